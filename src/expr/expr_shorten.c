/* One pass backwards over the program. It keeps the new register of every old one that is still needed, and renames,
 * frees and drops at the same time. A min, max or selection that is decided disappears: its selected operand gets
 * its register. A copy remains only if another instruction needs that operand too, or if it is a constant.
 *
 * Folding goes forwards before that pass: an operation on constants whose result is among the constants of the program
 * is that constant, and x * 1, x / 1, x - 0 and x + -0 are x. So the rest of a smooth minimum beyond its width ends. */
#include "expr/expr_shorten.h"

#include "expr/expr_link_internal.h"

#include <string.h>

enum { UNWANTED = 0xffff };

/* Whether an operation reads each operand. */
#define READS(member, name, R, A, B, C, expression) [member] = {EXPR_HAS_##A, EXPR_HAS_##B, EXPR_HAS_##C},
#define LOOP_READS(member, name, R, A, B, C) [member] = {EXPR_HAS_##A, EXPR_HAS_##B, EXPR_HAS_##C},
static const uint8_t reads[EXPR_ALL_OPERATIONS][3] = {EXPR_OPERATIONS(READS) EXPR_LOOP_OPERATIONS(LOOP_READS)};

struct renaming {
    uint16_t *renamed, *unused; /* of old registers, UNWANTED where none; registers that are free */
    uint32_t unused_count, register_count, first;
    unsigned is_first; /* the register that was wanted last was not wanted before */
};

/* The new register or constant of an old value that is read. */
static inline uint16_t want(struct renaming *r, uint16_t value) {
    if (value < r->first)
        return value;
    uint16_t *to = &r->renamed[value - r->first];
    r->is_first = *to == UNWANTED;
    if (r->is_first)
        *to = r->unused_count ? r->unused[--r->unused_count] : (uint16_t)(r->first + r->register_count++);
    return *to;
}

/* The memory of a shortening; the code comes first, because it is aligned most. */
size_t expr_shorten_size(const struct expr_program *program) {
    return program->count * sizeof(struct expr_instruction) +
           ((size_t)program->register_count + 1) * 3 * sizeof(uint16_t);
}

static bool is_selection(uint16_t operation) {
    return operation == EXPR_SELECT || operation == EXPR_INTEGER_SELECT || operation == EXPR_TRUTH_SELECT;
}

/* The operand that is selected. */
static inline uint16_t taken_operand(const struct expr_instruction *in, bool first) {
    if (is_selection(in->operation))
        return first ? in->b : in->c;
    return first ? in->a : in->b;
}

/* An operation that returns its operand, of the same type. */
static struct expr_instruction copy_of(const struct expr_instruction *in, uint16_t from) {
    enum expr_operation operation = (enum expr_operation)in->operation;
    if (operation == EXPR_INTEGER_SELECT)
        return (struct expr_instruction){EXPR_BIT_AND, in->out, from, from, in->out, 0};
    if (operation == EXPR_TRUTH_SELECT)
        return (struct expr_instruction){EXPR_TRUTH_SELECT, in->out, from, from, from, 0};
    return (struct expr_instruction){EXPR_COPY, in->out, from, in->out, in->out, 0};
}

/* --- folding --- */

static uint16_t find_constant(const struct expr_program *program, union expr_value value) {
    for (uint32_t k = 0; k < program->constant_count; k++)
        if (program->constants[k].i == value.i)
            return (uint16_t)k;
    return UNWANTED;
}

/* The constant that an operation on constants is, or UNWANTED. */
static uint16_t result_of_constants(const struct expr_program *program, const struct expr_instruction *in) {
    const uint16_t operands[3] = {in->a, in->b, in->c};
    union expr_value values[3] = {{.i = 0}, {.i = 0}, {.i = 0}};
    if (in->operation >= EXPR_OPERATION_COUNT || in->operation == EXPR_TEXEL)
        return UNWANTED;
    for (int k = 0; k < 3; k++) {
        if (reads[in->operation][k] && operands[k] >= program->constant_count)
            return UNWANTED;
        if (reads[in->operation][k])
            values[k] = program->constants[operands[k]];
    }
    return find_constant(program, expr_apply((enum expr_operation)in->operation, values[0], values[1], values[2]));
}

