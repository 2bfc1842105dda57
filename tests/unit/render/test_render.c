/* Pictures against closed forms and symmetries; no reference pictures. */
#include "tests/harness.h"
#include "tests/stage.h"

#include "base/mem.h"
#include "material/material_inputs.h"
#include "material/medium.h"
#include "material/microfacet_internal.h"
#include "render/camera.h"

#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

/* Tests may use the C library freely: they compare within tolerances. */

TEST(sphere_covers_the_area_its_silhouette_encloses) {
    struct stage s;
    stage_begin(&s, 2);
    s.settings.full = true;
    s.settings.samples = 8;
    s.ambient = colour_all(1);
    (void)stage_sphere(&s, s.root, stage_phong(&s, colour_all(1), colour_all(0), 1));
    CHECK(stage_render(&s, 200, 200));
    double sum = 0;
    for (uint32_t y = 0; y < 200; y++) {
        for (uint32_t x = 0; x < 200; x++)
            sum += stage_pixel(&s, x, y).r;
    }
    /* A sphere of radius 1 at distance 10 shows a disc of angle asin(1/10). */
    double pixel = 2 * tan(25 * pi / 180) / 200, radius = tan(asin(0.1)) / pixel;
    CHECK_NEAR(sqrt(sum / pi), radius, 0.02);
    stage_end(&s);
}

TEST(rotated_scaled_cube_has_its_projected_outline) {
    struct stage s;
    stage_begin(&s, 1);
    s.settings.full = true;
    s.settings.samples = 8;
    s.ambient = colour_all(1);
    struct node *cube = stage_cube(&s, s.root, stage_phong(&s, colour_all(1), colour_all(0), 1));
    stage_move(&s, cube, -0.5, -0.5, -0.5);
    stage_scale(&s, cube, 3, 2, 1e-6); /* flat: its outline is one rectangle */
    stage_rotate(&s, cube, 2, 30);
    CHECK(stage_render(&s, 200, 200));
    double sum = 0, sum_x = 0, sum_y = 0;
    for (uint32_t y = 0; y < 200; y++) {
        for (uint32_t x = 0; x < 200; x++) {
            double c = stage_pixel(&s, x, y).r;
            sum += c;
            sum_x += c * (x + 0.5);
            sum_y += c * (y + 0.5);
        }
    }
    double pixel = 2 * tan(25 * pi / 180) / 200 * 10;
    CHECK_NEAR(sum * pixel * pixel, 6, 0.01);
    CHECK_NEAR(sum_x / sum, 100, 0.02);
    CHECK_NEAR(sum_y / sum, 100, 0.02);
    /* The corner (1.5, 1) turned by 30 degrees is the topmost point. */
    double top = 100 - (1.5 * sin(pi / 6) + cos(pi / 6)) / pixel;
    uint32_t first_row = 0;
    while (first_row < 200) {
        double row = 0;
        for (uint32_t x = 0; x < 200; x++)
            row += stage_pixel(&s, x, first_row).r;
        if (row > 0.01)
            break;
        first_row++;
    }
    CHECK_NEAR(first_row + 0.5, top, 1);
    stage_end(&s);
}

