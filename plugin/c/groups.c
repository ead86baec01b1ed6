// Contacts act on one another through bodies that move and through cables, on which an impulse at one place moves
// others. What does not feel the rest is solved by itself, in no more sub-steps, rounds and sweeps than it needs.
#include "groups.h"
#include "table.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// Part of their own responses below which two places do not feel each other.
static const double unfelt = 1e-10;

void ancf_groups_free(ancf_groups* g) {
    free(g->group);
    for (int i = 0; i < ANCF_ITEMS; ++i) free(g->list[i]);
    free(g->first);
    free(g->other);
    free(g->effect);
    free(g->root);
    free(g->number);
    free(g->head);
    free(g->next);
    free(g->sum);
    free(g->touched);
}

static bool make_room(ancf_groups* g, const ancf_table* t) {
    const int nodes = t->n_places + t->n_bodies, sums = g->room_sum;
    const int items[ANCF_ITEMS] = {t->n_contacts, t->n_places, t->n_bodies};
    for (int i = 0; i < ANCF_ITEMS; ++i)
        if (!ancf_reserve((void**)&g->list[i], &g->room_list[i], items[i], sizeof(int))) return false;
    if (!ancf_reserve((void**)&g->sum, &g->room_sum, t->n_contacts, sizeof *g->sum)) return false;
    if (g->room_sum > sums) memset(g->sum, 0, (size_t)g->room_sum * sizeof *g->sum);
    return ancf_reserve((void**)&g->group, &g->room_group, nodes, sizeof *g->group) &&
           ancf_reserve((void**)&g->first, &g->room_first, t->n_contacts + 1, sizeof *g->first) &&
           ancf_reserve((void**)&g->root, &g->room_root, nodes, sizeof *g->root) &&
           ancf_reserve((void**)&g->number, &g->room_number, nodes, sizeof *g->number) &&
           ancf_reserve((void**)&g->head, &g->room_head, t->n_places, sizeof *g->head) &&
           ancf_reserve((void**)&g->next, &g->room_next, 2 * t->n_contacts, sizeof *g->next) &&
           ancf_reserve((void**)&g->touched, &g->room_touched, t->n_contacts, sizeof *g->touched);
}

static int root_of(ancf_groups* g, int i) {
    while (g->root[i] != i) i = g->root[i] = g->root[g->root[i]];
    return i;
}

// The smaller number becomes the root: groups come in the order in which things were added.
static void unite(ancf_groups* g, int i, int j) {
    i = root_of(g, i);
    j = root_of(g, j);
    if (i < j) g->root[j] = i;
    else g->root[i] = j;
}

static bool felt(const ancf_table* t, int place, int k) {
    const double w = t->effect[k] / unfelt;
    return w * w > t->place[place].compliance * t->place[t->other[k]].compliance;
}

// By what a contact belongs to its group: places, then bodies.
static int node_of(const ancf_table* t, const ancf_contact* c) {
    for (int s = 0; s < 2; ++s)
        if (c->side[s].place >= 0) return c->side[s].place;
    for (int s = 0; s < 2; ++s)
        if (c->side[s].body >= 0 && ancf_body_moves(&t->body[c->side[s].body])) return t->n_places + c->side[s].body;
    return t->n_places + c->side[c->side[0].body < 0].body;
}

static void unite_all(ancf_groups* g, const ancf_table* t) {
    for (int i = 0; i < t->n_places + t->n_bodies; ++i) g->root[i] = i;
    for (int i = 0; i < t->n_places; ++i)
        for (int k = t->first[i]; k < t->first[i + 1]; ++k)
            if (t->other[k] > i && felt(t, i, k)) unite(g, i, t->other[k]);
    for (int i = 0; i < t->n_contacts; ++i) {
        const ancf_contact* c = &t->contact[i];
        if (c->idle) continue;
        const int node = node_of(t, c);
        for (int s = 0; s < 2; ++s) {
            if (c->side[s].place >= 0) unite(g, node, c->side[s].place);
            if (c->side[s].body >= 0 && ancf_body_moves(&t->body[c->side[s].body]))
                unite(g, node, t->n_places + c->side[s].body);
        }
    }
    for (int i = 0; i < t->n_couplings; ++i) { // solved together
        unite(g, t->coupling[0].place, t->coupling[i].place);
        unite(g, t->coupling[i].place, t->n_places + t->coupling[i].body);
    }
}

