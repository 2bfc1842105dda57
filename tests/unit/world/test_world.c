/* The world against brute force, and the guarantees of flattening. */
#include "tests/harness.h"

#include "shape/planar.h"
#include "tests/stage.h"
#include "tests/unit/shape_makers.h"
#include "world/device_search.h"
#include "world/packet.h"

#include <float.h>
#include <math.h>
#include <string.h>

static void random_transform(struct stage *s, struct test_random *random, struct node *node, double spread) {
    struct transform t =
        transform_scale(vec3_make(test_uniform(random, 0.2, 2) * (test_uniform(random, 0, 1) < 0.2 ? -1 : 1),
                                  test_uniform(random, 0.2, 2), test_uniform(random, 0.2, 2)));
    node_transform(&s->scene, node, NODE_SCALE, &t);
    t = transform_rotate((int)test_uniform(random, 0, 3), test_uniform(random, -180, 180));
    node_transform(&s->scene, node, NODE_ROTATE, &t);
    t = transform_translate(vec3_make(test_uniform(random, -spread, spread), test_uniform(random, -spread, spread),
                                      test_uniform(random, -spread, spread)));
    node_transform(&s->scene, node, NODE_TRANSLATE, &t);
}

static struct node *shape_node(struct stage *s, struct test_random *random, const struct shape *shape) {
    struct node *node = scene_node(&s->scene, NODE_GEOMETRY, "shape", &s->error);
    node->shape = *shape;
    random_transform(s, random, node, 0.3);
    return node;
}

/* A closed shape of any kind, or a tree of them. */
static struct node *random_solid(struct stage *s, struct shape_makers *makers, struct test_random *random, int depth) {
    if (depth == 0 || test_uniform(random, 0, 1) < 0.75) {
        struct shape shape = make_solid(makers, random);
        return shape_node(s, random, &shape);
    }
    enum node_csg operation = (enum node_csg)(int)test_uniform(random, 0, 3);
    struct node *first = random_solid(s, makers, random, depth - 1);
    struct node *second = random_solid(s, makers, random, depth - 1);
    struct node *node = scene_combine(&s->scene, "csg", operation, (struct node *[]){first, second}, 2, &s->error);
    random_transform(s, random, node, 0.3);
    return node;
}

/* A shape of any kind, closed or not; all kinds equally often. */
static struct node *random_shape(struct stage *s, struct shape_makers *makers, struct test_random *random) {
    int kind = (int)test_uniform(random, 0, GEOMETRY_KIND_COUNT - 0.001);
    if (kind == SHAPE_KIND_COUNT) /* a CSG solid */
        return random_solid(s, makers, random, 2);
    struct shape shape = make_shape(makers, (enum shape_kind)kind, random).shape;
    return shape_node(s, random, &shape);
}

/* A mixed world: shapes of all kinds, instances of groups, CSG; sometimes flat, sometimes empty. */
static struct node *random_world(struct stage *s, struct shape_makers *makers, struct test_random *random, int count,
                                 double spread, bool planar) {
    struct node *root = scene_node(&s->scene, NODE_GROUP, "root", &s->error), *last = NULL;
    for (int i = 0; i < count; i++) {
        struct node *node;
        if (last && test_uniform(random, 0, 1) < 0.2) {
            node = scene_node(&s->scene, NODE_GROUP, "instance", &s->error);
            CHECK(node_add_child(&s->scene, node, last, &s->error));
            random_transform(s, random, node, spread);
        } else {
            node = random_shape(s, makers, random);
            random_transform(s, random, node, spread);
            last = node;
        }
        if (planar) {
            struct transform t = transform_scale(vec3_make(1, 1e-9, 1));
            node_transform(&s->scene, node, NODE_SCALE, &t);
        }
        CHECK(node_add_child(&s->scene, root, node, &s->error));
    }
    return root;
}

static struct ray random_ray(struct test_random *random, double spread) {
    struct ray ray = {.t_min = 0, .t_max = INFINITY};
    double *o = &ray.origin.x, *d = &ray.direction.x;
    for (int i = 0; i < 3; i++) {
        o[i] = test_uniform(random, -2 * spread, 2 * spread);
        d[i] = test_uniform(random, -1, 1);
        if (test_uniform(random, 0, 1) < 0.05)
            d[i] = 0;
    }
    if (d[0] == 0 && d[1] == 0 && d[2] == 0)
        d[2] = 1;
    if (test_uniform(random, 0, 1) < 0.2)
        ray.t_max = test_uniform(random, 0, spread);
    return ray;
}

