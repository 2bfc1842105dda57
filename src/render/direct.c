/* Direct light from the lights of the scene, and that of the photon map. A delta light is one evaluation times the
 * share of its shadow rays that arrive; for an area light every shadow ray is evaluated separately. The samples of a
 * light are in cells of the unit square, which are divided once more among the samples of a pixel. */
#include "render/direct_internal.h"

#include "light/light_edit.h"
#include "render/media_light_internal.h"
#include "world/packet.h"

enum { AREA_BATCH = 256 }; /* shadow rays of one hit that are traced together */

/* The origin of shadow rays: on the viewer's side of the surface, for any position of the light. */
static struct vec3 off_surface(const struct hit *hit) {
    return vec3_add_scaled(hit->point, hit->normal_geometric, hit->front ? hit->offset : -hit->offset);
}

/* The side of the hit's surface on which an offset point is: the sign. */
static double side_of(const struct hit *hit, struct vec3 from) {
    return vec3_dot(vec3_sub(from, hit->point), hit->normal_geometric);
}

static bool is_free(struct integrator_state *state, const struct hit *hit, struct vec3 from, struct vec3 direction,
                    double t_max) {
    struct hit_skip skip = hit_skip_from(hit, side_of(hit, from), direction);
    struct ray shadow = {.origin = from,
                         .direction = direction,
                         .t_max = t_max,
                         .time = hit->time,
                         .skip_primitive = skip.primitive,
                         .skip_part = skip.part};
    state->shadow_rays++;
    bool free = !world_any(state->job->world, &shadow, state->scratch);
    uint32_t blocker = world_blocker(state->scratch);
    OBSERVE(state->observer, OBSERVED_SHADOW_RAYS,
            .shadow = {1, free, blocker == WORLD_NOTHING ? OBSERVER_NO_BLOCKER : blocker});
    return free;
}

static bool target_is_free(struct integrator_state *state, const struct hit *hit, struct vec3 from,
                           const struct light_target *target) {
    return is_free(state, hit, from, light_target_from(target, from), light_target_end(target));
}

/* The samples of the shadow rays of one hit to a light with an extent, batch by batch. */
static struct sample_set samples_on_light(const struct integrator_state *state, const struct light *light,
                                          const struct light_context *context, uint32_t number, uint64_t key) {
    const struct settings *settings = &state->job->settings;
    uint32_t side = (uint32_t)(light->samples ? light->samples : settings->area_samples);
    if (settings->coarse && side > (uint32_t)settings->area_samples)
        side = (uint32_t)settings->area_samples;
    return sampler_on_light(&state->sampler, key, number, side, context->shares_cells);
}

/* So few rays search alone in less time than it takes to find their occluders together. */
enum { FEW_RAYS = 4 };

/* Occluders, without the hit's own primitive if all of it is behind the surface and all of the light in front. */
static struct occluder_candidates light_occluder_candidates(const struct world *world,
                                                            const struct light_context *context, const struct hit *hit,
                                                            uint32_t rays) {
    struct vec3 corner = context->corner, edge1 = context->edge1, edge2 = context->edge2;
    double side = side_of(hit, context->from);
    uint32_t skip_primitive = hit_skip_primitive_from(hit, side, vec3_sub(corner, context->from));
    for (int i = 1; i < 4 && skip_primitive != 0; i++) {
        struct vec3 other = vec3_add(i & 1 ? vec3_add(corner, edge1) : corner, i & 2 ? edge2 : vec3_all(0));
        skip_primitive = hit_skip_primitive_from(hit, side, vec3_sub(other, context->from));
    }
    if (rays <= FEW_RAYS)
        return (struct occluder_candidates){.skip_primitive = skip_primitive, .known = false};
    return world_occluder_candidates(world, context->from, corner, edge1, edge2, skip_primitive);
}