// Lists n items by their groups, in their order within each; those of group -1 are left out.
static void list(ancf_groups* g, int kind, const int* group, int n) {
    for (int k = 0; k < g->n; ++k) g->group[k].end[kind] = 0;
    for (int i = 0; i < n; ++i)
        if (group[i] >= 0) ++g->group[group[i]].end[kind];
    for (int k = 0, sum = 0; k < g->n; ++k) {
        ancf_contact_group* of = &g->group[k];
        sum += of->end[kind];
        of->first[kind] = of->end[kind] = sum - of->end[kind];
    }
    for (int i = 0; i < n; ++i)
        if (group[i] >= 0) g->list[kind][g->group[group[i]].end[kind]++] = i;
}

static void make_lists(ancf_groups* g, const ancf_table* t) {
    const int nodes = t->n_places + t->n_bodies;
    g->n = 0;
    for (int i = 0; i < nodes; ++i) {
        const int root = root_of(g, i);
        const bool idle = i < t->n_places && t->place[i].idle;
        g->number[i] = idle ? -1 : root == i ? g->n++ : g->number[root];
    }
    for (int k = 0; k < g->n; ++k) {
        g->group[k].substeps = -1;
        g->group[k].slides = false;
    }
    for (int i = 0; i < t->model->n_slides && t->slides >= 0; ++i) g->group[g->number[t->slides + i]].slides = true;
    list(g, ANCF_PLACES, g->number, t->n_places);
    list(g, ANCF_BODIES, g->number + t->n_places, t->n_bodies);
    g->contacts = 0;
    for (int i = 0; i < t->n_contacts; ++i) {
        const ancf_contact* c = &t->contact[i];
        g->touched[i] = c->idle ? -1 : g->number[node_of(t, c)];
        g->contacts += !c->idle;
    }
    list(g, ANCF_CONTACTS, g->touched, t->n_contacts);
}

static void list_sides(ancf_groups* g, const ancf_table* t) {
    for (int i = 0; i < t->n_places; ++i) g->head[i] = -1;
    for (int i = 2 * t->n_contacts - 1; i >= 0; --i) {
        const int place = t->contact[i >> 1].side[i & 1].place;
        if (place < 0 || t->contact[i >> 1].idle) continue;
        g->next[i] = g->head[place];
        g->head[place] = i;
    }
}

// Sums up what an impulse on a contact does to others; returns their number.
static int find_effects(ancf_groups* g, const ancf_table* t, int i) {
    int n = 0;
    for (int s = 0; s < 2; ++s) {
        const int place = t->contact[i].side[s].place;
        if (place < 0) continue;
        for (int k = t->first[place]; k < t->first[place + 1]; ++k) {
            if (!felt(t, place, k)) continue;
            for (int side = g->head[t->other[k]]; side >= 0; side = g->next[side]) {
                double* sum = &g->sum[side >> 1];
                if (*sum == 0.0) g->touched[n++] = side >> 1;
                *sum += (side & 1) == s ? t->effect[k] : -t->effect[k];
                if (*sum == 0.0) *sum = 1e-300; // stays on the list
            }
        }
    }
    return n;
}

static bool make_rows(ancf_groups* g, const ancf_table* t) {
    int count = 0;
    list_sides(g, t);
    g->first[0] = 0;
    for (int i = 0; i < t->n_contacts; ++i) {
        const int n = t->contact[i].idle ? 0 : find_effects(g, t, i);
        const bool room = ancf_reserve((void**)&g->other, &g->room_other, count + n, sizeof *g->other) &&
                          ancf_reserve((void**)&g->effect, &g->room_effect, count + n, sizeof *g->effect);
        for (int k = 0; k < n; ++k) {
            const int j = g->touched[k];
            if (room) {
                g->other[count] = j;
                g->effect[count++] = g->sum[j];
            }
            g->sum[j] = 0.0;
        }
        if (!room) return false;
        g->first[i + 1] = count;
    }
    return true;
}

bool ancf_groups_make(ancf_groups* g, const ancf_table* t) {
    if (!make_room(g, t)) return false;
    unite_all(g, t);
    make_lists(g, t);
    return make_rows(g, t);
}
