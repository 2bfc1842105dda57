/* Displacement by recorded functions: node:displace of meshes and height fields. */
#include "script/gr_displace_internal.h"

#include "expr/expr_field.h"
#include "mesh/mesh_displace.h"
#include "record/record_bounds.h"
#include "scene/traversal.h"
#include "script/rows_internal.h"
#include "script/script_internal.h"
#include "script/table_internal.h"
#include "shape/height_field.h"

#include <math.h>

enum { MAX_LEVEL = 12 };
#define CREASE 60.0

/* One call of node:displace. */
struct displacing {
    struct script_context *context;
    struct mesh_displacement by;
    double smooth; /* degrees */
    double parts;  /* without edge and level: how many edges the extent of a shape has at least; else 0 */
};

/* So fine that edges of a shape as large as the picture have a few pixels. Steps, so that the same mesh serves pictures
 * of similar sizes. */
static double parts_for_picture(const struct script_context *context) {
    enum { USUAL = 960, SMALL = 512, LARGE = 1024 };
    const struct script_host *host = script_of(context)->host;
    const double larger = host->width > host->height ? host->width : host->height, pixels = larger > 0 ? larger : USUAL;
    return pixels <= SMALL ? 128 : pixels <= LARGE ? 256 : 512;
}

/* For a shape of this extent. */
static struct mesh_displacement displacement_of(const struct displacing *d, double extent) {
    struct mesh_displacement by = d->by;
    if (d->parts > 0)
        by.edge = extent / d->parts;
    return by;
}

static bool displace_mesh(const struct displacing *d, struct node *node, struct error *error) {
    struct mesh_input input;
    struct mesh_tables own = {0};
    struct mesh *mesh = NULL;
    const struct box bounds = mesh_bounds(node->shape.mesh);
    const struct mesh_displacement by = displacement_of(d, vec3_length(vec3_sub(bounds.max, bounds.min)));
    record_use(&d->context->sandbox, d->by.program, &bounds);
    if (mesh_input_displace(node->shape.mesh, &by, &input, &own, error)) {
        input.name = node->name;
        if (mesh_input_smooth(&input, &own, d->smooth, error))
            mesh = assets_mesh(d->context->scene.assets, &input, error);
    }
    mesh_tables_destroy(&own);
    if (mesh)
        node->shape.mesh = mesh;
    scene_note_change(&d->context->scene);
    return mesh != NULL;
}

/* --- height fields --- */

static void grid_inputs(const void *context, size_t i, double inputs[EXPR_INPUT_COUNT]) {
    const struct height_field_input *grid = context;
    double x = (double)(i % grid->columns) / (grid->columns - 1), z = (double)(i / grid->columns) / (grid->rows - 1);
    inputs[EXPR_POINT_X] = x;
    inputs[EXPR_POINT_Y] = grid->heights ? grid->heights[i] : 0;
    inputs[EXPR_POINT_Z] = z;
}

/* The heights of the grid, or 0 if there are none, plus those of the function; in the arena of the call. */
const double *gr_function_heights(struct script_context *context, const struct height_field_input *grid,
                                  const struct expr_program *program, struct error *error) {
    size_t count = (size_t)grid->columns * grid->rows;
    const struct expr_points points = {count, grid_inputs, grid};
    if (program->output_count != 1) {
        (void)error_set(error, ERROR_SCENE, "the height of a height field is a number, not a vector");
        return NULL;
    }
    if (!expr_field_reads_only(program, EXPR_POINT_INPUTS, "a height may depend only on the point", error))
        return NULL;
    if (2 * (uint64_t)(grid->columns - 1) * (grid->rows - 1) > DISPLACED_TRIANGLES) {
        (void)error_set(error, ERROR_SCENE, "%u columns and %u rows are more than %d triangles", grid->columns,
                        grid->rows, DISPLACED_TRIANGLES);
        return NULL;
    }
    const struct box square = {{0, 0, 0}, {1, 0, 1}};
    /* Where it is used it is compared with Lua, before the next picture. */
    record_use(&context->sandbox, program, &square);
    double *heights = arena_alloc_array(&context->sandbox.call, count, sizeof *heights);
    if (!heights) {
        (void)error_no_memory(error, "a height field");
        return NULL;
    }
    if (!expr_field_evaluate(program, &points, heights, error))
        return NULL;
    for (size_t i = 0; grid->heights && i < count; i++)
        heights[i] += grid->heights[i];
    return heights;
}

