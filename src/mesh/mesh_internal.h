/* Shared by the files of the mesh; no other file includes it. */
#ifndef GRAY_MESH_MESH_INTERNAL_H
#define GRAY_MESH_MESH_INTERNAL_H

#include "accel/kd_triangles.h"
#include "accel/triangle_index.h"
#include "mesh/mesh.h"

/* The search structures, built on demand; separate from the tables, which never change. */
struct mesh_accel {
    struct triangle_index *index, *grid; /* grid: only after ACCEL_GRID was requested */
    struct kd_triangles *kd_tree;        /* the same for ACCEL_KDTREE */
    bool opening_is_known;
    double opening; /* mesh_opening */
};

/* Triangles as flat arrays. A triangle whose first normal or uv corner is MESH_NONE has none. */
struct mesh {
    uint32_t references;
    uint32_t vertex_count, triangle_count, normal_count, uv_count, face_count, dropped_faces;
    double (*vertices)[3];
    uint32_t (*corners)[3];
    double (*normals)[3]; /* unit length; NULL when the input has none */
    uint32_t (*normal_corners)[3];
    double (*uvs)[2];        /* NULL when the input has none */
    double (*second_uvs)[2]; /* the same */
    uint32_t (*uv_corners)[3];
    float (*colours)[3]; /* of the vertices, or NULL */
    bool colours_by_triangle;
    uint32_t *materials; /* per triangle, or NULL */
    /* The original polygons, stored only if the triangles do not determine them. */
    uint32_t *face_start, *face_vertex;
    char *file; /* NULL: of tables */
    uint64_t input_hash;
    struct box bounds;
    bool closed, outward; /* outward: of a closed mesh, the volume it encloses is positive */
    uint32_t open_edge_count;
    struct vec3 open_edges[MESH_OPEN_EDGES][2];
    struct triangle_set set; /* the triangles for searches: borrows the tables above */
    struct mesh_accel *accel;
};

#define MESH_NONE UINT32_MAX

/* The cross product of the edges of a triangle from its first corner; zero only if they are parallel. */
static inline struct vec3 mesh_normal_of_edges(struct vec3 e, struct vec3 f) {
    return vec3_make(triangle_edge(e.y, e.z, f.y, f.z), triangle_edge(e.z, e.x, f.z, f.x),
                     triangle_edge(e.x, e.y, f.x, f.y));
}

#endif
