/* See whitted.h. A path is (ray, key, counters): the key makes every random number a function of pixel, sample and the
 * way through the tree of rays. */
#include "render/whitted.h"

#include "base/random.h"
#include "look/microfacet.h"
#include "math/sampling.h"
#include "render/interface.h"

struct path {
    uint64_t key;
    int reflections, refractions; /* so far, from the camera */
    bool rough;                   /* after a rough surface: the next ones get one ray each */
    double weight;                /* how much of what this ray brings can arrive in the pixel */
};

static struct vec3 trace(struct tracer *tracer, const struct ray *ray, struct path path);

/* --- light that arrives directly --- */

enum { AREA_BATCH = 256 }; /* shadow rays of one hit that are asked together */

/* A ray from the surface, on the side that `towards` lies on. */
static struct vec3 off_surface(const struct hit *hit, struct vec3 towards) {
    double side = vec3_dot(towards, hit->normal_geometric) < 0 ? -hit->offset : hit->offset;
    return vec3_add_scaled(hit->point, hit->normal_geometric, side);
}

static bool is_free(struct tracer *tracer, struct vec3 from, struct vec3 direction, double t_max, double time) {
    struct ray shadow = {.origin = from, .direction = direction, .t_max = t_max, .time = time};
    tracer->shadow_rays++;
    return !world_any(tracer->job->world, &shadow, tracer->scratch);
}

/* The shadow rays of one hit to a light with an extent, asked batch by batch. */
struct fan {
    const struct light *light;
    struct light_frame frame;
    struct vec3 from;
    uint32_t side; /* side x side rays */
    uint64_t key;
    uint32_t turn, turns;
};

static struct fan fan_make(const struct tracer *tracer, const struct light *light, uint32_t number, uint64_t key) {
    struct fan fan = {.light = light, .key = key};
    fan.side = (uint32_t)(light->samples ? light->samples : tracer->job->settings.area_samples);
    /* Lights of SPEC 1.4 keep their jitter; the others share the cells among the samples of a pixel. */
    bool parted = light->emits || light->kind != LIGHT_PARALLELOGRAM;
    fan.turns = parted ? tracer->strata.side : 1;
    fan.turn = parted ? sample_turn(&tracer->strata, number) : 0;
    return fan;
}

static struct vec3 fan_target(const struct fan *fan, uint32_t cell) {
    uint32_t i = cell % fan->side, j = cell / fan->side;
    struct sample2 place = fan->turns > 1 ? sample_cell_part(fan->key, i, j, fan->side, fan->turn, fan->turns)
                                          : sample_cell(fan->key, i, j, fan->side);
    return light_target(fan->light, &fan->frame, fan->from, place);
}

/* The share of a light that reaches the hit: 0 or 1 for a point, of jittered shadow rays for an extent. */
static double visible_share(struct tracer *tracer, const struct light *light, uint32_t number, const struct hit *hit,
                            uint64_t key) {
    const struct world *world = tracer->job->world;
    if (light->kind == LIGHT_DIRECTIONAL) {
        struct vec3 to_light = vec3_negate(light->direction);
        return is_free(tracer, off_surface(hit, to_light), to_light, INFINITY, hit->time);
    }
    struct vec3 from = off_surface(hit, vec3_sub(light->position, hit->point));
    if (!light_has_extent(light))
        return is_free(tracer, from, vec3_sub(light->position, from), 1, hit->time);
    struct fan fan = fan_make(tracer, light, number, key);
    fan.from = from;
    if (!light_frame_make(light, fan.from, &fan.frame))
        return is_free(tracer, fan.from, vec3_sub(light->position, fan.from), 1, hit->time);
    uint32_t all = fan.side * fan.side, seen = 0, have = 0;
    struct vec3 targets[AREA_BATCH];
    for (uint32_t cell = 0; cell < all; cell++) {
        targets[have++] = fan_target(&fan, cell);
        if (have < AREA_BATCH && cell + 1 < all)
            continue;
        seen += world_count_visible(world, fan.from, hit->time, fan.frame.corner, fan.frame.edge1, fan.frame.edge2,
                                    targets, have, tracer->scratch);
        have = 0;
        if (tracer->pool && pool_cancelled(tracer->pool))
            return 0;
    }
    tracer->shadow_rays += all;
    return (double)seen / (double)all;
}

