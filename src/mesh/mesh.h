/* A triangle mesh with its own acceleration structure, an immutable asset once built: mesh_create copies and
 * triangulates, mesh_build_accel builds the search structure (lazily, before the first render, in parallel on the
 * pool). Nearest, any and all crossings use the same watertight triangle test. Owner: the asset store, by reference
 * count. */
#ifndef GRAY_MESH_MESH_H
#define GRAY_MESH_MESH_H

#include "accel/triangle_packet.h"
#include "base/bundle.h"
#include "base/error.h"
#include "base/list.h"
#include "base/pool.h"
#include "geometry/crossing.h"
#include "geometry/hit.h"
#include "math/affine.h"
#include "math/box.h"
#include "math/ray.h"
#include "settings/settings.h"

#include <stddef.h>
#include <stdint.h>

struct mesh;

/* Polygons as they come from a script or a file. Face f has corners face_start[f] .. face_start[f+1]-1 in the index
 * arrays (at least 3 corners). normals/normal_index and uvs/uv_index are NULL when absent; an index of UINT32_MAX there
 * means "this corner has none" (the face is then shaded flat / has no uv). Indices are 0-based and already checked to
 * be in range by the caller, coordinates finite. */
struct mesh_input {
    const char *name; /* for messages: file name or node name */
    const char *file; /* where it was read, or NULL; the mesh keeps a copy */
    uint32_t vertex_count, face_count;
    const double (*vertices)[3];
    const uint32_t *face_start; /* face_count + 1 entries */
    const uint32_t *vertex_index;
    uint32_t normal_count;
    const double (*normals)[3];
    const uint32_t *normal_index;
    uint32_t uv_count;
    const double (*uvs)[2];
    const double (*second_uvs)[2]; /* as many, with the same indices, or NULL */
    const uint32_t *uv_index;
    const uint32_t *face_material; /* material slot per face, or NULL */
    const float (*colours)[3];     /* of the vertices, or NULL */
    bool colours_by_face;          /* they are those of the faces instead */
};

/* Triangulates n-gons (concave ones by ear clipping in their best plane, convex ones fast; thousands of corners fine),
 * drops degenerate faces without a message (counted). NULL and error on no memory. Deterministic. Not more than 2^31
 * triangles. */
struct mesh *mesh_create(const struct mesh_input *input, struct error *error);
struct mesh *mesh_share(struct mesh *mesh); /* one more owner */
void mesh_release(struct mesh *mesh);
/* Builds the structure for searches of this kind, unless it exists. The mesh itself does not change. Call from one
 * thread while no search runs. ACCEL_AUTO: the index with the best resolution, usually one voxel; ACCEL_GRID: a grid of
 * many voxels, traversed by the algorithm of Amanatides and Woo, for teaching and verification. Errors: no memory,
 * cancelled. */
bool mesh_build_accel(const struct mesh *mesh, enum accel_kind kind, struct pool *pool, struct error *error);

struct box mesh_bounds(const struct mesh *mesh);
/* The tightest box of the mesh under `map`; reads every corner. */
struct box mesh_bounds_under(const struct mesh *mesh, const struct affine *map);
bool mesh_is_closed(const struct mesh *mesh); /* every edge is used by exactly two triangles in opposite directions */
enum { MESH_OPEN_EDGES = 3 };
/* Whether it has open edges: used by one face, or by faces that disagree about the outside. */
bool mesh_is_open(const struct mesh *mesh);
/* The first ones and what helps, as the end of a sentence about a mesh that is open. */
void mesh_describe_open_edges(const struct mesh *mesh, char *text, size_t size);
/* How much of the surface is missing, over its area, in the mesh's own space: 1 for a flat sheet, 0 without edges that
 * only one triangle uses. The vector areas of the loops of such edges count by magnitude, except that connected parts
 * may close each other: between them vectors are added. Worked out by the first call, in linear time. Call from one
 * thread. False: no memory. */
bool mesh_opening(const struct mesh *mesh, double *share);
bool mesh_is_outward(const struct mesh *mesh);  /* closed, and its triangles' normals point outwards */
const char *mesh_file(const struct mesh *mesh); /* NULL: it was made from tables */
uint32_t mesh_triangle_count(const struct mesh *mesh);
/* The corners of a triangle and its material slot (0 where there are none). */
void mesh_triangle(const struct mesh *mesh, uint32_t triangle, struct vec3 corners[3], uint32_t *slot);
uint32_t mesh_dropped_faces(const struct mesh *mesh);
bool mesh_has_uv(const struct mesh *mesh);
/* The original polygons, for scripts that read them: `corners` numbers of vertices, at most as many as the
 * largest face of the mesh has; both answers point into the mesh. */
const double (*mesh_vertices(const struct mesh *mesh, uint32_t *count))[3];
uint32_t mesh_face_count(const struct mesh *mesh);
const uint32_t *mesh_face(const struct mesh *mesh, uint32_t face, uint32_t *corners);
size_t mesh_memory(const struct mesh *mesh); /* bytes, index included */
/* The exact content as a key, so that equal tables give the same mesh (hash of everything in the input except the
 * name). */
uint64_t mesh_input_hash(const struct mesh_input *input);
bool mesh_equals(const struct mesh *a, const struct mesh *b); /* of equal input, and with triangles */
bool mesh_equals_input(const struct mesh *mesh, const struct mesh_input *input); /* vertices and faces the same */

bool mesh_nearest(const struct mesh *mesh, const struct ray *ray, enum accel_kind accel, struct geom_scratch *scratch,
                  struct crossing *out);
/* The same for the rays of one origin whose bit is set in `active` (accel/triangle_packet.h recommends which rays to
 * combine). Returns the bits of those that hit, with their results in out. */
uint64_t mesh_nearest_packet(const struct mesh *mesh, const struct ray_packet *rays, uint64_t active,
                             enum accel_kind accel, struct geom_scratch *scratch, struct packet_hits *out);
uint64_t mesh_any_packet(const struct mesh *mesh, const struct ray_packet *rays, uint64_t active, enum accel_kind accel,
                         struct geom_scratch *scratch);
bool mesh_any(const struct mesh *mesh, const struct ray *ray, enum accel_kind accel, struct geom_scratch *scratch);
/* The same for a ray that is known not to hit this triangle, where it starts. */
bool mesh_nearest_but(const struct mesh *mesh, const struct ray *ray, uint32_t triangle, enum accel_kind accel,
                      struct geom_scratch *scratch, struct crossing *out);
bool mesh_any_but(const struct mesh *mesh, const struct ray *ray, uint32_t triangle, enum accel_kind accel,
                  struct geom_scratch *scratch);
bool mesh_crossings(const struct mesh *mesh, const struct ray *ray, enum accel_kind accel, struct geom_scratch *scratch,
                    struct crossing_list *out);
/* The triangle has no vertex normals, uv and vertex colours. */
bool mesh_is_plain(const struct mesh *mesh, uint32_t triangle);
void mesh_describe(const struct mesh *mesh, const struct ray *ray, const struct crossing *crossing,
                   struct surface *out);
/* Copies what *mesh points to (base/bundle.h), but for what only files and messages need. */
void mesh_bundle(struct bundle *bundle, const struct mesh **mesh);

#endif
