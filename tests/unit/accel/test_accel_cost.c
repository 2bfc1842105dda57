/* The cost model of the scene accelerator against counts from the traversal of grids of many resolutions. */
#include "tests/harness.h"

#include "accel/accel_cost.h"
#include "accel/box_tree.h"
#include "accel/grid.h"
#include "accel/triangle_index.h"
#include "base/mem.h"
#include "tests/stage.h"

#include <stdlib.h>

/* In units of a node visit, as in accel_cost.c: a triangle of a block of eight costs 0.2, a voxel with the start of its
 * hierarchy 1.2 (most visited voxels are not empty), a box 0.3. */
static double cost_of(double nodes, double triangles, double voxels) {
    return nodes + 0.2 * triangles + 1.2 * voxels;
}

struct soup {
    double (*vertices)[3];
    uint32_t (*corners)[3];
    uint32_t count;
    struct box bounds;
};

static void soup_add(struct soup *s, struct test_random *random, struct vec3 at, double size) {
    for (int j = 0; j < 3; j++) {
        double *v = s->vertices[3 * s->count + (uint32_t)j];
        for (int k = 0; k < 3; k++)
            v[k] = vec3_get(at, k) + size * test_uniform(random, -0.5, 0.5);
        s->corners[s->count][j] = 3 * s->count + (uint32_t)j;
        s->bounds = box_add_point(s->bounds, vec3_make(v[0], v[1], v[2]));
    }
    s->count++;
}

enum { SOUP = 20000, FORMS = 6 };

/* Distributions: uniform in a cube; tiny slivers in it; a sheet; a ball; a ball in a wide bowl of large triangles; two
 * distant clusters. */
static struct soup make_soup(int form, struct test_random *random) {
    struct soup s = {.vertices = malloc(3 * SOUP * sizeof *s.vertices),
                     .corners = malloc(SOUP * sizeof *s.corners),
                     .bounds = box_empty()};
    for (int i = 0; i < SOUP; i++) {
        struct vec3 p = {test_uniform(random, -1, 1), test_uniform(random, -1, 1), test_uniform(random, -1, 1)};
        struct vec3 on_ball = vec3_normalize(p);
        switch (form) {
        case 0:
            soup_add(&s, random, p, 0.08);
            break;
        case 1:
            soup_add(&s, random, p, 0.01);
            break;
        case 2:
            soup_add(&s, random, vec3_make(p.x, 0.05 * sin(5 * p.x) * cos(4 * p.z), p.z), 0.03);
            break;
        case 3:
            soup_add(&s, random, on_ball, 0.04);
            break;
        case 4:
            if (i % 5 > 0)
                soup_add(&s, random, vec3_scale(on_ball, 0.01), 0.0004);
            else
                soup_add(&s, random, vec3_make(p.x, 0.3 * (p.x * p.x + p.z * p.z) - 0.02, p.z), 0.06);
            break;
        default:
            soup_add(&s, random, vec3_add_scaled(vec3_all(i % 2 ? 1 : -1), p, 0.05), 0.002);
        }
    }
    return s;
}

/* Half of the rays are random lines, half go to random triangles. */
static struct ray soup_ray(const struct soup *s, struct test_random *random, int i) {
    struct vec3 size = vec3_sub(s->bounds.max, s->bounds.min), route, target;
    route = vec3_make(test_uniform(random, -1, 1), test_uniform(random, -1, 1), test_uniform(random, -1, 1));
    target = vec3_add(s->bounds.min, vec3_mul(size, vec3_make(test_uniform(random, 0, 1), test_uniform(random, 0, 1),
                                                              test_uniform(random, 0, 1))));
    if (i % 2) {
        const double *v = s->vertices[3 * (uint32_t)test_uniform(random, 0, s->count)];
        target = vec3_make(v[0], v[1], v[2]);
    }
    route = vec3_normalize(route);
    return (struct ray){
        .origin = vec3_add_scaled(target, route, -2 * vec3_length(size)), .direction = route, .t_max = INFINITY};
}

static double counted(const struct soup *s, uint32_t voxels) {
    struct triangle_set set = {.vertices = (const double(*)[3])s->vertices,
                               .corners = (const uint32_t(*)[3])s->corners,
                               .count = s->count,
                               .bounds = s->bounds};
    struct triangle_index *index;
    struct error error;
    struct test_random random = {5};
    struct triangle_cost cost = {0};
    if (!triangle_index_build(&index, &set, voxels, NULL, &error))
        return INFINITY;
    enum { RAYS = 2000 };
    for (int i = 0; i < RAYS; i++) {
        struct ray ray = soup_ray(s, &random, i);
        struct triangle_hit hit;
        (void)triangle_index_nearest(index, &set, &ray, &hit, &cost);
    }
    triangle_index_destroy(index);
    return cost_of((double)cost.hierarchy_steps / RAYS, (double)cost.triangle_tests / RAYS, (double)cost.voxels / RAYS);
}

