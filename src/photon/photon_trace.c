/* The path of one photon: at each surface one random number decides between reflection, refraction, storage and
 * absorption, by their shares of light (Russian roulette: Arvo and Kirk, "Particle Transport and Image Synthesis",
 * SIGGRAPH 1990), and the photon continues undivided. Surfaces use the same code as Whitted's rays: the stack of media,
 * Snell, Fresnel, facets, Beer. One difference: total reflection is total, whatever -use-tir says about camera rays.
 *
 * A photon is a function of its number, and its place in the array is that number: threads cannot change the map. It
 * lands at most once, so memory is known before. */
#include "photon/photon_trace.h"
#include "base/clock.h"

#include "base/mem.h"
#include "base/random.h"
#include "material/bsdf_select.h"
#include "material/material_eval.h"
#include "material/medium_mix.h"
#include "photon/photon_target_internal.h"
#include "world/joint.h"
#include "world/world_describe.h"

enum { BATCH = 1024 };

struct photon_job {
    const struct world *world;
    const struct settings *settings;
    const struct photon_targets *targets;
    struct pool *pool;
    struct photon *photons;
    struct world_scratch *scratches; /* of each worker */
    uint64_t seed;
    uint32_t count;
    bool disperses; /* indices of refraction depend on the wavelength */
};

/* A photon under way. */
struct photon_path {
    struct ray ray;
    struct medium_stack media;
    struct colour left; /* of its power, per draw; the mean over all draws is what the surfaces leave */
    double length, strength;
    uint64_t key;
    uint32_t draws;
    bool specular; /* it met something specular */
};

static double draw(struct photon_path *path) {
    return random_unit(random_combine(path->key, path->draws++));
}

static double mean(struct colour c) {
    return (c.r + c.g + c.b) / 3;
}

/* The interaction of a surface with a photon. */
struct branching {
    struct bsdf_branch branches[BSDF_LOBES];
    int count;
    double diffuse; /* the largest component of what answers light from one direction */
};

static struct branching branching_make(const struct bsdf *bsdf) {
    struct branching branching = {.diffuse = bsdf_lambert(bsdf)};
    branching.count = bsdf_branches(bsdf, branching.branches);
    return branching;
}

/* On to where one of the branches sends it. False: absorbed. */
static bool scatter_photon(struct photon_path *path, const struct hit *hit, const struct bsdf *bsdf,
                           const struct branching *branching) {
    double to[BSDF_LOBES], all = 0;
    /* Single wavelengths have negative components. */
    const struct colour left = colour_abs(path->left);
    for (int i = 0; i < branching->count; i++) {
        to[i] = math_max(mean(colour_mul(left, branching->branches[i].weight)), 0) * branching->branches[i].expected;
        all += to[i];
    }
    /* All photons should have equal power: that after the strongest object of the cell. */
    double survival = all < path->strength ? all / path->strength : 1, x = draw(path);
    if (!(x < survival) || branching->count == 0)
        return false;
    double until = x / survival * all;
    int chosen = 0;
    while (chosen + 1 < branching->count && !(until < to[chosen]))
        until -= to[chosen++];
    const struct bsdf_branch *branch = &branching->branches[chosen];
    struct bsdf_draw position = {.facet = bsdf->side};
    if (branch->rough) {
        double u = draw(path), v = draw(path);
        position = bsdf_draw(bsdf, hit->view, (struct sample2){u, v});
    }
    struct bsdf_branch_direction sampled;
    if (!bsdf_branch_sample(bsdf, branch, hit->view, &position, &sampled))
        return false;
    path->left = colour_scale(colour_mul(path->left, sampled.weight), all / (to[chosen] * survival));
    if (sampled.transmits)
        bsdf_cross(bsdf, &path->media);
    path->ray = hit_ray(hit, &path->ray, sampled.direction, &path->media);
    path->specular = true;
    return true;
}

