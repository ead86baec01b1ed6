#include "ancf/cross.h"

#include <math.h>
#include <string.h>

enum { SEGMENTS_MAX = 64 }; // of an element

// Along one run, places nearer than this many radii never touch: however strongly a cable bends, it does not kick.
static const double neighbourhood = 4.0;

static const double steps_ahead = 1.5;   // what they may do in this many steps is looked for,
static const double margin_ahead = 0.02; // and this part of the smaller radius besides

static const double beyond = 4.0; // so many radii: pairs farther apart are left alone until they have travelled that

static bool neighbours(const ancf_cover* p, double xi, double length1, const ancf_cover* q, double eta,
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

static bool apart(const ancf_box* p, const ancf_box* q, double reach) {
    for (int c = 0; c < 3; ++c)
        if (p->low[c] > q->high[c] + reach || q->low[c] > p->high[c] + reach) return true;
    return false;
}

// Places of a pair nearer than `reach`. A pair is looked at again only when it can have come so near since.
static int find(ancf_nearest_pair* found, ancf_meeting* pair, const ancf_look* p, const ancf_look* q,
                const ancf_cover* cover_p, const ancf_cover* cover_q, double reach) {
    const double travel = p->travel + q->travel, radius = cover_p->radius + cover_q->radius;
    if (pair->gap - (travel - pair->travel) > reach) return 0;
    const double far = reach + beyond * radius;
    const int n = apart(&p->box, &q->box, far) ? 0
                                               : ancf_nearest_cubic(found, &p->cubic, cover_p->segments,
                                                                    cover_p->radius, &q->cubic, cover_q->radius, far);
    int near = 0;
    pair->gap = far;
    pair->travel = travel;
    for (int i = 0; i < n; ++i) {
        pair->gap = fmin(pair->gap, found[i].gap);
        if (found[i].gap < reach) found[near++] = found[i];
    }
    return near;
}

// A place's contact: the two sides, and how stiff it is where segments or elements share it.
static bool add_contact(ancf_table* table, const ancf_nearest_pair* at, const ancf_meeting* pair,
                        const ancf_cover* cover, const ancf_model* m, const ancf_laws* law, const ancf_memory** last,
                        const ancf_memory* end, double ahead) {
    const int e[2] = {pair->first, pair->second};
    ancf_contact c = {.key = {e[0], e[1], at->segment}, .gap = at->gap, .law = law->normal, .rub = law->rub};
    ancf_cover whole = cover[e[1]];
    whole.segments = 1;
    c.law.stiffness *= ancf_cover_share(&cover[e[0]], at->segment, at->xi[0]) * ancf_cover_share(&whole, 0, at->xi[1]);
    for (int s = 0; s < 2; ++s) {
        c.side[s] = (ancf_side) {.place = ancf_table_add_place(table, m, e[s], at->xi[s]), .body = -1};
        if (c.side[s].place < 0) return false;
    }
    memcpy(c.normal, at->normal, sizeof c.normal);
    double v[2][3];
    for (int s = 0; s < 2; ++s) ancf_model_at(v[s], m, m->v, e[s], at->xi[s]);
    for (int i = 0; i < 3; i++) c.gap -= ahead * c.normal[i] * (v[0][i] - v[1][i]); // from the middle to the start
    recall(c.friction, c.key, last, end);
    return ancf_table_add_contact(table, &c) >= 0;
}

int ancf_cross_add(ancf_table* table, ancf_boxes* boxes, const ancf_cover* cover, const ancf_model* m,
                   const ancf_laws* laws, int kinds, double step, const ancf_memory* last, int n_last) {
    ancf_nearest_pair found[SEGMENTS_MAX];
    const ancf_memory* end = last + n_last;
    int n, added = 0;
    ancf_meeting* meeting = ancf_boxes_meetings(boxes, &n);
    if (n == 0) return 0;
    const ancf_look* look = ancf_boxes_look(boxes, m, 0.5 * step);
    for (int k = 0; k < n; ++k) {
        const int e = meeting[k].first, f = meeting[k].second;
        const ancf_cover *p = &cover[e], *q = &cover[f];
        const double reach = steps_ahead * step * (look[e].speed + look[f].speed) +
                             margin_ahead * (p->radius < q->radius ? p->radius : q->radius);
        const int near = find(found, &meeting[k], &look[e], &look[f], p, q, reach);
        for (int i = 0; i < near; ++i) {
            if (neighbours(p, found[i].xi[0], m->element[e].length, q, found[i].xi[1], m->element[f].length)) continue;
            if (!add_contact(table, &found[i], &meeting[k], cover, m, &laws[p->kind * kinds + q->kind], &last, end,
                             0.5 * step))
                return -1;
            ++added;
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
