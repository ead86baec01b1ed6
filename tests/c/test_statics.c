// Static equilibrium against closed forms and published values.
#include "build.h"

#include "ancf/equilibrium.h"
#include "settle.h"

static const double pi = 3.14159265358979323846;

// Cantilever of REFERENCE, L = 2, square 0.1 x 0.1, dead tip load 3 EI/L^2: tip displacement with n elements.
static void cantilever(double tip[2], int n, int kind) {
    const double E = 2.07e11, side = 0.1, L = 2.0, ei = E * side * side * side * side / 12.0;
    const ancf_element all = {.kind = kind, .length = L, .ea = E * side * side, .ei = ei, .rho_a = 78.0};
    built b = build_cable(n, all, 1);
    b.hold[0] = b.hold[b.def.n_nodes] = ANCF_HELD;
    build_finish(&b);
    b.m->external[2 * b.stride + n] = -3.0 * ei / (L * L);
    const ancf_error error = ancf_equilibrium(b.m, 1e-9, 2000000, NULL);
    if (error) fail_msg("%d elements: %s", n, ancf_error_text(error));
    tip[0] = b.x[n] - L;
    tip[1] = b.x[2 * b.stride + n];
    build_free(&b);
}

static void cantilever_near_the_reference(void** state) {
    (void)state;
    const double good[5][2] = {
        {-0.362, -0.994}, {-0.489, -1.175}, {-0.5074, -1.2055}, {-0.50851, -1.20720}, {-0.508537, -1.207239}};
    const double exact[2] = {-0.508537304, -1.207239855};
    double before = INFINITY;
    for (int i = 0; i < 5; ++i) {
        double tip[2];
        cantilever(tip, 1 << i, ANCF_CURVATURE_EXACT | ANCF_AXIAL_REDUCED);
        const double error = hypot(tip[0] - exact[0], tip[1] - exact[1]);
        const double allowed = hypot(good[i][0] - exact[0], good[i][1] - exact[1]);
        assert_true(error < before);
        before = error;
        assert_true(error < 1.2 * allowed + 2e-6);
    }
}

// Elastic catenary between two points at one height: x(s) and z(s) from horizontal pull H, by Newton on the span.
static double catenary_pull(double span, double length, double weight, double ea) {
    double low = 1e-6 * weight, high = 1e6 * weight;
    for (int i = 0; i < 300; ++i) {
        const double H = sqrt(low * high), V = 0.5 * weight;
        const double x = H * length / ea + 2.0 * H * length / weight * asinh(V / H);
        if (x < span) low = H;
        else high = H;
    }
    return high;
}

static double catenary_sag(double H, double length, double weight, double ea) {
    const double V = 0.5 * weight;
    return weight * length / (8.0 * ea) + H * length / weight * (sqrt(1.0 + V * V / (H * H)) - 1.0);
}

static void hanging_cable(void** state) {
    (void)state;
    const double L = 1.2, span = 1.0, rho_a = 0.05, g = 9.81, ea = 5e3, weight = rho_a * L * g;
    const double H = catenary_pull(span, L, weight, ea), sag = catenary_sag(H, L, weight, ea);
    const int kinds[] = {0, ANCF_LUMPED, ANCF_CURVATURE_EXACT, ANCF_SPRING};
    for (int k = 0; k < 4; ++k) {
        const int n = 16;
        const ancf_element all = {
            .kind = kinds[k], .length = L, .ea = ea, .ei = k == 2 ? 1e-7 : 0.0, .rho_a = rho_a, .damping = 0.0};
        built b = build_cable(n, all, !(kinds[k] & ANCF_SPRING));
        for (int i = 0; i < b.n_dof; ++i) { // a V, slack
            const double s = i <= n ? (double)i / n : i <= 2 * n ? (i - n - 0.5) / n : (i - 2 * n - 0.5) / n;
            if (i <= n) {
                b.x[i] = span * s;
                b.x[2 * b.stride + i] = -0.3 * (1.0 - fabs(2.0 * s - 1.0));
            } else {
                b.x[2 * b.stride + i] = (s < 0.5 ? -1.0 : 1.0) * 0.5;
            }
        }
        build_share(&b, b.x);
        b.hold[0] = b.hold[n] = ANCF_HELD;
        build_finish(&b);
        b.m->gravity[2] = -g;
        const ancf_error error = ancf_equilibrium(b.m, 1e-8, 2000000, NULL);
        if (error) fail_msg("kind %d: %s", kinds[k], ancf_error_text(error));
        assert_near(b.x[2 * b.stride + n / 2], -sag, 1e-3 * sag * (k == 3 ? 3.0 : 1.0)); // a chain is a polygon
        double left[3], right[3];
        ancf_acceleration(b.m, b.x, b.v);
        memset(b.m->a, 0, 3 * (size_t)b.stride * sizeof *b.m->a);
        ancf_reaction(left, b.m, 0);
        ancf_reaction(right, b.m, n);
        assert_close(left[2] + right[2], weight, 1e-5);
        assert_near(left[0] + right[0], 0.0, 1e-5 * weight);
        assert_close(right[0], H, 5e-3);
        build_free(&b);
    }
}

