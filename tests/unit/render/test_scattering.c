/* Light that a medium scatters, along paths: against closed forms and integrals. */
#include "tests/harness.h"

#include "film/path_film.h"
#include "light/light_bounds.h"
#include "material/density.h"
#include "tests/stage.h"
#include "tests/unit/path_estimate.h"

#include <math.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

static struct medium medium_of(struct colour absorption, struct colour scattering, double g) {
    return medium_scattering(&(struct medium_input){
        .absorption = absorption, .scattering = scattering, .phase = {PHASE_HENYEY_GREENSTEIN, g}});
}

/* A room with a ball of radius 1 as its only wall, seen from the middle. */
static struct material *begin_room(struct stage *s, const struct medium *medium) {
    stage_begin(s, 2);
    struct material *wall = stage_phong(s, colour_all(0), colour_all(0), 1);
    (void)stage_sphere(s, s->root, wall);
    s->camera.eye = vec3_all(0);
    s->medium = medium;
    s->settings.integrator = INTEGRATOR_PATH;
    return wall;
}

static struct colour mean_of(struct stage *s, uint32_t side, int samples, int depth) {
    struct colour sum = {0, 0, 0};
    s->settings.path_samples = samples;
    s->settings.max_depth = depth;
    CHECK(stage_render(s, side, side));
    for (uint32_t i = 0; i < side * side; i++)
        sum = colour_add(sum, stage_pixel(s, i % side, i / side));
    return colour_scale(sum, 1.0 / (side * side));
}

TEST(what_is_not_scattered_is_beers_law_of_absorption_and_scattering) {
    const struct medium medium = medium_of(colour_make(0.1, 0.5, 0), colour_make(0.3, 0.5, 2), 0.4);
    struct stage s;
    begin_room(&s, &medium)->phong.emission = colour_all(1);
    struct colour mean = mean_of(&s, 8, 1024, 0);
    CHECK_NEAR(mean.r, exp(-0.4), 4e-3);
    CHECK_NEAR(mean.g, exp(-1), 4e-3);
    CHECK_NEAR(mean.b, exp(-2), 4e-3);
    stage_end(&s);
}

/* Whichever event a path meets first. */
TEST(features_seen_through_a_medium_are_the_mean_of_the_medium_and_what_is_behind) {
    const struct medium medium = medium_of(colour_make(0.2, 0.1, 0), colour_make(0.2, 0.3, 0.4), 0);
    struct stage s;
    begin_room(&s, &medium)->phong.kd = colour_make(0.5, 0.2, 0.1);
    s.settings.denoise = DENOISER_GRAY;
    (void)mean_of(&s, 8, 2, 4);
    const double left = exp(-0.4),
                 albedo[3] = {0.5 * left + 0.5 * (1 - left), 0.2 * left + 0.75 * (1 - left), 0.1 * left + (1 - left)};
    for (size_t i = 0; i < 64; i++) {
        const struct path_pixel pixel = path_film_load(&s.film, i);
        double normal = 0;
        for (int c = 0; c < 3; c++) {
            double part = path_pixel_feature(&pixel, 0, PATH_NORMAL + c);
            CHECK_NEAR(path_pixel_feature(&pixel, 0, PATH_ALBEDO + c), albedo[c], 1e-6);
            normal += part * part;
        }
        CHECK_NEAR(sqrt(normal), left, 1e-5);
        CHECK_NEAR(path_pixel_feature(&pixel, 1, PATH_DEPTH), 1, 1e-5);
    }
    stage_end(&s);
}

