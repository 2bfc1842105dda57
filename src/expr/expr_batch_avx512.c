/* Batches for processors with AVX-512: eight points in each vector. */
#define KERNEL(name) expr_##name##_avx512
#include "expr/expr_batch_kernel_internal.h"
