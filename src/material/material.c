/* Chains of materials. */
#include "material/material.h"

const struct material *material_origin(const struct material *material) {
    return material->origin ? material->origin : material;
}

const char *material_step_name(const struct material *link) {
#define IMAGE_ON(input, word, is_colour) [input] = "image on " word,
    static const char *const kinds[] = {MATERIAL_KINDS(LIST_WORD)}, *const images[] = {MATERIAL_INPUTS(IMAGE_ON)};
#undef IMAGE_ON
    return link->kind == MATERIAL_IMAGE && link->changed != INPUT_KD ? images[link->changed] : kinds[link->kind];
}

bool material_has_image(const struct material *material) {
    for (int i = 0; i < INPUT_COUNT; i++)
        if (material->inputs[i] && material->inputs[i]->has_image)
            return true;
    return material->bump != NULL;
}

static struct colour emission_of(const struct material *material, enum texture_estimate which) {
    const struct phong *numbers = &material_origin(material)->phong;
    const struct texture *texture = material->inputs[INPUT_EMISSION];
    return texture ? texture_estimate(texture, numbers, which) : numbers->emission;
}

struct colour material_emission(const struct material *material) {
    return emission_of(material, TEXTURE_AVERAGE);
}

struct colour material_emission_bound(const struct material *material) {
    return emission_of(material, TEXTURE_LARGEST);
}

bool material_has_ior(const struct material *material) {
    return material_origin(material)->phong.has_ior;
}
