// Mass matrices against quadrature and dense solves that are written here.
#include "build.h"

#include "ancf/equilibrium.h"
#include "ancf/response.h"
#include <time.h>

static const int kinds[] = {0, ANCF_LUMPED, ANCF_SPRING};

static void element_mass_is_the_integral(void** state) {
    (void)state;
    for (int k = 0; k < 3; ++k) {
        const ancf_element el = {.kind = kinds[k], .length = 0.37, .ea = 1.0, .rho_a = 0.21};
        double M[4][4], own[4][4];
        ancf_mass_element(M, &el);
        own_mass(own, &el);
        for (int i = 0; i < 4; ++i)
            for (int j = 0; j < 4; ++j) assert_near(M[i][j], own[i][j], 1e-15);
        const double total = M[0][0] + M[0][2] + M[2][0] + M[2][2];
        assert_close(total, 0.21 * 0.37, 1e-14);
    }
}

// All of M, unknown by unknown, copies of a slope taken as one: n x n, and the row of every unknown (-1: held).
typedef struct {
    int n, *row;
    double *M, *held; // free rows by free columns; free rows by all unknowns, for what is held
} dense;

static dense dense_make(const built* b) {
    dense d = {.row = malloc((size_t)b->n_dof * sizeof(int))};
    const int nn = b->def.n_nodes, ne = b->def.n_elements;
    for (int i = 0; i < b->n_dof; ++i) d.row[i] = -2;
    for (int e = 0; e < ne; ++e) // the copy at a start is that at the end before
        if (b->next[e] >= 0) d.row[nn + b->next[e]] = -3;
    for (int i = 0; i < b->n_dof; ++i)
        if (d.row[i] == -2) d.row[i] = b->hold[i] ? -1 : d.n++;
    for (int e = 0; e < ne; ++e)
        if (b->next[e] >= 0) d.row[nn + b->next[e]] = d.row[nn + ne + e];
    d.M = calloc((size_t)(d.n * d.n), sizeof(double));
    d.held = calloc((size_t)(d.n * b->n_dof), sizeof(double));
    for (int e = 0; e < ne; ++e) {
        double M[4][4];
        int dof[4];
        own_mass(M, &b->element[e]);
        ancf_model_dofs(dof, b->m, e);
        for (int i = 0; i < 4; ++i)
            for (int j = 0; j < 4; ++j) {
                const int r = d.row[dof[i]], c = d.row[dof[j]];
                if (r >= 0 && c >= 0) d.M[r * d.n + c] += M[i][j];
                if (r >= 0 && c < 0) d.held[r * b->n_dof + dof[j]] += M[i][j];
            }
    }
    for (int i = 0; i < nn; ++i)
        if (d.row[i] >= 0) d.M[d.row[i] * d.n + d.row[i]] += b->mass[i];
    return d;
}

static void dense_free(dense* d) {
    free(d->row);
    free(d->M);
    free(d->held);
}

// x = M^-1 b by Gauss elimination with pivoting, in long double.
static void dense_solve(double* x, const dense* d, const double* rhs) {
    const int n = d->n;
    long double* A = malloc((size_t)(n * (n + 1)) * sizeof *A);
    for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) A[i * (n + 1) + j] = d->M[i * n + j];
        A[i * (n + 1) + n] = rhs[i];
    }
    for (int j = 0; j < n; ++j) {
        int best = j;
        for (int i = j + 1; i < n; ++i)
            if (fabsl(A[i * (n + 1) + j]) > fabsl(A[best * (n + 1) + j])) best = i;
        for (int k = 0; k <= n; ++k) {
            const long double swap = A[j * (n + 1) + k];
            A[j * (n + 1) + k] = A[best * (n + 1) + k];
            A[best * (n + 1) + k] = swap;
        }
        for (int i = j + 1; i < n; ++i) {
            const long double factor = A[i * (n + 1) + j] / A[j * (n + 1) + j];
            for (int k = j; k <= n && factor != 0.0L; ++k) A[i * (n + 1) + k] -= factor * A[j * (n + 1) + k];
        }
    }
    for (int i = n - 1; i >= 0; --i) {
        long double sum = A[i * (n + 1) + n];
        for (int k = i + 1; k < n; ++k) sum -= A[i * (n + 1) + k] * x[k];
        x[i] = (double)(sum / A[i * (n + 1) + i]);
    }
    free(A);
}

