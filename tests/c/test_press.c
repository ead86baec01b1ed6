// Normal forces of the table of contacts against closed forms, conserved quantities and a reference with tiny steps.
#include "touch.h"

static const double alphas[3] = {0.08, 0.2, 0.32};

// Restitution by Hunt and Crossley: g(v) = g(-e v), g(u) = a u - ln(1 + a u), a = 1.5 alpha.
static double hunt_crossley(double alpha, double v) {
    const double a = 1.5 * alpha, wanted = a * v - log1p(a * v);
    double low = 0.0, high = 1.0;
    for (int i = 0; i < 200; ++i) {
        const double e = 0.5 * (low + high);
        if (-a * e * v - log1p(-a * e * v) < wanted && a * e * v < 1.0) low = e;
        else high = e;
    }
    return low;
}

// Of the spring-dashpot that never pulls: the oscillator until k x + c x' = 0.
static double dashpot(double zeta) {
    const double w = sqrt(1.0 - zeta * zeta),
                 t = 3.14159265358979323846 - atan2(2.0 * zeta * w, 1.0 - 2.0 * zeta * zeta);
    return -exp(-zeta * t / w) * (cos(t) - zeta / w * sin(t));
}

// How long an impact lasts by Hertz's law or a spring's, without damping [s].
static double duration(const ancf_normal* law, double own, double speed) {
    if (law->kind == ANCF_NORMAL_LINEAR) return 3.14159265358979323846 / sqrt(law->stiffness * own);
    return 2.9433 * pow(1.25 * speed * speed / (own * law->stiffness), 0.4) / speed;
}

typedef enum { PLACE_BODY, BODY_BODY, KNOT_WALL, PLACES } pair;

// A cable of three elements that two bodies, or one, meet; without elasticity.
typedef struct {
    built b;
    ancf_table* t;
    double* shift;
    pair kind;
    double inv_mass;
} impact;

static impact impact_make(pair kind, double ratio) {
    const ancf_element all = {.length = 0.6, .ea = 1.0, .rho_a = 0.02};
    impact i = {.b = build_cable(3, all, 1), .kind = kind};
    if (kind == KNOT_WALL) i.b.mass[1] = ratio * 0.002;
    build_finish(&i.b);
    assert_int_equal(ancf_table_create(&i.t, i.b.m), ANCF_OK);
    i.shift = calloc(3 * (size_t)i.b.stride, sizeof *i.shift);
    ancf_table_clear(i.t);
    ancf_table_add_place(i.t, i.b.m, 1, 0.37);
    ancf_table_prepare(i.t, i.b.m, i.b.v);
    i.inv_mass = ancf_table_place(i.t, 0)->compliance / ratio;
    return i;
}

static void impact_free(impact* i) {
    ancf_table_destroy(i->t);
    free(i->shift);
    build_free(&i->b);
}

typedef struct {
    double restitution, depth, impulse, damped;
    int steps, substeps;
} outcome;

// First side: the place or a body; second: a body that comes along -z at `speed`. Touches at `phase` of a step.
static outcome impact_run(impact* s, const ancf_normal* law, double speed, double step, double phase, double own) {
    const double z[3] = {0.0, 0.0, 1.0};
    memset(s->b.v, 0, 3 * (size_t)s->b.stride * sizeof(double));
    for (int i = 0; i < s->b.stride; ++i) s->b.x[2 * s->b.stride + i] = 0.0;
    if (s->kind == KNOT_WALL)
        for (int i = 0; i < s->b.def.n_nodes; ++i) s->b.v[2 * s->b.stride + i] = -speed;
    ancf_body far = {.position = {0.25, 0.0, -speed * step * phase}, .velocity = {0.0, 0.0, speed}};
    ancf_body near = {.position = {0.25, 0.0, 0.0}};
    far.inv_mass[2] = s->inv_mass;
    near.inv_mass[2] = own - s->inv_mass;
    if (s->kind == KNOT_WALL) far.velocity[2] = far.inv_mass[2] = 0.0;
    outcome o = {0};
    for (o.steps = 1; o.steps < 2000; ++o.steps) {
        ancf_contact c = {.side = {{0, -1, {0}}, {-1, 0, {0}}}, .normal = {0.0, 0.0, 1.0}, .law = *law};
        double at[3], u[3];
        int stiffest;
        ancf_table_clear(s->t);
        if (s->kind == PLACE_BODY) ancf_table_add_place(s->t, s->b.m, 1, 0.37);
        if (s->kind == KNOT_WALL) ancf_table_add_knot(s->t, s->b.m, 1);
        ancf_table_add_body(s->t, &far);
        if (s->kind == BODY_BODY) c.side[0] = (ancf_side) {-1, ancf_table_add_body(s->t, &near), {0}};
        if (s->kind == BODY_BODY) memcpy(at, near.position, sizeof at);
        else own_at(at, &s->b, s->b.x, 1, s->kind == KNOT_WALL ? 0.0 : 0.37);
        c.gap = at[2] - far.position[2];
        ancf_table_add_contact(s->t, &c);
        assert_int_equal(ancf_table_prepare(s->t, s->b.m, s->b.v), ANCF_OK);
        assert_close(ancf_table_contact(s->t, 0)->own, own, 1e-12);
        const int n = ancf_table_substeps(s->t, step, &stiffest);
        ancf_table_press(s->t, step, n);
        o.substeps += n;
        memset(s->shift, 0, 3 * (size_t)s->b.stride * sizeof(double));
        ancf_table_apply(s->t, s->b.m, step, s->b.v, s->shift);
        own_drift(&s->b, step, s->shift);
        const ancf_contact* after = ancf_table_contact(s->t, 0);
        ancf_table_slip(u, s->t, after);
        for (int k = 0; k < 3; ++k) {
            const ancf_body *f = ancf_table_body(s->t, 0), *g = ancf_table_body(s->t, 1);
            far.position[k] += step * far.velocity[k] + f->shift[k];
            far.velocity[k] = f->velocity[k];
            if (s->kind != BODY_BODY) continue;
            near.position[k] += step * near.velocity[k] + g->shift[k];
            near.velocity[k] = g->velocity[k];
        }
        o.impulse += after->impulse;
        o.damped += after->damped;
        o.depth = fmax(o.depth, after->depth);
        o.restitution = dot(u, z) / speed;
        // The gap that is left is the distance that is left.
        if (s->kind != BODY_BODY) own_at(at, &s->b, s->b.x, 1, s->kind == KNOT_WALL ? 0.0 : 0.37);
        else memcpy(at, near.position, sizeof at);
        assert_near(at[2] - far.position[2], after->gap, 1e-13 + 1e-12 * speed * step);
        if (after->gap > 0.0 && u[2] > 0.0) return o;
    }
    fail_msg("still touching after %d steps", o.steps);
    return o;
}

