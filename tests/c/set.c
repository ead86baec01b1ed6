// The step built for one instruction set alone: test_sets loads one such module for each.
#include "build.h"

static const int kinds[] = {ANCF_LUMPED, ANCF_LUMPED | ANCF_CURVATURE_EXACT, 0, ANCF_SPRING,
                            ANCF_LUMPED | ANCF_ENGINEERING};

static built start(int k) {
    uint64_t seed = 71 + (uint64_t)k;
    const int kind = kinds[k / 2];
    ancf_element all = net_element(kind, 5e-5);
    if (kind & ANCF_SPRING) all.ei = 0.0;
    if (k % 2) all.length *= 250;
    built b = k % 2 ? build_cable(250, all, !(kind & ANCF_SPRING)) : build_net(6, all);
    build_shake(&b, b.x, 0.05, &seed);
    build_shake(&b, b.v, 0.3, &seed);
    b.hold[0] = ANCF_HELD;
    build_finish(&b);
    b.m->gravity[2] = -9.81;
    return b;
}

// States after some steps of a net and of a smooth cable, into `state`; returns their number. NULL: only that. -1: they
// are others where energies are wanted.
int run_set(double* state) {
    int n = 0, same = 1;
    for (int k = 0; k < 10; ++k) {
        built b = start(k), booked = start(k);
        ancf_time time = {0}, again = {0};
        booked.m->track = true;
        if (state) {
            run_leapfrog(b.m, 2e-6, 50, &time);
            run_leapfrog(booked.m, 2e-6, 50, &again);
            same &= memcmp(b.x, booked.x, 3 * (size_t)b.stride * sizeof *b.x) == 0;
        }
        for (int c = 0; c < 3; ++c)
            for (int i = 0; i < b.n_dof; ++i, ++n)
                if (state) state[n] = b.x[c * b.stride + i];
        build_free(&b);
        build_free(&booked);
    }
    return same ? n : -1;
}
