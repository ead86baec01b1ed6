#include "factor.h"

#include "slide.h"

#include <cholmod.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { INVERT_UP_TO = 96, ROWS = 12 };

void ancf_mass_element(double M[4][4], const ancf_element* el) {
    const double L = el->length, m = el->rho_a * L;
    memset(M, 0, 16 * sizeof(double));
    if (el->kind & ANCF_SPRING) {
        M[0][0] = M[2][2] = m / 2.0;
        return;
    }
    if (el->kind & ANCF_LUMPED) { // 35/26 of the exact diagonal: 13/35 of it at a node becomes a half
        M[0][0] = M[2][2] = m / 2.0;
        M[1][1] = M[3][3] = m * L * L / 78.0;
        return;
    }
    const double exact[4][4] = {{13.0 / 35.0, 11.0 / 210.0 * L, 9.0 / 70.0, -13.0 / 420.0 * L},
                                {11.0 / 210.0 * L, L * L / 105.0, 13.0 / 420.0 * L, -L * L / 140.0},
                                {9.0 / 70.0, 13.0 / 420.0 * L, 13.0 / 35.0, -11.0 / 210.0 * L},
                                {-13.0 / 420.0 * L, -L * L / 140.0, -11.0 / 210.0 * L, L * L / 105.0}};
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) M[i][j] = m * exact[i][j];
}

void ancf_mass_weight(double w[4], const ancf_element* el) {
    const double L = el->length, m = el->rho_a * L;
    w[0] = w[2] = m / 2.0;
    w[1] = el->kind & ANCF_SPRING ? 0.0 : m * L / 12.0;
    w[3] = -w[1];
}

// The six different entries of every element's matrix (a b c -d; b e d f; c d a -b; -d f -b e).
static void list_matrices(ancf_model* m) {
    for (int e = 0; e < m->n_elements; ++e) {
        double M[4][4];
        ancf_mass_element(M, &m->element[e]);
        const double entry[6] = {M[0][0], M[0][1], M[0][2], M[1][2], M[1][1], M[1][3]};
        for (int k = 0; k < 6; ++k) m->mass->matrix[k * m->n_elements + e] = entry[k];
    }
}

// Mass of every unknown if the matrix is diagonal, shared slopes joined.
static void find_diagonal(double* mass, const ancf_model* m) {
    for (int e = 0; e < m->n_elements; ++e) {
        double M[4][4];
        int dof[4];
        ancf_mass_element(M, &m->element[e]);
        ancf_model_dofs(dof, m, e);
        for (int i = 0; i < 4; ++i) mass[dof[i]] += M[i][i];
    }
    memcpy(m->mass->own, mass, (size_t)m->stride * sizeof *mass);
    for (int i = 0; i < m->n_nodes; ++i) mass[i] += m->mass->added[i];
    double *start = mass + m->n_nodes, *end = start + m->n_elements;
    for (int e = 0; e < m->n_elements; ++e)
        if (m->next[e] >= 0) end[e] = start[m->next[e]] = end[e] + start[m->next[e]];
}

// Rows of the unknowns that are free and have mass; both copies of a shared slope get the same.
static int number_rows(ancf_model* m, const double* diagonal) {
    ancf_mass* mass = m->mass;
    int n = 0;
    for (int i = 0; i < m->stride; ++i)
        mass->row[i] = i < m->n_dof && diagonal[i] > 0.0 && m->hold[i] == ANCF_FREE ? n++ : -1;
    int *start = mass->row + m->n_nodes, *end = start + m->n_elements;
    for (int e = 0; e < m->n_elements; ++e)
        if (m->next[e] >= 0) end[e] = start[m->next[e]];
    int* used = calloc((size_t)n + 1, sizeof *used); // close the gaps that the copies left
    if (!used) return -1;
    for (int i = 0; i < m->n_dof; ++i)
        if (mass->row[i] >= 0) used[mass->row[i]] = 1;
    int count = 0;
    for (int i = 0; i < n; ++i) used[i] = used[i] ? count++ : -1;
    for (int i = 0; i < m->n_dof; ++i)
        if (mass->row[i] >= 0) mass->row[i] = used[mass->row[i]];
    free(used);
    return count;
}

