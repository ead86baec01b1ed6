// Laws of contact, friction and bearings: what is out of range is refused, what passes gives numbers.
#include "ancf/rotor.h"
#include "fuzz.h"

static bool good(double value) { return isfinite(value) && value > 0.0; }

static bool not_negative(double value) { return isfinite(value) && value >= 0.0; }

static void normal(fuzz* f) {
    const ancf_normal law = any_normal_law(f);
    const bool linear = law.kind == ANCF_NORMAL_LINEAR, hertz = law.kind == ANCF_NORMAL_HERTZ;
    const bool right = good(law.stiffness) && (linear || good(law.exponent)) && (hertz || not_negative(law.damping));
    need((ancf_normal_check(&law) == ANCF_OK) == right);
    const double depth = magnitude(f, 1e-9, 1e-2), rate = between(f, -10.0, 10.0);
    const double force = ancf_normal_force(&law, depth, rate);
    need(force >= 0.0);
    if (!(depth > 0.0)) need(force == 0.0 && ancf_normal_tangent(&law, depth) == 0.0);
    if (f->chance > 0.0) return;
    need(isfinite(force) && good(ancf_normal_tangent(&law, depth)) && good(ancf_normal_energy(&law, depth)));
    // The energy's derivative is the elastic force.
    const double n = linear ? 1.0 : law.exponent;
    need(fabs(ancf_normal_energy(&law, depth) * (n + 1.0) / depth - ancf_normal_force(&law, depth, 0.0)) <=
         1e-12 * ancf_normal_force(&law, depth, 0.0));
    const ancf_normal half = ancf_normal_shared(&law, 0.5);
    need(fabs(ancf_normal_energy(&half, depth) - ancf_normal_energy(&law, 0.5 * depth)) <=
         1e-12 * ancf_normal_energy(&half, depth));
}

// The speed that is left solves u + beta mu(u) = speed, and no smaller one does.
static void friction(fuzz* f) {
    const ancf_friction law = any_friction_law(f);
    const bool none = law.kind == ANCF_FRICTION_NONE, coulomb = law.kind == ANCF_FRICTION_COULOMB;
    const bool right = none || ((coulomb || not_negative(law.mu_s)) && not_negative(law.mu_k) && good(law.v0));
    need((ancf_friction_check(&law) == ANCF_OK) == right);
    if (!right) return;
    const double speed = magnitude(f, 1e-9, 1e2), beta = magnitude(f, 1e-9, 1e2);
    const double guess = by_chance(f, 0.5) ? 0.0 : magnitude(f, 1e-9, 1e2);
    double slope;
    const double rising = ancf_friction_rising(&law, speed, &slope);
    const double u = ancf_friction_solve(&law, speed, beta, guess);
    if (f->chance > 0.0) return;
    need(rising >= 0.0 && rising <= fmax(law.mu_s, law.mu_k) * (1.0 + 1e-12));
    need(u >= 0.0 && u <= speed);
    need(fabs(u + beta * ancf_friction_coefficient(&law, u) - speed) <= 1e-7 * speed);
    for (int i = 1; i < 8; ++i) {
        const double below = u * i / 8.0;
        need(below + beta * ancf_friction_coefficient(&law, below) <= speed * (1.0 + 1e-9));
    }
}

// The impulse goes into speed and friction, and friction never drives.
static void rotor(fuzz* f) {
    const ancf_rotor r = {magnitude(f, 1e-6, 10.0), by_chance(f, 0.3) ? 0.0 : magnitude(f, 1e-6, 1.0),
                          by_chance(f, 0.3) ? 0.0 : magnitude(f, 1e-6, 1.0)};
    const bool right = good(r.inertia) && not_negative(r.viscous) && not_negative(r.dry);
    need((ancf_rotor_check(&r) == ANCF_OK) == right);
    const double speed = between(f, -10.0, 10.0), force = between(f, -10.0, 10.0), dt = magnitude(f, 1e-6, 1e-3);
    double rubs;
    const double now = ancf_rotor_step(&rubs, &r, speed, force, dt);
    if (f->chance > 0.0) return;
    need(isfinite(now) && fabs(rubs) <= r.dry * (1.0 + 1e-12) && rubs * now <= 0.0);
    const double terms = r.inertia * fabs(speed) + dt * (fabs(force) + r.dry);
    need(fabs(r.inertia * (now - speed) - dt * (force + rubs - r.viscous * now)) <= 1e-13 * terms);
}

void fuzz_laws(fuzz* f) {
    normal(f);
    friction(f);
    rotor(f);
}
