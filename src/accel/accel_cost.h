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
    double filled;   /* voxels that are not empty, by the sample */
    double visited;  /* voxels that a random line through the frame visits */
    double occupied; /* those of them that hold something */
    double listed;   /* entries of their lists that it passes */
    double around;   /* things in the voxel of a random thing */
};

struct cost_sample {
    struct cost_level levels[MESSAGE_LEVELS];
    uint32_t level_count; /* 1: nothing to choose from, or no memory */
    double items;
};

typedef struct box cost_box(const void *context, uint32_t item);

/* Looks at `samples` of the `count` items at most; empty and infinite boxes are left out. Levels 0 .. levels - 1, fewer
 * where voxels would be many times as many as items. Deterministic. */
void cost_sample_take(struct cost_sample *cost_sample, const struct box *bounds, cost_box *box_of, const void *context,
                      uint32_t count, uint32_t samples, uint32_t levels);

/* A frame of about three voxels to an item with lists in them, against one voxel with a hierarchy of four children to a
 * node; in visits of its nodes. */
struct accel_scene_cost {
    double lists, hierarchy;
};
struct accel_scene_cost accel_lists_or_hierarchy(const struct cost_sample *cost_sample);

/* A frame over a mesh: for every level of the cost sample what a ray costs through voxels with hierarchies of eight
 * children to a node in them, in visits of a node and beyond what all levels have in common; and the level that costs
 * least. */
struct accel_mesh_cost {
    double costs[MESSAGE_LEVELS];
    uint32_t level;
};
struct accel_mesh_cost accel_over_mesh(const struct cost_sample *cost_sample);

#endif
