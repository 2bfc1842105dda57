/* The meaning of the classic language in the path tracer (docs/design/light.md): one test for each rule. */
#include "light/light_bounds.h"
#include "shape/planar.h"
#include "tests/harness.h"
#include "tests/stage.h"
#include "tests/unit/path_estimate.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SIZE = 16 };

static double mean_of(const struct stage *s) {
    double sum = 0;
    for (size_t i = 0; i < (size_t)s->film.width * s->film.height; i++)
        sum += (double)s->film.pixels[i].rgb[0];
    return sum / ((double)s->film.width * s->film.height);
}

static double path_mean(struct stage *s, int samples, int depth) {
    s->settings.integrator = INTEGRATOR_PATH;
    s->settings.path_samples = samples;
    s->settings.max_depth = depth;
    CHECK(stage_render(s, SIZE, SIZE));
    return mean_of(s);
}

static double whitted_mean(struct stage *s, int samples, int area_samples) {
    s->settings.integrator = INTEGRATOR_WHITTED;
    s->settings.full = true;
    s->settings.samples = samples;
    s->settings.area_samples = area_samples;
    CHECK(stage_render(s, SIZE, SIZE));
    return mean_of(s);
}

static struct node *add_planar(struct stage *s, const struct material *material, struct planar planar) {
    struct node *node = stage_sphere(s, s->root, material);
    node->shape = (struct shape){.kind = SHAPE_PLANAR, .planar = planar};
    return node;
}

/* A white floor at y = 0 seen from above. */
static struct node *begin_floor(struct stage *s) {
    stage_begin(s, 1);
    s->camera = (struct camera){{0, 4, 0}, {0, -1, 0}, {0, 0, -1}, 40};
    return add_planar(s, stage_phong(s, colour_all(1), colour_all(0), 1), planar_plane(vec3_make(0, 1, 0), 0));
}

static struct light *add_light(struct stage *s, enum light_kind kind) {
    struct light *light = &s->lights[s->light_count++];
    *light = (struct light){.kind = kind, .position = {0.5, 3, 0}, .colour = colour_all(0.8), .falloff = {1, 0, 0}};
    light->direction = vec3_make(0, -1, 0);
    light->radius = 0.5;
    light->corner = vec3_make(-0.5, 3, -0.5);
    light->edge1 = vec3_make(1, 0, 0);
    light->edge2 = vec3_make(0, 0, 1);
    light->cos_inner = 0.95;
    light->cos_outer = 0.9;
    return light;
}

/* A ball casts a shadow on the floor. */
static void begin_shadow(struct stage *s, enum light_kind kind, bool emissive) {
    (void)begin_floor(s);
    struct node *ball = stage_sphere(s, s->root, stage_phong(s, colour_make(0.5, 0.5, 0.5), colour_all(0), 1));
    stage_scale(s, ball, 0.4, 0.4, 0.4);
    stage_move(s, ball, 0, 1, 0);
    struct light *light = add_light(s, kind);
    light->emissive = emissive;
    light->colour = colour_all(emissive ? 4 : 0.8);
}

static void check_light_as_whitted(enum light_kind kind, bool emissive, double tolerance) {
    struct stage s;
    begin_shadow(&s, kind, emissive);
    double want = whitted_mean(&s, 8, 8);
    CHECK(want > 0.05);
    CHECK_NEAR(path_mean(&s, 128, 1), want, tolerance * want);
    stage_end(&s);
}

TEST(depth_1_is_the_direct_light_of_whitted_for_every_light) {
    check_light_as_whitted(LIGHT_POINT, false, 0.002);
    check_light_as_whitted(LIGHT_DIRECTIONAL, false, 0.002);
    check_light_as_whitted(LIGHT_SPOT, false, 0.002);
    check_light_as_whitted(LIGHT_PARALLELOGRAM, false, 0.004);
    check_light_as_whitted(LIGHT_DISC, false, 0.004);
    check_light_as_whitted(LIGHT_SPHERE, false, 0.004);
    check_light_as_whitted(LIGHT_PARALLELOGRAM, true, 0.004);
    check_light_as_whitted(LIGHT_DISC, true, 0.004);
    check_light_as_whitted(LIGHT_SPHERE, true, 0.004);
}

