// A line through rings: Eytelwein, Atwood, a purse drawn shut, winches, and what must hold in any motion.
#include "check.h"

#include "ancf/line.h"

#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

enum { MOST = 32 };

// Point masses on a line, moved by leapfrog. Those without mass are held.
typedef struct {
    ancf_line* line;
    double x[MOST][3], v[MOST][3], mass[MOST], gravity;
    int same; // place that the last one is, or -1
} scene;

static void forces(double f[MOST][3], const scene* s) {
    const ancf_line* l = s->line;
    memset(f, 0, MOST * sizeof *f);
    for (int i = 0; i < l->spans; ++i)
        for (int c = 0; c < 3; ++c) {
            f[i][c] += l->tension[i] * l->along[i][c];
            f[i + 1][c] -= l->tension[i] * l->along[i][c];
        }
    if (s->same >= 0)
        for (int c = 0; c < 3; ++c) f[s->same][c] += f[l->spans][c];
    for (int i = 0; i <= l->spans; ++i) f[i][2] -= s->mass[i] * s->gravity;
}

static void kick(scene* s, double time) {
    double f[MOST][3];
    forces(f, s);
    for (int i = 0; i <= s->line->spans; ++i)
        for (int c = 0; c < 3; ++c)
            if (s->mass[i] > 0.0) s->v[i][c] += time * f[i][c] / s->mass[i];
}

// Positions and velocities at the same time, before and after.
static void move(scene* s, double dt) {
    kick(s, dt / 2);
    for (int i = 0; i <= s->line->spans; ++i)
        for (int c = 0; c < 3; ++c) s->x[i][c] += dt * s->v[i][c];
    if (s->same >= 0) memcpy(s->x[s->line->spans], s->x[s->same], sizeof s->x[0]);
    ancf_line_step(s->line, (const double(*)[3])s->x, dt);
    kick(s, dt / 2);
}

// Kinetic, of gravity, elastic, and what friction has taken, less what winches have given.
static double energy(const scene* s) {
    double sum = ancf_line_energy(s->line) + s->line->rubbed - s->line->drawn;
    for (int i = 0; i <= s->line->spans; ++i) {
        sum += s->mass[i] * s->gravity * s->x[i][2];
        for (int c = 0; c < 3; ++c) sum += 0.5 * s->mass[i] * s->v[i][c] * s->v[i][c];
    }
    return sum;
}

// At one tension; below 0: slack.
static void lay(scene* s, int spans, double ea, double radius, double tension) {
    assert_int_equal(ancf_line_create(&s->line, spans, ea, radius), ANCF_OK);
    ancf_line_lay(s->line, (const double(*)[3])s->x);
    for (int i = 0; i < spans; ++i) {
        s->line->length[i] = s->line->way[i] / (1.0 + tension / ea);
        s->line->tension[i] = fmax(0.0, tension);
    }
}

static void bad_lines_are_refused(void** state) {
    (void)state;
    ancf_line* line = (ancf_line*)&state;
    assert_int_equal(ancf_line_create(&line, 0, 1.0, 0.0), ANCF_E_EMPTY);
    assert_null(line);
    ancf_line_destroy(NULL);
}

// T_out = T_in exp(mu sum of angles), the first span keeping what it had.
static void capstan(void** state) {
    (void)state;
    scene s = {.same = -1};
    const int n = 8;
    double angles = 0.0;
    for (int i = 0; i <= n; ++i) { // around a helix
        s.x[i][0] = cos(0.7 * i);
        s.x[i][1] = sin(0.7 * i);
        s.x[i][2] = 0.1 * i;
    }
    lay(&s, n, 1000.0, 0.0, 5.0);
    for (int i = 1; i < n; ++i) {
        s.line->friction[i] = 0.05 + 0.02 * i;
        double a = 0.0;
        for (int c = 0; c < 3; ++c) a += s.line->along[i - 1][c] * s.line->along[i][c];
        if (i < n - 1) angles += s.line->friction[i] * acos(a);
    }
    for (int i = 0; i < 2000; ++i) { // the last place is pulled away along its span
        for (int c = 0; c < 3; ++c) s.x[n][c] += 0.001 * s.line->along[n - 1][c];
        ancf_line_step(s.line, (const double(*)[3])s.x, 1.0);
    }
    double last = 0.0; // the angle at the last ring changes with the pull
    for (int c = 0; c < 3; ++c) last += s.line->along[n - 2][c] * s.line->along[n - 1][c];
    angles += s.line->friction[n - 1] * acos(last);
    assert_close(s.line->tension[n - 1] / s.line->tension[0], exp(angles), 1e-12);
    for (int i = 1; i < n; ++i) assert_int_equal(s.line->slides[i], 1);
    // Half as far back, and friction acts the other way round.
    for (int i = 0; i < 1500; ++i) {
        for (int c = 0; c < 3; ++c) s.x[n][c] -= 0.001 * s.line->along[n - 1][c];
        ancf_line_step(s.line, (const double(*)[3])s.x, 1.0);
    }
    assert_close(s.line->tension[n - 1] / s.line->tension[0], exp(-angles), 1e-12);
    assert_int_equal(s.line->unsettled, 0);
    ancf_line_destroy(s.line);
}

