#include "stiffness.h"
#include "ancf/mass.h"
#include "ancf/tangent.h"
#include "internal.h"

#include <stdlib.h>
#include <string.h>

// Blocks of an element's unknowns (r0, g0, r1, g1) on and below the diagonal.
enum { ELEMENT_PAIRS = 10 };
static const int pair_row[ELEMENT_PAIRS] = {0, 1, 1, 2, 2, 2, 3, 3, 3, 3};
static const int pair_column[ELEMENT_PAIRS] = {0, 0, 1, 0, 1, 2, 0, 1, 2, 3};

// Unknowns in the order of elements, so that a chain is a band: start node, start slope, end node, end slope.
static int number_unknowns(int* unknown, const ancf_model* m) {
    int n = 0;
    for (int i = 0; i < m->n_dof; ++i) unknown[i] = -1;
    for (int e = 0; e < m->n_elements; ++e) {
        int dof[4];
        const bool spring = m->element[e].kind & ANCF_SPRING;
        ancf_model_dofs(dof, m, e);
        for (int i = 0; i < 4; ++i) {
            if (m->hold[dof[i]] || unknown[dof[i]] >= 0 || (i % 2 == 1 && spring)) continue;
            unknown[dof[i]] = n++;
            if (i == 3 && m->next[e] >= 0) unknown[m->n_nodes + m->next[e]] = unknown[dof[i]];
            if (i != 1) continue;
            for (int k = m->first[dof[0]]; k < m->first[dof[0] + 1]; ++k) { // whose end this start goes on from
                const int other = m->at[k] >> 1;
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
            int* place = &s->place[p * m->n_elements + e];
            *place = -1;
            if (i < 0 || j < 0) continue;
            *place = i < j ? 2 * ancf_ldl_place(s->ldl, j, i) + 1 : 2 * ancf_ldl_place(s->ldl, i, j);
            s->mass[*place >> 1] += M[pair_row[p]][pair_column[p]];
        }
    }
    for (int i = 0; i < m->n_nodes; ++i)
        if (s->row[i] >= 0) s->mass[s->ldl->begin[s->row[i]]] += ancf_mass_added(m, i);
}

static ancf_error fill(ancf_stiffness* s, const ancf_model* m, int* pair) {
    const size_t n = (size_t)m->n_elements;
    const int unknowns = number_unknowns(s->row, m);
    const ancf_error error = ancf_ldl_create(&s->ldl, unknowns, pair, element_pairs(pair, m, s->row));
    if (error) return error;
    s->mass = calloc(unknowns > 0 ? (size_t)s->ldl->begin[unknowns] : 1, sizeof *s->mass);
    s->tangent = calloc(ANCF_TANGENT * n, sizeof *s->tangent);
    if (!s->mass || !s->tangent) return ANCF_E_MEMORY;
    for (int i = 0; i < m->n_dof; ++i)
        if (s->row[i] >= 0) s->row[i] = s->ldl->row[s->row[i]];
    find_places(s, m);
    return ANCF_OK;
}

ancf_error ancf_stiffness_create(ancf_stiffness** stiffness, const ancf_model* m) {
    ancf_stiffness* s = *stiffness = calloc(1, sizeof *s);
    if (!s) return ANCF_E_MEMORY;
    int* pair = calloc(2 * ELEMENT_PAIRS * (size_t)m->n_elements, sizeof *pair);
    s->row = calloc((size_t)m->n_dof, sizeof *s->row);
    s->place = calloc(ELEMENT_PAIRS * (size_t)m->n_elements, sizeof *s->place);
    const ancf_error error = pair && s->row && s->place ? fill(s, m, pair) : ANCF_E_MEMORY;
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
    free(s->place);
    free(s->mass);
    free(s->tangent);
    free(s);
}

// Adds factor A to a block, A row by row.
ANCF_INLINE void add_block(ancf_block* value, int place, const double A[9], double factor) {
    if (place < 0) return;
    ancf_column* B = value[place >> 1];
    const int down = place & 1 ? 3 : 1, right = place & 1 ? 1 : 3;
    for (int j = 0; j < 3; ++j)
        for (int i = 0; i < 3; ++i) B[j][i] += factor * A[right * i + down * j];
}

// Adds factor A^T.
ANCF_INLINE void add_transposed(ancf_block* value, int place, const double A[9], double factor) {
    add_block(value, place < 0 ? place : place ^ 1, A, factor);
}

ANCF_INLINE void read_symmetric(double A[9], const double* tangent) {
    static const int entry[9] = {0, 1, 2, 1, 3, 4, 2, 4, 5};
    for (int k = 0; k < 9; ++k) A[k] = tangent[entry[k]];
}

ANCF_CLONES static void add_element(ancf_stiffness* s, const ancf_model* m, int e) {
    const int n = m->n_elements;
    const double inv = m->inv_length[e], *t = s->tangent + e * ANCF_TANGENT;
    double g0g0[9], dd[9], g1g1[9], g0d[9], g0g1[9], dg1[9];
    int at[ELEMENT_PAIRS];
    for (int p = 0; p < ELEMENT_PAIRS; ++p) at[p] = s->place[p * n + e];
    read_symmetric(g0g0, t);
    read_symmetric(dd, t + 6);
    read_symmetric(g1g1, t + 12);
    for (int k = 0; k < 9; ++k) {
        g0d[k] = t[18 + k];
        g0g1[k] = t[27 + k];
        dg1[k] = t[36 + k];
    }
    ancf_block* value = s->ldl->value;
    add_block(value, at[0], dd, inv * inv);
    add_block(value, at[1], g0d, -inv);
    add_block(value, at[2], g0g0, 1.0);
    add_block(value, at[3], dd, -inv * inv);
    add_transposed(value, at[4], g0d, inv);
    add_block(value, at[5], dd, inv * inv);
    add_transposed(value, at[6], dg1, -inv);
    add_transposed(value, at[7], g0g1, 1.0);
    add_transposed(value, at[8], dg1, inv);
    add_block(value, at[9], g1g1, 1.0);
}

bool ancf_stiffness_factor(ancf_stiffness* s, const ancf_model* m, const double* x, const double* v, double mu,
                           double rate, bool definite) {
    ancf_ldl* ldl = s->ldl;
    if (ldl->n == 0) return true;
    ancf_tangent(s->tangent, m, x, v, rate, definite);
    for (int k = 0; k < ldl->begin[ldl->n]; ++k) {
        memset(ldl->value[k], 0, sizeof ldl->value[k]);
        for (int c = 0; c < 3; ++c) ldl->value[k][c][c] = mu * s->mass[k];
    }
    for (int e = 0; e < m->n_elements; ++e) add_element(s, m, e);
    return ancf_ldl_factor(ldl);
}

void ancf_stiffness_solve(ancf_stiffness* s, const ancf_model* m, double* change, const double* force) {
    for (int i = 0; i < m->n_dof; ++i) {
        if (s->row[i] < 0) continue;
        ancf_column* b = &s->ldl->rhs[s->row[i]];
        for (int c = 0; c < 3; ++c) (*b)[c] = force[c * m->stride + i];
    }
    ancf_ldl_solve(s->ldl);
    for (int i = 0; i < m->n_dof; ++i)
        for (int c = 0; c < 3; ++c) change[c * m->stride + i] = s->row[i] < 0 ? 0.0 : s->ldl->rhs[s->row[i]][c];
}
