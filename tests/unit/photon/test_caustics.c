/* Caustics: photons arrive where geometry says, in the unit of direct light. */
#include "light/sky.h"
#include "material/openpbr.h"
#include "math/elementary.h"
#include "photon/photon_trace.h"
#include "shape/planar.h"
#include "shape/revolved_quadric.h"
#include "tests/harness.h"
#include "tests/stage.h"
#include "tests/unit/mesh_makers.h"
#include "tests/unit/path_estimate.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The inverse of photon_pack (Z. Cigolle et al., "A Survey of Efficient Representations for Independent Unit Vectors",
 * JCGT 2014, section 3). */
static struct vec3 unpacked(uint32_t packed) {
    double u = (packed >> 16) / 32767.5 - 1, v = (packed & 65535) / 32767.5 - 1, z = 1 - fabs(u) - fabs(v);
    if (z < 0)
        return vec3_normalize(vec3_make(copysign(1 - fabs(v), u), copysign(1 - fabs(u), v), z));
    return vec3_normalize(vec3_make(u, v, z));
}

static const double pi = 3.14159265358979323846;

static struct material *white(struct stage *s) {
    struct material *material = stage_phong(s, colour_all(1), colour_all(0), 1);
    material->phong.two_sided = true;
    return material;
}

static struct material *mirror(struct stage *s) {
    struct material *material = stage_phong(s, colour_all(0), colour_all(1), 1);
    material->phong.reflect = 1;
    return material;
}

static struct material *fresnel_glass(struct stage *s, double ior) {
    struct material *material = scene_material(&s->scene, MATERIAL_FRESNEL, stage_glass(s, 0, 0, ior), &s->error);
    return material;
}

static struct node *object(struct stage *s, struct shape shape, const struct material *material) {
    struct node *node = stage_sphere(s, s->root, material);
    node->shape = shape;
    return node;
}

static struct node *box(struct stage *s, struct vec3 min, struct vec3 max, const struct material *material) {
    return object(s, (struct shape){.kind = SHAPE_BOX, .box = {min, max}}, material);
}

static struct node *ball(struct stage *s, struct vec3 centre, double radius, const struct material *material) {
    return object(s, (struct shape){.kind = SHAPE_SPHERE, .sphere = {centre, radius}}, material);
}

static struct light *add_light(struct stage *s, struct light light) {
    s->lights[s->light_count] = light;
    return &s->lights[s->light_count++];
}

static struct light *inverse_square(struct stage *s, struct vec3 position, double intensity) {
    return add_light(s, (struct light){.kind = LIGHT_POINT,
                                       .position = position,
                                       .colour = {1, 1, 1},
                                       .attenuation = ATTENUATION_INVERSE_SQUARE,
                                       .intensity = intensity});
}

/* The map of the stage's scene. */
static struct photon_statistics send(struct stage *s, int photons, struct photon_map *map) {
    struct photon_statistics statistics = {0};
    s->settings.caustics.photons = photons;
    CHECK(stage_build(s, s->root, ACCEL_AUTO));
    const struct photon_scene scene = {.world = &s->world, .settings = &s->settings};
    if (!photons_make(map, &scene, s->pool, &statistics, &s->error))
        test_fail(__FILE__, __LINE__, "%s", s->error.text);
    return statistics;
}

static struct vec3 photon_position(const struct photon_map *map, uint32_t i) {
    const float *at = map->spots[i].at;
    return vec3_add_scaled(map->origin, vec3_make((double)at[0], (double)at[1], (double)at[2]), map->unit);
}

static struct colour photon_power(const struct photon_map *map, uint32_t i) {
    const float *power = map->lights[i].power;
    return colour_scale(colour_make((double)power[0], (double)power[1], (double)power[2]), map->power_unit);
}

static struct colour all_power(const struct photon_map *map) {
    struct colour sum = {0, 0, 0};
    for (uint32_t i = 0; i < map->count; i++)
        sum = colour_add(sum, photon_power(map, i));
    return sum;
}

/* --- the unit of light --- */

/* The mean light on a piece of white floor. */
static struct colour floor_light(struct stage *s, int photons) {
    s->settings.caustics.photons = photons;
    CHECK(stage_render(s, 16, 16));
    struct colour sum = {0, 0, 0};
    for (uint32_t i = 0; i < 256; i++)
        sum = colour_add(sum, stage_pixel(s, i % 16, i / 16));
    return colour_scale(sum, 1.0 / 256);
}

/* A square mesh of side 0.6 above the floor, not part of the scene. */
static const struct node *mesh_above(struct stage *s) {
    struct maker maker = {0};
    for (int i = 0; i < 4; i++)
        maker_vertex(&maker, i == 1 || i == 2 ? 0.3 : -0.3, 5, i >= 2 ? 0.3 : -0.3);
    maker_triangle(&maker, 0, 1, 2);
    maker_triangle(&maker, 0, 2, 3);
    struct mesh_input input = maker_input(&maker);
    struct node *node = scene_node(&s->scene, NODE_GEOMETRY, "mesh", &s->error);
    node->shape = (struct shape){.kind = SHAPE_MESH, .mesh = assets_mesh(&s->assets, &input, &s->error)};
    node->material = stage_phong(s, colour_all(0), colour_all(0), 1);
    maker_free(&maker);
    return node;
}

