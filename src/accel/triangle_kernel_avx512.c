/* The same as with AVX2, eight wide, with twice as many registers. */
#if defined(__AVX512VL__)
#define KERNEL(name) triangle_##name##_avx512
#include "accel/triangle_kernel_internal.h"
#else
#include "accel/triangle_kernels_internal.h"
#endif
