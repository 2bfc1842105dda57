/* The path tracer against closed forms. Each render has a fixed number of samples; its standard error, from the pixels,
 * which are independent, is at most 0.1 % of the value, and the mean is within 4 of it. The samples of a pixel are a
 * sequence of low discrepancy: few pixels with many samples have less error than many with few. */
#include "shape/curve.h"
#include "shape/planar.h"
#include "tests/harness.h"
#include "tests/unit/mesh_makers.h"
#include "tests/unit/path_estimate.h"

#include <math.h>
#include <string.h>

static struct material *glowing(struct stage *s, double emission, double kd, double ks) {
    struct material *material = stage_phong(s, colour_all(kd), colour_all(ks), 1);
    material->phong.emission = colour_all(emission);
    material->phong.two_sided = true;
    material->phong.reflect = ks > 0 ? 1 : 0;
    return material;
}

static struct node *add_planar(struct stage *s, const struct material *material, struct planar planar) {
    struct node *node = stage_sphere(s, s->root, material);
    node->shape = (struct shape){.kind = SHAPE_PLANAR, .planar = planar};
    return node;
}

static struct node *add_rectangle(struct stage *s, const struct material *material, struct vec3 corner,
                                  struct vec3 along, struct vec3 up) {
    return add_planar(s, material, planar_parallelogram(corner, along, up));
}

/* A room that is a sphere about the origin, with blocks in it, all of one material. */
static void begin_room(struct stage *s, double emission, double kd, double ks) {
    stage_begin(s, 1);
    struct material *material = glowing(s, emission, kd, ks);
    struct node *room = stage_sphere(s, s->root, material);
    stage_scale(s, room, 8, 8, 8);
    struct node *block = stage_cube(s, s->root, material);
    stage_move(s, block, 0.5, -1, -4);
    stage_rotate(s, block, 1, 30);
    struct node *ball = stage_sphere(s, s->root, material);
    stage_move(s, ball, -2, 1, -5);
    s->camera = (struct camera){{0, 0, 3}, {0, 0, -1}, {0, 1, 0}, 60};
}

/* --- closed scenes --- */

static void check_closed(double kd, double ks, struct effort effort) {
    struct stage s;
    begin_room(&s, 1, kd, ks);
    estimate_check_mean(ks > 0 ? "closed scene, diffuse and mirror" : "closed diffuse scene", 1 / (1 - kd - ks), &s,
                        &effort, 1000);
    stage_end(&s);
}

static void check_cut(double albedo, int depth, struct effort effort) {
    struct stage s;
    begin_room(&s, 1, albedo, 0);
    estimate_check_mean("closed diffuse scene, cut", (1 - pow(albedo, depth + 1)) / (1 - albedo), &s, &effort, depth);
    stage_end(&s);
}

TEST(a_closed_diffuse_scene_shows_its_emission_over_one_minus_albedo) {
    check_closed(0.5, 0, (struct effort){16, 256, 1});
}

TEST(a_path_of_depth_n_has_n_bounces) {
    for (int depth = 0; depth <= 3; depth++)
        check_cut(0.5, depth, (struct effort){16, 256, 1});
}

TEST(diffuse_and_mirrored_light_add_up_in_a_closed_scene) {
    check_closed(0.3, 0.2, (struct effort){16, 512, 1});
}

TEST_LONG(closed_scenes_show_the_sum_of_their_bounces) {
    static const double albedos[][2] = {{0.2, 0}, {0.5, 0}, {0.8, 0}, {0.95, 0}, {0.3, 0.2}, {0.1, 0.8}, {0, 0.5}};
    for (size_t i = 0; i < sizeof albedos / sizeof *albedos; i++) {
        double kd = albedos[i][0], ks = albedos[i][1];
        check_closed(kd, ks, (struct effort){16, kd + ks > 0.75 ? 3072 : 512, 3});
        for (int depth = 0; depth <= 5 && ks == 0; depth++)
            check_cut(kd, depth, (struct effort){16, 512, 3});
    }
}

/* Light that a hair reflects starts at most half a width off it, on the side of its tangent plane; also if the hair is
 * `stretched` by that factor along a straight line. */
