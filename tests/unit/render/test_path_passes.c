/* Samples that come in passes, until a time is over or a tile has little enough noise. */
#include "denoise/film_denoise.h"
#include "render/path_noise_internal.h"
#include "tests/harness.h"
#include "tests/stage.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH = 70, HEIGHT = 50 };

/* A ball in a room that is lit by a lamp, and a mirror: tiles of different noise. */
static void begin(struct stage *s, int threads) {
    stage_begin(s, threads);
    s->settings.integrator = INTEGRATOR_PATH;
    s->settings.max_depth = 5;
    s->camera = (struct camera){{0, 0, 3.5}, {0, 0, -1}, {0, 1, 0}, 50};
    struct material *white = stage_phong(s, colour_make(0.7, 0.6, 0.5), colour_all(0), 1);
    white->phong.two_sided = true;
    struct node *room = stage_sphere(s, s->root, white);
    stage_scale(s, room, 4, 4, 4);
    struct material *glowing = stage_phong(s, colour_all(0), colour_all(0), 1);
    glowing->phong.emission = colour_all(20);
    struct node *area_light = stage_sphere(s, s->root, glowing);
    stage_scale(s, area_light, 0.4, 0.4, 0.4);
    stage_move(s, area_light, 1, 2.2, 0.5);
    struct node *ball = stage_sphere(s, s->root, stage_phong(s, colour_all(0.3), colour_all(0), 1));
    stage_move(s, ball, -1, -1, -1);
}

static size_t film_bytes(const struct film *film) {
    return (size_t)film->width * film->height * film_record_size(film->record);
}

static void *film_copy(const struct stage *s) {
    return memcpy(malloc(film_bytes(&s->film)), s->film.pixels, film_bytes(&s->film));
}

static struct path_pixel pixel_at(const struct stage *s, uint32_t x, uint32_t y) {
    return path_film_load(&s->film, (size_t)y * s->film.width + x);
}

TEST(a_picture_of_passes_has_the_bytes_of_one_whose_tiles_get_all_samples_in_one_go) {
    struct stage s;
    begin(&s, 3);
    s.settings.path_samples = 23;
    CHECK(stage_render(&s, WIDTH, HEIGHT));
    CHECK_EQ_INT(s.statistics.passes_samples, 0);
    void *whole = film_copy(&s);
    s.settings.passes = true;
    CHECK(stage_render(&s, WIDTH, HEIGHT));
    CHECK_EQ_INT(s.statistics.passes_samples, 23);
    CHECK(memcmp(whole, s.film.pixels, film_bytes(&s.film)) == 0);
    CHECK_EQ_INT(film_tiles_in(&s.film, FILM_TILE_DONE), film_tile_count(&s.film));
    CHECK(stage_pixel(&s, 5, 5).r > 0 && stage_pixel(&s, WIDTH - 5, 5).g > 0);
    free(whole);
    stage_end(&s);
}

TEST(a_picture_that_goes_on_with_the_samples_of_a_film_has_the_bytes_of_one_go) {
    struct stage s;
    begin(&s, 3);
    s.settings.passes = true;
    s.settings.path_samples = 32;
    CHECK(stage_render(&s, WIDTH, HEIGHT));
    void *whole = film_copy(&s);
    s.settings.path_samples = 8;
    CHECK(stage_render(&s, WIDTH, HEIGHT));
    for (uint32_t samples = 16; samples <= 32; samples *= 2) {
        struct render_statistics statistics = {0};
        struct render_job job = stage_job(&s, WIDTH, HEIGHT);
        job.film = &s.film;
        job.kept_samples = samples / 2;
        job.settings.path_samples = (int)samples;
        for (uint32_t i = 0; i < film_tile_count(&s.film); i++)
            atomic_store(&s.film.tiles[i], FILM_TILE_WANTED);
        CHECK(render_run(&job, s.pool, &statistics, &s.error));
        CHECK_EQ_INT(statistics.samples, WIDTH * HEIGHT * samples / 2);
    }
    CHECK(memcmp(whole, s.film.pixels, film_bytes(&s.film)) == 0);
    free(whole);
    stage_end(&s);
}

