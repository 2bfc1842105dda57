/* The recursive integrator of Whitted, "An Improved Illumination Model for Shaded Display", CACM 1980, with the rules
 * of SPEC 1.2: own light, reflected and refracted rays with independent counters, media stack, Fresnel. */
#ifndef GRAY_RENDER_WHITTED_H
#define GRAY_RENDER_WHITTED_H

#include "render/integrator_state.h"
#include "world/packet.h"

/* What all rays of a job share. */
struct whitted {
    double cutoff; /* cutoff_weight */
};

struct whitted whitted_make(const struct render_job *job);
/* The colour a camera ray brings, clamped to the range of float; key: the random key of this pixel and sample. */
struct vec3 whitted_trace(const struct whitted *whitted, struct integrator_state *tracer, const struct ray *ray,
                          uint64_t key);
/* The same for a ray that went with a packet: what it has met, or NULL. */
struct vec3 whitted_trace_met(const struct whitted *whitted, struct integrator_state *tracer, const struct ray *ray,
                              const struct packet_answer *met, uint64_t key);

#endif
