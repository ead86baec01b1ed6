#include "ancf/cross.h"

#include <math.h>
#include <string.h>

enum { SEGMENTS_MAX = 64 }; // of an element

// So many times their thickness beyond what is looked for in a step, pairs are told apart.
static const double beyond = 0.5;

// Along one run, places nearer than this many radii never touch: however strongly a cable bends, it does not kick.
static const double neighbourhood = 4.0;

static const double steps_ahead = 0.75;  // what they may do in this many steps from the middle of one is looked for,
static const double margin_ahead = 0.05; // and this part of the smaller radius besides

bool ancf_cross_neighbours(const ancf_cover* p, double xi, double length1, const ancf_cover* q, double eta,
                           double length2) {
    if (p->run != q->run) return false;
    double along = fabs(p->arc + xi * length1 - q->arc - eta * length2);
    if (p->closed > 0.0) along = fmin(along, p->closed - along);
    return along < neighbourhood * (p->radius > q->radius ? p->radius : q->radius);
}

static int compare(const ancf_memory* m, const int key[3]) {
    if (m->first != key[0]) return m->first < key[0] ? -1 : 1;
    if (m->second != key[1]) return m->second < key[1] ? -1 : 1;
    return (m->segment > key[2]) - (m->segment < key[2]);
}

// Walks on in the sorted memory to a contact's own entry.
static void recall(double friction[3], const int key[3], const ancf_memory** last, const ancf_memory* end) {
    while (*last < end && compare(*last, key) < 0) ++*last;
    const bool found = *last < end && compare(*last, key) == 0;
    for (int i = 0; i < 3; i++) friction[i] = found ? (*last)->friction[i] : 0.0;
}

// How near a pair has to be to be looked at in a step [m].
static double reach_of(const ancf_cover* p, const ancf_cover* q, double step, double speed) {
    return steps_ahead * step * speed + margin_ahead * (p->radius < q->radius ? p->radius : q->radius);
}

// Distance of two boxes along the axis on which they are farthest apart [m], < 0 if they overlap.
static double between(const ancf_box* p, const ancf_box* q) {
    double most = -INFINITY;
    for (int c = 0; c < 3; ++c) {
        const double a = p->low[c] - q->high[c], b = q->low[c] - p->high[c], gap = a > b ? a : b;
        most = gap > most ? gap : most;
    }
    return most;
}

// Places of a pair nearer than `reach`; remembers how near it was. What is near but not so near is looked for as well,
// so that the pair can rest until it may have come nearer.
static int find(ancf_nearest_pair* found, ancf_meeting* pair, double reach, ancf_boxes* boxes, const ancf_cover* p,
                const ancf_cover* q, const ancf_model* m, double ahead) {
    const ancf_look *a = ancf_boxes_look(boxes, m, pair->first, ahead),
                    *b = ancf_boxes_look(boxes, m, pair->second, ahead);
    const double thick = p->radius + q->radius, far = reach + beyond * thick;
    pair->gap = between(&a->box, &b->box);
    if (pair->gap > far) return 0;
    pair->gap = ancf_cubic_clearance(&a->cubic, &b->cubic) - thick;
    if (pair->gap > far) return 0;
    const int n = ancf_nearest_cubic(found, &a->cubic, p->segments, p->radius, &b->cubic, q->radius, far);
    int near = 0;
    pair->gap = far;
    for (int i = 0; i < n; ++i) {
        pair->gap = found[i].gap < pair->gap ? found[i].gap : pair->gap;
        if (found[i].gap < reach) found[near++] = found[i];
    }
    return near;
}

// A place's contact; left out where it does not come near enough at the velocities of now.
static int add_contact(ancf_table* table, const ancf_nearest_pair* at, const ancf_meeting* pair,
                       const ancf_cover* cover, const ancf_model* m, const ancf_laws* law, const ancf_memory** last,
                       const ancf_memory* end, double step) {
    const int e[2] = {pair->first, pair->second};
    double v[2][3], opening = 0.0;
    for (int s = 0; s < 2; ++s) ancf_model_at(v[s], m, m->v, e[s], at->xi[s]);
    for (int i = 0; i < 3; i++) opening += at->normal[i] * (v[0][i] - v[1][i]);
    if (at->gap > reach_of(&cover[e[0]], &cover[e[1]], step, opening < 0.0 ? -opening : 0.0)) return 0;
    ancf_contact c = {.key = {e[0], e[1], at->segment}, .law = law->normal, .rub = law->rub};
    c.gap = at->gap - 0.5 * step * opening; // from the middle of the step to its start
    int (*add_place)(ancf_table*, const ancf_model*, int, double) =
        law->rub.kind == ANCF_FRICTION_NONE ? ancf_table_add_place : ancf_table_add_slope;
    double x[2][3];
    for (int s = 0; s < 2; ++s) {
        c.side[s] = (ancf_side) {.place = add_place(table, m, e[s], at->xi[s]), .body = -1};
        if (c.side[s].place < 0) return -1;
        c.radius[s] = cover[e[s]].radius;
        ancf_model_at(x[s], m, m->x, e[s], at->xi[s]);
    }
    for (int i = 0; i < 3; i++) c.side[1].arm[i] = x[0][i] - x[1][i];
    memcpy(c.normal, at->normal, sizeof c.normal);
    recall(c.friction, c.key, last, end);
    return ancf_table_add_contact(table, &c) < 0 ? -1 : 1;
}

int ancf_cross_add(ancf_table* table, ancf_boxes* boxes, const ancf_cover* cover, const ancf_model* m,
                   const ancf_laws* laws, int kinds, double step, const ancf_memory* last, int n_last) {
    ancf_nearest_pair found[SEGMENTS_MAX];
    const ancf_memory* end = last + n_last;
    int n, added = 0;
    ancf_meeting* meeting = ancf_boxes_meetings(boxes, &n);
    if (n == 0) return 0;
    ancf_boxes_follow(boxes, m);
    for (int k = 0; k < n; ++k) {
        ancf_meeting* pair = &meeting[k];
        const int e = pair->first, f = pair->second;
        const ancf_cover *p = &cover[e], *q = &cover[f];
        const double reach = reach_of(p, q, step, ancf_boxes_speed(boxes, m, e) + ancf_boxes_speed(boxes, m, f));
        const double strayed = ancf_boxes_strayed(boxes, m, e) + ancf_boxes_strayed(boxes, m, f);
        if (pair->gap - (strayed + pair->strayed) > reach) continue;
        pair->strayed = strayed;
        const int near = find(found, pair, reach, boxes, p, q, m, 0.5 * step);
        for (int i = 0; i < near; ++i) {
            if (ancf_cross_neighbours(p, found[i].xi[0], m->element[e].length, q, found[i].xi[1], m->element[f].length))
                continue;
            const int one =
                add_contact(table, &found[i], pair, cover, m, &laws[p->kind * kinds + q->kind], &last, end, step);
            if (one < 0) return -1;
            added += one;
        }
    }
    return added;
}

int ancf_cross_keep(ancf_memory* memory, ancf_table* table, int begin, int end) {
    int n = 0;
    for (int i = begin; i < end; ++i) {
        const ancf_contact* c = ancf_table_contact(table, i);
        if (c->friction[0] == 0.0 && c->friction[1] == 0.0 && c->friction[2] == 0.0) continue;
        memory[n] = (ancf_memory) {.first = c->key[0], .second = c->key[1], .segment = c->key[2]};
        memcpy(memory[n++].friction, c->friction, sizeof c->friction);
    }
    return n;
}