/* A pane of index 1 casts a full shadow; its caustic must replace exactly the light that it blocks. */
static void pane_gives_back(const char *what, struct light light, double tolerance) {
    struct stage s;
    stage_begin(&s, 2);
    s.camera = (struct camera){{0.3, 0.5, 0.2}, {0, -1, 0}, {0, 0, -1}, 50};
    s.settings.lens.projection = PROJECTION_ORTHOGRAPHIC;
    s.settings.lens.view_height = 1;
    s.settings.area_samples = 16;
    light.colour = colour_make(0.5, 1, 2);
    add_light(&s, light);
    s.authored[0].node = light.kind == LIGHT_MESH ? mesh_above(&s) : NULL;
    box(&s, vec3_make(-20, -1, -20), vec3_make(20, 0, 20), white(&s));
    struct colour open = floor_light(&s, 0);
    struct material *pane = stage_glass(&s, 0, 1, 1);
    if (light.kind == LIGHT_SKY) /* no path around it */
        ball(&s, vec3_make(0, 0, 0), 1.5, pane);
    else
        box(&s, vec3_make(-3, 1, -3), vec3_make(3, 1.2, 3), pane);
    struct colour dark = floor_light(&s, 0), back = floor_light(&s, 20000);
    CHECK(open.b > 0);
    if (!(fabs(back.r / open.r - 1) < tolerance && fabs(back.b / open.b - 1) < tolerance && dark.g == 0))
        test_fail(__FILE__, __LINE__, "%s: %g %g %g without the pane, %g %g %g with it, %g without photons", what,
                  open.r, open.g, open.b, back.r, back.g, back.b, dark.g);
    stage_end(&s);
}

TEST(a_pane_of_index_1_gives_back_the_light_of_every_kind) {
    const struct vec3 above = {1, 4, 0.5};
    const double falloffs[4][3] = {{1, 0, 0}, {0, 0, 0}, {0, 1, 0}, {0.2, 0.1, 0.3}};
    for (int i = 0; i < 4; i++) {
        struct light point = {.kind = LIGHT_POINT, .position = above};
        memcpy(point.falloff, falloffs[i], sizeof point.falloff);
        pane_gives_back("point", point, 0.01);
    }
    struct light physical = {
        .kind = LIGHT_POINT, .position = above, .attenuation = ATTENUATION_INVERSE_SQUARE, .intensity = 20};
    pane_gives_back("inverse square", physical, 0.01);
    struct light range = {.kind = LIGHT_POINT, .position = above, .attenuation = ATTENUATION_RANGE, .range = 6};
    pane_gives_back("range", range, 0.01);
    struct light distant = {.kind = LIGHT_DIRECTIONAL, .direction = vec3_normalize(vec3_make(0.3, -1, 0.2))};
    pane_gives_back("directional", distant, 0.01);
    struct light spot = {.kind = LIGHT_SPOT,
                         .position = above,
                         .direction = {0, -1, 0},
                         .cos_inner = 0.999,
                         .cos_outer = 0.9,
                         .falloff = {1, 0, 0}};
    pane_gives_back("spot", spot, 0.01);
}

/* To photons, area lights with falloff from the centre are many point lights: equal up to the square of extent over
 * distance. */
TEST(a_pane_of_index_1_gives_back_the_light_of_lights_with_an_extent) {
    struct light panel = {.kind = LIGHT_PARALLELOGRAM,
                          .position = {0, 5, 0},
                          .corner = {-0.3, 5, -0.3},
                          .edge1 = {0.6, 0, 0},
                          .edge2 = {0, 0, 0.6},
                          .falloff = {1, 0, 0}};
    struct light disc = {.kind = LIGHT_DISC,
                         .position = {0.4, 5, 0},
                         .direction = {0, -1, 0},
                         .radius = 0.4,
                         .attenuation = ATTENUATION_INVERSE_SQUARE,
                         .intensity = 20};
    struct light globe = {.kind = LIGHT_SPHERE, .position = {0.4, 5, 0}, .radius = 0.4, .falloff = {1, 0, 0}};
    pane_gives_back("area light", panel, 0.015);
    pane_gives_back("disc", disc, 0.015);
    pane_gives_back("sphere", globe, 0.015);
    panel.emissive = disc.emissive = globe.emissive = true;
    pane_gives_back("lamp: parallelogram", panel, 0.015);
    pane_gives_back("lamp: disc", disc, 0.015);
    pane_gives_back("lamp: sphere", globe, 0.015);
    struct light mesh = {.kind = LIGHT_MESH, .emissive = true, .has_emission = true, .emission = {2, 2, 2}};
    pane_gives_back("lamp: mesh", mesh, 0.03);
    disc.one_sided = true;
    pane_gives_back("lamp: one-sided disc", disc, 0.015);
    /* Large and near: photons start from parts of it. */
    panel.position.y = panel.corner.y = 2;
    panel.corner = vec3_make(-1, 2, -1);
    panel.edge1.x = panel.edge2.z = 2;
    pane_gives_back("lamp: wide parallelogram", panel, 0.02);
}

