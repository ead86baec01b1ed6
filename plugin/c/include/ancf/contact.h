// The contacts of cables, and of bodies that knots carry, through one step of the cable.
//
// All that touches in a step stands in one table: places on cables and knots, bodies that move by themselves, contacts
// between them, and couplings of knots with points of bodies. Elasticity, damping and gravity act once, as a kick at
// the start. Then the normal forces of the contacts act in sub-steps short enough for the stiffest of them, on gaps and
// velocities at the places alone: what a unit impulse at one place does to another is a number, found once a step.
// Friction follows once, at the velocity that is left.
//
// Places, normals and gaps are best those of the middle of the step, half a step ahead at the present velocities: then
// the gap at the end of a step is that at the start of the next to third order, and what contacts store and give back
// is the same. An impulse acts on both sides at one point in space, also as they move within the step, so that angular
// momentum is exact; between two cables it acts at their two centrelines, and couples on their slopes make up for what
// is between these.
//
// In the order of use in a step: ancf_table_clear; add places, bodies, contacts, couplings; ancf_table_prepare,
// ancf_table_accelerate, ancf_table_guess, ancf_table_couple, ancf_table_substeps, ancf_table_press, ancf_table_rub,
// ancf_table_couple, ancf_table_apply, ancf_table_end. The cable can take several steps with contacts that were found
// once: ancf_table_go_on then stands for the first two.
#ifndef ANCF_CONTACT_H
#define ANCF_CONTACT_H

#include "law.h"
#include "model.h"
#include "response.h"

// A place on a cable.
typedef struct {
    int element;
    bool idle; // no contact there is near enough
    double xi;
    int dof[4];  // of its element's unknowns in a block
    double S[4]; // their weights at xi
    double T[4]; // and those in dr/dxi, if couples act there; else 0
    const ancf_response* response;
    double compliance;      // velocity by a unit impulse at the place itself [1/kg]
    double velocity[3];     // [m/s]
    double acceleration[3]; // without what is in the table [m/s2]
    double slope[3];        // dr/dxi at the start of the step [m]
    double bending[3];      // its velocity [m/s]
    double bends[3];        // its acceleration without what is in the table [m/s2]
    double impulse[3];      // on the cable in this step [N s]
    double couple[3];       // and on its slope [N s]
    double moment[3];       // impulses, each times the time from it to the end of the step [N s2]
    double pushed[6];       // velocity and that of the slope by what friction has found so far [m/s]
} ancf_place;

// A body that moves by itself.
typedef struct {
    double position[3];
    double velocity[3], spin[3];        // in: as they will be without what is in the table [m/s], [rad/s]; out: with it
    double acceleration[3], turning[3]; // without it [m/s2], [rad/s2]
    double inv_mass[3];                 // per axis, 0 where it cannot move [1/kg]
    double inv_inertia[9];              // world axes, row by row; 0 where it cannot turn [1/(kg m2)]
    double along[3];             // direction of a straight guide over the root of the mass on it; 0: none [1/sqrt(kg)]
    double impulse[3], twist[3]; // on it since the table was filled, the latter about where it is [N s], [N m s]
    double shift[3], turn[3];    // how far they move and turn it by the end of the step [m], [rad]
    double before[6];            // velocity and spin at the start of the step [m/s], [rad/s]
    double given[6];             // acceleration and turning as they were given: the guess of friction adds to them
    double moved[3], turned[3];  // since the table was filled, at the mean of what those do [m], [rad]
    double taken[6];             // impulse and twist at the start of the step
    double work;                 // that they have done on it since the table was filled [J]
    double pushed[6];            // velocity and spin by what was found so far of normal forces in a sub-step, or of
                                 // friction [m/s], [rad/s]
} ancf_body;

// One side of a contact: a place, a body, a body that moves with a knot and turns by itself, or none: it stands still.
typedef struct {
    int place; // number in the table, -1: none
    int body;
    double
        arm[3]; // from its position to where forces act, at the start of the step; of a second cable to the first [m]
} ancf_side;

