/* See media_light_internal.h. Strata are equal in length in bounded media. In endless ones they are equal in the light
 * that is left by the mean of the channels. */
#include "render/media_light_internal.h"

#include "light/light_edit.h"
#include "material/medium_mix.h"
#include "math/elementary.h"
#include "world/joint.h"
#include "world/world_describe.h"

/* --- to a light --- */

static struct colour dimmed(const struct ray *ray, double distance, const uint64_t *key, uint64_t stretch) {
    struct medium_effect effect;
    if (key)
        return medium_ray_left(MEDIUM_RAY_SHADOW, ray, distance, random_combine(*key, stretch));
    (void)medium_transmittance(MEDIUM_RAY_SHADOW, ray, distance, &effect);
    return effect.transmittance;
}

struct colour media_left(const struct world *world, const struct ray *ray, double end, const uint64_t *key,
                         struct world_scratch *scratch, struct medium_stack *media) {
    struct ray rest = *ray;
    struct colour left = colour_all(1);
    double length = vec3_length(ray->direction);
    bool met = true;
    medium_stack_copy(media, ray->media);
    rest.media = media;
    for (uint64_t stretch = 0; met; stretch++) {
        struct hit hit;
        struct joint joint = {.joined = JOINED_NOT};
        rest.t_max = end;
        met = world_nearest_surface(world, &rest, scratch, &hit);
        if (met && world_touches(world, &hit))
            world_join_path(world, &rest, media, scratch, &hit, &joint);
        if (joint.joined == JOINED_AWAY)
            continue;
        left = colour_mul(left, dimmed(&rest, (met ? hit.t : end) * length, key, stretch));
        if (!met)
            break;
        rest = joint_ray_through_hole(&joint, &hit, &rest, media);
        rest.direction = ray->direction;
        (void)joint_pass_invisible(world, &joint, &hit, media);
        end -= hit.t;
    }
    return left;
}

bool media_dim_lights(const struct world *world) {
    bool any = (world_outside(world)->affects & MEDIUM_RAY_SHADOW) != 0;
    for (uint32_t i = 0; i < world->material_count && !any; i++)
        any = world->media.all[i].fills;
    return any;
}

/* --- from lights --- */

/* A point in the media. */
struct medium_point {
    struct ray ray; /* to a light, in the media */
    struct vec3 wo;
    const struct medium_mix *mix;
    double density[MEDIUM_MIX_LIMIT];
};

/* What the media scatter of light from wi, per unit of length. */
static struct colour scattered(const struct medium_point *at, struct vec3 wi) {
    struct colour sum = {0, 0, 0};
    for (uint32_t i = 0; i < at->mix->count; i++) {
        const struct medium *medium = at->mix->media[i];
        if (medium->scatters && at->density[i] > 0)
            sum = colour_add_scaled(sum, medium->scattering, at->density[i] * phase_eval(&medium->phase, at->wo, wi));
    }
    return sum;
}

/* The part of a lamp's light that arrives from a target. */
static struct colour arriving(struct integrator_state *state, struct medium_point *at,
                              const struct light_target *target) {
    const struct world *world = state->job->world;
    at->ray.direction = light_target_from(target, at->ray.origin);
    at->ray.t_max = light_target_end(target);
    state->shadow_rays++;
    if (world_any(world, &at->ray, state->scratch))
        return colour_all(0);
    struct medium_stack behind;
    return media_left(world, &at->ray, at->ray.t_max, NULL, state->scratch, &behind);
}

/* Lights in the units of direct.c: a white matt surface that faces one reflects its colour over pi. */
static struct colour of_light(struct integrator_state *state, struct medium_point *at, const struct light *light,
                              uint64_t key) {
    struct vec3 p = at->ray.origin;
    struct light_arrival arrival;
    struct light_context context;
    if (light_is_delta(light)) {
        if (!light_arrive(light, p, &arrival) || arrival.strength == 0)
            return colour_all(0);
        struct colour part =
            colour_mul(colour_scale(arrival.colour, PI * arrival.strength), scattered(at, arrival.direction));
        return colour_is_black(part) ? part : colour_mul(part, arriving(state, at, &arrival.middle));
    }
    if (!light_context_make(light, p, p, &context))
        return colour_all(0);
    struct sample2 u = {random_unit(random_combine(key, 1)), random_unit(random_combine(key, 2))};
    struct light_sample sample = light_sample(light, &context, u);
    struct colour part = colour_mul(colour_scale(sample.intensity, PI), scattered(at, sample.direction));
    return colour_is_black(part) ? part : colour_mul(part, arriving(state, at, &sample.target));
}

