#include "stiffness.h"
#include "ancf/mass.h"
#include "ancf/tangent.h"
#include "slide.h"

#include <math.h>
#include <stdlib.h>

// A block of the matrix, and the slides of the nodes whose row and column it is in, or -1.
struct ancf_across {
    int place, row, column;
};

// Blocks of an element's unknowns (r0, g0, r1, g1) on and below the diagonal.
enum { ELEMENT_PAIRS = 10 };
static const int pair_row[ELEMENT_PAIRS] = {0, 1, 1, 2, 2, 2, 3, 3, 3, 3};
static const int pair_column[ELEMENT_PAIRS] = {0, 0, 1, 0, 1, 2, 0, 1, 2, 3};

// Unknowns in the order of elements, so that a chain is a band, but from both ends of their row in turn: what is
// eliminated one after the other then does not wait for each other, until both meet.
static int number_unknowns(int* unknown, const ancf_model* m) {
    int n = 0;
    for (int i = 0; i < m->n_dof; ++i) unknown[i] = -1;
    for (int turn = 0; turn < m->n_elements; ++turn) {
        const bool last = turn % 2;
        const int e = last ? m->n_elements - 1 - turn / 2 : turn / 2;
        int dof[4];
        const bool spring = m->element[e].kind & ANCF_SPRING;
        ancf_model_dofs(dof, m, e);
        for (int k = 0; k < 4; ++k) {
            const int i = last ? (k + 2) % 4 : k; // start node, start slope, end node, end slope, or the end first
            if (m->hold[dof[i]] || unknown[dof[i]] >= 0 || (i % 2 == 1 && spring)) continue;
            unknown[dof[i]] = n++;
            if (i == 3 && m->next[e] >= 0) unknown[m->n_nodes + m->next[e]] = unknown[dof[i]];
            if (i != 1) continue;
            for (int j = m->first[dof[0]]; j < m->first[dof[0] + 1]; ++j) { // whose end this start goes on from
                const int other = m->at[j] >> 1;
                if (m->next[other] == e) unknown[m->n_nodes + m->n_elements + other] = unknown[dof[i]];
            }
        }
    }
    return n;
}

static int element_pairs(int* pair, const ancf_model* m, const int* unknown) {
    int n = 0;
    for (int e = 0; e < m->n_elements; ++e) {
        int dof[4];
        ancf_model_dofs(dof, m, e);
        for (int p = 0; p < ELEMENT_PAIRS; ++p) {
            const int i = unknown[dof[pair_row[p]]], j = unknown[dof[pair_column[p]]];
            if (i < 0 || j < 0 || i == j) continue;
            pair[2 * n] = i;
            pair[2 * n++ + 1] = j;
        }
    }
    return n;
}

static void find_places(ancf_stiffness* s, const ancf_model* m) {
    for (int e = 0; e < m->n_elements; ++e) {
        double M[4][4];
        int dof[4];
        ancf_mass_element(M, &m->element[e]);
        ancf_model_dofs(dof, m, e);
        for (int p = 0; p < ELEMENT_PAIRS; ++p) {
            const int i = s->row[dof[pair_row[p]]], j = s->row[dof[pair_column[p]]];
            int* place = &s->place[e * ELEMENT_PAIRS + p];
            *place = -1;
            if (i < 0 || j < 0) continue;
            *place = i < j ? 2 * ancf_ldl_place(s->ldl, j, i) + 1 : 2 * ancf_ldl_place(s->ldl, i, j);
            s->mass[*place >> 1] += M[pair_row[p]][pair_column[p]];
            s->drag[*place >> 1] += m->element[e].drag * M[pair_row[p]][pair_column[p]];
        }
    }
    for (int i = 0; i < m->n_nodes; ++i)
        if (s->row[i] >= 0) s->mass[s->ldl->begin[s->row[i]]] += ancf_mass_added(m, i);
}

static ancf_error find_across(ancf_stiffness* s, const ancf_model* m) {
    const ancf_ldl* ldl = s->ldl;
    if (m->n_slides == 0) return ANCF_OK;
    int* slide_of = calloc((size_t)ldl->n + 1, sizeof *slide_of);
    s->across = calloc((size_t)ldl->begin[ldl->n], sizeof *s->across);
    if (!slide_of || !s->across) {
        free(slide_of);
        return ANCF_E_MEMORY;
    }
    for (int i = 0; i < ldl->n; ++i) slide_of[i] = -1;
    for (int i = 0; i < m->n_slides; ++i) slide_of[s->row[m->slide[i].node]] = i;
    for (int j = 0; j < ldl->n; ++j)
        for (int k = ldl->begin[j]; k < ldl->begin[j + 1]; ++k) {
            const int row = slide_of[ldl->index[k]], column = slide_of[j];
            if (row >= 0 || column >= 0) s->across[s->n_across++] = (struct ancf_across) {k, row, column};
        }
    free(slide_of);
    return ANCF_OK;
}

