/* One path, from the camera on, vertex by vertex. Its state is a weight (throughput) and the radiance so far. A path
 * ends at the sky, at the maximum depth, by Russian roulette, or at a visible area light.
 *
 * A *line of sight* is a camera ray, with its continuations by smooth surfaces and through holes. Lines of sight
 * show the background, visible area lights and fog. All other rays are scattered: they add the light that a surface
 * receives, weighted against the samples of path_direct. */

#include "material/bsdf_select.h"
#include "material/medium.h"
#include "math/range.h"
#include "render/path_light_internal.h"
#include "render/path_trace_internal.h"
#include "world/joint.h"
#include "world/world_describe.h"

#include <string.h>

enum { HOLE_LIMIT = 200 };           /* holes that a ray passes in succession, as in Whitted's integrator */
static const double survival = 0.95; /* at most */

/* The stages of a vertex, and the radiance of the path after each, for observers. */
enum stage { STAGE_BEFORE_HIT, STAGE_EMISSION, STAGE_PHOTONS, STAGE_DIRECT, STAGES };
struct path_stages {
    struct vec3 weight; /* of the path at the hit */
    struct vec3 lights[STAGES];
    double distance; /* at which a visible light ends the path */
};

struct path {
    struct ray ray;
    struct vec3 weight, light;
    double radiance_scale;    /* the factor of all refractions in the weight so far: a product of eta^2, which roulette
                                 ignores */
    struct path_parts *parts; /* or NULL */
    double travelled;         /* distance along the line of sight so far; only if parts are recorded */
    double pdf;               /* density of the ray's direction by solid angle; 0: the only possible direction */
    /* With photons, fractions of the weight: for paths whose last scattering was by a lobe that receives photons,
     * and for those that were scattered only by traced lobes since then. */
    struct vec3 received, thrown;
    struct path_stages *stages; /* for observers, or NULL */
    enum ray_kind kind;         /* of the ray, for observers */
    enum path_end end;          /* the same */
    bool sight;
    int depth, holes;              /* scattering events and holes so far */
    uint32_t dimension;            /* of the sampler: the first dimension of the next vertex */
    struct light_receiver scatter; /* the surface that scattered the current ray */
    struct medium_stack media;
};

static void note_stage(const struct path *path, enum stage stage) {
    if (path->stages)
        for (int i = (int)stage; i < STAGES; i++)
            path->stages->lights[i] = path->light;
}

static bool end_path(struct path *path, enum path_end end) {
    path->end = end;
    return false;
}

/* Adds light that was scattered `depth` times, divided by the kinds of its first scattering. */
static void add_to_groups(struct path_parts *parts, int depth, const struct vec3 shares[PATH_SCATTERINGS],
                          struct vec3 light) {
    if (depth == 0) {
        parts->light[PATH_LIGHT_EMISSION] = vec3_add(parts->light[PATH_LIGHT_EMISSION], light);
        return;
    }
    for (int i = 0; i < PATH_SCATTERINGS; i++) {
        struct vec3 *group = &parts->light[PATH_LIGHT_DIFFUSE_DIRECT + 2 * i + (depth > 1)];
        *group = vec3_add(*group, vec3_mul(shares[i], light));
    }
}

/* The hit of the path's ray. */
static void add_light(struct path *path, struct vec3 radiance) {
    if (radiance.x == 0 && radiance.y == 0 && radiance.z == 0)
        return;
    struct vec3 light = vec3_mul(path->weight, radiance);
    path->light = vec3_add(path->light, light);
    if (path->parts)
        add_to_groups(path->parts, path->depth, path->parts->shares, light);
}

/* The light of the lights that the vertex scatters directly. */
static void add_direct(const struct path_tracer *tracer, struct integrator_state *state, struct path *path,
                       struct path_vertex *vertex, const struct path_light_draw *draw) {
    struct vec3 first[PATH_SCATTERINGS];
    vertex->direct_shares = path->parts && path->depth == 0 ? first : NULL;
    struct vec3 light = vec3_mul(path->weight, path_direct(tracer, state, vertex, draw));
    path->light = vec3_add(path->light, light);
    if (path->parts && vec3_max_abs(light) > 0)
        add_to_groups(path->parts, path->depth + 1, path->depth == 0 ? first : path->parts->shares, light);
}

/* --- features --- */

static double compressed(double x) {
    return x > 0 ? x / (1 + x) : 0;
}

