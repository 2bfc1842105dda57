/* The pieces of a path, cut at its rays, each a function of the state of the path:
 *     begin    the sampler (path.c) and the camera ray (sample.c)
 *     extend   what the ray hits first
 *     shade    what is there: emission, the choice of a light, the next ray
 *     come_out the same where light comes out from under a surface (subsurface_walk_internal.h), without a ray
 *     shadow   whether the light arrives
 *     add      the light of a path that has ended becomes part of its pixel, in the order of samples (path.c)
 * A thread calls them for one path after the other. They call no allocator, no function pointer and not themselves;
 * what is below world_nearest_crossing and world_any may.
 *
 * A file that includes this one defines PATH(name), LAYERS, OBSERVED and MATTER: whether paths record light layers and
 * features (state->parts), whether they report to an observer, and whether there may be media, dispersion or walks
 * under surfaces (tracer->has_matter).
 *
 * A path ends at the sky, at the maximum depth, by Russian roulette, or at a visible area light. A *line of sight* is a
 * camera ray, with its continuations by smooth surfaces and through holes. Lines of sight show the background, visible
 * area lights and fog. All other rays are scattered: they add the light that a surface receives, weighted against the
 * samples of lights. */

#include "material/bsdf_select.h"
#include "material/medium_mix.h"
#include "math/range.h"
#include "math/spectrum.h"
#include "render/path_equiangular_internal.h"
#include "render/path_light_internal.h"
#include "render/path_trace_internal.h"
#include "render/path_watch_internal.h"
#include "render/subsurface_walk_internal.h"
#include "world/joint.h"
#include "world/world_describe.h"

#include <string.h>

enum { HOLE_LIMIT = 200 };           /* holes that a ray passes in succession, as in Whitted's integrator */
static const double survival = 0.95; /* at most, on surfaces that spread light */

/* --- layers and features --- */

/* Where they are recorded, or NULL. */
static struct path_parts *parts_of(const struct integrator_state *state) {
    return LAYERS ? state->parts : NULL;
}

/* Adds light that was scattered `depth` times, divided by the kinds of its first scattering. */
static void add_to_groups(struct path_parts *parts, int depth, const struct colour shares[PATH_SCATTERINGS],
                          struct colour light) {
    if (depth == 0) {
        parts->light[PATH_LIGHT_EMISSION] = colour_add(parts->light[PATH_LIGHT_EMISSION], light);
        return;
    }
    for (int i = 0; i < PATH_SCATTERINGS; i++) {
        struct colour *group = &parts->light[PATH_LIGHT_DIFFUSE_DIRECT + 2 * i + (depth > 1)];
        *group = colour_add(*group, colour_mul(shares[i], light));
    }
}

/* The hit of the path's ray. */
static void add_light(const struct integrator_state *state, struct path *path, struct colour radiance) {
    if (colour_is_black(radiance))
        return;
    struct colour light = colour_mul(path->weight, radiance);
    path->light = colour_add(path->light, light);
    struct path_parts *parts = parts_of(state);
    if (parts)
        add_to_groups(parts, path->depth, parts->shares, light);
}

static double compressed(double x) {
    return x > 0 ? x / (1 + x) : 0;
}

/* The groups of light that a line of sight shows. */
static struct colour light_albedo(struct colour radiance) {
    return colour_make(compressed(radiance.r), compressed(radiance.g), compressed(radiance.b));
}

static float in_unit(double x) {
    return x >= 1 ? 1 : x > 0 ? (float)x : 0;
}

/* The weight as for white light. */
static struct colour neutral_weight(const struct path *path) {
    if (!(path->media.wavelength > 0))
        return path->weight;
    return colour_share(path->weight, spectrum_weight((double)path->media.wavelength));
}

/* The end of a line of sight. distance: along the last ray of the path. */
static void set_features(const struct integrator_state *state, const struct path *path, struct colour albedo,
                         struct vec3 normal, double distance) {
    struct path_parts *parts = parts_of(state);
    if (!parts || parts->surface_known)
        return;
    parts->surface_known = true;
    const struct colour behind = colour_mul(neutral_weight(path), albedo);
    const struct colour a =
        parts->reflected > 0 ? colour_add_scaled(parts->seen, behind, 1 - parts->reflected) : behind;
    const float features[PATH_GLOW] = {in_unit(a.r),
                                       in_unit(a.g),
                                       in_unit(a.b),
                                       (float)normal.x,
                                       (float)normal.y,
                                       (float)normal.z,
                                       (float)number_clamped(distance, (double)FLT_MAX)};
    memcpy(parts->features, features, sizeof features);
}

/* Records the features of a surface that scatters light in more than single directions, or emits light. */
static void meet_features(const struct integrator_state *state, const struct path *path, const struct hit *hit,
                          const struct bsdf *bsdf) {
    struct path_parts *parts = parts_of(state);
    if (!parts || !path->sight)
        return;
    const struct bsdf_guide guide = bsdf_guide(bsdf, light_albedo(bsdf->emission));
    parts->travelled += hit->t * vec3_length(path->ray.direction);
    if (guide.scatters || colour_max_abs(bsdf->emission) > 0) {
        set_features(state, path, guide.albedo, bsdf->lit, parts->travelled);
    } else if (guide.refracted > 0 && parts->reflected == 0) {
        parts->reflected = guide.reflected / (guide.reflected + guide.refracted);
        parts->seen = colour_scale(neutral_weight(path), parts->reflected);
    }
}

