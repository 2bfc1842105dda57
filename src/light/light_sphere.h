/* The mathematics of LIGHT_SPHERE, for light.c. */
#ifndef GRAY_LIGHT_LIGHT_SPHERE_H
#define GRAY_LIGHT_LIGHT_SPHERE_H

#include "light/light.h"

/* False: the point is on the sphere, or so near that the cone is a half-space, or inside and the light no lamp. */
bool light_sphere_context(const struct light *light, struct light_context *out);
/* Equal areas of the unit square are equal solid angles. */
struct vec3 light_sphere_target(const struct light *light, const struct light_context *context, struct sample2 place);
/* The nearest crossing in the ray's interval. */
bool light_sphere_meets_ray(const struct light *light, const struct ray *ray, double *t);

#endif
