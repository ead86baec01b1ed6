// Contact and friction laws against closed forms (Shan, Guo, Gill 2019, Table 1, Eq. 8-11).
#include "check.h"

#include "ancf/law.h"
#include <float.h>
#include <stdbool.h>

static const double pi = 3.14159265358979323846;

static void errors_have_texts(void** state) {
    (void)state;
    assert_string_equal(ancf_error_text(ANCF_OK), "no error");
    for (int code = ANCF_OK; code <= ANCF_E_EQUILIBRIUM; code++) {
        assert_non_null(ancf_error_text((ancf_error)code));
        assert_true(ancf_error_text((ancf_error)code)[0] != '\0');
    }
    assert_non_null(ancf_error_text((ancf_error)9999));
    assert_string_not_equal(ancf_error_text((ancf_error)9999), ancf_error_text(ANCF_OK));
}

static void hertz_stiffness_by_hand(void** state) {
    (void)state;
    // h1 = h2 = 1/pi^2 gives k = 4 pi/6.
    assert_close(ancf_hertz_stiffness(1.0, pi, 0.0, pi, 0.0), 4.0 * pi / 6.0, 1e-15);
    assert_close(ancf_hertz_stiffness(4.0, pi, 0.0, pi, 0.0), 8.0 * pi / 6.0, 1e-15);
    // Johnson's form: k = 4/3 sqrt(r) E*, 1/E* = 0.91/4.456e8 + 0.8911/70e9 = 2.0549204e-9.
    const double modulus = 1.0 / (0.91 / 4.456e8 + 0.8911 / 70e9);
    assert_close(ancf_hertz_stiffness(0.01, 4.456e8, 0.3, 70e9, 0.33), 4.0 / 3.0 * 0.1 * modulus, 1e-14);
    assert_close(ancf_hertz_stiffness(0.01, 4.456e8, 0.3, 70e9, 0.33), 6.4884917e7, 1e-7);
    // A rigid partner, and the order of the two bodies.
    assert_close(ancf_hertz_stiffness(0.01, 1e9, 0.5, 1e300, 0.0), 4.0 / 3.0 * 0.1 * 1e9 / 0.75, 1e-14);
    assert_close(ancf_hertz_stiffness(0.02, 1e9, 0.1, 3e7, 0.4), ancf_hertz_stiffness(0.02, 3e7, 0.4, 1e9, 0.1), 1e-15);
}

static void normal_force_by_hand(void** state) {
    (void)state;
    const ancf_normal dashpot = {ANCF_NORMAL_LINEAR, 2000.0, 1.5, 30.0};
    assert_close(ancf_normal_force(&dashpot, 0.01, 0.2), 20.0 + 6.0, 1e-15);
    assert_close(ancf_normal_force(&dashpot, 0.01, -0.2), 20.0 - 6.0, 1e-15);
    const ancf_normal hertz = {ANCF_NORMAL_HERTZ, 1e6, 1.5, 0.5};
    assert_close(ancf_normal_force(&hertz, 0.01, 0.2), 1000.0, 1e-14);
    assert_close(ancf_normal_force(&hertz, 0.01, -7.0), 1000.0, 1e-14);
    const ancf_normal square = {ANCF_NORMAL_HERTZ, 1e6, 2.0, 0.5};
    assert_close(ancf_normal_force(&square, 0.01, 0.2), 100.0, 1e-13);
    const ancf_normal nonlinear = {ANCF_NORMAL_NONLINEAR, 1e6, 1.5, 0.2};
    assert_close(ancf_normal_force(&nonlinear, 0.01, 0.5), 1000.0 * (1.0 + 0.3 * 0.5), 1e-14);
    // The square root path is the limit of the general one.
    ancf_normal near = nonlinear;
    near.exponent = 1.5 * (1.0 + 1e-14);
    assert_close(ancf_normal_force(&nonlinear, 0.003, 0.1), ancf_normal_force(&near, 0.003, 0.1), 1e-12);
}

