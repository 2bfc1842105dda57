/* The render layers of a pixel: what its first sample hits, and the cost of all its samples. */
#include "render/aov_values_internal.h"

#include "film/path_film.h"
#include "light/light.h"
#include "material/material_eval.h"
#include "math/range.h"
#include "render/integrator_internal.h"
#include "render/sample_internal.h"
#include "world/world_describe.h"

#include <string.h>

static void set(float out[3], double x, double y, double z) {
    out[0] = (float)x;
    out[1] = (float)y;
    out[2] = (float)z;
}

/* The middle of a light that has one, as a ray from the hit; false for meshes and skies. */
static bool ray_to_light(const struct light *light, const struct hit *hit, struct ray *out) {
    struct light_target middle;
    if (!light_middle(light, &middle))
        return false;
    double across = vec3_dot(light_target_from(&middle, hit->point), hit->normal_geometric);
    *out = (struct ray){.t_max = light_target_end(&middle), .time = hit->time};
    out->origin = vec3_add_scaled(hit->point, hit->normal_geometric, across < 0 ? -hit->offset : hit->offset);
    out->direction = light_target_from(&middle, out->origin);
    return true;
}

static double lights_seen(const struct world *world, const struct hit *hit, struct world_scratch *scratch) {
    uint32_t seen = 0, all = 0;
    for (uint32_t i = 0; i < world->light_count; i++) {
        struct ray ray;
        if (!ray_to_light(&world->lights[i], hit, &ray))
            continue;
        all++;
        /* The surface hides points behind it, whether it is closed or not. */
        bool above = (vec3_dot(ray.direction, hit->normal_geometric) > 0) == hit->front;
        seen += above && !world_any(world, &ray, scratch);
    }
    return all > 0 ? (double)seen / (double)all : 0;
}

void aov_surface(const struct world *world, const struct ray *ray, uint32_t mask, struct world_scratch *scratch,
                 float out[AOV_COUNT][3]) {
    struct hit hit;
    struct bsdf bsdf;
    memset(out, 0, AOV_COUNT * sizeof *out);
    if (!world_nearest(world, ray, scratch, &hit))
        return;
    material_eval(&world->surfaces, &hit, NULL, NULL, &bsdf);
    double depth = hit.t * vec3_length(ray->direction), node = primitive_node(world, hit.primitive)->serial + 1.0;
    set(out[AOV_DEPTH], depth, depth, depth);
    set(out[AOV_NORMAL], bsdf.normal.x, bsdf.normal.y, bsdf.normal.z);
    set(out[AOV_ALBEDO], bsdf.albedo.r, bsdf.albedo.g, bsdf.albedo.b);
    double u, v;
    if (world_native_uv(world, &hit, &u, &v))
        set(out[AOV_UV], u, v, 1);
    set(out[AOV_NODE], node, node, node);
    double number = world->material_numbers[hit.material] + 1.0;
    set(out[AOV_MATERIAL], number, number, number);
    if (mask >> AOV_LIGHTS & 1) {
        double seen = lights_seen(world, &hit, scratch);
        set(out[AOV_LIGHTS], seen, seen, seen);
    }
}

/* Render layers, tile by tile after the picture is done. */

/* The cost of the samples of a pixel, and their number. */
static void measure_pixel(struct renderer *renderer, struct worker *worker, int64_t x, int64_t y, float cost[3],
                          float samples[3]) {
    uint64_t work = geom_work(&worker->scratch.geom), rays = worker->camera_rays;
    integrator_repeat(renderer, worker, x, y);
    for (int c = 0; c < 3; c++) {
        cost[c] = (float)(geom_work(&worker->scratch.geom) - work);
        samples[c] = (float)(worker->camera_rays - rays);
    }
}

/* True if a value was changed. */
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

/* What the film records of a path-traced pixel. */
static void path_layers(const struct film *film, size_t at, float values[AOV_COUNT][3]) {
    struct path_pixel pixel = path_film_load(film, at);
    struct colour raw = path_pixel_mean(&pixel), variance = path_pixel_variance_of_samples(&pixel);
    set(values[AOV_RAW], raw.r, raw.g, raw.b);
    set(values[AOV_VARIANCE], variance.r, variance.g, variance.b);
    for (int i = 0; i < PATH_LIGHT_GROUPS; i++) {
        struct colour light = path_pixel_light(&pixel, (enum path_light_group)i);
        set(values[AOV_EMISSION + i], light.r, light.g, light.b);
    }
}

void renderer_layer_pixel(struct renderer *renderer, struct worker *worker, int64_t x, int64_t y) {
    struct film *film = renderer->job->film;
    uint32_t mask = film->layer_mask;
    size_t at = (size_t)(y - film->y0) * film->width + (size_t)(x - film->x0);
    float values[AOV_COUNT][3] = {{0}};
    struct pixel_sample position = renderer_first_sample(renderer, x, y);
    struct ray ray;
    if (renderer_middle_ray(renderer, (double)position.x + position.dx, (double)position.y + position.dy, &ray))
        aov_surface(renderer->job->world, &ray, mask, &worker->scratch, values);
    if (mask & (UINT32_C(1) << AOV_COST | UINT32_C(1) << AOV_SAMPLES))
        measure_pixel(renderer, worker, x, y, values[AOV_COST], values[AOV_SAMPLES]);
    if (mask & AOV_PATH && integrator_traits(renderer->job->settings.integrator).has_light_parts)
        path_layers(film, at, values);
    worker->clamped |= clamp_layers(values);
    for (int i = 0; i < AOV_COUNT; i++) {
        size_t plane = aov_layer(mask, (enum aov)i) * (size_t)film->width * film->height;
        if (mask >> i & 1)
            memcpy(film->layers[plane + at], values[i], sizeof values[i]);
    }
}

void renderer_layer_item(void *context, uint32_t item, int index) {
    struct renderer *renderer = context;
    struct worker *worker = &renderer->workers[index];
    struct film_rectangle r = film_tile_rectangle(renderer->job->film, item);
    for (int64_t y = r.y0; y < r.y1; y++)
        for (int64_t x = r.x0; x < r.x1 && !renderer_stopped(renderer, worker); x++)
            renderer_layer_pixel(renderer, worker, x, y);
}
