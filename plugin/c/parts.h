// Contacts of a group that rub, in parts that are solved at once: t->rubbing and t->part.
#ifndef ANCF_PARTS_H
#define ANCF_PARTS_H

#include "table.h"

// Lists the contacts of a group that are not marked as listed, in parts of one body each, of one element each where
// they move no body; neighbours after one another. Returns their number.
int ancf_parts_list(ancf_table* t, const ancf_contact_group* g);

// Joins parts that follow one another, up to `most` contacts.
void ancf_parts_join(ancf_table* t, int most);

#endif