TEST(a_ball_of_index_1_gives_back_the_light_of_skies) {
    static const double stops[3][4] = {{-1, 9, 9, 9}, {0, 0.2, 0.5, 1}, {1, 2, 1.5, 0.5}};
    struct sky skies[3] = {{.kind = SKY_CONSTANT, .colour = {0.5, 0.75, 1}},
                           {.kind = SKY_STOPS, .stops = stops, .stop_count = 3}};
    sky_make_clear(vec3_normalize(vec3_make(1, 0.7, 0.4)), 3, colour_all(0.3), &skies[2]);
    const char *const names[3] = {"constant sky", "graded sky", "clear sky"};
    for (int i = 0; i < 3; i++)
        pane_gives_back(names[i], (struct light){.kind = LIGHT_SKY, .emissive = true, .sky = &skies[i], .samples = 16},
                        0.02);
}

/* The floor is unbounded, and half of the sky is below it. */
TEST(a_sky_sends_no_photons_through_the_ground) {
    static const double stops[4][4] = {{-1, 1, 1, 1}, {-1e-9, 1, 1, 1}, {0, 0, 0, 0}, {1, 0, 0, 0}};
    struct sky below = {.kind = SKY_STOPS, .stops = stops, .stop_count = 4};
    struct stage s;
    struct photon_map map;
    stage_begin(&s, 2);
    object(&s, (struct shape){.kind = SHAPE_PLANAR, .planar = planar_plane(vec3_make(0, 1, 0), 0)}, white(&s));
    ball(&s, vec3_make(0, 2, 0), 1, fresnel_glass(&s, 1.5));
    add_light(&s,
              (struct light){.kind = LIGHT_SKY, .emissive = true, .colour = {1, 1, 1}, .sky = &below, .samples = 1});
    CHECK(send(&s, 20000, &map).sent == 20000);
    CHECK(map.count == 0);
    photon_map_destroy(&map);
    stage_end(&s);
}

TEST(photons_shade_highlights_and_interpolated_sides_like_direct_light) {
    struct stage s;
    stage_begin(&s, 2);
    s.camera = (struct camera){{0, 0.9, 1}, {0, -0.9, -1}, {0, 1, 0}, 20};
    add_light(&s, (struct light){.kind = LIGHT_DIRECTIONAL,
                                 .direction = vec3_normalize(vec3_make(0.1, -1, 0.8)),
                                 .colour = {1, 1, 1}});
    box(&s, vec3_make(-20, -1, -20), vec3_make(20, 0, 20), stage_phong(&s, colour_all(0.2), colour_all(0.7), 3));
    struct colour open = floor_light(&s, 0);
    box(&s, vec3_make(-3, 1, -3), vec3_make(3, 1.2, 3), stage_glass(&s, 0, 1, 1));
    struct colour back = floor_light(&s, 40000);
    CHECK(open.r > 0.2 * 0.8 + 0.05); /* there is a highlight */
    CHECK_NEAR(back.r / open.r, 1, 0.02);
    stage_end(&s);
}

/* --- energy --- */

/* Sends photons of one light into a white hollow ball with a lossless object inside. */
static void arrives(const char *what, struct stage *s, double sent, double tolerance) {
    struct photon_map map;
    ball(s, vec3_make(0, 0, 0), 10, white(s));
    (void)send(s, 60000, &map);
    double arrived = all_power(&map).g;
    if (!(fabs(arrived / sent - 1) < tolerance))
        test_fail(__FILE__, __LINE__, "%s: %.6g sent, %.6g arrived", what, sent, arrived);
    photon_map_destroy(&map);
    stage_end(s);
}

TEST(without_absorption_all_flux_arrives) {
    struct stage s;
    /* A ball of radius 1 at distance 4 fills the solid angle 2 pi (1 - cos). */
    double cap = 2 * pi * (1 - sqrt(15.0 / 16));
    stage_begin(&s, 2);
    inverse_square(&s, vec3_make(0, 4, 0), 3);
    ball(&s, vec3_make(0, 0, 0), 1, fresnel_glass(&s, 1.5));
    arrives("a glass ball", &s, 3 * cap, 0.01);

    stage_begin(&s, 2);
    inverse_square(&s, vec3_make(0, 4, 0), 3);
    ball(&s, vec3_make(0, 0, 0), 1, mirror(&s));
    arrives("a mirror", &s, 3 * cap, 0.01);

    stage_begin(&s, 2);
    inverse_square(&s, vec3_make(0, 4, 0), 3);
    struct material *rough = stage_glass(&s, 0.3, 0.7, 1.5);
    rough->phong.roughness = 0.1; /* the facets of rougher glass mask a part of the light */
    ball(&s, vec3_make(0, 0, 0), 1, rough);
    arrives("rough glass", &s, 3 * cap, 0.02);

    /* Flux over solid angle 4 pi of a lamp inside of the glass. */
    stage_begin(&s, 2);
    inverse_square(&s, vec3_make(0, 0.2, 0), 1);
    ball(&s, vec3_make(0, 0, 0), 1, fresnel_glass(&s, 1.5));
    arrives("a lamp in a glass ball", &s, 4 * pi, 0.01);
}

/* Light that enters a face of a cube of index 1.5 meets the other faces beyond the critical angle. */
TEST(total_reflection_loses_nothing_whatever_use_tir_says) {
    struct stage s;
    stage_begin(&s, 2);
    double distance = 1.5, half = 1;
    inverse_square(&s, vec3_make(0, 0, half + distance), 1);
    box(&s, vec3_all(-half), vec3_all(half), stage_glass(&s, 0, 1, 1.5));
    double solid_angle = 4 * el_atan2(half * half, distance * sqrt(distance * distance + 2 * half * half));
    arrives("a glass cube", &s, solid_angle, 0.01);
}