static void normal_force_never_attracts(void** state) {
    (void)state;
    const ancf_normal_kind kinds[] = {ANCF_NORMAL_LINEAR, ANCF_NORMAL_HERTZ, ANCF_NORMAL_NONLINEAR};
    uint64_t seed = 1;
    for (int i = 0; i < 30000; i++) {
        const ancf_normal law = {kinds[i % 3], random_magnitude(&seed, 1e2, 1e9), random_between(&seed, 1.0, 2.5),
                                 random_magnitude(&seed, 1e-3, 1e3)};
        const double depth = random_between(&seed, -1e-2, 1e-2), rate = random_between(&seed, -50.0, 50.0);
        const double force = ancf_normal_force(&law, depth, rate);
        assert_true(force >= 0.0 && isfinite(force));
        if (depth <= 0.0) assert_true(force == 0.0);
    }
    const ancf_normal strong = {ANCF_NORMAL_LINEAR, 1e3, 1.0, 1e3};
    assert_true(ancf_normal_force(&strong, 1e-3, -1.0) == 0.0);
    assert_true(ancf_normal_force(&strong, 0.0, 1.0) == 0.0);
}

static const ancf_normal elastic[] = {
    {ANCF_NORMAL_LINEAR, 3e4, 1.5, 0.0},    {ANCF_NORMAL_HERTZ, 3e6, 1.5, 0.0}, {ANCF_NORMAL_NONLINEAR, 3e6, 1.5, 0.0},
    {ANCF_NORMAL_NONLINEAR, 2e5, 1.2, 0.0}, {ANCF_NORMAL_HERTZ, 2e7, 2.0, 0.0},
};

// Work on the loading path by Simpson's rule over depth = top z^4, which is smooth at 0.
static double loading_work(const ancf_normal* law, double top) {
    const int n = 2000;
    double sum = 0.0;
    for (int i = 0; i <= n; i++) {
        const double z = (double)i / n, weight = i == 0 || i == n ? 1.0 : i % 2 ? 4.0 : 2.0;
        sum += weight * ancf_normal_force(law, top * z * z * z * z, 0.0) * 4.0 * top * z * z * z;
    }
    return sum / (3.0 * n);
}

static void normal_energy_is_work_of_loading(void** state) {
    (void)state;
    for (size_t i = 0; i < sizeof elastic / sizeof *elastic; i++) {
        assert_close(ancf_normal_energy(&elastic[i], 2e-3), loading_work(&elastic[i], 2e-3), 1e-10);
        assert_true(ancf_normal_energy(&elastic[i], -1e-3) == 0.0);
    }
}

static void normal_tangent_is_slope(void** state) {
    (void)state;
    const double depth = 2e-3, h = 1e-7;
    for (size_t i = 0; i < sizeof elastic / sizeof *elastic; i++) {
        const double up = ancf_normal_force(&elastic[i], depth + h, 0.0);
        const double down = ancf_normal_force(&elastic[i], depth - h, 0.0);
        assert_close(ancf_normal_tangent(&elastic[i], depth), (up - down) / (2.0 * h), 1e-7);
        assert_true(ancf_normal_tangent(&elastic[i], -1e-3) == 0.0);
    }
}

// Speed after a mass has hit the plane at `speed` and left it: RK4, short steps.
static double rebound(const ancf_normal* law, double mass, double speed) {
    const double duration = pow(mass / (law->stiffness * pow(speed, law->exponent - 1.0)), 1.0 / (law->exponent + 1.0));
    const double h = 2e-4 * duration;
    double d = 0.0, u = speed;
    for (int i = 0; i < 1000000; i++) {
        const double a1 = -ancf_normal_force(law, d, u) / mass;
        const double u2 = u + 0.5 * h * a1, a2 = -ancf_normal_force(law, d + 0.5 * h * u, u2) / mass;
        const double u3 = u + 0.5 * h * a2, a3 = -ancf_normal_force(law, d + 0.5 * h * u2, u3) / mass;
        const double u4 = u + h * a3, a4 = -ancf_normal_force(law, d + h * u3, u4) / mass;
        d += h / 6.0 * (u + 2.0 * u2 + 2.0 * u3 + u4);
        u += h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
        if (d < 0.0) return -u;
    }
    return NAN;
}

static void hunt_crossley_restitution(void** state) {
    (void)state;
    const double alpha[] = {0.08, 0.2, 0.32}, e[] = {0.892734, 0.768000, 0.672262}; // closed form, whatever k, n, m
    struct body {
        double k, n, m;
    };
    const struct body body[] = {{1e6, 1.5, 0.05}, {3e8, 1.5, 2.0}, {1e4, 1.1, 0.01}, {1e7, 2.0, 0.3}};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++) {
            const ancf_normal law = {ANCF_NORMAL_NONLINEAR, body[j].k, body[j].n, alpha[i]};
            assert_near(rebound(&law, body[j].m, 1.5) / 1.5, e[i], 1e-4);
        }
    // e solves g(v) = g(-e v), g(u) = a u - ln(1 + a u), a = 1.5 alpha, at another speed too.
    const ancf_normal law = {ANCF_NORMAL_NONLINEAR, 1e6, 1.5, 0.2};
    const double out = rebound(&law, 0.05, 3.0), a = 0.3;
    assert_near(a * 3.0 - log(1.0 + a * 3.0), -a * out - log(1.0 - a * out), 2e-5);
}

