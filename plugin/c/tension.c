#include "ancf/tension.h"
#include "ancf/mass.h"
#include "ancf/shape.h"
#include "gram.h"
#include "internal.h"
#include "tile.h"

#include <float.h>
#include <math.h>

// An element's (g0, d, g1) in a field.
static void element_vectors(double g0[3], double d[3], double g1[3], const ancf_model* m, const double* x, int e) {
    int dof[4];
    ancf_model_dofs(dof, m, e);
    for (int c = 0; c < 3; ++c) {
        const double* u = x + c * m->stride;
        g0[c] = u[dof[1]];
        d[c] = (u[dof[2]] - u[dof[0]]) * m->inv_length[e];
        g1[c] = u[dof[3]];
    }
}

// r' and its rate at xi.
static void slope_at(double r[3], const ancf_model* m, const double* field, int e, double xi) {
    double g0[3], d[3], g1[3], s[3];
    element_vectors(g0, d, g1, m, field, e);
    ancf_shape_slope(s, xi);
    const bool spring = m->element[e].kind & ANCF_SPRING;
    for (int c = 0; c < 3; ++c) r[c] = spring ? d[c] : s[0] * g0[c] + s[1] * d[c] + s[2] * g1[c];
}

// Strain of a square of |r'|.
static double strain_of(double square, int kind) {
    return kind & (ANCF_SPRING | ANCF_ENGINEERING) ? sqrt(square) - 1.0 : 0.5 * (square - 1.0);
}

double ancf_strain(const ancf_model* m, const double* x, int element, double xi) {
    double r[3];
    slope_at(r, m, x, element, xi);
    return strain_of(ancf_inner(r, r), m->element[element].kind);
}

// Internal force in the middle of an element [N]: the mean along it, weighted as the work is of a way of its one end,
// 6 x (1 - x).
static void force_in_the_middle(double force[3], const ancf_model* m, int e) {
    double way[3][ANCF_TILE], wayv[3][ANCF_TILE], on[9];
    const ancf_element* el = &m->element[e];
    const ancf_tile one = {
        .begin = e, .end = e + 1, .kind = el->kind, .bending = el->ei > 0.0, .damped = el->damping > 0.0};
    ancf_fields k = ancf_tile_fields(m, &one, m->x, m->v, way, wayv);
    k.inv_length = m->inv_length + e;
    k.ea = m->ea_length + e;
    k.ei = m->ei_length + e;
    k.eta = m->damping + e;
    for (int c = 0; c < 3; ++c) {
        k.fd[c] = &on[c];
        k.f0[c] = &on[3 + c];
        k.f1[c] = &on[6 + c];
    }
    ancf_kernel(&k, one.kind, one.bending, one.damped);
    for (int c = 0; c < 3; ++c) force[c] = -on[c];
}

// The other element at a node where two of ANCF meet, one going in and one out, and nothing acts; or -1.
static int beyond(const ancf_model* m, int element, int node) {
    const int *at = m->at + m->first[node], count = m->first[node + 1] - m->first[node];
    if (count != 2 || (at[0] & 1) == (at[1] & 1) || m->hold[node] || ancf_slide_of(m, node) >= 0) return -1;
    if (ancf_mass_added(m, node) > 0.0) return -1;
    for (int c = 0; c < 3 && !m->unloaded; ++c)
        if (m->external[c * m->stride + node] != 0.0) return -1;
    const int other = (at[0] >> 1) == element ? at[1] >> 1 : at[0] >> 1;
    return m->element[other].kind & ANCF_SPRING ? -1 : other;
}

double ancf_tension(const ancf_model* m, int element, double xi) {
    const ancf_element* el = &m->element[element];
    double r[3], rv[3];
    slope_at(r, m, m->x, element, xi);
    if (el->kind & ANCF_SPRING) {
        slope_at(rv, m, m->v, element, xi);
        const double stretch = sqrt(ancf_inner(r, r));
        const double tension = el->ea * (stretch - 1.0 + el->damping * ancf_inner(r, rv) / stretch);
        return stretch > 1.0 && tension > 0.0 ? tension : 0.0;
    }
    double middle[3], next[3], force[3];
    force_in_the_middle(middle, m, element);
    int end = xi < 0.5 ? 0 : 1; // the nearer one, or the other if nothing is known beyond that
    int other = beyond(m, element, m->ends[2 * element + end]);
    if (other < 0) {
        end = !end;
        other = beyond(m, element, m->ends[2 * element + end]);
    }
    if (other >= 0) force_in_the_middle(next, m, other);
    for (int c = 0; c < 3; ++c) {
        double rise = -el->rho_a * m->gravity[c]; // per unstressed length
        if (other >= 0) rise = (end ? 2.0 : -2.0) * (next[c] - middle[c]) / (el->length + m->element[other].length);
        force[c] = middle[c] + (xi - 0.5) * el->length * rise;
    }
    return ancf_inner(force, r) / sqrt(ancf_inner(r, r) + DBL_MIN);
}

double ancf_tension_max(int* element, double* xi, const ancf_model* m, int begin, int end, int parts) {
    double largest = -INFINITY;
    *element = begin;
    *xi = 0.0;
    for (int e = begin; e < end; ++e)
        for (int k = 0; k <= parts; ++k) {
            const double at = (double)k / parts, tension = ancf_tension(m, e, at);
            if (tension <= largest) continue;
            largest = tension;
            *element = e;
            *xi = at;
        }
    return largest;
}

double ancf_strain_max(const ancf_model* m, const double* x, int* element) {
    double largest = -INFINITY;
    *element = 0;
    const int starts = m->n_nodes, ends = m->n_nodes + m->n_elements;
    for (int e = 0; e < m->n_elements; ++e) {
        double start = 0.0, middle = 0.0, end = 0.0; // squares of |r'|
        for (int c = 0; c < 3; ++c) {
            const double* u = x + c * m->stride;
            const double g0 = u[starts + e], g1 = u[ends + e];
            const double d = (u[m->ends[2 * e + 1]] - u[m->ends[2 * e]]) * m->inv_length[e];
            const double half = m->element[e].kind & ANCF_SPRING ? d : 1.5 * d - 0.25 * (g0 + g1);
            start += g0 * g0;
            middle += half * half;
            end += g1 * g1;
        }
        const bool spring = m->element[e].kind & ANCF_SPRING;
        const double square = spring ? middle : fmax(fmax(start, end), middle);
        const double strain = strain_of(square, m->element[e].kind);
        if (strain > largest) {
            largest = strain;
            *element = e;
        }
    }
    return largest;
}
