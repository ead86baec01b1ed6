// With F(v) what the laws give at velocities v, impulses or forces are P = F(v0 + W P). F falls along v, so this is
// where a convex function has its only minimum,
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

enum { STEPS = 200, PARTS = 20 };

// y = A x, A symmetric.
ANCF_CLONES static void multiply(double* restrict y, const double* restrict A, const double* restrict x, int n) {
    for (int i = 0; i < n; ++i) y[i] = 0.0;
    for (int k = 0; k < n; ++k) {
        const double* restrict row = A + k * n;
        for (int i = 0; i < n; ++i) y[i] += x[k] * row[i];
    }
}

// z = R x of every contact.
static void turn(double* z, double (*R)[3], const double* x, const ancf_newton_laws* laws) {
    if (laws->size == 1)
        for (int i = 0; i < laws->n; ++i) z[i] = R[i][0] * x[i];
    else
        for (int i = 0; i < laws->n; ++i) {
            const double first = R[i][0] * x[2 * i] + R[i][1] * x[2 * i + 1];
            z[2 * i + 1] = R[i][1] * x[2 * i] + R[i][2] * x[2 * i + 1];
            z[2 * i] = first;
        }
}

// Place of an unknown in the system: all first directions come before all second ones, which where things move in a
// plane do not feel one another.
static int place_of(const ancf_newton_laws* laws, int contact, int direction) { return direction * laws->n + contact; }

// Puts a number into a row of the upper triangle.
static void put(double* A, int* end, int row, int column, int m, double value) {
    if (value == 0.0) return;
    A[row * m + column] += value;
    if (end[row] <= column) end[row] = column + 1;
}

// R W R of two contacts with two directions each, i <= j, into the upper triangle.
static void put_block(double* A, int* end, int i, int j, const double* w, const double r[3], const double s[3], int m) {
    const int n = m / 2;
    if (w[1] == 0.0 && w[m] == 0.0 && r[1] == 0.0 && s[1] == 0.0) { // in a plane
        put(A, end, i, j, m, r[0] * w[0] * s[0]);
        put(A, end, n + i, n + j, m, r[2] * w[m + 1] * s[2]);
        return;
    }
    const double a = w[0] * s[0] + w[1] * s[1], b = w[0] * s[1] + w[1] * s[2], c = w[m] * s[0] + w[m + 1] * s[1],
                 d = w[m] * s[1] + w[m + 1] * s[2];
    put(A, end, i, j, m, r[0] * a + r[1] * c);
    put(A, end, i, n + j, m, r[0] * b + r[1] * d);
    if (i != j) put(A, end, j, n + i, m, r[1] * a + r[2] * c);
    put(A, end, n + i, n + j, m, r[1] * b + r[2] * d);
}

// The upper triangle of I + R W R, row by row; behind end[row] are zeros alone.
static void assemble(double* A, int* end, const double* W, double (*R)[3], const ancf_newton_laws* laws) {
    const int n = laws->n, m = n * laws->size;
    for (int i = 0; i < m; ++i) {
        memset(A + i * m + i, 0, sizeof *A * (size_t)(m - i));
        A[i * m + i] = 1.0;
        end[i] = i + 1;
    }
    for (int i = 0; i < n; ++i)
        for (int j = i; j < n; ++j) {
            const double* w = W + laws->size * (i * m + j);
            if (laws->size == 1) put(A, end, i, j, m, R[i][0] * w[0] * R[j][0]);
            else if (w[0] != 0.0 || w[1] != 0.0 || w[m] != 0.0 || w[m + 1] != 0.0)
                put_block(A, end, i, j, w, R[i], R[j], m);
        }
}

// Takes row k, which is as it will be but for its scale, off row i below it.
static void take_off(double* restrict A, int* restrict end, double* restrict x, int k, int i, int m) {
    const double* restrict row = A + k * m, factor = row[i];
    double* restrict other = A + i * m;
    if (factor == 0.0) return;
    for (int j = i; j < end[k]; ++j) other[j] -= factor * row[j];
    if (end[i] < end[k]) end[i] = end[k];
    x[i] -= factor * x[k];
}

