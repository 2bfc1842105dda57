/* Shapes with many parts: lathe, prism, sweep, height field, blob, curve and patches. The parameters of a
 * shape live in the arena of the scene; the builder of the shape reports their errors. */
#include "call/context.h"
#include "mesh/patch.h"
#include "record/record_bounds.h"
#include "script/gr_bevel_internal.h"
#include "script/gr_displace_internal.h"
#include "script/gr_materials_internal.h"
#include "script/rows_internal.h"
#include "script/table_internal.h"
#include "shape/blob.h"
#include "shape/curve.h"
#include "shape/height_field.h"
#include "shape/implicit.h"
#include "shape/lathe.h"
#include "shape/prism.h"
#include "shape/sweep.h"

#include <string.h>

static bool give_node(struct script_context *context, const struct script_value *args, const char *otherwise,
                      const struct shape *shape, struct script_result *result, struct error *error) {
    const struct script_value *name = &args[SHAPE_NAME];
    struct node *node = scene_node(&context->scene, NODE_GEOMETRY, name->given ? name->text : otherwise, error);
    if (!node || !set_shape_fields(context, args, node, error))
        return false;
    node->shape = *shape;
    result->pointer = node;
    return true;
}

static enum spline_kind spline_or(const struct script_value *value, enum spline_kind otherwise) {
    return value->given ? (enum spline_kind)value->choice : otherwise;
}

/* One number for each of `count` points, or one for all of them. */
static bool one_each(struct script_context *context, const struct script_value *value, const char *name, uint32_t count,
                     const double **out, struct error *error) {
    double *all = arena_alloc_array(&context->sandbox.call, count, sizeof *all);
    if (!all)
        return error_no_memory(error, "the numbers of a shape");
    if (!value->single && value->count != count)
        return error_set(error, ERROR_SCENE, "%s has %u entries, but points has %u", name, value->count, count);
    for (uint32_t i = 0; i < count; i++)
        all[i] = value->numbers[value->single ? 0 : i];
    *out = all;
    return true;
}

enum { LATHE_POINTS = SHAPE_FIRST, LATHE_SPLINE, LATHE_LOOP, LATHE_OPEN };
#define SPLINE(otherwise, help)                                                                                        \
    { "spline", KIND_CHOICE, OPTIONAL, 0, 0, LIST_BLANKS(SPLINE_KINDS), NULL, "'" otherwise "'", help }
#define SPLINE_HELP "Kind of spline through the points; bezier needs 3 n + 1 points."

static const struct script_parameter lathe_parameters[] = {
    SHAPE("lathe"),
    [LATHE_POINTS] = {"points", KIND_PAIRS, 0, ANY, NULL, NULL, "The profile: pairs of radius and y."},
    [LATHE_SPLINE] = SPLINE("linear", SPLINE_HELP),
    [LATHE_LOOP] = {"loop", KIND_BOOLEAN, OPTIONAL, ANY, NULL, "false", "Whether the profile is closed."},
    [LATHE_OPEN] = {"open", KIND_BOOLEAN, OPTIONAL, ANY, NULL, "false", "Whether ends off the axis have no discs."},
};

static bool gr_lathe(struct script_context *context, const struct script_value *args, struct script_result *result,
                     struct error *error) {
    struct lathe_input in = {.kind = spline_or(&args[LATHE_SPLINE], SPLINE_LINEAR),
                             .points = args[LATHE_POINTS].pairs,
                             .count = args[LATHE_POINTS].count,
                             .loop = args[LATHE_LOOP].boolean,
                             .open = args[LATHE_OPEN].boolean};
    if (in.count < 2)
        return error_set(error, ERROR_SCENE, "points has %u entries, not 2 or more", in.count);
    struct shape shape = {.kind = SHAPE_LATHE, .lathe = lathe_build(&context->scene.arena, &in, error)};
    return shape.lathe && give_node(context, args, "lathe", &shape, result, error);
}

