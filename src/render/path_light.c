/* The light that reaches a vertex of a path directly from the lights of the scene. Lights that a ray can hit are
 * sampled in two ways: by sampling the light, and by scattered rays that hit it. The power heuristic of multiple
 * importance sampling weights each sample (Veach 1997, equation 9.14). All other lights are sampled in the first way
 * only.
 *
 * Area lights do not block shadow rays. So a scattered ray adds the light of every area light that it crosses, and
 * continues: both ways give the same light. */
#include "light/light_edit.h"

#include "material/bsdf_select.h"
#include "material/medium_mix.h"
#include "render/media_light_internal.h"
#include "render/path_equiangular_internal.h"
#include "render/path_light_internal.h"
#include "world/world_describe.h"

/* The weight of a sample of density `pdf`, if the other strategy finds the same light with density `other`. */
static double weight_of(const struct path_tracer *tracer, enum path_strategy strategy, double pdf, double other) {
    if (tracer->strategy != PATH_STRATEGY_MIS)
        return tracer->strategy == strategy;
    return pdf * pdf / (pdf * pdf + other * other);
}

double path_light_weight(const struct path_tracer *tracer, double pdf, double other) {
    return weight_of(tracer, PATH_STRATEGY_LIGHTS, pdf, other);
}

struct colour path_without_thrown(const struct path_tracer *tracer, uint32_t light, struct colour thrown,
                                  struct colour radiance) {
    if (!tracer->photon_lights || light == LIGHT_NONE || !tracer->photon_lights[light])
        return radiance;
    return colour_mul(radiance, colour_sub(colour_all(1), thrown));
}

/* --- sampling a light --- */

/* f |cos| of a set of lobes. Classic lobes do not reflect light from behind the geometric surface. */
static inline struct colour scattered(const struct path_vertex *vertex, uint32_t lobes, struct vec3 wi) {
    const struct bsdf *bsdf = vertex->at.bsdf;
    if (bsdf && !(vec3_dot(wi, bsdf->geometric_side) > 0))
        lobes &= bsdf_lobes_with(bsdf, BSDF_TRANSMITS);
    return lobes ? interaction_eval(&vertex->at, lobes, BSDF_RADIANCE, wi) : colour_all(0);
}

/* Starts a ray to a sample on the side of the surface on which the light is, in the media on that side. */
static inline __attribute__((always_inline)) void leave_surface(const struct path_vertex *vertex,
                                                                struct path_shadow *out) {
    const struct world_light_sample *sample = &out->sample;
    const struct hit *hit = vertex->hit;
    struct ray *shadow = &out->ray;
    if (!(vec3_dot(sample->direction, vertex->at.bsdf->geometric_side) > 0)) {
        shadow->origin = hit_start(hit, vertex->ray, sample->direction);
        bsdf_cross(vertex->at.bsdf, &out->media);
    }
    shadow->direction = light_target_from(&sample->target, shadow->origin);
    /* A classic area light is shaded from its centre, which may be on the other side of the surface than this point. */
    double side = vec3_dot(sample->direction, hit->normal_geometric);
    struct hit_skip skip = sample->skip_primitive ? (struct hit_skip){sample->skip_primitive, 0}
                                                  : hit_skip_from(hit, side, shadow->direction);
    shadow->skip_primitive = skip.primitive;
    shadow->skip_part = skip.part;
}

static inline __attribute__((always_inline)) void send_shadow_ray(const struct path_vertex *vertex,
                                                                  struct path_shadow *out) {
    const struct world_light_sample *sample = &out->sample;
    struct ray *shadow = &out->ray;
    shadow->origin = vertex->receiver->from;
    shadow->t_min = 0;
    shadow->t_max = light_target_end(&sample->target);
    shadow->time = vertex->ray->time;
    shadow->footprint = (struct footprint){0, 0};
    shadow->media = &out->media;
    medium_stack_copy(&out->media, vertex->ray->media);
    if (vertex->at.bsdf) {
        leave_surface(vertex, out);
    } else {
        shadow->direction = light_target_from(&sample->target, shadow->origin);
        shadow->skip_primitive = sample->skip_primitive;
        shadow->skip_part = 0;
    }
    out->sent = true;
}

void path_send_shadow_ray(const struct path_vertex *vertex, struct path_shadow *out) {
    send_shadow_ray(vertex, out);
}

/* The random numbers of a stretch of a ray to a light from the last vertex of the path. */
static uint64_t stretch_key(const struct path *path, uint64_t stretch) {
    return random_combine(random_combine(path->sampler.key, path->dimension | SAMPLER_STRETCH), stretch);
}