static void compare_with_brute_force(enum accel_kind accel, int worlds, int rays, uint64_t seed) {
    struct test_random random = {seed};
    for (int w = 0; w < worlds; w++) {
        struct stage s;
        struct shape_makers makers = {0};
        stage_begin(&s, 1);
        static const int counts[] = {0, 1, 2, 5, 20, 80, 300};
        int count = counts[w % 7];
        double spread = w % 3 == 0 ? 2 : w % 3 == 1 ? 10 : 60;
        struct node *root = random_world(&s, &makers, &random, count, spread, w % 11 == 10);
        struct stage *stage = &s;
        if (!stage_build(stage, root, accel)) {
            test_fail(__FILE__, __LINE__, "%s", s.error.text);
            stage_end(&s);
            shape_makers_destroy(&makers);
            return;
        }
        struct world brute = s.world;
        brute.accel.kind = brute.mesh_accel = ACCEL_NONE;
        struct device_search search;
        CHECK(device_search_build(&search, &s.world, s.pool, &s.error));
        const struct world device = device_search_world(&search, &s.world);
        struct world_scratch scratch;
        CHECK(world_scratch_init(&scratch, &s.world));
        int wrong = 0;
        for (int i = 0; i < rays; i++) {
            struct ray ray = random_ray(&random, spread);
            uint32_t a = 0, b = 0, c = 0;
            struct crossing x = {0}, y = {0}, z = {0};
            bool hit_a = world_nearest_crossing(&s.world, &ray, &scratch, &a, &x);
            bool hit_b = world_nearest_crossing(&brute, &ray, &scratch, &b, &y);
            bool hit_c = world_nearest_crossing(&device, &ray, &scratch, &c, &z);
            bool same = hit_a == hit_b && (!hit_a || (a == b && x.t == y.t && x.part == y.part && x.leaf == y.leaf));
            same = same && world_any(&s.world, &ray, &scratch) == hit_b;
            same = same && hit_c == hit_b && (!hit_a || (a == c && x.t == z.t && x.part == z.part && x.leaf == z.leaf));
            same = same && world_any(&device, &ray, &scratch) == hit_b;
            wrong += !same;
            if (!same && wrong < 3)
                test_fail(__FILE__, __LINE__, "world %d ray %d: %d #%u t=%.17g, brute force %d #%u t=%.17g", w, i,
                          hit_a, a, x.t, hit_b, b, y.t);
        }
        CHECK_EQ_INT(wrong, 0);
        world_scratch_destroy(&scratch);
        device_search_destroy(&search);
        stage_end(&s);
        shape_makers_destroy(&makers);
    }
}

/* With every accelerator, by construction. */
#define TESTS_WITH(accel, word)                                                                                        \
    TEST(world_equals_brute_force_on_random_rays_with_##accel) {                                                       \
        compare_with_brute_force(accel, 21, 3000, 1 + accel);                                                          \
    }                                                                                                                  \
    TEST_LONG(world_equals_brute_force_on_ten_million_rays_with_##accel) {                                             \
        compare_with_brute_force(accel, 420, 24000, 11 + accel);                                                       \
    }
ACCEL_KINDS(TESTS_WITH)

/* There two crossings may have one t, and cancel each other. */
TEST(rays_hit_squeezed_implicit_solids_at_all_where_they_hit_them_first) {
    for (uint64_t seed = 1; seed <= 8; seed++) {
        struct test_random random = {seed};
        struct stage s;
        struct shape_makers makers = {0};
        stage_begin(&s, 1);
        struct node *root = scene_node(&s.scene, NODE_GROUP, "root", &s.error);
        for (int i = 0; i < 40; i++) {
            struct shape shape = make_shape(&makers, SHAPE_IMPLICIT, &random).shape;
            struct node *node = shape_node(&s, &random, &shape);
            struct transform squeezed = transform_scale(vec3_make(1, 1e-14, 1));
            random_transform(&s, &random, node, 4);
            node_transform(&s.scene, node, NODE_SCALE, &squeezed);
            CHECK(node_add_child(&s.scene, root, node, &s.error));
        }
        CHECK(stage_build(&s, root, ACCEL_NONE));
        struct world_scratch scratch;
        CHECK(world_scratch_init(&scratch, &s.world));
        for (int i = 0; i < 6000; i++) {
            struct ray ray = random_ray(&random, 4);
            uint32_t primitive;
            struct crossing crossing;
            bool hit = world_nearest_crossing(&s.world, &ray, &scratch, &primitive, &crossing);
            if (world_any(&s.world, &ray, &scratch) != hit)
                test_fail(__FILE__, __LINE__, "seed %d, ray %d: nearest %d", (int)seed, i, hit);
        }
        world_scratch_destroy(&scratch);
        stage_end(&s);
        shape_makers_destroy(&makers);
    }
}

