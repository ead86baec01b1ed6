#include "ancf/nearest.h"
#include "ancf/shape.h"
#include "internal.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>

enum {
    PIECES_MAX = 16,   // of the second cable
    LEAST_PARTS = 2,   // for which a least distance is made of those of chords
    SPLITS_MAX = 2,    // of half a segment, in search of another minimum
    SPLITS_MOST = 8,   // where there may be several
    SPLITS_BESIDE = 6, // beside a minimum that was found
    NEWTON_MAX = 16,
    ROOT_MAX = 100,
};

static const double fineness = 1e-3; // part of the radius by which a deeper place may be overlooked

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static void subtract(double c[3], const double a[3], const double b[3]) {
    for (int k = 0; k < 3; k++) c[k] = a[k] - b[k];
}

static double lower(double a, double b) { return a < b ? a : b; }

static double higher(double a, double b) { return a > b ? a : b; }

static double clamp(double x, double low, double high) { return x < low ? low : x > high ? high : x; }

void ancf_cubic_at(double r[3], const ancf_cubic* c, double xi) {
    const double s = 1.0 - xi, b0 = s * s * s, b1 = 3.0 * s * s * xi, b2 = 3.0 * s * xi * xi, b3 = xi * xi * xi;
    for (int k = 0; k < 3; k++)
        r[k] = b0 * c->control[0][k] + b1 * c->control[1][k] + b2 * c->control[2][k] + b3 * c->control[3][k];
}

void ancf_cubic_slope(double dr[3], const ancf_cubic* c, double xi) {
    const double s = 1.0 - xi, b0 = 3.0 * s * s, b1 = 6.0 * s * xi, b2 = 3.0 * xi * xi;
    const double(*p)[3] = c->control;
    for (int k = 0; k < 3; k++) dr[k] = b0 * (p[1][k] - p[0][k]) + b1 * (p[2][k] - p[1][k]) + b2 * (p[3][k] - p[2][k]);
}

// r(t) = a0 + a1 t + a2 t^2 + a3 t^3, from some origin.
typedef struct {
    double a[4][3];
} power;

static power expand(const ancf_cubic* c, const double origin[3]) {
    power p;
    for (int k = 0; k < 3; k++) {
        const double d0 = c->control[1][k] - c->control[0][k], d1 = c->control[2][k] - c->control[1][k],
                     d2 = c->control[3][k] - c->control[2][k];
        p.a[0][k] = c->control[0][k] - origin[k];
        p.a[1][k] = 3.0 * d0;
        p.a[2][k] = 3.0 * (d1 - d0);
        p.a[3][k] = d2 - 2.0 * d1 + d0;
    }
    return p;
}

ANCF_INLINE void at(double r[3], const power* p, double t) {
    for (int k = 0; k < 3; k++) r[k] = p->a[0][k] + t * (p->a[1][k] + t * (p->a[2][k] + t * p->a[3][k]));
}

// r, r' and r''.
ANCF_INLINE void jet(double r[3], double d[3], double dd[3], const power* p, double t) {
    at(r, p, t);
    for (int k = 0; k < 3; k++) {
        d[k] = p->a[1][k] + t * (2.0 * p->a[2][k] + t * 3.0 * p->a[3][k]);
        dd[k] = 2.0 * p->a[2][k] + t * 6.0 * p->a[3][k];
    }
}

// No |r''| of the cubic is larger.
static double bend_of(const power* p) {
    double end[3];
    for (int k = 0; k < 3; k++) end[k] = 2.0 * p->a[2][k] + 6.0 * p->a[3][k];
    return sqrt(higher(4.0 * dot(p->a[2], p->a[2]), dot(end, end)));
}

// No |r'| of the cubic is larger.
static double speed_of(const ancf_cubic* c) {
    double square = 0.0, edge[3];
    for (int i = 0; i < 3; i++) {
        subtract(edge, c->control[i + 1], c->control[i]);
        square = higher(square, dot(edge, edge));
    }
    return 3.0 * sqrt(square);
}

static double joint(int i, int segments) { return (double)i / segments; }

// Part of a cubic in [low, high], of `step`, between two points.
typedef struct {
    double low, high, step;
    double start[3], end[3], chord[3]; // of the origin of its power
    double length, inverse;            // of the chord [m], of its square
    double bend;                       // at least |r''| step^2 [m]; the part is within an eighth of it of its chord
} piece;

typedef enum { TO_POINT, TO_BOX, TO_SOLID, TO_CUBIC } target;

// The second cable, divided.
typedef struct {
    power cubic;
    int n;
    piece part[PIECES_MAX];
} strand;

// Gap of a curve from something, along its parameter.
typedef struct {
    target to;
    power cubic;
    const ancf_solid* solid;
    const strand* other;
    bool convex;   // the distance from it is a convex function of the point
    double fine;   // by which another minimum of a convex solid has to be deeper to count [m]; 0: only one is sought
    double detail; // size of what else makes minima [m]
    double speed;  // at least |r'| [m]
    double bend;   // at least |r''| [m]
    double margin; // rounding of a distance [m]
} field;

