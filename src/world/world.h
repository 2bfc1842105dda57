/* The flattened scene: placed primitives, a voxel grid over them, lights; immutable, flat arrays with 32-bit indices,
 * owned by the arena of one job. Answers what a ray meets. */
#ifndef GRAY_WORLD_WORLD_H
#define GRAY_WORLD_WORLD_H

#include "accel/box_tree.h"
#include "accel/grid.h"
#include "accel/kd_tree.h"
#include "base/arena.h"
#include "base/pool.h"
#include "geom/csg.h"
#include "geom/hit.h"
#include "geom/shape.h"
#include "math/motion.h"
#include "scene/node.h"

/* The way from a moving node to the world: after its own motion a fixed transform, then the next moving node above. */
struct moving_link {
    const struct moving_link *above;  /* NULL: the world itself */
    struct transform above_from_node; /* from the space its motion leads to, to the one that moves above it */
    struct motion motion;
};
/* Of a primitive under moving nodes. */
struct moving {
    const struct moving_link *link;
    struct transform link_from_object;
};

struct placed {
    struct transform world_from_object; /* of what moves: in the middle of the shutter's time */
    const struct moving *moving;        /* NULL: it stands still */
    struct shape shape;
    uint32_t material;   /* unused for CSG: the leaves have their own */
    uint32_t slot_count; /* of a mesh: face slot k has material + k; below 2 all have `material` */
    enum node_cull cull; /* of a mesh */
    bool identity;       /* world_from_object changes nothing: a placed sphere or box of an old scene, mostly */
    bool holes;          /* some of its materials let rays through by a picture */
    double scale;        /* largest stretch of world_from_object: bounds errors */
};

struct world {
    const struct placed *placed;
    struct box *boxes; /* world box of each placed primitive */
    uint32_t placed_count;
    struct shutter shutter;
    bool moves; /* something does */
    const struct material **materials;
    bool *material_has_image;  /* such materials need to know the footprint on the surface */
    bool *material_has_relief; /* and such ones where it rises */
    uint32_t material_count;
    const struct node **nodes; /* nodes[i]: the node that placed[i] came from */
    const struct light *lights;
    uint32_t light_count;
    struct sky sky;
    struct grid grid;     /* ACCEL_GRID */
    struct box_tree tree; /* ACCEL_AUTO, ACCEL_BVH */
    struct kd_tree kd_tree;
    enum accel_kind accel;
    uint32_t scratch_need;
    uint64_t triangles; /* instances counted */
    size_t mesh_memory; /* bytes of the distinct meshes */
};

/* One worker's mutable memory while it asks the world. */
struct world_scratch {
    struct geom_scratch geom;
    bool failed; /* no memory to grow: the frame is abandoned with ERROR_MACHINE */
    uint64_t rays, any_rays;
    uint32_t last_blocker; /* what stopped the last shadow ray */
};
bool world_scratch_init(struct world_scratch *scratch, const struct world *world);
void world_scratch_destroy(struct world_scratch *scratch);

/* Called with one line for things that are odd but not wrong (a geometry node without material ...). */
typedef void world_warning(void *context, const char *text);

/* Flattens the tree under root as it stands now; mesh indices are built where they are missing. The world points into
 * the scene's arena (materials, names), so it must not outlive the script. Errors: cycles (naming the nodes), no
 * memory, cancelled. lights and sky are copied. */
bool world_build(struct world *world, struct arena *arena, struct scene *scene, struct node *root,
                 const struct light *lights, uint32_t light_count, const struct sky *sky, struct shutter shutter,
                 enum accel_kind accel, struct pool *pool, world_warning *warn, void *warn_context,
                 struct error *error);
void world_destroy(struct world *world); /* what is not in the arena: grid and tree */

/* Where a moving primitive stands at a ray's time. */
struct transform world_moved(const struct moving *moving, struct shutter shutter, double ray_time);
/* Where a primitive stands at a ray's time; `moved` is the place for the transform of what moves. */
static inline const struct transform *world_placement(const struct world *world, const struct placed *placed,
                                                      double ray_time, struct transform *moved) {
    if (!placed->moving)
        return &placed->world_from_object;
    *moved = world_moved(placed->moving, world->shutter, ray_time);
    return moved;
}

/* Nearest hit in the ray's open interval, fully described. Equal t: the primitive that comes first in flattening order.
 */
bool world_nearest(const struct world *world, const struct ray *ray, struct world_scratch *scratch, struct hit *hit);
/* Only which primitive and where; for tests and counters. */
bool world_nearest_crossing(const struct world *world, const struct ray *ray, struct world_scratch *scratch,
                            uint32_t *placed, struct crossing *crossing);
bool world_any(const struct world *world, const struct ray *ray, struct world_scratch *scratch);
/* How many of the points targets[0 .. count-1], all inside the parallelogram, are seen from `from`: as world_any would
 * say of every segment, t in (0, 1), with the search for what can stand between done once for all of them. */
uint32_t world_count_visible(const struct world *world, struct vec3 from, double time, struct vec3 corner,
                             struct vec3 edge1, struct vec3 edge2, const struct vec3 *targets, uint32_t count,
                             struct world_scratch *scratch);
/* The same; visible (count entries, or NULL) says it of each. */
uint32_t world_visible(const struct world *world, struct vec3 from, double time, struct vec3 corner, struct vec3 edge1,
                       struct vec3 edge2, const struct vec3 *targets, uint32_t count, struct world_scratch *scratch,
                       bool *visible);
/* The closed primitives whose box meets `region`: all that can hold a point of it, in flattening order. `out` (or NULL)
 * has room for `limit`. Returns how many there are. */
uint32_t world_closed_in(const struct world *world, const struct box *region, uint32_t *out, uint32_t limit);
/* Those of candidates[0 .. count-1] whose inside holds `point` at a ray's time, innermost last; at most `limit`, which
 * is at most WORLD_NESTING. Returns the count. */
enum { WORLD_NESTING = 64 };
uint32_t world_containing(const struct world *world, struct vec3 point, double ray_time, const uint32_t *candidates,
                          uint32_t count, struct world_scratch *scratch, uint32_t *placed, uint32_t limit);

#endif
