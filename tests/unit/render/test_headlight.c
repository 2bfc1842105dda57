/* The picture while a camera moves: one ray for each pixel, shaded by a light at the eye. */
#include "math/elementary.h"
#include "render/headlight.h"
#include "tests/harness.h"
#include "tests/stage.h"

#include <math.h>
#include <string.h>

enum { SIZE = 43 }; /* no multiple of a packet; the middle pixel looks along the view */

static const struct colour kd = {0.8, 0.4, 0.2};

/* A sphere of radius 1 at the origin before a sky. */
static void begin(struct stage *s) {
    stage_begin(s, 2);
    (void)stage_sphere(s, s->root, stage_phong(s, kd, colour_all(0), 1));
    s->sky = (struct sky){.kind = SKY_CONSTANT, .colour = {0.1, 0.2, 0.3}};
    s->camera.fov = 20;
}

/* The film of the stage, by the headlight. */
static void show(struct stage *s, enum headlight_shows shows) {
    struct render_statistics statistics = {0};
    CHECK(stage_render(s, SIZE, SIZE));
    for (uint32_t i = 0; i < film_tile_count(&s->film); i++)
        atomic_store(&s->film.tiles[i], FILM_TILE_WANTED);
    memset(s->film.pixels, 0, sizeof *s->film.pixels * SIZE * SIZE);
    struct render_job job = stage_job(s, SIZE, SIZE);
    job.film = &s->film;
    const struct headlight_request request = {.shows = shows, .state = FILM_TILE_DONE};
    CHECK(render_headlight(&job, &request, s->pool, &statistics, &s->error));
    CHECK_EQ_INT(film_tiles_in(&s->film, FILM_TILE_DONE), film_tile_count(&s->film));
    CHECK(statistics.camera_rays == SIZE * SIZE);
}

static void light_up(struct stage *s) {
    show(s, HEADLIGHT_SURFACES);
}

/* The cosine at the nearest point of the sphere: a ray that passes its centre at the distance d has cosine sqrt(1 -
 * d^2).
 */
static double cosine_at(uint32_t x, uint32_t y) {
    double half = 10 * 3.14159265358979323846 / 180, pixel = 2 * el_sin(half) / el_cos(half) / SIZE;
    double u = (x + 0.5 - SIZE / 2.0) * pixel, v = (y + 0.5 - SIZE / 2.0) * pixel, across = sqrt(u * u + v * v);
    double distance = 10 * across / sqrt(1 + across * across);
    return distance < 1 ? sqrt(1 - distance * distance) : -1;
}

TEST(headlight_shades_a_sphere_by_the_cosine_to_the_eye) {
    struct stage s;
    begin(&s);
    light_up(&s);
    for (uint32_t y = 0; y < SIZE; y++) {
        for (uint32_t x = 0; x < SIZE; x++) {
            double cosine = cosine_at(x, y), light = 0.25 + 0.75 * cosine;
            struct colour want = cosine < 0 ? s.sky.colour : colour_scale(kd, light), got = stage_pixel(&s, x, y);
            CHECK(colour_max_abs(colour_sub(got, want)) < 1e-5);
        }
    }
    stage_end(&s);
}

/* The eye is at a distance of 10: the nearest point of the sphere at 9, seen along its normal. */
TEST(headlight_shows_normals_and_depth_of_a_sphere_by_their_formulas) {
    struct stage s;
    begin(&s);
    s.settings.tone.exposure = 1;
    show(&s, HEADLIGHT_NORMALS);
    struct vec3 view = vec3_normalize(s.camera.view);
    struct colour want = colour_make(0.5 - 0.5 * view.x, 0.5 - 0.5 * view.y, 0.5 - 0.5 * view.z);
    CHECK(colour_max_abs(colour_sub(colour_scale(stage_pixel(&s, SIZE / 2, SIZE / 2), 2), want)) < 1e-4);
    CHECK(colour_max_abs(stage_pixel(&s, 0, 0)) == 0);
    show(&s, HEADLIGHT_DEPTH);
    /* A ray that meets the sphere with the cosine c is sqrt(99 + c^2) - c long; the box ends at its far corners. */
    double farthest = sqrt(11 * 11 + 2);
    for (uint32_t i = 0; i < SIZE * SIZE; i++) {
        double c = cosine_at(i % SIZE, i / SIZE), got = stage_pixel(&s, i % SIZE, i / SIZE).r;
        CHECK_NEAR(2 * got, c < 0 ? 0 : (farthest - (sqrt(99 + c * c) - c)) / (farthest - 9), 1e-4);
    }
    stage_end(&s);
}

/* Blue and green and red add up to one until the colour is red. */
TEST(headlight_shows_more_cost_in_front_of_more_shapes) {
    struct stage s;
    begin(&s);
    for (int i = 0; i < 40; i++)
        stage_move(&s, stage_cube(&s, s.root, stage_phong(&s, kd, colour_all(0), 1)), 0, 0, -0.01 * i);
    show(&s, HEADLIGHT_COST);
    struct colour middle = stage_pixel(&s, SIZE / 2, SIZE / 2), corner = stage_pixel(&s, 0, 0);
    CHECK(middle.b < corner.b && middle.g + middle.r > corner.g + corner.r);
    CHECK(fabs(middle.r + middle.g + middle.b - 1) < 1e-5 && fabs(corner.r + corner.g + corner.b - 1) < 1e-5);
    stage_end(&s);
}

TEST(headlight_is_as_bright_with_any_exposure) {
    struct stage s;
    begin(&s);
    s.settings.tone.exposure = -3;
    light_up(&s);
    CHECK(colour_max_abs(colour_sub(colour_scale(stage_pixel(&s, SIZE / 2, SIZE / 2), 0.125), kd)) < 1e-5);
    stage_end(&s);
}

TEST(headlight_of_packets_is_that_of_single_rays) {
    static struct colour packets[SIZE * SIZE];
    struct stage s;
    for (int single = 0; single < 2; single++) {
        begin(&s);
        stage_move(&s, stage_cube(&s, s.root, stage_glass(&s, 0.3, 0.5, 1.5)), 0.531, -1.017, 0.473);
        s.settings.lens.shift_x = single ? 1e-13 : 0; /* a lens that has no packets */
        light_up(&s);
        for (uint32_t i = 0; i < SIZE * SIZE; i++) {
            struct colour colour = stage_pixel(&s, i % SIZE, i / SIZE);
            CHECK(!single || colour_max_abs(colour_sub(colour, packets[i])) < 1e-5);
            packets[i] = colour;
        }
        stage_end(&s);
    }
}
