/* Emission of photons. For each light, the directions (for a distant light: the positions across its rays) from which
 * photons can hit a specular object are stored in cells: the projection maps of Jensen 1996. */
#ifndef GRAY_PHOTON_PHOTON_TARGET_INTERNAL_H
#define GRAY_PHOTON_PHOTON_TARGET_INTERNAL_H

#include "base/arena.h"
#include "base/pool.h"
#include "light/light.h"
#include "world/world.h"

struct photon_cell {
    double until;          /* sum of the importance of all cells up to this one */
    uint32_t face, i, j;   /* of a cube around the light; face 0 for a distant light */
    float strength, shine; /* reflectance of the strongest specular object there; the light's own in its middle */
};

/* One light, or one part of a light with an extent. */
struct photon_target {
    struct light_emitter emitter;
    uint32_t number;                /* of the light */
    double corner[2], size, behind; /* PARALLEL: the square across, and where photons start along the direction; of an
                                       ENVIRONMENT size is that of the scene */
    struct box across,
        scene; /* ENVIRONMENT: boxes of the specular objects and of the whole scene, outside of which photons start */
    uint32_t level, cell_count; /* 2^level cells along the side of a face */
    struct photon_cell *cells;
    double total;              /* importance of all cells */
    double flux;               /* the emitted flux, estimated before tracing */
    uint32_t first, count;     /* photons of the whole map that are its own */
    struct medium_stack media; /* round the centre */
};

struct photon_targets {
    struct photon_target *targets;
    uint32_t count;
};

/* Finds the cells of every light of the world and divides `photons` among them by flux. Memory comes from the arena.
 * Errors: no memory, cancelled. Without specular objects there are no targets. */
bool photon_targets_make(struct photon_targets *out, const struct world *world, uint32_t photons, struct arena *arena,
                         struct pool *pool, struct error *error);

struct photon_start {
    struct vec3 origin, direction; /* direction: unit */
    struct colour power;           /* before fading */
    double strength; /* reflectance of the strongest object of its cell: power is divided by it, and after such an
                        object all photons have equal power */
    bool from_afar;  /* an unbounded object may be behind its origin */
    uint64_t key;
};
/* Photon `index` (0 .. count-1) of the target; a function of its arguments. */
struct photon_start photon_target_start(const struct photon_target *target, uint32_t index, uint64_t seed);

#endif