enum { PRISM_OUTLINE = SHAPE_FIRST, PRISM_HOLES, PRISM_FROM, PRISM_TO, PRISM_SPLINE, PRISM_EDGE, PRISM_CHAMFER };
static const struct script_parameter prism_parameters[] = {
    SHAPE("prism"),
    [PRISM_OUTLINE] = {"outline", KIND_PAIRS, 0, ANY, NULL, NULL, "A closed curve: pairs of x and z."},
    [PRISM_HOLES] = {"holes", KIND_CURVES, OPTIONAL, ANY, NULL, "none",
                     "More closed curves; the solid follows the even-odd rule."},
    [PRISM_FROM] = {"from", KIND_NUMBER, OPTIONAL, ANY, NULL, "0", "Height of the bottom."},
    [PRISM_TO] = {"to", KIND_NUMBER, OPTIONAL, ANY, NULL, "from + 1", "Height of the top."},
    [PRISM_SPLINE] = SPLINE("linear", "Kind of spline through the points; bezier needs 3 n points."),
    [PRISM_EDGE] = EDGE,
    [PRISM_CHAMFER] = CHAMFER,
};

static bool gr_prism(struct script_context *context, const struct script_value *args, struct script_result *result,
                     struct error *error) {
    const struct script_value *outline = &args[PRISM_OUTLINE], *holes = &args[PRISM_HOLES];
    uint32_t hole_points = holes->given ? holes->starts[holes->count] : 0,
             curves = 1 + (holes->given ? holes->count : 0);
    double(*points)[2] =
        arena_alloc_array(&context->sandbox.call, (size_t)outline->count + hole_points + 1, sizeof *points);
    uint32_t *starts = arena_alloc_array(&context->sandbox.call, (size_t)curves + 1, sizeof *starts);
    if (!points || !starts)
        return error_no_memory(error, "a prism");
    memcpy(points, outline->pairs, outline->count * sizeof *points);
    if (hole_points > 0)
        memcpy(points + outline->count, holes->pairs, hole_points * sizeof *points);
    for (uint32_t k = 1; k <= curves; k++)
        starts[k] = outline->count + (k > 1 ? holes->starts[k - 1] : 0);
    struct prism_input in = {.kind = spline_or(&args[PRISM_SPLINE], SPLINE_LINEAR),
                             .points = (const double(*)[2])points,
                             .curve_starts = starts,
                             .curve_count = curves};
    in.from = args[PRISM_FROM].number;
    in.to = args[PRISM_TO].given ? args[PRISM_TO].number : in.from + 1;
    if (has_bevel(&args[PRISM_EDGE])) {
        struct shape bevelled;
        return bevel_prism(context, &in, &args[PRISM_EDGE], &args[PRISM_CHAMFER], &bevelled, error) &&
               give_node(context, args, "prism", &bevelled, result, error);
    }
    struct shape shape = {.kind = SHAPE_PRISM, .prism = prism_build(&context->scene.arena, &in, error)};
    return shape.prism && give_node(context, args, "prism", &shape, result, error);
}

enum { SWEEP_POINTS = SHAPE_FIRST, SWEEP_RADII, SWEEP_SPLINE, SWEEP_LOOP };
static const struct script_parameter sweep_parameters[] = {
    SHAPE("sweep"),
    [SWEEP_POINTS] = {"points", KIND_POINTS, 0, ANY, NULL, NULL, "Path of the centre of the ball."},
    [SWEEP_RADII] = {"radii", KIND_NUMBERS, 0, ABOVE(0), NULL, NULL, "Radius at each point, or one for all."},
    [SWEEP_SPLINE] = SPLINE("catmull-rom", SPLINE_HELP),
    [SWEEP_LOOP] = {"loop", KIND_BOOLEAN, OPTIONAL, ANY, NULL, "false", "Whether the path is closed."},
};

