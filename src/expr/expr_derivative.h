/* Derivatives of expressions, forwards, with their values: at points and over boxes (L. B. Rall, "Automatic
 * Differentiation", 1981). */
#ifndef GRAY_EXPR_EXPR_DERIVATIVE_H
#define GRAY_EXPR_EXPR_DERIVATIVE_H

#include "expr/expr_interval.h"

/* The number of directions that are evaluated together. */
enum { EXPR_DIRECTIONS = 3 };

/* seeds[input][direction]: the derivative of an input along a direction. These are the directions x, y and z of p. */
extern const double expr_gradient_seeds[EXPR_INPUT_COUNT][EXPR_DIRECTIONS];

/* The size in bytes of the memory that expr_evaluate_gradient needs; at most EXPR_GRADIENT_LIMIT. */
enum { EXPR_GRADIENT_LIMIT = EXPR_VALUES * (int)(sizeof(union expr_value) + EXPR_DIRECTIONS * sizeof(double)) };
size_t expr_gradient_size(const struct expr_program *program);
/* The outputs at one point, with the bits of expr_evaluate, and their derivatives in three directions. At edges and
 * jumps it is the derivative of one side, for selections that of the selected side. It is NaN or infinite where the
 * formula is (the root of 0). rows: expr_gradient_size bytes, aligned to 64. */
void expr_evaluate_gradient(const struct expr_program *program, const double inputs[EXPR_INPUT_COUNT],
                            const double seeds[EXPR_INPUT_COUNT][EXPR_DIRECTIONS], double outputs[EXPR_OUTPUTS],
                            double gradients[EXPR_OUTPUTS][EXPR_DIRECTIONS], void *rows);

/* The first `count` directions of `seeds`. */
struct expr_directions {
    int count;
    double seeds[EXPR_INPUT_COUNT][EXPR_DIRECTIONS];
};

/* Bounds of a value and of its slopes. */
struct expr_range {
    struct expr_interval value, slopes[EXPR_DIRECTIONS];
    bool is_nan; /* the value is NaN everywhere */
};

/* The size in bytes of the memory that expr_evaluate_slopes needs. */
size_t expr_slopes_size(const struct expr_program *program);
/* Bounds of the outputs over a box (those of expr_evaluate_interval), and of their slopes in the directions: (f(a +
 * t seed) - f(a)) / t is within the bounds for all a and a + t seed in the box. So the bounds hold at edges, and are
 * infinite where the function may jump. choices: as in expr_evaluate_interval. rows: expr_slopes_size bytes, aligned
 * to 64. */
void expr_evaluate_slopes(const struct expr_program *program, const struct expr_interval inputs[EXPR_INPUT_COUNT],
                          const struct expr_directions *directions, struct expr_range outputs[EXPR_OUTPUTS],
                          struct expr_choice *choices, void *rows);

/* Boxes of expr_evaluate_slopes_lanes. */
enum { EXPR_LANES = 8 };

/* Eight boxes, or the cases of one box: then all lanes have the same ends, and the first three jumps that the box may
 * contain (a floor that takes two values, a remainder that passes the end of one period, a comparison that is not
 * decided) are divided among them, so that in a lane there is only one side of each. Every point of the box belongs to
 * a lane; each lane bounds the values of its points, but slopes across a jump are in none of them. */
struct expr_lane_inputs {
    double low[EXPR_INPUT_COUNT][EXPR_LANES], high[EXPR_INPUT_COUNT][EXPR_LANES];
    bool are_cases;
};

struct expr_lane_range {
    double low[EXPR_LANES], high[EXPR_LANES];
    struct {
        double low[EXPR_LANES], high[EXPR_LANES];
    } slopes[EXPR_DIRECTIONS];
    uint32_t may_be_nan, is_nan; /* bit i: in box i */
};

/* The size in bytes of the memory that expr_evaluate_slopes_lanes needs. */
size_t expr_lanes_size(const struct expr_program *program);
/* expr_evaluate_slopes of eight boxes at once; the ends may differ in their last digits. The boxes are lanes of the
 * choices. rows: expr_lanes_size bytes, aligned to 64, with any contents. */
void expr_evaluate_slopes_lanes(const struct expr_program *program, const struct expr_lane_inputs *inputs,
                                const struct expr_directions *directions, struct expr_lane_range outputs[EXPR_OUTPUTS],
                                struct expr_choice *choices, void *rows);

#endif
