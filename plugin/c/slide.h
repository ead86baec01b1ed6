// Nodes that go along straight lines alone, without mass of their own and without friction: what holds them across
// their lines is found exactly, from the inverse of what it does to all of them.
#ifndef ANCF_SLIDE_H
#define ANCF_SLIDE_H

#include "internal.h"

// Once the mass matrix is there, with the slides' list as copied from the definition.
ancf_error ancf_slides_create(ancf_model* m);
void ancf_slides_destroy(ancf_model* m);

// Takes what is across the lines off the nodes of a field of velocities or forces, such as m->f of a structure at rest.
void ancf_slides_project(const ancf_model* m, double* field);

// Puts the nodes on their lines.
void ancf_slides_place(ancf_model* m);

// Accelerations that take what is across off the velocity within a kick.
void ancf_slides_accelerate(ancf_model* m, double kick);

// Around a solve with the mass matrix alone: keeps what is across of given accelerations; then adds what forces across
// the lines do so that it is that again.
void ancf_slides_give(const ancf_model* m, const double* acceleration);
void ancf_slides_constrain(const ancf_model* m, double* acceleration);

// Around a pass that moves everything alike: keeps places and velocities; then moves them on from these, with the
// accelerations in m->a, where ancf_slides_give was told of what is across.
void ancf_slides_keep(ancf_model* m);
void ancf_slides_move(ancf_model* m, double kick, double step);

// What holds a node that slides is across its line: takes the rest off its force.
void ancf_slides_take(double force[3], const ancf_model* m, int node);

// Impulses across the lines that take these velocities (n_slides) away.
void ancf_slides_hold(double (*impulse)[3], const ancf_model* m, double (*velocity)[3]);

#endif
