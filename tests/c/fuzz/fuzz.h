// Random inputs, partly hostile, for the public interface of plugin/c, and what has to hold whatever they are.
#ifndef ANCF_FUZZ_H
#define ANCF_FUZZ_H

#include "../build.h"

#include "ancf/cover.h"
#include "ancf/law.h"
#include "ancf/stability.h"

typedef struct {
    uint64_t seed;
    double chance; // that a value is hostile; 0: all are such as cables have
} fuzz;

// Ends the process with a message if something does not hold.
void fuzz_need(bool holds, const char* what, const char* file, int line);
#define need(holds) fuzz_need(holds, #holds, __FILE__, __LINE__)

// The n-th allocation of plugin/c from now on fails, once; 0: none.
void fuzz_fail_allocation(int n);

// One input each.
void fuzz_laws(fuzz* f);    // contact and friction laws, rotor
void fuzz_groove(fuzz* f);  // sheaves
void fuzz_places(fuzz* f);  // nearest places
void fuzz_model(fuzz* f);   // built or refused, stepped, read
void fuzz_table(fuzz* f);   // contacts through steps
void fuzz_crossed(fuzz* f); // boxes, pairs, contacts of cables with cables
void fuzz_rest(fuzz* f);    // equilibrium, alone and on obstacles
void fuzz_line(fuzz* f);    // lines through rings

static inline bool by_chance(fuzz* f, double chance) { return random_unit(&f->seed) < chance; }

static inline int pick(fuzz* f, int n) { return (int)(random_unit(&f->seed) * n); }

double hostile_value(fuzz* f);

// From low to high, both above 0, every magnitude as likely; or a hostile value.
static inline double magnitude(fuzz* f, double low, double high) {
    return by_chance(f, f->chance) ? hostile_value(f) : random_magnitude(&f->seed, low, high);
}

static inline double between(fuzz* f, double low, double high) {
    return by_chance(f, f->chance) ? hostile_value(f) : random_between(&f->seed, low, high);
}

static inline void vector_between(double v[3], fuzz* f, double size) {
    for (int i = 0; i < 3; ++i) v[i] = between(f, -size, size);
}

void unit_vector(double n[3], fuzz* f); // never hostile

// An index below n, or a hostile one.
int index_below(fuzz* f, int n);

bool all_finite(const double* value, int n);

static inline bool is_unit(const double n[3]) { return fabs(n[0] * n[0] + n[1] * n[1] + n[2] * n[2] - 1.0) < 1e-9; }

ancf_normal any_normal_law(fuzz* f);
ancf_friction any_friction_law(fuzz* f);

// A law that passes its check.
ancf_normal good_normal_law(fuzz* f);
ancf_friction good_friction_law(fuzz* f);

// What a cable is made of, and where it lies and goes: elements in a row, a closed ring, or joined anyhow.
built any_build(fuzz* f);

// The same, and its model; false: it was refused.
bool any_model(built* b, fuzz* f);

int any_knot(fuzz* f, const ancf_model* m); // where an element ends

ancf_solid any_solid(fuzz* f, ancf_groove* groove);

// (n_elements), 1 to `most` segments each, laws of `kinds`.
ancf_cover* any_cover(fuzz* f, const ancf_model* m, int most, int kinds);

// A step that the cable bears [s], or a hostile one.
double any_step(fuzz* f, const ancf_model* m);

// State and velocity of a model spoilt here and there, as nobody looks at them between two steps.
void spoil(fuzz* f, const built* b);

#endif