/* The share of a delta light that reaches the hit: 0 or 1 for a point, of jittered shadow rays for an extent. */
static double visible_share(struct integrator_state *state, const struct light *light, uint32_t number,
                            const struct light_target *middle, const struct hit *hit, uint64_t key) {
    const struct world *world = state->job->world;
    struct light_context context;
    struct vec3 from = off_surface(hit);
    if (light_is_point(light))
        return target_is_free(state, hit, from, middle);
    if (!light_context_make(light, hit->point, from, &context))
        return 0;
    /* From here the lamp looks like a point. */
    if (context.single)
        return target_is_free(state, hit, from, middle);
    struct sample_set positions = samples_on_light(state, light, &context, number, key);
    uint32_t all = positions.side * positions.side, seen = 0, have = 0;
    struct occluder_candidates occluder_candidates = light_occluder_candidates(world, &context, hit, all);
    state->shadow_rays += all;
    /* Nothing lies between the point and the whole lamp. */
    if (occluder_candidates.known && occluder_candidates.count == 0) {
        OBSERVE(state->observer, OBSERVED_SHADOW_RAYS, .shadow = {all, all, OBSERVER_NO_BLOCKER});
        return 1;
    }
    struct vec3 targets[AREA_BATCH];
    for (uint32_t cell = 0; cell < all; cell++) {
        /* Shadow rays go in batches, which share the search for occluders. */
        targets[have++] = light_target_at(light, &context, sample_set_point(&positions, cell));
        if (have < AREA_BATCH && cell + 1 < all)
            continue;
        seen += world_visible(world, &occluder_candidates, &(struct shadow_rays){from, hit->time, targets, have},
                              state->scratch, NULL);
        have = 0;
        if (integrator_cancelled(state))
            return 0;
    }
    OBSERVE(state->observer, OBSERVED_SHADOW_RAYS, .shadow = {all, seen, OBSERVER_NO_BLOCKER});
    return (double)seen / (double)all;
}

/* The targets of shadow rays of one point, all distant or none. */
struct shadow_targets {
    const struct vec3 *at;
    uint32_t count;
    bool distant;
};

/* The visible targets. Lights on all sides have no shaft: rays are traced one by one. */
static void ask_targets(struct integrator_state *state, const struct light_context *context, const struct hit *hit,
                        const struct shadow_targets *targets, bool *visible) {
    uint32_t count = targets->count;
    if (context->bounded) {
        const struct world *world = state->job->world;
        struct occluder_candidates occluder_candidates = light_occluder_candidates(world, context, hit, count);
        uint32_t seen =
            world_visible(world, &occluder_candidates,
                          &(struct shadow_rays){context->from, hit->time, targets->at, count}, state->scratch, visible);
        state->shadow_rays += count;
        OBSERVE(state->observer, OBSERVED_SHADOW_RAYS, .shadow = {count, seen, OBSERVER_NO_BLOCKER});
        return;
    }
    for (uint32_t i = 0; i < count; i++) {
        struct light_target target = {targets->at[i], targets->distant};
        visible[i] = target_is_free(state, hit, context->from, &target);
    }
}

/* The reflection of a visible light: a mirroring surface shows its image, and a highlight would count the same light
 * again. */
static uint32_t without_highlight(const struct bsdf *bsdf) {
    uint32_t traced = bsdf_lobes_with(bsdf, BSDF_TRACED);
    return traced ? BSDF_ALL & ~(traced | bsdf_lobes_with(bsdf, BSDF_EXPONENT)) : BSDF_ALL;
}

/* An area light: every shadow ray is shaded separately, with the cosine at the light. Rays that cannot carry light are
 * not traced. */
static struct colour light_of_samples(struct integrator_state *state, const struct light *light, uint32_t number,
                                      const struct hit *hit, const struct bsdf *bsdf, uint64_t key) {
    uint32_t lobes = light_is_seen(light) ? without_highlight(bsdf) : BSDF_ALL;
    struct colour sum = {0, 0, 0};
    struct vec3 from = off_surface(hit);
    struct light_context context;
    if (!light_context_make(light, hit->point, from, &context))
        return sum;
    struct sample_set positions = samples_on_light(state, light, &context, number, key);
    uint32_t all = positions.side * positions.side, have = 0;
    struct vec3 targets[AREA_BATCH];
    struct colour carried[AREA_BATCH];
    bool visible[AREA_BATCH];
    for (uint32_t cell = 0; cell < all; cell++) {
        struct light_sample sample = light_sample(light, &context, sample_set_point(&positions, cell));
        struct colour arriving = colour_mul(bsdf_classic(bsdf, lobes, hit->view, sample.direction), sample.intensity);
        /* A sample whose light the surface does not reflect needs no shadow ray. */
        if (arriving.r != 0 || arriving.g != 0 || arriving.b != 0) {
            targets[have] = sample.target.at;
            carried[have++] = arriving;
        }
        if (have == 0 || (have < AREA_BATCH && cell + 1 < all))
            continue;
        ask_targets(state, &context, hit, &(struct shadow_targets){targets, have, sample.target.distant}, visible);
        for (uint32_t i = 0; i < have; i++)
            sum = visible[i] ? colour_add(sum, carried[i]) : sum;
        have = 0;
        if (integrator_cancelled(state))
            return colour_all(0);
    }
    return colour_scale(sum, 1 / (double)all);
}

