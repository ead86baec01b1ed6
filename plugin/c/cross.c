#include "ancf/cross.h"

#include <math.h>
#include <string.h>

// Along one run, places nearer than this many radii never touch: however strongly a cable bends, it does not kick.
static const double neighbourhood = 4.0;

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

int ancf_cross_add(ancf_table* table, const ancf_boxes* boxes, const ancf_cover* cover, const ancf_model* m,
                   const ancf_laws* laws, int kinds, double reach, const ancf_memory* last, int n_last) {
    enum { SEGMENTS_MAX = 64 };
    const ancf_memory* end = last + n_last;
    ancf_nearest_pair found[SEGMENTS_MAX];
    int n, added = 0;
    const ancf_meeting* meeting = ancf_boxes_meetings(boxes, &n);
    for (int k = 0; k < n; ++k) {
        const int e[2] = {meeting[k].first, meeting[k].second};
        const ancf_cover *p = &cover[e[0]], *q = &cover[e[1]];
        const double length[2] = {m->element[e[0]].length, m->element[e[1]].length};
        ancf_cubic cubic[2];
        for (int s = 0; s < 2; ++s) ancf_cover_cubic(&cubic[s], m, m->x, e[s]);
        const int segments = p->segments < SEGMENTS_MAX ? p->segments : SEGMENTS_MAX;
        const int places = ancf_nearest_cubic(found, &cubic[0], segments, p->radius, &cubic[1], q->radius, reach);
        const ancf_laws* law = &laws[p->kind * kinds + q->kind];
        for (int i = 0; i < places; ++i) {
            const ancf_nearest_pair* at = &found[i];
            if (neighbours(p, at->xi[0], length[0], q, at->xi[1], length[1])) continue;
            ancf_contact c = {.key = {e[0], e[1], at->segment}, .gap = at->gap, .law = law->normal, .rub = law->rub};
            for (int s = 0; s < 2; ++s) {
                c.side[s] = (ancf_side) {.place = ancf_table_add_place(table, m, e[s], at->xi[s]), .body = -1};
                if (c.side[s].place < 0) return -1;
            }
            ancf_cover whole = *q;
            whole.segments = 1;
            c.law.stiffness *= ancf_cover_share(p, at->segment, at->xi[0]) * ancf_cover_share(&whole, 0, at->xi[1]);
            memcpy(c.normal, at->normal, sizeof c.normal);
            recall(c.friction, c.key, &last, end);
            if (ancf_table_add_contact(table, &c) < 0) return -1;
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