TEST(a_picture_that_is_looked_at_is_shown_denoised_when_it_has_all_samples) {
    struct stage s;
    struct error error = {0};
    char warning[256];
    begin(&s, 2);
    s.settings.path_samples = 6;
    s.settings.denoise = DENOISER_GRAY;
    CHECK(stage_render(&s, WIDTH, HEIGHT));
    struct pool *pool = pool_create(1, warning);
    const struct denoise_source source = film_denoise_source(&s.film);
    static float denoised[WIDTH * HEIGHT][3];
    CHECK(denoise(&source, pool, denoised, &error));
    pool_destroy(pool);
    size_t count = (size_t)WIDTH * HEIGHT, floats = count * s.film.record.floats * sizeof *s.film.floats;
    CHECK(memcmp(denoised, s.film.pixels, sizeof denoised) != 0);
    void *sums = memcpy(malloc(floats), s.film.floats, floats);
    s.settings.passes = true;
    CHECK(stage_render(&s, WIDTH, HEIGHT));
    CHECK(memcmp(denoised, s.film.pixels, sizeof denoised) == 0);
    CHECK(memcmp(sums, s.film.floats, floats) == 0); /* of which files are made */
    CHECK_EQ_INT(film_tiles_in(&s.film, FILM_TILE_DONE), film_tile_count(&s.film));
    free(sums);
    stage_end(&s);
}

TEST(a_picture_of_a_time_limit_has_the_bytes_of_one_with_the_number_of_samples_that_it_reports) {
    struct stage s;
    begin(&s, 2);
    s.settings.time_limit = 0.2;
    CHECK(stage_render(&s, WIDTH, HEIGHT));
    uint64_t samples = s.statistics.passes_samples;
    CHECK(samples >= 1 && samples < PATH_SAMPLES_MAX);
    void *limited = film_copy(&s);
    s.settings.time_limit = 0;
    s.settings.path_samples = (int)samples;
    CHECK(stage_render(&s, WIDTH, HEIGHT));
    CHECK(memcmp(limited, s.film.pixels, film_bytes(&s.film)) == 0);
    free(limited);
    stage_end(&s);
}

TEST(a_time_limit_ends_with_the_samples_of_spp_where_these_are_few) {
    struct stage s;
    begin(&s, 1);
    s.settings.time_limit = 1000;
    s.settings.path_samples = 3;
    CHECK(stage_render(&s, WIDTH, HEIGHT));
    CHECK_EQ_INT(s.statistics.passes_samples, 3);
    stage_end(&s);
}

/* --- noise --- */

TEST(every_tile_gets_at_least_16_samples_and_as_many_as_its_noise_asks_for) {
    const double wanted = 0.06;
    struct stage s;
    begin(&s, 2);
    s.settings.noise = wanted;
    CHECK(stage_render(&s, WIDTH, HEIGHT));
    uint32_t fewest = UINT32_MAX, largest = 0;
    for (uint32_t tile = 0; tile < film_tile_count(&s.film); tile++) {
        struct film_rectangle r = film_tile_rectangle(&s.film, tile);
        uint32_t samples = pixel_at(&s, r.x0, r.y0).samples;
        for (uint32_t y = r.y0; y < r.y1; y++) {
            for (uint32_t x = r.x0; x < r.x1; x++)
                CHECK_EQ_INT(pixel_at(&s, x, y).samples, samples);
        }
        CHECK(path_tile_noise(&s.film, r) <= wanted);
        fewest = samples < fewest ? samples : fewest;
        largest = samples > largest ? samples : largest;
    }
    CHECK(fewest >= 16 && largest > fewest && largest < PATH_SAMPLES_NOISE);
    stage_end(&s);
}

TEST(a_picture_of_little_noise_has_the_same_bytes_for_any_threads_order_and_passes) {
    struct stage s;
    begin(&s, 1);
    s.settings.noise = 0.1;
    CHECK(stage_render(&s, WIDTH, HEIGHT));
    void *first = film_copy(&s);
    stage_end(&s);
    begin(&s, 3);
    s.settings.noise = 0.1;
    s.settings.tile_order = TILE_ORDER_CENTRE;
    for (int passes = 0; passes < 2; passes++) {
        s.settings.passes = passes != 0;
        CHECK(stage_render(&s, WIDTH, HEIGHT));
        CHECK(memcmp(first, s.film.pixels, film_bytes(&s.film)) == 0);
    }
    free(first);
    stage_end(&s);
}

