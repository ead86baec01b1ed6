// Normal forces of contacts that press on one another, all at once.
#ifndef ANCF_SQUEEZE_H
#define ANCF_SQUEEZE_H

#include "table.h"

// Velocity along the normal that a contact has gained since the sub-step began [m/s].
double ancf_push_gained(const ancf_table* t, const ancf_push* push);

// Lets an impulse along the normal of a contact act on all that feel it.
void ancf_push_give(ancf_table* t, int contact, double impulse);

// Puts the forces of n contacts over a sub-step h right, at most ANCF_NEWTON_MOST, while the rest stay; returns the
// largest change.
double ancf_squeeze(ancf_table* t, const int* contact, int n, double h, double enough);

#endif
