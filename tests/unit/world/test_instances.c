/* One node at many placements: the same bits as separate nodes, and little memory. */
#include "tests/harness.h"
#include "tests/stage.h"

#include <stdlib.h>
#include <string.h>

enum { COPIES = 60 };

struct scatter {
    double at[COPIES][3], turn[COPIES], size[COPIES];
    struct affine matrices[COPIES];
};

static void scatter(struct scatter *out) {
    struct test_random random = {5};
    for (int i = 0; i < COPIES; i++) {
        for (int k = 0; k < 3; k++)
            out->at[i][k] = test_uniform(&random, -3, 3);
        out->turn[i] = test_uniform(&random, -180, 180);
        out->size[i] = test_uniform(&random, 0.1, 0.5);
        for (int k = 0; k < 12; k++)
            out->matrices[i].m[k / 4][k % 4] = test_uniform(&random, -0.5, 0.5) + (k % 5 == 0) * 0.3;
    }
}

/* The instanced node: a ball beside a cube, under a node that moves them. */
static struct node *object(struct stage *s) {
    struct node *group = scene_node(&s->scene, NODE_GROUP, "thing", &s->error);
    stage_sphere(s, group, stage_phong(s, colour_make(0.9, 0.4, 0.2), colour_all(0.3), 10));
    struct node *cube = stage_cube(s, group, stage_phong(s, colour_make(0.2, 0.4, 0.9), colour_all(0.3), 10));
    stage_move(s, cube, 0.6, 0.1, 0.2);
    stage_scale(s, group, 1, 0.8, 1);
    return group;
}

static void finish(struct stage *s) {
    s->ambient = colour_all(0.1);
    stage_point_light(s, vec3_make(4, 6, 5), colour_all(0.9));
}

/* kind 0: nodes, 1: positions with rotations and sizes, 2: the matrices of the nodes */
static void build(struct stage *s, const struct scatter *all, int kind, struct placements *placements) {
    struct node *of = object(s), *parent = stage_group(s, s->root);
    stage_rotate(s, parent, 1, 20);
    finish(s);
    if (kind == 1) {
        *placements =
            (struct placements){.count = COPIES, .at = all->at, .turn = all->turn, .size = all->size, .axis = 2};
        parent->placements = placements;
        CHECK(node_add_child(&s->scene, parent, of, &s->error));
        return;
    }
    for (int i = 0; i < COPIES; i++) {
        struct node *node = stage_group(s, parent);
        CHECK(node_add_child(&s->scene, node, of, &s->error));
        stage_scale(s, node, all->size[i], all->size[i], all->size[i]);
        stage_rotate(s, node, 2, all->turn[i]);
        stage_move(s, node, all->at[i][0], all->at[i][1], all->at[i][2]);
    }
}

TEST(instances_with_many_transforms_give_the_bits_of_a_node_for_each) {
    struct scatter all;
    struct placements placements;
    unsigned char *reference = NULL;
    scatter(&all);
    for (int kind = 0; kind < 2; kind++) {
        struct stage s;
        stage_begin(&s, 2);
        build(&s, &all, kind, &placements);
        CHECK(stage_render(&s, 100, 80));
        size_t size = (size_t)100 * 80 * film_record_size(s.film.record);
        CHECK_EQ_INT(s.world.primitive_count, 2 * COPIES);
        CHECK_EQ_INT(s.world.prototype_count, 2);
        if (reference)
            CHECK(memcmp(reference, s.film.pixels, size) == 0);
        else
            reference = memcpy(malloc(size), s.film.pixels, size);
        stage_end(&s);
    }
    free(reference);
}

TEST(placements_by_matrix_follow_the_matrix) {
    struct scatter all;
    scatter(&all);
    struct placements placements = {.count = COPIES, .matrices = all.matrices};
    for (uint32_t i = 0; i < COPIES; i++) {
        struct transform t = placement_transform(&placements, i);
        CHECK(memcmp(&t.forward, &all.matrices[i], sizeof t.forward) == 0);
        struct vec3 p = {0.3, -0.2, 0.7}, q = affine_point(&t.inverse, affine_point(&t.forward, p));
        CHECK(vec3_length(vec3_sub(p, q)) < 1e-12);
    }
}

TEST(lists_of_lights_hold_for_every_instance) {
    static const double at[3][3] = {{-3, 0, 0}, {0, 0, 0}, {3, 0, 0}};
    struct placements placements = {.count = 3, .at = at};
    struct stage s;
    stage_begin(&s, 1);
    struct node *many = stage_group(&s, s.root);
    many->placements = &placements;
    stage_sphere(&s, many, stage_phong(&s, colour_all(1), colour_all(0), 1));
    struct node *other = stage_sphere(&s, s.root, stage_phong(&s, colour_all(1), colour_all(0), 1));
    stage_move(&s, other, 0, 3, 0);
    stage_point_light(&s, vec3_make(0, 0, 50), colour_all(1));
    const struct node *const list[] = {many};
    s.authored[0].include = list;
    s.authored[0].include_count = 1;
    CHECK(stage_build(&s, s.root, ACCEL_AUTO));
    CHECK_EQ_INT(s.world.primitive_count, 4);
    for (uint32_t i = 0; i < 4; i++)
        CHECK_EQ_INT(s.world.lights[0].lit[i], i < 3);
    stage_end(&s);
}

