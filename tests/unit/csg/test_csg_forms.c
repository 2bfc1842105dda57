/* Solids of every closed shape against point-by-point evaluation; inverses, clips, bounds and divided unions against
 * their definitions. */
#include "csg/csg_build.h"
#include "csg/csg_split.h"
#include "shape/planar.h"
#include "tests/unit/shape_makers.h"
#include "tests/unit/swept_makers.h"

enum { MAX = 10 };

/* ---- makers ---- */

static struct shape ball_or_box(uint32_t which) {
    if (which % 2 == 0)
        return (struct shape){.kind = SHAPE_SPHERE, .sphere = {{0, 0, 0}, 1}};
    return (struct shape){.kind = SHAPE_BOX, .box = {{-0.6, -0.8, -1}, {1, 0.6, 0.8}}};
}

static struct transform small_transform(struct test_random *random) {
    double x = exp(test_uniform(random, -0.5, 0.5)), y = exp(test_uniform(random, -0.5, 0.5));
    double z = exp(test_uniform(random, -0.5, 0.5)) * (test_uniform(random, 0, 1) < 0.3 ? -1 : 1);
    struct transform t = transform_scale(vec3_make(x, y, z));
    for (int axis = 0; axis < 3; axis++) {
        struct transform turn = transform_rotate(axis, test_uniform(random, 0, 360));
        t = transform_compose(&turn, &t);
    }
    struct transform move = transform_translate(random_vec3(random, 0.6));
    return transform_compose(&move, &t);
}

static struct csg_leaf random_leaf(struct test_random *random, struct shape_makers *makers) {
    struct csg_leaf leaf = {.csg_from_leaf = small_transform(random)};
    leaf.shape = make_solid(makers, random);
    return leaf;
}

static struct shape random_open(struct shape_makers *makers, struct test_random *random) {
    for (;;) {
        struct shape shape =
            make_shape(makers, (enum shape_kind)(int)test_uniform(random, 0, SHAPE_KIND_COUNT), random).shape;
        if (!shape_is_closed(&shape))
            return shape;
    }
}

static const struct csg *build(struct arena *arena, const struct csg_leaf *leaves, uint32_t count,
                               const struct csg_token *program, uint32_t length) {
    struct error error = {0};
    const struct csg *csg = csg_build(arena, leaves, count, program, length, &error);
    if (!csg)
        test_fail(__FILE__, __LINE__, "csg_build: %s", error.text);
    return csg;
}

static struct crossing_list crossings_of(const struct csg *csg, const struct ray *ray, struct geom_scratch *scratch) {
    struct crossing_list list;
    scratch->used = 0;
    while (!csg_crossings(csg, ray, scratch, &list) && scratch->overflow)
        CHECK(geom_scratch_grow(scratch));
    return list;
}

static struct ray random_line(struct test_random *random) {
    struct vec3 origin = random_vec3(random, test_uniform(random, 0, 1) < 0.3 ? 1 : 4);
    return ray_from(origin, vec3_sub(random_vec3(random, 1), origin));
}

/* ---- every shape ---- */

/* No shape is flatter than this where a ray touches it; thinner segments are not tested. */
#define THIN 1e-5

struct counts {
    uint64_t segments, insides, wrong, disorder, inward, endless;
};