TEST(phong_value_at_computed_points) {
    struct stage s;
    stage_begin(&s, 1);
    struct colour kd = {0.7, 0.5, 0.3}, ks = {0.2, 0.4, 0.6};
    (void)stage_sphere(&s, s.root, stage_phong(&s, kd, ks, 7));
    stage_point_light(&s, vec3_make(3, 4, 9), colour_make(0.9, 0.8, 1.1));
    s.lights[0].falloff[1] = 0.05;
    s.lights[0].falloff[2] = 0.01;
    s.ambient = colour_make(0.1, 0.2, 0.3);
    s.settings.samples = 1;
    CHECK(stage_render(&s, 101, 101));
    for (uint32_t at = 30; at < 70; at += 7) {
        /* The eye is at (0, 0, 10); intersect by hand. */
        double half = tan(25 * pi / 180);
        struct vec3 d = {((at + 0.5) / 50.5 - 1) * half, (1 - (at + 3.5) / 50.5) * half, -1}, o = {0, 0, 10};
        double a = vec3_dot(d, d), b = vec3_dot(o, d), c = vec3_dot(o, o) - 1, root = b * b - a * c;
        struct colour expected = {0, 0, 0};
        if (root > 0) {
            struct vec3 n = vec3_add_scaled(o, d, (-b - sqrt(root)) / a), v = vec3_normalize(vec3_negate(d));
            struct vec3 to = vec3_sub(s.lights[0].position, n), l = vec3_normalize(to);
            double distance = vec3_length(to), n_l = vec3_dot(n, l);
            struct vec3 r = vec3_sub(vec3_scale(n, 2 * n_l), l);
            double h = n_l > 0 && vec3_dot(r, v) > 0 ? pow(vec3_dot(r, v), 7) : 0;
            double fall = 1 / (1 + 0.05 * distance + 0.01 * distance * distance);
            struct colour sum = colour_add(colour_scale(kd, n_l > 0 ? n_l : 0), colour_scale(ks, h));
            expected = colour_add(colour_mul(s.ambient, kd), colour_scale(colour_mul(s.lights[0].colour, sum), fall));
        }
        struct colour got = stage_pixel(&s, at, at + 3);
        CHECK_NEAR(got.r, expected.r, 1e-6);
        CHECK_NEAR(got.g, expected.g, 1e-6);
        CHECK_NEAR(got.b, expected.b, 1e-6);
    }
    stage_end(&s);
}

TEST(shininess_zero_gives_one_on_the_lit_side_only) {
    struct stage s;
    stage_begin(&s, 1);
    (void)stage_sphere(&s, s.root, stage_phong(&s, colour_all(0), colour_all(0.25), 0));
    stage_point_light(&s, vec3_make(100, 0, 10), colour_all(1));
    CHECK(stage_render(&s, 41, 41));
    CHECK_NEAR(stage_pixel(&s, 22, 20).r, 0.25, 1e-6);
    CHECK_NEAR(stage_pixel(&s, 17, 20).r, 0, 1e-9);
    stage_end(&s);
}

TEST(shadow_of_a_sphere_ends_where_geometry_says) {
    struct stage s;
    stage_begin(&s, 1);
    struct material *white = stage_phong(&s, colour_all(1), colour_all(0), 1);
    struct node *floor_node = stage_cube(&s, s.root, white);
    stage_move(&s, floor_node, -0.5, -1, -0.5);
    stage_scale(&s, floor_node, 100, 1, 100);
    struct node *ball = stage_sphere(&s, s.root, white);
    stage_move(&s, ball, 0, 3, 0);
    stage_point_light(&s, vec3_make(0, 8, 0), colour_all(1));
    /* A view from above through the light: 1 unit is a known number of pixels. */
    s.camera = (struct camera){{0, 6, 0}, {0, -1, 0}, {0, 0, -1}, 90};
    s.camera.eye.y = 60;
    s.camera.fov = 2 * atan(6.0 / 60) * 180 / pi; /* the visible part of the floor is 12 x 12 */
    s.settings.full = true;
    s.settings.samples = 4;
    CHECK(stage_render(&s, 240, 240));
    /* Light 5 above the centre, radius 1: half angle asin(1/5); the shadow's radius on the floor, 8 below the light. */
    double radius = 8 * tan(asin(0.2));
    /* From the outside in: the ball itself hides the middle. */
    double edge = 0;
    for (uint32_t x = 239; x > 120; x--) {
        if (stage_pixel(&s, x, 120).r < 1e-9) {
            edge = (x + 1 - 120) / 20.0;
            break;
        }
    }
    CHECK_NEAR(edge, radius, 0.06);
    stage_end(&s);
}

