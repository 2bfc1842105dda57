/* Making and evaluating lists of instructions. Textures below are read, then changed, as if each texture were painted
 * over those below; the order in which parts are evaluated changes no bit. A subtree is a range of the list of its
 * tree, so a texture that is a part of one that was listed before needs no instructions of its own, and a list that has
 * just been made is continued by a texture over it. */
#include "material/texture_tables.h"

#include "base/mem.h"
#include "material/texture_function_internal.h"
#include "material/texture_mapping_internal.h"
#include "math/noise.h"

#include <stddef.h>
#include <string.h>

/* --- making --- */

/* The parts that there are, from the one that needs the most values on; returns their number. */
static int order_parts(const struct texture *texture, int order[TEXTURE_PARTS]) {
    int count = 0;
    for (int k = 0; k < texture_part_count(texture->operation.kind); k++) {
        int at = count;
        if (!texture->parts[k])
            continue;
        for (count++; at > 0 && texture->parts[order[at - 1]]->depth < texture->parts[k]->depth; at--)
            order[at] = order[at - 1];
        order[at] = k;
    }
    return count;
}

uint8_t texture_depth(const struct texture *texture) {
    int order[TEXTURE_PARTS], count = order_parts(texture, order), depth = 1;
    for (int i = 0; i < count; i++) {
        int needed = texture->parts[order[i]]->depth + i;
        depth = needed > depth ? needed : depth;
    }
    return (uint8_t)(depth < UINT8_MAX ? depth : UINT8_MAX);
}

/* Room for `more` elements. */
static void *grow(void *array, uint32_t count, size_t more, uint32_t *capacity, size_t size) {
    size_t wanted = *capacity ? (size_t)*capacity * 2 : 64;
    if (*capacity - count >= more)
        return array;
    wanted = wanted < count + more ? count + more : wanted;
    void *grown = wanted < TEXTURE_NONE ? mem_resize_array(array, wanted, size) : NULL;
    *capacity = grown ? (uint32_t)wanted : *capacity;
    return grown;
}

