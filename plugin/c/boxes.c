#include "ancf/boxes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static double lower(double a, double b) { return a < b ? a : b; }

static double higher(double a, double b) { return a > b ? a : b; }

struct ancf_boxes {
    const ancf_cover* cover;
    int n;
    double ahead;
    double* room;      // (n) [m]
    double* reference; // (3 x stride) state in which the boxes were set
    double* moved;     // (n_dof) how far nodes, and slopes over a third of their elements, are from it
    ancf_box* box;     // (n)
    struct start {
        double low;
        int element;
    } * order;       // (n) by lower ends along x
    ancf_look* look; // (n)
    int n_looked;    // elements that may meet another
    int* looked;     // (n) which
    bool* listed;    // (n)
    bool fresh;      // the boxes were set since the last look
    double mean[3];  // of the nodes, then [m]
    int n_meetings, room_meetings;
    ancf_meeting* meeting;
};

ancf_error ancf_boxes_create(ancf_boxes** boxes, const ancf_model* m, const ancf_cover* cover) {
    ancf_boxes* b = *boxes = calloc(1, sizeof *b);
    if (!b) return ANCF_E_MEMORY;
    const size_t n = (size_t)m->n_elements;
    b->cover = cover;
    b->n = m->n_elements;
    b->room = calloc(n, sizeof *b->room);
    b->reference = calloc(3 * (size_t)m->stride, sizeof *b->reference);
    b->moved = calloc((size_t)m->n_dof, sizeof *b->moved);
    b->box = calloc(n, sizeof *b->box);
    b->order = calloc(n, sizeof *b->order);
    b->look = calloc(n, sizeof *b->look);
    b->looked = calloc(n, sizeof *b->looked);
    b->listed = calloc(n, sizeof *b->listed);
    if (!b->room || !b->reference || !b->moved || !b->box || !b->order || !b->look || !b->looked || !b->listed) {
        ancf_boxes_destroy(b);
        *boxes = NULL;
        return ANCF_E_MEMORY;
    }
    return ANCF_OK;
}

void ancf_boxes_destroy(ancf_boxes* b) {
    if (!b) return;
    free(b->room);
    free(b->reference);
    free(b->moved);
    free(b->box);
    free(b->order);
    free(b->look);
    free(b->looked);
    free(b->listed);
    free(b->meeting);
    free(b);
}

// By how much an unknown moves the curve: a slope moves its control point by a third of the length.
static double lever(const ancf_model* m, int dof) {
    return dof < m->n_nodes ? 1.0 : m->element[(dof - m->n_nodes) % m->n_elements].length / 3.0;
}

// Largest component of a difference of fields at an unknown, as a way of the curve.
static double way(const ancf_model* m, const double* a, const double* b, int dof) {
    double largest = 0.0;
    for (int c = 0; c < 3; ++c) {
        const int i = c * m->stride + dof;
        largest = higher(largest, fabs(a[i] - (b ? b[i] : 0.0)));
    }
    return largest * lever(m, dof);
}

// A control point moves by its node's way, and its slope's besides.
static double element_way(const ancf_model* m, const double* a, const double* b, int e) {
    int dof[4];
    ancf_model_dofs(dof, m, e);
    const double start = way(m, a, b, dof[0]), end = way(m, a, b, dof[2]);
    if (m->element[e].kind & ANCF_SPRING) return higher(start, end);
    return higher(start + way(m, a, b, dof[1]), end + way(m, a, b, dof[3]));
}

double ancf_boxes_fastest(const ancf_model* m) {
    double square = 0.0;
    for (int e = 0; e < m->n_elements; ++e) {
        int dof[4];
        ancf_model_dofs(dof, m, e);
        for (int k = 0; k < 4; k += 2) {
            double sum = 0.0;
            for (int c = 0; c < 3; ++c) {
                const double* v = m->v + c * m->stride;
                const double slope =
                    m->element[e].kind & ANCF_SPRING ? 0.0 : lever(m, dof[k + 1]) * fabs(v[dof[k + 1]]);
                const double total = fabs(v[dof[k]]) + slope;
                sum += total * total;
            }
            square = higher(square, sum);
        }
    }
    return sqrt(square);
}

void ancf_boxes_plan(ancf_boxes* b, const ancf_model* m, double step, int steps, double ahead) {
    b->ahead = ahead;
    for (int e = 0; e < b->n; ++e)
        b->room[e] = higher(0.25 * b->cover[e].radius, steps * step * element_way(m, m->v, NULL, e));
}

// Box around the control points, and so around the curve.
static void hull(ancf_box* box, const ancf_cubic* cubic, double out) {
    for (int c = 0; c < 3; ++c) {
        const double p[4] = {cubic->control[0][c], cubic->control[1][c], cubic->control[2][c], cubic->control[3][c]};
        box->low[c] = lower(lower(p[0], p[1]), lower(p[2], p[3])) - out;
        box->high[c] = higher(higher(p[0], p[1]), higher(p[2], p[3])) + out;
    }
}

void ancf_boxes_of(ancf_box* box, const ancf_boxes* b, const ancf_model* m, int element) {
    ancf_cubic cubic;
    ancf_cover_cubic(&cubic, m, m->x, element);
    hull(box, &cubic, b->cover[element].radius + b->room[element] + b->ahead);
}

