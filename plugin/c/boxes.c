#include "ancf/boxes.h"
#include "internal.h"

#include <limits.h>
#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

static double lower(double a, double b) { return a < b ? a : b; }

static double higher(double a, double b) { return a > b ? a : b; }

struct start {
    double low;
    int element;
};

struct ancf_boxes {
    const ancf_cover* cover;
    int n;
    double ahead;
    double* room;        // (n) [m]
    double* reference;   // (3 x stride) state in which the boxes were set
    double* rest;        // (n_dof) zero
    double* lever;       // (n_dof) by how much an unknown moves a control point of the curve [-], [m]
    double* moved;       // (n_dof) from the reference, as control points move [m]
    ancf_box* box;       // (n)
    struct start* order; // (n) by lower ends along an axis
    int n_meetings, room_meetings;
    ancf_meeting *meeting, *spare; // spare: for sorting
    int* count;                    // (n + 1)
};

// A slope moves its control point by a third of the element's length; those of springs move nothing.
static double lever(const ancf_model* m, int dof) {
    if (dof < m->n_nodes) return 1.0;
    const ancf_element* e = &m->element[(dof - m->n_nodes) % m->n_elements];
    return e->kind & ANCF_SPRING ? 0.0 : e->length / 3.0;
}

ancf_error ancf_boxes_create(ancf_boxes** boxes, const ancf_model* m, const ancf_cover* cover) {
    ancf_boxes* b = *boxes = calloc(1, sizeof *b);
    if (!b) return ANCF_E_MEMORY;
    const size_t n = (size_t)m->n_elements;
    b->cover = cover;
    b->n = m->n_elements;
    b->room = calloc(n, sizeof *b->room);
    b->reference = calloc(3 * (size_t)m->stride, sizeof *b->reference);
    b->lever = calloc((size_t)m->n_dof, sizeof *b->lever);
    b->moved = calloc((size_t)m->n_dof, sizeof *b->moved);
    b->rest = calloc((size_t)m->n_dof, sizeof *b->rest);
    b->box = calloc(n, sizeof *b->box);
    b->order = calloc(n, sizeof *b->order);
    b->count = calloc(n + 1, sizeof *b->count);
    if (!b->room || !b->reference || !b->rest || !b->lever || !b->moved || !b->box || !b->order || !b->count) {
        ancf_boxes_destroy(b);
        *boxes = NULL;
        return ANCF_E_MEMORY;
    }
    for (int i = 0; i < m->n_dof; ++i) b->lever[i] = lever(m, i);
    return ANCF_OK;
}

void ancf_boxes_destroy(ancf_boxes* b) {
    if (!b) return;
    free(b->room);
    free(b->reference);
    free(b->lever);
    free(b->rest);
    free(b->moved);
    free(b->box);
    free(b->order);
    free(b->meeting);
    free(b->spare);
    free(b->count);
    free(b);
}

// Sum of what moves an element's control points, the larger of its ends; field: (n_dof).
static double larger_end(const ancf_model* m, const double* field, int e) {
    int dof[4];
    ancf_model_dofs(dof, m, e);
    return higher(field[dof[0]] + field[dof[1]], field[dof[2]] + field[dof[3]]);
}

// Largest component of a difference of fields at every unknown, as a way of control points. Blocks of b may be one.
ANCF_CLONES static void largest_ways(double* way, const double* a, const double* b, const double* lever, int n,
                                     int stride, int stride_b) {
    for (int i = 0; i < n; ++i) {
        const double x = fabs(a[i] - b[i]), y = fabs(a[stride + i] - b[stride_b + i]),
                     z = fabs(a[2 * stride + i] - b[2 * stride_b + i]);
        const double xy = x > y ? x : y;
        way[i] = lever[i] * (xy > z ? xy : z);
    }
}

double ancf_boxes_fastest(const ancf_model* m) {
    double square = 0.0;
    for (int e = 0; e < m->n_elements; ++e) {
        int dof[4];
        ancf_model_dofs(dof, m, e);
        for (int k = 0; k < 4; k += 2) {
            const double third = lever(m, dof[k + 1]);
            double sum = 0.0;
            for (int c = 0; c < 3; ++c) {
                const double* v = m->v + c * m->stride;
                const double total = fabs(v[dof[k]]) + third * fabs(v[dof[k + 1]]);
                sum += total * total;
            }
            square = higher(square, sum);
        }
    }
    return sqrt(square);
}

