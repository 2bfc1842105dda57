/* CSG against point-by-point evaluation, coincident faces, algebra, deep programs, exactness under scaling. */
#include "base/mem.h"
#include "csg/csg.h"
#include "csg/csg_build.h"
#include "mesh/mesh.h"
#include "tests/harness.h"
#include "tests/unit/csg_crossings.h"
#include "tests/unit/random_makers.h"

#include <math.h>
#include <stdlib.h>

static struct csg_leaf leaf_of(enum shape_kind kind, struct transform csg_from_leaf) {
    struct csg_leaf leaf = {.shape = {.kind = kind}, .csg_from_leaf = csg_from_leaf};
    if (kind == SHAPE_SPHERE)
        leaf.shape.sphere.radius = 1;
    else
        leaf.shape.box = (struct box){vec3_all(0), vec3_all(1)};
    return leaf;
}

static struct transform then(struct transform first, struct transform second) {
    return transform_compose(&second, &first);
}

static struct transform random_transform(struct test_random *random, double extent) {
    double x = exp(test_uniform(random, -0.7, 0.7)), y = exp(test_uniform(random, -0.7, 0.7));
    double z = exp(test_uniform(random, -0.7, 0.7)) * (test_uniform(random, 0, 1) < 0.3 ? -1 : 1);
    struct transform t = transform_scale(vec3_make(x, y, z));
    for (int axis = 0; axis < 3; axis++)
        t = then(t, transform_rotate(axis, test_uniform(random, 0, 360)));
    return then(t, transform_translate(random_vec3(random, extent)));
}

/* A random tree of `count` leaves as a postfix program: leaves are pushed and combined at random. */
static const struct csg *build(struct arena *arena, const struct csg_leaf *leaves, uint32_t count,
                               const struct csg_token *program, uint32_t length) {
    struct error error = {0};
    const struct csg *csg = csg_build(arena, leaves, count, program, length, &error);
    if (!csg)
        test_fail(__FILE__, __LINE__, "csg_build: %s", error.text);
    return csg;
}

static struct ray line_through(struct vec3 origin, struct vec3 target) {
    return (struct ray){.origin = origin, .direction = vec3_sub(target, origin), .t_min = -INFINITY, .t_max = INFINITY};
}

static struct crossing_list all_crossings(const struct csg *csg, const struct ray *ray, struct geom_scratch *scratch) {
    struct crossing_list list;
    scratch->used = 0;
    while (!csg_crossings(csg, ray, scratch, &list) && scratch->overflow)
        CHECK(geom_scratch_grow(scratch));
    return list;
}

/* Entries and exits alternate, t ascends, nearest and any agree with the list. */
static void check_list(const struct csg *csg, const struct ray *ray, struct geom_scratch *scratch,
                       struct crossing_list list) {
    CHECK_EQ_INT(list.count % 2, 0);
    for (uint32_t i = 0; i < list.count; i++) {
        const struct crossing *c = &scratch->items[list.first + i];
        CHECK(c->enter == (i % 2 == 0));
        CHECK(i == 0 || c->t > c[-1].t);
    }
    struct ray part = *ray;
    part.t_min = list.count ? scratch->items[list.first + list.count / 4].t : 0;
    struct crossing found = {0};
    uint32_t expected = list.count / 4 + 1;
    bool any = csg_any(csg, &part, scratch), nearest = csg_nearest(csg, &part, scratch, &found);
    CHECK(any == (expected < list.count) && nearest == any);
    if (nearest && expected < list.count)
        CHECK(found.t == scratch->items[list.first + expected].t &&
              found.leaf == scratch->items[list.first + expected].leaf);
}

struct tally {
    uint64_t segments, insides, wrong, inward, surfaces;
};

/* The middle of every segment is inside exactly if the list says so; normals point out of the solid. */
static void check_segments(const struct csg *csg, const struct ray *ray, struct geom_scratch *scratch,
                           struct crossing_list list, struct tally *tally) {
    for (uint32_t i = 0; i <= list.count; i++) {
        const struct crossing *c = &scratch->items[list.first + i];
        double from = i == 0 ? (list.count ? c[0].t - 1 : 0) : c[-1].t;
        double to = i == list.count ? (list.count ? c[-1].t + 1 : 1) : c[0].t;
        bool inside = i % 2 == 1;
        uint32_t used = scratch->used;
        tally->segments++;
        tally->insides += inside;
        if (to - from > 1e-11 && csg_contains(csg, ray_at(ray, from / 2 + to / 2), scratch) != inside)
            tally->wrong++;
        scratch->used = used;
        if (i == list.count)
            break;
        struct surface surface;
        struct crossing copy = *c;
        csg_describe(csg, ray, &copy, &surface);
        tally->surfaces++;
        tally->inward += copy.enter != (vec3_dot(surface.normal, ray->direction) < 0);
    }
}