/* 56 bytes each, 48 for the box, about 90 for the hierarchy; instances that are only translated share one linear map.
 */
TEST(a_placement_costs_less_than_two_hundred_bytes_of_the_world) {
    enum { SIDE = 400 };
    struct stage s;
    stage_begin(&s, 2);
    double(*at)[3] = malloc(SIDE * SIDE * sizeof *at);
    for (int i = 0; i < SIDE * SIDE; i++) {
        at[i][0] = 3 * (i % SIDE);
        at[i][1] = 0;
        at[i][2] = 3 * (i / SIDE);
    }
    struct placements placements = {.count = SIDE * SIDE, .at = (const double(*)[3])at};
    struct node *many = stage_group(&s, s.root);
    many->placements = &placements;
    stage_sphere(&s, many, stage_phong(&s, colour_all(1), colour_all(0), 1));
    CHECK(stage_build(&s, s.root, ACCEL_AUTO));
    CHECK_EQ_INT(s.world.primitive_count, SIDE * SIDE);
    CHECK(s.world.linear_count <= 1);
    size_t bytes = s.arena.total + box_tree_memory(&s.world.accel.tree);
    CHECK(bytes < (size_t)200 * SIDE * SIDE);
    stage_end(&s);
    free(at);
}

TEST(a_group_takes_no_memory_for_what_only_shapes_have) {
    struct stage s;
    stage_begin(&s, 1);
    size_t before = s.scene.arena.total;
    for (int i = 0; i < 1000; i++)
        CHECK(scene_node(&s.scene, NODE_GROUP, i % 2 ? "tree" : "bush", &s.error));
    CHECK(s.scene.arena.total - before <= (size_t)320 * 1000);
    stage_end(&s);
}

/* Rays at a dense cluster, alone and on a floor ten thousand times its size, in a hall around both: the work of the
 * search must stay about the same. */
TEST(a_dense_heap_costs_as_much_in_a_huge_scene_as_by_itself) {
    uint64_t work[2] = {0, 0}, balls[2] = {0, 0};
    for (int kind = 0; kind < 2; kind++) {
        struct stage s;
        stage_begin(&s, 1);
        struct material *plain = stage_phong(&s, colour_all(0.7), colour_all(0), 1);
        struct test_random random = {3};
        for (int i = 0; i < 20000; i++) {
            struct node *ball = stage_sphere(&s, s.root, plain);
            double p[3];
            for (int k = 0; k < 3; k++)
                p[k] = test_uniform(&random, -1, 1);
            stage_scale(&s, ball, 0.02, 0.02, 0.02);
            stage_move(&s, ball, p[0], p[1], p[2]);
        }
        struct node *parents[2];
        for (int i = 0; i < 2 && kind == 1; i++) { /* a floor and a hall */
            parents[i] = stage_cube(&s, s.root, plain);
            stage_move(&s, parents[i], -0.5, i ? -0.5 : -1, -0.5);
            stage_scale(&s, parents[i], 20000, i ? 20000 : 1, 20000);
            stage_move(&s, parents[i], 0, i ? 0 : -1, 0);
        }
        CHECK(stage_build(&s, s.root, ACCEL_AUTO));
        struct world_scratch scratch;
        CHECK(world_scratch_init(&scratch, &s.world));
        random = (struct test_random){4};
        for (int i = 0; i < 4000; i++) {
            struct ray ray = {.origin = {0, 0.5, 6}, .t_max = INFINITY};
            double x = test_uniform(&random, -0.9, 0.9), y = test_uniform(&random, -0.9, 0.9);
            ray.direction = vec3_sub(vec3_make(x, y, 0), ray.origin);
            uint32_t primitive;
            struct crossing crossing;
            uint64_t before = scratch.geom.cost.hierarchy_steps + scratch.geom.shape_tests;
            bool met = world_nearest_crossing(&s.world, &ray, &scratch, &primitive, &crossing) && primitive < 20000;
            balls[kind] += met;
            work[kind] += met ? scratch.geom.cost.hierarchy_steps + scratch.geom.shape_tests - before : 0;
        }
        world_scratch_destroy(&scratch);
        stage_end(&s);
    }
    CHECK(balls[0] > 2000 && balls[0] == balls[1]);
    CHECK((double)work[1] < 1.25 * (double)work[0]);
}
