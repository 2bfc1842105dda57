/* Methods of nodes. args[SELF] is the node before the colon. */
#include "call/context.h"
#include "script/bindings_internal.h"

#include <math.h>

bool gr_add_child(struct script_context *context, const struct script_value *args, struct script_result *result,
                  struct error *error) {
    (void)result;
    struct node *parent = args[SELF].node, *child = args[CHILD_NODE].node;
    int budget = 1000; /* larger cycles are found when the picture is rendered */
    bool may_close = parent == child || (parent->has_parent && (child->first_child || child->kind == NODE_CSG));
    if (may_close && node_holds(child, parent, &budget))
        return error_set(error, ERROR_SCENE,
                         parent == child ? "a node cannot be its own child"
                                         : "'%.200s' is below '%.200s': the nodes would form a cycle",
                         parent->name, child->name);
    return node_add_child(&context->scene, args[SELF].node, args[CHILD_NODE].node, error);
}

/* Properties that only shapes can have: an error on plain nodes, with --lenient a warning. */
static bool is_shape(struct script_context *context, const struct node *node, const char *what, struct error *error) {
    if (node->kind == NODE_GEOMETRY || node->kind == NODE_CSG)
        return true;
    if (!context->lenient)
        return error_set(error, ERROR_SCENE, "a plain node has no %s", what);
    sandbox_warn(&context->sandbox, "a plain node has no %s", what);
    return false;
}

/* False without an error: a warning was printed, and the call has no effect. */
static bool unless_warned(const struct error *error) {
    return error->kind == ERROR_NONE;
}

/* On a CSG node it is the material of the operands that have no material; src/world applies it. */
bool gr_set_material(struct script_context *context, const struct script_value *args, struct script_result *result,
                     struct error *error) {
    (void)result;
    if (!is_shape(context, args[SELF].node, "material", error))
        return unless_warned(error);
    args[SELF].node->material = args[SET_MATERIAL].material;
    scene_note_reference(&context->scene, args[SELF].node->index);
    return true;
}

/* How the image is mapped depends on the shape (docs/language.md 6.2); that is decided when the scene is flattened. */
bool gr_set_texture(struct script_context *context, const struct script_value *args, struct script_result *result,
                    struct error *error) {
    (void)result;
    struct node *node = args[SELF].node;
    if (!is_shape(context, node, "texture", error))
        return unless_warned(error);
    if (node->kind == NODE_CSG)
        return error_set(error, ERROR_SCENE, "a combined solid has no texture; set those of its operands");
    node->texture = gr_image(context, &args[SET_TEXTURE], error);
    scene_note_reference(&context->scene, node->index);
    return node->texture != NULL;
}

/* Likewise. */
bool gr_set_bump(struct script_context *context, const struct script_value *args, struct script_result *result,
                 struct error *error) {
    (void)result;
    struct node *node = args[SELF].node;
    if (!is_shape(context, node, "bump map", error))
        return unless_warned(error);
    if (node->kind == NODE_CSG)
        return error_set(error, ERROR_SCENE, "a combined solid has no bump map; set those of its operands");
    node->bump = read_bump_values(context, &args[SET_BUMP], error);
    scene_note_reference(&context->scene, node->index);
    return node->bump != NULL;
}

static bool step(struct script_context *context, const struct script_value *args, enum node_step kind,
                 const struct transform *by, struct error *error) {
    return node_transform(&context->scene, args[SELF].node, kind, by) || error_no_memory(error, "a transform");
}

static struct vec3 step_of(const struct script_value *args) {
    if (args[STEP_VECTOR].given)
        return args[STEP_VECTOR].vector;
    return (struct vec3){args[STEP_X].number, args[STEP_Y].number, args[STEP_Z].number};
}

bool gr_velocity(struct script_context *context, const struct script_value *args, struct script_result *result,
                 struct error *error) {
    (void)result, (void)error;
    scene_note_change(&context->scene);
    args[SELF].node->velocity = step_of(args);
    return true;
}

bool gr_spin(struct script_context *context, const struct script_value *args, struct script_result *result,
             struct error *error) {
    (void)result;
    const struct script_value *axis = &args[SPIN_AXIS], *direction = &args[SPIN_DIRECTION];
    struct vec3 unit = {axis->choice == 0, axis->choice == 1, axis->choice == 2};
    struct vec3 about = direction->given ? direction->vector : unit;
    if (vec3_max_abs(about) == 0)
        return error_set(error, ERROR_SCENE, "direction has length 0");
    scene_note_change(&context->scene);
    args[SELF].node->spin = NULL;
    if (args[SPIN_DEGREES].number == 0)
        return true;
    struct node_spin *spin = arena_alloc(&context->scene.arena, sizeof *spin);
    if (!spin)
        return error_no_memory(error, "a motion");
    *spin = (struct node_spin){about, args[SPIN_DEGREES].number};
    scene_note_reference(&context->scene, args[SELF].node->index);
    args[SELF].node->spin = spin;
    return true;
}

