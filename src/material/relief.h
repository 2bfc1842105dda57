/* Relief without geometry: normals turned by textures. */
#ifndef GRAY_MATERIAL_RELIEF_H
#define GRAY_MATERIAL_RELIEF_H

#include "material/material.h"

/* Turns *normal, a unit vector, by this and before it by all below; leaves it bit by bit where the texture is flat.
 * Needs hit->raise and the tangents of the mapping (material_has_relief); does nothing where a shape has none. */
void relief_turn(const struct relief *relief, const struct hit *hit, struct vec3 *normal);

#endif
