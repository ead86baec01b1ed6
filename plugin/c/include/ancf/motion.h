// How far and how fast elements have gone: what was so far apart that this cannot have closed it needs no look.
//
// All goes against the mean of the nodes, so that a net that flies as a whole goes nowhere in itself.
#ifndef ANCF_MOTION_H
#define ANCF_MOTION_H

#include "model.h"

typedef struct {
    int n;              // elements
    double step;        // [s]
    long looks;         // how often it was followed
    double* place;      // (3 x stride) in the middle of the step
    double* gone;       // (n) no point of an element has gone farther in all, against the mean [m]
    double* speed;      // (n) no point of it is faster, against the mean [m/s]
    double mean_way[3]; // of the nodes, in all [m]
    double mean_velocity[3];
    double* lever; // (n_dof) by how much a slope moves a control point [m]; 0 for springs
    double* way;   // (3 x stride) since it was followed before
    double* size;  // (n_dof) of these, or of velocities, against the mean
} ancf_motion;

ancf_error ancf_motion_create(ancf_motion** motion, const ancf_model* m);
void ancf_motion_destroy(ancf_motion* motion);

// Follows to the middle of a step that starts now. Once more from the same state changes nothing.
void ancf_motion_follow(ancf_motion* motion, const ancf_model* m, double step);

#endif
