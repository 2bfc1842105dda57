/* With --noise, the time of a tile is not known before it has most of its samples. So all tiles get their samples level
 * by level, each level with a third to all of the samples before, and the time left is known early. First, each tile
 * gets two samples. After that, the tile with the largest urgency gets its next level: the uncertainty of the cost of
 * its further samples, relative to the cost of this level (noise_estimate_urgency). So uncertain tiles come first, and
 * at the end the number of samples of the other tiles is nearly certain.
 *
 * In a farm the first rank hands out the tiles (output/farm.c), in the same order. A rank returns a tile after one
 * level, or more if they take less than a few milliseconds, with its record in the film (struct film_level). */
#include "base/clock.h"
#include "base/mem.h"
#include "film/path_film.h"
#include "render/integrator_internal.h"

#include <assert.h>
#include <math.h>
#include <string.h>
#include <time.h>

/* --- tiles that wait --- */

static bool comes_before(struct waiting_tile a, struct waiting_tile b) {
    return a.urgency > b.urgency || (a.urgency >= b.urgency && a.position < b.position);
}

static void put(struct sample_levels *levels, struct waiting_tile tile) {
    uint32_t at = levels->count++;
    for (; at > 0 && comes_before(tile, levels->waiting[(at - 1) / 2]); at = (at - 1) / 2)
        levels->waiting[at] = levels->waiting[(at - 1) / 2];
    levels->waiting[at] = tile;
}

/* There is one. */
static struct waiting_tile take_first(struct sample_levels *levels) {
    struct waiting_tile first = levels->waiting[0], last = levels->waiting[--levels->count];
    uint32_t at = 0;
    for (uint32_t next = 1; next < levels->count; next = 2 * at + 1) {
        if (next + 1 < levels->count && comes_before(levels->waiting[next + 1], levels->waiting[next]))
            next++;
        if (!comes_before(levels->waiting[next], last))
            break;
        levels->waiting[at] = levels->waiting[next];
        at = next;
    }
    levels->waiting[at] = last;
    return first;
}

/* Waits while no tile waits but others are in progress. False: all are final, or the render stops. */
static bool take_tile(struct renderer *renderer, const struct worker *worker, uint32_t *position) {
    const struct timespec pause = {0, 200000};
    struct sample_levels *levels = &renderer->levels;
    while (!renderer_stopped(renderer, worker) && !renderer_is_done(renderer)) {
        (void)pthread_mutex_lock(&levels->mutex);
        bool some = levels->count > 0, more = levels->in_progress > 0;
        if (some) {
            *position = take_first(levels).position;
            levels->in_progress++;
        }
        (void)pthread_mutex_unlock(&levels->mutex);
        if (some || !more)
            return some;
        (void)nanosleep(&pause, NULL);
    }
    return false;
}

static void put_back(struct renderer *renderer, uint32_t position, bool final) {
    struct sample_levels *levels = &renderer->levels;
    double urgency = noise_estimate_urgency(&renderer->noise_estimate, renderer->order[position]);
    (void)pthread_mutex_lock(&levels->mutex);
    if (!final)
        put(levels, (struct waiting_tile){urgency, position});
    levels->in_progress--;
    (void)pthread_mutex_unlock(&levels->mutex);
}

/* --- levels --- */

/* The state of a tile differs from that of the level before. */
static uint8_t state_after(uint32_t samples, uint32_t limit) {
    uint32_t level = 0;
    for (uint32_t n = 0; n < samples; n = noise_next_level(n, limit))
        level++;
    return (uint8_t)(FILM_TILE_LEVEL + level % FILM_LEVELS);
}

enum level_end { LEVEL_BROKEN /* stopped: the pixels are of no use */, LEVEL_DONE, LEVEL_FINAL };

/* The next level of a tile that has so many samples; changes their number. */
static enum level_end sample_level(struct renderer *renderer, struct worker *worker, uint32_t tile, uint32_t *samples) {
    struct film_rectangle r = film_tile_rectangle(renderer->job->film, tile);
    uint32_t limit = renderer->pass.end;
    worker->level = (struct sample_range){*samples, noise_next_level(*samples, limit)};
    renderer_level_begins(renderer, worker, tile, worker->level.end);
    bool whole = renderer_make_samples(renderer, worker, (struct rectangle){r.x0, r.y0, r.x1, r.y1});
    bool final = whole && (worker->quiet || worker->level.end == limit);
    if (whole)
        renderer_level_ends(renderer, worker, tile, final);
    *samples = worker->level.end;
    worker->level = (struct sample_range){0, 0};
    return final ? LEVEL_FINAL : whole ? LEVEL_DONE : LEVEL_BROKEN;
}

