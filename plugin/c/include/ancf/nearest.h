// Where a cable is nearest to a solid or to another cable, on the true curve.
//
// A piece of cable is divided into equal segments, and each has one place at most: that of its smallest gap. So a cable
// that lies along something is held all along, and nothing small passes between.
#ifndef ANCF_NEAREST_H
#define ANCF_NEAREST_H

#include "solid.h"
#include <stdbool.h>
#include <stdint.h>

// Centreline of an element: r(xi) = sum of Bernstein's polynomials times control points, xi in [0, 1].
typedef struct {
    double control[4][3]; // [m]
} ancf_cubic;

typedef struct {
    int segment;
    double xi;        // on the element
    double gap;       // between the surfaces [m], < 0: overlap
    double point[3];  // on the centreline [m]
    double normal[3]; // unit vector from the other body to the cable
    double power[3];  // xi, xi^2 and xi^3; their means if it is that of several places
    double share;     // derivative of the depth that its law is about by its own, see lying.h [-]; 1: a single place
} ancf_nearest;

typedef struct {
    int segment;        // of the first
    double xi[2];       // on the first and the second
    double gap;         // [m]
    double point[2][3]; // on the centrelines [m]
    double normal[3];   // unit vector from the second to the first
} ancf_nearest_pair;

void ancf_cubic_at(double r[3], const ancf_cubic* c, double xi);
void ancf_cubic_slope(double dr[3], const ancf_cubic* c, double xi); // dr/dxi

// The place at xi.
void ancf_nearest_place(ancf_nearest* place, int segment, double xi, const ancf_cubic* cable, double radius,
                        const ancf_solid* solid);

// Places of the segments whose gap is below `reach` [m], in the order of the segments; returns their number. found:
// room for `segments`.
int ancf_nearest_solid(ancf_nearest* found, const ancf_cubic* cable, int segments, double radius,
                       const ancf_solid* solid, double reach);

// The same for two elements: each segment of the first against the whole of the second.
int ancf_nearest_cubic(ancf_nearest_pair* found, const ancf_cubic* first, int segments, double radius1,
                       const ancf_cubic* second, double radius2, double reach);

// The same for those segments of the first, up to 64, whose bits are set in `which`. Pieces nearer than `far` [m] are
// searched with the same care, so that a place is the same whatever the reach.
int ancf_nearest_segments(ancf_nearest_pair* found, const ancf_cubic* first, int segments, uint64_t which,
                          double radius1, const ancf_cubic* second, double radius2, double reach, double far);

// No point of a cable is nearer to a point [m].
double ancf_nearest_least(const ancf_cubic* cable, const double point[3]);

// Where the part `within` of a cable is nearest to a point.
double ancf_nearest_from(const ancf_cubic* cable, const double within[2], const double point[3]);

// Where the part `within` of a first element and a second one are nearest to each other, near the places xi. False, and
// xi as it was, where that is not a minimum.
bool ancf_nearest_settle(double xi[2], const ancf_cubic* first, const double within[2], const ancf_cubic* second);

#endif
