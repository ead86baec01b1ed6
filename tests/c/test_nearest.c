// Signed distances of solids and nearest places of cables: closed forms and brute force.
#include "check.h"

#include <string.h>

#include "ancf/nearest.h"

enum { SEGMENTS = 4, SAMPLES = 200, KINDS = 5 };

static const ancf_groove groove = {0.05, 0.001, 0.006, 1.3, 0.008, 0.002};

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static void cross(double c[3], const double a[3], const double b[3]) {
    for (int k = 0; k < 3; k++) c[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

static double distance(const double a[3], const double b[3]) {
    const double d[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
    return sqrt(dot(d, d));
}

static void random_unit_vector(double v[3], uint64_t* seed) {
    double square;
    do {
        for (int k = 0; k < 3; k++) v[k] = random_between(seed, -1.0, 1.0);
        square = dot(v, v);
    } while (square > 1.0 || square < 1e-3);
    for (int k = 0; k < 3; k++) v[k] /= sqrt(square);
}

static void random_axes(double axis[3][3], uint64_t* seed) {
    double other[3];
    random_unit_vector(axis[0], seed);
    do {
        random_unit_vector(other, seed);
        cross(axis[1], axis[0], other);
    } while (dot(axis[1], axis[1]) < 1e-2);
    const double length = sqrt(dot(axis[1], axis[1]));
    for (int k = 0; k < 3; k++) axis[1][k] /= length;
    cross(axis[2], axis[0], axis[1]);
}

// Control points about a chord; bend 0: evenly on it.
static ancf_cubic random_cubic(uint64_t* seed, double spread, double length, double bend) {
    ancf_cubic c;
    double way[3];
    random_unit_vector(way, seed);
    for (int k = 0; k < 3; k++) {
        const double middle = random_between(seed, -spread, spread);
        for (int i = 0; i < 4; i++)
            c.control[i][k] = middle + length * (way[k] * ((double)i / 3.0 - 0.5) + random_between(seed, -bend, bend));
    }
    return c;
}

// A cable of unit speed and even bend: a bent arc, as in a model.
static ancf_cubic random_arc(uint64_t* seed, double spread, double length, double turn) {
    double axis[3][3], start[3], end[3], tangent[2][3];
    random_axes(axis, seed);
    const double angle = random_between(seed, 0.01, turn), r = length / angle;
    for (int k = 0; k < 3; k++) {
        start[k] = random_between(seed, -spread, spread);
        end[k] = start[k] + r * (sin(angle) * axis[0][k] + (1.0 - cos(angle)) * axis[1][k]);
        tangent[0][k] = axis[0][k];
        tangent[1][k] = cos(angle) * axis[0][k] + sin(angle) * axis[1][k];
    }
    ancf_cubic c;
    for (int k = 0; k < 3; k++) {
        c.control[0][k] = start[k];
        c.control[1][k] = start[k] + length * tangent[0][k] / 3.0;
        c.control[2][k] = end[k] - length * tangent[1][k] / 3.0;
        c.control[3][k] = end[k];
    }
    return c;
}

static ancf_cubic line(const double a[3], const double b[3]) {
    ancf_cubic c;
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 3; k++) c.control[i][k] = a[k] + (b[k] - a[k]) * (double)i / 3.0;
    return c;
}

// Of about the size of a cable of unit length.
static ancf_solid random_solid(ancf_solid_kind kind, uint64_t* seed) {
    ancf_solid s = {.kind = kind, .groove = &groove};
    random_axes(s.axis, seed);
    for (int k = 0; k < 3; k++) {
        s.center[k] = random_between(seed, -0.3, 0.3);
        s.size[k] = random_magnitude(seed, 0.02, 0.5);
        for (int i = 0; i < 3; i++) s.corner[i][k] = random_between(seed, -0.6, 0.6);
    }
    s.sense = (int)(3.0 * random_unit(seed)) - 1;
    return s;
}

static double to_edge(const double p[3], const double a[3], const double b[3]) {
    double e[3], w[3];
    for (int k = 0; k < 3; k++) {
        e[k] = b[k] - a[k];
        w[k] = p[k] - a[k];
    }
    const double t = fmin(1.0, fmax(0.0, dot(w, e) / dot(e, e)));
    for (int k = 0; k < 3; k++) w[k] -= t * e[k];
    return sqrt(dot(w, w));
}

static double oracle(const ancf_solid* s, const double p[3]) {
    double w[3], q[3], g[2], least = INFINITY, square = 0.0;
    for (int k = 0; k < 3; k++) w[k] = p[k] - s->center[k];
    for (int k = 0; k < 3; k++) q[k] = dot(w, s->axis[k]);
    switch (s->kind) {
    case ANCF_BALL:
        return distance(p, s->center) - s->size[0];
    case ANCF_BOX:
        for (int k = 0; k < 3; k++) {
            least = fmin(least, fmin(s->size[k] - q[k], s->size[k] + q[k]));
            square += pow(q[k] - fmin(s->size[k], fmax(-s->size[k], q[k])), 2);
        }
        return least > 0.0 ? -least : sqrt(square);
    case ANCF_TRIANGLE: {
        double ab[3], n[3];
        int inside = 0;
        for (int i = 0; i < 3; i++) {
            const double *a = s->corner[i], *b = s->corner[(i + 1) % 3], *c = s->corner[(i + 2) % 3];
            least = fmin(least, to_edge(p, a, b));
            double out[3], ac[3], ap[3];
            for (int k = 0; k < 3; k++) {
                ab[k] = b[k] - a[k];
                ac[k] = c[k] - a[k];
                ap[k] = p[k] - a[k];
            }
            cross(n, ab, ac);
            cross(out, n, ab);
            if (dot(out, ap) > 0.0) inside++;
            if (i == 2 && inside == 3) least = fabs(dot(n, ap)) / sqrt(dot(n, n));
        }
        return least;
    }
    case ANCF_PLANE:
        return s->sense == 0 ? fabs(q[0]) : s->sense * q[0];
    case ANCF_WHEEL:
        return ancf_groove_distance(g, s->groove, fabs(q[0]),
                                    sqrt(fmax(0.0, dot(w, w) - q[0] * q[0])) - s->groove->radius);
    }
    return NAN;
}

static void distances_of_solids(void** state) {
    (void)state;
    uint64_t seed = 1;
    for (int kind = 0; kind < KINDS; kind++)
        for (int i = 0; i < 20000; i++) {
            const ancf_solid s = random_solid((ancf_solid_kind)kind, &seed);
            const double size = kind == ANCF_WHEEL ? 0.07 : 0.7;
            double p[3], n[3], other[3];
            for (int k = 0; k < 3; k++)
                p[k] = (kind == ANCF_TRIANGLE ? 0.0 : s.center[k]) + random_between(&seed, -size, size);
            const double d = ancf_solid_distance(n, &s, p);
            assert_near(d, oracle(&s, p), 1e-14);
            assert_near(dot(n, n), 1.0, 1e-14);
            const double h = 1e-6;
            int smooth = 1;
            double slope[3];
            for (int k = 0; k < 3; k++) {
                double up[3], down[3];
                memcpy(up, p, sizeof up);
                memcpy(down, p, sizeof down);
                up[k] += h;
                down[k] -= h;
                slope[k] = ancf_solid_distance(other, &s, up);
                if (distance(other, n) > 1e-3) smooth = 0; // across a kink
                slope[k] = (slope[k] - ancf_solid_distance(other, &s, down)) / (2.0 * h);
                if (distance(other, n) > 1e-3) smooth = 0;
            }
            if (!smooth) continue;
            for (int k = 0; k < 3; k++) assert_near(n[k], slope[k], 1e-5);
        }
}

static void distances_by_hand(void** state) {
    (void)state;
    double n[3];
    ancf_solid s = {.kind = ANCF_BOX,
                    .center = {1.0, 0.0, 0.0},
                    .axis = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}},
                    .size = {1.0, 2.0, 3.0}};
    assert_true(ancf_solid_distance(n, &s, (double[3]) {5.0, 6.0, 1.0}) == 5.0); // off an edge
    assert_near(n[0], 0.6, 1e-15);
    assert_near(n[1], 0.8, 1e-15);
    assert_true(n[2] == 0.0);
    assert_true(ancf_solid_distance(n, &s, (double[3]) {1.0, 1.5, 0.0}) == -0.5);
    assert_true(n[1] == 1.0);
    assert_true(ancf_solid_distance(n, &s, (double[3]) {1.0, -2.0, 0.0}) == 0.0);
    assert_true(n[1] == -1.0);
    assert_near(ancf_solid_reach(&s), sqrt(14.0), 1e-15);
    s.kind = ANCF_BALL;
    assert_true(ancf_solid_distance(n, &s, s.center) == -1.0);
    assert_true(dot(n, n) == 1.0);
    assert_true(ancf_solid_reach(&s) == 1.0);
    s.kind = ANCF_PLANE;
    assert_true(isinf(ancf_solid_reach(&s)));
    s = (ancf_solid) {.kind = ANCF_TRIANGLE, .corner = {{0.0, 0.0, 0.0}, {4.0, 0.0, 0.0}, {0.0, 3.0, 0.0}}};
    assert_true(ancf_solid_distance(n, &s, (double[3]) {1.0, 1.0, -2.0}) == 2.0);
    assert_true(n[0] == 0.0 && n[1] == 0.0 && n[2] == -1.0);
    const double on[4][3] = {{1.0, 1.0, 0.0}, {4.0, 0.0, 0.0}, {2.0, 0.0, 0.0}, {2.0, 1.5, 0.0}};
    for (int i = 0; i < 4; i++) {
        assert_true(ancf_solid_distance(n, &s, on[i]) == 0.0);
        assert_true(n[0] == 0.0 && n[1] == 0.0 && n[2] == 1.0);
    }
    assert_true(ancf_solid_reach(&s) == 4.0);
    memcpy(s.corner[2], (double[3]) {8.0, 0.0, 0.0}, sizeof s.corner[2]); // on a line
    assert_near(ancf_solid_distance(n, &s, (double[3]) {9.0, 0.0, 1.0}), sqrt(2.0), 1e-15);
    assert_near(dot(n, n), 1.0, 1e-15);
    s = (ancf_solid) {.kind = ANCF_WHEEL, .axis = {{0.0, 0.0, 1.0}}, .groove = &groove};
    assert_true(ancf_solid_distance(n, &s, s.center) < 0.0);
    assert_near(dot(n, n), 1.0, 1e-15);
    assert_near(ancf_solid_reach(&s), hypot(0.058, ancf_groove_half_width(&groove)), 1e-15);
}

