/* The operations of expressions: one list, from which the graph, its folding and every evaluator are generated, so
 * that they cannot disagree. The results are those of Lua 5.4 (reference manual, sections 3.4 and 6.7), bit for bit
 * except for the bits of a NaN: floats are doubles, integers wrap around, // and % round towards minus infinity. */
#ifndef GRAY_EXPR_EXPR_OPERATIONS_H
#define GRAY_EXPR_EXPR_OPERATIONS_H

#include "image/image_function.h"
#include "math/elementary.h"
#include "math/noise.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

/* A value in a register. The operation determines which member is valid; a truth value is 0 or -1, all bits set. */
union expr_value {
    double f;
    int64_t i;
};

/* Each line: member, name in listings, types of the result and of the three operands (F float, I integer, B truth
 * value, N none), and the result in terms of a, b and c. Where Lua raises an error (an integer division by zero, a
 * float without an integer value), the recorder checks the operands; here the result is arbitrary. */
#define EXPR_OPERATIONS(X)                                                                                             \
    X(EXPR_COPY, "copy", F, F, N, N, a)                                                                                \
    X(EXPR_ADD, "add", F, F, F, N, a + b)                                                                              \
    X(EXPR_SUBTRACT, "subtract", F, F, F, N, a - b)                                                                    \
    X(EXPR_MULTIPLY, "multiply", F, F, F, N, a *b)                                                                     \
    X(EXPR_DIVIDE, "divide", F, F, F, N, a / b)                                                                        \
    X(EXPR_FLOOR_DIVIDE, "floor_divide", F, F, F, N, floor(a / b))                                                     \
    X(EXPR_MODULO, "modulo", F, F, F, N, expr_modulo(a, b))                                                            \
    X(EXPR_POWER, "power", F, F, F, N, el_pow(a, b))                                                                   \
    X(EXPR_NEGATE, "negate", F, F, N, N, -a)                                                                           \
    X(EXPR_ABS, "abs", F, F, N, N, fabs(a))                                                                            \
    X(EXPR_SQRT, "sqrt", F, F, N, N, sqrt(a))                                                                          \
    X(EXPR_FLOOR, "floor", F, F, N, N, floor(a))                                                                       \
    X(EXPR_CEIL, "ceil", F, F, N, N, ceil(a))                                                                          \
    X(EXPR_REMAINDER, "remainder", F, F, F, N, el_fmod(a, b))                                                          \
    X(EXPR_MIN, "min", F, F, F, N, b < a ? b : a)                                                                      \
    X(EXPR_MAX, "max", F, F, F, N, a < b ? b : a)                                                                      \
    X(EXPR_SIN, "sin", F, F, N, N, el_sin(a))                                                                          \
    X(EXPR_COS, "cos", F, F, N, N, el_cos(a))                                                                          \
    X(EXPR_TAN, "tan", F, F, N, N, el_tan(a))                                                                          \
    X(EXPR_ASIN, "asin", F, F, N, N, el_asin(a))                                                                       \
    X(EXPR_ACOS, "acos", F, F, N, N, el_acos(a))                                                                       \
    X(EXPR_ATAN, "atan", F, F, F, N, el_atan2(a, b))                                                                   \
    X(EXPR_EXP, "exp", F, F, N, N, el_exp(a))                                                                          \
    X(EXPR_LOG, "log", F, F, N, N, el_log(a))                                                                          \
    X(EXPR_LOG2, "log2", F, F, N, N, el_log2(a))                                                                       \
    X(EXPR_LOG10, "log10", F, F, N, N, el_log10(a))                                                                    \
    X(EXPR_SINH, "sinh", F, F, N, N, el_sinh(a))                                                                       \
    X(EXPR_COSH, "cosh", F, F, N, N, el_cosh(a))                                                                       \
    X(EXPR_TANH, "tanh", F, F, N, N, el_tanh(a))                                                                       \
    X(EXPR_NOISE, "noise", F, F, F, F, noise_perlin(a, b, c, 0))                                                       \
    X(EXPR_HASH, "hash", F, F, F, F, noise_hash(a, b, c))                                                              \
    X(EXPR_CELL_NEAREST, "cell_nearest", F, F, F, F, noise_cells(a, b, c).nearest)                                     \
    X(EXPR_CELL_SECOND, "cell_second", F, F, F, F, noise_cells(a, b, c).second)                                        \
    X(EXPR_CELL_ID, "cell_id", F, F, F, F, noise_cells(a, b, c).id)                                                    \
    X(EXPR_TEXEL, "texel", F, F, F, I, expr_texel(a, b, c))                                                            \
    X(EXPR_INTEGER_ADD, "integer_add", I, I, I, N, (int64_t)((uint64_t)a + (uint64_t)b))                               \
    X(EXPR_INTEGER_SUBTRACT, "integer_subtract", I, I, I, N, (int64_t)((uint64_t)a - (uint64_t)b))                     \
    X(EXPR_INTEGER_MULTIPLY, "integer_multiply", I, I, I, N, (int64_t)((uint64_t)a * (uint64_t)b))                     \
    X(EXPR_INTEGER_DIVIDE, "integer_divide", I, I, I, N, expr_integer_divide(a, b))                                    \
    X(EXPR_INTEGER_MODULO, "integer_modulo", I, I, I, N, expr_integer_modulo(a, b))                                    \
    X(EXPR_INTEGER_REMAINDER, "integer_remainder", I, I, I, N, expr_integer_remainder(a, b))                           \
    X(EXPR_INTEGER_NEGATE, "integer_negate", I, I, N, N, (int64_t)(0 - (uint64_t)a))                                   \
    X(EXPR_BIT_AND, "bit_and", I, I, I, N, a &b)                                                                       \
    X(EXPR_BIT_OR, "bit_or", I, I, I, N, a | b)                                                                        \
    X(EXPR_BIT_XOR, "bit_xor", I, I, I, N, a ^ b)                                                                      \
    X(EXPR_BIT_NOT, "bit_not", I, I, N, N, ~a)                                                                         \
    X(EXPR_SHIFT_LEFT, "shift_left", I, I, I, N, expr_shift_left(a, b))                                                \
    X(EXPR_SHIFT_RIGHT, "shift_right", I, I, I, N, expr_shift_left(a, (int64_t)(0 - (uint64_t)b)))                     \
    X(EXPR_TO_FLOAT, "to_float", F, I, N, N, (double)a)                                                                \
    X(EXPR_TO_INTEGER, "to_integer", I, F, N, N, expr_to_integer(a))                                                   \
    X(EXPR_LESS, "less", B, F, F, N, -(int64_t)(a < b))                                                                \
    X(EXPR_LESS_EQUAL, "less_equal", B, F, F, N, -(int64_t)(a <= b))                                                   \
    X(EXPR_EQUAL, "equal", B, F, F, N, -(int64_t)(a == b))                                                             \
    X(EXPR_INTEGER_LESS, "integer_less", B, I, I, N, -(int64_t)(a < b))                                                \
    X(EXPR_INTEGER_LESS_EQUAL, "integer_less_equal", B, I, I, N, -(int64_t)(a <= b))                                   \
    X(EXPR_INTEGER_EQUAL, "integer_equal", B, I, I, N, -(int64_t)(a == b))                                             \
    X(EXPR_MIXED_LESS, "mixed_less", B, I, F, N, -(int64_t)(expr_order(a, b) == -1))                                   \
    X(EXPR_MIXED_LESS_EQUAL, "mixed_less_equal", B, I, F, N, -(int64_t)(expr_order(a, b) <= 0))                        \
    X(EXPR_MIXED_GREATER, "mixed_greater", B, I, F, N, -(int64_t)(expr_order(a, b) == 1))                              \
    X(EXPR_MIXED_GREATER_EQUAL, "mixed_greater_equal", B, I, F, N, -(int64_t)(expr_order(a, b) >> 1 == 0))             \
    X(EXPR_MIXED_EQUAL, "mixed_equal", B, I, F, N, -(int64_t)(expr_order(a, b) == 0))                                  \
    X(EXPR_WHOLE, "whole", B, F, N, N, -(int64_t)(expr_is_integer(a)))                                                 \
    X(EXPR_SELECT, "select", F, B, F, F, a ? b : c)                                                                    \
    X(EXPR_INTEGER_SELECT, "integer_select", I, B, I, I, a ? b : c)                                                    \
    X(EXPR_TRUTH_SELECT, "truth_select", B, B, B, B, a ? b : c)

