#include "ancf/cover.h"
#include "internal.h"

#include <math.h>

// Control points of a field along one axis.
ANCF_INLINE void control(double p[4], const double* field, const int dof[4], double third, bool spring) {
    const double start = field[dof[0]], end = field[dof[2]];
    p[0] = start;
    p[1] = spring ? start + (end - start) / 3.0 : start + third * field[dof[1]];
    p[2] = spring ? end + (start - end) / 3.0 : end - third * field[dof[3]];
    p[3] = end;
}

void ancf_cover_cubic(ancf_cubic* cubic, const ancf_model* m, const double* x, int element) {
    const double third = m->element[element].length / 3.0;
    const bool spring = m->element[element].kind & ANCF_SPRING;
    int dof[4];
    ancf_model_dofs(dof, m, element);
    for (int c = 0; c < 3; ++c) {
        double p[4];
        control(p, x + c * m->stride, dof, third, spring);
        for (int k = 0; k < 4; ++k) cubic->control[k][c] = p[k];
    }
}

void ancf_cover_ahead(ancf_cubic* cubic, const ancf_model* m, int element, double time) {
    const double third = m->element[element].length / 3.0;
    const bool spring = m->element[element].kind & ANCF_SPRING;
    int dof[4];
    ancf_model_dofs(dof, m, element);
    for (int c = 0; c < 3; ++c) {
        double p[4], rate[4];
        control(p, m->x + c * m->stride, dof, third, spring);
        control(rate, m->v + c * m->stride, dof, third, spring);
        for (int k = 0; k < 4; ++k) cubic->control[k][c] = p[k] + time * rate[k];
    }
}

static int touch_points(ancf_nearest* found, const ancf_cover* cover, const ancf_cubic* cubic, const ancf_solid* solid,
                        double reach) {
    int n = 0;
    for (int i = 0; i <= cover->segments; ++i) {
        if ((i == 0 && !cover->owns[0]) || (i == cover->segments && !cover->owns[1])) continue;
        ancf_nearest* place = &found[n];
        ancf_nearest_place(place, i, (double)i / cover->segments, cubic, cover->radius, solid);
        n += place->gap < reach;
    }
    return n;
}

int ancf_cover_touch(ancf_nearest* found, const ancf_cover* cover, const ancf_cubic* cubic, const ancf_solid* solid,
                     double reach) {
    return cover->points ? touch_points(found, cover, cubic, solid, reach)
                         : ancf_nearest_solid(found, cubic, cover->segments, cover->radius, solid, reach);
}