/* A medium that absorbs nothing, in uniform light, whatever its density and its phase function. */
TEST(white_media_are_invisible_in_uniform_light) {
    const double g[] = {0, 0.75, -0.5};
    for (int i = 0; i < 3; i++) {
        const struct medium medium = medium_of(colour_all(0), colour_make(0.1, 1, 10), g[i]);
        for (int strategy = PATH_STRATEGY_MIS; strategy <= PATH_STRATEGY_BSDF; strategy += 2) {
            struct stage s;
            begin_room(&s, &medium)->phong.emission = colour_all(1);
            s.settings.path_strategy = (enum path_strategy)strategy;
            struct colour mean = mean_of(&s, 4, 1024, 1000);
            CHECK_NEAR(mean.r, 1, 0.015);
            CHECK_NEAR(mean.g, 1, 0.015);
            CHECK_NEAR(mean.b, 1, 0.03);
            CHECK_NEAR((mean.r + mean.g + mean.b) / 3, 1, 0.01);
            stage_end(&s);
        }
    }
}

/* Along -z through the light of a lamp, at last of a spot: the integral of scattering, phase function and attenuation
 * in the room. */
TEST(light_of_a_lamp_that_is_scattered_once_is_the_integral_along_the_line_of_sight) {
    const double g[] = {0, 0.7, -0.6, 0.2};
    for (int i = 0; i < 4; i++) {
        const struct medium medium = medium_of(colour_all(0.2), colour_make(0.5, 0.25, 1.5), g[i]);
        struct stage s;
        (void)begin_room(&s, &medium);
        struct vec3 lamp = {0.3, 0, -0.4};
        s.lights[s.light_count++] = (struct light){.kind = LIGHT_POINT,
                                                   .position = lamp,
                                                   .colour = {1, 1, 1},
                                                   .attenuation = ATTENUATION_INVERSE_SQUARE,
                                                   .direction = {-1, 0, 0},
                                                   .cos_inner = 0.95,
                                                   .cos_outer = 0.85,
                                                   .intensity = 1};
        s.lights[0].kind = i == 3 ? LIGHT_SPOT : LIGHT_POINT;
        const struct light lamp_there = s.lights[0];
        s.camera.fov = 0.01;
        struct colour mean = mean_of(&s, 4, 8192, 1);
        enum { STEPS = 20000 };
        for (int axis = 0; axis < 3; axis++) {
            double sum = 0, e = colour_get(medium.extinction, axis), scattering = colour_get(medium.scattering, axis);
            for (int k = 0; k < STEPS; k++) {
                double t = (k + 0.5) / STEPS, z = -t, r2 = lamp.x * lamp.x + (lamp.z - z) * (lamp.z - z), r = sqrt(r2);
                double cosine = -(lamp.z - z) / r, q = 1 + g[i] * g[i] - 2 * g[i] * cosine;
                double phase = (1 - g[i] * g[i]) / (4 * pi * q * sqrt(q));
                double cone = i == 3 ? light_cone(&lamp_there, vec3_make(-lamp.x / r, 0, (z - lamp.z) / r)) : 1;
                sum += cone * scattering * phase / r2 * exp(-e * (t + r)) / STEPS;
            }
            CHECK_NEAR(colour_get(mean, axis) / pi, sum, 0.015 * sum);
        }
        stage_end(&s);
    }
}

TEST(samples_of_lights_and_of_phase_functions_find_the_same_light) {
    const struct medium medium = medium_of(colour_make(0.1, 0.3, 0), colour_make(1, 0.5, 2), 0.5);
    struct colour means[3];
    for (int strategy = PATH_STRATEGY_MIS; strategy <= PATH_STRATEGY_BSDF; strategy++) {
        struct stage s;
        (void)begin_room(&s, &medium);
        struct material *glow = stage_phong(&s, colour_all(0), colour_all(0), 1);
        glow->phong.emission = colour_make(4, 5, 6);
        struct node *ball = stage_sphere(&s, s.root, glow);
        stage_move(&s, ball, 0.5, 0.2, -0.3);
        stage_scale(&s, ball, 0.3, 0.3, 0.3);
        s.settings.path_strategy = (enum path_strategy)strategy;
        means[strategy] = mean_of(&s, 8, 2048, 8);
        stage_end(&s);
    }
    for (int i = 1; i < 3; i++) {
        CHECK_NEAR(means[i].r, means[0].r, 0.02 * means[0].r);
        CHECK_NEAR(means[i].g, means[0].g, 0.02 * means[0].g);
        CHECK_NEAR(means[i].b, means[0].b, 0.02 * means[0].b);
    }
}

