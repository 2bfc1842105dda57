/* Images and bump maps that other functions take. */
#ifndef GRAY_SCRIPT_GR_MATERIALS_INTERNAL_H
#define GRAY_SCRIPT_GR_MATERIALS_INTERNAL_H

#include "call/context.h"

/* The image of an argument, from the store or from its file; NULL with an error. */
struct image *gr_find_image(struct script_context *context, const struct script_value *value, struct error *error);

/* The image for node:set_texture: with the lookup of its texture, else mip-mapped and repeated; NULL with an error. */
const struct texture_image *gr_image(struct script_context *context, const struct script_value *value,
                                     struct error *error);
/* The bump map for node:set_bump: a result of gr.bump, or any other image with the default height. */
const struct bump *read_bump_values(struct script_context *context, const struct script_value *value,
                                    struct error *error);

#endif