/* --- on the way --- */

/* A scattered ray. passed: after holes, the line began at t = -passed. */
static struct path_segment segment_of(const struct path *path, double passed) {
    return (struct path_segment){path, passed};
}

/* After holes, the distance from where the line began, in t of the ray. */
static double passed_of(const struct path *path) {
    if (path->kind != RAY_HOLE)
        return 0;
    return vec3_length(vec3_sub(path->ray.origin, path->scatter.from)) / vec3_length(path->ray.direction);
}

/* Where a ray ends; nothing hit is a hit, too. */
enum travelled { ENDS_AT_HIT, ENDS_AT_LIGHT, ENDS_IN_MEDIUM };

/* How far it comes, and the medium that scatters it there, or NULL. tracked: of path_equiangular_internal.h. */
struct path_stretch {
    double distance, end; /* the end of the ray */
    const struct medium *medium;
    struct path_tracked tracked;
};

/* The random numbers of the media along the path's ray. */
static uint64_t medium_key(const struct path *path) {
    return random_combine(path->sampler.key, path->dimension | SAMPLER_MEDIUM);
}

/* The samples of lights on the way, and what weights those of the vertex against them: the weight of the path is still
 * that before the way. */
static __attribute__((noinline)) void sample_aimed_light(const struct path_tracer *tracer,
                                                         struct integrator_state *state, struct path *path,
                                                         const struct medium_mix *mix, double distance,
                                                         struct path_aimed *choice) {
    struct colour light = colour_mul(path->weight, path_aimed_light(tracer, state, path, mix, distance, choice));
    struct path_parts *parts = parts_of(state);
    path->light = colour_add(path->light, light);
    if (!parts || colour_is_black(light))
        return;
    struct colour scattered[PATH_SCATTERINGS];
    path_share_volume(scattered);
    add_to_groups(parts, path->depth + 1, path->depth == 0 ? scattered : parts->shares, light);
}

/* What weights the light at a vertex against those samples. */
static void note_tracked(const struct path *path, const struct medium_mix *mix, struct colour weight, double end,
                         struct path_stretch *out) {
    const struct medium_line line = {path->ray.origin, vec3_normalize(path->ray.direction), out->distance,
                                     path->ray.time};
    out->tracked.ray = &path->ray;
    out->tracked.end = end;
    out->tracked.distance = out->distance;
    out->tracked.density = medium_mix_density(mix, &line, weight);
}

/* Passes the medium, up to out->distance. */
static void pass_single(const struct path_tracer *tracer, struct integrator_state *state, struct path *path,
                        const struct medium *medium, enum medium_ray kind, struct path_stretch *out) {
    struct medium_effect effect;
    if (medium->scatters) {
        const struct sample2 u = sampler_point(&path->sampler, path->dimension | SAMPLER_MEDIUM);
        const struct medium_mix mix = {1, {medium}};
        const double end = out->distance;
        const bool aimed = path_is_aimed(tracer, path);
        const struct colour weight = path->weight;
        add_light(state, path, medium_emission(medium, end));
        if (aimed)
            sample_aimed_light(tracer, state, path, &mix, end, &out->tracked.choice);
        struct medium_sample sample = medium_sample(medium, end, weight, u);
        path->weight = colour_mul(weight, sample.weight);
        out->distance = sample.distance;
        out->medium = sample.scatters ? medium : NULL;
        if (aimed && sample.scatters)
            note_tracked(path, &mix, weight, end, out);
        return;
    }
    if (medium_transmittance(kind, &path->ray, out->distance, &effect)) {
        add_light(state, path, effect.added);
        path->weight = colour_mul(path->weight, effect.transmittance);
    }
}

/* The same for several together, and for a density. */
static __attribute__((noinline)) void pass_mix(const struct path_tracer *tracer, struct integrator_state *state,
                                               struct path *path, enum medium_ray kind, struct path_stretch *out) {
    struct medium_mix mix;
    struct medium_track track;
    medium_stack_mix(path->ray.media, &mix);
    if (mix.count == 0)
        return;
    if (mix.count == 1 && !mix.media[0]->density) {
        pass_single(tracer, state, path, mix.media[0], kind, out);
        return;
    }
    const double end = out->distance;
    const struct medium_line line = {path->ray.origin, vec3_normalize(path->ray.direction), end, path->ray.time};
    const struct glow_met met = {tracer->glow, path->scatter.point, path->pdf};
    const struct medium_draw numbers = {sampler_point(&path->sampler, path->dimension | SAMPLER_MEDIUM),
                                        medium_key(path), tracer->glow && path->pdf > 0 ? &met : NULL};
    const struct colour weight = path->weight;
    medium_mix_track(&mix, &line, weight, numbers, &track);
    add_light(state, path, track.emitted);
    /* What only absorbs does not end the path. */
    if (!medium_mix_scatters(&mix)) {
        path->weight = colour_mul(weight, medium_mix_left(&mix, &line, random_combine(medium_key(path), 0)));
        return;
    }
    const bool aimed = path_is_aimed(tracer, path);
    if (aimed)
        sample_aimed_light(tracer, state, path, &mix, end, &out->tracked.choice);
    path->weight = colour_mul(weight, track.weight);
    out->distance = track.distance;
    out->medium = track.scatterer;
    if (aimed && track.scatterer)
        note_tracked(path, &mix, weight, end, out);
}