TEST_TIMES(points_of_a_parallelogram_seen_through_a_shaft_are_those_that_single_rays_see, 30) {
    struct test_random random = {5};
    int partly = 0;
    for (int w = 0; w < 12 * times; w++) {
        struct stage s;
        struct shape_makers makers = {0};
        stage_begin(&s, 1);
        struct node *root = random_world(&s, &makers, &random, w % 4 == 0 ? 200 : 12, 6, false);
        CHECK(stage_build(&s, root, ACCEL_AUTO));
        struct world_scratch scratch;
        CHECK(world_scratch_init(&scratch, &s.world));
        for (int i = 0; i < 1000; i++) {
            double n[12];
            for (int k = 0; k < 12; k++)
                n[k] = test_uniform(&random, -8, 8);
            struct vec3 from = {n[0], n[1], n[2]}, corner = {n[3], n[4], n[5]};
            struct vec3 edge1 = {n[6] * 0.2, n[7] * 0.2, n[8] * 0.2}, edge2 = {n[9] * 0.2, n[10] * 0.2, n[11] * 0.2};
            if (i % 50 == 0)
                edge2 = vec3_all(0);
            if (i % 77 == 0)
                from = vec3_add(corner, vec3_add(edge1, edge2)); /* on the parallelogram itself */
            struct vec3 targets[16];
            uint32_t seen = 0;
            for (int k = 0; k < 16; k++) {
                targets[k] = vec3_add_scaled(corner, edge1, test_uniform(&random, 0, 1));
                targets[k] = vec3_add_scaled(targets[k], edge2, test_uniform(&random, 0, 1));
                struct ray ray = {.origin = from, .direction = vec3_sub(targets[k], from), .t_max = 1};
                seen += !world_any(&s.world, &ray, &scratch);
            }
            partly += seen > 0 && seen < 16;
            struct occluder_candidates occluder_candidates =
                world_occluder_candidates(&s.world, from, corner, edge1, edge2, 0);
            CHECK_EQ_INT(world_visible(&s.world, &occluder_candidates, &(struct shadow_rays){from, 0, targets, 16},
                                       &scratch, NULL),
                         seen);
        }
        world_scratch_destroy(&scratch);
        stage_end(&s);
        shape_makers_destroy(&makers);
    }
    CHECK(partly > 300 * times);
}

/* Cylinders, cones on either side of their tip, both kinds of hyperboloid, discs, ellipsoids. */
static struct node *random_convex_or_not(struct stage *s, struct test_random *random) {
    struct node *node = scene_node(&s->scene, NODE_GEOMETRY, "shape", &s->error);
    struct revolved_quadric conics[] = {
        revolved_quadric_upright(0, 0, 1, -1, 1, false),     revolved_quadric_upright(0.25, 0.5, 0.25, -1, 1, false),
        revolved_quadric_upright(0.25, -1, 1, 0, 2, true),   revolved_quadric_upright(-1, 0, 1, -0.5, 1, false),
        revolved_quadric_upright(1, 0, -0.25, -1, 1, false), revolved_quadric_upright(1, 0, 0.25, -1, 1, false),
        revolved_quadric_upright(0.25, 0, 0, -1, 1, false),  revolved_quadric_upright(0, 1, 0, 0, 1, false)};
    int kind = (int)test_uniform(random, 0, 10);
    if (kind < 8)
        node->shape = (struct shape){.kind = SHAPE_REVOLVED_QUADRIC, .revolved_quadric = conics[kind]};
    else if (kind == 8)
        node->shape =
            (struct shape){.kind = SHAPE_PLANAR, .planar = planar_disc(vec3_all(0), vec3_make(0, 1, 1), 1, 0.4)};
    else
        node->shape = (struct shape){.kind = SHAPE_ELLIPSOID, .ellipsoid = {vec3_all(0.1), {1, 0.4, 0.7}}};
    random_transform(s, random, node, 0.3);
    return node;
}

