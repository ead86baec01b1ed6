// Nodes that slide along lines: against the equations of motion with multipliers, conserved quantities, closed forms,
// and against nodes that are held or free where a line makes one of them.
#include "touch.h"

#include "ancf/equilibrium.h"
#include "ancf/implicit.h"
#include "drag.h"
#include "lever.h"
#include "settle.h"

#include <float.h>

static const int kinds[] = {0, ANCF_LUMPED, ANCF_SPRING, ANCF_LUMPED | ANCF_ENGINEERING};
enum { KINDS = sizeof kinds / sizeof *kinds };

static ancf_element element_of(int kind) {
    return (ancf_element) {.kind = kind,
                           .length = kind == ANCF_SPRING ? 0.3 : 2.1,
                           .ea = 40.0,
                           .ei = kind & ANCF_SPRING ? 0.0 : 2e-3,
                           .rho_a = 0.05};
}

// A cable that goes on smoothly, a cable of separate elements or a net, of which some nodes slide.
static built random_model(int run, uint64_t* seed, bool parallel) {
    ancf_element all = element_of(kinds[run % KINDS]);
    const int spring = all.kind & ANCF_SPRING, layout = run / KINDS % 3;
    if (layout == 2) all.length = 0.3;
    else if (spring) all.length = 2.1;
    built b = layout == 2 ? build_net(2, all) : build_cable(7, all, layout == 0 && !spring);
    build_shake(&b, b.x, 0.1, seed);
    build_shake(&b, b.v, 0.5, seed);
    b.mass[2] = 0.1;
    const int sliding[] = {0, 3, 4, 7};
    double direction[3];
    random_direction(direction, seed);
    for (int k = 0; k < 1 + run % BUILD_SLIDES; ++k) {
        if (!parallel) random_direction(direction, seed);
        build_slide(&b, sliding[k], direction);
    }
    return b;
}

static double across_line(double part[3], const ancf_slide* s, const double v[3]) {
    const double length = dot(s->along, v);
    for (int c = 0; c < 3; ++c) part[c] = v[c] - length * s->along[c];
    return length;
}

static void at_node(double v[3], const built* b, const double* field, int node) {
    for (int c = 0; c < 3; ++c) v[c] = field[c * b->stride + node];
}

// M field, summed up here over elements, both copies of a shared slope the sum.
static void own_multiply(double* product, const built* b, const double* field) {
    memset(product, 0, 3 * (size_t)b->stride * sizeof *product);
    for (int c = 0; c < 3; ++c) {
        for (int e = 0; e < b->def.n_elements; ++e) {
            double M[4][4];
            int dof[4];
            own_mass(M, &b->element[e]);
            ancf_model_dofs(dof, b->m, e);
            for (int i = 0; i < 4; ++i)
                for (int j = 0; j < 4; ++j) product[c * b->stride + dof[i]] += M[i][j] * field[c * b->stride + dof[j]];
        }
        for (int i = 0; i < b->def.n_nodes; ++i) product[c * b->stride + i] += b->mass[i] * field[c * b->stride + i];
    }
    ancf_model_join(b->m, product);
}

