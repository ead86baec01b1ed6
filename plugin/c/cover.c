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

// Over a quarter of a segment from its end, the share rises from that of all who meet there to the whole.
double ancf_cover_share(const ancf_cover* cover, int segment, double xi) {
    const double at = xi * cover->segments - segment, from[2] = {at, 1.0 - at};
    const int last = cover->segments - 1;
    const double meeting[2] = {segment == 0 ? cover->meeting[0] : 2, segment == last ? cover->meeting[1] : 2};
    double share = 1.0;
    for (int k = 0; k < 2; ++k) {
        const double alone = fmin(fmax(4.0 * from[k], 0.0), 1.0);
        share *= alone + (1.0 - alone) / meeting[k];
    }
    return share;
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