TEST_TIMES(csg_segments_equal_point_by_point_evaluation, 50) {
    enum { MAX = 24 };
    struct test_random random = {1};
    struct geom_scratch scratch;
    CHECK(geom_scratch_init(&scratch, 1000));
    struct tally tally = {0};
    for (int tree = 0; tree < 500 * times; tree++) {
        struct arena arena = {0};
        struct csg_leaf leaves[MAX];
        struct csg_token program[2 * MAX];
        uint32_t count = 1 + (uint32_t)test_uniform(&random, 0, tree % 10 == 0 ? MAX - 0.001 : 7.999);
        for (uint32_t i = 0; i < count; i++)
            leaves[i] =
                leaf_of(test_uniform(&random, 0, 1) < 0.5 ? SHAPE_SPHERE : SHAPE_BOX, random_transform(&random, 1));
        const struct csg *csg = build(&arena, leaves, count, program, random_program(&random, 0, count, 0, program));
        for (int i = 0; csg && i < 500; i++) {
            struct vec3 origin = random_vec3(&random, i % 4 ? 4 : 1);
            struct ray ray = line_through(origin, random_vec3(&random, 1));
            struct crossing_list list = all_crossings(csg, &ray, &scratch);
            check_list(csg, &ray, &scratch, list);
            check_segments(csg, &ray, &scratch, list, &tally);
        }
        arena_destroy(&arena);
    }
    CHECK_EQ_INT(tally.wrong, 0);
    CHECK_EQ_INT(tally.inward, 0);
    CHECK(tally.insides > 75000 * (uint64_t)times && tally.surfaces == 2 * tally.insides);
    geom_scratch_destroy(&scratch);
}

/* The box from `min` to `max` as a leaf, through several transforms so that it has rounding errors of its own. */
static struct csg_leaf roundabout_box(struct test_random *random, struct vec3 min, struct vec3 max,
                                      const struct transform *last) {
    struct vec3 size = vec3_sub(max, min), by = random_vec3(random, 3);
    double factor = exp(test_uniform(random, -1, 1)), angle = test_uniform(random, -180, 180);
    int axis = (int)test_uniform(random, 0, 2.999);
    struct transform t = transform_translate(by);
    t = then(t, transform_scale(vec3_all(factor)));
    t = then(t, transform_rotate(axis, angle));
    t = then(t, transform_rotate(axis, -angle));
    t = then(t, transform_scale(vec3_all(1 / factor)));
    t = then(t, transform_translate(vec3_negate(by)));
    t = then(t, transform_scale(size));
    t = then(t, transform_translate(min));
    return leaf_of(SHAPE_BOX, then(t, *last));
}

struct expected_box {
    struct vec3 min, max;
};

/* A program of boxes with common faces must be exactly one box, or nothing (min > max): on every line two crossings or
 * none, at the same t as for that box. */
