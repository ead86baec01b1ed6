// Knots that go on together with points of bodies: conjugate gradients on the impulses p between them,
//
//     (S M^-1 S^T + B) p = what is missing,
//
// with S that takes the knots out of all unknowns and B what impulses do to the bodies' points. If there are few, what
// they do to knots comes from what places do to one another; if mass is lumped, from its inverse. Else the
// preconditioner is the inverse itself, but for what the points of one body do to one another: with the inverse C of
// the blocks of B on the diagonal it is C - C S (M + S^T C S)^-1 S^T C, by a sparse factor of blocks in each step, and
// what impulses do to the knots comes with it. Only what is found is given to the table.
#include "factor.h"
#include "ldl.h"
#include "slide.h"
#include "table.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { ROUNDS = 200, PASSES = 3 };

static const double tolerance = 1e-14; // of what is missing, as part of what was
static const double rounding = 1e-14;  // of velocities: what is missing cannot be told any more
static const double stiffest = 1e-6;   // part of its knot's compliance that a body's point at least counts with in C

typedef double (*vectors)[3];

// What is missing: velocity of the body's point, with what its turning adds, less that of the knot.
static void miss(const ancf_table* t, const ancf_coupling* c, double v[3]) {
    ancf_body_velocity(v, &t->body[c->body], c->arm);
    const double* knot = t->place[c->place].velocity;
    for (int i = 0; i < 3; i++) v[i] += c->ahead[i] - knot[i];
}

static int knot_of(const ancf_table* t, const ancf_coupling* c) {
    const ancf_place* p = &t->place[c->place];
    return p->dof[p->xi > 0.5 ? 2 : 0];
}

static void push(const ancf_table* t, int place, const double impulse[3]) {
    for (int e = t->first[place]; e < t->first[place + 1]; ++e)
        for (int k = 0; k < 3; k++) t->place[t->other[e]].pushed[k] += t->effect[e] * impulse[k];
}

// Velocities of the knots by impulses on all of them, by what places do to one another.
static void answer_of_places(vectors v, const ancf_table* t, vectors impulse) {
    const int n = t->n_couplings, slides = t->slides < 0 ? 0 : t->model->n_slides;
    for (int i = 0; i < n; ++i) memset(t->place[t->coupling[i].place].pushed, 0, sizeof t->place->pushed);
    for (int i = 0; i < slides; ++i) memset(t->place[t->slides + i].pushed, 0, sizeof t->place->pushed);
    for (int i = 0; i < n; ++i) push(t, t->coupling[i].place, impulse[i]);
    for (int i = 0; i < slides; ++i) memcpy(t->hold[slides + i], t->place[t->slides + i].pushed, sizeof *t->hold);
    if (slides > 0) ancf_slides_hold(t->hold, t->model, t->hold + slides);
    for (int i = 0; i < slides; ++i) push(t, t->slides + i, t->hold[i]);
    for (int i = 0; i < n; ++i) memcpy(v[i], t->place[t->coupling[i].place].pushed, sizeof v[i]);
}

// The same by the inverse of lumped mass or the factor; each knot carries one body.
static void answer_of_knots(vectors v, const ancf_table* t, vectors impulse) {
    const ancf_mass* mass = t->model->mass;
    const int n = t->n_couplings;
    if (!mass->diagonal && mass->n > 0) memset(mass->rhs, 0, (size_t)mass->n * sizeof *mass->rhs);
    for (int i = 0; i < n; ++i) {
        const int knot = knot_of(t, &t->coupling[i]), row = mass->row[knot];
        for (int k = 0; k < 3; k++) {
            if (mass->diagonal) v[i][k] = mass->inverse[knot] * impulse[i][k];
            else if (row >= 0) mass->rhs[row][k] = impulse[i][k];
        }
    }
    if (mass->diagonal) return;
    ancf_mass_solve_rows(mass);
    for (int i = 0; i < n; ++i) {
        const int row = mass->row[knot_of(t, &t->coupling[i])];
        for (int k = 0; k < 3; k++) v[i][k] = row >= 0 ? mass->rhs[row][k] : 0.0;
    }
}