/* A delta light: shaded once. */
static struct colour light_of_delta(struct integrator_state *state, const struct light *light, uint32_t number,
                                    const struct hit *hit, const struct bsdf *bsdf, uint64_t key) {
    struct light_arrival arrival;
    if (!light_arrive(light, hit->point, &arrival))
        return colour_all(0);
    uint32_t lobes = light_is_seen(light) ? without_highlight(bsdf) : BSDF_ALL;
    struct colour reflected = bsdf_classic(bsdf, lobes, hit->view, arrival.direction);
    OBSERVE(state->observer, OBSERVED_LIGHT_SAMPLE,
            .position = {arrival.distance, arrival.strength, arrival.direction, reflected});
    if (arrival.strength == 0 || colour_is_black(reflected))
        return colour_all(0);
    double share = visible_share(state, light, number, &arrival.middle, hit, key);
    return share == 0 ? colour_all(0) : colour_mul(colour_scale(arrival.colour, share * arrival.strength), reflected);
}

static struct colour one_light(struct integrator_state *state, const struct light *light, uint32_t number,
                               const struct hit *hit, const struct bsdf *bsdf, uint64_t key) {
    if (light_is_delta(light))
        return light_of_delta(state, light, number, hit, bsdf, key);
    return light_of_samples(state, light, number, hit, bsdf, key);
}

/* What media leave of a light's way to the hit, for all of the light that of its middle. */
static struct colour left_of_light(struct integrator_state *state, const struct light *light, const struct hit *hit) {
    struct light_target middle;
    if (!light_middle(light, &middle))
        return colour_all(1);
    struct ray ray = {.origin = off_surface(hit), .time = hit->time, .media = state->lit_from};
    ray.direction = light_target_from(&middle, ray.origin);
    struct medium_stack behind;
    return media_left(state->job->world, &ray, light_target_end(&middle), NULL, state->scratch, &behind);
}

struct colour direct_light(struct integrator_state *state, const struct hit *hit, const struct bsdf *bsdf,
                           uint64_t key) {
    const struct world *world = state->job->world;
    struct colour sum = colour_mul(state->job->ambient, bsdf->ambient);
    uint64_t reached = 0;
    for (uint32_t i = 0; i < world->light_count && !bsdf->dark; i++) {
        const struct light *light = &world->lights[i];
        /* The light has a list of what it lights. */
        if (light->lit && !light->lit[hit->primitive]) {
            OBSERVE(state->observer, OBSERVED_LIGHT_SKIPPED, .light = {i, light, OBSERVER_NO_BLOCKER, {0, 0, 0}});
            continue;
        }
        state->scratch->light = i % WORLD_SHADOW_CACHE;
        OBSERVE(state->observer, OBSERVED_LIGHT_BEGIN, .light = {i, light, OBSERVER_NO_BLOCKER, {0, 0, 0}});
        struct colour own = one_light(state, light, i, hit, bsdf, sampler_light(key, i));
        if (state->lit_from && !colour_is_black(own))
            own = colour_mul(own, left_of_light(state, light, hit));
        sum = colour_add(sum, own);
        reached |= (uint64_t)(own.r != 0 || own.g != 0 || own.b != 0) << i % 64;
        OBSERVE(state->observer, OBSERVED_LIGHT_END, .light = {i, light, OBSERVER_NO_BLOCKER, own});
    }
    /* Anti-aliasing compares which lights reach the first hits of neighbouring pixels. */
    if (state->camera_hit) {
        state->camera_hit->lights = reached;
        state->camera_hit = NULL;
    }
    struct colour photons = {0, 0, 0};
    bool asked = state->caustics && !bsdf->dark;
    if (asked) {
        photons = photon_map_light(state->caustics, world, hit, bsdf, BSDF_ALL);
        sum = colour_add(sum, photons);
    }
    OBSERVE(state->observer, OBSERVED_DIRECT,
            .direct = {state->job->ambient, colour_mul(state->job->ambient, bsdf->ambient), photons, sum, asked});
    return sum;
}
