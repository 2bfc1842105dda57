/* A photon map: where light that went through or off specular surfaces fell, kept to sum up the light at a point
 * (Jensen, "Global Illumination using Photon Maps", EGWR 1996; "Realistic Image Synthesis Using Photon Mapping", 2001).
 * Built once before a picture, read by every thread. */
#ifndef GRAY_PHOTON_PHOTON_MAP_H
#define GRAY_PHOTON_PHOTON_MAP_H

#include "base/pool.h"
#include "material/bsdf.h"
#include "world/world.h"

#define PHOTON_NOWHERE UINT32_MAX

/* A photon as it landed. Power: irradiance times area, in the unit in which a light's colour times its falloff is
 * irradiance (docs/design/light.md). */
struct photon {
    struct vec3 position;
    struct colour power;
    uint32_t from;  /* unit direction to where it came from, packed by photon_pack */
    uint32_t light; /* index into the world's lights; PHOTON_NOWHERE: it did not land */
};

/* The photons in the order of a balanced tree; all in units of the map, powers of two, so that a scene of another scale
 * gives the same bits. Owns its arrays. */
struct photon_map {
    uint32_t count, levels; /* leaves are the nodes of level `levels`; the root is node 1 */
    struct photon_spot {
        float at[3], radius; /* of the disc that it lights */
    } * spots;
    struct photon_light {
        float power[3];
        uint32_t from, light;
    } * lights;
    struct photon_node {
        float min[3], max[3]; /* contains the discs below it */
    } * nodes;
    struct vec3 origin;
    double unit, power_unit; /* world units per unit of the map */
    bool listed;             /* some light does not reach everything */
};

struct photon_list {
    const struct photon *items;
    uint32_t count;
};
/* Keeps the photons that landed, in order. radius: world units, 0 for one by
 * density. Errors: no memory, cancelled. An empty map is fine. */
bool photon_map_build(struct photon_map *map, const struct world *world, const struct photon_list *photons,
                      double radius, struct pool *pool, struct error *error);
void photon_map_destroy(struct photon_map *map);

/* The light that these lobes of the surface reflect towards hit->view from all photons around the hit that landed on
 * its lit side. */
struct colour photon_map_light(const struct photon_map *map, const struct world *world, const struct hit *hit,
                               const struct bsdf *bsdf, uint32_t lobes);

/* A unit vector in 32 bits: a point of the octahedron in 16 + 16 bits, wrong by at most 1e-4. */
uint32_t photon_pack(struct vec3 direction);

#endif
