// Cubic shape functions of a cable element (Shan, Guo, Gill 2019, Eq. 2-4).
//
// r(xi) = S1 r0 + S2 g0 + S3 r1 + S4 g1, with xi = s/L in [0, 1], end positions r0, r1 [m] and end slopes
// g = dr/ds [-]. Written on (g0, d, g1) with d = (r1 - r0)/L, the slope along the element is
// r' = a g0 + b d + c g1 with a + b + c = 1, which is what the elastic forces are built on.
#ifndef ANCF_SHAPE_H
#define ANCF_SHAPE_H

static inline void ancf_powers(double power[3], double xi) {
    power[0] = xi;
    power[1] = xi * xi;
    power[2] = xi * xi * xi;
}

// Means of S over several xi, from the means of xi, xi^2 and xi^3.
static inline void ancf_shape_mean(double S[4], const double power[3], double length) {
    S[0] = 1.0 - 3.0 * power[1] + 2.0 * power[2];
    S[1] = length * (power[0] - 2.0 * power[1] + power[2]);
    S[2] = 3.0 * power[1] - 2.0 * power[2];
    S[3] = length * (power[2] - power[1]);
}

// S[4]: weights of (r0, g0, r1, g1) in the position at xi; Eq. 3-4. length [m].
static inline void ancf_shape(double S[4], double xi, double length) {
    double power[3];
    ancf_powers(power, xi);
    ancf_shape_mean(S, power, length);
}

// abc[3]: weights of (g0, d, g1) in the slope dr/ds at xi.
static inline void ancf_shape_slope(double abc[3], double xi) {
    abc[0] = 1.0 - 4.0 * xi + 3.0 * xi * xi;
    abc[1] = 6.0 * xi - 6.0 * xi * xi;
    abc[2] = 3.0 * xi * xi - 2.0 * xi;
}

// abc[3]: weights of (g0, d, g1) in L d2r/ds2 at xi.
static inline void ancf_shape_curvature(double abc[3], double xi) {
    abc[0] = 6.0 * xi - 4.0;
    abc[1] = 6.0 - 12.0 * xi;
    abc[2] = 6.0 * xi - 2.0;
}

#endif
