/* Light that comes straight from the lights of the scene, and that of the photon map. A light at a place, or one that
 * is shaded as from its centre, is one evaluation times the share of its shadow rays that arrive; of a lamp every
 * shadow ray is evaluated by itself. The places of a light's samples are cells of the unit square, parted once more
 * among the samples of a pixel. */
#include "render/direct.h"

#include "world/packet.h"

enum { AREA_BATCH = 256 }; /* shadow rays of one hit that are asked together */

/* A ray from the surface, on the side that `towards` lies on. */
static struct vec3 off_surface(const struct hit *hit, struct vec3 towards) {
    double side = vec3_dot(towards, hit->normal_geometric) < 0 ? -hit->offset : hit->offset;
    return vec3_add_scaled(hit->point, hit->normal_geometric, side);
}

static bool is_free(struct integrator_state *tracer, const struct hit *hit, struct vec3 from, struct vec3 direction,
                    double t_max) {
    struct ray shadow = {.origin = from,
                         .direction = direction,
                         .t_max = t_max,
                         .time = hit->time,
                         .passes = hit_passes(hit, direction)};
    tracer->shadow_rays++;
    bool free = !world_any(tracer->job->world, &shadow, tracer->scratch);
    bool known = !free && tracer->job->world->accel.kind != ACCEL_NONE;
    observe_shadow_rays(tracer->observer, 1, free,
                        known ? tracer->scratch->blockers[tracer->scratch->light] : OBSERVER_NO_BLOCKER);
    return free;
}

/* The shadow rays of one hit to a light with an extent, asked batch by batch. */
struct fan {
    const struct light *light;
    struct light_frame frame;
    struct vec3 from;
    struct sample_set places;
};

static struct fan fan_make(const struct integrator_state *tracer, const struct light *light, uint32_t number,
                           uint64_t key) {
    const struct settings *settings = &tracer->job->settings;
    uint32_t side = (uint32_t)(light->samples ? light->samples : settings->area_samples);
    if (settings->coarse && side > (uint32_t)settings->area_samples)
        side = (uint32_t)settings->area_samples;
    /* Lights of SPEC 1.4 keep their jitter; the others share the cells among the samples of a pixel. */
    bool shared = light->emits || light->kind != LIGHT_PARALLELOGRAM;
    return (struct fan){.light = light, .places = sampler_on_light(&tracer->sampler, key, number, side, shared)};
}

/* What stands between: not the hit's own primitive where all of it is behind the surface and all of the light before.
 */
static struct between fan_between(const struct world *world, const struct fan *fan, const struct hit *hit) {
    struct vec3 corner = fan->frame.corner, edge1 = fan->frame.edge1, edge2 = fan->frame.edge2;
    uint32_t passes = hit_passes(hit, vec3_sub(corner, fan->from));
    for (int i = 1; i < 4 && passes != 0; i++) {
        struct vec3 other = vec3_add(i & 1 ? vec3_add(corner, edge1) : corner, i & 2 ? edge2 : vec3_all(0));
        passes = hit_passes(hit, vec3_sub(other, fan->from));
    }
    return world_between(world, fan->from, corner, edge1, edge2, passes);
}

/* The share of a light that reaches the hit: 0 or 1 for a point, of jittered shadow rays for an extent. */
static double visible_share(struct integrator_state *tracer, const struct light *light, uint32_t number,
                            const struct hit *hit, uint64_t key) {
    const struct world *world = tracer->job->world;
    if (light->kind == LIGHT_DIRECTIONAL) {
        struct vec3 to_light = vec3_negate(light->direction);
        return is_free(tracer, hit, off_surface(hit, to_light), to_light, INFINITY);
    }
    struct vec3 from = off_surface(hit, vec3_sub(light->position, hit->point));
    if (!light_has_extent(light))
        return is_free(tracer, hit, from, vec3_sub(light->position, from), 1);
    struct fan fan = fan_make(tracer, light, number, key);
    fan.from = from;
    if (!light_frame_make(light, fan.from, &fan.frame))
        return is_free(tracer, hit, fan.from, vec3_sub(light->position, fan.from), 1);
    uint32_t all = fan.places.side * fan.places.side, seen = 0, have = 0;
    struct between between = fan_between(world, &fan, hit);
    tracer->shadow_rays += all;
    if (between.known && between.count == 0) {
        observe_shadow_rays(tracer->observer, all, all, OBSERVER_NO_BLOCKER);
        return 1;
    }
    struct vec3 targets[AREA_BATCH];
    for (uint32_t cell = 0; cell < all; cell++) {
        targets[have++] = light_target(light, &fan.frame, fan.from, sample_set_point(&fan.places, cell));
        if (have < AREA_BATCH && cell + 1 < all)
            continue;
        seen += world_visible(world, &between, fan.from, hit->time, targets, have, tracer->scratch, NULL);
        have = 0;
        if (integrator_cancelled(tracer))
            return 0;
    }
    observe_shadow_rays(tracer->observer, all, seen, OBSERVER_NO_BLOCKER);
    return (double)seen / (double)all;
}

