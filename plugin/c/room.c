#include "internal.h"

#include <stdlib.h>

bool ancf_reserve(void** items, int* room, int n, size_t size) {
    if (n <= *room) return true;
    const int wanted = n > *room + *room / 2 ? n : *room + *room / 2;
    void* grown = realloc(*items, (size_t)wanted * size);
    if (!grown) return false;
    *items = grown;
    *room = wanted;
    return true;
}
