/* Claims for every integrator: these tests loop over the list of integrators. */
#include "base/list.h"
#include "render/pixel_trace.h"
#include "tests/harness.h"
#include "tests/stage.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH = 70, HEIGHT = 50 };

/* A highlight, glass and edges: more than one tile, and pixels that are not alike. */
static void begin(struct stage *s, int threads, enum integrator_kind integrator) {
    stage_begin(s, threads);
    s->settings.integrator = integrator;
    s->camera = (struct camera){{0, 1, 6}, {0, -0.1, -1}, {0, 1, 0}, 40};
    stage_sphere(s, s->root, stage_glass(s, 0.5, 0.5, 1.5));
    struct node *ball = stage_sphere(s, s->root, stage_phong(s, colour_make(0.8, 0.3, 0.2), colour_all(0.4), 20));
    stage_move(s, ball, 1.6, 0, -1);
    stage_point_light(s, vec3_make(2, 5, 4), colour_all(0.9));
    s->ambient = colour_all(0.2);
}

static size_t film_bytes(const struct film *film) {
    return (size_t)film->width * film->height * film_record_size(film->record);
}

TEST(every_integrator_fills_the_film_with_the_same_bytes_for_any_number_of_threads) {
    for (int kind = 0; kind < LIST_COUNT(INTEGRATORS); kind++) {
        struct stage one, four;
        begin(&one, 1, (enum integrator_kind)kind);
        begin(&four, 4, (enum integrator_kind)kind);
        CHECK(stage_render(&one, WIDTH, HEIGHT) && stage_render(&four, WIDTH, HEIGHT));
        CHECK(memcmp(one.film.pixels, four.film.pixels, film_bytes(&one.film)) == 0);
        CHECK_EQ_INT(film_tiles_in(&one.film, FILM_TILE_DONE), film_tile_count(&one.film));
        CHECK(one.statistics.camera_rays >= WIDTH * HEIGHT && one.statistics.samples >= WIDTH * HEIGHT);
        double min = INFINITY, max = 0;
        for (uint32_t i = 0; i < WIDTH * HEIGHT; i++) {
            min = fmin(min, (double)one.film.pixels[i].rgb[0]);
            max = fmax(max, (double)one.film.pixels[i].rgb[0]);
        }
        CHECK(isfinite(min) && isfinite(max) && max > min + 0.1);
        stage_end(&one);
        stage_end(&four);
    }
}

TEST(every_integrator_records_what_tiles_can_carry) {
    static uint8_t bytes[FILM_PACKED_LIMIT];
    for (int kind = 0; kind < LIST_COUNT(INTEGRATORS); kind++) {
        struct stage s;
        begin(&s, 2, (enum integrator_kind)kind);
        CHECK(stage_render(&s, WIDTH, HEIGHT));
        CHECK(film_record_valid(s.film.record));
        CHECK(film_record_equal(s.film.record, stage_record((enum integrator_kind)kind)));
        void *before = memcpy(malloc(film_bytes(&s.film)), s.film.pixels, film_bytes(&s.film));
        for (uint32_t tile = 0; tile < film_tile_count(&s.film); tile++) {
            size_t size = film_tile_pack(&s.film, tile, bytes);
            atomic_store(&s.film.tiles[tile], FILM_TILE_WANTED);
            film_clear_unfinished(&s.film);
            CHECK(film_tile_unpack(&s.film, tile, bytes, size));
        }
        CHECK(memcmp(before, s.film.pixels, film_bytes(&s.film)) == 0);
        free(before);
        stage_end(&s);
    }
}

/* A picture whose first tiles come from a checkpoint is that of an uninterrupted run. */
TEST(every_integrator_goes_on_where_a_film_has_stopped) {
    for (int kind = 0; kind < LIST_COUNT(INTEGRATORS); kind++) {
        struct stage s;
        begin(&s, 2, (enum integrator_kind)kind);
        CHECK(stage_render(&s, WIDTH, HEIGHT));
        void *whole = memcpy(malloc(film_bytes(&s.film)), s.film.pixels, film_bytes(&s.film));
        atomic_store(&s.film.tiles[0], FILM_TILE_WANTED);
        atomic_store(&s.film.tiles[4], FILM_TILE_WANTED);
        film_clear_unfinished(&s.film);
        struct render_job job = stage_job(&s, WIDTH, HEIGHT);
        CHECK(render_run(&job, s.pool, &s.statistics, &s.error));
        CHECK(memcmp(whole, s.film.pixels, film_bytes(&s.film)) == 0);
        free(whole);
        stage_end(&s);
    }
}

