/* Functions of a point or of a direction, in place of a hit: skies, colours of lights by direction, densities. */
#ifndef GRAY_EXPR_EXPR_FIELD_H
#define GRAY_EXPR_EXPR_FIELD_H

#include "expr/expr_program.h"
#include "math/vec3.h"

/* Sets of inputs: bit `input` of enum expr_input. */
enum { EXPR_POINT_INPUTS = 1U << EXPR_POINT_X | 1U << EXPR_POINT_Y | 1U << EXPR_POINT_Z };

/* Whether the program reads this input. */
bool expr_field_reads(const struct expr_program *program, enum expr_input input);
/* Whether the program reads only these inputs. Error: "the function reads s.u, but WORDS". */
bool expr_field_reads_only(const struct expr_program *program, unsigned inputs, const char *words, struct error *error);

/* The value for a point or a unit direction p; the other inputs are 0. One output is all three components. Numbers
 * below 0 and those that are not finite count as 0. */
struct colour expr_field_at(const struct expr_program *program, struct vec3 p);

/* Many points: `inputs` writes those of point i that the program reads. */
struct expr_points {
    size_t count;
    void (*inputs)(const void *context, size_t i, double inputs[EXPR_INPUT_COUNT]);
    const void *context;
};
/* Evaluates all points in batches; values: output_count numbers each. Errors: "at p = {1, 2, 3} the function is not a
 * number (NaN)" for the first value that is not finite, no memory. */
bool expr_field_evaluate(const struct expr_program *program, const struct expr_points *points, double *values,
                         struct error *error);

/* A bound of all components over all unit directions, at least 0: from intervals. Where these are infinite, it is an
 * estimate from some directions. False: no memory. */
bool expr_field_largest(const struct expr_program *program, double *largest);

#endif