// M a = f + forces across the lines, and a as given across: these conditions have one solution.
static void accelerations_solve_the_equations(void** state) {
    (void)state;
    uint64_t seed = 91;
    for (int run = 0; run < 120; ++run) {
        built b = random_model(run, &seed, false);
        const size_t n = 3 * (size_t)b.stride;
        if (run % 2) b.hold[5] = ANCF_HELD;
        if (run % 2 && kinds[run % KINDS] != ANCF_SPRING) b.hold[b.def.n_nodes + 3] = ANCF_HELD; // a sliding clamp
        build_finish(&b);
        double *f = calloc(3 * n, sizeof *f), *a = f + n, *left = a + n, largest = 0.0;
        for (int c = 0; c < 3; ++c)
            for (int i = 0; i < b.n_dof; ++i) {
                f[c * b.stride + i] = random_between(&seed, -1.0, 1.0);
                a[c * b.stride + i] = random_between(&seed, -10.0, 10.0);
            }
        if (kinds[run % KINDS] == ANCF_SPRING)
            for (int c = 0; c < 3; ++c)
                for (int i = b.def.n_nodes; i < b.n_dof; ++i) f[c * b.stride + i] = a[c * b.stride + i] = 0.0;
        build_share(&b, a);
        ancf_model_join(b.m, f);
        double given[BUILD_SLIDES][3];
        for (int k = 0; k < b.def.n_slides; ++k) at_node(given[k], &b, a, b.slide[k].node);
        ancf_mass_solve(b.m, a, f);
        own_multiply(left, &b, a);
        for (size_t i = 0; i < n; ++i) {
            largest = fmax(largest, fabs(left[i]) + fabs(f[i]));
            left[i] -= f[i];
        }
        for (int k = 0; k < b.def.n_slides; ++k) {
            double force[3], part[3], wanted[3], found[3];
            at_node(force, &b, left, b.slide[k].node);
            assert_near(across_line(part, &b.slide[k], force), 0.0, 1e-12 * largest);
            for (int c = 0; c < 3; ++c) left[c * b.stride + b.slide[k].node] = 0.0;
            at_node(force, &b, a, b.slide[k].node);
            across_line(found, &b.slide[k], force);
            across_line(wanted, &b.slide[k], given[k]);
            for (int c = 0; c < 3; ++c) assert_near(found[c], wanted[c], 1e-13 * norm(force));
        }
        for (int c = 0; c < 3; ++c)
            for (int i = 0; i < b.n_dof; ++i)
                if (!b.m->hold[i]) assert_near(left[c * b.stride + i], 0.0, 1e-12 * largest);
        free(f);
        build_free(&b);
    }
}

// Velocities that the lines allow.
static void go_along(built* b) {
    for (int k = 0; k < b->def.n_slides; ++k) {
        double v[3];
        at_node(v, b, b->v, b->slide[k].node);
        const double length = dot(b->slide[k].along, v);
        for (int c = 0; c < 3; ++c) b->v[c * b->stride + b->slide[k].node] = length * b->slide[k].along[c];
    }
}

static void assert_on_lines(const built* b) {
    for (int k = 0; k < b->def.n_slides; ++k) {
        double x[3], v[3], part[3];
        at_node(x, b, b->x, b->slide[k].node);
        at_node(v, b, b->v, b->slide[k].node);
        for (int c = 0; c < 3; ++c) x[c] -= b->slide[k].at[c];
        across_line(part, &b->slide[k], x);
        assert_near(norm(part), 0.0, 4.0 * DBL_EPSILON * (1.0 + norm(b->slide[k].at)));
        across_line(part, &b->slide[k], v);
        assert_near(norm(part), 0.0, 4.0 * DBL_EPSILON * norm(v));
    }
}

// Where all lines are parallel, momentum along them is kept; what is across changes by what holds the nodes, also in
// the first step where they come with velocities across.
static void momentum_along_is_kept(void** state) {
    (void)state;
    uint64_t seed = 92;
    double largest = 0.0;
    for (int run = 0; run < 48; ++run) {
        built b = random_model(run, &seed, true);
        build_finish(&b);
        if (run / 12 % 2) go_along(&b);
        const double h = 2e-5, *d = b.slide[0].along;
        double P0[3], P[3], H[3], terms[2], given[3] = {0.0, 0.0, 0.0};
        ancf_time time = {h, h};
        own_momentum(P0, H, terms, &b);
        for (int i = 0; i < 2000; ++i) {
            if (run % 2) {
                ancf_advance(b.m, &time);
            } else {
                ancf_predict(b.m, &time);
                ancf_correct(b.m, &time, b.m->free, NULL);
            }
            for (int k = 0; k < b.def.n_slides; ++k) {
                double force[3];
                ancf_reaction(force, b.m, b.slide[k].node);
                assert_near(dot(force, d), 0.0, 4.0 * DBL_EPSILON * norm(force) + 1e-25);
                for (int c = 0; c < 3; ++c) given[c] += h * force[c];
            }
        }
        assert_on_lines(&b);
        own_momentum(P, H, terms, &b);
        for (int c = 0; c < 3; ++c) P[c] -= P0[c];
        assert_near(dot(P, d), 0.0, 1e-12 * terms[0]);
        for (int c = 0; c < 3; ++c) assert_near(P[c] - given[c], 0.0, 1e-12 * terms[0]);
        largest = fmax(largest, norm(given) / terms[0]);
        build_free(&b);
    }
    assert_true(largest > 0.1);
}

