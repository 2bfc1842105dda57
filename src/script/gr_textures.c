/* Textures that are no images: patterns, and operations on other textures. Each function has its binding and its table
 * row in this file.
 */
#include "script/bindings_internal.h"
#include "script/context_internal.h"
#include "script/table_rows_internal.h"

/* Saved edits count textures among the materials of a scene. */
struct script_texture *gr_keep_texture(struct script_context *context, const struct script_texture *value,
                                       struct error *error) {
    struct script_texture *out = arena_alloc(&context->scene.arena, sizeof *out);
    if (!out) {
        error_no_memory(error, "a texture");
        return NULL;
    }
    *out = *value;
    context->scene.material_count++;
    return out;
}

const struct texture *gr_texture_of(struct script_context *context, const struct script_value *value,
                                    struct error *error) {
    struct arena *arena = &context->scene.arena;
    const struct script_texture *given = value->texture;
    struct vec3 v = value->vector;
    const struct texture_image *image = given ? texture_as_image(given->texture) : NULL;
    if (image) { /* transparent parts are white */
        const struct texture *white = texture_keep(arena, texture_number(1), error);
        return white ? texture_keep(arena, texture_image(image, white), error) : NULL;
    }
    if (given)
        return given->texture;
    return texture_keep(arena, v.x == v.y && v.y == v.z ? texture_number(v.x) : texture_constant(v), error);
}

static bool give(struct script_context *context, struct texture texture, struct script_result *result,
                 struct error *error) {
    struct script_texture out = {.texture = texture_keep(&context->scene.arena, texture, error)};
    result->pointer = out.texture ? gr_keep_texture(context, &out, error) : NULL;
    return result->pointer != NULL;
}

#define INTERP                                                                                                         \
    { "interp", KIND_WHOLE, OPTIONAL, IN_RANGE(0, 1), NULL, "0", "Interpolation of the noise: 0 linear, 1 cosine." }
/* A colour, a number for all three components, or a texture. */
#define PART(name, help)                                                                                               \
    { name, KIND_SIZE, OR_TEXTURE, ANY, NULL, NULL, help }

enum { MARBLED_F, MARBLED_MULTIPLIER, MARBLED_VEIN, MARBLED_INTERP };
static const struct script_parameter marble_parameters[] = {
    [MARBLED_F] = {"f", KIND_NUMBER, 0, ANY, NULL, NULL, "Factor of the point before the noise."},
    [MARBLED_MULTIPLIER] = {"multiplier", KIND_NUMBER, 0, ANY, NULL, NULL, "Strength of the noise in the veins."},
    [MARBLED_VEIN] = {"vein_frequency", KIND_NUMBER, 0, ANY, NULL, NULL, "Frequency of the veins along y."},
    [MARBLED_INTERP] = INTERP,
};

static bool marble(struct script_context *context, const struct script_value *args, struct script_result *result,
                   struct error *error) {
    return give(context,
                texture_marble(args[MARBLED_F].number, args[MARBLED_MULTIPLIER].number, args[MARBLED_VEIN].number,
                               (int)args[MARBLED_INTERP].number),
                result, error);
}

enum { WOODEN_F, WOODEN_DENSITY, WOODEN_INTERP };
static const struct script_parameter wood_parameters[] = {
    [WOODEN_F] = {"f", KIND_NUMBER, 0, ANY, NULL, NULL, "Factor of the point before the noise."},
    [WOODEN_DENSITY] = {"density", KIND_NUMBER, 0, ANY, NULL, NULL, "Density of the grain."},
    [WOODEN_INTERP] = INTERP,
};

static bool wood(struct script_context *context, const struct script_value *args, struct script_result *result,
                 struct error *error) {
    return give(context,
                texture_wood(args[WOODEN_F].number, args[WOODEN_DENSITY].number, (int)args[WOODEN_INTERP].number),
                result, error);
}

enum { MIXED_A, MIXED_B, MIXED_RATIO };
static const struct script_parameter mix_parameters[] = {
    [MIXED_A] = PART("a", "Value where ratio is 1: a number, a colour or a texture."),
    [MIXED_B] = PART("b", "Value where ratio is 0."),
    [MIXED_RATIO] = {"ratio", KIND_NUMBER, OPTIONAL | OR_TEXTURE, ANY, NULL, "0.5",
                     "Weight of a: the result is a * ratio + b * (1 - ratio)."},
};

static bool mix(struct script_context *context, const struct script_value *args, struct script_result *result,
                struct error *error) {
    struct script_value ratio = args[MIXED_RATIO];
    ratio.vector = vec3_all(ratio.given ? ratio.number : 0.5);
    const struct texture *a = gr_texture_of(context, &args[MIXED_A], error);
    const struct texture *b = a ? gr_texture_of(context, &args[MIXED_B], error) : NULL;
    const struct texture *share = b ? gr_texture_of(context, &ratio, error) : NULL;
    return share && give(context, texture_mix(a, b, share), result, error);
}

enum { FACTOR_A, FACTOR_B };
static const struct script_parameter multiply_parameters[] = {
    [FACTOR_A] = PART("a", "One factor: a number, a colour or a texture."),
    [FACTOR_B] = PART("b", "The other factor."),
};

static bool multiply(struct script_context *context, const struct script_value *args, struct script_result *result,
                     struct error *error) {
    const struct texture *a = gr_texture_of(context, &args[FACTOR_A], error);
    const struct texture *b = a ? gr_texture_of(context, &args[FACTOR_B], error) : NULL;
    return b && give(context, texture_multiply(a, b), result, error);
}

enum { FN_F, FN_POINTS };
static const struct script_parameter fn_parameters[] = {
    [FN_F] = PART("f", "A Lua function f(p, s) of the point, or anything else that is a texture."),
    [FN_POINTS] =
        {"points", KIND_WHOLE, OPTIONAL, IN_RANGE(1, FUNCTION_POINTS), NULL, "16",
         "Maximum number of points of a pixel's footprint over which the function is averaged: 1, 2, 4, 8 or 16."},
};

static bool fn(struct script_context *context, const struct script_value *args, struct script_result *result,
               struct error *error) {
    const struct texture *texture = gr_texture_of(context, &args[FN_F], error);
    if (!texture)
        return false;
    struct texture own = *texture;
    int points = args[FN_POINTS].given ? (int)args[FN_POINTS].number : FUNCTION_POINTS;
    while (points & (points - 1)) /* a power of two */
        points &= points - 1;
    if (own.kind == TEXTURE_FUNCTION && args[FN_POINTS].given)
        own.recorded.points = points;
    return give(context, own, result, error);
}

static const struct script_function rows[] = {
    GR("fn", fn_parameters, RESULT_TEXTURE, fn,
       "A Lua function as a texture. Every argument that accepts a texture also accepts a function.", "f points?"),
    GR("marble_texture", marble_parameters, RESULT_TEXTURE, marble,
       "A marble pattern between 0 and 1, for inputs of gr.material.", "f multiplier vein_frequency interp?"),
    GR("wood_texture", wood_parameters, RESULT_TEXTURE, wood,
       "A wood pattern between 0 and 1, for inputs of gr.material.", "f density interp?"),
    GR("mix_texture", mix_parameters, RESULT_TEXTURE, mix, "A mix of two textures or colours.", "a b ratio?"),
    GR("multiply_texture", multiply_parameters, RESULT_TEXTURE, multiply, "The product of two textures or colours.",
       "a b"),
};

const struct function_rows texture_functions = {rows, COUNT(rows)};
