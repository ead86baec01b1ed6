#include "ancf/tangent.h"
#include "ancf/shape.h"
#include "strain.h"

#include <float.h>
#include <math.h>

// At a point of the element the strains depend on r' and k = L r'', which are sums over q = (g0, d, g1) with the
// weights s and t of shape.h. A second derivative A over r' (symmetric, 3x3) so adds s_i s_j A to the block (i, j) of
// the tangent, and one over k adds t_i t_j A.

// A symmetric 3x3 matrix as (xx xy xz yy yz zz).
enum { XX, XY, XZ, YY, YZ, ZZ };

// The pairs (i, j) of q: the three diagonal ones, then (g0, d), (g0, g1), (d, g1).
static const int first_of[6] = {0, 1, 2, 0, 0, 1}, second_of[6] = {0, 1, 2, 1, 2, 2};

// The blocks of one element: what is symmetric in each of the six pairs, and the whole of what is not.
typedef struct {
    double symmetric[6][6];
    double full[3][9];
} blocks;

// A = factor (a b^T + b a^T + add I).
ANCF_INLINE void dyad(double A[6], double factor, const double a[3], const double b[3], double add) {
    A[XX] = factor * (2.0 * a[0] * b[0] + add);
    A[XY] = factor * (a[0] * b[1] + a[1] * b[0]);
    A[XZ] = factor * (a[0] * b[2] + a[2] * b[0]);
    A[YY] = factor * (2.0 * a[1] * b[1] + add);
    A[YZ] = factor * (a[1] * b[2] + a[2] * b[1]);
    A[ZZ] = factor * (2.0 * a[2] * b[2] + add);
}

// Adds w_i w_j A to every pair.
ANCF_INLINE void add_point(blocks* K, const double w[3], const double A[6]) {
    for (int p = 0; p < 6; ++p) {
        const double weight = w[first_of[p]] * w[second_of[p]];
        for (int k = 0; k < 6; ++k) K->symmetric[p][k] += weight * A[k];
    }
}

ANCF_INLINE void combine(double sum[3], const double w[3], const double g0[3], const double d[3], const double g1[3]) {
    for (int c = 0; c < 3; ++c) sum[c] = w[0] * g0[c] + w[1] * d[c] + w[2] * g1[c];
}

// An element's (g0, d, g1) and their rates.
typedef struct {
    double g0[3], d[3], g1[3], g0v[3], dv[3], g1v[3];
} vectors;

// What all elements of a call have in common.
typedef struct {
    double rate;     // dv/dx [1/s]
    double geometry; // 1, or 0 if what may be indefinite is left out
    double least;    // stress below which it counts as this one: 0, or -infinity
} rules;

// Axial energy EA L/2 int eps^2 with the stress eps + eta r'.dr'/dt.
ANCF_INLINE void axial_tangent(blocks* K, const vectors* q, double ea, double eta, const rules* by, int points,
                               int damped) {
    const double *xi = points == 3 ? gauss3_xi : gauss5_xi, *weight = points == 3 ? gauss3_weight : gauss5_weight;
    for (int p = 0; p < points; ++p) {
        double s[3], r[3], h[3], A[6];
        ancf_shape_slope(s, xi[p]);
        combine(r, s, q->g0, q->d, q->g1);
        double stress = 0.5 * (dot(r, r) - 1.0);
        for (int c = 0; c < 3; ++c) h[c] = 0.5 * r[c];
        if (damped) {
            double rv[3];
            combine(rv, s, q->g0v, q->dv, q->g1v);
            stress += eta * dot(r, rv);
            for (int c = 0; c < 3; ++c) h[c] += 0.5 * eta * (by->rate * r[c] + by->geometry * rv[c]);
        }
        dyad(A, 4.0 * ea * weight[p], r, h, stress > by->least ? stress : by->least);
        add_point(K, s, A);
    }
}

