// Friction along two directions across the normal: what it moves, and the slip that comes of it.
#include "drag.h"

#include "lever.h"

#include <math.h>
#include <string.h>

// Two directions across a normal.
static void across(double tangent[2][3], const double n[3]) {
    const double x = fabs(n[0]), y = fabs(n[1]), z = fabs(n[2]);
    const int least = x < y ? (x < z ? 0 : 2) : (y < z ? 1 : 2);
    const double axis[3] = {least == 0, least == 1, least == 2};
    ancf_cross(tangent[0], n, axis);
    const double size = sqrt(ancf_dot(tangent[0], tangent[0]));
    for (int i = 0; i < 3; i++) tangent[0][i] /= size;
    ancf_cross(tangent[1], n, tangent[0]);
}

// What holds nodes that slide against friction of the other contact, to the slip of the one.
static void add_by_slides(double w[2][2], const ancf_table* t, const ancf_contact* one, const ancf_drag* d,
                          const ancf_contact* other, const ancf_drag* e) {
    for (int from = 0; from < 2 && t->slides >= 0; ++from)
        for (int b = 0; b < 2 && other->side[from].place >= 0; ++b) {
            double push[3];
            for (int i = 0; i < 3; i++) push[i] = from ? -e->tangent[b][i] : e->tangent[b][i];
            if (!ancf_table_hold(t, other->side[from].place, push, e->levers ? e->turn[2 * from][b] : NULL)) continue;
            for (int to = 0; to < 2; ++to)
                for (int k = 0; k < t->model->n_slides && one->side[to].place >= 0; ++k) {
                    const ancf_effects by = ancf_table_effects(t, t->slides + k, one->side[to].place);
                    for (int a = 0; a < 2; ++a) {
                        w[a][b] += (to ? -1.0 : 1.0) * by.effect * ancf_dot(d->tangent[a], t->hold[k]);
                        if (d->levers) w[a][b] += by.bend.to * ancf_dot(d->turn[2 * to][a], t->hold[k]);
                    }
                }
        }
}

// Slip of one contact by unit impulses on the other, through cables.
static void add_by_places(double w[2][2], const ancf_table* t, const ancf_contact* one, const ancf_drag* d,
                          const ancf_contact* other, const ancf_drag* e) {
    for (int to = 0; to < 2; ++to)
        for (int from = 0; from < 2; ++from) {
            if (one->side[to].place < 0 || other->side[from].place < 0) continue;
            const ancf_effects by = ancf_table_effects(t, other->side[from].place, one->side[to].place);
            if (by.effect == 0.0) continue;
            const double near = to ? -1.0 : 1.0, far = from ? -1.0 : 1.0;
            for (int a = 0; a < 2; ++a)
                for (int b = 0; b < 2; ++b) {
                    const double *there = d->turn[2 * to][a], *here = e->turn[2 * from][b];
                    w[a][b] += near * far * by.effect * ancf_dot(d->tangent[a], e->tangent[b]);
                    if (e->levers) w[a][b] += near * by.bend.from * ancf_dot(d->tangent[a], here);
                    if (d->levers) w[a][b] += far * by.bend.to * ancf_dot(there, e->tangent[b]);
                    if (d->levers && e->levers) w[a][b] += by.bend.both * ancf_dot(there, here);
                }
        }
    add_by_slides(w, t, one, d, other, e);
}

static void add_by_bodies(double w[2][2], const ancf_drag* d, const ancf_drag* e) {
    for (int to = 0; to < 2; ++to)
        for (int from = 0; from < 2; ++from) {
            if (!d->body[to] || d->body[to] != e->body[from]) continue;
            for (int a = 0; a < 2; ++a)
                for (int b = 0; b < 2; ++b) {
                    const double* answer = e->answer[from][b];
                    w[a][b] += (to ? -1.0 : 1.0) * ancf_dot(d->tangent[a], answer);
                    w[a][b] += ancf_dot(d->turn[2 * to + 1][a], answer + 3);
                }
        }
}

// Into W, and what it is the other way round.
static void add(double* W, double w[2][2], int i, int j, int m) {
    for (int a = 0; a < 2; ++a)
        for (int b = 0; b < 2; ++b) {
            W[(2 * i + a) * m + 2 * j + b] += w[a][b];
            if (i != j) W[(2 * j + b) * m + 2 * i + a] += w[a][b];
        }
}

