/* Nodes and primitives. A primitive is a geometry node: everything that can have a pose is a node. */
#include "call/context.h"
#include "scene/node_bounds.h"
#include "script/bindings_internal.h"

#include <string.h>

/* These functions return true with a result, or false with an error of the called function. */
static bool give(struct script_result *result, void *pointer) {
    result->pointer = pointer;
    return pointer != NULL;
}

static const char *text_or(const struct script_value *value, const char *otherwise) {
    return value->given ? value->text : otherwise;
}

static bool add_children(struct script_context *context, struct node *node, const struct script_value *children,
                         struct error *error) {
    for (uint32_t k = 0; k < children->count; k++)
        if (!node_add_child(&context->scene, node, children->nodes[k], error))
            return false;
    return true;
}

bool gr_node(struct script_context *context, const struct script_value *args, struct script_result *result,
             struct error *error) {
    struct node *node = scene_node(&context->scene, NODE_GROUP, text_or(&args[GROUP_NAME], "node"), error);
    return give(result, node) && add_children(context, node, &args[GROUP_CHILDREN], error);
}

/* A list with one number for each entry, or one for all; copied, since arguments live only during the call. */
static bool keep_numbers(struct script_context *context, const struct script_value *given, const char *name,
                         const struct placements *placements, const double **out, struct error *error) {
    if (!given->given)
        return true;
    if (!given->single && given->count != placements->count)
        return error_set(error, ERROR_SCENE, "%s has %u numbers for %u places", name, given->count, placements->count);
    double *kept = arena_alloc_array(&context->scene.arena, given->count, sizeof *kept);
    if (!kept)
        return error_no_memory(error, "the positions of instances");
    memcpy(kept, given->numbers, given->count * sizeof *kept);
    *out = kept;
    return true;
}

enum { PLACEMENT_NUMBERS = 3, MATRIX_NUMBERS = 12 };

static bool check_rows(const struct script_value *at, uint32_t length, struct error *error) {
    for (uint32_t i = 0; i < at->count; i++) {
        uint32_t found = at->starts[i + 1] - at->starts[i];
        if (found != length)
            return error_set(error, ERROR_SCENE, "at[%u] has %u numbers, not %s", i + 1, found,
                             i > 0 ? (length == PLACEMENT_NUMBERS ? "3 as those before" : "12 as those before")
                                   : "3 or 12");
        struct affine matrix;
        struct transform ignored;
        if (length != MATRIX_NUMBERS)
            continue;
        memcpy(matrix.m, at->numbers + (size_t)i * MATRIX_NUMBERS, sizeof matrix.m);
        if (!transform_from_affine(&matrix, &ignored))
            return error_set(error, ERROR_SCENE, "at[%u] is a singular matrix: it has no inverse", i + 1);
    }
    return true;
}

bool gr_instances(struct script_context *context, const struct script_value *args, struct script_result *result,
                  struct error *error) {
    const struct script_value *at = &args[INSTANCES_AT];
    bool matrices = at->count > 0 && at->starts[1] == MATRIX_NUMBERS;
    if (!check_rows(at, matrices ? MATRIX_NUMBERS : PLACEMENT_NUMBERS, error))
        return false;
    if (matrices && (args[INSTANCES_TURN].given || args[INSTANCES_SIZE].given))
        return error_set(error, ERROR_SCENE, "turn and size need positions {x, y, z} in at, not matrices");
    struct node *node = scene_node(&context->scene, NODE_GROUP, text_or(&args[INSTANCES_NAME], "instances"), error);
    struct placements *placements = arena_alloc(&context->scene.arena, sizeof *placements);
    size_t numbers = (size_t)at->count * (matrices ? MATRIX_NUMBERS : PLACEMENT_NUMBERS);
    double *kept = arena_alloc_array(&context->scene.arena, numbers, sizeof *kept);
    if (!node || !placements || !kept)
        return error_no_memory(error, "the positions of instances");
    if (numbers > 0)
        memcpy(kept, at->numbers, numbers * sizeof *kept);
    placements->count = at->count;
    placements->at = matrices ? NULL : (const double(*)[3])kept;
    placements->matrices = matrices ? (const struct affine *)kept : NULL;
    placements->axis = args[INSTANCES_AXIS].given ? args[INSTANCES_AXIS].choice : 1;
    placements->one_turn = args[INSTANCES_TURN].single;
    placements->one_size = args[INSTANCES_SIZE].single;
    node->placements = placements;
    result->pointer = node;
    return keep_numbers(context, &args[INSTANCES_TURN], "turn", placements, &placements->turn, error) &&
           keep_numbers(context, &args[INSTANCES_SIZE], "size", placements, &placements->size, error) &&
           node_add_child(&context->scene, node, args[INSTANCES_OF].node, error);
}

