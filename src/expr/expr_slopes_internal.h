/* Common parts of the evaluators of bounds with slopes: one box at a time in expr_derivative.c, eight at once in the
 * kernel of each instruction set. */
#ifndef GRAY_EXPR_EXPR_SLOPES_INTERNAL_H
#define GRAY_EXPR_EXPR_SLOPES_INTERNAL_H

#include "expr/expr_derivative.h"
#include "expr/expr_interval_internal.h"

/* A value in eight boxes. Truth values are 0 and 1. */
struct expr_lanes {
    double low[EXPR_LANES], high[EXPR_LANES];
    struct {
        double low[EXPR_LANES], high[EXPR_LANES];
    } slopes[EXPR_DIRECTIONS];
    double roots[EXPR_DIRECTIONS][EXPR_LANES]; /* only if has_roots */
    uint32_t may_be_nan, is_nan;               /* bit i: in box i */
    bool has_roots;
} __attribute__((aligned(64)));

/* values: one for each register, those of the inputs filled in. choices: or NULL. */
void expr_run_slopes_base(const struct expr_program *program, int directions, bool are_cases, struct expr_lanes *values,
                          struct expr_choice *choices);
void expr_run_slopes_avx2(const struct expr_program *program, int directions, bool are_cases, struct expr_lanes *values,
                          struct expr_choice *choices);
void expr_run_slopes_avx512(const struct expr_program *program, int directions, bool are_cases,
                            struct expr_lanes *values, struct expr_choice *choices);

#endif