static void hertz_rebound_loses_nothing(void** state) {
    (void)state;
    const ancf_normal law = {ANCF_NORMAL_HERTZ, 1e6, 1.5, 0.2};
    assert_close(rebound(&law, 0.05, 1.5), 1.5, 1e-6);
}

// Damped oscillator: half a period, until the force or the depth is zero (here the force cut comes first).
static void dashpot_restitution(void** state) {
    (void)state;
    const double k = 1e4, m = 0.1, c = 10.0, zeta = c / (2.0 * sqrt(k * m)), root = sqrt(1.0 - zeta * zeta);
    const ancf_normal law = {ANCF_NORMAL_LINEAR, k, 1.0, c};
    // x = exp(-zeta w t) sin(root w t)/..: the force k x + c x' vanishes at the phase below (Schwager, Poeschel 2007).
    const double end = atan2(2.0 * zeta * root, 2.0 * zeta * zeta - 1.0); // phase of zero force
    const double expected = exp(-zeta / root * end);
    assert_near(rebound(&law, m, 1.0), expected, 1e-4);
}

// Hollars' formula, Eq. 11, as it stands in the paper.
static double hollars(double mu_s, double mu_k, double v0, double v) {
    const double s = v / v0;
    return fmin(s, 1.0) * (mu_k + 2.0 * (mu_s - mu_k) / (1.0 + s * s));
}

static void hollars_points(void** state) {
    (void)state;
    const double v0 = 1e-3;
    const ancf_friction law = {ANCF_FRICTION_HOLLARS, 0.3, 0.2, v0};
    assert_close(ancf_friction_coefficient(&law, v0), 0.3, 1e-15);
    for (int i = 1; i < 5000; i++) { // the peak is nowhere else
        assert_true(ancf_friction_coefficient(&law, v0 * i * 1e-3) <= 0.3 * (1.0 + 1e-15));
        if (i != 1000) assert_true(ancf_friction_coefficient(&law, v0 * i * 1e-3) < 0.3);
    }
    assert_true(ancf_friction_coefficient(&law, 0.0) == 0.0);
    assert_close(ancf_friction_slope(&law), (2.0 * 0.3 - 0.2) / v0, 1e-15);
    assert_close(ancf_friction_coefficient(&law, 1e-9 * v0) / (1e-9 * v0), 0.4 / v0, 1e-12);
    assert_near(ancf_friction_coefficient(&law, 1e3), 0.2, 1e-12);
    assert_close(ancf_friction_coefficient(&law, 3.0 * v0), 0.2 + 0.2 / 10.0, 1e-15); // by hand
    assert_close(ancf_friction_coefficient(&law, 0.5 * v0), 0.5 * (0.2 + 0.2 / 1.25), 1e-15);
    for (int i = 0; i < 400; i++)
        assert_near(ancf_friction_coefficient(&law, 1e-2 * i * v0), hollars(0.3, 0.2, v0, 1e-2 * i * v0), 1e-16);
}

static void coulomb_points(void** state) {
    (void)state;
    const ancf_friction law = {ANCF_FRICTION_COULOMB, 0.9, 0.2, 1e-3}; // mu_s plays no part
    assert_close(ancf_friction_coefficient(&law, 0.5e-3), 0.1, 1e-15);
    assert_close(ancf_friction_coefficient(&law, 1e-3), 0.2, 1e-15);
    assert_close(ancf_friction_coefficient(&law, 5.0), 0.2, 1e-15);
    assert_close(ancf_friction_slope(&law), 200.0, 1e-15);
    const ancf_friction none = {ANCF_FRICTION_NONE, 0.9, 0.2, 1e-3};
    assert_true(ancf_friction_coefficient(&none, 1.0) == 0.0 && ancf_friction_slope(&none) == 0.0);
    assert_true(ancf_friction_solve(&none, 1.25, 100.0, 0.0) == 1.25);
}