// How far the energy goes from where it was, in steps of h, at the positions that they start from.
static double energy_off(int run, double h) {
    uint64_t seed = 93 + (uint64_t)run;
    built b = random_model(run, &seed, false);
    b.mass[2] = 0.0; // ancf_kinetic_kept is that of elements
    build_finish(&b);
    go_along(&b);
    double first = 0.0, most = 0.0, largest = 0.0;
    ancf_time time = {h, 0.0};
    for (int i = 0; i < (int)(0.02 / h + 0.5); ++i) {
        double axial, bending;
        ancf_predict(b.m, &time);
        ancf_elastic_energy(&axial, &bending, b.m, b.x, 0, b.def.n_elements);
        const double now = axial + bending + ancf_kinetic_kept(b.m, time.last, 0.0);
        if (i == 0) first = now;
        most = fmax(most, fabs(now - first));
        largest = fmax(largest, now);
        ancf_correct(b.m, &time, b.m->free, NULL);
        time.last = h;
    }
    build_free(&b);
    return most / largest;
}

static void energy_is_kept_to_second_order(void** state) {
    (void)state;
    for (int run = 0; run < 12; ++run) {
        const double coarse = energy_off(run, 2e-5), fine = energy_off(run, 1e-5);
        print_message("%g %g\n", coarse, fine);
        assert_true(coarse < 1e-3);
        assert_near(coarse / fine, 4.0, 0.4);
    }
}

// The schemes go to one motion, where lines lie anyhow and one node is clamped besides.
static void schemes_agree(void** state) {
    (void)state;
    for (int run = 0; run < 12; ++run) {
        double* x[3];
        int n = 0;
        for (int scheme = 0; scheme < 3; ++scheme) {
            uint64_t seed = 94 + (uint64_t)run;
            built b = random_model(run, &seed, false);
            if (kinds[run % KINDS] != ANCF_SPRING) b.hold[b.def.n_nodes] = ANCF_HELD;
            build_finish(&b);
            go_along(&b);
            for (int c = 0; c < 3 && b.hold[b.def.n_nodes]; ++c) b.v[c * b.stride + b.def.n_nodes] = 0.0;
            b.m->gravity[2] = -9.81;
            const double h = 2e-6;
            ancf_time time = {h, 0.0};
            ancf_implicit* implicit;
            double* a = calloc(3 * (size_t)b.stride, sizeof *a);
            assert_int_equal(ancf_implicit_create(&implicit, b.m, 0.9), ANCF_OK);
            for (int i = 0; i < 2000; ++i) {
                if (scheme == 0) ancf_advance(b.m, &time);
                if (scheme == 1) ancf_rk4(b.m, h);
                if (scheme == 2) assert_int_equal(ancf_implicit_step(implicit, b.m, a, &time, 1), ANCF_OK);
                time.last = h;
            }
            assert_on_lines(&b);
            n = 3 * b.stride;
            x[scheme] = malloc((size_t)n * sizeof *x[scheme]);
            memcpy(x[scheme], b.x, (size_t)n * sizeof *x[scheme]);
            free(a);
            ancf_implicit_destroy(implicit);
            build_free(&b);
        }
        for (int i = 0; i < n; ++i) {
            assert_near(x[0][i], x[1][i], 2e-7);
            assert_near(x[2][i], x[1][i], 2e-7);
        }
        for (int scheme = 0; scheme < 3; ++scheme) free(x[scheme]);
    }
}

