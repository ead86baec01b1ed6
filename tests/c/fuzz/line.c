// Lines through rings: whatever happens to them, length is kept but for what drums take, and brakes hold no more than
// they can.
#include "ancf/line.h"
#include "fuzz.h"

enum { SPANS_MOST = 24, STEPS = 40, OTHER_WINCH = 10 };

static ancf_winch any_winch(fuzz* f, double ea) {
    ancf_winch w = {0.0, 0.0, INFINITY, 0.0, INFINITY};
    if (by_chance(f, 0.5)) w.brake = ea * magnitude(f, 1e-6, 1.0);
    if (by_chance(f, 0.7)) w.force = fmin(w.brake, ea * magnitude(f, 1e-6, 1.0));
    if (by_chance(f, 0.7)) w.speed = between(f, -2.0, 2.0);
    if (by_chance(f, 0.5)) w.least = magnitude(f, 1e-3, 10.0);
    if (by_chance(f, 0.5)) w.most = magnitude(f, 1.0, 100.0);
    return w;
}

static void fill(ancf_line* l, fuzz* f, double (*x)[3]) {
    const double strain = between(f, -0.3, 0.1);
    for (int i = 0; i <= l->spans; ++i) {
        vector_between(x[i], f, 1.0);
        if (i > 0 && by_chance(f, 0.1))
            for (int c = 0; c < 3; ++c) x[i][c] = x[i - 1][c];
        const bool ring = i > 0 && i < l->spans;
        if (ring && by_chance(f, 0.7)) l->friction[i] = magnitude(f, 1e-3, 2.0);
        l->slides[i] = ring ? pick(f, 3) - 1 : pick(f, 4);
    }
    ancf_line_lay(l, (const double(*)[3])x);
    for (int i = 0; i < l->spans; ++i) {
        l->length[i] = l->way[i] / (1.0 + (by_chance(f, 0.1) ? between(f, -0.5, 0.5) : strain));
        l->tension[i] = fmax(0.0, l->ea * (l->way[i] / l->length[i] - 1.0));
    }
}

// A step, and what has to hold after it, hostile values apart.
static void step(ancf_line* l, fuzz* f, const double (*x)[3], double dt) {
    const double before = ancf_line_length(l);
    const long unsettled = l->unsettled;
    ancf_line_step(l, x, dt);
    if (f->chance > 0.0) return;
    need(all_finite(l->length, l->spans) && all_finite(l->tension, l->spans) && all_finite(l->flow, l->spans + 1));
    need(isfinite(l->rubbed) && isfinite(l->drawn) && ancf_line_energy(l) >= 0.0);
    double ways = 0.0;
    for (int i = 0; i < l->spans; ++i) {
        need(l->length[i] > 0.0 && l->tension[i] >= 0.0);
        ways += l->way[i];
    }
    need(fabs(ancf_line_length(l) - before - l->flow[0] + l->flow[l->spans]) <= 1e-9 * (before + ways));
    if (l->unsettled > unsettled) return;
    for (int end = 0; end < 2; ++end) need(l->tension[end ? l->spans - 1 : 0] <= l->winch[end].brake * (1.0 + 1e-9));
}

void fuzz_line(fuzz* f) {
    double x[SPANS_MOST + 1][3], inverse[SPANS_MOST + 1];
    ancf_line* l;
    if (by_chance(f, 0.1)) fuzz_fail_allocation(1 + pick(f, 4));
    const ancf_error error =
        ancf_line_create(&l, pick(f, SPANS_MOST + 1), magnitude(f, 1e1, 1e7), magnitude(f, 1e-4, 0.1));
    fuzz_fail_allocation(0);
    if (error) {
        need(l == NULL && (error == ANCF_E_MEMORY || error == ANCF_E_EMPTY));
        return;
    }
    fill(l, f, x);
    const double dt = magnitude(f, 1e-6, 1e-2);
    for (int k = 0; k < STEPS; ++k) {
        for (int end = 0; k % OTHER_WINCH == 0 && end < 2; ++end) l->winch[end] = any_winch(f, l->ea);
        for (int i = 0; i <= l->spans; ++i)
            for (int c = 0; c < 3; ++c) x[i][c] += between(f, -0.01, 0.01);
        step(l, f, (const double(*)[3])x, dt);
        for (int i = 0; i <= l->spans; ++i) inverse[i] = by_chance(f, 0.2) ? 0.0 : magnitude(f, 1e-2, 1e2);
        const double rate2 = ancf_line_frequency2(l, inverse, by_chance(f, 0.5) ? 0.0 : 0.25);
        need(f->chance > 0.0 || (isfinite(rate2) && rate2 >= 0.0));
    }
    ancf_line_destroy(l);
}
