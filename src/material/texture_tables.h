/* Textures of a world: lists of instructions in postfix order, evaluated in a loop with a small stack of values. A
 * table holds each distinct authored texture once; the instructions refer to it by index. A program is a range of the
 * instructions and reads one texture as a colour or as a number; programs share instructions where one is a part of
 * another.
 *
 * Of the parts of an operation the one that needs the most values is evaluated first: while a later one is evaluated,
 * one more value waits (R. Sethi and J. D. Ullman, "The generation of optimal code for arithmetic expressions", JACM
 * 1970). Needs d1 >= d2 >= d3 of the parts become max(d1, d2 + 1, d3 + 2). The smallest tree S(d) that needs d values
 * has a part that needs d, or two parts that need d - 1, or three that need d - 2, so S(d) = 1 + min(2 S(d - 1),
 * 3 S(d - 2)) with S(1) = 1, S(2) = 3: 4, 9, 13, 27, 40, 81 ..., S(2 n) = 3^n. S(18) = 3^9 = 19,683 is more than
 * TEXTURE_SIZE, so TEXTURE_DEPTH values are enough for every tree. */
#ifndef GRAY_MATERIAL_TEXTURE_TABLES_H
#define GRAY_MATERIAL_TEXTURE_TABLES_H

#include "base/bundle.h"
#include "base/key_map.h"
#include "material/texture.h"

enum { TEXTURE_DEPTH = 17 };
#define TEXTURE_NONE UINT32_MAX /* in place of a program, or of an index */

/* APPLY: the operation takes its parts off the stack and puts its value there. Around the instructions of a shared
 * texture, RECALL puts a known value there and goes on after KEEP, which makes the value known. */
enum texture_action { ACTION_APPLY, ACTION_RECALL, ACTION_KEEP };
struct texture_instruction {
    uint32_t texture; /* its index in the table */
    uint8_t action, kind;
    bool is_number; /* the value is a number */
    /* Two bits for each part, its position below the end of the stack, from 1, or 0 if there is none; then the number
     * of values that are taken off the stack. */
    uint8_t positions;
};
_Static_assert(sizeof(struct texture_instruction) == 8, "lists of instructions are small");
struct texture_program {
    uint32_t first, count;
};
struct texture_tables {
    struct texture_operation *operations;
    const bool *are_colours; /* those that are read as colours: their pictures are decoded in linear colours */
    const struct texture_instruction *instructions;
    const struct texture_program *programs;
    uint32_t count; /* of operations */
    uint32_t instruction_count, program_count;
};

/* The values that are known at a time while the texture is evaluated, from those of its parts. */
uint8_t texture_depth(const struct texture *texture);

/* Reads several programs at one hit; values of `shared` textures are computed once. */
enum { TEXTURE_SHARED = 4 };
struct texture_reader {
    const struct hit *hit;
    const struct texture_tables *tables;
    const struct phong *numbers; /* of the material, for TEXTURE_PARAMETER; NULL: white */
    int count;                   /* of values that are known */
    struct {
        uint32_t texture;
        bool is_number;
        struct colour value;
    } known[TEXTURE_SHARED];
};

static inline void texture_reader_init(struct texture_reader *reader, const struct hit *hit,
                                       const struct texture_tables *tables, const struct phong *numbers) {
    reader->hit = hit;
    reader->tables = tables;
    reader->numbers = numbers;
    reader->count = 0;
}
/* The value of a program; of one that reads a number, x is it. */
struct colour texture_read(uint32_t program, struct texture_reader *reader);

/* The estimate of a program that reads a colour. */
struct colour texture_program_estimate(const struct texture_tables *tables, uint32_t program,
                                       const struct phong *numbers, enum texture_estimate which);

/* Makes tables of authored textures. Zero-initialise; texture_builder_destroy frees its memory. */
struct texture_builder {
    /* The distinct textures in order of first use, parts before their readers, and their instructions. */
    struct built_texture {
        const struct texture *authored;
        struct texture_program instructions[2]; /* by is_number; of count 0: none yet */
        uint32_t programs[2];                   /* + 1 */
        bool is_colour;
    } * textures;
    struct key_map indices; /* by address, which decides the position of an entry and never its index */
    struct texture_instruction *instructions;
    struct texture_program *programs;
    uint32_t count, capacity, instruction_count, instruction_capacity, program_count, program_capacity;
    uint32_t start; /* of the program that is being made */
};
/* The program that reads the texture as a number or as a colour. False: no memory. */
bool texture_builder_add(struct texture_builder *builder, const struct texture *texture, bool is_number, uint32_t *out);
/* The texture, which was added, and its parts as far as they are, are colours. */
void texture_builder_mark_colours(struct texture_builder *builder, const struct texture *texture);
/* The index of a texture that was added. */
uint32_t texture_builder_index(const struct texture_builder *builder, const struct texture *texture);
/* False: no memory. */
bool texture_builder_finish(const struct texture_builder *builder, struct arena *arena, struct texture_tables *out);
void texture_builder_destroy(struct texture_builder *builder);
/* Whether a function has been NaN somewhere, as its `nan` says. */
bool texture_tables_met_nan(const struct texture_tables *tables);
/* What it points to (base/bundle.h). */
bundle_fields texture_tables_bundle;

#endif
