// Knots that go on together with points of bodies, against conserved quantities and a dense solve written here.
#include "touch.h"

#include <time.h>

enum { BODIES = 3, COUPLINGS = 12 };

// FULL has a body of its own, one on a guide and one that stands still on so many knots that these come from a sparse
// factor where mass is consistent.
typedef enum { ONE, LIGHT, HEAVY, MANY, GUIDED, STANDING, MIXED, FULL, SCENES } kind;

// Bodies that knots of a cable or a net hold at points off their centres.
typedef struct {
    built b;
    ancf_table* t;
    double *before, *shift;
    int n_bodies, n;
    solid solid[BODIES];
    int knot[COUPLINGS], body[COUPLINGS];
} scene;

static scene scene_make(kind which, int run, uint64_t* seed) {
    const ancf_element all = {
        .kind = run % 2 ? ANCF_LUMPED : 0, .length = 0.3, .ea = 1.0, .rho_a = which == LIGHT ? 5.0 : 0.05};
    const int full = which == FULL;
    scene s = {.b = run % 4 < 2 ? build_cable(full ? 12 : 7, all, 1) : build_net(full ? 3 : 2, all)};
    built* b = &s.b;
    s.n_bodies = which == MIXED || full ? 3 : 1;
    s.n = which == ONE || which == LIGHT || which == HEAVY ? 1
          : which == GUIDED                                ? 2
          : which == STANDING                              ? 3
          : full                                           ? COUPLINGS
                                                           : 6;
    build_shake(b, b->x, 0.2, seed);
    build_shake(b, b->v, 1.0, seed);
    b->mass[2] = 0.1;
    build_finish(b);
    assert_int_equal(ancf_table_create(&s.t, b->m), ANCF_OK);
    s.before = velocity_before(b);
    s.shift = s.before + 3 * b->stride;
    ancf_table_clear(s.t);
    for (int i = 0; i < s.n_bodies; ++i) {
        const double mass = which == LIGHT ? 1e-4 : which == HEAVY ? 100.0 : random_magnitude(seed, 1e-2, 1.0);
        const bool stands = which == STANDING || (full && i == 2);
        s.solid[i] = random_solid(seed, stands ? 0.0 : mass, stands ? 0.0 : 1e-3 * mass);
        ancf_body* body = &s.solid[i].body;
        random_vector(body->position, seed, 0.1);
        random_vector(body->velocity, seed, stands ? 0.0 : 1.0);
        random_vector(body->spin, seed, stands ? 0.0 : 5.0);
        if (which == GUIDED || ((which == MIXED || full) && i == 1)) {
            double direction[3];
            random_direction(direction, seed);
            const double speed = dot(direction, body->velocity);
            for (int c = 0; c < 3; ++c) {
                body->inv_mass[c] = 0.0;
                body->along[c] = direction[c] / sqrt(mass);
                body->velocity[c] = speed * direction[c];
            }
        }
        ancf_table_add_body(s.t, body);
    }
    for (int k = 0; k < s.n; ++k) {
        ancf_coupling c = {0};
        s.knot[k] = k + 1;
        s.body[k] = c.body = k % s.n_bodies;
        c.place = ancf_table_add_knot(s.t, b->m, s.knot[k]);
        for (int i = 0; i < 3; ++i) c.arm[i] = b->x[i * b->stride + s.knot[k]] - s.solid[c.body].body.position[i];
        random_vector(c.ahead, seed, 0.1);
        assert_int_equal(ancf_table_add_coupling(s.t, &c), k);
    }
    assert_int_equal(ancf_table_prepare(s.t, b->m, b->v), ANCF_OK);
    return s;
}

static void scene_free(scene* s) {
    ancf_table_destroy(s->t);
    free(s->before);
    build_free(&s->b);
}

// What is missing at a coupling, from a field and bodies.
static void missing(double v[3], const scene* s, int k, const double* field, const ancf_body* bodies) {
    const ancf_coupling* c = ancf_table_coupling(s->t, k);
    body_point_velocity(v, &bodies[c->body], c->arm);
    for (int i = 0; i < 3; ++i) v[i] += c->ahead[i] - field[i * s->b.stride + s->knot[k]];
}