/* Whitted's pixels have 16 x 16 positions of 4 x 4 points of the light each. */
TEST_LONG(depth_1_is_the_direct_light_of_whitted_to_a_thousandth_for_every_seed) {
    static const struct {
        const char *claim;
        enum light_kind kind;
        bool emissive;
    } cases[] = {{"depth 1: path tracer / Whitted, point", LIGHT_POINT, false},
                 {"depth 1: path tracer / Whitted, direction", LIGHT_DIRECTIONAL, false},
                 {"depth 1: path tracer / Whitted, spot", LIGHT_SPOT, false},
                 {"depth 1: path tracer / Whitted, classic parallelogram", LIGHT_PARALLELOGRAM, false},
                 {"depth 1: path tracer / Whitted, classic disc", LIGHT_DISC, false},
                 {"depth 1: path tracer / Whitted, classic ball", LIGHT_SPHERE, false},
                 {"depth 1: path tracer / Whitted, parallelogram", LIGHT_PARALLELOGRAM, true},
                 {"depth 1: path tracer / Whitted, disc", LIGHT_DISC, true},
                 {"depth 1: path tracer / Whitted, ball", LIGHT_SPHERE, true}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        for (int seed = 1; seed <= 3; seed++) {
            struct stage s;
            begin_shadow(&s, cases[i].kind, cases[i].emissive);
            s.settings.seed = (uint64_t)seed;
            const struct estimate whitted = {whitted_mean(&s, 16, 4), 0};
            const struct effort effort = {SIZE, 1024, 1};
            struct estimate path = estimate_render_twice(&s, &effort, 1, seed);
            path.error += 2e-4 * whitted.mean; /* of the edge of the shadow in Whitted's picture */
            estimate_check_equal(cases[i].claim, whitted, path, seed, 0.001);
            stage_end(&s);
        }
    }
}

TEST(highlights_of_lights_without_body_are_those_of_whitted) {
    struct stage s;
    stage_begin(&s, 1);
    for (int mirrors = 0; mirrors < 2; mirrors++) {
        struct material *material = stage_phong(&s, colour_all(0.3), colour_all(0.5), 12);
        material->phong.reflect = mirrors; /* of the black sky */
        (void)stage_sphere(&s, s.root, material);
    }
    s.camera = (struct camera){{0, 0, 4}, {0, 0, -1}, {0, 1, 0}, 35};
    stage_point_light(&s, vec3_make(2, 3, 5), colour_all(0.9));
    double want = whitted_mean(&s, 8, 8);
    CHECK_NEAR(path_mean(&s, 256, 1), want, 0.002 * want);
    stage_end(&s);
}

TEST(every_falloff_gives_intensity_times_cosine) {
    for (int attenuation = 0; attenuation < 3; attenuation++) {
        struct stage s;
        (void)begin_floor(&s);
        struct light *light = add_light(&s, LIGHT_POINT);
        light->position = vec3_make(0, 3, 0);
        light->attenuation = (enum light_attenuation)attenuation;
        light->falloff[0] = 0.5;
        light->falloff[1] = 0.1;
        light->falloff[2] = 0.2;
        light->range = 5;
        light->intensity = 6;
        s.camera.fov = 0.01; /* directly below the light: cosine 1, distance 3 */
        const double want[3] = {0.8 / (0.5 + 0.3 + 1.8), 0.8 * (1 - 3.0 / 5), 0.8 * 6 / 9};
        CHECK_NEAR(path_mean(&s, 1, 1), want[attenuation], 1e-5);
        stage_end(&s);
    }
}

TEST(ambient_light_is_nothing_to_paths_and_one_notice_says_so) {
    static const char scene[] = "local r = gr.node('r')\n"
                                "r:add_child(gr.sphere{material=gr.material({1,1,1},{0,0,0},1)})\n"
                                "gr.render{node=r, file='a.png', width=8, height=8, eye={0,0,5}, ambient={1,1,1}, "
                                "background={0,0,0}, integrator='path', spp=1}\n"
                                "gr.render{node=r, file='b.png', width=8, height=8, eye={0,0,5}, ambient={0,0,0}, "
                                "background={0,0,0}, integrator='path', spp=1}\n";
    struct test_result result = test_gray_scene(scene, "scene.lua", NULL);
    CHECK_EQ_INT(result.status, 0);
    const char *notice = strstr(result.err, "ignores ambient");
    CHECK(notice && !strstr(notice + 1, "ignores ambient"));
    struct test_picture a = test_read_picture(test_path("a.png")), b = test_read_picture(test_path("b.png"));
    CHECK(memcmp(a.rgb, b.rgb, (size_t)3 * a.width * a.height) == 0);
    free(a.rgb);
    free(b.rgb);
    test_free_result(&result);
}

