/* What a frame takes over from the frame before: the accelerator, with other boxes. */
#include "tests/harness.h"
#include "tests/stage.h"
#include "world/world.h"

#include <math.h>
#include <string.h>

static bool build(struct stage *s, const struct node *root, struct accel_cache *cache, struct arena *arena,
                  struct world *out) {
    const struct sky sky = {.kind = SKY_GRADIENT};
    const struct world_input input = {.scene = &s->scene, .root = root, .sky = &sky, .cache = cache};
    return world_build(out, &input, arena, s->pool, &s->error);
}

static struct ray random_ray(struct test_random *random) {
    struct vec3 from = {test_uniform(random, -20, 20), test_uniform(random, -20, 20), test_uniform(random, -20, 20)};
    struct vec3 to = {test_uniform(random, -10, 10), test_uniform(random, -10, 10), test_uniform(random, -10, 10)};
    return (struct ray){.origin = from, .direction = vec3_sub(to, from), .t_min = 0, .t_max = INFINITY};
}

/* How many of the rays meet something else. */
static int differences(const struct world *a, const struct world *b, struct test_random *random) {
    enum { RAYS = 40 };
    struct ray rays[RAYS];
    struct hit of_a[RAYS], of_b[RAYS];
    bool met_a[RAYS], met_b[RAYS];
    struct world_scratch scratch_a, scratch_b;
    int wrong = 0;
    CHECK(world_scratch_init(&scratch_a, a) && world_scratch_init(&scratch_b, b));
    for (int i = 0; i < RAYS; i++)
        rays[i] = random_ray(random);
    world_nearest_batch(a, rays, RAYS, &scratch_a, of_a);
    world_nearest_batch(b, rays, RAYS, &scratch_b, of_b);
    world_any_batch(a, rays, RAYS, &scratch_a, met_a);
    world_any_batch(b, rays, RAYS, &scratch_b, met_b);
    for (int i = 0; i < RAYS; i++) {
        struct hit single;
        bool hit = of_b[i].primitive != WORLD_NOTHING;
        bool same = of_a[i].primitive == of_b[i].primitive && met_a[i] == met_b[i] && met_a[i] == hit &&
                    world_nearest(a, &rays[i], &scratch_a, &single) == hit;
        wrong += !same || (hit && (of_a[i].t != of_b[i].t || single.t != of_b[i].t ||
                                   memcmp(&of_a[i].normal, &of_b[i].normal, sizeof of_a[i].normal) != 0));
    }
    world_scratch_destroy(&scratch_a);
    world_scratch_destroy(&scratch_b);
    return wrong;
}

static struct node *add_ball(struct stage *s, struct node *root, double radius) {
    struct node *node = scene_node(&s->scene, NODE_GEOMETRY, "ball", &s->error);
    node->shape.kind = SHAPE_SPHERE;
    node->shape.sphere.radius = radius;
    CHECK(node_add_child(&s->scene, root, node, &s->error));
    return node;
}

static void put(struct stage *s, struct node *node, struct test_random *random, double spread) {
    struct transform to =
        transform_translate(vec3_make(test_uniform(random, -spread, spread), test_uniform(random, -spread, spread),
                                      test_uniform(random, -spread, spread)));
    node_reset_transform(node);
    CHECK(node_transform(&s->scene, node, NODE_TRANSLATE, &to));
}