static void check_hairy_room(bool flat, double stretched, struct effort effort) {
    static const double curl[4][3] = {{-3, -2, -4}, {-1, 2, -5}, {1, 1, -6}, {3, -2, -5}};
    static const double widths[4] = {0.25, 0.4, 0.3, 0.2};
    const double line[4][3] = {
        {-4 / stretched, -1, -4}, {-1 / stretched, -1, -4}, {1 / stretched, -1, -4}, {4 / stretched, -1, -4}};
    struct arena arena = {0};
    struct stage s;
    char claim[80];
    begin_room(&s, 1, 0.7, 0);
    struct node *hair = stage_sphere(&s, s.root, glowing(&s, 0.2, 0.94, 0));
    const struct curve_input in = {
        .kind = SPLINE_CATMULL_ROM, .points = stretched > 0 ? line : curl, .widths = widths, .count = 4, .flat = flat};
    hair->shape = (struct shape){.kind = SHAPE_CURVE, .curve = curve_build(&arena, &in, &s.error)};
    if (stretched > 0)
        stage_scale(&s, hair, stretched, 1, 1);
    snprintf(claim, sizeof claim, "closed room with a %s%s", stretched > 0 ? "stretched " : "",
             flat ? "ribbon" : "hair");
    estimate_check_mean(claim, 1 / (1 - 0.7), &s, &effort, 1000);
    stage_end(&s);
    arena_destroy(&arena);
}

TEST(hair_in_a_closed_scene_is_as_bright_as_its_walls) {
    check_hairy_room(false, 0, (struct effort){16, 192, 1});
    check_hairy_room(true, 0, (struct effort){16, 192, 1});
}
TEST(stretched_hair_in_a_closed_scene_is_as_bright_as_its_walls) {
    check_hairy_room(false, 40, (struct effort){16, 192, 1});
    check_hairy_room(true, 40, (struct effort){16, 192, 1});
}
TEST_LONG(hair_in_a_closed_scene_is_as_bright_as_its_walls_for_every_seed) {
    for (int stretched = 0; stretched <= 40; stretched += 40) {
        check_hairy_room(false, stretched, (struct effort){16, 1536, 3});
        check_hairy_room(true, stretched, (struct effort){16, 1536, 3});
    }
}

