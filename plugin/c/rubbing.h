// Friction of contacts that feel one another, all at once.
#ifndef ANCF_RUBBING_H
#define ANCF_RUBBING_H

#include "ancf/law.h"

// What friction can be: it rises with the speed by its law, to the coefficient `most` or to where the law would fall,
// and stays there.
typedef struct {
    const ancf_friction* law;
    double pressed, most; // normal impulse [N s], [-]
} ancf_rubbing;

// Friction impulses P of n contacts, two of each along two directions across its normal [N s], that belong to slips
// v = v0 + W P [m/s]; W is 2n x 2n [1/kg]. See ancf_newton.
int ancf_rubbing_solve(double* P, double* v, double* left, int n, const ancf_rubbing* contact, const double* W,
                       double enough, double* scratch);

#endif
