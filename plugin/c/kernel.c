#include "kernel.h"
#include "gram.h"
#include "lanes.h"

#include <float.h>

// Damping of the fast curvature, by its rate along its own direction at 2 Gauss points (exact for a linear r''), where
// L r'' = q -+ sqrt(3) k: a rigid rotation turns r'' but has no such rate.
ANCF_INLINE void damp_fast(double h[ANCF_GRAM], const double G[ANCF_GRAM], const double rate[ANCF_GRAM],
                           double ei_eta) {
    const double root3 = 1.7320508075688772;
    double q[2];
    for (int p = 0; p < 2; ++p) {
        const double s = p ? root3 : -root3, kk = G[ANCF_QQ] + 3.0 * G[ANCF_KK] + 2.0 * s * G[ANCF_QK],
                     kv = 0.5 * (rate[ANCF_QQ] + 3.0 * rate[ANCF_KK]) + s * rate[ANCF_QK];
        q[p] = 0.25 * ei_eta * kv / ((kk > 0.0 ? kk : 0.0) + ancf_tiny_curvature2);
    }
    h[ANCF_QQ] += q[0] + q[1];
    h[ANCF_KK] += 3.0 * (q[0] + q[1]);
    h[ANCF_QK] += 2.0 * root3 * (q[1] - q[0]);
}

// EI/2 int kappa^2 ds at 3 Gauss points, `elastic` times, with its Kelvin-Voigt term.
ANCF_INLINE void bend_exact(double h[ANCF_GRAM], const double G[ANCF_GRAM], const double rate[ANCF_GRAM], double ei,
                            double eta, int damped, double elastic) {
    for (int p = 0; p < 3; ++p) {
        const double t = ancf_gauss3_t[p], a = 0.5 * t, b = 0.25 * (3.0 * t * t - 1.0), s = 3.0 * t;
        double P, R, Q;
        ancf_at_place(&P, &R, &Q, G, t);
        const double inv = 1.0 / P, part = R * inv;
        double qP = inv * inv * (2.0 * R * part - Q), qR = -2.0 * inv * part, qQ = inv, factor = 0.5 * elastic;
        if (damped) {
            double Pv, Rv, Qv;
            ancf_at_place(&Pv, &Rv, &Qv, rate, t);
            const double q = inv * (Q - R * part), along = qP * Pv + qR * Rv + qQ * Qv;
            factor += 0.25 * eta * along / ((q > 0.0 ? q : 0.0) + ancf_tiny_curvature2);
        }
        factor *= ancf_gauss3_weight[p] * ei;
        qP *= factor;
        qR *= factor;
        qQ *= factor;
        h[ANCF_DD] += qP;
        h[ANCF_QQ] += a * a * qP + a * qR + qQ;
        h[ANCF_KK] += b * b * qP + s * b * qR + s * s * qQ;
        h[ANCF_DQ] += 2.0 * a * qP + qR;
        h[ANCF_DK] += 2.0 * b * qP + s * qR;
        h[ANCF_QK] += 2.0 * a * b * qP + (s * a + b) * qR + 2.0 * s * qQ;
    }
}

// d, q and k of an element from its way and end slopes, or their rates.
ANCF_INLINE void vectors_of(double d[3], double q[3], double k[3], const double* const way[3],
                            const double* const g0[3], const double* const g1[3], const double* inv_length, int e) {
    for (int c = 0; c < 3; ++c) {
        d[c] = way[c][e] * inv_length[e];
        q[c] = g1[c][e] - g0[c][e];
        k[c] = g1[c][e] + g0[c][e] - 2.0 * d[c];
    }
}

// Forces of an element by the derivatives h.
ANCF_INLINE void forces_of(const ancf_fields* K, int e, const double h[ANCF_GRAM], const double d[3], const double q[3],
                           const double k[3]) {
    for (int c = 0; c < 3; ++c) {
        const double on_d = 2.0 * h[ANCF_DD] * d[c] + h[ANCF_DQ] * q[c] + h[ANCF_DK] * k[c],
                     on_q = 2.0 * h[ANCF_QQ] * q[c] + h[ANCF_DQ] * d[c] + h[ANCF_QK] * k[c],
                     on_k = 2.0 * h[ANCF_KK] * k[c] + h[ANCF_DK] * d[c] + h[ANCF_QK] * q[c];
        K->fd[c][e] = K->inv_length[e] * (2.0 * on_k - on_d);
        K->f0[c][e] = on_q - on_k;
        K->f1[c][e] = -(on_q + on_k);
    }
}

