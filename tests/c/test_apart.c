// What may meet, and what rests: against brute force, and against searches that remember nothing.
#include "build.h"
#include "finder.h"

enum { CABLES = 4, ELEMENTS = 5, ALL = CABLES * ELEMENTS, STEPS = 600 };

static const double radius = 2e-3, length = 0.06; // of an element
static const double step = 1e-4;

static double distance(const double a[3], const double b[3]) {
    return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
}

static ancf_cubic random_cubic(uint64_t* seed, double bend) {
    ancf_cubic c;
    for (int k = 0; k < 3; ++k) {
        const double start = random_between(seed, -1.0, 1.0), way = random_between(seed, -0.5, 0.5);
        for (int i = 0; i < 4; ++i) c.control[i][k] = start + i / 3.0 * way + random_between(seed, -bend, bend);
    }
    return c;
}

static void random_axis(double axis[3], uint64_t* seed) {
    const double none[3] = {0.0, 0.0, 0.0};
    double size;
    do {
        for (int k = 0; k < 3; ++k) axis[k] = random_between(seed, -1.0, 1.0);
        size = distance(axis, none);
    } while (size < 0.1);
    for (int k = 0; k < 3; ++k) axis[k] /= size;
}

// Least distance of parts of two cubics by dense samples: no less than it is.
static double sampled(const ancf_cubic* p, int i, int n, const ancf_cubic* q, int j, int n2) {
    enum { SAMPLES = 40 };
    double least = INFINITY;
    for (int a = 0; a <= SAMPLES; ++a)
        for (int b = 0; b <= SAMPLES; ++b) {
            double x[3], y[3];
            ancf_cubic_at(x, p, (i + (double)a / SAMPLES) / n);
            ancf_cubic_at(y, q, (j + (double)b / SAMPLES) / n2);
            least = fmin(least, distance(x, y));
        }
    return least;
}

static void no_distance_is_smaller_than_a_gap(void** state) {
    (void)state;
    uint64_t seed = 1;
    int apart = 0;
    for (int k = 0; k < 3000; ++k) {
        const double bend = k % 3 ? 0.1 : 1.0;
        const ancf_cubic p = random_cubic(&seed, bend), q = random_cubic(&seed, bend);
        const int n = 1 + k % 7, n2 = 1 + k % 4, i = k % n, j = k % n2;
        double axis[3], back[3];
        random_axis(axis, &seed);
        for (int c = 0; c < 3; ++c) back[c] = -axis[c];
        const double gap = ancf_cubic_gap(axis, &p, i, n, &q, j, n2), least = sampled(&p, i, n, &q, j, n2);
        assert_true(gap <= least + 1e-14);
        assert_near(ancf_cubic_gap(back, &q, j, n2, &p, i, n), gap, 1e-14);
        apart += gap > 0.0;
    }
    assert_true(apart > 300);
}

// Straight ones across each other, along the axis on which they are nearest.
static void gaps_of_straight_ones_are_distances(void** state) {
    (void)state;
    uint64_t seed = 2;
    for (int k = 0; k < 300; ++k) {
        const double away = random_between(&seed, 0.0, 1.0), n[3] = {0.0, 0.0, 1.0};
        ancf_cubic p, q;
        for (int i = 0; i < 4; ++i) {
            memcpy(p.control[i], (double[3]) {i / 3.0 - 0.5, 0.0, away}, sizeof p.control[i]);
            memcpy(q.control[i], (double[3]) {0.1, i / 3.0 - 0.5, 0.0}, sizeof q.control[i]);
        }
        assert_near(ancf_cubic_gap(n, &p, 2, 4, &q, 1, 3), away, 1e-15);
    }
}

// ---------------------------------------------------------------- cables that wander

typedef struct {
    built b;
    ancf_cover cover[ALL];
    double target[3 * (CABLES * (ELEMENTS + 1) + 2 * ALL)]; // velocities they take up
} scene;

// Cables side by side, nearer than they are thick here and there, with elements of several kinds.
static void scene_start(scene* s, uint64_t* seed, double shake) {
    const ancf_element all = {.length = length, .ea = 1.0, .rho_a = 1e-3};
    s->b = build_start(CABLES * (ELEMENTS + 1), ALL, all);
    built* b = &s->b;
    for (int r = 0; r < CABLES; ++r)
        for (int i = 0; i <= ELEMENTS; ++i) {
            const int node = r * (ELEMENTS + 1) + i;
            b->x[(r % 2) * b->stride + node] = length * (i - 0.5 * ELEMENTS);
            b->x[(1 - r % 2) * b->stride + node] = 0.02 * (r - 1);
            b->x[2 * b->stride + node] = 3e-3 * r;
            if (i == ELEMENTS) continue;
            const int e = r * ELEMENTS + i;
            b->ends[2 * e] = node;
            b->ends[2 * e + 1] = node + 1;
            if (r == 1) b->element[e].kind = ANCF_SPRING;
            else if (i + 1 < ELEMENTS) b->next[e] = e + 1;
            s->cover[e] = (ancf_cover) {.radius = r == 2 ? 1.5 * radius : radius,
                                        .segments = 1 + (r + i) % 5,
                                        .mask = 1,
                                        .structure = r,
                                        .own = true,
                                        .run = r,
                                        .arc = i * length};
        }
    build_slopes(b);
    if (shake > 0.0) build_shake(b, b->x, shake, seed);
    build_finish(b);
}