static void friction_never_drives(void** state) {
    (void)state;
    const ancf_friction law = {ANCF_FRICTION_HOLLARS, 0.05, 0.3, 1e-3}; // the formula would push below 1.3 v0
    for (int i = 0; i < 4000; i++) assert_true(ancf_friction_coefficient(&law, 1e-6 * i) >= 0.0);
    assert_true(ancf_friction_slope(&law) >= 0.0);
}

typedef struct {
    double mu_s, mu_k, v0;
    bool ramp_only; // Coulomb
} curve;

static long double mu_of(const curve* c, long double u) {
    const long double s = u / c->v0, q = c->ramp_only ? 0.0L : 2.0L * ((long double)c->mu_s - c->mu_k) / (1.0L + s * s);
    const long double mu = c->mu_k + q;
    return (s < 1.0L ? s : 1.0L) * (mu > 0.0L ? mu : 0.0L);
}

// Smallest root of u + beta mu(u) = speed: the first change of sign on a fine grid, then bisection.
static long double smallest_root(const curve* c, long double speed, long double beta) {
    long double low = 0.0L, high = speed;
    for (int i = 1; i <= 6000; i++) {
        long double u =
            i <= 4000 ? c->v0 * i / 2000.0L : 2.0L * c->v0 * powl(speed / (2.0L * c->v0), (i - 4000) / 2000.0L);
        if (u > speed) u = speed;
        if (u + beta * mu_of(c, u) >= speed) {
            high = u;
            break;
        }
        low = u;
    }
    for (int i = 0; i < 200; i++) {
        const long double u = 0.5L * (low + high);
        if (u + beta * mu_of(c, u) >= speed) high = u;
        else low = u;
    }
    return high;
}

// The residual can be no better than rounding of its terms; the root then is off by that over the slope.
static void check_root(const ancf_friction* law, const curve* c, double speed, double beta) {
    const double u = ancf_friction_solve(law, speed, beta, 0.0);
    const long double root = smallest_root(c, speed, beta), h = 1e-6L * root;
    const long double slope = 1.0L + beta * (mu_of(c, root) - mu_of(c, root - h)) / h;
    const long double rounding = 4.0L * DBL_EPSILON * speed;
    assert_true(u >= 0.0 && u <= speed);
    // Near a double root the slope says little: then the bend limits the error.
    const long double allowed = 1e-14L * root + 4.0L * rounding / fmaxl(fabsl(slope), 1e-3L);
    const bool near_double = fabsl(slope) < 1e-3L;
    if (!near_double) assert_near(u, (double)root, (double)allowed);
    assert_near((double)(u + beta * mu_of(c, u)), speed, 8.0 * DBL_EPSILON * (speed + fabs((double)(root * slope))));
    for (int k = 1; k < 8; ++k) { // wherever it is sought first
        const double again = ancf_friction_solve(law, speed, beta, speed * k * k / 40.0);
        if (!near_double) assert_near(again, (double)root, (double)allowed);
    }
}

// As long as it rises with the speed it is the law; its slope is that of its values.
static void rising_friction_is_the_law(void** state) {
    (void)state;
    uint64_t seed = 10;
    int kept = 0;
    for (int i = 0; i < 6000; i++) {
        const double v0 = random_magnitude(&seed, 1e-6, 1.0), mu_k = random_between(&seed, 0.0, 1.0),
                     mu_s = i % 3 == 0 ? random_between(&seed, 0.0, 1.0) : mu_k + random_between(&seed, 0.0, 1.0);
        const ancf_friction law = {i % 7 == 0 ? ANCF_FRICTION_COULOMB : ANCF_FRICTION_HOLLARS, mu_s, mu_k, v0};
        const curve c = {mu_s, mu_k, v0, law.kind == ANCF_FRICTION_COULOMB};
        const double u = v0 * random_magnitude(&seed, 1e-3, 1e3), h = 1e-6 * u;
        double slope, unused;
        const double mu = ancf_friction_rising(&law, u, &slope);
        const bool falls = law.kind == ANCF_FRICTION_HOLLARS && mu_s > mu_k && u > v0;
        assert_near(mu, falls ? mu_s : (double)mu_of(&c, u), 1e-14);
        kept += falls;
        if (fabs(u - v0) < 2.0 * h) continue;
        const double rise = ancf_friction_rising(&law, u + h, &unused) - ancf_friction_rising(&law, u - h, &unused);
        assert_near(slope, rise / (2.0 * h), 1e-8 / u);
    }
    assert_true(kept > 1000);
}

