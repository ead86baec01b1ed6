// A step of the study's net (84 elements) against the force code of the textbook, in the same run; then what an element
// of a long cable costs, on one thread and on two.
//     bench_net [file.csv | --check]
// Writes one line a case, with the machine's name; fails if a step misses what it is to be faster by. With --check it
// measures nothing: only that both have the same force.
#define _POSIX_C_SOURCE 200809L
#include "build.h"

#include <omp.h>
#include <time.h>
#include <unistd.h>

enum { REPEATS = 41, STEPS = 400, LONG = 100000, THREADED = 20000 };

static double read_clock(clockid_t clock) {
    struct timespec t;
    clock_gettime(clock, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static double now(void) { return read_clock(CLOCK_PROCESS_CPUTIME_ID); }

static const double gauss3_xi[3] = {0.1127016653792583, 0.5, 0.8872983346207417};
static const double gauss3_weight[3] = {5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0};

static void cross(double c[3], const double a[3], const double b[3]) {
    c[0] = a[1] * b[2] - a[2] * b[1];
    c[1] = a[2] * b[0] - a[0] * b[2];
    c[2] = a[0] * b[1] - a[1] * b[0];
}

// Generalised force on the 12 coordinates of one element as the textbooks have it: Gauss points in turn, 5 for the
// axial term and 3 for the curvature (Gerstmayr, Shabana 2006): dkappa/de from kappa = |r' x r''|/|r'|^2.
static void textbook_force(double Q[12], const double e[12], double L, double ea, double ei) {
    for (int i = 0; i < 12; ++i) Q[i] = 0.0;
    for (int p = 0; p < 5; ++p) {
        double S[4], r[3] = {0.0, 0.0, 0.0};
        const double z = gauss5_xi[p];
        S[0] = (6.0 * z * z - 6.0 * z) / L;
        S[1] = 1.0 - 4.0 * z + 3.0 * z * z;
        S[2] = (6.0 * z - 6.0 * z * z) / L;
        S[3] = 3.0 * z * z - 2.0 * z;
        for (int i = 0; i < 4; ++i)
            for (int c = 0; c < 3; ++c) r[c] += S[i] * e[3 * i + c];
        const double eps = 0.5 * (r[0] * r[0] + r[1] * r[1] + r[2] * r[2] - 1.0);
        for (int i = 0; i < 4; ++i)
            for (int c = 0; c < 3; ++c) Q[3 * i + c] -= gauss5_weight[p] * L * ea * eps * S[i] * r[c];
    }
    for (int p = 0; p < 3; ++p) {
        double S[4], T[4], r[3] = {0.0, 0.0, 0.0}, k[3] = {0.0, 0.0, 0.0}, f[3];
        const double z = gauss3_xi[p];
        S[0] = (6.0 * z * z - 6.0 * z) / L;
        S[1] = 1.0 - 4.0 * z + 3.0 * z * z;
        S[2] = (6.0 * z - 6.0 * z * z) / L;
        S[3] = 3.0 * z * z - 2.0 * z;
        T[0] = (12.0 * z - 6.0) / (L * L);
        T[1] = (6.0 * z - 4.0) / L;
        T[2] = (6.0 - 12.0 * z) / (L * L);
        T[3] = (6.0 * z - 2.0) / L;
        for (int i = 0; i < 4; ++i)
            for (int c = 0; c < 3; ++c) {
                r[c] += S[i] * e[3 * i + c];
                k[c] += T[i] * e[3 * i + c];
            }
        cross(f, r, k);
        const double g = r[0] * r[0] + r[1] * r[1] + r[2] * r[2];
        const double length = sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]), kappa = length / g;
        if (length == 0.0) continue;
        double kf[3], fr[3];
        cross(kf, k, f);
        cross(fr, f, r);
        for (int i = 0; i < 4; ++i)
            for (int c = 0; c < 3; ++c) {
                const double df = S[i] * kf[c] + T[i] * fr[c];
                const double dkappa = (df / length - 2.0 * kappa * S[i] * r[c]) / g;
                Q[3 * i + c] -= gauss3_weight[p] * L * ei * kappa * dkappa;
            }
    }
}