static bool gr_sweep(struct script_context *context, const struct script_value *args, struct script_result *result,
                     struct error *error) {
    struct sweep_input in = {.kind = spline_or(&args[SWEEP_SPLINE], SPLINE_CATMULL_ROM),
                             .points = args[SWEEP_POINTS].points,
                             .count = args[SWEEP_POINTS].count,
                             .loop = args[SWEEP_LOOP].boolean};
    if (in.count < 2)
        return error_set(error, ERROR_SCENE, "points has %u entries, not 2 or more", in.count);
    if (!one_each(context, &args[SWEEP_RADII], "radii", in.count, &in.radii, error))
        return false;
    struct shape shape = {.kind = SHAPE_SWEEP, .sweep = sweep_build(&context->scene.arena, &in, error)};
    return shape.sweep && give_node(context, args, "sweep", &shape, result, error);
}

enum {
    IMPLICIT_F = SHAPE_FIRST,
    IMPLICIT_BOUNDS,
    IMPLICIT_RADIUS,
    IMPLICIT_CENTRE,
    IMPLICIT_OPEN,
    IMPLICIT_LIPSCHITZ,
    IMPLICIT_DISTANCE
};
static const struct script_parameter implicit_parameters[] = {
    SHAPE("implicit"),
    [IMPLICIT_F] = {"f", KIND_FUNCTION, 0, ANY, NULL, NULL, "A function of a point that is negative inside."},
    [IMPLICIT_BOUNDS] = {"bounds", KIND_POINTS, OPTIONAL, ANY, NULL, "a ball, if radius is given",
                         "Two corners {min, max} of the box that bounds it."},
    [IMPLICIT_RADIUS] = {"radius", KIND_NUMBER, OPTIONAL | LOW_OPEN, ABOVE(0), NULL, NULL,
                         "Radius of a ball that bounds it, instead of bounds."},
    [IMPLICIT_CENTRE] = {"centre", KIND_POINT, OPTIONAL, ANY, NULL, "{0, 0, 0}", "Centre of that ball."},
    [IMPLICIT_OPEN] = {"open", KIND_BOOLEAN, OPTIONAL, ANY, NULL, "false", "Whether there are no caps on the bounds."},
    [IMPLICIT_LIPSCHITZ] = {"lipschitz", KIND_NUMBER, OPTIONAL | LOW_OPEN, ABOVE(0), NULL, NULL,
                            "A bound of the slope of f: |f(a) - f(b)| <= lipschitz |a - b|."},
    [IMPLICIT_DISTANCE] = {"distance", KIND_BOOLEAN, OPTIONAL, ANY, NULL, "false",
                           "Whether |f| is at most the distance to the surface."},
};

static void use_in_bounds(struct script_context *context, const struct expr_program *program,
                          const struct shape *shape) {
    const struct box bounds = shape_bounds(shape);
    record_use(&context->sandbox, program, &bounds);
}

/* Operations for a line of an implicit solid. A picture of 640 x 480 needs minutes above the first number, and hours
 * above the second. */
static const double slow_line = 20000, refused_line = 200000;
#define ADVICE                                                                                                         \
    "declare distance = true if |f| is at most the distance to the surface, or lipschitz = L, a bound of the slope "   \
    "of f"

