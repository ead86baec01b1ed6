#include "ancf/elastic.h"
#include "ancf/shape.h"
#include "internal.h"
#include "strain.h"

#include <float.h>
#include <math.h>

// Green's strain at xi is eps = w(xi).(G - 1)/2 with the six dot products G = (g0.g0, d.d, g1.g1, g0.d, g0.g1, d.g1)
// and w = (a2, b2, c2, 2ab, 2ac, 2bc). The axial energy EA L/2 int eps^2 is therefore exactly (EA L/8) y^T W y with y =
// G - 1 and the constant W = int w w^T; the force is the chain rule over G. Rates of G are objective, so Kelvin-Voigt
// damping is y + eta dG/dt in the place of y.

static void strain_weights(double w[6], double xi) {
    double s[3];
    ancf_shape_slope(s, xi);
    w[0] = s[0] * s[0];
    w[1] = s[1] * s[1];
    w[2] = s[2] * s[2];
    w[3] = 2.0 * s[0] * s[1];
    w[4] = 2.0 * s[0] * s[2];
    w[5] = 2.0 * s[1] * s[2];
}

static void axial_rule(double W[21], int n, const double* xi, const double* weight) {
    for (int k = 0; k < 21; ++k) W[k] = 0.0;
    for (int p = 0; p < n; ++p) {
        double w[6];
        strain_weights(w, xi[p]);
        for (int i = 0, k = 0; i < 6; ++i)
            for (int j = i; j < 6; ++j) W[k++] += weight[p] * w[i] * w[j];
    }
}

void ancf_axial_rules(double exact[21], double reduced[21]) {
    axial_rule(exact, 5, gauss5_xi, gauss5_weight);
    axial_rule(reduced, 3, gauss3_xi, gauss3_weight);
}

ANCF_INLINE void gram_of(double G[6], const double g0[3], const double d[3], const double g1[3]) {
    G[0] = dot(g0, g0);
    G[1] = dot(d, d);
    G[2] = dot(g1, g1);
    G[3] = dot(g0, d);
    G[4] = dot(g0, g1);
    G[5] = dot(d, g1);
}

ANCF_INLINE void gram_rate_of(double R[6], const double g0[3], const double d[3], const double g1[3],
                              const double g0v[3], const double dv[3], const double g1v[3]) {
    R[0] = 2.0 * dot(g0, g0v);
    R[1] = 2.0 * dot(d, dv);
    R[2] = 2.0 * dot(g1, g1v);
    R[3] = dot(g0, dv) + dot(g0v, d);
    R[4] = dot(g0, g1v) + dot(g0v, g1);
    R[5] = dot(d, g1v) + dot(dv, g1);
}

ANCF_INLINE void multiply6(double h[6], const double W[21], const double y[6]) {
    h[0] = W[0] * y[0] + W[1] * y[1] + W[2] * y[2] + W[3] * y[3] + W[4] * y[4] + W[5] * y[5];
    h[1] = W[1] * y[0] + W[6] * y[1] + W[7] * y[2] + W[8] * y[3] + W[9] * y[4] + W[10] * y[5];
    h[2] = W[2] * y[0] + W[7] * y[1] + W[11] * y[2] + W[12] * y[3] + W[13] * y[4] + W[14] * y[5];
    h[3] = W[3] * y[0] + W[8] * y[1] + W[12] * y[2] + W[15] * y[3] + W[16] * y[4] + W[17] * y[5];
    h[4] = W[4] * y[0] + W[9] * y[1] + W[13] * y[2] + W[16] * y[3] + W[18] * y[4] + W[19] * y[5];
    h[5] = W[5] * y[0] + W[10] * y[1] + W[14] * y[2] + W[17] * y[3] + W[19] * y[4] + W[20] * y[5];
}

// EI/2 int |r''|^2 ds = (EI/L)(2 u.u + 2 v.v + 2 u.v), u = g0 - d, v = g1 - d: adds to the forces on g0, d, g1.
ANCF_INLINE void bend_fast(double f0[3], double fd[3], double f1[3], const double u[3], const double v[3], double ei) {
    for (int c = 0; c < 3; ++c) {
        const double b0 = ei * (4.0 * u[c] + 2.0 * v[c]), b1 = ei * (4.0 * v[c] + 2.0 * u[c]);
        f0[c] -= b0;
        f1[c] -= b1;
        fd[c] += b0 + b1;
    }
}

