// Contacts that are found once for several steps of the cable: a free cable and a ball that spins and is pushed hit
// each other, rub and part.
#include "touch.h"

#include "ancf/cover.h"
#include "ancf/stability.h"

enum { ELEMENTS = 4, STEPS = 60, STEPS_MAX = 6 };

static const double ball_radius = 0.03, cable_radius = 1e-3, ball_mass = 0.02, push[3] = {0.0, 0.3, -4.0};

// What is left when they have parted, and how far momenta were off on the way, as parts of their terms.
typedef struct {
    double velocity[3], spin[3], off[2], pressed;
    int steps; // in contact
} outcome;

typedef struct {
    built b;
    ancf_table* t;
    ancf_time time;
    ancf_body ball;
    double friction[3], late[3], owed;
    double *after, *shift;
} meeting;

// Finds the contact for the middle of steps of length h, and fills the table.
static void meet(meeting* s, int steps) {
    const ancf_model* m = s->b.m;
    const double h = s->time.step, whole = steps * h, first = -0.5 * (steps - 1) * h;
    ancf_contact c = {.side = {{0, -1, {0}}, {-1, 0, {0}}}, .owed = s->owed};
    ancf_solid round = {.kind = ANCF_BALL, .size = {ball_radius}};
    ancf_nearest found, best = {.gap = INFINITY};
    int element = 0;
    for (int i = 0; i < 3; ++i) round.center[i] = s->ball.position[i] + 0.5 * whole * s->ball.velocity[i];
    for (int e = 0; e < ELEMENTS; ++e) {
        ancf_cubic cubic;
        ancf_cover_ahead(&cubic, m, e, 0.5 * whole);
        if (ancf_nearest_solid(&found, &cubic, 1, cable_radius, &round, 1.0) && found.gap < best.gap) {
            best = found;
            element = e;
        }
    }
    double at[3], v[3], a[3], opening = 0.0;
    own_at(at, &s->b, s->b.x, element, best.xi);
    own_at(v, &s->b, s->b.v, element, best.xi);
    own_at(a, &s->b, m->a, element, best.xi);
    ancf_body ball = s->ball;
    for (int i = 0; i < 3; ++i) {
        c.normal[i] = best.normal[i];
        c.side[1].arm[i] = at[i] - ball.position[i];
        c.friction[i] = s->friction[i];
        opening += c.normal[i] * (v[i] - ball.velocity[i]);
        ball.acceleration[i] = push[i] / ball_mass;
        ball.velocity[i] += (whole + first) * ball.acceleration[i];
    }
    c.owed = ancf_owed(s->owed, s->late, a);
    c.gap = best.gap - 0.5 * whole * opening;
    c.law = c.plain = (ancf_normal) {ANCF_NORMAL_HERTZ, 2e7, 1.5, 0.0};
    c.rub = (ancf_friction) {ANCF_FRICTION_HOLLARS, 0.3, 0.2, 1e-2};
    c.round = c.held = ball_radius + cable_radius;
    c.margin = 0.05 * cable_radius;
    c.within[1] = 1.0;
    ancf_table_clear(s->t);
    ancf_table_add_place(s->t, m, element, best.xi);
    ancf_table_add_body(s->t, &ball);
    ancf_table_add_contact(s->t, &c);
    if (steps > 1) ancf_table_rest(s->t, m, m->free, h, first);
    assert_int_equal(ancf_table_prepare(s->t, m, m->free), ANCF_OK);
    ancf_table_accelerate(s->t, m, m->a);
}

// As many steps of the cable with what was found once.
static void go(meeting* s, int steps, outcome* o) {
    ancf_model* m = s->b.m;
    const size_t size = 3 * (size_t)s->b.stride * sizeof *s->after;
    const double h = s->time.step;
    double passed = 0.0;
    int stiffest;
    for (int k = 0; k < steps; ++k) {
        double left;
        passed = h * (k - 0.5 * (steps - 1));
        ancf_predict(m, &s->time);
        if (k == 0) meet(s, steps);
        else assert_int_equal(ancf_table_go_on(s->t, m, m->free, h), ANCF_OK);
        memcpy(s->after, m->free, size);
        memset(s->shift, 0, size);
        ancf_table_guess(s->t, h);
        ancf_table_press(s->t, h, ancf_table_substeps(s->t, h, &stiffest));
        ancf_table_rub(s->t, h, &left);
        assert_true(left < 1e-7);
        ancf_table_apply(s->t, m, h, s->after, s->shift);
        ancf_table_end(s->t, h);
        ancf_correct(m, &s->time, s->after, s->shift);
        s->time.last = h;
    }
    const ancf_body* b = ancf_table_body(s->t, 0);
    const ancf_contact* c = ancf_table_contact(s->t, 0);
    for (int i = 0; i < 3; ++i) {
        s->ball.position[i] += b->moved[i];
        s->ball.velocity[i] = b->velocity[i] - passed * push[i] / ball_mass;
        s->ball.spin[i] = b->spin[i];
        s->friction[i] = c->friction[i];
        s->late[i] = c->late[i];
    }
    s->owed = c->owed;
    o->pressed += norm(c->pressed);
    o->steps += norm(c->pressed) > 0.0;
}

