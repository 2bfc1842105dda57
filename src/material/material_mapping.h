/* Materials on shapes. The mapping that a script requests for an image ("by the shape", "spherical") depends on the
 * shape: on spheres and boxes it becomes another mapping (texture_mapping_on). The world resolves this once, for each
 * material and each layout of its shapes, so that a hit needs no information about its shape. */
#ifndef GRAY_MATERIAL_MATERIAL_MAPPING_H
#define GRAY_MATERIAL_MATERIAL_MAPPING_H

#include "material/material.h"
#include "shape/shape.h"

struct material_mapping_entry;

/* The cache; zero except for the arena, which owns all results. */
struct material_mapping {
    struct arena *arena;
    struct material_mapping_entry *entries;
    uint32_t capacity, count;
};

/* The material as shapes of that layout show it: the same where no mapping changes. A copy has the numbers of the
 * original's base, also those that change later. NULL and error: no memory. */
const struct material *material_on_layout(struct material_mapping *mapping, const struct material *material,
                                          enum surface_layout layout, struct error *error);

#endif
