// Friction of all contacts that pressed, together, at the velocity after it has acted; as normal forces act in the
// course of the step, at its mean over the step, by which things move. What is at rest under them has a velocity at the
// end of the step, and where that is not along the normal it would be taken for slip.
//
// Explicit friction would need a step of 2 m v0/((2 mu_s - mu_k) f_n). Here each contact's friction belongs to the
// velocity that is left. A few sweeps contact by contact (Gauss-Seidel) find which stick and which slide, as Stribeck's
// falling branch leaves a choice; then Newton's method finds all of a group, or of one part of it after the other.
#include "drag.h"
#include "lever.h"
#include "parts.h"
#include "rubbing.h"

#include <math.h>
#include <string.h>

enum { SWEEPS = 2, RENEWALS = 20 };

// A group of up to FEW contacts is one part, and so is one that cables alone tie together: where each contact feels its
// neighbours alone, Newton's method costs little for all of them, and parts would hand on what is off one by one.
// Others go round over parts of one body each, then, as long as that does not end, over larger ones.
enum { FEW = 8, STAGES = 2 };
struct stage {
    int most, rounds;
};
static const struct stage stage[STAGES] = {{1, 8}, {ANCF_NEWTON_MOST, 32}};

// Part of the largest friction impulse by which friction may be off, and below which a contact is left as it is.
static const double tolerance = 1e-8;

static void project(double v[3], const double normal[3]) {
    const double along = ancf_dot(v, normal);
    for (int i = 0; i < 3; i++) v[i] -= along * normal[i];
}

// Velocity of the first side against the second where they touch.
static void slip_of(double v[3], const ancf_table* t, const ancf_contact* c) {
    ancf_table_slip(v, t, c);
    if (ancf_lever_has(c)) ancf_lever_slip(v, t, c);
}

static void rub(ancf_table* t, const ancf_contact* c, const double impulse[3], double step) {
    if (impulse[0] == 0.0 && impulse[1] == 0.0 && impulse[2] == 0.0) return;
    ancf_table_kick(t, c, impulse, step);
    if (ancf_lever_has(c)) ancf_lever_kick(t, c, impulse, step);
}

static bool rubs(const ancf_contact* c) { return c->impulse > 0.0 && c->rub.kind != ANCF_FRICTION_NONE; }

// Largest impulse of friction [N s].
static double most_of(const ancf_contact* c) { return ancf_larger(c->rub.mu_s, c->rub.mu_k) * c->impulse; }

static double square(const double v[2]) { return v[0] * v[0] + v[1] * v[1]; }

// Slip by a unit impulse along a direction, along it [1/kg], but no less than its mean over directions, with which
// sweeps could go too far.
static double along(const ancf_drag* d, const double v[2]) {
    const double mean = 0.5 * (d->own[0][0] + d->own[1][1]), size = square(v);
    if (!(size > 0.0)) return mean;
    return ancf_larger(
        mean, (d->own[0][0] * v[0] * v[0] + 2.0 * d->own[0][1] * v[0] * v[1] + d->own[1][1] * v[1] * v[1]) / size);
}

// What the coefficient can rise to: where it falls with the speed, what it is at that; at rest, what it is at the end
// of rest.
static double most_at(const ancf_contact* c, double speed) {
    if (c->rub.kind != ANCF_FRICTION_HOLLARS || !(c->rub.mu_s > c->rub.mu_k)) return c->rub.mu_k;
    return ancf_friction_coefficient(&c->rub, ancf_larger(speed, c->rub.v0));
}

