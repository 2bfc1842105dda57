/* The index of triangles by itself: every instruction set, one voxel and many, any number of threads. */
#include "accel/triangle_layout_internal.h"
#include "base/isa.h"
#include "tests/unit/mesh_makers.h"

static struct triangle_index *build(const struct triangle_set *set, uint32_t voxels, struct pool *pool) {
    struct triangle_index *index = NULL;
    struct error error = {0};
    if (!triangle_index_build(&index, set, voxels, pool, &error)) {
        test_fail(__FILE__, __LINE__, "no index: %s", error.text);
        exit(1);
    }
    return index;
}

/* The nearest hit and any hit agree with a test of every triangle; true if there is one. */
static bool meets_the_same(const struct triangle_index *index, const struct triangle_set *set, const struct ray *ray,
                           struct triangle_cost *cost) {
    struct triangle_hit expected = {0}, hit = {0};
    bool found = triangle_brute_nearest(set, ray, &expected, cost);
    CHECK(triangle_index_nearest(index, set, ray, &hit, cost) == found);
    CHECK(triangle_index_any(index, set, ray, cost) == found);
    CHECK(!found || (hit.triangle == expected.triangle && hit.t == expected.t));
    return found;
}

struct tally {
    uint64_t once[64]; /* one bit per triangle that was met; the sets here are small */
    double sum;
};

static void count_hit(void *context, const struct triangle_hit *hit) {
    struct tally *tally = context;
    uint64_t bit = UINT64_C(1) << (hit->triangle & 63), *word = &tally->once[hit->triangle >> 6];
    if (!(*word & bit))
        tally->sum += hit->t * (1 + hit->triangle);
    *word |= bit;
}

static void check_searches(const struct maker *m, uint32_t voxels, int rays, struct test_random *random,
                           const char *what) {
    struct triangle_set set = set_of(m);
    struct triangle_index *index = build(&set, voxels, NULL);
    struct mesh *mesh = maker_mesh(m);
    struct triangle_cost cost = {0};
    for (int i = 0; i < rays; i++) {
        struct ray ray = test_any_ray(m, mesh, random);
        struct triangle_hit expected = {0}, hit = {0};
        bool found = triangle_brute_nearest(&set, &ray, &expected, &cost);
        bool same = triangle_index_nearest(index, &set, &ray, &hit, &cost) == found;
        if (found)
            same = same && hit.triangle == expected.triangle && memcmp(&hit.t, &expected.t, sizeof hit.t) == 0 &&
                   memcmp(&hit.u, &expected.u, sizeof hit.u) == 0 && memcmp(&hit.v, &expected.v, sizeof hit.v) == 0;
        same = same && triangle_index_any(index, &set, &ray, &cost) == found;
        struct tally all = {0}, every = {0};
        triangle_index_all(index, &set, &ray, count_hit, &all, &cost);
        triangle_brute_all(&set, &ray, count_hit, &every, &cost);
        same = same && memcmp(all.once, every.once, sizeof all.once) == 0;
        if (!same)
            test_fail(__FILE__, __LINE__,
                      "%s, %u voxels, instruction set %d: ray %d differs from trying every triangle", what, voxels,
                      (int)cpu_isa(), i);
    }
    mesh_release(mesh);
    triangle_index_destroy(index);
}

TEST_TIMES(every_instruction_set_and_number_of_voxels_answers_as_trying_every_triangle, 30) {
    static const char *const sets[] = {"base", "avx2", "avx512"};
    int tried = 0;
    for (int isa = 0; isa < 3; isa++) {
        if (!cpu_select_isa(sets[isa]))
            continue;
        tried++;
        struct test_random random = {11}; /* the same rays for each */
        for (int kind = 0; kind < SOUP_KINDS; kind++) {
            struct maker m = {0};
            maker_soup(&m, (enum soup)kind, 400, &random);
            const uint32_t voxels[] = {1, 30, 400, 4000};
            for (int k = 0; k < 4; k++)
                check_searches(&m, voxels[k], 150 * times, &random, "soup");
            maker_free(&m);
        }
        struct maker m = {0};
        maker_twisted_torus(&m, 40, 16, 1);
        check_searches(&m, 1, 300 * times, &random, "torus");
        check_searches(&m, 500, 300 * times, &random, "torus");
        maker_free(&m);
    }
    CHECK(cpu_select_isa("auto"));
    CHECK(!cpu_select_isa("avx3"));
    CHECK(tried >= 1);
}

