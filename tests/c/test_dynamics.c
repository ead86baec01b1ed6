// Motion against closed forms, conserved quantities and orders of convergence.
#include "build.h"

static const double pi = 3.14159265358979323846;

// The net with its bullets, thrown, turning, deformed: free flight.
static built flying_net(int kind, double damping, uint64_t* seed) {
    built b = build_net(6, net_element(kind, damping));
    const int corners[4] = {0, 6, 42, 48};
    for (int i = 0; i < 4; ++i) b.mass[corners[i]] = 0.05;
    build_shake(&b, b.x, 0.05, seed);
    build_shake(&b, b.v, 0.3, seed);
    for (int i = 0; i < b.n_dof; ++i) {
        const double u[3] = {b.x[i], b.x[b.stride + i], b.x[2 * b.stride + i]}, w[3] = {0.7, -0.4, 1.1};
        for (int c = 0; c < 3; ++c) {
            b.v[c * b.stride + i] += w[(c + 1) % 3] * u[(c + 2) % 3] - w[(c + 2) % 3] * u[(c + 1) % 3];
            if (i < b.def.n_nodes) b.v[c * b.stride + i] += 0.5 * c - 0.3;
        }
    }
    build_finish(&b);
    return b;
}

static void momentum_is_constant_in_free_flight(void** state) {
    (void)state;
    uint64_t seed = 41;
    for (int k = 0; k < 6; ++k) {
        const int kind = (k % 2 ? ANCF_LUMPED : 0) | (k >= 4 ? ANCF_CURVATURE_EXACT : 0);
        built b = flying_net(kind, k / 2 == 1 || k >= 4 ? 5e-5 : 0.0, &seed);
        double P0[3], H0[3], P[3], H[3], terms[2], P1[3], H1[3];
        ancf_time time = {0};
        own_momentum(P0, H0, terms, &b);
        for (int i = 0; i < 4; ++i) { // 1e5 steps, looked at four times
            run_leapfrog(b.m, k % 2 ? 2e-5 : 2e-6, 25000, &time);
            own_momentum(P, H, terms, &b);
            for (int c = 0; c < 3; ++c) {
                assert_near(P[c], P0[c], 1e-11 * terms[0]);
                assert_near(H[c], H0[c], 1e-11 * terms[1]);
            }
        }
        ancf_momentum(P1, H1, b.m);
        for (int c = 0; c < 3; ++c) {
            assert_near(P1[c], P[c], 1e-13 * terms[0]);
            assert_near(H1[c], H[c], 1e-13 * terms[1]);
        }
        build_free(&b);
    }
}

// Under mass-proportional damping alpha both momenta go down as exp(-alpha t), whatever else goes on inside.
static void momenta_decay_with_drag(void** state) {
    (void)state;
    uint64_t seed = 43;
    for (int k = 0; k < 4; ++k) {
        ancf_element all = {.kind = k % 2 ? ANCF_LUMPED : 0, .length = 1.0, .ea = 350.0, .ei = 2.2e-5, .rho_a = 1.1e-3};
        all.drag = 3.0;
        built b = build_cable(8, all, 1);
        build_shake(&b, b.x, 0.1, &seed);
        build_shake(&b, b.v, 2.0, &seed);
        for (int i = 0; i < b.n_dof; ++i) b.v[b.stride + i] += 3.0 * b.x[i];
        build_finish(&b);
        double P0[3], H0[3], P[3], H[3], terms[2];
        const double h = 1e-5, t = 0.2;
        ancf_time time = {0};
        own_momentum(P0, H0, terms, &b);
        if (k < 2) run_leapfrog(b.m, h, (int)(t / h + 0.5), &time);
        else
            for (int i = 0; i < (int)(t / h + 0.5); ++i) ancf_rk4(b.m, h);
        own_momentum(P, H, terms, &b);
        const double left = exp(-3.0 * (k < 2 ? t - 0.5 * h : t)); // leapfrog's velocities are half a step behind
        for (int c = 0; c < 3; ++c) {
            assert_near(P[c], left * P0[c], (k < 2 ? 3e-5 : 1e-9) * terms[0]);
            assert_near(H[c], left * H0[c], (k < 2 ? 3e-5 : 1e-6) * terms[1]); // RK4 damps waves, and turns
        }
        assert_true(fabs(P0[0]) + fabs(H0[2]) > 1e-2 * (terms[0] + terms[1]));
        build_free(&b);
    }
}

