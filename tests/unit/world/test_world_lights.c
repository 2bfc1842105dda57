/* All light of a world: for emitters of every kind, samples of lights agree with samples of directions that hit them.
 */
#include "base/random.h"
#include "light/light_bounds.h"
#include "light/light_mesh.h"
#include "material/classic.h"
#include "material/material_eval.h"
#include "tests/harness.h"
#include "tests/stage.h"
#include "tests/unit/shape_makers.h"
#include "world/world_lights.h"

#include <math.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

struct room {
    struct stage stage;
    struct arena arena;
    struct world_lights lights;
    struct world_scratch scratch;
};

static void room_begin(struct room *r) {
    memset(r, 0, sizeof *r);
    stage_begin(&r->stage, 1);
}

static void room_build(struct room *r, bool background) {
    struct stage *s = &r->stage;
    CHECK(stage_build(s, s->root, ACCEL_AUTO));
    CHECK(world_lights_build(&r->lights, &s->world, (struct world_lights_options){background, LIGHT_CHOICE_TREE},
                             &r->arena, s->pool, &s->error));
    CHECK(world_scratch_init(&r->scratch, &s->world));
}

static void room_end(struct room *r) {
    world_scratch_destroy(&r->scratch);
    world_lights_destroy(&r->lights);
    arena_destroy(&r->arena);
    stage_end(&r->stage);
}

static const struct material *glowing(struct room *r, double red, double green, double blue) {
    struct material *material = stage_phong(&r->stage, colour_all(0), colour_all(0), 1);
    material->phong.emission = colour_make(red, green, blue);
    return material;
}

static struct colour emission_at(const struct room *r, const struct hit *hit) {
    struct bsdf bsdf;
    material_eval(&r->stage.world.surfaces, hit, NULL, NULL, &bsdf);
    return bsdf.emission;
}

static struct sample2 xi_of(uint64_t seed, uint64_t index) {
    return (struct sample2){random_unit(random_combine(seed, 2 * index)),
                            random_unit(random_combine(seed, 2 * index + 1))};
}

static struct vec3 direction_of(struct sample2 xi) {
    double y = 1 - 2 * xi.y, level = sqrt(fmax(0, 1 - y * y));
    return vec3_make(level * cos(2 * pi * xi.x), y, level * sin(2 * pi * xi.x));
}

/* The light of one sample of the lights, times |cosine|; *density: that of its direction, including the choice of the
 * light. */
static struct colour of_lights(struct room *r, const struct light_receiver *at, uint64_t i, double *density,
                               bool *is_delta) {
    struct world_light_sample sample;
    double pmf;
    struct light_part part =
        light_sampler_sample(&r->lights.sampler, at->point, at->normal, random_unit(random_combine(11, i)), &pmf);
    if (part.light == LIGHT_NONE || !world_lights_sample(&r->lights, at, part, xi_of(12, i), &sample))
        return colour_all(0);
    struct ray ray = {.origin = at->from,
                      .direction = light_target_from(&sample.target, at->from),
                      .t_max = sample.decided ? INFINITY : light_target_end(&sample.target),
                      .time = 0.5,
                      .skip_primitive = sample.skip_primitive};
    struct hit hit;
    *density = sample.pdf * pmf;
    *is_delta = sample.is_delta;
    struct colour radiance;
    if (sample.decided) {
        double t;
        radiance = world_lights_seen_by(&r->lights, at, &sample, &ray, &r->scratch, &t);
        bool shows =
            world_nearest(&r->stage.world, &ray, &r->scratch, &hit) && world_lights_shows(&r->lights, &sample, &hit);
        if (shows && !sample.is_delta)
            CHECK_NEAR(world_lights_pdf_of_hit(&r->lights, at, sample.direction, &hit) / *density, 1, 1e-4);
        CHECK(!shows || hit.t == t);
    } else {
        radiance = colour_scale(sample.radiance, world_lights_visible(&r->lights, &ray, &r->scratch));
    }
    return colour_scale(radiance, fabs(vec3_dot(sample.direction, at->normal)));
}

