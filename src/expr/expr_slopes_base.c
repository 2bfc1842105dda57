/* Bounds with slopes for every x86-64 processor. */
#define KERNEL(name) expr_##name##_base
#include "expr/expr_slopes_kernel_internal.h"