void ancf_boxes_plan(ancf_boxes* b, const ancf_model* m, double step, int steps, double ahead) {
    b->ahead = ahead;
    largest_ways(b->moved, m->v, b->rest, b->lever, m->n_dof, m->stride, 0);
    for (int e = 0; e < b->n; ++e)
        b->room[e] = higher(0.25 * b->cover[e].radius, steps * step * larger_end(m, b->moved, e));
}

// Box around the control points, and so around the curve.
static void hull(ancf_box* box, const ancf_cubic* cubic, double out) {
    for (int c = 0; c < 3; ++c) {
        const double p[4] = {cubic->control[0][c], cubic->control[1][c], cubic->control[2][c], cubic->control[3][c]};
        box->low[c] = lower(lower(p[0], p[1]), lower(p[2], p[3])) - out;
        box->high[c] = higher(higher(p[0], p[1]), higher(p[2], p[3])) + out;
    }
}

void ancf_boxes_around(ancf_box* box, const ancf_boxes* b, const ancf_cubic* part, int element) {
    hull(box, part, b->cover[element].radius + b->room[element] + b->ahead);
}

void ancf_boxes_of(ancf_box* box, const ancf_boxes* b, const ancf_model* m, int element) {
    ancf_cubic cubic;
    ancf_cover_cubic(&cubic, m, m->x, element);
    ancf_boxes_around(box, b, &cubic, element);
}

double ancf_boxes_room(const ancf_boxes* b, int element) { return b->room[element]; }

static bool adjacent(const ancf_model* m, int a, int b) {
    const int *p = &m->ends[2 * a], *q = &m->ends[2 * b];
    return p[0] == q[0] || p[0] == q[1] || p[1] == q[0] || p[1] == q[1];
}

// Whether two elements may touch, wherever they are.
static bool may_meet(const ancf_boxes* b, const ancf_model* m, int e, int f) {
    const ancf_cover *p = &b->cover[e], *q = &b->cover[f];
    if (!(p->mask & q->mask) || (p->structure == q->structure && !p->own)) return false;
    return !adjacent(m, e, f);
}

static bool overlap(const ancf_box* p, const ancf_box* q) {
    for (int c = 0; c < 3; ++c)
        if (p->low[c] > q->high[c] || q->low[c] > p->high[c]) return false;
    return true;
}

static bool add_meeting(ancf_boxes* b, int e, int f) {
    int room = b->room_meetings;
    if (!ancf_reserve((void**)&b->spare, &room, b->n_meetings + 1, sizeof *b->spare) ||
        !ancf_reserve((void**)&b->meeting, &b->room_meetings, b->n_meetings + 1, sizeof *b->meeting))
        return false;
    b->meeting[b->n_meetings++] = (ancf_meeting) {.first = e < f ? e : f, .second = e < f ? f : e};
    return true;
}

static int key_of(const ancf_meeting* pair, bool second) { return second ? pair->second : pair->first; }

// Sorts by counting; what is equal stays in its order.
static void sort(ancf_meeting* to, const ancf_meeting* from, const ancf_boxes* b, bool second) {
    memset(b->count, 0, (size_t)(b->n + 1) * sizeof *b->count);
    for (int i = 0; i < b->n_meetings; ++i) ++b->count[key_of(&from[i], second) + 1];
    for (int e = 0; e < b->n; ++e) b->count[e + 1] += b->count[e];
    for (int i = 0; i < b->n_meetings; ++i) to[b->count[key_of(&from[i], second)]++] = from[i];
}

static int by_start(const void* a, const void* b) {
    const struct start *p = a, *q = b;
    return p->low != q->low ? (p->low > q->low) - (p->low < q->low)
                            : (p->element > q->element) - (p->element < q->element);
}

// Whether any two elements may touch.
static bool any_may_meet(const ancf_boxes* b) {
    int structure = -1;
    for (int e = 0; e < b->n; ++e) {
        const ancf_cover* c = &b->cover[e];
        if (c->radius == 0.0) continue;
        if (c->own || (structure >= 0 && c->structure != structure)) return true;
        structure = c->structure;
    }
    return false;
}

