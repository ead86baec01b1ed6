// The mass matrix: scalar times the 3x3 identity, factored once. One that is diagonal may change with the lengths of
// springs (spool.h).
#ifndef ANCF_MASS_H
#define ANCF_MASS_H

#include "model.h"

// Element mass over (r0, g0, r1, g1): the exact integral of rho A S^T S, or lumped in the proportions of its
// diagonal with the total mass kept (Hinton, Rock, Zienkiewicz 1976).
void ancf_mass_element(double M[4][4], const ancf_element* element);

// Exact integral of rho A S, what a unit of gravity does to an element's unknowns [kg], [kg m], however its mass is
// lumped.
void ancf_mass_weight(double w[4], const ancf_element* element);

ancf_error ancf_mass_create(ancf_model* m, const double* added);
void ancf_mass_destroy(ancf_mass* mass);

// acceleration = M^-1 force, all (3 x stride); force joined. Where a node or slope is held, `acceleration` holds
// the given value before and after; where a node slides, its part across the line.
void ancf_mass_solve(const ancf_model* m, double* acceleration, const double* force);

// product = M field; shared slopes come out joined.
void ancf_mass_multiply(const ancf_model* m, double* product, const double* field);

// Kinetic energy of all elements, added masses left out [J]; only where the matrix is diagonal.
double ancf_mass_kinetic(const ancf_model* m);

// The same at v + last/2 a, less that at step/2 a (balance.h).
double ancf_mass_kinetic_kept(const ancf_model* m, double last, double step);

// Mass added at a node [kg].
double ancf_mass_added(const ancf_model* m, int node);

// Inverse of the diagonal mass of every unknown (stride), 0 where it is held or has none [1/kg and its like].
const double* ancf_mass_inverse(const ancf_model* m);

// Mass of a node, where the matrix is diagonal [kg].
double ancf_mass_of_node(const ancf_model* m, int node);

// After the length of a spring has changed, where the matrix is diagonal.
void ancf_mass_refresh(ancf_model* m, int element);

// A node answers as if it had another mass, until ancf_mass_refresh [kg].
void ancf_mass_lend(ancf_model* m, int node, double mass);

// True if the whole matrix is diagonal.
bool ancf_mass_diagonal(const ancf_model* m);

#endif
