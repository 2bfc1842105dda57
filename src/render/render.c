/* Tiles. A tile samples its pixels and the rim of one pixel round them once (a pixel's first sample is a function of
 * the pixel alone, so two tiles that share a rim agree), marks by neighbours' differences, resamples what is marked,
 * and is final. No barrier, nothing shared but the film, of which every tile writes its own pixels. */
#include "render/render.h"

#include "base/mem.h"
#include "base/random.h"
#include "render/aov.h"
#include "render/camera.h"
#include "render/cutoff.h"
#include "render/photon_trace.h"
#include "render/shard.h"
#include "render/whitted.h"

#include <stdatomic.h>
#include <string.h>
#include <time.h>

/* Samples that are traced together: places in the picture, in the order in which they are wanted. */
struct place {
    int64_t x, y;
    double dx, dy; /* within the pixel */
    uint64_t number;
};

struct batch {
    struct place places[PACKET_RAYS];
    struct vec3 colours[PACKET_RAYS];
    uint32_t count;
    struct ray_packet packet;
    struct packet_answer answers[PACKET_RAYS];
};

struct worker {
    struct world_scratch scratch;
    struct tracer tracer;
    uint64_t camera_rays, marked, samples;
    struct media ray_media;
    struct camera_frame camera; /* of the sample's moment, when the camera moves */
    struct batch batch;
    struct vec3 first[(FILM_TILE + 2) * (FILM_TILE + 2)];
};

struct run {
    const struct render_job *job;
    struct pool *pool;
    struct camera_frame camera;
    struct media eye_media;
    /* -full, or a lens or moving things: what is blurred differs from sample to sample, not from its neighbours */
    bool full;
    bool timed;        /* something moves while the shutter is open */
    bool together;     /* camera rays start in one place and at one moment */
    bool media_by_ray; /* rays start in different places or moments, and solids are near */
    uint32_t *closed;  /* the solids that the eye can stand in */
    uint32_t closed_count;
    struct photon_map caustics;
    struct worker *workers;
    uint32_t tiles_wanted; /* of this process, those that were there before too */
    uint64_t *cost;        /* of each tile while shards are chosen */
    _Atomic uint32_t done;
    _Atomic bool failed;
};

/* A rectangle of pixels of the whole picture: x0 <= x < x1. */
struct rectangle {
    int64_t x0, y0, x1, y1;
};