TEST(a_face_seen_from_behind_gets_no_light_unless_two_sided) {
    for (int two_sided = 0; two_sided < 2; two_sided++) {
        struct stage s;
        stage_begin(&s, 1);
        struct material *white = stage_phong(&s, colour_all(1), colour_all(0), 1);
        white->phong.two_sided = two_sided;
        static const double vertices[3][3] = {{-2, -2, 0}, {0, 2, 0}, {2, -2, 0}}; /* normal -z */
        static const uint32_t starts[2] = {0, 3}, indices[3] = {0, 1, 2};
        struct mesh_input input = {.name = "sheet",
                                   .vertex_count = 3,
                                   .face_count = 1,
                                   .vertices = vertices,
                                   .face_start = starts,
                                   .vertex_index = indices};
        struct node *writer = stage_cube(&s, s.root, white);
        writer->shape = (struct shape){.kind = SHAPE_MESH, .mesh = assets_mesh(&s.assets, &input, &s.error)};
        stage_point_light(&s, vec3_make(0, 0, 5), colour_all(1));
        CHECK(stage_render(&s, 21, 21));
        CHECK_NEAR(stage_pixel(&s, 10, 10).r, two_sided, 1e-2);
        stage_end(&s);
    }
}

/* --- superposition, symmetry, scale, threads --- */

/* A scene with many kinds of objects. `unit`: the length of one unit. `mirrored`: x becomes -x. */
static void busy_scene(struct stage *s, double unit, bool mirrored) {
    struct node *top = stage_group(s, s->root);
    struct material *glass = stage_glass(s, 0.3, 0.8, 1.5);
    struct material *shiny = stage_phong(s, colour_make(0.8, 0.3, 0.2), colour_all(0.5), 20);
    struct material *marble = scene_material(&s->scene, MATERIAL_MARBLE, shiny, &s->error);
    CHECK(material_mix_kd(marble, texture_marble(2, 3, 4, 0), texture_constant(colour_make(0.1, 0.2, 0.9)),
                          &s->scene.arena, &s->error));
    struct material *chrome = stage_glass(s, 0.9, 0, 1);
    struct material *dielectric = scene_material(&s->scene, MATERIAL_FRESNEL, glass, &s->error);
    struct node *ball = stage_sphere(s, top, dielectric);
    stage_move(s, ball, 0.7, 0.2, 1.5);
    struct node *cube = stage_cube(s, top, marble);
    stage_rotate(s, cube, 1, 35);
    stage_scale(s, cube, 1.5, 2, 1.2);
    stage_move(s, cube, -2, -1, -1);
    struct node *mirror = stage_sphere(s, top, chrome);
    stage_scale(s, mirror, 1.2, 0.8, 1);
    stage_move(s, mirror, 2, 1.4, -1.5);
    struct node *floor_node = stage_cube(s, top, stage_phong(s, colour_make(0.5, 0.6, 0.5), colour_all(0.1), 5));
    stage_move(s, floor_node, -0.5, -1, -0.5);
    stage_scale(s, floor_node, 20, 0.3, 20);
    stage_move(s, floor_node, 0, -1, 0);
    stage_scale(s, top, mirrored ? -unit : unit, unit, unit);
    double side = mirrored ? -unit : unit;
    s->ambient = colour_all(0.1);
    stage_point_light(s, vec3_make(4 * side, 6 * unit, 5 * unit), colour_all(0.7));
    s->lights[1] = (struct light){.kind = LIGHT_PARALLELOGRAM,
                                  .corner = {-6 * side, 5 * unit, 2 * unit},
                                  .edge1 = {2 * side, 0, 0},
                                  .edge2 = {0, 0, 2 * unit},
                                  .colour = {0.4, 0.5, 0.6},
                                  .falloff = {1, 0.01 / unit, 0.002 / unit / unit}};
    s->lights[1].position = vec3_make(-5 * side, 5 * unit, 3 * unit);
    s->light_count = 2;
    s->sky.kind = SKY_GRADIENT;
    s->camera = (struct camera){{0.3 * side, 1.5 * unit, 9 * unit}, {0, -0.1, -1}, {0, 1, 0}, 45};
    s->settings.samples = 2;
}

