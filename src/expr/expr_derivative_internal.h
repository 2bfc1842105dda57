/* Bounds with slopes, one instruction at a time: for the evaluators of one box and of eight
 * (expr_slopes_internal.h). */
#ifndef GRAY_EXPR_EXPR_DERIVATIVE_INTERNAL_H
#define GRAY_EXPR_EXPR_DERIVATIVE_INTERNAL_H

#include "expr/expr_derivative.h"
#include "expr/expr_interval_internal.h"

/* A value with its slopes, and the largest slopes of its root: INFINITY where nothing is known. */
struct expr_rooted {
    struct expr_range range;
    double roots[EXPR_DIRECTIONS];
};

/* One instruction on operands whose bounds are known. */
void expr_rooted_apply(const struct expr_instruction *in, const struct expr_rooted *from[3], int directions,
                       struct expr_rooted *out);
/* Repeats the body of a loop. values: of the body, with its arguments, which become the final states. scratch: for the
 * bounds of all values of the body. */
void expr_rooted_loop(const struct expr_loop *loop, int directions, struct expr_rooted *values,
                      struct expr_interval *scratch);
/* A constant operand; of EXPR_TYPE_N any interval. */
struct expr_interval expr_interval_of_constant(enum expr_type type, union expr_value value);

#endif
