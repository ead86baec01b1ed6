// With F(v) what the laws give at slips v, friction is P = F(v0 + W P). F falls along v, so this is where a convex
// function has its only minimum,
//
//     E(P) = P^T W P/2 - sum of the integrals of F dv,   grad E = W (P - F).
//
// With D = -dF/dv = R R, Newton's step is dP = -(I + D W)^-1 (P - F), by Cholesky's factors of I + R W R [Alart and
// Curnier 1991]. It goes down E; where it would go too far, as at the ends of the laws' branches, a part of it is
// sought.
#include "newton.h"

#include "internal.h"

#include <math.h>
#include <string.h>

enum { STEPS = 30, PARTS = 20 };

// Part of the slope of E along a step that may be left at its end.
static const double flat = 0.5;

// Coefficient of friction and its slope over the speed; *rate is coefficient over speed, also at rest.
static double coefficient_at(const ancf_rubbing* c, double speed, double* rate, double* slope) {
    double coefficient = ancf_friction_rising(c->law, speed, slope);
    if (coefficient > c->most) {
        coefficient = c->most;
        *slope = 0.0;
    }
    *rate = speed > 0.0 ? coefficient / speed : *slope;
    return coefficient;
}

// Friction at a slip, without the rest: -F.
static void friction_at(double F[2], const ancf_rubbing* c, const double v[2]) {
    double rate, slope;
    coefficient_at(c, sqrt(v[0] * v[0] + v[1] * v[1]), &rate, &slope);
    for (int a = 0; a < 2; ++a) F[a] = -c->pressed * rate * v[a];
}

// Root of -dF/dv: xx, xy, yy. Returns nothing negative.
static void root_at(double R[3], const ancf_rubbing* c, const double v[2]) {
    double rate, slope;
    const double speed = sqrt(v[0] * v[0] + v[1] * v[1]);
    coefficient_at(c, speed, &rate, &slope);
    const double across = sqrt(c->pressed * rate), along = sqrt(c->pressed * fmax(slope, 0.0)) - across,
                 x = speed > 0.0 ? v[0] / speed : 1.0, y = speed > 0.0 ? v[1] / speed : 0.0;
    R[0] = across + along * x * x;
    R[1] = along * x * y;
    R[2] = across + along * y * y;
}

// y = A x, A symmetric.
ANCF_CLONES static void multiply(double* restrict y, const double* restrict A, const double* restrict x, int n) {
    for (int i = 0; i < n; ++i) y[i] = 0.0;
    for (int k = 0; k < n; ++k) {
        const double* restrict row = A + k * n;
        for (int i = 0; i < n; ++i) y[i] += x[k] * row[i];
    }
}

// z = R x of every contact.
static void turn(double* z, double (*R)[3], const double* x, int n) {
    for (int i = 0; i < n; ++i) {
        const double first = R[i][0] * x[2 * i] + R[i][1] * x[2 * i + 1];
        z[2 * i + 1] = R[i][1] * x[2 * i] + R[i][2] * x[2 * i + 1];
        z[2 * i] = first;
    }
}

// The upper triangle of I + R W R, row by row.
static void assemble(double* A, const double* W, double (*R)[3], int n) {
    const int m = 2 * n;
    for (int i = 0; i < n; ++i)
        for (int j = i; j < n; ++j) {
            const double *w = W + 2 * i * m + 2 * j, *r = R[i], *s = R[j];
            double *up = A + 2 * i * m + 2 * j, *low = up + m;
            const double a = w[0] * s[0] + w[1] * s[1], b = w[0] * s[1] + w[1] * s[2],
                         c = w[m] * s[0] + w[m + 1] * s[1], d = w[m] * s[1] + w[m + 1] * s[2];
            up[0] = r[0] * a + r[1] * c;
            up[1] = r[0] * b + r[1] * d;
            low[0] = r[1] * a + r[2] * c;
            low[1] = r[1] * b + r[2] * d;
        }
    for (int i = 0; i < m; ++i) A[i * m + i] += 1.0;
}

