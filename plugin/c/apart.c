#include "ancf/apart.h"
#include "internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double steps_ahead = 0.75;  // what they may do in this many steps from the middle of one is looked for,
static const double margin_ahead = 0.05; // and this part of the smaller radius besides

static const double rounding = 1e-6; // more than that of distances and ways, in radii

// A segment of one element and a segment of another.
typedef struct {
    int piece[2];
    bool learned;   // the axis is that of a place found on the curves
    double axis[3]; // from the second to the first; 0: none known
    double wake;    // they are apart while their ways in all, together, are shorter than this [m]
} window;

typedef struct {
    int first, second, begin, end; // its windows
    double wake;                   // the least of theirs
} pair;

typedef struct {
    int n_pairs, room_pairs, n_windows, room_windows;
    pair* pair;     // sorted by first, then second
    window* window; // of a pair sorted by pieces
} list;

struct ancf_apart {
    const ancf_cover* cover;
    int n;
    const ancf_motion* motion;
    int* start;        // (n) of an element's first piece
    double* margin;    // (n) half of what is looked for at no speed [m]
    double* claim;     // (n) what has gone and what is looked for together [m]
    long* looked;      // (n) number of the step in which its cubic and pieces were made
    ancf_cubic* cubic; // (n)
    ancf_box* box;     // (all segments)
    long looks;
    list now, last; // last: those of before, whose room the next ones take
};

static double lower(double a, double b) { return a < b ? a : b; }

static double higher(double a, double b) { return a > b ? a : b; }

static double clamp(double x, double low, double high) { return x < low ? low : x > high ? high : x; }

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

ancf_error ancf_apart_create(ancf_apart** apart, const ancf_model* m, const ancf_cover* cover,
                             const ancf_motion* motion) {
    ancf_apart* a = *apart = calloc(1, sizeof *a);
    if (!a) return ANCF_E_MEMORY;
    const size_t n = (size_t)m->n_elements;
    size_t pieces = 0;
    for (size_t e = 0; e < n; ++e) pieces += (size_t)cover[e].segments;
    a->cover = cover;
    a->motion = motion;
    a->n = m->n_elements;
    a->start = calloc(n, sizeof *a->start);
    a->margin = calloc(n, sizeof *a->margin);
    a->claim = calloc(n, sizeof *a->claim);
    a->looked = calloc(n, sizeof *a->looked);
    a->cubic = calloc(n, sizeof *a->cubic);
    a->box = calloc(pieces, sizeof *a->box);
    if (!a->start || !a->margin || !a->claim || !a->looked || !a->cubic || !a->box) {
        ancf_apart_destroy(a);
        *apart = NULL;
        return ANCF_E_MEMORY;
    }
    for (int e = 0, start = 0; e < a->n; ++e) {
        a->start[e] = start;
        start += cover[e].segments;
        a->margin[e] = 0.5 * margin_ahead * cover[e].radius;
    }
    return ANCF_OK;
}

void ancf_apart_destroy(ancf_apart* a) {
    if (!a) return;
    free(a->start);
    free(a->margin);
    free(a->claim);
    free(a->looked);
    free(a->cubic);
    free(a->box);
    free(a->now.pair);
    free(a->now.window);
    free(a->last.pair);
    free(a->last.window);
    free(a);
}

// ---------------------------------------------------------------- pieces

// Least and largest of what a part of an element's cubic is along an axis, at most: those of its control points.
static void span(double range[2], const double axis[3], const ancf_cubic* whole, int i, int n) {
    const double a = dot(axis, whole->control[0]), b = dot(axis, whole->control[1]), c = dot(axis, whole->control[2]),
                 d = dot(axis, whole->control[3]), k1 = 3.0 * (b - a), k2 = 3.0 * (c - 2.0 * b + a),
                 k3 = d - a - 3.0 * (c - b), step = 1.0 / n, start = i * step, end = start + step;
    const double first = a + start * (k1 + start * (k2 + start * k3)), last = a + end * (k1 + end * (k2 + end * k3)),
                 after = first + step / 3.0 * (k1 + start * (2.0 * k2 + start * 3.0 * k3)),
                 before = last - step / 3.0 * (k1 + end * (2.0 * k2 + end * 3.0 * k3));
    range[0] = lower(lower(first, after), lower(before, last));
    range[1] = higher(higher(first, after), higher(before, last));
}

double ancf_cubic_gap(const double axis[3], const ancf_cubic* first, int i, int n, const ancf_cubic* second, int j,
                      int n2) {
    double a[2], b[2];
    span(a, axis, first, i, n);
    span(b, axis, second, j, n2);
    return a[0] - b[1];
}

