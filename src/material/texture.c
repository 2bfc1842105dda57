/* Trees of textures as scripts and files make them, and estimates of what they show. texture_tables.c evaluates
 * them. */
#include "material/texture.h"

#include "material/texture_tables.h"

/* --- values --- */

static struct texture leaf(struct texture_operation operation) {
    return (struct texture){.operation = operation, .source = "", .depth = 1, .size = 1};
}

struct texture texture_constant(struct colour colour) {
    return leaf((struct texture_operation){.kind = TEXTURE_CONSTANT,
                                           .constant = {colour, (colour.r + colour.g + colour.b) / 3, false}});
}

struct texture texture_display_colour(struct colour colour) {
    struct texture texture = texture_constant(colour);
    texture.operation.constant.display = true;
    return texture;
}

struct texture texture_number(double number) {
    return leaf((struct texture_operation){.kind = TEXTURE_CONSTANT, .constant = {colour_all(number), number, false}});
}

struct texture texture_vertex_colour(void) {
    return leaf((struct texture_operation){.kind = TEXTURE_VERTEX_COLOUR});
}

struct texture texture_marble(double f, double multiplier, double vein_frequency, int interpolation) {
    return leaf(
        (struct texture_operation){.kind = TEXTURE_MARBLE, .marble = {f, multiplier, vein_frequency, interpolation}});
}

struct texture texture_wood(double f, double density, int interpolation) {
    return leaf((struct texture_operation){.kind = TEXTURE_WOOD, .wood = {f, density, interpolation}});
}

/* The operation over its parts. Sizes above TEXTURE_SIZE count as TEXTURE_SIZE + 1. */
static struct texture over(struct texture_operation operation, const struct texture *a, const struct texture *b,
                           const struct texture *c) {
    struct texture out = {.operation = operation, .parts = {a, b, c}, .source = "", .size = 1};
    for (int i = 0; i < TEXTURE_PARTS; i++) {
        if (!out.parts[i])
            continue;
        out.size += out.parts[i]->size;
        out.has_image = out.has_image || out.parts[i]->has_image;
        out.has_function = out.has_function || out.parts[i]->has_function;
    }
    out.size = out.size > TEXTURE_SIZE ? TEXTURE_SIZE + 1 : out.size;
    out.depth = texture_depth(&out);
    return out;
}

struct texture texture_image(const struct texture_image *image, const struct texture *below) {
    struct texture out = over((struct texture_operation){.kind = TEXTURE_IMAGE, .image = *image}, below, NULL, NULL);
    out.has_image = true;
    return out;
}

struct texture texture_mix(const struct texture *a, const struct texture *b, const struct texture *ratio) {
    return over((struct texture_operation){.kind = TEXTURE_MIX}, a, b, ratio);
}

struct texture texture_multiply(const struct texture *a, const struct texture *b) {
    return over((struct texture_operation){.kind = TEXTURE_MULTIPLY}, a, b, NULL);
}

struct texture texture_map(const struct texture *of, enum texture_function function, double amount) {
    return over((struct texture_operation){.kind = TEXTURE_MAP, .map = {function, amount}}, of, NULL, NULL);
}

struct texture texture_function(const struct expr_program *program, bool has_coordinates, struct colour average,
                                struct colour largest) {
    struct texture out = leaf((struct texture_operation){.kind = TEXTURE_FUNCTION,
                                                         .recorded = {.program = program,
                                                                      .mapping = MAPPING_BY_SHAPE,
                                                                      .has_coordinates = has_coordinates,
                                                                      .points = FUNCTION_POINTS,
                                                                      .average = average,
                                                                      .largest = largest}});
    out.has_image = has_coordinates;
    out.has_function = true;
    return out;
}

const struct texture *texture_parameter(enum material_input input) {
#define PARAMETER(input, ...)                                                                                          \
    [input] = {.operation = {.kind = TEXTURE_PARAMETER, .parameter = (input)}, .source = "", .depth = 1, .size = 1},
    static const struct texture parameters[] = {MATERIAL_INPUTS(PARAMETER)};
#undef PARAMETER
    return &parameters[input];
}

const struct texture *texture_keep(struct arena *arena, struct texture value, struct error *error) {
    if (value.size > TEXTURE_SIZE) {
        error_set(error, ERROR_SCENE, "more than %d textures are in one", TEXTURE_SIZE);
        return NULL;
    }
    struct texture *out = arena_alloc(arena, sizeof *out);
    if (!out) {
        error_no_memory(error, "a texture");
        return NULL;
    }
    *out = value;
    return out;
}

int texture_part_count(enum texture_kind kind) {
    switch (kind) {
    case TEXTURE_CONSTANT:
    case TEXTURE_PARAMETER:
    case TEXTURE_VERTEX_COLOUR:
    case TEXTURE_MARBLE:
    case TEXTURE_WOOD:
    case TEXTURE_FUNCTION:
        return 0;
    case TEXTURE_IMAGE:
    case TEXTURE_MAP:
        return 1;
    case TEXTURE_MULTIPLY:
        return 2;
    case TEXTURE_MIX:
        return 3;
    }
    return 0;
}

int texture_colour_parts(enum texture_kind kind) {
    switch (kind) {
    case TEXTURE_CONSTANT:
    case TEXTURE_PARAMETER:
    case TEXTURE_VERTEX_COLOUR:
    case TEXTURE_MARBLE:
    case TEXTURE_WOOD:
    case TEXTURE_FUNCTION:
    case TEXTURE_MAP:
        return 0;
    case TEXTURE_IMAGE:
        return 1;
    case TEXTURE_MIX:
    case TEXTURE_MULTIPLY:
        return 2;
    }
    return 0;
}

/* --- operations --- */

