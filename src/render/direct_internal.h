/* Light that arrives at a hit straight from the lights of the scene, and as caustics. */
#ifndef GRAY_RENDER_DIRECT_INTERNAL_H
#define GRAY_RENDER_DIRECT_INTERNAL_H

#include "material/bsdf.h"
#include "render/integrator_state_internal.h"

/* What the surface sends to hit->view of it, with the ambient light. key: the random key of the path so far. */
struct vec3 direct_light(struct integrator_state *state, const struct hit *hit, const struct bsdf *bsdf, uint64_t key);

#endif
