// A node i on a line along d may have a velocity along d alone, P v_i = 0 with P = I - d d^T. Forces lambda across the
// lines see to that, with the mass matrix M times the unit matrix of the three axes:
//
//     a = M^-1 (f + lambda),   P_i a_i as given:   sum over j of P_i (M^-1)_ij P_j lambda_j = P_i (given - M^-1 f)_i.
//
// Blocks on the diagonal are taken as (M^-1)_ii I, so that the matrix over all slides is regular, and maps what is
// across the lines to what is across them. It is inverted once; where M is diagonal, so is it.
#include "slide.h"
#include "factor.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct ancf_sliding {
    double* inverse;    // (3 n x 3 n) [kg]; NULL: M is diagonal
    double (*given)[3]; // (n) across, of accelerations
    double (*x)[3], (*v)[3];
    double (*gained)[3], (*held)[3];
    double *force, *answer; // (3 x stride)
};

static double along(const ancf_slide* s, const double v[3]) {
    return s->along[0] * v[0] + s->along[1] * v[1] + s->along[2] * v[2];
}

static void across(double part[3], const ancf_slide* s, const double v[3]) {
    const double length = along(s, v);
    for (int c = 0; c < 3; ++c) part[c] = v[c] - length * s->along[c];
}

static void read(double v[3], const ancf_model* m, const double* field, int node) {
    for (int c = 0; c < 3; ++c) v[c] = field[c * m->stride + node];
}

static void write(const ancf_model* m, double* field, int node, const double v[3]) {
    for (int c = 0; c < 3; ++c) field[c * m->stride + node] = v[c];
}

// ---------------------------------------------------------------- made, once

// What a unit impulse on one slide's node does to those of all.
static void effects_of(double* effect, const ancf_model* m, int slide) {
    struct ancf_sliding* s = m->sliding;
    const size_t field = 3 * (size_t)m->stride * sizeof *s->force;
    memset(s->force, 0, field);
    memset(s->answer, 0, field);
    s->force[m->slide[slide].node] = 1.0;
    ancf_mass_solve_freely(m, s->answer, s->force);
    for (int i = 0; i < m->n_slides; ++i) effect[i] = s->answer[m->slide[i].node];
}

static void fill_column(double* A, const ancf_model* m, int j, const double* effect) {
    const int n = m->n_slides;
    for (int i = 0; i < n; ++i)
        for (int c = 0; c < 3; ++c) {
            double unit[3] = {0.0, 0.0, 0.0}, part[3];
            unit[c] = 1.0;
            if (i != j) {
                across(part, &m->slide[j], unit);
                across(unit, &m->slide[i], part);
            }
            for (int k = 0; k < 3; ++k) A[(3 * i + k) * 3 * n + 3 * j + c] = effect[i] * unit[k];
        }
}

// Gauss and Jordan, in place; symmetric and positive definite. False: it is not.
static bool invert(double* A, int n) {
    for (int k = 0; k < n; ++k) {
        const double pivot = A[k * n + k];
        if (!(pivot > 0.0)) return false;
        A[k * n + k] = 1.0;
        for (int j = 0; j < n; ++j) A[k * n + j] /= pivot;
        for (int i = 0; i < n; ++i) {
            const double factor = A[i * n + k];
            if (i == k || factor == 0.0) continue;
            A[i * n + k] = 0.0;
            for (int j = 0; j < n; ++j) A[i * n + j] -= factor * A[k * n + j];
        }
    }
    return true;
}

static ancf_error make_inverse(ancf_model* m) {
    struct ancf_sliding* s = m->sliding;
    const size_t n = (size_t)m->n_slides;
    double* effect = calloc(n, sizeof *effect);
    s->inverse = calloc(9 * n * n, sizeof *s->inverse);
    ancf_error error = effect && s->inverse ? ANCF_OK : ANCF_E_MEMORY;
    for (int j = 0; j < m->n_slides && !error; ++j) {
        effects_of(effect, m, j);
        fill_column(s->inverse, m, j, effect);
    }
    free(effect);
    if (error) return error;
    return invert(s->inverse, 3 * m->n_slides) ? ANCF_OK : ANCF_E_FACTOR;
}

ancf_error ancf_slides_create(ancf_model* m) {
    const size_t n = (size_t)m->n_slides, field = 3 * (size_t)m->stride;
    if (n == 0) return ANCF_OK;
    struct ancf_sliding* s = m->sliding = calloc(1, sizeof *s);
    if (!s) return ANCF_E_MEMORY;
    s->given = calloc(5 * n, sizeof *s->given);
    s->force = calloc(2 * field, sizeof *s->force);
    if (!s->given || !s->force) return ANCF_E_MEMORY;
    s->x = s->given + n;
    s->v = s->x + n;
    s->gained = s->v + n;
    s->held = s->gained + n;
    s->answer = s->force + field;
    return ancf_mass_diagonal(m) ? ANCF_OK : make_inverse(m);
}

void ancf_slides_destroy(ancf_model* m) {
    if (m->sliding) {
        free(m->sliding->inverse);
        free(m->sliding->given);
        free(m->sliding->force);
    }
    free(m->sliding);
    free(m->slide);
    free(m->slide_of);
}

// ---------------------------------------------------------------- held across

