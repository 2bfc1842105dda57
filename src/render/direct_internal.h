/* Direct light at a hit, and caustics. */
#ifndef GRAY_RENDER_DIRECT_INTERNAL_H
#define GRAY_RENDER_DIRECT_INTERNAL_H

#include "material/bsdf.h"
#include "render/integrator_state_internal.h"

/* The light that the surface reflects towards hit->view, with the ambient light. key: the random key of the path so
 * far. */
struct colour direct_light(struct integrator_state *state, const struct hit *hit, const struct bsdf *bsdf,
                           uint64_t key);

#endif
