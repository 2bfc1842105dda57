/* Materials, their decorators, and textures. */
#include "script/gr_materials_internal.h"

#include "base/file.h"
#include "compat/lenient.h"
#include "compat/lenient_picture.h"
#include "material/bump.h"
#include "material/material_inputs.h"
#include "script/gr_textures_internal.h"
#include "script/rows_internal.h"

#include <math.h>
#include <string.h>

/* The choices of parameters. */
#define HIGHLIGHTS(X) X(HIGHLIGHT_PHONG, "phong") X(HIGHLIGHT_BLINN, "blinn")
#define SPHERE_MAPPINGS(X) X(SPHERE_MAPPING_CLASSIC, "classic") X(SPHERE_MAPPING_OUTSIDE, "outside")
enum { SPHERE_MAPPINGS(LIST_MEMBER) };
#define IMAGE_CHANNELS(X) X(INPUT_KD, "kd") X(INPUT_KS, "ks") X(INPUT_EMISSION, "emission") X(INPUT_OPACITY, "opacity")
#define BUMP_KINDS(X) X(MATERIAL_BUMP, "bump") X(MATERIAL_NORMAL, "normal")

#define BASE ROW("material", KIND_MATERIAL, 0, ANY, NULL, NULL, "The base material.")

/* How an image is looked up: these fields always follow one another. */
enum {
    LOOKUP_FILTER,
    LOOKUP_WRAP,
    LOOKUP_FLIP_U,
    LOOKUP_TILES,
    LOOKUP_OFFSET,
    LOOKUP_ENCODING,
    LOOKUP_MAPPING,
    LOOKUP_COUNT
};
#define FILTER                                                                                                         \
    ROW("filter", KIND_CHOICE, OPTIONAL, 0, 0, LIST_BLANKS(IMAGE_FILTERS), NULL, "'mipmap'", "Filter of the lookup.")
#define WRAP_PARAMETER                                                                                                 \
    ROW("wrap", KIND_CHOICE, OPTIONAL, 0, 0, LIST_BLANKS(IMAGE_WRAPS), NULL, "'repeat'", "Lookup outside of the image.")
#define FLIP_U                                                                                                         \
    ROW("flip_u", KIND_BOOLEAN, OPTIONAL, ANY, NULL, "false", "Whether the image is mirrored from left to right.")
#define SPHERE_MAPPING                                                                                                 \
    ROW("mapping", KIND_CHOICE, OPTIONAL, 0, 0, LIST_BLANKS(SPHERE_MAPPINGS), NULL, "'classic'",                       \
        "On spheres: classic is mirrored, seen from outside; outside is not.")
#define TILES ROW("tiles", KIND_PAIR, OPTIONAL, ANY, NULL, "1", "Number of repetitions: one number, or {across, up}.")
#define OFFSET                                                                                                         \
    ROW("offset", KIND_PAIR, OPTIONAL, ANY, NULL, "0", "Shift in units of the image: one number, or {across, up}.")
#define ENCODING                                                                                                       \
    ROW("encoding", KIND_CHOICE, OPTIONAL | OR_NUMBER | LOW_OPEN, 0, 10, LIST_BLANKS(TEXTURE_ENCODINGS), NULL,         \
        "'auto'",                                                                                                      \
        "Meaning of its numbers for linear colours; auto: as the file states, otherwise sRGB for colours of 8 "        \
        "bits; a number is a gamma.")
#define LOOKUP_FIELDS(first)                                                                                           \
    [first + LOOKUP_FILTER] = FILTER, [first + LOOKUP_WRAP] = WRAP_PARAMETER, [first + LOOKUP_FLIP_U] = FLIP_U,        \
             [first + LOOKUP_TILES] = TILES, [first + LOOKUP_OFFSET] = OFFSET, [first + LOOKUP_ENCODING] = ENCODING,   \
             [first + LOOKUP_MAPPING] = SPHERE_MAPPING

static bool give(struct script_result *result, struct material *material) {
    result->pointer = material;
    return material != NULL;
}

