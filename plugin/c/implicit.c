#include "ancf/implicit.h"
#include "ancf/elastic.h"
#include "ancf/mass.h"
#include "ancf/stability.h"
#include "internal.h"
#include "massdamp.h"
#include "slide.h"
#include "stiffness.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { FIELDS = 13, ITERATIONS = 12, HALVINGS = 10 };
static const double tolerance = 1e-8; // of what Newton's method leaves, in lengths of an element and as slope
// How far anything may turn or stretch in a step, as slope. Farther off, Newton's method finds states that a cable
// would not come to, and the scheme may gain energy.
static const double farthest = 0.25;
static const double slow = 0.1; // corrections that shrink by no more get a new tangent

ancf_error ancf_implicit_create(ancf_implicit** implicit, const ancf_model* m, double rho) {
    *implicit = NULL;
    if (!(rho >= 0.0 && rho <= 1.0)) return ANCF_E_RHO;
    ancf_implicit* s = *implicit = calloc(1, sizeof *s);
    if (!s) return ANCF_E_MEMORY;
    const size_t field = 3 * (size_t)m->stride;
    s->rho = rho;
    s->fields = calloc(FIELDS * field, sizeof *s->fields);
    if (!s->fields || ancf_stiffness_create(&s->stiffness, m)) {
        ancf_implicit_destroy(s);
        *implicit = NULL;
        return ANCF_E_MEMORY;
    }
    double** const fields[FIELDS] = {&s->start_x, &s->start_v, &s->start_a, &s->old_x,  &s->old_v,
                                     &s->change,  &s->old_f,   &s->inertia, &s->held_a, &s->held_jerk,
                                     &s->kept_x,  &s->kept_v,  &s->kept_f};
    for (int k = 0; k < FIELDS; ++k) *fields[k] = s->fields + (size_t)k * field;
    return ANCF_OK;
}

void ancf_implicit_destroy(ancf_implicit* s) {
    if (!s) return;
    ancf_stiffness_destroy(s->stiffness);
    free(s->fields);
    free(s);
}

// ---------------------------------------------------------------- forces

static size_t field_size(const ancf_model* m) { return 3 * (size_t)m->stride * sizeof(double); }

static void copy(double* to, const double* from, const ancf_model* m) { memcpy(to, from, field_size(m)); }

ANCF_CLONES static void add_scaled(double* restrict sum, double factor, const double* restrict b, int n) {
    for (int i = 0; i < n; ++i) sum[i] += factor * b[i];
}

// Force at the model's state. That of the elements is kept for the step that starts there: a function of the state
// alone.
static void force_now(ancf_implicit* s, ancf_model* m, double* force) {
    if (memcmp(s->kept_x, m->x, field_size(m)) || memcmp(s->kept_v, m->v, field_size(m)) || !s->kept) {
        copy(s->kept_x, m->x, m);
        copy(s->kept_v, m->v, m);
        ancf_elastic_force(m, s->kept_f, m->x, m->v);
        s->kept = true;
    }
    copy(force, s->kept_f, m);
    ancf_add_loads(m, force, m->v);
}

// ---------------------------------------------------------------- what is held

// Over the step, what is held moves evenly accelerated, by held times its length in all: its acceleration is the
// difference to the velocity of the step before over the time between the middles of both.
static void plan_held(ancf_implicit* s, const ancf_model* m, const double* a, const ancf_time* time) {
    for (int k = 0; k < m->n_held; ++k)
        for (int c = 0; c < 3; ++c) {
            const int j = c * m->stride + m->is_held[k];
            const double before = m->v[j] - 0.5 * time->last * a[j];
            s->held_a[j] = (m->held[j] - before) / ancf_kick(time);
            s->held_jerk[j] = time->last > 0.0 ? (s->held_a[j] - a[j]) / time->last : 0.0;
        }
}

// Puts what is held where it is `at` seconds after the start; its acceleration in m->a is that of `middle`.
static void place_held(const ancf_implicit* s, ancf_model* m, double step, double at, double middle) {
    for (int k = 0; k < m->n_held; ++k)
        for (int c = 0; c < 3; ++c) {
            const int j = c * m->stride + m->is_held[k];
            const double turn = s->held_a[j], first = m->held[j] - 0.5 * step * turn;
            m->x[j] = at == step ? s->start_x[j] + step * m->held[j] : s->start_x[j] + at * (first + 0.5 * at * turn);
            m->v[j] = first + at * turn;
            m->a[j] = turn + middle * s->held_jerk[j];
        }
}

