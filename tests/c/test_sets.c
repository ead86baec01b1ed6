// The same result with every instruction set that this machine has.
#include "check.h"

#include <dlfcn.h>
#include <stdlib.h>

typedef int (*run)(double* state);

static double* result(const char* path, int* n) {
    void* module = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    if (!module) fail_msg("%s", dlerror());
    run run_set;
    *(void**)&run_set = dlsym(module, "run_set");
    assert_non_null(run_set);
    double* state = calloc((size_t)(*n = run_set(NULL)), sizeof *state);
    if (run_set(state) != *n) fail_msg("%s: a step whose energies are wanted is another", path);
    dlclose(module);
    return state;
}

static void all_sets_agree(void** state) {
    (void)state;
    const char* path[3] = {ANCF_SETS "v4.so", ANCF_SETS "v3.so", ANCF_SETS "v1.so"};
    const int has[3] = {__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
                            __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw"),
                        __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"), 1};
    int n = 0, of = 0, different = 0;
    double* plain = result(path[2], &n);
    for (int k = 0; k < 2; ++k) {
        if (!has[k]) continue;
        double* own = result(path[k], &of);
        assert_int_equal(of, n);
        for (int i = 0; i < n; ++i) {
            assert_near(own[i], plain[i], 1e-12 * fmax(1.0, fabs(plain[i])));
            different += own[i] != plain[i];
        }
        assert_true(different > 0); // other instructions round otherwise: both cannot have been the same build
        free(own);
    }
    free(plain);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(all_sets_agree)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
