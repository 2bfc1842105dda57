/* A triangle mesh made of a solid. */
#ifndef GRAY_EXPORT_SOLID_MESH_INTERNAL_H
#define GRAY_EXPORT_SOLID_MESH_INTERNAL_H

#include "base/error.h"
#include "base/pool.h"
#include "csg/csg.h"
#include "formats/list.h"

#define NO_INDEX UINT32_MAX

/* A vertex inside of a smooth piece, on an edge between two, or at a corner. */
enum { VERTEX_SMOOTH, VERTEX_EDGE, VERTEX_CORNER };
struct solid_vertex {
    struct vec3 point, normal[3]; /* as many normals and surfaces as sharp + 1 */
    uint32_t surface[3];
    uint8_t sharp;
};
/* Counterclockwise as seen from outside. */
struct solid_triangle {
    uint32_t vertex[3], surface;
};
/* Owner: the caller, solid_mesh_destroy. */
struct solid_mesh {
    struct list vertices, triangles;
};

void solid_mesh_destroy(struct solid_mesh *mesh);
/* Forgets triangles that have a vertex twice, and vertices that no triangle has. False: no memory. */
bool solid_mesh_compact(struct solid_mesh *mesh);

static inline struct solid_vertex *solid_vertex_at(const struct solid_mesh *mesh, uint32_t index) {
    return (struct solid_vertex *)mesh->vertices.items + index;
}
static inline struct solid_triangle *solid_triangle_at(const struct solid_mesh *mesh, uint32_t index) {
    return (struct solid_triangle *)mesh->triangles.items + index;
}

/* Coordinates are multiples of a number that is about this: single precision has them all, and what is nearly a plane
 * or a line through the origin has no noise. */
double solid_grain(const struct csg *csg);
struct vec3 solid_round(const struct csg *csg, struct vec3 point);

struct solid_input {
    const struct csg *csg; /* closed and finite */
    const char *name;      /* of its node, for messages */
    double tolerance;
    struct pool *pool;
    bool may_have_faults; /* a scene's: a mesh with faults is better than none, and than a long time */
};
/* What is worth a notice. */
struct solid_findings {
    uint32_t separated;   /* vertices that were moved because parts of the solid touch there */
    struct vec3 position; /* of one of them */
    bool has_faults;      /* it is further away than the tolerance somewhere, or triangles intersect */
};

/* A closed, oriented mesh whose coordinates are numbers of single precision and whose triangles do not intersect; at
 * all points that are tested the distance from the solid, and of the solid from it, is below the tolerance. If no such
 * mesh is found, a mesh that may have faults is the best that was. Errors: the solid is empty, or too fine for this; no
 * memory; cancelled. */
bool solid_mesh_build(const struct solid_input *input, struct solid_mesh *out, struct solid_findings *findings,
                      struct error *error);
/* The triangles of a mesh under a map, with one vertex for each position; `surface` is the material slot. False: no
 * memory. */
bool solid_mesh_of_triangles(const struct mesh *mesh, const struct affine *map, struct solid_mesh *out);
/* Whether every edge has two triangles in opposite directions, and the triangles of every vertex are one ring; the mesh
 * is compact. False: no memory. */
bool solid_mesh_is_closed(const struct solid_mesh *mesh, bool *closed, struct error *error);

#endif