// ---------------------------------------------------------------- Newton's method

// Constants of the method; forces and inertia balance as weighted means of both ends of a step.
typedef struct {
    double inertia_new, force_new; // 1 - alpha_m, 1 - alpha_f
    double beta, gamma;
} weights;

static weights weights_of(double rho) {
    const double alpha_m = (2.0 * rho - 1.0) / (rho + 1.0), alpha_f = rho / (rho + 1.0);
    return (weights) {.inertia_new = 1.0 - alpha_m,
                      .force_new = 1.0 - alpha_f,
                      .beta = 0.25 * (1.0 - alpha_m + alpha_f) * (1.0 - alpha_m + alpha_f),
                      .gamma = 0.5 - alpha_m + alpha_f};
}

// Where the last correction was largest, or not a number.
static void find_fault(ancf_implicit* s, const ancf_model* m) {
    double largest = -1.0;
    for (int c = 0; c < 3; ++c)
        for (int i = 0; i < m->n_dof; ++i) {
            const double size = s->stiffness->per_size[i] * fabs(s->change[c * m->stride + i]);
            if (m->hold[i] || size <= largest) continue;
            largest = isnan(size) ? INFINITY : size;
            s->element = i < m->n_nodes ? m->at[m->first[i]] >> 1 : (i - m->n_nodes) % m->n_elements;
        }
}

// Corrects the trial state until inertia and forces balance; m->f and m->a are the means of both that do.
static bool solve(ancf_implicit* s, ancf_model* m, double* a, const weights* w, double h) {
    const int n = 3 * m->stride;
    const double per_x = 1.0 / (w->beta * h * h), rate = w->gamma / (w->beta * h);
    const double mu = w->inertia_new * per_x / w->force_new;
    double last = 0.0;
    bool renew = true, exact = true, settled = false;
    for (int k = 0; k <= ITERATIONS; ++k) {
        force_now(s, m, m->f);
        for (int i = 0; i < n; ++i) m->f[i] = w->force_new * m->f[i] + (1.0 - w->force_new) * s->old_f[i];
        if (settled) return true;
        ancf_mass_multiply(m, s->inertia, m->a);
        for (int i = 0; i < n; ++i) s->change[i] = (m->f[i] - s->inertia[i]) / w->force_new;
        if (renew) {
            exact = ancf_stiffness_factor(s->stiffness, m, m->x, m->v, mu, rate, false);
            if (!exact && !ancf_stiffness_factor(s->stiffness, m, m->x, m->v, mu, rate, true)) return false;
        }
        ancf_stiffness_solve(s->stiffness, m, s->change, s->change);
        ++s->iterations;
        const double size = ancf_stiffness_size(s->stiffness, m, s->change), shrinks = k > 0 ? size / last : 1.0;
        if (!isfinite(size)) return false;
        add_scaled(m->x, 1.0, s->change, n);
        add_scaled(m->v, rate, s->change, n);
        add_scaled(a, per_x, s->change, n);
        add_scaled(m->a, w->inertia_new * per_x, s->change, n);
        // What is left: of second order by the tangent of this very state, else as corrections shrink.
        const double left = renew && exact ? size * size : shrinks < 1.0 ? size * shrinks / (1.0 - shrinks) : INFINITY;
        settled = left < tolerance;
        renew = k > 0 && shrinks > slow;
        last = size;
    }
    return false;
}

// ---------------------------------------------------------------- energy

static double product(const ancf_model* m, const double* a, const double* b, bool joined) {
    double sum = 0.0;
    for (int c = 0; c < 3; ++c)
        for (int i = 0; i < m->n_dof; ++i)
            if (!joined || ancf_model_counts(m, i)) sum += a[c * m->stride + i] * b[c * m->stride + i];
    return sum;
}

static double elastic_energy(const ancf_model* m, const double* x) {
    double axial, bending;
    ancf_elastic_energy(&axial, &bending, m, x, 0, m->n_elements);
    return axial + bending;
}

static double kinetic_energy(ancf_implicit* s, const ancf_model* m, const double* v) {
    ancf_mass_multiply(m, s->inertia, v);
    return 0.5 * product(m, v, s->inertia, true);
}