/* Rooms whose own light is sampled by the solid angle of their bound, or of their triangles. */
static void check_box_room(bool mesh, struct effort effort) {
    static const uint32_t faces[6][4] = {{0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                         {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}};
    struct stage s;
    stage_begin(&s, 1);
    struct node *room = stage_cube(&s, s.root, glowing(&s, 1, 0.5, 0));
    stage_move(&s, room, -0.5, -0.5, -0.5);
    stage_scale(&s, room, 8, 8, 8);
    s.camera = (struct camera){{0, 0, 3}, {0, 0, -1}, {0, 1, 0}, 60};
    struct maker maker = {0};
    for (int i = 0; i < 8; i++)
        maker_vertex(&maker, i & 1, i >> 1 & 1, i >> 2);
    for (int i = 0; i < 6; i++)
        maker_face(&maker, faces[i], 4);
    struct mesh_input input = maker_input(&maker);
    if (mesh)
        room->shape = (struct shape){.kind = SHAPE_MESH, .mesh = assets_mesh(&s.assets, &input, &s.error)};
    maker_free(&maker);
    estimate_check_mean(mesh ? "closed room of triangles" : "closed room, a box", 2, &s, &effort, 1000);
    stage_end(&s);
}

TEST(closed_rooms_of_a_box_and_of_triangles_show_the_sum_of_their_bounces) {
    check_box_room(false, (struct effort){16, 128, 1});
    check_box_room(true, (struct effort){16, 128, 1});
}
TEST_LONG(closed_rooms_of_a_box_and_of_triangles_show_the_sum_of_their_bounces_for_every_seed) {
    check_box_room(false, (struct effort){16, 1024, 3});
    check_box_room(true, (struct effort){16, 1024, 3});
}

/* Without roughness the remaining light is uniform, as always in a sphere. E / pi is I cos / d^2 of a light of
 * intensity I; its mean over a sphere of radius R is I / R^2 wherever the light is. */
static void check_lit_sphere(double albedo, struct vec3 at, struct effort effort) {
    enum { RADIUS = 8 };
    struct stage s;
    stage_begin(&s, 1);
    struct node *room = stage_sphere(&s, s.root, glowing(&s, 0, albedo, 0));
    stage_scale(&s, room, RADIUS, RADIUS, RADIUS);
    s.camera = (struct camera){{0, 0, 3}, {0, 0, -1}, {0, 1, 0}, 60};
    stage_point_light(&s, at, colour_all(1));
    s.lights[0].attenuation = ATTENUATION_INVERSE_SQUARE;
    s.lights[0].intensity = 64;
    for (int seed = 1; seed <= effort.seeds; seed++) {
        static struct film_pixel direct[ESTIMATE_SIZE_MAX * ESTIMATE_SIZE_MAX];
        size_t count = (size_t)effort.size * effort.size;
        (void)estimate_render(&s, &effort, 1, seed);
        memcpy(direct, s.film.pixels, count * sizeof *direct);
        (void)estimate_render(&s, &effort, 1000, seed);
        for (size_t i = 0; i < count; i++) /* the indirect part of the surface's colour */
            s.film.pixels[i].rgb[0] = (s.film.pixels[i].rgb[0] - direct[i].rgb[0]) / (float)albedo;
        estimate_check("sphere with a light of intensity I: indirect E / pi",
                       64 / (double)(RADIUS * RADIUS) * albedo / (1 - albedo), estimate_of(&s, 0), seed,
                       effort_precision(&effort));
    }
    stage_end(&s);
}

TEST(indirect_light_in_a_sphere_is_the_same_wherever_the_light_is) {
    check_lit_sphere(0.5, vec3_make(0, 0, 0), (struct effort){16, 256, 1});
    check_lit_sphere(0.5, vec3_make(1, 0.5, -1.5), (struct effort){16, 512, 1});
}

TEST_LONG(indirect_light_in_spheres_is_the_same_wherever_the_light_is) {
    check_lit_sphere(0.2, vec3_make(3, 0, 0), (struct effort){16, 2048, 3});
    check_lit_sphere(0.5, vec3_make(2, 1, -3), (struct effort){16, 2048, 3});
    check_lit_sphere(0.8, vec3_make(-1, 4, 2), (struct effort){16, 4096, 3});
}

/* B1 = 1 + .5 B2, B2 = .8 B1. */
static void check_planes(struct effort effort) {
    struct stage s;
    stage_begin(&s, 1);
    (void)add_planar(&s, glowing(&s, 1, 0.5, 0), planar_plane(vec3_make(0, 0, 1), -1));
    (void)add_planar(&s, glowing(&s, 0, 0.8, 0), planar_plane(vec3_make(0, 0, -1), -1));
    s.camera = (struct camera){{0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 60};
    estimate_check_mean("parallel planes, the one that emits", 1 / (1 - 0.5 * 0.8), &s, &effort, 1000);
    s.camera.view = vec3_make(0, 0, 1);
    estimate_check_mean("parallel planes, the other one", 0.8 / (1 - 0.5 * 0.8), &s, &effort, 1000);
    stage_end(&s);
}

TEST(parallel_planes_light_each_other) {
    check_planes((struct effort){16, 256, 1});
}
TEST_LONG(parallel_planes_light_each_other_for_every_seed) {
    check_planes((struct effort){16, 1024, 3});
}

/* --- form factors: a white surface shows E / pi of a lamp of radiance 1 --- */

static void camera_along_z(struct stage *s, double height, double z) {
    s->camera = (struct camera){{0, 0, z}, {0, 0, -1}, {0, 1, 0}, 50};
    s->settings.lens.projection = PROJECTION_ORTHOGRAPHIC;
    s->settings.lens.view_height = height;
}

/* The face at z = -1/2 of a cube of side 1 is white, another one glows. */
static void check_cube(bool opposite, struct effort effort) {
    struct stage s;
    stage_begin(&s, 1);
    (void)add_rectangle(&s, glowing(&s, 0, 1, 0), vec3_make(-0.5, -0.5, -0.5), vec3_make(1, 0, 0), vec3_make(0, 1, 0));
    if (opposite)
        (void)add_rectangle(&s, glowing(&s, 1, 0, 0), vec3_make(-0.5, -0.5, 0.5), vec3_make(1, 0, 0),
                            vec3_make(0, 1, 0));
    else
        (void)add_rectangle(&s, glowing(&s, 1, 0, 0), vec3_make(-0.5, -0.5, -0.5), vec3_make(1, 0, 0),
                            vec3_make(0, 0, 1));
    camera_along_z(&s, 1, 0);
    for (int seed = 1; seed <= effort.seeds; seed++)
        estimate_check(opposite ? "opposite faces of a cube" : "adjacent faces of a cube",
                       opposite ? 0.199825 : 0.200044, estimate_render_twice(&s, &effort, 1, seed), seed,
                       effort_precision(&effort));
    stage_end(&s);
}

TEST(faces_of_a_cube_light_each_other_by_their_form_factors) {
    check_cube(true, (struct effort){16, 256, 1});
    check_cube(false, (struct effort){16, 256, 1});
}
TEST_LONG(faces_of_a_cube_light_each_other_by_their_form_factors_for_every_seed) {
    check_cube(true, (struct effort){16, 1024, 3});
    check_cube(false, (struct effort){16, 1024, 3});
}

static void check_discs(struct effort effort) {
    struct stage s;
    stage_begin(&s, 1);
    (void)add_planar(&s, glowing(&s, 0, 1, 0), planar_disc(vec3_make(0, 0, -0.5), vec3_make(0, 0, 1), 1, 0));
    (void)add_planar(&s, glowing(&s, 1, 0, 0), planar_disc(vec3_make(0, 0, 0.5), vec3_make(0, 0, -1), 1, 0));
    camera_along_z(&s, 2, 0);
    for (int seed = 1; seed <= effort.seeds; seed++) {
        struct estimate square = estimate_render_twice(&s, &effort, 1, seed);
        double disc = 4 / 3.14159265358979323846;
        estimate_check("coaxial discs", 0.381966, (struct estimate){square.mean * disc, square.error * disc}, seed,
                       effort_precision(&effort));
    }
    stage_end(&s);
}

TEST(coaxial_discs_light_each_other_by_their_form_factor) {
    check_discs((struct effort){16, 512, 1});
}
TEST_LONG(coaxial_discs_light_each_other_by_their_form_factor_for_every_seed) {
    check_discs((struct effort){16, 1024, 3});
}

/* --- glass --- */

/* Red light arrives by reflection, green light through the pane. */
static void check_pane(struct effort effort) {
    struct stage s;
    stage_begin(&s, 1);
    struct material *glass = stage_glass(&s, 0, 0, 1.5), *behind = glowing(&s, 0, 0, 0), *before = glowing(&s, 0, 0, 0);
    glass->fresnel = true;
    before->phong.emission = colour_make(1, 0, 0);
    behind->phong.emission = colour_make(0, 1, 0);
    struct node *pane = stage_cube(&s, s.root, glass);
    stage_move(&s, pane, -0.5, -0.5, -0.5);
    stage_scale(&s, pane, 10, 10, 1);
    (void)add_planar(&s, behind, planar_plane(vec3_make(0, 0, 1), -5));
    (void)add_planar(&s, before, planar_plane(vec3_make(0, 0, -1), -5));
    camera_along_z(&s, 1, 3);
    for (int seed = 1; seed <= effort.seeds; seed++) {
        (void)estimate_render(&s, &effort, 100, seed);
        estimate_check("pane of index 1.5, reflected", 1.0 / 13, estimate_of(&s, 0), seed, effort_precision(&effort));
        estimate_check("pane of index 1.5, transmitted", 12.0 / 13, estimate_of(&s, 1), seed,
                       effort_precision(&effort));
    }
    stage_end(&s);
}

TEST(a_pane_of_glass_reflects_a_thirteenth) {
    check_pane((struct effort){16, 1024, 1});
}
TEST_LONG(a_pane_of_glass_reflects_a_thirteenth_for_every_seed) {
    check_pane((struct effort){16, 4096, 3});
}

TEST(rough_glass_of_index_1_is_invisible) {
    const struct effort effort = {16, 16, 1};
    struct stage with, without;
    for (int i = 0; i < 2; i++) {
        struct stage *s = i ? &with : &without;
        stage_begin(s, 1);
        struct material *stripes = glowing(s, 0.25, 0, 0);
        (void)add_rectangle(s, stripes, vec3_make(-2, -2, -3), vec3_make(2, 0, 0), vec3_make(0, 4, 0));
        s->sky.colour = colour_all(0.75);
        if (i) {
            struct material *glass = stage_glass(s, 0, 0, 1);
            glass->fresnel = true;
            glass->phong.roughness = 0.5;
            (void)stage_sphere(s, s->root, glass);
        }
        s->camera = (struct camera){{0, 0, 4}, {0, 0, -1}, {0, 1, 0}, 30};
        (void)estimate_render(s, &effort, 16, 5);
    }
    for (size_t i = 0; i < (size_t)effort.size * effort.size; i++)
        CHECK_NEAR(with.film.pixels[i].rgb[0], without.film.pixels[i].rgb[0], 1e-6);
    stage_end(&with);
    stage_end(&without);
}