bool gr_joint(struct script_context *context, const struct script_value *args, struct script_result *result,
              struct error *error) {
    struct node *node = scene_node(&context->scene, NODE_JOINT, text_or(&args[JOINT_NAME], "joint"), error);
    if (!node)
        return false;
    struct vec3 x = args[JOINT_X].vector, y = args[JOINT_Y].vector;
    node->joint_x.min = x.x, node->joint_x.init = x.y, node->joint_x.max = x.z;
    node->joint_y.min = y.x, node->joint_y.init = y.y, node->joint_y.max = y.z;
    result->pointer = node;
    return add_children(context, node, &args[JOINT_CHILDREN], error);
}

bool gr_sphere(struct script_context *context, const struct script_value *args, struct script_result *result,
               struct error *error) {
    struct node *node = scene_node(&context->scene, NODE_GEOMETRY, text_or(&args[SPHERE_NAME], "sphere"), error);
    if (!node)
        return false;
    node->material = args[SPHERE_MATERIAL].material;
    node->shape.kind = SHAPE_SPHERE;
    node->shape.sphere.centre = args[SPHERE_CENTRE].vector;
    node->shape.sphere.radius = args[SPHERE_RADIUS].given ? args[SPHERE_RADIUS].number : 1;
    return give(result, node);
}

bool gr_cube(struct script_context *context, const struct script_value *args, struct script_result *result,
             struct error *error) {
    struct node *node = scene_node(&context->scene, NODE_GEOMETRY, text_or(&args[CUBE_NAME], "cube"), error);
    if (!node)
        return false;
    struct vec3 corner = args[CUBE_CORNER].vector, size = args[CUBE_SIZE].given ? args[CUBE_SIZE].vector : vec3_all(1);
    struct vec3 other = vec3_add(corner, size);
    node->material = args[CUBE_MATERIAL].material;
    node->shape.kind = SHAPE_BOX;
    node->shape.box = (struct box){vec3_min(corner, other), vec3_max(corner, other)};
    struct vec3 min = node->shape.box.min, max = node->shape.box.max;
    if (!(min.x < max.x && min.y < max.y && min.z < max.z))
        return error_set(error, ERROR_SCENE, "size is too small for this corner");
    return give(result, node);
}

bool gr_geometry(struct script_context *context, const struct script_value *args, struct script_result *result,
                 struct error *error) {
    const struct node *primitive = args[GEOMETRY_PRIMITIVE].node;
    if (primitive->kind != NODE_GEOMETRY && primitive->kind != NODE_CSG)
        return error_set(error, ERROR_SCENE, "primitive must be a shape, not the plain node '%s'", primitive->name);
    struct node *node = scene_node(&context->scene, primitive->kind, text_or(&args[GEOMETRY_NAME], "geometry"), error);
    if (!node)
        return false;
    node->singular = primitive->singular;
    node->parent_from_node = primitive->parent_from_node;
    node->shape = primitive->shape;
    node->material = args[GEOMETRY_MATERIAL].given ? args[GEOMETRY_MATERIAL].material : primitive->material;
    node->slots = primitive->slots;
    node->slot_names = primitive->slot_names;
    node->slot_count = primitive->slot_count;
    node->cull = primitive->cull;
    node->texture = primitive->texture;
    node->bump = primitive->bump;
    node->operation = primitive->operation;
    node->operands = primitive->operands;
    node->operand_count = primitive->operand_count;
    if (primitive->separate) {
        node->separate = arena_alloc_array(&context->scene.arena, 3, sizeof *node->separate);
        if (!node->separate)
            return error_no_memory(error, "a node");
        memcpy(node->separate, primitive->separate, 3 * sizeof *node->separate);
    }
    for (const struct node_child *child = primitive->first_child; child; child = child->next)
        if (!node_add_child(&context->scene, node, child->node, error))
            return false;
    return give(result, node);
}

/* An open surface has no inside. Open surfaces further below are found when the world is built. */
static bool check_operand(const struct node *operand, struct error *error) {
    struct vec3 a, b;
    if (operand->kind == NODE_CSG && operand->operation == NODE_CLIPPED)
        return error_set(error, ERROR_SCENE,
                         "'%s' is clipped, cut open without caps, so it has no inside; intersect it instead",
                         operand->name);
    if (operand->kind != NODE_GEOMETRY)
        return true;
    if (operand->shape.kind != SHAPE_MESH) {
        const char *why = shape_why_open(&operand->shape);
        return !why || error_set(error, ERROR_SCENE, "'%s' %s", operand->name, why);
    }
    if (!mesh_open_edge(operand->shape.mesh, &a, &b))
        return true;
    const char *file = mesh_file(operand->shape.mesh);
    return error_set(error, ERROR_SCENE,
                     "mesh '%s'%s%.200s is not closed, so it has no inside: the edge from {%.6g, %.6g, %.6g} to "
                     "{%.6g, %.6g, %.6g} is open",
                     operand->name, file ? " of " : "", file ? file : "", a.x, a.y, a.z, b.x, b.y, b.z);
}

