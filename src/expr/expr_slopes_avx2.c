/* Bounds with slopes for processors with AVX2: four boxes in each vector. */
#define KERNEL(name) expr_##name##_avx2
#include "expr/expr_slopes_kernel_internal.h"
