/* See whitted_internal.h. A path is (ray, key, counters): the key makes every random number a function of pixel, sample
 * and the position in the tree of rays. */
#include "material/bsdf_select.h"
#include "material/medium.h"
#include "render/media_light_internal.h"
#include "render/stored_light_internal.h"
#include "render/style_internal.h"
#include "render/whitted_trace_internal.h"
#include "world/joint.h"
#include "world/world_describe.h"

#include <math.h>

/* Limits the colour of a secondary ray: no filter makes it infinite, so infinity times 0 cannot occur. */
static const double light_limit = 1e200;

struct path {
    uint64_t key;
    int reflections, refractions; /* so far, from the camera */
    bool rough;                   /* after a rough surface: the next ones get one ray each */
    double weight;                /* the fraction of this ray's radiance that can arrive in the pixel */
    double cutoff;                /* a ray of less weight is not followed */
    int holes;                    /* went through so far */
};

static struct colour trace(struct integrator_state *state, const struct ray *ray, const struct path *path);

/* The nearest visible light before t_max, or NULL. */
static const struct light *visible_light(const struct world *world, const struct ray *ray, double t_max,
                                         struct light_hit *hit) {
    const struct light *best = NULL;
    struct ray limited = *ray;
    struct light_hit met;
    limited.t_min = 0; /* also before boundaries without effect */
    limited.t_max = t_max;
    for (uint32_t i = 0; i < world->light_count; i++) {
        if (world->lights[i].visible && light_meets_ray(&world->lights[i], &limited, &met)) {
            best = &world->lights[i];
            limited.t_max = met.t;
            *hit = met;
        }
    }
    return best;
}

/* --- secondary rays --- */

/* Field by field: a copy of the whole struct would wait for recent stores. */
static struct path path_on(const struct path *path, double share) {
    return (struct path){.key = path->key,
                         .reflections = path->reflections,
                         .refractions = path->refractions,
                         .rough = path->rough,
                         .weight = path->weight * share,
                         .cutoff = path->cutoff,
                         .holes = path->holes};
}

/* Whether the result of a ray is negligible. */
static bool is_given_up(const struct integrator_state *state, enum ray_kind kind, bool limit, struct colour filter,
                        const struct path *path) {
    enum ray_cut cut = limit ? RAY_OVER_LIMIT : path->weight < path->cutoff ? RAY_TOO_WEAK : RAY_FOLLOWED;
    OBSERVE(state->observer, OBSERVED_RAY_SENT, .sent = {kind, filter, cut});
    return cut != RAY_FOLLOWED;
}

/* A hit with its surface and its ray. */
struct surface_point {
    const struct ray *ray;
    const struct hit *hit;
    const struct bsdf *bsdf;
};

/* The radiance from a direction, times its weight. What cannot change the pixel by the cut-off is not followed. */
static struct colour follow(struct integrator_state *state, const struct surface_point *at,
                            const struct bsdf_branch_direction *towards, const struct path *from) {
    const struct settings *settings = &state->job->settings;
    struct colour filter = towards->weight;
    bool transmits = towards->transmits;
    struct path path = path_on(from, colour_max_abs(filter));
    bool limit = transmits ? path.refractions >= settings->refract_limit : path.reflections >= settings->reflect_limit;
    if (is_given_up(state, transmits ? RAY_REFRACTED : RAY_REFLECTED, limit, filter, &path))
        return colour_all(0);
    /* Behind the surface the ray is in other media; each branch has random numbers of its own. */
    struct ray onward = hit_ray(at->hit, at->ray, towards->direction, at->ray->media);
    struct medium_stack behind;
    if (transmits) {
        medium_stack_copy(&behind, at->ray->media);
        bsdf_cross(at->bsdf, &behind);
        onward.media = &behind;
        state->refracted_rays++;
        path.key = sampler_branch(path.key, SAMPLER_REFRACTED);
        path.refractions++;
    } else {
        state->reflected_rays++;
        path.key = sampler_branch(path.key, SAMPLER_REFLECTED);
        path.reflections++;
    }
    return colour_mul(filter, trace(state, &onward, &path));
}

static struct colour follow_branch(struct integrator_state *state, const struct surface_point *at,
                                   const struct bsdf_branch *branch, const struct bsdf_draw *position,
                                   const struct path *from) {
    struct bsdf_branch_direction sampled;
    if (!bsdf_branch_sample(at->bsdf, branch, at->hit->view, position, &sampled))
        return colour_all(0);
    return follow(state, at, &sampled, from);
}

