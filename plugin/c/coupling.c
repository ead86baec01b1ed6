// Knots that go on together with points of bodies: conjugate gradients on the impulses between them. What these do to
// the knots comes from the sparse factor of the mass matrix if there are many, else from what places do to one another;
// only what is found is given to the table.
#include "factor.h"
#include "slide.h"
#include "table.h"

#include <math.h>
#include <string.h>

enum { ROUNDS = 200, PASSES = 3 };

static const double tolerance = 1e-14; // of what is missing, as part of what was
static const double rounding = 1e-14;  // of velocities: what is missing cannot be told any more

typedef double (*vectors)[3];

// What is missing: velocity of the body's point, with what its turning adds, less that of the knot.
static void miss(const ancf_table* t, const ancf_coupling* c, double v[3]) {
    ancf_body_velocity(v, &t->body[c->body], c->arm);
    const double* knot = t->place[c->place].velocity;
    for (int i = 0; i < 3; i++) v[i] += c->ahead[i] - knot[i];
}

static int knot_of(const ancf_table* t, const ancf_coupling* c) {
    const ancf_place* p = &t->place[c->place];
    return p->dof[p->xi > 0.5 ? 2 : 0];
}

static void push(const ancf_table* t, int place, const double impulse[3]) {
    for (int e = t->first[place]; e < t->first[place + 1]; ++e)
        for (int k = 0; k < 3; k++) t->place[t->other[e]].pushed[k] += t->effect[e] * impulse[k];
}

// Velocities of the knots by impulses on all of them, by what places do to one another.
static void answer_of_places(vectors v, const ancf_table* t, vectors impulse) {
    const int n = t->n_couplings, slides = t->slides < 0 ? 0 : t->model->n_slides;
    for (int i = 0; i < n; ++i) memset(t->place[t->coupling[i].place].pushed, 0, sizeof t->place->pushed);
    for (int i = 0; i < slides; ++i) memset(t->place[t->slides + i].pushed, 0, sizeof t->place->pushed);
    for (int i = 0; i < n; ++i) push(t, t->coupling[i].place, impulse[i]);
    for (int i = 0; i < slides; ++i) memcpy(t->hold[slides + i], t->place[t->slides + i].pushed, sizeof *t->hold);
    if (slides > 0) ancf_slides_hold(t->hold, t->model, t->hold + slides);
    for (int i = 0; i < slides; ++i) push(t, t->slides + i, t->hold[i]);
    for (int i = 0; i < n; ++i) memcpy(v[i], t->place[t->coupling[i].place].pushed, sizeof v[i]);
}

// The same by the factor; each knot carries one body.
static void answer_of_knots(vectors v, const ancf_table* t, vectors impulse) {
    const ancf_mass* mass = t->model->mass;
    const int n = t->n_couplings;
    if (!mass->diagonal && mass->n > 0) memset(mass->rhs, 0, (size_t)mass->n * sizeof *mass->rhs);
    for (int i = 0; i < n; ++i) {
        const int knot = knot_of(t, &t->coupling[i]), row = mass->row[knot];
        for (int k = 0; k < 3; k++) {
            if (mass->diagonal) v[i][k] = mass->inverse[knot] * impulse[i][k];
            else if (row >= 0) mass->rhs[row][k] = impulse[i][k];
        }
    }
    if (mass->diagonal) return;
    ancf_mass_solve_rows(mass);
    for (int i = 0; i < n; ++i) {
        const int row = mass->row[knot_of(t, &t->coupling[i])];
        for (int k = 0; k < 3; k++) v[i][k] = row >= 0 ? mass->rhs[row][k] : 0.0;
    }
}

// By how much impulses between knots and bodies change what is missing, less of it being more.
static void change(vectors less, const ancf_table* t, vectors impulse) {
    if (t->factored) answer_of_knots(less, t, impulse);
    else answer_of_places(less, t, impulse);
    for (int i = 0; i < t->n_couplings; ++i) memset(t->body[t->coupling[i].body].pushed, 0, sizeof t->body->pushed);
    for (int i = 0; i < t->n_couplings; ++i) {
        const ancf_coupling* c = &t->coupling[i];
        ancf_body* b = &t->body[c->body];
        double twist[3], answer[6];
        ancf_cross(twist, c->arm, impulse[i]);
        ancf_body_answer(answer, b, impulse[i], twist);
        for (int k = 0; k < 6; k++) b->pushed[k] += answer[k];
    }
    for (int i = 0; i < t->n_couplings; ++i) {
        const ancf_coupling* c = &t->coupling[i];
        const double* v = t->body[c->body].pushed;
        double turned[3];
        ancf_cross(turned, v + 3, c->arm);
        for (int k = 0; k < 3; k++) less[i][k] += v[k] + turned[k];
    }
}