static void add_entry(cholmod_triplet* t, int i, int j, double value) {
    if (i < 0 || j < 0 || i < j || value == 0.0) return; // the lower triangle of the free part
    ((int*)t->i)[t->nnz] = i;
    ((int*)t->j)[t->nnz] = j;
    ((double*)t->x)[t->nnz++] = value;
}

// Exact mass of an element's nodes once its slopes are eliminated, m [1/15 1/60; 1/60 1/15].
static void condensed_element(double M[2][2], const ancf_element* el) {
    const double mass = el->rho_a * el->length;
    M[0][0] = M[1][1] = mass / 15.0;
    M[0][1] = M[1][0] = mass / 60.0;
}

static void assemble_condensed(cholmod_triplet* t, const ancf_model* m) {
    const int* row = m->mass->row;
    for (int e = 0; e < m->n_elements; ++e) {
        double M[2][2];
        condensed_element(M, &m->element[e]);
        for (int i = 0; i < 2; ++i)
            for (int j = 0; j < 2; ++j) add_entry(t, row[m->ends[2 * e + i]], row[m->ends[2 * e + j]], M[i][j]);
    }
    for (int i = 0; i < m->n_nodes; ++i) add_entry(t, row[i], row[i], m->mass->added[i]);
}

static void assemble(cholmod_triplet* t, const ancf_model* m) {
    const int* row = m->mass->row;
    for (int e = 0; e < m->n_elements; ++e) {
        double M[4][4];
        int dof[4];
        ancf_mass_element(M, &m->element[e]);
        ancf_model_dofs(dof, m, e);
        for (int i = 0; i < 4; ++i)
            for (int j = 0; j < 4; ++j) add_entry(t, row[dof[i]], row[dof[j]], M[i][j]);
    }
    for (int i = 0; i < m->n_nodes; ++i) add_entry(t, row[i], row[i], m->mass->added[i]);
}

// Takes L out of the library's factor: what remains is two short loops a step, without calls or allocation.
static ancf_error take_factor(ancf_model* m, const cholmod_factor* L) {
    ancf_mass* mass = m->mass;
    const int n = mass->n, *p = L->p, *li = L->i, *order = L->Perm;
    const double* lx = L->x;
    mass->begin = calloc((size_t)n + 1, sizeof *mass->begin);
    mass->index = calloc((size_t)p[n], sizeof *mass->index);
    mass->value = calloc((size_t)p[n], sizeof *mass->value);
    mass->pivot = calloc((size_t)n, sizeof *mass->pivot);
    mass->rhs = calloc((size_t)n, sizeof *mass->rhs);
    int* place = calloc((size_t)n, sizeof *place);
    if (!mass->begin || !mass->index || !mass->value || !mass->pivot || !mass->rhs || !place) {
        free(place);
        return ANCF_E_MEMORY;
    }
    int count = 0;
    for (int j = 0; j < n; ++j) {
        place[order[j]] = j;
        mass->pivot[j] = 1.0 / lx[p[j]];
        for (int k = p[j] + 1; k < p[j + 1]; ++k) {
            mass->index[count] = li[k];
            mass->value[count++] = lx[k];
        }
        mass->begin[j + 1] = count;
    }
    for (int i = 0; i < m->n_dof; ++i)
        if (mass->row[i] >= 0) mass->row[i] = place[mass->row[i]];
    free(place);
    return ANCF_OK;
}

