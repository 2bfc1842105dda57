/* The triangle kernels as compiled for processors without SIMD. */
#define GRAY_NO_SIMD
#include "tests/unit/mesh_makers.h"

#include "accel/triangle_kernels_internal.h"

TRIANGLE_KERNELS(portable)
#define KERNEL(name) triangle_##name##_portable
#include "accel/triangle_kernel_internal.h"

enum { TRIANGLES = 300 };

/* The hits of a line; one may be reported again, with the same bits. */
struct met {
    struct triangle_hit hit[TRIANGLES];
    bool is_met[TRIANGLES], changed;
};

static bool are_same(const struct triangle_hit *a, const struct triangle_hit *b) {
    return a->triangle == b->triangle && a->t == b->t && a->u == b->u && a->v == b->v && a->enter == b->enter;
}

static void keep_hit(void *context, const struct triangle_hit *hit) {
    struct met *met = context;
    met->changed = met->changed || (met->is_met[hit->triangle] && !are_same(&met->hit[hit->triangle], hit));
    met->is_met[hit->triangle] = true;
    met->hit[hit->triangle] = *hit;
}

static bool met_same(const struct met *a, const struct met *b) {
    bool same = !a->changed && !b->changed;
    for (int i = 0; i < TRIANGLES && same; i++)
        same = a->is_met[i] == b->is_met[i] && (!a->is_met[i] || are_same(&a->hit[i], &b->hit[i]));
    return same;
}

TEST_TIMES(searches_without_vectors_give_the_bits_of_trying_every_triangle, 30) {
    struct test_random random = {11};
    const char *names[SOUP_KINDS] = {"even", "slivers", "flat", "mixed sizes", "tiny in huge", "lattice", "line"};
    int hits = 0;
    for (int kind = 0; kind < SOUP_KINDS; kind++) {
        struct maker m = {0};
        maker_soup(&m, (enum soup)kind, TRIANGLES, &random);
        struct triangle_set set = set_of(&m);
        struct mesh *mesh = maker_mesh(&m);
        struct triangle_index *index;
        struct error error;
        CHECK(set.count <= TRIANGLES && triangle_index_build(&index, &set, 1, NULL, &error));
        for (int i = 0; i < 1000 * times; i++) {
            struct ray ray = test_any_ray(&m, mesh, &random);
            struct triangle_cost cost = {0};
            struct triangle_hit hit = {0}, expected = {0};
            struct met met = {0}, every = {0};
            bool found = triangle_brute_nearest(&set, &ray, &expected, &cost);
            bool same = triangle_nearest_portable(index, &set, &ray, &hit, &cost) == found &&
                        triangle_any_portable(index, &set, &ray, &cost) == found;
            triangle_all_portable(index, &set, &ray, keep_hit, &met, &cost);
            triangle_brute_all(&set, &ray, keep_hit, &every, &cost);
            if (!same || (found && !are_same(&hit, &expected)) || !met_same(&met, &every))
                test_fail(__FILE__, __LINE__, "%s: ray %d differs from trying every triangle", names[kind], i);
            hits += found;
        }
        triangle_index_destroy(index);
        mesh_release(mesh);
        maker_free(&m);
    }
    CHECK(hits > 700 * times);
}