struct colour texture_parameter_colour(enum material_input input, const struct phong *numbers) {
    if (!numbers)
        return colour_all(1);
    switch (input) {
    case INPUT_KD:
        return numbers->kd;
    case INPUT_KS:
        return numbers->ks;
    case INPUT_SHININESS:
        return colour_all(numbers->shininess);
    case INPUT_REFLECT:
        return colour_all(numbers->reflect);
    case INPUT_REFRACT:
        return colour_all(numbers->refract);
    case INPUT_ROUGHNESS:
        return colour_all(numbers->roughness);
    case INPUT_EMISSION:
        return numbers->emission;
    case INPUT_OPACITY:
        OPENPBR_INPUTS(LIST_LABEL)
        break;
    }
    return colour_all(1);
}

double texture_map_number(const struct texture_operation *map, double x) {
    switch (map->map.function) {
    case FUNCTION_RED:
    case FUNCTION_GREEN:
    case FUNCTION_BLUE:
        return x;
    case FUNCTION_COMPLEMENT:
        return 1 - x;
    case FUNCTION_SATURATE:
        return x > 1 ? 1 : x > 0 ? x : 0;
    case FUNCTION_STEP:
        return x >= map->map.amount ? 1 : 0;
    }
    return x;
}

bool texture_map_component(const struct texture_operation *map, struct colour colour, double *out) {
    enum texture_function function = map->map.function;
    *out = function == FUNCTION_RED ? colour.r : function == FUNCTION_GREEN ? colour.g : colour.b;
    return function == FUNCTION_RED || function == FUNCTION_GREEN || function == FUNCTION_BLUE;
}

struct colour texture_map_colour(const struct texture_operation *map, struct colour of) {
    double component;
    if (texture_map_component(map, of, &component))
        return colour_all(component);
    return colour_make(texture_map_number(map, of.r), texture_map_number(map, of.g), texture_map_number(map, of.b));
}

/* --- without a hit --- */

static struct colour larger(struct colour a, struct colour b) {
    return colour_make(math_max(a.r, b.r), math_max(a.g, b.g), math_max(a.b, b.b));
}

static struct colour estimate_image(const struct texture_image *image, struct colour under,
                                    enum texture_estimate which) {
    struct colour tint = image->apart ? image->tint : colour_all(1);
    if (which == TEXTURE_LARGEST_TEXEL) {
        struct rgba texel = image_largest(image->image);
        tint = colour_mul(tint, colour_make(texel.r, texel.g, texel.b));
        if (texel.a >= 1)
            return tint;
    }
    if (which != TEXTURE_AVERAGE)
        return larger(tint, under);
    struct rgba mean_texel = image_lookup(image->image, (struct image_point){0.5, 0.5, 1, 1},
                                          (struct image_sampling){IMAGE_MIPMAP, IMAGE_CLAMP, IMAGE_CLAMP});
    struct colour colour = colour_mul(colour_make(mean_texel.r, mean_texel.g, mean_texel.b), tint);
    return colour_add(colour, colour_scale(under, image->alpha == ALPHA_COVERS ? 1 - mean_texel.a : 0));
}

struct colour texture_operation_estimate(const struct texture_operation *operation,
                                         const struct colour parts[TEXTURE_PARTS], const struct phong *numbers,
                                         enum texture_estimate which) {
    bool largest = which != TEXTURE_AVERAGE;
    switch (operation->kind) {
    case TEXTURE_CONSTANT:
        return operation->constant.colour;
    case TEXTURE_PARAMETER:
        return texture_parameter_colour(operation->parameter, numbers);
    case TEXTURE_VERTEX_COLOUR:
        return colour_all(1);
    case TEXTURE_IMAGE:
        return estimate_image(&operation->image, parts[0], which);
    case TEXTURE_MARBLE:
    case TEXTURE_WOOD:
        return colour_all(largest ? 1 : 0.5);
    case TEXTURE_MIX: {
        struct colour a = parts[PART_A], b = parts[PART_B], r = parts[PART_RATIO];
        double ratio = (r.r + r.g + r.b) / 3;
        return largest ? larger(a, b) : colour_add(colour_scale(a, ratio), colour_scale(b, 1 - ratio));
    }
    case TEXTURE_MULTIPLY:
        return colour_mul(parts[PART_A], parts[PART_B]);
    case TEXTURE_MAP: {
        double component;
        bool is_component = texture_map_component(operation, parts[0], &component);
        return largest && !is_component ? colour_all(1) : texture_map_colour(operation, parts[0]);
    }
    case TEXTURE_FUNCTION:
        return largest ? operation->recorded.largest : operation->recorded.average;
    }
    return colour_all(0);
}

struct colour texture_estimate(const struct texture *texture, const struct phong *numbers,
                               enum texture_estimate which) {
    struct colour parts[TEXTURE_PARTS] = {{0, 0, 0}};
    for (int k = 0; k < texture_part_count(texture->operation.kind); k++)
        if (texture->parts[k])
            parts[k] = texture_estimate(texture->parts[k], numbers, which);
    return texture_operation_estimate(&texture->operation, parts, numbers, which);
}

struct transfer_function texture_image_transfer(const struct texture_image *lookup, bool colour) {
    if (lookup->gamma > 0)
        return (struct transfer_function){TRANSFER_POWER, lookup->gamma};
    switch (lookup->encoding) {
    case ENCODING_AUTO:
        break;
    case ENCODING_SRGB:
        return (struct transfer_function){TRANSFER_SRGB, 0};
    case ENCODING_LINEAR:
        return (struct transfer_function){TRANSFER_POWER, 1};
    }
    return colour ? image_colour_transfer(lookup->image) : (struct transfer_function){TRANSFER_UNSTATED, 0};
}
