// Predict and correct in one pass over the elements, where nothing acts but the model's own forces: what a tile needs
// is read once, and only the state is written. The same operations in the same order as in step.c, to the last bit.
#include "ancf/mass.h"
#include "ancf/step.h"
#include "held.h"
#include "tile.h"

// How a component of the state goes on.
typedef struct {
    double kick, step, gravity; // [s], [s], [m/s2]
} mover;

ANCF_INLINE void move_all(double* restrict x, double* restrict v, const double* restrict f,
                          const double* restrict inverse, const double* restrict weight, const mover* by, int n,
                          int falls) {
    const mover b = *by;
    for (int i = 0; i < n; ++i) {
        const double force = falls ? f[i] + b.gravity * weight[i] : f[i], a = inverse[i] * force;
        v[i] = v[i] + b.kick * a;
        x[i] = x[i] + b.step * v[i];
    }
}

ANCF_CLONES static void move(double* restrict x, double* restrict v, const double* restrict f,
                             const double* restrict inverse, const double* restrict weight, const mover* by, int n) {
    if (by->gravity != 0.0) move_all(x, v, f, inverse, weight, by, n, 1);
    else move_all(x, v, f, inverse, weight, by, n, 0);
}

ANCF_CLONES static void add(double* restrict sum, const double* restrict more, int n) {
    for (int i = 0; i < n; ++i) sum[i] += more[i];
}

// Where a slope goes on into that of the next element, the force on both is the sum.
ANCF_CLONES static void join(double* restrict start, double* restrict end, const double* restrict goes_on, int n) {
#pragma GCC ivdep
    for (int e = 0; e + 1 < n; ++e) {
        const double next = start[e + 1], last = end[e];
        start[e + 1] = next + goes_on[e] * last;
        end[e] = last + goes_on[e] * next;
    }
}

// Forces on the nodes between the elements of a chain.
ANCF_CLONES static void between(double* restrict force, const double* restrict on, int n) {
    for (int e = 0; e + 1 < n; ++e) force[e] = on[e] - on[e + 1];
}

typedef struct {
    double f0[3][ANCF_TILE], f1[3][ANCF_TILE], on[3][ANCF_TILE], node[ANCF_TILE];
} forces;

// Moves what is a tile's own; the forces on its first and last slope are left in m->f, for a seam.
static void move_tile(ancf_model* m, const ancf_tile* t, forces* f, mover by) {
    const ancf_tile* like = &m->tile[t->like];
    const double* inverse = ancf_mass_inverse(m);
    const int n = t->end - t->begin, first = !t->start_moves, last = !t->end_moves;
    for (int c = 0; c < 3; ++c) {
        const int block = c * m->stride, start = m->n_nodes + t->begin, end = start + m->n_elements,
                  s = m->n_nodes + like->begin, e = s + m->n_elements;
        double *f0 = f->f0[c], *f1 = f->f1[c], *x = m->x + block, *v = m->v + block;
        by.gravity = m->gravity[c];
        if (!m->unloaded) {
            add(f0, m->external + block + start, n);
            add(f1, m->external + block + end, n);
        }
        if (t->joined) join(f0, f1, m->goes_on + like->begin, n);
        m->f[block + start] = f0[0];
        m->f[block + end + n - 1] = f1[n - 1];
        move(x + start + first, v + start + first, f0 + first, inverse + s + first, m->weight + s + first, &by,
             n - first);
        move(x + end, v + end, f1, inverse + e, m->weight + e, &by, n - last);
        if (!t->chain) continue;
        const int node = m->ends[2 * t->begin + 1], alike = m->ends[2 * like->begin + 1];
        between(f->node, f->on[c], n);
        if (!m->unloaded) add(f->node, m->external + block + node, n - 1);
        move(x + node, v + node, f->node, inverse + alike, m->weight + alike, &by, n - 1);
    }
}

static void advance_tile(ancf_model* m, const ancf_tile* t, const mover* by) {
    double d[3][ANCF_TILE], dv[3][ANCF_TILE];
    forces f;
    ancf_fields k = ancf_tile_fields(m, t, m->x, m->v, d, dv, f.on);
    for (int c = 0; c < 3; ++c) {
        k.f0[c] = f.f0[c];
        k.f1[c] = f.f1[c];
    }
    ancf_kernel(&k, t->kind, t->bending, t->damped);
    ancf_tile_keep(m, t, f.on, true);
    move_tile(m, t, &f, *by);
}

// Moves unknowns whose forces, all but gravity's, stand in m->f.
ANCF_CLONES static void move_places(ancf_model* m, const mover* by, int begin, int end) {
    const double* inverse = ancf_mass_inverse(m);
    const mover b = *by;
    for (int c = 0; c < 3; ++c) {
        double *x = m->x + c * m->stride, *v = m->v + c * m->stride, *f = m->f + c * m->stride,
               *a = m->a + c * m->stride;
        const double g = m->gravity[c];
        for (int i = begin; i < end && g != 0.0; ++i) f[i] += g * m->weight[i];
#pragma GCC ivdep
        for (int i = begin; i < end; ++i) {
            a[i] = inverse[i] > 0.0 ? inverse[i] * f[i] : a[i];
            v[i] = v[i] + b.kick * a[i];
            x[i] = x[i] + b.step * v[i];
        }
    }
}

static void move_knots(ancf_model* m, const ancf_range* r, const mover* by) {
    ancf_tile_gather(m->f, m, r->begin, r->end);
    for (int c = 0; c < 3 && !m->unloaded; ++c)
        add(m->f + c * m->stride + r->begin, m->external + c * m->stride + r->begin, r->end - r->begin);
    move_places(m, by, r->begin, r->end);
}

static void move_seam(ancf_model* m, const int* place, const mover* by) {
    for (int c = 0; c < 3 && place[1] >= 0; ++c) {
        double *f = m->f + c * m->stride, sum = f[place[0]] + f[place[1]];
        f[place[0]] = f[place[1]] = sum;
    }
    for (int k = 0; k < 2 && place[k] >= 0; ++k) move_places(m, by, place[k], place[k] + 1);
}

// Alone, or by all threads of a team: no sum depends on their number.
static void pass(ancf_model* m, const mover* by) {
#pragma omp for schedule(static)
    for (int t = 0; t < m->n_tiles; ++t) advance_tile(m, &m->tile[t], by);
#pragma omp for schedule(static) nowait
    for (int r = 0; r < m->n_knots; ++r) move_knots(m, &m->knots[r], by);
#pragma omp for schedule(static)
    for (int s = 0; s < m->n_seams; ++s) move_seam(m, &m->seam[2 * s], by);
}

void ancf_advance(ancf_model* m, const ancf_time* time) {
    const mover by = {.kick = ancf_kick(time), .step = time->step};
    if (!ancf_mass_diagonal(m) || m->track) {
        ancf_predict(m, time);
        ancf_correct(m, time, m->free, NULL);
        return;
    }
    ancf_held_accelerate(m, by.kick);
    ancf_held_keep(m);
    pass(m, &by);
    ancf_held_move(m, by.step);
}