static ancf_error fill(ancf_stiffness* s, const ancf_model* m, int* pair) {
    const size_t n = (size_t)m->n_elements;
    const int unknowns = number_unknowns(s->row, m);
    const ancf_error error = ancf_ldl_create(&s->ldl, unknowns, pair, element_pairs(pair, m, s->row));
    if (error) return error;
    const size_t entries = unknowns > 0 ? (size_t)s->ldl->begin[unknowns] : 1;
    s->mass = calloc(entries, sizeof *s->mass);
    s->drag = calloc(entries, sizeof *s->drag);
    s->tangent = calloc(ANCF_TANGENT * n, sizeof *s->tangent);
    if (!s->mass || !s->drag || !s->tangent) return ANCF_E_MEMORY;
    for (int i = 0; i < m->n_dof; ++i)
        if (s->row[i] >= 0) s->row[i] = s->ldl->row[s->row[i]];
    find_places(s, m);
    if (find_across(s, m)) return ANCF_E_MEMORY;
    for (int i = m->n_nodes; i < m->n_dof; ++i) s->per_size[i] = 1.0;
    for (int k = 0; k < 2 * m->n_elements; ++k)
        s->per_size[m->ends[k]] = fmax(s->per_size[m->ends[k]], m->inv_length[k / 2]);
    return ANCF_OK;
}

ancf_error ancf_stiffness_create(ancf_stiffness** stiffness, const ancf_model* m) {
    ancf_stiffness* s = *stiffness = calloc(1, sizeof *s);
    if (!s) return ANCF_E_MEMORY;
    int* pair = calloc(2 * ELEMENT_PAIRS * (size_t)m->n_elements, sizeof *pair);
    s->row = calloc((size_t)m->n_dof, sizeof *s->row);
    s->per_size = calloc((size_t)m->n_dof, sizeof *s->per_size);
    s->place = calloc(ELEMENT_PAIRS * (size_t)m->n_elements, sizeof *s->place);
    const ancf_error error = pair && s->row && s->per_size && s->place ? fill(s, m, pair) : ANCF_E_MEMORY;
    free(pair);
    if (error) {
        ancf_stiffness_destroy(s);
        *stiffness = NULL;
    }
    return error;
}

void ancf_stiffness_destroy(ancf_stiffness* s) {
    if (!s) return;
    ancf_ldl_destroy(s->ldl);
    free(s->row);
    free(s->per_size);
    free(s->place);
    free(s->mass);
    free(s->drag);
    free(s->tangent);
    free(s->across);
    free(s);
}

// Adds factor A to a block.
ANCF_INLINE void add_block(ancf_block* value, int place, const ancf_column A[3], double factor) {
    if (place < 0) return;
    ancf_column* B = value[place >> 1];
    if (place & 1) {
        for (int c = 0; c < 3; ++c)
            for (int i = 0; i < 3; ++i) B[c][i] += factor * A[i][c];
        return;
    }
    for (int c = 0; c < 3; ++c) B[c] += factor * A[c];
}

ANCF_INLINE void read_symmetric(ancf_column A[3], const double* t) {
    A[0] = (ancf_column) {t[0], t[1], t[2], 0.0};
    A[1] = (ancf_column) {t[1], t[3], t[4], 0.0};
    A[2] = (ancf_column) {t[2], t[4], t[5], 0.0};
}

// A block that stands in the tangent row by row, or its transpose: `along` a column, `across` from one to the next.
ANCF_INLINE void read_block(ancf_column A[3], const double* t, int along, int across) {
    for (int c = 0; c < 3; ++c)
        A[c] = (ancf_column) {t[across * c], t[across * c + along], t[across * c + 2 * along], 0.0};
}

ANCF_CLONES static void add_elements(ancf_stiffness* s, const ancf_model* m) {
    const int n = m->n_elements;
    ancf_block* value = s->ldl->value;
    for (int e = 0; e < n; ++e) {
        const double inv = m->inv_length[e], *t = s->tangent + e * ANCF_TANGENT;
        const int* at = s->place + e * ELEMENT_PAIRS;
        ancf_column g0g0[3] = {{0.0}}, dd[3] = {{0.0}}, g1g1[3] = {{0.0}}, g0d[3] = {{0.0}}, dg0[3] = {{0.0}},
                    g1g0[3] = {{0.0}}, g1d[3] = {{0.0}};
        read_symmetric(g0g0, t);
        read_symmetric(dd, t + 6);
        read_symmetric(g1g1, t + 12);
        read_block(g0d, t + 18, 3, 1);
        read_block(dg0, t + 18, 1, 3);
        read_block(g1g0, t + 27, 1, 3);
        read_block(g1d, t + 36, 1, 3);
        add_block(value, at[0], dd, inv * inv);
        add_block(value, at[1], g0d, -inv);
        add_block(value, at[2], g0g0, 1.0);
        add_block(value, at[3], dd, -inv * inv);
        add_block(value, at[4], dg0, inv);
        add_block(value, at[5], dd, inv * inv);
        add_block(value, at[6], g1d, -inv);
        add_block(value, at[7], g1g0, 1.0);
        add_block(value, at[8], g1d, inv);
        add_block(value, at[9], g1g1, 1.0);
    }
}

