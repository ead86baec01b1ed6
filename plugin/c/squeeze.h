// Normal forces of contacts that press on one another, all at once.
#ifndef ANCF_SQUEEZE_H
#define ANCF_SQUEEZE_H

#include "table.h"

// Puts the forces of n contacts over a sub-step h right, at most ANCF_NEWTON_MOST, while the rest stay; returns the
// largest change. *left: by how much a force is off.
double ancf_squeeze(double* left, ancf_table* t, const int* contact, int n, double h, double enough);

#endif
