/* Analytic shapes: every row of the table becomes a geometry node with one shape. Checked here are the conditions on
 * several numbers together, which the table cannot express, and sizes that the root-finders cannot handle. */
#include "call/context.h"
#include "math/range.h"
#include "script/gr_bevel_internal.h"
#include "script/rows_internal.h"
#include "script/table_internal.h"
#include "shape/planar.h"
#include "shape/revolved_quadric.h"

#define LENGTH(name, fallback, help)                                                                                   \
    { name, KIND_NUMBER, OPTIONAL | LOW_OPEN, ABOVE(0), NULL, fallback, help }
#define POSITION(name, fallback, help)                                                                                 \
    { name, KIND_POINT, OPTIONAL, ANY, NULL, fallback, help }
#define OPEN_ENDS                                                                                                      \
    {                                                                                                                  \
        "open", KIND_BOOLEAN, OPTIONAL, ANY, NULL, "false",                                                            \
            "Whether it has no caps; without caps it is not a solid for CSG."                                          \
    }

static struct node *shape_node(struct script_context *context, const struct script_value *args, const char *otherwise,
                               struct error *error) {
    const struct script_value *name = &args[SHAPE_NAME];
    struct node *node = scene_node(&context->scene, NODE_GEOMETRY, name->given ? name->text : otherwise, error);
    return node && set_shape_fields(context, args, node, error) ? node : NULL;
}

static bool give_shape(struct node *node, const struct shape *shape, struct script_result *result) {
    if (!node)
        return false;
    node->shape = *shape;
    result->pointer = node;
    return true;
}

static double number_or(const struct script_value *value, double otherwise) {
    return value->given ? value->number : otherwise;
}

static struct vec3 vector_or(const struct script_value *value, double x, double y, double z) {
    return value->given ? value->vector : vec3_make(x, y, z);
}

/* A length that must not be zero. */
static bool length_is_fine(double length, const char *name, struct error *error) {
    if (length >= NUMBER_SMALLEST && length <= NUMBER_LIMIT)
        return true;
    return error_set(error, ERROR_SCENE, "%s is too %s: %g", name, length > 1 ? "large" : "small", length);
}

/* Two end points that differ. */
static bool ends_are_fine(struct vec3 from, struct vec3 to, struct error *error) {
    double length = vec3_length(vec3_sub(to, from));
    if (!(length > 0))
        return error_set(error, ERROR_SCENE, "from and to are the same point");
    return length_is_fine(length, "the distance of from and to", error);
}

enum { CYLINDER_FROM = SHAPE_FIRST, CYLINDER_TO, CYLINDER_RADIUS, CYLINDER_OPEN, CYLINDER_EDGE, CYLINDER_CHAMFER };
static const struct script_parameter cylinder_parameters[] = {
    SHAPE("cylinder"),
    [CYLINDER_FROM] = POSITION("from", "{0, -1, 0}", "Centre of one end."),
    [CYLINDER_TO] = POSITION("to", "{0, 1, 0}", "Centre of the other end."),
    [CYLINDER_RADIUS] = LENGTH("radius", "1", "Radius."),
    [CYLINDER_OPEN] = OPEN_ENDS,
    [CYLINDER_EDGE] = EDGE,
    [CYLINDER_CHAMFER] = CHAMFER,
};