static outcome collide(int steps) {
    const ancf_element all = {.length = 0.2, .ea = 50.0, .ei = 1e-4, .rho_a = 5e-3};
    meeting s = {.b = build_cable(ELEMENTS, all, 1)};
    outcome o = {.steps = 0};
    int stiffest;
    solid known = {.mass = ball_mass};
    const double inertia = 0.4 * ball_mass * ball_radius * ball_radius;
    build_finish(&s.b);
    assert_int_equal(ancf_table_create(&s.t, s.b.m), ANCF_OK);
    s.after = calloc(6 * (size_t)s.b.stride, sizeof *s.after);
    s.shift = s.after + 3 * s.b.stride;
    s.time.step = 0.5 * ancf_critical_step(s.b.m, 0.05, &stiffest);
    s.ball = (ancf_body) {.position = {0.08, 0.0, ball_radius + cable_radius + 1e-3},
                          .velocity = {0.5, 0.0, -2.0},
                          .spin = {0.0, 60.0, 10.0}};
    for (int i = 0; i < 3; ++i) {
        s.ball.inv_mass[i] = 1.0 / ball_mass;
        s.ball.inv_inertia[4 * i] = 1.0 / inertia;
        known.inertia[4 * i] = inertia;
    }
    double P[2][3] = {{0.0}}, H[2][3] = {{0.0}}, terms[2];
    own_momentum(P[0], H[0], terms, &s.b);
    add_momentum(P[0], H[0], terms, &known, &s.ball);
    for (int k = 0; k < STEPS; k += steps) {
        double turn[3];
        cross(turn, s.ball.position, push);
        for (int i = 0; i < 3; ++i) { // what pushes acts where a step starts
            P[0][i] += steps * s.time.step * push[i];
            H[0][i] += steps * s.time.step * turn[i];
        }
        go(&s, steps, &o);
        memset(P[1], 0, sizeof P[1]);
        memset(H[1], 0, sizeof H[1]);
        own_momentum(P[1], H[1], terms, &s.b);
        add_momentum(P[1], H[1], terms, &known, &s.ball);
        for (int i = 0; i < 3; ++i) {
            o.off[0] = fmax(o.off[0], fabs(P[1][i] - P[0][i]) / terms[0]);
            o.off[1] = fmax(o.off[1], fabs(H[1][i] - H[0][i]) / terms[1]);
        }
    }
    memcpy(o.velocity, s.ball.velocity, sizeof o.velocity);
    memcpy(o.spin, s.ball.spin, sizeof o.spin);
    ancf_table_destroy(s.t);
    free(s.after);
    build_free(&s.b);
    return o;
}

// Momenta are kept however many steps go by, and the outcome differs from that of contacts found in every step by the
// square of their number.
static void found_once_is_found_always(void** state) {
    (void)state;
    const outcome always = collide(1);
    assert_true(always.steps >= 4 && always.spin[1] < 59.6 && always.pressed > 5e-4);
    for (int steps = 1; steps <= STEPS_MAX; ++steps) {
        const outcome o = collide(steps);
        print_message("%d steps: off %.1e and %.1e, velocity %.6f %.6f %.6f, spin %.5f, impulse %.6g\n", steps,
                      o.off[0], o.off[1], o.velocity[0], o.velocity[1], o.velocity[2], o.spin[1], o.pressed);
        assert_true(o.off[0] < 1e-13 && o.off[1] < 1e-13);
        const double apart = 1e-3 * (steps * steps - 1.0);
        assert_close(o.pressed, always.pressed, apart);
        for (int i = 0; i < 3; ++i) assert_near(o.velocity[i], always.velocity[i], apart * always.pressed / ball_mass);
        assert_near(o.spin[1], always.spin[1], apart * (60.0 - always.spin[1]));
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(found_once_is_found_always),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
