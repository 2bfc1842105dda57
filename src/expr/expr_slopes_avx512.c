/* Bounds with slopes for processors with AVX-512: eight boxes in each vector. */
#define KERNEL(name) expr_##name##_avx512
#include "expr/expr_slopes_kernel_internal.h"