typedef struct {
    double t, value, slope; // slope: d value / dt
    double other;           // parameter of the other curve
    int part;               // of a box: face, edge or corner that is nearest; else 0
} spot;

static spot nearest_of(const strand* s, const double point[3]);

// ancf_solid_distance in the box's own axes.
static void box_probe(spot* s, const double size[3], const double r[3], const double d[3]) {
    double out[3], along[3], square = 0.0, rate = 0.0;
    s->part = 0;
    for (int k = 0; k < 3; k++) {
        out[k] = fabs(r[k]) - size[k];
        along[k] = r[k] < 0.0 ? -d[k] : d[k];
        const double over = higher(out[k], 0.0);
        s->part = 3 * s->part + (over > 0.0 ? (r[k] < 0.0 ? 1 : 2) : 0);
        square += over * over;
        rate += over * along[k];
    }
    if (square > 0.0) {
        s->value = sqrt(square);
        s->slope = rate / s->value;
        return;
    }
    const int up = out[0] > out[1] ? 0 : 1, face = out[2] > out[up] ? 2 : up;
    s->value = out[face];
    s->slope = along[face];
    s->part = 27 + 2 * face + (r[face] < 0.0);
}

static spot probe(const field* f, double t) {
    spot s = {.t = t};
    double r[3], d[3], dd[3], normal[3];
    jet(r, d, dd, &f->cubic, t);
    if (f->to == TO_BOX) {
        box_probe(&s, f->solid->size, r, d);
        return s;
    }
    if (f->to == TO_SOLID) {
        s.value = ancf_solid_distance(normal, f->solid, r);
        s.slope = dot(normal, d);
        return s;
    }
    if (f->to == TO_CUBIC) {
        double there[3];
        s.other = nearest_of(f->other, r).t;
        at(there, &f->other->cubic, s.other);
        subtract(r, r, there);
    }
    s.value = sqrt(dot(r, r));
    s.slope = s.value > 0.0 ? dot(r, d) / s.value : 0.0;
    return s;
}

// The spot of sign change of the slope in [a, b], from - to +: regula falsi (Illinois), made safe by bisection.
static spot valley(const field* f, spot a, spot b) {
    const double first = b.t - a.t;
    // Off points and edges the square of the distance is smooth, the distance is not. Inside there is no square.
    const double least = f->to == TO_BOX || f->to == TO_SOLID ? 0.02 * f->speed * first : 0.0;
    double ya = a.slope * higher(a.value, least), yb = b.slope * higher(b.value, least), width = first;
    const bool left = a.value <= b.value;
    spot best = left ? a : b, s = best;
    double y = left ? ya : yb;
    for (int i = 0, side = 0; i < ROOT_MAX; i++) {
        double t = a.t + (b.t - a.t) * (ya / (ya - yb));
        if (i % 3 == 2) {
            if (b.t - a.t > 0.5 * width) t = a.t + 0.5 * (b.t - a.t);
            width = b.t - a.t;
        }
        if (!(t > a.t && t < b.t)) t = a.t + 0.5 * (b.t - a.t);
        if (!(t > a.t && t < b.t)) break;
        const double y_last = y, moved = fabs(t - s.t);
        s = probe(f, t);
        // The last one is nearest to the root, unless there is a kink.
        if (s.value <= best.value + f->margin) best = s;
        y = s.slope * higher(s.value, least);
        if (y == 0.0 || moved <= 1e-11 * first) break;
        const double step = fabs(y * moved / (y_last - y));
        // One more secant is as good as exact.
        if (step <= 0.1 * moved && step * moved <= 1e-10 * first * first) {
            if (best.t != s.t) break;
            best.t = clamp(y < 0.0 ? t + step : t - step, a.t, b.t);
            if (f->to == TO_CUBIC) best = probe(f, best.t); // with its partner
            break;
        }
        if (y < 0.0) {
            a = s;
            ya = y;
            if (side < 0) yb *= 0.5;
            side = -1;
        } else {
            b = s;
            yb = y;
            if (side > 0) ya *= 0.5;
            side = 1;
        }
    }
    return best;
}

// Smallest value a field can have between two spots.
static double floor_of(const field* f, const spot* a, const spot* b) {
    const double x = b->t - a->t, lipschitz = 0.5 * (a->value + b->value - f->speed * x);
    if (!f->convex) return lipschitz;
    // Above a + a' u - r''/2 u^2, and the same from b: the larger one is least where they meet, or at an end.
    const double ends = lower(a->value, b->value), rise = b->slope - a->slope + f->bend * x,
                 u = a->value - b->value + b->slope * x + 0.5 * f->bend * x * x;
    if (!(u > 0.0 && u < rise * x)) return ends;
    const double meet = u / rise;
    return higher(lipschitz, lower(ends, a->value + meet * (a->slope - 0.5 * f->bend * meet)));
}

// Whether a field may have several minima within x.
ANCF_INLINE bool several(const field* f, double x) { return f->bend * x > 0.4 * f->speed || f->speed * x > f->detail; }

