// Contacts of two cables: couples that make up for what lies between their centrelines, and work that contacts owe.
#include "touch.h"

#include "ancf/stability.h"
#include "drag.h"
#include "lever.h"

enum { CONTACTS = 4 };

typedef struct {
    built b;
    ancf_table* t;
    double* shift;
    bool crosses; // all cables that touch, so much that couples balance friction
} crossing;

// The smallest part of G against both radii is then above the twentieth below which it counts less.
static bool crosses(const ancf_table* t, const ancf_contact* c) {
    const double *a = t->place[c->side[0].place].slope, *b = t->place[c->side[1].place].slope, r = c->radius[0],
                 q = c->radius[1];
    double n[3];
    cross(n, a, b);
    return r * q * dot(n, n) / (dot(a, a) * dot(b, b)) > 0.05 * (r + q) * (r + q);
}

// A net, shaken and moving anyhow, some pairs of whose cables touch at random places.
static crossing crossing_make(uint64_t* seed, bool rubs) {
    const ancf_element all = {.length = 0.1, .ea = 1.0, .rho_a = 0.02};
    crossing s = {.b = build_net(2, all), .crosses = true};
    build_shake(&s.b, s.b.x, 0.5, seed);
    build_shake(&s.b, s.b.v, 1.0, seed);
    build_finish(&s.b);
    assert_int_equal(ancf_table_create(&s.t, s.b.m), ANCF_OK);
    s.shift = calloc(3 * (size_t)s.b.stride, sizeof *s.shift);
    for (int k = 0; k < CONTACTS; ++k) {
        ancf_contact c = {.law = {ANCF_NORMAL_NONLINEAR, 1e7, 1.5, 0.2}, .gap = -random_magnitude(seed, 1e-6, 1e-4)};
        if (rubs) c.rub = (ancf_friction) {ANCF_FRICTION_HOLLARS, 0.3, 0.2, 1e-2};
        double x[2][3], *way = c.side[1].arm;
        for (int i = 0; i < 2; ++i) {
            const int element = 2 * k + i + (i ? 4 : 0) * (k % 2);
            const double xi = random_between(seed, 0.0, 1.0);
            c.side[i].place = ancf_table_add_slope(s.t, s.b.m, element, xi);
            c.side[i].body = -1;
            own_at(x[i], &s.b, s.b.x, element, xi);
        }
        for (int i = 0; i < 3; ++i) way[i] = x[0][i] - x[1][i];
        for (int i = 0; i < 3; ++i) c.normal[i] = way[i] / norm(way);
        const double part = random_between(seed, 0.2, 0.8); // their surfaces meet between them
        c.radius[0] = part * norm(way);
        c.radius[1] = norm(way) - c.radius[0];
        ancf_table_add_contact(s.t, &c);
    }
    assert_int_equal(ancf_table_prepare(s.t, s.b.m, s.b.v), ANCF_OK);
    for (int k = 0; k < CONTACTS; ++k) s.crosses &= crosses(s.t, ancf_table_contact(s.t, k));
    return s;
}

static void crossing_free(crossing* s) {
    ancf_table_destroy(s->t);
    free(s->shift);
    build_free(&s->b);
}

// Surfaces that turn as one do not slip, however thick the cables are and however they lie.
static void turning_as_one_is_no_slip(void** state) {
    (void)state;
    uint64_t seed = 81;
    int n = 0;
    for (int run = 0; run < 200; ++run) {
        crossing s = crossing_make(&seed, true);
        double spin[3], r[3], v[3];
        random_vector(spin, &seed, 1.0);
        for (int i = 0; i < s.b.n_dof; ++i) {
            for (int c = 0; c < 3; ++c) r[c] = s.b.x[c * s.b.stride + i];
            cross(v, spin, r);
            for (int c = 0; c < 3; ++c) s.b.v[c * s.b.stride + i] = v[c];
        }
        assert_int_equal(ancf_table_prepare(s.t, s.b.m, s.b.v), ANCF_OK);
        for (int k = 0; k < CONTACTS; ++k) {
            const ancf_contact* c = ancf_table_contact(s.t, k);
            if (!crosses(s.t, c)) continue;
            ++n;
            ancf_table_slip(v, s.t, c);
            const double centrelines = norm(v);
            ancf_lever_slip(v, s.t, c);
            assert_true(norm(v) < 1e-12 * centrelines);
        }
        crossing_free(&s);
    }
    assert_true(n > 100);
}

// Slip is what the couples of an impulse do work on: the two maps are each other's transpose.
static void slip_is_conjugate_to_couples(void** state) {
    (void)state;
    uint64_t seed = 82;
    for (int run = 0; run < 200; ++run) {
        crossing s = crossing_make(&seed, true);
        const ancf_contact* c = ancf_table_contact(s.t, run % CONTACTS);
        double P[3], v[3] = {0.0, 0.0, 0.0}, work = 0.0, before[2][3];
        random_vector(P, &seed, 1.0);
        ancf_lever_slip(v, s.t, c);
        for (int i = 0; i < 2; ++i) memcpy(before[i], s.t->place[c->side[i].place].bending, sizeof before[i]);
        ancf_lever_kick(s.t, c, P, 1e-4);
        for (int i = 0; i < 2; ++i) work += dot(s.t->place[c->side[i].place].couple, before[i]);
        assert_near(dot(P, v), work, 1e-12 * norm(P) * norm(v));
        crossing_free(&s);
    }
}

