/* Which primitives each light reaches, from its lists of nodes. */
#ifndef GRAY_WORLD_LIGHT_LISTS_H
#define GRAY_WORLD_LIGHT_LISTS_H

#include "world/world.h"

/* Fills `lit` of every light that has a list: a primitive counts as listed when its node or any node on the way to it
 * from the root is. After flattening. lights: the world's own copy. Errors: no memory. */
bool light_lists_resolve(const struct world *world, struct light *lights, struct arena *arena, const struct node *root,
                         struct error *error);

/* Sets lit[i] to `value` for every primitive i that comes from a listed node or one below it. False: no memory.
 */
bool light_lists_mark(const struct world *world, const struct node *const *list, uint32_t count, uint8_t *lit,
                      uint8_t value, const struct node *root);

#endif
