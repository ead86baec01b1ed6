// Normal forces of the contacts, in sub-steps of the cable's step.
#include "answer.h"
#include "push.h"
#include "squeeze.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

// Length of a sub-step times the highest frequency of the contacts: a tenth of the time that an impact by Hertz lasts,
// 4.03/frequency.
static const double substep_frequency = 0.4;

static const double substeps_largest = 1e6;

// Part of a contact's force, and of what stops it in a sub-step, that gives back what it owes.
static const double repaid_part = 0.1;

// Part of a force by which it may be off for Newton's method to end.
static const double enough = 1e-7;

enum { ROUNDS = 60 };

// Rounds contact by contact, before all are solved at once, and if couplings are kept in each; rounds over parts.
enum { TOGETHER = 6, TOGETHER_COUPLED = 20, PARTS_ROUNDS = 10 };

// Change of a force, as part of the largest, below which contacts that press on one another are done.
static const double together = 1e-6;

// Depth that an impact at the speed of approach of the contact drives it to [m].
static double deepest(const ancf_contact* c, double approach) {
    const double now = c->gap < 0.0 ? -c->gap : 0.0;
    if (!(approach > 0.0) || !(c->own > 0.0)) return now;
    const double n = ancf_normal_exponent(&c->law);
    const double stored = approach * approach * (n + 1.0) / (2.0 * c->own * c->law.stiffness);
    return pow((now > 0.0 ? pow(now, n + 1.0) : 0.0) + stored, 1.0 / (n + 1.0));
}

// Relative acceleration along the normal, without what is in the table [m/s2].
static double accelerates(const ancf_table* t, const ancf_contact* c) {
    double sum = 0.0;
    for (int s = 0; s < 2; ++s) {
        const ancf_side* side = &c->side[s];
        double a = side->place >= 0 ? ancf_dot(t->place[side->place].acceleration, c->normal) : 0.0;
        if (side->body >= 0) {
            const ancf_body* b = &t->body[side->body];
            double v[3];
            ancf_cross(v, b->turning, side->arm);
            a += ancf_dot(v, c->normal) + ancf_dot(b->acceleration, c->normal);
        }
        sum += s ? -a : a;
    }
    return sum;
}

static double* stiffness_at(ancf_table* t, const ancf_side* side, int body) {
    if (body) return side->body < 0 ? NULL : &t->stiffness[t->n_places + side->body];
    return side->place < 0 ? NULL : &t->stiffness[side->place];
}

// Square of the frequency of one contact if all others are as stiff as they get: a row sum of stiffness times effect.
static double row_sum(const ancf_table* t, const ancf_contact* c) {
    double sum = 0.0, cables = 0.0;
    for (int s = 0; s < 2; ++s) {
        const ancf_side* side = &c->side[s];
        if (side->place < 0) continue;
        cables += t->place[side->place].compliance;
        for (int k = t->first[side->place]; k < t->first[side->place + 1]; ++k)
            sum += fabs(t->effect[k]) * t->stiffness[t->other[k]];
    }
    double bodies = 0.0;
    for (int s = 0; s < 2; ++s)
        if (c->side[s].body >= 0) bodies = ancf_larger(bodies, t->stiffness[t->n_places + c->side[s].body]);
    return sum + ancf_larger(c->own - cables, 0.0) * bodies;
}

// Whether two sides come together within the step, however their velocity changes in it; *approach is the fastest.
static bool can_touch(const ancf_table* t, const ancf_contact* c, double step, double* approach) {
    const double u = ancf_table_opening(t, c) - 0.5 * step * fabs(accelerates(t, c));
    *approach = -u;
    return c->gap <= 0.0 || c->gap + step * u <= 0.0;
}

