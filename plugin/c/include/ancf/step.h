// Time integration in phases: predict, contacts (contact.h), correct (leapfrog), and RK4 as the reference.
//
// Positions are those of the step, velocities those of the half step before it. The kick of a step is as long as the
// mean of this and the last step; a start from rest (last = 0) so makes half a kick, and the scheme is second order.
#ifndef ANCF_STEP_H
#define ANCF_STEP_H

#include "model.h"

typedef struct {
    double step, last; // length of this step and of the one before [s]; last = 0 at the start
} ancf_time;

// Length of a step's kick [s].
static inline double ancf_kick(const ancf_time* time) { return 0.5 * (time->last + time->step); }

// Phase 1: forces of elasticity, damping, gravity and m->external at the present state; then m->free = mean velocity of
// the step ahead if no more than these act.
void ancf_predict(ancf_model* m, const ancf_time* time);

// Phase 3: `after` (3 x stride) is m->free as contacts and couplings have changed it, or m->free itself if nothing did;
// `shift` (3 x stride) what they move besides step times that velocity, or NULL. Moves the state on by one step.
void ancf_correct(ancf_model* m, const ancf_time* time, const double* after, const double* shift);

// Both phases where nothing comes between them, to the last bit, but faster. Of m->f and m->a it leaves what belongs to
// nodes that are held, slide or have added mass, and to what else is held.
void ancf_advance(ancf_model* m, const ancf_time* time);

// One step of the classical Runge-Kutta scheme, m->external constant.
void ancf_rk4(ancf_model* m, double step);

// Accelerations at a state into m->a.
void ancf_acceleration(ancf_model* m, const double* x, const double* v);

// Force that holds an unknown at the last step [N, N m]: M a - f of its row, for nodes and slopes that are held and,
// across their lines, for nodes that slide. Of a slope that goes on into the next element, that on both copies.
void ancf_reaction(double force[3], const ancf_model* m, int dof);

#endif