static unsigned char *copy_film(const struct stage *s, size_t *size) {
    *size = (size_t)s->film.width * s->film.height * film_record_size(s->film.record);
    unsigned char *copy = malloc(*size);
    memcpy(copy, s->film.pixels, *size);
    return copy;
}

/* Keeps the first film; every later one must have the same bytes. The caller frees *reference. */
static void check_same_film(const struct stage *s, unsigned char **reference) {
    size_t size;
    unsigned char *bytes = copy_film(s, &size);
    if (*reference) {
        CHECK(memcmp(*reference, bytes, size) == 0);
        free(bytes);
    } else {
        *reference = bytes;
    }
}

TEST(scaling_a_scene_by_a_power_of_two_gives_the_same_bits) {
    unsigned char *reference = NULL;
    static const double units[] = {1, 0x1p-10, 0x1p20};
    for (int i = 0; i < 3; i++) {
        struct stage s;
        stage_begin(&s, 2);
        busy_scene(&s, units[i], false);
        CHECK(stage_render(&s, 120, 90));
        check_same_film(&s, &reference);
        stage_end(&s);
    }
    free(reference);
}

TEST(scaling_a_scene_by_other_factors_changes_at_most_one_level_in_one_pixel_of_ten_thousand) {
    struct film_pixel *reference = NULL;
    static const double units[] = {1, 1e-3, 1e6};
    for (int i = 0; i < 3; i++) {
        struct stage s;
        size_t size;
        stage_begin(&s, 2);
        busy_scene(&s, units[i], false);
        CHECK(stage_render(&s, 160, 120));
        struct film_pixel *pixels = (struct film_pixel *)copy_film(&s, &size);
        if (!reference) {
            reference = pixels;
        } else {
            int different = 0;
            for (size_t p = 0; p < 160 * 120; p++) {
                int worst = 0;
                for (int c = 0; c < 3; c++) {
                    int a = (int)floor(255 * fmin(1, (double)reference[p].rgb[c]) + 0.5);
                    int b = (int)floor(255 * fmin(1, (double)pixels[p].rgb[c]) + 0.5);
                    worst = abs(a - b) > worst ? abs(a - b) : worst;
                }
                different += worst > 0;
                CHECK(worst <= 1);
            }
            CHECK(different * 10000 <= 160 * 120);
            free(pixels);
        }
        stage_end(&s);
    }
    free(reference);
}

TEST(threads_do_not_change_a_bit) {
    unsigned char *reference = NULL;
    static const int threads[] = {1, 2, 7};
    for (int i = 0; i < 3; i++) {
        struct stage s;
        stage_begin(&s, threads[i]);
        busy_scene(&s, 1, false);
        CHECK(stage_render(&s, 130, 70));
        check_same_film(&s, &reference);
        stage_end(&s);
    }
    free(reference);
}

TEST(every_accelerator_gives_the_same_picture) {
    unsigned char *reference = NULL;
    for (int i = 0; i < 5; i++) {
        struct stage s;
        stage_begin(&s, 2);
        busy_scene(&s, 1, false);
        static const enum accel_kind kinds[5] = {ACCEL_NONE, ACCEL_AUTO, ACCEL_GRID, ACCEL_BVH, ACCEL_KDTREE};
        s.settings.accel = kinds[i];
        CHECK(stage_render(&s, 100, 70));
        check_same_film(&s, &reference);
        stage_end(&s);
    }
    free(reference);
}

/* The memory set up for a picture does not depend on its size, and rendering allocates nothing else. */
TEST(rendering_a_hundred_times_as_many_pixels_takes_no_more_allocations) {
#ifndef GRAY_FAULTS
    test_skip("allocations are counted only in builds with GRAY_FAULTS");
#endif
    struct stage s;
    uint64_t taken[3];
    stage_begin(&s, 2);
    busy_scene(&s, 1, false);
    for (int i = 0; i < 3; i++) { /* the first one builds the indices of meshes */
        uint64_t before = mem_allocations();
        CHECK(stage_render(&s, i < 2 ? 16 : 160, i < 2 ? 12 : 120));
        taken[i] = mem_allocations() - before;
    }
    CHECK(taken[1] > 0);
    CHECK_EQ_INT((int64_t)taken[2], (int64_t)taken[1]);
    stage_end(&s);
}

