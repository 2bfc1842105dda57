/* Methods of nodes, and the order of their transforms. args[SELF] is the node before the colon. */
#include "call/context.h"
#include "scene/node_bounds.h"
#include "script/gr_materials_internal.h"
#include "script/rows_internal.h"

#include <math.h>

static const struct script_parameter self_parameters[] = {SELF_PARAMETER};

enum { CHILD_NODE = 1 };
static const struct script_parameter child_parameters[] = {
    SELF_PARAMETER,
    [CHILD_NODE] = {"node", KIND_NODE, 0, ANY, NULL, NULL, "The child; a node under several parents is an instance."},
};

/* Among the first ones: a long list is made by a loop, of different nodes. */
static bool has_child(const struct node *parent, const struct node *child) {
    enum { LOOKED_AT = 64 };
    const struct node_child *at = parent->first_child;
    for (int i = 0; at && i < LOOKED_AT && at->node != child; i++)
        at = at->next;
    return at && at->node == child;
}

static bool gr_add_child(struct script_context *context, const struct script_value *args, struct script_result *result,
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
    if (has_child(parent, child) && sandbox_is_new_line(&context->sandbox, "add_child"))
        sandbox_warn(&context->sandbox, "'%.200s' is a child of '%.200s' already: it is there twice, at the same place",
                     child->name, parent->name);
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

enum { SET_MATERIAL = 1 };
static const struct script_parameter set_material_parameters[] = {
    SELF_PARAMETER,
    [SET_MATERIAL] = {"material", KIND_MATERIAL, 0, ANY, NULL, NULL, MATERIAL_HELP},
};

/* On a CSG node it is the material of the operands that have no material; src/world applies it. */
static bool gr_set_material(struct script_context *context, const struct script_value *args,
                            struct script_result *result, struct error *error) {
    (void)result;
    if (!is_shape(context, args[SELF].node, "material", error))
        return unless_warned(error);
    args[SELF].node->material = args[SET_MATERIAL].material;
    scene_note_reference(&context->scene, args[SELF].node->index);
    return true;
}

enum { SET_TEXTURE = 1 };
static const struct script_parameter set_texture_parameters[] = {
    SELF_PARAMETER,
    [SET_TEXTURE] = {"texture", KIND_IMAGE, 0, ANY, NULL, NULL, "A texture, or the name of a picture file."},
};

/* How the image is mapped depends on the shape (docs/language.md 6.2); that is decided when the scene is flattened. */
static bool gr_set_texture(struct script_context *context, const struct script_value *args,
                           struct script_result *result, struct error *error) {
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

enum { SET_BUMP = 1 };
static const struct script_parameter set_bump_parameters[] = {
    SELF_PARAMETER,
    [SET_BUMP] = {"bump", KIND_IMAGE, OR_TEXTURE, ANY, NULL, NULL,
                  "A result of gr.bump, or the name of a picture file."},
};

/* Likewise. */
static bool gr_set_bump(struct script_context *context, const struct script_value *args, struct script_result *result,
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

enum { STEP_X = 1, STEP_Y, STEP_Z, STEP_VECTOR };
static const struct script_parameter scale_parameters[] = {
    SELF_PARAMETER,
    [STEP_X] = {"x", KIND_NUMBER, 0, ANY, NULL, NULL, "Factor along x."},
    [STEP_Y] = {"y", KIND_NUMBER, 0, ANY, NULL, NULL, "Factor along y."},
    [STEP_Z] = {"z", KIND_NUMBER, 0, ANY, NULL, NULL, "Factor along z."},
    [STEP_VECTOR] = {"vector", KIND_TRIPLE, 0, ANY, NULL, NULL, "The three numbers as a table."},
};

static const struct script_parameter translate_parameters[] = {
    SELF_PARAMETER,
    [STEP_X] = {"x", KIND_NUMBER, 0, ANY, NULL, NULL, "Distance along x."},
    [STEP_Y] = {"y", KIND_NUMBER, 0, ANY, NULL, NULL, "Distance along y."},
    [STEP_Z] = {"z", KIND_NUMBER, 0, ANY, NULL, NULL, "Distance along z."},
    [STEP_VECTOR] = {"vector", KIND_TRIPLE, 0, ANY, NULL, NULL, "The three numbers as a table."},
};

static const struct script_parameter velocity_parameters[] = {
    SELF_PARAMETER,
    [STEP_X] = {"x", KIND_NUMBER, 0, ANY, NULL, NULL, "Distance along x per second, in the space of the parent."},
    [STEP_Y] = {"y", KIND_NUMBER, 0, ANY, NULL, NULL, "Distance along y."},
    [STEP_Z] = {"z", KIND_NUMBER, 0, ANY, NULL, NULL, "Distance along z."},
    [STEP_VECTOR] = {"vector", KIND_TRIPLE, 0, ANY, NULL, NULL, "The three numbers as a table."},
};

static struct vec3 step_of(const struct script_value *args) {
    if (args[STEP_VECTOR].given)
        return args[STEP_VECTOR].vector;
    return (struct vec3){args[STEP_X].number, args[STEP_Y].number, args[STEP_Z].number};
}

static bool gr_velocity(struct script_context *context, const struct script_value *args, struct script_result *result,
                        struct error *error) {
    (void)result, (void)error;
    scene_note_change(&context->scene);
    args[SELF].node->velocity = step_of(args);
    return true;
}

enum { SPIN_AXIS = 1, SPIN_DEGREES, SPIN_DIRECTION };
static const struct script_parameter spin_parameters[] = {
    SELF_PARAMETER,
    [SPIN_AXIS] = {"axis", KIND_AXIS, 0, 0, 0, "x y z", NULL, NULL, "The axis."},
    [SPIN_DEGREES] = {"degrees", KIND_NUMBER, 0, ANY, "degrees", NULL, "Angle per second; 0: none."},
    [SPIN_DIRECTION] = {"direction", KIND_DIRECTION, 0, ANY, NULL, NULL, "Any direction as axis."},
};

static bool gr_spin(struct script_context *context, const struct script_value *args, struct script_result *result,
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
    context->scene.spins = true;
    return true;
}

static bool gr_reset(struct script_context *context, const struct script_value *args, struct script_result *result,
                     struct error *error) {
    (void)result, (void)error;
    node_reset_transform(&context->scene, args[SELF].node);
    return true;
}

enum { MOVES_TO_NODE = 1 };
static const struct script_parameter moves_to_parameters[] = {
    SELF_PARAMETER,
    [MOVES_TO_NODE] = {"node", KIND_NODE, 0, ANY, NULL, NULL,
                       "A node whose own transforms are the pose of this one at time 1; it need not be in the scene."},
};

/* Only the transforms of the other node itself are used, with their values at the time of rendering. */
static bool gr_moves_to(struct script_context *context, const struct script_value *args, struct script_result *result,
                        struct error *error) {
    (void)result, (void)error;
    args[SELF].node->moves_to = args[MOVES_TO_NODE].node;
    scene_note_reference(&context->scene, args[SELF].node->index);
    return true;
}

static bool gr_scale(struct script_context *context, const struct script_value *args, struct script_result *result,
                     struct error *error) {
    (void)result;
    struct vec3 factors = step_of(args);
    double min = math_min(math_min(fabs(factors.x), fabs(factors.y)), fabs(factors.z));
    if (!isfinite(1 / min)) {
        context_warn_once(context, WARNED_OTHER, "a factor is %g, so nothing under this node is drawn", min);
        scene_note_change(&context->scene);
        args[SELF].node->singular = true;
        return true;
    }
    struct transform by = transform_scale(factors);
    return step(context, args, NODE_SCALE, &by, error);
}

enum { ROTATE_AXIS = 1, ROTATE_ANGLE };
static const struct script_parameter rotate_parameters[] = {
    SELF_PARAMETER,
    [ROTATE_AXIS] = {"axis", KIND_AXIS, 0, 0, 0, "x y z", NULL, NULL, "The axis, in either case."},
    [ROTATE_ANGLE] = {"angle", KIND_NUMBER, 0, ANY, "degrees", NULL,
                      "Angle, counterclockwise when the axis points to the viewer."},
};

static const struct script_parameter rotate_axis_parameters[] = {
    SELF_PARAMETER,
    [ROTATE_AXIS] = {"axis", KIND_DIRECTION, 0, ANY, NULL, NULL, "The axis, of any length except 0."},
    [ROTATE_ANGLE] = {"angle", KIND_NUMBER, 0, ANY, "degrees", NULL,
                      "Angle, counterclockwise when the axis points to the viewer."},
};

static bool gr_rotate(struct script_context *context, const struct script_value *args, struct script_result *result,
                      struct error *error) {
    (void)result;
    struct transform by = transform_rotate(args[ROTATE_AXIS].choice, args[ROTATE_ANGLE].number);
    return step(context, args, NODE_ROTATE, &by, error);
}

static bool gr_rotate_axis(struct script_context *context, const struct script_value *args,
                           struct script_result *result, struct error *error) {
    (void)result;
    if (vec3_max_abs(args[ROTATE_AXIS].vector) == 0)
        return error_set(error, ERROR_SCENE, "axis has length 0");
    struct transform by = transform_rotate_about(args[ROTATE_AXIS].vector, args[ROTATE_ANGLE].number);
    return step(context, args, NODE_ROTATE, &by, error);
}

enum { QUAT_W = 1, QUAT_X, QUAT_Y, QUAT_Z, QUAT_TABLE };
static const struct script_parameter rotate_quat_parameters[] = {
    SELF_PARAMETER,
    [QUAT_W] = {"w", KIND_NUMBER, 0, ANY, NULL, NULL, "Cosine of half the angle; gray normalises the quaternion."},
    [QUAT_X] = {"x", KIND_NUMBER, 0, ANY, NULL, NULL, "x of the unit axis, times the sine of half the angle."},
    [QUAT_Y] = {"y", KIND_NUMBER, 0, ANY, NULL, NULL, "The same for y."},
    [QUAT_Z] = {"z", KIND_NUMBER, 0, ANY, NULL, NULL, "The same for z."},
    [QUAT_TABLE] = {"quaternion", KIND_QUATERNION, 0, ANY, NULL, NULL, "The four numbers as a table."},
};

static bool gr_rotate_quat(struct script_context *context, const struct script_value *args,
                           struct script_result *result, struct error *error) {
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

enum { POSE_TRANSLATE = 1, POSE_ROTATE, POSE_SCALE };
static const struct script_parameter pose_parameters[] = {
    SELF_PARAMETER,
    [POSE_TRANSLATE] = {"translate", KIND_POINT, OPTIONAL, ANY, NULL, "{0, 0, 0}", "Translation, the last step."},
    [POSE_ROTATE] = {"rotate", KIND_QUATERNION, OPTIONAL, ANY, NULL, "{1, 0, 0, 0}",
                     "Rotation, a quaternion {w, x, y, z} as for node:rotate_quat."},
    [POSE_SCALE] = {"scale", KIND_SIZE, OPTIONAL, ANY, NULL, "1",
                    "Scale factor, the first step, one number or three; of 0 nothing is drawn."},
};

/* This order does not depend on the order of transforms (gr.transform_order). */
static bool gr_pose(struct script_context *context, const struct script_value *args, struct script_result *result,
                    struct error *error) {
    (void)result;
    struct node *node = args[SELF].node;
    const struct script_value *rotate = &args[POSE_ROTATE], *scale = &args[POSE_SCALE];
    if (rotate->given && rotate->number == 0 && vec3_max_abs(rotate->vector) == 0)
        return error_set(error, ERROR_SCENE, "the quaternion must not be 0");
    struct vec3 factors = scale->given ? scale->vector : vec3_all(1);
    /* A node of no size has no inverse; it is not drawn. */
    double min = math_min(math_min(fabs(factors.x), fabs(factors.y)), fabs(factors.z));
    bool singular = !isfinite(1 / min);
    const struct transform steps[NODE_STEPS] = {
        [NODE_TRANSLATE] = transform_translate(args[POSE_TRANSLATE].vector),
        [NODE_ROTATE] =
            rotate->given ? transform_rotate_quaternion(rotate->number, rotate->vector) : transform_identity(),
        [NODE_SCALE] = transform_scale(singular ? vec3_all(1) : factors),
    };
    /* The old order puts new transforms on the other side, so they come in reverse. */
    static const enum node_step forward[] = {NODE_SCALE, NODE_ROTATE, NODE_TRANSLATE};
    node_reset_transform(&context->scene, node);
    for (int i = 0; i < NODE_STEPS; i++) {
        enum node_step kind = forward[context->scene.order == TRANSFORM_ORDER_OLD ? NODE_STEPS - 1 - i : i];
        if (!node_transform(&context->scene, node, kind, &steps[kind]))
            return error_no_memory(error, "a transform");
    }
    node->singular = singular;
    if (singular)
        scene_note_change(&context->scene);
    return true;
}

static bool gr_translate(struct script_context *context, const struct script_value *args, struct script_result *result,
                         struct error *error) {
    (void)result;
    struct transform by = transform_translate(step_of(args));
    return step(context, args, NODE_TRANSLATE, &by, error);
}

static const struct script_parameter order_parameters[] = {
    {"order", KIND_CHOICE, 0, 0, 0, LIST_BLANKS(TRANSFORM_ORDERS), NULL, NULL,
     "new: calls act in the order in which they are written; old: the last call acts first; separate: scale, then "
     "rotate, then translate."},
};

static bool gr_transform_order(struct script_context *context, const struct script_value *args,
                               struct script_result *result, struct error *error) {
    (void)result;
    (void)error;
    context->scene.order = (enum transform_order)args[0].choice;
    return true;
}

static bool gr_bounds(struct script_context *context, const struct script_value *args, struct script_result *result,
                      struct error *error) {
    struct box *box = arena_alloc(&context->sandbox.call, sizeof *box);
    if (!box)
        return error_no_memory(error, "a box");
    if (!node_bounds(args[SELF].node, box, error))
        return false;
    if (box_is_empty(box))
        return error_set(error, ERROR_SCENE, "no shape is below this node");
    result->pointer = box;
    return true;
}

static bool gr_faces(struct script_context *context, const struct script_value *args, struct script_result *result,
                     struct error *error) {
    (void)context;
    const struct node *node = args[SELF].node;
    if (node->kind != NODE_GEOMETRY || node->shape.kind != SHAPE_MESH)
        return error_set(error, ERROR_SCENE, "the node is not a mesh");
    result->mesh = node->shape.mesh;
    return true;
}

static const struct script_function method_rows[] = {
    GR("transform_order", order_parameters, RESULT_NOTHING, gr_transform_order,
       "Selects how scale, rotate and translate compose in this script.", "order"),
    NODE("add_child", child_parameters, RESULT_SELF, gr_add_child, "Adds a child to this node.", "node"),
    NODE("bounds", self_parameters, RESULT_BOUNDS, gr_bounds,
         "Returns the bounding box of this node and its children, with its own transforms: smallest and largest x, y, "
         "z.",
         ""),
    NODE("faces", self_parameters, RESULT_FACES, gr_faces,
         "Returns the vertices and faces of a mesh, in object space, as gr.mesh accepts them.", ""),
    NODE("set_material", set_material_parameters, RESULT_SELF, gr_set_material, "Sets the material of a shape.",
         "material"),
    NODE("set_texture", set_texture_parameters, RESULT_SELF, gr_set_texture, "Replaces kd of a shape by an image.",
         "texture"),
    NODE("set_bump", set_bump_parameters, RESULT_SELF, gr_set_bump, "Sets the bump map of a shape.", "bump"),
    NODE("scale", scale_parameters, RESULT_SELF, gr_scale, "Scales this node.", "x y z", "vector"),
    NODE("rotate", rotate_parameters, RESULT_SELF, gr_rotate, "Rotates this node about an axis.", "axis angle"),
    NODE("velocity", velocity_parameters, RESULT_SELF, gr_velocity,
         "Sets the velocity of this node per second while the shutter is open; its transforms are its pose at time 0.",
         "x y z", "vector"),
    NODE("moves_to", moves_to_parameters, RESULT_SELF, gr_moves_to,
         "Moves this node from its own pose at time 0 to the pose of another node at time 1, on the shorter rotation.",
         "node"),
    NODE("spin", spin_parameters, RESULT_SELF, gr_spin,
         "Rotates this node at a constant rate about an axis through the origin of its own space, before its "
         "transforms.",
         "axis degrees", "direction degrees"),
    NODE("reset", self_parameters, RESULT_SELF, gr_reset,
         "Removes the transforms of this node, so that an animation can set new ones in each frame.", ""),
    NODE("pose", pose_parameters, RESULT_SELF, gr_pose,
         "Replaces the transforms of this node by a scale, a rotation and a translation, as gr.keys interpolates them.",
         "translate rotate? scale?"),
    NODE("rotate_axis", rotate_axis_parameters, RESULT_SELF, gr_rotate_axis, "Rotates this node about any direction.",
         "axis angle"),
    NODE("rotate_quat", rotate_quat_parameters, RESULT_SELF, gr_rotate_quat, "Rotates this node by a quaternion.",
         "w x y z", "quaternion"),
    NODE("translate", translate_parameters, RESULT_SELF, gr_translate, "Translates this node.", "x y z", "vector"),
};
const struct function_rows method_functions = {method_rows, COUNT(method_rows)};
