/* One sample of a pixel, from its position to its colour; single, or many with camera rays in packets. The
 * random key of a sample is a function of the pixel and of the sample's number. */
#include "base/unreachable.h"
#include "math/elementary.h"
#include "render/filter_internal.h"
#include "render/integrator_internal.h"
#include "render/sampler.h"

#include <math.h>

/* The camera at a ray's time. */
bool renderer_prepare_at(const struct render_job *job, double ray_time, struct camera_frame *out, char warning[256],
                         struct error *error) {
    const struct settings *settings = &job->settings;
    struct camera camera = job->camera;
    if (settings->motion.moves)
        camera = camera_at(&job->camera, &settings->motion, shutter_time(settings->shutter, ray_time));
    return camera_prepare(&camera, settings, (struct picture_size){job->width, job->height}, out, warning, error);
}

bool renderer_middle_ray(const struct renderer *renderer, double x, double y, struct ray *out) {
    if (camera_is_plain(&renderer->camera)) {
        *out = camera_ray(&renderer->camera, x, y);
        return true;
    }
    return camera_ray_through(&renderer->camera, x, y, (struct sample2){0.5, 0.5}, 0, out);
}

static struct vec3 trace_from_eye(struct renderer *renderer, struct worker *worker, struct ray *ray, double share,
                                  uint64_t key) {
    ray->footprint.spread *= share;
    ray->footprint.width *= share;
    worker->camera_rays++;
    if (renderer->medium_stack_by_ray) {
        medium_stack_at(renderer->job->world,
                        &(struct inside_query){ray->origin, ray->time, renderer->closed, renderer->closed_count},
                        &worker->scratch, &worker->ray_medium_stack);
        worker->state.eye_medium_stack = &worker->ray_medium_stack;
    }
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
        both.light[i] = vec3_make(left->light[i].x, right->light[i].y, right->light[i].z);
    return both;
}

/* Through a lens, in another projection, for two eyes. */
static struct vec3 sample_through(struct renderer *renderer, struct worker *worker, const struct camera_frame *camera,
                                  struct sample2 at, double time, double share) {
    const struct sampler sampler = worker->state.sampler;
    struct sample2 position = sampler_lens(&sampler);
    struct ray ray, right_ray;
    bool anaglyph = camera->lens.stereo == STEREO_ANAGLYPH;
    if (!camera_ray_through(camera, at.x, at.y, position, anaglyph ? -1 : 0, &ray))
        return vec3_all(0);
    ray.time = time;
    struct vec3 colour = trace_from_eye(renderer, worker, &ray, share, sampler.key);
    if (!anaglyph)
        return colour;
    (void)camera_ray_through(camera, at.x, at.y, position, 1, &right_ray);
    right_ray.time = time;
    struct path_parts *parts = worker->state.parts, left_parts;
    if (parts) {
        left_parts = *parts;
        *parts = (struct path_parts){0};
    }
    struct vec3 right = trace_from_eye(renderer, worker, &right_ray, share, sampler_right_eye(&sampler));
    if (parts)
        *parts = parts_of_eyes(&left_parts, parts);
    return vec3_make(colour.x, right.y, right.z);
}

