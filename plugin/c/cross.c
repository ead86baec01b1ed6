#include "ancf/cross.h"

#include <math.h>
#include <string.h>

enum { SEGMENTS_MAX = 64 }; // of an element

// So many times their thickness beyond what is looked for, curves are searched with the same care.
static const double beyond = 0.5;

// Along one run, places nearer than this many radii never touch: however strongly a cable bends, it does not kick.
static const double neighbourhood = 4.0;

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
static void recall(ancf_contact* c, const ancf_model* m, const ancf_memory** last, const ancf_memory* end) {
    while (*last < end && compare(*last, c->key) < 0) ++*last;
    if (*last == end || compare(*last, c->key) != 0) return;
    const ancf_memory* own = *last;
    double a[2][3];
    for (int s = 0; s < 2; ++s) ancf_model_at(a[s], m, m->a, c->key[s], own->xi[s]);
    for (int i = 0; i < 3; i++) {
        c->friction[i] = own->friction[i];
        a[0][i] -= a[1][i];
    }
    c->owed = ancf_owed(own->owed, own->late, a[0]);
}

// A place's contact.
static int add_contact(ancf_table* table, const ancf_nearest_pair* at, const ancf_near* pair, const ancf_cover* cover,
                       const ancf_model* m, const ancf_laws* law, const ancf_memory** last, const ancf_memory* end,
                       double step) {
    const int e[2] = {pair->first, pair->second};
    double v[2][3], opening = 0.0;
    for (int s = 0; s < 2; ++s) ancf_model_at(v[s], m, m->v, e[s], at->xi[s]);
    for (int i = 0; i < 3; i++) opening += at->normal[i] * (v[0][i] - v[1][i]);
    ancf_contact c = {.key = {e[0], e[1], at->segment}, .law = law->normal, .rub = law->rub};
    c.gap = at->gap - 0.5 * step * opening; // from the middle of the step to its start
    const bool rubs = law->rub.kind != ANCF_FRICTION_NONE;
    double x[2][3];
    for (int s = 0; s < 2; ++s) {
        const int place =
            rubs ? ancf_table_add_slope(table, m, e[s], at->xi[s]) : ancf_table_add_place(table, m, e[s], at->xi[s]);
        if (place < 0) return -1;
        c.side[s] = (ancf_side) {.place = place, .body = -1};
        c.radius[s] = cover[e[s]].radius;
        ancf_model_at(x[s], m, m->x, e[s], at->xi[s]);
    }
    c.margin = ancf_apart_reach(&cover[e[0]], &cover[e[1]], step, 0.0);
    for (int i = 0; i < 3; i++) c.side[1].arm[i] = x[0][i] - x[1][i];
    for (int k = 0; k < 2; ++k) c.within[k] = (double)(at->segment + k) / cover[e[0]].segments;
    memcpy(c.normal, at->normal, sizeof c.normal);
    recall(&c, m, last, end);
    return ancf_table_add_contact(table, &c) < 0 ? -1 : 1;
}

int ancf_cross_add(ancf_table* table, ancf_apart* apart, const ancf_cover* cover, const ancf_model* m,
                   const ancf_laws* laws, int kinds, double step, const ancf_memory* last, int n_last) {
    ancf_nearest_pair found[SEGMENTS_MAX];
    const ancf_memory* end = last + n_last;
    int added = 0;
    for (ancf_near pair = {0}; ancf_apart_next(&pair, apart, m);) {
        const int e = pair.first, f = pair.second;
        const ancf_cover *p = &cover[e], *q = &cover[f];
        const int n =
            ancf_nearest_segments(found, &pair.cubic[0], p->segments, pair.segments, p->radius, &pair.cubic[1],
                                  q->radius, pair.reach, pair.reach + beyond * (p->radius + q->radius));
        ancf_apart_learn(apart, &pair, found, n);
        for (int i = 0; i < n; ++i) {
            if (ancf_cross_neighbours(p, found[i].xi[0], m->element[e].length, q, found[i].xi[1], m->element[f].length))
                continue;
            const int one =
                add_contact(table, &found[i], &pair, cover, m, &laws[p->kind * kinds + q->kind], &last, end, step);
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
        if (c->impulse == 0.0 && c->owed == 0.0) continue;
        ancf_memory* own = &memory[n++];
        *own = (ancf_memory) {.first = c->key[0], .second = c->key[1], .segment = c->key[2], .owed = c->owed};
        for (int s = 0; s < 2; ++s) own->xi[s] = ancf_table_place(table, c->side[s].place)->xi;
        memcpy(own->friction, c->friction, sizeof c->friction);
        memcpy(own->late, c->late, sizeof c->late);
    }
    return n;
}