// Three rows of the inverse, which is symmetric, times a velocity.
ANCF_CLONES static void subtract_rows(double* restrict sum, const double* restrict row, const double v[3], int n) {
    const double a = v[0], b = v[1], c = v[2];
    for (int i = 0; i < n; ++i) sum[i] -= a * row[i] + b * row[n + i] + c * row[2 * n + i];
}

void ancf_slides_hold(double (*impulse)[3], const ancf_model* m, double (*velocity)[3]) {
    const struct ancf_sliding* s = m->sliding;
    const int n = m->n_slides;
    memset(impulse, 0, (size_t)n * sizeof *impulse);
    for (int j = 0; j < n; ++j) {
        double off[3];
        across(off, &m->slide[j], velocity[j]);
        if (off[0] == 0.0 && off[1] == 0.0 && off[2] == 0.0) continue;
        for (int c = 0; c < 3 && !s->inverse; ++c) impulse[j][c] = -off[c] / m->mass->inverse[m->slide[j].node];
        if (s->inverse) subtract_rows(*impulse, s->inverse + 9 * j * n, off, 3 * n);
    }
}

void ancf_slides_give(const ancf_model* m, const double* acceleration) {
    for (int i = 0; i < m->n_slides; ++i) {
        double a[3];
        read(a, m, acceleration, m->slide[i].node);
        across(m->sliding->given[i], &m->slide[i], a);
    }
}

// What is across is then given exactly.
static void set_across(const ancf_model* m, double* acceleration) {
    for (int i = 0; i < m->n_slides; ++i) {
        const ancf_slide* slide = &m->slide[i];
        double a[3];
        read(a, m, acceleration, slide->node);
        const double length = along(slide, a);
        for (int c = 0; c < 3; ++c) a[c] = m->sliding->given[i][c] + length * slide->along[c];
        write(m, acceleration, slide->node, a);
    }
}

void ancf_slides_constrain(const ancf_model* m, double* acceleration) {
    struct ancf_sliding* s = m->sliding;
    for (int i = 0; i < m->n_slides && s->inverse; ++i) {
        read(s->gained[i], m, acceleration, m->slide[i].node);
        for (int c = 0; c < 3; ++c) s->gained[i][c] -= s->given[i][c];
    }
    if (s->inverse) {
        const size_t field = 3 * (size_t)m->stride;
        ancf_slides_hold(s->held, m, s->gained);
        memset(s->force, 0, 2 * field * sizeof *s->force);
        for (int i = 0; i < m->n_slides; ++i) write(m, s->force, m->slide[i].node, s->held[i]);
        ancf_mass_solve_freely(m, s->answer, s->force);
        for (size_t i = 0; i < field; ++i) acceleration[i] += s->answer[i];
    }
    set_across(m, acceleration);
}

// ---------------------------------------------------------------- steps

void ancf_slides_project(const ancf_model* m, double* field) {
    for (int i = 0; i < m->n_slides; ++i) {
        const ancf_slide* s = &m->slide[i];
        double v[3];
        read(v, m, field, s->node);
        const double length = along(s, v);
        for (int c = 0; c < 3; ++c) v[c] = length * s->along[c];
        write(m, field, s->node, v);
    }
}

void ancf_slides_take(double force[3], const ancf_model* m, int node) {
    const int i = ancf_slide_of(m, node);
    if (i >= 0) across(force, &m->slide[i], (double[3]) {force[0], force[1], force[2]});
}

void ancf_slides_place(ancf_model* m) {
    for (int i = 0; i < m->n_slides; ++i) {
        const ancf_slide* s = &m->slide[i];
        double x[3];
        read(x, m, m->x, s->node);
        for (int c = 0; c < 3; ++c) x[c] -= s->at[c];
        const double length = along(s, x);
        for (int c = 0; c < 3; ++c) x[c] = s->at[c] + length * s->along[c];
        write(m, m->x, s->node, x);
    }
}

void ancf_slides_accelerate(ancf_model* m, double kick) {
    for (int i = 0; i < m->n_slides; ++i) {
        double v[3];
        read(v, m, m->v, m->slide[i].node);
        for (int c = 0; c < 3; ++c) v[c] = -v[c] / kick;
        write(m, m->a, m->slide[i].node, v);
    }
}

void ancf_slides_keep(ancf_model* m) {
    for (int i = 0; i < m->n_slides; ++i) {
        read(m->sliding->x[i], m, m->x, m->slide[i].node);
        read(m->sliding->v[i], m, m->v, m->slide[i].node);
    }
}

// As step.c does it, to the last bit.
ANCF_CLONES static void go(double* field, const ancf_model* m, double (*from)[3], double factor, const double* rate) {
    for (int i = 0; i < m->n_slides; ++i)
        for (int c = 0; c < 3; ++c) {
            const int j = c * m->stride + m->slide[i].node;
            field[j] = from[i][c] + factor * rate[j];
        }
}

void ancf_slides_move(ancf_model* m, double kick, double step) {
    if (m->n_slides == 0) return;
    if (!m->sliding->inverse) set_across(m, m->a);
    go(m->v, m, m->sliding->v, kick, m->a);
    ancf_slides_project(m, m->v); // ancf_predict
    ancf_slides_project(m, m->v); // ancf_correct
    go(m->x, m, m->sliding->x, step, m->v);
    ancf_slides_place(m);
}
