// Generalised-alpha against its own theory, closed forms, conserved quantities, and explicit schemes.
#include "build.h"

#include "ancf/implicit.h"

static const double pi = 3.14159265358979323846;

typedef struct {
    ancf_implicit* s;
    double* a;
    ancf_time time;
} stepper;

static stepper start(const built* b, double rho) {
    stepper run = {.a = calloc(3 * (size_t)b->stride, sizeof(double))};
    assert_int_equal(ancf_implicit_create(&run.s, b->m, rho), ANCF_OK);
    return run;
}

static void stop(stepper* run) {
    ancf_implicit_destroy(run->s);
    free(run->a);
}

static void steps(stepper* run, built* b, double h, int n) {
    run->time.step = h;
    for (int i = 0; i < n; ++i) {
        assert_int_equal(ancf_implicit_step(run->s, b->m, run->a, &run->time, 1), ANCF_OK);
        run->time.last = h;
    }
}

static double distance(const double x[3], const double y[3]) {
    return sqrt((x[0] - y[0]) * (x[0] - y[0]) + (x[1] - y[1]) * (x[1] - y[1]) + (x[2] - y[2]) * (x[2] - y[2]));
}

// Along a chain of N springs under tension, mode j is an oscillator of frequency w = 2 sqrt(k/m) sin(j pi/(2 N)). Its
// recursion in (q, q', q'') is three lines of the paper, and must be followed whatever w h is.
static void recursion_of_an_oscillator(void** state) {
    (void)state;
    const int n = 12, mode = 5;
    const double stretch = 1.5, L = 3.0, ea = 400.0, rho_a = 0.01, l0 = L / n, size = 1e-6;
    const double w = 2.0 * sqrt(ea / l0 / (rho_a * l0)) * sin(0.5 * mode * pi / n);
    for (int k = 0; k < 6; ++k) {
        const double rho = (double[]) {0.0, 0.5, 0.9}[k / 2], h = (k % 2 ? 8.0 : 0.3) / w;
        const ancf_element all = {.kind = ANCF_SPRING, .length = L, .ea = ea, .rho_a = rho_a};
        built b = build_cable(n, all, 0);
        double shape[13], rest[13];
        for (int i = 0; i <= n; ++i) {
            shape[i] = sin(mode * pi * i / n);
            rest[i] = b.x[i] *= stretch;
            b.x[i] += size * shape[i];
            b.v[i] = 0.4 * w * size * shape[i];
        }
        b.hold[0] = b.hold[n] = ANCF_HELD;
        build_finish(&b);
        stepper run = start(&b, rho);
        double q = size, v = 0.4 * w * size, a = -w * w * q;
        const double am = (2 * rho - 1) / (rho + 1), af = rho / (rho + 1), gamma = 0.5 - am + af;
        const double beta = 0.25 * (1 - am + af) * (1 - am + af);
        for (int i = 0; i < 40; ++i) {
            steps(&run, &b, h, 1);
            const double q1 = q + h * v + h * h * (0.5 - beta) * a; // and beta a_new
            const double next =
                (-am * a - w * w * ((1 - af) * q1 + af * q)) / (1 - am + w * w * (1 - af) * h * h * beta);
            v += h * ((1 - gamma) * a + gamma * next);
            q = q1 + h * h * beta * next;
            a = next;
            for (int j = 1; j < n; ++j) {
                assert_near(b.x[j] - rest[j], q * shape[j], 1e-8 * size);
                assert_near(b.v[j], v * shape[j], 1e-8 * size * w);
            }
        }
        if (k == 1) assert_true(fabs(q) < 1e-7 * size); // rho = 0: what is not resolved is gone
        stop(&run);
        build_free(&b);
    }
}

// A smooth motion of a soft cable with a mass at its end; the other end is held, or led up and down.
static built swinging_cable(int kind, double damping) {
    const ancf_element all = {.kind = kind,
                              .length = 1.0,
                              .ea = 30.0,
                              .ei = kind & ANCF_SPRING ? 0.0 : 0.02,
                              .rho_a = 0.4,
                              .damping = damping};
    built b = build_cable(3, all, !(kind & ANCF_SPRING));
    const double slope = kind & ANCF_SPRING ? 0.0 : 1.0;
    for (int i = 0; i < b.def.n_nodes; ++i) {
        b.x[i] *= 1.2;
        b.v[2 * b.stride + i] = -1.5 * b.x[i] * b.x[i];
        b.v[b.stride + i] = 0.7 * b.x[i];
    }
    for (int e = 0; e < 3; ++e)
        for (int k = 0; k < 2; ++k) {
            const int dof = 4 + 3 * k + e;
            b.x[dof] = 1.2 * slope;
            b.v[2 * b.stride + dof] = -3.0 * 1.2 * 1.2 * (e + k) / 3.0 * slope;
            b.v[b.stride + dof] = 0.7 * 1.2 * slope;
        }
    b.mass[3] = 0.1;
    b.hold[0] = ANCF_HELD;
    build_finish(&b);
    b.m->gravity[1] = -9.81;
    return b;
}

