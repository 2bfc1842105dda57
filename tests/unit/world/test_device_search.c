/* The search of devices finds the bits of every other search, in meshes that are hard for hierarchies. Worlds with all
 * kinds of shapes are in test_world.c. */
#include "base/fault.h"
#include "tests/stage.h"
#include "tests/unit/mesh_makers.h"
#include "world/device_search.h"

enum { GROWING = 150 };

/* Each triangle contains the one before, as seen along z: splits by area take one at a time. */
static void growing_triangles(struct maker *m, double factor) {
    for (int i = 0; i < GROWING; i++) {
        const double r = pow(factor, i - GROWING / 2.0), z = i % 3 ? 0.1 * r : 0;
        const uint32_t a = maker_vertex(m, -r, -r, z), b = maker_vertex(m, r, -r, z);
        maker_triangle(m, a, b, maker_vertex(m, 0.1 * r, r, -z));
    }
}

/* The same triangles several times, and some without area. */
static void coincident_triangles(struct maker *m, struct test_random *random) {
    maker_soup(m, SOUP_LATTICE, 60, random);
    for (uint32_t i = 0; i < 180; i += 3)
        for (int k = 0; k < 2; k++)
            maker_triangle(m, i, i + 1 + (uint32_t)k, k ? i + 1 : i + 2);
    maker_triangle(m, 0, 1, 1);
    const uint32_t a = maker_vertex(m, 0, 0, 0), b = maker_vertex(m, 1, 1, 1);
    maker_triangle(m, a, b, maker_vertex(m, 0.5, 0.5, 0.5));
}

static void make(struct maker *m, int kind, struct test_random *random) {
    static const uint32_t counts[] = {1, 4, 5, 60, 300};
    if (kind < SOUP_KINDS)
        maker_soup(m, (enum soup)kind, counts[(int)test_uniform(random, 0, 4.99)], random);
    else if (kind < SOUP_KINDS + 2)
        growing_triangles(m, kind == SOUP_KINDS ? 1.04 : 1.3);
    else if (kind == SOUP_KINDS + 2)
        maker_sphere(m, 7);
    else
        coincident_triangles(m, random);
}
enum { MESH_KINDS = SOUP_KINDS + 4 };

/* The mesh in the world, three times: the second time it has a hierarchy of its own; and with other maps. */
static void add_meshes(struct stage *s, struct mesh *mesh, struct test_random *random, double size) {
    const struct material *material = stage_phong(s, colour_all(0.5), colour_all(0), 1);
    for (int i = 0; i < 6; i++) {
        struct node *node = scene_node(&s->scene, NODE_GEOMETRY, "mesh", &s->error);
        node->shape = (struct shape){.kind = SHAPE_MESH, .mesh = mesh};
        node->material = material;
        node->cull = i == 2 ? CULL_BACK : CULL_NONE;
        if (i > 2) {
            stage_scale(s, node, 1, test_uniform(random, 0.3, 2), 1);
            stage_rotate(s, node, 2, i == 4 ? 90 : test_uniform(random, -90, 90));
            stage_move(s, node, size * test_uniform(random, -1, 1), i == 4 ? 0 : size, 0);
        }
        CHECK(node_add_child(&s->scene, s->root, node, &s->error));
    }
}

static bool same_bits(double a, double b) {
    return memcmp(&a, &b, sizeof a) == 0;
}

/* What the ray meets in two worlds; `out` is what it meets. */
static bool agree(const struct world *a, const struct world *b, const struct ray *ray, struct world_scratch *scratch,
                  struct crossing *out) {
    struct crossing x = {0}, y = {0};
    uint32_t of_x = WORLD_NOTHING, of_y = WORLD_NOTHING;
    const bool met = world_nearest_crossing(a, ray, scratch, &of_x, &x);
    bool same = world_nearest_crossing(b, ray, scratch, &of_y, &y) == met && world_any(b, ray, scratch) == met;
    if (met)
        same = same && of_x == of_y && same_bits(x.t, y.t) && same_bits(x.u, y.u) && same_bits(x.v, y.v) &&
               x.part == y.part && x.enter == y.enter && x.flip == y.flip && x.leaf == y.leaf;
    *out = x;
    out->leaf = met;
    return same;
}

TEST_TIMES(the_search_of_devices_finds_in_any_meshes_what_tests_of_all_triangles_find, 20) {
    static const double scales[] = {1, 1e-3, 1e7, 1e-25, 1e25, 1e-42, 1e42, 1e-90, 1e90};
    struct test_random random = {6};
    uint64_t hits = 0, wrong = 0;
    for (int round = 0; round < 9 * MESH_KINDS * times; round++) {
        const double scale = scales[round / MESH_KINDS % 9];
        struct maker m = {0};
        struct stage s;
        struct device_search search;
        struct world_scratch scratch;
        make(&m, round % MESH_KINDS, &random);
        maker_scale(&m, scale, round % 5 == 0 ? 100 * scale : 0, 0, 0);
        struct mesh *mesh = maker_mesh(&m);
        stage_begin(&s, 1);
        add_meshes(&s, mesh, &random, scale);
        CHECK(stage_build(&s, s.root, ACCEL_AUTO) && device_search_build(&search, &s.world, s.pool, &s.error));
        CHECK(world_scratch_init(&scratch, &s.world));
        const struct world device = device_search_world(&search, &s.world);
        struct world brute = s.world;
        brute.accel.kind = brute.mesh_accel = ACCEL_NONE;
        brute.group.index = NULL;
        for (int i = 0; i < 150; i++) {
            struct ray ray = test_any_ray(&m, mesh, &random);
            struct crossing met;
            if (i % 16 == 15) /* as long or as short as no unit vector */
                ray.direction = vec3_scale(ray.direction, i % 32 == 15 ? 1e60 : 1e-60);
            bool same = agree(&brute, &device, &ray, &scratch, &met);
            hits += met.leaf;
            /* Skips, of triangles that the ray would hit. */
            if (met.leaf && i % 2) {
                ray.skip_primitive = 1 + (uint32_t)test_uniform(&random, 0, 5.99);
                ray.skip_part = i % 4 == 1 ? 0 : 1 + met.part;
                same = agree(&s.world, &device, &ray, &scratch, &met) && same;
            }
            wrong += !same;
            if (!same && wrong < 5)
                test_fail(__FILE__, __LINE__, "round %d, ray %d", round, i);
        }
        world_scratch_destroy(&scratch);
        device_search_destroy(&search);
        stage_end(&s);
        mesh_release(mesh);
        maker_free(&m);
    }
    CHECK(hits > 5000 * (uint64_t)times);
    CHECK_EQ_INT(wrong, 0);
}