int ancf_table_substeps(ancf_table* t, double step, int* stiffest) {
    double highest = 0.0;
    int most = 0;
    *stiffest = 0;
    for (int i = 0; i < t->n_places + t->n_bodies; ++i) t->stiffness[i] = 0.0;
    for (int i = 0; i < t->groups.n; ++i) t->groups.group[i].substeps = 0;
    for (int k = 0; k < t->groups.n; ++k) {
        ancf_contact_group* g = &t->groups.group[k];
        const int* contact = t->groups.list[ANCF_CONTACTS];
        double square = 0.0;
        for (int i = g->first[ANCF_CONTACTS]; i < g->end[ANCF_CONTACTS]; ++i) {
            const ancf_contact* c = &t->contact[contact[i]];
            double approach;
            if (!can_touch(t, c, step, &approach)) continue;
            g->substeps = 1;
            const double tangent = ancf_normal_tangent(&c->law, deepest(c, approach));
            for (int s = 0; s < 2; ++s)
                for (int body = 0; body < 2; ++body) {
                    double* there = stiffness_at(t, &c->side[s], body);
                    if (there) *there += tangent;
                }
        }
        if (!g->substeps) continue;
        for (int i = g->first[ANCF_CONTACTS]; i < g->end[ANCF_CONTACTS]; ++i) {
            square = ancf_larger(square, row_sum(t, &t->contact[contact[i]]));
            if (!(square > highest)) continue;
            highest = square;
            *stiffest = contact[i];
        }
        const double wanted = ceil(step * sqrt(square) / substep_frequency);
        if (wanted > 1.0) g->substeps = (int)fmin(wanted, substeps_largest);
        if (g->substeps > most) most = g->substeps;
    }
    return t->most = most;
}

// One contact over a sub-step h, from its gap and the velocity u that it would have by itself: the force that is its
// own answer, sought from a guess on. The answer falls with the force, so Newton's method within brackets finds it
// however stiff the contact is.
static ancf_pressing press_one(const ancf_contact* c, double u, double h, double guess) {
    if (c->gap >= 0.0 && c->gap + h * u >= 0.0) return (ancf_pressing) {0.0, 0.0, {0.0, 0.0}};
    double low = 0.0, high = INFINITY, force = guess;
    ancf_pressing f;
    for (int i = 0; i < ROUNDS; ++i) {
        f = ancf_answer_alone(c, u, h, force);
        const double off = f.total - force, more = off / (1.0 - fmin(f.slope[1], 0.0));
        if (fabs(off) <= enough * force) { // the error is of the order of its square
            f.total = force + more;
            f.elastic += f.slope[0] * more;
            break;
        }
        if (off > 0.0) low = force;
        else high = force;
        force += more;
        if (force > low && force < high) continue;
        if (high == INFINITY) high = ancf_answer_alone(c, u, h, low).total;
        force = 0.5 * (low + high);
        if (!(force > low && force < high)) break;
    }
    return f;
}

// Force beside that of the law, at the mean velocity of a sub-step, so that its work is what is owed, as far as it
// changes neither the force nor the velocity by more than a part.
static double repay(const ancf_contact* c, double force, double speed, double h) {
    if (c->owed == 0.0 || !(force > 0.0) || speed == 0.0) return 0.0;
    const double most = repaid_part * fmin(force, c->own > 0.0 ? fabs(speed) / (h * c->own) : force);
    return fmax(-most, fmin(most, -c->owed / (h * speed)));
}

// One contact's force while what others give it goes on as it is [m/s]. Returns its change.
static double press_with(ancf_contact* c, double others, double h, double guess) {
    c->met = others;
    const ancf_pressing f = press_one(c, c->speed + 0.5 * others, h, guess);
    c->repaid = repay(c, f.total, c->speed + 0.5 * (others + h * c->own * f.total), h);
    const double before = c->force;
    c->force = c->before = f.total + c->repaid;
    c->elastic = f.elastic;
    return c->force - before;
}