struct estimate {
    double mean, error;
};

static void estimate_add(struct estimate *e, double value) {
    e->mean += value;
    e->error += value * value;
}
static void estimate_end(struct estimate *e, double n) {
    e->mean /= n;
    e->error = sqrt(fmax(0, e->error / n - e->mean * e->mean) / n);
}

static int compared;

/* Light at a point by scattered rays alone (uniform over the sphere), and by both kinds of samples with the balance
 * heuristic; green channel. Delta lights are left out: no scattered ray hits them. */
static void compare(struct room *r, const struct light_receiver *at, uint64_t n, double tolerance) {
    struct estimate single = {0, 0}, both = {0, 0};
    int hits = 0;
    for (uint64_t i = 0; i < n; i++) {
        double density = 0, of_scattered = 1 / (4 * pi), sum = 0, met = 0, weighted = 0;
        bool is_delta = false;
        struct colour carried = of_lights(r, at, i, &density, &is_delta);
        if (density > 0 && !is_delta)
            sum = carried.g / (density + of_scattered);
        struct vec3 direction = direction_of(xi_of(13, i));
        struct ray ray = {.origin = at->from, .direction = direction, .t_max = INFINITY, .time = 0.5};
        struct hit hit;
        double cosine = fabs(vec3_dot(direction, at->normal));
        bool found = world_nearest(&r->stage.world, &ray, &r->scratch, &hit);
        if (found) {
            double shown = world_lights_radiance(&r->lights, at->primitive, &hit, emission_at(r, &hit)).g * cosine;
            double pdf = world_lights_pdf_of_hit(&r->lights, at, direction, &hit);
            met += shown / of_scattered;
            weighted += shown / (of_scattered + pdf);
            ray.t_max = hit.t;
        }
        struct world_lights_traversal traversal;
        struct light_hit area_light;
        uint32_t light;
        world_lights_met_begin(&traversal, &r->lights, &ray);
        while (world_lights_met_next(&traversal, &light, &area_light)) {
            if (!world_lights_illuminate(&r->lights, light, at->primitive))
                continue;
            double shown = light_emitted(&r->lights.lights[light], &ray, &area_light).g * cosine;
            met += shown / of_scattered;
            weighted += shown / (of_scattered + world_lights_pdf(&r->lights, at, light, direction, &area_light));
        }
        for (uint32_t k = 0; k < r->lights.sampler.infinite_count && !found; k++) {
            struct light_hit behind = {.t = INFINITY};
            light = r->lights.sampler.infinite[k];
            double shown = light_emitted(&r->lights.lights[light], &ray, &behind).g * cosine;
            met += shown / of_scattered;
            weighted += shown / (of_scattered + world_lights_pdf(&r->lights, at, light, direction, &behind));
        }
        hits += met > 0;
        estimate_add(&single, met);
        estimate_add(&both, sum + weighted);
    }
    estimate_end(&single, (double)n);
    estimate_end(&both, (double)n);
    if (hits < 20) /* hidden, or too small to be hit by chance */
        return;
    CHECK_NEAR(both.mean, single.mean, 4.5 * (both.error + single.error));
    CHECK(both.error <= tolerance * single.error);
    compared++;
}

static struct light_receiver receiver_at(double x, double y, double z) {
    struct light_receiver at = {.point = {x, y, z}, .normal = vec3_normalize(vec3_make(0.2, 1, -0.3))};
    at.from = at.point;
    at.primitive = WORLD_NOTHING;
    return at;
}

static void paint(struct node *node, const struct material *material) {
    node->material = material;
}

