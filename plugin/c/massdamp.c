#include "massdamp.h"
#include "ancf/mass.h"

// Force of an element on its four unknowns, component c.
static void force_of(double f[4], double M[4][4], double drag, const int dof[4], const double* v) {
    for (int i = 0; i < 4; ++i) {
        f[i] = 0.0;
        for (int j = 0; j < 4; ++j) f[i] -= drag * M[i][j] * v[dof[j]];
    }
}

void ancf_massdamp_force(double* force, const ancf_model* m, const double* v, double part) {
    for (int e = 0; e < m->n_elements; ++e) {
        const ancf_element* el = &m->element[e];
        if (el->drag == 0.0) continue;
        double M[4][4], f[4];
        int dof[4];
        ancf_mass_element(M, el);
        ancf_model_dofs(dof, m, e);
        for (int c = 0; c < 3; ++c) {
            force_of(f, M, el->drag, dof, v + c * m->stride);
            for (int i = 0; i < 4; ++i) force[c * m->stride + dof[i]] += part * f[i];
        }
    }
}

double ancf_massdamp_power(const ancf_model* m, const double* v, const double* w) {
    double sum = 0.0;
    for (int e = 0; e < m->n_elements && m->dragged; ++e) {
        const ancf_element* el = &m->element[e];
        if (el->drag == 0.0) continue;
        double M[4][4], f[4];
        int dof[4];
        ancf_mass_element(M, el);
        ancf_model_dofs(dof, m, e);
        for (int c = 0; c < 3; ++c) {
            force_of(f, M, el->drag, dof, v + c * m->stride);
            for (int i = 0; i < 4; ++i) sum += f[i] * w[c * m->stride + dof[i]];
        }
    }
    return sum;
}
