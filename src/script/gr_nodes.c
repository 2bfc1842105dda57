/* Nodes and primitives. A primitive is a geometry node: everything that can have a pose is a node. */
#include "call/context.h"
#include "script/rows_internal.h"

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

enum { GROUP_NAME, GROUP_CHILDREN };
#define CHILDREN                                                                                                       \
    { "children", KIND_NODES, OPTIONAL, ANY, NULL, "{}", "Child nodes." }

static const struct script_parameter group_parameters[] = {
    [GROUP_NAME] = {"name", KIND_TEXT, OPTIONAL, ANY, NULL, "'node'", NAME_HELP},
    [GROUP_CHILDREN] = CHILDREN,
};

static bool gr_node(struct script_context *context, const struct script_value *args, struct script_result *result,
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

enum { INSTANCES_NAME, INSTANCES_OF, INSTANCES_AT, INSTANCES_TURN, INSTANCES_AXIS, INSTANCES_SIZE };
static const struct script_parameter instances_parameters[] = {
    [INSTANCES_NAME] = {"name", KIND_TEXT, OPTIONAL, ANY, NULL, "'instances'", NAME_HELP},
    [INSTANCES_OF] = {"of", KIND_NODE, 0, ANY, NULL, NULL, "The node to place."},
    [INSTANCES_AT] = {"at", KIND_ROWS, 0, ANY, NULL, NULL,
                      "Its positions, {x, y, z}, or matrices of three rows, 12 numbers each."},
    [INSTANCES_TURN] =
        {"turn", KIND_NUMBERS, OPTIONAL, ANY, "degrees", "0",
         "Angle of a rotation about axis, before the translation; one for each position, or one for all."},
    [INSTANCES_AXIS] = {"axis", KIND_AXIS, OPTIONAL, 0, 0, "x y z", NULL, "'y'", "Axis of that rotation."},
    [INSTANCES_SIZE] = {"size", KIND_NUMBERS, OPTIONAL | LOW_OPEN, ABOVE(0), NULL, "1",
                        "Scale factor, applied first; one for each position, or one for all."},
};

static bool gr_instances(struct script_context *context, const struct script_value *args, struct script_result *result,
                         struct error *error) {
    const struct script_value *at = &args[INSTANCES_AT];
    bool matrices = at->count > 0 && at->starts[1] == MATRIX_NUMBERS;
    if (!check_rows(at, matrices ? MATRIX_NUMBERS : PLACEMENT_NUMBERS, error))
        return false;
    if (matrices && (args[INSTANCES_TURN].given || args[INSTANCES_SIZE].given))
        return error_set(error, ERROR_SCENE, "turn and size need positions {x, y, z} in at, not matrices");
    /* The table belongs to the call, the positions to the scene. */
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

enum { JOINT_NAME, JOINT_X, JOINT_Y, JOINT_CHILDREN };
static const struct script_parameter joint_parameters[] = {
    [JOINT_NAME] = {"name", KIND_TEXT, OPTIONAL, ANY, NULL, "'joint'", NAME_HELP},
    [JOINT_X] = {"x", KIND_TRIPLE, OPTIONAL, ANY, "degrees", "{0, 0, 0}",
                 "Smallest, initial and largest angle about x; gray draws the initial one."},
    [JOINT_Y] = {"y", KIND_TRIPLE, OPTIONAL, ANY, "degrees", "{0, 0, 0}", "The same for y."},
    [JOINT_CHILDREN] = CHILDREN,
};

static bool gr_joint(struct script_context *context, const struct script_value *args, struct script_result *result,
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

enum { SPHERE_CENTRE = SHAPE_FIRST, SPHERE_RADIUS };
static const struct script_parameter sphere_parameters[] = {
    SHAPE("sphere"),
    [SPHERE_CENTRE] = {"centre", KIND_POINT, OPTIONAL, ANY, NULL, "{0, 0, 0}", "Centre."},
    [SPHERE_RADIUS] = {"radius", KIND_NUMBER, OPTIONAL | LOW_OPEN, ABOVE(0), NULL, "1", "Radius."},
};

static bool gr_sphere(struct script_context *context, const struct script_value *args, struct script_result *result,
                      struct error *error) {
    struct node *node = scene_node(&context->scene, NODE_GEOMETRY, text_or(&args[SHAPE_NAME], "sphere"), error);
    if (!node || !set_shape_fields(context, args, node, error))
        return false;
    node->shape.kind = SHAPE_SPHERE;
    node->shape.sphere.centre = args[SPHERE_CENTRE].vector;
    node->shape.sphere.radius = args[SPHERE_RADIUS].given ? args[SPHERE_RADIUS].number : 1;
    return give(result, node);
}

enum { CUBE_CORNER = SHAPE_FIRST, CUBE_SIZE };
static const struct script_parameter cube_parameters[] = {
    SHAPE("cube"),
    [CUBE_CORNER] = {"corner", KIND_POINT, OPTIONAL, ANY, NULL, "{0, 0, 0}",
                     "The corner with the smallest coordinates."},
    [CUBE_SIZE] = {"size", KIND_SIZE, OPTIONAL | NOT_ZERO, ANY, NULL, "1",
                   "Length of the edges, one number or three; a negative length extends in the negative direction."},
};

static bool gr_cube(struct script_context *context, const struct script_value *args, struct script_result *result,
                    struct error *error) {
    struct node *node = scene_node(&context->scene, NODE_GEOMETRY, text_or(&args[SHAPE_NAME], "cube"), error);
    if (!node || !set_shape_fields(context, args, node, error))
        return false;
    struct vec3 corner = args[CUBE_CORNER].vector, size = args[CUBE_SIZE].given ? args[CUBE_SIZE].vector : vec3_all(1);
    struct vec3 other = vec3_add(corner, size);
    node->shape.kind = SHAPE_BOX;
    node->shape.box = (struct box){vec3_min(corner, other), vec3_max(corner, other)};
    struct vec3 min = node->shape.box.min, max = node->shape.box.max;
    if (!(min.x < max.x && min.y < max.y && min.z < max.z))
        return error_set(error, ERROR_SCENE, "size is too small for this corner");
    return give(result, node);
}

enum { GEOMETRY_NAME, GEOMETRY_PRIMITIVE, GEOMETRY_MATERIAL };
static const struct script_parameter geometry_parameters[] = {
    [GEOMETRY_NAME] = {"name", KIND_TEXT, OPTIONAL, ANY, NULL, "'geometry'", NAME_HELP},
    [GEOMETRY_PRIMITIVE] = {"primitive", KIND_NODE, 0, ANY, NULL, NULL, "A primitive, for instance gr.sphere(mat)."},
    [GEOMETRY_MATERIAL] = {"material", KIND_MATERIAL, OPTIONAL | GHOST_IS_NONE, ANY, NULL, "the primitive's",
                           MATERIAL_HELP},
};

static bool gr_geometry(struct script_context *context, const struct script_value *args, struct script_result *result,
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
    node->walls = primitive->walls;
    node->texture = primitive->texture;
    node->bump = primitive->bump;
    node->operation = primitive->operation;
    node->operands = primitive->operands;
    node->operand_count = primitive->operand_count;
    /* The steps of its transform are changed by each node for itself. */
    if (primitive->separate) {
        node->separate = arena_alloc_array(&context->scene.arena, 3, sizeof *node->separate);
        if (!node->separate)
            return error_no_memory(error, "a node");
        memcpy(node->separate, primitive->separate, 3 * sizeof *node->separate);
    }
    /* Children are shared. */
    for (const struct node_child *child = primitive->first_child; child; child = child->next)
        if (!node_add_child(&context->scene, node, child->node, error))
            return false;
    return give(result, node);
}

/* An open surface has no inside. Open surfaces further below are found when the world is built. */
static bool check_operand(const struct node *operand, struct error *error) {
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
    if (!mesh_is_open(operand->shape.mesh))
        return true;
    const char *file = mesh_file(operand->shape.mesh);
    char edges[600];
    mesh_describe_open_edges(operand->shape.mesh, edges, sizeof edges);
    return error_set(error, ERROR_SCENE, "mesh '%s'%s%.200s is not closed, so it has no inside: %s", operand->name,
                     file ? " of " : "", file ? file : "", edges);
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

enum { CSG_NAME, CSG_A, CSG_B, CSG_OPERANDS };
static const struct script_parameter csg_parameters[] = {
    [CSG_NAME] = {"name", KIND_TEXT, OPTIONAL, ANY, NULL, "'csg'", NAME_HELP},
    [CSG_A] = {"a", KIND_NODE, GHOST_IS_NONE, ANY, NULL, NULL,
               "A closed solid; a group is the union of the solids below it."},
    [CSG_B] = {"b", KIND_NODE, GHOST_IS_NONE, ANY, NULL, NULL, "The second operand."},
    [CSG_OPERANDS] = {"operands", KIND_NODES, OPTIONAL | REST, ANY, NULL, NULL,
                      "Further operands: as extra arguments, as this list, or as unnamed entries of the table; a and b "
                      "may be left out then."},
};

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
    context_note_line(context);
    return give(result, scene_combine(&context->scene, name, operation, operands, known, error));
}

static bool gr_union(struct script_context *context, const struct script_value *args, struct script_result *result,
                     struct error *error) {
    return combine(context, NODE_UNION, args, result, error);
}

static bool gr_difference(struct script_context *context, const struct script_value *args, struct script_result *result,
                          struct error *error) {
    return combine(context, NODE_DIFFERENCE, args, result, error);
}

static bool gr_intersection(struct script_context *context, const struct script_value *args,
                            struct script_result *result, struct error *error) {
    return combine(context, NODE_INTERSECTION, args, result, error);
}

enum { INVERSE_NAME, INVERSE_A };
static const struct script_parameter inverse_parameters[] = {
    [INVERSE_NAME] = {"name", KIND_TEXT, OPTIONAL, ANY, NULL, "'inverse'", NAME_HELP},
    [INVERSE_A] = {"a", KIND_NODE, GHOST_IS_NONE, ANY, NULL, NULL,
                   "A closed solid; a group is the union of the solids below it."},
};

static bool gr_inverse(struct script_context *context, const struct script_value *args, struct script_result *result,
                       struct error *error) {
    struct node *solid = args[INVERSE_A].node;
    const char *name = text_or(&args[INVERSE_NAME], "inverse");
    if (!solid)
        return show_rest(context, name, NULL, result, error);
    return check_operand(solid, error) &&
           give(result, scene_combine(&context->scene, name, NODE_INVERSE, &solid, 1, error));
}

enum { CLIPPED_NAME, CLIPPED_OBJECT, CLIPPED_BY };
static const struct script_parameter clipped_parameters[] = {
    [CLIPPED_NAME] = {"name", KIND_TEXT, OPTIONAL, ANY, NULL, "'clipped'", NAME_HELP},
    [CLIPPED_OBJECT] = {"object", KIND_NODE, GHOST_IS_NONE, ANY, NULL, NULL,
                        "The visible object: a shape or a group of shapes."},
    [CLIPPED_BY] = {"by", KIND_NODE, GHOST_IS_NONE, ANY, NULL, NULL,
                    "A closed solid; the part of the object inside it remains."},
};

static const struct script_parameter bounded_parameters[] = {
    [CLIPPED_NAME] = {"name", KIND_TEXT, OPTIONAL, ANY, NULL, "'bounded'", NAME_HELP},
    [CLIPPED_OBJECT] = {"object", KIND_NODE, GHOST_IS_NONE, ANY, NULL, NULL,
                        "The visible object: a shape or a group of shapes."},
    [CLIPPED_BY] = {"by", KIND_NODE, GHOST_IS_NONE, ANY, NULL, NULL,
                    "A closed solid that contains the object. gray does not verify this: parts outside may or may not "
                    "be visible."},
};

static bool enclose(struct script_context *context, enum node_csg operation, const char *name,
                    const struct script_value *args, struct script_result *result, struct error *error) {
    struct node *operands[2] = {args[CLIPPED_OBJECT].node, args[CLIPPED_BY].node};
    if (!operands[0] || !operands[1])
        return show_rest(context, name, operands[0], result, error);
    return check_operand(operands[1], error) &&
           give(result, scene_combine(&context->scene, name, operation, operands, 2, error));
}

static bool gr_clipped_by(struct script_context *context, const struct script_value *args, struct script_result *result,
                          struct error *error) {
    return enclose(context, NODE_CLIPPED, text_or(&args[CLIPPED_NAME], "clipped"), args, result, error);
}

static bool gr_bounded_by(struct script_context *context, const struct script_value *args, struct script_result *result,
                          struct error *error) {
    return enclose(context, NODE_BOUNDED, text_or(&args[CLIPPED_NAME], "bounded"), args, result, error);
}

/* node:bounds(). */

static const struct script_function node_rows[] = {
    GR("node", group_parameters, RESULT_NODE, gr_node, "A node with children and a transform.", "name?"),
    GR("instances", instances_parameters, RESULT_NODE, gr_instances,
       "A node at many positions; each position costs a tenth of the memory of a node.", "of at"),
    GR("joint", joint_parameters, RESULT_NODE, gr_joint,
       "A node that rotates about x and y, with limits of the angles.", "name x? y?"),
    GR("sphere", sphere_parameters, RESULT_NODE, gr_sphere, "A sphere; by default of radius 1 at the origin.",
       "material", "name"),
    GR("cube", cube_parameters, RESULT_NODE, gr_cube, "A cube; by default from (0,0,0) to (1,1,1).", "material",
       "name"),
    GR("nh_sphere", sphere_parameters, RESULT_NODE, gr_sphere, "A sphere with centre and radius.", "name centre radius",
       "material centre radius"),
    GR("nh_box", cube_parameters, RESULT_NODE, gr_cube, "A cube with corner and size.", "name corner size",
       "material corner size"),
};
const struct function_rows node_functions = {node_rows, COUNT(node_rows)};

static const struct script_function solid_rows[] = {
    GR("geometry", geometry_parameters, RESULT_NODE, gr_geometry, "A node with the shape and material of a primitive.",
       "name primitive"),
    GR("csg_union", csg_parameters, RESULT_NODE, gr_union,
       "The union of solids: points in any operand. It has no inner walls.", "name a b", "a b"),
    GR("csg_difference", csg_parameters, RESULT_NODE, gr_difference,
       "The difference of solids: points in the first operand and in none of the others.", "name a b", "a b"),
    GR("csg_intersection", csg_parameters, RESULT_NODE, gr_intersection,
       "The intersection of solids: points in all operands.", "name a b", "a b"),
    GR("csg_merge", csg_parameters, RESULT_NODE, gr_union,
       "The same as gr.csg_union, which has no inner walls either; a plain node keeps them.", "name a b", "a b"),
    GR("csg_inverse", inverse_parameters, RESULT_NODE, gr_inverse,
       "The complement of a solid: the same surface, turned inside out.", "name a", "a"),
    GR("union", csg_parameters, RESULT_NODE, gr_union, "The same as gr.csg_union.", "name a b", "a b"),
    GR("difference", csg_parameters, RESULT_NODE, gr_difference, "The same as gr.csg_difference.", "name a b", "a b"),
    GR("intersection", csg_parameters, RESULT_NODE, gr_intersection, "The same as gr.csg_intersection.", "name a b",
       "a b"),
    GR("merge", csg_parameters, RESULT_NODE, gr_union, "The same as gr.csg_merge.", "name a b", "a b"),
    GR("inverse", inverse_parameters, RESULT_NODE, gr_inverse, "The same as gr.csg_inverse.", "name a", "a"),
    GR("clipped_by", clipped_parameters, RESULT_NODE, gr_clipped_by,
       "The part of the surfaces of an object that is inside a solid: cut open, without caps. It is not a CSG operand.",
       "name object by", "object by"),
    GR("bounded_by", bounded_parameters, RESULT_NODE, gr_bounded_by,
       "The object, with the hint that a solid contains it. This makes objects with a large bounding box faster.",
       "name object by", "object by"),
};
const struct function_rows solid_functions = {solid_rows, COUNT(solid_rows)};
