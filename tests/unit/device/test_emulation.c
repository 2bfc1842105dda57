/* Paths in waves over the bundle of a scene: the bytes of the film are those of threads. Scenes of the language are
 * rendered by tests/unit/project/test_device.c. */
#include "device/emulation.h"
#include "film/film.h"
#include "tests/harness.h"
#include "tests/stage.h"

#include "base/mem.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH = 40, HEIGHT = 30 };

/* Mirrors, glass, lamps, a sky, a solid with a hole. */
static void begin_scene_of(struct stage *s, int threads) {
    stage_begin(s, threads);
    s->settings.integrator = INTEGRATOR_PATH;
    s->settings.path_samples = 6;
    s->settings.denoise = DENOISER_GRAY;
    s->settings.max_depth = 8;
    s->camera = (struct camera){{0, 1, 6}, {0, -0.1, -1}, {0, 1, 0}, 50};
    s->sky.colour = colour_make(0.2, 0.3, 0.4);
    stage_point_light(s, vec3_make(3, 5, 4), colour_make(0.9, 0.8, 0.7));
    struct material *glowing = stage_phong(s, colour_all(0), colour_all(0), 1);
    glowing->phong.emission = colour_all(6);
    struct node *lamp = stage_sphere(s, s->root, glowing);
    stage_scale(s, lamp, 0.3, 0.3, 0.3);
    stage_move(s, lamp, -2, 3, 1);
    struct node *floor = stage_cube(s, s->root, stage_phong(s, colour_make(0.7, 0.5, 0.3), colour_all(0.2), 30));
    stage_scale(s, floor, 20, 1, 20);
    stage_move(s, floor, -10, -2, -10);
    stage_move(s, stage_sphere(s, s->root, stage_glass(s, 1, 1, 1.5)), 1.2, 0, 0);
    stage_move(s, stage_sphere(s, s->root, stage_glass(s, 1, 0, 1)), -1.2, 0, 0);
    stage_lenses(s, stage_phong(s, colour_make(0.8, 0.2, 0.1), colour_all(0), 1), 6);
}

static void begin_scene(struct stage *s) {
    begin_scene_of(s, 2);
}

/* The colours and the records of the film. */
struct picture {
    struct film_pixel pixels[WIDTH * HEIGHT];
    float *floats;
    size_t size;
};
static void keep(const struct film *film, struct picture *out) {
    const size_t count = (size_t)WIDTH * HEIGHT;
    memcpy(out->pixels, film->pixels, sizeof out->pixels);
    out->size = count * film->record.floats * sizeof *out->floats;
    out->floats = realloc(out->floats, out->size);
    memcpy(out->floats, film->floats, out->size);
}
static bool same(const struct picture *a, const struct picture *b) {
    return a->size == b->size && memcmp(a->pixels, b->pixels, sizeof a->pixels) == 0 &&
           memcmp(a->floats, b->floats, a->size) == 0;
}

/* A device that loses some samples, as one whose memory is too small for a query. */
struct loser {
    struct path_device inner;
    _Atomic uint32_t lost;
};
static bool begin_losing(void *context, struct bundle *scene, bool *is_used, struct error *error) {
    const struct loser *loser = context;
    return loser->inner.begin(loser->inner.context, scene, is_used, error);
}
static bool make_losing(void *context, const struct path_orders *orders, struct path_counts *counts) {
    struct loser *loser = context;
    uint64_t number = 0;
    if (!loser->inner.make(loser->inner.context, orders, counts))
        return false;
    for (uint32_t k = 0; k < orders->count; k++)
        for (uint64_t i = 0; i < path_order_pixels(&orders->all[k]); i++, number++)
            if (i % 3 == 0) {
                const struct path_pixel lost = {.samples = orders->all[k].begin, .sums = {{7, 7, 7}}};
                memcpy(path_orders_pixel(orders, number), &lost, orders->pixel_size);
                loser->lost++;
            }
    return true;
}

static void render_with(struct stage *s, const struct path_device *device, struct picture *out) {
    struct render_job job = stage_job(s, WIDTH, HEIGHT);
    job.device = device;
    memset(job.film->pixels, 0, sizeof out->pixels);
    for (uint32_t i = 0; i < film_tile_count(job.film); i++)
        atomic_store(&job.film->tiles[i], FILM_TILE_WANTED);
    CHECK(render_run(&job, s->pool, &s->statistics, &s->error));
    keep(job.film, out);
}

static void check_scene(struct stage *s) {
    struct picture threads = {0}, device = {0};
    CHECK(stage_render(s, WIDTH, HEIGHT));
    keep(&s->film, &threads);
    static const uint32_t waves[] = {1, 7, 1000, 0};
    for (int i = 0; i < 4; i++) {
        struct emulation *emulation = emulation_create(s->pool, waves[i], 0);
        struct loser loser = {emulation_device(emulation), 0};
        loser.inner.waiting = i == 1 ? 3 : 0; /* threads make tiles beside them */
        const struct path_device losing = {.begin = begin_losing, .make = make_losing, .context = &loser};
        render_with(s, i < 3 ? &loser.inner : &losing, &device);
        CHECK(same(&threads, &device));
        CHECK((loser.lost > 0) == (i == 3));
        emulation_destroy(emulation);
    }
    free(threads.floats);
    free(device.floats);
}

TEST(waves_over_the_bundle_of_a_scene_give_the_bytes_of_threads) {
    struct stage s;
    begin_scene(&s);
    check_scene(&s);
    stage_end(&s);
}

TEST(waves_until_a_tile_is_quiet_give_the_bytes_of_threads) {
    struct stage s;
    begin_scene(&s);
    s.settings.path_samples = 64;
    s.settings.noise = 0.2;
    check_scene(&s);
    stage_end(&s);
}