/* A view factor in closed form: coaxial discs of radius 1 at distance 2. */
TEST(a_lamp_sends_a_mirror_its_view_factor) {
    struct stage s;
    stage_begin(&s, 2);
    add_light(&s, (struct light){.kind = LIGHT_DISC,
                                 .position = {0, 2, 0},
                                 .direction = {0, -1, 0},
                                 .radius = 1,
                                 .colour = {1, 1, 1},
                                 .emissive = true,
                                 .one_sided = true});
    object(&s, (struct shape){.kind = SHAPE_PLANAR, .planar = planar_disc(vec3_all(0), vec3_make(0, 1, 0), 1, 0)},
           mirror(&s));
    double r = 0.5, x = 1 + (1 + r * r) / (r * r), factor = 0.5 * (x - sqrt(x * x - 4));
    arrives("a lamp", &s, pi * factor, 0.015);
}

TEST(coloured_glass_and_absorption_colour_the_light_exactly) {
    for (int absorbs = 0; absorbs < 2; absorbs++) {
        struct stage s;
        struct photon_map map;
        stage_begin(&s, 2);
        add_light(&s, (struct light){.kind = LIGHT_DIRECTIONAL, .direction = {0, -1, 0}, .colour = {1, 1, 1}});
        box(&s, vec3_make(-20, -1, -20), vec3_make(20, 0, 20), white(&s));
        struct material *glass = stage_glass(&s, 0, 1, 1.5);
        struct colour expect = {0.04, 1, 0.25};
        if (absorbs) {
            glass->phong.absorption = colour_make(1, 0, 3);
            expect = colour_make(4 * el_exp(-0.5), 4, 4 * el_exp(-1.5));
        } else {
            glass->phong.ks = colour_make(0.2, 1, 0.5);
            expect = colour_make(4 * 0.04, 4, 4 * 0.25);
        }
        box(&s, vec3_make(-1, 1, -1), vec3_make(1, 1.5, 1), glass);
        (void)send(&s, 20000, &map);
        struct colour sum = all_power(&map);
        CHECK_NEAR(sum.r, expect.r, 0.01 * 4);
        CHECK_NEAR(sum.g, expect.g, 0.01 * 4);
        CHECK_NEAR(sum.b / sum.g, expect.b / expect.g, 0.01);
        photon_map_destroy(&map);
        stage_end(&s);
    }
}

TEST(the_light_of_two_lights_is_the_sum) {
    struct colour light[3];
    for (int which = 0; which < 3; which++) {
        struct stage s;
        stage_begin(&s, 2);
        s.camera = (struct camera){{0, 0.5, 0}, {0, -1, 0}, {0, 0, -1}, 50};
        s.settings.lens.projection = PROJECTION_ORTHOGRAPHIC;
        s.settings.lens.view_height = 3;
        box(&s, vec3_make(-20, -1, -20), vec3_make(20, 0, 20), white(&s));
        ball(&s, vec3_make(0, 2, 0), 1, fresnel_glass(&s, 1.5));
        if (which != 1)
            inverse_square(&s, vec3_make(2, 6, 0), 20)->colour = colour_make(1, 0, 0.5);
        if (which != 0)
            add_light(&s, (struct light){.kind = LIGHT_DIRECTIONAL, .direction = {0, -1, 0}, .colour = {0, 1, 0.5}});
        light[which] = colour_sub(floor_light(&s, 60000), floor_light(&s, 0));
        stage_end(&s);
    }
    CHECK_NEAR(light[2].r / light[0].r, 1, 0.03);
    CHECK_NEAR(light[2].g / light[1].g, 1, 0.03);
    CHECK_NEAR(light[2].b / (light[0].b + light[1].b), 1, 0.03);
}

/* --- where light gathers --- */

static const struct vec3 down_a_little = {1, -0.5, 0};

/* An upright ring of radius 1 and height 1, a mirror, on a white floor. */
static void ring_on_floor(struct stage *s) {
    stage_begin(s, 2);
    s->settings.caustics.radius = 0.01; /* no search for radii: only positions are used */
    box(s, vec3_make(-20, -1, -20), vec3_make(20, 0, 20), white(s));
    struct revolved_quadric ring = revolved_quadric_cylinder(vec3_make(0, 0, 0), vec3_make(0, 1, 0), 1, true);
    object(s, (struct shape){.kind = SHAPE_REVOLVED_QUADRIC, .revolved_quadric = ring}, mirror(s));
}

/* Where light along a line of constant z inside the ring is brightest. */
static double brightest(const struct photon_map *map, double z, double low, double high) {
    enum { BINS = 60 };
    double bins[BINS] = {0}, width = (high - low) / BINS;
    for (uint32_t i = 0; i < map->count; i++) {
        struct vec3 p = photon_position(map, i);
        double bin = (p.x - low) / width;
        if (fabs(p.z - z) < 0.005 && bin >= 0 && bin < BINS)
            bins[(int)bin] += photon_power(map, i).r;
    }
    int best = 0;
    for (int i = 1; i < BINS; i++)
        best = bins[i] > bins[best] ? i : best;
    return low + width * (best + 0.5);
}

