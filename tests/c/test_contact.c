// The table of contacts, and friction of all contacts together, against closed forms and solves written here.
#include "touch.h"

static const ancf_friction hollars = {ANCF_FRICTION_HOLLARS, 0.3, 0.2, 1e-3};
static const ancf_friction constant = {ANCF_FRICTION_HOLLARS, 0.3, 0.3, 1e-3};

// Hollars' formula, Eq. 11.
static double mu(const ancf_friction* law, double speed) {
    const double s = speed / law->v0;
    return fmin(s, 1.0) * (law->mu_k + 2.0 * (law->mu_s - law->mu_k) / (1.0 + s * s));
}

// A mass at the first knot of a chain that has no other there, or a knot that is held.
typedef struct {
    built b;
    ancf_table* t;
    double *v, *shift;
} point;

static point point_make(double mass) {
    const ancf_element all = {.kind = ANCF_SPRING, .length = 1.0, .ea = 1.0, .rho_a = 1e-6};
    point p = {.b = build_cable(1, all, 0)};
    p.b.mass[0] = mass - 0.5e-6;
    if (mass == 0.0) p.b.mass[0] = 0.0;
    if (mass == 0.0) p.b.hold[0] = ANCF_HELD;
    build_finish(&p.b);
    assert_int_equal(ancf_table_create(&p.t, p.b.m), ANCF_OK);
    p.v = p.b.v;
    p.shift = calloc(3 * (size_t)p.b.stride, sizeof *p.shift);
    return p;
}

static void point_free(point* p) {
    ancf_table_destroy(p->t);
    free(p->shift);
    build_free(&p->b);
}

// A step in which a contact at the knot presses with a force: what friction does. The contact keeps its guess.
static int point_rub(point* p, ancf_contact* c, ancf_body* body, double force, double step) {
    double left;
    ancf_table_clear(p->t);
    c->side[0] = (ancf_side) {ancf_table_add_knot(p->t, p->b.m, 0), -1, {0}};
    c->side[1].place = -1;
    c->side[1].body = body ? ancf_table_add_body(p->t, body) : -1;
    ancf_table_add_contact(p->t, c);
    assert_int_equal(ancf_table_prepare(p->t, p->b.m, p->v), ANCF_OK);
    ancf_table_contact(p->t, 0)->impulse = force * step;
    const int sweeps = ancf_table_rub(p->t, step, &left);
    ancf_table_apply(p->t, p->b.m, step, p->v, p->shift);
    *c = *ancf_table_contact(p->t, 0);
    if (body) *body = *ancf_table_body(p->t, 0);
    return sweeps;
}

// A contact point of a net, pulled along the surface: mu(u) f_n = T gives 2.5786e-4 m/s, and explicit friction 0.045.
static void held_point_creeps_at_closed_form(void** state) {
    (void)state;
    const double mass = 2.3e-5, normal_force = 0.5, pull = 0.05, v0 = 1e-3, dt = 2e-5;
    double low = 0.0, high = v0; // mu = 0.1 on the rising branch
    for (int i = 0; i < 100; ++i) {
        const double s = 0.5 * (low + high);
        if (mu(&hollars, s) * normal_force < pull) low = s;
        else high = s;
    }
    assert_near(low, 2.58e-4, 1e-6); // measured by the prototype, NUMERICS
    point p = point_make(mass);
    ancf_contact c = {.normal = {0.0, 0.0, 1.0}, .rub = hollars};
    for (int i = 0; i < 3000; ++i) {
        p.v[0] += 0.6 * dt * pull / mass;
        p.v[p.b.stride] += 0.8 * dt * pull / mass;
        assert_true(point_rub(&p, &c, NULL, normal_force, dt) <= 3);
        assert_true(hypot(p.v[0], p.v[p.b.stride]) < 1.0001 * low); // never faster on the way
    }
    assert_close(hypot(p.v[0], p.v[p.b.stride]), low, 1e-10);
    assert_close(p.v[0], 0.6 * low, 1e-10);
    assert_near(c.friction[0], -0.6 * pull, 1e-12);
    assert_near(c.friction[1], -0.8 * pull, 1e-12);
    point_free(&p);
}