/* The state of the tile tells others what has happened. */
static void report_level(struct renderer *renderer, struct worker *worker, uint32_t tile, enum level_end end,
                         uint32_t samples) {
    if (end == LEVEL_FINAL)
        renderer_measure_layers(renderer, worker, tile);
    if (end == LEVEL_DONE)
        atomic_store_explicit(&renderer->job->film->tiles[tile], state_after(samples, renderer->pass.end),
                              memory_order_release);
    else
        renderer_end_tile(renderer, tile, end == LEVEL_FINAL);
}

/* False: it gets no more levels. */
static bool make_level(struct renderer *renderer, struct worker *worker, uint32_t tile) {
    uint32_t *samples = &renderer->levels.samples[tile];
    /* Who reads samples that follow sees that state: no store moves before an exchange. */
    (void)atomic_exchange(&renderer->job->film->tiles[tile], FILM_TILE_TAKEN);
    enum level_end end = sample_level(renderer, worker, tile, samples);
    report_level(renderer, worker, tile, end, *samples);
    return end == LEVEL_DONE;
}

/* An item for each tile and each level that there may be. */
static void level_item(void *context, uint32_t item, int index) {
    struct renderer *renderer = context;
    struct worker *worker = &renderer->workers[index];
    uint32_t position;
    (void)item;
    if (take_tile(renderer, worker, &position))
        put_back(renderer, position, !make_level(renderer, worker, renderer->order[position]));
}

bool renderer_make_levels(struct renderer *renderer) {
    const struct film *film = renderer->job->film;
    struct sample_levels *levels = &renderer->levels;
    uint32_t rounds = 0, limit = renderer->pass.end, count = film_tile_count(film);
    for (uint32_t samples = 0; samples < limit; samples = noise_next_level(samples, limit))
        rounds++;
    for (uint32_t position = 0; position < count; position++) {
        uint8_t state = atomic_load_explicit(&film->tiles[renderer->order[position]], memory_order_relaxed);
        if (state == FILM_TILE_WANTED || film_tile_is_begun(state))
            put(levels, (struct waiting_tile){HUGE_VAL, position});
    }
    (void)pthread_mutex_init(&levels->mutex, NULL);
    bool whole = pool_run(renderer->pool, count * rounds, level_item, renderer);
    (void)pthread_mutex_destroy(&levels->mutex);
    return whole;
}

/* --- in a farm --- */

/* Processor seconds of a tile for each thread of the farm, in which the first rank can pass on a tile. */
static const double farm_pause = 0.004;
/* When so much is left, relative to what is done, ranks may wait for the longest tile. */
static const double farm_end_share = 0.1;

static_assert(sizeof(struct noise_tile) <= sizeof((struct film_level *)0)->known, "a record holds a noise_tile");

static void load_record(struct renderer *renderer, uint32_t tile) {
    const struct film_level *level = &renderer->job->film->levels[tile];
    struct noise_tile *of_tile = &renderer->noise_estimate.tiles[tile];
    memcpy(of_tile, level->known, sizeof *of_tile);
    if (of_tile->history.last.samples == 0) /* its samples come from a checkpoint */
        of_tile->before = atomic_load_explicit(&level->samples, memory_order_relaxed);
}

static void store_record(struct renderer *renderer, uint32_t tile) {
    struct film_level *level = &renderer->job->film->levels[tile];
    const struct noise_tile *of_tile = &renderer->noise_estimate.tiles[tile];
    memcpy(level->known, of_tile, sizeof *of_tile);
    level->urgency = of_tile->urgency;
    sum_store(&level->cost, of_tile->cost);
    sum_store(&level->rest, sum_load(&of_tile->rest));
    sum_store(&level->begun, 0);
}

void renderer_make_farm_levels(struct renderer *renderer, struct worker *worker, uint32_t tile) {
    struct film_level *level = &renderer->job->film->levels[tile];
    uint64_t begun = clock_nanoseconds(CLOCK_THREAD_CPUTIME_ID);
    uint32_t samples = atomic_load_explicit(&level->samples, memory_order_relaxed);
    enum level_end end;
    /* A checkpoint has more samples if the script states another limit than before. These are made again, all at once:
     * the first rank would not take fewer samples than it has. */
    bool again = samples >= renderer->pass.end;
    if (again)
        atomic_store_explicit(&level->samples, samples = 0, memory_order_relaxed);
    load_record(renderer, tile);
    do {
        end = sample_level(renderer, worker, tile, &samples);
        store_record(renderer, tile);
        atomic_store_explicit(&level->samples, end == LEVEL_BROKEN ? 0 : samples, memory_order_relaxed);
    } while (
        end == LEVEL_DONE && !renderer_is_done(renderer) &&
        (again || 1e-9 * (double)(clock_nanoseconds(CLOCK_THREAD_CPUTIME_ID) - begun) < farm_pause * level->threads));
    if (end == LEVEL_BROKEN)
        memset(level, 0, sizeof *level);
    report_level(renderer, worker, tile, end, samples);
}