// Nets, private and shared slopes, carried masses, held nodes and slopes, consistent, lumped and mixed.
static built scene(int which, uint64_t* seed) {
    const int kind = which % 2 ? ANCF_LUMPED : 0;
    const ancf_element all = {.kind = kind, .length = 0.3, .ea = 5.0, .ei = 1e-3, .rho_a = 0.2};
    built b = which < 4 ? build_cable(7, all, which >= 2) : build_net(4, all);
    for (int e = 0; e < b.def.n_elements; ++e) {
        b.element[e].length *= random_between(seed, 0.5, 1.5);
        b.element[e].rho_a *= random_between(seed, 0.5, 1.5);
        if (which >= 6 && e % 3 == 0) b.element[e].kind = ANCF_LUMPED;
    }
    for (int i = 0; i < b.def.n_nodes; i += 3) b.mass[i] = random_between(seed, 0.0, 2.0);
    if (which % 4 >= 2 || which >= 6) {
        b.hold[0] = b.hold[b.def.n_nodes] = ANCF_HELD; // clamped
        b.hold[b.def.n_nodes - 1] = ANCF_HELD;
    }
    build_finish(&b);
    return b;
}

static void condensed_equals_full(void** state) {
    (void)state;
    uint64_t seed = 21;
    for (int which = 0; which < 8; ++which) {
        built b = scene(which, &seed);
        dense d = dense_make(&b);
        double* force = calloc(3 * (size_t)b.stride, sizeof *force);
        double* acceleration = calloc(3 * (size_t)b.stride, sizeof *acceleration);
        double *rhs = malloc((size_t)d.n * sizeof *rhs), *a = malloc((size_t)d.n * sizeof *a);
        build_shake(&b, force, 1.0, &seed);
        for (int i = 0; i < b.n_dof; ++i)
            for (int c = 0; c < 3; ++c)
                if (b.hold[i]) acceleration[c * b.stride + i] = random_between(&seed, -5.0, 5.0);
        ancf_mass_solve(b.m, acceleration, force);
        for (int c = 0; c < 3; ++c) {
            double largest = 0.0;
            for (int i = 0; i < b.n_dof; ++i)
                if (d.row[i] >= 0) rhs[d.row[i]] = force[c * b.stride + i];
            for (int i = 0; i < d.n; ++i)
                for (int j = 0; j < b.n_dof; ++j)
                    if (b.hold[j]) rhs[i] -= d.held[i * b.n_dof + j] * acceleration[c * b.stride + j];
            dense_solve(a, &d, rhs);
            for (int i = 0; i < d.n; ++i) largest = fmax(largest, fabs(a[i]));
            for (int i = 0; i < b.n_dof; ++i)
                if (d.row[i] >= 0) assert_near(acceleration[c * b.stride + i], a[d.row[i]], 1e-12 * largest);
        }
        assert_int_equal(ancf_mass_diagonal(b.m), which % 2 == 1 || 0);
        free(force);
        free(acceleration);
        free(rhs);
        free(a);
        dense_free(&d);
        build_free(&b);
    }
}

static void multiply_and_solve_are_inverse(void** state) {
    (void)state;
    uint64_t seed = 22;
    for (int which = 0; which < 6; ++which) {
        if (which % 4 >= 2) continue; // nothing held
        built b = scene(which, &seed);
        double* field = calloc(9 * (size_t)b.stride, sizeof *field);
        double *product = field + 3 * b.stride, *again = product + 3 * b.stride;
        build_shake(&b, field, 1.0, &seed);
        ancf_mass_multiply(b.m, product, field);
        ancf_mass_solve(b.m, again, product);
        for (int c = 0; c < 3; ++c)
            for (int i = 0; i < b.n_dof; ++i) assert_near(again[c * b.stride + i], field[c * b.stride + i], 1e-12);
        free(field);
        build_free(&b);
    }
}

