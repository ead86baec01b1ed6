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
    double axial, bending; // [J]
} ancf_energies;

// Energies of n elements without forces.
void ancf_kernel_energy(ancf_energies* energy, const ancf_fields* fields, int kind, bool bending);

// What elements store, and what damping does.
typedef struct {
    double elastic;                // energy [J]
    double *f0[3], *f1[3], *fd[3]; // Kelvin-Voigt forces alone, of elements that have them
    double power;                  // of these at the elements' rates [W]
} ancf_account;

// ancf_kernel, to the last bit, and the account of its elements.
void ancf_kernel_booked(ancf_account* account, const ancf_fields* fields, int kind, bool bending, bool damped);

// Power of n elements' forces at their rates [W].
void ancf_kernel_power(double* power, const ancf_fields* fields);

#endif