#define GROW(builder, name, names, more)                                                                               \
    grow((builder)->names, (builder)->name##count, more, &(builder)->name##capacity, sizeof *(builder)->names)

uint32_t texture_builder_index(const struct texture_builder *builder, const struct texture *texture) {
    return *key_map_find(&builder->indices, (uintptr_t)texture);
}

/* The texture gets an index, after all below it. */
static bool number(struct texture_builder *builder, const struct texture *texture) {
    if (key_map_find(&builder->indices, (uintptr_t)texture))
        return true;
    for (int k = 0; k < TEXTURE_PARTS; k++)
        if (texture->parts[k] && !number(builder, texture->parts[k]))
            return false;
    struct built_texture *textures = GROW(builder, , textures, 1);
    if (!textures)
        return false;
    builder->textures = textures;
    if (!key_map_add(&builder->indices, (uintptr_t)texture, builder->count))
        return false;
    textures[builder->count++] = (struct built_texture){.authored = texture};
    return true;
}

static bool append(struct texture_builder *builder, const struct texture_instruction *from, uint32_t count) {
    struct texture_instruction *list = GROW(builder, instruction_, instructions, count);
    if (!list)
        return false;
    builder->instructions = list;
    memcpy(list + builder->instruction_count, from, count * sizeof *from);
    builder->instruction_count += count;
    return true;
}

/* Appends what is listed already, unless the program that begins here can begin there. */
static bool append_again(struct texture_builder *builder, struct texture_program listed) {
    if (builder->start == builder->instruction_count && listed.first + listed.count == builder->start) {
        builder->start = listed.first;
        return true;
    }
    struct texture_instruction *list = GROW(builder, instruction_, instructions, listed.count);
    if (!list)
        return false;
    builder->instructions = list;
    return append(builder, list + listed.first, listed.count);
}

/* Whether a part is read as a number, if the texture is or is not. */
static bool part_is_number(const struct texture *texture, int part, bool is_number) {
    double ignored;
    if (texture->operation.kind == TEXTURE_MIX && part == PART_RATIO)
        return true;
    return is_number && !(texture->operation.kind == TEXTURE_MAP &&
                          texture_map_component(&texture->operation, colour_all(0), &ignored));
}

/* Appends the instructions of a texture that has an index. */
static bool list(struct texture_builder *builder, const struct texture *texture, bool is_number) {
    struct texture_instruction instruction = {.texture = texture_builder_index(builder, texture),
                                              .kind = (uint8_t)texture->operation.kind,
                                              .is_number = is_number};
    struct texture_program *listed = &builder->textures[instruction.texture].instructions[is_number];
    int order[TEXTURE_PARTS], count = order_parts(texture, order);
    if (listed->count > 0)
        return append_again(builder, *listed);
    bool begins = builder->start == builder->instruction_count;
    uint32_t first = builder->instruction_count;
    unsigned positions = (unsigned)count << 2 * TEXTURE_PARTS;
    if (texture->shared) {
        instruction.action = ACTION_RECALL;
        if (!append(builder, &instruction, 1))
            return false;
    }
    for (int i = 0; i < count; i++) {
        positions |= (unsigned)(count - i) << 2 * order[i];
        if (!list(builder, texture->parts[order[i]], part_is_number(texture, order[i], is_number)))
            return false;
    }
    instruction.action = ACTION_APPLY;
    instruction.positions = (uint8_t)positions;
    if (!append(builder, &instruction, 1))
        return false;
    if (texture->shared) {
        instruction.action = ACTION_KEEP;
        if (!append(builder, &instruction, 1))
            return false;
    }
    first = begins ? builder->start : first;
    *listed = (struct texture_program){first, builder->instruction_count - first};
    return true;
}

bool texture_builder_add(struct texture_builder *builder, const struct texture *texture, bool is_number,
                         uint32_t *out) {
    if (!number(builder, texture))
        return false;
    struct built_texture *built = &builder->textures[texture_builder_index(builder, texture)];
    if (built->programs[is_number] == 0) {
        struct texture_program *programs = GROW(builder, program_, programs, 1);
        if (!programs)
            return false;
        builder->programs = programs;
        builder->start = builder->instruction_count;
        if (built->instructions[is_number].count == 0 && !list(builder, texture, is_number))
            return false;
        programs[builder->program_count++] = built->instructions[is_number];
        built->programs[is_number] = builder->program_count;
    }
    *out = built->programs[is_number] - 1;
    return true;
}

void texture_builder_mark_colours(struct texture_builder *builder, const struct texture *texture) {
    struct built_texture *built = &builder->textures[texture_builder_index(builder, texture)];
    if (built->is_colour)
        return;
    built->is_colour = true;
    for (int k = 0; k < texture_colour_parts(texture->operation.kind); k++)
        if (texture->parts[k])
            texture_builder_mark_colours(builder, texture->parts[k]);
}

static void *copy(struct arena *arena, const void *from, uint32_t count, size_t size) {
    void *out = arena_alloc_array(arena, (size_t)count + 1, size);
    if (out && count > 0)
        memcpy(out, from, count * size);
    return out;
}

bool texture_builder_finish(const struct texture_builder *builder, struct arena *arena, struct texture_tables *out) {
    bool *are_colours = arena_alloc_array(arena, (size_t)builder->count + 1, sizeof *are_colours);
    out->count = builder->count;
    out->instruction_count = builder->instruction_count;
    out->program_count = builder->program_count;
    out->operations = arena_alloc_array(arena, (size_t)builder->count + 1, sizeof *out->operations);
    out->instructions = copy(arena, builder->instructions, builder->instruction_count, sizeof *builder->instructions);
    out->programs = copy(arena, builder->programs, builder->program_count, sizeof *builder->programs);
    out->are_colours = are_colours;
    if (!are_colours || !out->operations || !out->instructions || !out->programs)
        return false;
    for (uint32_t i = 0; i < builder->count; i++) {
        out->operations[i] = builder->textures[i].authored->operation;
        are_colours[i] = builder->textures[i].is_colour;
    }
    return true;
}

void texture_builder_destroy(struct texture_builder *builder) {
    mem_free(builder->textures);
    key_map_destroy(&builder->indices);
    mem_free(builder->instructions);
    mem_free(builder->programs);
}

/* --- at a hit --- */

static double mean(struct colour colour) {
    return (colour.r + colour.g + colour.b) / 3;
}

static double parameter_number(enum material_input input, const struct phong *numbers) {
    struct colour colour = texture_parameter_colour(input, numbers);
    bool has_colour = input == INPUT_KD || input == INPUT_KS || input == INPUT_EMISSION;
    return has_colour ? mean(colour) : colour.r;
}

/* The colour of an image alone. False: the surface has no coordinates for it. */
static bool image_colour(const struct texture_image *image, const struct hit *hit, struct colour *colour,
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
        *colour = colour_all(texel.a);
        return true;
    }
    *colour = colour_scale(colour_make(texel.r, texel.g, texel.b), share);
    if (image->apart)
        *colour = colour_mul(*colour, image->tint);
    return true;
}

