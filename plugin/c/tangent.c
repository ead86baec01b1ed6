#include "ancf/tangent.h"
#include "ancf/shape.h"
#include "gram.h"

#include <float.h>
#include <math.h>

// At a point of the element the strains depend on r' and k = L r'', which are sums over q = (g0, d, g1) with the
// weights s and t of shape.h. A second derivative A over r' (symmetric, 3x3) so adds s_i s_j A to the block (i, j) of
// the tangent, and one over k adds t_i t_j A.

// Elements side by side: one in each lane of a vector, as wide as the widest that a machine may have.
enum { LANES = 8 };
typedef double lane __attribute__((vector_size(LANES * sizeof(double))));
typedef long long lane_mask __attribute__((vector_size(LANES * sizeof(double))));

// A symmetric 3x3 matrix as (xx xy xz yy yz zz).
enum { XX, XY, XZ, YY, YZ, ZZ };

// The pairs (i, j) of q: the three diagonal ones, then (g0, d), (g0, g1), (d, g1).
static const int first_of[6] = {0, 1, 2, 0, 0, 1}, second_of[6] = {0, 1, 2, 1, 2, 2};

static const lane zero;

ANCF_INLINE lane dot_lanes(const lane a[3], const lane b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

// The blocks of elements: what is symmetric in each of the six pairs, and the whole of what is not.
typedef struct {
    lane symmetric[6][6];
    lane full[3][9];
} blocks;

// A = factor (a b^T + b a^T + add I).
ANCF_INLINE void dyad(lane A[6], lane factor, const lane a[3], const lane b[3], lane add) {
    A[XX] = factor * (2.0 * a[0] * b[0] + add);
    A[XY] = factor * (a[0] * b[1] + a[1] * b[0]);
    A[XZ] = factor * (a[0] * b[2] + a[2] * b[0]);
    A[YY] = factor * (2.0 * a[1] * b[1] + add);
    A[YZ] = factor * (a[1] * b[2] + a[2] * b[1]);
    A[ZZ] = factor * (2.0 * a[2] * b[2] + add);
}

// Adds w_i w_j A to every pair.
ANCF_INLINE void add_point(blocks* K, const double w[3], const lane A[6]) {
    for (int p = 0; p < 6; ++p) {
        const double weight = w[first_of[p]] * w[second_of[p]];
        for (int k = 0; k < 6; ++k) K->symmetric[p][k] += weight * A[k];
    }
}

ANCF_INLINE void combine(lane sum[3], const double w[3], const lane g0[3], const lane d[3], const lane g1[3]) {
    for (int c = 0; c < 3; ++c) sum[c] = w[0] * g0[c] + w[1] * d[c] + w[2] * g1[c];
}

// Gauss points on [0, 1].
static const double gauss3_xi[3] = {0.5 - 0.38729833462074170, 0.5, 0.5 + 0.38729833462074170};
static const double gauss5_xi[5] = {0.5 - 0.45308992296933199640, 0.5 - 0.26923465505284154552, 0.5,
                                    0.5 + 0.26923465505284154552, 0.5 + 0.45308992296933199640};

// An element's (g0, d, g1) and their rates.
typedef struct {
    lane g0[3], d[3], g1[3], g0v[3], dv[3], g1v[3];
} vectors;

// What all elements of a call have in common.
typedef struct {
    double rate;     // dv/dx [1/s]
    double geometry; // 1, or 0 if what may be indefinite is left out
    lane_mask all;   // compressed places count as well
} rules;

// |r'|, or the least that has a direction.
ANCF_INLINE lane stretch_of(lane square) {
    for (int l = 0; l < LANES; ++l) square[l] = sqrt(ancf_with_direction(square[l]));
    return square;
}

// At a point: r' and its rate, Green's strain. The stress is eps + eta r'.dr'/dt.
ANCF_INLINE void green_point(lane A[6], const lane r[3], const lane rv[3], lane factor, lane eta, const rules* by,
                             int damped) {
    lane h[3], stress = 0.5 * (dot_lanes(r, r) - 1.0);
    for (int c = 0; c < 3; ++c) h[c] = 0.5 * r[c];
    if (damped) {
        stress += eta * dot_lanes(r, rv);
        for (int c = 0; c < 3; ++c) h[c] += 0.5 * eta * (by->rate * r[c] + by->geometry * rv[c]);
    }
    dyad(A, factor, r, h, (lane)((lane_mask)stress & ((stress > 0.0) | by->all)));
}

// The same with engineering strain: the force EA (|r'| - 1 + eta d|r'|/dt) is along r'.
ANCF_INLINE void stretch_point(lane A[6], const lane r[3], const lane rv[3], lane factor, lane eta, const rules* by,
                               int damped) {
    const lane stretch = stretch_of(dot_lanes(r, r)), inv = 1.0 / stretch;
    lane n[3], h[3], stress = stretch - 1.0, along = zero;
    for (int c = 0; c < 3; ++c) n[c] = inv * r[c];
    if (damped) {
        along = dot_lanes(n, rv);
        stress += eta * along;
    }
    stress = inv * (lane)((lane_mask)stress & ((stress > 0.0) | by->all));
    for (int c = 0; c < 3; ++c) {
        h[c] = 0.5 * (1.0 - stress) * n[c];
        if (damped) h[c] += 0.5 * eta * (by->rate * n[c] + by->geometry * inv * (rv[c] - along * n[c]));
    }
    dyad(A, factor, n, h, stress);
}

// Axial energy EA L/2 int eps^2.
ANCF_INLINE void axial_tangent(blocks* K, const vectors* q, lane ea, lane eta, const rules* by, int strain, int points,
                               int damped) {
    const double *xi = points == 3 ? gauss3_xi : gauss5_xi,
                 *weight = points == 3 ? ancf_gauss3_weight : ancf_gauss5_weight;
    for (int p = 0; p < points; ++p) {
        double s[3];
        lane r[3], rv[3], A[6];
        ancf_shape_slope(s, xi[p]);
        combine(r, s, q->g0, q->d, q->g1);
        if (damped) combine(rv, s, q->g0v, q->dv, q->g1v);
        if (strain == ANCF_GREEN) green_point(A, r, rv, 4.0 * ea * weight[p], eta, by, damped);
        else stretch_point(A, r, rv, 4.0 * ea * weight[p], eta, by, damped);
        add_point(K, s, A);
    }
}

// (EI/L)(2 u.u + 2 v.v + 2 u.v), u = g0 - d, v = g1 - d.
ANCF_INLINE void bend_fast_tangent(blocks* K, lane ei) {
    static const double factor[6] = {4.0, 12.0, 4.0, -6.0, 2.0, -6.0};
    for (int p = 0; p < 6; ++p) {
        K->symmetric[p][XX] += factor[p] * ei;
        K->symmetric[p][YY] += factor[p] * ei;
        K->symmetric[p][ZZ] += factor[p] * ei;
    }
}

// The damping of damp_fast in kernel.c: force -1/2 EI/L eta (k.kv/k.k) w k at 2 Gauss points.
ANCF_INLINE void damp_fast_tangent(blocks* K, const vectors* q, lane ei_eta, const rules* by) {
    const double root3 = 1.7320508075688772;
    for (int p = 0; p < 2; ++p) {
        const double s = p ? root3 : -root3, w[3] = {s - 1.0, -2.0 * s, s + 1.0};
        lane k[3], kv[3], h[3], A[6];
        combine(k, w, q->g0, q->d, q->g1);
        combine(kv, w, q->g0v, q->dv, q->g1v);
        const lane square = dot_lanes(k, k) + ancf_tiny_curvature2, work = dot_lanes(k, kv), share = work / square;
        for (int c = 0; c < 3; ++c) h[c] = 0.5 * (by->rate * k[c] + by->geometry * (kv[c] - 2.0 * share * k[c]));
        dyad(A, 0.5 * ei_eta / square, k, h, by->geometry * work);
        add_point(K, w, A);
    }
}

// Second derivatives of (L kappa)^2 = q = (Q P - R^2)/P^2 over (r', k), with P = r'.r', R = r'.k, Q = k.k; rk row by
// row.
typedef struct {
    lane rr[6], kk[6], rk[9];
} hessian;

ANCF_INLINE void curvature_hessian(hessian* H, const lane r[3], const lane k[3], lane inv, lane R, lane Q) {
    lane u[3], w[3], add[6];
    for (int c = 0; c < 3; ++c) {
        u[c] = (4.0 * Q - 12.0 * R * R) * r[c] + 8.0 * R * k[c];
        w[c] = -r[c];
    }
    dyad(H->kk, inv * inv, r, w, 2.0 / inv);
    dyad(H->rr, inv * inv, r, u, (4.0 * R * R - 2.0 * Q) / inv);
    dyad(add, -inv * inv, k, k, zero);
    for (int i = 0; i < 6; ++i) H->rr[i] += add[i];
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            H->rk[3 * i + j] = inv * inv * (8.0 * R * r[i] * r[j] - 4.0 * r[i] * k[j] - 2.0 * k[i] * r[j]);
    for (int i = 0; i < 9; i += 4) H->rk[i] -= 2.0 * inv * R;
}

// q's gradient over (r', k), as in kernel.c; R and Q over P.
ANCF_INLINE void curvature_gradient(lane qr[3], lane qk[3], const lane r[3], const lane k[3], lane inv, lane R,
                                    lane Q) {
    for (int c = 0; c < 3; ++c) {
        qk[c] = 2.0 * inv * (k[c] - R * r[c]);
        qr[c] = 2.0 * inv * ((2.0 * R * R - Q) * r[c] - R * k[c]);
    }
}

// b = H a over (r', k).
ANCF_INLINE void hessian_times(lane br[3], lane bk[3], const hessian* H, const lane ar[3], const lane ak[3]) {
    static const int place[3][3] = {{XX, XY, XZ}, {XY, YY, YZ}, {XZ, YZ, ZZ}};
    for (int i = 0; i < 3; ++i) {
        br[i] = bk[i] = zero;
        for (int j = 0; j < 3; ++j) {
            br[i] += H->rr[place[i][j]] * ar[j] + H->rk[3 * i + j] * ak[j];
            bk[i] += H->rk[3 * j + i] * ar[j] + H->kk[place[i][j]] * ak[j];
        }
    }
}

// Adds the second derivatives at a point with the weights s over r' and t over k.
ANCF_INLINE void add_hessian(blocks* K, const double s[3], const double t[3], const hessian* H) {
    add_point(K, s, H->rr);
    add_point(K, t, H->kk);
    for (int i = 0; i < 3; ++i) {
        const double w = s[i] * t[i];
        K->symmetric[i][XX] += 2.0 * w * H->rk[0];
        K->symmetric[i][XY] += w * (H->rk[1] + H->rk[3]);
        K->symmetric[i][XZ] += w * (H->rk[2] + H->rk[6]);
        K->symmetric[i][YY] += 2.0 * w * H->rk[4];
        K->symmetric[i][YZ] += w * (H->rk[5] + H->rk[7]);
        K->symmetric[i][ZZ] += 2.0 * w * H->rk[8];
    }
    for (int p = 0; p < 3; ++p) {
        const double st = s[first_of[3 + p]] * t[second_of[3 + p]], ts = t[first_of[3 + p]] * s[second_of[3 + p]];
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) K->full[p][3 * i + j] += st * H->rk[3 * i + j] + ts * H->rk[3 * j + i];
    }
}