static void lead(built* b, int led, double t, double h) { // the mean velocity of 0.05 (1 - cos 9 t) over a step
    if (led) b->m->held[b->stride] = 0.05 * (cos(9.0 * t) - cos(9.0 * (t + h))) / h;
}

static void end_after(double x[3], int kind, double damping, int led, int n, int implicit) {
    built b = swinging_cable(kind, damping);
    stepper run = start(&b, 0.8);
    const double h = 0.3 / n;
    for (int i = 0; i < n; ++i) {
        lead(&b, led, i * h, h);
        if (implicit) steps(&run, &b, h, 1);
        else run_leapfrog(b.m, h, 1, &run.time);
    }
    for (int c = 0; c < 3; ++c) x[c] = b.x[c * b.stride + 3];
    stop(&run);
    build_free(&b);
}

static void second_order(void** state) {
    (void)state;
    const int kinds[] = {0, ANCF_LUMPED, ANCF_CURVATURE_EXACT, ANCF_AXIAL_REDUCED, ANCF_CURVATURE_EXACT,
                         0, ANCF_SPRING};
    for (int k = 0; k < 7; ++k) {
        const double damping = k >= 4 && k < 6 ? 2e-3 : 0.0;
        for (int led = 0; led < 2; ++led) {
            double one[3], two[3], fine[3], x[3], error[3];
            // Leapfrog's lagged damping is of first order: its limit by extrapolation, of second otherwise.
            end_after(one, kinds[k], damping, led, 20000, 0);
            end_after(two, kinds[k], damping, led, 40000, 0);
            for (int c = 0; c < 3; ++c) fine[c] = two[c] + (two[c] - one[c]) / (damping > 0.0 ? 1.0 : 3.0);
            for (int i = 0; i < 3; ++i) {
                end_after(x, kinds[k], damping, led, 150 << i, 1);
                error[i] = distance(x, fine);
            }
            for (int i = 0; i < 2; ++i) {
                const double order = log2(error[i] / error[i + 1]);
                if (order < 1.85)
                    fail_msg("kind %d damping %g led %d: order %.3f of 2 (errors %g %g %g)", kinds[k], damping, led,
                             order, error[0], error[1], error[2]);
            }
        }
    }
}

// A net with heavy corners, its state shaken.
static built shaken_net(uint64_t* seed) {
    built b = build_net(4, net_element(ANCF_CURVATURE_EXACT, 0.0));
    b.mass[0] = b.mass[24] = 0.05;
    build_shake(&b, b.x, 0.02, seed);
    build_shake(&b, b.v, 0.1, seed);
    return b;
}

// Free fall is exact, turning and all; momentum is constant in flight, whatever the step.
static void momentum(void** state) {
    (void)state;
    uint64_t seed = 91;
    built b = shaken_net(&seed);
    for (int i = 0; i < b.def.n_nodes; ++i) b.v[i] += 3.0;
    build_finish(&b);
    b.m->gravity[2] = -9.81;
    double P0[3], H0[3], P[3], H[3], terms[2], weight = 0.1;
    for (int e = 0; e < b.def.n_elements; ++e) weight += b.element[e].rho_a * b.element[e].length;
    own_momentum(P0, H0, terms, &b);
    stepper run = start(&b, 0.9);
    steps(&run, &b, 1e-3, 100);
    own_momentum(P, H, terms, &b);
    assert_near(P[0], P0[0], 1e-11 * terms[0]);
    assert_near(P[1], P0[1], 1e-11 * terms[0]);
    assert_near(P[2], P0[2] - 9.81 * 0.1 * weight, 1e-11 * terms[0]);
    stop(&run);
    build_free(&b);
}