TEST(crop_is_exactly_that_part_of_the_whole) {
    struct stage whole, part;
    stage_begin(&whole, 2);
    busy_scene(&whole, 1, false);
    CHECK(stage_render(&whole, 150, 100));
    stage_begin(&part, 2);
    busy_scene(&part, 1, false);
    part.settings.cropped = true;
    part.settings.crop_x = 37;
    part.settings.crop_y = 11;
    part.settings.crop_width = 65;
    part.settings.crop_height = 60;
    CHECK(stage_render(&part, 150, 100));
    CHECK_EQ_INT(part.film.width, 65);
    int wrong = 0;
    for (uint32_t y = 0; y < 60; y++) {
        for (uint32_t x = 0; x < 65; x++) {
            size_t at = y * 65 + x, in_whole = (y + 11) * 150 + x + 37;
            wrong += memcmp(&part.film.pixels[at], &whole.film.pixels[in_whole], sizeof(struct film_pixel)) != 0;
            wrong += memcmp(&part.film.floats[3 * at], &whole.film.floats[3 * in_whole], 3 * sizeof(float)) != 0;
        }
    }
    CHECK_EQ_INT(wrong, 0);
    stage_end(&part);
    stage_end(&whole);
}

TEST(mirrored_scene_gives_the_mirrored_picture) {
    struct stage a, b;
    stage_begin(&a, 2);
    stage_begin(&b, 2);
    busy_scene(&a, 1, false);
    busy_scene(&b, 1, true);
    /* Jitter is a function of the pixel, so only hard shadows can be compared, on a grid that is its own mirror image.
     */
    a.light_count = b.light_count = 1;
    a.settings.full = b.settings.full = true;
    a.settings.aa_pattern = b.settings.aa_pattern = AA_GRID;
    CHECK(stage_render(&a, 120, 80) && stage_render(&b, 120, 80));
    double worst = 0;
    int off = 0;
    for (uint32_t y = 0; y < 80; y++) {
        for (uint32_t x = 0; x < 120; x++) {
            struct colour d = colour_sub(stage_pixel(&a, x, y), stage_pixel(&b, 119 - x, y));
            worst = fmax(worst, colour_max_abs(d));
            off += colour_max_abs(d) > 1e-5;
        }
    }
    CHECK(off <= 1);
    stage_end(&a);
    stage_end(&b);
}

TEST(two_lights_together_are_the_sum_of_both) {
    struct stage s[3];
    for (int i = 0; i < 3; i++) {
        stage_begin(&s[i], 2);
        busy_scene(&s[i], 1, false);
        s[i].ambient = colour_all(0);
        s[i].sky = (struct sky){.kind = SKY_CONSTANT};
        s[i].settings.full = true;
        if (i == 0)
            s[i].lights[1].colour = colour_all(0);
        if (i == 1)
            s[i].lights[0].colour = colour_all(0);
        CHECK(stage_render(&s[i], 90, 60));
    }
    double worst = 0;
    for (uint32_t y = 0; y < 60; y++) {
        for (uint32_t x = 0; x < 90; x++) {
            struct colour sum = colour_add(stage_pixel(&s[0], x, y), stage_pixel(&s[1], x, y));
            worst = fmax(worst, colour_max_abs(colour_sub(sum, stage_pixel(&s[2], x, y))));
        }
    }
    CHECK(worst < 1e-5);
    for (int i = 0; i < 3; i++)
        stage_end(&s[i]);
}

/* --- media: directions through glass, from the sky's colour --- */