TEST_TIMES(emitters_of_every_kind_of_shape_are_sampled_as_scattered_rays_meet_them, 30) {
    struct test_random random = {17};
    struct shape_makers makers = {0};
    for (int kind = 0; kind <= SHAPE_KIND_COUNT; kind++) {
        for (int turn = 0; turn < 6; turn++) {
            struct room r;
            room_begin(&r);
            struct node *node =
                scene_node(&r.stage.scene, kind == SHAPE_KIND_COUNT ? NODE_CSG : NODE_GEOMETRY, "it", &r.stage.error);
            if (kind == SHAPE_KIND_COUNT) {
                struct node **operands = arena_alloc_array(&r.stage.scene.arena, 2, sizeof(struct node *));
                for (int i = 0; i < 2; i++) {
                    operands[i] = scene_node(&r.stage.scene, NODE_GEOMETRY, "part", &r.stage.error);
                    operands[i]->shape = make_solid(&makers, &random);
                    paint(operands[i], glowing(&r, 1, i ? 2 : 1, 1));
                }
                node->operation = NODE_UNION;
                node->operands = operands;
                node->operand_count = 2;
            } else {
                node->shape = make_shape(&makers, (enum shape_kind)kind, &random).shape;
                paint(node, glowing(&r, 1, 2, 1));
            }
            node->parent_from_node = turn % 3 == 0 ? transform_identity() : make_transform(&random, 1);
            CHECK(node_add_child(&r.stage.scene, r.stage.root, node, &r.stage.error));
            struct node *screen = stage_sphere(&r.stage, r.stage.root, glowing(&r, 0, 0, 0));
            stage_scale(&r.stage, screen, 0.3, 0.3, 0.3);
            stage_move(&r.stage, screen, 0.8, -1.7, 0.4);
            room_build(&r, false);
            struct light_receiver at = receiver_at(turn % 2 ? 0.1 : 1, turn % 2 ? 0.05 : -2.6, turn % 2 ? 0.2 : 0.7);
            compare(&r, &at, 2500 * (uint64_t)times, turn % 2 ? 3 : 1.5);
            room_end(&r);
        }
    }
    CHECK(compared > 50);
    shape_makers_destroy(&makers);
}

static struct light area_light_of_kind(enum light_kind kind, double x, double y, double z) {
    struct light light = {.kind = kind, .colour = {1, 2, 1}, .emissive = true, .position = {x, y, z}, .radius = 0.6};
    light.direction = vec3_normalize(vec3_make(0.3, -1, 0.1));
    light.corner = vec3_make(x - 0.5, y, z - 0.4);
    light.edge1 = vec3_make(1, 0, 0.2);
    light.edge2 = vec3_make(0, 0.3, 0.8);
    return light;
}

TEST(lamps_and_skies_are_sampled_as_scattered_rays_meet_them) {
    for (int background = 0; background < 2; background++) {
        struct room r;
        room_begin(&r);
        struct node *ball = stage_sphere(&r.stage, r.stage.root, glowing(&r, 3, 3, 3));
        stage_scale(&r.stage, ball, 0.4, 0.4, 0.4);
        stage_move(&r.stage, ball, -1.5, 1, 0);
        sky_make_clear(vec3_normalize(vec3_make(1, 1, -1)), 3, colour_all(0.15), &r.stage.sky);
        r.stage.lights[r.stage.light_count++] = area_light_of_kind(LIGHT_SPHERE, 1, 2, 0);
        r.stage.lights[r.stage.light_count++] = area_light_of_kind(LIGHT_DISC, -0.5, 1.5, 0.4);
        r.stage.lights[r.stage.light_count++] = area_light_of_kind(LIGHT_PARALLELOGRAM, 0.5, 1.2, -0.6);
        r.stage.lights[r.stage.light_count++] =
            (struct light){.kind = LIGHT_POINT, .colour = {9, 9, 9}, .position = {0, 3, 0}};
        room_build(&r, background);
        CHECK_EQ_INT(r.lights.count, 5 + background);
        struct light_receiver at = receiver_at(0.1, 0, 0.2);
        compare(&r, &at, 40000, 1);
        room_end(&r);
    }
}