// Puts one contact's friction right while the others' stay; returns the square of its change [N2 s2]. Its own part is
// taken off the velocity, the scalar equation solved along what is left, and the new part put on: where nothing changes
// any more, the friction belongs to the true velocity, whatever w was.
static double rub_one(ancf_table* t, int contact, double largest) {
    ancf_contact* c = &t->contact[contact];
    ancf_drag* d = &t->drag[contact];
    double v[2];
    ancf_drag_slip(v, t, c, d);
    const double now = sqrt(square(v)), w = along(d, square(d->impulse) > 0.0 ? d->impulse : v);
    double moved = 0.0, change[2];
    for (int a = 0; a < 2; ++a) {
        v[a] -= w * d->impulse[a];
        moved = ancf_larger(moved, fabs(v[a] - d->without[a]));
    }
    if (moved <= tolerance * w * largest) return 0.0;
    d->without[0] = v[0];
    d->without[1] = v[1];
    const double speed = sqrt(square(v)), left = ancf_friction_solve(&c->rub, speed, w * c->impulse, now),
                 bound = ancf_friction_coefficient(&c->rub, left) * c->impulse;
    c->most = most_at(c, left);
    for (int a = 0; a < 2; ++a) {
        const double wanted = speed > 0.0 ? -bound * (v[a] / speed) : 0.0;
        change[a] = wanted - d->impulse[a];
        d->impulse[a] = wanted;
    }
    ancf_drag_give(t, c, d, change);
    return square(change);
}

// Takes the velocities over the step off the accelerations, or puts them on.
static void accelerations(ancf_table* t, double inverse) {
    for (int c = 0; c < 3; c++) {
        for (int i = 0; i < t->n_places; ++i) {
            t->place[i].acceleration[c] += inverse * t->place[i].velocity[c];
            t->place[i].bends[c] += inverse * t->place[i].bending[c];
        }
        for (int i = 0; i < t->n_bodies; ++i) {
            t->body[i].acceleration[c] += inverse * t->body[i].velocity[c];
            t->body[i].turning[c] += inverse * t->body[i].spin[c];
        }
    }
}

// Friction acts from the start of the step, where slower velocities are than in its middle: there leapfrog has the work
// of all that acts evenly.
void ancf_table_guess(ancf_table* t, double step) {
    const int *live = t->groups.list[ANCF_CONTACTS], n = t->groups.contacts;
    double now[3];
    for (int i = 0; i < n; ++i) slip_of(t->slip[live[i]], t, &t->contact[live[i]]);
    accelerations(t, -1.0 / step);
    for (int i = 0; i < n; ++i) {
        ancf_contact* c = &t->contact[live[i]];
        double P[3];
        project(c->friction, c->normal);
        for (int k = 0; k < 3; k++) P[k] = step * (c->guess[k] = c->friction[k]);
        rub(t, c, P, step);
    }
    accelerations(t, 1.0 / step);
    for (int i = 0; i < n; ++i) {
        double* slip = t->slip[live[i]];
        slip_of(now, t, &t->contact[live[i]]);
        for (int k = 0; k < 3; k++) slip[k] = 0.5 * (now[k] - slip[k]);
    }
    ancf_table_speed_up(t, -0.5 * step);
    for (int i = 0; i < n; ++i) {
        ancf_contact* c = &t->contact[live[i]];
        slip_of(now, t, c);
        c->rubbed -= step * ancf_dot(c->guess, now);
        for (int k = 0; k < 3; k++) t->slip[live[i]][k] += now[k];
    }
    ancf_table_speed_up(t, 0.5 * step);
    t->guessed = true;
}

// Velocities of the end of the step turn into their means over it, as normal forces act in the course of it.
static void turn_back(ancf_table* t, double step) {
    for (int i = 0; i < t->n_places; ++i) memset(t->place[i].pushed, 0, sizeof t->place[i].pushed);
    for (int i = 0; i < t->n_places; ++i) {
        const ancf_place* p = &t->place[i];
        double late[3];
        for (int c = 0; c < 3; c++) late[c] = p->impulse[c] - p->moment[c] / step;
        if (late[0] == 0.0 && late[1] == 0.0 && late[2] == 0.0) continue;
        for (int k = t->first[i]; k < t->first[i + 1]; ++k) {
            double* pushed = t->place[t->other[k]].pushed;
            for (int c = 0; c < 3; c++) {
                pushed[c] -= t->effect[k] * late[c];
                pushed[3 + c] -= t->bend[k].to * late[c];
            }
        }
    }
    for (int i = 0; i < t->n_bodies; ++i) {
        ancf_body* b = &t->body[i];
        for (int c = 0; c < 3; c++) {
            b->pushed[c] = b->before[c] + b->shift[c] / step - b->velocity[c];
            b->pushed[3 + c] = b->before[3 + c] + b->turn[c] / step - b->spin[c];
        }
    }
}

