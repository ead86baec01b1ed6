#include "ancf/model.h"
#include "ancf/mass.h"
#include "ancf/shape.h"
#include "slide.h"
#include "tile.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { LANES = 8 };

int ancf_stride(int n_nodes, int n_elements) { return (n_nodes + 2 * n_elements + LANES - 1) / LANES * LANES; }

static bool is_finite_positive(double value) { return isfinite(value) && value > 0.0; }

static ancf_error check_element(const ancf_element* e) {
    if (e->kind & ~(ANCF_SPRING | ANCF_LUMPED | ANCF_AXIAL_REDUCED | ANCF_CURVATURE_EXACT | ANCF_ENGINEERING))
        return ANCF_E_KIND;
    if (!is_finite_positive(e->length)) return ANCF_E_LENGTH;
    if (!is_finite_positive(e->ea) || !isfinite(e->ei) || e->ei < 0.0) return ANCF_E_STIFFNESS;
    if (!is_finite_positive(e->rho_a)) return ANCF_E_MASS;
    if (!isfinite(e->damping) || e->damping < 0.0) return ANCF_E_DAMPING;
    if (!isfinite(e->drag) || e->drag < 0.0) return ANCF_E_DRAG;
    if ((e->kind & ANCF_SPRING) && e->ei > 0.0) return ANCF_E_SPRING;
    return ANCF_OK;
}

static ancf_error check_elements(const ancf_def* def, int* where) {
    for (int e = 0; e < def->n_elements; ++e) {
        *where = e;
        const int start = def->ends[2 * e], end = def->ends[2 * e + 1];
        if (start < 0 || end < 0 || start >= def->n_nodes || end >= def->n_nodes || start == end) return ANCF_E_NODE;
        const ancf_error error = check_element(&def->element[e]);
        if (error) return error;
    }
    return ANCF_OK;
}

// A slope is shared by two elements at most, at one node, and not by springs.
static ancf_error check_next(const ancf_def* def, int* where) {
    unsigned char* used = calloc((size_t)def->n_elements, 1);
    if (!used) return ANCF_E_MEMORY;
    ancf_error error = ANCF_OK;
    for (int e = 0; e < def->n_elements && !error; ++e) {
        const int k = def->next[e];
        if (k == -1) continue;
        *where = e;
        if (k < 0 || k >= def->n_elements || used[k] || def->ends[2 * k] != def->ends[2 * e + 1] ||
            ((def->element[e].kind | def->element[k].kind) & ANCF_SPRING))
            error = ANCF_E_NEXT;
        else used[k] = 1;
    }
    free(used);
    return error;
}

static ancf_error check_masses(const ancf_def* def, int* where) {
    for (int i = 0; def->mass && i < def->n_nodes; ++i) {
        *where = i;
        if (!isfinite(def->mass[i]) || def->mass[i] < 0.0) return ANCF_E_MASS;
    }
    return ANCF_OK;
}

// What moves is moved by elements.
static ancf_error check_loose(const ancf_def* def, int* where) {
    unsigned char* met = calloc((size_t)def->n_nodes, 1);
    if (!met) return ANCF_E_MEMORY;
    for (int k = 0; k < 2 * def->n_elements; ++k) met[def->ends[k]] = 1;
    ancf_error error = ANCF_OK;
    for (int i = 0; i < def->n_nodes && !error; ++i) {
        if (met[i] || (def->hold && def->hold[i])) continue;
        *where = i;
        error = ANCF_E_LOOSE;
    }
    free(met);
    return error;
}

static bool is_slide(const ancf_def* def, const ancf_slide* s) {
    const double *d = s->along, *at = s->at, square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    return s->node >= 0 && s->node < def->n_nodes && !(def->hold && def->hold[s->node]) && fabs(square - 1.0) < 1e-12 &&
           isfinite(at[0]) && isfinite(at[1]) && isfinite(at[2]);
}

