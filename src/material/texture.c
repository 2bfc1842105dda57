/* Evaluating trees of textures. The order of operations is part of the pictures: textures below are read first, then
 * changed, as if each texture were painted over those below. */
#include "material/texture.h"

#include "material/texture_function_internal.h"
#include "material/texture_mapping_internal.h"
#include "math/noise.h"

/* --- values --- */

struct texture texture_constant(struct vec3 colour) {
    return (struct texture){
        .kind = TEXTURE_CONSTANT, .size = 1, .constant = {colour, (colour.x + colour.y + colour.z) / 3, false}};
}

struct texture texture_display_colour(struct vec3 colour) {
    struct texture texture = texture_constant(colour);
    texture.constant.display = true;
    return texture;
}

struct texture texture_number(double number) {
    return (struct texture){.kind = TEXTURE_CONSTANT, .size = 1, .constant = {vec3_all(number), number, false}};
}

struct texture texture_vertex_colour(void) {
    return (struct texture){.kind = TEXTURE_VERTEX_COLOUR, .size = 1};
}

struct texture texture_marble(double f, double multiplier, double vein_frequency, int interpolation) {
    return (struct texture){
        .kind = TEXTURE_MARBLE, .size = 1, .marble = {f, multiplier, vein_frequency, interpolation}};
}

struct texture texture_wood(double f, double density, int interpolation) {
    return (struct texture){.kind = TEXTURE_WOOD, .size = 1, .wood = {f, density, interpolation}};
}

/* The size of a tree whose root has these parts (or NULL); sizes above TEXTURE_SIZE count as TEXTURE_SIZE + 1. */
static struct texture over(enum texture_kind kind, const struct texture *a, const struct texture *b,
                           const struct texture *c) {
    const struct texture *const below[] = {a, b, c};
    struct texture out = {.kind = kind, .size = 1};
    for (int i = 0; i < 3; i++) {
        if (!below[i])
            continue;
        out.size += below[i]->size;
        out.has_image = out.has_image || below[i]->has_image;
        out.has_function = out.has_function || below[i]->has_function;
    }
    out.size = out.size > TEXTURE_SIZE ? TEXTURE_SIZE + 1 : out.size;
    return out;
}

struct texture texture_image(const struct texture_image *image, const struct texture *below) {
    struct texture out = over(TEXTURE_IMAGE, below, NULL, NULL);
    out.has_image = true;
    out.image.lookup = *image;
    out.image.below.authored = below;
    return out;
}

struct texture texture_mix(const struct texture *a, const struct texture *b, const struct texture *ratio) {
    struct texture out = over(TEXTURE_MIX, a, b, ratio);
    out.mix.a.authored = a;
    out.mix.b.authored = b;
    out.mix.ratio.authored = ratio;
    return out;
}

struct texture texture_multiply(const struct texture *a, const struct texture *b) {
    struct texture out = over(TEXTURE_MULTIPLY, a, b, NULL);
    out.multiply.a.authored = a;
    out.multiply.b.authored = b;
    return out;
}

struct texture texture_map(const struct texture *of, enum texture_function function, double amount) {
    struct texture out = over(TEXTURE_MAP, of, NULL, NULL);
    out.map.of.authored = of;
    out.map.function = function;
    out.map.amount = amount;
    return out;
}

struct texture texture_function(const struct expr_program *program, bool has_coordinates, struct vec3 average,
                                struct vec3 largest) {
    return (struct texture){.kind = TEXTURE_FUNCTION,
                            .size = 1,
                            .has_image = has_coordinates,
                            .has_function = true,
                            .recorded = {.program = program,
                                         .source = "",
                                         .mapping = MAPPING_BY_SHAPE,
                                         .points = FUNCTION_POINTS,
                                         .average = average,
                                         .largest = largest}};
}

