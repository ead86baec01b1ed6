// The inverse of a mass matrix is full, but falls off exponentially with the distance (Demko, Moss, Smith 1984): a
// column is worth making near its element only. Each entry comes exactly from the factor L L^T: forward along the paths
// of an element's rows to the root of the elimination tree (Gilbert, Peierls 1988), then backward for the rows around
// the element and those that they hang on, ring by ring until nothing is felt any more.
#include "ancf/response.h"
#include "factor.h"
#include "internal.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double negligible = 1e-14; // part of what is largest in a column, of nodes or of slopes
static const double vanished = 1e-20;   // the same on the way to the root, where all have the unit of a root of energy

struct ancf_responses {
    int n_elements;
    ancf_response* element; // (n_elements), NULL dof: not made yet

    // Of the one that is being made. Rows are those of the factor, sides by side the four columns.
    double (*row)[4]; // 0 but for the rows of `made`
    bool* done;       // (rows) made
    int *made, n_made;
    int top;                          // above it, rows are 0
    int *ring, n_ring, *node, n_node; // elements and nodes around
    bool *met, *reached;              // (n_elements), (n_nodes) which
    int* dof;                         // (n) their unknowns
    double (*column)[4];              // (n)
    int n, room_dof, room_column;
};

ancf_error ancf_responses_create(ancf_responses** responses, const ancf_model* m) {
    const size_t rows = (size_t)m->mass->n + 1, elements = (size_t)m->n_elements, nodes = (size_t)m->n_nodes;
    ancf_responses* r = *responses = calloc(1, sizeof *r);
    if (!r) return ANCF_E_MEMORY;
    r->n_elements = m->n_elements;
    r->element = calloc(elements, sizeof *r->element);
    r->row = calloc(rows, sizeof *r->row);
    r->done = calloc(rows, sizeof *r->done);
    r->made = calloc(rows, sizeof *r->made);
    r->ring = calloc(elements, sizeof *r->ring);
    r->met = calloc(elements, sizeof *r->met);
    r->node = calloc(nodes, sizeof *r->node);
    r->reached = calloc(nodes, sizeof *r->reached);
    if (r->element && r->row && r->done && r->made && r->ring && r->met && r->node && r->reached) return ANCF_OK;
    ancf_responses_destroy(r);
    *responses = NULL;
    return ANCF_E_MEMORY;
}

void ancf_responses_destroy(ancf_responses* r) {
    if (!r) return;
    for (int e = 0; r->element && e < r->n_elements; ++e) {
        free((void*)r->element[e].dof);
        free((void*)r->element[e].column);
    }
    free(r->element);
    free(r->row);
    free(r->done);
    free(r->made);
    free(r->ring);
    free(r->met);
    free(r->node);
    free(r->reached);
    free(r->dof);
    free(r->column);
    free(r);
}

// Largest entries of the four columns, of nodes and of slopes: accelerations, and these times the mass that goes with
// each. What is negligible is so by both: light and heavy, long and short elements have no scale in common.
typedef struct {
    double fast[2][4], strong[2][4];
} extent;

static void enlarge(double largest[4], const double entry[4]) {
    for (int k = 0; k < 4; ++k) {
        const double size = fabs(entry[k]);
        largest[k] = size > largest[k] ? size : largest[k];
    }
}

static bool exceeds(const double entry[4], const double largest[4], double part) {
    int n = 0;
    for (int k = 0; k < 4; ++k) n += fabs(entry[k]) > part * largest[k];
    return n > 0;
}

static void times_mass(double product[4], const ancf_model* m, int dof, const double entry[4]) {
    const double mass = 1.0 / m->mass->inverse[dof];
    for (int k = 0; k < 4; ++k) product[k] = mass * entry[k];
}

static void extend(extent* all, const ancf_model* m, int dof, const double entry[4]) {
    const int slope = dof >= m->n_nodes;
    double strong[4];
    times_mass(strong, m, dof, entry);
    enlarge(all->fast[slope], entry);
    enlarge(all->strong[slope], strong);
}

static bool felt(const extent* all, const ancf_model* m, int dof, const double entry[4]) {
    const int slope = dof >= m->n_nodes;
    double strong[4];
    times_mass(strong, m, dof, entry);
    return exceeds(entry, all->fast[slope], negligible) || exceeds(strong, all->strong[slope], negligible);
}

// ---- rows

static int parent_of(const ancf_mass* mass, int row) {
    return mass->begin[row] < mass->begin[row + 1] ? mass->index[mass->begin[row]] : -1;
}

