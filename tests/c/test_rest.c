// Static equilibrium with contact: forces on what lies below, closed forms, and no trace where nothing is near.
#include "touch.h"

#include "ancf/equilibrium.h"

static const double g = 9.81;

typedef struct {
    ancf_cover* cover;
    ancf_normal law;
    ancf_laws laws;
    ancf_rest* rest;
} touching;

static void touch_start(touching* t, const built* b, double radius, double stiffness, ancf_obstacle* obstacle, int n) {
    const int elements = b->def.n_elements;
    t->cover = calloc((size_t)elements, sizeof *t->cover);
    for (int e = 0; e < elements; ++e)
        t->cover[e] = (ancf_cover) {.radius = radius, .segments = 4, .mask = 1, .run = e};
    t->law = (ancf_normal) {ANCF_NORMAL_HERTZ, stiffness, 1.5, 0.0};
    t->laws = (ancf_laws) {.normal = t->law};
    for (int i = 0; i < n; ++i) obstacle[i].law = &t->law;
    assert_int_equal(ancf_rest_create(&t->rest, b->m, t->cover, &t->laws, 1, obstacle, n, NULL, 0), ANCF_OK);
}

static void touch_end(touching* t) {
    ancf_rest_destroy(t->rest);
    free(t->cover);
}

// A net on a ball, its corners pulled down: all that is pulled rests on the ball, and without a moment about its
// centre.
static void net_on_a_ball(void** state) {
    (void)state;
    const double radius = 5e-4, big = 0.15, pull = 2.0;
    built b = build_net(6, net_element(0, 0.0));
    for (int i = 0; i < b.def.n_nodes; ++i) { // from y-z into x-y, above the ball
        b.x[i] = b.x[b.stride + i] - 0.24;
        b.x[b.stride + i] = b.x[2 * b.stride + i] - 0.24;
        b.x[2 * b.stride + i] = big + 1e-3;
    }
    build_slopes(&b);
    build_finish(&b);
    b.m->gravity[2] = -g;
    const int corner[4] = {0, 6, 42, 48};
    double weight = 4.0 * pull;
    for (int k = 0; k < 4; ++k) b.m->external[2 * b.stride + corner[k]] = -pull;
    for (int e = 0; e < b.def.n_elements; ++e) weight += g * b.element[e].rho_a * b.element[e].length;
    ancf_obstacle ball = {.solid = {.kind = ANCF_BALL, .size = {big}}, .node = -1, .mask = 1};
    touching t;
    touch_start(&t, &b, radius, 1e7, &ball, 1);
    assert_int_equal(ancf_equilibrium(b.m, 1e-9, 500000, t.rest), ANCF_OK);
    assert_close(ball.force[2], -weight, 1e-6);
    for (int c = 0; c < 3; ++c) assert_near(ball.moment[c], 0.0, 1e-9 * weight);
    for (int c = 0; c < 2; ++c) assert_near(ball.force[c], 0.0, 1e-6 * weight);
    touch_end(&t);
    build_free(&b);
}

// A stiff rod, one end held, across a small ball: one place, as deep as the law says; the force by the levers.
static void depth_of_one_place(void** state) {
    (void)state;
    const double radius = 5e-3, small = 0.02, k = 1e8, L = 0.4;
    const ancf_element all = {.length = L, .ea = 1e6, .ei = 1e3, .rho_a = 5.0};
    built b = build_cable(1, all, 1);
    for (int i = 0; i < 2; ++i) b.x[2 * b.stride + i] = small + radius;
    b.hold[0] = ANCF_HELD;
    build_finish(&b);
    b.m->gravity[2] = -g;
    ancf_obstacle ball = {
        .solid = {.kind = ANCF_BALL, .center = {0.27, 0.0, 0.0}, .size = {small}}, .node = -1, .mask = 1};
    touching t;
    touch_start(&t, &b, radius, k, &ball, 1);
    assert_int_equal(ancf_equilibrium(b.m, 1e-8, 500000, t.rest), ANCF_OK);
    double at[3], least = INFINITY;
    for (int i = 0; i <= 40000; ++i) {
        own_at(at, &b, b.x, 0, i / 40000.0);
        at[0] -= ball.solid.center[0];
        least = fmin(least, norm(at));
    }
    const double force = norm(ball.force);
    assert_close(force, all.rho_a * g * L * 0.5 * L / ball.solid.center[0], 1e-3);
    assert_close(small + radius - least, pow(force / k, 2.0 / 3.0), 1e-4);
    touch_end(&t);
    build_free(&b);
}