// Two weights over a fixed ring: a = g (m1 - c m2)/(m1 + c m2), c = exp(mu pi).
static double fallen(double friction, double dt, double* drift) {
    scene s = {.same = -1, .gravity = 9.81};
    s.x[0][2] = s.x[2][2] = -3.0;
    s.mass[0] = 3.0;
    s.mass[2] = 1.0;
    const double c = exp(friction * pi), a = 9.81 * (3.0 - c) / (3.0 + c), end = 0.5;
    lay(&s, 2, 1e6, 0.0, 0.0);
    s.line->friction[1] = friction;
    // At the tensions of the motion from the start, so that nothing swings.
    const double tension[2] = {3.0 * (9.81 - a), 9.81 + a};
    for (int i = 0; i < 2; ++i) {
        s.line->length[i] = s.line->way[i] / (1.0 + tension[i] / 1e6);
        s.line->tension[i] = tension[i];
    }
    s.line->slides[1] = -1;
    const double before = energy(&s);
    const int n = (int)(end / dt + 0.5);
    for (int i = 0; i < n; ++i) move(&s, dt);
    *drift = energy(&s) - before;
    assert_close(s.v[0][2], -a * end, 2e-4);
    assert_close(s.v[2][2], a * end, 2e-4);
    if (friction > 0.0) assert_close(s.line->rubbed, (tension[0] - tension[1]) * a * end * end / 2, 1e-3);
    else assert_near(s.line->rubbed, 0.0, 1e-9);
    const double way = -3.0 - s.x[0][2];
    ancf_line_destroy(s.line);
    return way / (a * end * end / 2);
}

static void atwood(void** state) {
    (void)state;
    const double frictions[] = {0.0, 0.1, 0.3};
    for (int k = 0; k < 3; ++k) {
        double coarse, fine;
        assert_near(fallen(frictions[k], 1e-4, &coarse), 1.0, 2e-4);
        assert_near(fallen(frictions[k], 5e-5, &fine), 1.0, 2e-4);
        assert_near(coarse, 0.0, 1e-5 * 9.81 * 3.0);
        assert_near(fine, 0.0, fabs(coarse) / 2 + 1e-10);
    }
}

// Weights that friction holds: 1 < m1/m2 < exp(mu pi).
static void atwood_sticks(void** state) {
    (void)state;
    scene s = {.same = -1, .gravity = 9.81};
    s.x[0][2] = s.x[2][2] = -1.0;
    s.mass[0] = 2.0;
    s.mass[2] = 1.0;
    lay(&s, 2, 1e4, 0.0, 0.0);
    s.line->friction[1] = 0.3; // exp(0.3 pi) = 2.57
    const double tension[2] = {2.0 * 9.81, 9.81};
    for (int i = 0; i < 2; ++i) {
        s.line->length[i] = s.line->way[i] / (1.0 + tension[i] / 1e4);
        s.line->tension[i] = tension[i];
    }
    for (int i = 0; i < 20000; ++i) move(&s, 1e-4);
    assert_near(s.x[0][2], -1.0, 1e-12);
    assert_near(s.x[2][2], -1.0, 1e-12);
    assert_near(s.line->rubbed, 0.0, 0.0);
    ancf_line_destroy(s.line);
}

