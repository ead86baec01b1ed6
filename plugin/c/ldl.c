#include "ldl.h"
#include "internal.h"

#include <cholmod.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

// ---------------------------------------------------------------- structure

// Takes the columns out of the library's factor of a matrix of ones in the same places.
static ancf_error take_structure(ancf_ldl* a, const cholmod_factor* L) {
    const int n = a->n, *p = L->p, *li = L->i, *order = L->Perm;
    int longest = 0;
    a->begin = calloc((size_t)n + 1, sizeof *a->begin);
    a->index = calloc((size_t)p[n], sizeof *a->index);
    a->row = calloc((size_t)n, sizeof *a->row);
    a->value = calloc((size_t)p[n], sizeof *a->value);
    a->rhs = calloc((size_t)n, sizeof *a->rhs);
    if (!a->begin || !a->index || !a->row || !a->value || !a->rhs) return ANCF_E_MEMORY;
    memcpy(a->begin, p, ((size_t)n + 1) * sizeof *p);
    memcpy(a->index, li, (size_t)p[n] * sizeof *li);
    for (int j = 0; j < n; ++j) {
        a->row[order[j]] = j;
        if (p[j + 1] - p[j] > longest) longest = p[j + 1] - p[j];
    }
    a->column = calloc((size_t)longest, sizeof *a->column);
    return a->column ? ANCF_OK : ANCF_E_MEMORY;
}

static void add_entry(cholmod_triplet* t, int i, int j, double value) {
    ((int*)t->i)[t->nnz] = i > j ? i : j;
    ((int*)t->j)[t->nnz] = i > j ? j : i;
    ((double*)t->x)[t->nnz++] = value;
}

// The order of unknowns as they come keeps a chain a band; that of a net comes from minimum degree. The library takes
// the one with the fewer entries.
static ancf_error analyse(ancf_ldl* a, const int* pair, int n_pairs) {
    const size_t n = (size_t)a->n, entries = n + 3 * (size_t)n_pairs;
    ancf_error error = ANCF_E_MEMORY;
    cholmod_common common;
    cholmod_start(&common);
    common.supernodal = CHOLMOD_SIMPLICIAL;
    common.final_ll = 1;
    common.print = 0;
    common.nmethods = 2;
    common.method[0].ordering = CHOLMOD_NATURAL;
    common.method[1].ordering = CHOLMOD_AMD;
    common.postorder = 0;
    cholmod_triplet* t = cholmod_allocate_triplet(n, n, entries, -1, CHOLMOD_REAL, &common);
    cholmod_sparse* A = NULL;
    cholmod_factor* L = NULL;
    if (t) {
        for (int i = 0; i < a->n; ++i) add_entry(t, i, i, 1.0);
        for (int k = 0; k < n_pairs; ++k) { // ones off the diagonal, and larger sums on it: positive definite
            const int i = pair[2 * k], j = pair[2 * k + 1];
            add_entry(t, i, j, 1.0);
            add_entry(t, i, i, 1.0);
            add_entry(t, j, j, 1.0);
        }
        A = cholmod_triplet_to_sparse(t, entries, &common);
    }
    if (A) L = cholmod_analyze(A, &common);
    if (L && cholmod_factorize(A, L, &common) && common.status == CHOLMOD_OK &&
        cholmod_change_factor(CHOLMOD_REAL, 1, 0, 1, 1, L, &common))
        error = take_structure(a, L);
    cholmod_free_factor(&L, &common);
    cholmod_free_sparse(&A, &common);
    cholmod_free_triplet(&t, &common);
    cholmod_finish(&common);
    return error;
}

ancf_error ancf_ldl_create(ancf_ldl** ldl, int n, const int* pair, int n_pairs) {
    ancf_ldl* a = *ldl = calloc(1, sizeof *a);
    if (!a) return ANCF_E_MEMORY;
    a->n = n;
    const ancf_error error = n > 0 ? analyse(a, pair, n_pairs) : ANCF_OK;
    if (error) {
        ancf_ldl_destroy(a);
        *ldl = NULL;
    }
    return error;
}

void ancf_ldl_destroy(ancf_ldl* a) {
    if (!a) return;
    free(a->begin);
    free(a->index);
    free(a->row);
    free(a->value);
    free(a->column);
    free(a->rhs);
    free(a);
}

