#include "tile.h"
#include "ancf/mass.h"

#include <stdlib.h>
#include <string.h>

enum { CHAIN_LEAST = 16, KNOTS = 512 }; // elements of a chain, nodes of a range at most

static int start_of(const ancf_model* m, int e) { return m->n_nodes + e; }

static int end_of(const ancf_model* m, int e) { return m->n_nodes + m->n_elements + e; }

// Whether an element starts where the one before ends, at a node where nothing else is.
static bool follows(const ancf_model* m, int e) {
    const int node = m->ends[2 * e];
    return e > 0 && m->ends[2 * e - 1] == node && m->ends[2 * e - 2] == node - 1 && m->ends[2 * e + 1] == node + 1 &&
           m->first[node + 1] - m->first[node] == 2 && !m->hold[node] && ancf_mass_added(m, node) == 0.0;
}

// Whether a slope moves with its tile: by itself, or with that of the neighbour to which it belongs.
static bool moves(const ancf_model* m, const int* before, int e) {
    const int last = e - 1;
    if (m->hold[start_of(m, e)] || m->hold[end_of(m, last)]) return false;
    return (before[e] < 0 && m->next[last] < 0) || before[e] == last;
}

static bool same_kind(const ancf_tile* t, const ancf_element* el) {
    return t->kind == (el->kind & ~ANCF_LUMPED) && t->bending == (el->ei > 0.0) && t->damped == (el->damping > 0.0);
}

static bool equal(const double* a, int i, int j, int n) { return memcmp(a + i, a + j, (size_t)n * sizeof *a) == 0; }

// Whether all constants of two tiles are the same.
static bool alike(const ancf_model* m, const ancf_tile* a, const ancf_tile* b) {
    const int i = a->begin, j = b->begin, n = a->end - i;
    if (b->end - j != n || a->chain != b->chain) return false;
    const double* of_elements[] = {m->inv_length, m->ea_length, m->ei_length, m->damping, m->goes_on};
    for (size_t k = 0; k < sizeof of_elements / sizeof *of_elements; ++k)
        if (!equal(of_elements[k], i, j, n)) return false;
    const double* of_places[] = {m->weight, ancf_mass_inverse(m)};
    for (int k = 0; k < 2; ++k) {
        const double* p = of_places[k];
        if (!equal(p, start_of(m, i), start_of(m, j), n) || !equal(p, end_of(m, i), end_of(m, j), n)) return false;
        if (a->chain && !equal(p, m->ends[2 * i + 1], m->ends[2 * j + 1], n - 1)) return false;
    }
    return true;
}

// before: (n_elements) element that goes on into this one, or -1; ahead: elements of a chain from this one on.
static void divide(ancf_model* m, const int* before, const int* ahead) {
    ancf_tile* t = NULL;
    for (int e = 0; e < m->n_elements; ++e) {
        const ancf_element* el = &m->element[e];
        const bool goes_on = t && t->end - t->begin < ANCF_TILE && same_kind(t, el) && moves(m, before, e) &&
                             (t->chain ? follows(m, e) : ahead[e] < CHAIN_LEAST);
        if (!goes_on) {
            t = &m->tile[m->n_tiles++];
            *t = (ancf_tile) {.begin = e,
                              .kind = el->kind & ~ANCF_LUMPED,
                              .bending = el->ei > 0.0,
                              .damped = el->damping > 0.0,
                              .chain =
                                  ahead[e] >= CHAIN_LEAST || (e > 0 && t > m->tile && t[-1].chain && follows(m, e))};
        } else if (before[e] == e - 1) {
            m->goes_on[e - 1] = 1.0;
            t->joined = true;
        }
        t->end = e + 1;
    }
    for (int k = 0; k < m->n_tiles; ++k) {
        const int like = k ? m->tile[k - 1].like : 0;
        m->tile[k].like = alike(m, &m->tile[k], &m->tile[like]) ? like : k;
    }
}

// Slopes at the ends of tiles that are shared or held; both copies of one that is shared at once.
static void list_seams(ancf_model* m, const int* before) {
    for (ancf_tile* t = m->tile; t < m->tile + m->n_tiles; ++t) {
        const int end = end_of(m, t->end - 1), next = m->next[t->end - 1], start = start_of(m, t->begin);
        t->start_moves = before[t->begin] < 0 && !m->hold[start];
        t->end_moves = next < 0 && !m->hold[end];
        if (!t->end_moves) {
            m->seam[2 * m->n_seams] = end;
            m->seam[2 * m->n_seams++ + 1] = next >= 0 ? start_of(m, next) : -1;
        }
        if (before[t->begin] < 0 && m->hold[start]) {
            m->seam[2 * m->n_seams] = start;
            m->seam[2 * m->n_seams++ + 1] = -1;
        }
    }
}