ANCF_INLINE int points_of(int strain) { return strain == ANCF_STRETCH_REDUCED ? 3 : 5; }

// (L kappa)^2 at the 3 Gauss points, with their weights.
ANCF_INLINE double exact_curvature2(const double G[ANCF_GRAM]) {
    double sum = 0.0;
    for (int p = 0; p < 3; ++p) {
        double P, R, Q;
        ancf_at_place(&P, &R, &Q, G, ancf_gauss3_t[p]);
        const double q = (Q - R * R / P) / P; // not below 0 but by rounding
        sum += ancf_gauss3_weight[p] * (q > 0.0 ? q : 0.0);
    }
    return sum;
}

ANCF_INLINE double axial_of(const double G[ANCF_GRAM], const ancf_rule* rule, int strain, double ea) {
    return strain == ANCF_GREEN ? ancf_axial_energy(G, rule, ea) : ancf_stretch_energy(G, points_of(strain), ea);
}

ANCF_INLINE double bent_of(const double G[ANCF_GRAM], int bending, double ei) {
    if (bending == ANCF_STRAIGHT) return 0.0;
    return 0.5 * ei * (bending == ANCF_FAST ? G[ANCF_QQ] + 3.0 * G[ANCF_KK] : exact_curvature2(G));
}

// Of a tile's room, of which n are taken.
ANCF_INLINE double sum_of(double a[ANCF_TILE], int n) {
    ancf_lanes sum = {0.0};
    for (int e = n; e % ANCF_LANES; ++e) a[e] = 0.0;
    for (int e = 0; e < n; e += ANCF_LANES) sum += ancf_lanes_at(a + e);
    return ancf_lanes_sum(&sum);
}

// What single elements store and what their Kelvin-Voigt forces do, summed up after a loop, so that this stays one lane
// each; and where those forces are put.
typedef struct {
    double stored[ANCF_TILE], power[ANCF_TILE];
    ancf_fields slow;
} books;

ANCF_INLINE void open_books(books* to, const ancf_account* account, const ancf_fields* fields) {
    to->slow = *fields;
    for (int c = 0; c < 3; ++c) {
        to->slow.f0[c] = account->f0[c];
        to->slow.f1[c] = account->f1[c];
        to->slow.fd[c] = account->fd[c];
    }
}

ANCF_INLINE void close_books(ancf_account* account, books* from, int damped) {
    account->elastic = sum_of(from->stored, from->slow.n);
    account->power = damped ? sum_of(from->power, from->slow.n) : 0.0;
}

ANCF_INLINE void book(books* to, int e, const double d[3], const double q[3], const double k[3],
                      const double G[ANCF_GRAM], const double rate[ANCF_GRAM], const ancf_rule* rule, int strain,
                      int bending, int damped) {
    const double ea = to->slow.ea[e], ei = to->slow.ei[e], eta = to->slow.eta[e];
    double h[ANCF_GRAM], power = 0.0;
    to->stored[e] = axial_of(G, rule, strain, ea) + bent_of(G, bending, ei);
    if (!damped) return;
    if (strain == ANCF_GREEN) ancf_axial(h, rate, rule, ea * eta, 0.0);
    else ancf_stretch(h, G, rate, points_of(strain), ea, eta, damped, 0.0);
    if (bending == ANCF_FAST) damp_fast(h, G, rate, ei * eta);
    if (bending == ANCF_EXACT) bend_exact(h, G, rate, ei, eta, damped, 0.0);
    forces_of(&to->slow, e, h, d, q, k);
    for (int i = 0; i < ANCF_GRAM; ++i) power -= h[i] * rate[i];
    to->power[e] = power;
}