/* --- skies --- */

TEST(a_chosen_background_lights_the_scene_and_the_gradient_that_nobody_chose_does_not) {
    static const char scene[] =
        "local r = gr.node('r')\n"
        "r:add_child(gr.rectangle{material=gr.material{kd={1,1,1}, two_sided=true}, corner={-9,-9,0}, along={18,0,0}, "
        "up={0,18,0}})\n"
        "local t = {node=r, width=4, height=4, eye={0,0,5}, integrator='path', spp=64, srgb=false}\n"
        "for name, background in pairs{none=false, gradient='gradient', colour={.5,.5,.5}} do\n"
        "  t.file, t.background = name .. '.png', background or nil\n  gr.render(t)\nend\n";
    struct test_result result = test_gray_scene(scene, "scene.lua", NULL);
    CHECK_EQ_INT(result.status, 0);
    struct test_picture none = test_read_picture(test_path("none.png"));
    struct test_picture gradient = test_read_picture(test_path("gradient.png"));
    struct test_picture colour = test_read_picture(test_path("colour.png"));
    for (size_t i = 0; i < 16; i++) {
        CHECK_EQ_INT(none.rgb[3 * i + 2], 0);
        CHECK(gradient.rgb[3 * i + 2] > 90); /* half way from horizon to horizon */
        CHECK_NEAR(colour.rgb[3 * i], 127, 12);
    }
    free(none.rgb);
    free(gradient.rgb);
    free(colour.rgb);
    test_free_result(&result);
}

TEST(scattered_rays_meet_the_sky_light_and_lines_of_sight_the_background) {
    struct stage s;
    static const struct sky blue = {.kind = SKY_CONSTANT, .colour = {0.25, 0.25, 0.25}};
    (void)begin_floor(&s);
    struct light *light = add_light(&s, LIGHT_SKY);
    light->sky = &blue;
    light->emissive = true;
    light->colour = colour_all(1);
    s.sky.colour = colour_all(0.75);
    CHECK_NEAR(path_mean(&s, 256, 1), 0.25, 0.001); /* a white floor below the sky light */
    s.camera.view = vec3_make(0, 1, 0.1);
    CHECK_NEAR(path_mean(&s, 4, 1), 0.75, 1e-6);
    /* In a mirror, too. */
    struct material *mirror = stage_phong(&s, colour_all(0), colour_all(1), 1);
    mirror->phong.reflect = 1;
    (void)add_planar(&s, mirror, planar_plane(vec3_make(0, 1, 0), 0.5));
    s.camera.view = vec3_make(0, -1, 0);
    CHECK_NEAR(path_mean(&s, 4, 4), 0.75, 1e-6);
    stage_end(&s);
}

/* --- lamps --- */

TEST(a_lamp_that_is_not_visible_lights_and_is_not_seen) {
    double light[2], seen[2], mirrored[2];
    for (int visible = 0; visible < 2; visible++) {
        struct stage s;
        struct node *floor = begin_floor(&s);
        struct light *area_light = add_light(&s, LIGHT_SPHERE);
        area_light->emissive = true;
        area_light->visible = visible;
        area_light->colour = colour_all(4);
        area_light->position = vec3_make(6, 3, 0);
        light[visible] = path_mean(&s, 256, 4);
        s.camera.view = vec3_make(6, -1, 0);
        s.camera.fov = 3;
        seen[visible] = path_mean(&s, 4, 4);
        struct material *mirror = stage_phong(&s, colour_all(0), colour_all(1), 1);
        mirror->phong.reflect = 1;
        floor->material = mirror;
        s.camera.view = vec3_make(6, -7, 0);
        mirrored[visible] = path_mean(&s, 4, 4);
        stage_end(&s);
    }
    CHECK_NEAR(light[0], light[1], 0.01 * light[1]);
    CHECK(light[0] > 0.01);
    CHECK_NEAR(seen[0], 0, 0.2);
    CHECK_NEAR(seen[1], 4, 1e-5);
    CHECK(mirrored[0] < 0.1); /* a highlight replaces its image */
    CHECK_NEAR(mirrored[1], 4, 1e-5);
}

