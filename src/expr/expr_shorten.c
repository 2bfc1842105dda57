/* One pass backwards over the program. It keeps the new register of every old one that is still needed, and renames,
 * frees and drops at the same time. A min, max or selection that is decided disappears: its selected operand gets
 * its register. A copy remains only if another instruction needs that operand too, or if it is a constant. */
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

size_t expr_shorten_size(const struct expr_program *program) {
    return ((size_t)program->register_count + 1) * 2 * sizeof(uint16_t);
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

bool expr_shorten(const struct expr_program *program, const struct expr_choice *choices, uint32_t lane,
                  struct expr_stack *stack, void *scratch, struct expr_program *out) {
    struct renaming r = {.renamed = scratch, .first = program->constant_count};
    r.unused = r.renamed + program->register_count;
    memset(r.renamed, 0xff, program->register_count * sizeof *r.renamed); /* UNWANTED */
    struct expr_program shorter = *program;
    for (int i = 0; i < program->output_count; i++)
        shorter.outputs[i] = want(&r, program->outputs[i]);
    struct expr_instruction *end = stack->code + stack->free, *to = end;
    struct expr_linker linker = {.constant_count = program->constant_count};
    for (uint32_t n = program->count; n-- > 0;) {
        struct expr_instruction in = program->code[n];
        uint16_t *renamed = &r.renamed[in.out - r.first], result = *renamed;
        if (result == UNWANTED)
            continue;
        *renamed = UNWANTED;
        bool first = choices[n].first >> lane & 1, second = choices[n].second >> lane & 1;
        if (first || second) {
            uint16_t from = taken_operand(&in, first);
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
