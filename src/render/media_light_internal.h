/* Light in media: what they leave of a ray to a light, and, for Whitted's integrator, what they scatter towards the
 * eye. Paths are in path_pieces_internal.h. */
#ifndef GRAY_RENDER_MEDIA_LIGHT_INTERNAL_H
#define GRAY_RENDER_MEDIA_LIGHT_INTERNAL_H

#include "render/integrator_state_internal.h"

/* What is left of light along the ray, in its media, over t up to `end`, through the invisible surfaces of media.
 * key: of random transmittances; NULL: those of a quadrature. *media: those at the end. */
struct colour media_left(const struct world *world, const struct ray *ray, double end, const uint64_t *key,
                         struct world_scratch *scratch, struct medium_stack *media);
/* Whether a medium that dims rays to lights may be anywhere. */
bool media_dim_lights(const struct world *world);

/* The light of lamps that media scatter once towards the origin of the ray, and their emission unless
 * medium_transmittance has it, over a distance that may be infinite: the mean of strata, each with a ray to every
 * lamp. */
struct colour media_in_scattering(struct integrator_state *state, const struct ray *ray, double distance, uint64_t key);

#endif
