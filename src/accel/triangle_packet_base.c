/* Packets for the baseline processor: SSE2 on x86-64, plain C elsewhere. */
#define PACKET(name) triangle_packet_##name##_base
#include "accel/triangle_packet_kernel_internal.h"
