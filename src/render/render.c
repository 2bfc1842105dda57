/* Tiles, handed out to the workers; the integrator renders the pixels of a tile. A tile is self-contained and final
 * when it is done. There is no barrier, and only the film is shared: every tile writes its own pixels. */
#include "base/clock.h"
#include "render/aov_values_internal.h"
#include "render/integrator.h"
#include "render/integrator_internal.h"
#include "render/media_light_internal.h"

#include "base/mem.h"
#include "denoise/film_denoise.h"
#include "expr/expr_field.h"
#include "film/aov.h"
#include "film/film.h"
#include "film/path_film.h"
#include "material/fog_field.h"
#include "render/path_noise_internal.h"
#include "render/pixel_trace.h"
#include "render/sample_internal.h"
#include "settings/settings.h"

#include <math.h>
#include <stdatomic.h>
#include <string.h>

/* The cost of a tile, from few rays: the number of hits and of secondary rays, which does not depend on the accelerator
 * or the instruction set. */
enum { COST_SAMPLES = 4 };

static void cost_item(void *context, uint32_t item, int index) {
    struct renderer *renderer = context;
    struct worker *worker = &renderer->workers[index];
    struct film_rectangle r = film_tile_rectangle(renderer->job->film, item);
    struct integrator_state *state = &worker->state;
    uint64_t before = state->hits + state->reflected_rays + state->refracted_rays;
    /* With many shards fewer rays per tile: each shard samples all tiles. */
    uint32_t count = renderer->job->shards <= 16 ? COST_SAMPLES : 1;
    for (uint32_t i = 0; i < count && !renderer_stopped(renderer, worker); i++) {
        uint32_t x = r.x0 + (r.x1 - r.x0) * (2 * i + 1) / (2 * count);
        uint32_t y = r.y0 + (r.y1 - r.y0) * ((2 * i + 1) * 3 % (2 * count)) / (2 * count);
        struct pixel_sample position = renderer_first_sample(renderer, x, y);
        (void)renderer_sample(renderer, worker, &position);
    }
    renderer->cost[item] = 1 + state->hits + state->reflected_rays + state->refracted_rays - before;
}

/* Marks what other shards make. */
static bool choose_tiles(struct renderer *renderer, struct error *error) {
    struct film *film = renderer->job->film;
    uint32_t count = film_tile_count(film);
    if (renderer->job->shards <= 1)
        return true;
    renderer->cost = mem_alloc_zero(count, sizeof *renderer->cost);
    if (!renderer->cost)
        return error_no_memory(error, "the tiles of a shard");
    bool looked = pool_run(renderer->pool, count, cost_item, renderer);
    bool ok = looked && shard_choose(renderer->cost, film, renderer->job->shard, renderer->job->shards);
    mem_free(renderer->cost);
    renderer->cost = NULL;
    if (!looked)
        return error_set(error, ERROR_CANCELLED, "stopped while rendering");
    return ok || error_no_memory(error, "the tiles of a shard");
}

bool renderer_is_done(const struct renderer *renderer) {
    return renderer->job->drain && atomic_load_explicit(renderer->job->drain, memory_order_relaxed) != 0;
}

/* Makes a tile or a part of it. False: stopped. A cancelled ray leaves a wrong colour, so a tile that ends after a
 * request to stop counts as not done. */
static bool make_part(struct renderer *renderer, struct worker *worker, uint32_t tile, struct film_rectangle part,
                      double share) {
    renderer_tile_begins(renderer, worker, tile, share);
    bool whole = integrator_render(renderer, worker, &part) && !renderer_stopped(renderer, worker);
    if (worker->scratch.failed) {
        atomic_store(&renderer->failed, true);
        pool_cancel(renderer->pool);
    }
    worker->tile_ended = clock_now();
    if (whole)
        renderer_tile_ends(renderer, worker);
    return whole;
}

