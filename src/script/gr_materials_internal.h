/* Images and bump maps that other functions take. */
#ifndef GRAY_SCRIPT_GR_MATERIALS_INTERNAL_H
#define GRAY_SCRIPT_GR_MATERIALS_INTERNAL_H

#include "call/context.h"
#include "material/glasses.h"

#define GLASS_WORD(name, ...) " " name
/* The row of a glass by its name. */
#define GLASS_FIELD                                                                                                    \
    {                                                                                                                  \
        "glass", KIND_CHOICE, OPTIONAL, 0, 0, &(GLASSES(GLASS_WORD))[1], NULL, "none",                                 \
            "A glass by its name: its index and its dispersion."                                                       \
    }
/* Its number in struct dispersion; 0: none. */
static inline uint32_t gr_glass_of(const struct script_value *value) {
    return value->given ? (uint32_t)value->choice + 1 : 0;
}

/* The image of an argument, from the store or from its file; NULL with an error. */
struct image *gr_find_image(struct script_context *context, const struct script_value *value, struct error *error);

/* The image for node:set_texture: with the lookup of its texture, else mip-mapped and repeated; NULL with an error. */
const struct texture_image *gr_image(struct script_context *context, const struct script_value *value,
                                     struct error *error);
/* The bump map for node:set_bump: a result of gr.bump, or any other image with the default height. */
const struct bump *read_bump_values(struct script_context *context, const struct script_value *value,
                                    struct error *error);

#endif
