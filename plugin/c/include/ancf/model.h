// A set of cables and nets: nodes joined by elements.
//
// Unknowns. A node has a position, an element a slope dr/ds at either end. Slopes belong to their element's end, so
// that a whole model is computed lane by lane; where a cable goes on smoothly from one element into the next, both
// carry the same slope and it moves as one (`next`). A position, velocity or force of the whole model is one array
// of three blocks, x, y and z, each `stride` long:
//     [0, n_nodes)                          nodes
//     [n_nodes, n_nodes + n_elements)       slopes at the starts
//     [.. + n_elements)                     slopes at the ends
#ifndef ANCF_MODEL_H
#define ANCF_MODEL_H

#include "error.h"
#include <stdbool.h>

// What an element is made of; the sum of these bits.
enum {
    ANCF_SPRING = 1,          // tension-only spring and damper instead of a beam (Eq. 1)
    ANCF_LUMPED = 2,          // diagonal mass
    ANCF_AXIAL_REDUCED = 4,   // axial energy by 3 Gauss points instead of exactly
    ANCF_CURVATURE_EXACT = 8, // bending by kappa = |r' x r''|/|r'|^2 instead of |r''|
    ANCF_ENGINEERING = 16,    // axial strain |r'| - 1 instead of (r'.r' - 1)/2; of springs always
};

typedef struct {
    int kind;       // bits above
    double length;  // unstressed [m]
    double ea;      // axial stiffness [N]
    double ei;      // bending stiffness [N m2]; 0: none is computed
    double rho_a;   // mass per length [kg/m]
    double damping; // Kelvin-Voigt time [s]; 0: none is computed
    double drag;    // mass-proportional damping [1/s]; 0: none is computed
} ancf_element;

// How a node moves, and how a slope does.
typedef enum {
    ANCF_FREE,
    ANCF_HELD, // its new velocity is given: fixed, following a body, clamped
} ancf_hold;

// A node that goes along a straight line alone, which stands still; nothing rubs, and what holds it has no mass.
typedef struct {
    int node;
    double along[3]; // unit vector
    double at[3];    // a point of the line [m]
} ancf_slide;

typedef struct {
    int n_nodes, n_elements;
    const ancf_element* element; // (n_elements)
    const int* ends;             // (n_elements x 2) node numbers
    const int* next;             // (n_elements) element into which this one goes on smoothly, or -1
    const double* mass;          // (n_nodes) added mass [kg], NULL: none
    const int* hold;             // (n_nodes + 2 n_elements) ancf_hold of every unknown, NULL: all free
    int n_slides;
    const ancf_slide* slide; // (n_slides) of nodes that are free
} ancf_def;

// A run of elements that are computed together: of one kind, and with every slope of its own but the first and the
// last.
typedef struct {
    int begin, end;
    int kind;
    bool bending, damped;
    int joined;                  // number of slopes that go on smoothly from one into the next
    bool start_moves, end_moves; // its first slope, its last; else they belong to a seam
    bool chain;                  // nodes follow one another, and nothing else meets those between its elements
    int like;                    // tile with equal constants, itself or one before
    int seam, knots;             // numbers of the first whose last tile this is
} ancf_tile;

// What tiles do not move on their own, and the first and last tile that it takes.
typedef struct {
    int place[2]; // of a slope, and of the other copy of one that is shared, or -1
    int first, last;
} ancf_seam;

typedef struct {
    int begin, end; // nodes
    int first, last;
} ancf_knots;

typedef struct ancf_mass ancf_mass;

