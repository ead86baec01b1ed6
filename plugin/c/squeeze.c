// Over a sub-step h each force is what its law gives at the mean velocity w along the normal, minus the quotient of
// elastic energy and way h w with what damping adds: it falls with w, as Newton's method wants it.
#include "squeeze.h"

#include <math.h>

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

// What the contacts' forces do to their mean velocities.
static void find_effects(double* W, ancf_table* t, const int* contact, int n, double h) {
    const ancf_groups* g = &t->groups;
    for (int i = 0; i < n; ++i) t->push[contact[i]].number = i;
    for (int i = 0; i < n; ++i) {
        const ancf_push* push = &t->push[contact[i]];
        double* row = W + i * n;
        for (int j = 0; j < n; ++j) row[j] = 0.0;
        for (int k = g->first[contact[i]]; k < g->first[contact[i] + 1]; ++k) {
            const ancf_push* other = &t->push[g->other[k]];
            if (other->number >= n || contact[other->number] != g->other[k]) continue;
            row[other->number] += 0.5 * h * g->effect[k] * ancf_dot(push->normal, other->normal);
        }
        for (int j = 0; j < n; ++j) {
            const ancf_push* other = &t->push[contact[j]];
            for (int s = 0; s < 2; ++s)
                for (int r = 0; r < 2; ++r) {
                    if (push->body[s] < 0 || push->body[s] != other->body[r]) continue;
                    for (int k = 0; k < 6; k++) row[j] += 0.5 * h * push->along[s][k] * other->answer[r][k];
                }
        }
    }
}

typedef struct {
    const ancf_table* t;
    const int* contact;
    double h;
} squeezed;

static void force_at(double* F, const void* law, int i, const double* v) {
    const squeezed* s = law;
    double slope, elastic;
    *F = ancf_press_answer(&s->t->contact[s->contact[i]], *v, s->h, &elastic, &slope);
}

static void root_at(double R[3], const void* law, int i, const double* v) {
    const squeezed* s = law;
    double slope, elastic;
    ancf_press_answer(&s->t->contact[s->contact[i]], *v, s->h, &elastic, &slope);
    R[0] = slope < 0.0 ? sqrt(-slope) : 0.0;
}

double ancf_squeeze(ancf_table* t, const int* contact, int n, double h, double enough) {
    double force[ANCF_NEWTON_MOST], v[ANCF_NEWTON_MOST], left, largest = 0.0;
    const squeezed s = {t, contact, h};
    const ancf_newton_laws laws = {n, 1, force_at, root_at, &s};
    for (int i = 0; i < n; ++i) {
        const ancf_contact* c = &t->contact[contact[i]];
        force[i] = c->force - c->repaid;
        v[i] = c->speed + 0.5 * ancf_push_gained(t, &t->push[contact[i]]);
    }
    find_effects(t->effects, t, contact, n, h);
    ancf_newton(force, v, &left, &laws, t->effects, enough, t->newton);
    for (int i = 0; i < n; ++i) {
        ancf_contact* c = &t->contact[contact[i]];
        double slope;
        ancf_press_answer(c, v[i], h, &c->elastic, &slope);
        const double more = force[i] - (c->force - c->repaid);
        c->force += more;
        c->before = c->force;
        ancf_push_give(t, contact[i], h * more);
        largest = ancf_larger(largest, fabs(more));
    }
    return largest;
}