struct colour path_light_arriving(const struct path_tracer *tracer, struct integrator_state *state,
                                  const struct path *path, struct path_shadow *shadow) {
    const struct world_lights *lights = &tracer->lights;
    const struct world_light_sample *sample = &shadow->sample;
    double end = shadow->ray.t_max;
    struct colour radiance = sample->radiance;
    state->scratch->light = sample->light % WORLD_SHADOW_CACHE;
    state->shadow_rays++;
    if (sample->decided) {
        shadow->ray.t_max = INFINITY;
        radiance = world_lights_seen_by(lights, &path->scatter, sample, &shadow->ray, state->scratch, &end);
    } else {
        radiance = colour_scale(radiance, world_lights_visible(lights, &shadow->ray, state->scratch));
    }
    if (tracer->has_fillings && !colour_is_black(radiance)) {
        uint64_t key = stretch_key(path, 0);
        struct medium_stack behind;
        return colour_mul(radiance, media_left(lights->world, &shadow->ray, end, &key, state->scratch, &behind));
    }
    if (colour_is_black(radiance) || !path_is_affected(tracer, MEDIUM_RAY_SHADOW, &shadow->ray))
        return radiance;
    return colour_mul(radiance, medium_ray_left(MEDIUM_RAY_SHADOW, &shadow->ray,
                                                end * vec3_length(shadow->ray.direction), stretch_key(path, 0)));
}

/* --- glowing media --- */

/* How many times the ray that ends in these media is in this one. */
static double times_in(const struct medium *medium, const struct medium_stack *media) {
    struct medium_mix mix;
    double times = 0;
    medium_stack_mix(media, &mix);
    for (uint32_t i = 0; i < mix.count; i++)
        times += mix.media[i] == medium;
    return times;
}

struct colour path_glow_light(const struct path_tracer *tracer, struct integrator_state *state, const struct path *path,
                              const struct path_vertex *vertex, uint32_t dimension, struct vec3 *direction) {
    const struct world_lights *lights = &tracer->lights;
    const double time = path->ray.time;
    const struct sampler *sampler = &path->sampler;
    struct path_shadow shadow;
    struct glow_sample at;
    if (!glow_sample(tracer->glow, time, sampler_point(sampler, dimension | SAMPLER_GLOW),
                     sampler_point(sampler, (dimension + 1) | SAMPLER_GLOW), &at))
        return colour_all(0);
    /* What the vertex scatters of its light. */
    const struct vec3 off = vec3_sub(at.point, vertex->receiver->point);
    const double square = vec3_dot(off, off);
    if (!(square > 0))
        return colour_all(0);
    *direction = vec3_normalize(off);
    struct colour light = scattered(vertex, vertex->at.lobes, *direction);
    if (colour_is_black(light))
        return light;
    const double density = medium_density(at.medium, at.point, time);
    light = colour_mul(light, medium_emission_at(at.medium, density, at.point, time));
    if (colour_is_black(light))
        return light;
    /* What of it arrives. */
    shadow.sample = (struct world_light_sample){.direction = *direction, .target = {.at = at.point}};
    path_send_shadow_ray(vertex, &shadow);
    state->shadow_rays++;
    light = colour_scale(light, world_lights_visible(lights, &shadow.ray, state->scratch));
    if (colour_is_black(light))
        return light;
    const uint64_t key = random_combine(sampler->key, dimension | SAMPLER_GLOW);
    struct medium_stack media;
    light = colour_mul(light, media_left(lights->world, &shadow.ray, shadow.ray.t_max, &key, state->scratch, &media));
    const struct glow_met met = {tracer->glow, vertex->receiver->point, interaction_pdf(&vertex->at, *direction)};
    const double weight = met.pdf > 0 ? 1 - glow_met_weight(&met, at.medium, at.point, time) : 1;
    return colour_scale(light, times_in(at.medium, &media) * weight / (at.pdf * square));
}

/* --- kinds of scattering --- */

enum scattering { SCATTERING_DIFFUSE, SCATTERING_SPECULAR, SCATTERING_TRANSMISSION, SCATTERING_VOLUME };

static enum scattering scattering_of(unsigned lobe_flags) {
    return lobe_flags & BSDF_TRANSMITS ? SCATTERING_TRANSMISSION
           : lobe_flags & BSDF_DIFFUSE ? SCATTERING_DIFFUSE
                                       : SCATTERING_SPECULAR;
}

void path_share_all(unsigned flags, struct colour out[PATH_SCATTERINGS]) {
    for (int i = 0; i < PATH_SCATTERINGS; i++)
        out[i] = colour_all((int)scattering_of(flags) == i ? 1 : 0);
}

void path_share_volume(struct colour out[PATH_SCATTERINGS]) {
    for (int i = 0; i < PATH_SCATTERINGS; i++)
        out[i] = colour_all(i == SCATTERING_VOLUME ? 1 : 0);
}

