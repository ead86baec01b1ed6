// One freedom with inertia, drive, viscous and dry friction: the turning of a sheave (J [kg m2], torque [N m], speed
// [rad/s]) or a slide on a guide (m [kg], force [N], speed [m/s]).
#ifndef ANCF_ROTOR_H
#define ANCF_ROTOR_H

#include "error.h"

typedef struct {
    double inertia; // > 0
    double viscous; // friction per speed, >= 0
    double dry;     // bound of the dry friction, >= 0
} ancf_rotor;

ancf_error ancf_rotor_check(const ancf_rotor* rotor);

// Speed after a step of length dt under a force or torque. Both frictions belong to the new speed: dry friction holds
// truly. friction: out, the dry part that acted.
double ancf_rotor_step(double* friction, const ancf_rotor* rotor, double speed, double force, double dt);

// Inertia that a kick within a step of length dt has to overcome.
double ancf_rotor_resistance(const ancf_rotor* rotor, double dt);

#endif