static ancf_error factorise(ancf_model* m) {
    ancf_mass* mass = m->mass;
    // A half of each element's matrix and its diagonal.
    const size_t n = (size_t)mass->n, entries = 10 * (size_t)m->n_elements + (size_t)m->n_nodes;
    ancf_error error = ANCF_E_FACTOR;
    cholmod_common common;
    cholmod_start(&common);
    common.supernodal = CHOLMOD_SIMPLICIAL;
    common.final_ll = 1;
    common.print = 0;
    cholmod_triplet* t = cholmod_allocate_triplet(n, n, entries, -1, CHOLMOD_REAL, &common);
    cholmod_sparse* A = NULL;
    cholmod_factor* L = NULL;
    if (t) {
        if (mass->condensed) assemble_condensed(t, m);
        else assemble(t, m);
        A = cholmod_triplet_to_sparse(t, entries, &common);
    }
    if (A) L = cholmod_analyze(A, &common);
    if (L && cholmod_factorize(A, L, &common) && common.status == CHOLMOD_OK &&
        cholmod_change_factor(CHOLMOD_REAL, 1, 0, 1, 1, L, &common))
        error = take_factor(m, L);
    cholmod_free_factor(&L, &common);
    cholmod_free_sparse(&A, &common);
    cholmod_free_triplet(&t, &common);
    cholmod_finish(&common);
    return error;
}

// Every element exact, with two free slopes of its own.
static bool can_condense(const ancf_model* m) {
    if (m->n_shared > 0) return false;
    for (int e = 0; e < m->n_elements; ++e)
        if (m->element[e].kind & (ANCF_LUMPED | ANCF_SPRING)) return false;
    for (int i = m->n_nodes; i < m->n_dof; ++i)
        if (m->hold[i]) return false;
    return true;
}

// Leaves rows to the nodes alone.
static void condense(ancf_model* m) {
    ancf_mass* mass = m->mass;
    mass->n = 0;
    for (int i = 0; i < m->n_nodes; ++i)
        if (mass->row[i] >= 0) mass->row[i] = mass->n++;
    for (int i = m->n_nodes; i < m->n_dof; ++i) mass->row[i] = -1;
    for (int e = 0; e < m->n_elements; ++e) {
        const ancf_element* el = &m->element[e];
        mass->slope_flex[e] = 60.0 / (el->rho_a * el->length * el->length * el->length);
    }
    for (int k = 0; k < 2 * m->n_elements; ++k) mass->from[k] = (m->at[k] & 1) * m->n_elements + (m->at[k] >> 1);
}

// The inverse of a small matrix, column by column.
static ancf_error invert(ancf_mass* mass) {
    if (mass->n > INVERT_UP_TO) return ANCF_OK;
    mass->rows = (mass->n + ROWS - 1) / ROWS * ROWS;
    mass->full = calloc((size_t)(mass->n * mass->rows), sizeof *mass->full);
    mass->load = calloc(6 * (size_t)mass->rows, sizeof *mass->load);
    if (!mass->full || !mass->load) return ANCF_E_MEMORY;
    for (int j = 0; j < mass->n; ++j) {
        memset(mass->rhs, 0, (size_t)mass->n * sizeof *mass->rhs);
        mass->rhs[j][0] = 1.0;
        ancf_mass_solve_rows(mass);
        for (int i = 0; i < mass->n; ++i) mass->full[j * mass->rows + i] = mass->rhs[i][0];
    }
    memset(mass->rhs, 0, (size_t)mass->n * sizeof *mass->rhs);
    return ANCF_OK;
}

