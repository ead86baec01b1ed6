// Contacts of cables with cables: segments on the true curves.
#ifndef ANCF_CROSS_H
#define ANCF_CROSS_H

#include "apart.h"
#include "contact.h"

// Laws of two kinds of cover.
typedef struct {
    ancf_normal normal;
    ancf_friction rub;
} ancf_laws;

// What a contact leaves to the next step; sorted by first, second, segment.
typedef struct {
    int first, second, segment;
    double friction[3]; // on the first, as a first guess [N]
    double xi[2];       // its places
    double late[3];     // see ancf_contact [N s2]
    double owed;        // see ancf_table_owe [J]
} ancf_memory;

// Whether two places are so near along one run that they never touch; lengths are those of their elements [m].
bool ancf_cross_neighbours(const ancf_cover* first, double xi, double length1, const ancf_cover* second, double eta,
                           double length2);

// Adds to the table the contacts of all pairs whose gap in the middle of the step may close in three quarters of a step
// at the present speeds, wherever these point: others can turn them. The motion is followed before. laws: (kinds x
// kinds). Returns their number; -1: out of memory. What is `friction` of a contact is taken from `last`, (n_last), and
// so is what it owes.
int ancf_cross_add(ancf_table* table, ancf_apart* apart, const ancf_cover* cover, const ancf_model* m,
                   const ancf_laws* laws, int kinds, double step, const ancf_memory* last, int n_last);

// What the contacts begin .. end-1 of the table leave to the next step. memory: room for all; returns how many.
int ancf_cross_keep(ancf_memory* memory, ancf_table* table, int begin, int end);

#endif