// A purse of n rings of mass m on a circle, drawn shut by a winch at its force F: R'' = -2 F sin(pi/n)/m.
static void purse(void** state) {
    (void)state;
    enum { N = 12 };
    scene s = {.same = 0};
    for (int i = 0; i <= N; ++i) {
        s.x[i][0] = cos(2.0 * pi * i / N);
        s.x[i][1] = sin(2.0 * pi * i / N);
        s.mass[i] = i < N ? 0.2 : 0.0;
    }
    memcpy(s.x[N], s.x[0], sizeof s.x[0]);
    lay(&s, N, 5e3, 0.0, 20.0);
    s.line->winch[1] = (ancf_winch) {1e3, 20.0, INFINITY, 0.0, INFINITY};
    const double pull = 2.0 * 20.0 * sin(pi / N) / 0.2, dt = 1e-4, end = 0.15, before = energy(&s);
    for (int i = 0; i < 1500; ++i) move(&s, dt);
    const double radius = 1.0 - pull * end * end / 2;
    for (int i = 0; i < N; ++i) {
        assert_close(hypot(s.x[i][0], s.x[i][1]), radius, 1e-12);
        assert_near(s.x[i][1] * cos(2.0 * pi * i / N), s.x[i][0] * sin(2.0 * pi * i / N), 1e-12);
    }
    assert_int_equal(s.line->slides[N], ANCF_STRAINS);
    assert_near(energy(&s), before, 1e-9); // a constant force is integrated exactly
    assert_close(s.line->drawn -
                     (ancf_line_energy(s.line) - 0.5 * 400.0 / 5e3 * 2 * N * sin(pi / N) / (1 + 20.0 / 5e3)),
                 N * 0.2 * pull * end * pull * end / 2, 1e-9);
    ancf_line_destroy(s.line);
}

// What a winch does to a weight on a straight line.
static scene hoist(double mass, double ea) {
    scene s = {.same = -1, .gravity = 9.81};
    s.x[0][2] = 0.0;
    s.x[1][2] = -10.0;
    s.mass[1] = mass;
    lay(&s, 1, ea, 0.0, mass * 9.81);
    return s;
}

