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
        memcpy(rest, error->text + length, sizeof rest - length);
        error_set(error, error->kind, "%s%s", path, rest);
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

static struct material *image_material(struct context *context, const struct value *value, const struct value *filter,
                                       const struct value *flip_u, const struct material *base, struct error *error) {
    struct image *image = act_find_image(context, value, error);
    struct material *m = image ? scene_material(&context->scene, MATERIAL_IMAGE, base, error) : NULL;
    if (!m)
        return NULL;
    act_image_defaults(m, value, image);
    if (filter->given)
        m->image.filter = (enum image_filter)filter->choice;
    if (flip_u->given)
        m->image.flip_u = flip_u->boolean;
    return m;
}

static bool td_material(struct context *context, const struct value *args, enum image_mapping mapping,
                        struct result *result, struct error *error) {
    struct material *m = image_material(context, &args[IMAGE_PNG], &args[IMAGE_FILTER], &args[IMAGE_FLIP_U],
                                        args[IMAGE_MATERIAL].material, error);
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
    struct material *m =
        image_material(context, &args[TEXTURE_FILE], &args[TEXTURE_FILTER], &args[TEXTURE_FLIP_U], NULL, error);
    if (m) {
        m->image.mapping = MAPPING_UV;
        if (args[TEXTURE_WRAP].given)
            m->image.wrap = (enum image_wrap)args[TEXTURE_WRAP].choice;
    }
    return give(result, m);
}