// Adds how fast impulses between knots and bodies move the bodies' points.
static void add_answer_of_bodies(vectors v, const ancf_table* t, vectors impulse) {
    for (int i = 0; i < t->n_couplings; ++i) memset(t->body[t->coupling[i].body].pushed, 0, sizeof t->body->pushed);
    for (int i = 0; i < t->n_couplings; ++i) {
        const ancf_coupling* c = &t->coupling[i];
        ancf_body* b = &t->body[c->body];
        double twist[3], answer[6];
        ancf_cross(twist, c->arm, impulse[i]);
        ancf_body_answer(answer, b, impulse[i], twist);
        for (int k = 0; k < 6; k++) b->pushed[k] += answer[k];
    }
    for (int i = 0; i < t->n_couplings; ++i) {
        const ancf_coupling* c = &t->coupling[i];
        const double* pushed = t->body[c->body].pushed;
        double turned[3];
        ancf_cross(turned, pushed + 3, c->arm);
        for (int k = 0; k < 3; k++) v[i][k] += pushed[k] + turned[k];
    }
}

// Response of a body's point to an impulse on itself, M^-1 - [a] I^-1 [a]: rows.
static void own_of_body(double A[3][3], const ancf_table* t, const ancf_coupling* c) {
    const ancf_body* b = &t->body[c->body];
    for (int j = 0; j < 3; j++) {
        double e[3] = {0.0, 0.0, 0.0}, twist[3], spin[3], column[3];
        e[j] = 1.0;
        ancf_cross(twist, c->arm, e);
        ancf_multiply(spin, b->inv_inertia, twist);
        ancf_cross(column, spin, c->arm);
        for (int i = 0; i < 3; i++) A[i][j] = column[i] + b->along[i] * b->along[j];
        A[j][j] += b->inv_mass[j];
    }
}

// By Cramer, of a symmetric matrix; returns its determinant. 0 where that is not above 0.
static double invert(double inverse[3][3], double A[3][3]) {
    double det = 0.0;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            const int k = (i + 1) % 3, l = (i + 2) % 3, m = (j + 1) % 3, n = (j + 2) % 3;
            inverse[i][j] = A[k][m] * A[l][n] - A[k][n] * A[l][m];
        }
    for (int j = 0; j < 3; j++) det += A[0][j] * inverse[0][j];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) inverse[i][j] = det > 0.0 ? inverse[i][j] / det : 0.0;
    return det;
}

// Inverse of the response of a coupling to an impulse on itself, knot and body.
static void invert_own(double inverse[3][3], const ancf_table* t, const ancf_coupling* c) {
    double A[3][3];
    own_of_body(A, t, c);
    for (int j = 0; j < 3; j++) A[j][j] += t->place[c->place].compliance;
    invert(inverse, A);
}

// Inverse of that of the body, or of a little more where it can hardly move: its smallest eigenvalue is at least
// 4 det/trace^2.
static void invert_body(double inverse[3][3], const ancf_table* t, const ancf_coupling* c) {
    double A[3][3];
    const double least = stiffest * t->place[c->place].compliance;
    own_of_body(A, t, c);
    const double trace = A[0][0] + A[1][1] + A[2][2];
    if (4.0 * invert(inverse, A) > least * trace * trace) return;
    for (int j = 0; j < 3; j++) A[j][j] += least;
    invert(inverse, A);
}

static void solve_own(double p[3], vectors inverse, const double v[3]) {
    for (int i = 0; i < 3; i++) p[i] = ancf_dot(inverse[i], v);
}

// ---------------------------------------------------------------- sparse factor

// Entries of the mass matrix by its rows, as in mass.c; returns their number.
static int entries_of(int row[16][2], double value[16], const ancf_model* m, int e) {
    const ancf_mass* mass = m->mass;
    double M[4][4];
    int dof[4], n = 0;
    ancf_model_dofs(dof, m, e);
    ancf_mass_element(M, &m->element[e]);
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) {
            const int to = mass->row[dof[i]], from = mass->row[dof[j]];
            if (to < 0 || from < 0) continue;
            row[n][0] = to;
            row[n][1] = from;
            const double all = m->element[e].rho_a * m->element[e].length;
            value[n++] = mass->condensed ? all / (i == j ? 15.0 : 60.0) : M[i][j];
        }
    return n;
}

static ancf_error make_structure(ancf_ldl** ldl, const ancf_model* m) {
    int row[16][2], n = 0;
    double value[16];
    int* pair = calloc(32 * (size_t)m->n_elements, sizeof *pair);
    if (!pair) return ANCF_E_MEMORY;
    for (int e = 0; e < m->n_elements; ++e) {
        const int count = entries_of(row, value, m, e);
        for (int k = 0; k < count; ++k) {
            if (row[k][0] <= row[k][1] || value[k] == 0.0) continue;
            memcpy(pair + 2 * n++, row[k], sizeof *row);
        }
    }
    const ancf_error error = ancf_ldl_create(ldl, m->mass->n, pair, n);
    free(pair);
    return error;
}

