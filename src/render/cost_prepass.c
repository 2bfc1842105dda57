/* The cost pre-pass, if a time estimate is requested: PROBE_SIDE x PROBE_SIDE rays through each tile before the first
 * one (eight times as many with --noise), about 1 % of the work. Tiles that get their samples level by level need no
 * pre-pass. After that, the next free worker updates and reports
 * the time estimate (render/time_estimate.h) a hundred times a second. Times are processor times, so other programs
 * have no influence. */
#include "base/clock.h"
#include "render/integrator_internal.h"

#include <math.h>

/* Nanoseconds between two forecasts. */
static const uint64_t pause = 10000000;

/* Includes tiles that other ranks of a farm will render. */
static void probe_tile(void *context, uint32_t tile, int index) {
    struct renderer *renderer = context;
    struct worker *worker = &renderer->workers[index];
    const struct film *film = renderer->job->film;
    struct film_rectangle r = film_tile_rectangle(film, tile);
    struct vec3 colours[PROBE_RAYS];
    uint8_t state = atomic_load_explicit(&film->tiles[tile], memory_order_relaxed);
    if (state == FILM_TILE_DONE || state == FILM_TILE_ELSEWHERE)
        return;
    uint64_t begun = clock_nanoseconds(CLOCK_THREAD_CPUTIME_ID);
    for (int i = 0; i < PROBE_RAYS; i++) {
        struct pixel pixel = integrator_probe_pixel(&r, i);
        struct pixel_sample position = renderer_first_sample(renderer, pixel.x, pixel.y);
        if (renderer_stopped(renderer, worker) || renderer_is_done(renderer))
            return;
        colours[i] = renderer_sample(renderer, worker, &position);
    }
    double resampling = integrator_resampling(renderer, worker, &r, colours);
    uint64_t took = clock_nanoseconds(CLOCK_THREAD_CPUTIME_ID) - begun;
    time_estimate_probe(&renderer->time_estimate, tile, (double)(r.x1 - r.x0) * (r.y1 - r.y0), 1 + (double)took,
                        resampling);
}

/* So many rays count in the statistics. */
struct ray_counts {
    uint64_t camera_rays, hits, reflected_rays, refracted_rays, shadow_rays, shape_tests, box_tests;
    struct triangle_cost cost;
};

static struct ray_counts counts_of(const struct worker *worker) {
    const struct integrator_state *state = &worker->state;
    const struct geom_scratch *geom = &worker->scratch.geom;
    return (struct ray_counts){.camera_rays = worker->camera_rays,
                               .hits = state->hits,
                               .reflected_rays = state->reflected_rays,
                               .refracted_rays = state->refracted_rays,
                               .shadow_rays = state->shadow_rays,
                               .shape_tests = geom->shape_tests,
                               .box_tests = geom->box_tests,
                               .cost = geom->cost};
}

static void restore_counts(struct worker *worker, const struct ray_counts *counts) {
    struct integrator_state *state = &worker->state;
    struct geom_scratch *geom = &worker->scratch.geom;
    worker->camera_rays = counts->camera_rays;
    state->hits = counts->hits;
    state->reflected_rays = counts->reflected_rays;
    state->refracted_rays = counts->refracted_rays;
    state->shadow_rays = counts->shadow_rays;
    geom->shape_tests = counts->shape_tests;
    geom->box_tests = counts->box_tests;
    geom->cost = counts->cost;
}

/* These rays are not part of the picture's statistics. */
static void forget_counts(struct renderer *renderer) {
    const struct ray_counts none = {0};
    for (int i = 0; i < pool_workers(renderer->pool); i++) {
        struct worker *worker = &renderer->workers[i];
        restore_counts(worker, &none);
        worker->clamped = worker->state.clamped = false;
    }
}

void renderer_expect_levels(struct renderer *renderer) {
    const struct film *film = renderer->job->film;
    for (uint32_t tile = 0; tile < film_tile_count(film); tile++) {
        struct film_rectangle r = film_tile_rectangle(film, tile);
        uint8_t state = atomic_load_explicit(&film->tiles[tile], memory_order_relaxed);
        if (state == FILM_TILE_WANTED || film_tile_is_begun(state))
            noise_estimate_expect(&renderer->noise_estimate, tile, (double)(r.x1 - r.x0) * (r.y1 - r.y0),
                                  renderer->levels.wanted ? renderer->levels.samples[tile] : 0);
    }
}

