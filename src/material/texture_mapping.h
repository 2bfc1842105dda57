/* From a hit to a point of an image. */
#ifndef GRAY_MATERIAL_TEXTURE_MAPPING_H
#define GRAY_MATERIAL_TEXTURE_MAPPING_H

#include "material/texture.h"

/* u from the left, v from the top, both in images; the size of the ray's footprint in the same units. */
struct texcoord {
    double u, v, width_u, width_v;
    enum image_wrap wrap_u, wrap_v;
    /* How the point moves in world space with u and with v; zero where the shape does not say. */
    struct vec3 dpdu, dpdv;
};

/* False: this surface has no coordinates for the mapping. */
bool texture_coordinates(const struct texture_image *image, const struct hit *hit, struct texcoord *out);
/* The coordinates that the shape itself supplies, v from below; false: none. Searches leave those of balls out, because
 * few materials ask for them. */
bool texture_native_uv(const struct hit *hit, double *u, double *v);
/* The image there, premultiplied. */
struct rgba texture_texel(const struct texture_image *image, const struct texcoord *at);

#endif