/* Passes what is around the ray, up to out->distance. */
static void pass_medium(const struct path_tracer *tracer, struct integrator_state *state, struct path *path,
                        enum medium_ray kind, struct path_stretch *out) {
    const struct medium *medium = medium_stack_current(path->ray.media);
    out->end = out->distance;
    out->medium = NULL;
    out->tracked.density = 0;
    if (medium->mixed)
        pass_mix(tracer, state, path, kind, out);
    else
        pass_single(tracer, state, path, medium, kind, out);
}

/* The depth is that of what is behind, as far as that is seen: that of single events would be noise, and so would be
 * that of a horizon. */
static double depth_in_medium(const struct medium *medium, double before, double end) {
    const struct medium_mix mix = {1, {medium}};
    double haze = medium_mix_haze(&mix), depth = haze > 0 ? math_min(end, 4 / haze) : end;
    return depth < INFINITY ? before + depth : 0;
}

/* Adds everything between the origin of the ray and its end: area lights, media. out: set unless it ends at
 * its hit without a medium. */
static enum travelled travel(const struct path_tracer *tracer, struct integrator_state *state, struct path *path,
                             const struct hit *hit, struct path_watch *watch, struct path_stretch *out) {
    double end = hit ? hit->t : path->ray.t_max;
    struct colour radiance;
    bool seen = false;
    if (path->sight) {
        seen = path_area_light_seen(tracer, &path->ray, end, &end, &radiance);
    } else if (tracer->lights.area_light_count > 0) {
        const struct path_segment segment = segment_of(path, passed_of(path));
        add_light(state, path, path_area_lights(tracer, &segment, end));
    }
    enum medium_ray kind = path->sight ? MEDIUM_RAY_SIGHT : MEDIUM_RAY_SCATTERED;
    if (!seen && !(MATTER && path_is_affected(tracer, kind, &path->ray)))
        return ENDS_AT_HIT;
    out->distance = hit || seen ? end * vec3_length(path->ray.direction) : INFINITY;
    out->medium = NULL;
    if (MATTER)
        pass_medium(tracer, state, path, kind, out);
    if (out->medium)
        return ENDS_IN_MEDIUM;
    if (!seen)
        return ENDS_AT_HIT;
    const struct path_parts *parts = parts_of(state);
    set_features(state, path, light_albedo(radiance), vec3_all(0), parts ? parts->travelled + out->distance : 0);
    watch_arrival(watch, path, out->distance);
    add_light(state, path, radiance);
    watch_stage(watch, path, STAGE_EMISSION);
    (void)watch_end(watch, PATH_SEES_LIGHT);
    return ENDS_AT_LIGHT;
}

static void leave_scene(const struct path_tracer *tracer, struct integrator_state *state, struct path *path) {
    const struct world *world = state->job->world;
    if (state->job->settings.transparent && path->sight && path->depth == 0) {
        state->seen_through += (path->weight.r + path->weight.g + path->weight.b) / 3;
        set_features(state, path, colour_all(0), vec3_all(0), 0);
    } else if (path->sight) {
        struct colour sky = sky_colour(&world->sky, vec3_normalize(path->ray.direction), path->ray.footprint.spread);
        set_features(state, path, light_albedo(sky), vec3_all(0), 0);
        add_light(state, path, sky);
    } else {
        const struct path_segment segment = segment_of(path, 0);
        add_light(state, path, path_environment(tracer, &segment));
    }
}

/* --- the next ray --- */

/* False: the path ends here. Paths with weights above 1 can end, too. The chance is the square root of the weight: if
 * it were the weight itself, the paths that stay would all have the weight 1, and the loss of the others would add more
 * noise than their rays cost. `spreads`: on a surface, to more than single directions. Media scatter so often that even
 * .95 would leave few, heavy paths; and so does a tumbler of clear glass, with four surfaces. */
static bool survives(struct path *path, bool spreads, double u) {
    double chance = sqrt(colour_max_abs(path->weight) / path->radiance_scale), limit = spreads ? survival : 1;
    chance = chance < limit ? chance : limit;
    if (!(u < chance))
        return false;
    path->weight = colour_scale(path->weight, 1 / chance);
    return true;
}

/* --- photons --- */

/* The light of the photon map at the vertex. */
static void add_photons(const struct path_tracer *tracer, const struct integrator_state *state, struct path *path,
                        const struct path_vertex *vertex) {
    uint32_t lobes = vertex->at.lobes & bsdf_select(vertex->at.bsdf, BSDF_FOR_PHOTONS);
    if (lobes == 0 || path->depth + 2 > tracer->max_depth)
        return;
    struct colour found = photon_map_light(&tracer->caustics, state->job->world, vertex->hit, vertex->at.bsdf, lobes);
    struct colour light = colour_mul(path->weight, found);
    path->light = colour_add(path->light, light);
    if (vertex->sight)
        path->calm += (float)math_min(colour_max_abs(light), (double)FLT_MAX);
    /* Photons have been scattered before; diffuse lobes receive nearly all of them. */
    struct colour diffuse[PATH_SCATTERINGS];
    path_share_all(BSDF_DIFFUSE, diffuse);
    struct path_parts *parts = parts_of(state);
    if (parts)
        add_to_groups(parts, path->depth + 2, path->depth == 0 ? diffuse : parts->shares, light);
}

