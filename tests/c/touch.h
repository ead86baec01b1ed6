// Scenes of contacts for the tests: vectors, bodies of known mass and inertia, momenta and energies of cable and
// bodies.
#ifndef ANCF_TEST_TOUCH_H
#define ANCF_TEST_TOUCH_H

#include "build.h"

#include "ancf/contact.h"

static inline double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static inline double norm(const double a[3]) { return sqrt(dot(a, a)); }

static inline void cross(double c[3], const double a[3], const double b[3]) {
    for (int i = 0; i < 3; ++i) c[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

static inline void random_vector(double v[3], uint64_t* seed, double size) {
    for (int i = 0; i < 3; ++i) v[i] = random_between(seed, -size, size);
}

static inline void random_direction(double n[3], uint64_t* seed) {
    double length;
    do {
        random_vector(n, seed, 1.0);
        length = norm(n);
    } while (length < 0.1 || length > 1.0);
    for (int i = 0; i < 3; ++i) n[i] /= length;
}

// Solves A x = b (n x n), partial pivoting; A and b are used up.
static inline void dense_solve(double* x, double* A, double* b, int n) {
    for (int j = 0; j < n; ++j) {
        int best = j;
        for (int i = j + 1; i < n; ++i)
            if (fabs(A[i * n + j]) > fabs(A[best * n + j])) best = i;
        for (int k = 0; k < n; ++k) {
            const double swap = A[j * n + k];
            A[j * n + k] = A[best * n + k];
            A[best * n + k] = swap;
        }
        const double swap = b[j];
        b[j] = b[best];
        b[best] = swap;
        for (int i = j + 1; i < n; ++i) {
            const double factor = A[i * n + j] / A[j * n + j];
            for (int k = j; k < n; ++k) A[i * n + k] -= factor * A[j * n + k];
            b[i] -= factor * b[j];
        }
    }
    for (int i = n - 1; i >= 0; --i) {
        x[i] = b[i];
        for (int k = i + 1; k < n; ++k) x[i] -= A[i * n + k] * x[k];
        x[i] /= A[i * n + i];
    }
}

// A body whose mass and inertia the test knows. mass 0: it stands still, or a knot carries it.
typedef struct {
    ancf_body body;
    double mass, inertia[9];
} solid;

// Principal moments 1, 2 and 2.5 times `inertia` about axes that lie anyhow.
static inline solid random_solid(uint64_t* seed, double mass, double inertia) {
    solid s = {.mass = mass};
    const double moment[3] = {inertia, 2.0 * inertia, 2.5 * inertia};
    double axis[3][3], along;
    random_direction(axis[0], seed);
    random_direction(axis[1], seed);
    along = dot(axis[0], axis[1]);
    for (int i = 0; i < 3; ++i) axis[1][i] -= along * axis[0][i];
    along = norm(axis[1]);
    for (int i = 0; i < 3; ++i) axis[1][i] /= along;
    cross(axis[2], axis[0], axis[1]);
    for (int i = 0; i < 3; ++i) {
        s.body.inv_mass[i] = mass > 0.0 ? 1.0 / mass : 0.0;
        for (int j = 0; j < 3; ++j)
            for (int k = 0; k < 3 && inertia > 0.0; ++k) {
                s.inertia[3 * i + j] += moment[k] * axis[k][i] * axis[k][j];
                s.body.inv_inertia[3 * i + j] += axis[k][i] * axis[k][j] / moment[k];
            }
    }
    return s;
}

// The velocities of now, and behind them an empty field of displacements; to be freed.
static inline double* velocity_before(const built* b) {
    const size_t n = 3 * (size_t)b->stride;
    double* before = calloc(2 * n, sizeof *before);
    memcpy(before, b->v, n * sizeof *before);
    return before;
}

static inline void body_point_velocity(double v[3], const ancf_body* b, const double arm[3]) {
    cross(v, b->spin, arm);
    for (int i = 0; i < 3; ++i) v[i] += b->velocity[i];
}

// Adds a body's momenta about the origin, and the magnitudes of their terms.
static inline void add_momentum(double P[3], double H[3], double terms[2], const solid* s, const ancf_body* b) {
    double l[3];
    cross(l, b->position, b->velocity);
    for (int i = 0; i < 3; ++i) {
        const double turn = dot(s->inertia + 3 * i, b->spin);
        P[i] += s->mass * b->velocity[i];
        H[i] += s->mass * l[i] + turn;
        terms[0] += fabs(s->mass * b->velocity[i]);
        terms[1] += s->mass * norm(b->position) * norm(b->velocity) + fabs(turn);
    }
}

static inline double kinetic_of_solid(const solid* s, const ancf_body* b) {
    double sum = s->mass * dot(b->velocity, b->velocity);
    for (int i = 0; i < 3; ++i) sum += b->spin[i] * dot(s->inertia + 3 * i, b->spin);
    return 0.5 * sum;
}

// Kinetic energy of the cable with its added masses, at a field of velocities.
static inline double kinetic_of_field(const built* b, const double* v) {
    double sum = 0.0;
    for (int e = 0; e < b->def.n_elements; ++e) {
        double M[4][4];
        int dof[4];
        own_mass(M, &b->element[e]);
        ancf_model_dofs(dof, b->m, e);
        for (int c = 0; c < 3; ++c)
            for (int i = 0; i < 4; ++i)
                for (int j = 0; j < 4; ++j)
                    sum += 0.5 * M[i][j] * v[c * b->stride + dof[i]] * v[c * b->stride + dof[j]];
    }
    for (int c = 0; c < 3; ++c)
        for (int i = 0; i < b->def.n_nodes; ++i) sum += 0.5 * b->mass[i] * pow(v[c * b->stride + i], 2.0);
    return sum;
}

// An element's unknowns weighed at xi (Eq. 3-4), written here again.
static inline void own_weights(double S[4], const ancf_element* el, double xi) {
    const double x2 = xi * xi, x3 = x2 * xi;
    S[0] = 1.0 - 3.0 * x2 + 2.0 * x3;
    S[1] = el->length * (xi - 2.0 * x2 + x3);
    S[2] = 3.0 * x2 - 2.0 * x3;
    S[3] = el->length * (x3 - x2);
}

static inline void own_at(double u[3], const built* b, const double* field, int element, double xi) {
    double S[4];
    int dof[4];
    own_weights(S, &b->element[element], xi);
    ancf_model_dofs(dof, b->m, element);
    for (int c = 0; c < 3; ++c) {
        u[c] = 0.0;
        for (int i = 0; i < 4; ++i) u[c] += S[i] * field[c * b->stride + dof[i]];
    }
}

// Adds to a field of velocities what an impulse at a place does: S^T J through the mass matrix, not through responses.
static inline void own_kick(const built* b, double* v, int element, double xi, const double J[3]) {
    double S[4];
    int dof[4];
    double* force = calloc(6 * (size_t)b->stride, sizeof *force);
    double* answer = force + 3 * b->stride;
    own_weights(S, &b->element[element], xi);
    ancf_model_dofs(dof, b->m, element);
    for (int c = 0; c < 3; ++c)
        for (int i = 0; i < 4; ++i) force[c * b->stride + dof[i]] = S[i] * J[c];
    ancf_model_join(b->m, force);
    ancf_mass_solve(b->m, answer, force);
    for (int i = 0; i < 3 * b->stride; ++i) v[i] += answer[i];
    free(force);
}

static inline void own_kick_body(ancf_body* b, const double arm[3], const double J[3]) {
    double twist[3];
    cross(twist, arm, J);
    const double guided = dot(b->along, J);
    for (int i = 0; i < 3; ++i) {
        b->velocity[i] += b->inv_mass[i] * J[i] + guided * b->along[i];
        b->spin[i] += dot(b->inv_inertia + 3 * i, twist);
    }
}

// Relative velocity of a contact's sides from a field and bodies as they are.
static inline void own_slip(double u[3], const built* b, ancf_table* t, const ancf_contact* c, const double* v,
                            const ancf_body* bodies) {
    for (int i = 0; i < 3; ++i) u[i] = 0.0;
    for (int s = 0; s < 2; ++s) {
        const ancf_side* side = &c->side[s];
        double w[3];
        if (side->place >= 0) {
            const ancf_place* p = ancf_table_place(t, side->place);
            own_at(w, b, v, p->element, p->xi);
            for (int i = 0; i < 3; ++i) u[i] += s ? -w[i] : w[i];
        }
        if (side->body >= 0) {
            body_point_velocity(w, &bodies[side->body], side->arm);
            for (int i = 0; i < 3; ++i) u[i] += s ? -w[i] : w[i];
        }
    }
}

// Gives impulses J (n x 3) to the contacts' sides, on a field and bodies.
static inline void own_give(const built* b, ancf_table* t, double* v, ancf_body* bodies, int n, double (*J)[3]) {
    for (int k = 0; k < n; ++k)
        for (int s = 0; s < 2; ++s) {
            const ancf_side* side = &ancf_table_contact(t, k)->side[s];
            const double sign = s ? -1.0 : 1.0, P[3] = {sign * J[k][0], sign * J[k][1], sign * J[k][2]};
            if (side->place >= 0) {
                const ancf_place* p = ancf_table_place(t, side->place);
                own_kick(b, v, p->element, p->xi, P);
            }
            if (side->body >= 0) own_kick_body(&bodies[side->body], side->arm, P);
        }
}

// Positions after a step without elasticity.
static inline void own_drift(const built* b, double step, const double* shift) {
    for (int i = 0; i < 3 * b->stride; ++i) b->x[i] += step * b->v[i] + (shift ? shift[i] : 0.0);
}

#endif
