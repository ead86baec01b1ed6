#include "ancf/lying.h"

#include <math.h>
#include <string.h>

// So many times the root mean square; within such parts of a depth, one passes into the other.
static const double lying = 1.2, blend_lying = 0.15, blend_end = 0.1;

static const double weight[4] = {0.1739274225687269, 0.3260725774312731, 0.3260725774312731, 0.1739274225687269};

void ancf_lying_along(ancf_spot spot[ANCF_LYING_SPOTS], int segment, int segments) {
    static const double gauss[4] = {0.0694318442029737, 0.3300094782075719, 0.6699905217924281, 0.9305681557970263};
    const bool first = spot[0].xi * segments < segment + 0.5;
    spot[1] = (ancf_spot) {.xi = (double)(segment + first) / segments};
    for (int i = 0; i < 4; ++i) spot[ANCF_LYING_FIRST + i] = (ancf_spot) {.xi = (segment + gauss[i]) / segments};
}

// The larger of 1 and 1 + over, smoothly within `blend`; *part: its derivative by `over`.
static double larger(double* part, double over, double blend) {
    *part = over < -blend ? 0.0 : over < blend ? (over + blend) / (2.0 * blend) : 1.0;
    return over < -blend ? 1.0 : over < blend ? 1.0 + (over + blend) * (over + blend) / (4.0 * blend) : 1.0 + over;
}

// The larger of two, of which the first is; and their parts.
static double join(ancf_spot two[2], double blend) {
    const double over = two[1].depth / two[0].depth - 1.0, more = larger(&two[1].part, over, blend);
    two[0].part = more - two[1].part * (1.0 + over);
    return more * two[0].depth;
}

double ancf_lying_depth(ancf_spot spot[ANCF_LYING_SPOTS], double* spread) {
    ancf_spot* along = &spot[ANCF_LYING_FIRST];
    double square = 0.0;
    for (int i = 0; i < 4; ++i) square += weight[i] * along[i].depth * along[i].depth;
    const double mean = sqrt(square);
    ancf_spot two[2] = {{.depth = join(spot, blend_end)}, {.depth = lying * mean}};
    const double depth = join(two, blend_lying);
    *spread = two[1].part;
    for (int i = 0; i < ANCF_LYING_FIRST; ++i) spot[i].part *= two[0].part;
    for (int i = 0; i < 4; ++i)
        along[i].part = mean > 0.0 ? two[1].part * lying * weight[i] * along[i].depth / mean : 0.0;
    return depth;
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

// The mean of spots, unless they are pressed in directions too different for one contact.
static void take_mean(ancf_nearest* place, const ancf_spot spot[ANCF_LYING_SPOTS], double depth, double more) {
    ancf_nearest mean = {.segment = place->segment};
    double sum = 0.0, square = 0.0;
    for (int i = 0; i < ANCF_LYING_SPOTS; ++i) sum += spot[i].part;
    for (int i = 0; i < ANCF_LYING_SPOTS; ++i) {
        const double part = spot[i].part / sum;
        double power = part;
        for (int k = 0; k < 3; k++) {
            mean.power[k] += power *= spot[i].xi;
            mean.point[k] += part * spot[i].at[k];
            mean.normal[k] += part * spot[i].normal[k];
        }
    }
    for (int k = 0; k < 3; k++) square += mean.normal[k] * mean.normal[k];
    if (square < 0.81) return;
    for (int k = 0; k < 3; k++) mean.normal[k] /= sqrt(square);
    mean.xi = mean.power[0];
    mean.share = sum;
    mean.gap = more - depth / sum;
    *place = mean;
}

void ancf_lying_on(ancf_nearest* place, const ancf_cubic* cable, int segments, double radius, const ancf_solid* solid,
                   double more) {
    if (!(place->gap < more)) return;
    ancf_spot spot[ANCF_LYING_SPOTS] = {spot_of(place, more)};
    ancf_lying_along(spot, place->segment, segments);
    for (int i = 1; i < ANCF_LYING_SPOTS; ++i) probe(&spot[i], cable, solid, radius + more);
    double spread;
    const double depth = ancf_lying_depth(spot, &spread);
    if (spot[0].part < 1.0) take_mean(place, spot, depth, more);
}
