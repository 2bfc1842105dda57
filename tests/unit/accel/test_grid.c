/* The voxel grid against a test of every item, on random worlds of boxes; degenerate worlds; exactness under scaling.
 */
#include "accel/grid.h"
#include "base/mem.h"
#include "shape/box_shape_internal.h"
#include "tests/harness.h"
#include "tests/unit/random_makers.h"

#include <math.h>
#include <stdlib.h>

enum { WORLD_ITEMS = 300 };

struct nearest_item {
    bool found;
    uint32_t item;
    double t;
};

static void point_at(const struct box *boxes, uint32_t item, const struct ray *ray, struct nearest_item *best) {
    struct crossing pair[2];
    if (!box_shape_crossings(&boxes[item], ray, pair))
        return;
    for (int k = 0; k < 2; k++) {
        double t = pair[k].t;
        if (!(t > ray->t_min && t < ray->t_max))
            continue;
        if (!best->found || t < best->t || (t == best->t && item < best->item))
            *best = (struct nearest_item){true, item, t};
        return;
    }
}

static struct nearest_item brute_force(const struct box *boxes, uint32_t count, const struct ray *ray) {
    struct nearest_item best = {0};
    for (uint32_t i = 0; i < count; i++)
        point_at(boxes, i, ray, &best);
    return best;
}

static struct nearest_item through_grid(const struct grid *grid, const struct box *boxes, const struct ray *ray,
                                        uint32_t *voxels) {
    struct nearest_item best = {0};
    struct grid_traversal w;
    double last_exit = -INFINITY;
    for (bool ok = grid_traversal_begin(&w, grid, ray); ok; ok = grid_traversal_next(&w)) {
        CHECK(w.t_exit >= last_exit && w.count > 0);
        last_exit = w.t_exit;
        for (uint32_t i = 0; i < w.count; i++)
            point_at(boxes, w.items[i], ray, &best);
        if (best.found && best.t <= w.t_exit)
            break;
    }
    *voxels = w.voxels;
    return best;
}

/* Worlds of many kinds: spread or crowded, flat, on lattice planes, far from the origin, of very different sizes. */
static uint32_t random_world(struct test_random *random, struct box *boxes) {
    uint32_t count = 1 + (uint32_t)test_uniform(random, 0, WORLD_ITEMS - 0.001);
    if (test_uniform(random, 0, 1) < 0.3)
        count = 1 + count % 8;
    double kind = test_uniform(random, 0, 1), sizes = exp(test_uniform(random, -5, 0.5));
    struct vec3 spread = {1, 1, 1}, middle = {0, 0, 0};
    if (kind < 0.2)
        spread.y = 0;
    else if (kind < 0.35)
        spread.x = 1e-9;
    else if (kind < 0.45)
        spread = vec3_make(0, 1, 0);
    else if (kind < 0.6)
        middle = random_vec3(random, 1e6);
    bool lattice = test_uniform(random, 0, 1) < 0.25;
    for (uint32_t i = 0; i < count; i++) {
        struct vec3 p = vec3_add(middle, vec3_mul(random_vec3(random, 10), spread)), size = random_vec3(random, 1);
        double scale = sizes * exp(test_uniform(random, -3, 1));
        size = vec3_scale(vec3_make(fabs(size.x), fabs(size.y), fabs(size.z)), scale);
        if (lattice) {
            p = vec3_make(floor(p.x), floor(p.y), floor(p.z));
            size = vec3_all(1);
        }
        boxes[i] = (struct box){p, vec3_add(p, size)};
    }
    return count;
}

