/* The box around everything under a node, by the traversal of all paths below it. */
#ifndef GRAY_SCENE_NODE_BOUNDS_H
#define GRAY_SCENE_NODE_BOUNDS_H

#include "base/error.h"
#include "math/box.h"
#include "scene/node.h"

/* In the space of its parents; empty where nothing is drawn. Vertices of meshes are mapped one by one, so that the box
 * is tight under any transform; nodes with millions of objects are measured more coarsely or refused, so that the query
 * is always fast. Combined solids are measured by their operands. Errors: too deep, too much, no memory. */
bool node_bounds(const struct node *node, struct box *out, struct error *error);
/* The same of what a picture can frame: endless parts such as planes do not count. */
bool node_finite_bounds(const struct node *node, struct box *out, struct error *error);

#endif