// Unit forces on the element's unknowns; slopes that were eliminated pass theirs on to the nodes (mass.c).
static void push(ancf_responses* r, const ancf_model* m, int element, const int dof[4]) {
    const double flat[4][4] = {{1.0}, {0.0, 1.0}, {0.0, 0.0, 1.0}, {0.0, 0.0, 0.0, 1.0}};
    const double q = m->inv_length[element];
    const double passed[2][4] = {{1.0, -7.0 * q, 0.0, -2.0 * q}, {0.0, 2.0 * q, 1.0, 7.0 * q}};
    for (int i = 0; i < 4; ++i) {
        const int row = m->mass->row[dof[i]];
        if (row >= 0) memcpy(r->row[row], m->mass->condensed ? passed[i / 2] : flat[i], sizeof *r->row);
    }
}

// Takes the lowest of the rows that have been reached and lets all that stand there go on to the next above.
static int go_on(int reached[4], const ancf_mass* mass) {
    int row = INT_MAX;
    for (int i = 0; i < 4; ++i)
        if (reached[i] >= 0 && reached[i] < row) row = reached[i];
    if (row == INT_MAX) return row;
    for (int i = 0; i < 4; ++i)
        if (reached[i] == row) reached[i] = parent_of(mass, row);
    return row;
}

static void go_up(ancf_responses* r, const ancf_mass* mass, int reached[4]) {
    double largest[4] = {0.0, 0.0, 0.0, 0.0};
    for (int row = go_on(reached, mass); row <= r->top; row = go_on(reached, mass)) {
        double* y = r->row[row];
        for (int k = 0; k < 4; ++k) y[k] *= mass->pivot[row];
        r->made[r->n_made++] = row;
        enlarge(largest, y);
        if (!exceeds(y, largest, vanished)) continue;
        for (int i = mass->begin[row]; i < mass->begin[row + 1]; ++i) {
            if (mass->index[i] > r->top) r->top = mass->index[i];
            for (int k = 0; k < 4; ++k) r->row[mass->index[i]][k] -= mass->value[i] * y[k];
        }
    }
}

static void go_down(ancf_responses* r, const ancf_mass* mass, int row) {
    double* x = r->row[row];
    for (int i = mass->begin[row]; i < mass->begin[row + 1]; ++i)
        for (int k = 0; k < 4; ++k) x[k] -= mass->value[i] * r->row[mass->index[i]][k];
    for (int k = 0; k < 4; ++k) x[k] *= mass->pivot[row];
    r->done[row] = true;
}

// The rows that are not 0 on the paths from the element's.
static void solve_paths(ancf_responses* r, const ancf_model* m, int element) {
    const ancf_mass* mass = m->mass;
    int dof[4], reached[4];
    ancf_model_dofs(dof, m, element);
    push(r, m, element, dof);
    r->top = -1;
    for (int i = 0; i < 4; ++i) {
        const int row = reached[i] = mass->row[dof[i]];
        if (row > r->top) r->top = row;
        if (row < 0 || !mass->diagonal) continue;
        r->row[row][i] = mass->inverse[dof[i]];
        r->made[r->n_made++] = row;
    }
    if (mass->diagonal) return;
    go_up(r, mass, reached);
    for (int i = r->n_made - 1; i >= 0; --i) go_down(r, mass, r->made[i]);
}

// Makes a row, after those above that it hangs on.
static const double* solve_row(ancf_responses* r, const ancf_mass* mass, int row) {
    if (mass->diagonal) return r->row[row];
    const int first = r->n_made;
    for (int up = row; up >= 0 && up <= r->top && !r->done[up]; up = parent_of(mass, up)) r->made[r->n_made++] = up;
    for (int i = r->n_made - 1; i >= first; --i) go_down(r, mass, r->made[i]);
    return r->row[row];
}

// ---- rings

static void meet(ancf_responses* r, const ancf_model* m, int element) {
    if (r->met[element]) return;
    r->met[element] = true;
    r->ring[r->n_ring++] = element;
    for (int end = 0; end < 2; ++end) {
        const int node = m->ends[2 * element + end];
        if (r->reached[node]) continue;
        r->reached[node] = true;
        r->node[r->n_node++] = node;
    }
}

static bool answers(ancf_responses* r, const ancf_model* m, int dof, extent* all) {
    const int row = m->mass->row[dof];
    if (row < 0) return false;
    const double* entry = solve_row(r, m->mass, row);
    extend(all, m, dof, entry);
    return felt(all, m, dof, entry);
}

// All elements at nodes that feel something, in themselves or in a slope there, outward from the first.
static void go_out(ancf_responses* r, const ancf_model* m, int element) {
    extent all = {0};
    meet(r, m, element);
    for (int i = 0; i < r->n_node; ++i) {
        const int node = r->node[i], *at = m->at + m->first[node], n = m->first[node + 1] - m->first[node];
        bool feels = answers(r, m, node, &all);
        for (int k = 0; k < n; ++k)
            if (answers(r, m, m->n_nodes + (at[k] & 1) * m->n_elements + (at[k] >> 1), &all)) feels = true;
        for (int k = 0; k < n && feels; ++k) meet(r, m, at[k] >> 1);
    }
}

