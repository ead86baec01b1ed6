// Groove of a sheave, bearing and guide: closed forms.
#include "check.h"

#include "ancf/rotor.h"
#include "ancf/sheave.h"

static const double pi = 3.14159265358979323846;

static const ancf_groove round_groove = {0.05, 0.0, 0.005, 1.57079632679489661923, 0.005, 0.002};
static const ancf_groove flanged = {0.05, 0.003, 0.002, 1.57079632679489661923, 0.006, 0.002};
static const ancf_groove vee = {0.05, 0.0, 0.002, 1.1, 0.01, 0.001};
static const ancf_groove plain = {0.05, 0.01, 0.0, 1.57079632679489661923, 0.0, 0.0};

static void grooves_are_checked(void** state) {
    (void)state;
    const ancf_groove* good[] = {&round_groove, &flanged, &vee, &plain};
    for (int i = 0; i < 4; i++) assert_int_equal(ancf_groove_check(good[i]), ANCF_OK);
    ancf_groove bad = round_groove;
    bad.radius = 0.0;
    assert_int_equal(ancf_groove_check(&bad), ANCF_E_GROOVE);
    bad = round_groove;
    bad.height = 0.004; // the lip below the end of the arc
    assert_int_equal(ancf_groove_check(&bad), ANCF_E_GROOVE);
    bad = round_groove;
    bad.slope = 2.0;
    assert_int_equal(ancf_groove_check(&bad), ANCF_E_GROOVE);
    bad = flanged;
    bad.land = NAN;
    assert_int_equal(ancf_groove_check(&bad), ANCF_E_GROOVE);
    assert_near(ancf_groove_opening(&round_groove), 0.005, 1e-15);
    assert_near(ancf_groove_half_width(&flanged), 0.007, 1e-15);
    assert_near(ancf_groove_curvature(&flanged), 10.0, 1e-12);
    assert_near(ancf_groove_curvature(&round_groove), 10.0 - 100.0, 1e-12);
}

static void distances_by_hand(void** state) {
    (void)state;
    double g[2];
    assert_near(ancf_groove_distance(g, &round_groove, 0.0, 0.002), 0.002, 1e-15);   // over the bottom
    assert_near(ancf_groove_distance(g, &round_groove, 0.003, 0.005), 0.002, 1e-15); // beside the arc's centre
    assert_near(g[0], -1.0, 1e-12);
    assert_near(ancf_groove_distance(g, &flanged, 0.004, 0.005), 0.001, 1e-15); // beside the wall
    assert_near(g[0], -1.0, 1e-12);
    assert_near(ancf_groove_distance(g, &flanged, 0.006, 0.009), 0.003, 1e-15); // over the land
    assert_near(g[1], 1.0, 1e-12);
    assert_near(ancf_groove_distance(g, &flanged, 0.010, 0.0), 0.003, 1e-15);   // beside the sheave
    assert_near(ancf_groove_distance(g, &flanged, 0.010, 0.010), 0.005, 1e-15); // off its edge
    assert_near(g[0], 0.6, 1e-12);
    assert_near(ancf_groove_distance(g, &flanged, 0.0, -0.001), -0.001, 1e-15); // inside
    assert_near(ancf_groove_distance(g, &plain, 0.013, 0.004), 0.005, 1e-15);
}

// |gradient| = 1, it is the derivative of the distance, and both are continuous along any line through the groove.
static void distance_is_smooth(void** state) {
    (void)state;
    const ancf_groove* all[] = {&round_groove, &flanged, &vee};
    uint64_t seed = 5;
    const double h = 1e-8, ball = 0.0015; // smaller than every fillet
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 20000; i++) {
            const double u = random_between(&seed, 0.0, 0.99 * ancf_groove_opening(all[k]));
            const double q = random_between(&seed, 0.0, 0.008);
            double g[2], other[2];
            const double d = ancf_groove_distance(g, all[k], u, q);
            if (d < 0.0 || d > ball) continue;
            assert_near(g[0] * g[0] + g[1] * g[1], 1.0, 1e-12);
            const double up = ancf_groove_distance(other, all[k], u, q + h);
            assert_near((up - d) / h, g[1], 1e-4);
            assert_near(other[0], g[0], 1e-3);
            const double aside = ancf_groove_distance(other, all[k], u + h, q);
            assert_near((aside - d) / h, g[0], 1e-4);
        }
}

static void contact_turns_with_the_axis(void** state) {
    (void)state;
    uint64_t seed = 9;
    for (int i = 0; i < 1000; i++) {
        const double a = random_between(&seed, 0.0, 2.0 * pi), z = random_between(&seed, -0.004, 0.004),
                     rho = random_between(&seed, 0.05, 0.054);
        const double along_z[3] = {0.0, 0.0, 1.0}, along_x[3] = {1.0, 0.0, 0.0};
        const double p[3] = {rho * cos(a), rho * sin(a), z}, q[3] = {z, rho * cos(a), rho * sin(a)};
        ancf_groove_contact one, two;
        ancf_groove_touch(&one, &round_groove, along_z, p, 0.003);
        ancf_groove_touch(&two, &round_groove, along_x, q, 0.003);
        assert_near(one.depth, two.depth, 1e-15);
        for (int c = 0; c < 3; c++) assert_near(one.normal[c], two.normal[(c + 1) % 3], 1e-12);
        // Nothing turns it about the axis.
        assert_near(p[0] * one.normal[1] - p[1] * one.normal[0], 0.0, 1e-15);
    }
}

