/* Batches for every x86-64 processor. */
#define KERNEL(name) expr_##name##_base
#include "expr/expr_batch_kernel_internal.h"
