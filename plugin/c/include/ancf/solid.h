// Solids that cables touch, as signed distances.
#ifndef ANCF_SOLID_H
#define ANCF_SOLID_H

#include "sheave.h"

typedef enum {
    ANCF_BALL,
    ANCF_BOX,
    ANCF_TRIANGLE, // both sides act
    ANCF_PLANE,    // through `center`; see `sense`
    ANCF_WHEEL,    // a sheave
} ancf_solid_kind;

typedef struct {
    ancf_solid_kind kind;
    double center[3];          // [m]
    double axis[3][3];         // box: unit vectors of its axes; plane: [0] its normal; wheel: [0] its axis
    double size[3];            // ball: [0] radius; box: half sizes [m]
    double corner[3][3];       // triangle [m]
    int sense;                 // plane: side that acts, 1 that of the normal, -1 the other, 0 the one a point is on
    const ancf_groove* groove; // wheel
} ancf_solid;

// Signed distance of a point from the surface [m], < 0 inside; normal: unit vector of its gradient, out of the solid.
// On a triangle, and on a plane of sense 0, nothing is inside.
double ancf_solid_distance(double normal[3], const ancf_solid* solid, const double point[3]);

// Half the diagonal of the solid's extent from `center` [m]: no point of it is farther; INFINITY for a plane.
double ancf_solid_reach(const ancf_solid* solid);

#endif
