// Knots that go on together with points of bodies.
#include "table.h"

#include <math.h>

enum { ROUNDS = 200 };

static const double tolerance = 1e-14; // of what is missing, as part of what was
static const double rounding = 1e-14;  // of velocities: what is missing cannot be told any more

typedef double (*vectors)[3];

// What is missing: velocity of the body's point, with what its turning adds, less that of the knot.
static void miss(const ancf_table* t, const ancf_coupling* c, double v[3]) {
    ancf_body_velocity(v, &t->body[c->body], c->arm);
    const double* knot = t->place[c->place].velocity;
    for (int i = 0; i < 3; i++) v[i] += c->ahead[i] - knot[i];
}

static void give(ancf_table* t, const ancf_coupling* c, const double impulse[3], double rest) {
    const double back[3] = {-impulse[0], -impulse[1], -impulse[2]};
    ancf_table_kick_place(t, c->place, impulse, rest);
    ancf_table_kick_body(t, c->body, c->arm, back, rest);
}

// Response of a coupling to an impulse on itself: (w + M^-1 - [a] I^-1 [a]) p, solved for p.
static void solve_own(double p[3], const ancf_table* t, const ancf_coupling* c, const double v[3]) {
    const ancf_body* b = &t->body[c->body];
    double A[3][3];
    for (int j = 0; j < 3; j++) {
        double e[3] = {0.0, 0.0, 0.0}, twist[3], spin[3], column[3];
        e[j] = 1.0;
        ancf_cross(twist, c->arm, e);
        ancf_multiply(spin, b->inv_inertia, twist);
        ancf_cross(column, spin, c->arm);
        for (int i = 0; i < 3; i++) A[i][j] = column[i] + b->along[i] * b->along[j];
        A[j][j] += b->inv_mass[j] + t->place[c->place].compliance;
    }
    double cof[3], det = 0.0;
    for (int j = 0; j < 3; j++) {
        const int k = (j + 1) % 3, l = (j + 2) % 3;
        cof[j] = A[1][k] * A[2][l] - A[1][l] * A[2][k];
        det += A[0][j] * cof[j];
    }
    for (int i = 0; i < 3; i++) { // Cramer; A is symmetric
        const int k = (i + 1) % 3, l = (i + 2) % 3;
        double sum = 0.0;
        for (int j = 0; j < 3; j++) {
            const int m = (j + 1) % 3, n = (j + 2) % 3;
            sum += (A[k][m] * A[l][n] - A[k][n] * A[l][m]) * v[j];
        }
        p[i] = det > 0.0 ? sum / det : 0.0;
    }
}

static double inner(vectors a, vectors b, int n) {
    double sum = 0.0;
    for (int i = 0; i < n; ++i) sum += ancf_dot(a[i], b[i]);
    return sum;
}

static void give_all(ancf_table* t, vectors impulse, double factor, double rest) {
    for (int i = 0; i < t->n_couplings; ++i) {
        ancf_coupling* c = &t->coupling[i];
        double P[3];
        for (int k = 0; k < 3; k++) {
            P[k] = factor * impulse[i][k];
            c->impulse[k] += P[k];
        }
        give(t, c, P, rest);
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

// Conjugate gradients, every coupling's own response as the preconditioner. The product with the matrix is what a kick
// changes: it is given, looked at, and lengthened to the right size.
void ancf_table_couple(ancf_table* t, double rest) {
    const int n = t->n_couplings;
    if (n == 0) return;
    vectors r = t->scratch, z = r + n, p = z + n, changed = p + n;
    for (int i = 0; i < n; ++i) {
        miss(t, &t->coupling[i], r[i]);
        solve_own(p[i], t, &t->coupling[i], r[i]);
    }
    const double enough = fmax(tolerance * tolerance * inner(r, r, n), noise(t));
    if (inner(r, r, n) <= enough) return;
    double product = inner(r, p, n);
    for (int round = 0; round < ROUNDS && product > 0.0; ++round) {
        give_all(t, p, 1.0, rest);
        for (int i = 0; i < n; ++i) {
            miss(t, &t->coupling[i], changed[i]);
            for (int k = 0; k < 3; k++) changed[i][k] = r[i][k] - changed[i][k];
        }
        const double curvature = inner(p, changed, n), length = curvature > 0.0 ? product / curvature : 0.0;
        give_all(t, p, length - 1.0, rest);
        for (int i = 0; i < n; ++i) {
            miss(t, &t->coupling[i], r[i]);
            solve_own(z[i], t, &t->coupling[i], r[i]);
        }
        if (inner(r, r, n) <= enough) return;
        const double next = inner(r, z, n), part = next / product;
        for (int i = 0; i < n; ++i)
            for (int k = 0; k < 3; k++) p[i][k] = z[i][k] + part * p[i][k];
        product = next;
    }
}