/* The groups of light that a line of sight shows. */
static struct vec3 light_albedo(struct vec3 radiance) {
    return vec3_make(compressed(radiance.x), compressed(radiance.y), compressed(radiance.z));
}

static float in_unit(double x) {
    return x >= 1 ? 1 : x > 0 ? (float)x : 0;
}

/* The end of a line of sight. distance: along the last ray of the path. */
static void set_features(struct path *path, struct vec3 albedo, struct vec3 normal, double distance) {
    struct path_parts *parts = path->parts;
    if (!parts || parts->surface_known)
        return;
    parts->surface_known = true;
    const struct vec3 behind = vec3_mul(path->weight, albedo);
    const struct vec3 a = parts->reflected > 0 ? vec3_add_scaled(parts->seen, behind, 1 - parts->reflected) : behind;
    const float features[PATH_GLOW] = {in_unit(a.x),
                                       in_unit(a.y),
                                       in_unit(a.z),
                                       (float)normal.x,
                                       (float)normal.y,
                                       (float)normal.z,
                                       (float)number_clamped(path->travelled + distance, (double)FLT_MAX)};
    memcpy(parts->features, features, sizeof features);
}

/* Records the features of a surface that scatters light in more than single directions, or emits light. */
static void meet_features(struct path *path, const struct hit *hit, const struct bsdf *bsdf) {
    const struct bsdf_guide guide = bsdf_guide(bsdf, light_albedo(bsdf->emission));
    double distance = hit->t * vec3_length(path->ray.direction);
    if (guide.scatters || vec3_max_abs(bsdf->emission) > 0) {
        set_features(path, guide.albedo, bsdf->lit, distance);
    } else if (guide.refracted > 0 && path->parts->reflected == 0) {
        path->parts->reflected = guide.reflected / (guide.reflected + guide.refracted);
        path->parts->seen = vec3_scale(path->weight, path->parts->reflected);
    }
    path->travelled += distance;
}

/* --- one ray --- */

/* The ray has arrived at its hit, or at a light at this distance. */
static void note_arrival(const struct path *path, double distance) {
    if (!path->stages)
        return;
    path->stages->weight = path->weight;
    path->stages->distance = distance;
    note_stage(path, STAGE_BEFORE_HIT);
}

/* After holes, the distance from where the line began, in t of the ray. */
static double passed_of(const struct path *path) {
    if (path->kind != RAY_HOLE)
        return 0;
    return vec3_length(vec3_sub(path->ray.origin, path->scatter.from)) / vec3_length(path->ray.direction);
}

/* Adds everything between the origin of the ray and its hit: area lights, fog, absorption. False: the path ends at
 * an area light. */
static bool travel(const struct path_tracer *tracer, const struct integrator_state *state, struct path *path,
                   const struct hit *hit) {
    double end = hit ? hit->t : path->ray.t_max;
    struct vec3 radiance;
    bool seen = false;
    if (path->sight)
        seen = path_area_light_seen(tracer, &path->ray, end, &end, &radiance);
    else if (tracer->lights.area_light_count > 0)
        add_light(path, path_area_lights(tracer,
                                         &(struct path_segment){&path->ray, &path->scatter, path->pdf, path->thrown,
                                                                passed_of(path)},
                                         end));
    enum medium_ray kind = path->sight ? MEDIUM_RAY_SIGHT : MEDIUM_RAY_SCATTERED;
    if (!seen && !medium_affects(kind, state->job->fog, &path->ray))
        return true;
    double distance = hit || seen ? end * vec3_length(path->ray.direction) : INFINITY;
    struct medium_effect effect;
    if (medium_transmittance(kind, state->job->fog, &path->ray, distance, &effect)) {
        add_light(path, vec3_mul(effect.source, vec3_sub(vec3_all(1), effect.transmittance)));
        path->weight = vec3_mul(path->weight, effect.transmittance);
    }
    if (!seen)
        return true;
    set_features(path, light_albedo(radiance), vec3_all(0), distance);
    note_arrival(path, distance);
    add_light(path, radiance);
    note_stage(path, STAGE_EMISSION);
    return end_path(path, PATH_SEES_LIGHT);
}

