/* The searches for the processor every build runs on: SSE2 on x86-64, plain C elsewhere. */
#define KERNEL(name) triangle_##name##_base
#include "accel/triangle_kernel_internal.h"