static int order_along(ancf_boxes* b, int axis) {
    int n = 0;
    for (int e = 0; e < b->n; ++e)
        if (b->cover[e].radius > 0.0) b->order[n++] = (struct start) {b->box[e].low[axis], e};
    qsort(b->order, (size_t)n, sizeof *b->order, by_start);
    return n;
}

// Boxes that overlap along an axis by which they are ordered, less the boxes themselves.
static long crowd(const ancf_boxes* b, int axis, int n) {
    long sum = 0;
    for (int i = 0; i < n; ++i) {
        const double high = b->box[b->order[i].element].high[axis];
        int inside = i, outside = n;
        while (outside - inside > 1) {
            const int middle = inside + (outside - inside) / 2;
            if (b->order[middle].low <= high) inside = middle;
            else outside = middle;
        }
        sum += inside - i;
    }
    return sum;
}

// Orders the boxes along the axis on which fewest overlap: those of a flat net do so all along its normal.
static int order_best(ancf_boxes* b, int* axis) {
    long least = LONG_MAX;
    int n = 0, last = 0;
    for (int c = 0; c < 3; ++c) {
        n = order_along(b, last = c);
        const long pairs = crowd(b, c, n);
        if (pairs >= least) continue;
        least = pairs;
        *axis = c;
    }
    return *axis == last ? n : order_along(b, *axis);
}

static void find_meetings_of(ancf_boxes* b, const ancf_model* m, int axis, int i, int n, bool* enough) {
    const int e = b->order[i].element;
    for (int j = i + 1; j < n && b->order[j].low <= b->box[e].high[axis]; ++j) {
        const int f = b->order[j].element;
        if (overlap(&b->box[e], &b->box[f]) && may_meet(b, m, e, f) && !add_meeting(b, e, f)) *enough = false;
    }
}

int ancf_boxes_set(ancf_boxes* b, const ancf_model* m) {
    memcpy(b->reference, m->x, 3 * (size_t)m->stride * sizeof *m->x);
    for (int e = 0; e < b->n; ++e)
        if (b->cover[e].radius > 0.0) ancf_boxes_of(&b->box[e], b, m, e);
    b->n_meetings = 0;
    if (!any_may_meet(b)) return 0;
    int axis = 0;
    const int n = order_best(b, &axis);
    bool enough = true;
    for (int i = 0; i < n && enough; ++i) find_meetings_of(b, m, axis, i, n, &enough);
    if (!enough) return -1;
    if (b->n_meetings == 0) return 0;
    sort(b->spare, b->meeting, b, true);
    sort(b->meeting, b->spare, b, false);
    return b->n_meetings;
}

// What one of `threads` does for ancf_boxes_hold.
static bool part_holds(const ancf_boxes* b, const ancf_model* m, int thread, int threads) {
    const int first = ancf_share(m->n_dof, thread, threads), last = ancf_share(m->n_dof, thread + 1, threads);
    largest_ways(b->moved + first, m->x + first, b->reference + first, b->lever + first, last - first, m->stride,
                 m->stride);
    if (threads > 1) {
#pragma omp barrier
    }
    const double *node = b->moved, *start = node + m->n_nodes, *end = start + m->n_elements, *room = b->room;
    bool hold = true;
    for (int e = ancf_share(b->n, thread, threads); e < ancf_share(b->n, thread + 1, threads); ++e)
        hold &= node[m->ends[2 * e]] + start[e] <= room[e] && node[m->ends[2 * e + 1]] + end[e] <= room[e];
    return hold;
}

bool ancf_boxes_hold(const ancf_boxes* b, const ancf_model* m) {
    if (b->n < ANCF_THREADED_FROM) return part_holds(b, m, 0, 1);
    bool hold = true;
#pragma omp parallel reduction(&& : hold)
    hold = part_holds(b, m, omp_get_thread_num(), omp_get_num_threads());
    return hold;
}

const ancf_box* ancf_boxes_box(const ancf_boxes* b, int element) { return &b->box[element]; }

const ancf_meeting* ancf_boxes_meetings(const ancf_boxes* b, int* n) {
    *n = b->n_meetings;
    return b->meeting;
}
