// The stable step: against eigenvalues computed here, and against what leapfrog does above and below it.
#include "build.h"

#include "ancf/stability.h"

// Stiffness of an element, straight along x and unstressed, by quadrature: along it EA S'S'^T, across EI S''S''^T.
static void own_stiffness(double K[4][4], const ancf_element* el, int across) {
    const double L = el->length;
    memset(K, 0, 16 * sizeof(double));
    for (int p = 0; p < 5; ++p) {
        const double z = gauss5_xi[p];
        const double slope[4] = {(6 * z * z - 6 * z) / L, 1 - 4 * z + 3 * z * z, (6 * z - 6 * z * z) / L,
                                 3 * z * z - 2 * z};
        const double bend[4] = {(12 * z - 6) / (L * L), (6 * z - 4) / L, (6 - 12 * z) / (L * L), (6 * z - 2) / L};
        for (int i = 0; i < 4; ++i)
            for (int j = 0; j < 4; ++j)
                K[i][j] += gauss5_weight[p] * L * (across ? el->ei * bend[i] * bend[j] : el->ea * slope[i] * slope[j]);
    }
}

// Largest w of K u = w^2 M u: power iteration with M^-1 K, M inverted by elimination.
static double own_frequency(double K[4][4], double M[4][4]) {
    double A[4][8], u[4] = {1.0, -0.3, -0.7, 0.4}, w2 = 0.0;
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) {
            A[i][j] = M[i][j];
            A[i][4 + j] = K[i][j];
        }
    for (int j = 0; j < 4; ++j) {
        const double pivot = A[j][j];
        for (int k = 0; k < 8; ++k) A[j][k] /= pivot;
        for (int i = 0; i < 4; ++i)
            for (int k = 7; k >= j && i != j; --k) A[i][k] -= A[i][j] * A[j][k];
    }
    for (int it = 0; it < 20000; ++it) {
        double next[4] = {0.0}, size = 0.0;
        for (int i = 0; i < 4; ++i) {
            for (int j = 0; j < 4; ++j) next[i] += A[i][4 + j] * u[j];
            size = fmax(size, fabs(next[i]));
        }
        w2 = size;
        for (int i = 0; i < 4; ++i) u[i] = size > 0.0 ? next[i] / size : 0.0;
    }
    return sqrt(w2);
}

static void element_frequency_is_the_largest(void** state) {
    (void)state;
    const ancf_element el[] = {
        {.kind = 0, .length = 0.08, .ea = 350.0, .ei = 2.2e-5, .rho_a = 1.1e-3},
        {.kind = ANCF_LUMPED, .length = 0.08, .ea = 350.0, .ei = 2.2e-5, .rho_a = 1.1e-3},
        {.kind = 0, .length = 0.5, .ea = 1.0, .ei = 30.0, .rho_a = 1.0},
        {.kind = ANCF_LUMPED, .length = 0.5, .ea = 1.0, .ei = 30.0, .rho_a = 1.0},
        {.kind = 0, .length = 2.0, .ea = 1e4, .ei = 0.0, .rho_a = 0.3},
    };
    for (size_t k = 0; k < sizeof el / sizeof *el; ++k) {
        double M[4][4], K[4][4], along, across;
        own_mass(M, &el[k]);
        own_stiffness(K, &el[k], 0);
        along = own_frequency(K, M);
        own_stiffness(K, &el[k], 1);
        across = own_frequency(K, M);
        assert_close(ancf_element_frequency(&el[k]), fmax(along, across), 1e-6);
    }
    // A spring between two halves of its mass: w^2 = 2 (EA/L)/(rho A L/2).
    const ancf_element spring = {.kind = ANCF_SPRING, .length = 0.2, .ea = 50.0, .rho_a = 0.01};
    assert_close(ancf_element_frequency(&spring), sqrt(4.0 * 50.0 / 0.01) / 0.2, 1e-12);
}

