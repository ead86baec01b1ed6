// Models: refused for what they are refused for and nothing else, stepped in every way, and read.
#include "ancf/implicit.h"
#include "ancf/motion.h"
#include "ancf/response.h"
#include "ancf/tangent.h"
#include "fuzz.h"

static bool good(double value) { return isfinite(value) && value > 0.0; }

static bool not_negative(double value) { return isfinite(value) && value >= 0.0; }

static bool element_is_right(const built* b, int e) {
    const ancf_element* el = &b->element[e];
    const int *ends = &b->ends[2 * e], k = b->next[e], n = b->def.n_elements;
    for (int i = 0; i < 2; ++i)
        if (ends[i] < 0 || ends[i] >= b->def.n_nodes) return false;
    if (ends[0] == ends[1] || el->kind < 0 || el->kind > 31) return false;
    if (!good(el->length) || !good(el->ea) || !not_negative(el->ei) || !good(el->rho_a) || !not_negative(el->damping) ||
        !not_negative(el->drag))
        return false;
    if ((el->kind & ANCF_SPRING) && el->ei != 0.0) return false;
    if (k == -1) return true;
    if (k < 0 || k >= n || b->ends[2 * k] != ends[1] || ((el->kind | b->element[k].kind) & ANCF_SPRING)) return false;
    for (int other = 0; other < e; ++other)
        if (b->next[other] == k) return false;
    return true;
}

// What the header says of a definition, written here again.
static bool is_right(const built* b) {
    for (int e = 0; e < b->def.n_elements; ++e)
        if (!element_is_right(b, e)) return false;
    for (int i = 0; i < b->def.n_nodes; ++i) {
        bool met = false;
        for (int k = 0; k < 2 * b->def.n_elements; ++k) met = met || b->ends[k] == i;
        if (!met && !(b->def.hold && b->hold[i])) return false;
        if (b->def.mass && !not_negative(b->mass[i])) return false;
    }
    for (int i = 0; i < b->def.n_slides; ++i) {
        const int node = b->slide[i].node;
        if ((b->def.hold && b->hold[node]) || (i == 1 && b->slide[0].node == node)) return false;
    }
    for (int c = 0; c < 3; ++c)
        if (!all_finite(b->x + c * b->stride, b->n_dof) || !all_finite(b->v + c * b->stride, b->n_dof)) return false;
    return true;
}

static built copy_of(const built* b) {
    built c = build_start(b->def.n_nodes, b->def.n_elements, (ancf_element) {0});
    need(ancf_model_create(&c.m, &b->def, c.x, c.v, NULL) == ANCF_OK);
    memcpy(c.x, b->x, 3 * (size_t)b->stride * sizeof *b->x);
    memcpy(c.v, b->v, 3 * (size_t)b->stride * sizeof *b->v);
    memcpy(c.m->gravity, b->m->gravity, sizeof c.m->gravity);
    memcpy(c.m->external, b->m->external, 3 * (size_t)b->stride * sizeof(double));
    memcpy(c.m->held, b->m->held, 3 * (size_t)b->stride * sizeof(double));
    c.m->unloaded = b->m->unloaded;
    c.m->track = b->m->track;
    return c;
}

static void read(fuzz* f, built* b) {
    ancf_model* m = b->m;
    ancf_energy energy;
    int element;
    double axial, bending, linear[3], angular[3], at[3];
    ancf_energy_of(&energy, m, 0, m->n_elements);
    ancf_elastic_energy(&axial, &bending, m, m->x, 0, m->n_elements);
    ancf_kinetic_kept(m, 1e-5, 1e-5);
    ancf_height(m);
    ancf_momentum(linear, angular, m);
    ancf_strain_max(m, m->x, &element);
    need(element >= 0 && element < m->n_elements);
    const int e = pick(f, m->n_elements);
    const double xi = random_unit(&f->seed);
    ancf_strain(m, m->x, e, xi);
    ancf_tension(m, e, xi);
    ancf_model_at(at, m, m->x, e, xi);
    ancf_speed_spread(m, m->v);
    ancf_reaction(at, m, pick(f, m->n_dof));
    bool finite = true;
    for (int c = 0; c < 3; ++c) finite = finite && all_finite(m->x + c * m->stride, m->n_dof);
    if (!finite) need(!ancf_finite(m, m->x));
    if (f->chance > 0.0) return;
    need(finite && ancf_finite(m, m->x) && isfinite(axial) && isfinite(bending) && isfinite(energy.kinetic));
    need(energy.axial >= 0.0 && energy.bending >= 0.0 && energy.kinetic >= 0.0);
    need(all_finite(linear, 3) && all_finite(angular, 3));
}

