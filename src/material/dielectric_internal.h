/* The laws of a smooth boundary between two dielectrics. Directions are unit vectors that point away from the surface,
 * normals lie on the side of `view`; eta = index on view's side / index on the other side. */
#ifndef GRAY_MATERIAL_DIELECTRIC_INTERNAL_H
#define GRAY_MATERIAL_DIELECTRIC_INTERNAL_H

#include "math/vec3.h"

#include <stdbool.h>

struct vec3 dielectric_mirror(struct vec3 normal, struct vec3 view); /* 2 (n.v) n - v */
/* Snell's law. False: total internal reflection. */
bool dielectric_refract(struct vec3 normal, struct vec3 view, double eta, struct vec3 *out);
/* Unpolarised Fresnel reflectance; 1 beyond the critical angle. cos_view > 0. */
double dielectric_fresnel(double cos_view, double eta);

#endif