TEST(frames_of_meshes_cost_little_more_than_the_best_of_all_resolutions) {
    struct test_random random = {3};
    for (int form = 0; form < FORMS; form++) {
        struct soup s = make_soup(form, &random);
        double chosen = counted(&s, 0), best = INFINITY;
        for (uint32_t voxels = 1; voxels <= 32768; voxels *= 8) {
            double cost = counted(&s, voxels);
            best = cost < best ? cost : best;
        }
        CHECK(chosen <= 1.1 * best);
        free(s.vertices);
        free(s.corners);
    }
}

static struct box soup_box(const void *context, uint32_t i) {
    const struct soup *s = context;
    struct box box = box_empty();
    for (int j = 0; j < 3; j++) {
        const double *v = s->vertices[s->corners[i][j]];
        box = box_add_point(box, vec3_make(v[0], v[1], v[2]));
    }
    return box;
}

TEST(frames_of_meshes_have_the_voxels_that_the_model_finds_cheapest) {
    struct test_random random = {3};
    for (int form = 0; form < FORMS; form++) {
        struct soup s = make_soup(form, &random);
        struct cost_sample cost_sample;
        cost_sample_take(&cost_sample, &(struct cost_items){&s.bounds, soup_box, &s, s.count}, 512, 5);
        struct accel_mesh_cost frame = accel_over_mesh(&cost_sample);
        CHECK(cost_sample.level_count > 1);
        for (uint32_t l = 0; l < cost_sample.level_count; l++)
            CHECK(frame.costs[frame.level] <= frame.costs[l]);
        const uint32_t *cells = cost_sample.levels[frame.level].cells;
        CHECK(counted(&s, 0) == counted(&s, cells[0] * cells[1] * cells[2]));
        free(s.vertices);
        free(s.corners);
    }
}

/* The cost of an invented mesh: a million occupied voxels, of which a ray meets one. */
TEST(a_mesh_whose_voxels_save_more_than_their_traversal_costs_gets_them) {
    struct cost_sample cost_sample = {.level_count = 4, .items = 1e6};
    for (uint32_t l = 0; l < 4; l++)
        cost_sample.levels[l] = (struct cost_level){
            .cells = {1, 1, 1}, .filled = 1, .visited = 1, .occupied = 1, .listed = 1, .neighbours = 1};
    CHECK_EQ_INT(accel_over_mesh(&cost_sample).level, 0);
    cost_sample.levels[3].filled = 1e6;
    CHECK_EQ_INT(accel_over_mesh(&cost_sample).level, 3);
    cost_sample.levels[3].visited = 1000;
    CHECK_EQ_INT(accel_over_mesh(&cost_sample).level, 0);
}

/* --- over primitives --- */

static void add_ball(struct stage *s, struct node *root, struct vec3 at, double radius) {
    struct node *node = stage_sphere(s, root, NULL);
    stage_scale(s, node, radius, radius, radius);
    stage_move(s, node, at.x, at.y, at.z);
}

/* A uniform cloud, a sparse one, a cluster over a wide floor, a sheet, two clusters, sizes of all magnitudes. */
static void make_world(struct stage *s, int form, int count, struct test_random *random) {
    struct node *root = s->root;
    for (int i = 0; i < count; i++) {
        struct vec3 p = {test_uniform(random, -1, 1), test_uniform(random, -1, 1), test_uniform(random, -1, 1)};
        double each = 1 / cbrt(count);
        switch (form) {
        case 0:
            add_ball(s, root, p, 0.8 * each);
            break;
        case 1:
            add_ball(s, root, p, 0.1 * each);
            break;
        case 2:
            add_ball(s, root, i ? vec3_scale(p, 0.01) : vec3_make(0, -1, 0), i ? 0.008 * each : 0.9);
            break;
        case 3:
            add_ball(s, root, vec3_make(p.x, 0.01 * p.y, p.z), 0.6 / sqrt(count));
            break;
        case 4:
            add_ball(s, root, vec3_add_scaled(vec3_all(i % 2 ? 1 : -1), p, 0.05), 0.04 * each);
            break;
        default:
            add_ball(s, root, p, each * exp(test_uniform(random, -5, 1)));
        }
    }
}

