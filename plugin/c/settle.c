#include "settle.h"
#include "ancf/balance.h"
#include "ancf/elastic.h"
#include "ancf/stability.h"
#include "ancf/step.h"
#include "internal.h"
#include "stiffness.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// Newton's method on the energy: (mu M + K) change = force, each step shortened until the energy falls. Mass takes the
// place of the stiffness that a slack cable, or one that is far from rest, does not have; mu goes down as steps
// succeed, and near the solution nothing but K is left (Levenberg 1944, Marquardt 1963).

enum { ITERATIONS = 150, HALVINGS = 10 };
static const double longest = 0.3; // that anything moves at once, in its sizes (stiffness.h)

static double potential(const ancf_model* m) {
    double axial, bending, work = 0.0;
    ancf_elastic_energy(&axial, &bending, m, m->x, 0, m->n_elements);
    for (int i = 0; i < 3 * m->stride; ++i) work += m->external[i] * m->x[i];
    return axial + bending + ancf_height(m) - work;
}

static double highest_frequency(const ancf_model* m) {
    double w = 0.0;
    for (int e = 0; e < m->n_elements; ++e) w = fmax(w, ancf_element_frequency(&m->element[e]));
    return w;
}

// Goes along the change as far as the energy falls, or the force where the energy is known no better; by how often it
// was halved, or -1.
static int go(ancf_model* m, const double* change, double* before, const double* rest, double part, double* left) {
    const double energy = potential(m), force = *left;
    memcpy(before, m->x, 3 * (size_t)m->stride * sizeof *before);
    for (int k = 0; k < HALVINGS; ++k, part *= 0.5) {
        for (int i = 0; i < 3 * m->stride; ++i) m->x[i] = before[i] + part * change[i];
        ancf_acceleration(m, m->x, rest);
        *left = ancf_imbalance(m);
        if (potential(m) < energy || *left < 0.5 * force) return k;
    }
    memcpy(m->x, before, 3 * (size_t)m->stride * sizeof *before);
    return -1;
}

static bool find(ancf_model* m, ancf_stiffness* s, double tolerance, double* fields) {
    const size_t field = 3 * (size_t)m->stride;
    double *rest = fields, *change = rest + field, *before = change + field;
    const double top = highest_frequency(m) * highest_frequency(m);
    double mu = 1e-4 * top;
    ancf_acceleration(m, m->x, rest);
    double left = ancf_imbalance(m);
    for (int k = 0; k < ITERATIONS && mu < 1e3 * top; ++k) {
        if (left < tolerance) return true;
        if (!ancf_stiffness_factor(s, m, m->x, rest, mu, 0.0, false) &&
            !ancf_stiffness_factor(s, m, m->x, rest, mu, 0.0, true)) {
            mu *= 10.0;
            continue;
        }
        ancf_stiffness_solve(s, m, change, m->f);
        const double size = ancf_stiffness_size(s, m, change);
        if (!isfinite(size)) return false;
        const int halved = go(m, change, before, rest, fmin(1.0, longest / size), &left);
        if (halved < 0) ancf_acceleration(m, m->x, rest);
        mu *= halved < 0 ? 100.0 : halved > 1 ? 3.0 : size > longest ? 0.5 : 0.1;
    }
    return false;
}

bool ancf_settle(ancf_model* m, double tolerance) {
    const size_t field = 3 * (size_t)m->stride;
    ancf_stiffness* s = NULL;
    double* fields = calloc(4 * field, sizeof *fields);
    if (!fields || ancf_stiffness_create(&s, m)) {
        free(fields);
        return false;
    }
    double* start = fields + 3 * field;
    memcpy(start, m->x, field * sizeof *start);
    const bool found = find(m, s, tolerance, fields);
    if (!found) memcpy(m->x, start, field * sizeof *start);
    ancf_stiffness_destroy(s);
    free(fields);
    return found;
}
