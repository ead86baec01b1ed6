#include "tile.h"
#include "ancf/mass.h"

#include <stdlib.h>
#include <string.h>

enum { CHAIN_LEAST = 16, KNOTS = 64 }; // elements of a chain, nodes of a range at most

static int start_of(const ancf_model* m, int e) { return m->n_nodes + e; }

static int end_of(const ancf_model* m, int e) { return m->n_nodes + m->n_elements + e; }

// Whether an element starts where the one before ends, at a node where nothing else is.
static bool follows(const ancf_model* m, int e) {
    const int node = m->ends[2 * e];
    return e > 0 && m->ends[2 * e - 1] == node && m->ends[2 * e - 2] == node - 1 && m->ends[2 * e + 1] == node + 1 &&
           m->first[node + 1] - m->first[node] == 2 && !m->hold[node] && ancf_slide_of(m, node) < 0 &&
           ancf_mass_added(m, node) == 0.0;
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
            ++t->joined;
        }
        t->end = e + 1;
    }
    for (int k = 0; k < m->n_tiles; ++k) {
        const int like = k ? m->tile[k - 1].like : 0;
        m->tile[k].like = alike(m, &m->tile[k], &m->tile[like]) ? like : k;
    }
}

// Slopes at the ends of tiles that are shared or held; both copies of one that is shared at once.
static void list_seams(ancf_model* m, const int* before, const int* tile_of) {
    for (int k = 0; k < m->n_tiles; ++k) {
        ancf_tile* t = &m->tile[k];
        const int end = end_of(m, t->end - 1), next = m->next[t->end - 1], start = start_of(m, t->begin);
        t->start_moves = before[t->begin] < 0 && !m->hold[start];
        t->end_moves = next < 0 && !m->hold[end];
        if (next >= 0) {
            const int other = tile_of[next];
            m->seam[m->n_seams++] =
                (ancf_seam) {{end, start_of(m, next)}, .first = k < other ? k : other, .last = k > other ? k : other};
        } else if (!t->end_moves) {
            m->seam[m->n_seams++] = (ancf_seam) {{end, -1}, k, k};
        }
        if (before[t->begin] < 0 && !t->start_moves) m->seam[m->n_seams++] = (ancf_seam) {{start, -1}, k, k};
    }
}

// Adds a node to the last range, or to a new one.
static ancf_knots* add_knot(ancf_model* m, int node) {
    ancf_knots* last = &m->knots[m->n_knots - 1];
    if (m->n_knots == 0 || last->end != node || node - last->begin == KNOTS) {
        last = &m->knots[m->n_knots++];
        *last = (ancf_knots) {.begin = node, .first = m->n_tiles - 1};
    }
    last->end = node + 1;
    return last;
}

static void list_knots(ancf_model* m, const int* tile_of) {
    for (int i = 0; i < m->n_nodes; ++i) {
        const int* at = m->at + m->first[i];
        const int n = m->first[i + 1] - m->first[i], tile = n ? tile_of[*at >> 1] : 0;
        if (n == 2 && m->tile[tile].chain && tile_of[at[1] >> 1] == tile) continue; // the chain's own
        ancf_knots* k = add_knot(m, i);
        for (int j = 0; j < n; ++j) {
            const int of = tile_of[at[j] >> 1];
            if (of < k->first) k->first = of;
            if (of > k->last) k->last = of;
        }
    }
}

static int by_last_seam(const void* a, const void* b) {
    const ancf_seam *p = a, *q = b;
    return p->last != q->last ? p->last - q->last : p->place[0] - q->place[0];
}

static int by_last_knots(const void* a, const void* b) {
    const ancf_knots *p = a, *q = b;
    return p->last != q->last ? p->last - q->last : p->begin - q->begin;
}

// Sorts them by the tile that they wait for; one tile more tells where the lists end.
static void sort(ancf_model* m) {
    qsort(m->seam, (size_t)m->n_seams, sizeof *m->seam, by_last_seam);
    qsort(m->knots, (size_t)m->n_knots, sizeof *m->knots, by_last_knots);
    int seam = 0, knots = 0;
    for (int t = 0; t <= m->n_tiles; ++t) {
        while (seam < m->n_seams && m->seam[seam].last < t) ++seam;
        while (knots < m->n_knots && m->knots[knots].last < t) ++knots;
        m->tile[t].seam = seam;
        m->tile[t].knots = knots;
    }
}