/* Rays that leave a surface and skip its primitive. */
TEST(the_primitive_that_a_ray_skips_would_not_have_been_met) {
    struct test_random random = {77};
    int reported = 0, met_others = 0;
    for (int w = 0; w < 40; w++) {
        struct stage s;
        struct shape_makers makers = {0};
        stage_begin(&s, 1);
        struct node *root = random_world(&s, &makers, &random, 12, 2, false);
        for (int i = 0; i < 12; i++) {
            struct node *node = random_convex_or_not(&s, &random);
            random_transform(&s, &random, node, 2);
            CHECK(node_add_child(&s.scene, root, node, &s.error));
        }
        CHECK(stage_build(&s, root, w % 2 ? ACCEL_AUTO : ACCEL_GRID));
        struct device_search search;
        CHECK(device_search_build(&search, &s.world, s.pool, &s.error));
        const struct world device = device_search_world(&search, &s.world);
        struct world_scratch scratch;
        CHECK(world_scratch_init(&scratch, &s.world));
        for (int i = 0; i < 3000; i++) {
            struct ray ray = random_ray(&random, 2);
            struct hit hit;
            if (!world_nearest(&s.world, &ray, &scratch, &hit))
                continue;
            struct vec3 direction = random_ray(&random, 1).direction;
            if (i % 3 == 0) /* nearly along the surface */
                direction = vec3_add_scaled(vec3_cross(direction, hit.normal_geometric), hit.normal_geometric,
                                            test_uniform(&random, -1e-5, 1e-5));
            double side = vec3_dot(direction, hit.normal_geometric) < 0 ? -hit.offset : hit.offset;
            struct ray onward = {.origin = vec3_add_scaled(hit.point, hit.normal_geometric, side),
                                 .direction = direction,
                                 .t_max = i % 2 ? INFINITY : 3};
            struct ray passing = onward;
            struct hit_skip skip = hit_skip_from(&hit, side, direction);
            passing.skip_primitive = skip.primitive;
            passing.skip_part = skip.part;
            if (!passing.skip_primitive)
                continue;
            reported++;
            uint32_t a = 0, b = 0;
            struct crossing x = {0}, y = {0};
            bool met = world_nearest_crossing(&s.world, &onward, &scratch, &a, &x);
            met_others += met;
            CHECK_EQ_INT(world_nearest_crossing(&s.world, &passing, &scratch, &b, &y), met);
            CHECK(!met || (a == b && x.t == y.t && (a != hit.primitive || (skip.part && x.part != hit.part))));
            CHECK_EQ_INT(world_any(&s.world, &passing, &scratch), met);
            CHECK_EQ_INT(world_nearest_crossing(&device, &passing, &scratch, &b, &y), met);
            CHECK(!met || (a == b && x.t == y.t && x.part == y.part));
            CHECK_EQ_INT(world_any(&device, &passing, &scratch), met);
            struct vec3 edge = vec3_scale(hit.normal_geometric, 1e-3);
            struct occluder_candidates occluder_candidates =
                world_occluder_candidates(&s.world, onward.origin, vec3_add(onward.origin, direction), edge, edge,
                                          skip.part ? 0 : skip.primitive);
            struct vec3 target = vec3_add(onward.origin, direction);
            struct ray segment = {.origin = onward.origin, .direction = vec3_sub(target, onward.origin), .t_max = 1};
            CHECK_EQ_INT(world_visible(&s.world, &occluder_candidates,
                                       &(struct shadow_rays){onward.origin, 0, &target, 1}, &scratch, NULL),
                         !world_any(&s.world, &segment, &scratch));
        }
        world_scratch_destroy(&scratch);
        device_search_destroy(&search);
        stage_end(&s);
        shape_makers_destroy(&makers);
    }
    CHECK(reported > 10000 && met_others > 2000);
}

enum { SMALL_MESHES = 9 };