// ---- answers

// Slopes that were eliminated: M_ss^-1 f - T a of their nodes (mass.c).
static void slopes_of(double slope[2][4], const ancf_responses* r, const ancf_model* m, int element, int of) {
    const double own[2][4] = {{0.0, 4.0, 0.0, 3.0}, {0.0, 3.0, 0.0, 4.0}}, still[4] = {0.0, 0.0, 0.0, 0.0};
    const int *end = m->ends + 2 * element, *row = m->mass->row;
    const double *r0 = row[end[0]] >= 0 ? r->row[row[end[0]]] : still,
                 *r1 = row[end[1]] >= 0 ? r->row[row[end[1]]] : still;
    for (int k = 0; k < 4; ++k) {
        slope[0][k] = -m->inv_length[element] * (7.0 * r0[k] - 2.0 * r1[k]);
        slope[1][k] = -m->inv_length[element] * (2.0 * r0[k] - 7.0 * r1[k]);
        for (int s = 0; s < 2 && element == of; ++s) slope[s][k] += m->mass->slope_flex[element] * own[s][k];
    }
}

static void tell(ancf_responses* r, int dof, const double entry[4]) {
    r->dof[r->n] = dof;
    memcpy(r->column[r->n++], entry, sizeof *r->column);
}

static void tell_all(ancf_responses* r, const ancf_model* m, int of) {
    const int* row = m->mass->row;
    for (int i = 0; i < r->n_node; ++i)
        if (row[r->node[i]] >= 0) tell(r, r->node[i], r->row[row[r->node[i]]]);
    for (int i = 0; i < r->n_ring; ++i) {
        double slope[2][4];
        if (m->mass->condensed) slopes_of(slope, r, m, r->ring[i], of);
        for (int end = 0; end < 2; ++end) {
            const int dof = m->n_nodes + end * m->n_elements + r->ring[i];
            if (m->mass->condensed) tell(r, dof, slope[end]);
            else if (row[dof] >= 0) tell(r, dof, r->row[row[dof]]);
        }
    }
}

static void leave_negligible(ancf_responses* r, const ancf_model* m) {
    extent all = {0};
    const int n = r->n;
    for (int i = 0; i < n; ++i) extend(&all, m, r->dof[i], r->column[i]);
    r->n = 0;
    for (int i = 0; i < n; ++i)
        if (felt(&all, m, r->dof[i], r->column[i])) tell(r, r->dof[i], r->column[i]);
}

static ancf_error take(ancf_response* response, ancf_responses* r, const ancf_model* m, int of) {
    const int most = r->n_node + 2 * r->n_ring;
    if (!ancf_reserve((void**)&r->dof, &r->room_dof, most, sizeof *r->dof) ||
        !ancf_reserve((void**)&r->column, &r->room_column, most, sizeof *r->column))
        return ANCF_E_MEMORY;
    tell_all(r, m, of);
    leave_negligible(r, m);
    int* dof = calloc((size_t)r->n + 1, sizeof *dof); // never empty: NULL says not made
    double(*column)[4] = calloc((size_t)r->n + 1, sizeof *column);
    if (!dof || !column) {
        free(dof);
        free(column);
        return ANCF_E_MEMORY;
    }
    if (r->n > 0) {
        memcpy(dof, r->dof, (size_t)r->n * sizeof *dof);
        memcpy(column, r->column, (size_t)r->n * sizeof *column);
    }
    *response = (ancf_response) {r->n, dof, (const double(*)[4])column};
    return ANCF_OK;
}

static void forget(ancf_responses* r) {
    for (int i = 0; i < r->n_made; ++i) {
        memset(r->row[r->made[i]], 0, sizeof *r->row);
        r->done[r->made[i]] = false;
    }
    for (int i = 0; i < r->n_ring; ++i) r->met[r->ring[i]] = false;
    for (int i = 0; i < r->n_node; ++i) r->reached[r->node[i]] = false;
    r->n_made = r->n_ring = r->n_node = r->n = 0;
}

const ancf_response* ancf_responses_of(ancf_responses* r, const ancf_model* m, int element) {
    ancf_response* response = &r->element[element];
    if (response->dof) return response;
    solve_paths(r, m, element);
    go_out(r, m, element);
    const ancf_error error = take(response, r, m, element);
    forget(r);
    return error ? NULL : response;
}

void ancf_responses_renew(ancf_responses* r, const ancf_model* m, int node) {
    for (int k = m->first[node]; k < m->first[node + 1]; ++k) {
        const ancf_response* response = &r->element[m->at[k] >> 1];
        double(*column)[4] = (double(*)[4])response->column; // ours
        for (int i = 0; i < response->n; ++i)
            if (response->dof[i] == node) column[i][m->at[k] & 1 ? 2 : 0] = m->mass->inverse[node];
    }
}