static void block_slides_to_rest(void** state) {
    (void)state;
    const double g = 9.81, speed = 1.0, dt = 1e-5, expected = speed * speed / (2.0 * 0.3 * g);
    point p = point_make(7.0);
    ancf_contact c = {.normal = {0.0, 1.0, 0.0}, .rub = {ANCF_FRICTION_COULOMB, 0.0, 0.3, 1e-5}};
    double way = 0.0, rubbed = 0.0;
    p.v[0] = speed;
    for (int i = 0; i < 60000; ++i) {
        point_rub(&p, &c, NULL, 7.0 * g, dt);
        way += dt * p.v[0];
        rubbed += c.rubbed;
        assert_true(p.v[0] >= 0.0);
    }
    assert_close(way, expected, 1e-4);
    assert_near(p.v[0], 0.0, 1e-12);
    assert_close(rubbed, 0.5 * 7.0 * speed * speed, 1e-9);                   // friction took all of it
    for (int i = 0; i < p.b.n_dof; ++i) assert_near(p.shift[i], 0.0, 1e-15); // it acts through the whole step
    point_free(&p);
}

// On a slope with tan(angle) = 0.5 and mu = 0.3 the acceleration is g (sin - 0.3 cos).
static void block_slides_down_a_slope(void** state) {
    (void)state;
    const double g = 9.81, angle = atan(0.5), dt = 1e-4, mass = 3.0;
    point p = point_make(mass);
    ancf_contact c = {.normal = {0.0, 0.0, 1.0}, .rub = {ANCF_FRICTION_COULOMB, 0.0, 0.3, 1e-6}};
    for (int i = 0; i < 10000; ++i) {
        p.v[0] += dt * g * sin(angle);
        point_rub(&p, &c, NULL, mass * g * cos(angle), dt);
    }
    assert_close(p.v[0], g * (sin(angle) - 0.3 * cos(angle)), 1e-6);
    point_free(&p);
}

// A sphere on a fixed axle, rubbed at its equator: w falls by mu f_n R/I each second.
static void sphere_spins_down(void** state) {
    (void)state;
    const double R = 0.1, inertia = 2e-3, normal_force = 4.0, spin = 20.0, dt = 1e-4;
    for (int looseaxes = 1; looseaxes <= 3; looseaxes += 2) { // a sheave turns about its axle alone
        point p = point_make(0.0);
        ancf_body sphere = {.position = {-R, 0.0, 0.0}, .spin = {0.0, 0.0, spin}};
        for (int i = 3 - looseaxes; i < 3; ++i) sphere.inv_inertia[4 * i] = 1.0 / inertia;
        ancf_contact c = {.side = {{0}, {-1, 0, {R, 0.0, 0.0}}},
                          .normal = {1.0, 0.0, 0.0},
                          .rub = {ANCF_FRICTION_COULOMB, 0.0, 0.25, 1e-6}};
        const double rate = 0.25 * normal_force * R / inertia;
        double turned = 0.0, rubbed = 0.0;
        for (int i = 0; i < 12000; ++i) {
            const double before = sphere.spin[2];
            point_rub(&p, &c, &sphere, normal_force, dt);
            if (i < 2000) turned += dt * before + sphere.turn[2];
            rubbed += c.rubbed;
            if (i != 1999) continue;
            assert_close(sphere.spin[2], spin - 0.2 * rate, 1e-9);
            assert_close(c.friction[1], 0.25 * normal_force, 1e-12);
            assert_close(sphere.twist[2], -0.25 * normal_force * R * dt, 1e-12);
            assert_close(turned, 0.2 * spin - 0.5 * 0.2 * (0.2 + dt) * rate, 1e-9);
        }
        assert_near(sphere.spin[2], 0.0, 1e-9);
        assert_close(rubbed, 0.5 * inertia * spin * spin, 1e-9);
        point_free(&p);
    }
}

// A surface that moves under the point drags it along: v tends to the surface's velocity at the centreline.
static void spinning_body_drags_the_point(void** state) {
    (void)state;
    point p = point_make(0.01);
    ancf_body drum = {.position = {0.0, 0.0, -0.3}, .spin = {0.0, 2.0, 0.0}, .velocity = {0.1, 0.0, 0.0}};
    ancf_contact c = {.side = {{0}, {-1, 0, {0.0, 0.0, 0.3}}}, .normal = {0.0, 0.0, 1.0}, .rub = hollars};
    for (int i = 0; i < 3000; ++i) point_rub(&p, &c, &drum, 1.0, 1e-4);
    assert_near(p.v[0], 0.1 + 2.0 * 0.3, 1e-9); // (0,2,0) x (0,0,0.3) = (0.6,0,0)
    assert_true(drum.spin[1] == 2.0 && drum.velocity[0] == 0.1);
    point_free(&p);
}

