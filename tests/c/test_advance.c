// A step in one pass: to the last bit what its phases do, on any number of threads.
#include "build.h"

#include <omp.h>

enum { STEPS = 3 };

static const int kinds[] = {
    ANCF_LUMPED,          ANCF_LUMPED | ANCF_CURVATURE_EXACT, ANCF_LUMPED | ANCF_AXIAL_REDUCED, ANCF_SPRING, 0,
    ANCF_CURVATURE_EXACT, ANCF_LUMPED | ANCF_ENGINEERING};
enum { KINDS = sizeof kinds / sizeof *kinds, LAYOUTS = 7, CASES = KINDS * LAYOUTS * 2 };

static ancf_element element_of(int kind, double damping) {
    return (ancf_element) {.kind = kind,
                           .length = 0.1,
                           .ea = 40.0,
                           .ei = kind & ANCF_SPRING ? 0.0 : 2e-3,
                           .rho_a = 0.01,
                           .damping = damping};
}

// Cables and nets, longer and shorter than what is computed at once, smooth and with knots, closed, out of order.
static built layout_of(int layout, ancf_element all) {
    const int spring = all.kind & ANCF_SPRING;
    all.length *= layout == 0 ? 500 : layout == 1 ? 40 : layout == 2 ? 300 : 1;
    if (layout == 0) return build_cable(500, all, !spring);
    if (layout == 1) return build_cable(40, all, 0);
    if (layout == 2) { // some slopes of its own
        built b = build_cable(300, all, !spring);
        for (int e = 0; e < 300; ++e)
            if (e % 5 == 2 || e > 200) b.next[e] = -1;
        return b;
    }
    if (layout == 3) return build_net(6, all);
    if (layout == 4) return build_net(9, all);
    if (layout == 5) { // a closed ring, against the order of its elements
        const int n = 230;
        built b = build_start(n, n, all);
        for (int e = 0; e < n; ++e) {
            const double a = 2.0 * 3.14159265358979323846 * e / n;
            b.ends[2 * e] = n - 1 - e;
            b.ends[2 * e + 1] = (2 * n - 2 - e) % n;
            if (!spring) b.next[e] = (e + 1) % n;
            b.x[e] = 3.7 * cos(a);
            b.x[b.stride + e] = 3.7 * sin(a);
        }
        build_slopes(&b);
        return b;
    }
    built b = build_start(202, 200, all); // two cables, elements of both in turn
    for (int e = 0; e < 200; ++e) {
        const int node = e % 2 * 101 + e / 2;
        b.ends[2 * e] = node;
        b.ends[2 * e + 1] = node + 1;
        if (!spring && e < 198) b.next[e] = e + 2;
    }
    for (int i = 0; i < 202; ++i) {
        b.x[i] = 0.1 * (i % 101);
        b.x[b.stride + i] = i / 101;
    }
    build_slopes(&b);
    return b;
}

static built case_of(int k, uint64_t* seed) {
    const int kind = kinds[k % KINDS], layout = k / KINDS % LAYOUTS, hard = k / KINDS / LAYOUTS;
    built b = layout_of(layout, element_of(kind, hard ? 1e-4 : 0.0));
    build_shake(&b, b.x, 0.1, seed);
    build_shake(&b, b.v, 0.5, seed);
    if (hard) {
        const int n = b.def.n_nodes, e = b.def.n_elements;
        b.element[e / 2].ea *= 1.5;
        b.mass[n / 3] = 0.02;
        b.hold[0] = b.hold[n / 2] = ANCF_HELD;
        build_slide(&b, n / 2 - 1, (const double[3]) {1.0, 2.0, -0.5});
        build_slide(&b, n - 2, (const double[3]) {0.0, -1.0, 3.0});
        if (!(kind & ANCF_SPRING)) b.hold[n] = b.hold[n + e / 4] = b.hold[n + e + e / 3] = ANCF_HELD;
    }
    build_finish(&b);
    b.m->unloaded = !hard;
    for (int c = 0; c < 3 && hard; ++c) {
        b.m->gravity[c] = c == 1 ? 0.0 : -9.81 + c;
        for (int i = 0; i < b.n_dof; ++i) {
            b.m->external[c * b.stride + i] = random_between(seed, -0.1, 0.1);
            if (b.m->hold[i]) b.m->held[c * b.stride + i] = 0.1 * (c + i % 3);
        }
        for (int s = 0; s < b.m->n_shared; ++s)
            b.m->held[c * b.stride + b.m->shared[2 * s]] = b.m->held[c * b.stride + b.m->shared[2 * s + 1]];
    }
    return b;
}

static void assert_same(const double* a, const double* b, int n) {
    for (int i = 0; i < n; ++i)
        if (!(a[i] == b[i])) fail_msg("entry %d is %.17g, not %.17g", i, a[i], b[i]);
}