/* What the records say of all tiles that get samples in this run. */
struct farm_totals {
    double cost, rest, begun, longest; /* longest: the largest rest of a tile */
    double pixels, pixels_sampled;     /* of all tiles, and of those that got samples */
    uint32_t threads;
};

static void add_record(const struct film *film, uint32_t tile, struct farm_totals *totals) {
    const struct film_level *level = &film->levels[tile];
    struct film_rectangle r = film_tile_rectangle(film, tile);
    double pixels = (double)(r.x1 - r.x0) * (r.y1 - r.y0), cost = sum_load(&level->cost), rest = sum_load(&level->rest);
    bool sampled = cost > 0; /* in this run */
    if (!sampled && atomic_load_explicit(&film->tiles[tile], memory_order_relaxed) == FILM_TILE_DONE)
        return; /* it comes from a checkpoint */
    totals->pixels += pixels;
    if (!sampled)
        return;
    totals->pixels_sampled += pixels;
    totals->cost += cost;
    totals->rest += rest;
    totals->begun += sum_load(&level->begun);
    totals->longest = fmax(totals->longest, rest);
    uint32_t threads = atomic_load_explicit(&level->threads, memory_order_relaxed);
    totals->threads = threads > totals->threads ? threads : totals->threads;
}

/* As noise_estimate_work. */
struct time_estimate_work renderer_farm_work(const struct renderer *renderer) {
    const struct film *film = renderer->job->film;
    struct farm_totals totals = {0};
    for (uint32_t tile = 0; tile < film_tile_count(film); tile++)
        add_record(film, tile, &totals);
    if (!(totals.pixels_sampled > 0))
        return (struct time_estimate_work){0, 1};
    double done = totals.cost, begun = totals.begun, unsampled = totals.pixels - totals.pixels_sampled;
    double left = (done + totals.rest) / totals.pixels_sampled * unsampled + totals.rest - begun;
    if (totals.threads > 1 && left < farm_end_share * done)
        left = fmax(left, totals.threads * totals.longest - begun);
    return (struct time_estimate_work){done + begun, fmax(left, 0)};
}

uint32_t render_level_samples(const struct film *film, uint32_t tile, uint32_t limit) {
    if (!film_record_equal(film->record, path_film_record(path_film_parts(film->record))))
        return 0;
    struct film_rectangle r = film_tile_rectangle(film, tile);
    uint32_t all = 0, level = 0;
    for (uint32_t y = r.y0; y < r.y1; y++) {
        for (uint32_t x = r.x0; x < r.x1; x++) {
            uint32_t samples = path_film_load(film, (size_t)(y - film->y0) * film->width + (x - film->x0)).samples;
            if (all > 0 && samples != all)
                return 0;
            all = samples;
        }
    }
    while (level < all && level < limit)
        level = noise_next_level(level, limit);
    return level == all && all < limit ? all : 0;
}

/* Where a checkpoint has samples of tiles. */
static void find_begun_tiles(struct renderer *renderer) {
    struct film *film = renderer->job->film;
    for (uint32_t tile = 0; tile < film_tile_count(film); tile++) {
        uint8_t state = atomic_load_explicit(&film->tiles[tile], memory_order_relaxed);
        if (!film_tile_is_begun(state))
            continue;
        uint32_t samples = renderer->levels.wanted ? render_level_samples(film, tile, renderer->pass.end) : 0;
        if (samples > 0)
            renderer->levels.samples[tile] = samples;
        else
            atomic_store_explicit(&film->tiles[tile], FILM_TILE_WANTED, memory_order_relaxed);
    }
}

bool renderer_order_levels(struct renderer *renderer) {
    const struct render_job *job = renderer->job;
    uint32_t count = film_tile_count(job->film);
    struct sample_levels *levels = &renderer->levels;
    levels->wanted = job->settings.noise > 0 && renderer->pass.end > 0 && !renderer_makes_passes(renderer);
    if (levels->wanted) {
        levels->samples = mem_alloc_zero((size_t)count + 1, sizeof *levels->samples);
        levels->waiting = mem_alloc_zero((size_t)count + 1, sizeof *levels->waiting);
        if (!levels->samples || !levels->waiting ||
            !noise_estimate_create(&renderer->noise_estimate, count,
                                   noise_limits_for(job->settings.noise, renderer->pass.end),
                                   pool_workers(renderer->pool)))
            return false;
    }
    if (!job->handout)
        find_begun_tiles(renderer);
    if (levels->wanted)
        renderer_expect_levels(renderer);
    return true;
}
