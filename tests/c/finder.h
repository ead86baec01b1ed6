// What finds contacts of cables with cables: boxes, motions, pairs of segments, contacts.
#ifndef TESTS_C_FINDER_H
#define TESTS_C_FINDER_H

#include "ancf/cross.h"

#include <stdbool.h>

typedef struct {
    ancf_boxes* boxes;
    ancf_motion* motion;
    ancf_apart* apart;
    ancf_table* table;
} finder;

// False: one could not be made; finder_end() frees the others.
static inline bool finder_start(finder* f, const ancf_model* m, const ancf_cover* cover) {
    *f = (finder) {0};
    return !ancf_boxes_create(&f->boxes, m, cover) && !ancf_motion_create(&f->motion, m) &&
           !ancf_apart_create(&f->apart, m, cover, f->motion) && !ancf_table_create(&f->table, m);
}

static inline void finder_end(finder* f) {
    ancf_boxes_destroy(f->boxes);
    ancf_apart_destroy(f->apart);
    ancf_motion_destroy(f->motion);
    ancf_table_destroy(f->table);
}

#endif
