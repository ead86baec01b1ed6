#include "ancf/solid.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static void subtract(double c[3], const double a[3], const double b[3]) {
    for (int k = 0; k < 3; k++) c[k] = a[k] - b[k];
}

// What is left of terms of this magnitude, where it is rounding and nothing else: 0, so that planar scenes stay planar.
static double clean(double rest, double magnitude) { return fabs(rest) <= 4.0 * DBL_EPSILON * magnitude ? 0.0 : rest; }

// Unit vector; `fallback` for one without length.
static double normalize(double n[3], const double v[3], const double fallback[3]) {
    const double length = sqrt(dot(v, v));
    for (int k = 0; k < 3; k++) n[k] = length > 0.0 ? v[k] / length : fallback[k];
    return length;
}

static const double some_unit[3] = {1.0, 0.0, 0.0};

static double ball_distance(double normal[3], const ancf_solid* s, const double point[3]) {
    double way[3];
    subtract(way, point, s->center);
    return normalize(normal, way, some_unit) - s->size[0];
}

static double box_distance(double normal[3], const ancf_solid* s, const double point[3]) {
    double way[3], side[3], over[3], square = 0.0;
    subtract(way, point, s->center);
    for (int i = 0; i < 3; i++) {
        const double q = dot(way, s->axis[i]);
        side[i] = q < 0.0 ? -1.0 : 1.0;
        over[i] = fabs(q) - s->size[i];
        if (over[i] > 0.0) square += over[i] * over[i];
    }
    const int up = over[0] > over[1] ? 0 : 1, face = over[2] > over[up] ? 2 : up;
    if (!(square > 0.0)) {
        for (int k = 0; k < 3; k++) normal[k] = side[face] * s->axis[face][k];
        return over[face];
    }
    const double distance = sqrt(square);
    for (int k = 0; k < 3; k++) normal[k] = 0.0;
    for (int i = 0; i < 3; i++) {
        if (!(over[i] > 0.0)) continue;
        const double share = side[i] * over[i] / distance;
        for (int k = 0; k < 3; k++) normal[k] += share * s->axis[i][k];
    }
    return distance;
}

// Normal of the face; false where the corners are on a line.
static bool face_normal(double n[3], const double u[3], const double v[3]) {
    double c[3];
    for (int k = 0; k < 3; k++) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        const double one = u[i] * v[j], two = u[j] * v[i];
        c[k] = clean(one - two, fabs(one) + fabs(two));
    }
    normalize(n, c, some_unit);
    return dot(c, c) > 1e-28 * dot(u, u) * dot(v, v);
}

// Way to the point, at `way` from an edge's start, from where the edge is nearest.
static void from_edge(double rest[3], const double way[3], const double edge[3]) {
    const double length = dot(edge, edge), along = dot(way, edge);
    const double t = along <= 0.0 ? 0.0 : along >= length ? 1.0 : along / length;
    for (int k = 0; k < 3; k++) rest[k] = clean(way[k] - t * edge[k], fabs(way[k]) + fabs(t * edge[k]));
}

static double triangle_distance(double normal[3], const ancf_solid* s, const double point[3]) {
    double ab[3], ac[3], bc[3], pa[3], pb[3], pc[3], face[3], best[3], rest[3];
    subtract(ab, s->corner[1], s->corner[0]);
    subtract(ac, s->corner[2], s->corner[0]);
    subtract(bc, s->corner[2], s->corner[1]);
    subtract(pa, point, s->corner[0]);
    subtract(pb, point, s->corner[1]);
    subtract(pc, point, s->corner[2]);
    const double a1 = dot(ab, pa), a2 = dot(ac, pa), b1 = dot(ab, pb), b2 = dot(ac, pb), c1 = dot(ab, pc),
                 c2 = dot(ac, pc);
    // Barycentric coordinates of the foot, times four areas squared.
    const bool over = a1 * b2 - b1 * a2 > 0.0 && c1 * a2 - a1 * c2 > 0.0 && b1 * c2 - c1 * b2 > 0.0;
    const bool flat = face_normal(face, ab, ac);
    if (over && flat) {
        const double height = dot(face, pa);
        for (int k = 0; k < 3; k++) normal[k] = height < 0.0 ? -face[k] : face[k];
        return fabs(height);
    }
    from_edge(best, pa, ab);
    from_edge(rest, pa, ac);
    if (dot(rest, rest) < dot(best, best)) subtract(best, rest, (double[3]) {0.0, 0.0, 0.0});
    from_edge(rest, pb, bc);
    if (dot(rest, rest) < dot(best, best)) subtract(best, rest, (double[3]) {0.0, 0.0, 0.0});
    return normalize(normal, best, face);
}

static double plane_distance(double normal[3], const ancf_solid* s, const double point[3]) {
    double way[3];
    subtract(way, point, s->center);
    const double height = dot(way, s->axis[0]);
    const double sign = s->sense < 0 || (s->sense == 0 && height < 0.0) ? -1.0 : 1.0;
    for (int k = 0; k < 3; k++) normal[k] = sign * s->axis[0][k];
    return sign * height;
}

static double wheel_distance(double normal[3], const ancf_solid* s, const double point[3]) {
    double way[3];
    subtract(way, point, s->center);
    ancf_groove_contact contact;
    ancf_groove_touch(&contact, s->groove, s->axis[0], way, 0.0);
    // On the axis there is no way out but along it.
    normalize(normal, contact.normal, s->axis[0]);
    return -contact.depth;
}

double ancf_solid_distance(double normal[3], const ancf_solid* solid, const double point[3]) {
    switch (solid->kind) {
    case ANCF_BALL:
        return ball_distance(normal, solid, point);
    case ANCF_BOX:
        return box_distance(normal, solid, point);
    case ANCF_TRIANGLE:
        return triangle_distance(normal, solid, point);
    case ANCF_PLANE:
        return plane_distance(normal, solid, point);
    case ANCF_WHEEL:
        return wheel_distance(normal, solid, point);
    }
    return INFINITY;
}

double ancf_solid_reach(const ancf_solid* solid) {
    double reach = 0.0, way[3];
    switch (solid->kind) {
    case ANCF_BALL:
        return solid->size[0];
    case ANCF_BOX:
        return sqrt(dot(solid->size, solid->size));
    case ANCF_TRIANGLE:
        for (int i = 0; i < 3; i++) {
            subtract(way, solid->corner[i], solid->center);
            reach = fmax(reach, sqrt(dot(way, way)));
        }
        return reach;
    case ANCF_PLANE:
        return INFINITY;
    case ANCF_WHEEL:
        return hypot(solid->groove->radius + solid->groove->height, ancf_groove_half_width(solid->groove));
    }
    return INFINITY;
}