/* Where the picture is transparent, or ends, there is what lies below. */
static struct colour image_over(const struct texture_image *image, struct colour under, const struct hit *hit) {
    struct colour colour;
    double rest;
    if (!image_colour(image, hit, &colour, &rest))
        return under;
    return colour_add(colour, colour_scale(under, rest));
}

static double image_number_over(const struct texture_image *image, double under, const struct hit *hit) {
    struct colour colour;
    double rest;
    if (!image_colour(image, hit, &colour, &rest))
        return under;
    return (image->alpha == ALPHA_ONLY ? colour.r : mean(colour)) + under * rest;
}

static double marble_at(const struct texture_operation *operation, struct vec3 p) {
    return noise_marble(p, operation->marble.f, operation->marble.multiplier, operation->marble.vein_frequency,
                        operation->marble.interpolation);
}

static double wood_at(const struct texture_operation *operation, struct vec3 p) {
    return noise_wood(p.x, p.y, p.z, operation->wood.f, operation->wood.density, operation->wood.interpolation);
}

static unsigned position_of(const struct texture_instruction *in, int part) {
    return in->positions >> 2 * part & 3;
}

static unsigned taken_by(const struct texture_instruction *in) {
    return in->positions >> 2 * TEXTURE_PARTS;
}

/* end: of the stack of values, where the parts are. */
static struct colour part_of(const struct texture_instruction *in, int part, const struct colour *end) {
    return end[-(ptrdiff_t)position_of(in, part)];
}

static struct colour apply(const struct texture_instruction *in, const struct colour *end,
                           const struct texture_reader *reader) {
    const struct texture_operation *operation = &reader->tables->operations[in->texture];
    const struct hit *hit = reader->hit;
    switch ((enum texture_kind)in->kind) {
    case TEXTURE_CONSTANT:
        return operation->constant.colour;
    case TEXTURE_PARAMETER:
        return texture_parameter_colour(operation->parameter, reader->numbers);
    case TEXTURE_VERTEX_COLOUR:
        return hit->has_colour ? hit->colour : colour_all(1);
    case TEXTURE_IMAGE:
        return image_over(&operation->image, in->positions != 0 ? end[-1] : colour_all(0), hit);
    case TEXTURE_MARBLE:
        return colour_all(marble_at(operation, hit->pattern_point));
    case TEXTURE_WOOD:
        return colour_all(wood_at(operation, hit->pattern_point));
    case TEXTURE_MIX: {
        struct colour a = part_of(in, PART_A, end), b = part_of(in, PART_B, end);
        double ratio = part_of(in, PART_RATIO, end).r;
        return colour_add(colour_scale(a, ratio), colour_scale(b, 1 - ratio));
    }
    case TEXTURE_MULTIPLY:
        return colour_mul(part_of(in, PART_A, end), part_of(in, PART_B, end));
    case TEXTURE_MAP:
        return texture_map_colour(operation, end[-1]);
    case TEXTURE_FUNCTION:
        return texture_function_colour(operation, hit);
    }
    return colour_all(0);
}

static double apply_to_numbers(const struct texture_instruction *in, const struct colour *end,
                               const struct texture_reader *reader) {
    const struct texture_operation *operation = &reader->tables->operations[in->texture];
    const struct hit *hit = reader->hit;
    switch ((enum texture_kind)in->kind) {
    case TEXTURE_CONSTANT:
        return operation->constant.number;
    case TEXTURE_PARAMETER:
        return parameter_number(operation->parameter, reader->numbers);
    case TEXTURE_VERTEX_COLOUR:
        return hit->has_colour ? mean(hit->colour) : 1;
    case TEXTURE_IMAGE:
        return image_number_over(&operation->image, in->positions != 0 ? end[-1].r : 0, hit);
    case TEXTURE_MARBLE:
        return marble_at(operation, hit->pattern_point);
    case TEXTURE_WOOD:
        return wood_at(operation, hit->pattern_point);
    case TEXTURE_MIX: {
        double ratio = part_of(in, PART_RATIO, end).r;
        return part_of(in, PART_A, end).r * ratio + part_of(in, PART_B, end).r * (1 - ratio);
    }
    case TEXTURE_MULTIPLY:
        return part_of(in, PART_A, end).r * part_of(in, PART_B, end).r;
    case TEXTURE_MAP: {
        double component;
        return texture_map_component(operation, end[-1], &component) ? component
                                                                     : texture_map_number(operation, end[-1].r);
    }
    case TEXTURE_FUNCTION: {
        struct colour colour = texture_function_colour(operation, hit);
        return operation->recorded.program->output_count == 1 ? colour.r : mean(colour);
    }
    }
    return 0;
}