// Control points of the rates of an element, as those of the element itself.
static void rates(double rate[4][3], const ancf_model* m, int element) {
    ancf_cubic cubic;
    ancf_cover_cubic(&cubic, m, m->v, element);
    memcpy(rate, cubic.control, sizeof cubic.control);
}

static double largest_norm(double a[4][3], const double mean[3]) {
    double square = 0.0;
    for (int k = 0; k < 4; ++k) {
        double sum = 0.0;
        for (int c = 0; c < 3; ++c) sum += (a[k][c] - mean[c]) * (a[k][c] - mean[c]);
        square = higher(square, sum);
    }
    return sqrt(square);
}

static void mean_of_nodes(double mean[3], const ancf_model* m, const double* field) {
    for (int c = 0; c < 3; ++c) {
        double sum = 0.0;
        for (int i = 0; i < m->n_nodes; ++i) sum += field[c * m->stride + i];
        mean[c] = sum / m->n_nodes;
    }
}

const ancf_look* ancf_boxes_look(ancf_boxes* b, const ancf_model* m, double ahead) {
    double drift[3], place[3], moved[3];
    mean_of_nodes(drift, m, m->v);
    mean_of_nodes(place, m, m->x);
    for (int c = 0; c < 3; ++c) {
        place[c] += ahead * drift[c];
        moved[c] = place[c] - b->mean[c];
        b->mean[c] = place[c];
    }
    for (int i = 0; i < b->n_looked; ++i) {
        const int e = b->looked[i];
        ancf_look* look = &b->look[e];
        double rate[4][3];
        const ancf_cubic before = look->cubic;
        ancf_cover_cubic(&look->cubic, m, m->x, e);
        rates(rate, m, e);
        for (int k = 0; k < 4; ++k)
            for (int c = 0; c < 3; ++c) look->cubic.control[k][c] += ahead * rate[k][c];
        hull(&look->box, &look->cubic, b->cover[e].radius);
        look->speed = largest_norm(rate, drift);
        for (int k = 0; k < 4; ++k)
            for (int c = 0; c < 3; ++c) rate[k][c] = look->cubic.control[k][c] - before.control[k][c];
        look->travel = b->fresh ? 0.0 : look->travel + largest_norm(rate, moved);
    }
    b->fresh = false;
    return b->look;
}

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
    if (b->n_meetings == b->room_meetings) {
        const int room = b->room_meetings ? 2 * b->room_meetings : 64;
        ancf_meeting* grown = realloc(b->meeting, (size_t)room * sizeof *grown);
        if (!grown) return false;
        b->meeting = grown;
        b->room_meetings = room;
    }
    b->meeting[b->n_meetings++] = (ancf_meeting) {.first = e < f ? e : f, .second = e < f ? f : e, .gap = -INFINITY};
    return true;
}

static int by_elements(const void* a, const void* b) {
    const ancf_meeting *p = a, *q = b;
    return p->first != q->first ? (p->first > q->first) - (p->first < q->first)
                                : (p->second > q->second) - (p->second < q->second);
}

static int by_start(const void* a, const void* b) {
    const struct start *p = a, *q = b;
    return p->low != q->low ? (p->low > q->low) - (p->low < q->low)
                            : (p->element > q->element) - (p->element < q->element);
}

static void list_looked(ancf_boxes* b) {
    memset(b->listed, 0, (size_t)b->n * sizeof *b->listed);
    for (int i = 0; i < b->n_meetings; ++i) b->listed[b->meeting[i].first] = b->listed[b->meeting[i].second] = true;
    b->n_looked = 0;
    for (int e = 0; e < b->n; ++e)
        if (b->listed[e]) b->looked[b->n_looked++] = e;
}

int ancf_boxes_set(ancf_boxes* b, const ancf_model* m) {
    memcpy(b->reference, m->x, 3 * (size_t)m->stride * sizeof *m->x);
    int n = 0;
    for (int e = 0; e < b->n; ++e) {
        if (b->cover[e].radius == 0.0) continue;
        ancf_boxes_of(&b->box[e], b, m, e);
        b->order[n++] = (struct start) {b->box[e].low[0], e};
    }
    qsort(b->order, (size_t)n, sizeof *b->order, by_start);
    b->n_meetings = 0;
    b->fresh = true;
    for (int i = 0; i < n; ++i) {
        const int e = b->order[i].element;
        for (int j = i + 1; j < n && b->order[j].low <= b->box[e].high[0]; ++j) {
            const int f = b->order[j].element;
            if (overlap(&b->box[e], &b->box[f]) && may_meet(b, m, e, f) && !add_meeting(b, e, f)) return -1;
        }
    }
    qsort(b->meeting, (size_t)b->n_meetings, sizeof *b->meeting, by_elements);
    list_looked(b);
    return b->n_meetings;
}

bool ancf_boxes_hold(const ancf_boxes* b, const ancf_model* m) {
    for (int i = 0; i < m->n_dof; ++i) b->moved[i] = way(m, m->x, b->reference, i);
    const double *start = b->moved + m->n_nodes, *end = start + m->n_elements;
    bool hold = true;
    for (int e = 0; e < b->n; ++e) {
        const double *node = b->moved, *room = b->room;
        hold = hold && node[m->ends[2 * e]] + start[e] <= room[e] && node[m->ends[2 * e + 1]] + end[e] <= room[e];
    }
    return hold;
}

ancf_meeting* ancf_boxes_meetings(const ancf_boxes* b, int* n) {
    *n = b->n_meetings;
    return b->meeting;
}