static void add_entry(ancf_knots_factor* f, int i, int j, double value) {
    const int a = f->ldl->row[i], b = f->ldl->row[j];
    if (a >= b) f->mass[ancf_ldl_place(f->ldl, a, b)] += value;
}

static void add_entries(ancf_knots_factor* f, const ancf_model* m) {
    int row[16][2];
    double value[16];
    for (int e = 0; e < m->n_elements; ++e) {
        const int count = entries_of(row, value, m, e);
        for (int k = 0; k < count; ++k)
            if (value[k] != 0.0) add_entry(f, row[k][0], row[k][1], value[k]);
    }
    for (int i = 0; i < m->n_nodes; ++i)
        if (m->mass->row[i] >= 0) add_entry(f, m->mass->row[i], m->mass->row[i], m->mass->added[i]);
}

void ancf_knots_factor_free(ancf_knots_factor* f) {
    ancf_ldl_destroy(f->ldl);
    free(f->mass);
    *f = (ancf_knots_factor) {0};
}

ancf_error ancf_knots_factor_make(ancf_knots_factor* f, const ancf_model* m) {
    f->state = ANCF_KNOTS_OLD;
    if (f->ldl) return ANCF_OK;
    const ancf_error error = make_structure(&f->ldl, m);
    if (error) return error;
    f->mass = calloc((size_t)f->ldl->begin[f->ldl->n], sizeof *f->mass);
    if (!f->mass) {
        ancf_knots_factor_free(f);
        return ANCF_E_MEMORY;
    }
    add_entries(f, m);
    return ANCF_OK;
}

static int row_of(const ancf_table* t, int i) {
    const int row = t->model->mass->row[knot_of(t, &t->coupling[i])];
    return row < 0 ? -1 : t->knots.ldl->row[row];
}

// M + S^T C S, factored; own: C.
static bool factor(ancf_table* t, vectors own) {
    const ancf_ldl* a = t->knots.ldl;
    for (int k = 0; k < a->begin[a->n]; ++k) {
        const double mass = t->knots.mass[k];
        a->value[k][0] = (ancf_column) {mass, 0.0, 0.0, 0.0};
        a->value[k][1] = (ancf_column) {0.0, mass, 0.0, 0.0};
        a->value[k][2] = (ancf_column) {0.0, 0.0, mass, 0.0};
    }
    for (int i = 0; i < t->n_couplings; ++i) {
        const int row = row_of(t, i);
        if (row < 0) continue;
        ancf_column* D = a->value[a->begin[row]];
        for (int k = 0; k < 3; k++)
            for (int j = 0; j < 3; j++) D[j][k] += own[3 * i + k][j];
    }
    return ancf_ldl_factor(t->knots.ldl);
}

// p = C (r - a) of a = (M + S^T C S)^-1 S^T C r.
static void solve_by_factor(vectors p, const ancf_table* t, vectors own, vectors r) {
    const ancf_ldl* ldl = t->knots.ldl;
    memset(ldl->rhs, 0, (size_t)ldl->n * sizeof *ldl->rhs);
    for (int i = 0; i < t->n_couplings; ++i) {
        const int row = row_of(t, i);
        double load[3];
        if (row < 0) continue;
        solve_own(load, own + 3 * i, r[i]);
        for (int k = 0; k < 3; k++) ldl->rhs[row][k] += load[k];
    }
    ancf_ldl_solve(t->knots.ldl);
    for (int i = 0; i < t->n_couplings; ++i) {
        const int row = row_of(t, i);
        double left[3];
        for (int k = 0; k < 3; k++) left[k] = r[i][k] - (row < 0 ? 0.0 : ldl->rhs[row][k]);
        solve_own(p[i], own + 3 * i, left);
    }
}

// Whether the factor is there; it is that of a whole step.
static bool prepare(ancf_table* t, vectors own) {
    const int n = t->n_couplings;
    ancf_knots_factor* f = &t->knots;
    const bool sparse = t->factored && !t->model->mass->diagonal && t->model->mass->n > 0;
    if (sparse && f->state != ANCF_KNOTS_NONE) {
        for (int i = 0; i < n; ++i) invert_body(own + 3 * i, t, &t->coupling[i]);
        if (f->state == ANCF_KNOTS_OLD) f->state = factor(t, own) ? ANCF_KNOTS_NEW : ANCF_KNOTS_NONE;
        if (f->state == ANCF_KNOTS_NEW) return true;
    }
    for (int i = 0; i < n; ++i) invert_own(own + 3 * i, t, &t->coupling[i]);
    return false;
}

// ---------------------------------------------------------------- impulses