static void single_impacts_bounce_by_theory(void** state) {
    (void)state;
    const double ratios[] = {0.01, 0.1, 1.0, 10.0, 100.0}, speeds[] = {0.1, 0.5, 2.0, 10.0};
    const double steps[] = {0.05, 0.2, 0.5, 1.0, 3.0}, zetas[] = {0.0, 0.05, 0.2};
    double worst[7] = {0.0}, mean[7] = {0.0}, high = 0.0, low = 2.0;
    uint64_t seed = 61;
    for (int law = 0; law < 7; ++law)
        for (int run = 0; run < 5 * 5 * 4; ++run) {
            const double ratio = ratios[run % 5], part = steps[run / 5 % 5], speed = speeds[run / 25];
            impact s = impact_make(run % 3, ratio);
            const double k = random_magnitude(&seed, 1e4, 1e8);
            ancf_normal n = {ANCF_NORMAL_LINEAR, k, 1.5, 0.0};
            if (law < 4) n.kind = law ? ANCF_NORMAL_NONLINEAR : ANCF_NORMAL_HERTZ;
            if (law > 0 && law < 4) n.damping = alphas[law - 1];
            double own = 0.0;
            if (s.kind == KNOT_WALL) {
                ancf_table_clear(s.t);
                ancf_table_add_knot(s.t, s.b.m, 1);
                ancf_table_prepare(s.t, s.b.m, s.b.v);
                own = ancf_table_place(s.t, 0)->compliance;
            } else own = s.inv_mass * (1.0 + ratio);
            if (law >= 4) n.damping = 2.0 * zetas[law - 4] * sqrt(k / own);
            const double expected = law == 0  ? 1.0
                                    : law < 4 ? hunt_crossley(n.damping, speed)
                                              : dashpot(zetas[law - 4]);
            const double T = duration(&n, own, speed);
            for (int phase = 0; phase < 200; ++phase) {
                const outcome o = impact_run(&s, &n, speed, part * T, (phase + 0.5) / 200.0, own);
                const double off = fabs(o.restitution / expected - 1.0);
                mean[law] += off / (200.0 * 100.0);
                worst[law] = fmax(worst[law], off);
                if (n.damping == 0.0) {
                    high = fmax(high, o.restitution);
                    low = fmin(low, o.restitution);
                }
            }
            impact_free(&s);
        }
    print_message("restitution off by at most (mean)");
    for (int law = 0; law < 7; ++law) print_message(" %.2g (%.2g)", worst[law], mean[law]);
    print_message(", undamped %.3g above and %.3g below 1\n", high - 1.0, 1.0 - low);
    for (int law = 0; law < 7; ++law) assert_true(worst[law] < (law == 6 ? 0.015 : 0.01));
    assert_true(high <= 1.0 + 1e-9 && low >= 0.999);
}

// A cable or net with places, bodies that fly, bodies that knots carry, and contacts of all sorts among them.
enum { BODIES = 5, CONTACTS = 14 };

typedef struct {
    built b;
    ancf_table* t;
    int n_bodies, n_contacts;
    solid solid[BODIES];
    double start[BODIES][3]; // positions
    double *v, *shift;       // field before, and what moves besides
} scene;

static ancf_normal random_law(uint64_t* seed, bool damped) {
    ancf_normal law = {ANCF_NORMAL_HERTZ, random_magnitude(seed, 1e4, 1e7), 1.5, 0.0};
    const double kind = random_unit(seed);
    if (kind < 0.3) law = (ancf_normal) {ANCF_NORMAL_LINEAR, random_magnitude(seed, 1e2, 1e4), 1.0, damped ? 0.1 : 0.0};
    else if (kind < 0.7 && damped) {
        law.kind = ANCF_NORMAL_NONLINEAR;
        law.damping = random_between(seed, 0.05, 0.4);
    }
    return law;
}

