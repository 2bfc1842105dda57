/* The path tracer: light goes from wall to wall (J. Kajiya, "The Rendering Equation", SIGGRAPH 1986). Next-event
 * estimation at every vertex and BSDF sampling are combined by multiple importance sampling with the power heuristic,
 * and Russian roulette ends paths (E. Veach, "Robust Monte Carlo Methods for Light Transport Simulation", 1997,
 * chapters 9 and 10). The vocabulary is that of pbrt-v4.
 *
 * path.c: pixels and their samples. path_trace.c: one path. path_light.c: the light that reaches a vertex. */
#ifndef GRAY_RENDER_PATH_INTERNAL_H
#define GRAY_RENDER_PATH_INTERNAL_H

#include "base/arena.h"
#include "render/filter_internal.h"
#include "render/photon_trace_internal.h"
#include "render/render_internal.h"
#include "world/world_lights.h"

/* Of a run. Owns the arena. */
struct path_tracer {
    uint32_t samples; /* of a pixel, at most */
    int max_depth;    /* scattering events of a path: 0 emission, 1 direct light */
    enum path_strategy strategy;
    struct filter filter;
    double noise; /* a tile with that is done; 0: all samples */
    double clamp; /* largest component of a sample; 0: any */
    bool built;   /* the lights are there */
    /* With --caustics: photons bring the light of these lights (by number) that traced lobes throw onto classic ones,
     * and paths leave it out. NULL: paths bring it. */
    const bool *photon_lights;
    struct photon_map caustics;
    struct arena arena;
    struct world_lights lights; /* immutable while the render runs */
};

/* See render/integrator_internal.h. `tracer` is zero. */
struct film_record path_tracer_record(const struct settings *settings); /* NULL: the least */
bool path_tracer_create(struct path_tracer *tracer, struct renderer *renderer, struct render_statistics *statistics,
                        struct error *error);
void path_tracer_destroy(struct path_tracer *tracer);
bool path_tracer_render(const struct path_tracer *tracer, struct renderer *renderer, struct worker *worker,
                        const struct rectangle *part);
void path_tracer_repeat(const struct path_tracer *tracer, struct renderer *renderer, struct worker *worker, int64_t x,
                        int64_t y);
void path_tracer_warn(const struct render_job *job, world_warning *warn, void *context);

/* path_trace.c. The radiance that a camera ray brings, clamped to the range of float; key: the random key of the ray.
 */
struct vec3 path_trace(const struct path_tracer *tracer, struct integrator_state *state, const struct ray *ray,
                       uint64_t key);
/* The same for a ray that went with a packet: what it has met, or NULL. */
struct vec3 path_trace_met(const struct path_tracer *tracer, struct integrator_state *state, const struct ray *ray,
                           const struct packet_answer *met, uint64_t key);

/* --- path_light.c --- */

/* A vertex whose BSDF is known. */
struct path_vertex {
    const struct ray *ray; /* that met it */
    const struct hit *hit;
    const struct bsdf *bsdf;
    struct light_receiver receiver;
    uint32_t lobes;             /* that scatter */
    uint32_t substitute;        /* highlights that stand for the mirror image of lights which no mirror shows */
    struct vec3 thrown;         /* share of the path's weight that photons bring, if traced lobes scatter here */
    struct vec3 *direct_shares; /* or NULL; path_direct sets what path_shares says about the light that it finds */
};

/* A ray that was scattered at a receiver. */
struct path_segment {
    const struct ray *ray;
    const struct light_receiver *receiver;
    double pdf;         /* of its direction by solid angle; 0: it had no other one */
    struct vec3 thrown; /* share of the path's weight that photons bring, where they bring the light that it meets */
};

/* Light that comes straight from one light of the scene: `choice` chooses it, `xi` lies on it. */
struct vec3 path_direct(const struct path_tracer *tracer, struct integrator_state *state,
                        const struct path_vertex *vertex, double choice, struct sample2 xi);
/* How much of the light that these lobes of the vertex scatter from wi belongs to each kind of scattering, by channel;
 * the sum is 1. */
void path_shares(const struct path_vertex *vertex, uint32_t lobes, struct vec3 wi, struct vec3 out[PATH_SCATTERINGS]);
/* A kind alone: that of a lobe with these flags. */
void path_share_all(unsigned flags, struct vec3 out[PATH_SCATTERINGS]);
/* What scattered rays bring, weighted against path_direct: of a surface whose material emits `emission` at the hit; of
 * the lamps that the ray meets before t_max; of skies where it meets nothing. */
struct vec3 path_emission(const struct path_tracer *tracer, const struct path_segment *segment, const struct hit *hit,
                          struct vec3 emission);
struct vec3 path_area_lights(const struct path_tracer *tracer, const struct path_segment *segment, double t_max);
struct vec3 path_environment(const struct path_tracer *tracer, const struct path_segment *segment);
/* The nearest lamp that shows itself on a line of sight before t_max, and where. */
bool path_area_light_seen(const struct path_tracer *tracer, const struct ray *ray, double t_max, double *t,
                          struct vec3 *radiance);

#endif
