/* Lenses, projections and stereo pairs by closed forms. */
#include "render/camera.h"
#include "tests/harness.h"
#include "tests/stage.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

/* Only a small bright ball at the given position. */
static void dot_stage(struct stage *s, struct vec3 at, double radius) {
    stage_begin(s, 2);
    struct material *material = stage_phong(s, colour_all(1), colour_all(0), 1);
    material->phong.unlit = true;
    struct node *ball = stage_sphere(s, s->root, material);
    stage_scale(s, ball, radius, radius, radius);
    stage_move(s, ball, at.x, at.y, at.z);
    s->camera = (struct camera){{0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 40};
    s->settings.full = true;
    s->settings.samples = 4;
    s->settings.aa_pattern = AA_GRID; /* the same in every pixel */
}

struct moments {
    double sum, x, y, xx, yy;
};

static struct moments moments_of(const struct stage *s, uint32_t x0, uint32_t x1, int channel) {
    struct moments m = {0};
    for (uint32_t y = 0; y < s->film.height; y++) {
        for (uint32_t x = x0; x < x1; x++) {
            double c = colour_get(stage_pixel(s, x, y), channel);
            m.sum += c;
            m.x += c * (x + 0.5);
            m.y += c * (y + 0.5);
            m.xx += c * (x + 0.5) * (x + 0.5);
            m.yy += c * (y + 0.5) * (y + 0.5);
        }
    }
    m.x /= m.sum, m.y /= m.sum;
    m.xx = m.xx / m.sum - m.x * m.x;
    m.yy = m.yy / m.sum - m.y * m.y;
    return m;
}

TEST(a_point_out_of_focus_is_a_disc_of_the_circle_of_confusion) {
    static const double depths[] = {5, 20, 8};
    for (int i = 0; i < 3; i++) {
        for (int blades = 0; blades <= 6; blades += 3) {
            struct stage s;
            double z = depths[i], ball = 0.02 * z, focus = 10, aperture = 0.8;
            dot_stage(&s, vec3_make(0, 0, -z), ball);
            /* The 40 pixels in the middle of 96. */
            s.camera.fov = 2 * atan(tan(20 * pi / 180) * 40 / 96) * 180 / pi;
            s.settings.samples = 16;
            s.settings.lens.aperture = aperture;
            s.settings.lens.focus = focus;
            s.settings.lens.blades = blades;
            CHECK(stage_render(&s, 40, 40));
            double pixel = 2 * tan(20 * pi / 180) / 96, radius = aperture * fabs(1 / focus - 1 / z) / pixel;
            /* Variance along an axis: R^2 / 4 for a disc; (R^2 / 12)(2 + cos(2 pi / n)) for a regular polygon. */
            double variance = blades ? radius * radius / 12 * (2 + cos(2 * pi / blades)) : radius * radius / 4;
            double own = ball / z / pixel;
            variance += own * own / 4 + 1.0 / 12;
            struct moments m = moments_of(&s, 0, 40, 0);
            CHECK_NEAR(m.x, 20, 0.15);
            CHECK_NEAR(m.y, 20, 0.15);
            CHECK_NEAR(m.xx / variance, 1, 0.04);
            CHECK_NEAR(m.yy / variance, 1, 0.04);
            CHECK_NEAR(m.sum / (pi * own * own), 1, 0.02); /* blur keeps the light */
            stage_end(&s);
        }
    }
}

TEST(what_is_in_focus_is_as_sharp_as_through_a_pinhole) {
    for (int by_point = 0; by_point < 2; by_point++) {
        struct stage s;
        dot_stage(&s, vec3_make(0.7, 0.3, -10), 1);
        CHECK(stage_render(&s, 64, 64));
        struct moments sharp = moments_of(&s, 0, 64, 0);
        s.settings.lens.aperture = 0.05;
        s.settings.lens.focus = by_point ? 0 : 10;
        s.settings.lens.focus_point = vec3_make(-3, 2, -10);
        CHECK(stage_render(&s, 64, 64));
        struct moments lens = moments_of(&s, 0, 64, 0);
        CHECK_NEAR(lens.xx, sharp.xx, 0.1);
        CHECK_NEAR(lens.sum, sharp.sum, 2);
        stage_end(&s);
    }
}

/* Stratifying pixel and lens together must have less variance than the same number of independent points on the lens.
 */
TEST(samples_of_pixel_and_lens_are_stratified_together) {
    double error[2] = {0, 0};
    for (int single = 0; single < 2; single++) {
        struct stage s;
        dot_stage(&s, vec3_make(-50, 0, -10), 50); /* the edge of a huge ball in the middle: a vertical line */
        s.camera.fov = 1e-4;
        s.settings.lens.aperture = 1;
        s.settings.lens.focus = 5;
        error[single] = stage_variance_about_half(&s, single);
        stage_end(&s);
    }
    CHECK(error[0] < 0.3 * error[1]);
}

TEST(orthographic_size_does_not_depend_on_depth) {
    for (int i = 0; i < 2; i++) {
        struct stage s;
        dot_stage(&s, vec3_make(1, 0.5, i ? -100 : -3), 1);
        s.settings.lens.projection = PROJECTION_ORTHOGRAPHIC;
        s.settings.lens.view_height = 5;
        CHECK(stage_render(&s, 100, 100));
        struct moments m = moments_of(&s, 0, 100, 0);
        CHECK_NEAR(m.sum * 0.05 * 0.05, pi, 0.01);
        CHECK_NEAR(m.x, 50 + 20, 0.02);
        CHECK_NEAR(m.y, 50 - 10, 0.02);
        stage_end(&s);
    }
}

TEST(fisheye_radius_is_proportional_to_the_angle) {
    for (int i = 1; i <= 4; i++) {
        struct stage s;
        double angle = i * 40 * pi / 180;
        dot_stage(&s, vec3_make(10 * sin(angle), 0, -10 * cos(angle)), 0.3);
        s.settings.lens.projection = PROJECTION_FISHEYE;
        s.settings.lens.angle = 360;
        CHECK(stage_render(&s, 200, 160));
        struct moments m = moments_of(&s, 0, 200, 0);
        CHECK_NEAR(m.x, 100 + 80 * angle / pi, 0.2);
        CHECK_NEAR(m.y, 80, 0.05);
        s.sky.colour = colour_all(1);
        CHECK(stage_render(&s, 200, 160));
        CHECK_NEAR(stage_pixel(&s, 2, 2).r, 0, 0); /* outside of the circle */
        stage_end(&s);
    }
}

TEST(panorama_shows_longitude_and_latitude) {
    static const struct {
        struct vec3 at;
        double x, y;
    } positions[] = {
        {{10, 0, 0}, 150, 50}, {{0, 0, -10}, 100, 50}, {{-10, 0, 0}, 50, 50}, {{7.071, 7.071, 0}, 150, 25}};
    for (int i = 0; i < 4; i++) {
        struct stage s;
        dot_stage(&s, positions[i].at, 0.3);
        s.settings.lens.projection = PROJECTION_PANORAMA;
        CHECK(stage_render(&s, 200, 100));
        struct moments m = moments_of(&s, 0, 200, 0);
        CHECK_NEAR(m.x, positions[i].x, 0.05);
        CHECK_NEAR(m.y, positions[i].y, 0.05);
        stage_end(&s);
    }
}

TEST(an_off_centre_window_shows_that_part_of_the_larger_picture) {
    struct stage a, b;
    dot_stage(&a, vec3_make(0.4, 0.2, -10), 1);
    dot_stage(&b, vec3_make(0.4, 0.2, -10), 1);
    CHECK(stage_render(&a, 64, 64));
    b.settings.lens.shift_x = 0.125;
    b.settings.lens.shift_y = 0.0625;
    CHECK(stage_render(&b, 64, 64));
    int wrong = 0;
    for (uint32_t y = 4; y < 64; y++) {
        for (uint32_t x = 0; x < 56; x++)
            wrong += stage_pixel(&b, x, y).r != stage_pixel(&a, x + 8, y - 4).r;
    }
    CHECK_EQ_INT(wrong, 0);
    stage_end(&a);
    stage_end(&b);
}

TEST(stereo_disparity_is_that_of_the_eyes_and_the_screen) {
    static const double depths[] = {4, 10, 40};
    for (int i = 0; i < 3; i++) {
        struct stage s;
        double z = depths[i], eyes = 0.6, screen = 10;
        dot_stage(&s, vec3_make(0.02 * z, 0, -z), 0.02 * z);
        s.settings.lens.stereo = STEREO_SIDE;
        s.settings.lens.eye_distance = eyes;
        s.settings.lens.screen = screen;
        CHECK(stage_render(&s, 256, 128));
        double pixel = 2 * tan(20 * pi / 180) / 128, left = moments_of(&s, 0, 128, 0).x;
        double right = moments_of(&s, 128, 256, 0).x - 128;
        CHECK_NEAR(left - right, eyes * (1 / z - 1 / screen) / pixel, 0.05);
        CHECK_NEAR((left + right) / 2, 64 + 0.02 / pixel, 0.05);
        /* The anaglyph has the left eye in red and the right one in green and blue. */
        s.settings.lens.stereo = STEREO_ANAGLYPH;
        CHECK(stage_render(&s, 128, 128));
        CHECK_NEAR(moments_of(&s, 0, 128, 0).x, left, 1e-6);
        CHECK_NEAR(moments_of(&s, 0, 128, 1).x, right, 1e-6);
        CHECK_NEAR(moments_of(&s, 0, 128, 2).x, right, 1e-6);
        stage_end(&s);
    }
}

TEST(lenses_give_the_same_bits_for_any_threads_crop_and_power_of_two) {
    struct film_pixel *reference = NULL;
    for (int i = 0; i < 4; i++) {
        struct stage s;
        double unit = i == 3 ? 0x1p12 : 1;
        dot_stage(&s, vec3_make(0, 0, -3 * unit), unit);
        s.settings.lens.aperture = 0.2 * unit;
        s.settings.lens.focus = 5 * unit;
        s.settings.lens.blades = 5;
        pool_destroy(s.pool);
        char warning[256];
        s.pool = pool_create(i == 1 ? 7 : 2, warning);
        if (i == 2) {
            s.settings.cropped = true;
            s.settings.crop_height = 40;
            s.settings.crop_width = 70;
        }
        CHECK(stage_render(&s, 70, 50));
        if (!reference)
            reference = memcpy(malloc(2 * 70 * 50 * sizeof *reference), s.film.pixels, 2 * 70 * 50 * sizeof *reference);
        size_t size = (size_t)70 * (i == 2 ? 40 : 50) * sizeof *reference;
        CHECK(memcmp(reference, s.film.pixels, size) == 0 && memcmp(reference + 70 * 50, s.film.floats, size) == 0);
        stage_end(&s);
    }
    free(reference);
}

TEST(an_orthographic_ray_that_starts_inside_glass_carries_the_glass) {
    struct stage s;
    stage_begin(&s, 1);
    struct material *glass = stage_glass(&s, 0, 1, 1.5);
    glass->phong.absorption = colour_all(1);
    struct node *slab = stage_cube(&s, s.root, glass); /* x from 0 to 1: half of the picture */
    stage_scale(&s, slab, 1, 2, 1);
    stage_move(&s, slab, 0, -1, -0.5);
    s.sky.colour = colour_all(1);
    s.camera = (struct camera){{0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 40};
    s.settings.lens.projection = PROJECTION_ORTHOGRAPHIC;
    s.settings.lens.view_height = 1;
    CHECK(stage_render(&s, 4, 4));
    CHECK_NEAR(stage_pixel(&s, 0, 1).r, 1, 1e-9);
    CHECK_NEAR(stage_pixel(&s, 3, 1).r, exp(-0.5), 1e-6);
    stage_end(&s);
}

/* A lens half in glass: with a distant focus all its rays have one direction, so the picture is the mean of a pinhole's
 * in the glass and one in the air. */
TEST(glass_that_the_lens_cuts_through_is_known_to_each_ray) {
    double lens = 0, pinhole[2] = {0, 0};
    for (int i = 0; i < 3; i++) {
        struct stage s;
        stage_begin(&s, 1);
        s.sky = (struct sky){.kind = SKY_GRADIENT};
        struct node *block = stage_cube(&s, s.root, stage_glass(&s, 0, 1, 1.5));
        stage_scale(&s, block, 100, 100, 20);
        stage_move(&s, block, -100, -50, -1);
        s.camera = (struct camera){{i == 0 ? 0 : i == 1 ? -0.25 : 0.25, 0, 0}, {0, 0.5, -1}, {0, 1, 0}, 1e-4};
        s.settings.samples = 16;
        s.settings.lens.aperture = i == 0 ? 0.5 : 0;
        s.settings.lens.focus = 1e9;
        CHECK(stage_render(&s, 1, 1));
        *(i == 0 ? &lens : &pinhole[i - 1]) = stage_pixel(&s, 0, 0).b;
        stage_end(&s);
    }
    CHECK(pinhole[0] > pinhole[1] + 0.05); /* glass bends the view upwards */
    CHECK_NEAR(lens, (pinhole[0] + pinhole[1]) / 2, 0.02 * (pinhole[0] - pinhole[1]));
}

TEST(lenses_that_cannot_be_are_refused) {
    struct settings settings = settings_default();
    struct camera camera = {{0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 60};
    struct camera_frame frame;
    struct error error;
    char warning[256];
    settings.lens.aperture = 1;
    settings.lens.focus_point = vec3_make(0, 0, 5);
    CHECK(!camera_prepare(&camera, &settings, (struct picture_size){10, 10}, &frame, warning, &error));
    settings.lens.focus = 1;
    CHECK(camera_prepare(&camera, &settings, (struct picture_size){10, 10}, &frame, warning, &error));
    settings.lens.projection = PROJECTION_FISHEYE;
    CHECK(!camera_prepare(&camera, &settings, (struct picture_size){10, 10}, &frame, warning, &error));
    settings.lens.aperture = 0;
    settings.lens.stereo = STEREO_SIDE;
    CHECK(!camera_prepare(&camera, &settings, (struct picture_size){10, 10}, &frame, warning, &error));
    settings.lens.projection = PROJECTION_PERSPECTIVE;
    CHECK(!camera_prepare(&camera, &settings, (struct picture_size){11, 10}, &frame, warning, &error));
}