static void check_line(const struct csg *csg, const struct ray *ray, struct geom_scratch *scratch,
                       struct counts *tally) {
    struct crossing_list list = crossings_of(csg, ray, scratch);
    tally->disorder += list.count % 2;
    for (uint32_t k = 0; k <= list.count; k++) {
        const struct crossing *c = &scratch->items[list.first];
        double from = k ? c[k - 1].t : -INFINITY, to = k < list.count ? c[k].t : INFINITY;
        tally->endless += k == 0 && to == -INFINITY;
        if ((k < list.count && to == -INFINITY) || (k && from == INFINITY))
            continue;
        tally->disorder += k < list.count && (c[k].enter != (k % 2 == 0) || !(from < to));
        double middle = isfinite(from) && isfinite(to) ? from / 2 + to / 2
                        : isfinite(from)               ? from + 1
                        : isfinite(to)                 ? to - 1
                                                       : 0;
        bool inside = k % 2 == 1;
        uint32_t used = scratch->used;
        tally->segments++;
        tally->insides += inside;
        if (to - from > THIN && csg_contains(csg, ray_at(ray, middle), scratch) != inside)
            tally->wrong++;
        scratch->used = used;
        if (k == list.count || !isfinite(to))
            continue;
        struct surface surface;
        struct crossing copy = scratch->items[list.first + k];
        csg_describe(csg, ray, &copy, &surface);
        double cosine = vec3_dot(vec3_normalize(surface.normal), vec3_normalize(ray->direction));
        tally->inward += fabs(cosine) > 1e-5 && copy.enter != (cosine < 0);
    }
    /* The nearest hit after a random t is the first of the list after it. */
    struct ray part = *ray;
    part.t_min = 0.3;
    struct crossing nearest, expected = {.t = INFINITY};
    for (uint32_t k = list.count; k-- > 0;)
        if (scratch->items[list.first + k].t > part.t_min)
            expected = scratch->items[list.first + k];
    scratch->used = list.first + list.count;
    bool found = csg_nearest(csg, &part, scratch, &nearest);
    while (scratch->overflow && geom_scratch_grow(scratch))
        found = csg_nearest(csg, &part, scratch, &nearest);
    tally->disorder +=
        found != isfinite(expected.t) || (found && (nearest.t != expected.t || nearest.leaf != expected.leaf));
}

static struct counts check_trees(uint64_t seed, int trees, int rays) {
    struct test_random random = {seed};
    struct geom_scratch scratch;
    struct shape_makers makers = {0};
    struct counts tally = {0};
    CHECK(geom_scratch_init(&scratch, 4000));
    for (int tree = 0; tree < trees; tree++) {
        struct arena arena = {0};
        struct csg_leaf leaves[MAX];
        struct csg_token program[4 * MAX];
        uint32_t count = 1 + (uint32_t)test_uniform(&random, 0, MAX - 0.001);
        for (uint32_t i = 0; i < count; i++)
            leaves[i] = random_leaf(&random, &makers);
        const struct csg *csg = build(&arena, leaves, count, program, random_program(&random, 0, count, 0.12, program));
        for (int i = 0; csg && i < rays; i++) {
            struct ray ray = random_line(&random);
            uint64_t before = tally.wrong + tally.disorder + tally.inward;
            check_line(csg, &ray, &scratch, &tally);
            if (tally.wrong + tally.disorder + tally.inward > before && before < 10)
                fprintf(stderr, "tree %d of %u operands, ray %d\n", tree, count, i);
        }
        arena_destroy(&arena);
    }
    shape_makers_destroy(&makers);
    geom_scratch_destroy(&scratch);
    return tally;
}

TEST(csg_of_every_closed_shape_equals_point_by_point_evaluation) {
    struct counts tally = check_trees(1, 200, 80);
    CHECK_EQ_INT(tally.wrong, 0);
    CHECK_EQ_INT(tally.disorder, 0);
    CHECK_EQ_INT(tally.inward, 0);
    CHECK(tally.insides > 5000 && tally.endless > 500);
}

TEST_LONG(csg_of_every_closed_shape_equals_point_by_point_evaluation_on_ten_million_rays) {
    struct counts tally = check_trees(2, 20000, 500);
    CHECK_EQ_INT(tally.wrong, 0);
    CHECK_EQ_INT(tally.disorder, 0);
    CHECK_EQ_INT(tally.inward, 0);
    CHECK(tally.insides > 3000000);
}

/* ---- inverses ---- */