TEST(a_refitted_world_answers_as_a_new_one_over_a_thousand_random_moves) {
    enum { BALLS = 400, MOVES = 1000, ROOM = BALLS + MOVES };
    static struct node *balls[ROOM];
    struct test_random random = {20};
    struct accel_cache cache = {0};
    struct arena arena_of_a = {0}, arena_of_b = {0};
    struct world a, b;
    struct stage s;
    int count = BALLS, refitted = 0, rebuilt = 0, wrong = 0;
    stage_begin(&s, 2);
    struct node *root = scene_node(&s.scene, NODE_GROUP, "root", &s.error);
    for (int i = 0; i < BALLS; i++) {
        balls[i] = add_ball(&s, root, test_uniform(&random, 0.1, 0.8));
        put(&s, balls[i], &random, 10);
    }
    for (int move = 0; move < MOVES; move++) {
        /* One ball, a few of them, all a little, one far away, or one more. */
        int kind = (int)test_uniform(&random, 0, 40), moved = kind < 30 ? 1 : kind < 36 ? 20 : kind == 36 ? count : 0;
        for (int i = 0; i < moved; i++)
            put(&s, balls[(int)test_uniform(&random, 0, count)], &random, kind == 36 ? 5 : 10);
        if (kind == 37)
            put(&s, balls[0], &random, 1e4);
        if (kind == 38) {
            balls[count] = add_ball(&s, root, 0.5);
            put(&s, balls[count++], &random, 10);
        }
        const struct box_tree_node *kept = cache.accel.tree.nodes;
        if (!build(&s, root, &cache, &arena_of_a, &a) || !build(&s, root, NULL, &arena_of_b, &b)) {
            test_fail(__FILE__, __LINE__, "%s", s.error.text);
            break;
        }
        refitted += kept && a.accel.tree.nodes == kept;
        rebuilt += !kept || a.accel.tree.nodes != kept;
        wrong += differences(&a, &b, &random);
        world_keep_accel(&a, &cache);
        world_destroy(&a);
        world_destroy(&b);
        arena_reset(&arena_of_a);
        arena_reset(&arena_of_b);
    }
    CHECK_EQ_INT(wrong, 0);
    CHECK(refitted > MOVES / 2);
    CHECK(rebuilt > 10);
    accel_cache_destroy(&cache);
    arena_destroy(&arena_of_a);
    arena_destroy(&arena_of_b);
    stage_end(&s);
}

/* Each node's box is exactly that of its items: the same sum of areas as of boxes found by looking at all items below.
 */
TEST(a_refitted_hierarchy_has_the_boxes_of_its_items) {
    enum { COUNT = 3000 };
    static struct box boxes[COUNT];
    struct test_random random = {7};
    struct box_tree tree;
    struct error error;
    struct stage s;
    stage_begin(&s, 1);
    for (int round = 0; round < 2; round++) {
        struct box all = box_empty();
        for (int i = 0; i < COUNT; i++) {
            struct vec3 at = {test_uniform(&random, -9, 9), test_uniform(&random, -9, 9), test_uniform(&random, -9, 9)};
            boxes[i] = (struct box){at, vec3_add(at, vec3_all(test_uniform(&random, 0, 1)))};
            if (i % 100 == 99)
                boxes[i] = box_empty();
            else
                all = box_join(all, boxes[i]);
        }
        if (round == 0)
            CHECK(box_tree_build(&tree, boxes, COUNT, s.pool, &error));
        else
            box_tree_refit(&tree, boxes);
        CHECK(memcmp(&all, &tree.bounds, sizeof all) == 0);
        uint32_t items = 0;
        for (uint32_t n = 0; n < tree.node_count; n++) {
            for (int k = 0; k < BOX_TREE_WIDTH; k++) {
                uint32_t child = tree.nodes[n].child[k];
                struct box in_parent, own = box_empty();
                in_parent.min = vec3_make(tree.nodes[n].planes[0][0][k], tree.nodes[n].planes[1][0][k],
                                          tree.nodes[n].planes[2][0][k]);
                in_parent.max = vec3_make(tree.nodes[n].planes[0][1][k], tree.nodes[n].planes[1][1][k],
                                          tree.nodes[n].planes[2][1][k]);
                if (child == BOX_TREE_NONE)
                    continue;
                if (child & BOX_TREE_ITEM) {
                    own = boxes[child & ~BOX_TREE_ITEM];
                    items++;
                }
                for (int j = 0; !(child & BOX_TREE_ITEM) && j < BOX_TREE_WIDTH; j++) {
                    const struct box_tree_node *below = &tree.nodes[child];
                    CHECK(child > n);
                    for (int axis = 0; below->child[j] != BOX_TREE_NONE && axis < 3; axis++) {
                        double *low = &own.min.x + axis, *high = &own.max.x + axis;
                        *low = fmin(*low, below->planes[axis][0][j]);
                        *high = fmax(*high, below->planes[axis][1][j]);
                    }
                }
                CHECK(memcmp(&own, &in_parent, sizeof own) == 0);
            }
        }
        CHECK_EQ_INT(items, COUNT - COUNT / 100);
    }
    box_tree_destroy(&tree);
    stage_end(&s);
}