/* Observers get the final colour of the pixel, and its samples with one ray each. */
static bool check_pixel_trace(void *context, struct pixel_trace *pixel_trace, struct error *error) {
    const struct stage *s = context;
    struct colour want = stage_pixel(s, pixel_trace->x, pixel_trace->y);
    int samples = 0;
    (void)error;
    CHECK(pixel_trace->rgb[0] == (float)want.r && pixel_trace->rgb[1] == (float)want.g &&
          pixel_trace->rgb[2] == (float)want.b);
    for (const struct pixel_trace_sample *sample = pixel_trace->sample; sample; sample = sample->next, samples++)
        CHECK(sample->first && sample->first->begun && sample->first->kind == RAY_CAMERA);
    CHECK(samples > 0);
    return true;
}

TEST(every_integrator_shows_observers_the_pixels_that_it_makes) {
    static const uint32_t pixels[][2] = {{20, 25}, {35, 25}, {50, 30}, {0, 0}, {69, 49}};
    for (int kind = 0; kind < LIST_COUNT(INTEGRATORS); kind++) {
        struct stage s;
        begin(&s, 1, (enum integrator_kind)kind);
        CHECK(stage_render(&s, WIDTH, HEIGHT));
        struct render_job job = stage_job(&s, WIDTH, HEIGHT);
        CHECK(render_pixels(&job, s.pool, (struct pixel_list){pixels, 5}, check_pixel_trace, &s, &s.error));
        stage_end(&s);
    }
}

static bool near(struct colour a, struct colour b) {
    return colour_max_abs(colour_sub(a, b)) <= 1e-9 * (1 + colour_max_abs(a));
}

/* The ray brings what its hit sends, reduced on the way, and the light on the way. The hit sends its emission, direct
 * light, and the weighted light of the next ray. Returns the number of rays. */
static int check_sums(const struct pixel_trace_ray *ray, int ends[PATH_IN_TOO_MANY_HOLES + 1]) {
    const struct observed_vertex *vertex = &ray->vertex;
    struct colour seen = colour_add(vertex->emission, vertex->direct), lights = vertex->photons;
    int count = 1;
    CHECK(ray->begun && ray->is_vertex);
    for (const struct pixel_trace_light *light = ray->lights; light; light = light->next)
        lights = colour_add(lights, light->colour);
    CHECK(near(lights, vertex->direct));
    for (const struct pixel_trace_ray *next = ray->first; next; next = next->next) {
        seen = colour_add(seen, colour_mul(next->weight, next->brings));
        count += check_sums(next, ends);
    }
    CHECK(near(ray->seen, seen));
    CHECK(near(ray->brings, colour_add(colour_mul(ray->left, ray->seen), ray->in_scattered)));
    CHECK((vertex->end == PATH_GOES_ON) == (ray->first != NULL));
    ends[vertex->end]++;
    return count;
}

struct path_sums {
    int rays, ends[PATH_IN_TOO_MANY_HOLES + 1];
};

static bool check_path(void *context, struct pixel_trace *pixel_trace, struct error *error) {
    struct path_sums *sums = context;
    (void)error;
    for (const struct pixel_trace_sample *sample = pixel_trace->sample; sample; sample = sample->next) {
        CHECK(sample->first && !sample->first->next && near(sample->first->brings, sample->colour));
        sums->rays += check_sums(sample->first, sums->ends);
    }
    return true;
}

TEST(the_terms_of_every_vertex_of_a_path_add_up_for_observers) {
    static const uint32_t pixels[][2] = {{20, 25}, {35, 25}, {50, 30}, {0, 0}, {69, 49}, {10, 10}};
    struct path_sums sums = {0};
    struct stage s;
    begin(&s, 1, INTEGRATOR_PATH);
    s.settings.path_samples = 64;
    s.settings.max_depth = 4;
    s.settings.roulette_depth = 1;
    struct material *lamp = stage_phong(&s, colour_make(0.8, 0.8, 0.3), colour_all(0), 1);
    lamp->phong.emission = colour_make(3, 2, 1);
    stage_move(&s, stage_sphere(&s, s.root, lamp), -2.5, 0.5, -2);
    struct material *amber = stage_glass(&s, 0.2, 0.8, 1.4);
    amber->phong.absorption = colour_make(0.1, 0.4, 1);
    stage_move(&s, stage_sphere(&s, s.root, amber), 0.8, -1.5, 1);
    CHECK(stage_render(&s, WIDTH, HEIGHT));
    struct render_job job = stage_job(&s, WIDTH, HEIGHT);
    CHECK(render_pixels(&job, s.pool, (struct pixel_list){pixels, 6}, check_path, &sums, &s.error));
    CHECK(sums.rays > 500);
    for (int i = 0; i <= PATH_LOSES_ROULETTE; i++)
        if (i != PATH_SEES_LIGHT && i != PATH_IS_ABSORBED && sums.ends[i] == 0)
            test_fail(__FILE__, __LINE__, "no vertex has the end %d", i);
    stage_end(&s);
}
