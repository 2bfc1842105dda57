/* Rays of one origin, as arrays of components, so that vectors can be loaded directly. */
#ifndef GRAY_ACCEL_RAY_PACKET_H
#define GRAY_ACCEL_RAY_PACKET_H

#include "math/ray.h"

#include <stdint.h>

enum { PACKET_RAYS = 64, PACKET_STEP = 16 };

/* Rays 0 .. count - 1; their interval is (t_min, t_max[i]). Entries from there to the next multiple of PACKET_STEP
 * repeat ray 0 (ray_packet_pad): searches read them but return no results for them. */
struct ray_packet {
    _Alignas(64) double direction[3][PACKET_RAYS];
    double t_max[PACKET_RAYS];
    struct vec3 origin;
    double t_min, time;
    uint32_t count;
};

static inline void ray_packet_pad(struct ray_packet *packet) {
    for (uint32_t i = packet->count; i % PACKET_STEP != 0; i++) {
        for (int k = 0; k < 3; k++)
            packet->direction[k][i] = packet->direction[k][0];
        packet->t_max[i] = packet->t_max[0];
    }
}

static inline uint64_t ray_packet_all(const struct ray_packet *packet) {
    return packet->count < 64 ? (UINT64_C(1) << packet->count) - 1 : UINT64_MAX;
}

static inline struct ray ray_packet_get(const struct ray_packet *packet, unsigned i) {
    return (struct ray){
        .origin = packet->origin,
        .direction = {packet->direction[0][i], packet->direction[1][i], packet->direction[2][i]},
        .t_min = packet->t_min,
        .t_max = packet->t_max[i],
        .time = packet->time,
    };
}

#endif