/* The light through the holes of a surface (an opacity texture of leaves): the ray continues
 * unchanged. Bounded, since every hole is a deeper call. */
static struct colour follow_hole(struct integrator_state *state, const struct hit *hit, const struct joint *joint,
                                 const struct ray *ray, double share, const struct path *from) {
    enum { HOLE_LIMIT = 200 };
    struct path path = path_on(from, share);
    if (is_given_up(state, RAY_HOLE, path.holes >= HOLE_LIMIT, colour_all(share), &path))
        return colour_all(0);
    struct ray onward = joint_ray_through_hole(joint, hit, ray, ray->media);
    struct medium_stack behind;
    if (hit->solid != SOLID_NONE) {
        medium_stack_copy(&behind, ray->media);
        if (joint_pass_invisible(state->job->world, joint, hit, &behind))
            onward.media = &behind;
    }
    state->refracted_rays++;
    path.key = sampler_branch(path.key, SAMPLER_HOLE);
    path.holes++;
    return colour_scale(trace(state, &onward, &path), share);
}

enum { GLOSSY_SAMPLES = 4 };

/* A rough surface: the mean over facets of what each reflects and refracts. */
static struct colour follow_rough(struct integrator_state *state, const struct surface_point *at,
                                  const struct bsdf_branch *branches, int count, const struct path *path) {
    bool coarse = path->rough || state->job->settings.coarse;
    uint32_t n = coarse ? 1 : at->bsdf->glossy_samples ? (uint32_t)at->bsdf->glossy_samples : GLOSSY_SAMPLES;
    uint64_t key = sampler_branch(path->key, SAMPLER_ROUGH);
    struct sample_set facets = sampler_facets(&state->sampler, path->key, key, n);
    struct colour sum = {0, 0, 0};
    OBSERVE(state->observer, OBSERVED_SPLIT, .part = 1 / ((double)n * (double)n));
    for (uint32_t cell = 0; cell < n * n; cell++) {
        struct bsdf_draw position = bsdf_draw(at->bsdf, at->hit->view, sample_set_point(&facets, cell));
        struct path branch = path_on(path, 1);
        branch.key = sampler_facet(key, cell);
        branch.rough = true;
        for (int i = 0; i < count; i++) {
            if (branches[i].rough)
                sum = colour_add(sum, follow_branch(state, at, &branches[i], &position, &branch));
        }
    }
    return colour_scale(sum, 1 / ((double)n * (double)n));
}

/* --- layered materials --- */

/* A direction that a facet sends light to. */
struct candidate {
    struct bsdf_branch_direction towards;
    double weight; /* its largest component */
    int branch;
    uint64_t key;
};

enum { CANDIDATE_CELLS = 16, FEW_CELLS = 4 };
struct candidates {
    const struct bsdf_branch *branches;
    int branch_count;
    struct sample_set facets;   /* one in each cell */
    uint32_t cells, begin, end; /* all, and those of a batch */
    int count;
    double weight;         /* the sum */
    struct candidate *all; /* room for one of each cell of a batch and branch */
};

/* The facets in these cells of the square, for all rough branches. Where the mean share of a branch is known, its
 * candidates divide that in proportion to their weights, and their mean has no noise. */
static void find_candidates(const struct surface_point *at, struct candidates *out) {
    const struct bsdf_branch *branches = out->branches;
    const struct sample_set *facets = &out->facets;
    const double cells = out->end - out->begin, part = 1 / ((double)facets->side * (double)facets->side);
    double sums[BSDF_LOBES] = {0};
    out->count = 0;
    out->weight = 0;
    for (uint32_t cell = out->begin; cell < out->end; cell++) {
        const struct bsdf_draw position = {.u = sample_set_point(facets, cell)};
        for (int i = 0; i < out->branch_count; i++) {
            struct candidate *found = &out->all[out->count];
            if (!branches[i].rough ||
                !bsdf_branch_sample(at->bsdf, &branches[i], at->hit->view, &position, &found->towards))
                continue;
            found->weight = colour_max_abs(found->towards.weight);
            found->branch = i;
            found->key = sampler_facet(facets->key, cell);
            sums[i] += found->weight;
            out->count += found->weight > 0;
        }
    }
    /* Scaled, so that those of a branch together have its share. */
    for (int i = 0; i < out->count; i++) {
        struct candidate *found = &out->all[i];
        const struct bsdf_branch *branch = &branches[found->branch];
        double all = bsdf_branch_is_known(at->bsdf, branch) ? branch->expected * colour_max_abs(branch->weight) * cells
                                                            : sums[found->branch];
        double scale = part * all / sums[found->branch];
        found->towards.weight = colour_scale(found->towards.weight, scale);
        found->weight *= scale;
        out->weight += found->weight;
    }
}