/* Two programs have crossings with every line at the same t, of the same operands, in the same direction. */
static uint32_t check_same(const struct csg *a, const struct csg *b, struct test_random *random, int rays) {
    struct geom_scratch of_a, of_b;
    CHECK(geom_scratch_init(&of_a, 64) && geom_scratch_init(&of_b, 64));
    uint32_t crossings = 0, wrong = 0;
    for (int i = 0; a && b && i < rays; i++) {
        struct ray ray = random_line(random);
        struct crossing_list la = crossings_of(a, &ray, &of_a), lb = crossings_of(b, &ray, &of_b);
        crossings += la.count;
        wrong += la.count != lb.count;
        for (uint32_t k = 0; k < la.count && la.count == lb.count; k++) {
            const struct crossing *ca = &of_a.items[la.first + k], *cb = &of_b.items[lb.first + k];
            wrong += ca->t != cb->t || ca->enter != cb->enter;
            wrong += isfinite(ca->t) && (ca->flip != cb->flip || ca->leaf != cb->leaf || ca->part != cb->part);
        }
        struct crossing na, nb;
        bool fa = csg_nearest(a, &ray, &of_a, &na), fb = csg_nearest(b, &ray, &of_b, &nb);
        wrong += fa != fb || (fa && na.t != nb.t);
    }
    CHECK_EQ_INT(wrong, 0);
    geom_scratch_destroy(&of_a);
    geom_scratch_destroy(&of_b);
    return crossings;
}

TEST(csg_inverses_obey_de_morgan) {
    const enum csg_operation U = CSG_UNION, I = CSG_INTERSECTION, D = CSG_DIFFERENCE, L = CSG_LEAF, N = CSG_INVERSE;
    const struct csg_token left[][8] = {
        {{L, 0}, {L, 1}, {U, 0}, {N, 0}},         /* not (a + b) */
        {{L, 0}, {L, 1}, {I, 0}, {N, 0}},         /* not (a * b) */
        {{L, 0}, {L, 1}, {D, 0}},                 /* a - b */
        {{L, 0}, {N, 0}, {N, 0}, {L, 1}, {U, 0}}, /* not not a + b */
        {{L, 0}, {N, 0}, {L, 1}, {N, 0}, {D, 0}}, /* not a - not b */
    };
    const struct csg_token right[][8] = {
        {{L, 0}, {N, 0}, {L, 1}, {N, 0}, {I, 0}}, /* not a * not b */
        {{L, 0}, {N, 0}, {L, 1}, {N, 0}, {U, 0}}, /* not a + not b */
        {{L, 0}, {N, 0}, {L, 1}, {U, 0}, {N, 0}}, /* not (not a + b) */
        {{L, 0}, {L, 1}, {U, 0}},                 /* a + b */
        {{L, 1}, {L, 0}, {D, 0}},                 /* b - a */
    };
    static const uint32_t lengths[][2] = {{4, 5}, {4, 5}, {3, 5}, {5, 3}, {5, 3}};
    struct test_random random = {3};
    struct shape_makers makers = {0};
    uint32_t crossings[5] = {0};
    for (int turn = 0; turn < 60; turn++) {
        struct arena arena = {0};
        struct csg_leaf leaves[2] = {random_leaf(&random, &makers), random_leaf(&random, &makers)};
        for (int law = 0; law < 5; law++) {
            const struct csg *a = build(&arena, leaves, 2, left[law], lengths[law][0]);
            const struct csg *b = build(&arena, leaves, 2, right[law], lengths[law][1]);
            crossings[law] += check_same(a, b, &random, 50);
        }
        arena_destroy(&arena);
    }
    for (int law = 0; law < 5; law++)
        CHECK(crossings[law] > 500);
    shape_makers_destroy(&makers);
}

