/* Bump maps and normal maps: normals changed by textures. */
#ifndef GRAY_MATERIAL_BUMP_H
#define GRAY_MATERIAL_BUMP_H

#include "geometry/hit.h"
#include "material/surface_material.h"

/* A bump or a normal map (MATERIAL_BUMP, MATERIAL_NORMAL) over nothing, as high as one that says nothing of it: slopes
 * as the colours have them; heights of BUMP_HEIGHT, of the size on the surface where the texture is an image alone. */
struct bump bump_make(enum material_kind kind, const struct texture *texture);

/* Changes *normal, a unit vector, by the bumps of the material, from the lowest to the highest; keeps its bits if there
 * are none or their textures are constant. Needs hit->raise and the tangents of the mapping (needs_tangents); does
 * nothing if a shape has none. */
void bump_turn_normal(const struct surface_tables *tables, const struct surface_material *material,
                      const struct hit *hit, struct vec3 *normal);
/* The same by the bumps of the clear coat, which the other function leaves out. False: there are none. */
bool bump_turn_coat(const struct surface_tables *tables, const struct surface_material *material, const struct hit *hit,
                    struct vec3 *normal);

#endif
