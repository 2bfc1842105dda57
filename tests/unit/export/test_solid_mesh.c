/* Meshes of solids: closed, without intersections by a test of their own, within the tolerance in both directions. */
#include "csg/csg_build.h"
#include "export/solid_cast_internal.h"
#include "export/solid_mesh_internal.h"
#include "export/triangles_internal.h"
#include "math/elementary.h"
#include "tests/unit/random_makers.h"
#include "tests/unit/shape_makers.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* --- makers --- */

static const struct csg *solid_of(struct arena *arena, const struct csg_leaf *leaves, uint32_t count,
                                  const enum csg_operation *operations) {
    struct csg_token program[64];
    struct error error = {0};
    uint32_t length = 0;
    for (uint32_t i = 0; i < count; i++) {
        program[length++] = (struct csg_token){CSG_LEAF, (uint16_t)i};
        if (i > 0)
            program[length++] = (struct csg_token){operations[i - 1], 0};
    }
    const struct csg *csg = csg_build(arena, leaves, count, program, length, &error);
    if (!csg)
        test_fail(__FILE__, __LINE__, "csg_build: %s", error.text);
    return csg;
}

static struct csg_leaf leaf_of(struct shape shape, struct transform map) {
    return (struct csg_leaf){.shape = shape, .csg_from_leaf = map};
}
static struct shape ball(double radius) {
    return (struct shape){.kind = SHAPE_SPHERE, .sphere = {{0, 0, 0}, radius}};
}
static struct shape block(struct vec3 min, struct vec3 max) {
    return (struct shape){.kind = SHAPE_BOX, .box = {min, max}};
}
static struct shape cylinder(struct vec3 from, struct vec3 to, double radius) {
    return (struct shape){.kind = SHAPE_REVOLVED_QUADRIC,
                          .revolved_quadric = revolved_quadric_cylinder(from, to, radius, false)};
}
static struct transform turned(double x, double y, double z) {
    struct transform a = transform_rotate(0, x), b = transform_rotate(1, y), c = transform_rotate(2, z);
    struct transform t = transform_compose(&b, &a);
    return transform_compose(&c, &t);
}

/* --- checks --- */

static double turn(struct vec3 a, struct vec3 b, struct vec3 c, struct vec3 d) {
    long double x[3][3];
    for (int i = 0; i < 3; i++) {
        struct vec3 p = i == 0 ? b : i == 1 ? c : d;
        x[i][0] = (long double)p.x - a.x, x[i][1] = (long double)p.y - a.y, x[i][2] = (long double)p.z - a.z;
    }
    return (double)(x[0][0] * (x[1][1] * x[2][2] - x[1][2] * x[2][1]) -
                    x[0][1] * (x[1][0] * x[2][2] - x[1][2] * x[2][0]) +
                    x[0][2] * (x[1][0] * x[2][1] - x[1][1] * x[2][0]));
}

/* By the signs of volumes; coordinates of single precision make them exact but for tiny ones. */
static bool edge_meets(struct vec3 a, struct vec3 b, const struct vec3 t[3]) {
    double above = turn(t[0], t[1], t[2], a), below = turn(t[0], t[1], t[2], b);
    if (above * below >= 0)
        return false;
    double x = turn(a, b, t[0], t[1]), y = turn(a, b, t[1], t[2]), z = turn(a, b, t[2], t[0]);
    return (x > 0 && y > 0 && z > 0) || (x < 0 && y < 0 && z < 0);
}

static bool meet(const struct corners *a, const struct corners *b) {
    for (int i = 0; i < 3; i++) {
        int k = (i + 1) % 3;
        bool common = false, other = false;
        for (int n = 0; n < 3; n++) {
            common = common || a->vertex[i] == b->vertex[n] || a->vertex[k] == b->vertex[n];
            other = other || b->vertex[i] == a->vertex[n] || b->vertex[k] == a->vertex[n];
        }
        if ((!common && edge_meets(a->point[i], a->point[k], b->point)) ||
            (!other && edge_meets(b->point[i], b->point[k], a->point)))
            return true;
    }
    return false;
}

static int by_low_x(const void *one, const void *other) {
    double x = ((const struct box *)one)->min.x, y = ((const struct box *)other)->min.x;
    return (x > y) - (x < y);
}

