/* Patches: triangles over the surfaces of a world, with vertices that are common to patches of one primitive whose
 * normals agree. Planar shapes are rectangles of patches, which may go beyond the shape; boxes and balls are six of
 * them, meshes are their own triangles, and other closed shapes and solids the mesh of primitive_mesh_build. Patches
 * are divided by longest edges (M.-C. Rivara, "Algorithms for refining triangular grids suitable for adaptive and
 * multigrid techniques", 1984), so that no vertex lies within an edge. */
#ifndef GRAY_RADIOSITY_PATCHES_H
#define GRAY_RADIOSITY_PATCHES_H

#include "accel/box_tree.h"
#include "base/key_map.h"
#include "formats/list.h"
#include "world/world.h"

#define PATCH_NONE UINT32_MAX

/* Counterclockwise as seen from the front. */
struct patch {
    uint32_t vertex[3]; /* of one primitive */
};
struct patch_vertex {
    struct vec3 point;
    uint64_t primitive; /* without padding: solutions are kept as they are */
};
/* Zero value: empty. Owner: the caller, patches_destroy. */
struct patches {
    const struct world *world;
    struct list vertices, all; /* struct patch_vertex, struct patch */
    double edge;               /* at most so long are those of patches in the beginning */
    size_t *first;             /* by vertex, one more at the end: its patches */
    uint32_t *of_vertex;
    struct box_tree tree; /* over the patches */
};

static inline struct patch *patch_at(const struct patches *patches, uint32_t index) {
    return (struct patch *)patches->all.items + index;
}
static inline struct patch_vertex *patch_vertex_at(const struct patches *patches, uint32_t index) {
    return (struct patch_vertex *)patches->vertices.items + index;
}
static inline uint32_t patch_primitive(const struct patches *patches, uint32_t index) {
    return (uint32_t)patch_vertex_at(patches, patch_at(patches, index)->vertex[0])->primitive;
}
void patch_corners(const struct patches *patches, uint32_t index, struct vec3 out[3]);
/* The normal of its front, as long as twice its area. */
static inline struct vec3 patch_normal(const struct vec3 corners[3]) {
    return vec3_cross(vec3_sub(corners[1], corners[0]), vec3_sub(corners[2], corners[0]));
}
static inline double patch_area(const struct vec3 corners[3]) {
    return vec3_length(patch_normal(corners)) / 2;
}

/* What a primitive is to radiosity. BLACK: no light that arrives there is reflected diffusely. */
enum patch_kind { PATCHES_BLACK, PATCHES_PLANAR, PATCHES_BOX, PATCHES_BALL, PATCHES_MESH, PATCHES_SOLID, PATCHES_BARE };
/* BARE: diffuse, but without patches, because it is open or has no end. */
enum patch_kind patches_kind(const struct world *world, uint32_t primitive);

/* Patches of all primitives at time 0, about a quarter of the limit. Errors: the scene has more triangles than the
 * limit; no memory; cancelled. */
bool patches_build(struct patches *patches, const struct world *world, uint32_t limit, struct pool *pool,
                   struct error *error);
void patches_destroy(struct patches *patches);

/* Adds an edge to those that are to be divided. False: no memory. */
bool patches_mark(struct key_map *edges, uint32_t a, uint32_t b);
/* Divides patches with marked edges, unless there would be more than the limit: then *done is false, and nothing
 * changes but the marks. New vertices come behind the old ones. Errors: no memory. */
bool patches_divide(struct patches *patches, struct key_map *edges, uint32_t limit, bool *done, struct error *error);
/* Groups items by their keys below `groups`, or PATCH_NONE, which have none: items[first[k]] to items[first[k + 1] - 1]
 * are the numbers of those with key k, in their order. False: no memory. */
bool patches_group(const uint32_t *keys, size_t count, uint32_t groups, size_t **first, uint32_t **items);
/* Fills `first` and `of_vertex` after changes. Errors: no memory. */
bool patches_index(struct patches *patches, struct error *error);
/* Builds the tree, for patches_find. Errors: no memory, cancelled. */
bool patches_index_space(struct patches *patches, struct pool *pool, struct error *error);

/* The patch of a hit, and the shares of its vertices there. False: there is none near it. */
bool patches_find(const struct patches *patches, const struct hit *hit, uint32_t *patch, double shares[3]);

/* The point of the true surface near a point of a patch, seen from the front. False: the shape is not there. */
bool patches_hit(const struct patches *patches, uint32_t patch, struct vec3 point, struct world_scratch *scratch,
                 struct hit *hit);

#endif