/* Light along x that turns at the angle a touches ((3 cos a - cos 3a), (3 sin a - sin 3a)) / 4. */
TEST(a_distant_light_draws_a_nephroid_in_a_ring) {
    struct stage s;
    struct photon_map map;
    ring_on_floor(&s);
    add_light(
        &s, (struct light){.kind = LIGHT_DIRECTIONAL, .direction = vec3_normalize(down_a_little), .colour = {1, 1, 1}});
    (void)send(&s, 300000, &map);
    CHECK_NEAR(brightest(&map, 0, 0, 0.9), 0.5, 0.025);
    double a = pi / 6;
    double x = (3 * el_cos(a) - el_cos(3 * a)) / 4, z = (3 * el_sin(a) - el_sin(3 * a)) / 4;
    CHECK_NEAR(brightest(&map, z, 0, 0.9), x, 0.03);
    CHECK_NEAR(brightest(&map, -z, 0, 0.9), x, 0.03);
    photon_map_destroy(&map);
    stage_end(&s);
}

TEST(a_lamp_on_the_rim_draws_a_cardioid_in_a_ring) {
    struct stage s;
    struct photon_map map;
    ring_on_floor(&s);
    add_light(&s, (struct light){.kind = LIGHT_SPOT,
                                 .position = {-0.999, 1, 0},
                                 .direction = vec3_normalize(vec3_make(1, -0.3, 0)),
                                 .cos_inner = 0.8,
                                 .cos_outer = 0.7,
                                 .falloff = {0, 0, 1},
                                 .colour = {1, 1, 1}});
    (void)send(&s, 300000, &map);
    CHECK_NEAR(brightest(&map, 0, 0, 0.9), 1.0 / 3, 0.025);
    photon_map_destroy(&map);
    stage_end(&s);
}

/* The mean square distance from the axis of a narrow beam that went through a ball of radius 1. */
static double beam_behind_ball(double ior, double screen) {
    struct stage s;
    struct photon_map map;
    stage_begin(&s, 2);
    add_light(&s, (struct light){.kind = LIGHT_DIRECTIONAL, .direction = {0, -1, 0}, .colour = {1, 1, 1}});
    struct planar aperture = planar_disc(vec3_make(0, 2, 0), vec3_make(0, 1, 0), 3, 0.1);
    object(&s, (struct shape){.kind = SHAPE_PLANAR, .planar = aperture}, white(&s));
    ball(&s, vec3_make(0, 0, 0), 1, stage_glass(&s, 0, 1, ior));
    box(&s, vec3_make(-5, -screen - 1, -5), vec3_make(5, -screen, 5), white(&s));
    (void)send(&s, 80000, &map);
    double sum = 0;
    for (uint32_t i = 0; i < map.count; i++) {
        struct vec3 p = photon_position(&map, i);
        sum += p.x * p.x + p.z * p.z;
    }
    CHECK(map.count > 400);
    double mean = sum / map.count;
    photon_map_destroy(&map);
    stage_end(&s);
    return mean;
}

TEST(the_focus_of_a_ball_lens_lies_at_n_r_over_2_n_minus_2) {
    for (int i = 0; i < 2; i++) {
        double ior = i == 0 ? 1.5 : 1.7, focus = ior / (2 * (ior - 1)), best = beam_behind_ball(ior, focus);
        CHECK(sqrt(best) < 0.002);
        CHECK(beam_behind_ball(ior, focus * 0.96) > 2 * best);
        CHECK(beam_behind_ball(ior, focus * 1.04) > 2 * best);
    }
}

/* --- the map --- */

/* Glass, mirrors and five kinds of light. */
static void busy_scene(struct stage *s, int threads) {
    stage_begin(s, threads);
    s->camera = (struct camera){{0, 3, 6}, {0, -0.4, -1}, {0, 1, 0}, 50};
    box(s, vec3_make(-20, -1, -20), vec3_make(20, 0, 20), stage_phong(s, colour_all(0.8), colour_all(0.2), 10));
    ball(s, vec3_make(0, 1, 0), 1, fresnel_glass(s, 1.5));
    ball(s, vec3_make(-2, 1, 1), 0.75, mirror(s));
    struct material *rough = stage_glass(s, 0.25, 0.75, 1.25);
    rough->phong.roughness = 0.25;
    ball(s, vec3_make(2, 0.5, 1), 0.5, rough);
    inverse_square(s, vec3_make(3, 5, 2), 20);
    static const struct sky grey = {.kind = SKY_CONSTANT, .colour = {0.25, 0.25, 0.25}};
    add_light(s, (struct light){.kind = LIGHT_SKY, .emissive = true, .colour = {1, 1, 1}, .sky = &grey, .samples = 1});
    add_light(s, (struct light){.kind = LIGHT_DIRECTIONAL, .direction = {0, -1, 0}, .colour = {0.5, 0.5, 0.5}});
    add_light(s, (struct light){.kind = LIGHT_PARALLELOGRAM,
                                .position = {-2, 5, -1},
                                .corner = {-3, 5, -2},
                                .edge1 = {2, 0, 0},
                                .edge2 = {0, 0, 2},
                                .colour = {0.5, 0.5, 0.25},
                                .falloff = {1, 0, 0}});
    add_light(s,
              (struct light){
                  .kind = LIGHT_SPHERE, .position = {0, 5, 3}, .radius = 0.5, .colour = {8, 8, 8}, .emissive = true});
}