// Gravity's force on an unknown is the integral of rho A S, by quadrature here, and a node's own mass; with the mass
// matrix that is not lumped a free cable falls without strain.
static void gravity_is_consistent(void** state) {
    (void)state;
    uint64_t seed = 23;
    for (int which = 0; which < 8; ++which) {
        built b = scene(which, &seed);
        double* own = calloc((size_t)b.n_dof, sizeof *own);
        double total = 0.0;
        for (int e = 0; e < b.def.n_elements; ++e) {
            const double L = b.element[e].length;
            int dof[4];
            ancf_model_dofs(dof, b.m, e);
            for (int p = 0; p < 5; ++p) {
                const double z = gauss5_xi[p], mass = gauss5_weight[p] * b.element[e].rho_a * L;
                own[dof[0]] += mass * (1 - z) * (1 - z) * (1 + 2 * z);
                own[dof[1]] += mass * L * z * (1 - z) * (1 - z);
                own[dof[2]] += mass * z * z * (3 - 2 * z);
                own[dof[3]] -= mass * L * z * z * (1 - z);
            }
        }
        for (int i = 0; i < b.def.n_nodes; ++i) total += own[i] += b.mass[i];
        for (int e = 0; e < b.def.n_elements; ++e) {
            if (b.next[e] < 0) continue;
            double *end = &own[b.def.n_nodes + b.def.n_elements + e], *start = &own[b.def.n_nodes + b.next[e]];
            *end = *start = *end + *start;
        }
        for (int i = 0; i < b.n_dof; ++i) assert_near(b.m->weight[i], own[i], 1e-15 * total);
        for (int i = 0; i < b.n_dof && which % 4 == 0; ++i) b.m->f[2 * b.stride + i] = -9.81 * b.m->weight[i];
        if (which == 0 || which == 4) {
            ancf_mass_solve(b.m, b.m->a, b.m->f);
            for (int i = 0; i < b.n_dof; ++i)
                assert_near(b.m->a[2 * b.stride + i], i < b.def.n_nodes ? -9.81 : 0.0, 1e-10);
        }
        free(own);
        build_free(&b);
    }
}

// One element between two points sags by the same parabola, lumped or not: W l/(8 T).
static void lumped_cable_sags_as_the_exact_one(void** state) {
    (void)state;
    double sag[2];
    for (int k = 0; k < 2; ++k) {
        const ancf_element all = {.kind = k ? ANCF_LUMPED : 0, .length = 1.0, .ea = 2e4, .rho_a = 0.2};
        built b = build_cable(1, all, 0);
        double middle[3];
        b.x[1] = 1.02; // so taut that its sag does not change the tension
        build_slopes(&b);
        b.hold[0] = b.hold[1] = ANCF_HELD;
        build_finish(&b);
        b.m->gravity[2] = -9.81;
        assert_int_equal(ancf_equilibrium(b.m, 1e-12, 100000, NULL), ANCF_OK);
        ancf_model_at(middle, b.m, b.x, 0, 0.5);
        sag[k] = -middle[2];
        build_free(&b);
    }
    const double tension = 2e4 * 0.5 * (1.02 * 1.02 - 1.0) * 1.02;
    assert_close(sag[0], 0.2 * 9.81 * 1.02 / (8.0 * tension), 1e-3);
    assert_close(sag[1], sag[0], 1e-9);
}

static void response_is_a_column_of_the_inverse(void** state) {
    (void)state;
    uint64_t seed = 24;
    for (int which = 0; which < 8; ++which) {
        built b = scene(which, &seed);
        dense d = dense_make(&b);
        double *rhs = malloc((size_t)d.n * sizeof *rhs), *a = malloc((size_t)d.n * sizeof *a);
        ancf_responses* responses;
        assert_int_equal(ancf_responses_create(&responses, b.m), ANCF_OK);
        for (int run = 0; run < 8; ++run) {
            const int e = run == 0 ? 0 : (int)(random_unit(&seed) * b.def.n_elements);
            const ancf_response* response = ancf_responses_of(responses, b.m, e);
            assert_non_null(response);
            assert_ptr_equal(ancf_responses_of(responses, b.m, e), response); // made once
            assert_in_range(response->n, 0, b.n_dof);
            int of[4];
            ancf_model_dofs(of, b.m, e);
            for (int k = 0; k < 4; ++k) {
                double* all = calloc((size_t)b.n_dof, sizeof *all);
                double largest = 0.0;
                for (int i = 0; i < d.n; ++i) rhs[i] = 0.0;
                if (d.row[of[k]] >= 0) rhs[d.row[of[k]]] = 1.0;
                dense_solve(a, &d, rhs);
                for (int i = 0; i < d.n; ++i) largest = fmax(largest, fabs(a[i]));
                for (int i = 0; i < response->n; ++i) all[response->dof[i]] += response->column[i][k];
                for (int i = 0; i < b.n_dof; ++i)
                    assert_near(all[i], d.row[i] >= 0 ? a[d.row[i]] : 0.0, 1e-12 * largest);
                free(all);
            }
        }
        ancf_responses_destroy(responses);
        free(rhs);
        free(a);
        dense_free(&d);
        build_free(&b);
    }
}