static scene scene_make(uint64_t* seed, int which, bool damped) {
    const ancf_element all = {
        .kind = which % 2 ? ANCF_LUMPED : 0, .length = which % 4 < 2 ? 1.0 : 0.3, .ea = 1.0, .rho_a = 0.05};
    scene s = {.b = which % 4 < 2 ? build_cable(6, all, which % 8 < 4) : build_net(2, all), .n_bodies = BODIES};
    built* b = &s.b;
    build_shake(b, b->x, 0.2, seed);
    build_shake(b, b->v, 1.0, seed);
    const int carried = 3; // the knot with bodies 3 and 4, which turn about it
    b->mass[carried] = 0.02;
    b->mass[carried + 1] = 0.1;
    build_finish(b);
    assert_int_equal(ancf_table_create(&s.t, b->m), ANCF_OK);
    s.v = calloc(3 * (size_t)b->stride, sizeof *s.v);
    s.shift = calloc(3 * (size_t)b->stride, sizeof *s.shift);
    ancf_table_clear(s.t);
    int knot[BODIES];
    for (int i = 0; i < BODIES; ++i) {
        s.solid[i] =
            random_solid(seed, i < 3 ? random_magnitude(seed, 1e-3, 1.0) : 0.0, random_magnitude(seed, 1e-5, 1e-3));
        ancf_body* body = &s.solid[i].body;
        random_vector(body->position, seed, 0.3);
        random_vector(body->velocity, seed, i < 3 ? 1.0 : 0.0);
        random_vector(body->spin, seed, 3.0);
        knot[i] = i < 3 ? -1 : ancf_table_add_knot(s.t, b->m, carried + i - 3);
        for (int c = 0; c < 3 && i >= 3; ++c) body->position[c] = b->x[c * b->stride + carried + i - 3];
        memcpy(s.start[i], body->position, sizeof s.start[i]);
        ancf_table_add_body(s.t, body);
    }
    for (int k = 0; k < CONTACTS; ++k) {
        ancf_contact c = {.side = {{-1, -1, {0}}, {-1, -1, {0}}}, .law = random_law(seed, damped)};
        double at[3], other[3];
        const int e = (int)(random_unit(seed) * b->def.n_elements), body = k % BODIES;
        const double xi = random_unit(seed);
        own_at(at, b, b->x, e, xi);
        random_direction(c.normal, seed);
        if (k % 7 == 6) { // two bodies
            random_vector(at, seed, 0.3);
            c.side[0].body = (body + 1) % BODIES;
            c.side[0].place = knot[c.side[0].body];
        } else c.side[0].place = ancf_table_add_place(s.t, b->m, e, xi);
        if (k % 7 == 5) { // two cables: apart along the normal
            const int f = (e + 2) % b->def.n_elements;
            own_at(other, b, b->x, f, 1.0 - xi);
            c.side[1].place = ancf_table_add_place(s.t, b->m, f, 1.0 - xi);
            for (int i = 0; i < 3; ++i) c.normal[i] = at[i] - other[i];
            const double length = norm(c.normal);
            for (int i = 0; i < 3; ++i) c.normal[i] /= length;
        } else {
            c.side[1].body = body;
            c.side[1].place = knot[body];
        }
        for (int q = 0; q < 2; ++q)
            for (int i = 0; i < 3 && c.side[q].body >= 0; ++i) c.side[q].arm[i] = at[i] - s.start[c.side[q].body][i];
        c.gap = random_between(seed, -2e-5, 1e-5);
        ancf_table_add_contact(s.t, &c);
    }
    s.n_contacts = CONTACTS;
    memcpy(s.v, b->v, 3 * (size_t)b->stride * sizeof *s.v);
    assert_int_equal(ancf_table_prepare(s.t, b->m, b->v), ANCF_OK);
    return s;
}

static void scene_free(scene* s) {
    ancf_table_destroy(s->t);
    free(s->v);
    free(s->shift);
    build_free(&s->b);
}

static double scene_kinetic(const scene* s) {
    double sum = kinetic_of_field(&s->b, s->b.v);
    for (int i = 0; i < s->n_bodies; ++i) sum += kinetic_of_solid(&s->solid[i], ancf_table_body(s->t, i));
    return sum;
}

// Momenta of all, about the origin; carried bodies are where their knots are.
static void scene_momentum(double P[3], double H[3], double terms[2], const scene* s) {
    own_momentum(P, H, terms, &s->b);
    for (int i = 0; i < s->n_bodies; ++i) add_momentum(P, H, terms, &s->solid[i], ancf_table_body(s->t, i));
}

// A step changes no momentum, friction and what it moves included; the centre of mass goes on evenly whatever the
// sub-steps move. Contacts of two centrelines leave a couple and are out of touch where moments are looked at.
static void momentum_is_exact(void** state) {
    (void)state;
    uint64_t seed = 62;
    int pressed = 0;
    for (int run = 0; run < 400; ++run) {
        scene s = scene_make(&seed, run / 2, true);
        const double step = random_magnitude(&seed, 1e-5, 1e-3);
        const bool moments = run % 2;
        double P0[3], H0[3], P[3], H[3], terms[2], unused[3], size[2], moved[3], left;
        int stiffest;
        for (int k = 0; k < s.n_contacts; ++k) {
            ancf_contact* c = ancf_table_contact(s.t, k);
            if (moments && c->side[1].body < 0) c->gap = 1.0;
            if (run % 4 >= 2) c->rub = (ancf_friction) {ANCF_FRICTION_HOLLARS, 0.3, 0.2, 1e-3};
        }
        scene_momentum(P0, H0, terms, &s);
        const int n = ancf_table_substeps(s.t, step, &stiffest);
        assert_true(n > 0);
        ancf_table_press(s.t, step, n);
        ancf_table_rub(s.t, step, &left);
        ancf_table_apply(s.t, s.b.m, step, s.b.v, s.shift);
        for (int i = 0; i < 3 * s.b.stride; ++i) s.shift[i] += step * s.b.v[i]; // the whole way
        built way = s.b;
        way.v = s.shift;
        own_momentum(moved, unused, size, &way);
        for (int j = 0; j < s.n_bodies; ++j)
            for (int i = 0; i < 3; ++i) {
                ancf_body* body = ancf_table_body(s.t, j);
                const double its_way = step * s.solid[j].body.velocity[i] + body->shift[i];
                moved[i] += s.solid[j].mass * its_way;
                body->position[i] += its_way;
            }
        for (int i = 0; i < 3 * s.b.stride; ++i) s.b.x[i] += s.shift[i];
        scene_momentum(P, H, terms, &s);
        for (int i = 0; i < 3; ++i) {
            assert_near(P[i], P0[i], 1e-12 * terms[0]);
            assert_near(moved[i], step * P0[i], 1e-12 * step * terms[0]);
            if (moments) assert_near(H[i], H0[i], 1e-12 * terms[1]);
        }
        for (int k = 0; k < s.n_contacts; ++k) {
            pressed += ancf_table_contact(s.t, k)->impulse > 0.0;
            assert_true(ancf_table_contact(s.t, k)->impulse >= 0.0);
        }
        scene_free(&s);
    }
    assert_true(pressed > 2000);
}

