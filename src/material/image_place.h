/* From a hit to a place on a picture. */
#ifndef GRAY_MATERIAL_IMAGE_PLACE_H
#define GRAY_MATERIAL_IMAGE_PLACE_H

#include "material/material.h"

/* u from the left, v from the top, both in pictures; the size of the ray's footprint in the same units. */
struct image_place {
    double u, v, width_u, width_v;
    enum image_wrap wrap_u, wrap_v;
    /* How the point moves in world space with u and with v; zero where the shape does not tell. */
    struct vec3 dpdu, dpdv;
};

/* False: this surface has no places on pictures. */
bool image_place(const struct material *material, const struct hit *hit, struct image_place *out);
/* The picture there, premultiplied. */
struct rgba image_at(const struct material *material, const struct image_place *place);

#endif
