/* Lines through a closed solid: all crossings of a line, described, and what they say about points near the surface. */
#ifndef GRAY_EXPORT_SOLID_CAST_INTERNAL_H
#define GRAY_EXPORT_SOLID_CAST_INTERNAL_H

#include "csg/csg.h"

/* Normals have unit length and point outwards. `surface` is the number of a smooth piece of the solid: of the leaf, and
 * of its part where parts meet in edges. */
struct solid_crossing {
    double t;
    struct vec3 point, normal;
    uint32_t surface;
    bool enter;
};

/* The leaf of a surface. */
static inline uint32_t solid_leaf(uint32_t surface) {
    return surface >> 16;
}

/* One worker's memory. */
struct solid_probe {
    const struct csg *csg;
    struct geom_scratch scratch;
    struct solid_crossing *found; /* by the last cast, by ascending t */
    uint32_t count, capacity;
    bool failed; /* no memory: what was found since then is not complete */
};

bool solid_probe_init(struct solid_probe *probe, const struct csg *csg);
void solid_probe_destroy(struct solid_probe *probe);
/* One for each worker; NULL: no memory. */
struct solid_probe *solid_probes(const struct csg *csg, int count);
void solid_probes_destroy(struct solid_probe *probes, int count);
/* Sets probe->found. */
void solid_cast(struct solid_probe *probe, struct vec3 origin, struct vec3 direction);
/* The crossing nearest to the origin, on either side, if it is nearer than `limit`; the direction has unit length. */
bool solid_cast_near(struct solid_probe *probe, struct vec3 origin, struct vec3 direction, double limit,
                     struct solid_crossing *nearest);
bool solid_contains(struct solid_probe *probe, struct vec3 point);
/* True proves that the surface is nearer to the point than `distance`. `normal` is about that of the surface there, and
 * has unit length. */
bool solid_is_near(struct solid_probe *probe, struct vec3 point, struct vec3 normal, double distance);
/* The same, which proves more and takes longer where it proves nothing. */
bool solid_is_near_for_sure(struct solid_probe *probe, struct vec3 point, struct vec3 normal, double distance);

#endif