// Damping of the fast curvature, by its rate along its own direction at 2 Gauss points (exact for a linear r''): a
// rigid rotation turns r'' but has no such rate.
ANCF_INLINE void damp_fast(double f0[3], double fd[3], double f1[3], const double u[3], const double v[3],
                           const double uv[3], const double vv[3], double ei_eta) {
    const double root3 = 1.7320508075688772;
    for (int p = 0; p < 2; ++p) {
        const double s = p ? root3 : -root3, wu = s - 1.0, wv = s + 1.0;
        double k[3], kv[3];
        for (int c = 0; c < 3; ++c) {
            k[c] = wu * u[c] + wv * v[c];
            kv[c] = wu * uv[c] + wv * vv[c];
        }
        const double q = 0.5 * ei_eta * dot(k, kv) / (dot(k, k) + tiny_curvature2);
        for (int c = 0; c < 3; ++c) {
            f0[c] -= q * wu * k[c];
            f1[c] -= q * wv * k[c];
            fd[c] += q * (wu + wv) * k[c];
        }
    }
}

// EI/2 int kappa^2 ds, kappa = |r' x r''|/|r'|^2, at 3 Gauss points, with its Kelvin-Voigt term. (L kappa)^2 =
// q = (Q P - R^2)/P^2 with P = r'.r', R = r'.k, Q = k.k, k = L r''.
ANCF_INLINE void bend_exact(double f0[3], double fd[3], double f1[3], const double g0[3], const double d[3],
                            const double g1[3], const double g0v[3], const double dv[3], const double g1v[3], double ei,
                            double eta, int damped) {
    for (int p = 0; p < 3; ++p) {
        double s[3], t[3], r[3], k[3];
        ancf_shape_slope(s, gauss3_xi[p]);
        ancf_shape_curvature(t, gauss3_xi[p]);
        for (int c = 0; c < 3; ++c) {
            r[c] = s[0] * g0[c] + s[1] * d[c] + s[2] * g1[c];
            k[c] = t[0] * g0[c] + t[1] * d[c] + t[2] * g1[c];
        }
        const double P = dot(r, r), R = dot(r, k), Q = dot(k, k), inv = 1.0 / P;
        const double q = (Q - R * R * inv) * inv;
        double qr[3], qk[3]; // gradients of q
        for (int c = 0; c < 3; ++c) {
            qk[c] = 2.0 * inv * (k[c] - R * inv * r[c]);
            qr[c] = 2.0 * inv * inv * ((2.0 * R * R * inv - Q) * r[c] - R * k[c]);
        }
        double factor = 0.5;
        if (damped) {
            double rate = 0.0;
            for (int c = 0; c < 3; ++c) {
                const double rv = s[0] * g0v[c] + s[1] * dv[c] + s[2] * g1v[c];
                const double kv = t[0] * g0v[c] + t[1] * dv[c] + t[2] * g1v[c];
                rate += qr[c] * rv + qk[c] * kv;
            }
            factor += 0.25 * eta * rate / (q + tiny_curvature2);
        }
        factor *= gauss3_weight[p] * ei;
        for (int c = 0; c < 3; ++c) {
            f0[c] -= factor * (s[0] * qr[c] + t[0] * qk[c]);
            fd[c] -= factor * (s[1] * qr[c] + t[1] * qk[c]);
            f1[c] -= factor * (s[2] * qr[c] + t[2] * qk[c]);
        }
    }
}

enum { STRAIGHT, FAST, EXACT };

// Blocks of the fields a kernel reads and writes, at the first element of its group.
typedef struct {
    const double *g0[3], *g1[3], *d[3], *g0v[3], *g1v[3], *dv[3];
    double *f0[3], *f1[3], *fd[3];
    const double *inv_length, *ea, *ei, *eta;
    int n;
} kernel_fields;

