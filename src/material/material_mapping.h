/* Materials on shapes. What a script asks of an image ("as the shape has it", "round the sphere") depends on the shape:
 * on balls and boxes it becomes another mapping (texture_mapping_on). The world finds out once, for each material
 * and each layout of the shapes that show it, so that a hit says nothing of the shape that it came from. */
#ifndef GRAY_MATERIAL_MATERIAL_MAPPING_H
#define GRAY_MATERIAL_MATERIAL_MAPPING_H

#include "material/material.h"
#include "shape/shape.h"

struct material_mapping_entry;

/* What is known already; zero but for the arena, in which everything made lies. */
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
