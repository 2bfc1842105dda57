/* Open transparent surfaces are thin walls for paths and photons; what counts as open is in test_opening.c. */
#include "material/openpbr.h"
#include "photon/photon_trace.h"
#include "shape/planar.h"
#include "tests/harness.h"
#include "tests/stage.h"
#include "tests/unit/mesh_makers.h"
#include "tests/unit/path_estimate.h"
#include "tests/unit/surface_makers.h"

#include <math.h>

enum { SIDE = 16 };
static const struct colour tint = {0.5, 0.7, 0.9};

static void begin(struct stage *s) {
    stage_begin(s, 1);
    s->sky.colour = colour_all(1);
    s->settings.integrator = INTEGRATOR_PATH;
    s->settings.path_samples = 4;
}

/* A tilted square at the origin that fills the picture. */
static struct node *add_pane(struct stage *s, const struct material *material) {
    struct node *pane = stage_sphere(s, s->root, material);
    struct planar square = planar_parallelogram(vec3_make(-500, -500, 0), vec3_make(1000, 0, 0), vec3_make(0, 1000, 0));
    pane->shape = (struct shape){.kind = SHAPE_PLANAR, .planar = square};
    stage_rotate(s, pane, 0, 25);
    stage_rotate(s, pane, 1, 40);
    return pane;
}

static struct material *fresnel_glass(struct stage *s) {
    return scene_material(&s->scene, MATERIAL_FRESNEL, stage_glass(s, 0, 0, 1.5), &s->error);
}

static struct material *layered_glass(struct stage *s, double roughness) {
    struct openpbr *layers = arena_alloc(&s->scene.arena, sizeof *layers);
    struct material *material = stage_glass(s, 0, 1, 1.5);
    *layers = openpbr_defaults();
    material->kind = MATERIAL_OPENPBR;
    material->openpbr = layers;
    material->phong.roughness = roughness;
    return material;
}

static void check_sky(const char *what, struct stage *s, struct colour value) {
    CHECK(stage_render(s, SIDE, SIDE));
    for (uint32_t i = 0; i < SIDE * SIDE; i++)
        for (int c = 0; c < 3; c++) {
            double found = colour_get(stage_pixel(s, i % SIDE, i / SIDE), c);
            if (!(fabs(found - colour_get(value, c)) < 1e-6)) {
                test_fail(__FILE__, __LINE__, "%s: %.9g, not %.9g", what, found, colour_get(value, c));
                return;
            }
        }
}

TEST(an_open_pane_before_a_white_sky_shows_its_tint_once) {
    for (int side = 0; side < 2; side++) {
        struct stage s;
        begin(&s);
        struct material *glass = stage_glass(&s, 0, 1, 1.5), *deep = stage_glass(&s, 0, 1, 1.5);
        glass->phong.ks = tint;
        deep->phong.absorption = colour_all(3);
        struct node *pane = add_pane(&s, glass);
        if (side)
            stage_rotate(&s, pane, 1, 180);
        check_sky("tinted", &s, tint);
        pane->material = deep;
        check_sky("with absorption inside", &s, colour_all(1));
        stage_end(&s);
    }
}

TEST(open_panes_of_clear_glass_are_invisible_in_a_white_furnace) {
    struct stage s;
    begin(&s);
    struct node *pane = add_pane(&s, fresnel_glass(&s));
    check_sky("classic, by Fresnel's equations", &s, colour_all(1));
    pane->material = layered_glass(&s, 0);
    check_sky("layered, smooth", &s, colour_all(1));
    const struct effort effort = {SIDE, 256, 1};
    pane->material = layered_glass(&s, 0.4);
    estimate_check_mean("a rough open pane in a furnace", 1, &s, &effort, 100);
    stage_end(&s);
}

/* Without Fresnel's equations, on both sides of the wall z = 0. */
TEST(a_rough_open_pane_passes_light_as_it_would_mirror_it) {
    struct test_random random = {5};
    struct material pane = {.kind = MATERIAL_PHONG, .depth = 1, .phong = {.ks = tint, .refract = 1, .roughness = 0.6}};
    struct material mirror = {
        .kind = MATERIAL_PHONG, .depth = 1, .phong = {.ks = tint, .reflect = 1, .roughness = 0.6}};
    pane.phong.ior = 1.5;
    pane.phong.has_ior = true;
    for (int i = 0; i < 1000; i++) {
        struct vec3 wo = vec3_normalize(test_point(&random, 1)), wi = vec3_normalize(test_point(&random, 1));
        struct vec3 behind = vec3_make(wi.x, wi.y, -wi.z), up = vec3_make(0, 0, 1);
        struct hit hit = {.view = wo, .front = wo.z > 0, .normal = up, .normal_geometric = up};
        struct bsdf passes, mirrors;
        surface_eval(&pane, &hit, NULL, &(struct material_context){.total_reflection = true, .thin = true}, &passes);
        surface_eval(&mirror, &hit, NULL, &(struct material_context){.total_reflection = true}, &mirrors);
        uint32_t traced = bsdf_lobes_with(&passes, BSDF_TRACED), other = bsdf_lobes_with(&mirrors, BSDF_TRACED);
        struct colour a = bsdf_eval(&passes, traced, BSDF_RADIANCE, wo, behind),
                      b = bsdf_eval(&mirrors, other, BSDF_RADIANCE, wo, wi);
        CHECK(colour_max_abs(colour_sub(a, b)) <= 1e-9 * (1 + colour_max_abs(b)));
        CHECK_NEAR(bsdf_pdf(&passes, traced, wo, behind), bsdf_pdf(&mirrors, other, wo, wi), 1e-9);
    }
}