// little: by which a minimum has to be deeper than the best one so far, to count [m]; 0: beside those that are found
// deeper ones are looked for.
static void explore(spot* best, const field* f, const spot* a, const spot* b, double limit, int splits, double little) {
    const double x = b->t - a->t;
    if (!(floor_of(f, a, b) < lower(limit, best->value - higher(little, 1e-9 * f->speed * x)))) return;
    const bool turns = a->slope * x < -f->margin && b->slope * x > f->margin;
    // A groove has two walls.
    const bool bent = several(f, x) || (f->to == TO_SOLID && !f->convex && splits > 1);
    if (turns && (!bent || splits == 0)) {
        spot s = valley(f, *a, *b);
        if (s.value <= best->value + f->margin) *best = s;
        // A cable that arches over a face lies on two edges, and there are corners.
        const bool same = f->to == TO_BOX && a->part == b->part && s.part == a->part;
        const int more = little == 0.0 ? SPLITS_BESIDE : splits - 1;
        if (!(f->fine > 0.0) || same || more < 0) return;
        s.slope = 0.0;
        explore(best, f, a, &s, limit, more, f->fine);
        explore(best, f, &s, b, limit, more, f->fine);
        return;
    }
    if (splits == 0) {
        if (little == 0.0 && f->fine > 0.0) explore(best, f, a, b, limit, SPLITS_BESIDE, f->fine);
        return;
    }
    const spot middle = probe(f, a->t + 0.5 * x);
    if (middle.value < best->value - f->margin) {
        *best = middle;
        little = lower(little, DBL_MIN); // it is this valley
    }
    explore(best, f, a, &middle, limit, splits - 1, little);
    explore(best, f, &middle, b, limit, splits - 1, little);
}

// Until no part has several minima. Seldom needed, and so by itself.
__attribute__((noinline, cold)) static void explore_deeper(spot* best, const field* f, const spot* a, const spot* b,
                                                           double limit, int splits) {
    for (double x = ldexp(b->t - a->t, -splits); splits < SPLITS_MOST && several(f, x); x *= 0.5) ++splits;
    explore(best, f, a, b, limit, splits, 0.0);
}

// Smallest value between two spots. What ties to rounding is held in the middle.
static spot search(const field* f, const spot* a, const spot* b, double limit, int splits) {
    const double x = 0.5 * (b->t - a->t);
    const spot middle = probe(f, a->t + x);
    spot best = middle;
    if (a->value < best.value - f->margin) best = *a;
    if (b->value < best.value - f->margin) best = *b;
    if (several(f, x / (1 << splits))) {
        explore_deeper(&best, f, a, &middle, limit, splits);
        explore_deeper(&best, f, &middle, b, limit, splits);
        return best;
    }
    explore(&best, f, a, &middle, limit, splits, 0.0);
    explore(&best, f, &middle, b, limit, splits, 0.0);
    return best;
}

static piece part_of(const power* p, double low, double high, const double start[3], double bend) {
    piece s = {.low = low, .high = high, .step = high - low};
    at(s.end, p, high);
    for (int k = 0; k < 3; k++) {
        s.start[k] = start[k];
        s.chord[k] = s.end[k] - start[k];
    }
    const double square = dot(s.chord, s.chord);
    s.length = sqrt(square);
    s.inverse = square > 0.0 ? 1.0 / square : 0.0;
    s.bend = bend * s.step * s.step;
    return s;
}

// Square of the distance of a chord from a point; along: where on it, from 0 to 1.
ANCF_INLINE double chord_square(double* along, const piece* s, const double point[3]) {
    double way[3];
    subtract(way, point, s->start);
    *along = clamp(dot(way, s->chord) * s->inverse, 0.0, 1.0);
    for (int k = 0; k < 3; k++) way[k] -= *along * s->chord[k];
    return dot(way, way);
}

// Nearest spot of a piece to the origin, if it has a place below `limit`; along: where to start.
static spot nearest_in(const power* p, const piece* s, double along, double limit) {
    double r[3], d[3], dd[3];
    const double length = s->length, slowest = length - 0.5 * s->bend;
    spot best = {.t = s->low + along * s->step};
    // (r^2/2)'' >= |r'|^2 - |r| |r''| > 0: there is one minimum, and Newton finds it.
    const double w = limit + 0.125 * s->bend, stiff = slowest * slowest - w * s->bend;
    if (slowest > 0.0 && stiff > 0.0) {
        // |(r^2/2)'''| / (2 (r^2/2)'') at most: what a step leaves, of its square.
        const double left = s->bend * (1.5 * (length + 0.5 * s->bend) + w) / stiff;
        double low = s->low, high = s->high;
        bool low_known = false, high_known = false;
        for (int i = 0; i < NEWTON_MAX; i++) {
            jet(r, d, dd, p, best.t);
            const double g = dot(r, d), h = dot(d, d) + dot(r, dd);
            if (g > 0.0) {
                high = best.t;
                high_known = true;
            } else {
                low = best.t;
                low_known = true;
            }
            double next = best.t - g / h;
            const bool out = (low_known && next < low) || (high_known && next > high) || !(h > 0.0);
            next = out ? 0.5 * (low + high) : clamp(next, low, high);
            const double moved = fabs(next - best.t);
            best.t = next;
            if (left * moved * moved <= 1e-10 * s->step * s->step) break;
        }
        at(r, p, best.t);
        best.value = sqrt(dot(r, r));
        return best;
    }
    field f = {.to = TO_POINT, .cubic = *p, .convex = true, .detail = INFINITY};
    f.speed = (length + 0.5 * s->bend) / s->step;
    f.bend = s->bend / (s->step * s->step);
    f.margin = 4.0 * DBL_EPSILON * (length + s->bend + limit);
    const spot a = probe(&f, s->low), b = probe(&f, s->high);
    return search(&f, &a, &b, limit, SPLITS_MAX);
}