ANCF_INLINE void beam_kernel(const kernel_fields* k, const double* rule, int bending, int damped) {
    double W[21];
    for (int i = 0; i < 21; ++i) W[i] = rule[i];
    const kernel_fields K = *k;
#pragma GCC ivdep
    for (int e = 0; e < K.n; ++e) {
        const double g0[3] = {K.g0[0][e], K.g0[1][e], K.g0[2][e]};
        const double g1[3] = {K.g1[0][e], K.g1[1][e], K.g1[2][e]};
        const double d[3] = {K.d[0][e], K.d[1][e], K.d[2][e]};
        double g0v[3] = {0}, g1v[3] = {0}, dv[3] = {0};
        double y[6], h[6], f0[3], fd[3], f1[3];
        gram_of(y, g0, d, g1);
        for (int i = 0; i < 6; ++i) y[i] -= 1.0;
        if (damped) {
            for (int c = 0; c < 3; ++c) {
                g0v[c] = K.g0v[c][e];
                g1v[c] = K.g1v[c][e];
                dv[c] = K.dv[c][e];
            }
            double rate[6];
            gram_rate_of(rate, g0, d, g1, g0v, dv, g1v);
            for (int i = 0; i < 6; ++i) y[i] += K.eta[e] * rate[i];
        }
        multiply6(h, W, y);
        for (int i = 0; i < 6; ++i) h[i] *= -K.ea[e];
        for (int c = 0; c < 3; ++c) {
            f0[c] = 2.0 * h[0] * g0[c] + h[3] * d[c] + h[4] * g1[c];
            fd[c] = 2.0 * h[1] * d[c] + h[3] * g0[c] + h[5] * g1[c];
            f1[c] = 2.0 * h[2] * g1[c] + h[4] * g0[c] + h[5] * d[c];
        }
        if (bending == FAST) {
            double u[3], v[3];
            for (int c = 0; c < 3; ++c) {
                u[c] = g0[c] - d[c];
                v[c] = g1[c] - d[c];
            }
            bend_fast(f0, fd, f1, u, v, K.ei[e]);
            if (damped) {
                double uv[3], vv[3];
                for (int c = 0; c < 3; ++c) {
                    uv[c] = g0v[c] - dv[c];
                    vv[c] = g1v[c] - dv[c];
                }
                damp_fast(f0, fd, f1, u, v, uv, vv, K.ei[e] * K.eta[e]);
            }
        }
        if (bending == EXACT) bend_exact(f0, fd, f1, g0, d, g1, g0v, dv, g1v, K.ei[e], K.eta[e], damped);
        for (int c = 0; c < 3; ++c) {
            K.f0[c][e] = f0[c];
            K.f1[c][e] = f1[c];
            K.fd[c][e] = K.inv_length[e] * fd[c];
        }
    }
}

// One function per combination that a scene can have, so that none computes what it does not need.
#define ANCF_BEAM_KERNEL(name, bending, damped)                                                                        \
    ANCF_CLONES static void name(const kernel_fields* k, const double* rule) { beam_kernel(k, rule, bending, damped); }
ANCF_BEAM_KERNEL(beam_straight, STRAIGHT, 0)
ANCF_BEAM_KERNEL(beam_straight_damped, STRAIGHT, 1)
ANCF_BEAM_KERNEL(beam_fast, FAST, 0)
ANCF_BEAM_KERNEL(beam_fast_damped, FAST, 1)
ANCF_BEAM_KERNEL(beam_exact, EXACT, 0)
ANCF_BEAM_KERNEL(beam_exact_damped, EXACT, 1)

// Tension-only spring and damper, k = EA/dl (Eq. 1), engineering strain |d| - 1.
ANCF_CLONES static void spring_kernel(const kernel_fields* k) {
    const kernel_fields K = *k;
#pragma GCC ivdep
    for (int e = 0; e < K.n; ++e) {
        const double d[3] = {K.d[0][e], K.d[1][e], K.d[2][e]};
        const double dv[3] = {K.dv[0][e], K.dv[1][e], K.dv[2][e]};
        const double stretch = sqrt(dot(d, d)), taut = stretch > 1.0 ? 1.0 : 0.0;
        const double inv = 1.0 / (stretch + DBL_MIN);
        const double ea = 4.0 * K.ea[e] * K.inv_length[e];
        const double tension = ea * (stretch - 1.0 + K.eta[e] * dot(d, dv) * inv);
        const double pull = -taut * inv * (tension > 0.0 ? tension : 0.0);
        for (int c = 0; c < 3; ++c) {
            K.f0[c][e] = 0.0;
            K.f1[c][e] = 0.0;
            K.fd[c][e] = pull * d[c];
        }
    }
}

