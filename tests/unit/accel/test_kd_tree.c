/* The kd-tree over boxes: cheaper than brute force, bounded in size, the same after scaling; missed hits would show in
 * test_world.c and test_mesh.c, which compare with brute force. */
#include "accel/kd_tree.h"
#include "base/mem.h"
#include "tests/harness.h"

#include <math.h>
#include <stdlib.h>

static struct box small_box(struct test_random *random, double spread, double size) {
    double p[3], d[3];
    for (int k = 0; k < 3; k++) {
        p[k] = test_uniform(random, -spread, spread);
        d[k] = test_uniform(random, 0, size);
    }
    struct vec3 min = {p[0], p[1], p[2]};
    return (struct box){min, vec3_add(min, vec3_make(d[0], d[1], d[2]))};
}

static struct ray ray_to(struct vec3 from, struct vec3 to) {
    return (struct ray){.origin = from, .direction = vec3_sub(to, from), .t_max = INFINITY};
}

static bool offers(const struct kd_tree *tree, const struct ray *ray, uint32_t item) {
    struct kd_traversal traversal;
    kd_traversal_begin(&traversal, tree, ray, 0);
    while (kd_traversal_next(&traversal, ray->t_max))
        for (uint32_t i = 0; i < traversal.count; i++)
            if (traversal.items[i] == item)
                return true;
    return false;
}

TEST(kd_tree_of_nothing_offers_nothing) {
    struct kd_tree tree;
    struct error error;
    struct box empty[3] = {box_empty(), box_empty(), box_empty()};
    struct ray ray = ray_to(vec3_all(0), vec3_make(0, 0, 1));
    struct kd_traversal traversal;
    for (uint32_t count = 0; count <= 3; count += 3) {
        CHECK(kd_tree_build(&tree, &(struct kd_items){empty, count, NULL, NULL}, NULL, &error));
        kd_traversal_begin(&traversal, &tree, &ray, 0);
        CHECK(!kd_traversal_next(&traversal, INFINITY));
        kd_tree_destroy(&tree);
    }
}

TEST(kd_tree_loses_no_points_and_no_flats_at_extreme_sizes) {
    const double scales[] = {1e-150, 1e-30, 1, 1e30, 1e140};
    struct error error;
    for (int k = 0; k < 5; k++)
        for (int shape = 0; shape < 4; shape++) {
            double s = scales[k];
            struct box boxes[64];
            for (uint32_t i = 0; i < 64; i++) {
                struct vec3 p = {s * (i % 4), s * (i / 4 % 4), s * (i / 16)};
                if (shape == 1) /* all in one point */
                    p = vec3_make(s, -s, s);
                if (shape == 2) /* in a plane */
                    p.z = 7 * s;
                if (shape == 3) /* in a line */
                    p.y = p.z = 0;
                boxes[i] = (struct box){p, p};
            }
            struct kd_tree tree;
            CHECK(kd_tree_build(&tree, &(struct kd_items){boxes, 64, NULL, NULL}, NULL, &error));
            for (uint32_t i = 0; i < 64; i++) {
                /* Rays along an axis meet the points exactly. */
                struct vec3 p = boxes[i].min, aside = vec3_make(0, 0, 8 * s);
                struct ray ray = {.origin = vec3_sub(p, aside), .direction = {0, 0, s}, .t_max = INFINITY};
                CHECK(offers(&tree, &ray, i));
                ray.direction.z = -s;
                ray.origin = vec3_add(p, aside);
                CHECK(offers(&tree, &ray, i));
            }
            kd_tree_destroy(&tree);
        }
}

TEST(kd_tree_offers_unbounded_items_to_every_ray) {
    struct error error;
    struct box boxes[4];
    for (uint32_t i = 0; i < 4; i++)
        boxes[i] = (struct box){vec3_all(i), vec3_all(i + 0.5)};
    boxes[2].max.y = INFINITY;
    struct kd_tree tree;
    CHECK(kd_tree_build(&tree, &(struct kd_items){boxes, 4, NULL, NULL}, NULL, &error));
    struct ray miss = ray_to(vec3_all(-10), vec3_make(-10, -20, -10)), hit = ray_to(vec3_all(-1), vec3_all(1));
    CHECK(offers(&tree, &miss, 2) && !offers(&tree, &miss, 0));
    CHECK(offers(&tree, &hit, 0) && offers(&tree, &hit, 1) && offers(&tree, &hit, 2) && offers(&tree, &hit, 3));
    kd_tree_destroy(&tree);
}

