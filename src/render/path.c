/* The pixels of the path tracer. A pixel is the mean of its samples, which are added in order: as many as the pass
 * of the renderer takes, or until the noise of the tile is small enough. See path_internal.h. */
#include "render/path_internal.h"

#include "base/clock.h"
#include "base/mem.h"
#include "base/random.h"
#include "math/elementary.h"
#include "render/integrator_internal.h"
#include "render/path_noise_internal.h"
#include "render/path_view_internal.h"
#include "render/path_wave_internal.h"
#include "render/sample_internal.h"
#include "world/world_describe.h"

#include <stdio.h>
#include <string.h>

struct film_record path_tracer_record(const struct settings *settings) {
    unsigned parts = 0;
    if (settings_denoise(settings))
        parts |= PATH_PART_FEATURES;
    if (settings->aov & AOV_LIGHT)
        parts |= PATH_PART_LIGHT;
    if (settings_line_width(settings) > 0)
        parts |= PATH_PART_LINE;
    if (settings->transparent)
        parts |= PATH_PART_ALPHA;
    if (settings->resolve == RESOLVE_BRIGHT)
        parts |= PATH_PART_BRIGHT;
    return path_film_record(parts);
}

/* The footprint of a sample as a fraction of the pixel's width. It is that of 64 samples for any number of samples,
 * so that a picture does not depend on how many samples follow. The mean over the samples filters the rest. */
static const double footprint_share = 0.125;

bool path_has_parts(const struct settings *settings) {
    return path_film_parts(path_tracer_record(settings)) & (PATH_PART_FEATURES | PATH_PART_LIGHT);
}

/* Storage for the parts of a batch of samples, one for each worker. */
static bool make_sample_parts(struct path_tracer *tracer, struct renderer *renderer) {
    for (int i = 0; i < renderer->worker_count; i++) {
        struct path_parts *parts = arena_alloc(&tracer->arena, PACKET_RAYS * sizeof *parts);
        if (!parts)
            return false;
        renderer->workers[i].batch.parts = parts;
    }
    return true;
}

/* With --noise: a film of one tile for each worker. */
static bool make_tile_films(struct path_tracer *tracer, struct renderer *renderer) {
    struct film_record record = renderer->job->film->record;
    struct error ignored;
    size_t bytes;
    int workers = renderer->worker_count;
    if (!(tracer->noise > 0))
        return true;
    tracer->tiles = arena_alloc_array(&tracer->arena, (size_t)workers, sizeof *tracer->tiles);
    for (int i = 0; tracer->tiles && i < workers; i++) {
        void *block =
            film_size(FILM_TILE, FILM_TILE, record, &bytes, &ignored) ? arena_alloc(&tracer->arena, bytes) : NULL;
        if (!block)
            return false;
        film_layout(&tracer->tiles[i], block, FILM_TILE, FILM_TILE, record);
    }
    return tracer->tiles != NULL;
}

static bool make_contours(struct path_tracer *tracer, struct renderer *renderer) {
    double width = settings_line_width(&renderer->job->settings);
    int workers = renderer->worker_count;
    if (!(width > 0))
        return true;
    tracer->contours = arena_alloc_array(&tracer->arena, (size_t)workers, sizeof *tracer->contours);
    while (tracer->contours && tracer->contour_count < workers) {
        if (!contour_init(&tracer->contours[tracer->contour_count], width))
            return false;
        tracer->contour_count++;
    }
    return tracer->contours != NULL;
}

/* The lights that emit photons. */
static bool find_photon_lights(struct path_tracer *tracer, const struct world *world) {
    bool *lights = arena_alloc_array(&tracer->arena, (size_t)tracer->lights.count + 1, sizeof *lights);
    for (uint32_t i = 0; lights && i < world->light_count; i++) {
        struct light_emitter emitter;
        lights[i] = light_emitter_make(&world->lights[i], 0, 0, 1, &emitter);
    }
    for (uint32_t i = world->light_count; lights && i < tracer->lights.count; i++)
        lights[i] = tracer->lights.emitters[i].owner != LIGHT_NONE && lights[tracer->lights.emitters[i].owner];
    tracer->photon_lights = lights;
    return lights != NULL;
}