struct visit {
    const struct float_trees *trees;
    const struct box *boxes;
    uint8_t *seen;
    int deepest;
    bool inside;
};

static bool lies_in(const float outer[6], const struct box *box) {
    const struct box wide = {{outer[0], outer[1], outer[2]}, {outer[3], outer[4], outer[5]}};
    return box_contains(&wide, box->min) && box_contains(&wide, box->max);
}

/* parent_box: NULL for the root. */
static void visit(struct visit *v, uint32_t reference, const float *parent_box, int depth) {
    v->deepest = depth > v->deepest ? depth : v->deepest;
    if (!(reference & FLOAT_TREE_LEAF)) {
        const struct float_node *node = &v->trees->nodes[reference];
        for (int k = 0; k < 2; k++) {
            const float *box = node->box[k];
            for (int i = 0; i < 3 && parent_box; i++)
                v->inside = v->inside && box[i] >= parent_box[i] && box[3 + i] <= parent_box[3 + i];
            visit(v, node->child[k], box, depth + 1);
        }
        return;
    }
    const bool is_single = reference & FLOAT_TREE_SINGLE;
    const uint32_t low = reference & (FLOAT_TREE_MANY - 1);
    const uint32_t count = is_single ? 1 : (reference >> FLOAT_TREE_RUN_SHIFT & (FLOAT_TREE_RUN - 1)) + 1;
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t item = is_single ? low : v->trees->order[low + i];
        v->seen[item]++;
        v->inside = v->inside && (!parent_box || lies_in(parent_box, &v->boxes[item]));
    }
}

/* Sizes grow by one factor, so that splits alone would give a chain; some boxes are infinite, and some empty. */
TEST(hierarchies_in_single_precision_have_every_item_once_in_boxes_that_contain_it_and_are_never_too_deep) {
    enum { ITEMS = 3000 };
    static struct box boxes[ITEMS];
    static const double factors[] = {1, 1.2, 0.93, 2};
    char warning[256];
    struct pool *pool = pool_create(1, warning);
    struct test_random random = {3};
    for (int round = 0; round < 40; round++) {
        const uint32_t count = round % 5 ? 1 + (uint32_t)test_uniform(&random, 0, round % 2 ? 9 : ITEMS - 1) : ITEMS;
        struct float_trees trees = {0};
        struct error error = {0};
        uint32_t roots[2];
        double size = 1;
        for (uint32_t i = 0; i < count; i++) {
            struct vec3 p = vec3_scale(test_point(&random, 1), size);
            boxes[i] = (struct box){p, vec3_add(p, vec3_all(size * test_uniform(&random, 0, 1)))};
            if (i % 97 == 96)
                boxes[i].max.x = INFINITY;
            if (i % 101 == 100)
                boxes[i] = box_empty();
            size = i % 500 == 499 ? 1 : size * factors[round % 4];
        }
        const struct float_tree_items items = {boxes, count, round % 3 == 0 ? count / 2 : 0};
        for (int k = 0; k < 2; k++) {
            static uint8_t seen[ITEMS];
            struct visit v = {&trees, boxes, seen, 0, true};
            memset(seen, 0, sizeof seen);
            CHECK(float_trees_add(&trees, &items, pool, &roots[k], &error));
            visit(&v, roots[k], NULL, 0);
            CHECK(v.inside);
            CHECK(v.deepest <= FLOAT_TREE_DEPTH);
            for (uint32_t i = 0; i < count; i++)
                CHECK_EQ_INT(seen[i], i % 101 != 100);
        }
        float_trees_destroy(&trees);
    }
    pool_destroy(pool);
}

#ifdef GRAY_FAULTS
TEST(the_search_of_devices_survives_any_allocation_that_fails) {
    struct test_random random = {2};
    struct maker m = {0};
    struct stage s;
    bool done = false;
    int failed = 0;
    make(&m, SOUP_EVEN, &random);
    struct mesh *mesh = maker_mesh(&m);
    stage_begin(&s, 2);
    add_meshes(&s, mesh, &random, 1);
    CHECK(stage_build(&s, s.root, ACCEL_AUTO));
    for (uint64_t k = 1; !done; k++) {
        struct error error = {0};
        struct device_search search;
        fault_at(FAULT_OF_ALLOCATION, k);
        done = device_search_build(&search, &s.world, s.pool, &error);
        fault_at(FAULT_OF_ALLOCATION, 0);
        CHECK(done || error.kind == ERROR_MACHINE);
        failed += !done;
        pool_reset_cancel(s.pool);
        device_search_destroy(&search);
    }
    CHECK(failed > 8);
    stage_end(&s);
    mesh_release(mesh);
    maker_free(&m);
}
#endif