/* The fraction of light from wi that these lobes of the vertex scatter. */
static struct colour share_of_lobes(const struct path_vertex *vertex, uint32_t lobes, struct vec3 wi) {
    const struct interaction *at = &vertex->at;
    if (lobes == 0 || lobes == at->lobes)
        return colour_all(lobes ? 1 : 0);
    struct colour part = interaction_eval(at, lobes, BSDF_RADIANCE, wi),
                  all = interaction_eval(at, at->lobes, BSDF_RADIANCE, wi);
    return colour_share(part, all);
}

/* Photons carry light from a light source through traced lobes to a lobe that receives them. A path that continues
 * from such a lobe through traced lobes would find the same light again. */
static void count_shares(struct path *path, const struct path_vertex *vertex, const struct bsdf_sample *sample) {
    const struct bsdf *bsdf = vertex->at.bsdf;
    /* Photons pass media as paths do. */
    if (!bsdf)
        return;
    uint32_t traced = vertex->at.lobes & bsdf_lobes_with(bsdf, BSDF_TRACED);
    uint32_t receiving = vertex->at.lobes & bsdf_select(bsdf, BSDF_FOR_PHOTONS);
    bool delta = (sample->flags & BSDF_DELTA) != 0;
    struct colour by_traced = delta ? colour_all(1) : share_of_lobes(vertex, traced, sample->direction);
    path->thrown = colour_mul(colour_add(path->received, path->thrown), by_traced);
    path->received = delta ? colour_all(0) : share_of_lobes(vertex, receiving, sample->direction);
}

/* The ray that continues from a vertex in a medium. */
static __attribute__((noinline)) void send_in_medium(struct ray *ray, struct vec3 from, struct vec3 direction) {
    double passed = vec3_length(vec3_sub(from, ray->origin));
    ray->footprint.width += ray->footprint.spread * passed;
    ray->origin = from;
    ray->direction = direction;
    ray->t_min = 0;
    ray->t_max = INFINITY;
    ray->skip_primitive = ray->skip_part = 0;
}

/* Goes under the surface, on to where it comes out (come_out): the path's ray ends there. No scattering of the path,
 * until it is scattered out. Always false, for the other pieces are not to follow. */
static __attribute__((noinline)) bool walk_below(struct integrator_state *state, struct path *path,
                                                 const struct path_vertex *vertex, const struct bsdf_sample *sample,
                                                 struct path_watch *watch) {
    const struct subsurface *under = &vertex->at.bsdf->subsurface;
    struct subsurface_walk walk = {.world = state->job->world,
                                   .scratch = state->scratch,
                                   .primitive = vertex->hit->primitive,
                                   .under = *under,
                                   .key = random_combine(path->sampler.key, path->dimension | SAMPLER_MEDIUM),
                                   .normal = vertex->hit->normal_geometric,
                                   .ray = hit_ray(vertex->hit, &path->ray, sample->direction, &path->media),
                                   .weight = colour_mul(path->weight, colour_share(sample->weight, under->colour))};
    if (!subsurface_walk(&walk))
        return watch_end(watch, walk.scatterings > 0 ? PATH_LOSES_ROULETTE : PATH_IS_ABSORBED);
    path->weight = walk.weight;
    path->kind = RAY_BELOW;
    watch_walk(watch, walk.scatterings);
    if (walk.comes_out) {
        path->ray = walk.ray;
        path->met = (struct packet_answer){.primitive = walk.primitive, .crossing = walk.crossing};
    }
    return false;
}

