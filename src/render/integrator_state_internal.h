/* The common state of all integrators: one worker's view of the job. Direct light and the samples of pixels need
 * nothing else. Data of a single integrator is in its own header. */
#ifndef GRAY_RENDER_INTEGRATOR_STATE_INTERNAL_H
#define GRAY_RENDER_INTEGRATOR_STATE_INTERNAL_H

#include "film/path_parts.h"
#include "math/range.h"
#include "photon/photon_map.h"
#include "radiosity/radiosity.h"
#include "render/observer.h"
#include "render/render.h"
#include "render/sampler.h"

/* The hit of a camera ray, for comparisons of neighbouring pixels. */
struct camera_hit {
    double t;           /* infinite: no hit, or a transparent boundary */
    uint32_t primitive; /* WORLD_NOTHING: none */
    uint32_t material;
    struct vec3 normal; /* unit, towards the eye; 0 without a hit */
    uint64_t lights;    /* bit i modulo 64: light i reaches the first surface that was shaded */
};
static inline struct camera_hit camera_hit_none(void) {
    return (struct camera_hit){.t = INFINITY, .primitive = WORLD_NOTHING};
}

/* Owns nothing: all pointers outlive the worker's tiles. */
struct integrator_state {
    const struct render_job *job;
    const struct pool *pool; /* returns whether to stop; NULL: never */
    struct world_scratch *scratch;
    const struct medium_stack *eye_medium_stack; /* the medium that contains the camera */
    const struct medium_stack *lit_from;         /* the media before the surface that is lit; or NULL: nothing dims */
    struct sampler sampler;                      /* of the current pixel sample */
    const struct photon_map *caustics;           /* or NULL */
    const struct radiosity *radiosity;           /* stored light in place of that of the lights; or NULL */
    struct observer *observer;                   /* or NULL */
    struct path_parts *parts;                    /* or NULL; of the current camera ray, zero before */
    struct camera_hit *camera_hit;               /* or NULL; for a camera ray until its first hit is shaded */
    /* With settings.transparent: the share of the current sample that sees the background; 0 before. */
    double seen_through;
    bool media_dim; /* media may dim rays to lights */
    uint64_t reflected_rays, refracted_rays, shadow_rays, hits, medium_events;
    bool clamped; /* set after a colour that was not finite or too large */
};

/* Paths through glass grow exponentially, and a hit may have thousands of shadow rays: long computations check
 * whether to stop. */
static inline bool integrator_cancelled(const struct integrator_state *state) {
    return state->pool && pool_cancelled(state->pool);
}

/* The colour with channels up to the limit, and a note if that changes it. */
static inline struct colour integrator_clamp_light(struct integrator_state *state, struct colour colour, double limit) {
    if (colour_within(colour, limit))
        return colour;
    state->clamped = true;
    return colour_clamped(colour, limit);
}

#endif
