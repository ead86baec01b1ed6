#include "rubbing.h"

#include "newton.h"

#include <math.h>

// Coefficient of friction over the speed, also at rest; *slope is its slope.
static double rate_at(const ancf_rubbing* c, double speed, double* slope) {
    double coefficient = ancf_friction_rising(c->law, speed, slope);
    if (coefficient > c->most) {
        coefficient = c->most;
        *slope = 0.0;
    }
    return speed > 0.0 ? coefficient / speed : *slope;
}

// Friction at a slip.
static void friction_at(double* F, const void* contacts, int i, const double* v) {
    const ancf_rubbing* c = (const ancf_rubbing*)contacts + i;
    double slope;
    const double rate = rate_at(c, sqrt(v[0] * v[0] + v[1] * v[1]), &slope);
    for (int a = 0; a < 2; ++a) F[a] = -c->pressed * rate * v[a];
}

// Root of minus its derivative.
static void root_at(double R[3], const void* contacts, int i, const double* v) {
    const ancf_rubbing* c = (const ancf_rubbing*)contacts + i;
    double slope;
    const double speed = sqrt(v[0] * v[0] + v[1] * v[1]), rate = rate_at(c, speed, &slope);
    const double across = sqrt(c->pressed * rate), along = sqrt(c->pressed * fmax(slope, 0.0)) - across,
                 x = speed > 0.0 ? v[0] / speed : 1.0, y = speed > 0.0 ? v[1] / speed : 0.0;
    R[0] = across + along * x * x;
    R[1] = along * x * y;
    R[2] = across + along * y * y;
}

int ancf_rubbing_solve(double* P, double* v, double* left, int n, const ancf_rubbing* contact, const double* W,
                       double enough, double* scratch) {
    const ancf_newton_laws laws = {n, 2, friction_at, root_at, contact};
    return ancf_newton(P, v, left, &laws, W, enough, scratch);
}
