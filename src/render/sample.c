/* One sample of a pixel, from its position to its colour; single, or many with camera rays in packets. The
 * random key of a sample is a function of the pixel and of the sample's number. */
#include "base/unreachable.h"
#include "render/integrator_internal.h"
#include "render/sample_internal.h"
#include "render/sampler.h"

#include <float.h>

static struct camera moved_camera(const struct render_job *job, double ray_time) {
    const struct settings *settings = &job->settings;
    return settings->motion.moves
               ? camera_at(&job->camera, &settings->motion, shutter_time(settings->shutter, ray_time))
               : job->camera;
}

bool renderer_prepare_at(const struct render_job *job, double ray_time, struct camera_frame *out, char warning[256],
                         struct error *error) {
    const struct camera camera = moved_camera(job, ray_time);
    return camera_prepare(&camera, &job->settings, (struct picture_size){job->width, job->height}, out, warning, error);
}

const struct camera_frame *renderer_camera_of(const struct renderer *renderer, const struct sampler *sampler,
                                              struct camera_frame *own) {
    const struct render_job *job = renderer->job;
    if (!renderer->timed || !job->settings.motion.moves)
        return &renderer->camera;
    const struct camera camera = moved_camera(job, sampler_time(sampler));
    const struct picture_size size = {job->width, job->height};
    return camera_prepare_quietly(&camera, &job->settings, size, own) ? own : NULL;
}

bool renderer_middle_ray(const struct renderer *renderer, double x, double y, struct ray *out) {
    if (camera_is_plain(&renderer->camera)) {
        *out = camera_ray(&renderer->camera, x, y);
        return true;
    }
    return camera_ray_through(&renderer->camera, x, y, (struct sample2){0.5, 0.5}, NULL, out);
}

/* The footprint of a sample on textures, as a fraction of the pixel's width. */
static void set_footprint(const struct renderer *renderer, uint64_t number, struct ray *ray) {
    double share = renderer->sampler == SAMPLER_SOBOL ? renderer->sample_share
                   : number > 0                       ? 1.0 / renderer->job->settings.samples
                                                      : 1;
    ray->footprint.spread *= share;
    ray->footprint.width *= share;
}

/* With the time and the footprint of the sample. False: nothing is visible there. */
static bool ray_through(const struct renderer *renderer, const struct camera_frame *camera,
                        const struct pixel_sample *at, const struct sampler *sampler, const struct camera_view *view,
                        struct ray *out) {
    double x = (double)at->x + at->dx, y = (double)at->y + at->dy;
    if (!view)
        *out = camera_ray(camera, x, y);
    else if (!camera_ray_through(camera, x, y, sampler_lens(sampler), view, out))
        return false;
    out->time = renderer->timed ? sampler_time(sampler) : 0;
    set_footprint(renderer, at->number, out);
    return true;
}

/* A wide filter does not look beyond the view of the pixel. */
static struct camera_view view_of(const struct camera_frame *camera, const struct pixel_sample *at) {
    return camera_view_at(camera, (double)at->x + 0.5, (double)at->y + 0.5);
}

bool renderer_camera_ray(const struct renderer *renderer, const struct camera_frame *camera,
                         const struct pixel_sample *at, const struct sampler *sampler, struct ray *out) {
    if (camera_is_plain(camera))
        return ray_through(renderer, camera, at, sampler, NULL, out);
    struct camera_view view = view_of(camera, at);
    return ray_through(renderer, camera, at, sampler, &view, out);
}

const struct medium_stack *renderer_eye_media(const struct renderer *renderer, const struct ray *ray,
                                              struct world_scratch *scratch, struct medium_stack *own) {
    if (!renderer->medium_stack_by_ray)
        return &renderer->eye_medium_stack;
    const struct inside_query eye = {ray->origin, ray->time, renderer->closed, renderer->closed_count};
    world_medium_stack(renderer->job->world, &eye, scratch, own);
    return own;
}

static struct colour trace_from_eye(struct renderer *renderer, struct worker *worker, const struct ray *ray,
                                    uint64_t key) {
    worker->camera_rays++;
    worker->state.eye_medium_stack = renderer_eye_media(renderer, ray, &worker->scratch, &worker->ray_medium_stack);
    return integrator_radiance(renderer, worker, ray, key);
}

/* Red comes from the left eye, green and blue from the right one; normal and depth from the left one. */
static struct path_parts parts_of_eyes(const struct path_parts *left, const struct path_parts *right) {
    struct path_parts both = *left;
    for (int channel = 1; channel < 3; channel++) {
        both.features[PATH_ALBEDO + channel] = right->features[PATH_ALBEDO + channel];
        both.features[PATH_GLOW + channel] = right->features[PATH_GLOW + channel];
    }
    for (int i = 0; i < PATH_LIGHT_GROUPS; i++)
        both.light[i] = colour_make(left->light[i].r, right->light[i].g, right->light[i].b);
    return both;
}

/* The depth of the middle of a pixel as a colour: the direction of a ray is one unit long along the view. */
static struct colour sample_depth(struct renderer *renderer, struct worker *worker, const struct pixel_sample *at) {
    struct ray ray;
    struct hit hit;
    worker->camera_rays++;
    if (!renderer_middle_ray(renderer, (double)at->x + 0.5, (double)at->y + 0.5, &ray) ||
        !world_nearest(renderer->job->world, &ray, &worker->scratch, &hit))
        return colour_all(0);
    return colour_all(math_min(hit.t, (double)FLT_MAX));
}

