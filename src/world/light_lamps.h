/* What lamps need to know about the scene: the triangles of meshes, the tables of skies. */
#ifndef GRAY_WORLD_LIGHT_LAMPS_H
#define GRAY_WORLD_LIGHT_LAMPS_H

#include "world/world.h"

/* Fills `mesh` and `table` of the lights that are meshes and skies. After flattening; lights: the world's own copy. A
 * mesh that is not in the scene stands where its own transforms put it, unseen. Errors: no memory; a node without a
 * mesh. Warnings: a mesh lamp without light. A sky that is to be turned is, and behind everything, too, if it is seen
 * there. */
bool light_lamps_resolve(struct world *world, struct light *lights, struct arena *arena, const struct node *root,
                         struct pool *pool, world_warning *warn, void *warn_context, struct error *error);

#endif
