/* From the graph to a program. It contains the nodes that the outputs need, in the order of the graph, in which
 * operands come first; but the sine and the cosine of one number follow each other, since evaluators compute both at
 * once. A register is free again after the last instruction that reads it (linear scan: Poletto and Sarkar 1999). */
#include "expr/expr_program.h"

#include "base/mem.h"
#include "expr/expr_batch_internal.h"
#include "expr/expr_link_internal.h"

#include <stdio.h>
#include <string.h>

/* The compiler's data about each node. */
struct allocation {
    uint32_t last;    /* the position in the order of the last node that reads it; UINT32_MAX for outputs */
    uint32_t wave;    /* its sine or cosine, the first of them */
    uint32_t partner; /* of the first: the other one. EXPR_NONE: none */
    uint16_t value;   /* where it stands */
    bool needed, ordered;
};

static void mark(const struct expr_graph *graph, const uint32_t *outputs, int output_count,
                 struct allocation *allocations) {
    for (uint32_t n = 0; n < graph->count; n++)
        allocations[n].wave = allocations[n].partner = EXPR_NONE;
    for (int i = 0; i < output_count; i++)
        allocations[outputs[i]].needed = true;
    for (uint32_t n = graph->count; n-- > 0;) {
        const struct expr_node *node = &graph->nodes[n];
        for (int k = 0; allocations[n].needed && k < expr_operand_count(node->operation); k++)
            allocations[node->operands[k]].needed = true;
    }
}

static bool is_wave(const struct expr_node *node) {
    return node->operation == EXPR_SIN || node->operation == EXPR_COS;
}

/* The needed operations in the order of the program; returns their number. */
static uint32_t put_in_order(const struct expr_graph *graph, const uint32_t *outputs, int output_count,
                             struct allocation *allocations, uint32_t *order) {
    for (uint32_t n = 0; n < graph->count; n++) {
        uint32_t *wave = is_wave(&graph->nodes[n]) ? &allocations[graph->nodes[n].operands[0]].wave : NULL;
        if (!wave || !allocations[n].needed)
            continue;
        if (*wave != EXPR_NONE)
            allocations[*wave].partner = n;
        else
            *wave = n;
    }
    uint32_t count = 0;
    for (uint32_t n = 0; n < graph->count; n++) {
        const struct expr_node *node = &graph->nodes[n];
        if (!allocations[n].needed || allocations[n].ordered || node->operation == EXPR_CONSTANT ||
            node->operation == EXPR_INPUT)
            continue;
        order[count++] = n;
        uint32_t partner = allocations[n].partner;
        if (partner != EXPR_NONE) {
            order[count++] = partner;
            allocations[partner].ordered = true;
        }
    }
    for (uint32_t at = 0; at < count; at++)
        for (int k = 0; k < expr_operand_count(graph->nodes[order[at]].operation); k++)
            allocations[graph->nodes[order[at]].operands[k]].last = at;
    for (int i = 0; i < output_count; i++)
        allocations[outputs[i]].last = UINT32_MAX;
    return count;
}

/* The free registers and their number; register numbers start after the constants. */
struct registers {
    uint16_t free[EXPR_VALUES];
    uint32_t free_count, count, first;
};

static bool take(struct registers *registers, uint16_t *value) {
    if (registers->free_count > 0) {
        *value = registers->free[--registers->free_count];
        return true;
    }
    if (registers->first + registers->count >= EXPR_VALUES)
        return false;
    *value = (uint16_t)(registers->first + registers->count++);
    return true;
}

static bool too_large(struct error *error) {
    return error_set(error, ERROR_SCENE, "the function needs more than %d constants and values at once", EXPR_VALUES);
}

static bool number_constants(const struct expr_graph *graph, struct allocation *allocations, struct arena *arena,
                             struct expr_program *program, struct error *error) {
    uint32_t count = 0;
    for (uint32_t n = 0; n < graph->count; n++)
        count += allocations[n].needed && graph->nodes[n].operation == EXPR_CONSTANT;
    if (count >= EXPR_VALUES)
        return too_large(error);
    union expr_value *constants = arena_alloc_array(arena, (size_t)count + 1, sizeof *constants);
    if (!constants)
        return error_no_memory(error, "a function");
    program->constants = constants;
    for (uint32_t n = 0; n < graph->count; n++) {
        if (!allocations[n].needed || graph->nodes[n].operation != EXPR_CONSTANT)
            continue;
        allocations[n].value = (uint16_t)program->constant_count;
        constants[program->constant_count++] = graph->nodes[n].constant;
    }
    return true;
}