static ancf_error check_slides(const ancf_def* def, int* where) {
    for (int i = 0; i < def->n_slides; ++i) {
        *where = def->slide[i].node;
        if (!is_slide(def, &def->slide[i])) return ANCF_E_SLIDE;
        for (int j = 0; j < i; ++j)
            if (def->slide[j].node == def->slide[i].node) return ANCF_E_SLIDE;
    }
    return ANCF_OK;
}

static ancf_error check_state(const ancf_def* def, const double* x, const double* v, int* where) {
    const int n = def->n_nodes + 2 * def->n_elements, stride = ancf_stride(def->n_nodes, def->n_elements);
    for (int c = 0; c < 3; ++c)
        for (int i = 0; i < n; ++i) {
            *where = i < def->n_nodes ? i : (i - def->n_nodes) % def->n_elements;
            if (!isfinite(x[c * stride + i]) || !isfinite(v[c * stride + i])) return ANCF_E_STATE;
        }
    return ANCF_OK;
}

ancf_error ancf_model_check(const ancf_def* def, const double* x, const double* v, int* where) {
    *where = 0;
    if (def->n_nodes < 1 || def->n_elements < 1) return ANCF_E_EMPTY;
    ancf_error error = check_elements(def, where);
    if (!error) error = check_next(def, where);
    if (!error) error = check_masses(def, where);
    if (!error) error = check_loose(def, where);
    if (!error) error = check_slides(def, where);
    return error ? error : check_state(def, x, v, where);
}

static bool allocate(ancf_model* m) {
    const size_t n = (size_t)m->n_nodes, e = (size_t)m->n_elements, field = 3 * (size_t)m->stride;
    m->element = calloc(e, sizeof *m->element);
    m->ends = calloc(2 * e, sizeof *m->ends);
    m->next = calloc(e, sizeof *m->next);
    m->hold = calloc((size_t)m->stride, sizeof *m->hold);
    m->shared = calloc(2 * e, sizeof *m->shared);
    m->is_held = calloc((size_t)m->stride, sizeof *m->is_held);
    m->tile = calloc(e + 1, sizeof *m->tile);
    m->seam = calloc(2 * e, sizeof *m->seam);
    m->knots = calloc(n, sizeof *m->knots);
    m->first = calloc(n + 1, sizeof *m->first);
    m->at = calloc(2 * e, sizeof *m->at);
    m->sign = calloc(2 * e, sizeof *m->sign);
    m->inv_length = calloc(5 * e, sizeof *m->inv_length);
    m->weight = calloc((size_t)m->stride, sizeof *m->weight);
    m->external = calloc(5 * field, sizeof *m->external);
    m->pull = calloc(3 * e, sizeof *m->pull);
    m->work = calloc(6 * field, sizeof *m->work);
    if (!m->element || !m->ends || !m->next || !m->hold || !m->shared || !m->is_held || !m->tile || !m->seam ||
        !m->knots || !m->first || !m->at || !m->sign || !m->inv_length || !m->weight || !m->external || !m->pull ||
        !m->work)
        return false;
    m->ea_length = m->inv_length + e;
    m->ei_length = m->ea_length + e;
    m->damping = m->ei_length + e;
    m->goes_on = m->damping + e;
    m->held = m->external + field;
    m->f = m->held + field;
    m->a = m->f + field;
    m->free = m->a + field;
    return true;
}

static void copy_elements(ancf_model* m, const ancf_def* def) {
    for (int e = 0; e < m->n_elements; ++e) {
        const ancf_element* el = &def->element[e];
        m->element[e] = *el;
        m->ends[2 * e] = def->ends[2 * e];
        m->ends[2 * e + 1] = def->ends[2 * e + 1];
        m->next[e] = def->next[e];
        m->inv_length[e] = 1.0 / el->length;
        m->ea_length[e] = el->ea * el->length / 4.0;
        m->ei_length[e] = el->ei / el->length;
        m->damping[e] = el->damping;
        if (el->drag > 0.0) m->dragged = true;
    }
    if (def->hold) memcpy(m->hold, def->hold, (size_t)m->n_dof * sizeof *m->hold);
}