// Both ways to take a step agree to the last bit; a free cable without forces keeps its momentum.
static void leapfrog(fuzz* f, built* b, double step, int steps) {
    built twin = copy_of(b);
    ancf_time time = {step, 0.0};
    double P[2][3], H[3], terms[2][2], pull = 0.0;
    own_momentum(P[0], H, terms[0], b);
    for (int i = 0; i < steps; ++i) {
        ancf_advance(b->m, &time);
        ancf_predict(twin.m, &time);
        ancf_correct(twin.m, &time, twin.m->free, NULL);
        for (int k = 0; k < 3 * b->def.n_elements; ++k) pull += step * fabs(b->m->pull[k]);
        time.last = step;
        const bool finite = all_finite(b->x, 3 * b->stride) && all_finite(b->v, 3 * b->stride);
        for (int k = 0; k < 3 * b->stride && finite; ++k) need(b->x[k] == twin.x[k] && (b->v[k] == twin.v[k]));
    }
    const double* g = b->m->gravity;
    bool alone =
        b->m->unloaded && b->def.n_slides == 0 && f->chance == 0.0 && g[0] == 0.0 && g[1] == 0.0 && g[2] == 0.0;
    for (int i = 0; i < b->n_dof; ++i) alone = alone && !b->m->hold[i];
    for (int e = 0; e < b->def.n_elements; ++e) alone = alone && b->element[e].drag == 0.0;
    if (!b->def.mass) memset(b->mass, 0, (size_t)b->def.n_nodes * sizeof *b->mass);
    own_momentum(P[1], H, terms[1], b);
    for (int c = 0; c < 3 && alone && b->def.mass; ++c)
        need(fabs(P[1][c] - P[0][c]) <= 1e-12 * (terms[0][0] + terms[1][0] + pull));
    ancf_model_destroy(twin.m);
    twin.m = NULL;
    build_free(&twin);
}

// A step that does not converge leaves the state as it was; one that does gives numbers.
static void implicit(fuzz* f, built* b, double step, int steps) {
    const size_t size = 3 * (size_t)b->stride;
    double *a = calloc(3 * size, sizeof *a), *before = a + size;
    ancf_implicit* s;
    const double rho = between(f, 0.0, 1.0);
    const ancf_error refused = ancf_implicit_create(&s, b->m, rho);
    need(refused == (rho >= 0.0 && rho <= 1.0 ? ANCF_OK : ANCF_E_RHO));
    ancf_time time = {step, 0.0};
    for (int i = 0; i < steps && !refused; ++i) {
        memcpy(before, b->x, size * sizeof *before);
        memcpy(before + size, b->v, size * sizeof *before);
        if (ancf_implicit_step(s, b->m, a, &time, 1)) {
            need(memcmp(before, b->x, size * sizeof *before) == 0);
            need(memcmp(before + size, b->v, size * sizeof *before) == 0);
            need(s->element >= 0 && s->element < b->def.n_elements);
            break;
        }
        need(ancf_finite(b->m, b->x) && ancf_finite(b->m, b->v));
        time.last = step;
    }
    if (!refused) ancf_implicit_destroy(s);
    free(a);
}