static struct ray random_ray(struct test_random *random, const struct box *boxes, uint32_t count) {
    const struct box *aim = &boxes[(uint32_t)test_uniform(random, 0, count - 0.001)];
    double aside = test_uniform(random, 0, 1) < 0.3 ? 0.5 : 0.5 * vec3_get(vec3_sub(aim->max, aim->min), 0);
    struct vec3 target = vec3_add(vec3_scale(vec3_add(aim->min, aim->max), 0.5), random_vec3(random, aside));
    struct ray ray = {.t_min = 0, .t_max = INFINITY};
    double kind = test_uniform(random, 0, 1);
    if (kind < 0.4) {
        ray.origin = vec3_add(target, random_vec3(random, 15));
        ray.direction = vec3_sub(target, ray.origin);
    } else if (kind < 0.6) { /* from inside, anywhere */
        ray.origin = target;
        ray.direction = random_vec3(random, 1);
    } else if (kind < 0.7) { /* from far away */
        ray.origin = vec3_add(target, random_vec3(random, exp(test_uniform(random, 3, 25))));
        ray.direction = vec3_sub(target, ray.origin);
    } else { /* along an axis or in a coordinate plane, with +0 or -0, also exactly on lattice planes */
        ray.origin = vec3_add(target, random_vec3(random, 15));
        ray.direction = random_vec3(random, 1);
        if (kind < 0.85) {
            ray.origin = vec3_make(floor(target.x), target.y, floor(target.z));
            ray.direction = vec3_make(0.0, kind < 0.8 ? -1 : 1, -0.0);
            ray.origin.y += ray.direction.y * -30;
        } else if (kind < 0.9) {
            ray.direction.z = 0;
        } else {
            ray.direction = vec3_make(1, -1, 1);
            ray.origin = vec3_sub(vec3_make(floor(target.x), floor(target.y), floor(target.z)), ray.direction);
        }
    }
    ray.direction = vec3_scale(ray.direction, exp(test_uniform(random, -8, 8)));
    if (test_uniform(random, 0, 1) < 0.2)
        ray.t_max = test_uniform(random, 0, 2);
    if (test_uniform(random, 0, 1) < 0.1)
        ray.t_min = -INFINITY;
    return ray;
}

static void compare_with_brute_force(uint64_t seed, int worlds, int rays) {
    struct test_random random = {seed};
    struct box boxes[WORLD_ITEMS];
    struct error error;
    uint64_t hits = 0, wrong = 0;
    for (int world = 0; world < worlds; world++) {
        uint32_t count = random_world(&random, boxes), voxels;
        struct grid grid;
        CHECK(grid_build(&grid, boxes, count, NULL, &error));
        for (int i = 0; i < rays; i++) {
            struct ray ray = random_ray(&random, boxes, count);
            struct nearest_item a = brute_force(boxes, count, &ray), b = through_grid(&grid, boxes, &ray, &voxels);
            hits += a.found;
            if (a.found == b.found && (!a.found || (a.item == b.item && a.t == b.t)))
                continue;
            if (++wrong < 5)
                test_fail(__FILE__, __LINE__, "world %d ray %d: item %u t %.17g, through the grid item %u t %.17g",
                          world, i, a.item, a.t, b.item, b.t);
        }
        grid_destroy(&grid);
    }
    CHECK_EQ_INT(wrong, 0);
    CHECK(hits > (uint64_t)worlds * (uint64_t)rays / 4);
}

TEST(grid_answers_like_brute_force) {
    compare_with_brute_force(1, 100, 2500);
}

TEST_LONG(grid_answers_like_brute_force_on_ten_million_rays) {
    compare_with_brute_force(2, 1000, 10000);
}

TEST(grid_steps_are_the_same_after_scaling_by_powers_of_two) {
    struct test_random random = {3};
    struct box boxes[WORLD_ITEMS], scaled[WORLD_ITEMS];
    struct error error;
    const int exponents[] = {-480, -10, 20, 480};
    for (int world = 0; world < 20; world++) {
        uint32_t count = random_world(&random, boxes);
        struct grid grid, big;
        CHECK(grid_build(&grid, boxes, count, NULL, &error));
        for (int e = 0; e < 4; e++) {
            double s = ldexp(1, exponents[e]);
            for (uint32_t i = 0; i < count; i++)
                scaled[i] = (struct box){vec3_scale(boxes[i].min, s), vec3_scale(boxes[i].max, s)};
            CHECK(grid_build(&big, scaled, count, NULL, &error));
            for (int i = 0; i < 3; i++)
                CHECK_EQ_INT(grid.cells[i], big.cells[i]);
            for (int i = 0; i < 2000; i++) {
                struct ray ray = random_ray(&random, boxes, count), big_ray = ray;
                big_ray.origin = vec3_scale(ray.origin, s);
                big_ray.direction = vec3_scale(ray.direction, s);
                struct grid_traversal a, b;
                bool in_a = grid_traversal_begin(&a, &grid, &ray), in_b = grid_traversal_begin(&b, &big, &big_ray);
                while (in_a && in_b) {
                    CHECK(a.t_exit == b.t_exit && a.count == b.count && a.voxels == b.voxels);
                    CHECK(a.items - grid.cell_items == b.items - big.cell_items);
                    in_a = grid_traversal_next(&a);
                    in_b = grid_traversal_next(&b);
                }
                CHECK(in_a == in_b && a.voxels == b.voxels);
            }
            grid_destroy(&big);
        }
        grid_destroy(&grid);
    }
}