// h = 0.9 (2/w)(sqrt(1 + z^2) - z), z = eta w/2, w the element's times sqrt(1 + 3 strain).
static void rule_by_hand(void** state) {
    (void)state;
    const ancf_element spring = {.kind = ANCF_SPRING, .length = 1.0, .ea = 25.0, .rho_a = 1.0, .damping = 0.15};
    built b = build_cable(3, (ancf_element) {.kind = ANCF_SPRING, .length = 3.0, .ea = 25.0, .rho_a = 1.0}, 0);
    b.element[1].damping = spring.damping;
    build_finish(&b);
    int at = -1;
    // w = 10, z = 0.75: 0.9 x 0.2 x (1.25 - 0.75).
    assert_close(ancf_critical_step(b.m, 0.0, &at), 0.09, 1e-9);
    assert_int_equal(at, 1);
    const double w = 10.0 * sqrt(1.6), z = 0.075 * w;
    assert_close(ancf_critical_step(b.m, 0.2, &at), 1.8 / w * (sqrt(1.0 + z * z) - z), 1e-9);
    build_free(&b);
    // Mass-proportional damping: z = drag/(2 w).
    b = build_cable(1, (ancf_element) {.kind = ANCF_SPRING, .length = 1.0, .ea = 25.0, .rho_a = 1.0, .drag = 15.0}, 0);
    build_finish(&b);
    assert_close(ancf_critical_step(b.m, 0.0, &at), 0.09, 1e-9);
    build_free(&b);
}

// So much damping that h w -> 0.9/z: w = 10 sqrt(1 + 3 strain) as above, z = 0.075 w.
static void much_damping_leaves_a_step(void** state) {
    (void)state;
    built b = build_cable(1, (ancf_element) {.kind = ANCF_SPRING, .length = 1.0, .ea = 25.0, .rho_a = 1.0}, 0);
    b.element[0].damping = 0.15;
    build_finish(&b);
    int at = -1;
    for (double strain = 1e10; strain < 1e20; strain *= 10.0)
        assert_close(ancf_critical_step(b.m, strain, &at), 0.9 / (0.075 * 100.0 * (1.0 + 3.0 * strain)), 1e-9);
    build_free(&b);
}

// Largest speed that a small nudge has grown to after some thousand steps, over that at the start.
static double growth(built* b, double factor, int steps) {
    uint64_t seed = 31;
    int at;
    ancf_time time = {0};
    const double h = factor * ancf_critical_step(b->m, 0.0, &at);
    double first = 0.0, last = 0.0;
    build_shake(b, b->v, 1e-2, &seed);
    for (int i = 0; i < 3 * b->stride; ++i) first = fmax(first, fabs(b->v[i]));
    run_leapfrog(b->m, h, steps, &time);
    for (int i = 0; i < 3 * b->stride; ++i) {
        if (!isfinite(b->v[i])) return INFINITY;
        last = fmax(last, fabs(b->v[i]));
    }
    return last / first;
}

// Five cables and two nets, and two cables whose shared slopes and full mass make the element a cautious bound.
enum { TIGHT = 7, SCENES = 9 };

static built scene(int which, int damped) {
    static const ancf_element cable[] = {
        {.kind = ANCF_LUMPED, .length = 1.0, .ea = 350.0, .ei = 2.2e-5, .rho_a = 1.1e-3, .damping = 5e-5},
        {.kind = 0, .length = 1.0, .ea = 350.0, .ei = 2.2e-5, .rho_a = 1.1e-3, .damping = 5e-5},
        {.kind = ANCF_LUMPED | ANCF_CURVATURE_EXACT, .length = 2., .ea = 1e4, .ei = 20., .rho_a = .5, .damping = 1e-4},
        {.kind = ANCF_LUMPED | ANCF_AXIAL_REDUCED, .length = .5, .ea = 40., .ei = .2, .rho_a = .02, .damping = 1e-3},
        {.kind = ANCF_SPRING, .length = 1.0, .ea = 350.0, .rho_a = 1.1e-3, .damping = 5e-5},
        {.kind = 0, .length = 1.0, .ea = 350.0, .ei = 2.2e-5, .rho_a = 1.1e-3, .damping = 5e-5},
        {.kind = ANCF_CURVATURE_EXACT, .length = 2.0, .ea = 1e4, .ei = 20.0, .rho_a = 0.5, .damping = 1e-4},
    };
    static const int elements[] = {10, 4, 8, 5, 12, 4, 8}, smooth[] = {0, 0, 1, 1, 0, 1, 1};
    const int net = which == 5 || which == 6, k = which < 5 ? which : which - 2;
    ancf_element all = net ? net_element(which == 5 ? ANCF_LUMPED : 0, 5e-5) : cable[k];
    if (!damped) all.damping = 0.0;
    built b = net ? build_net(6, all) : build_cable(elements[k], all, smooth[k]);
    if (all.kind & ANCF_SPRING) { // taut, or it would not resist
        for (int i = 0; i < b.n_dof; ++i) b.x[i] *= 1.0001;
        b.hold[0] = b.hold[b.def.n_nodes - 1] = ANCF_HELD;
    }
    build_finish(&b);
    return b;
}