// Pressed in sub-steps, then rubbed: a body thrown on the ground aslant loses mu times what it gains across.
static void impact_rubs_by_its_impulse(void** state) {
    (void)state;
    const double mass = 0.02, step = 1e-3;
    for (int phase = 0; phase < 20; ++phase) {
        point p = point_make(mass);
        const double gap = 2.0 * step * (phase + 0.5) / 20.0;
        double left, normal = 0.0, vx = 5.0, vz = -2.0, at = gap, rubbed = 0.0, damped = 0.0;
        for (int i = 0; i < 30; ++i) {
            int stiffest;
            ancf_contact c = {.side = {{-1, 0, {0}}, {-1, -1, {0}}},
                              .normal = {0.0, 0.0, 1.0},
                              .gap = at,
                              .law = {ANCF_NORMAL_NONLINEAR, 1e5, 1.5, 0.1},
                              .rub = {ANCF_FRICTION_COULOMB, 0.0, 0.25, 1e-3}};
            ancf_body body = {.velocity = {vx, 0.0, vz}, .inv_mass = {1.0 / mass, 1.0 / mass, 1.0 / mass}};
            ancf_table_clear(p.t);
            ancf_table_add_body(p.t, &body);
            ancf_table_add_contact(p.t, &c);
            assert_int_equal(ancf_table_prepare(p.t, p.b.m, p.v), ANCF_OK);
            ancf_table_press(p.t, step, ancf_table_substeps(p.t, step, &stiffest));
            ancf_table_rub(p.t, step, &left);
            c = *ancf_table_contact(p.t, 0);
            body = *ancf_table_body(p.t, 0);
            assert_close(body.impulse[0], -0.25 * c.impulse, 1e-12); // slides all the time
            assert_close(body.impulse[2], c.impulse, 1e-12);
            normal += c.impulse;
            rubbed += c.rubbed;
            damped += c.damped;
            vx = body.velocity[0];
            vz = body.velocity[2];
            at = c.gap;
        }
        assert_close(normal, mass * (vz + 2.0), 1e-12);
        assert_close(vx, 5.0 - 0.25 * (vz + 2.0), 1e-12);
        assert_true(vz > 1.0 && vz < 2.0);
        assert_close(0.5 * mass * (29.0 - vx * vx - vz * vz), rubbed + damped, 1e-9);
        point_free(&p);
    }
}

// A scene of contacts: places on a cable or a net, free bodies, a body that turns on a knot, the cable with itself.
enum { BODIES = 3, CONTACTS = 8 };

typedef struct {
    built b;
    ancf_table* t;
    double *before, *shift;
    solid solid[BODIES];
    double force[CONTACTS];
    int n;
} scene;

static void scene_prepare(scene* s, double dt) {
    memcpy(s->b.v, s->before, 3 * (size_t)s->b.stride * sizeof *s->before);
    memset(s->shift, 0, 3 * (size_t)s->b.stride * sizeof *s->shift);
    for (int i = 0; i < BODIES; ++i) *ancf_table_body(s->t, i) = s->solid[i].body;
    assert_int_equal(ancf_table_prepare(s->t, s->b.m, s->b.v), ANCF_OK);
    for (int k = 0; k < s->n; ++k) ancf_table_contact(s->t, k)->impulse = s->force[k] * dt;
}