typedef struct {
    ancf_side side[2];
    int key[3];       // the caller's
    double normal[3]; // unit vector from the second side to the first: pressed apart, the first moves along it
    double gap;       // in: at the start [m]; out: as the sub-steps leave it
    ancf_normal law;
    ancf_friction rub;
    double friction[3];    // in: first guess; out: mean force on the first side in this step [N]
    double guess[3];       // what of it acted while the normal forces did [N]
    double met;            // velocity along the normal without its own force, when that was found [m/s]
    double most;           // coefficient that its friction can have [-]
    double impulse;        // of the normal force in this step, >= 0 [N s]
    double depth;          // deepest penetration since the table was filled [m]
    double pressed[3];     // normal impulse on the first side since then [N s]
    double dragged[3];     // and that of friction [N s]
    double force, before;  // normal force of a sub-step, and the last that was found [N]
    double kicked;         // part of `force` that has moved what it acts on [N]
    double energy;         // elastic energy at the start of a sub-step, in the end of the step [J]
    double found;          // and what of it no work has stored: since the table was filled, it was found there, at the
                           // start of a step, besides what the one before had left [J]
    double left;           // elastic energy that the step before has left; 0 when the table is filled [J]
    double damped;         // taken out by its damping since the table was filled [J]
    double rubbed;         // and by its friction [J]
    double own;            // velocity along the normal by a unit impulse along it [1/kg]
    double speed, elastic; // of the sub-step [m/s], [N]
    double owed;           // work that it did too much, in: in steps before, out: in all, see ancf_table_owe [J]
    double repaid;         // part of `force` that gives it back [N]
    double changing[3];    // acceleration of the first side against the second without what is in the table [m/s2]
    double start[3];       // arm of the second side at the start [m]
    double margin;         // see ancf_table_rest [m]
    bool idle;             // too far to touch in this step
    double within[2];      // part of the first side's element on which its place moves; one point if it does not
    double round;          // of a ball and a cable: sum of the radii [m]; 0: not round
    double held;        // distance of the place from the ball's centre at which the gap is zero: `round`, but where a
                        // segment lies along it [m]
    ancf_normal plain;  // law of a single place; `law` where a segment lies along a ball, see lying.h
    double radius[2];   // of two cables: how far from their centrelines they touch; else 0 [m]
    double lever[9];    // turning by a moment, see lever.c [1/m]
    double line[3];     // normal in the middle of the step
    double balanced[3]; // moment of normal impulses that friction has added and couples balance [N m s]
    double going[3];    // velocity of the first side's place or position against the second's before friction [m/s]
    double late[3];     // normal impulse, each part times the time from the start of the step to it [N s2]
} ancf_contact;

// A knot that goes on together with a point of a body (Eq. 5, multipliers solved for).
typedef struct {
    int place, body;
    double arm[3];     // from the body's position to the point [m]
    double ahead[3];   // what the point's velocity gains within the step by the body's turning [m/s]
    double impulse[3]; // on the knot in this step [N s]
} ancf_coupling;

typedef struct ancf_table ancf_table;

ancf_error ancf_table_create(ancf_table** table, const ancf_model* m);
void ancf_table_destroy(ancf_table* table);

// Empties it. Numbers of what is added count from 0; -1: out of memory.
void ancf_table_clear(ancf_table* table);

// A node's mass has changed, of a diagonal mass matrix.
void ancf_table_renew(ancf_table* table, const ancf_model* m, int node);
int ancf_table_add_place(ancf_table* table, const ancf_model* m, int element, double xi);
int ancf_table_add_mean(ancf_table* table, const ancf_model* m, int element,
                        const double power[3]);                                           // of several places
int ancf_table_add_knot(ancf_table* table, const ancf_model* m, int node);                // where an element ends
int ancf_table_add_slope(ancf_table* table, const ancf_model* m, int element, double xi); // a place that takes couples
int ancf_table_add_body(ancf_table* table, const ancf_body* body);
int ancf_table_add_contact(ancf_table* table, const ancf_contact* contact);
int ancf_table_add_coupling(ancf_table* table, const ancf_coupling* coupling);