// Shared slopes and springs, too.
static void momentum_of_smooth_cables_and_springs(void** state) {
    (void)state;
    uint64_t seed = 42;
    for (int k = 0; k < 3; ++k) {
        const ancf_element all = {.kind = k == 2   ? ANCF_SPRING
                                          : k == 1 ? ANCF_LUMPED
                                                   : 0,
                                  .length = 1.0,
                                  .ea = 350.0,
                                  .ei = k == 2 ? 0.0 : 2.2e-5,
                                  .rho_a = 1.1e-3,
                                  .damping = 2e-5};
        built b = build_cable(8, all, k < 2);
        build_shake(&b, b.x, 0.1, &seed);
        build_shake(&b, b.v, 2.0, &seed);
        for (int i = 0; i < b.n_dof; ++i) b.v[b.stride + i] += 3.0 * b.x[i];
        b.mass[3] = 0.01;
        build_finish(&b);
        double P0[3], H0[3], P[3], H[3], terms[2];
        ancf_time time = {0};
        own_momentum(P0, H0, terms, &b);
        run_leapfrog(b.m, 5e-6, 100000, &time);
        own_momentum(P, H, terms, &b);
        for (int c = 0; c < 3; ++c) {
            assert_near(P[c], P0[c], 1e-11 * terms[0]);
            assert_near(H[c], H0[c], 1e-11 * terms[1]);
        }
        build_free(&b);
    }
}

// A smooth motion of a soft cable, for the orders.
static built swinging_cable(int kind) {
    const ancf_element all = {.kind = kind, .length = 1.0, .ea = 30.0, .ei = 0.02, .rho_a = 0.4};
    built b = build_cable(3, all, 1);
    for (int i = 0; i < b.def.n_nodes; ++i) {
        b.v[2 * b.stride + i] = -1.5 * b.x[i] * b.x[i];
        b.v[b.stride + i] = 0.7 * b.x[i];
    }
    for (int e = 0; e < 3; ++e) {
        b.v[2 * b.stride + 4 + e] = -3.0 * e / 3.0;
        b.v[2 * b.stride + 7 + e] = -3.0 * (e + 1) / 3.0;
        b.v[b.stride + 4 + e] = b.v[b.stride + 7 + e] = 0.7;
    }
    b.mass[3] = 0.1;
    b.hold[0] = ANCF_HELD;
    build_finish(&b);
    b.m->gravity[1] = -9.81;
    return b;
}

// Position of the free end at t = 0.3 with n steps.
static void end_after(double x[3], int kind, int n, int rk4) {
    built b = swinging_cable(kind);
    ancf_time time = {0};
    if (rk4)
        for (int i = 0; i < n; ++i) ancf_rk4(b.m, 0.3 / n);
    else run_leapfrog(b.m, 0.3 / n, n, &time);
    for (int c = 0; c < 3; ++c) x[c] = b.x[c * b.stride + 3];
    build_free(&b);
}

static double error_of(const double x[3], const double y[3]) {
    return sqrt((x[0] - y[0]) * (x[0] - y[0]) + (x[1] - y[1]) * (x[1] - y[1]) + (x[2] - y[2]) * (x[2] - y[2]));
}

