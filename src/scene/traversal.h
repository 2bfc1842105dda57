/* The one traversal of the scene graph. Its order: a node, then its operands, then its children in the order in which
 * they were added, once for each of its placements. Flattening, paths, lists of lights, bounds and picking all follow
 * it, so that they agree. A node with several parents is visited on every path to it. The stack is on the heap: only
 * memory limits the depth.
 *
 *   struct scene_traversal t = {.operands = OPERANDS_AS_CHILD, .frame_size = sizeof(struct my_frame)};
 *   scene_traversal_begin(&t, root);
 *   while ((event = scene_traversal_next(&t)) != SCENE_END) ...
 *   scene_traversal_end(&t); */
#ifndef GRAY_SCENE_TRAVERSAL_H
#define GRAY_SCENE_TRAVERSAL_H

#include "scene/node.h"

/* One node of a path. */
struct scene_step {
    const struct node *node;
    uint32_t placement; /* the one of its placements that leads on; counts from 1, 0: it has none */
};

/* Which operands of NODE_CSG are visited. */
enum scene_operands {
    OPERANDS_AS_CHILD,  /* of a clipped or bounded node: the first one, like a child */
    OPERANDS_OF_SOLIDS, /* all, but of a bounded node the first one only: the bound is no part of the solid */
    OPERANDS_ALL
};

enum scene_event {
    SCENE_ENTER,    /* a node, before everything below it */
    SCENE_CHILDREN, /* its children follow, at one of its placements; not of nodes without children */
    SCENE_LEAVE,    /* a node, after everything below it */
    SCENE_END,
    SCENE_NO_MEMORY
};

/* The placement of the children of the last node of a path, from its own placement. */
struct transform scene_step_map(const struct scene_step *step, const struct transform *from_node);

/* Set the first part, the rest to zero. */
struct scene_traversal {
    enum scene_operands operands;
    bool distinct; /* children are visited once, ignoring placements: for functions of nodes, not of paths */
    bool inside;   /* of the root only its operands are visited */
    const uint8_t
        *draws; /* by node->index: nodes with 0 and everything below them are not visited; NULL: visits everything */
    size_t frame_size; /* bytes of the caller's own memory for each node of the path; not initialised */

    /* The path from the root to the node of the last event. */
    struct scene_step *steps;
    uint32_t depth;

    const struct node *root; /* private, from here on */
    char *frames;
    uint32_t capacity;
    bool leaving;
};

void scene_traversal_begin(struct scene_traversal *t, const struct node *root);
enum scene_event scene_traversal_next(struct scene_traversal *t);
/* After SCENE_ENTER: skips everything below this node, and its SCENE_LEAVE. */
void scene_traversal_skip(struct scene_traversal *t);
void scene_traversal_end(struct scene_traversal *t); /* at any time */

/* The node of the last event. */
static inline const struct node *scene_traversal_node(const struct scene_traversal *t) {
    return t->steps[t->depth - 1].node;
}
/* The caller's memory of that node, or of the one so many levels above it (less than depth); until the next event. */
void *scene_traversal_frame(const struct scene_traversal *t, uint32_t levels);
/* Which operand of the node above it that node is; SCENE_CHILD: it is a child, or the root. */
#define SCENE_CHILD UINT32_MAX
uint32_t scene_traversal_operand(const struct scene_traversal *t);

#endif