/* Continues in a direction that the BSDF or the phase function samples. */
static inline __attribute__((always_inline)) bool scatter(const struct path_tracer *tracer,
                                                          struct integrator_state *state, struct path *path,
                                                          const struct path_vertex *vertex, double u_roulette,
                                                          struct path_watch *watch) {
    const struct bsdf *bsdf = vertex->at.bsdf;
    const struct sample2 u = sampler_point(&path->sampler, path->dimension - 1); /* the last one of the vertex */
    struct bsdf_sample sample;
    if (!interaction_sample(&vertex->at, BSDF_RADIANCE, u, &sample))
        return watch_end(watch, PATH_IS_ABSORBED);
    bool transmits = (sample.flags & BSDF_TRANSMITS) != 0, delta = (sample.flags & BSDF_DELTA) != 0;
    if (MATTER && (sample.flags & BSDF_BELOW))
        return walk_below(state, path, vertex, &sample, watch);
    /* A shading normal may reflect into the surface. */
    if (bsdf && !transmits && !(vec3_dot(sample.direction, bsdf->geometric_side) > 0))
        return watch_end(watch, PATH_IS_ABSORBED);
    if (tracer->photon_lights)
        count_shares(path, vertex, &sample);
    /* The first scattering decides to which layers the light belongs. */
    struct path_parts *parts = parts_of(state);
    if (parts && path->depth == 0) {
        if (delta)
            path_share_all(sample.flags, parts->shares);
        else
            path_shares(vertex, vertex->at.lobes, sample.direction, parts->shares);
    }
    path->weight = colour_mul(path->weight, sample.weight);
    path->depth++;
    if (transmits)
        path->radiance_scale *= bsdf->eta * bsdf->eta;
    /* Roulette, or a weight of 0, ends paths that bring nothing. */
    bool plays = path->depth > tracer->roulette_depth;
    if (plays ? !survives(path, bsdf && !delta, u_roulette) : colour_max_abs(path->weight) == 0)
        return watch_end(watch, plays ? PATH_LOSES_ROULETTE : PATH_IS_ABSORBED);
    path->pdf = delta ? 0 : sample.pdf;
    path->sight = path->sight && delta;
    /* The last ray of a path finds only lights that rays can meet. */
    if (!path->sight && path->depth >= tracer->max_depth && !tracer->lights.met)
        return watch_end(watch, PATH_REACHES_MAX_DEPTH);
    if (bsdf)
        path->ray = hit_ray(vertex->hit, &path->ray, sample.direction, &path->media);
    else
        send_in_medium(&path->ray, path->scatter.point, sample.direction);
    path->kind = transmits ? RAY_REFRACTED : RAY_REFLECTED;
    if (transmits) {
        bsdf_cross(bsdf, &path->media);
        state->refracted_rays++;
    } else {
        state->reflected_rays++;
    }
    return true;
}

/* The light of glowing media at the vertex. */
static __attribute__((noinline)) void add_glow(const struct path_tracer *tracer, struct integrator_state *state,
                                               struct path *path, const struct path_vertex *vertex,
                                               uint32_t dimension) {
    struct vec3 direction;
    struct colour light = colour_mul(path->weight, path_glow_light(tracer, state, path, vertex, dimension, &direction));
    struct path_parts *parts = parts_of(state);
    path->light = colour_add(path->light, light);
    if (!parts || colour_is_black(light))
        return;
    struct colour shares[PATH_SCATTERINGS];
    if (path->depth == 0)
        path_shares(vertex, vertex->at.lobes, direction, shares);
    add_to_groups(parts, path->depth + 1, path->depth == 0 ? shares : parts->shares, light);
}

/* Asks for the light of a light source, and continues. dimension: the first one of the vertex. */
static inline __attribute__((always_inline)) bool
light_and_scatter(const struct path_tracer *tracer, struct integrator_state *state, struct path *path,
                  const struct path_vertex *vertex, struct path_shadow *shadow, struct path_watch *watch) {
    const struct sampler *sampler = &path->sampler;
    uint32_t dimension = path->dimension - SAMPLER_VERTEX_DIMENSIONS;
    bool chooses = tracer->lights.sampler.count > 1 || path->depth >= tracer->roulette_depth;
    struct sample2 choice = chooses ? sampler_point(sampler, dimension) : (struct sample2){0, 0};
    const struct path_light_draw draw = {choice.x, sampler, dimension + 1};
    struct path_choice chosen;
    shadow->weight = path->weight;
    shadow->depth = path->depth;
    if (!(MATTER && vertex->sealed) && path_choose_light(tracer, vertex, &draw, shadow, &chosen) && parts_of(state) &&
        path->depth == 0)
        path_direct_shares(vertex, &chosen, shadow->sample.direction, shadow->shares);
    if (MATTER && tracer->glow)
        add_glow(tracer, state, path, vertex, dimension);
    return scatter(tracer, state, path, vertex, choice.y, watch);
}

/* The way to the hit in a sealed solid, where nothing but the medium is, before the hit is described: most rays do not
 * come that far. False: it is another way, and nothing is done. */
static __attribute__((noinline)) bool travel_sealed(const struct path_tracer *tracer, struct integrator_state *state,
                                                    struct path *path, struct path_stretch *out) {
    if (!path_is_sealed(tracer, &path->media) || touching_has(&state->job->world->touching, path->met.primitive))
        return false;
    out->distance = path->met.crossing.t * vec3_length(path->ray.direction);
    pass_medium(tracer, state, path, MEDIUM_RAY_SCATTERED, out);
    return true;
}

/* One vertex in the medium of the ray, after a distance. False: the path ends here. */
static __attribute__((noinline)) bool meet_medium(const struct path_tracer *tracer, struct integrator_state *state,
                                                  struct path *path, const struct path_stretch *end,
                                                  struct path_shadow *shadow, struct path_watch *watch) {
    struct vec3 direction = vec3_normalize(path->ray.direction);
    struct vec3 point = vec3_add_scaled(path->ray.origin, direction, end->distance);
    path->dimension += SAMPLER_VERTEX_DIMENSIONS;
    state->medium_events++;
    watch_medium(watch, path, end->end);
    if (path->depth >= tracer->max_depth)
        return watch_end(watch, PATH_REACHES_MAX_DEPTH);
    struct path_parts *parts = parts_of(state);
    if (parts && path->sight)
        set_features(state, path, medium_albedo(end->medium), vec3_all(0),
                     depth_in_medium(end->medium, parts->travelled, end->end));
    path->scatter = (struct light_receiver){point, point, {0, 0, 0}, WORLD_NOTHING};
    const struct path_vertex vertex = {.ray = &path->ray,
                                       .at = {.lobes = 1, .wo = vec3_negate(direction), .phase = &end->medium->phase},
                                       .receiver = &path->scatter,
                                       .sight = path->sight,
                                       .thrown = path->thrown,
                                       .tracked = end->tracked.density > 0 ? &end->tracked : NULL,
                                       .sealed = path_is_sealed(tracer, &path->media)};
    return light_and_scatter(tracer, state, path, &vertex, shadow, watch);
}