/* A white floor: the arriving light is E / pi = I f cos, for one light by its own samples. */
TEST(lights_without_emission_give_what_the_classic_language_says) {
    static const struct {
        enum light_attenuation attenuation;
        double falloff[3], factor; /* at distance 2 */
    } cases[] = {{ATTENUATION_COEFFICIENTS, {1, 0, 0}, 1},
                 {ATTENUATION_COEFFICIENTS, {0.5, 0.25, 0.125}, 1 / 1.5},
                 {ATTENUATION_RANGE, {0}, 1 - 2.0 / 5},
                 {ATTENUATION_INVERSE_SQUARE, {0}, 3.0 / 4}};
    static const enum light_kind kinds[] = {LIGHT_POINT, LIGHT_SPOT, LIGHT_DISC, LIGHT_SPHERE, LIGHT_PARALLELOGRAM};
    for (int k = 0; k < 20; k++) {
        struct room r;
        room_begin(&r);
        struct light light = area_light_of_kind(kinds[k % 5], 0, 2, 0);
        light.emissive = false;
        light.attenuation = cases[k / 5].attenuation;
        memcpy(light.falloff, cases[k / 5].falloff, sizeof light.falloff);
        light.range = 5;
        light.intensity = 3;
        light.direction = vec3_make(0, -1, 0);
        light.cos_inner = 0.9, light.cos_outer = 0.8;
        r.stage.lights[0] = light;
        r.stage.light_count = 1;
        room_build(&r, false);
        struct light_receiver at = receiver_at(0, 0, 0);
        at.normal = vec3_normalize(vec3_make(0.6, 0.8, 0));
        for (uint64_t i = 0; i < 16; i++) {
            struct world_light_sample sample;
            CHECK(world_lights_sample(&r.lights, &at, (struct light_part){0, 0}, xi_of(3, i), &sample));
            CHECK(sample.is_delta && !sample.decided && sample.pdf == 1);
            double white = sample.radiance.g * vec3_dot(sample.direction, at.normal) / pi; /* of a white surface */
            CHECK_NEAR(white, 2 * cases[k / 5].factor * 0.8, 1e-12);
        }
        double pmf;
        CHECK_EQ_INT(light_sampler_sample(&r.lights.sampler, at.point, at.normal, 0.3, &pmf).light, 0);
        CHECK_NEAR(pmf, 1, 0);
        room_end(&r);
    }
}

/* gr.mesh_light over an emitting mesh controls its sampling and, with its own emission, its light; in both cases there
 * is one light. */
static struct node *tetrahedron_outside(struct room *r, const struct material *material) {
    static const double corners[4][3] = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
    static const uint32_t start[] = {0, 3, 6, 9, 12}, index[] = {0, 1, 2, 0, 3, 1, 0, 2, 3, 1, 3, 2};
    struct mesh_input input = {.name = "tetrahedron",
                               .vertex_count = 4,
                               .face_count = 4,
                               .vertices = corners,
                               .face_start = start,
                               .vertex_index = index};
    struct node *node = scene_node(&r->stage.scene, NODE_GEOMETRY, "mesh", &r->stage.error);
    node->shape = (struct shape){.kind = SHAPE_MESH, .mesh = assets_mesh(&r->stage.assets, &input, &r->stage.error)};
    node->material = material;
    stage_move(&r->stage, node, 0.5, 3, 0);
    return node;
}

static struct node *tetrahedron(struct room *r, const struct material *material) {
    struct node *node = tetrahedron_outside(r, material);
    CHECK(node_add_child(&r->stage.scene, r->stage.root, node, &r->stage.error));
    return node;
}

static double mean_of_samples(struct room *r, const struct light_receiver *at, uint64_t n) {
    double sum = 0;
    for (uint64_t i = 0; i < n; i++) {
        double density = 0;
        bool is_delta;
        struct colour carried = of_lights(r, at, i, &density, &is_delta);
        sum += density > 0 ? carried.g / density / (double)n : 0;
    }
    return sum;
}