static void winches(void** state) {
    (void)state;
    // At constant speed the tension is the weight and the load goes at that speed, stretched material and all.
    scene s = hoist(2.0, 1e6);
    s.line->winch[0] = (ancf_winch) {1.5, 100.0, 200.0, 4.0, INFINITY};
    s.v[1][2] = 1.5 * (1.0 + 2.0 * 9.81 / 1e6);
    for (int i = 0; i < 20000; ++i) move(&s, 1e-4);
    assert_close(s.line->tension[0], 2.0 * 9.81, 1e-3);
    assert_near(s.x[1][2], -10.0 + 2.0 * 1.5, 1e-4);
    assert_close(s.line->drawn, 2.0 * 9.81 * 3.0, 1e-3);
    assert_int_equal(s.line->slides[0], ANCF_DRAWS);
    ancf_line_destroy(s.line);

    // It stops where it is told to.
    s = hoist(2.0, 1e4);
    const double whole = ancf_line_length(s.line);
    s.line->winch[0] = (ancf_winch) {1.0, 1e3, 1e4, 9.0, INFINITY};
    for (int i = 0; i < 15000; ++i) move(&s, 1e-4);
    assert_close(ancf_line_length(s.line), 9.0, 1e-12);
    assert_int_equal(s.line->slides[0], ANCF_HOLDS);
    // And lets out again, up to a length.
    s.line->winch[0] = (ancf_winch) {-0.5, 1e3, 1e4, 0.0, 9.25};
    for (int i = 0; i < 10000; ++i) move(&s, 1e-4);
    assert_close(ancf_line_length(s.line), 9.25, 1e-12);
    assert_near(whole > 9.25, 1, 0);
    ancf_line_destroy(s.line);

    // Let out at a speed below its brake's tension; above, the brake holds back until it falls no faster than that.
    s = hoist(2.0, 1e4);
    s.line->winch[0] = (ancf_winch) {-0.5, 0.0, 30.0, 0.0, INFINITY};
    s.v[1][2] = -3.0;
    const double braked = (3.0 - 0.5) / (30.0 / 2.0 - 9.81); // [s], but for what the line stretches
    double most = 0.0;
    for (int i = 0; i < 20000; ++i) {
        move(&s, 1e-4);
        most = fmax(most, s.line->tension[0]);
        if (i == (int)(0.5 * braked / 1e-4)) assert_close(s.v[1][2], -(3.0 + 0.5) / 2, 0.02);
    }
    assert_close(most, 30.0, 1e-9);
    assert_int_equal(s.line->slides[0], ANCF_DRAWS);
    const double out = 1.0 + (3.0 - 0.5) / 2 * braked; // 2 s at its speed, and what slips
    assert_near(ancf_line_length(s.line), 10.0 / (1.0 + 2.0 * 9.81 / 1e4) + out, 0.02);
    assert_int_equal(s.line->unsettled, 0);
    ancf_line_destroy(s.line);

    // Where its speed changes its sign it lets out, wherever it would stop to draw in.
    s = hoist(2.0, 1e4);
    const double before_it = ancf_line_length(s.line);
    s.line->winch[0] = (ancf_winch) {-0.5, 1e3, 1e4, 1.0, INFINITY};
    for (int i = 0; i < 1000; ++i) move(&s, 1e-4);
    assert_close(ancf_line_length(s.line), before_it + 0.05, 1e-12);
    ancf_line_destroy(s.line);

    // Too heavy a weight: it strains, and moves nothing.
    s = hoist(2.0, 1e4);
    s.line->winch[0] = (ancf_winch) {1.0, 15.0, 1e4, 0.0, INFINITY};
    for (int i = 0; i < 1000; ++i) move(&s, 1e-4);
    assert_near(s.x[1][2], -10.0, 1e-9);
    assert_near(s.line->drawn, 0.0, 0.0);
    ancf_line_destroy(s.line);

    // A brake at half the weight lets it fall at half of gravity, and takes the other half.
    s = hoist(2.0, 1e4);
    s.line->winch[0].brake = s.line->tension[0] = 9.81;
    s.line->length[0] = 10.0 / (1.0 + 9.81 / 1e4);
    const double before = energy(&s);
    for (int i = 0; i < 10000; ++i) move(&s, 1e-4);
    assert_close(s.v[1][2], -9.81 / 2, 1e-9);
    assert_close(s.line->drawn, -9.81 * 9.81 / 4, 1e-3); // but for what it stretches what it lets out
    assert_near(energy(&s), before, 1e-9);
    ancf_line_destroy(s.line);

    // At its force it lifts with F - m g.
    s = hoist(2.0, 1e4);
    s.line->winch[0] = (ancf_winch) {1e3, 25.0, 100.0, 0.0, INFINITY};
    s.line->tension[0] = 25.0;
    s.line->length[0] = 10.0 / (1.0 + 25.0 / 1e4);
    for (int i = 0; i < 10000; ++i) move(&s, 1e-4);
    assert_close(s.v[1][2], 25.0 / 2.0 - 9.81, 1e-9);
    ancf_line_destroy(s.line);
}

// Two winches that pull a line between them, over rings that stand still.
static void tug(void** state) {
    (void)state;
    scene s = {.same = -1};
    for (int i = 0; i < 4; ++i) s.x[i][0] = i;
    for (double speed = 0.1; speed < 1e4; speed *= 10.0) {
        lay(&s, 3, 1e3, 0.0, 0.0);
        ancf_line* l = s.line;
        const double(*x)[3] = (const double(*)[3])s.x;
        // The stronger one draws what the other's brake lets out.
        l->winch[0] = (ancf_winch) {speed, 20.0, INFINITY, 0.0, INFINITY};
        l->winch[1] = (ancf_winch) {speed, 10.0, 15.0, 0.0, INFINITY};
        for (int i = 0; i < 2000; ++i) ancf_line_step(l, x, 1e-3);
        assert_close(l->tension[1], 15.0, 1e-9);
        assert_int_equal(l->slides[0], ANCF_DRAWS);
        assert_int_equal(l->slides[3], ANCF_SLIPS);
        assert_close(l->flow[0], -1e-3 * speed, 1e-12);
        // Held by the other, it strains at its own force.
        l->winch[1].brake = INFINITY;
        for (int i = 0; i < 2000; ++i) ancf_line_step(l, x, 1e-3);
        assert_close(l->tension[1], 20.0, 1e-9);
        assert_int_equal(l->slides[0], ANCF_STRAINS);
        assert_int_equal(l->slides[3], ANCF_HOLDS);
        assert_int_equal(l->unsettled, 0);
        ancf_line_destroy(l);
    }
}

