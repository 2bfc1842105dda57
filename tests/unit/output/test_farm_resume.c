/* Farms with --noise that are interrupted and continued from their checkpoint: two ranks in one process, which render
 * in threads, with messages in queues. The test steps both ranks, so that nothing is handed out while it does not. */
#include "base/pool.h"
#include "film/path_film.h"
#include "output/farm.h"
#include "render/render.h"
#include "tests/harness.h"
#include "tests/stage.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { RANKS = 2, WIDTH = 96, HEIGHT = 96, QUEUE = 1024, SLOTS = 2 };

struct letter {
    int kind;
    size_t size;
    uint8_t *data;
};

struct member {
    int number;
    struct letter letters[QUEUE];
    uint32_t begun, ended;
    struct farm_transport transport;
    struct control control;
    struct farm *farm;
    struct film film;
    struct pool *pool;
    struct render_job job;
    struct render_statistics statistics;
    struct error error;
    pthread_t thread;
    bool ok;
};
static struct member ranks[RANKS];

/* --- the transport --- */

static void send(void *context, int to, int kind, const void *data, size_t size) {
    struct member *receiver = &ranks[to];
    struct letter *letter = &receiver->letters[receiver->ended++ % QUEUE];
    (void)context;
    CHECK(receiver->ended - receiver->begun < QUEUE);
    *letter = (struct letter){kind, size, malloc(size)};
    memcpy(letter->data, data, size);
}

/* The other rank waits for answers of the first one, which gets a turn then. */
static bool receive(void *context, int *from, int *kind, void *data, size_t *size) {
    struct member *rank = context;
    if (rank->begun == rank->ended && rank->number > 0)
        farm_step(ranks[0].farm);
    if (rank->begun == rank->ended)
        return false;
    struct letter *letter = &rank->letters[rank->begun++ % QUEUE];
    *from = 1 - rank->number;
    *kind = letter->kind;
    *size = letter->size;
    memcpy(data, letter->data, letter->size);
    free(letter->data);
    return true;
}

