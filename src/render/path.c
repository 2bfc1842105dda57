/* The pixels of the path tracer: the mean of `samples` samples each, added in their order. See path_internal.h. */
#include "render/path_internal.h"

#include "render/integrator_internal.h"
#include "render/path_film_internal.h"

#include <stdio.h>

struct film_record path_tracer_record(void) {
    return path_film_record();
}

/* Of the pixel's width, what a sample stands for: that of 64 samples, for any number of them, so that a picture does
 * not depend on how many samples it will have. The rest of the filtering is the mean over the samples. */
static const double footprint_share = 0.125;

bool path_tracer_create(struct path_tracer *tracer, struct renderer *renderer, struct error *error) {
    const struct settings *settings = &renderer->job->settings;
    tracer->samples = settings->path_samples > 0 ? (uint32_t)settings->path_samples : PATH_SAMPLES_DEFAULT;
    tracer->max_depth = settings->max_depth;
    renderer->sampler = SAMPLER_SOBOL;
    renderer->sample_share = footprint_share;
    tracer->strategy = settings->path_strategy;
    const struct world *world = renderer->job->world;
    bool background = renderer->job->background_lights && sky_brightest(&world->sky) > 0;
    tracer->built = world_lights_build(&tracer->lights, world, background, LIGHT_CHOICE_TREE, &tracer->arena,
                                       renderer->pool, error);
    return tracer->built;
}

void path_tracer_destroy(struct path_tracer *tracer) {
    if (tracer->built)
        world_lights_destroy(&tracer->lights);
    arena_destroy(&tracer->arena);
}

/* --- pixels --- */

static struct pixel_sample sample_place(const struct renderer *renderer, int64_t x, int64_t y, uint32_t number) {
    uint64_t pixel = (uint64_t)y * renderer->job->width + (uint64_t)x;
    struct sampler sampler = sampler_make_sobol(renderer->job->settings.seed, pixel, number);
    struct sample2 at = sampler_point(&sampler, SAMPLER_PIXEL);
    return (struct pixel_sample){x, y, at.x, at.y, number};
}

static size_t pixel_index(const struct film *film, int64_t x, int64_t y) {
    return (size_t)(y - film->y0) * film->width + (size_t)(x - film->x0);
}

static void finish_pixel(struct film *film, const struct worker *worker, int64_t x, int64_t y,
                         const struct path_pixel *pixel) {
    path_film_store(film, pixel_index(film, x, y), pixel);
    observe_pixel(worker->state.observer, &(struct observed_pixel){.colour = path_pixel_mean(pixel), .full = true});
}

/* The samples of a row, pixel by pixel, batch by batch: a batch may hold samples of several pixels. */
bool path_tracer_render(const struct path_tracer *tracer, struct renderer *renderer, struct worker *worker,
                        const struct rectangle *part) {
    struct batch *batch = &worker->batch;
    for (int64_t y = part->y0; y < part->y1; y++) {
        uint64_t all = (uint64_t)(part->x1 - part->x0) * tracer->samples, next = 0;
        struct path_pixel pixel = {0};
        while (next < all) {
            for (batch->count = 0; batch->count < PACKET_RAYS && next < all; next++)
                batch->places[batch->count++] = sample_place(renderer, part->x0 + (int64_t)(next / tracer->samples), y,
                                                             (uint32_t)(next % tracer->samples));
            renderer_sample_batch(renderer, worker);
            if (renderer_stopped(renderer, worker))
                return false;
            for (uint32_t i = 0; i < batch->count; i++) {
                path_pixel_add(&pixel, batch->colours[i], 1);
                if (pixel.samples < tracer->samples)
                    continue;
                finish_pixel(renderer->job->film, worker, batch->places[i].x, y, &pixel);
                pixel = (struct path_pixel){0};
            }
        }
        renderer_tile_goes_on(renderer, worker, 1, (double)(y + 1 - part->y0) / (double)(part->y1 - part->y0));
    }
    return true;
}

void path_tracer_repeat(const struct path_tracer *tracer, struct renderer *renderer, struct worker *worker, int64_t x,
                        int64_t y) {
    for (uint32_t i = 0; i < tracer->samples && !renderer_stopped(renderer, worker); i++) {
        struct pixel_sample place = sample_place(renderer, x, y, i);
        (void)renderer_sample(renderer, worker, &place);
    }
}

/* --- what the scene language says and paths take otherwise --- */

/* Of the first node that has the material; of the operands of CSG it is not looked for. */
static const char *user_of(const struct world *world, uint32_t material) {
    for (uint32_t i = 0; i < world->prototype_count; i++) {
        const struct prototype *prototype = &world->prototypes[i];
        uint32_t slots = prototype->slot_count > 1 ? prototype->slot_count : 1;
        if (!prototype->geometry.csg && material - prototype->material < slots)
            return world->authored.nodes[i]->name;
    }
    return "CSG";
}

void path_tracer_warn(const struct render_job *job, world_warning *warn, void *context) {
    const struct world *world = job->world;
    char text[256];
    if (vec3_max_abs(job->ambient) > 0)
        warn(context, "--integrator path ignores ambient: light goes from wall to wall instead");
    for (uint32_t i = 0; i < world->material_count; i++) {
        const struct material *material = &world->materials[i];
        double albedo = material_albedo_bound(material);
        if (!(albedo > 1 + 0x1p-20))
            continue;
        (void)snprintf(text, sizeof text,
                       "warning: --integrator path: the material of '%.100s' sends back more light than arrives (%.3g "
                       "times): --max-depth and chance end its paths",
                       material->name && material->name[0] ? material->name : user_of(world, i), albedo);
        warn(context, text);
        return;
    }
}
