// What normal forces do to one another in a sub-step: it acts on velocities beside those of the table.
#ifndef ANCF_PUSH_H
#define ANCF_PUSH_H

#include "table.h"

// Gets a contact ready to be pressed with others.
void ancf_push_find(ancf_table* t, int contact);

// Velocity along the normal that a contact has gained since the sub-step began [m/s].
double ancf_push_gained(const ancf_table* t, const ancf_push* push);

// Lets an impulse along the normal of a contact act on all that feel it.
void ancf_push_give(ancf_table* t, int contact, double impulse);

#endif