static bool is_number(const struct expr_program *program, uint16_t value, double number) {
    const union expr_value bits = {.f = number};
    return value < program->constant_count && program->constants[value].i == bits.i;
}

/* The operand that the result is equal to, or UNWANTED. */
static uint16_t equal_operand(const struct expr_program *program, const struct expr_instruction *in) {
    switch (in->operation) { /* no list: few operations have such operands */
    case EXPR_COPY:
        return in->a;
    case EXPR_ADD:
        return is_number(program, in->b, -0.0) ? in->a : is_number(program, in->a, -0.0) ? in->b : UNWANTED;
    case EXPR_SUBTRACT:
        return is_number(program, in->b, 0) ? in->a : UNWANTED;
    case EXPR_MULTIPLY:
        return is_number(program, in->b, 1) ? in->a : is_number(program, in->a, 1) ? in->b : UNWANTED;
    case EXPR_DIVIDE:
        return is_number(program, in->b, 1) ? in->a : UNWANTED;
    default:
        return UNWANTED;
    }
}

/* Copies the code; reads constants instead of the registers that contain them. known: room for one of each register; at
 * the end the constant that it contains, or UNWANTED. */
static void read_constants(const struct expr_program *program, uint16_t *known, struct expr_instruction *code) {
    const uint32_t first = program->constant_count;
    memset(known, 0xff, program->register_count * sizeof *known); /* UNWANTED */
    for (uint32_t n = 0; n < program->count; n++) {
        struct expr_instruction in = program->code[n];
        uint16_t *const operands[3] = {&in.a, &in.b, &in.c};
        for (int k = 0; k < 3; k++)
            if (reads[in.operation][k] && *operands[k] >= first && known[*operands[k] - first] != UNWANTED)
                *operands[k] = known[*operands[k] - first];
        uint16_t equal = equal_operand(program, &in);
        if (equal == UNWANTED)
            equal = result_of_constants(program, &in);
        else
            in = (struct expr_instruction){EXPR_COPY, in.out, equal, in.out, in.out, 0};
        known[in.out - first] = equal < first ? equal : UNWANTED;
        code[n] = in;
    }
}

/* --- both --- */

/* The code before it is renamed, and what ends in it. */
struct shortening {
    const struct expr_program *program;
    const struct expr_instruction *code;
    const uint16_t *known;             /* constants that registers contain at the end, or NULL */
    const struct expr_choice *choices; /* of lane `lane`, or NULL */
    uint32_t lane;
};

static bool shorten(const struct shortening *s, struct expr_stack *stack, uint16_t *memory, struct expr_program *out) {
    const struct expr_program *program = s->program;
    struct renaming r = {.renamed = memory, .first = program->constant_count};
    r.unused = r.renamed + program->register_count;
    memset(r.renamed, 0xff, program->register_count * sizeof *r.renamed); /* UNWANTED */
    struct expr_program shorter = *program;
    for (int i = 0; i < program->output_count; i++) {
        const uint16_t from = program->outputs[i];
        const bool is_known = s->known && from >= r.first && s->known[from - r.first] != UNWANTED;
        shorter.outputs[i] = is_known ? s->known[from - r.first] : want(&r, from);
    }
    struct expr_instruction *end = stack->code + stack->free, *to = end;
    struct expr_linker linker = {.constant_count = program->constant_count};
    for (uint32_t n = program->count; n-- > 0;) {
        struct expr_instruction in = s->code[n];
        uint16_t *renamed = &r.renamed[in.out - r.first], result = *renamed;
        if (result == UNWANTED)
            continue;
        *renamed = UNWANTED;
        bool first = s->choices && (s->choices[n].first >> s->lane & 1);
        bool second = s->choices && (s->choices[n].second >> s->lane & 1);
        if (first || second || (s->known && in.operation == EXPR_COPY)) {
            uint16_t from = first || second ? taken_operand(&in, first) : in.a;
            if (from >= r.first && r.renamed[from - r.first] == UNWANTED) {
                r.renamed[from - r.first] = result;
                continue;
            }
            in = copy_of(&in, from);
        }
        if (to == stack->code)
            return false;
        r.unused[r.unused_count++] = result;
        const uint8_t *reading = reads[in.operation];
        in.out = result;
        in.a = reading[0] ? want(&r, in.a) : result;
        unsigned ended = r.is_first;
        in.b = reading[1] ? want(&r, in.b) : result;
        ended |= r.is_first << 1;
        in.c = reading[2] ? want(&r, in.c) : result;
        ended |= r.is_first << 2;
        *--to = in;
        expr_link(&linker, to, ended);
    }
    expr_link_operands(&linker, UINT32_MAX);
    shorter.code = to;
    shorter.count = (uint32_t)(end - to);
    shorter.direct_inputs = shorter.direct_output = 0;
    shorter.input_count = 0;
    for (int i = 0; i < program->input_count; i++) {
        uint16_t renamed = r.renamed[program->inputs[i].value - r.first];
        if (renamed == UNWANTED)
            continue;
        shorter.inputs[shorter.input_count].input = program->inputs[i].input;
        shorter.inputs[shorter.input_count++].value = renamed;
    }
    shorter.register_count = r.register_count;
    if (program->loop_count == 0)
        shorter.row_count = r.register_count;
    stack->free = (size_t)(to - stack->code);
    *out = shorter;
    return true;
}

