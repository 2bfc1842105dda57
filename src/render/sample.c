/* One sample of a pixel, from the place in the picture to the colour; alone, or many whose camera rays go together. The
 * random key of a sample is a function of the pixel and of the sample's number. */
#include "render/run.h"

#include "base/random.h"
#include "render/story.h"

/* The camera at a ray's time. */
bool run_prepare_at(const struct render_job *job, double ray_time, struct camera_frame *out, char warning[256],
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

static struct vec3 sample_alone(struct run *run, struct worker *worker, const struct place *place) {
    uint64_t key = begin_sample(run, worker, place->x, place->y, place->number);
    double x = (double)place->x + place->dx, y = (double)place->y + place->dy, share = sample_share(run, place->number);
    const struct camera_frame *camera = &run->camera;
    double time = run->timed ? sample_time(&worker->tracer.strata, key) : 0;
    if (run->timed && run->job->settings.motion.moves) {
        char warning[256];
        struct error error;
        camera = &worker->camera;
        if (!run_prepare_at(run->job, time, &worker->camera, warning, &error))
            return vec3_all(0); /* the one moment in which a view turns through zero */
    }
    if (!camera_is_plain(camera))
        return sample_through(run, worker, camera, x, y, time, share, key);
    struct ray ray = camera_ray(camera, x, y);
    ray.time = time;
    return trace_from_eye(run, worker, &ray, share, key);
}

struct vec3 run_sample(struct run *run, struct worker *worker, const struct place *place) {
    if (!run->story)
        return sample_alone(run, worker, place);
    struct story_place told = {place->x, place->y, place->dx, place->dy, place->number};
    worker->tracer.story = run->story;
    story_sample_begin(run->story, &told);
    struct vec3 colour = sample_alone(run, worker, place);
    story_sample_end(run->story, &told, colour);
    return colour;
}

/* The samples of a batch, as run_sample would bring them. What the camera rays meet is looked for together. */
void run_sample_batch(struct run *run, struct worker *worker) {
    struct batch *batch = &worker->batch;
    if (!run->together || batch->count == 1) {
        for (uint32_t i = 0; i < batch->count; i++)
            batch->colours[i] = run_sample(run, worker, &batch->places[i]);
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
struct place run_first_place(const struct run *run, int64_t x, int64_t y) {
    double at = run->job->settings.pixel_corner ? 0 : 0.5;
    return (struct place){x, y, at, at, 0};
}

/* Whether the first sample is the one in the middle of N x N. */
bool run_first_counts(const struct run *run) {
    const struct settings *settings = &run->job->settings;
    return (settings->samples & 1) && !settings->pixel_corner && run->camera.lens.aperture == 0 && !run->timed;
}

/* Mean of the N x N samples; where one of them is the first sample again it is not traced twice. */
struct vec3 run_all_samples(struct run *run, struct worker *worker, int64_t x, int64_t y, const struct vec3 *first) {
    int n = run->job->settings.samples;
    bool reuse = run_first_counts(run);
    struct batch *batch = &worker->batch;
    struct vec3 sum = {0, 0, 0};
    int centre = reuse ? n / 2 * n + n / 2 : -1;
    for (int begin = 0; begin < n * n; begin += PACKET_RAYS) {
        int end = begin + PACKET_RAYS < n * n ? begin + PACKET_RAYS : n * n;
        batch->count = 0;
        for (int k = begin; k < end; k++) {
            if (k == centre && !first)
                batch->places[batch->count++] = run_first_place(run, x, y);
            else if (k != centre)
                batch->places[batch->count++] =
                    (struct place){x, y, (k % n + 0.5) / n, (k / n + 0.5) / n, (uint64_t)(k + 1)};
        }
        run_sample_batch(run, worker);
        uint32_t next = 0;
        for (int k = begin; k < end; k++)
            sum = vec3_add(sum, k == centre && first ? *first : batch->colours[next++]);
    }
    return vec3_scale(sum, 1 / ((double)n * (double)n));
}