/* e / s (1 - exp(-s d)), by both integrators; the room is black. */
TEST(the_emission_of_a_medium_is_seen_by_both_integrators) {
    struct medium medium = medium_of(colour_all(1), colour_all(0), 0);
    medium.emission = colour_make(1, 0.5, 0);
    for (int scatters = 0; scatters < 2; scatters++) {
        struct stage s;
        (void)begin_room(&s, &medium);
        for (int i = 0; i < 2; i++) {
            s.settings.integrator = i ? INTEGRATOR_PATH : INTEGRATOR_WHITTED;
            struct colour mean = mean_of(&s, 2, 64, 0);
            CHECK_NEAR(mean.r, 0.632121, 1e-6);
            CHECK_NEAR(mean.g, 0.632121 / 2, 1e-6);
            CHECK_NEAR(mean.b, 0, 0);
        }
        stage_end(&s);
        medium.scatters = true;
    }
}

/* --- media that fill solids --- */

static struct medium filling_of(double absorption, double scattering, double g) {
    return medium_filling(&(struct medium_input){.absorption = colour_all(absorption),
                                                 .scattering = colour_all(scattering),
                                                 .phase = {PHASE_HENYEY_GREENSTEIN, g}});
}

/* A slab from z0 to z1, which is wide. */
static void add_slab(struct stage *s, const struct material *material, double z0, double z1) {
    struct node *slab = stage_cube(s, s->root, material);
    stage_move(s, slab, -0.5, -0.5, 0);
    stage_scale(s, slab, 40, 40, z1 - z0);
    stage_move(s, slab, 0, 0, z0);
}

TEST(white_media_in_solids_are_invisible_in_uniform_light) {
    const struct medium medium = filling_of(0, 3, 0.4);
    for (int cube = 0; cube < 2; cube++) {
        for (int inside = 0; inside < 2; inside++) {
            struct stage s;
            stage_begin(&s, 2);
            (void)(cube ? stage_cube(&s, s.root, stage_filling(&s, &medium))
                        : stage_sphere(&s, s.root, stage_filling(&s, &medium)));
            s.sky.colour = colour_all(1);
            s.camera.eye = inside ? vec3_make(0.4, 0.3, 0.5) : vec3_make(0, 0, 3);
            s.settings.integrator = INTEGRATOR_PATH;
            CHECK_NEAR(mean_of(&s, 16, 256, 1000).g, 1, 0.003);
            stage_end(&s);
        }
    }
}

/* Slabs in a row before a glowing wall: what is left is the product, by both integrators; their invisible surfaces
 * count neither as depth nor as refraction. A slab inside another one adds to it. */
TEST(solids_filled_with_media_dim_what_is_behind_them_and_cost_no_depth) {
    const struct medium thin = filling_of(0.3, 0, 0), dense = filling_of(1.1, 0, 0);
    struct stage s;
    stage_begin(&s, 1);
    struct material *glow = stage_phong(&s, colour_all(0), colour_all(0), 1);
    glow->phong.emission = colour_all(1);
    add_slab(&s, glow, -6, -5);
    add_slab(&s, stage_filling(&s, &thin), -1, 1);
    add_slab(&s, stage_filling(&s, &dense), -0.25, 0.25);
    add_slab(&s, stage_filling(&s, &thin), 2, 3);
    add_slab(&s, stage_filling(&s, &dense), 3, 3.5);
    s.camera.fov = 0.01;
    for (int inside = 0; inside < 2; inside++) {
        s.camera.eye = vec3_make(0, 0, inside ? 0 : 10);
        double depth = inside ? 1.1 * 0.25 + 0.3 : 1.1 * (0.5 + 0.5) + 0.3 * (1 + 2);
        for (int i = 0; i < 2; i++) {
            s.settings.integrator = i ? INTEGRATOR_PATH : INTEGRATOR_WHITTED;
            s.settings.reflect_limit = s.settings.refract_limit = 0;
            CHECK_NEAR(mean_of(&s, 2, 16, 0).g, exp(-depth), 1e-6);
        }
    }
    stage_end(&s);
}