static void textbook_forces(double* force, const built* b) {
    memset(force, 0, 3 * (size_t)b->stride * sizeof *force);
    for (int k = 0; k < b->def.n_elements; ++k) {
        double e[12], Q[12];
        int dof[4];
        ancf_model_dofs(dof, b->m, k);
        for (int i = 0; i < 4; ++i)
            for (int c = 0; c < 3; ++c) e[3 * i + c] = b->x[c * b->stride + dof[i]];
        textbook_force(Q, e, b->element[k].length, b->element[k].ea, b->element[k].ei);
        for (int i = 0; i < 4; ++i)
            for (int c = 0; c < 3; ++c) force[c * b->stride + dof[i]] += Q[3 * i + c];
    }
}

static built flying_net(int kind, double damping) {
    uint64_t seed = 51;
    ancf_element all = net_element(kind, damping);
    if (kind & ANCF_SPRING) all.ei = 0.0;
    built b = build_net(6, all);
    const int corners[4] = {0, 6, 42, 48};
    for (int i = 0; i < 4; ++i) b.mass[corners[i]] = 0.05;
    build_shake(&b, b.x, 0.02, &seed);
    build_shake(&b, b.v, 0.1, &seed);
    build_finish(&b);
    b.m->unloaded = true;
    return b;
}

// One cable, smooth throughout.
static built long_cable(int elements, double damping) {
    uint64_t seed = 52;
    ancf_element all = net_element(ANCF_LUMPED, damping);
    all.length *= elements;
    built b = build_cable(elements, all, 1);
    build_shake(&b, b.x, 0.02, &seed);
    build_finish(&b);
    b.m->unloaded = true;
    return b;
}

static int compare(const void* a, const void* b) {
    const double x = *(const double*)a, y = *(const double*)b;
    return (x > y) - (x < y);
}

static double median(double* t, int n) {
    qsort(t, (size_t)n, sizeof *t, compare);
    return t[n / 2];
}

// Medians [us] of our step and of the textbook's force, taken in turn so that both see the same machine.
static void measure(double* step, double* textbook, built* b, double h) {
    double ours[REPEATS], theirs[REPEATS];
    double* force = malloc(3 * (size_t)b->stride * sizeof *force);
    ancf_time time = {0};
    run_leapfrog(b->m, h, STEPS, &time);
    for (int r = 0; r < REPEATS; ++r) {
        const double start = now();
        run_leapfrog(b->m, h, STEPS, &time);
        const double middle = now();
        for (int i = 0; i < STEPS; ++i) {
            textbook_forces(force, b);
            b->x[0] += 1e-300 * force[0]; // the compiler may not drop or merge the calls
        }
        ours[r] = (middle - start) / STEPS * 1e6;
        theirs[r] = (now() - middle) / STEPS * 1e6;
    }
    *step = median(ours, REPEATS);
    *textbook = median(theirs, REPEATS);
    free(force);
}

// Both codes must give the same force, or the race means nothing.
static int same_force(const built* b) {
    double* force = calloc(6 * (size_t)b->stride, sizeof *force);
    double *own = force + 3 * b->stride, largest = 0.0, off = 0.0;
    textbook_forces(own, b);
    ancf_elastic_force(b->m, force, b->x, b->v);
    for (int c = 0; c < 3; ++c)
        for (int i = 0; i < b->n_dof; ++i) {
            largest = fmax(largest, fabs(own[c * b->stride + i]));
            off = fmax(off, fabs(own[c * b->stride + i] - force[c * b->stride + i]));
        }
    free(force);
    return off < 1e-9 * largest;
}

// Median [ns] of a step of an element by a clock, of single steps: other work then spoils few of them.
static double cost(built* b, double h, clockid_t clock) {
    double taken[STEPS];
    ancf_time time = {0};
    run_leapfrog(b->m, h, 10, &time);
    for (int r = 0; r < STEPS; ++r) {
        const double start = read_clock(clock);
        run_leapfrog(b->m, h, 1, &time);
        taken[r] = (read_clock(clock) - start) / b->def.n_elements * 1e9;
    }
    return median(taken, STEPS);
}