struct swept {
    struct box box; /* the first member, for by_low_x */
    struct corners corners;
};

/* Pairs of triangles that intersect, by a sweep along x. */
static uint32_t intersections(const struct solid_mesh *mesh) {
    uint32_t count = (uint32_t)mesh->triangles.count, found = 0;
    struct swept *all = malloc(count * sizeof *all);
    for (uint32_t i = 0; i < count; i++) {
        all[i].corners = corners_of(mesh, i);
        all[i].box = corners_box(&all[i].corners);
    }
    qsort(all, count, sizeof *all, by_low_x);
    for (uint32_t i = 0; i < count; i++) {
        for (uint32_t k = i + 1; k < count && all[k].box.min.x <= all[i].box.max.x; k++) {
            struct box both = box_meet(all[i].box, all[k].box);
            found += !box_is_empty(&both) && meet(&all[i].corners, &all[k].corners);
        }
    }
    free(all);
    return found;
}

static double volume_of(const struct solid_mesh *mesh, double *area) {
    double volume = 0;
    *area = 0;
    for (uint32_t i = 0; i < mesh->triangles.count; i++) {
        struct corners c = corners_of(mesh, i);
        volume += vec3_dot(c.point[0], vec3_cross(c.point[1], c.point[2])) / 6;
        *area += vec3_length(triangle_normal(c.point)) / 2;
    }
    return volume;
}

/* Vertices - edges + faces. */
static int euler_of(const struct solid_mesh *mesh) {
    return (int)mesh->vertices.count - (int)mesh->triangles.count / 2;
}

static double distance_to_mesh(const struct solid_mesh *mesh, const struct box_tree *tree, struct vec3 p,
                               double limit) {
    struct region_search search;
    double nearest = INFINITY;
    uint32_t triangle;
    region_search_begin(&search, tree, (struct box){vec3_sub(p, vec3_all(limit)), vec3_add(p, vec3_all(limit))});
    while (region_search_next(&search, &triangle)) {
        struct corners c = corners_of(mesh, triangle);
        nearest = fmin(nearest, triangle_distance_squared(p, c.point));
    }
    return sqrt(nearest);
}

/* Points of the solid that are farther than the tolerance from the mesh, of those on random lines, and points of the
 * mesh that are not proved to be near to the solid. */
static void count_far(const struct solid_mesh *mesh, const struct csg *csg, double tolerance, int lines,
                      struct test_random *random, uint32_t *of_solid, uint32_t *of_mesh) {
    struct solid_probe probe;
    struct box_tree tree;
    struct error error = {0};
    char warning[256];
    struct pool *pool = pool_create(1, warning);
    struct vec3 middle = vec3_scale(vec3_add(csg->bounds.min, csg->bounds.max), 0.5);
    double radius = vec3_length(vec3_sub(csg->bounds.max, middle));
    *of_solid = *of_mesh = 0;
    CHECK(solid_probe_init(&probe, csg) && triangle_tree_build(&tree, mesh, pool, &error));
    for (int i = 0; i < lines; i++) {
        solid_cast(&probe, vec3_add(middle, random_vec3(random, radius)), random_vec3(random, 1));
        for (uint32_t k = 0; k < probe.count; k++)
            *of_solid += distance_to_mesh(mesh, &tree, probe.found[k].point, 2 * tolerance) > tolerance;
        struct corners c = corners_of(mesh, (uint32_t)test_uniform(random, 0, (double)mesh->triangles.count));
        double u = sqrt(test_uniform(random, 0, 1)), v = test_uniform(random, 0, 1);
        struct vec3 at = vec3_add_scaled(vec3_scale(c.point[0], 1 - u), c.point[1], u * (1 - v));
        at = vec3_add_scaled(at, c.point[2], u * v);
        struct vec3 normal = vec3_normalize(triangle_normal(c.point));
        *of_mesh += !solid_is_near_for_sure(&probe, at, normal, 1.05 * tolerance);
    }
    solid_probe_destroy(&probe);
    box_tree_destroy(&tree);
    pool_destroy(pool);
}