/* Where the strata are on a line, and how dense they are. */
struct strata {
    double from, to, rate; /* rate: of endless media; 0: all are equal in length */
};

/* False: nothing is on the line. */
static bool find_strata(const struct medium_mix *mix, const struct medium_line *line, struct strata *out) {
    *out = (struct strata){INFINITY, 0, 0};
    for (uint32_t i = 0; i < mix->count; i++) {
        const struct medium *medium = mix->media[i];
        struct colour e = medium->extinction;
        double from = 0, to = line->distance;
        if (medium->density) {
            const struct medium_line local = medium_placement_line(medium->placement, line);
            const struct ray ray = {.origin = local.origin, .direction = local.direction, .t_max = line->distance};
            struct box box = density_box(medium->density);
            if (!box_clip(&box, &ray, &from, &to))
                continue;
        }
        out->from = math_min(out->from, from);
        out->to = math_max(out->to, to);
        if (!medium->density || !(to < INFINITY))
            out->rate += (e.r + e.g + e.b) / 3;
    }
    return out->from < out->to && (out->to < INFINITY || out->rate > 0);
}

static double stratum_at(const struct strata *strata, double u, double *pdf) {
    double length = strata->to - strata->from, whole = -el_expm1(-strata->rate * length);
    if (!(whole > 0x1p-20)) {
        *pdf = 1 / length;
        return strata->from + u * length;
    }
    double t = -el_log(1 - u * whole) / strata->rate;
    *pdf = strata->rate * el_exp(-strata->rate * t) / whole;
    return strata->from + math_min(t, length);
}

struct colour media_in_scattering(struct integrator_state *state, const struct ray *ray, double distance,
                                  uint64_t key) {
    const struct world *world = state->job->world;
    struct medium_mix mix;
    struct strata strata;
    struct colour sum = {0, 0, 0}, left = {1, 1, 1};
    if (!medium_affects(MEDIUM_RAY_SHADOW, ray))
        return sum;
    medium_stack_mix(ray->media, &mix);
    bool shows_emission = mix.count > 1 || (mix.count == 1 && mix.media[0]->density);
    struct medium_line line = {ray->origin, vec3_normalize(ray->direction), distance, ray->time};
    if ((!shows_emission && !medium_mix_scatters(&mix)) || !find_strata(&mix, &line, &strata))
        return sum;
    struct medium_point at = {.wo = vec3_negate(line.direction), .mix = &mix};
    int count = state->job->settings.medium_samples;
    double before = 0;
    for (int k = 0; k < count; k++) {
        uint64_t own = random_combine(key, (uint64_t)k);
        double pdf, t = stratum_at(&strata, (k + random_unit(own)) / count, &pdf);
        /* What is left of light from there. */
        line.origin = vec3_add_scaled(ray->origin, line.direction, before);
        line.distance = t - before;
        left = colour_mul(left, medium_mix_dimmed(&mix, &line));
        before = t;
        at.ray = (struct ray){
            .origin = vec3_add_scaled(ray->origin, line.direction, t), .time = ray->time, .media = ray->media};
        struct colour here = {0, 0, 0};
        for (uint32_t i = 0; i < mix.count; i++) {
            at.density[i] = medium_density(mix.media[i], at.ray.origin, ray->time);
            if (shows_emission)
                here = colour_add(here, medium_emission_at(mix.media[i], at.density[i], at.ray.origin, ray->time));
        }
        for (uint32_t i = 0; i < world->light_count; i++)
            here = colour_add(here, of_light(state, &at, &world->lights[i], random_combine(own, i)));
        sum = colour_add(sum, colour_mul(left, colour_scale(here, 1 / (pdf * count))));
        if (integrator_cancelled(state))
            break;
    }
    return sum;
}
