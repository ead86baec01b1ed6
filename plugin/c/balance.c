#include "ancf/balance.h"
#include "ancf/elastic.h"
#include "ancf/mass.h"
#include "internal.h"

static double kinetic_of(const ancf_model* m, int e) {
    double M[4][4], sum = 0.0;
    int dof[4];
    ancf_mass_element(M, &m->element[e]);
    ancf_model_dofs(dof, m, e);
    for (int c = 0; c < 3; ++c) {
        const double* v = m->v + c * m->stride;
        for (int i = 0; i < 4; ++i)
            for (int j = 0; j < 4; ++j) sum += 0.5 * v[dof[i]] * M[i][j] * v[dof[j]];
    }
    return sum;
}

static double gravity_of(const ancf_model* m, int e) {
    double w[4], sum = 0.0;
    int dof[4];
    ancf_mass_weight(w, &m->element[e]);
    ancf_model_dofs(dof, m, e);
    for (int c = 0; c < 3; ++c)
        for (int i = 0; i < 4; ++i) sum -= m->gravity[c] * w[i] * m->x[c * m->stride + dof[i]];
    return sum;
}

static double kinetic_whole(const ancf_model* m) {
    double sum = 0.0;
    if (ancf_mass_diagonal(m)) return ancf_mass_kinetic(m);
    for (int e = 0; e < m->n_elements; ++e) sum += kinetic_of(m, e);
    return sum;
}

// mid M mid/2 - half M half/2 of mid = v + last a/2 and half = step a/2 is (mid - half) M (mid + half)/2.
double ancf_kinetic_kept(const ancf_model* m, double last, double step) {
    if (ancf_mass_diagonal(m)) return ancf_mass_kinetic_kept(m, last, step);
    const int n = 3 * m->stride;
    double *more = m->work, *momentum = more + n, twice = 0.0;
    for (int i = 0; i < n; ++i) more[i] = m->v[i] + 0.5 * (last + step) * m->a[i];
    ancf_mass_multiply(m, momentum, more);
    for (int c = 0; c < 3; ++c)
        for (int i = 0; i < m->n_dof; ++i) {
            const int j = c * m->stride + i;
            if (!ancf_model_counts(m, i)) continue;
            const double added = i < m->n_nodes ? ancf_mass_added(m, i) : 0.0;
            twice += (m->v[j] + 0.5 * (last - step) * m->a[j]) * (momentum[j] - added * more[j]);
        }
    return 0.5 * twice;
}

void ancf_energy_of(ancf_energy* energy, const ancf_model* m, int begin, int end) {
    const bool whole = begin == 0 && end == m->n_elements;
    const bool falls = m->gravity[0] != 0.0 || m->gravity[1] != 0.0 || m->gravity[2] != 0.0;
    energy->kinetic = whole ? kinetic_whole(m) : 0.0;
    energy->gravity = 0.0;
    ancf_elastic_energy(&energy->axial, &energy->bending, m, m->x, begin, end);
    for (int e = begin; e < end && !whole; ++e) energy->kinetic += kinetic_of(m, e);
    for (int e = begin; e < end && falls; ++e) energy->gravity += gravity_of(m, e);
}

ANCF_CLONES static double product(const double* a, const double* b, int n) {
    double sum = 0.0;
#pragma omp simd reduction(+ : sum)
    for (int i = 0; i < n; ++i) sum += a[i] * b[i];
    return sum;
}

// The end's copy of a shared slope counts no second time.
double ancf_height(const ancf_model* m) {
    double sum = 0.0;
    for (int c = 0; c < 3; ++c) {
        const double *x = m->x + c * m->stride, g = m->gravity[c];
        if (g == 0.0) continue;
        sum -= g * product(m->weight, x, m->n_dof);
        for (int k = 0; k < m->n_shared; ++k) sum += g * m->weight[m->shared[2 * k + 1]] * x[m->shared[2 * k + 1]];
    }
    return sum;
}

void ancf_momentum(double linear[3], double angular[3], ancf_model* m) {
    const int s = m->stride;
    double* p = m->work;
    ancf_mass_multiply(m, p, m->v);
    for (int c = 0; c < 3; ++c) linear[c] = angular[c] = 0.0;
    for (int i = 0; i < m->n_dof; ++i) {
        if (!ancf_model_counts(m, i)) continue;
        for (int c = 0; c < 3; ++c) {
            const int d = (c + 1) % 3, b = (c + 2) % 3;
            if (i < m->n_nodes) linear[c] += p[c * s + i];
            angular[c] += m->x[d * s + i] * p[b * s + i] - m->x[b * s + i] * p[d * s + i];
        }
    }
}