static const struct texture *number_or_texture(struct script_context *context, const struct script_value *value,
                                               struct error *error) {
    struct script_value own = *value;
    own.colour = colour_all(value->number);
    return gr_texture_of(context, &own, error);
}

enum {
    PHONG_KD,
    PHONG_KS,
    PHONG_SHININESS,
    PHONG_REFLECT,
    PHONG_REFRACT,
    PHONG_IOR,
    PHONG_TWO_SIDED,
    PHONG_HIGHLIGHT,
    PHONG_LIT,
    PHONG_EMISSION,
    PHONG_ROUGHNESS,
    PHONG_GLOSSY_SAMPLES,
    PHONG_ABSORPTION,
    PHONG_OPACITY,
    PHONG_METALNESS,
    PHONG_BUMP,
    PHONG_GLASS
};
#define KD ROW("kd", KIND_COLOUR, OR_TEXTURE, ANY, NULL, NULL, "Diffuse and ambient colour.")
#define KS                                                                                                             \
    ROW("ks", KIND_COLOUR, OPTIONAL | OR_TEXTURE, ANY, NULL, "{0, 0, 0}",                                              \
        "Colour of highlights; filter of reflected and refracted rays.")
#define SHININESS                                                                                                      \
    ROW("shininess", KIND_NUMBER, OPTIONAL | OR_TEXTURE, ABOVE(0), NULL, "1", "Exponent of the highlight.")
#define TWO_SIDED                                                                                                      \
    ROW("two_sided", KIND_BOOLEAN, OPTIONAL, ANY, NULL, "false", "Whether faces seen from behind are lit, too.")
#define SURFACE_FIELDS                                                                                                 \
    [PHONG_HIGHLIGHT] = ROW("highlight", KIND_CHOICE, OPTIONAL, 0, 0, LIST_BLANKS(HIGHLIGHTS), NULL,                   \
                            "specular of the render", "Formula of the highlight."),                                    \
    [PHONG_LIT] = ROW("lit", KIND_BOOLEAN, OPTIONAL, ANY, NULL, "true",                                                \
                      "Whether light affects it; false: it shows kd unchanged."),                                      \
    [PHONG_EMISSION] = ROW("emission", KIND_COLOUR, OPTIONAL | OR_TEXTURE, ANY, NULL, "{0, 0, 0}",                     \
                           "Emitted light, added to reflected light."),                                                \
    [PHONG_ROUGHNESS] = ROW("roughness", KIND_NUMBER, OPTIONAL | OR_TEXTURE, IN_RANGE(0, 1), NULL, "0",                \
                            "Roughness of reflection and refraction; 0 is polished."),                                 \
    [PHONG_GLOSSY_SAMPLES] =                                                                                           \
        ROW("glossy_samples", KIND_WHOLE, OPTIONAL, IN_RANGE(1, 64), NULL, "4",                                        \
            "N x N rays from a rough surface; after the first rough surface of a path, one ray."),                     \
    [PHONG_ABSORPTION] = ROW("absorption", KIND_COLOUR, OPTIONAL, ABOVE(0), NULL, "{0, 0, 0}",                         \
                             "Absorption inside the solid: factor exp(-absorption * distance)."),                      \
    [PHONG_OPACITY] = ROW("opacity", KIND_NUMBER, OPTIONAL | OR_TEXTURE, IN_RANGE(0, 1), NULL, "1",                    \
                          "Opacity of the surface; below 1 it has holes."),                                            \
    [PHONG_METALNESS] = ROW("metalness", KIND_NUMBER, OPTIONAL | OR_TEXTURE, IN_RANGE(0, 1), NULL, "0",                \
                            "Fraction of kd that replaces ks."),                                                       \
    [PHONG_BUMP] = ROW("bump", KIND_IMAGE, OPTIONAL | OR_TEXTURE, ANY, NULL, "none",                                   \
                       "Heights: a result of gr.bump, a file or a texture."),                                          \
    [PHONG_GLASS] = GLASS_FIELD