// A taut string of which one end slides across it swings as a quarter of a wave: w = pi/(2 L) sqrt(T/(rho A)).
static void a_string_swings_as_a_quarter_wave(void** state) {
    (void)state;
    const double pi = 3.14159265358979323846, L = 1.0, T = 50.0, rho = 0.02, w = 0.5 * pi / L * sqrt(T / rho);
    for (int run = 0; run < 4; ++run) {
        const int n = 24, lumped = run % 2;
        built b =
            build_cable(n, (ancf_element) {.kind = lumped ? ANCF_LUMPED : 0, .length = L, .ea = 1e3, .rho_a = rho}, 1);
        double e = T / 1e3; // T = EA e sqrt(1 + 2 e), by Newton's method
        for (int k = 0; k < 30; ++k)
            e -= (1e3 * e * sqrt(1.0 + 2.0 * e) - T) / (1e3 * (1.0 + 3.0 * e) / sqrt(1.0 + 2.0 * e));
        const double stretch = sqrt(1.0 + 2.0 * e), size = 1e-5, along[3] = {0.0, 0.0, -2.0};
        const double real_w = w / sqrt(stretch); // L and rho A are those of the unstressed string
        for (int i = 0; i < 3 * b.stride; ++i) b.x[i] *= stretch;
        for (int i = 0; i <= n; ++i) b.x[2 * b.stride + i] = size * sin(0.5 * pi * i / n);
        for (int k = 0; k < n; ++k) {
            b.x[2 * b.stride + b.def.n_nodes + k] = size * 0.5 * pi / L * cos(0.5 * pi * k / n);
            b.x[2 * b.stride + b.def.n_nodes + n + k] = size * 0.5 * pi / L * cos(0.5 * pi * (k + 1) / n);
        }
        b.hold[0] = ANCF_HELD;
        build_slide(&b, n, along);
        build_finish(&b);
        ancf_implicit* implicit;
        double* a = calloc(3 * (size_t)b.stride, sizeof *a);
        assert_int_equal(ancf_implicit_create(&implicit, b.m, 1.0), ANCF_OK);
        // A quarter of the period after its largest, it goes through 0.
        const double quarter = 0.5 * pi / real_w, h = run < 2 ? 1e-6 : 1e-4;
        ancf_time time = {h, 0.0};
        double before = 1.0, crossed = 0.0;
        for (int i = 0; i < (int)(1.5 * quarter / h) && crossed == 0.0; ++i) {
            if (run < 2) ancf_advance(b.m, &time);
            else assert_int_equal(ancf_implicit_step(implicit, b.m, a, &time, 1), ANCF_OK);
            time.last = h;
            const double now = b.x[2 * b.stride + n];
            if (now <= 0.0) crossed = h * (i + before / (before - now));
            before = now;
        }
        print_message("a quarter takes %.6g of %.6g s\n", crossed, quarter);
        assert_near(crossed / quarter, 1.0, 2e-4);
        free(a);
        ancf_implicit_destroy(implicit);
        build_free(&b);
    }
}

// A beam whose one clamp slides across it: F L^3/(12 E I), by Newton's method.
static void a_guided_beam_bends_by_a_twelfth(void** state) {
    (void)state;
    const double L = 1.0, EI = 2.0, F = 1e-4;
    for (int run = 0; run < 2; ++run) {
        const int n = 6;
        built b = build_cable(n, (ancf_element) {.length = L, .ea = 1e3, .ei = EI, .rho_a = 0.1}, 1);
        b.hold[0] = b.hold[b.def.n_nodes] = b.hold[b.n_dof - 1] = ANCF_HELD;
        const double along[3] = {0.0, 0.6, 0.8};
        build_slide(&b, n, along);
        build_finish(&b);
        for (int c = 0; c < 3; ++c) b.m->external[c * b.stride + n] = F * (along[c] + (c == 0 ? 3.0 : 0.0));
        if (run == 0) assert_true(ancf_settle(b.m, 1e-10, NULL));
        else assert_int_equal(ancf_equilibrium(b.m, 1e-10, 400000, NULL), ANCF_OK);
        assert_on_lines(&b);
        double x[3], reaction[3];
        at_node(x, &b, b.x, n);
        x[0] -= L;
        assert_near(dot(x, along), F * L * L * L / (12.0 * EI), 1e-6 * F * L * L * L / (12.0 * EI));
        memset(b.v, 0, 3 * (size_t)b.stride * sizeof *b.v);
        ancf_acceleration(b.m, b.x, b.v);
        ancf_reaction(reaction, b.m, n);
        assert_near(reaction[0], -3.0 * F, 1e-3 * F); // all of the load along the beam, which stays as long as it is
        build_free(&b);
    }
}

