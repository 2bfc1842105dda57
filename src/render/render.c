/* Tiles, handed out to the workers; within one works the integrator. A tile is self-contained and final when it is
 * done. No barrier, nothing shared but the film, of which every tile writes its own pixels. */
#include "render/integrator.h"

#include "base/mem.h"
#include "render/order.h"
#include "render/pixel_trace.h"
#include "render/shard.h"

#include <math.h>
#include <stdatomic.h>
#include <string.h>
#include <time.h>

static double seconds_now(void) {
    struct timespec now;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* What a tile costs, from few rays: surfaces met and rays sent on, which no way of searching and no instruction set
 * changes. */
enum { COST_SAMPLES = 4 };

static void cost_item(void *context, uint32_t item, int index) {
    struct run *run = context;
    struct worker *worker = &run->workers[index];
    struct film_rectangle r = film_tile_rectangle(run->job->film, item);
    struct integrator_state *state = &worker->state;
    uint64_t before = state->hits + state->reflected_rays + state->refracted_rays;
    /* Many shards look at fewer rays: each of them looks at all tiles. */
    uint32_t count = run->job->shards <= 16 ? COST_SAMPLES : 1;
    for (uint32_t i = 0; i < count && !run_stopped(run, worker); i++) {
        uint32_t x = r.x0 + (r.x1 - r.x0) * (2 * i + 1) / (2 * count);
        uint32_t y = r.y0 + (r.y1 - r.y0) * ((2 * i + 1) * 3 % (2 * count)) / (2 * count);
        struct pixel_sample place = run_first_place(run, x, y);
        (void)run_sample(run, worker, &place);
    }
    run->cost[item] = 1 + state->hits + state->reflected_rays + state->refracted_rays - before;
}

/* Marks what other shards make. */
static bool choose_tiles(struct run *run, struct error *error) {
    struct film *film = run->job->film;
    uint32_t count = film_tile_count(film);
    if (run->job->shards <= 1)
        return true;
    run->cost = mem_alloc_zero(count, sizeof *run->cost);
    if (!run->cost)
        return error_no_memory(error, "the tiles of a shard");
    bool looked = pool_run(run->pool, count, cost_item, run);
    bool ok = looked && shard_choose(run->cost, film, run->job->shard, run->job->shards);
    mem_free(run->cost);
    run->cost = NULL;
    if (!looked)
        return error_set(error, ERROR_CANCELLED, "stopped while rendering");
    return ok || error_no_memory(error, "the tiles of a shard");
}

bool run_is_enough(const struct run *run) {
    return run->job->enough && atomic_load_explicit(run->job->enough, memory_order_relaxed) != 0;
}

/* Makes a tile or a part of it; false: stopped. A ray that was given up leaves a wrong colour: what ends after a wish
 * to stop counts as not done. */
static bool make_part(struct run *run, struct worker *worker, uint32_t tile, struct rectangle part, double share) {
    run_tile_begins(run, worker, tile, share);
    bool whole = integrator_render(run, worker, &part) && !run_stopped(run, worker);
    if (worker->scratch.failed) {
        atomic_store(&run->failed, true);
        pool_cancel(run->pool);
    }
    worker->tile_ended = seconds_now();
    if (whole)
        run_tile_ends(run, worker);
    return whole;
}

static void end_tile(struct run *run, uint32_t tile, bool whole) {
    struct film *film = run->job->film;
    atomic_store_explicit(&film->tiles[tile], whole ? FILM_TILE_DONE : FILM_TILE_WANTED, memory_order_release);
    if (whole && run->job->tile_done) {
        uint32_t done = atomic_fetch_add(&run->done, 1) + 1;
        run->job->tile_done(run->job->context, tile, done, run->tiles_wanted);
    }
}

static void make_tile(struct run *run, uint32_t tile, int index) {
    struct film *film = run->job->film;
    uint8_t wanted = FILM_TILE_WANTED;
    if (run_is_enough(run) || !atomic_compare_exchange_strong(&film->tiles[tile], &wanted, FILM_TILE_TAKEN))
        return;
    struct film_rectangle r = film_tile_rectangle(film, tile);
    end_tile(run, tile, make_part(run, &run->workers[index], tile, (struct rectangle){r.x0, r.y0, r.x1, r.y1}, 1));
}

/* The last tiles of the order are made in quarters, so that no thread waits long for another one's last tile. Who comes
 * first takes the tile, who ends last ends it; once it is begun, its other quarters are made even when it is enough. */
enum { QUARTERS = 4, QUARTER_FAILED = 0x80, TAIL_SHARE = 16, TAIL_LIMIT = 64 };

static void make_quarter(struct run *run, uint32_t number, int index) {
    struct film *film = run->job->film;
    uint32_t tile = run->order[run->whole_tiles + number / QUARTERS];
    _Atomic uint8_t *count = &run->quarters[number / QUARTERS];
    uint8_t state = atomic_load(&film->tiles[tile]);
    if (state == FILM_TILE_WANTED && run_is_enough(run))
        return;
    if (state == FILM_TILE_WANTED && atomic_compare_exchange_strong(&film->tiles[tile], &state, FILM_TILE_TAKEN))
        state = FILM_TILE_TAKEN;
    if (state != FILM_TILE_TAKEN)
        return;
    struct film_rectangle r = film_tile_rectangle(film, tile);
    uint32_t x = r.x0 + (r.x1 - r.x0 + 1) / 2, y = r.y0 + (r.y1 - r.y0 + 1) / 2;
    bool right = number % 2 == 1, low = number / 2 % 2 == 1;
    struct rectangle part = {right ? x : r.x0, low ? y : r.y0, right ? r.x1 : x, low ? r.y1 : y};
    int64_t pixels = (part.x1 - part.x0) * (part.y1 - part.y0);
    double share = (double)pixels / ((double)(r.x1 - r.x0) * (r.y1 - r.y0));
    if (pixels > 0 && !make_part(run, &run->workers[index], tile, part, share))
        atomic_fetch_or(count, QUARTER_FAILED);
    uint8_t before = atomic_fetch_add(count, 1);
    if ((before & ~QUARTER_FAILED) + 1 == QUARTERS)
        end_tile(run, tile, !(before & QUARTER_FAILED));
}

static void tile_item(void *context, uint32_t place, int index) {
    struct run *run = context;
    if (place < run->whole_tiles)
        make_tile(run, run->order[place], index);
    else
        make_quarter(run, place - run->whole_tiles, index);
}

/* Makes whatever becomes wanted until no more can. */
static void handout_item(void *context, uint32_t item, int index) {
    struct run *run = context;
    const struct film *film = run->job->film;
    const struct timespec pause = {0, 500000};
    uint32_t count = film_tile_count(film);
    (void)item;
    while (!run_stopped(run, &run->workers[index]) && !run_is_enough(run)) {
        uint32_t tile = 0;
        while (tile < count && atomic_load_explicit(&film->tiles[tile], memory_order_relaxed) != FILM_TILE_WANTED)
            tile++;
        if (tile < count)
            make_tile(run, tile, index);
        else if (atomic_load(run->job->handout) != 1)
            return;
        else
            (void)nanosleep(&pause, NULL);
        if (run->estimated)
            run_report_estimate(run);
    }
}

static bool run_tiles(struct run *run, struct render_statistics *statistics) {
    int workers = pool_workers(run->pool);
    double begun = seconds_now();
    for (int i = 0; i < workers; i++)
        run->workers[i].tile_ended = begun;
    uint32_t tail = film_tile_count(run->job->film) - run->whole_tiles;
    bool whole = run->job->handout ? pool_run(run->pool, (uint32_t)workers, handout_item, run)
                                   : pool_run(run->pool, run->whole_tiles + QUARTERS * tail, tile_item, run);
    double ended = seconds_now();
    for (uint32_t i = 0; i < tail && !whole; i++) { /* those of which quarters are missing */
        uint8_t taken = FILM_TILE_TAKEN;
        (void)atomic_compare_exchange_strong(&run->job->film->tiles[run->order[run->whole_tiles + i]], &taken,
                                             FILM_TILE_WANTED);
    }
    for (int i = 0; i < workers; i++)
        statistics->idle_seconds += ended - run->workers[i].tile_ended;
    return whole;
}

bool render_prepare(struct render_job *job, uint32_t *x0, uint32_t *y0, uint32_t *width, uint32_t *height,
                    char warning[256], struct error *error) {
    const struct settings *s = &job->settings;
    struct camera_frame frame;
    char ignored[256];
    if (!run_prepare_at(job, 0, &frame, warning, error) || !run_prepare_at(job, 1, &frame, ignored, error))
        return false;
    *x0 = *y0 = 0;
    *width = job->width;
    *height = job->height;
    if (!s->cropped)
        return true;
    if (s->crop_x < 0 || s->crop_y < 0 || s->crop_width < 1 || s->crop_height < 1 || s->crop_x >= (int64_t)job->width ||
        s->crop_width > (int64_t)job->width - s->crop_x || s->crop_y >= (int64_t)job->height ||
        s->crop_height > (int64_t)job->height - s->crop_y)
        return error_set(error, ERROR_USAGE, "--crop %lld,%lld,%lld,%lld does not lie inside the picture of %u x %u",
                         (long long)s->crop_x, (long long)s->crop_y, (long long)s->crop_width,
                         (long long)s->crop_height, job->width, job->height);
    *x0 = (uint32_t)s->crop_x;
    *y0 = (uint32_t)s->crop_y;
    *width = (uint32_t)s->crop_width;
    *height = (uint32_t)s->crop_height;
    return true;
}

static void add_statistics(const struct run *run, int workers, struct render_statistics *out) {
    for (int i = 0; i < workers; i++) {
        const struct worker *worker = &run->workers[i];
        out->camera_rays += worker->camera_rays;
        out->reflected_rays += worker->state.reflected_rays;
        out->refracted_rays += worker->state.refracted_rays;
        out->shadow_rays += worker->state.shadow_rays;
        out->shape_tests += worker->scratch.geom.shape_tests;
        out->triangle_tests += worker->scratch.geom.cost.triangle_tests;
        out->voxels += worker->scratch.geom.cost.voxels;
        out->hierarchy_steps += worker->scratch.geom.cost.hierarchy_steps;
        out->box_tests += worker->scratch.geom.box_tests;
    }
    integrator_add_statistics(run, out);
    out->samples = out->camera_rays;
    out->pixels += (uint64_t)run->job->film->width * run->job->film->height;
}

static bool start_workers(struct run *run, int workers) {
    run->workers = mem_alloc_zero((size_t)workers, sizeof *run->workers);
    if (!run->workers)
        return false;
    for (int i = 0; i < workers; i++) {
        struct worker *worker = &run->workers[i];
        if (!world_scratch_init(&worker->scratch, run->job->world))
            return false;
        worker->index = i;
        worker->state = (struct integrator_state){
            .job = run->job, .pool = run->pool, .scratch = &worker->scratch, .eye_media = &run->eye_media};
    }
    return true;
}

static void count_tiles(struct run *run) {
    const struct film *film = run->job->film;
    uint32_t done = film_tiles_in(film, FILM_TILE_DONE);
    run->tiles_wanted = film_tile_count(film) - film_tiles_in(film, FILM_TILE_ELSEWHERE);
    atomic_store(&run->done, done);
}

/* The solids that rays may start in, and whether each ray must ask for itself. */
static bool find_eye_media(struct run *run, const struct box *origins, bool spread) {
    const struct world *world = run->job->world;
    run->closed_count = world->medium_count > 0 ? world_closed_in(world, origins, NULL, 0) : 0;
    run->closed = mem_alloc_zero((size_t)run->closed_count + 1, sizeof *run->closed);
    if (!run->closed)
        return false;
    if (run->closed_count > 0)
        (void)world_closed_in(world, origins, run->closed, run->closed_count);
    run->media_by_ray = run->closed_count > 0 && spread;
    run->together = camera_is_plain(&run->camera) && !run->timed && !run->media_by_ray;
    media_around(world, run->camera.eye, 0, run->closed, run->closed_count, &run->workers[0].scratch, &run->eye_media);
    return !run->workers[0].scratch.failed;
}

static bool prepare_run(struct run *run, const struct camera_frame *at_close) {
    const struct render_job *job = run->job;
    const struct shutter *shutter = &job->settings.shutter;
    run->timed = shutter->close > shutter->open && (job->world->moves || job->settings.motion.moves);
    struct box origins = box_join(camera_origins(&run->camera), camera_origins(at_close));
    return find_eye_media(run, &origins, run->timed || camera_spreads(&run->camera));
}

/* Everything before the first tile. */
static bool begin_run(struct run *run, int workers, struct render_statistics *statistics, struct error *error) {
    char warning[256];
    struct camera_frame at_close;
    if (!run_prepare_at(run->job, 0, &run->camera, warning, error) ||
        !run_prepare_at(run->job, 1, &at_close, warning, error))
        return false;
    if (!start_workers(run, workers) || !prepare_run(run, &at_close))
        return error_no_memory(error, "the workers of a render");
    return integrator_create(run, workers, statistics, error);
}

static void end_run(struct run *run, int workers) {
    for (int i = 0; run->workers && i < workers; i++)
        world_scratch_destroy(&run->workers[i].scratch);
    integrator_destroy(run->integrator);
    mem_free(run->workers);
    mem_free(run->closed);
    mem_free(run->order);
    mem_free(run->quarters);
    time_estimate_destroy(&run->time_estimate);
}

/* The part is one pixel. */
static bool record_pixel(struct run *run, struct film *film, struct pixel_trace *pixel_trace, struct error *error) {
    struct worker *worker = &run->workers[0];
    struct rectangle tile = {pixel_trace->x, pixel_trace->y, (int64_t)pixel_trace->x + 1, (int64_t)pixel_trace->y + 1};
    film->x0 = pixel_trace->x;
    film->y0 = pixel_trace->y;
    worker->state.observer = &pixel_trace->observer;
    if (!integrator_render(run, worker, &tile) || run_stopped(run, worker))
        return worker->scratch.failed ? error_no_memory(error, "the crossings of a ray")
                                      : error_set(error, ERROR_CANCELLED, "stopped while rendering");
    return !pixel_trace->failed || error_no_memory(error, "the trace of a pixel");
}

bool render_pixels(const struct render_job *job, struct pool *pool, const uint32_t (*pixels)[2], uint32_t count,
                   pixel_trace_listener *listen, void *context, struct error *error) {
    struct film_pixel pixel = {0};
    float floats[FILM_RECORD_FLOATS] = {0};
    uint8_t marked = 0;
    struct film film = {.width = 1,
                        .height = 1,
                        .full_width = job->width,
                        .full_height = job->height,
                        .record = integrator_record(job->settings.integrator),
                        .pixels = &pixel,
                        .floats = floats,
                        .marked = &marked};
    struct render_job own = *job;
    struct render_statistics statistics = {0};
    struct run run = {.job = &own, .pool = pool};
    own.film = &film;
    own.settings.show_marks = false;
    bool ok = begin_run(&run, pool_workers(pool), &statistics, error);
    run.together = false; /* each sample tells for itself */
    for (uint32_t i = 0; ok && i < count; i++) {
        struct pixel_trace pixel_trace;
        pixel_trace_init(&pixel_trace, pixels[i][0], pixels[i][1]);
        ok = record_pixel(&run, &film, &pixel_trace, error) && listen(context, &pixel_trace, error);
        pixel_trace_destroy(&pixel_trace);
    }
    end_run(&run, pool_workers(pool));
    return ok;
}

/* In a farm tiles are made as they are handed out. */
static bool order_tiles(struct run *run) {
    const struct film *film = run->job->film;
    uint32_t count = film_tile_count(film);
    if (run->job->progress_estimate &&
        !time_estimate_create(&run->time_estimate, count, film_tiles_across(film), pool_workers(run->pool)))
        return false;
    run->whole_tiles = count;
    if (run->job->handout)
        return true;
    uint32_t tail = (count + TAIL_SHARE - 1) / TAIL_SHARE;
    tail = tail < TAIL_LIMIT ? tail : TAIL_LIMIT;
    run->whole_tiles = count - tail;
    run->order = mem_alloc_zero(count, sizeof *run->order);
    run->quarters = mem_alloc_zero(tail, sizeof *run->quarters);
    return run->order && run->quarters && tile_order(film, run->job->settings.order, run->order);
}

static bool is_unfinished(const struct run *run) {
    const struct film *film = run->job->film;
    return film_tiles_in(film, FILM_TILE_WANTED) > 0;
}

static bool make_tiles(struct run *run, struct render_statistics *statistics, struct error *error) {
    if (!order_tiles(run))
        return error_no_memory(error, "the order of the tiles");
    count_tiles(run);
    bool whole = run_cost_prepass(run) && run_tiles(run, statistics) && !(run_is_enough(run) && is_unfinished(run));
    if (whole && run->job->progress_estimate)
        run_report_end(run);
    if (!atomic_load(&run->failed))
        return whole || error_set(error, ERROR_CANCELLED, "stopped while rendering");
    if (!whole)
        pool_reset_cancel(run->pool);
    return error_no_memory(error, "the crossings of a ray");
}

bool render_run(const struct render_job *job, struct pool *pool, struct render_statistics *statistics,
                struct error *error) {
    struct run run = {.job = job, .pool = pool};
    int workers = pool_workers(pool);
    double begin = seconds_now();
    bool ok =
        begin_run(&run, workers, statistics, error) && choose_tiles(&run, error) && make_tiles(&run, statistics, error);
    if (run.integrator)
        add_statistics(&run, workers, statistics);
    if (ok && job->film->layers && !pool_run(pool, film_tile_count(job->film), run_layer_item, &run))
        ok = error_set(error, ERROR_CANCELLED, "stopped while rendering");
    for (int i = 0; run.workers && i < workers; i++)
        statistics->clamped += run.workers[i].clamped || run.workers[i].state.clamped;
    end_run(&run, workers);
    statistics->render_seconds += seconds_now() - begin;
    return ok;
}
