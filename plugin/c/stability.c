#include "ancf/stability.h"
#include "ancf/elastic.h"
#include "ancf/mass.h"
#include "internal.h"

#include <math.h>

// The larger one, NaN if either is: what cannot be computed must not pass for a small number.
static double larger(double a, double b) { return a > b || isnan(a) ? a : b; }

// Stiffness of a straight unstressed element over (r0, g0, r1, g1), along it or across.
static void axial_stiffness(double K[4][4], const ancf_element* el) {
    const double L = el->length, k = el->ea / (30.0 * L);
    const double s[4][4] = {{36.0, 3.0 * L, -36.0, 3.0 * L},
                            {3.0 * L, 4.0 * L * L, -3.0 * L, -L * L},
                            {-36.0, -3.0 * L, 36.0, -3.0 * L},
                            {3.0 * L, -L * L, -3.0 * L, 4.0 * L * L}};
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) K[i][j] = k * s[i][j];
}

static void bending_stiffness(double K[4][4], const ancf_element* el) {
    const double L = el->length, k = el->ei / (L * L * L);
    const double s[4][4] = {{12.0, 6.0 * L, -12.0, 6.0 * L},
                            {6.0 * L, 4.0 * L * L, -6.0 * L, 2.0 * L * L},
                            {-12.0, -6.0 * L, 12.0, -6.0 * L},
                            {6.0 * L, 2.0 * L * L, -6.0 * L, 4.0 * L * L}};
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) K[i][j] = k * s[i][j];
}

// Splits a symmetric element matrix into its even and odd parts under reversal of the element, 2x2 each: on
// (r0 + r1, g0 - g1) and (r0 - r1, g0 + g1). sign = +1 even, -1 odd.
static void reduce(double A[2][2], double K[4][4], double sign) {
    A[0][0] = K[0][0] + sign * K[0][2];
    A[0][1] = A[1][0] = K[0][1] - sign * K[0][3];
    A[1][1] = K[1][1] - sign * K[1][3];
}

// Largest eigenvalue of K x = w2 M x, 2x2.
static double largest_eigenvalue(double K[2][2], double M[2][2]) {
    const double a = M[0][0] * M[1][1] - M[0][1] * M[1][0];
    const double b = K[0][0] * M[1][1] + K[1][1] * M[0][0] - 2.0 * K[0][1] * M[0][1];
    const double c = K[0][0] * K[1][1] - K[0][1] * K[1][0];
    return (b + sqrt(larger(b * b - 4.0 * a * c, 0.0))) / (2.0 * a);
}

static double frequency2(double K[4][4], double M[4][4]) {
    double largest = 0.0;
    for (int s = -1; s <= 1; s += 2) {
        double k[2][2], mm[2][2];
        reduce(k, K, s);
        reduce(mm, M, s);
        largest = larger(largest, largest_eigenvalue(k, mm));
    }
    return largest;
}

double ancf_element_frequency(const ancf_element* el) {
    double K[4][4], M[4][4];
    ancf_mass_element(M, el);
    if (el->kind & ANCF_SPRING) return sqrt(2.0 * el->ea / el->length / M[0][0]);
    axial_stiffness(K, el);
    double w2 = frequency2(K, M);
    if (el->ei > 0.0) {
        bending_stiffness(K, el);
        w2 = larger(w2, frequency2(K, M));
    }
    return sqrt(w2);
}

// Green's strain: EA (1 + 3 eps) along the cable; engineering strain: EA along it, and EA eps/(1 + eps) across, where
// it comes on top of bending.
double ancf_stiffening(int kind, double strain) {
    return 1.0 + (kind & ANCF_ENGINEERING ? 1.0 : 3.0) * fmax(strain, 0.0);
}

double ancf_element_step(const ancf_element* el, double strain) {
    const double w = ancf_element_frequency(el) * sqrt(ancf_stiffening(el->kind, strain));
    const double z = 0.5 * (el->damping * w + el->drag / w);
    return 0.9 * (2.0 / w) / (sqrt(1.0 + z * z) + z); // as sqrt(1 + z^2) - z, which would cancel
}

double ancf_critical_step(const ancf_model* m, double strain, int* element) {
    double least = INFINITY;
    *element = 0;
    for (int e = 0; e < m->n_elements; ++e) {
        if (m->element[e].kind & ANCF_WOUND) continue;
        const double step = ancf_element_step(&m->element[e], strain);
        if (step >= least) continue;
        least = step;
        *element = e;
        if (isnan(step)) break;
    }
    return least;
}

double ancf_speed_spread(const ancf_model* m, const double* v) {
    double spread = 0.0;
    for (int c = 0; c < 3; ++c) {
        const double* u = v + c * m->stride;
        double low = u[0], high = u[0];
        for (int i = 1; i < m->n_nodes; ++i) {
            low = u[i] < low ? u[i] : low;
            high = u[i] > high ? u[i] : high;
        }
        if (high - low > spread) spread = high - low;
    }
    return spread;
}

ANCF_CLONES static double sum_of(const double* u, int n) {
    double sum = 0.0;
#pragma omp simd reduction(+ : sum)
    for (int i = 0; i < n; ++i) sum += u[i];
    return sum;
}

bool ancf_finite(const ancf_model* m, const double* x) {
    return isfinite(sum_of(x, m->n_dof)) && isfinite(sum_of(x + m->stride, m->n_dof)) &&
           isfinite(sum_of(x + 2 * m->stride, m->n_dof));
}