// Anything at random: length is kept but for what drums take, friction takes and never gives, tensions stay within
// Eytelwein's bounds, and the ends within what their winches can.
static void whatever_happens(void** state) {
    (void)state;
    uint64_t seed = 11;
    for (int run = 0; run < 300; ++run) {
        scene s = {.same = -1};
        const int n = 1 + (int)random_between(&seed, 0.0, 20.0);
        for (int i = 0; i <= n; ++i) {
            for (int c = 0; c < 3; ++c) s.x[i][c] = random_between(&seed, 0.0, 1.0);
            s.mass[i] = random_magnitude(&seed, 0.1, 10.0);
            for (int c = 0; c < 3; ++c) s.v[i][c] = random_between(&seed, -0.3, 0.3);
        }
        lay(&s, n, 1e3, 0.02, random_between(&seed, -10.0, 50.0));
        const bool rough = random_unit(&seed) < 0.7;
        for (int i = 1; i < n && rough; ++i)
            s.line->friction[i] = random_unit(&seed) < 0.8 ? random_between(&seed, 0.0, 0.6) : 0.0;
        for (int k = 0; k < 2; ++k) {
            ancf_winch* w = &s.line->winch[k];
            if (random_unit(&seed) < 0.4) w->brake = random_between(&seed, 50.0, 90.0); // not below what it starts with
            if (random_unit(&seed) < 0.4) {
                w->speed = random_between(&seed, -1.0, 1.0);
                w->force = fmin(w->brake, random_between(&seed, 1.0, 50.0));
                w->least = 0.2 * n * 0.02;
            }
        }
        const double first = energy(&s);
        double scale = 1.0, passed = ancf_line_length(s.line), rubbed = 0.0;
        for (int step = 0; step < 3000; ++step) {
            move(&s, 1e-4);
            const ancf_line* l = s.line;
            passed += l->flow[0] - l->flow[n];
            assert_close(ancf_line_length(l), passed, 1e-11);
            assert_true(l->rubbed >= rubbed - 1e-7 * scale);
            rubbed = fmax(rubbed, l->rubbed);
            scale = fmax(scale, fabs(l->drawn) + ancf_line_energy(l) + rubbed);
            for (int i = 1; i < n; ++i) {
                double p = 0.0, q = 0.0, dot = 0.0;
                for (int c = 0; c < 3; ++c) {
                    p += l->along[i - 1][c] * l->along[i - 1][c];
                    q += l->along[i][c] * l->along[i][c];
                    dot += l->along[i - 1][c] * l->along[i][c];
                }
                const double most = exp(l->friction[i] * acos(fmax(-1.0, fmin(1.0, dot / sqrt(p * q)))));
                assert_true(l->tension[i] <= l->tension[i - 1] * most * (1 + 1e-9));
                assert_true(l->tension[i - 1] <= l->tension[i] * most * (1 + 1e-9));
            }
            for (int k = 0; k < 2; ++k) {
                const double tension = l->tension[k ? n - 1 : 0], out = k ? -l->flow[n] : l->flow[0];
                assert_true(tension <= l->winch[k].brake * (1 + 1e-9));
                if (out < 0.0) assert_true(tension <= l->winch[k].force * (1 + 1e-9));
            }
            for (int i = 0; i < n; ++i) {
                const double strain = l->way[i] / l->length[i] - 1.0;
                assert_near(l->tension[i], fmax(0.0, l->ea * strain), 1e-8 * l->ea);
            }
        }
        assert_int_equal(s.line->unsettled, 0);
        double f[MOST][3], pull[3];
        forces(f, &s);
        for (int i = 0; i <= n; ++i) {
            ancf_line_pull(pull, s.line, i);
            for (int c = 0; c < 3; ++c) assert_near(pull[c], f[i][c], 1e-12);
        }
        assert_near(energy(&s), first, 2e-4 * scale);
        ancf_line_destroy(s.line);
    }
}