// EI/2 int kappa^2 ds and its damping, whose force is -EI/L (1/2 + eta/4 (dq/dt)/q) grad q: bend_exact in kernel.c.
ANCF_INLINE void bend_exact_tangent(blocks* K, const vectors* v, lane ei, lane eta, const rules* by, int damped) {
    for (int p = 0; p < 3; ++p) {
        double s[3], t[3];
        lane r[3], k[3], rr[6] = {0}, kk[6] = {0}, rk[9] = {0};
        hessian H;
        ancf_shape_slope(s, gauss3_xi[p]);
        ancf_shape_curvature(t, gauss3_xi[p]);
        combine(r, s, v->g0, v->d, v->g1);
        combine(k, t, v->g0, v->d, v->g1);
        const lane inv = 1.0 / dot_lanes(r, r), R = dot_lanes(r, k) * inv, Q = dot_lanes(k, k) * inv,
                   factor = ancf_gauss3_weight[p] * ei;
        lane phi = zero + 0.5;
        curvature_hessian(&H, r, k, inv, R, Q);
        if (damped) {
            lane rv[3], kv[3], qr[3], qk[3], hr[3], hk[3];
            combine(rv, s, v->g0v, v->dv, v->g1v);
            combine(kv, t, v->g0v, v->dv, v->g1v);
            curvature_gradient(qr, qk, r, k, inv, R, Q);
            hessian_times(hr, hk, &H, rv, kv);
            const lane share = 1.0 / (Q - R * R + ancf_tiny_curvature2),
                       rate = (dot_lanes(qr, rv) + dot_lanes(qk, kv)) * share;
            phi += 0.25 * eta * by->geometry * rate;
            for (int c = 0; c < 3; ++c) {
                hr[c] = 0.5 * (by->geometry * (hr[c] - rate * qr[c]) + by->rate * qr[c]);
                hk[c] = 0.5 * (by->geometry * (hk[c] - rate * qk[c]) + by->rate * qk[c]);
            }
            const lane damp = 0.25 * eta * share * factor;
            dyad(rr, damp, qr, hr, zero);
            dyad(kk, damp, qk, hk, zero);
            for (int i = 0; i < 3; ++i)
                for (int j = 0; j < 3; ++j) rk[3 * i + j] = damp * (qr[i] * hk[j] + hr[i] * qk[j]);
        }
        for (int i = 0; i < 6; ++i) {
            H.rr[i] = by->geometry * phi * factor * H.rr[i] + rr[i];
            H.kk[i] = phi * factor * H.kk[i] + kk[i];
        }
        for (int i = 0; i < 9; ++i) H.rk[i] = by->geometry * phi * factor * H.rk[i] + rk[i];
        add_hessian(K, s, t, &H);
    }
}