// A new aim now and then, towards which velocities go smoothly; the whole drifts.
static void wander(scene* s, int k, uint64_t* seed) {
    ancf_model* m = s->b.m;
    for (int c = 0; c < 3; ++c)
        for (int i = 0; i < m->n_dof; ++i) {
            double *v = &m->v[c * m->stride + i], *aim = &s->target[c * m->n_dof + i];
            const double drift = i < m->n_nodes ? 3.0 : 0.0;
            if (k % 40 == 0) *aim = drift + random_between(seed, -1.0, 1.0) * (i < m->n_nodes ? 0.5 : 10.0);
            *v += 0.05 * (*aim - *v);
            m->x[c * m->stride + i] += step * *v;
        }
    for (int c = 0; c < 3; ++c) // back to the middle, so that they stay near each other
        for (int i = 0; i < m->n_nodes; ++i) {
            double mean = 0.0;
            const int first = i / (ELEMENTS + 1) * (ELEMENTS + 1);
            for (int j = 0; j <= ELEMENTS; ++j) mean += m->x[c * m->stride + first + j] / (ELEMENTS + 1);
            s->target[c * m->n_dof + i] -= 0.5 * (mean - 3.0 * k * step);
        }
}

static void finder_set(finder* f, const scene* s) {
    const double ahead = 2.5 * step * ancf_boxes_fastest(s->b.m) + 0.05 * radius;
    ancf_boxes_plan(f->boxes, s->b.m, step, 100, ahead);
    assert_true(ancf_boxes_set(f->boxes, s->b.m) >= 0);
    assert_true(ancf_apart_set(f->apart, f->boxes, s->b.m) >= 0);
}

static int finder_find(finder* f, const scene* s) {
    static const ancf_laws laws = {.normal = {ANCF_NORMAL_HERTZ, 1e5, 1.5, 0.0}};
    ancf_table_clear(f->table);
    ancf_motion_follow(f->motion, s->b.m, step);
    return ancf_cross_add(f->table, f->apart, s->cover, s->b.m, &laws, 1, step, NULL, 0);
}

static void same_contacts(const finder* f, const finder* g, int n) {
    for (int i = 0; i < n; ++i) {
        const ancf_contact *c = ancf_table_contact(f->table, i), *d = ancf_table_contact(g->table, i);
        assert_memory_equal(c->key, d->key, sizeof c->key);
        assert_memory_equal(&c->gap, &d->gap, sizeof c->gap);
        assert_memory_equal(c->normal, d->normal, sizeof c->normal);
        for (int k = 0; k < 2; ++k) {
            const double xi = ancf_table_place(f->table, c->side[k].place)->xi;
            assert_memory_equal(&xi, &ancf_table_place(g->table, d->side[k].place)->xi, sizeof xi);
        }
    }
}

// What touches in the middle of the step, of all pairs, is in the table.
static int all_that_touch(const finder* f, const scene* s, int n) {
    int touching = 0;
    for (int e = 0; e < ALL; ++e)
        for (int g = e + 1; g < ALL; ++g) {
            const int *p = &s->b.ends[2 * e], *q = &s->b.ends[2 * g];
            if (p[0] == q[1] || p[1] == q[0]) continue;
            ancf_cubic first, second;
            ancf_nearest_pair found[8];
            ancf_cover_ahead(&first, s->b.m, e, 0.5 * step);
            ancf_cover_ahead(&second, s->b.m, g, 0.5 * step);
            const int places = ancf_nearest_cubic(found, &first, s->cover[e].segments, s->cover[e].radius, &second,
                                                  s->cover[g].radius, 0.0);
            for (int k = 0; k < places; ++k) {
                if (ancf_cross_neighbours(&s->cover[e], found[k].xi[0], length, &s->cover[g], found[k].xi[1], length))
                    continue;
                int i = 0;
                for (; i < n; ++i) {
                    const int* key = ancf_table_contact(f->table, i)->key;
                    if (key[0] == e && key[1] == g && key[2] == found[k].segment) break;
                }
                assert_true(i < n);
                ++touching;
            }
        }
    return touching;
}