TEST(a_mesh_light_over_an_emitting_mesh_counts_once) {
    double lit[4];
    for (int i = 0; i < 4; i++) {
        struct room r;
        room_begin(&r);
        struct node *node = tetrahedron(&r, glowing(&r, 1, 2, 3));
        for (int k = 0; k < i; k++) { /* none, one, two; the last with emission of its own */
            r.stage.lights[k] = (struct light){.kind = LIGHT_MESH, .emissive = true, .colour = {1, 1, 1}};
            r.stage.authored[k].node = node;
            r.stage.lights[k].has_emission = i == 3;
            r.stage.lights[k].emission = colour_make(5, 5, 5);
        }
        r.stage.light_count = i == 3 ? 1 : (uint32_t)i;
        room_build(&r, false);
        CHECK_EQ_INT(r.lights.count, i == 2 ? 2 : 1);
        struct light_receiver at = receiver_at(0, 0, 0);
        compare(&r, &at, 20000, 1);
        lit[i] = mean_of_samples(&r, &at, 20000);
        room_end(&r);
    }
    CHECK_NEAR(lit[1], lit[0], 1e-9);
    CHECK_NEAR(lit[2], lit[0], 0.02 * lit[0]);
    CHECK_NEAR(lit[3], 2.5 * lit[0], 1e-9);
}

/* Behind a screen, with a second light; from outside and from inside of the mesh, which emits outwards only. */
TEST(triangles_of_a_mesh_light_that_is_not_in_the_scene_are_met_as_they_are_sampled) {
    double lit[3];
    for (int i = 0; i < 3; i++) {
        struct room r;
        room_begin(&r);
        struct node *node =
            i == 0 ? tetrahedron(&r, glowing(&r, 1, 2, 3)) : tetrahedron_outside(&r, glowing(&r, 1, 2, 3));
        struct node *screen = stage_sphere(&r.stage, r.stage.root, glowing(&r, 0, 0, 0));
        stage_scale(&r.stage, screen, 0.2, 0.2, 0.2);
        stage_move(&r.stage, screen, 0, 1, 0);
        r.stage.lights[0] = (struct light){.kind = LIGHT_MESH, .emissive = true, .colour = {1, 1, 1}};
        r.stage.authored[0].node = node;
        r.stage.light_count = 1;
        if (i == 2)
            r.stage.lights[r.stage.light_count++] = area_light_of_kind(LIGHT_DISC, -0.5, 1.5, 0.4);
        room_build(&r, false);
        CHECK_EQ_INT(r.lights.area_light_count, i == 0 ? 0 : i == 1 ? 4 : 5);
        int before = compared;
        struct light_receiver at = receiver_at(0.1, 0, 0.2);
        compare(&r, &at, 40000, 1);
        CHECK(compared > before);
        lit[i] = mean_of_samples(&r, &at, 20000);
        struct ray out = {.origin = {0.5, 3, 0}, .direction = {0, -1, 0.1}, .t_max = INFINITY};
        struct world_lights_traversal traversal;
        struct light_hit hit;
        uint32_t light;
        world_lights_met_begin(&traversal, &r.lights, &out);
        while (world_lights_met_next(&traversal, &light, &hit))
            CHECK_EQ_INT(light, 1);
        room_end(&r);
    }
    CHECK_NEAR(lit[1], lit[0], 0.01 * lit[0]);
    CHECK(lit[2] > 1.2 * lit[1]);
}