static void couplings_hold(void** state) {
    (void)state;
    uint64_t seed = 71;
    double worst = 0.0;
    for (int which = 0; which < SCENES; ++which)
        for (int run = 0; run < 40; ++run) {
            scene s = scene_make(which, run, &seed);
            ancf_body after[BODIES];
            double start = 0.0, left = 0.0;
            for (int i = 0; i < s.n_bodies; ++i) after[i] = s.solid[i].body;
            for (int k = 0; k < s.n; ++k) {
                double v[3];
                missing(v, &s, k, s.before, after);
                start = fmax(start, norm(v));
            }
            ancf_table_couple(s.t, 1e-4);
            ancf_table_apply(s.t, s.b.m, 1e-4, s.b.v, s.shift);
            for (int i = 0; i < s.n_bodies; ++i) after[i] = *ancf_table_body(s.t, i);
            for (int k = 0; k < s.n; ++k) {
                double v[3];
                missing(v, &s, k, s.b.v, after);
                left = fmax(left, norm(v));
            }
            worst = fmax(worst, left / start);
            // They hold already: once more changes nothing.
            const ancf_coupling first = *ancf_table_coupling(s.t, 0);
            ancf_table_couple(s.t, 1e-4);
            for (int i = 0; i < 3; ++i)
                assert_near(ancf_table_coupling(s.t, 0)->impulse[i], first.impulse[i], 1e-12 * norm(first.impulse));
            scene_free(&s);
        }
    print_message("at most %.2g of what was missing is left\n", worst);
    assert_true(worst < 1e-12);
}

// A guide takes what is across it, and a body that stands still takes all.
static void momentum_is_exchanged(void** state) {
    (void)state;
    uint64_t seed = 72;
    const kind free_ones[] = {ONE, LIGHT, HEAVY, MANY};
    for (int run = 0; run < 160; ++run) {
        const double step = 1e-4, rest = 0.3e-4;
        scene s = scene_make(free_ones[run % 4], run / 4, &seed);
        double P0[3], H0[3], P[3], H[3], terms[2], moved[3], unused[3], size[2];
        own_momentum(P0, H0, terms, &s.b);
        for (int i = 0; i < s.n_bodies; ++i) add_momentum(P0, H0, terms, &s.solid[i], &s.solid[i].body);
        ancf_table_couple(s.t, rest);
        ancf_table_apply(s.t, s.b.m, step, s.b.v, s.shift);
        own_momentum(P, H, terms, &s.b);
        for (int i = 0; i < s.n_bodies; ++i) add_momentum(P, H, terms, &s.solid[i], ancf_table_body(s.t, i));
        for (int i = 0; i < 3; ++i) {
            assert_near(P[i], P0[i], 1e-13 * terms[0]);
            assert_near(H[i], H0[i], 1e-13 * terms[1]);
        }
        for (int i = 0; i < 3 * s.b.stride; ++i) s.shift[i] += step * s.b.v[i];
        built way = s.b; // the centre of mass goes on evenly
        way.v = s.shift;
        own_momentum(moved, unused, size, &way);
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < s.n_bodies; ++j) {
                const solid* body = &s.solid[j];
                moved[i] += body->mass * (step * body->body.velocity[i] + ancf_table_body(s.t, j)->shift[i]);
                // Given at one moment, `rest` before the end.
                const double dv = ancf_table_body(s.t, j)->velocity[i] - body->body.velocity[i];
                const double dw = ancf_table_body(s.t, j)->spin[i] - body->body.spin[i];
                assert_near(ancf_table_body(s.t, j)->shift[i], rest * dv, 1e-14 * step * fabs(dv) + 1e-18);
                assert_near(ancf_table_body(s.t, j)->turn[i], rest * dw, 1e-14 * step * fabs(dw) + 1e-17);
            }
            assert_near(moved[i], step * P0[i], 1e-13 * step * terms[0]);
        }
        scene_free(&s);
    }
}