// (EI/L)(2 u.u + 2 v.v + 2 u.v), u = g0 - d, v = g1 - d.
ANCF_INLINE void bend_fast_tangent(blocks* K, double ei) {
    static const double factor[6] = {4.0, 12.0, 4.0, -6.0, 2.0, -6.0};
    for (int p = 0; p < 6; ++p) {
        K->symmetric[p][XX] += factor[p] * ei;
        K->symmetric[p][YY] += factor[p] * ei;
        K->symmetric[p][ZZ] += factor[p] * ei;
    }
}

// The damping of damp_fast in elastic.c: force -1/2 EI/L eta (k.kv/k.k) w k at 2 Gauss points.
ANCF_INLINE void damp_fast_tangent(blocks* K, const vectors* q, double ei_eta, const rules* by) {
    const double root3 = 1.7320508075688772;
    for (int p = 0; p < 2; ++p) {
        const double s = p ? root3 : -root3, w[3] = {s - 1.0, -2.0 * s, s + 1.0};
        double k[3], kv[3], h[3], A[6];
        combine(k, w, q->g0, q->d, q->g1);
        combine(kv, w, q->g0v, q->dv, q->g1v);
        const double square = dot(k, k) + tiny_curvature2, work = dot(k, kv), share = work / square;
        for (int c = 0; c < 3; ++c) h[c] = 0.5 * (by->rate * k[c] + by->geometry * (kv[c] - 2.0 * share * k[c]));
        dyad(A, 0.5 * ei_eta / square, k, h, by->geometry * work);
        add_point(K, w, A);
    }
}

// Second derivatives of (L kappa)^2 = q = (Q P - R^2)/P^2 over (r', k), with P = r'.r', R = r'.k, Q = k.k; rk row by
// row.
typedef struct {
    double rr[6], kk[6], rk[9];
} hessian;

ANCF_INLINE void curvature_hessian(hessian* H, const double r[3], const double k[3], double inv, double R, double Q) {
    double u[3], w[3], add[6];
    for (int c = 0; c < 3; ++c) {
        u[c] = (4.0 * Q - 12.0 * R * R) * r[c] + 8.0 * R * k[c];
        w[c] = -r[c];
    }
    dyad(H->kk, inv * inv, r, w, 2.0 / inv);
    dyad(H->rr, inv * inv, r, u, (4.0 * R * R - 2.0 * Q) / inv);
    dyad(add, -inv * inv, k, k, 0.0);
    for (int i = 0; i < 6; ++i) H->rr[i] += add[i];
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            H->rk[3 * i + j] = inv * (inv * (8.0 * R * r[i] * r[j] - 4.0 * r[i] * k[j] - 2.0 * k[i] * r[j]) -
                                      (i == j ? 2.0 * R : 0.0));
}

// q's gradient over (r', k), as in elastic.c; R and Q over P.
ANCF_INLINE void curvature_gradient(double qr[3], double qk[3], const double r[3], const double k[3], double inv,
                                    double R, double Q) {
    for (int c = 0; c < 3; ++c) {
        qk[c] = 2.0 * inv * (k[c] - R * r[c]);
        qr[c] = 2.0 * inv * ((2.0 * R * R - Q) * r[c] - R * k[c]);
    }
}