/* A ceiling of triangles whose emission is 0 but about one vertex in a hundred. */
static struct node *spotted_ceiling(struct room *r) {
    enum { SIDE = 30, VERTICES = (SIDE + 1) * (SIDE + 1), FACES = SIDE * SIDE };
    static double vertices[VERTICES][3];
    static float colours[VERTICES][3];
    static uint32_t start[FACES + 1], index[4 * FACES];
    for (uint32_t i = 0; i < VERTICES; i++) {
        double x = 0.2 * (i % (SIDE + 1)) - 3, z = 0.2 * (i / (SIDE + 1)) - 3;
        memcpy(vertices[i], (const double[3]){x, 2, z}, sizeof vertices[i]);
        for (int c = 0; c < 3; c++)
            colours[i][c] = i % 97 == 50 ? 100 : 0;
    }
    for (uint32_t i = 0; i < FACES; i++) {
        uint32_t corner = i / SIDE * (SIDE + 1) + i % SIDE;
        const uint32_t of_face[4] = {corner, corner + 1, corner + SIDE + 2, corner + SIDE + 1};
        memcpy(&index[4 * (size_t)i], of_face, sizeof of_face);
        start[i + 1] = 4 * (i + 1);
    }
    const struct mesh_input input = {.name = "ceiling",
                                     .vertex_count = VERTICES,
                                     .face_count = FACES,
                                     .vertices = (const double(*)[3])vertices,
                                     .face_start = start,
                                     .vertex_index = index,
                                     .colours = (const float(*)[3])colours};
    struct material *material = stage_phong(&r->stage, colour_all(0), colour_all(0), 1);
    material->inputs[INPUT_EMISSION] = texture_keep(&r->stage.scene.arena, texture_vertex_colour(), &r->stage.error);
    struct node *node = stage_sphere(&r->stage, r->stage.root, material);
    node->shape = (struct shape){.kind = SHAPE_MESH, .mesh = assets_mesh(&r->stage.assets, &input, &r->stage.error)};
    return node;
}

TEST(triangles_of_a_mesh_are_sampled_by_their_own_part_of_a_texture_of_emission) {
    for (int as_light = 0; as_light < 2; as_light++) {
        struct room r;
        room_begin(&r);
        const struct node *node = spotted_ceiling(&r);
        if (as_light) { /* the same by gr.mesh_light */
            r.stage.lights[0] = (struct light){.kind = LIGHT_MESH, .emissive = true, .colour = {1, 1, 1}};
            r.stage.authored[0].node = node;
            r.stage.light_count = 1;
        }
        room_build(&r, false);
        CHECK_EQ_INT(r.lights.count, 1);
        struct light_receiver at = receiver_at(0.1, 0, 0.2);
        const struct light_mesh *mesh = r.lights.lights[0].mesh;
        double bright = 0, all = 0;
        for (uint32_t i = 0; i < mesh->count; i++) {
            double pmf = light_sampler_pmf(&r.lights.sampler, at.point, at.normal, (struct light_part){0, i});
            all += pmf;
            bright += light_triangle_radiance(&mesh->triangles[i]).g > 1 ? pmf : 0;
        }
        CHECK_NEAR(all, 1, 1e-9);
        CHECK(bright > 0.8);
        compare(&r, &at, 40000, 0.5);
        room_end(&r);
    }
}

/* A partly transparent sheet in front of an emitting sphere, an emitting cube and a lamp. */
TEST(holes_let_through_what_their_opacity_leaves) {
    static const double opacities[] = {0, 0.25, 0.75, 1};
    double lit[3][5];
    for (int i = 0; i < 15; i++) {
        struct room r;
        room_begin(&r);
        struct stage *s = &r.stage;
        if (i / 5 == 0) {
            stage_move(s, stage_sphere(s, s->root, glowing(&r, 1, 2, 3)), 0, 4, 0);
        } else if (i / 5 == 1) {
            stage_move(s, stage_cube(s, s->root, glowing(&r, 1, 2, 3)), 0, 4, 0);
        } else {
            s->lights[s->light_count++] = area_light_of_kind(LIGHT_DISC, 0, 4, 0);
        }
        if (i % 5 < 4) {
            struct material *sheet = stage_phong(s, colour_all(0), colour_all(0), 1);
            sheet->inputs[INPUT_OPACITY] = texture_keep(&s->scene.arena, texture_number(opacities[i % 5]), &s->error);
            struct node *node = stage_cube(s, s->root, sheet); /* seen through twice */
            stage_scale(s, node, 20, 0.1, 20);
            stage_move(s, node, -10, 1, -10);
        }
        room_build(&r, false);
        struct light_receiver at = receiver_at(0.2, 0, 0.1);
        lit[i / 5][i % 5] = mean_of_samples(&r, &at, 2000);
        room_end(&r);
    }
    for (int i = 0; i < 15; i++) {
        double open = i % 5 < 4 ? 1 - opacities[i % 5] : 1;
        CHECK(lit[i / 5][4] > 0);
        CHECK_NEAR(lit[i / 5][i % 5] / lit[i / 5][4], open * open, 1e-9);
    }
}