// (S M^-1 S^T + what the bodies answer) p = what is missing, all couplings together, column by column.
static void impulses_are_those_of_a_dense_solve(void** state) {
    (void)state;
    uint64_t seed = 73;
    for (int which = 0; which < SCENES; ++which)
        for (int run = 0; run < 20; ++run) {
            scene s = scene_make(which, run, &seed);
            const int n = 3 * s.n;
            double A[9 * COUPLINGS * COUPLINGS], rhs[3 * COUPLINGS], p[3 * COUPLINGS], largest = 0.0;
            ancf_body still[BODIES], bodies[BODIES];
            double* field = calloc(3 * (size_t)s.b.stride, sizeof *field);
            for (int i = 0; i < s.n_bodies; ++i) {
                still[i] = s.solid[i].body;
                memset(still[i].velocity, 0, sizeof still[i].velocity);
                memset(still[i].spin, 0, sizeof still[i].spin);
            }
            for (int j = 0; j < n; ++j) {
                const ancf_coupling* c = ancf_table_coupling(s.t, j / 3);
                const ancf_place* place = ancf_table_place(s.t, c->place);
                double e[3] = {0.0, 0.0, 0.0}, back[3] = {0.0, 0.0, 0.0};
                e[j % 3] = 1.0;
                back[j % 3] = -1.0;
                memset(field, 0, 3 * (size_t)s.b.stride * sizeof *field);
                memcpy(bodies, still, sizeof bodies);
                own_kick(&s.b, field, place->element, place->xi, e);
                own_kick_body(&bodies[c->body], c->arm, back);
                for (int k = 0; k < s.n; ++k) {
                    double v[3];
                    missing(v, &s, k, field, bodies);
                    for (int i = 0; i < 3; ++i) A[(3 * k + i) * n + j] = ancf_table_coupling(s.t, k)->ahead[i] - v[i];
                }
            }
            for (int i = 0; i < s.n_bodies; ++i) bodies[i] = s.solid[i].body;
            for (int k = 0; k < s.n; ++k) missing(rhs + 3 * k, &s, k, s.before, bodies);
            dense_solve(p, A, rhs, n);
            for (int i = 0; i < n; ++i) largest = fmax(largest, fabs(p[i]));
            ancf_table_couple(s.t, 1e-4);
            ancf_table_apply(s.t, s.b.m, 1e-4, s.b.v, s.shift);
            for (int k = 0; k < s.n; ++k) {
                const ancf_coupling* c = ancf_table_coupling(s.t, k);
                const ancf_place* place = ancf_table_place(s.t, c->place);
                const double back[3] = {-p[3 * k], -p[3 * k + 1], -p[3 * k + 2]};
                for (int i = 0; i < 3; ++i) assert_near(c->impulse[i], p[3 * k + i], 1e-11 * largest);
                own_kick(&s.b, s.before, place->element, place->xi, p + 3 * k);
                own_kick_body(&bodies[c->body], c->arm, back);
            }
            for (int i = 0; i < 3 * s.b.stride; ++i) assert_near(s.b.v[i], s.before[i], 1e-9);
            for (int j = 0; j < s.n_bodies; ++j)
                for (int i = 0; i < 3; ++i) {
                    const ancf_body* b = ancf_table_body(s.t, j);
                    assert_near(b->velocity[i], bodies[j].velocity[i], 1e-10);
                    assert_near(b->spin[i], bodies[j].spin[i], 1e-9);
                }
            free(field);
            scene_free(&s);
        }
}

// What the impulses take of the energy is what a perfectly plastic impact takes; with `ahead` 0 never a gain.
static void coupling_gives_no_energy(void** state) {
    (void)state;
    uint64_t seed = 74;
    for (int run = 0; run < 200; ++run) {
        scene s = scene_make(run % SCENES, run / SCENES, &seed);
        double taken = 0.0, before = kinetic_of_field(&s.b, s.b.v), after;
        if (run % SCENES == GUIDED || run % SCENES == MIXED || run % SCENES == STANDING ||
            run % SCENES == FULL) { // masses not as in solid
            scene_free(&s);
            continue;
        }
        for (int k = 0; k < s.n; ++k) memset(ancf_table_coupling(s.t, k)->ahead, 0, 3 * sizeof(double));
        double start[COUPLINGS][3];
        ancf_body bodies[BODIES];
        for (int i = 0; i < s.n_bodies; ++i) {
            bodies[i] = s.solid[i].body;
            before += kinetic_of_solid(&s.solid[i], &bodies[i]);
        }
        for (int k = 0; k < s.n; ++k) missing(start[k], &s, k, s.before, bodies);
        ancf_table_couple(s.t, 1e-4);
        ancf_table_apply(s.t, s.b.m, 1e-4, s.b.v, s.shift);
        after = kinetic_of_field(&s.b, s.b.v);
        for (int i = 0; i < s.n_bodies; ++i) after += kinetic_of_solid(&s.solid[i], ancf_table_body(s.t, i));
        for (int k = 0; k < s.n; ++k) taken += 0.5 * dot(start[k], ancf_table_coupling(s.t, k)->impulse);
        assert_near(before - after, taken, 1e-12 * before);
        assert_true(taken > 0.0);
        scene_free(&s);
    }
}

