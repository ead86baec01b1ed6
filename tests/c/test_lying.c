// How a segment that lies along something is held: one depth, its derivatives, the mean place.
#include "check.h"

#include "ancf/cover.h"
#include "ancf/law.h"
#include "ancf/lying.h"
#include "ancf/shape.h"
#include <string.h>

static const double weight[4] = {0.1739274225687269, 0.3260725774312731, 0.3260725774312731, 0.1739274225687269};

// A deepest place, and depths along the segment that are none deeper.
static void random_spots(ancf_spot spot[ANCF_LYING_SPOTS], uint64_t* seed) {
    const double flat = random_unit(seed);
    spot[0] = (ancf_spot) {.xi = random_unit(seed), .depth = random_between(seed, 0.7, 1.0)};
    ancf_lying_along(spot, 0, 1);
    for (int i = 1; i < ANCF_LYING_SPOTS; ++i) spot[i].depth = spot[0].depth * random_between(seed, flat, 1.0);
}

// The depth of a uniform profile is 1.2 times it, and that of a single place is its own.
static void limits(void** state) {
    (void)state;
    ancf_spot spot[ANCF_LYING_SPOTS] = {{.xi = 0.45, .depth = 0.4}};
    double spread;
    ancf_lying_along(spot, 2, 5);
    assert_close(spot[1].xi, 0.6, 1e-15);
    for (int i = ANCF_LYING_FIRST; i < ANCF_LYING_SPOTS; ++i) assert_true(spot[i].xi > 0.4 && spot[i].xi < 0.6);
    assert_close(ancf_lying_depth(spot, &spread), 0.4, 1e-15);
    assert_true(spread == 0.0 && spot[0].part == 1.0 && spot[1].part == 0.0 && spot[2].part == 0.0);
    for (int i = 1; i < ANCF_LYING_SPOTS; ++i) spot[i].depth = 0.4;
    assert_close(ancf_lying_depth(spot, &spread), 0.48, 0.01); // two equal ends are a little more than one
    for (int i = ANCF_LYING_FIRST; i < ANCF_LYING_SPOTS; ++i) assert_true(spot[i].part > weight[i - ANCF_LYING_FIRST]);
    assert_true(spread > 0.9 && spot[0].part < 0.1);
}

// Parts are derivatives of the one depth, by finite differences, and it is homogeneous: the sum of parts times depths.
static void parts_are_derivatives(void** state) {
    (void)state;
    uint64_t seed = 11;
    int spread_some = 0, ends = 0;
    for (int run = 0; run < 3000; ++run) {
        ancf_spot spot[ANCF_LYING_SPOTS], moved[ANCF_LYING_SPOTS];
        random_spots(spot, &seed);
        double spread, sum = 0.0, off, two[2];
        const double depth = ancf_lying_depth(spot, &spread);
        for (int i = 0; i < ANCF_LYING_SPOTS; ++i) {
            sum += spot[i].part * spot[i].depth;
            assert_true(spot[i].part >= 0.0);
            for (int k = 0; k < 2; ++k) {
                memcpy(moved, spot, sizeof moved);
                moved[i].depth += k ? 1e-6 : -1e-6;
                two[k] = ancf_lying_depth(moved, &off);
            }
            assert_near((two[1] - two[0]) / 2e-6, spot[i].part, 3e-5); // second derivatives jump
        }
        assert_close(sum, depth, 1e-12);
        spread_some += spread > 0.0 && spread < 1.0;
        ends += spot[1].part > 0.0;
    }
    assert_true(spread_some > 300 && ends > 300);
}

static ancf_cubic bent(double tilt, double sag) {
    ancf_cubic c = {{{0.0}}};
    for (int k = 0; k < 4; ++k) {
        c.control[k][0] = k / 3.0;
        c.control[k][2] = tilt * (k / 3.0 - 0.5) + (k == 1 || k == 2 ? sag : 0.0);
    }
    return c;
}

static const ancf_cover cover = {.radius = 0.1, .segments = 1};
static const ancf_solid floor_plane = {.kind = ANCF_PLANE, .axis = {{0.0, 0.0, 1.0}}, .sense = 1};

static ancf_nearest held(ancf_cubic c, double depth, double more) {
    ancf_nearest found;
    for (int k = 0; k < 4; ++k) c.control[k][2] += 0.1 - depth;
    assert_int_equal(ancf_cover_touch(&found, &cover, &c, &floor_plane, more + 1e-3), 1);
    ancf_lying_on(&found, &c, cover.segments, cover.radius, &floor_plane, more);
    return found;
}