// Solves A x = x by A = U^T U, which takes the place of the upper triangle. All eigenvalues are 1 at least. Four rows
// are taken off those below them in one pass.
ANCF_CLONES static void solve(double* restrict A, int* restrict end, double* restrict x, int m) {
    for (int k = 0; k < m; k += 4) {
        const int behind = k + 4 < m ? k + 4 : m;
        int last = 0;
        for (int p = k; p < behind; ++p) {
            double* restrict row = A + p * m;
            const double inverse = 1.0 / sqrt(row[p]);
            for (int j = p; j < end[p]; ++j) row[j] *= inverse;
            x[p] /= row[p];
            for (int i = p + 1; i < behind; ++i) take_off(A, end, x, p, i, m);
            if (last < end[p]) last = end[p];
        }
        const double* restrict a = A + k * m, * restrict b = a + m, * restrict c = b + m, * restrict d = c + m;
        for (int i = behind; i < last; ++i) { // none behind the last four
            double* restrict other = A + i * m;
            const double fa = a[i], fb = b[i], fc = c[i], fd = d[i];
            if (fa == 0.0 && fb == 0.0 && fc == 0.0 && fd == 0.0) continue;
            for (int j = i; j < last; ++j) other[j] = other[j] - fa * a[j] - fb * b[j] - fc * c[j] - fd * d[j];
            if (end[i] < last) end[i] = last;
            x[i] = x[i] - fa * x[k] - fb * x[k + 1] - fc * x[k + 2] - fd * x[k + 3];
        }
    }
    for (int k = m - 1; k >= 0; --k) {
        const double* row = A + k * m;
        double sum = x[k];
        for (int j = k + 1; j < end[k]; ++j) sum -= row[j] * x[j];
        x[k] = sum / row[k];
    }
}

// What is off, P - F; returns the square of the largest.
static double miss(double* off, const double* P, const double* v, const ancf_newton_laws* laws) {
    const int size = laws->size;
    double largest = 0.0;
    for (int i = 0; i < laws->n; ++i) {
        double F[2], square = 0.0;
        laws->answer(F, laws->law, i, v + size * i);
        for (int a = 0; a < size; ++a) {
            const double by = off[size * i + a] = P[size * i + a] - F[a];
            square += by * by;
        }
        if (square > largest || isnan(square)) largest = square;
    }
    return largest;
}

// A step on its way.
typedef struct {
    const ancf_newton_laws* laws;
    const double *P, *v, *dP, *dv;
} way;

// Slope of E along it.
static double slope_at(const way* w, double part) {
    const int size = w->laws->size;
    double sum = 0.0;
    for (int i = 0; i < w->laws->n; ++i) {
        double F[2], there[2];
        for (int a = 0; a < size; ++a) there[a] = w->v[size * i + a] + part * w->dv[size * i + a];
        w->laws->answer(F, w->laws->law, i, there);
        for (int a = 0; a < size; ++a) {
            const int k = size * i + a;
            sum += (w->P[k] + part * w->dP[k] - F[a]) * w->dv[k];
        }
    }
    return sum;
}

// Part of a step to where E is nearly least along it, but not beyond, so that no steps can go round in a circle: where
// the slope is a quarter of what it was, by regula falsi, with no part of the bracket too small. A whole step may go a
// little too far.
static double part_of(const way* w) {
    const double start = slope_at(w, 0.0), end = slope_at(w, 1.0), aim = 0.25 * start;
    if (!(start < 0.0) || end <= -0.5 * aim) return 1.0;
    double low = 0.0, high = 1.0, at_low = start - aim, at_high = end - aim, part = 1.0;
    for (int i = 0; i < PARTS; ++i) {
        part = (low * at_high - high * at_low) / (at_high - at_low);
        part = fmin(fmax(part, low + 0.1 * (high - low)), high - 0.1 * (high - low));
        const double at = slope_at(w, part) - aim;
        if (fabs(at) <= -aim) break;
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

int ancf_newton(double* P, double* v, double* left, const ancf_newton_laws* laws, const double* W, double enough,
                double* scratch) {
    const int m = laws->n * laws->size;
    double *A = scratch, *off = A + m * m, *dP = off + m, *dv = dP + m, (*R)[3] = (double(*)[3])(dv + m);
    double largest = miss(off, P, v, laws);
    int step = 0, end[2 * ANCF_NEWTON_MOST];
    for (; step < STEPS && largest > enough * enough; ++step) {
        for (int i = 0; i < laws->n; ++i) laws->root(R[i], laws->law, i, v + laws->size * i);
        assemble(A, end, W, R, laws);
        multiply(dv, W, off, m);
        turn(dP, R, dv, laws);
        for (int i = 0; i < m; ++i) dv[place_of(laws, i / laws->size, i % laws->size)] = dP[i];
        solve(A, end, dv, m);
        for (int i = 0; i < m; ++i) dP[i] = dv[place_of(laws, i / laws->size, i % laws->size)];
        turn(dP, R, dP, laws);
        for (int i = 0; i < m; ++i) dP[i] -= off[i];
        multiply(dv, W, dP, m);
        const double part = part_of(&(way) {laws, P, v, dP, dv});
        for (int i = 0; i < m; ++i) {
            P[i] += part * dP[i];
            v[i] += part * dv[i];
        }
        largest = miss(off, P, v, laws);
    }
    *left = sqrt(largest);
    return step;
}
