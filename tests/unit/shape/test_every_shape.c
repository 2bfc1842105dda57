/* Claims for every kind of shape, and the makers of all kinds. A new shape needs only a maker to be tested: its
 * crossings are sorted and agree with nearest, any, box and point tests, its normals point outwards, and it has the
 * volume or the area that its maker states. */
#include "csg/csg_build.h"
#include "tests/unit/shape_makers.h"

#include "csg/csg.h"
#include "shape/bevelled.h"
#include "shape/implicit.h"
#include "shape/planar.h"
#include "shape/revolved_quadric.h"
#include "shape/shape_part.h"
#include "tests/unit/function_makers.h"
#include "tests/unit/swept_makers.h"

#include <math.h>
#include <string.h>

/* ---- makers ---- */

static bool chance(struct test_random *random, double share) {
    return test_uniform(random, 0, 1) < share;
}

static struct made_shape made_sphere(struct test_random *random) {
    double radius = test_uniform(random, 0.3, 1);
    struct shape shape = {.kind = SHAPE_SPHERE, .sphere = {random_vec3(random, 0.3), radius}};
    return (struct made_shape){shape, 4 * M_PI / 3 * radius * radius * radius, 4 * M_PI * radius * radius};
}

static struct made_shape made_box(struct test_random *random) {
    struct vec3 low = random_vec3(random, 0.4), size = vec3_add(random_vec3(random, 0.3), vec3_all(0.5));
    struct shape shape = {.kind = SHAPE_BOX, .box = {low, vec3_add(low, size)}};
    return (struct made_shape){shape, size.x * size.y * size.z,
                               2 * (size.x * size.y + size.y * size.z + size.z * size.x)};
}

static struct made_shape made_revolved_quadric(struct test_random *random) {
    double a = test_uniform(random, 0.2, 1), b = test_uniform(random, 0.2, 1), h = test_uniform(random, 0.2, 1);
    struct vec3 from = random_vec3(random, 0.5), to = vec3_add(from, vec3_make(a, b, -h));
    double length = vec3_length(vec3_sub(to, from));
    bool open = chance(random, 0.3);
    struct made_shape made = {.shape = {.kind = SHAPE_REVOLVED_QUADRIC}, .volume = NAN, .area = NAN};
    struct revolved_quadric *revolved_quadric = &made.shape.revolved_quadric;
    switch ((int)test_uniform(random, 0, 5)) {
    case 0:
        *revolved_quadric = revolved_quadric_cylinder(from, to, a, open);
        made.volume = M_PI * a * a * length;
        made.area = 2 * M_PI * a * (length + (open ? 0 : a));
        break;
    case 1:
        *revolved_quadric = revolved_quadric_frustum(from, a, to, chance(random, 0.5) ? 0 : b, open);
        break;
    case 2:
        *revolved_quadric = revolved_quadric_paraboloid(a, b, open);
        made.volume = M_PI / 2 * a * a * b;
        break;
    case 3:
        *revolved_quadric = revolved_quadric_one_sheet(a * b, a, -h, b, open);
        break;
    default:
        *revolved_quadric = revolved_quadric_two_sheets(h * b, h, a, open);
        break;
    }
    if (open)
        made.volume = NAN;
    return made;
}

static struct made_shape made_ellipsoid(struct test_random *random) {
    struct vec3 radii = vec3_add(random_vec3(random, 0.4), vec3_all(0.6));
    struct shape shape = {.kind = SHAPE_ELLIPSOID, .ellipsoid = {random_vec3(random, 0.3), radii}};
    return (struct made_shape){shape, 4 * M_PI / 3 * radii.x * radii.y * radii.z, NAN};
}

/* An ellipsoid, or a saddle in a box, closed, open or unbounded. */
static struct made_shape made_quadric(struct shape_makers *makers, struct test_random *random) {
    struct box all = {vec3_all(-INFINITY), vec3_all(INFINITY)}, limits = {{-1, -0.8, -0.9}, {1, 0.75, 1}};
    struct vec3 r = vec3_add(random_vec3(random, 0.3), vec3_all(0.6));
    double pick = test_uniform(random, 0, 1), q = test_uniform(random, 0.1, 0.9);
    struct quadric *quadric = arena_alloc(&makers->arena, sizeof *quadric);
    struct shape shape = {.kind = SHAPE_QUADRIC, .quadric = quadric};
    if (pick < 0.4) {
        *quadric = (struct quadric){.c = {1 / (r.x * r.x), 1 / (r.y * r.y), 1 / (r.z * r.z), 0, 0, 0, 0, 0, 0, -1},
                                    .limits = all};
        return (struct made_shape){shape, 4 * M_PI / 3 * r.x * r.y * r.z, NAN};
    }
    *quadric = (struct quadric){.c = {1, -q, r.z, 0.3, -0.2, 0.4, 0.2, 0.1, -0.3, -q},
                                .limits = pick < 0.95 ? limits : all,
                                .open = pick < 0.6};
    return (struct made_shape){shape, NAN, NAN};
}