/* What every mesh must be. False: there is none, and *error says why. */
static bool check_solid(const char *what, const struct csg *csg, double tolerance, int lines,
                        struct test_random *random, struct solid_mesh *mesh, struct solid_findings *findings,
                        struct error *error) {
    char warning[256];
    struct pool *pool = pool_create(2, warning);
    const struct solid_input input = {csg, what, tolerance, pool};
    bool closed = false;
    uint32_t of_solid, of_mesh;
    bool ok = solid_mesh_build(&input, mesh, findings, error);
    pool_destroy(pool);
    if (!ok)
        return false;
    CHECK(solid_mesh_is_closed(mesh, &closed, error));
    if (!closed)
        test_fail(__FILE__, __LINE__, "%s: the mesh is open", what);
    uint32_t found = intersections(mesh);
    if (found > 0)
        test_fail(__FILE__, __LINE__, "%s: %u pairs of triangles intersect", what, found);
    count_far(mesh, csg, tolerance, lines, random, &of_solid, &of_mesh);
    /* A detail that no line of the grid meets may be lost. */
    if (of_solid > (uint32_t)lines / 1000 || of_mesh > 0)
        test_fail(__FILE__, __LINE__, "%s: %u points of the solid and %u of the mesh of %d are too far", what, of_solid,
                  of_mesh, lines);
    return true;
}

static struct solid_mesh mesh_of(const char *what, const struct csg *csg, double tolerance) {
    struct solid_mesh mesh = {0};
    struct solid_findings findings;
    struct error error = {0};
    struct test_random random = {1};
    if (!check_solid(what, csg, tolerance, 1000, &random, &mesh, &findings, &error))
        test_fail(__FILE__, __LINE__, "%s: %s", what, error.text);
    return mesh;
}

/* --- tests --- */

TEST(a_turned_cube_has_12_triangles_at_its_corners) {
    struct arena arena = {0};
    const struct csg_leaf leaf = leaf_of(block(vec3_all(-0.5), vec3_all(0.5)), turned(30, 40, 50));
    const struct csg *csg = solid_of(&arena, &leaf, 1, NULL);
    struct solid_mesh mesh = mesh_of("cube", csg, 1e-3);
    double area;
    CHECK_EQ_INT(mesh.triangles.count, 12);
    CHECK_EQ_INT(euler_of(&mesh), 2);
    CHECK_NEAR(volume_of(&mesh, &area), 1, 1e-6);
    for (uint32_t i = 0; i < mesh.vertices.count; i++)
        CHECK_NEAR(vec3_length(solid_vertex_at(&mesh, i)->point), sqrt(0.75), 1e-6);
    solid_mesh_destroy(&mesh);
    arena_destroy(&arena);
}

TEST(a_ball_and_a_torus_have_their_volume_and_genus) {
    struct arena arena = {0};
    struct csg_leaf leaf = leaf_of(ball(1), transform_identity());
    struct solid_mesh mesh = mesh_of("ball", solid_of(&arena, &leaf, 1, NULL), 4e-3);
    double area;
    CHECK_NEAR(volume_of(&mesh, &area), 4 * PI / 3, 4e-3 * 4 * PI);
    CHECK_NEAR(area, 4 * PI, 0.01 * 4 * PI);
    CHECK_EQ_INT(euler_of(&mesh), 2);
    solid_mesh_destroy(&mesh);
    leaf = leaf_of((struct shape){.kind = SHAPE_TORUS, .torus = {0.7, 0.25}}, turned(20, 30, 0));
    mesh = mesh_of("torus", solid_of(&arena, &leaf, 1, NULL), 4e-3);
    CHECK_NEAR(volume_of(&mesh, &area), 2 * PI * PI * 0.7 * 0.0625, 4e-3 * 4 * PI * PI * 0.7 * 0.25);
    CHECK_EQ_INT(euler_of(&mesh), 0);
    solid_mesh_destroy(&mesh);
    arena_destroy(&arena);
}