static void friction_solve_finds_smallest_root(void** state) {
    (void)state;
    uint64_t seed = 2;
    int several = 0;
    for (int i = 0; i < 6000; i++) {
        const double v0 = random_magnitude(&seed, 1e-6, 1.0), mu_k = random_between(&seed, 0.0, 1.0);
        const double mu_s = i % 3 == 0 ? random_between(&seed, 0.0, 1.0) : mu_k + random_between(&seed, 0.0, 1.0);
        const ancf_friction_kind kind = i % 7 == 0 ? ANCF_FRICTION_COULOMB : ANCF_FRICTION_HOLLARS;
        const ancf_friction law = {kind, mu_s, mu_k, v0};
        const curve c = {mu_s, mu_k, v0, kind == ANCF_FRICTION_COULOMB};
        const double beta = v0 * random_magnitude(&seed, 1e-3, 1e6);
        // Half the speeds are where there are several roots: near v0 + beta mu_s.
        const double speed = i % 2 ? v0 * random_magnitude(&seed, 1e-4, 1e6)
                                   : v0 + beta * (mu_k + (mu_s - mu_k) * random_between(&seed, 0.5, 1.1));
        check_root(&law, &c, speed, beta);
        if (kind == ANCF_FRICTION_HOLLARS && mu_s > mu_k && speed < v0 + beta * mu_s && beta * (mu_s - mu_k) > v0 &&
            speed > v0 + beta * (mu_k + 0.2 * (mu_s - mu_k)))
            several++;
    }
    assert_true(several > 500);
}

// Three roots by hand: mu_k = 0, mu_s = 1/2, v0 = 1: s + b s/(1+s^2) below 1 and s + b/(1+s^2) above. b = 10,
// speed 5.5: g(1) = 1 + 5 - 5.5 > 0 and g(2) = 2 + 2 - 5.5 < 0, so one sticks, one is near 1.2 and one slides near 5.
static void friction_solve_sticks(void** state) {
    (void)state;
    const ancf_friction law = {ANCF_FRICTION_HOLLARS, 0.5, 0.0, 1.0};
    const double u = ancf_friction_solve(&law, 5.5, 10.0, 0.0);
    assert_true(u < 1.0);
    assert_near(u + 10.0 * u / (1.0 + u * u), 5.5, 1e-14);
    const double slid = ancf_friction_solve(&law, 6.0 + 1e-9, 10.0, 0.0); // just too fast to stick
    assert_true(slid > 4.0);
    assert_near(slid + 10.0 / (1.0 + slid * slid), 6.0 + 1e-9, 1e-14);
    // At the edge itself, v0 is the root.
    assert_near(ancf_friction_solve(&law, 6.0, 10.0, 0.0), 1.0, 1e-12);
}

// 1 + b D = speed, slope of g at v0 only 1 for any b: the hard case of Newton's method.
static void friction_solve_at_the_peak(void** state) {
    (void)state;
    const curve c = {0.5, 0.0, 1.0, false};
    const ancf_friction law = {ANCF_FRICTION_HOLLARS, 0.5, 0.0, 1.0};
    for (double b = 1e-3; b < 1e7; b *= 10.0)
        for (double off = 1e-15; off < 1.0; off *= 10.0) {
            check_root(&law, &c, (1.0 + 0.5 * b) * (1.0 - off), b);
            check_root(&law, &c, (1.0 + 0.5 * b) * (1.0 + off), b);
        }
}

static void friction_solve_at_the_ends(void** state) {
    (void)state;
    const ancf_friction law = {ANCF_FRICTION_HOLLARS, 0.3, 0.2, 1e-3};
    assert_true(ancf_friction_solve(&law, 0.0, 1.0, 0.0) == 0.0);
    assert_true(ancf_friction_solve(&law, 0.0, 0.0, 0.0) == 0.0);
    assert_close(ancf_friction_solve(&law, 2.5, 0.0, 0.0), 2.5, 1e-15);
    assert_close(ancf_friction_solve(&law, 1e-5, 0.0, 0.0), 1e-5, 1e-15);
    assert_near(ancf_friction_solve(&law, 1e12, 1.0, 0.0), 1e12 - 0.2, 1e-3);
    const double tiny = ancf_friction_solve(&law, 1e-310, 1e-3, 0.0); // denormal, linear range: /(1 + 0.4)
    assert_near(tiny, 1e-310 / 1.4, 1e-322);
    const double u = ancf_friction_solve(&law, 1e-12, 1e3, 0.0); // 1 + 0.4 beta/v0 = 400001
    assert_close(u, 1e-12 / 400001.0, 1e-14);
    const ancf_friction sharp = {ANCF_FRICTION_HOLLARS, 0.3, 0.2, 1e-310};
    assert_near(ancf_friction_solve(&sharp, 1.0, 1.0, 0.0), 0.8, 1e-12);
    const ancf_friction zero = {ANCF_FRICTION_HOLLARS, 0.0, 0.0, 1e-3};
    assert_close(ancf_friction_solve(&zero, 0.7, 1e3, 0.0), 0.7, 1e-15);
}

