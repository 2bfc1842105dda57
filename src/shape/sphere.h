/* The sphere's mathematics, in its own space. */
#ifndef GRAY_SHAPE_SPHERE_H
#define GRAY_SHAPE_SPHERE_H

#include "geometry/crossing.h"
#include "geometry/hit.h"
#include "math/ray.h"

/* Both crossings of the whole line in order, the entering one first; false when there are none. The part is 0. */
bool sphere_crossings(struct vec3 centre, double radius, const struct ray *ray, struct crossing out[2]);
bool sphere_contains(struct vec3 centre, double radius, struct vec3 point);
void sphere_describe(struct vec3 centre, double radius, const struct ray *ray, const struct crossing *crossing,
                     struct surface *out);

/* Adds the parameters of the classic image mapping to a surface that sphere_describe has filled: apart, because they
 * cost more than all the rest and few materials ask (those that do work from the normal: material/material.c). */
void sphere_uv(double radius, struct surface *surface);
/* How the point with this unit normal moves with u and with v. */
void sphere_tangents(double radius, struct vec3 normal, struct vec3 *dpdu, struct vec3 *dpdv);

/* --- The ellipsoid with its axes along x, y and z, in its own space --- */

struct ellipsoid {
    struct vec3 centre, radii; /* > 0 */
};

int ellipsoid_crossings(const struct ellipsoid *e, const struct ray *ray, struct crossing out[2]);
bool ellipsoid_contains(const struct ellipsoid *e, struct vec3 point);
void ellipsoid_describe(const struct ellipsoid *e, const struct ray *ray, const struct crossing *crossing,
                        struct surface *out);
void ellipsoid_extent(const struct ellipsoid *e, struct vec3 g, double *lo, double *hi);

#endif