// Kinetic, elastic and damped energy of random tables stays, whatever the sub-steps: they are discrete gradients. What
// contacts were found to store is that of their gaps, what bodies have got is the change of their kinetic energy.
static void energy_of_random_tables(void** state) {
    (void)state;
    static const double factors[] = {0.5, 1.0, 4.0};
    double worst = 0.0;
    for (int run = 0; run < 600; ++run) {
        uint64_t seed = 1000 + (uint64_t)run / 3;
        scene s = scene_make(&seed, run / 3, run / 3 % 2);
        const double step = random_magnitude(&seed, 1e-5, 1e-3);
        int stiffest;
        double before = scene_kinetic(&s), deepest = 0.0, after, damped = 0.0;
        double stored[CONTACTS];
        for (int k = 0; k < s.n_contacts; ++k) {
            const ancf_contact* c = ancf_table_contact(s.t, k);
            before += stored[k] = ancf_normal_energy(&c->law, -c->gap);
        }
        const int n = ancf_table_substeps(s.t, step, &stiffest);
        ancf_table_press(s.t, step, (int)ceil(factors[run % 3] * n));
        ancf_table_apply(s.t, s.b.m, step, s.b.v, s.shift);
        ancf_table_end(s.t, step);
        after = scene_kinetic(&s);
        for (int k = 0; k < s.n_contacts; ++k) assert_close(ancf_table_contact(s.t, k)->found, stored[k], 1e-15);
        for (int i = 0; i < s.n_bodies; ++i) {
            const ancf_body* body = ancf_table_body(s.t, i);
            const double had = kinetic_of_solid(&s.solid[i], &s.solid[i].body),
                         has = kinetic_of_solid(&s.solid[i], body);
            assert_near(body->work, has - had, 1e-12 * (has + had));
        }
        for (int k = 0; k < s.n_contacts; ++k) {
            const ancf_contact* c = ancf_table_contact(s.t, k);
            assert_close(c->energy, ancf_normal_energy(&c->law, -c->gap), 1e-15);
            assert_true(c->damped >= -1e-9 * before);
            deepest += ancf_normal_energy(&c->law, c->depth);
            after += c->energy;
            damped += c->damped;
        }
        assert_true(run / 3 % 2 ? damped > 0.0 : fabs(damped) < 1e-12 * before);
        worst = fmax(worst, fabs(after + damped - before) / deepest);
        scene_free(&s);
    }
    print_message("energy of random tables off by %.2g of what the contacts hold\n", worst);
    assert_true(worst < 1e-5);
}

// Bodies and contacts that go on for many steps: two balls on one element; a ball that bounces between two cables; a
// ball under its weight on 20 places of a cable on the ground; a row of balls; a ball
// squeezed between walls.
typedef enum { TWO_ON_ONE, BETWEEN, ON_TWENTY, ROW, SQUEEZED, RIGS } rig_kind;

typedef struct {
    built b;
    ancf_table* t;
    double *shift, step, gravity;
    int n_bodies, n_contacts, n_places;
    solid solid[24];
    struct {
        int element;
        double xi;
    } place[24];
    ancf_contact contact[48];
} rig;

static void rig_place(rig* r, ancf_contact* c, int side, int element, double xi) {
    r->place[r->n_places].element = element;
    r->place[r->n_places].xi = xi;
    c->side[side].place = r->n_places++;
}

