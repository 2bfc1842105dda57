/* Deriving materials: a new one with everything of its base, except one input that is replaced or mixed. Results are in
 * the arena. False and error: no memory, or the tree of textures has become too large (texture.h). */
#ifndef GRAY_MATERIAL_MATERIAL_INPUTS_H
#define GRAY_MATERIAL_MATERIAL_INPUTS_H

#include "material/material.h"

/* All of the base, which may be NULL: then the material is a base with the numbers 0. Name, serial and `older` are the
 * caller's. */
void material_derive(struct material *material, enum material_kind kind, const struct material *base);

/* The input times the texture. */
bool material_multiply(struct material *material, enum material_input input, const struct texture *by,
                       struct arena *arena, struct error *error);
/* The input times a constant; for numbers of struct openpbr, which do not multiply the textures of their inputs. */
bool material_multiply_constant(struct material *material, enum material_input input, struct texture constant,
                                struct arena *arena, struct error *error);
/* kd * pattern + mix * (1 - pattern): marble and wood. */
bool material_mix_kd(struct material *material, struct texture pattern, struct texture mix, struct arena *arena,
                     struct error *error);
/* The image over the input, without its alpha if that is opacity. Not for INPUT_OPACITY. */
bool material_cover(struct material *material, enum material_input input, const struct texture_image *image,
                    struct arena *arena, struct error *error);
/* Holes where the image is black, or by its alpha (ALPHA_ONLY); cutoff > 0: all or nothing, from there on. */
bool material_cut(struct material *material, const struct texture_image *image, double cutoff, struct arena *arena,
                  struct error *error);
/* The same by the alpha of an image with `cuts`, as it is; nothing for others. */
bool material_cut_by_alpha(struct material *material, const struct texture_image *image, struct arena *arena,
                           struct error *error);
/* `bump` over the existing bumps; its `below` is set. */
bool material_add_bump(struct material *material, const struct bump *bump, struct arena *arena, struct error *error);
/* The share `metalness` of kd becomes the colour of highlight and mirror and replaces that share of ks. */
bool material_mix_metal(struct material *material, const struct texture *metalness, struct arena *arena,
                        struct error *error);

#endif