static void orders_of_convergence(void** state) {
    (void)state;
    const int kinds[] = {0, ANCF_LUMPED, ANCF_CURVATURE_EXACT, ANCF_AXIAL_REDUCED};
    for (int k = 0; k < 4; ++k) {
        double fine[3], x[3], rk4[3], leapfrog[3];
        end_after(fine, kinds[k], 20000, 1);
        assert_true(fabs(fine[1]) > 0.05); // it does move
        for (int i = 0; i < 3; ++i) {
            end_after(x, kinds[k], 200 << i, 1);
            rk4[i] = error_of(x, fine);
            end_after(x, kinds[k], 1000 << i, 0);
            leapfrog[i] = error_of(x, fine);
        }
        for (int i = 0; i < 2; ++i) {
            const double p4 = log2(rk4[i] / rk4[i + 1]), p2 = log2(leapfrog[i] / leapfrog[i + 1]);
            if (fabs(p4 - 4.0) > 0.25 || fabs(p2 - 2.0) > 0.1)
                fail_msg("kind %d: orders %.3f of 4, %.3f of 2 (errors %g, %g)", kinds[k], p4, p2, rk4[i], leapfrog[i]);
        }
    }
}

// Leapfrog's energy, taken at the full step, stays near its start for long.
static void energy_is_bounded(void** state) {
    (void)state;
    uint64_t seed = 43;
    for (int k = 0; k < 2; ++k) {
        built b = flying_net(k ? ANCF_LUMPED : 0, 0.0, &seed);
        const int n = 3 * b.stride;
        double *half = malloc((size_t)n * sizeof *half), first = 0.0, worst = 0.0;
        ancf_time time = {0};
        const double h = k ? 1e-5 : 4e-6;
        run_leapfrog(b.m, h, 1, &time);
        for (int i = 0; i < 20000; ++i) {
            ancf_energy energy;
            memcpy(half, b.v, (size_t)n * sizeof *half);
            double *x = malloc((size_t)n * sizeof *x), *v = malloc((size_t)n * sizeof *v);
            if (i % 500 == 0) { // mean of the two half steps' velocities belongs to this step's position
                memcpy(x, b.x, (size_t)n * sizeof *x);
                ancf_predict(b.m, &time);
                memcpy(v, b.v, (size_t)n * sizeof *v);
                for (int j = 0; j < n; ++j) b.v[j] = 0.5 * (half[j] + b.m->free[j]);
                ancf_energy_of(&energy, b.m, 0, b.def.n_elements);
                double total = energy.kinetic + energy.axial + energy.bending;
                for (int j = 0; j < b.def.n_nodes; ++j)
                    for (int c = 0; c < 3; ++c)
                        total += 0.5 * b.mass[j] * b.v[c * b.stride + j] * b.v[c * b.stride + j];
                if (i == 0) first = total;
                worst = fmax(worst, fabs(total - first) / first);
                memcpy(b.v, v, (size_t)n * sizeof *v);
            }
            free(x);
            free(v);
            run_leapfrog(b.m, h, 1, &time);
        }
        assert_true(worst < 2e-2);
        assert_true(worst > 1e-9); // leapfrog is not exact
        free(half);
        build_free(&b);
    }
}

// A rod swings about its end with T = 2 pi sqrt(2 L/(3 g)), for small angles.
static void compound_pendulum_of_one_element(void** state) {
    (void)state;
    const double L = 1.0, g = 9.81, period = 2.0 * pi * sqrt(2.0 * L / (3.0 * g)), h = 2e-5;
    const ancf_element all = {.length = L, .ea = 5e4, .ei = 200.0, .rho_a = 0.5};
    built b = build_cable(1, all, 0);
    const double angle = 0.02; // from straight down
    b.x[1] = b.x[2] = b.x[3] = sin(angle);
    b.x[b.stride + 1] = b.x[b.stride + 2] = b.x[b.stride + 3] = -cos(angle);
    b.hold[0] = ANCF_HELD;
    build_finish(&b);
    b.m->gravity[1] = -g;
    ancf_time time = {0};
    int crossings = 0;
    double first = 0.0, last = 0.0, before = b.x[1];
    for (int i = 1; crossings < 9; ++i) {
        run_leapfrog(b.m, h, 1, &time);
        if (before * b.x[1] < 0.0) {
            last = h * (i - b.x[1] / (b.x[1] - before));
            if (crossings++ == 0) first = last;
        }
        before = b.x[1];
        assert_true(i < 1000000);
    }
    const double amplitude = 1.0 + angle * angle / 16.0;
    assert_close((last - first) / 4.0, period * amplitude, 1e-3);
    build_free(&b);
}