// ---------------------------------------------------------------- contact

enum { CONTACTS = 5 };

typedef struct {
    built b;
    ancf_table* t;
    solid body[CONTACTS];
    double *before, *shift;
} touching;

typedef enum { SLIDES, HELD, FREE } holding;

// Balls that touch a cable near nodes that slide along z, or are held, or free; all of it across z or along it.
static touching touching_make(int run, holding how, bool along, bool rubs, uint64_t* seed) {
    const int sliding[] = {0, 2, 3};
    ancf_element all = element_of(kinds[run % KINDS]);
    all.length = 2.1;
    touching s = {.b = build_cable(7, all, run / KINDS % 2 && !(all.kind & ANCF_SPRING))};
    built* b = &s.b;
    build_shake(b, b->v, 0.5, seed);
    for (int c = 0; c < 3; ++c)
        for (int i = 0; i < b->n_dof; ++i)
            if ((c == 2) != along) b->v[c * b->stride + i] = 0.0;
    for (int k = 0; k < 3; ++k) {
        for (int c = 0; c < 2; ++c) b->v[c * b->stride + sliding[k]] = 0.0;
        if (how == HELD) b->hold[sliding[k]] = ANCF_HELD;
        if (how == SLIDES) build_slide(b, sliding[k], (const double[3]) {0.0, 0.0, 3.0});
    }
    build_finish(b);
    assert_int_equal(ancf_table_create(&s.t, b->m), ANCF_OK);
    s.before = velocity_before(b);
    s.shift = s.before + 3 * b->stride;
    for (int k = 0; k < CONTACTS; ++k) {
        s.body[k] = random_solid(seed, random_magnitude(seed, 1e-2, 1.0), 0.0);
        ancf_body* body = &s.body[k].body;
        const double angle = random_between(seed, 0.0, 6.28);
        double n[3] = {along ? 0.0 : cos(angle), along ? 0.0 : sin(angle), along ? 1.0 : 0.0};
        ancf_contact c = {.side = {{-1, -1, {0.0}}, {-1, k, {0.0}}},
                          .gap = random_between(seed, -1e-4, 1e-5),
                          .law = {ANCF_NORMAL_HERTZ, 1e6, 1.5, 0.0},
                          .rub = {rubs ? ANCF_FRICTION_COULOMB : ANCF_FRICTION_NONE, 0.5, 0.4, 0.01}};
        c.plain = c.law;
        memcpy(c.normal, n, sizeof n);
        c.side[0].place = ancf_table_add_place(s.t, b->m, k, random_between(seed, 0.0, 1.0));
        random_vector(body->velocity, seed, 1.0);
        for (int i = 0; i < 3; ++i)
            if ((i == 2) != along) body->velocity[i] = 0.0;
        assert_int_equal(ancf_table_add_body(s.t, body), k);
        assert_int_equal(ancf_table_add_contact(s.t, &c), k);
    }
    assert_int_equal(ancf_table_prepare(s.t, b->m, b->v), ANCF_OK);
    return s;
}