/* A sky of radiance 1000 above the horizon, which divides the pixel, and black below. */
TEST(half_a_pixel_of_bright_light_beside_black_is_white_after_exposure_with_resolve_bright) {
    static const double stops[4][4] = {{-1, 0, 0, 0}, {0, 0, 0, 0}, {0, 1000, 1000, 1000}, {1, 1000, 1000, 1000}};
    struct stage s;
    stage_begin(&s, 1);
    s.sky = (struct sky){.kind = SKY_STOPS, .stops = stops, .stop_count = 4};
    s.settings.integrator = INTEGRATOR_PATH;
    s.settings.path_samples = 1024;
    CHECK(stage_render(&s, 1, 1));
    CHECK_NEAR(stage_pixel(&s, 0, 0).r, 500, 5);
    s.settings.resolve = RESOLVE_BRIGHT;
    for (double exposure = 0; exposure > -20; exposure -= 5) {
        s.settings.tone.exposure = exposure;
        double white = pow(2, -exposure), mapped = 0.5 * 1000 / (white + 1000);
        CHECK(stage_render(&s, 1, 1));
        CHECK_NEAR(stage_pixel(&s, 0, 0).r / (white * mapped / (1 - mapped)), 1, 0.02);
    }
    stage_end(&s);
}

/* On a line of sight, in front of a bright sky; light that falls through it reaches the floor. */
TEST(a_visible_lamp_hides_what_is_behind_it_from_lines_of_sight_and_casts_no_shadow) {
    double lit[2];
    for (int with_disc = 0; with_disc < 2; with_disc++) {
        struct stage s;
        (void)begin_floor(&s);
        s.sky.colour = colour_all(1);
        if (with_disc) {
            struct light *light = add_light(&s, LIGHT_DISC);
            light->emissive = light->visible = light->one_sided = true;
            light->direction = vec3_make(0, 1, 0); /* shines upwards */
            light->radius = 2;
            light->colour = colour_all(0.25);
        }
        s.camera.eye.y = 2;
        lit[with_disc] = path_mean(&s, 256, 1);
        s.camera.eye.y = 9;
        s.camera.fov = 1;
        CHECK_NEAR(path_mean(&s, 4, 1), with_disc ? 0.25 : 1, with_disc ? 1e-6 : 0.01);
        stage_end(&s);
    }
    CHECK_NEAR(lit[0], 1, 0.001);
    CHECK_NEAR(lit[1], lit[0], 0.002);
}

/* A square of two triangles above the floor. gr.mesh_light over it counts once; with an emission of its own it lights
 * the floor by that one, and cameras see the other one. */
TEST(a_mesh_light_over_an_emitting_material_only_says_how_it_is_sampled) {
    static const double corners[4][3] = {{-1, 3, -1}, {1, 3, -1}, {1, 3, 1}, {-1, 3, 1}};
    static const uint32_t start[] = {0, 4}, index[] = {0, 1, 2, 3};
    const struct mesh_input input = {.name = "square",
                                     .vertex_count = 4,
                                     .face_count = 1,
                                     .vertices = corners,
                                     .face_start = start,
                                     .vertex_index = index};
    double lit[3];
    for (int kind = 0; kind < 3; kind++) {
        struct stage s;
        (void)begin_floor(&s);
        struct material *glow = stage_phong(&s, colour_all(0), colour_all(0), 1);
        glow->phong.emission = colour_all(1);
        struct node *square = stage_sphere(&s, s.root, glow);
        square->shape = (struct shape){.kind = SHAPE_MESH, .mesh = assets_mesh(&s.assets, &input, &s.error)};
        s.camera.eye.y = 2;
        if (kind > 0) {
            s.lights[0] = (struct light){.kind = LIGHT_MESH, .emissive = true, .colour = {1, 1, 1}};
            s.lights[0].has_emission = kind == 2;
            s.lights[0].emission = colour_all(3);
            s.authored[0].node = square;
            s.light_count = 1;
        }
        lit[kind] = path_mean(&s, 256, 1);
        s.camera.view = vec3_make(0, 1, 0);
        CHECK_NEAR(path_mean(&s, 1, 1), 1, 1e-6);
        stage_end(&s);
    }
    CHECK(lit[0] > 0.05);
    CHECK_NEAR(lit[1], lit[0], 0.005 * lit[0]);
    CHECK_NEAR(lit[2], 3 * lit[0], 0.005 * lit[2]);
}

