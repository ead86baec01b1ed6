// Models for the tests: cables and nets, and what a test computes of them by itself.
#ifndef ANCF_TEST_BUILD_H
#define ANCF_TEST_BUILD_H

#include "check.h"

#include "ancf/balance.h"
#include "ancf/elastic.h"
#include "ancf/mass.h"
#include "ancf/model.h"
#include "ancf/shape.h"
#include "ancf/step.h"
#include "ancf/tension.h"
#include <stdlib.h>
#include <string.h>

enum { BUILD_SLIDES = 4 };

typedef struct {
    ancf_def def;
    ancf_slide slide[BUILD_SLIDES];
    ancf_element* element;
    int *ends, *next, *hold;
    double *mass, *x, *v;
    int n_dof, stride;
    ancf_model* m;
} built;

static inline built build_start(int n_nodes, int n_elements, ancf_element all) {
    built b = {.n_dof = n_nodes + 2 * n_elements, .stride = ancf_stride(n_nodes, n_elements)};
    b.element = calloc((size_t)n_elements, sizeof *b.element);
    b.ends = calloc(2 * (size_t)n_elements, sizeof *b.ends);
    b.next = calloc((size_t)n_elements, sizeof *b.next);
    b.hold = calloc((size_t)b.n_dof, sizeof *b.hold);
    b.mass = calloc((size_t)n_nodes, sizeof *b.mass);
    b.x = calloc(3 * (size_t)b.stride, sizeof *b.x);
    b.v = calloc(3 * (size_t)b.stride, sizeof *b.v);
    for (int e = 0; e < n_elements; ++e) {
        b.element[e] = all;
        b.next[e] = -1;
    }
    b.def = (ancf_def) {.n_nodes = n_nodes, .n_elements = n_elements};
    return b;
}

// Slopes of straight elements between the nodes as they lie.
static inline void build_slopes(built* b) {
    for (int e = 0; e < b->def.n_elements; ++e)
        for (int c = 0; c < 3; ++c) {
            double* u = b->x + c * b->stride;
            const double d = (u[b->ends[2 * e + 1]] - u[b->ends[2 * e]]) / b->element[e].length;
            u[b->def.n_nodes + e] = u[b->def.n_nodes + b->def.n_elements + e] = d;
        }
}

// Straight cable along x from the origin; all.length is that of the whole cable.
static inline built build_cable(int elements, ancf_element all, int smooth) {
    all.length /= elements;
    built b = build_start(elements + 1, elements, all);
    for (int i = 0; i <= elements; ++i) b.x[i] = i * all.length;
    for (int e = 0; e < elements; ++e) {
        b.ends[2 * e] = e;
        b.ends[2 * e + 1] = e + 1;
        if (smooth && e + 1 < elements) b.next[e] = e + 1;
    }
    build_slopes(&b);
    return b;
}

// Square net in the y-z plane, all.length is the mesh length.
static inline built build_net(int meshes, ancf_element all) {
    const int k = meshes + 1;
    built b = build_start(k * k, 2 * k * meshes, all);
    int e = 0;
    for (int i = 0; i < k; ++i)
        for (int j = 0; j < k; ++j) {
            b.x[b.stride + i * k + j] = i * all.length;
            b.x[2 * b.stride + i * k + j] = j * all.length;
            if (i + 1 < k) {
                b.ends[2 * e] = i * k + j;
                b.ends[2 * e++ + 1] = (i + 1) * k + j;
            }
            if (j + 1 < k) {
                b.ends[2 * e] = i * k + j;
                b.ends[2 * e++ + 1] = i * k + j + 1;
            }
        }
    build_slopes(&b);
    return b;
}

// Lets a node slide along a direction of any length, from where it is now.
static inline void build_slide(built* b, int node, const double direction[3]) {
    ancf_slide* s = &b->slide[b->def.n_slides++];
    const double *d = direction, length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    s->node = node;
    for (int c = 0; c < 3; ++c) {
        s->along[c] = d[c] / length;
        s->at[c] = b->x[c * b->stride + node];
    }
}

static inline void build_finish(built* b) {
    int where = -1;
    b->def.element = b->element;
    b->def.ends = b->ends;
    b->def.next = b->next;
    b->def.mass = b->mass;
    b->def.hold = b->hold;
    b->def.slide = b->slide;
    const ancf_error error = ancf_model_create(&b->m, &b->def, b->x, b->v, &where);
    if (error) fail_msg("%s (at %d)", ancf_error_text(error), where);
}

static inline void build_free(built* b) {
    ancf_model_destroy(b->m);
    free(b->element);
    free(b->ends);
    free(b->next);
    free(b->hold);
    free(b->mass);
    free(b->x);
    free(b->v);
}