// Phase by which a mode is late after whole periods at the expected frequency, as a part of the way; q and dq are its
// amplitude and rate. 0: exactly that frequency.
static double frequency_error(double q, double dq, double w, int periods) {
    return atan2(-dq / w, q) / (2.0 * pi * periods);
}

static double project(const built* b, const double* field, const double* shape, int block) {
    double sum = 0.0, norm = 0.0;
    for (int i = 0; i < b->def.n_nodes; ++i) {
        sum += field[block * b->stride + i] * shape[i];
        norm += shape[i] * shape[i];
    }
    return sum / norm;
}

// Transverse waves of a string under T0: f_n = n/(2 l) sqrt(T0/mu), l and mu as stretched.
static void taut_string(void** state) {
    (void)state;
    for (int mode = 1; mode <= 3; ++mode)
        for (int kind = 0; kind <= ANCF_AXIAL_REDUCED; kind += ANCF_AXIAL_REDUCED) {
            const int n = 16;
            const double stretch = 1.05, L = 2.0, ea = 400.0, rho_a = 0.01;
            const ancf_element all = {.kind = kind, .length = L, .ea = ea, .rho_a = rho_a};
            built b = build_cable(n, all, 1);
            double shape[17];
            for (int i = 0; i < b.n_dof; ++i) b.x[i] *= stretch;
            for (int i = 0; i <= n; ++i) {
                shape[i] = sin(mode * pi * i / n);
                b.x[b.stride + i] = 1e-5 * shape[i];
                const double slope = 1e-5 * mode * pi / L * cos(mode * pi * i / n);
                if (i < n) b.x[b.stride + n + 1 + i] = slope;
                if (i > 0) b.x[b.stride + 2 * n + i] = slope;
            }
            b.hold[0] = b.hold[n] = ANCF_HELD;
            build_finish(&b);
            const double tension = ea * 0.5 * (stretch * stretch - 1.0) * stretch;
            const double w = mode * pi / (L * stretch) * sqrt(tension / (rho_a / stretch));
            const int periods = 3, steps = 6000;
            for (int i = 0; i < steps; ++i) ancf_rk4(b.m, periods * 2.0 * pi / w / steps);
            const double q = project(&b, b.x, shape, 1), dq = project(&b, b.v, shape, 1);
            assert_close(hypot(q, dq / w), 1e-5, 1e-3);
            assert_near(frequency_error(q, dq, w, periods), 0.0, 1e-4);
            build_free(&b);
        }
}

// Pinned beam: w_n = (n pi/L)^2 sqrt(EI/rhoA).
static void pinned_beam(void** state) {
    (void)state;
    for (int mode = 1; mode <= 2; ++mode)
        for (int kind = 0; kind <= ANCF_CURVATURE_EXACT; kind += ANCF_CURVATURE_EXACT) {
            const int n = 8;
            const double L = 1.5, ei = 0.5, rho_a = 0.3;
            const ancf_element all = {.kind = kind, .length = L, .ea = 2e3, .ei = ei, .rho_a = rho_a};
            built b = build_cable(n, all, 1);
            double shape[9];
            for (int i = 0; i <= n; ++i) {
                shape[i] = sin(mode * pi * i / n);
                b.x[b.stride + i] = 1e-6 * shape[i];
                const double slope = 1e-6 * mode * pi / L * cos(mode * pi * i / n);
                if (i < n) b.x[b.stride + n + 1 + i] = slope;
                if (i > 0) b.x[b.stride + 2 * n + i] = slope;
            }
            b.hold[0] = b.hold[n] = ANCF_HELD;
            build_finish(&b);
            const double w = mode * mode * pi * pi / (L * L) * sqrt(ei / rho_a);
            const int periods = 3, steps = 20000;
            for (int i = 0; i < steps; ++i) ancf_rk4(b.m, periods * 2.0 * pi / w / steps);
            const double q = project(&b, b.x, shape, 1), dq = project(&b, b.v, shape, 1);
            assert_close(hypot(q, dq / w), 1e-6, 1e-2);
            assert_near(frequency_error(q, dq, w, periods), 0.0, 3e-4);
            build_free(&b);
        }
}

