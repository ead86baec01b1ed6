// Which segments of elements are apart, and how long they rest.
//
// Of two segments near each other an axis is remembered along which the hulls of their control points are apart. They
// rest until both together may have closed that gap; then the gap along the axis is looked at again, and only where it
// is too small are the curves themselves. A segment that rests touches nothing, so that resting changes no contact.
#ifndef ANCF_APART_H
#define ANCF_APART_H

#include "boxes.h"
#include "motion.h"
#include <stdint.h>

typedef struct ancf_apart ancf_apart;

// Two elements that may be nearer than their reach.
typedef struct {
    int first, second;   // first < second
    uint64_t segments;   // of the first where they may, as bits
    double reach;        // [m]
    ancf_cubic cubic[2]; // in the middle of the step
    int next;            // number of the pair after it
} ancf_near;

// cover: (n_elements), and motion, followed before pairs are asked for: kept by the caller.
ancf_error ancf_apart_create(ancf_apart** apart, const ancf_model* m, const ancf_cover* cover,
                             const ancf_motion* motion);
void ancf_apart_destroy(ancf_apart* apart);

// After boxes have been set: the segments that may meet while these hold. Returns the number of pairs of segments;
// -1: out of memory.
int ancf_apart_set(ancf_apart* apart, const ancf_boxes* boxes, const ancf_model* m);

// The next pair that does not rest, in the order of first and second; starts with one that is zero. False: no more.
bool ancf_apart_next(ancf_near* near, ancf_apart* apart, const ancf_model* m);

// Remembers directions from places of the pair, (n) sorted by segment.
void ancf_apart_learn(ancf_apart* apart, const ancf_near* near, const ancf_nearest_pair* found, int n);

// How near two elements have to be to be looked at in a step, at a speed of one against the other [m].
double ancf_apart_reach(const ancf_cover* first, const ancf_cover* second, double step, double speed);

// No distance of the i-th of n equal parts of a cubic from the j-th of n2 of another is smaller, if the axis is a unit
// vector; < 0 along one that does not part them [m].
double ancf_cubic_gap(const double axis[3], const ancf_cubic* first, int i, int n, const ancf_cubic* second, int j,
                      int n2);

#endif