static struct made_shape made_torus(struct test_random *random) {
    double major = test_uniform(random, 0.4, 0.9), minor = test_uniform(random, 0.05, 0.35);
    bool spindle = chance(random, 0.2);
    struct shape shape = {.kind = SHAPE_TORUS, .torus = {spindle ? minor : major, spindle ? major : minor}};
    return (struct made_shape){shape, spindle ? NAN : 2 * M_PI * M_PI * major * minor * minor,
                               spindle ? NAN : 4 * M_PI * M_PI * major * minor};
}

static double beta(double x, double y) {
    return exp(lgamma(x) + lgamma(y) - lgamma(x + y));
}

/* Volume: Jaklic, Leonardis and Solina, Segmentation and Recovery of Superquadrics, 2000, section 2.2. */
static struct made_shape made_superellipsoid(struct test_random *random) {
    double e = test_uniform(random, 0.3, 3), n = test_uniform(random, 0.3, 3);
    struct shape shape = {.kind = SHAPE_SUPERELLIPSOID, .superellipsoid = {.e = e, .n = n}};
    return (struct made_shape){shape, 2 * e * n * beta(n / 2 + 1, n) * beta(e / 2, e / 2), NAN};
}

static struct made_shape made_planar(struct test_random *random) {
    struct vec3 a = random_vec3(random, 0.6), b = random_vec3(random, 1), c = random_vec3(random, 1);
    double across = vec3_length(vec3_cross(b, c)), radius = test_uniform(random, 0.3, 1);
    struct made_shape made = {.shape = {.kind = SHAPE_PLANAR}, .volume = NAN, .area = NAN};
    double pick = test_uniform(random, 0, 1);
    if (pick < 0.3) {
        made.shape.planar = planar_parallelogram(a, b, c);
        made.area = across;
    } else if (pick < 0.6) {
        double inner = chance(random, 0.5) ? 0 : radius * 0.4;
        made.shape.planar = planar_disc(a, b, radius, inner);
        made.area = M_PI * (radius * radius - inner * inner);
    } else if (pick < 0.9) {
        made.shape.planar = planar_triangle(a, vec3_add(a, b), vec3_add(a, c));
        made.area = across / 2;
    } else {
        made.shape.planar = planar_plane(b, test_uniform(random, -0.5, 0.5));
    }
    return made;
}

static struct made_shape made_lathe(struct shape_makers *makers, struct test_random *random) {
    if (chance(random, 0.6)) {
        enum spline_kind kind = chance(random, 0.5) ? SPLINE_LINEAR : SPLINE_B_SPLINE;
        return (struct made_shape){random_lathe(&makers->arena, random, kind), NAN, NAN};
    }
    double points[4][2] = {{0, -0.7}, {0, -0.3}, {0, 0.4}, {0, 0.6}}, volume = 0;
    points[1][0] = test_uniform(random, 0.2, 1);
    points[2][0] = test_uniform(random, 0.2, 1);
    for (int i = 0; i < 3; i++) {
        double a = points[i][0], b = points[i + 1][0];
        volume += M_PI / 3 * (points[i + 1][1] - points[i][1]) * (a * a + a * b + b * b);
    }
    struct shape shape = make_lathe(&makers->arena, SPLINE_LINEAR, (const double(*)[2])points, 4, false, false);
    return (struct made_shape){shape, volume, NAN};
}

static struct made_shape made_prism(struct shape_makers *makers, struct test_random *random) {
    if (chance(random, 0.6)) {
        enum spline_kind kind = chance(random, 0.5) ? SPLINE_LINEAR : SPLINE_CATMULL_ROM;
        return (struct made_shape){random_prism(&makers->arena, random, kind), NAN, NAN};
    }
    double points[9][2], height = test_uniform(random, 0.2, 1);
    uint32_t count = 3 + (uint32_t)test_uniform(random, 0, 6.99), starts[2] = {0, count};
    for (uint32_t i = 0; i < count; i++) {
        points[i][0] = cos(2 * M_PI * i / count);
        points[i][1] = sin(2 * M_PI * i / count);
    }
    struct error error = {0};
    struct prism_input in = {.kind = SPLINE_LINEAR,
                             .points = (const double(*)[2])points,
                             .curve_starts = starts,
                             .curve_count = 1,
                             .from = -height / 2,
                             .to = height / 2};
    struct shape shape = {.kind = SHAPE_PRISM, .prism = prism_build(&makers->arena, &in, &error)};
    double area = sin(2 * M_PI / count) * count / 2;
    return (struct made_shape){shape, area * height, 2 * area + 2 * sin(M_PI / count) * count * height};
}

/* A convex solid that grew by a ball: Steiner's formula. `curvature` is the integral of its mean curvature. */
static void grow(struct made_shape *made, double volume, double area, double curvature, double radius) {
    made->volume = volume + area * radius + curvature * radius * radius + 4 * M_PI / 3 * radius * radius * radius;
    made->area = area + 2 * curvature * radius + 4 * M_PI * radius * radius;
}

