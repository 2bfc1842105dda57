/* Relief without geometry: normals turned by textures. */
#ifndef GRAY_MATERIAL_BUMP_H
#define GRAY_MATERIAL_BUMP_H

#include "material/material.h"

/* Turns *normal, a unit vector, by the bumps of the material, from the lowest on; leaves it bit by bit where there are
 * none or their textures are flat. Needs hit->raise and the tangents of the mapping (material_has_bump); does nothing
 * where a shape has none. */
void bump_turn_normal(const struct material *material, const struct hit *hit, struct vec3 *normal);

#endif
