/* Authored materials and textures at a hit, by tables that are made for this hit alone. */
#ifndef GRAY_TESTS_UNIT_SURFACE_MAKERS_H
#define GRAY_TESTS_UNIT_SURFACE_MAKERS_H

#include "material/material_eval.h"

void surface_inputs_of(const struct material *material, const struct hit *hit, struct surface_inputs *out);
void surface_eval(const struct material *material, const struct hit *hit, const struct medium_stack *media,
                  const struct material_context *context, struct bsdf *out);
double surface_albedo_bound_of(const struct material *material);
struct colour texture_colour_at(const struct texture *texture, const struct hit *hit);
double texture_number_at(const struct texture *texture, const struct hit *hit);

#endif