/* Which of the targets of a fan arrive. Skies and lamps all around have no shaft: each ray looks for itself. */
static void ask_targets(struct integrator_state *tracer, const struct fan *fan, const struct hit *hit,
                        const struct vec3 *targets, uint32_t count, bool *visible) {
    if (fan->frame.bounded) {
        const struct world *world = tracer->job->world;
        struct between between = fan_between(world, fan, hit);
        uint32_t seen = world_visible(world, &between, fan->from, hit->time, targets, count, tracer->scratch, visible);
        tracer->shadow_rays += count;
        observe_shadow_rays(tracer->observer, count, seen, OBSERVER_NO_BLOCKER);
        return;
    }
    bool sky = fan->light->kind == LIGHT_SKY;
    for (uint32_t i = 0; i < count; i++)
        visible[i] =
            is_free(tracer, hit, fan->from, sky ? targets[i] : vec3_sub(targets[i], fan->from), sky ? INFINITY : 1);
}

/* A lamp: every shadow ray shades by itself, with the cosine at the lamp. Rays that cannot bring light are not asked.
 */
static struct vec3 lamp_light(struct integrator_state *tracer, const struct light *light, uint32_t number,
                              const struct hit *hit, const struct shading *shading, struct vec3 normal, uint64_t key) {
    struct vec3 sum = {0, 0, 0};
    struct fan fan = fan_make(tracer, light, number, key);
    /* What is lit is the ray's side, wherever the middle of the lamp may be. */
    fan.from = off_surface(hit, hit->front ? hit->normal_geometric : vec3_negate(hit->normal_geometric));
    if (!light_frame_make(light, fan.from, &fan.frame))
        return sum;
    uint32_t all = fan.places.side * fan.places.side, have = 0;
    struct vec3 targets[AREA_BATCH], carried[AREA_BATCH];
    bool visible[AREA_BATCH];
    for (uint32_t cell = 0; cell < all; cell++) {
        struct light_sample sample =
            light_sample_lamp(light, &fan.frame, fan.from, sample_set_point(&fan.places, cell));
        struct vec3 to_light = sample.target;
        if (light->kind != LIGHT_SKY)
            to_light = vec3_normalize(vec3_sub(sample.target, hit->point));
        struct vec3 arriving = vec3_mul(shading_evaluate(shading, normal, hit->view, to_light), sample.light);
        if (arriving.x != 0 || arriving.y != 0 || arriving.z != 0) {
            targets[have] = sample.target;
            carried[have++] = arriving;
        }
        if (have == 0 || (have < AREA_BATCH && cell + 1 < all))
            continue;
        ask_targets(tracer, &fan, hit, targets, have, visible);
        for (uint32_t i = 0; i < have; i++)
            sum = visible[i] ? vec3_add(sum, carried[i]) : sum;
        have = 0;
        if (integrator_cancelled(tracer))
            return vec3_all(0);
    }
    return vec3_scale(sum, 1 / (double)all);
}

/* One light shaded as from one place. */
static struct vec3 light_from_place(struct integrator_state *tracer, const struct light *light, uint32_t number,
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
    observe_light_place(tracer->observer, distance, strength, to_light, reflected);
    if (strength == 0 || (reflected.x == 0 && reflected.y == 0 && reflected.z == 0))
        return vec3_all(0);
    double share = visible_share(tracer, light, number, hit, key);
    return share == 0 ? vec3_all(0) : vec3_mul(vec3_scale(light->colour, share * strength), reflected);
}

/* What a surface shows of a sky: mirrored it sees the background itself, so a highlight would count that twice. */
static struct shading without_highlight(const struct shading *shading) {
    struct shading out = *shading;
    bool mirrors = false;
    out.count = 0;
    for (int i = 0; i < shading->count; i++) {
        mirrors = mirrors || shading->lobes[i].kind == LOBE_MIRROR || shading->lobes[i].kind == LOBE_REFRACT;
        if (shading->lobes[i].kind == LOBE_DIFFUSE)
            out.lobes[out.count++] = shading->lobes[i];
    }
    return mirrors ? out : *shading;
}

static struct vec3 one_light(struct integrator_state *tracer, const struct light *light, uint32_t number,
                             const struct hit *hit, const struct shading *shading, struct vec3 normal, uint64_t key) {
    if (light->kind == LIGHT_SKY) {
        struct shading matt = without_highlight(shading);
        return lamp_light(tracer, light, number, hit, &matt, normal, key);
    }
    return light->emits ? lamp_light(tracer, light, number, hit, shading, normal, key)
                        : light_from_place(tracer, light, number, hit, shading, normal, key);
}

struct vec3 direct_light(struct integrator_state *tracer, const struct hit *hit, const struct shading *shading,
                         struct vec3 normal, bool dark_side, uint64_t key) {
    const struct world *world = tracer->job->world;
    struct vec3 sum = vec3_mul(tracer->job->ambient, shading->ambient);
    for (uint32_t i = 0; i < world->light_count && !dark_side; i++) {
        const struct light *light = &world->lights[i];
        if (light->lit && !light->lit[hit->placed]) {
            observe_light_skipped(tracer->observer, i, light);
            continue;
        }
        tracer->scratch->light = i % WORLD_BLOCKERS;
        observe_light_begin(tracer->observer, i, light);
        struct vec3 own = one_light(tracer, light, i, hit, shading, normal, sampler_light(key, i));
        sum = vec3_add(sum, own);
        observe_light_end(tracer->observer, i, light, own);
    }
    struct vec3 photons = {0, 0, 0};
    bool asked = tracer->caustics && !dark_side;
    if (asked) {
        photons = photon_map_light(tracer->caustics, world, hit, shading, normal);
        sum = vec3_add(sum, photons);
    }
    observe_direct(tracer->observer,
                   &(struct observed_direct){tracer->job->ambient, vec3_mul(tracer->job->ambient, shading->ambient),
                                             photons, sum, asked});
    return sum;
}
