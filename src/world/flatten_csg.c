/* From a CSG node to one postfix program: operands are closed geometry, other CSG nodes or groups, which count as the
 * union of their descendants. An operand without any surface is the empty set, or everything if it is the inverse of
 * that, and disappears by the algebra (A u 0 = A, A n 0 = 0, A - 0 = A, 0 - A = 0, and so on).
 *
 * A clipped primitive becomes the surface of its own program, followed by the clips. A union of opaque solids, or of
 * one material, becomes one primitive for each disjoint part. */
#include "csg/csg_build.h"
#include "world/flatten_csg_internal.h"

#include "base/mem.h"
#include "csg/csg_split.h"
#include "scene/traversal.h"
#include "world/flatten_material_internal.h"

enum { CSG_NESTING = 10000, CSG_LEAVES = 65535 };

enum content { NOTHING, EVERYTHING, SOMETHING };

struct csg_draft {
    struct csg_leaf *leaves;
    struct csg_token *program;
    uint32_t leaf_count, leaf_capacity, length, capacity;
    uint32_t
        met;     /* shapes so far, including those removed by the algebra (world_operand_path counts in the same way) */
    bool unseen; /* its surfaces are invisible: leaves need no material */
};

/* The state from the ancestors of an operand. */
struct inherited_state {
    struct transform csg_from_parent;
    const struct material *inherited;
    const struct box *limit; /* in CSG space, or NULL */
    uint32_t nesting;
};

/* Data of every node on the path: its pose, the state for its operands and children, and the result of it and of those
 * visited so far. */