static struct made_shape made_bevelled_cylinder(struct shape_makers *makers, struct test_random *random) {
    const struct vec3 from = random_vec3(random, 0.5), axis = vec3_add(random_vec3(random, 0.3), vec3_all(0.5));
    struct bevelled_cylinder in = {.from = from,
                                   .to = vec3_add(from, axis),
                                   .radius = test_uniform(random, 0.2, 0.7),
                                   .chamfer = chance(random, 0.5)};
    const double length = vec3_length(axis), r = in.radius, limit = r < length / 2 ? r : length / 2;
    struct error error = {0};
    in.edge = test_uniform(random, 0.1, 0.9) * limit;
    const double e = in.edge, inner = r - e, straight = length - 2 * e;
    struct made_shape made = {
        {.kind = SHAPE_BEVELLED, .bevelled = bevelled_cylinder(&makers->arena, &in, &error)}, NAN, NAN};
    if (in.chamfer) {
        made.volume = M_PI * r * r * straight + 2 * M_PI / 3 * e * (r * r + r * inner + inner * inner);
        made.area = 2 * M_PI * (inner * inner + r * straight + (r + inner) * e * sqrt(2));
    } else {
        grow(&made, M_PI * inner * inner * straight, 2 * M_PI * inner * (inner + straight),
             M_PI * straight + M_PI * M_PI * inner, e);
    }
    return made;
}

/* A regular polygon: its edges' exterior angles sum to a turn for the upright ones and are right ones above and below.
 * A star, which is not convex, or a smooth curve. */
static struct made_shape made_bevelled(struct shape_makers *makers, struct test_random *random) {
    if (chance(random, 0.4))
        return made_bevelled_cylinder(makers, random);
    const bool convex = chance(random, 0.6), smooth = !convex && chance(random, 0.4);
    const uint32_t sides = 3 + (uint32_t)test_uniform(random, 0, 5.99), count = convex ? sides : 2 * sides;
    const double height = test_uniform(random, 0.3, 1), e = test_uniform(random, 0.02, smooth ? 0.04 : 0.13);
    double points[16][2], apothem = cos(M_PI / count), scale = 1 - e / apothem;
    const uint32_t starts[2] = {0, count};
    for (uint32_t i = 0; i < count; i++) {
        double angle = 2 * M_PI * i / count;
        double radius = convex || i % 2 == 0 ? 1 : 0.75;
        points[i][0] = radius * cos(angle);
        points[i][1] = radius * sin(angle);
    }
    struct error error = {0};
    struct prism_input in = {.kind = smooth ? SPLINE_B_SPLINE : SPLINE_LINEAR,
                             .points = (const double(*)[2])points,
                             .curve_starts = starts,
                             .curve_count = 1,
                             .from = -height / 2,
                             .to = height / 2};
    struct made_shape made = {
        {.kind = SHAPE_BEVELLED, .bevelled = bevelled_prism(&makers->arena, &makers->arena, &in, e, &error)}, NAN, NAN};
    if (!made.shape.bevelled)
        test_fail(__FILE__, __LINE__, "%s", error.text);
    if (convex) {
        double area = scale * scale * sin(2 * M_PI / count) * count / 2,
               perimeter = 2 * scale * sin(M_PI / count) * count;
        double inner = height - 2 * e;
        grow(&made, area * inner, 2 * area + perimeter * inner, M_PI * inner + M_PI / 2 * perimeter, e);
    }
    return made;
}

static struct made_shape made_sweep(struct shape_makers *makers, struct test_random *random) {
    if (chance(random, 0.6)) {
        static const enum spline_kind kinds[] = {SPLINE_LINEAR, SPLINE_CATMULL_ROM, SPLINE_B_SPLINE};
        enum spline_kind kind = kinds[(int)test_uniform(random, 0, 2.99)];
        return (struct made_shape){random_sweep(&makers->arena, random, kind), NAN, NAN};
    }
    double points[2][3] = {{0, -0.5, 0}, {0.3, 0.4, -0.2}}, radius = test_uniform(random, 0.1, 0.4);
    double length = sqrt(0.3 * 0.3 + 0.9 * 0.9 + 0.2 * 0.2), radii[2] = {radius, radius};
    struct error error = {0};
    struct sweep_input in = {.kind = SPLINE_LINEAR, .points = (const double(*)[3])points, .radii = radii, .count = 2};
    struct shape shape = {.kind = SHAPE_SWEEP, .sweep = sweep_build(&makers->arena, &in, &error)};
    return (struct made_shape){shape, M_PI * radius * radius * (length + 4 * radius / 3),
                               2 * M_PI * radius * (length + 2 * radius)};
}

