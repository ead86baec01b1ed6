// Tables of contacts through steps of a cable.
#include "ancf/contact.h"
#include "fuzz.h"

enum { SUBSTEPS_MOST = 300 }; // that a test has time for

static int any_place(fuzz* f, ancf_table* t, const ancf_model* m) {
    const int element = pick(f, m->n_elements);
    const double xi = by_chance(f, 0.2) ? pick(f, 2) : random_unit(&f->seed);
    if (by_chance(f, 0.2)) return ancf_table_add_knot(t, m, any_knot(f, m));
    if (by_chance(f, 0.2)) return ancf_table_add_mean(t, m, element, (double[3]) {xi, xi * xi, xi * xi * xi});
    return ancf_table_add_place(t, m, element, xi);
}

static void any_body(ancf_body* b, fuzz* f) {
    *b = (ancf_body) {0};
    vector_between(b->position, f, 1.0);
    vector_between(b->velocity, f, 5.0);
    vector_between(b->spin, f, 20.0);
    vector_between(b->acceleration, f, 10.0);
    vector_between(b->turning, f, 10.0);
    if (by_chance(f, 0.1)) {
        const double mass = random_magnitude(&f->seed, 1e-3, 10.0);
        unit_vector(b->along, f);
        for (int i = 0; i < 3; ++i) b->along[i] /= sqrt(mass);
        return;
    }
    const double mass = magnitude(f, 1e-3, 10.0), inertia = magnitude(f, 1e-6, 1e-2);
    for (int i = 0; i < 3; ++i) {
        if (by_chance(f, 0.8)) b->inv_mass[i] = 1.0 / mass;
        if (by_chance(f, 0.8)) b->inv_inertia[4 * i] = 1.0 / inertia;
    }
}

// A cable and what stands still, a body, or a ball that a knot carries; such a ball and the same.
static void touch_body(ancf_contact* c, fuzz* f, ancf_table* t, const ancf_model* m, int bodies) {
    c->side[0].place = any_place(f, t, m);
    for (int s = 0; s < 2 && bodies > 0; ++s) {
        if (by_chance(f, s ? 0.3 : 0.8)) continue;
        c->side[s].body = pick(f, bodies);
        if (s == 1 && c->side[0].body == c->side[1].body) c->side[1].body = -1;
        if (c->side[s].body < 0) continue;
        vector_between(c->side[s].arm, f, 0.1);
        const double* inv = ancf_table_body(t, c->side[s].body)->inv_mass;
        if (s == 0 || (inv[0] == 0.0 && inv[1] == 0.0 && inv[2] == 0.0))
            c->side[s].place = ancf_table_add_knot(t, m, any_knot(f, m));
    }
    if (c->side[0].body < 0 && c->side[1].body >= 0 && by_chance(f, 0.5)) c->round = c->held = magnitude(f, 1e-3, 1e-1);
}

static void touch_cable(ancf_contact* c, fuzz* f, ancf_table* t, const ancf_model* m) {
    double x[2][3];
    for (int s = 0; s < 2; ++s) {
        const int element = pick(f, m->n_elements);
        const double xi = random_unit(&f->seed);
        c->side[s].place = ancf_table_add_slope(t, m, element, xi);
        c->radius[s] = magnitude(f, 1e-4, 1e-2);
        ancf_model_at(x[s], m, m->x, element, xi);
    }
    for (int i = 0; i < 3; ++i) c->side[1].arm[i] = x[0][i] - x[1][i];
}

static void any_contact(ancf_contact* c, fuzz* f, ancf_table* t, const ancf_model* m, int bodies) {
    *c =
        (ancf_contact) {.side = {{-1, -1, {0}}, {-1, -1, {0}}}, .law = good_normal_law(f), .rub = good_friction_law(f)};
    c->plain = c->law;
    if (by_chance(f, 0.2)) touch_cable(c, f, t, m);
    else touch_body(c, f, t, m, bodies);
    unit_vector(c->normal, f);
    c->gap = by_chance(f, 0.5) ? -magnitude(f, 1e-7, 1e-4) : magnitude(f, 1e-7, 1e-2);
    c->margin = by_chance(f, 0.5) ? 0.0 : magnitude(f, 1e-6, 1e-2);
    c->owed = by_chance(f, 0.8) ? 0.0 : between(f, -1e-6, 1e-6);
    if (by_chance(f, 0.3)) vector_between(c->friction, f, 0.1);
    c->within[1] = by_chance(f, 0.5) ? 1.0 : 0.0;
}

