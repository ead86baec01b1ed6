// Friction of all contacts that pressed, together, at the velocity after it has acted; as normal forces act in the
// course of the step, at its mean over the step, by which things move. What is at rest under them has a velocity at the
// end of the step, and where that is not along the normal it would be taken for slip.
//
// Explicit friction would need a step of 2 m v0/((2 mu_s - mu_k) f_n). Here each contact's friction belongs to the
// velocity that is left, found contact by contact until none changes (Gauss-Seidel).
#include "drag.h"
#include "lever.h"

#include <math.h>
#include <string.h>

// On Stribeck's falling branch neighbours can free and catch each other without end. After a few sweeps what slides and
// can, goes on to; after some more each coefficient is as it was then, or less, and there is one solution.
enum { SWEEPS_FREE = 3, SWEEPS_SLIDING = 5, SWEEPS_MAX = 24 };

// Where a heavy body holds a light cable and another pulls at it, sweeps change nearly as much as those before: changes
// that go down as a geometric series, but for a part, are led to its sum at once [Aitken 1926].
static const double misfit = 0.1, slowest = 0.9999;

// Part of the largest friction impulse below which a sweep's changes end the solve, and a contact is left as it is.
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
    if (ancf_lever_has(c)) ancf_lever_kick(t, c, impulse);
}

static bool rubs(const ancf_contact* c) { return c->impulse > 0.0 && c->rub.kind != ANCF_FRICTION_NONE; }

// Largest impulse of friction [N s].
static double most_of(const ancf_contact* c) { return ancf_larger(c->rub.mu_s, c->rub.mu_k) * c->impulse; }

static double square(const double v[2]) { return v[0] * v[0] + v[1] * v[1]; }

// Slip by a unit impulse along a direction, along it [1/kg], but no less than its mean over directions, with which
// sweeps could go too far.
static double along(const ancf_drag* d, const double v[2]) {
    const double mean = 0.5 * (d->own[0] + d->own[2]), size = square(v);
    if (!(size > 0.0)) return mean;
    return ancf_larger(mean,
                       (d->own[0] * v[0] * v[0] + 2.0 * d->own[1] * v[0] * v[1] + d->own[2] * v[1] * v[1]) / size);
}

// Coefficient of friction at the speed that it leaves of a speed.
static double coefficient_left(ancf_contact* c, double speed, double beta, int sweep) {
    if (sweep > SWEEPS_SLIDING) return ancf_friction_settle(&c->rub, speed, beta, c->most);
    const double left = ancf_friction_solve(&c->rub, speed, beta, sweep > SWEEPS_FREE && c->slides);
    const double coefficient = ancf_friction_coefficient(&c->rub, left);
    c->slides = left > c->rub.v0;
    c->most = c->slides ? coefficient : c->rub.mu_s;
    return coefficient;
}

// Puts one contact's friction right while the others' stay; returns the square of its change [N2 s2]. Its own part is
// taken off the velocity, the scalar equation solved along what is left, and the new part put on: where nothing changes
// any more, the friction belongs to the true velocity, whatever w was.
static double rub_one(ancf_table* t, ancf_contact* c, ancf_drag* d, double largest, int sweep) {
    double v[2];
    ancf_drag_slip(v, t, c, d);
    const double w = along(d, square(d->impulse) > 0.0 ? d->impulse : v);
    double moved = 0.0;
    for (int a = 0; a < 2; ++a) {
        v[a] -= w * d->impulse[a];
        moved = ancf_larger(moved, fabs(v[a] - d->without[a]));
        d->change[a] = 0.0;
    }
    if (moved <= tolerance * w * largest) return 0.0;
    d->without[0] = v[0];
    d->without[1] = v[1];
    const double speed = sqrt(square(v));
    const double bound = coefficient_left(c, speed, w * c->impulse, sweep) * c->impulse;
    for (int a = 0; a < 2; ++a) {
        const double wanted = speed > 0.0 ? -bound * (v[a] / speed) : 0.0;
        d->change[a] = wanted - d->impulse[a];
        d->impulse[a] = wanted;
    }
    ancf_drag_give(t, c, d, d->change);
    return square(d->change);
}

// How much of its last change is still to come for a contact whose last two changes are terms of a geometric series; 0
// where they are not.
static double to_come(const ancf_drag* d) {
    const double before = square(d->former), now = square(d->change),
                 both = d->former[0] * d->change[0] + d->former[1] * d->change[1];
    if (!(both > 0.0) || both > slowest * before || now * before - both * both > misfit * misfit * now * before)
        return 0.0;
    return both / (before - both);
}

