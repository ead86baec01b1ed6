#include "ancf/cover.h"

#include <math.h>

void ancf_cover_cubic(ancf_cubic* cubic, const ancf_model* m, const double* x, int element) {
    const double third = m->element[element].length / 3.0;
    const bool spring = m->element[element].kind & ANCF_SPRING;
    int dof[4];
    ancf_model_dofs(dof, m, element);
    for (int c = 0; c < 3; ++c) {
        const double* u = x + c * m->stride;
        const double start = u[dof[0]], end = u[dof[2]];
        cubic->control[0][c] = start;
        cubic->control[1][c] = spring ? start + (end - start) / 3.0 : start + third * u[dof[1]];
        cubic->control[2][c] = spring ? end + (start - end) / 3.0 : end - third * u[dof[3]];
        cubic->control[3][c] = end;
    }
}

void ancf_cover_ahead(ancf_cubic* cubic, const ancf_model* m, int element, double time) {
    ancf_cubic rate;
    ancf_cover_cubic(cubic, m, m->x, element);
    ancf_cover_cubic(&rate, m, m->v, element);
    for (int k = 0; k < 4; ++k)
        for (int c = 0; c < 3; ++c) cubic->control[k][c] += time * rate.control[k][c];
}

static int touch_points(ancf_nearest* found, const ancf_cover* cover, const ancf_cubic* cubic, const ancf_solid* solid,
                        double reach) {
    int n = 0;
    for (int i = 0; i <= cover->segments; ++i) {
        if ((i == 0 && !cover->owns[0]) || (i == cover->segments && !cover->owns[1])) continue;
        ancf_nearest* place = &found[n];
        place->segment = i;
        place->xi = (double)i / cover->segments;
        ancf_cubic_at(place->point, cubic, place->xi);
        place->gap = ancf_solid_distance(place->normal, solid, place->point) - cover->radius;
        n += place->gap < reach;
    }
    return n;
}

int ancf_cover_touch(ancf_nearest* found, const ancf_cover* cover, const ancf_cubic* cubic, const ancf_solid* solid,
                     double reach) {
    return cover->points ? touch_points(found, cover, cubic, solid, reach)
                         : ancf_nearest_solid(found, cubic, cover->segments, cover->radius, solid, reach);
}