/* The tile is done, and is reported; or it is not whole and still wanted, unless it has samples that are kept. */
static void end_tile(struct renderer *renderer, uint32_t tile, bool whole) {
    struct film *film = renderer->job->film;
    uint8_t taken = FILM_TILE_TAKEN;
    if (whole)
        atomic_store_explicit(&film->tiles[tile], FILM_TILE_DONE, memory_order_release);
    else
        (void)atomic_compare_exchange_strong(&film->tiles[tile], &taken, FILM_TILE_WANTED);
    if (whole && renderer->job->tile_done) {
        uint32_t done = atomic_fetch_add(&renderer->done, 1) + 1;
        renderer->job->tile_done(renderer->job->context, tile, done, renderer->tiles_wanted);
    }
}

/* --- the work --- */

/* So many of the last tiles of the order are rendered in quarters, so that no thread waits long for the last tile of
 * another: a share of all tiles. */
enum { TAIL_SHARE = 16 };
/* A request to stop is noticed so soon while a worker waits, in seconds. */
static const double work_patience = 0.01;

/* Whether the item is to be made. The first worker of a tile takes it; once it is begun, its other quarters are
 * finished even while draining. Passes take tiles again. */
static bool claim(struct renderer *renderer, const struct work_item *item, uint8_t *before) {
    _Atomic uint8_t *state = &renderer->job->film->tiles[item->tile];
    uint8_t wanted = FILM_TILE_WANTED;
    *before = atomic_load(state);
    if (item->quarter != WORK_WHOLE && *before == FILM_TILE_TAKEN)
        return true;
    if (renderer_is_done(renderer))
        return false;
    if (renderer->pass.open)
        return *before == FILM_TILE_WANTED || *before >= FILM_TILE_PASSED;
    if (atomic_compare_exchange_strong(state, &wanted, FILM_TILE_TAKEN))
        return true;
    return item->quarter == WORK_WHOLE ? film_tile_is_begun(wanted) : wanted == FILM_TILE_TAKEN;
}

/* The item is made, or not whole; before: the state of its tile. */
static enum work_result end_item(struct renderer *renderer, const struct work_item *item, bool whole, uint8_t before) {
    if (!renderer->pass.open)
        return whole ? WORK_DONE : WORK_FAILED;
    uint8_t after = (uint8_t)(FILM_TILE_PASSED + renderer->pass.number % FILM_PASSES);
    atomic_store_explicit(&renderer->job->film->tiles[item->tile], whole ? after : before, memory_order_release);
    return WORK_SKIPPED; /* the tile ends after the last pass */
}

static double area(struct film_rectangle r) {
    return (double)(r.x1 - r.x0) * (r.y1 - r.y0);
}

static enum work_result make_item(struct renderer *renderer, struct worker *worker, const struct work_item *item) {
    struct film *film = renderer->job->film;
    struct film_rectangle tile = film_tile_rectangle(film, item->tile), r = work_item_part(tile, item);
    uint8_t before;
    if (!claim(renderer, item, &before))
        return WORK_SKIPPED;
    worker->tile_state = item->quarter == WORK_WHOLE && !renderer->pass.open ? &film->tiles[item->tile] : NULL;
    const double begun = clock_now();
    bool whole = !(area(r) > 0) || make_part(renderer, worker, item->tile, r, area(r) / area(tile));
    if (whole && area(r) > 0)
        atomic_store_explicit(&renderer->pace.seconds, (clock_now() - begun) * area(tile) / area(r),
                              memory_order_relaxed);
    return end_item(renderer, item, whole, before);
}

static void give_back(struct renderer *renderer, const struct work_item *item, enum work_result result) {
    result = work_queue_give_back(&renderer->queue, item, result);
    if (result != WORK_SKIPPED)
        end_tile(renderer, item->tile, result == WORK_DONE);
}

/* --- a device, and threads beside it --- */

/* The number of workers that wait for the device. */
static uint32_t waiting_workers(const struct renderer *renderer) {
    uint32_t count = 0;
    for (int i = 0; i < renderer->worker_count; i++)
        count += renderer->workers[i].for_device != NULL;
    return count;
}

/* So many tiles at once that a card is full, with the one that is taken; fewer towards the end, so that all workers have
 * some. */
static uint32_t tiles_at_once(struct renderer *renderer) {
    static const double paths = 1 << 22;
    const struct path_device *device = renderer->job->device;
    const double samples = renderer->pass.end - renderer->pass.begin;
    const double share = (work_queue_left(&renderer->queue) + 1) / waiting_workers(renderer);
    const double count = math_min(share, paths / (samples * FILM_TILE * FILM_TILE));
    return (uint32_t)math_max(math_min(count, device->tiles > 0 ? device->tiles : PATH_ORDERS), 1);
}

