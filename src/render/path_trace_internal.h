/* One path of the path tracer. */
#ifndef GRAY_RENDER_PATH_TRACE_INTERNAL_H
#define GRAY_RENDER_PATH_TRACE_INTERNAL_H

#include "render/path_internal.h"

/* The radiance along a camera ray, clamped to the range of float; key: the random key of the ray. */
struct vec3 path_trace(const struct path_tracer *tracer, struct integrator_state *state, const struct ray *ray,
                       uint64_t key);
/* The same for a ray of a packet: its hit, or NULL. */
struct vec3 path_trace_met(const struct path_tracer *tracer, struct integrator_state *state, const struct ray *ray,
                           const struct packet_answer *met, uint64_t key);

#endif
