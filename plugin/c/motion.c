#include "ancf/motion.h"
#include "internal.h"

#include <math.h>
#include <stdlib.h>

ancf_error ancf_motion_create(ancf_motion** motion, const ancf_model* m) {
    ancf_motion* a = *motion = calloc(1, sizeof *a);
    if (!a) return ANCF_E_MEMORY;
    const size_t n = (size_t)m->n_elements, n_dof = (size_t)m->n_dof, field = 3 * (size_t)m->stride;
    a->n = m->n_elements;
    a->place = calloc(field, sizeof *a->place);
    a->gone = calloc(n, sizeof *a->gone);
    a->speed = calloc(n, sizeof *a->speed);
    a->lever = calloc(n_dof, sizeof *a->lever);
    a->way = calloc(field, sizeof *a->way);
    a->size = calloc(n_dof, sizeof *a->size);
    if (!a->place || !a->gone || !a->speed || !a->lever || !a->way || !a->size) {
        ancf_motion_destroy(a);
        *motion = NULL;
        return ANCF_E_MEMORY;
    }
    for (int e = 0; e < a->n; ++e) {
        if (m->element[e].kind & ANCF_SPRING) continue;
        a->lever[m->n_nodes + e] = a->lever[m->n_nodes + a->n + e] = m->element[e].length / 3.0;
    }
    return ANCF_OK;
}

void ancf_motion_destroy(ancf_motion* a) {
    if (!a) return;
    free(a->place);
    free(a->gone);
    free(a->speed);
    free(a->lever);
    free(a->way);
    free(a->size);
    free(a);
}

// Places ahead of a state, and the ways to there from the places of before; n: of all three blocks. Whether any has
// moved.
ANCF_CLONES static bool go(double* restrict place, double* restrict way, const double* restrict x,
                           const double* restrict v, double ahead, int n) {
    double any = 0.0;
#pragma omp simd reduction(+ : any)
    for (int i = 0; i < n; ++i) {
        const double next = x[i] + ahead * v[i];
        way[i] = next - place[i];
        place[i] = next;
        any += fabs(way[i]);
    }
    return any != 0.0;
}

// How far or how fast control points go by each unknown, against the mean of the nodes.
ANCF_CLONES static void against_mean(double* restrict size, const double* restrict field, const double* restrict lever,
                                     int n_nodes, int n_dof, int stride, double mean[3]) {
    const double *x = field, *y = field + stride, *z = field + 2 * stride;
    double mean_x = 0.0, mean_y = 0.0, mean_z = 0.0;
#pragma omp simd reduction(+ : mean_x, mean_y, mean_z)
    for (int i = 0; i < n_nodes; ++i) {
        mean_x += x[i];
        mean_y += y[i];
        mean_z += z[i];
    }
    mean_x /= n_nodes;
    mean_y /= n_nodes;
    mean_z /= n_nodes;
    for (int i = 0; i < n_nodes; ++i) {
        const double a = x[i] - mean_x, b = y[i] - mean_y, c = z[i] - mean_z;
        size[i] = sqrt(a * a + b * b + c * c);
    }
    mean[0] = mean_x;
    mean[1] = mean_y;
    mean[2] = mean_z;
    for (int i = n_nodes; i < n_dof; ++i) size[i] = lever[i] * sqrt(x[i] * x[i] + y[i] * y[i] + z[i] * z[i]);
}

ANCF_CLONES static void larger_ends(double* restrict larger, const double* restrict size, const int* restrict ends,
                                    int n_nodes, int n) {
    const double *start = size + n_nodes, *end = start + n;
    for (int e = 0; e < n; ++e) {
        const double a = size[ends[2 * e]] + start[e], b = size[ends[2 * e + 1]] + end[e];
        larger[e] = a > b ? a : b;
    }
}

void ancf_motion_follow(ancf_motion* a, const ancf_model* m, double step) {
    double way[3];
    a->step = step;
    if (!go(a->place, a->way, m->x, m->v, 0.5 * step, 3 * m->stride) && a->looks > 0) return;
    ++a->looks;
    against_mean(a->size, a->way, a->lever, m->n_nodes, m->n_dof, m->stride, way);
    larger_ends(a->speed, a->size, m->ends, m->n_nodes, a->n);
    for (int e = 0; e < a->n; ++e) a->gone[e] += a->speed[e];
    for (int c = 0; c < 3; ++c) a->mean_way[c] += way[c];
    against_mean(a->size, m->v, a->lever, m->n_nodes, m->n_dof, m->stride, a->mean_velocity);
    larger_ends(a->speed, a->size, m->ends, m->n_nodes, a->n);
}