/* Takes items; those that are not to be made, or are empty, are given back at once. */
static enum work_answer take_for_device(struct renderer *renderer, struct device_work *work) {
    enum work_answer answer = WORK_HERE;
    uint32_t limit = 1;
    work->count = 0;
    while (answer == WORK_HERE && work->count < limit) {
        struct work_item *item = &work->taken[work->count].item;
        uint8_t *before = &work->taken[work->count].before;
        answer = work_queue_take(&renderer->queue, work->count == 0 ? work_patience : 0, item);
        if (answer != WORK_HERE)
            continue;
        limit = limit > 1 ? limit : tiles_at_once(renderer);
        work->parts[work->count] = work_item_part(film_tile_rectangle(renderer->job->film, item->tile), item);
        if (!claim(renderer, item, before))
            give_back(renderer, item, WORK_SKIPPED);
        else if (!(area(work->parts[work->count]) > 0))
            give_back(renderer, item, end_item(renderer, item, true, *before));
        else
            work->count++;
    }
    return answer;
}

static enum work_answer work_for_device(struct renderer *renderer, struct worker *worker) {
    struct device_work *work = worker->for_device;
    const enum work_answer answer = take_for_device(renderer, work);
    const uint32_t count = work->count;
    const double begun = clock_now();
    if (count == 0)
        return answer;
    /* While a worker has items, the pass stays. */
    const struct sample_pass *pass = &renderer->pass;
    const double share = (pass->end - pass->begin) / (double)(pass->open ? pass->limit : pass->end);
    atomic_fetch_add(&renderer->pace.taken, count);
    const bool whole = integrator_render_by_device(renderer, worker) && !renderer_stopped(renderer, worker);
    if (worker->scratch.failed) {
        atomic_store(&renderer->failed, true);
        pool_cancel(renderer->pool);
    }
    worker->tile_ended = clock_now();
    atomic_fetch_add(&renderer->pace.made, count);
    for (uint32_t i = 0; i < count; i++) {
        const struct work_item *item = &work->taken[i].item;
        const struct film_rectangle tile = film_tile_rectangle(renderer->job->film, item->tile);
        if (whole)
            renderer_tile_was_made(renderer, item->tile, share * area(work_item_part(tile, item)) / area(tile),
                                   (worker->tile_ended - begun) / count);
        give_back(renderer, item, end_item(renderer, item, whole, work->taken[i].before));
    }
    return WORK_HERE;
}

static void begin_pace(struct renderer *renderer, double now) {
    struct device_pace *pace = &renderer->pace;
    atomic_store(&pace->begun, now);
    atomic_store(&pace->taken, 0);
    atomic_store(&pace->made, 0);
    atomic_store(&pace->seconds, 0);
}

/* Whether the device will have made all that is left before a thread would have made one more tile. */
static bool is_left_to_device(struct renderer *renderer) {
    const struct device_pace *pace = &renderer->pace;
    const uint32_t made = atomic_load(&pace->made), taken = atomic_load(&pace->taken);
    const double left = work_queue_left(&renderer->queue), passed = clock_now() - atomic_load(&pace->begun);
    return made > 0 && left > 0 && atomic_load(&pace->seconds) > (left + taken - made) * passed / made;
}

/* A pool_function: a worker, until the work is over. */
static void work(void *context, uint32_t item, int index) {
    struct renderer *renderer = context;
    struct worker *worker = &renderer->workers[index];
    const bool takes_many = worker->for_device && !(renderer->job->settings.noise > 0);
    (void)item;
    for (enum work_answer answer = WORK_LATER; answer != WORK_OVER && !renderer_stopped(renderer, worker);) {
        struct work_item taken;
        const uint32_t seen = atomic_load(&renderer->queue.event->signals);
        if (takes_many) {
            answer = work_for_device(renderer, worker);
        } else if (!worker->for_device && is_left_to_device(renderer)) {
            pool_wait(renderer->queue.event, seen, work_patience);
        } else {
            answer = work_queue_take(&renderer->queue, work_patience, &taken);
            if (answer == WORK_HERE)
                give_back(renderer, &taken, make_item(renderer, worker, &taken));
        }
        pool_poll(renderer->pool, index);
    }
}