/* The pane covers a face of the cube and stands out on all sides. */
TEST(a_pane_flush_on_a_solid_of_glass_is_invisible_in_a_white_furnace) {
    struct stage s;
    begin(&s);
    struct material *glass = fresnel_glass(&s);
    struct node *pane = stage_sphere(&s, s.root, glass), *cube = stage_cube(&s, s.root, glass);
    struct planar square = planar_parallelogram(vec3_make(-2, -2, 0), vec3_make(4, 0, 0), vec3_make(0, 4, 0));
    pane->shape = (struct shape){.kind = SHAPE_PLANAR, .planar = square};
    stage_move(&s, cube, -0.5, -0.5, -1);
    stage_scale(&s, s.root, 2, 2, 2);
    const struct effort effort = {SIDE, 256, 1};
    estimate_check_mean("a pane flush on a cube", 1, &s, &effort, 100);
    stage_end(&s);
}

/* Whether the picture of a glowing ball is the same as without the object before it. */
static bool shows_the_same(struct stage *s, struct node *object, enum node_walls walls) {
    struct colour bare[SIDE * SIDE];
    double largest = 0;
    object->walls = walls;
    object->singular = true;
    CHECK(stage_render(s, SIDE, SIDE));
    for (uint32_t i = 0; i < SIDE * SIDE; i++)
        bare[i] = stage_pixel(s, i % SIDE, i / SIDE);
    object->singular = false;
    CHECK(stage_render(s, SIDE, SIDE));
    for (uint32_t i = 0; i < SIDE * SIDE; i++)
        largest = fmax(largest, colour_max_abs(colour_sub(stage_pixel(s, i % SIDE, i / SIDE), bare[i])));
    return largest < 1e-6;
}

static void begin_ball(struct stage *s) {
    begin(s);
    struct material *glowing = stage_phong(s, colour_make(1, 0.5, 0), colour_all(0), 1);
    glowing->phong.unlit = true;
    stage_move(s, stage_sphere(s, s->root, glowing), 0.4, 0.3, -6);
    s->sky.colour = colour_make(0, 0, 0.2);
}

TEST(thin_walled_of_a_node_decides_whether_an_open_surface_refracts) {
    struct stage s;
    begin_ball(&s);
    struct node *pane = add_pane(&s, stage_glass(&s, 0, 1, 1.5));
    CHECK(shows_the_same(&s, pane, WALLS_BY_SHAPE));
    CHECK(shows_the_same(&s, pane, WALLS_THIN));
    CHECK(!shows_the_same(&s, pane, WALLS_OF_SOLID));
    struct node *ball = stage_sphere(&s, s.root, stage_glass(&s, 0, 1, 1.5));
    pane->singular = true;
    stage_scale(&s, ball, 3, 3, 3);
    CHECK(!shows_the_same(&s, ball, WALLS_BY_SHAPE));
    CHECK(shows_the_same(&s, ball, WALLS_THIN));
    stage_scale(&s, ball, 5, 5, 5); /* the camera is in it */
    CHECK(shows_the_same(&s, ball, WALLS_THIN));
    stage_end(&s);
}

TEST(what_a_clip_leaves_of_glass_is_a_thin_wall) {
    struct stage s;
    begin_ball(&s);
    struct node *ball = scene_node(&s.scene, NODE_GEOMETRY, "ball", &s.error);
    ball->shape = (struct shape){.kind = SHAPE_SPHERE, .sphere = {{0, 0, 0}, 3}};
    ball->material = stage_glass(&s, 0, 1, 1.5);
    struct node *half = scene_node(&s.scene, NODE_GEOMETRY, "half", &s.error);
    half->shape = (struct shape){.kind = SHAPE_PLANAR, .planar = planar_plane(vec3_make(0, 0, 1), 1)};
    struct node *clipped = scene_combine(&s.scene, "clipped", NODE_CLIPPED, (struct node *[]){ball, half}, 2, &s.error);
    CHECK(node_add_child(&s.scene, s.root, clipped, &s.error));
    CHECK(shows_the_same(&s, ball, WALLS_BY_SHAPE));
    CHECK(!shows_the_same(&s, ball, WALLS_OF_SOLID));
    stage_end(&s);
}