// What friction along either direction does to the slip along both is what kicks do, with couples on slopes among it.
static void drag_is_what_kicks_do(void** state) {
    (void)state;
    uint64_t seed = 85;
    for (int run = 0; run < 100; ++run) {
        crossing s = crossing_make(&seed, true);
        const ancf_contact* c = ancf_table_contact(s.t, run % CONTACTS);
        ancf_drag* d = &s.t->drag[run % CONTACTS];
        d->slip[0] = d->slip[1] = 0.0;
        for (int i = 0; i < s.t->n_places; ++i) memset(s.t->place[i].pushed, 0, sizeof s.t->place[i].pushed);
        for (int i = 0; i < s.t->n_bodies; ++i) memset(s.t->body[i].pushed, 0, sizeof s.t->body[i].pushed);
        ancf_drag_find(s.t, run % CONTACTS);
        assert_near(dot(d->tangent[0], c->normal), 0.0, 1e-15);
        assert_near(dot(d->tangent[1], c->normal), 0.0, 1e-15);
        for (int k = 0; k < 2; ++k) {
            double before[3], after[3], old[2], found[2];
            const double unit[2] = {k == 0, k == 1};
            ancf_table_slip(before, s.t, c);
            ancf_lever_slip(before, s.t, c);
            ancf_table_kick(s.t, c, d->tangent[k], 0.0);
            ancf_lever_kick(s.t, c, d->tangent[k], 1e-4);
            ancf_table_slip(after, s.t, c);
            ancf_lever_slip(after, s.t, c);
            ancf_drag_slip(old, s.t, c, d);
            ancf_drag_give(s.t, c, d, unit);
            ancf_drag_slip(found, s.t, c, d);
            for (int a = 0; a < 2; ++a) {
                const double truth = dot(after, d->tangent[a]) - dot(before, d->tangent[a]);
                assert_near(found[a] - old[a], truth, 1e-10 * d->own[k][k]);
                assert_near(d->own[a][k], truth, 1e-10 * d->own[k][k]);
            }
        }
        crossing_free(&s);
    }
}

// Angular momentum about the origin is kept but for what is told as left; that is nothing where cables cross.
static void moments_are_kept_or_told(void** state) {
    (void)state;
    uint64_t seed = 83;
    int crossed = 0, rubbed = 0;
    for (int run = 0; run < 400; ++run) {
        const bool rubs = run % 2;
        crossing s = crossing_make(&seed, rubs);
        const double step = random_magnitude(&seed, 1e-5, 1e-3);
        double P0[3], H0[3], P[3], H[3], terms[2], left[3], unsolved;
        int stiffest;
        own_momentum(P0, H0, terms, &s.b);
        const int n = ancf_table_substeps(s.t, step, &stiffest);
        ancf_table_press(s.t, step, n);
        ancf_table_rub(s.t, step, &unsolved);
        ancf_table_apply(s.t, s.b.m, step, s.b.v, s.shift);
        own_drift(&s.b, step, s.shift);
        own_momentum(P, H, terms, &s.b);
        ancf_table_twist_left(left, s.t);
        for (int i = 0; i < 3; ++i) {
            assert_near(P[i], P0[i], 1e-12 * terms[0]);
            assert_near(H[i] - left[i], H0[i], 1e-12 * terms[1]);
        }
        if (!rubs) assert_true(norm(left) == 0.0);
        if (s.crosses) {
            ++crossed;
            assert_true(norm(left) < 1e-13 * terms[1]);
        }
        for (int k = 0; k < CONTACTS; ++k) rubbed += norm(ancf_table_contact(s.t, k)->friction) > 0.0;
        crossing_free(&s);
    }
    assert_true(crossed > 20 && rubbed > 400);
}

// What friction takes at the surfaces, couples included, is what the cables lose.
static void friction_takes_what_is_lost(void** state) {
    (void)state;
    uint64_t seed = 84;
    for (int run = 0; run < 200; ++run) {
        crossing s = crossing_make(&seed, true);
        const double step = random_magnitude(&seed, 1e-6, 1e-5);
        double all = kinetic_of_field(&s.b, s.b.v), lost = 0.0, rubbed = 0.0, unsolved;
        int stiffest;
        const double before = all;
        for (int k = 0; k < CONTACTS; ++k) {
            const ancf_contact* c = ancf_table_contact(s.t, k);
            all += ancf_normal_energy(&c->law, -c->gap);
        }
        const int n = ancf_table_substeps(s.t, step, &stiffest);
        ancf_table_press(s.t, step, n);
        ancf_table_rub(s.t, step, &unsolved);
        ancf_table_apply(s.t, s.b.m, step, s.b.v, s.shift);
        for (int k = 0; k < CONTACTS; ++k) {
            const ancf_contact* c = ancf_table_contact(s.t, k);
            lost += c->energy + c->damped + c->rubbed;
            rubbed += c->rubbed;
        }
        assert_near(kinetic_of_field(&s.b, s.b.v) + lost, all, 1e-6 * before);
        assert_true(rubbed >= 0.0);
        crossing_free(&s);
    }
}