ancf_error ancf_mass_create(ancf_model* m, const double* added) {
    ancf_mass* mass = m->mass = calloc(1, sizeof *mass);
    if (!mass) return ANCF_E_MEMORY;
    mass->inverse = calloc((size_t)m->stride, sizeof *mass->inverse);
    mass->added = calloc((size_t)m->n_nodes, sizeof *mass->added);
    mass->own = calloc((size_t)m->stride, sizeof *mass->own);
    mass->row = calloc((size_t)m->stride, sizeof *mass->row);
    mass->matrix = calloc(6 * (size_t)m->n_elements, sizeof *mass->matrix);
    mass->slope_flex = calloc((size_t)m->n_elements, sizeof *mass->slope_flex);
    mass->push = calloc(6 * (size_t)m->n_elements, sizeof *mass->push);
    mass->from = calloc(2 * (size_t)m->n_elements, sizeof *mass->from);
    if (!mass->inverse || !mass->added || !mass->own || !mass->row || !mass->matrix || !mass->slope_flex ||
        !mass->push || !mass->from)
        return ANCF_E_MEMORY;
    if (added) memcpy(mass->added, added, (size_t)m->n_nodes * sizeof *added);

    list_matrices(m);
    double* diagonal = m->work;
    find_diagonal(diagonal, m);
    mass->diagonal = true;
    for (int e = 0; e < m->n_elements; ++e)
        if (!(m->element[e].kind & (ANCF_LUMPED | ANCF_SPRING))) mass->diagonal = false;
    mass->n = number_rows(m, diagonal);
    if (mass->n < 0) return ANCF_E_MEMORY;
    for (int i = 0; i < m->n_dof; ++i) {
        if (mass->row[i] >= 0) mass->inverse[i] = 1.0 / diagonal[i];
        if (m->hold[i] && diagonal[i] > 0.0) mass->held = true;
    }
    memset(diagonal, 0, (size_t)m->stride * sizeof *diagonal);
    if (mass->diagonal) return ANCF_OK;
    mass->condensed = can_condense(m);
    if (mass->condensed) condense(m);
    if (mass->n == 0) return ANCF_OK;
    const ancf_error error = factorise(m);
    return error || !mass->condensed ? error : invert(mass);
}

void ancf_mass_destroy(ancf_mass* mass) {
    if (!mass) return;
    free(mass->inverse);
    free(mass->added);
    free(mass->own);
    free(mass->row);
    free(mass->begin);
    free(mass->index);
    free(mass->value);
    free(mass->pivot);
    free(mass->rhs);
    free(mass->matrix);
    free(mass->slope_flex);
    free(mass->push);
    free(mass->from);
    free(mass->full);
    free(mass->load);
    free(mass);
}

ANCF_CLONES double ancf_mass_kinetic_kept(const ancf_model* m, double last, double step) {
    double twice = 0.0;
    for (int c = 0; c < 3; ++c) {
        const double *v = m->v + c * m->stride, *a = m->a + c * m->stride, *own = m->mass->own;
#pragma omp simd reduction(+ : twice)
        for (int i = 0; i < m->n_dof; ++i) {
            const double mid = v[i] + 0.5 * last * a[i], half = 0.5 * step * a[i];
            twice += own[i] * (mid * mid - half * half);
        }
    }
    return 0.5 * twice;
}

double ancf_mass_kinetic(const ancf_model* m) { return ancf_mass_kinetic_kept(m, 0.0, 0.0); }

double ancf_mass_added(const ancf_model* m, int node) { return m->mass->added[node]; }

const double* ancf_mass_inverse(const ancf_model* m) { return m->mass->inverse; }

bool ancf_mass_diagonal(const ancf_model* m) { return m->mass->diagonal; }

ANCF_CLONES static void solve_diagonal(const ancf_model* m, double* acceleration, const double* force) {
    const double* inverse = m->mass->inverse;
    for (int c = 0; c < 3; ++c) {
        double* a = acceleration + c * m->stride;
        const double* f = force + c * m->stride;
        for (int i = 0; i < m->stride; ++i) a[i] = inverse[i] > 0.0 ? inverse[i] * f[i] : a[i];
    }
}