/* In a farm: the tiles that are wanted now. The state is read before them, so that none is missed at the end. */
static enum work_answer find_handed_out(void *context, struct work_queue *queue) {
    struct renderer *renderer = context;
    const struct film *film = renderer->job->film;
    bool open = atomic_load(renderer->job->handout) == 1;
    uint32_t found = 0;
    for (uint32_t tile = 0; tile < film_tile_count(film) && !renderer_is_done(renderer); tile++) {
        if (atomic_load_explicit(&film->tiles[tile], memory_order_relaxed) == FILM_TILE_WANTED)
            renderer->order[found++] = tile;
    }
    if (found == 0)
        return open && !renderer_is_done(renderer) ? WORK_LATER : WORK_OVER;
    work_queue_set(queue, renderer->order, found, 0);
    return WORK_HERE;
}

/* False: stopped. */
static bool do_work(struct renderer *renderer, struct render_statistics *statistics) {
    struct work_queue *queue = &renderer->queue;
    int workers = pool_workers(renderer->pool);
    double begun = clock_now();
    for (int i = 0; i < workers; i++)
        renderer->workers[i].tile_ended = begun;
    work_queue_begin(queue);
    begin_pace(renderer, begun);
    const int waiting = renderer->worker_count - workers;
    struct pool_threads *threads = waiting > 0 && renderer->workers[workers].for_device
                                       ? pool_threads_start((uint32_t)waiting, workers, work, renderer)
                                       : NULL;
    bool whole = pool_run(renderer->pool, (uint32_t)workers, work, renderer);
    pool_threads_join(threads);
    whole = whole && !pool_cancelled(renderer->pool);
    work_queue_destroy(queue);
    double ended = clock_now();
    for (uint32_t i = 0; i < queue->tail && !whole; i++) { /* those of which quarters are missing */
        uint8_t taken = FILM_TILE_TAKEN;
        (void)atomic_compare_exchange_strong(&renderer->job->film->tiles[queue->tiles[queue->whole + i]], &taken,
                                             FILM_TILE_WANTED);
    }
    for (int i = 0; i < workers; i++)
        statistics->idle_seconds += ended - renderer->workers[i].tile_ended;
    return whole;
}

/* The first one of a mask. */
static enum aov path_layer(uint32_t mask) {
    int i = 0;
    while (!((mask & AOV_PATH) >> i & 1))
        i++;
    return (enum aov)i;
}

bool render_prepare(struct render_job *job, struct render_area *area, char warning[256], struct error *error) {
    static const char *const integrators[] = {INTEGRATORS(LIST_WORD)};
    const struct settings *s = &job->settings;
    struct camera_frame frame;
    char ignored[256];
    if (!renderer_prepare_at(job, 0, &frame, warning, error) || !renderer_prepare_at(job, 1, &frame, ignored, error))
        return false;
    /* What the integrator cannot make. */
    if (!integrator_traits(s->integrator).has_light_parts && s->aov & AOV_PATH && s->aov != AOV_ALL)
        return error_set(error, ERROR_USAGE, "--aov %s is a layer of --integrator path only",
                         aov_name(path_layer(s->aov)));
    if (settings_exclude(s))
        return error_set(error, ERROR_SCENE,
                         "styles are for the integrator 'whitted', not for '%s'; --line-width draws lines over its "
                         "pictures",
                         integrators[s->integrator]);
    *area = (struct render_area){0, 0, job->width, job->height};
    if (!s->cropped)
        return true;
    /* Without sums, which could overflow. */
    if (s->crop_x < 0 || s->crop_y < 0 || s->crop_width < 1 || s->crop_height < 1 || s->crop_x >= (int64_t)job->width ||
        s->crop_width > (int64_t)job->width - s->crop_x || s->crop_y >= (int64_t)job->height ||
        s->crop_height > (int64_t)job->height - s->crop_y)
        return error_set(error, ERROR_USAGE, "--crop %lld,%lld,%lld,%lld does not lie inside the picture of %u x %u",
                         (long long)s->crop_x, (long long)s->crop_y, (long long)s->crop_width,
                         (long long)s->crop_height, job->width, job->height);
    *area = (struct render_area){(uint32_t)s->crop_x, (uint32_t)s->crop_y, (uint32_t)s->crop_width,
                                 (uint32_t)s->crop_height};
    return true;
}