static scene scene_make(uint64_t* seed, const ancf_friction* law, int which, int n, double slip, double guess) {
    const ancf_element all = {.kind = which % 3 ? 0 : ANCF_LUMPED, .length = 1.0, .ea = 1.0, .rho_a = 0.3};
    scene s = {.b = which % 2 ? build_cable(3, all, which % 4 < 2) : build_net(2, all), .n = n};
    built* b = &s.b;
    build_shake(b, b->x, 0.2, seed);
    build_shake(b, b->v, slip, seed);
    b->mass[1] = 0.5;
    build_finish(b);
    assert_int_equal(ancf_table_create(&s.t, b->m), ANCF_OK);
    s.before = velocity_before(b);
    s.shift = s.before + 3 * b->stride;
    ancf_table_clear(s.t);
    const int knot = ancf_table_add_knot(s.t, b->m, 1);
    for (int i = 0; i < BODIES; ++i) { // the last one is carried by the knot
        s.solid[i] = random_solid(seed, i < 2 ? 0.2 : 0.0, 5e-3);
        ancf_body* body = &s.solid[i].body;
        random_vector(body->position, seed, 0.3);
        random_vector(body->velocity, seed, i < 2 ? slip : 0.0);
        random_vector(body->spin, seed, slip);
        for (int c = 0; c < 3 && i == 2; ++c) body->position[c] = b->x[c * b->stride + 1];
        ancf_table_add_body(s.t, body);
    }
    for (int k = 0; k < n; ++k) {
        ancf_contact c = {.side = {{-1, -1, {0}}, {-1, -1, {0}}}, .rub = *law};
        double at[3];
        const int e = (int)(random_unit(seed) * b->def.n_elements);
        const double xi = random_unit(seed);
        own_at(at, b, b->x, e, xi);
        c.side[0].place = ancf_table_add_place(s.t, b->m, e, xi);
        if (k % 4 == 3)
            c.side[1].place = ancf_table_add_place(s.t, b->m, (e + 2) % b->def.n_elements, random_unit(seed));
        else if (k % 4 > 0) c.side[1].body = (k + k / 4) % BODIES;
        if (c.side[1].body == 2) c.side[1].place = knot;
        for (int i = 0; i < 3 && c.side[1].body >= 0; ++i)
            c.side[1].arm[i] = at[i] - s.solid[c.side[1].body].body.position[i];
        random_direction(c.normal, seed);
        random_vector(c.friction, seed, guess);
        s.force[k] = random_between(seed, 0.1, 3.0);
        ancf_table_add_contact(s.t, &c);
    }
    return s;
}

static void scene_free(scene* s) {
    ancf_table_destroy(s->t);
    free(s->before);
    build_free(&s->b);
}

static void along_the_surface(double u[3], const ancf_contact* c) {
    const double along = dot(u, c->normal);
    for (int i = 0; i < 3; ++i) u[i] -= along * c->normal[i];
}

static void friction_impulses(double J[CONTACTS][3], const scene* s, double dt) {
    for (int k = 0; k < s->n; ++k)
        for (int i = 0; i < 3; ++i) J[k][i] = dt * ancf_table_contact(s->t, k)->friction[i];
}

// State after the impulses have acted on what was there before: through the mass matrix, not taken from the table.
static void apply(double* v, ancf_body body[BODIES], const scene* s, double J[CONTACTS][3]) {
    memcpy(v, s->before, 3 * (size_t)s->b.stride * sizeof *v);
    for (int i = 0; i < BODIES; ++i) body[i] = s->solid[i].body;
    own_give(&s->b, s->t, v, body, s->n, J);
}

// The equations themselves: friction is -mu(|u|) f_n u/|u| of the velocity u that it leaves.
static double residual(const scene* s, double dt) {
    double *v = malloc(3 * (size_t)s->b.stride * sizeof *v), J[CONTACTS][3], worst = 0.0;
    ancf_body body[BODIES];
    friction_impulses(J, s, dt);
    apply(v, body, s, J);
    for (int k = 0; k < s->n; ++k) {
        const ancf_contact* c = ancf_table_contact(s->t, k);
        double u[3];
        own_slip(u, &s->b, s->t, c, v, body);
        along_the_surface(u, c);
        const double speed = norm(u), force = mu(&c->rub, speed) * s->force[k];
        for (int i = 0; i < 3; ++i)
            worst = fmax(worst, fabs(J[k][i] / dt + (speed > 0.0 ? force * u[i] / speed : 0.0)));
    }
    free(v);
    return worst;
}

// One call, without a guess. Returns what the forces are off by.
static double scene_solve(scene* s, double dt) {
    double left;
    scene_prepare(s, dt);
    ancf_table_rub(s->t, dt, &left);
    ancf_table_apply(s->t, s->b.m, dt, s->b.v, s->shift);
    return left;
}

