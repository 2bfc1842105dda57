/* Materials, their decorators, and textures. */
#include "script/actions.h"
#include "script/context.h"

#include "base/file.h"

#include <string.h>

static bool give(struct result *result, struct material *material) {
    result->pointer = material;
    return material != NULL;
}

static struct material *phong(struct context *context, const struct value *args, struct error *error) {
    struct material *m = scene_material(&context->scene, MATERIAL_PHONG, NULL, error);
    if (!m)
        return NULL;
    m->phong.kd = args[PHONG_KD].vector;
    m->phong.ks = args[PHONG_KS].vector;
    m->phong.shininess = args[PHONG_SHININESS].given ? args[PHONG_SHININESS].number : 1;
    m->phong.reflect = args[PHONG_REFLECT].number;
    m->phong.refract = args[PHONG_REFRACT].number;
    m->phong.has_ior = args[PHONG_IOR].given;
    m->phong.ior = args[PHONG_IOR].given ? args[PHONG_IOR].number : 1;
    m->phong.two_sided = args[PHONG_TWO_SIDED].boolean;
    if (args[PHONG_HIGHLIGHT].given)
        m->phong.highlight = args[PHONG_HIGHLIGHT].choice == 0 ? HIGHLIGHT_PHONG : HIGHLIGHT_BLINN;
    m->phong.unlit = args[PHONG_LIT].given && !args[PHONG_LIT].boolean;
    m->phong.emission = args[PHONG_EMISSION].vector;
    m->phong.absorption = args[PHONG_ABSORPTION].vector;
    m->phong.roughness = args[PHONG_ROUGHNESS].number;
    m->phong.glossy_samples = (int)args[PHONG_GLOSSY_SAMPLES].number;
    return m;
}

bool act_material(struct context *context, const struct value *args, struct result *result, struct error *error) {
    if (args[PHONG_REFRACT].number > 0 && !args[PHONG_IOR].given)
        return error_set(error, ERROR_SCENE, "ior is missing: light that is refracted needs an index of refraction");
    return give(result, phong(context, args, error));
}

bool act_rr_material(struct context *context, const struct value *args, struct result *result, struct error *error) {
    struct material *m = phong(context, args, error);
    if (m)
        m->phong.has_ior = true;
    return give(result, m);
}

bool act_marble(struct context *context, const struct value *args, struct result *result, struct error *error) {
    struct material *m = scene_material(&context->scene, MATERIAL_MARBLE, args[MARBLE_MATERIAL].material, error);
    if (m) {
        m->marble.f = args[MARBLE_F].number;
        m->marble.multiplier = args[MARBLE_MULTIPLIER].number;
        m->marble.vein_frequency = args[MARBLE_VEIN].number;
        m->marble.interpolation = (int)args[MARBLE_INTERP].number;
        m->marble.mix = args[MARBLE_MIX].vector;
    }
    return give(result, m);
}

bool act_wood(struct context *context, const struct value *args, struct result *result, struct error *error) {
    struct material *m = scene_material(&context->scene, MATERIAL_WOOD, args[WOOD_MATERIAL].material, error);
    if (m) {
        m->wood.f = args[WOOD_F].number;
        m->wood.density = args[WOOD_DENSITY].number;
        m->wood.interpolation = (int)args[WOOD_INTERP].number;
        m->wood.mix = args[WOOD_MIX].vector;
    }
    return give(result, m);
}

bool act_fresnel(struct context *context, const struct value *args, struct result *result, struct error *error) {
    if (!material_has_ior(args[FRESNEL_MATERIAL].material))
        return error_set(error, ERROR_SCENE, "material has no index of refraction; give it one with gr.rr_material");
    return give(result, scene_material(&context->scene, MATERIAL_FRESNEL, args[FRESNEL_MATERIAL].material, error));
}

struct image *act_find_image(struct context *context, const struct value *value, struct error *error) {
    if (value->image)
        return value->image;
    char path[PATH_SIZE], canonical[PATH_SIZE];
    if (!files_require(context, value->text, path, error))
        return NULL;
    if (!file_canonical(path, canonical, sizeof canonical))
        memcpy(canonical, path, sizeof canonical);
    struct image *image = assets_image(context->scene.assets, canonical, error);
    size_t length = strlen(canonical);
    if (!image && strncmp(error->text, canonical, length) == 0) { /* tell the path as the scene knows it */
        char rest[sizeof error->text];
        bool limit = error->limit;
        memcpy(rest, error->text + length, sizeof rest - length);
        error_set(error, error->kind, "%s%s", path, rest);
        error->limit = limit;
    }
    return image;
}

void act_image_defaults(struct material *material, const struct value *value, struct image *image) {
    if (value->material)
        material->image = value->material->image;
    else
        material->image.filter = IMAGE_MIPMAP, material->image.wrap = IMAGE_REPEAT;
    material->image.image = image;
}

