// The elements in tiles: runs that one kernel computes while what it needs stays in the cache.
#ifndef ANCF_TILE_H
#define ANCF_TILE_H

#include "kernel.h"

// Divides the elements into m->tile, and lists what no tile moves on its own: m->seam and m->knots. After the mass has
// been made, as tiles with equal constants are told. False: out of memory.
bool ancf_tiles_make(ancf_model* m);

// Lets the tile of an element have constants of its own: those that were like it are no longer.
void ancf_tiles_part(ancf_model* m, int element);

// What a tile's kernel reads at a state (x, v); way, wayv: room for it. Forces on nodes go to m->pull.
ancf_fields ancf_tile_fields(const ancf_model* m, const ancf_tile* tile, const double* x, const double* v,
                             double way[3][ANCF_TILE], double wayv[3][ANCF_TILE]);

// Its rates of another velocity.
void ancf_tile_rates(ancf_fields* fields, const ancf_model* m, const ancf_tile* tile, const double* v,
                     double wayv[3][ANCF_TILE]);

// Sums of m->pull at the nodes begin .. end-1, into a field.
void ancf_tile_gather(double* force, const ancf_model* m, int begin, int end);

#endif
