/* The materials of a world, and their textures. */
#ifndef GRAY_WORLD_FLATTEN_MATERIAL_INTERNAL_H
#define GRAY_WORLD_FLATTEN_MATERIAL_INTERNAL_H

#include "world/flatten_internal.h"

/* Index of a node's effective material: its texture over its material; without one that of the CSG solid it is a part
 * of (`inherited`, may be NULL), else plain gray. A mesh with several material slots has *count of them in a row, from
 * *out on; everything else has 1. */
bool flatten_material(struct flattening *f, const struct node *node, const struct material *inherited, uint32_t *out,
                      uint32_t *count);
/* The world's own materials, flat copies of the authored ones, with their textures. Errors: no memory. */
bool flatten_surfaces(struct flattening *f);

/* Warns "node 'NAME' WHAT", with the line of the script, once for each node. */
void flatten_warn_once(struct flattening *f, const struct node *node, const char *what);

#endif
