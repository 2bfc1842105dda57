/* Packets of rays beside single ones, to the bit: over a scene with every kind of shape at rest, moving, in instances,
 * combined, clipped and with holes, through every accelerator. */
#include "tests/harness.h"
#include "tests/stage.h"
#include "tests/unit/script_host.h"
#include "world/node_path.h"
#include "world/packet.h"
#include "world/world_describe.h"

#include <string.h>

static const char scene[] =
    "local paint = gr.material({0.5, 0.5, 0.5}, {0, 0, 0}, 1)\n"
    "local lace = gr.image_material{material = paint, image = 'holes.pfm', channel = 'opacity'}\n"
    "local tetra = {verts = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},\n"
    "  faces = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}, uvs = {{0, 0}, {1, 0}, {0, 1}, {1, 1}}}\n"
    "local function all(paint)\n"
    "  return {gr.sphere(paint), gr.cube(paint), gr.cylinder(paint), gr.cone(paint), gr.torus(paint, 0.8, 0.2),\n"
    "    gr.ellipsoid{material = paint, radii = {1, 0.5, 0.7}}, gr.paraboloid(paint), gr.hyperboloid(paint),\n"
    "    gr.quadric{material = paint, xx = 1, yy = 2, zz = 1, constant = -1}, gr.superellipsoid(paint),\n"
    "    gr.rectangle(paint, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}), gr.disc(paint),\n"
    "    gr.lathe(paint, {{0, 0}, {1, 0}, {1, 1}, {0, 2}}, 'catmull-rom'),\n"
    "    gr.prism{material = paint, outline = {{0, 0}, {3, 0}, {0, 3}}, holes = {{{1, 1}, {1.5, 1}, {1, 1.5}}}, to = "
    "2},\n"
    "    gr.sweep(paint, {{0, 0, 0}, {1, 1, 0}, {2, 0, 1}}, {0.1, 0.2, 0.1}), gr.height_field(paint, {{0, 1, 0}, {1, "
    "0, 1}}),\n"
    "    gr.blob(paint, {{0, 0, 0, 1}}, {{0, 0, 0, 1, 0, 0, 0.5, 2}}, 0.4),\n"
    "    gr.curve(paint, {{0, 0, 0}, {1, 1, 0}, {2, 0, 1}, {1, 0, 0}}, 0.1, 'b-spline'),\n"
    "    gr.mesh{material = paint, verts = tetra.verts, faces = tetra.faces, uvs = tetra.uvs},\n"
    "    gr.mesh{material = paint, verts = tetra.verts, faces = {tetra.faces[1], tetra.faces[4]}, uvs = tetra.uvs, "
    "cull = "
    "'back'},\n"
    "    gr.difference('solid', gr.sphere(paint), gr.cube(paint)),\n"
    "    gr.clipped_by(gr.sphere(paint), gr.cube(paint))}\n"
    "end\n"
    "local root, number = gr.node('root'), 0\n"
    "local function put(node)\n"
    "  number = number + 1\n"
    "  node:rotate('x', 37 * number):rotate('y', 61 * number)\n"
    "  node:translate((number * 7) % 11 - 5, (number * 5) % 13 - 6, (number * 3) % 7 - 3)\n"
    "  root:add_child(node)\n"
    "end\n"
    "for k = 1, 3 do for _, shape in ipairs(all(paint)) do\n"
    "  local node = gr.node('at rest') node:add_child(shape) put(node)\n"
    "end end\n"
    "for _, shape in ipairs(all(lace)) do put(shape) end\n"
    "for _, shape in ipairs(all(paint)) do local node = gr.node('moves') node:add_child(shape) put(node) "
    "node:velocity(1, 2, 0) "
    "end\n"
    "for _, shape in ipairs(all(paint)) do\n"
    "  put(gr.instances{of = shape, at = {{0, 1, 2}, {2, 0, 1}}, turn = {10, 80}, axis = 'z', size = 0.6})\n"
    "end\n"
    "gr.render{node = root, file = 'x.png', width = 8, height = 8, eye = {0, 0, 20}, shutter = {0, 1}}\n";

enum { RAYS = 3000 };
static const enum accel_kind accels[] = {ACCEL_AUTO, ACCEL_GRID, ACCEL_BVH, ACCEL_KDTREE, ACCEL_NONE};

