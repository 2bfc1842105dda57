/* Evaluating a chain of decorators from the base outwards: each link changes what the links below left. Patterns use
 * the point in the object space of the operand that made the surface, so they stick to the object. */
#include "material/material.h"

#include "material/image_place.h"
#include "material/relief.h"
#include "math/noise.h"

static struct vec3 mix_colours(double ratio, struct vec3 kd, struct vec3 mix) {
    return vec3_add(vec3_scale(kd, ratio), vec3_scale(mix, 1 - ratio));
}

static void image_over(const struct material *material, const struct hit *hit, struct surface_look *look) {
    struct image_place place;
    if (!image_place(material, hit, &place))
        return;
    struct rgba texel = image_at(material, &place);
    bool opaque = material->image.without_alpha && texel.a > 0;
    double share = opaque ? 1 / texel.a : 1;
    struct vec3 colour = vec3_scale(vec3_make(texel.r, texel.g, texel.b), share);
    if (material->image.apart)
        colour = vec3_mul(colour, material->image.tint);
    double rest = opaque ? 0 : 1 - texel.a, cover;
    switch (material->image.target) {
    case IMAGE_TO_KD:
        look->kd = vec3_add(colour, vec3_scale(look->kd, rest));
        return;
    case IMAGE_TO_KS:
        look->ks = vec3_add(colour, vec3_scale(look->ks, rest));
        return;
    case IMAGE_TO_EMISSION:
        look->emission = vec3_add(colour, vec3_scale(look->emission, rest));
        return;
    case IMAGE_TO_OPACITY:
        cover = material->image.by_alpha ? texel.a : (colour.x + colour.y + colour.z) / 3;
        if (material->image.cutoff > 0)
            cover = cover >= material->image.cutoff ? 1 : 0;
        look->opacity *= cover > 1 ? 1 : cover;
        return;
    }
}

/* Metallic and roughness by a picture, after glTF 2.0: blue times metallic, green times roughness; the colour below is
 * that of both kinds of surface. The formulas of formats/gltf_look.c, point by point. */
static void metal_over(const struct material *material, const struct hit *hit, struct surface_look *look) {
    struct image_place place;
    double metal = material->image.metallic, rough = material->image.roughness;
    if (material->image.image && image_place(material, hit, &place)) {
        struct rgba texel = image_at(material, &place);
        double share = texel.a > 0 ? 1 / texel.a : 0;
        metal *= texel.b * share;
        rough *= texel.g * share;
    }
    struct vec3 colour = look->kd;
    double r4 = rough * rough * rough * rough, n = 2 / fmax(r4, 1e-3) - 2;
    look->kd = vec3_scale(colour, 1 - metal);
    if (look->refract > 0) /* what shines through has the filter in ks */
        return;
    look->ks = vec3_add(vec3_all(material->image.f0 * (1 - metal)), vec3_scale(colour, metal));
    look->shininess = n < 1 ? 1 : n > 2000 ? 2000 : n;
    look->reflect = metal * (1 - rough) * (1 - rough);
}

/* One link of the chain over what the links below left. */
static void material_link(const struct material *material, const struct hit *hit, struct surface_look *look) {
    struct vec3 p = hit->pattern_point;
    switch (material->kind) {
    case MATERIAL_PHONG:
        look->kd = material->phong.kd;
        look->ks = material->phong.ks;
        look->shininess = material->phong.shininess;
        look->reflect = material->phong.reflect;
        look->refract = material->phong.refract;
        look->ior = material->phong.ior;
        look->has_ior = material->phong.has_ior;
        look->two_sided = material->phong.two_sided;
        look->unlit = material->phong.unlit;
        look->normal = hit->normal;
        look->opacity = 1;
        look->highlight = material->phong.highlight;
        look->emission = material->phong.emission;
        look->absorption = material->phong.absorption;
        look->roughness = material->phong.roughness;
        look->glossy_samples = material->phong.glossy_samples;
        look->fresnel = false;
        if (material->phong.by_vertex && hit->has_colour)
            look->kd = vec3_mul(look->kd, hit->colour);
        break;
    case MATERIAL_MARBLE: {
        double ratio = noise_marble(p.x, p.y, p.z, material->marble.f, material->marble.multiplier,
                                    material->marble.vein_frequency, material->marble.interpolation);
        look->kd = mix_colours(ratio, look->kd, material->marble.mix);
        break;
    }
    case MATERIAL_WOOD: {
        double ratio =
            noise_wood(p.x, p.y, p.z, material->wood.f, material->wood.density, material->wood.interpolation);
        look->kd = mix_colours(ratio, look->kd, material->wood.mix);
        break;
    }
    case MATERIAL_IMAGE:
        image_over(material, hit, look);
        break;
    case MATERIAL_BUMP:
        relief_bump(material, hit, look);
        break;
    case MATERIAL_NORMAL:
        relief_normal(material, hit, look);
        break;
    case MATERIAL_METAL:
        metal_over(material, hit, look);
        break;
    case MATERIAL_FRESNEL:
        look->fresnel = true;
        break;
    }
}

