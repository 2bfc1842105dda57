#define GRAY_NO_JUMPS
#define expr_compile expr_compile_by_switch
#define expr_evaluate expr_evaluate_by_switch
#define expr_batch_size expr_batch_size_by_switch
#define expr_evaluate_batch expr_evaluate_batch_by_switch
#define expr_repeated expr_repeated_by_switch
#define expr_describe expr_describe_by_switch
#define expr_program_bundle expr_program_bundle_by_switch
#include "tests/unit/expr_by_switch.h"

#include "expr/expr_program.c"
