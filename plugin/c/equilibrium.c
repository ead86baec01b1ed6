#include "ancf/equilibrium.h"
#include "ancf/elastic.h"
#include "ancf/step.h"

#include <math.h>
#include <string.h>

// Dynamic relaxation with adaptive damping (Underwood 1983): the motion of a fictitious structure whose masses make a
// step of one stable, damped at the lowest frequency that its own motion shows. It needs no stiffness matrix, and so
// takes slack cables, mechanisms that hang free and tension-only springs as they come.

// Fictitious masses: a quarter of the row sums of the element stiffness, which bounds its frequencies by 2.
static void fictitious_mass(double* mass, const ancf_model* m, double stiffening) {
    memset(mass, 0, (size_t)m->stride * sizeof *mass);
    for (int e = 0; e < m->n_elements; ++e) {
        const ancf_element* el = &m->element[e];
        const double axial = stiffening * el->ea / el->length, bending = el->ei / pow(el->length, 3.0);
        int dof[4];
        ancf_model_dofs(dof, m, e);
        if (el->kind & ANCF_SPRING) {
            mass[dof[0]] += 0.5 * axial;
            mass[dof[2]] += 0.5 * axial;
            continue;
        }
        const double node = 0.25 * (78.0 / 30.0 * axial + 36.0 * bending);
        const double slope = 0.25 * (11.0 / 30.0 * axial + 18.0 * bending) * el->length * el->length;
        mass[dof[0]] += node;
        mass[dof[2]] += node;
        mass[dof[1]] += slope;
        mass[dof[3]] += slope;
    }
    double *start = mass + m->n_nodes, *end = start + m->n_elements;
    for (int e = 0; e < m->n_elements; ++e)
        if (m->next[e] >= 0) end[e] = start[m->next[e]] = end[e] + start[m->next[e]];
}

static double unit_length(const ancf_model* m, int dof) {
    return dof < m->n_nodes ? 1.0 : m->element[(dof - m->n_nodes) % m->n_elements].length;
}

// Largest unbalanced force over the largest force that elements or loads exert.
static double imbalance(const ancf_model* m, const double* mass) {
    double residual = 0.0, largest = 0.0;
    for (int c = 0; c < 3; ++c) {
        const double *f = m->f + c * m->stride, *external = m->external + c * m->stride;
        for (int i = 0; i < m->n_dof; ++i) {
            if (mass[i] > 0.0 && !m->hold[i]) residual = fmax(residual, fabs(f[i]) / unit_length(m, i));
            const double load = external[i] + m->gravity[c] * m->weight[i];
            largest = fmax(largest, fabs(load) / unit_length(m, i));
        }
        const double* fd = m->scratch + 6 * m->n_elements + c * m->n_elements;
        for (int e = 0; e < m->n_elements; ++e) largest = fmax(largest, fabs(fd[e]));
    }
    return largest > 0.0 ? residual / largest : 0.0;
}

// The damping that the motion asks for: twice the frequency of its Rayleigh quotient.
static double damping_of(const ancf_model* m, const double* mass, const double* before, const double* rate) {
    double stiffness = 0.0, inertia = 0.0;
    for (int c = 0; c < 3; ++c)
        for (int i = 0; i < m->n_dof; ++i) {
            const int j = c * m->stride + i;
            stiffness += rate[j] * (before[j] - m->f[j]);
            inertia += mass[i] * rate[j] * rate[j];
        }
    return stiffness > 0.0 && inertia > 0.0 ? fmin(2.0 * sqrt(stiffness / inertia), 1.9) : 0.0;
}

static void relaxation_step(ancf_model* m, const double* mass, double* rate, double damping) {
    const double keep = (2.0 - damping) / (2.0 + damping), push = 2.0 / (2.0 + damping);
    for (int c = 0; c < 3; ++c)
        for (int i = 0; i < m->n_dof; ++i) {
            const int j = c * m->stride + i;
            if (m->hold[i] || mass[i] <= 0.0) continue;
            rate[j] = keep * rate[j] + push * m->f[j] / mass[i];
            m->x[j] += rate[j];
        }
}

ancf_error ancf_equilibrium(ancf_model* m, double tolerance, int iterations) {
    enum { REFRESH = 100 };
    const size_t field = 3 * (size_t)m->stride;
    double *rate = m->work + 2 * field, *before = rate + field, *mass = before + field, *rest = mass + field;
    memset(rate, 0, 4 * field * sizeof *rate);
    memset(m->v, 0, field * sizeof *m->v);
    double damping = 0.0, stiffening = 0.0;
    for (int k = 0; k < iterations; ++k) {
        if (k % REFRESH == 0) {
            int element;
            const double needed = 1.2 * (1.0 + 3.0 * fmax(ancf_strain_max(m, m->x, &element), 0.0));
            if (needed > stiffening || needed < 0.5 * stiffening) fictitious_mass(mass, m, stiffening = needed);
        }
        memcpy(before, m->f, field * sizeof *before);
        ancf_acceleration(m, m->x, rest);
        if (imbalance(m, mass) < tolerance) return ANCF_OK;
        if (k > 0) damping = damping_of(m, mass, before, rate);
        relaxation_step(m, mass, rate, damping);
    }
    return ANCF_E_EQUILIBRIUM;
}