static void leave_scene(const struct path_tracer *tracer, struct integrator_state *state, struct path *path) {
    const struct world *world = state->job->world;
    if (state->job->settings.transparent && path->sight && path->depth == 0) {
        state->seen_through += (path->weight.x + path->weight.y + path->weight.z) / 3;
        set_features(path, vec3_all(0), vec3_all(0), -path->travelled);
    } else if (path->sight) {
        struct vec3 sky = sky_colour(&world->sky, vec3_normalize(path->ray.direction), path->ray.footprint.spread);
        set_features(path, light_albedo(sky), vec3_all(0), -path->travelled);
        add_light(path, sky);
    } else {
        add_light(path, path_environment(
                            tracer, &(struct path_segment){&path->ray, &path->scatter, path->pdf, path->thrown, 0}));
    }
}

/* False: the path ends here. Paths with weights above 1 can end, too. The chance is the square root of the weight: if
 * it were the weight itself, the paths that stay would all have the weight 1, and the loss of the others would add more
 * noise than their rays cost. */
static bool survives(struct path *path, double u) {
    double chance = sqrt(vec3_max_abs(path->weight) / path->radiance_scale);
    chance = chance < survival ? chance : survival;
    if (!(u < chance))
        return false;
    path->weight = vec3_scale(path->weight, 1 / chance);
    return true;
}

/* --- photons --- */

/* The light of the photon map at the vertex. */
static void add_photons(const struct path_tracer *tracer, const struct integrator_state *state, struct path *path,
                        const struct path_vertex *vertex) {
    uint32_t lobes = vertex->lobes & bsdf_select(vertex->bsdf, BSDF_FOR_PHOTONS);
    if (lobes == 0 || path->depth + 2 > tracer->max_depth)
        return;
    struct vec3 found = photon_map_light(&tracer->caustics, state->job->world, vertex->hit, vertex->bsdf, lobes);
    struct vec3 light = vec3_mul(path->weight, found);
    path->light = vec3_add(path->light, light);
    /* Photons have been scattered before; diffuse lobes receive nearly all of them. */
    struct vec3 diffuse[PATH_SCATTERINGS];
    path_share_all(BSDF_DIFFUSE, diffuse);
    if (path->parts)
        add_to_groups(path->parts, path->depth + 2, path->depth == 0 ? diffuse : path->parts->shares, light);
}

static double share_of(double part, double all) {
    return all != 0 ? part / all : 0;
}

/* The fraction of light from wi that these lobes of the vertex scatter. */
static struct vec3 share_of_lobes(const struct path_vertex *vertex, uint32_t lobes, struct vec3 wi) {
    const struct bsdf *bsdf = vertex->bsdf;
    if (lobes == 0 || lobes == vertex->lobes)
        return vec3_all(lobes ? 1 : 0);
    struct vec3 part = bsdf_eval(bsdf, lobes, BSDF_RADIANCE, vertex->hit->view, wi),
                all = bsdf_eval(bsdf, vertex->lobes, BSDF_RADIANCE, vertex->hit->view, wi);
    return vec3_make(share_of(part.x, all.x), share_of(part.y, all.y), share_of(part.z, all.z));
}

/* Photons carry light from a light source through traced lobes to a lobe that receives them. A path that continues
 * from such a lobe through traced lobes would find the same light again. */
static void count_shares(struct path *path, const struct path_vertex *vertex, const struct bsdf_sample *sample) {
    uint32_t traced = vertex->lobes & bsdf_lobes_with(vertex->bsdf, BSDF_TRACED);
    uint32_t receiving = vertex->lobes & bsdf_select(vertex->bsdf, BSDF_FOR_PHOTONS);
    bool delta = (sample->flags & BSDF_DELTA) != 0;
    struct vec3 by_traced = delta ? vec3_all(1) : share_of_lobes(vertex, traced, sample->direction);
    path->thrown = vec3_mul(vec3_add(path->received, path->thrown), by_traced);
    path->received = delta ? vec3_all(0) : share_of_lobes(vertex, receiving, sample->direction);
}

