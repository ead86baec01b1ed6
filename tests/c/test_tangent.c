// The tangent against differences of the force, and the sparse solver against matrices that are written here.
#include "build.h"

#include "ancf/tangent.h"
#include "ldl.h"

typedef struct {
    int kind;
    double ei, damping;
} variant;

static const variant variants[] = {
    {0, 0.0, 0.0},
    {ANCF_AXIAL_REDUCED, 0.0, 0.0},
    {0, 2e-2, 0.0},
    {ANCF_AXIAL_REDUCED, 2e-2, 0.0},
    {ANCF_CURVATURE_EXACT, 2e-2, 0.0},
    {ANCF_AXIAL_REDUCED | ANCF_CURVATURE_EXACT, 2e-2, 0.0},
    {ANCF_SPRING, 0.0, 0.0},
    {0, 0.0, 3e-3},
    {ANCF_AXIAL_REDUCED, 0.0, 3e-3},
    {0, 2e-2, 3e-3},
    {ANCF_AXIAL_REDUCED, 2e-2, 3e-3},
    {ANCF_CURVATURE_EXACT, 2e-2, 3e-3},
    {ANCF_AXIAL_REDUCED | ANCF_CURVATURE_EXACT, 2e-2, 3e-3},
    {ANCF_SPRING, 0.0, 3e-3},
    {ANCF_ENGINEERING, 0.0, 0.0},
    {ANCF_ENGINEERING | ANCF_AXIAL_REDUCED, 2e-2, 0.0},
    {ANCF_ENGINEERING | ANCF_CURVATURE_EXACT, 2e-2, 0.0},
    {ANCF_ENGINEERING, 0.0, 3e-3},
    {ANCF_ENGINEERING | ANCF_AXIAL_REDUCED, 2e-2, 3e-3},
    {ANCF_ENGINEERING | ANCF_CURVATURE_EXACT, 2e-2, 3e-3},
};
enum { VARIANTS = sizeof variants / sizeof *variants, DOFS = 12 };

// All variants in one model, one element after the other, none of which touches another.
static built build_variants(double stretch, double by, uint64_t* seed) {
    const ancf_element any = {.length = 0.3, .ea = 40.0, .rho_a = 0.1};
    built b = build_start(2 * VARIANTS, VARIANTS, any);
    for (int e = 0; e < VARIANTS; ++e) {
        b.element[e].kind = variants[e].kind;
        b.element[e].ei = variants[e].ei;
        b.element[e].damping = variants[e].damping;
        b.ends[2 * e] = 2 * e;
        b.ends[2 * e + 1] = 2 * e + 1;
        b.x[2 * e] = 0.1 * e;
        b.x[2 * e + 1] = 0.1 * e + 0.3 * stretch;
    }
    build_slopes(&b);
    build_shake(&b, b.x, by, seed);
    build_shake(&b, b.v, 40.0 * by, seed);
    build_finish(&b);
    return b;
}

// Place in a block of unknown k of an element: (r0, g0, r1, g1), three coordinates each.
static int place_of(const built* b, int e, int k) {
    int dof[4];
    ancf_model_dofs(dof, b->m, e);
    return k % 3 * b->stride + dof[k / 3];
}