static bool gr_cylinder(struct script_context *context, const struct script_value *args, struct script_result *result,
                        struct error *error) {
    struct vec3 from = vector_or(&args[CYLINDER_FROM], 0, -1, 0), to = vector_or(&args[CYLINDER_TO], 0, 1, 0);
    double radius = number_or(&args[CYLINDER_RADIUS], 1);
    if (!ends_are_fine(from, to, error) || !length_is_fine(radius, "radius", error))
        return false;
    struct node *node = shape_node(context, args, "cylinder", error);
    struct shape shape = {.kind = SHAPE_REVOLVED_QUADRIC,
                          .revolved_quadric = revolved_quadric_cylinder(from, to, radius, args[CYLINDER_OPEN].boolean)};
    struct bevelled_cylinder bevelled = {.from = from, .to = to, .radius = radius};
    if (has_bevel(&args[CYLINDER_EDGE]) && args[CYLINDER_OPEN].boolean)
        return error_set(error, ERROR_SCENE, "edge needs a cylinder with caps, and open is true");
    if (node && has_bevel(&args[CYLINDER_EDGE]) &&
        !bevel_cylinder(context, &bevelled, &args[CYLINDER_EDGE], &args[CYLINDER_CHAMFER], &shape, error))
        return false;
    return give_shape(node, &shape, result);
}

enum { CONE_FROM = SHAPE_FIRST, CONE_TO, CONE_FROM_RADIUS, CONE_RADIUS, CONE_OPEN };
static const struct script_parameter cone_parameters[] = {
    SHAPE("cone"),
    [CONE_FROM] = POSITION("from", "{0, 0, 0}", "The apex, or the centre of the end with from_radius."),
    [CONE_TO] = POSITION("to", "{0, 1, 0}", "Centre of the end with radius."),
    [CONE_FROM_RADIUS] = {"from_radius", KIND_NUMBER, OPTIONAL, ABOVE(0), NULL, "0",
                          "Radius at from; above 0 it is a frustum."},
    [CONE_RADIUS] = {"radius", KIND_NUMBER, OPTIONAL, ABOVE(0), NULL, "1", "Radius at to."},
    [CONE_OPEN] = OPEN_ENDS,
};

static bool gr_cone(struct script_context *context, const struct script_value *args, struct script_result *result,
                    struct error *error) {
    struct vec3 from = vector_or(&args[CONE_FROM], 0, 0, 0), to = vector_or(&args[CONE_TO], 0, 1, 0);
    double first = number_or(&args[CONE_FROM_RADIUS], 0), second = number_or(&args[CONE_RADIUS], 1);
    if (!ends_are_fine(from, to, error) || !length_is_fine(math_max(first, second), "the larger radius", error))
        return false;
    struct node *node = shape_node(context, args, "cone", error);
    struct shape shape = {.kind = SHAPE_REVOLVED_QUADRIC,
                          .revolved_quadric =
                              revolved_quadric_frustum(from, first, to, second, args[CONE_OPEN].boolean)};
    return give_shape(node, &shape, result);
}

enum { PARABOLOID_RADIUS = SHAPE_FIRST, PARABOLOID_HEIGHT, PARABOLOID_OPEN };
static const struct script_parameter paraboloid_parameters[] = {
    SHAPE("paraboloid"),
    [PARABOLOID_RADIUS] = LENGTH("radius", "1", "Radius of the rim."),
    [PARABOLOID_HEIGHT] = LENGTH("height", "1", "y of the rim; the apex is at the origin."),
    [PARABOLOID_OPEN] = OPEN_ENDS,
};

static bool gr_paraboloid(struct script_context *context, const struct script_value *args, struct script_result *result,
                          struct error *error) {
    double radius = number_or(&args[PARABOLOID_RADIUS], 1), height = number_or(&args[PARABOLOID_HEIGHT], 1);
    if (!length_is_fine(radius, "radius", error) || !length_is_fine(height, "height", error))
        return false;
    struct node *node = shape_node(context, args, "paraboloid", error);
    struct shape shape = {.kind = SHAPE_REVOLVED_QUADRIC,
                          .revolved_quadric =
                              revolved_quadric_paraboloid(radius, height, args[PARABOLOID_OPEN].boolean)};
    return give_shape(node, &shape, result);
}