/* --- the vertex --- */

/* The surface at the hit of the path's ray. */
static void evaluate(const struct integrator_state *state, const struct path *path, const struct hit *hit,
                     const struct joint *joint, struct bsdf *bsdf) {
    const struct world *world = state->job->world;
    const struct material_context context = {.specular = state->job->settings.specular,
                                             .total_reflection = true,
                                             .no_black_highlight = true,
                                             .walks = MATTER,
                                             .thin = primitive_is_thin(world, hit->primitive),
                                             .joint = joint_boundary(joint)};
    if (OBSERVED && !material_observe(&world->surfaces, hit, world->authored.materials[hit->material], &context,
                                      observe_material, state->observer))
        state->scratch->failed = true;
    material_eval(&world->surfaces, hit, path->ray.media, &context, bsdf);
}

/* The surface's own light. */
static void add_emission(const struct path_tracer *tracer, const struct integrator_state *state, struct path *path,
                         const struct hit *hit, struct colour emission) {
    if (path->sight) {
        add_light(state, path, emission);
    } else if (tracer->lights.met) {
        const struct path_segment segment = segment_of(path, 0);
        add_light(state, path, path_emission(tracer, &segment, hit, emission));
    }
}

/* What a ray hits, and the surfaces that coincide there. */
struct path_hit {
    struct hit hit;
    struct joint joint;
};

/* The features of a line of sight through media that scatter: the mean of theirs and of what is behind, since those of
 * single events would be noise. Not of clear surfaces and of holes: the path decides what is seen there. */
static __attribute__((noinline)) void blend_features(const struct integrator_state *state, const struct path *path,
                                                     const struct path_hit *at) {
    const struct path_parts *parts = parts_of(state);
    struct medium_mix mix;
    medium_stack_mix(path->ray.media, &mix);
    if (!parts || parts->surface_known || !medium_mix_scatters(&mix))
        return;
    struct vec3 direction = vec3_normalize(path->ray.direction), normal = {0, 0, 0};
    double distance = at ? at->hit.t * vec3_length(path->ray.direction) : INFINITY;
    struct colour behind;
    if (at) {
        struct bsdf bsdf;
        evaluate(state, path, &at->hit, &at->joint, &bsdf);
        const struct bsdf_guide guide = bsdf_guide(&bsdf, light_albedo(bsdf.emission));
        if (bsdf.opacity < 1 || !(guide.scatters || colour_max_abs(bsdf.emission) > 0))
            return;
        behind = guide.albedo;
        normal = bsdf.lit;
    } else {
        behind = state->job->settings.transparent && path->depth == 0
                     ? colour_all(0)
                     : light_albedo(sky_colour(&state->job->world->sky, direction, path->ray.footprint.spread));
    }
    const struct medium_line line = {path->ray.origin, direction, distance, path->ray.time};
    const struct colour left = medium_mix_left(&mix, &line, random_combine(medium_key(path), 1));
    const struct medium *medium = mix.media[0];
    for (uint32_t i = 0; !medium->scatters; i++)
        medium = mix.media[i];
    const struct colour from_medium = colour_mul(medium_albedo(medium), colour_sub(colour_all(1), left));
    set_features(state, path, colour_add(from_medium, colour_mul(left, behind)),
                 vec3_scale(normal, (left.r + left.g + left.b) / 3),
                 depth_in_medium(medium, parts->travelled, distance));
}

/* One vertex on a surface. False: the path ends here. */
static bool meet_surface(const struct path_tracer *tracer, struct integrator_state *state, struct path *path,
                         const struct path_hit *at, struct path_shadow *shadow, struct path_watch *watch) {
    const struct hit *hit = &at->hit;
    const struct joint *joint = &at->joint;
    uint32_t dimension = path->dimension;
    struct bsdf bsdf;
    path->dimension += SAMPLER_VERTEX_DIMENSIONS;
    state->hits++;
    evaluate(state, path, hit, joint, &bsdf);
    /* A hole. */
    if (bsdf.opacity < 1 && !(random_unit(random_combine(path->sampler.key, dimension)) < bsdf.opacity)) {
        path->ray = joint_ray_through_hole(joint, hit, &path->ray, &path->media);
        path->kind = RAY_HOLE;
        return joint_pass_invisible(state->job->world, joint, hit, &path->media) || path->holes++ < HOLE_LIMIT ||
               watch_end(watch, PATH_IN_TOO_MANY_HOLES);
    }
    if (OBSERVED)
        OBSERVE(state->observer, OBSERVED_SURFACE, .surface = &bsdf);
    /* The light that comes from here. */
    meet_features(state, path, hit, &bsdf);
    add_emission(tracer, state, path, hit, bsdf.emission);
    watch_stage(watch, path, STAGE_EMISSION);
    if (path->depth >= tracer->max_depth)
        return watch_end(watch, PATH_REACHES_MAX_DEPTH);
    struct path_vertex vertex = {.ray = &path->ray, .hit = hit, .sight = path->sight};
    vertex.at.bsdf = &bsdf;
    vertex.at.wo = hit->view;
    double side = hit->front ? hit->offset : -hit->offset;
    path->scatter = (struct light_receiver){hit->point, vec3_add_scaled(hit->point, hit->normal_geometric, side),
                                            bsdf.side, hit->primitive};
    vertex.receiver = &path->scatter;
    vertex.at.lobes = bsdf_select(&bsdf, BSDF_FOR_PATHS);
    vertex.substitute = bsdf_select(&bsdf, BSDF_FOR_UNSEEN_LIGHTS);
    if (tracer->photon_lights) {
        add_photons(tracer, state, path, &vertex);
        vertex.thrown = colour_add(path->received, path->thrown);
        watch_stage(watch, path, STAGE_PHOTONS);
    }
    return light_and_scatter(tracer, state, path, &vertex, shadow, watch);
}