/* Inputs are in the first registers from the start. */
static bool assign_inputs(const struct expr_graph *graph, struct allocation *allocations, struct registers *registers,
                          struct expr_program *program, struct error *error) {
    for (uint32_t n = 0; n < graph->count; n++) {
        if (!allocations[n].needed || graph->nodes[n].operation != EXPR_INPUT)
            continue;
        if (!take(registers, &allocations[n].value))
            return too_large(error);
        program->inputs[program->input_count].input = (uint16_t)graph->nodes[n].operands[0];
        program->inputs[program->input_count++].value = allocations[n].value;
    }
    return true;
}

static bool write_code(const struct expr_graph *graph, const uint32_t *order, struct allocation *allocations,
                       struct registers *registers, struct expr_instruction *code, struct expr_program *program) {
    for (uint32_t at = 0; at < program->count; at++) {
        const struct expr_node *node = &graph->nodes[order[at]];
        struct allocation *result = &allocations[order[at]];
        uint16_t values[3];
        int count = expr_operand_count(node->operation);
        for (int k = 0; k < count; k++) {
            struct allocation *operand = &allocations[node->operands[k]];
            values[k] = operand->value;
            if (operand->last == at && operand->value >= program->constant_count) {
                registers->free[registers->free_count++] = operand->value;
                operand->last = UINT32_MAX; /* once, also if this instruction reads it twice */
            }
        }
        if (!take(registers, &result->value))
            return false;
        for (int k = count; k < 3; k++)
            values[k] = result->value;
        code[at] =
            (struct expr_instruction){(uint16_t)node->operation, result->value, values[0], values[1], values[2], 0};
    }
    return true;
}

void expr_link_program(const struct expr_program *program, struct expr_instruction *code) {
    bool is_read[EXPR_VALUES] = {false}; /* by a later instruction, or as an output */
    struct expr_linker linker = {.constant_count = program->constant_count};
    for (int i = 0; i < program->output_count; i++)
        is_read[program->outputs[i]] = true;
    for (uint32_t n = program->count; n-- > 0;) {
        struct expr_instruction *in = &code[n];
        const uint16_t operands[3] = {in->a, in->b, in->c};
        unsigned ended = 0;
        is_read[in->out] = false;
        for (int k = 0; k < expr_operand_count((enum expr_operation)in->operation); k++) {
            ended |= (unsigned)!is_read[operands[k]] << k;
            is_read[operands[k]] = true;
        }
        expr_link(&linker, in, ended);
    }
    expr_link_operands(&linker, UINT32_MAX);
}

/* The compiler's memory. */
struct layout {
    struct allocation *allocations;
    struct registers *registers;
    uint32_t *order;
};

/* Generates the code of the nodes in their order. */
static bool compile(const struct expr_graph *graph, const struct layout *layout, struct arena *arena,
                    struct expr_program *program, struct expr_instruction *code, struct error *error) {
    if (!code)
        return error_no_memory(error, "a function");
    program->code = code;
    if (!number_constants(graph, layout->allocations, arena, program, error))
        return false;
    layout->registers->first = program->constant_count;
    if (!assign_inputs(graph, layout->allocations, layout->registers, program, error))
        return false;
    if (!write_code(graph, layout->order, layout->allocations, layout->registers, code, program))
        return too_large(error);
    program->register_count = layout->registers->count;
    return true;
}

bool expr_compile(const struct expr_graph *graph, const uint32_t *outputs, int output_count, struct arena *arena,
                  struct expr_program *program, struct error *error) {
    const struct layout layout = {mem_alloc_zero((size_t)graph->count + 1, sizeof *layout.allocations),
                                  mem_alloc_zero(1, sizeof *layout.registers),
                                  mem_alloc_zero((size_t)graph->count + 1, sizeof *layout.order)};
    *program = (struct expr_program){.count = 0};
    bool ok = layout.allocations && layout.registers && layout.order;
    if (!ok)
        (void)error_no_memory(error, "a function");
    if (ok) {
        mark(graph, outputs, output_count, layout.allocations);
        program->count = put_in_order(graph, outputs, output_count, layout.allocations, layout.order);
    }
    struct expr_instruction *code = ok ? arena_alloc_array(arena, (size_t)program->count + 1, sizeof *code) : NULL;
    ok = ok && compile(graph, &layout, arena, program, code, error);
    for (int i = 0; ok && i < output_count; i++)
        program->outputs[i] = layout.allocations[outputs[i]].value;
    if (ok) {
        program->output_count = output_count;
        expr_link_program(program, code);
    }
    mem_free(layout.allocations);
    mem_free(layout.registers);
    mem_free(layout.order);
    return ok;
}