TEST(shadow_rays_are_dimmed_by_the_media_that_they_pass) {
    const struct medium medium = filling_of(0.4, 0.3, 0);
    double light[2];
    for (int filling = 0; filling < 2; filling++) {
        struct stage s;
        stage_floor(&s);
        s.lights[0] = (struct light){.kind = LIGHT_POINT, .position = {0, 8, 0}, .colour = {1, 1, 1}};
        struct node *slab = stage_cube(&s, s.root, stage_filling(&s, &medium));
        stage_move(&s, slab, -0.5, 0, -0.5);
        stage_scale(&s, slab, 4, 2, 4);
        stage_move(&s, slab, 0, filling ? 3 : 20, 0);
        s.camera.eye = vec3_make(0, 1, 0.001);
        s.camera.view = vec3_make(0, -1, 0);
        s.camera.up = vec3_make(0, 0, 1);
        s.camera.fov = 0.01;
        s.settings.integrator = INTEGRATOR_PATH;
        light[filling] = mean_of(&s, 2, 16, 1).g;
        stage_end(&s);
    }
    CHECK(light[0] > 0.01);
    CHECK_NEAR(light[1] / light[0], exp(-0.7 * 2), 1e-5);
}

TEST(an_open_shape_holds_no_medium) {
    const struct medium medium = filling_of(0.4, 0.3, 0);
    struct stage s;
    stage_begin(&s, 1);
    struct node *pane = stage_sphere(&s, s.root, stage_filling(&s, &medium));
    pane->shape = (struct shape){.kind = SHAPE_PLANAR, .planar = planar_disc(vec3_all(0), vec3_make(0, 0, 1), 1, 0)};
    CHECK(!stage_build(&s, s.root, ACCEL_AUTO));
    CHECK(strstr(s.error.text, "is open, so it holds no medium") != NULL);
    stage_end(&s);
}

static int seeds_of(int times) {
    return times > 1 ? 3 : 1;
}

/* Against a value with four digits: within four standard errors, which are at most .1 % in the long form. */
static void check_share(const char *claim, double want, struct estimate e, int seed, int times) {
    estimate_record(claim, want, e, seed);
    if (!(fabs(e.mean - want) <= 4 * e.error + (times > 1 ? 0.0001 : 0.0015)) ||
        !(e.error <= (times > 1 ? 0.001 : 0.05) * want))
        test_fail(__FILE__, __LINE__, "%s, seed %d: %.6f +- %.2g, not %.4f", claim, seed, e.mean, e.error, want);
}

/* Shares of a normal beam, known values of transport theory (the last one: van de Hulst, "Multiple Light Scattering",
 * 1980): by reciprocity what the camera sees along the normal of a slab in front of, or behind, a plane of radiance 1.
 */
TEST_TIMES(slabs_reflect_and_transmit_as_transport_theory_says, 40) {
    static const struct {
        double albedo, g, depth, reflected, transmitted;
    } slabs[] = {{1, 0, 1, 0.3413, 0.6587},
                 {1, 0, 4, 0.6910, 0.3090},
                 {0.9, 0, 1, 0.2674, 0.5916},
                 {0.9, 0.75, 2, 0.09740, 0.66096}};
    for (int k = 0; k < 4 * seeds_of(times); k++) {
        const int i = k % 4, samples = 4096 * times * (times > 1 && i == 3 ? 4 : 1);
        const struct medium medium =
            filling_of((1 - slabs[i].albedo) * slabs[i].depth, slabs[i].albedo * slabs[i].depth, slabs[i].g);
        for (int behind = 0; behind < 2; behind++) {
            struct stage s;
            stage_begin(&s, 2);
            struct material *glow = stage_phong(&s, colour_all(0), colour_all(0), 1);
            glow->phong.emission = colour_all(1);
            glow->phong.two_sided = true;
            struct node *wall = stage_sphere(&s, s.root, glow);
            wall->shape =
                (struct shape){.kind = SHAPE_PLANAR, .planar = planar_plane(vec3_make(0, 0, 1), behind ? -5 : 20)};
            struct node *slab = stage_cube(&s, s.root, stage_filling(&s, &medium));
            stage_move(&s, slab, -0.5, -0.5, 0);
            stage_scale(&s, slab, 400, 400, 1);
            s.camera.fov = 0.01;
            s.settings.integrator = INTEGRATOR_PATH;
            s.settings.seed = (uint64_t)(k / 4);
            (void)mean_of(&s, 8, samples / 4, 1000);
            double want = behind ? slabs[i].transmitted : slabs[i].reflected;
            check_share(behind ? "slab, normal beam: transmitted" : "slab, normal beam: reflected", want,
                        estimate_of(&s, 1), k / 4 + 1, times);
            stage_end(&s);
        }
    }
}