// L L^T x = b for three right-hand sides at once.
ANCF_CLONES void ancf_mass_solve_rows(const ancf_mass* mass) {
    double(*b)[4] = mass->rhs;
    const int *begin = mass->begin, *index = mass->index;
    const double *value = mass->value, *pivot = mass->pivot;
    for (int j = 0; j < mass->n; ++j) {
        double x[4];
        for (int c = 0; c < 4; ++c) x[c] = b[j][c] *= pivot[j];
        for (int k = begin[j]; k < begin[j + 1]; ++k)
            for (int c = 0; c < 4; ++c) b[index[k]][c] -= value[k] * x[c];
    }
    for (int j = mass->n - 1; j >= 0; --j) {
        double x[4];
        for (int c = 0; c < 4; ++c) x[c] = b[j][c];
        for (int k = begin[j]; k < begin[j + 1]; ++k)
            for (int c = 0; c < 4; ++c) x[c] -= value[k] * b[index[k]][c];
        for (int c = 0; c < 4; ++c) b[j][c] = x[c] * pivot[j];
    }
}

// What is held pushes on the rest: b -= M a of the held accelerations, element by element.
static void subtract_held(const ancf_model* m, const double* acceleration) {
    const ancf_mass* mass = m->mass;
    for (int e = 0; e < m->n_elements; ++e) {
        int dof[4];
        ancf_model_dofs(dof, m, e);
        if (!(m->hold[dof[0]] | m->hold[dof[1]] | m->hold[dof[2]] | m->hold[dof[3]])) continue;
        double M[4][4];
        ancf_mass_element(M, &m->element[e]);
        for (int i = 0; i < 4; ++i)
            for (int j = 0; j < 4; ++j)
                if (m->hold[dof[j]] && mass->row[dof[i]] >= 0)
                    for (int c = 0; c < 3; ++c)
                        mass->rhs[mass->row[dof[i]]][c] -= M[i][j] * acceleration[c * m->stride + dof[j]];
    }
}

static void solve_consistent(const ancf_model* m, double* acceleration, const double* force) {
    const ancf_mass* mass = m->mass;
    const int s = m->stride;
    for (int i = 0; i < m->n_dof; ++i) {
        const int r = mass->row[i];
        if (r < 0) continue;
        for (int c = 0; c < 3; ++c) mass->rhs[r][c] = force[c * s + i];
    }
    if (mass->held) subtract_held(m, acceleration);
    ancf_mass_solve_rows(mass);
    for (int i = 0; i < m->n_dof; ++i) {
        const int r = mass->row[i];
        if (r < 0) continue;
        for (int c = 0; c < 3; ++c) acceleration[c * s + i] = mass->rhs[r][c];
    }
}

// Forces of the slopes, passed on to the nodes: -T^T f with T = (1/L) [7 -2; 2 -7].
ANCF_CLONES static void push_nodes(const ancf_model* m, const double* force) {
    const int n = m->n_elements;
    for (int c = 0; c < 3; ++c) {
        const double *f0 = force + c * m->stride + m->n_nodes, *f1 = f0 + n;
        double *p0 = m->mass->push + 2 * c * n, *p1 = p0 + n;
#pragma GCC ivdep
        for (int e = 0; e < n; ++e) {
            p0[e] = -m->inv_length[e] * (7.0 * f0[e] + 2.0 * f1[e]);
            p1[e] = m->inv_length[e] * (2.0 * f0[e] + 7.0 * f1[e]);
        }
    }
}

// Slopes from their forces and the nodes' accelerations: M_ss^-1 f - T a, M_ss^-1 = (60/(m L^2)) [4 3; 3 4].
ANCF_CLONES static void slopes_follow(const ancf_model* m, double* acceleration, const double* force) {
    const int n = m->n_elements;
    for (int c = 0; c < 3; ++c) {
        const double *f0 = force + c * m->stride + m->n_nodes, *f1 = f0 + n, *flex = m->mass->slope_flex;
        const double *r0 = m->mass->push + 2 * c * n, *r1 = r0 + n;
        double *a0 = acceleration + c * m->stride + m->n_nodes, *a1 = a0 + n;
#pragma GCC ivdep
        for (int e = 0; e < n; ++e) {
            a0[e] = flex[e] * (4.0 * f0[e] + 3.0 * f1[e]) - m->inv_length[e] * (7.0 * r0[e] - 2.0 * r1[e]);
            a1[e] = flex[e] * (3.0 * f0[e] + 4.0 * f1[e]) - m->inv_length[e] * (2.0 * r0[e] - 7.0 * r1[e]);
        }
    }
}