/* The known value of a shared texture, or NULL. */
static const struct colour *recall(const struct texture_reader *reader, const struct texture_instruction *in) {
    for (int i = 0; i < reader->count; i++)
        if (reader->known[i].texture == in->texture && reader->known[i].is_number == in->is_number)
            return &reader->known[i].value;
    return NULL;
}

static void keep(struct texture_reader *reader, const struct texture_instruction *in, struct colour value) {
    if (reader->count == TEXTURE_SHARED)
        return;
    reader->known[reader->count].texture = in->texture;
    reader->known[reader->count].is_number = in->is_number;
    reader->known[reader->count++].value = value;
}

struct colour texture_read(uint32_t program, struct texture_reader *reader) {
    struct texture_program range = reader->tables->programs[program];
    const struct texture_instruction *in = &reader->tables->instructions[range.first], *last = in + range.count;
    struct colour values[TEXTURE_DEPTH], *end = values;
    for (; in < last; in++) {
        const struct colour *known = in->action == ACTION_RECALL ? recall(reader, in) : NULL;
        if (in->action == ACTION_APPLY) {
            struct colour value =
                in->is_number ? colour_all(apply_to_numbers(in, end, reader)) : apply(in, end, reader);
            end -= taken_by(in);
            *end++ = value;
        } else if (in->action == ACTION_KEEP) {
            keep(reader, in, end[-1]);
        } else if (known) {
            *end++ = *known;
            for (uint32_t texture = in->texture; in->action != ACTION_KEEP || in->texture != texture;)
                in++;
        }
    }
    return values[0];
}

struct colour texture_program_estimate(const struct texture_tables *tables, uint32_t program,
                                       const struct phong *numbers, enum texture_estimate which) {
    struct texture_program range = tables->programs[program];
    const struct texture_instruction *in = &tables->instructions[range.first], *last = in + range.count;
    struct colour values[TEXTURE_DEPTH], *end = values;
    for (; in < last; in++) {
        struct colour parts[TEXTURE_PARTS] = {{0, 0, 0}};
        if (in->action != ACTION_APPLY)
            continue;
        for (int k = 0; k < TEXTURE_PARTS; k++)
            if (position_of(in, k) > 0)
                parts[k] = part_of(in, k, end);
        end -= taken_by(in);
        *end++ = texture_operation_estimate(&tables->operations[in->texture], parts, numbers, which);
    }
    return values[0];
}

bool texture_tables_met_nan(const struct texture_tables *tables) {
    bool met = false;
    for (uint32_t i = 0; i < tables->count && !met; i++) {
        const struct texture_operation *operation = &tables->operations[i];
        struct texture_nan *nan = operation->kind == TEXTURE_FUNCTION ? operation->recorded.nan : NULL;
        if (!nan)
            continue;
        while (atomic_flag_test_and_set_explicit(&nan->lock, memory_order_acquire))
            continue;
        met = nan->found;
        atomic_flag_clear_explicit(&nan->lock, memory_order_release);
    }
    return met;
}

static void bundle_operation(struct bundle *bundle, void *texture_operation) {
    struct texture_operation *operation = texture_operation;
    if (operation->kind == TEXTURE_IMAGE)
        image_bundle(bundle, &operation->image.image);
    if (operation->kind != TEXTURE_FUNCTION)
        return;
    BUNDLE(bundle, operation->recorded.program, 1, expr_program_bundle);
    BUNDLE(bundle, operation->recorded.nan, 1, NULL);
}

void texture_tables_bundle(struct bundle *bundle, void *texture_tables) {
    struct texture_tables *tables = texture_tables;
    BUNDLE(bundle, tables->operations, tables->count, bundle_operation);
    BUNDLE(bundle, tables->are_colours, tables->count, NULL);
    BUNDLE(bundle, tables->instructions, tables->instruction_count, NULL);
    BUNDLE(bundle, tables->programs, tables->program_count, NULL);
}
