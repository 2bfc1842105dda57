/* Bounds of expressions over boxes of their inputs (interval arithmetic: R. E. Moore, "Interval Analysis", 1966; T.
 * Duff, "Interval arithmetic and recursive subdivision for implicit functions and constructive solid geometry",
 * SIGGRAPH 1992), and programs shortened for a box by what the bounds decide (M. Keeter, "Massively parallel rendering
 * of complex closed-form implicit surfaces", SIGGRAPH 2020).
 *
 * Ends are rounded outwards, so that they bound what the program computes and, but for underflow, the function itself.
 * The bounds have the same bits on every machine. */
#ifndef GRAY_EXPR_EXPR_INTERVAL_H
#define GRAY_EXPR_EXPR_INTERVAL_H

#include "expr/expr_program.h"

/* Either low <= value <= high (-0 counts as 0), or the value is NaN, which happens only if may_be_nan is set.
 * Integers are bounded by doubles; truth values are 0 (false) and 1. */
struct expr_interval {
    double low, high;
    bool may_be_nan;
};

/* Boxes that are evaluated at once, and lanes of a choice. */
enum { EXPR_BOXES = 64 };

/* The decisions of one instruction. Bit i is set if the first operand, or the second, is always selected in box i:
 * by min, max and abs, or by a condition. */
struct expr_choice {
    uint64_t first, second;
};

/* Evaluates one operation on intervals; it ignores operands that the operation does not have. The types of the
 * operands decide between numbers and truth values. */
struct expr_interval expr_interval_apply(enum expr_operation operation, struct expr_interval a, struct expr_interval b,
                                         struct expr_interval c);

/* Bounds of the outputs over one box. inputs: by enum expr_input; the program ignores those that it does not read.
 * choices: one for each instruction, of which lane 0 is written, or NULL. rows: an interval for each constant and row,
 * at most EXPR_VALUES, with any contents. */
void expr_evaluate_interval(const struct expr_program *program, const struct expr_interval inputs[EXPR_INPUT_COUNT],
                            struct expr_interval outputs[EXPR_OUTPUTS], struct expr_choice *choices, void *rows);

/* Up to EXPR_BOXES boxes: the ends of input i are low[i] and high[i], one for each box. The program ignores inputs that
 * it does not read; they may be NULL. */
struct expr_boxes {
    uint32_t count;
    const double *low[EXPR_INPUT_COUNT], *high[EXPR_INPUT_COUNT];
};

/* Bounds of one output over the boxes. */
struct expr_bounds {
    double low[EXPR_BOXES], high[EXPR_BOXES];
    uint64_t may_be_nan; /* bit i: in box i */
};

/* The size in bytes of the memory that expr_evaluate_intervals needs. */
size_t expr_intervals_size(const struct expr_program *program);
/* The same as expr_evaluate_interval for each of the boxes, which are lanes of the choices. choices: one for each
 * instruction, or NULL. rows: expr_intervals_size bytes, aligned to 64, with any contents. */
void expr_evaluate_intervals(const struct expr_program *program, const struct expr_boxes *boxes,
                             struct expr_bounds outputs[EXPR_OUTPUTS], struct expr_choice *choices, void *rows);

#endif
