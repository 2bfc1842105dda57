/* Materials, their decorators, and textures. */
#include "compat/lenient.h"
#include "compat/lenient_picture.h"
#include "script/bindings_internal.h"
#include "script/gr_textures_internal.h"

#include "base/file.h"
#include "material/bump.h"
#include "material/material_inputs.h"

#include <math.h>
#include <string.h>

static bool give(struct script_result *result, struct material *material) {
    result->pointer = material;
    return material != NULL;
}

static const struct texture *number_or_texture(struct script_context *context, const struct script_value *value,
                                               struct error *error) {
    struct script_value own = *value;
    own.vector = vec3_all(value->number);
    return gr_texture_of(context, &own, error);
}

/* The inputs with textures: the texture times the number, which is 1. */
static bool with_textures(struct script_context *context, struct material *m, const struct script_value *args,
                          struct error *error) {
    static const struct {
        int field;
        enum material_input input;
        bool is_share; /* between 0 and 1 for every value of the texture */
    } inputs[] = {{PHONG_KD, INPUT_KD, false},
                  {PHONG_KS, INPUT_KS, false},
                  {PHONG_SHININESS, INPUT_SHININESS, false},
                  {PHONG_REFLECT, INPUT_REFLECT, true},
                  {PHONG_REFRACT, INPUT_REFRACT, true},
                  {PHONG_ROUGHNESS, INPUT_ROUGHNESS, true},
                  {PHONG_EMISSION, INPUT_EMISSION, false},
                  {PHONG_OPACITY, INPUT_OPACITY, true}};
    struct arena *arena = &context->scene.arena;
    for (size_t i = 0; i < sizeof inputs / sizeof inputs[0]; i++) {
        const struct script_value *value = &args[inputs[i].field];
        bool is_hole = inputs[i].input == INPUT_OPACITY && value->given && value->number < 1;
        if (!value->texture && !is_hole)
            continue;
        const struct texture *texture = number_or_texture(context, value, error);
        if (texture && inputs[i].is_share)
            texture = texture_keep(arena, texture_map(texture, FUNCTION_SATURATE, 0), error);
        if (!texture || !material_multiply(m, inputs[i].input, texture, arena, error))
            return false;
    }
    const struct script_value *metalness = &args[PHONG_METALNESS];
    if (metalness->texture || metalness->number > 0) {
        const struct texture *texture = number_or_texture(context, metalness, error);
        texture = texture ? texture_keep(arena, texture_map(texture, FUNCTION_SATURATE, 0), error) : NULL;
        if (!texture || !material_mix_metal(m, texture, arena, error))
            return false;
    }
    if (!args[PHONG_BUMP].given)
        return true;
    const struct bump *bump = read_bump_values(context, &args[PHONG_BUMP], error);
    return bump && material_add_bump(m, bump, arena, error);
}

static struct material *phong(struct script_context *context, const struct script_value *args, struct error *error) {
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
    static const enum material_highlight highlights[] = {HIGHLIGHTS(LIST_MEMBER)};
    if (args[PHONG_HIGHLIGHT].given)
        m->phong.highlight = highlights[args[PHONG_HIGHLIGHT].choice];
    m->phong.unlit = args[PHONG_LIT].given && !args[PHONG_LIT].boolean;
    m->phong.emission = args[PHONG_EMISSION].vector;
    m->phong.absorption = args[PHONG_ABSORPTION].vector;
    m->phong.roughness = args[PHONG_ROUGHNESS].number;
    m->phong.glossy_samples = (int)args[PHONG_GLOSSY_SAMPLES].number;
    return with_textures(context, m, args, error) ? m : NULL;
}