static void rule_is_stable_and_tight(void** state) {
    (void)state;
    for (int which = 0; which < SCENES; ++which)
        for (int damped = 0; damped < 2; ++damped) {
            built b = scene(which, damped);
            const double below = growth(&b, 1.0, 20000);
            build_free(&b);
            if (!(below < 30.0)) fail_msg("scene %d damped %d: not stable at the rule, %g", which, damped, below);
            if (which >= TIGHT) continue;
            b = scene(which, damped);
            const double above = growth(&b, 1.7, 20000);
            build_free(&b);
            if (!(above > 1e3)) fail_msg("scene %d damped %d: stable at 1.7, %g", which, damped, above);
        }
}

// Mass-proportional damping in a single element, whose frequency is known exactly.
static void rule_with_drag(void** state) {
    (void)state;
    for (int above = 0; above < 2; ++above) {
        ancf_element all = {.kind = ANCF_LUMPED, .length = 1.0, .ea = 350.0, .ei = 2.2e-5, .rho_a = 1.1e-3};
        all.drag = ancf_element_frequency(&all);
        built b = build_cable(1, all, 0);
        build_finish(&b);
        const double grown = growth(&b, above ? 1.15 : 1.0, 20000);
        assert_true(above ? grown > 1e3 : grown < 30.0);
        build_free(&b);
    }
}

// The same with engineering strain, which stiffens by bending across alone: the rule is stable.
static void step_with_engineering_strain(void** state) {
    (void)state;
    for (int soft = 0; soft < 2; ++soft) {
        const ancf_element all = {.kind = ANCF_LUMPED | ANCF_ENGINEERING,
                                  .length = 1.0,
                                  .ea = 350.0,
                                  .ei = soft ? 2.2e-5 : 0.8,
                                  .rho_a = 1.1e-3};
        built b = build_cable(6, all, 0);
        for (int i = 0; i < b.n_dof; ++i) b.x[i] *= 1.2;
        b.hold[0] = b.hold[b.def.n_nodes - 1] = ANCF_HELD;
        build_finish(&b);
        int at;
        const double strained = ancf_critical_step(b.m, ancf_strain_max(b.m, b.x, &at), &at);
        const double plain = ancf_critical_step(b.m, 0.0, &at);
        assert_close(strained, plain / sqrt(1.2), 1e-12);
        assert_true(growth(&b, strained / plain, 20000) < 30.0);
        build_free(&b);
    }
}

// A cable held stretched by a fifth: the rule with the strain is stable, 1.1 times the unstressed one is not.
static void strain_makes_the_step_shorter(void** state) {
    (void)state;
    for (int taut = 0; taut < 2; ++taut) {
        const ancf_element all = {.kind = ANCF_LUMPED, .length = 1.0, .ea = 350.0, .ei = 2.2e-5, .rho_a = 1.1e-3};
        built b = build_cable(6, all, 0);
        for (int i = 0; i < b.n_dof; ++i) b.x[i] *= 1.2;
        b.hold[0] = b.hold[b.def.n_nodes - 1] = ANCF_HELD;
        build_finish(&b);
        int at;
        const double strained = ancf_critical_step(b.m, ancf_strain_max(b.m, b.x, &at), &at);
        const double plain = ancf_critical_step(b.m, 0.0, &at);
        assert_close(strained, plain / sqrt(1.0 + 3.0 * 0.22), 1e-12);
        if (taut) assert_true(growth(&b, strained / plain, 20000) < 30.0);
        else assert_true(growth(&b, 1.1, 20000) > 1e3);
        build_free(&b);
    }
}

