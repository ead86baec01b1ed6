#include "ancf/elastic.h"
#include "ancf/shape.h"
#include "gram.h"
#include "tile.h"

#include <math.h>

bool ancf_elastic_damped(const ancf_model* m) {
    for (int t = 0; t < m->n_tiles; ++t)
        if (m->tile[t].damped) return true;
    return false;
}

void ancf_elastic_force(ancf_model* m, double* force, const double* x, const double* v) {
    double way[3][ANCF_TILE], wayv[3][ANCF_TILE];
    for (const ancf_tile* t = m->tile; t < m->tile + m->n_tiles; ++t) {
        ancf_fields k = ancf_tile_fields(m, t, x, v, way, wayv);
        for (int c = 0; c < 3; ++c) {
            k.f0[c] = force + c * m->stride + m->n_nodes + t->begin;
            k.f1[c] = k.f0[c] + m->n_elements;
        }
        ancf_kernel(&k, t->kind, t->bending, t->damped);
    }
    ancf_tile_gather(force, m, 0, m->n_nodes);
}

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

void ancf_elastic_energy(double* axial, double* bending, const ancf_model* m, const double* x, int begin, int end) {
    double way[3][ANCF_TILE];
    *axial = *bending = 0.0;
    for (const ancf_tile* t = m->tile; t < m->tile + m->n_tiles; ++t) {
        ancf_tile part = *t;
        if (part.begin < begin) part.begin = begin;
        if (part.end > end) part.end = end;
        if (part.begin >= part.end) continue;
        ancf_fields k = ancf_tile_places(m, &part, x, way);
        k.inv_length = m->inv_length + part.begin;
        k.ea = m->ea_length + part.begin;
        k.ei = m->ei_length + part.begin;
        double stretched, bent;
        ancf_kernel_energy(&stretched, &bent, &k, t->kind);
        *axial += stretched;
        *bending += bent;
    }
}

double ancf_damping_power(ancf_model* m, const double* x, const double* v) {
    if (!ancf_elastic_damped(m)) return 0.0;
    const int field = 3 * m->stride;
    double *total = m->work, *elastic = m->work + field, *rest = m->work + 2 * field;
    for (int i = 0; i < field; ++i) rest[i] = 0.0;
    ancf_elastic_force(m, total, x, v);
    ancf_elastic_force(m, elastic, x, rest);
    double power = 0.0;
    for (int c = 0; c < 3; ++c)
        for (int i = 0; i < m->n_dof; ++i) {
            const int j = c * m->stride + i;
            power += (elastic[j] - total[j]) * v[j];
        }
    return power;
}

// r' and its rate at xi.
static void slope_at(double r[3], const ancf_model* m, const double* field, int e, double xi) {
    double g0[3], d[3], g1[3], s[3];
    element_vectors(g0, d, g1, m, field, e);
    ancf_shape_slope(s, xi);
    const bool spring = m->element[e].kind & ANCF_SPRING;
    for (int c = 0; c < 3; ++c) r[c] = spring ? d[c] : s[0] * g0[c] + s[1] * d[c] + s[2] * g1[c];
}

double ancf_strain(const ancf_model* m, const double* x, int element, double xi) {
    double r[3];
    slope_at(r, m, x, element, xi);
    return m->element[element].kind & ANCF_SPRING ? sqrt(ancf_inner(r, r)) - 1.0 : 0.5 * (ancf_inner(r, r) - 1.0);
}

double ancf_tension(const ancf_model* m, int element, double xi) {
    const ancf_element* el = &m->element[element];
    double r[3], rv[3];
    slope_at(r, m, m->x, element, xi);
    slope_at(rv, m, m->v, element, xi);
    const double stretch = sqrt(ancf_inner(r, r));
    if (el->kind & ANCF_SPRING) {
        const double tension = el->ea * (stretch - 1.0 + el->damping * ancf_inner(r, rv) / stretch);
        return stretch > 1.0 && tension > 0.0 ? tension : 0.0;
    }
    return el->ea * (0.5 * (ancf_inner(r, r) - 1.0) + el->damping * ancf_inner(r, rv)) * stretch;
}

double ancf_strain_max(const ancf_model* m, const double* x, int* element) {
    double largest = -1.0;
    for (int e = 0; e < m->n_elements; ++e)
        for (int p = 0; p < 3; ++p) {
            const double strain = ancf_strain(m, x, e, 0.5 * p);
            if (strain > largest) {
                largest = strain;
                *element = e;
            }
        }
    return largest;
}