// Lets frictions of a group go to where the last two sweeps lead, as far as friction can be. False: they lead nowhere.
static bool lead_on(ancf_table* t, const ancf_contact_group* g) {
    bool led = false;
    for (int k = g->first[ANCF_CONTACTS]; k < g->end[ANCF_CONTACTS]; ++k) {
        const int i = t->groups.list[ANCF_CONTACTS][k];
        const ancf_contact* c = &t->contact[i];
        ancf_drag* d = &t->drag[i];
        const double more = rubs(c) ? to_come(d) : 0.0;
        if (more == 0.0) continue;
        double wanted[2], change[2];
        for (int a = 0; a < 2; ++a) wanted[a] = d->impulse[a] + more * d->change[a];
        const double bound = most_of(c), size = sqrt(square(wanted)), kept = size > bound ? bound / size : 1.0;
        for (int a = 0; a < 2; ++a) {
            change[a] = kept * wanted[a] - d->impulse[a];
            d->impulse[a] = kept * wanted[a];
        }
        ancf_drag_give(t, c, d, change);
        d->without[0] = INFINITY; // solved again
        led = true;
    }
    return led;
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
static double start(ancf_table* t, ancf_contact* c, ancf_drag* d, double step) {
    double slip[3], change[2];
    ancf_drag_find(t, c, d);
    slip_of(slip, t, c);
    const double bound = rubs(c) ? most_of(c) : 0.0;
    for (int a = 0; a < 2; ++a) {
        d->impulse[a] = step * ancf_dot(d->tangent[a], c->friction);
        d->slip[a] = ancf_dot(d->tangent[a], slip);
        d->change[a] = 0.0;
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

// Gives the friction that was found to all that feels it.
static void finish(ancf_table* t, ancf_contact* c, const ancf_drag* d, double step) {
    double P[3];
    for (int i = 0; i < 3; i++) {
        c->friction[i] = (d->impulse[0] * d->tangent[0][i] + d->impulse[1] * d->tangent[1][i]) / step;
        P[i] = step * (c->friction[i] - c->guess[i]);
    }
    rub(t, c, P, step);
}

// Friction of what presses in a group. Returns the number of sweeps.
static int rub_group(ancf_table* t, const ancf_contact_group* g, double step, double* left) {
    const int *contact = t->groups.list[ANCF_CONTACTS], first = g->first[ANCF_CONTACTS], end = g->end[ANCF_CONTACTS];
    double largest = 0.0, change = 0.0;
    for (int k = first; k < end; ++k) {
        const int i = contact[k];
        largest = ancf_larger(largest, start(t, &t->contact[i], &t->drag[i], step));
    }
    double last = INFINITY;             // change when it was led on
    int sweep = 0, since = 0, wait = 3; // sweeps since then, and until next; longer where it did not help
    while (largest > 0.0 && sweep < SWEEPS_MAX) {
        change = 0.0;
        ++sweep;
        for (int k = first; k < end; ++k) {
            ancf_contact* c = &t->contact[contact[k]];
            ancf_drag* d = &t->drag[contact[k]];
            if (!rubs(c)) continue;
            memcpy(d->former, d->change, sizeof d->former);
            change = ancf_larger(change, rub_one(t, c, d, largest, sweep));
        }
        if (change <= tolerance * tolerance * largest * largest) break;
        if (++since < wait || sweep == SWEEPS_MAX || !lead_on(t, g)) continue;
        if (change > 0.25 * last) wait *= 2;
        last = change;
        since = 0;
    }
    for (int k = first; k < end; ++k) finish(t, &t->contact[contact[k]], &t->drag[contact[k]], step);
    if (largest > 0.0) *left = ancf_larger(*left, sqrt(change) / largest);
    return sweep;
}

int ancf_table_rub(ancf_table* t, double step, double* left) {
    const int *live = t->groups.list[ANCF_CONTACTS], n = t->groups.contacts;
    int sweeps = 0;
    *left = 0.0;
    for (int i = 0; i < n; ++i) {
        double now[3], *slip = t->slip[live[i]];
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
        slip_of(now, t, c);
        for (int k = 0; k < 3; k++)
            c->rubbed -= step * (c->friction[k] - c->guess[k]) * (t->slip[live[i]][k] + 0.5 * now[k]);
    }
    return sweeps;
}