struct operand_frame {
    struct transform csg_from_node, of_children;
    const struct material *inherited, *inherited_operands;
    const struct box *limit, *limit_operands;
    uint32_t start, leaves; /* of its program and its leaves in the draft */
    enum content content;
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

static bool report_open(struct flattening *f, const struct node *node) {
    const char *file = node->shape.kind == SHAPE_MESH ? mesh_file(node->shape.mesh) : NULL;
    if (node->shape.kind == SHAPE_MESH && mesh_is_open(node->shape.mesh)) {
        char edges[600];
        mesh_describe_open_edges(node->shape.mesh, edges, sizeof edges);
        return error_set(f->error, ERROR_SCENE, "node '%.100s' is an operand of CSG but its mesh%s%.200s is open: %s",
                         node->name, file ? " of " : "", file ? file : "", edges);
    }
    return error_set(f->error, ERROR_SCENE, "node '%.100s' is an operand of CSG but %s", node->name,
                     shape_why_open(&node->shape));
}

static bool add_leaf(struct flattening *f, struct csg_draft *draft, const struct node *node,
                     const struct transform *csg_from_node, const struct inherited_state *above) {
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
    struct csg_leaf leaf = {
        .shape = node->shape, .csg_from_leaf = *csg_from_node, .limit = above->limit, .origin = draft->met++};
    if (!flatten_mesh_accel(f, &node->shape))
        return false;
    if (!draft->unseen && !flatten_material(f, node, above->inherited, &leaf.material, &leaf.slot_count))
        return false;
    draft->leaves[draft->leaf_count] = leaf;
    return add_token(f, draft, (struct csg_token){.operation = CSG_LEAF, .leaf = (uint16_t)draft->leaf_count++});
}

static bool add_inverse(struct flattening *f, struct csg_draft *draft) {
    if (draft->program[draft->length - 1].operation == CSG_INVERSE) { /* twice is not at all */
        draft->length--;
        return true;
    }
    return add_token(f, draft, (struct csg_token){.operation = CSG_INVERSE});
}

/* `so_far` is in the draft, the operand follows it. */
static bool join(struct flattening *f, struct csg_draft *draft, enum csg_operation operation, enum content operand,
                 enum content *so_far) {
    enum content neutral = operation == CSG_INTERSECTION ? EVERYTHING : NOTHING;
    if (operand == neutral)
        return true;
    if (operand != SOMETHING) { /* decides: an empty set in an intersection, everything in a union or as a subtrahend */
        *so_far = operation == CSG_UNION ? EVERYTHING : NOTHING;
        return true;
    }
    if (*so_far == SOMETHING)
        return add_token(f, draft, (struct csg_token){.operation = operation});
    if (operation == CSG_DIFFERENCE ? *so_far == NOTHING : *so_far != neutral)
        return true;
    *so_far = SOMETHING;
    return operation != CSG_DIFFERENCE || add_inverse(f, draft);
}

static bool add_solid(struct flattening *f, struct csg_draft *draft, const struct node *solid,
                      const struct inherited_state *above, bool inside, enum content *content);

/* The box around a solid whose pose is given by its ancestors; infinite if unknown. */
static bool box_of_solid(struct flattening *f, const struct node *solid, const struct inherited_state *above,
                         struct box *out) {
    struct csg_draft draft = {.unseen = true};
    enum content content = NOTHING;
    *out = (struct box){vec3_all(-INFINITY), vec3_all(INFINITY)};
    bool ok = add_solid(f, &draft, solid, above, false, &content);
    if (ok && content == SOMETHING) {
        const struct csg *csg =
            csg_build(f->arena, draft.leaves, draft.leaf_count, draft.program, draft.length, f->error);
        ok = csg != NULL;
        if (ok && !csg->inside_out)
            *out = csg->bounds;
    }
    mem_free(draft.leaves);
    mem_free(draft.program);
    return ok;
}

bool flatten_limit(struct flattening *f, const struct node *solid, const struct transform *world_from_parent,
                   struct box *limit) {
    struct inherited_state above = {.csg_from_parent = transform_identity()};
    struct box own;
    if (!box_of_solid(f, solid, &above, &own))
        return false;
    own = box_transform(&world_from_parent->forward, &own);
    *limit = box_meet(*limit, own);
    return true;
}

/* The box that the operand of a bounded node is known to lie in; NULL without memory or for an error. */
static const struct box *bound_of(struct flattening *f, const struct node *node, const struct operand_frame *frame,
                                  uint32_t nesting) {
    struct inherited_state above = {frame->csg_from_node, frame->inherited_operands, frame->limit, nesting};
    struct box *limit = arena_alloc(f->arena, sizeof *limit);
    if (!limit) {
        error_no_memory(f->error, "the operands of a CSG solid");
        return NULL;
    }
    if (!box_of_solid(f, node->operands[1], &above, limit))
        return NULL;
    if (frame->limit)
        *limit = box_meet(*limit, *frame->limit);
    return limit;
}

/* Begins a CSG node, before its first operand. Its material applies to operands without one. */
static bool begin_operation(struct flattening *f, const struct node *node, struct operand_frame *frame,
                            uint32_t nesting) {
    frame->inherited_operands = node->material ? node->material : frame->inherited;
    frame->limit_operands = frame->limit;
    frame->content = node->operation == NODE_INTERSECTION ? EVERYTHING : NOTHING;
    if (node->operation == NODE_CLIPPED)
        return error_set(
            f->error, ERROR_SCENE,
            "node '%.100s' is an operand of CSG but is clipped, cut open without caps, so it has no inside; "
            "intersect it instead",
            node->name);
    if (node->operation == NODE_BOUNDED)
        frame->limit_operands = bound_of(f, node, frame, nesting + 1);
    return node->operation != NODE_BOUNDED || frame->limit_operands;
}

/* A node that was just entered: its own surface. `skip`: nothing is under it. */
static bool enter_operand(struct flattening *f, struct csg_draft *draft, const struct node *node,
                          const struct inherited_state *above, struct operand_frame *frame, bool *skip) {
    frame->content = NOTHING;
    frame->start = draft->length;
    frame->leaves = draft->leaf_count;
    frame->inherited = above->inherited;
    frame->limit = above->limit;
    if (above->nesting > CSG_NESTING)
        return error_set(f->error, ERROR_SCENE, "CSG solids are nested more than %d deep", CSG_NESTING);
    /* What is scaled to nothing is nothing. */
    *skip = node->singular;
    if (*skip)
        return true;
    if (node_moves(node))
        return error_set(f->error, ERROR_SCENE,
                         "node '%.100s' moves inside of a combined solid; only the solid as a whole can move",
                         node->name);
    /* Into the space of the whole solid. */
    struct transform parent_from_node = node_parent_from_node(node);
    frame->csg_from_node = transform_compose(&above->csg_from_parent, &parent_from_node);
    if (!flatten_check_transform(f, node, &frame->csg_from_node))
        return false;
    if (node->kind == NODE_CSG)
        return begin_operation(f, node, frame, above->nesting);
    if (!node_has_surface(node))
        return true;
    if (!shape_is_closed(&node->shape))
        return report_open(f, node);
    frame->content = SOMETHING;
    return add_leaf(f, draft, node, &frame->csg_from_node, above);
}

/* An operand that decides the result needs no program. */
static void forget_decided(struct csg_draft *draft, const struct operand_frame *frame) {
    if (frame->content == SOMETHING)
        return;
    draft->length = frame->start;
    draft->leaf_count = frame->leaves;
}

/* Adds the result of operand `number`. */
static bool add_operand(struct flattening *f, struct csg_draft *draft, const struct node *node, uint32_t number,
                        enum content operand, struct operand_frame *frame) {
    bool ok = true;
    switch (node->operation) {
    case NODE_UNION:
        ok = join(f, draft, CSG_UNION, operand, &frame->content);
        break;
    case NODE_INTERSECTION:
        ok = join(f, draft, CSG_INTERSECTION, operand, &frame->content);
        break;
    case NODE_DIFFERENCE:
        if (number > 0)
            ok = join(f, draft, CSG_DIFFERENCE, operand, &frame->content);
        else
            frame->content = operand;
        break;
    case NODE_INVERSE:
        frame->content = operand == NOTHING ? EVERYTHING : operand == EVERYTHING ? NOTHING : SOMETHING;
        ok = operand != SOMETHING || add_inverse(f, draft);
        break;
    case NODE_CLIPPED:
    case NODE_BOUNDED:
        frame->content = operand;
        break;
    }
    /* An operand without effect leaves no trace. */
    forget_decided(draft, frame);
    return ok;
}

/* Ends a node: its parent adds its result; for the root it is the final result. */
static bool leave_operand(struct flattening *f, struct csg_draft *draft, const struct scene_traversal *t,
                          enum content *content) {
    struct operand_frame *frame = scene_traversal_frame(t, 0);
    *content = frame->content;
    if (t->depth == 1)
        return true;
    uint32_t number = scene_traversal_operand(t);
    struct operand_frame *above = scene_traversal_frame(t, 1);
    if (number != SCENE_CHILD)
        return add_operand(f, draft, t->steps[t->depth - 2].node, number, frame->content, above);
    return join(f, draft, CSG_UNION, frame->content, &above->content);
}

/* The state that the parent gives the node just entered. */
static struct inherited_state above_of(const struct scene_traversal *t, uint32_t nesting) {
    const struct operand_frame *frame = scene_traversal_frame(t, 1);
    nesting += t->depth - 1;
    if (scene_traversal_operand(t) == SCENE_CHILD)
        return (struct inherited_state){frame->of_children, frame->inherited, frame->limit, nesting};
    return (struct inherited_state){frame->csg_from_node, frame->inherited_operands, frame->limit_operands, nesting};
}

static bool enter_solid(struct flattening *f, struct csg_draft *draft, struct scene_traversal *t,
                        const struct inherited_state *above) {
    struct operand_frame *frame = scene_traversal_frame(t, 0);
    const struct node *node = scene_traversal_node(t);
    bool skip = false;
    if (t->inside && t->depth == 1) { /* its own pose does not affect the solid's space */
        *frame = (struct operand_frame){
            .csg_from_node = above->csg_from_parent, .inherited = above->inherited, .limit = above->limit};
        return begin_operation(f, node, frame, above->nesting);
    }
    struct inherited_state own = t->depth > 1 ? above_of(t, above->nesting) : *above;
    if (!enter_operand(f, draft, node, &own, frame, &skip))
        return false;
    enum content nothing;
    if (skip) {
        if (!leave_operand(f, draft, t, &nothing))
            return false;
        scene_traversal_skip(t);
    }
    return true;
}

/* Everything under a node as one operand: the union of its own surface and of its children. inside: only its operands,
 * as if the node had the pose of its parent. */
static bool add_solid(struct flattening *f, struct csg_draft *draft, const struct node *solid,
                      const struct inherited_state *above, bool inside, enum content *content) {
    struct scene_traversal t = {
        .operands = OPERANDS_OF_SOLIDS, .inside = inside, .frame_size = sizeof(struct operand_frame)};
    enum scene_event event;
    bool ok = true;
    *content = NOTHING;
    scene_traversal_begin(&t, solid);
    while (ok && (event = scene_traversal_next(&t)) != SCENE_END) {
        if (event == SCENE_NO_MEMORY) {
            ok = error_no_memory(f->error, "a CSG program");
        } else if (event == SCENE_ENTER) {
            ok = enter_solid(f, draft, &t, above);
        } else {
            struct operand_frame *frame = scene_traversal_frame(&t, 0);
            forget_decided(draft, frame); /* of the placement before */
            if (event == SCENE_CHILDREN)
                frame->of_children = scene_step_map(&t.steps[t.depth - 1], &frame->csg_from_node);
            else
                ok = leave_operand(f, draft, &t, content);
        }
    }
    scene_traversal_end(&t);
    return ok;
}

/* The clips behind the solid, all of them at once. */
static bool add_clips(struct flattening *f, struct csg_draft *draft, const struct node *node, const struct clip *clips,
                      const struct pose *pose, enum content *content) {
    struct transform csg_from_ground = transform_invert(&pose->from_node);
    uint32_t start = draft->length, leaves = draft->leaf_count;
    *content = EVERYTHING;
    draft->unseen = true;
    for (const struct clip *clip = clips; clip; clip = clip->next) {
        struct inherited_state above = {.csg_from_parent = transform_compose(&csg_from_ground, &clip->pose.from_node)};
        enum content one;
        if (clip->pose.above != pose->above)
            return error_set(
                f->error, ERROR_SCENE,
                "node '%.100s' or a node above it moves, but its clip does not; only both together can move",
                node->name);
        if (!add_solid(f, draft, clip->solid, &above, false, &one) || !join(f, draft, CSG_INTERSECTION, one, content))
            return false;
        if (*content != SOMETHING) {
            draft->length = start;
            draft->leaf_count = leaves;
        }
    }
    return true;
}

/* Whether disjoint parts are indistinguishable from one solid, also from inside. */
static bool may_be_split(const struct flattening *f, const struct csg_draft *draft) {
    const uint32_t *numbers = f->world->material_numbers;
    bool all_opaque = true, all_alike = true;
    for (uint32_t i = 0; i < draft->leaf_count; i++) {
        const struct csg_leaf *leaf = &draft->leaves[i];
        for (uint32_t slot = 0; all_opaque && (slot == 0 || slot < leaf->slot_count); slot++) {
            const struct material *material = f->world->authored.materials[leaf->material + slot];
            struct surface_material surface = surface_material_make(material, false, NULL);
            all_opaque = !surface_is_transparent(&surface);
        }
        all_alike = all_alike && leaf->slot_count < 2 && numbers[leaf->material] == numbers[draft->leaves[0].material];
    }
    return all_opaque || all_alike;
}

static bool build(struct flattening *f, const struct csg_draft *draft, uint32_t solid_length, const struct csg ***parts,
                  uint32_t *count) {
    if (solid_length == draft->length && may_be_split(f, draft))
        return csg_build_parts(f->arena,
                               &(struct csg_program){draft->leaves, draft->leaf_count, draft->program, draft->length},
                               parts, count, f->error);
    *parts = arena_alloc(f->arena, sizeof **parts);
    if (!*parts)
        return error_no_memory(f->error, "CSG");
    (*parts)[0] = csg_build_clipped(
        f->arena, &(struct csg_program){draft->leaves, draft->leaf_count, draft->program, draft->length}, solid_length,
        f->error);
    *count = 1;
    return (*parts)[0] != NULL;
}

static enum csg_cull cull_of(const struct node *node) {
    switch (node->cull) {
    case CULL_NONE:
        break;
    case CULL_BACK:
        return CSG_CULL_BACK;
    case CULL_FRONT:
        return CSG_CULL_FRONT;
    }
    return CSG_CULL_NONE;
}

bool flatten_csg(struct flattening *f, const struct node *node, const struct pose *pose,
                 const struct graphics_state *state, const struct csg ***parts, uint32_t *count) {
    struct csg_draft draft = {0};
    enum content content = SOMETHING, clip = EVERYTHING;
    struct transform identity = transform_identity();
    struct inherited_state above = {.csg_from_parent = identity, .inherited = state ? state->inherited : NULL};
    *parts = NULL;
    *count = 0;
    bool ok = node->kind == NODE_CSG ? add_solid(f, &draft, node, &above, true, &content)
                                     : add_leaf(f, &draft, node, &identity, &above);
    if (ok && node->kind != NODE_CSG) /* a surface of its own that is clipped */
        draft.leaves[0].cull = cull_of(node);
    uint32_t solid_length = draft.length;
    if (ok && content == SOMETHING && state && state->clips)
        ok = add_clips(f, &draft, node, state->clips, pose, &clip);
    if (ok && content == SOMETHING && clip != NOTHING)
        ok = build(f, &draft, solid_length, parts, count);
    mem_free(draft.leaves);
    mem_free(draft.program);
    return ok;
}
