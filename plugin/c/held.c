#include "held.h"

#include "slide.h"

void ancf_held_accelerate(ancf_model* m, double kick) {
    for (int k = 0; k < m->n_held; ++k)
        for (int c = 0; c < 3; ++c) {
            const int j = c * m->stride + m->is_held[k];
            m->a[j] = (m->held[j] - m->v[j]) / kick;
        }
    ancf_slides_accelerate(m, kick);
}

void ancf_held_set(const ancf_model* m, double* v) {
    for (int k = 0; k < m->n_held; ++k)
        for (int c = 0; c < 3; ++c) {
            const int j = c * m->stride + m->is_held[k];
            v[j] = m->held[j];
        }
    ancf_slides_project(m, v);
}

void ancf_held_keep(ancf_model* m) {
    for (int k = 0; k < m->n_held; ++k)
        for (int c = 0; c < 3; ++c) {
            const int j = c * m->stride + m->is_held[k];
            m->free[j] = m->x[j];
        }
    ancf_slides_keep(m);
    ancf_slides_give(m, m->a);
}

ANCF_CLONES void ancf_held_move(ancf_model* m, double kick, double step) {
    ancf_held_set(m, m->v);
    for (int k = 0; k < m->n_held; ++k)
        for (int c = 0; c < 3; ++c) {
            const int j = c * m->stride + m->is_held[k];
            m->x[j] = m->free[j] + step * m->v[j];
        }
    ancf_slides_move(m, kick, step);
}