/* The lights with a position, if there are media. */
static bool find_aimed_lights(struct path_tracer *tracer) {
    const struct world_lights *lights = &tracer->lights;
    struct light_target middle;
    if (!tracer->has_fillings && !tracer->in_medium)
        return true;
    struct aimed_light *list = arena_alloc_array(&tracer->arena, (size_t)lights->count + 1, sizeof *list);
    for (uint32_t i = 0; list && i < lights->count; i++) {
        struct aimed_light *next = &list[tracer->aimed_light_count];
        next->light = i;
        if (light_middle(&lights->lights[i], &middle) && !middle.distant &&
            light_bounds_of(&lights->lights[i], 0, &next->bounds) == LIGHT_EXTENT_BOUNDED)
            tracer->aimed_light_count++;
    }
    tracer->aimed_lights = list;
    return list != NULL;
}

/* --- sealed solids --- */

static bool share_points(const struct box *a, const struct box *b) {
    struct box both = box_meet(*a, *b);
    return !box_is_empty(&both);
}

/* Whether a light may have points in the box. */
static bool light_is_in(const struct world_lights *lights, uint32_t number, const struct box *box) {
    const struct light *light = &lights->lights[number];
    uint32_t primitive = lights->emitters[number].primitive, parts = light_part_count(light);
    if (primitive != WORLD_NOTHING)
        return share_points(&lights->world->boxes[primitive], box);
    for (uint32_t i = 0; i < parts; i++) {
        struct light_bounds bounds;
        if (light_bounds_of(light, i, &bounds) == LIGHT_EXTENT_BOUNDED && share_points(&bounds.box, box))
            return true;
    }
    return false;
}

/* Whether the surface of the solid stops every ray between a point inside and a lamp: light passes it refracted. */
static bool is_sealed(const struct world_lights *lights, const struct solid *solid) {
    const struct world *world = lights->world;
    const struct prototype *prototype = primitive_prototype(world, solid->primitive);
    const struct medium *medium = &world->media.all[solid->medium];
    bool sealed = (medium->scatters || medium->inner) && !medium->fills && !prototype->holes && !prototype->is_thin &&
                  prototype->cull == CULL_NONE && geometry_is_closed(&prototype->geometry);
    for (uint32_t i = 0; i < lights->count && sealed; i++)
        sealed = !light_is_in(lights, i, &world->boxes[solid->primitive]);
    return sealed;
}

static bool find_sealed(struct path_tracer *tracer, const struct world *world) {
    uint32_t count = world->first_solid ? world->first_solid[world->primitive_count] : 0;
    bool *sealed = count > 0 ? arena_alloc_array(&tracer->arena, count, sizeof *sealed) : NULL, any = false;
    for (uint32_t i = 0; sealed && i < count; i++) {
        sealed[i] = is_sealed(&tracer->lights, &world->media.solids[i]);
        any = any || sealed[i];
    }
    tracer->sealed = any ? sealed : NULL;
    return count == 0 || sealed;
}

/* Scattered rays may meet the emission of media. */
static bool find_glow(struct path_tracer *tracer, const struct world *world, struct error *error) {
    const uint32_t first = world->media.outside;
    for (uint32_t i = 0; i <= first; i++)
        for (const struct medium *medium = &world->media.all[i]; medium; medium = medium->inner)
            tracer->lights.met = tracer->lights.met || colour_max_abs(medium->emission) > 0;
    return tracer->strategy == PATH_STRATEGY_BSDF ||
           glow_build(&tracer->glow, &world->media.all[first], world->local_media_count + 1, &tracer->arena, error);
}

/* --- devices --- */

struct measurement {
    const struct path_tracer *tracer;
    struct renderer *renderer;
    double end; /* seconds of the clock */
    _Atomic uint64_t samples;
};