/* Up to twelve triangles; some meshes have vertex normals. */
static struct mesh *small_mesh(struct test_random *random, bool smooth) {
    enum { LIMIT = 12 };
    double vertices[3 * LIMIT][3], normals[1][3] = {{0.6, 0, 0.8}};
    uint32_t starts[LIMIT + 1], corners[3 * LIMIT], normal_of[3 * LIMIT] = {0};
    uint32_t count = 1 + (uint32_t)test_uniform(random, 0, LIMIT - 1);
    double middle[3];
    for (int k = 0; k < 3; k++)
        middle[k] = test_uniform(random, -3, 3);
    for (uint32_t i = 0; i < 3 * count; i++) {
        for (int k = 0; k < 3; k++)
            vertices[i][k] = middle[k] + test_uniform(random, -3, 3);
        corners[i] = i;
        starts[i / 3] = i / 3 * 3;
    }
    starts[count] = 3 * count;
    struct mesh_input input = {.name = "small",
                               .vertex_count = 3 * count,
                               .face_count = count,
                               .vertices = (const double(*)[3])vertices,
                               .face_start = starts,
                               .vertex_index = corners,
                               .normal_count = smooth ? 1 : 0,
                               .normals = smooth ? (const double(*)[3])normals : NULL,
                               .normal_index = smooth ? normal_of : NULL};
    struct error error;
    return mesh_create(&input, &error);
}

/* What shading reads. */
static bool same_hit(const struct hit *a, const struct hit *b) {
    return a->t == b->t && a->primitive == b->primitive && a->part == b->part && a->front == b->front &&
           a->material == b->material && a->offset == b->offset && a->footprint == b->footprint &&
           a->convexity == b->convexity && a->has_uv == b->has_uv && a->has_colour == b->has_colour &&
           a->pattern_scale == b->pattern_scale && memcmp(&a->point, &b->point, sizeof a->point) == 0 &&
           memcmp(&a->view, &b->view, sizeof a->view) == 0 && memcmp(&a->normal, &b->normal, sizeof a->normal) == 0 &&
           memcmp(&a->normal_geometric, &b->normal_geometric, sizeof a->normal) == 0 &&
           memcmp(&a->pattern_point, &b->pattern_point, sizeof a->point) == 0 &&
           memcmp(&a->pattern_normal, &b->pattern_normal, sizeof a->normal) == 0;
}

/* A ray, and one that leaves its hit and skips what it cannot hit. */
static void compare_group(const struct world *world, const struct world *single, struct world_scratch *scratch,
                          struct ray ray, struct test_random *random, int *hits) {
    for (int bounce = 0; bounce < 3; bounce++) {
        struct hit a, b;
        bool met = world_nearest(single, &ray, scratch, &a);
        CHECK_EQ_INT(world_nearest(world, &ray, scratch, &b), met);
        CHECK_EQ_INT(world_any(world, &ray, scratch), met);
        CHECK(world->device || (world_blocker(scratch) != WORLD_NOTHING) == met);
        if (!met)
            return;
        CHECK(same_hit(&a, &b));
        ++*hits;
        ray = hit_ray(&a, &ray, random_ray(random, 1).direction, NULL);
    }
}

TEST(small_meshes_that_are_searched_together_have_the_hits_of_each) {
    struct test_random random = {5};
    int hits = 0;
    for (int w = 0; w < 30; w++) {
        struct stage s;
        struct mesh *meshes[SMALL_MESHES];
        stage_begin(&s, 1);
        const struct material *material = stage_phong(&s, colour_all(0.5), colour_all(0), 0);
        struct node *root = scene_node(&s.scene, NODE_GROUP, "root", &s.error);
        for (int i = 0; i < SMALL_MESHES; i++) {
            struct node *node = scene_node(&s.scene, NODE_GEOMETRY, "mesh", &s.error);
            meshes[i] = i > 0 && i == w % SMALL_MESHES ? mesh_share(meshes[i - 1]) : small_mesh(&random, i % 3 == 1);
            node->shape = (struct shape){.kind = SHAPE_MESH, .mesh = meshes[i]};
            node->material = material;
            CHECK(node_add_child(&s.scene, root, node, &s.error));
        }
        if (w % 2)
            stage_move(&s, stage_sphere(&s, root, material), 1, 0.5, -1);
        CHECK(stage_build(&s, root, ACCEL_AUTO));
        CHECK(s.world.group.index != NULL);
        struct world single = s.world;
        single.group.index = NULL;
        struct device_search search;
        CHECK(device_search_build(&search, &s.world, s.pool, &s.error));
        const struct world device = device_search_world(&search, &s.world);
        struct world_scratch scratch;
        CHECK(world_scratch_init(&scratch, &s.world));
        for (int i = 0; i < 2000; i++) {
            struct ray ray = random_ray(&random, i % 10 == 9 ? 1e4 : 1.5);
            if (i % 10 == 9)
                ray.direction = vec3_sub(ray.direction, ray.origin);
            ray.footprint = (struct footprint){0.01, 0.001};
            if (i % 7 == 6)
                ray.t_min = 0.5;
            compare_group(i % 2 ? &s.world : &device, &single, &scratch, ray, &random, &hits);
        }
        world_scratch_destroy(&scratch);
        device_search_destroy(&search);
        stage_end(&s);
        for (int i = 0; i < SMALL_MESHES; i++)
            mesh_release(meshes[i]);
    }
    CHECK(hits > 20000);
}