void material_look(const struct material *material, const struct hit *hit, struct surface_look *out) {
    material_look_told(material, hit, out, NULL, NULL);
}

void material_look_told(const struct material *material, const struct hit *hit, struct surface_look *out,
                        material_told *told, void *context) {
    const struct material *chain[MATERIAL_DEPTH];
    int depth = 0;
    for (const struct material *link = material; link && depth < MATERIAL_DEPTH; link = link->base)
        chain[depth++] = link;
    while (depth > 0) {
        material_link(chain[--depth], hit, out);
        if (told)
            told(context, chain[depth], out);
    }
}

bool material_has_relief(const struct material *material) {
    for (const struct material *link = material; link; link = link->base)
        if (link->kind == MATERIAL_BUMP || link->kind == MATERIAL_NORMAL)
            return true;
    return false;
}

bool material_has_holes(const struct material *material) {
    for (const struct material *link = material; link; link = link->base)
        if (link->kind == MATERIAL_IMAGE && link->image.target == IMAGE_TO_OPACITY)
            return true;
    return false;
}

bool material_has_image(const struct material *material) {
    for (const struct material *link = material; link; link = link->base)
        if (link->kind == MATERIAL_IMAGE || link->kind == MATERIAL_METAL)
            return true;
    return material_has_relief(material);
}

void material_shading(const struct surface_look *look, enum specular_kind specular, bool ambient_plain,
                      struct shading *out) {
    out->count = 0;
    out->emission = look->emission;
    /* The square spreads the useful values over 0..1 (Burley, "Physically-Based Shading at Disney", 2012). */
    out->alpha = look->roughness * look->roughness;
    bool blinn = look->highlight == HIGHLIGHT_AS_SET ? specular == SPECULAR_BLINN : look->highlight == HIGHLIGHT_BLINN;
    if (look->unlit) {
        out->emission = vec3_add(out->emission, look->kd);
        out->ambient = vec3_all(0);
    } else {
        out->ambient = ambient_plain ? vec3_all(1) : look->kd;
        out->lobes[out->count++] = (struct lobe){.kind = LOBE_DIFFUSE, .weight = look->kd};
        out->lobes[out->count++] = (struct lobe){.kind = blinn ? LOBE_BLINN : LOBE_PHONG,
                                                 .weight = vec3_scale(look->ks, 1 - look->refract),
                                                 .exponent = look->shininess};
    }
    if (look->reflect != 0)
        out->lobes[out->count++] = (struct lobe){.kind = LOBE_MIRROR, .weight = vec3_scale(look->ks, look->reflect)};
    if (look->refract != 0)
        out->lobes[out->count++] = (struct lobe){.kind = LOBE_REFRACT, .weight = vec3_scale(look->ks, look->refract)};
}

bool material_is_transparent(const struct material *material, double *ior) {
    bool fresnel = false;
    const struct material *link = material;
    for (; link->base; link = link->base)
        fresnel = fresnel || link->kind == MATERIAL_FRESNEL;
    if (link->kind != MATERIAL_PHONG || !link->phong.has_ior)
        return false;
    *ior = link->phong.ior;
    return fresnel || link->phong.refract > 0;
}

struct vec3 material_absorption(const struct material *material) {
    const struct material *link = material;
    while (link->base)
        link = link->base;
    return link->kind == MATERIAL_PHONG ? link->phong.absorption : vec3_all(0);
}

struct vec3 material_emission(const struct material *material) {
    const struct material *link = material;
    while (link->base)
        link = link->base;
    return link->kind == MATERIAL_PHONG ? link->phong.emission : vec3_all(0);
}

bool material_has_ior(const struct material *material) {
    const struct material *link = material;
    while (link->base)
        link = link->base;
    return link->kind == MATERIAL_PHONG && link->phong.has_ior;
}

double material_specular(const struct material *material) {
    bool fresnel = false, filtered = false;
    double metal = 0;
    const struct material *link = material;
    for (; link->base; link = link->base) {
        fresnel = fresnel || link->kind == MATERIAL_FRESNEL;
        filtered = filtered || (link->kind == MATERIAL_IMAGE && link->image.target == IMAGE_TO_KS);
        if (link->kind == MATERIAL_METAL) /* what a picture makes of it is not known here */
            metal = link->image.image ? 1 : link->image.metallic * (1 - link->image.roughness);
    }
    if (link->kind != MATERIAL_PHONG)
        return 0;
    double amount = fresnel ? 1 : link->phong.reflect + link->phong.refract;
    double own = amount > 0 ? amount * (filtered ? 1 : vec3_max_abs(link->phong.ks)) : 0;
    return own > metal ? own : metal;
}
