// How a segment that lies along something is held.
//
// A contact law needs one depth. That of the deepest place alone would let the force of a segment that lies along a
// floor or a sheave jump from one of its ends to the other for ever. So the depth of a segment is, in the order in
// which they matter: that of its deepest place; or of this and the farther end, where they are nearly the same, as over
// a hump; or where it lies along the other side, a little more than the root mean square of depths along it. All is
// smooth between them. The elastic energy is that of the law at the one depth, so the force on a place is the law's
// times the derivative of the one depth by that at the place.
#ifndef ANCF_LYING_H
#define ANCF_LYING_H

#include "nearest.h"

// The deepest place, the farther end, and Gauss's points along the segment.
enum { ANCF_LYING_FIRST = 2, ANCF_LYING_SPOTS = ANCF_LYING_FIRST + 4 };

typedef struct {
    double xi, eta; // on the element, and on another one that it meets
    double depth;   // [m]
    double part;    // derivative of the one depth by this one [-]
    double at[3];   // on the centreline [m]
    double normal[3];
} ancf_spot;

// Where on its segment the other spots are, from the deepest, the first.
void ancf_lying_along(ancf_spot spot[ANCF_LYING_SPOTS], int segment, int segments);

// The one depth of spots; fills in their parts. *spread: how far those along the segment matter, 0 to 1.
double ancf_lying_depth(ancf_spot spot[ANCF_LYING_SPOTS], double* spread);

// Makes a segment's nearest place on a solid the mean of those that hold it. Depths are larger by `more` [m] for that:
// so much it may still sink in.
void ancf_lying_on(ancf_nearest* place, const ancf_cubic* cable, int segments, double radius, const ancf_solid* solid,
                   double more);

#endif