bool gr_material(struct script_context *context, const struct script_value *args, struct script_result *result,
                 struct error *error) {
    context_warn_of_bytes(context, "kd", args[PHONG_KD].vector);
    context_warn_of_bytes(context, "ks", args[PHONG_KS].vector);
    if (args[PHONG_REFRACT].number > 0 && !args[PHONG_IOR].given)
        return error_set(error, ERROR_SCENE, "ior is missing: refraction needs an index of refraction");
    return give(result, phong(context, args, error));
}

bool gr_rr_material(struct script_context *context, const struct script_value *args, struct script_result *result,
                    struct error *error) {
    struct material *m = phong(context, args, error);
    if (m)
        m->phong.has_ior = true;
    return give(result, m);
}

/* The pattern mixes kd with another colour. */
static bool pattern_over(struct script_context *context, struct material *m, struct texture pattern,
                         const struct script_value *mix, struct script_result *result, struct error *error) {
    struct texture other = mix->display ? texture_display_colour(mix->vector) : texture_constant(mix->vector);
    return m && material_mix_kd(m, pattern, other, &context->scene.arena, error) && give(result, m);
}

bool gr_marble(struct script_context *context, const struct script_value *args, struct script_result *result,
               struct error *error) {
    struct texture pattern = texture_marble(args[MARBLE_F].number, args[MARBLE_MULTIPLIER].number,
                                            args[MARBLE_VEIN].number, (int)args[MARBLE_INTERP].number);
    return pattern_over(context,
                        scene_material(&context->scene, MATERIAL_MARBLE, args[MARBLE_MATERIAL].material, error),
                        pattern, &args[MARBLE_MIX], result, error);
}

bool gr_wood(struct script_context *context, const struct script_value *args, struct script_result *result,
             struct error *error) {
    struct texture pattern =
        texture_wood(args[WOOD_F].number, args[WOOD_DENSITY].number, (int)args[WOOD_INTERP].number);
    return pattern_over(context, scene_material(&context->scene, MATERIAL_WOOD, args[WOOD_MATERIAL].material, error),
                        pattern, &args[WOOD_MIX], result, error);
}

bool gr_fresnel(struct script_context *context, const struct script_value *args, struct script_result *result,
                struct error *error) {
    if (!material_has_ior(args[FRESNEL_MATERIAL].material))
        return error_set(error, ERROR_SCENE, "material has no index of refraction; give it one with gr.rr_material");
    return give(result, scene_material(&context->scene, MATERIAL_FRESNEL, args[FRESNEL_MATERIAL].material, error));
}

static struct image *image_of_file(struct script_context *context, const struct script_value *value,
                                   struct error *error) {
    if (value->image)
        return value->image;
    char path[PATH_SIZE], canonical[PATH_SIZE];
    if (!files_require(&context->sandbox, value->text, path, error))
        return NULL;
    if (!file_canonical(path, canonical, sizeof canonical))
        memcpy(canonical, path, sizeof canonical);
    struct image *image = assets_image(context->scene.assets, canonical, error);
    size_t length = strlen(canonical);
    if (!image && strncmp(error->text, canonical, length) == 0) { /* report the path as the scene wrote it */
        char rest[sizeof error->text];
        bool limit = error->limit;
        memcpy(rest, error->text + length, sizeof rest - length);
        error_set(error, error->kind, "%s%s", path, rest);
        error->limit = limit;
    }
    return image;
}

struct image *gr_find_image(struct script_context *context, const struct script_value *value, struct error *error) {
    struct image *image = image_of_file(context, value, error);
    if (image || !context->lenient || error->kind != ERROR_SCENE || error->limit)
        return image;
    lenient_warn(context, "%s: checks take its place", error->text);
    *error = (struct error){0};
    return lenient_checks(context, error);
}

static void image_defaults(struct texture_image *out, const struct script_value *value, struct image *image) {
    const struct texture_image *from = value->texture ? texture_as_image(value->texture->texture) : NULL;
    *out = from ? *from : (struct texture_image){.filter = IMAGE_MIPMAP, .wrap = IMAGE_REPEAT};
    out->image = image;
}