// Starts from the guess, in the tangent plane and no larger than friction can be. Returns that bound [N s].
static double start(ancf_table* t, int contact, double step) {
    const ancf_contact* c = &t->contact[contact];
    ancf_drag* d = &t->drag[contact];
    const double bound = most_of(c);
    double slip[3], change[2];
    ancf_drag_find(t, contact);
    slip_of(slip, t, c);
    for (int a = 0; a < 2; ++a) {
        d->impulse[a] = step * ancf_dot(d->tangent[a], c->friction);
        d->slip[a] = ancf_dot(d->tangent[a], slip);
        d->without[a] = INFINITY; // solved once at least
    }
    const double size = sqrt(square(d->impulse)), part = size > bound ? bound / size : 1.0;
    for (int a = 0; a < 2; ++a) {
        d->impulse[a] *= part;
        change[a] = d->impulse[a] - step * ancf_dot(d->tangent[a], c->guess);
    }
    ancf_drag_give(t, c, d, change);
    return bound;
}

// Gives a friction force instead of its guess to all that feels it.
static void finish(ancf_table* t, ancf_contact* c, const double force[3], double step) {
    double P[3];
    for (int i = 0; i < 3; i++) {
        c->friction[i] = force[i];
        P[i] = step * (force[i] - c->guess[i]);
    }
    rub(t, c, P, step);
}

// Puts friction of a part of a group right while the rest stays; returns the square of the largest change. *left: by
// how much it is off.
static double rub_part(ancf_table* t, const double* W, const int* contact, int n, double largest, double* left,
                       int* steps) {
    double P[2 * ANCF_NEWTON_MOST], v[2 * ANCF_NEWTON_MOST], change = 0.0;
    ancf_rubbing part[ANCF_NEWTON_MOST];
    for (int i = 0; i < n; ++i) {
        const ancf_contact* c = &t->contact[contact[i]];
        part[i] = (ancf_rubbing) {&c->rub, c->impulse, c->most};
        memcpy(P + 2 * i, t->drag[contact[i]].impulse, sizeof t->drag->impulse);
        ancf_drag_slip(v + 2 * i, t, c, &t->drag[contact[i]]);
    }
    double renewed = INFINITY; // largest change of a force by its coefficient
    for (int renewal = 0; renewal < RENEWALS && renewed > tolerance * largest; ++renewal) {
        *steps += ancf_rubbing_solve(P, v, left, n, part, W, tolerance * largest, t->newton);
        renewed = 0.0;
        for (int i = 0; i < n; ++i) {
            const ancf_contact* c = &t->contact[contact[i]];
            const double speed = sqrt(square(v + 2 * i)), most = most_at(c, speed);
            if (!(speed > c->rub.v0)) continue;
            renewed = ancf_larger(renewed, fabs(most - part[i].most) * c->impulse);
            part[i].most = most;
        }
    }
    *left = ancf_larger(*left, renewed);
    for (int i = 0; i < n; ++i) {
        ancf_contact* c = &t->contact[contact[i]];
        ancf_drag* d = &t->drag[contact[i]];
        const double more[2] = {P[2 * i] - d->impulse[0], P[2 * i + 1] - d->impulse[1]};
        c->most = part[i].most;
        memcpy(d->impulse, P + 2 * i, sizeof d->impulse);
        ancf_drag_give(t, c, d, more);
        change = ancf_larger(change, square(more));
    }
    return change;
}

// Marks the contacts of a group that rub as to be listed; takes back what was guessed of the others.
static void take_back(ancf_table* t, const ancf_contact_group* g, double step) {
    for (int k = g->first[ANCF_CONTACTS]; k < g->end[ANCF_CONTACTS]; ++k) {
        const int i = t->groups.list[ANCF_CONTACTS][k];
        t->drag[i].listed = !rubs(&t->contact[i]);
        t->drag[i].number = -1;
        if (t->drag[i].listed) finish(t, &t->contact[i], (double[3]) {0.0, 0.0, 0.0}, step);
    }
}

