// Friction of all contacts that pressed, together, at the velocity after it has acted; as normal forces act in the
// course of the step, at its mean over the step, by which things move. What is at rest under them has a velocity at the
// end of the step, and where that is not along the normal it would be taken for slip.
//
// Explicit friction would need a step of 2 m v0/((2 mu_s - mu_k) f_n). Here each contact's friction belongs to the
// velocity that is left, found contact by contact until none changes (Gauss-Seidel).
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

// Mean over the tangent plane of a body's response at the point, half the trace of P (M^-1 - [a] I^-1 [a]) P [1/kg].
static double body_across(const ancf_body* b, const double arm[3], const double normal[3]) {
    const double *J = b->inv_inertia, *a = arm;
    double side[3], turn[3], trace = 0.0;
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        trace += b->inv_mass[i] * (1.0 - normal[i] * normal[i]);
        trace += J[4 * i] * (a[j] * a[j] + a[k] * a[k]);
        trace -= (J[3 * i + j] + J[3 * j + i]) * a[i] * a[j];
    }
    ancf_cross(side, arm, normal);
    ancf_multiply(turn, J, side);
    const double raised = ancf_dot(b->along, normal);
    trace += ancf_dot(b->along, b->along) - raised * raised;
    return 0.5 * (trace - ancf_dot(side, turn));
}

// Effective inverse mass across the normal, its mean over directions [1/kg].
static double across(const ancf_table* t, const ancf_contact* c) {
    if (ancf_lever_has(c)) return ancf_lever_across(t, c);
    double w = 0.0;
    for (int s = 0; s < 2; ++s) {
        if (c->side[s].place >= 0) w += t->place[c->side[s].place].compliance;
        if (c->side[s].body >= 0) w += body_across(&t->body[c->side[s].body], c->side[s].arm, c->normal);
    }
    return w;
}

// The same along a vector, but no less than that mean, with which sweeps could go too far.
static double along(const ancf_table* t, const ancf_contact* c, const double vector[3]) {
    const double size = sqrt(ancf_dot(vector, vector));
    if (ancf_lever_has(c) || !(size > 0.0)) return c->own;
    const double direction[3] = {vector[0] / size, vector[1] / size, vector[2] / size};
    return ancf_larger(c->own, ancf_table_compliance(t, c, direction));
}

static bool rubs(const ancf_contact* c) { return c->impulse > 0.0 && c->rub.kind != ANCF_FRICTION_NONE; }

// Largest impulse of friction [N s].
static double most_of(const ancf_contact* c) { return ancf_larger(c->rub.mu_s, c->rub.mu_k) * c->impulse; }

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
static double rub_one(ancf_table* t, ancf_contact* c, double step, double largest, int sweep) {
    double v[3], change[3], moved = 0.0;
    slip_of(v, t, c);
    for (int i = 0; i < 3; i++) v[i] -= c->lag[i];
    project(v, c->normal);
    const double w = along(t, c, ancf_dot(c->friction, c->friction) > 0.0 ? c->friction : v);
    for (int i = 0; i < 3; i++) {
        v[i] -= w * step * c->friction[i];
        moved = ancf_larger(moved, fabs(v[i] - c->without[i]));
    }
    c->change[0] = c->change[1] = c->change[2] = 0.0;
    if (moved <= tolerance * c->own * largest) return 0.0;
    memcpy(c->without, v, sizeof v);
    const double speed = sqrt(ancf_dot(v, v));
    const double coefficient = coefficient_left(c, speed, w * c->impulse, sweep);
    const double force = coefficient * c->impulse / step;
    for (int i = 0; i < 3; i++) {
        const double friction = speed > 0.0 ? -force * (v[i] / speed) : 0.0;
        change[i] = step * (friction - c->friction[i]);
        c->friction[i] = friction;
    }
    rub(t, c, change, step);
    memcpy(c->change, change, sizeof change);
    return ancf_dot(change, change);
}

// How much of its last change is still to come for a contact whose last two changes are terms of a geometric series; 0
// where they are not.
static double to_come(const ancf_contact* c) {
    const double before = ancf_dot(c->former, c->former), both = ancf_dot(c->former, c->change),
                 now = ancf_dot(c->change, c->change);
    if (!(both > 0.0) || both > slowest * before || now * before - both * both > misfit * misfit * now * before)
        return 0.0;
    return both / (before - both);
}