// The tangent over (r0, g0, r1, g1), from its documented entries.
static void full_tangent(double K[DOFS][DOFS], const double* tangent, int e, double length) {
    static const int symmetric[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
    double Q[9][9];
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            for (int p = 0; p < 3; ++p) {
                Q[3 * p + i][3 * p + j] = tangent[e * ANCF_TANGENT + 6 * p + symmetric[i][j]];
                const int row = p == 2 ? 1 : 0, column = p == 0 ? 1 : 2;
                Q[3 * row + i][3 * column + j] = Q[3 * column + j][3 * row + i] =
                    tangent[e * ANCF_TANGENT + 18 + 9 * p + 3 * i + j];
            }
    double T[9][DOFS] = {{0.0}}; // (g0, d, g1) of the unknowns
    for (int c = 0; c < 3; ++c) {
        T[c][3 + c] = T[6 + c][9 + c] = 1.0;
        T[3 + c][c] = -1.0 / length;
        T[3 + c][6 + c] = 1.0 / length;
    }
    for (int i = 0; i < DOFS; ++i)
        for (int j = 0; j < DOFS; ++j) {
            K[i][j] = 0.0;
            for (int k = 0; k < 9; ++k)
                for (int l = 0; l < 9; ++l) K[i][j] += T[k][i] * Q[k][l] * T[l][j];
        }
}

// Central differences of the force, velocities moving along.
static void difference(double J[VARIANTS][DOFS][DOFS], built* b, double rate) {
    const double step = 1e-6;
    const size_t size = 3 * (size_t)b->stride * sizeof(double);
    double *up = malloc(size), *down = malloc(size), *x = malloc(size), *v = malloc(size);
    for (int j = 0; j < DOFS; ++j) {
        for (int sign = 1; sign >= -1; sign -= 2) {
            memcpy(x, b->x, size);
            memcpy(v, b->v, size);
            for (int e = 0; e < VARIANTS; ++e) {
                x[place_of(b, e, j)] += sign * step;
                v[place_of(b, e, j)] += sign * step * rate;
            }
            ancf_elastic_force(b->m, sign > 0 ? up : down, x, v);
        }
        for (int e = 0; e < VARIANTS; ++e)
            for (int i = 0; i < DOFS; ++i)
                J[e][i][j] = (down[place_of(b, e, i)] - up[place_of(b, e, i)]) / (2.0 * step);
    }
    free(up);
    free(down);
    free(x);
    free(v);
}

static double J[VARIANTS][DOFS][DOFS], K[DOFS][DOFS];

static void derivative_of_the_force(void** state) {
    (void)state;
    uint64_t seed = 81;
    for (int round = 0; round < 12; ++round) {
        const double rate = round % 3 ? 700.0 * (round % 3) : 0.0;
        built b = build_variants(round % 2 ? 1.3 : 0.9, 0.2, &seed);
        double* tangent = malloc(ANCF_TANGENT * VARIANTS * sizeof *tangent);
        ancf_tangent(tangent, b.m, b.x, b.v, rate, false);
        difference(J, &b, rate);
        for (int e = 0; e < VARIANTS; ++e) {
            double largest = 0.0;
            full_tangent(K, tangent, e, 0.3);
            for (int i = 0; i < DOFS; ++i)
                for (int j = 0; j < DOFS; ++j) largest = fmax(largest, fabs(J[e][i][j]));
            assert_true(largest > 1.0 || variants[e].kind & ANCF_SPRING);
            for (int i = 0; i < DOFS; ++i)
                for (int j = 0; j < DOFS; ++j) assert_near(K[i][j], 0.5 * (J[e][i][j] + J[e][j][i]), 2e-7 * largest);
        }
        free(tangent);
        build_free(&b);
    }
}

// Without what may be indefinite: no direction in which it is negative, however compressed; and nothing is missing of a
// straight taut element at rest.
static void definite_tangent(void** state) {
    (void)state;
    uint64_t seed = 82;
    for (int round = 0; round < 20; ++round) {
        const bool taut = round == 0;
        built b = build_variants(taut ? 1.3 : 0.6, taut ? 0.0 : 0.3, &seed);
        double *tangent = malloc(2 * ANCF_TANGENT * VARIANTS * sizeof *tangent),
               *whole = tangent + ANCF_TANGENT * VARIANTS;
        ancf_tangent(tangent, b.m, b.x, b.v, 500.0, true);
        ancf_tangent(whole, b.m, b.x, b.v, 500.0, false);
        for (int k = 0; k < ANCF_TANGENT * VARIANTS && taut; ++k) assert_near(tangent[k], whole[k], 1e-13 * 40.0);
        bool indefinite = false;
        for (int e = 0; e < VARIANTS; ++e)
            for (int way = 0; way < 400; ++way) {
                double z[DOFS], sum = 0.0, other = 0.0;
                for (int i = 0; i < DOFS; ++i) z[i] = random_between(&seed, -1.0, 1.0) * (i / 3 % 2 ? 1.0 : 0.3);
                if (way % 2)
                    for (int i = 0; i < 6; ++i) z[6 + i] = (i < 3 ? 1.0 : -1.0) * z[i];
                full_tangent(K, tangent, e, 0.3);
                for (int i = 0; i < DOFS; ++i)
                    for (int j = 0; j < DOFS; ++j) sum += z[i] * K[i][j] * z[j];
                full_tangent(K, whole, e, 0.3);
                for (int i = 0; i < DOFS; ++i)
                    for (int j = 0; j < DOFS; ++j) other += z[i] * K[i][j] * z[j];
                assert_true(sum >= -1e-10);
                indefinite |= other < -1e-3;
            }
        assert_true(indefinite != taut); // so that there is something to leave out
        free(tangent);
        build_free(&b);
    }
}

// Random sparse matrices of blocks, diagonally dominant, against the product with a known solution.
static void sparse_factor(void** state) {
    (void)state;
    uint64_t seed = 83;
    for (int round = 0; round < 8; ++round) {
        const int n = 1 + 7 * round, n_pairs = 3 * n;
        int pair[2 * 3 * 50];
        for (int k = 0; k < n_pairs; ++k) {
            pair[2 * k] = (int)(random_unit(&seed) * n);
            pair[2 * k + 1] = round % 2 || pair[2 * k] == 0 ? (int)(random_unit(&seed) * n) : pair[2 * k] - 1;
        }
        int kept = 0;
        for (int k = 0; k < n_pairs; ++k) {
            if (pair[2 * k] == pair[2 * k + 1]) continue;
            pair[2 * kept] = pair[2 * k];
            pair[2 * kept++ + 1] = pair[2 * k + 1];
        }
        ancf_ldl* ldl;
        assert_int_equal(ancf_ldl_create(&ldl, n, pair, kept), ANCF_OK);
        double(*A)[150] = calloc((size_t)(3 * n), sizeof *A);
        for (int k = 0; k < kept + n; ++k) {
            const int i = ldl->row[k < kept ? pair[2 * k] : k - kept],
                      j = ldl->row[k < kept ? pair[2 * k + 1] : k - kept];
            const int row = i > j ? i : j, column = i > j ? j : i, place = ancf_ldl_place(ldl, row, column);
            assert_int_equal(ldl->index[place], row);
            for (int c = 0; c < 3; ++c)
                for (int r = row == column ? c : 0; r < 3; ++r) {
                    const double value = k < kept ? random_between(&seed, -1.0, 1.0) : r == c ? 40.0 : 0.3;
                    ldl->value[place][c][r] += value;
                    A[3 * row + r][3 * column + c] += value;
                    if (row != column || r != c) A[3 * column + c][3 * row + r] += value;
                }
        }
        double x[150];
        for (int i = 0; i < 3 * n; ++i) x[i] = random_between(&seed, -1.0, 1.0);
        for (int i = 0; i < 3 * n; ++i) {
            ldl->rhs[i / 3][i % 3] = 0.0;
            for (int j = 0; j < 3 * n; ++j) ldl->rhs[i / 3][i % 3] += A[i][j] * x[j];
        }
        assert_true(ancf_ldl_factor(ldl));
        ancf_ldl_solve(ldl);
        for (int i = 0; i < 3 * n; ++i) assert_near(ldl->rhs[i / 3][i % 3], x[i], 1e-13);
        memset(ldl->value, 0, (size_t)ldl->begin[n] * sizeof *ldl->value);
        for (int j = 0; j < n; ++j)
            for (int c = 0; c < 3; ++c) ldl->value[ldl->begin[j]][c][c] = j == n - 1 && c == 2 ? -1.0 : 1.0;
        assert_false(ancf_ldl_factor(ldl));
        free(A);
        ancf_ldl_destroy(ldl);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(derivative_of_the_force),
        cmocka_unit_test(definite_tangent),
        cmocka_unit_test(sparse_factor),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
