/* The searches for processors with AVX2 and FMA (which only single precision uses). This file is compiled for them, and
 * nothing in it runs before isa.c has detected them. */
#if defined(__AVX2__)
#define KERNEL(name) triangle_##name##_avx2
#include "accel/triangle_kernel_internal.h"
#else
#include "accel/triangle_kernels_internal.h"
#endif