static struct colour sample_both_eyes(struct renderer *renderer, struct worker *worker,
                                      const struct camera_frame *camera, const struct pixel_sample *at) {
    const struct sampler sampler = worker->state.sampler;
    struct camera_view view = camera_view_of_eye(camera, -1);
    struct ray ray, right_ray;
    if (!ray_through(renderer, camera, at, &sampler, &view, &ray))
        return colour_all(0);
    struct colour left = trace_from_eye(renderer, worker, &ray, sampler.key);
    view = camera_view_of_eye(camera, 1);
    (void)ray_through(renderer, camera, at, &sampler, &view, &right_ray);
    struct path_parts *parts = worker->state.parts, left_parts;
    if (parts) {
        left_parts = *parts;
        *parts = (struct path_parts){0};
    }
    struct colour right = trace_from_eye(renderer, worker, &right_ray, sampler_right_eye(&sampler));
    if (parts)
        *parts = parts_of_eyes(&left_parts, parts);
    worker->state.seen_through /= 2;
    return colour_make(left.r, right.g, right.b);
}

/* The strata of sample i of a batch, and the hit of its camera ray. */
static void begin_records(struct worker *worker, uint32_t i) {
    struct batch *batch = &worker->batch;
    worker->state.seen_through = 0;
    worker->state.parts = batch->parts ? &batch->parts[i] : NULL;
    worker->state.camera_hit = batch->camera_hits ? &batch->camera_hits[i] : NULL;
    if (batch->parts)
        batch->parts[i] = (struct path_parts){0};
    if (batch->camera_hits)
        batch->camera_hits[i] = camera_hit_none();
}

static void end_records(struct worker *worker) {
    worker->state.parts = NULL;
    worker->state.camera_hit = NULL;
}

static struct sampler sampler_of(const struct renderer *renderer, const struct pixel_sample *position) {
    const struct settings *settings = &renderer->job->settings;
    uint64_t pixel = (uint64_t)position->y * renderer->job->width + (uint64_t)position->x;
    switch (renderer->sampler) {
    case SAMPLER_STRATA:
        return sampler_make(settings->seed, pixel, position->number, (uint32_t)settings->samples);
    case SAMPLER_SOBOL:
        return sampler_make_sobol(settings->seed, pixel, position->number);
    }
    UNREACHABLE("no sampler");
}

static struct colour sample_single(struct renderer *renderer, struct worker *worker,
                                   const struct pixel_sample *position) {
    worker->state.sampler = sampler_of(renderer, position);
    const struct sampler sampler = worker->state.sampler;
    const struct camera_frame *camera = renderer_camera_of(renderer, &sampler, &worker->camera);
    if (!camera)
        return colour_all(0);
    if (camera->lens.stereo == STEREO_ANAGLYPH)
        return sample_both_eyes(renderer, worker, camera, position);
    if (camera->lens.depth && view_of(camera, position).depth)
        return sample_depth(renderer, worker, position);
    struct ray ray;
    if (!renderer_camera_ray(renderer, camera, position, &sampler, &ray))
        return colour_all(0);
    return trace_from_eye(renderer, worker, &ray, sampler.key);
}

struct colour renderer_sample(struct renderer *renderer, struct worker *worker, const struct pixel_sample *position) {
    OBSERVE(worker->state.observer, OBSERVED_SAMPLE_BEGIN, .sample.position = position);
    struct colour colour = sample_single(renderer, worker, position);
    OBSERVE(worker->state.observer, OBSERVED_SAMPLE_END, .sample = {position, colour});
    return colour;
}

/* The samples of a batch, equal to those of renderer_sample. The hits of the camera rays are found together. */
void renderer_sample_batch(struct renderer *renderer, struct worker *worker) {
    struct batch *batch = &worker->batch;
    if (!renderer->together || batch->count == 1) {
        for (uint32_t i = 0; i < batch->count; i++) {
            begin_records(worker, i);
            batch->colours[i] = renderer_sample(renderer, worker, &batch->positions[i]);
            batch->seen_through[i] = worker->state.seen_through;
        }
        end_records(worker);
        return;
    }
    /* The hits of all camera rays are found in one search. */
    struct ray_packet *packet = &batch->packet;
    packet->count = batch->count;
    packet->origin = renderer->camera.eye;
    packet->t_min = packet->time = 0;
    for (uint32_t i = 0; i < batch->count; i++) {
        const struct pixel_sample *position = &batch->positions[i];
        struct ray ray =
            camera_ray(&renderer->camera, (double)position->x + position->dx, (double)position->y + position->dy);
        packet->direction[0][i] = ray.direction.x;
        packet->direction[1][i] = ray.direction.y;
        packet->direction[2][i] = ray.direction.z;
        packet->t_max[i] = ray.t_max;
    }
    ray_packet_pad(packet);
    uint64_t met = world_nearest_packet(renderer->job->world, packet, &worker->scratch, batch->answers);
    worker->camera_rays += batch->count;
    /* Each sample goes on alone, with the footprint that belongs to it. */
    for (uint32_t i = 0; i < batch->count; i++) {
        const struct pixel_sample *position = &batch->positions[i];
        struct ray ray =
            camera_ray(&renderer->camera, (double)position->x + position->dx, (double)position->y + position->dy);
        set_footprint(renderer, position->number, &ray);
        worker->state.sampler = sampler_of(renderer, position);
        begin_records(worker, i);
        batch->colours[i] = integrator_radiance_met(renderer, worker, &ray, met >> i & 1 ? &batch->answers[i] : NULL,
                                                    worker->state.sampler.key);
        batch->seen_through[i] = worker->state.seen_through;
    }
    end_records(worker);
}

/* The first sample has number 0, at the centre or the corner of the pixel. */
struct pixel_sample renderer_first_sample(const struct renderer *renderer, int64_t x, int64_t y) {
    double at = renderer->job->settings.pixel_corner ? 0 : 0.5;
    return (struct pixel_sample){x, y, at, at, 0, 1};
}
