/* Bounds for processors with AVX2: four boxes in each vector. isa.c checks the processor before any of this
 * runs. A compiler without AVX2 makes the base functions from this file. */
#define KERNEL(name) expr_##name##_avx2
#include "expr/expr_interval_kernel_internal.h"