// Forces, and the books if they are wanted.
ANCF_INLINE void beam(ancf_account* account, const ancf_fields* fields, const ancf_rule* of, int strain, int bending,
                      int damped) {
    const ancf_fields K = *fields;
    const ancf_rule rule = *of;
    books all;
    if (account) open_books(&all, account, fields);
#pragma GCC ivdep
    for (int e = 0; e < K.n; ++e) {
        double d[3], q[3], k[3], G[ANCF_GRAM], at[ANCF_GRAM], rate[ANCF_GRAM] = {0.0}, h[ANCF_GRAM];
        vectors_of(d, q, k, K.way, K.g0, K.g1, K.inv_length, e);
        ancf_gram(G, d, q, k);
        for (int i = 0; i < ANCF_GRAM; ++i) at[i] = G[i];
        if (damped) {
            double dv[3], qv[3], kv[3];
            vectors_of(dv, qv, kv, K.wayv, K.g0v, K.g1v, K.inv_length, e);
            ancf_gram_rate(rate, d, q, k, dv, qv, kv);
            for (int i = 0; i < ANCF_GRAM; ++i) at[i] += K.eta[e] * rate[i];
        }
        if (strain == ANCF_GREEN) ancf_axial(h, at, &rule, K.ea[e], 1.0);
        else ancf_stretch(h, G, rate, points_of(strain), K.ea[e], K.eta[e], damped, 1.0);
        if (bending == ANCF_FAST) {
            h[ANCF_QQ] += 0.5 * K.ei[e];
            h[ANCF_KK] += 1.5 * K.ei[e];
            if (damped) damp_fast(h, G, rate, K.ei[e] * K.eta[e]);
        }
        if (bending == ANCF_EXACT) bend_exact(h, G, rate, K.ei[e], K.eta[e], damped, 1.0);
        forces_of(&K, e, h, d, q, k);
        if (account) book(&all, e, d, q, k, G, rate, &rule, strain, bending, damped);
    }
    if (account) close_books(account, &all, damped);
}

// The books alone.
ANCF_INLINE void book_beams(ancf_account* account, const ancf_fields* fields, const ancf_rule* of, int strain,
                            int bending, int damped) {
    const ancf_fields K = *fields;
    const ancf_rule rule = *of;
    books all;
    open_books(&all, account, fields);
#pragma GCC ivdep
    for (int e = 0; e < K.n; ++e) {
        double d[3], q[3], k[3], G[ANCF_GRAM], rate[ANCF_GRAM] = {0.0};
        vectors_of(d, q, k, K.way, K.g0, K.g1, K.inv_length, e);
        ancf_gram(G, d, q, k);
        if (damped) {
            double dv[3], qv[3], kv[3];
            vectors_of(dv, qv, kv, K.wayv, K.g0v, K.g1v, K.inv_length, e);
            ancf_gram_rate(rate, d, q, k, dv, qv, kv);
        }
        book(&all, e, d, q, k, G, rate, &rule, strain, bending, damped);
    }
    close_books(account, &all, damped);
}

// Forces with the books in one loop, where the compiler rounds the forces there as it does without (test_advance.c,
// test_sets.c): products that both have in common it may contract otherwise.
ANCF_INLINE void beam_booked(ancf_account* account, const ancf_fields* fields, const ancf_rule* rule, int strain,
                             int bending, int damped) {
    const int together = strain == ANCF_GREEN && bending != ANCF_EXACT;
    beam(together ? account : NULL, fields, rule, strain, bending, damped);
    if (!together) book_beams(account, fields, rule, strain, bending, damped);
}

// One function per combination that a scene can have, so that none computes what it does not need.
#define ANCF_BEAM_KERNEL(name, strain, bending, damped)                                                                \
    ANCF_CLONES static void name(const ancf_fields* fields, const ancf_rule* rule) {                                   \
        beam(NULL, fields, rule, strain, bending, damped);                                                             \
    }                                                                                                                  \
    ANCF_CLONES static void booked_##name(ancf_account* account, const ancf_fields* fields, const ancf_rule* rule) {   \
        beam_booked(account, fields, rule, strain, bending, damped);                                                   \
    }
