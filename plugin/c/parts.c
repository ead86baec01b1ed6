#include "parts.h"

// Ends a part of the list at its end.
static void end_part(ancf_table* t, int n) { t->part[++t->parts] = n; }

// The body that a contact's friction moves, or -1.
static int body_of(const ancf_table* t, const ancf_contact* c) {
    for (int s = 1; s >= 0; --s)
        if (c->side[s].body >= 0 && ancf_body_moves(&t->body[c->side[s].body])) return c->side[s].body;
    return -1;
}

// The element that its first side is on, or -1.
static int element_of(const ancf_table* t, int contact) {
    const int place = t->contact[contact].side[0].place;
    return place < 0 ? -1 : t->place[place].element;
}

// Adds a contact and those of the same body to the list of n, or those of the same element if there is none; returns
// the number listed.
static int list_part(ancf_table* t, int contact, int n) {
    const int body = body_of(t, &t->contact[contact]), element = element_of(t, contact);
    int size = 0;
    for (int next = body < 0 ? contact : t->first_on[body]; next >= 0; next = t->next_on[next]) {
        if (body < 0 && next != contact && (element < 0 || element_of(t, next) != element)) break;
        if (t->drag[next].listed) continue;
        if (size > 0 && size % ANCF_NEWTON_MOST == 0) end_part(t, n);
        t->drag[next].listed = true;
        t->rubbing[n++] = next;
        ++size;
    }
    end_part(t, n);
    return n;
}

// Chains the contacts of each body, and those that move none.
static void chain(ancf_table* t, const ancf_contact_group* g) {
    const int *contact = t->groups.list[ANCF_CONTACTS], *bodies = t->groups.list[ANCF_BODIES];
    int bare = -1;
    for (int k = g->first[ANCF_BODIES]; k < g->end[ANCF_BODIES]; ++k) t->first_on[bodies[k]] = -1;
    for (int k = g->end[ANCF_CONTACTS] - 1; k >= g->first[ANCF_CONTACTS]; --k) {
        const int i = contact[k];
        if (t->drag[i].listed) continue;
        const int body = body_of(t, &t->contact[i]);
        int* first = body < 0 ? &bare : &t->first_on[body];
        t->next_on[i] = *first;
        *first = i;
    }
}

int ancf_parts_list(ancf_table* t, const ancf_contact_group* g) {
    const ancf_groups* of = &t->groups;
    int n = 0, seen = 0;
    chain(t, g);
    t->parts = t->part[0] = 0;
    for (int k = g->first[ANCF_CONTACTS]; k < g->end[ANCF_CONTACTS]; ++k) {
        const int i = of->list[ANCF_CONTACTS][k];
        if (!t->drag[i].listed) n = list_part(t, i, n);
        for (; seen < n; ++seen)
            for (int j = of->first[t->rubbing[seen]]; j < of->first[t->rubbing[seen] + 1]; ++j)
                if (!t->drag[of->other[j]].listed) n = list_part(t, of->other[j], n);
    }
    return n;
}

void ancf_parts_join(ancf_table* t, int most) {
    int parts = 0;
    for (int k = 1; k <= t->parts; ++k)
        if (k == t->parts || t->part[k + 1] - t->part[parts] > most) t->part[++parts] = t->part[k];
    t->parts = parts;
}
