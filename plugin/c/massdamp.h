// Mass-proportional damping: a force -alpha M v of each element, which slows all its motion alike.
#ifndef ANCF_MASSDAMP_H
#define ANCF_MASSDAMP_H

#include "internal.h"

// Adds `part` of the forces at a velocity v; shared slopes are not joined.
void ancf_massdamp_force(double* force, const ancf_model* m, const double* v, double part);

// Power of the forces at v on a motion w [W]: not above 0 where these are one.
double ancf_massdamp_power(const ancf_model* m, const double* v, const double* w);

#endif