// Lists what is shared and what is held. A slope that is held at one of its copies is held at both.
static void list_places(ancf_model* m) {
    for (int e = 0; e < m->n_elements; ++e) {
        if (m->next[e] < 0) continue;
        const int start = m->n_nodes + m->next[e], end = m->n_nodes + m->n_elements + e;
        m->shared[2 * m->n_shared] = start;
        m->shared[2 * m->n_shared++ + 1] = end;
        if (m->hold[start] || m->hold[end]) m->hold[start] = m->hold[end] = ANCF_HELD;
    }
    for (int i = 0; i < m->n_dof; ++i)
        if (m->hold[i]) m->is_held[m->n_held++] = i;
}

static ancf_error copy_slides(ancf_model* m, const ancf_def* def) {
    if (def->n_slides == 0) return ANCF_OK;
    m->slide = calloc((size_t)def->n_slides, sizeof *m->slide);
    m->slide_of = calloc((size_t)m->n_nodes, sizeof *m->slide_of);
    if (!m->slide || !m->slide_of) return ANCF_E_MEMORY;
    m->n_slides = def->n_slides;
    memcpy(m->slide, def->slide, (size_t)m->n_slides * sizeof *m->slide);
    for (int i = 0; i < m->n_nodes; ++i) m->slide_of[i] = -1;
    for (int i = 0; i < m->n_slides; ++i) m->slide_of[m->slide[i].node] = i;
    return ANCF_OK;
}

// Which element ends meet at a node, in the order of the elements: the order of all sums.
static void find_ends(ancf_model* m) {
    for (int k = 0; k < 2 * m->n_elements; ++k) m->first[m->ends[k] + 1]++;
    for (int i = 0; i < m->n_nodes; ++i) m->first[i + 1] += m->first[i];
    int* fill = m->first;
    for (int k = 0; k < 2 * m->n_elements; ++k) m->at[fill[m->ends[k]]++] = k;
    for (int i = m->n_nodes; i > 0; --i) m->first[i] = m->first[i - 1];
    m->first[0] = 0;
    for (int k = 0; k < 2 * m->n_elements; ++k) m->sign[k] = m->at[k] & 1 ? 1.0 : -1.0;
}

// Gravity acts on the true curve, so that a cable sags the same however its mass is lumped.
static void weigh(ancf_model* m) {
    for (int e = 0; e < m->n_elements; ++e) {
        double w[4];
        int dof[4];
        ancf_mass_weight(w, &m->element[e]);
        ancf_model_dofs(dof, m, e);
        for (int i = 0; i < 4; ++i) m->weight[dof[i]] += w[i];
    }
    for (int i = 0; i < m->n_nodes; ++i) m->weight[i] += ancf_mass_added(m, i);
    for (int k = 0; k < m->n_shared; ++k) {
        double *start = m->weight + m->shared[2 * k], *end = m->weight + m->shared[2 * k + 1];
        *start = *end = *start + *end;
    }
}

ancf_error ancf_model_create(ancf_model** model, const ancf_def* def, double* x, double* v, int* where) {
    int unused;
    if (!where) where = &unused;
    *model = NULL;
    ancf_error error = ancf_model_check(def, x, v, where);
    if (error) return error;

    ancf_model* m = calloc(1, sizeof *m);
    if (!m) return ANCF_E_MEMORY;
    m->n_nodes = def->n_nodes;
    m->n_elements = def->n_elements;
    m->n_dof = def->n_nodes + 2 * def->n_elements;
    m->stride = ancf_stride(def->n_nodes, def->n_elements);
    m->x = x;
    m->v = v;
    if (!allocate(m)) {
        error = ANCF_E_MEMORY;
    } else {
        copy_elements(m, def);
        list_places(m);
        find_ends(m);
        error = ancf_mass_create(m, def->mass);
        if (!error) error = copy_slides(m, def);
        if (!error) error = ancf_slides_create(m);
    }
    if (!error) {
        weigh(m);
        if (!ancf_tiles_make(m)) error = ANCF_E_MEMORY;
    }
    if (error) {
        ancf_model_destroy(m);
        return error;
    }
    *model = m;
    return ANCF_OK;
}

