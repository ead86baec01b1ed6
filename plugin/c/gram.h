// An element's elastic law on six dot products.
//
// In Legendre polynomials of t = 2 xi - 1 the slope is r' = d + q P1(t)/2 + k P2(t)/2, with its mean d = (r1 - r0)/L,
// q = g1 - g0 and k = g0 + g1 - 2 d of the end slopes g0, g1. All strain and curvature is in the dot products
// G = (d.d, q.q, k.k, d.q, d.k, q.k), whose rates are objective: twice Green's strain is
//     e = sum E_n P_n(t),  E0 = d.d - 1 + q.q/12 + k.k/20, E1 = d.q + q.k/5, E2 = d.k + q.q/6 + k.k/14,
//                          E3 = 3 q.k/10, E4 = 9 k.k/70,
// the axial energy EA L/8 sum E_n^2/(2 n + 1) exactly, and that of |r''| (EI/2L)(q.q + 3 k.k).
#ifndef ANCF_GRAM_H
#define ANCF_GRAM_H

#include "internal.h"

#include <math.h>

enum { ANCF_DD, ANCF_QQ, ANCF_KK, ANCF_DQ, ANCF_DK, ANCF_QK, ANCF_GRAM };

// Parts of E2, E3 and E4 that depend on how the axial energy is integrated: exactly, or by 3 Gauss points, at which P3
// is zero and P4 = -3 P2/4.
typedef struct {
    double kk2, qk3, kk4; // of k.k in E2, of q.k in E3, of k.k in E4
} ancf_rule;

static inline ancf_rule ancf_rule_of(int kind) {
    return kind & ANCF_AXIAL_REDUCED ? (ancf_rule) {-1.0 / 40.0, 0.0, 0.0}
                                     : (ancf_rule) {1.0 / 14.0, 3.0 / 10.0, 9.0 / 70.0};
}

// How bending is counted.
typedef enum { ANCF_STRAIGHT, ANCF_FAST, ANCF_EXACT, ANCF_BENDINGS } ancf_bending;

static inline ancf_bending ancf_bending_of(int kind, bool bending) {
    if (!bending) return ANCF_STRAIGHT;
    return kind & ANCF_CURVATURE_EXACT ? ANCF_EXACT : ANCF_FAST;
}

ANCF_INLINE double ancf_inner(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

ANCF_INLINE void ancf_gram(double G[ANCF_GRAM], const double d[3], const double q[3], const double k[3]) {
    G[ANCF_DD] = ancf_inner(d, d);
    G[ANCF_QQ] = ancf_inner(q, q);
    G[ANCF_KK] = ancf_inner(k, k);
    G[ANCF_DQ] = ancf_inner(d, q);
    G[ANCF_DK] = ancf_inner(d, k);
    G[ANCF_QK] = ancf_inner(q, k);
}

ANCF_INLINE void ancf_gram_rate(double R[ANCF_GRAM], const double d[3], const double q[3], const double k[3],
                                const double dv[3], const double qv[3], const double kv[3]) {
    R[ANCF_DD] = 2.0 * ancf_inner(d, dv);
    R[ANCF_QQ] = 2.0 * ancf_inner(q, qv);
    R[ANCF_KK] = 2.0 * ancf_inner(k, kv);
    R[ANCF_DQ] = ancf_inner(d, qv) + ancf_inner(q, dv);
    R[ANCF_DK] = ancf_inner(d, kv) + ancf_inner(k, dv);
    R[ANCF_QK] = ancf_inner(q, kv) + ancf_inner(k, qv);
}

// one: 1, or 0 to get the rates of E from that of G.
ANCF_INLINE void ancf_strains(double E[5], const double G[ANCF_GRAM], const ancf_rule* rule, double one) {
    E[0] = (G[ANCF_DD] - one) + ((1.0 / 12.0) * G[ANCF_QQ] + (1.0 / 20.0) * G[ANCF_KK]);
    E[1] = G[ANCF_DQ] + (1.0 / 5.0) * G[ANCF_QK];
    E[2] = G[ANCF_DK] + ((1.0 / 6.0) * G[ANCF_QQ] + rule->kk2 * G[ANCF_KK]);
    E[3] = rule->qk3 * G[ANCF_QK];
    E[4] = rule->kk4 * G[ANCF_KK];
}

// Axial energy.
ANCF_INLINE double ancf_axial_energy(const double G[ANCF_GRAM], const ancf_rule* rule, double ea_length) {
    double E[5];
    ancf_strains(E, G, rule, 1.0);
    return 0.5 * ea_length *
           (E[0] * E[0] + E[1] * E[1] / 3.0 + E[2] * E[2] / 5.0 + E[3] * E[3] / 7.0 + E[4] * E[4] / 9.0);
}

// h = its derivatives by G, or their rates.
ANCF_INLINE void ancf_axial(double h[ANCF_GRAM], const double G[ANCF_GRAM], const ancf_rule* rule, double ea_length,
                            double one) {
    double E[5];
    ancf_strains(E, G, rule, one);
    E[0] *= ea_length;
    E[1] *= ea_length * (1.0 / 3.0);
    E[2] *= ea_length * (1.0 / 5.0);
    h[ANCF_DD] = E[0];
    h[ANCF_DQ] = E[1];
    h[ANCF_DK] = E[2];
    h[ANCF_QQ] = (1.0 / 12.0) * E[0] + (1.0 / 6.0) * E[2];
    h[ANCF_KK] = (1.0 / 20.0) * E[0] + rule->kk2 * E[2] + (1.0 / 9.0) * rule->kk4 * (ea_length * E[4]);
    h[ANCF_QK] = (1.0 / 5.0) * E[1] + (1.0 / 7.0) * rule->qk3 * (ea_length * E[3]);
}

static const double ancf_gauss3_t[3] = {-0.77459666924148338, 0.0, 0.77459666924148338};
static const double ancf_gauss3_weight[3] = {5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0};

// Square of L kappa below which its direction is noise.
static const double ancf_tiny_curvature2 = 1e-18;

// P = r'.r', R = r'.L r'' and Q = L^2 r''.r'' at a place t, from G, or their rates from its rate; the curvature
// kappa = |r' x r''|/|r'|^2 there is (L kappa)^2 = (Q P - R^2)/P^2.
ANCF_INLINE void ancf_at_place(double* P, double* R, double* Q, const double G[ANCF_GRAM], double t) {
    const double a = 0.5 * t, b = 0.25 * (3.0 * t * t - 1.0), s = 3.0 * t;
    *P = G[ANCF_DD] + a * a * G[ANCF_QQ] + b * b * G[ANCF_KK] +
         2.0 * (a * G[ANCF_DQ] + b * G[ANCF_DK] + a * b * G[ANCF_QK]);
    *R = G[ANCF_DQ] + s * G[ANCF_DK] + a * G[ANCF_QQ] + (s * a + b) * G[ANCF_QK] + s * b * G[ANCF_KK];
    *Q = G[ANCF_QQ] + s * s * G[ANCF_KK] + 2.0 * s * G[ANCF_QK];
}

#endif
