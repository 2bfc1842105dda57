/* Finished tiles represent the others, because the order spreads them over the picture: a tile that is not begun is
 * expected to cost as much as its finished neighbours, or as the mean of all without any. One that is begun costs as
 * much as before for the same part of its work. Costs are processor times, so other programs have little influence.
 *
 * The estimate is the moment of the end and not the time left: between two reports the latter falls as the clock
 * goes. */
#include "render/time_estimate.h"

#include "base/clock.h"
#include "base/mem.h"
#include "render/render_internal.h"

/* --- the work of the tiles --- */

static double part_of(const struct tile_cost *tile) {
    return (double)atomic_load_explicit(&tile->part, memory_order_relaxed) / TILE_COST_WHOLE;
}

static double cost_of(const struct tile_cost *tile) {
    return (double)atomic_load_explicit(&tile->cost, memory_order_relaxed);
}

/* The cost of a pixel of the finished tiles among the eight neighbours; `otherwise` without any. */
static double neighbouring_cost(const struct time_estimate *estimate, uint32_t tile, double otherwise) {
    uint32_t x = tile % estimate->across, y = tile / estimate->across, rows = estimate->count / estimate->across;
    double cost = 0, pixels = 0;
    for (uint32_t v = y > 0 ? y - 1 : 0; v <= y + 1 && v < rows; v++) {
        for (uint32_t u = x > 0 ? x - 1 : 0; u <= x + 1 && u < estimate->across; u++) {
            const struct tile_cost *other = &estimate->tiles[v * estimate->across + u];
            bool done = part_of(other) > 0.9999; /* the parts of quarters are rounded */
            cost += done ? cost_of(other) : 0;
            pixels += done ? other->pixels : 0;
        }
    }
    return pixels > 0 ? cost / pixels : otherwise;
}

struct time_estimate_work time_estimate_work(const struct time_estimate *estimate) {
    double done = 0, pixels = 0, left = 0, longest = 0;
    for (uint32_t i = 0; i < estimate->count; i++) {
        done += cost_of(&estimate->tiles[i]);
        pixels += estimate->tiles[i].pixels * part_of(&estimate->tiles[i]);
    }
    if (!(pixels > 0))
        return (struct time_estimate_work){0, 1};
    for (uint32_t i = 0; i < estimate->count; i++) {
        const struct tile_cost *tile = &estimate->tiles[i];
        double part = part_of(tile);
        double rest = part > 0 ? cost_of(tile) / part * math_max(1 - part, 0)
                               : tile->pixels * neighbouring_cost(estimate, i, done / pixels);
        left += rest;
        longest = math_max(longest, rest);
    }
    return (struct time_estimate_work){done, math_max(left, estimate->waiting * longest)};
}

/* --- what workers report --- */

/* Seconds between two reports: some, and so many more for each tile that a report takes less than a hundredth of the
 * time of a thread. */
static const double report_pause = 0.01, report_pause_of_tile = 2e-6;

bool renderer_begin_estimate(struct renderer *renderer) {
    const struct film *film = renderer->job->film;
    struct time_estimate *estimate = &renderer->time_estimate;
    if (!renderer->job->progress_estimate)
        return true;
    bool waits = renderer->job->settings.noise > 0 && !renderer_makes_passes(renderer);
    estimate->count = film_tile_count(film);
    estimate->across = film_tiles_across(film);
    estimate->waiting = waits ? pool_workers(renderer->pool) : 1;
    estimate->tiles = mem_alloc_zero(estimate->count, sizeof *estimate->tiles);
    for (uint32_t tile = 0; estimate->tiles && tile < estimate->count; tile++) {
        struct film_rectangle r = film_tile_rectangle(film, tile);
        uint8_t state = atomic_load_explicit(&film->tiles[tile], memory_order_relaxed);
        if (state == FILM_TILE_WANTED || film_tile_is_begun(state))
            estimate->tiles[tile].pixels = (double)(r.x1 - r.x0) * (r.y1 - r.y0);
    }
    renderer->job->progress_estimate->begun = clock_now();
    return estimate->tiles != NULL;
}

/* The next free worker reports. A time limit is the time, whatever the tiles cost. */
static void report(struct renderer *renderer, double now) {
    struct progress_estimate *progress = renderer->job->progress_estimate;
    double reported = atomic_load_explicit(&renderer->reported, memory_order_relaxed);
    if (now - reported < report_pause + report_pause_of_tile * renderer->time_estimate.count ||
        !atomic_compare_exchange_strong(&renderer->reported, &reported, now))
        return;
    struct time_estimate_work work = time_estimate_work(&renderer->time_estimate);
    double limit = renderer->job->settings.time_limit;
    if (limit > 0)
        work = (struct time_estimate_work){now - progress->begun, math_max(renderer->begun + limit - now, 0)};
    progress_estimate_report(progress, work.done, work.left, now);
}

void renderer_tile_begins(struct renderer *renderer, struct worker *worker, uint32_t tile, double share) {
    struct tile_cost *cost = renderer->time_estimate.tiles ? &renderer->time_estimate.tiles[tile] : NULL;
    if (!cost)
        return;
    uint32_t part = share < 1 ? 0 : atomic_load_explicit(&cost->part, memory_order_relaxed);
    worker->part = (double)part / TILE_COST_WHOLE;
    worker->cost = (struct worker_cost){cost, share, part, clock_nanoseconds(CLOCK_THREAD_CPUTIME_ID), clock_now()};
}

/* Adds what has changed since the last time; the part may decrease. */
static void add_cost(struct renderer *renderer, struct worker *worker, double now) {
    struct worker_cost *cost = &worker->cost;
    uint64_t worked = clock_nanoseconds(CLOCK_THREAD_CPUTIME_ID);
    uint32_t part = (uint32_t)(cost->share * worker->part * TILE_COST_WHOLE);
    atomic_fetch_add_explicit(&cost->tile->cost, worked - cost->worked, memory_order_relaxed);
    atomic_fetch_add_explicit(&cost->tile->part, part - cost->part, memory_order_relaxed);
    cost->part = part;
    cost->worked = worked;
    cost->added = now;
    report(renderer, now);
}

void renderer_tile_goes_on(struct renderer *renderer, struct worker *worker, double part) {
    worker->part = part;
    if (!renderer->time_estimate.tiles)
        return;
    double now = clock_now();
    if (now - worker->cost.added >= report_pause)
        add_cost(renderer, worker, now);
}

void renderer_tile_ends(struct renderer *renderer, struct worker *worker) {
    if (renderer->time_estimate.tiles)
        add_cost(renderer, worker, clock_now());
}

void renderer_tile_was_made(struct renderer *renderer, uint32_t tile, double share, double seconds) {
    struct tile_cost *cost = renderer->time_estimate.tiles ? &renderer->time_estimate.tiles[tile] : NULL;
    if (!cost)
        return;
    atomic_fetch_add_explicit(&cost->cost, (uint64_t)(seconds * 1e9), memory_order_relaxed);
    atomic_fetch_add_explicit(&cost->part, (uint32_t)(share * TILE_COST_WHOLE), memory_order_relaxed);
    report(renderer, clock_now());
}