// The angular momentum of a free spinning cable goes astray with the square of the step.
static void angular_momentum(void** state) {
    (void)state;
    double error[3] = {0.0, 0.0, 0.0};
    for (int k = 0; k < 3; ++k) {
        const ancf_element all = {.length = 1.0, .ea = 200.0, .ei = 0.05, .rho_a = 0.1};
        built b = build_cable(6, all, 1);
        for (int i = 0; i < b.n_dof; ++i) {
            const double along = i < b.def.n_nodes ? b.x[i] - 0.5 : 1.0;
            b.v[b.stride + i] = 6.0 * along;
        }
        build_finish(&b);
        double P[3], H0[3], H[3], terms[2];
        own_momentum(P, H0, terms, &b);
        stepper run = start(&b, 0.9);
        for (int i = 0; i < 100; ++i) {
            steps(&run, &b, 1e-3 / (1 << k), 1 << k);
            own_momentum(P, H, terms, &b);
            error[k] = fmax(error[k], fabs(H[2] - H0[2]) / terms[1]);
        }
        stop(&run);
        build_free(&b);
    }
    assert_true(error[0] < 1e-3);
    for (int k = 0; k < 2; ++k) assert_true(log2(error[k] / error[k + 1]) > 1.8);
}

static double energy_of(const built* b) {
    ancf_energy e;
    ancf_energy_of(&e, b->m, 0, b->def.n_elements);
    double sum = e.kinetic + e.axial + e.bending + ancf_height(b->m);
    for (int i = 0; i < b->def.n_nodes; ++i)
        for (int c = 0; c < 3; ++c) sum += 0.5 * b->mass[i] * b->v[c * b->stride + i] * b->v[c * b->stride + i];
    return sum;
}

// What energies lose is what damping and the method are said to take, whatever the step; what the method takes vanishes
// with the square of the step and more, and is never negative where it is much.
static void energy_is_accounted_for(void** state) {
    (void)state;
    const int kinds[] = {0, ANCF_LUMPED, ANCF_CURVATURE_EXACT, ANCF_SPRING, ANCF_ENGINEERING};
    for (int k = 0; k < 10; ++k) {
        const double damping = k % 2 ? 2e-3 : 0.0;
        double lost[3];
        for (int i = 0; i < 3; ++i) {
            built b = swinging_cable(kinds[k / 2], damping);
            stepper run = start(&b, 0.6);
            b.m->track = true;
            const double whole = energy_of(&b), h = 4e-3 / (1 << i);
            steps(&run, &b, h, 50 << i);
            const double taken = b.m->damping_work + run.s->lost;
            assert_near(energy_of(&b) + taken, whole,
                        1e-6 * fabs(whole)); // what Newton leaves: 1e-8 of a length a step
            assert_true(damping == 0.0 ? b.m->damping_work == 0.0 : b.m->damping_work > 1e-4 * whole);
            lost[i] = run.s->lost;
            stop(&run);
            build_free(&b);
        }
        assert_true(fabs(lost[0]) > 1e-6);
        for (int i = 0; i < 2; ++i) { // it oscillates: nearer to 2 than to 1
            const double order = log2(fabs(lost[i] / lost[i + 1]));
            if (order < 1.5) fail_msg("case %d: order %.3f (%g %g %g)", k, order, lost[0], lost[1], lost[2]);
        }
    }
}

// A wave that a step cannot resolve loses its energy, and the account says so.
static void unresolved_waves_are_lost(void** state) {
    (void)state;
    const ancf_element all = {.length = 1.0, .ea = 1e6, .ei = 0.05, .rho_a = 0.1};
    built b = build_cable(8, all, 1);
    for (int i = 0; i < b.def.n_nodes; ++i) b.v[i] = i % 2 ? 1.0 : -1.0;
    build_finish(&b);
    b.m->track = true;
    stepper run = start(&b, 0.5);
    const double whole = energy_of(&b);
    steps(&run, &b, 1e-2, 20);
    assert_true(energy_of(&b) < 0.05 * whole);
    assert_near(energy_of(&b) + run.s->lost, whole, 1e-6 * whole);
    stop(&run);
    build_free(&b);
}

// The tip of the flexible pendulum at 1 s: .652800 .046069 .660242, from 64 elements undamped and an independent
// integration by DOP853; slopes turn with the cable.
static void flexible_pendulum(void** state) {
    (void)state;
    const double area = 25e-6, E = 1.6e6, rho = 320.0, tip[3] = {0.652800, 0.046069, 0.660242};
    const int n = 32;
    const ancf_element all = {.length = 1.0, .ea = E * area, .ei = E * area * area / (4.0 * pi), .rho_a = rho * area};
    built b = build_cable(n, all, 1);
    for (int i = 0; i < b.n_dof; ++i) b.v[2 * b.stride + i] = i <= n ? -4.0 * b.x[i] : -4.0;
    b.hold[0] = ANCF_HELD;
    build_finish(&b);
    b.m->gravity[1] = -9.8;
    stepper run = start(&b, 0.9);
    steps(&run, &b, 1.25e-4, 8000);
    for (int c = 0; c < 3; ++c) assert_near(b.x[c * b.stride + n], tip[c], 2e-5);
    stop(&run);
    build_free(&b);
}