/* `lookup` points to the fields from LOOKUP_FILTER on. */
static bool read_image(struct script_context *context, const struct script_value *value,
                       const struct script_value *lookup, struct texture_image *out, struct error *error) {
    struct image *image = gr_find_image(context, value, error);
    if (!image)
        return false;
    image_defaults(out, value, image);
    out->mapping = MAPPING_BY_SHAPE;
    if (lookup[LOOKUP_FILTER].given)
        out->filter = (enum image_filter)lookup[LOOKUP_FILTER].choice;
    if (lookup[LOOKUP_WRAP].given)
        out->wrap = out->wrap_v = (enum image_wrap)lookup[LOOKUP_WRAP].choice;
    if (lookup[LOOKUP_FLIP_U].given)
        out->flip_u = lookup[LOOKUP_FLIP_U].boolean;
    if (lookup[LOOKUP_MAPPING].given)
        out->outside = lookup[LOOKUP_MAPPING].choice == SPHERE_MAPPING_OUTSIDE;
    if (lookup[LOOKUP_ENCODING].given) {
        out->encoding = (enum texture_encoding)lookup[LOOKUP_ENCODING].choice;
        out->gamma = lookup[LOOKUP_ENCODING].number;
    }
    const struct script_value *tiles = &lookup[LOOKUP_TILES], *offset = &lookup[LOOKUP_OFFSET];
    if ((tiles->given || offset->given) && !out->apart) {
        out->apart = true;
        out->scale[0] = out->scale[1] = 1;
        out->tint = vec3_all(1);
        out->wrap_v = out->wrap;
    }
    if (tiles->given)
        out->scale[0] = tiles->vector.x, out->scale[1] = tiles->vector.y;
    if (offset->given)
        out->offset[0] = offset->vector.x, out->offset[1] = offset->vector.y;
    return true;
}

/* The image alone, as a texture. NULL with an error: it cannot be read. */
static const struct texture *read_texture(struct script_context *context, const struct script_value *value,
                                          const struct script_value *lookup, struct error *error) {
    struct texture_image image;
    return read_image(context, value, lookup, &image, error)
               ? texture_keep(&context->scene.arena, texture_image(&image, NULL), error)
               : NULL;
}

/* The image as a factor of an input of the material below. */
static bool image_over(struct script_context *context, const struct texture_image *image, enum material_input input,
                       const struct material *base, struct script_result *result, struct error *error) {
    struct arena *arena = &context->scene.arena;
    struct material *m = scene_material(&context->scene, MATERIAL_IMAGE, base, error);
    if (!m)
        return false;
    bool ok = input == INPUT_OPACITY ? material_cut(m, image, 0, arena, error)
                                     : material_cover(m, input, image, arena, error);
    return ok && give(result, m);
}

static bool td_material(struct script_context *context, const struct script_value *args, enum texture_mapping mapping,
                        struct script_result *result, struct error *error) {
    struct script_value lookup[LOOKUP_COUNT] = {[LOOKUP_FILTER] = args[IMAGE_FILTER],
                                                [LOOKUP_FLIP_U] = args[IMAGE_FLIP_U],
                                                [LOOKUP_MAPPING] = args[IMAGE_MAPPING]};
    struct texture_image image;
    if (!read_image(context, &args[IMAGE_PNG], lookup, &image, error))
        return false;
    image.mapping = mapping;
    return image_over(context, &image, INPUT_KD, args[IMAGE_MATERIAL].material, result, error);
}

bool gr_td_cube(struct script_context *context, const struct script_value *args, struct script_result *result,
                struct error *error) {
    return td_material(context, args, MAPPING_CUBE, result, error);
}

bool gr_td_sphere(struct script_context *context, const struct script_value *args, struct script_result *result,
                  struct error *error) {
    return td_material(context, args, MAPPING_SPHERE, result, error);
}