/* Of `rays` places at equal distances in the sum of all weights, the candidates that are there, by their weight over
 * their chance. The mean over all first places is the sum of all candidates (J. Talbot, D. Cline and P. Egbert,
 * "Importance Resampling for Global Illumination", EGSR 2005). */
static struct colour follow_candidates(struct integrator_state *state, const struct surface_point *at,
                                       const struct candidates *from, uint32_t rays, const struct path *path) {
    struct colour sum = {0, 0, 0};
    uint32_t sent = 0; /* the step may underflow */
    double step = from->weight / rays, next = step * random_unit(random_mix(path->key)), passed = 0;
    for (int i = 0; i < from->count; i++) {
        struct bsdf_branch_direction towards = from->all[i].towards;
        towards.weight = colour_scale(towards.weight, from->weight / from->all[i].weight);
        passed += from->all[i].weight;
        for (uint64_t k = 0; next < passed && sent < rays; next += step, k++, sent++) {
            struct path branch = path_on(path, 1);
            branch.key = random_combine(from->all[i].key, k);
            branch.rough = true;
            sum = colour_add(sum, follow(state, at, &towards, &branch));
        }
    }
    return colour_scale(sum, 1.0 / rays);
}

/* In batches of cells, each with its share of the rays. */
static struct colour follow_batches(struct integrator_state *state, const struct surface_point *at,
                                    struct candidates *candidates, double rays, const struct path *path) {
    const uint32_t cells = candidates->cells, batch = cells < CANDIDATE_CELLS ? cells : CANDIDATE_CELLS;
    struct colour sum = {0, 0, 0};
    while (candidates->end < cells) {
        candidates->begin = candidates->end;
        candidates->end = cells - candidates->begin < batch ? cells : candidates->begin + batch;
        find_candidates(at, candidates);
        double here = math_max(1, floor(rays * (candidates->end - candidates->begin) / cells));
        sum = colour_add(sum, follow_candidates(state, at, candidates, (uint32_t)here, path));
    }
    return sum;
}

/* Deep paths have few cells. Their memory is not in one frame with that for many, so their stack stays small. */
static struct colour follow_few(struct integrator_state *state, const struct surface_point *at,
                                struct candidates *candidates, double rays, const struct path *path) {
    struct candidate found[FEW_CELLS * BSDF_LOBES];
    candidates->all = found;
    return follow_batches(state, at, candidates, rays, path);
}

static __attribute__((noinline)) struct colour follow_many(struct integrator_state *state,
                                                           const struct surface_point *at,
                                                           struct candidates *candidates, double rays,
                                                           const struct path *path) {
    struct candidate found[CANDIDATE_CELLS * BSDF_LOBES];
    candidates->all = found;
    return follow_batches(state, at, candidates, rays, path);
}

/* The share of light in the rough branches. */
static double rough_share(const struct bsdf_branch *branches, int count) {
    double share = 0;
    for (int i = 0; i < count; i++)
        share += branches[i].rough ? branches[i].expected * colour_max_abs(branches[i].weight) : 0;
    return share;
}

/* Whether the rough branches divide one number of rays. After a rough surface, glass sends one ray to each side. */
static bool is_divided(const struct bsdf *bsdf, const struct bsdf_branch *rough, const struct path *path) {
    return bsdf_branch_is_layered(bsdf, rough) && !(path->rough && bsdf_lobes_with(bsdf, BSDF_TRANSMITS));
}

/* All rough branches of a layered material: as many rays as their share of light justifies, which the samples of a
 * pixel divide among them. After a rough surface there is one ray, with a chance (Russian roulette: J. Arvo and D.
 * Kirk, "Particle Transport and Image Synthesis", SIGGRAPH 1990). */