/* --- layers --- */

void renderer_measure_layers(struct renderer *renderer, struct worker *worker, uint32_t tile) {
    enum { PIXELS_SIDE = 2 };
    if (!renderer->estimated || !renderer->job->film->layers)
        return;
    struct film_rectangle r = film_tile_rectangle(renderer->job->film, tile);
    struct ray_counts counts = counts_of(worker);
    uint64_t begun = clock_nanoseconds(CLOCK_THREAD_CPUTIME_ID);
    for (uint32_t i = 0; i < PIXELS_SIDE * PIXELS_SIDE; i++) {
        uint32_t x = r.x0 + (r.x1 - r.x0) * (2 * (i % PIXELS_SIDE) + 1) / (2 * PIXELS_SIDE);
        uint32_t y = r.y0 + (r.y1 - r.y0) * (2 * (i / PIXELS_SIDE) + 1) / (2 * PIXELS_SIDE);
        renderer_layer_pixel(renderer, worker, x, y);
    }
    restore_counts(worker, &counts);
    sum_add(&worker->layers.measured_cost, (double)(clock_nanoseconds(CLOCK_THREAD_CPUTIME_ID) - begun));
    sum_add(&worker->layers.measured_pixels, PIXELS_SIDE * PIXELS_SIDE);
}

uint64_t renderer_layers_begin(const struct renderer *renderer) {
    return renderer->estimated ? clock_nanoseconds(CLOCK_THREAD_CPUTIME_ID) : 0;
}

void renderer_layers_end(struct renderer *renderer, struct worker *worker, uint64_t begun, double pixels) {
    if (!renderer->estimated)
        return;
    sum_add(&worker->layers.cost, (double)(clock_nanoseconds(CLOCK_THREAD_CPUTIME_ID) - begun));
    sum_add(&worker->layers.pixels, pixels);
    renderer_report_estimate(renderer);
}

/* The layers are made after all tiles, row by row: at first the pixels that were measured predict the rest, which are
 * spread over the picture, later those that are made. */
static void add_layers(const struct renderer *renderer, struct time_estimate_work *work) {
    const struct film *film = renderer->job->film;
    double cost = 0, pixels = 0, measured_cost = 0, measured_pixels = 0, all = (double)film->width * film->height;
    for (int i = 0; film->layers && i < pool_workers(renderer->pool); i++) {
        const struct layer_sums *layers = &renderer->workers[i].layers;
        cost += sum_load(&layers->cost);
        pixels += sum_load(&layers->pixels);
        measured_cost += sum_load(&layers->measured_cost);
        measured_pixels += sum_load(&layers->measured_pixels);
    }
    double by_measured = measured_pixels > 0 ? fmax(measured_cost / measured_pixels * all - cost, 0) : 0;
    double by_made = pixels > 0 ? cost / pixels * (all - pixels) : 0;
    work->done += measured_cost + cost;
    work->left += measured_pixels > 0 ? by_measured * (1 - pixels / all) + by_made * pixels / all : by_made;
}

bool renderer_cost_prepass(struct renderer *renderer) {
    struct progress_estimate *progress_estimate = renderer->job->progress_estimate;
    const struct film *film = renderer->job->film;
    if (!progress_estimate)
        return true;
    /* Others of a farm have begun already. */
    uint64_t begun = clock_nanoseconds(CLOCK_MONOTONIC);
    if (!renderer->levels.wanted) {
        if (!pool_run(renderer->pool, film_tile_count(film), probe_tile, renderer))
            return false;
        forget_counts(renderer);
        time_estimate_begin_tiles(&renderer->time_estimate, renderer->job->settings.noise > 0);
    }
    renderer->estimated = true;
    atomic_store(&progress_estimate->begun, renderer->job->handout ? begun : clock_nanoseconds(CLOCK_MONOTONIC));
    progress_estimate_report(progress_estimate, 0, 1, 0);
    renderer->worked = clock_nanoseconds(CLOCK_PROCESS_CPUTIME_ID);
    return true;
}