// M times the response to a unit impulse sums up to it, with light knots beside heavy bodies, short elements beside
// long ones: much of the momentum is in what hardly moves.
static void response_takes_the_impulse(void** state) {
    (void)state;
    uint64_t seed = 25;
    double worst = 0.0;
    for (int run = 0; run < 12; ++run) {
        const ancf_element all = {.length = run % 2 ? 0.01 : 30.0, .ea = 5.0, .rho_a = 1e-3};
        built b = run % 3 ? build_net(14, all) : build_cable(300, all, 1);
        for (int e = 0; e < b.def.n_elements; ++e) {
            b.element[e].length *= random_between(&seed, 0.5, 1.5);
            if (run >= 6 && e % 5 == 0) b.element[e].kind = ANCF_LUMPED;
        }
        const double lightest = 1e-3 * b.element[0].length;
        for (int i = 0; i < b.def.n_nodes; ++i)
            if (random_unit(&seed) < 0.2) b.mass[i] = lightest * random_magnitude(&seed, 1.0, 1e4);
        build_finish(&b);
        double(*force)[4] = calloc((size_t)b.n_dof, sizeof *force),
        (*answer)[4] = calloc((size_t)b.n_dof, sizeof *answer);
        ancf_responses* responses;
        assert_int_equal(ancf_responses_create(&responses, b.m), ANCF_OK);
        for (int touch = 0; touch < 10; ++touch) {
            const int element = (int)(random_unit(&seed) * b.def.n_elements);
            const ancf_response* response = ancf_responses_of(responses, b.m, element);
            int of[4];
            ancf_model_dofs(of, b.m, element);
            memset(force, 0, (size_t)b.n_dof * sizeof *force);
            memset(answer, 0, (size_t)b.n_dof * sizeof *answer);
            for (int i = 0; i < response->n; ++i) memcpy(answer[response->dof[i]], response->column[i], sizeof *answer);
            for (int e = 0; e < b.def.n_elements; ++e) {
                double M[4][4];
                int dof[4];
                own_mass(M, &b.element[e]);
                ancf_model_dofs(dof, b.m, e);
                for (int i = 0; i < 4; ++i)
                    for (int j = 0; j < 4; ++j)
                        for (int k = 0; k < 4; ++k) force[dof[i]][k] += M[i][j] * answer[dof[j]][k];
            }
            for (int place = 0; place <= 4; ++place) {
                double S[4], sum = -1.0;
                ancf_shape(S, 0.25 * place, b.element[element].length);
                for (int i = 0; i < b.def.n_nodes; ++i)
                    for (int k = 0; k < 4; ++k) sum += S[k] * (force[i][k] + b.mass[i] * answer[i][k]);
                worst = fmax(worst, fabs(sum));
            }
        }
        ancf_responses_destroy(responses);
        free(force);
        free(answer);
        build_free(&b);
    }
    print_message("momentum off by %.2g of the impulse\n", worst);
    assert_true(worst < 1e-12);
}

// Shortest CPU time of several runs for the responses of 16 elements [s].
static double time_of_responses(built b) {
    double least = INFINITY;
    build_finish(&b);
    for (int run = 0; run < 5; ++run) {
        ancf_responses* responses;
        assert_int_equal(ancf_responses_create(&responses, b.m), ANCF_OK);
        const clock_t start = clock();
        for (int i = 0; i < 16; ++i)
            assert_non_null(ancf_responses_of(responses, b.m, (2 * i + 1) * (b.def.n_elements / 32)));
        least = fmin(least, (double)(clock() - start) / CLOCKS_PER_SEC);
        ancf_responses_destroy(responses);
    }
    build_free(&b);
    return least;
}

static void responses_do_not_cost_the_whole_model(void** state) {
    (void)state;
    for (int kind = 0; kind <= ANCF_LUMPED; kind += ANCF_LUMPED) {
        const ancf_element all = {.kind = kind, .length = 1.0, .ea = 5.0, .rho_a = 0.2};
        const double net = time_of_responses(build_net(80, all)) / time_of_responses(build_net(20, all)),
                     cable =
                         time_of_responses(build_cable(64000, all, 1)) / time_of_responses(build_cable(1000, all, 1));
        print_message("16 times the net: %.1f times the time; 64 times the cable: %.1f\n", net, cable);
        assert_true(net < 8.0);
        assert_true(cable < 16.0);
    }
}

