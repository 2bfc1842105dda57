/* From a CSG node to one postfix program: operands are closed geometry, other CSG nodes or groups, which count as the
 * union of what is under them. An operand without any surface is the empty set and disappears by the algebra
 * (A u 0 = A, A n 0 = 0, A - 0 = A, 0 - A = 0). */
#include "world/flatten.h"

#include "base/mem.h"

enum { CSG_NESTING = 10000, CSG_LEAVES = 65535 };

struct csg_draft {
    struct csg_leaf *leaves;
    struct csg_token *program;
    uint32_t leaf_count, leaf_capacity, length, capacity;
};

static bool add_token(struct flattening *f, struct csg_draft *draft, struct csg_token token) {
    if (draft->length == draft->capacity) {
        uint32_t capacity = draft->capacity ? draft->capacity * 2 : 16;
        struct csg_token *program = mem_resize_array(draft->program, capacity, sizeof *program);
        if (!program)
            return error_no_memory(f->error, "a CSG program");
        draft->program = program;
        draft->capacity = capacity;
    }
    draft->program[draft->length++] = token;
    return true;
}

static bool tell_open(struct flattening *f, const struct node *node) {
    struct vec3 a = {0}, b = {0};
    if (node->shape.kind == SHAPE_MESH && mesh_open_edge(node->shape.mesh, &a, &b))
        return error_set(f->error, ERROR_SCENE,
                         "node '%.100s' is an operand of CSG but its mesh is open: the edge from (%g, %g, %g) to "
                         "(%g, %g, %g) belongs to one face only, or to faces that disagree about the outside",
                         node->name, a.x, a.y, a.z, b.x, b.y, b.z);
    return error_set(f->error, ERROR_SCENE, "node '%.100s' is an operand of CSG but %s", node->name,
                     shape_why_open(&node->shape));
}

static bool add_leaf(struct flattening *f, struct csg_draft *draft, struct node *node,
                     const struct transform *csg_from_node, const struct material *inherited) {
    if (!shape_is_closed(&node->shape))
        return tell_open(f, node);
    if (draft->leaf_count == CSG_LEAVES)
        return error_set(f->error, ERROR_SCENE, "a CSG solid has more than %d operands", CSG_LEAVES);
    if (draft->leaf_count == draft->leaf_capacity) {
        uint32_t capacity = draft->leaf_capacity ? draft->leaf_capacity * 2 : 16;
        struct csg_leaf *leaves = mem_resize_array(draft->leaves, capacity, sizeof *leaves);
        if (!leaves)
            return error_no_memory(f->error, "the operands of a CSG solid");
        draft->leaves = leaves;
        draft->leaf_capacity = capacity;
    }
    struct csg_leaf leaf = {.shape = node->shape, .csg_from_leaf = *csg_from_node};
    if (!flatten_mesh_index(f, &node->shape) || !flatten_material(f, node, inherited, &leaf.material, &leaf.slot_count))
        return false;
    draft->leaves[draft->leaf_count] = leaf;
    return add_token(f, draft, (struct csg_token){.operation = CSG_LEAF, .leaf = (uint16_t)draft->leaf_count++});
}

static bool add_operand(struct flattening *f, struct csg_draft *draft, struct node *node,
                        const struct transform *csg_from_parent, const struct material *inherited, int nesting,
                        bool *empty);

