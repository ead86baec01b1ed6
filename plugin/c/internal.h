// What the files of plugin/c share and nobody else needs.
#ifndef ANCF_INTERNAL_H
#define ANCF_INTERNAL_H

#include "ancf/model.h"

#include <stddef.h>

// One build of a kernel for each instruction set, chosen at run time. Not under a sanitizer, which is not up yet when
// the choice is made, and not where ANCF_ONE_SET says that the compiler's own is meant.
#if !defined(ANCF_ONE_SET) && defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) &&                       \
    !defined(__SANITIZE_ADDRESS__)
#define ANCF_CLONES __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define ANCF_CLONES
#endif
#if defined(__SANITIZE_ADDRESS__) // whose checks, inlined a thousand times, would take minutes to compile
#define ANCF_INLINE static inline
#else
#define ANCF_INLINE static inline __attribute__((always_inline))
#endif

enum { ANCF_THREADED_FROM = 4000 }; // elements; fewer are not worth the waiting of threads for one another

// The first of n that one of `threads` takes; its last is before the first of the next one.
static inline int ancf_share(int n, int thread, int threads) { return (int)((long)n * thread / threads); }

// Makes room for n items of a size, half as many again at least. False: out of memory, and nothing is lost.
bool ancf_reserve(void** items, int* room, int n, size_t size);

// Weights of an element's four unknowns at xi.
void ancf_model_weights(double S[4], const ancf_model* m, int element, double xi);
void ancf_model_mean_weights(double S[4], const ancf_model* m, int element, const double power[3]);
void ancf_model_slope_weights(double T[4], const ancf_model* m, int element, double xi); // in dr/dxi

// m->f = all forces but contact at a state.
void ancf_total_force(ancf_model* m, const double* x, const double* v);

// Adds m->external, gravity and mass-proportional damping at a velocity to the forces of elements, and joins them.
void ancf_add_loads(const ancf_model* m, double* force, const double* v);

// Whether a sum over all unknowns takes this one: of a shared slope's two copies the start's alone.
static inline bool ancf_model_counts(const ancf_model* m, int dof) {
    const int end = dof - m->n_nodes - m->n_elements;
    return end < 0 || m->next[end] < 0;
}

// Number of the slide that a node goes on, or -1.
static inline int ancf_slide_of(const ancf_model* m, int node) { return m->n_slides > 0 ? m->slide_of[node] : -1; }

// Largest unbalanced force, but for rounding, over the largest that elements or loads exert, at the state that m->f was
// found for [-].
double ancf_imbalance(const ancf_model* m);

#endif
