/* Shared by the files of this module. */
#ifndef GRAY_LIGHT_LIGHT_INTERNAL_H
#define GRAY_LIGHT_LIGHT_INTERNAL_H

#include "light/light.h"
#include "material/classic.h"

#include <math.h>

static inline double light_luminance(struct vec3 c) {
    return 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z;
}

/* The intensity of radiance 1 from a place on a plane, for the intensity of its area. */
static inline double weight_of_area(double weight, struct vec3 normal, struct vec3 away) {
    double squared = vec3_length_squared(away), cosine = fabs(vec3_dot(normal, away));
    return squared > 0 ? weight * cosine / (squared * sqrt(squared)) : 0;
}

/* The square of twice `half` about `centre` across the context's axis becomes the parallelogram that holds all targets.
 */
static inline void light_context_square(struct light_context *out, struct vec3 centre, double half) {
    out->edge1 = vec3_scale(out->right, 2 * half);
    out->edge2 = vec3_scale(out->up, 2 * half);
    out->corner = vec3_add_scaled(vec3_add_scaled(centre, out->right, -half), out->up, -half);
}

#endif
