#include "ancf/lying.h"

#include <math.h>
#include <string.h>

// So many times the root mean square; within such parts of a depth, one passes into the other.
static const double lying = 1.2, blend_lying = 0.15, blend_halves = 0.1;
static const double apart_halves = 0.25; // of a segment; nearer places are the same

static const double weight[ANCF_LYING_SPOTS] = {0.1739274225687269, 0.3260725774312731, 0.3260725774312731,
                                                0.1739274225687269};

void ancf_lying_along(ancf_spot spot[ANCF_LYING_SPOTS], int segment, int segments) {
    static const double gauss[ANCF_LYING_SPOTS] = {0.0694318442029737, 0.3300094782075719, 0.6699905217924281,
                                                   0.9305681557970263};
    for (int i = 0; i < ANCF_LYING_SPOTS; ++i) spot[i] = (ancf_spot) {.xi = (segment + gauss[i]) / segments};
}

// The larger of 1 and 1 + over, smoothly within `blend`; *part: its derivative by `over`.
static double larger(double* part, double over, double blend) {
    *part = over < -blend ? 0.0 : over < blend ? (over + blend) / (2.0 * blend) : 1.0;
    return over < -blend ? 1.0 : over < blend ? 1.0 + (over + blend) * (over + blend) / (4.0 * blend) : 1.0 + over;
}

// One depth of the deepest places of two halves, and their parts.
static double join_halves(ancf_spot half[2], int segments) {
    ancf_spot *deeper = &half[half[1].depth > half[0].depth], *other = &half[half[1].depth <= half[0].depth];
    const double way = fmin(fabs(half[1].xi - half[0].xi) * segments / apart_halves, 1.0);
    const double over = other->depth / deeper->depth - 1.0;
    double part;
    const double one = 1.0 + way * (larger(&part, over, blend_halves) - 1.0);
    other->part = way * part;
    deeper->part = one - other->part * (1.0 + over);
    return one * deeper->depth;
}

double ancf_lying_depth(ancf_spot* spot, int n, int segments, double* spread) {
    spot[0].part = 1.0;
    const double deepest = n == 1 ? spot[0].depth : join_halves(spot, segments);
    double square = 0.0;
    ancf_spot* along = &spot[n];
    for (int i = 0; i < ANCF_LYING_SPOTS; ++i) square += weight[i] * along[i].depth * along[i].depth;
    const double mean = sqrt(square), over = lying * mean / deepest - 1.0;
    const double more = larger(spread, over, blend_lying), alone = more - *spread * (1.0 + over);
    for (int i = 0; i < n; ++i) spot[i].part *= alone;
    for (int i = 0; i < ANCF_LYING_SPOTS; ++i)
        along[i].part = mean > 0.0 ? *spread * lying * weight[i] * along[i].depth / mean : 0.0;
    return more * deepest;
}

static void probe(ancf_spot* s, const ancf_cubic* cubic, const ancf_solid* solid, double surface) {
    ancf_cubic_at(s->at, cubic, s->xi);
    s->depth = fmax(surface - ancf_solid_distance(s->normal, solid, s->at), 0.0);
}

static ancf_spot spot_of(const ancf_nearest* place, double more) {
    ancf_spot s = {.xi = place->xi, .depth = more - place->gap};
    memcpy(s.at, place->point, sizeof s.at);
    memcpy(s.normal, place->normal, sizeof s.normal);
    return s;
}

// The mean of spots; false if they are pressed in directions too different for one contact.
static bool take_mean(ancf_nearest* place, const ancf_spot* spot, int n, double depth, double more) {
    ancf_nearest mean = {.segment = place->segment};
    double sum = 0.0, square = 0.0;
    for (int i = 0; i < n; ++i) sum += spot[i].part;
    for (int i = 0; i < n; ++i) {
        const double part = spot[i].part / sum;
        double power = part;
        for (int k = 0; k < 3; k++) {
            mean.power[k] += power *= spot[i].xi;
            mean.point[k] += part * spot[i].at[k];
            mean.normal[k] += part * spot[i].normal[k];
        }
    }
    for (int k = 0; k < 3; k++) square += mean.normal[k] * mean.normal[k];
    if (square < 0.81) return false;
    for (int k = 0; k < 3; k++) mean.normal[k] /= sqrt(square);
    mean.xi = mean.power[0];
    mean.share = sum;
    mean.gap = more - depth / sum;
    *place = mean;
    return true;
}

void ancf_lying_on(ancf_nearest* place, const ancf_cover* cover, const ancf_cubic* cubic, const ancf_solid* solid,
                   double more) {
    if (cover->points || !(place->gap < more)) return;
    ancf_spot spot[ANCF_LYING_MOST], along[ANCF_LYING_SPOTS];
    const double surface = cover->radius + more, middle = (place->segment + 0.5) / cover->segments;
    const bool second = place->xi > middle;
    spot[0] = spot_of(place, more);
    ancf_lying_along(along, place->segment, cover->segments);
    for (int i = 0; i < ANCF_LYING_SPOTS; ++i) probe(&along[i], cubic, solid, surface);
    ancf_spot other = {.xi = (double)(place->segment + !second) / cover->segments};
    probe(&other, cubic, solid, surface);
    const int begin = second ? 0 : ANCF_LYING_SPOTS / 2;
    for (int i = begin; i < begin + ANCF_LYING_SPOTS / 2; ++i) other.depth = fmax(other.depth, along[i].depth);
    int n = 1;
    if (other.depth > (1.0 - 1.5 * blend_halves) * spot[0].depth) {
        const double within[2] = {second ? middle - 0.5 / cover->segments : middle,
                                  second ? middle : middle + 0.5 / cover->segments};
        ancf_nearest half;
        ancf_nearest_within(&half, cubic, within, cover->radius, solid);
        spot[n++] = spot_of(&half, more);
    }
    memcpy(&spot[n], along, sizeof along);
    double spread;
    const double depth = ancf_lying_depth(spot, n, cover->segments, &spread);
    if (spot[0].part < 1.0) take_mean(place, spot, n + ANCF_LYING_SPOTS, depth, more);
}