static struct made_shape made_height_field(struct shape_makers *makers, struct test_random *random) {
    double top = test_uniform(random, 0.1, 0.8), heights[6] = {top, top, top, top, top, top};
    if (chance(random, 0.6))
        return (struct made_shape){random_height_field(&makers->arena, random, 8), NAN, NAN};
    struct error error = {0};
    struct height_field_input in = {
        .heights = heights, .columns = 3, .rows = 2, .floor = -0.2, .open = chance(random, 0.5)};
    struct shape shape = {.kind = SHAPE_HEIGHT_FIELD, .height_field = height_field_build(&makers->arena, &in, &error)};
    return (struct made_shape){shape, in.open ? NAN : top + 0.2, in.open ? 1 : 2 + 4 * (top + 0.2)};
}

static struct made_shape made_blob(struct shape_makers *makers, struct test_random *random) {
    if (chance(random, 0.6))
        return (struct made_shape){random_blob(&makers->arena, random), NAN, NAN};
    struct error error = {0};
    struct blob_element ball = {.radius = test_uniform(random, 0.5, 1.2), .strength = test_uniform(random, 0.8, 2)};
    ball.a = ball.b = random_vec3(random, 0.3);
    struct blob_input in = {.elements = &ball, .count = 1, .threshold = 0.5};
    struct shape shape = {.kind = SHAPE_BLOB, .blob = blob_build(&makers->arena, &in, &error)};
    double radius = ball.radius * sqrt(1 - sqrt(in.threshold / ball.strength));
    return (struct made_shape){shape, 4 * M_PI / 3 * radius * radius * radius, 4 * M_PI * radius * radius};
}

/* Straight: lines at the angle s to it see the width times length sin s, half the mean of a cylinder's sheet. */
static struct made_shape made_curve(struct shape_makers *makers, struct test_random *random) {
    bool straight = chance(random, 0.4);
    double points[4][3] = {{-0.5, 0.2, 0.1}, {0.6, -0.4, 0.3}}, width = test_uniform(random, 0.05, 0.3);
    double widths[4] = {width, width, width, width};
    for (int k = 0; k < 12 && !straight; k++)
        points[k / 3][k % 3] = test_uniform(random, -0.8, 0.8);
    double length = sqrt(1.1 * 1.1 + 0.6 * 0.6 + 0.2 * 0.2);
    struct error error = {0};
    struct curve_input in = {.kind = straight ? SPLINE_LINEAR : SPLINE_BEZIER,
                             .points = (const double(*)[3])points,
                             .widths = widths,
                             .count = straight ? 2 : 4};
    struct shape shape = {.kind = SHAPE_CURVE, .curve = curve_build(&makers->arena, &in, &error)};
    return (struct made_shape){shape, NAN, straight ? M_PI / 2 * width * length : NAN};
}

/* A tetrahedron, whole or without one of its faces. */
static struct made_shape made_mesh(struct shape_makers *makers, struct test_random *random) {
    static const uint32_t faces[] = {0, 1, 2, 0, 3, 1, 1, 3, 2, 2, 3, 0}, starts[] = {0, 3, 6, 9, 12};
    double vertices[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}, {0, 1, 0}}, area = 0;
    bool closed = chance(random, 0.7);
    for (int i = 0; i < 12; i++)
        vertices[i / 3][i % 3] += test_uniform(random, -0.1, 0.1);
    struct mesh_input input = {.name = "small",
                               .vertex_count = 4,
                               .face_count = closed ? 4 : 3,
                               .vertices = (const double(*)[3])vertices,
                               .face_start = starts,
                               .vertex_index = faces};
    if (makers->mesh_count < MADE_MESHES)
        makers->meshes[makers->mesh_count++] = indexed_mesh(&input);
    else
        return (struct made_shape){
            {.kind = SHAPE_MESH, .mesh = makers->meshes[(int)test_uniform(random, 0, MADE_MESHES - 0.01)]}, NAN, NAN};
    struct vec3 p[4];
    for (int i = 0; i < 4; i++)
        p[i] = vec3_make(vertices[i][0], vertices[i][1], vertices[i][2]);
    for (uint32_t f = 0; f < input.face_count; f++) {
        struct vec3 corner = p[faces[3 * f]];
        area +=
            vec3_length(vec3_cross(vec3_sub(p[faces[3 * f + 1]], corner), vec3_sub(p[faces[3 * f + 2]], corner))) / 2;
    }
    double box = vec3_dot(vec3_sub(p[1], p[0]), vec3_cross(vec3_sub(p[2], p[0]), vec3_sub(p[3], p[0])));
    struct shape shape = {.kind = SHAPE_MESH, .mesh = makers->meshes[makers->mesh_count - 1]};
    return (struct made_shape){shape, closed ? fabs(box) / 6 : NAN, area};
}