// D A, A D or both of a block A, with D = d d^T of a line along d: nothing leads across it, nor from there. A node's
// own block gets across its line what keeps the matrix regular.
static void cut(ancf_block A, const double* row, const double* column, bool own) {
    const double size = own ? fabs(A[0][0]) + fabs(A[1][1]) + fabs(A[2][2]) : 0.0;
    for (int c = 0; c < 3 && row; ++c) {
        const double length = row[0] * A[c][0] + row[1] * A[c][1] + row[2] * A[c][2];
        A[c] = (ancf_column) {length * row[0], length * row[1], length * row[2], 0.0};
    }
    if (column) {
        const ancf_column length = column[0] * A[0] + column[1] * A[1] + column[2] * A[2];
        for (int c = 0; c < 3; ++c) A[c] = column[c] * length;
    }
    for (int c = 0; c < 3 && own; ++c)
        for (int i = 0; i < 3; ++i) A[c][i] += size * ((i == c ? 1.0 : 0.0) - row[i] * row[c]);
}

static void cut_across(ancf_stiffness* s, const ancf_model* m) {
    for (int k = 0; k < s->n_across; ++k) {
        const struct ancf_across* at = &s->across[k];
        cut(s->ldl->value[at->place], at->row < 0 ? NULL : m->slide[at->row].along,
            at->column < 0 ? NULL : m->slide[at->column].along, at->row == at->column);
    }
}

bool ancf_stiffness_factor(ancf_stiffness* s, const ancf_model* m, const double* x, const double* v, double mu,
                           double rate, bool definite) {
    ancf_ldl* ldl = s->ldl;
    if (ldl->n == 0) return true;
    ancf_tangent(s->tangent, m, x, v, rate, definite);
    for (int k = 0; k < ldl->begin[ldl->n]; ++k) {
        const double mass = mu * s->mass[k] + rate * s->drag[k];
        ldl->value[k][0] = (ancf_column) {mass, 0.0, 0.0, 0.0};
        ldl->value[k][1] = (ancf_column) {0.0, mass, 0.0, 0.0};
        ldl->value[k][2] = (ancf_column) {0.0, 0.0, mass, 0.0};
    }
    add_elements(s, m);
    cut_across(s, m);
    return ancf_ldl_factor(ldl);
}

void ancf_stiffness_solve(ancf_stiffness* s, const ancf_model* m, double* change, const double* force) {
    for (int i = 0; i < m->n_dof; ++i) {
        if (s->row[i] < 0) continue;
        ancf_column* b = &s->ldl->rhs[s->row[i]];
        for (int c = 0; c < 3; ++c) (*b)[c] = force[c * m->stride + i];
    }
    for (int i = 0; i < m->n_slides; ++i) {
        const double* d = m->slide[i].along;
        ancf_column* b = &s->ldl->rhs[s->row[m->slide[i].node]];
        const double length = d[0] * (*b)[0] + d[1] * (*b)[1] + d[2] * (*b)[2];
        for (int c = 0; c < 3; ++c) (*b)[c] = length * d[c];
    }
    ancf_ldl_solve(s->ldl);
    for (int i = 0; i < m->n_dof; ++i)
        for (int c = 0; c < 3; ++c) change[c * m->stride + i] = s->row[i] < 0 ? 0.0 : s->ldl->rhs[s->row[i]][c];
    ancf_slides_project(m, change);
}

ANCF_CLONES double ancf_stiffness_size(const ancf_stiffness* s, const ancf_model* m, const double* change) {
    double largest = 0.0, sum = 0.0;
    for (int c = 0; c < 3; ++c)
        for (int i = 0; i < m->n_dof; ++i) {
            const double size = s->per_size[i] * fabs(change[c * m->stride + i]);
            largest = size > largest ? size : largest;
            sum += size;
        }
    return isfinite(sum) ? largest : INFINITY;
}

ANCF_CLONES double ancf_stiffness_turn(const ancf_model* m, const double* change) {
    const int n = m->n_elements, s = m->stride;
    double largest = 0.0;
#pragma omp simd reduction(max : largest)
    for (int e = 0; e < n; ++e) {
        const int g0 = m->n_nodes + e, g1 = g0 + n, r0 = m->ends[2 * e], r1 = m->ends[2 * e + 1];
        double start = 0.0, end = 0.0, chord = 0.0;
        for (int c = 0; c < 3; ++c) {
            const double *u = change + c * s, d = (u[r1] - u[r0]) * m->inv_length[e];
            start += u[g0] * u[g0];
            end += u[g1] * u[g1];
            chord += d * d;
        }
        largest = fmax(largest, fmax(chord, fmax(start, end)));
    }
    return sqrt(largest);
}