// A weight on a cable: strain and tension in closed form; on springs too.
static void hanging_weight(void** state) {
    (void)state;
    for (int kind = 0; kind <= ANCF_SPRING; ++kind) {
        const ancf_element all = {.kind = kind, .length = 1.0, .ea = 100.0, .rho_a = 1e-9};
        built b = build_cable(3, all, 0);
        b.mass[3] = 0.8;
        b.hold[0] = ANCF_HELD;
        for (int i = 0; i < b.n_dof; ++i) b.v[i] = 1.0; // relaxation starts from rest, whatever was there
        build_finish(&b);
        b.m->gravity[0] = 10.0;
        assert_int_equal(ancf_equilibrium(b.m, 1e-10, 200000, NULL), ANCF_OK);
        double stretch = 1.08; // EA (l - 1) = 8 for springs; EA (l^2 - 1)/2 l = 8 for Green's strain
        for (int i = 0; i < 50 && kind != ANCF_SPRING; ++i)
            stretch -= (50.0 * (stretch * stretch - 1.0) * stretch - 8.0) / (50.0 * (3.0 * stretch * stretch - 1.0));
        assert_near(b.x[3], stretch, 1e-7);
        assert_near(ancf_tension(b.m, 1, 0.4), 8.0, 1e-5);
        for (int i = 0; i < 3 * b.stride; ++i) assert_true(b.v[i] == 0.0);
        build_free(&b);
    }
}

static void no_equilibrium_is_told(void** state) {
    (void)state;
    const ancf_element all = {.length = 1.0, .ea = 100.0, .rho_a = 0.1};
    built b = build_cable(3, all, 1); // nothing held, under gravity
    build_finish(&b);
    b.m->gravity[2] = -9.81;
    assert_int_equal(ancf_equilibrium(b.m, 1e-8, 2000, NULL), ANCF_E_EQUILIBRIUM);
    build_free(&b);
}

// A straight bar bent by a tip moment stays a circle: EI kappa = M. The moment acts on the end slope as a pair, so the
// load follows it: r' x F = M needs |r'| = 1, F across the slope.
static void tip_moment_makes_an_arc(void** state) {
    (void)state;
    const int n = 8;
    const double L = 1.0, ei = 2.0, angle = pi / 3.0, moment = ei * angle / L;
    const ancf_element all = {
        .kind = ANCF_CURVATURE_EXACT | ANCF_AXIAL_REDUCED, .length = L, .ea = 1e4, .ei = ei, .rho_a = 1.0};
    built b = build_cable(n, all, 1);
    b.hold[0] = b.hold[n + 1] = ANCF_HELD;
    build_finish(&b);
    const int slope = b.def.n_nodes + 2 * n - 1;
    for (int i = 0; i < 30; ++i) { // the dead load is turned until it lies across the slope
        const double gx = b.x[slope], gy = b.x[b.stride + slope], g2 = gx * gx + gy * gy;
        b.m->external[slope] = -moment * gy / g2;
        b.m->external[b.stride + slope] = moment * gx / g2;
        assert_int_equal(ancf_equilibrium(b.m, 1e-10, 2000000, NULL), ANCF_OK);
    }
    assert_near(b.x[n], L / angle * sin(angle), 2e-3);
    assert_near(b.x[b.stride + n], L / angle * (1.0 - cos(angle)), 2e-3);
    build_free(&b);
}