// Fields of a tile, at its first element.
typedef struct {
    const int* ends; // (2 x n)
    const double *x[3], *g0[3], *g1[3], *v[3], *g0v[3], *g1v[3];
    const double *inv_length, *ea, *ei, *eta;
    double* tangent; // (n x ANCF_TANGENT)
    int n;
    rules by;
} kernel_fields;

// Lanes beyond the last element compute that once more.
ANCF_INLINE lane read_lanes(const double* field, int e, int count) {
    lane value;
    for (int l = 0; l < LANES; ++l) value[l] = field[e + (l < count ? l : count - 1)];
    return value;
}

ANCF_INLINE void read_vectors(vectors* q, const kernel_fields* K, int e, int count, int damped) {
    const lane inv_length = read_lanes(K->inv_length, e, count);
    for (int c = 0; c < 3; ++c) {
        q->g0[c] = read_lanes(K->g0[c], e, count);
        q->g1[c] = read_lanes(K->g1[c], e, count);
        if (damped) {
            q->g0v[c] = read_lanes(K->g0v[c], e, count);
            q->g1v[c] = read_lanes(K->g1v[c], e, count);
        }
        for (int l = 0; l < LANES; ++l) {
            const int* ends = K->ends + 2 * (e + (l < count ? l : count - 1));
            q->d[c][l] = K->x[c][ends[1]] - K->x[c][ends[0]];
            if (damped) q->dv[c][l] = K->v[c][ends[1]] - K->v[c][ends[0]];
        }
        q->d[c] *= inv_length;
        if (damped) q->dv[c] *= inv_length;
    }
}

