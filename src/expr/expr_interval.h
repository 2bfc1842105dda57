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

/* Every value is NaN, which only happens where may_be_nan is set, or low <= value <= high (-0 counts as 0). Integers
 * are bounded by doubles; truths are 0 (false) and 1. */
struct expr_interval {
    double low, high;
    bool may_be_nan;
};

/* Boxes that are evaluated at once, and lanes of a choice. */
enum { EXPR_BOXES = 64 };

/* Of one instruction: bit i is set if box i always takes the first operand (of min, max, abs, and where a condition
 * holds) or the second. */
struct expr_choice {
    uint64_t first, second;
};

/* One operation on intervals; those that it does not read may be anything. Of numbers or truths by their types. */
struct expr_interval expr_interval_apply(enum expr_operation operation, struct expr_interval a, struct expr_interval b,
                                         struct expr_interval c);

/* Bytes that expr_evaluate_interval works in. */
size_t expr_interval_size(const struct expr_program *program);
/* Bounds of the outputs over one box. inputs: by enum expr_input, of which only those that the program reads count.
 * choices: one for each instruction, of which lane 0 is written; or NULL. rows: expr_interval_size bytes, aligned to
 * 64, whatever they hold. */
void expr_evaluate_interval(const struct expr_program *program, const struct expr_interval inputs[EXPR_INPUT_COUNT],
                            struct expr_interval outputs[EXPR_OUTPUTS], struct expr_choice *choices, void *rows);

#endif