static struct colour follow_layers(struct integrator_state *state, const struct surface_point *at,
                                   const struct bsdf_branch *branches, int count, const struct path *path) {
    const double side = at->bsdf->glossy_samples ? at->bsdf->glossy_samples : GLOSSY_SAMPLES, all = side * side;
    const double share = rough_share(branches, count);
    const bool is_coarse = path->rough || state->job->settings.coarse;
    const double chance = is_coarse ? math_min(4 * share, 1) : 1;
    const double rays = is_coarse ? 1 : math_min(all, math_max(1, ceil(2 * all * share / state->sampler.side)));
    const uint32_t n = (uint32_t)math_max(2, ceil(sqrt(rays)));
    uint64_t key = sampler_branch(path->key, SAMPLER_ROUGH);
    struct candidates candidates = {.branches = branches,
                                    .branch_count = count,
                                    .facets = sampler_facets(&state->sampler, path->key, key, n),
                                    .cells = n * n};
    if (chance < 1 && random_unit(random_mix(key)) >= chance)
        return (struct colour){0, 0, 0};
    OBSERVE(state->observer, OBSERVED_SPLIT, .part = 1 / rays);
    struct colour sum = (n * n <= FEW_CELLS ? follow_few : follow_many)(state, at, &candidates, rays, path);
    return colour_scale(sum, 1 / chance);
}

/* --- one hit --- */

static struct colour shade(struct integrator_state *state, const struct surface_point *at, const struct path *path) {
    OBSERVE(state->observer, OBSERVED_SURFACE, .surface = at->bsdf);
    state->lit_from = state->media_dim ? at->ray->media : NULL;
    struct colour colour = state->radiosity ? stored_light(state, at->hit, at->bsdf, path->key)
                                            : style_light(state, at->hit, at->bsdf, path->key);
    colour = colour_add(colour, at->bsdf->emission);
    struct bsdf_branch branches[BSDF_LOBES];
    const struct bsdf_draw smooth = {.facet = at->bsdf->side};
    int count = bsdf_branches(at->bsdf, branches);
    const struct bsdf_branch *rough = NULL;
    for (int i = 0; i < count; i++) {
        if (branches[i].rough)
            rough = &branches[i];
        else
            colour = colour_add(colour, follow_branch(state, at, &branches[i], &smooth, path));
    }
    if (!rough)
        return colour;
    return colour_add(
        colour, (is_divided(at->bsdf, rough, path) ? follow_layers : follow_rough)(state, at, branches, count, path));
}

static struct colour shade_hit(struct integrator_state *state, const struct ray *ray, const struct hit *hit,
                               const struct joint *joint, const struct path *path) {
    const struct settings *settings = &state->job->settings;
    const struct world *world = state->job->world;
    const struct material_context context = {.specular = settings->specular,
                                             .ambient_plain = settings->ambient_plain,
                                             .total_reflection = settings->use_tir,
                                             .joint = joint_boundary(joint)};
    struct bsdf bsdf;
    struct surface_point at = {ray, hit, &bsdf};
    state->hits++;
    if (state->observer && !material_observe(&world->surfaces, hit, world->authored.materials[hit->material], &context,
                                             observe_material, state->observer))
        state->scratch->failed = true;
    material_eval(&world->surfaces, hit, ray->media, &context, &bsdf);
    double hole = 1 - bsdf.opacity;
    if (!(hole > 0))
        return shade(state, &at, path);
    struct colour behind = follow_hole(state, hit, joint, ray, hole, path);
    if (hole >= 1)
        return behind;
    struct path covered = path_on(path, bsdf.opacity);
    return colour_add_scaled(behind, shade(state, &at, &covered), bsdf.opacity);
}

/* The radiance of a ray with its hit, or NULL. */
static struct colour incident_radiance(struct integrator_state *state, const struct ray *ray, const struct hit *hit,
                                       const struct joint *joint, const struct path *path) {
    const struct world *world = state->job->world;
    bool met = hit != NULL;
    struct light_hit area_light_hit;
    const struct light *area_light = visible_light(world, ray, met ? hit->t : ray->t_max, &area_light_hit);
    double end = area_light ? area_light_hit.t : met ? hit->t : ray->t_max;

    /* The medium along the ray. */
    bool affected = medium_affects(MEDIUM_RAY_SIGHT, ray);
    double distance = INFINITY;
    if ((met || area_light) && (affected || state->observer))
        distance = end * vec3_length(ray->direction);
    struct medium_effect air = {.transmittance = {1, 1, 1}};
    struct path dimmed;
    affected = affected && medium_transmittance(MEDIUM_RAY_SIGHT, ray, distance, &air);
    struct colour left = air.transmittance;
    OBSERVE(state->observer, OBSERVED_RAY_BEGIN, .begin = {ray, hit, area_light, distance, path->weight, 0});
    if (affected) {
        dimmed = path_on(path, colour_max_abs(left));
        path = &dimmed;
    }

    struct colour colour = {0, 0, 0}, seen, in_scattered = air.added;
    bool looked = !(path->weight < path->cutoff);
    if (!looked) {
        left = colour_all(0);
        in_scattered = air.source;
    } else if (area_light)
        colour = light_emitted(area_light, ray, &area_light_hit);
    else if (met)
        colour = shade_hit(state, ray, hit, joint, path);
    else if (state->job->settings.transparent && path->reflections == 0 && path->refractions == 0)
        state->seen_through += path->weight;
    else
        colour = sky_colour(&world->sky, vec3_normalize(ray->direction), ray->footprint.spread);
    seen = colour;
    if (affected && looked)
        in_scattered = colour_add(
            in_scattered, media_in_scattering(state, ray, distance, sampler_branch(path->key, SAMPLER_IN_MEDIUM)));
    if (affected)
        colour = colour_add(colour_mul(colour, left), in_scattered);
    colour = integrator_clamp_light(state, colour, light_limit);
    OBSERVE(state->observer, OBSERVED_RAY_END, .end = {looked, seen, left, in_scattered, colour});
    return colour;
}