static void one_pass_is_the_phases(void** state) {
    (void)state;
    for (int k = 0; k < CASES; ++k) {
        uint64_t seed = 61 + (uint64_t)k, again = seed;
        built b = case_of(k, &seed), own = case_of(k, &again);
        ancf_time time = {.step = 1e-4};
        const size_t size = 3 * (size_t)b.stride * sizeof *b.x;
        double* start = malloc(size);
        memcpy(start, b.x, size);
        for (int i = 0; i < STEPS; ++i) {
            time.step = 1e-4 * (1 + i % 2);
            ancf_advance(b.m, &time);
            ancf_predict(own.m, &time);
            ancf_correct(own.m, &time, own.m->free, NULL);
            time.last = time.step;
            assert_same(b.x, own.x, 3 * b.stride);
            assert_same(b.v, own.v, 3 * b.stride);
            for (int j = 0; j < b.n_dof; ++j) { // what reactions are made of
                double force[3], expected[3];
                if (b.m->hold[j] == ANCF_FREE) continue;
                ancf_reaction(force, b.m, j);
                ancf_reaction(expected, own.m, j);
                assert_same(force, expected, 3);
            }
            for (int j = 0; j < b.def.n_nodes; ++j)
                for (int c = 0; c < 3 && b.mass[j] > 0.0; ++c)
                    assert_true(b.m->a[c * b.stride + j] == own.m->a[c * b.stride + j]);
        }
        assert_true(memcmp(start, b.x, size) != 0);
        free(start);
        build_free(&b);
        build_free(&own);
    }
}

// Forces on what is free, as the elements make them.
static double power_of(const built* b, const double* force, const double* velocity) {
    double sum = 0.0;
    for (int c = 0; c < 3; ++c)
        for (int i = 0; i < b->n_dof; ++i) sum += force[c * b->stride + i] * velocity[c * b->stride + i];
    return sum;
}

// A step whose energies are wanted takes the same way to the last bit. What it tells of damping is what the forces with
// less those without rates do, at the velocities before and after the kick.
static void energies_change_no_bit(void** state) {
    (void)state;
    for (int k = 0; k < CASES; ++k) {
        uint64_t seed = 64 + (uint64_t)k, again = seed;
        built b = case_of(k, &seed), own = case_of(k, &again);
        const size_t size = 3 * (size_t)b.stride;
        double *with = calloc(size, sizeof *with), *without = calloc(size, sizeof *without),
               *rest = calloc(size, sizeof *rest);
        ancf_time time = {.step = 1e-4};
        b.m->track = true;
        for (int i = 0; i < STEPS; ++i) {
            double axial, bending;
            ancf_elastic_energy(&axial, &bending, own.m, own.x, 0, own.def.n_elements);
            ancf_elastic_force(own.m, with, own.x, own.v);
            ancf_elastic_force(own.m, without, own.x, rest);
            ancf_predict(b.m, &time);
            ancf_predict(own.m, &time);
            for (size_t j = 0; j < size; ++j) with[j] -= without[j];
            const double damped[2] = {power_of(&own, with, own.v), power_of(&own, with, own.m->free)};
            const double scale = 1e-9 * (fabs(power_of(&own, without, own.v)) + fabs(damped[0]) + 1e-3);
            assert_near(b.m->elastic, axial + bending, 1e-13 * b.m->elastic);
            for (int j = 0; j < 2; ++j) assert_near(b.m->damping_power[j], damped[j], scale);
            ancf_correct(b.m, &time, b.m->free, NULL);
            ancf_correct(own.m, &time, own.m->free, NULL);
            time.last = time.step;
            assert_same(b.x, own.x, 3 * b.stride);
            assert_same(b.v, own.v, 3 * b.stride);
        }
        free(with);
        free(without);
        free(rest);
        build_free(&b);
        build_free(&own);
    }
}

// Both copies of a shared slope stay one.
static void shared_slopes_stay_one(void** state) {
    (void)state;
    for (int k = 0; k < CASES; ++k) {
        uint64_t seed = 62 + (uint64_t)k;
        built b = case_of(k, &seed);
        if (!b.m->unloaded) {
            build_free(&b);
            continue;
        }
        ancf_time time = {0};
        run_leapfrog(b.m, 1e-4, STEPS, &time);
        for (int s = 0; s < b.m->n_shared; ++s)
            for (int c = 0; c < 3; ++c) {
                const double* x = b.x + c * b.stride;
                assert_true(x[b.m->shared[2 * s]] == x[b.m->shared[2 * s + 1]]);
            }
        build_free(&b);
    }
}

// Large enough for threads; more of them than this machine may have.
static void threads_change_no_bit(void** state) {
    (void)state;
    const int before = omp_get_max_threads();
    for (int net = 0; net < 2; ++net) {
        built b[3];
        for (int t = 0; t < 3; ++t) {
            uint64_t seed = 63;
            ancf_element all = element_of(ANCF_LUMPED, 1e-4);
            if (!net) all.length *= 9000;
            b[t] = net ? build_net(60, all) : build_cable(9000, all, 1);
            build_shake(&b[t], b[t].x, 0.1, &seed);
            build_shake(&b[t], b[t].v, 0.5, &seed);
            b[t].hold[0] = b[t].hold[b[t].def.n_nodes / 2] = ANCF_HELD;
            build_finish(&b[t]);
            ancf_time time = {0};
            omp_set_num_threads(1 + t);
            run_leapfrog(b[t].m, 1e-4, 20, &time);
            assert_same(b[t].x, b[0].x, 3 * b[0].stride);
            assert_same(b[t].v, b[0].v, 3 * b[0].stride);
        }
        for (int t = 0; t < 3; ++t) build_free(&b[t]);
    }
    omp_set_num_threads(before);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_pass_is_the_phases),
        cmocka_unit_test(energies_change_no_bit),
        cmocka_unit_test(shared_slopes_stay_one),
        cmocka_unit_test(threads_change_no_bit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