// Lets frictions of a group go to where the last two sweeps lead, as far as friction can be. False: they lead nowhere.
static bool lead_on(ancf_table* t, const ancf_contact_group* g, double step) {
    bool led = false;
    for (int k = g->first[ANCF_CONTACTS]; k < g->end[ANCF_CONTACTS]; ++k) {
        ancf_contact* c = &t->contact[t->groups.list[ANCF_CONTACTS][k]];
        const double more = rubs(c) ? to_come(c) : 0.0;
        if (more == 0.0) continue;
        double wanted[3], P[3];
        for (int i = 0; i < 3; i++) wanted[i] = step * c->friction[i] + more * c->change[i];
        const double bound = most_of(c), size = sqrt(ancf_dot(wanted, wanted)),
                     kept = size > bound ? bound / size : 1.0;
        for (int i = 0; i < 3; i++) {
            P[i] = kept * wanted[i] - step * c->friction[i];
            c->friction[i] = kept * wanted[i] / step;
        }
        rub(t, c, P, step);
        c->without[0] = INFINITY; // solved again
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

// Starts from the guess, in the tangent plane and no larger than friction can be. Returns that bound [N s].
static double start(ancf_table* t, ancf_contact* c, double step) {
    project(c->friction, c->normal);
    const double bound = most_of(c);
    const double size = step * sqrt(ancf_dot(c->friction, c->friction)), part = size > bound ? bound / size : 1.0;
    double P[3];
    for (int i = 0; i < 3; i++) {
        c->friction[i] *= rubs(c) ? part : 0.0;
        P[i] = step * (c->friction[i] - c->guess[i]);
    }
    rub(t, c, P, step);
    if (!rubs(c)) return 0.0;
    c->own = across(t, c);
    c->change[0] = c->change[1] = c->change[2] = 0.0;
    c->without[0] = c->without[1] = c->without[2] = INFINITY; // solved once at least
    return bound;
}

// Friction of what presses in a group. Returns the number of sweeps.
static int rub_group(ancf_table* t, const ancf_contact_group* g, double step, double* left) {
    const int *contact = t->groups.list[ANCF_CONTACTS], first = g->first[ANCF_CONTACTS], end = g->end[ANCF_CONTACTS];
    double largest = 0.0, change = 0.0;
    for (int k = first; k < end; ++k) largest = ancf_larger(largest, start(t, &t->contact[contact[k]], step));
    double last = INFINITY;             // change when it was led on
    int sweep = 0, since = 0, wait = 3; // sweeps since then, and until next; longer where it did not help
    while (largest > 0.0 && sweep < SWEEPS_MAX) {
        change = 0.0;
        ++sweep;
        for (int k = first; k < end; ++k) {
            ancf_contact* c = &t->contact[contact[k]];
            if (!rubs(c)) continue;
            memcpy(c->former, c->change, sizeof c->former);
            change = ancf_larger(change, rub_one(t, c, step, largest, sweep));
        }
        if (change <= tolerance * tolerance * largest * largest) break;
        if (++since < wait || sweep == SWEEPS_MAX || !lead_on(t, g, step)) continue;
        if (change > 0.25 * last) wait *= 2;
        last = change;
        since = 0;
    }
    if (largest > 0.0) *left = ancf_larger(*left, sqrt(change) / largest);
    return sweep;
}

// Velocities less their means over the step, as normal forces act in the course of it.
static void find_lags(ancf_table* t, double step) {
    for (int i = 0; i < t->n_places; ++i) memset(t->place[i].lag, 0, sizeof t->place[i].lag);
    for (int i = 0; i < t->n_places; ++i) {
        const ancf_place* p = &t->place[i];
        double late[3];
        for (int c = 0; c < 3; c++) late[c] = p->impulse[c] - p->moment[c] / step;
        if (late[0] == 0.0 && late[1] == 0.0 && late[2] == 0.0) continue;
        for (int k = t->first[i]; k < t->first[i + 1]; ++k) {
            double* lag = t->place[t->other[k]].lag;
            for (int c = 0; c < 3; c++) {
                lag[c] += t->effect[k] * late[c];
                lag[3 + c] += t->bend[k].to * late[c];
            }
        }
    }
    for (int i = 0; i < t->n_bodies; ++i) {
        ancf_body* b = &t->body[i];
        for (int c = 0; c < 3; c++) {
            b->lag[c] = b->velocity[c] - b->before[c] - b->shift[c] / step;
            b->lag[3 + c] = b->spin[c] - b->before[3 + c] - b->turn[c] / step;
        }
    }
}

static void swap(double a[3], double b[3]) {
    for (int c = 0; c < 3; c++) {
        const double kept = a[c];
        a[c] = b[c];
        b[c] = kept;
    }
}

static void swap_lags(ancf_table* t) {
    for (int i = 0; i < t->n_places; ++i) {
        swap(t->place[i].velocity, t->place[i].lag);
        swap(t->place[i].bending, t->place[i].lag + 3);
    }
    for (int i = 0; i < t->n_bodies; ++i) {
        swap(t->body[i].velocity, t->body[i].lag);
        swap(t->body[i].spin, t->body[i].lag + 3);
    }
}

// Slips of the lags, with which those of the velocities are too large.
static void slip_lags(ancf_table* t, double step) {
    find_lags(t, step);
    swap_lags(t);
    for (int i = 0; i < t->groups.contacts; ++i) {
        ancf_contact* c = &t->contact[t->groups.list[ANCF_CONTACTS][i]];
        slip_of(c->lag, t, c);
    }
    swap_lags(t);
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
    slip_lags(t, step);
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
