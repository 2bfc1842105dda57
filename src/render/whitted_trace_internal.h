/* One tree of rays of Whitted's integrator. */
#ifndef GRAY_RENDER_WHITTED_TRACE_INTERNAL_H
#define GRAY_RENDER_WHITTED_TRACE_INTERNAL_H

#include "render/whitted_internal.h"

/* The radiance along a camera ray, clamped to the range of float; key: the random key of this pixel and sample. */
struct colour whitted_trace(const struct whitted *whitted, struct integrator_state *state, const struct ray *ray,
                            uint64_t key);
/* The same for a ray of a packet: its hit, or NULL. */
struct colour whitted_trace_met(const struct whitted *whitted, struct integrator_state *state, const struct ray *ray,
                                const struct packet_answer *met, uint64_t key);

#endif
