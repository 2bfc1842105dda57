/* The complete description of the crossing that a search has found. */
#ifndef GRAY_WORLD_WORLD_DESCRIBE_H
#define GRAY_WORLD_WORLD_DESCRIBE_H

#include "world/world.h"

/* Describes a result of world_nearest_crossing. */
void world_describe(const struct world *world, const struct ray *ray, uint32_t primitive,
                    const struct crossing *crossing, struct hit *hit);
/* The nearest hit, of any one of the surfaces that coincide there: world_join may follow. */
bool world_nearest_surface(const struct world *world, const struct ray *ray, struct world_scratch *scratch,
                           struct hit *hit);
/* The solid behind the surface of a primitive that has this material there, or SOLID_NONE. */
static inline uint32_t world_solid(const struct world *world, uint32_t primitive, uint32_t material) {
    if (!world->first_solid)
        return SOLID_NONE;
    uint32_t end = world->first_solid[primitive + 1];
    for (uint32_t i = world->first_solid[primitive]; i < end; i++)
        if (world->solid_materials[i] == material)
            return i;
    return SOLID_NONE;
}
/* Whether the surface is the invisible one of a medium; *boundary: it. */
static inline bool world_is_filled(const struct world *world, const struct hit *hit, struct medium_boundary *boundary) {
    *boundary = (struct medium_boundary){hit->solid, 1, {1, 1, 1}, hit->front, false};
    return hit->solid != SOLID_NONE && world->media.all[world->media.solids[hit->solid].medium].fills;
}
/* Whether some boundary refracts wavelengths by different indices. */
bool world_disperses(const struct world *world);
/* Whether the boundary at the hit does, for white light in these media. */
bool world_needs_wavelength(const struct world *world, const struct hit *hit, const struct medium_stack *media);
/* The u and v that the shape of a hit supplies. False: it has none. */
bool world_native_uv(const struct world *world, const struct hit *hit, double *u, double *v);
/* What is the same for every hit of a triangle of a primitive whose space is the world's. */
struct group_facet world_facet(const struct world *world, uint32_t primitive, uint32_t triangle);

#endif
