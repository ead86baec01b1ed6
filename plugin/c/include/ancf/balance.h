// Energies and momenta.
#ifndef ANCF_BALANCE_H
#define ANCF_BALANCE_H

#include "model.h"

typedef struct {
    double kinetic, axial, bending, gravity; // [J]
} ancf_energy;

// Energies of the elements begin .. end-1, without the masses added at nodes, at the model's state.
void ancf_energy_of(ancf_energy* energy, const ancf_model* m, int begin, int end);

// Linear [kg m/s] and angular momentum about the origin [kg m2/s], added masses included. Uses m->work.
void ancf_momentum(double linear[3], double angular[3], ancf_model* m);

#endif
