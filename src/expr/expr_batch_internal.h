/* The evaluator of batches in each instruction set it is built for; expr_program.c chooses between them. */
#ifndef GRAY_EXPR_EXPR_BATCH_INTERNAL_H
#define GRAY_EXPR_EXPR_BATCH_INTERNAL_H

#include "base/isa.h"
#include "expr/expr_program.h"

/* rows: EXPR_BATCH values for each register, then three spare rows; `width`, a multiple of 8, of each are computed. */
void expr_run_base(const struct expr_program *program, uint32_t width, double *rows);
void expr_run_avx2(const struct expr_program *program, uint32_t width, double *rows);
void expr_run_avx512(const struct expr_program *program, uint32_t width, double *rows);

#endif