// A slack rope comes to rest on a taut one, crosswise.
static void two_ropes_carry_each_other(void** state) {
    (void)state;
    enum { N = 9 };
    const double radius = 2e-3, L = 1.0;
    const ancf_element all = {.length = L / N, .ea = 1e3, .rho_a = 0.05};
    built b = build_start(2 * (N + 1), 2 * N, all);
    for (int r = 0; r < 2; ++r)
        for (int i = 0; i <= N; ++i) {
            const int node = r * (N + 1) + i;
            b.x[r * b.stride + node] = (r ? 0.97 : 0.999) * L * ((double)i / N - 0.5);
            b.x[2 * b.stride + node] = r * 2.0 * radius;
            if (i < N) {
                const int e = r * N + i;
                b.ends[2 * e] = node;
                b.ends[2 * e + 1] = node + 1;
                if (i + 1 < N) b.next[e] = e + 1;
            }
        }
    build_slopes(&b);
    for (int k = 0; k < 4; ++k) b.hold[(k / 2) * (N + 1) + (k % 2) * N] = ANCF_HELD;
    build_finish(&b);
    b.m->gravity[2] = -g;
    touching t;
    touch_start(&t, &b, radius, 1e7, NULL, 0);
    for (int e = 0; e < 2 * N; ++e) {
        t.cover[e].structure = e / N;
        t.cover[e].segments = 3; // they cross in the middle of one
    }
    assert_int_equal(ancf_equilibrium(b.m, 1e-8, 500000, t.rest), ANCF_OK);
    double low[3], high[3];
    own_at(low, &b, b.x, N / 2, 0.5);
    own_at(high, &b, b.x, N + N / 2, 0.5);
    assert_near(high[2] - low[2], 2.0 * radius, 0.02 * radius);
    for (int c = 0; c < 2; ++c) assert_near(high[c] - low[c], 0.0, 1e-6);
    // Contact forces are inner forces: with them in m->f, what is out of balance is at the four ends alone.
    double sum = 0.0;
    for (int i = 0; i < b.def.n_nodes; ++i)
        if (!b.hold[i]) sum += b.m->f[2 * b.stride + i];
    assert_near(sum, 0.0, 1e-5);
    touch_end(&t);
    build_free(&b);
}

// What may touch but is never near changes no bit.
static void far_is_none(void** state) {
    (void)state;
    built b[2];
    for (int k = 0; k < 2; ++k) {
        b[k] = build_cable(12, (ancf_element) {.length = 1.2, .ea = 5e3, .ei = 1e-4, .rho_a = 0.05}, 1);
        b[k].hold[0] = b[k].hold[12] = ANCF_HELD;
        build_finish(&b[k]);
        b[k].m->gravity[2] = -g;
        ancf_obstacle floor = {.solid = {.kind = ANCF_PLANE, .center = {0.0, 0.0, -5.0}, .axis = {{0.0, 0.0, 1.0}}},
                               .node = -1,
                               .mask = 1};
        touching t;
        touch_start(&t, &b[k], 2e-3, 1e7, &floor, 1);
        assert_int_equal(ancf_equilibrium(b[k].m, 1e-8, 500000, k ? t.rest : NULL), ANCF_OK);
        touch_end(&t);
    }
    assert_memory_equal(b[0].x, b[1].x, 3 * (size_t)b[0].stride * sizeof *b[0].x);
    for (int k = 0; k < 2; ++k) build_free(&b[k]);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(net_on_a_ball),
        cmocka_unit_test(depth_of_one_place),
        cmocka_unit_test(two_ropes_carry_each_other),
        cmocka_unit_test(far_is_none),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