/* --- one point --- */

#define EVALUATE(member, name, R, A, B, C, expression)                                                                 \
    case member: {                                                                                                     \
        EXPR_C_TYPE_##A a = values[in->a].EXPR_MEMBER_##A;                                                             \
        EXPR_C_TYPE_##B b = values[in->b].EXPR_MEMBER_##B;                                                             \
        EXPR_C_TYPE_##C c = values[in->c].EXPR_MEMBER_##C;                                                             \
        (void)a, (void)b, (void)c;                                                                                     \
        if ((member == EXPR_SIN || member == EXPR_COS) && expr_is_pair(in, end)) {                                     \
            bool is_sine = member == EXPR_SIN;                                                                         \
            in++;                                                                                                      \
            el_sincos(values[in->a].f, &values[in[is_sine ? -1 : 0].out].f, &values[in[is_sine ? 0 : -1].out].f);      \
            break;                                                                                                     \
        }                                                                                                              \
        values[in->out].EXPR_MEMBER_##R = (expression);                                                                \
        break;                                                                                                         \
    }

/* Linked instructions: `last` is the result of the one before. Storing costs less than asking whether to. */
#define SINGLE_R(operand) values[in->operand].f
#define SINGLE_K(operand) values[in->operand].f
#define SINGLE_L(operand) last
#define LINKED_NEGATE(a) -(a)
#define LINKED_ABS(a) fabs(a)
#define LINKED_SQRT(a) sqrt(a)
#define LINKED_FLOOR(a) floor(a)
#define LINKED_ADD(a, b) (a) + (b)
#define LINKED_SUBTRACT(a, b) (a) - (b)
#define LINKED_MULTIPLY(a, b) (a) * (b)
#define LINKED_DIVIDE(a, b) (a) / (b)
#define LINKED_MIN(a, b) (b) < (a) ? (b) : (a)
#define LINKED_MAX(a, b) (a) < (b) ? (b) : (a)
#define LINKED_LESS(a, b) truth((a) < (b))
#define LINKED_LESS_EQUAL(a, b) truth((a) <= (b))
#define LINKED_SELECT(a, b, c) is_true(a) ? (b) : (c)
#define SINGLE_CASE_1(operation, oa, stored)                                                                           \
    case EXPR_LINK_1(operation, oa, stored):                                                                           \
        values[in->out].f = last = LINKED_##operation(SINGLE_##oa(a));                                                 \
        break;
#define SINGLE_CASE_2(operation, oa, ob, stored)                                                                       \
    case EXPR_LINK_2(operation, oa, ob, stored):                                                                       \
        values[in->out].f = last = LINKED_##operation(SINGLE_##oa(a), SINGLE_##ob(b));                                 \
        break;
