// Static equilibrium by Newton's method, where nothing comes near to what it may touch.
#ifndef ANCF_SETTLE_H
#define ANCF_SETTLE_H

#include "ancf/rest.h"

// Moves m->x to a minimum of energy as ancf_equilibrium does. rest: what it may touch, NULL: nothing. False: it found
// none, or came near to touching something; m->x is as it was.
bool ancf_settle(ancf_model* m, double tolerance, ancf_rest* rest);

#endif