void ancf_model_destroy(ancf_model* m) {
    if (!m) return;
    ancf_slides_destroy(m);
    ancf_mass_destroy(m->mass);
    free(m->element);
    free(m->ends);
    free(m->next);
    free(m->hold);
    free(m->shared);
    free(m->is_held);
    free(m->tile);
    free(m->seam);
    free(m->knots);
    free(m->first);
    free(m->at);
    free(m->sign);
    free(m->inv_length);
    free(m->weight);
    free(m->external);
    free(m->pull);
    free(m->work);
    free(m);
}

// Weights of an element's four unknowns at xi: cubic, or linear between a spring's ends.
void ancf_model_mean_weights(double S[4], const ancf_model* m, int element, const double power[3]) {
    if (m->element[element].kind & ANCF_SPRING) {
        S[0] = 1.0 - power[0];
        S[1] = S[3] = 0.0;
        S[2] = power[0];
    } else {
        ancf_shape_mean(S, power, m->element[element].length);
    }
}

void ancf_model_weights(double S[4], const ancf_model* m, int element, double xi) {
    double power[3];
    ancf_powers(power, xi);
    ancf_model_mean_weights(S, m, element, power);
}

void ancf_model_slope_weights(double T[4], const ancf_model* m, int element, double xi) {
    if (m->element[element].kind & ANCF_SPRING) {
        T[0] = -1.0;
        T[1] = T[3] = 0.0;
        T[2] = 1.0;
        return;
    }
    double abc[3];
    const double length = m->element[element].length;
    ancf_shape_slope(abc, xi);
    T[0] = -abc[1];
    T[1] = length * abc[0];
    T[2] = abc[1];
    T[3] = length * abc[2];
}

void ancf_model_mean_at(double value[3], const ancf_model* m, const double* field, int element, const double power[3]) {
    double S[4];
    int dof[4];
    ancf_model_mean_weights(S, m, element, power);
    ancf_model_dofs(dof, m, element);
    for (int c = 0; c < 3; ++c) {
        const double* u = field + c * m->stride;
        value[c] = S[0] * u[dof[0]] + S[1] * u[dof[1]] + S[2] * u[dof[2]] + S[3] * u[dof[3]];
    }
}

int ancf_model_twin(const ancf_model* m, int dof) {
    const int k = dof - m->n_nodes, n = m->n_elements;
    if (k < 0) return -1;
    if (k >= n) return m->next[k - n] < 0 ? -1 : m->n_nodes + m->next[k - n];
    const int node = m->ends[2 * k];
    for (int i = m->first[node]; i < m->first[node + 1]; ++i)
        if (m->at[i] & 1 && m->next[m->at[i] >> 1] == k) return m->n_nodes + n + (m->at[i] >> 1);
    return -1;
}

void ancf_model_at(double value[3], const ancf_model* m, const double* field, int element, double xi) {
    double power[3];
    ancf_powers(power, xi);
    ancf_model_mean_at(value, m, field, element, power);
}

void ancf_model_join(const ancf_model* m, double* force) {
    for (int k = 0; k < m->n_shared; ++k)
        for (int c = 0; c < 3; ++c) {
            double *start = force + c * m->stride + m->shared[2 * k],
                   *end = force + c * m->stride + m->shared[2 * k + 1];
            *end = *start = *end + *start;
        }
}
