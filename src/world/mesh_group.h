/* Many small meshes with a common index of their triangles. A ray descends one hierarchy, not one over boxes and then
 * one in each mesh. Members are meshes of a few triangles in world space: their hits have the bits of separate
 * searches. */
#ifndef GRAY_WORLD_MESH_GROUP_H
#define GRAY_WORLD_MESH_GROUP_H

#include "accel/box_tree.h"
#include "accel/triangle_index.h"
#include "base/arena.h"
#include "math/ray.h"

struct world;

/* Data that is equal for all hits of a triangle, for world_describe. */
struct group_facet {
    struct vec3 normal, unit_normal; /* as they are in struct surface and in struct hit */
    double error;                    /* of a point on it */
    uint32_t material;
    bool plain; /* false: there is more to compute, and the rest is not set */
};

/* Zero-initialised: no group. Triangles are in flattening order, so the lowest of those with equal t belongs to the
 * first primitive. Owns index and rest. */
struct mesh_group {
    struct triangle_set set;
    struct triangle_index *index;     /* NULL: no group */
    const uint32_t *first;            /* of each primitive, and one more: the number of its first triangle */
    const uint32_t *primitive;        /* of each triangle */
    const struct group_facet *facets; /* of each triangle */
    struct box_tree rest;             /* over the primitives that are not members */
};

/* Makes a group if most primitives can be members; else none. The world has its boxes. Errors: no memory, cancelled;
 * the caller then destroys partial results. */
bool mesh_group_build(struct mesh_group *group, const struct world *world, struct arena *arena, struct pool *pool,
                      struct error *error);
void mesh_group_destroy(struct mesh_group *group);
size_t mesh_group_memory(const struct mesh_group *group); /* bytes */

/* The triangles of a primitive; none if it is not a member. */
static inline struct triangle_run mesh_group_run(const struct mesh_group *group, uint32_t primitive) {
    uint32_t first = group->first[primitive];
    return (struct triangle_run){first, group->first[primitive + 1] - first};
}

/* The triangles that a ray skips. */
static inline struct triangle_run mesh_group_skipped(const struct mesh_group *group, const struct ray *ray) {
    if (ray->skip_primitive == 0)
        return (struct triangle_run){0, 0};
    struct triangle_run run = mesh_group_run(group, ray->skip_primitive - 1);
    if (ray->skip_part > 0 && run.count > 0)
        run = (struct triangle_run){run.first + ray->skip_part - 1, 1};
    return run;
}

#endif
