#include "massdamp.h"
#include "ancf/mass.h"

// Forces of an element on its four unknowns, and which these are.
static void force_of(double f[3][4], int dof[4], const ancf_model* m, int element, const double* v) {
    const ancf_element* el = &m->element[element];
    double M[4][4];
    ancf_mass_element(M, el);
    ancf_model_dofs(dof, m, element);
    for (int c = 0; c < 3; ++c)
        for (int i = 0; i < 4; ++i) {
            f[c][i] = 0.0;
            for (int j = 0; j < 4; ++j) f[c][i] -= el->drag * M[i][j] * v[c * m->stride + dof[j]];
        }
}

void ancf_massdamp_force(double* force, const ancf_model* m, const double* v, double part) {
    double f[3][4];
    int dof[4];
    for (int e = 0; e < m->n_elements; ++e) {
        if (m->element[e].drag == 0.0) continue;
        force_of(f, dof, m, e, v);
        for (int c = 0; c < 3; ++c)
            for (int i = 0; i < 4; ++i) force[c * m->stride + dof[i]] += part * f[c][i];
    }
}

double ancf_massdamp_power(const ancf_model* m, const double* v, const double* w) {
    double sum = 0.0, f[3][4];
    int dof[4];
    for (int e = 0; e < m->n_elements && m->dragged; ++e) {
        if (m->element[e].drag == 0.0) continue;
        force_of(f, dof, m, e, v);
        for (int c = 0; c < 3; ++c)
            for (int i = 0; i < 4; ++i) sum += f[c][i] * w[c * m->stride + dof[i]];
    }
    return sum;
}
