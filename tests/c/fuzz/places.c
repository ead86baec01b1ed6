// Distances: grooves, and where curves are nearest to solids and to one another.
#include "ancf/lying.h"
#include "fuzz.h"

#include <float.h>

void fuzz_groove(fuzz* f) {
    ancf_groove groove;
    any_solid(f, &groove);
    const bool refused = ancf_groove_check(&groove);
    const double sizes[] = {groove.radius, groove.floor, groove.fillet, groove.slope, groove.height, groove.land};
    if (!all_finite(sizes, 6)) need(refused);
    for (int i = 0; i < 6; ++i)
        if (sizes[i] < 0.0) need(refused);
    if (refused) return;
    double axis[3], place[3];
    unit_vector(axis, f);
    vector_between(place, f, 2.0 * groove.radius);
    const double radius = magnitude(f, 1e-4, 1e-1);
    ancf_groove_contact touch;
    ancf_groove_touch(&touch, &groove, axis, place, radius);
    double gradient[2];
    const double u = magnitude(f, 1e-6, 1.0), q = between(f, -groove.radius, groove.radius);
    const double distance = ancf_groove_distance(gradient, &groove, u, q);
    if (f->chance > 0.0) return;
    need(isfinite(touch.depth) && is_unit(touch.normal) && isfinite(ancf_groove_curvature(&groove)));
    need(fabs(gradient[0] * gradient[0] + gradient[1] * gradient[1] - 1.0) < 1e-9);
    // A distance changes by no more than the way.
    const double du = random_between(&f->seed, 0.0, 1e-3), dq = random_between(&f->seed, -1e-3, 1e-3);
    need(fabs(ancf_groove_distance(gradient, &groove, u + du, q + dq) - distance) <=
         hypot(du, dq) * (1.0 + 1e-9) + 1e-12);
    // A ball's depth falls as it goes along the normal.
    for (int i = 0; i < 3; ++i) place[i] += 1e-4 * touch.normal[i];
    ancf_groove_contact after;
    ancf_groove_touch(&after, &groove, axis, place, radius);
    need(fabs(after.depth - touch.depth) <= 1e-4 * (1.0 + 1e-6));
}

static void any_cubic(ancf_cubic* c, fuzz* f) {
    double at[3], way[3];
    vector_between(at, f, 1.0);
    const double piece = magnitude(f, 1e-2, 1.0);
    for (int k = 0; k < 4; ++k) {
        unit_vector(way, f);
        for (int i = 0; i < 3; ++i) c->control[k][i] = at[i] += piece * way[i] + (i == 0 ? piece : 0.0);
    }
    if (by_chance(f, 0.1)) // straight
        for (int k = 0; k < 4; ++k)
            for (int i = 0; i < 3; ++i) c->control[k][i] = at[i] + k * piece * way[i];
    if (by_chance(f, 0.02)) // all in one point
        for (int k = 1; k < 4; ++k) memcpy(c->control[k], c->control[0], sizeof c->control[0]);
    if (by_chance(f, f->chance)) c->control[pick(f, 4)][pick(f, 3)] = hostile_value(f);
}

static double size_of(const ancf_cubic* c) {
    double size = 0.0;
    for (int k = 0; k < 4; ++k)
        for (int i = 0; i < 3; ++i) size = fmax(size, fabs(c->control[k][i]));
    return size;
}