static double inner(vectors a, vectors b, int n) {
    double sum = 0.0;
    for (int i = 0; i < n; ++i) sum += ancf_dot(a[i], b[i]);
    return sum;
}

// moved: how fast the knots go by the impulses.
static void give_all(ancf_table* t, vectors impulse, vectors moved, double rest) {
    for (int i = 0; i < t->n_couplings; ++i) {
        ancf_coupling* c = &t->coupling[i];
        const double back[3] = {-impulse[i][0], -impulse[i][1], -impulse[i][2]};
        ancf_table_kick_place(t, c->place, impulse[i], rest);
        ancf_table_kick_body(t, c->body, c->arm, back, rest);
        for (int k = 0; k < 3; k++) {
            c->impulse[k] += impulse[i][k];
            if (t->alone) t->place[c->place].velocity[k] += moved[i][k];
        }
    }
}

// Square of what is missing where it cannot be told from rounding.
static double noise(const ancf_table* t) {
    double sum = 0.0;
    for (int i = 0; i < t->n_couplings; ++i) {
        const ancf_coupling* c = &t->coupling[i];
        const ancf_body* b = &t->body[c->body];
        const double *v = b->velocity, *w = b->spin, *knot = t->place[c->place].velocity;
        sum += ancf_dot(v, v) + ancf_dot(w, w) * ancf_dot(c->arm, c->arm) + ancf_dot(knot, knot) +
               ancf_dot(c->ahead, c->ahead);
    }
    return rounding * rounding * sum;
}

// What the solver works with, (n) each but `own` (3 n): the inverses that its preconditioner takes.
typedef struct {
    bool sparse;
    vectors r, p, z, answer, impulse, moved, own;
} solver;

static void precondition(vectors z, const ancf_table* t, const solver* s) {
    if (s->sparse) solve_by_factor(z, t, s->own, s->r);
    for (int i = 0; i < t->n_couplings && !s->sparse; ++i) solve_own(z[i], s->own + 3 * i, s->r[i]);
}

static void add_scaled(vectors sum, double factor, vectors a, int n) {
    for (int i = 0; i < n; ++i)
        for (int k = 0; k < 3; k++) sum[i][k] += factor * a[i][k];
}

// Conjugate gradients. Adds to `impulse` what makes up for r, and to `moved` how fast the knots go by it.
static void solve_all(const solver* s, const ancf_table* t, double enough) {
    const int n = t->n_couplings;
    precondition(s->p, t, s);
    double product = inner(s->r, s->p, n);
    for (int round = 0; round < ROUNDS && product > 0.0; ++round) {
        if (t->factored) answer_of_knots(s->z, t, s->p);
        else answer_of_places(s->z, t, s->p);
        memcpy(s->answer, s->z, (size_t)n * sizeof *s->answer);
        add_answer_of_bodies(s->answer, t, s->p);
        const double curvature = inner(s->p, s->answer, n), length = curvature > 0.0 ? product / curvature : 0.0;
        add_scaled(s->impulse, length, s->p, n);
        add_scaled(s->moved, length, s->z, n);
        add_scaled(s->r, -length, s->answer, n);
        if (!(length > 0.0) || inner(s->r, s->r, n) <= enough) return;
        precondition(s->z, t, s);
        const double next = inner(s->r, s->z, n), part = next / product;
        for (int i = 0; i < n; ++i)
            for (int k = 0; k < 3; k++) s->p[i][k] = s->z[i][k] + part * s->p[i][k];
        product = next;
    }
}

void ancf_table_couple(ancf_table* t, double rest) {
    const int n = t->n_couplings;
    if (n == 0) return;
    solver s = {.r = t->scratch};
    s.p = s.r + n;
    s.z = s.p + n;
    s.answer = s.z + n;
    s.impulse = s.answer + n;
    s.moved = s.impulse + n;
    s.own = s.moved + n;
    double enough = INFINITY;
    s.sparse = prepare(t, s.own);
    for (int pass = 0; pass < PASSES; ++pass) { // more than one where rounding has let r drift
        for (int i = 0; i < n; ++i) miss(t, &t->coupling[i], s.r[i]);
        const double missing = inner(s.r, s.r, n);
        if (pass == 0) enough = fmax(tolerance * tolerance * missing, noise(t));
        if (missing <= enough) return;
        memset(s.impulse, 0, (size_t)n * sizeof *s.impulse);
        memset(s.moved, 0, (size_t)n * sizeof *s.moved);
        solve_all(&s, t, enough);
        give_all(t, s.impulse, s.moved, rest);
    }
}
