/* The path tracer: surfaces also receive the light that other surfaces reflect (J. Kajiya, "The Rendering Equation",
 * SIGGRAPH 1986). Next-event estimation at every vertex and BSDF sampling are combined by multiple importance sampling
 * with the power heuristic, and Russian roulette ends paths (E. Veach, "Robust Monte Carlo Methods for Light Transport
 * Simulation", 1997, chapters 9 and 10). The vocabulary is that of pbrt-v4.
 *
 * path.c: pixels and their samples. path_trace.c: one path. path_light.c: the light that reaches a vertex. */
#ifndef GRAY_RENDER_PATH_INTERNAL_H
#define GRAY_RENDER_PATH_INTERNAL_H

#include "base/arena.h"
#include "photon/photon_trace.h"
#include "render/filter_internal.h"
#include "render/render_internal.h"
#include "render/style_internal.h"
#include "world/world_lights.h"

/* State of a run. Owns the arena, and the contours of each worker. */
struct path_tracer {
    uint32_t samples;   /* of a pixel, at most */
    int max_depth;      /* scattering events of a path: 0 emission, 1 direct light */
    int roulette_depth; /* scattering events after which roulette may end a path */
    enum path_strategy strategy;
    struct filter filter;
    double noise; /* a tile with this noise is finished; 0: every tile takes all samples */
    double clamp; /* the limit on components of a sample; 0: no limit */
    bool built;   /* the lights are prepared */
    /* With --caustics: photons carry the light from these lights (by number) that reaches classic lobes through
     * traced lobes, and paths omit it. NULL: paths include it. */
    const bool *photon_lights;
    struct photon_map caustics;
    struct film *tiles;       /* with --noise: of each worker, for the tile that it makes; else NULL */
    struct contour *contours; /* NULL: no lines */
    int contour_count;
    struct arena arena;
    struct world_lights lights; /* immutable while the render runs */
};

/* See render/integrator_internal.h. `tracer` is zero-initialised. */
struct film_record path_tracer_record(const struct settings *settings);
bool path_tracer_create(struct path_tracer *tracer, struct renderer *renderer, struct render_statistics *statistics,
                        struct error *error);
void path_tracer_destroy(struct path_tracer *tracer);
bool path_tracer_render(const struct path_tracer *tracer, struct renderer *renderer, struct worker *worker,
                        const struct film_rectangle *part);
void path_tracer_repeat(const struct path_tracer *tracer, struct renderer *renderer, struct worker *worker, int64_t x,
                        int64_t y);
void path_tracer_warn(const struct render_job *job, world_warning *warn, void *context);

/* path_trace.c. The radiance along a camera ray, clamped to the range of float; key: the random key of the ray.
 */
struct vec3 path_trace(const struct path_tracer *tracer, struct integrator_state *state, const struct ray *ray,
                       uint64_t key);
/* The same for a ray of a packet: its hit, or NULL. */
struct vec3 path_trace_met(const struct path_tracer *tracer, struct integrator_state *state, const struct ray *ray,
                           const struct packet_answer *met, uint64_t key);

/* --- path_light.c --- */

/* A vertex whose BSDF is known. */
struct path_vertex {
    const struct ray *ray; /* that hit it */
    const struct hit *hit;
    const struct bsdf *bsdf;
    struct light_receiver receiver;
    uint32_t lobes;      /* that scatter */
    uint32_t substitute; /* highlights that represent the mirror image of those lights that no mirror shows */
    bool sight;          /* of a line of sight, on which mirrors show only visible lights */
    struct vec3 thrown;  /* the fraction of the path's weight that photons represent, if traced lobes scatter here */
    struct vec3
        *direct_shares; /* or NULL; path_direct then stores what path_shares returns for the light that it finds */
};

/* A ray that was scattered at a receiver. */
struct path_segment {
    const struct ray *ray;
    const struct light_receiver *receiver;
    double pdf;         /* density of its direction by solid angle; 0: the only possible direction */
    struct vec3 thrown; /* the fraction of the path's weight that photons represent, for lights that send photons */
    double passed;      /* after holes: the line began at t = -passed */
};

/* Random numbers for direct light: `choice` selects the light, and the point of `sampler` in this dimension selects a
 * point on the light, if it has an extent. */
struct path_light_draw {
    double choice;
    const struct sampler *sampler;
    uint32_t dimension;
};
/* Light that arrives directly from one light of the scene. */
struct vec3 path_direct(const struct path_tracer *tracer, struct integrator_state *state,
                        const struct path_vertex *vertex, const struct path_light_draw *draw);
/* For each kind of scattering and each channel: its fraction of the light that these lobes of the vertex scatter
 * from wi. The fractions add up to 1. */
void path_shares(const struct path_vertex *vertex, uint32_t lobes, struct vec3 wi, struct vec3 out[PATH_SCATTERINGS]);
/* The fractions of a lobe with these flags: all of its light belongs to one kind. */
void path_share_all(unsigned flags, struct vec3 out[PATH_SCATTERINGS]);
/* The light along scattered rays, weighted against path_direct: that of an emissive surface (`emission` at the hit);
 * that of the area lights that the ray crosses before t_max; that of skies if it hits nothing. */
struct vec3 path_emission(const struct path_tracer *tracer, const struct path_segment *segment, const struct hit *hit,
                          struct vec3 emission);
struct vec3 path_area_lights(const struct path_tracer *tracer, const struct path_segment *segment, double t_max);
struct vec3 path_environment(const struct path_tracer *tracer, const struct path_segment *segment);
/* The nearest visible area light on a line of sight before t_max, and its distance. */
bool path_area_light_seen(const struct path_tracer *tracer, const struct ray *ray, double t_max, double *t,
                          struct vec3 *radiance);

#endif
