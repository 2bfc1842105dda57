/* What an observer gets to know of a path: its rays in order, and what each adds to it. Where OBSERVED is 0 (see
 * path_pieces_internal.h) these functions do nothing, and `watch` is NULL. */
#ifndef GRAY_RENDER_PATH_WATCH_INTERNAL_H
#define GRAY_RENDER_PATH_WATCH_INTERNAL_H

#include "material/medium_mix.h"
#include "render/path_state_internal.h"

/* The stages of a vertex. */
enum path_stage { STAGE_BEFORE_HIT, STAGE_EMISSION, STAGE_PHOTONS, STAGE_DIRECT, STAGES };

/* Of a longer path only the first rays. */
struct path_watch {
    struct watched_ray {
        struct colour weight, light;  /* of the path at the start of the ray */
        struct colour arriving;       /* the weight of the path at the hit */
        struct colour lights[STAGES]; /* the radiance of the path after each stage */
        double distance;              /* at which a visible light ends the path, or the medium scatters it */
        bool in_medium;
        double chance; /* of the medium to scatter it before the end of the ray */
    } rays[64];
    int count;
    int scatterings; /* under the surface that the path has gone through last */
    bool cut;        /* the current ray is none of them */
    enum path_end end;
};

static inline struct watched_ray *watched_ray(struct path_watch *watch) {
    return watch->cut ? NULL : &watch->rays[watch->count - 1];
}

static inline void watch_stage(struct path_watch *watch, const struct path *path, enum path_stage stage) {
    struct watched_ray *ray = OBSERVED ? watched_ray(watch) : NULL;
    for (int i = (int)stage; ray && i < STAGES; i++)
        ray->lights[i] = path->light;
}

/* The ray has arrived at its hit, or at a light at this distance. */
static inline void watch_arrival(struct path_watch *watch, const struct path *path, double distance) {
    struct watched_ray *ray = OBSERVED ? watched_ray(watch) : NULL;
    if (!ray)
        return;
    ray->arriving = path->weight;
    ray->distance = distance;
    watch_stage(watch, path, STAGE_BEFORE_HIT);
}

/* The medium scatters the path at the distance where watch_arrival said that it is; the ray would have ended at
 * `end`. */
static inline void watch_medium(struct path_watch *watch, const struct path *path, double end) {
    struct watched_ray *ray = OBSERVED ? watched_ray(watch) : NULL;
    if (!ray)
        return;
    const struct medium_line line = {path->ray.origin, vec3_normalize(path->ray.direction), end, path->ray.time};
    struct medium_mix mix;
    medium_stack_mix(path->ray.media, &mix);
    double sum = ray->weight.r + ray->weight.g + ray->weight.b;
    ray->in_medium = true;
    ray->chance = sum > 0 ? 1 - colour_dot(ray->weight, medium_mix_dimmed(&mix, &line)) / sum : 0;
}

static inline void watch_walk(struct path_watch *watch, int scatterings) {
    if (OBSERVED)
        watch->scatterings = scatterings;
}

/* The path ends for this reason: false. */
static inline bool watch_end(struct path_watch *watch, enum path_end why) {
    if (OBSERVED)
        watch->end = why;
    return false;
}

#if OBSERVED

/* The ray of the path is its next one. hit: or NULL. */
static void watch_ray(struct path_watch *watch, const struct observer *observer, const struct path *path,
                      const struct hit *hit) {
    enum { LIMIT = sizeof watch->rays / sizeof *watch->rays };
    watch->cut = watch->count == LIMIT;
    watch->end = PATH_GOES_ON;
    if (watch->cut)
        return;
    double distance = hit ? hit->t * vec3_length(path->ray.direction) : INFINITY;
    if (watch->count > 0)
        OBSERVE(observer, OBSERVED_RAY_SENT,
                .sent = {(enum ray_kind)path->kind, colour_share(path->weight, watch->rays[watch->count - 1].arriving),
                         RAY_FOLLOWED});
    watch->rays[watch->count++] = (struct watched_ray){.weight = path->weight, .light = path->light};
    watch_arrival(watch, path, 0);
    OBSERVE(observer, OBSERVED_RAY_BEGIN,
            .begin = {&path->ray, hit, NULL, distance, math_min(colour_max_abs(path->weight), 1),
                      path->kind == RAY_BELOW ? watch->scatterings : 0});
}

/* The end of the current ray: what its hit adds to the path. */
static void watch_vertex(struct path_watch *watch, const struct observer *observer, bool has_photons) {
    const struct watched_ray *ray = watched_ray(watch);
    if (!ray)
        return;
    struct colour gains[STAGES];
    for (int i = STAGE_EMISSION; i < STAGES; i++)
        gains[i] = colour_share(colour_sub(ray->lights[i], ray->lights[i - 1]), ray->arriving);
    OBSERVE(observer, OBSERVED_VERTEX,
            .vertex = {.end = watch->end,
                       .distance = ray->distance,
                       .in_medium = ray->in_medium,
                       .chance = ray->chance,
                       .emission = gains[STAGE_EMISSION],
                       .photons = gains[STAGE_PHOTONS],
                       .direct = colour_add(gains[STAGE_PHOTONS], gains[STAGE_DIRECT]),
                       .has_photons = has_photons});
}

/* The path has ended. */
static void watch_path(const struct path_watch *watch, const struct observer *observer, const struct path *path) {
    for (int i = watch->count - 1; i >= 0; i--) {
        const struct watched_ray *ray = &watch->rays[i];
        struct colour before = ray->lights[STAGE_BEFORE_HIT];
        OBSERVE(observer, OBSERVED_RAY_END,
                .end = {.evaluated = true,
                        .seen = colour_share(colour_sub(path->light, before), ray->arriving),
                        .left = colour_share(ray->arriving, ray->weight),
                        .in_scattered = colour_share(colour_sub(before, ray->light), ray->weight),
                        .brings = colour_share(colour_sub(path->light, ray->light), ray->weight)});
    }
}

/* The light that was chosen, and what arrived of it. */
static void watch_light(const struct observer *observer, const struct world_lights *lights,
                        const struct path_shadow *shadow, bool arrived, struct colour light) {
    if (shadow->part.light == LIGHT_NONE)
        return;
    uint32_t number = shadow->part.light, primitive = lights->emitters[number].primitive;
    OBSERVE(
        observer, OBSERVED_LIGHT_BEGIN,
        .light = {
            number, &lights->lights[number], primitive == WORLD_NOTHING ? OBSERVER_NO_BLOCKER : primitive, {0, 0, 0}});
    if (shadow->sent)
        OBSERVE(observer, OBSERVED_SHADOW_RAYS, .shadow = {1, arrived, OBSERVER_NO_BLOCKER});
    OBSERVE(observer, OBSERVED_LIGHT_END, .light = {number, &lights->lights[number], OBSERVER_NO_BLOCKER, light});
}

#endif

#endif