/* Fog around a lamp, a spot and a floor; and smoke in a ball: Whitted's strata against paths cut to one scattering.
 * Emission, whose light Whitted's integrator does not scatter, is compared without the lamp and without scattering. */
TEST_TIMES(media_of_whitted_are_those_of_paths_that_scatter_once, 16) {
    struct arena arena = {0};
    struct error error = {0};
    const struct box box = {{-5, -0.5, -5}, {5, 1.2, 5}};
    const float values[8] = {0, 1, 2, 1, 0.5, 0, 3, 1};
    const struct density_grid grid = {{{-1, 0, -1}, {1, 1.5, 1}}, {2, 2, 2}, values, 1, false};
    for (int k = 0; k < 8; k++) {
        const int i = k / 2;
        const bool glows = k & 1;
        const struct medium_input in = {.absorption = colour_make(0.1, 0, 0.2),
                                        .scattering = colour_make(0.2, 0.3, 0.1),
                                        .emission = glows ? colour_make(0.005, 0.01, 0.02) : colour_all(0),
                                        .phase = {PHASE_HENYEY_GREENSTEIN, 0.3},
                                        .density = i == 1   ? density_of_box(&arena, &box, &error)
                                                   : i == 2 ? density_of_grid(&arena, &grid, &error)
                                                            : NULL};
        const struct medium outside = medium_scattering(&in), inside = medium_filling(&in);
        struct colour means[2];
        for (int path = 0; path < 2; path++) {
            struct stage s;
            stage_floor(&s);
            s.lights[0] = (struct light){.kind = LIGHT_POINT,
                                         .position = {0.5, 1.6, -0.5},
                                         .colour = {1, 1, 1},
                                         .attenuation = ATTENUATION_INVERSE_SQUARE,
                                         .intensity = 1};
            s.camera.eye = vec3_make(0, 1, 4);
            s.camera.view = vec3_make(0, -0.1, -1);
            s.camera.fov = 60;
            s.light_count = !glows;
            s.medium = i < 3 ? &outside : NULL;
            if (i == 3)
                stage_move(&s, stage_sphere(&s, s.root, stage_filling(&s, &inside)), 0, 1, 0);
            s.settings.integrator = path ? INTEGRATOR_PATH : INTEGRATOR_WHITTED;
            s.settings.medium_samples = 16 * times;
            s.settings.full = true;
            s.settings.samples = 4;
            means[path] = mean_of(&s, 16, 64 * times, !glows);
            stage_end(&s);
        }
        CHECK_NEAR(means[0].r, means[1].r, 0.05 * means[1].r);
        CHECK_NEAR(means[0].g, means[1].g, 0.05 * means[1].g);
        CHECK_NEAR(means[0].b, means[1].b, 0.05 * means[1].b);
    }
    arena_destroy(&arena);
}

/* Lamps that are sampled at distances of their own: the same light as by brute force, where only scattered rays find
 * the lamp. One lamp, or more of unlike brightness than a ray chooses from. */