// A slack cable pushed together, a crumpled net: negative strain makes the matrix indefinite.
static void compressed_elements(void** state) {
    (void)state;
    uint64_t seed = 92;
    for (int k = 0; k < 2; ++k) {
        const ancf_element all = {.length = 1.0, .ea = 1e5, .ei = 1e-3, .rho_a = 0.1, .damping = 1e-3};
        built b = k ? build_net(4, net_element(0, 1e-3)) : build_cable(10, all, 1);
        for (int i = 0; i < b.n_dof; ++i)
            for (int c = 0; c < 3; ++c) b.x[c * b.stride + i] *= 0.6;
        build_shake(&b, b.x, 0.05, &seed);
        b.hold[0] = ANCF_HELD;
        build_finish(&b);
        b.m->gravity[2] = -9.81;
        b.m->track = true;
        stepper run = start(&b, 0.5);
        const double whole = energy_of(&b);
        steps(&run, &b, 1e-3, 500);
        assert_near(energy_of(&b) + b.m->damping_work + run.s->lost, whole, 1e-5 * whole);
        stop(&run);
        build_free(&b);
    }
}

// A net shaken so that its cables turn by far more than a step can follow: it gains no energy.
static void violent_net(void** state) {
    (void)state;
    uint64_t seed = 93;
    built b = shaken_net(&seed);
    build_finish(&b);
    stepper run = start(&b, 0.9);
    const double whole = energy_of(&b);
    steps(&run, &b, 3e-4, 100);
    assert_true(energy_of(&b) < 1.02 * whole);
    assert_true(run.s->rejected > 100);
    stop(&run);
    build_free(&b);
}

// What is held goes where it is told, to the bit; what holds a hanging cable at rest carries its weight.
static void held_nodes(void** state) {
    (void)state;
    const ancf_element all = {.length = 0.5, .ea = 200.0, .ei = 1e-3, .rho_a = 0.1, .damping = 1e-2};
    built b = build_cable(4, all, 1);
    b.hold[0] = b.hold[5] = ANCF_HELD; // clamped
    b.mass[4] = 0.2;
    for (int i = 0; i < b.n_dof; ++i) {
        b.x[2 * b.stride + i] = -b.x[i];
        b.x[i] = 0.0;
    }
    build_finish(&b);
    b.m->gravity[2] = -9.81;
    stepper run = start(&b, 0.7);
    double where = 0.0;
    const int z = 2 * b.stride;
    for (int i = 0; i < 200; ++i) { // up and down, so that nothing swings
        b.m->held[z] = 0.2 * sin(0.1 * i);
        where += 2e-3 * b.m->held[z];
        steps(&run, &b, 2e-3, 1);
        assert_near(b.x[z], where, 1e-14);
        assert_true(b.x[0] == 0.0 && b.x[z + 5] == -1.0);
        if (i > 0) assert_near(b.v[z], 0.2 * sin(0.1 * (i + 0.5)), 1e-3); // at the end of the step
    }
    b.m->held[z] = 0.0;
    steps(&run, &b, 2e-2, 500);
    double force[3];
    ancf_reaction(force, b.m, 0);
    assert_close(force[2], 9.81 * (0.2 + 0.05), 1e-8);
    assert_near(force[0], 0.0, 1e-8);
    stop(&run);
    build_free(&b);
}

// All of it held: led along, and nothing to solve for.
static void nothing_is_free(void** state) {
    (void)state;
    built b = build_cable(2, (ancf_element) {.length = 1.0, .ea = 1e3, .ei = 0.1, .rho_a = 0.1}, 1);
    for (int i = 0; i < b.n_dof; ++i) b.hold[i] = ANCF_HELD;
    build_finish(&b);
    b.m->gravity[2] = -9.81;
    stepper run = start(&b, 0.9);
    for (int i = 0; i < b.def.n_nodes; ++i) b.m->held[i] = 0.5;
    steps(&run, &b, 1e-2, 10);
    for (int i = 0; i < b.def.n_nodes; ++i) assert_near(b.x[i], 0.5 * i + 0.05, 1e-14);
    stop(&run);
    build_free(&b);
}

