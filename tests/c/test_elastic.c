// Elastic and damping forces against derivatives of energies that are written here.
#include "build.h"

static const double pi = 3.14159265358979323846;

static void shape_functions_add_up(void** state) {
    (void)state;
    for (int i = -2; i <= 12; ++i) {
        const double xi = 0.1 * i, L = 0.7, h = 1e-6;
        double S[4], up[4], down[4], a[3], k[3], aup[3], adown[3];
        ancf_shape(S, xi, L);
        assert_near(S[0] + S[2], 1.0, 1e-14);               // partition of unity
        assert_near(S[1] + L * S[2] + S[3], L * xi, 1e-14); // a straight cable is straight
        ancf_shape(up, xi + h, L);
        ancf_shape(down, xi - h, L);
        ancf_shape_slope(a, xi);
        ancf_shape_curvature(k, xi);
        ancf_shape_slope(aup, xi + h);
        ancf_shape_slope(adown, xi - h);
        assert_near(a[0] + a[1] + a[2], 1.0, 1e-14);
        assert_near(k[0] + k[1] + k[2], 0.0, 1e-14);
        assert_near(a[0], (up[1] - down[1]) / (2 * h * L), 1e-8);
        assert_near(a[1], (up[2] - down[2]) / (2 * h), 1e-8);
        assert_near(a[2], (up[3] - down[3]) / (2 * h * L), 1e-8);
        for (int j = 0; j < 3; ++j) assert_near(k[j], (aup[j] - adown[j]) / (2 * h), 1e-8);
    }
    double S[4];
    ancf_shape(S, 0.0, 0.7);
    assert_true(S[0] == 1.0 && S[1] == 0.0 && S[2] == 0.0 && S[3] == 0.0);
    ancf_shape(S, 1.0, 0.7);
    assert_true(S[0] == 0.0 && S[2] == 1.0 && fabs(S[1]) < 1e-16 && S[3] == 0.0);
}

typedef struct {
    int kind;
    double ei, damping;
} variant;

static const variant variants[] = {
    {0, 0.0, 0.0},
    {0, 2e-2, 0.0},
    {ANCF_AXIAL_REDUCED, 0.0, 0.0},
    {ANCF_AXIAL_REDUCED, 2e-2, 0.0},
    {ANCF_CURVATURE_EXACT, 2e-2, 0.0},
    {ANCF_AXIAL_REDUCED | ANCF_CURVATURE_EXACT, 2e-2, 0.0},
    {ANCF_SPRING, 0.0, 0.0},
    {0, 0.0, 3e-3},
    {0, 2e-2, 3e-3},
    {ANCF_AXIAL_REDUCED, 2e-2, 3e-3},
    {ANCF_CURVATURE_EXACT, 2e-2, 3e-3},
    {ANCF_AXIAL_REDUCED | ANCF_CURVATURE_EXACT, 2e-2, 3e-3},
    {ANCF_SPRING, 0.0, 3e-3},
    {ANCF_ENGINEERING, 0.0, 0.0},
    {ANCF_ENGINEERING, 2e-2, 0.0},
    {ANCF_ENGINEERING | ANCF_AXIAL_REDUCED, 2e-2, 0.0},
    {ANCF_ENGINEERING | ANCF_CURVATURE_EXACT, 2e-2, 0.0},
    {ANCF_ENGINEERING, 0.0, 3e-3},
    {ANCF_ENGINEERING, 2e-2, 3e-3},
    {ANCF_ENGINEERING | ANCF_AXIAL_REDUCED, 0.0, 3e-3},
    {ANCF_ENGINEERING | ANCF_AXIAL_REDUCED | ANCF_CURVATURE_EXACT, 2e-2, 3e-3},
};
enum { VARIANTS = sizeof variants / sizeof *variants };

static ancf_element element_of(const variant* a) {
    return (ancf_element) {
        .kind = a->kind, .length = 0.3, .ea = 40.0, .ei = a->ei, .rho_a = 0.1, .damping = a->damping};
}