static void touching_solve(touching* s, double step) {
    int stiffest;
    double left;
    ancf_table_guess(s->t, step);
    assert_true(ancf_table_press(s->t, step, 3 * ancf_table_substeps(s->t, step, &stiffest)) < 1e-4);
    ancf_table_rub(s->t, step, &left);
    assert_true(left < 1e-4);
    ancf_table_apply(s->t, s->b.m, step, s->b.v, s->shift);
}

static void touching_free(touching* s) {
    ancf_table_destroy(s->t);
    free(s->before);
    build_free(&s->b);
}

// Across its line a node that slides is one that is held; along it, one that is free.
static void contacts_feel_lines(void** state) {
    (void)state;
    int pressed = 0, rubbed = 0;
    for (int run = 0; run < 160; ++run) {
        const bool along = run / 8 % 2, rubs = run / 16 % 2;
        uint64_t seed = 95 + (uint64_t)run, again = seed;
        touching s = touching_make(run, SLIDES, along, rubs, &seed),
                 own = touching_make(run, along ? FREE : HELD, along, rubs, &again);
        const double step = 1e-4;
        double largest = 0.0, fastest = 0.0;
        touching_solve(&s, step);
        touching_solve(&own, step);
        for (int i = 0; i < 3 * s.b.stride; ++i) fastest = fmax(fastest, fabs(own.b.v[i]));
        for (int k = 0; k < CONTACTS; ++k) largest = fmax(largest, ancf_table_contact(own.t, k)->impulse);
        for (int k = 0; k < CONTACTS; ++k) {
            const ancf_contact *c = ancf_table_contact(s.t, k), *d = ancf_table_contact(own.t, k);
            assert_near(c->impulse, d->impulse, 1e-4 * largest);
            for (int i = 0; i < 3; ++i) assert_near(step * c->friction[i], step * d->friction[i], 1e-4 * largest);
            pressed += d->impulse > 0.0;
            rubbed += norm(d->friction) > 0.0;
        }
        for (int i = 0; i < 3 * s.b.stride; ++i) {
            assert_near(s.b.v[i], own.b.v[i], 1e-4 * fastest);
            assert_near(s.shift[i], own.shift[i], 1e-4 * step * fastest);
        }
        touching_free(&s);
        touching_free(&own);
    }
    assert_true(pressed > 400 && rubbed > 100);
}

// Whatever the directions are: velocities are what the impulses of contacts give by the mass matrix and the lines, no
// node leaves its line, and what presses without friction keeps the energy.
static void contacts_keep_lines(void** state) {
    (void)state;
    uint64_t seed = 96;
    for (int run = 0; run < 80; ++run) {
        const bool rubs = run / 8 % 2;
        touching s = touching_make(run % 2 + run / 2 * KINDS, SLIDES, run % 3 == 0, rubs, &seed); // no springs
        const double step = 1e-4;
        ancf_body bodies[CONTACTS];
        double J[CONTACTS][3], energy = 0.0, before = kinetic_of_field(&s.b, s.b.v), fastest = 0.0, v[3], part[3];
        for (int k = 0; k < CONTACTS; ++k) {
            ancf_contact* c = ancf_table_contact(s.t, k);
            random_direction(c->normal, &seed);
            bodies[k] = s.body[k].body;
            before += kinetic_of_solid(&s.body[k], &bodies[k]) + ancf_normal_energy(&c->law, -c->gap);
        }
        assert_int_equal(ancf_table_prepare(s.t, s.b.m, s.b.v), ANCF_OK);
        touching_solve(&s, step);
        for (int k = 0; k < CONTACTS; ++k) {
            const ancf_contact* c = ancf_table_contact(s.t, k);
            for (int i = 0; i < 3; ++i) J[k][i] = c->impulse * c->normal[i] + step * c->friction[i];
            energy += c->energy;
        }
        own_give(&s.b, s.t, s.before, bodies, CONTACTS, J);
        for (int i = 0; i < 3 * s.b.stride; ++i) fastest = fmax(fastest, fabs(s.before[i]));
        for (int i = 0; i < 3 * s.b.stride; ++i) assert_near(s.b.v[i], s.before[i], 1e-11 * fastest);
        for (int k = 0; k < s.b.def.n_slides; ++k) {
            at_node(v, &s.b, s.b.v, s.b.slide[k].node);
            across_line(part, &s.b.slide[k], v);
            assert_near(norm(part), 0.0, 1e-12 * fastest);
            at_node(v, &s.b, s.shift, s.b.slide[k].node);
            across_line(part, &s.b.slide[k], v);
            assert_near(norm(part), 0.0, 1e-12 * step * fastest);
        }
        for (int k = 0; k < CONTACTS; ++k) energy += kinetic_of_solid(&s.body[k], ancf_table_body(s.t, k));
        energy += kinetic_of_field(&s.b, s.b.v);
        if (!rubs) assert_near(energy, before, 1e-5 * before);
        touching_free(&s);
    }
}