static void check_is_box(uint64_t seed, const struct expected_box *operands, uint32_t count,
                         const struct csg_token *program, uint32_t length, struct expected_box expected) {
    struct test_random random = {seed};
    struct geom_scratch scratch;
    CHECK(geom_scratch_init(&scratch, 64));
    uint64_t wrong = 0, hits = 0;
    for (int turn = 0; turn < 50; turn++) {
        struct arena arena = {0};
        struct transform last = turn == 0 ? transform_identity() : random_transform(&random, 5);
        struct csg_leaf leaves[8];
        for (uint32_t i = 0; i < count; i++)
            leaves[i] = roundabout_box(&random, operands[i].min, operands[i].max, &last);
        const struct csg *csg = build(&arena, leaves, count, program, length);
        struct csg_leaf truth = leaf_of(SHAPE_BOX, last);
        bool nothing = !(expected.min.x < expected.max.x);
        truth.shape.box = (struct box){expected.min, expected.max};
        for (int i = 0; csg && i < 4000; i++) {
            double far = i % 16 ? 1 : exp(test_uniform(&random, 0, 10));
            struct vec3 origin = affine_point(&last.forward, random_vec3(&random, 4 * far));
            struct vec3 at = vec3_add(vec3_all(0.5), random_vec3(&random, 0.7));
            double tolerance = 1e-10 * far;
            if (i % 8 == 1) { /* nearly in the plane of a face */
                const double planes[] = {0, 0.3, 0.4, 0.5, 1};
                double plane = planes[i / 8 % 5], side = test_uniform(&random, -1e-5, 1e-5);
                at.x = plane + test_uniform(&random, -1e-6, 1e-6);
                origin = affine_point(&last.forward, vec3_make(plane + side, test_uniform(&random, -4, 4), -3));
                tolerance = 1e-7;
            }
            struct ray ray = line_through(origin, affine_point(&last.forward, at));
            struct crossing_list list = all_crossings(csg, &ray, &scratch);
            double t[2] = {0, 0};
            uint32_t found = list.count;
            for (uint32_t k = 0; k < found && k < 2; k++)
                t[k] = scratch.items[list.first + k].t;
            if (nothing) {
                wrong += found != 0;
                hits++;
                continue;
            }
            struct ray box_ray = ray_transform(&last.inverse, &ray);
            CHECK(shape_crossings(&truth.shape, &box_ray, &scratch, &list));
            const struct crossing *c = &scratch.items[list.first];
            hits += list.count > 0;
            if (found == list.count) {
                if (found && (fabs(t[0] - c[0].t) > tolerance || fabs(t[1] - c[1].t) > tolerance))
                    wrong++;
            } else { /* only a chord as short as a rounding error may differ */
                double chord = list.count ? c[1].t - c[0].t : t[1] - t[0];
                wrong += found > 2 || chord > tolerance;
            }
        }
        arena_destroy(&arena);
    }
    CHECK_EQ_INT(wrong, 0);
    CHECK(hits > 60000);
    geom_scratch_destroy(&scratch);
}

static const struct csg_token two[2][3] = {
    {{CSG_LEAF, 0}, {CSG_LEAF, 1}, {CSG_DIFFERENCE, 0}},
    {{CSG_LEAF, 0}, {CSG_LEAF, 1}, {CSG_UNION, 0}},
};

TEST(csg_difference_with_common_faces_leaves_no_skin) {
    /* The cutter shares five faces with what it cuts. */
    struct expected_box half[] = {{{0, 0, 0}, {1, 1, 1}}, {{0.5, 0, 0}, {1, 1, 1}}};
    check_is_box(1, half, 2, two[0], 3, (struct expected_box){{0, 0, 0}, {0.5, 1, 1}});
    /* One common face; the cutter protrudes at the others. */
    struct expected_box over[] = {{{0, 0, 0}, {1, 1, 1}}, {{-1, -1, 0.3}, {2, 2, 1}}};
    check_is_box(2, over, 2, two[0], 3, (struct expected_box){{0, 0, 0}, {1, 1, 0.3}});
    /* A cutter that touches from outside removes nothing. */
    struct expected_box outside[] = {{{0, 0, 0}, {1, 1, 1}}, {{1, 0, 0}, {2, 1, 1}}};
    check_is_box(3, outside, 2, two[0], 3, (struct expected_box){{0, 0, 0}, {1, 1, 1}});
    /* A solid minus itself is empty. */
    struct expected_box same[] = {{{0, 0, 0}, {1, 1, 1}}, {{0, 0, 0}, {1, 1, 1}}};
    check_is_box(4, same, 2, two[0], 3, (struct expected_box){{1, 1, 1}, {0, 0, 0}});
}

TEST(csg_operand_thinner_than_rounding_is_not_seen) {
    struct expected_box cut[] = {{{0, 0, 0}, {1, 1, 1}}, {{0.5, -1, -1}, {0.5 + 0x1p-53, 2, 2}}};
    check_is_box(14, cut, 2, two[0], 3, (struct expected_box){{0, 0, 0}, {1, 1, 1}});
    struct expected_box plate[] = {{{0, 0, 0}, {1, 1, 1}}, {{1, -1, -1}, {1 + 0x1p-52, 2, 2}}};
    check_is_box(15, plate, 2, two[1], 3, (struct expected_box){{0, 0, 0}, {1, 1, 1}});
}

TEST(csg_union_of_touching_solids_has_no_inner_wall) {
    struct expected_box halves[] = {{{0, 0, 0}, {0.4, 1, 1}}, {{0.4, 0, 0}, {1, 1, 1}}};
    check_is_box(5, halves, 2, two[1], 3, (struct expected_box){{0, 0, 0}, {1, 1, 1}});
    struct expected_box four[] = {
        {{0, 0, 0}, {0.4, 0.3, 1}}, {{0.4, 0, 0}, {1, 0.3, 1}}, {{0, 0.3, 0}, {0.4, 1, 1}}, {{0.4, 0.3, 0}, {1, 1, 1}}};
    const struct csg_token program[] = {{CSG_LEAF, 0}, {CSG_LEAF, 1},  {CSG_UNION, 0}, {CSG_LEAF, 2},
                                        {CSG_LEAF, 3}, {CSG_UNION, 0}, {CSG_UNION, 0}};
    check_is_box(6, four, 4, program, 7, (struct expected_box){{0, 0, 0}, {1, 1, 1}});
}

