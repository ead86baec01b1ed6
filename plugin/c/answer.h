// Normal force of a contact over a sub-step h of its step. The elastic part is minus the quotient of elastic energy and
// way, damping acts at the mean velocity; never pulling.
#ifndef ANCF_ANSWER_H
#define ANCF_ANSWER_H

#include "ancf/contact.h"

typedef struct {
    double elastic, total; // [N]
    double slope[2];       // of both, by the force that moves the contact [-]
} ancf_pressing;

// With velocity u along the normal without its own force, if `force` is what moves it.
ancf_pressing ancf_answer_alone(const ancf_contact* c, double u, double h, double force);

// At a mean velocity v along the normal; *elastic is its elastic part [N], *slope its derivative by v [N s/m].
double ancf_answer_at(const ancf_contact* c, double v, double h, double* elastic, double* slope);

#endif