// What a part of a step took out: by damping forces, and beyond it by weighting inertia and elastic forces so that
// their work is more than the energies gain. Uses m->work.
static void note_losses(ancf_implicit* s, ancf_model* m, const weights* w) {
    const int n = 3 * m->stride;
    double *way = m->work, *rest = way + n, *elastic = rest + n, *damping = elastic + n, *all = damping + n,
           *alone = all + n;
    memset(rest, 0, 3 * field_size(m));
    for (int i = 0; i < n; ++i) way[i] = m->x[i] - s->old_x[i];
    for (int k = 0; k < 2; ++k) {
        const double part = k ? w->force_new : 1.0 - w->force_new, *x = k ? m->x : s->old_x, *v = k ? m->v : s->old_v;
        ancf_elastic_force(m, all, x, v);
        ancf_elastic_force(m, alone, x, rest);
        for (int i = 0; i < n; ++i) {
            damping[i] += part * (all[i] - alone[i]);
            elastic[i] += part * alone[i];
        }
        if (m->dragged) ancf_massdamp_force(damping, m, v, part);
    }
    m->damping_work -= product(m, damping, way, false);
    ancf_mass_multiply(m, s->inertia, m->a);
    s->lost += product(m, s->inertia, way, true) - product(m, elastic, way, false);
    s->lost -= kinetic_energy(s, m, m->v) - kinetic_energy(s, m, s->old_v);
    s->lost -= elastic_energy(m, m->x) - elastic_energy(m, s->old_x);
}

// ---------------------------------------------------------------- steps

// What slides goes on along its line: no velocity nor acceleration across it.
static void keep_on_lines(ancf_model* m, double* a) {
    ancf_slides_place(m);
    ancf_slides_project(m, m->v);
    ancf_slides_project(m, a);
}

// One of the equal parts of a step.
static bool take_part(ancf_implicit* s, ancf_model* m, double* a, const weights* w, double step, int part) {
    const int n = 3 * m->stride;
    const double h = step / s->parts, at = part * h, end = part + 1 == s->parts ? step : at + h;
    keep_on_lines(m, a);
    copy(s->old_x, m->x, m);
    copy(s->old_v, m->v, m);
    force_now(s, m, s->old_f);
    for (int i = 0; i < n; ++i) { // accelerations of the start go on, as a first trial
        m->x[i] += h * (m->v[i] + 0.5 * h * a[i]);
        m->v[i] += h * a[i];
        m->a[i] = a[i];
    }
    place_held(s, m, step, end, at + w->inertia_new * h);
    if (!solve(s, m, a, w, h) || !ancf_finite(m, m->x) || !ancf_finite(m, m->v)) return false;
    keep_on_lines(m, a);
    for (int i = 0; i < n; ++i) s->change[i] = m->x[i] - s->old_x[i];
    if (ancf_stiffness_turn(m, s->change) > farthest) return false;
    if (m->track) note_losses(s, m, w);
    return true;
}

// Accelerations at the start, where the caller has none.
static void accelerate(ancf_implicit* s, ancf_model* m, double* a) {
    force_now(s, m, m->f);
    copy(a, s->held_a, m);
    ancf_mass_solve(m, a, m->f);
}

static bool take_step(ancf_implicit* s, ancf_model* m, double* a, const weights* w, double step) {
    for (int part = 0; part < s->parts; ++part)
        if (!take_part(s, m, a, w, step, part)) return false;
    return true;
}

ancf_error ancf_implicit_step(ancf_implicit* s, ancf_model* m, double* a, const ancf_time* time, int parts) {
    const weights w = weights_of(s->rho);
    const double damped = m->damping_work, lost = s->lost;
    plan_held(s, m, a, time);
    if (time->last <= 0.0) accelerate(s, m, a);
    copy(s->start_x, m->x, m);
    copy(s->start_v, m->v, m);
    copy(s->start_a, a, m);
    s->iterations = 0;
    for (s->parts = parts; !take_step(s, m, a, &w, time->step); s->parts *= 2) {
        find_fault(s, m);
        ++s->rejected;
        copy(m->x, s->start_x, m);
        copy(m->v, s->start_v, m);
        copy(a, s->start_a, m);
        m->damping_work = damped;
        s->lost = lost;
        if (s->parts == parts << HALVINGS) return ANCF_E_STEP;
    }
    for (int k = 0; k < m->n_held; ++k)
        for (int c = 0; c < 3; ++c) a[c * m->stride + m->is_held[k]] = s->held_a[c * m->stride + m->is_held[k]];
    for (int i = 0; i < 3 * m->stride; ++i) m->free[i] = (m->x[i] - s->start_x[i]) / time->step;
    m->damping_half = damped;
    return ANCF_OK;
}
