/* Queries for several rays of one origin together. The results are those of single rays. */
#ifndef GRAY_WORLD_PACKET_H
#define GRAY_WORLD_PACKET_H

#include "accel/ray_packet.h"
#include "world/world.h"

struct packet_answer {
    struct crossing crossing;
    uint32_t primitive;
};

/* world_nearest_crossing for each ray: its bit, and out[i]. The packet is padded (ray_packet_pad). */
uint64_t world_nearest_packet(const struct world *world, const struct ray_packet *rays, struct world_scratch *scratch,
                              struct packet_answer *out);

/* The primitives that can be between a point and a parallelogram, in any order; unknown if there are too many. */
enum { OCCLUDER_CANDIDATES = 24 };
struct occluder_candidates {
    uint32_t items[OCCLUDER_CANDIDATES], count;
    uint32_t skip_primitive; /* as of a ray */
    bool known;
};
struct occluder_candidates world_occluder_candidates(const struct world *world, struct vec3 from, struct vec3 corner,
                                                     struct vec3 edge1, struct vec3 edge2, uint32_t skip_primitive);
/* Segments from a point to others. */
struct shadow_rays {
    struct vec3 from;
    double time;
    const struct vec3 *targets;
    uint32_t count;
};
/* The number of visible targets, all inside the parallelogram: as world_any for every segment, t in (0, 1). visible
 * (count entries, or NULL): the result for each. Occluders move to the front of `occluder_candidates`. */
uint32_t world_visible(const struct world *world, struct occluder_candidates *occluder_candidates,
                       const struct shadow_rays *shadow_rays, struct world_scratch *scratch, bool *visible);

#endif
