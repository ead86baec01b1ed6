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
} ancf_account;

// Energies of n elements; damped: and their Kelvin-Voigt forces alone, where ancf_kernel would leave all forces.
void ancf_kernel_books(ancf_account* account, const ancf_fields* fields, int kind, bool bending, bool damped);

// Power of n elements' forces at their rates [W].
void ancf_kernel_power(double* power, const ancf_fields* fields);

#endif