// The normal is where the depth falls fastest: by as much as the ball moves along it, on either side of the groove.
static void normal_is_the_gradient(void** state) {
    (void)state;
    const double axis[3] = {0.0, 0.6, 0.8}, h = 1e-7;
    uint64_t seed = 10;
    int sides[2] = {0, 0};
    for (int i = 0; i < 2000; i++) {
        double p[3];
        for (int c = 0; c < 3; c++) p[c] = random_between(&seed, -0.055, 0.055);
        ancf_groove_contact now, up, down;
        ancf_groove_touch(&now, &flanged, axis, p, 0.003);
        const double z = p[1] * axis[1] + p[2] * axis[2];
        if (fabs(now.depth) > 0.002 || fabs(z) < 2.0 * h) continue;
        double gradient[3];
        for (int c = 0; c < 3; c++) {
            double q[3] = {p[0], p[1], p[2]};
            q[c] += h;
            ancf_groove_touch(&up, &flanged, axis, q, 0.003);
            q[c] -= 2.0 * h;
            ancf_groove_touch(&down, &flanged, axis, q, 0.003);
            gradient[c] = (up.depth - down.depth) / (2.0 * h);
        }
        const double size = sqrt(gradient[0] * gradient[0] + gradient[1] * gradient[1] + gradient[2] * gradient[2]);
        if (fabs(size - 1.0) > 1e-5) continue; // across a ridge
        for (int c = 0; c < 3; c++) assert_near(now.normal[c], -gradient[c], 1e-5);
        sides[z < 0.0]++;
    }
    assert_true(sides[0] > 10 && sides[1] > 10);
}

static void planar_stays_planar(void** state) {
    (void)state;
    const double axis[3] = {0.0, 1.0, 0.0};
    for (int i = 0; i < 360; i++) {
        const double p[3] = {0.052 * cos(i), 0.0, 0.052 * sin(i)};
        ancf_groove_contact c;
        ancf_groove_touch(&c, &round_groove, axis, p, 0.003);
        assert_true(c.normal[1] == 0.0);
        assert_near(c.depth, 0.001, 1e-15);
    }
}

static void rotor_runs_down(void** state) {
    (void)state;
    const ancf_rotor viscous = {2.0, 0.5, 0.0};
    double speed = 3.0, friction;
    for (int i = 0; i < 100000; i++) speed = ancf_rotor_step(&friction, &viscous, speed, 0.0, 1e-5);
    assert_close(speed, 3.0 * exp(-0.25), 1e-5);
    for (int i = 0; i < 10000; i++) speed = ancf_rotor_step(&friction, &viscous, speed, 1.0, 1.0); // stiff
    assert_close(speed, 2.0, 1e-12);
}

static void dry_friction_holds(void** state) {
    (void)state;
    const ancf_rotor dry = {2.0, 0.1, 0.3};
    double friction;
    assert_true(ancf_rotor_step(&friction, &dry, 0.0, 0.29, 1e-3) == 0.0);
    assert_near(friction, -0.29, 1e-15);
    assert_true(ancf_rotor_step(&friction, &dry, 0.0, -0.29, 1e-3) == 0.0);
    assert_true(ancf_rotor_step(&friction, &dry, 0.0, 0.31, 1e-3) > 0.0);
    assert_near(friction, -0.3, 1e-15);
    double speed = 1.0;
    int steps = 0;
    const ancf_rotor brake = {2.0, 0.0, 0.5};
    while (speed > 0.0 && steps < 100000) {
        speed = ancf_rotor_step(&friction, &brake, speed, 0.0, 1e-3);
        steps++;
    }
    assert_near(1e-3 * steps, 4.0, 2e-3);
    assert_true(speed == 0.0);
    const ancf_rotor bad[] = {{0.0, 0.0, 0.0}, {1.0, -1.0, 0.0}, {1.0, 0.0, NAN}};
    assert_int_equal(ancf_rotor_check(&bad[0]), ANCF_E_INERTIA);
    assert_int_equal(ancf_rotor_check(&bad[1]), ANCF_E_BEARING);
    assert_int_equal(ancf_rotor_check(&bad[2]), ANCF_E_BEARING);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(grooves_are_checked),    cmocka_unit_test(distances_by_hand),
        cmocka_unit_test(distance_is_smooth),     cmocka_unit_test(contact_turns_with_the_axis),
        cmocka_unit_test(normal_is_the_gradient), cmocka_unit_test(planar_stays_planar),
        cmocka_unit_test(rotor_runs_down),        cmocka_unit_test(dry_friction_holds),
    };
    return cmocka_run_group_tests_name("sheave", tests, NULL, NULL);
}
