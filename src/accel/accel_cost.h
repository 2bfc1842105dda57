/* The cost of traversing a grid of voxels, estimated from a sample of its items. */
#ifndef GRAY_ACCEL_ACCEL_COST_H
#define GRAY_ACCEL_ACCEL_COST_H

#include "math/box.h"

#include <stdbool.h>
#include <stdint.h>

enum { MESSAGE_LEVELS = 7 };

/* Level l has cubical voxels, 2^l along the longest axis. */
struct cost_level {
    uint32_t cells[3];
    double filled;     /* voxels that are not empty, by the sample */
    double visited;    /* voxels that a random line through the frame visits */
    double occupied;   /* those of them that are occupied */
    double listed;     /* entries of their lists that it passes */
    double neighbours; /* items in the voxel of a random item */
};

struct cost_sample {
    struct cost_level levels[MESSAGE_LEVELS];
    uint32_t level_count; /* 1: no choice, or no memory */
    double items;
};

typedef struct box cost_box(const void *context, uint32_t item);

struct cost_items {
    const struct box *bounds;
    cost_box *box_of;
    const void *context;
    uint32_t count;
};
/* Samples at most `samples` of the items; empty and infinite boxes are left out. Levels 0 .. levels - 1, fewer
 * where voxels would be many times as many as items. Deterministic. */
void cost_sample_take(struct cost_sample *cost_sample, const struct cost_items *items, uint32_t samples,
                      uint32_t levels);

/* Costs, in visits of a node, of a frame with about three voxels per item and lists in them, and of one voxel with a
 * hierarchy of four children per node. */
struct accel_scene_cost {
    double lists, hierarchy;
};
struct accel_scene_cost accel_lists_or_hierarchy(const struct cost_sample *cost_sample);

/* A frame over a mesh: for every level of the cost sample, the cost of a ray through voxels with hierarchies of eight
 * children per node, in visits of a node, without the cost common to all levels; and the level with the lowest cost. */
struct accel_mesh_cost {
    double costs[MESSAGE_LEVELS];
    uint32_t level;
};
struct accel_mesh_cost accel_over_mesh(const struct cost_sample *cost_sample);

#endif