static void laws_are_checked(void** state) {
    (void)state;
    const ancf_normal good = {ANCF_NORMAL_NONLINEAR, 1e6, 1.5, 0.2};
    assert_int_equal(ancf_normal_check(&good), ANCF_OK);
    const ancf_normal bad[] = {
        {ANCF_NORMAL_NONLINEAR, 0.0, 1.5, 0.2}, {ANCF_NORMAL_NONLINEAR, -1.0, 1.5, 0.2},
        {ANCF_NORMAL_NONLINEAR, NAN, 1.5, 0.2}, {ANCF_NORMAL_NONLINEAR, INFINITY, 1.5, 0.2},
        {ANCF_NORMAL_NONLINEAR, 1e6, 0.0, 0.2}, {ANCF_NORMAL_HERTZ, 1e6, NAN, 0.2},
        {ANCF_NORMAL_NONLINEAR, 1e6, 1.5, -1.}, {ANCF_NORMAL_LINEAR, 1e6, 1.0, NAN},
        {(ancf_normal_kind)17, 1e6, 1.5, 0.2},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) assert_int_equal(ancf_normal_check(&bad[i]), ANCF_E_LAW);
    const ancf_friction fine[] = {
        {ANCF_FRICTION_HOLLARS, 0.3, 0.2, 1e-3},
        {ANCF_FRICTION_HOLLARS, 0.2, 0.3, 1e-3},
        {ANCF_FRICTION_COULOMB, 0.0, 0.0, 1e-3},
        {ANCF_FRICTION_NONE, NAN, NAN, 0.0},
    };
    for (size_t i = 0; i < sizeof fine / sizeof *fine; i++) assert_int_equal(ancf_friction_check(&fine[i]), ANCF_OK);
    const ancf_friction wrong[] = {
        {ANCF_FRICTION_HOLLARS, -.1, 0.2, 1e-3}, {ANCF_FRICTION_HOLLARS, 0.3, -.2, 1e-3},
        {ANCF_FRICTION_HOLLARS, NAN, 0.2, 1e-3}, {ANCF_FRICTION_COULOMB, 0.3, INFINITY, 1e-3},
        {ANCF_FRICTION_HOLLARS, 0.3, 0.2, 0.0},  {ANCF_FRICTION_COULOMB, 0.3, 0.2, -1e-3},
        {ANCF_FRICTION_HOLLARS, 0.3, 0.2, NAN},  {(ancf_friction_kind)17, 0.3, 0.2, 1e-3},
    };
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++)
        assert_int_equal(ancf_friction_check(&wrong[i]), ANCF_E_LAW);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(errors_have_texts),
        cmocka_unit_test(hertz_stiffness_by_hand),
        cmocka_unit_test(normal_force_by_hand),
        cmocka_unit_test(normal_force_never_attracts),
        cmocka_unit_test(normal_energy_is_work_of_loading),
        cmocka_unit_test(normal_tangent_is_slope),
        cmocka_unit_test(hunt_crossley_restitution),
        cmocka_unit_test(hertz_rebound_loses_nothing),
        cmocka_unit_test(dashpot_restitution),
        cmocka_unit_test(hollars_points),
        cmocka_unit_test(coulomb_points),
        cmocka_unit_test(friction_never_drives),
        cmocka_unit_test(friction_solve_finds_smallest_root),
        cmocka_unit_test(rising_friction_is_the_law),
        cmocka_unit_test(friction_solve_sticks),
        cmocka_unit_test(friction_solve_at_the_peak),
        cmocka_unit_test(friction_solve_at_the_ends),
        cmocka_unit_test(laws_are_checked),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