TEST(csg_inverse_has_the_same_surface_turned_inside_out) {
    struct test_random random = {4};
    struct shape_makers makers = {0};
    struct geom_scratch scratch;
    CHECK(geom_scratch_init(&scratch, 2000));
    static const struct csg_token program[] = {{CSG_LEAF, 0}, {CSG_INVERSE, 0}};
    int crossings = 0;
    for (int turn = 0; turn < 200; turn++) {
        struct arena arena = {0};
        struct csg_leaf leaf = random_leaf(&random, &makers);
        const struct csg *own = build(&arena, &leaf, 1, program, 1), *inverse = build(&arena, &leaf, 1, program, 2);
        CHECK(inverse->inside_out && !own->inside_out);
        for (int i = 0; i < 100; i++) {
            struct ray ray = random_line(&random);
            ray.t_min = 0;
            struct crossing a, b;
            bool hit = csg_nearest(own, &ray, &scratch, &a), again = csg_nearest(inverse, &ray, &scratch, &b);
            CHECK(hit == again);
            if (!hit || !again)
                continue;
            struct surface sa, sb;
            csg_describe(own, &ray, &a, &sa);
            csg_describe(inverse, &ray, &b, &sb);
            CHECK(a.t == b.t && a.enter != b.enter && a.flip != b.flip);
            CHECK(sa.normal.x == -sb.normal.x && sa.normal.y == -sb.normal.y && sa.normal.z == -sb.normal.z);
            CHECK(sa.pattern_normal.x == sb.pattern_normal.x && sa.u == sb.u && sa.v == sb.v);
            crossings++;
        }
        arena_destroy(&arena);
    }
    CHECK(crossings > 5000);
    shape_makers_destroy(&makers);
    geom_scratch_destroy(&scratch);
}

/* ---- clips ---- */

/* The crossings of the clipped object are those of the object that are inside the clip. Those near the clip's surface
 * may be either. */
static void check_clipped(const struct csg *clipped, const struct csg *clip, const struct ray *ray,
                          const struct crossing *all, uint32_t count, struct geom_scratch *scratch, uint64_t *wrong,
                          uint64_t *shown) {
    struct crossing_list list = crossings_of(clipped, ray, scratch);
    struct crossing found[64];
    uint32_t found_count = list.count < 64 ? list.count : 64, at = 0;
    memcpy(found, &scratch->items[list.first], found_count * sizeof *found);
    for (uint32_t k = 0; k < count; k++) {
        if (!isfinite(all[k].t))
            continue;
        bool seen = at < found_count && found[at].t == all[k].t;
        struct crossing_list walls = crossings_of(clip, ray, scratch);
        double nearest = INFINITY;
        for (uint32_t i = 0; i < walls.count; i++)
            nearest = fmin(nearest, fabs(scratch->items[walls.first + i].t - all[k].t));
        scratch->used = 0;
        bool expected = csg_contains(clip, ray_at(ray, all[k].t), scratch);
        *wrong += nearest > THIN && seen != expected;
        *shown += seen;
        if (seen) {
            *wrong += found[at].enter != all[k].enter || found[at].flip != all[k].flip || found[at].part != all[k].part;
            at++;
        }
    }
    *wrong += at != found_count;
    struct ray part = *ray;
    part.t_min = 0;
    struct crossing nearest = {0}, expected = {.t = INFINITY};
    for (uint32_t k = found_count; k-- > 0;)
        if (found[k].t > 0)
            expected = found[k];
    scratch->used = 0;
    bool hit = csg_nearest(clipped, &part, scratch, &nearest);
    *wrong += hit != isfinite(expected.t) || (hit && nearest.t != expected.t);
}