TEST_TIMES(aimed_distances_and_scattered_rays_find_the_same_light_of_a_lamp, 16) {
    struct arena arena = {0};
    struct error error = {0};
    const float values[8] = {0, 1, 2, 1, 0.5, 0, 3, 1};
    const struct density_grid grid = {{vec3_all(-1), vec3_all(1)}, {2, 2, 2}, values, 1, false};
    const struct medium_input in = {.absorption = colour_make(0.1, 0, 0.2),
                                    .scattering = colour_make(0.2, 0.6, 1),
                                    .phase = {PHASE_HENYEY_GREENSTEIN, 0.3}};
    for (int i = 0; i < 3; i++) {
        struct medium_input own = in;
        own.density = i == 1 ? density_of_grid(&arena, &grid, &error) : NULL;
        const struct medium medium = medium_scattering(&own);
        struct colour means[2];
        for (int brute = 0; brute < 2; brute++) {
            struct stage s;
            (void)begin_room(&s, &medium);
            for (int k = 0; k < (i == 2 ? 18 : 1); k++)
                s.lights[s.light_count++] = (struct light){.kind = LIGHT_SPHERE,
                                                           .position = {0.3 - 0.05 * k, 0.2 - 0.04 * k, -0.4},
                                                           .radius = 0.25,
                                                           .colour = {1 + k % 5, 1, 1},
                                                           .intensity = 1};
            s.settings.path_strategy = brute ? PATH_STRATEGY_BSDF : PATH_STRATEGY_MIS;
            means[brute] = mean_of(&s, 8, 1024 * times, 2);
            stage_end(&s);
        }
        CHECK(means[1].g > 1e-3);
        for (int k = 0; k < 3; k++)
            CHECK_NEAR(colour_get(means[0], k), colour_get(means[1], k), 0.04 * colour_get(means[1], k));
    }
    arena_destroy(&arena);
}

/* --- densities, several media, surfaces --- */

/* A white cloud in a ball that lies in another cloud, from the outside and from the inside. */
TEST_TIMES(white_media_of_any_density_are_invisible_in_uniform_light, 8) {
    static const float values[8] = {0, 5, 2, 1, 0.5, 0, 30, 1};
    struct arena arena = {0};
    struct error error = {0};
    const struct density_grid grid = {{vec3_all(-1), vec3_all(1)}, {2, 2, 2}, values, 3, false};
    const struct box box = {vec3_all(-2), {2, 0.3, 2}};
    const struct medium_input cloud = {.scattering = colour_make(0.3, 1, 3),
                                       .phase = {PHASE_HENYEY_GREENSTEIN, 0.6},
                                       .density = density_of_grid(&arena, &grid, &error)};
    const struct medium_input haze = {
        .scattering = colour_all(0.5), .phase = {PHASE_RAYLEIGH, 0}, .density = density_of_box(&arena, &box, &error)};
    const struct medium inner = medium_filling(&cloud), outer = medium_filling(&haze);
    for (int inside = 0; inside < 2; inside++) {
        struct stage s;
        stage_begin(&s, 2);
        (void)stage_sphere(&s, s.root, stage_filling(&s, &inner));
        struct material *other = stage_phong(&s, colour_all(0), colour_all(0), 1);
        *other = *stage_filling(&s, &outer);
        struct node *cube = stage_cube(&s, s.root, other);
        stage_move(&s, cube, -0.5, -0.5, -0.5);
        stage_scale(&s, cube, 3, 3, 3);
        s.sky.colour = colour_all(1);
        s.camera.eye = inside ? vec3_make(0.4, -0.3, 0.5) : vec3_make(0, 0, 3);
        s.settings.integrator = INTEGRATOR_PATH;
        struct colour mean = mean_of(&s, 16, 64 * times, 1000);
        CHECK_NEAR(mean.r, 1, 0.012);
        CHECK_NEAR(mean.g, 1, 0.012);
        CHECK_NEAR(mean.b, 1, 0.025);
        stage_end(&s);
    }
    arena_destroy(&arena);
}

