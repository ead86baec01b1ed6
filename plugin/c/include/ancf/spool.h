// A drum from which a cable of springs, with its mass, is paid out, and onto which it is hauled in.
//
// The cable leaves the drum at a node, the exit: a place, through which the material flows. What is wound is mass at it
// (elements of ANCF_WOUND). The first element outside lies between the exit and the first node of the material; its
// unstressed length l changes at the rate u, and half of its mass goes with either end: with the node, and in the exit
// with the velocity w = v0 + u (r1 - r0)/l that the material has there. Of all nodes, and l, Lagrange's equations are
//     d(m1 v1)/dt = F1 + (rho A/2) u w,     d(m0 v0 + q)/dt = F0 - (rho A/2) u w,     q = (rho A/2) u (r1 - r0),
// so that linear momentum, with the q of what leaves, and the centre of mass go as they must, whatever u does. After
// Hong and Ren (2011) and Escalona (2017), whose elements have such a flow at their ends.
#ifndef ANCF_SPOOL_H
#define ANCF_SPOOL_H

#include "line.h"
#include "step.h"

typedef struct {
    int node;        // where the cable leaves the drum
    int element;     // that begins or ends there, the first one outside
    int store;       // wound element whose length it is fed from
    double both;     // unstressed length of these two [m]
    double beyond;   // unstressed length outside, without that element [m]
    double capacity; // unstressed length outside beyond which even a slipping drum gives nothing [m]
    ancf_winch law;  // its lengths are those of all that is outside
    double inertia;  // of the drum, over the square of its radius [kg]
    double rate;     // at which the length outside grew in the last step [m/s]
    double flow[3];  // q, momentum of what leaves, as far as it has been given [kg m/s]
    int does;        // ancf_drum
    double tension;  // in the cable where it leaves the drum, in the last step [N]
    double work;     // of the drum on the cable, up to the positions that the last step started from [J]
    double ahead;    // and in the half of that step behind them [J]
    double kinetic;  // energy of what flows, besides that of its mass with the velocity of the exit [J]
    double next;     // unstressed length of the element at the end of the step [m]
} ancf_spool;

// A model that was just made is told of it. ANCF_E_MEMORY.
ancf_error ancf_spool_join(const ancf_spool* s, ancf_model* m);

// Between ancf_predict and what comes then: decides how much is fed in the step, and changes the two nodes' m->free,
// m->a, m->f and mass.
void ancf_spool_feed(ancf_spool* s, ancf_model* m, const ancf_time* time);

// After the step: its length, and masses and weights of now.
void ancf_spool_end(const ancf_spool* s, ancf_model* m);

// Unstressed length of all that is outside [m].
double ancf_spool_length(const ancf_spool* s, const ancf_model* m);

// What momentum() of the model lacks, after a step that was `last` long [kg m/s].
void ancf_spool_momentum(double p[3], const ancf_spool* s, const ancf_model* m, double last);

// Between two steps: a node is put into the first element, or the one at its end taken out. Strain and velocity go on,
// and so does linear momentum, and the centre of mass but for what bends between the nodes.
typedef struct {
    double x[3], v[3]; // of the node that comes, or at the end of that which stays [m], [m/s]
    double exit[3];    // velocity of the exit then [m/s]
    double energy;     // gained by it [J]
} ancf_knotting;

// The new node leaves an element of a length on its far side; the first one has the rest, s->next.
void ancf_spool_split(ancf_knotting* node, ancf_spool* s, const ancf_model* m, double length, double last);

// `second`: the element beyond the first, which takes its place with the length s->next; node->v is the new velocity of
// its far node. Where the cable bends, its chord is shorter than two were: the drum takes that, so that tension goes
// on.
void ancf_spool_merge(ancf_knotting* node, ancf_spool* s, const ancf_model* m, int second, double last);

#endif