/* A ball, or a torus in a ball. */
static struct made_shape made_implicit(struct shape_makers *makers, struct test_random *random) {
    struct function_maker m;
    struct error error = {0};
    bool is_ball = chance(random, 0.5);
    double radius = test_uniform(random, 0.3, 0.8), minor = radius * test_uniform(random, 0.2, 0.6);
    function_begin(&m);
    uint32_t node =
        is_ball ? fn_ball(&m, random_vec3(random, 0.1), radius, chance(random, 0.5)) : fn_torus(&m, radius, minor);
    struct implicit_input in = {.program = function_end(&m, node, &makers->arena),
                                .bounds = {vec3_all(-1), vec3_all(1)},
                                .is_ball = !is_ball,
                                .radius = 2,
                                .open = chance(random, 0.2)};
    struct shape shape = {.kind = SHAPE_IMPLICIT, .implicit = implicit_build(&makers->arena, &in, &error)};
    double volume = is_ball ? 4 * M_PI / 3 * radius * radius * radius : 2 * M_PI * M_PI * radius * minor * minor;
    double area = is_ball ? 4 * M_PI * radius * radius : 4 * M_PI * M_PI * radius * minor;
    return (struct made_shape){shape, in.open ? NAN : volume, area};
}

/* A cube with a hollow ball in it, or a random tree of solids. */
static struct made_geometry made_csg(struct shape_makers *makers, struct test_random *random) {
    enum { LEAVES = 5 };
    struct csg_leaf leaves[LEAVES];
    struct csg_token program[4 * LEAVES] = {{CSG_LEAF, 0}, {CSG_LEAF, 1}, {CSG_DIFFERENCE, 0}};
    uint32_t count = 2, length = 3;
    bool known = chance(random, 0.3);
    double radius = test_uniform(random, 0.3, 0.7);
    for (uint32_t i = 0; i < LEAVES; i++)
        leaves[i] = (struct csg_leaf){.csg_from_leaf = transform_identity()};
    leaves[0].shape = (struct shape){.kind = SHAPE_BOX, .box = {vec3_all(-0.75), vec3_all(0.75)}};
    leaves[1].shape = (struct shape){.kind = SHAPE_SPHERE, .sphere = {vec3_all(0), radius}};
    if (!known) {
        count = 1 + (uint32_t)test_uniform(random, 0, LEAVES - 0.001);
        length = random_program(random, 0, count, 0, program);
        for (uint32_t i = 0; i < count; i++)
            leaves[i] =
                (struct csg_leaf){.csg_from_leaf = make_transform(random, 0.4), .shape = make_solid(makers, random)};
    }
    struct error error = {0};
    const struct csg *csg = csg_build(&makers->arena, leaves, count, program, length, &error);
    if (!csg)
        test_fail(__FILE__, __LINE__, "%s", error.text);
    return (struct made_geometry){geometry_of_csg(csg), known ? 3.375 - 4 * M_PI / 3 * radius * radius * radius : NAN,
                                  known ? 13.5 + 4 * M_PI * radius * radius : NAN};
}

struct made_shape make_shape(struct shape_makers *makers, enum shape_kind kind, struct test_random *random) {
    switch (kind) {
    case SHAPE_SPHERE:
        return made_sphere(random);
    case SHAPE_BOX:
        return made_box(random);
    case SHAPE_REVOLVED_QUADRIC:
        return made_revolved_quadric(random);
    case SHAPE_ELLIPSOID:
        return made_ellipsoid(random);
    case SHAPE_QUADRIC:
        return made_quadric(makers, random);
    case SHAPE_TORUS:
        return made_torus(random);
    case SHAPE_SUPERELLIPSOID:
        return made_superellipsoid(random);
    case SHAPE_PLANAR:
        return made_planar(random);
    case SHAPE_LATHE:
        return made_lathe(makers, random);
    case SHAPE_PRISM:
        return made_prism(makers, random);
    case SHAPE_BEVELLED:
        return made_bevelled(makers, random);
    case SHAPE_SWEEP:
        return made_sweep(makers, random);
    case SHAPE_HEIGHT_FIELD:
        return made_height_field(makers, random);
    case SHAPE_BLOB:
        return made_blob(makers, random);
    case SHAPE_IMPLICIT:
        return made_implicit(makers, random);
    case SHAPE_CURVE:
        return made_curve(makers, random);
    case SHAPE_MESH:
        return made_mesh(makers, random);
    }
    return made_sphere(random);
}

struct made_geometry make_geometry(struct shape_makers *makers, int kind, struct test_random *random) {
    if (kind == SHAPE_KIND_COUNT)
        return made_csg(makers, random);
    struct made_shape made = make_shape(makers, (enum shape_kind)kind, random);
    return (struct made_geometry){geometry_of_shape(&made.shape), made.volume, made.area};
}

struct shape make_solid(struct shape_makers *makers, struct test_random *random) {
    for (;;) {
        enum shape_kind kind = (enum shape_kind)(int)test_uniform(random, 0, SHAPE_KIND_COUNT - 0.001);
        struct shape shape = make_shape(makers, kind, random).shape;
        if (shape_is_closed(&shape))
            return shape;
    }
}

void shape_makers_destroy(struct shape_makers *makers) {
    for (uint32_t i = 0; i < makers->mesh_count; i++)
        mesh_release(makers->meshes[i]);
    arena_destroy(&makers->arena);
    *makers = (struct shape_makers){0};
}

