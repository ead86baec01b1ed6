// Elastic and damping forces of all elements.
#ifndef ANCF_ELASTIC_H
#define ANCF_ELASTIC_H

#include "model.h"

// force = -dU/de and the Kelvin-Voigt force at state (x, v), (3 x stride); shared slopes are not joined yet.
void ancf_elastic_force(ancf_model* m, double* force, const double* x, const double* v);

// Elastic energy of the elements begin .. end-1 [J], by axial strain and by bending.
void ancf_elastic_energy(double* axial, double* bending, const ancf_model* m, const double* x, int begin, int end);

#endif