typedef double four __attribute__((vector_size(4 * sizeof(double)), aligned(sizeof(double))));

// y = A x for three right-hand sides, n columns: ROWS rows at a time, whose sums stay in nine registers.
ANCF_CLONES static void multiply_full(double* restrict y, const double* restrict A, const double* restrict x, int n,
                                      int rows) {
    for (int i = 0; i < rows; i += ROWS) {
        four sum[3][3] = {{{0.0}}};
        for (int j = 0; j < n; ++j) {
            const double* a = A + j * rows + i;
            const four a0 = *(const four*)a, a1 = *(const four*)(a + 4), a2 = *(const four*)(a + 8);
            for (int c = 0; c < 3; ++c) {
                const double load = x[c * rows + j];
                sum[0][c] += a0 * load;
                sum[1][c] += a1 * load;
                sum[2][c] += a2 * load;
            }
        }
        for (int k = 0; k < 3; ++k)
            for (int c = 0; c < 3; ++c) *(four*)(y + c * rows + i + 4 * k) = sum[k][c];
    }
}

// Where a row's right-hand side stands, and then the solution: x, y and z `apart`.
typedef struct {
    double *load, *answer;
    int each, apart;
} nodes_rhs;

static nodes_rhs rhs_of(const ancf_mass* mass) {
    double* side = mass->rows ? mass->load : (double*)mass->rhs;
    return mass->rows ? (nodes_rhs) {side, side + 3 * mass->rows, 1, mass->rows} : (nodes_rhs) {side, side, 4, 1};
}

static void solve_nodes(const ancf_mass* mass) {
    if (mass->rows) multiply_full(mass->load + 3 * mass->rows, mass->full, mass->load, mass->n, mass->rows);
    else ancf_mass_solve_rows(mass);
}

// Forces of the nodes, with those that the slopes pass on.
ANCF_CLONES static void load_nodes(const ancf_model* m, const double* force) {
    const ancf_mass* mass = m->mass;
    const int n = m->n_elements, s = m->stride, *row = mass->row, *from = mass->from, *first = m->first;
    const double *x = mass->push, *y = x + 2 * n, *z = y + 2 * n;
    const nodes_rhs rhs = rhs_of(mass);
    for (int i = 0; i < m->n_nodes; ++i) {
        if (row[i] < 0) continue;
        double *sum = rhs.load + row[i] * rhs.each, sum_x = force[i], sum_y = force[s + i], sum_z = force[2 * s + i];
        for (int k = first[i]; k < first[i + 1]; ++k) {
            sum_x += x[from[k]];
            sum_y += y[from[k]];
            sum_z += z[from[k]];
        }
        sum[0] = sum_x;
        sum[rhs.apart] = sum_y;
        sum[2 * rhs.apart] = sum_z;
    }
}

// The nodes' accelerations, and for each element those of its ends.
ANCF_CLONES static void unload_nodes(const ancf_model* m, double* acceleration) {
    const ancf_mass* mass = m->mass;
    const int n = m->n_elements, s = m->stride, *row = mass->row, *ends = m->ends;
    double *a = acceleration, *b = a + s, *c = b + s, *x = mass->push, *y = x + 2 * n, *z = y + 2 * n;
    const nodes_rhs rhs = rhs_of(mass);
    for (int i = 0; i < m->n_nodes; ++i) {
        if (row[i] < 0) continue;
        const double* value = rhs.answer + row[i] * rhs.each;
        a[i] = value[0];
        b[i] = value[rhs.apart];
        c[i] = value[2 * rhs.apart];
    }
    for (int e = 0; e < n; ++e) {
        const int i = ends[2 * e], j = ends[2 * e + 1];
        x[e] = a[i];
        x[n + e] = a[j];
        y[e] = b[i];
        y[n + e] = b[j];
        z[e] = c[i];
        z[n + e] = c[j];
    }
}