static const long double gauss3_xi[3] = {0.1127016653792583114820734600217600L, 0.5L,
                                         0.8872983346207416885179265399782400L};
static const long double gauss3_weight[3] = {5.0L / 18.0L, 8.0L / 18.0L, 5.0L / 18.0L};

static long double dot(const long double a[3], const long double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// r' and L r'' at xi from the element's vectors e[4][3] (r0, g0, r1, g1), derived from Eq. 3-4.
static void tangents(long double r[3], long double k[3], long double e[4][3], long double L, long double z) {
    for (int c = 0; c < 3; ++c) {
        r[c] = (e[2][c] - e[0][c]) * (6 * z - 6 * z * z) / L + e[1][c] * (1 - 4 * z + 3 * z * z) +
               e[3][c] * (3 * z * z - 2 * z);
        k[c] = (e[2][c] - e[0][c]) * (6 - 12 * z) / L + e[1][c] * (6 * z - 4) + e[3][c] * (6 * z - 2);
    }
}

static long double strain_at(long double e[4][3], long double L, long double z, int kind) {
    long double r[3], k[3];
    tangents(r, k, e, L, z);
    return kind & ANCF_ENGINEERING ? sqrtl(dot(r, r)) - 1.0L : 0.5L * (dot(r, r) - 1.0L);
}

static long double curvature_at(long double e[4][3], long double L, long double z, int kind) {
    long double r[3], k[3];
    tangents(r, k, e, L, z);
    if (!(kind & ANCF_CURVATURE_EXACT)) return sqrtl(dot(k, k)) / L;
    const long double x[3] = {r[1] * k[2] - r[2] * k[1], r[2] * k[0] - r[0] * k[2], r[0] * k[1] - r[1] * k[0]};
    return sqrtl(dot(x, x)) / dot(r, r) / L;
}

static long double stretch_of(long double e[4][3], long double L) {
    long double d[3];
    for (int c = 0; c < 3; ++c) d[c] = (e[2][c] - e[0][c]) / L;
    return sqrtl(dot(d, d));
}

// Energy of one element, from the definitions: EA/2 int eps^2 + EI/2 int kappa^2.
static long double own_energy(long double e[4][3], const ancf_element* el) {
    const long double L = el->length;
    long double sum = 0.0L;
    if (el->kind & ANCF_SPRING) {
        const long double strain = stretch_of(e, L) - 1.0L;
        return strain > 0.0L ? 0.5L * el->ea * L * strain * strain : 0.0L;
    }
    for (int p = 0; p < 3; ++p) {
        const long double eps = strain_at(e, L, gauss3_xi[p], el->kind),
                          kappa = curvature_at(e, L, gauss3_xi[p], el->kind);
        sum += 0.5L * gauss3_weight[p] * L * el->ei * kappa * kappa;
        if (el->kind & ANCF_AXIAL_REDUCED) sum += 0.5L * gauss3_weight[p] * L * el->ea * eps * eps;
    }
    for (int p = 0; p < 5 && !(el->kind & ANCF_AXIAL_REDUCED); ++p) { // 5 Gauss points are exact for degree 8
        const long double eps = strain_at(e, L, gauss5_xi[p], el->kind);
        sum += 0.5L * gauss5_weight[p] * L * el->ea * eps * eps;
    }
    return sum;
}

// Half the dissipated power of one element, eta/2 (EA int eps'^2 + EI int kappa'^2), at velocity v. The rates are
// differences along the motion. Axial: like the energy; fast curvature: at 2 Gauss points.
static long double own_dissipation(long double e[4][3], long double v[4][3], const ancf_element* el) {
    const long double L = el->length, h = 1e-7L;
    long double up[4][3], down[4][3], sum = 0.0L;
    for (int i = 0; i < 4; ++i)
        for (int c = 0; c < 3; ++c) {
            up[i][c] = e[i][c] + h * v[i][c];
            down[i][c] = e[i][c] - h * v[i][c];
        }
    if (el->kind & ANCF_SPRING) {
        const long double rate = (stretch_of(up, L) - stretch_of(down, L)) / (2.0L * h);
        return stretch_of(e, L) > 1.0L ? 0.5L * el->damping * el->ea * L * rate * rate : 0.0L;
    }
    const int points = el->kind & ANCF_AXIAL_REDUCED ? 3 : 5;
    for (int p = 0; p < points; ++p) {
        const long double xi = points == 3 ? gauss3_xi[p] : gauss5_xi[p];
        const long double weight = points == 3 ? gauss3_weight[p] : gauss5_weight[p];
        const long double rate = (strain_at(up, L, xi, el->kind) - strain_at(down, L, xi, el->kind)) / (2.0L * h);
        sum += weight * el->ea * rate * rate;
    }
    const int exact = el->kind & ANCF_CURVATURE_EXACT;
    for (int p = 0; p < (exact ? 3 : 2); ++p) {
        const long double xi = exact ? gauss3_xi[p] : 0.5L + (p ? 0.5L : -0.5L) / sqrtl(3.0L);
        const long double rate = (curvature_at(up, L, xi, el->kind) - curvature_at(down, L, xi, el->kind)) / (2.0L * h);
        sum += (exact ? gauss3_weight[p] : 0.5L) * el->ei * rate * rate;
    }
    return 0.5L * el->damping * L * sum;
}

static void vectors(long double e[4][3], const built* b, const double* field, int element) {
    int dof[4];
    ancf_model_dofs(dof, b->m, element);
    for (int i = 0; i < 4; ++i)
        for (int c = 0; c < 3; ++c) e[i][c] = field[c * b->stride + dof[i]];
}

// Expected forces of all elements, unknown by unknown: -dU/de - dR/de'.
static void own_force(double* force, const built* b, int damping) {
    memset(force, 0, 3 * (size_t)b->stride * sizeof *force);
    for (int e = 0; e < b->def.n_elements; ++e) {
        const ancf_element* el = &b->element[e];
        long double x[4][3], v[4][3];
        int dof[4];
        ancf_model_dofs(dof, b->m, e);
        vectors(x, b, b->x, e);
        vectors(v, b, b->v, e);
        for (int i = 0; i < 4; ++i)
            for (int c = 0; c < 3; ++c) {
                const long double h = 1e-5L, x0 = x[i][c], v0 = v[i][c], hv = 0.1L;
                x[i][c] = x0 + h;
                const long double up = own_energy(x, el);
                x[i][c] = x0 - h;
                const long double down = own_energy(x, el);
                x[i][c] = x0;
                double f = (double)(-(up - down) / (2.0L * h));
                if (damping && el->damping > 0.0) { // quadratic in v: any difference is exact
                    v[i][c] = v0 + hv;
                    const long double rup = own_dissipation(x, v, el);
                    v[i][c] = v0 - hv;
                    f -= (double)((rup - own_dissipation(x, v, el)) / (2.0L * hv));
                    v[i][c] = v0;
                }
                force[c * b->stride + dof[i]] += f;
            }
    }
}

static double largest(const double* field, const built* b) {
    double max = 0.0;
    for (int c = 0; c < 3; ++c)
        for (int i = 0; i < b->n_dof; ++i) max = fmax(max, fabs(field[c * b->stride + i]));
    return max;
}

static void check_force(built* b, double tolerance) {
    double* force = calloc(3 * (size_t)b->stride, sizeof *force);
    double* own = calloc(3 * (size_t)b->stride, sizeof *own);
    ancf_elastic_force(b->m, force, b->x, b->v);
    own_force(own, b, 1);
    const double scale = largest(own, b);
    assert_true(scale > 1e-3);
    for (int c = 0; c < 3; ++c)
        for (int i = 0; i < b->n_dof; ++i)
            assert_near(force[c * b->stride + i], own[c * b->stride + i], tolerance * scale);
    free(force);
    free(own);
}

static void force_is_derivative_of_energy(void** state) {
    (void)state;
    uint64_t seed = 11;
    for (int k = 0; k < VARIANTS; ++k)
        for (int run = 0; run < 3; ++run) {
            const ancf_element all = element_of(&variants[k]);
            built b = run ? build_net(1, all) : build_cable(3, all, !(all.kind & ANCF_SPRING));
            build_shake(&b, b.x, 0.4, &seed);
            if (all.kind & ANCF_SPRING && run)
                for (int i = 0; i < 3 * b.stride; ++i) b.x[i] *= 1.8; // taut: where slack, its rate law has a kink
            build_shake(&b, b.v, variants[k].damping > 0.0 && (all.kind & ANCF_SPRING) ? 0.01 : 1.0, &seed);
            build_finish(&b);
            check_force(&b, 1e-7);
            double axial, bending;
            long double sum = 0.0L, x[4][3];
            ancf_elastic_energy(&axial, &bending, b.m, b.x, 0, b.def.n_elements);
            for (int e = 0; e < b.def.n_elements; ++e) {
                vectors(x, &b, b.x, e);
                sum += own_energy(x, &b.element[e]);
            }
            assert_close(axial + bending, (double)sum, 1e-13);
            build_free(&b);
        }
}

// A model of many kinds at once, groups of one element and of many.
static void mixed_model_is_the_sum_of_its_parts(void** state) {
    (void)state;
    uint64_t seed = 12;
    built b = build_net(3, element_of(&variants[0]));
    for (int e = 0; e < b.def.n_elements; ++e) {
        b.element[e] = element_of(&variants[e < 10 ? 8 : e % 6]);
        b.element[e].length = random_between(&seed, 0.2, 0.35);
        b.element[e].ea = random_between(&seed, 10.0, 90.0);
    }
    build_shake(&b, b.x, 0.3, &seed);
    build_shake(&b, b.v, 0.3, &seed);
    build_finish(&b);
    check_force(&b, 1e-7);
    build_free(&b);
}

// Turns every vector of a field about an axis, by Rodrigues' formula, and shifts the nodes.
static void move_rigidly(const built* b, double* field, const double axis[3], double angle, const double shift[3]) {
    for (int i = 0; i < b->n_dof; ++i) {
        double u[3], along = 0.0;
        for (int c = 0; c < 3; ++c) {
            u[c] = field[c * b->stride + i];
            along += u[c] * axis[c];
        }
        for (int c = 0; c < 3; ++c) {
            const int j = (c + 1) % 3, k = (c + 2) % 3;
            field[c * b->stride + i] = u[c] * cos(angle) + (axis[j] * u[k] - axis[k] * u[j]) * sin(angle) +
                                       axis[c] * along * (1.0 - cos(angle)) + (i < b->def.n_nodes ? shift[c] : 0.0);
        }
    }
}

static void rigid_motion_gives_no_strain(void** state) {
    (void)state;
    const double axis[3] = {2.0 / 7.0, 3.0 / 7.0, 6.0 / 7.0}, shift[3] = {3.0, -2.0, 5.0};
    for (int k = 0; k < VARIANTS; ++k) {
        const ancf_element all = element_of(&variants[k]);
        built b = build_net(2, all);
        move_rigidly(&b, b.x, axis, 1.1, shift);
        build_finish(&b);
        double* f = calloc(3 * (size_t)b.stride, sizeof *f);
        ancf_elastic_force(b.m, f, b.x, b.v);
        assert_near(largest(f, &b), 0.0, 1e-12 * all.ea);
        for (int e = 0; e < b.def.n_elements; ++e)
            for (int p = 0; p <= 4; ++p) assert_near(ancf_strain(b.m, b.x, e, 0.25 * p), 0.0, 1e-14);
        free(f);
        build_free(&b);
    }
}

// Power that damping takes out: of the part of the force that goes with the velocity.
static double damping_power(const built* b) {
    const size_t n = 3 * (size_t)b->stride;
    double *still = calloc(n, sizeof *still), *at_rest = calloc(n, sizeof *at_rest),
           *moving = calloc(n, sizeof *moving);
    ancf_elastic_force(b->m, at_rest, b->x, still);
    ancf_elastic_force(b->m, moving, b->x, b->v);
    long double power = 0.0L;
    for (size_t i = 0; i < n; ++i) power -= ((long double)moving[i] - at_rest[i]) * b->v[i];
    free(still);
    free(at_rest);
    free(moving);
    return (double)power;
}

static void rigid_motion_is_not_damped(void** state) {
    (void)state;
    uint64_t seed = 13;
    const double w[3] = {3.0, -7.0, 2.0};
    for (int k = 0; k < VARIANTS; ++k) {
        if (variants[k].damping <= 0.0) continue;
        built b = build_net(2, element_of(&variants[k]));
        build_shake(&b, b.x, 0.4, &seed);
        build_finish(&b);
        const size_t n = 3 * (size_t)b.stride;
        double *at_rest = calloc(n, sizeof *at_rest), *moving = calloc(n, sizeof *moving);
        ancf_elastic_force(b.m, at_rest, b.x, b.v);
        for (int i = 0; i < b.n_dof; ++i)
            for (int c = 0; c < 3; ++c) {
                const int j = (c + 1) % 3, l = (c + 2) % 3;
                b.v[c * b.stride + i] = w[j] * b.x[l * b.stride + i] - w[l] * b.x[j * b.stride + i] +
                                        (i < b.def.n_nodes ? 4.0 * c - 3.0 : 0.0);
            }
        ancf_elastic_force(b.m, moving, b.x, b.v);
        for (size_t i = 0; i < n; ++i) assert_near(moving[i], at_rest[i], 1e-13 * largest(at_rest, &b));
        // And the test can see damping: the same field, stretched.
        for (int i = 0; i < b.n_dof; ++i) b.v[i] += 0.1 * b.x[i];
        assert_true(damping_power(&b) > 1e-6);
        free(at_rest);
        free(moving);
        build_free(&b);
    }
}

static void damping_takes_out_twice_its_function(void** state) {
    (void)state;
    uint64_t seed = 14;
    for (int k = 0; k < VARIANTS; ++k) {
        built b = build_net(1, element_of(&variants[k]));
        const int spring = variants[k].kind & ANCF_SPRING;
        build_shake(&b, b.x, 0.3, &seed);
        for (int i = 0; i < 3 * b.stride && spring; ++i) b.x[i] *= 1.8;
        build_shake(&b, b.v, spring ? 0.01 : 1.0, &seed);
        build_finish(&b);
        long double sum = 0.0L, x[4][3], v[4][3];
        for (int e = 0; e < b.def.n_elements; ++e) {
            vectors(x, &b, b.x, e);
            vectors(v, &b, b.v, e);
            sum += 2.0L * own_dissipation(x, v, &b.element[e]);
        }
        assert_near(damping_power(&b), (double)sum, 1e-8 * (double)sum);
        build_free(&b);
    }
}

// A straight cable at stretch 1.2 that grows at 0.5 /s: eps = 0.22, eps' = 1.2 x 0.5, tension EA (eps + eta eps') 1.2;
// of engineering strain eps = 0.2, eps' = 0.5, EA (eps + eta eps').
static void tension_of_a_stretched_cable(void** state) {
    (void)state;
    for (int k = 0; k < VARIANTS; ++k) {
        const ancf_element all = element_of(&variants[k]);
        built b = build_cable(3, all, 0);
        for (int i = 0; i < b.n_dof; ++i) {
            b.v[i] = 0.5 * b.x[i];
            b.x[i] *= 1.2;
        }
        build_finish(&b);
        const int plain = all.kind & (ANCF_SPRING | ANCF_ENGINEERING);
        const double strain = plain ? 0.2 : 0.22, rate = plain ? 0.5 : 0.6;
        const double tension = all.ea * (strain + all.damping * rate) * (plain ? 1.0 : 1.2);
        double* f = calloc(3 * (size_t)b.stride, sizeof *f);
        ancf_elastic_force(b.m, f, b.x, b.v);
        for (int e = 0; e < 3; ++e)
            for (int p = 0; p <= 3; ++p) {
                assert_close(ancf_strain(b.m, b.x, e, p / 3.0), strain, 1e-13);
                assert_close(ancf_tension(b.m, e, p / 3.0), tension, 1e-13);
            }
        assert_close(f[0], tension, 1e-12); // pulls the start forward
        assert_close(f[3], -tension, 1e-12);
        assert_near(f[1], 0.0, 1e-12);
        int at = -1;
        assert_close(ancf_strain_max(b.m, b.x, &at), strain, 1e-13);
        assert_in_range(at, 0, 2);
        for (int i = 0; i < 3 * b.stride; ++i) b.x[i] = NAN;
        at = -1;
        ancf_strain_max(b.m, b.x, &at);
        assert_in_range(at, 0, 2);
        free(f);
        build_free(&b);
    }
}

static void slack_spring_is_free(void** state) {
    (void)state;
    const ancf_element all = element_of(&variants[12]);
    built b = build_cable(2, all, 0);
    for (int i = 0; i < b.n_dof; ++i) {
        b.v[i] = -b.x[i];
        b.x[i] *= 0.9;
    }
    build_finish(&b);
    double* f = calloc(3 * (size_t)b.stride, sizeof *f);
    ancf_elastic_force(b.m, f, b.x, b.v);
    assert_true(largest(f, &b) == 0.0);
    assert_true(ancf_tension(b.m, 0, 0.5) == 0.0);
    for (int i = 0; i < b.n_dof; ++i) b.v[i] = 100.0 * b.x[i]; // lengthening fast, but slack still
    ancf_elastic_force(b.m, f, b.x, b.v);
    assert_true(largest(f, &b) == 0.0);
    for (int i = 0; i < b.n_dof; ++i) b.x[i] *= 1.12 / 0.9; // taut, but slackening fast: never pushes
    for (int i = 0; i < b.n_dof; ++i) b.v[i] = -100.0 * b.x[i];
    ancf_elastic_force(b.m, f, b.x, b.v);
    assert_true(largest(f, &b) == 0.0);
    free(f);
    build_free(&b);
}

// A straight rod bent into a quarter of a circle stores EI (pi/2)^2/(2 L).
static void bent_into_an_arc(void** state) {
    (void)state;
    for (int exact = 0; exact < 2; ++exact) {
        const int n = 16;
        const ancf_element all = {
            .kind = exact ? ANCF_CURVATURE_EXACT : 0, .length = 1.0, .ea = 50.0, .ei = 0.3, .rho_a = 1.0};
        built b = build_cable(n, all, 1);
        const double R = 2.0 / pi;
        for (int i = 0; i <= n; ++i) {
            const double a = 0.5 * pi * i / n;
            b.x[i] = R * sin(a);
            b.x[b.stride + i] = R * (1.0 - cos(a));
            if (i < n) {
                b.x[n + 1 + i] = cos(a);
                b.x[b.stride + n + 1 + i] = sin(a);
            }
            if (i > 0) {
                b.x[2 * n + i] = cos(a);
                b.x[b.stride + 2 * n + i] = sin(a);
            }
        }
        build_finish(&b);
        double axial, bending;
        ancf_elastic_energy(&axial, &bending, b.m, b.x, 0, n);
        assert_close(bending, 0.3 * pi * pi / 4.0 / 2.0, 1e-5);
        assert_near(axial, 0.0, 1e-6 * bending);
        build_free(&b);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(shape_functions_add_up),
        cmocka_unit_test(force_is_derivative_of_energy),
        cmocka_unit_test(mixed_model_is_the_sum_of_its_parts),
        cmocka_unit_test(rigid_motion_gives_no_strain),
        cmocka_unit_test(rigid_motion_is_not_damped),
        cmocka_unit_test(damping_takes_out_twice_its_function),
        cmocka_unit_test(tension_of_a_stretched_cable),
        cmocka_unit_test(slack_spring_is_free),
        cmocka_unit_test(bent_into_an_arc),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