// Tip of an inextensible cantilever under a dead load across, EI theta'' = -P cos(theta), by shooting with RK4: (along,
// across) over its length for P L2/EI.
static void elastica(double tip[2], double load) {
    double low = 0.0, high = 10.0;
    for (int round = 0; round < 200; ++round) {
        const int n = 4000;
        const double root = 0.5 * (low + high), h = 1.0 / n; // curvature at the clamp; none at the tip
        double y[4] = {0.0, root, 0.0, 0.0};                 // angle, curvature, along, across
        for (int i = 0; i < n; ++i) {
            double sum[4] = {0.0}, rate[4] = {0.0};
            for (int k = 0; k < 4; ++k) {
                const double at = k == 0 ? 0.0 : k == 3 ? 1.0 : 0.5, weight = k % 3 ? 2.0 : 1.0;
                const double angle = y[0] + at * h * rate[0], bent = y[1] + at * h * rate[1];
                rate[0] = bent;
                rate[1] = -load * cos(angle);
                rate[2] = cos(angle);
                rate[3] = sin(angle);
                for (int j = 0; j < 4; ++j) sum[j] += weight * h / 6.0 * rate[j];
            }
            for (int j = 0; j < 4; ++j) y[j] += sum[j];
        }
        if (y[1] > 0.0) high = root;
        else low = root;
        tip[0] = y[2];
        tip[1] = y[3];
    }
}

// A steel strip that its tip load bends far, in 32 elements: by Newton's method, to 1e-9.
static void strip_of_many_elements(void** state) {
    (void)state;
    const int n = 32;
    const double L = 0.508, E = 7.17e10, height = 12.7e-3, thick = 3.19e-3, ei = E * height * pow(thick, 3.0) / 12.0;
    for (int k = 1; k <= 3; ++k) {
        const double load = 6.0 * k;
        const ancf_element all = {.kind = ANCF_CURVATURE_EXACT | ANCF_AXIAL_REDUCED,
                                  .length = L,
                                  .ea = E * height * thick,
                                  .ei = ei,
                                  .rho_a = 0.11};
        built b = build_cable(n, all, 1);
        b.hold[0] = b.hold[n + 1] = ANCF_HELD;
        build_finish(&b);
        b.m->external[2 * b.stride + n] = load;
        double tip[2];
        elastica(tip, load * L * L / ei);
        assert_true(ancf_settle(b.m, 1e-9, NULL));
        const double allowed = L * (load / all.ea + 1e-6); // the strip stretches, and has finite elements
        assert_near(b.x[n], L * tip[0], allowed);
        assert_near(b.x[2 * b.stride + n], L * tip[1], allowed);
        build_free(&b);
    }
}

// Lets a cable of n elements hang by its ends; what holds these.
static void hang(double first[3], double last[3], built* b, int n) {
    b->hold[0] = b->hold[n] = ANCF_HELD;
    build_finish(b);
    b->m->gravity[2] = -9.81;
    assert_true(ancf_settle(b->m, 1e-9, NULL));
    ancf_reaction(first, b->m, 0);
    ancf_reaction(last, b->m, n);
}

// 10 m of a cable that hardly stretches (EA = 2e7 N), hinged over 8 m: rounding of its positions alone makes forces of
// 1e-7 N. What holds it carries half its weight.
static void stiff_hanging_cable(void** state) {
    (void)state;
    const double L = 10.0, span = 8.0, weight = 1.2 * L * 9.81;
    for (int n = 16; n <= 64; n *= 2) {
        const ancf_element all = {.kind = ANCF_CURVATURE_EXACT, .length = L, .ea = 2e7, .ei = 20.0, .rho_a = 1.2};
        built b = build_cable(n, all, 1);
        for (int i = 0; i < b.n_dof; ++i) { // a parabola, half a metre too long
            const int node = i <= n ? i : i <= 2 * n ? i - n - 1 : i - 2 * n;
            const double s = (double)node / n, slope = -11.0 * (1.0 - 2.0 * s) / span, unit = sqrt(1.0 + slope * slope);
            b.x[i] = i <= n ? span * s : 1.0 / unit;
            b.x[2 * b.stride + i] = i <= n ? -11.0 * s * (1.0 - s) : slope / unit;
        }
        double first[3], last[3];
        hang(first, last, &b, n);
        assert_close(first[2], 0.5 * weight, 1e-7);
        assert_close(last[2], 0.5 * weight, 1e-7);
        assert_close(first[0], -last[0], 1e-7);
        const double H = catenary_pull(span, L, weight, 2e7), sag = catenary_sag(H, L, weight, 2e7);
        assert_close(-b.x[2 * b.stride + n / 2], sag, 0.02); // as far as bending lets it
        build_free(&b);
    }
}