// What friction of one contact does to the slip of another is what kicks do, couples on slopes among it, where lines
// lie anyhow.
static void friction_is_what_kicks_do(void** state) {
    (void)state;
    uint64_t seed = 97;
    for (int run = 0; run < 60; ++run) {
        built b =
            build_cable(9, (ancf_element) {.kind = run % 2 ? ANCF_LUMPED : 0, .length = 2.7, .ea = 1.0, .rho_a = 0.05},
                        run / 2 % 2);
        const int pairs[2][2] = {{1, 2}, {3, 7}};
        double direction[3], W[16];
        build_shake(&b, b.x, 0.1, &seed);
        for (int k = 0; k < 3; ++k) {
            random_direction(direction, &seed);
            build_slide(&b, 2 * k + 1, direction);
        }
        build_finish(&b);
        ancf_table* t;
        assert_int_equal(ancf_table_create(&t, b.m), ANCF_OK);
        for (int k = 0; k < 2; ++k) {
            ancf_contact c = {.radius = {0.01, 0.02}, .rub = {ANCF_FRICTION_COULOMB, 0.5, 0.4, 0.01}};
            for (int s = 0; s < 2; ++s) {
                c.side[s] =
                    (ancf_side) {ancf_table_add_slope(t, b.m, pairs[k][s], random_between(&seed, 0.0, 1.0)), -1, {0.0}};
            }
            random_direction(c.normal, &seed);
            random_vector(c.side[1].arm, &seed, 0.02);
            ancf_table_add_contact(t, &c);
        }
        assert_int_equal(ancf_table_prepare(t, b.m, b.v), ANCF_OK);
        for (int k = 0; k < 2; ++k) ancf_drag_find(t, k);
        ancf_drag_effects(W, t, (const int[]) {0, 1}, 2);
        for (int from = 0; from < 2; ++from)
            for (int k = 0; k < 2; ++k) {
                double before[2][3], after[3], old[2][2], found[2];
                const double unit[2] = {k == 0, k == 1};
                for (int i = 0; i < t->n_places; ++i) memset(t->place[i].pushed, 0, sizeof t->place[i].pushed);
                for (int to = 0; to < 2; ++to) {
                    t->drag[to].slip[0] = t->drag[to].slip[1] = 0.0;
                    ancf_table_slip(before[to], t, &t->contact[to]);
                    ancf_lever_slip(before[to], t, &t->contact[to]);
                    ancf_drag_slip(old[to], t, &t->contact[to], &t->drag[to]);
                }
                ancf_table_kick(t, &t->contact[from], t->drag[from].tangent[k], 1e-4);
                ancf_lever_kick(t, &t->contact[from], t->drag[from].tangent[k], 1e-4);
                ancf_drag_give(t, &t->contact[from], &t->drag[from], unit);
                for (int to = 0; to < 2; ++to) {
                    ancf_table_slip(after, t, &t->contact[to]);
                    ancf_lever_slip(after, t, &t->contact[to]);
                    ancf_drag_slip(found, t, &t->contact[to], &t->drag[to]);
                    for (int a = 0; a < 2; ++a) {
                        const double truth =
                            dot(after, t->drag[to].tangent[a]) - dot(before[to], t->drag[to].tangent[a]);
                        assert_near(found[a] - old[to][a], truth, 1e-10 * W[5 * (2 * from + k)]);
                        assert_near(W[(2 * to + a) * 4 + 2 * from + k], truth, 1e-10 * W[5 * (2 * from + k)]);
                    }
                }
            }
        ancf_table_destroy(t);
        build_free(&b);
    }
}