/* With --lenient an operand may be a feature that does not exist yet. The result shows the other operands, unless they
 * were to be subtracted from it: a plain node with the remaining one, or nothing. */
static bool show_rest(struct script_context *context, const char *name, struct node *rest, struct script_result *result,
                      struct error *error) {
    struct node *node = scene_node(&context->scene, NODE_GROUP, name, error);
    if (!node || (rest && !node_add_child(&context->scene, node, rest, error)))
        return false;
    return give(result, node);
}

/* a and b if they are given (ghosts are not), and those of the list, which has NULL for ghosts. */
static struct node **list_operands(struct script_context *context, const struct script_value *args, uint32_t *count) {
    const struct script_value *list = &args[CSG_OPERANDS];
    bool named = !list->given || list->single || args[CSG_A].given || args[CSG_B].given;
    struct node **operands = arena_alloc_array(&context->sandbox.call, (size_t)list->count + 2, sizeof *operands);
    *count = 0;
    if (operands && named) {
        operands[(*count)++] = args[CSG_A].node;
        operands[(*count)++] = args[CSG_B].node;
    }
    for (uint32_t k = 0; operands && k < list->count; k++)
        operands[(*count)++] = list->nodes[k];
    return operands;
}

static bool combine(struct script_context *context, enum node_csg operation, const struct script_value *args,
                    struct script_result *result, struct error *error) {
    uint32_t count, known = 0;
    const char *name = text_or(&args[CSG_NAME], "csg");
    struct node **operands = list_operands(context, args, &count);
    if (!operands)
        return error_no_memory(error, "the operands");
    if (count == 0)
        return error_set(error, ERROR_SCENE, "operands are missing");
    bool nothing = operation == NODE_DIFFERENCE && !operands[0];
    for (uint32_t k = 0; k < count; k++)
        if (operands[k])
            operands[known++] = operands[k];
    if (known == 0 || nothing || (known == 1 && count > 1))
        return show_rest(context, name, nothing || known == 0 ? NULL : operands[0], result, error);
    for (uint32_t k = 0; k < known; k++)
        if (!check_operand(operands[k], error))
            return false;
    return give(result, scene_combine(&context->scene, name, operation, operands, known, error));
}

bool gr_union(struct script_context *context, const struct script_value *args, struct script_result *result,
              struct error *error) {
    return combine(context, NODE_UNION, args, result, error);
}

bool gr_difference(struct script_context *context, const struct script_value *args, struct script_result *result,
                   struct error *error) {
    return combine(context, NODE_DIFFERENCE, args, result, error);
}

bool gr_intersection(struct script_context *context, const struct script_value *args, struct script_result *result,
                     struct error *error) {
    return combine(context, NODE_INTERSECTION, args, result, error);
}

bool gr_inverse(struct script_context *context, const struct script_value *args, struct script_result *result,
                struct error *error) {
    struct node *solid = args[INVERSE_A].node;
    const char *name = text_or(&args[INVERSE_NAME], "inverse");
    if (!solid)
        return show_rest(context, name, NULL, result, error);
    return check_operand(solid, error) &&
           give(result, scene_combine(&context->scene, name, NODE_INVERSE, &solid, 1, error));
}

static bool enclose(struct script_context *context, enum node_csg operation, const char *name,
                    const struct script_value *args, struct script_result *result, struct error *error) {
    struct node *operands[2] = {args[CLIPPED_OBJECT].node, args[CLIPPED_BY].node};
    if (!operands[0] || !operands[1])
        return show_rest(context, name, operands[0], result, error);
    return check_operand(operands[1], error) &&
           give(result, scene_combine(&context->scene, name, operation, operands, 2, error));
}

bool gr_clipped_by(struct script_context *context, const struct script_value *args, struct script_result *result,
                   struct error *error) {
    return enclose(context, NODE_CLIPPED, text_or(&args[CLIPPED_NAME], "clipped"), args, result, error);
}

bool gr_bounded_by(struct script_context *context, const struct script_value *args, struct script_result *result,
                   struct error *error) {
    return enclose(context, NODE_BOUNDED, text_or(&args[CLIPPED_NAME], "bounded"), args, result, error);
}

bool gr_transform_order(struct script_context *context, const struct script_value *args, struct script_result *result,
                        struct error *error) {
    (void)result;
    (void)error;
    context->scene.order = (enum transform_order)args[0].choice;
    return true;
}

/* node:bounds(). */

bool gr_bounds(struct script_context *context, const struct script_value *args, struct script_result *result,
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