static void add_statistics(const struct renderer *renderer, int workers, struct render_statistics *out) {
    out->noisy = renderer->job->settings.noise > 0 && atomic_load(&renderer->unsatisfied);
    out->out_of_time = out->out_of_time && out->noisy;
    for (int i = 0; i < workers; i++) {
        const struct worker *worker = &renderer->workers[i];
        out->camera_rays += worker->camera_rays;
        out->reflected_rays += worker->state.reflected_rays;
        out->refracted_rays += worker->state.refracted_rays;
        out->shadow_rays += worker->state.shadow_rays;
        out->medium_events += worker->state.medium_events;
        out->shape_tests += worker->scratch.geom.shape_tests;
        out->triangle_tests += worker->scratch.geom.cost.triangle_tests;
        out->voxels += worker->scratch.geom.cost.voxels;
        out->hierarchy_steps += worker->scratch.geom.cost.hierarchy_steps;
        out->box_tests += worker->scratch.geom.box_tests;
    }
    integrator_add_statistics(renderer, out);
    out->samples = out->camera_rays;
    out->pixels += (uint64_t)renderer->job->film->width * renderer->job->film->height;
}

static bool start_workers(struct renderer *renderer, int workers) {
    renderer->worker_count = workers;
    renderer->workers = mem_alloc_zero((size_t)workers, sizeof *renderer->workers);
    if (!renderer->workers)
        return false;
    bool dims = media_dim_lights(renderer->job->world);
    for (int i = 0; i < workers; i++) {
        struct worker *worker = &renderer->workers[i];
        if (!world_scratch_init(&worker->scratch, renderer->job->world))
            return false;
        worker->index = i;
        worker->state = (struct integrator_state){.job = renderer->job,
                                                  .pool = renderer->pool,
                                                  .scratch = &worker->scratch,
                                                  .eye_medium_stack = &renderer->eye_medium_stack,
                                                  .media_dim = dims};
    }
    return true;
}

static void count_tiles(struct renderer *renderer) {
    const struct film *film = renderer->job->film;
    uint32_t done = film_tiles_in(film, FILM_TILE_DONE);
    renderer->tiles_wanted = film_tile_count(film) - film_tiles_in(film, FILM_TILE_ELSEWHERE);
    atomic_store(&renderer->done, done);
}

/* The solids that may contain ray origins, and whether each ray needs its own query. */
static bool find_eye_medium_stack(struct renderer *renderer, const struct box *origins, bool spread) {
    const struct world *world = renderer->job->world;
    renderer->closed_count = world->first_solid ? world_closed_in(world, origins, NULL, 0) : 0;
    renderer->closed = mem_alloc_zero((size_t)renderer->closed_count + 1, sizeof *renderer->closed);
    if (!renderer->closed)
        return false;
    if (renderer->closed_count > 0)
        (void)world_closed_in(world, origins, renderer->closed, renderer->closed_count);
    renderer->medium_stack_by_ray = renderer->closed_count > 0 && spread;
    renderer->together = camera_is_plain(&renderer->camera) && !renderer->timed && !renderer->medium_stack_by_ray;
    world_medium_stack(world, &(struct inside_query){renderer->camera.eye, 0, renderer->closed, renderer->closed_count},
                       &renderer->workers[0].scratch, &renderer->eye_medium_stack);
    return !renderer->workers[0].scratch.failed;
}

/* Whether a function of a script does. */
static bool reads_time(const struct render_job *job) {
    const struct world *world = job->world;
    const struct fog *fog = world_outside(world)->fog;
    const struct fog_field *field = fog ? fog->field : NULL;
    const struct expr_program *colour = field ? fog_field_colour(field) : NULL;
    bool reads = field && (expr_field_reads(fog_field_density(field), EXPR_TIME) ||
                           (colour && expr_field_reads(colour, EXPR_TIME)));
    for (uint32_t i = 0; !reads && i < world->surfaces.textures.count; i++)
        reads = world->surfaces.textures.operations[i].kind == TEXTURE_FUNCTION &&
                expr_field_reads(world->surfaces.textures.operations[i].recorded.program, EXPR_TIME);
    return reads;
}