TEST(csg_intersection_of_touching_solids_is_empty) {
    struct expected_box touching[] = {{{0, 0, 0}, {0.4, 1, 1}}, {{0.4, 0, 0}, {1, 1, 1}}};
    const struct csg_token program[] = {{CSG_LEAF, 0}, {CSG_LEAF, 1}, {CSG_INTERSECTION, 0}};
    check_is_box(7, touching, 2, program, 3, (struct expected_box){{1, 1, 1}, {0, 0, 0}});
    struct expected_box same[] = {{{0, 0, 0}, {1, 1, 1}}, {{0, 0, 0}, {1, 1, 1}}};
    check_is_box(8, same, 2, program, 3, (struct expected_box){{0, 0, 0}, {1, 1, 1}});
}

/* Of two coincident faces one wins everywhere; their materials do not alternate. */
TEST(csg_coincident_faces_show_one_operand) {
    struct test_random random = {9};
    struct geom_scratch scratch;
    CHECK(geom_scratch_init(&scratch, 64));
    struct arena arena = {0};
    uint32_t shown[2] = {0, 0};
    for (int turn = 0; turn < 20; turn++) {
        struct transform last = random_transform(&random, 5);
        /* Both tops lie in y = 1; operand 1 covers the middle of operand 0. */
        struct csg_leaf leaves[] = {roundabout_box(&random, vec3_make(0, 0, 0), vec3_make(1, 1, 1), &last),
                                    roundabout_box(&random, vec3_make(0.1, 0.5, 0.1), vec3_make(0.9, 1, 0.9), &last)};
        const struct csg *csg = build(&arena, leaves, 2, two[1], 3);
        for (int i = 0; csg && i < 5000; i++) {
            struct vec3 above = random_vec3(&random, 3), at = random_vec3(&random, 0.39);
            struct ray ray = line_through(affine_point(&last.forward, vec3_make(above.x, 4, above.z)),
                                          affine_point(&last.forward, vec3_make(0.5 + at.x, 1, 0.5 + at.z)));
            struct crossing c;
            CHECK(csg_nearest(csg, &ray, &scratch, &c));
            CHECK_NEAR(c.t, 1, 1e-10);
            shown[c.leaf]++;
        }
    }
    CHECK_EQ_INT(shown[0], 20 * 5000);
    CHECK_EQ_INT(shown[1], 0);
    arena_destroy(&arena);
    geom_scratch_destroy(&scratch);
}

/* Two programs have crossings with every line at the same t in the same direction. Returns the number of crossings. */
static uint32_t check_same(const struct csg *a, const struct csg *b, struct test_random *random, int rays) {
    struct geom_scratch scratch_a, scratch_b;
    CHECK(geom_scratch_init(&scratch_a, 64) && geom_scratch_init(&scratch_b, 64));
    uint32_t crossings = 0, wrong = 0;
    for (int i = 0; a && b && i < rays; i++) {
        struct ray ray = line_through(random_vec3(random, 4), random_vec3(random, 1));
        struct crossing_list la = all_crossings(a, &ray, &scratch_a), lb = all_crossings(b, &ray, &scratch_b);
        crossings += la.count;
        wrong += la.count != lb.count;
        for (uint32_t k = 0; k < la.count && la.count == lb.count; k++) {
            const struct crossing *ca = &scratch_a.items[la.first + k], *cb = &scratch_b.items[lb.first + k];
            wrong += ca->t != cb->t || ca->enter != cb->enter || ca->flip != cb->flip;
        }
    }
    CHECK_EQ_INT(wrong, 0);
    geom_scratch_destroy(&scratch_a);
    geom_scratch_destroy(&scratch_b);
    return crossings;
}

/* The unit cube as a mesh; with `outward` false its faces are reversed. */
static struct mesh *mesh_cube(bool outward) {
    static const double vertices[8][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0},
                                          {0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {1, 1, 1}};
    static const uint32_t start[7] = {0, 4, 8, 12, 16, 20, 24};
    static const uint32_t corners[24] = {0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4, 2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5};
    uint32_t wound[24];
    for (uint32_t i = 0; i < 24; i++)
        wound[i] = corners[outward ? i : i / 4 * 4 + 3 - i % 4];
    struct mesh_input input = {.name = "cube",
                               .vertex_count = 8,
                               .face_count = 6,
                               .vertices = vertices,
                               .face_start = start,
                               .vertex_index = wound};
    return indexed_mesh(&input);
}

