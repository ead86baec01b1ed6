#include "ancf/contact.h"

#include "internal.h"

#include <math.h>

// A warm start leaves changes of 1e-3 and less, which a sweep shortens by a twentieth where many contacts share few
// unknowns: more sweeps buy little that the next step does not. On Stribeck's falling branch neighbours can free and
// catch each other without end; they would take any number.
enum { SWEEPS_MAX = 6 };

// Part of the largest friction force below which a sweep's changes end the solve.
static const double tolerance = 1e-8;

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static void cross(double c[3], const double a[3], const double b[3]) {
    c[0] = a[1] * b[2] - a[2] * b[1];
    c[1] = a[2] * b[0] - a[0] * b[2];
    c[2] = a[0] * b[1] - a[1] * b[0];
}

static void multiply(double y[3], const double A[9], const double x[3]) {
    for (int i = 0; i < 3; i++) y[i] = dot(A + 3 * i, x);
}

static void project(double v[3], const double normal[3]) {
    const double along = dot(v, normal);
    for (int i = 0; i < 3; i++) v[i] -= along * normal[i];
}

void ancf_point_place(ancf_point* point, const ancf_model* m, int element, double xi) {
    point->element = element;
    point->xi = xi;
    ancf_model_dofs(point->place, m, element);
    ancf_model_weights(point->S, m, element, xi);
}

void ancf_points_motion(double* position, double* velocity, const ancf_model* m, const ancf_point* point, int n) {
    for (int k = 0; k < n; ++k) {
        ancf_point_at(position + 3 * k, m, m->x, &point[k]);
        ancf_point_at(velocity + 3 * k, m, m->v, &point[k]);
    }
}

// Friction acts at the cable's centreline, on both sides (Eq. 12-16).
static void lever(double arm[3], const ancf_model* m, const ancf_contact* c) {
    ancf_point_at(arm, m, m->x, c->point);
    for (int i = 0; i < 3; i++) arm[i] -= c->partner->position[i];
}

static void kick_point(const ancf_model* m, double* velocity, const ancf_point* point, const double impulse[3]) {
    for (int k = 0; k < point->n; k++) {
        double* v = velocity + point->dof[k];
        const double dv = point->dv[k];
        v[0] += dv * impulse[0];
        v[m->stride] += dv * impulse[1];
        v[2 * m->stride] += dv * impulse[2];
    }
}

static void kick_partner(ancf_partner* p, const double arm[3], const double impulse[3]) {
    double moment[3], turn[3];
    cross(moment, arm, impulse);
    multiply(turn, p->inv_inertia, moment);
    const double guided = dot(p->along, impulse);
    for (int i = 0; i < 3; i++) {
        p->velocity[i] += p->inv_mass[i] * impulse[i] + guided * p->along[i];
        p->spin[i] += turn[i];
    }
}

// Gives the impulse to the cable and its opposite to the other side.
static void kick(const ancf_model* m, const ancf_contact* c, const double arm[3], const double impulse[3],
                 double* velocity) {
    const double back[3] = {-impulse[0], -impulse[1], -impulse[2]};
    kick_point(m, velocity, c->point, impulse);
    if (c->other) kick_point(m, velocity, c->other, back);
    if (c->partner) kick_partner(c->partner, arm, back);
}

static void relative_velocity(double v[3], const ancf_model* m, const ancf_contact* c, const double arm[3],
                              const double* velocity) {
    double u[3];
    ancf_point_at(v, m, velocity, c->point);
    if (c->other) {
        ancf_point_at(u, m, velocity, c->other);
        for (int i = 0; i < 3; i++) v[i] -= u[i];
    }
    if (c->partner) {
        cross(u, c->partner->spin, arm);
        for (int i = 0; i < 3; i++) v[i] -= u[i] + c->partner->velocity[i];
    }
}

// Mean over the tangent plane of a body's response at the point, half the trace of P (M^-1 - [a] I^-1 [a]) P [1/kg].
static double partner_compliance(const ancf_partner* p, const double arm[3], const double normal[3]) {
    const double *J = p->inv_inertia, *a = arm;
    double side[3], turn[3], trace = 0.0;
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        trace += p->inv_mass[i] * (1.0 - normal[i] * normal[i]);
        trace += J[4 * i] * (a[j] * a[j] + a[k] * a[k]);
        trace -= (J[3 * i + j] + J[3 * j + i]) * a[i] * a[j];
    }
    cross(side, arm, normal);
    multiply(turn, J, side);
    const double raised = dot(p->along, normal);
    trace += dot(p->along, p->along) - raised * raised;
    return 0.5 * (trace - dot(side, turn));
}

// Effective inverse mass [1/kg]. It need not be exact: friction that solves the equation does so with any (relax).
static double compliance(const ancf_contact* c, const double arm[3]) {
    double w = c->point->compliance;
    if (c->other) w += c->other->compliance;
    if (c->partner) w += partner_compliance(c->partner, arm, c->normal);
    return w;
}

