// Feeds the public interface of plugin/c with inputs at random, partly hostile, in child processes:
//     fuzz [count] [seed] [first]
// Nothing ends by a signal or a sanitizer, nothing hangs, and what fuzz.h says holds. Prints the inputs that do not,
// each of which comes again by `fuzz 1 seed number`.
#define _DEFAULT_SOURCE
#include "fuzz.h"

#include <signal.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

enum { BLOCK = 2000, SECONDS = 120 };

static const struct {
    const char* name;
    void (*run)(fuzz*);
    double share;
} kinds[] = {{"laws", fuzz_laws, 0.2},    {"groove", fuzz_groove, 0.1}, {"places", fuzz_places, 0.15},
             {"model", fuzz_model, 0.25}, {"table", fuzz_table, 0.15},  {"crossed", fuzz_crossed, 0.07},
             {"rest", fuzz_rest, 0.03},   {"line", fuzz_line, 0.05}};
enum { KINDS = sizeof kinds / sizeof *kinds };

// Shared by parent and child.
typedef struct {
    long number;
    int kind;
    long of[KINDS], hostile;
} progress;
static progress* now;

// ---- allocations that fail

static int until_failure;

void fuzz_fail_allocation(int n) { until_failure = n; }

static bool fails(void) { return until_failure > 0 && --until_failure == 0; }

void* __real_malloc(size_t size);
void* __real_calloc(size_t n, size_t size);
void* __real_realloc(void* old, size_t size);

// What the linker puts in place of theirs.
void* __wrap_malloc(size_t size) { return fails() ? NULL : __real_malloc(size); }
void* __wrap_calloc(size_t n, size_t size) { return fails() ? NULL : __real_calloc(n, size); }
void* __wrap_realloc(void* old, size_t size) { return fails() ? NULL : __real_realloc(old, size); }

// ---- inputs

void fuzz_need(bool holds, const char* what, const char* file, int line) {
    if (holds) return;
    fprintf(stderr, "%s:%d: does not hold: %s\n", file, line, what);
    fflush(stderr);
    _exit(3);
}

static void one(uint64_t seed, long number) {
    static const double chances[] = {0.0, 0.0, 0.01, 0.05, 0.2};
    fuzz f = {.seed = seed * 0x9e3779b97f4a7c15u + (uint64_t)number * 0xd1342543de82ef95u};
    random_unit(&f.seed);
    double share = random_unit(&f.seed);
    int kind = 0;
    while (kind < KINDS - 1 && share >= kinds[kind].share) share -= kinds[kind++].share;
    f.chance = chances[pick(&f, 5)];
    now->number = number;
    now->kind = kind;
    ++now->of[kind];
    now->hostile += f.chance > 0.0;
    alarm(SECONDS);
    kinds[kind].run(&f);
}

static int tell(uint64_t seed, int status) {
    printf("seed %llu, input %ld (%s): ", (unsigned long long)seed, now->number, kinds[now->kind].name);
    if (WIFSIGNALED(status) && WTERMSIG(status) == SIGALRM) puts("hangs");
    else if (WIFSIGNALED(status)) printf("signal %d\n", WTERMSIG(status));
    else printf("ends with %d\n", WEXITSTATUS(status));
    fflush(stdout);
    return 1;
}

int main(int argc, char** argv) {
    const long count = argc > 1 ? atol(argv[1]) : 5000, first = argc > 3 ? atol(argv[3]) : 0;
    const uint64_t seed = argc > 2 ? strtoull(argv[2], NULL, 10) : 1;
    now = mmap(NULL, sizeof *now, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (now == MAP_FAILED) return 2;
    long bad = 0;
    for (long next = first; next < first + count;) {
        const long end = next + BLOCK < first + count ? next + BLOCK : first + count;
        const pid_t child = fork();
        if (child == 0) {
            for (long number = next; number < end; ++number) one(seed, number);
            exit(0); // looks for leaks
        }
        int status;
        if (child < 0 || waitpid(child, &status, 0) != child) return 2;
        if (status != 0) bad += tell(seed, status);
        next = status == 0 ? end : now->number + 1;
    }
    printf("seed %llu: %ld inputs, %ld of them with hostile values:", (unsigned long long)seed, count, now->hostile);
    for (int k = 0; k < KINDS; ++k) printf(" %s %ld%s", kinds[k].name, now->of[k], k + 1 < KINDS ? "," : "");
    printf("; %ld bad\n", bad);
    return bad > 0;
}
