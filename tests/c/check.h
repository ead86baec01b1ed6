// What all C tests share: cmocka, comparison of numbers, reproducible random numbers.
#ifndef ANCF_TEST_CHECK_H
#define ANCF_TEST_CHECK_H

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

static inline void check_near(double value, double expected, double tolerance, const char* what, const char* file,
                              int line) {
    if (fabs(value - expected) <= tolerance) return; // a NaN falls through
    fprintf(stderr, "%s:%d: %s = %.17g, expected %.17g, off by %.3g, allowed %.3g\n", file, line, what, value, expected,
            value - expected, tolerance);
    _fail(file, line);
}

// Absolute and relative comparison; a NaN fails.
#define assert_near(value, expected, tolerance) check_near(value, expected, tolerance, #value, __FILE__, __LINE__)
#define assert_close(value, expected, relative)                                                                        \
    check_near(value, expected, fabs(expected) * (relative), #value, __FILE__, __LINE__)

// Uniform in [0, 1), the same numbers on every machine (splitmix64).
static inline double random_unit(uint64_t* seed) {
    uint64_t z = (*seed += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

static inline double random_between(uint64_t* seed, double low, double high) {
    return low + (high - low) * random_unit(seed);
}

// Every magnitude between low and high is as likely.
static inline double random_magnitude(uint64_t* seed, double low, double high) {
    return low * pow(high / low, random_unit(seed));
}

#endif