/* Reports a Lipschitz bound that does not hold, an empty solid, and bounds of values that are too wide. */
static bool examine_implicit(struct script_context *context, const struct implicit_input *in,
                             const struct implicit *solid, struct error *error) {
    struct implicit_findings found;
    if (!implicit_examine(solid, &found, error))
        return false;
    const struct vec3 at = found.steepest_at;
    if (found.line_work > refused_line)
        return error_set(
            error, ERROR_SCENE,
            "the bounds of f are too wide to find its surface in reasonable time, as of fractals: " ADVICE);
    /* Slow: a bound of the slopes may help, where the points support one. */
    if (found.marched_work > 0 && 2 * found.marched_work < found.line_work)
        context_warn_once(context, WARNED_SLOW,
                          "rays need %.0f operations each, and %.0f with lipschitz = %.4g, which the slopes of f at "
                          "%u points support",
                          found.line_work, found.marched_work, found.lipschitz, found.points);
    else if (found.line_work > slow_line)
        sandbox_warn(&context->sandbox, "the bounds of f are wide, so that rays need %.0f operations each: " ADVICE,
                     found.line_work);
    if (found.is_empty)
        sandbox_warn(&context->sandbox,
                     "f is negative at none of the points that were examined: if it is an estimate that stays "
                     "above 0, subtract a small distance from it");
    /* Slopes above the declared bound: rays may step over the surface. */
    if (found.steep_points > 0 && in->is_distance)
        sandbox_warn(&context->sandbox,
                     "|f| is above the distance to the surface at %u of %u points (%.3g times at {%.4g, %.4g, %.4g}), "
                     "so parts of the surface may be missing: divide f, or declare lipschitz instead of distance",
                     found.steep_points, found.points, found.steepest, at.x, at.y, at.z);
    else if (found.steep_points > 0)
        sandbox_warn(&context->sandbox,
                     "the slope of f is above lipschitz = %.4g at %u of %u points (%.3g at {%.4g, %.4g, %.4g}), so "
                     "parts of the surface may be missing: declare a larger bound, or divide f by it",
                     in->lipschitz, found.steep_points, found.points, found.steepest, at.x, at.y, at.z);
    return true;
}

static bool gr_implicit(struct script_context *context, const struct script_value *args, struct script_result *result,
                        struct error *error) {
    const struct script_value *bounds = &args[IMPLICIT_BOUNDS], *radius = &args[IMPLICIT_RADIUS];
    struct implicit_input in = {.program = args[IMPLICIT_F].program,
                                .is_ball = radius->given,
                                .centre = args[IMPLICIT_CENTRE].vector,
                                .radius = radius->number,
                                .open = args[IMPLICIT_OPEN].boolean,
                                .lipschitz = args[IMPLICIT_LIPSCHITZ].given    ? args[IMPLICIT_LIPSCHITZ].number
                                             : args[IMPLICIT_DISTANCE].boolean ? 1
                                                                               : 0};
    /* Fields that exclude or need each other. */
    in.is_distance = args[IMPLICIT_DISTANCE].boolean;
    if (args[IMPLICIT_LIPSCHITZ].given && in.is_distance)
        return error_set(error, ERROR_SCENE, "lipschitz and distance exclude each other");
    if (bounds->given == radius->given)
        return error_set(error, ERROR_SCENE,
                         radius->given ? "bounds and radius exclude each other"
                                       : "bounds is missing (or radius), for example "
                                         "bounds = {{-1, -1, -1}, {1, 1, 1}}");
    if (args[IMPLICIT_CENTRE].given && !radius->given)
        return error_set(error, ERROR_SCENE, "centre needs radius");
    if (bounds->given && bounds->count != 2)
        return error_set(error, ERROR_SCENE, "bounds has %u entries, not the two corners {min, max}", bounds->count);
    if (bounds->given)
        in.bounds = (struct box){vec3_make(bounds->points[0][0], bounds->points[0][1], bounds->points[0][2]),
                                 vec3_make(bounds->points[1][0], bounds->points[1][1], bounds->points[1][2])};
    /* The solid; notices about what would make it faster. */
    struct shape shape = {.kind = SHAPE_IMPLICIT, .implicit = implicit_build(&context->scene.arena, &in, error)};
    if (shape.implicit && !examine_implicit(context, &in, shape.implicit, error))
        return false;
    if (shape.implicit)
        use_in_bounds(context, in.program, &shape);
    return shape.implicit && give_node(context, args, "implicit", &shape, result, error);
}

