#include "internal.h"

ANCF_CLONES double ancf_product(const double* a, const double* b, int n) {
    double sum = 0.0;
#pragma omp simd reduction(+ : sum)
    for (int i = 0; i < n; ++i) sum += a[i] * b[i];
    return sum;
}
