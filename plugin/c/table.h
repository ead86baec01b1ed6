// What is in a table of contacts, for the files that solve it.
#ifndef ANCF_TABLE_H
#define ANCF_TABLE_H

#include "ancf/contact.h"
#include "groups.h"
#include "internal.h"
#include "newton.h"

// Velocity of the other's slope by an impulse, of the other by an impulse on the slope, and of slope by slope [1/kg].
typedef struct {
    double to, from, both;
} ancf_bend;

typedef struct {
    double effect;
    ancf_bend bend;
} ancf_effects;

// One contact among others in a sub-step. Signs are those of an impulse along the normal.
typedef struct {
    double pushed; // velocity along the normal since the sub-step began, but by bodies [m/s]
    double normal[3];
    int body[2];         // that move, or -1
    int number;          // among those that are solved at once
    double along[2][6];  // velocity along the normal by their velocity and spin [-], [m]
    double answer[2][6]; // velocity and spin by a unit impulse [1/kg], [1/(kg m)]
} ancf_push;

// Friction of one contact among others, along two directions across its normal.
typedef struct {
    bool levers, listed;
    int number; // among those that are solved at once
    double tangent[2][3];
    double turn[4][2][3];   // couple or twist by a unit impulse, on the place [-] and the body [m] of either side
    double* body[2];        // `pushed` of bodies that move, or NULL
    double answer[2][2][6]; // their velocity and spin by a unit impulse [1/kg], [1/(kg m)]
    double own[2][2];       // slip along either by a unit impulse along either [1/kg]
    double slip[2];         // before friction, but for its guess [m/s]
    double impulse[2];      // [N s]
    double without[2];      // slip without its own friction, when that was found [m/s]
} ancf_drag;

struct ancf_table {
    const ancf_model* model; // that of the step
    ancf_responses* responses;
    int n_places, n_bodies, n_contacts, n_couplings;
    ancf_place* place;
    ancf_body* body;
    ancf_contact* contact;
    ancf_coupling* coupling;
    int room_places, room_bodies, room_contacts, room_couplings;

    // Velocity at place other[k] by a unit impulse at place i, for k in first[i] .. first[i + 1] [1/kg].
    int *first, *other;
    double* effect;
    ancf_bend* bend; // the same of slopes
    int room_first, room_effect;
    bool slopes;       // any place takes couples
    int slides;        // place of the model's first node that slides, those of the others behind it; -1: none
    double (*hold)[3]; // (2 n_slides) impulses across their lines, and scratch
    int room_hold;
    bool factored, alone; // couplings are so many that the factor answers sooner; and have no contact: no rows are made

    // For prepare: places that use an unknown, as lists, and sums by place.
    int *head, *next; // (n_dof), (4 n_places)
    int room_next;
    ancf_effects* sum; // (n_places)
    int* touched;      // (n_places)
    int room_sum;
    double* stiffness; // (n_places + n_bodies) of the contacts there [N/m]
    int room_stiffness;
    ancf_groups groups;
    ancf_push* push; // (n_contacts)
    int room_push;
    ancf_drag* drag; // (n_contacts)
    int room_drag;
    // Contacts of a group that rub, entries part[k] .. part[k + 1] - 1 of `rubbing` being solved at once, k < parts;
    // lists of those at a body; what those of a part do to one another [1/kg].
    int *rubbing, *part, *first_on, *next_on, parts;
    double* effects;
    int room_rubbing, room_part, room_first_on, room_next_on, room_effects;
    double newton[ANCF_NEWTON_ROOM];
    int most;             // sub-steps of the group that needs most; -1: not asked
    double (*scratch)[3]; // (7 n_couplings) for conjugate gradients
    int room_scratch;
    double (*slip)[3]; // (n_contacts) before friction [m/s]
    int room_slip;
    double passed;  // from the middle of the time for which accelerations of bodies are given to that of the step [s]
    bool guessed;   // slip is that of a first guess, at the start of the step
    double left[3]; // what the couples could not balance [N m s]
};

static inline double ancf_dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static inline void ancf_cross(double c[3], const double a[3], const double b[3]) {
    c[0] = a[1] * b[2] - a[2] * b[1];
    c[1] = a[2] * b[0] - a[0] * b[2];
    c[2] = a[0] * b[1] - a[1] * b[0];
}

static inline void ancf_multiply(double y[3], const double A[9], const double x[3]) {
    for (int i = 0; i < 3; i++) y[i] = ancf_dot(A + 3 * i, x);
}

// Velocity of a body's point [m/s].
static inline void ancf_body_velocity(double v[3], const ancf_body* b, const double arm[3]) {
    ancf_cross(v, b->spin, arm);
    for (int i = 0; i < 3; i++) v[i] += b->velocity[i];
}

// What is not a number stays.
static inline double ancf_larger(double a, double b) { return a > b || a != a ? a : b; }

// Sum of a field's values at an element's unknowns, with weights.
void ancf_value_of(double value[3], const int dof[4], const double weight[4], const ancf_model* m, const double* field);

// What a step starts with, however many the contacts have gone through.
ancf_error ancf_table_start(ancf_table* t, const ancf_model* m, const double* velocity);

// Gives an impulse to a place or to a body's point, `rest` before the end of the step.
void ancf_table_kick_place(ancf_table* t, int place, const double impulse[3], double rest);
void ancf_table_kick_slope(ancf_table* t, int place, const double impulse[3], double step); // at its start
void ancf_table_kick_body(ancf_table* t, int body, const double arm[3], const double impulse[3], double rest);

// Impulses on the nodes that slide, in t->hold, by which what holds them answers to an impulse and a couple at a place,
// NULL: no couple. False: none of them feels it.
bool ancf_table_hold(const ancf_table* t, int place, const double impulse[3], const double couple[3]);

// And to both sides of a contact.
void ancf_table_kick(ancf_table* t, const ancf_contact* c, const double impulse[3], double rest);

// Velocity and spin of a body by an impulse and its twist [m/s], [rad/s].
void ancf_body_answer(double answer[6], const ancf_body* b, const double impulse[3], const double twist[3]);

// Whether it does in the step: one that stands still ties no contacts together.
bool ancf_body_moves(const ancf_body* b);

// Lets the accelerations of places and bodies act for a time.
void ancf_table_speed_up(ancf_table* t, double time);
void ancf_table_speed_up_group(ancf_table* t, const ancf_contact_group* group, double time);

// Velocity of the first side's place or body against the second side's [m/s], and its acceleration without what is in
// the table [m/s2].
void ancf_table_going(double v[3], const ancf_table* t, const ancf_contact* c);
void ancf_table_changing(double a[3], const ancf_table* t, const ancf_contact* c);

// Velocity of the first side against the second's along the normal [m/s].
double ancf_table_opening(const ancf_table* t, const ancf_contact* c);

// What one place does to another.
ancf_effects ancf_table_effects(const ancf_table* t, int from, int to);

#endif