bool gr_image_material(struct script_context *context, const struct script_value *args, struct script_result *result,
                       struct error *error) {
    static const enum material_input channels[] = {IMAGE_CHANNELS(LIST_MEMBER)};
    struct texture_image image;
    return read_image(context, &args[OVER_IMAGE], &args[OVER_LOOKUP], &image, error) &&
           image_over(context, &image, channels[args[OVER_CHANNEL].choice], args[OVER_MATERIAL].material, result,
                      error);
}

/* How an image or another texture is mapped to a surface. The amount and the kind are args[0] and args[1]; a bump map
 * keeps the settings of its template. */
static bool read_bump(struct script_context *context, const struct script_value *value,
                      const struct script_value *lookup, const struct script_value *args, struct bump *out,
                      struct error *error) {
    static const enum material_kind kinds[] = {BUMP_KINDS(LIST_MEMBER)};
    const struct script_texture *from = value->texture;
    bool is_image = !from || texture_as_image(from->texture), known = from && from->is_bump;
    const struct texture *texture = is_image ? read_texture(context, value, lookup, error) : from->texture;
    if (!texture)
        return false;
    *out = bump_make(args[1].given ? kinds[args[1].choice] : known ? from->bump.kind : kinds[0], texture);
    if (args[0].given) {
        out->height = args[0].number;
        out->relative = false;
    } else if (known && from->bump.kind == out->kind) {
        out->height = from->bump.height;
        out->relative = from->bump.relative;
    }
    return true;
}

bool gr_texture(struct script_context *context, const struct script_value *args, struct script_result *result,
                struct error *error) {
    struct script_texture texture = {.texture =
                                         read_texture(context, &args[TEXTURE_FILE], &args[TEXTURE_LOOKUP], error)};
    result->pointer = texture.texture ? context_keep_texture(context, &texture, error) : NULL;
    return result->pointer != NULL;
}

static struct script_texture *keep_bump(struct script_context *context, const struct bump *bump, struct error *error) {
    return context_keep_texture(
        context, &(struct script_texture){.texture = bump->texture.authored, .is_bump = true, .bump = *bump}, error);
}

bool gr_bump(struct script_context *context, const struct script_value *args, struct script_result *result,
             struct error *error) {
    struct bump bump;
    if (!read_bump(context, &args[BUMP_FILE], &args[BUMP_LOOKUP], &args[BUMP_AMOUNT], &bump, error))
        return false;
    result->pointer = keep_bump(context, &bump, error);
    return result->pointer != NULL;
}

bool gr_bump_material(struct script_context *context, const struct script_value *args, struct script_result *result,
                      struct error *error) {
    struct bump bump;
    if (!read_bump(context, &args[OVER_IMAGE], &args[OVER_LOOKUP], &args[BUMP_OVER_AMOUNT], &bump, error))
        return false;
    struct material *m = scene_material(&context->scene, bump.kind, args[OVER_MATERIAL].material, error);
    return m && material_add_bump(m, &bump, &context->scene.arena, error) && give(result, m);
}

const struct bump *read_bump_values(struct script_context *context, const struct script_value *value,
                                    struct error *error) {
    static const struct script_value nothing[LOOKUP_COUNT];
    struct bump bump;
    const struct script_texture *kept =
        read_bump(context, value, nothing, nothing, &bump, error) ? keep_bump(context, &bump, error) : NULL;
    return kept ? &kept->bump : NULL;
}

const struct texture_image *gr_image(struct script_context *context, const struct script_value *value,
                                     struct error *error) {
    struct image *image = gr_find_image(context, value, error);
    struct texture_image *kept = image ? arena_alloc(&context->scene.arena, sizeof *kept) : NULL;
    if (image && !kept)
        error_no_memory(error, "a texture");
    if (!kept)
        return NULL;
    image_defaults(kept, value, image);
    context->scene.material_count++; /* as context_keep_texture does */
    return kept;
}
