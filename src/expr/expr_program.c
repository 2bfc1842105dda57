/* From the graph to a program. It contains the nodes that the outputs need, in the order of the graph, in which
 * operands come first; but the sine and the cosine of one number follow each other, since evaluators compute both at
 * once. A register is free again after the last instruction that reads it (linear scan: Poletto and Sarkar 1999). */
#include "expr/expr_program.h"

#include "base/mem.h"
#include "expr/expr_batch_internal.h"
#include "expr/expr_frames_internal.h"
#include "expr/expr_link_internal.h"

#include <stdio.h>
#include <string.h>

/* The compiler's data about each node. */
struct allocation {
    uint32_t last;    /* the position in the order of the last node that reads it; UINT32_MAX for outputs */
    uint32_t wave;    /* its sine or cosine, the first of them */
    uint32_t partner; /* of the first: the other one. EXPR_NONE: none */
    uint16_t value;   /* where it stands */
    uint16_t operand; /* of an operation of a loop: the constant with the number of the loop */
    bool needed, ordered;
};

/* A program that is compiled: that of a function, or the body of a loop. */
struct layout {
    const struct expr_graph *graph;
    const struct expr_kept_loop *loop; /* NULL: the function */
    const uint32_t *outputs;           /* nodes */
    uint32_t output_count;
    struct allocation *allocations;
    struct registers *registers;
    uint32_t *order, *numbers; /* nodes; the loops of this program, by their numbers in the graph */
    struct arena *arena;
};

static uint32_t depth_of(const struct layout *layout) {
    return layout->loop ? layout->loop->loop.depth : 0;
}

/* Whether this program computes the node: it is no constant, no input and not from outside of the body. */
static bool is_computed(const struct layout *layout, uint32_t n) {
    const struct expr_node *node = &layout->graph->nodes[n];
    return node->operation != EXPR_CONSTANT && node->operation != EXPR_INPUT && node->depth == depth_of(layout);
}

/* Operands that are values: all but the constant of a loop. */
static int count_operands(const struct expr_node *node) {
    return expr_operand_count(node->operation) - (node->operation > EXPR_OPERATION_COUNT);
}

static void mark(const struct layout *layout) {
    const struct expr_graph *graph = layout->graph;
    struct allocation *allocations = layout->allocations;
    for (uint32_t n = 0; n < graph->count; n++)
        allocations[n].wave = allocations[n].partner = EXPR_NONE;
    for (uint32_t i = 0; i < layout->output_count; i++)
        allocations[layout->outputs[i]].needed = true;
    for (uint32_t n = graph->count; n-- > 0;) {
        const struct expr_node *node = &graph->nodes[n];
        bool is_read = allocations[n].needed && is_computed(layout, n);
        for (int k = 0; is_read && k < count_operands(node); k++)
            allocations[node->operands[k]].needed = true;
    }
}

static bool is_wave(const struct expr_node *node) {
    return node->operation == EXPR_SIN || node->operation == EXPR_COS;
}

