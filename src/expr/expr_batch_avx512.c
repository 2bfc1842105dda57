/* The same as with AVX2, eight points at once. */
#define KERNEL(name) expr_##name##_avx512
#include "expr/expr_batch_kernel_internal.h"
