#include "ancf/equilibrium.h"
#include "ancf/stability.h"
#include "ancf/tension.h"
#include "internal.h"
#include "settle.h"
#include "slack.h"
#include "slide.h"

#include <float.h>
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
    for (int c = 1; c < 3; ++c) memcpy(mass + c * m->stride, mass, (size_t)m->stride * sizeof *mass);
}

static double unit_length(const ancf_model* m, int dof) {
    return dof < m->n_nodes ? 1.0 : m->element[(dof - m->n_nodes) % m->n_elements].length;
}

// Force that the last bits of positions stand for: no state can be found whose force is less.
static double rounding(const ancf_model* m) {
    double largest = 0.0;
    for (int c = 0; c < 3; ++c) {
        const double* x = m->x + c * m->stride;
        for (int e = 0; e < m->n_elements; ++e) {
            const double far = fmax(fabs(x[m->ends[2 * e]]), fabs(x[m->ends[2 * e + 1]]));
            largest = fmax(largest, m->element[e].ea * m->inv_length[e] * far);
        }
    }
    return 8.0 * DBL_EPSILON * largest;
}

double ancf_imbalance(const ancf_model* m) {
    double residual = 0.0, largest = 0.0, sum = 0.0; // the sum shows what a largest value does not: not a number
    for (int c = 0; c < 3; ++c) {
        const double *f = m->f + c * m->stride, *external = m->external + c * m->stride;
        for (int i = 0; i < m->n_dof; ++i) {
            if (!m->hold[i]) residual = fmax(residual, fabs(f[i]) / unit_length(m, i));
            sum += f[i];
            const double load = external[i] + m->gravity[c] * m->weight[i];
            largest = fmax(largest, fabs(load) / unit_length(m, i));
        }
    }
    for (int k = 0; k < 3 * m->n_elements; ++k) largest = fmax(largest, fabs(m->pull[k]));
    if (!isfinite(sum)) return INFINITY;
    return largest > 0.0 ? fmax(residual - rounding(m), 0.0) / largest : 0.0;
}

// The motion's Rayleigh quotient, as sums that fade with its past.
typedef struct {
    double stiffness, inertia;
} quotient;

// The damping that the motion asks for: twice the frequency of its Rayleigh quotient. keep: what counts of the past.
static double damping_of(quotient* q, const ancf_model* m, const double* mass, const double* before, const double* rate,
                         double keep) {
    q->stiffness *= keep;
    q->inertia *= keep;
    for (int c = 0; c < 3; ++c)
        for (int i = 0; i < m->n_dof; ++i) {
            const int j = c * m->stride + i;
            q->stiffness += rate[j] * (before[j] - m->f[j]);
            q->inertia += mass[j] * rate[j] * rate[j];
        }
    return q->stiffness > 0.0 && q->inertia > 0.0 ? fmin(2.0 * sqrt(q->stiffness / q->inertia), 1.9) : 0.0;
}

static void relaxation_step(ancf_model* m, const double* mass, double* rate, double damping) {
    const double keep = (2.0 - damping) / (2.0 + damping), push = 2.0 / (2.0 + damping);
    for (int c = 0; c < 3; ++c)
        for (int i = 0; i < m->n_dof; ++i) {
            const int j = c * m->stride + i;
            if (m->hold[i] || mass[j] <= 0.0) continue;
            rate[j] = keep * rate[j] + push * m->f[j] / mass[j];
            m->x[j] += rate[j];
        }
}

// What keeps contacts from bouncing, with the rest of the step.
static void drag_step(ancf_model* m, const ancf_rest* rest, const double* mass, double* rate, double damping) {
    const double push = 2.0 / (2.0 + damping);
    const double* drag = ancf_rest_drag(rest);
    for (int c = 0; c < 3; ++c)
        for (int i = 0; i < m->n_dof; ++i) {
            const int j = c * m->stride + i;
            if (m->hold[i] || drag[j] == 0.0) continue;
            const double more = push * drag[j] / mass[j];
            rate[j] += more;
            m->x[j] += more;
        }
}

// Takes a step back as far as it was longer than `leap` [m].
static void shorten(ancf_model* m, double* rate, double leap) {
    double longest = 0.0;
    for (int c = 0; c < 3; ++c)
        for (int i = 0; i < m->n_dof; ++i)
            longest = fmax(longest, fabs(rate[c * m->stride + i]) * (i < m->n_nodes ? 1.0 : unit_length(m, i) / 3.0));
    if (longest <= leap) return;
    const double over = 1.0 - leap / longest;
    for (int j = 0; j < 3 * m->stride; ++j) {
        m->x[j] -= over * rate[j];
        rate[j] -= over * rate[j];
    }
}

// Adds the forces of contact; near: masses with those that contacts need.
static void touch(ancf_model* m, ancf_rest* rest, double* near, const double* mass, const double* rate) {
    ancf_rest_press(rest, m, rate);
    const double *force = ancf_rest_force(rest), *inertia = ancf_rest_inertia(rest);
    for (int j = 0; j < 3 * m->stride; ++j) {
        m->f[j] += force[j];
        near[j] = mass[j] + inertia[j];
    }
}

static const double fading = 0.97; // contacts make it noisy

ancf_error ancf_equilibrium(ancf_model* m, double tolerance, int iterations, ancf_rest* rest) {
    enum { REFRESH = 100 };
    const size_t field = 3 * (size_t)m->stride;
    double *rate = m->work + 2 * field, *before = rate + field, *mass = before + field, *still = mass + field;
    double* near = m->work; // masses where it may touch
    memset(m->v, 0, field * sizeof *m->v);
    if (!ancf_hang(m, rest)) return ANCF_E_MEMORY;
    if (ancf_settle(m, tolerance, rest)) return ANCF_OK;
    memset(rate, 0, 4 * field * sizeof *rate);
    double damping = 0.0, stiffening = 0.0;
    quotient motion = {0.0, 0.0};
    for (int k = 0; k < iterations; ++k) {
        if (k % REFRESH == 0) {
            int element;
            const double needed = 1.2 * ancf_stiffening(0, ancf_strain_max(m, m->x, &element));
            if (needed > stiffening || needed < 0.5 * stiffening) fictitious_mass(mass, m, stiffening = needed);
        }
        memcpy(before, m->f, field * sizeof *before);
        ancf_total_force(m, m->x, still);
        const int pairs = rest ? ancf_rest_look(rest, m, rate) : 0;
        if (pairs < 0) return ANCF_E_MEMORY;
        if (pairs > 0) touch(m, rest, near, mass, rate);
        ancf_slides_project(m, m->f);
        if (ancf_imbalance(m) < tolerance) return ANCF_OK;
        const double* inertia = pairs > 0 ? near : mass;
        if (k > 0) damping = damping_of(&motion, m, inertia, before, rate, pairs > 0 ? fading : 0.0);
        relaxation_step(m, inertia, rate, damping);
        if (pairs > 0) drag_step(m, rest, inertia, rate, damping);
        if (pairs > 0) shorten(m, rate, ancf_rest_leap(rest));
        ancf_slides_project(m, rate);
        ancf_slides_place(m);
    }
    return ANCF_E_EQUILIBRIUM;
}
