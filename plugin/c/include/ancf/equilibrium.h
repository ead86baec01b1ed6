// Static equilibrium under gravity, loads and contact.
#ifndef ANCF_EQUILIBRIUM_H
#define ANCF_EQUILIBRIUM_H

#include "rest.h"

// Moves m->x to a state where the force on every free unknown is below tolerance times the largest force in the model,
// velocities zero: by Newton's method, or where that comes near to contact or fails, by dynamic relaxation. rest: what
// it may touch, NULL: nothing. Returns ANCF_E_EQUILIBRIUM if it does not get there in `iterations`.
ancf_error ancf_equilibrium(ancf_model* m, double tolerance, int iterations, ancf_rest* rest);

#endif