/* --- the pieces --- */

/* The camera ray. */
static void begin(struct path *path, const struct integrator_state *state, const struct ray *ray, uint64_t key) {
    path->ray = *ray;
    path->weight = colour_all(1);
    path->light = colour_all(0);
    path->radiance_scale = 1;
    path->pdf = 0;
    path->received = path->thrown = colour_all(0);
    path->sight = true;
    path->kind = RAY_CAMERA;
    path->depth = 0;
    path->holes = 0;
    path->calm = 0;
    path->dimension = SAMPLER_FIRST_VERTEX;
    medium_stack_copy(&path->media, state->eye_medium_stack);
    path->ray.media = &path->media;
    path->sampler = state->sampler;
    /* The other eye of a stereo pair. */
    if (key != path->sampler.key)
        path->sampler.pixel_key = random_combine(path->sampler.pixel_key, UINT64_MAX);
    path->sampler.key = key;
}

/* What the ray hits first. */
static inline void extend(const struct integrator_state *state, struct path *path) {
    if (!world_nearest_crossing(state->job->world, &path->ray, state->scratch, &path->met.primitive,
                                &path->met.crossing))
        path->met.primitive = WORLD_NOTHING;
}

/* What is at the hit: emission, the choice of a light, the next ray. False: the path has ended. A light may have been
 * asked for in either case. */
static bool shade(const struct path_tracer *tracer, struct integrator_state *state, struct path *path,
                  struct path_shadow *shadow, struct path_watch *watch) {
    const struct world *world = state->job->world;
    bool met = path->met.primitive != WORLD_NOTHING;
    struct path_stretch end;
    struct path_hit at;
    at.joint.joined = JOINED_NOT;
    shadow->part.light = LIGHT_NONE;
    shadow->sent = false;
    bool travelled = MATTER && !OBSERVED && tracer->sealed && met && travel_sealed(tracer, state, path, &end);
    if (travelled && end.medium)
        return meet_medium(tracer, state, path, &end, shadow, watch);
    /* The surface, or nothing where several have no effect together. */
    if (met) {
        world_describe(world, &path->ray, path->met.primitive, &path->met.crossing, &at.hit);
        if (MATTER && tracer->disperses && world_needs_wavelength(world, &at.hit, &path->media)) {
            double u = sampler_point(&path->sampler, SAMPLER_WAVELENGTH).x;
            path->weight = colour_mul(path->weight, medium_stack_choose_wavelength(&path->media, u));
        }
        if (world_touches(world, &at.hit))
            world_join_path(world, &path->ray, &path->media, state->scratch, &at.hit, &at.joint);
        if (at.joint.joined == JOINED_AWAY) {
            if (OBSERVED)
                watch->cut = true;
            return true;
        }
    }
#if OBSERVED
    watch_ray(watch, state->observer, path, met ? &at.hit : NULL);
#endif
    if (MATTER && LAYERS && !OBSERVED && path->sight && !travelled && (path->media.count > 0 || tracer->in_medium))
        blend_features(state, path, met ? &at : NULL);
    /* The way to it, then the surface or the sky there. */
    enum travelled to = travelled ? ENDS_AT_HIT : travel(tracer, state, path, met ? &at.hit : NULL, watch, &end);
    if (to == ENDS_AT_LIGHT)
        return false;
    watch_arrival(watch, path, to == ENDS_IN_MEDIUM ? end.distance : 0);
    if (to == ENDS_IN_MEDIUM)
        return meet_medium(tracer, state, path, &end, shadow, watch);
    if (met)
        return meet_surface(tracer, state, path, &at, shadow, watch);
    leave_scene(tracer, state, path);
    watch_stage(watch, path, STAGE_EMISSION);
    return watch_end(watch, PATH_LEAVES_SCENE);
}

