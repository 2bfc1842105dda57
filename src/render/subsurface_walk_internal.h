/* The walk of a path under a surface (material/subsurface.h), from where it goes in to where it comes out. Only the
 * surface of the same primitive ends it: what else is inside has no effect. */
#ifndef GRAY_RENDER_SUBSURFACE_WALK_INTERNAL_H
#define GRAY_RENDER_SUBSURFACE_WALK_INTERNAL_H

#include "material/subsurface.h"
#include "world/world.h"

struct subsurface_walk {
    const struct world *world;
    struct world_scratch *scratch;
    uint32_t primitive;
    struct subsurface under;
    uint64_t key;       /* of its random numbers */
    struct vec3 normal; /* outwards, where it goes in */
    /* In: the ray that goes in. Out: the one that comes out. */
    struct ray ray;
    struct colour weight; /* of the path */
    struct crossing crossing;
    int scatterings;
    bool comes_out; /* else it is to come out where it went in */
};
/* False: it loses the roulette, or has no weight left. */
bool subsurface_walk(struct subsurface_walk *walk);

#endif