// One that remembers, one that starts anew in every step, and one that sets its boxes in every step but remembers.
static void resting_changes_no_contact(void** state) {
    (void)state;
    int contacts = 0, touching = 0, set = 0;
    for (uint64_t seed = 10; seed < 16; ++seed) {
        static scene s;
        uint64_t random = seed;
        memset(&s, 0, sizeof s);
        scene_start(&s, &random, 0.1);
        finder lazy, eager;
        assert_true(finder_start(&lazy, s.b.m, s.cover));
        assert_true(finder_start(&eager, s.b.m, s.cover));
        for (int k = 0; k < STEPS; ++k) {
            wander(&s, k, &random);
            if (k == STEPS / 2) // put elsewhere at once, all turned about
                for (int i = 0; i < s.b.m->n_dof; ++i) s.b.m->x[i] = -s.b.m->x[i];
            if (k == 0 || !ancf_boxes_hold(lazy.boxes, s.b.m)) {
                finder_set(&lazy, &s);
                ++set;
            }
            finder_set(&eager, &s);
            finder fresh;
            assert_true(finder_start(&fresh, s.b.m, s.cover));
            finder_set(&fresh, &s);
            const int n = finder_find(&fresh, &s);
            assert_int_equal(finder_find(&lazy, &s), n);
            assert_int_equal(finder_find(&eager, &s), n);
            same_contacts(&fresh, &lazy, n);
            same_contacts(&fresh, &eager, n);
            touching += all_that_touch(&fresh, &s, n);
            contacts += n;
            finder_end(&fresh);
        }
        finder_end(&lazy);
        finder_end(&eager);
        build_free(&s.b);
    }
    assert_true(touching > 1000);
    assert_true(contacts > touching);
    assert_true(set < 6 * STEPS / 5); // boxes hold, or nothing has been shown
}

// Straight cables across each other with room between them: their boxes overlap, and none is ever looked at closely.
static void what_is_apart_rests(void** state) {
    (void)state;
    static scene s;
    uint64_t seed = 3;
    memset(&s, 0, sizeof s);
    scene_start(&s, &seed, 0.0);
    for (int e = 0; e < ALL; ++e) s.cover[e].radius = 1e-3;
    for (int i = 0; i < s.b.m->n_dof; ++i) { // aslant, so that boxes are wide
        double *x = &s.b.m->x[i], *z = &s.b.m->x[2 * s.b.stride + i];
        const double along = *x, up = *z;
        *x = sqrt(0.5) * (along - up);
        *z = sqrt(0.5) * (along + up);
    }
    finder f;
    assert_true(finder_start(&f, s.b.m, s.cover));
    finder_set(&f, &s);
    int n, asked = 0;
    ancf_boxes_meetings(f.boxes, &n);
    assert_true(n > 0);
    for (int k = 0; k < 100; ++k) {
        for (int i = 0; i < s.b.m->n_nodes; ++i) s.b.m->x[i] += 0.1 * length;
        ancf_motion_follow(f.motion, s.b.m, step);
        for (ancf_near near = {0}; ancf_apart_next(&near, f.apart, s.b.m);) ++asked;
    }
    assert_int_equal(asked, 0);
    // One that comes down on the next is looked at, and where it touches.
    for (int i = 0; i <= ELEMENTS; ++i) {
        s.b.m->x[i] -= sqrt(0.5) * 1.5e-3;
        s.b.m->x[2 * s.b.stride + i] += sqrt(0.5) * 1.5e-3;
    }
    ancf_motion_follow(f.motion, s.b.m, step);
    for (ancf_near near = {0}; ancf_apart_next(&near, f.apart, s.b.m); ++asked) {
        assert_true(near.first < ELEMENTS && near.second / ELEMENTS == 1);
        assert_true(near.segments > 0 && near.segments >> s.cover[near.first].segments == 0);
    }
    assert_true(asked > 0);
    finder_end(&f);
    build_free(&s.b);
}

// All pairs of boxes that overlap and may touch, in order.
static void meetings_are_all_pairs_in_order(void** state) {
    (void)state;
    int all = 0;
    for (uint64_t seed = 20; seed < 40; ++seed) {
        static scene s;
        uint64_t random = seed;
        memset(&s, 0, sizeof s);
        scene_start(&s, &random, 0.1);
        finder f;
        assert_true(finder_start(&f, s.b.m, s.cover));
        for (int k = 0; k < 5; ++k) {
            build_shake(&s.b, s.b.m->x, 0.5, &random);
            finder_set(&f, &s);
            int n, i = 0;
            const ancf_meeting* pair = ancf_boxes_meetings(f.boxes, &n);
            for (int e = 0; e < ALL; ++e)
                for (int g = e + 1; g < ALL; ++g) {
                    const int *p = &s.b.ends[2 * e], *q = &s.b.ends[2 * g];
                    ancf_box one, two;
                    ancf_boxes_of(&one, f.boxes, s.b.m, e);
                    ancf_boxes_of(&two, f.boxes, s.b.m, g);
                    bool meet = p[0] != q[1] && p[1] != q[0];
                    for (int c = 0; c < 3; ++c) meet = meet && one.low[c] <= two.high[c] && two.low[c] <= one.high[c];
                    if (!meet) continue;
                    assert_true(i < n && pair[i].first == e && pair[i].second == g);
                    ++i;
                }
            assert_int_equal(i, n);
            all += n;
        }
        finder_end(&f);
        build_free(&s.b);
    }
    assert_true(all > 1000);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_distance_is_smaller_than_a_gap), cmocka_unit_test(gaps_of_straight_ones_are_distances),
        cmocka_unit_test(resting_changes_no_contact),        cmocka_unit_test(what_is_apart_rests),
        cmocka_unit_test(meetings_are_all_pairs_in_order),
    };
    return cmocka_run_group_tests_name("apart", tests, NULL, NULL);
}
