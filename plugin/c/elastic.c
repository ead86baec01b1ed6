#include "ancf/elastic.h"
#include "account.h"
#include "ancf/shape.h"
#include "gram.h"
#include "tile.h"

#include <math.h>

// Where a field has the forces on a tile's slopes.
static void put_slopes(ancf_fields* k, const ancf_model* m, const ancf_tile* t, double* field) {
    for (int c = 0; c < 3; ++c) {
        k->f0[c] = field + c * m->stride + m->n_nodes + t->begin;
        k->f1[c] = k->f0[c] + m->n_elements;
    }
}

void ancf_elastic_force(ancf_model* m, double* force, const double* x, const double* v) {
    double way[3][ANCF_TILE], wayv[3][ANCF_TILE];
    for (const ancf_tile* t = m->tile; t < m->tile + m->n_tiles; ++t) {
        ancf_fields k = ancf_tile_fields(m, t, x, v, way, wayv);
        put_slopes(&k, m, t, force);
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

static void add(ancf_account* sum, const ancf_account* more) {
    sum->axial += more->axial;
    sum->bending += more->bending;
}

void ancf_elastic_energy(double* axial, double* bending, const ancf_model* m, const double* x, int begin, int end) {
    double way[3][ANCF_TILE], wayv[3][ANCF_TILE];
    ancf_account sum = {0}, one;
    for (const ancf_tile* t = m->tile; t < m->tile + m->n_tiles; ++t) {
        ancf_tile part = *t;
        if (part.begin < begin) part.begin = begin;
        if (part.end > end) part.end = end;
        if (part.begin >= part.end) continue;
        ancf_fields k = ancf_tile_fields(m, &part, x, x, way, wayv);
        k.inv_length = m->inv_length + part.begin;
        k.ea = m->ea_length + part.begin;
        k.ei = m->ei_length + part.begin;
        k.eta = m->damping + part.begin;
        ancf_kernel_books(&one, &k, t->kind, t->bending, false);
        add(&sum, &one);
    }
    *axial = sum.axial;
    *bending = sum.bending;
}

static bool slows(const ancf_tile* t) { return t->damped || t->kind & ANCF_SPRING; }

// Kelvin-Voigt forces of a tile in m->work: those on slopes where a field has them, those on nodes behind the field.
static void find_books(ancf_fields* k, const ancf_model* m, const ancf_tile* t) {
    put_slopes(k, m, t, m->work);
    for (int c = 0; c < 3; ++c) k->fd[c] = m->work + 3 * m->stride + c * m->n_elements + t->begin;
}

void ancf_elastic_force_booked(ancf_books* books, ancf_model* m, double* force, const double* x, const double* v) {
    double way[3][ANCF_TILE], wayv[3][ANCF_TILE], power;
    ancf_account sum = {0}, one;
    books->power = 0.0;
    for (const ancf_tile* t = m->tile; t < m->tile + m->n_tiles; ++t) {
        ancf_fields k = ancf_tile_fields(m, t, x, v, way, wayv);
        put_slopes(&k, m, t, force);
        ancf_kernel(&k, t->kind, t->bending, t->damped);
        find_books(&k, m, t);
        ancf_kernel_books(&one, &k, t->kind, t->bending, slows(t));
        add(&sum, &one);
        if (!slows(t)) continue;
        ancf_kernel_power(&power, &k);
        books->power += power;
    }
    ancf_tile_gather(force, m, 0, m->n_nodes);
    books->elastic = sum.axial + sum.bending;
}

double ancf_elastic_power(const ancf_model* m, const double* v) {
    double wayv[3][ANCF_TILE], sum = 0.0, power;
    for (const ancf_tile* t = m->tile; t < m->tile + m->n_tiles; ++t) {
        if (!slows(t)) continue;
        ancf_fields k = {.n = t->end - t->begin};
        find_books(&k, m, t);
        ancf_tile_rates(&k, m, t, v, wayv);
        ancf_kernel_power(&power, &k);
        sum += power;
    }
    return sum;
}

double ancf_damping_power(const ancf_model* m, const double* x, const double* v) {
    double way[3][ANCF_TILE], wayv[3][ANCF_TILE], force[9][ANCF_TILE], sum = 0.0, power;
    ancf_account unused;
    for (const ancf_tile* t = m->tile; t < m->tile + m->n_tiles; ++t) {
        if (!slows(t)) continue;
        ancf_fields k = ancf_tile_fields(m, t, x, v, way, wayv);
        for (int c = 0; c < 3; ++c) {
            k.f0[c] = force[c];
            k.f1[c] = force[3 + c];
            k.fd[c] = force[6 + c];
        }
        ancf_kernel_books(&unused, &k, t->kind, t->bending, true);
        ancf_kernel_power(&power, &k);
        sum -= power;
    }
    return sum;
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
        const double strain = spring ? sqrt(square) - 1.0 : 0.5 * (square - 1.0);
        if (strain > largest) {
            largest = strain;
            *element = e;
        }
    }
    return largest;
}