enum { CURVE_POINTS = SHAPE_FIRST, CURVE_WIDTHS, CURVE_SPLINE, CURVE_FLAT };
static const struct script_parameter curve_parameters[] = {
    SHAPE("curve"),
    [CURVE_POINTS] = {"points", KIND_POINTS, 0, ANY, NULL, NULL, "Path of the curve."},
    [CURVE_WIDTHS] = {"widths", KIND_NUMBERS, 0, ABOVE(0), NULL, NULL, "Width at each point, or one for all."},
    [CURVE_SPLINE] = SPLINE("catmull-rom", SPLINE_HELP),
    [CURVE_FLAT] = {"flat", KIND_BOOLEAN, OPTIONAL, ANY, NULL, "false",
                    "Whether it is shaded as a flat ribbon instead of a round hair."},
};

static bool gr_curve(struct script_context *context, const struct script_value *args, struct script_result *result,
                     struct error *error) {
    struct curve_input in = {.kind = spline_or(&args[CURVE_SPLINE], SPLINE_CATMULL_ROM),
                             .points = args[CURVE_POINTS].points,
                             .count = args[CURVE_POINTS].count,
                             .flat = args[CURVE_FLAT].boolean};
    if (in.count < 2)
        return error_set(error, ERROR_SCENE, "points has %u entries, not 2 or more", in.count);
    if (!one_each(context, &args[CURVE_WIDTHS], "widths", in.count, &in.widths, error))
        return false;
    struct shape shape = {.kind = SHAPE_CURVE, .curve = curve_build(&context->scene.arena, &in, error)};
    return shape.curve && give_node(context, args, "curve", &shape, result, error);
}

/* Heights from rows of numbers, which must have equal lengths. */
static bool heights_of_rows(const struct script_value *rows, struct height_field_input *in, struct error *error) {
    in->rows = rows->count;
    in->columns = rows->count > 0 ? rows->starts[1] : 0;
    for (uint32_t j = 0; j < rows->count; j++) {
        uint32_t length = rows->starts[j + 1] - rows->starts[j];
        if (length != in->columns)
            return error_set(error, ERROR_SCENE, "heights[%u] has %u numbers, but heights[1] has %u", j + 1, length,
                             in->columns);
    }
    in->heights = rows->numbers;
    return in->rows > 1 && in->columns > 1
               ? true
               : error_set(error, ERROR_SCENE, "heights needs 2 rows of 2 numbers at least");
}

/* Heights 0 to 1 from the mean of red, green and blue; the picture's upper edge is z = 0. */
static bool heights_of_image(struct script_context *context, const struct script_value *value,
                             struct height_field_input *in, struct error *error) {
    struct image *image = gr_find_image(context, value, error);
    if (!image)
        return false;
    in->columns = image_width(image);
    in->rows = image_height(image);
    double *heights = arena_alloc_array(&context->sandbox.call, (size_t)in->columns * in->rows, sizeof *heights);
    if (!heights)
        return error_no_memory(error, "a height field");
    for (uint32_t j = 0; j < in->rows; j++)
        for (uint32_t i = 0; i < in->columns; i++) {
            struct rgba texel = image_texel(image, i, j);
            heights[(size_t)j * in->columns + i] = (texel.r + texel.g + texel.b) / 3;
        }
    in->heights = heights;
    return true;
}

