// How a model answers to forces on its elements: columns of the inverse mass matrix, made where they are first needed.
#ifndef ANCF_RESPONSE_H
#define ANCF_RESPONSE_H

#include "model.h"

// Accelerations of the unknowns `dof` of a block under unit forces on one element's four unknowns.
typedef struct {
    int n;
    const int* dof;            // (n)
    const double (*column)[4]; // (n) [1/kg and its like]
} ancf_response;

typedef struct ancf_responses ancf_responses;

ancf_error ancf_responses_create(ancf_responses** responses, const ancf_model* m);
void ancf_responses_destroy(ancf_responses* responses);

// That of an element; NULL: out of memory. What is below 1e-14 of its column's largest, in speed and in momentum, is
// left out.
const ancf_response* ancf_responses_of(ancf_responses* responses, const ancf_model* m, int element);

// A node's mass has changed, of a diagonal mass matrix: so do the responses that were made.
void ancf_responses_renew(ancf_responses* responses, const ancf_model* m, int node);

#endif
