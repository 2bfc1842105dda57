/* The path tracer: surfaces also receive the light that other surfaces reflect (J. Kajiya, "The Rendering Equation",
 * SIGGRAPH 1986). Next-event estimation at every vertex and BSDF sampling are combined by multiple importance sampling
 * with the power heuristic, and Russian roulette ends paths (E. Veach, "Robust Monte Carlo Methods for Light Transport
 * Simulation", 1997, chapters 9 and 10). The vocabulary is that of pbrt-v4.
 *
 * path.c: pixels and their samples. path_pieces_internal.h: one path. path_light.c: the light that reaches a vertex. */
#ifndef GRAY_RENDER_PATH_INTERNAL_H
#define GRAY_RENDER_PATH_INTERNAL_H

#include "base/arena.h"
#include "material/glow.h"
#include "photon/photon_trace.h"
#include "render/contour_internal.h"
#include "render/filter_internal.h"
#include "render/render_internal.h"
#include "render/style_internal.h"
#include "world/world_lights.h"

/* A light with a middle, by number. */
struct aimed_light {
    uint32_t light;
    struct light_bounds bounds;
};

/* State of a run. Owns the arena, and the contours of each worker. */
struct path_tracer {
    uint32_t samples;   /* of a pixel, at most */
    int max_depth;      /* scattering events of a path: 0 emission, 1 direct light */
    int roulette_depth; /* scattering events after which roulette may end a path */
    enum path_strategy strategy;
    struct filter filter;
    double noise;                           /* a tile with this noise is finished; 0: every tile takes all samples */
    double clamp;                           /* the limit on components of a sample; 0: no limit */
    double bright;                          /* of struct path_pixel */
    bool has_parts;                         /* path_has_parts */
    bool built;                             /* the lights are prepared */
    bool has_matter;                        /* media that affect rays, dispersion, or light that goes under surfaces */
    bool has_fillings;                      /* media inside invisible surfaces */
    bool in_medium;                         /* the medium around all solids affects rays */
    bool disperses;                         /* indices of refraction depend on the wavelength */
    const struct aimed_light *aimed_lights; /* path_equiangular_internal.h */
    uint32_t aimed_light_count;
    const struct glow *glow; /* or NULL */
    const bool *sealed; /* by number of solid: light scatters inside, and no lamp reaches a point there; NULL: none */
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

/* Where no lamp reaches. */
static inline bool path_is_sealed(const struct path_tracer *tracer, const struct medium_stack *media) {
    return tracer->sealed && media->count > 0 && tracer->sealed[media->solids[media->count - 1]];
}

/* The position of a sample of a pixel, and the weight of the filter there. */
struct pixel_sample path_sample_position(const struct path_tracer *tracer, const struct render_job *job, int64_t x,
                                         int64_t y, uint32_t number);
/* The last piece of a path (path_pieces_internal.h). parts: or NULL. */
void path_add(struct path_pixel *pixel, const struct path_parts *parts, struct colour light, double seen_through,
              double weight);
/* Whether paths record parts besides their light. */
bool path_has_parts(const struct settings *settings);

/* See render/integrator_internal.h. `tracer` is zero-initialised. */
struct film_record path_tracer_record(const struct settings *settings);
bool path_tracer_create(struct path_tracer *tracer, struct renderer *renderer, struct render_statistics *statistics,
                        struct error *error);
void path_tracer_destroy(struct path_tracer *tracer);
bool path_tracer_render(const struct path_tracer *tracer, struct renderer *renderer, struct worker *worker,
                        const struct film_rectangle *part);
bool path_tracer_render_by_device(const struct path_tracer *tracer, struct renderer *renderer, struct worker *worker);
void path_tracer_repeat(const struct path_tracer *tracer, struct renderer *renderer, struct worker *worker, int64_t x,
                        int64_t y);
void path_tracer_warn(const struct render_job *job, world_warning *warn, void *context);

#endif
