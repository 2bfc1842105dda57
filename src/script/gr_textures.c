/* Textures that are no images: patterns, and operations on other textures. Each function has its binding and its table
 * row in this file. */
#include "script/gr_textures_internal.h"

#include "expr/expr_text.h"
#include "image/image_function.h"
#include "record/record.h"
#include "record/vector.h"
#include "script/gr_materials_internal.h"
#include "script/rows_internal.h"
#include "script/table_internal.h"

#include <lauxlib.h>
#include <string.h>

const struct texture *gr_texture_of(struct script_context *context, const struct script_value *value,
                                    struct error *error) {
    struct arena *arena = &context->scene.arena;
    const struct script_texture *given = value->texture;
    struct colour v = value->colour;
    const struct texture_image *image = given ? texture_as_image(given->texture) : NULL;
    if (image) { /* transparent parts are white, unless alpha is opacity */
        const struct texture *white = texture_keep(arena, texture_number(1), error);
        struct texture_image own = *image;
        own.alpha = image->cuts ? ALPHA_STRAIGHT : image->alpha;
        return white ? texture_keep(arena, texture_image(&own, white), error) : NULL;
    }
    if (given)
        return given->texture;
    return texture_keep(arena, v.r == v.g && v.g == v.b ? texture_number(v.r) : texture_constant(v), error);
}

const struct texture_image *gr_cut_of(const struct script_value *value, enum material_input input) {
    const struct texture_image *image = value->texture ? texture_as_image(value->texture->texture) : NULL;
    return image && image->cuts && (input == INPUT_KD || input == INPUT_OPACITY) ? image : NULL;
}

static bool give(struct script_context *context, struct texture texture, struct script_result *result,
                 struct error *error) {
    struct script_texture out = {.texture = texture_keep(&context->scene.arena, texture, error)};
    result->pointer = out.texture ? context_keep_texture(context, &out, error) : NULL;
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
    ratio.colour = colour_all(ratio.given ? ratio.number : 0.5);
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
    if (own.operation.kind == TEXTURE_FUNCTION && args[FN_POINTS].given)
        own.operation.recorded.points = points;
    return give(context, own, result, error);
}

/* --- pictures as functions --- */

/* The picture of a texture as a function, with the lookup of gr.texture. Its numbers are those of the file, unless the
 * texture has an explicit encoding. */
static struct image_function *make_image_function(struct script_context *context, const struct texture_image *image,
                                                  struct error *error) {
    struct transfer_function transfer = {TRANSFER_UNSTATED, 0};
    struct image_function *out = arena_alloc(&context->scene.arena, sizeof *out);
    if (!out) {
        (void)error_no_memory(error, "a picture");
        return NULL;
    }
    if (image->gamma > 0)
        transfer = (struct transfer_function){TRANSFER_POWER, image->gamma};
    else if (image->encoding == ENCODING_SRGB)
        transfer = (struct transfer_function){TRANSFER_SRGB, 0};
    struct image *decoded = image_decode(image->image, transfer, error);
    if (!decoded || !image_make_ranges(decoded, error))
        return NULL;
    *out = (struct image_function){.image = decoded,
                                   .sampling = {image->filter, image->wrap, image->apart ? image->wrap_v : image->wrap},
                                   .scale = {1, 1},
                                   .flip_u = image->flip_u,
                                   .tint = {1, 1, 1}};
    /* Tiles, offset and tint, where they were set. */
    if (!image->apart)
        return out;
    for (int k = 0; k < 2; k++) {
        out->scale[k] = image->scale[k];
        out->offset[k] = image->offset[k];
    }
    out->tint[0] = image->tint.r;
    out->tint[1] = image->tint.g;
    out->tint[2] = image->tint.b;
    return out;
}

/* Of a texture that is only an image. NULL: an error. */
static const struct image_function *image_function_of(struct script_context *context, struct script_texture *texture,
                                                      struct error *error) {
    if (!texture->function) {
        texture->function = make_image_function(context, texture_as_image(texture->texture), error);
        context->scene.escaped = true; /* the texture may be older */
    }
    return texture->function;
}

enum { PROGRAM_CODE, PROGRAM_IMAGE };
#define PROGRAM_PICTURE(name)                                                                                          \
    { name, KIND_IMAGE, OPTIONAL | RARE, ANY, NULL, "none", "A picture that texel reads." }