bool ancf_tiles_make(ancf_model* m) {
    const int n = m->n_elements;
    int *before = malloc(3 * (size_t)n * sizeof *before), *ahead = before + n, *tile_of = ahead + n;
    if (!before) return false;
    for (int e = 0; e < n; ++e) before[e] = -1;
    for (int e = 0; e < n; ++e)
        if (m->next[e] >= 0) before[m->next[e]] = e;
    for (int e = n - 1; e >= 0; --e) ahead[e] = 1 + (e + 1 < n && follows(m, e + 1) ? ahead[e + 1] : 0);
    divide(m, before, ahead);
    for (int t = 0; t < m->n_tiles; ++t)
        for (int e = m->tile[t].begin; e < m->tile[t].end; ++e) tile_of[e] = t;
    list_seams(m, before, tile_of);
    list_knots(m, tile_of);
    sort(m);
    free(before);
    return true;
}

// r1 - r0 of a tile's elements, or its rate.
ANCF_CLONES static void find_ways(double way[3][ANCF_TILE], const ancf_model* m, const ancf_tile* t,
                                  const double* field) {
    const int n = t->end - t->begin, *ends = m->ends + 2 * t->begin;
    const double *x = field, *y = x + m->stride, *z = y + m->stride;
    if (t->chain) {
        x += ends[0];
        y += ends[0];
        z += ends[0];
        for (int e = 0; e < n; ++e) {
            way[0][e] = x[e + 1] - x[e];
            way[1][e] = y[e + 1] - y[e];
            way[2][e] = z[e + 1] - z[e];
        }
        return;
    }
    for (int e = 0; e < n; ++e) {
        const int i = ends[2 * e], j = ends[2 * e + 1];
        way[0][e] = x[j] - x[i];
        way[1][e] = y[j] - y[i];
        way[2][e] = z[j] - z[i];
    }
}

void ancf_tile_rates(ancf_fields* k, const ancf_model* m, const ancf_tile* t, const double* v,
                     double wayv[3][ANCF_TILE]) {
    find_ways(wayv, m, t, v);
    for (int c = 0; c < 3; ++c) {
        k->wayv[c] = wayv[c];
        k->g0v[c] = v + c * m->stride + m->n_nodes + t->begin;
        k->g1v[c] = k->g0v[c] + m->n_elements;
    }
}

ancf_fields ancf_tile_fields(const ancf_model* m, const ancf_tile* t, const double* x, const double* v,
                             double way[3][ANCF_TILE], double wayv[3][ANCF_TILE]) {
    const int like = m->tile[t->like].begin;
    ancf_fields k = {.n = t->end - t->begin,
                     .inv_length = m->inv_length + like,
                     .ea = m->ea_length + like,
                     .ei = m->ei_length + like,
                     .eta = m->damping + like};
    find_ways(way, m, t, x);
    if (t->damped || t->kind & ANCF_SPRING) ancf_tile_rates(&k, m, t, v, wayv);
    for (int c = 0; c < 3; ++c) {
        k.way[c] = way[c];
        k.g0[c] = x + c * m->stride + m->n_nodes + t->begin;
        k.g1[c] = k.g0[c] + m->n_elements;
        k.fd[c] = m->pull + c * m->n_elements + t->begin;
    }
    return k;
}

ANCF_CLONES void ancf_tile_gather(double* restrict force, const ancf_model* m, int begin, int end) {
    const int *at = m->at, *first = m->first;
    const double *pull_x = m->pull, *pull_y = pull_x + m->n_elements, *pull_z = pull_y + m->n_elements, *sign = m->sign;
    double *x = force, *y = x + m->stride, *z = y + m->stride;
    for (int i = begin; i < end; ++i) {
        double sum_x = 0.0, sum_y = 0.0, sum_z = 0.0;
        for (int k = first[i]; k < first[i + 1]; ++k) {
            const int e = at[k] >> 1;
            sum_x += sign[k] * pull_x[e];
            sum_y += sign[k] * pull_y[e];
            sum_z += sign[k] * pull_z[e];
        }
        x[i] = sum_x;
        y[i] = sum_y;
        z[i] = sum_z;
    }
}