/* The strata of sample i of a batch, and the hit of its camera ray. */
static void begin_records(struct worker *worker, uint32_t i) {
    struct batch *batch = &worker->batch;
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

static void begin_sample(const struct renderer *renderer, struct worker *worker, const struct pixel_sample *position) {
    const struct settings *settings = &renderer->job->settings;
    uint64_t pixel = (uint64_t)position->y * renderer->job->width + (uint64_t)position->x;
    switch (renderer->sampler) {
    case SAMPLER_STRATA:
        worker->state.sampler = sampler_make(settings->seed, pixel, position->number, (uint32_t)settings->samples);
        break;
    case SAMPLER_SOBOL:
        worker->state.sampler = sampler_make_sobol(settings->seed, pixel, position->number);
        break;
    }
}

/* The footprint of a sample on textures, as a fraction of the pixel's width. */
static double sample_share(const struct renderer *renderer, uint64_t number) {
    if (renderer->sampler == SAMPLER_SOBOL)
        return renderer->sample_share;
    return number > 0 ? 1.0 / renderer->job->settings.samples : 1;
}

static struct vec3 sample_single(struct renderer *renderer, struct worker *worker,
                                 const struct pixel_sample *position) {
    begin_sample(renderer, worker, position);
    double x = (double)position->x + position->dx, y = (double)position->y + position->dy,
           share = sample_share(renderer, position->number);
    const struct camera_frame *camera = &renderer->camera;
    double time = renderer->timed ? sampler_time(&worker->state.sampler) : 0;
    if (renderer->timed && renderer->job->settings.motion.moves) {
        char warning[256];
        struct error error;
        camera = &worker->camera;
        if (!renderer_prepare_at(renderer->job, time, &worker->camera, warning, &error))
            return vec3_all(0); /* the one moment in which a view turns through zero */
    }
    if (!camera_is_plain(camera))
        return sample_through(renderer, worker, camera, (struct sample2){x, y}, time, share);
    struct ray ray = camera_ray(camera, x, y);
    ray.time = time;
    return trace_from_eye(renderer, worker, &ray, share, worker->state.sampler.key);
}

struct vec3 renderer_sample(struct renderer *renderer, struct worker *worker, const struct pixel_sample *position) {
    observe_sample_begin(worker->state.observer, position);
    struct vec3 colour = sample_single(renderer, worker, position);
    observe_sample_end(worker->state.observer, position, colour);
    return colour;
}

/* The samples of a batch, equal to those of renderer_sample. The hits of the camera rays are found together. */
void renderer_sample_batch(struct renderer *renderer, struct worker *worker) {
    struct batch *batch = &worker->batch;
    if (!renderer->together || batch->count == 1) {
        for (uint32_t i = 0; i < batch->count; i++) {
            begin_records(worker, i);
            batch->colours[i] = renderer_sample(renderer, worker, &batch->positions[i]);
        }
        end_records(worker);
        return;
    }
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
    for (uint32_t i = 0; i < batch->count; i++) {
        const struct pixel_sample *position = &batch->positions[i];
        struct ray ray =
            camera_ray(&renderer->camera, (double)position->x + position->dx, (double)position->y + position->dy);
        double share = sample_share(renderer, position->number);
        ray.footprint.spread *= share;
        ray.footprint.width *= share;
        begin_sample(renderer, worker, position);
        begin_records(worker, i);
        batch->colours[i] = integrator_radiance_met(renderer, worker, &ray, met >> i & 1 ? &batch->answers[i] : NULL,
                                                    worker->state.sampler.key);
    }
    end_records(worker);
}

/* The first sample has number 0, at the centre or the corner of the pixel. */
struct pixel_sample renderer_first_sample(const struct renderer *renderer, int64_t x, int64_t y) {
    double at = renderer->job->settings.pixel_corner ? 0 : 0.5;
    return (struct pixel_sample){x, y, at, at, 0, 1};
}

/* See sampler.h. Keys below the key of the strata of a pixel: the number of a light, for the order of the strata on
 * that light; the key of a ray, for the strata on a rough surface; UINT64_MAX and the next lower one, for those of lens
 * and shutter; 2, for the jitter on the lens; from UINT64_MAX - 2 down, for the multi-jittered sets of the lights; and
 * 2^62, for the pattern in the pixel. */

static const uint64_t order_of_lens = UINT64_MAX, order_of_times = UINT64_MAX - 1, sets_of_lights = UINT64_MAX - 2;
static const uint64_t jitter_of_times = UINT64_MAX - 1; /* below the key of the sample */
static const uint64_t jitter_of_lens = 2;
static const uint64_t pattern_in_pixel = UINT64_C(1) << 62;

/* The part for this sample: the samples of a pixel visit each part once. */
static uint32_t part_of(const struct sampler *sampler, uint64_t dimension) {
    if (sampler->side <= 1)
        return 0;
    return sample_permute(sampler->cell, sampler->side * sampler->side, random_combine(sampler->pixel_key, dimension));
}

/* Cell (i, j) has its point in column j and row side - 1 - i of its side x side strata (the canonical arrangement of
 * Kensler's memo, math/sampling.c). So edges along rows and columns have side^2 steps instead of side. Edges at other
 * angles have at most the error of the regular grid. The points are symmetric about the centre, so the mean of a linear
 * function is exact. */
struct sample2 sampler_pixel_rotated(const struct sampler *sampler) {
    uint32_t n = sampler->side, i = sampler->cell % n, j = sampler->cell / n;
    uint64_t bits = random_combine(sampler->pixel_key, pattern_in_pixel);
    struct sample2 at = {((double)i + ((double)j + 0.5) / n) / n, ((double)j + ((double)(n - 1 - i) + 0.5) / n) / n};
    if (bits & 1)
        at.x = 1 - at.x;
    return bits & 2 ? (struct sample2){at.y, at.x} : at;
}

struct sample2 sampler_pixel_jittered(const struct sampler *sampler) {
    uint64_t set = random_combine(sampler->pixel_key, pattern_in_pixel);
    return sample_multi(set, random_combine(set, 0), (struct sample_part){0, 0, 1, sampler->cell, sampler->side});
}

struct sample2 sampler_lens(const struct sampler *sampler) {
    if (sampler->kind == SAMPLER_SOBOL)
        return sampler_point(sampler, SAMPLER_LENS);
    uint32_t side = sampler->side, cell = part_of(sampler, order_of_lens);
    return sample_cell(random_combine(sampler->pixel_key, jitter_of_lens), cell % side, cell / side, side);
}

double sampler_time(const struct sampler *sampler) {
    if (sampler->kind == SAMPLER_SOBOL)
        return sampler_point(sampler, SAMPLER_TIME).x;
    uint32_t all = sampler->side * sampler->side, cell = part_of(sampler, order_of_times);
    return ((double)cell + random_unit(random_combine(sampler->key, jitter_of_times))) / (double)all;
}

struct sample_set sampler_facets(const struct sampler *sampler, uint64_t ray_key, uint64_t rough_key, uint32_t side) {
    if (sampler->side <= 1)
        return (struct sample_set){.kind = SAMPLE_SET_JITTERED, .key = rough_key, .side = side};
    return (struct sample_set){.kind = SAMPLE_SET_PARTS,
                               .key = rough_key,
                               .side = side,
                               .part = part_of(sampler, ray_key),
                               .parts = sampler->side};
}

struct sample_set sampler_on_light(const struct sampler *sampler, uint64_t light_key, uint32_t light, uint32_t side,
                                   bool shared) {
    if (!shared)
        return (struct sample_set){.kind = SAMPLE_SET_JITTERED, .key = light_key, .side = side};
    return (struct sample_set){.kind = SAMPLE_SET_MULTI,
                               .key = light_key,
                               .set_key = random_combine(sampler->pixel_key, sets_of_lights - light),
                               .side = side,
                               .part = part_of(sampler, light),
                               .parts = sampler->side};
}

/* The density is constant in each of FILTER_CELLS cells of half the filter, with the filter's integral over the cell,
 * so one table serves every filter. See filter_internal.h. */

static double gaussian(double x, double radius) {
    const double falloff = 2;
    return el_exp(-falloff * x * x) - el_exp(-falloff * radius * radius);
}

/* D. Mitchell and A. Netravali, "Reconstruction Filters in Computer Graphics", SIGGRAPH 1988, with B = C = 1/3. */
static double mitchell(double x) {
    if (x < 1)
        return (7 * x * x * x - 12 * x * x + 16.0 / 3) / 6;
    return (-7.0 / 3 * x * x * x + 12 * x * x - 20 * x + 32.0 / 3) / 6;
}

static double filter_radius(enum filter_kind kind) {
    switch (kind) {
    case FILTER_BOX:
        return 0.5;
    case FILTER_TENT:
        return 1;
    case FILTER_GAUSSIAN:
        return 1.5;
    case FILTER_MITCHELL:
        return 2;
    }
    UNREACHABLE("a filter of no kind");
}

static double filter_value(enum filter_kind kind, double x, double radius) {
    switch (kind) {
    case FILTER_BOX:
        return 1;
    case FILTER_TENT:
        return 1 - x;
    case FILTER_GAUSSIAN:
        return gaussian(x, radius);
    case FILTER_MITCHELL:
        return mitchell(x);
    }
    UNREACHABLE("a filter of no kind");
}

void filter_init(struct filter *filter, enum filter_kind kind) {
    double radius = filter_radius(kind), step = radius / FILTER_CELLS;
    filter->kind = kind;
    filter->radius = radius;
    filter->sums[0] = 0;
    for (int i = 0; i < FILTER_CELLS; i++) {
        double begin = filter_value(kind, i * step, radius), middle = filter_value(kind, (i + 0.5) * step, radius),
               end = filter_value(kind, (i + 1) * step, radius), value = (begin + 4 * middle + end) / 6; /* Simpson */
        filter->negative[i] = value < 0;
        filter->sums[i + 1] = filter->sums[i] + fabs(value);
    }
    for (int i = 1; i <= FILTER_CELLS; i++)
        filter->sums[i] /= filter->sums[FILTER_CELLS];
}

/* Inverts the integral from the centre on both sides; the sign goes into *weight. */
static double sample_axis(const struct filter *filter, double u, double *weight) {
    double side = u < 0.5 ? -1 : 1, target = fabs(2 * u - 1);
    int low = 0, high = FILTER_CELLS;
    while (high - low > 1) {
        int middle = (low + high) / 2;
        if (filter->sums[middle] <= target)
            low = middle;
        else
            high = middle;
    }
    double inside = filter->sums[low + 1] - filter->sums[low];
    double part = inside > 0 ? (target - filter->sums[low]) / inside : 0;
    if (filter->negative[low])
        *weight = -*weight;
    return 0.5 + side * (low + part) * (filter->radius / FILTER_CELLS);
}

struct filter_sample filter_sample(const struct filter *filter, struct sample2 u) {
    struct filter_sample sample = {u.x, u.y, 1};
    if (filter->kind == FILTER_BOX)
        return sample;
    sample.x = sample_axis(filter, u.x, &sample.weight);
    sample.y = sample_axis(filter, u.y, &sample.weight);
    return sample;
}