static bool prepare_rendering(struct renderer *renderer, const struct camera_frame *at_close) {
    const struct render_job *job = renderer->job;
    const struct shutter *shutter = &job->settings.shutter;
    renderer->timed =
        shutter->close > shutter->open && (job->world->moves || job->settings.motion.moves || reads_time(job));
    struct box origins = box_join(camera_origins(&renderer->camera), camera_origins(at_close));
    return find_eye_medium_stack(renderer, &origins, renderer->timed || camera_spreads(&renderer->camera));
}

/* Everything before the first tile. */
static bool begin_rendering(struct renderer *renderer, int workers, struct render_statistics *statistics,
                            struct error *error) {
    char warning[256];
    struct camera_frame at_close;
    if (!renderer_prepare_at(renderer->job, 0, &renderer->camera, warning, error) ||
        !renderer_prepare_at(renderer->job, 1, &at_close, warning, error))
        return false;
    if (!start_workers(renderer, workers) || !prepare_rendering(renderer, &at_close))
        return error_no_memory(error, "the workers of a render");
    return integrator_create(renderer, workers, statistics, error);
}

static void end_rendering(struct renderer *renderer, int workers) {
    for (int i = 0; renderer->workers && i < workers; i++) {
        struct worker *worker = &renderer->workers[i];
        if (worker->for_device)
            mem_free(worker->for_device->pixels);
        mem_free(worker->for_device);
        world_scratch_destroy(&worker->scratch);
    }
    integrator_destroy(renderer->integrator);
    mem_free(renderer->workers);
    mem_free(renderer->closed);
    mem_free(renderer->order);
    mem_free(renderer->time_estimate.tiles);
}

/* The part is one pixel. */
static bool record_pixel(struct renderer *renderer, struct film *film, struct pixel_trace *pixel_trace,
                         struct error *error) {
    struct worker *worker = &renderer->workers[0];
    struct film_rectangle tile = {pixel_trace->x, pixel_trace->y, pixel_trace->x + 1, pixel_trace->y + 1};
    film->x0 = pixel_trace->x;
    film->y0 = pixel_trace->y;
    worker->state.observer = &pixel_trace->observer;
    if (!integrator_render(renderer, worker, &tile) || renderer_stopped(renderer, worker))
        return worker->scratch.failed ? error_no_memory(error, "the crossings of a ray")
                                      : error_set(error, ERROR_CANCELLED, "stopped while rendering");
    return !pixel_trace->failed || error_no_memory(error, "the trace of a pixel");
}

bool render_pixels(const struct render_job *job, struct pool *pool, struct pixel_list pixels,
                   pixel_trace_listener *listen, void *context, struct error *error) {
    struct film_pixel pixel = {0};
    float floats[FILM_RECORD_FLOATS] = {0};
    uint8_t marked = 0;
    struct film film = {.width = 1,
                        .height = 1,
                        .full_width = job->width,
                        .full_height = job->height,
                        .record = render_record(&job->settings),
                        .pixels = &pixel,
                        .floats = floats,
                        .marked = &marked};
    struct render_job own = *job;
    struct render_statistics statistics = {0};
    struct renderer renderer = {.job = &own, .pool = pool, .roams = true};
    own.film = &film;
    own.settings.show_refined = false;
    bool ok = begin_rendering(&renderer, pool_workers(pool), &statistics, error);
    renderer.together = false; /* each sample is reported on its own */
    for (uint32_t i = 0; ok && i < pixels.count; i++) {
        struct pixel_trace pixel_trace;
        pixel_trace_init(&pixel_trace, pixels.at[i][0], pixels.at[i][1]);
        ok = record_pixel(&renderer, &film, &pixel_trace, error) && listen(context, &pixel_trace, error);
        pixel_trace_destroy(&pixel_trace);
    }
    end_rendering(&renderer, pool_workers(pool));
    return ok;
}

