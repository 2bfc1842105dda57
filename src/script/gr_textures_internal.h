/* Textures that are no images. */
#ifndef GRAY_SCRIPT_GR_TEXTURES_INTERNAL_H
#define GRAY_SCRIPT_GR_TEXTURES_INTERNAL_H

#include "call/context.h"

/* The texture of an input, or a constant texture of its number or colour; NULL with an error. */
const struct texture *gr_texture_of(struct script_context *context, const struct script_value *value,
                                    struct error *error);
/* The image of a texture whose alpha is opacity, if it is for the colour or the opacity of a material; else NULL. */
const struct texture_image *gr_cut_of(const struct script_value *value, enum material_input input);
/* Adds img:at to the handles of textures; after lenient_open. */
void textures_open(lua_State *L);

#endif