TEST_TIMES(csg_clipped_solids_are_their_surface_inside_of_the_clip, 30) {
    struct test_random random = {5};
    struct geom_scratch scratch;
    struct shape_makers makers = {0};
    uint64_t wrong = 0, shown = 0;
    CHECK(geom_scratch_init(&scratch, 4000));
    for (int tree = 0; tree < 180 * times; tree++) {
        struct arena arena = {0};
        struct csg_leaf leaves[2 * MAX];
        struct csg_token program[8 * MAX], own[8 * MAX];
        struct error error = {0};
        uint32_t count = 1 + (uint32_t)test_uniform(&random, 0, 3.999);
        uint32_t behind = 1 + (uint32_t)test_uniform(&random, 0, 2.999);
        for (uint32_t i = 0; i < count + behind; i++)
            leaves[i] = random_leaf(&random, &makers);
        uint32_t length = random_program(&random, 0, count, 0.12, program);
        uint32_t more = random_program(&random, count, behind, 0.12, &program[length]);
        for (uint32_t i = 0; i < more; i++) {
            own[i] = program[length + i];
            own[i].leaf = (uint16_t)(own[i].operation == CSG_LEAF ? own[i].leaf - count : 0);
        }
        const struct csg *object = build(&arena, leaves, count, program, length);
        const struct csg *clip = build(&arena, leaves + count, behind, own, more);
        const struct csg *clipped = csg_build_clipped(
            &arena, &(struct csg_program){leaves, count + behind, program, length + more}, length, &error);
        CHECK(clipped && clipped->clipped && !clipped->open);
        for (int i = 0; clipped && i < 100; i++) {
            struct ray ray = random_line(&random);
            struct crossing_list list = crossings_of(object, &ray, &scratch);
            struct crossing all[64];
            uint32_t n = list.count < 64 ? list.count : 64;
            memcpy(all, &scratch.items[list.first], n * sizeof *all);
            check_clipped(clipped, clip, &ray, all, n, &scratch, &wrong, &shown);
        }
        arena_destroy(&arena);
    }
    CHECK_EQ_INT(wrong, 0);
    CHECK(shown > 2000 * (uint64_t)times);
    shape_makers_destroy(&makers);
    geom_scratch_destroy(&scratch);
}

TEST(csg_clipped_open_shapes_are_their_surface_inside_of_the_clip) {
    struct test_random random = {6};
    struct geom_scratch scratch;
    struct shape_makers makers = {0};
    uint64_t wrong = 0, shown = 0;
    CHECK(geom_scratch_init(&scratch, 4000));
    const struct csg_token program[] = {{CSG_LEAF, 0}, {CSG_LEAF, 1}, {CSG_INVERSE, 0}};
    for (int turn = 0; turn < 400; turn++) {
        struct arena arena = {0};
        struct error error = {0};
        struct csg_leaf leaves[2] = {
            {.shape = random_open(&makers, &random), .csg_from_leaf = small_transform(&random)},
            {.shape = ball_or_box((uint32_t)turn), .csg_from_leaf = small_transform(&random)}};
        uint32_t length = turn % 3 ? 2 : 3;
        const struct csg *clipped =
            csg_build_clipped(&arena, &(struct csg_program){leaves, 2, program, length}, 1, &error);
        const struct csg_token own[] = {{CSG_LEAF, 0}, {CSG_INVERSE, 0}};
        const struct csg *clip = build(&arena, leaves + 1, 1, own, length - 1);
        CHECK(clipped && clipped->open);
        for (int i = 0; clipped && i < 100; i++) {
            struct ray ray = random_line(&random), leaf_ray = ray_transform(&leaves[0].csg_from_leaf.inverse, &ray);
            struct crossing_list list;
            scratch.used = 0;
            CHECK(shape_crossings(&leaves[0].shape, &leaf_ray, &scratch, &list));
            struct crossing all[8];
            memcpy(all, &scratch.items[list.first], list.count * sizeof *all);
            check_clipped(clipped, clip, &ray, all, list.count, &scratch, &wrong, &shown);
        }
        arena_destroy(&arena);
    }
    CHECK_EQ_INT(wrong, 0);
    CHECK(shown > 3000);
    shape_makers_destroy(&makers);
    geom_scratch_destroy(&scratch);
}

/* ---- coincident faces ---- */

/* The unit cube through several transforms, so that it has rounding errors of its own. */
static struct csg_leaf roundabout_box(struct test_random *random, struct vec3 min, struct vec3 max,
                                      const struct transform *last) {
    double angle = test_uniform(random, -180, 180), factor = exp(test_uniform(random, -1, 1));
    struct vec3 by = random_vec3(random, 3), size = vec3_sub(max, min);
    const struct transform steps[] = {transform_translate(by),
                                      transform_scale(vec3_all(factor)),
                                      transform_rotate(1, angle),
                                      transform_rotate(1, -angle),
                                      transform_scale(vec3_all(1 / factor)),
                                      transform_translate(vec3_negate(by)),
                                      transform_scale(size),
                                      transform_translate(min),
                                      *last};
    struct csg_leaf leaf = {.shape = {.kind = SHAPE_BOX, .box = {{0, 0, 0}, {1, 1, 1}}},
                            .csg_from_leaf = transform_identity()};
    for (size_t i = 0; i < sizeof steps / sizeof steps[0]; i++)
        leaf.csg_from_leaf = transform_compose(&steps[i], &leaf.csg_from_leaf);
    return leaf;
}