/* A cube that is moved, turned and scaled, with a grid in its own space or one that fits it, and the same in the world.
 */
TEST(a_density_moves_with_its_solid) {
    static const float own[8] = {0, 1, 2, 3, 0.5, 0, 4, 1}, turned[8] = {2, 0, 3, 1, 4, 0.5, 1, 0};
    struct colour means[3], one[3];
    for (int i = 0; i < 3; i++) {
        struct arena arena = {0};
        struct error error = {0};
        const struct density_grid grid = {i == 0 ? (struct box){{-1, -2, -8}, {3, 2, -4}}
                                                 : (struct box){vec3_all(0), vec3_all(1)},
                                          {2, 2, 2},
                                          i == 0 ? turned : own,
                                          1,
                                          i == 2};
        const struct medium_input in = {.absorption = colour_make(0.1, 0.3, 0.6),
                                        .density = density_of_grid(&arena, &grid, &error)};
        const struct medium outside = medium_scattering(&in), inside = medium_filling(&in);
        struct stage s;
        stage_begin(&s, 2);
        if (i > 0) {
            struct node *cube = stage_cube(&s, s.root, stage_filling(&s, &inside));
            stage_scale(&s, cube, 4, 4, 4);
            stage_rotate(&s, cube, 2, 90);
            stage_move(&s, cube, 3, -2, -8);
        }
        s.medium = i == 0 ? &outside : NULL;
        s.sky.colour = colour_all(1);
        s.camera.eye = vec3_make(0, 1, 0);
        for (int path = 0; path < 2; path++) {
            s.settings.integrator = path ? INTEGRATOR_PATH : INTEGRATOR_WHITTED;
            (path ? means : one)[i] = mean_of(&s, 16, path ? 64 : 1, 10);
        }
        CHECK_NEAR(means[i].g, one[i].g, 0.005);
        stage_end(&s);
        arena_destroy(&arena);
    }
    for (int i = 1; i < 3; i++) {
        CHECK(means[i].b < 0.9);
        CHECK_NEAR(means[i].g, means[0].g, 0.005);
        CHECK_NEAR(one[i].r, one[0].r, 1e-6);
        CHECK_NEAR(one[i].b, one[0].b, 1e-6);
    }
}

/* The index is 1, so the surface is there in name only. */
TEST(a_medium_behind_a_surface_of_index_1_is_the_one_that_fills_the_solid) {
    struct medium fills = filling_of(0.4, 1.5, 0.3), behind = fills;
    struct colour means[2];
    behind.fills = false;
    for (int i = 0; i < 2; i++) {
        struct stage s;
        stage_begin(&s, 2);
        struct material *glass = stage_glass(&s, 0, 1, 1);
        glass->phong.ks = colour_all(1);
        glass->medium = &behind;
        (void)stage_sphere(&s, s.root, i ? glass : stage_filling(&s, &fills));
        s.sky.colour = colour_make(0.5, 1, 2);
        s.camera.eye = vec3_make(0, 0, 3);
        s.settings.integrator = INTEGRATOR_PATH;
        means[i] = mean_of(&s, 16, 512, 100);
        stage_end(&s);
    }
    CHECK(means[0].g < 0.9);
    CHECK_NEAR(means[1].r, means[0].r, 0.01 * means[0].r);
    CHECK_NEAR(means[1].g, means[0].g, 0.01 * means[0].g);
    CHECK_NEAR(means[1].b, means[0].b, 0.01 * means[0].b);
}

/* What a slab of this depth shows in a direction with this cosine to its normal, of a plane of radiance 1 on the side
 * of the camera or behind it. */