/* Every tile needs more than the 24 samples that it has at first. */
TEST(tiles_that_go_on_from_a_check_end_at_the_same_sample_with_the_bytes_of_one_go) {
    struct stage s;
    struct render_statistics statistics = {0};
    begin(&s, 2);
    s.settings.noise = 0.06;
    CHECK(stage_render(&s, WIDTH, HEIGHT));
    for (uint32_t tile = 0; tile < film_tile_count(&s.film); tile++) {
        struct film_rectangle r = film_tile_rectangle(&s.film, tile);
        CHECK(pixel_at(&s, r.x0, r.y0).samples > 24);
    }
    void *whole = film_copy(&s);
    uint64_t all = s.statistics.camera_rays;
    s.settings.path_samples = 24;
    CHECK(stage_render(&s, WIDTH, HEIGHT));
    for (uint32_t tile = 0; tile < film_tile_count(&s.film); tile++)
        s.film.tiles[tile] = FILM_TILE_BEGUN;
    s.settings.path_samples = 0;
    struct render_job job = stage_job(&s, WIDTH, HEIGHT);
    CHECK(render_run(&job, s.pool, &statistics, &s.error));
    CHECK_EQ_INT(statistics.camera_rays, all - 24 * WIDTH * HEIGHT);
    CHECK(memcmp(whole, s.film.pixels, film_bytes(&s.film)) == 0);
    free(whole);
    stage_end(&s);
}

TEST(spp_is_the_limit_of_samples_where_the_noise_asks_for_more) {
    struct stage s;
    begin(&s, 2);
    s.settings.noise = 1e-6;
    s.settings.path_samples = 20;
    CHECK(stage_render(&s, WIDTH, HEIGHT));
    for (uint32_t y = 0; y < HEIGHT; y++) {
        for (uint32_t x = 0; x < WIDTH; x++)
            CHECK_EQ_INT(pixel_at(&s, x, y).samples, 20);
    }
    stage_end(&s);
}

TEST(statistics_state_what_ended_a_picture_with_noise) {
    struct stage s;
    begin(&s, 2);
    s.settings.noise = 1;
    CHECK(stage_render(&s, WIDTH, HEIGHT));
    CHECK(!s.statistics.noisy && !s.statistics.out_of_time);
    s.settings.time_limit = 1000;
    CHECK(stage_render(&s, WIDTH, HEIGHT));
    CHECK(!s.statistics.noisy && !s.statistics.out_of_time);
    s.settings.noise = 1e-9;
    s.settings.path_samples = 3;
    CHECK(stage_render(&s, WIDTH, HEIGHT));
    CHECK(s.statistics.noisy && !s.statistics.out_of_time);
    s.settings.time_limit = 0;
    CHECK(stage_render(&s, WIDTH, HEIGHT));
    CHECK(s.statistics.noisy && !s.statistics.out_of_time);
    s.settings.path_samples = 0;
    s.settings.time_limit = 0.1;
    CHECK(stage_render(&s, WIDTH, HEIGHT));
    CHECK(s.statistics.noisy && s.statistics.out_of_time);
    stage_end(&s);
}

/* If the noise is c / sqrt(N), a tile ends at the first check with c <= wanted sqrt(N). */
TEST(the_samples_of_a_tile_are_expected_from_the_square_root_of_their_number) {
    static const double factors[] = {0.3, 1, 2.5, 7};
    for (int i = 0; i < 4; i++) {
        const double wanted = 0.1, factor = factors[i];
        uint32_t ends = 16;
        while (factor / sqrt(ends) > wanted)
            ends = path_next_check(ends);
        for (uint32_t n = 16; n < ends; n = path_next_check(n))
            CHECK_EQ_INT(path_samples_expected(n, factor / sqrt(n), wanted, 65536), ends);
        CHECK_EQ_INT(path_samples_expected(ends, factor / sqrt(ends), wanted, 65536), ends);
    }
    CHECK_EQ_INT(path_samples_expected(16, 0.2, 0.1, 65536), 64);
    CHECK_EQ_INT(path_samples_expected(4, 0.4, 0.1, 65536), 64);
    CHECK_EQ_INT(path_samples_expected(4, 0.1, 0.1, 65536), 16);
    CHECK_EQ_INT(path_samples_expected(1, 0, 0.1, 65536), 0);
    CHECK_EQ_INT(path_samples_expected(16, 0.2, 0.1, 40), 40);
    CHECK_EQ_INT(path_samples_expected(24, HUGE_VAL, 0.1, 65536), 65536);
    CHECK_EQ_INT(path_samples_expected(32, 0, 0.1, 65536), 32);
}

