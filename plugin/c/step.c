#include "ancf/step.h"
#include "ancf/elastic.h"
#include "ancf/mass.h"
#include "internal.h"

#include <string.h>

static size_t field_size(const ancf_model* m) { return 3 * (size_t)m->stride * sizeof(double); }

ANCF_CLONES static void add_scaled(double* sum, const double* a, double factor, const double* b, int n) {
#pragma GCC ivdep
    for (int i = 0; i < n; ++i) sum[i] = a[i] + factor * b[i];
}

void ancf_add_loads(const ancf_model* m, double* force) {
    add_scaled(force, force, 1.0, m->external, 3 * m->stride);
    ancf_model_join(m, force);
    for (int c = 0; c < 3; ++c) // joined already
        if (m->gravity[c] != 0.0)
            add_scaled(force + c * m->stride, force + c * m->stride, m->gravity[c], m->weight, m->n_dof);
}

// m->f = all forces but contact at a state.
static void total_force(ancf_model* m, const double* x, const double* v) {
    ancf_elastic_force(m, m->f, x, v);
    if (m->track) memcpy(m->work + 6 * m->stride, m->f, field_size(m)); // for note_damping
    ancf_add_loads(m, m->f);
}

void ancf_acceleration(ancf_model* m, const double* x, const double* v) {
    total_force(m, x, v);
    ancf_mass_solve(m, m->a, m->f);
}

// Acceleration that brings what is held to its given velocity within a kick.
static void accelerate_held(ancf_model* m, double kick) {
    for (int k = 0; k < m->n_held; ++k)
        for (int c = 0; c < 3; ++c) {
            const int j = c * m->stride + m->is_held[k];
            m->a[j] = (m->held[j] - m->v[j]) / kick;
        }
}

// Velocities of what is held, exactly.
static void set_held(const ancf_model* m, double* v) {
    for (int k = 0; k < m->n_held; ++k)
        for (int c = 0; c < 3; ++c) {
            const int j = c * m->stride + m->is_held[k];
            v[j] = m->held[j];
        }
}

void ancf_predict(ancf_model* m, const ancf_time* time) {
    const double kick = ancf_kick(time);
    accelerate_held(m, kick);
    total_force(m, m->x, m->v);
    ancf_mass_solve(m, m->a, m->f);
    add_scaled(m->free, m->v, kick, m->a, 3 * m->stride);
    set_held(m, m->free);
}

// What the Kelvin-Voigt forces take out in a kick, to the last bit of the scheme: their work on the mean velocity. The
// forces are what total_force kept less the elastic ones.
static void note_damping(ancf_model* m) {
    const int n = 3 * m->stride;
    double *damping = m->work + 2 * n, *elastic = damping + n, *rest = elastic + n;
    if (!m->track) return;
    memset(rest, 0, field_size(m));
    ancf_elastic_force(m, elastic, m->x, rest);
    for (int i = 0; i < n; ++i) damping[i] -= elastic[i];
}

// Half a kick's worth of it, at a velocity: that before, or that after they have acted and no contact yet.
static void track_damping(ancf_model* m, double kick, const double* velocity) {
    const int n = 3 * m->stride;
    const double* damping = m->work + 2 * n;
    if (!m->track) return;
    for (int i = 0; i < n; ++i) m->damping_work -= 0.5 * kick * damping[i] * velocity[i];
}

void ancf_correct(ancf_model* m, const ancf_time* time, const double* after, const double* shift) {
    const int n = 3 * m->stride;
    const double kick = ancf_kick(time);
    note_damping(m);
    track_damping(m, kick, m->v);
    m->damping_half = m->damping_work;
    track_damping(m, kick, m->free);
    if (after != m->free)
        for (int i = 0; i < n; ++i) m->a[i] += (after[i] - m->free[i]) / kick;
    memcpy(m->v, after, field_size(m));
    add_scaled(m->x, m->x, time->step, m->v, n);
    if (shift) add_scaled(m->x, m->x, 1.0, shift, n);
}

void ancf_rk4(ancf_model* m, double step) {
    static const double at[4] = {0.0, 0.5, 0.5, 1.0}, weight[4] = {1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0};
    const int n = 3 * m->stride;
    double *x0 = m->work, *v0 = x0 + n, *dx = v0 + n, *dv = dx + n, *x = dv + n, *v = x + n;
    memcpy(x0, m->x, field_size(m));
    memcpy(v0, m->v, field_size(m));
    memset(dx, 0, 2 * field_size(m));
    accelerate_held(m, step);
    m->track = false; // its work is not counted, and m->work is taken
    for (int s = 0; s < 4; ++s) {
        // v and m->a hold the rates of the stage before.
        for (int i = 0; i < n; ++i) {
            const double rate = s ? v[i] : 0.0;
            x[i] = x0[i] + at[s] * step * rate;
        }
        for (int i = 0; i < n; ++i) v[i] = v0[i] + (s ? at[s] * step * m->a[i] : 0.0);
        ancf_acceleration(m, x, v);
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
}

void ancf_reaction(double force[3], const ancf_model* m, int dof) {
    for (int c = 0; c < 3; ++c) force[c] = -m->f[c * m->stride + dof];
    for (int e = 0; e < m->n_elements; ++e) {
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
}