// A scene in the plane z = 0: facets that stand on it, boxes turned in it, balls in it.
static void planar_stays_planar(void** state) {
    (void)state;
    uint64_t seed = 4;
    for (int kind = 0; kind < KINDS; kind++)
        for (int i = 0; i < 5000; i++) {
            ancf_solid s = random_solid((ancf_solid_kind)kind, &seed);
            const double a = random_between(&seed, 0.0, 6.3);
            const double turned[3][3] = {{cos(a), sin(a), 0.0}, {-sin(a), cos(a), 0.0}, {0.0, 0.0, 1.0}};
            memcpy(s.axis, turned, sizeof turned);
            if (kind == ANCF_WHEEL) memcpy(s.axis[0], turned[2], sizeof turned[2]);
            s.center[2] = 0.0;
            for (int k = 0; k < 2; k++) s.corner[1][k] = s.corner[0][k]; // an upright edge
            s.corner[0][2] = -random_between(&seed, 0.1, 1.0);
            s.corner[1][2] = i % 2 ? -s.corner[0][2] : random_between(&seed, 0.1, 1.0);
            s.corner[2][2] = i % 2 ? 0.0 : s.corner[0][2];
            ancf_cubic c = random_cubic(&seed, 0.3, 1.0, 0.2), other = random_cubic(&seed, 0.3, 1.0, 0.2);
            for (int j = 0; j < 4; j++) c.control[j][2] = other.control[j][2] = 0.0;
            if (i % 4 == 0) { // across
                for (int j = 0; j < 4; j++)
                    for (int k = 0; k < 3; k++) other.control[j][k] = k == 2 ? 0.1 * (j - 1.5) : 0.1;
            }
            ancf_nearest found[SEGMENTS];
            ancf_nearest_pair pair[SEGMENTS];
            int n = ancf_nearest_solid(found, &c, SEGMENTS, 0.01, &s, 0.5);
            const int may_tilt = kind != ANCF_BALL && kind != ANCF_PLANE && !(kind == ANCF_TRIANGLE && i % 2);
            for (int j = 0; j < n; j++) {
                const double tilt = fabs(found[j].normal[2]); // inside a solid or off a slanted edge
                assert_true(found[j].point[2] == 0.0 && (tilt == 0.0 || (may_tilt && tilt > 1e-9)));
            }
            n = ancf_nearest_cubic(pair, &c, SEGMENTS, 0.01, &other, 0.01, 0.5);
            for (int j = 0; j < n && i % 4; j++) assert_true(pair[j].normal[2] == 0.0 && pair[j].point[1][2] == 0.0);
        }
}