// From where the chord of the second is nearest to where that of the first is [Ericson 2005]. False: no direction.
static bool between_chords(double axis[3], const ancf_cubic* first, int i, int n, const ancf_cubic* second, int j,
                           int n2) {
    double a[3], b[3], start[3], way[3];
    ancf_cubic_at(start, first, (double)i / n);
    ancf_cubic_at(a, first, (double)(i + 1) / n);
    ancf_cubic_at(way, second, (double)j / n2);
    ancf_cubic_at(b, second, (double)(j + 1) / n2);
    for (int c = 0; c < 3; ++c) {
        a[c] -= start[c];
        b[c] -= way[c];
        way[c] = start[c] - way[c];
    }
    const double aa = dot(a, a), bb = dot(b, b), ab = dot(a, b), aw = dot(a, way), bw = dot(b, way),
                 det = aa * bb - ab * ab;
    double s = det > 1e-12 * aa * bb ? clamp((ab * bw - aw * bb) / det, 0.0, 1.0) : 0.5;
    double t = bb > 0.0 ? (ab * s + bw) / bb : 0.0;
    if (!(t >= 0.0 && t <= 1.0)) {
        t = clamp(t, 0.0, 1.0);
        s = aa > 0.0 ? clamp((ab * t - aw) / aa, 0.0, 1.0) : 0.0;
    }
    for (int c = 0; c < 3; ++c) way[c] += s * a[c] - t * b[c];
    const double length = sqrt(dot(way, way));
    for (int c = 0; c < 3; ++c) axis[c] = way[c] / length;
    return length > 0.0;
}

// ---------------------------------------------------------------- windows

static bool add_pair(list* l, const pair* p) {
    const bool enough = ancf_reserve((void**)&l->pair, &l->room_pairs, l->n_pairs + 1, sizeof *p);
    if (enough) l->pair[l->n_pairs++] = *p;
    return enough;
}

static bool add_window(list* l, const window* w) {
    const bool enough = ancf_reserve((void**)&l->window, &l->room_windows, l->n_windows + 1, sizeof *w);
    if (enough) l->window[l->n_windows++] = *w;
    return enough;
}

static bool overlap(const ancf_box* p, const ancf_box* q) {
    for (int c = 0; c < 3; ++c)
        if (p->low[c] > q->high[c] || q->low[c] > p->high[c]) return false;
    return true;
}

// Boxes of an element's pieces as they are now.
static void box_pieces(ancf_apart* a, const ancf_boxes* boxes, const ancf_model* m, int e) {
    if (a->looked[e] == a->looks) return;
    a->looked[e] = a->looks;
    const int n = a->cover[e].segments;
    const double third = 1.0 / (3.0 * n);
    ancf_cubic whole, piece;
    double(*p)[3] = piece.control, slope[3];
    ancf_cover_cubic(&whole, m, m->x, e);
    ancf_cubic_at(p[3], &whole, 0.0);
    ancf_cubic_slope(slope, &whole, 0.0);
    for (int i = 0; i < n; ++i) {
        memcpy(p[0], p[3], sizeof p[0]);
        for (int c = 0; c < 3; ++c) p[1][c] = p[0][c] + third * slope[c];
        ancf_cubic_at(p[3], &whole, (i + 1.0) / n);
        ancf_cubic_slope(slope, &whole, (i + 1.0) / n);
        for (int c = 0; c < 3; ++c) p[2][c] = p[3][c] - third * slope[c];
        ancf_boxes_around(&a->box[a->start[e] + i], boxes, &piece, e);
    }
}

// The pair as it was, from number *k on; NULL: it was none.
static const pair* find_last(const list* last, int* k, const ancf_meeting* of) {
    for (; *k < last->n_pairs; ++*k) {
        const pair* p = &last->pair[*k];
        if (p->first > of->first || (p->first == of->first && p->second > of->second)) return NULL;
        if (p->first == of->first && p->second == of->second) return p;
    }
    return NULL;
}

// What was known of windows, from number *k on, still holds for those that are windows again.
static void inherit(window* w, const ancf_apart* a, const pair* was, int* k) {
    for (; *k < was->end; ++*k) {
        const window* old = &a->last.window[*k];
        const int order = old->piece[0] != w->piece[0] ? old->piece[0] - w->piece[0] : old->piece[1] - w->piece[1];
        if (order > 0) return;
        if (order < 0) continue;
        *w = *old;
        return;
    }
}

static bool add_windows(ancf_apart* a, const ancf_boxes* boxes, const ancf_meeting* of, const pair* was) {
    pair p = {.first = of->first, .second = of->second, .begin = a->now.n_windows, .wake = INFINITY};
    const ancf_box *first = &a->box[a->start[p.first]], *second = &a->box[a->start[p.second]],
                   *whole = ancf_boxes_box(boxes, p.second);
    int old = was ? was->begin : 0;
    for (int i = 0; i < a->cover[p.first].segments; ++i) {
        if (!overlap(&first[i], whole)) continue;
        for (int j = 0; j < a->cover[p.second].segments; ++j) {
            if (!overlap(&first[i], &second[j])) continue;
            window w = {.piece = {i, j}, .wake = -INFINITY};
            if (was) inherit(&w, a, was, &old);
            p.wake = lower(p.wake, w.wake);
            if (!add_window(&a->now, &w)) return false;
        }
    }
    p.end = a->now.n_windows;
    return p.begin == p.end || add_pair(&a->now, &p);
}

