/* Flattening, paths, lists of lights, picking and bounds against a simple recursion over the same graph: random graphs
 * with placements, shared nodes, combined, clipped and bounded ones. */
#include "inspect/pick.h"
#include "scene/node_bounds.h"
#include "scene/traversal.h"
#include "tests/harness.h"
#include "tests/stage.h"
#include "world/mesh_lights_internal.h"
#include "world/node_path.h"

#include <stdio.h>
#include <string.h>

enum { NODES = 1000, PATHS = 6000, PATH_TEXT = 400, DEEP = 40 };

/* The end of one path, in the order of the traversal. */
struct expected {
    const struct node *node;
    char text[PATH_TEXT];
    struct transform map;
    bool listed;
};

struct forest {
    struct stage stage;
    struct test_random random;
    const struct material *material;
    struct node *nodes[NODES];
    uint32_t count;
    const struct node *list[3];
    struct expected expected[PATHS];
    uint32_t expected_count;
};

static double pick(struct forest *f, double low, double high) {
    return test_uniform(&f->random, low, high);
}

static struct node *keep(struct forest *f, struct node *node) {
    struct stage *s = &f->stage;
    CHECK(f->count < NODES);
    stage_scale(s, node, pick(f, 0.5, 1), pick(f, 0.5, 1), pick(f, 0.5, 1));
    stage_rotate(s, node, (int)pick(f, 0, 2.99), pick(f, -90, 90));
    stage_move(s, node, pick(f, -1, 1), pick(f, -1, 1), pick(f, -1, 1));
    node->singular = pick(f, 0, 1) < 0.03;
    f->nodes[f->count++] = node;
    return node;
}

static struct node *shape(struct forest *f) {
    struct node *node = scene_node(&f->stage.scene, NODE_GEOMETRY, "shape", &f->stage.error);
    node->shape = pick(f, 0, 1) < 0.5 ? (struct shape){.kind = SHAPE_SPHERE, .sphere = {{0, 0, 0}, 0.5}}
                                      : (struct shape){.kind = SHAPE_BOX, .box = {{-0.4, -0.3, -0.5}, {0.5, 0.4, 0.3}}};
    node->material = f->material;
    return keep(f, node);
}

static struct node *solid(struct forest *f, int depth) {
    if (depth == 0 || pick(f, 0, 1) < 0.4)
        return shape(f);
    struct node *operands[3] = {solid(f, depth - 1), solid(f, depth - 1), solid(f, depth - 1)};
    enum node_csg operation = (enum node_csg)pick(f, 0, NODE_DIFFERENCE + 0.99);
    struct node *node =
        scene_combine(&f->stage.scene, "solid", operation, operands, 2 + (pick(f, 0, 1) < 0.3), &f->stage.error);
    if (pick(f, 0, 1) < 0.2)
        CHECK(node_add_child(&f->stage.scene, node, shape(f), &f->stage.error));
    return keep(f, node);
}

/* A bound that contains everything: its claim is true. */
static struct node *large_ball(struct forest *f) {
    struct node *node = scene_node(&f->stage.scene, NODE_GEOMETRY, "ball", &f->stage.error);
    node->shape = (struct shape){.kind = SHAPE_SPHERE, .sphere = {{0, 0, 0}, 100}};
    return node;
}

static struct node *grow(struct forest *f, int depth) {
    struct stage *s = &f->stage;
    double what = pick(f, 0, 1);
    if (f->count > 4 && what < 0.15) /* shared with another parent */
        return f->nodes[(uint32_t)pick(f, 0, f->count - 0.01)];
    if (depth == 0 || what < 0.3)
        return shape(f);
    if (what < 0.45)
        return solid(f, 2);
    struct node *node;
    if (what < 0.6) {
        bool clipped = pick(f, 0, 1) < 0.5;
        struct node *operands[2] = {grow(f, depth - 1), clipped ? shape(f) : large_ball(f)};
        node = scene_combine(&s->scene, clipped ? "clipped" : "bounded", clipped ? NODE_CLIPPED : NODE_BOUNDED,
                             operands, 2, &s->error);
    } else {
        static const double at[2][3] = {{-0.7, 0.2, 0}, {0.6, 0, 0.3}};
        static const struct placements lists[3] = {{.count = 2, .at = at}, {.count = 1, .at = at}, {.count = 0}};
        node = scene_node(&s->scene, NODE_GROUP, "group", &s->error);
        if (pick(f, 0, 1) < 0.4)
            node->placements = &lists[(int)pick(f, 0, 2.3)];
    }
    for (int i = (int)pick(f, 0, 2.99); i > 0; i--)
        CHECK(node_add_child(&s->scene, node, grow(f, depth - 1), &s->error));
    return keep(f, node);
}