/* By a half-space and a ball that contain it, and by a ball that its bounds stick out of. */
TEST(what_a_clip_leaves_whole_refracts) {
    static const double radii[] = {0, 6, 4};
    for (int i = 0; i < 3; i++) {
        struct stage s;
        begin_ball(&s);
        struct node *ball = scene_node(&s.scene, NODE_GEOMETRY, "ball", &s.error);
        struct node *clipping = scene_node(&s.scene, NODE_GEOMETRY, "clipping", &s.error);
        ball->shape = (struct shape){.kind = SHAPE_SPHERE, .sphere = {{0, 0, 0}, 3}};
        ball->material = stage_glass(&s, 0, 1, 1.5);
        clipping->shape = (struct shape){.kind = SHAPE_SPHERE, .sphere = {{0, 0, 0}, radii[i]}};
        if (i == 0)
            clipping->shape = (struct shape){.kind = SHAPE_PLANAR, .planar = planar_plane(vec3_make(0, 0, 1), 4)};
        struct node *clipped =
            scene_combine(&s.scene, "clipped", NODE_CLIPPED, (struct node *[]){ball, clipping}, 2, &s.error);
        CHECK(node_add_child(&s.scene, s.root, clipped, &s.error));
        CHECK_EQ_INT(shows_the_same(&s, ball, WALLS_BY_SHAPE), i == 2);
        stage_end(&s);
    }
}

TEST(whitted_refracts_at_open_surfaces_as_before) {
    struct stage s;
    begin_ball(&s);
    s.settings.integrator = INTEGRATOR_WHITTED;
    struct node *pane = add_pane(&s, stage_glass(&s, 0, 1, 1.5));
    CHECK(!shows_the_same(&s, pane, WALLS_BY_SHAPE));
    CHECK(!shows_the_same(&s, pane, WALLS_THIN));
    stage_end(&s);
}

/* Light from (0, 4, 0) through the disc of radius 1 at y = 2 falls on the disc of radius 2 at y = 0. */
TEST(photons_pass_an_open_surface_straight_on_with_its_tint_once) {
    struct stage s;
    stage_begin(&s, 1);
    s.settings.caustics.photons = 20000;
    struct material *glass = stage_glass(&s, 0, 1, 1.5);
    glass->phong.ks = tint;
    struct node *disc = stage_sphere(&s, s.root, glass), *ground = stage_sphere(&s, s.root, NULL);
    disc->shape =
        (struct shape){.kind = SHAPE_PLANAR, .planar = planar_disc(vec3_make(0, 2, 0), vec3_make(0, 1, 0), 1, 0)};
    ground->shape = (struct shape){.kind = SHAPE_PLANAR, .planar = planar_plane(vec3_make(0, 1, 0), 0)};
    ground->material = stage_phong(&s, colour_all(1), colour_all(0), 1);
    stage_point_light(&s, vec3_make(0, 4, 0), colour_all(1));
    s.lights[0].attenuation = ATTENUATION_INVERSE_SQUARE;
    s.lights[0].intensity = 1;
    struct photon_map maps[2];
    double farthest = 0;
    struct colour sums[2] = {{0, 0, 0}, {0, 0, 0}};
    for (int clear = 0; clear < 2; clear++) {
        struct photon_statistics statistics = {0};
        glass->phong.ks = clear ? colour_all(1) : tint;
        CHECK(stage_build(&s, s.root, ACCEL_AUTO));
        const struct photon_scene scene = {.world = &s.world, .settings = &s.settings};
        CHECK(photons_make(&maps[clear], &scene, s.pool, &statistics, &s.error));
        for (uint32_t i = 0; i < maps[clear].count; i++) {
            const float *at = maps[clear].spots[i].at, *power = maps[clear].lights[i].power;
            struct vec3 position = vec3_add_scaled(
                maps[clear].origin, vec3_make((double)at[0], (double)at[1], (double)at[2]), maps[clear].unit);
            farthest = fmax(farthest, hypot(position.x, position.z));
            sums[clear] = colour_add_scaled(
                sums[clear], colour_make((double)power[0], (double)power[1], (double)power[2]), maps[clear].power_unit);
        }
        photon_map_destroy(&maps[clear]);
    }
    CHECK(farthest > 1.99 && farthest < 2.0001);
    for (int c = 0; c < 3; c++)
        CHECK_NEAR(colour_get(sums[0], c) / colour_get(sums[1], c), colour_get(tint, c), 0.01);
    stage_end(&s);
}