// b = H a over (r', k).
ANCF_INLINE void hessian_times(double br[3], double bk[3], const hessian* H, const double ar[3], const double ak[3]) {
    static const int place[3][3] = {{XX, XY, XZ}, {XY, YY, YZ}, {XZ, YZ, ZZ}};
    for (int i = 0; i < 3; ++i) {
        br[i] = bk[i] = 0.0;
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

// EI/2 int kappa^2 ds and its damping, whose force is -EI/L (1/2 + eta/4 (dq/dt)/q) grad q: bend_exact in elastic.c.
ANCF_INLINE void bend_exact_tangent(blocks* K, const vectors* v, double ei, double eta, const rules* by, int damped) {
    for (int p = 0; p < 3; ++p) {
        double s[3], t[3], r[3], k[3], rr[6] = {0.0}, kk[6] = {0.0}, rk[9] = {0.0};
        hessian H;
        ancf_shape_slope(s, gauss3_xi[p]);
        ancf_shape_curvature(t, gauss3_xi[p]);
        combine(r, s, v->g0, v->d, v->g1);
        combine(k, t, v->g0, v->d, v->g1);
        const double inv = 1.0 / dot(r, r), R = dot(r, k) * inv, Q = dot(k, k) * inv, factor = gauss3_weight[p] * ei;
        double phi = 0.5;
        curvature_hessian(&H, r, k, inv, R, Q);
        if (damped) {
            double rv[3], kv[3], qr[3], qk[3], hr[3], hk[3];
            combine(rv, s, v->g0v, v->dv, v->g1v);
            combine(kv, t, v->g0v, v->dv, v->g1v);
            curvature_gradient(qr, qk, r, k, inv, R, Q);
            hessian_times(hr, hk, &H, rv, kv);
            const double share = 1.0 / (Q - R * R + tiny_curvature2), rate = (dot(qr, rv) + dot(qk, kv)) * share;
            phi += 0.25 * eta * by->geometry * rate;
            for (int c = 0; c < 3; ++c) {
                hr[c] = 0.5 * (by->geometry * (hr[c] - rate * qr[c]) + by->rate * qr[c]);
                hk[c] = 0.5 * (by->geometry * (hk[c] - rate * qk[c]) + by->rate * qk[c]);
            }
            const double damp = 0.25 * eta * share * factor;
            dyad(rr, damp, qr, hr, 0.0);
            dyad(kk, damp, qk, hk, 0.0);
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

// Fields of a group of elements, at its first one.
typedef struct {
    const int* ends; // (2 x n)
    const double *x[3], *g0[3], *g1[3], *v[3], *g0v[3], *g1v[3];
    const double *inv_length, *ea, *ei, *eta;
    double* tangent; // (ANCF_TANGENT) rows of `row` each
    int row, n;
    rules by;
} kernel_fields;

ANCF_INLINE void read_vectors(vectors* q, const kernel_fields* K, int e, int damped) {
    const int start = K->ends[2 * e], end = K->ends[2 * e + 1];
    for (int c = 0; c < 3; ++c) {
        q->g0[c] = K->g0[c][e];
        q->g1[c] = K->g1[c][e];
        q->d[c] = (K->x[c][end] - K->x[c][start]) * K->inv_length[e];
        if (!damped) continue;
        q->g0v[c] = K->g0v[c][e];
        q->g1v[c] = K->g1v[c][e];
        q->dv[c] = (K->v[c][end] - K->v[c][start]) * K->inv_length[e];
    }
}

ANCF_INLINE void write_blocks(const kernel_fields* K, const blocks* B, int e) {
    static const int place[9] = {XX, XY, XZ, XY, YY, YZ, XZ, YZ, ZZ};
    for (int p = 0; p < 3; ++p) {
        for (int k = 0; k < 6; ++k) K->tangent[(6 * p + k) * K->row + e] = B->symmetric[p][k];
        for (int k = 0; k < 9; ++k)
            K->tangent[(18 + 9 * p + k) * K->row + e] = B->symmetric[3 + p][place[k]] + B->full[p][k];
    }
}

enum { STRAIGHT, FAST, EXACT };

ANCF_INLINE void beam_kernel(const kernel_fields* k, int points, int bending, int damped) {
    const kernel_fields K = *k;
#pragma GCC ivdep
    for (int e = 0; e < K.n; ++e) {
        vectors q;
        blocks B = {0};
        read_vectors(&q, &K, e, damped);
        axial_tangent(&B, &q, K.ea[e], K.eta[e], &K.by, points, damped);
        if (bending == FAST) {
            bend_fast_tangent(&B, K.ei[e]);
            if (damped) damp_fast_tangent(&B, &q, K.ei[e] * K.eta[e], &K.by);
        }
        if (bending == EXACT) bend_exact_tangent(&B, &q, K.ei[e], K.eta[e], &K.by, damped);
        write_blocks(&K, &B, e);
    }
}

// One function per combination that a scene can have.
#define ANCF_TANGENT_KERNEL(name, bending, damped)                                                                     \
    ANCF_CLONES static void name(const kernel_fields* k) { beam_kernel(k, 5, bending, damped); }                       \
    ANCF_CLONES static void name##_reduced(const kernel_fields* k) { beam_kernel(k, 3, bending, damped); }
ANCF_TANGENT_KERNEL(straight, STRAIGHT, 0)
ANCF_TANGENT_KERNEL(straight_damped, STRAIGHT, 1)
ANCF_TANGENT_KERNEL(fast, FAST, 0)
ANCF_TANGENT_KERNEL(fast_damped, FAST, 1)
ANCF_TANGENT_KERNEL(exact, EXACT, 0)
ANCF_TANGENT_KERNEL(exact_damped, EXACT, 1)

// Tension-only spring and damper: nothing where it is slack.
static void spring_kernel(const kernel_fields* K) {
    for (int e = 0; e < K->n; ++e) {
        vectors q;
        blocks B = {0};
        read_vectors(&q, K, e, 1);
        const double stretch = sqrt(dot(q.d, q.d)), inv = 1.0 / (stretch + DBL_MIN), eta = K->eta[e];
        const double rate = eta * dot(q.d, q.dv) * inv, strain = stretch - 1.0 + rate;
        if (stretch > 1.0 && strain > 0.0) {
            double n[3], h[3];
            for (int c = 0; c < 3; ++c) {
                n[c] = q.d[c] * inv;
                h[c] = 0.5 * (1.0 + eta * K->by.rate - strain * inv) * n[c] +
                       0.5 * K->by.geometry * inv * (eta * q.dv[c] - rate * n[c]);
            }
            dyad(B.symmetric[1], 4.0 * K->ea[e], n, h, strain * inv);
        }
        write_blocks(K, &B, e);
    }
}

static void choose_kernel(const ancf_group* g, const kernel_fields* k) {
    static void (*const beam[3][2][2])(const kernel_fields*) = {
        {{straight, straight_reduced}, {straight_damped, straight_damped_reduced}},
        {{fast, fast_reduced}, {fast_damped, fast_damped_reduced}},
        {{exact, exact_reduced}, {exact_damped, exact_damped_reduced}}};
    const int bending = !g->bending ? STRAIGHT : g->kind & ANCF_CURVATURE_EXACT ? EXACT : FAST;
    if (g->kind & ANCF_SPRING) spring_kernel(k);
    else beam[bending][g->damped][(g->kind & ANCF_AXIAL_REDUCED) != 0](k);
}

void ancf_tangent(double* tangent, const ancf_model* m, const double* x, const double* v, double rate, bool definite) {
    for (int i = 0; i < m->n_groups; ++i) {
        const ancf_group* g = &m->group[i];
        const int b = g->begin, start = m->n_nodes + b, end = start + m->n_elements;
        kernel_fields k = {.ends = m->ends + 2 * b,
                           .inv_length = m->inv_length + b,
                           .ea = m->ea_length + b,
                           .ei = m->ei_length + b,
                           .eta = m->damping + b,
                           .tangent = tangent + b,
                           .row = m->n_elements,
                           .n = g->end - b,
                           .by = {rate, definite ? 0.0 : 1.0, definite ? 0.0 : -INFINITY}};
        for (int c = 0; c < 3; ++c) {
            const int block = c * m->stride;
            k.x[c] = x + block;
            k.g0[c] = x + block + start;
            k.g1[c] = x + block + end;
            k.v[c] = v + block;
            k.g0v[c] = v + block + start;
            k.g1v[c] = v + block + end;
        }
        choose_kernel(g, &k);
    }
}