/* Tiles of a checkpoint that have samples (--noise): they go on if these are of use, else they begin again. */
static void find_begun_tiles(const struct renderer *renderer) {
    struct film *film = renderer->job->film;
    bool keeps = renderer->job->settings.noise > 0 && renderer->pass.end > 0 && !renderer_makes_passes(renderer);
    for (uint32_t tile = 0; tile < film_tile_count(film); tile++) {
        if (film_tile_is_begun(atomic_load_explicit(&film->tiles[tile], memory_order_relaxed)) &&
            !(keeps && path_samples_kept(film, film_tile_rectangle(film, tile), renderer->pass.end)))
            atomic_store_explicit(&film->tiles[tile], FILM_TILE_WANTED, memory_order_relaxed);
    }
}

/* The whole picture in its order, or, in a farm, those tiles that are begun: the others follow when they are handed
 * out. False: no memory. */
static bool plan_work(struct renderer *renderer) {
    const struct render_job *job = renderer->job;
    const struct film *film = job->film;
    uint32_t count = film_tile_count(film), tail = (count + TAIL_SHARE - 1) / TAIL_SHARE, begun = 0;
    renderer->order = mem_alloc_zero(count, sizeof *renderer->order);
    if (!renderer->order || !film_tile_order(film, job->settings.tile_order, renderer->order))
        return false;
    find_begun_tiles(renderer);
    if (job->handout) {
        for (uint32_t tile = 0; tile < count; tile++) {
            if (film_tile_is_begun(atomic_load(&film->tiles[tile])))
                renderer->order[begun++] = tile;
        }
        renderer->queue = (struct work_queue){.event = job->handed, .more = find_handed_out, .context = renderer};
        work_queue_set(&renderer->queue, renderer->order, begun, 0);
        return true;
    }
    tail = tail < WORK_TAIL ? tail : WORK_TAIL;
    if (job->settings.noise > 0 || renderer_makes_passes(renderer)) /* the noise of the whole tile decides */
        tail = 0;
    work_queue_set(&renderer->queue, renderer->order, count - tail, tail);
    return true;
}

static bool is_unfinished(const struct renderer *renderer) {
    const struct film *film = renderer->job->film;
    return film_tiles_in(film, FILM_TILE_DONE) + film_tiles_in(film, FILM_TILE_ELSEWHERE) < film_tile_count(film);
}

/* A displayed picture is denoised when it has all samples; without memory for that it stays unchanged. A part of a
 * shard is not denoised because it lacks its neighbours. False: stopped. */
static bool show_denoised(struct renderer *renderer) {
    struct film *film = renderer->job->film;
    struct error error = {0};
    if (!renderer->job->settings.passes || !settings_denoise(&renderer->job->settings) ||
        !(path_film_parts(film->record) & PATH_PART_FEATURES) || film_tiles_in(film, FILM_TILE_ELSEWHERE) > 0)
        return true;
    return film_show_denoised(film, renderer->pool, &error) || error.kind != ERROR_CANCELLED;
}

/* Passes over the picture: every pass adds samples to all pixels, so that something is to be seen soon, and the time
 * can decide how many samples there will be. A pixel's samples are numbered and added in order (path_film.h):
 * the picture has the bytes of one that got them all in one go.
 *
 * The first pass has one sample, and each further one at most as many as all before it. */

static const double shown_every = 1; /* seconds; a pass of a picture that is looked at takes about that */

bool renderer_makes_passes(const struct renderer *renderer) {
    const struct settings *settings = &renderer->job->settings;
    return renderer->pass.end > 0 && (settings->passes || settings->time_limit > 0);
}

/* Seconds until the time is over. */
static double time_left(const struct renderer *renderer, double now) {
    double limit = renderer->job->settings.time_limit;
    return limit > 0 ? limit - (now - renderer->begun) : HUGE_VAL;
}

/* How many samples the next pass has: with a limit no more than half of the time left, so that the last passes are
 * short ones and end near it. second: seconds that one sample of all pixels takes. */
static uint32_t next_samples(const struct renderer *renderer, uint32_t limit, double seconds, double now) {
    uint32_t done = renderer->pass.end, left = limit - done;
    double fitting = time_left(renderer, now) / 2 / seconds;
    if (renderer->job->settings.passes)
        fitting = math_min(fitting, shown_every / seconds);
    uint32_t count = done < left ? done : left;
    return fitting < (double)count ? (uint32_t)math_max(fitting, 1) : count;
}

