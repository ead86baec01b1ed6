// Predict and correct in one pass over the elements, where nothing acts but the model's own forces: what a tile needs
// is read once, and only the state is written. The same operations in the same order as in step.c, to the last bit.
#include "ancf/mass.h"
#include "ancf/step.h"
#include "held.h"
#include "tile.h"

#include <omp.h>

// How unknowns go on: v += kick f/M and x += step v, gravity in f.
typedef struct {
    double kick, step, gravity[3];                         // [s], [s], [m/s2]
    double *x0[3], *v0[3], *x1[3], *v1[3];                 // slopes at the starts and ends of a tile
    const double *inverse0, *inverse1, *weight0, *weight1; // 1/M, and what gravity's force is over g
} mover;

ANCF_INLINE void move_all(double* restrict x, double* restrict v, const double* restrict f,
                          const double* restrict inverse, const double* restrict weight, double kick, double step,
                          double gravity, int n, int falls) {
    for (int i = 0; i < n; ++i) {
        const double force = falls ? f[i] + gravity * weight[i] : f[i], a = inverse[i] * force;
        v[i] = v[i] + kick * a;
        x[i] = x[i] + step * v[i];
    }
}

// A component of unknowns that follow one another goes on.
ANCF_INLINE void move(double* restrict x, double* restrict v, const double* restrict f, const double* restrict inverse,
                      const double* restrict weight, const mover* by, int c, int n) {
    const double g = by->gravity[c];
    if (g != 0.0) move_all(x, v, f, inverse, weight, by->kick, by->step, g, n, 1);
    else move_all(x, v, f, inverse, weight, by->kick, by->step, g, n, 0);
}

ANCF_INLINE void add(double* restrict sum, const double* restrict more, int n) {
    for (int i = 0; i < n; ++i) sum[i] += more[i];
}

// Where a slope goes on into that of the next element, the force on both is the sum.
ANCF_INLINE void join(double* restrict start, double* restrict end, const double* restrict goes_on, int n) {
#pragma GCC ivdep
    for (int e = 0; e + 1 < n; ++e) {
        const double next = start[e + 1], last = end[e];
        start[e + 1] = next + goes_on[e] * last;
        end[e] = last + goes_on[e] * next;
    }
}

typedef struct {
    double f0[3][ANCF_TILE], f1[3][ANCF_TILE], on[3][ANCF_TILE], node[ANCF_TILE];
} forces;

// Moves the slopes that are a tile's own; the forces on its first and last are left in m->f, for a seam.
ANCF_CLONES static void move_slopes(ancf_model* m, const ancf_tile* t, forces* f, const mover* by) {
    const int n = t->end - t->begin, first = !t->start_moves, last = !t->end_moves, begin = m->tile[t->like].begin;
    for (int c = 0; c < 3; ++c) {
        const int start = c * m->stride + m->n_nodes + t->begin, end = start + m->n_elements;
        double *f0 = f->f0[c], *f1 = f->f1[c];
        if (!m->unloaded) {
            add(f0, m->external + start, n);
            add(f1, m->external + end, n);
        }
        if (t->joined) join(f0, f1, m->goes_on + begin, n);
        m->f[start] = f0[0];
        m->f[end + n - 1] = f1[n - 1];
        move(by->x0[c] + first, by->v0[c] + first, f0 + first, by->inverse0 + first, by->weight0 + first, by, c,
             n - first);
        move(by->x1[c], by->v1[c], f1, by->inverse1, by->weight1, by, c, n - last);
    }
}