static const struct script_parameter material_parameters[] = {
    [PHONG_KD] = KD,
    [PHONG_KS] = KS,
    [PHONG_SHININESS] = SHININESS,
    [PHONG_REFLECT] = {"reflect", KIND_NUMBER, OPTIONAL | OR_TEXTURE, IN_RANGE(0, 1), NULL, "0",
                       "Amount of reflection."},
    [PHONG_REFRACT] = {"refract", KIND_NUMBER, OPTIONAL | OR_TEXTURE, IN_RANGE(0, 1), NULL, "0",
                       "Amount of refraction."},
    [PHONG_IOR] = {"ior", KIND_NUMBER, OPTIONAL, ABOVE(1), NULL, "none", "Index of refraction inside the solid."},
    [PHONG_TWO_SIDED] = TWO_SIDED,
    SURFACE_FIELDS,
};

static const struct script_parameter rr_parameters[] = {
    [PHONG_KD] = KD,
    [PHONG_KS] = KS,
    [PHONG_SHININESS] = SHININESS,
    [PHONG_REFLECT] = {"reflect", KIND_NUMBER, OPTIONAL | OR_TEXTURE, IN_RANGE(0, 1), NULL, "0",
                       "Amount of reflection."},
    [PHONG_REFRACT] = {"refract", KIND_NUMBER, OPTIONAL | OR_TEXTURE, IN_RANGE(0, 1), NULL, "0",
                       "Amount of refraction."},
    [PHONG_IOR] = {"ior", KIND_NUMBER, OPTIONAL, ABOVE(1), NULL, "1", "Index of refraction inside the solid."},
    [PHONG_TWO_SIDED] = TWO_SIDED,
    SURFACE_FIELDS,
};

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
        const struct texture_image *cut = gr_cut_of(value, inputs[i].input);
        if (cut && !material_cut_by_alpha(m, cut, arena, error))
            return false;
        if (cut && inputs[i].input == INPUT_OPACITY)
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
    if (args[PHONG_GLASS].given && args[PHONG_IOR].given) {
        error_set(error, ERROR_SCENE, "glass has an index of its own: ior is not needed");
        return NULL;
    }
    struct material *m = scene_material(&context->scene, MATERIAL_PHONG, NULL, error);
    if (!m)
        return NULL;
    m->phong.kd = args[PHONG_KD].colour;
    m->phong.ks = args[PHONG_KS].colour;
    m->phong.shininess = args[PHONG_SHININESS].given ? args[PHONG_SHININESS].number : 1;
    m->phong.reflect = args[PHONG_REFLECT].number;
    m->phong.refract = args[PHONG_REFRACT].number;
    m->phong.has_ior = args[PHONG_IOR].given;
    m->phong.ior = args[PHONG_IOR].given ? args[PHONG_IOR].number : 1;
    if (args[PHONG_GLASS].given) {
        m->phong.dispersion = (struct dispersion){1, gr_glass_of(&args[PHONG_GLASS])};
        m->phong.has_ior = true;
        m->phong.ior = glass_ior(m->phong.dispersion.glass);
    }
    m->phong.two_sided = args[PHONG_TWO_SIDED].boolean;
    static const enum material_highlight highlights[] = {HIGHLIGHTS(LIST_MEMBER)};
    if (args[PHONG_HIGHLIGHT].given)
        m->phong.highlight = highlights[args[PHONG_HIGHLIGHT].choice];
    m->phong.unlit = args[PHONG_LIT].given && !args[PHONG_LIT].boolean;
    m->phong.emission = args[PHONG_EMISSION].colour;
    m->phong.absorption = args[PHONG_ABSORPTION].colour;
    m->phong.roughness = args[PHONG_ROUGHNESS].number;
    m->phong.glossy_samples = (int)args[PHONG_GLOSSY_SAMPLES].number;
    return with_textures(context, m, args, error) ? m : NULL;
}

static bool gr_material(struct script_context *context, const struct script_value *args, struct script_result *result,
                        struct error *error) {
    context_warn_of_bytes(context, "kd", args[PHONG_KD].colour);
    context_warn_of_bytes(context, "ks", args[PHONG_KS].colour);
    if (args[PHONG_REFRACT].number > 0 && !args[PHONG_IOR].given && !args[PHONG_GLASS].given)
        return error_set(error, ERROR_SCENE, "ior is missing: refraction needs an index of refraction");
    return give(result, phong(context, args, error));
}