static spot nearest_of(const strand* s, const double point[3]) {
    double square[PIECES_MAX], along[PIECES_MAX], least = INFINITY;
    for (int j = 0; j < s->n; j++) {
        square[j] = chord_square(&along[j], &s->part[j], point);
        least = lower(least, square[j]);
    }
    power from = s->cubic;
    subtract(from.a[0], from.a[0], point);
    const double sag = 0.125 * s->part[0].bend, top = sqrt(least) + sag; // the bend is the same in all parts
    spot best = {.value = INFINITY};
    for (int j = 0; j < s->n; j++) {
        const double edge = lower(top, best.value) + sag;
        if (square[j] * (1.0 - 1e-12) > edge * edge) continue;
        const spot here = nearest_in(&from, &s->part[j], along[j], edge);
        if (here.value < best.value) best = here;
    }
    return best;
}

void ancf_nearest_place(ancf_nearest* place, int segment, double xi, const ancf_cubic* cable, double radius,
                        const ancf_solid* solid) {
    place->segment = segment;
    place->xi = xi;
    ancf_powers(place->power, xi);
    place->share = 1.0;
    ancf_cubic_at(place->point, cable, xi);
    place->gap = ancf_solid_distance(place->normal, solid, place->point) - radius;
}

typedef struct {
    double low[3], high[3];
} box;

static box box_of(const ancf_cubic* c) {
    box b;
    for (int k = 0; k < 3; k++) {
        const double p = c->control[0][k], q = c->control[1][k], r = c->control[2][k], s = c->control[3][k];
        b.low[k] = lower(lower(p, q), lower(r, s));
        b.high[k] = higher(higher(p, q), higher(r, s));
    }
    return b;
}

static bool apart(const box* a, const box* b, double limit) {
    double square = 0.0;
    for (int k = 0; k < 3; k++) {
        const double out = higher(0.0, higher(a->low[k] - b->high[k], b->low[k] - a->high[k]));
        square += out * out;
    }
    return !(limit > 0.0 && square < limit * limit);
}

static bool boxes_apart(const ancf_cubic* c, const ancf_cubic* d, double limit) {
    const box a = box_of(c), b = box_of(d);
    return apart(&a, &b, limit);
}

static bool corners_apart(const ancf_cubic* c, const double corner[3][3], double limit) {
    const box a = box_of(c);
    box b;
    for (int k = 0; k < 3; k++) {
        b.low[k] = lower(lower(corner[0][k], corner[1][k]), corner[2][k]);
        b.high[k] = higher(higher(corner[0][k], corner[1][k]), corner[2][k]);
    }
    return apart(&a, &b, limit);
}

// By itself: twice as fast as with a box.
static bool point_apart(const ancf_cubic* c, const double point[3], double limit) {
    double square = 0.0;
    for (int k = 0; k < 3; k++) {
        const double p = c->control[0][k], q = c->control[1][k], r = c->control[2][k], s = c->control[3][k];
        const double low = lower(lower(p, q), lower(r, s)), high = higher(higher(p, q), higher(r, s));
        const double out = higher(0.0, higher(low - point[k], point[k] - high));
        square += out * out;
    }
    return !(limit > 0.0 && square < limit * limit);
}

static int nearest_ball(ancf_nearest* found, const ancf_cubic* cable, int segments, double radius,
                        const ancf_solid* solid, double reach) {
    const double limit = radius + solid->size[0] + reach;
    if (point_apart(cable, solid->center, limit)) return 0;
    const power p = expand(cable, solid->center);
    const double bend = bend_of(&p), step = 1.0 / segments, edge = limit + 0.125 * bend * step * step;
    int n = 0;
    double start[3], end[3], chord[3];
    at(start, &p, 0.0);
    for (int i = 0; i < segments; i++) {
        at(end, &p, (i + 1) * step);
        subtract(chord, end, start);
        // Of the chord's distance, times the chord's: without a division.
        const double square = dot(chord, chord), t = clamp(-dot(start, chord), 0.0, square),
                     times = square * dot(start, start) + t * (t + 2.0 * dot(start, chord));
        if (times <= edge * edge * square) {
            const piece s = part_of(&p, joint(i, segments), joint(i + 1, segments), start, bend);
            const spot best = nearest_in(&p, &s, t * s.inverse, limit);
            ancf_nearest_place(&found[n], i, best.t, cable, radius, solid);
            if (found[n].gap < reach) n++;
        }
        for (int k = 0; k < 3; k++) start[k] = end[k];
    }
    return n;
}