/* The grid becomes so fine that the sides and diagonals of its cells on the ground are at most `edge` long. */
static bool displace_field(const struct displacing *d, struct node *node, struct error *error) {
    struct height_field_input grid;
    const struct mesh_displacement by = displacement_of(d, sqrt(2)); /* of the unit square */
    uint32_t n = 1U << by.level;
    if (by.edge > 0) {
        double steps = ceil(height_field_step(node->shape.height_field) / by.edge);
        n = steps < 1 ? 1 : steps < 40000 ? (uint32_t)steps : 40000;
    }
    if (!height_field_refine(node->shape.height_field, n, &d->context->sandbox.call, &grid, error))
        return false;
    grid.heights = gr_function_heights(d->context, &grid, d->by.program, error);
    if (!grid.heights)
        return false;
    const struct height_field *field = height_field_build(&d->context->scene.arena, &grid, error);
    if (field)
        node->shape.height_field = field;
    scene_note_change(&d->context->scene);
    return field != NULL;
}

/* --- nodes --- */

static bool displace_node(const struct displacing *d, struct node *node, struct error *error) {
    switch ((unsigned)node->shape.kind) { /* no list: every other shape, new ones too, has no vertices */
    case SHAPE_MESH:
        return displace_mesh(d, node, error);
    case SHAPE_HEIGHT_FIELD:
        return displace_field(d, node, error);
    default:
        return error_set(error, ERROR_SCENE,
                         "%s '%.100s' has no vertices; only meshes, patches and height fields are displaced",
                         shape_kind_name(node->shape.kind), node->name);
    }
}

/* Visits every shape at the node and below it once. */
static bool displace_all(const struct displacing *d, const struct node *root, struct error *error) {
    struct scene_traversal t = {.operands = OPERANDS_ALL, .distinct = true};
    struct scene *scene = &d->context->scene;
    uint8_t *done = arena_alloc_array(&d->context->sandbox.call, (size_t)scene->node_total + 1, sizeof *done);
    uint32_t count = 0;
    enum scene_event event;
    bool ok = done || error_no_memory(error, "a displacement");
    scene_traversal_begin(&t, root);
    while (ok && (event = scene_traversal_next(&t)) != SCENE_END) {
        ok = event != SCENE_NO_MEMORY || error_no_memory(error, "a displacement");
        if (event != SCENE_ENTER)
            continue;
        /* Nodes belong to the script, which may change them; the traversal only reads them. */
        struct node *node = (struct node *)(uintptr_t)scene_traversal_node(&t);
        bool is_done = done[node->index] != 0;
        done[node->index] = 1;
        if (is_done)
            scene_traversal_skip(&t);
        if (is_done || node->kind != NODE_GEOMETRY)
            continue;
        count++;
        ok = displace_node(d, node, error);
    }
    scene_traversal_end(&t);
    return ok && (count > 0 || error_set(error, ERROR_SCENE, "there is no shape that can be displaced"));
}

enum { DISPLACE_F = SELF + 1, DISPLACE_EDGE, DISPLACE_LEVEL, DISPLACE_SMOOTH };
static const struct script_parameter displace_parameters[] = {
    SELF_PARAMETER,
    [DISPLACE_F] = {"f", KIND_FUNCTION, OPTIONAL, ANY, NULL, NULL,
                    "A function f(p, s) of a vertex: the distance along its normal, or an offset {x, y, z}."},
    [DISPLACE_EDGE] = {"edge", KIND_NUMBER, OPTIONAL | LOW_OPEN, ABOVE(0), NULL, "a part of the extent",
                       "Longer edges are halved, until none is longer, before vertices move."},
    [DISPLACE_LEVEL] = {"level", KIND_WHOLE, OPTIONAL, IN_RANGE(0, MAX_LEVEL), NULL, "edge",
                        "Instead of edge: how often every edge is halved."},
    [DISPLACE_SMOOTH] = {"smooth", KIND_NUMBER, OPTIONAL, IN_RANGE(0, 180), "degrees", "60",
                         "Crease angle of the displaced mesh, as in gr.mesh; 0: all faces are flat."},
};

static bool gr_displace(struct script_context *context, const struct script_value *args, struct script_result *result,
                        struct error *error) {
    (void)result;
    const struct script_value *edge = &args[DISPLACE_EDGE], *level = &args[DISPLACE_LEVEL];
    const struct displacing d = {.context = context,
                                 .by = {args[DISPLACE_F].program, edge->number, (int)level->number},
                                 .smooth = args[DISPLACE_SMOOTH].given ? args[DISPLACE_SMOOTH].number : CREASE,
                                 .parts = edge->given || level->given ? 0 : parts_for_picture(context)};
    if (!args[DISPLACE_F].given)
        return error_set(error, ERROR_SCENE, "f is missing, a function of a vertex");
    if (edge->given && level->given)
        return error_set(error, ERROR_SCENE, "edge and level exclude each other");
    return displace_all(&d, args[SELF].node, error);
}

static const struct script_function rows[] = {
    NODE("displace", displace_parameters, RESULT_SELF, gr_displace,
         "Divides meshes, patches and height fields into small triangles and moves their vertices by a function.",
         "f edge?"),
};
const struct function_rows displace_functions = {rows, COUNT(rows)};