// The same where all of them go on from one element into the next, and nothing is loaded: both copies at once.
ANCF_CLONES static void move_smooth(ancf_model* m, const ancf_tile* t, const forces* f, const mover* by) {
    const int n = t->end - t->begin;
    for (int c = 0; c < 3; ++c) {
        const int start = c * m->stride + m->n_nodes + t->begin, end = start + m->n_elements + n - 1;
        const double *f0 = f->f0[c] + 1, *f1 = f->f1[c], *inverse = by->inverse0 + 1, *weight = by->weight0 + 1;
        double *x0 = by->x0[c] + 1, *v0 = by->v0[c] + 1, *x1 = by->x1[c], *v1 = by->v1[c];
        const double kick = by->kick, step = by->step, g = by->gravity[c];
#pragma GCC ivdep
        for (int e = 0; e < n - 1; ++e) {
            const double a = inverse[e] * (f0[e] + f1[e] + g * weight[e]), v = v0[e] + kick * a, x = x0[e] + step * v;
            v0[e] = v1[e] = v;
            x0[e] = x1[e] = x;
        }
        m->f[start] = f->f0[c][0];
        m->f[end] = f1[n - 1];
        if (t->start_moves) move(x0 - 1, v0 - 1, f0 - 1, inverse - 1, weight - 1, by, c, 1);
        if (t->end_moves) move(x1 + n - 1, v1 + n - 1, f1 + n - 1, by->inverse1 + n - 1, by->weight1 + n - 1, by, c, 1);
    }
}

// Those of springs, which nothing acts on.
ANCF_CLONES static void drift(const mover* by, int n) {
    for (int c = 0; c < 3; ++c) {
        double* restrict x0 = by->x0[c], * restrict x1 = by->x1[c];
        const double *v0 = by->v0[c], *v1 = by->v1[c];
        for (int e = 0; e < n; ++e) {
            x0[e] = x0[e] + by->step * v0[e];
            x1[e] = x1[e] + by->step * v1[e];
        }
    }
}

// Moves the nodes between the elements of a chain; the forces on those at its ends are left in m->pull.
ANCF_CLONES static void move_between(ancf_model* m, const ancf_tile* t, forces* f, const mover* by) {
    const int n = t->end - t->begin, node = m->ends[2 * t->begin + 1], like = m->ends[2 * m->tile[t->like].begin + 1];
    const double* inverse = ancf_mass_inverse(m);
    for (int c = 0; c < 3; ++c) {
        const int block = c * m->stride + node;
        double *pull = m->pull + c * m->n_elements + t->begin, *on = f->on[c];
        pull[0] = on[0];
        pull[n - 1] = on[n - 1];
        double *x = m->x + block, *v = m->v + block;
        const double *external = m->external + block, *flex = inverse + like, *weight = m->weight + like;
        const double kick = by->kick, step = by->step, g = by->gravity[c];
        for (int e = 0; e + 1 < n; ++e) f->node[e] = on[e] - on[e + 1];
        if (!m->unloaded) add(f->node, external, n - 1);
#pragma GCC ivdep
        for (int e = 0; e < n - 1; ++e) {
            const double a = flex[e] * (f->node[e] + g * weight[e]);
            v[e] = v[e] + kick * a;
            x[e] = x[e] + step * v[e];
        }
    }
}

static void advance_tile(ancf_model* m, const ancf_tile* t, mover by) {
    double way[3][ANCF_TILE], wayv[3][ANCF_TILE];
    forces f;
    ancf_fields k = ancf_tile_fields(m, t, m->x, m->v, way, wayv);
    const int n = t->end - t->begin, start = m->n_nodes + t->begin, like = m->n_nodes + m->tile[t->like].begin;
    by.inverse0 = ancf_mass_inverse(m) + like;
    by.inverse1 = by.inverse0 + m->n_elements;
    by.weight0 = m->weight + like;
    by.weight1 = by.weight0 + m->n_elements;
    for (int c = 0; c < 3; ++c) {
        by.x0[c] = m->x + c * m->stride + start;
        by.v0[c] = m->v + c * m->stride + start;
        by.x1[c] = by.x0[c] + m->n_elements;
        by.v1[c] = by.v0[c] + m->n_elements;
        k.f0[c] = f.f0[c];
        k.f1[c] = f.f1[c];
        if (t->chain) k.fd[c] = f.on[c];
    }
    ancf_kernel(&k, t->kind, t->bending, t->damped);
    if (t->kind & ANCF_SPRING) drift(&by, n);
    else if (t->joined == n - 1 && m->unloaded) move_smooth(m, t, &f, &by);
    else move_slopes(m, t, &f, &by);
    if (t->chain) move_between(m, t, &f, &by);
}