/* Rays of one origin, time and begin, in any direction: count of them. */
static void make_rays(struct test_random *random, struct ray *rays, uint32_t count) {
    const struct ray first = {
        .origin = {test_uniform(random, -9, 9), test_uniform(random, -9, 9), test_uniform(random, -9, 9)},
        .t_min = test_uniform(random, 0, 1) < 0.2 ? test_uniform(random, 0, 2) : 0,
        .time = test_uniform(random, 0, 1)};
    for (uint32_t i = 0; i < count; i++) {
        struct ray *ray = &rays[i];
        *ray = first;
        ray->direction =
            vec3_make(test_uniform(random, -1, 1), test_uniform(random, -1, 1), test_uniform(random, -1, 1));
        if (test_uniform(random, 0, 1) < 0.1)
            ray->direction.y = 0;
        ray->t_max = test_uniform(random, 0, 1) < 0.3 ? test_uniform(random, 0, 12) : INFINITY;
        ray->footprint = (struct footprint){test_uniform(random, 0, 0.1), 0.01};
    }
}

static uint64_t trace_packet(const struct world *world, const struct ray *rays, uint32_t count,
                             struct world_scratch *scratch, struct packet_answer *answers) {
    struct ray_packet packet = {.origin = rays->origin, .t_min = rays->t_min, .time = rays->time, .count = count};
    for (uint32_t i = 0; i < count; i++) {
        packet.direction[0][i] = rays[i].direction.x;
        packet.direction[1][i] = rays[i].direction.y;
        packet.direction[2][i] = rays[i].direction.z;
        packet.t_max[i] = rays[i].t_max;
    }
    ray_packet_pad(&packet);
    return world_nearest_packet(world, &packet, scratch, answers);
}

/* Packets of 1 to 64 rays, and the complete hits of all. */
static void check_packets(const struct world *world, const char *what) {
    struct test_random random = {world->accel.kind + UINT64_C(1)};
    struct world_scratch scratch;
    uint32_t wrong = 0, found = 0, rays_traced = 0;
    CHECK(world_scratch_init(&scratch, world));
    while (rays_traced < RAYS) {
        struct ray rays[PACKET_RAYS];
        struct packet_answer answers[PACKET_RAYS];
        struct hit hit, single;
        uint32_t count = 1 + (uint32_t)test_uniform(&random, 0, PACKET_RAYS);
        make_rays(&random, rays, count);
        uint64_t met = trace_packet(world, rays, count, &scratch, answers);
        for (uint32_t i = 0; i < count; i++) {
            memset(&hit, 0, sizeof hit);
            memset(&single, 0, sizeof single);
            bool is_hit = world_nearest(world, &rays[i], &scratch, &single);
            if (met >> i & 1)
                world_describe(world, &rays[i], answers[i].primitive, &answers[i].crossing, &hit);
            found += is_hit;
            wrong += is_hit != (met >> i & 1) || (is_hit && memcmp(&single, &hit, sizeof single) != 0);
        }
        rays_traced += count;
    }
    if (wrong > 0)
        test_fail(__FILE__, __LINE__, "%s: %u of %u rays differ from the same rays alone", what, wrong, rays_traced);
    if (found < RAYS / 10 || found == rays_traced)
        test_fail(__FILE__, __LINE__, "%s: %u rays meet something", what, found);
    world_scratch_destroy(&scratch);
}

