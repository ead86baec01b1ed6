#include "settle.h"
#include "ancf/balance.h"
#include "ancf/elastic.h"
#include "ancf/stability.h"
#include "slide.h"
#include "stiffness.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// Newton's method on the energy: (mu M + K) change = force, each step shortened until the energy falls. Mass takes the
// place of the stiffness that a slack cable, or one that is far from rest, does not have; mu goes down as steps
// succeed, and near the solution nothing but K is left (Levenberg 1944, Marquardt 1963).

enum { ITERATIONS = 400, HALVINGS = 10 };
static const double farthest = 0.3; // that anything turns or stretches at once, as slope

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

// Finds m->f, and by how much it is off.
static double force_off(ancf_model* m, const double* still) {
    ancf_total_force(m, m->x, still);
    ancf_slides_project(m, m->f);
    return ancf_imbalance(m);
}

// The part of a change that is not too far to follow: nothing turns or stretches by more than `farthest`, and no node
// goes farther than all elements are long together, so that what has nothing to hold it does not get lost.
static double allowed_part(const ancf_model* m, const double* change) {
    double reach = 0.0, way = 0.0;
    for (int e = 0; e < m->n_elements; ++e) reach += m->element[e].length;
    for (int c = 0; c < 3; ++c)
        for (int i = 0; i < m->n_nodes; ++i) way = fmax(way, fabs(change[c * m->stride + i]));
    return fmin(1.0, fmin(farthest / ancf_stiffness_turn(m, change), reach / way));
}

// Goes through a change, or a part of it, as far as the energy falls, or the force where the energy is known no better;
// by how often it was halved, or -1.
static int go(ancf_model* m, const double* change, double* before, const double* still, double* left) {
    double part = 1.0;
    const double energy = potential(m), force = *left;
    memcpy(before, m->x, 3 * (size_t)m->stride * sizeof *before);
    for (int k = 0; k < HALVINGS; ++k, part *= 0.5) {
        for (int i = 0; i < 3 * m->stride; ++i) m->x[i] = before[i] + part * change[i];
        ancf_slides_place(m);
        *left = force_off(m, still);
        if (potential(m) < energy || *left < 0.5 * force) return k;
    }
    memcpy(m->x, before, 3 * (size_t)m->stride * sizeof *before);
    force_off(m, still);
    *left = force;
    return -1;
}

static bool find(ancf_model* m, ancf_stiffness* s, double tolerance, ancf_rest* rest, double* fields) {
    const size_t field = 3 * (size_t)m->stride;
    double *still = fields, *change = still + field, *before = change + field;
    const double w = highest_frequency(m), top = w * w;
    double mu = 1e-4 * top;
    if (rest && !ancf_rest_clear(rest, m, still)) return false;
    double left = force_off(m, still);
    for (int k = 0; k < ITERATIONS && mu < 1e3 * top; ++k) {
        if (left < tolerance) return true;
        if (!ancf_stiffness_factor(s, m, m->x, still, mu, 0.0, false) &&
            !ancf_stiffness_factor(s, m, m->x, still, mu, 0.0, true)) {
            mu *= 10.0;
            continue;
        }
        ancf_stiffness_solve(s, m, change, m->f);
        if (!isfinite(ancf_stiffness_size(s, m, change))) return false;
        const double part = allowed_part(m, change);
        for (size_t i = 0; i < field; ++i) change[i] *= part;
        if (rest && !ancf_rest_clear(rest, m, change)) return false;
        const int halved = go(m, change, before, still, &left);
        mu *= halved < 0 ? 100.0 : halved > 1 ? 3.0 : part < 1.0 ? 0.5 : 0.1;
    }
    return false;
}

bool ancf_settle(ancf_model* m, double tolerance, ancf_rest* rest) {
    const size_t field = 3 * (size_t)m->stride;
    ancf_stiffness* s = NULL;
    double* fields = calloc(4 * field, sizeof *fields);
    if (!fields || ancf_stiffness_create(&s, m)) {
        free(fields);
        return false;
    }
    double* start = fields + 3 * field;
    memcpy(start, m->x, field * sizeof *start);
    const bool found = find(m, s, tolerance, rest, fields);
    if (!found) memcpy(m->x, start, field * sizeof *start);
    ancf_stiffness_destroy(s);
    free(fields);
    return found;
}