TEST(a_drilled_plate_has_sharp_edges_and_few_triangles) {
    struct arena arena = {0};
    const struct csg_leaf leaves[2] = {
        leaf_of(block(vec3_make(-1, -0.6, -0.4), vec3_make(1, 0.6, 0.4)), transform_identity()),
        leaf_of(cylinder(vec3_make(0, 0, -1), vec3_make(0, 0, 1), 0.35), transform_identity())};
    const enum csg_operation minus = CSG_DIFFERENCE;
    struct solid_mesh mesh = mesh_of("drilled plate", solid_of(&arena, leaves, 2, &minus), 2e-3);
    double area;
    CHECK_NEAR(volume_of(&mesh, &area), 1.92 - PI * 0.35 * 0.35 * 0.8, 2e-3 * 2 * PI * 0.35 * 0.8);
    CHECK_EQ_INT(euler_of(&mesh), 0);
    CHECK(mesh.triangles.count < 400);
    /* The vertices on the rim are on both surfaces. */
    for (uint32_t i = 0; i < mesh.vertices.count; i++) {
        struct vec3 p = solid_vertex_at(&mesh, i)->point;
        double radius = sqrt(p.x * p.x + p.y * p.y);
        if (radius < 0.45 && fabs(p.z) > 0.39999)
            CHECK(fabs(radius - 0.35) < 1e-6 && fabs(fabs(p.z) - 0.4) < 1e-6);
    }
    solid_mesh_destroy(&mesh);
    arena_destroy(&arena);
}

TEST(a_shell_of_three_tolerances_stays_a_shell) {
    struct arena arena = {0};
    double tolerance = 4e-3;
    const struct csg_leaf leaves[2] = {leaf_of(ball(1), transform_identity()),
                                       leaf_of(ball(1 - 3 * tolerance), transform_identity())};
    const enum csg_operation minus = CSG_DIFFERENCE;
    struct solid_mesh mesh = mesh_of("shell", solid_of(&arena, leaves, 2, &minus), tolerance);
    CHECK_EQ_INT(euler_of(&mesh), 4); /* two closed surfaces */
    solid_mesh_destroy(&mesh);
    arena_destroy(&arena);
}

TEST(solids_that_touch_in_an_edge_are_separated_there) {
    struct arena arena = {0};
    const struct csg_leaf leaves[2] = {
        leaf_of(block(vec3_make(-0.8, -0.8, -0.5), vec3_make(0, 0, 0.5)), transform_identity()),
        leaf_of(block(vec3_make(0, 0, -0.5), vec3_make(0.8, 0.8, 0.5)), transform_identity())};
    const enum csg_operation plus = CSG_UNION;
    struct solid_mesh mesh = {0};
    struct solid_findings findings;
    struct error error = {0};
    struct test_random random = {1};
    CHECK(check_solid("cubes", solid_of(&arena, leaves, 2, &plus), 5e-3, 1000, &random, &mesh, &findings, &error));
    CHECK(findings.separated > 0);
    CHECK_NEAR(findings.position.x, 0, 1e-2);
    CHECK_NEAR(findings.position.y, 0, 1e-2);
    solid_mesh_destroy(&mesh);
    arena_destroy(&arena);
}

TEST(an_empty_solid_is_an_error) {
    struct arena arena = {0};
    const struct csg_leaf leaves[2] = {leaf_of(ball(1), transform_identity()), leaf_of(ball(2), transform_identity())};
    const enum csg_operation minus = CSG_DIFFERENCE;
    struct solid_mesh mesh = {0};
    struct solid_findings findings;
    struct error error = {0};
    struct test_random random = {1};
    CHECK(!check_solid("nothing", solid_of(&arena, leaves, 2, &minus), 1e-2, 10, &random, &mesh, &findings, &error));
    CHECK_TEXT(error.text, "node 'nothing' is empty: there is nothing to write");
    arena_destroy(&arena);
}