/* Continues in a direction that the BSDF samples. */
static bool scatter(const struct path_tracer *tracer, struct integrator_state *state, struct path *path,
                    const struct path_vertex *vertex, struct sample2 u, double u_roulette) {
    const struct hit *hit = vertex->hit;
    const struct bsdf *bsdf = vertex->bsdf;
    struct bsdf_sample sample;
    if (!bsdf_sample(bsdf, vertex->lobes, BSDF_RADIANCE, hit->view, u, &sample))
        return end_path(path, PATH_IS_ABSORBED);
    bool transmits = (sample.flags & BSDF_TRANSMITS) != 0, delta = (sample.flags & BSDF_DELTA) != 0;
    /* A shading normal may reflect into the surface. */
    if (!transmits && !(vec3_dot(sample.direction, bsdf->geometric_side) > 0))
        return end_path(path, PATH_IS_ABSORBED);
    if (tracer->photon_lights)
        count_shares(path, vertex, &sample);
    /* The first scattering decides to which layers the light belongs. */
    if (path->parts && path->depth == 0) {
        if (delta)
            path_share_all(sample.flags, path->parts->shares);
        else
            path_shares(vertex, vertex->lobes, sample.direction, path->parts->shares);
    }
    path->weight = vec3_mul(path->weight, sample.weight);
    path->depth++;
    if (transmits)
        path->radiance_scale *= bsdf->eta * bsdf->eta;
    /* Roulette, or a weight of 0, ends paths that bring nothing. */
    bool plays = path->depth > tracer->roulette_depth;
    if (plays ? !survives(path, u_roulette) : vec3_max_abs(path->weight) == 0)
        return end_path(path, plays ? PATH_LOSES_ROULETTE : PATH_IS_ABSORBED);
    path->pdf = delta ? 0 : sample.pdf;
    path->sight = path->sight && delta;
    /* The last ray of a path finds only lights that rays can meet. */
    if (!path->sight && path->depth >= tracer->max_depth && !tracer->lights.met)
        return end_path(path, PATH_REACHES_MAX_DEPTH);
    path->scatter = vertex->receiver;
    path->ray = hit_ray(hit, &path->ray, sample.direction, &path->media);
    path->kind = transmits ? RAY_REFRACTED : RAY_REFLECTED;
    if (transmits) {
        bsdf_cross(bsdf, &path->media);
        state->refracted_rays++;
    } else {
        state->reflected_rays++;
    }
    return true;
}

/* One vertex on a surface. False: the path ends here. */
static bool meet_surface(const struct path_tracer *tracer, struct integrator_state *state, struct path *path,
                         const struct sampler *sampler, const struct hit *hit, const struct joint *joint) {
    const struct settings *settings = &state->job->settings;
    const struct world *world = state->job->world;
    const struct material_context context = {.specular = settings->specular,
                                             .total_reflection = true,
                                             .no_black_highlight = true,
                                             .thin = primitive_is_thin(world, hit->primitive),
                                             .joint = joint_boundary(joint)};
    uint32_t dimension = path->dimension;
    struct bsdf bsdf;
    path->dimension += SAMPLER_VERTEX_DIMENSIONS;
    state->hits++;
    if (state->observer)
        material_observe(&world->surfaces, hit, world->authored.materials[hit->material], &context, observe_material,
                         state->observer);
    material_eval(&world->surfaces, hit, path->ray.media, &context, &bsdf);
    if (bsdf.opacity < 1 && !(random_unit(random_combine(sampler->key, dimension)) < bsdf.opacity)) {
        path->ray = joint_ray_through_hole(joint, hit, &path->ray, &path->media);
        path->kind = RAY_HOLE;
        return path->holes++ < HOLE_LIMIT || end_path(path, PATH_IN_TOO_MANY_HOLES);
    }
    OBSERVE(state->observer, OBSERVED_SURFACE, .surface = &bsdf);
    if (path->parts && path->sight)
        meet_features(path, hit, &bsdf);
    if (path->sight)
        add_light(path, bsdf.emission);
    else if (tracer->lights.met)
        add_light(path,
                  path_emission(tracer, &(struct path_segment){&path->ray, &path->scatter, path->pdf, path->thrown, 0},
                                hit, bsdf.emission));
    note_stage(path, STAGE_EMISSION);
    if (path->depth >= tracer->max_depth)
        return end_path(path, PATH_REACHES_MAX_DEPTH);
    struct path_vertex vertex = {.ray = &path->ray, .hit = hit, .bsdf = &bsdf, .sight = path->sight};
    double side = hit->front ? hit->offset : -hit->offset;
    vertex.receiver = (struct light_receiver){hit->point, vec3_add_scaled(hit->point, hit->normal_geometric, side),
                                              bsdf.side, hit->primitive};
    vertex.lobes = bsdf_select(&bsdf, BSDF_FOR_PATHS);
    vertex.substitute = bsdf_select(&bsdf, BSDF_FOR_UNSEEN_LIGHTS);
    if (tracer->photon_lights) {
        add_photons(tracer, state, path, &vertex);
        vertex.thrown = vec3_add(path->received, path->thrown);
        note_stage(path, STAGE_PHOTONS);
    }
    bool chooses = tracer->lights.sampler.count > 1 || path->depth >= tracer->roulette_depth;
    struct sample2 choice = chooses ? sampler_point(sampler, dimension) : (struct sample2){0, 0};
    /* Needed after the shadow ray, but computed beside it. */
    struct sample2 onward = sampler_point(sampler, dimension + 2);
    add_direct(tracer, state, path, &vertex, &(struct path_light_draw){choice.x, sampler, dimension + 1});
    note_stage(path, STAGE_DIRECT);
    return scatter(tracer, state, path, &vertex, onward, choice.y);
}