// Height over a plane is itself a cubic.
static int nearest_plane(ancf_nearest* found, const ancf_cubic* cable, int segments, double radius,
                         const ancf_solid* solid, double reach) {
    const double limit = radius + reach, sign = solid->sense < 0 ? -1.0 : 1.0;
    double height[4], way[3], size = 0.0;
    for (int i = 0; i < 4; i++) {
        subtract(way, cable->control[i], solid->center);
        height[i] = sign * dot(way, solid->axis[0]);
        size += fabs(way[0]) + fabs(way[1]) + fabs(way[2]);
    }
    if (!(lower(lower(height[0], height[1]), lower(height[2], height[3])) < limit)) return 0;
    const double c1 = 3.0 * (height[1] - height[0]), c2 = 3.0 * (height[2] - 2.0 * height[1] + height[0]),
                 c3 = height[3] - height[0] - 3.0 * (height[2] - height[1]), disc = c2 * c2 - 3.0 * c1 * c3;
    // Its only minimum inside.
    const double root = sqrt(higher(disc, 0.0)), lowest = c2 >= 0.0 ? -c1 / (c2 + root) : (root - c2) / (3.0 * c3);
    const double margin = 4.0 * DBL_EPSILON * size;
    int n = 0;
    for (int i = 0; i < segments; i++) {
        const double t[3] = {0.5 * (joint(i, segments) + joint(i + 1, segments)), joint(i, segments),
                             joint(i + 1, segments)};
        double best = INFINITY, place = t[0];
        for (int j = 0; j < 3; j++) {
            const double value = height[0] + t[j] * (c1 + t[j] * (c2 + t[j] * c3));
            if (!(value < best - margin)) continue;
            best = value;
            place = t[j];
        }
        // A valley that is more than rounding.
        const bool inside = lowest > t[1] && lowest < t[2] && root * (t[2] - t[1]) * (t[2] - t[1]) > margin;
        if (inside && height[0] + lowest * (c1 + lowest * (c2 + lowest * c3)) < best + margin) place = lowest;
        if (!inside && !(best < limit + margin)) continue;
        ancf_nearest_place(&found[n], i, place, cable, radius, solid);
        if (found[n].gap < reach) n++;
    }
    return n;
}

// Distance of the control points from a solid, at least; cheap.
static double cheap_bound(const ancf_cubic* cable, const ancf_solid* solid) {
    double middle[3], normal[3], away = 0.0, away2 = 0.0;
    for (int k = 0; k < 3; k++)
        middle[k] = 0.125 * (cable->control[0][k] + cable->control[3][k]) +
                    0.375 * (cable->control[1][k] + cable->control[2][k]);
    if (solid->kind == ANCF_WHEEL) { // the groove itself takes long
        double way[3];
        for (int i = 0; i < 4; i++) {
            subtract(way, cable->control[i], middle);
            away2 = higher(away2, dot(way, way));
        }
        away = sqrt(away2);
        subtract(way, middle, solid->center);
        const double z = dot(way, solid->axis[0]), rho = sqrt(higher(0.0, dot(way, way) - z * z));
        const double radial = rho - away - solid->groove->radius - solid->groove->height;
        return radial > 0.0 ? radial : fabs(z) - away - ancf_groove_half_width(solid->groove);
    }
    // The tangent plane of a convex function lies below it.
    const double d = ancf_solid_distance(normal, solid, middle), foot = dot(normal, middle);
    for (int i = 0; i < 4; i++) away = lower(away, dot(normal, cable->control[i]) - foot);
    return d + away;
}

