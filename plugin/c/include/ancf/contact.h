// Friction between cables and bodies, solved at the new velocity.
//
// Explicit friction would need a step of 2 m v0/((2 mu_s - mu_k) f_n); here every contact's friction is the one that
// belongs to the velocity after it has acted, all contacts together, by Gauss-Seidel over the table.
#ifndef ANCF_CONTACT_H
#define ANCF_CONTACT_H

#include "law.h"
#include "model.h"

// A body that cables touch.
typedef struct {
    double position[3], velocity[3], spin[3]; // as they will be without friction [m], [m/s], [rad/s]
    double inv_mass[3];                       // per axis, 0 where it cannot move [1/kg]
    double inv_inertia[9];                    // world axes, row by row; 0 where it cannot turn [1/(kg m2)]
    double along[3]; // direction of a straight guide over the root of the mass on it; 0: none [1/sqrt(kg)]
} ancf_partner;

// A point on a cable, and the response of the model to a unit force there (ancf_mass_response).
typedef struct {
    int element;
    double xi;
    int place[4];     // of its element's unknowns in a block
    double S[4];      // their weights at xi
    int n;            // unknowns that move
    const int* dof;   // (n)
    const double* dv; // (n) their acceleration under 1 N
    double compliance;
} ancf_point;

typedef struct {
    const ancf_point* point; // on a cable
    const ancf_point* other; // what it touches: a cable (or NULL),
    ancf_partner* partner;   // a body (or NULL), or both: a body that moves with a knot and turns on its own
    double normal[3];        // unit vector
    double normal_force;     // elastic part, >= 0 [N]
    double normal_damping;   // its dashpot c [N s/m], which acts at the new velocity too; 0: none
    const ancf_friction* law;
    double friction[3];   // in: first guess. out: force on `point` [N]; its opposite acts on the other side
    double damping_force; // in: first guess. out: what the dashpot adds to normal_force, the sum never below 0 [N]
} ancf_contact;

// Sets element, xi, place and S.
void ancf_point_place(ancf_point* point, const ancf_model* m, int element, double xi);

// Value of a field at a point, S(xi) e.
static inline void ancf_point_at(double value[3], const ancf_model* m, const double* field, const ancf_point* point) {
    const int* i = point->place;
    const double* S = point->S;
    for (int c = 0; c < 3; ++c) {
        const double* u = field + c * m->stride;
        value[c] = S[0] * u[i[0]] + S[1] * u[i[1]] + S[2] * u[i[2]] + S[3] * u[i[3]];
    }
}

// Positions and velocities of n points, (n x 3) each.
void ancf_points_motion(double* position, double* velocity, const ancf_model* m, const ancf_point* point, int n);

// Adds the force F at a point to the generalised force, Q = S(xi)^T F (Eq. 16).
static inline void ancf_point_add_force(const ancf_model* m, double* force, const ancf_point* point,
                                        const double F[3]) {
    for (int c = 0; c < 3; ++c)
        for (int k = 0; k < 4; ++k) force[c * m->stride + point->place[k]] += point->S[k] * F[c];
}

// Solves friction and damping of n contacts for a kick of length dt [s]. velocity (3 x stride): in the free velocity,
// out the velocity after friction. Returns the number of sweeps.
int ancf_contact_solve(const ancf_model* m, ancf_contact* table, int n, double dt, double* velocity);

#endif