TEST(rays_from_a_million_sizes_away_are_answered_as_by_trying_every_triangle) {
    struct test_random random = {12};
    struct maker m = {0};
    maker_sphere(&m, 8);
    struct triangle_set set = set_of(&m);
    struct triangle_index *index = build(&set, 0, NULL);
    struct triangle_cost cost = {0};
    int hits = 0;
    for (int i = 0; i < 20000; i++) {
        double distance = pow(10, test_uniform(&random, 3, 12));
        struct vec3 origin = vec3_scale(vec3_normalize(test_point(&random, 1)), distance);
        struct ray ray = test_ray(origin, vec3_sub(test_point(&random, 1), origin));
        hits += meets_the_same(index, &set, &ray, &cost);
    }
    CHECK(hits > 5000);
    triangle_index_destroy(index);
    maker_free(&m);
}

/* Unused lanes of blocks and the transform of rays into local space both depend on the distance of the origin. */
TEST(rays_from_a_few_sizes_away_meet_what_trying_every_triangle_meets_and_nothing_else) {
    struct test_random random = {14};
    struct maker m = {0};
    maker_sphere(&m, 5); /* blocks that are not full */
    struct triangle_set set = set_of(&m);
    struct triangle_index *index = build(&set, 0, NULL);
    struct triangle_cost cost = {0};
    int hits = 0;
    for (int i = 0; i < 20000; i++) {
        struct vec3 route = i & 1 ? test_point(&random, 1) : vec3_add(vec3_all(1), test_point(&random, 0.2));
        struct vec3 origin = vec3_scale(vec3_normalize(route), test_uniform(&random, 1, 30));
        /* At the mesh, or past places where an index may have put padding. */
        struct vec3 target = test_point(&random, 1);
        double far = pow(2, floor(test_uniform(&random, 1, 9)));
        if (i & 2)
            target =
                vec3_add(vec3_all(far), vec3_make(test_uniform(&random, 0, 0.1), test_uniform(&random, 0, 0.1), 0));
        struct ray ray = test_ray(origin, vec3_sub(target, origin));
        ray.direction = vec3_scale(ray.direction, pow(2, test_uniform(&random, -40, 40)));
        double across = vec3_length(origin) / vec3_length(ray.direction);
        if (i % 3 == 0)
            ray.t_max = across * test_uniform(&random, 0, 2);
        if (i % 7 == 0)
            ray.t_min = across * test_uniform(&random, -1, 1);
        hits += meets_the_same(index, &set, &ray, &cost);
    }
    CHECK(hits > 3000);
    triangle_index_destroy(index);
    maker_free(&m);
}

/* A small dense ball in a scene that is up to a million times as wide, away from its middle: there single precision
 * resolves positions hardly better than the size of the ball's triangles. Rays go at edges and corners, from near and
 * far and from the ball itself. */