// A ball bounces on a held cable that gives way, without damping. Returns how much energy is gained, *owing what should
// be by what contacts owe. [J]
static double gained(double speed, bool owes, double* owing) {
    const ancf_element all = {.length = 0.3, .ea = 500.0, .ei = 1e-4, .rho_a = 2e-3};
    built b = build_cable(3, all, 1);
    ancf_table* t;
    b.hold[0] = b.hold[3] = ANCF_HELD;
    build_finish(&b);
    for (int i = 0; i < b.stride; ++i) b.x[i] *= 1.02; // tight
    assert_int_equal(ancf_table_create(&t, b.m), ANCF_OK);
    double *after = calloc(6 * (size_t)b.stride, sizeof *after), *shift = after + 3 * b.stride;
    int stiffest;
    ancf_body ball = {.position = {0.15, 0.0, -1e-3}, .velocity = {0.0, 0.0, speed}, .inv_mass = {0.0, 0.0, 1e3}};
    ancf_time time = {.step = 0.7 * ancf_critical_step(b.m, 0.05, &stiffest)};
    double owed = 0.0, late[3] = {0.0, 0.0, 0.0}, start = 0.0, stored = 0.0, energy = 0.0;
    *owing = 0.0;
    for (int i = 0; i < 3000; ++i) {
        double axial, bending, at[3], a[3];
        ancf_predict(b.m, &time);
        ancf_elastic_energy(&axial, &bending, b.m, b.x, 0, 3);
        energy = ancf_kinetic_kept(b.m, time.last, time.step) + axial + bending + stored +
                 0.5 * ball.velocity[2] * ball.velocity[2] / ball.inv_mass[2];
        if (i == 0) start = energy;
        own_at(at, &b, b.x, 1, 0.5);
        own_at(a, &b, b.m->a, 1, 0.5);
        ancf_table_clear(t);
        ancf_contact c = {.side = {{0, -1, {0}}, {-1, 0, {0}}}, .normal = {0.0, 0.0, 1.0}};
        c.law = (ancf_normal) {ANCF_NORMAL_HERTZ, 1e7, 1.5, 0.0};
        c.gap = at[2] - ball.position[2];
        const double due = ancf_owed(owed, late, a);
        *owing += owes ? 0.0 : due;
        c.owed = owes ? due : 0.0;
        ancf_table_add_place(t, b.m, 1, 0.5);
        ancf_body moving = ball;
        ancf_table_add_body(t, &moving);
        ancf_table_add_contact(t, &c);
        assert_int_equal(ancf_table_prepare(t, b.m, b.m->free), ANCF_OK);
        ancf_table_accelerate(t, b.m, b.m->a);
        memcpy(after, b.m->free, 3 * (size_t)b.stride * sizeof *after);
        memset(shift, 0, 3 * (size_t)b.stride * sizeof *shift);
        ancf_table_press(t, time.step, ancf_table_substeps(t, time.step, &stiffest));
        ancf_table_apply(t, b.m, time.step, after, shift);
        ancf_table_end(t, time.step);
        ancf_correct(b.m, &time, after, shift);
        const ancf_contact* done = ancf_table_contact(t, 0);
        memcpy(late, done->late, sizeof late);
        owed = done->owed;
        stored = done->energy;
        ball.position[2] += time.step * ball.velocity[2] + ancf_table_body(t, 0)->shift[2];
        ball.velocity[2] = ancf_table_body(t, 0)->velocity[2];
        time.last = time.step;
    }
    ancf_table_destroy(t);
    free(after);
    build_free(&b);
    return energy - start;
}

static void what_contacts_owe_is_given_back(void** state) {
    (void)state;
    for (double speed = 0.03; speed < 0.5; speed *= 2.0) {
        double owing, none;
        const double without = gained(speed, false, &owing), with = gained(speed, true, &none);
        print_message("%.2g m/s: %.3g J gained, %.3g J owed, %.3g J left once that is given back\n", speed, without,
                      owing, with);
        assert_close(without, owing, 0.02);
        assert_true(fabs(with) < 0.1 * fabs(without));
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(turning_as_one_is_no_slip),   cmocka_unit_test(slip_is_conjugate_to_couples),
        cmocka_unit_test(drag_is_what_kicks_do),       cmocka_unit_test(moments_are_kept_or_told),
        cmocka_unit_test(friction_takes_what_is_lost), cmocka_unit_test(what_contacts_owe_is_given_back),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