/* The sky {0, 0, (1 + y) / 2} shows the y of the unit direction that left the scene. */
static double leaving_y(struct stage *s) {
    s->settings.samples = 1;
    s->settings.refract_limit = 10;
    s->sky.kind = SKY_GRADIENT;
    CHECK(stage_render(s, 1, 1));
    return 2 * stage_pixel(s, 0, 0).b - 1;
}

static struct vec3 refract_by_hand(struct vec3 d, struct vec3 n, double from, double to) {
    d = vec3_normalize(d);
    n = vec3_normalize(n);
    if (vec3_dot(d, n) > 0)
        n = vec3_negate(n);
    double c = -vec3_dot(d, n), eta = from / to;
    return vec3_add(vec3_scale(d, eta), vec3_scale(n, eta * c - sqrt(1 - eta * eta * (1 - c * c))));
}

static struct vec3 sphere_point(struct vec3 o, struct vec3 d, double radius, bool far) {
    double a = vec3_dot(d, d), b = vec3_dot(o, d), c = vec3_dot(o, o) - radius * radius, root = sqrt(b * b - a * c);
    return vec3_add_scaled(o, d, (-b + (far ? root : -root)) / a);
}

TEST(snell_through_a_glass_ball) {
    struct stage s;
    stage_begin(&s, 1);
    (void)stage_sphere(&s, s.root, stage_glass(&s, 0, 1, 1.5));
    s.camera = (struct camera){{0, 0.6, 10}, {0, 0, -1}, {0, 1, 0}, 1};
    struct vec3 o = {0, 0.6, 10}, d = {0, 0, -1};
    struct vec3 p = sphere_point(o, d, 1, false), in = refract_by_hand(d, p, 1, 1.5);
    struct vec3 q = sphere_point(p, in, 1, true), out = refract_by_hand(in, q, 1.5, 1);
    CHECK_NEAR(leaving_y(&s), out.y, 1e-6);
    stage_end(&s);
}

/* Two concentric spheres: outer index a, inner index b. */
static void nested_balls(double outer, double inner, double radius, bool camera_inside) {
    struct stage s;
    stage_begin(&s, 1);
    (void)stage_sphere(&s, s.root, stage_glass(&s, 0, 1, outer));
    struct node *ball = stage_sphere(&s, s.root, stage_glass(&s, 0, 1, inner));
    stage_scale(&s, ball, radius, radius, radius);
    double start = camera_inside ? 0 : 10, height = camera_inside ? 0.1 : 0.3;
    s.camera = (struct camera){{0, height, start}, {0, 0, -1}, {0, 1, 0}, 1};
    struct vec3 o = {0, height, start}, d = {0, 0, -1};
    struct vec3 p = o;
    if (!camera_inside) {
        p = sphere_point(o, d, 1, false);
        d = refract_by_hand(d, p, 1, outer);
        p = sphere_point(p, d, radius, false);
        d = refract_by_hand(d, p, outer, inner);
    }
    p = sphere_point(p, d, radius, true);
    d = refract_by_hand(d, p, inner, outer);
    p = sphere_point(p, d, 1, true);
    d = refract_by_hand(d, p, outer, 1);
    CHECK_NEAR(leaving_y(&s), d.y, 1e-6);
    stage_end(&s);
}

TEST(glass_in_water_bubble_in_glass_shell_and_camera_inside_follow_snell) {
    nested_balls(1.333, 1.5, 0.6, false); /* glass in water */
    nested_balls(1.5, 1, 0.4, false);     /* an air bubble in glass */
    nested_balls(1.5, 1, 0.95, false);    /* a thin shell */
    nested_balls(1.5, 1.333, 0.5, true);  /* the camera inside water inside glass */
}

