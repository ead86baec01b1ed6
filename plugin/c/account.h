// What all elements store and take out.
#ifndef ANCF_ACCOUNT_H
#define ANCF_ACCOUNT_H

#include "kernel.h"

// Elastic energy at x, and the power of the Kelvin-Voigt forces of v at v and at another velocity.
ancf_account ancf_elastic_account(const ancf_model* m, const double* x, const double* v, const double* after);

#endif