static bool gr_rr_material(struct script_context *context, const struct script_value *args,
                           struct script_result *result, struct error *error) {
    struct material *m = phong(context, args, error);
    if (m)
        m->phong.has_ior = true;
    return give(result, m);
}

/* The pattern mixes kd with another colour. */
static bool pattern_over(struct script_context *context, struct material *m, struct texture pattern,
                         const struct script_value *mix, struct script_result *result, struct error *error) {
    struct texture other = mix->display ? texture_display_colour(mix->colour) : texture_constant(mix->colour);
    return m && material_mix_kd(m, pattern, other, &context->scene.arena, error) && give(result, m);
}

enum { MARBLE_MATERIAL, MARBLE_F, MARBLE_MULTIPLIER, MARBLE_VEIN, MARBLE_INTERP, MARBLE_MIX };
#define INTERP                                                                                                         \
    ROW("interp", KIND_WHOLE, OPTIONAL, IN_RANGE(0, 1), NULL, "0", "Interpolation of the noise: 0 linear, 1 cosine.")
#define MIX ROW("mix", KIND_COLOUR, OR_DISPLAY, ANY, NULL, NULL, "Colour to mix with kd.")

static const struct script_parameter marble_parameters[] = {
    [MARBLE_MATERIAL] = BASE,
    [MARBLE_F] = {"f", KIND_NUMBER, 0, ANY, NULL, NULL, "Factor of the point before the noise."},
    [MARBLE_MULTIPLIER] = {"multiplier", KIND_NUMBER, 0, ANY, NULL, NULL, "Strength of the noise in the veins."},
    [MARBLE_VEIN] = {"vein_frequency", KIND_NUMBER, 0, ANY, NULL, NULL, "Frequency of the veins along y."},
    [MARBLE_INTERP] = INTERP,
    [MARBLE_MIX] = MIX,
};

static bool gr_marble(struct script_context *context, const struct script_value *args, struct script_result *result,
                      struct error *error) {
    struct texture pattern = texture_marble(args[MARBLE_F].number, args[MARBLE_MULTIPLIER].number,
                                            args[MARBLE_VEIN].number, (int)args[MARBLE_INTERP].number);
    return pattern_over(context,
                        scene_material(&context->scene, MATERIAL_MARBLE, args[MARBLE_MATERIAL].material, error),
                        pattern, &args[MARBLE_MIX], result, error);
}

enum { WOOD_MATERIAL, WOOD_F, WOOD_DENSITY, WOOD_INTERP, WOOD_MIX };
static const struct script_parameter wood_parameters[] = {
    [WOOD_MATERIAL] = BASE,
    [WOOD_F] = {"f", KIND_NUMBER, 0, ANY, NULL, NULL, "Factor of the point before the noise."},
    [WOOD_DENSITY] = {"density", KIND_NUMBER, 0, ANY, NULL, NULL, "Density of the grain."},
    [WOOD_INTERP] = INTERP,
    [WOOD_MIX] = MIX,
};

static bool gr_wood(struct script_context *context, const struct script_value *args, struct script_result *result,
                    struct error *error) {
    struct texture pattern =
        texture_wood(args[WOOD_F].number, args[WOOD_DENSITY].number, (int)args[WOOD_INTERP].number);
    return pattern_over(context, scene_material(&context->scene, MATERIAL_WOOD, args[WOOD_MATERIAL].material, error),
                        pattern, &args[WOOD_MIX], result, error);
}

enum { FRESNEL_MATERIAL };
static const struct script_parameter fresnel_parameters[] = {[FRESNEL_MATERIAL] = BASE};

