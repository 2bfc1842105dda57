/* From a hit to a point of an image. */
#ifndef GRAY_MATERIAL_TEXTURE_MAPPING_INTERNAL_H
#define GRAY_MATERIAL_TEXTURE_MAPPING_INTERNAL_H

#include "material/texture.h"
#include "shape/shape.h"

/* u from the left, v from the top, both in images; the size of the ray's footprint in the same units. */
struct texcoord {
    double u, v, width_u, width_v;
    enum image_wrap wrap_u, wrap_v;
    /* How the point moves in world space with u and with v; zero where the shape does not say. */
    struct vec3 dpdu, dpdv;
};

/* The mapping that replaces this one on shapes of that layout. */
enum texture_mapping texture_mapping_on(enum texture_mapping mapping, enum surface_layout layout);
/* False: this surface has no coordinates for the mapping. */
bool texture_coordinates(const struct texture_image *image, const struct hit *hit, struct texcoord *out);
/* The image there, premultiplied. */
struct rgba texture_texel(const struct texture_image *image, const struct texcoord *at);

#endif
