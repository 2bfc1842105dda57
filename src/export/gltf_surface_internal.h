/* The triangles of a primitive for a glTF file. */
#ifndef GRAY_EXPORT_GLTF_SURFACE_INTERNAL_H
#define GRAY_EXPORT_GLTF_SURFACE_INTERNAL_H

#include "base/error.h"
#include "base/pool.h"
#include "formats/list.h"
#include "world/world.h"

/* As in the file, but v counts from below. Equal bytes are one vertex. */
struct gltf_vertex {
    float point[3], normal[3], uv[2], colour[3];
};
/* Counterclockwise as seen from outside; `material` is that of the world. */
struct gltf_triangle {
    uint32_t vertex[3], material;
};
/* Zero value: empty. Owner: the caller, gltf_surface_destroy. */
struct gltf_surface {
    struct list vertices, triangles;
    bool has_normals, has_colours;
    bool has_uv;      /* those of the shape, which images follow */
    bool is_unfolded; /* u and v are between 0 and 1, and no two places of the surface have the same */
    bool is_open;
    bool is_unit; /* in a space of its own: spheres of all sizes are one */
    struct transform object_from_surface;
    uint32_t material; /* of triangles that are added */
    bool falls;        /* likewise of grids: the diagonal of a cell, from the left */
    const char *why;   /* it is left out or inexact: the end of a sentence; or NULL */
    double tolerance;  /* about the largest distance from the exact one, in its space */
};
void gltf_surface_destroy(struct gltf_surface *surface);

static inline struct gltf_vertex *gltf_vertices(const struct gltf_surface *surface) {
    return surface->vertices.items;
}
static inline struct gltf_triangle *gltf_triangles(const struct gltf_surface *surface) {
    return surface->triangles.items;
}
static inline struct vec3 gltf_point(const float numbers[3]) {
    return vec3_make((double)numbers[0], (double)numbers[1], (double)numbers[2]);
}

struct gltf_source {
    const struct world *world;
    uint32_t primitive;
    double share;       /* the tolerance as a share of the size */
    double solid_share; /* likewise, of solids that are meshed */
    struct pool *pool;
};
/* The surface of a primitive in its own space. Errors: no memory, cancelled. */
bool gltf_surface_make(const struct gltf_source *source, struct gltf_surface *out, struct error *error);
/* The vectors along which u and v grow on a triangle, with weights by its area, under a map (NULL: none). */
void gltf_directions(const struct gltf_surface *surface, const struct gltf_triangle *triangle, const struct affine *map,
                     struct vec3 out[2]);
/* Spheres and boxes: where the one of unit size is in the space of the primitive. */
bool gltf_surface_is_unit(const struct geometry *geometry, struct transform *object_from_surface);
/* Gives each triangle a place of its own in the unit square, of at least `smallest` of the `size` steps along each
 * side. False: there are too many. */
bool gltf_surface_unfold(struct gltf_surface *surface, uint32_t size, uint32_t smallest);

#endif