/* Of two halves of a floor every light excludes one, whether the light is sampled or hit. */
TEST(lists_of_nodes_hold_for_light_that_is_sampled_and_light_that_is_met) {
    static const struct sky grey = {.kind = SKY_CONSTANT, .colour = {1, 1, 1}};
    for (int kind = 0; kind < LIGHT_KIND_COUNT; kind++) {
        if (kind == LIGHT_MESH)
            continue;
        struct stage s;
        stage_begin(&s, 1);
        const struct material *white = stage_phong(&s, colour_all(1), colour_all(0), 1);
        (void)add_planar(&s, white, planar_parallelogram(vec3_make(0, 0, 5), vec3_make(5, 0, 0), vec3_make(0, 0, -10)));
        const struct node *dark =
            add_planar(&s, white, planar_parallelogram(vec3_make(-5, 0, 5), vec3_make(5, 0, 0), vec3_make(0, 0, -10)));
        s.camera = (struct camera){{0, 4, 0}, {0, -1, 0}, {0, 0, -1}, 40};
        struct light *light = add_light(&s, (enum light_kind)kind);
        light->position.x = 0;
        light->emissive = kind != LIGHT_POINT && kind != LIGHT_SPOT && kind != LIGHT_DIRECTIONAL;
        light->sky = &grey;
        light->cos_outer = 0.5;
        s.authored[0].exclude = &dark;
        s.authored[0].exclude_count = 1;
        (void)path_mean(&s, 64, 1);
        for (uint32_t y = 0; y < SIZE; y++) {
            for (uint32_t x = 0; x < SIZE; x++)
                CHECK((stage_pixel(&s, x, y).r > 0.01) == (x >= SIZE / 2));
        }
        stage_end(&s);
    }
}

/* A square of radiance 1 above the floor as a mesh light whose node is not in the scene. */
static struct node *add_unseen_square(struct stage *s) {
    static const double corners[4][3] = {{-1, 3, -1}, {1, 3, -1}, {1, 3, 1}, {-1, 3, 1}};
    static const uint32_t start[] = {0, 4}, index[] = {0, 1, 2, 3};
    const struct mesh_input input = {.name = "square",
                                     .vertex_count = 4,
                                     .face_count = 1,
                                     .vertices = corners,
                                     .face_start = start,
                                     .vertex_index = index};
    struct node *square = scene_node(&s->scene, NODE_GEOMETRY, "square", &s->error);
    square->shape = (struct shape){.kind = SHAPE_MESH, .mesh = assets_mesh(&s->assets, &input, &s->error)};
    struct light *light = add_light(s, LIGHT_MESH);
    light->emissive = light->has_emission = true;
    light->colour = light->emission = colour_all(1);
    s->authored[s->light_count - 1].node = square;
    return square;
}

TEST_TIMES(glass_throws_full_shadows_of_lights_without_body_and_lamps_are_found_through_it, 8) {
    double area_light[2], mesh_light[2], point[2];
    for (int pane = 0; pane < 2; pane++) {
        struct stage s;
        (void)begin_floor(&s);
        if (pane) {
            struct node *glass = stage_cube(&s, s.root, stage_glass(&s, 0, 1, 1));
            stage_move(&s, glass, -0.5, 2, -0.5);
            stage_scale(&s, glass, 40, 1, 40);
        }
        s.camera = (struct camera){{0, 1.5, 0}, {0, -1, 0}, {0, 0, -1}, 40};
        struct light *light = add_light(&s, LIGHT_POINT);
        light->position.y = 4;
        point[pane] = path_mean(&s, 16, 8);
        light->kind = LIGHT_SPHERE;
        light->emissive = true;
        light->radius = 0.8;
        light->colour = colour_all(4);
        area_light[pane] = path_mean(&s, 512 * times, 8);
        s.light_count = 0;
        stage_move(&s, add_unseen_square(&s), 0, 2, 0);
        mesh_light[pane] = path_mean(&s, 256 * times, 8);
        stage_end(&s);
    }
    CHECK(point[0] > 0.1);
    CHECK_NEAR(point[1], 0, 1e-9);
    CHECK_NEAR(area_light[1], area_light[0], 0.02 * area_light[0]);
    CHECK_NEAR(mesh_light[1], mesh_light[0], 0.02 * mesh_light[0]);
}