TEST(rays_at_a_tiny_dense_ball_in_a_wide_scene_meet_what_trying_every_triangle_meets) {
    static const char *const sets[] = {"base", "avx2", "avx512"};
    int hits = 0;
    for (int isa = 0; isa < 3; isa++) {
        if (!cpu_select_isa(sets[isa]))
            continue;
        struct test_random random = {77};
        for (int size = 1; size <= 6; size++) {
            struct maker m = {0};
            maker_tiny_ball(&m, pow(10, -size));
            uint32_t ball = m.vertex_count - 3;
            struct vec3 middle = TINY_BALL_MIDDLE;
            struct triangle_set set = set_of(&m);
            struct triangle_index *index = build(&set, 0, NULL);
            struct triangle_cost cost = {0};
            for (int i = 0; i < 1500; i++) {
                const double *a = m.vertices[(uint32_t)test_uniform(&random, 0, ball)];
                const double *b = m.vertices[(uint32_t)test_uniform(&random, 0, ball)];
                double blend = i % 3 ? test_uniform(&random, 0, 1) : 0;
                struct vec3 target =
                    vec3_make(a[0] + blend * (b[0] - a[0]), a[1] + blend * (b[1] - a[1]), a[2] + blend * (b[2] - a[2]));
                double extent = pow(10, test_uniform(&random, -size - 1, 1));
                struct vec3 origin =
                    i % 5 ? vec3_add(middle, test_point(&random, extent)) : vec3_make(b[0], b[1], b[2]);
                struct ray ray = test_ray(origin, vec3_sub(target, origin));
                hits += meets_the_same(index, &set, &ray, &cost);
            }
            triangle_index_destroy(index);
            maker_free(&m);
        }
    }
    CHECK(cpu_select_isa("auto"));
    CHECK(hits > 3000);
}

/* Below some height, single precision cannot decide whether a ray leaves the floor it starts on; the floor is so large
 * that the tolerance of the triangle test is large, too. The sides are odd numbers, so that no coordinate of the floor
 * is exact; the same for a tilted floor. */
TEST(rays_that_start_close_above_or_below_a_huge_floor_meet_what_trying_every_triangle_meets) {
    static const char *const sets[] = {"base", "avx2", "avx512"};
    for (int isa = 0; isa < 3; isa++) {
        if (!cpu_select_isa(sets[isa]))
            continue;
        struct test_random random = {15};
        int hits = 0, rays = 0;
        for (int tilted = 0; tilted < 2; tilted++) {
            struct maker m = {0};
            maker_sphere(&m, 4);
            double slope = tilted ? 0.37 : 0;
            uint32_t first = m.vertex_count;
            for (int i = 0; i < 4; i++) {
                double x = i & 1 ? 310.7 : -290.3, z = i & 2 ? 301.9 : -330.1;
                maker_vertex(&m, x, slope * x - 1.1, z);
            }
            maker_triangle(&m, first, first + 1, first + 3);
            maker_triangle(&m, first, first + 3, first + 2);
            struct triangle_set set = set_of(&m);
            struct triangle_index *index = build(&set, 0, NULL);
            struct triangle_cost cost = {0};
            for (int i = 0; i < 4000; i++) {
                struct vec3 origin = vec3_scale(test_point(&random, 1), i & 1 ? 200 : 3);
                double height = pow(10, test_uniform(&random, -14, 0));
                origin.y = slope * origin.x - 1.1 + (i & 2 ? height : i & 4 ? -height : 0);
                struct ray ray = test_ray(origin, test_point(&random, 1));
                if (i % 5 == 0)
                    ray.direction = vec3_make(i % 3 == 0, i % 3 == 1, i % 3 == 2 ? -1 : 0);
                if (i % 7 == 0)
                    ray.t_max = test_uniform(&random, 0, 3);
                hits += meets_the_same(index, &set, &ray, &cost);
                rays++;
            }
            triangle_index_destroy(index);
            maker_free(&m);
        }
        CHECK(hits > rays / 6 && hits < rays * 5 / 6);
    }
    CHECK(cpu_select_isa("auto"));
}

