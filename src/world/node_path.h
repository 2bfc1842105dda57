/* The path from the root to a primitive. A primitive has its node, but a node may have several parents and many
 * transforms: the traversal of flattening finds the path. */
#ifndef GRAY_WORLD_NODE_PATH_H
#define GRAY_WORLD_NODE_PATH_H

#include "scene/traversal.h"
#include "world/world.h"

/* The traversal of flattening, over a tree that has not changed since; the caller sets frame_size and ends it. */
struct scene_traversal world_traversal(const struct world *world, const struct node *root, size_t frame_size);
/* The number of primitives, from number `next` on, of this node at its next visit. */
uint32_t world_primitives_of(const struct world *world, const struct node *node, uint32_t next);

/* Called in flattening order: primitives first .. first + count - 1 are those of the last node of the path. Returns
 * false to end the traversal. */
typedef bool node_path_visit(void *context, uint32_t first, uint32_t count, const struct scene_step *steps,
                             uint32_t depth);

/* The tree must be the one the world was built of, unchanged. A node that one clip removes completely and the next does
 * not is reported with the earlier path. False: no memory. */
bool world_visit_node_paths(const struct world *world, const struct node *root, node_path_visit *visit, void *context,
                            struct error *error);

/* "root#0 / tree#7 [3] / leaf#9": names with their order of creation, and which placement; "added cube#1": the first
 * node that was added in the window. Control characters become '?'. Cut at `size`; returns the length it would have. */
size_t node_path_text(const struct scene_step *steps, uint32_t depth, char *out, size_t size);

struct primitive_list {
    const uint32_t *numbers;
    uint32_t count;
};
/* As texts in the arena: out[i] is the path to the primitive primitives.numbers[i], in ascending order. NULL if
 * there is none. */
bool world_find_node_paths(const struct world *world, const struct node *root, struct primitive_list primitives,
                           struct arena *arena, const char **out, struct error *error);

/* Inside of combined solids (NODE_CSG): every node under a solid, reported after its descendants. steps: the path to
 * it, without the solid; its leaves, and those of its descendants, have origin first .. end - 1 (csg_leaf.origin).
 * Paths of more than OPERAND_DEPTH nodes are not reported. The visit returns false to end the traversal. False: no
 * memory. */
enum { OPERAND_DEPTH = 256 };
typedef bool world_operand_visit(void *context, uint32_t first, uint32_t end, const struct scene_step *steps,
                                 uint32_t depth);
bool world_visit_operands(const struct node *solid, world_operand_visit *visit, void *context);
/* The path to the shape of a leaf; steps has room for `capacity`. length: 0: there is none, or it is longer. False: no
 * memory. */
bool world_operand_path(const struct node *solid, uint32_t origin, struct scene_step *steps, uint32_t capacity,
                        uint32_t *length);

#endif