TEST(any_number_of_threads_makes_the_same_photon_map) {
    struct stage s;
    struct photon_map maps[3];
    const int threads[3] = {1, 2, 5};
    for (int i = 0; i < 3; i++) {
        busy_scene(&s, threads[i]);
        (void)send(&s, 30000, &maps[i]);
        stage_end(&s);
        CHECK(maps[i].count > 1000 && maps[i].count == maps[0].count);
        CHECK(memcmp(maps[i].spots, maps[0].spots, maps[i].count * sizeof *maps[i].spots) == 0);
        CHECK(memcmp(maps[i].lights, maps[0].lights, maps[i].count * sizeof *maps[i].lights) == 0);
    }
    for (int i = 0; i < 3; i++)
        photon_map_destroy(&maps[i]);
}

/* Every length times 2^k, falloff coefficients scaled to match: the same bytes. */
TEST(caustics_of_a_scene_of_another_scale_are_the_same_bytes) {
    enum { SIZE = 24 };
    float pixels[3][SIZE * SIZE * 3];
    const int exponents[3] = {0, -10, 20};
    for (int k = 0; k < 3; k++) {
        struct stage s;
        double factor = ldexp(1, exponents[k]);
        busy_scene(&s, 2);
        stage_scale(&s, s.root, factor, factor, factor);
        s.camera.eye = vec3_scale(s.camera.eye, factor);
        s.lights[0].intensity *= factor * factor;
        for (uint32_t i = 0; i < s.light_count; i++) {
            struct light *light = &s.lights[i];
            light->position = vec3_scale(light->position, factor);
            light->corner = vec3_scale(light->corner, factor);
            light->edge1 = vec3_scale(light->edge1, factor);
            light->edge2 = vec3_scale(light->edge2, factor);
            light->radius *= factor;
        }
        s.settings.caustics.photons = 20000;
        CHECK(stage_render(&s, SIZE, SIZE));
        for (uint32_t i = 0; i < SIZE * SIZE; i++)
            memcpy(&pixels[k][3 * i], s.film.pixels[i].rgb, sizeof s.film.pixels[i].rgb);
        stage_end(&s);
    }
    CHECK(memcmp(pixels[0], pixels[1], sizeof pixels[0]) == 0);
    CHECK(memcmp(pixels[0], pixels[2], sizeof pixels[0]) == 0);
}

TEST(the_map_gives_the_sum_over_all_discs) {
    struct stage s;
    struct photon_map map;
    busy_scene(&s, 2);
    (void)send(&s, 20000, &map);
    struct bsdf bsdf = {
        .count = 1, .lobes = {{.kind = LOBE_DIFFUSE, .weight = {1, 1, 1}}}, .normal = {0, 1, 0}, .lit = {0, 1, 0}};
    struct test_random random = {5};
    int lit = 0;
    for (int i = 0; i < 300; i++) {
        struct hit hit = {.normal = {0, 1, 0}, .normal_geometric = {0, 1, 0}, .front = true, .view = {0, 1, 0}};
        hit.point = vec3_make(test_uniform(&random, -3, 3), 0, test_uniform(&random, -3, 3));
        struct colour light = photon_map_light(&map, &s.world, &hit, &bsdf, BSDF_ALL);
        double sum = 0;
        for (uint32_t k = 0; k < map.count; k++) {
            struct vec3 d = vec3_sub(photon_position(&map, k), hit.point);
            double radius = (double)map.spots[k].radius * map.unit;
            double squared = vec3_dot(d, d) + 15 * d.y * d.y, share = 1 - squared / (radius * radius);
            if (share > 0 && unpacked(map.lights[k].from).y > 0)
                sum += photon_power(&map, k).r * 2 * share / (pi * radius * radius);
        }
        lit += sum > 0;
        CHECK_NEAR(light.r, sum, 1e-4 * sum + 1e-9);
    }
    CHECK(lit > 100);
    photon_map_destroy(&map);
    stage_end(&s);
}

TEST(a_radius_that_is_given_holds_for_every_photon) {
    struct stage s;
    struct photon_map map;
    busy_scene(&s, 2);
    s.settings.caustics.radius = 0.125;
    (void)send(&s, 5000, &map);
    for (uint32_t i = 0; i < map.count; i++)
        CHECK_NEAR((double)map.spots[i].radius * map.unit, 0.125, 1e-6);
    photon_map_destroy(&map);
    stage_end(&s);
}

TEST(packed_directions_are_right_to_a_ten_thousandth) {
    struct test_random random = {11};
    for (int i = 0; i < 20000; i++) {
        struct vec3 d = {test_uniform(&random, -1, 1), test_uniform(&random, -1, 1), test_uniform(&random, -1, 1)};
        if (i < 27)
            d = vec3_make(i % 3 - 1, (double)(i / 3 % 3) - 1, (double)(i / 9) - 1);
        if (!(vec3_length(d) > 0))
            continue;
        d = vec3_normalize(d);
        CHECK(vec3_length(vec3_sub(unpacked(photon_pack(d)), d)) < 1e-4);
    }
}

