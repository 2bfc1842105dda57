/* The evaluator of expressions at one point as compiled where no addresses of labels exist. */
#ifndef GRAY_TESTS_EXPR_BY_SWITCH_H
#define GRAY_TESTS_EXPR_BY_SWITCH_H

#include "expr/expr_program.h"

void expr_evaluate_by_switch(const struct expr_program *program, const double inputs[EXPR_INPUT_COUNT],
                             double outputs[EXPR_OUTPUTS]);

#endif