// Response of a body at the point along the normal [1/kg].
static double partner_along(const ancf_partner* p, const double arm[3], const double normal[3]) {
    double side[3], turn[3];
    cross(side, arm, normal);
    multiply(turn, p->inv_inertia, side);
    const double guided = dot(p->along, normal);
    double w = dot(side, turn) + guided * guided;
    for (int i = 0; i < 3; i++) w += p->inv_mass[i] * normal[i] * normal[i];
    return w;
}

static bool touches(const ancf_contact* c) { return c->normal_force > 0.0; }

// Puts one contact's dashpot right while all else stays: d = c rate at the rate that is left, but the contact does not
// pull. Returns the square of its change [N2].
static double damp(const ancf_model* m, ancf_contact* c, double dt, double* velocity) {
    double arm[3] = {0.0, 0.0, 0.0}, v[3], impulse[3];
    if (c->partner) lever(arm, m, c);
    relative_velocity(v, m, c, arm, velocity);
    double w = c->point->compliance + (c->other ? c->other->compliance : 0.0);
    if (c->partner) w += partner_along(c->partner, arm, c->normal);
    const double rate = w * dt * c->damping_force - dot(v, c->normal); // without its own part
    const double force = fmax(c->normal_damping * rate / (1.0 + w * dt * c->normal_damping), -c->normal_force);
    const double change = force - c->damping_force;
    for (int i = 0; i < 3; i++) impulse[i] = dt * change * c->normal[i];
    c->damping_force = force;
    kick(m, c, arm, impulse, velocity);
    return change * change;
}

// Puts one contact's friction right while the others' stay; returns the square of its change [N2]. Its own part
// w f dt is taken off the velocity, the scalar equation solved along what is left, and the new part put on: where
// nothing changes any more, f belongs to the true velocity, even if w was only near the response in that direction.
static double rub(const ancf_model* m, ancf_contact* c, double dt, double* velocity) {
    double arm[3] = {0.0, 0.0, 0.0}, v[3], change[3], impulse[3];
    const double normal_force = c->normal_force + c->damping_force;
    if (c->partner) lever(arm, m, c);
    relative_velocity(v, m, c, arm, velocity);
    project(v, c->normal);
    const double w = compliance(c, arm);
    for (int i = 0; i < 3; i++) v[i] -= w * dt * c->friction[i];
    const double speed = sqrt(dot(v, v));
    const double left = ancf_friction_solve(c->law, speed, w * dt * normal_force);
    const double force = ancf_friction_coefficient(c->law, left) * normal_force;
    for (int i = 0; i < 3; i++) {
        const double friction = speed > 0.0 ? -force * (v[i] / speed) : 0.0;
        change[i] = friction - c->friction[i];
        impulse[i] = dt * change[i];
        c->friction[i] = friction;
    }
    kick(m, c, arm, impulse, velocity);
    return dot(change, change);
}

// Starts from the guess: friction in the tangent plane, and a dashpot. Returns the size of its forces [N].
static double start(const ancf_model* m, ancf_contact* c, double dt, double* velocity) {
    double arm[3] = {0.0, 0.0, 0.0}, impulse[3];
    project(c->friction, c->normal);
    if (!touches(c) || c->law->kind == ANCF_FRICTION_NONE) c->friction[0] = c->friction[1] = c->friction[2] = 0.0;
    if (!touches(c) || c->normal_damping == 0.0) c->damping_force = 0.0;
    for (int i = 0; i < 3; i++) impulse[i] = dt * (c->friction[i] + c->damping_force * c->normal[i]);
    if (c->partner) lever(arm, m, c);
    kick(m, c, arm, impulse, velocity);
    return fmax(fmax(c->law->mu_s, c->law->mu_k), c->normal_damping > 0.0 ? 1.0 : 0.0) * c->normal_force;
}

static double relax(const ancf_model* m, ancf_contact* c, double dt, double* velocity) {
    double change = 0.0;
    if (!touches(c)) return 0.0;
    if (c->normal_damping > 0.0) change = damp(m, c, dt, velocity);
    if (c->law->kind != ANCF_FRICTION_NONE) change = fmax(change, rub(m, c, dt, velocity));
    return change;
}

int ancf_contact_solve(const ancf_model* m, ancf_contact* table, int n, double dt, double* velocity) {
    double largest = 0.0;
    for (int i = 0; i < n; i++) largest = fmax(largest, start(m, &table[i], dt, velocity));
    const double enough = tolerance * tolerance * largest * largest;
    for (int sweep = 1; sweep <= SWEEPS_MAX; sweep++) {
        double change = 0.0;
        for (int i = 0; i < n; i++) change = fmax(change, relax(m, &table[i], dt, velocity));
        if (change <= enough) return sweep;
    }
    return SWEEPS_MAX;
}
