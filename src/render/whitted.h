/* The recursive integrator of Whitted, "An Improved Illumination Model for Shaded Display", CACM 1980, with the rules
 * of SPEC 1.2: own light, reflected and refracted rays with independent counters, media stack, Fresnel. */
#ifndef GRAY_RENDER_WHITTED_H
#define GRAY_RENDER_WHITTED_H

#include "math/sampling.h"
#include "render/media.h"
#include "render/render.h"
#include "world/packet.h"

/* One worker's view of a job. */
struct tracer {
    const struct render_job *job;
    const struct pool *pool; /* asked whether to stop; NULL: never */
    struct world_scratch *scratch;
    const struct medium_stack *eye_media; /* what the camera stands in */
    struct strata strata;                 /* of the pixel sample that is traced */
    const struct photon_map *caustics;    /* or NULL */
    double cutoff;                        /* cutoff_weight of the job */
    struct story *story;                  /* who writes down what happens, or NULL */
    uint64_t reflected_rays, refracted_rays, shadow_rays, hits;
    bool clamped; /* set where a colour was not finite or too large */
};

/* The colour a camera ray brings, clamped to the range of float; key: the random key of this pixel and sample. */
struct vec3 whitted_trace(struct tracer *tracer, const struct ray *ray, uint64_t key);
/* The same for a ray that went with a packet: what it has met, or NULL. */
struct vec3 whitted_trace_met(struct tracer *tracer, const struct ray *ray, const struct packet_answer *met,
                              uint64_t key);

#endif