// Presses every contact of a group while the others go on as they did in the round before. Returns the largest change
// of a force, *largest is the largest force. The first round looks at all before any is pushed.
static double press_round(ancf_table* t, const ancf_contact_group* g, double h, bool first, double* largest) {
    const int* contact = t->groups.list[ANCF_CONTACTS];
    const double little = 0.1 * together * *largest;
    double change = 0.0;
    *largest = 0.0;
    for (int k = g->first[ANCF_CONTACTS]; k < g->end[ANCF_CONTACTS]; ++k) {
        const int i = contact[k];
        ancf_contact* c = &t->contact[i];
        const double others = ancf_push_gained(t, &t->push[i]) - h * c->own * c->force;
        *largest = ancf_larger(*largest, c->force);
        if (!first && fabs(others - c->met) <= h * c->own * little) continue; // its force would change by less
        const double more = press_with(c, others, h, first ? c->before : c->force);
        change = ancf_larger(change, fabs(more));
        *largest = ancf_larger(*largest, c->force);
        if (!first && more != 0.0) ancf_push_give(t, i, h * more);
    }
    for (int k = g->first[ANCF_CONTACTS]; first && k < g->end[ANCF_CONTACTS]; ++k) {
        const int i = contact[k];
        if (t->contact[i].force > 0.0) ancf_push_give(t, i, h * t->contact[i].force);
    }
    return change;
}

// Gives places and bodies what a contact's force has changed by since the last time.
static void kick_along(ancf_table* t, ancf_contact* c, double h, double rest) {
    const double impulse = h * (c->force - c->kicked);
    c->kicked = c->force;
    if (impulse == 0.0) return;
    const double P[3] = {impulse * c->normal[0], impulse * c->normal[1], impulse * c->normal[2]};
    ancf_table_kick(t, c, P, rest);
}

// What rounds do not end, all at once, or one part after the other. Returns what a force is off by.
static double squeeze(ancf_table* t, const ancf_contact_group* g, double h, double largest) {
    const int *contact = t->groups.list[ANCF_CONTACTS], first = g->first[ANCF_CONTACTS], end = g->end[ANCF_CONTACTS];
    double off = INFINITY;
    for (int round = 0; round < PARTS_ROUNDS && off > together * largest; ++round) {
        off = 0.0;
        for (int k = first; k < end; k += ANCF_NEWTON_MOST) {
            const int n = end - k < ANCF_NEWTON_MOST ? end - k : ANCF_NEWTON_MOST;
            double left;
            const double change = ancf_squeeze(&left, t, contact + k, n, h, 1e-3 * together * largest);
            off = ancf_larger(off, n < end - first ? ancf_larger(change, left) : left);
        }
    }
    return off;
}

// The forces of a group over a sub-step, each the answer to all others. Returns what they are off by, as part of the
// largest.
static double press_group(ancf_table* t, const ancf_contact_group* g, double h, double rest) {
    const int *contact = t->groups.list[ANCF_CONTACTS], first = g->first[ANCF_CONTACTS], end = g->end[ANCF_CONTACTS];
    const bool couples = t->n_couplings > 0 || g->slides;
    if (end == first + 1 && !couples) { // alone
        ancf_contact* c = &t->contact[contact[first]];
        press_with(c, ancf_table_opening(t, c) - c->speed, h, c->before);
        kick_along(t, c, h, rest);
        return 0.0;
    }
    for (int k = first; k < end; ++k) ancf_push_find(t, contact[k]);
    const int rounds = couples ? TOGETHER_COUPLED : TOGETHER;
    double largest = 0.0, change = INFINITY;
    for (int round = 0; round < rounds && change > together * largest; ++round) {
        change = press_round(t, g, h, round == 0, &largest);
        if (!couples) continue;
        for (int k = first; k < end; ++k) kick_along(t, &t->contact[contact[k]], h, rest);
        ancf_table_couple(t, rest);
        for (int k = first; k < end; ++k) ancf_push_find(t, contact[k]);
    }
    if (!couples && change > together * largest) change = squeeze(t, g, h, largest);
    for (int k = first; k < end; ++k) kick_along(t, &t->contact[contact[k]], h, rest);
    return largest == 0.0 ? 0.0 : change / largest;
}