static bool fill(fuzz* f, ancf_table* t, const built* b) {
    const int bodies = pick(f, 4), contacts = pick(f, 7),
              couplings = bodies > 0 && by_chance(f, 0.3) ? 1 + pick(f, 2) : 0;
    int last = -1;
    ancf_table_clear(t);
    for (int i = 0; i < bodies; ++i) {
        ancf_body body;
        any_body(&body, f);
        if (ancf_table_add_body(t, &body) < 0) return false;
    }
    for (int i = 0; i < contacts; ++i) {
        ancf_contact c;
        any_contact(&c, f, t, b->m, bodies);
        if (c.side[0].place < 0 || (c.radius[1] != 0.0 && c.side[1].place < 0) || ancf_table_add_contact(t, &c) < 0)
            return false;
    }
    for (int i = 0; i < couplings && i < bodies; ++i) { // a knot carries one body, and is not held
        const int knot = any_knot(f, b->m);
        bool slides = false;
        for (int k = 0; k < b->m->n_slides; ++k) slides = slides || b->m->slide[k].node == knot;
        if (b->m->hold[knot] || knot == last || slides) continue;
        ancf_coupling c = {.place = ancf_table_add_knot(t, b->m, last = knot), .body = i};
        vector_between(c.arm, f, 0.1);
        if (c.place < 0 || ancf_table_add_coupling(t, &c) < 0) return false;
    }
    return true;
}

// Normal forces never pull, and friction stays within its cone, on average over the step.
static void hold_to_laws(ancf_table* t, double step) {
    for (int i = 0; i < ancf_table_contacts(t); ++i) {
        const ancf_contact* c = ancf_table_contact(t, i);
        need(c->impulse >= 0.0 && isfinite(c->impulse));
        const double size =
            sqrt(c->friction[0] * c->friction[0] + c->friction[1] * c->friction[1] + c->friction[2] * c->friction[2]);
        need(size * step <= fmax(c->rub.mu_s, c->rub.mu_k) * c->impulse * (1.0 + 1e-6) + 1e-12);
    }
}

// after: room for two fields.
static bool step_through(fuzz* f, ancf_table* t, built* b, double step, bool first, bool sane, double* after) {
    ancf_model* m = b->m;
    const ancf_time time = {step, first ? 0.0 : step};
    const size_t size = 3 * (size_t)b->stride;
    int stiffest;
    double left;
    ancf_predict(m, &time);
    if (first) {
        if (by_chance(f, 0.5)) ancf_table_rest(t, m, m->free, step, by_chance(f, 0.7) ? 0.0 : -0.5 * step);
        if (ancf_table_prepare(t, m, m->free)) return false;
        ancf_table_accelerate(t, m, m->a);
    } else if (ancf_table_go_on(t, m, m->free, step)) {
        return false;
    }
    need(ancf_table_awake(t) >= 0 && ancf_table_awake(t) <= ancf_table_contacts(t));
    double* shift = after + size;
    memset(shift, 0, size * sizeof *shift);
    memcpy(after, m->free, size * sizeof *after);
    if (by_chance(f, 0.7)) ancf_table_guess(t, step);
    ancf_table_couple(t, step);
    const int needed = ancf_table_substeps(t, step, &stiffest);
    need(needed >= 0 && (needed == 0 || (stiffest >= 0 && stiffest < ancf_table_contacts(t))));
    const double pressed = ancf_table_press(t, step, needed < SUBSTEPS_MOST ? needed : SUBSTEPS_MOST);
    const int sweeps = ancf_table_rub(t, step, &left);
    need(sweeps >= 0);
    if (sweeps > 0) ancf_table_couple(t, step);
    ancf_table_apply(t, m, step, after, shift);
    ancf_table_forces(t, m, step, m->f);
    ancf_table_end(t, step);
    sane = sane && needed < SUBSTEPS_MOST && pressed < 1e-3 && left < 1e-3; // else it was told
    if (sane) hold_to_laws(t, step);
    ancf_correct(m, &time, after, shift);
    if (sane) need(ancf_finite(m, m->x) && ancf_finite(m, m->v));
    double v[3];
    for (int i = 0; i < ancf_table_contacts(t); ++i) ancf_table_slip(v, t, ancf_table_contact(t, i));
    ancf_table_impulse(v, t, m, pick(f, b->n_dof));
    ancf_table_twist_left(v, t);
    return true;
}

void fuzz_table(fuzz* f) {
    built b;
    if (!any_model(&b, f)) return;
    ancf_table* t = NULL;
    double* after = calloc(6 * (size_t)b.stride, sizeof *after);
    spoil(f, &b);
    if (by_chance(f, 0.1)) fuzz_fail_allocation(1 + pick(f, 60));
    const double step = any_step(f, b.m);
    const int steps = 1 + pick(f, 3);
    const bool sane = f->chance == 0.0; // until contacts have thrown things about
    if (ancf_table_create(&t, b.m) == ANCF_OK) {
        for (int filling = 0; filling < 2; ++filling)
            if (fill(f, t, &b))
                for (int i = 0; i < steps && step_through(f, t, &b, step, i == 0, sane && i + filling == 0, after);
                     ++i) {
                }
        ancf_table_destroy(t);
    }
    fuzz_fail_allocation(0);
    free(after);
    build_free(&b);
}