static void list_knots(ancf_model* m, const bool* in_chain) {
    ancf_range* last = NULL;
    for (int i = 0; i < m->n_nodes; ++i) {
        if (in_chain[i]) continue;
        if (!last || last->end != i || i - last->begin == KNOTS) {
            last = &m->knots[m->n_knots++];
            last->begin = i;
        }
        last->end = i + 1;
    }
}

static void make(ancf_model* m, int* before, int* ahead, bool* in_chain) {
    for (int e = 0; e < m->n_elements; ++e) before[e] = -1;
    for (int e = 0; e < m->n_elements; ++e)
        if (m->next[e] >= 0) before[m->next[e]] = e;
    for (int e = m->n_elements - 1; e >= 0; --e)
        ahead[e] = 1 + (e + 1 < m->n_elements && follows(m, e + 1) ? ahead[e + 1] : 0);
    divide(m, before, ahead);
    list_seams(m, before);
    for (const ancf_tile* t = m->tile; t < m->tile + m->n_tiles; ++t)
        for (int e = t->begin + 1; e < t->end && t->chain; ++e) in_chain[m->ends[2 * e]] = true;
    list_knots(m, in_chain);
}

bool ancf_tiles_make(ancf_model* m) {
    const size_t n = (size_t)m->n_elements;
    int *before = malloc(n * sizeof *before), *ahead = malloc(n * sizeof *ahead);
    bool* in_chain = calloc((size_t)m->n_nodes, sizeof *in_chain);
    const bool enough = before && ahead && in_chain;
    if (enough) make(m, before, ahead, in_chain);
    free(before);
    free(ahead);
    free(in_chain);
    return enough;
}

ANCF_CLONES static void chain_chords(double* restrict chord, const double* restrict node,
                                     const double* restrict inv_length, int n) {
    for (int e = 0; e < n; ++e) chord[e] = (node[e + 1] - node[e]) * inv_length[e];
}

// (r1 - r0)/L of a tile's elements, or its rate.
static void chords(double chord[3][ANCF_TILE], const ancf_model* m, const ancf_tile* t, const double* field) {
    const int n = t->end - t->begin, *ends = m->ends + 2 * t->begin;
    const double* inv_length = m->inv_length + m->tile[t->like].begin;
    for (int c = 0; c < 3; ++c) {
        const double* u = field + c * m->stride;
        if (t->chain) chain_chords(chord[c], u + ends[0], inv_length, n);
        for (int e = 0; e < n && !t->chain; ++e) chord[c][e] = (u[ends[2 * e + 1]] - u[ends[2 * e]]) * inv_length[e];
    }
}

ancf_fields ancf_tile_fields(const ancf_model* m, const ancf_tile* t, const double* x, const double* v,
                             double d[3][ANCF_TILE], double dv[3][ANCF_TILE], double on[3][ANCF_TILE]) {
    const int like = m->tile[t->like].begin;
    ancf_fields k = {.inv_length = m->inv_length + like,
                     .ea = m->ea_length + like,
                     .ei = m->ei_length + like,
                     .eta = m->damping + like,
                     .n = t->end - t->begin};
    chords(d, m, t, x);
    if (t->damped || t->kind & ANCF_SPRING) chords(dv, m, t, v);
    for (int c = 0; c < 3; ++c) {
        const int start = c * m->stride + m->n_nodes + t->begin, end = start + m->n_elements;
        k.g0[c] = x + start;
        k.g1[c] = x + end;
        k.g0v[c] = v + start;
        k.g1v[c] = v + end;
        k.d[c] = d[c];
        k.dv[c] = dv[c];
        k.fd[c] = on[c];
    }
    return k;
}

ANCF_CLONES static void interleave(double* restrict pull, double on[3][ANCF_TILE], int n) {
    for (int e = 0; e < n; ++e) {
        pull[4 * e] = on[0][e];
        pull[4 * e + 1] = on[1][e];
        pull[4 * e + 2] = on[2][e];
        pull[4 * e + 3] = 0.0;
    }
}

void ancf_tile_keep(const ancf_model* m, const ancf_tile* t, double on[3][ANCF_TILE], bool ends) {
    const int n = t->end - t->begin;
    double* pull = m->pull + 4 * t->begin;
    if (t->chain && ends)
        for (int e = 0; e<n; e += n> 1 ? n - 1 : 1)
            for (int c = 0; c < 3; ++c) pull[4 * e + c] = on[c][e];
    else interleave(pull, on, n);
}

ANCF_CLONES void ancf_tile_gather(double* force, const ancf_model* m, int begin, int end) {
    const int *at = m->at, *first = m->first;
    for (int i = begin; i < end; ++i) {
        double sum[4] = {0.0, 0.0, 0.0, 0.0};
        for (int k = first[i]; k < first[i + 1]; ++k) {
            const double *pull = m->pull + 4 * (at[k] >> 1), sign = at[k] & 1 ? 1.0 : -1.0;
            for (int c = 0; c < 4; ++c) sum[c] += sign * pull[c];
        }
        for (int c = 0; c < 3; ++c) force[c * m->stride + i] = sum[c];
    }
}