// Held nodes push on the others through the condensed matrix.
static void subtract_held_nodes(const ancf_model* m, const double* acceleration) {
    const ancf_mass* mass = m->mass;
    const nodes_rhs rhs = rhs_of(mass);
    for (int e = 0; e < m->n_elements; ++e) {
        const int* end = m->ends + 2 * e;
        if (!m->hold[end[0]] && !m->hold[end[1]]) continue;
        double M[2][2];
        condensed_element(M, &m->element[e]);
        for (int i = 0; i < 2; ++i)
            for (int j = 0; j < 2; ++j)
                if (m->hold[end[j]] && mass->row[end[i]] >= 0)
                    for (int c = 0; c < 3; ++c)
                        rhs.load[mass->row[end[i]] * rhs.each + c * rhs.apart] -=
                            M[i][j] * acceleration[c * m->stride + end[j]];
    }
}

static void solve_condensed(const ancf_model* m, double* acceleration, const double* force) {
    const ancf_mass* mass = m->mass;
    push_nodes(m, force);
    load_nodes(m, force);
    if (mass->held) subtract_held_nodes(m, acceleration);
    if (mass->n > 0) solve_nodes(mass);
    unload_nodes(m, acceleration);
    slopes_follow(m, acceleration, force);
}

void ancf_mass_solve_freely(const ancf_model* m, double* acceleration, const double* force) {
    if (m->mass->diagonal) solve_diagonal(m, acceleration, force);
    else if (m->mass->condensed) solve_condensed(m, acceleration, force);
    else if (m->mass->n > 0) solve_consistent(m, acceleration, force);
}

void ancf_mass_solve(const ancf_model* m, double* acceleration, const double* force) {
    if (m->n_slides > 0) ancf_slides_give(m, acceleration);
    ancf_mass_solve_freely(m, acceleration, force);
    if (m->n_slides > 0) ancf_slides_constrain(m, acceleration);
}

// Along one axis: the slopes' part of the product, and what each element's ends (n each) add at their nodes.
ANCF_CLONES static void multiply_elements(const ancf_model* m, double* product, const double* field, double* start,
                                          double* end) {
    const int n = m->n_elements;
    const double *g0 = field + m->n_nodes, *g1 = g0 + n, *a = m->mass->matrix;
    const double *b = a + n, *c = b + n, *d = c + n, *ee = d + n, *f = ee + n;
    double *p0 = product + m->n_nodes, *p1 = p0 + n;
#pragma GCC ivdep
    for (int e = 0; e < n; ++e) {
        const double r0 = field[m->ends[2 * e]], r1 = field[m->ends[2 * e + 1]];
        start[e] = a[e] * r0 + b[e] * g0[e] + c[e] * r1 - d[e] * g1[e];
        p0[e] = b[e] * r0 + ee[e] * g0[e] + d[e] * r1 + f[e] * g1[e];
        end[e] = c[e] * r0 + d[e] * g0[e] + a[e] * r1 - b[e] * g1[e];
        p1[e] = ee[e] * g1[e] - d[e] * r0 + f[e] * g0[e] - b[e] * r1;
    }
}

void ancf_mass_multiply(const ancf_model* m, double* product, const double* field) {
    const int n = m->n_elements;
    for (int c = 0; c < 3; ++c) {
        const double* x = field + c * m->stride;
        double *p = product + c * m->stride, *at_ends = m->mass->push;
        multiply_elements(m, p, x, at_ends, at_ends + n);
        for (int i = 0; i < m->n_nodes; ++i) {
            p[i] = m->mass->added[i] * x[i];
            for (int k = m->first[i]; k < m->first[i + 1]; ++k) p[i] += at_ends[(m->at[k] & 1) * n + (m->at[k] >> 1)];
        }
        for (int i = m->n_dof; i < m->stride; ++i) p[i] = 0.0;
    }
    ancf_model_join(m, product);
}