// One part after the other until none changes, or so many rounds, or, in a hurry, until that is not to be expected of
// them. Returns by how much friction is off.
static double rub_parts(ancf_table* t, int rounds, bool hurry, double largest, int* steps) {
    double left = INFINITY, before = INFINITY;
    for (int round = 0; round < rounds && left > tolerance * largest; ++round) {
        double change = 0.0;
        if (hurry && round > 1 && left * pow(left / before, rounds - round) > tolerance * largest) break;
        before = left;
        left = 0.0;
        for (int k = 0; k < t->parts; ++k) {
            const int *contact = t->rubbing + t->part[k], n = t->part[k + 1] - t->part[k];
            double off = 0.0, *W = t->effects + 4 * ANCF_NEWTON_MOST * (size_t)t->part[k];
            if (round == 0) ancf_drag_effects(W, t, contact, n);
            change = ancf_larger(change, rub_part(t, W, contact, n, largest, &off, steps));
            left = ancf_larger(left, off);
        }
        if (t->parts == 1) break;
        left = ancf_larger(left, sqrt(change));
    }
    return left;
}

// Whether any of the n contacts listed moves a body.
static bool moves_bodies(const ancf_table* t, int n) {
    for (int k = 0; k < n; ++k)
        if (t->drag[t->rubbing[k]].body[0] || t->drag[t->rubbing[k]].body[1]) return true;
    return false;
}

// Friction of what presses in a group. Returns the number of sweeps and of Newton's steps.
static int rub_group(ancf_table* t, const ancf_contact_group* g, double step, double* left) {
    take_back(t, g, step);
    const int n = ancf_parts_list(t, g), *contact = t->rubbing;
    double largest = 0.0, off = INFINITY;
    int needed = 0;
    for (int k = 0; k < n; ++k) largest = ancf_larger(largest, start(t, contact[k], step));
    if (largest == 0.0) off = 0.0;
    while (off > tolerance * largest && needed < SWEEPS) {
        double change = 0.0;
        ++needed;
        for (int k = 0; k < n; ++k) change = ancf_larger(change, rub_one(t, contact[k], largest));
        off = sqrt(change);
    }
    const int from = moves_bodies(t, n) ? 0 : STAGES - 1;
    for (int i = from; i < STAGES && off > tolerance * largest; ++i) {
        ancf_parts_join(t, n <= FEW ? FEW : stage[i].most);
        off = rub_parts(t, stage[i].rounds, i < STAGES - 1, largest, &needed);
    }
    for (int k = 0; k < n; ++k) {
        const ancf_drag* d = &t->drag[contact[k]];
        double force[3];
        for (int i = 0; i < 3; i++)
            force[i] = (d->impulse[0] * d->tangent[0][i] + d->impulse[1] * d->tangent[1][i]) / step;
        finish(t, &t->contact[contact[k]], force, step);
    }
    if (largest != 0.0) *left = ancf_larger(*left, off / largest);
    return needed;
}

// Whether friction acts in the step, or did as a guess.
static bool works(const ancf_contact* c) {
    return rubs(c) || c->guess[0] != 0.0 || c->guess[1] != 0.0 || c->guess[2] != 0.0;
}

int ancf_table_rub(ancf_table* t, double step, double* left) {
    const int *live = t->groups.list[ANCF_CONTACTS], n = t->groups.contacts;
    int sweeps = 0;
    *left = 0.0;
    for (int i = 0; i < n; ++i) {
        double now[3], *slip = t->slip[live[i]];
        if (!works(&t->contact[live[i]])) continue;
        slip_of(now, t, &t->contact[live[i]]);
        for (int k = 0; k < 3; k++) slip[k] = (t->guessed ? slip[k] : now[k]) - 0.5 * now[k];
    }
    turn_back(t, step);
    for (int k = 0; k < t->groups.n; ++k) {
        const int needed = rub_group(t, &t->groups.group[k], step, left);
        if (needed > sweeps) sweeps = needed;
    }
    for (int i = 0; i < n; ++i) {
        ancf_contact* c = &t->contact[live[i]];
        double now[3]; // energy goes with the mean of the velocities before and after
        if (!works(c)) continue;
        slip_of(now, t, c);
        for (int k = 0; k < 3; k++)
            c->rubbed -= step * (c->friction[k] - c->guess[k]) * (t->slip[live[i]][k] + 0.5 * now[k]);
    }
    return sweeps;
}