/* Samples of pixels all over the picture until the time is over; the counts of the worker stay. */
static void try_samples(void *context, uint32_t item, int worker_index) {
    struct measurement *measured = context;
    struct renderer *renderer = measured->renderer;
    const struct film *film = renderer->job->film;
    struct worker *worker = &renderer->workers[worker_index];
    struct batch *batch = &worker->batch;
    const struct integrator_state state = worker->state;
    const struct geom_scratch geom = worker->scratch.geom;
    const uint64_t camera_rays = worker->camera_rays;
    for (uint32_t k = 0; clock_now() < measured->end && !pool_cancelled(renderer->pool); k++) {
        for (batch->count = 0; batch->count < PACKET_RAYS; batch->count++) {
            const uint64_t number = random_mix((uint64_t)item << 40 | (uint64_t)k << 8 | batch->count);
            const uint32_t x = film->x0 + (uint32_t)(number % film->width);
            const uint32_t y = film->y0 + (uint32_t)(number / film->width % film->height);
            batch->positions[batch->count] =
                path_sample_position(measured->tracer, renderer->job, x, y, renderer->pass.begin);
        }
        renderer_sample_batch(renderer, worker);
        atomic_fetch_add(&measured->samples, batch->count);
    }
    worker->state = state;
    worker->camera_rays = camera_rays;
    worker->scratch.geom.shape_tests = geom.shape_tests;
    worker->scratch.geom.box_tests = geom.box_tests;
    worker->scratch.geom.cost = geom.cost;
}

static struct path_estimate estimate(const struct path_tracer *tracer, struct renderer *renderer) {
    static const double seconds = 0.1;
    const double begun = clock_now();
    struct measurement measured = {tracer, renderer, begun + seconds, 0};
    const struct film *film = renderer->job->film;
    (void)pool_run(renderer->pool, (uint32_t)pool_workers(renderer->pool), try_samples, &measured);
    return (struct path_estimate){(double)film->width * (double)film->height * tracer->samples,
                                  (double)atomic_load(&measured.samples) / (clock_now() - begun)};
}

/* Of devices that take views; others begin each picture. A view that is too large is left to threads. */
static enum path_device_answer show_view(const struct renderer *renderer) {
    const struct path_device *device = renderer->job->device;
    struct path_view view;
    if (!device->take_view)
        return PATH_DEVICE_BEGINS;
    return path_view_make(renderer, &view) ? device->take_view(device->context, &view) : PATH_DEVICE_LEAVES;
}

/* *is_used false: threads make the picture. */
static bool send_scene(const struct path_tracer *tracer, const struct renderer *renderer, bool *is_used,
                       struct error *error) {
    const struct path_device *device = renderer->job->device;
    struct device_search search;
    if (!device_search_build(&search, renderer->job->world, renderer->pool, error))
        return false;
    struct bundle *scene = path_scene_bundle(tracer, renderer, &search);
    bool ok = scene ? device->begin(device->context, scene, is_used, error)
                    : error_no_memory(error, "the scene for a device");
    bundle_destroy(scene);
    device_search_destroy(&search);
    return ok;
}

/* If the job has a device, and it can render the scene, workers give their samples to it. */
static bool begin_device(struct path_tracer *tracer, struct renderer *renderer, struct error *error) {
    const struct path_device *device = renderer->job->device;
    const char *lacks = device && !renderer->roams ? path_scene_lacks(tracer, renderer) : NULL;
    if (lacks && device->leave && !device->leave(device->context, lacks, error))
        return false;
    if (!device || renderer->roams || lacks)
        return true;
    enum path_device_answer answer = show_view(renderer);
    if (answer == PATH_DEVICE_BEGINS && device->is_worth) {
        const struct path_estimate threads = estimate(tracer, renderer);
        if (!device->is_worth(device->context, &threads))
            return true;
    }
    if (answer == PATH_DEVICE_BEGINS) {
        bool is_used = false;
        if (!send_scene(tracer, renderer, &is_used, error))
            return false;
        answer = is_used ? show_view(renderer) : PATH_DEVICE_LEAVES;
    }
    /* The last workers wait for the device; if there are only those of the processor, these do. */
    const int first = device->waiting > 0 ? pool_workers(renderer->pool) : 0;
    bool ok = true;
    for (int i = first; ok && answer != PATH_DEVICE_LEAVES && i < renderer->worker_count; i++) {
        renderer->workers[i].for_device = mem_alloc_zero(1, sizeof *renderer->workers[i].for_device);
        ok = renderer->workers[i].for_device || error_no_memory(error, "the workers of a render");
    }
    return ok;
}