static rig rig_make(rig_kind kind, int lumped, double alpha) {
    const ancf_element all = {.kind = lumped, .length = 1.0, .ea = 1.0, .rho_a = 0.05};
    ancf_normal law = {ANCF_NORMAL_NONLINEAR, 1e6, 1.5, alpha};
    rig r = {.step = 3e-4};
    uint64_t seed = 64;
    if (kind == BETWEEN) {
        r.b = build_start(4, 2, all);
        const int ends[4] = {0, 1, 2, 3};
        memcpy(r.b.ends, ends, sizeof ends);
        r.b.x[1] = r.b.x[3] = 1.0;
        for (int i = 0; i < 4; ++i) {
            r.b.x[2 * r.b.stride + i] = i < 2 ? 0.0 : 0.1;
            r.b.mass[i] = 1.0; // so that the ball comes back often
        }
        build_slopes(&r.b);
    } else r.b = build_cable(4, all, 1);
    build_finish(&r.b);
    assert_int_equal(ancf_table_create(&r.t, r.b.m), ANCF_OK);
    r.shift = calloc(3 * (size_t)r.b.stride, sizeof *r.shift);
    const ancf_contact plain = {.side = {{-1, -1, {0}}, {-1, -1, {0}}}, .normal = {0.0, 0.0, 1.0}, .law = law};
    for (int k = 0; k < 48; ++k) r.contact[k] = plain;
    if (kind == TWO_ON_ONE) {
        r.n_bodies = r.n_contacts = 2;
        for (int k = 0; k < 2; ++k) {
            r.solid[k] = random_solid(&seed, k ? 0.02 : 0.005, 0.0);
            r.solid[k].body.velocity[2] = k ? -1.0 : -2.0;
            r.contact[k].side[0].body = k;
            r.contact[k].gap = k ? 1e-5 : 4e-5;
            rig_place(&r, &r.contact[k], 1, 1, k ? 0.8 : 0.35);
        }
    } else if (kind == BETWEEN) {
        r.n_bodies = 1;
        r.n_contacts = 2;
        r.solid[0] = random_solid(&seed, 0.01, 0.0);
        r.solid[0].body.velocity[2] = 1.5;
        for (int k = 0; k < 2; ++k) {
            r.contact[k].side[k].body = 0;
            r.contact[k].gap = -2e-5;
            rig_place(&r, &r.contact[k], 1 - k, k, 0.0);
        }
    } else if (kind == ON_TWENTY) {
        r.n_bodies = 2;
        r.n_contacts = 40;
        r.gravity = 9.81;
        r.solid[0] = random_solid(&seed, 0.5, 1e-3);
        r.solid[0].body.velocity[2] = -0.2;
        for (int k = 0; k < 20; ++k) {
            ancf_contact *top = &r.contact[k], *ground = &r.contact[20 + k];
            top->side[0].body = 0;
            top->side[0].arm[0] = 0.05 * (k - 9.5) / 10.0;
            top->side[0].arm[2] = -0.05;
            top->gap = 1e-4 * random_unit(&seed);
            rig_place(&r, top, 1, 1 + k / 10, 0.05 + 0.1 * (k % 10));
            ground->side[0].place = top->side[1].place;
            ground->side[1].body = 1;
        }
    } else if (kind == SQUEEZED) {
        r.n_bodies = 2;
        r.n_contacts = 3;
        r.solid[0] = random_solid(&seed, 0.01, 0.0);
        r.solid[0].body.velocity[2] = 0.5;
        for (int k = 0; k < 3; ++k) {
            const double angle = 2.1 * k;
            r.contact[k].side[0].body = 0;
            r.contact[k].side[1].body = 1; // stands still
            r.contact[k].normal[0] = sin(angle);
            r.contact[k].normal[2] = cos(angle);
            r.contact[k].gap = -1e-4 * (1.0 + k);
        }
    } else { // row of balls, the first one thrown, on a place at the end
        r.n_bodies = r.n_contacts = 8;
        for (int k = 0; k < 8; ++k) {
            r.solid[k] = random_solid(&seed, 0.01, 0.0);
            r.contact[k].side[0].body = k;
            r.contact[k].side[1].body = k < 7 ? k + 1 : -1;
            r.contact[k].gap = k ? 1e-9 : 1e-5;
        }
        rig_place(&r, &r.contact[7], 1, 1, 0.3);
        r.solid[0].body.velocity[2] = -2.0;
    }
    return r;
}

static void rig_free(rig* r) {
    ancf_table_destroy(r->t);
    free(r->shift);
    build_free(&r->b);
}

static double rig_energy(const rig* r) {
    double sum = kinetic_of_field(&r->b, r->b.v);
    for (int i = 0; i < r->n_bodies; ++i) sum += kinetic_of_solid(&r->solid[i], &r->solid[i].body);
    for (int k = 0; k < r->n_contacts; ++k) {
        const ancf_contact* c = &r->contact[k];
        sum += ancf_normal_energy(&c->law, -c->gap);
    }
    return sum;
}

// One step with `factor` times the sub-steps that the table asks for. Returns what the damping took.
static double rig_step(rig* r, double factor, int* substeps) {
    int stiffest;
    double damped = 0.0;
    ancf_table_clear(r->t);
    for (int i = 0; i < r->n_places; ++i) ancf_table_add_place(r->t, r->b.m, r->place[i].element, r->place[i].xi);
    for (int i = 0; i < r->n_bodies; ++i) ancf_table_add_body(r->t, &r->solid[i].body);
    for (int k = 0; k < r->n_contacts; ++k) ancf_table_add_contact(r->t, &r->contact[k]);
    assert_int_equal(ancf_table_prepare(r->t, r->b.m, r->b.v), ANCF_OK);
    const int n = (int)ceil(factor * ancf_table_substeps(r->t, r->step, &stiffest));
    ancf_table_press(r->t, r->step, n);
    memset(r->shift, 0, 3 * (size_t)r->b.stride * sizeof(double));
    ancf_table_apply(r->t, r->b.m, r->step, r->b.v, r->shift);
    for (int i = 0; i < r->n_bodies; ++i) {
        memcpy(r->solid[i].body.velocity, ancf_table_body(r->t, i)->velocity, 3 * sizeof(double));
        memcpy(r->solid[i].body.spin, ancf_table_body(r->t, i)->spin, 3 * sizeof(double));
    }
    for (int k = 0; k < r->n_contacts; ++k) {
        r->contact[k].gap = ancf_table_contact(r->t, k)->gap;
        damped += ancf_table_contact(r->t, k)->damped;
    }
    *substeps += n;
    return damped;
}