ANCF_INLINE void write_blocks(const kernel_fields* K, const blocks* B, int e, int count) {
    static const int place[9] = {XX, XY, XZ, XY, YY, YZ, XZ, YZ, ZZ};
    lane all[ANCF_TANGENT];
    for (int p = 0; p < 3; ++p) {
        for (int k = 0; k < 6; ++k) all[6 * p + k] = B->symmetric[p][k];
        for (int k = 0; k < 9; ++k) all[18 + 9 * p + k] = B->symmetric[3 + p][place[k]] + B->full[p][k];
    }
    for (int l = 0; l < count; ++l) {
        double* tangent = K->tangent + (e + l) * ANCF_TANGENT;
        for (int k = 0; k < ANCF_TANGENT; ++k) tangent[k] = all[k][l];
    }
}

ANCF_INLINE void beam_kernel(const kernel_fields* k, int strain, int points, int bending, int damped) {
    const kernel_fields K = *k;
    for (int e = 0; e < K.n; e += LANES) {
        const int count = K.n - e < LANES ? K.n - e : LANES;
        vectors q;
        blocks B = {0};
        read_vectors(&q, &K, e, count, damped);
        const lane ea = read_lanes(K.ea, e, count), ei = read_lanes(K.ei, e, count), eta = read_lanes(K.eta, e, count);
        axial_tangent(&B, &q, ea, eta, &K.by, strain, points, damped);
        if (bending == ANCF_FAST) {
            bend_fast_tangent(&B, ei);
            if (damped) damp_fast_tangent(&B, &q, ei * eta, &K.by);
        }
        if (bending == ANCF_EXACT) bend_exact_tangent(&B, &q, ei, eta, &K.by, damped);
        write_blocks(&K, &B, e, count);
    }
}

// One function per combination that a scene can have.
#define ANCF_TANGENT_KERNEL(name, bending, damped)                                                                     \
    ANCF_CLONES static void name(const kernel_fields* k) { beam_kernel(k, ANCF_GREEN, 5, bending, damped); }           \
    ANCF_CLONES static void name##_reduced(const kernel_fields* k) { beam_kernel(k, ANCF_GREEN, 3, bending, damped); } \
    ANCF_CLONES static void name##_stretch(const kernel_fields* k) {                                                   \
        beam_kernel(k, ANCF_STRETCH, 5, bending, damped);                                                              \
    }                                                                                                                  \
    ANCF_CLONES static void name##_stretch_reduced(const kernel_fields* k) {                                           \
        beam_kernel(k, ANCF_STRETCH, 3, bending, damped);                                                              \
    }
