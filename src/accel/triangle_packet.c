/* Chooses the packet search for the processor; traces single rays if a packet is not worthwhile or not possible. */
#include "accel/triangle_packet.h"

#include "base/isa.h"

/* With fewer rays the common work of a packet costs more than it saves. */
enum { FEWEST = 4 };

uint64_t triangle_packet_nearest(const struct triangle_index *index, const struct triangle_set *set,
                                 const struct ray_packet *rays, uint64_t active, struct packet_hits *hits,
                                 struct triangle_cost *cost) {
    uint64_t answer = 0;
    if (set->count == 0)
        return 0;
    if (__builtin_popcountll(active) >= FEWEST) {
#if CPU_ISA_CHOICE
        if (cpu_isa() == CPU_ISA_AVX512) {
            if (triangle_packet_nearest_avx512(index, set, rays, active, hits, &answer, cost))
                return answer;
        } else if (cpu_isa() == CPU_ISA_AVX2) {
            if (triangle_packet_nearest_avx2(index, set, rays, active, hits, &answer, cost))
                return answer;
        } else
#endif
            if (triangle_packet_nearest_base(index, set, rays, active, hits, &answer, cost))
            return answer;
    }
    for (; active; active &= active - 1) {
        unsigned i = (unsigned)__builtin_ctzll(active);
        struct ray ray = ray_packet_get(rays, i);
        struct triangle_hit hit;
        if (!triangle_index_nearest(index, set, &ray, &hit, cost))
            continue;
        packet_hits_set(hits, i, &hit);
        answer |= UINT64_C(1) << i;
    }
    return answer;
}

uint64_t triangle_packet_any(const struct triangle_index *index, const struct triangle_set *set,
                             const struct ray_packet *rays, uint64_t active, struct triangle_cost *cost) {
    uint64_t answer = 0;
    if (set->count == 0)
        return 0;
    if (__builtin_popcountll(active) >= FEWEST) {
#if CPU_ISA_CHOICE
        if (cpu_isa() == CPU_ISA_AVX512) {
            if (triangle_packet_any_avx512(index, set, rays, active, &answer, cost))
                return answer;
        } else if (cpu_isa() == CPU_ISA_AVX2) {
            if (triangle_packet_any_avx2(index, set, rays, active, &answer, cost))
                return answer;
        } else
#endif
            if (triangle_packet_any_base(index, set, rays, active, &answer, cost))
            return answer;
    }
    for (; active; active &= active - 1) {
        unsigned i = (unsigned)__builtin_ctzll(active);
        struct ray ray = ray_packet_get(rays, i);
        answer |= (uint64_t)triangle_index_any(index, set, &ray, cost) << i;
    }
    return answer;
}