/* Passes the media over a distance. True: one of them has scattered the photon. */
static bool pass_media(struct photon_path *path, double distance) {
    struct medium_mix mix;
    struct medium_track track;
    if (!medium_affects(MEDIUM_RAY_PHOTON, &path->ray))
        return false;
    medium_stack_mix(path->ray.media, &mix);
    const struct medium_line line = {path->ray.origin, path->ray.direction, distance, path->ray.time};
    if (!medium_mix_scatters(&mix)) {
        const uint64_t key = random_combine(path->key, ~(uint64_t)path->draws); /* none of those that are drawn */
        path->left = colour_mul(path->left, medium_mix_left(&mix, &line, key));
        return false;
    }
    double u = draw(path), v = draw(path);
    const struct medium_draw numbers = {{u, v}, random_combine(path->key, path->draws++), NULL};
    medium_mix_track(&mix, &line, path->left, numbers, &track);
    path->left = colour_mul(path->left, track.weight);
    if (!track.scatterer)
        return false;
    u = draw(path), v = draw(path);
    path->length += track.distance;
    path->ray.origin = vec3_add_scaled(path->ray.origin, path->ray.direction, track.distance);
    path->ray.direction =
        phase_sample(&track.scatterer->phase, vec3_negate(path->ray.direction), (struct sample2){u, v});
    path->ray.t_min = 0;
    path->ray.skip_primitive = path->ray.skip_part = 0;
    return true;
}

static void store_photon(const struct photon_start *start, const struct photon_target *target,
                         const struct photon_path *path, const struct hit *hit, struct photon *photon) {
    struct colour power = colour_mul(start->power, path->left);
    power = colour_scale(power, light_photon_attenuation(target->emitter.light, path->length));
    if (!colour_finite(power) || !vec3_finite(hit->point) || !(colour_max_abs(power) > 0))
        return;
    *photon = (struct photon){hit->point, power, photon_pack(hit->view), target->number};
}

static void trace_photon(struct photon_job *s, const struct photon_target *target, uint32_t index,
                         struct world_scratch *scratch, struct photon *photon) {
    struct photon_start start = photon_target_start(target, index, s->seed);
    struct photon_path path = {.ray = {.origin = start.origin, .direction = start.direction, .t_max = INFINITY},
                               .left = {1, 1, 1},
                               .strength = start.strength,
                               .key = start.key};
    medium_stack_copy(&path.media, &target->media);
    path.ray.media = &path.media;
    path.ray.time = draw(&path);
    if (colour_is_black(start.power))
        return;
    if (start.from_afar) {
        /* It starts beyond the finite objects: an unbounded ground may block it. */
        struct ray back = path.ray;
        struct hit ground;
        back.direction = vec3_negate(start.direction);
        if (world_nearest(s->world, &back, scratch, &ground))
            return;
    }
    struct joint joint;
    const uint8_t *lit = target->emitter.light->lit;
    for (int bounce = 0; bounce < PHOTON_BOUNCES && !scratch->failed; bounce++) {
        struct hit hit;
        struct bsdf bsdf;
        joint.joined = JOINED_NOT;
        if (!world_nearest_surface(s->world, &path.ray, scratch, &hit)) {
            if (!pass_media(&path, INFINITY))
                return;
            continue;
        }
        if (s->disperses && world_needs_wavelength(s->world, &hit, &path.media))
            path.left = colour_mul(path.left, medium_stack_choose_wavelength(&path.media, draw(&path)));
        if (world_touches(s->world, &hit))
            world_join_path(s->world, &path.ray, &path.media, scratch, &hit, &joint);
        if (joint.joined == JOINED_AWAY)
            continue;
        if (pass_media(&path, hit.t))
            continue;
        path.length += hit.t;
        const struct material_context context = {.specular = s->settings->specular,
                                                 .ambient_plain = s->settings->ambient_plain,
                                                 .total_reflection = true,
                                                 .thin = primitive_is_thin(s->world, hit.primitive),
                                                 .joint = joint_boundary(&joint)};
        material_eval(&s->world->surfaces, &hit, &path.media, &context, &bsdf);
        if (bsdf.opacity < 1 && draw(&path) >= bsdf.opacity) {
            /* Through a hole, as if nothing were there. */
            path.ray = joint_ray_through_hole(&joint, &hit, &path.ray, &path.media);
            (void)joint_pass_invisible(s->world, &joint, &hit, &path.media);
            continue;
        }
        struct branching branching = branching_make(&bsdf);
        bool receives = path.specular && branching.diffuse > 0 && !bsdf.dark;
        if (receives && (!lit || lit[hit.primitive])) {
            double on = 0;
            for (int i = 0; i < branching.count; i++)
                on += mean(branching.branches[i].weight);
            on = math_max(on, 0);
            double share = branching.diffuse / (branching.diffuse + on);
            if (draw(&path) < share) {
                path.left = colour_scale(path.left, 1 / share);
                store_photon(&start, target, &path, &hit, photon);
                return;
            }
            path.left = colour_scale(path.left, 1 / (1 - share));
        }
        if (!scatter_photon(&path, &hit, &bsdf, &branching))
            return;
    }
}

