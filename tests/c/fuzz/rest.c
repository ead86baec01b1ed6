// Equilibrium: found, or told that it was not; alone and on what may be touched.
#include "ancf/equilibrium.h"
#include "fuzz.h"

enum { OBSTACLES_MOST = 3, KINDS = 2, FREE_MOST = 500 };

typedef struct {
    ancf_obstacle obstacle[OBSTACLES_MOST];
    ancf_groove groove[OBSTACLES_MOST];
    ancf_normal law[OBSTACLES_MOST][KINDS];
    ancf_laws between[KINDS * KINDS];
    ancf_obstacle_pair pair[OBSTACLES_MOST];
    int n, n_pairs;
} things;

static void any_things(things* t, fuzz* f, const ancf_model* m) {
    static const int excluded[1] = {0};
    t->n = pick(f, OBSTACLES_MOST + 1);
    for (int i = 0; i < KINDS * KINDS; ++i) t->between[i] = (ancf_laws) {good_normal_law(f), good_friction_law(f)};
    for (int i = 0; i < t->n; ++i) {
        ancf_obstacle* o = &t->obstacle[i];
        do o->solid = any_solid(f, &t->groove[i]);
        while (o->solid.kind == ANCF_WHEEL && ancf_groove_check(&t->groove[i]));
        for (int k = 0; k < KINDS; ++k) t->law[i][k] = good_normal_law(f);
        o->node = by_chance(f, 0.3) ? any_knot(f, m) : -1;
        if (o->node >= 0) o->solid.kind = ANCF_BALL;
        o->mask = 1;
        o->law = t->law[i];
        o->excluded = excluded;
        o->n_excluded = by_chance(f, 0.3);
        vector_between(o->arm, f, 0.01);
    }
    for (int i = 0; i < t->n; ++i)
        if (t->obstacle[i].node >= 0 && t->n > 1)
            t->pair[t->n_pairs++] = (ancf_obstacle_pair) {i, (i + 1) % t->n, good_normal_law(f)};
}

void fuzz_rest(fuzz* f) {
    built b;
    if (!any_model(&b, f)) return;
    vector_between(b.m->gravity, f, 10.0);
    b.m->unloaded = true;
    ancf_cover* cover = any_cover(f, b.m, 4, KINDS);
    things t = {0};
    any_things(&t, f, b.m);
    ancf_rest* rest = NULL;
    const double tolerance = magnitude(f, 1e-9, 1e-3);
    spoil(f, &b);
    const bool finite = all_finite(b.x, 3 * b.stride); // what no force feels stays as it is
    if (by_chance(f, 0.1)) fuzz_fail_allocation(1 + pick(f, 60));
    if (t.n > 0 && ancf_rest_create(&rest, b.m, cover, t.between, KINDS, t.obstacle, t.n, t.pair, t.n_pairs)) {
        need(rest == NULL);
    } else {
        const ancf_error error = ancf_equilibrium(b.m, tolerance, 1 + pick(f, FREE_MOST), rest);
        need(error == ANCF_OK || error == ANCF_E_EQUILIBRIUM || error == ANCF_E_MEMORY || error == ANCF_E_FACTOR);
        for (int i = 0; i < 3 * b.stride && error == ANCF_OK; ++i) need((isfinite(b.x[i]) || !finite) && b.v[i] == 0.0);
    }
    fuzz_fail_allocation(0);
    ancf_rest_destroy(rest);
    free(cover);
    build_free(&b);
}