#define ANCF_BEAM_KERNELS(name, strain)                                                                                \
    ANCF_BEAM_KERNEL(name##_straight, strain, ANCF_STRAIGHT, 0)                                                        \
    ANCF_BEAM_KERNEL(name##_straight_damped, strain, ANCF_STRAIGHT, 1)                                                 \
    ANCF_BEAM_KERNEL(name##_fast, strain, ANCF_FAST, 0)                                                                \
    ANCF_BEAM_KERNEL(name##_fast_damped, strain, ANCF_FAST, 1)                                                         \
    ANCF_BEAM_KERNEL(name##_exact, strain, ANCF_EXACT, 0)                                                              \
    ANCF_BEAM_KERNEL(name##_exact_damped, strain, ANCF_EXACT, 1)
ANCF_BEAM_KERNELS(green, ANCF_GREEN)
ANCF_BEAM_KERNELS(stretch, ANCF_STRETCH)
ANCF_BEAM_KERNELS(stretch_reduced, ANCF_STRETCH_REDUCED)

// Functions of a name, in the order of kernel_number().
#define ANCF_OF_STRAIN(name)                                                                                           \
    name##_straight, name##_straight_damped, name##_fast, name##_fast_damped, name##_exact, name##_exact_damped
#define ANCF_OF_STRAINS(prefix)                                                                                        \
    ANCF_OF_STRAIN(prefix##green), ANCF_OF_STRAIN(prefix##stretch), ANCF_OF_STRAIN(prefix##stretch_reduced)
enum { KERNELS = ANCF_STRAINS * ANCF_BENDINGS * 2 };

static int kernel_number(int kind, bool bending, bool damped) {
    return 2 * ((int)ancf_strain_of(kind) * ANCF_BENDINGS + (int)ancf_bending_of(kind, bending)) + damped;
}

// Tension-only spring and damper, k = EA/dl (Eq. 1), engineering strain |d| - 1.
ANCF_INLINE void spring_of(ancf_account* account, const ancf_fields* fields, int booked) {
    const ancf_fields K = *fields;
    ancf_account slow = {0};
    double stored[ANCF_TILE], power[ANCF_TILE];
    if (booked) slow = *account;
#pragma GCC ivdep
    for (int e = 0; e < K.n; ++e) {
        double d[3], dv[3];
        for (int c = 0; c < 3; ++c) {
            d[c] = K.way[c][e] * K.inv_length[e];
            dv[c] = K.wayv[c][e] * K.inv_length[e];
        }
        const double stretch = sqrt(ancf_inner(d, d)), taut = stretch > 1.0 ? 1.0 : 0.0;
        const double inv = 1.0 / (stretch + DBL_MIN);
        const double ea = 4.0 * K.ea[e] * K.inv_length[e];
        const double tension = ea * (stretch - 1.0 + K.eta[e] * ancf_inner(d, dv) * inv);
        const double pull = -taut * inv * (tension > 0.0 ? tension : 0.0);
        for (int c = 0; c < 3; ++c) {
            K.f0[c][e] = 0.0;
            K.f1[c][e] = 0.0;
            K.fd[c][e] = pull * d[c];
        }
        if (!booked) continue;
        const double strain = taut * (stretch - 1.0), slack = -ea * strain,
                     viscous = ea * K.eta[e] * ancf_inner(d, dv) * inv,
                     against = -taut * inv * (viscous > slack ? viscous : slack); // it never pushes
        stored[e] = 2.0 * K.ea[e] * strain * strain;
        power[e] = 0.0;
        for (int c = 0; c < 3; ++c) {
            slow.f0[c][e] = 0.0;
            slow.f1[c][e] = 0.0;
            slow.fd[c][e] = against * d[c];
            power[e] += against * d[c] * K.wayv[c][e];
        }
    }
    if (!booked) return;
    account->elastic = sum_of(stored, K.n);
    account->power = sum_of(power, K.n);
}

ANCF_CLONES static void spring(const ancf_fields* fields) { spring_of(NULL, fields, 0); }

ANCF_CLONES static void booked_spring(ancf_account* account, const ancf_fields* fields) {
    spring_of(account, fields, 1);
}

void ancf_kernel(const ancf_fields* fields, int kind, bool bending, bool damped) {
    if (kind & ANCF_SPRING) {
        spring(fields);
        return;
    }
    static void (*const beams[KERNELS])(const ancf_fields*, const ancf_rule*) = {ANCF_OF_STRAINS()};
    const ancf_rule rule = ancf_rule_of(kind);
    beams[kernel_number(kind, bending, damped)](fields, &rule);
}

void ancf_kernel_booked(ancf_account* account, const ancf_fields* fields, int kind, bool bending, bool damped) {
    if (kind & ANCF_SPRING) {
        booked_spring(account, fields);
        return;
    }
    static void (*const beams[KERNELS])(ancf_account*, const ancf_fields*,
                                        const ancf_rule*) = {ANCF_OF_STRAINS(booked_)};
    const ancf_rule rule = ancf_rule_of(kind);
    beams[kernel_number(kind, bending, damped)](account, fields, &rule);
}

ANCF_INLINE void energy_of(ancf_energies* energy, const ancf_fields* fields, const ancf_rule* by, int strain,
                           int bending) {
    const ancf_fields K = *fields;
    const ancf_rule rule = *by;
    double axial[ANCF_TILE], bent[ANCF_TILE];
#pragma GCC ivdep
    for (int e = 0; e < K.n; ++e) {
        double d[3], q[3], k[3], G[ANCF_GRAM];
        vectors_of(d, q, k, K.way, K.g0, K.g1, K.inv_length, e);
        ancf_gram(G, d, q, k);
        axial[e] = axial_of(G, &rule, strain, K.ea[e]);
        bent[e] = bent_of(G, bending, K.ei[e]);
    }
    *energy = (ancf_energies) {sum_of(axial, K.n), sum_of(bent, K.n)};
}

#define ANCF_ENERGY(name, strain, bending)                                                                             \
    ANCF_CLONES static void name(ancf_energies* energy, const ancf_fields* fields, const ancf_rule* rule) {            \
        energy_of(energy, fields, rule, strain, bending);                                                              \
    }
#define ANCF_ENERGIES(name, strain)                                                                                    \
    ANCF_ENERGY(name##_straight, strain, ANCF_STRAIGHT)                                                                \
    ANCF_ENERGY(name##_fast, strain, ANCF_FAST)                                                                        \
    ANCF_ENERGY(name##_exact, strain, ANCF_EXACT)
ANCF_ENERGIES(energy_green, ANCF_GREEN)
ANCF_ENERGIES(energy_stretch, ANCF_STRETCH)
ANCF_ENERGIES(energy_stretch_reduced, ANCF_STRETCH_REDUCED)

ANCF_CLONES static void energy_spring(ancf_energies* energy, const ancf_fields* fields) {
    const ancf_fields K = *fields;
    double axial[ANCF_TILE];
    for (int e = 0; e < K.n; ++e) {
        double d[3];
        for (int c = 0; c < 3; ++c) d[c] = K.way[c][e] * K.inv_length[e];
        const double stretch = sqrt(ancf_inner(d, d)), strain = stretch > 1.0 ? stretch - 1.0 : 0.0;
        axial[e] = 2.0 * K.ea[e] * strain * strain;
    }
    *energy = (ancf_energies) {.axial = sum_of(axial, K.n)};
}

void ancf_kernel_energy(ancf_energies* energy, const ancf_fields* fields, int kind, bool bending) {
    if (kind & ANCF_SPRING) {
        energy_spring(energy, fields);
        return;
    }
    static void (*const beams[ANCF_STRAINS * ANCF_BENDINGS])(ancf_energies*, const ancf_fields*, const ancf_rule*) = {
        energy_green_straight,           energy_green_fast,           energy_green_exact,
        energy_stretch_straight,         energy_stretch_fast,         energy_stretch_exact,
        energy_stretch_reduced_straight, energy_stretch_reduced_fast, energy_stretch_reduced_exact};
    const ancf_rule rule = ancf_rule_of(kind);
    beams[kernel_number(kind, bending, false) / 2](energy, fields, &rule);
}

ANCF_CLONES void ancf_kernel_power(double* power, const ancf_fields* fields) {
    const ancf_fields K = *fields;
    ancf_lanes sum[3] = {{0.0}, {0.0}, {0.0}};
    double rest = 0.0;
    int e = 0;
    for (; e + ANCF_LANES <= K.n; e += ANCF_LANES)
        for (int c = 0; c < 3; ++c)
            sum[c] += ancf_lanes_at(K.fd[c] + e) * ancf_lanes_at(K.wayv[c] + e) +
                      ancf_lanes_at(K.f0[c] + e) * ancf_lanes_at(K.g0v[c] + e) +
                      ancf_lanes_at(K.f1[c] + e) * ancf_lanes_at(K.g1v[c] + e);
    for (; e < K.n; ++e)
        for (int c = 0; c < 3; ++c)
            rest += K.fd[c][e] * K.wayv[c][e] + K.f0[c][e] * K.g0v[c][e] + K.f1[c][e] * K.g1v[c][e];
    sum[0] += sum[1] + sum[2];
    *power = ancf_lanes_sum(sum) + rest;
}