/* The next pass, when all workers have ended the one before. */
static enum work_answer next_pass(void *context, struct work_queue *queue) {
    struct renderer *renderer = context;
    struct sample_pass *pass = &renderer->pass;
    double now = clock_now();
    double seconds = math_max((now - renderer->passes_begun) / (pass->end - renderer->job->kept_samples), 1e-9);
    if (queue->out > 0)
        return WORK_LATER;
    if (renderer_is_done(renderer) || pass->end == pass->limit || !atomic_load(&renderer->unsatisfied) ||
        time_left(renderer, now) < seconds)
        return WORK_OVER;
    uint32_t samples = next_samples(renderer, pass->limit, seconds, now);
    pass->number++;
    pass->begin = pass->end;
    pass->end += samples;
    atomic_store(&renderer->unsatisfied, false);
    begin_pace(renderer, now);
    work_queue_set(queue, queue->tiles, queue->whole, 0);
    return WORK_HERE;
}

static void begin_passes(struct renderer *renderer) {
    renderer->passes_begun = clock_now();
    uint32_t kept = renderer->job->kept_samples;
    renderer->pass = (struct sample_pass){.limit = renderer->pass.end, .begin = kept, .end = kept + 1, .open = true};
    renderer->queue.more = next_pass;
    renderer->queue.context = renderer;
}

/* All passes are made. */
static void end_passes(struct renderer *renderer) {
    struct film *film = renderer->job->film;
    for (uint32_t tile = 0; tile < film_tile_count(film); tile++) {
        if (atomic_load(&film->tiles[tile]) >= FILM_TILE_PASSED)
            end_tile(renderer, tile, true);
    }
}

static bool make_passes(struct renderer *renderer, struct render_statistics *statistics) {
    begin_passes(renderer);
    if (!do_work(renderer, statistics) || renderer_is_done(renderer))
        return false;
    statistics->passes_samples = renderer->pass.end;
    statistics->out_of_time = renderer->pass.end < renderer->pass.limit;
    bool ok = show_denoised(renderer);
    end_passes(renderer);
    return ok;
}

static bool make_tiles(struct renderer *renderer, struct render_statistics *statistics, struct error *error) {
    if (!plan_work(renderer) || !renderer_begin_estimate(renderer))
        return error_no_memory(error, "the order of the tiles");
    count_tiles(renderer);
    bool whole = renderer_makes_passes(renderer)
                     ? make_passes(renderer, statistics)
                     : do_work(renderer, statistics) && !(renderer_is_done(renderer) && is_unfinished(renderer));
    if (!atomic_load(&renderer->failed))
        return whole || error_set(error, ERROR_CANCELLED, "stopped while rendering");
    if (!whole)
        pool_reset_cancel(renderer->pool);
    return error_no_memory(error, "the crossings of a ray");
}

bool render_run(const struct render_job *job, struct pool *pool, struct render_statistics *statistics,
                struct error *error) {
    double begin = clock_now();
    struct renderer renderer = {.job = job, .pool = pool, .begun = begin};
    const bool has_device = job->device && job->settings.integrator == INTEGRATOR_PATH;
    int workers = pool_workers(pool) + (has_device ? (int)job->device->waiting : 0);
    bool ok = begin_rendering(&renderer, workers, statistics, error) && choose_tiles(&renderer, error) &&
              make_tiles(&renderer, statistics, error);
    if (renderer.integrator)
        add_statistics(&renderer, workers, statistics);
    if (ok && job->film->layers && !pool_run(pool, film_tile_count(job->film), renderer_layer_item, &renderer))
        ok = error_set(error, ERROR_CANCELLED, "stopped while rendering");
    if (ok && job->progress_estimate)
        progress_estimate_report(job->progress_estimate, 1, 0, clock_now());
    for (int i = 0; renderer.workers && i < workers; i++)
        statistics->clamped += renderer.workers[i].clamped || renderer.workers[i].state.clamped;
    end_rendering(&renderer, workers);
    statistics->render_seconds += clock_now() - begin;
    return ok;
}