enum {
    HYPERBOLOID_SHEETS = SHAPE_FIRST,
    HYPERBOLOID_RADIUS,
    HYPERBOLOID_HEIGHT,
    HYPERBOLOID_WAIST,
    HYPERBOLOID_GAP,
    HYPERBOLOID_OPEN
};
static const struct script_parameter hyperboloid_parameters[] = {
    SHAPE("hyperboloid"),
    [HYPERBOLOID_SHEETS] = {"sheets", KIND_WHOLE, OPTIONAL, IN_RANGE(1, 2), NULL, "1, with gap 2",
                            "1: one sheet with a waist; 2: two bowls."},
    [HYPERBOLOID_RADIUS] = LENGTH("radius", "twice waist, or 1", "Radius of both rims."),
    [HYPERBOLOID_HEIGHT] = LENGTH("height", "twice gap, or 1", "y of one rim; the other is at -y."),
    [HYPERBOLOID_WAIST] = LENGTH("waist", "radius/2", "Radius at y = 0, for one sheet."),
    [HYPERBOLOID_GAP] = LENGTH("gap", "height/2", "y of one apex, for two sheets; the other is at -y."),
    [HYPERBOLOID_OPEN] = OPEN_ENDS,
};

static bool gr_hyperboloid(struct script_context *context, const struct script_value *args,
                           struct script_result *result, struct error *error) {
    double waist = number_or(&args[HYPERBOLOID_WAIST], 0.5), gap = number_or(&args[HYPERBOLOID_GAP], 0.5);
    double radius = number_or(&args[HYPERBOLOID_RADIUS], 2 * waist),
           height = number_or(&args[HYPERBOLOID_HEIGHT], 2 * gap);
    waist = number_or(&args[HYPERBOLOID_WAIST], radius / 2);
    gap = number_or(&args[HYPERBOLOID_GAP], height / 2);
    bool two = args[HYPERBOLOID_SHEETS].given ? args[HYPERBOLOID_SHEETS].number == 2 : args[HYPERBOLOID_GAP].given;
    bool open = args[HYPERBOLOID_OPEN].boolean;
    if (!length_is_fine(radius, "radius", error) || !length_is_fine(height, "height", error))
        return false;
    if (args[two ? HYPERBOLOID_WAIST : HYPERBOLOID_GAP].given)
        return error_set(error, ERROR_SCENE, "%s",
                         two ? "waist is for one sheet: with sheets=2 give gap"
                             : "gap is for two sheets: with sheets=1 give waist");
    if (!two && !(waist < radius))
        return error_set(error, ERROR_SCENE, "waist must be smaller than radius: %g, %g", waist, radius);
    if (two && !(gap < height))
        return error_set(error, ERROR_SCENE, "gap must be smaller than height: %g, %g", gap, height);
    if (!length_is_fine(two ? gap : waist, two ? "gap" : "waist", error))
        return false;
    struct node *node = shape_node(context, args, "hyperboloid", error);
    struct shape shape = {.kind = SHAPE_REVOLVED_QUADRIC,
                          .revolved_quadric = two ? revolved_quadric_two_sheets(gap, height, radius, open)
                                                  : revolved_quadric_one_sheet(waist, radius, -height, height, open)};
    return give_shape(node, &shape, result);
}

enum { ELLIPSOID_CENTRE = SHAPE_FIRST, ELLIPSOID_RADII };
static const struct script_parameter ellipsoid_parameters[] = {
    SHAPE("ellipsoid"),
    [ELLIPSOID_CENTRE] = POSITION("centre", "{0, 0, 0}", "Centre."),
    [ELLIPSOID_RADII] = {"radii", KIND_SIZE, OPTIONAL, ANY, NULL, "1", "Radii along x, y and z: one number or three."},
};

