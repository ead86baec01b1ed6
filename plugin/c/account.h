// What all elements store and take out.
#ifndef ANCF_ACCOUNT_H
#define ANCF_ACCOUNT_H

#include "kernel.h"

typedef struct {
    double elastic; // energy [J]
    double power;   // of the Kelvin-Voigt forces, at the velocity that they are of [W]
} ancf_books;

// ancf_elastic_force, to the last bit, and its books. Leaves the Kelvin-Voigt forces in m->work.
void ancf_elastic_force_booked(ancf_books* books, ancf_model* m, double* force, const double* x, const double* v);

// Power of these at another velocity, before anything else uses m->work.
double ancf_elastic_power(const ancf_model* m, const double* v);

// What Kelvin-Voigt forces take out at a state [W].
double ancf_damping_power(const ancf_model* m, const double* x, const double* v);

#endif