static double seconds_now(void) {
    struct timespec now;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* The camera at a ray's time. */
static bool prepare_at(const struct render_job *job, double ray_time, struct camera_frame *out, char warning[256],
                       struct error *error) {
    const struct settings *settings = &job->settings;
    struct camera camera = job->camera;
    if (settings->motion.moves)
        camera = camera_at(&job->camera, &settings->motion, shutter_time(settings->shutter, ray_time));
    return camera_prepare(&camera, settings, job->width, job->height, out, warning, error);
}

static struct vec3 trace_from_eye(struct run *run, struct worker *worker, struct ray *ray, double share, uint64_t key) {
    ray->footprint.spread *= share;
    ray->footprint.width *= share;
    worker->camera_rays++;
    if (run->media_by_ray) {
        media_around(run->job->world, ray->origin, ray->time, run->closed, run->closed_count, &worker->scratch,
                     &worker->ray_media);
        worker->tracer.eye_media = &worker->ray_media;
    }
    return whitted_trace(&worker->tracer, ray, key);
}

/* Through a lens, in another projection, for two eyes. The places on the lens of a pixel's samples are parted into as
 * many cells as there are samples, visited in an order of the pixel's own, so that pixel and lens are stratified
 * together. */
static struct vec3 sample_through(struct run *run, struct worker *worker, const struct camera_frame *camera, double x,
                                  double y, double time, double share, uint64_t key) {
    const struct strata *strata = &worker->tracer.strata;
    uint32_t side = strata->side, cell = sample_turn(strata, UINT64_MAX);
    struct sample2 place = sample_cell(random_combine(strata->key, 2), cell % side, cell / side, side);
    struct ray ray, right_ray;
    bool anaglyph = camera->lens.stereo == STEREO_ANAGLYPH;
    if (!camera_ray_through(camera, x, y, place, anaglyph ? -1 : 0, &ray))
        return vec3_all(0);
    ray.time = time;
    struct vec3 colour = trace_from_eye(run, worker, &ray, share, key);
    if (!anaglyph)
        return colour;
    (void)camera_ray_through(camera, x, y, place, 1, &right_ray);
    right_ray.time = time;
    struct vec3 right = trace_from_eye(run, worker, &right_ray, share, random_combine(key, UINT64_MAX));
    return vec3_make(colour.x, right.y, right.z);
}

/* The moment of a sample, from 0 to 1: the shutter's time is parted among the samples of a pixel like the lens. */
static double sample_time(const struct strata *strata, uint64_t key) {
    uint32_t all = strata->side * strata->side, cell = sample_turn(strata, UINT64_MAX - 1);
    return ((double)cell + random_unit(random_combine(key, UINT64_MAX - 1))) / (double)all;
}

/* The random key of a sample. Number 0 is the first sample of a pixel, which stands alone; the others are number - 1 of
 * N x N. */
static uint64_t begin_sample(const struct run *run, struct worker *worker, int64_t x, int64_t y, uint64_t number) {
    uint64_t pixel = (uint64_t)y * run->job->width + (uint64_t)x;
    uint64_t key_of_pixel = random_combine(random_combine(run->job->settings.seed, 0), pixel);
    uint32_t side = number > 0 ? (uint32_t)run->job->settings.samples : 1;
    worker->tracer.strata =
        (struct strata){number > 0 ? (uint32_t)number - 1 : 0, side, random_combine(key_of_pixel, 1)};
    return random_combine(key_of_pixel, number);
}

/* Of the pixel's width, what a sample stands for: its footprint on textures. */
static double sample_share(const struct run *run, uint64_t number) {
    return number > 0 ? 1.0 / run->job->settings.samples : 1;
}

static struct vec3 sample(struct run *run, struct worker *worker, const struct place *place) {
    uint64_t key = begin_sample(run, worker, place->x, place->y, place->number);
    double x = (double)place->x + place->dx, y = (double)place->y + place->dy, share = sample_share(run, place->number);
    const struct camera_frame *camera = &run->camera;
    double time = run->timed ? sample_time(&worker->tracer.strata, key) : 0;
    if (run->timed && run->job->settings.motion.moves) {
        char warning[256];
        struct error error;
        camera = &worker->camera;
        if (!prepare_at(run->job, time, &worker->camera, warning, &error))
            return vec3_all(0); /* the one moment in which a view turns through zero */
    }
    if (!camera_is_plain(camera))
        return sample_through(run, worker, camera, x, y, time, share, key);
    struct ray ray = camera_ray(camera, x, y);
    ray.time = time;
    return trace_from_eye(run, worker, &ray, share, key);
}

/* The samples of a batch, as sample() would bring them. What the camera rays meet is looked for together. */
static void sample_batch(struct run *run, struct worker *worker) {
    struct batch *batch = &worker->batch;
    if (!run->together || batch->count == 1) {
        for (uint32_t i = 0; i < batch->count; i++)
            batch->colours[i] = sample(run, worker, &batch->places[i]);
        return;
    }
    struct ray_packet *packet = &batch->packet;
    packet->count = batch->count;
    packet->origin = run->camera.eye;
    packet->t_min = packet->time = 0;
    for (uint32_t i = 0; i < batch->count; i++) {
        const struct place *place = &batch->places[i];
        struct ray ray = camera_ray(&run->camera, (double)place->x + place->dx, (double)place->y + place->dy);
        packet->direction[0][i] = ray.direction.x;
        packet->direction[1][i] = ray.direction.y;
        packet->direction[2][i] = ray.direction.z;
        packet->t_max[i] = ray.t_max;
    }
    ray_packet_pad(packet);
    uint64_t met = world_nearest_packet(run->job->world, packet, &worker->scratch, batch->answers);
    worker->camera_rays += batch->count;
    for (uint32_t i = 0; i < batch->count; i++) {
        const struct place *place = &batch->places[i];
        struct ray ray = camera_ray(&run->camera, (double)place->x + place->dx, (double)place->y + place->dy);
        double share = sample_share(run, place->number);
        ray.footprint.spread *= share;
        ray.footprint.width *= share;
        uint64_t key = begin_sample(run, worker, place->x, place->y, place->number);
        batch->colours[i] = whitted_trace_met(&worker->tracer, &ray, met >> i & 1 ? &batch->answers[i] : NULL, key);
    }
}

/* The first sample has number 0, at the centre or the corner of the pixel. */
static struct place first_place(const struct run *run, int64_t x, int64_t y) {
    double at = run->job->settings.pixel_corner ? 0 : 0.5;
    return (struct place){x, y, at, at, 0};
}

/* Mean of the N x N samples; where one of them is the first sample again it is not traced twice. */
static struct vec3 all_samples(struct run *run, struct worker *worker, int64_t x, int64_t y, const struct vec3 *first) {
    int n = run->job->settings.samples;
    bool reuse = (n & 1) && !run->job->settings.pixel_corner && run->camera.lens.aperture == 0 && !run->timed;
    struct batch *batch = &worker->batch;
    struct vec3 sum = {0, 0, 0};
    int centre = reuse ? n / 2 * n + n / 2 : -1;
    for (int begin = 0; begin < n * n; begin += PACKET_RAYS) {
        int end = begin + PACKET_RAYS < n * n ? begin + PACKET_RAYS : n * n;
        batch->count = 0;
        for (int k = begin; k < end; k++) {
            if (k == centre && !first)
                batch->places[batch->count++] = first_place(run, x, y);
            else if (k != centre)
                batch->places[batch->count++] =
                    (struct place){x, y, (k % n + 0.5) / n, (k / n + 0.5) / n, (uint64_t)(k + 1)};
        }
        sample_batch(run, worker);
        uint32_t next = 0;
        for (int k = begin; k < end; k++)
            sum = vec3_add(sum, k == centre && first ? *first : batch->colours[next++]);
    }
    return vec3_scale(sum, 1 / ((double)n * (double)n));
}

static double clamp01(double c) {
    return c >= 1 ? 1 : c > 0 ? c : 0;
}

/* What counts is the difference in the picture file. */
static struct vec3 toned(const struct tone *tone, struct vec3 c) {
    if (tone_is_plain(tone))
        return c;
    return vec3_make(tone_apply(tone, c.x), tone_apply(tone, c.y), tone_apply(tone, c.z));
}

static double squared_distance(struct vec3 a, struct vec3 b) {
    struct vec3 d = {clamp01(a.x) - clamp01(b.x), clamp01(a.y) - clamp01(b.y), clamp01(a.z) - clamp01(b.z)};
    return vec3_dot(d, d);
}

/* First-pass colours of the tile and its rim, as far as they are in the picture. `area` is the rectangle with the rim.
 */
static const struct vec3 *first_at(const struct worker *worker, const struct rectangle *area, int64_t x, int64_t y) {
    return &worker->first[(size_t)(y - area->y0) * (FILM_TILE + 2) + (size_t)(x - area->x0)];
}

static bool is_marked(const struct run *run, const struct worker *worker, const struct rectangle *area, int64_t x,
                      int64_t y) {
    const struct settings *settings = &run->job->settings;
    struct vec3 own = toned(&settings->tone, *first_at(worker, area, x, y));
    for (int dy = -1; dy <= 1; dy++) {
        for (int dx = -1; dx <= 1; dx++) {
            int64_t nx = x + dx, ny = y + dy;
            if ((dx == 0 && dy == 0) || nx < area->x0 || nx >= area->x1 || ny < area->y0 || ny >= area->y1)
                continue;
            double tolerance = dx == 0 || dy == 0 ? settings->side_tolerance : settings->corner_tolerance;
            if (squared_distance(own, toned(&settings->tone, *first_at(worker, area, nx, ny))) > tolerance)
                return true;
        }
    }
    return false;
}

static void store(float out[3], struct vec3 colour) {
    out[0] = (float)colour.x;
    out[1] = (float)colour.y;
    out[2] = (float)colour.z;
}

static bool stopped(const struct run *run, const struct worker *worker) {
    return pool_cancelled(run->pool) || worker->scratch.failed;
}

static void finish_pixel(struct run *run, struct worker *worker, const struct rectangle *area, int64_t x, int64_t y,
                         bool have_first) {
    struct film *film = run->job->film;
    size_t at = (size_t)(y - film->y0) * film->width + (size_t)(x - film->x0);
    const struct vec3 *first = have_first ? first_at(worker, area, x, y) : NULL;
    bool marked = run->full || is_marked(run, worker, area, x, y);
    struct vec3 colour = marked ? all_samples(run, worker, x, y, first) : *first;
    store(film->pixels[at].rgb, colour);
    store(film->pixels[at].first, first ? *first : colour);
    film->marked[at] = marked;
    worker->marked += marked;
}

/* The first samples of a small square go together. */
enum { PATCH = 8 };
_Static_assert((int)(PATCH *PATCH) == (int)PACKET_RAYS, "a patch is a packet");

static void sample_patch(struct run *run, struct worker *worker, const struct rectangle *area, int64_t x0, int64_t y0) {
    struct batch *batch = &worker->batch;
    batch->count = 0;
    for (int64_t y = y0; y < y0 + PATCH && y < area->y1; y++) {
        for (int64_t x = x0; x < x0 + PATCH && x < area->x1; x++)
            batch->places[batch->count++] = first_place(run, x, y);
    }
    sample_batch(run, worker);
    for (uint32_t i = 0; i < batch->count; i++) {
        const struct place *place = &batch->places[i];
        worker->first[(size_t)(place->y - area->y0) * (FILM_TILE + 2) + (size_t)(place->x - area->x0)] =
            batch->colours[i];
    }
}

/* For somebody who watches: the first pass as far as it is, and what will be sampled again. */
static void show_marks(struct run *run, const struct worker *worker, const struct rectangle *area,
                       const struct rectangle *tile) {
    struct film *film = run->job->film;
    for (int64_t y = tile->y0; y < tile->y1; y++) {
        for (int64_t x = tile->x0; x < tile->x1; x++) {
            size_t at = (size_t)(y - film->y0) * film->width + (size_t)(x - film->x0);
            store(film->pixels[at].rgb, *first_at(worker, area, x, y));
            film->marked[at] = run->full || is_marked(run, worker, area, x, y) ? FILM_MARK_WAITS : 0;
        }
    }
}

static bool render_tile(struct run *run, struct worker *worker, struct rectangle tile) {
    const struct settings *settings = &run->job->settings;
    bool have_first = !run->full || settings->keep_first;
    int64_t rim = run->full ? 0 : 1;
    struct rectangle area = {tile.x0 - rim, tile.y0 - rim, tile.x1 + rim, tile.y1 + rim};
    area.x0 = area.x0 < 0 ? 0 : area.x0;
    area.y0 = area.y0 < 0 ? 0 : area.y0;
    area.x1 = area.x1 > run->job->width ? run->job->width : area.x1;
    area.y1 = area.y1 > run->job->height ? run->job->height : area.y1;
    for (int64_t y = area.y0; y < area.y1 && have_first; y += PATCH) {
        for (int64_t x = area.x0; x < area.x1; x += PATCH) {
            if (stopped(run, worker))
                return false;
            sample_patch(run, worker, &area, x, y);
        }
    }
    if (settings->show_marks && have_first)
        show_marks(run, worker, &area, &tile);
    for (int64_t y = tile.y0; y < tile.y1; y++) {
        for (int64_t x = tile.x0; x < tile.x1; x++) {
            if (stopped(run, worker))
                return false;
            finish_pixel(run, worker, &area, x, y, have_first);
        }
    }
    return true;
}

/* What a tile costs, from few rays: surfaces met and rays sent on, which no way of searching and no instruction set
 * changes. */
enum { COST_SAMPLES = 4 };

static void cost_item(void *context, uint32_t item, int index) {
    struct run *run = context;
    struct worker *worker = &run->workers[index];
    struct film_rectangle r = film_tile_rectangle(run->job->film, item);
    struct tracer *tracer = &worker->tracer;
    uint64_t before = tracer->hits + tracer->reflected_rays + tracer->refracted_rays;
    /* Many shards look at fewer rays: each of them looks at all tiles. */
    uint32_t count = run->job->shards <= 16 ? COST_SAMPLES : 1;
    for (uint32_t i = 0; i < count && !stopped(run, worker); i++) {
        uint32_t x = r.x0 + (r.x1 - r.x0) * (2 * i + 1) / (2 * count);
        uint32_t y = r.y0 + (r.y1 - r.y0) * ((2 * i + 1) * 3 % (2 * count)) / (2 * count);
        struct place place = first_place(run, x, y);
        (void)sample(run, worker, &place);
    }
    run->cost[item] = 1 + tracer->hits + tracer->reflected_rays + tracer->refracted_rays - before;
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

static void tile_item(void *context, uint32_t item, int index) {
    struct run *run = context;
    struct worker *worker = &run->workers[index];
    struct film *film = run->job->film;
    uint8_t wanted = FILM_TILE_WANTED;
    if (!atomic_compare_exchange_strong(&film->tiles[item], &wanted, FILM_TILE_TAKEN))
        return;
    struct film_rectangle r = film_tile_rectangle(film, item);
    struct rectangle tile = {r.x0, r.y0, r.x1, r.y1};
    /* A ray that was given up leaves a wrong colour: what ends after a wish to stop counts as not done. */
    bool whole = render_tile(run, worker, tile) && !stopped(run, worker);
    if (worker->scratch.failed) {
        atomic_store(&run->failed, true);
        pool_cancel(run->pool);
    }
    atomic_store_explicit(&film->tiles[item], whole ? FILM_TILE_DONE : FILM_TILE_WANTED, memory_order_release);
    if (!whole)
        return;
    if (run->job->tile_done) {
        uint32_t done = atomic_fetch_add(&run->done, 1) + 1;
        run->job->tile_done(run->job->context, item, done, run->tiles_wanted);
    }
}

/* Makes whatever becomes wanted until no more can. */
static void gated_item(void *context, uint32_t item, int index) {
    struct run *run = context;
    const struct film *film = run->job->film;
    const struct timespec pause = {0, 500000};
    uint32_t count = film_tile_count(film);
    (void)item;
    while (!stopped(run, &run->workers[index])) {
        uint32_t tile = 0;
        while (tile < count && atomic_load_explicit(&film->tiles[tile], memory_order_relaxed) != FILM_TILE_WANTED)
            tile++;
        if (tile < count)
            tile_item(run, tile, index);
        else if (atomic_load(run->job->gate) != 1)
            return;
        else
            (void)nanosleep(&pause, NULL);
    }
}

static bool run_tiles(struct run *run) {
    if (run->job->gate)
        return pool_run(run->pool, (uint32_t)pool_workers(run->pool), gated_item, run);
    return pool_run(run->pool, film_tile_count(run->job->film), tile_item, run);
}

bool render_prepare(struct render_job *job, uint32_t *x0, uint32_t *y0, uint32_t *width, uint32_t *height,
                    char warning[256], struct error *error) {
    const struct settings *s = &job->settings;
    struct camera_frame frame;
    char ignored[256];
    if (!prepare_at(job, 0, &frame, warning, error) || !prepare_at(job, 1, &frame, ignored, error))
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

/* --- layers beside the picture --- */

/* Through the middle of the lens, when the shutter opens. */
static bool middle_ray(const struct run *run, const struct place *place, struct ray *out) {
    double x = (double)place->x + place->dx, y = (double)place->y + place->dy;
    if (camera_is_plain(&run->camera)) {
        *out = camera_ray(&run->camera, x, y);
        return true;
    }
    return camera_ray_through(&run->camera, x, y, (struct sample2){0.5, 0.5}, 0, out);
}

static uint64_t work_of(const struct worker *worker) {
    const struct geom_scratch *done = &worker->scratch.geom;
    return done->cost.hierarchy_steps + done->cost.voxels + done->cost.triangle_tests + done->box_tests +
           done->shape_tests;
}

/* Traces the samples of a pixel once more, one by one: what they cost, and how many there are. */
static void measure_pixel(struct run *run, struct worker *worker, int64_t x, int64_t y, bool marked, float cost[3],
                          float samples[3]) {
    uint64_t work = work_of(worker), rays = worker->camera_rays;
    int n = run->job->settings.samples;
    bool have_first = !run->full || run->job->settings.keep_first;
    bool reuse = (n & 1) && !run->job->settings.pixel_corner && run->camera.lens.aperture == 0 && !run->timed;
    struct place place = first_place(run, x, y);
    if (have_first || reuse)
        (void)sample(run, worker, &place);
    for (int k = 0; marked && k < n * n && !stopped(run, worker); k++) {
        if (reuse && k == n / 2 * n + n / 2)
            continue;
        place = (struct place){x, y, (k % n + 0.5) / n, (k / n + 0.5) / n, (uint64_t)(k + 1)};
        (void)sample(run, worker, &place);
    }
    for (int c = 0; c < 3; c++) {
        cost[c] = (float)(work_of(worker) - work);
        samples[c] = (float)(worker->camera_rays - rays);
    }
}

static void layer_item(void *context, uint32_t item, int index) {
    struct run *run = context;
    struct worker *worker = &run->workers[index];
    struct film *film = run->job->film;
    struct film_rectangle r = film_tile_rectangle(film, item);
    uint32_t mask = film->layer_mask;
    for (int64_t y = r.y0; y < r.y1; y++) {
        for (int64_t x = r.x0; x < r.x1 && !stopped(run, worker); x++) {
            size_t at = (size_t)(y - film->y0) * film->width + (size_t)(x - film->x0);
            float values[AOV_COUNT][3] = {{0}};
            struct place place = first_place(run, x, y);
            struct ray ray;
            if (middle_ray(run, &place, &ray))
                aov_surface(run->job->world, &ray, mask, &worker->scratch, values);
            if (mask & (UINT32_C(1) << AOV_COST | UINT32_C(1) << AOV_SAMPLES))
                measure_pixel(run, worker, x, y, film->marked[at], values[AOV_COST], values[AOV_SAMPLES]);
            for (int i = 0; i < AOV_COUNT; i++) {
                size_t plane = aov_layer(mask, (enum aov)i) * (size_t)film->width * film->height;
                if (mask >> i & 1)
                    memcpy(film->layers[plane + at], values[i], sizeof values[i]);
            }
        }
    }
}

static void add_statistics(const struct run *run, int workers, struct render_statistics *out) {
    for (int i = 0; i < workers; i++) {
        const struct worker *worker = &run->workers[i];
        out->camera_rays += worker->camera_rays;
        out->marked_pixels += worker->marked;
        out->reflected_rays += worker->tracer.reflected_rays;
        out->refracted_rays += worker->tracer.refracted_rays;
        out->shadow_rays += worker->tracer.shadow_rays;
        out->shape_tests += worker->scratch.geom.shape_tests;
        out->triangle_tests += worker->scratch.geom.cost.triangle_tests;
        out->voxels += worker->scratch.geom.cost.voxels;
        out->hierarchy_steps += worker->scratch.geom.cost.hierarchy_steps;
        out->box_tests += worker->scratch.geom.box_tests;
    }
    out->samples = out->camera_rays;
    out->pixels += (uint64_t)run->job->film->width * run->job->film->height;
}

static bool start_workers(struct run *run, int workers) {
    run->workers = mem_alloc_zero((size_t)workers, sizeof *run->workers);
    if (!run->workers)
        return false;
    double cutoff = cutoff_weight(run->job);
    for (int i = 0; i < workers; i++) {
        struct worker *worker = &run->workers[i];
        if (!world_scratch_init(&worker->scratch, run->job->world))
            return false;
        worker->tracer = (struct tracer){.job = run->job,
                                         .pool = run->pool,
                                         .scratch = &worker->scratch,
                                         .eye_media = &run->eye_media,
                                         .cutoff = cutoff};
    }
    return true;
}

static void count_tiles(struct run *run) {
    const struct film *film = run->job->film;
    uint32_t done = film_tiles_in(film, FILM_TILE_DONE);
    run->tiles_wanted = film_tile_count(film) - film_tiles_in(film, FILM_TILE_ELSEWHERE);
    atomic_store(&run->done, done);
}

static bool anything_is_transparent(const struct world *world) {
    double ior;
    for (uint32_t i = 0; i < world->material_count; i++) {
        if (material_is_transparent(world->materials[i], &ior))
            return true;
    }
    return false;
}

/* The solids that rays may start in, and whether each ray must ask for itself. */
static bool find_eye_media(struct run *run, const struct box *origins, bool spread) {
    const struct world *world = run->job->world;
    run->closed_count = anything_is_transparent(world) ? world_closed_in(world, origins, NULL, 0) : 0;
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
    run->full = job->settings.full || run->timed || run->camera.lens.aperture > 0;
    struct box origins = box_join(camera_origins(&run->camera), camera_origins(at_close));
    return find_eye_media(run, &origins, run->timed || camera_spreads(&run->camera));
}

/* Before the first tile; without photons there is no map. */
static bool send_photons(struct run *run, int workers, struct render_statistics *out, struct error *error) {
    struct photon_statistics photons = {0};
    if (run->job->settings.caustics.photons == 0)
        return true;
    bool ok = photons_make(&run->caustics, run->job->world, &run->job->settings, run->pool, &photons, error);
    out->photons += photons.sent;
    out->photons_landed += photons.landed;
    out->photon_rays += photons.rays;
    out->photon_seconds += photons.seconds;
    out->photon_map_seconds += photons.map_seconds;
    for (int i = 0; i < workers; i++)
        run->workers[i].tracer.caustics = &run->caustics;
    return ok;
}

bool render_run(const struct render_job *job, struct pool *pool, struct render_statistics *statistics,
                struct error *error) {
    struct run run = {.job = job, .pool = pool};
    char warning[256];
    int workers = pool_workers(pool);
    double begin = seconds_now();
    struct camera_frame at_close;
    if (!prepare_at(job, 0, &run.camera, warning, error) || !prepare_at(job, 1, &at_close, warning, error))
        return false;
    bool ok = start_workers(&run, workers) && prepare_run(&run, &at_close);
    if (!ok) {
        error_no_memory(error, "the workers of a render");
    } else if (!send_photons(&run, workers, statistics, error) || !choose_tiles(&run, error)) {
        ok = false;
    } else if (count_tiles(&run), !run_tiles(&run)) {
        ok = atomic_load(&run.failed) ? error_no_memory(error, "the crossings of a ray")
                                      : error_set(error, ERROR_CANCELLED, "stopped while rendering");
        if (atomic_load(&run.failed))
            pool_reset_cancel(pool);
    } else if (atomic_load(&run.failed)) {
        ok = error_no_memory(error, "the crossings of a ray");
    }
    if (run.workers)
        add_statistics(&run, workers, statistics);
    if (ok && job->film->layers && !pool_run(pool, film_tile_count(job->film), layer_item, &run))
        ok = error_set(error, ERROR_CANCELLED, "stopped while rendering");
    if (run.workers) {
        for (int i = 0; i < workers; i++)
            world_scratch_destroy(&run.workers[i].scratch);
    }
    photon_map_destroy(&run.caustics);
    mem_free(run.workers);
    mem_free(run.closed);
    statistics->render_seconds += seconds_now() - begin;
    return ok;
}