bool path_tracer_create(struct path_tracer *tracer, struct renderer *renderer, struct render_statistics *statistics,
                        struct error *error) {
    const struct settings *settings = &renderer->job->settings;
    tracer->samples = settings_path_samples(settings);
    tracer->has_parts = path_has_parts(settings);
    renderer->pass = (struct sample_pass){.end = tracer->samples};
    tracer->max_depth = settings->max_depth;
    tracer->roulette_depth = settings->roulette_depth;
    tracer->noise = settings->noise;
    tracer->clamp = settings->clamp;
    tracer->bright = settings->resolve == RESOLVE_BRIGHT ? el_exp2(settings->tone.exposure) : 0;
    /* Samples are points of a Sobol sequence, whose footprint does not depend on their number. */
    filter_init(&tracer->filter, settings->filter);
    renderer->sampler = SAMPLER_SOBOL;
    renderer->sample_share = footprint_share;
    tracer->strategy = settings->path_strategy;
    const struct world *world = renderer->job->world;
    tracer->in_medium = world_outside(world)->affects != 0;
    tracer->disperses = world_disperses(world);
    tracer->has_matter = tracer->in_medium || tracer->disperses;
    for (uint32_t i = 0; i < world->material_count; i++) {
        tracer->has_fillings = tracer->has_fillings || world->media.all[i].fills;
        tracer->has_matter =
            tracer->has_matter || world->media.all[i].affects != 0 || surface_walks(&world->surfaces.materials[i]);
    }
    /* Memory of the workers, as far as the film keeps something of it. */
    if ((path_has_parts(settings) && !make_sample_parts(tracer, renderer)) || !make_tile_films(tracer, renderer) ||
        !make_contours(tracer, renderer))
        return error_no_memory(error, "the workers of a render");
    /* The lights and, with --caustics, the photons that they send. */
    struct world_lights_options options = {renderer->job->background_lights, settings->light_choice};
    tracer->built = world_lights_build(&tracer->lights, world, options, &tracer->arena, renderer->pool, error);
    if (tracer->built && (!find_aimed_lights(tracer) || !find_sealed(tracer, world)))
        return error_no_memory(error, "the solids of the scene");
    if (tracer->built && !find_glow(tracer, world, error))
        return false;
    if (tracer->built && settings->caustics.photons > 0) {
        const struct photon_scene scene = {world, settings};
        if (!find_photon_lights(tracer, world))
            return error_no_memory(error, "the lights of the scene");
        if (!photons_send(&tracer->caustics, &scene, renderer->pool, statistics, error))
            return false;
    }
    return tracer->built && begin_device(tracer, renderer, error);
}

void path_tracer_destroy(struct path_tracer *tracer) {
    if (tracer->built)
        world_lights_destroy(&tracer->lights);
    photon_map_destroy(&tracer->caustics);
    for (int i = 0; i < tracer->contour_count; i++)
        contour_destroy(&tracer->contours[i]);
    arena_destroy(&tracer->arena);
}

/* --- pixels --- */

struct pixel_sample path_sample_position(const struct path_tracer *tracer, const struct render_job *job, int64_t x,
                                         int64_t y, uint32_t number) {
    uint64_t pixel = (uint64_t)y * job->width + (uint64_t)x;
    struct sampler sampler = sampler_make_sobol(job->settings.seed, pixel, number);
    struct filter_sample at = filter_sample(&tracer->filter, sampler_point(&sampler, SAMPLER_PIXEL));
    return (struct pixel_sample){x, y, at.x, at.y, number, at.weight};
}

static size_t pixel_index(const struct film *film, int64_t x, int64_t y) {
    return (size_t)(y - film->y0) * film->width + (size_t)(x - film->x0);
}

static void finish_pixel(struct film *film, const struct worker *worker, int64_t x, int64_t y,
                         const struct path_pixel *pixel) {
    path_film_store(film, pixel_index(film, x, y), pixel);
    OBSERVE(
        worker->state.observer, OBSERVED_PIXEL,
        .pixel = {.colour = path_pixel_below_line(pixel, path_pixel_mean(pixel)), .full = true, .first_counts = true});
}