// Inverse of the response of a coupling to an impulse on itself, w + M^-1 - [a] I^-1 [a]: rows. 0 where none.
static void invert_own(double inverse[3][3], const ancf_table* t, const ancf_coupling* c) {
    const ancf_body* b = &t->body[c->body];
    double A[3][3], det = 0.0;
    for (int j = 0; j < 3; j++) {
        double e[3] = {0.0, 0.0, 0.0}, twist[3], spin[3], column[3];
        e[j] = 1.0;
        ancf_cross(twist, c->arm, e);
        ancf_multiply(spin, b->inv_inertia, twist);
        ancf_cross(column, spin, c->arm);
        for (int i = 0; i < 3; i++) A[i][j] = column[i] + b->along[i] * b->along[j];
        A[j][j] += b->inv_mass[j] + t->place[c->place].compliance;
    }
    for (int i = 0; i < 3; i++) // Cramer; A is symmetric
        for (int j = 0; j < 3; j++) {
            const int k = (i + 1) % 3, l = (i + 2) % 3, m = (j + 1) % 3, n = (j + 2) % 3;
            inverse[i][j] = A[k][m] * A[l][n] - A[k][n] * A[l][m];
        }
    for (int j = 0; j < 3; j++) det += A[0][j] * inverse[0][j];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) inverse[i][j] = det > 0.0 ? inverse[i][j] / det : 0.0;
}

static void solve_own(double p[3], vectors inverse, const double v[3]) {
    for (int i = 0; i < 3; i++) p[i] = ancf_dot(inverse[i], v);
}

static double inner(vectors a, vectors b, int n) {
    double sum = 0.0;
    for (int i = 0; i < n; ++i) sum += ancf_dot(a[i], b[i]);
    return sum;
}

static void give_all(ancf_table* t, vectors impulse, vectors answer, double rest) {
    if (t->alone) answer_of_knots(answer, t, impulse);
    for (int i = 0; i < t->n_couplings; ++i) {
        ancf_coupling* c = &t->coupling[i];
        const double back[3] = {-impulse[i][0], -impulse[i][1], -impulse[i][2]};
        ancf_table_kick_place(t, c->place, impulse[i], rest);
        ancf_table_kick_body(t, c->body, c->arm, back, rest);
        for (int k = 0; k < 3; k++) {
            c->impulse[k] += impulse[i][k];
            if (t->alone) t->place[c->place].velocity[k] += answer[i][k];
        }
    }
}

// Square of what is missing where it cannot be told from rounding.
static double noise(const ancf_table* t) {
    double sum = 0.0;
    for (int i = 0; i < t->n_couplings; ++i) {
        const ancf_coupling* c = &t->coupling[i];
        const ancf_body* b = &t->body[c->body];
        const double *v = b->velocity, *w = b->spin, *knot = t->place[c->place].velocity;
        sum += ancf_dot(v, v) + ancf_dot(w, w) * ancf_dot(c->arm, c->arm) + ancf_dot(knot, knot) +
               ancf_dot(c->ahead, c->ahead);
    }
    return rounding * rounding * sum;
}

// Conjugate gradients, every coupling's own response as the preconditioner. Adds to `impulse` what makes up for r.
static void solve_all(vectors impulse, const ancf_table* t, vectors r, vectors p, vectors other, vectors own,
                      double enough) {
    const int n = t->n_couplings;
    for (int i = 0; i < n; ++i) solve_own(p[i], own + 3 * i, r[i]);
    double product = inner(r, p, n);
    for (int round = 0; round < ROUNDS && product > 0.0; ++round) {
        change(other, t, p);
        const double curvature = inner(p, other, n), length = curvature > 0.0 ? product / curvature : 0.0;
        for (int i = 0; i < n; ++i)
            for (int k = 0; k < 3; k++) {
                impulse[i][k] += length * p[i][k];
                r[i][k] -= length * other[i][k];
            }
        if (!(length > 0.0) || inner(r, r, n) <= enough) return;
        for (int i = 0; i < n; ++i) solve_own(other[i], own + 3 * i, r[i]);
        const double next = inner(r, other, n), part = next / product;
        for (int i = 0; i < n; ++i)
            for (int k = 0; k < 3; k++) p[i][k] = other[i][k] + part * p[i][k];
        product = next;
    }
}

void ancf_table_couple(ancf_table* t, double rest) {
    const int n = t->n_couplings;
    if (n == 0) return;
    vectors r = t->scratch, p = r + n, other = p + n, impulse = other + n, own = impulse + n;
    double enough = INFINITY;
    for (int i = 0; i < n; ++i) invert_own(own + 3 * i, t, &t->coupling[i]);
    for (int pass = 0; pass < PASSES; ++pass) { // more than one where rounding has let r drift
        for (int i = 0; i < n; ++i) miss(t, &t->coupling[i], r[i]);
        const double missing = inner(r, r, n);
        if (pass == 0) enough = fmax(tolerance * tolerance * missing, noise(t));
        if (missing <= enough) return;
        memset(impulse, 0, (size_t)n * sizeof *impulse);
        solve_all(impulse, t, r, p, other, own, enough);
        give_all(t, impulse, other, rest);
    }
}
