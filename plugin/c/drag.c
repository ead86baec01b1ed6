// Friction along two directions across the normal: what it moves, and the slip that comes of it.
#include "drag.h"

#include "lever.h"

#include <math.h>

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

// Slip by what places do to one another: along a by a unit impulse along b [1/kg].
static double by_places(const ancf_table* t, const ancf_contact* c, const ancf_drag* d, int a, int b) {
    const double turned = a == b;
    double sum = 0.0;
    for (int from = 0; from < 2; ++from)
        for (int to = 0; to < 2; ++to) {
            if (c->side[from].place < 0 || c->side[to].place < 0) continue;
            const ancf_effects e = ancf_table_effects(t, c->side[from].place, c->side[to].place);
            const double sign = from == to ? 1.0 : -1.0;
            sum += sign * e.effect * turned;
            if (!d->levers) continue;
            const double *there = d->turn[2 * to][a], *here = d->turn[2 * from][b];
            sum += (to ? -1.0 : 1.0) * e.bend.from * ancf_dot(d->tangent[a], here);
            sum +=
                (from ? -1.0 : 1.0) * e.bend.to * ancf_dot(d->tangent[b], there) + e.bend.both * ancf_dot(there, here);
        }
    return sum;
}

static double by_bodies(const ancf_drag* d, int a, int b) {
    double sum = 0.0;
    for (int s = 0; s < 2; ++s) {
        if (!d->body[s]) continue;
        sum += (s ? -1.0 : 1.0) * ancf_dot(d->tangent[a], d->answer[s][b]);
        sum += ancf_dot(d->turn[2 * s + 1][a], d->answer[s][b] + 3);
    }
    return sum;
}

void ancf_drag_find(ancf_table* t, const ancf_contact* c, ancf_drag* d) {
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
    d->own[0] = by_places(t, c, d, 0, 0) + by_bodies(d, 0, 0);
    d->own[1] = by_places(t, c, d, 0, 1) + by_bodies(d, 0, 1);
    d->own[2] = by_places(t, c, d, 1, 1) + by_bodies(d, 1, 1);
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

void ancf_drag_give(ancf_table* t, const ancf_contact* c, const ancf_drag* d, const double impulse[2]) {
    for (int s = 0; s < 2; ++s) {
        if (d->body[s])
            for (int i = 0; i < 6; i++)
                d->body[s][i] += impulse[0] * d->answer[s][0][i] + impulse[1] * d->answer[s][1][i];
        const int place = c->side[s].place;
        if (place < 0) continue;
        const double sign = s ? -1.0 : 1.0;
        double push[3], couple[3];
        for (int i = 0; i < 3; i++) push[i] = sign * (impulse[0] * d->tangent[0][i] + impulse[1] * d->tangent[1][i]);
        for (int k = t->first[place]; k < t->first[place + 1]; ++k) {
            double* w = t->place[t->other[k]].pushed;
            for (int i = 0; i < 3; i++) w[i] += t->effect[k] * push[i];
        }
        if (!t->slopes) continue;
        for (int i = 0; i < 3; i++)
            couple[i] = d->levers ? impulse[0] * d->turn[2 * s][0][i] + impulse[1] * d->turn[2 * s][1][i] : 0.0;
        for (int k = t->first[place]; k < t->first[place + 1]; ++k) {
            double* w = t->place[t->other[k]].pushed;
            for (int i = 0; i < 3; i++) {
                w[i] += t->bend[k].from * couple[i];
                w[3 + i] += t->bend[k].to * push[i] + t->bend[k].both * couple[i];
            }
        }
    }
}
