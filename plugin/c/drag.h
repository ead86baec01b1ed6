// Friction of one contact among others, while it is sought. It acts on velocities beside those of the table, `pushed`
// of places and bodies.
#ifndef ANCF_DRAG_H
#define ANCF_DRAG_H

#include "table.h"

// Two directions across the normal of a contact, what an impulse along either moves and turns, and the slip by that:
// `own`. The rest is left as it is.
void ancf_drag_find(ancf_table* t, int contact);

// Slips of n contacts along their directions by unit impulses along them, W (2n x 2n) [1/kg].
void ancf_drag_effects(double* W, ancf_table* t, const int* contact, int n);

// Slip along both directions: d->slip and what `pushed` makes [m/s].
void ancf_drag_slip(double v[2], const ancf_table* t, const ancf_contact* c, const ancf_drag* d);

// Lets an impulse along both directions [N s] act on the `pushed` of all that feel it.
void ancf_drag_give(ancf_table* t, const ancf_contact* c, const ancf_drag* d, const double impulse[2]);

#endif