enum {
    FIELD_HEIGHTS = SHAPE_FIRST,
    FIELD_IMAGE,
    FIELD_F,
    FIELD_COLUMNS,
    FIELD_ROWS,
    FIELD_FLOOR,
    FIELD_OPEN,
    FIELD_SMOOTH
};
enum { FUNCTION_SIDE = 257 };
static const struct script_parameter field_parameters[] = {
    SHAPE("height field"),
    [FIELD_HEIGHTS] = {"heights", KIND_ROWS, OPTIONAL, ANY, NULL, NULL,
                       "Rows of heights, all of one length; x varies within a row, z from row to row."},
    [FIELD_IMAGE] = {"image", KIND_IMAGE, OPTIONAL, ANY, NULL, NULL,
                     "A picture instead of heights: black is 0, white is 1, the upper edge is z = 0."},
    [FIELD_F] = {"f", KIND_FUNCTION, OPTIONAL, ANY, NULL, NULL,
                 "A function of the point {x, 0, z}: its height, or an offset that is added to heights or image."},
    [FIELD_COLUMNS] = {"columns", KIND_WHOLE, OPTIONAL, IN_RANGE(2, 32768), NULL, "257",
                       "Points along x at which f is evaluated, without heights and image."},
    [FIELD_ROWS] = {"rows", KIND_WHOLE, OPTIONAL, IN_RANGE(2, 32768), NULL, "columns", "Points along z."},
    [FIELD_FLOOR] = {"floor", KIND_NUMBER, OPTIONAL, ANY, NULL, "a tenth of the height range below the lowest point",
                     "Height of the floor of the solid."},
    [FIELD_OPEN] = {"open", KIND_BOOLEAN, OPTIONAL, ANY, NULL, "false", "Whether it has no walls and no floor."},
    [FIELD_SMOOTH] = {"smooth", KIND_BOOLEAN, OPTIONAL, ANY, NULL, "false", "Whether normals are interpolated."},
};

/* Heights from rows, from an image, or from a function, which may be added to them. */
static bool heights_of_field(struct script_context *context, const struct script_value *args,
                             struct height_field_input *in, struct error *error) {
    const struct script_value *rows = &args[FIELD_HEIGHTS], *image = &args[FIELD_IMAGE], *f = &args[FIELD_F];
    const struct script_value *columns = &args[FIELD_COLUMNS];
    bool has_table = rows->given || image->given;
    if (!has_table && !f->given)
        return error_set(error, ERROR_SCENE, "heights is missing (or image, the name of a file, or f, a function)");
    if ((columns->given || args[FIELD_ROWS].given) && (has_table || !f->given))
        return error_set(error, ERROR_SCENE, "columns and rows go with f, without heights and image");
    if (rows->given && !heights_of_rows(rows, in, error))
        return false;
    if (image->given && !heights_of_image(context, image, in, error))
        return false;
    if (!has_table) {
        in->columns = columns->given ? (uint32_t)columns->number : FUNCTION_SIDE;
        in->rows = args[FIELD_ROWS].given ? (uint32_t)args[FIELD_ROWS].number : in->columns;
    }
    if (f->given)
        in->heights = gr_function_heights(context, in, f->program, error);
    return in->heights != NULL;
}

static bool gr_height_field(struct script_context *context, const struct script_value *args,
                            struct script_result *result, struct error *error) {
    const struct script_value *rows = &args[FIELD_HEIGHTS], *image = &args[FIELD_IMAGE];
    struct height_field_input in = {.open = args[FIELD_OPEN].boolean, .smooth = args[FIELD_SMOOTH].boolean};
    if (rows->given && image->given)
        return error_set(error, ERROR_SCENE, "heights and image exclude each other");
    if (!heights_of_field(context, args, &in, error))
        return false;
    double low = INFINITY, high = -INFINITY;
    for (size_t i = 0; i < (size_t)in.columns * in.rows; i++) {
        low = math_min(low, in.heights[i]);
        high = math_max(high, in.heights[i]);
    }
    in.floor = args[FIELD_FLOOR].given ? args[FIELD_FLOOR].number : low - (high > low ? (high - low) / 10 : 0.1);
    struct shape shape = {.kind = SHAPE_HEIGHT_FIELD,
                          .height_field = height_field_build(&context->scene.arena, &in, error)};
    return shape.height_field && give_node(context, args, "height field", &shape, result, error);
}