int ancf_table_contacts(const ancf_table* table); // their number
int ancf_table_awake(const ancf_table* table);    // of them, once it is prepared, that are not left out
int ancf_table_places(const ancf_table* table);
ancf_place* ancf_table_place(ancf_table* table, int i);
void ancf_table_twist_left(double twist[3], const ancf_table* table); // in this step, see ancf_table_apply [N m s]
ancf_body* ancf_table_body(ancf_table* table, int i);
ancf_contact* ancf_table_contact(ancf_table* table, int i);
ancf_coupling* ancf_table_coupling(ancf_table* table, int i);

// Leaves contacts out, and what is at their places, that cannot touch in a step [s]: whose gap is by `margin` larger
// than what closes in one and a quarter of it, at the velocities that ancf_table_prepare gets. `passed`: from the
// middle of the time for which the accelerations of bodies are given to that of the step, where the cable takes several
// steps with what was found for all of them [s]; 0: one. In several, what is not round is never left out.
void ancf_table_rest(ancf_table* table, const ancf_model* m, const double* velocity, double step, double passed);

// Gets ready for a step: velocities of the places from the field `velocity` (3 x stride), and what places do to each
// other. ANCF_E_MEMORY if there is not enough.
ancf_error ancf_table_prepare(ancf_table* table, const ancf_model* m, const double* velocity);

// Ends a step: what contacts owe, sums over all steps since the table was filled, and where bodies are.
void ancf_table_end(ancf_table* table, double step);

// Goes on with the same contacts into the next step of the cable, of the same length, instead of ancf_table_prepare and
// ancf_table_accelerate: where sides and gaps are now, and what contacts owe. m->x is where the cable has come to, m->a
// its acceleration without what is in the table, `velocity` as in ancf_table_prepare. Solids that are not round are
// taken as flat meanwhile. ANCF_E_MEMORY if there is not enough.
ancf_error ancf_table_go_on(ancf_table* table, const ancf_model* m, const double* velocity, double step);

// Accelerations of the places from a field (3 x stride); without this call, none.
void ancf_table_accelerate(ancf_table* table, const ancf_model* m, const double* acceleration);

// Sub-steps that the normal forces need in a step [s], and the contact that needs most; 0: nothing can touch in it.
// Contacts that do not feel these may need fewer.
int ancf_table_substeps(ancf_table* table, double step, int* stiffest);

// Lets the first guess of friction act, evenly through the step, so that normal forces feel it; optional.
void ancf_table_guess(ancf_table* table, double step);

// The normal forces through a step, in `substeps` (0: gaps alone go on), or as many times more or fewer of what each
// needs. Couplings are kept in each. Returns what the forces are off by, as part of the largest of those that feel one
// another.
double ancf_table_press(ancf_table* table, double step, int substeps);

// Friction of all contacts that pressed, at the velocity after it. Returns the number of sweeps and Newton's steps;
// *left is what friction is off by, as part of the largest friction force.
int ancf_table_rub(ancf_table* table, double step, double* left);

// Impulses that make knots and points of bodies go on together from now on; `rest` is the time to the step's end.
void ancf_table_couple(ancf_table* table, double rest);

// The last word on spins and slopes: impulses of normal forces acted where friction has moved things meanwhile. What
// cables without torsion cannot take of that, and of friction between them, is left. Then adds to a field of velocities
// what the table's impulses do, and to a field of displacements what they do besides `step` times that velocity (3 x
// stride each).
void ancf_table_apply(ancf_table* table, const ancf_model* m, double step, double* velocity, double* shift);

// Contacts act while accelerations are even, those of the start of the step; leapfrog's energy goes with the mean of
// those at its start and at its end. So they do late . (a_end - a_start)/2 too much work. ancf_table_end books the
// part of a_start; the next step knows a_end and adds its part by ancf_owed, which gives the `owed` of its contact.
// Contacts give it back where they press.
double ancf_owed(double before, const double late[3], const double changing[3]);

// Adds the table's impulses to a field of forces, over a time [s] (3 x stride), but for those that hold what slides.
void ancf_table_forces(const ancf_table* table, const ancf_model* m, double time, double* force);

// What the table's impulses give to an unknown in this step, before other unknowns share it [N s].
void ancf_table_impulse(double impulse[3], const ancf_table* table, const ancf_model* m, int dof);

// Relative velocity of the first side against the second, as it is now [m/s].
void ancf_table_slip(double v[3], const ancf_table* table, const ancf_contact* contact);

#endif