struct transform make_transform(struct test_random *random, double spread) {
    struct transform t = transform_identity();
    for (int axis = 0; axis < 3; axis++) {
        double factor = exp(test_uniform(random, -0.7, 0.7)) * (chance(random, 0.2) ? -1 : 1);
        struct vec3 scale = vec3_make(axis == 0 ? factor : 1, axis == 1 ? factor : 1, axis == 2 ? factor : 1);
        struct transform by = transform_scale(scale), turn = transform_rotate(axis, test_uniform(random, -180, 180));
        t = transform_compose(&by, &t);
        t = transform_compose(&turn, &t);
    }
    struct transform move = transform_translate(random_vec3(random, spread));
    return transform_compose(&move, &t);
}

/* ---- tests ---- */

static const char *kind_name(int kind) {
    return kind == SHAPE_KIND_COUNT ? "csg" : shape_kind_name((enum shape_kind)kind);
}

/* Thinner segments are not tested: the position of a surface is known only up to rounding. */
#define THIN 1e-5

struct failures {
    long crossings, order, nearest, any, box, primitive_box, points, normals, layout;
};

/* A surface supplies what the layout of its shape states. */
static bool layout_holds(const struct geometry *geometry, const struct surface *surface) {
    if (geometry->csg) /* that of one of its operands */
        return true;
    switch (shape_layout(&geometry->shape)) {
    case LAYOUT_UV:
        return surface->has_uv || (surface->u == 0 && surface->v == 0);
    case LAYOUT_FACES:
        return surface->has_uv && surface->u >= 0 && surface->u <= 1 && surface->v >= 0 && surface->v <= 1;
    case LAYOUT_SPHERE:
        return !surface->has_uv && fabs(vec3_length(surface->pattern_normal) - 1) < 1e-15;
    }
    return false;
}

static void check_line_of(const struct geometry *geometry, struct test_random *random, struct geom_scratch *scratch,
                          struct failures *n) {
    struct vec3 origin = random_vec3(random, chance(random, 0.3) ? 0.7 : 4);
    struct ray ray = ray_from(origin, vec3_sub(random_vec3(random, 0.8), origin));
    struct crossing_list list = list_of_geometry(geometry, &ray, scratch);
    bool closed = geometry_is_closed(geometry);
    n->crossings += list.count;
    n->order += closed && list.count % 2 != 0;
    n->order +=
        !geometry_mesh(geometry) && list.count > geometry_scratch_need(geometry); /* for a mesh it is an estimate */
    for (uint32_t k = 1; k < list.count; k++)
        n->order += !(scratch->items[k - 1].t < scratch->items[k].t) && closed;

    /* Nearest and any, from a t between two crossings. */
    struct ray part = ray;
    uint32_t from = list.count > 0 ? (uint32_t)test_uniform(random, 0, list.count - 0.001) : 0;
    double first = list.count > 0 ? scratch->items[from].t : 0;
    part.t_min = isfinite(first) ? first : -1e9;
    part.t_max = chance(random, 0.5) ? INFINITY : part.t_min + test_uniform(random, 0, 1);
    struct crossing expected = {.t = INFINITY}, nearest;
    for (uint32_t k = list.count; k-- > 0;)
        if (scratch->items[k].t > part.t_min && scratch->items[k].t < part.t_max)
            expected = scratch->items[k];
    scratch->used = list.count;
    bool found = geometry_nearest(geometry, &part, scratch, &nearest);
    n->nearest += found != isfinite(expected.t) || (found && nearest.t != expected.t);
    n->any += geometry_any(geometry, &part, scratch) != found;

    struct box box = geometry_bounds(geometry);
    box = (struct box){vec3_sub(box.min, vec3_all(1e-9)), vec3_add(box.max, vec3_all(1e-9))};
    for (uint32_t k = 0; k < list.count; k++) {
        struct crossing c = scratch->items[k];
        if (!isfinite(c.t))
            continue;
        struct surface surface;
        geometry_describe(geometry, &ray, &c, &surface);
        double cosine = vec3_dot(vec3_normalize(surface.normal), vec3_normalize(ray.direction));
        n->normals += fabs(cosine) > 1e-4 && closed && c.enter != (cosine < 0);
        n->box += !box_contains(&box, surface.point);
        n->layout += !layout_holds(geometry, &surface);
    }
    for (uint32_t k = 0; closed && k <= list.count; k++) {
        double before = k > 0 ? scratch->items[k - 1].t : -INFINITY;
        double after = k < list.count ? scratch->items[k].t : INFINITY;
        if (!isfinite(before) || !isfinite(after) || after - before < THIN)
            continue;
        uint32_t used = scratch->used;
        n->points += geometry_contains(geometry, ray_at(&ray, before / 2 + after / 2), scratch) != (k % 2 == 1);
        scratch->used = used;
    }
}

