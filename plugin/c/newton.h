// Friction of contacts that feel one another, all at once.
#ifndef ANCF_NEWTON_H
#define ANCF_NEWTON_H

#include "ancf/law.h"

// What friction can be: it rises with the speed by its law, to the coefficient `most` or to where the law would fall,
// and stays there.
typedef struct {
    const ancf_friction* law;
    double pressed, most; // normal impulse [N s], [-]
} ancf_rubbing;

// Contacts, and room for numbers that they need beside W.
enum { ANCF_NEWTON_MOST = 32, ANCF_NEWTON_ROOM = (4 * ANCF_NEWTON_MOST + 9) * ANCF_NEWTON_MOST };

// Friction impulses P of n contacts, two of each along two directions across its normal [N s], that belong to slips
// v = v0 + W P [m/s], W symmetric and without negative eigenvalues (2n x 2n) [1/kg]. In and out: P, and v with it.
// Ends when no friction is off by more than `enough` [N s]; *left is by how much it is. Returns the number of steps.
int ancf_newton_friction(double* P, double* v, double* left, int n, const ancf_rubbing* contact, const double* W,
                         double enough, double* scratch);

#endif