ANCF_TANGENT_KERNEL(straight, ANCF_STRAIGHT, 0)
ANCF_TANGENT_KERNEL(straight_damped, ANCF_STRAIGHT, 1)
ANCF_TANGENT_KERNEL(fast, ANCF_FAST, 0)
ANCF_TANGENT_KERNEL(fast_damped, ANCF_FAST, 1)
ANCF_TANGENT_KERNEL(exact, ANCF_EXACT, 0)
ANCF_TANGENT_KERNEL(exact_damped, ANCF_EXACT, 1)

// Tension-only spring and damper: nothing where it is slack.
static void spring_kernel(const kernel_fields* K) {
    for (int e = 0; e < K->n; ++e) {
        double *tangent = K->tangent + e * ANCF_TANGENT, *dd = tangent + 6, d[3], dv[3];
        const int *ends = K->ends + 2 * e, start = ends[0], end = ends[1];
        for (int k = 0; k < ANCF_TANGENT; ++k) tangent[k] = 0.0;
        for (int c = 0; c < 3; ++c) {
            d[c] = (K->x[c][end] - K->x[c][start]) * K->inv_length[e];
            dv[c] = (K->v[c][end] - K->v[c][start]) * K->inv_length[e];
        }
        const double stretch = sqrt(ancf_inner(d, d)), inv = 1.0 / (stretch + DBL_MIN), eta = K->eta[e];
        const double rate = eta * ancf_inner(d, dv) * inv, strain = stretch - 1.0 + rate, ea = 4.0 * K->ea[e];
        if (stretch <= 1.0 || strain <= 0.0) continue;
        for (int i = 0, k = 0; i < 3; ++i)
            for (int j = i; j < 3; ++j, ++k) {
                const double ni = d[i] * inv, nj = d[j] * inv;
                const double turn = 0.5 * (ni * (eta * dv[j] - rate * nj) + nj * (eta * dv[i] - rate * ni));
                dd[k] = ea * ((1.0 + eta * K->by.rate - strain * inv) * ni * nj + K->by.geometry * turn * inv);
                if (i == j) dd[k] += ea * strain * inv;
            }
    }
}

static void choose_kernel(const ancf_tile* t, const kernel_fields* k) {
    enum { REDUCED = 1, STRETCH = 2 };
#define ANCF_RULES(name) name, name##_reduced, name##_stretch, name##_stretch_reduced
    static void (*const beam[ANCF_BENDINGS][2][4])(const kernel_fields*) = {
        {{ANCF_RULES(straight)}, {ANCF_RULES(straight_damped)}},
        {{ANCF_RULES(fast)}, {ANCF_RULES(fast_damped)}},
        {{ANCF_RULES(exact)}, {ANCF_RULES(exact_damped)}}};
    const int rule = (t->kind & ANCF_AXIAL_REDUCED ? REDUCED : 0) + (t->kind & ANCF_ENGINEERING ? STRETCH : 0);
    if (t->kind & ANCF_SPRING) spring_kernel(k);
    else beam[ancf_bending_of(t->kind, t->bending)][t->damped][rule](k);
}

void ancf_tangent(double* tangent, const ancf_model* m, const double* x, const double* v, double rate, bool definite) {
    for (int i = 0; i < m->n_tiles; ++i) {
        const ancf_tile* t = &m->tile[i];
        const int b = t->begin, start = m->n_nodes + b, end = start + m->n_elements;
        kernel_fields k = {.ends = m->ends + 2 * b,
                           .inv_length = m->inv_length + b,
                           .ea = m->ea_length + b,
                           .ei = m->ei_length + b,
                           .eta = m->damping + b,
                           .tangent = tangent + b * ANCF_TANGENT,
                           .n = t->end - b,
                           .by = {rate, definite ? 0.0 : 1.0, zero == (definite ? 1.0 : 0.0)}};
        for (int c = 0; c < 3; ++c) {
            const int block = c * m->stride;
            k.x[c] = x + block;
            k.g0[c] = x + block + start;
            k.g1[c] = x + block + end;
            k.v[c] = v + block;
            k.g0v[c] = v + block + start;
            k.g1v[c] = v + block + end;
        }
        choose_kernel(t, &k);
    }
}