/* The needed operations in the order of the program; returns their number. */
static uint32_t put_in_order(const struct layout *layout) {
    const struct expr_graph *graph = layout->graph;
    struct allocation *allocations = layout->allocations;
    uint32_t *order = layout->order;
    /* The sine and the cosine of one operand become partners, which stand together. */
    for (uint32_t n = 0; n < graph->count; n++) {
        uint32_t *wave = is_wave(&graph->nodes[n]) ? &allocations[graph->nodes[n].operands[0]].wave : NULL;
        if (!wave || !allocations[n].needed || !is_computed(layout, n))
            continue;
        if (*wave != EXPR_NONE)
            allocations[*wave].partner = n;
        else
            *wave = n;
    }
    uint32_t count = 0;
    for (uint32_t n = 0; n < graph->count; n++) {
        if (!allocations[n].needed || allocations[n].ordered || !is_computed(layout, n))
            continue;
        order[count++] = n;
        uint32_t partner = allocations[n].partner;
        if (partner != EXPR_NONE) {
            order[count++] = partner;
            allocations[partner].ordered = true;
        }
    }
    /* The last use of each value, after which its register is free; outputs stay. */
    for (uint32_t at = 0; at < count; at++)
        for (int k = 0; k < count_operands(&graph->nodes[order[at]]); k++)
            allocations[graph->nodes[order[at]].operands[k]].last = at;
    for (uint32_t i = 0; i < layout->output_count; i++)
        allocations[layout->outputs[i]].last = UINT32_MAX;
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

/* The constant operand of a node of a loop: the last one. */
static int64_t loop_operand(const struct expr_graph *graph, const struct expr_node *node) {
    return graph->nodes[node->operands[expr_operand_count(node->operation) - 1]].constant.i;
}

static bool number_constants(const struct layout *layout, struct expr_program *program, struct error *error) {
    const struct expr_graph *graph = layout->graph;
    struct allocation *allocations = layout->allocations;
    uint32_t count = 0;
    for (uint32_t n = 0; n < graph->count; n++)
        count += allocations[n].needed && graph->nodes[n].operation == EXPR_CONSTANT;
    for (uint32_t at = 0; at < program->count; at++)
        count += graph->nodes[layout->order[at]].operation > EXPR_OPERATION_COUNT;
    if (count >= EXPR_VALUES)
        return too_large(error);
    /* Constants of the graph, and then one for each operation of a loop: which loop and which state. */
    union expr_value *constants = arena_alloc_array(layout->arena, (size_t)count + 1, sizeof *constants);
    if (!constants)
        return error_no_memory(error, "a function");
    program->constants = constants;
    for (uint32_t n = 0; n < graph->count; n++) {
        if (!allocations[n].needed || graph->nodes[n].operation != EXPR_CONSTANT)
            continue;
        allocations[n].value = (uint16_t)program->constant_count;
        constants[program->constant_count++] = graph->nodes[n].constant;
    }
    for (uint32_t at = 0; at < program->count; at++) {
        const struct expr_node *node = &graph->nodes[layout->order[at]];
        if (node->operation < EXPR_OPERATION_COUNT)
            continue;
        int64_t operand = loop_operand(graph, node);
        uint32_t number = 0;
        while (layout->numbers[number] != operand >> 16)
            number++;
        allocations[layout->order[at]].operand = (uint16_t)program->constant_count;
        constants[program->constant_count++].i = expr_loop_operand(number, (uint32_t)(operand & 0xffff));
    }
    return true;
}

/* Inputs are in the first registers from the start, and stay there. */
static bool assign_inputs(const struct layout *layout, struct expr_program *program, struct error *error) {
    const struct expr_graph *graph = layout->graph;
    for (uint32_t n = 0; n < graph->count; n++) {
        if (!layout->allocations[n].needed || graph->nodes[n].operation != EXPR_INPUT)
            continue;
        if (!take(layout->registers, &layout->allocations[n].value))
            return too_large(error);
        program->inputs[program->input_count].input = (uint16_t)graph->nodes[n].operands[0];
        program->inputs[program->input_count++].value = layout->allocations[n].value;
        layout->allocations[n].last = UINT32_MAX;
    }
    return true;
}

/* The arguments of a body are in its first registers from the start, and stay there. */
static bool assign_arguments(const struct layout *layout, struct error *error) {
    const struct expr_kept_loop *kept = layout->loop;
    const struct expr_graph *graph = layout->graph;
    const uint32_t first = layout->registers->first;
    for (uint32_t k = 0; k <= kept->argument_count; k++) {
        uint16_t value;
        if (!take(layout->registers, &value))
            return too_large(error);
        if (k >= kept->loop.state_count && k < kept->argument_count) {
            layout->allocations[kept->arguments[k]].value = value;
            layout->allocations[kept->arguments[k]].last = UINT32_MAX;
        }
    }
    for (uint32_t n = 0; n < graph->count; n++) {
        if (!expr_is_symbol(&graph->nodes[n]) || graph->nodes[n].depth != kept->loop.depth)
            continue;
        uint32_t slot = expr_symbol_slot(&graph->nodes[n]);
        layout->allocations[n].value = (uint16_t)(first + (slot == 0 ? kept->argument_count : slot - 1));
        layout->allocations[n].last = UINT32_MAX;
    }
    return true;
}

static bool write_code(const struct layout *layout, struct expr_instruction *code, const struct expr_program *program) {
    const struct expr_graph *graph = layout->graph;
    struct registers *registers = layout->registers;
    for (uint32_t at = 0; at < program->count; at++) {
        const struct expr_node *node = &graph->nodes[layout->order[at]];
        struct allocation *result = &layout->allocations[layout->order[at]];
        uint16_t values[3];
        int count = count_operands(node);
        for (int k = 0; k < count; k++) {
            struct allocation *operand = &layout->allocations[node->operands[k]];
            values[k] = operand->value;
            if (operand->last == at && operand->value >= program->constant_count) {
                registers->free[registers->free_count++] = operand->value;
                operand->last = UINT32_MAX; /* once, also if this instruction reads it twice */
            }
        }
        if (node->operation > EXPR_OPERATION_COUNT)
            values[count++] = result->operand;
        if (!take(registers, &result->value))
            return false;
        for (int k = count; k < 3; k++)
            values[k] = result->value;
        code[at] =
            (struct expr_instruction){(uint16_t)node->operation, result->value, values[0], values[1], values[2], 0};
    }
    return true;
}

/* Sets the links. is_read: of each value, whether it is read after the program. */
static void link_code(const struct expr_program *program, struct expr_instruction *code, bool is_read[EXPR_VALUES]) {
    struct expr_linker linker = {.constant_count = program->constant_count,
                                 .input_end = program->constant_count + (uint32_t)program->input_count};
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

/* Inputs are direct that are no outputs, and that only linked sums, differences and products read. */
static void find_direct_inputs(struct expr_program *program) {
    bool is_copied[EXPR_VALUES] = {false};
    for (int i = 0; i < program->output_count; i++)
        is_copied[program->outputs[i]] = true;
    for (uint32_t n = 0; n < program->count; n++) {
        const struct expr_instruction *in = &program->code[n];
        const uint16_t operands[3] = {in->a, in->b, in->c};
        bool is_direct = in->link != EXPR_UNLINKED && expr_links_inputs(in->operation);
        for (int k = 0; k < expr_operand_count((enum expr_operation)in->operation) && !is_direct; k++)
            is_copied[operands[k]] = true;
    }
    for (int i = 0; i < program->input_count; i++)
        program->direct_inputs |= (uint16_t)(!is_copied[program->inputs[i].value] << i);
}

/* The last instruction need not store an output that it computes, unless that is an output twice. */
static void find_direct_output(struct expr_program *program, struct expr_instruction *code) {
    struct expr_instruction *last = program->count > 0 ? &code[program->count - 1] : NULL;
    int uses = 0, found = 0;
    for (int i = 0; i < program->output_count && last; i++) {
        if (program->outputs[i] != last->out)
            continue;
        found = i;
        uses++;
    }
    if (uses != 1 || last->link == EXPR_UNLINKED)
        return;
    program->direct_output = (uint16_t)(1 + found);
    last->link--; /* it was one that stores */
}

static void link_function(struct expr_program *program, struct expr_instruction *code) {
    bool is_read[EXPR_VALUES] = {false};
    for (int i = 0; i < program->output_count; i++)
        is_read[program->outputs[i]] = true;
    link_code(program, code, is_read);
    find_direct_inputs(program);
    find_direct_output(program, code);
    expr_link_pairs(code, program->count);
}

/* Lists the loops of the program: their numbers in the graph. */
static uint32_t list_loops(const struct layout *layout, const struct expr_program *program) {
    uint32_t count = 0;
    for (uint32_t at = 0; at < program->count; at++) {
        const struct expr_node *node = &layout->graph->nodes[layout->order[at]];
        if (node->operation == EXPR_LOOP)
            layout->numbers[count++] = (uint32_t)(loop_operand(layout->graph, node) >> 16);
    }
    return count;
}

/* An instruction that copies a value of this type. */
static struct expr_instruction copy_of(enum expr_type type, uint16_t from, uint16_t out) {
    if (type == EXPR_TYPE_F)
        return (struct expr_instruction){EXPR_COPY, out, from, out, out, 0};
    if (type == EXPR_TYPE_I)
        return (struct expr_instruction){EXPR_BIT_AND, out, from, from, out, 0};
    return (struct expr_instruction){EXPR_TRUTH_SELECT, out, from, from, from, 0};
}

/* The results of the body in the order of the states. States are written one after the other, so that a result which is
 * the register of another state is copied. `code` has room for that. */
static bool finish_body(const struct layout *layout, struct expr_loop *loop, struct expr_instruction *code,
                        uint16_t *next, enum expr_type *types) {
    struct expr_program *body = &loop->body;
    bool is_read[EXPR_VALUES] = {false};
    for (uint32_t k = 0; k < loop->state_count; k++) {
        const uint32_t node = layout->loop->loop.next[k];
        uint16_t value = layout->allocations[node].value, first = (uint16_t)body->constant_count;
        types[k] = layout->graph->nodes[node].type;
        if (value >= first && value < first + loop->state_count && value != first + k) {
            /* Written before it is read: it needs a copy. */
            uint16_t copy;
            if (!take(layout->registers, &copy))
                return false;
            code[body->count++] = copy_of(types[k], value, copy);
            value = copy;
        }
        next[k] = value;
        is_read[value] = true;
    }
    /* The states, and the count of the loop, stay in their registers. */
    for (uint32_t k = 0; k <= loop->argument_count; k++)
        is_read[body->constant_count + k] = true;
    body->register_count = layout->registers->count;
    link_code(body, code, is_read);
    expr_link_pairs(code, body->count);
    return true;
}

static bool compile_loops(const struct layout *layout, struct expr_program *program, struct error *error);

/* Generates the instructions, without links. Returns them, with room for one more for each output; NULL: an error. */
static struct expr_instruction *generate(const struct layout *layout, struct expr_program *program,
                                         struct error *error) {
    mark(layout);
    program->count = put_in_order(layout);
    program->loop_count = list_loops(layout, program);
    struct expr_instruction *code =
        arena_alloc_array(layout->arena, (size_t)program->count + layout->output_count + 1, sizeof *code);
    program->code = code;
    if (!code) {
        (void)error_no_memory(error, "a function");
        return NULL;
    }
    if (!number_constants(layout, program, error))
        return NULL;
    layout->registers->first = program->constant_count;
    if (!(layout->loop ? assign_arguments(layout, error) : assign_inputs(layout, program, error)))
        return NULL;
    if (!write_code(layout, code, program)) {
        (void)too_large(error);
        return NULL;
    }
    program->register_count = layout->registers->count;
    return code;
}

static bool compile_function(const struct layout *layout, struct expr_program *program, struct error *error) {
    struct expr_instruction *code = generate(layout, program, error);
    if (!code)
        return false;
    for (uint32_t i = 0; i < layout->output_count; i++)
        program->outputs[i] = layout->allocations[layout->outputs[i]].value;
    program->output_count = (int)layout->output_count;
    link_function(program, code);
    return compile_loops(layout, program, error);
}

static bool compile_body(const struct layout *layout, struct expr_loop *loop, struct error *error) {
    const struct expr_graph_loop *from = &layout->loop->loop;
    uint16_t *next = arena_alloc_array(layout->arena, (size_t)from->state_count + 1, sizeof *next);
    enum expr_type *types = arena_alloc_array(layout->arena, (size_t)from->state_count + 1, sizeof *types);
    if (!next || !types)
        return error_no_memory(error, "a function");
    *loop = (struct expr_loop){.first = from->first,
                               .last = from->last,
                               .ends = from->ends,
                               .state_count = (uint16_t)from->state_count,
                               .argument_count = (uint16_t)layout->loop->argument_count,
                               .next = next,
                               .type = types};
    struct expr_instruction *code = generate(layout, &loop->body, error);
    if (!code)
        return false;
    if (!finish_body(layout, loop, code, next, types))
        return too_large(error);
    return compile_loops(layout, &loop->body, error);
}

/* Compiles with memory that is freed afterwards. loop: where the body goes, or NULL. */
static bool compile(struct layout *layout, struct expr_program *program, struct expr_loop *loop, struct error *error) {
    const size_t nodes = (size_t)layout->graph->count + 1;
    layout->allocations = mem_alloc_zero(nodes, sizeof *layout->allocations);
    layout->registers = mem_alloc_zero(1, sizeof *layout->registers);
    layout->order = mem_alloc_zero(nodes, sizeof *layout->order);
    layout->numbers = mem_alloc_zero((size_t)layout->graph->loop_count + 1, sizeof *layout->numbers);
    bool ok = layout->allocations && layout->registers && layout->order && layout->numbers;
    if (!ok)
        (void)error_no_memory(error, "a function");
    else
        ok = loop ? compile_body(layout, loop, error) : compile_function(layout, program, error);
    mem_free(layout->allocations);
    mem_free(layout->registers);
    mem_free(layout->order);
    mem_free(layout->numbers);
    return ok;
}

/* Compiles the loops of a program, and gives them memory after its registers. */
static bool compile_loops(const struct layout *layout, struct expr_program *program, struct error *error) {
    program->row_count = program->register_count;
    if (program->loop_count == 0)
        return true;
    struct expr_loop *loops = arena_alloc_array(layout->arena, program->loop_count, sizeof *loops);
    if (!loops)
        return error_no_memory(error, "a function");
    program->loops = loops;
    for (uint32_t k = 0; k < program->loop_count; k++) {
        const struct expr_kept_loop *kept = &layout->graph->loops[layout->numbers[k]];
        if (kept->loop.depth > EXPR_DEPTH)
            return error_set(error, ERROR_SCENE, "the function has loops that are more than %d deep in each other",
                             EXPR_DEPTH);
        struct layout body = {.graph = layout->graph,
                              .loop = kept,
                              .outputs = kept->loop.next,
                              .output_count = kept->loop.state_count,
                              .arena = layout->arena};
        if (!compile(&body, NULL, &loops[k], error))
            return false;
        /* Its registers follow those of the program and of earlier loops. */
        loops[k].offset = program->row_count;
        program->row_count += expr_loop_rows(&loops[k]);
        program->loop_work += (loops[k].last - loops[k].first + 1) * expr_work(&loops[k].body);
        if (program->constant_count + program->row_count > EXPR_VALUES)
            return too_large(error);
    }
    return true;
}

bool expr_compile(const struct expr_graph *graph, const uint32_t *outputs, int output_count, struct arena *arena,
                  struct expr_program *program, struct error *error) {
    struct layout layout = {.graph = graph, .outputs = outputs, .output_count = (uint32_t)output_count, .arena = arena};
    *program = (struct expr_program){.count = 0};
    return compile(&layout, program, NULL, error);
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
#define SINGLE_I(operand) values[in->operand].f
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
/* With one jump for all instructions, a point takes 1.5 times as long. */
#define NEXT                                                                                                           \
    if (++in >= end)                                                                                                   \
        return NULL;                                                                                                   \
    EXPR_JUMP
#define SINGLE_1(operation, oa, stored)                                                                                \
    operation##_##oa##_##stored : values[in->out].f = last = LINKED_##operation(SINGLE_##oa(a));                       \
    NEXT
#define SINGLE_2(operation, oa, ob, stored)                                                                            \
    operation##_##oa##_##ob##_##stored : values[in->out].f = last =                                                    \
        LINKED_##operation(SINGLE_##oa(a), SINGLE_##ob(b));                                                            \
    NEXT
#define SINGLE_3(oa, ob, oc, stored)                                                                                   \
    SELECT_##oa##_##ob##_##oc##_##stored : values[in->out].f = last =                                                  \
        LINKED_SELECT(SINGLE_##oa(a), SINGLE_##ob(b), SINGLE_##oc(c));                                                 \
    NEXT

static inline double truth(bool x) {
    union expr_value value = {.i = -(int64_t)x};
    return value.f;
}

static inline bool is_true(double x) {
    union expr_value value = {.f = x};
    return value.i != 0;
}

/* Runs an instruction, or the two of a sine and a cosine; returns the last one. */
static const struct expr_instruction *run_unlinked(const struct expr_program *program,
                                                   const struct expr_instruction *in, union expr_value *values) {
    const struct expr_instruction *end = program->code + program->count;
    switch ((enum expr_operation)in->operation) {
        EXPR_OPERATIONS(EVALUATE)
    EXPR_LOOP_CASES : {
        const struct expr_loop_access at = expr_loop_access(program, in);
        values[at.puts ? at.value : in->out] = values[at.puts ? in->b : at.value];
        break;
    }
    case EXPR_CONSTANT:
    case EXPR_INPUT:
    case EXPR_OPERATION_COUNT:
    case EXPR_ALL_OPERATIONS:
        break;
    }
    return in;
}

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wpedantic" /* addresses of labels */

/* Up to the next loop, or to the end: NULL. */
static const struct expr_instruction *run_code(const struct expr_program *program, const struct expr_instruction *in,
                                               union expr_value *values) {
    const struct expr_instruction *const end = program->code + program->count;
    double last = 0;
    if (in >= end)
        return NULL;
    EXPR_JUMPS(EXPR_LINK_ADDRESSES EXPR_PAIR_CASES(EXPR_ADDRESS_FIRST))
LOOP:
    return in;
UNLINKED:
    in = run_unlinked(program, in, values);
    NEXT EXPR_LINK_CASES(SINGLE_1, SINGLE_2, SINGLE_3)
}

#pragma GCC diagnostic pop

/* See EXPR_DEFINE_RUN. */
struct point_frame {
    const struct expr_program *program;
    const struct expr_loop *loop;
    const struct expr_instruction *in;
    union expr_value *values;
    uint32_t step; /* the next one */
};

static const struct expr_instruction *point_continue(const struct point_frame *f) {
    return run_code(f->program, f->in, f->values);
}

static void point_begin_loop(const struct point_frame *f, struct point_frame *inner) {
    const struct expr_loop *loop = expr_loop_access(f->program, f->in).loop;
    union expr_value *values = f->values + f->program->constant_count + loop->offset;
    memcpy(values, loop->body.constants, loop->body.constant_count * sizeof *values);
    *inner = (struct point_frame){&loop->body, loop, NULL, values, loop->first};
}

static bool point_begin_step(struct point_frame *f) {
    const struct expr_loop *loop = f->loop;
    union expr_value *registers = f->values + loop->body.constant_count;
    const bool is_float = loop->type[0] == EXPR_TYPE_F;
    if (f->step > loop->last || (loop->ends && f->step > 1 && !(is_float ? registers[0].f > 0 : registers[0].i > 0)))
        return false;
    registers[loop->argument_count].i = f->step++;
    f->in = loop->body.code;
    return true;
}

/* The states are written in order, which changes no result (see struct expr_loop). */
static void point_end_step(const struct point_frame *f) {
    union expr_value *registers = f->values + f->loop->body.constant_count;
    const uint32_t states = f->loop->state_count;
    const uint16_t *next = f->loop->next;
    for (uint32_t k = 0; k < states; k++)
        registers[k] = f->values[next[k]];
}

EXPR_DEFINE_RUN(point)

__attribute__((noinline)) static void run_loops(const struct expr_program *program, union expr_value *values) {
    struct point_frame frames[EXPR_FRAMES] = {{program, NULL, program->code, values, 0}};
    point_run(frames);
}

void expr_evaluate(const struct expr_program *program, const double inputs[EXPR_INPUT_COUNT],
                   double outputs[EXPR_OUTPUTS]) {
    union expr_value values[EXPR_VALUES];
    memcpy(values, program->constants, program->constant_count * sizeof *values);
    for (int i = 0; i < program->input_count; i++)
        values[program->inputs[i].value].f = inputs[program->inputs[i].input];
    if (program->loop_count > 0)
        run_loops(program, values);
    else
        (void)run_code(program, program->code, values);
    for (int i = 0; i < program->output_count; i++)
        outputs[i] = values[program->outputs[i]].f;
}

/* --- batches --- */

/* One row for each register and for the memory of loops, and three for constants that are operands. */
size_t expr_batch_size(const struct expr_program *program) {
    return ((size_t)program->row_count + 3) * EXPR_BATCH * sizeof(union expr_value);
}

static double *row_of(const struct expr_program *program, uint16_t value, double *rows) {
    return rows + (size_t)(value - program->constant_count) * EXPR_BATCH;
}

/* Copies inputs that are not direct. Incomplete vectors read only copies. */
static void put_inputs(const struct expr_program *program, uint32_t count, uint32_t width, double *rows,
                       struct expr_direct *direct) {
    const bool is_whole = width == count && cpu_isa() != CPU_ISA_BASE;
    for (int i = 0; i < program->input_count; i++) {
        if (is_whole && (program->direct_inputs >> i & 1))
            continue;
        double *row = row_of(program, program->inputs[i].value, rows);
        memcpy(row, direct->inputs[i], count * sizeof *row);
        for (uint32_t k = count; k < width; k++)
            row[k] = row[0]; /* so that it needs no more steps of a loop */
        direct->inputs[i] = row;
    }
}

void expr_evaluate_batch(const struct expr_program *program, uint32_t count,
                         const double *const inputs[EXPR_INPUT_COUNT], double *const outputs[EXPR_OUTPUTS],
                         void *rows) {
    static const uint32_t steps[] = {[CPU_ISA_BASE] = 4, [CPU_ISA_AVX2] = 4, [CPU_ISA_AVX512] = 8};
    const uint32_t step = steps[cpu_isa()], width = (count + step - 1) & ~(step - 1);
    const int last = cpu_isa() == CPU_ISA_BASE ? -1 : program->direct_output - 1;
    double *values = rows;
    struct expr_direct direct;
    for (int i = 0; i < program->input_count; i++)
        direct.inputs[i] = inputs[program->inputs[i].input];
    put_inputs(program, count, width, values, &direct);
    direct.output = last < 0 ? NULL : width == count ? outputs[last] : row_of(program, program->outputs[last], values);
    CPU_ISA_CALL(expr_run, program, width, values, &direct)
    for (int i = 0; i < program->output_count; i++) {
        uint16_t value = program->outputs[i];
        if (value >= program->constant_count) {
            const double *row = row_of(program, value, values);
            if (i != last || row == direct.output)
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

const struct expr_loop *expr_repeated(const struct expr_program *program, uint32_t instruction) {
    const struct expr_instruction *in = &program->code[instruction];
    return in->operation == EXPR_LOOP ? expr_loop_access(program, in).loop : NULL;
}

/* The registers that a loop names are those of its body. */
static void describe_loop_operation(const struct expr_program *program, const struct expr_instruction *in, char *out,
                                    size_t size) {
    const enum expr_operation operation = (enum expr_operation)in->operation;
    const struct expr_loop_access at = expr_loop_access(program, in);
    const struct expr_loop *loop = at.loop;
    const unsigned number = (unsigned)(loop - program->loops), slot = at.slot;
    char word[40] = "";
    if (at.puts)
        (void)describe_value(program, operation, 1, in->b, word, sizeof word);
    if (at.puts)
        (void)snprintf(out, size, "loop %u: r%u =%s", number, slot, word);
    else if (operation != EXPR_LOOP)
        (void)snprintf(out, size, "r%u = loop %u: r%u", (unsigned)(in->out - program->constant_count), number, slot);
    else
        (void)snprintf(out, size, "loop %u: for r%u = %u to %u%s", number, (unsigned)loop->argument_count, loop->first,
                       loop->last, loop->ends ? " while r0 > 0" : "");
}

void expr_describe(const struct expr_program *program, uint32_t instruction, char *out, size_t size) {
    const struct expr_instruction *in = &program->code[instruction];
    enum expr_operation operation = (enum expr_operation)in->operation;
    if (operation > EXPR_OPERATION_COUNT) {
        describe_loop_operation(program, in, out, size);
        return;
    }
    const uint16_t operands[3] = {in->a, in->b, in->c};
    char words[3][40] = {"", "", ""};
    for (int k = 0; k < expr_operand_count(operation); k++)
        (void)describe_value(program, operation, k, operands[k], words[k], sizeof words[k]);
    (void)snprintf(out, size, "r%u = %s%s%s%s", (unsigned)(in->out - program->constant_count),
                   expr_operation_name(operation), words[0], words[1], words[2]);
}

static void bundle_loop(struct bundle *bundle, void *expr_loop) {
    struct expr_loop *loop = expr_loop;
    expr_program_bundle(bundle, &loop->body);
    BUNDLE(bundle, loop->next, loop->state_count, NULL);
    BUNDLE(bundle, loop->type, loop->state_count, NULL);
}

void expr_program_bundle(struct bundle *bundle, void *function) {
    struct expr_program *program = function;
    program->source = NULL;
    BUNDLE(bundle, program->code, program->count, NULL);
    BUNDLE(bundle, program->constants, program->constant_count, NULL);
    BUNDLE(bundle, program->loops, program->loop_count, bundle_loop);
}
