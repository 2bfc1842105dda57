/* The way of one photon: at each surface one draw decides between the mirror, what is behind, the map and nothing, by
 * how much light each would get (Russian roulette: Arvo and Kirk, "Particle Transport and Image Synthesis", SIGGRAPH
 * 1990), and the photon carries on undivided. What Whitted's rays do at a surface happens here by the same code: the
 * stack of media, Snell, Fresnel, facets, Beer. One difference: total reflection is total, whatever -use-tir says about
 * camera rays.
 *
 * A photon is a function of its number, and its place in the array is that number: threads cannot change the map. It
 * lands at most once, so memory is known before. */
#include "render/photon_trace.h"

#include "base/mem.h"
#include "base/random.h"
#include "material/material_eval.h"
#include "material/medium.h"
#include "render/photon_aim.h"

#include <time.h>

enum { BATCH = 1024 };

struct sending {
    const struct world *world;
    const struct fog *fog; /* or NULL */
    const struct settings *settings;
    const struct photon_aims *aims;
    struct pool *pool;
    struct photon *photons;
    struct world_scratch *scratches; /* of each worker */
    uint64_t seed;
    uint32_t count;
};

/* A photon under way. */
struct flight {
    struct ray ray;
    struct medium_stack media;
    struct vec3 left; /* of its power, per draw; the mean over all draws is what the surfaces leave */
    double length, strength;
    uint64_t key;
    uint32_t draws;
    bool specular; /* it met something specular */
};

static double draw(struct flight *flight) {
    return random_unit(random_combine(flight->key, flight->draws++));
}

static double mean(struct vec3 c) {
    return (c.x + c.y + c.z) / 3;
}

/* What a surface does with a photon. */
struct choice {
    struct bsdf_branch branches[BSDF_LOBES];
    int count;
    double diffuse; /* the largest component of what answers light from one direction */
};

static struct choice choice_make(const struct bsdf *bsdf) {
    struct choice choice = {.diffuse = 0};
    for (int i = 0; i < bsdf->count; i++) {
        if (lobe_flags(bsdf->lobes[i].kind) & BSDF_LAMBERT)
            choice.diffuse = vec3_max_abs(bsdf->lobes[i].weight);
    }
    choice.count = bsdf_branches(bsdf, choice.branches);
    return choice;
}

/* On to where one of the branches sends it. False: absorbed. */
static bool fly_on(struct flight *flight, const struct hit *hit, const struct bsdf *bsdf, const struct choice *choice) {
    double to[BSDF_LOBES], all = 0;
    for (int i = 0; i < choice->count; i++) {
        to[i] = fmax(mean(vec3_mul(flight->left, choice->branches[i].weight)), 0) * choice->branches[i].expected;
        all += to[i];
    }
    /* All photons are to have the same power: what is left of one that met the strongest thing of its cell. */
    double survival = all < flight->strength ? all / flight->strength : 1, x = draw(flight);
    if (!(x < survival) || choice->count == 0)
        return false;
    double until = x / survival * all;
    int chosen = 0;
    while (chosen + 1 < choice->count && !(until < to[chosen]))
        until -= to[chosen++];
    const struct bsdf_branch *branch = &choice->branches[chosen];
    struct vec3 facet = bsdf->side;
    if (branch->rough) {
        double u = draw(flight), v = draw(flight);
        facet = bsdf_facet(bsdf, hit->view, (struct sample2){u, v});
    }
    struct bsdf_branch_direction sampled;
    if (!bsdf_branch_sample(bsdf, branch, hit->view, facet, &sampled))
        return false;
    flight->left = vec3_scale(vec3_mul(flight->left, sampled.weight), all / (to[chosen] * survival));
    if (sampled.transmits)
        medium_stack_cross(&flight->media, &bsdf->boundary);
    flight->ray = hit_ray(hit, &flight->ray, sampled.direction, &flight->media);
    flight->specular = true;
    return true;
}

static void land(const struct photon_start *start, const struct photon_aim *aim, const struct flight *flight,
                 const struct hit *hit, struct photon *photon) {
    struct vec3 power = vec3_mul(start->power, flight->left);
    power = vec3_scale(power, light_photon_fading(aim->emitter.light, flight->length));
    if (!vec3_finite(power) || !vec3_finite(hit->point) || !(vec3_max_abs(power) > 0))
        return;
    *photon = (struct photon){hit->point, power, photon_pack(hit->view), aim->number};
}

