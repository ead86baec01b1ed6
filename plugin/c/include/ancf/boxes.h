// Boxes around the elements, and which of them may meet.
//
// A box holds while its element has not moved by more than the room in it; what is far from everything costs no more
// than this look.
#ifndef ANCF_BOXES_H
#define ANCF_BOXES_H

#include "cover.h"

typedef struct {
    double low[3], high[3]; // [m]
} ancf_box;

typedef struct {
    int first, second; // first < second
} ancf_meeting;

typedef struct ancf_boxes ancf_boxes;

// cover: (n_elements), kept by the caller.
ancf_error ancf_boxes_create(ancf_boxes** boxes, const ancf_model* m, const ancf_cover* cover);
void ancf_boxes_destroy(ancf_boxes* boxes);

// Chooses the room of every element: what it moves by in `steps` steps at its speed now, and no less than a quarter of
// its radius. ahead: how far beyond it things have to be seen [m].
void ancf_boxes_plan(ancf_boxes* boxes, const ancf_model* m, double step, int steps, double ahead);

// Box of an element as it is now, with its room.
void ancf_boxes_of(ancf_box* box, const ancf_boxes* boxes, const ancf_model* m, int element);

// The same for a part of its cubic.
void ancf_boxes_around(ancf_box* box, const ancf_boxes* boxes, const ancf_cubic* part, int element);

// How far an element may move along each axis while its box holds [m].
double ancf_boxes_room(const ancf_boxes* boxes, int element);

// From now on, boxes are those of this state. Finds the pairs of elements that may meet while they hold; -1: out of
// memory.
int ancf_boxes_set(ancf_boxes* boxes, const ancf_model* m);

// Whether all boxes hold.
bool ancf_boxes_hold(const ancf_boxes* boxes, const ancf_model* m);

// Sorted by first, then second.
const ancf_meeting* ancf_boxes_meetings(const ancf_boxes* boxes, int* n);

// Box of an element when they were set; nothing for one that touches nothing.
const ancf_box* ancf_boxes_box(const ancf_boxes* boxes, int element);

// Largest speed of a node, or of a slope over a third of its element [m/s].
double ancf_boxes_fastest(const ancf_model* m);

#endif
