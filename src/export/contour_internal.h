/* Shared by the files of the contour: the first mesh of a solid, which is fine and exact, before triangles are removed.
 *
 * The space is divided into cells, an octree over cubes. All crossings of a cell's edges with the surface are known,
 * any number of them. On each face they are joined in pairs by arcs (contour_face.c); the arcs of a cell's six faces
 * make loops, and each loop bounds one disc of triangles inside of the cell (contour_cell.c). So every edge has exactly
 * two triangles by construction, and triangles of different cells cannot cross. This is cubical marching squares (Ho,
 * Wu, Chen, Chuang, Ouhyoung, "Cubical Marching Squares: Adaptive Feature Preserving Surface Extraction from Volume
 * Data", Eurographics 2005) with several crossings on an edge. */
#ifndef GRAY_EXPORT_CONTOUR_INTERNAL_H
#define GRAY_EXPORT_CONTOUR_INTERNAL_H

#include "base/key_map.h"
#include "base/pool.h"
#include "export/solid_cast_internal.h"
#include "export/solid_mesh_internal.h"
#include "formats/list.h"

/* On a line of the grid. */
struct grid_crossing {
    uint32_t vertex;
    int unit; /* of the line: the crossing is between this node and the next one */
    bool enter;
};
/* All crossings of a line. */
struct grid_line {
    uint32_t first, count;
};
/* A crossing of a line that need not be an edge of a cell: the mesh must come near to it. */
struct known_point {
    struct vec3 point;
    uint32_t next; /* of the same base cell, or NO_INDEX */
};

/* The nodes of the finest cells are those of a regular grid. A base cell has `base` finest cells on each side; the
 * sizes of cells are powers of two. Cells of the size `small` are as small as the tolerance asks for; only some are
 * divided further, where the solid is nearly no manifold. */
struct line_grid {
    struct vec3 origin;
    double step;
    int base, small, count[3], base_count[3];
    struct list lines, crossings; /* struct grid_line, grid_crossing */
    struct key_map line_numbers;
    struct list known;     /* struct known_point */
    uint32_t *first_known; /* by base cell */
    uint8_t *wanted;       /* by base cell: a mesh is to be made of it (again) */
    bool has_wanted;       /* some of them, for a line that was cast late */
};

/* From one crossing to another in a face, the solid on the right as seen from where the axis points to. Between them
 * are vertices on edges of the surface. */
struct arc {
    uint32_t from, to, feature, features;
    bool bent; /* both ends are on one edge of the face */
};
struct face {
    uint32_t first, count; /* arcs */
    bool bad;              /* its cells are to be divided */
};

struct contour {
    struct solid_probe probe;
    double tolerance, size;
    struct line_grid grid;
    struct list vertices, triangles; /* struct solid_vertex, solid_triangle */
    struct list arcs, faces;
    struct key_map face_numbers, divided, passed; /* cells that are divided, that passed the tests which take long */
    int divisions;                                /* of small cells that are left */
    int finest;                                   /* cells of this size are never divided */
    bool failed;                                  /* no memory: the mesh is of no use */
};

/* A cell, by its lowest node, in finest units. */
struct cell {
    int at[3], size;
};

static inline struct solid_vertex *contour_vertex(const struct contour *contour, uint32_t index) {
    return (struct solid_vertex *)contour->vertices.items + index;
}
static inline struct vec3 vec3_with(struct vec3 v, int axis, double value) {
    return vec3_make(axis == 0 ? value : v.x, axis == 1 ? value : v.y, axis == 2 ? value : v.z);
}
static inline double grid_node(const struct line_grid *grid, int axis, int index) {
    return vec3_get(grid->origin, axis) + grid->step * index;
}
static inline uint64_t cell_key(const int at[3], int size, int kind) {
    int level = 31 - __builtin_clz((unsigned)size);
    return ((uint64_t)at[0] << 44 | (uint64_t)at[1] << 28 | (uint64_t)at[2] << 12 | (uint64_t)level << 4 |
            (uint64_t)kind) +
           1;
}
static inline bool contour_is_divided(const struct contour *contour, const struct cell *cell) {
    return key_map_find(&contour->divided, cell_key(cell->at, cell->size, 0)) != NULL;
}
static inline size_t grid_base_index(const struct line_grid *grid, const int base[3]) {
    return ((size_t)base[0] * (size_t)grid->base_count[1] + (size_t)base[1]) * (size_t)grid->base_count[2] +
           (size_t)base[2];
}

/* Without memory it sets contour->failed and returns a vertex that exists. */
uint32_t contour_add_vertex(struct contour *contour, const struct solid_vertex *vertex);
void contour_add_triangle(struct contour *contour, uint32_t a, uint32_t b, uint32_t c, uint32_t surface);

/* Everything is within about a quarter of the tolerance of the surface, but for *is_coarse: a mesh that may have
 * faults, of a solid with too many details. `cells`: base cells along the longest side. `known`: points of the surface,
 * struct known_point; the caller destroys it. Errors: no memory, cancelled. */
bool contour_build(const struct solid_input *input, uint32_t cells, struct solid_mesh *out, struct list *known,
                   bool *is_coarse, struct error *error);

#endif
