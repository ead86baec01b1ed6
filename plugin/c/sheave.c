#include "ancf/sheave.h"

#include <math.h>
#include <stdbool.h>

static const double half_pi = 1.57079632679489661923;

// Where the wall begins, and its lip.
typedef struct {
    double foot[2], lip[2], sine, cosine;
} wall;

static wall wall_of(const ancf_groove* g) {
    wall w;
    w.sine = sin(g->slope);
    w.cosine = g->slope < half_pi ? cos(g->slope) : 0.0;
    w.foot[0] = g->floor + g->fillet * w.sine;
    w.foot[1] = g->fillet * (1.0 - w.cosine);
    const double rise = fmax(0.0, g->height - w.foot[1]);
    w.lip[0] = w.foot[0] + rise * w.cosine / w.sine;
    w.lip[1] = w.foot[1] + rise;
    return w;
}

static bool not_negative(double x) { return isfinite(x) && x >= 0.0; }

ancf_error ancf_groove_check(const ancf_groove* g) {
    const bool sizes = isfinite(g->radius) && g->radius > 0.0 && not_negative(g->floor) && not_negative(g->fillet) &&
                       not_negative(g->height) && not_negative(g->land);
    if (!sizes || !(g->slope > 0.0 && g->slope <= half_pi)) return ANCF_E_GROOVE;
    if (g->height == 0.0) return g->floor > 0.0 && g->fillet == 0.0 ? ANCF_OK : ANCF_E_GROOVE;
    const wall w = wall_of(g);
    return g->fillet > 0.0 && g->height >= w.foot[1] * (1.0 - 1e-12) ? ANCF_OK : ANCF_E_GROOVE;
}

double ancf_groove_opening(const ancf_groove* g) { return g->height > 0.0 ? wall_of(g).lip[0] : g->floor; }

double ancf_groove_half_width(const ancf_groove* g) { return ancf_groove_opening(g) + g->land; }

double ancf_groove_curvature(const ancf_groove* g) {
    return 0.5 * (1.0 / g->radius - (g->floor == 0.0 ? 1.0 / g->fillet : 0.0));
}

// The nearest point so far: square of its distance, and the way from it.
typedef struct {
    double square, way[2];
} nearest;

static void consider(nearest* best, double du, double dq) {
    const double square = du * du + dq * dq;
    if (square >= best->square) return;
    best->square = square;
    best->way[0] = du;
    best->way[1] = dq;
}

static void consider_segment(nearest* best, const double a[2], const double b[2], double u, double q) {
    const double du = b[0] - a[0], dq = b[1] - a[1], length = du * du + dq * dq;
    double t = length > 0.0 ? ((u - a[0]) * du + (q - a[1]) * dq) / length : 0.0;
    t = t < 0.0 ? 0.0 : t > 1.0 ? 1.0 : t;
    consider(best, u - a[0] - t * du, q - a[1] - t * dq);
}

// Height of the surface over u.
static double surface(const ancf_groove* g, const wall* w, double u) {
    if (u <= g->floor) return 0.0;
    if (u <= w->foot[0]) {
        const double s = u - g->floor, r = g->fillet;
        return r - sqrt(fmax(0.0, (r - s) * (r + s)));
    }
    return u < w->lip[0] ? w->foot[1] + (u - w->foot[0]) * w->sine / w->cosine : w->lip[1];
}

double ancf_groove_distance(double gradient[2], const ancf_groove* g, double u, double q) {
    const bool plain = g->height == 0.0;
    const wall w = plain ? (wall) {.foot = {g->floor, 0.0}, .lip = {g->floor, 0.0}, .sine = 1.0} : wall_of(g);
    // Over the floor the way up is exact, so that what is planar stays so to the last bit.
    if (u <= g->floor && (plain ? q >= 0.0 : q <= g->fillet && q > -0.5 * g->floor)) {
        gradient[0] = 0.0;
        gradient[1] = 1.0;
        return q;
    }
    nearest best = {INFINITY, {0.0, 1.0}};
    const double middle[2] = {0.0, 0.0}, floor[2] = {g->floor, 0.0}, rim[2] = {w.lip[0] + g->land, w.lip[1]},
                 axis[2] = {rim[0], -g->radius};
    consider_segment(&best, middle, floor, u, q);
    const double du = u - g->floor, dq = q - g->fillet, away = sqrt(du * du + dq * dq);
    const double turned = atan2(du, -dq); // angle from the bottom of the fillet
    if (!plain && away > 0.0 && turned >= 0.0 && turned <= g->slope)
        consider(&best, du * (1.0 - g->fillet / away), dq * (1.0 - g->fillet / away));
    if (!plain) consider_segment(&best, w.foot, w.lip, u, q);
    consider_segment(&best, w.lip, rim, u, q);
    consider_segment(&best, rim, axis, u, q);
    const bool inside = u < rim[0] && q < surface(g, &w, u);
    const double distance = sqrt(best.square), sign = inside ? -1.0 : 1.0;
    gradient[0] = distance > 0.0 ? sign * best.way[0] / distance : 0.0;
    gradient[1] = distance > 0.0 ? sign * best.way[1] / distance : 1.0;
    return sign * distance;
}

void ancf_groove_touch(ancf_groove_contact* contact, const ancf_groove* g, const double axis[3], const double place[3],
                       double radius) {
    const double z = place[0] * axis[0] + place[1] * axis[1] + place[2] * axis[2];
    double out[3], gradient[2];
    for (int i = 0; i < 3; i++) out[i] = place[i] - z * axis[i];
    const double rho = sqrt(out[0] * out[0] + out[1] * out[1] + out[2] * out[2]);
    contact->depth = radius - ancf_groove_distance(gradient, g, fabs(z), rho - g->radius);
    const double along = z < 0.0 ? -gradient[0] : gradient[0];
    for (int i = 0; i < 3; i++) contact->normal[i] = (rho > 0.0 ? gradient[1] * out[i] / rho : 0.0) + along * axis[i];
}
