/* Many rays of one origin at once: the camera rays of a few pixels, or the shadow rays of one hit. The answers are the
 * same bits as one ray after the other gets from triangle_index.h; rays that do not go well together are sent one after
 * the other. */
#ifndef GRAY_ACCEL_TRIANGLE_PACKET_H
#define GRAY_ACCEL_TRIANGLE_PACKET_H

#include "accel/ray_packet.h"
#include "accel/triangle_index.h"

/* What each ray of a packet has met; meaningful where the bit of the ray is set in the answer. */
struct packet_hits {
    _Alignas(64) double t[PACKET_RAYS], u[PACKET_RAYS], v[PACKET_RAYS];
    uint32_t triangle[PACKET_RAYS];
    bool enter[PACKET_RAYS];
};

static inline void packet_hits_set(struct packet_hits *hits, unsigned i, const struct triangle_hit *hit) {
    hits->t[i] = hit->t;
    hits->u[i] = hit->u;
    hits->v[i] = hit->v;
    hits->triangle[i] = hit->triangle;
    hits->enter[i] = hit->enter;
}

/* For each ray whose bit is set in `active`, what triangle_index_nearest says: its bit of the answer, and hits. */
uint64_t triangle_packet_nearest(const struct triangle_index *index, const struct triangle_set *set,
                                 const struct ray_packet *rays, uint64_t active, struct packet_hits *hits,
                                 struct triangle_cost *cost);
/* The same for triangle_index_any. */
uint64_t triangle_packet_any(const struct triangle_index *index, const struct triangle_set *set,
                             const struct ray_packet *rays, uint64_t active, struct triangle_cost *cost);

/* The searches in each instruction set. False: these rays do not suit a packet, nothing was done. */
#define TRIANGLE_PACKETS(suffix)                                                                                       \
    bool triangle_packet_nearest_##suffix(const struct triangle_index *index, const struct triangle_set *set,          \
                                          const struct ray_packet *rays, uint64_t active, struct packet_hits *hits,    \
                                          uint64_t *answer, struct triangle_cost *cost);                               \
    bool triangle_packet_any_##suffix(const struct triangle_index *index, const struct triangle_set *set,              \
                                      const struct ray_packet *rays, uint64_t active, uint64_t *answer,                \
                                      struct triangle_cost *cost);

TRIANGLE_PACKETS(base)
TRIANGLE_PACKETS(avx2)
TRIANGLE_PACKETS(avx512)

#endif