static void many_contacts_solve_their_equations(void** state) {
    (void)state;
    uint64_t seed = 4;
    int exact = 0;
    double worst = 0.0;
    for (int run = 0; run < 600; ++run) {
        const double dt = random_magnitude(&seed, 1e-6, 1e-3), slip = random_magnitude(&seed, 1e-4, 1.0);
        scene s =
            scene_make(&seed, run % 2 ? &hollars : &constant, run / 2, 1 + run % CONTACTS, slip, run % 3 ? 0.5 : 0.0);
        double J[CONTACTS][3];
        ancf_body body[BODIES];
        const double left = scene_solve(&s, dt);
        exact += left <= 1e-8;
        assert_true(left <= 1e-5);
        worst = fmax(worst, residual(&s, dt));
        friction_impulses(J, &s, dt);
        for (int k = 0; k < s.n; ++k) {
            const ancf_contact* c = ancf_table_contact(s.t, k);
            assert_near(dot(c->friction, c->normal), 0.0, 1e-14);
            assert_true(norm(c->friction) <= 0.3 * s.force[k] * (1.0 + 1e-14 + 10.0 * left));
        }
        // What the table says it did to the velocities is what these forces do, and nothing else.
        double* v = malloc(3 * (size_t)s.b.stride * sizeof *v);
        apply(v, body, &s, J);
        for (int i = 0; i < 3 * s.b.stride; ++i) assert_near(s.b.v[i], v[i], 1e-12);
        for (int j = 0; j < BODIES; ++j)
            for (int i = 0; i < 3; ++i) {
                assert_near(ancf_table_body(s.t, j)->velocity[i], body[j].velocity[i], 1e-12);
                assert_near(ancf_table_body(s.t, j)->spin[i], body[j].spin[i], 1e-11);
            }
        free(v);
        scene_free(&s);
    }
    print_message("exact %d of 600, residual %.2g N\n", exact, worst);
    assert_true(exact >= 600 * 99 / 100);
    assert_true(worst < 1e-6); // of 3 N
}

// A contact's own answer and the velocities at its sides are those of the mass matrix and the bodies.
static void table_answers_as_the_mass_matrix(void** state) {
    (void)state;
    uint64_t seed = 12;
    for (int run = 0; run < 60; ++run) {
        scene s = scene_make(&seed, &hollars, run, CONTACTS, 1.0, 0.0);
        scene_prepare(&s, 1e-4);
        for (int k = 0; k < s.n; ++k) {
            const ancf_contact* c = ancf_table_contact(s.t, k);
            double *v = calloc(3 * (size_t)s.b.stride, sizeof *v), J[CONTACTS][3] = {{0}}, u[3], w[3];
            ancf_body body[BODIES];
            for (int i = 0; i < BODIES; ++i) {
                body[i] = s.solid[i].body;
                memset(body[i].velocity, 0, sizeof body[i].velocity);
                memset(body[i].spin, 0, sizeof body[i].spin);
            }
            memcpy(J[k], c->normal, sizeof J[k]);
            own_give(&s.b, s.t, v, body, s.n, J);
            own_slip(u, &s.b, s.t, c, v, body);
            assert_close(c->own, dot(u, c->normal), 1e-11);
            for (int i = 0; i < BODIES; ++i) body[i] = s.solid[i].body;
            own_slip(u, &s.b, s.t, c, s.before, body);
            ancf_table_slip(w, s.t, c);
            for (int i = 0; i < 3; ++i) assert_near(w[i], u[i], 1e-13);
            free(v);
        }
        // A knot is a place at an end of an element that meets there.
        for (int i = 0; i < s.b.def.n_nodes; ++i) {
            const int k = ancf_table_add_knot(s.t, s.b.m, i);
            const ancf_place* p = ancf_table_place(s.t, k);
            double at[3];
            own_at(at, &s.b, s.b.x, p->element, p->xi);
            for (int c = 0; c < 3; ++c) assert_true(at[c] == s.b.x[c * s.b.stride + i]);
        }
        scene_free(&s);
    }
}

