// Groove of a sheave: contact of a ball with a body of revolution, without facets.
//
// Half of the profile in the meridian half plane, u = |z| along the axis, q = height above the bottom of the groove:
// floor, fillet, wall, land, side face:
//
//        land          lip   q = height
//       +----------+
//  side |           \  wall, inclined by `slope`
//       |            `--.____________ q = 0
//       |             fillet  floor
//
// The distance to it has a continuous gradient wherever the fillet is larger than the ball.
#ifndef ANCF_SHEAVE_H
#define ANCF_SHEAVE_H

#include "error.h"

typedef struct {
    double radius; // at the bottom of the groove [m]
    double floor;  // half width of the flat bottom [m]
    double fillet; // radius that joins bottom and wall [m]
    double slope;  // of the wall against the floor, above 0 to pi/2 [rad]
    double height; // of the lip above the bottom [m]; 0: a plain cylinder
    double land;   // width of the rim beyond the lip [m]
} ancf_groove;

typedef struct {
    double depth;     // of the ball in the sheave [m], < 0: they do not touch
    double normal[3]; // unit vector out of the sheave
} ancf_groove_contact;

ancf_error ancf_groove_check(const ancf_groove* groove);

// Half of the width between the lips, and of the whole rim [m].
double ancf_groove_opening(const ancf_groove* groove);
double ancf_groove_half_width(const ancf_groove* groove);

// Signed distance of (u >= 0, q) from the profile [m], < 0 inside the sheave; gradient: its direction.
double ancf_groove_distance(double gradient[2], const ancf_groove* groove, double u, double q);

// Contact with a ball of a radius whose centre is at `place` from the sheave's centre; axis: unit vector.
void ancf_groove_touch(ancf_groove_contact* contact, const ancf_groove* groove, const double axis[3],
                       const double place[3], double radius);

// Mean curvature of the surface at the bottom [1/m]: half of 1/radius - 1/fillet, the latter where there is no floor.
double ancf_groove_curvature(const ancf_groove* groove);

#endif
