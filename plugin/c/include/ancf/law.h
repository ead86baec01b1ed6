// Contact laws of two bodies: normal force (Shan, Guo, Gill 2019, Table 1, Eq. 8-10) and friction (Eq. 11),
// friction also as the implicit solve at the new velocity.
#ifndef ANCF_LAW_H
#define ANCF_LAW_H

#include "error.h"

#include <stdbool.h>

typedef enum {
    ANCF_NORMAL_LINEAR,    // spring-dashpot, f = k d + c d'
    ANCF_NORMAL_HERTZ,     // f = k d^n
    ANCF_NORMAL_NONLINEAR, // Hunt-Crossley, f = k d^n + c d' d^n with c = 1.5 alpha k (Eq. 10)
} ancf_normal_kind;

typedef enum {
    ANCF_FRICTION_NONE,
    ANCF_FRICTION_COULOMB, // mu_k f_n, made continuous below v0
    ANCF_FRICTION_HOLLARS, // Eq. 11
} ancf_friction_kind;

typedef struct {
    ancf_normal_kind kind;
    double stiffness; // k [N/m^n]
    double exponent;  // n [-]; the spring-dashpot takes it as 1
    double damping;   // alpha [s/m] of Hunt-Crossley; c [N s/m] of the spring-dashpot
} ancf_normal;

typedef struct {
    ancf_friction_kind kind;
    double mu_s, mu_k; // static and kinetic coefficient [-]
    double v0;         // transition velocity v_t0 [m/s]
} ancf_friction;

ancf_error ancf_normal_check(const ancf_normal* law);
ancf_error ancf_friction_check(const ancf_friction* law);

// k of two elastic bodies in contact [N/m^1.5], Eq. 8-9. radius: of the contact, r1 r2/(r1 + r2), or the one
// radius against a plane [m]; young [Pa].
double ancf_hertz_stiffness(double radius, double young1, double poisson1, double young2, double poisson2);

// Normal force [N], never attractive. depth > 0 [m] where the bodies overlap, rate = d(depth)/dt [m/s].
double ancf_normal_force(const ancf_normal* law, double depth, double rate);

// Exponent n of the elastic part [-].
static inline double ancf_normal_exponent(const ancf_normal* law) {
    return law->kind == ANCF_NORMAL_LINEAR ? 1.0 : law->exponent;
}

// The law of a contact whose depth is only `share` times what the law is about, and acts back by as much.
ancf_normal ancf_normal_shared(const ancf_normal* law, double share);

// Slope df/d(depth) of the elastic part [N/m].
double ancf_normal_tangent(const ancf_normal* law, double depth);

// Elastic energy stored at a depth [J].
double ancf_normal_energy(const ancf_normal* law, double depth);

// Friction force per unit of normal force at a sliding speed >= 0 [-].
double ancf_friction_coefficient(const ancf_friction* law, double speed);

// Slope of the friction coefficient at rest [s/m]: (2 mu_s - mu_k)/v0 for Hollars.
double ancf_friction_slope(const ancf_friction* law);

// The coefficient [-] and its slope [s/m] as long as it rises with the speed; where it would fall it stays.
double ancf_friction_rising(const ancf_friction* law, double speed, double* slope);

// The speed u >= 0 [m/s] that is left once friction has acted: u + beta mu(u) = speed, beta = dt f_n/m >= 0 [m/s].
// On Stribeck's falling branch there can be several roots: the smallest, which sticks, is taken.
// `guess` is where it may be, 0 if that is not known.
double ancf_friction_solve(const ancf_friction* law, double speed, double beta, double guess);

#endif