int ancf_nearest_solid(ancf_nearest* found, const ancf_cubic* cable, int segments, double radius,
                       const ancf_solid* solid, double reach) {
    if (solid->kind == ANCF_BALL) return nearest_ball(found, cable, segments, radius, solid, reach);
    if (solid->kind == ANCF_PLANE && solid->sense != 0)
        return nearest_plane(found, cable, segments, radius, solid, reach);
    const double limit = radius + reach;
    if (solid->kind == ANCF_TRIANGLE && corners_apart(cable, solid->corner, limit)) return 0;
    if (!(cheap_bound(cable, solid) < limit)) return 0;
    static const double origin[3] = {0.0, 0.0, 0.0};
    field f = {.to = TO_SOLID, .solid = solid, .cubic = expand(cable, origin), .convex = solid->kind != ANCF_WHEEL};
    f.fine = f.convex ? fineness * radius : 0.0;
    f.detail = f.convex ? INFINITY : solid->groove->floor + solid->groove->fillet;
    f.speed = speed_of(cable);
    f.bend = bend_of(&f.cubic);
    if (solid->kind == ANCF_BOX) {
        const power from = expand(cable, solid->center);
        f.to = TO_BOX;
        for (int i = 0; i < 4; i++)
            for (int k = 0; k < 3; k++) f.cubic.a[i][k] = dot(solid->axis[k], from.a[i]);
    }
    f.margin = f.speed;
    for (int k = 0; k < 3; k++) f.margin += fabs(cable->control[0][k]) + fabs(solid->center[k]);
    f.margin *= 4.0 * DBL_EPSILON;
    int n = 0;
    spot a = probe(&f, 0.0), b;
    bool known = true;      // a
    double least = a.value; // at the segment's start, at least
    for (int i = 0; i < segments; i++) {
        const double low = joint(i, segments), high = joint(i + 1, segments), arc = f.speed * (high - low);
        if (least - arc >= limit) { // nothing of it can come so near
            least -= arc;
            known = false;
            continue;
        }
        if (!known) a = probe(&f, low);
        b = probe(&f, high);
        known = true;
        least = b.value;
        if (floor_of(&f, &a, &b) < limit) {
            const spot best = search(&f, &a, &b, limit, SPLITS_MAX);
            if (best.value < limit + f.margin) {
                ancf_nearest_place(&found[n], i, best.t, cable, radius, solid);
                if (found[n].gap < reach) n++;
            }
        }
        a = b;
    }
    return n;
}

// Square of the distance of two chords, and where on them, from 0 to 1 [Ericson 2005].
static double chords_square(double along[2], const piece* a, const piece* b) {
    double way[3];
    subtract(way, a->start, b->start);
    const double aa = dot(a->chord, a->chord), bb = dot(b->chord, b->chord), ab = dot(a->chord, b->chord),
                 aw = dot(a->chord, way), bw = dot(b->chord, way), det = aa * bb - ab * ab;
    double s = det > 1e-12 * aa * bb ? clamp((ab * bw - aw * bb) / det, 0.0, 1.0) : 0.5;
    double t = bb > 0.0 ? (ab * s + bw) / bb : 0.0;
    if (!(bb > 0.0 && t >= 0.0 && t <= 1.0)) {
        t = clamp(t, 0.0, 1.0);
        s = aa > 0.0 ? clamp((ab * t - aw) / aa, 0.0, 1.0) : 0.0;
    }
    along[0] = s;
    along[1] = t;
    for (int k = 0; k < 3; k++) way[k] += s * a->chord[k] - t * b->chord[k];
    return dot(way, way);
}

// Whether half the square of the distance is strictly convex on two pieces, where they are nearer than `limit`.
static bool convex_pair(const piece* a, const piece* b, double limit) {
    const double w = limit + 0.125 * (a->bend + b->bend), fast_a = a->length - 0.5 * a->bend,
                 fast_b = b->length - 0.5 * b->bend;
    if (!(fast_a > 0.0 && fast_b > 0.0)) return false;
    const double aa = fast_a * fast_a - w * a->bend, bb = fast_b * fast_b - w * b->bend,
                 ab = fabs(dot(a->chord, b->chord)) + 0.5 * (a->length * b->bend + b->length * a->bend) +
                      0.25 * a->bend * b->bend;
    return aa > 0.0 && bb > 0.0 && aa * bb > 1.02 * ab * ab; // with room for a fast Newton
}

// Newton's method on two convex pieces, from where their chords are nearest; false if it does not settle.
static bool settle(spot* best, const power* first, const piece* a, const power* second, const piece* b,
                   const double along[2]) {
    double t = a->low + along[0] * a->step, u = b->low + along[1] * b->step;
    for (int i = 0; i < NEWTON_MAX; i++) {
        double w[3], p[3], dp[3], ddp[3], q[3], dq[3], ddq[3];
        jet(p, dp, ddp, first, t);
        jet(q, dq, ddq, second, u);
        subtract(w, p, q);
        const double gt = dot(w, dp), gu = -dot(w, dq), tt = dot(dp, dp) + dot(w, ddp), uu = dot(dq, dq) - dot(w, ddq),
                     tu = -dot(dp, dq), det = tt * uu - tu * tu;
        if (!(tt > 0.0 && uu > 0.0 && det > 0.0)) return false;
        const bool hold_t = (t <= a->low && gt >= 0.0) || (t >= a->high && gt <= 0.0);
        const bool hold_u = (u <= b->low && gu >= 0.0) || (u >= b->high && gu <= 0.0);
        double next_t = t, next_u = u;
        if (hold_t || hold_u) {
            if (!hold_t) next_t = clamp(t - gt / tt, a->low, a->high);
            if (!hold_u) next_u = clamp(u - gu / uu, b->low, b->high);
        } else {
            const double free_t = t + (tu * gu - uu * gt) / det, free_u = u + (tu * gt - tt * gu) / det;
            next_t = clamp(free_t, a->low, a->high);
            next_u = clamp(free_u, b->low, b->high);
            // On a side of the box the other goes to the minimum of the side.
            if (next_t != free_t) next_u = clamp(u - (gu + tu * (next_t - t)) / uu, b->low, b->high);
            else if (next_u != free_u) next_t = clamp(t - (gt + tu * (next_u - u)) / tt, a->low, a->high);
        }
        const bool done = fabs(next_t - t) <= 1e-7 * a->step && fabs(next_u - u) <= 1e-7 * b->step;
        t = next_t;
        u = next_u;
        if (!done) continue;
        at(p, first, t);
        at(q, second, u);
        subtract(w, p, q);
        *best = (spot) {.t = t, .value = sqrt(dot(w, w)), .other = u};
        return true;
    }
    return false;
}