// Places checked, and those among several minima that are not the lowest one; by how much at most.
typedef struct {
    int places, off;
    double most;
} tally;

static void count(tally* t, double gap, double least) {
    t->places++;
    if (gap < least + 1e-11) return;
    t->off++;
    t->most = fmax(t->most, gap - least);
}

// Place in a segment, on the curve, with the gap it says; gap below reach and never above that of ends and middle.
static void check_solid(tally* t, const ancf_cubic* c, int segments, double radius, const ancf_solid* s, double reach) {
    ancf_nearest found[16];
    const int n = ancf_nearest_solid(found, c, segments, radius, s, reach);
    int next = 0;
    for (int i = 0; i < segments; i++) {
        double least = INFINITY, coarse = INFINITY, p[3], normal[3];
        for (int j = 0; j <= SAMPLES; j++) {
            ancf_cubic_at(p, c, (i + (double)j / SAMPLES) / segments);
            const double gap = oracle(s, p) - radius;
            least = fmin(least, gap);
            if (j % (SAMPLES / 2) == 0) coarse = fmin(coarse, gap);
        }
        if (next == n || found[next].segment != i) {
            assert_true(coarse > reach - 1e-13);
            count(t, reach, least);
            continue;
        }
        const ancf_nearest* f = &found[next++];
        assert_true(f->xi >= (double)i / segments - 1e-15 && f->xi <= (i + 1.0) / segments + 1e-15);
        assert_true(f->gap < reach);
        ancf_cubic_at(p, c, f->xi);
        assert_near(distance(p, f->point), 0.0, 1e-15);
        assert_near(f->gap, oracle(s, p) - radius, 1e-14);
        assert_near(ancf_solid_distance(normal, s, p), f->gap + radius, 1e-15);
        assert_true(distance(normal, f->normal) < 1e-15);
        assert_true(f->gap < coarse + 1e-13);
        count(t, f->gap, least);
    }
    assert_int_equal(next, n);
}

static void cables_on_solids(void** state) {
    (void)state;
    tally t = {0};
    uint64_t seed = 2;
    for (int kind = 0; kind < KINDS; kind++)
        for (int i = 0; i < 4000; i++) {
            const ancf_solid s = random_solid((ancf_solid_kind)kind, &seed);
            const double size = kind == ANCF_WHEEL ? 0.07 : 1.0;
            ancf_cubic c = random_arc(&seed, 0.5, 1.0, 1.5);
            for (int j = 0; j < 4; j++)
                for (int k = 0; k < 3; k++) c.control[j][k] = s.center[k] + size * (c.control[j][k] - s.center[k]);
            const int segments = 2 + i % 7;
            check_solid(&t, &c, segments, size * random_magnitude(&seed, 0.001, 0.1), &s,
                        size * random_magnitude(&seed, 0.001, 2.0));
        }
    assert_true(t.places > 50000 && t.off <= 5 && t.most < 1e-3);
}

