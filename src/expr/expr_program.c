/* From the graph to a program. It contains the nodes that the outputs need, in the order of the graph, in which
 * operands come first. A register is free again after the last instruction that reads it (linear scan: Poletto and
 * Sarkar 1999). */
#include "expr/expr_program.h"

#include "base/mem.h"
#include "expr/expr_batch_internal.h"

#include <stdio.h>
#include <string.h>

/* The compiler's data about each node. */
struct allocation {
    uint32_t last;  /* the last node that reads it; its own number if there is none; the number of nodes for outputs */
    uint16_t value; /* where it stands */
    bool needed;
};

static void mark(const struct expr_graph *graph, const uint32_t *outputs, int output_count,
                 struct allocation *allocations) {
    for (int i = 0; i < output_count; i++)
        allocations[outputs[i]] = (struct allocation){.last = graph->count, .needed = true};
    for (uint32_t n = graph->count; n-- > 0;) {
        const struct expr_node *node = &graph->nodes[n];
        for (int k = 0; allocations[n].needed && k < expr_operand_count(node->operation); k++) {
            struct allocation *operand = &allocations[node->operands[k]];
            operand->last = operand->needed && operand->last > n ? operand->last : n;
            operand->needed = true;
        }
    }
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

static bool write_code(const struct expr_graph *graph, struct allocation *allocations, struct registers *registers,
                       struct expr_instruction *code, struct expr_program *program, struct error *error) {
    for (uint32_t n = 0; n < graph->count; n++) {
        const struct expr_node *node = &graph->nodes[n];
        uint16_t values[3];
        int count = expr_operand_count(node->operation);
        if (!allocations[n].needed || node->operation == EXPR_CONSTANT || node->operation == EXPR_INPUT)
            continue;
        for (int k = 0; k < count; k++) {
            struct allocation *operand = &allocations[node->operands[k]];
            values[k] = operand->value;
            if (operand->last == n && operand->value >= program->constant_count) {
                registers->free[registers->free_count++] = operand->value;
                operand->last = n + 1; /* once, also if this instruction reads it twice */
            }
        }
        if (!take(registers, &allocations[n].value))
            return too_large(error);
        for (int k = count; k < 3; k++)
            values[k] = allocations[n].value;
        code[program->count++] =
            (struct expr_instruction){(uint16_t)node->operation, allocations[n].value, values[0], values[1], values[2]};
    }
    return true;
}

/* Generates the code of all marked nodes. */
static bool compile(const struct expr_graph *graph, struct arena *arena, struct allocation *allocations,
                    struct registers *registers, struct expr_program *program, struct error *error) {
    uint32_t count = 0;
    for (uint32_t n = 0; n < graph->count; n++)
        count += allocations[n].needed;
    struct expr_instruction *code = arena_alloc_array(arena, (size_t)count + 1, sizeof *code);
    if (!code)
        return error_no_memory(error, "a function");
    program->code = code;
    if (!number_constants(graph, allocations, arena, program, error))
        return false;
    registers->first = program->constant_count;
    if (!assign_inputs(graph, allocations, registers, program, error) ||
        !write_code(graph, allocations, registers, code, program, error))
        return false;
    program->register_count = registers->count;
    return true;
}

bool expr_compile(const struct expr_graph *graph, const uint32_t *outputs, int output_count, struct arena *arena,
                  struct expr_program *program, struct error *error) {
    struct allocation *allocations = mem_alloc_zero((size_t)graph->count + 1, sizeof *allocations);
    struct registers *registers = mem_alloc_zero(1, sizeof *registers);
    *program = (struct expr_program){.count = 0};
    bool ok = allocations && registers;
    if (!ok)
        (void)error_no_memory(error, "a function");
    if (ok)
        mark(graph, outputs, output_count, allocations);
    ok = ok && compile(graph, arena, allocations, registers, program, error);
    for (int i = 0; ok && i < output_count; i++)
        program->outputs[i] = allocations[outputs[i]].value;
    if (ok)
        program->output_count = output_count;
    mem_free(allocations);
    mem_free(registers);
    return ok;
}

/* --- one point --- */

#define TYPE_F double
#define TYPE_I int64_t
#define TYPE_B int64_t
#define TYPE_N int64_t
#define MEMBER_F f
#define MEMBER_I i
#define MEMBER_B i
#define MEMBER_N i
#define EVALUATE(member, name, R, A, B, C, expression)                                                                 \
    case member: {                                                                                                     \
        TYPE_##A a = values[in->a].MEMBER_##A;                                                                         \
        TYPE_##B b = values[in->b].MEMBER_##B;                                                                         \
        TYPE_##C c = values[in->c].MEMBER_##C;                                                                         \
        (void)a, (void)b, (void)c;                                                                                     \
        values[in->out].MEMBER_##R = (expression);                                                                     \
        break;                                                                                                         \
    }

void expr_evaluate(const struct expr_program *program, const double inputs[EXPR_INPUT_COUNT],
                   double outputs[EXPR_OUTPUTS]) {
    union expr_value values[EXPR_VALUES];
    for (uint32_t i = 0; i < program->constant_count; i++)
        values[i] = program->constants[i];
    for (int i = 0; i < program->input_count; i++)
        values[program->inputs[i].value].f = inputs[program->inputs[i].input];
    for (const struct expr_instruction *in = program->code, *end = in + program->count; in < end; in++) {
        switch ((enum expr_operation)in->operation) {
            EXPR_OPERATIONS(EVALUATE)
        case EXPR_CONSTANT:
        case EXPR_INPUT:
        case EXPR_OPERATION_COUNT:
            break;
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
    uint32_t width = (count + 7) & ~7U;
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

static int describe_value(const struct expr_program *program, enum expr_type type, uint16_t value, char *out,
                          size_t size) {
    if (value >= program->constant_count)
        return snprintf(out, size, " r%u", (unsigned)(value - program->constant_count));
    if (type == EXPR_TYPE_F)
        return snprintf(out, size, " %.17g", program->constants[value].f);
    return snprintf(out, size, " %lld", (long long)program->constants[value].i);
}

void expr_describe(const struct expr_program *program, uint32_t instruction, char *out, size_t size) {
    const struct expr_instruction *in = &program->code[instruction];
    enum expr_operation operation = (enum expr_operation)in->operation;
    const uint16_t operands[3] = {in->a, in->b, in->c};
    char words[3][40] = {"", "", ""};
    for (int k = 0; k < expr_operand_count(operation); k++)
        (void)describe_value(program, expr_operand_type(operation, k), operands[k], words[k], sizeof words[k]);
    (void)snprintf(out, size, "r%u = %s%s%s%s", (unsigned)(in->out - program->constant_count),
                   expr_operation_name(operation), words[0], words[1], words[2]);
}