TEST(csg_takes_closed_meshes_like_boxes_with_either_winding) {
    struct test_random random = {16};
    struct geom_scratch scratch_a, scratch_b;
    CHECK(geom_scratch_init(&scratch_a, 1000) && geom_scratch_init(&scratch_b, 1000));
    struct mesh *meshes[2] = {mesh_cube(false), mesh_cube(true)};
    uint32_t wrong = 0, crossings = 0;
    for (int tree = 0; tree < 60; tree++) {
        struct arena arena = {0};
        struct csg_leaf leaves[6], with_meshes[6];
        struct csg_token program[12];
        uint32_t count = 1 + (uint32_t)tree % 6, length = random_program(&random, 0, count, 0, program);
        for (uint32_t i = 0; i < count; i++) {
            with_meshes[i] = leaves[i] = leaf_of(SHAPE_BOX, random_transform(&random, 0.7));
            if (i % 3 < 2)
                with_meshes[i].shape = (struct shape){.kind = SHAPE_MESH, .mesh = meshes[i % 3]};
        }
        const struct csg *a = build(&arena, leaves, count, program, length);
        const struct csg *b = build(&arena, with_meshes, count, program, length);
        for (int i = 0; a && b && i < 500; i++) {
            struct ray ray = line_through(random_vec3(&random, 4), random_vec3(&random, 1));
            struct crossing_list la = all_crossings(a, &ray, &scratch_a), lb = all_crossings(b, &ray, &scratch_b);
            check_list(b, &ray, &scratch_b, lb);
            crossings += lb.count;
            wrong += la.count != lb.count;
            for (uint32_t k = 0; k < la.count && la.count == lb.count; k++) {
                const struct crossing *ca = &scratch_a.items[la.first + k];
                struct crossing cb = scratch_b.items[lb.first + k];
                struct surface surface;
                csg_describe(b, &ray, &cb, &surface);
                wrong += fabs(ca->t - cb.t) > 1e-11 || ca->enter != cb.enter || ca->leaf != cb.leaf;
                wrong += cb.enter != (vec3_dot(surface.normal, ray.direction) < 0);
            }
        }
        arena_destroy(&arena);
    }
    CHECK_EQ_INT(wrong, 0);
    CHECK(crossings > 10000);
    mesh_release(meshes[0]);
    mesh_release(meshes[1]);
    geom_scratch_destroy(&scratch_a);
    geom_scratch_destroy(&scratch_b);
}

TEST(csg_obeys_de_morgan_and_distribution) {
    struct test_random random = {10};
#define U CSG_UNION
#define I CSG_INTERSECTION
#define D CSG_DIFFERENCE
#define L CSG_LEAF
    /* Leaves 0, 1, 2 are a, b, c; 3 is a once more. */
    const struct csg_token left[][5] = {
        {{L, 0}, {L, 1}, {L, 2}, {U, 0}, {D, 0}}, /* a - (b + c) */
        {{L, 0}, {L, 1}, {L, 2}, {I, 0}, {D, 0}}, /* a - b * c */
        {{L, 0}, {L, 1}, {L, 2}, {D, 0}, {D, 0}}, /* a - (b - c) */
        {{L, 0}, {L, 1}, {L, 2}, {U, 0}, {I, 0}}, /* a * (b + c) */
        {{L, 0}, {L, 1}, {L, 2}, {I, 0}, {U, 0}}, /* a + b * c */
    };
    const struct csg_token right[][7] = {
        {{L, 0}, {L, 1}, {D, 0}, {L, 3}, {L, 2}, {D, 0}, {I, 0}}, /* (a - b) * (a - c) */
        {{L, 0}, {L, 1}, {D, 0}, {L, 3}, {L, 2}, {D, 0}, {U, 0}}, /* (a - b) + (a - c) */
        {{L, 0}, {L, 1}, {D, 0}, {L, 3}, {L, 2}, {I, 0}, {U, 0}}, /* (a - b) + a * c */
        {{L, 0}, {L, 1}, {I, 0}, {L, 3}, {L, 2}, {I, 0}, {U, 0}}, /* a * b + a * c */
        {{L, 0}, {L, 1}, {U, 0}, {L, 3}, {L, 2}, {U, 0}, {I, 0}}, /* (a + b) * (a + c) */
    };
#undef U
#undef I
#undef D
#undef L
    uint32_t crossings[5] = {0};
    for (int turn = 0; turn < 40; turn++) {
        struct arena arena = {0};
        struct csg_leaf leaves[4];
        for (int i = 0; i < 3; i++)
            leaves[i] = leaf_of((turn >> i) % 2 ? SHAPE_SPHERE : SHAPE_BOX, random_transform(&random, 0.4));
        leaves[3] = leaves[0];
        for (int law = 0; law < 5; law++) {
            const struct csg *a = build(&arena, leaves, 3, left[law], 5), *b = build(&arena, leaves, 4, right[law], 7);
            crossings[law] += check_same(a, b, &random, 500);
        }
        arena_destroy(&arena);
    }
    for (int law = 0; law < 5; law++)
        CHECK(crossings[law] > 5000);
}