// Pressed by a contact, the body and its knots stay together through all sub-steps and at the end.
static void contacts_keep_couplings(void** state) {
    (void)state;
    uint64_t seed = 75;
    for (int run = 0; run < 40; ++run) {
        const double step = 1e-4;
        scene s = scene_make(MANY, run, &seed);
        for (int k = 0; k < s.n; ++k) memset(ancf_table_coupling(s.t, k)->ahead, 0, 3 * sizeof(double));
        ancf_body wall = {.position = {0.0, 0.0, 0.0}};
        ancf_contact c = {.side = {{-1, 0, {0.02, -0.01, 0.03}}, {-1, 1, {0.0, 0.0, 0.0}}},
                          .law = {ANCF_NORMAL_HERTZ, 1e7, 1.5, 0.0}};
        double v[3], before, after;
        random_direction(c.normal, &seed);
        ancf_table_add_body(s.t, &wall);
        ancf_table_add_contact(s.t, &c);
        assert_int_equal(ancf_table_prepare(s.t, s.b.m, s.b.v), ANCF_OK);
        ancf_table_couple(s.t, step);
        ancf_contact* touching = ancf_table_contact(s.t, 0);
        ancf_table_slip(v, s.t, touching);
        if (dot(v, touching->normal) > 0.0)
            for (int i = 0; i < 3; ++i) touching->normal[i] *= -1.0;
        ancf_body b = *ancf_table_body(s.t, 0);
        double* field = calloc(6 * (size_t)s.b.stride, sizeof *field);
        memcpy(field, s.b.v, 3 * (size_t)s.b.stride * sizeof *field);
        ancf_table_apply(s.t, s.b.m, step, field, field + 3 * s.b.stride);
        before = kinetic_of_field(&s.b, field) + kinetic_of_solid(&s.solid[0], &b);
        ancf_table_press(s.t, step, 40);
        ancf_table_apply(s.t, s.b.m, step, s.b.v, s.shift);
        b = *ancf_table_body(s.t, 0);
        after = kinetic_of_field(&s.b, s.b.v) + kinetic_of_solid(&s.solid[0], &b);
        assert_true(touching->impulse > 0.0);
        assert_near(after + touching->energy, before, 1e-6 * before);
        for (int k = 0; k < s.n; ++k) {
            missing(v, &s, k, s.b.v, &b);
            assert_near(norm(v), 0.0, 1e-12);
        }
        free(field);
        scene_free(&s);
    }
}

// Bodies off their centres on so many knots of a square net; each step begins as the first.
typedef struct {
    built b;
    int n;
    double time; // of all steps in the solver [s]
    ancf_table* t;
    solid* solid;
    double *before, *shift;
} full_net;

static full_net full_make(int meshes, int bodies, int mass, uint64_t* seed) {
    full_net f = {.b = build_net(meshes, (ancf_element) {.kind = mass, .length = 0.3, .ea = 1.0, .rho_a = 0.05})};
    build_shake(&f.b, f.b.v, 1.0, seed);
    build_finish(&f.b);
    f.n = bodies;
    f.solid = calloc((size_t)f.n, sizeof *f.solid);
    f.before = velocity_before(&f.b);
    f.shift = f.before + 3 * f.b.stride;
    for (int i = 0; i < f.n; ++i) {
        const double size = random_magnitude(seed, 1e-2, 1.0);
        f.solid[i] = random_solid(seed, size, 1e-3 * size);
        ancf_body* body = &f.solid[i].body;
        random_vector(body->velocity, seed, 1.0);
        random_vector(body->spin, seed, 5.0);
        random_vector(body->position, seed, 0.05);
        for (int c = 0; c < 3; ++c) body->position[c] += f.b.x[c * f.b.stride + i];
    }
    assert_int_equal(ancf_table_create(&f.t, f.b.m), ANCF_OK);
    return f;
}

static void full_step(full_net* f) {
    memcpy(f->b.v, f->before, 3 * (size_t)f->b.stride * sizeof *f->b.v);
    memset(f->shift, 0, 3 * (size_t)f->b.stride * sizeof *f->shift);
    ancf_table_clear(f->t);
    for (int i = 0; i < f->n; ++i) {
        ancf_coupling c = {.body = ancf_table_add_body(f->t, &f->solid[i].body),
                           .place = ancf_table_add_knot(f->t, f->b.m, i)};
        for (int k = 0; k < 3; ++k) c.arm[k] = f->b.x[k * f->b.stride + i] - f->solid[i].body.position[k];
        ancf_table_add_coupling(f->t, &c);
    }
    const clock_t start = clock();
    assert_int_equal(ancf_table_prepare(f->t, f->b.m, f->b.v), ANCF_OK);
    ancf_table_couple(f->t, 1e-4);
    ancf_table_apply(f->t, f->b.m, 1e-4, f->b.v, f->shift);
    f->time += (double)(clock() - start) / CLOCKS_PER_SEC;
}

static void full_free(full_net* f) {
    ancf_table_destroy(f->t);
    free(f->solid);
    free(f->before);
    build_free(&f->b);
}