void path_shares(const struct path_vertex *vertex, uint32_t lobes, struct vec3 wi,
                 struct colour out[PATH_SCATTERINGS]) {
    const struct bsdf *bsdf = vertex->at.bsdf;
    if (!bsdf) {
        path_share_volume(out);
        return;
    }
    const uint32_t of_kind[PATH_SCATTERINGS] = {[SCATTERING_DIFFUSE] = lobes & bsdf_select(bsdf, BSDF_FOR_DIFFUSE),
                                                [SCATTERING_SPECULAR] = lobes & bsdf_select(bsdf, BSDF_FOR_SPECULAR),
                                                [SCATTERING_TRANSMISSION] =
                                                    lobes & bsdf_select(bsdf, BSDF_FOR_TRANSMISSION)};
    struct colour sum = {0, 0, 0};
    for (int i = 0; i < PATH_SCATTERINGS; i++) {
        out[i] = of_kind[i] ? scattered(vertex, of_kind[i], wi) : colour_all(0);
        sum = colour_add(sum, out[i]);
    }
    for (int i = 0; i < PATH_SCATTERINGS; i++)
        out[i] = colour_share(out[i], sum);
    /* A channel that no lobe scatters: its light is 0 for any fraction. */
    out[0] = colour_sub(colour_all(1), colour_add(out[1], out[2]));
}

/* --- one light --- */

void path_direct_shares(const struct path_vertex *vertex, const struct path_choice *choice, struct vec3 wi,
                        struct colour shares[PATH_SCATTERINGS]) {
    struct colour f = choice->lobes, highlight = choice->highlight, sum = colour_add(f, highlight);
    path_shares(vertex, vertex->at.lobes, wi, shares);
    if (colour_is_black(highlight))
        return;
    struct colour all = colour_share(f, sum);
    for (int i = 0; i < PATH_SCATTERINGS; i++)
        shares[i] = colour_mul(shares[i], all);
    shares[SCATTERING_SPECULAR] = colour_add(shares[SCATTERING_SPECULAR], colour_sub(colour_all(1), all));
}

/* The part of a light to sample. Most lights with a position have one part, which needs no call. */
static inline struct light_part choose_part(const struct light_sampler *sampler, const struct light_receiver *receiver,
                                            double choice, double *pmf) {
    *pmf = 1;
    if (sampler->choice == LIGHT_CHOICE_TREE && sampler->infinite_count == 0 && sampler->node_count == 1)
        return sampler->nodes[0].part;
    return light_sampler_sample(sampler, receiver->point, receiver->normal, choice, pmf);
}

bool path_choose_light(const struct path_tracer *tracer, const struct path_vertex *vertex,
                       const struct path_light_draw *draw, struct path_shadow *out, struct path_choice *choice) {
    const struct world_lights *lights = &tracer->lights;
    struct world_light_sample *sample = &out->sample;
    double pmf;
    struct light_part part = out->part = choose_part(&lights->sampler, vertex->receiver, draw->choice, &pmf);
    out->sent = false;
    if (part.light == LIGHT_NONE ||
        (vertex->at.bsdf && !vertex->substitute && bsdf_is_smooth(vertex->at.bsdf, vertex->at.lobes)))
        return false;
    struct sample2 xi = {0, 0};
    if (!light_is_point(&lights->lights[part.light]))
        xi = sampler_point(draw->sampler, draw->dimension);
    if (!world_lights_sample(lights, vertex->receiver, part, xi, sample))
        return false;
    struct colour f = scattered(vertex, vertex->at.lobes, sample->direction);
    if (!vertex->substitute && colour_is_black(f))
        return false;
    if (tracer->photon_lights && !vertex->at.bsdf)
        f = path_without_thrown(tracer, part.light, vertex->thrown, f);
    uint32_t traced =
        tracer->photon_lights && vertex->at.bsdf ? vertex->at.lobes & bsdf_lobes_with(vertex->at.bsdf, BSDF_TRACED) : 0;
    if (traced && !colour_is_black(vertex->thrown)) {
        struct colour by_traced = scattered(vertex, traced, sample->direction);
        f = colour_sub(f, colour_sub(by_traced, path_without_thrown(tracer, part.light, vertex->thrown, by_traced)));
    }
    double pdf = pmf * sample->pdf;
    if (sample->is_delta) {
        f = colour_scale(f, 1 / pdf);
    } else {
        double other = interaction_pdf(&vertex->at, sample->direction);
        f = colour_scale(f, weight_of(tracer, PATH_STRATEGY_LIGHTS, pdf, other) / pdf);
    }
    if (vertex->tracked)
        f = colour_scale(f, path_tracked_weight(tracer, vertex->tracked, part, pmf));
    choice->lobes = f;
    choice->highlight = colour_all(0);
    /* Lines of sight do not meet lights that are not visible; scattered rays meet all but delta lights. Photons that
     * the mirror throws replace the highlight. */
    if (vertex->substitute && part.light < lights->world->light_count &&
        (vertex->sight ? !light_is_seen(&lights->lights[part.light]) : sample->is_delta))
        choice->highlight =
            path_without_thrown(tracer, part.light, vertex->thrown,
                                colour_scale(scattered(vertex, vertex->substitute, sample->direction), 1 / pdf));
    out->scattered = colour_add(f, choice->highlight);
    if (colour_is_black(out->scattered))
        return false;
    send_shadow_ray(vertex, out);
    return true;
}

