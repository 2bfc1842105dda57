/* What the media along a ray do to its light: absorption inside transparent solids (the current medium of the ray's
 * stack) and fog in the open air. Integrators ask here and nowhere else.
 *
 * Rays are of kinds, and each medium states which of them it affects. Shadow rays are of none: transparent solids throw
 * full shadows, and the classic fogs dim what is seen, not the light of lamps. */
#ifndef GRAY_MATERIAL_MEDIUM_H
#define GRAY_MATERIAL_MEDIUM_H

#include "material/fog.h"
#include "material/medium_stack.h"
#include "math/ray.h"

enum medium_ray {
    MEDIUM_RAY_SIGHT = 1,  /* from the camera, with all that is reflected, refracted and seen through holes after it */
    MEDIUM_RAY_PHOTON = 2, /* of a photon */
};

/* Sets of them. */
enum {
    ABSORPTION_AFFECTS = MEDIUM_RAY_SIGHT | MEDIUM_RAY_PHOTON,
    FOG_AFFECTS = MEDIUM_RAY_SIGHT,
};

/* Light that was `x` is transmittance * x + source * (1 - transmittance) after it. */
struct medium_effect {
    struct vec3 transmittance; /* 0..1 */
    struct vec3 source;        /* what a stretch without end shows of the medium itself */
};

/* From the ray's origin over a distance in world units (infinite: nothing was met). fog: of the scene, or NULL. False:
 * the ray is not affected; the effect is that of nothing. */
bool medium_transmittance(enum medium_ray kind, const struct fog *fog, const struct ray *ray, double distance,
                          struct medium_effect *out);

#endif