static const struct script_parameter program_parameters[] = {
    [PROGRAM_CODE] = {"code", KIND_TEXT, 0, ANY, NULL, NULL,
                      "Its operations, such as 'v0 = p.x; v1 = sin v0; result v1'."},
    [PROGRAM_IMAGE] = PROGRAM_PICTURE("image1"),
    PROGRAM_PICTURE("image2"),
    PROGRAM_PICTURE("image3"),
    PROGRAM_PICTURE("image4"),
};

static bool program(struct script_context *context, const struct script_value *args, struct script_result *result,
                    struct error *error) {
    struct arena *arena = &context->scene.arena;
    struct expr_program *out = arena_alloc(arena, sizeof *out);
    struct expr_images images = {.count = EXPR_IMAGES};
    for (int k = 0; k < EXPR_IMAGES; k++) {
        const struct script_value *value = &args[PROGRAM_IMAGE + k];
        const struct texture_image *file = value->text ? gr_image(context, value, error) : NULL;
        if (value->texture)
            images.items[k] = image_function_of(context, (struct script_texture *)(uintptr_t)value->texture, error);
        else if (file)
            images.items[k] = make_image_function(context, file, error);
        if (value->given && !images.items[k])
            return false;
    }
    if (!out)
        return error_no_memory(error, "a function");
    if (!expr_read_text(args[PROGRAM_CODE].text, &images, arena, out, error))
        return false;
    out->source = "gr.program";
    return give(context, record_texture_of(out), result, error);
}

static const struct script_function rows[] = {
    GR("fn", fn_parameters, RESULT_TEXTURE, fn,
       "A Lua function as a texture. Every argument that accepts a texture also accepts a function.", "f points?"),
    GR("program", program_parameters, RESULT_TEXTURE, program,
       "A function as the text of its operations, as gray writes it into scenes of JSON.", "code"),
    GR("marble_texture", marble_parameters, RESULT_TEXTURE, marble,
       "A marble pattern between 0 and 1, for inputs of gr.material.", "f multiplier vein_frequency interp?"),
    GR("wood_texture", wood_parameters, RESULT_TEXTURE, wood,
       "A wood pattern between 0 and 1, for inputs of gr.material.", "f density interp?"),
    GR("mix_texture", mix_parameters, RESULT_TEXTURE, mix, "A mix of two textures or colours.", "a b ratio?"),
    GR("multiply_texture", multiply_parameters, RESULT_TEXTURE, multiply, "The product of two textures or colours.",
       "a b"),
};

const struct function_rows texture_functions = {rows, COUNT(rows)};

/* --- img:at --- */

static const struct image_function *image_function_at(lua_State *L, int index) {
    struct script_context *context = context_of(L);
    const struct handle *handle = handle_at(L, index);
    struct script_texture *texture = handle && handle->type == HANDLE_TEXTURE ? handle->pointer : NULL;
    struct error error = {0};
    context->sandbox.lua = L;
    if (!texture || texture->is_bump || !texture_as_image(texture->texture))
        luaL_error(L, "img:at(u, v) needs a picture, a result of gr.texture, not %s", value_words(L, index));
    const struct image_function *function = image_function_of(context, texture, &error);
    if (!function)
        sandbox_raise_error(&context->sandbox, &error);
    return function;
}

/* img:at(u, v): the colour, multiplied by alpha, and alpha. */
static int image_at(lua_State *L) {
    const struct image_function *function = image_function_at(L, 1);
    lua_settop(L, 3);
    return push_image_value(L, function);
}

/* Upvalue 1: what handles without methods have in its place. */
static int texture_index(lua_State *L) {
    if (lua_type(L, 2) == LUA_TSTRING && strcmp(lua_tostring(L, 2), "at") == 0) {
        lua_pushcfunction(L, image_at);
        return 1;
    }
    if (!context_of(L)->lenient)
        return luaL_error(L, "a texture has no field '%s'; img:at(u, v) reads a picture", luaL_tolstring(L, 2, NULL));
    lua_pushvalue(L, lua_upvalueindex(1));
    lua_insert(L, 1);
    lua_call(L, 2, 1);
    return 1;
}

void textures_open(lua_State *L) {
    lua_rawgetp(L, LUA_REGISTRYINDEX, handle_key(HANDLE_TEXTURE));
    lua_getfield(L, -1, "__index");
    lua_pushcclosure(L, texture_index, 1);
    lua_setfield(L, -2, "__index");
    lua_pop(L, 1);
}