static void no_normal_force_no_friction(void** state) {
    (void)state;
    uint64_t seed = 3;
    scene s = scene_make(&seed, &hollars, 1, 2, 1.0, 3.0);
    double left = 1.0;
    ancf_table_contact(s.t, 1)->rub.kind = ANCF_FRICTION_NONE;
    s.force[0] = 0.0;
    scene_prepare(&s, 1e-3);
    assert_int_equal(ancf_table_rub(s.t, 1e-3, &left), 0);
    assert_true(left == 0.0);
    ancf_table_apply(s.t, s.b.m, 1e-3, s.b.v, s.shift);
    for (int k = 0; k < 2; ++k)
        for (int i = 0; i < 3; ++i) assert_true(ancf_table_contact(s.t, k)->friction[i] == 0.0);
    assert_memory_equal(s.before, s.b.v, 3 * (size_t)s.b.stride * sizeof *s.before);
    ancf_table_clear(s.t);
    assert_int_equal(ancf_table_prepare(s.t, s.b.m, s.b.v), ANCF_OK);
    assert_int_equal(ancf_table_contacts(s.t), 0);
    assert_int_equal(ancf_table_rub(s.t, 1e-3, &left), 0);
    scene_free(&s);
}

// Two places in two directions, coupled by an inverse mass matrix, by Newton's method on the four velocities with
// growing time: constant mu, so that there is one solution.
static void newton_two(double u[4], double loose[4], double b11, double b12, double b22, double f1, double f2,
                       double dt) {
    const double B[2][2] = {{b11, b12}, {b12, b22}}, fn[2] = {f1, f2}, mu0 = 0.3, v0 = 1e-3;
    memcpy(u, loose, 4 * sizeof *u);
    for (int level = 1; level <= 2000; ++level) { // continuation in dt keeps Newton near the solution
        const double h = dt * level / 2000.0;
        for (int it = 0; it < 50; ++it) {
            double r[4], J[16] = {0.0}, d[4], D[2][2][2], force[2][2], size = 0.0;
            for (int k = 0; k < 2; ++k) {
                const double s = hypot(u[2 * k], u[2 * k + 1]);
                for (int i = 0; i < 2; ++i) {
                    const double w = s < v0 ? mu0 * fn[k] / v0 : mu0 * fn[k] / s;
                    force[k][i] = -w * u[2 * k + i];
                    for (int j = 0; j < 2; ++j)
                        D[k][i][j] = -w * (i == j) + (s < v0 ? 0.0 : w * u[2 * k + i] * u[2 * k + j] / (s * s));
                }
            }
            for (int k = 0; k < 2; ++k)
                for (int i = 0; i < 2; ++i) {
                    r[2 * k + i] = -(u[2 * k + i] - loose[2 * k + i]);
                    J[(2 * k + i) * 4 + 2 * k + i] = 1.0;
                    for (int l = 0; l < 2; ++l) {
                        r[2 * k + i] += h * B[k][l] * force[l][i];
                        for (int j = 0; j < 2; ++j) J[(2 * k + i) * 4 + 2 * l + j] -= h * B[k][l] * D[l][i][j];
                    }
                }
            dense_solve(d, J, r, 4);
            for (int i = 0; i < 4; ++i) {
                u[i] += d[i];
                size = fmax(size, fabs(d[i]));
            }
            if (size < 1e-16) break;
        }
    }
}