/* The node's operation over its two operands, in csg space. Its material goes to what has none under it. */
static bool add_operation(struct flattening *f, struct csg_draft *draft, struct node *node,
                          const struct transform *csg_from_node, const struct material *inherited, int nesting,
                          bool *empty) {
    inherited = node->material ? node->material : inherited;
    bool first_empty = true, second_empty = true;
    uint32_t start = draft->length, leaves = draft->leaf_count;
    if (!add_operand(f, draft, node->operands[0], csg_from_node, inherited, nesting + 1, &first_empty))
        return false;
    uint32_t middle = draft->length, middle_leaves = draft->leaf_count;
    if (!add_operand(f, draft, node->operands[1], csg_from_node, inherited, nesting + 1, &second_empty))
        return false;
    enum csg_operation operation = CSG_UNION;
    switch (node->operation) {
    case NODE_UNION:
        break;
    case NODE_INTERSECTION:
        operation = CSG_INTERSECTION;
        break;
    case NODE_DIFFERENCE:
        operation = CSG_DIFFERENCE;
        break;
    }
    if (!first_empty && !second_empty) {
        *empty = false;
        return add_token(f, draft, (struct csg_token){.operation = operation});
    }
    *empty = operation == CSG_UNION ? first_empty && second_empty : operation == CSG_DIFFERENCE ? first_empty : true;
    if (*empty) {
        draft->length = start;
        draft->leaf_count = leaves;
    } else if (second_empty) {
        draft->length = middle;
        draft->leaf_count = middle_leaves;
    }
    return true;
}

static bool add_children(struct flattening *f, struct csg_draft *draft, struct node *node,
                         const struct transform *csg_from_node, const struct material *inherited, int nesting,
                         bool *empty) {
    for (struct node_child *child = node->first_child; child; child = child->next) {
        bool child_empty;
        if (!add_operand(f, draft, child->node, csg_from_node, inherited, nesting + 1, &child_empty))
            return false;
        if (!child_empty && !*empty && !add_token(f, draft, (struct csg_token){.operation = CSG_UNION}))
            return false;
        *empty = *empty && child_empty;
    }
    return true;
}

/* Everything under a node as one operand: its own surface and its children, united. */
static bool add_operand(struct flattening *f, struct csg_draft *draft, struct node *node,
                        const struct transform *csg_from_parent, const struct material *inherited, int nesting,
                        bool *empty) {
    *empty = true;
    if (nesting > CSG_NESTING)
        return error_set(f->error, ERROR_SCENE, "CSG solids are nested more than %d deep", CSG_NESTING);
    if (node->singular)
        return true;
    if (node_moves(node))
        return error_set(f->error, ERROR_SCENE,
                         "node '%.100s' moves inside of a combined solid; only the solid as a whole can move",
                         node->name);
    struct transform parent_from_node = node_parent_from_node(node);
    struct transform csg_from_node = transform_compose(csg_from_parent, &parent_from_node);
    if (node->kind == NODE_GEOMETRY) {
        bool nothing = node->shape.kind == SHAPE_MESH && mesh_triangle_count(node->shape.mesh) == 0;
        if (!nothing && !add_leaf(f, draft, node, &csg_from_node, inherited))
            return false;
        *empty = nothing;
    } else if (node->kind == NODE_CSG) {
        if (!add_operation(f, draft, node, &csg_from_node, inherited, nesting, empty))
            return false;
    }
    uint32_t rounds = node->placements ? node->placements->count : 1;
    for (uint32_t i = 0; i < rounds && node->first_child; i++) {
        struct transform csg_from_child = csg_from_node;
        if (node->placements) {
            struct transform node_from_child = placement_transform(node->placements, i);
            csg_from_child = transform_compose(&csg_from_node, &node_from_child);
        }
        if (!add_children(f, draft, node, &csg_from_child, inherited, nesting, empty))
            return false;
    }
    return true;
}

bool flatten_csg(struct flattening *f, struct node *node, const struct csg **out) {
    struct csg_draft draft = {0};
    bool empty = true;
    struct transform identity = transform_identity();
    *out = NULL;
    bool ok = add_operation(f, &draft, node, &identity, NULL, 0, &empty);
    if (ok && !empty) {
        *out = csg_build(f->arena, draft.leaves, draft.leaf_count, draft.program, draft.length, f->error);
        ok = *out != NULL;
    }
    mem_free(draft.leaves);
    mem_free(draft.program);
    return ok;
}
