/* Layers and their colours. Colours do not depend on the picture where that can be avoided, so that two pictures can be
 * compared: cost goes by its logarithm from black (1) over blue, red and yellow to white (2^20); numbers of nodes and
 * materials get colours by a hash. Depth is nearest / distance, as in depth buffers. */
#include "render/aov.h"

#include "base/random.h"
#include "light/light.h"
#include "material/material_eval.h"
#include "material/texture_mapping.h"
#include "math/elementary.h"
#include "math/range.h"
#include "render/integrator_internal.h"
#include "render/path_film.h"

#include <string.h>

#define AOV_NAME(aov, name, channels) [aov] = (name),
#define AOV_CHANNELS(aov, name, channels) [aov] = (channels),
static const char *const names[] = {AOVS(AOV_NAME)};

const char *aov_name(enum aov aov) {
    return names[aov];
}

const char *aov_channels(enum aov aov) {
    static const char *const all[] = {AOVS(AOV_CHANNELS)};
    return all[aov];
}

bool aov_parse(const char *text, uint32_t *mask) {
    *mask = 0;
    for (const char *at = text;; at++) {
        size_t size = strcspn(at, ",");
        uint32_t found = size == 3 && memcmp(at, "all", 3) == 0 ? AOV_ALL : 0;
        for (int i = 0; i < AOV_COUNT; i++)
            if (strlen(names[i]) == size && memcmp(at, names[i], size) == 0)
                found = UINT32_C(1) << i;
        if (found == 0)
            return false;
        *mask |= found;
        at += size;
        if (*at == '\0')
            return true;
    }
}

uint32_t aov_layers(uint32_t mask) {
    return (uint32_t)__builtin_popcount(mask & AOV_ALL);
}

uint32_t aov_layer(uint32_t mask, enum aov aov) {
    return aov_layers(mask & ((UINT32_C(1) << aov) - 1));
}

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
    material_eval(&world->materials[hit.material], &hit, NULL, NULL, &bsdf);
    double depth = hit.t * vec3_length(ray->direction), node = primitive_node(world, hit.primitive)->serial + 1.0;
    set(out[AOV_DEPTH], depth, depth, depth);
    set(out[AOV_NORMAL], bsdf.normal.x, bsdf.normal.y, bsdf.normal.z);
    set(out[AOV_ALBEDO], bsdf.albedo.x, bsdf.albedo.y, bsdf.albedo.z);
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

struct aov_scale aov_scale(enum aov aov, const float (*values)[3], size_t count) {
    struct aov_scale scale = {INFINITY, 1};
    for (size_t i = 0; i < count && (aov == AOV_DEPTH || aov == AOV_SAMPLES); i++) {
        double value = (double)values[i][0];
        scale.nearest = value > 0 && value < scale.nearest ? value : scale.nearest;
        scale.max = value > scale.max ? value : scale.max;
    }
    return scale;
}

static double clamp01(double x) {
    return x >= 1 ? 1 : x > 0 ? x : 0;
}

/* Black, blue, red, yellow, white at 0, 1/4 ... 1. */
static void heat(double x, double rgb[3]) {
    static const double stops[5][3] = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {1, 1, 0}, {1, 1, 1}};
    double position = clamp01(x) * 4;
    int below = position >= 3 ? 3 : (int)position;
    for (int c = 0; c < 3; c++)
        rgb[c] = stops[below][c] + (position - below) * (stops[below + 1][c] - stops[below][c]);
}

static double fraction(double x) {
    return x - floor(x);
}

void aov_colour(enum aov aov, const struct aov_scale *scale, const float value[3], double rgb[3]) {
    const double v[3] = {(double)value[0], (double)value[1], (double)value[2]};
    for (int c = 0; c < 3; c++)
        rgb[c] = clamp01(v[c]);
    switch (aov) {
    case AOV_DEPTH:
        rgb[0] = rgb[1] = rgb[2] = v[0] > 0 ? clamp01(scale->nearest / v[0]) : 0;
        break;
    case AOV_NORMAL:
        for (int c = 0; c < 3 && (v[0] != 0 || v[1] != 0 || v[2] != 0); c++)
            rgb[c] = clamp01((v[c] + 1) / 2);
        break;
    case AOV_UV:
        rgb[0] = fraction(v[0]);
        rgb[1] = fraction(v[1]);
        break;
    case AOV_NODE:
    case AOV_MATERIAL:
        for (uint32_t c = 0; c < 3 && v[0] > 0; c++)
            rgb[c] = 0.25 + 0.75 * random_unit(random_combine((uint64_t)v[0], c));
        break;
    case AOV_COST:
        heat(v[0] > 0 ? el_log(v[0]) / (20 * 0.69314718055994530942) : 0, rgb);
        break;
    case AOV_SAMPLES:
        rgb[0] = rgb[1] = rgb[2] = v[0] / scale->max;
        break;
    case AOV_ALBEDO:
    case AOV_LIGHTS:
    case AOV_RAW:
    case AOV_VARIANCE:
    case AOV_EMISSION:
    case AOV_DIFFUSE_DIRECT:
    case AOV_DIFFUSE_INDIRECT:
    case AOV_SPECULAR_DIRECT:
    case AOV_SPECULAR_INDIRECT:
    case AOV_TRANSMISSION_DIRECT:
    case AOV_TRANSMISSION_INDIRECT:
        break;
    }
}

/* Render layers, tile by tile after the picture is done. */

static uint64_t work_of(const struct worker *worker) {
    const struct geom_scratch *done = &worker->scratch.geom;
    return done->cost.hierarchy_steps + done->cost.voxels + done->cost.triangle_tests + done->box_tests +
           done->shape_tests;
}

/* The cost of the samples of a pixel, and their number. */
static void measure_pixel(struct renderer *renderer, struct worker *worker, int64_t x, int64_t y, float cost[3],
                          float samples[3]) {
    uint64_t work = work_of(worker), rays = worker->camera_rays;
    integrator_repeat(renderer, worker, x, y);
    for (int c = 0; c < 3; c++) {
        cost[c] = (float)(work_of(worker) - work);
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
    struct vec3 raw = path_pixel_mean(&pixel), variance = path_pixel_variance_of_samples(&pixel);
    set(values[AOV_RAW], raw.x, raw.y, raw.z);
    set(values[AOV_VARIANCE], variance.x, variance.y, variance.z);
    for (int i = 0; i < PATH_LIGHT_GROUPS; i++) {
        struct vec3 light = path_pixel_light(&pixel, (enum path_light_group)i);
        set(values[AOV_EMISSION + i], light.x, light.y, light.z);
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
