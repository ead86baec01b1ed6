// What cables touch while they come to rest: normal forces by position alone; nothing rubs, nothing is damped.
//
// Places are those of the step (cover.h, cross.h). Where a segment lies along a solid, so that its gap is nearly the
// same all along, its force is spread over it: a single place would jump from end to end and never settle.
#ifndef ANCF_REST_H
#define ANCF_REST_H

#include "cross.h"

// A solid that cables may touch.
typedef struct {
    ancf_solid solid;
    int node;               // that carries it, without turning it; -1: it stands still
    double arm[3];          // from the node to its centre [m]
    int mask;               // bits; elements without a common one pass through it
    const ancf_normal* law; // (kinds of cover) against elements
    const int* excluded;    // (n_excluded) elements that never touch it, ascending
    int n_excluded;
    double force[3], moment[3]; // out: on it, the latter about the origin [N], [N m]
} ancf_obstacle;

// Two obstacles that may touch; the first is a ball that a node carries.
typedef struct {
    int ball, other;
    ancf_normal law;
} ancf_obstacle_pair;

typedef struct ancf_rest ancf_rest;

// What is given is kept by the caller. laws: (kinds x kinds) between cables.
ancf_error ancf_rest_create(ancf_rest** rest, const ancf_model* m, const ancf_cover* cover, const ancf_laws* laws,
                            int kinds, ancf_obstacle* obstacle, int n_obstacles, const ancf_obstacle_pair* pair,
                            int n_pairs);
void ancf_rest_destroy(ancf_rest* rest);

// How many pairs may touch, wherever the state goes until the next look; rate: (3 x stride) its change by an iteration.
// -1: out of memory.
int ancf_rest_look(ancf_rest* rest, ancf_model* m, double* rate);

// Whether nothing can touch anywhere between the state of now and that after a change of it by `way` (3 x stride).
bool ancf_rest_clear(ancf_rest* rest, ancf_model* m, double* way);

// Contacts at the state of now and its rate, fields (3 x stride) with shared slopes joined: forces; masses to be added
// so that iterations stay stable; and forces that keep the sides of a contact from bouncing, 0 at rest.
void ancf_rest_press(ancf_rest* rest, const ancf_model* m, const double* rate);
const double* ancf_rest_force(const ancf_rest* rest);
const double* ancf_rest_inertia(const ancf_rest* rest);
const double* ancf_rest_drag(const ancf_rest* rest);

// Farthest that anything may move at once, so as not to pass through [m].
double ancf_rest_leap(const ancf_rest* rest);

#endif