/* A picture over `base`; `lookup` are the fields counted from LOOKUP_FILTER. */
static struct material *image_over(struct context *context, enum material_kind kind, const struct value *image_value,
                                   const struct value *lookup, const struct material *base, struct error *error) {
    struct image *image = act_find_image(context, image_value, error);
    struct material *m = image ? scene_material(&context->scene, kind, base, error) : NULL;
    if (!m)
        return NULL;
    act_image_defaults(m, image_value, image);
    m->image.mapping = MAPPING_BY_SHAPE;
    if (lookup[LOOKUP_FILTER].given)
        m->image.filter = (enum image_filter)lookup[LOOKUP_FILTER].choice;
    if (lookup[LOOKUP_WRAP].given)
        m->image.wrap = m->image.wrap_v = (enum image_wrap)lookup[LOOKUP_WRAP].choice;
    if (lookup[LOOKUP_FLIP_U].given)
        m->image.flip_u = lookup[LOOKUP_FLIP_U].boolean;
    const struct value *tiles = &lookup[LOOKUP_TILES], *offset = &lookup[LOOKUP_OFFSET];
    if ((tiles->given || offset->given) && !m->image.apart) {
        m->image.apart = true;
        m->image.scale[0] = m->image.scale[1] = 1;
        m->image.tint = vec3_all(1);
        m->image.wrap_v = m->image.wrap;
    }
    if (tiles->given)
        m->image.scale[0] = tiles->vector.x, m->image.scale[1] = tiles->vector.y;
    if (offset->given)
        m->image.offset[0] = offset->vector.x, m->image.offset[1] = offset->vector.y;
    return m;
}

static bool td_material(struct context *context, const struct value *args, enum image_mapping mapping,
                        struct result *result, struct error *error) {
    struct value lookup[LOOKUP_COUNT] = {[LOOKUP_FILTER] = args[IMAGE_FILTER], [LOOKUP_FLIP_U] = args[IMAGE_FLIP_U]};
    struct material *m =
        image_over(context, MATERIAL_IMAGE, &args[IMAGE_PNG], lookup, args[IMAGE_MATERIAL].material, error);
    if (m)
        m->image.mapping = mapping;
    return give(result, m);
}

bool act_td_cube(struct context *context, const struct value *args, struct result *result, struct error *error) {
    return td_material(context, args, MAPPING_CUBE, result, error);
}

bool act_td_sphere(struct context *context, const struct value *args, struct result *result, struct error *error) {
    return td_material(context, args, MAPPING_SPHERE, result, error);
}

/* A texture is an image material without a base; node:set_texture copies it. */
bool act_texture(struct context *context, const struct value *args, struct result *result, struct error *error) {
    return give(result, image_over(context, MATERIAL_IMAGE, &args[TEXTURE_FILE], &args[TEXTURE_LOOKUP], NULL, error));
}

bool act_image_material(struct context *context, const struct value *args, struct result *result, struct error *error) {
    static const enum image_target targets[] = {IMAGE_TO_KD, IMAGE_TO_KS, IMAGE_TO_EMISSION, IMAGE_TO_OPACITY};
    struct material *m =
        image_over(context, MATERIAL_IMAGE, &args[OVER_IMAGE], &args[OVER_LOOKUP], args[OVER_MATERIAL].material, error);
    if (m)
        m->image.target = targets[args[OVER_CHANNEL].choice];
    return give(result, m);
}

/* The amount and the kind are args[0] and args[1]. A bump map keeps what its template says. m itself, or NULL. */
static struct material *set_relief(struct material *m, const struct value *template, const struct value *args) {
    const struct material *from = template->material;
    bool known = from && (from->kind == MATERIAL_BUMP || from->kind == MATERIAL_NORMAL);
    if (!m)
        return NULL;
    if (args[1].given)
        m->kind = args[1].choice == 0 ? MATERIAL_BUMP : MATERIAL_NORMAL;
    else if (known)
        m->kind = from->kind;
    if (args[0].given) {
        m->image.height = args[0].number;
        m->image.relative = false;
    } else if (!known || from->kind != m->kind) {
        m->image.relative = m->kind == MATERIAL_BUMP;
        m->image.height = m->kind == MATERIAL_BUMP ? RELIEF_HEIGHT : 1;
    }
    return m;
}

bool act_bump(struct context *context, const struct value *args, struct result *result, struct error *error) {
    struct material *m = image_over(context, MATERIAL_BUMP, &args[RELIEF_FILE], &args[RELIEF_LOOKUP], NULL, error);
    return give(result, set_relief(m, &args[RELIEF_FILE], &args[RELIEF_AMOUNT]));
}

bool act_bump_material(struct context *context, const struct value *args, struct result *result, struct error *error) {
    struct material *m =
        image_over(context, MATERIAL_BUMP, &args[OVER_IMAGE], &args[OVER_LOOKUP], args[OVER_MATERIAL].material, error);
    return give(result, set_relief(m, &args[OVER_IMAGE], &args[RELIEF_OVER_AMOUNT]));
}

struct material *act_relief(struct context *context, const struct value *value, struct error *error) {
    static const struct value nothing[LOOKUP_COUNT];
    struct material *m = image_over(context, MATERIAL_BUMP, value, nothing, NULL, error);
    return set_relief(m, value, nothing);
}
