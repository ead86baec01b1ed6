// What is in a mass matrix, for the files that solve with it.
#ifndef ANCF_FACTOR_H
#define ANCF_FACTOR_H

#include "ancf/mass.h"

// Unknowns that share a slope, or have no mass, are numbered once or not at all: `row` maps a block's place to its row
// of the matrix. A diagonal matrix needs no more than its inverse, another as L L^T in an order that keeps L sparse.
// Where every element keeps both slopes to itself, as in a net, they are eliminated exactly element by element, in
// lanes, and only the nodes' matrix is left, which is inverted outright if it is small.
struct ancf_mass {
    bool diagonal, condensed;
    bool held;          // something is held that has mass
    double* inverse;    // (stride) 1 over the diagonal of M, 0 where held or massless
    double* added;      // (n_nodes) [kg]
    double* own;        // (stride) diagonal of the elements alone, copies of a shared slope apart
    int* row;           // (stride) row of an unknown in the factor, or -1
    int n;              // rows
    int *begin, *index; // columns of L below the diagonal, each sorted
    double *value, *pivot;
    double (*rhs)[4];   // (n) right-hand sides x, y, z side by side
    double* matrix;     // (6 x n_elements) what an element's matrix consists of
    double* slope_flex; // (n_elements) 60/(m L^2), condensed only
    double* push;       // (6 x n_elements) what the slopes' forces do to the nodes, x y z, starts and ends in each
    int* from;          // (2 n_elements) places in a component of `push` of what meets at the nodes, as m->at
    int rows;           // n rounded up, 0: the nodes' matrix is not inverted
    double* full;       // (n x rows) its inverse, column by column
    double* load;       // (6 x rows) forces and accelerations of the nodes
};

// ancf_mass_solve as if nothing slid.
void ancf_mass_solve_freely(const ancf_model* m, double* acceleration, const double* force);

// rhs = (L L^T)^-1 rhs; not where the matrix is diagonal.
void ancf_mass_solve_rows(const ancf_mass* mass);

#endif
