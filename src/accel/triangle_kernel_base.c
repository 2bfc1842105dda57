/* The searches for the baseline processor: SSE2 on x86-64, plain C elsewhere. */
#define KERNEL(name) triangle_##name##_base
#include "accel/triangle_kernel_internal.h"