TEST_TIMES(every_shape_is_crossed_where_its_points_and_its_box_say_and_met_at_the_first_crossing, 30) {
    struct geom_scratch scratch;
    CHECK(geom_scratch_init(&scratch, 4000));
    for (int kind = 0; kind < GEOMETRY_KIND_COUNT; kind++) {
        struct shape_makers makers = {0};
        struct test_random random = {(uint64_t)(1 + kind)};
        struct failures n = {0};
        for (int i = 0; i < 60 * times; i++) {
            struct geometry geometry = make_geometry(&makers, kind, &random).geometry;
            CHECK(geometry.csg ? kind == SHAPE_KIND_COUNT : (int)geometry.shape.kind == kind);
            for (int ray = 0; ray < 80; ray++)
                check_line_of(&geometry, &random, &scratch, &n);
        }
        shape_makers_destroy(&makers);
        if (n.order || n.nearest || n.any || n.box || n.points || n.normals || n.layout || n.crossings < 300 * times)
            test_fail(__FILE__, __LINE__,
                      "%s, %ld crossings: %ld out of order, %ld nearest, %ld any, %ld beyond the box, %ld points, %ld "
                      "normals, %ld layouts",
                      kind_name(kind), n.crossings, n.order, n.nearest, n.any, n.box, n.points, n.normals, n.layout);
    }
    geom_scratch_destroy(&scratch);
}

TEST_TIMES(every_shape_under_a_random_map_lies_in_its_box_there, 30) {
    struct geom_scratch scratch;
    CHECK(geom_scratch_init(&scratch, 4000));
    for (int kind = 0; kind < GEOMETRY_KIND_COUNT; kind++) {
        struct shape_makers makers = {0};
        struct test_random random = {(uint64_t)(100 + kind)};
        long outside = 0, crossings = 0;
        for (int i = 0; i < 60 * times; i++) {
            struct geometry geometry = make_geometry(&makers, kind, &random).geometry;
            struct transform map = make_transform(&random, 2);
            struct box box = geometry_bounds_under(&geometry, &map.forward);
            box = (struct box){vec3_sub(box.min, vec3_all(1e-8)), vec3_add(box.max, vec3_all(1e-8))};
            for (int k = 0; k < 50; k++) {
                struct vec3 origin = random_vec3(&random, 4);
                struct ray ray = ray_from(origin, vec3_sub(random_vec3(&random, 0.8), origin));
                struct crossing_list list = list_of_geometry(&geometry, &ray, &scratch);
                crossings += list.count;
                for (uint32_t c = 0; c < list.count; c++)
                    if (isfinite(scratch.items[c].t))
                        outside += !box_contains(&box, affine_point(&map.forward, ray_at(&ray, scratch.items[c].t)));
            }
        }
        shape_makers_destroy(&makers);
        if (outside || crossings < 150 * times)
            test_fail(__FILE__, __LINE__, "%s: %ld of %ld crossings outside", kind_name(kind), outside, crossings);
    }
    geom_scratch_destroy(&scratch);
}

static bool is_in_part(const struct shape_part *part, struct vec3 point) {
    struct oriented_box box = shape_part_box(part);
    struct vec3 rest = vec3_sub(point, box.corner);
    /* The edges are at right angles, except those of a parallelogram, whose third one is zero. */
    double uv = vec3_dot(box.edges[0], box.edges[1]), uu = vec3_length_squared(box.edges[0]),
           vv = vec3_length_squared(box.edges[1]), ww = vec3_length_squared(box.edges[2]);
    double u = vec3_dot(rest, box.edges[0]), v = vec3_dot(rest, box.edges[1]), det = uu * vv - uv * uv;
    double a = (u * vv - v * uv) / det, b = (v * uu - u * uv) / det, c = vec3_dot(rest, box.edges[2]) / ww;
    if (!(ww > 0)) {
        struct vec3 across = vec3_cross(box.edges[0], box.edges[1]);
        c = fabs(vec3_dot(rest, across)) > 1e-7 * vec3_length(across) ? 2 : 0.5;
    }
    return a > -1e-7 && a < 1 + 1e-7 && b > -1e-7 && b < 1 + 1e-7 && c > -1e-7 && c < 1 + 1e-7;
}

/* Some part has the point; or, `depth` times split in two, one of the halves. */
static bool is_in_halves(const struct shape_part *part, const struct affine *map, struct vec3 point, int depth) {
    struct shape_part halves[2];
    if (!is_in_part(part, point))
        return false;
    if (depth == 0)
        return true;
    shape_part_split(part, map, halves);
    return is_in_halves(&halves[0], map, point, depth - 1) || is_in_halves(&halves[1], map, point, depth - 1);
}