static double counted_world(const struct stage *s) {
    struct test_random random = {5};
    struct world_scratch scratch;
    CHECK(world_scratch_init(&scratch, &s->world));
    enum { RAYS = 4000 };
    for (int i = 0; i < RAYS; i++) {
        struct vec3 route = {test_uniform(&random, -1, 1), test_uniform(&random, -1, 1), test_uniform(&random, -1, 1)};
        struct vec3 at = {test_uniform(&random, -1, 1), test_uniform(&random, -1, 1), test_uniform(&random, -1, 1)};
        if (i % 2) {
            const struct box *box = &s->world.boxes[(uint32_t)test_uniform(&random, 0, s->world.primitive_count)];
            at = vec3_scale(vec3_add(box->min, box->max), 0.5);
        }
        struct ray ray = {.origin = vec3_add_scaled(at, route, -5), .direction = route, .t_max = INFINITY};
        uint32_t primitive;
        struct crossing crossing;
        (void)world_nearest_crossing(&s->world, &ray, &scratch, &primitive, &crossing);
    }
    double nodes = (double)scratch.geom.cost.hierarchy_steps, boxes = (double)scratch.geom.box_tests,
           voxels = (double)scratch.geom.cost.voxels;
    world_scratch_destroy(&scratch);
    return (nodes + 0.3 * boxes + 0.35 * voxels) / RAYS;
}

TEST(scene_accelerators_cost_little_more_than_the_better_of_cells_and_hierarchy) {
    int cells = 0, hierarchies = 0;
    for (int form = 0; form < 6; form++) {
        double cost[3];
        enum accel_kind frame = ACCEL_AUTO;
        for (int i = 0; i < 3; i++) {
            struct stage s;
            struct test_random random = {(uint64_t)form};
            stage_begin(&s, 1);
            make_world(&s, form, 4000, &random);
            CHECK(stage_build(&s, s.root, (enum accel_kind[]){ACCEL_AUTO, ACCEL_GRID, ACCEL_BVH}[i]));
            frame = i == 0 ? s.world.accel.kind : frame;
            cost[i] = counted_world(&s);
            stage_end(&s);
        }
        cells += frame == ACCEL_GRID;
        hierarchies += frame == ACCEL_BVH;
        CHECK(cost[0] <= 1.6 * (cost[1] < cost[2] ? cost[1] : cost[2]));
    }
    CHECK(cells > 0 && hierarchies > 0);
}

/* --- memory while building --- */

static void check_peak(const char *what, uint64_t before, uint64_t result) {
    uint64_t peak = mem_peak() - before;
    if (peak > 2 * result)
        test_fail(__FILE__, __LINE__, "%s: %llu bytes at the peak for %llu", what, (unsigned long long)peak,
                  (unsigned long long)result);
}

TEST(building_takes_at_most_twice_the_memory_of_what_is_built) {
#ifndef GRAY_FAULTS
    test_skip("memory is counted only in builds with GRAY_FAULTS");
#endif
    struct test_random random = {4};
    struct stage stage;
    stage_begin(&stage, 2);
    for (int form = 0; form < FORMS; form += 2) {
        struct soup s = make_soup(form, &random);
        struct triangle_set set = {.vertices = (const double(*)[3])s.vertices,
                                   .corners = (const uint32_t(*)[3])s.corners,
                                   .count = s.count,
                                   .bounds = s.bounds};
        struct triangle_index *index;
        struct error error;
        uint64_t before = mem_peak_begin();
        CHECK(triangle_index_build(&index, &set, 0, stage.pool, &error));
        check_peak("a mesh", before, triangle_index_memory(index));
        triangle_index_destroy(index);

        /* Boxes of the triangles, as if each were a primitive; the boxes count as memory of the structure. */
        struct box *boxes = malloc(s.count * sizeof *boxes);
        for (uint32_t i = 0; i < s.count; i++) {
            boxes[i] = box_empty();
            for (int j = 0; j < 3; j++) {
                const double *v = s.vertices[3 * i + (uint32_t)j];
                boxes[i] = box_add_point(boxes[i], vec3_make(v[0], v[1], v[2]));
            }
        }
        struct box_tree tree;
        before = mem_peak_begin();
        CHECK(box_tree_build(&tree, boxes, s.count, stage.pool, &error));
        check_peak("a hierarchy of placed primitives", before - s.count * sizeof *boxes,
                   box_tree_memory(&tree) + s.count * sizeof *boxes);
        box_tree_destroy(&tree);
        struct grid grid;
        before = mem_peak_begin();
        CHECK(grid_build(&grid, boxes, s.count, stage.pool, &error));
        check_peak("a grid of placed primitives", before, grid_memory(&grid));
        grid_destroy(&grid);
        free(boxes);
        free(s.vertices);
        free(s.corners);
    }
    stage_end(&stage);
}