/* --clamp: the colour is kept. Pictures become darker where samples differ much. */
static struct vec3 limited(struct vec3 colour, double limit) {
    double largest = vec3_max_abs(colour);
    return limit > 0 && largest > limit ? vec3_scale(colour, limit / largest) : colour;
}

/* If the radiance was limited, each group of light is scaled by the same factor. */
static void finish_parts(struct integrator_state *state, struct path_parts *parts, double found, double left) {
    for (int i = 0; i < PATH_LIGHT_GROUPS; i++) {
        struct vec3 light = integrator_clamp_light(state, parts->light[i], (double)FLT_MAX);
        parts->light[i] = left < found ? vec3_scale(light, left / found) : light;
    }
    const struct vec3 *glow = &parts->light[PATH_LIGHT_EMISSION];
    parts->features[PATH_GLOW] = (float)glow->x;
    parts->features[PATH_GLOW + 1] = (float)glow->y;
    parts->features[PATH_GLOW + 2] = (float)glow->z;
}

/* The rays of a path for observers, in order. Of a longer path only the first ones. */
struct observed_path {
    struct observed_ray {
        struct vec3 weight, light; /* of the path at the start of the ray */
        struct path_stages stages;
    } rays[64];
    int count;
    bool cut; /* the current ray is none of them */
};

static struct vec3 quotient(struct vec3 a, struct vec3 b) {
    return vec3_make(share_of(a.x, b.x), share_of(a.y, b.y), share_of(a.z, b.z));
}

static void observe_next(struct observed_path *observed, const struct integrator_state *state, struct path *path,
                         const struct hit *hit) {
    enum { LIMIT = sizeof observed->rays / sizeof *observed->rays };
    observed->cut = observed->count == LIMIT;
    path->stages = NULL;
    path->end = PATH_GOES_ON;
    if (observed->cut)
        return;
    double distance = hit ? hit->t * vec3_length(path->ray.direction) : INFINITY;
    if (observed->count > 0)
        OBSERVE(state->observer, OBSERVED_RAY_SENT,
                .sent = {path->kind, quotient(path->weight, observed->rays[observed->count - 1].stages.weight),
                         RAY_FOLLOWED});
    struct observed_ray *ray = &observed->rays[observed->count++];
    *ray = (struct observed_ray){path->weight, path->light, {.weight = path->weight}};
    path->stages = &ray->stages;
    note_arrival(path, 0);
    const struct ray sent = path->ray;
    OBSERVE(state->observer, OBSERVED_RAY_BEGIN,
            .begin = {&sent, hit, NULL, distance, fmin(vec3_max_abs(path->weight), 1)});
}

/* The end of the current ray: what its hit adds to the path. */
static void observe_hit(const struct observed_path *observed, const struct path_tracer *tracer,
                        const struct integrator_state *state, const struct path *path) {
    if (observed->cut)
        return;
    const struct path_stages *stages = path->stages;
    struct vec3 gains[STAGES];
    for (int i = STAGE_EMISSION; i < STAGES; i++)
        gains[i] = quotient(vec3_sub(stages->lights[i], stages->lights[i - 1]), stages->weight);
    OBSERVE(state->observer, OBSERVED_VERTEX,
            .vertex = {.end = path->end,
                       .distance = stages->distance,
                       .emission = gains[STAGE_EMISSION],
                       .photons = gains[STAGE_PHOTONS],
                       .direct = vec3_add(gains[STAGE_PHOTONS], gains[STAGE_DIRECT]),
                       .has_photons = tracer->photon_lights != NULL});
}

