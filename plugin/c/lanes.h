// Sums of products in registers: what `omp simd reduction` adds up, the compiler keeps in memory from turn to turn.
#ifndef ANCF_LANES_H
#define ANCF_LANES_H

#include "internal.h"

typedef double ancf_lanes __attribute__((vector_size(4 * sizeof(double)), aligned(sizeof(double))));
enum { ANCF_LANES = 4 }; // a divisor of a field's stride and of ANCF_TILE

ANCF_INLINE ancf_lanes ancf_lanes_at(const double* a) { return *(const ancf_lanes*)a; }

ANCF_INLINE double ancf_lanes_sum(const ancf_lanes* a) {
    const ancf_lanes s = *a;
    return (s[0] + s[2]) + (s[1] + s[3]);
}

#endif