/* The simple recursion. */
static void expect(struct forest *f, const struct node *node, const struct transform *above, const char *path,
                   bool listed) {
    char text[PATH_TEXT], below[PATH_TEXT];
    if (node->singular)
        return;
    for (int i = 0; i < 3; i++)
        listed = listed || f->list[i] == node;
    struct transform own = node_parent_from_node(node), map = transform_compose(above, &own);
    int length = snprintf(text, sizeof text, "%s%s#%u", path, node->name, node->serial);
    CHECK(length > 0 && (size_t)length + 20 < sizeof text && f->expected_count < PATHS);
    bool placing = node->kind == NODE_CSG && node->operation >= NODE_CLIPPED;
    if (node->kind == NODE_GEOMETRY || (node->kind == NODE_CSG && !placing)) {
        struct expected *e = &f->expected[f->expected_count++];
        *e = (struct expected){.node = node, .map = map, .listed = listed};
        memcpy(e->text, text, (size_t)length + 1);
    }
    (void)snprintf(below, sizeof below, "%.380s / ", text);
    if (placing)
        expect(f, node->operands[0], &map, below, listed);
    for (uint32_t i = 0; i < (node->placements ? node->placements->count : 1); i++) {
        struct transform of_children = map;
        if (node->placements) {
            struct transform step = placement_transform(node->placements, i);
            of_children = transform_compose(&map, &step);
            (void)snprintf(below, sizeof below, "%.370s [%u] / ", text, i + 1);
        }
        for (const struct node_child *child = node->first_child; child; child = child->next)
            expect(f, child->node, &of_children, below, listed);
    }
}

static bool plant(struct forest *f, uint64_t seed) {
    struct stage *s = &f->stage;
    stage_begin(s, 1);
    f->random = (struct test_random){seed};
    f->count = f->expected_count = 0;
    f->material = stage_phong(s, colour_all(0.5), colour_all(0), 1);
    for (int i = 0; i < 16; i++)
        CHECK(node_add_child(&s->scene, s->root, grow(f, 4), &s->error));
    for (int i = 0; i < 3; i++)
        f->list[i] = f->nodes[(uint32_t)pick(f, 0, f->count - 0.01)];
    struct transform ground = transform_identity();
    expect(f, s->root, &ground, "", false);
    if (stage_build(s, s->root, ACCEL_AUTO))
        return true;
    test_fail(__FILE__, __LINE__, "%s", s->error.text);
    return false;
}

static bool note_texts(void *context, uint32_t first, uint32_t count, const struct scene_step *steps, uint32_t depth) {
    char(*texts)[PATH_TEXT] = context;
    for (uint32_t i = first; i < first + count; i++)
        (void)node_path_text(steps, depth, texts[i], PATH_TEXT);
    return true;
}

static double difference(const struct affine *a, const struct affine *b) {
    double largest = 0;
    for (int i = 0; i < 12; i++)
        largest = fmax(largest, fabs(a->m[i / 4][i % 4] - b->m[i / 4][i % 4]));
    return largest;
}

/* Solids may be empty or consist of disjoint parts: then a path has no primitive, or several in a row. */
static void check_forest(struct forest *f, uint32_t *primitive, uint32_t *shared) {
    struct world *world = &f->stage.world;
    static char texts[PATHS][PATH_TEXT];
    static uint8_t listed[PATHS];
    CHECK(world->primitive_count <= PATHS);
    memset(listed, 0, sizeof listed);
    CHECK(world_visit_node_paths(world, f->stage.root, note_texts, texts, &f->stage.error));
    CHECK(light_lists_mark(world, f->list, 3, listed, 1, f->stage.root));
    uint32_t next = 0;
    for (uint32_t i = 0; i < f->expected_count; i++) {
        const struct expected *e = &f->expected[i];
        uint32_t parts = world_primitives_of(world, e->node, next);
        /* An empty solid followed by the same node on another path has no primitive: the texts distinguish them. */
        if (parts == 0 || (e->node->kind == NODE_CSG && strcmp(texts[next], e->text) != 0))
            continue;
        for (uint32_t k = next; k < next + parts; k++) {
            struct transform map = world_placement(world, k, 0);
            CHECK(primitive_node(world, k) == e->node);
            CHECK_TEXT(texts[k], e->text);
            CHECK(difference(&map.forward, &e->map.forward) < 1e-12);
            CHECK_EQ_INT(listed[k], e->listed);
            *shared += e->listed;
        }
        next += parts;
    }
    CHECK_EQ_INT(next, world->primitive_count);
    *primitive += next;
}

TEST(flattening_paths_and_lists_of_lights_follow_one_order_on_random_graphs) {
    static struct forest f;
    uint32_t primitive = 0, listed = 0;
    for (uint64_t seed = 1; seed <= 60; seed++) {
        if (plant(&f, seed))
            check_forest(&f, &primitive, &listed);
        stage_end(&f.stage);
    }
    CHECK(primitive > 1000 && listed > 100 && listed < primitive);
}

static bool in_box(const struct box *box, struct vec3 p) {
    struct vec3 slack = vec3_all(1e-9);
    struct box wide = {vec3_sub(box->min, slack), vec3_add(box->max, slack)};
    return box_contains(&wide, p);
}

