/* Pictures beside the picture, tile by tile after the picture is done. */
#include "render/integrator.h"

#include "math/range.h"
#include "render/aov.h"

#include <string.h>

/* Through the middle of the lens, when the shutter opens. */
static bool middle_ray(const struct renderer *renderer, const struct pixel_sample *place, struct ray *out) {
    double x = (double)place->x + place->dx, y = (double)place->y + place->dy;
    if (camera_is_plain(&renderer->camera)) {
        *out = camera_ray(&renderer->camera, x, y);
        return true;
    }
    return camera_ray_through(&renderer->camera, x, y, (struct sample2){0.5, 0.5}, 0, out);
}

static uint64_t work_of(const struct worker *worker) {
    const struct geom_scratch *done = &worker->scratch.geom;
    return done->cost.hierarchy_steps + done->cost.voxels + done->cost.triangle_tests + done->box_tests +
           done->shape_tests;
}

/* What the samples of a pixel cost, and how many there are. */
static void measure_pixel(struct renderer *renderer, struct worker *worker, int64_t x, int64_t y, float cost[3],
                          float samples[3]) {
    uint64_t work = work_of(worker), rays = worker->camera_rays;
    integrator_repeat(renderer, worker, x, y);
    for (int c = 0; c < 3; c++) {
        cost[c] = (float)(work_of(worker) - work);
        samples[c] = (float)(worker->camera_rays - rays);
    }
}

/* True where something had to be changed. */
static bool clamp_layers(float values[AOV_COUNT][3]) {
    bool clamped = false;
    for (int i = 0; i < AOV_COUNT; i++) {
        for (int c = 0; c < 3; c++) {
            float value = (float)number_clamped((double)values[i][c], (double)FLT_MAX);
            clamped = clamped || value != values[i][c]; /* NaN too */
            values[i][c] = value;
        }
    }
    return clamped;
}

void renderer_layer_item(void *context, uint32_t item, int index) {
    struct renderer *renderer = context;
    struct worker *worker = &renderer->workers[index];
    struct film *film = renderer->job->film;
    struct film_rectangle r = film_tile_rectangle(film, item);
    uint32_t mask = film->layer_mask;
    for (int64_t y = r.y0; y < r.y1; y++) {
        for (int64_t x = r.x0; x < r.x1 && !renderer_stopped(renderer, worker); x++) {
            size_t at = (size_t)(y - film->y0) * film->width + (size_t)(x - film->x0);
            float values[AOV_COUNT][3] = {{0}};
            struct pixel_sample place = renderer_first_sample(renderer, x, y);
            struct ray ray;
            if (middle_ray(renderer, &place, &ray))
                aov_surface(renderer->job->world, &ray, mask, &worker->scratch, values);
            if (mask & (UINT32_C(1) << AOV_COST | UINT32_C(1) << AOV_SAMPLES))
                measure_pixel(renderer, worker, x, y, values[AOV_COST], values[AOV_SAMPLES]);
            worker->clamped |= clamp_layers(values);
            for (int i = 0; i < AOV_COUNT; i++) {
                size_t plane = aov_layer(mask, (enum aov)i) * (size_t)film->width * film->height;
                if (mask >> i & 1)
                    memcpy(film->layers[plane + at], values[i], sizeof values[i]);
            }
        }
    }
}
