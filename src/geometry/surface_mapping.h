/* Image coordinates round an axis, also for surfaces that have none of their own: wrapped like a label, or like a map
 * of the earth. */
#ifndef GRAY_GEOMETRY_SURFACE_MAPPING_H
#define GRAY_GEOMETRY_SURFACE_MAPPING_H

#include "geometry/hit.h"

/* Unit vectors at right angles to the unit vector `axis` from which angles are counted; x and z for the axis y. */
void surface_mapping_axes(struct vec3 axis, struct vec3 *x, struct vec3 *z);

/* Both fill u, v, dpdu and dpdv of a surface whose point and normal are known; normals may have any length > 0. u is
 * the turn round the axis, from 0 to 1 to the right seen from outside, beginning behind (at -x for the axis y). Where
 * the surface looks towards the axis u runs the other way, so that nothing is mirrored. */

/* Seen from `centre`: v is the angle above the lower pole, 0 to 1. The axis is y. */
void surface_mapping_sphere(struct vec3 centre, struct surface *out);
/* Seen from the axis through `base`: v is the height above the base in units of `length`. The axis has unit length. */
void surface_mapping_label(struct vec3 base, struct vec3 axis, double length, struct surface *out);

#endif
