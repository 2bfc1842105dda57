/* Expressions ready for evaluation: a flat list of instructions over numbered values. Constants come first, then
 * registers, which are used again when no later instruction reads them. A program is immutable and in the arena of
 * the caller. Any number of threads may evaluate it at the same time. The results have the same bits on every
 * machine, for single points and in batches. */
#ifndef GRAY_EXPR_EXPR_PROGRAM_H
#define GRAY_EXPR_EXPR_PROGRAM_H

#include "base/arena.h"
#include "base/bundle.h"
#include "base/error.h"
#include "expr/expr_graph.h"

#include <stddef.h>

/* EXPR_VALUES: the maximum number of constants and registers of a program. EXPR_BATCH: points of a batch. */
enum { EXPR_VALUES = 8192, EXPR_OUTPUTS = 4, EXPR_BATCH = 64 };

struct expr_instruction {
    uint16_t operation;    /* enum expr_operation */
    uint16_t out, a, b, c; /* `out` for operands that the operation does not have */
    uint16_t link;         /* for the evaluators of points, see expr_link_internal.h; 0 is right but for EXPR_LOOP */
};

struct expr_loop;

struct expr_program {
    const char *source; /* of a function of a script, "scene.lua:12", for reports; or NULL */
    const struct expr_instruction *code;
    const union expr_value *constants; /* values 0 to constant_count - 1 */
    uint32_t count, constant_count, register_count;
    uint32_t row_count; /* the registers, and after them the memory of the loops, in registers */
    uint32_t loop_count;
    uint64_t loop_work;            /* instructions of all steps of the loops */
    const struct expr_loop *loops; /* by their number, see expr_loop_operand */
    int input_count, output_count;
    struct {
        uint16_t input, value; /* an enum expr_input, and the register that contains it at the start */
    } inputs[EXPR_INPUT_COUNT];
    uint16_t outputs[EXPR_OUTPUTS]; /* floats */
    /* What links of batches do not read from registers, or not write there: bit k is inputs[k]; 1 + the number of the
     * output that the last instruction computes, or 0. */
    uint16_t direct_inputs, direct_output;
};

/* A loop of a program. Its body is a program of its own, without inputs and outputs. The first registers of the body
 * are the states, then the values from outside, then the number of the step; they keep their values through the
 * body. */
struct expr_loop {
    struct expr_program body;
    uint32_t first, last; /* steps */
    bool ends;            /* see struct expr_graph_loop */
    uint16_t state_count, argument_count;
    const uint16_t *next;       /* values of the body: the new states; none is the register of another state */
    const enum expr_type *type; /* of the states */
    uint32_t offset;            /* of its memory, in registers of the program that contains it, after the constants */
};

/* The memory of a loop, in registers: the constants and rows of its body, and as many for evaluators that need another
 * form of them. */
static inline uint32_t expr_loop_rows(const struct expr_loop *loop) {
    return 2 * (loop->body.constant_count + loop->body.row_count + 3);
}

/* What an instruction of a loop names by a constant: the loop, and the slot of its memory, after the constants of its
 * body; `value` is that slot by its number among the values of the program. An instruction that puts a value there has
 * the constant as its operand c, others as b. */
struct expr_loop_access {
    bool puts;
    const struct expr_loop *loop;
    uint32_t slot, value;
};

static inline struct expr_loop_access expr_loop_access(const struct expr_program *program,
                                                       const struct expr_instruction *in) {
    const enum expr_operation operation = (enum expr_operation)in->operation;
    const bool puts = operation == EXPR_PUT_FLOAT || operation == EXPR_PUT_INTEGER || operation == EXPR_PUT_TRUTH;
    const int64_t named = program->constants[puts ? in->c : in->b].i;
    const struct expr_loop *loop = &program->loops[named >> 16];
    const uint32_t slot = (uint32_t)(named & 0xffff);
    return (struct expr_loop_access){puts, loop, slot,
                                     program->constant_count + loop->offset + loop->body.constant_count + slot};
}

/* How many instructions a point needs at most, with the steps of loops. */
static inline uint64_t expr_work(const struct expr_program *program) {
    return program->count + program->loop_work;
}

/* Whether an instruction and the next one are the sine and the cosine of one number, in any order. */
static inline bool expr_is_pair(const struct expr_instruction *in, const struct expr_instruction *end) {
    return in + 1 < end && in[1].a == in->a && in->out != in->a &&
           in[1].operation == (in->operation == EXPR_SIN ? EXPR_COS : EXPR_SIN);
}

/* Compiles the program that computes these nodes, which are floats and at most EXPR_OUTPUTS. False and an error: no
 * memory, more than EXPR_VALUES values, or loops deeper in each other than EXPR_DEPTH. */
bool expr_compile(const struct expr_graph *graph, const uint32_t *outputs, int output_count, struct arena *arena,
                  struct expr_program *program, struct error *error);

/* Evaluates one point. inputs: by enum expr_input; the program ignores those that it does not read. */
void expr_evaluate(const struct expr_program *program, const double inputs[EXPR_INPUT_COUNT],
                   double outputs[EXPR_OUTPUTS]);

/* The size in bytes of the memory that expr_evaluate_batch needs. */
size_t expr_batch_size(const struct expr_program *program);
/* Evaluates `count` points, at most EXPR_BATCH. inputs[i] and outputs[i] are arrays of `count` numbers; inputs that
 * the program does not read may be NULL. No output overlaps an input. rows: expr_batch_size bytes, aligned to 64, with
 * any contents. */
void expr_evaluate_batch(const struct expr_program *program, uint32_t count,
                         const double *const inputs[EXPR_INPUT_COUNT], double *const outputs[EXPR_OUTPUTS], void *rows);

/* Prints one instruction: "r12 = add r3 0.5", at most `size` bytes with the final NUL. Those of a loop: "loop 0: r1 =
 * r7" with a register of its body, "loop 0: for r5 = 1 to 99 while r0 > 0", "r9 = loop 0: r1". */
void expr_describe(const struct expr_program *program, uint32_t instruction, char *out, size_t size);
/* The loop that an instruction repeats (EXPR_LOOP), or NULL. */
const struct expr_loop *expr_repeated(const struct expr_program *program, uint32_t instruction);
/* What it points to (base/bundle.h). */
bundle_fields expr_program_bundle;

#endif