// A column clamped at its foot under more than Euler's load, K(p)^2 EI/L^2, leans over by alpha at its top, p =
// sin(alpha/2): the top is 2 E/K - 1 up and 2 p/K aside (in its lengths; complete elliptic integrals). Straight up is
// an equilibrium as well, but no minimum of the energy.
static void buckled_column(void** state) {
    (void)state;
    const int n = 32;
    const double L = 1.0, ei = 1.0, p = sin(40.0 * pi / 180.0);
    double a = 1.0, b0 = sqrt(1.0 - p * p), c = p, power = 0.5, sum = 0.5 * p * p; // arithmetic-geometric mean
    while (c > 1e-16) {
        const double next = 0.5 * (a + b0);
        c = 0.5 * (a - b0);
        b0 = sqrt(a * b0);
        a = next;
        power *= 2.0;
        sum += power * c * c;
    }
    const double K = 0.5 * pi / a, E = K * (1.0 - sum);
    const ancf_element all = {
        .kind = ANCF_CURVATURE_EXACT | ANCF_AXIAL_REDUCED, .length = L, .ea = 1e6, .ei = ei, .rho_a = 1.0};
    built b = build_cable(n, all, 1);
    b.hold[0] = b.hold[n + 1] = ANCF_HELD;
    build_finish(&b);
    b.x[b.stride + n] += 1e-3; // a little aside
    b.m->external[n] = -K * K * ei / (L * L);
    assert_true(ancf_settle(b.m, 1e-9, NULL));
    assert_near(b.x[n], L * (2.0 * E / K - 1.0), 1e-4);
    assert_near(b.x[b.stride + n], L * 2.0 * p / K, 1e-4);
    build_free(&b);
}

// From a start that is crumpled at random, with elements pushed together, to a sagging cable that its ends carry.
static void crumpled_start(void** state) {
    (void)state;
    const int n = 32;
    for (int k = 0; k < 8; ++k) {
        uint64_t seed = 119 + (uint64_t)k;
        const ancf_element all = {.kind = k % 2 ? ANCF_CURVATURE_EXACT : ANCF_AXIAL_REDUCED,
                                  .length = 10.0,
                                  .ea = k < 4 ? 1e4 : 2e7,
                                  .ei = 20.0,
                                  .rho_a = 1.2};
        built b = build_cable(n, all, 1);
        for (int i = 0; i < b.n_dof; ++i) b.x[i] *= 0.8;
        build_shake(&b, b.x, 0.5, &seed);
        double first[3], last[3];
        hang(first, last, &b, n);
        assert_close(first[2] + last[2], 1.2 * 10.0 * 9.81, 1e-7);
        assert_true(b.x[2 * b.stride + n / 2] < -1.0);
        build_free(&b);
    }
}

// What is not held has no equilibrium, and stays as it was.
static void nothing_to_settle(void** state) {
    (void)state;
    const ancf_element all = {.length = 1.0, .ea = 1e4, .ei = 0.1, .rho_a = 0.1};
    built b = build_cable(4, all, 1);
    build_finish(&b);
    b.m->gravity[2] = -9.81;
    assert_false(ancf_settle(b.m, 1e-9, NULL));
    for (int i = 0; i < b.n_dof; ++i) assert_true(b.x[2 * b.stride + i] == 0.0);
    build_free(&b);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cantilever_near_the_reference),
        cmocka_unit_test(hanging_cable),
        cmocka_unit_test(hanging_weight),
        cmocka_unit_test(no_equilibrium_is_told),
        cmocka_unit_test(tip_moment_makes_an_arc),
        cmocka_unit_test(strip_of_many_elements),
        cmocka_unit_test(stiff_hanging_cable),
        cmocka_unit_test(buckled_column),
        cmocka_unit_test(crumpled_start),
        cmocka_unit_test(nothing_to_settle),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