TEST(overlapping_solids_are_left_at_any_depth_of_the_stack) {
    /* Two slabs, x-normal, that overlap: a ray passes 1 | A | A+B | B | 1 and leaves parallel to its original
     * direction. */
    struct stage s;
    stage_begin(&s, 1);
    for (int i = 0; i < 2; i++) {
        struct node *slab = stage_cube(&s, s.root, stage_glass(&s, 0, 1, i ? 1.7 : 1.4));
        stage_move(&s, slab, -0.5, -0.5, 0);
        stage_scale(&s, slab, 50, 50, 2);
        stage_move(&s, slab, 0, 0, i ? -1 : 0);
    }
    s.camera = (struct camera){{0, 0, 10}, {0, 0.4, -1}, {0, 1, 0}, 1};
    CHECK_NEAR(leaving_y(&s), 0.4 / sqrt(1.16), 1e-7);
    stage_end(&s);
}

TEST(fresnel_reflectance_at_tabulated_angles) {
    /* Unpolarised reflectance of glass 1.5 in air: Hecht, "Optics", normal 0.04, 45 degrees 0.0502, 60 degrees 0.0892.
     */
    CHECK_NEAR(dielectric_fresnel(1, 1 / 1.5), 0.04, 1e-12);
    CHECK_NEAR(dielectric_fresnel(cos(pi / 4), 1 / 1.5), 0.050240, 2e-6);
    CHECK_NEAR(dielectric_fresnel(0.5, 1 / 1.5), 0.089186, 2e-5);
    CHECK_NEAR(dielectric_fresnel(1e-9, 1 / 1.5), 1, 1e-7);
    CHECK_NEAR(dielectric_fresnel(cos(50 * pi / 180), 1.5), 1, 0); /* beyond the critical angle of 41.8 degrees */
    /* Brewster's angle: the p part vanishes, what is left is half of the s part. */
    double brewster = atan(1.5), s = (1 - 2.25) / (1 + 2.25);
    CHECK_NEAR(dielectric_fresnel(cos(brewster), 1 / 1.5), 0.5 * s * s, 1e-12);
}

TEST(total_internal_reflection_is_lost_without_use_tir_and_kept_with_it) {
    for (int use_tir = 0; use_tir < 2; use_tir++) {
        struct stage s;
        stage_begin(&s, 1);
        /* From inside a glass cube at 45 degrees to a wall. */
        struct node *cube = stage_cube(&s, s.root, stage_glass(&s, 0, 1, 1.5));
        stage_move(&s, cube, -0.5, -0.5, -0.5);
        stage_scale(&s, cube, 2, 2, 2);
        s.camera = (struct camera){{0.2, 0.1, 0}, {1, 0.9, 0}, {0, 0, 1}, 1};
        s.settings.use_tir = use_tir;
        s.settings.reflect_limit = 1;
        s.settings.samples = 1;
        s.sky = (struct sky){.kind = SKY_CONSTANT, .colour = {1, 1, 1}};
        CHECK(stage_render(&s, 1, 1));
        /* With a limit of one reflection the path ends inside: the second wall reflects it totally again, so it is
         * black. */
        CHECK_NEAR(stage_pixel(&s, 0, 0).r, 0, 0);
        CHECK_EQ_INT(s.statistics.reflected_rays, use_tir);
        stage_end(&s);
    }
}

TEST(filter_colour_lets_only_its_light_through) {
    struct stage s;
    stage_begin(&s, 1);
    struct material *blue = stage_glass(&s, 0, 1, 1);
    blue->phong.ks = colour_make(0, 0, 1);
    s.camera.fov = 5;
    (void)stage_sphere(&s, s.root, blue);
    s.sky = (struct sky){.kind = SKY_CONSTANT, .colour = {0.9, 0.8, 0.7}};
    CHECK(stage_render(&s, 3, 3));
    struct colour c = stage_pixel(&s, 1, 1);
    CHECK(c.r == 0 && c.g == 0);
    CHECK_NEAR(c.b, 0.7, 1e-6);
    stage_end(&s);
}