static void energy_of_long_runs(void** state) {
    (void)state;
    static const char* name[RIGS] = {"two on one element", "between two cables", "on 20 places", "row", "squeezed"};
    for (int run = 0; run < 4 * RIGS; ++run) {
        const int kind = run / 4;
        rig r = rig_make(kind, run % 2 ? ANCF_LUMPED : 0, run / 2 % 2 ? 0.2 : 0.0);
        const double start = rig_energy(&r);
        double worst = 0.0, put = 0.0;
        int substeps = 0;
        for (int i = 0; i < 2000; ++i) {
            const double before = r.gravity != 0.0 ? rig_energy(&r) : 0.0;
            if (r.gravity != 0.0) r.solid[0].body.velocity[2] -= r.step * r.gravity;
            if (r.gravity != 0.0) put += rig_energy(&r) - before;
            put -= rig_step(&r, 1.0, &substeps);
            worst = fmax(worst, fabs(rig_energy(&r) - put - start) / start);
        }
        print_message("%s%s: off by %.2g in %d sub-steps\n", name[kind], run / 2 % 2 ? ", damped" : "", worst,
                      substeps);
        assert_true(substeps > 10);
        assert_true(worst < 1e-6);
        rig_free(&r);
    }
}

// A ball that a soft contact pushes within a step into stiff ones, which the sub-steps were not made for: no energy
// comes.
static void stiff_contacts_met_on_the_way(void** state) {
    (void)state;
    for (int run = 0; run < 8; ++run) {
        rig r = rig_make(SQUEEZED, 0, run % 2 ? 0.2 : 0.0);
        r.n_contacts = 3;
        r.step = 1e-3;
        r.solid[0].body.velocity[2] = 0.0;
        for (int k = 0; k < 3; ++k) {
            const double normal[3][3] = {{0.0, 0.0, -1.0}, {0.6, 0.0, 0.8}, {-0.6, 0.0, 0.8}};
            memcpy(r.contact[k].normal, normal[k], sizeof normal[k]);
            r.contact[k].law.stiffness = pow(10.0, 7 + run / 2);
            r.contact[k].gap = 1e-6 * (1.0 + 0.1 * k);
        }
        r.contact[0].law = (ancf_normal) {ANCF_NORMAL_LINEAR, 1e3, 1.0, 0.0};
        r.contact[0].gap = -1e-3;
        const double start = rig_energy(&r);
        double worst = 0.0, put = 0.0;
        int substeps = 0;
        for (int i = 0; i < 500; ++i) {
            const double damped = rig_step(&r, 1.0, &substeps);
            assert_true(damped >= -1e-9 * start);
            put -= damped;
            worst = fmax(worst, fabs(rig_energy(&r) - put - start) / start);
        }
        print_message("stiffness %.0e%s: off by %.2g\n", r.contact[1].law.stiffness, run % 2 ? ", damped" : "", worst);
        assert_true(worst < 1e-4);
        rig_free(&r);
    }
}

// The same system by the Runge-Kutta scheme in tiny steps: velocities, ways and gaps, all from the mass matrix itself.
typedef struct {
    double *v, *way;        // fields
    ancf_body body[BODIES]; // shift and turn: ways
    double gap[CONTACTS];
} motion;

static motion motion_copy(const motion* a, int n) {
    motion c = *a;
    c.v = malloc(2 * (size_t)n * sizeof *c.v);
    c.way = c.v + n;
    memcpy(c.v, a->v, (size_t)n * sizeof *c.v);
    memcpy(c.way, a->way, (size_t)n * sizeof *c.v);
    return c;
}

static void body_add(ancf_body* a, double h, const ancf_body* rate) {
    for (int i = 0; i < 3; ++i) {
        a->velocity[i] += h * rate->velocity[i];
        a->spin[i] += h * rate->spin[i];
        a->shift[i] += h * rate->shift[i];
        a->turn[i] += h * rate->turn[i];
    }
}

static void motion_add(motion* a, double h, const motion* rate, const scene* s) {
    for (int i = 0; i < 3 * s->b.stride; ++i) {
        a->v[i] += h * rate->v[i];
        a->way[i] += h * rate->way[i];
    }
    for (int i = 0; i < s->n_bodies; ++i) body_add(&a->body[i], h, &rate->body[i]);
    for (int k = 0; k < s->n_contacts; ++k) a->gap[k] += h * rate->gap[k];
}

// Forces act on the second side where the first side's point is in space by now.
static void move_arm(ancf_contact* c, const motion* a, const scene* s) {
    const ancf_side *first = &c->side[0], *second = &c->side[1];
    double way[3], back[3];
    if (second->body < 0) return;
    if (first->place >= 0) {
        const ancf_place* p = ancf_table_place(s->t, first->place);
        own_at(way, &s->b, a->way, p->element, p->xi);
    } else memcpy(way, a->body[first->body].shift, sizeof way);
    if (second->place >= 0) {
        const ancf_place* p = ancf_table_place(s->t, second->place);
        own_at(back, &s->b, a->way, p->element, p->xi);
    } else memcpy(back, a->body[second->body].shift, sizeof back);
    for (int i = 0; i < 3; ++i) c->side[1].arm[i] = c->start[i] + way[i] - back[i];
}

static void motion_rate(motion* rate, const motion* a, const scene* s) {
    double force[CONTACTS][3];
    memcpy(rate->way, a->v, 3 * (size_t)s->b.stride * sizeof(double));
    memset(rate->v, 0, 3 * (size_t)s->b.stride * sizeof(double));
    for (int i = 0; i < s->n_bodies; ++i) {
        rate->body[i] = a->body[i];
        for (int c = 0; c < 3; ++c) {
            rate->body[i].shift[c] = a->body[i].velocity[c];
            rate->body[i].turn[c] = a->body[i].spin[c];
            rate->body[i].velocity[c] = rate->body[i].spin[c] = 0.0;
        }
    }
    for (int k = 0; k < s->n_contacts; ++k) {
        ancf_contact* c = ancf_table_contact(s->t, k);
        double u[3];
        move_arm(c, a, s);
        own_slip(u, &s->b, s->t, c, a->v, a->body);
        rate->gap[k] = dot(u, c->normal);
        const double f = ancf_normal_force(&c->law, -a->gap[k], -rate->gap[k]);
        for (int i = 0; i < 3; ++i) force[k][i] = f * c->normal[i];
    }
    own_give(&s->b, s->t, rate->v, rate->body, s->n_contacts, force);
    for (int k = 0; k < s->n_contacts; ++k) {
        ancf_contact* c = ancf_table_contact(s->t, k);
        memcpy(c->side[1].arm, c->start, sizeof c->start);
    }
}

