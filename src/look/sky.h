/* What a ray sees that meets nothing: a function of its unit direction alone (SPEC 1.5). */
#ifndef GRAY_LOOK_SKY_H
#define GRAY_LOOK_SKY_H

#include "base/error.h"
#include "image/image.h"
#include "math/vec3.h"

enum sky_kind { SKY_GRADIENT, SKY_CONSTANT, SKY_CROSS };

struct sky {
    enum sky_kind kind;
    struct vec3 colour;  /* of SKY_CONSTANT */
    struct image *image; /* of SKY_CROSS: a 4 x 3 cross `#T##` / `LFRK` / `#B##`, seen from inside */
    bool mirror;
};

/* Checks the proportions of the cross. */
bool sky_from_cross(struct image *image, bool mirror, struct sky *out, struct error *error);
/* `spread`: angle of the ray's cone in radians, for filtering; 0 = unknown. */
struct vec3 sky_colour(const struct sky *sky, struct vec3 direction, double spread);

#endif
