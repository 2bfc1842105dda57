/* See media.h. */
#include "render/media.h"

void media_around(const struct world *world, struct vec3 point, double ray_time, const uint32_t *closed,
                  uint32_t closed_count, struct world_scratch *scratch, struct medium_stack *out) {
    uint32_t inside[MEDIA_LIMIT];
    uint32_t count = world_containing(world, point, ray_time, closed, closed_count, scratch, inside, MEDIA_LIMIT);
    out->count = 0;
    for (uint32_t i = 0; i < count; i++) {
        const struct prototype *prototype = primitive_prototype(world, inside[i]);
        uint32_t material = prototype->geometry.csg ? prototype->geometry.csg->leaves[0].material : prototype->material;
        if (world->material_medium[material] == MEDIUM_NONE)
            continue;
        struct medium medium = world->media[world->material_medium[material]];
        medium.primitive = inside[i];
        medium_stack_enter(out, &medium);
    }
}