/* Against a picture of many samples, as --noise defines it. */
static double tile_error(const struct film *film, struct film_rectangle r, float reference[][3]) {
    double sum = 0;
    for (uint32_t y = r.y0; y < r.y1; y++) {
        for (uint32_t x = r.x0; x < r.x1; x++) {
            size_t at = (size_t)y * film->width + x;
            for (int c = 0; c < 3; c++) {
                double truth = (double)reference[at][c], got = (double)film->pixels[at].rgb[c];
                sum += (got - truth) * (got - truth) / (truth * truth + 0.01) / 3;
            }
        }
    }
    return sqrt(sum / ((r.x1 - r.x0) * (r.y1 - r.y0)));
}

/* The picture of many samples, which has little error beside the smallest noise, serves all of them. */
struct noise_check {
    double wanted[5];
    int count, reference_samples, seeds;
};

/* s: begun by one of the scenes. */
static void check_noise(struct stage *s, const struct noise_check *check) {
    static float reference[WIDTH * HEIGHT][3];
    s->settings.seed = 99;
    s->settings.path_samples = check->reference_samples;
    CHECK(stage_render(s, WIDTH, HEIGHT));
    memcpy(reference, s->film.pixels, sizeof reference);
    s->settings.path_samples = 0;
    for (int i = 0; i < check->count * check->seeds; i++) {
        double wanted = s->settings.noise = check->wanted[i / check->seeds];
        s->settings.seed = (uint64_t)(1 + i % check->seeds);
        CHECK(stage_render(s, WIDTH, HEIGHT));
        for (uint32_t tile = 0; tile < film_tile_count(&s->film); tile++) {
            double error = tile_error(&s->film, film_tile_rectangle(&s->film, tile), reference);
            if (error > 1.25 * wanted)
                test_fail(__FILE__, __LINE__, "tile %u, noise %g, seed %d: error %g", tile, wanted,
                          1 + i % check->seeds, error);
        }
    }
    stage_end(s);
}

/* A small lamp and a ball on a floor. Only scattered rays find the light that the ball sends to the floor: one sample
 * in thousands, and much brighter than the others. */
static void begin_rare(struct stage *s, bool glass) {
    stage_begin(s, 2);
    s->settings.integrator = INTEGRATOR_PATH;
    s->settings.max_depth = 6;
    s->camera = (struct camera){{0, 3, 6}, {0, -0.45, -1}, {0, 1, 0}, 50};
    struct material *white = stage_phong(s, colour_all(0.7), colour_all(0), 1);
    struct node *floor = stage_cube(s, s->root, white);
    stage_scale(s, floor, 8, 0.2, 8);
    stage_move(s, floor, -4, -0.2, -4);
    struct material *glowing = stage_phong(s, colour_all(0), colour_all(0), 1);
    glowing->phong.emission = colour_all(120);
    struct node *lamp = stage_sphere(s, s->root, glowing);
    stage_scale(s, lamp, 0.1, 0.1, 0.1);
    stage_move(s, lamp, 1.5, 3, 0);
    struct material *mirror = stage_phong(s, colour_all(0), colour_all(0.9), 1);
    mirror->phong.reflect = 1;
    struct node *ball = stage_sphere(s, s->root, glass ? stage_glass(s, 0.1, 0.9, 1.5) : mirror);
    stage_scale(s, ball, 0.8, 0.8, 0.8);
    stage_move(s, ball, -0.8, glass ? 1 : 0.8, 0);
}

TEST(the_error_of_a_tile_is_at_most_one_and_a_quarter_of_the_noise_requested) {
    struct stage s;
    begin(&s, 2);
    check_noise(&s, &(struct noise_check){{0.12}, 1, 160, 1});
}

TEST_LONG(the_error_of_tiles_is_the_one_requested_at_every_noise_and_seed) {
    struct stage s;
    begin(&s, 2);
    check_noise(&s, &(struct noise_check){{0.08, 0.06, 0.04, 0.03, 0.02}, 5, 8192, 3});
}

/* With the own mean of each pixel in the denominator of its noise, the error of a tile is up to 9 times the noise. */
TEST(the_error_of_a_tile_is_the_one_requested_where_rare_bright_paths_make_it) {
    struct stage s;
    begin_rare(&s, false);
    check_noise(&s, &(struct noise_check){{0.2}, 1, 512, 3});
}

TEST_LONG(the_error_of_tiles_with_rare_bright_paths_is_the_one_requested_behind_mirrors_and_glass) {
    struct stage s;
    for (int glass = 0; glass < 2; glass++) {
        begin_rare(&s, glass);
        check_noise(&s, &(struct noise_check){{0.2, 0.1}, 2, 8192, 6});
    }
}
