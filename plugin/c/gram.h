// An element's elastic law on six dot products.
//
// In Legendre polynomials of t = 2 xi - 1 the slope is r' = d + q P1(t)/2 + k P2(t)/2, with its mean d = (r1 - r0)/L,
// q = g1 - g0 and k = g0 + g1 - 2 d of the end slopes g0, g1. All strain and curvature is in the dot products
// G = (d.d, q.q, k.k, d.q, d.k, q.k), whose rates are objective: twice Green's strain is
//     e = sum E_n P_n(t),  E0 = d.d - 1 + q.q/12 + k.k/20, E1 = d.q + q.k/5, E2 = d.k + q.q/6 + k.k/14,
//                          E3 = 3 q.k/10, E4 = 9 k.k/70,
// the axial energy EA L/8 sum E_n^2/(2 n + 1) exactly, and that of |r''| (EI/2L)(q.q + 3 k.k).
//
// With engineering strain |r'| - 1 the axial energy EA L/2 int (|r'| - 1)^2 is no polynomial: its Gauss points are 5,
// or 3 where it is reduced.
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
           (E[0] * E[0] + (1.0 / 3.0) * (E[1] * E[1]) + (1.0 / 5.0) * (E[2] * E[2]) + (1.0 / 7.0) * (E[3] * E[3]) +
            (1.0 / 9.0) * (E[4] * E[4]));
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

// How axial strain is counted.
typedef enum { ANCF_GREEN, ANCF_STRETCH, ANCF_STRETCH_REDUCED, ANCF_STRAINS } ancf_strain_kind;

static inline ancf_strain_kind ancf_strain_of(int kind) {
    if (!(kind & ANCF_ENGINEERING)) return ANCF_GREEN;
    return kind & ANCF_AXIAL_REDUCED ? ANCF_STRETCH_REDUCED : ANCF_STRETCH;
}

static const double ancf_gauss5_t[5] = {-0.90617984593866399280, -0.53846931010568309104, 0.0, 0.53846931010568309104,
                                        0.90617984593866399280};
static const double ancf_gauss5_weight[5] = {0.11846344252809454376, 0.23931433524968323402, 0.28444444444444444444,
                                             0.23931433524968323402, 0.11846344252809454376};
static const double ancf_gauss3_t[3] = {-0.77459666924148338, 0.0, 0.77459666924148338};
static const double ancf_gauss3_weight[3] = {5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0};

// Square of L kappa below which its direction is noise.
static const double ancf_tiny_curvature2 = 1e-18;

// Square of |r'| below which it has no direction.
static const double ancf_tiny_stretch2 = 1e-16;

// P = r'.r' at a place t from G, or its rate from G's.
ANCF_INLINE double ancf_stretch2(const double G[ANCF_GRAM], double t) {
    const double a = 0.5 * t, b = 0.25 * (3.0 * t * t - 1.0);
    return G[ANCF_DD] + a * a * G[ANCF_QQ] + b * b * G[ANCF_KK] +
           2.0 * (a * G[ANCF_DQ] + b * G[ANCF_DK] + a * b * G[ANCF_QK]);
}

// The larger of it and what still has a direction.
ANCF_INLINE double ancf_with_direction(double stretch2) {
    return stretch2 > ancf_tiny_stretch2 ? stretch2 : ancf_tiny_stretch2;
}

// Adds what a derivative by P at a place t is by G.
ANCF_INLINE void ancf_by_stretch2(double h[ANCF_GRAM], double by_p, double t) {
    const double a = 0.5 * t, b = 0.25 * (3.0 * t * t - 1.0);
    h[ANCF_DD] += by_p;
    h[ANCF_QQ] += a * a * by_p;
    h[ANCF_KK] += b * b * by_p;
    h[ANCF_DQ] += 2.0 * a * by_p;
    h[ANCF_DK] += 2.0 * b * by_p;
    h[ANCF_QK] += 2.0 * a * b * by_p;
}

// Axial energy of engineering strain.
ANCF_INLINE double ancf_stretch_energy(const double G[ANCF_GRAM], int points, double ea_length) {
    const double *t = points == 3 ? ancf_gauss3_t : ancf_gauss5_t,
                 *weight = points == 3 ? ancf_gauss3_weight : ancf_gauss5_weight;
    double sum = 0.0;
    for (int p = 0; p < points; ++p) {
        const double strain = sqrt(ancf_with_direction(ancf_stretch2(G, t[p]))) - 1.0;
        sum += weight[p] * strain * strain;
    }
    return 2.0 * ea_length * sum;
}

// h = `elastic` times its derivatives by G, and those of its Kelvin-Voigt term.
ANCF_INLINE void ancf_stretch(double h[ANCF_GRAM], const double G[ANCF_GRAM], const double rate[ANCF_GRAM], int points,
                              double ea_length, double eta, int damped, double elastic) {
    const double *t = points == 3 ? ancf_gauss3_t : ancf_gauss5_t,
                 *weight = points == 3 ? ancf_gauss3_weight : ancf_gauss5_weight;
    for (int i = 0; i < ANCF_GRAM; ++i) h[i] = 0.0;
    for (int p = 0; p < points; ++p) {
        const double square = ancf_with_direction(ancf_stretch2(G, t[p])), inv = 1.0 / sqrt(square);
        double part = elastic * (1.0 - inv);
        if (damped) part += 0.5 * eta * ancf_stretch2(rate, t[p]) * inv * inv;
        ancf_by_stretch2(h, 2.0 * weight[p] * ea_length * part, t[p]);
    }
}

// P = r'.r', R = r'.L r'' and Q = L^2 r''.r'' at a place t, from G, or their rates from its rate; the curvature
// kappa = |r' x r''|/|r'|^2 there is (L kappa)^2 = (Q P - R^2)/P^2.
ANCF_INLINE void ancf_at_place(double* P, double* R, double* Q, const double G[ANCF_GRAM], double t) {
    const double a = 0.5 * t, b = 0.25 * (3.0 * t * t - 1.0), s = 3.0 * t;
    *P = ancf_stretch2(G, t);
    *R = G[ANCF_DQ] + s * G[ANCF_DK] + a * G[ANCF_QQ] + (s * a + b) * G[ANCF_QK] + s * b * G[ANCF_KK];
    *Q = G[ANCF_QQ] + s * s * G[ANCF_KK] + 2.0 * s * G[ANCF_QK];
}

#endif