/* Row k of a list of balls or cylinders: `width` numbers and optionally the strength. */
static bool blob_rows(const struct script_value *rows, const char *name, uint32_t width, struct blob_element *out,
                      struct error *error) {
    for (uint32_t k = 0; k < rows->count; k++) {
        const double *row = rows->numbers + rows->starts[k];
        uint32_t length = rows->starts[k + 1] - rows->starts[k];
        if (length != width && length != width + 1)
            return error_set(error, ERROR_SCENE, "%s[%u] has %u numbers, not %u or %u", name, k + 1, length, width,
                             width + 1);
        const double *end = row + (width == 7 ? 3 : 0);
        out[k].a = vec3_make(row[0], row[1], row[2]);
        out[k].b = vec3_make(end[0], end[1], end[2]);
        out[k].radius = row[width - 1];
        out[k].strength = length > width ? row[width] : 1;
        if (!(out[k].radius > 0) || out[k].strength == 0)
            return error_set(error, ERROR_SCENE, "%s[%u] has the radius %g and the strength %g", name, k + 1,
                             out[k].radius, out[k].strength);
    }
    return true;
}

enum { BLOB_SPHERES = SHAPE_FIRST, BLOB_CYLINDERS, BLOB_THRESHOLD };
static const struct script_parameter blob_parameters[] = {
    SHAPE("blob"),
    [BLOB_SPHERES] = {"spheres", KIND_ROWS, OPTIONAL, ANY, NULL, "{}",
                      "Balls {x, y, z, radius, strength}; the default strength is 1."},
    [BLOB_CYLINDERS] = {"cylinders", KIND_ROWS, OPTIONAL, ANY, NULL, "{}",
                        "Rods {x1, y1, z1, x2, y2, z2, radius, strength}; the default strength is 1."},
    [BLOB_THRESHOLD] =
        {"threshold", KIND_NUMBER, OPTIONAL | LOW_OPEN, ABOVE(0), NULL, "0.5",
         "The surface is where the sum of the fields strength (1 - (distance/radius)^2)^2 has this value."},
};

static bool gr_blob(struct script_context *context, const struct script_value *args, struct script_result *result,
                    struct error *error) {
    const struct script_value *balls = &args[BLOB_SPHERES], *rods = &args[BLOB_CYLINDERS];
    struct blob_input in = {.count = balls->count + rods->count, .threshold = 0.5};
    struct blob_element *elements = arena_alloc_array(&context->sandbox.call, (size_t)in.count + 1, sizeof *elements);
    if (!elements)
        return error_no_memory(error, "a blob");
    if (!blob_rows(balls, "spheres", 4, elements, error) ||
        !blob_rows(rods, "cylinders", 7, elements + balls->count, error))
        return false;
    if (in.count == 0)
        return error_set(error, ERROR_SCENE, "spheres is missing (or cylinders)");
    in.elements = elements;
    if (args[BLOB_THRESHOLD].given)
        in.threshold = args[BLOB_THRESHOLD].number;
    struct shape shape = {.kind = SHAPE_BLOB, .blob = blob_build(&context->scene.arena, &in, error)};
    return shape.blob && give_node(context, args, "blob", &shape, result, error);
}

enum { PATCH_POINTS = SHAPE_FIRST, PATCH_PATCHES, PATCH_TOLERANCE, PATCH_FLIP };
static const struct script_parameter patch_parameters[] = {
    SHAPE("patch"),
    [PATCH_POINTS] = {"points", KIND_POINTS, 0, ANY, NULL, NULL, "Control points, 16 for each patch, in 4 rows of 4."},
    [PATCH_PATCHES] = {"patches", KIND_FACES, OPTIONAL, ANY, NULL, "16 points each, in order",
                       "Tuples of 16 indices into points, from 0."},
    [PATCH_TOLERANCE] = {"tolerance", KIND_NUMBER, OPTIONAL | LOW_OPEN, ABOVE(0), NULL, "a thousandth of the size",
                         "Largest distance of the triangles from the exact surface."},
    [PATCH_FLIP] = {"flip", KIND_BOOLEAN, OPTIONAL, ANY, NULL, "false", "Whether the front is reversed."},
};

