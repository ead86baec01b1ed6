// Elastic and damping forces of all elements.
#ifndef ANCF_ELASTIC_H
#define ANCF_ELASTIC_H

#include "model.h"

// force = -dU/de and the Kelvin-Voigt force at state (x, v), (3 x stride); shared slopes are not joined yet.
void ancf_elastic_force(ancf_model* m, double* force, const double* x, const double* v);

// Elastic energy of the elements begin .. end-1 [J], by axial strain and by bending.
void ancf_elastic_energy(double* axial, double* bending, const ancf_model* m, const double* x, int begin, int end);

// Strain at xi: Green's (r'.r' - 1)/2 for ANCF, engineering strain for springs [-].
double ancf_strain(const ancf_model* m, const double* x, int element, double xi);

// Tension at xi, damping included: EA eps |r'| for ANCF, the spring's force for springs [N].
double ancf_tension(const ancf_model* m, int element, double xi);

// Largest strain of all elements, over their ends and middles, and its element; what is not a number is left out [-].
double ancf_strain_max(const ancf_model* m, const double* x, int* element);

#endif