/* The view factor of a rectangle a x b at distance h, whose corner is above the point. */
static double corner_factor(double a, double b, double h) {
    double x = hypot(a, h), y = hypot(b, h);
    return (a / x * atan(b / x) + b / y * atan(a / y)) / (2 * 3.14159265358979323846);
}

/* A vertical mirror shows the floor the image of the light. Cameras see it in no mirror. */
TEST_TIMES(scattered_rays_meet_a_mesh_light_that_is_not_in_the_scene, 3) {
    const double direct = 4 * corner_factor(1, 1, 3), image = 2 * (corner_factor(5, 1, 3) - corner_factor(3, 1, 3));
    for (int strategy = PATH_STRATEGY_MIS; strategy <= PATH_STRATEGY_BSDF; strategy++) {
        for (int photons = 0; photons < 2; photons++) {
            struct stage s;
            (void)begin_floor(&s);
            struct material *mirror = stage_phong(&s, colour_all(0), colour_all(1), 1);
            mirror->phong.reflect = 1;
            (void)add_planar(&s, mirror,
                             planar_parallelogram(vec3_make(2, 0, -50), vec3_make(0, 50, 0), vec3_make(0, 0, 100)));
            (void)add_unseen_square(&s);
            s.camera.fov = 0.01;
            s.settings.path_strategy = (enum path_strategy)strategy;
            s.settings.caustics.photons = photons * 400000;
            s.settings.caustics.radius = 0.3;
            const int samples = times > 1 ? 2048 : strategy == PATH_STRATEGY_BSDF ? 1024 : 320;
            const struct effort effort = {ESTIMATE_SIZE_MAX, samples, times};
            if (photons) { /* the noise of the photons is equal in all pixels */
                const struct effort less = {ESTIMATE_SIZE_MAX, 128, 1};
                double mean = estimate_render(&s, &less, 2, 1).mean;
                CHECK_NEAR(mean, direct + image, 0.01 * (direct + image));
            } else {
                estimate_check_mean("a mesh light that is not in the scene, and its image in a mirror", direct + image,
                                    &s, &effort, 2);
            }
            s.settings.caustics.photons /= 100;
            s.camera = (struct camera){{1, 4, 0}, {1, -0.5, 0}, {0, 1, 0}, 0.01};
            CHECK(path_mean(&s, 1, 1) < 0.9); /* the mirror shows the camera a highlight and not the square */
            stage_end(&s);
        }
    }
}

TEST(materials_that_emit_light_the_scene_from_both_sides) {
    for (int turned = 0; turned < 2; turned++) {
        struct stage s;
        (void)begin_floor(&s);
        struct material *glow = stage_phong(&s, colour_all(0), colour_all(0), 1);
        glow->phong.emission = colour_all(1);
        (void)add_planar(&s, glow, planar_plane(vec3_make(0, turned ? 1 : -1, 0), turned ? 6 : -6));
        CHECK_NEAR(path_mean(&s, 64, 1), 1, 0.001);
        stage_end(&s);
    }
}

/* --- surfaces --- */

TEST(paths_pass_holes_as_often_as_their_opacity_leaves) {
    struct stage s;
    stage_begin(&s, 1);
    struct material *sheet = stage_phong(&s, colour_all(0), colour_all(0), 1);
    sheet->inputs[INPUT_OPACITY] = texture_keep(&s.scene.arena, texture_number(0.25), &s.error);
    (void)add_planar(&s, sheet, planar_plane(vec3_make(0, 0, 1), 0));
    s.sky.colour = colour_all(1);
    CHECK_NEAR(path_mean(&s, 1024, 1), 0.75, 0.004);
    s.camera.eye.z = 1e6; /* of any number of sheets */
    (void)add_planar(&s, sheet, planar_plane(vec3_make(0, 0, 1), -1));
    CHECK_NEAR(path_mean(&s, 1024, 1), 0.75 * 0.75, 0.005);
    stage_end(&s);
}

/* From inside of glass, beyond the critical angle, the eye sees what is in the glass behind it. */
TEST(total_reflection_is_total_whatever_use_tir_says) {
    for (int use_tir = 0; use_tir < 2; use_tir++) {
        struct stage s;
        stage_begin(&s, 1);
        s.settings.use_tir = use_tir;
        struct node *block = stage_cube(&s, s.root, stage_glass(&s, 0, 1, 1.5));
        stage_move(&s, block, -0.5, -0.5, 0);
        stage_scale(&s, block, 100, 100, 10);
        stage_move(&s, block, 0, 0, -1);
        struct material *glow = stage_phong(&s, colour_all(0), colour_all(0), 1);
        glow->phong.emission = colour_all(0.7);
        (void)add_planar(&s, glow, planar_plane(vec3_make(0, 0, -1), -2));
        s.camera = (struct camera){{0, 0, 0}, {2, 0, -1}, {0, 1, 0}, 5};
        CHECK_NEAR(path_mean(&s, 4, 4), 0.7, 1e-6);
        stage_end(&s);
    }
}

