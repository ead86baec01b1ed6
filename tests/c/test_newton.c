// Friction of contacts that feel one another: it belongs to the slip that is left, whatever they hang on.
#include "check.h"

#include "newton.h"
#include "rubbing.h"

#include <string.h>

enum { MOST = ANCF_NEWTON_MOST, M = 2 * MOST };

// Contacts between bodies: each slip is that of two bodies' velocities, so that W = J M^-1 J^T.
typedef struct {
    int n;
    double W[M * M], v0[M], P[M], v[M], bound;
    ancf_friction law[MOST];
    ancf_rubbing contact[MOST];
} heap;

static double scratch[ANCF_NEWTON_ROOM];

// The law by its equations: as long as it rises, and as far as `most`.
static double coefficient(const ancf_rubbing* c, double speed) {
    const ancf_friction* f = c->law;
    const double s = speed / f->v0;
    double mu = fmin(s, 1.0) * f->mu_k;
    if (f->kind == ANCF_FRICTION_HOLLARS)
        mu = fmin(s, 1.0) * fmax(f->mu_k + 2.0 * (f->mu_s - f->mu_k) / (1.0 + s * s), 0.0);
    if (s > 1.0 && f->kind == ANCF_FRICTION_HOLLARS && f->mu_s > f->mu_k) mu = f->mu_s;
    return fmin(mu, c->most);
}

static void slips(heap* h) {
    for (int i = 0; i < 2 * h->n; ++i) {
        h->v[i] = h->v0[i];
        for (int k = 0; k < 2 * h->n; ++k) h->v[i] += h->W[2 * h->n * i + k] * h->P[k];
    }
}

// Friction that is as large as can be, in any direction.
static void start(heap* h, uint64_t* seed, double part) {
    for (int i = 0; i < h->n; ++i) {
        const double angle = random_between(seed, 0.0, 6.283), size = part * h->contact[i].most * h->contact[i].pressed;
        h->P[2 * i] = size * cos(angle);
        h->P[2 * i + 1] = size * sin(angle);
    }
    slips(h);
}

// `bodies` of masses from 1 to `ratio`, each contact between two of them.
static void make(heap* h, uint64_t* seed, int n, int bodies, double ratio) {
    static double J[M][3 * MOST], weight[3 * MOST];
    const int m = 2 * n, r = 3 * bodies;
    memset(J, 0, sizeof J);
    h->n = n;
    h->bound = 0.0;
    for (int b = 0; b < bodies; ++b) {
        const double inverse = 1.0 / random_magnitude(seed, 1.0, ratio);
        for (int k = 0; k < 3; ++k) weight[3 * b + k] = inverse;
    }
    for (int i = 0; i < n; ++i) {
        const int one = i % bodies, other = (int)random_between(seed, 0.0, bodies);
        for (int a = 0; a < 2; ++a)
            for (int k = 0; k < 3; ++k) {
                J[2 * i + a][3 * one + k] += random_between(seed, -1.0, 1.0);
                J[2 * i + a][3 * other + k] += random_between(seed, -1.0, 1.0);
            }
    }
    for (int i = 0; i < m; ++i)
        for (int j = 0; j < m; ++j) {
            double sum = 0.0;
            for (int k = 0; k < r; ++k) sum += J[i][k] * weight[k] * J[j][k];
            h->W[m * i + j] = sum;
        }
    for (int i = 0; i < n; ++i) {
        ancf_friction* f = &h->law[i];
        ancf_rubbing* c = &h->contact[i];
        f->kind = random_unit(seed) < 0.2 ? ANCF_FRICTION_COULOMB : ANCF_FRICTION_HOLLARS;
        f->mu_k = random_between(seed, 0.0, 0.5);
        f->mu_s = random_between(seed, 0.8, 2.0) * f->mu_k;
        f->v0 = random_magnitude(seed, 1e-4, 1e-1);
        const double highest = f->kind == ANCF_FRICTION_HOLLARS ? fmax(f->mu_s, f->mu_k) : f->mu_k;
        *c = (ancf_rubbing) {f, random_magnitude(seed, 1e-3, 1.0), random_unit(seed) < 0.5 ? highest : f->mu_k};
        h->bound = fmax(h->bound, c->most * c->pressed);
        for (int a = 0; a < 2; ++a)
            h->v0[2 * i + a] = random_between(seed, -1.0, 1.0) * random_magnitude(seed, 1e-4, 1.0);
    }
}

static void check_solved(const heap* h, double within) {
    for (int i = 0; i < h->n; ++i) {
        const double *v = h->v + 2 * i, speed = hypot(v[0], v[1]);
        const double force = h->contact[i].pressed * coefficient(&h->contact[i], speed);
        for (int a = 0; a < 2; ++a) assert_near(h->P[2 * i + a], speed > 0.0 ? -force * v[a] / speed : 0.0, within);
    }
}

// From no friction and from the largest in any direction it ends at the same slips, where friction belongs to them.
static void friction_belongs_to_the_slip(void** state) {
    (void)state;
    static heap h;
    uint64_t seed = 5;
    int most = 0, stuck = 0, slid = 0;
    for (int run = 0; run < 2000; ++run) {
        const int n = 1 + (int)random_between(&seed, 0.0, run % 16 ? 32.0 : MOST),
                  bodies = 1 + (int)random_between(&seed, 0.0, n);
        double first[M], left;
        make(&h, &seed, n, bodies, run % 2 ? 1e4 : 10.0);
        for (int again = 0; again < 2; ++again) {
            start(&h, &seed, again);
            const int steps = ancf_rubbing_solve(h.P, h.v, &left, n, h.contact, h.W, 1e-10 * h.bound, scratch);
            if (steps > most) most = steps;
            assert_true(left <= 1e-10 * h.bound);
            check_solved(&h, 1.01e-10 * h.bound);
            slips(&h); // exact again
            check_solved(&h, 1e-8 * h.bound);
            for (int i = 0; again && i < 2 * n; ++i) assert_near(h.v[i], first[i], 1e-6 * h.law[i / 2].v0 + 1e-8);
            memcpy(first, h.v, sizeof first);
        }
        for (int i = 0; i < n; ++i) {
            const bool slides = hypot(h.v[2 * i], h.v[2 * i + 1]) > h.law[i].v0;
            stuck += !slides;
            slid += slides;
        }
    }
    printf("%d steps at most, %d stick, %d slide\n", most, stuck, slid);
    assert_true(most < MOST && stuck > 1000 && slid > 1000);
}