// The same from a state that was put aside: nothing else is remembered.
static void resumes_to_the_bit(void** state) {
    (void)state;
    built b = swinging_cable(ANCF_CURVATURE_EXACT, 1e-3), c = swinging_cable(ANCF_CURVATURE_EXACT, 1e-3);
    stepper one = start(&b, 0.8), two = start(&c, 0.8);
    const size_t size = 3 * (size_t)b.stride * sizeof(double);
    steps(&one, &b, 3e-3, 20);
    memcpy(c.x, b.x, size);
    memcpy(c.v, b.v, size);
    memcpy(two.a, one.a, size);
    two.time = one.time;
    steps(&one, &b, 3e-3, 20);
    steps(&two, &c, 3e-3, 20);
    assert_memory_equal(c.x, b.x, size);
    assert_memory_equal(c.v, b.v, size);
    stop(&one);
    stop(&two);
    build_free(&b);
    build_free(&c);
}

static void a_step_that_fails(void** state) {
    (void)state;
    built b = swinging_cable(0, 0.0);
    const size_t size = 3 * (size_t)b.stride * sizeof(double);
    double* x = malloc(size);
    stepper run = start(&b, 0.8);
    steps(&run, &b, 1e-3, 3);
    memcpy(x, b.x, size);
    b.m->external[b.stride + 3] = 1e300;
    run.time.step = 1e-3;
    assert_int_equal(ancf_implicit_step(run.s, b.m, run.a, &run.time, 1), ANCF_E_STEP);
    assert_memory_equal(b.x, x, size);
    assert_int_equal(run.s->element, 2);
    assert_int_equal(run.s->rejected, 11);
    b.m->external[b.stride + 3] = 0.0;
    steps(&run, &b, 1e-3, 3);
    ancf_implicit* none;
    assert_int_equal(ancf_implicit_create(&none, b.m, 1.1), ANCF_E_RHO);
    assert_null(none);
    assert_int_equal(ancf_implicit_create(&none, b.m, NAN), ANCF_E_RHO);
    free(x);
    stop(&run);
    build_free(&b);
}

// The same with a held node at which no element ends, the last of all; and one that is led nowhere is no number.
static void a_node_without_elements(void** state) {
    (void)state;
    const ancf_element all = {.length = 1.0, .ea = 30.0, .ei = 0.02, .rho_a = 0.4};
    built b = build_start(4, 2, all);
    for (int i = 0; i < 3; ++i) b.x[i] = (double)i;
    for (int e = 0; e < 2; ++e)
        for (int k = 0; k < 2; ++k) b.ends[2 * e + k] = e + k;
    b.hold[0] = b.hold[3] = ANCF_HELD;
    build_slopes(&b);
    build_finish(&b);
    const size_t size = 3 * (size_t)b.stride * sizeof(double);
    double* x = malloc(size);
    stepper run = start(&b, 0.8);
    steps(&run, &b, 1e-3, 3);
    memcpy(x, b.x, size);
    const double wrong[3] = {NAN, INFINITY, 1e300};
    for (int k = 0; k < 3; ++k) {
        double* where = k < 2 ? &b.m->held[2 * b.stride + 3] : &b.m->external[b.stride + 2];
        *where = wrong[k];
        run.time.step = 1e-3;
        assert_int_equal(ancf_implicit_step(run.s, b.m, run.a, &run.time, 1), ANCF_E_STEP);
        assert_memory_equal(b.x, x, size);
        assert_in_range(run.s->element, 0, 1);
        *where = 0.0;
    }
    assert_int_equal(run.s->element, 1); // where the force was
    steps(&run, &b, 1e-3, 3);
    free(x);
    stop(&run);
    build_free(&b);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(recursion_of_an_oscillator),
        cmocka_unit_test(second_order),
        cmocka_unit_test(momentum),
        cmocka_unit_test(angular_momentum),
        cmocka_unit_test(energy_is_accounted_for),
        cmocka_unit_test(unresolved_waves_are_lost),
        cmocka_unit_test(flexible_pendulum),
        cmocka_unit_test(compressed_elements),
        cmocka_unit_test(violent_net),
        cmocka_unit_test(held_nodes),
        cmocka_unit_test(nothing_is_free),
        cmocka_unit_test(resumes_to_the_bit),
        cmocka_unit_test(a_step_that_fails),
        cmocka_unit_test(a_node_without_elements),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
