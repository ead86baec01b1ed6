#include "ancf/law.h"

#include <math.h>
#include <stdbool.h>

enum { SOLVE_MAX = 100 }; // bisection alone would be done by then

static bool positive(double x) { return isfinite(x) && x > 0.0; }

static bool not_negative(double x) { return isfinite(x) && x >= 0.0; }

ancf_error ancf_normal_check(const ancf_normal* law) {
    const bool known =
        law->kind == ANCF_NORMAL_LINEAR || law->kind == ANCF_NORMAL_HERTZ || law->kind == ANCF_NORMAL_NONLINEAR;
    const bool exponent = law->kind == ANCF_NORMAL_LINEAR || positive(law->exponent);
    const bool damping = law->kind == ANCF_NORMAL_HERTZ || not_negative(law->damping);
    return known && exponent && damping && positive(law->stiffness) ? ANCF_OK : ANCF_E_LAW;
}

ancf_error ancf_friction_check(const ancf_friction* law) {
    if (law->kind == ANCF_FRICTION_NONE) return ANCF_OK;
    const bool known = law->kind == ANCF_FRICTION_COULOMB || law->kind == ANCF_FRICTION_HOLLARS;
    const bool mu_s = law->kind == ANCF_FRICTION_COULOMB || not_negative(law->mu_s);
    return known && mu_s && not_negative(law->mu_k) && positive(law->v0) ? ANCF_OK : ANCF_E_LAW;
}

double ancf_hertz_stiffness(double radius, double young1, double poisson1, double young2, double poisson2) {
    const double pi = 3.14159265358979323846;
    const double h1 = (1.0 - poisson1 * poisson1) / (pi * young1); // Eq. 9
    const double h2 = (1.0 - poisson2 * poisson2) / (pi * young2);
    return 4.0 * sqrt(radius) / (3.0 * pi * (h1 + h2)); // Eq. 8
}

// pow costs fifty times a square root, and 1.5 is what Hertz gives for spheres.
static double power(double depth, double exponent) {
    return exponent == 1.5 ? depth * sqrt(depth) : pow(depth, exponent);
}

double ancf_normal_force(const ancf_normal* law, double depth, double rate) {
    if (!(depth > 0.0)) return 0.0;
    double force = 0.0;
    switch (law->kind) { // Table 1
    case ANCF_NORMAL_LINEAR:
        force = law->stiffness * depth + law->damping * rate;
        break;
    case ANCF_NORMAL_HERTZ:
        force = law->stiffness * power(depth, law->exponent);
        break;
    case ANCF_NORMAL_NONLINEAR: // c = 1.5 alpha k, Eq. 10
        force = law->stiffness * power(depth, law->exponent) * (1.0 + 1.5 * law->damping * rate);
        break;
    }
    return force > 0.0 ? force : 0.0;
}

ancf_normal ancf_normal_shared(const ancf_normal* law, double share) {
    if (share == 1.0) return *law;
    ancf_normal own = *law;
    own.stiffness *= pow(share, ancf_normal_exponent(law) + 1.0);
    own.damping *= own.kind == ANCF_NORMAL_LINEAR ? share * share : share;
    return own;
}

double ancf_normal_tangent(const ancf_normal* law, double depth) {
    if (!(depth > 0.0)) return 0.0;
    const double n = ancf_normal_exponent(law);
    if (n == 1.0) return law->stiffness;
    return law->stiffness * n * (n == 1.5 ? sqrt(depth) : pow(depth, n - 1.0));
}

double ancf_normal_energy(const ancf_normal* law, double depth) {
    if (!(depth > 0.0)) return 0.0;
    const double n = ancf_normal_exponent(law);
    return law->stiffness * power(depth, n) * depth / (n + 1.0);
}

// Hollars' curve without min(v/v0, 1), at s = v/v0. With mu_s < mu_k/2 the formula would push near rest: not below 0.
static double stribeck(const ancf_friction* law, double s) {
    const double mu = law->mu_k + 2.0 * (law->mu_s - law->mu_k) / (1.0 + s * s);
    return mu > 0.0 ? mu : 0.0;
}

double ancf_friction_coefficient(const ancf_friction* law, double speed) {
    const double s = speed / law->v0, ramp = s < 1.0 ? s : 1.0;
    switch (law->kind) {
    case ANCF_FRICTION_NONE:
        return 0.0;
    case ANCF_FRICTION_COULOMB:
        return ramp * law->mu_k;
    case ANCF_FRICTION_HOLLARS:
        return ramp * stribeck(law, s); // Eq. 11
    }
    return 0.0;
}