TEST(a_cube_cut_by_a_cube_with_a_common_face_leaves_no_speckle_on_a_million_rays) {
    struct test_random random = {7};
    struct geom_scratch scratch;
    CHECK(geom_scratch_init(&scratch, 64));
    const struct csg_token program[] = {{CSG_LEAF, 0}, {CSG_LEAF, 1}, {CSG_DIFFERENCE, 0}};
    uint64_t speckles = 0, floors = 0;
    for (int turn = 0; turn < 100; turn++) {
        struct arena arena = {0};
        struct transform last = small_transform(&random);
        /* The cutter reaches from half height exactly to the top. */
        struct csg_leaf leaves[2] = {
            roundabout_box(&random, vec3_make(0, 0, 0), vec3_make(1, 1, 1), &last),
            roundabout_box(&random, vec3_make(0.25, 0.5, 0.25), vec3_make(0.75, 1, 0.75), &last)};
        const struct csg *csg = build(&arena, leaves, 2, program, 3);
        for (int i = 0; csg && i < 10000; i++) {
            /* From above through the hole in the top: the hit must be the floor or a wall of the hole. */
            double x = test_uniform(&random, 0.2501, 0.7499), z = test_uniform(&random, 0.2501, 0.7499);
            struct vec3 from = random_vec3(&random, 2), hole = {x, 1, z};
            from.y = test_uniform(&random, 2, 4);
            struct ray ray = ray_from(affine_point(&last.forward, from), vec3_make(0, 0, 0));
            ray.direction = vec3_sub(affine_point(&last.forward, hole), ray.origin);
            struct crossing c;
            struct surface s;
            if (!csg_nearest(csg, &ray, &scratch, &c)) {
                speckles++;
                continue;
            }
            csg_describe(csg, &ray, &c, &s);
            double height = affine_point(&last.inverse, s.point).y;
            speckles += c.leaf != 1 || height > 1 - 1e-6;
            floors += height < 0.5 + 1e-9;
        }
        arena_destroy(&arena);
    }
    CHECK_EQ_INT(speckles, 0);
    CHECK(floors > 200000);
    geom_scratch_destroy(&scratch);
}

TEST(a_face_in_the_surface_of_the_clip_is_shown_whole) {
    struct test_random random = {8};
    struct geom_scratch scratch;
    CHECK(geom_scratch_init(&scratch, 64));
    /* First the clip stands on the cube, then it lies in its upper half: both show the top. */
    const struct csg_token program[] = {{CSG_LEAF, 0}, {CSG_LEAF, 1}};
    for (int turn = 0; turn < 40; turn++) {
        struct arena arena = {0};
        struct error error = {0};
        struct transform last = small_transform(&random);
        double low = turn % 2 ? 1 : 0.5;
        struct csg_leaf leaves[2] = {
            roundabout_box(&random, vec3_make(0, 0, 0), vec3_make(1, 1, 1), &last),
            roundabout_box(&random, vec3_make(-1, low, -1), vec3_make(2, low + 0.5, 2), &last)};
        const struct csg *csg = csg_build_clipped(&arena, &(struct csg_program){leaves, 2, program, 2}, 1, &error);
        for (int i = 0; csg && i < 2500; i++) {
            struct vec3 from = random_vec3(&random, 2),
                        top = {test_uniform(&random, 0.001, 0.999), 1, test_uniform(&random, 0.001, 0.999)};
            from.y = 4;
            struct ray ray = ray_from(affine_point(&last.forward, from), vec3_make(0, 0, 0));
            ray.direction = vec3_sub(affine_point(&last.forward, top), ray.origin);
            struct crossing c;
            CHECK(csg_nearest(csg, &ray, &scratch, &c));
            CHECK_NEAR(c.t, 1, 1e-9);
            CHECK_EQ_INT(c.leaf, 0);
        }
        arena_destroy(&arena);
    }
    geom_scratch_destroy(&scratch);
}