TEST(kd_tree_of_small_items_offers_few_of_them) {
    enum { ITEMS = 20000, RAYS = 2000 };
    struct test_random random = {1};
    struct error error;
    struct box *boxes = malloc(ITEMS * sizeof *boxes);
    for (int i = 0; i < ITEMS; i++)
        boxes[i] = small_box(&random, 10, 0.1);
    struct kd_tree tree;
    CHECK(kd_tree_build(&tree, &(struct kd_items){boxes, ITEMS, NULL, NULL}, NULL, &error));
    uint64_t offered = 0, steps = 0;
    for (int i = 0; i < RAYS; i++) {
        struct vec3 from = small_box(&random, 30, 1).min, to = small_box(&random, 10, 1).min;
        struct ray ray = ray_to(from, to);
        struct kd_traversal traversal;
        kd_traversal_begin(&traversal, &tree, &ray, 0);
        while (kd_traversal_next(&traversal, INFINITY))
            offered += traversal.count;
        steps += traversal.steps;
    }
    /* A ray of length 20 comes near about 20000 * 0.01 / 400 * 20 boxes. */
    CHECK(offered < (uint64_t)RAYS * 60);
    CHECK(steps < (uint64_t)RAYS * 400);
    kd_tree_destroy(&tree);
    free(boxes);
}

TEST(kd_tree_over_items_that_all_overlap_stays_small) {
    enum { ITEMS = 5000 };
    struct test_random random = {2};
    struct error error;
    struct box *boxes = malloc(ITEMS * sizeof *boxes);
    for (int i = 0; i < ITEMS; i++)
        boxes[i] = (struct box){vec3_sub(vec3_all(-10), small_box(&random, 1, 1).min),
                                vec3_add(vec3_all(10), small_box(&random, 1, 1).min)};
    struct kd_tree tree;
    CHECK(kd_tree_build(&tree, &(struct kd_items){boxes, ITEMS, NULL, NULL}, NULL, &error));
    CHECK(kd_tree_memory(&tree) < 400 * (size_t)ITEMS);
    kd_tree_destroy(&tree);
    free(boxes);
}

TEST(kd_tree_is_the_same_after_scaling_by_powers_of_two) {
    enum { ITEMS = 3000 };
    const int exponents[] = {-100, -3, 40, 200};
    struct test_random random = {3};
    struct error error;
    struct box boxes[ITEMS], scaled[ITEMS];
    for (int i = 0; i < ITEMS; i++)
        boxes[i] = small_box(&random, 10, 1);
    struct kd_tree tree, other;
    CHECK(kd_tree_build(&tree, &(struct kd_items){boxes, ITEMS, NULL, NULL}, NULL, &error));
    for (int e = 0; e < 4; e++) {
        double s = ldexp(1, exponents[e]);
        for (int i = 0; i < ITEMS; i++)
            scaled[i] = (struct box){vec3_scale(boxes[i].min, s), vec3_scale(boxes[i].max, s)};
        CHECK(kd_tree_build(&other, &(struct kd_items){scaled, ITEMS, NULL, NULL}, NULL, &error));
        CHECK_EQ_INT(tree.node_count, other.node_count);
        CHECK_EQ_INT(tree.entry_count, other.entry_count);
        for (uint32_t i = 0; i < tree.node_count; i++) {
            CHECK(tree.nodes[i].axis == other.nodes[i].axis && tree.nodes[i].offset == other.nodes[i].offset);
            CHECK(tree.nodes[i].axis == KD_LEAF || tree.nodes[i].split * s == other.nodes[i].split);
        }
        kd_tree_destroy(&other);
    }
    kd_tree_destroy(&tree);
}