static void on_solid(fuzz* f) {
    ancf_groove groove;
    ancf_solid solid;
    do solid = any_solid(f, &groove);
    while (solid.kind == ANCF_WHEEL && ancf_groove_check(&groove));
    ancf_cubic cable;
    any_cubic(&cable, f);
    const int segments = 1 + pick(f, by_chance(f, 0.1) ? 64 : 6);
    const double radius = magnitude(f, 1e-4, 1e-1), reach = magnitude(f, 1e-4, 1.0);
    ancf_nearest found[64];
    const int n = ancf_nearest_solid(found, &cable, segments, radius, &solid, reach);
    need(n >= 0 && n <= segments);
    for (int k = 0; k < n; ++k) {
        need(found[k].segment >= 0 && found[k].segment < segments);
        need(k == 0 || found[k].segment > found[k - 1].segment);
        need(!(found[k].gap >= reach));
    }
    const bool sane = f->chance == 0.0;
    for (int k = 0; k < n && sane; ++k) {
        const double low = (double)found[k].segment / segments, high = (double)(found[k].segment + 1) / segments;
        need(found[k].xi >= low - 1e-12 && found[k].xi <= high + 1e-12 && is_unit(found[k].normal));
        double r[3], normal[3];
        ancf_cubic_at(r, &cable, found[k].xi);
        need(fabs(ancf_solid_distance(normal, &solid, r) - radius - found[k].gap) <= 1e-9 * (1.0 + fabs(found[k].gap)));
    }
    // What is far out of reach of the nearest place is nowhere near, and what is within it was found: along the curve.
    for (int i = 0, k = 0; i < segments && sane; ++i) {
        double least = INFINITY, normal[3], r[3];
        for (int j = 0; j <= 16; ++j) {
            ancf_cubic_at(r, &cable, (i + j / 16.0) / segments);
            least = fmin(least, ancf_solid_distance(normal, &solid, r) - radius);
        }
        const bool given = k < n && found[k].segment == i;
        if (least < reach) need(given);
        if (given) need(found[k].gap <= least + 1e-9);
        k += given;
    }
    for (int k = 0; k < n; ++k) ancf_lying_on(&found[k], &cable, segments, radius, &solid, magnitude(f, 1e-6, 1e-3));
    for (int k = 0; k < n && sane; ++k) need(isfinite(found[k].gap) && is_unit(found[k].normal));
}

static void on_cubic(fuzz* f) {
    ancf_cubic first, second;
    any_cubic(&first, f);
    any_cubic(&second, f);
    const int segments = 1 + pick(f, by_chance(f, 0.05) ? 64 : 6);
    const double radius[2] = {magnitude(f, 1e-4, 1e-1), magnitude(f, 1e-4, 1e-1)}, reach = magnitude(f, 1e-4, 1.0);
    ancf_nearest_pair found[64];
    const int n = ancf_nearest_cubic(found, &first, segments, radius[0], &second, radius[1], reach);
    need(n >= 0 && n <= segments);
    const bool sane = f->chance == 0.0;
    for (int i = 0, k = 0; i < segments && sane; ++i) {
        double least = INFINITY, p[3], q[3];
        for (int j = 0; j <= 8; ++j)
            for (int l = 0; l <= 32; ++l) {
                ancf_cubic_at(p, &first, (i + j / 8.0) / segments);
                ancf_cubic_at(q, &second, l / 32.0);
                const double d[3] = {p[0] - q[0], p[1] - q[1], p[2] - q[2]};
                least = fmin(least, sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) - radius[0] - radius[1]);
            }
        const bool given = k < n && found[k].segment == i;
        if (least < reach) need(given);
        if (given) need(found[k].gap <= least + 1e-9 && is_unit(found[k].normal));
        k += given;
    }
    for (int k = 0; k < n; ++k) {
        need(found[k].segment >= 0 && found[k].segment < segments && !(found[k].gap >= reach));
        const double within[2] = {(double)found[k].segment / segments, (double)(found[k].segment + 1) / segments};
        double xi[2] = {found[k].xi[0], found[k].xi[1]};
        ancf_nearest_settle(xi, &first, within, &second);
        if (sane)
            for (int s = 0; s < 2; ++s) need(xi[s] >= -1e-12 && xi[s] <= 1.0 + 1e-12);
    }
}

// No point of a curve is nearer to a point than the least that is said.
static void to_point(fuzz* f) {
    ancf_cubic cable;
    any_cubic(&cable, f);
    double point[3], r[3];
    vector_between(point, f, 2.0);
    const double within[2] = {0.0, by_chance(f, 0.2) ? 0.0 : 1.0}, least = ancf_nearest_least(&cable, point);
    const double xi = ancf_nearest_from(&cable, within, point);
    if (f->chance > 0.0) return;
    need(xi >= within[0] && xi <= within[1]);
    double best = INFINITY;
    for (int j = 0; j <= 64; ++j) {
        double square = 0.0;
        ancf_cubic_at(r, &cable, j / 64.0);
        for (int i = 0; i < 3; ++i) square += (r[i] - point[i]) * (r[i] - point[i]);
        best = fmin(best, sqrt(square));
    }
    need(least <= best + 16.0 * DBL_EPSILON * size_of(&cable));
}

void fuzz_places(fuzz* f) {
    on_solid(f);
    on_cubic(f);
    to_point(f);
}