/* ---- boxes and parts ---- */

/* The bounds are tight: no part of the surface is outside, and the part that an axis-aligned box cuts off an end is not
 * counted. */
TEST(csg_bounds_are_intersected_and_subtracted) {
    struct arena arena = {0};
    struct csg_leaf leaves[3] = {
        {.shape = {.kind = SHAPE_BOX, .box = {{0, 0, 0}, {1, 1, 1}}}, .csg_from_leaf = transform_identity()},
        {.shape = {.kind = SHAPE_BOX, .box = {{-1, 0.5, -1}, {2, 3, 2}}}, .csg_from_leaf = transform_identity()},
        {.shape = {.kind = SHAPE_PLANAR, .planar = planar_plane(vec3_make(1, 0, 0), 0.25)},
         .csg_from_leaf = transform_identity()}};
    const struct csg_token less[] = {
        {CSG_LEAF, 0}, {CSG_LEAF, 1}, {CSG_DIFFERENCE, 0}, {CSG_LEAF, 2}, {CSG_DIFFERENCE, 0}};
    const struct csg *csg = build(&arena, leaves, 3, less, 5);
    CHECK_NEAR(csg->bounds.max.y, 0.5, 1e-9);
    CHECK_NEAR(csg->bounds.min.x, 0.25, 1e-9);
    CHECK(csg->bounds.max.y >= 0.5 && csg->bounds.min.x <= 0.25 && csg->bounds.max.x >= 1 && csg->bounds.min.y <= 0);
    /* A solid between two infinite planes has no known bounds; the operand that cuts it has. */
    const struct csg_token inverse[] = {
        {CSG_LEAF, 0}, {CSG_INVERSE, 0}, {CSG_LEAF, 1}, {CSG_UNION, 0}, {CSG_INVERSE, 0}};
    csg = build(&arena, leaves, 2, inverse, 5);
    CHECK(!csg->inside_out);
    CHECK_NEAR(csg->bounds.max.y, 0.5, 1e-9);
    arena_destroy(&arena);
}

TEST(csg_asks_no_operand_whose_part_of_the_solid_the_ray_misses) {
    struct arena arena = {0};
    struct geom_scratch scratch;
    CHECK(geom_scratch_init(&scratch, 1000));
    /* A ball minus a plate through its middle that extends far beyond it. */
    struct csg_leaf leaves[2] = {
        {.shape = {.kind = SHAPE_SPHERE, .sphere = {{0, 0, 0}, 1}}, .csg_from_leaf = transform_identity()},
        {.shape = {.kind = SHAPE_BOX, .box = {{-9, -0.1, -9}, {9, 0.1, 9}}}, .csg_from_leaf = transform_identity()}};
    const struct csg_token less[] = {{CSG_LEAF, 0}, {CSG_LEAF, 1}, {CSG_DIFFERENCE, 0}};
    const struct csg *csg = build(&arena, leaves, 2, less, 3);
    struct crossing c;
    const struct ray at_ball = {.origin = {-5, 1.8, 0}, .direction = {5, -1, 0}, .t_max = INFINITY};
    const struct ray beside = {.origin = {5, 5, 0}, .direction = {0, -1, 0}, .t_max = INFINITY};
    CHECK(csg_nearest(csg, &at_ball, &scratch, &c) && c.leaf == 0);
    CHECK_EQ_INT(scratch.shape_tests, 1);
    CHECK(!csg_nearest(csg, &beside, &scratch, &c));
    CHECK_EQ_INT(scratch.shape_tests, 1);
    arena_destroy(&arena);
    geom_scratch_destroy(&scratch);
}