/* Rays that pass through a ball for longer than its surface may be off. */
static void check_tolerance(const struct world *world, const char *what) {
    const double share = 0x1p-12;
    struct test_random random = {21};
    struct world_scratch scratch;
    uint32_t compared = 0, wrong = 0;
    CHECK(world_scratch_init(&scratch, world));
    for (int packet = 0; packet < 100; packet++) {
        struct ray rays[PACKET_RAYS];
        struct packet_answer answers[PACKET_RAYS];
        make_rays(&random, rays, PACKET_RAYS);
        scratch.geom.tolerance = (float)share;
        const uint64_t met = trace_packet(world, rays, PACKET_RAYS, &scratch, answers);
        scratch.geom.tolerance = 0;
        for (uint32_t i = 0; i < PACKET_RAYS; i++) {
            struct ray rest = rays[i];
            struct hit hit, exact;
            if (!world_nearest(world, &rays[i], &scratch, &exact))
                continue;
            const double room = 2 * share * exact.t;
            rest.t_min = exact.t;
            rest.t_max = exact.t + 2 * room;
            if (exact.t - rays[i].t_min < room || world_nearest(world, &rest, &scratch, &hit))
                continue;
            compared++;
            if (met >> i & 1)
                world_describe(world, &rays[i], answers[i].primitive, &answers[i].crossing, &hit);
            wrong += !(met >> i & 1) || fabs(hit.t - exact.t) > room || hit.primitive != exact.primitive ||
                     vec3_dot(hit.normal_geometric, exact.normal_geometric) < 0.999;
        }
    }
    if (wrong > 0 || compared < 500)
        test_fail(__FILE__, __LINE__, "%s: %u of %u rays differ by more than the tolerance", what, wrong, compared);
    world_scratch_destroy(&scratch);
}

static void (*check_world)(const struct world *world, const char *what);

static void hear_of_scene(void *context, const char *text) {
    (void)context, (void)text;
}

static void check_scene(struct listener *listener, const struct render_request *request) {
    char warning[256];
    struct pool *pool = pool_create(1, warning);
    (void)listener;
    CHECK(pool != NULL);
    for (size_t k = 0; k < sizeof accels / sizeof accels[0]; k++) {
        struct world world = {0};
        struct arena arena = {0};
        struct error error = {0};
        char what[32];
        const struct world_input input = {.scene = request->scene,
                                          .root = request->root,
                                          .lights = request->lights,
                                          .light_count = request->light_count,
                                          .sky = &request->sky,
                                          .shutter = request->settings.shutter,
                                          .accel = accels[k],
                                          .warn = hear_of_scene};
        if (world_build(&world, &input, &arena, pool, &error)) {
            (void)snprintf(what, sizeof what, "accelerator %d", (int)accels[k]);
            check_world(&world, what);
            world_destroy(&world);
        } else {
            test_fail(__FILE__, __LINE__, "%s", error.text);
        }
        arena_destroy(&arena);
    }
    pool_destroy(pool);
}

/* Shapes of every kind by construction: test_world.c. */
TEST(packets_of_rays_meet_what_single_rays_meet_with_every_accelerator) {
    static struct listener listener = {.seen = check_scene};
    static const float holes[12] = {0, 0, 0, 1, 1, 1, 0.7F, 0.7F, 0.7F, 0.25F, 0.25F, 0.25F};
    char path[600], bytes[64];
    struct error error = {0};
    check_world = check_packets;
    int head = snprintf(bytes, sizeof bytes, "PF\n2 2\n-1.0\n");
    memcpy(bytes + head, holes, 48);
    (void)snprintf(path, sizeof path, "%s/holes.pfm", test_folder());
    test_write_file(path, bytes, (size_t)head + 48);
    if (!listen_to_text(&listener, scene, NULL, &error))
        test_fail(__FILE__, __LINE__, "%s", error.text);
    CHECK_EQ_INT(listener.renders, 1);
}

TEST(packets_with_a_tolerance_meet_moved_solids_by_functions_within_it) {
    static struct listener listener = {.seen = check_scene};
    struct error error = {0};
    check_world = check_tolerance;
    bool done = listen_to_text(
        &listener,
        "local root = gr.node 'root' for i = 1, 40 do "
        "local ball = gr.implicit{f = function(p) return gr.length(p) - 1 end, radius = 1.2, distance = true} "
        "ball:scale(1 + i % 3, 1, 2) ball:rotate('z', 30 * i) "
        "ball:translate(7 * math.sin(i), 7 * math.sin(2 * i), 7 * math.cos(3 * i)) root:add_child(ball) end "
        "root:add_child(gr.plane{normal = {0, 1, 0}, distance = -8}) "
        "gr.render{node = root, file = 'x.png', width = 4, height = 4, eye = {0, 0, 9}, lights = {}}",
        NULL, &error);
    CHECK_TEXT(error.text, "");
    CHECK(done);
    CHECK_EQ_INT(listener.renders, 1);
}
