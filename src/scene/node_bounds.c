/* Every node of the path gathers the box of what has been visited below it. */
#include "scene/node_bounds.h"

#include "scene/traversal.h"

enum { DEPTH_LIMIT = 2000, STEPS = 1 << 24 };

struct measuring {
    struct scene_traversal traversal;
    long long steps; /* left */
    bool finite;     /* endless parts do not count */
    struct error *error;
};

/* The state of every node on the path; box: that of its visited part. */
struct measure_frame {
    struct transform from_node, of_children;
    struct box box;
};

static struct box bounds_of_shape(struct measuring *m, const struct shape *shape, const struct affine *map) {
    uint32_t faces = shape->kind == SHAPE_MESH ? mesh_face_count(shape->mesh) : 0;
    bool exact = faces > 0 && faces < m->steps / 2;
    m->steps -= exact ? faces : 0;
    return exact ? mesh_bounds_under(shape->mesh, map) : shape_bounds_under(shape, map);
}

/* A box without the endless parts, where they do not count; operands of solids keep theirs. */
static struct box counted(const struct measuring *m, struct box box) {
    const double limit = 1e15;
    bool is_part = scene_traversal_operand(&m->traversal) == SCENE_CHILD;
    bool endless = !(vec3_max_abs(box.min) <= limit && vec3_max_abs(box.max) <= limit);
    return m->finite && is_part && endless ? box_empty() : box;
}

/* A node that is not drawn is an empty box. */
static bool enter(struct measuring *m) {
    struct scene_traversal *t = &m->traversal;
    const struct node *node = scene_traversal_node(t);
    struct measure_frame *frame = scene_traversal_frame(t, 0);
    frame->box = box_empty();
    if (node->singular)
        return true;
    if (t->depth - 1 > DEPTH_LIMIT)
        return error_set(m->error, ERROR_SCENE, "nodes are nested more than %d deep, or in a cycle", DEPTH_LIMIT);
    if (--m->steps < 0)
        return error_set(m->error, ERROR_SCENE, "more than %d objects are below this node", STEPS);
    frame->from_node = node_parent_from_node(node);
    if (t->depth > 1) {
        const struct measure_frame *above = scene_traversal_frame(t, 1);
        bool child = scene_traversal_operand(t) == SCENE_CHILD;
        frame->from_node = transform_compose(child ? &above->of_children : &above->from_node, &frame->from_node);
    } else {
        struct transform identity = transform_identity();
        frame->from_node = transform_compose(&identity, &frame->from_node);
    }
    if (node->kind == NODE_GEOMETRY)
        frame->box = counted(m, bounds_of_shape(m, &node->shape, &frame->from_node.forward));
    return true;
}

/* A box around the operands of a combined solid, as tight as it can be without their surfaces. */
static struct box with_operand(const struct node *node, uint32_t number, struct box box, struct box operand) {
    if (number == 0)
        return operand;
    switch (node->operation) {
    case NODE_UNION:
        return box_join(box, operand);
    case NODE_DIFFERENCE:
    case NODE_INVERSE:
        return box;
    case NODE_INTERSECTION:
    case NODE_CLIPPED:
    case NODE_BOUNDED:
        return box_meet(box, operand);
    }
    return box;
}

static void leave(const struct measuring *m) {
    const struct scene_traversal *t = &m->traversal;
    const struct measure_frame *frame = scene_traversal_frame(t, 0);
    uint32_t number = scene_traversal_operand(t);
    if (t->depth == 1)
        return;
    struct measure_frame *above = scene_traversal_frame(t, 1);
    above->box = number == SCENE_CHILD ? box_join(above->box, counted(m, frame->box))
                                       : with_operand(t->steps[t->depth - 2].node, number, above->box, frame->box);
}

/* A difference or an inverse has the bounds of its first operand. */
static bool is_measured(const struct scene_traversal *t) {
    uint32_t number = scene_traversal_operand(t);
    if (number == SCENE_CHILD || number == 0)
        return true;
    enum node_csg operation = t->steps[t->depth - 2].node->operation;
    return operation != NODE_DIFFERENCE && operation != NODE_INVERSE;
}

/* The last of the operands was visited. */
static void end_operands(const struct node *node, struct measure_frame *frame) {
    if (node->kind == NODE_CSG && box_is_empty(&frame->box))
        frame->box = box_empty();
}

static bool measure(struct measuring *m, struct box *box) {
    struct scene_traversal *t = &m->traversal;
    enum scene_event event;
    while ((event = scene_traversal_next(t)) < SCENE_END) {
        const struct node *node = scene_traversal_node(t);
        struct measure_frame *frame = scene_traversal_frame(t, 0);
        if (event == SCENE_ENTER && !is_measured(t)) {
            scene_traversal_skip(t);
            continue;
        }
        if (event == SCENE_ENTER && !enter(m))
            return false;
        /* A box is complete when everything below the node has been joined into it. */
        if (event != SCENE_ENTER)
            end_operands(node, frame);
        if (event == SCENE_CHILDREN)
            frame->of_children = scene_step_map(&t->steps[t->depth - 1], &frame->from_node);
        if (t->depth == 1)
            *box = frame->box;
        if (event == SCENE_LEAVE || node->singular)
            leave(m);
        if (node->singular)
            scene_traversal_skip(t);
    }
    return event == SCENE_END || error_no_memory(m->error, "a box");
}

static bool bounds(const struct node *node, bool finite, struct box *out, struct error *error) {
    struct measuring m = {.traversal = {.operands = OPERANDS_ALL, .frame_size = sizeof(struct measure_frame)},
                          .steps = STEPS,
                          .finite = finite,
                          .error = error};
    scene_traversal_begin(&m.traversal, node);
    bool ok = measure(&m, out);
    scene_traversal_end(&m.traversal);
    return ok;
}

bool node_bounds(const struct node *node, struct box *out, struct error *error) {
    return bounds(node, false, out, error);
}

bool node_finite_bounds(const struct node *node, struct box *out, struct error *error) {
    return bounds(node, true, out, error);
}
