/* The media around a point of the world. */
#ifndef GRAY_RENDER_MEDIUM_STACK_AT_H
#define GRAY_RENDER_MEDIUM_STACK_AT_H

#include "material/medium_stack.h"
#include "world/world.h"

/* The transparent solids that hold the point at a ray's time, found by counting crossings; closed[0 .. closed_count-1]
 * are the solids in question (world_closed_in). */
void medium_stack_at(const struct world *world, struct vec3 point, double ray_time, const uint32_t *closed,
                     uint32_t closed_count, struct world_scratch *scratch, struct medium_stack *out);

#endif