static bool gr_ellipsoid(struct script_context *context, const struct script_value *args, struct script_result *result,
                         struct error *error) {
    struct vec3 centre = args[ELLIPSOID_CENTRE].vector, radii = vector_or(&args[ELLIPSOID_RADII], 1, 1, 1);
    if (!(radii.x > 0 && radii.y > 0 && radii.z > 0))
        return error_set(error, ERROR_SCENE, "radii must all be positive: %g, %g, %g", radii.x, radii.y, radii.z);
    if (!length_is_fine(radii.x, "the first of radii", error) ||
        !length_is_fine(radii.y, "the second of radii", error) || !length_is_fine(radii.z, "the third of radii", error))
        return false;
    struct node *node = shape_node(context, args, "ellipsoid", error);
    struct shape shape = {.kind = SHAPE_ELLIPSOID, .ellipsoid = {centre, radii}};
    return give_shape(node, &shape, result);
}

enum {
    QUADRIC_XX = SHAPE_FIRST,
    QUADRIC_YY,
    QUADRIC_ZZ,
    QUADRIC_XY,
    QUADRIC_XZ,
    QUADRIC_YZ,
    QUADRIC_X,
    QUADRIC_Y,
    QUADRIC_Z,
    QUADRIC_CONSTANT,
    QUADRIC_MIN,
    QUADRIC_MAX,
    QUADRIC_OPEN
};
#define COEFFICIENT(name)                                                                                              \
    { name, KIND_NUMBER, OPTIONAL, ANY, NULL, "0", "Coefficient." }

static const struct script_parameter quadric_parameters[] = {
    SHAPE("quadric"), /* without any coefficient the unit ball */
    [QUADRIC_XX] = COEFFICIENT("xx"),
    [QUADRIC_YY] = COEFFICIENT("yy"),
    [QUADRIC_ZZ] = COEFFICIENT("zz"),
    [QUADRIC_XY] = COEFFICIENT("xy"),
    [QUADRIC_XZ] = COEFFICIENT("xz"),
    [QUADRIC_YZ] = COEFFICIENT("yz"),
    [QUADRIC_X] = COEFFICIENT("x"),
    [QUADRIC_Y] = COEFFICIENT("y"),
    [QUADRIC_Z] = COEFFICIENT("z"),
    [QUADRIC_CONSTANT] = {"constant", KIND_NUMBER, OPTIONAL, ANY, NULL, "0",
                          "Constant term; the solid is where the sum is negative."},
    [QUADRIC_MIN] = POSITION("min", "infinite", "Corner of a box that limits it."),
    [QUADRIC_MAX] = POSITION("max", "infinite", "The opposite corner."),
    [QUADRIC_OPEN] = OPEN_ENDS,
};

static bool gr_quadric(struct script_context *context, const struct script_value *args, struct script_result *result,
                       struct error *error) {
    struct quadric *quadric = arena_alloc(&context->scene.arena, sizeof *quadric);
    if (!quadric)
        return error_no_memory(error, "a quadric");
    /* The coefficients; without any, a unit sphere. */
    double largest = 0;
    for (int i = 0; i < 10; i++) {
        quadric->c[i] = number_or(&args[QUADRIC_XX + i], 0);
        if (i < 9)
            largest = math_max(largest, fabs(quadric->c[i]));
    }
    bool none = true;
    for (int i = 0; i < 9; i++)
        none = none && !args[QUADRIC_XX + i].given;
    if (none) {
        quadric->c[0] = quadric->c[1] = quadric->c[2] = largest = 1;
        quadric->c[9] = number_or(&args[QUADRIC_CONSTANT], -1);
    }
    if (!(largest >= NUMBER_SMALLEST))
        return error_set(error, ERROR_SCENE, "at least one of xx, yy, zz, xy, xz, yz, x, y, z must not be 0");
    /* The box that cuts it. */
    quadric->limits.min = vector_or(&args[QUADRIC_MIN], -INFINITY, -INFINITY, -INFINITY);
    quadric->limits.max = vector_or(&args[QUADRIC_MAX], INFINITY, INFINITY, INFINITY);
    struct vec3 min = quadric->limits.min, max = quadric->limits.max;
    if (!(min.x < max.x && min.y < max.y && min.z < max.z))
        return error_set(error, ERROR_SCENE, "min must be smaller than max along every axis");
    quadric->open = args[QUADRIC_OPEN].boolean;
    struct node *node = shape_node(context, args, "quadric", error);
    struct shape shape = {.kind = SHAPE_QUADRIC, .quadric = quadric};
    return give_shape(node, &shape, result);
}

