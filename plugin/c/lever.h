// Contacts between two cables: where they touch is a radius from the centrelines that forces act on.
#ifndef ANCF_LEVER_H
#define ANCF_LEVER_H

#include "table.h"

// Whether couples go with a contact's friction.
static inline bool ancf_lever_has(const ancf_contact* c) {
    return c->radius[0] > 0.0 && c->rub.kind != ANCF_FRICTION_NONE;
}

// Gets a contact of two places that take couples ready.
void ancf_lever_prepare(const ancf_table* t, ancf_contact* c);

// Gives the couples on both slopes that balance the moment of an impulse on the first side and its opposite on the
// second, at the start of the step.
void ancf_lever_kick(ancf_table* t, const ancf_contact* c, const double impulse[3], double step);

// Adds to the velocity of the first side against the second what their turning makes at where they touch.
void ancf_lever_slip(double v[3], const ancf_table* t, const ancf_contact* c);

// Those couples, on either side's slope.
void ancf_lever_couples(double first[3], double second[3], const ancf_table* t, const ancf_contact* c,
                        const double impulse[3]);

// Friction acts from the start of the step: balances the moments of the normal impulses that act later, where it has
// moved the centrelines. Adds up in t->left what no couple can balance of all moments.
void ancf_lever_balance(ancf_table* t, double step);

#endif