static bool gr_patch(struct script_context *context, const struct script_value *args, struct script_result *result,
                     struct error *error) {
    const struct script_value *points = &args[PATCH_POINTS], *patches = &args[PATCH_PATCHES];
    const char *name = args[SHAPE_NAME].given ? args[SHAPE_NAME].text : "patch";
    struct patch_input in = {.name = name, .points = points->points, .flip = args[PATCH_FLIP].boolean};
    in.tolerance = args[PATCH_TOLERANCE].number;
    /* 16 points for each patch, by indices or in order. */
    if (patches->given) {
        double(*all)[3] = arena_alloc_array(&context->sandbox.call, (size_t)patches->count * 16 + 1, sizeof *all);
        if (!all)
            return error_no_memory(error, "patches");
        for (uint32_t k = 0; k < patches->count; k++) {
            if (patches->starts[k + 1] - patches->starts[k] != 16)
                return error_set(error, ERROR_SCENE, "patches[%u] has %u indices, not 16", k + 1,
                                 patches->starts[k + 1] - patches->starts[k]);
            for (uint32_t i = 0; i < 16; i++) {
                uint32_t index = patches->indices[patches->starts[k] + i];
                if (index >= points->count)
                    return error_set(error, ERROR_SCENE,
                                     "patches[%u][%u] is %u, but there are %u points, counted from 0", k + 1, i + 1,
                                     index, points->count);
                memcpy(all[16 * (size_t)k + i], points->points[index], sizeof *all);
            }
        }
        in.points = (const double(*)[3])all;
        in.count = patches->count;
    } else if (points->count == 0 || points->count % 16 != 0) {
        return error_set(error, ERROR_SCENE, "points has %u entries, not 16 for each patch", points->count);
    } else {
        in.count = points->count / 16;
    }
    /* The mesh of all patches. */
    struct mesh_input input;
    if (!patch_tessellate(&context->sandbox.call, &in, &input, error))
        return false;
    struct shape shape = {.kind = SHAPE_MESH, .mesh = assets_mesh(context->scene.assets, &input, error)};
    return shape.mesh && give_node(context, args, "patch", &shape, result, error);
}

/* The rows of the table. */
static const struct script_function rows[] = {
    GR("lathe", lathe_parameters, RESULT_NODE, gr_lathe, "A surface of revolution: a profile rotated about the y axis.",
       "material points spline?", "name points spline?"),
    GR("prism", prism_parameters, RESULT_NODE, gr_prism, "An extrusion: an outline along y, with holes.",
       "material outline", "name outline"),
    GR("sweep", sweep_parameters, RESULT_NODE, gr_sweep,
       "A sphere sweep: the volume of a ball that moves along a spline.", "material points radii spline?",
       "name points radii spline?"),
    GR("height_field", field_parameters, RESULT_NODE, gr_height_field,
       "A height field over the square from 0 to 1 in x and z, solid down to its floor.", "material heights",
       "name heights"),
    GR("blob", blob_parameters, RESULT_NODE, gr_blob,
       "A blob (metaballs): the isosurface of the fields of balls and rods.", "material spheres cylinders? threshold?",
       "name spheres cylinders? threshold?"),
    GR("implicit", implicit_parameters, RESULT_NODE, gr_implicit,
       "An implicit solid: the points in a box or a ball where a function is negative.", "material f bounds",
       "name f bounds"),
    GR("curve", curve_parameters, RESULT_NODE, gr_curve, "A hair: a ribbon along a spline that faces each ray.",
       "material points widths spline?", "name points widths spline?"),
    GR("patch", patch_parameters, RESULT_NODE, gr_patch, "Bicubic Bezier patches, as a mesh.",
       "material points patches?", "name points patches?"),
};
const struct function_rows swept_functions = {rows, COUNT(rows)};