// Both copies of a shared slope as the first one is.
static inline void build_share(const built* b, double* field) {
    for (int c = 0; c < 3; ++c) {
        double *start = field + c * b->stride + b->def.n_nodes, *end = start + b->def.n_elements;
        for (int e = 0; e < b->def.n_elements; ++e)
            if (b->next[e] >= 0) start[b->next[e]] = end[e];
    }
}

// Moves everything at random, by at most `by` (slopes) or by a part of an element's length (nodes).
static inline void build_shake(built* b, double* field, double by, uint64_t* seed) {
    for (int c = 0; c < 3; ++c)
        for (int i = 0; i < b->n_dof; ++i)
            field[c * b->stride + i] +=
                random_between(seed, -by, by) * (i < b->def.n_nodes ? b->element[0].length : 1.0);
    build_share(b, field);
}

// Gauss points on [0, 1].
static const double gauss5_xi[5] = {0.046910077030668004, 0.23076534494715845, 0.5, 0.76923465505284155,
                                    0.953089922969332};
static const double gauss5_weight[5] = {0.11846344252809454, 0.23931433524968324, 0.28444444444444444,
                                        0.23931433524968324, 0.11846344252809454};

// Element mass by quadrature of rho A S^T S, or in the proportions of its diagonal (Hinton, Rock, Zienkiewicz 1976).
static inline void own_mass(double M[4][4], const ancf_element* el) {
    memset(M, 0, 16 * sizeof(double));
    const double L = el->length;
    for (int p = 0; p < 5; ++p) {
        const double z = gauss5_xi[p];
        double S[4] = {(1 - z) * (1 - z) * (1 + 2 * z), L * z * (1 - z) * (1 - z), z * z * (3 - 2 * z),
                       -L * z * z * (1 - z)};
        for (int i = 0; i < 4; ++i)
            for (int j = 0; j < 4; ++j) M[i][j] += gauss5_weight[p] * el->rho_a * L * S[i] * S[j];
    }
    if (!(el->kind & (ANCF_LUMPED | ANCF_SPRING))) return;
    const double factor = el->rho_a * L / (M[0][0] + M[2][2]);
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) M[i][j] *= i == j ? factor : 0.0;
    if (el->kind & ANCF_SPRING) M[1][1] = M[3][3] = 0.0;
}

// P = sum of M v and H = sum of r x M v, added masses included; *terms the sums of the magnitudes.
static inline void own_momentum(double P[3], double H[3], double terms[2], const built* b) {
    memset(P, 0, 3 * sizeof(double));
    memset(H, 0, 3 * sizeof(double));
    terms[0] = terms[1] = 0.0;
    for (int e = 0; e < b->def.n_elements + b->def.n_nodes; ++e) {
        double M[4][4] = {{0.0}};
        int dof[4] = {0, 0, 0, 0}, n = 4;
        if (e < b->def.n_elements) {
            ancf_model_dofs(dof, b->m, e);
            own_mass(M, &b->element[e]);
        } else {
            dof[0] = e - b->def.n_elements;
            M[0][0] = b->mass[dof[0]];
            n = 1;
        }
        for (int i = 0; i < n; ++i) {
            double p[3] = {0.0, 0.0, 0.0}, r[3];
            for (int c = 0; c < 3; ++c) {
                for (int j = 0; j < n; ++j) p[c] += M[i][j] * b->v[c * b->stride + dof[j]];
                r[c] = b->x[c * b->stride + dof[i]];
                if (i % 2 == 0) {
                    P[c] += p[c];
                    terms[0] += fabs(p[c]);
                }
            }
            for (int c = 0; c < 3; ++c) {
                const int j = (c + 1) % 3, k = (c + 2) % 3;
                H[c] += r[j] * p[k] - r[k] * p[j];
                terms[1] += fabs(r[j] * p[k]) + fabs(r[k] * p[j]);
            }
        }
    }
}

// Leapfrog for a number of steps, from a start with half a kick.
static inline void run_leapfrog(ancf_model* m, double h, int steps, ancf_time* time) {
    time->step = h;
    for (int i = 0; i < steps; ++i) {
        ancf_advance(m, time);
        time->last = h;
    }
}

// The net of the study: 6 x 6 meshes of 0.08 m, 1 mm, 1440 kg/m3.
static inline ancf_element net_element(int kind, double damping) {
    const double E = 4.456e8, r = 5e-4, pi = 3.14159265358979323846, A = pi * r * r;
    return (ancf_element) {.kind = kind,
                           .length = 0.08,
                           .ea = E * A,
                           .ei = E * pi * r * r * r * r / 4.0,
                           .rho_a = 1440.0 * A,
                           .damping = damping};
}

#endif