TEST(every_shape_lies_in_its_parts_and_in_their_halves) {
    struct geom_scratch scratch;
    struct affine same = affine_identity();
    CHECK(geom_scratch_init(&scratch, 4000));
    for (int kind = 0; kind < SHAPE_KIND_COUNT; kind++) {
        struct shape_makers makers = {0};
        struct test_random random = {(uint64_t)(300 + kind)};
        long outside = 0, crossings = 0;
        for (int i = 0; i < 60; i++) {
            struct geometry geometry = make_geometry(&makers, kind, &random).geometry;
            struct shape_part part;
            if (!shape_part(&geometry.shape, 0, &part))
                continue;
            for (int k = 0; k < 60; k++) {
                struct vec3 origin = random_vec3(&random, 4);
                struct ray ray = ray_from(origin, vec3_sub(random_vec3(&random, 0.8), origin));
                struct crossing_list list = list_of_geometry(&geometry, &ray, &scratch);
                for (uint32_t c = 0; c < list.count; c++) {
                    struct vec3 point = ray_at(&ray, scratch.items[c].t);
                    bool found = false;
                    for (uint32_t number = 0; !found && shape_part(&geometry.shape, number, &part); number++)
                        found = is_in_halves(&part, &same, point, 3);
                    outside += !found;
                    crossings++;
                }
            }
        }
        shape_makers_destroy(&makers);
        if (outside || crossings < 200)
            test_fail(__FILE__, __LINE__, "%s: %ld of %ld crossings outside", kind_name(kind), outside, crossings);
    }
    geom_scratch_destroy(&scratch);
}

/* Sums of a random variable: its mean and the standard error of the mean. */
struct sums {
    double count, sum, squares;
};

static void add_to(struct sums *sums, double x) {
    sums->count++;
    sums->sum += x;
    sums->squares += x * x;
}

/* The standard error of the mean is small; true if the expected value is not known. */
static bool is_precise(const struct sums *sums, double factor, double expected) {
    double mean = sums->sum / sums->count, variance = sums->squares / sums->count - mean * mean;
    return isnan(expected) || factor * sqrt(variance / sums->count) < 0.04 * expected;
}

/* Within five standard errors; true for any mean if the expected value is not known. */
static bool agrees(const struct sums *sums, double factor, double expected) {
    double mean = sums->sum / sums->count, variance = sums->squares / sums->count - mean * mean;
    return isnan(expected) || fabs(factor * mean - expected) < 5 * factor * sqrt(variance / sums->count);
}

/* Integral geometry (Santalo 1976, I.4 and IV.14): of lines that cross a ball of radius R evenly from all sides, the
 * mean length inside a solid times pi R^2 is its volume, the mean number of crossings times 2 pi R^2 the area of its
 * surface. The ball encloses the shape's box. */
static void measure(const struct made_geometry *made, struct test_random *random, struct geom_scratch *scratch) {
    enum { LINES = 60000, FEW = 10000 };
    struct box box = geometry_bounds(&made->geometry);
    struct vec3 middle = vec3_scale(vec3_add(box.min, box.max), 0.5);
    double radius = vec3_length(vec3_sub(box.max, box.min)) / 2, across = M_PI * radius * radius;
    struct sums inside = {0}, crossings = {0};
    bool precise = false;
    for (int i = 0; i < LINES && !precise; i++) {
        double z = test_uniform(random, -1, 1), turn = test_uniform(random, 0, 2 * M_PI), r = sqrt(1 - z * z);
        struct vec3 direction = {r * cos(turn), r * sin(turn), z}, side, up;
        planar_across(direction, &side, &up);
        double far = radius * sqrt(test_uniform(random, 0, 1)), angle = test_uniform(random, 0, 2 * M_PI);
        struct vec3 origin = vec3_add_scaled(middle, side, far * cos(angle));
        struct ray ray = ray_from(vec3_add_scaled(origin, up, far * sin(angle)), direction);
        struct crossing_list list = list_of_geometry(&made->geometry, &ray, scratch);
        double length = 0;
        for (uint32_t k = 1; k < list.count; k += 2)
            length += scratch->items[k].t - scratch->items[k - 1].t;
        add_to(&inside, length);
        add_to(&crossings, list.count);
        precise = i % FEW == FEW - 1 && is_precise(&inside, across, made->volume) &&
                  is_precise(&crossings, 2 * across, made->area);
    }
    if (!precise || !agrees(&inside, across, made->volume) || !agrees(&crossings, 2 * across, made->area))
        test_fail(__FILE__, __LINE__, "%s: volume %g, %g by lines; area %g, %g by lines",
                  geometry_kind_name(&made->geometry), made->volume, across * inside.sum / inside.count, made->area,
                  2 * across * crossings.sum / crossings.count);
}

TEST(every_shape_has_the_volume_or_the_area_of_its_closed_form) {
    struct geom_scratch scratch;
    CHECK(geom_scratch_init(&scratch, 64));
    for (int kind = 0; kind < GEOMETRY_KIND_COUNT; kind++) {
        struct shape_makers makers = {0};
        struct test_random random = {(uint64_t)(200 + kind)};
        int known = 0;
        for (int i = 0; i < 60 && known < 3; i++) {
            struct made_geometry made = make_geometry(&makers, kind, &random);
            if (isnan(made.volume) && isnan(made.area))
                continue;
            known++;
            measure(&made, &random, &scratch);
        }
        if (known < 3)
            test_fail(__FILE__, __LINE__, "%s: its maker states neither a volume nor an area", kind_name(kind));
        shape_makers_destroy(&makers);
    }
    geom_scratch_destroy(&scratch);
}