double ancf_friction_slope(const ancf_friction* law) {
    switch (law->kind) {
    case ANCF_FRICTION_NONE:
        return 0.0;
    case ANCF_FRICTION_COULOMB:
        return law->mu_k / law->v0;
    case ANCF_FRICTION_HOLLARS:
        return stribeck(law, 0.0) / law->v0;
    }
    return 0.0;
}

double ancf_friction_rising(const ancf_friction* law, double speed, double* slope) {
    const double s = speed / law->v0;
    *slope = 0.0;
    if (law->kind == ANCF_FRICTION_COULOMB) {
        if (s < 1.0) *slope = law->mu_k / law->v0;
        return s < 1.0 ? s * law->mu_k : law->mu_k;
    }
    const double q = 1.0 / (1.0 + s * s), drop = 2.0 * (law->mu_s - law->mu_k) * q, mu = law->mu_k + drop;
    if (law->kind == ANCF_FRICTION_NONE || !(mu > 0.0)) return 0.0;
    if (s < 1.0) {
        *slope = (law->mu_k + drop * (2.0 * q - 1.0)) / law->v0;
        return s * mu;
    }
    if (drop > 0.0) return law->mu_s;
    *slope = -2.0 * drop * s * q / law->v0;
    return mu;
}

static double solve_coulomb(double mu, double speed, double beta, double v0) {
    const double stick = speed / (1.0 + beta * mu / v0);
    return stick <= v0 ? stick : speed - beta * mu;
}

// Value and first two derivatives at s of g(s) = s + b mu(s) - speed, for s on the ramp [0, 1] or beyond it.
typedef struct {
    double value, slope, bend;
} taylor;

static taylor expand(const ancf_friction* law, double s, double b, double speed, bool ramp) {
    const double q = 1.0 / (1.0 + s * s), drop = 2.0 * (law->mu_s - law->mu_k) * q;
    const double mu = law->mu_k + drop;
    if (mu < 0.0) return (taylor) {s - speed, 1.0, 0.0};
    if (ramp)
        return (taylor) {s + b * s * mu - speed, 1.0 + b * (law->mu_k + drop * (2.0 * q - 1.0)),
                         b * drop * 2.0 * s * q * (4.0 * q - 3.0)};
    return (taylor) {s + b * mu - speed, 1.0 - 2.0 * b * drop * s * q, b * drop * q * (6.0 - 8.0 * q)};
}

// Root of the parabola through a point. It holds where a double root is near, on which Newton's steps would only halve.
static double parabola_step(taylor g) {
    const double disc = g.slope * g.slope - 2.0 * g.value * g.bend;
    return -2.0 * g.value / (g.slope + (disc > 0.0 ? sqrt(disc) : 0.0));
}

// Root in [lo, hi], where g(lo) <= 0 <= g(hi), from s. Where a step leaves the bracket, it is halved.
static double solve_between(const ancf_friction* law, double s, double b, double speed, double lo, double hi,
                            bool ramp) {
    for (int i = 0; i < SOLVE_MAX; i++) {
        const taylor g = expand(law, s, b, speed, ramp);
        if (g.value > 0.0) hi = s;
        else lo = s;
        double next = s + parabola_step(g);
        if (!(next >= lo && next <= hi)) next = lo + 0.5 * (hi - lo);
        if (fabs(next - s) <= 1e-10 * s) // a step of third order: what is left is below rounding
            return next;
        s = next;
    }
    return s;
}

// The root on the ramp, sought from a guess, if it can be that.
static double stick_root(const ancf_friction* law, double b, double speed, double guess) {
    const double hi = speed < 1.0 ? speed : 1.0;
    if (!(guess > 0.0 && guess < hi)) guess = speed / (1.0 + b * stribeck(law, 0.0));
    return solve_between(law, guess < hi ? guess : hi, b, speed, 0.0, hi, true);
}

static double solve_hollars(const ancf_friction* law, double speed, double beta, double guess) {
    const double s = speed / law->v0, b = beta / law->v0;
    if (!(s < 1e150)) // so far out that the curve is flat; also keeps infinity out
        return speed - beta * law->mu_k;
    const double near = guess / law->v0;
    if (1.0 + b * stribeck(law, 1.0) >= s) return law->v0 * stick_root(law, b, s, near);
    return law->v0 * solve_between(law, near >= 1.0 && near < s ? near : s, b, s, 1.0, s, false);
}

double ancf_friction_solve(const ancf_friction* law, double speed, double beta, double guess) {
    if (!(speed > 0.0)) return 0.0;
    switch (law->kind) {
    case ANCF_FRICTION_NONE:
        return speed;
    case ANCF_FRICTION_COULOMB:
        return solve_coulomb(law->mu_k, speed, beta, law->v0);
    case ANCF_FRICTION_HOLLARS:
        return solve_hollars(law, speed, beta, guess);
    }
    return speed;
}
