/* Data of lights from the scene: the triangles of meshes, the tables of skies. */
#ifndef GRAY_WORLD_MESH_LIGHTS_INTERNAL_H
#define GRAY_WORLD_MESH_LIGHTS_INTERNAL_H

#include "world/flatten_internal.h"
#include "world/world.h"

/* Fills `mesh` and `table` of the lights that are meshes and skies. After flattening, with the same f; lights: the
 * world's own copy of what was authored. Meshes that are not in the scene emit invisibly, at the pose of the light's
 * node and of the nodes between it and them. Errors: no memory; a node without a mesh; those of flatten_scene for a
 * node that is not in the scene. Warnings: a mesh lamp without light. A sky with a pending rotation is rotated, also as
 * the background if it is the same. */
bool mesh_lights_resolve(struct flattening *f, const struct scene_light *authored, struct light *lights,
                         const struct node *root);
/* Sets `mesh` of a light that is only one primitive, a mesh, with the emission of its materials. Errors: no memory. */
bool mesh_lights_primitive(const struct world *world, uint32_t primitive, struct light *light, struct arena *arena,
                           struct error *error);
/* Replaces `mesh` of a light over primitives of the world: each triangle has its own mean emission, as far as a few
 * filtered points show it, and at least a small part of that of its material. For textures, whose mean over a whole
 * mesh is a poor estimate for one triangle. Errors: no memory, cancelled. */
bool mesh_lights_estimate(const struct world *world, struct light *light, struct arena *arena, struct pool *pool,
                          struct error *error);

/* Which primitives each light illuminates, from its lists of nodes. */

/* Fills `lit` of every light that has a list: a primitive counts as listed if its node or any ancestor on its path is.
 * After flattening. lights: the world's own copy. Errors: no memory. */
bool light_lists_resolve(const struct world *world, const struct scene_light *authored, struct light *lights,
                         struct arena *arena, const struct node *root, struct error *error);

/* Sets lit[i] to `value` for every primitive i that comes from a listed node or one below it. False: no memory. */
bool light_lists_mark(const struct world *world, const struct node *const *list, uint32_t count, uint8_t *lit,
                      uint8_t value, const struct node *root);

#endif