static void two_places_against_newton(void** state) {
    (void)state;
    uint64_t seed = 5;
    int stuck = 0, sliding = 0;
    for (int run = 0; run < 60; ++run) {
        const ancf_element all = {.length = 1.0, .ea = 1.0, .rho_a = random_between(&seed, 0.1, 0.3)};
        built b = build_cable(2, all, 1);
        build_shake(&b, b.v, run % 2 ? 0.02 : 2e-3, &seed);
        build_finish(&b);
        const double xi[2] = {random_unit(&seed), random_unit(&seed)}, dt = random_magnitude(&seed, 1e-5, 1e-3);
        double B[2][2], loose[4], u[4], force[2], left, *before = malloc(3 * (size_t)b.stride * sizeof *before);
        double* shift = calloc(3 * (size_t)b.stride, sizeof *shift);
        memcpy(before, b.v, 3 * (size_t)b.stride * sizeof *before);
        for (int k = 0; k < 2; ++k) {
            double *kick = calloc(3 * (size_t)b.stride, sizeof *kick), v[3];
            const double one[3] = {1.0, 0.0, 0.0};
            own_kick(&b, kick, k, xi[k], one);
            for (int l = 0; l < 2; ++l) {
                own_at(v, &b, kick, l, xi[l]);
                B[l][k] = v[0];
            }
            own_at(v, &b, b.v, k, xi[k]);
            loose[2 * k] = v[0];
            loose[2 * k + 1] = v[1];
            force[k] = random_between(&seed, 0.1, 2.0);
            free(kick);
        }
        newton_two(u, loose, B[0][0], B[0][1], B[1][1], force[0], force[1], dt);
        ancf_table* t;
        assert_int_equal(ancf_table_create(&t, b.m), ANCF_OK);
        for (int k = 0; k < 2; ++k) {
            const ancf_contact c = {.side = {{ancf_table_add_place(t, b.m, k, xi[k]), -1, {0}}, {-1, -1, {0}}},
                                    .normal = {0.0, 0.0, 1.0},
                                    .rub = constant};
            ancf_table_add_contact(t, &c);
        }
        assert_int_equal(ancf_table_prepare(t, b.m, before), ANCF_OK);
        for (int k = 0; k < 2; ++k) ancf_table_contact(t, k)->impulse = force[k] * dt;
        ancf_table_rub(t, dt, &left);
        assert_true(left <= 1e-8);
        ancf_table_apply(t, b.m, dt, b.v, shift);
        for (int k = 0; k < 2; ++k) {
            double v[3];
            if (hypot(u[2 * k], u[2 * k + 1]) < 1e-3) stuck++;
            else sliding++;
            own_at(v, &b, b.v, k, xi[k]);
            for (int i = 0; i < 2; ++i) assert_near(v[i], u[2 * k + i], 1e-9);
        }
        ancf_table_destroy(t);
        free(before);
        free(shift);
        build_free(&b);
    }
    assert_true(stuck > 10 && sliding > 10);
}

// What one gains the others lose, moments about the origin too: friction between two places that meet at a point.
static void momentum_is_exchanged(void** state) {
    (void)state;
    uint64_t seed = 6;
    for (int run = 0; run < 100; ++run) {
        scene s = scene_make(&seed, &hollars, run, CONTACTS, 0.1, 1.0);
        double P0[3], H0[3], P[3], H[3], terms[2], left, couple[3] = {0.0, 0.0, 0.0};
        s.force[0] = s.force[4] = 0.0; // on the ground
        scene_prepare(&s, 1e-3);
        own_momentum(P0, H0, terms, &s.b);
        for (int i = 0; i < BODIES; ++i) add_momentum(P0, H0, terms, &s.solid[i], &s.solid[i].body);
        ancf_table_rub(s.t, 1e-3, &left);
        ancf_table_apply(s.t, s.b.m, 1e-3, s.b.v, s.shift);
        own_momentum(P, H, terms, &s.b);
        for (int i = 0; i < BODIES; ++i) add_momentum(P, H, terms, &s.solid[i], ancf_table_body(s.t, i));
        for (int k = 3; k < s.n; k += 4) { // two centrelines apart leave a couple
            const ancf_contact* c = ancf_table_contact(s.t, k);
            const ancf_place *p = ancf_table_place(s.t, c->side[0].place), *q = ancf_table_place(s.t, c->side[1].place);
            double a[3], b[3], turn[3];
            own_at(a, &s.b, s.b.x, p->element, p->xi);
            own_at(b, &s.b, s.b.x, q->element, q->xi);
            for (int i = 0; i < 3; ++i) a[i] -= b[i];
            cross(turn, a, c->friction);
            for (int i = 0; i < 3; ++i) couple[i] += 1e-3 * turn[i];
        }
        for (int i = 0; i < 3; ++i) {
            assert_near(P[i], P0[i], 1e-13 * terms[0]);
            assert_near(H[i], H0[i] + couple[i], 1e-13 * terms[1]);
        }
        scene_free(&s);
    }
}

// Friction takes energy out, never puts it in, and says how much.
static void friction_dissipates(void** state) {
    (void)state;
    uint64_t seed = 7;
    for (int run = 0; run < 200; ++run) {
        scene s = scene_make(&seed, &hollars, run, CONTACTS, 0.3, 0.3);
        double before = kinetic_of_field(&s.b, s.before), after, rubbed = 0.0;
        scene_solve(&s, 1e-4);
        after = kinetic_of_field(&s.b, s.b.v);
        for (int i = 0; i < BODIES; ++i) {
            before += kinetic_of_solid(&s.solid[i], &s.solid[i].body);
            after += kinetic_of_solid(&s.solid[i], ancf_table_body(s.t, i));
        }
        for (int k = 0; k < s.n; ++k) {
            const ancf_contact* c = ancf_table_contact(s.t, k);
            double u[3];
            ancf_table_slip(u, s.t, c);
            assert_true(dot(u, c->friction) <= 1e-10);
            rubbed += c->rubbed;
        }
        assert_true(after < before);
        assert_near(before - after, rubbed, 1e-12 * before);
        scene_free(&s);
    }
}