static void send(struct sending *s, const struct photon_aim *aim, uint32_t index, struct world_scratch *scratch,
                 struct photon *photon) {
    struct photon_start start = photon_aim_start(aim, index, s->seed);
    struct flight flight = {.ray = {.origin = start.origin, .direction = start.direction, .t_max = INFINITY},
                            .left = {1, 1, 1},
                            .strength = start.strength,
                            .key = start.key};
    medium_stack_copy(&flight.media, &aim->media);
    flight.ray.media = &flight.media;
    flight.ray.time = draw(&flight);
    if (start.power.x == 0 && start.power.y == 0 && start.power.z == 0)
        return;
    if (start.from_afar) {
        /* It comes from beyond what is finite: a ground without end may be in its way. */
        struct ray back = flight.ray;
        struct hit ground;
        back.direction = vec3_negate(start.direction);
        if (world_nearest(s->world, &back, scratch, &ground))
            return;
    }
    const struct material_context context = {
        .specular = s->settings->specular, .ambient_plain = s->settings->ambient_plain, .total_reflection = true};
    const uint8_t *lit = aim->emitter.light->lit;
    for (int bounce = 0; bounce < PHOTON_BOUNCES && !scratch->failed; bounce++) {
        struct hit hit;
        struct bsdf bsdf;
        if (!world_nearest(s->world, &flight.ray, scratch, &hit))
            return;
        flight.length += hit.t;
        struct medium_effect effect;
        if (medium_transmittance(MEDIUM_RAY_PHOTON, s->fog, &flight.ray, hit.t, &effect))
            flight.left = vec3_mul(flight.left, effect.transmittance);
        material_eval(&s->world->materials[hit.material], &hit, &flight.media, &context, &bsdf);
        if (bsdf.opacity < 1 && draw(&flight) >= bsdf.opacity) {
            /* Through a hole, as if nothing were there. */
            flight.ray = hit_ray(&hit, &flight.ray, vec3_negate(hit.view), &flight.media);
            continue;
        }
        struct choice choice = choice_make(&bsdf);
        bool receives = flight.specular && choice.diffuse > 0 && !bsdf.dark;
        if (receives && (!lit || lit[hit.placed])) {
            double on = 0;
            for (int i = 0; i < choice.count; i++)
                on += mean(choice.branches[i].weight);
            on = fmax(on, 0);
            double share = choice.diffuse / (choice.diffuse + on);
            if (draw(&flight) < share) {
                flight.left = vec3_scale(flight.left, 1 / share);
                land(&start, aim, &flight, &hit, photon);
                return;
            }
            flight.left = vec3_scale(flight.left, 1 / (1 - share));
        }
        if (!fly_on(&flight, &hit, &bsdf, &choice))
            return;
    }
}

static void send_batch(void *context, uint32_t batch, int worker) {
    struct sending *s = context;
    uint64_t end = ((uint64_t)batch + 1) * BATCH;
    const struct photon_aim *aim = s->aims->aims;
    for (uint32_t i = batch * BATCH; i < end && i < s->count && !pool_cancelled(s->pool); i++) {
        s->photons[i].light = PHOTON_NOWHERE;
        while (i >= aim->first + aim->count)
            aim++;
        send(s, aim, i - aim->first, &s->scratches[worker], &s->photons[i]);
    }
}

static bool send_all(struct sending *s, struct photon_statistics *statistics, struct error *error) {
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

static double seconds_now(void) {
    struct timespec now;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static bool aim_all(struct sending *s, struct photon_aims *aims, struct arena *arena, struct error *error) {
    struct world_scratch scratch;
    bool ok = world_scratch_init(&scratch, s->world) || error_no_memory(error, "the crossings of a photon");
    ok = ok &&
         photon_aims_make(aims, s->world, (uint32_t)s->settings->caustics.photons, arena, &scratch, s->pool, error);
    world_scratch_destroy(&scratch);
    s->aims = aims;
    s->count = aims->count > 0 ? (uint32_t)s->settings->caustics.photons : 0;
    return ok;
}

bool photons_make(struct photon_map *map, const struct render_job *job, struct pool *pool,
                  struct photon_statistics *statistics, struct error *error) {
    struct arena arena = {0};
    struct photon_aims aims = {0};
    double begin = seconds_now();
    const struct settings *settings = &job->settings;
    struct sending s = {.world = job->world,
                        .fog = job->fog,
                        .settings = settings,
                        .pool = pool,
                        .seed = random_combine(settings->seed, UINT64_C(0x70686f746f6e73))};
    *map = (struct photon_map){0};
    bool ok = aim_all(&s, &aims, &arena, error);
    if (ok && s.count > 0) {
        s.photons = mem_alloc((size_t)s.count * sizeof *s.photons);
        s.scratches = mem_alloc_zero((size_t)pool_workers(pool), sizeof *s.scratches);
        ok = s.photons && s.scratches;
        if (!ok)
            ok = error_no_memory(error, "the photons of the caustics");
        else
            ok = send_all(&s, statistics, error);
        double sent = seconds_now();
        ok = ok && photon_map_build(map, job->world, s.photons, s.count, settings->caustics.radius, pool, error);
        statistics->map_seconds += seconds_now() - sent;
    }
    statistics->sent += s.count;
    statistics->landed += map->count;
    statistics->seconds += seconds_now() - begin;
    mem_free(s.photons);
    mem_free(s.scratches);
    arena_destroy(&arena);
    if (!ok)
        photon_map_destroy(map);
    return ok;
}