static void choose_kernel(const ancf_model* m, const ancf_group* g, const kernel_fields* k) {
    if (g->kind & ANCF_SPRING) {
        spring_kernel(k);
        return;
    }
    static void (*const beam[3][2])(const kernel_fields*, const double*) = {
        {beam_straight, beam_straight_damped}, {beam_fast, beam_fast_damped}, {beam_exact, beam_exact_damped}};
    const int bending = !g->bending ? STRAIGHT : g->kind & ANCF_CURVATURE_EXACT ? EXACT : FAST;
    beam[bending][g->damped](k, g->kind & ANCF_AXIAL_REDUCED ? m->axial_reduced : m->axial_exact);
}

// d = (r1 - r0)/L of every element, (3 x n_elements).
static void gather(double* d, const ancf_model* m, const double* x) {
    const int n = m->n_elements;
    for (int c = 0; c < 3; ++c) {
        const double* u = x + c * m->stride;
        double* dc = d + c * n;
        for (int e = 0; e < n; ++e) dc[e] = (u[m->ends[2 * e + 1]] - u[m->ends[2 * e]]) * m->inv_length[e];
    }
}

// Force on a node: plus that on d/L of the elements that end there, minus that of those that start there.
static void scatter(double* force, const ancf_model* m, const double* fd) {
    const int n = m->n_elements;
    for (int i = 0; i < m->n_nodes; ++i) {
        double sum[3] = {0.0, 0.0, 0.0};
        for (int k = m->first[i]; k < m->first[i + 1]; ++k) {
            const int e = m->at[k] >> 1;
            const double sign = m->at[k] & 1 ? 1.0 : -1.0;
            for (int c = 0; c < 3; ++c) sum[c] += sign * fd[c * n + e];
        }
        for (int c = 0; c < 3; ++c) force[c * m->stride + i] = sum[c];
    }
}

static bool any_damped(const ancf_model* m) {
    for (int g = 0; g < m->n_groups; ++g)
        if (m->group[g].damped || m->group[g].kind & ANCF_SPRING) return true;
    return false;
}

void ancf_elastic_force(ancf_model* m, double* force, const double* x, const double* v) {
    const int n = m->n_elements;
    double *d = m->scratch, *dv = d + 3 * n, *fd = dv + 3 * n;
    gather(d, m, x);
    if (any_damped(m)) gather(dv, m, v);
    for (int i = 0; i < m->n_groups; ++i) {
        const ancf_group* g = &m->group[i];
        const int b = g->begin, start = m->n_nodes + b, end = start + n;
        kernel_fields k = {.inv_length = m->inv_length + b,
                           .ea = m->ea_length + b,
                           .ei = m->ei_length + b,
                           .eta = m->damping + b,
                           .n = g->end - b};
        for (int c = 0; c < 3; ++c) {
            const int block = c * m->stride;
            k.g0[c] = x + block + start;
            k.g1[c] = x + block + end;
            k.g0v[c] = v + block + start;
            k.g1v[c] = v + block + end;
            k.f0[c] = force + block + start;
            k.f1[c] = force + block + end;
            k.d[c] = d + c * n + b;
            k.dv[c] = dv + c * n + b;
            k.fd[c] = fd + c * n + b;
        }
        choose_kernel(m, g, &k);
    }
    scatter(force, m, fd);
}

// An element's (g0, d, g1) in a field.
static void element_vectors(double g0[3], double d[3], double g1[3], const ancf_model* m, const double* x, int e) {
    int dof[4];
    ancf_model_dofs(dof, m, e);
    for (int c = 0; c < 3; ++c) {
        const double* u = x + c * m->stride;
        g0[c] = u[dof[1]];
        d[c] = (u[dof[2]] - u[dof[0]]) * m->inv_length[e];
        g1[c] = u[dof[3]];
    }
}

static double axial_energy(const ancf_model* m, int e, const double g0[3], const double d[3], const double g1[3]) {
    if (m->element[e].kind & ANCF_SPRING) {
        const double strain = sqrt(dot(d, d)) - 1.0;
        return strain > 0.0 ? 0.5 * m->element[e].ea * m->element[e].length * strain * strain : 0.0;
    }
    double y[6], h[6], sum = 0.0;
    gram_of(y, g0, d, g1);
    for (int i = 0; i < 6; ++i) y[i] -= 1.0;
    multiply6(h, m->element[e].kind & ANCF_AXIAL_REDUCED ? m->axial_reduced : m->axial_exact, y);
    for (int i = 0; i < 6; ++i) sum += h[i] * y[i];
    return 0.5 * m->ea_length[e] * sum;
}