/* The vertex where the path comes out from under a surface, in the place of shade. */
static __attribute__((noinline)) bool come_out(const struct path_tracer *tracer, struct integrator_state *state,
                                               struct path *path, struct path_shadow *shadow,
                                               struct path_watch *watch) {
    const struct world *world = state->job->world;
    struct hit hit;
    struct bsdf bsdf;
    world_describe(world, &path->ray, path->met.primitive, &path->met.crossing, &hit);
#if OBSERVED
    watch_ray(watch, state->observer, path, &hit);
#endif
    path->kind = RAY_REFLECTED;
    path->dimension += SAMPLER_VERTEX_DIMENSIONS;
    shadow->part.light = LIGHT_NONE;
    shadow->sent = false;
    state->hits++;
    material_eval_matt(&world->surfaces, &hit, &bsdf);
    path->scatter = (struct light_receiver){hit.point, vec3_add_scaled(hit.point, hit.normal_geometric, hit.offset),
                                            bsdf.side, hit.primitive};
    struct path_vertex vertex = {.ray = &path->ray, .hit = &hit, .receiver = &path->scatter};
    vertex.at = (struct interaction){.bsdf = &bsdf, .lobes = 1, .wo = hit.view};
    if (tracer->photon_lights) {
        add_photons(tracer, state, path, &vertex);
        vertex.thrown = colour_add(path->received, path->thrown);
        watch_stage(watch, path, STAGE_PHOTONS);
    }
    return light_and_scatter(tracer, state, path, &vertex, shadow, watch);
}

/* Whether the light that was asked for arrives. */
static void shadow(const struct path_tracer *tracer, struct integrator_state *state, struct path *path,
                   struct path_shadow *shadow) {
    struct colour arriving = colour_all(0), seen = colour_all(0);
    if (shadow->sent) {
        arriving = path_light_arriving(tracer, state, path, shadow);
        seen = colour_mul(shadow->scattered, arriving);
        struct colour light = colour_mul(shadow->weight, seen);
        path->light = colour_add(path->light, light);
        struct path_parts *parts = parts_of(state);
        if (parts && colour_max_abs(light) > 0)
            add_to_groups(parts, shadow->depth + 1, shadow->depth == 0 ? shadow->shares : parts->shares, light);
    }
#if OBSERVED
    watch_light(state->observer, &tracer->lights, shadow, colour_max_abs(arriving) > 0, seen);
#endif
}

/* After each vertex. */
static inline __attribute__((always_inline)) void end_vertex(const struct path_tracer *tracer,
                                                             struct integrator_state *state, struct path *path,
                                                             struct path_shadow *to_light, struct path_watch *watch) {
    shadow(tracer, state, path, to_light);
#if OBSERVED
    watch_stage(watch, path, STAGE_DIRECT);
    watch_vertex(watch, state->observer, tracer->photon_lights != NULL);
#else
    (void)watch;
#endif
}

/* If the radiance was limited, each group of light is scaled by the same factor. */
static void finish_parts(struct integrator_state *state, struct path_parts *parts, double found, double left) {
    for (int i = 0; i < PATH_LIGHT_GROUPS; i++) {
        struct colour light = integrator_clamp_light(state, parts->light[i], (double)FLT_MAX);
        parts->light[i] = left < found ? colour_scale(light, left / found) : light;
    }
    const struct colour *glow = &parts->light[PATH_LIGHT_EMISSION];
    parts->features[PATH_GLOW] = (float)glow->r;
    parts->features[PATH_GLOW + 1] = (float)glow->g;
    parts->features[PATH_GLOW + 2] = (float)glow->b;
}

/* The light of the path, which is to be added to its pixel. Limits come last: what is cut off is a property of the
 * whole sample. --clamp keeps the colour; pictures become darker where samples differ much. */
static struct colour finish(const struct path_tracer *tracer, struct integrator_state *state, const struct path *path) {
    struct colour light = integrator_clamp_light(state, path->light, (double)FLT_MAX);
    double found = colour_max_abs(light),
           limit = tracer->clamp > 0 ? math_min(tracer->clamp + (double)path->calm, found) : found;
    if (limit < found)
        light = colour_scale(light, limit / found);
    if (parts_of(state))
        finish_parts(state, parts_of(state), found, colour_max_abs(light));
    return light;
}

#if !defined PIECES_ONLY
struct colour PATH(trace)(const struct path_tracer *tracer, struct integrator_state *state, const struct ray *ray,
                          const struct packet_answer *met, bool ask, uint64_t key) {
    struct path path;
    struct path_shadow to_light;
    struct path_watch *watch = NULL;
#if OBSERVED
    struct path_watch watched;
    watch = &watched;
    watch->count = 0;
#endif
    begin(&path, state, ray, key);
    if (ask)
        extend(state, &path);
    else if (met)
        path.met = *met;
    else
        path.met.primitive = WORLD_NOTHING;
    for (;;) {
        bool goes_on = shade(tracer, state, &path, &to_light, watch);
        end_vertex(tracer, state, &path, &to_light, watch);
        while (MATTER && !goes_on && path.kind == RAY_BELOW && !integrator_cancelled(state)) {
            goes_on = come_out(tracer, state, &path, &to_light, watch);
            end_vertex(tracer, state, &path, &to_light, watch);
        }
        if (!goes_on || integrator_cancelled(state))
            break;
        extend(state, &path);
    }
#if OBSERVED
    struct colour light = finish(tracer, state, &path);
    watch_path(watch, state->observer, &path);
    return light;
#else
    return finish(tracer, state, &path);
#endif
}
#endif