TEST(csg_scaled_by_powers_of_two_gives_the_same_crossings) {
    struct test_random random = {11};
    struct geom_scratch scratch_a, scratch_b;
    CHECK(geom_scratch_init(&scratch_a, 64) && geom_scratch_init(&scratch_b, 64));
    const int exponents[] = {-400, -10, 20, 400};
    uint32_t crossings = 0, wrong = 0;
    for (int tree = 0; tree < 40; tree++) {
        struct arena arena = {0};
        struct csg_leaf leaves[8], scaled[8];
        struct csg_token program[16];
        uint32_t count = 2 + (uint32_t)tree % 7, length = random_program(&random, 0, count, 0, program);
        for (uint32_t i = 0; i < count; i++)
            leaves[i] = leaf_of(i % 2 ? SHAPE_SPHERE : SHAPE_BOX, random_transform(&random, 1));
        leaves[count - 1] = leaves[0]; /* coincident faces as well */
        const struct csg *csg = build(&arena, leaves, count, program, length);
        for (int e = 0; e < 4; e++) {
            double s = ldexp(1, exponents[e]);
            for (uint32_t i = 0; i < count; i++) {
                scaled[i] = leaves[i];
                scaled[i].csg_from_leaf = then(leaves[i].csg_from_leaf, transform_scale(vec3_all(s)));
            }
            const struct csg *big = build(&arena, scaled, count, program, length);
            for (int i = 0; csg && big && i < 500; i++) {
                struct ray ray = line_through(random_vec3(&random, 4), random_vec3(&random, 1)), big_ray = ray;
                big_ray.origin = vec3_scale(ray.origin, s);
                big_ray.direction = vec3_scale(ray.direction, s);
                struct crossing_list la = all_crossings(csg, &ray, &scratch_a);
                struct crossing_list lb = all_crossings(big, &big_ray, &scratch_b);
                wrong += la.count != lb.count;
                crossings += la.count;
                for (uint32_t k = 0; k < la.count && la.count == lb.count; k++) {
                    struct crossing *a = &scratch_a.items[la.first + k], *b = &scratch_b.items[lb.first + k];
                    wrong += a->t != b->t || a->leaf != b->leaf || a->part != b->part || a->flip != b->flip;
                    struct surface sa, sb;
                    csg_describe(csg, &ray, a, &sa);
                    csg_describe(big, &big_ray, b, &sb);
                    wrong += sa.point.x * s != sb.point.x || sa.normal.y != sb.normal.y * s || sa.error * s != sb.error;
                }
            }
        }
        arena_destroy(&arena);
    }
    CHECK_EQ_INT(wrong, 0);
    CHECK(crossings > 10000);
    geom_scratch_destroy(&scratch_a);
    geom_scratch_destroy(&scratch_b);
}