/* Photons are sent only towards specular objects: most of them meet one, however small it is. */
TEST(photons_are_sent_towards_specular_objects) {
    for (int kind = 0; kind < 2; kind++) {
        struct stage s;
        struct photon_map map;
        stage_begin(&s, 2);
        box(&s, vec3_make(-200, -1, -200), vec3_make(200, 0, 200), white(&s));
        ball(&s, vec3_make(3, 0.5, 1), 0.05, stage_glass(&s, 0, 1, 1.5));
        if (kind == 0)
            inverse_square(&s, vec3_make(0, 50, 0), 1);
        else
            add_light(&s, (struct light){.kind = LIGHT_DIRECTIONAL,
                                         .direction = vec3_normalize(vec3_make(1, -1, 0.5)),
                                         .colour = {1, 1, 1}});
        struct photon_statistics statistics = send(&s, 10000, &map);
        CHECK_EQ_INT(statistics.sent, 10000);
        CHECK(statistics.landed > 4000);
        photon_map_destroy(&map);
        stage_end(&s);
    }
}

/* Cells without light have no parts with light: the search ends at the first of them. It took minutes. */
TEST(a_spot_that_shines_away_from_all_glass_sends_no_photon) {
    struct stage s;
    struct photon_map map;
    stage_begin(&s, 2);
    for (int i = 0; i < 1000; i++)
        ball(&s, vec3_make(i % 10, 1 + (double)(i / 100), (double)(i / 10 % 10)), 0.3, stage_glass(&s, 0, 1, 1.5));
    add_light(&s, (struct light){.kind = LIGHT_SPOT,
                                 .position = {5, 15, 5},
                                 .direction = {0, 1, 0},
                                 .cos_inner = 0.95,
                                 .cos_outer = 0.94,
                                 .colour = {1, 1, 1}});
    struct photon_statistics statistics = send(&s, 100000, &map);
    CHECK_EQ_INT(statistics.sent, 0);
    CHECK_EQ_INT(map.count, 0);
    photon_map_destroy(&map);
    stage_end(&s);
}

TEST(without_anything_specular_no_photon_is_sent) {
    struct stage s;
    struct photon_map map;
    stage_begin(&s, 2);
    box(&s, vec3_make(-2, -1, -2), vec3_make(2, 0, 2), white(&s));
    inverse_square(&s, vec3_make(0, 5, 0), 1);
    struct photon_statistics statistics = send(&s, 10000, &map);
    CHECK_EQ_INT(statistics.sent, 0);
    CHECK_EQ_INT(map.count, 0);
    photon_map_destroy(&map);
    stage_end(&s);
}

/* Paths leave the light of these layers to photons. */
TEST(photons_are_sent_towards_gloss_and_coats_of_layered_materials) {
    for (int kind = 0; kind < 5; kind++) {
        struct stage s;
        struct photon_map map;
        stage_begin(&s, 2);
        box(&s, vec3_make(-2, -1, -2), vec3_make(2, 0, 2), white(&s));
        struct openpbr layers = openpbr_defaults();
        struct texture half = texture_number(0.5);
        struct material *lacquer = white(&s);
        lacquer->kind = MATERIAL_OPENPBR;
        lacquer->phong.ks = colour_all(1);
        lacquer->openpbr = &layers;
        layers.specular_weight = kind == 1;
        layers.coat_weight = kind == 2;
        if (kind >= 3)
            lacquer->inputs[kind == 3 ? INPUT_COAT_WEIGHT : INPUT_METALNESS] = &half;
        ball(&s, vec3_make(0, 1.5, 0), 1, lacquer);
        inverse_square(&s, vec3_make(0, 5, 0), 1);
        CHECK_EQ_INT(send(&s, 1000, &map).sent, kind == 0 ? 0 : 1000);
        photon_map_destroy(&map);
        stage_end(&s);
    }
}

/* --- paths --- */

/* The mean picture of a white floor under a ball of glass under a lamp; walls send light on to both. alpha: roughness
 * of the ball, of which a part scatters diffusely. medium: around all, or NULL. */
static struct colour light_under_lens(int photons, int samples, double alpha, const struct medium *medium,
                                      uint64_t seed) {
    struct stage s;
    stage_begin(&s, 2);
    s.medium = medium;
    s.settings.integrator = INTEGRATOR_PATH;
    s.settings.path_samples = samples;
    s.settings.max_depth = 60;
    s.settings.seed = seed;
    s.camera = (struct camera){{0, 0.4, 0}, {0, -1, 0}, {0, 0, -1}, 50};
    s.settings.lens.projection = PROJECTION_ORTHOGRAPHIC;
    s.settings.lens.view_height = 3;
    struct material *grey = white(&s);
    grey->phong.kd = colour_make(0.5, 0.4, 0.3);
    box(&s, vec3_make(-3, -1, -3), vec3_make(3, 0, 3), grey);
    box(&s, vec3_make(-3.2, 0, -3), vec3_make(-3, 5, 3), grey);
    struct material *glass = stage_glass(&s, 0, 0.9, 1.5);
    if (alpha > 0) {
        glass->phong.kd = colour_all(0.2);
        glass->phong.reflect = 0.1;
        glass->phong.refract = 0.7;
        glass->phong.roughness = alpha;
    }
    ball(&s, vec3_make(0, 1.6, 0), 1, glass);
    add_light(&s, (struct light){.kind = LIGHT_DISC,
                                 .position = {0, 4.5, 0},
                                 .direction = {0, -1, 0},
                                 .radius = 1.2,
                                 .colour = {3, 4, 5},
                                 .emissive = true,
                                 .one_sided = true});
    struct colour mean = floor_light(&s, photons);
    stage_end(&s);
    return mean;
}