/* The sums of the pixel before a pass: those of the film, or zero in the first pass. lines: of the part, or NULL. */
static struct path_pixel begin_pixel(const struct path_tracer *tracer, const struct film *film,
                                     const struct contour *lines, int64_t x, int64_t y, uint32_t begin) {
    struct path_pixel pixel;
    if (begin > 0)
        pixel = path_film_load(film, pixel_index(film, x, y));
    else
        pixel = (struct path_pixel){.line = lines ? (float)contour_coverage(lines, x, y) : 0};
    pixel.bright = tracer->bright;
    return pixel;
}

/* What a part of a tile gets: before: samples of a checkpoint; expected: all samples, 0 if that is not known. */
struct sample_plan {
    struct film *film;
    const struct film_rectangle *part;
    uint32_t before, expected;
};

void path_add(struct path_pixel *pixel, const struct path_parts *parts, struct colour light, double seen_through,
              double weight) {
    if (parts)
        path_pixel_add_parts(pixel, parts, light, weight);
    path_pixel_add(pixel, light, seen_through, weight);
}

/* Adds these samples to the pixels of a row of the film, pixel by pixel and batch by batch. A batch may contain samples
 * of several pixels. */
static bool sample_row(const struct path_tracer *tracer, struct renderer *renderer, struct worker *worker,
                       const struct sample_plan *plan, int64_t y, struct sample_range range) {
    struct film *film = plan->film;
    const struct film_rectangle *part = plan->part;
    uint32_t begin = range.begin, end = range.end;
    struct batch *batch = &worker->batch;
    uint32_t each = end - begin;
    const struct contour *lines = tracer->contours ? &tracer->contours[worker->index] : NULL;
    uint64_t all = (uint64_t)(part->x1 - part->x0) * each, next = 0;
    struct path_pixel pixel = begin_pixel(tracer, film, lines, part->x0, y, begin);
    while (next < all) {
        /* A batch is filled across the borders of pixels. */
        for (batch->count = 0; batch->count < PACKET_RAYS && next < all; next++)
            batch->positions[batch->count++] = path_sample_position(
                tracer, renderer->job, part->x0 + (int64_t)(next / each), y, begin + (uint32_t)(next % each));
        renderer_sample_batch(renderer, worker);
        if (renderer_stopped(renderer, worker))
            return false;
        /* Samples are added in their order, so the sums do not depend on the batches. */
        for (uint32_t i = 0; i < batch->count; i++) {
            int64_t x = batch->positions[i].x;
            path_add(&pixel, batch->parts ? &batch->parts[i] : NULL, batch->colours[i], batch->seen_through[i],
                     batch->positions[i].weight);
            if (pixel.samples < end)
                continue;
            finish_pixel(film, worker, x, y, &pixel);
            if (x + 1 < part->x1)
                pixel = begin_pixel(tracer, film, lines, x + 1, y, begin);
        }
    }
    return true;
}

static void count_of_device(struct worker *worker, const struct path_counts *counts) {
    struct integrator_state *state = &worker->state;
    worker->camera_rays += counts->camera_rays;
    state->reflected_rays += counts->reflected_rays;
    state->refracted_rays += counts->refracted_rays;
    state->shadow_rays += counts->shadow_rays;
    state->hits += counts->hits;
    state->medium_events += counts->medium_events;
    state->clamped = state->clamped || counts->clamped != 0;
}

static struct path_orders orders_of(const struct path_tracer *tracer, const struct device_work *work) {
    return (struct path_orders){work->orders, work->count, work->pixels, path_pixel_size(tracer->has_parts)};
}

/* Orders for these samples of a part of the film, with the pixels as they are before. False: no memory. */
static bool order_part(const struct path_tracer *tracer, struct worker *worker, const struct film *film,
                       const struct film_rectangle *part, struct sample_range range) {
    struct device_work *work = worker->for_device;
    struct path_orders orders = orders_of(tracer, work);
    const struct path_order order = {part->x0, part->y0, part->x1, part->y1, range.begin, range.end};
    uint64_t pixel = path_orders_pixels(&orders);
    const size_t needed = (size_t)(pixel + path_order_pixels(&order)) * orders.pixel_size;
    const struct contour *lines = tracer->contours ? &tracer->contours[worker->index] : NULL;
    if (needed > work->room) {
        const size_t room = needed > 2 * work->room ? needed : 2 * work->room;
        void *pixels = mem_resize_array(work->pixels, room, 1);
        if (!pixels)
            return !(worker->scratch.failed = true);
        orders.pixels = work->pixels = pixels;
        work->room = room;
    }
    work->parts[work->count] = *part;
    work->orders[work->count++] = order;
    for (uint32_t y = part->y0; y < part->y1; y++)
        for (uint32_t x = part->x0; x < part->x1; x++) {
            const struct path_pixel before = begin_pixel(tracer, film, lines, x, y, range.begin);
            memcpy(path_orders_pixel(&orders, pixel++), &before, orders.pixel_size);
        }
    return true;
}