TEST(rays_that_are_not_finite_or_have_no_direction_meet_nothing) {
    struct maker m = {0};
    maker_sphere(&m, 4);
    struct triangle_set set = set_of(&m);
    struct triangle_index *index = build(&set, 0, NULL);
    struct triangle_cost cost = {0};
    struct triangle_hit hit;
    const struct vec3 odd[] = {{0, 0, 0}, {NAN, 0, 1}, {INFINITY, 0, 0}, {1, -INFINITY, NAN}};
    for (int i = 0; i < 4; i++) {
        struct ray ray = test_ray(vec3_all(0), odd[i]);
        CHECK(!triangle_index_nearest(index, &set, &ray, &hit, &cost));
        CHECK(!triangle_index_any(index, &set, &ray, &cost));
        ray = test_ray(odd[i], vec3_make(0, 0, 1));
        CHECK(triangle_index_any(index, &set, &ray, &cost) == (i == 0));
    }
    triangle_index_destroy(index);
    maker_free(&m);
}

TEST(the_index_has_the_same_bytes_for_any_number_of_threads) {
    struct maker m = {0};
    maker_twisted_torus(&m, 200, 75, 2);
    struct test_random random = {13};
    maker_soup(&m, SOUP_MIXED_SIZES, 10000, &random);
    struct triangle_set set = set_of(&m);
    for (uint32_t voxels = 0; voxels <= 300; voxels += 300) {
        struct triangle_index *first = build(&set, voxels, NULL);
        const int threads[] = {1, 2, 7};
        for (int k = 0; k < 3; k++) {
            char warning[256];
            struct pool *pool = pool_create(threads[k], warning);
            struct triangle_index *other = build(&set, voxels, pool);
            CHECK(first->node_count == other->node_count && first->block_count == other->block_count &&
                  first->voxel_count == other->voxel_count && first->big == other->big && first->only == other->only);
            CHECK(memcmp(first->nodes, other->nodes, first->node_count * sizeof *first->nodes) == 0);
            CHECK(memcmp(first->blocks, other->blocks, first->block_count * sizeof *first->blocks) == 0);
            CHECK((first->voxels == NULL) == (voxels == 0));
            CHECK(voxels == 0 || memcmp(first->voxels, other->voxels, first->voxel_count * sizeof *first->voxels) == 0);
            triangle_index_destroy(other);
            pool_destroy(pool);
        }
        triangle_index_destroy(first);
    }
    maker_free(&m);
}

TEST(a_cancelled_build_leaves_nothing_behind) {
    struct maker m = {0};
    maker_sphere(&m, 60);
    struct triangle_set set = set_of(&m);
    char warning[256];
    struct pool *pool = pool_create(2, warning);
    struct error error = {0};
    struct triangle_index *index = NULL;
    pool_cancel(pool);
    CHECK(!triangle_index_build(&index, &set, 0, pool, &error));
    CHECK(error.kind == ERROR_CANCELLED && index == NULL);
    pool_destroy(pool);
    maker_free(&m);
}

TEST(products_that_cancel_are_compared_exactly) {
    CHECK(triangle_edge(3, 5, 6, 10) == 0);
    CHECK(triangle_edge(1 + 0x1p-52, 1, 1, 1 - 0x1p-53) > 0);
    /* (1 + e)(1 - e) - 1 = -e^2, lost by rounding */
    CHECK(triangle_edge(1 + 0x1p-30, 1, 1, 1 - 0x1p-30) == -0x1p-60);
    CHECK(triangle_edge(1, 1 + 0x1p-30, 1 - 0x1p-30, 1) == 0x1p-60);
    CHECK(triangle_edge(-1 - 0x1p-30, 1, -1, 1 - 0x1p-30) == -triangle_edge(-1, 1 - 0x1p-30, -1 - 0x1p-30, 1));
    CHECK(triangle_edge_tie(0, 1, 0, 2) == -triangle_edge_tie(0, 2, 0, 1));
    CHECK(triangle_edge_tie(1, 1, 2, 1) == -triangle_edge_tie(2, 1, 1, 1));
    CHECK(triangle_edge_tie(3, 3, 3, 3) == 0);
}
