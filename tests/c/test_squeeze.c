// Normal forces that press on one another: what a contact answers, and many at one place.
#include "touch.h"

#include "answer.h"
#include "newton.h"

static ancf_normal random_law(uint64_t* seed) {
    ancf_normal law = {ANCF_NORMAL_LINEAR, random_magnitude(seed, 1e4, 1e8), 1.5, random_magnitude(seed, 1e-2, 1e1)};
    const double which = random_unit(seed);
    if (which < 0.3) law.kind = ANCF_NORMAL_HERTZ;
    if (which > 0.6) law.kind = ANCF_NORMAL_NONLINEAR;
    if (law.kind == ANCF_NORMAL_NONLINEAR) law.damping = random_between(seed, 0.0, 0.5);
    return law;
}

// Its work over the sub-step is what elastic energy is lost, whatever the way; its slope is that of its values, but
// where a dashpot begins or ends within the sub-step, and where damping ends it.
static void an_answer_is_energy_over_way(void** state) {
    (void)state;
    uint64_t seed = 71;
    int sloped = 0;
    for (int run = 0; run < 20000; ++run) {
        ancf_contact c = {.law = random_law(&seed), .gap = random_between(&seed, -1.0, 0.3) * 1e-4, .own = 50.0};
        const double h = random_magnitude(&seed, 1e-7, 1e-5), v = random_between(&seed, -10.0, 10.0);
        c.energy = ancf_normal_energy(&c.law, -c.gap);
        double elastic, slope, at[2], unused[2];
        const double force = ancf_answer_at(&c, v, h, &elastic, &slope), end = c.gap + h * v;
        assert_true(force >= 0.0 && elastic >= 0.0 && slope <= 0.0);
        if (force > 0.0)
            assert_near(-elastic * h * v, ancf_normal_energy(&c.law, -end) - c.energy,
                        1e-12 * (c.energy + elastic * h));
        if (v > 0.0) assert_true(force <= elastic * (1.0 + 1e-15));
        const double d = 1e-5 * fabs(v);
        for (int k = 0; k < 2; ++k) at[k] = ancf_answer_at(&c, v + (k ? d : -d), h, &unused[0], &unused[1]);
        const bool whole = c.gap < 0.0 && c.gap + h * (v + d) < 0.0;
        if (!whole || !(at[0] > 0.0 && at[1] > 0.0) || fabs(h * v) < 1e-3 * fabs(c.gap)) continue;
        assert_near(slope, (at[1] - at[0]) / (2.0 * d), 1e-5 * fabs(slope) + 1e-9 * force / fabs(v));
        ++sloped;
    }
    assert_true(sloped > 4000);
}

typedef struct {
    double impulse, after, damped, left;
    int substeps;
} met;

// A place on a free cable that a body meets, with `n` contacts there that share a stiffness unevenly, in so many
// sub-steps, 0: as they ask for.
static met meet(const ancf_normal* law, int n, double speed, double gap, double inv_mass, int substeps) {
    const ancf_element all = {.length = 0.6, .ea = 1.0, .rho_a = 0.02};
    built b = build_cable(3, all, 1);
    build_finish(&b);
    ancf_table* t;
    assert_int_equal(ancf_table_create(&t, b.m), ANCF_OK);
    ancf_table_clear(t);
    ancf_table_add_place(t, b.m, 1, 0.37);
    ancf_body body = {.velocity = {0.0, 0.0, speed}, .inv_mass = {inv_mass, inv_mass, inv_mass}};
    ancf_table_add_body(t, &body);
    double share = 0.0;
    for (int i = 0; i < n; ++i) share += 1.0 + i % 3;
    for (int i = 0; i < n; ++i) {
        ancf_contact c = {.side = {{0, -1, {0}}, {-1, 0, {0}}}, .normal = {0.0, 0.0, 1.0}, .gap = gap, .law = *law};
        c.law.stiffness *= (1.0 + i % 3) / share;
        if (law->kind == ANCF_NORMAL_LINEAR) c.law.damping *= (1.0 + i % 3) / share;
        ancf_table_add_contact(t, &c);
    }
    assert_int_equal(ancf_table_prepare(t, b.m, b.v), ANCF_OK);
    int stiffest;
    const int needed = ancf_table_substeps(t, 1e-4, &stiffest);
    met result = {.substeps = substeps > 0 ? substeps : needed};
    result.left = ancf_table_press(t, 1e-4, result.substeps);
    double v[3];
    for (int i = 0; i < n; ++i) {
        result.impulse += ancf_table_contact(t, i)->impulse;
        result.damped += ancf_table_contact(t, i)->damped;
    }
    ancf_table_slip(v, t, ancf_table_contact(t, 0));
    result.after = v[2];
    ancf_table_destroy(t);
    build_free(&b);
    return result;
}

// Relative differences between many contacts at a place and one.
static met same(const ancf_normal* law, int n, double speed, double gap, double inv_mass, int substeps) {
    const met many = meet(law, n, speed, gap, inv_mass, substeps),
              one = meet(law, 1, speed, gap, inv_mass, many.substeps);
    const double scale = speed + fabs(one.after);
    return (met) {fabs(many.impulse / one.impulse - 1.0), fabs(many.after - one.after) / scale,
                  fabs(many.damped - one.damped) / (scale * one.impulse), many.left, many.substeps};
}

// Contacts at one and the same place are one whose stiffness is theirs together.
static void contacts_at_one_place_are_one(void** state) {
    (void)state;
    uint64_t seed = 72;
    double worst = 0.0;
    for (int run = 0; run < 600; ++run) {
        const ancf_normal law = random_law(&seed);
        const double speed = random_magnitude(&seed, 0.01, 5.0), gap = random_between(&seed, -1e-4, 0.0),
                     inv_mass = random_magnitude(&seed, 0.1, 1e4);
        const met off = same(&law, 2 + run % 31, speed, gap, inv_mass, 1 + run % 4);
        worst = fmax(worst, off.impulse);
        assert_true(off.impulse < 1e-6 && off.after < 1e-6 && off.damped < 1e-6 && off.left < 1e-6);
    }
    printf("off by %.1e of the impulse at most\n", worst);
}

// So are more than are solved at once, in the sub-steps that they ask for. In fewer, too, or what is left is told.
static void many_at_one_place_are_one_or_told(void** state) {
    (void)state;
    uint64_t seed = 73;
    int told = 0;
    double worst = 0.0;
    for (int run = 0; run < 300; ++run) {
        const ancf_normal law = random_law(&seed);
        const double speed = random_magnitude(&seed, 0.01, 5.0), gap = random_between(&seed, -1e-4, 0.0),
                     inv_mass = random_magnitude(&seed, 0.1, 1e4);
        const int n = ANCF_NEWTON_MOST + 1 + run % 97;
        const met asked = same(&law, n, speed, gap, inv_mass, 0), once = same(&law, n, speed, gap, inv_mass, 1);
        worst = fmax(worst, asked.impulse);
        assert_true(asked.left < 1e-6 && asked.impulse < 1e-6 && asked.after < 1e-6 && asked.damped < 1e-6);
        if (once.left < 1e-6) assert_true(once.impulse < 1e-6);
        else ++told;
    }
    printf("off by %.1e at most; %d of 300 not solved in one sub-step\n", worst, told);
    assert_true(told > 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_answer_is_energy_over_way),
        cmocka_unit_test(contacts_at_one_place_are_one),
        cmocka_unit_test(many_at_one_place_are_one_or_told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
