/* node:bounds(): the box round everything under a node, by a walk over all paths below it. Vertices of meshes are
 * mapped one by one, so that the box is tight under any transform; nodes that place millions of things are measured
 * more coarsely or refused, so that the answer never takes longer than a moment. */
#include "script/actions.h"
#include "script/context.h"

enum { DEPTH_LIMIT = 2000, STEPS = 1 << 24 };

struct measuring {
    long long steps; /* left */
    struct error *error;
};

static bool measure(struct measuring *m, const struct node *node, const struct transform *map, int depth,
                    struct box *box);

/* What is round the operands of a combined solid, as far as it can be said without looking at their surfaces. */
static bool measure_csg(struct measuring *m, const struct node *node, const struct transform *map, int depth,
                        struct box *box) {
    for (uint32_t k = 0; k < node->operand_count; k++) {
        struct box one;
        bool first_alone = node->operation == NODE_DIFFERENCE || node->operation == NODE_INVERSE;
        if (k > 0 && first_alone)
            break;
        if (!measure(m, node->operands[k], map, depth + 1, &one))
            return false;
        *box = k == 0 ? one : node->operation == NODE_UNION ? box_join(*box, one) : box_meet(*box, one);
    }
    if (box_is_empty(box))
        *box = box_empty();
    return true;
}

/* What the node is itself, without its children. */
static bool measure_self(struct measuring *m, const struct node *node, const struct transform *map, int depth,
                         struct box *box) {
    *box = box_empty();
    if (node->kind == NODE_CSG)
        return measure_csg(m, node, map, depth, box);
    if (node->kind != NODE_GEOMETRY)
        return true;
    uint32_t faces = node->shape.kind == SHAPE_MESH ? mesh_face_count(node->shape.mesh) : 0;
    bool exact = faces > 0 && faces < m->steps / 2;
    m->steps -= exact ? faces : 0;
    *box = exact ? mesh_bounds_under(node->shape.mesh, &map->forward) : shape_bounds_under(&node->shape, &map->forward);
    return true;
}

static bool measure_children(struct measuring *m, const struct node *node, const struct transform *map, int depth,
                             struct box *box) {
    for (const struct node_child *child = node->first_child; child; child = child->next) {
        struct box below;
        if (!measure(m, child->node, map, depth + 1, &below))
            return false;
        *box = box_join(*box, below);
    }
    return true;
}

static bool measure(struct measuring *m, const struct node *node, const struct transform *map, int depth,
                    struct box *box) {
    *box = box_empty();
    if (node->singular)
        return true;
    if (depth > DEPTH_LIMIT)
        return error_set(m->error, ERROR_SCENE, "nodes are nested more than %d deep, or in a cycle", DEPTH_LIMIT);
    if (--m->steps < 0)
        return error_set(m->error, ERROR_SCENE, "more than %d things are under this node", STEPS);
    struct transform parent_from_node = node_parent_from_node(node);
    struct transform own = transform_compose(map, &parent_from_node);
    if (!measure_self(m, node, &own, depth, box))
        return false;
    uint32_t rounds = node->placements ? node->placements->count : 1;
    for (uint32_t i = 0; i < rounds && node->first_child; i++) {
        struct transform map_of_children = own;
        if (node->placements) {
            struct transform node_from_child = placement_transform(node->placements, i);
            map_of_children = transform_compose(&own, &node_from_child);
        }
        if (!measure_children(m, node, &map_of_children, depth, box))
            return false;
    }
    return true;
}

bool act_bounds(struct context *context, const struct value *args, struct result *result, struct error *error) {
    struct measuring m = {.steps = STEPS, .error = error};
    struct transform identity = transform_identity();
    struct box *box = arena_alloc(&context->call, sizeof *box);
    if (!box)
        return error_no_memory(error, "a box");
    if (!measure(&m, args[SELF].node, &identity, 0, box))
        return false;
    if (box_is_empty(box))
        return error_set(error, ERROR_SCENE, "nothing is under this node");
    result->pointer = box;
    return true;
}