// Two cables, made ready to be searched.
typedef struct {
    power first;
    strand other;
    double bend;   // of the first, at least |r''| [m]
    double speed;  // of the first, at least |r'| [m]
    double turn;   // of the other, length within which it hardly turns [m]
    double margin; // rounding of a distance [m]
    double limit;  // distance below which a place counts [m]
    double far;    // distance up to which pieces have to be convex for a fast search [m]
} crossing;

// Nearest spot of a piece of the first to the other; no less than `limit` if there is none below.
static spot nearest_pair(const crossing* x, const piece* a) {
    const power* first = &x->first;
    const strand* other = &x->other;
    const double limit = x->limit;
    double bound[PIECES_MAX], along[PIECES_MAX][2];
    for (int j = 0; j < other->n; j++) {
        const piece* b = &other->part[j];
        const double sag = 0.125 * (a->bend + b->bend), size = 0.5 * (a->length + b->length);
        double way[3];
        for (int k = 0; k < 3; k++) way[k] = 0.5 * (a->start[k] + a->end[k] - b->start[k] - b->end[k]);
        const double room = limit + sag + size;
        bound[j] = INFINITY;
        if (!(dot(way, way) < room * room)) continue;
        // Nearly parallel chords are given away by rounding.
        bound[j] = sqrt(chords_square(along[j], a, b)) - sag - 1e-6 * size;
    }
    spot best = {.t = a->low, .value = x->far};
    for (;;) {
        int j = 0;
        for (int i = 1; i < other->n; i++)
            if (bound[i] < bound[j]) j = i;
        if (!(bound[j] < lower(best.value, limit))) return best;
        const piece* b = &other->part[j];
        const double top = lower(best.value, bound[j] + 0.25 * (a->bend + b->bend) + 1e-6 * (a->length + b->length));
        spot here;
        if (!convex_pair(a, b, top) || !settle(&here, first, a, &other->cubic, b, along[j])) break;
        if (here.value < best.value) best = here;
        bound[j] = INFINITY;
    }
    // Nearly parallel or strongly bent: along the first only.
    const field f = {.to = TO_CUBIC,
                     .cubic = *first,
                     .other = other,
                     .detail = x->turn,
                     .speed = x->speed,
                     .bend = x->bend,
                     .margin = x->margin};
    const spot low = probe(&f, a->low), high = probe(&f, a->high);
    const double below = lower(best.value, limit);
    if (!(floor_of(&f, &low, &high) < below)) return best;
    const int splits = a->bend > 0.4 * a->length ? SPLITS_MAX : 1; // each takes long
    const spot here = search(&f, &low, &high, below, splits);
    return here.value < best.value + x->margin ? here : best;
}

static void any_across(double normal[3], const double tangent[3]) {
    int k = 0;
    for (int i = 1; i < 3; i++)
        if (fabs(tangent[i]) < fabs(tangent[k])) k = i;
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    const double length = sqrt(tangent[i] * tangent[i] + tangent[j] * tangent[j]);
    normal[k] = 0.0;
    normal[i] = length > 0.0 ? tangent[j] / length : 1.0;
    normal[j] = length > 0.0 ? -tangent[i] / length : 0.0;
}

static void place_on_cubic(ancf_nearest_pair* place, int segment, const spot* s, const ancf_cubic* first,
                           const ancf_cubic* second, double radii, double margin) {
    double way[3], tangent[3];
    place->segment = segment;
    place->xi[0] = s->t;
    place->xi[1] = s->other;
    ancf_cubic_at(place->point[0], first, s->t);
    ancf_cubic_at(place->point[1], second, s->other);
    subtract(way, place->point[0], place->point[1]);
    const double distance = sqrt(dot(way, way));
    place->gap = distance - radii;
    if (distance > margin) { // what is shorter has no direction but rounding's
        for (int k = 0; k < 3; k++) place->normal[k] = way[k] / distance;
        return;
    }
    ancf_cubic_slope(tangent, first, s->t);
    any_across(place->normal, tangent);
}

// Whether the chords of two cubics are farther apart than any place below `limit` can be.
static bool chords_apart(const ancf_cubic* first, const ancf_cubic* second, double limit) {
    const double* origin = second->control[0];
    const power p = expand(first, origin), q = expand(second, origin);
    const double bend = bend_of(&p), bend2 = bend_of(&q), room = limit + 0.125 * (bend + bend2);
    const piece a = part_of(&p, 0.0, 1.0, p.a[0], bend), b = part_of(&q, 0.0, 1.0, q.a[0], bend2);
    double along[2];
    return !(chords_square(along, &a, &b) * (1.0 - 1e-6) < room * room);
}