static void record_hit(const struct world *world, const struct hit *hit, struct camera_hit *out) {
    bool through = world->material_has_medium[hit->material] || primitive_prototype(world, hit->primitive)->holes;
    out->t = through ? INFINITY : hit->t;
    out->primitive = hit->primitive;
    out->material = hit->material;
    out->normal = hit->front ? hit->normal : vec3_negate(hit->normal);
}

/* The same for a ray that hits a primitive which touches others. */
static __attribute__((noinline)) struct colour joined_radiance(struct integrator_state *state, const struct ray *ray,
                                                               struct hit *hit, const struct path *path,
                                                               struct camera_hit *record) {
    struct joint joint;
    bool met = world_join(state->job->world, ray, state->scratch, hit, &joint);
    if (met && record)
        record_hit(state->job->world, hit, record);
    return incident_radiance(state, joint.passed ? &joint.ray : ray, met ? hit : NULL, &joint, path);
}

/* The radiance of a ray that has met a surface, or NULL. record: where a hit is noted, or NULL. */
static inline struct colour radiance_of(struct integrator_state *state, const struct ray *ray, struct hit *hit,
                                        const struct path *path, struct camera_hit *record) {
    static const struct joint single = {.joined = JOINED_NOT};
    if (hit && world_touches(state->job->world, hit))
        return joined_radiance(state, ray, hit, path, record);
    if (hit && record)
        record_hit(state->job->world, hit, record);
    return incident_radiance(state, ray, hit, &single, path);
}

static inline __attribute__((always_inline)) struct colour trace(struct integrator_state *state, const struct ray *ray,
                                                                 const struct path *path) {
    struct hit hit;
    if (integrator_cancelled(state))
        return colour_all(0); /* deep paths through glass grow exponentially */
    bool met = world_nearest_surface(state->job->world, ray, state->scratch, &hit);
    return radiance_of(state, ray, met ? &hit : NULL, path, NULL);
}

/* The light of a camera ray that starts in the media of the eye. met: its hit, or NULL. ask: it is not known yet. */
static struct colour camera_light(const struct whitted *whitted, struct integrator_state *state, const struct ray *ray,
                                  const struct packet_answer *met, bool ask, uint64_t key) {
    const struct world *world = state->job->world;
    const struct path path = {.key = key, .weight = 1, .cutoff = whitted->cutoff};
    struct ray from_eye = *ray;
    struct hit hit;
    bool found = met;
    from_eye.media = state->eye_medium_stack;
    if (state->job->settings.style == STYLE_INK) /* a drawing of lines alone */
        return colour_all(1);
    if (integrator_cancelled(state))
        return colour_all(0);
    if (ask)
        found = world_nearest_surface(world, &from_eye, state->scratch, &hit);
    else if (met)
        world_describe(world, &from_eye, met->primitive, &met->crossing, &hit);
    struct colour light = radiance_of(state, &from_eye, found ? &hit : NULL, &path, state->camera_hit);
    return integrator_clamp_light(state, light, (double)FLT_MAX);
}

struct colour whitted_trace(const struct whitted *whitted, struct integrator_state *state, const struct ray *ray,
                            uint64_t key) {
    return camera_light(whitted, state, ray, NULL, true, key);
}

struct colour whitted_trace_met(const struct whitted *whitted, struct integrator_state *state, const struct ray *ray,
                                const struct packet_answer *met, uint64_t key) {
    return camera_light(whitted, state, ray, met, false, key);
}