/* A lamp: every shadow ray shades by itself, with the cosine at the lamp. Rays that cannot bring light are not asked.
 */
static struct vec3 lamp_light(struct tracer *tracer, const struct light *light, uint32_t number, const struct hit *hit,
                              const struct shading *shading, struct vec3 normal, uint64_t key) {
    struct vec3 sum = {0, 0, 0};
    struct fan fan = fan_make(tracer, light, number, key);
    /* What is lit is the ray's side, wherever the middle of the lamp may be. */
    fan.from = off_surface(hit, hit->front ? hit->normal_geometric : vec3_negate(hit->normal_geometric));
    if (!light_frame_make(light, fan.from, &fan.frame))
        return sum;
    uint32_t all = fan.side * fan.side, have = 0;
    struct vec3 targets[AREA_BATCH], carried[AREA_BATCH];
    bool visible[AREA_BATCH];
    for (uint32_t cell = 0; cell < all; cell++) {
        struct vec3 target = fan_target(&fan, cell);
        struct vec3 to_light = vec3_normalize(vec3_sub(target, hit->point));
        struct vec3 reflected = shading_evaluate(shading, normal, hit->view, to_light);
        double weight = light_target_weight(light, &fan.frame, hit->point, target);
        if (weight > 0 && (reflected.x != 0 || reflected.y != 0 || reflected.z != 0)) {
            targets[have] = target;
            carried[have++] = vec3_scale(reflected, weight);
        }
        if (have == 0 || (have < AREA_BATCH && cell + 1 < all))
            continue;
        (void)world_visible(tracer->job->world, fan.from, hit->time, fan.frame.corner, fan.frame.edge1, fan.frame.edge2,
                            targets, have, tracer->scratch, visible);
        tracer->shadow_rays += have;
        for (uint32_t i = 0; i < have; i++)
            sum = visible[i] ? vec3_add(sum, carried[i]) : sum;
        have = 0;
    }
    return vec3_scale(vec3_mul(light->colour, sum), 1 / (double)all);
}

/* One light shaded as from one place. */
static struct vec3 light_from_place(struct tracer *tracer, const struct light *light, uint32_t number,
                                    const struct hit *hit, const struct shading *shading, struct vec3 normal,
                                    uint64_t key) {
    bool distant = light->kind == LIGHT_DIRECTIONAL;
    struct vec3 to_light = distant ? vec3_negate(light->direction) : vec3_sub(light->position, hit->point);
    double distance = distant ? 1 : vec3_length(to_light), strength = 1;
    if (!(distance > 0))
        return vec3_all(0);
    if (!distant) {
        to_light = vec3_scale(to_light, 1 / distance);
        strength = light_attenuation(light, distance) * light_cone(light, vec3_negate(to_light));
    }
    struct vec3 reflected = shading_evaluate(shading, normal, hit->view, to_light);
    if (strength == 0 || (reflected.x == 0 && reflected.y == 0 && reflected.z == 0))
        return vec3_all(0);
    double share = visible_share(tracer, light, number, hit, key);
    return share == 0 ? vec3_all(0) : vec3_mul(vec3_scale(light->colour, share * strength), reflected);
}

static struct vec3 own_light(struct tracer *tracer, const struct hit *hit, const struct shading *shading,
                             struct vec3 normal, bool dark_side, uint64_t key) {
    const struct world *world = tracer->job->world;
    struct vec3 sum = vec3_mul(tracer->job->ambient, shading->ambient);
    for (uint32_t i = 0; i < world->light_count && !dark_side; i++) {
        const struct light *light = &world->lights[i];
        if (light->lit && !light->lit[hit->placed])
            continue;
        uint64_t light_key = random_combine(key, i);
        sum = vec3_add(sum, light->emits ? lamp_light(tracer, light, i, hit, shading, normal, light_key)
                                         : light_from_place(tracer, light, i, hit, shading, normal, light_key));
    }
    return sum;
}

