/* Sampling of a triangle by its solid angle at a point (sampling.c). */
#ifndef GRAY_MATH_SPHERICAL_TRIANGLE_H
#define GRAY_MATH_SPHERICAL_TRIANGLE_H

#include "math/sampling.h"

struct spherical_triangle {
    struct vec3 from, corner, edge1, edge2;
    struct vec3 a, b, across; /* unit directions of two corners; `across`: from a towards the third one, tangent at a */
    double cos_ab, cos_ac, cos_alpha, sin_alpha; /* cosines of two arcs; the angle at a */
    double angle;                                /* the solid angle */
};

/* False: its solid angle is too small, or almost a half-space. */
bool spherical_triangle_make(struct vec3 corner, struct vec3 edge1, struct vec3 edge2, struct vec3 from,
                             struct spherical_triangle *out);
/* A point of the triangle; equal areas of the unit square are equal solid angles. */
struct vec3 spherical_triangle_point(const struct spherical_triangle *seen, struct sample2 xi);

#endif
