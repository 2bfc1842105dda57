/* What the integrators of a job have in common: one worker's view of the job. Direct light and the samples of pixels
 * need no more; what only one integrator needs is in its own header. */
#ifndef GRAY_RENDER_INTEGRATOR_STATE_INTERNAL_H
#define GRAY_RENDER_INTEGRATOR_STATE_INTERNAL_H

#include "render/observer.h"
#include "render/path_parts.h"
#include "render/photon_map_internal.h"
#include "render/render.h"
#include "render/sampler.h"

/* Owns nothing: all pointers outlive the worker's tiles. */
struct integrator_state {
    const struct render_job *job;
    const struct pool *pool; /* asked whether to stop; NULL: never */
    struct world_scratch *scratch;
    const struct medium_stack *eye_medium_stack; /* what the camera stands in */
    struct sampler sampler;                      /* of the pixel sample that is traced */
    const struct photon_map *caustics;           /* or NULL */
    struct observer *observer;                   /* or NULL */
    struct path_parts *parts;                    /* or NULL; of the camera ray that is traced, zero before */
    uint64_t reflected_rays, refracted_rays, shadow_rays, hits;
    bool clamped; /* set where a colour was not finite or too large */
};

/* Paths through glass grow exponentially, and lights may have thousands of shadow rays: what takes long asks. */
static inline bool integrator_cancelled(const struct integrator_state *state) {
    return state->pool && pool_cancelled(state->pool);
}

#endif