/* The nearest light that shows itself before t_max, or NULL. */
static const struct light *visible_light(const struct world *world, const struct ray *ray, double t_max, double *t) {
    const struct light *best = NULL;
    struct ray limited = *ray;
    limited.t_max = t_max;
    for (uint32_t i = 0; i < world->light_count; i++) {
        if (world->lights[i].visible && light_meets_ray(&world->lights[i], &limited, t)) {
            best = &world->lights[i];
            limited.t_max = *t;
        }
    }
    *t = limited.t_max;
    return best;
}

/* --- secondary rays --- */

static bool is_black(struct vec3 c) {
    return c.x == 0 && c.y == 0 && c.z == 0;
}

/* Times the filter. What cannot change the pixel by the cut-off is not followed. */
static struct vec3 follow_mirror(struct tracer *tracer, const struct hit *hit, const struct ray *ray,
                                 struct vec3 direction, struct vec3 filter, struct path path) {
    const struct settings *settings = &tracer->job->settings;
    path.weight *= vec3_max_abs(filter);
    if (path.reflections >= settings->reflect_limit || path.weight < settings->cutoff)
        return vec3_all(0);
    struct ray reflected = interface_ray(hit, ray, direction, ray->media);
    tracer->reflected_rays++;
    path.key = random_combine(path.key, UINT32_MAX);
    path.reflections++;
    return vec3_mul(filter, trace(tracer, &reflected, path));
}

static struct vec3 follow_refraction(struct tracer *tracer, const struct hit *hit, const struct ray *ray,
                                     struct vec3 direction, const struct media *behind, struct vec3 filter,
                                     struct path path) {
    const struct settings *settings = &tracer->job->settings;
    path.weight *= vec3_max_abs(filter);
    if (path.refractions >= settings->refract_limit || path.weight < settings->cutoff)
        return vec3_all(0);
    struct ray refracted = interface_ray(hit, ray, direction, behind);
    tracer->refracted_rays++;
    path.key = random_combine(path.key, (uint64_t)UINT32_MAX + 1);
    path.refractions++;
    return vec3_mul(filter, trace(tracer, &refracted, path));
}

/* A rough surface: the mean over facets of what each reflects and refracts. */
struct rough {
    const struct hit *hit;
    const struct ray *ray;
    const struct interface *interface;
    double alpha;
    int samples;
};

enum { GLOSSY_SAMPLES = 4 };

static struct vec3 follow_rough(struct tracer *tracer, const struct rough *rough, struct vec3 mirror,
                                struct vec3 refraction, struct path path) {
    const struct hit *hit = rough->hit;
    uint32_t n = path.rough ? 1 : rough->samples ? (uint32_t)rough->samples : GLOSSY_SAMPLES;
    uint32_t turns = tracer->strata.side, turn = turns > 1 ? sample_turn(&tracer->strata, path.key) : 0;
    uint64_t key = random_combine(path.key, (uint64_t)UINT32_MAX + 2);
    struct vec3 sum = {0, 0, 0};
    for (uint32_t cell = 0; cell < n * n; cell++) {
        struct sample2 place = turns > 1 ? sample_cell_part(key, cell % n, cell / n, n, turn, turns)
                                         : sample_cell(key, cell % n, cell / n, n);
        struct vec3 facet = microfacet_normal(rough->interface->side, hit->view, rough->alpha, place);
        struct path branch = path;
        branch.key = random_combine(key, cell);
        branch.rough = true;
        if (!is_black(mirror)) {
            struct vec3 direction = interface_facet_mirror(rough->interface, facet, hit->view);
            sum = vec3_add(sum, follow_mirror(tracer, hit, rough->ray, direction, mirror, branch));
        }
        if (!is_black(refraction)) {
            struct vec3 direction = interface_facet_through(rough->interface, facet, hit->view);
            struct vec3 light =
                follow_refraction(tracer, hit, rough->ray, direction, &rough->interface->behind, refraction, branch);
            sum = vec3_add(sum, light);
        }
    }
    return vec3_scale(sum, 1 / ((double)n * (double)n));
}

