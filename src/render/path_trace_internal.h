/* One path of the path tracer. */
#ifndef GRAY_RENDER_PATH_TRACE_INTERNAL_H
#define GRAY_RENDER_PATH_TRACE_INTERNAL_H

#include "render/path_internal.h"
#include "world/packet.h"

/* The radiance along a camera ray, clamped to the range of float. ask: what it hits is not known yet; else that is
 * `met`, or nothing for NULL. key: the random key of the ray. */
struct colour path_trace(const struct path_tracer *tracer, struct integrator_state *state, const struct ray *ray,
                         const struct packet_answer *met, bool ask, uint64_t key);
/* The same for paths that record nothing, in scenes without and with light inside of matter; for light layers and
 * features; and for those with an observer (path_pieces_internal.h). */
struct colour path_trace_plain(const struct path_tracer *tracer, struct integrator_state *state, const struct ray *ray,
                               const struct packet_answer *met, bool ask, uint64_t key);
struct colour path_trace_matter(const struct path_tracer *tracer, struct integrator_state *state, const struct ray *ray,
                                const struct packet_answer *met, bool ask, uint64_t key);
struct colour path_trace_layers(const struct path_tracer *tracer, struct integrator_state *state, const struct ray *ray,
                                const struct packet_answer *met, bool ask, uint64_t key);
struct colour path_trace_observed(const struct path_tracer *tracer, struct integrator_state *state,
                                  const struct ray *ray, const struct packet_answer *met, bool ask, uint64_t key);

#endif
