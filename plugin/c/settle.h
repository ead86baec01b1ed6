// Static equilibrium by Newton's method, where nothing touches.
#ifndef ANCF_SETTLE_H
#define ANCF_SETTLE_H

#include "ancf/model.h"

// Moves m->x to a minimum of energy as ancf_equilibrium does, without contact. False: it found none, and m->x is as it
// was.
bool ancf_settle(ancf_model* m, double tolerance);

#endif