static bool gr_fresnel(struct script_context *context, const struct script_value *args, struct script_result *result,
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
    /* What the call gives goes before what the texture has. */
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
    /* A lookup that was plain begins with one tile. */
    if ((tiles->given || offset->given) && !out->apart) {
        out->apart = true;
        out->scale[0] = out->scale[1] = 1;
        out->tint = colour_all(1);
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
    bool holes = input == INPUT_OPACITY;
    if ((holes || input == INPUT_KD) && !material_cut_by_alpha(m, image, arena, error))
        return false;
    bool ok =
        holes ? image->cuts || material_cut(m, image, 0, arena, error) : material_cover(m, input, image, arena, error);
    return ok && give(result, m);
}

enum { IMAGE_MATERIAL, IMAGE_PNG, IMAGE_FILTER, IMAGE_FLIP_U, IMAGE_MAPPING };
static const struct script_parameter image_parameters[] = {
    [IMAGE_MATERIAL] = BASE,
    [IMAGE_PNG] = {"png", KIND_IMAGE, 0, ANY, NULL, NULL, "A picture file, or a texture."},
    [IMAGE_FILTER] = FILTER,
    [IMAGE_FLIP_U] = FLIP_U,
    [IMAGE_MAPPING] = SPHERE_MAPPING,
};

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

static bool gr_td_cube(struct script_context *context, const struct script_value *args, struct script_result *result,
                       struct error *error) {
    return td_material(context, args, MAPPING_CUBE, result, error);
}

static bool gr_td_sphere(struct script_context *context, const struct script_value *args, struct script_result *result,
                         struct error *error) {
    return td_material(context, args, MAPPING_SPHERE, result, error);
}

enum { OVER_MATERIAL, OVER_IMAGE, OVER_LOOKUP, OVER_CHANNEL = OVER_LOOKUP + LOOKUP_COUNT };
static const struct script_parameter image_over_parameters[] = {
    [OVER_MATERIAL] = BASE,
    [OVER_IMAGE] = {"image", KIND_IMAGE, 0, ANY, NULL, NULL, "A picture file, or a texture."},
    LOOKUP_FIELDS(OVER_LOOKUP),
    [OVER_CHANNEL] = {"channel", KIND_CHOICE, OPTIONAL, 0, 0, LIST_BLANKS(IMAGE_CHANNELS), NULL, "'kd'",
                      "The input that the image replaces; where opacity is below 1, the surface has holes."},
};

static bool gr_image_material(struct script_context *context, const struct script_value *args,
                              struct script_result *result, struct error *error) {
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

enum { TEXTURE_FILE, TEXTURE_LOOKUP, TEXTURE_ALPHA = TEXTURE_LOOKUP + LOOKUP_COUNT };
static const struct script_parameter texture_parameters[] = {
    [TEXTURE_FILE] = {"file", KIND_IMAGE, 0, ANY, NULL, NULL, "A picture file."},
    LOOKUP_FIELDS(TEXTURE_LOOKUP),
    [TEXTURE_ALPHA] = {"alpha", KIND_BOOLEAN, OPTIONAL, ANY, NULL, "false",
                       "Whether the alpha of the picture is the opacity of the surface."},
};

static bool gr_texture(struct script_context *context, const struct script_value *args, struct script_result *result,
                       struct error *error) {
    struct texture_image image;
    if (!read_image(context, &args[TEXTURE_FILE], &args[TEXTURE_LOOKUP], &image, error))
        return false;
    if (args[TEXTURE_ALPHA].given)
        image.cuts = args[TEXTURE_ALPHA].boolean;
    struct script_texture texture = {.texture =
                                         texture_keep(&context->scene.arena, texture_image(&image, NULL), error)};
    result->pointer = texture.texture ? context_keep_texture(context, &texture, error) : NULL;
    return result->pointer != NULL;
}

static struct script_texture *keep_bump(struct script_context *context, const struct bump *bump, struct error *error) {
    return context_keep_texture(
        context, &(struct script_texture){.texture = bump->texture, .is_bump = true, .bump = *bump}, error);
}

enum { BUMP_FILE, BUMP_LOOKUP, BUMP_AMOUNT = BUMP_LOOKUP + LOOKUP_COUNT, BUMP_KIND };
#define BUMP_AMOUNT_FIELD                                                                                              \
    ROW("height", KIND_NUMBER, OPTIONAL, ANY, NULL, "1/50 of the picture's size; 1 for normals",                       \
        "Height of white above black, in units of the object; for normals, a factor of the slopes.")
#define BUMP_KIND_FIELD                                                                                                \
    ROW("kind", KIND_CHOICE, OPTIONAL, 0, 0, LIST_BLANKS(BUMP_KINDS), NULL, "'bump'",                                  \
        "Contents: heights, or normals as colours (x right, y up, z outwards).")

static const struct script_parameter bump_parameters[] = {
    [BUMP_FILE] = {"file", KIND_IMAGE, OR_TEXTURE, ANY, NULL, NULL, "A picture file, or any texture."},
    LOOKUP_FIELDS(BUMP_LOOKUP),
    [BUMP_AMOUNT] = BUMP_AMOUNT_FIELD,
    [BUMP_KIND] = BUMP_KIND_FIELD,
};

static bool gr_bump(struct script_context *context, const struct script_value *args, struct script_result *result,
                    struct error *error) {
    struct bump bump;
    if (!read_bump(context, &args[BUMP_FILE], &args[BUMP_LOOKUP], &args[BUMP_AMOUNT], &bump, error))
        return false;
    result->pointer = keep_bump(context, &bump, error);
    return result->pointer != NULL;
}

enum { BUMP_OVER_AMOUNT = OVER_LOOKUP + LOOKUP_COUNT, BUMP_OVER_KIND };
static const struct script_parameter bump_over_parameters[] = {
    [OVER_MATERIAL] = BASE,
    [OVER_IMAGE] = {"image", KIND_IMAGE, OR_TEXTURE, ANY, NULL, NULL, "A picture file, or a result of gr.bump."},
    LOOKUP_FIELDS(OVER_LOOKUP),
    [BUMP_OVER_AMOUNT] = BUMP_AMOUNT_FIELD,
    [BUMP_OVER_KIND] = BUMP_KIND_FIELD,
};

static bool gr_bump_material(struct script_context *context, const struct script_value *args,
                             struct script_result *result, struct error *error) {
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

static const struct script_function material_rows[] = {
    GR("material", material_parameters, RESULT_MATERIAL, gr_material, "A Phong material.", "kd ks? shininess?"),
    GR("rr_material", rr_parameters, RESULT_MATERIAL, gr_rr_material, "A Phong material that reflects and refracts.",
       "kd ks shininess reflect refract ior"),
    GR("marble_pnd_material", marble_parameters, RESULT_MATERIAL, gr_marble, "Marble over another material.",
       "material f multiplier vein_frequency interp mix"),
    GR("wood_pnd_material", wood_parameters, RESULT_MATERIAL, gr_wood, "Wood over another material.",
       "material f density interp mix"),
    GR("td_cube_material", image_parameters, RESULT_MATERIAL, gr_td_cube,
       "An image on each side of the unit cube, over another material.", "material png"),
    GR("td_sphere_material", image_parameters, RESULT_MATERIAL, gr_td_sphere,
       "An image around the unit sphere, over another material.", "material png"),
    GR("difresnel_material", fresnel_parameters, RESULT_MATERIAL, gr_fresnel,
       "A dielectric: reflects and refracts by Fresnel's equations.", "material"),
    GR("difresneld_material", fresnel_parameters, RESULT_MATERIAL, gr_fresnel, "The same as gr.difresnel_material.",
       "material"),
    GR("texture", texture_parameters, RESULT_TEXTURE, gr_texture,
       "An image texture for node:set_texture and for inputs of gr.material.", "file"),
    GR("bump", bump_parameters, RESULT_TEXTURE, gr_bump, "A bump map or normal map for node:set_bump.", "file height?"),
    GR("image_material", image_over_parameters, RESULT_MATERIAL, gr_image_material,
       "An image mapped by the texture coordinates of the shape, over another material.", "material image"),
    GR("bump_material", bump_over_parameters, RESULT_MATERIAL, gr_bump_material,
       "A bump map or normal map over another material.", "material image height?"),
};
const struct function_rows material_functions = {material_rows, COUNT(material_rows)};