static void others(fuzz* f, built* b, double step) {
    ancf_model* m = b->m;
    const int n = m->n_elements;
    double* tangent = calloc((size_t)n * ANCF_TANGENT, sizeof *tangent);
    ancf_tangent(tangent, m, m->x, m->v, magnitude(f, 1e-3, 1e5), by_chance(f, 0.5));
    if (f->chance == 0.0) need(all_finite(tangent, n * ANCF_TANGENT));
    free(tangent);
    ancf_responses* responses;
    need(ancf_responses_create(&responses, m) == ANCF_OK);
    const ancf_response* response = ancf_responses_of(responses, m, pick(f, n));
    need(response && response->n >= 0 && response->n <= m->n_dof);
    for (int i = 0; i < response->n; ++i) need(response->dof[i] >= 0 && response->dof[i] < m->n_dof);
    ancf_responses_destroy(responses);
    ancf_motion* motion;
    need(ancf_motion_create(&motion, m) == ANCF_OK);
    ancf_motion_follow(motion, m, step);
    ancf_motion_destroy(motion);
    ancf_rk4(m, step);
}

// Whatever allocation fails, that is told, and nothing is left behind.
static void short_of_memory(fuzz* f, built* b) {
    ancf_implicit* implicit = NULL;
    ancf_motion* motion = NULL;
    fuzz_fail_allocation(1 + pick(f, 60));
    ancf_error error = ancf_model_create(&b->m, &b->def, b->x, b->v, NULL);
    need((b->m == NULL) == (error != ANCF_OK));
    if (!error) error = ancf_implicit_create(&implicit, b->m, 0.5);
    if (!error) error = ancf_motion_create(&motion, b->m);
    fuzz_fail_allocation(0);
    if (f->chance == 0.0) need(error == ANCF_E_MEMORY || (error == ANCF_OK) == is_right(b));
    if (implicit) ancf_implicit_destroy(implicit);
    if (motion) ancf_motion_destroy(motion);
}

void fuzz_model(fuzz* f) {
    built b = any_build(f);
    int where = -1;
    b.def.slide = b.slide;
    if (by_chance(f, 0.05)) {
        short_of_memory(f, &b);
        build_free(&b);
        return;
    }
    if (by_chance(f, f->chance / 4.0)) b.def.n_elements = -pick(f, 3);
    const int elements = b.def.n_elements;
    const ancf_error error = ancf_model_create(&b.m, &b.def, b.x, b.v, &where);
    if (elements < 1) need(error == ANCF_E_EMPTY);
    else if (error != ANCF_E_FACTOR || f->chance == 0.0) need((error == ANCF_OK) == is_right(&b));
    need((b.m == NULL) == (error != ANCF_OK) && strlen(ancf_error_text(error)) > 0);
    if (error) {
        const int most = b.def.n_nodes > elements ? b.def.n_nodes : elements;
        need(where >= 0 && (elements < 1 || where < most));
        build_free(&b);
        return;
    }
    if (by_chance(f, 0.5)) vector_between(b.m->gravity, f, 10.0);
    b.m->unloaded = by_chance(f, 0.5);
    b.m->track = by_chance(f, 0.3);
    for (int c = 0; c < 3; ++c)
        for (int i = 0; i < b.n_dof; ++i) {
            if (!b.m->unloaded && by_chance(f, 0.2)) b.m->external[c * b.stride + i] = between(f, -1e-3, 1e-3);
            if (b.m->hold[i] && by_chance(f, 0.2)) b.m->held[c * b.stride + i] = between(f, -0.1, 0.1);
        }
    ancf_model_join(b.m, b.m->external);
    const double step = any_step(f, b.m);
    spoil(f, &b);
    const int steps = 1 + pick(f, 5);
    if (by_chance(f, 0.7)) leapfrog(f, &b, step, steps);
    else implicit(f, &b, 20.0 * step, 1);
    read(f, &b);
    if (by_chance(f, 0.3)) others(f, &b, step);
    build_free(&b);
}