// Moves unknowns whose forces, all but gravity's, stand in m->f.
ANCF_INLINE void move_places(ancf_model* m, const mover* by, int begin, int end) {
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

ANCF_CLONES static void move_knots(ancf_model* m, const ancf_knots* r, const mover* by) {
    ancf_tile_gather(m->f, m, r->begin, r->end);
    for (int c = 0; c < 3 && !m->unloaded; ++c)
        add(m->f + c * m->stride + r->begin, m->external + c * m->stride + r->begin, r->end - r->begin);
    move_places(m, by, r->begin, r->end);
}

ANCF_CLONES static void move_seam(ancf_model* m, const ancf_seam* s, const mover* by) {
    const int* place = s->place;
    for (int c = 0; c < 3 && place[1] >= 0; ++c) {
        double *f = m->f + c * m->stride, sum = f[place[0]] + f[place[1]];
        f[place[0]] = f[place[1]] = sum;
    }
    for (int k = 0; k < 2 && place[k] >= 0; ++k) move_places(m, by, place[k], place[k] + 1);
}

// First tile of the thread that computes tile t.
static int run_of(const ancf_model* m, int t, int threads) {
    const int thread = (int)(((t + 1L) * threads - 1) / m->n_tiles);
    return ancf_share(m->n_tiles, thread, threads);
}

// One of `threads`: a run of tiles each, and what waits for these alone; when all have been computed, its part of what
// waits for those of several. No sum depends on their number.
static void pass(ancf_model* m, const mover* by, int thread, int threads) {
    const int begin = ancf_share(m->n_tiles, thread, threads), end = ancf_share(m->n_tiles, thread + 1, threads);
    for (int t = begin; t < end; ++t) {
        const ancf_tile* of = &m->tile[t];
        advance_tile(m, of, *by);
        for (int k = of->knots; k < of[1].knots; ++k)
            if (m->knots[k].first >= begin) move_knots(m, &m->knots[k], by);
        for (int k = of->seam; k < of[1].seam; ++k)
            if (m->seam[k].first >= begin) move_seam(m, &m->seam[k], by);
    }
    if (threads == 1) return;
#pragma omp barrier
    for (int k = ancf_share(m->n_knots, thread, threads); k < ancf_share(m->n_knots, thread + 1, threads); ++k)
        if (m->knots[k].first < run_of(m, m->knots[k].last, threads)) move_knots(m, &m->knots[k], by);
    for (int k = ancf_share(m->n_seams, thread, threads); k < ancf_share(m->n_seams, thread + 1, threads); ++k)
        if (m->seam[k].first < run_of(m, m->seam[k].last, threads)) move_seam(m, &m->seam[k], by);
}

// Everything at once, from m->a.
ANCF_CLONES static void move_whole(ancf_model* m, const mover* by) {
    double* restrict x = m->x, * restrict v = m->v;
    const double* restrict a = m->a;
    const double kick = by->kick, step = by->step;
    for (int i = 0; i < 3 * m->stride; ++i) {
        v[i] = v[i] + kick * a[i];
        x[i] = x[i] + step * v[i];
    }
}

void ancf_advance(ancf_model* m, const ancf_time* time) {
    const mover by = {
        .kick = ancf_kick(time), .step = time->step, .gravity = {m->gravity[0], m->gravity[1], m->gravity[2]}};
    if (m->track || m->dragged) {
        ancf_predict(m, time);
        ancf_correct(m, time, m->free, NULL);
        return;
    }
    ancf_held_accelerate(m, by.kick);
    ancf_held_keep(m);
    if (!ancf_mass_diagonal(m)) {
        ancf_acceleration(m, m->x, m->v);
        move_whole(m, &by);
    } else if (m->n_elements < ANCF_THREADED_FROM) {
        pass(m, &by, 0, 1);
    } else {
#pragma omp parallel
        pass(m, &by, omp_get_thread_num(), omp_get_num_threads());
    }
    ancf_held_move(m, by.kick, by.step);
}
