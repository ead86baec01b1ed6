// The matrix of implicit steps and of Newton's method, mu M + K, over the unknowns that are free.
#ifndef ANCF_STIFFNESS_H
#define ANCF_STIFFNESS_H

#include "ancf/model.h"
#include "ldl.h"

typedef struct ancf_stiffness {
    ancf_ldl* ldl;
    int* row;         // (n_dof) of the matrix; -1: held, or nothing acts on it
    int* place;       // (n_elements x ELEMENT_PAIRS) 2 (number in ldl->value) + (1: transposed), or -1
    double* mass;     // (blocks of ldl) of M, each times I [kg, kg m, kg m2]
    double* drag;     // (blocks of ldl) of M times each element's mass-proportional damping [kg/s and its like]
    double* per_size; // (n_dof) one over what a change counts by: the shortest element at a node, 1 at a slope [1/m, -]
    double* tangent;  // (n_elements x ANCF_TANGENT)
    int n_across;     // blocks in the rows and columns of nodes that slide
    struct ancf_across* across;
} ancf_stiffness;

ancf_error ancf_stiffness_create(ancf_stiffness** stiffness, const ancf_model* m);
void ancf_stiffness_destroy(ancf_stiffness* stiffness);

// mu M + K, and rate times mass-proportional damping, at a state, and its factor; mu [1/s2], rate and definite as in
// tangent.h. False: not positive definite.
bool ancf_stiffness_factor(ancf_stiffness* stiffness, const ancf_model* m, const double* x, const double* v, double mu,
                           double rate, bool definite);

// change (3 x stride) = (mu M + K)^-1 force, 0 where held, along its line where a node slides; force joined.
void ancf_stiffness_solve(ancf_stiffness* stiffness, const ancf_model* m, double* change, const double* force);

// The largest of a change, in the sizes above; infinite if it is not finite.
double ancf_stiffness_size(const ancf_stiffness* stiffness, const ancf_model* m, const double* change);

// Largest change of a slope, or of an element's chord over its length: how far anything turns or stretches [-].
double ancf_stiffness_turn(const ancf_model* m, const double* change);

#endif