/* The operations of a loop, which is one unit of several instructions: the first ones put an initial state, or a value
 * from outside that the body reads, into its memory; EXPR_LOOP repeats the body; the last ones take the final states.
 * Their integer operands and results only keep them in this order: operand a is the instruction before. The last
 * operand is a constant, expr_loop_operand. Each line: member, name, types of the result and of the operands. */
#define EXPR_LOOP_OPERATIONS(X)                                                                                        \
    X(EXPR_PUT_FLOAT, "put", I, I, F, I)                                                                               \
    X(EXPR_PUT_INTEGER, "put", I, I, I, I)                                                                             \
    X(EXPR_PUT_TRUTH, "put", I, I, B, I)                                                                               \
    X(EXPR_LOOP, "loop", I, I, I, N)                                                                                   \
    X(EXPR_TAKE_FLOAT, "take", F, I, I, N)                                                                             \
    X(EXPR_TAKE_INTEGER, "take", I, I, I, N)                                                                           \
    X(EXPR_TAKE_TRUTH, "take", B, I, I, N)
/* For switches over all operations. */
#define EXPR_LOOP_CASES                                                                                                \
    case EXPR_PUT_FLOAT:                                                                                               \
    case EXPR_PUT_INTEGER:                                                                                             \
    case EXPR_PUT_TRUTH:                                                                                               \
    case EXPR_LOOP:                                                                                                    \
    case EXPR_TAKE_FLOAT:                                                                                              \
    case EXPR_TAKE_INTEGER:                                                                                            \
    case EXPR_TAKE_TRUTH

