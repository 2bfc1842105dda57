/* Which closed primitives can hold a point, and which of them do. */
#include "world/world_internal.h"

#include <string.h>

/* Such a solid holds what is outside of its box. */
static bool is_inside_out(const struct geometry *geometry) {
    return geometry->csg && geometry->csg->inside_out;
}

uint32_t world_closed_in(const struct world *world, const struct box *region, uint32_t *out, uint32_t limit) {
    uint32_t count = 0;
    for (uint32_t i = 0; i < world->primitive_count; i++) {
        struct box common = box_meet(world->boxes[i], *region);
        const struct geometry *geometry = primitive_geometry(world, i);
        if ((box_is_empty(&common) && !is_inside_out(geometry)) || !geometry_is_closed(geometry))
            continue;
        if (out && count < limit)
            out[count] = i;
        count++;
    }
    return count;
}

static bool contains(const struct world *world, uint32_t index, struct vec3 p_object, struct world_scratch *scratch) {
    const struct geometry *geometry = primitive_geometry(world, index);
    bool inside = geometry_contains(geometry, p_object, &scratch->geom);
    while (scratch->geom.overflow && geom_scratch_grow(&scratch->geom))
        inside = geometry_contains(geometry, p_object, &scratch->geom);
    scratch->failed = scratch->failed || scratch->geom.overflow;
    return inside && !scratch->geom.overflow;
}

uint32_t world_containing(const struct world *world, struct vec3 point, double ray_time, const uint32_t *candidates,
                          uint32_t candidate_count, struct world_scratch *scratch, uint32_t *primitive,
                          uint32_t limit) {
    struct ray ray = {.origin = point, .direction = {0.5377, 0.6212, 0.5698}, .t_max = INFINITY, .time = ray_time};
    uint32_t count = 0;
    double ends[WORLD_NESTING];
    limit = limit < WORLD_NESTING ? limit : WORLD_NESTING;
    for (uint32_t k = 0; k < candidate_count; k++) {
        uint32_t i = candidates[k];
        if (!box_contains(&world->boxes[i], point) && !is_inside_out(primitive_geometry(world, i)))
            continue;
        struct ray ray_object = primitive_ray(world, i, &ray);
        if (!contains(world, i, ray_object.origin, scratch))
            continue;
        /* Innermost last: the solid the ray leaves first is the innermost. */
        struct crossing crossing = {.t = INFINITY};
        (void)world_ask_nearest(world, i, &ray_object, scratch, &crossing);
        uint32_t at = count;
        while (at > 0 && ends[at - 1] < crossing.t)
            at--;
        if (count < limit) {
            memmove(primitive + at + 1, primitive + at, (count - at) * sizeof *primitive);
            memmove(ends + at + 1, ends + at, (count - at) * sizeof *ends);
            count++;
        } else if (at > 0) {
            at--; /* the outermost falls off */
            memmove(primitive, primitive + 1, at * sizeof *primitive);
            memmove(ends, ends + 1, at * sizeof *ends);
        } else {
            continue;
        }
        primitive[at] = i;
        ends[at] = crossing.t;
    }
    return count;
}