static void wild_cables_on_solids(void** state) {
    (void)state;
    tally t = {0};
    uint64_t seed = 3;
    for (int kind = 0; kind < KINDS; kind++)
        for (int i = 0; i < 2000; i++) {
            const ancf_solid s = random_solid((ancf_solid_kind)kind, &seed);
            const double size = kind == ANCF_WHEEL ? 0.1 : 1.0;
            ancf_cubic c = random_cubic(&seed, 0.3, 1.0, 0.8);
            for (int j = 0; j < 4; j++)
                for (int k = 0; k < 3; k++) c.control[j][k] = s.center[k] + size * (c.control[j][k] - s.center[k]);
            check_solid(&t, &c, 1 + i % 5, 0.01, &s, i % 3 ? 0.1 : 1.0);
        }
    assert_true(t.places > 20000 && t.off <= 10 && t.most < 0.01);
}

// A cable without length is a ball's centre, for cables of every bend.
static void cables_on_one_without_length(void** state) {
    (void)state;
    uint64_t seed = 15;
    int places = 0;
    for (int i = 0; i < 5000; i++) {
        const ancf_cubic c = random_cubic(&seed, 0.3, 1.0, 0.2 * (i % 5));
        ancf_solid ball = {.kind = ANCF_BALL, .size = {0.02}};
        for (int k = 0; k < 3; k++) ball.center[k] = random_between(&seed, -1.0, 1.0);
        const ancf_cubic point = line(ball.center, ball.center);
        ancf_nearest found[16];
        ancf_nearest_pair pair[16];
        const int segments = 1 + i % 7, n = ancf_nearest_solid(found, &c, segments, 0.01, &ball, 0.5);
        assert_int_equal(ancf_nearest_cubic(pair, &c, segments, 0.01, &point, 0.02, 0.5), n);
        for (int k = 0; k < n; k++) {
            assert_int_equal(pair[k].segment, found[k].segment);
            assert_near(pair[k].gap, found[k].gap, 1e-9);
        }
        places += n;
    }
    assert_true(places > 2000);
}

// Segments much longer than a groove is wide, across it: two flanges and what is between them, in one segment.
static void cables_across_narrow_grooves(void** state) {
    (void)state;
    static const ancf_groove narrow = {0.36, 0.0, 0.004, 1.39, 0.08, 0.004};
    tally t = {0};
    uint64_t seed = 16;
    for (int i = 0; i < 3000; i++) {
        ancf_solid s = random_solid(ANCF_WHEEL, &seed);
        s.groove = &narrow;
        ancf_cubic c = random_cubic(&seed, 0.0, 2.0, 0.1 * (i % 3));
        const double aside = random_between(&seed, 0.2, 0.5);
        for (int j = 0; j < 4; j++)
            for (int k = 0; k < 3; k++) c.control[j][k] += s.center[k] + aside * s.axis[1][k];
        check_solid(&t, &c, 3, 0.01, &s, 0.3);
    }
    assert_true(t.places > 5000 && t.off == 0);
}

static void check_pair(tally* t, const ancf_cubic* a, const ancf_cubic* b, int segments, double r1, double r2,
                       double reach) {
    ancf_nearest_pair found[16];
    const int n = ancf_nearest_cubic(found, a, segments, r1, b, r2, reach);
    static double there[SAMPLES + 1][3];
    for (int j = 0; j <= SAMPLES; j++) ancf_cubic_at(there[j], b, (double)j / SAMPLES);
    int next = 0;
    for (int i = 0; i < segments; i++) {
        double least = INFINITY, coarse = INFINITY;
        const int fine = 40;
        for (int j = 0; j <= fine; j++) {
            double p[3];
            ancf_cubic_at(p, a, (i + (double)j / fine) / segments);
            double here = INFINITY;
            for (int k = 0; k <= SAMPLES; k++) here = fmin(here, distance(p, there[k]) - r1 - r2);
            least = fmin(least, here);
            if (j % (fine / 2) == 0) coarse = fmin(coarse, here);
        }
        if (next == n || found[next].segment != i) {
            assert_true(coarse > reach - 1e-13);
            count(t, reach, least);
            continue;
        }
        const ancf_nearest_pair* f = &found[next++];
        double p[3], q[3], dp[3], dq[3];
        assert_true(f->xi[0] >= (double)i / segments - 1e-15 && f->xi[0] <= (i + 1.0) / segments + 1e-15);
        assert_true(f->xi[1] >= 0.0 && f->xi[1] <= 1.0);
        assert_true(f->gap < reach);
        ancf_cubic_at(p, a, f->xi[0]);
        ancf_cubic_at(q, b, f->xi[1]);
        ancf_cubic_slope(dp, a, f->xi[0]);
        ancf_cubic_slope(dq, b, f->xi[1]);
        assert_near(distance(p, f->point[0]) + distance(q, f->point[1]), 0.0, 1e-15);
        assert_near(f->gap, distance(p, q) - r1 - r2, 1e-15);
        assert_near(dot(f->normal, f->normal), 1.0, 1e-14);
        for (int k = 0; k < 3; k++) assert_near(p[k] - q[k], (f->gap + r1 + r2) * f->normal[k], 1e-13);
        assert_true(f->gap < coarse + 1e-13);
        count(t, f->gap, least);
        if (f->gap > least + 1e-11) continue;
        // Nearest for each alone: at right angles, or an end.
        const double w = f->gap + r1 + r2, low = (double)i / segments, high = (i + 1.0) / segments,
                     along = w * dot(f->normal, dp) / (1e-9 + dot(dp, dp)),
                     along2 = -w * dot(f->normal, dq) / (1e-9 + dot(dq, dq));
        const double place = 1e-9;
        if (f->xi[0] > low) assert_true(along < place);
        if (f->xi[0] < high) assert_true(along > -place);
        if (f->xi[1] > 0.0) assert_true(along2 < place);
        if (f->xi[1] < 1.0) assert_true(along2 > -place);
    }
    assert_int_equal(next, n);
}