/* Camera rays of a few pixels, rays along an axis, and rays in all directions, which must be traced one by one. */
static struct ray_packet random_packet(struct test_random *random, double spread, int form) {
    struct ray first = random_ray(random, spread);
    struct ray_packet packet = {.origin = first.origin, .count = 1 + (uint32_t)test_uniform(random, 0, 64)};
    double width = vec3_length(first.direction) * test_uniform(random, 0, 0.2);
    for (uint32_t i = 0; i < packet.count; i++) {
        double n[3];
        for (int k = 0; k < 3; k++)
            n[k] = test_uniform(random, -1, 1);
        struct vec3 d = vec3_add_scaled(first.direction, vec3_make(n[0], n[1], n[2]), width);
        if (form == 1)
            d = vec3_make(i % 2 ? 0.0 : n[0] * 0.1, i % 3 ? -0.0 : n[1] * 0.1, first.direction.z < 0 ? -1 : 1);
        if (form == 2)
            d = vec3_make(n[0], n[1], n[2]);
        packet.direction[0][i] = d.x;
        packet.direction[1][i] = d.y;
        packet.direction[2][i] = d.z;
        packet.t_max[i] = i % 4 ? INFINITY : test_uniform(random, 0, 3);
    }
    ray_packet_pad(&packet);
    return packet;
}

TEST_TIMES(packets_of_rays_meet_in_a_world_what_single_rays_meet, 30) {
    struct test_random random = {8};
    uint64_t hits = 0;
    for (int w = 0; w < 28; w++) {
        struct stage s;
        struct shape_makers makers = {0};
        stage_begin(&s, 1);
        static const int counts[] = {0, 1, 2, 5, 20, 80, 300};
        double spread = w % 3 == 0 ? 2 : w % 3 == 1 ? 10 : 60;
        struct node *root = random_world(&s, &makers, &random, counts[w % 7], spread, w % 11 == 10);
        CHECK(stage_build(&s, root, w % 9 == 8 ? ACCEL_GRID : ACCEL_AUTO));
        struct world_scratch scratch;
        CHECK(world_scratch_init(&scratch, &s.world));
        for (int i = 0; i < 50 * times; i++) {
            struct ray_packet packet = random_packet(&random, spread, i % 4);
            struct packet_answer answers[PACKET_RAYS];
            uint64_t met = world_nearest_packet(&s.world, &packet, &scratch, answers);
            CHECK((met & ~ray_packet_all(&packet)) == 0);
            hits += (uint64_t)__builtin_popcountll(met);
            for (uint32_t k = 0; k < packet.count; k++) {
                struct ray ray = ray_packet_get(&packet, k);
                uint32_t primitive;
                struct crossing c;
                bool single = world_nearest_crossing(&s.world, &ray, &scratch, &primitive, &c);
                bool same = single == (met >> k & 1);
                if (same && single)
                    same = answers[k].primitive == primitive && answers[k].crossing.t == c.t &&
                           answers[k].crossing.part == c.part && answers[k].crossing.leaf == c.leaf &&
                           answers[k].crossing.u == c.u && answers[k].crossing.v == c.v;
                if (!same)
                    test_fail(__FILE__, __LINE__, "world %d, packet %d, ray %u differs from the same ray single", w, i,
                              k);
            }
        }
        world_scratch_destroy(&scratch);
        stage_end(&s);
        shape_makers_destroy(&makers);
    }
    CHECK(hits > 4000 * (uint64_t)times);
}

/* Lights and scales near the limits of double make such rays. Their hits are not defined, but they must be in the
 * world.
 */
