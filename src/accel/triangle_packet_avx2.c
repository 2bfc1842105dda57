/* Packets for processors with AVX2 and FMA, eight rays to a vector. */
#if defined(__AVX2__)
#define PACKET(name) triangle_packet_##name##_avx2
#include "accel/triangle_packet_kernel_internal.h"
#else
#include "accel/triangle_packet.h"
#endif