/* A pixel as the film keeps it: parts that its samples do not have are as before. */
static struct path_pixel whole_pixel(const struct path_orders *orders, uint64_t number, const struct film *film,
                                     size_t at, uint32_t begin) {
    struct path_pixel pixel = {.samples = 0};
    if (begin > 0 && orders->pixel_size < sizeof pixel)
        pixel = path_film_load(film, at);
    memcpy(&pixel, path_orders_pixel(orders, number), orders->pixel_size);
    return pixel;
}

/* Before the first sample of a part. False: stopped. */
static bool find_contours(const struct path_tracer *tracer, struct renderer *renderer, struct worker *worker,
                          const struct film_rectangle *part, uint32_t begin) {
    return !tracer->contours || begin > 0 || contour_find(&tracer->contours[worker->index], renderer, worker, part);
}

/* Has the orders of the worker made. What the device leaves out the worker makes. plan: its part is of no use. False:
 * stopped. */
static bool make_orders(const struct path_tracer *tracer, struct renderer *renderer, struct worker *worker,
                        const struct sample_plan *plan) {
    const struct path_device *device = renderer->job->device;
    const struct device_work *work = worker->for_device;
    const struct path_orders orders = orders_of(tracer, work);
    struct path_counts counts = {0};
    uint64_t number = 0;
    uint32_t lined = work->count - 1; /* the part of which the worker has the contours */
    bool goes_on = device->make(device->context, &orders, &counts);
    count_of_device(worker, &counts);
    for (uint32_t i = 0; i < work->count && goes_on; i++) {
        const struct film_rectangle *part = &work->parts[i];
        const struct sample_range range = {work->orders[i].begin, work->orders[i].end};
        for (uint32_t y = part->y0; y < part->y1; y++)
            for (uint32_t x = part->x0; x < part->x1 && goes_on; x++, number++) {
                const struct film_rectangle one = {x, y, x + 1, y + 1};
                const struct sample_plan single = {plan->film, &one, plan->before, plan->expected};
                if (path_orders_pixel(&orders, number)->samples != range.end) {
                    goes_on = i == lined || find_contours(tracer, renderer, worker, part, range.begin);
                    lined = i;
                    goes_on = goes_on && sample_row(tracer, renderer, worker, &single, y, range);
                    continue;
                }
                const struct path_pixel pixel =
                    whole_pixel(&orders, number, plan->film, pixel_index(plan->film, x, y), range.begin);
                finish_pixel(plan->film, worker, x, y, &pixel);
            }
    }
    return goes_on;
}

static bool sample_part(const struct path_tracer *tracer, struct renderer *renderer, struct worker *worker,
                        const struct sample_plan *plan, struct sample_range range) {
    const struct film_rectangle *part = plan->part;
    if (worker->for_device) {
        worker->for_device->count = 0;
        return order_part(tracer, worker, plan->film, part, range) && make_orders(tracer, renderer, worker, plan);
    }
    for (int64_t y = part->y0; y < part->y1; y++) {
        if (!sample_row(tracer, renderer, worker, plan, y, range))
            return false;
        double rows = (double)(y + 1 - part->y0) / (double)(part->y1 - part->y0);
        double samples = range.begin + (range.end - range.begin) * rows;
        if (plan->expected > 0)
            renderer_tile_goes_on(renderer, worker, (samples - plan->before) / (plan->expected - plan->before));
    }
    return true;
}

/* --- noise --- */

static void copy_pixels(struct film *to, const struct film *from, const struct film_rectangle *part) {
    size_t width = (size_t)(part->x1 - part->x0), floats = from->record.floats;
    for (int64_t y = part->y0; y < part->y1; y++) {
        size_t in = pixel_index(to, part->x0, y), out = pixel_index(from, part->x0, y);
        memcpy(&to->pixels[in], &from->pixels[out], width * sizeof *to->pixels);
        memcpy(&to->floats[in * floats], &from->floats[out * floats], width * floats * sizeof *to->floats);
    }
}