int ancf_ldl_place(const ancf_ldl* a, int row, int column) {
    int low = a->begin[column], high = a->begin[column + 1] - 1;
    while (low < high) {
        const int middle = (low + high) / 2;
        if (a->index[middle] < row) low = middle + 1;
        else high = middle;
    }
    return low;
}

// ---------------------------------------------------------------- numbers

// Inverse of a diagonal block, of which the lower triangle counts: by its l d l^T. False: it is not positive definite.
ANCF_INLINE bool invert(ancf_column* D) {
    const double d0 = D[0][0], i0 = 1.0 / d0, l10 = D[0][1] * i0, l20 = D[0][2] * i0;
    const double d1 = D[1][1] - l10 * D[0][1], i1 = 1.0 / d1, s21 = D[1][2] - l20 * D[0][1], l21 = s21 * i1;
    const double d2 = D[2][2] - l20 * D[0][2] - l21 * s21, i2 = 1.0 / d2;
    const double m20 = l10 * l21 - l20; // of l^-1, with -l10 and -l21
    const double inv20 = m20 * i2, inv21 = -l21 * i2, inv10 = -l10 * i1 - l21 * inv20;
    D[0] = (ancf_column) {i0 + l10 * l10 * i1 + m20 * inv20, inv10, inv20, 0.0};
    D[1] = (ancf_column) {inv10, i1 - l21 * inv21, inv21, 0.0};
    D[2] = (ancf_column) {inv20, inv21, i2, 0.0};
    return d0 > 0.0 && d1 > 0.0 && d2 > 0.0;
}

ANCF_INLINE ancf_column lanes(double x) { return (ancf_column) {x, x, x, x}; }

// Right-looking: every column A, once it is known, becomes L = A D^-1 and is taken off those to its right, as L A^T.
ANCF_CLONES bool ancf_ldl_factor(ancf_ldl* a) {
    const int *begin = a->begin, *index = a->index;
    ancf_block *value = a->value, *known = a->column;
    for (int j = 0; j < a->n; ++j) {
        const int first = begin[j] + 1, count = begin[j + 1] - first;
        ancf_column* D = value[begin[j]];
        if (!invert(D)) return false;
        for (int k = 0; k < count; ++k) {
            ancf_column *L = value[first + k], *A = known[k];
            for (int c = 0; c < 3; ++c) A[c] = L[c];
            for (int c = 0; c < 3; ++c) L[c] = A[0] * D[c][0] + A[1] * D[c][1] + A[2] * D[c][2];
        }
        for (int k = 0; k < count; ++k) {
            const ancf_column* entry = known[k];
            const ancf_column A[3][3] = {{lanes(entry[0][0]), lanes(entry[0][1]), lanes(entry[0][2])},
                                         {lanes(entry[1][0]), lanes(entry[1][1]), lanes(entry[1][2])},
                                         {lanes(entry[2][0]), lanes(entry[2][1]), lanes(entry[2][2])}};
            int place = begin[index[first + k]];
            for (int i = k; i < count; ++i) {
                while (index[place] != index[first + i]) ++place;
                const ancf_column* L = value[first + i];
                const ancf_column L0 = L[0], L1 = L[1], L2 = L[2];
                for (int c = 0; c < 3; ++c) value[place][c] -= L0 * A[0][c] + L1 * A[1][c] + L2 * A[2][c];
            }
        }
    }
    return true;
}

ANCF_CLONES void ancf_ldl_solve(ancf_ldl* a) {
    const int *begin = a->begin, *index = a->index;
    ancf_block* value = a->value;
    ancf_column* b = a->rhs;
    for (int j = 0; j < a->n; ++j)
        for (int p = begin[j] + 1; p < begin[j + 1]; ++p)
            b[index[p]] -= value[p][0] * b[j][0] + value[p][1] * b[j][1] + value[p][2] * b[j][2];
    for (int j = a->n - 1; j >= 0; --j) {
        const ancf_column* D = value[begin[j]];
        ancf_column sum[3] = {{0.0}};
        for (int p = begin[j] + 1; p < begin[j + 1]; ++p)
            for (int c = 0; c < 3; ++c) sum[c] += value[p][c] * b[index[p]];
        ancf_column x = D[0] * b[j][0] + D[1] * b[j][1] + D[2] * b[j][2];
        for (int c = 0; c < 3; ++c) x[c] -= sum[c][0] + sum[c][1] + sum[c][2];
        b[j] = x;
    }
}
