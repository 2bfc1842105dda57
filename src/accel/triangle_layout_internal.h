/* The memory layout of the indexed triangles of a mesh. Private to src/accel/triangle_*.
 *
 * Local space: (p - centre) * scale, scale a power of two, so that the mesh fills [-1, 1] along its longest axis to
 * half at least. Scaling a mesh by a power of two changes no bit of its index. Single precision appears in local space
 * only.
 *
 * Frame: a uniform grid of voxels over the local box, with a border of outside voxels. A voxel holds a
 * reference to the hierarchy of the triangles that touch it. Triangles that touch very many voxels are in one hierarchy
 * of their own, which every ray visits first.
 *
 * Invariant: a triangle is listed in every voxel that its box, grown by VOXEL_MARGIN, touches (or among the big ones),
 * and lies in that voxel's hierarchy with its box cut to the voxel grown by VOXEL_MARGIN. */
#ifndef GRAY_ACCEL_TRIANGLE_LAYOUT_INTERNAL_H
#define GRAY_ACCEL_TRIANGLE_LAYOUT_INTERNAL_H

#include "accel/triangle_index.h"

enum {
    WIDTH = 8,
    MAX_BRANCH_DEPTH = 96, /* of the binary hierarchy that a hierarchy is made from, so no node lies deeper */
    STACK_ENTRIES = MAX_BRANCH_DEPTH * (WIDTH - 1) + WIDTH /* the largest stack of a search */
};

/* Local units. The rounding of a traversal is below 2^-16 (a few hundred steps at most, each off by 2^-24 of 4 or
 * so). */
#define VOXEL_MARGIN 0x1p-13f

/* Boxes in nodes are larger by this on every side, local units. It covers the rounding to single precision of the ray,
 * whose origin is at most NEAR_BY = 8 in size (2^-22 for the origin, 2^-20 for the distance along it to a side), of the
 * box (2^-25) and of plane * r - m (2^-20 at most). */
#define NEAR_BY 8
#define BOX_GROWTH 0x1p-18f

/* A reference: REF_EMPTY, REF_OUTSIDE, REF_LEAF | number of a block, or number of a node (from 1). */
#define REF_EMPTY 0u
#define REF_OUTSIDE UINT32_MAX
#define REF_LEAF (UINT32_C(1) << 31)

/* Voxels of a frame that has one, its border counted. */
enum { ONE_VOXEL = 27 };

/* Boxes of up to eight children; an unused child has a box that no ray hits and comes last. order: for each octant of
 * directions (bit k of its number: negative along axis k) all eight lanes, from the last one met to the first, three
 * bits each from the lowest; a search visits children in this order. */
struct wide_node {
    float bounds[6][WIDTH]; /* min x, max x, min y, max y, min z, max z */
    uint32_t child[WIDTH];
    uint32_t order[8];
};

/* Up to eight triangles: corner 0, the two edges from it, their numbers, and those of their vertices (which saves the
 * deciding test a memory access). An unused lane has a triangle with edges of 1/16, so far outside (in each coordinate
 * of its corner) that the tolerance of every test is larger than its determinant: it is never a certain hit; the few
 * rays that pass near it use the deciding test, which treats it as a point. */
#define UNUSED_AT 0x1p20f
struct triangle_block {
    float corner[3][WIDTH], edge1[3][WIDTH], edge2[3][WIDTH];
    uint32_t ids[WIDTH], vertices[3][WIDTH];
};

/* The fields that every ray reads come first. Vectors of three have a fourth number, unused or 0, so that they can be
 * loaded at once. */
struct triangle_index {
    double centre[4];
    /* Sizes of the origin (lanes 0 to 2) and direction (lanes 4 to 6) of rays that need not be moved to the frame: from
     * .. less than to. All 0: every ray is moved. */
    float usual_from[WIDTH], usual_to[WIDTH];
    double scale;
    uint32_t only;                 /* the hierarchy of the only voxel, if there is only one */
    float half_single[4];          /* local half extents, margin included */
    struct wide_node *nodes;       /* nodes[0] is not used */
    struct triangle_block *blocks; /* in the table that begins with the nodes */
    size_t voxel_count;
    uint32_t big; /* reference to the triangles that touch very many voxels */
    uint32_t node_count, block_count;
    uint32_t cells[3]; /* without the border */
    double half[4];
    float cell[4], inverse_cell[4], last_cell[4]; /* last_cell: cells - 1 */
    uint32_t *voxels;                             /* (cells + 2) of each axis; NULL: there is one */
    uint32_t stride[2];                           /* of y and z in voxels[] */
    /* where the next voxel is: by the direction's negative axes, then by the axes stepped along */
    int32_t offset[8][8];
};

#endif
