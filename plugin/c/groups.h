// Which contacts of a table act on one another within a step, and how.
#ifndef ANCF_GROUPS_H
#define ANCF_GROUPS_H

#include <stdbool.h>
#include <stddef.h>

struct ancf_table;

enum { ANCF_CONTACTS, ANCF_PLACES, ANCF_BODIES, ANCF_ITEMS };

// What feels one another: of each kind of item the entries first .. end - 1 of its list.
typedef struct {
    int first[ANCF_ITEMS], end[ANCF_ITEMS];
    int substeps; // that its normal forces need
    bool slides;  // nodes that slide are among its places
} ancf_contact_group;

typedef struct {
    int n, contacts; // numbers of groups, and of the contacts in them: without those that are idle
    ancf_contact_group* group;
    int* list[ANCF_ITEMS]; // numbers of the table, group by group
    // Velocity of contact other[k] by a unit impulse on contact i, through cables, for k in first[i] .. first[i + 1],
    // itself among them [1/kg].
    int *first, *other;
    double* effect;
    // Scratch: tree and number of the group of places, then bodies; sides of contacts at a place; sums by contact.
    int *root, *number, *head, *next, *touched;
    double* sum;
    // Sizes of the arrays.
    int room_group, room_list[ANCF_ITEMS], room_first, room_other, room_effect;
    int room_root, room_number, room_head, room_next, room_touched, room_sum;
} ancf_groups;

void ancf_groups_free(ancf_groups* groups);

// False: out of memory.
bool ancf_groups_make(ancf_groups* groups, const struct ancf_table* table);

#endif
