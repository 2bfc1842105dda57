/* The cost of one ray against one shape, and against CSG solids of many: shape_nearest from random points around the
 * shape to random points of its box, in nanoseconds of CPU time, the minimum of several rounds; and the share of rays
 * that hit.
 *
 *   shapes [NAME ...]        NAME is a part of a shape's name; without one all are measured */
#include "base/arena.h"
#include "csg/csg.h"
#include "csg/csg_build.h"
#include "shape/blob.h"
#include "shape/curve.h"
#include "shape/height_field.h"
#include "shape/lathe.h"
#include "shape/planar.h"
#include "shape/prism.h"
#include "shape/revolved_quadric.h"
#include "shape/shape.h"
#include "shape/sweep.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { RAYS = 4096, ROUNDS = 7 };

static double uniform(uint64_t *state) {
    *state = *state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (double)(*state >> 11) * 0x1p-52 - 1;
}

static struct vec3 somewhere(uint64_t *state) {
    double x = uniform(state), y = uniform(state), z = uniform(state);
    return vec3_make(x, y, z);
}

static double seconds(void) {
    struct timespec now;
    (void)clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static void measure(const char *name, const struct shape *shape, struct geom_scratch *scratch) {
    static struct ray rays[RAYS];
    uint64_t state = 1;
    struct box box = shape_bounds(shape);
    if (!vec3_finite(box.min) || !vec3_finite(box.max))
        box = (struct box){vec3_all(-1), vec3_all(1)};
    struct vec3 middle = vec3_scale(vec3_add(box.min, box.max), 0.5),
                half = vec3_scale(vec3_sub(box.max, box.min), 0.5);
    for (int i = 0; i < RAYS; i++) {
        struct vec3 origin = vec3_scale(somewhere(&state), 4), at = vec3_add(middle, vec3_mul(somewhere(&state), half));
        rays[i] = (struct ray){.origin = origin, .direction = vec3_sub(at, origin), .t_max = INFINITY};
    }
    double best = INFINITY;
    long hits = 0;
    for (int round = 0; round < ROUNDS; round++) {
        double start = seconds();
        struct crossing crossing;
        hits = 0;
        for (int i = 0; i < RAYS; i++)
            hits += shape_nearest(shape, &rays[i], scratch, &crossing);
        best = fmin(best, seconds() - start);
    }
    printf("%-32s %8.0f ns  %5.2f million rays/s  %3.0f %% hit\n", name, best / RAYS * 1e9, RAYS / best * 1e-6,
           100.0 * (double)hits / RAYS);
}

/* ---- combined solids ---- */

/* The reference for the cost of a solid: the crossings of all its leaves, each in its own space as if it were a
 * separate primitive. `boxes`: only leaves whose box the ray hits, including the test of the boxes. */
static double leaves_cost(const struct csg *csg, const struct ray *rays, const struct box *boxes,
                          struct geom_scratch *scratch) {
    double best = INFINITY;
    for (int round = 0; round < ROUNDS; round++) {
        double start = seconds();
        for (int i = 0; i < RAYS; i++) {
            struct box_probe probe = box_probe_make(&rays[i]);
            for (uint32_t k = 0; k < csg->leaf_count; k++) {
                if (boxes && !box_probe_meets(&probe, &boxes[k], 0, INFINITY))
                    continue;
                struct ray ray = ray_transform(&csg->leaves[k].csg_from_leaf.inverse, &rays[i]);
                struct crossing_list list;
                scratch->used = 0;
                (void)shape_crossings(&csg->leaves[k].shape, &ray, scratch, &list);
            }
        }
        best = fmin(best, seconds() - start);
    }
    scratch->used = 0;
    return best;
}

static void measure_solid(const char *name, struct arena *arena, const struct csg_leaf *leaves, uint32_t count,
                          const struct csg_token *program, struct geom_scratch *scratch) {
    static struct ray rays[RAYS];
    struct error error = {0};
    const struct csg *csg = csg_build(arena, leaves, count, program, 2 * count - 1, &error);
    struct box *boxes = arena_alloc_array(arena, count, sizeof *boxes);
    if (!csg || !boxes)
        return;
    uint64_t state = 1;
    struct vec3 middle = vec3_scale(vec3_add(csg->bounds.min, csg->bounds.max), 0.5),
                half = vec3_scale(vec3_sub(csg->bounds.max, csg->bounds.min), 0.5);
    for (uint32_t k = 0; k < count; k++)
        boxes[k] = box_pad(shape_bounds_under(&leaves[k].shape, &leaves[k].csg_from_leaf.forward));
    for (int i = 0; i < RAYS; i++) {
        struct vec3 origin = vec3_scale(somewhere(&state), 4), at = vec3_add(middle, vec3_mul(somewhere(&state), half));
        rays[i] = (struct ray){.origin = origin, .direction = vec3_sub(at, origin), .t_max = INFINITY};
    }
    double best = INFINITY;
    for (int round = 0; round < ROUNDS; round++) {
        double start = seconds();
        struct crossing crossing;
        for (int i = 0; i < RAYS; i++)
            (void)csg_nearest(csg, &rays[i], scratch, &crossing);
        best = fmin(best, seconds() - start);
    }
    double all = leaves_cost(csg, rays, NULL, scratch), boxed = leaves_cost(csg, rays, boxes, scratch);
    printf(
        "%-32s %8.0f ns  %5.2f million rays/s  %5.2f of all its leaves (%.0f ns), %5.2f of those it meets (%.0f ns)\n",
        name, best / RAYS * 1e9, RAYS / best * 1e-6, best / all, all / RAYS * 1e9, best / boxed, boxed / RAYS * 1e9);
}

/* Trees eight operations deep: a chain of nine leaves, and the full tree of 256; and unions. */
static void measure_solids(int argc, char **argv, bool (*wanted)(int, char **, const char *), struct arena *arena,
                           struct geom_scratch *scratch) {
    enum { DEPTH = 8, FULL = 1 << DEPTH };
    static struct csg_leaf leaves[FULL];
    static struct csg_token program[2 * FULL];
    static const char *const names[] = {"csg chain of depth 8", "csg tree of depth 8", "csg union of 100",
                                        "csg union of 100 touching", "csg ball less 100"};
    for (int kind = 0; kind < 5; kind++) {
        uint64_t state = 3;
        uint32_t count = kind == 0 ? DEPTH + 1 : kind == 1 ? FULL : 100, length = 0;
        for (uint32_t i = 0; i < count; i++) {
            double size = kind == 0 ? 0.7 : kind == 1 ? 0.4 : kind == 3 ? 0.3 : 0.1;
            struct transform scale = transform_scale(vec3_all(kind == 4 && i == 0 ? 1 : size));
            struct transform turn = transform_rotate((int)i % 3, 360 * uniform(&state));
            struct transform move = transform_translate(vec3_scale(somewhere(&state), kind == 0 ? 0.4 : 0.8));
            leaves[i] = (struct csg_leaf){.shape = {.kind = SHAPE_SPHERE, .sphere = {{0, 0, 0}, 1}}};
            if (i % 2)
                leaves[i].shape = (struct shape){.kind = SHAPE_BOX, .box = {{-1, -1, -1}, {1, 1, 1}}};
            leaves[i].csg_from_leaf = transform_compose(&turn, &scale);
            if (kind != 4 || i > 0)
                leaves[i].csg_from_leaf = transform_compose(&move, &leaves[i].csg_from_leaf);
            program[length++] = (struct csg_token){CSG_LEAF, (uint16_t)i};
            enum csg_operation operation = kind == 4                ? CSG_DIFFERENCE
                                           : kind > 1 || i % 4 != 3 ? CSG_UNION
                                                                    : CSG_DIFFERENCE;
            /* A full tree: after leaf i as many operations as i + 1 has factors of 2. */
            for (uint32_t done = 2; kind == 1 && (i + 1) % done == 0; done *= 2)
                program[length++] = (struct csg_token){done == 2   ? CSG_DIFFERENCE
                                                       : done == 8 ? CSG_INTERSECTION
                                                                   : CSG_UNION,
                                                       0};
            if (kind != 1 && i > 0)
                program[length++] = (struct csg_token){operation, 0};
        }
        if (wanted(argc, argv, names[kind]))
            measure_solid(names[kind], arena, leaves, count, program, scratch);
    }
}

static bool is_wanted(int argc, char **argv, const char *name) {
    bool wanted = argc < 2;
    for (int k = 1; k < argc; k++)
        wanted = wanted || strstr(name, argv[k]) != NULL;
    return wanted;
}

/* Shapes of many parts, each once small and once large. */
static void measure_swept(int argc, char **argv, struct arena *arena, struct geom_scratch *scratch) {
    enum { MAX = 1001, SIDE = 513 };
    static double profile[MAX][2], outline[2 * MAX][2], helix[MAX][3], sizes[MAX], heights[SIDE * SIDE];
    static struct blob_element elements[200];
    struct error error = {0};
    for (int many = 0; many < 2; many++) {
        int count = many ? MAX : 9;
        uint64_t state = 5;
        for (int i = 0; i < count; i++) {
            double x = (double)i / (count - 1), turn = 6.283185307179586 * i / count, size = 0.8 + 0.2 * cos(8 * turn);
            profile[i][0] = i == 0 || i == count - 1 ? 0 : 0.7 + 0.2 * sin(20 * x);
            profile[i][1] = 2 * x - 1;
            outline[i][0] = size * cos(turn);
            outline[i][1] = size * sin(turn);
            helix[i][0] = cos(many ? 0.2 * i : i), helix[i][1] = 2 * x - 1, helix[i][2] = sin(many ? 0.2 * i : i);
            sizes[i] = many ? 0.02 : 0.15;
        }
        const uint32_t starts[] = {0, (uint32_t)count};
        for (int spline = 0; spline < 2; spline++) {
            enum spline_kind kind = spline ? SPLINE_CATMULL_ROM : SPLINE_LINEAR;
            char name[64];
            struct lathe_input lathe = {.kind = kind, .points = (const double(*)[2])profile, .count = (uint32_t)count};
            struct prism_input prism = {kind, (const double(*)[2])outline, starts, 1, -0.5, 0.5};
            struct sweep_input sweep = {kind, (const double(*)[3])helix, sizes, (uint32_t)count, false};
            const struct shape made[] = {{.kind = SHAPE_LATHE, .lathe = lathe_build(arena, &lathe, &error)},
                                         {.kind = SHAPE_PRISM, .prism = prism_build(arena, &prism, &error)},
                                         {.kind = SHAPE_SWEEP, .sweep = sweep_build(arena, &sweep, &error)}};
            static const char *const names[] = {"lathe", "prism", "sweep"};
            for (int k = 0; k < 3; k++) {
                (void)snprintf(name, sizeof name, "%s, %s, %d points", names[k], spline ? "spline" : "linear", count);
                if (is_wanted(argc, argv, name))
                    measure(name, &made[k], scratch);
            }
        }
        int side = many ? SIDE : 17, balls = many ? 200 : 5;
        for (int j = 0; j < side; j++)
            for (int i = 0; i < side; i++)
                heights[j * side + i] = 0.1 * sin(9.0 * i / side) * cos(11.0 * j / side) + 0.01 * uniform(&state);
        struct height_field_input land = {
            .heights = heights, .columns = (uint32_t)side, .rows = (uint32_t)side, .floor = -0.2};
        for (int i = 0; i < balls; i++) {
            elements[i].a = elements[i].b = somewhere(&state);
            elements[i].radius = many ? 0.2 : 0.8;
            elements[i].strength = 1;
        }
        struct blob_input blob = {elements, (uint32_t)balls, 0.5};
        struct curve_input curve = {SPLINE_CATMULL_ROM, (const double(*)[3])helix, sizes, (uint32_t)count, false};
        const struct shape made[] = {
            {.kind = SHAPE_HEIGHT_FIELD, .height_field = height_field_build(arena, &land, &error)},
            {.kind = SHAPE_BLOB, .blob = blob_build(arena, &blob, &error)},
            {.kind = SHAPE_CURVE, .curve = curve_build(arena, &curve, &error)}};
        static const char *const names[] = {"height field of 17 x 17",   "blob of 5 balls",   "curve, 9 points",
                                            "height field of 513 x 513", "blob of 200 balls", "curve, 1001 points"};
        for (int k = 0; k < 3; k++)
            if (is_wanted(argc, argv, names[3 * many + k]))
                measure(names[3 * many + k], &made[k], scratch);
    }
}

int main(int argc, char **argv) {
    static const struct quadric saddle = {.c = {1, -1, 1, 0.3, 0, 0, 0, 0, 0, -0.2},
                                          .limits = {{-1, -1, -1}, {1, 1, 1}}};
    struct vec3 low = {0, -1, 0}, zero = {0, 0, 0}, up = {0, 1, 0};
    const struct vec3 corners[] = {{1, 0, 0}, {0, 0, -1}, {-1, 0, 0}, {0.2, 0, 0.1}, {0, 0, 1}};
    const uint32_t end = 5;
    struct arena arena = {0};
    struct planar polygon;
    const char *why;
    struct geom_scratch scratch;
    if (!geom_scratch_init(&scratch, 1 << 16) || !planar_polygon(&arena, corners, &end, 1, &polygon, &why))
        return 3;
    const struct {
        const char *name;
        struct shape shape;
    } table[] = {
        {"sphere", {.kind = SHAPE_SPHERE, .sphere = {{0, 0, 0}, 1}}},
        {"box", {.kind = SHAPE_BOX, .box = {{-1, -1, -1}, {1, 1, 1}}}},
        {"ellipsoid", {.kind = SHAPE_ELLIPSOID, .ellipsoid = {{0, 0, 0}, {1, 0.5, 0.7}}}},
        {"cylinder",
         {.kind = SHAPE_REVOLVED_QUADRIC, .revolved_quadric = revolved_quadric_cylinder(low, up, 1, false)}},
        {"open cylinder",
         {.kind = SHAPE_REVOLVED_QUADRIC, .revolved_quadric = revolved_quadric_cylinder(low, up, 1, true)}},
        {"cone", {.kind = SHAPE_REVOLVED_QUADRIC, .revolved_quadric = revolved_quadric_frustum(zero, 0, up, 1, false)}},
        {"paraboloid", {.kind = SHAPE_REVOLVED_QUADRIC, .revolved_quadric = revolved_quadric_paraboloid(1, 1, false)}},
        {"hyperboloid of one sheet",
         {.kind = SHAPE_REVOLVED_QUADRIC, .revolved_quadric = revolved_quadric_one_sheet(0.5, 1, -1, 1, false)}},
        {"hyperboloid of two sheets",
         {.kind = SHAPE_REVOLVED_QUADRIC, .revolved_quadric = revolved_quadric_two_sheets(0.5, 1, 1, false)}},
        {"quadric", {.kind = SHAPE_QUADRIC, .quadric = &saddle}},
        {"torus", {.kind = SHAPE_TORUS, .torus = {1, 0.4}}},
        {"superellipsoid 0.3, 0.3", {.kind = SHAPE_SUPERELLIPSOID, .superellipsoid = {0.3, 0.3}}},
        {"superellipsoid 1.5, 1.5", {.kind = SHAPE_SUPERELLIPSOID, .superellipsoid = {1.5, 1.5}}},
        {"superellipsoid 3, 3", {.kind = SHAPE_SUPERELLIPSOID, .superellipsoid = {3, 3}}},
        {"square", {.kind = SHAPE_PLANAR, .planar = planar_square()}},
        {"disc", {.kind = SHAPE_PLANAR, .planar = planar_disc(zero, up, 1, 0)}},
        {"triangle", {.kind = SHAPE_PLANAR, .planar = planar_triangle(corners[0], corners[1], corners[2])}},
        {"polygon of 5", {.kind = SHAPE_PLANAR, .planar = polygon}},
        {"half-space", {.kind = SHAPE_PLANAR, .planar = planar_plane(up, 0)}},
    };
    for (size_t i = 0; i < sizeof table / sizeof table[0]; i++)
        if (is_wanted(argc, argv, table[i].name))
            measure(table[i].name, &table[i].shape, &scratch);
    measure_swept(argc, argv, &arena, &scratch);
    measure_solids(argc, argv, is_wanted, &arena, &scratch);
    geom_scratch_destroy(&scratch);
    arena_destroy(&arena);
    return 0;
}