enum { TORUS_MAJOR = SHAPE_FIRST, TORUS_MINOR };
static const struct script_parameter torus_parameters[] = {
    SHAPE("torus"),
    [TORUS_MAJOR] = {"major", KIND_NUMBER, OPTIONAL, ABOVE(0), NULL, "1",
                     "Radius of the centre circle in the plane y = 0."},
    [TORUS_MINOR] = LENGTH("minor", "0.25", "Radius of the tube."),
};

static bool gr_torus(struct script_context *context, const struct script_value *args, struct script_result *result,
                     struct error *error) {
    double major = number_or(&args[TORUS_MAJOR], 1), minor = number_or(&args[TORUS_MINOR], 0.25);
    if (!length_is_fine(minor, "minor", error) || !length_is_fine(math_max(major, minor), "major", error))
        return false;
    if (minor < 1e-6 * major)
        return error_set(error, ERROR_SCENE, "minor must be at least a millionth of major: %g, %g", minor, major);
    struct node *node = shape_node(context, args, "torus", error);
    struct shape shape = {.kind = SHAPE_TORUS, .torus = {major, minor}};
    return give_shape(node, &shape, result);
}

enum { SUPER_E = SHAPE_FIRST, SUPER_N };
static const struct script_parameter superellipsoid_parameters[] = {
    SHAPE("superellipsoid"),
    [SUPER_E] = {"e", KIND_NUMBER, OPTIONAL, IN_RANGE(0.02, 20), NULL, "1",
                 "Exponent of the cross-section: near 0 a square, 1 a circle, 2 a diamond."},
    [SUPER_N] = {"n", KIND_NUMBER, OPTIONAL, IN_RANGE(0.02, 20), NULL, "1", "Exponent of the profile, likewise."},
};

static bool gr_superellipsoid(struct script_context *context, const struct script_value *args,
                              struct script_result *result, struct error *error) {
    struct node *node = shape_node(context, args, "superellipsoid", error);
    struct shape shape = {.kind = SHAPE_SUPERELLIPSOID,
                          .superellipsoid = {number_or(&args[SUPER_E], 1), number_or(&args[SUPER_N], 1)}};
    return give_shape(node, &shape, result);
}

enum { BOX_MIN = SHAPE_FIRST, BOX_MAX, BOX_EDGE, BOX_CHAMFER };
static const struct script_parameter box_parameters[] = {
    SHAPE("box"),
    [BOX_MIN] = {"min", KIND_POINT, 0, ANY, NULL, NULL, "A corner."},
    [BOX_MAX] = {"max", KIND_POINT, 0, ANY, NULL, NULL, "The opposite corner."},
    [BOX_EDGE] = EDGE,
    [BOX_CHAMFER] = CHAMFER,
};

static bool gr_box(struct script_context *context, const struct script_value *args, struct script_result *result,
                   struct error *error) {
    struct vec3 a = args[BOX_MIN].vector, b = args[BOX_MAX].vector;
    struct box box = {vec3_min(a, b), vec3_max(a, b)};
    if (!(box.min.x < box.max.x && box.min.y < box.max.y && box.min.z < box.max.z))
        return error_set(error, ERROR_SCENE, "min and max must differ along every axis");
    struct node *node = shape_node(context, args, "box", error);
    struct shape shape = {.kind = SHAPE_BOX, .box = box};
    if (node && has_bevel(&args[BOX_EDGE]) &&
        !bevel_box(context, &box, &args[BOX_EDGE], &args[BOX_CHAMFER], &shape, error))
        return false;
    return give_shape(node, &shape, result);
}