/* The nearest crossing of several solids; by t alone, since disjoint parts have no common crossings. */
static bool nearest_of(const struct csg *const *parts, uint32_t count, const struct ray *ray,
                       struct geom_scratch *scratch, struct crossing *out) {
    bool found = false;
    struct crossing c;
    for (uint32_t i = 0; i < count; i++)
        if (csg_nearest(parts[i], ray, scratch, &c) && (!found || c.t < out->t)) {
            *out = c;
            found = true;
        }
    return found;
}

TEST(csg_parts_answer_together_as_the_whole) {
    enum { MANY = 60 };
    struct test_random random = {9};
    struct geom_scratch scratch;
    CHECK(geom_scratch_init(&scratch, 2000));
    uint32_t split = 0, hits = 0, wrong = 0;
    for (int turn = 0; turn < 120; turn++) {
        struct arena arena = {0};
        struct error error = {0};
        struct csg_leaf leaves[MANY];
        struct csg_token program[2 * MANY];
        uint32_t count = 2 + (uint32_t)turn % (MANY - 1), length = 0;
        for (uint32_t i = 0; i < count; i++) {
            struct transform size = transform_scale(vec3_all(test_uniform(&random, 0.02, 0.25)));
            struct transform move = transform_translate(random_vec3(&random, 1));
            leaves[i] = (struct csg_leaf){.shape = ball_or_box(i)};
            leaves[i].csg_from_leaf = transform_compose(&move, &size);
            program[length++] = (struct csg_token){CSG_LEAF, (uint16_t)i};
            if (i > 0)
                program[length++] = (struct csg_token){i % 5 == 4 ? CSG_DIFFERENCE : CSG_UNION, 0};
        }
        const struct csg *whole = build(&arena, leaves, count, program, length);
        const struct csg **parts;
        uint32_t part_count;
        CHECK(csg_build_parts(&arena, &(struct csg_program){leaves, count, program, length}, &parts, &part_count,
                              &error));
        split += part_count > 1;
        for (int i = 0; i < 200; i++) {
            struct ray ray = random_line(&random);
            ray.t_min = 0;
            struct crossing a, b = {0};
            bool hit = csg_nearest(whole, &ray, &scratch, &a),
                 again = nearest_of(parts, part_count, &ray, &scratch, &b);
            hits += hit;
            wrong += hit != again || (hit && (a.t != b.t || a.enter != b.enter || a.flip != b.flip));
        }
        arena_destroy(&arena);
    }
    CHECK_EQ_INT(wrong, 0);
    CHECK(split > 15 && hits > 5000);
    geom_scratch_destroy(&scratch);
}

TEST(csg_of_a_hundred_solids_that_keep_apart_is_a_hundred_parts_and_touching_ones_are_one) {
    enum { SIDE = 10 };
    struct arena arena = {0};
    struct error error = {0};
    struct csg_leaf leaves[SIDE * SIDE];
    struct csg_token program[2 * SIDE * SIDE];
    for (int touching = 0; touching < 2; touching++) {
        uint32_t length = 0;
        for (uint32_t i = 0; i < SIDE * SIDE; i++) {
            struct transform move = transform_translate(vec3_make(i % SIDE, 0, i / SIDE));
            leaves[i] = (struct csg_leaf){.shape = {.kind = SHAPE_SPHERE, .sphere = {{0, 0, 0}, touching ? 0.5 : 0.4}},
                                          .csg_from_leaf = move};
            program[length++] = (struct csg_token){CSG_LEAF, (uint16_t)i};
            if (i > 0)
                program[length++] = (struct csg_token){CSG_UNION, 0};
        }
        const struct csg **parts;
        uint32_t count;
        CHECK(csg_build_parts(&arena, &(struct csg_program){leaves, SIDE * SIDE, program, length}, &parts, &count,
                              &error));
        CHECK_EQ_INT(count, touching ? 1 : SIDE * SIDE);
    }
    arena_destroy(&arena);
}
