/* The disc and the annulus. */
#ifndef GRAY_GEOM_SHAPE_DISC_H
#define GRAY_GEOM_SHAPE_DISC_H

#include "geom/flat.h"

/* 0 <= inner < radius, normal of any length > 0. */
struct flat flat_disc(struct vec3 centre, struct vec3 normal, double radius, double inner);

/* a and b count radii from the centre; inner is the hole's share of the radius. */
static inline bool disc_holds(double inner, double a, double b) {
    double square = a * a + b * b;
    return square <= 1 && square >= inner * inner;
}
/* How far it reaches along a direction whose parts along u and v are given. */
static inline double disc_reach(double u, double v) {
    return vec3_length(vec3_make(u, v, 0));
}
/* From radii to the image, which is the square round the disc. */
void disc_image(const struct flat *flat, struct surface *out);

#endif