static void cables_on_cables(void** state) {
    (void)state;
    tally t = {0};
    uint64_t seed = 6;
    for (int i = 0; i < 3000; i++) {
        const ancf_cubic a = random_arc(&seed, 0.3, 1.0, 1.5);
        ancf_cubic b = random_arc(&seed, 0.3, 1.0, 1.5);
        const double reach = random_magnitude(&seed, 0.001, 1.0), bend = 0.1 * (i % 4);
        if (i % 3 == 0) // beside the first, nearly parallel
            for (int j = 0; j < 4; j++)
                for (int k = 0; k < 3; k++)
                    b.control[j][k] = a.control[i % 2 ? j : 3 - j][k] + 0.05 + bend * random_between(&seed, -0.3, 0.3);
        check_pair(&t, &a, &b, 1 + i % 6, random_magnitude(&seed, 0.001, 0.1), 0.01, reach);
    }
    assert_true(t.places > 5000 && t.off == 0);
}

static void wild_cables_on_cables(void** state) {
    (void)state;
    tally t = {0};
    uint64_t seed = 7;
    for (int i = 0; i < 1500; i++) {
        const ancf_cubic a = random_cubic(&seed, 0.3, 1.0, 0.7), b = random_cubic(&seed, 0.3, 1.0, 0.7);
        check_pair(&t, &a, &b, 1 + i % 5, 0.01, 0.01, 0.3);
    }
    assert_true(t.places > 3000 && t.off <= 2 && t.most < 0.05);
}

// Arcs over the rims of plates, which they touch at two edges or a corner: the deeper place, but for what is allowed.
static void cables_over_rims(void** state) {
    (void)state;
    const double radius = 0.01;
    tally t = {0};
    uint64_t seed = 6;
    for (int i = 0; i < 20000; i++) {
        ancf_solid s = random_solid(i % 4 ? ANCF_BOX : ANCF_TRIANGLE, &seed);
        double rim[3];
        for (int k = 0; k < 3; k++)
            s.size[k] = k ? random_between(&seed, 0.2, 1.0) : random_magnitude(&seed, 0.01, 0.2);
        for (int k = 0; k < 3; k++) {
            rim[k] = 0.5 * (s.corner[0][k] + s.corner[1 + i % 2][k]);
            if (s.kind == ANCF_BOX) {
                rim[k] = s.center[k];
                for (int j = 1; j < 3; j++)
                    rim[k] +=
                        s.axis[j][k] * s.size[j] * (j == 1 || i % 8 == 1 ? 1.0 : random_between(&seed, -1.0, 1.0));
            }
        }
        ancf_cubic c = random_arc(&seed, 0.0, 1.0, 1.0);
        double middle[3], off[3];
        ancf_cubic_at(middle, &c, 0.5);
        for (int k = 0; k < 3; k++) off[k] = rim[k] - middle[k] + random_between(&seed, -1.0, 1.0) * 2.0 * radius;
        for (int j = 0; j < 4; j++)
            for (int k = 0; k < 3; k++) c.control[j][k] += off[k];
        check_solid(&t, &c, 1 + i % 5, radius, &s, radius);
    }
    assert_true(t.places > 50000 && t.off <= 5 && t.most < 1e-3 * radius);
}

