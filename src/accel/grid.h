/* A uniform voxel grid over boxes, traversed by the algorithm of Amanatides and Woo, "A Fast Voxel Traversal Algorithm
 * for Ray Tracing", Eurographics 1987. Invariant: every item is listed in every voxel its box touches. Knows boxes and
 * indices only. Infinite boxes are in a separate list that every ray tests first. */
#ifndef GRAY_ACCEL_GRID_H
#define GRAY_ACCEL_GRID_H

#include "base/error.h"
#include "base/pool.h"
#include "math/box.h"
#include "math/ray.h"

#include <stddef.h>
#include <stdint.h>

struct grid {
    struct box bounds; /* of the finite items, padded */
    uint32_t cells[3]; /* 0 when there is no finite item */
    struct vec3 cell_size, inverse_cell_size;
    uint32_t *cell_start; /* cells product + 1 */
    uint32_t *cell_items; /* item indices, ascending inside a voxel */
    uint32_t *unbounded;  /* items with an infinite box, ascending */
    uint32_t unbounded_count;
    uint32_t item_count;
};

/* boxes[i] belongs to item i; empty boxes are left out. Owner: the caller, grid_destroy frees it. */
bool grid_build(struct grid *grid, const struct box *boxes, uint32_t count, struct pool *pool, struct error *error);
void grid_destroy(struct grid *grid);
size_t grid_memory(const struct grid *grid);

/* for (ok = grid_traversal_begin(&w, grid, ray); ok; ok = grid_traversal_next(&w)) { w.items[0 .. w.count-1]; if (best
 * t <= w.t_exit) stop }: visits the unbounded list first (t_exit = -infinity), then voxels in order along the ray;
 * empty voxels are skipped. w.t_exit is where the ray leaves the voxel: a hit with t <= t_exit is final. */
struct grid_traversal {
    const uint32_t *items;
    uint32_t count;
    double t_exit;
    const struct grid *grid;
    double t_next[3], t_step[3], t_end;
    int64_t cell, cell_step[3];
    uint32_t left[3];
    uint32_t voxels; /* visited so far, empty ones too */
    int state;
};
bool grid_traversal_begin(struct grid_traversal *traversal, const struct grid *grid, const struct ray *ray);
bool grid_traversal_next(struct grid_traversal *traversal);

#endif
