/* Batches for processors with AVX2, four points at once. Nothing here runs before system.c has asked the processor;
 * where the compiler knows no AVX2 these are the functions of the base. */
#define KERNEL(name) expr_##name##_avx2
#include "expr/expr_batch_kernel_internal.h"
