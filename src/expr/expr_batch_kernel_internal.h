/* The batch evaluator, compiled for the instruction set of the file that includes this one. Each instruction is one
 * loop over the points, with a constant length for whole batches. The loops come from the list of operations, and
 * the compiler vectorises them. No result depends on the number of points in a vector. */
#include "expr/expr_batch_internal.h"

/* Rows of doubles also store integers and truth values. */
typedef int64_t __attribute__((may_alias)) row_integer;

#define TYPE_F double
#define TYPE_I row_integer
#define TYPE_B row_integer
#define TYPE_N row_integer
/* The result may be stored over an operand. Each point only reads its own operands, so the loop has no dependency
 * between points. */
#if defined(__clang__)
#define INDEPENDENT _Pragma("clang loop vectorize(assume_safety)")
#else
#define INDEPENDENT _Pragma("GCC ivdep")
#endif
#define LOOP(bound, A, B, C, expression)                                                                               \
    {                                                                                                                  \
        INDEPENDENT                                                                                                    \
        for (uint32_t i = 0; i < (bound); i++) {                                                                       \
            TYPE_##A a = as[i];                                                                                        \
            TYPE_##B b = bs[i];                                                                                        \
            TYPE_##C c = cs[i];                                                                                        \
            (void)a, (void)b, (void)c;                                                                                 \
            out[i] = (expression);                                                                                     \
        }                                                                                                              \
    }
#define RUN(member, name, R, A, B, C, expression)                                                                      \
    case member: {                                                                                                     \
        TYPE_##R *out = (TYPE_##R *)(void *)to;                                                                        \
        const TYPE_##A *as = (const TYPE_##A *)(const void *)from[0];                                                  \
        const TYPE_##B *bs = (const TYPE_##B *)(const void *)from[1];                                                  \
        const TYPE_##C *cs = (const TYPE_##C *)(const void *)from[2];                                                  \
        if (width == EXPR_BATCH)                                                                                       \
            LOOP(EXPR_BATCH, A, B, C, expression)                                                                      \
        else                                                                                                           \
            LOOP(width, A, B, C, expression)                                                                           \
        break;                                                                                                         \
    }

/* The row of a value. A constant is copied into all of `spare`. */
static inline const double *row_of(const struct expr_program *program, uint16_t value, uint32_t width, double *rows,
                                   double *spare) {
    if (value >= program->constant_count)
        return rows + (size_t)(value - program->constant_count) * EXPR_BATCH;
    row_integer *out = (row_integer *)(void *)spare, x = program->constants[value].i;
    for (uint32_t i = 0; i < width; i++)
        out[i] = x;
    return spare;
}

void KERNEL(run)(const struct expr_program *program, uint32_t width, double *rows) {
    double *spare = rows + (size_t)program->register_count * EXPR_BATCH;
    for (const struct expr_instruction *in = program->code, *end = in + program->count; in < end; in++) {
        double *to = rows + (size_t)(in->out - program->constant_count) * EXPR_BATCH;
        const double *from[3] = {row_of(program, in->a, width, rows, spare),
                                 row_of(program, in->b, width, rows, spare + EXPR_BATCH),
                                 row_of(program, in->c, width, rows, spare + 2 * EXPR_BATCH)};
        switch ((enum expr_operation)in->operation) {
            EXPR_OPERATIONS(RUN)
        case EXPR_CONSTANT:
        case EXPR_INPUT:
        case EXPR_OPERATION_COUNT:
            break;
        }
    }
}