void ancf_drag_effects(double* W, ancf_table* t, const int* contact, int n) {
    const ancf_groups* g = &t->groups;
    const int m = 2 * n;
    memset(W, 0, sizeof *W * (size_t)(m * m));
    for (int i = 0; i < n; ++i) t->drag[contact[i]].number = i;
    for (int i = 0; i < n; ++i) {
        const int one = contact[i];
        const ancf_drag* d = &t->drag[one];
        for (int k = g->first[one]; k < g->first[one + 1]; ++k) {
            const int other = g->other[k], j = t->drag[other].number;
            if (j < i || j >= n || contact[j] != other) continue;
            double w[2][2] = {{0.0, 0.0}, {0.0, 0.0}};
            add_by_places(w, t, &t->contact[one], d, &t->contact[other], &t->drag[other]);
            add(W, w, i, j, m);
        }
        for (int j = i; j < n && (d->body[0] || d->body[1]); ++j) {
            double w[2][2] = {{0.0, 0.0}, {0.0, 0.0}};
            add_by_bodies(w, d, &t->drag[contact[j]]);
            add(W, w, i, j, m);
        }
    }
}

void ancf_drag_find(ancf_table* t, int contact) {
    const ancf_contact* c = &t->contact[contact];
    ancf_drag* d = &t->drag[contact];
    across(d->tangent, c->normal);
    d->levers = ancf_lever_has(c);
    for (int a = 0; a < 2; ++a) {
        if (d->levers) ancf_lever_couples(d->turn[0][a], d->turn[2][a], t, c, d->tangent[a]);
        for (int s = 0; s < 2; ++s) {
            d->body[s] = NULL;
            if (c->side[s].body < 0) continue;
            ancf_body* b = &t->body[c->side[s].body];
            if (!ancf_body_moves(b)) continue;
            d->body[s] = b->pushed;
            double push[3], *twist = d->turn[2 * s + 1][a];
            for (int i = 0; i < 3; i++) push[i] = s ? -d->tangent[a][i] : d->tangent[a][i];
            ancf_cross(twist, c->side[s].arm, push);
            ancf_body_answer(d->answer[s][a], b, push, twist);
        }
    }
    memset(d->own, 0, sizeof d->own);
    add_by_places(d->own, t, c, d, c, d);
    add_by_bodies(d->own, d, d);
}

void ancf_drag_slip(double v[2], const ancf_table* t, const ancf_contact* c, const ancf_drag* d) {
    double u[3] = {0.0, 0.0, 0.0};
    v[0] = d->slip[0];
    v[1] = d->slip[1];
    for (int s = 0; s < 2; ++s) {
        const double sign = s ? -1.0 : 1.0;
        if (c->side[s].place >= 0) {
            const double* w = t->place[c->side[s].place].pushed;
            for (int i = 0; i < 3; i++) u[i] += sign * w[i];
            for (int a = 0; d->levers && a < 2; ++a) v[a] += ancf_dot(d->turn[2 * s][a], w + 3);
        }
        if (d->body[s]) {
            const double* w = d->body[s];
            for (int i = 0; i < 3; i++) u[i] += sign * w[i];
            for (int a = 0; a < 2; ++a) v[a] += ancf_dot(d->turn[2 * s + 1][a], w + 3);
        }
    }
    for (int a = 0; a < 2; ++a) v[a] += ancf_dot(d->tangent[a], u);
}

// Velocities of all places by an impulse at one of them, and a couple on its slope.
static void push_places(ancf_table* t, int place, const double push[3], const double couple[3]) {
    for (int k = t->first[place]; k < t->first[place + 1]; ++k) {
        double* w = t->place[t->other[k]].pushed;
        for (int i = 0; i < 3; i++) w[i] += t->effect[k] * push[i];
    }
    if (!t->slopes) return;
    for (int k = t->first[place]; k < t->first[place + 1]; ++k) {
        double* w = t->place[t->other[k]].pushed;
        for (int i = 0; i < 3; i++) {
            w[i] += t->bend[k].from * couple[i];
            w[3 + i] += t->bend[k].to * push[i] + t->bend[k].both * couple[i];
        }
    }
}

void ancf_drag_give(ancf_table* t, const ancf_contact* c, const ancf_drag* d, const double impulse[2]) {
    for (int s = 0; s < 2; ++s) {
        if (d->body[s])
            for (int i = 0; i < 6; i++)
                d->body[s][i] += impulse[0] * d->answer[s][0][i] + impulse[1] * d->answer[s][1][i];
        const int place = c->side[s].place;
        if (place < 0) continue;
        const double sign = s ? -1.0 : 1.0;
        double push[3], couple[3];
        for (int i = 0; i < 3; i++) {
            push[i] = sign * (impulse[0] * d->tangent[0][i] + impulse[1] * d->tangent[1][i]);
            couple[i] = d->levers ? impulse[0] * d->turn[2 * s][0][i] + impulse[1] * d->turn[2 * s][1][i] : 0.0;
        }
        push_places(t, place, push, couple);
        if (!ancf_table_hold(t, place, push, couple)) continue;
        for (int k = 0; k < t->model->n_slides; ++k) push_places(t, t->slides + k, t->hold[k], (double[3]) {0.0});
    }
}