void renderer_report_estimate(struct renderer *renderer) {
    if (!renderer->estimated)
        return;
    uint64_t now = clock_nanoseconds(CLOCK_MONOTONIC),
             reported = atomic_load_explicit(&renderer->reported, memory_order_relaxed);
    if (now - reported < pause || !atomic_compare_exchange_strong(&renderer->reported, &reported, now))
        return;
    struct progress_estimate *progress_estimate = renderer->job->progress_estimate;
    struct time_estimate_work work =
        renderer->levels.wanted && renderer->job->handout ? renderer_farm_work(renderer)
        : renderer->noise_estimate.count > 0
            ? noise_estimate_work(&renderer->noise_estimate)
            : time_estimate_work(&renderer->time_estimate, renderer->job->handout ? renderer->job->film : NULL);
    add_layers(renderer, &work);
    uint64_t worked = clock_nanoseconds(CLOCK_PROCESS_CPUTIME_ID) - renderer->worked + 1;
    double passed = (double)(now - atomic_load(&progress_estimate->begun)) * pool_workers(renderer->pool);
    atomic_store_explicit(&progress_estimate->pace, (uint64_t)(1000 * passed / (double)worked), memory_order_relaxed);
    double limit = renderer->job->settings.time_limit;
    if (limit > 0 && work.done > 0) {
        double seconds = 1e-9 * (double)(now - atomic_load(&progress_estimate->begun));
        work.left = fmin(work.left, fmax(renderer->begun + limit - 1e-9 * (double)now, 0) * work.done / seconds);
    }
    progress_estimate_report(progress_estimate, work.done, work.left, now);
}

void renderer_report_end(struct renderer *renderer) {
    progress_estimate_report(renderer->job->progress_estimate, 1, 0, clock_nanoseconds(CLOCK_MONOTONIC));
}

void renderer_tile_begins(struct renderer *renderer, struct worker *worker, uint32_t tile, double share) {
    if (!renderer->estimated)
        return;
    worker->tile_begun = worker->first_ended = clock_nanoseconds(CLOCK_THREAD_CPUTIME_ID);
    time_estimate_begin(&renderer->time_estimate, worker->index, tile, share);
}

static void level_goes_on(struct renderer *renderer, const struct worker *worker, double part) {
    const struct noise_sums *sums = &renderer->noise_estimate.sums[worker->index];
    noise_estimate_part(&renderer->noise_estimate, worker->index, part);
    if (renderer->job->handout)
        sum_store(&renderer->job->film->levels[worker->level_tile].begun, sum_load(&sums->planned) * part);
}

void renderer_tile_goes_on(struct renderer *renderer, struct worker *worker, int pass, double part) {
    if (renderer->noise_estimate.count > 0)
        level_goes_on(renderer, worker, part);
    if (!renderer->estimated)
        return;
    if (pass == 0 && part >= 1)
        worker->first_ended = clock_nanoseconds(CLOCK_THREAD_CPUTIME_ID);
    if (renderer->noise_estimate.count == 0)
        time_estimate_part(&renderer->time_estimate, worker->index, pass, part);
    renderer_report_estimate(renderer);
}

void renderer_tile_ends(struct renderer *renderer, struct worker *worker) {
    if (!renderer->estimated)
        return;
    uint64_t now = clock_nanoseconds(CLOCK_THREAD_CPUTIME_ID);
    time_estimate_done(&renderer->time_estimate, worker->index, (double)(now - worker->tile_begun),
                       (double)(worker->first_ended - worker->tile_begun));
    renderer_report_estimate(renderer);
}

void renderer_level_begins(struct renderer *renderer, struct worker *worker, uint32_t tile, uint32_t end) {
    if (renderer->noise_estimate.count == 0)
        return;
    worker->tile_begun = clock_nanoseconds(CLOCK_THREAD_CPUTIME_ID);
    worker->level_tile = tile;
    noise_estimate_begin(&renderer->noise_estimate, worker->index, tile, end);
}

void renderer_level_ends(struct renderer *renderer, struct worker *worker, uint32_t tile, bool final) {
    if (renderer->noise_estimate.count == 0 || worker->noise.samples == 0)
        return;
    uint64_t now = clock_nanoseconds(CLOCK_THREAD_CPUTIME_ID);
    struct noise_level level = {worker->noise, 1 + (double)(now - worker->tile_begun), final};
    noise_estimate_done(&renderer->noise_estimate, worker->index, tile, &level);
    renderer_report_estimate(renderer);
}