static bool give_planar(struct script_context *context, const struct script_value *args, const char *otherwise,
                        const struct planar *planar, struct script_result *result, struct error *error) {
    struct node *node = shape_node(context, args, otherwise, error);
    struct shape shape = {.kind = SHAPE_PLANAR, .planar = *planar};
    return give_shape(node, &shape, result);
}

/* The classic square, or with a normal or a distance the infinite plane. */
enum { PLANE_NORMAL = SHAPE_FIRST, PLANE_DISTANCE };
static const struct script_parameter plane_parameters[] = {
    SHAPE("plane"),
    [PLANE_NORMAL] = {"normal", KIND_DIRECTION, OPTIONAL, ANY, NULL, "none: the square",
                      "Normal of an infinite plane; in CSG the plane is a half-space."},
    [PLANE_DISTANCE] = {"distance", KIND_NUMBER, OPTIONAL, ANY, NULL, "0",
                        "Distance of the plane from the origin along the normal."},
};

static bool gr_plane(struct script_context *context, const struct script_value *args, struct script_result *result,
                     struct error *error) {
    bool infinite = args[PLANE_NORMAL].given || args[PLANE_DISTANCE].given;
    struct vec3 normal = vector_or(&args[PLANE_NORMAL], 0, 1, 0);
    struct planar planar = infinite ? planar_plane(normal, args[PLANE_DISTANCE].number) : planar_square();
    return give_planar(context, args, "plane", &planar, result, error);
}

static const struct script_parameter square_parameters[] = {SHAPE("square")};

static bool gr_square(struct script_context *context, const struct script_value *args, struct script_result *result,
                      struct error *error) {
    struct planar planar = planar_square();
    return give_planar(context, args, "square", &planar, result, error);
}

/* Edges that are not parallel and whose lengths are in the valid range. */
static bool span_is_fine(struct vec3 u, struct vec3 v, const char *what, struct error *error) {
    double along = vec3_length(u), up = vec3_length(v);
    if (!(vec3_length(vec3_cross(u, v)) > 1e-12 * along * up))
        return error_set(error, ERROR_SCENE, "%s", what);
    return length_is_fine(along, "the length of an edge", error) && length_is_fine(up, "the length of an edge", error);
}

enum { RECTANGLE_CORNER = SHAPE_FIRST, RECTANGLE_ALONG, RECTANGLE_UP };
static const struct script_parameter rectangle_parameters[] = {
    SHAPE("rectangle"),
    [RECTANGLE_CORNER] = POSITION("corner", "{-0.5, 0, 0.5}", "Corner where an image has its lower left."),
    [RECTANGLE_ALONG] = {"along", KIND_DIRECTION, OPTIONAL, ANY, NULL, "{1, 0, 0}", "Edge along u of an image."},
    [RECTANGLE_UP] = {"up", KIND_DIRECTION, OPTIONAL, ANY, NULL, "{0, 0, -1}",
                      "Edge along v of an image; not parallel to along."},
};

static bool gr_rectangle(struct script_context *context, const struct script_value *args, struct script_result *result,
                         struct error *error) {
    struct vec3 corner = vector_or(&args[RECTANGLE_CORNER], -0.5, 0, 0.5);
    struct vec3 along = vector_or(&args[RECTANGLE_ALONG], 1, 0, 0), up = vector_or(&args[RECTANGLE_UP], 0, 0, -1);
    if (!span_is_fine(along, up, "along and up are parallel", error))
        return false;
    struct planar planar = planar_parallelogram(corner, along, up);
    return give_planar(context, args, "rectangle", &planar, result, error);
}