static void send_batch(void *context, uint32_t batch, int worker) {
    struct photon_job *s = context;
    uint64_t end = ((uint64_t)batch + 1) * BATCH;
    const struct photon_target *target = s->targets->targets;
    for (uint32_t i = batch * BATCH; i < end && i < s->count && !pool_cancelled(s->pool); i++) {
        s->photons[i].light = PHOTON_NOWHERE;
        while (i >= target->first + target->count)
            target++;
        trace_photon(s, target, i - target->first, &s->scratches[worker], &s->photons[i]);
    }
}

static bool trace_photons(struct photon_job *s, struct photon_statistics *statistics, struct error *error) {
    int workers = pool_workers(s->pool);
    bool failed = false;
    for (int i = 0; i < workers && !failed; i++)
        failed = !world_scratch_init(&s->scratches[i], s->world);
    bool whole = !failed && pool_run(s->pool, (uint32_t)(((uint64_t)s->count + BATCH - 1) / BATCH), send_batch, s);
    for (int i = 0; i < workers; i++) {
        failed = failed || s->scratches[i].failed;
        statistics->rays += s->scratches[i].rays;
        world_scratch_destroy(&s->scratches[i]);
    }
    if (failed)
        return error_no_memory(error, "the crossings of a photon");
    return whole || error_set(error, ERROR_CANCELLED, "stopped while sending photons");
}

static bool find_targets(struct photon_job *s, struct photon_targets *targets, struct arena *arena,
                         struct error *error) {
    bool ok = photon_targets_make(targets, s->world, (uint32_t)s->settings->caustics.photons, arena, s->pool, error);
    s->targets = targets;
    s->count = targets->count > 0 ? (uint32_t)s->settings->caustics.photons : 0;
    return ok;
}

bool photons_make(struct photon_map *map, const struct photon_scene *scene, struct pool *pool,
                  struct photon_statistics *statistics, struct error *error) {
    struct arena arena = {0};
    struct photon_targets targets = {0};
    double begin = clock_now();
    const struct settings *settings = scene->settings;
    struct photon_job s = {.world = scene->world,
                           .settings = settings,
                           .pool = pool,
                           .disperses = world_disperses(scene->world),
                           .seed = random_combine(settings->seed, UINT64_C(0x70686f746f6e73))};
    *map = (struct photon_map){0};
    /* Where photons are sent decides how many; each has its own place, so their order is fixed. */
    bool ok = find_targets(&s, &targets, &arena, error);
    if (ok && s.count > 0) {
        s.photons = mem_alloc((size_t)s.count * sizeof *s.photons);
        s.scratches = mem_alloc_zero((size_t)pool_workers(pool), sizeof *s.scratches);
        ok = s.photons && s.scratches;
        if (!ok)
            ok = error_no_memory(error, "the photons of the caustics");
        else
            ok = trace_photons(&s, statistics, error);
        double sent = clock_now();
        ok = ok && photon_map_build(map, scene->world, &(struct photon_list){s.photons, s.count},
                                    settings->caustics.radius, pool, error);
        statistics->map_seconds += clock_now() - sent;
    }
    statistics->sent += s.count;
    statistics->landed += map->count;
    statistics->seconds += clock_now() - begin;
    mem_free(s.photons);
    mem_free(s.scratches);
    arena_destroy(&arena);
    if (!ok)
        photon_map_destroy(map);
    return ok;
}

bool photons_send(struct photon_map *map, const struct photon_scene *scene, struct pool *pool,
                  struct render_statistics *statistics, struct error *error) {
    struct photon_statistics photons = {0};
    *map = (struct photon_map){0};
    if (scene->settings->caustics.photons == 0)
        return true;
    bool ok = photons_make(map, scene, pool, &photons, error);
    statistics->photons += photons.sent;
    statistics->photons_landed += photons.landed;
    statistics->photon_rays += photons.rays;
    statistics->photon_seconds += photons.seconds;
    statistics->photon_map_seconds += photons.map_seconds;
    return ok;
}
