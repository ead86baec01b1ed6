#include "ancf/balance.h"
#include "ancf/elastic.h"
#include "ancf/mass.h"

void ancf_energy_of(ancf_energy* energy, const ancf_model* m, int begin, int end) {
    energy->kinetic = energy->gravity = 0.0;
    ancf_elastic_energy(&energy->axial, &energy->bending, m, m->x, begin, end);
    if (begin == 0 && end == m->n_elements && ancf_mass_diagonal(m)) {
        energy->kinetic = ancf_mass_kinetic(m);
        for (int c = 0; c < 3; ++c)
            for (int i = 0; i < m->n_nodes && m->gravity[c] != 0.0; ++i)
                energy->gravity -= m->gravity[c] * ancf_mass_of_node(m, i) * m->x[c * m->stride + i];
        return;
    }
    const bool falls = m->gravity[0] != 0.0 || m->gravity[1] != 0.0 || m->gravity[2] != 0.0;
    for (int e = begin; e < end; ++e) {
        double M[4][4];
        int dof[4];
        ancf_mass_element(M, &m->element[e]);
        ancf_model_dofs(dof, m, e);
        const bool diagonal = m->element[e].kind & (ANCF_LUMPED | ANCF_SPRING);
        for (int c = 0; c < 3; ++c) {
            const double *x = m->x + c * m->stride, *v = m->v + c * m->stride;
            for (int i = 0; i < 4; ++i) {
                double momentum = diagonal ? M[i][i] * v[dof[i]] : 0.0;
                for (int j = 0; j < 4 && !diagonal; ++j) momentum += M[i][j] * v[dof[j]];
                energy->kinetic += 0.5 * v[dof[i]] * momentum;
                if (falls) energy->gravity -= m->gravity[c] * (M[i][0] + M[i][2]) * x[dof[i]];
            }
        }
    }
}

// The sum over both copies of a shared slope would count it twice: only the start's is taken.
static bool counts(const ancf_model* m, int dof) {
    const int end = dof - m->n_nodes - m->n_elements;
    return end < 0 || m->next[end] < 0;
}

void ancf_momentum(double linear[3], double angular[3], ancf_model* m) {
    const int s = m->stride;
    double* p = m->work;
    ancf_mass_multiply(m, p, m->v);
    for (int c = 0; c < 3; ++c) linear[c] = angular[c] = 0.0;
    for (int i = 0; i < m->n_dof; ++i) {
        if (!counts(m, i)) continue;
        for (int c = 0; c < 3; ++c) {
            const int d = (c + 1) % 3, b = (c + 2) % 3;
            if (i < m->n_nodes) linear[c] += p[c * s + i];
            angular[c] += m->x[d * s + i] * p[b * s + i] - m->x[b * s + i] * p[d * s + i];
        }
    }
}
