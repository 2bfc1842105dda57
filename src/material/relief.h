/* Relief without geometry: normals turned by pictures. */
#ifndef GRAY_MATERIAL_RELIEF_H
#define GRAY_MATERIAL_RELIEF_H

#include "material/material.h"

/* Turn look->normal, a unit vector; leave it bit by bit where the picture is flat. Need hit->raise and the tangents of
 * the mapping (material_has_relief); do nothing where a shape has none. */
void relief_bump(const struct material *material, const struct hit *hit, struct surface_look *look);
void relief_normal(const struct material *material, const struct hit *hit, struct surface_look *look);

#endif