static struct estimate shown(const struct medium *medium, double cosine, bool behind, int samples, int seed) {
    struct stage s;
    stage_begin(&s, 2);
    struct material *glow = stage_phong(&s, colour_all(0), colour_all(0), 1);
    glow->phong.emission = colour_all(1);
    glow->phong.two_sided = true;
    struct node *wall = stage_sphere(&s, s.root, glow);
    wall->shape = (struct shape){.kind = SHAPE_PLANAR, .planar = planar_plane(vec3_make(0, 0, 1), behind ? -5 : 20)};
    struct node *slab = stage_cube(&s, s.root, stage_filling(&s, medium));
    stage_move(&s, slab, -0.5, -0.5, 0);
    stage_scale(&s, slab, 4000, 4000, 1);
    s.camera.fov = 0.001;
    s.camera.view = vec3_make(sqrt(1 - cosine * cosine), 0, -cosine);
    s.camera.up = vec3_make(0, 1, 0);
    s.settings.integrator = INTEGRATOR_PATH;
    s.settings.seed = (uint64_t)seed;
    (void)mean_of(&s, 4, samples, 1000);
    struct estimate e = estimate_of(&s, 1);
    stage_end(&s);
    return e;
}

/* Known values of transport theory, of diffuse light by the mean over directions; depth 60 is as good as a half space.
 */
TEST_TIMES(slabs_in_diffuse_light_and_half_spaces_are_those_of_transport_theory, 16) {
    static const struct {
        double albedo, depth, cosine, reflected, transmitted; /* cosine 0: diffuse light */
    } slabs[] = {{1, 1, 0, 0.4466, 0.5534},
                 {0.9, 2, 0, 0.4372, 0.2656},
                 {0.9, 60, 1, 0.4149, -1},
                 {0.9, 60, 0.5, 0.5079, -1},
                 {0.9, 60, 0, 0.4780, -1}};
    const int samples = 128 * times, directions = times > 1 ? 64 : 8;
    for (int n = 0; n < 5 * seeds_of(times); n++) {
        const int i = n % 5;
        const struct medium medium =
            filling_of((1 - slabs[i].albedo) * slabs[i].depth, slabs[i].albedo * slabs[i].depth, 0);
        for (int behind = 0; behind < (slabs[i].transmitted >= 0 ? 2 : 1); behind++) {
            struct estimate sum = {0, 0};
            for (int k = 0; k < directions; k++) {
                double cosine = slabs[i].cosine > 0 ? slabs[i].cosine : sqrt((k + 0.5) / directions);
                struct estimate e = shown(&medium, cosine, behind, samples, 1000 * (n / 5) + k);
                sum.mean += e.mean / directions;
                sum.error += e.error * e.error / directions / directions;
            }
            sum.error = sqrt(sum.error);
            check_share(behind ? "slab, diffuse light: transmitted" : "slab or half space: reflected",
                        behind ? slabs[i].transmitted : slabs[i].reflected, sum, n / 5 + 1, times);
        }
    }
}

/* Coefficients of .1, 1 and 10 against those of a gray medium: the variance of the mean of the channels. */
TEST(channels_with_other_coefficients_have_at_most_twice_the_variance_of_a_gray_medium) {
    double variance[2];
    for (int gray = 0; gray < 2; gray++) {
        struct medium medium = medium_filling(&(struct medium_input){
            .scattering = gray ? colour_all(1) : colour_make(0.1, 1, 10), .phase = {PHASE_HENYEY_GREENSTEIN, 0}});
        struct stage s;
        stage_begin(&s, 2);
        (void)stage_sphere(&s, s.root, stage_filling(&s, &medium));
        s.sky.colour = colour_all(1);
        s.camera.eye = vec3_make(0, 0, 3);
        s.camera.fov = 20;
        s.settings.integrator = INTEGRATOR_PATH;
        s.settings.path_samples = 16;
        s.settings.max_depth = 1000;
        CHECK(stage_render(&s, 32, 32));
        double sum = 0;
        for (uint32_t i = 0; i < 1024; i++) {
            struct colour c = stage_pixel(&s, i % 32, i / 32);
            double off = (c.r + c.g + c.b) / 3 - 1;
            sum += off * off;
        }
        variance[gray] = sum / 1024;
        stage_end(&s);
    }
    CHECK(variance[0] <= 2 * variance[1] + 1e-9);
}