bool expr_shorten(const struct expr_program *program, const struct expr_choice *choices, uint32_t lane,
                  struct expr_stack *stack, void *scratch, struct expr_program *out) {
    const struct shortening shortening = {program, program->code, NULL, choices, lane};
    return shorten(&shortening, stack, scratch, out);
}

static bool has_copied_constant(const struct expr_program *program) {
    for (uint32_t n = 0; n < program->count; n++)
        if (program->code[n].operation == EXPR_COPY && program->code[n].a < program->constant_count)
            return true;
    return false;
}

bool expr_fold(const struct expr_program *program, struct expr_stack *stack, void *scratch, struct expr_program *out) {
    if (!has_copied_constant(program)) {
        *out = *program;
        return true;
    }
    struct expr_instruction *code = scratch;
    uint16_t *known = (uint16_t *)(void *)(code + program->count);
    read_constants(program, known, code);
    const struct shortening shortening = {program, code, known, NULL, 0};
    return shorten(&shortening, stack, known + program->register_count, out);
}

/* Constants that are not read are left out, so that evaluating a point does not copy them. */
bool expr_keep(const struct expr_program *program, struct arena *arena, struct expr_program *out) {
    uint16_t moved[EXPR_VALUES]; /* the new number of each value; first, of constants, whether they are read */
    const uint32_t first = program->constant_count, values = first + program->register_count;
    memset(moved, 0, first * sizeof *moved);
    for (uint32_t n = 0; n < program->count; n++) {
        const struct expr_instruction *in = &program->code[n];
        const uint16_t operands[3] = {in->a, in->b, in->c};
        for (int k = 0; k < 3; k++)
            if (operands[k] < first)
                moved[operands[k]] = 1;
    }
    for (int i = 0; i < program->output_count; i++)
        if (program->outputs[i] < first)
            moved[program->outputs[i]] = 1;
    uint32_t count = 0;
    for (uint32_t v = 0; v < first; v++)
        count += moved[v];
    struct expr_instruction *code = arena_alloc_array(arena, (size_t)program->count + 1, sizeof *code);
    union expr_value *constants = arena_alloc_array(arena, (size_t)count + 1, sizeof *constants);
    if (!code || !constants)
        return false;
    *out = *program;
    out->code = code;
    out->constants = constants;
    out->constant_count = 0;
    for (uint32_t v = 0; v < values; v++) {
        bool is_read = v >= first || moved[v];
        if (v < first && is_read)
            constants[out->constant_count++] = program->constants[v];
        moved[v] = (uint16_t)(v < first ? out->constant_count - is_read : v - first + count);
    }
    for (uint32_t n = 0; n < program->count; n++) {
        const struct expr_instruction *in = &program->code[n];
        code[n] = (struct expr_instruction){in->operation, moved[in->out], moved[in->a],
                                            moved[in->b],  moved[in->c],   in->link};
    }
    for (int i = 0; i < out->input_count; i++)
        out->inputs[i].value = moved[program->inputs[i].value];
    for (int i = 0; i < out->output_count; i++)
        out->outputs[i] = moved[program->outputs[i]];
    return true;
}