TEST(rays_that_are_not_finite_meet_only_what_is_there) {
    static const double odd[] = {NAN, INFINITY, -INFINITY, DBL_MAX, -DBL_MAX, 0, 1, DBL_MIN};
    struct test_random random = {81};
    for (int w = 0; w < 3 * LIST_COUNT(ACCEL_KINDS); w++) {
        struct stage s;
        struct shape_makers makers = {0};
        stage_begin(&s, 1);
        static const int counts[] = {2, 5, 30};
        CHECK(stage_build(&s, random_world(&s, &makers, &random, counts[w % 3], 10, false), (enum accel_kind)(w / 3)));
        struct device_search search;
        CHECK(device_search_build(&search, &s.world, s.pool, &s.error));
        const struct world device = device_search_world(&search, &s.world);
        struct world_scratch scratch;
        CHECK(world_scratch_init(&scratch, &s.world));
        for (int i = 0; i < 3000; i++) {
            struct ray ray = random_ray(&random, 10);
            double *numbers[] = {&ray.origin.x, &ray.direction.x};
            for (int k = 0; k < 6; k++)
                if (test_uniform(&random, 0, 1) < 0.7)
                    numbers[k / 3][k % 3] = odd[(int)test_uniform(&random, 0, 7.999)];
            uint32_t primitive = 0;
            struct crossing c;
            CHECK(!world_nearest_crossing(&s.world, &ray, &scratch, &primitive, &c) ||
                  primitive < s.world.primitive_count);
            (void)world_any(&s.world, &ray, &scratch);
            CHECK(!world_nearest_crossing(&device, &ray, &scratch, &primitive, &c) ||
                  primitive < s.world.primitive_count);
            (void)world_any(&device, &ray, &scratch);
        }
        world_scratch_destroy(&scratch);
        device_search_destroy(&search);
        stage_end(&s);
        shape_makers_destroy(&makers);
    }
}

TEST(world_names_the_nodes_of_a_cycle) {
    struct stage s;
    stage_begin(&s, 1);
    struct node *a = scene_node(&s.scene, NODE_GROUP, "arm", &s.error);
    struct node *b = scene_node(&s.scene, NODE_GROUP, "hand", &s.error);
    CHECK(node_add_child(&s.scene, a, b, &s.error) && node_add_child(&s.scene, b, a, &s.error));
    CHECK(!stage_build(&s, a, ACCEL_GRID));
    CHECK_TEXT(s.error.text, "the nodes form a cycle: 'arm' > 'hand' > 'arm'");
    stage_end(&s);
}

TEST(world_refuses_a_tree_that_doubles_sixty_times) {
    struct stage s;
    stage_begin(&s, 1);
    struct node *node = scene_node(&s.scene, NODE_GEOMETRY, "leaf", &s.error);
    node->shape = (struct shape){.kind = SHAPE_SPHERE, .sphere = {{0, 0, 0}, 1}};
    struct node *group = NULL, *empty = scene_node(&s.scene, NODE_GROUP, "nothing", &s.error);
    for (int i = 0; i < 60; i++) {
        group = scene_node(&s.scene, NODE_GROUP, "twice", &s.error);
        CHECK(node_add_child(&s.scene, group, node, &s.error) && node_add_child(&s.scene, group, node, &s.error));
        node = group;
        struct node *more = scene_node(&s.scene, NODE_GROUP, "nothing", &s.error);
        CHECK(node_add_child(&s.scene, more, empty, &s.error) && node_add_child(&s.scene, more, empty, &s.error));
        empty = more;
    }
    CHECK(!stage_build(&s, group, ACCEL_GRID));
    CHECK(strstr(s.error.text, "more than 268435456 primitives") != NULL);
    CHECK(stage_build(&s, empty, ACCEL_GRID)); /* 2^60 paths without any shape */
    CHECK_EQ_INT(s.world.primitive_count, 0);
    stage_end(&s);
}

TEST_TIMES(world_flattens_a_long_chain_of_nodes, 4) {
    struct stage s;
    stage_begin(&s, 1);
    struct node *root = scene_node(&s.scene, NODE_GROUP, "root", &s.error), *node = root;
    for (int i = 0; i < 250000 * times; i++) {
        struct node *child = scene_node(&s.scene, NODE_GROUP, "link", &s.error);
        CHECK(node_add_child(&s.scene, node, child, &s.error));
        node = child;
    }
    struct node *leaf = scene_node(&s.scene, NODE_GEOMETRY, "leaf", &s.error);
    leaf->shape = (struct shape){.kind = SHAPE_SPHERE, .sphere = {{0, 0, 0}, 1}};
    CHECK(node_add_child(&s.scene, node, leaf, &s.error));
    CHECK(stage_build(&s, root, ACCEL_GRID));
    CHECK_EQ_INT(s.world.primitive_count, 1);
    CHECK_EQ_INT(s.warnings, 1); /* no material */
    stage_end(&s);
}