// To be read, not written, outside plugin/c, except x, v, held, external, gravity and unloaded.
typedef struct {
    int n_nodes, n_elements;
    int n_dof;  // n_nodes + 2 n_elements
    int stride; // length of a block, n_dof rounded up
    ancf_element* element;
    int* ends; // (n_elements x 2)
    int* next; // (n_elements)
    int* hold; // (n_dof) ancf_hold
    int n_shared, n_held;
    int* shared;  // (n_shared x 2) places of the two copies of a shared slope in a block
    int* is_held; // (n_held) places of what is held
    int n_slides;
    ancf_slide* slide; // (n_slides)
    int* slide_of;     // (n_nodes) number of a node's slide, or -1; NULL: there are none
    struct ancf_sliding* sliding;
    int n_tiles;
    ancf_tile* tile;
    int n_seams, n_knots;
    ancf_seam* seam;   // (n_seams), sorted by last
    ancf_knots* knots; // (n_knots), sorted by last

    // Elements meeting at a node: end k = 2 e + (0 start, 1 end), for k in at[first[i]] .. at[first[i+1]].
    int* first;   // (n_nodes + 1)
    int* at;      // (2 n_elements)
    double* sign; // (2 n_elements) 1 where an element ends, -1 where it starts

    // Per element, so that the kernels divide by nothing (n_elements each).
    double *inv_length, *ea_length, *ei_length; // 1/L, EA L/4, EI/L
    double* damping;                            // Kelvin-Voigt time [s]
    double* goes_on;                            // 1 where the slope at the end goes on within the tile, else 0

    ancf_mass* mass;
    double* weight; // (n_dof) gravity's force is weight g [kg or kg m]
    double gravity[3];
    bool unloaded;           // external is zero, and is not read
    bool dragged;            // some elements have mass-proportional damping
    bool track;              // elastic and what follows are wanted
    double elastic;          // energy at the positions that the last step started from [J]
    double damping_power[2]; // of Kelvin-Voigt forces and drag in the last step, at the velocities before and after [W]
    double damping_work;     // taken out by them so far [J]
    double damping_half;     // of that, before the positions that the last step started from [J]

    double *x, *v;    // state, (3 x stride) each: positions [m], slopes [-], and their rates. The caller's.
    double* external; // (3 x stride) forces that act besides those computed here [N, N m]
    double* held;     // (3 x stride) new velocity of what is held
    double *f, *a;    // (3 x stride) force and acceleration of the last step
    double* free;     // (3 x stride) mean velocity of the step ahead without friction
    double* pull;     // (3 x n_elements) forces of the elements on their end nodes; on start nodes the other way [N]
    double* work;     // (6 x 3 x stride) for RK4, equilibrium, momentum, kinetic energy
} ancf_model;

// Builds a model on the caller's state arrays x and v ((3 x ancf_stride(def)) each, laid out as above). On an error
// nothing is left behind, *model is NULL and *where is the number of the node or element at fault.
ancf_error ancf_model_create(ancf_model** model, const ancf_def* def, double* x, double* v, int* where);
void ancf_model_destroy(ancf_model* model);

// What ancf_model_create refuses, but for what only shows when memory and a factor are needed.
ancf_error ancf_model_check(const ancf_def* def, const double* x, const double* v, int* where);

int ancf_stride(int n_nodes, int n_elements);

// Numbers of an element's unknowns in a block: (start node, start slope, end node, end slope).
static inline void ancf_model_dofs(int dof[4], const ancf_model* m, int element) {
    dof[0] = m->ends[2 * element];
    dof[1] = m->n_nodes + element;
    dof[2] = m->ends[2 * element + 1];
    dof[3] = m->n_nodes + m->n_elements + element;
}

// The other copy of a slope that goes on from one element into the next, or -1.
int ancf_model_twin(const ancf_model* m, int dof);

// Value at xi of element e of the field whose blocks are at `field` (m->x gives the position, m->v the velocity).
void ancf_model_at(double value[3], const ancf_model* m, const double* field, int element, double xi);

// Its mean over several places, from the means of their xi, xi^2 and xi^3.
void ancf_model_mean_at(double value[3], const ancf_model* m, const double* field, int element, const double power[3]);

// Makes both copies of every shared slope the sum of the two, as a force on the one slope is.
void ancf_model_join(const ancf_model* m, double* force);

#endif