// Couplings with bodies off their centres hold beside it.
static void couplings_hold_beside_lines(void** state) {
    (void)state;
    uint64_t seed = 98;
    for (int run = 0; run < 60; ++run) {
        built b = random_model(run, &seed, false);
        build_finish(&b);
        go_along(&b);
        ancf_table* t;
        assert_int_equal(ancf_table_create(&t, b.m), ANCF_OK);
        double* before = velocity_before(&b);
        const int knots[] = {1, 2, 5};
        for (int k = 0; k < 3; ++k) {
            solid s = random_solid(&seed, 0.1, 1e-4);
            random_vector(s.body.velocity, &seed, 1.0);
            ancf_table_add_body(t, &s.body);
            ancf_coupling c = {.place = ancf_table_add_knot(t, b.m, knots[k]), .body = k, .arm = {0.01, -0.02, 0.0}};
            ancf_table_add_coupling(t, &c);
        }
        assert_int_equal(ancf_table_prepare(t, b.m, b.v), ANCF_OK);
        ancf_table_couple(t, 1e-4);
        ancf_table_apply(t, b.m, 1e-4, b.v, before + 3 * b.stride);
        for (int k = 0; k < 3; ++k) {
            const ancf_coupling* c = ancf_table_coupling(t, k);
            double v[3], knot[3];
            body_point_velocity(v, ancf_table_body(t, k), c->arm);
            at_node(knot, &b, b.v, knots[k]);
            for (int i = 0; i < 3; ++i) assert_near(v[i], knot[i], 1e-12);
            own_kick(&b, before, ancf_table_place(t, c->place)->element, ancf_table_place(t, c->place)->xi, c->impulse);
        }
        for (int i = 0; i < 3 * b.stride; ++i) assert_near(b.v[i], before[i], 1e-11);
        ancf_table_destroy(t);
        free(before);
        build_free(&b);
    }
}

static void bad_lines_are_refused(void** state) {
    (void)state;
    const ancf_slide good = {1, {0.0, 0.0, 1.0}, {0.0, 0.0, 0.0}};
    ancf_slide bad[] = {good, good, good, good, good};
    bad[0].node = -1;
    bad[1].node = 99;
    bad[2].node = 0; // held
    bad[3].along[2] = 1.1;
    bad[4].at[1] = NAN;
    for (int k = 0; k < 6; ++k) {
        built b = build_cable(3, element_of(0), 1);
        b.hold[0] = ANCF_HELD;
        build_finish(&b);
        ancf_def def = b.def;
        const ancf_slide twice[2] = {good, good};
        def.n_slides = k < 5 ? 1 : 2;
        def.slide = k < 5 ? &bad[k] : twice;
        ancf_model* m;
        int where;
        assert_int_equal(ancf_model_create(&m, &def, b.x, b.v, &where), ANCF_E_SLIDE);
        assert_int_equal(where, def.slide[0].node);
        assert_null(m);
        build_free(&b);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(accelerations_solve_the_equations),
        cmocka_unit_test(momentum_along_is_kept),
        cmocka_unit_test(energy_is_kept_to_second_order),
        cmocka_unit_test(schemes_agree),
        cmocka_unit_test(a_string_swings_as_a_quarter_wave),
        cmocka_unit_test(a_guided_beam_bends_by_a_twelfth),
        cmocka_unit_test(contacts_feel_lines),
        cmocka_unit_test(contacts_keep_lines),
        cmocka_unit_test(friction_is_what_kicks_do),
        cmocka_unit_test(couplings_hold_beside_lines),
        cmocka_unit_test(bad_lines_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