// The bound against the largest eigenvalue of the stiffness, by finite differences and power iteration.
static double largest(scene* s, int n) {
    double y[MOST][3], f0[MOST][3], f1[MOST][3], x0[MOST][3], value = 0.0;
    uint64_t seed = 3;
    memcpy(x0, s->x, sizeof x0);
    for (int i = 0; i <= n; ++i)
        for (int c = 0; c < 3; ++c) y[i][c] = random_between(&seed, -1.0, 1.0);
    double kept[MOST], tension[MOST];
    memcpy(kept, s->line->length, (size_t)n * sizeof *kept);
    memcpy(tension, s->line->tension, (size_t)n * sizeof *kept);
    for (int round = 0; round < 300; ++round) {
        double norm = 0.0, h = 1e-7;
        for (int i = 0; i <= n; ++i)
            for (int c = 0; c < 3; ++c) norm += y[i][c] * y[i][c];
        norm = sqrt(norm);
        for (int side = 0; side < 2; ++side) {
            for (int i = 0; i <= n; ++i)
                for (int c = 0; c < 3; ++c) s->x[i][c] = x0[i][c] + (side ? h : -h) * y[i][c] / norm;
            memcpy(s->line->length, kept, (size_t)n * sizeof *kept);
            ancf_line_step(s->line, (const double(*)[3])s->x, 1.0);
            forces(side ? f1 : f0, s);
        }
        for (int i = 0; i <= n; ++i)
            for (int c = 0; c < 3; ++c) y[i][c] = s->mass[i] > 0 ? -(f1[i][c] - f0[i][c]) / (2 * h) / s->mass[i] : 0.0;
        value = 0.0;
        for (int i = 0; i <= n; ++i)
            for (int c = 0; c < 3; ++c) value += y[i][c] * y[i][c];
        value = sqrt(value);
    }
    memcpy(s->x, x0, sizeof x0);
    memcpy(s->line->length, kept, (size_t)n * sizeof *kept);
    memcpy(s->line->tension, tension, (size_t)n * sizeof *kept);
    ancf_line_lay(s->line, (const double(*)[3])s->x);
    return value;
}

static void frequencies(void** state) {
    (void)state;
    uint64_t seed = 21;
    for (int run = 0; run < 40; ++run) {
        scene s = {.same = -1};
        const int n = 1 + (int)random_between(&seed, 0.0, 8.0);
        double inverse[MOST];
        for (int i = 0; i <= n; ++i) {
            for (int c = 0; c < 3; ++c) s.x[i][c] = random_between(&seed, 0.0, 1.0);
            s.mass[i] = 1.0; // symmetric, as power iteration likes it
            inverse[i] = 1.0;
        }
        lay(&s, n, 1e3, 0.01, run % 2 ? 10.0 : 2e3); // stretched to thrice its length, it swings across as fast
        for (int rough = 0; rough < 2; ++rough) {
            for (int i = 1; i < n; ++i) s.line->friction[i] = rough ? 5.0 : 0.0;
            const double bound = ancf_line_frequency2(s.line, inverse, 1.0), true_one = largest(&s, n);
            assert_true(bound >= true_one * (1 - 1e-4));
            assert_true(bound <= 6.0 * true_one);
        }
        ancf_line_destroy(s.line);
    }
}

// Of ways that may become a quarter of what they are: that of places four times as near.
static void frequencies_of_nearer_places(void** state) {
    (void)state;
    const double inverse[4] = {1.0, 2.0, 0.5, 3.0};
    for (int rough = 0; rough < 2; ++rough) {
        scene s = {.same = -1, .x = {{0, 0, 0}, {1, 0, 0}, {1, 2, 0}, {0, 2, 1}}};
        lay(&s, 3, 1e3, 0.0, 10.0);
        for (int i = 1; i < 3; ++i) s.line->friction[i] = 0.2 * rough;
        const double before = ancf_line_frequency2(s.line, inverse, 0.25);
        for (int i = 0; i < 4; ++i)
            for (int c = 0; c < 3; ++c) s.x[i][c] *= 0.25;
        ancf_line_lay(s.line, (const double(*)[3])s.x);
        assert_close(before, ancf_line_frequency2(s.line, inverse, 1.0), 1e-12);
        s.line->radius = 1.0; // no way is shorter than that of rings that meet
        ancf_line_lay(s.line, (const double(*)[3])s.x);
        for (int i = 0; i < 3; ++i) s.line->way[i] = 1.0;
        assert_close(ancf_line_frequency2(s.line, inverse, 0.0), ancf_line_frequency2(s.line, inverse, 1.0), 1e-12);
        ancf_line_destroy(s.line);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bad_lines_are_refused),
        cmocka_unit_test(capstan),
        cmocka_unit_test(atwood),
        cmocka_unit_test(atwood_sticks),
        cmocka_unit_test(purse),
        cmocka_unit_test(winches),
        cmocka_unit_test(tug),
        cmocka_unit_test(whatever_happens),
        cmocka_unit_test(frequencies),
        cmocka_unit_test(frequencies_of_nearer_places),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