TEST(csg_operand_that_is_open_is_an_error_that_names_node_and_edges) {
    struct stage s;
    struct shape_makers makers = {0};
    struct test_random random = {7};
    stage_begin(&s, 1);
    struct node *open = scene_node(&s.scene, NODE_GEOMETRY, "bowl", &s.error);
    do {
        open->shape = make_shape(&makers, SHAPE_MESH, &random).shape;
    } while (shape_is_closed(&open->shape));
    struct node *ball = scene_node(&s.scene, NODE_GEOMETRY, "ball", &s.error);
    ball->shape = (struct shape){.kind = SHAPE_SPHERE, .sphere = {{0, 0, 0}, 1}};
    struct node *cut = scene_combine(&s.scene, "cut", NODE_DIFFERENCE, (struct node *[]){ball, open}, 2, &s.error);
    CHECK(!stage_build(&s, cut, ACCEL_GRID));
    CHECK(strstr(s.error.text, "node 'bowl'") != NULL && strstr(s.error.text, "open edges") != NULL);
    stage_end(&s);
    shape_makers_destroy(&makers);
}

TEST(an_empty_operand_follows_the_algebra_of_sets) {
    struct stage s;
    stage_begin(&s, 1);
    static const uint32_t expected[3] = {1, 0, 1}; /* A u 0, A n 0, A - 0 */
    for (int operation = 0; operation < 3; operation++) {
        struct node *ball = scene_node(&s.scene, NODE_GEOMETRY, "ball", &s.error);
        ball->shape = (struct shape){.kind = SHAPE_SPHERE, .sphere = {{0, 0, 0}, 1}};
        struct node *nothing = scene_node(&s.scene, NODE_GROUP, "nothing", &s.error);
        struct node *cut =
            scene_combine(&s.scene, "cut", (enum node_csg)operation, (struct node *[]){ball, nothing}, 2, &s.error);
        CHECK(stage_build(&s, cut, ACCEL_GRID));
        CHECK_EQ_INT(s.world.primitive_count, expected[operation]);
    }
    stage_end(&s);
}

TEST(world_finds_the_solids_that_contain_a_point_innermost_last) {
    struct stage s;
    stage_begin(&s, 1);
    struct node *root = scene_node(&s.scene, NODE_GROUP, "root", &s.error);
    static const double radii[3] = {2, 3, 1};
    for (int i = 0; i < 3; i++) {
        struct node *ball = scene_node(&s.scene, NODE_GEOMETRY, "ball", &s.error);
        ball->shape = (struct shape){.kind = SHAPE_SPHERE, .sphere = {{0, 0, 0}, radii[i]}};
        CHECK(node_add_child(&s.scene, root, ball, &s.error));
    }
    CHECK(stage_build(&s, root, ACCEL_GRID));
    struct world_scratch scratch;
    CHECK(world_scratch_init(&scratch, &s.world));
    uint32_t inside[4], all[4];
    struct box everywhere = {vec3_all(-INFINITY), vec3_all(INFINITY)};
    CHECK_EQ_INT(world_closed_in(&s.world, &everywhere, all, 4), 3);
    struct box far_away = {vec3_all(4), vec3_all(5)};
    CHECK_EQ_INT(world_closed_in(&s.world, &far_away, NULL, 0), 0);
    CHECK_EQ_INT(
        world_containing(&s.world, &(struct inside_query){vec3_make(0.1, 0.2, 0.3), 0, all, 3}, &scratch, inside, 4),
        3);
    CHECK(inside[0] == 1 && inside[1] == 0 && inside[2] == 2);
    CHECK_EQ_INT(
        world_containing(&s.world, &(struct inside_query){vec3_make(0.1, 0.2, 0.3), 0, all, 3}, &scratch, inside, 2),
        2);
    CHECK(inside[0] == 0 && inside[1] == 2);
    CHECK_EQ_INT(
        world_containing(&s.world, &(struct inside_query){vec3_make(2.5, 0, 0), 0, all, 3}, &scratch, inside, 4), 1);
    world_scratch_destroy(&scratch);
    stage_end(&s);
}
