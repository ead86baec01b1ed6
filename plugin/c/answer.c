#include "answer.h"

#include "table.h"

#include <math.h>

// Part of a way on which there is overlap.
static double overlapping(double gap, double way) {
    const double end = gap + way;
    if (gap <= 0.0) return end <= 0.0 ? 1.0 : -gap / way;
    return end >= 0.0 ? 0.0 : end / way;
}

// Minus the quotient of elastic energy and way (a discrete gradient), so that the length of the sub-steps neither gives
// nor takes energy; *rise is its derivative by the way.
static double elastic_over(const ancf_contact* c, double way, double* rise) {
    const ancf_normal* law = &c->law;
    const double depth = -(c->gap + way);
    const ancf_normal spring = {law->kind, law->stiffness, law->exponent, 0.0};
    if (!(fabs(way) > 1e-7 * fabs(c->gap))) {
        *rise = -0.5 * ancf_normal_tangent(law, depth + 0.5 * way);
        return ancf_normal_force(&spring, depth + 0.5 * way, 0.0);
    }
    const double end = ancf_normal_force(&spring, depth, 0.0), n = ancf_normal_exponent(law);
    const double elastic = (c->energy - (depth > 0.0 ? end * depth / (n + 1.0) : 0.0)) / way;
    *rise = (end - elastic) / way;
    return elastic;
}

// Rate of damping [N s/m]; *bends: its derivative by the elastic force.
static double damping_over(const ancf_contact* c, double way, double elastic, double* bends) {
    *bends = 0.0;
    if (c->law.kind == ANCF_NORMAL_LINEAR) return c->law.damping * overlapping(c->gap, way);
    if (c->law.kind == ANCF_NORMAL_NONLINEAR) return elastic * (*bends = 1.5 * c->law.damping); // Eq. 10
    return 0.0;
}

ancf_pressing ancf_answer_alone(const ancf_contact* c, double u, double h, double force) {
    const double own = 0.5 * h * c->own, way = h * (u + own * force);
    ancf_pressing f = {0.0, 0.0, {0.0, 0.0}};
    double rise, bends;
    f.elastic = elastic_over(c, way, &rise);
    if (!(f.elastic > 0.0)) {
        f.elastic = 0.0;
        return f;
    }
    const double rate = damping_over(c, way, f.elastic, &bends);
    // At the mean velocity u + own total.
    const double whole = 1.0 + rate * own;
    f.total = (f.elastic - rate * u) / whole;
    f.total = ancf_larger(f.total, 0.0);
    f.slope[0] = rise * h * own;
    if (f.total > 0.0) f.slope[1] = (1.0 - bends * (u + own * f.total)) / whole * f.slope[0];
    return f;
}

double ancf_answer_at(const ancf_contact* c, double v, double h, double* elastic, double* slope) {
    const double way = h * v;
    double rise, bends;
    *elastic = *slope = 0.0;
    if (c->gap >= 0.0 && c->gap + way >= 0.0) return 0.0;
    *elastic = ancf_larger(elastic_over(c, way, &rise), 0.0);
    if (!(*elastic > 0.0)) return 0.0;
    const double rate = damping_over(c, way, *elastic, &bends), total = *elastic - rate * v;
    if (!(total > 0.0)) return 0.0;
    *slope = h * rise * (1.0 - bends * v) - rate;
    return total;
}