// Chord of a sphere, two lines askew, and a line beside a box: in closed form.
static void straight_lines(void** state) {
    (void)state;
    uint64_t seed = 8;
    ancf_nearest found[SEGMENTS];
    ancf_nearest_pair pair[SEGMENTS];
    for (int i = 0; i < 5000; i++) {
        double axis[3][3], a[3], b[3], c[3], d[3];
        random_axes(axis, &seed);
        const double height = random_between(&seed, 0.05, 0.5), where = random_between(&seed, 0.01, 0.99),
                     where2 = random_between(&seed, 0.01, 0.99), angle = random_between(&seed, 0.05, 3.1);
        ancf_solid ball = {.kind = ANCF_BALL, .size = {0.03}};
        for (int k = 0; k < 3; k++) {
            ball.center[k] = random_between(&seed, -5.0, 5.0);
            a[k] = ball.center[k] + height * axis[2][k] - where * axis[0][k];
            b[k] = a[k] + axis[0][k];
            const double way = cos(angle) * axis[0][k] + sin(angle) * axis[1][k];
            c[k] = ball.center[k] - where2 * way;
            d[k] = c[k] + way;
        }
        const ancf_cubic first = line(a, b), second = line(c, d);
        const int in = (int)(where * SEGMENTS);
        int n = ancf_nearest_solid(found, &first, SEGMENTS, 0.01, &ball, 2.0);
        assert_int_equal(n, SEGMENTS);
        assert_near(found[in].xi, where, 1e-9);
        assert_near(found[in].gap, height - 0.04, 1e-14);
        for (int k = 0; k < 3; k++) assert_near(found[in].normal[k], axis[2][k], 1e-8);
        for (int j = 0; j < SEGMENTS; j++) {
            const double near = fmin((j + 1.0) / SEGMENTS, fmax((double)j / SEGMENTS, where));
            assert_near(found[j].xi, near, 1e-9);
            assert_near(found[j].gap, hypot(height, near - where) - 0.04, 1e-14);
        }
        assert_int_equal(ancf_nearest_solid(found, &first, SEGMENTS, 0.01, &ball, height - 0.04 - 1e-12), 0);
        assert_true(ancf_nearest_solid(found, &first, SEGMENTS, 0.01, &ball, height - 0.04 + 1e-12) >= 1);

        n = ancf_nearest_cubic(pair, &first, SEGMENTS, 0.01, &second, 0.02, 2.0);
        assert_int_equal(n, SEGMENTS);
        assert_near(pair[in].xi[0], where, 1e-9);
        assert_near(pair[in].xi[1], where2, 1e-9);
        assert_near(pair[in].gap, height - 0.03, 1e-14);
        for (int k = 0; k < 3; k++) assert_near(pair[in].normal[k], axis[2][k], 1e-8);
        assert_int_equal(ancf_nearest_cubic(pair, &first, SEGMENTS, 0.01, &second, 0.02, height - 0.03 - 1e-12), 0);
        assert_true(ancf_nearest_cubic(pair, &first, SEGMENTS, 0.01, &second, 0.02, height - 0.03 + 1e-12) >= 1);
    }
}

// A cable along something is held in the middle of its segments, not where rounding falls.
static void along_is_held_in_the_middle(void** state) {
    (void)state;
    ancf_nearest found[SEGMENTS];
    ancf_nearest_pair pair[SEGMENTS];
    uint64_t seed = 10;
    for (int i = 0; i < 2000; i++) {
        double axis[3][3], a[3], b[3], c[3], d[3];
        random_axes(axis, &seed);
        ancf_solid s = {.kind = ANCF_BOX, .size = {2.0, 2.0, 0.3}}, plane = {.kind = ANCF_PLANE, .sense = 1 - i % 3};
        const double side = plane.sense < 0 ? -1.0 : 1.0;
        for (int k = 0; k < 3; k++) {
            s.center[k] = plane.center[k] = random_between(&seed, -5.0, 5.0);
            plane.axis[0][k] = side * axis[2][k];
            a[k] = s.center[k] + 0.32 * axis[2][k] - 0.5 * axis[0][k];
            b[k] = a[k] + axis[0][k];
            c[k] = a[k] + 0.05 * axis[1][k] - 0.25 * axis[0][k];
            d[k] = c[k] + (i % 2 ? 2.0 : 1.25) * axis[0][k];
        }
        memcpy(s.axis, axis, sizeof axis);
        const ancf_cubic first = line(a, b), second = i % 2 ? line(c, d) : line(d, c);
        assert_int_equal(ancf_nearest_solid(found, &first, SEGMENTS, 0.01, &s, 0.1), SEGMENTS);
        for (int j = 0; j < SEGMENTS; j++) {
            assert_near(found[j].xi, (j + 0.5) / SEGMENTS, 0.0);
            assert_near(found[j].gap, 0.01, 1e-14);
        }
        assert_int_equal(ancf_nearest_solid(found, &first, SEGMENTS, 0.01, &plane, 0.5), SEGMENTS);
        for (int j = 0; j < SEGMENTS; j++) {
            assert_near(found[j].xi, (j + 0.5) / SEGMENTS, 0.0);
            assert_near(found[j].gap, 0.31, 1e-14);
        }
        assert_int_equal(ancf_nearest_cubic(pair, &first, SEGMENTS, 0.01, &second, 0.02, 0.1), SEGMENTS);
        for (int j = 0; j < SEGMENTS; j++) {
            assert_near(pair[j].xi[0], (j + 0.5) / SEGMENTS, 0.0);
            assert_near(pair[j].gap, 0.02, 1e-14);
            for (int k = 0; k < 3; k++) assert_near(pair[j].normal[k], -axis[1][k], 1e-12);
        }
    }
}

static void move(double to[3], const double from[3], double turn[3][3], const double shift[3]) {
    for (int k = 0; k < 3; k++) to[k] = shift[k] + dot(turn[k], from);
}

static ancf_cubic moved_cubic(const ancf_cubic* c, double turn[3][3], const double shift[3]) {
    ancf_cubic m;
    for (int i = 0; i < 4; i++) move(m.control[i], c->control[i], turn, shift);
    return m;
}

