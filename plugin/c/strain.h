// What the elastic forces and their derivatives share.
#ifndef ANCF_STRAIN_H
#define ANCF_STRAIN_H

#include "internal.h"

// Gauss points on [0, 1].
static const double gauss3_xi[3] = {0.5 - 0.38729833462074170, 0.5, 0.5 + 0.38729833462074170};
static const double gauss3_weight[3] = {5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0};
static const double gauss5_xi[5] = {0.5 - 0.45308992296933199640, 0.5 - 0.26923465505284154552, 0.5,
                                    0.5 + 0.26923465505284154552, 0.5 + 0.45308992296933199640};
static const double gauss5_weight[5] = {0.11846344252809454376, 0.23931433524968323402, 0.28444444444444444444,
                                        0.23931433524968323402, 0.11846344252809454376};

// Curvature below which its direction is noise, times L.
static const double tiny_curvature2 = 1e-18;

ANCF_INLINE double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

#endif
