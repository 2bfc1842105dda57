/* Failures while accelerators are built: whichever allocation fails, and whenever the build is cancelled, it ends with
 * one error of that kind and can be started again with the same result. */
#include "accel/box_tree.h"
#include "base/fault.h"
#include "tests/unit/mesh_makers.h"
#include "tests/unit/random_makers.h"

#include <pthread.h>
#include <unistd.h>

enum { RINGS = 46, BOXES = 3000 };

/* A bumpy ball of about 2 RINGS^2 triangles. */
static struct mesh *bumpy_ball(uint32_t rings) {
    struct maker m = {0};
    struct error error = {0};
    for (uint32_t i = 0; i <= rings; i++)
        for (uint32_t j = 0; j <= rings; j++) {
            double a = 3.14159265 * i / rings, b = 6.2831853 * j / rings, r = 1 + 0.1 * sin(7 * a) * cos(5 * b);
            (void)maker_vertex(&m, r * sin(a) * cos(b), r * cos(a), r * sin(a) * sin(b));
        }
    for (uint32_t i = 0; i < rings; i++)
        for (uint32_t j = 0; j < rings; j++) {
            uint32_t at = i * (rings + 1) + j;
            maker_triangle(&m, at, at + 1, at + rings + 1);
            maker_triangle(&m, at + 1, at + rings + 2, at + rings + 1);
        }
    struct mesh_input input = maker_input(&m);
    struct mesh *mesh = mesh_create(&input, &error);
    CHECK(mesh != NULL);
    maker_free(&m);
    return mesh;
}

static const enum accel_kind kinds[] = {ACCEL_AUTO, ACCEL_GRID, ACCEL_KDTREE};

/* Rays find the same hits with every accelerator. */
static void check_searches(const struct mesh *mesh) {
    struct test_random random = {77};
    struct geom_scratch scratch;
    int wrong = 0, hits = 0;
    CHECK(geom_scratch_init(&scratch, 64));
    for (int i = 0; i < 300; i++) {
        struct vec3 from = random_vec3(&random, 3);
        struct ray ray = ray_from(from, vec3_sub(random_vec3(&random, 0.8), from));
        struct crossing first = {0}, other;
        ray.t_min = 0;
        bool found = mesh_nearest(mesh, &ray, ACCEL_NONE, &scratch, &first);
        hits += found;
        for (size_t k = 0; k < sizeof kinds / sizeof kinds[0]; k++) {
            bool again = mesh_nearest(mesh, &ray, kinds[k], &scratch, &other);
            wrong += again != found || (found && (other.t != first.t || other.part != first.part));
        }
    }
    CHECK(hits > 100);
    CHECK_EQ_INT(wrong, 0);
    geom_scratch_destroy(&scratch);
}

#ifdef GRAY_FAULTS
TEST(indices_of_meshes_survive_any_allocation_that_fails) {
    char warning[256];
    struct pool *pool = pool_create(2, warning);
    struct mesh *mesh = bumpy_ball(RINGS);
    int failed = 0;
    for (size_t b = 0; b < sizeof kinds / sizeof kinds[0]; b++) {
        bool done = false;
        for (uint64_t k = 1; !done; k += 1 + k / 6) { /* the build of a tree polls often */
            struct error error = {0};
            fault_at(FAULT_OF_ALLOCATION, k);
            done = mesh_build_accel(mesh, kinds[b], pool, &error);
            fault_at(FAULT_OF_ALLOCATION, 0);
            CHECK(done || error.kind == ERROR_MACHINE);
            failed += !done;
            pool_reset_cancel(pool);
        }
    }
    CHECK(failed > 20);
    check_searches(mesh);
    mesh_release(mesh);
    pool_destroy(pool);
}

TEST(hierarchies_of_boxes_survive_any_allocation_that_fails) {
    char warning[256];
    struct pool *pool = pool_create(2, warning);
    struct test_random random = {5};
    static struct box boxes[BOXES];
    for (int i = 0; i < BOXES; i++) {
        struct vec3 p = random_vec3(&random, 10);
        boxes[i] = (struct box){p, vec3_add(p, vec3_all(test_uniform(&random, 0, 1)))};
    }
    bool done = false;
    int failed = 0;
    for (uint64_t k = 1; !done; k++) {
        struct error error = {0};
        struct box_tree tree = {0};
        fault_at(FAULT_OF_ALLOCATION, k);
        done = box_tree_build(&tree, boxes, BOXES, pool, &error);
        fault_at(FAULT_OF_ALLOCATION, 0);
        CHECK(done || error.kind == ERROR_MACHINE);
        CHECK(!done || tree.item_count == BOXES);
        failed += !done;
        pool_reset_cancel(pool);
        box_tree_destroy(&tree);
    }
    CHECK(failed > 3);
    pool_destroy(pool);
}
#endif

struct stopper {
    struct pool *pool;
    useconds_t after;
};

static void *stop_soon(void *context) {
    const struct stopper *stopper = context;
    (void)usleep(stopper->after);
    pool_cancel(stopper->pool);
    return NULL;
}

/* Cancels before the start, then a little later each time, until the build finishes first (on a slow machine perhaps
 * never).
 */
TEST(building_may_be_stopped_at_any_moment) {
    char warning[256];
    struct pool *pool = pool_create(2, warning);
    struct mesh *mesh = bumpy_ball(RINGS);
    for (size_t b = 0; b < sizeof kinds / sizeof kinds[0]; b++) {
        bool done = false;
        for (useconds_t after = 0; !done && after < 20000; after += 1 + after) {
            struct error error = {0};
            struct stopper stopper = {pool, after};
            pthread_t thread;
            if (after == 0)
                pool_cancel(pool);
            CHECK(pthread_create(&thread, NULL, stop_soon, &stopper) == 0);
            done = mesh_build_accel(mesh, kinds[b], pool, &error);
            CHECK(pthread_join(thread, NULL) == 0);
            CHECK(done || error.kind == ERROR_CANCELLED);
            pool_reset_cancel(pool);
        }
        struct error error = {0};
        CHECK(mesh_build_accel(mesh, kinds[b], pool, &error));
    }
    check_searches(mesh);
    mesh_release(mesh);
    pool_destroy(pool);
}