static void motion_run(motion* a, const scene* s, double step, int steps) {
    static const double at[4] = {0.0, 0.5, 0.5, 1.0}, weight[4] = {1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0};
    const int n = 3 * s->b.stride;
    const double h = step / steps;
    motion rate = motion_copy(a, n);
    for (int i = 0; i < steps; ++i) {
        motion from = motion_copy(a, n);
        for (int k = 0; k < 4; ++k) {
            motion stage = motion_copy(&from, n);
            if (k) motion_add(&stage, at[k] * h, &rate, s);
            motion_rate(&rate, &stage, s);
            motion_add(a, weight[k] * h, &rate, s);
            free(stage.v);
        }
        free(from.v);
    }
    free(rate.v);
}

// Largest of what is off, each kind as a part of its own size.
static double difference(const scene* s, const motion* ref, double step) {
    double off[4] = {0.0}, size[4] = {0.0}, worst = 0.0;
    for (int i = 0; i < 3 * s->b.stride; ++i) {
        const double way = step * s->b.v[i] + s->shift[i];
        off[0] = fmax(off[0], fabs(s->b.v[i] - ref->v[i]));
        off[1] = fmax(off[1], fabs(way - ref->way[i]));
        size[0] = fmax(size[0], fabs(ref->v[i] - s->v[i]));
        size[1] = fmax(size[1], fabs(ref->way[i] - step * s->v[i]));
    }
    for (int j = 0; j < s->n_bodies; ++j) {
        const ancf_body *b = ancf_table_body(s->t, j), *r = &ref->body[j], *before = &s->solid[j].body;
        for (int i = 0; i < 3; ++i) {
            off[2] = fmax(off[2], fabs(step * before->velocity[i] + b->shift[i] - r->shift[i]));
            off[3] = fmax(off[3], fabs(step * before->spin[i] + b->turn[i] - r->turn[i]));
            size[2] = fmax(size[2], fabs(r->shift[i] - step * before->velocity[i]));
            size[3] = fmax(size[3], fabs(r->turn[i] - step * before->spin[i]));
        }
    }
    for (int k = 0; k < 4; ++k) worst = fmax(worst, off[k] / size[k]);
    return worst;
}

static void converge(bool damped, double wanted) {
    enum { LEVELS = 5, RUNS = 12 };
    double mean[LEVELS] = {0.0}, enough = 0.0;
    for (int run = 0; run < RUNS; ++run) {
        motion ref = {0};
        uint64_t seed = 100 + (uint64_t)run;
        double step = 0.0;
        for (int level = -1; level < LEVELS; ++level) {
            seed = 100 + (uint64_t)run;
            scene s = scene_make(&seed, run, damped);
            int stiffest;
            if (level < 0) { // so long that the stiffest contact wants so many sub-steps
                step = wanted * 1e-3 / ancf_table_substeps(s.t, 1e-3, &stiffest);
                ref = motion_copy(&(motion) {.v = s.v, .way = s.shift}, 3 * s.b.stride);
                for (int i = 0; i < s.n_bodies; ++i) ref.body[i] = s.solid[i].body;
                for (int k = 0; k < s.n_contacts; ++k) ref.gap[k] = ancf_table_contact(s.t, k)->gap;
                motion_run(&ref, &s, step, 2000);
            } else {
                const int n = level ? 4 << level : ancf_table_substeps(s.t, step, &stiffest);
                ancf_table_press(s.t, step, n);
                ancf_table_apply(s.t, s.b.m, step, s.b.v, s.shift);
                const double off = difference(&s, &ref, step);
                if (level == 0) enough = fmax(enough, off);
                mean[level] += off / RUNS;
            }
            scene_free(&s);
        }
        free(ref.v);
    }
    print_message("%s: off by %.3g at the table's sub-steps (mean %.3g), at 8, 16 .. by",
                  damped ? "damped" : "undamped", enough, mean[0]);
    for (int level = 1; level < LEVELS; ++level) print_message(" %.3g", mean[level]);
    print_message("\n");
    assert_true(enough < 0.02 && mean[0] < 0.01);
    assert_near(log2(mean[LEVELS - 2] / mean[LEVELS - 1]), 2.0, 0.15);
}

static void ways_converge_to_the_reference(void** state) {
    (void)state;
    converge(false, 10.0);
    converge(true, 10.0);
    converge(false, 30.0);
    converge(true, 30.0);
}