static void bad_models_are_refused(void** state) {
    (void)state;
    const ancf_element good = {.length = 1.0, .ea = 10.0, .ei = 0.1, .rho_a = 0.2, .damping = 1e-3};
    const struct {
        ancf_error error;
        ancf_element element;
    } bad[] = {
        {ANCF_E_KIND, {.kind = 32, .length = 1.0, .ea = 1.0, .rho_a = 1.0}},
        {ANCF_E_KIND, {.kind = ANCF_LUMPED | 1 << 30, .length = 1.0, .ea = 1.0, .rho_a = 1.0}},
        {ANCF_E_KIND, {.kind = -1, .length = 1.0, .ea = 1.0, .rho_a = 1.0}},
        {ANCF_E_LENGTH, {.length = 0.0, .ea = 1.0, .rho_a = 1.0}},
        {ANCF_E_LENGTH, {.length = NAN, .ea = 1.0, .rho_a = 1.0}},
        {ANCF_E_STIFFNESS, {.length = 1.0, .ea = -1.0, .rho_a = 1.0}},
        {ANCF_E_STIFFNESS, {.length = 1.0, .ea = 1.0, .ei = -1.0, .rho_a = 1.0}},
        {ANCF_E_STIFFNESS, {.length = 1.0, .ea = INFINITY, .rho_a = 1.0}},
        {ANCF_E_MASS, {.length = 1.0, .ea = 1.0, .rho_a = 0.0}},
        {ANCF_E_DAMPING, {.length = 1.0, .ea = 1.0, .rho_a = 1.0, .damping = -1.0}},
        {ANCF_E_DRAG, {.length = 1.0, .ea = 1.0, .rho_a = 1.0, .drag = -1.0}},
        {ANCF_E_SPRING, {.kind = ANCF_SPRING, .length = 1.0, .ea = 1.0, .ei = 1.0, .rho_a = 1.0}},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; ++i) {
        built b = build_cable(3, good, 1);
        b.element[2] = bad[i].element;
        ancf_model* m = (ancf_model*)&b;
        int where = -1;
        b.def.element = b.element;
        b.def.ends = b.ends;
        b.def.next = b.next;
        assert_int_equal(ancf_model_create(&m, &b.def, b.x, b.v, &where), bad[i].error);
        assert_null(m);
        assert_int_equal(where, 2);
        build_free(&b);
    }
    for (int which = 0; which < 8; ++which) {
        built b = build_cable(3, good, 1);
        const ancf_error expected[] = {ANCF_E_NODE, ANCF_E_NODE, ANCF_E_NODE,  ANCF_E_NEXT,
                                       ANCF_E_NEXT, ANCF_E_MASS, ANCF_E_STATE, ANCF_E_STATE};
        if (which == 0) b.ends[3] = 4;
        if (which == 1) b.ends[3] = b.ends[2];
        if (which == 2) b.ends[0] = -1;
        if (which == 3) b.next[0] = 2; // does not start where this one ends
        if (which == 4) b.next[2] = 3;
        if (which == 5) b.mass[1] = NAN;
        if (which == 6) b.x[b.stride + 1] = NAN;
        if (which == 7) b.v[2 * b.stride + 5] = INFINITY;
        b.def.element = b.element;
        b.def.ends = b.ends;
        b.def.next = b.next;
        b.def.mass = b.mass;
        ancf_model* m = NULL;
        int where = -1;
        assert_int_equal(ancf_model_create(&m, &b.def, b.x, b.v, &where), expected[which]);
        assert_null(m);
        build_free(&b);
    }
    for (int held = 0; held < 2; ++held) { // no element ends at node 2
        built b = build_start(4, 2, good);
        const int ends[] = {0, 1, 1, 3};
        memcpy(b.ends, ends, sizeof ends);
        for (int i = 0; i < 4; ++i) b.x[i] = (double)i;
        build_slopes(&b);
        b.hold[2] = held ? ANCF_HELD : ANCF_FREE;
        b.def.element = b.element;
        b.def.ends = b.ends;
        b.def.next = b.next;
        b.def.hold = b.hold;
        int where = -1;
        assert_int_equal(ancf_model_create(&b.m, &b.def, b.x, b.v, &where), held ? ANCF_OK : ANCF_E_LOOSE);
        if (!held) assert_int_equal(where, 2);
        build_free(&b);
    }
    built b = build_cable(1, good, 0);
    b.def.n_elements = 0;
    ancf_model* m = NULL;
    assert_int_equal(ancf_model_create(&m, &b.def, b.x, b.v, NULL), ANCF_E_EMPTY);
    build_free(&b);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(element_mass_is_the_integral),
        cmocka_unit_test(condensed_equals_full),
        cmocka_unit_test(multiply_and_solve_are_inverse),
        cmocka_unit_test(gravity_is_consistent),
        cmocka_unit_test(lumped_cable_sags_as_the_exact_one),
        cmocka_unit_test(response_is_a_column_of_the_inverse),
        cmocka_unit_test(response_takes_the_impulse),
        cmocka_unit_test(responses_do_not_cost_the_whole_model),
        cmocka_unit_test(bad_models_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
