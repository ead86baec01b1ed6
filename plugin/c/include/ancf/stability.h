// The stable step of leapfrog.
#ifndef ANCF_STABILITY_H
#define ANCF_STABILITY_H

#include "model.h"

// Highest frequency of an element on its own [rad/s], straight and unstressed: a bound on that of the whole model.
double ancf_element_frequency(const ancf_element* element);

// By how much the square of that is larger at a strain, at most.
double ancf_stiffening(int kind, double strain);

// Stable step [s] of an element at a largest strain, h = 0.9 (2/w)(sqrt(1 + z^2) - z) with z = (damping w + drag/w)/2
// and w^2 times ancf_stiffening.
double ancf_element_step(const ancf_element* element, double strain);

// The least of all that are not wound on a drum; *element is the one that sets it. Not a number, 0 or infinite for
// values that are too far from those of a cable, in that element.
double ancf_critical_step(const ancf_model* m, double strain, int* element);

// Largest difference of the velocities of two nodes along an axis [m/s]: over the shortest length a bound on how fast
// strains grow.
double ancf_speed_spread(const ancf_model* m, const double* v);

// All values of a field, and their sum, are numbers.
bool ancf_finite(const ancf_model* m, const double* field);

#endif
