// What elements carry along themselves.
#ifndef ANCF_TENSION_H
#define ANCF_TENSION_H

#include "model.h"

// Strain at xi: Green's (r'.r' - 1)/2, or engineering strain |r'| - 1 [-], always for springs. Where an element bends,
// the strain of its cubic swings about what it is on the mean.
double ancf_strain(const ancf_model* m, const double* x, int element, double xi);

// Tension at xi, damping included [N]: of a spring its force; of ANCF elements the part along the cable of the internal
// force, as the force balance of the nodes has it. That is exact in the middle of an element under a uniform load;
// between the middles of two it goes straight, unless something acts at the node between them, and beyond it goes on as
// in the element's other half. Where that is not known it goes by the element's own weight.
double ancf_tension(const ancf_model* m, int element, double xi);

// Largest tension of elements from one to before another, over `parts` + 1 places each, from end to end, with where it
// is [N]. Of the first where there are several.
double ancf_tension_max(int* element, double* xi, const ancf_model* m, int begin, int end, int parts);

// Largest strain of all elements, over their ends and middles, and its element; what is not a number is left out [-].
double ancf_strain_max(const ancf_model* m, const double* x, int* element);

#endif
