/* Evaluating a chain of decorators from the base outwards: each link changes what the links below left. Patterns use
 * the point in the object space of the operand that made the surface, so they stick to the object. */
#include "look/material.h"

#include "math/elementary.h"
#include "math/noise.h"

static const double pi = 3.14159265358979323846;

static struct vec3 mix_colours(double ratio, struct vec3 kd, struct vec3 mix) {
    return vec3_add(vec3_scale(kd, ratio), vec3_scale(mix, 1 - ratio));
}

/* A place on an image with the size of the footprint there, in units of the whole image. */
struct image_place {
    double u, v, width_u, width_v;
    enum image_wrap wrap_u, wrap_v;
};

/* u grows with the angle about y, v from the north pole down (SPEC 1.2, and 2.1 for the classic variant). */
static struct image_place place_on_sphere(const struct hit *hit, bool classic) {
    struct vec3 from_centre = hit->on_sphere ? hit->pattern_normal : hit->pattern_point;
    struct vec3 p = vec3_normalize(from_centre);
    double y = p.y < -1 ? -1 : p.y > 1 ? 1 : p.y;
    struct image_place place = {.wrap_u = IMAGE_REPEAT, .wrap_v = IMAGE_CLAMP};
    if (classic) {
        place.u = 0.5 + el_atan2(p.z, p.x) / (2 * pi);
        place.v = 0.5 - el_asin(y) / pi;
    } else {
        place.u = (el_atan2(-p.z, -p.x) + pi) / (2 * pi);
        place.v = el_acos(y) / pi;
    }
    double radius = hit->on_sphere ? vec3_length(from_centre) : vec3_length(hit->pattern_point);
    double width = radius > 0 ? hit->footprint * hit->pattern_scale / radius : 0;
    double ring = sqrt(1 - y * y);
    place.width_v = width / pi;
    place.width_u = width < 2 * pi * ring ? width / (2 * pi * ring) : width > 0 ? 1 : 0;
    return place;
}

/* The sides stand upright and alike; front, top and bottom meet at the edges (SPEC 1.2). A box brings these parameters
 * itself; other shapes are seen from the direction of their normal. */
static struct image_place place_on_cube(const struct hit *hit) {
    struct vec3 p = hit->pattern_point, n = hit->pattern_normal;
    double width = hit->footprint * hit->pattern_scale;
    struct image_place place = {.wrap_u = IMAGE_CLAMP, .wrap_v = IMAGE_CLAMP, .width_u = width, .width_v = width};
    if (hit->on_box && hit->has_uv) {
        double du = vec3_length(hit->dpdu), dv = vec3_length(hit->dpdv);
        place.u = hit->u;
        place.v = hit->v;
        place.width_u = du > 0 ? hit->footprint / du : 0;
        place.width_v = dv > 0 ? hit->footprint / dv : 0;
        return place;
    }
    double x = fabs(n.x), y = fabs(n.y), z = fabs(n.z);
    if (z >= x && z >= y) {
        place.u = n.z > 0 ? p.x : 1 - p.x;
        place.v = 1 - p.y;
    } else if (x >= y) {
        place.u = n.x > 0 ? 1 - p.z : p.z;
        place.v = 1 - p.y;
    } else {
        place.u = p.x;
        place.v = n.y > 0 ? p.z : 1 - p.z;
    }
    return place;
}

static struct image_place place_by_uv(const struct hit *hit, const struct material *material) {
    double du = vec3_length(hit->dpdu), dv = vec3_length(hit->dpdv), u = hit->u, v = hit->v;
    enum image_wrap wrap_u = material->image.wrap, wrap_v = wrap_u;
    if (material->image.apart) {
        const double *scale = material->image.scale, *offset = material->image.offset;
        u = scale[0] * u + offset[0];
        v = scale[1] * v + offset[1];
        du = scale[0] != 0 ? du / fabs(scale[0]) : 0;
        dv = scale[1] != 0 ? dv / fabs(scale[1]) : 0;
        wrap_v = material->image.wrap_v;
    }
    /* vt counts v from the bottom of the image (OBJ), image rows from the top. */
    return (struct image_place){.u = u,
                                .v = 1 - v,
                                .width_u = du > 0 ? hit->footprint / du : 0,
                                .width_v = dv > 0 ? hit->footprint / dv : 0,
                                .wrap_u = wrap_u,
                                .wrap_v = wrap_v};
}

static void image_over(const struct material *material, const struct hit *hit, struct surface_look *look) {
    struct image_place place = {0};
    switch (material->image.mapping) {
    case MAPPING_SPHERE:
        place = place_on_sphere(hit, false);
        break;
    case MAPPING_SPHERE_CLASSIC:
        place = place_on_sphere(hit, true);
        break;
    case MAPPING_CUBE:
        place = place_on_cube(hit);
        break;
    case MAPPING_UV:
        if (!hit->has_uv && !hit->on_sphere)
            return;
        place = hit->on_sphere ? place_on_sphere(hit, true) : place_by_uv(hit, material);
        break;
    }
    if (material->image.flip_u)
        place.u = 1 - place.u;
    struct rgba texel = image_lookup(material->image.image, place.u, place.v, place.width_u, place.width_v,
                                     material->image.filter, place.wrap_u, place.wrap_v);
    struct vec3 colour = vec3_make(texel.r, texel.g, texel.b);
    if (material->image.apart)
        colour = vec3_mul(colour, material->image.tint);
    look->kd = vec3_add(colour, vec3_scale(look->kd, 1 - texel.a));
}

/* One link of the chain over what the links below left. */
static void material_link(const struct material *material, const struct hit *hit, struct surface_look *look) {
    struct vec3 p = hit->pattern_point;
    switch (material->kind) {
    case MATERIAL_PHONG:
        *look = (struct surface_look){.kd = material->phong.kd,
                                      .ks = material->phong.ks,
                                      .shininess = material->phong.shininess,
                                      .reflect = material->phong.reflect,
                                      .refract = material->phong.refract,
                                      .ior = material->phong.ior,
                                      .has_ior = material->phong.has_ior,
                                      .two_sided = material->phong.two_sided,
                                      .unlit = material->phong.unlit,
                                      .highlight = material->phong.highlight,
                                      .emission = material->phong.emission,
                                      .absorption = material->phong.absorption,
                                      .roughness = material->phong.roughness,
                                      .glossy_samples = material->phong.glossy_samples};
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
    case MATERIAL_FRESNEL:
        look->fresnel = true;
        break;
    }
}

void material_look(const struct material *material, const struct hit *hit, struct surface_look *out) {
    const struct material *chain[MATERIAL_DEPTH];
    int depth = 0;
    for (const struct material *link = material; link && depth < MATERIAL_DEPTH; link = link->base)
        chain[depth++] = link;
    while (depth > 0)
        material_link(chain[--depth], hit, out);
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

bool material_has_ior(const struct material *material) {
    const struct material *link = material;
    while (link->base)
        link = link->base;
    return link->kind == MATERIAL_PHONG && link->phong.has_ior;
}