/* --- unphysical numbers --- */

TEST(negative_colours_are_kept) {
    struct stage s;
    stage_begin(&s, 1);
    struct material *material = stage_phong(&s, colour_all(-0.5), colour_all(0), 1);
    material->phong.emission = colour_all(1);
    material->phong.two_sided = true;
    (void)stage_sphere(&s, s.root, material);
    s.camera.eye = vec3_all(0);
    CHECK_NEAR(path_mean(&s, 512, 1000), 1 / 1.5, 0.003);
    stage_end(&s);
}

TEST(a_material_that_makes_light_ends_by_depth_and_is_named_once) {
    static const char scene[] =
        "local r = gr.node('r')\n"
        "local m = gr.material{kd={2,2,2}, emission={1,1,1}, two_sided=true}\n"
        "r:add_child(gr.sphere{material=m})\n"
        "gr.render{node=r, file='a.pfm', width=8, height=8, eye={0,0,0}, integrator='path', spp=16, max_depth=5}\n";
    struct test_result result = test_gray_scene(scene, "scene.lua", NULL);
    CHECK_EQ_INT(result.status, 0);
    const char *warning = strstr(result.err, "more light than it receives");
    CHECK(warning && !strstr(warning + 1, "more light than it receives"));
    test_free_result(&result);
    struct stage s;
    stage_begin(&s, 1);
    struct material *material = stage_phong(&s, colour_all(2), colour_all(0), 1);
    material->phong.emission = colour_all(1);
    material->phong.two_sided = true;
    (void)stage_sphere(&s, s.root, material);
    s.camera.eye = vec3_all(0);
    CHECK_NEAR(path_mean(&s, 1024, 5), 63, 0.2); /* 1 + 2 + ... + 32 */
    CHECK(isfinite(path_mean(&s, 1, 1000000)));  /* one path in twenty ends */
    stage_end(&s);
}

/* Also by the brightest texel of a picture. */
TEST(the_warning_of_materials_that_make_light_knows_the_texels_of_pictures) {
    static const char scene[] = "local r = gr.node('r')\n"
                                "local m = gr.material{kd=gr.texture('kd.pfm'), ks={.12,.12,.12}, shininess=40}\n"
                                "r:add_child(gr.sphere{material=m})\n"
                                "gr.render{node=r, file='a.pfm', width=8, height=8, eye={0,0,5}, integrator='path', "
                                "spp=1}\n";
    for (int bright = 0; bright < 2; bright++) {
        char picture[64];
        const float texels[3] = {0.9F, bright ? 1.5F : 0.25F, 0.5F};
        int header = snprintf(picture, sizeof picture, "PF\n1 1\n-1\n");
        memcpy(picture + header, texels, sizeof texels);
        test_write_file(test_path("kd.pfm"), picture, (size_t)header + sizeof texels);
        struct test_result result = test_gray_scene(scene, "scene.lua", NULL);
        CHECK_EQ_INT(result.status, 0);
        CHECK((strstr(result.err, "more light than it receives") != NULL) == bright);
        test_free_result(&result);
    }
}

TEST(an_emitter_without_bounds_has_one_notice) {
    static const char *const nodes[] = {
        "r:add_child(gr.plane{name='floor', normal={0,1,0}, material=m})\n"
        "r:add_child(gr.plane{normal={0,1,0}, distance=9, material=m})\n",
        "r:add_child(gr.csg_difference('floor', gr.plane{normal={0,1,0}, material=m}, gr.sphere{material=m}))\n"};
    for (size_t i = 0; i < sizeof nodes / sizeof *nodes; i++) {
        char scene[1024];
        (void)snprintf(scene, sizeof scene,
                       "local r, m = gr.node('r'), gr.material{kd={0,0,0}, emission={1,1,1}, two_sided=true}\n%s"
                       "gr.render{node=r, file='a.pfm', width=8, height=8, eye={0,1,0}, integrator='path', spp=16}\n",
                       nodes[i]);
        struct test_result result = test_gray_scene(scene, "scene.lua", NULL);
        CHECK_EQ_INT(result.status, 0);
        const char *notice = strstr(result.err, "has no bounds");
        CHECK(strstr(result.err, "'floor' emits light") != NULL);
        CHECK(notice && !strstr(notice + 1, "has no bounds"));
        test_free_result(&result);
    }
}