enum { DISC_CENTRE = SHAPE_FIRST, DISC_NORMAL, DISC_RADIUS, DISC_INNER };
static const struct script_parameter disc_parameters[] = {
    SHAPE("disc"),
    [DISC_CENTRE] = POSITION("centre", "{0, 0, 0}", "Centre."),
    [DISC_NORMAL] = {"normal", KIND_DIRECTION, OPTIONAL, ANY, NULL, "{0, 1, 0}", "Normal of the front."},
    [DISC_RADIUS] = LENGTH("radius", "1, or twice inner", "Radius."),
    [DISC_INNER] = {"inner", KIND_NUMBER, OPTIONAL, ABOVE(0), NULL, "0", "Radius of the hole."},
};

static bool gr_disc(struct script_context *context, const struct script_value *args, struct script_result *result,
                    struct error *error) {
    double inner = number_or(&args[DISC_INNER], 0);
    double radius = number_or(&args[DISC_RADIUS], inner > 0 ? 2 * inner : 1);
    struct vec3 centre = args[DISC_CENTRE].vector;
    if (!length_is_fine(radius, "radius", error))
        return false;
    if (!(inner < radius))
        return error_set(error, ERROR_SCENE, "inner must be smaller than radius: %g, %g", inner, radius);
    struct planar planar = planar_disc(centre, vector_or(&args[DISC_NORMAL], 0, 1, 0), radius, inner);
    return give_planar(context, args, "disc", &planar, result, error);
}

enum { TRIANGLE_A = SHAPE_FIRST, TRIANGLE_B, TRIANGLE_C };
static const struct script_parameter triangle_parameters[] = {
    SHAPE("triangle"),
    [TRIANGLE_A] = {"a", KIND_POINT, 0, ANY, NULL, NULL, "A corner; from the front, a, b, c run counterclockwise."},
    [TRIANGLE_B] = {"b", KIND_POINT, 0, ANY, NULL, NULL, "The next corner."},
    [TRIANGLE_C] = {"c", KIND_POINT, 0, ANY, NULL, NULL, "The last corner."},
};

static bool gr_triangle(struct script_context *context, const struct script_value *args, struct script_result *result,
                        struct error *error) {
    struct vec3 a = args[TRIANGLE_A].vector, b = args[TRIANGLE_B].vector, c = args[TRIANGLE_C].vector;
    if (!span_is_fine(vec3_sub(b, a), vec3_sub(c, a), "a, b and c lie on one line", error))
        return false;
    struct planar planar = planar_triangle(a, b, c);
    return give_planar(context, args, "triangle", &planar, result, error);
}

enum { POLYGON_POINTS = SHAPE_FIRST, POLYGON_OUTLINES };
static const struct script_parameter polygon_parameters[] = {
    SHAPE("polygon"),
    [POLYGON_POINTS] = {"points", KIND_POINTS, 0, ANY, NULL, NULL,
                        "Corners in one plane; from the front, the first outline runs counterclockwise."},
    [POLYGON_OUTLINES] = {"outlines", KIND_FACES, OPTIONAL, ANY, NULL, "all points in order",
                          "Tuples of indices into points, from 0; the polygon is filled by the even-odd rule."},
};