/* A tile that gets its samples in one go gets them in a film of the worker. After each check they are copied into the
 * film of the picture, so that a checkpoint finds the samples of the last check there at any time. */
static struct film *begin_tile(const struct path_tracer *tracer, const struct film *film, const struct worker *worker,
                               const struct film_rectangle *part) {
    struct film *own = &tracer->tiles[worker->index];
    own->x0 = part->x0;
    own->y0 = part->y0;
    own->width = part->x1 - part->x0;
    if (film_tile_is_begun(atomic_load(worker->tile_state)))
        copy_pixels(own, film, part);
    return own;
}

/* Unless the tile is to have no more samples, its state is the check that it has passed. */
static void end_check(struct film *film, const struct film *own, const struct worker *worker,
                      const struct film_rectangle *part, struct sample_range range) {
    uint32_t checks = 0;
    for (uint32_t n = 0; n < range.begin; n = path_next_check(n))
        checks++;
    /* Who reads samples that follow sees that state. */
    atomic_store_explicit(worker->tile_state, FILM_TILE_TAKEN, memory_order_relaxed);
    atomic_thread_fence(memory_order_release);
    copy_pixels(film, own, part);
    if (range.begin < range.end)
        atomic_store_explicit(worker->tile_state, (uint8_t)(FILM_TILE_BEGUN + checks % FILM_CHECKS),
                              memory_order_release);
}

/* Whether the tile is at a check and its noise is small enough. Computes its expected number of samples. */
static bool is_quiet(const struct path_tracer *tracer, const struct film *film, const struct film_rectangle *part,
                     uint32_t samples, uint32_t *expected) {
    double wanted = tracer->noise, noise = path_tile_noise(film, *part);
    bool quiet = path_is_check(samples) && samples >= path_minimum_samples(wanted) && noise <= wanted;
    *expected = quiet ? samples : path_samples_expected(samples, noise, wanted, tracer->samples);
    return quiet;
}

/* Takes the samples of the pass until the noise of the tile is small enough. A tile that an earlier pass has finished
 * gets no more samples. */
static bool sample_until_quiet(const struct path_tracer *tracer, struct renderer *renderer, struct worker *worker,
                               const struct film_rectangle *part) {
    struct film *film = renderer->job->film;
    bool whole = worker->tile_state != NULL;
    struct sample_plan plan = {whole ? begin_tile(tracer, film, worker, part) : film, part, 0, 0};
    struct sample_range range = {renderer->pass.begin, renderer->pass.end};
    /* The tile has samples of a checkpoint, or of earlier passes. */
    if (whole && film_tile_is_begun(atomic_load(worker->tile_state)))
        range.begin = plan.before = path_film_load(plan.film, 0).samples;
    if (!whole && range.begin > 0 && path_film_load(film, pixel_index(film, part->x0, part->y0)).samples < range.begin)
        return true;
    while (!((path_is_check(range.begin) || range.begin == range.end) &&
             is_quiet(tracer, plan.film, part, range.begin, &plan.expected))) {
        if (range.begin == range.end) {
            atomic_store_explicit(&renderer->unsatisfied, true, memory_order_relaxed);
            break;
        }
        /* The samples up to the next check. */
        uint32_t check = path_next_check(range.begin), next = check < range.end ? check : range.end;
        if ((whole && range.begin > 0 && renderer_is_done(renderer)) ||
            !sample_part(tracer, renderer, worker, &plan, (struct sample_range){range.begin, next}))
            return false;
        range.begin = next;
        if (whole)
            end_check(film, plan.film, worker, part, range);
    }
    if (plan.expected > plan.before)
        renderer_tile_goes_on(renderer, worker, (double)(range.begin - plan.before) / (plan.expected - plan.before));
    return true;
}