static void prepare(crossing* x, const ancf_cubic* first, int segments, const ancf_cubic* second, double limit,
                    double far) {
    const double* origin = second->control[0];
    x->first = expand(first, origin);
    x->other.cubic = expand(second, origin);
    const double bend2 = bend_of(&x->other.cubic);
    x->bend = bend_of(&x->first);
    x->speed = speed_of(first);
    const double speed2 = speed_of(second);
    x->turn = bend2 > 0.0 ? 0.2 * speed2 * speed2 / bend2 : INFINITY;
    x->limit = limit;
    x->far = far;
    x->other.n = segments < PIECES_MAX ? segments : PIECES_MAX;
    double start[3];
    at(start, &x->other.cubic, 0.0);
    for (int j = 0; j < x->other.n; j++) {
        x->other.part[j] = part_of(&x->other.cubic, joint(j, x->other.n), joint(j + 1, x->other.n), start, bend2);
        memcpy(start, x->other.part[j].end, sizeof start);
    }
    x->margin =
        4.0 * DBL_EPSILON * (x->speed + bend2 + sqrt(dot(x->first.a[0], x->first.a[0])) + sqrt(dot(start, start)));
}

// The place of a segment; false if it has none below the limit.
static bool place_of(ancf_nearest_pair* place, const crossing* x, int i, int segments, const ancf_cubic* first,
                     const ancf_cubic* second, double radii) {
    double start[3];
    at(start, &x->first, joint(i, segments));
    const piece part = part_of(&x->first, joint(i, segments), joint(i + 1, segments), start, x->bend);
    const spot best = nearest_pair(x, &part);
    if (!(best.value < x->limit)) return false;
    place_on_cubic(place, i, &best, first, second, radii, x->margin);
    return true;
}

int ancf_nearest_cubic(ancf_nearest_pair* found, const ancf_cubic* first, int segments, double radius1,
                       const ancf_cubic* second, double radius2, double reach) {
    const double radii = radius1 + radius2, limit = radii + reach;
    if (boxes_apart(first, second, limit) || chords_apart(first, second, limit)) return 0;
    crossing x;
    prepare(&x, first, segments, second, limit, limit);
    int n = 0;
    for (int i = 0; i < segments; i++)
        if (place_of(&found[n], &x, i, segments, first, second, radii) && found[n].gap < reach) n++;
    return n;
}

int ancf_nearest_segments(ancf_nearest_pair* found, const ancf_cubic* first, int segments, uint64_t which,
                          double radius1, const ancf_cubic* second, double radius2, double reach, double far) {
    const double radii = radius1 + radius2;
    crossing x;
    prepare(&x, first, segments, second, radii + reach, radii + far);
    int n = 0;
    for (int i = 0; i < segments; i++) {
        if (!(which >> i & 1)) continue;
        if (place_of(&found[n], &x, i, segments, first, second, radii) && found[n].gap < reach) n++;
    }
    return n;
}

double ancf_nearest_least(const ancf_cubic* cable, const double point[3]) {
    static const double origin[3] = {0.0, 0.0, 0.0};
    const power p = expand(cable, point);
    const double bend = bend_of(&p);
    double start[3], least = INFINITY, along;
    memcpy(start, p.a[0], sizeof start);
    for (int i = 0; i < LEAST_PARTS; i++) {
        const piece s = part_of(&p, joint(i, LEAST_PARTS), joint(i + 1, LEAST_PARTS), start, bend);
        least = lower(least, sqrt(chord_square(&along, &s, origin)) - 0.125 * s.bend);
        memcpy(start, s.end, sizeof start);
    }
    return least;
}

double ancf_nearest_from(const ancf_cubic* cable, const double within[2], const double point[3]) {
    const power p = expand(cable, point);
    double start[3], along;
    at(start, &p, within[0]);
    const piece s = part_of(&p, within[0], within[1], start, bend_of(&p));
    static const double origin[3] = {0.0, 0.0, 0.0};
    const double distance = sqrt(chord_square(&along, &s, origin));
    return nearest_in(&p, &s, along, distance + 0.125 * s.bend).t;
}

bool ancf_nearest_settle(double xi[2], const ancf_cubic* first, const double within[2], const ancf_cubic* second) {
    const double* origin = second->control[0];
    const power p = expand(first, origin), q = expand(second, origin);
    double start[3];
    at(start, &p, within[0]);
    const piece a = part_of(&p, within[0], within[1], start, bend_of(&p));
    const piece b = part_of(&q, 0.0, 1.0, q.a[0], bend_of(&q));
    const double along[2] = {a.step > 0.0 ? (xi[0] - a.low) / a.step : 0.0, xi[1]};
    spot best;
    if (!settle(&best, &p, &a, &q, &b, along)) return false;
    xi[0] = best.t;
    xi[1] = best.other;
    return true;
}