/* --- media --- */

TEST(fog_dims_lines_of_sight_as_in_whitted_and_nothing_else) {
    const struct fog fog = {.kind = FOG_EXPONENTIAL, .colour = {0.2, 0.2, 0.2}, .density = 0.1};
    struct stage s;
    (void)begin_floor(&s);
    struct material *mirror = stage_phong(&s, colour_all(0), colour_all(0.9), 1);
    mirror->phong.reflect = 1;
    struct node *ball = stage_sphere(&s, s.root, mirror);
    stage_move(&s, ball, 0.5, 1, 0);
    (void)add_light(&s, LIGHT_POINT);
    s.sky.colour = colour_all(0); /* that does not light anything */
    s.fog = &fog;
    s.settings.reflect_limit = 1;
    double want = whitted_mean(&s, 8, 8);
    CHECK_NEAR(path_mean(&s, 1024, 2), want, 0.01 * want);
    stage_end(&s);
}

TEST(glass_absorbs_along_paths) {
    struct stage s;
    stage_begin(&s, 1);
    struct material *glass = stage_glass(&s, 0, 1, 1), *glow = stage_phong(&s, colour_all(0), colour_all(0), 1);
    glass->phong.absorption = colour_all(0.7);
    glow->phong.emission = colour_all(1);
    struct node *pane = stage_cube(&s, s.root, glass);
    stage_move(&s, pane, -0.5, -0.5, -0.5);
    stage_scale(&s, pane, 100, 100, 2);
    (void)add_planar(&s, glow, planar_plane(vec3_make(0, 0, 1), -5));
    s.camera.fov = 0.01;
    CHECK_NEAR(path_mean(&s, 16, 4), exp(-0.7 * 2), 1e-5);
    stage_end(&s);
}

/* Light 1 from everywhere, a floor that reflects all of it, and a clear ball on it: rays that enter at the rim are
 * reflected inside up to hundreds of times, others meet the floor near its point of contact. Nothing is lost, so ball
 * and floor are invisible. */
TEST(a_clear_ball_on_a_white_floor_is_invisible_in_even_light_also_at_its_rim) {
    enum { WIDTH = 48, RINGS = 4 };
    struct stage s;
    stage_begin(&s, 2);
    struct material *glass = scene_material(&s.scene, MATERIAL_FRESNEL, stage_glass(&s, 0, 1, 1.5), &s.error);
    stage_move(&s, stage_sphere(&s, s.root, glass), 0, 1, 0);
    (void)add_planar(&s, stage_phong(&s, colour_all(1), colour_all(0), 1), planar_plane(vec3_make(0, 1, 0), 0));
    s.sky.colour = colour_all(1);
    s.camera = (struct camera){{0, 1, 8}, {0, 0, -1}, {0, 1, 0}, 15};
    s.settings.integrator = INTEGRATOR_PATH;
    s.settings.path_samples = 64;
    s.settings.max_depth = s.settings.roulette_depth = 1000;
    CHECK(stage_render(&s, WIDTH, WIDTH));
    double sums[RINGS + 1] = {0}, counts[RINGS + 1] = {0};
    double radius = 1 / sqrt(63) / tan(7.5 * 3.14159265358979323846 / 180) * WIDTH / 2;
    for (uint32_t i = 0; i < WIDTH * WIDTH; i++) {
        double from = hypot(i % WIDTH + 0.5 - WIDTH / 2, i / WIDTH + 0.5 - WIDTH / 2) / radius;
        int ring = from < 1 ? (int)(RINGS * from * from * from * from) : RINGS; /* thin at the rim */
        double value = stage_pixel(&s, i % WIDTH, i / WIDTH).r;
        CHECK(value > 0.85 && value < 1.15);
        sums[ring] += value;
        counts[ring]++;
    }
    for (int ring = 0; ring <= RINGS; ring++)
        CHECK_NEAR(sums[ring] / counts[ring], 1, 0.002);
    stage_end(&s);
}
