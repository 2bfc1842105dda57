/* Bounds of expressions over a patch with two parameters, by affine forms (J. Comba and J. Stolfi, "Affine arithmetic
 * and its applications to computer graphics", SIBGRAPI 1993): a value is middle + slopes[0] a + slopes[1] b + e, where
 * a and b are the parameters, from -1 to 1, and |e| <= rest. They keep what intervals lose: the coordinates of the
 * points of a patch depend on each other, and the bounds of a product of a direction and a constant vector have an error
 * that falls with the square of the size of the patch. */
#ifndef GRAY_EXPR_EXPR_AFFINE_H
#define GRAY_EXPR_EXPR_AFFINE_H

#include "expr/expr_interval.h"

struct expr_affine {
    double middle, slopes[2], rest;
};

struct expr_affine expr_affine_add(struct expr_affine a, struct expr_affine b);
struct expr_affine expr_affine_scale(struct expr_affine a, double factor);
struct expr_affine expr_affine_multiply(struct expr_affine a, struct expr_affine b);

/* The size in bytes of the memory that expr_evaluate_affine needs. */
size_t expr_affine_size(const struct expr_program *program);
/* Bounds of the outputs over the patch: sums, differences and products of affine forms are affine forms, all other
 * operations are those of expr_interval.h, and so are all in programs with loops. inputs: by enum expr_input. rows:
 * expr_affine_size bytes, with any contents. */
void expr_evaluate_affine(const struct expr_program *program, const struct expr_affine inputs[EXPR_INPUT_COUNT],
                          struct expr_interval outputs[EXPR_OUTPUTS], void *rows);

#endif