TEST(csg_programs_of_ten_thousand_operands_work_however_deep) {
    enum { MANY = 10000 };
    struct test_random random = {12};
    struct geom_scratch scratch;
    CHECK(geom_scratch_init(&scratch, 100000));
    struct csg_leaf *leaves = malloc(MANY * sizeof *leaves);
    struct csg_token *program = malloc(2 * MANY * sizeof *program);
    for (uint32_t i = 0; i < MANY; i++) {
        struct transform small = transform_scale(vec3_all(test_uniform(&random, 0.01, 0.06)));
        leaves[i] =
            leaf_of(i % 2 ? SHAPE_SPHERE : SHAPE_BOX, then(small, transform_translate(random_vec3(&random, 1))));
    }
    leaves[0] = leaf_of(SHAPE_BOX, then(transform_scale(vec3_all(2)), transform_translate(vec3_all(-1))));
    for (int kind = 0; kind < 5; kind++) {
        uint32_t length = 0;
        if (kind < 3) { /* left-deep: union, difference, all three by turns */
            program[length++] = (struct csg_token){CSG_LEAF, 0};
            for (uint32_t i = 1; i < MANY; i++) {
                enum csg_operation by_turns = i % 3 == 0 ? CSG_UNION : i % 3 == 1 ? CSG_DIFFERENCE : CSG_UNION;
                program[length++] = (struct csg_token){CSG_LEAF, (uint16_t)i};
                program[length++] = (struct csg_token){kind == 0   ? CSG_UNION
                                                       : kind == 1 ? CSG_DIFFERENCE
                                                                   : by_turns,
                                                       0};
            }
        } else { /* right-deep: a - (b - (c - ...)), and by turns */
            for (uint32_t i = 0; i < MANY; i++)
                program[length++] = (struct csg_token){CSG_LEAF, (uint16_t)i};
            for (uint32_t i = 1; i < MANY; i++)
                program[length++] = (struct csg_token){kind == 3 || i % 2 ? CSG_DIFFERENCE : CSG_UNION, 0};
        }
        struct arena arena = {0};
        const struct csg *csg = build(&arena, leaves, MANY, program, length);
        struct tally tally = {0};
        for (int i = 0; csg && i < 100; i++) {
            struct vec3 origin = random_vec3(&random, 3);
            struct ray ray = line_through(origin, random_vec3(&random, 1));
            struct crossing_list list = all_crossings(csg, &ray, &scratch);
            check_list(csg, &ray, &scratch, list);
            check_segments(csg, &ray, &scratch, list, &tally);
        }
        CHECK_EQ_INT(tally.wrong, 0);
        CHECK_EQ_INT(tally.inward, 0);
        CHECK(tally.insides >= 100);
        arena_destroy(&arena);
    }
    free(program);
    free(leaves);
    geom_scratch_destroy(&scratch);
}

TEST(csg_needs_no_more_scratch_than_it_says_and_grows_into_it) {
    enum { COUNT = 40 };
    struct test_random random = {13};
    struct arena arena = {0};
    struct csg_leaf leaves[COUNT];
    struct csg_token program[2 * COUNT];
    uint32_t length = 0;
    for (uint32_t i = 0; i < COUNT; i++) { /* shells inside each other: a line through the middle crosses all */
        leaves[i] = leaf_of(SHAPE_SPHERE, transform_scale(vec3_all(COUNT - i)));
        program[length++] = (struct csg_token){CSG_LEAF, (uint16_t)i};
    }
    for (uint32_t i = 1; i < COUNT; i++)
        program[length++] = (struct csg_token){CSG_DIFFERENCE, 0};
    const struct csg *csg = build(&arena, leaves, COUNT, program, length);
    struct geom_scratch large, small;
    CHECK(geom_scratch_init(&large, csg->max_crossings) && geom_scratch_init(&small, 16));
    for (int i = 0; i < 1000; i++) {
        struct ray ray = line_through(random_vec3(&random, 100), random_vec3(&random, 0.1));
        struct crossing_list list = all_crossings(csg, &ray, &large), again = all_crossings(csg, &ray, &small);
        CHECK_EQ_INT(list.count, 2 * COUNT);
        CHECK_EQ_INT(again.count, 2 * COUNT);
        CHECK(large.capacity == csg->max_crossings && small.capacity > 2 * COUNT);
    }
    /* If the scratch is too small, every query reports it and leaves the scratch unchanged. */
    struct ray ray = line_through(vec3_make(100, 1, 2), vec3_all(0));
    struct crossing c;
    small.used = small.capacity - 3;
    for (int question = 0; question < 3; question++) {
        small.overflow = false;
        CHECK(question != 0 || !csg_nearest(csg, &ray, &small, &c));
        CHECK(question != 1 || !csg_any(csg, &ray, &small));
        small.used += question == 2 ? 3 : 0;
        CHECK(question != 2 || !csg_contains(csg, vec3_all(0), &small));
        CHECK(small.overflow && small.used == small.capacity - (question == 2 ? 0 : 3));
    }
    geom_scratch_destroy(&large);
    geom_scratch_destroy(&small);
    arena_destroy(&arena);
}