// Shortest CPU time of 20 steps, in several [s].
static double time_of_full(int meshes, int bodies, int mass, uint64_t* seed) {
    full_net f = full_make(meshes, bodies, mass, seed);
    double least = INFINITY;
    full_step(&f); // makes the responses
    for (int run = 0; run < 10; ++run) {
        f.time = 0.0;
        for (int i = 0; i < 20; ++i) full_step(&f);
        least = fmin(least, f.time);
    }
    full_free(&f);
    return least;
}

static void many_couplings_hold(void** state) {
    (void)state;
    uint64_t seed = 77;
    for (int mass = 0; mass <= ANCF_LUMPED; mass += ANCF_LUMPED) {
        full_net f = full_make(12, 169, mass, &seed);
        double P0[3], H0[3], P[3], H[3], terms[2], worst = 0.0;
        own_momentum(P0, H0, terms, &f.b);
        for (int i = 0; i < f.n; ++i) add_momentum(P0, H0, terms, &f.solid[i], &f.solid[i].body);
        full_step(&f);
        own_momentum(P, H, terms, &f.b);
        for (int i = 0; i < f.n; ++i) {
            double v[3];
            add_momentum(P, H, terms, &f.solid[i], ancf_table_body(f.t, i));
            body_point_velocity(v, ancf_table_body(f.t, i), ancf_table_coupling(f.t, i)->arm);
            for (int c = 0; c < 3; ++c) worst = fmax(worst, fabs(v[c] - f.b.v[c * f.b.stride + i]));
        }
        assert_true(worst < 1e-12);
        for (int i = 0; i < 3; ++i) {
            assert_near(P[i], P0[i], 1e-13 * terms[0]);
            assert_near(H[i], H0[i], 1e-13 * terms[1]);
        }
        full_free(&f);
        const double many = time_of_full(12, 169, mass, &seed) / time_of_full(5, 36, mass, &seed),
                     few = time_of_full(50, 4, mass, &seed) / time_of_full(10, 4, mass, &seed);
        print_message("169 couplings take %.1f times as long as 36; 4 in a net of 50 x 50 %.1f of those in 10 x 10\n",
                      many, few);
        assert_true(many < 8.0); // 4.7 times as many
        assert_true(few < 4.0);
    }
}

// A cable of which nothing is free holds a body at a point: all of the point's velocity is gone, and the spin about it
// stays.
static void nothing_is_free(void** state) {
    (void)state;
    const ancf_element all = {.length = 1.0, .ea = 1.0, .rho_a = 0.1};
    uint64_t seed = 78;
    built b = build_cable(1, all, 0);
    for (int i = 0; i < b.n_dof; ++i) b.hold[i] = ANCF_HELD;
    build_finish(&b);
    solid s = random_solid(&seed, 0.3, 1e-3);
    ancf_body* body = &s.body;
    body->position[0] = 1.1;
    random_vector(body->velocity, &seed, 1.0);
    random_vector(body->spin, &seed, 5.0);
    ancf_table* t;
    assert_int_equal(ancf_table_create(&t, b.m), ANCF_OK);
    ancf_table_clear(t);
    ancf_coupling c = {
        .body = ancf_table_add_body(t, body), .place = ancf_table_add_knot(t, b.m, 1), .arm = {-0.1, 0.0, 0.0}};
    ancf_table_add_coupling(t, &c);
    double* v = velocity_before(&b);
    assert_int_equal(ancf_table_prepare(t, b.m, v), ANCF_OK);
    ancf_table_couple(t, 1e-4);
    ancf_table_apply(t, b.m, 1e-4, v, v + 3 * b.stride);
    const ancf_body* after = ancf_table_body(t, 0);
    double point[3], more[3], about[2][3];
    body_point_velocity(point, after, c.arm);
    assert_true(norm(point) < 1e-14);
    for (int k = 0; k < 2; ++k) { // angular momentum about the knot
        const ancf_body* is = k ? after : body;
        const double way[3] = {0.1, 0.0, 0.0};
        cross(more, way, is->velocity);
        for (int i = 0; i < 3; ++i) about[k][i] = s.mass * more[i] + dot(s.inertia + 3 * i, is->spin);
    }
    for (int i = 0; i < 3; ++i) assert_near(about[1][i], about[0][i], 1e-14);
    ancf_table_destroy(t);
    free(v);
    build_free(&b);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(couplings_hold),
        cmocka_unit_test(momentum_is_exchanged),
        cmocka_unit_test(impulses_are_those_of_a_dense_solve),
        cmocka_unit_test(coupling_gives_no_energy),
        cmocka_unit_test(contacts_keep_couplings),
        cmocka_unit_test(many_couplings_hold),
        cmocka_unit_test(nothing_is_free),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
