#include "push.h"

#include <string.h>

void ancf_push_find(ancf_table* t, int contact) {
    const ancf_contact* c = &t->contact[contact];
    ancf_push* push = &t->push[contact];
    memcpy(push->normal, c->normal, sizeof push->normal);
    push->pushed = ancf_table_opening(t, c) - c->speed;
    push->number = 0;
    for (int s = 0; s < 2; ++s) {
        push->body[s] = -1;
        if (c->side[s].body < 0) continue;
        ancf_body* b = &t->body[c->side[s].body];
        if (!ancf_body_moves(b)) continue;
        push->body[s] = c->side[s].body;
        double* along = push->along[s];
        for (int k = 0; k < 3; k++) {
            along[k] = s ? -c->normal[k] : c->normal[k];
            b->pushed[k] = b->pushed[3 + k] = 0.0;
        }
        ancf_cross(along + 3, c->side[s].arm, along);
        ancf_body_answer(push->answer[s], b, along, along + 3);
    }
}

double ancf_push_gained(const ancf_table* t, const ancf_push* push) {
    double sum = push->pushed;
    for (int s = 0; s < 2; ++s) {
        if (push->body[s] < 0) continue;
        const double *v = t->body[push->body[s]].pushed, *along = push->along[s];
        for (int k = 0; k < 6; k++) sum += along[k] * v[k];
    }
    return sum;
}

void ancf_push_give(ancf_table* t, int contact, double impulse) {
    const ancf_push* push = &t->push[contact];
    const ancf_groups* g = &t->groups;
    for (int k = g->first[contact]; k < g->first[contact + 1]; ++k) {
        ancf_push* other = &t->push[g->other[k]];
        other->pushed += impulse * g->effect[k] * ancf_dot(push->normal, other->normal);
    }
    for (int s = 0; s < 2; ++s) {
        if (push->body[s] < 0) continue;
        double* v = t->body[push->body[s]].pushed;
        for (int k = 0; k < 6; k++) v[k] += impulse * push->answer[s][k];
    }
}
