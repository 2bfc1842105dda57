/* Common functions of the interval evaluators: constants as intervals, and decisions between operands. */
#ifndef GRAY_EXPR_EXPR_INTERVAL_INTERNAL_H
#define GRAY_EXPR_EXPR_INTERVAL_INTERNAL_H

#include "base/isa.h"
#include "expr/expr_interval.h"

/* A constant NaN allows any number, too. */
static inline struct expr_interval expr_interval_of_float(double x) {
    return x == x ? (struct expr_interval){x, x, false} : (struct expr_interval){-INFINITY, INFINITY, true};
}

struct expr_interval expr_interval_of_integer(int64_t i);

static inline struct expr_interval expr_interval_of_truth(int64_t x) {
    return (struct expr_interval){x != 0, x != 0, false};
}

/* a * a */
struct expr_interval expr_interval_square(struct expr_interval a);

/* The decision for one box, in lane 0; a and b are the first two operands. */
struct expr_choice expr_interval_decide(enum expr_operation operation, struct expr_interval a, struct expr_interval b);

/* Repeats the body of a loop from `step` on over one box, whose points are all in that step. values: of the body, with
 * its arguments, which become the final states: for each state all values that a point of the box may end with. */
void expr_interval_loop(const struct expr_loop *loop, uint32_t step, struct expr_interval *values);

/* All steps from `step` on at once, over one box in whose loop these steps are too many to be bounded one by one.
 * values: as above. `ended`: bounds of the states of points that have ended, if has_ended; finally, of all points. */
void expr_interval_loop_rest(const struct expr_loop *loop, uint32_t step, bool has_ended, struct expr_interval *ended,
                             struct expr_interval *values);

/* Whether a point whose first state has these bounds may end, and whether it may go on. */
static inline bool expr_may_end(struct expr_interval first) {
    return first.may_be_nan || !(first.low > 0);
}

static inline bool expr_may_go_on(struct expr_interval first) {
    return first.high > 0;
}

/* Steps of a loop that are bounded one by one; the bounds of the others are those of all of them. */
enum { EXPR_EXACT_STEPS = 1024 };

/* The flags of a register in all boxes: of numbers whether they may be NaN (first), of truth values whether they
 * certainly (first) or possibly (second) hold. */
struct expr_flags {
    uint64_t first, second;
};

/* The evaluator of many boxes in each instruction set. rows: for each register EXPR_BOXES lower ends and as many upper
 * ones; flags: one for each register. Boxes up to `width`, a multiple of 8, are computed; choices: or NULL. */
void expr_run_intervals_base(const struct expr_program *program, uint32_t width, double *rows, struct expr_flags *flags,
                             struct expr_choice *choices);
void expr_run_intervals_avx2(const struct expr_program *program, uint32_t width, double *rows, struct expr_flags *flags,
                             struct expr_choice *choices);
void expr_run_intervals_avx512(const struct expr_program *program, uint32_t width, double *rows,
                               struct expr_flags *flags, struct expr_choice *choices);

#endif
