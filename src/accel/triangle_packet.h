/* Many rays of one origin at once: the camera rays of a few pixels, or the shadow rays of one hit. The results have the
 * same bits as those of single rays (triangle_index.h); rays that do not suit a packet are traced one by one. */
#ifndef GRAY_ACCEL_TRIANGLE_PACKET_H
#define GRAY_ACCEL_TRIANGLE_PACKET_H

#include "accel/ray_packet.h"
#include "accel/triangle_index.h"

/* The hit of each ray of a packet; valid if the bit of the ray is set in the result. */
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

/* triangle_index_nearest for each ray whose bit is set in `active`: returns a bit per ray, and fills hits. */
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
