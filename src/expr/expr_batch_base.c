/* Batches for the processor every build runs on. */
#define KERNEL(name) expr_##name##_base
#include "expr/expr_batch_kernel_internal.h"