static void long_cables(FILE* file, const char* host) {
    for (int damped = 0; damped < 2; ++damped) {
        built b = long_cable(LONG, damped ? 5e-5 : 0.0);
        omp_set_num_threads(1);
        const double ns = cost(&b, 2e-5, CLOCK_PROCESS_CPUTIME_ID);
        fprintf(file, "%s,smooth cable %s,%d,%.1f,%.2f,,\n", host, damped ? "damped" : "undamped", LONG,
                1e-3 * LONG * ns, ns);
        build_free(&b);
    }
    built b = long_cable(THREADED, 0.0);
    omp_set_num_threads(1);
    const double one = cost(&b, 2e-5, CLOCK_MONOTONIC);
    omp_set_num_threads(2);
    const double two = cost(&b, 2e-5, CLOCK_MONOTONIC);
    fprintf(file, "%s,smooth cable,%d,%.1f,%.2f,,\n", host, THREADED, 1e-3 * THREADED * one, one);
    fprintf(file, "%s,smooth cable on two threads,%d,%.1f,%.2f,,\n", host, THREADED, 1e-3 * THREADED * two, two);
    build_free(&b);
}

int main(int argc, char** argv) {
    const struct {
        const char* name;
        int kind;
        double damping, step;
        double least; // times faster than the textbook's force; 0: not asked
    } cases[] = {
        {"lumped fast undamped", ANCF_LUMPED, 0.0, 2e-5, 13.0},
        {"lumped fast damped", ANCF_LUMPED, 5e-5, 2e-5, 0.0},
        {"lumped exact undamped", ANCF_LUMPED | ANCF_CURVATURE_EXACT, 0.0, 2e-5, 5.0},
        {"lumped exact damped", ANCF_LUMPED | ANCF_CURVATURE_EXACT, 5e-5, 2e-5, 0.0},
        {"consistent fast undamped", 0, 0.0, 2e-6, 6.5},
        {"consistent fast damped", 0, 5e-5, 2e-6, 0.0},
        {"consistent exact undamped", ANCF_CURVATURE_EXACT, 0.0, 2e-6, 0.0},
        {"consistent exact damped", ANCF_CURVATURE_EXACT, 5e-5, 2e-6, 0.0},
        {"springs", ANCF_SPRING, 0.0, 2e-5, 13.0},
        {"springs damped", ANCF_SPRING, 5e-5, 2e-5, 0.0},
    };
    char host[128] = "unknown";
    gethostname(host, sizeof host - 1);
    const int check = argc > 1 && strcmp(argv[1], "--check") == 0;
    FILE* file = argc > 1 && !check ? fopen(argv[1], "w") : stdout;
    if (!file) {
        perror(argv[1]);
        return 2;
    }
    int failed = 0;
    if (!check) fprintf(file, "machine,case,elements,step_us,ns_an_element,textbook_force_us,ratio\n");
    for (size_t k = 0; k < sizeof cases / sizeof *cases; ++k) {
        built b = flying_net(cases[k].kind, cases[k].damping);
        if (cases[k].damping == 0.0 && (cases[k].kind & ANCF_CURVATURE_EXACT) && !same_force(&b)) {
            fprintf(stderr, "%s: the textbook's force is another\n", cases[k].name);
            failed = 1;
        }
        if (check) {
            build_free(&b);
            continue;
        }
        double step, textbook;
        measure(&step, &textbook, &b, cases[k].step);
        fprintf(file, "%s,%s,%d,%.3f,%.2f,%.3f,%.1f\n", host, cases[k].name, b.def.n_elements, step,
                1e3 * step / b.def.n_elements, textbook, textbook / step);
        if (textbook < cases[k].least * step) {
            fprintf(stderr, "%s: only %.1f times faster\n", cases[k].name, textbook / step);
            failed = 1;
        }
        build_free(&b);
    }
    if (!check) long_cables(file, host);
    if (file != stdout) fclose(file);
    return failed;
}
