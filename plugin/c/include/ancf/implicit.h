// Implicit time integration: generalised-alpha (Chung, Hulbert 1993) with Newton's method.
//
// Positions, velocities and the accelerations that the method carries along are those of one time, the end of the step.
// Its length is a matter of accuracy alone; motions that it cannot resolve are damped, by the factor rho a step at
// infinite frequency.
#ifndef ANCF_IMPLICIT_H
#define ANCF_IMPLICIT_H

#include "model.h"
#include "step.h"

typedef struct ancf_stiffness ancf_stiffness;

typedef struct {
    double rho;     // 0: what is not resolved is gone after a step, 1: nothing is lost
    long rejected;  // steps and parts of them that did not converge and were taken again in halves, so far
    int parts;      // in how many the last step was taken
    int iterations; // Newton's, in the last step
    int element;    // where the last step went wrong, if it did
    double lost;    // energy that the method took out of the cables so far, where m->track is set [J]

    ancf_stiffness* stiffness;
    double* fields; // all of the following
    // (3 x stride) each
    double *start_x, *start_v, *start_a; // at the start of the step
    double *old_x, *old_v, *old_f;       // at the start of the part, and the force there
    double *inertia, *change;            // M a; Newton's correction
    double *held_a, *held_jerk;          // of what is held
    double *kept_x, *kept_v, *kept_f;    // the last state a force of the elements was asked for, and that force
    bool kept;
} ancf_implicit;

// rho from 0 to 1.
ancf_error ancf_implicit_create(ancf_implicit** implicit, const ancf_model* m, double rho);
void ancf_implicit_destroy(ancf_implicit* implicit);

// One step, in so many equal parts or more, from the state and `a` (3 x stride), the caller's accelerations that belong
// to it; time->last = 0: they are found first. m->external and gravity act as they are; what is held moves by its
// velocity m->held times the step, and its velocity and acceleration follow from that and the step before. m->f and
// m->a are then forces and accelerations that balance within the step, m->free the mean velocity. ANCF_E_STEP: it does
// not converge, in however short parts; the state is what it was.
ancf_error ancf_implicit_step(ancf_implicit* implicit, ancf_model* m, double* a, const ancf_time* time, int parts);

#endif