#define SINGLE_CASE_3(oa, ob, oc, stored)                                                                              \
    case EXPR_LINK_3(oa, ob, oc, stored):                                                                              \
        values[in->out].f = last = LINKED_SELECT(SINGLE_##oa(a), SINGLE_##ob(b), SINGLE_##oc(c));                      \
        break;

static inline double truth(bool x) {
    union expr_value value = {.i = -(int64_t)x};
    return value.f;
}

static inline bool is_true(double x) {
    union expr_value value = {.f = x};
    return value.i != 0;
}

/* Runs an instruction, or the two of a sine and a cosine; returns the last one. */
static const struct expr_instruction *run_unlinked(const struct expr_instruction *in,
                                                   const struct expr_instruction *end, union expr_value *values) {
    switch ((enum expr_operation)in->operation) {
        EXPR_OPERATIONS(EVALUATE)
    case EXPR_CONSTANT:
    case EXPR_INPUT:
    case EXPR_OPERATION_COUNT:
        break;
    }
    return in;
}

void expr_evaluate(const struct expr_program *program, const double inputs[EXPR_INPUT_COUNT],
                   double outputs[EXPR_OUTPUTS]) {
    union expr_value values[EXPR_VALUES];
    double last = 0;
    for (uint32_t i = 0; i < program->constant_count; i++)
        values[i] = program->constants[i];
    for (int i = 0; i < program->input_count; i++)
        values[program->inputs[i].value].f = inputs[program->inputs[i].input];
    for (const struct expr_instruction *in = program->code, *end = in + program->count; in < end; in++) {
        switch (in->link) {
        case EXPR_UNLINKED:
            in = run_unlinked(in, end, values);
            break;
            EXPR_LINK_CASES(SINGLE_CASE_1, SINGLE_CASE_2, SINGLE_CASE_3)
        default:
            __builtin_unreachable();
        }
    }
    for (int i = 0; i < program->output_count; i++)
        outputs[i] = values[program->outputs[i]].f;
}

/* --- batches --- */

/* One row for each register, and three for constants that are operands. */
size_t expr_batch_size(const struct expr_program *program) {
    return ((size_t)program->register_count + 3) * EXPR_BATCH * sizeof(union expr_value);
}

void expr_evaluate_batch(const struct expr_program *program, uint32_t count,
                         const double *const inputs[EXPR_INPUT_COUNT], double *const outputs[EXPR_OUTPUTS],
                         void *rows) {
    static void (*const run[])(const struct expr_program *, uint32_t, double *) = {
        [CPU_ISA_BASE] = expr_run_base, [CPU_ISA_AVX2] = expr_run_avx2, [CPU_ISA_AVX512] = expr_run_avx512};
    uint32_t width = (count + 15) & ~15U;
    double *values = rows;
    for (int i = 0; i < program->input_count; i++) {
        double *row = values + (size_t)(program->inputs[i].value - program->constant_count) * EXPR_BATCH;
        memcpy(row, inputs[program->inputs[i].input], count * sizeof *row);
        for (uint32_t k = count; k < width; k++)
            row[k] = 0;
    }
    run[cpu_isa()](program, width, values);
    for (int i = 0; i < program->output_count; i++) {
        uint16_t value = program->outputs[i];
        if (value >= program->constant_count) {
            const double *row = values + (size_t)(value - program->constant_count) * EXPR_BATCH;
            memcpy(outputs[i], row, count * sizeof *row);
            continue;
        }
        for (uint32_t k = 0; k < count; k++)
            outputs[i][k] = program->constants[value].f;
    }
}

/* --- listings --- */

/* " wood.png:red": the last part of the name of the picture, and the channel. */
static int describe_texel(int64_t operand, char *out, size_t size) {
    static const char *const channels[] = {"red", "green", "blue", "alpha"};
    const char *name = image_name(expr_texel_function(operand)->image), *slash = strrchr(name, '/');
    return snprintf(out, size, " %.24s:%s", slash ? slash + 1 : name, channels[operand & 3]);
}

static int describe_value(const struct expr_program *program, enum expr_operation operation, int k, uint16_t value,
                          char *out, size_t size) {
    enum expr_type type = expr_operand_type(operation, k);
    if (value >= program->constant_count)
        return snprintf(out, size, " r%u", (unsigned)(value - program->constant_count));
    if (type == EXPR_TYPE_F)
        return snprintf(out, size, " %.17g", program->constants[value].f);
    if (type == EXPR_TYPE_I && operation == EXPR_TEXEL)
        return describe_texel(program->constants[value].i, out, size);
    return snprintf(out, size, " %lld", (long long)program->constants[value].i);
}

void expr_describe(const struct expr_program *program, uint32_t instruction, char *out, size_t size) {
    const struct expr_instruction *in = &program->code[instruction];
    enum expr_operation operation = (enum expr_operation)in->operation;
    const uint16_t operands[3] = {in->a, in->b, in->c};
    char words[3][40] = {"", "", ""};
    for (int k = 0; k < expr_operand_count(operation); k++)
        (void)describe_value(program, operation, k, operands[k], words[k], sizeof words[k]);
    (void)snprintf(out, size, "r%u = %s%s%s%s", (unsigned)(in->out - program->constant_count),
                   expr_operation_name(operation), words[0], words[1], words[2]);
}
