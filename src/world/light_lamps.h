/* What lamps need to know about the scene: the triangles of meshes, the tables of skies. */
#ifndef GRAY_WORLD_LIGHT_LAMPS_H
#define GRAY_WORLD_LIGHT_LAMPS_H

#include "world/flatten.h"

/* Fills `mesh` and `table` of the lights that are meshes and skies. After flattening, with the same f; lights: the
 * world's own copy. Meshes that are not in the scene emit invisibly, at the pose of the light's node and of the nodes
 * between it and them. Errors: no memory; a node without a mesh; those of flatten_scene for a node that is not in the
 * scene. Warnings: a mesh lamp without light. A sky that is to be turned is, and behind everything, too, if it is seen
 * there. */
bool light_lamps_resolve(struct flattening *f, struct light *lights, const struct node *root);
/* Sets `mesh` of a light that is one placed mesh alone, with the emission of its materials. Errors: no memory. */
bool light_lamps_primitive(const struct world *world, uint32_t primitive, struct light *light, struct arena *arena,
                           struct error *error);

#endif