/* --- rays that meet lights --- */

/* The weight of a scattered ray that hits a light; sampling the light would find this point with that density. */
static double met_weight(const struct path_tracer *tracer, const struct path_segment *segment, double pdf) {
    return segment->path->pdf == 0 ? 1 : weight_of(tracer, PATH_STRATEGY_BSDF, segment->path->pdf, pdf);
}

struct colour path_emission(const struct path_tracer *tracer, const struct path_segment *segment, const struct hit *hit,
                            struct colour emission) {
    const struct world_lights *lights = &tracer->lights;
    if (lights->of_primitive[hit->primitive] == LIGHT_NONE && colour_is_black(emission))
        return emission;
    struct colour radiance = world_lights_radiance(lights, segment->path->scatter.primitive, hit, emission);
    radiance = path_without_thrown(tracer, lights->of_primitive[hit->primitive], segment->path->thrown, radiance);
    if (colour_is_black(radiance) || segment->path->pdf == 0)
        return radiance;
    double pdf = world_lights_pdf_of_hit(lights, &segment->path->scatter, vec3_negate(hit->view), hit);
    return colour_scale(radiance, met_weight(tracer, segment, pdf));
}

struct colour path_area_lights(const struct path_tracer *tracer, const struct path_segment *segment, double t_max) {
    const struct world_lights *lights = &tracer->lights;
    struct colour sum = {0, 0, 0};
    struct world_lights_traversal traversal;
    struct light_hit hit;
    uint32_t number;
    if (lights->area_light_count == 0)
        return sum;
    struct ray ray = segment->path->ray;
    ray.t_max = t_max;
    ray.t_min = -segment->passed;
    world_lights_met_begin(&traversal, lights, &ray);
    while (world_lights_met_next(&traversal, &number, &hit)) {
        bool counted = segment->passed > 0 && !(hit.t > 0); /* before the hole */
        if (counted || !world_lights_illuminate(lights, number, segment->path->scatter.primitive))
            continue;
        struct colour radiance = light_emitted(&lights->lights[number], &ray, &hit);
        if (path_is_affected(tracer, MEDIUM_RAY_SCATTERED, &ray))
            radiance =
                colour_mul(radiance, medium_ray_left(MEDIUM_RAY_SCATTERED, &ray, hit.t * vec3_length(ray.direction),
                                                     stretch_key(segment->path, number)));
        radiance = path_without_thrown(tracer, number, segment->path->thrown, radiance);
        double pdf = world_lights_pdf(lights, &segment->path->scatter, number, vec3_normalize(ray.direction), &hit);
        sum = colour_add_scaled(sum, radiance, met_weight(tracer, segment, pdf));
    }
    return sum;
}

struct colour path_environment(const struct path_tracer *tracer, const struct path_segment *segment) {
    const struct world_lights *lights = &tracer->lights;
    const struct light_hit hit = {.t = INFINITY};
    struct colour sum = {0, 0, 0};
    struct vec3 direction = vec3_normalize(segment->path->ray.direction);
    for (uint32_t i = 0; i < lights->sampler.infinite_count; i++) {
        uint32_t number = lights->sampler.infinite[i];
        const struct light *light = &lights->lights[number];
        if (light_is_delta(light) || !world_lights_illuminate(lights, number, segment->path->scatter.primitive))
            continue;
        double pdf = world_lights_pdf(lights, &segment->path->scatter, number, direction, &hit);
        struct colour radiance =
            path_without_thrown(tracer, number, segment->path->thrown, light_emitted(light, &segment->path->ray, &hit));
        sum = colour_add_scaled(sum, radiance, met_weight(tracer, segment, pdf));
    }
    return sum;
}

bool path_area_light_seen(const struct path_tracer *tracer, const struct ray *ray, double t_max, double *t,
                          struct colour *radiance) {
    const struct world_lights *lights = &tracer->lights;
    struct light_hit hit;
    uint32_t number;
    if (lights->area_light_count == 0)
        return false;
    struct ray limited = *ray;
    limited.t_min = 0; /* also before boundaries without effect */
    limited.t_max = t_max;
    if (!world_lights_seen(lights, &limited, &number, &hit))
        return false;
    *radiance = light_emitted(&lights->lights[number], &limited, &hit);
    *t = hit.t;
    return true;
}
