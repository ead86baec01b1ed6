// Over a sub-step h each force is what its law gives at the mean velocity w along the normal, minus the quotient of
// elastic energy and way h w with what damping adds: it falls with w, as Newton's method wants it.
#include "squeeze.h"

#include "answer.h"
#include "push.h"

#include <math.h>

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
    *F = ancf_answer_at(&s->t->contact[s->contact[i]], *v, s->h, &elastic, &slope);
}

static void root_at(double R[3], const void* law, int i, const double* v) {
    const squeezed* s = law;
    double slope, elastic;
    ancf_answer_at(&s->t->contact[s->contact[i]], *v, s->h, &elastic, &slope);
    R[0] = slope < 0.0 ? sqrt(-slope) : 0.0;
}

// Forces that the laws give, in v the mean velocities that all of them leave. What does not press gives back nothing.
static void press_all(double* force, double* v, double* repaid, double* left, const ancf_newton_laws* laws,
                      ancf_table* t, double enough) {
    const int n = laws->n;
    for (bool again = true; again;) {
        ancf_newton(force, v, left, laws, t->effects, enough, t->newton);
        again = false;
        for (int i = 0; i < n; ++i) {
            if (force[i] > 0.0 || repaid[i] == 0.0) continue;
            for (int j = 0; j < n; ++j) v[j] -= t->effects[j * n + i] * repaid[i];
            repaid[i] = 0.0;
            again = true;
        }
    }
}

double ancf_squeeze(double* left, ancf_table* t, const int* contact, int n, double h, double enough) {
    double force[ANCF_NEWTON_MOST], v[ANCF_NEWTON_MOST], repaid[ANCF_NEWTON_MOST], largest = 0.0;
    const squeezed s = {t, contact, h};
    const ancf_newton_laws laws = {n, 1, force_at, root_at, &s};
    for (int i = 0; i < n; ++i) {
        const ancf_contact* c = &t->contact[contact[i]];
        repaid[i] = c->repaid;
        force[i] = c->force - c->repaid;
        v[i] = c->speed + 0.5 * ancf_push_gained(t, &t->push[contact[i]]);
    }
    find_effects(t->effects, t, contact, n, h);
    press_all(force, v, repaid, left, &laws, t, enough);
    for (int i = 0; i < n; ++i) {
        ancf_contact* c = &t->contact[contact[i]];
        double slope;
        ancf_answer_at(c, v[i], h, &c->elastic, &slope);
        const double more = force[i] + repaid[i] - c->force;
        c->force = c->before = c->force + more;
        c->repaid = repaid[i];
        ancf_push_give(t, contact[i], h * more);
        largest = ancf_larger(largest, fabs(more));
    }
    return largest;
}