static void gaps_move_with_the_scene(void** state) {
    (void)state;
    uint64_t seed = 11;
    const double none[3] = {0.0, 0.0, 0.0};
    for (int i = 0; i < 10000; i++) {
        double turn[3][3], shift[3];
        random_axes(turn, &seed);
        for (int k = 0; k < 3; k++) shift[k] = random_between(&seed, -3.0, 3.0);
        const ancf_solid s = random_solid((ancf_solid_kind)(i % KINDS), &seed);
        const ancf_cubic c = random_arc(&seed, 0.3, s.kind == ANCF_WHEEL ? 0.2 : 1.0, 1.0);
        ancf_solid t = s;
        move(t.center, s.center, turn, shift);
        for (int j = 0; j < 3; j++) {
            move(t.corner[j], s.corner[j], turn, shift);
            move(t.axis[j], s.axis[j], turn, none);
        }
        const ancf_cubic d = moved_cubic(&c, turn, shift);
        ancf_nearest one[SEGMENTS], two[SEGMENTS];
        const int n = ancf_nearest_solid(one, &c, SEGMENTS, 0.01, &s, 0.2);
        assert_int_equal(ancf_nearest_solid(two, &d, SEGMENTS, 0.01, &t, 0.2), n);
        for (int j = 0; j < n; j++) assert_near(one[j].gap, two[j].gap, 1e-11);
        const ancf_cubic e = random_arc(&seed, 0.3, 1.0, 1.0), f = moved_cubic(&e, turn, shift);
        ancf_nearest_pair first[SEGMENTS], second[SEGMENTS];
        const int m = ancf_nearest_cubic(first, &c, SEGMENTS, 0.01, &e, 0.01, 0.2);
        assert_int_equal(ancf_nearest_cubic(second, &d, SEGMENTS, 0.01, &f, 0.01, 0.2), m);
        for (int j = 0; j < m; j++) assert_near(first[j].gap, second[j].gap, 1e-11);
    }
}

static void degenerate_cables(void** state) {
    (void)state;
    tally t = {0};
    const double o[3] = {0.0, 0.0, 0.0}, x[3] = {1.0, 0.0, 0.0}, y[3] = {0.0, 1.0, 0.0}, z[3] = {0.5, 0.0, 0.0},
                 w[3] = {2.0, 0.0, 0.0}, up[3] = {0.3, 0.5, 0.0}, down[3] = {0.3, -0.5, 0.0};
    ancf_cubic stopped = line(o, x), loop = line(o, x);
    memcpy(stopped.control[1], o, sizeof o); // no speed at its ends
    memcpy(stopped.control[2], x, sizeof x);
    memcpy(loop.control[1], w, sizeof w); // back on itself
    memcpy(loop.control[2], down, sizeof down);
    const ancf_cubic all[] = {line(o, x), line(x, o), line(o, y),     line(z, z), line(o, o),
                              line(z, w), line(x, w), line(up, down), stopped,    loop};
    enum { N = sizeof all / sizeof all[0] };
    for (int i = 0; i < N; i++)
        for (int j = 0; j < N; j++) {
            ancf_nearest_pair pair[SEGMENTS];
            const int n = ancf_nearest_cubic(pair, &all[i], SEGMENTS, 0.01, &all[j], 0.01, 2.0);
            assert_int_equal(n, SEGMENTS);
            check_pair(&t, &all[i], &all[j], SEGMENTS, 0.01, 0.01, 2.0);
        }
    // Across each other: at a right angle to the first.
    ancf_nearest_pair pair[SEGMENTS];
    assert_int_equal(ancf_nearest_cubic(pair, &all[0], SEGMENTS, 0.01, &all[7], 0.01, 0.01), 1);
    assert_near(pair[0].xi[0], 0.3, 1e-9);
    assert_near(pair[0].xi[1], 0.5, 1e-9);
    assert_near(pair[0].gap, -0.02, 1e-9);
    assert_near(pair[0].normal[0], 0.0, 1e-15);
    // A cable without length near a ball, and a ball's centre on a cable.
    ancf_nearest found[SEGMENTS];
    ancf_solid ball = {.kind = ANCF_BALL, .center = {0.5, 0.2, 0.0}, .size = {0.1}};
    assert_int_equal(ancf_nearest_solid(found, &all[3], SEGMENTS, 0.01, &ball, 0.1), SEGMENTS);
    for (int k = 0; k < SEGMENTS; k++) assert_near(found[k].gap, 0.09, 1e-15);
    ball.center[1] = 0.0;
    assert_int_equal(ancf_nearest_solid(found, &all[0], SEGMENTS, 0.01, &ball, 0.01), 2);
    for (int k = 0; k < 2; k++) {
        assert_near(found[k].gap, -0.11, 1e-15);
        assert_near(dot(found[k].normal, found[k].normal), 1.0, 1e-15);
    }
    // An arc about the ball's centre: everywhere as near.
    const double q = 0.5522847498307936;
    const ancf_cubic arc = {{{1.0, 0.0, 0.0}, {1.0, q, 0.0}, {q, 1.0, 0.0}, {0.0, 1.0, 0.0}}};
    ball = (ancf_solid) {.kind = ANCF_BALL, .size = {0.9}};
    check_solid(&t, &arc, SEGMENTS, 0.05, &ball, 0.1);
    assert_int_equal(t.off, 0);
    assert_int_equal(ancf_nearest_solid(found, &arc, SEGMENTS, 0.05, &ball, 0.1), SEGMENTS);
}