/* Of a type: the C type of its values, their member of union expr_value, and whether there is an operand. */
#define EXPR_C_TYPE_F double
#define EXPR_C_TYPE_I int64_t
#define EXPR_C_TYPE_B int64_t
#define EXPR_C_TYPE_N int64_t
#define EXPR_MEMBER_F f
#define EXPR_MEMBER_I i
#define EXPR_MEMBER_B i
#define EXPR_MEMBER_N i
#define EXPR_HAS_F 1
#define EXPR_HAS_I 1
#define EXPR_HAS_B 1
#define EXPR_HAS_N 0

#define EXPR_OPERATION_MEMBER(member, ...) member,
enum expr_operation {
    EXPR_CONSTANT, /* leaves of the graph; they are no instructions */
    EXPR_INPUT,
    EXPR_OPERATIONS(EXPR_OPERATION_MEMBER) EXPR_OPERATION_COUNT,
    EXPR_LOOP_OPERATIONS(EXPR_OPERATION_MEMBER) EXPR_ALL_OPERATIONS
};
enum expr_type { EXPR_TYPE_F, EXPR_TYPE_I, EXPR_TYPE_B, EXPR_TYPE_N };

/* The third operand of EXPR_TEXEL is a constant: the address of a struct image_function, which its lowest two bits do
 * not need, plus the channel. Addresses are below 2^53, so that bounds of integers have them exactly. */
static inline int64_t expr_texel_operand(const struct image_function *function, int channel) {
    return (int64_t)((uintptr_t)function | (uintptr_t)channel);
}

static inline const struct image_function *expr_texel_function(int64_t operand) {
    return (const struct image_function *)((uintptr_t)operand & ~(uintptr_t)3);
}

static inline double expr_texel(double u, double v, int64_t operand) {
    return image_function_value(expr_texel_function(operand), u, v, (int)(operand & 3));
}

/* The number of a loop in its program (while recording, in the graph), and a slot of it. */
static inline int64_t expr_loop_operand(uint32_t loop, uint32_t slot) {
    return (int64_t)((uint64_t)loop << 16 | slot);
}

static inline double expr_modulo(double a, double b) {
    double m = el_fmod(a, b);
    return (m > 0 ? b < 0 : m < 0 && b > 0) ? m + b : m;
}

/* The quotient, rounded down. A division by 0 gives 0; the recorder has reported it as an error before. */
static inline int64_t expr_integer_divide(int64_t a, int64_t b) {
    if ((uint64_t)b + 1 <= 1) /* 0 and -1 */
        return b ? (int64_t)(0 - (uint64_t)a) : 0;
    int64_t quotient = a / b;
    return (a ^ b) < 0 && a % b != 0 ? quotient - 1 : quotient;
}

static inline int64_t expr_integer_modulo(int64_t a, int64_t b) {
    if ((uint64_t)b + 1 <= 1)
        return 0;
    int64_t m = a % b;
    return m != 0 && (m ^ b) < 0 ? m + b : m;
}

/* math.fmod of integers: the result has the sign of a. */
static inline int64_t expr_integer_remainder(int64_t a, int64_t b) {
    return (uint64_t)b + 1 <= 1 ? 0 : a % b;
}

/* A negative b shifts to the right; both directions fill with zeros. */
static inline int64_t expr_shift_left(int64_t a, int64_t b) {
    if (b <= -64 || b >= 64)
        return 0;
    return (int64_t)(b < 0 ? (uint64_t)a >> -b : (uint64_t)a << b);
}

static inline bool expr_is_integer(double x) {
    return x >= -0x1p63 && x < 0x1p63 && floor(x) == x;
}

/* Rounds towards zero; the smallest integer if the result is no integer of 64 bits. */
static inline int64_t expr_to_integer(double x) {
    return x >= -0x1p63 && x < 0x1p63 ? (int64_t)x : INT64_MIN;
}

/* Compares exactly: -1, 0 or 1 if a is less than, equal to or greater than b; 3 if b is NaN. */
static inline int expr_order(int64_t a, double b) {
    double rounded = (double)a;
    if (rounded < b)
        return -1;
    if (rounded > b)
        return 1;
    if (!(rounded == b))
        return 3;
    if (b >= 0x1p63) /* a was rounded up to it */
        return -1;
    return a < (int64_t)b ? -1 : a > (int64_t)b;
}

#endif
