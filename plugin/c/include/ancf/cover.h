// What elements show to the outside: their thickness, how finely contacts are looked for, and what they may touch.
#ifndef ANCF_COVER_H
#define ANCF_COVER_H

#include "model.h"
#include "nearest.h"

typedef struct {
    double radius; // [m]; 0: touches nothing
    int segments;  // of the element, each with one place of contact at most
    bool points;   // places stand at the ends of the segments, as spheres; else they move along the curve
    int kind;      // number of material and radius together, for laws between cables
    int mask;      // bits; elements without a common one pass through each other
    int structure; // cable or net that it belongs to
    bool own;      // touches elements of its own structure
    int run;       // row of elements in which arc length counts
    double arc;    // unstressed length along the run to its start [m]
    double closed; // length of a run that ends where it starts, else 0 [m]
    bool owns[2];  // whether a sphere at the node is this element's
} ancf_cover;

// Centreline of an element at a state.
void ancf_cover_cubic(ancf_cubic* cubic, const ancf_model* m, const double* x, int element);

// The same a time later, at the velocities of now.
void ancf_cover_ahead(ancf_cubic* cubic, const ancf_model* m, int element, double time);

// Places of an element nearer to a solid than `reach` [m]; found: room for segments + 1. Returns their number.
int ancf_cover_touch(ancf_nearest* found, const ancf_cover* cover, const ancf_cubic* cubic, const ancf_solid* solid,
                     double reach);

#endif
