// Forces of many elements at once, a lane each.
#ifndef ANCF_KERNEL_H
#define ANCF_KERNEL_H

#include "internal.h"

enum { ANCF_TILE = 192 }; // elements at most

// Components of what a kernel reads and writes, each (n). Rates are read by damped kernels and springs alone.
typedef struct {
    const double *way[3], *g0[3], *g1[3];    // r1 - r0 and the end slopes
    const double *wayv[3], *g0v[3], *g1v[3]; // their rates
    double *f0[3], *f1[3];                   // forces on the end slopes
    double* fd[3];                           // force on the end node, and the other way on the start node
    const double *inv_length, *ea, *ei, *eta;
    int n;
} ancf_fields;

// kind, bending and damped: those of all n elements.
void ancf_kernel(const ancf_fields* fields, int kind, bool bending, bool damped);

typedef struct {
    double axial, bending; // energy [J]
    double before, after; // power of the Kelvin-Voigt forces at two velocities, one of them that which they are for [W]
} ancf_account;

// What forces of n elements store and take out. after: whose rates are the second velocity; or NULL, and no power.
void ancf_kernel_account(ancf_account* account, const ancf_fields* fields, const ancf_fields* after, int kind,
                         bool bending);

#endif