static bool gr_polygon(struct script_context *context, const struct script_value *args, struct script_result *result,
                       struct error *error) {
    const struct script_value *points = &args[POLYGON_POINTS], *outlines = &args[POLYGON_OUTLINES];
    uint32_t count = outlines->given ? outlines->starts[outlines->count] : points->count;
    uint32_t outline_count = outlines->given ? outlines->count : 1;
    struct vec3 *corners = arena_alloc_array(&context->sandbox.call, count, sizeof *corners);
    uint32_t *ends = arena_alloc_array(&context->sandbox.call, outline_count, sizeof *ends);
    if (!corners || !ends)
        return error_no_memory(error, "a polygon");
    /* The corners of all outlines. */
    for (uint32_t i = 0; i < count; i++) {
        uint32_t index = outlines->given ? outlines->indices[i] : i;
        if (index >= points->count)
            return error_set(error, ERROR_SCENE, "outlines has the index %u, but there are %u points, counted from 0",
                             index, points->count);
        corners[i] = vec3_make(points->points[index][0], points->points[index][1], points->points[index][2]);
    }
    /* Where each outline ends. */
    for (uint32_t i = 0; i < outline_count; i++) {
        ends[i] = outlines->given ? outlines->starts[i + 1] : count;
        uint32_t corners_here = ends[i] - (i ? ends[i - 1] : 0);
        if (corners_here < 3 && outlines->given)
            return error_set(error, ERROR_SCENE, "outlines[%u] has %u corners, not 3 or more", i + 1, corners_here);
        if (corners_here < 3)
            return error_set(error, ERROR_SCENE, "points has %u corners, not 3 or more", corners_here);
    }
    struct planar planar;
    const char *why;
    if (!planar_polygon(&context->scene.arena, corners, ends, outline_count, &planar, &why))
        return why ? error_set(error, ERROR_SCENE, "this is not a polygon: %s", why)
                   : error_no_memory(error, "a polygon");
    return give_planar(context, args, "polygon", &planar, result, error);
}

/* The rows of the table. */
static const struct script_function rows[] = {
    GR("cylinder", cylinder_parameters, RESULT_NODE, gr_cylinder,
       "A capped cylinder; by default about the y axis, of radius 1, from y = -1 to 1.", "material", "name"),
    GR("cone", cone_parameters, RESULT_NODE, gr_cone,
       "A capped cone or frustum; by default with apex at the origin and radius 1 at y = 1.", "material", "name"),
    GR("torus", torus_parameters, RESULT_NODE, gr_torus, "A torus about the y axis.", "name major? minor?",
       "material major? minor?"),
    GR("plane", plane_parameters, RESULT_NODE, gr_plane,
       "The square from -0.5 to 0.5 in x and z at y = 0; with a normal, an infinite plane.", "material", "name"),
    GR("square", square_parameters, RESULT_NODE, gr_square, "The square from -0.5 to 0.5 in x and z at y = 0.",
       "material", "name"),
    GR("box", box_parameters, RESULT_NODE, gr_box, "A box between two corners.", "material min max", "name min max"),
    GR("ellipsoid", ellipsoid_parameters, RESULT_NODE, gr_ellipsoid, "An ellipsoid along the axes.", "material radii?",
       "name radii?"),
    GR("paraboloid", paraboloid_parameters, RESULT_NODE, gr_paraboloid, "A capped paraboloid that opens along y.",
       "material", "name"),
    GR("hyperboloid", hyperboloid_parameters, RESULT_NODE, gr_hyperboloid,
       "A capped hyperboloid about y, of one sheet or of two.", "material", "name"),
    GR("quadric", quadric_parameters, RESULT_NODE, gr_quadric,
       "The solid where xx x^2 + yy y^2 + zz z^2 + xy x y + xz x z + yz y z + x x + y y + z z + constant < 0.",
       "material xx yy zz constant", "name xx yy zz constant"),
    GR("superellipsoid", superellipsoid_parameters, RESULT_NODE, gr_superellipsoid,
       "A rounded cube, cylinder, double cone or star: (|x|^(2/e) + |z|^(2/e))^(e/n) + |y|^(2/n) = 1.",
       "material e? n?", "name e? n?"),
    GR("rectangle", rectangle_parameters, RESULT_NODE, gr_rectangle, "A rectangle or parallelogram.",
       "material corner? along? up?", "name corner? along? up?"),
    GR("disc", disc_parameters, RESULT_NODE, gr_disc, "A disc, or a ring.", "material", "name"),
    GR("triangle", triangle_parameters, RESULT_NODE, gr_triangle, "A triangle.", "material a b c", "name a b c"),
    GR("polygon", polygon_parameters, RESULT_NODE, gr_polygon, "A polygon of any shape, with holes.",
       "material points outlines?", "name points outlines?"),
};
const struct function_rows shape_functions = {rows, COUNT(rows)};
