/* Recorded functions at a hit: their values averaged over the footprint of the ray, and their slopes for bumps. */
#ifndef GRAY_MATERIAL_TEXTURE_FUNCTION_INTERNAL_H
#define GRAY_MATERIAL_TEXTURE_FUNCTION_INTERNAL_H

#include "material/texture.h"

/* The mean of a TEXTURE_FUNCTION over the footprint, from 1 to recorded.points points. A number counts for all three
 * components, NaN as 0. Without a footprint it is the value at the hit. */
struct colour texture_function_colour(const struct texture_operation *texture, const struct hit *hit);

/* The slopes of the surface with heights `height` times the number of a TEXTURE_FUNCTION, averaged over the footprint:
 * the derivatives along the tangents of frame_tangents in pattern space (hit->along_a, along_b). False: the function
 * may be discontinuous within the footprint, has no finite slope there, or is too large. */
bool texture_function_slopes(const struct texture_operation *texture, const struct hit *hit, double height,
                             double slopes[2]);

#endif