// EI/2 int |r''|^2 ds, in closed form.
static double fast_bending_energy(double ei_length, const double g0[3], const double d[3], const double g1[3]) {
    double sum = 0.0;
    for (int c = 0; c < 3; ++c) {
        const double u = g0[c] - d[c], v = g1[c] - d[c];
        sum += u * u + v * v + u * v;
    }
    return 2.0 * ei_length * sum;
}

static double bending_energy(const ancf_model* m, int e, const double g0[3], const double d[3], const double g1[3]) {
    if (!(m->element[e].kind & ANCF_CURVATURE_EXACT)) return fast_bending_energy(m->ei_length[e], g0, d, g1);
    double sum = 0.0;
    for (int p = 0; p < 3; ++p) {
        double s[3], t[3], r[3], k[3];
        ancf_shape_slope(s, gauss3_xi[p]);
        ancf_shape_curvature(t, gauss3_xi[p]);
        for (int c = 0; c < 3; ++c) {
            r[c] = s[0] * g0[c] + s[1] * d[c] + s[2] * g1[c];
            k[c] = t[0] * g0[c] + t[1] * d[c] + t[2] * g1[c];
        }
        const double P = dot(r, r), R = dot(r, k), Q = dot(k, k);
        sum += gauss3_weight[p] * (Q - R * R / P) / P;
    }
    return 0.5 * m->ei_length[e] * sum;
}

void ancf_elastic_energy(double* axial, double* bending, const ancf_model* m, const double* x, int begin, int end) {
    *axial = *bending = 0.0;
    for (int e = begin; e < end; ++e) {
        double g0[3], d[3], g1[3];
        element_vectors(g0, d, g1, m, x, e);
        *axial += axial_energy(m, e, g0, d, g1);
        if (m->element[e].ei > 0.0) *bending += bending_energy(m, e, g0, d, g1);
    }
}

double ancf_damping_power(ancf_model* m, const double* x, const double* v) {
    if (!any_damped(m)) return 0.0;
    const int field = 3 * m->stride;
    double *total = m->work, *elastic = m->work + field, *rest = m->work + 2 * field;
    for (int i = 0; i < field; ++i) rest[i] = 0.0;
    ancf_elastic_force(m, total, x, v);
    ancf_elastic_force(m, elastic, x, rest);
    double power = 0.0;
    for (int c = 0; c < 3; ++c)
        for (int i = 0; i < m->n_dof; ++i) {
            const int j = c * m->stride + i;
            power += (elastic[j] - total[j]) * v[j];
        }
    return power;
}

// r' and its rate at xi.
static void slope_at(double r[3], const ancf_model* m, const double* field, int e, double xi) {
    double g0[3], d[3], g1[3], s[3];
    element_vectors(g0, d, g1, m, field, e);
    ancf_shape_slope(s, xi);
    const bool spring = m->element[e].kind & ANCF_SPRING;
    for (int c = 0; c < 3; ++c) r[c] = spring ? d[c] : s[0] * g0[c] + s[1] * d[c] + s[2] * g1[c];
}

double ancf_strain(const ancf_model* m, const double* x, int element, double xi) {
    double r[3];
    slope_at(r, m, x, element, xi);
    return m->element[element].kind & ANCF_SPRING ? sqrt(dot(r, r)) - 1.0 : 0.5 * (dot(r, r) - 1.0);
}

double ancf_tension(const ancf_model* m, int element, double xi) {
    const ancf_element* el = &m->element[element];
    double r[3], rv[3];
    slope_at(r, m, m->x, element, xi);
    slope_at(rv, m, m->v, element, xi);
    const double stretch = sqrt(dot(r, r));
    if (el->kind & ANCF_SPRING) {
        const double tension = el->ea * (stretch - 1.0 + el->damping * dot(r, rv) / stretch);
        return stretch > 1.0 && tension > 0.0 ? tension : 0.0;
    }
    return el->ea * (0.5 * (dot(r, r) - 1.0) + el->damping * dot(r, rv)) * stretch;
}

double ancf_strain_max(const ancf_model* m, const double* x, int* element) {
    double largest = -1.0;
    for (int e = 0; e < m->n_elements; ++e)
        for (int p = 0; p < 3; ++p) {
            const double strain = ancf_strain(m, x, e, 0.5 * p);
            if (strain > largest) {
                largest = strain;
                *element = e;
            }
        }
    return largest;
}
