#include "ancf/step.h"
#include "account.h"
#include "ancf/elastic.h"
#include "ancf/mass.h"
#include "held.h"
#include "internal.h"
#include "massdamp.h"
#include "slide.h"

#include <string.h>

static size_t field_size(const ancf_model* m) { return 3 * (size_t)m->stride * sizeof(double); }

ANCF_CLONES static void add_scaled(double* sum, const double* a, double factor, const double* b, int n) {
#pragma GCC ivdep
    for (int i = 0; i < n; ++i) sum[i] = a[i] + factor * b[i];
}

void ancf_add_loads(const ancf_model* m, double* force, const double* v) {
    if (m->dragged) ancf_massdamp_force(force, m, v, 1.0);
    if (!m->unloaded) add_scaled(force, force, 1.0, m->external, 3 * m->stride);
    ancf_model_join(m, force);
    for (int c = 0; c < 3; ++c) // joined already
        if (m->gravity[c] != 0.0)
            add_scaled(force + c * m->stride, force + c * m->stride, m->gravity[c], m->weight, m->n_dof);
}

void ancf_total_force(ancf_model* m, const double* x, const double* v) {
    ancf_elastic_force(m, m->f, x, v);
    ancf_add_loads(m, m->f, v);
}

void ancf_acceleration(ancf_model* m, const double* x, const double* v) {
    ancf_total_force(m, x, v);
    ancf_mass_solve(m, m->a, m->f);
}

void ancf_predict(ancf_model* m, const ancf_time* time) {
    const double kick = ancf_kick(time);
    ancf_held_accelerate(m, kick);
    if (m->track) {
        ancf_books books;
        ancf_elastic_force_booked(&books, m, m->f, m->x, m->v);
        m->elastic = books.elastic;
        m->damping_power[0] = books.power + ancf_massdamp_power(m, m->v, m->v);
    } else {
        ancf_elastic_force(m, m->f, m->x, m->v);
    }
    ancf_add_loads(m, m->f, m->v);
    ancf_mass_solve(m, m->a, m->f);
    add_scaled(m->free, m->v, kick, m->a, 3 * m->stride);
    ancf_held_set(m, m->free);
    // What the damping forces do in the kick: half of that at the velocity before, half at that after they have
    // acted and no contact yet; their work on the mean, to the rounding of the scheme.
    if (m->track) m->damping_power[1] = ancf_elastic_power(m, m->free) + ancf_massdamp_power(m, m->v, m->free);
}

void ancf_correct(ancf_model* m, const ancf_time* time, const double* after, const double* shift) {
    const int n = 3 * m->stride;
    const double kick = ancf_kick(time);
    if (m->track) {
        m->damping_half = m->damping_work - 0.5 * kick * m->damping_power[0];
        m->damping_work = m->damping_half - 0.5 * kick * m->damping_power[1];
    }
    if (after != m->free)
        for (int i = 0; i < n; ++i) m->a[i] += (after[i] - m->free[i]) / kick;
    memcpy(m->v, after, field_size(m));
    ancf_slides_project(m, m->v); // what rounding left
    add_scaled(m->x, m->x, time->step, m->v, n);
    if (shift) add_scaled(m->x, m->x, 1.0, shift, n);
    ancf_slides_place(m);
}

void ancf_rk4(ancf_model* m, double step) {
    static const double at[4] = {0.0, 0.5, 0.5, 1.0}, weight[4] = {1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0};
    const int n = 3 * m->stride;
    double *x0 = m->work, *v0 = x0 + n, *dx = v0 + n, *dv = dx + n, *x = dv + n, *v = x + n;
    memcpy(x0, m->x, field_size(m));
    memcpy(v0, m->v, field_size(m));
    memset(dx, 0, 2 * field_size(m));
    ancf_held_accelerate(m, step);
    const bool track = m->track;
    double damping = 0.0; // power of the damping forces
    m->track = false;     // m->work is taken
    for (int s = 0; s < 4; ++s) {
        // v and m->a hold the rates of the stage before.
        for (int i = 0; i < n; ++i) {
            const double rate = s ? v[i] : 0.0;
            x[i] = x0[i] + at[s] * step * rate;
        }
        for (int i = 0; i < n; ++i) v[i] = v0[i] + (s ? at[s] * step * m->a[i] : 0.0);
        ancf_acceleration(m, x, v);
        if (track) damping -= weight[s] * (ancf_damping_power(m, x, v) - ancf_massdamp_power(m, v, v));
        for (int i = 0; i < n; ++i) {
            dx[i] += weight[s] * v[i];
            dv[i] += weight[s] * m->a[i];
        }
    }
    for (int i = 0; i < n; ++i) {
        m->x[i] = x0[i] + step * dx[i];
        m->v[i] = v0[i] + step * dv[i];
        m->a[i] = dv[i];
    }
    ancf_slides_project(m, m->v);
    ancf_slides_place(m);
    m->damping_work -= step * damping;
}

// Adds what an element's mass takes to be accelerated at one of its unknowns.
static void add_inertia(double force[3], const ancf_model* m, int e, int dof) {
    double M[4][4];
    int of[4];
    ancf_model_dofs(of, m, e);
    for (int i = 0; i < 4; ++i) {
        if (of[i] != dof) continue;
        ancf_mass_element(M, &m->element[e]);
        for (int j = 0; j < 4; ++j)
            for (int c = 0; c < 3; ++c) force[c] += M[i][j] * m->a[c * m->stride + of[j]];
    }
}

void ancf_reaction(double force[3], const ancf_model* m, int dof) {
    for (int c = 0; c < 3; ++c) force[c] = -m->f[c * m->stride + dof];
    if (dof < m->n_nodes) {
        for (int k = m->first[dof]; k < m->first[dof + 1]; ++k) add_inertia(force, m, m->at[k] >> 1, dof);
        ancf_slides_take(force, m, dof);
        return;
    }
    const int twin = ancf_model_twin(m, dof);
    add_inertia(force, m, (dof - m->n_nodes) % m->n_elements, dof);
    if (twin >= 0) add_inertia(force, m, (twin - m->n_nodes) % m->n_elements, twin);
}