static void observe_end(const struct observed_path *observed, const struct integrator_state *state,
                        const struct path *path) {
    for (int i = observed->count - 1; i >= 0; i--) {
        const struct observed_ray *ray = &observed->rays[i];
        struct vec3 before = ray->stages.lights[STAGE_BEFORE_HIT];
        OBSERVE(state->observer, OBSERVED_RAY_END,
                .end = {.evaluated = true,
                        .seen = quotient(vec3_sub(path->light, before), ray->stages.weight),
                        .left = quotient(ray->stages.weight, ray->weight),
                        .in_scattered = quotient(vec3_sub(before, ray->light), ray->weight),
                        .brings = quotient(vec3_sub(path->light, ray->light), ray->weight)});
    }
}

/* hit: the hit of the camera ray, if it has met anything; it is also the storage for the hits of later rays. */
static struct vec3 follow(const struct path_tracer *tracer, struct integrator_state *state, struct path *path,
                          struct sampler *sampler, struct hit *hit, bool met) {
    const struct world *world = state->job->world;
    struct joint joint;
    struct observed_path observed;
    observed.count = 0;
    path->stages = NULL;
    for (;;) {
        joint.joined = JOINED_NOT;
        if (met && world_touches(world, hit))
            met = world_join_path(world, &path->ray, &path->media, state->scratch, hit, &joint);
        if (state->observer)
            observe_next(&observed, state, path, met ? hit : NULL);
        /* The way to the hit, then the surface or the sky there. */
        bool goes_on = travel(tracer, state, path, met ? hit : NULL);
        if (goes_on && met) {
            note_arrival(path, 0);
            goes_on = meet_surface(tracer, state, path, sampler, hit, &joint);
        } else if (goes_on) {
            note_arrival(path, 0);
            leave_scene(tracer, state, path);
            note_stage(path, STAGE_EMISSION);
            goes_on = end_path(path, PATH_LEAVES_SCENE);
        }
        if (state->observer)
            observe_hit(&observed, tracer, state, path);
        if (!goes_on || integrator_cancelled(state))
            break;
        met = world_nearest_surface(world, &path->ray, state->scratch, hit);
    }
    /* Limits come last: what is cut off is a property of the whole sample. */
    struct vec3 found = integrator_clamp_light(state, path->light, (double)FLT_MAX);
    struct vec3 light = limited(found, tracer->clamp);
    if (path->parts)
        finish_parts(state, path->parts, vec3_max_abs(found), vec3_max_abs(light));
    if (state->observer)
        observe_end(&observed, state, path);
    return light;
}

static void begin(struct path *path, struct sampler *sampler, const struct integrator_state *state,
                  const struct ray *ray, uint64_t key) {
    path->ray = *ray;
    path->weight = vec3_all(1);
    path->light = vec3_all(0);
    path->parts = state->parts;
    path->travelled = 0;
    path->radiance_scale = 1;
    path->pdf = 0;
    path->received = path->thrown = vec3_all(0);
    path->sight = true;
    path->depth = path->holes = 0;
    path->dimension = SAMPLER_FIRST_VERTEX;
    medium_stack_copy(&path->media, state->eye_medium_stack);
    path->ray.media = &path->media;
    *sampler = state->sampler;
    /* The other eye of a stereo pair. */
    if (key != sampler->key)
        sampler->pixel_key = random_combine(sampler->pixel_key, UINT64_MAX);
    sampler->key = key;
}

struct vec3 path_trace(const struct path_tracer *tracer, struct integrator_state *state, const struct ray *ray,
                       uint64_t key) {
    struct path path;
    struct sampler sampler;
    struct hit hit;
    begin(&path, &sampler, state, ray, key);
    bool met = world_nearest_surface(state->job->world, &path.ray, state->scratch, &hit);
    return follow(tracer, state, &path, &sampler, &hit, met);
}

struct vec3 path_trace_met(const struct path_tracer *tracer, struct integrator_state *state, const struct ray *ray,
                           const struct packet_answer *met, uint64_t key) {
    struct path path;
    struct sampler sampler;
    struct hit hit;
    begin(&path, &sampler, state, ray, key);
    if (met)
        world_describe(state->job->world, &path.ray, met->primitive, &met->crossing, &hit);
    return follow(tracer, state, &path, &sampler, &hit, met != NULL);
}
