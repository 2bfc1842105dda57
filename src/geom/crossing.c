/* The stack of crossings of one worker. It is grown only between rays, so that pointers and indices into it hold while
 * a ray is being answered. */
#include "geom/crossing.h"

#include "base/mem.h"

bool geom_scratch_init(struct geom_scratch *scratch, uint32_t capacity) {
    *scratch = (struct geom_scratch){0};
    if (capacity < 16)
        capacity = 16;
    scratch->items = mem_resize_array(NULL, capacity, sizeof *scratch->items);
    if (!scratch->items)
        return false;
    scratch->capacity = capacity;
    return true;
}

void geom_scratch_destroy(struct geom_scratch *scratch) {
    mem_free(scratch->items);
    scratch->items = NULL;
    scratch->capacity = scratch->used = 0;
}

bool geom_scratch_grow(struct geom_scratch *scratch) {
    if (scratch->capacity > UINT32_MAX / 2)
        return false;
    uint32_t capacity = scratch->capacity ? scratch->capacity * 2 : 16;
    struct crossing *items = mem_resize_array(scratch->items, capacity, sizeof *items);
    if (!items)
        return false;
    scratch->items = items;
    scratch->capacity = capacity;
    scratch->used = 0;
    scratch->overflow = false;
    return true;
}
