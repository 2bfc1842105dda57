/* The batch evaluator, compiled for each instruction set; expr_program.c selects one of them. */
#ifndef GRAY_EXPR_EXPR_BATCH_INTERNAL_H
#define GRAY_EXPR_EXPR_BATCH_INTERNAL_H

#include "base/isa.h"
#include "expr/expr_program.h"

/* What linked instructions read and write in place of rows, with any alignment: the direct inputs by their registers,
 * and the direct output (see struct expr_program). */
struct expr_direct {
    const double *inputs[EXPR_INPUT_COUNT];
    double *output; /* NULL: there is none */
};

/* rows: EXPR_BATCH values for each register, then three spare rows. The first `width` values of each row are
 * computed; width is a multiple of 4, for AVX-512 of 8. */
void expr_run_base(const struct expr_program *program, uint32_t width, double *rows, const struct expr_direct *direct);
void expr_run_avx2(const struct expr_program *program, uint32_t width, double *rows, const struct expr_direct *direct);
void expr_run_avx512(const struct expr_program *program, uint32_t width, double *rows,
                     const struct expr_direct *direct);

#endif