bool path_tracer_render(const struct path_tracer *tracer, struct renderer *renderer, struct worker *worker,
                        const struct film_rectangle *part) {
    const struct sample_pass *pass = &renderer->pass;
    bool kept = worker->tile_state && film_tile_is_begun(atomic_load(worker->tile_state));
    if (!kept && !find_contours(tracer, renderer, worker, part, pass->begin))
        return false;
    if (tracer->noise > 0)
        return sample_until_quiet(tracer, renderer, worker, part);
    atomic_store_explicit(&renderer->unsatisfied, true, memory_order_relaxed);
    const struct sample_plan plan = {renderer->job->film, part, 0, tracer->samples};
    return sample_part(tracer, renderer, worker, &plan, (struct sample_range){pass->begin, pass->end});
}

bool path_tracer_render_by_device(const struct path_tracer *tracer, struct renderer *renderer, struct worker *worker) {
    const struct sample_range range = {renderer->pass.begin, renderer->pass.end};
    const struct sample_plan plan = {renderer->job->film, NULL, 0, tracer->samples};
    struct device_work *work = worker->for_device;
    const uint32_t count = work->count;
    work->count = 0;
    atomic_store_explicit(&renderer->unsatisfied, true, memory_order_relaxed);
    for (uint32_t i = 0; i < count; i++) {
        const struct film_rectangle part = work->parts[i];
        if (!find_contours(tracer, renderer, worker, &part, range.begin) ||
            !order_part(tracer, worker, plan.film, &part, range))
            return false;
    }
    return make_orders(tracer, renderer, worker, &plan);
}

void path_tracer_repeat(const struct path_tracer *tracer, struct renderer *renderer, struct worker *worker, int64_t x,
                        int64_t y) {
    const struct film *film = renderer->job->film;
    uint32_t samples = path_film_load(film, pixel_index(film, x, y)).samples;
    for (uint32_t i = 0; i < samples && !renderer_stopped(renderer, worker); i++) {
        struct pixel_sample position = path_sample_position(tracer, renderer->job, x, y, i);
        (void)renderer_sample(renderer, worker, &position);
    }
}

/* --- parts of the scene language with another meaning for paths --- */

/* The first node with this material; operands of CSG are not searched. */
static const char *user_of(const struct world *world, uint32_t material) {
    for (uint32_t i = 0; i < world->prototype_count; i++) {
        const struct prototype *prototype = &world->prototypes[i];
        uint32_t slots = prototype->slot_count > 1 ? prototype->slot_count : 1;
        if (!prototype->geometry.csg && material - prototype->material < slots)
            return world->authored.nodes[i]->name;
    }
    return "CSG";
}

static bool has_emission(const struct world *world, uint32_t material) {
    const struct surface_material *surface = &world->surfaces.materials[material];
    return colour_max_abs(surface_emission(&world->surfaces, surface)) > 0 ||
           colour_max_abs(surface_emission_bound(&world->surfaces, surface)) > 0;
}

/* Next-event estimation needs bounds. */
static void warn_of_infinite_emitter(const struct world *world, world_warning *warn, void *context) {
    char text[256];
    for (uint32_t i = 0; i < world->primitive_count; i++) {
        const struct box *box = &world->boxes[i];
        if ((vec3_finite(box->min) && vec3_finite(box->max)) || !primitive_has_material(world, i, has_emission))
            continue;
        (void)snprintf(text, sizeof text,
                       "--integrator path: '%.100s' emits light and has no bounds: only scattered rays find its light, "
                       "which causes noise",
                       primitive_node(world, i)->name);
        warn(context, text);
        return;
    }
}

void path_tracer_warn(const struct render_job *job, world_warning *warn, void *context) {
    const struct world *world = job->world;
    char text[256];
    warn_of_infinite_emitter(world, warn, context);
    if (colour_max_abs(job->ambient) > 0)
        warn(context, "--integrator path ignores ambient: it computes indirect light instead");
    for (uint32_t i = 0; i < world->material_count; i++) {
        const struct surface_material *material = &world->surfaces.materials[i];
        const char *name = world->authored.materials[i]->name;
        double albedo = surface_albedo_bound(&world->surfaces, material);
        if (!(albedo > 1 + 0x1p-20))
            continue;
        (void)snprintf(text, sizeof text,
                       "warning: --integrator path: the material of '%.100s' reflects more light than it receives "
                       "(%.3g times); only --max-depth and Russian roulette end its paths",
                       name && name[0] ? name : user_of(world, i), albedo);
        warn(context, text);
        return;
    }
}