TEST(limits_count_reflections_and_refractions_apart) {
    struct stage s;
    stage_begin(&s, 1);
    (void)stage_sphere(&s, s.root, stage_glass(&s, 0, 1, 1.2));
    s.sky = (struct sky){.kind = SKY_CONSTANT, .colour = {1, 1, 1}};
    s.camera.fov = 5;
    s.settings.reflect_limit = 0;
    s.settings.refract_limit = 2;
    CHECK(stage_render(&s, 3, 3));
    CHECK_NEAR(stage_pixel(&s, 1, 1).r, 1, 1e-6);
    s.settings.refract_limit = 1;
    CHECK(stage_render(&s, 3, 3));
    CHECK_NEAR(stage_pixel(&s, 1, 1).r, 0, 0);
    stage_end(&s);
}

TEST(camera_replaces_an_up_parallel_to_view_with_one_warning) {
    struct settings settings = settings_default();
    struct camera camera = {{0, 0, 0}, {0, -3, 0}, {0, 2, 0}, 60};
    struct camera_frame frame;
    struct error error;
    char warning[256];
    CHECK(camera_prepare(&camera, &settings, (struct picture_size){10, 10}, &frame, warning, &error));
    CHECK(strstr(warning, "up is parallel to view") != NULL);
    CHECK_NEAR(vec3_dot(frame.right, frame.forward), 0, 1e-15);
    camera.up = vec3_make(5, 2, 0);
    CHECK(camera_prepare(&camera, &settings, (struct picture_size){10, 10}, &frame, warning, &error));
    CHECK_TEXT(warning, "");
}

/* Solid i of primitive i modulo 10, with index 1 + i / 100. */
enum { SOLIDS = 100 };
static struct solid numbered_solids[SOLIDS];
static struct medium numbered_media[SOLIDS];
static const struct media numbered = {numbered_solids, numbered_media, 0};
static void number_solids(void) {
    for (uint32_t i = 0; i < SOLIDS; i++) {
        numbered_solids[i] = (struct solid){i % 10, i};
        numbered_media[i] = (struct medium){.ior = 1 + i / 100.0};
    }
}

TEST(media_stack_removes_the_solid_that_is_left) {
    number_solids();
    struct medium_stack media = {.media = &numbered};
    CHECK_NEAR(medium_stack_ior(&media), 1, 0);
    medium_stack_enter(&media, 53);
    medium_stack_enter(&media, 37);
    medium_stack_enter(&media, 63);
    medium_stack_leave(&media, 7);
    CHECK_NEAR(medium_stack_ior(&media), 1.63, 0);
    medium_stack_leave(&media, 3);
    CHECK_NEAR(medium_stack_ior(&media), 1.53, 0);
    medium_stack_leave(&media, 9);
    CHECK_EQ_INT(media.count, 1);
    for (uint32_t i = 0; i < SOLIDS; i++)
        medium_stack_enter(&media, i);
    CHECK_EQ_INT(media.count, MEDIUM_STACK_LIMIT);
    CHECK_NEAR(medium_stack_ior(&media), 1.99, 0);
}

TEST(the_relative_index_is_that_of_the_stacks_before_and_behind) {
    struct test_random random = {3};
    number_solids();
    for (int run = 0; run < 2000; run++) {
        struct medium_stack before = {.media = &numbered}, behind;
        for (int i = (int)test_uniform(&random, 0, 6); i > 0; i--)
            medium_stack_enter(&before, (uint32_t)test_uniform(&random, 0, 40) / 10 * 10 +
                                            (uint32_t)test_uniform(&random, 0, 4));
        uint32_t solid = 40 + (uint32_t)test_uniform(&random, 0, 4);
        struct medium_boundary boundary = {.solid = solid, .ior = numbered_media[solid].ior, .entering = run % 2 == 0};
        medium_stack_copy(&behind, &before);
        medium_stack_cross(&behind, &boundary);
        bool stays = !boundary.entering && behind.count == before.count; /* it was in a solid it never entered */
        double here = stays ? boundary.ior : medium_stack_ior(&before);
        CHECK_NEAR(medium_stack_eta(&before, &boundary), here / medium_stack_ior(&behind), 0);
    }
}