const struct texture *texture_parameter(enum material_input input) {
#define PARAMETER(input, ...) [input] = {.kind = TEXTURE_PARAMETER, .size = 1, .parameter = (input)},
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

int texture_parts(struct texture *texture, union texture_ref *parts[TEXTURE_PARTS]) {
    switch (texture->kind) {
    case TEXTURE_CONSTANT:
    case TEXTURE_PARAMETER:
    case TEXTURE_VERTEX_COLOUR:
    case TEXTURE_MARBLE:
    case TEXTURE_WOOD:
    case TEXTURE_FUNCTION:
        return 0;
    case TEXTURE_IMAGE:
        parts[0] = &texture->image.below;
        return 1;
    case TEXTURE_MIX:
        parts[0] = &texture->mix.a;
        parts[1] = &texture->mix.b;
        parts[2] = &texture->mix.ratio;
        return 3;
    case TEXTURE_MULTIPLY:
        parts[0] = &texture->multiply.a;
        parts[1] = &texture->multiply.b;
        return 2;
    case TEXTURE_MAP:
        parts[0] = &texture->map.of;
        return 1;
    }
    return 0;
}

int texture_colour_parts(const struct texture *texture) {
    switch (texture->kind) {
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

/* --- leaves --- */

static struct vec3 parameter_colour(enum material_input input, const struct phong *numbers) {
    if (!numbers)
        return vec3_all(1);
    switch (input) {
    case INPUT_KD:
        return numbers->kd;
    case INPUT_KS:
        return numbers->ks;
    case INPUT_SHININESS:
        return vec3_all(numbers->shininess);
    case INPUT_REFLECT:
        return vec3_all(numbers->reflect);
    case INPUT_REFRACT:
        return vec3_all(numbers->refract);
    case INPUT_ROUGHNESS:
        return vec3_all(numbers->roughness);
    case INPUT_EMISSION:
        return numbers->emission;
    case INPUT_OPACITY:
        OPENPBR_INPUTS(LIST_LABEL)
        break;
    }
    return vec3_all(1);
}

static double mean(struct vec3 colour) {
    return (colour.x + colour.y + colour.z) / 3;
}

static double parameter_number(enum material_input input, const struct phong *numbers) {
    struct vec3 colour = parameter_colour(input, numbers);
    bool has_colour = input == INPUT_KD || input == INPUT_KS || input == INPUT_EMISSION;
    return has_colour ? mean(colour) : colour.x;
}

/* The colour of an image alone. False: the surface has no coordinates for it. */
static bool texture_image_colour(const struct texture_image *image, const struct hit *hit, struct vec3 *colour,
                                 double *rest) {
    struct texcoord at;
    if (!texture_coordinates(image, hit, &at))
        return false;
    struct rgba texel = texture_texel(image, &at);
    double share = 1;
    *rest = 0;
    switch (image->alpha) {
    case ALPHA_COVERS:
        *rest = 1 - texel.a;
        break;
    case ALPHA_IGNORED:
        share = texel.a > 0 ? 1 / texel.a : 1;
        *rest = texel.a > 0 ? 0 : 1 - texel.a;
        break;
    case ALPHA_DARKENS:
        break;
    case ALPHA_STRAIGHT:
        share = texel.a > 0 ? 1 / texel.a : 0;
        break;
    case ALPHA_ONLY:
        *colour = vec3_all(texel.a);
        return true;
    }
    *colour = vec3_scale(vec3_make(texel.r, texel.g, texel.b), share);
    if (image->apart)
        *colour = vec3_mul(*colour, image->tint);
    return true;
}

static double marble_at(const struct texture *texture, struct vec3 p) {
    return noise_marble(p, texture->marble.f, texture->marble.multiplier, texture->marble.vein_frequency,
                        texture->marble.interpolation);
}

static double wood_at(const struct texture *texture, struct vec3 p) {
    return noise_wood(p.x, p.y, p.z, texture->wood.f, texture->wood.density, texture->wood.interpolation);
}

static double function_of(enum texture_function function, double amount, double x) {
    switch (function) {
    case FUNCTION_RED:
    case FUNCTION_GREEN:
    case FUNCTION_BLUE:
        return x;
    case FUNCTION_COMPLEMENT:
        return 1 - x;
    case FUNCTION_SATURATE:
        return x > 1 ? 1 : x > 0 ? x : 0;
    case FUNCTION_STEP:
        return x >= amount ? 1 : 0;
    }
    return x;
}

/* Whether the function selects one component of a colour; which. */
static bool takes_component(enum texture_function function, struct vec3 colour, double *out) {
    *out = function == FUNCTION_RED ? colour.x : function == FUNCTION_GREEN ? colour.y : colour.z;
    return function == FUNCTION_RED || function == FUNCTION_GREEN || function == FUNCTION_BLUE;
}

/* --- trees --- */

static struct vec3 part_colour(union texture_ref part, struct texture_reader *reader) {
    return texture_read_colour(texture_at(reader->textures, part), reader);
}

static double part_scalar(union texture_ref part, struct texture_reader *reader) {
    return texture_read_scalar(texture_at(reader->textures, part), reader);
}

static struct vec3 evaluate_colour(const struct texture *texture, struct texture_reader *reader) {
    switch (texture->kind) {
    case TEXTURE_CONSTANT:
        return texture->constant.colour;
    case TEXTURE_PARAMETER:
        return parameter_colour(texture->parameter, reader->numbers);
    case TEXTURE_VERTEX_COLOUR:
        return reader->hit->has_colour ? reader->hit->colour : vec3_all(1);
    case TEXTURE_IMAGE: {
        /* Where the picture is transparent, or ends, there is what lies below. */
        const struct texture *below = texture_at(reader->textures, texture->image.below);
        struct vec3 colour, under = below ? texture_read_colour(below, reader) : vec3_all(0);
        double rest;
        if (!texture_image_colour(&texture->image.lookup, reader->hit, &colour, &rest))
            return under;
        return vec3_add(colour, vec3_scale(under, rest));
    }
    case TEXTURE_MARBLE:
        return vec3_all(marble_at(texture, reader->hit->pattern_point));
    case TEXTURE_WOOD:
        return vec3_all(wood_at(texture, reader->hit->pattern_point));
    case TEXTURE_MIX: {
        struct vec3 a = part_colour(texture->mix.a, reader);
        double ratio = part_scalar(texture->mix.ratio, reader);
        struct vec3 b = part_colour(texture->mix.b, reader);
        return vec3_add(vec3_scale(a, ratio), vec3_scale(b, 1 - ratio));
    }
    case TEXTURE_MULTIPLY: {
        struct vec3 a = part_colour(texture->multiply.a, reader);
        return vec3_mul(a, part_colour(texture->multiply.b, reader));
    }
    case TEXTURE_MAP: {
        struct vec3 of = part_colour(texture->map.of, reader);
        enum texture_function function = texture->map.function;
        double component, amount = texture->map.amount;
        if (takes_component(function, of, &component))
            return vec3_all(component);
        return vec3_make(function_of(function, amount, of.x), function_of(function, amount, of.y),
                         function_of(function, amount, of.z));
    }
    case TEXTURE_FUNCTION:
        return texture_function_colour(texture, reader->hit);
    }
    return vec3_all(0);
}

static double evaluate_scalar(const struct texture *texture, struct texture_reader *reader) {
    switch (texture->kind) {
    case TEXTURE_CONSTANT:
        return texture->constant.number;
    case TEXTURE_PARAMETER:
        return parameter_number(texture->parameter, reader->numbers);
    case TEXTURE_VERTEX_COLOUR:
        return reader->hit->has_colour ? mean(reader->hit->colour) : 1;
    case TEXTURE_IMAGE: {
        const struct texture *below = texture_at(reader->textures, texture->image.below);
        struct vec3 colour;
        double rest, under = below ? texture_read_scalar(below, reader) : 0;
        if (!texture_image_colour(&texture->image.lookup, reader->hit, &colour, &rest))
            return under;
        return (texture->image.lookup.alpha == ALPHA_ONLY ? colour.x : mean(colour)) + under * rest;
    }
    case TEXTURE_MARBLE:
        return marble_at(texture, reader->hit->pattern_point);
    case TEXTURE_WOOD:
        return wood_at(texture, reader->hit->pattern_point);
    case TEXTURE_MIX: {
        double a = part_scalar(texture->mix.a, reader), ratio = part_scalar(texture->mix.ratio, reader);
        return a * ratio + part_scalar(texture->mix.b, reader) * (1 - ratio);
    }
    case TEXTURE_MULTIPLY: {
        double a = part_scalar(texture->multiply.a, reader);
        return a * part_scalar(texture->multiply.b, reader);
    }
    case TEXTURE_MAP: {
        enum texture_function function = texture->map.function;
        double component;
        if (function == FUNCTION_RED || function == FUNCTION_GREEN || function == FUNCTION_BLUE) {
            (void)takes_component(function, part_colour(texture->map.of, reader), &component);
            return component;
        }
        return function_of(function, texture->map.amount, part_scalar(texture->map.of, reader));
    }
    case TEXTURE_FUNCTION: {
        struct vec3 colour = texture_function_colour(texture, reader->hit);
        return texture->recorded.program->output_count == 1 ? colour.x : mean(colour);
    }
    }
    return 0;
}

/* The cached value of a shared texture, or -1. */
static int known(const struct texture_reader *reader, const struct texture *texture, bool is_number) {
    for (int i = 0; i < reader->count; i++)
        if (reader->known[i].of == texture && reader->known[i].is_number == is_number)
            return i;
    return -1;
}

static void remember(struct texture_reader *reader, const struct texture *texture, bool is_number, struct vec3 value) {
    if (reader->count == TEXTURE_SHARED)
        return;
    reader->known[reader->count].of = texture;
    reader->known[reader->count].is_number = is_number;
    reader->known[reader->count++].value = value;
}

struct vec3 texture_read_colour(const struct texture *texture, struct texture_reader *reader) {
    if (!texture->shared)
        return evaluate_colour(texture, reader);
    int at = known(reader, texture, false);
    if (at >= 0)
        return reader->known[at].value;
    struct vec3 colour = evaluate_colour(texture, reader);
    remember(reader, texture, false, colour);
    return colour;
}

double texture_read_scalar(const struct texture *texture, struct texture_reader *reader) {
    if (!texture->shared)
        return evaluate_scalar(texture, reader);
    int at = known(reader, texture, true);
    if (at >= 0)
        return reader->known[at].value.x;
    double number = evaluate_scalar(texture, reader);
    remember(reader, texture, true, vec3_all(number));
    return number;
}

/* --- without a hit --- */

static struct vec3 larger(struct vec3 a, struct vec3 b) {
    return vec3_make(fmax(a.x, b.x), fmax(a.y, b.y), fmax(a.z, b.z));
}

static struct vec3 estimate_image(const struct texture *texture, const struct texture *textures,
                                  const struct phong *numbers, enum texture_estimate which) {
    const struct texture_image *image = &texture->image.lookup;
    const struct texture *below = texture_at(textures, texture->image.below);
    struct vec3 tint = image->apart ? image->tint : vec3_all(1);
    struct vec3 under = below ? texture_estimate(below, textures, numbers, which) : vec3_all(0);
    if (which == TEXTURE_LARGEST_TEXEL) {
        struct rgba texel = image_largest(image->image);
        tint = vec3_mul(tint, vec3_make(texel.r, texel.g, texel.b));
        if (texel.a >= 1)
            return tint;
    }
    if (which != TEXTURE_AVERAGE)
        return larger(tint, under);
    struct rgba mean_texel = image_lookup(image->image, (struct image_point){0.5, 0.5, 1, 1},
                                          (struct image_sampling){IMAGE_MIPMAP, IMAGE_CLAMP, IMAGE_CLAMP});
    struct vec3 colour = vec3_mul(vec3_make(mean_texel.r, mean_texel.g, mean_texel.b), tint);
    return vec3_add(colour, vec3_scale(under, image->alpha == ALPHA_COVERS ? 1 - mean_texel.a : 0));
}

struct vec3 texture_estimate(const struct texture *texture, const struct texture *textures, const struct phong *numbers,
                             enum texture_estimate which) {
    bool largest = which != TEXTURE_AVERAGE;
    switch (texture->kind) {
    case TEXTURE_CONSTANT:
        return texture->constant.colour;
    case TEXTURE_PARAMETER:
        return parameter_colour(texture->parameter, numbers);
    case TEXTURE_VERTEX_COLOUR:
        return vec3_all(1);
    case TEXTURE_IMAGE:
        return estimate_image(texture, textures, numbers, which);
    case TEXTURE_MARBLE:
    case TEXTURE_WOOD:
        return vec3_all(largest ? 1 : 0.5);
    case TEXTURE_MIX: {
        struct vec3 a = texture_estimate(texture_at(textures, texture->mix.a), textures, numbers, which);
        struct vec3 b = texture_estimate(texture_at(textures, texture->mix.b), textures, numbers, which);
        double ratio = mean(texture_estimate(texture_at(textures, texture->mix.ratio), textures, numbers, which));
        return largest ? larger(a, b) : vec3_add(vec3_scale(a, ratio), vec3_scale(b, 1 - ratio));
    }
    case TEXTURE_MULTIPLY:
        return vec3_mul(texture_estimate(texture_at(textures, texture->multiply.a), textures, numbers, which),
                        texture_estimate(texture_at(textures, texture->multiply.b), textures, numbers, which));
    case TEXTURE_MAP: {
        struct vec3 of = texture_estimate(texture_at(textures, texture->map.of), textures, numbers, which);
        enum texture_function function = texture->map.function;
        double component, amount = texture->map.amount;
        if (takes_component(function, of, &component))
            return vec3_all(component);
        if (largest)
            return vec3_all(1);
        return vec3_make(function_of(function, amount, of.x), function_of(function, amount, of.y),
                         function_of(function, amount, of.z));
    }
    case TEXTURE_FUNCTION:
        return largest ? texture->recorded.largest : texture->recorded.average;
    }
    return vec3_all(0);
}