bool gr_reset(struct script_context *context, const struct script_value *args, struct script_result *result,
              struct error *error) {
    (void)result, (void)error;
    node_reset_transform(&context->scene, args[SELF].node);
    return true;
}

/* Only the transforms of the other node itself are used, with their values at the time of rendering. */
bool gr_moves_to(struct script_context *context, const struct script_value *args, struct script_result *result,
                 struct error *error) {
    (void)result, (void)error;
    args[SELF].node->moves_to = args[MOVES_TO_NODE].node;
    scene_note_reference(&context->scene, args[SELF].node->index);
    return true;
}

bool gr_scale(struct script_context *context, const struct script_value *args, struct script_result *result,
              struct error *error) {
    (void)result;
    struct vec3 factors = step_of(args);
    double min = fmin(fmin(fabs(factors.x), fabs(factors.y)), fabs(factors.z));
    if (!isfinite(1 / min)) {
        context_warn_once(context, WARNED_OTHER, "a factor is %g, so nothing under this node is drawn", min);
        scene_note_change(&context->scene);
        args[SELF].node->singular = true;
        return true;
    }
    struct transform by = transform_scale(factors);
    return step(context, args, NODE_SCALE, &by, error);
}

bool gr_rotate(struct script_context *context, const struct script_value *args, struct script_result *result,
               struct error *error) {
    (void)result;
    struct transform by = transform_rotate(args[ROTATE_AXIS].choice, args[ROTATE_ANGLE].number);
    return step(context, args, NODE_ROTATE, &by, error);
}

bool gr_rotate_axis(struct script_context *context, const struct script_value *args, struct script_result *result,
                    struct error *error) {
    (void)result;
    if (vec3_max_abs(args[ROTATE_AXIS].vector) == 0)
        return error_set(error, ERROR_SCENE, "axis has length 0");
    struct transform by = transform_rotate_about(args[ROTATE_AXIS].vector, args[ROTATE_ANGLE].number);
    return step(context, args, NODE_ROTATE, &by, error);
}

bool gr_rotate_quat(struct script_context *context, const struct script_value *args, struct script_result *result,
                    struct error *error) {
    (void)result;
    const struct script_value *table = &args[QUAT_TABLE];
    double w = table->given ? table->number : args[QUAT_W].number;
    struct vec3 xyz = {args[QUAT_X].number, args[QUAT_Y].number, args[QUAT_Z].number};
    if (table->given)
        xyz = table->vector;
    if (w == 0 && vec3_max_abs(xyz) == 0)
        return error_set(error, ERROR_SCENE, "the quaternion must not be 0");
    struct transform by = transform_rotate_quaternion(w, xyz);
    return step(context, args, NODE_ROTATE, &by, error);
}

/* This order does not depend on the order of transforms (gr.transform_order). */
bool gr_pose(struct script_context *context, const struct script_value *args, struct script_result *result,
             struct error *error) {
    (void)result;
    struct node *node = args[SELF].node;
    const struct script_value *rotate = &args[POSE_ROTATE], *scale = &args[POSE_SCALE];
    if (rotate->given && rotate->number == 0 && vec3_max_abs(rotate->vector) == 0)
        return error_set(error, ERROR_SCENE, "the quaternion must not be 0");
    struct vec3 factors = scale->given ? scale->vector : vec3_all(1);
    double min = fmin(fmin(fabs(factors.x), fabs(factors.y)), fabs(factors.z));
    bool singular = !isfinite(1 / min);
    const struct transform steps[NODE_STEPS] = {
        [NODE_TRANSLATE] = transform_translate(args[POSE_TRANSLATE].vector),
        [NODE_ROTATE] =
            rotate->given ? transform_rotate_quaternion(rotate->number, rotate->vector) : transform_identity(),
        [NODE_SCALE] = transform_scale(singular ? vec3_all(1) : factors),
    };
    static const enum node_step forward[] = {NODE_SCALE, NODE_ROTATE, NODE_TRANSLATE};
    node_reset_transform(&context->scene, node);
    for (int i = 0; i < NODE_STEPS; i++) {
        enum node_step kind = forward[context->scene.order == ORDER_OLD ? NODE_STEPS - 1 - i : i];
        if (!node_transform(&context->scene, node, kind, &steps[kind]))
            return error_no_memory(error, "a transform");
    }
    node->singular = singular;
    if (singular)
        scene_note_change(&context->scene);
    return true;
}

bool gr_translate(struct script_context *context, const struct script_value *args, struct script_result *result,
                  struct error *error) {
    (void)result;
    struct transform by = transform_translate(step_of(args));
    return step(context, args, NODE_TRANSLATE, &by, error);
}
