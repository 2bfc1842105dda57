/* See medium_stack_at.h. */
#include "render/medium_stack_at.h"

void medium_stack_at(const struct world *world, struct vec3 point, double ray_time, const uint32_t *closed,
                     uint32_t closed_count, struct world_scratch *scratch, struct medium_stack *out) {
    uint32_t inside[MEDIUM_STACK_LIMIT];
    uint32_t count =
        world_containing(world, point, ray_time, closed, closed_count, scratch, inside, MEDIUM_STACK_LIMIT);
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