// Moves the arm of the second side on by a time: its end goes with the first side. Positions go through the whole step
// at velocities that have the accelerations in them; those of the table have them from `until` of it on. Where the step
// is one of several, bodies' positions go as if they had those of all from the start, for YADE's do. Of two cables
// the normal turns with the line between their centrelines.
static void swing(const ancf_table* t, ancf_contact* c, double time, double until) {
    double v[3], a[3], *arm = c->side[1].arm;
    const bool cables = c->radius[0] > 0.0;
    if (c->side[1].body < 0 && !cables) return;
    ancf_table_going(v, t, c);
    ancf_table_changing(a, t, c);
    for (int s = 0; s < 2; ++s)
        if (c->side[s].place < 0 && c->side[s].body >= 0)
            for (int k = 0; k < 3; k++) v[k] += (s ? 1.0 : -1.0) * t->passed * t->body[c->side[s].body].given[k];
    for (int k = 0; k < 3; k++) arm[k] += time * (v[k] + until * a[k]);
    if (!cables) return;
    const double along = ancf_dot(arm, c->normal), size = copysign(sqrt(ancf_dot(arm, arm)), along);
    if (along != 0.0)
        for (int k = 0; k < 3; k++) c->normal[k] = arm[k] / size;
}

// h: its length; at: its middle; since: the time from the last one's middle; until: from its start to the step's
// middle. Returns what forces are off by.
static double substep(ancf_table* t, const ancf_contact_group* g, double h, double at, double rest, double since,
                      double until) {
    const int *contact = t->groups.list[ANCF_CONTACTS], first = g->first[ANCF_CONTACTS], end = g->end[ANCF_CONTACTS];
    for (int k = first; k < end; ++k) {
        ancf_contact* c = &t->contact[contact[k]];
        swing(t, c, since, until);
        c->speed = ancf_table_opening(t, c);
        c->force = c->kicked = 0.0;
        c->energy = ancf_normal_energy(&c->law, -c->gap);
        if (at < h) c->found += c->energy - c->left; // the first
    }
    ancf_table_speed_up_group(t, g, h);
    const double left = press_group(t, g, h, rest);
    for (int k = first; k < end; ++k) {
        ancf_contact* c = &t->contact[contact[k]];
        const double way = 0.5 * h * (c->speed + ancf_table_opening(t, c));
        c->impulse += h * c->force;
        for (int j = 0; j < 3; j++) c->late[j] += h * c->force * at * c->normal[j];
        c->gap += way;
        c->damped -= (c->force - c->repaid - c->elastic) * way;
        c->owed += c->repaid * way;
        c->depth = ancf_larger(c->depth, -c->gap);
    }
    return left;
}

static double press_through(ancf_table* t, const ancf_contact_group* g, double step, int substeps) {
    const double h = step / (substeps > 0 ? substeps : 1);
    double left = 0.0;
    if (substeps) ancf_table_speed_up_group(t, g, -0.5 * step); // from the middle of the step to its start
    for (int s = 0; s < substeps; ++s) {
        const double at = (s + 0.5) * h;
        left = ancf_larger(left, substep(t, g, h, at, step - at, s ? h : 0.5 * h, 0.5 * step - s * h));
    }
    if (substeps) ancf_table_speed_up_group(t, g, -0.5 * step);
    for (int k = g->first[ANCF_CONTACTS]; k < g->end[ANCF_CONTACTS]; ++k) {
        ancf_contact* c = &t->contact[t->groups.list[ANCF_CONTACTS][k]];
        memcpy(c->side[1].arm, c->start, sizeof c->start);
        memcpy(c->normal, c->line, sizeof c->line);
        c->speed = ancf_table_opening(t, c);
        if (substeps == 0) c->gap += step * c->speed;
        c->left = c->energy = ancf_normal_energy(&c->law, -c->gap);
    }
    return left;
}

double ancf_table_press(ancf_table* t, double step, int substeps) {
    double left = 0.0;
    for (int k = 0; k < t->groups.n; ++k) {
        const ancf_contact_group* g = &t->groups.group[k];
        int n = substeps;
        if (t->most > 0) n = (int)ceil((double)g->substeps * substeps / t->most);
        left = ancf_larger(left, press_through(t, g, step, n));
    }
    for (int k = 0; k < t->groups.contacts; ++k) { // other groups have moved them by rounding
        ancf_contact* c = &t->contact[t->groups.list[ANCF_CONTACTS][k]];
        ancf_table_going(c->going, t, c);
    }
    return left;
}
