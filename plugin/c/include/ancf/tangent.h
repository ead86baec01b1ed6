// Derivative of the elastic and damping forces of every element: what implicit steps and Newton's method solve with.
#ifndef ANCF_TANGENT_H
#define ANCF_TANGENT_H

#include "model.h"

// Entries of an element's tangent over (g0, d, g1), d = (r1 - r0)/L, each block 3x3: the diagonal blocks' upper
// triangles (xx xy xz yy yz zz) of g0, d, g1 from 0, 6 and 12 on, then row by row the blocks (g0, d), (g0, g1), (d, g1)
// from 18, 27 and 36 on.
enum { ANCF_TANGENT = 45 };

// tangent: (n_elements x ANCF_TANGENT), -df/dx for a change of x that takes v along, dv = rate dx [1/s]; of what
// damping adds, which is not symmetric, the symmetric part. definite: what could make it indefinite is left out,
// compression above all; it is then an approximation.
void ancf_tangent(double* tangent, const ancf_model* m, const double* x, const double* v, double rate, bool definite);

#endif