TEST(picking_names_the_path_of_what_a_ray_meets_and_no_ray_meets_anything_outside_of_the_bounds) {
    static struct forest f;
    static char texts[PATHS][PATH_TEXT];
    int hits = 0;
    for (uint64_t seed = 100; seed < 130; seed++) {
        struct stage *s = &f.stage;
        struct world_scratch scratch;
        struct box bounds;
        if (!plant(&f, seed))
            continue;
        CHECK(node_bounds(s->root, &bounds, &s->error));
        CHECK(world_visit_node_paths(&s->world, s->root, note_texts, texts, &s->error));
        CHECK(world_scratch_init(&scratch, &s->world));
        const struct render_job job = {
            .world = &s->world, .camera = s->camera, .settings = s->settings, .width = 64, .height = 64};
        for (int i = 0; i < 150; i++) {
            double x = pick(&f, 16, 48), y = pick(&f, 16, 48);
            struct picked picked;
            struct hit hit;
            CHECK(pick_at(&job, s->root, (struct pick_query){x, y, 0}, &picked, &s->error));
            if (!picked.hit)
                continue;
            struct vec3 eye = vec3_make(0, 0, 10);
            struct ray ray = {.origin = eye, .direction = vec3_sub(picked.position, eye), .t_max = INFINITY};
            CHECK(world_nearest(&s->world, &ray, &scratch, &hit));
            CHECK(in_box(&bounds, picked.position));
            if (vec3_length(vec3_sub(hit.point, picked.position)) > 1e-9)
                continue; /* at an edge */
            hits++;
            CHECK_TEXT(picked.node_path, texts[hit.primitive]);
            CHECK_EQ_INT(picked.serial, primitive_node(&s->world, hit.primitive)->serial);
        }
        world_scratch_destroy(&scratch);
        stage_end(s);
    }
    CHECK(hits > 500);
}

TEST(paths_inside_of_solids_lead_to_the_shapes_that_flattening_made_leaves_of) {
    static struct forest f;
    int leaves = 0;
    for (uint64_t seed = 200; seed < 240; seed++) {
        struct scene_step steps[DEEP];
        if (!plant(&f, seed))
            continue;
        const struct world *world = &f.stage.world;
        for (uint32_t i = 0; i < world->primitive_count; i++) {
            const struct csg *whole = primitive_geometry(world, i)->csg;
            const struct node *node = primitive_node(world, i);
            for (uint32_t k = 0; whole && node->kind == NODE_CSG && k < whole->leaf_count; k++) {
                const struct csg_leaf *leaf = &whole->leaves[k];
                uint32_t depth;
                CHECK(world_operand_path(node, leaf->origin, steps, DEEP, &depth));
                if (depth == 0) /* of a clip, which is no part of the node */
                    continue;
                const struct node *last = steps[depth - 1].node;
                CHECK(last->kind == NODE_GEOMETRY && memcmp(&last->shape, &leaf->shape, sizeof leaf->shape) == 0);
                leaves++;
            }
        }
        stage_end(&f.stage);
    }
    CHECK(leaves > 300);
}

/* Each level is the only child, or the only operand, of the next. */
TEST(a_traversal_of_a_hundred_thousand_levels_needs_no_stack_of_the_machine) {
    enum { LEVELS = 100000 };
    struct stage s;
    stage_begin(&s, 1);
    struct node *top = stage_group(&s, s.root), *bottom = top;
    for (int i = 0; i < LEVELS; i++) {
        struct node *operands[2] = {top, top};
        struct node *node = i % 2 ? scene_combine(&s.scene, "level", NODE_UNION, operands, 1, &s.error)
                                  : scene_node(&s.scene, NODE_GROUP, "level", &s.error);
        CHECK(node && (i % 2 || node_add_child(&s.scene, node, top, &s.error)));
        top = node;
    }
    struct scene_traversal t = {.operands = OPERANDS_ALL, .frame_size = sizeof(uint64_t)};
    enum scene_event event;
    uint32_t entered = 0, left = 0, deepest = 0;
    scene_traversal_begin(&t, top);
    while ((event = scene_traversal_next(&t)) < SCENE_END) {
        *(uint64_t *)scene_traversal_frame(&t, 0) = t.depth;
        CHECK(t.depth == 1 || *(uint64_t *)scene_traversal_frame(&t, 1) == t.depth - 1);
        entered += event == SCENE_ENTER;
        left += event == SCENE_LEAVE;
        deepest = t.depth > deepest ? t.depth : deepest;
        if (event == SCENE_ENTER && scene_traversal_node(&t) == bottom)
            CHECK_EQ_INT(t.depth, LEVELS + 1);
    }
    CHECK_EQ_INT(event, SCENE_END);
    CHECK_EQ_INT(entered, LEVELS + 1);
    CHECK_EQ_INT(left, LEVELS + 1);
    CHECK_EQ_INT(deepest, LEVELS + 1);
    scene_traversal_end(&t);
    stage_end(&s);
}