// Nothing is computed where nothing can touch, and gaps go on alone.
static void no_substeps_where_nothing_touches(void** state) {
    (void)state;
    uint64_t seed = 65;
    for (int run = 0; run < 40; ++run) {
        const double step = 1e-4;
        scene s = scene_make(&seed, run, true);
        double before[CONTACTS], rate[CONTACTS], kinetic = scene_kinetic(&s);
        int stiffest = -7;
        for (int k = 0; k < s.n_contacts; ++k) {
            ancf_contact* c = ancf_table_contact(s.t, k);
            double u[3];
            ancf_table_slip(u, s.t, c);
            rate[k] = dot(u, c->normal);
            before[k] = c->gap = 1e-9 + fmax(0.0, -rate[k] * step);
        }
        assert_int_equal(ancf_table_substeps(s.t, step, &stiffest), 0);
        assert_in_range(stiffest, 0, s.n_contacts - 1);
        ancf_table_press(s.t, step, 0);
        ancf_table_apply(s.t, s.b.m, step, s.b.v, s.shift);
        for (int k = 0; k < s.n_contacts; ++k) {
            const ancf_contact* c = ancf_table_contact(s.t, k);
            assert_near(c->gap, before[k] + step * rate[k], 1e-15);
            assert_true(c->impulse == 0.0 && c->energy == 0.0 && c->damped == 0.0);
        }
        assert_true(scene_kinetic(&s) == kinetic);
        // One that will touch is enough, and it is told.
        const int k = run % s.n_contacts;
        if (rate[k] < -1e-3) {
            ancf_table_contact(s.t, k)->gap = -0.5 * rate[k] * step;
            assert_true(ancf_table_substeps(s.t, step, &stiffest) > 0);
            assert_in_range(stiffest, 0, s.n_contacts - 1);
        }
        scene_free(&s);
    }
}

// Thrown at a wall and drawn back, a body would be where it was after a step of mean velocity 0, and yet it hits: at
// v^2 = v0^2 - 2 a gap, if that is above 0. While it touches it is drawn back as well.
static void what_turns_within_a_step_hits(void** state) {
    (void)state;
    impact s = impact_make(PLACE_BODY, 1.0);
    const double step = 1e-3, a = 1000.0, mass = 0.2, start = 0.5 * a * step, deep = 0.5 * start * start / a;
    for (int i = 0; i < 20; ++i) {
        const double gap = deep * (0.05 + 0.1 * i), square = start * start - 2.0 * a * gap;
        ancf_table_clear(s.t);
        ancf_body body = {.acceleration = {0.0, 0.0, a}, .inv_mass = {1.0 / mass, 1.0 / mass, 1.0 / mass}};
        const ancf_contact c = {.side = {{-1, ancf_table_add_body(s.t, &body), {0}}, {-1, -1, {0}}},
                                .normal = {0.0, 0.0, 1.0},
                                .gap = gap,
                                .law = {ANCF_NORMAL_HERTZ, 1e12, 1.5, 0.0}};
        ancf_table_add_contact(s.t, &c);
        int stiffest;
        assert_int_equal(ancf_table_prepare(s.t, s.b.m, s.b.v), ANCF_OK);
        const int n = ancf_table_substeps(s.t, step, &stiffest);
        ancf_table_press(s.t, step, n);
        const double impulse = ancf_table_contact(s.t, 0)->impulse;
        const double v = sqrt(fmax(square, 0.0)), lasts = v > 0.0 ? duration(&c.law, 1.0 / mass, v) : 0.0;
        assert_near(impulse, mass * (2.0 * v - a * lasts), 0.005 * mass * start);
    }
    impact_free(&s);
}

// Forces beyond all numbers on one of two cables that do not feel each other: no smaller number hides them, whichever
// of the contacts and cables they are on.
static void not_a_number_is_told(void** state) {
    (void)state;
    for (int run = 0; run < 8; ++run) {
        const int which = run % 4, rubbing = run / 4;
        built b = build_start(4, 2, (ancf_element) {.length = 1.0, .ea = 1.0, .rho_a = 1.0});
        for (int i = 0; i < 4; ++i) {
            b.x[i] = (double)i;
            b.ends[i] = i;
        }
        build_slopes(&b);
        build_finish(&b);
        ancf_table* t;
        assert_int_equal(ancf_table_create(&t, b.m), ANCF_OK);
        ancf_table_clear(t);
        for (int i = 0; i < 4; ++i) {
            ancf_body body = {.position = {2.0 * (i / 2) + 0.5, 0.0, -0.01}, .velocity = {0.1, 0.0, 1.0}};
            for (int k = 0; k < 3; ++k) body.inv_mass[k] = 10.0;
            ancf_contact c = {
                .side = {{ancf_table_add_place(t, b.m, i / 2, 0.5), -1, {0}}, {-1, ancf_table_add_body(t, &body), {0}}},
                .normal = {0.0, 0.0, 1.0},
                .gap = -1e-5,
                .law = {ANCF_NORMAL_HERTZ, 1e6, 1.5, 0.0},
                .rub = {ANCF_FRICTION_HOLLARS, 0.3, 0.2, 1e-3}};
            if (i == which && rubbing) c.friction[0] = INFINITY;
            if (i == which && !rubbing) {
                c.law.stiffness = 1e300;
                c.gap = -1e10;
            }
            ancf_table_add_contact(t, &c);
        }
        int stiffest = -7;
        double left = 0.0;
        assert_int_equal(ancf_table_prepare(t, b.m, b.v), ANCF_OK);
        ancf_table_substeps(t, 1e-5, &stiffest);
        assert_in_range(stiffest, 0, 3);
        const double pressed = ancf_table_press(t, 1e-5, 4);
        ancf_table_rub(t, 1e-5, &left);
        assert_true(isnan(rubbing ? left : pressed));
        if (!rubbing) assert_int_equal(stiffest, which);
        ancf_table_destroy(t);
        build_free(&b);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(single_impacts_bounce_by_theory),   cmocka_unit_test(momentum_is_exact),
        cmocka_unit_test(energy_of_random_tables),           cmocka_unit_test(energy_of_long_runs),
        cmocka_unit_test(stiff_contacts_met_on_the_way),     cmocka_unit_test(ways_converge_to_the_reference),
        cmocka_unit_test(no_substeps_where_nothing_touches), cmocka_unit_test(not_a_number_is_told),
        cmocka_unit_test(what_turns_within_a_step_hits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
