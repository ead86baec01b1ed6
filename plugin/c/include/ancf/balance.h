// Energies and momenta.
#ifndef ANCF_BALANCE_H
#define ANCF_BALANCE_H

#include "model.h"

typedef struct {
    double kinetic, axial, bending, gravity; // [J]
} ancf_energy;

// Energies of the elements begin .. end-1, without the masses added at nodes, at the model's state.
void ancf_energy_of(ancf_energy* energy, const ancf_model* m, int begin, int end);

// Kinetic energy, without added masses, that leapfrog keeps the sum of with the elastic energy of positions: of the
// velocity there, `last` before which m->v was taken, less that of half the next kick, which lasts `step` [J]. For a
// linear cable and even steps that sum is exact, v-^T M v+/2 + V. Uses m->work.
double ancf_kinetic_kept(const ancf_model* m, double last, double step);

// Potential of gravity at the model's state, added masses included [J].
double ancf_height(const ancf_model* m);

// Linear [kg m/s] and angular momentum about the origin [kg m2/s], added masses included. Uses m->work.
void ancf_momentum(double linear[3], double angular[3], ancf_model* m);

#endif