/* --- one hit --- */

static struct vec3 shade(struct tracer *tracer, const struct ray *ray, const struct hit *hit, struct path path) {
    const struct settings *settings = &tracer->job->settings;
    struct surface_look look;
    material_look(tracer->job->world->materials[hit->material], hit, &look);
    struct interface interface;
    interface_make(hit, ray->media, &look, &interface);
    bool dark_side = !hit->front && !look.two_sided;
    struct vec3 normal = look.two_sided && !hit->front ? vec3_negate(hit->normal) : hit->normal;
    struct shading shading;
    material_shading(&look, settings->specular, settings->ambient_plain, &shading);
    struct vec3 colour = own_light(tracer, hit, &shading, normal, dark_side, path.key);
    colour = vec3_add(colour, shading.emission);

    struct vec3 mirror = {0, 0, 0}, refraction = {0, 0, 0};
    for (int i = 0; i < shading.count; i++) {
        if (shading.lobes[i].kind == LOBE_MIRROR)
            mirror = vec3_add(mirror, shading.lobes[i].weight);
        if (shading.lobes[i].kind == LOBE_REFRACT)
            refraction = vec3_add(refraction, shading.lobes[i].weight);
    }
    /* Total internal reflection: the refracted share turns back, or is lost. Fresnel's has none left by itself. */
    if (!interface.passes) {
        if (settings->use_tir)
            mirror = vec3_add(mirror, refraction);
        refraction = vec3_all(0);
    }
    if (shading.alpha > 0) {
        struct rough rough = {hit, ray, &interface, shading.alpha, look.glossy_samples};
        return vec3_add(colour, follow_rough(tracer, &rough, mirror, refraction, path));
    }
    if (!is_black(mirror)) {
        struct vec3 direction = interface_mirror(&interface, hit->view);
        colour = vec3_add(colour, follow_mirror(tracer, hit, ray, direction, mirror, path));
    }
    if (!is_black(refraction)) {
        colour = vec3_add(colour,
                          follow_refraction(tracer, hit, ray, interface.through, &interface.behind, refraction, path));
    }
    return colour;
}

static struct vec3 trace(struct tracer *tracer, const struct ray *ray, struct path path) {
    const struct world *world = tracer->job->world;
    const struct fog *fog = tracer->job->fog;
    struct hit hit;
    if (tracer->pool && pool_cancelled(tracer->pool))
        return vec3_all(0); /* deep paths through glass grow exponentially */
    bool met = world_nearest(world, ray, tracer->scratch, &hit);
    double end;
    const struct light *lamp = visible_light(world, ray, met ? hit.t : ray->t_max, &end);

    /* What is between here and there. */
    bool inside = ray->media && ray->media->count > 0, endless = !met && !lamp, clear = true;
    double length = vec3_length(ray->direction), distance = endless ? INFINITY : end * length;
    struct vec3 left = {1, 1, 1};
    if (inside) {
        left = media_left(ray->media, distance);
        clear = false;
    } else if (fog && !(endless && fog->clear_sky)) {
        left = vec3_all(fog_transmittance(fog, ray->origin, vec3_scale(ray->direction, 1 / length), distance));
        clear = false;
    }
    path.weight *= vec3_max_abs(left);

    struct vec3 colour = {0, 0, 0};
    if (path.weight < tracer->job->settings.cutoff)
        left = vec3_all(0);
    else if (lamp)
        colour = lamp->colour;
    else if (met)
        colour = shade(tracer, ray, &hit, path);
    else
        colour = sky_colour(&world->sky, vec3_normalize(ray->direction), ray->footprint.spread);
    if (clear)
        return colour;
    colour = vec3_mul(colour, left);
    return inside ? colour : vec3_add_scaled(colour, fog->colour, 1 - left.x);
}

struct vec3 whitted_trace(struct tracer *tracer, const struct ray *ray, uint64_t key) {
    struct ray from_eye = *ray;
    from_eye.media = tracer->eye_media;
    return trace(tracer, &from_eye, (struct path){.key = key, .weight = 1});
}