static void check_energy(double alpha, int samples, const struct medium *medium) {
    struct colour paths = light_under_lens(0, samples, alpha, medium, 1),
                  both = light_under_lens(300000, samples / 4, alpha, medium, 2);
    CHECK_NEAR(both.r, paths.r, 0.01 * paths.r);
    CHECK_NEAR(both.g, paths.g, 0.01 * paths.g);
    CHECK_NEAR(both.b, paths.b, 0.01 * paths.b);
}

TEST(paths_with_photons_show_the_caustic_of_a_lamp_through_a_lens_once) {
    check_energy(0, 512, NULL);
}

TEST(paths_with_photons_show_the_light_of_rough_glass_over_diffuse_once) {
    check_energy(0.3, 512, NULL);
}

/* A fifth of the light of a channel is scattered on its way, and some of it absorbed. */
TEST_TIMES(photons_and_paths_are_scattered_alike_by_a_medium_around_a_lens, 16) {
    const struct medium medium = medium_scattering(&(struct medium_input){.absorption = colour_make(0.01, 0.02, 0),
                                                                          .scattering = colour_make(0.02, 0.04, 0.06),
                                                                          .phase = {PHASE_HENYEY_GREENSTEIN, 0.5}});
    check_energy(0, 512 * times, &medium);
}

/* The error is that of the mean of runs with different seeds. */
static struct estimate lens_estimate(int photons, int samples, double alpha, uint64_t seed) {
    enum { RUNS = 16 };
    double sum = 0, squares = 0;
    for (uint64_t run = 0; run < RUNS; run++) {
        double light = light_under_lens(photons, samples, alpha, NULL, random_combine(seed, run)).g;
        sum += light / RUNS;
        squares += light * light / RUNS;
    }
    return (struct estimate){sum, sqrt(fmax(0, squares - sum * sum) / (RUNS - 1))};
}

TEST_LONG(paths_with_photons_show_what_paths_show_below_a_lens_for_every_seed) {
    for (int rough = 0; rough < 2; rough++) {
        for (uint64_t seed = 1; seed <= 3; seed++) {
            struct estimate paths = lens_estimate(0, rough ? 2560 : 2048, 0.3 * rough, seed);
            struct estimate both = lens_estimate(rough ? 250000 : 100000, 384, 0.3 * rough, seed + 10);
            estimate_check_equal(rough ? "below a rough lens: paths, and photons" : "below a lens: paths, and photons",
                                 paths, both, (int)seed, 0.001);
        }
    }
}

/* A white floor from x on, which paths show from above. */
static void begin_floor_from_above(struct stage *s, int samples, double x) {
    stage_begin(s, 2);
    s->settings.integrator = INTEGRATOR_PATH;
    s->settings.path_samples = samples;
    s->camera = (struct camera){{0, 0.3, 0}, {0, -1, 0}, {0, 0, -1}, 50};
    s->settings.lens.projection = PROJECTION_ORTHOGRAPHIC;
    s->settings.lens.view_height = 0.5;
    box(s, vec3_make(x, -1, -3), vec3_make(3, 0, 3), white(s));
}

TEST(photons_give_paths_the_caustic_of_a_light_without_body) {
    for (int photons = 0; photons <= 100000; photons += 100000) {
        struct stage s;
        begin_floor_from_above(&s, 64, -3);
        ball(&s, vec3_make(0, 1.6, 0), 1, stage_glass(&s, 0, 1, 1.5));
        inverse_square(&s, vec3_make(0, 5, 0), 25);
        double light = floor_light(&s, photons).r;
        CHECK(photons == 0 ? light == 0 : light > 1);
        stage_end(&s);
    }
}

/* A highlight of a mirror stands for the light of lamps that no ray can hit. Photons that the mirror throws are the
 * same light: scattered rays must not add the highlight to it. The floor has the light of the lamp and of its mirror
 * image. */
TEST(photons_replace_the_highlights_of_mirrors_on_which_scattered_rays_see_lights_without_body) {
    struct colour light[2];
    for (int mirrored = 0; mirrored < 2; mirrored++) {
        struct stage s;
        begin_floor_from_above(&s, 256, -1);
        inverse_square(&s, vec3_make(0, 1, 0), 1);
        if (mirrored) {
            struct material *mirror = stage_phong(&s, colour_all(0), colour_all(0.9), 1);
            mirror->phong.reflect = 1;
            box(&s, vec3_make(-1.2, -1, -3), vec3_make(-1, 3, 3), mirror);
        } else {
            inverse_square(&s, vec3_make(-2, 1, 0), 0.9);
        }
        light[mirrored] = floor_light(&s, 100000 * mirrored);
        stage_end(&s);
    }
    CHECK_NEAR(light[1].g, light[0].g, 0.01 * light[0].g);
}