static struct ray plain_ray(struct vec3 origin, struct vec3 direction) {
    return (struct ray){.origin = origin, .direction = direction, .t_min = 0, .t_max = INFINITY};
}

/* Every item whose box the ray meets is offered. */
static bool offers(const struct grid *grid, const struct ray *ray, uint32_t item) {
    struct grid_traversal w;
    for (bool ok = grid_traversal_begin(&w, grid, ray); ok; ok = grid_traversal_next(&w))
        for (uint32_t i = 0; i < w.count; i++)
            if (w.items[i] == item)
                return true;
    return false;
}

TEST(grid_of_nothing_offers_nothing) {
    struct grid grid;
    struct error error;
    struct box empty[3] = {box_empty(), box_empty(), box_empty()};
    struct ray ray = plain_ray(vec3_all(0), vec3_make(0, 0, 1));
    struct grid_traversal w;
    CHECK(grid_build(&grid, NULL, 0, NULL, &error));
    CHECK(!grid_traversal_begin(&w, &grid, &ray));
    grid_destroy(&grid);
    CHECK(grid_build(&grid, empty, 3, NULL, &error));
    CHECK(!grid_traversal_begin(&w, &grid, &ray) && grid.cells[0] == 0);
    grid_destroy(&grid);
}

TEST(grid_of_points_flats_and_extreme_sizes_loses_nothing) {
    struct error error;
    const double scales[] = {1e-150, 1e-30, 1, 1e30, 1e150};
    for (int k = 0; k < 5; k++) {
        double s = scales[k];
        struct box boxes[64];
        for (int shape = 0; shape < 4; shape++) {
            for (uint32_t i = 0; i < 64; i++) {
                struct vec3 p = {s * (i % 4), s * (i / 4 % 4), s * (i / 16)};
                if (shape == 1) /* all in one point */
                    p = vec3_make(s, -s, s);
                if (shape == 2) /* in a plane that does not go through the origin */
                    p.z = 7 * s;
                if (shape == 3) /* in a line through it */
                    p.y = p.z = 0;
                boxes[i] = (struct box){p, p};
            }
            struct grid grid;
            CHECK(grid_build(&grid, boxes, 64, NULL, &error));
            for (uint32_t i = 0; i < 64; i++) {
                struct vec3 from = {-3 * s, 5.5 * s, -11 * s};
                struct ray ray = plain_ray(from, vec3_sub(boxes[i].min, from));
                CHECK(offers(&grid, &ray, i));
                ray = plain_ray(vec3_sub(boxes[i].min, vec3_make(0, 0, 8 * s)), vec3_make(0, 0, s));
                CHECK(offers(&grid, &ray, i));
            }
            grid_destroy(&grid);
        }
    }
    /* Everything at the origin: there is no length for a relative error. */
    struct box zero[5] = {{{0, 0, 0}, {0, 0, 0}}};
    struct grid grid;
    CHECK(grid_build(&grid, zero, 5, NULL, &error));
    struct ray ray = plain_ray(vec3_make(1, 2, 3), vec3_make(-1, -2, -3));
    CHECK(offers(&grid, &ray, 4));
    grid_destroy(&grid);
}