// Free beam: beta L = 4.730040745, w = beta^2 sqrt(EI/rhoA), with its own mode as the start.
static void free_beam(void** state) {
    (void)state;
    const int n = 8;
    const double L = 1.5, ei = 0.5, rho_a = 0.3, bl = 4.730040744862704, beta = bl / L;
    const double sigma = (cosh(bl) - cos(bl)) / (sinh(bl) - sin(bl));
    const ancf_element all = {.length = L, .ea = 2e3, .ei = ei, .rho_a = rho_a};
    built b = build_cable(n, all, 1);
    double shape[9];
    for (int i = 0; i <= n; ++i) {
        const double z = bl * i / n;
        shape[i] = cosh(z) + cos(z) - sigma * (sinh(z) + sin(z));
        const double slope = 1e-6 * beta * (sinh(z) - sin(z) - sigma * (cosh(z) + cos(z)));
        b.x[b.stride + i] = 1e-6 * shape[i];
        if (i < n) b.x[b.stride + n + 1 + i] = slope;
        if (i > 0) b.x[b.stride + 2 * n + i] = slope;
    }
    build_finish(&b);
    const double w = beta * beta * sqrt(ei / rho_a);
    const int periods = 3, steps = 20000;
    for (int i = 0; i < steps; ++i) ancf_rk4(b.m, periods * 2.0 * pi / w / steps);
    const double q = project(&b, b.x, shape, 1), dq = project(&b, b.v, shape, 1);
    assert_close(hypot(q, dq / w), 1e-6, 1e-2);
    assert_near(frequency_error(q, dq, w, periods), 0.0, 3e-4);
    build_free(&b);
}

// N springs under T0: w_j = 2 sqrt(k/m) sin(j pi/(2 N)), k = T0/l across and EA/L along, m between two springs.
static void chain_of_springs(void** state) {
    (void)state;
    const int n = 12;
    for (int mode = 1; mode <= 5; mode += 2)
        for (int along = 0; along < 2; ++along) {
            const double stretch = 1.02, L = 3.0, ea = 400.0, rho_a = 0.01, l0 = L / n;
            const ancf_element all = {.kind = ANCF_SPRING, .length = L, .ea = ea, .rho_a = rho_a};
            built b = build_cable(n, all, 0);
            double shape[13];
            for (int i = 0; i < b.n_dof; ++i) b.x[i] *= stretch;
            double rest[13];
            for (int i = 0; i <= n; ++i) {
                shape[i] = sin(mode * pi * i / n);
                rest[i] = b.x[i];
                b.x[(along ? 0 : b.stride) + i] += 1e-7 * shape[i];
            }
            b.hold[0] = b.hold[n] = ANCF_HELD;
            build_finish(&b);
            const double tension = ea * (stretch - 1.0), mass = rho_a * l0;
            const double k = along ? ea / l0 : tension / (l0 * stretch);
            const double w = 2.0 * sqrt(k / mass) * sin(0.5 * mode * pi / n);
            const int periods = 20, steps = 40000;
            for (int i = 0; i < steps; ++i) ancf_rk4(b.m, periods * 2.0 * pi / w / steps);
            for (int i = 0; i <= n && along; ++i) b.x[i] -= rest[i];
            const double q = project(&b, b.x, shape, along ? 0 : 1), dq = project(&b, b.v, shape, along ? 0 : 1);
            assert_close(hypot(q, dq / w), 1e-7, 1e-3);
            assert_near(frequency_error(q, dq, w, periods), 0.0, 1e-6);
            build_free(&b);
        }
}

