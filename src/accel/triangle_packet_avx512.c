/* Packets for processors with AVX-512, sixteen rays to a vector. */
#if defined(__AVX512VL__)
#define PACKET(name) triangle_packet_##name##_avx512
#include "accel/triangle_packet_kernel_internal.h"
#else
#include "accel/triangle_packet.h"
#endif