// Solves A x = x by A = U^T U, which takes the place of the upper triangle. All eigenvalues are 1 at least.
ANCF_CLONES static void solve(double* restrict A, double* restrict x, int m) {
    for (int k = 0; k < m; ++k) {
        double* restrict row = A + k * m;
        const double inverse = 1.0 / sqrt(row[k]);
        for (int j = k; j < m; ++j) row[j] *= inverse;
        x[k] /= row[k];
        for (int i = k + 1; i < m; ++i) {
            double* restrict other = A + i * m;
            const double factor = row[i];
            for (int j = i; j < m; ++j) other[j] -= factor * row[j];
            x[i] -= factor * x[k];
        }
    }
    for (int k = m - 1; k >= 0; --k) {
        const double* row = A + k * m;
        double sum = x[k];
        for (int j = k + 1; j < m; ++j) sum -= row[j] * x[j];
        x[k] = sum / row[k];
    }
}

// What friction is off by, P - F; returns the square of the largest.
static double miss(double* off, const double* P, const double* v, int n, const ancf_rubbing* contact) {
    double largest = 0.0;
    for (int i = 0; i < n; ++i) {
        double F[2];
        friction_at(F, &contact[i], v + 2 * i);
        for (int a = 0; a < 2; ++a) off[2 * i + a] = P[2 * i + a] - F[a];
        largest = fmax(largest, off[2 * i] * off[2 * i] + off[2 * i + 1] * off[2 * i + 1]);
    }
    return largest;
}

// A step on its way: friction and slips `part` of it further, and the slope of E along it.
typedef struct {
    int n;
    const ancf_rubbing* contact;
    const double *P, *v, *dP, *dv;
} way;

static double slope_at(const way* w, double part) {
    double sum = 0.0;
    for (int i = 0; i < w->n; ++i) {
        double F[2];
        const double there[2] = {w->v[2 * i] + part * w->dv[2 * i], w->v[2 * i + 1] + part * w->dv[2 * i + 1]};
        friction_at(F, &w->contact[i], there);
        for (int a = 0; a < 2; ++a) {
            const int k = 2 * i + a;
            sum += (w->P[k] + part * w->dP[k] - F[a]) * w->dv[k];
        }
    }
    return sum;
}

// Part of a step to where E is nearly least along it: regula falsi, with no part of the bracket too small.
static double part_of(const way* w) {
    double low = 0.0, high = 1.0, at_low = slope_at(w, 0.0), at_high = slope_at(w, 1.0), part = 1.0;
    const double enough = -flat * at_low;
    double at = at_high;
    for (int i = 0; i < PARTS && fabs(at) > enough && at_low < 0.0 && at_high > 0.0; ++i) {
        part = (low * at_high - high * at_low) / (at_high - at_low);
        part = fmin(fmax(part, low + 0.1 * (high - low)), high - 0.1 * (high - low));
        at = slope_at(w, part);
        if (at > 0.0) {
            high = part;
            at_high = at;
        } else {
            low = part;
            at_low = at;
        }
    }
    return part;
}

int ancf_newton_friction(double* P, double* v, double* left, int n, const ancf_rubbing* contact, const double* W,
                         double enough, double* scratch) {
    const int m = 2 * n;
    double *A = scratch, *off = A + m * m, *dP = off + m, *dv = dP + m, (*R)[3] = (double(*)[3])(dv + m);
    double largest = miss(off, P, v, n, contact);
    int step = 0;
    for (; step < STEPS && largest > enough * enough; ++step) {
        for (int i = 0; i < n; ++i) root_at(R[i], &contact[i], v + 2 * i);
        assemble(A, W, R, n);
        multiply(dv, W, off, m);
        turn(dP, R, dv, n);
        solve(A, dP, m);
        turn(dP, R, dP, n);
        for (int i = 0; i < m; ++i) dP[i] -= off[i];
        multiply(dv, W, dP, m);
        const double part = part_of(&(way) {n, contact, P, v, dP, dv});
        for (int i = 0; i < m; ++i) {
            P[i] += part * dP[i];
            v[i] += part * dv[i];
        }
        largest = miss(off, P, v, n, contact);
    }
    *left = sqrt(largest);
    return step;
}