TEST(lists_hold_for_lights_that_are_sampled_and_met) {
    struct room r;
    room_begin(&r);
    struct node *node = tetrahedron(&r, glowing(&r, 1, 2, 3)),
                *ball = stage_sphere(&r.stage, r.stage.root, glowing(&r, 0, 0, 0));
    const struct node *list[] = {ball};
    r.stage.lights[0] = (struct light){.kind = LIGHT_MESH, .emissive = true, .colour = {1, 1, 1}};
    r.stage.authored[0].node = node;
    r.stage.lights[1] = area_light_of_kind(LIGHT_SPHERE, 0, 3, 2);
    for (int i = 0; i < 2; i++)
        r.stage.authored[i].exclude = list, r.stage.authored[i].exclude_count = 1;
    r.stage.light_count = 2;
    room_build(&r, false);
    struct light_receiver at = receiver_at(0, 1.001, 0);
    struct ray up = {.origin = at.from, .direction = {0.1, 1, 0}, .t_max = INFINITY};
    struct hit hit;
    CHECK(world_nearest(&r.stage.world, &up, &r.scratch, &hit));
    for (uint32_t primitive = 0; primitive < 2; primitive++) {
        struct world_light_sample sample;
        at.primitive = primitive; /* the mesh, then the ball */
        for (uint32_t light = 0; light < 2; light++)
            CHECK(world_lights_sample(&r.lights, &at, (struct light_part){light, 0}, (struct sample2){0.4, 0.4},
                                      &sample) == (primitive == 0) ||
                  (light == 0 && primitive == 0));
        CHECK((world_lights_radiance(&r.lights, primitive, &hit, colour_all(1)).g > 0) == (primitive == 0));
        CHECK((world_lights_pdf_of_hit(&r.lights, &at, vec3_normalize(up.direction), &hit) > 0) == (primitive == 0));
    }
    room_end(&r);
}

TEST(camera_rays_meet_the_nearest_visible_lamp) {
    struct room r;
    room_begin(&r);
    for (int i = 0; i < 4; i++) {
        r.stage.lights[i] = area_light_of_kind(i % 2 ? LIGHT_DISC : LIGHT_SPHERE, 0, 3 + 2 * i, 0);
        r.stage.lights[i].visible = i > 0;
    }
    r.stage.light_count = 4;
    room_build(&r, false);
    struct ray up = {.direction = {0, 1, 0}, .t_max = INFINITY};
    struct light_hit hit;
    struct world_lights_traversal traversal;
    uint32_t light;
    int met = 0;
    CHECK(world_lights_seen(&r.lights, &up, &light, &hit));
    CHECK_EQ_INT(light, 1);
    CHECK_NEAR(hit.t, 5, 1e-9);
    world_lights_met_begin(&traversal, &r.lights, &up);
    while (world_lights_met_next(&traversal, &light, &hit))
        met++;
    CHECK_EQ_INT(met, 4);
    up.t_max = 4;
    CHECK(!world_lights_seen(&r.lights, &up, &light, &hit));
    room_end(&r);
}

TEST(a_black_background_is_no_light) {
    struct room r;
    room_begin(&r);
    room_build(&r, true);
    CHECK_EQ_INT(r.lights.count, 0);
    room_end(&r);
    room_begin(&r);
    r.stage.sky = (struct sky){.kind = SKY_CONSTANT, .colour = {0, 0.5, 0}};
    room_build(&r, true);
    CHECK_EQ_INT(r.lights.count, 1);
    room_end(&r);
}