// A segment that rocks on a floor: its nearest place jumps from end to end, what holds it does not.
static void rocking_moves_the_place_little(void** state) {
    (void)state;
    const double depth = 1e-3;
    ancf_nearest last = held(bent(-2e-3, 0.0), depth, 0.0);
    assert_true(last.xi == 0.0 || last.xi == 1.0); // one end alone holds it
    for (double tilt = -2e-3; tilt <= 2e-3; tilt += 1e-6) {
        const ancf_nearest now = held(bent(tilt, 0.0), depth, 0.0);
        assert_near(now.xi, last.xi, 2e-3);
        assert_near(now.gap, last.gap, 2e-6);
        last = now;
    }
    assert_near(held(bent(0.0, 0.0), depth, 0.0).xi, 0.5, 1e-12);
}

// Work along a path of tilt, height and sag is the difference of elastic energies: force times displacement of the
// place, with the law's share.
static void work_is_energy(void** state) {
    (void)state;
    const ancf_normal law = {ANCF_NORMAL_HERTZ, 1e6, 1.5, 0.0};
    const int steps = 20000;
    double work = 0.0, before = 0.0, most = 0.0;
    double last[3] = {0.0};
    for (int i = 0; i <= 2 * steps; ++i) {
        // Places for the way of a step are those of its middle.
        const double t = (double)i / (2 * steps);
        const double tilt = 3e-3 * sin(9.0 * t), depth = 2e-3 * (1.0 - 0.9 * t), sag = 1e-3 * sin(5.0 * t);
        const ancf_nearest now = held(bent(tilt, sag), depth, 0.0);
        const ancf_normal own = ancf_normal_shared(&law, now.share);
        if (i % 2) {
            last[0] = ancf_normal_force(&own, -now.gap, 0.0);
            last[1] = now.power[0];
            last[2] = now.power[1];
            continue;
        }
        const double energy = ancf_normal_energy(&own, -now.gap);
        most = fmax(most, energy);
        if (i > 0) {
            const double s = (double)(i - 2) / (2 * steps), tilt0 = 3e-3 * sin(9.0 * s),
                         depth0 = 2e-3 * (1.0 - 0.9 * s), sag0 = 1e-3 * sin(5.0 * s);
            // Height at xi: tilt (xi - 1/2) + 3 sag xi (1 - xi) - depth.
            const double way =
                (tilt - tilt0) * (last[1] - 0.5) + 3.0 * (sag - sag0) * (last[1] - last[2]) - (depth - depth0);
            work += last[0] * way;
            assert_near(work, before - energy, 1e-5 * most);
        } else {
            before = energy;
        }
    }
    assert_true(most > 0.0);
}

// The mean place is one on the centreline's mean, and velocities there are the same means.
static void means_of_weights(void** state) {
    (void)state;
    uint64_t seed = 12;
    const double L = 0.7;
    for (int run = 0; run < 100; ++run) {
        double power[3] = {0.0}, mean[4] = {0.0}, S[4];
        for (int i = 0; i < 5; ++i) {
            const double xi = random_unit(&seed);
            ancf_shape(S, xi, L);
            for (int k = 0; k < 4; ++k) mean[k] += S[k] / 5.0;
            power[0] += xi / 5.0;
            power[1] += xi * xi / 5.0;
            power[2] += xi * xi * xi / 5.0;
        }
        ancf_shape_mean(S, power, L);
        for (int k = 0; k < 4; ++k) assert_near(S[k], mean[k], 1e-14);
    }
    const ancf_nearest place = held(bent(1e-3, 5e-4), 2e-3, 0.0);
    assert_true(place.share > 1.0 && place.share <= 1.2 + 1e-12);
    assert_near(place.point[0], place.xi, 1e-14);
}

// A share of a law: depth and force as they act on the place.
static void shared_laws(void** state) {
    (void)state;
    const ancf_normal laws[] = {{ANCF_NORMAL_LINEAR, 3e4, 1.5, 20.0},
                                {ANCF_NORMAL_HERTZ, 1e6, 1.5, 0.0},
                                {ANCF_NORMAL_NONLINEAR, 1e6, 2.0, 0.3}};
    for (int i = 0; i < 3; ++i) {
        const ancf_normal own = ancf_normal_shared(&laws[i], 1.17);
        assert_close(ancf_normal_force(&own, 0.01, 0.2), 1.17 * ancf_normal_force(&laws[i], 0.0117, 1.17 * 0.2), 1e-13);
        assert_close(ancf_normal_energy(&own, 0.01), ancf_normal_energy(&laws[i], 0.0117), 1e-13);
    }
}

// What falls flat on a floor is held along all of its length before it touches.
static void falls_flat(void** state) {
    (void)state;
    const ancf_nearest place = held(bent(1e-6, 0.0), -1e-4, 3e-4);
    assert_near(place.xi, 0.5, 1e-3);
    assert_near(place.gap, 1e-4, 1e-6);
    assert_near(place.share, 1.2, 1e-5);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(limits),
        cmocka_unit_test(parts_are_derivatives),
        cmocka_unit_test(rocking_moves_the_place_little),
        cmocka_unit_test(work_is_energy),
        cmocka_unit_test(means_of_weights),
        cmocka_unit_test(shared_laws),
        cmocka_unit_test(falls_flat),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
