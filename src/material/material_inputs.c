/* A decorator of the language is one function here: it replaces an input by a texture that contains the previous
 * texture. So a chain of decorators becomes one tree for each input, and only inputs with textures take time at a hit.
 * The language and the readers of files build their materials by these functions. */
#include "material/material_inputs.h"

void material_derive(struct material *material, enum material_kind kind, const struct material *base) {
    *material = base ? *base : (struct material){0};
    material->kind = kind;
    material->base = base;
    material->origin = base && base->origin ? base->origin : base;
    material->depth = base ? base->depth + 1 : 1;
    material->serial = 0;
    material->older = NULL;
    material->name = NULL;
    material->fresnel = material->fresnel || kind == MATERIAL_FRESNEL;
}

/* The texture of an input; where it is a number, the texture of that number. */
static const struct texture *material_input(const struct material *material, enum material_input input) {
    return material->inputs[input] ? material->inputs[input] : texture_parameter(input);
}

static bool put(struct material *material, enum material_input input, struct texture texture, struct arena *arena,
                struct error *error) {
    const struct texture *kept = texture_keep(arena, texture, error);
    if (!kept)
        return false;
    material->inputs[input] = kept;
    return true;
}

bool material_multiply(struct material *material, enum material_input input, const struct texture *by,
                       struct arena *arena, struct error *error) {
    return put(material, input, texture_multiply(material_input(material, input), by), arena, error);
}

bool material_multiply_constant(struct material *material, enum material_input input, struct texture constant,
                                struct arena *arena, struct error *error) {
    const struct texture *factor = texture_keep(arena, constant, error);
    return factor && material_multiply(material, input, factor, arena, error);
}

bool material_mix_kd(struct material *material, struct texture pattern, struct texture mix, struct arena *arena,
                     struct error *error) {
    const struct texture *ratio = texture_keep(arena, pattern, error);
    const struct texture *other = ratio ? texture_keep(arena, mix, error) : NULL;
    return other &&
           put(material, INPUT_KD, texture_mix(material_input(material, INPUT_KD), other, ratio), arena, error);
}

bool material_cover(struct material *material, enum material_input input, const struct texture_image *image,
                    struct arena *arena, struct error *error) {
    struct texture_image own = *image;
    own.alpha = image->cuts ? ALPHA_STRAIGHT : image->alpha;
    material->changed = input;
    return put(material, input, texture_image(&own, material_input(material, input)), arena, error);
}

bool material_cut(struct material *material, const struct texture_image *image, double cutoff, struct arena *arena,
                  struct error *error) {
    struct texture_image own = *image;
    own.alpha = image->alpha == ALPHA_ONLY ? ALPHA_ONLY : ALPHA_DARKENS;
    material->changed = INPUT_OPACITY;
    /* Opaque if the surface has no coordinates for the image. */
    const struct texture *whole = texture_keep(arena, texture_number(1), error);
    const struct texture *picture = whole ? texture_keep(arena, texture_image(&own, whole), error) : NULL;
    if (!picture)
        return false;
    enum texture_function function = cutoff > 0 ? FUNCTION_STEP : FUNCTION_SATURATE;
    const struct texture *cover = texture_keep(arena, texture_map(picture, function, cutoff), error);
    return cover && material_multiply(material, INPUT_OPACITY, cover, arena, error);
}

bool material_cut_by_alpha(struct material *material, const struct texture_image *image, struct arena *arena,
                           struct error *error) {
    enum material_input changed = material->changed;
    struct texture_image own = *image;
    own.alpha = ALPHA_ONLY;
    if (image->cuts && !material_cut(material, &own, 0, arena, error))
        return false;
    material->changed = changed;
    return true;
}

bool material_add_bump(struct material *material, const struct bump *bump, struct arena *arena, struct error *error) {
    struct bump *own = arena_alloc(arena, sizeof *own);
    if (!own)
        return error_no_memory(error, "a bump map");
    *own = *bump;
    own->below = material->bump;
    material->bump = own;
    return true;
}

static const struct texture *keep_shared(struct arena *arena, struct texture value, struct error *error) {
    value.shared = true;
    return texture_keep(arena, value, error);
}

/* kd * (1 - metalness). */
static bool put_rest_of_metal(struct material *material, const struct texture *colour, const struct texture *metalness,
                              struct arena *arena, struct error *error) {
    const struct texture *rest = texture_keep(arena, texture_map(metalness, FUNCTION_COMPLEMENT, 0), error);
    return rest && put(material, INPUT_KD, texture_multiply(colour, rest), arena, error);
}

bool material_mix_metal(struct material *material, const struct texture *metalness, struct arena *arena,
                        struct error *error) {
    const struct texture *colour = keep_shared(arena, *material_input(material, INPUT_KD), error);
    const struct texture *share = keep_shared(arena, *metalness, error);
    return colour && share && put_rest_of_metal(material, colour, share, arena, error) &&
           put(material, INPUT_KS, texture_mix(colour, material_input(material, INPUT_KS), share), arena, error);
}