TEST(waves_through_a_lens_give_the_bytes_of_threads) {
    struct stage s;
    begin_scene(&s);
    s.settings.lens.aperture = 0.4;
    s.settings.filter = FILTER_MITCHELL;
    check_scene(&s);
    stage_end(&s);
}

TEST(waves_below_lines_give_the_bytes_of_threads) {
    struct stage s;
    begin_scene_of(&s, 1); /* a thread orders both tiles together */
    s.settings.line_width = 2;
    check_scene(&s);
    stage_end(&s);
}

TEST(waves_from_a_camera_that_moves_give_the_bytes_of_threads) {
    struct stage s;
    begin_scene(&s);
    s.settings.shutter = (struct shutter){0, 0.5};
    s.settings.motion = (struct camera_motion){true, {0.5, 1.5, 5}, {0.2, -0.2, -1}, {0.1, 1, 0}};
    check_scene(&s);
    stage_end(&s);
}

/* A solid of many operands, in the memory of a single crossing. */
struct counter {
    struct path_device inner;
    _Atomic uint32_t whole, left;
};
static bool begin_counting(void *context, struct bundle *scene, bool *is_used, struct error *error) {
    const struct counter *counter = context;
    return counter->inner.begin(counter->inner.context, scene, is_used, error);
}
static bool make_counting(void *context, const struct path_orders *orders, struct path_counts *counts) {
    struct counter *counter = context;
    uint64_t number = 0;
    bool goes_on = counter->inner.make(counter->inner.context, orders, counts);
    for (uint32_t k = 0; k < orders->count; k++)
        for (uint64_t i = 0; i < path_order_pixels(&orders->all[k]); i++, number++)
            *(path_orders_pixel(orders, number)->samples == orders->all[k].end ? &counter->whole : &counter->left) += 1;
    return goes_on;
}

TEST(pixels_whose_queries_outgrow_the_memory_of_a_device_are_made_by_threads) {
    struct stage s;
    struct picture threads = {0}, device = {0};
    begin_scene(&s);
    const struct material *red = stage_phong(&s, colour_make(0.8, 0.2, 0.1), colour_all(0), 1);
    struct node *group = scene_node(&s.scene, NODE_GROUP, "operands", &s.error), *operands[13];
    for (int i = 0; i < 13; i++) {
        const double size = i == 0 ? 1.6 : 0.1, away = i == 0 ? 4.5 : 3 + 0.25 * i;
        operands[i] = stage_sphere(&s, group, red);
        stage_scale(&s, operands[i], size, size, size);
        stage_move(&s, operands[i], 0, 1 - 0.1 * away, 6 - away);
    }
    struct node *cheese = scene_combine(&s.scene, "cheese", NODE_DIFFERENCE, operands, 13, &s.error);
    CHECK(cheese && node_add_child(&s.scene, s.root, cheese, &s.error));
    CHECK(stage_render(&s, WIDTH, HEIGHT));
    keep(&s.film, &threads);
    struct emulation *emulation = emulation_create(s.pool, 0, 1);
    struct counter counter = {.inner = emulation_device(emulation)};
    const struct path_device counting = {.begin = begin_counting, .make = make_counting, .context = &counter};
    render_with(&s, &counting, &device);
    CHECK(same(&threads, &device));
    CHECK(counter.whole > 0 && counter.left > 0);
    emulation_destroy(emulation);
    free(threads.floats);
    free(device.floats);
    stage_end(&s);
}

/* --- no pointer is forgotten --- */

struct words {
    uint64_t from[512], to[512];
    int count;
    uint32_t found;
    bool begun;
};

/* Where this process has memory. */
static void read_maps(struct words *words) {
    char line[512];
    FILE *maps = fopen("/proc/self/maps", "r");
    while (maps && words->count < 512 && fgets(line, sizeof line, maps)) {
        char *end;
        words->from[words->count] = strtoull(line, &end, 16);
        words->to[words->count] = strtoull(end + 1, NULL, 16);
        words->count += words->from[words->count] > 1 << 16;
    }
    if (maps)
        (void)fclose(maps);
}

static bool find_addresses(void *context, struct bundle *scene, bool *is_used, struct error *error) {
    *is_used = false;
    struct words *words = context;
    const size_t size = bundle_size(scene);
    uint64_t *bytes = mem_alloc_aligned(64, size);
    bundle_write(scene, bytes);
    read_maps(words);
    for (size_t i = 0; i < size / 8; i++)
        for (int k = 0; k < words->count; k++)
            words->found += bytes[i] >= words->from[k] && bytes[i] < words->to[k];
    mem_free(bytes);
    words->begun = true;
    return error_set(error, ERROR_CANCELLED, "seen");
}

TEST(no_word_of_the_bundle_of_a_scene_is_an_address_of_the_process) {
    struct stage s;
    struct words words = {.count = 0};
#if defined __SANITIZE_ADDRESS__ || defined __SANITIZE_THREAD__
    test_skip("the memory of the sanitizers has all addresses");
#elif defined __clang__
    test_skip("clang leaves old bytes between the members of structures");
#endif
    begin_scene(&s);
    CHECK(stage_render(&s, WIDTH, HEIGHT));
    struct render_job job = stage_job(&s, WIDTH, HEIGHT);
    const struct path_device device = {.begin = find_addresses, .context = &words};
    job.device = &device;
    CHECK(!render_run(&job, s.pool, &s.statistics, &s.error));
    CHECK(words.begun && words.count > 5);
    CHECK_EQ_INT(words.found, 0);
    stage_end(&s);
}