TEST(csg_surfaces_keep_the_operand_that_made_them) {
    struct arena arena = {0};
    struct geom_scratch scratch;
    CHECK(geom_scratch_init(&scratch, 64));
    /* A cube of edge 2 about the origin less a sphere of radius 1/2 about the middle of its +z face. */
    struct csg_leaf leaves[] = {
        leaf_of(SHAPE_BOX, then(transform_scale(vec3_all(2)), transform_translate(vec3_all(-1)))),
        leaf_of(SHAPE_SPHERE, then(transform_scale(vec3_all(0.5)), transform_translate(vec3_make(0, 0, 1))))};
    const struct csg *csg = build(&arena, leaves, 2, two[0], 3);
    struct ray ray = line_through(vec3_make(0, 0, 5), vec3_make(0, 0, 4));
    ray.t_min = 0;
    struct crossing c;
    struct surface s;
    CHECK(csg_nearest(csg, &ray, &scratch, &c));
    CHECK(c.t == 4.5 && c.leaf == 1 && c.enter && c.flip);
    csg_describe(csg, &ray, &c, &s);
    CHECK_EQ_INT(s.leaf, 1);
    CHECK_NEAR(s.point.z, 0.5, 1e-15);
    CHECK(s.normal.z > 0 && s.shading_normal.z > 0 && s.normal.x == 0);
    CHECK(s.pattern_normal.z == -1 && s.pattern_point.z == -1 && s.pattern_point.x == 0);
    CHECK(s.error > 0 && s.error < 1e-13);
    ray = line_through(vec3_make(0.75, 0, 5), vec3_make(0.75, 0, 4));
    CHECK(csg_nearest(csg, &ray, &scratch, &c));
    CHECK(c.t == 4 && c.leaf == 0 && c.enter && !c.flip);
    CHECK(csg_contains(csg, vec3_make(0, 0, 0), &scratch) && !csg_contains(csg, vec3_make(0, 0, 0.75), &scratch));
    arena_destroy(&arena);
    geom_scratch_destroy(&scratch);
}

TEST(csg_bounds_follow_the_operations) {
    struct arena arena = {0};
    struct csg_leaf leaves[] = {leaf_of(SHAPE_BOX, transform_identity()),
                                leaf_of(SHAPE_BOX, transform_translate(vec3_make(0.5, 0, 0)))};
    const enum csg_operation operations[] = {CSG_UNION, CSG_INTERSECTION, CSG_DIFFERENCE};
    const double min_x[] = {0, 0.5, 0}, max_x[] = {1.5, 1, 1};
    for (int i = 0; i < 3; i++) {
        const struct csg_token program[] = {{CSG_LEAF, 0}, {CSG_LEAF, 1}, {operations[i], 0}};
        const struct csg *csg = build(&arena, leaves, 2, program, 3);
        CHECK_NEAR(csg->bounds.min.x, min_x[i], 1e-12);
        CHECK_NEAR(csg->bounds.max.x, max_x[i], 1e-12);
        CHECK(csg->bounds.min.x <= min_x[i] && csg->bounds.max.x >= max_x[i]);
    }
    arena_destroy(&arena);
}

TEST(csg_of_malformed_programs_is_refused) {
    struct arena arena = {0};
    struct error error;
    struct csg_leaf leaves[] = {leaf_of(SHAPE_BOX, transform_identity()), leaf_of(SHAPE_SPHERE, transform_identity())};
    const struct csg_token programs[][3] = {
        {{CSG_LEAF, 0}, {CSG_UNION, 0}, {CSG_LEAF, 1}}, /* operation without operands */
        {{CSG_LEAF, 0}, {CSG_LEAF, 0}, {CSG_UNION, 0}}, /* a leaf used twice */
        {{CSG_LEAF, 0}, {CSG_LEAF, 2}, {CSG_UNION, 0}}, /* a leaf that does not exist */
        {{CSG_LEAF, 0}, {CSG_LEAF, 1}, {CSG_LEAF, 1}},  /* unused operands */
    };
    for (size_t i = 0; i < sizeof programs / sizeof programs[0]; i++)
        CHECK(!csg_build(&arena, leaves, 2, programs[i], 3, &error) && error.kind == ERROR_SCENE);
    CHECK(!csg_build(&arena, leaves, 0, programs[0], 0, &error));
    CHECK(!csg_build(&arena, leaves, 2, programs[0], 1, &error));
    arena_destroy(&arena);
}

TEST(csg_build_survives_every_failing_allocation) {
    struct csg_leaf leaves[] = {leaf_of(SHAPE_BOX, transform_identity()), leaf_of(SHAPE_SPHERE, transform_identity())};
    for (uint64_t k = 1;; k++) { /* fails only in builds with fault injection */
        struct arena arena = {0};
        struct error error = {0};
        mem_fail_at(k);
        const struct csg *csg = csg_build(&arena, leaves, 2, two[0], 3, &error);
        mem_fail_at(0);
        CHECK(csg || error.kind == ERROR_MACHINE);
        arena_destroy(&arena);
        if (csg)
            break;
    }
}