static void same_in_same_out(void** state) {
    (void)state;
    uint64_t seed = 12;
    for (int i = 0; i < 1000; i++) {
        const ancf_cubic a = random_arc(&seed, 0.2, 1.0, 1.0), b = random_arc(&seed, 0.2, 1.0, 1.0);
        ancf_nearest_pair one[SEGMENTS], two[SEGMENTS];
        memset(one, 0, sizeof one);
        memset(two, 0xff, sizeof two);
        const int n = ancf_nearest_cubic(one, &a, SEGMENTS, 0.01, &b, 0.01, 0.5);
        assert_int_equal(ancf_nearest_cubic(two, &a, SEGMENTS, 0.01, &b, 0.01, 0.5), n);
        for (int j = 0; j < n; j++) {
            assert_true(one[j].gap == two[j].gap && one[j].xi[0] == two[j].xi[0] && one[j].xi[1] == two[j].xi[1]);
            for (int k = 0; k < 3; k++) assert_true(one[j].normal[k] == two[j].normal[k]);
        }
    }
}

// Places of some segments are those of all, to the last bit, and a smaller reach only leaves places out.
static void segments_by_themselves(void** state) {
    (void)state;
    uint64_t seed = 14;
    int left_out = 0;
    for (int i = 0; i < 2000; i++) {
        const ancf_cubic a = random_arc(&seed, 0.2, 1.0, 1.0), b = random_arc(&seed, 0.2, 1.0, 1.0);
        const uint64_t which = (uint64_t)i % (1 << SEGMENTS);
        const double far = 0.3, reach = i % 2 ? far : 0.1;
        ancf_nearest_pair all[SEGMENTS], some[SEGMENTS];
        const int n = ancf_nearest_cubic(all, &a, SEGMENTS, 0.01, &b, 0.02, far),
                  m = ancf_nearest_segments(some, &a, SEGMENTS, which, 0.01, &b, 0.02, reach, far);
        int k = 0;
        for (int j = 0; j < n; j++) {
            if (!(which >> all[j].segment & 1)) continue;
            if (!(all[j].gap < reach)) {
                left_out++;
                continue;
            }
            assert_true(k < m && some[k].segment == all[j].segment && some[k].gap == all[j].gap);
            assert_true(some[k].xi[0] == all[j].xi[0] && some[k].xi[1] == all[j].xi[1]);
            k++;
        }
        assert_int_equal(k, m);
    }
    assert_true(left_out > 100);
}

// No point of a curve is nearer than its least distance, which is near for curves that bend little.
static void least_distances(void** state) {
    (void)state;
    uint64_t seed = 41;
    double loosest = 0.0;
    for (int run = 0; run < 4000; ++run) {
        const double bend = run % 2 ? 0.02 : 0.5;
        const ancf_cubic c = random_cubic(&seed, 0.3, 1.0, bend);
        double point[3], at[3], least = INFINITY;
        for (int k = 0; k < 3; k++) point[k] = random_between(&seed, -2.0, 2.0);
        for (int i = 0; i <= SAMPLES; i++) {
            ancf_cubic_at(at, &c, (double)i / SAMPLES);
            least = fmin(least, distance(at, point));
        }
        const double told = ancf_nearest_least(&c, point);
        assert_true(told <= least);
        if (bend < 0.1) loosest = fmax(loosest, least - told);
    }
    assert_true(loosest < 0.026); // |r''| <= 0.83, on halves: an eighth of a quarter
}

static void curves_and_slopes(void** state) {
    (void)state;
    uint64_t seed = 13;
    for (int i = 0; i < 1000; i++) {
        const ancf_cubic c = random_cubic(&seed, 3.0, 1.0, 1.0);
        const double xi = random_between(&seed, 0.01, 0.99), h = 1e-6;
        double p[4][3], r[3], up[3], down[3], dr[3];
        memcpy(p, c.control, sizeof p);
        for (int n = 3; n > 0; n--) // de Casteljau
            for (int j = 0; j < n; j++)
                for (int k = 0; k < 3; k++) p[j][k] += xi * (p[j + 1][k] - p[j][k]);
        ancf_cubic_at(r, &c, xi);
        ancf_cubic_at(up, &c, xi + h);
        ancf_cubic_at(down, &c, xi - h);
        ancf_cubic_slope(dr, &c, xi);
        for (int k = 0; k < 3; k++) {
            assert_near(r[k], p[0][k], 1e-14);
            assert_near(dr[k], (up[k] - down[k]) / (2.0 * h), 1e-8);
        }
        ancf_cubic_at(r, &c, 0.0);
        ancf_cubic_at(up, &c, 1.0);
        for (int k = 0; k < 3; k++) assert_true(r[k] == c.control[0][k] && up[k] == c.control[3][k]);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(distances_of_solids),
        cmocka_unit_test(distances_by_hand),
        cmocka_unit_test(planar_stays_planar),
        cmocka_unit_test(cables_on_solids),
        cmocka_unit_test(wild_cables_on_solids),
        cmocka_unit_test(cables_on_one_without_length),
        cmocka_unit_test(cables_across_narrow_grooves),
        cmocka_unit_test(cables_over_rims),
        cmocka_unit_test(cables_on_cables),
        cmocka_unit_test(wild_cables_on_cables),
        cmocka_unit_test(straight_lines),
        cmocka_unit_test(along_is_held_in_the_middle),
        cmocka_unit_test(gaps_move_with_the_scene),
        cmocka_unit_test(degenerate_cables),
        cmocka_unit_test(same_in_same_out),
        cmocka_unit_test(least_distances),
        cmocka_unit_test(curves_and_slopes),
        cmocka_unit_test(segments_by_themselves),
    };
    return cmocka_run_group_tests_name("nearest", tests, NULL, NULL);
}