TEST(unbounded_items_are_offered_first_to_every_ray) {
    struct error error;
    struct box boxes[6];
    for (uint32_t i = 0; i < 6; i++)
        boxes[i] = (struct box){vec3_all(i), vec3_all(i + 0.5)};
    boxes[1].max.x = INFINITY;
    boxes[4] = (struct box){vec3_all(-INFINITY), vec3_all(INFINITY)};
    boxes[5] = box_empty();
    struct grid grid;
    CHECK(grid_build(&grid, boxes, 6, NULL, &error));
    CHECK_EQ_INT(grid.unbounded_count, 2);
    struct ray miss = plain_ray(vec3_all(-10), vec3_make(0, -1, 0)), hit = plain_ray(vec3_all(-1), vec3_all(1));
    struct grid_traversal w;
    CHECK(grid_traversal_begin(&w, &grid, &miss) && w.count == 2 && w.items[0] == 1 && w.items[1] == 4);
    CHECK(w.t_exit == -INFINITY && !grid_traversal_next(&w));
    CHECK(grid_traversal_begin(&w, &grid, &hit) && w.count == 2);
    CHECK(grid_traversal_next(&w) && w.items[0] == 0);
    CHECK(offers(&grid, &hit, 2) && offers(&grid, &hit, 3) && !offers(&grid, &hit, 5));
    grid_destroy(&grid);
}

TEST(items_that_touch_every_voxel_do_not_fill_the_memory) {
    enum { MANY = 20000 };
    struct error error;
    struct box *boxes = malloc(MANY * sizeof *boxes);
    struct test_random random = {4};
    for (int i = 0; i < MANY; i++)
        boxes[i] = (struct box){vec3_add(vec3_all(-10), random_vec3(&random, 1)),
                                vec3_add(vec3_all(10), random_vec3(&random, 1))};
    struct grid grid;
    CHECK(grid_build(&grid, boxes, MANY, NULL, &error));
    CHECK(grid_memory(&grid) < 200 * (size_t)MANY);
    grid_destroy(&grid);
    free(boxes);
}

TEST(grid_of_small_items_has_short_lists_and_short_walks) {
    enum { MANY = 100000 };
    struct error error;
    struct box *boxes = malloc(MANY * sizeof *boxes);
    struct test_random random = {5};
    for (int i = 0; i < MANY; i++) {
        struct vec3 p = random_vec3(&random, 1);
        boxes[i] = (struct box){p, vec3_add(p, vec3_all(0.005))};
    }
    struct grid grid;
    CHECK(grid_build(&grid, boxes, MANY, NULL, &error));
    uint64_t cells = (uint64_t)grid.cells[0] * grid.cells[1] * grid.cells[2];
    CHECK(cells > 2 * MANY && cells < 4 * MANY);
    uint64_t looked = 0, voxels = 0;
    for (int i = 0; i < 10000; i++) {
        struct ray ray = plain_ray(random_vec3(&random, 1), random_vec3(&random, 1));
        struct grid_traversal w;
        for (bool ok = grid_traversal_begin(&w, &grid, &ray); ok; ok = grid_traversal_next(&w))
            looked += w.count;
        voxels += w.voxels;
    }
    CHECK(looked < 10000 * 200 && voxels < 10000 * 200);
    grid_destroy(&grid);
    free(boxes);
}

TEST(grid_build_survives_every_failing_allocation) {
    struct box boxes[20];
    struct test_random random = {6};
    struct error error = {0};
    for (int i = 0; i < 20; i++)
        boxes[i] = (struct box){random_vec3(&random, 1), vec3_all(2)};
    boxes[7].max = vec3_all(INFINITY);
    for (uint64_t k = 1;; k++) { /* fails only in builds with fault injection */
        struct grid grid;
        mem_fail_at(k);
        bool ok = grid_build(&grid, boxes, 20, NULL, &error);
        mem_fail_at(0);
        CHECK(ok || (error.kind == ERROR_MACHINE && !grid.cell_items && !grid.unbounded));
        grid_destroy(&grid);
        if (ok)
            break;
    }
}

TEST(grid_build_stops_when_cancelled) {
    char warning[256];
    struct pool *pool = pool_create(1, warning);
    struct box boxes[20] = {{{0, 0, 0}, {1, 1, 1}}};
    struct error error = {0};
    struct grid grid;
    pool_cancel(pool);
    CHECK(!grid_build(&grid, boxes, 20, pool, &error) && error.kind == ERROR_CANCELLED);
    pool_reset_cancel(pool);
    CHECK(grid_build(&grid, boxes, 20, pool, &error));
    grid_destroy(&grid);
    pool_destroy(pool);
}
