// The elements in tiles: runs that one kernel computes while what it needs stays in the cache.
#ifndef ANCF_TILE_H
#define ANCF_TILE_H

#include "kernel.h"

enum { ANCF_TILE = 64 }; // elements at most

// Divides the elements into m->tile, and lists what no tile moves on its own: m->seam and m->knots. After the mass has
// been made, as tiles with equal constants are told. False: out of memory.
bool ancf_tiles_make(ancf_model* m);

// What a tile's kernel reads at a state (x, v), and where it leaves the forces on (r1 - r0)/L; d, dv, on: room for it.
ancf_fields ancf_tile_fields(const ancf_model* m, const ancf_tile* tile, const double* x, const double* v,
                             double d[3][ANCF_TILE], double dv[3][ANCF_TILE], double on[3][ANCF_TILE]);

// Forces on the ends of all elements of a tile, from `on` = those of the kernel on (r1 - r0)/L, into m->pull; of a
// chain those of its first and last element alone if `ends`.
void ancf_tile_keep(const ancf_model* m, const ancf_tile* tile, double on[3][ANCF_TILE], bool ends);

// Sum of what ends at the nodes begin .. end-1, into a field.
void ancf_tile_gather(double* force, const ancf_model* m, int begin, int end);

#endif