// The same table gives the same bits, whatever it held before.
static void same_table_same_bits(void** state) {
    (void)state;
    for (int run = 0; run < 20; ++run) {
        double* velocity[2];
        ancf_contact contact[2][CONTACTS];
        int size = 0;
        double left[2];
        for (int again = 0; again < 2; ++again) {
            uint64_t seed = 8 + (uint64_t)run;
            scene s = scene_make(&seed, &hollars, run, CONTACTS, 0.3, 0.1);
            size = 3 * s.b.stride;
            if (again) { // something else first, then the same once more
                const int n = ancf_table_contacts(s.t);
                ancf_contact keep[CONTACTS];
                int element[2 * CONTACTS + 1], places = 0;
                double xi[2 * CONTACTS + 1];
                for (int k = 0; k < n; ++k) {
                    keep[k] = *ancf_table_contact(s.t, k);
                    for (int q = 0; q < 2; ++q)
                        if (keep[k].side[q].place >= places) places = keep[k].side[q].place + 1;
                }
                for (int i = 0; i < places; ++i) {
                    element[i] = ancf_table_place(s.t, i)->element;
                    xi[i] = ancf_table_place(s.t, i)->xi;
                }
                scene_solve(&s, 1e-4);
                ancf_table_clear(s.t);
                for (int i = 0; i < 50; ++i)
                    ancf_table_add_place(s.t, s.b.m, i % s.b.def.n_elements, random_unit(&seed));
                assert_int_equal(ancf_table_prepare(s.t, s.b.m, s.before), ANCF_OK);
                ancf_table_clear(s.t);
                for (int i = 0; i < places; ++i) ancf_table_add_place(s.t, s.b.m, element[i], xi[i]);
                for (int i = 0; i < BODIES; ++i) ancf_table_add_body(s.t, &s.solid[i].body);
                for (int k = 0; k < n; ++k) ancf_table_add_contact(s.t, &keep[k]);
            }
            left[again] = scene_solve(&s, 1e-4);
            velocity[again] = malloc((size_t)size * sizeof(double));
            memcpy(velocity[again], s.b.v, (size_t)size * sizeof(double));
            for (int k = 0; k < CONTACTS; ++k) contact[again][k] = *ancf_table_contact(s.t, k);
            scene_free(&s);
        }
        assert_memory_equal(&left[0], &left[1], sizeof(double));
        assert_memory_equal(velocity[0], velocity[1], (size_t)size * sizeof(double));
        for (int k = 0; k < CONTACTS; ++k)
            assert_memory_equal(contact[0][k].friction, contact[1][k].friction, 3 * sizeof(double));
        free(velocity[0]);
        free(velocity[1]);
    }
}

// The result as first guess of the same problem changes nothing and takes one sweep or two.
static void solution_is_a_good_guess(void** state) {
    (void)state;
    uint64_t seed = 10;
    double left;
    scene s = scene_make(&seed, &constant, 1, CONTACTS, 0.3, 0.0);
    scene_solve(&s, 1e-4);
    scene_prepare(&s, 1e-4);
    assert_true(ancf_table_rub(s.t, 1e-4, &left) <= 2);
    scene_free(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(table_answers_as_the_mass_matrix),
        cmocka_unit_test(held_point_creeps_at_closed_form),
        cmocka_unit_test(block_slides_to_rest),
        cmocka_unit_test(block_slides_down_a_slope),
        cmocka_unit_test(sphere_spins_down),
        cmocka_unit_test(spinning_body_drags_the_point),
        cmocka_unit_test(impact_rubs_by_its_impulse),
        cmocka_unit_test(no_normal_force_no_friction),
        cmocka_unit_test(many_contacts_solve_their_equations),
        cmocka_unit_test(two_places_against_newton),
        cmocka_unit_test(momentum_is_exchanged),
        cmocka_unit_test(friction_dissipates),
        cmocka_unit_test(same_table_same_bits),
        cmocka_unit_test(solution_is_a_good_guess),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