TEST_TIMES(every_closed_shape_becomes_a_closed_mesh_within_the_tolerance, 12) {
    struct test_random random = {38};
    for (int kind = 0; kind < SHAPE_KIND_COUNT; kind++) {
        struct shape_makers makers = {0};
        for (int made = 0, tries = 0; made < times && tries < 40 * times; tries++) {
            struct made_shape shape = make_shape(&makers, (enum shape_kind)kind, &random);
            struct box bounds = shape_bounds(&shape.shape);
            if (!shape_is_closed(&shape.shape) || !vec3_finite(bounds.min) || !vec3_finite(bounds.max))
                continue;
            const struct csg_leaf leaf = leaf_of(shape.shape, turned(20, 30, 50));
            const struct csg *csg = solid_of(&makers.arena, &leaf, 1, NULL);
            double tolerance = vec3_max_abs(vec3_sub(csg->bounds.max, csg->bounds.min)) / (times > 1 ? 400 : 100), area;
            struct solid_mesh mesh = {0};
            struct solid_findings findings;
            struct error error = {0};
            made++;
            const char *name = shape_kind_name((enum shape_kind)kind);
            if (!check_solid(name, csg, tolerance, times > 1 ? 20000 : 500, &random, &mesh, &findings, &error)) {
                test_fail(__FILE__, __LINE__, "%s: %s", name, error.text);
                continue;
            }
            double volume = volume_of(&mesh, &area);
            if (isfinite(shape.volume) && fabs(volume - shape.volume) > tolerance * area)
                test_fail(__FILE__, __LINE__, "%s: the volume is %g, not %g", name, volume, shape.volume);
            solid_mesh_destroy(&mesh);
        }
        shape_makers_destroy(&makers);
    }
}

static struct csg_leaf random_leaf(struct test_random *random, bool first) {
    double size = test_uniform(random, 0.25, 0.7), spread = first ? 0.1 : 0.7, kind = test_uniform(random, 0, 1);
    struct vec3 up = {0, size, 0};
    struct shape shape = ball(size);
    if (kind < 0.3)
        shape = block(vec3_make(-size, -size * test_uniform(random, 0.3, 1.3), -size * test_uniform(random, 0.3, 1.3)),
                      vec3_make(size, 0.7 * size, 0.6 * size));
    else if (kind < 0.5)
        shape = cylinder(vec3_negate(up), up, test_uniform(random, 0.1, 0.4));
    else if (kind < 0.65)
        shape = (struct shape){.kind = SHAPE_TORUS, .torus = {size, test_uniform(random, 0.08, 0.23)}};
    else if (kind < 0.8)
        shape = (struct shape){.kind = SHAPE_REVOLVED_QUADRIC,
                               .revolved_quadric = revolved_quadric_frustum(
                                   vec3_negate(up), test_uniform(random, 0.1, 0.55), up,
                                   test_uniform(random, 0, 1) < 0.5 ? 0 : test_uniform(random, 0, 0.2), false)};
    bool straight = test_uniform(random, 0, 1) < 0.4;
    struct transform turn_of =
        straight ? turned(90 * floor(test_uniform(random, 0, 2)), 90 * floor(test_uniform(random, 0, 2)), 0)
                 : turned(test_uniform(random, 0, 360), test_uniform(random, 0, 360), 0);
    struct transform move = transform_translate(random_vec3(random, spread));
    return leaf_of(shape, transform_compose(&move, &turn_of));
}

TEST_TIMES(random_solids_become_closed_meshes_without_intersections, 200) {
    int errors = 0;
    for (int tree = 0; tree < 5 * times; tree++) {
        struct arena arena = {0};
        struct test_random random = {(uint64_t)tree + 1000};
        struct csg_leaf leaves[14];
        enum csg_operation operations[14];
        uint32_t count = (uint32_t)test_uniform(&random, 3, 15);
        for (uint32_t i = 0; i < count; i++) {
            double operation = test_uniform(&random, 0, 1);
            leaves[i] = random_leaf(&random, i == 0);
            operations[i] = operation < 0.5 ? CSG_UNION : operation < 0.9 ? CSG_DIFFERENCE : CSG_INTERSECTION;
        }
        const struct csg *csg = solid_of(&arena, leaves, count, operations);
        struct solid_mesh mesh = {0};
        struct solid_findings findings;
        struct error error = {0};
        char name[32];
        (void)snprintf(name, sizeof name, "tree %d", tree);
        if (!check_solid(name, csg, times > 1 ? 3e-3 : 1e-2, times > 1 ? 2000 : 500, &random, &mesh, &findings,
                         &error) &&
            !strstr(error.text, "is empty"))
            errors++;
        solid_mesh_destroy(&mesh);
        arena_destroy(&arena);
    }
    if (errors > times * 5 / 1000)
        test_fail(__FILE__, __LINE__, "%d of %d trees have no mesh", errors, 5 * times);
}
