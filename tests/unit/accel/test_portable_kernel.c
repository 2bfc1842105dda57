/* The triangle kernels as compiled for processors without SIMD. */
#define GRAY_NO_SIMD
#include "tests/unit/mesh_makers.h"

#include "accel/triangle_kernels_internal.h"

TRIANGLE_KERNELS(portable)
#define KERNEL(name) triangle_##name##_portable
#include "accel/triangle_kernel_internal.h"

struct sum {
    uint64_t triangles;
    double t;
};

static void add_up(void *context, const struct triangle_hit *hit) {
    struct sum *sum = context;
    sum->triangles += 1 + (uint64_t)hit->triangle * hit->triangle;
    sum->t += hit->t * (1 + hit->triangle);
}

/* One voxel lists a triangle once, so that hits can be added up. */
TEST_TIMES(searches_without_vectors_give_the_bits_of_trying_every_triangle, 30) {
    struct test_random random = {11};
    const char *names[SOUP_KINDS] = {"even", "slivers", "flat", "mixed sizes", "tiny in huge", "lattice", "line"};
    int hits = 0;
    for (int kind = 0; kind < SOUP_KINDS; kind++) {
        struct maker m = {0};
        maker_soup(&m, (enum soup)kind, 300, &random);
        struct triangle_set set = set_of(&m);
        struct mesh *mesh = maker_mesh(&m);
        struct triangle_index *index;
        struct error error;
        CHECK(triangle_index_build(&index, &set, 1, NULL, &error));
        for (int i = 0; i < 1000 * times; i++) {
            struct ray ray = test_any_ray(&m, mesh, &random);
            struct triangle_cost cost = {0};
            struct triangle_hit hit = {0}, expected = {0};
            struct sum sum = {0}, every = {0};
            bool found = triangle_brute_nearest(&set, &ray, &expected, &cost);
            bool same = triangle_nearest_portable(index, &set, &ray, &hit, &cost) == found &&
                        triangle_any_portable(index, &set, &ray, &cost) == found;
            same = same && (!found || (hit.triangle == expected.triangle && hit.t == expected.t &&
                                       hit.u == expected.u && hit.v == expected.v && hit.enter == expected.enter));
            triangle_all_portable(index, &set, &ray, add_up, &sum, &cost);
            triangle_brute_all(&set, &ray, add_up, &every, &cost);
            if (!same || sum.triangles != every.triangles || fabs(sum.t - every.t) > 1e-9 * fabs(every.t))
                test_fail(__FILE__, __LINE__, "%s: ray %d differs from trying every triangle", names[kind], i);
            hits += found;
        }
        triangle_index_destroy(index);
        mesh_release(mesh);
        maker_free(&m);
    }
    CHECK(hits > 700 * times);
}
