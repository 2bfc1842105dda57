/* Batches of rays. Rays in a row that share their origin go as a packet (world/packet.h), the others one by one in the
 * order in which they come: the bounces of neighbouring pixels visit the same part of the world. Sorting them by octant
 * and origin was measured and lost (0.76 to 0.81 of the speed: what the order of tiles brought together is separated).
 */
#include "world/packet.h"

#include <string.h>

static bool goes_with(const struct ray *first, const struct ray *ray) {
    return memcmp(&first->origin, &ray->origin, sizeof ray->origin) == 0 && first->t_min == ray->t_min &&
           first->time == ray->time && ray->skip_primitive == 0;
}

/* How many rays from the first on can go as one packet. */
static uint32_t packet_length(const struct ray *rays, uint32_t count) {
    uint32_t length = 1;
    if (rays->skip_primitive != 0)
        return 1;
    while (length < count && length < PACKET_RAYS && goes_with(rays, &rays[length]))
        length++;
    return length;
}

static void nearest_packet(const struct world *world, const struct ray *rays, uint32_t count,
                           struct world_scratch *scratch, struct hit *hits) {
    struct ray_packet packet;
    struct packet_answer answers[PACKET_RAYS];
    packet.origin = rays->origin;
    packet.t_min = rays->t_min;
    packet.time = rays->time;
    packet.count = count;
    for (uint32_t i = 0; i < count; i++) {
        packet.direction[0][i] = rays[i].direction.x;
        packet.direction[1][i] = rays[i].direction.y;
        packet.direction[2][i] = rays[i].direction.z;
        packet.t_max[i] = rays[i].t_max;
    }
    ray_packet_pad(&packet);
    uint64_t found = world_nearest_packet(world, &packet, scratch, answers);
    for (uint32_t i = 0; i < count; i++) {
        hits[i].primitive = WORLD_NOTHING;
        if (found >> i & 1)
            world_describe(world, &rays[i], answers[i].primitive, &answers[i].crossing, &hits[i]);
    }
}

void world_nearest_batch(const struct world *world, const struct ray *rays, uint32_t count,
                         struct world_scratch *scratch, struct hit *hits) {
    enum { FEWEST = 4 }; /* fewer do not pay for a packet */
    for (uint32_t i = 0, length; i < count; i += length) {
        length = packet_length(rays + i, count - i);
        if (length >= FEWEST) {
            nearest_packet(world, rays + i, length, scratch, hits + i);
            continue;
        }
        length = 1;
        if (!world_nearest(world, &rays[i], scratch, &hits[i]))
            hits[i].primitive = WORLD_NOTHING;
    }
}

void world_any_batch(const struct world *world, const struct ray *rays, uint32_t count, struct world_scratch *scratch,
                     bool *met) {
    for (uint32_t i = 0; i < count; i++)
        met[i] = world_any(world, &rays[i], scratch);
}