static void speeds_are_compared_along_axes(void** state) {
    (void)state;
    built b = build_net(4, net_element(ANCF_LUMPED, 0.0));
    build_finish(&b);
    const int n = b.def.n_nodes;
    for (int c = 0; c < 3; ++c)
        for (int i = 0; i < b.m->stride; ++i)
            b.v[c * b.m->stride + i] = i < n ? 7000.0 + c : 1e9; // slopes do not count
    assert_true(ancf_speed_spread(b.m, b.v) == 0.0);
    b.v[0] -= 3.0;
    b.v[n - 1] += 1.0;
    b.v[b.m->stride + 2] += 3.5;
    assert_close(ancf_speed_spread(b.m, b.v), 4.0, 1e-12);
    build_free(&b);
}

static void any_value_that_is_no_number_is_seen(void** state) {
    (void)state;
    built b = build_net(4, net_element(ANCF_LUMPED, 0.0));
    build_finish(&b);
    assert_true(ancf_finite(b.m, b.x));
    for (int c = 0; c < 3; ++c)
        for (int i = 0; i < b.m->n_dof; ++i)
            for (int k = 0; k < 3; ++k) {
                double* value = &b.x[c * b.m->stride + i];
                const double kept = *value;
                *value = k == 0 ? NAN : k == 1 ? INFINITY : -INFINITY;
                assert_false(ancf_finite(b.m, b.x));
                *value = kept;
            }
    build_free(&b);
}

// What the formula cannot compute is no step at all, and the element is named; a short one would be a lie.
static void extremes_give_no_step(void** state) {
    (void)state;
    const ancf_element extreme[] = {
        {.kind = ANCF_LUMPED, .length = 1e-300, .ea = 350.0, .ei = 2.2e-5, .rho_a = 1.1e-3},
        {.kind = 0, .length = 1e-300, .ea = 350.0, .ei = 2.2e-5, .rho_a = 1.1e-3},
        {.kind = 0, .length = 1.0, .ea = 350.0, .ei = 2.2e-5, .rho_a = 1e-300},
        {.kind = 0, .length = 1.0, .ea = 1e300, .ei = 2.2e-5, .rho_a = 1.1e-3},
        {.kind = 0, .length = 1.0, .ea = 350.0, .ei = 1e300, .rho_a = 1.1e-3},
        {.kind = ANCF_SPRING, .length = 1.0, .ea = 1e-300, .rho_a = 1e300},
        {.kind = ANCF_LUMPED, .length = 1.0, .ea = 350.0, .ei = 2.2e-5, .rho_a = 1.1e-3, .damping = 1e300},
    };
    for (size_t k = 0; k < sizeof extreme / sizeof *extreme; ++k) {
        ancf_element pair[2] = {{.length = 1.0, .ea = 350.0, .rho_a = 1.1e-3}, extreme[k]};
        int at = -1;
        const double own = ancf_critical_step(&(ancf_model) {.n_elements = 1, .element = &pair[1]}, 0.1, &at);
        assert_int_equal(at, 0);
        if (isfinite(own) && own > 0.0) fail_msg("element %zu: a step of %g s", k, own);
        const double both = ancf_critical_step(&(ancf_model) {.n_elements = 2, .element = pair}, 0.1, &at);
        assert_int_equal(at, own == INFINITY ? 0 : 1); // one without any stiffness limits nothing
        assert_true(own == INFINITY || !(both > 0.0));
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(element_frequency_is_the_largest),    cmocka_unit_test(rule_by_hand),
        cmocka_unit_test(much_damping_leaves_a_step),          cmocka_unit_test(rule_is_stable_and_tight),
        cmocka_unit_test(strain_makes_the_step_shorter),       cmocka_unit_test(rule_with_drag),
        cmocka_unit_test(step_with_engineering_strain),        cmocka_unit_test(speeds_are_compared_along_axes),
        cmocka_unit_test(any_value_that_is_no_number_is_seen), cmocka_unit_test(extremes_give_no_step),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