// What moves in a plane has no friction across it, and each contact feels those of the same body alone: most of W is
// zero.
static void in_a_plane_nothing_acts_across(void** state) {
    (void)state;
    static heap h;
    uint64_t seed = 7;
    for (int run = 0; run < 500; ++run) {
        const int n = 1 + (int)random_between(&seed, 0.0, run % 16 ? 32.0 : MOST);
        double left;
        make(&h, &seed, n, 1 + n / 2, 10.0);
        for (int i = 0; i < 2 * n; ++i)
            for (int j = 0; j < 2 * n; ++j)
                if ((i - j) % 2) h.W[2 * n * i + j] = 0.0;
        for (int i = 0; i < n; ++i) h.v0[2 * i + 1] = 0.0;
        start(&h, &seed, 0.0);
        ancf_rubbing_solve(h.P, h.v, &left, n, h.contact, h.W, 1e-10 * h.bound, scratch);
        assert_true(left <= 1e-10 * h.bound);
        check_solved(&h, 1.01e-10 * h.bound);
        for (int i = 0; i < n; ++i) assert_true(h.P[2 * i + 1] == 0.0 && h.v[2 * i + 1] == 0.0);
        slips(&h);
        check_solved(&h, 1e-8 * h.bound);
    }
}

// Contacts at one and the same place are one that is pressed by all: sweeps contact by contact would take ages.
static void contacts_at_one_place_are_one(void** state) {
    (void)state;
    uint64_t seed = 6;
    for (int run = 0; run < 500; ++run) {
        const int n = 2 + run % 5;
        const double w = random_magnitude(&seed, 1.0, 1e4), angle = random_between(&seed, 0.0, 6.283);
        const ancf_friction law = {ANCF_FRICTION_HOLLARS, 0.3, 0.2, 1e-3};
        double W[M * M] = {0}, P[M] = {0}, v[M], left, all = 0.0, sum[2] = {0.0, 0.0};
        ancf_rubbing contact[MOST];
        const double speed = random_magnitude(&seed, 1e-5, 1.0);
        for (int i = 0; i < n; ++i) {
            contact[i] = (ancf_rubbing) {&law, random_magnitude(&seed, 1e-6, 1e-3), law.mu_s};
            all += contact[i].pressed;
            v[2 * i] = speed * cos(angle);
            v[2 * i + 1] = speed * sin(angle);
            for (int j = 0; j < n; ++j)
                for (int a = 0; a < 2; ++a) W[2 * n * (2 * i + a) + 2 * j + a] = w;
        }
        ancf_rubbing_solve(P, v, &left, n, contact, W, 1e-14 * all, scratch);
        const double stick = ancf_friction_solve(&law, speed, w * all, 0.0),
                     expected = stick < law.v0 ? stick : speed - w * all * law.mu_s;
        for (int i = 0; i < n; ++i) {
            sum[0] += P[2 * i];
            sum[1] += P[2 * i + 1];
            assert_near(hypot(v[2 * i], v[2 * i + 1]), expected, 1e-8 * expected + 1e-13 * speed);
        }
        assert_near(hypot(sum[0], sum[1]), (speed - expected) / w, 1e-8 * all);
    }
}

// What is right is left alone, and what cannot move takes all friction there is.
static void what_is_right_stays(void** state) {
    (void)state;
    const ancf_friction law = {ANCF_FRICTION_COULOMB, 0.0, 0.4, 1e-2};
    const ancf_rubbing contact[2] = {{&law, 2.0, 0.4}, {&law, 3.0, 0.4}};
    double W[16] = {0}, P[4] = {0}, v[4] = {0.3, -0.4, 3e-3, 0.0}, left;
    assert_int_equal(ancf_rubbing_solve(P, v, &left, 2, contact, W, 1e-12, scratch), 1);
    assert_near(P[0], -0.48, 1e-15);
    assert_near(P[1], 0.64, 1e-15);
    assert_near(P[2], -0.36, 1e-15);
    assert_near(P[3], 0.0, 1e-15);
    assert_int_equal(ancf_rubbing_solve(P, v, &left, 2, contact, W, 1e-12, scratch), 0);
}

// A slip that is not a number leaves no number, wherever it stands: it is not taken for a small one.
static void not_a_number_is_left(void** state) {
    (void)state;
    static heap h;
    uint64_t seed = 9;
    for (int run = 0; run < 60; ++run) {
        double left = 0.0;
        make(&h, &seed, 3, 2, 10.0);
        start(&h, &seed, 0.5);
        h.v[run % 6] = h.v0[run % 6] = NAN;
        ancf_rubbing_solve(h.P, h.v, &left, h.n, h.contact, h.W, 1e-10 * h.bound, scratch);
        assert_false(left <= 1e-3 * h.bound);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(not_a_number_is_left),
        cmocka_unit_test(friction_belongs_to_the_slip),
        cmocka_unit_test(in_a_plane_nothing_acts_across),
        cmocka_unit_test(contacts_at_one_place_are_one),
        cmocka_unit_test(what_is_right_stays),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