static double read_clock(void *context) {
    struct timespec time;
    (void)context;
    (void)clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

/* --- scenes and films --- */

/* A ball in a room that is lit by a lamp: tiles of different noise. */
static void begin(struct stage *s) {
    stage_begin(s, 2);
    s->settings.integrator = INTEGRATOR_PATH;
    s->settings.max_depth = 5;
    s->settings.noise = 0.16;
    s->camera = (struct camera){{0, 0, 3.5}, {0, 0, -1}, {0, 1, 0}, 50};
    struct material *white = stage_phong(s, colour_make(0.7, 0.6, 0.5), colour_all(0), 1);
    white->phong.two_sided = true;
    stage_scale(s, stage_sphere(s, s->root, white), 4, 4, 4);
    struct material *glowing = stage_phong(s, colour_all(0), colour_all(0), 1);
    glowing->phong.emission = colour_all(20);
    struct node *lamp = stage_sphere(s, s->root, glowing);
    stage_scale(s, lamp, 0.4, 0.4, 0.4);
    stage_move(s, lamp, 1, 2.2, 0.5);
    stage_move(s, stage_sphere(s, s->root, stage_phong(s, colour_all(0.3), colour_all(0), 1)), -1, -1, -1);
}

static struct film new_film(struct film_record record) {
    struct film film = {.full_width = WIDTH, .full_height = HEIGHT};
    struct error error;
    size_t bytes;
    CHECK(film_size(WIDTH, HEIGHT, record, &bytes, &error));
    film_layout(&film, calloc(1, bytes), WIDTH, HEIGHT, record);
    return film;
}

static size_t film_bytes(const struct film *film) {
    return (size_t)WIDTH * HEIGHT * film_record_size(film->record);
}

/* Of the tiles that a checkpoint would keep. */
static uint64_t samples_in(const struct film *film) {
    uint64_t samples = 0;
    for (uint32_t tile = 0; tile < film_tile_count(film); tile++) {
        struct film_rectangle r = film_tile_rectangle(film, tile);
        uint8_t state = atomic_load(&film->tiles[tile]);
        if (state == FILM_TILE_DONE || film_tile_is_begun(state))
            samples +=
                (uint64_t)(r.x1 - r.x0) * (r.y1 - r.y0) * path_film_load(film, (size_t)r.y0 * WIDTH + r.x0).samples;
    }
    return samples;
}

static void set_samples(struct film *film, struct film_rectangle r, uint32_t samples) {
    for (uint32_t y = r.y0; y < r.y1; y++) {
        for (uint32_t x = r.x0; x < r.x1; x++) {
            struct path_pixel pixel = path_film_load(film, (size_t)y * WIDTH + x);
            pixel.samples = samples;
            path_film_store(film, (size_t)y * WIDTH + x, &pixel);
        }
    }
}

/* --- farms --- */

static void *render(void *context) {
    struct member *rank = context;
    rank->ok = render_run(&rank->job, rank->pool, &rank->statistics, &rank->error);
    return NULL;
}

static struct tile_picture picture_of(struct film_record record) {
    return (struct tile_picture){.number = 1,
                                 .full_width = WIDTH,
                                 .full_height = HEIGHT,
                                 .width = WIDTH,
                                 .height = HEIGHT,
                                 .record = record,
                                 .shard = 1,
                                 .shards = 1,
                                 .name = "a.png"};
}

/* The world of the stage is built; `film`: of the first rank, which takes it. */
static void begin_farm(struct stage *s, struct film film) {
    struct tile_picture picture = picture_of(film.record);
    char warning[256];
    for (int number = 0; number < RANKS; number++) {
        struct member *rank = &ranks[number];
        *rank = (struct member){.number = number, .film = number ? new_film(film.record) : film};
        rank->transport = (struct farm_transport){
            .context = rank, .rank = number, .size = RANKS, .send = send, .receive = receive, .clock = read_clock};
        rank->farm = farm_create(&rank->transport, SLOTS, 0, &rank->control);
        rank->pool = pool_create(1, warning);
    }
    for (int number = 0; number < RANKS; number++) {
        struct member *rank = &ranks[number];
        bool already = false;
        CHECK(farm_begin(rank->farm, &picture, &rank->film, &already, &rank->error) && !already);
        rank->job = stage_job(s, WIDTH, HEIGHT);
        rank->job.film = &rank->film;
        rank->job.handout = &rank->control.handout;
        rank->job.drain = &rank->control.drain;
        CHECK(pthread_create(&rank->thread, NULL, render, rank) == 0);
    }
}

static void step_farm(void) {
    const struct timespec pause = {0, 200000};
    (void)nanosleep(&pause, NULL);
    for (int number = RANKS - 1; number >= 0; number--)
        farm_step(ranks[number].farm);
}

/* Tiles in progress end at their next check. Gives the film of the first rank; the statistics of both stay. */
static struct film end_farm(bool interrupted) {
    for (int number = 0; number < RANKS; number++)
        ranks[number].control.drain = interrupted;
    for (int number = 0; number < RANKS; number++) {
        /* The others read that all tiles are there. */
        farm_step(ranks[number].farm);
        CHECK(pthread_join(ranks[number].thread, NULL) == 0 && (interrupted || ranks[number].ok));
    }
    for (int number = RANKS - 1; number >= 0; number--) {
        farm_step(ranks[number].farm);
        farm_end(ranks[number].farm, interrupted);
    }
    for (int number = 0; number < RANKS; number++) {
        struct member *rank = &ranks[number];
        for (; rank->begun < rank->ended; rank->begun++)
            free(rank->letters[rank->begun % QUEUE].data);
        farm_destroy(rank->farm);
        pool_destroy(rank->pool);
    }
    free(ranks[1].film.pixels);
    return ranks[0].film;
}

static struct film run_farm(struct stage *s, struct film film) {
    begin_farm(s, film);
    while (film_tiles_in(&ranks[0].film, FILM_TILE_DONE) < film_tile_count(&film))
        step_farm();
    return end_farm(false);
}

static uint64_t camera_rays(void) {
    return ranks[0].statistics.camera_rays + ranks[1].statistics.camera_rays;
}

/* Runs a farm with this film until its tiles have so many samples. It may end by itself before it is interrupted: then
 * it begins again. */
static struct film interrupt_farm(struct stage *s, struct film from, uint64_t samples) {
    for (;;) {
        struct film film = new_film(from.record);
        struct error error;
        size_t bytes;
        CHECK(film_size(WIDTH, HEIGHT, from.record, &bytes, &error));
        memcpy(film.pixels, from.pixels, bytes); /* the tiles, too: all is in one block */
        begin_farm(s, film);
        while (samples_in(&film) < samples)
            step_farm();
        film = end_farm(true);
        if (film_tiles_in(&film, FILM_TILE_DONE) < film_tile_count(&film))
            return film;
        free(film.pixels);
    }
}

/* The same; and puts its checkpoint into another film. */
static struct film interrupted_film(struct stage *s, struct film from, uint64_t samples) {
    struct tile_picture picture = picture_of(from.record);
    struct film film = interrupt_farm(s, from, samples), restored = new_film(from.record);
    struct tile_file file;
    struct error error;
    uint32_t done, twice;
    const char *path = test_path("checkpoint");
    CHECK(tile_file_write(FILE_AT(path), NULL, 0, &picture, &film, &error) && tile_file_read(path, &file, &error));
    tile_file_restore(&file, &restored, &done, &twice);
    tile_file_close(&file);
    CHECK_EQ_INT(samples_in(&restored), samples_in(&film));
    free(film.pixels);
    free(from.pixels);
    return restored;
}

TEST(a_farm_with_noise_that_goes_on_from_its_checkpoint_takes_no_sample_of_it_again_and_has_the_bytes_of_one_run) {
    struct stage s;
    begin(&s);
    CHECK(stage_render(&s, WIDTH, HEIGHT));
    uint64_t all = samples_in(&s.film);
    CHECK_EQ_INT(s.statistics.camera_rays, all);
    struct film film = interrupted_film(&s, new_film(s.film.record), all / 4);
    uint64_t kept = samples_in(&film);
    CHECK(kept >= all / 4 && kept < all);
    film = run_farm(&s, film);
    CHECK_EQ_INT(camera_rays(), all - kept);
    CHECK(memcmp(s.film.pixels, film.pixels, film_bytes(&film)) == 0);
    free(film.pixels);
    stage_end(&s);
}

TEST(a_farm_interrupted_again_and_again_has_the_bytes_of_one_run) {
    struct stage s;
    begin(&s);
    CHECK(stage_render(&s, WIDTH, HEIGHT));
    struct film film = new_film(s.film.record);
    uint64_t all = samples_in(&s.film);
    for (int turn = 0; turn < 3; turn++)
        film = interrupted_film(&s, film, samples_in(&film) + all / 10);
    film = run_farm(&s, film);
    CHECK(memcmp(s.film.pixels, film.pixels, film_bytes(&film)) == 0);
    free(film.pixels);
    stage_end(&s);
}

TEST(tiles_of_a_checkpoint_whose_samples_are_not_those_of_a_check_are_made_again_by_a_farm) {
    struct stage s;
    begin(&s);
    CHECK(stage_render(&s, WIDTH, HEIGHT));
    struct film film = new_film(s.film.record);
    struct film_rectangle r = film_tile_rectangle(&film, 0);
    set_samples(&film, film_tile_rectangle(&film, 1), 5);
    set_samples(&film, r, 16);
    set_samples(&film, (struct film_rectangle){r.x1 - 1, r.y1 - 1, r.x1, r.y1}, 24);
    film.tiles[0] = film.tiles[1] = FILM_TILE_BEGUN;
    film = run_farm(&s, film);
    CHECK(memcmp(s.film.pixels, film.pixels, film_bytes(&film)) == 0);
    free(film.pixels);
    stage_end(&s);
}

TEST(tiles_of_a_checkpoint_with_more_samples_than_the_limit_are_made_again_by_a_farm) {
    struct stage s;
    begin(&s);
    s.settings.noise = 1e-6;
    s.settings.path_samples = 20;
    CHECK(stage_render(&s, WIDTH, HEIGHT));
    struct film film = new_film(s.film.record);
    for (uint32_t tile = 0; tile < film_tile_count(&film); tile++) {
        set_samples(&film, film_tile_rectangle(&film, tile), tile % 2 ? 32 : 24);
        film.tiles[tile] = FILM_TILE_BEGUN;
    }
    film = run_farm(&s, film);
    CHECK(memcmp(s.film.pixels, film.pixels, film_bytes(&film)) == 0);
    free(film.pixels);
    stage_end(&s);
}
