// What is held: its new velocity is given.
#ifndef ANCF_HELD_H
#define ANCF_HELD_H

#include "internal.h"

// Accelerations that bring it to that velocity within a kick; and that of what slides to one along its line.
void ancf_held_accelerate(ancf_model* m, double kick);

// That velocity, exactly; of what slides, along its line.
void ancf_held_set(const ancf_model* m, double* v);

// Keeps its places in m->free while a pass moves everything alike; then moves it on from them.
void ancf_held_keep(ancf_model* m);
void ancf_held_move(ancf_model* m, double kick, double step);

#endif