int ancf_apart_set(ancf_apart* a, const ancf_boxes* boxes, const ancf_model* m) {
    int n, old = 0;
    const ancf_meeting* meeting = ancf_boxes_meetings(boxes, &n);
    const list last = a->now;
    a->now = a->last;
    a->last = last;
    a->now.n_pairs = a->now.n_windows = 0;
    ++a->looks;
    for (int k = 0; k < n; ++k) {
        box_pieces(a, boxes, m, meeting[k].first);
        box_pieces(a, boxes, m, meeting[k].second);
        if (!add_windows(a, boxes, &meeting[k], find_last(&a->last, &old, &meeting[k]))) return -1;
    }
    return a->now.n_windows;
}

// ---------------------------------------------------------------- asked

double ancf_apart_reach(const ancf_cover* p, const ancf_cover* q, double step, double speed) {
    return steps_ahead * step * speed + margin_ahead * lower(p->radius, q->radius);
}

static void look(ancf_apart* a, const ancf_model* m, int e) {
    if (a->looked[e] != a->looks) ancf_cover_cubic(&a->cubic[e], m, a->motion->place, e);
    a->looked[e] = a->looks;
}

// Whether the pieces of a window are farther apart than `reach`; how far they are.
static bool parted(window* w, double* gap, const ancf_near* near, const ancf_apart* a) {
    const int i = w->piece[0], j = w->piece[1], n = a->cover[near->first].segments,
              n2 = a->cover[near->second].segments;
    const ancf_cubic *p = &a->cubic[near->first], *q = &a->cubic[near->second];
    const double thick = a->cover[near->first].radius + a->cover[near->second].radius, less = (1.0 + rounding) * thick;
    double axis[3];
    *gap = ancf_cubic_gap(w->axis, p, i, n, q, j, n2) - less;
    if (*gap < near->reach + thick && !w->learned && between_chords(axis, p, i, n, q, j, n2)) {
        const double other = ancf_cubic_gap(axis, p, i, n, q, j, n2) - less;
        if (other > *gap) {
            memcpy(w->axis, axis, sizeof axis);
            *gap = other;
        }
    }
    w->learned = w->learned && *gap > near->reach;
    return *gap > near->reach;
}

// Looks at the windows of a pair that do not rest.
static void wake(ancf_near* near, ancf_apart* a, const ancf_model* m, pair* p) {
    const int e = p->first, f = p->second;
    const double gone = a->motion->gone[e] + a->motion->gone[f], claim = a->claim[e] + a->claim[f];
    look(a, m, e);
    look(a, m, f);
    near->first = e;
    near->second = f;
    near->segments = 0;
    near->reach =
        ancf_apart_reach(&a->cover[e], &a->cover[f], a->motion->step, a->motion->speed[e] + a->motion->speed[f]);
    p->wake = INFINITY;
    for (int k = p->begin; k < p->end; ++k) {
        window* w = &a->now.window[k];
        double gap;
        if (!(w->wake > claim)) {
            if (!parted(w, &gap, near, a)) near->segments |= (uint64_t)1 << w->piece[0];
            w->wake = gap + gone;
        }
        p->wake = lower(p->wake, w->wake);
    }
}

static void start(ancf_apart* a) {
    const ancf_motion* motion = a->motion;
    ++a->looks;
    for (int e = 0; e < a->n; ++e)
        a->claim[e] = motion->gone[e] + steps_ahead * motion->step * motion->speed[e] + a->margin[e];
}

bool ancf_apart_next(ancf_near* near, ancf_apart* a, const ancf_model* m) {
    const double* claim = a->claim;
    if (near->next == 0 && a->now.n_pairs > 0) start(a);
    for (int k = near->next; k < a->now.n_pairs; ++k) {
        pair* p = &a->now.pair[k];
        if (p->wake > claim[p->first] + claim[p->second]) continue;
        wake(near, a, m, p);
        if (near->segments == 0) continue;
        near->next = k + 1;
        ancf_cover_ahead(&near->cubic[0], m, p->first, 0.5 * a->motion->step);
        ancf_cover_ahead(&near->cubic[1], m, p->second, 0.5 * a->motion->step);
        return true;
    }
    return false;
}

void ancf_apart_learn(ancf_apart* a, const ancf_near* near, const ancf_nearest_pair* found, int n) {
    const pair* p = &a->now.pair[near->next - 1];
    const int parts = a->cover[near->second].segments;
    int i = 0;
    for (int k = p->begin; k < p->end; ++k) {
        window* w = &a->now.window[k];
        while (i < n && found[i].segment < w->piece[0]) ++i;
        if (i == n) return;
        if (found[i].segment != w->piece[0]) continue;
        const int part = (int)(found[i].xi[1] * parts);
        if (w->piece[1] != (part < parts ? part : parts - 1)) continue;
        memcpy(w->axis, found[i].normal, sizeof w->axis);
        w->learned = true;
    }
}