// Four equal elements, hinged at x = 0, thrown across: values of REFERENCE at t = 0.02, from another program. Its start
// gives speeds to the nodes alone, none to the slopes (a rigid turn would end at z = -0.07994), and its steps are
// Euler's at 1e-4 s, which is 1e-5 m of fall: a whole kick at the start makes leapfrog the same.
static void flexible_pendulum(void** state) {
    (void)state;
    const double area = 25e-6, E = 1.6e6, rho = 320.0;
    for (int kind = 0; kind <= ANCF_CURVATURE_EXACT; kind += ANCF_CURVATURE_EXACT) {
        const ancf_element all = {
            .kind = kind, .length = 1.0, .ea = E * area, .ei = E * area * area / (4.0 * pi), .rho_a = rho * area};
        built b = build_cable(4, all, 1);
        for (int i = 0; i < b.def.n_nodes; ++i) b.v[2 * b.stride + i] = -4.0 * b.x[i];
        b.hold[0] = ANCF_HELD;
        build_finish(&b);
        b.m->gravity[1] = -9.8;
        ancf_time time = {.last = 1e-4};
        run_leapfrog(b.m, 1e-4, 200, &time);
        assert_near(b.x[b.stride + 2], -0.0019524, 1e-5);
        assert_near(b.x[2 * b.stride + 4], -0.0816723, 1e-5);
        build_free(&b);
    }
}

// A node that is led moves as it is told, whatever pulls on it; what leads it feels the cable's weight at rest.
static void held_node_follows(void** state) {
    (void)state;
    for (int kind = 0; kind <= ANCF_LUMPED; kind += ANCF_LUMPED) {
        const ancf_element all = {.kind = kind, .length = 0.5, .ea = 200.0, .ei = 1e-3, .rho_a = 0.1, .damping = 1e-3};
        built b = build_cable(4, all, 1);
        b.hold[0] = ANCF_HELD;
        b.mass[4] = 0.2;
        for (int i = 0; i < b.n_dof; ++i) { // hangs down
            b.x[2 * b.stride + i] = -b.x[i];
            b.x[i] = 0.0;
        }
        build_finish(&b);
        b.m->gravity[2] = -9.81;
        ancf_time time = {0};
        const double h = 5e-5;
        for (int i = 0; i < 2000; ++i) {
            b.m->held[0] = sin(0.01 * i);
            run_leapfrog(b.m, h, 1, &time);
            assert_true(b.v[0] == b.m->held[0]);
            assert_true(b.v[2 * b.stride] == 0.0 && b.x[2 * b.stride] == 0.0);
        }
        b.m->held[0] = 0.0;
        double force[3], mean = 0.0;
        const double friction = 0.999; // quick way to rest
        for (int i = 0; i < 60000; ++i) {
            run_leapfrog(b.m, h, 1, &time);
            for (int j = 0; j < 3 * b.stride; ++j) b.v[j] *= friction;
        }
        for (int i = 0; i < 1000; ++i) {
            run_leapfrog(b.m, h, 1, &time);
            ancf_reaction(force, b.m, 0);
            mean += force[2] / 1000.0;
        }
        assert_close(mean, 9.81 * (0.2 + 0.05), 1e-6);
        build_free(&b);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(momentum_is_constant_in_free_flight),
        cmocka_unit_test(momentum_of_smooth_cables_and_springs),
        cmocka_unit_test(momenta_decay_with_drag),
        cmocka_unit_test(orders_of_convergence),
        cmocka_unit_test(energy_is_bounded),
        cmocka_unit_test(compound_pendulum_of_one_element),
        cmocka_unit_test(taut_string),
        cmocka_unit_test(pinned_beam),
        cmocka_unit_test(free_beam),
        cmocka_unit_test(chain_of_springs),
        cmocka_unit_test(flexible_pendulum),
        cmocka_unit_test(held_node_follows),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
