// Impulses or forces of contacts that feel one another, all at once.
#ifndef ANCF_NEWTON_H
#define ANCF_NEWTON_H

// Contacts, and room for numbers that they need beside W.
enum { ANCF_NEWTON_MOST = 128, ANCF_NEWTON_ROOM = (4 * ANCF_NEWTON_MOST + 9) * ANCF_NEWTON_MOST };

// What n contacts answer to velocities, in one direction each, or in two. `answer` falls with the velocity; `root` is
// the root of minus its derivative, in two directions xx, xy, yy.
typedef struct {
    int n, size;
    void (*answer)(double* F, const void* law, int contact, const double* v);
    void (*root)(double R[3], const void* law, int contact, const double* v);
    const void* law;
} ancf_newton_laws;

// P that belong to v = v0 + W P, W symmetric and without negative eigenvalues. In and out: P, and v with it. Ends when
// no contact is off by more than `enough`; *left is by how much one is. Returns the number of steps. Scratch:
// ANCF_NEWTON_ROOM.
int ancf_newton(double* P, double* v, double* left, const ancf_newton_laws* laws, const double* W, double enough,
                double* scratch);

#endif
