/* The cost of traversing a grid of voxels, estimated from a sample of its items. */
#ifndef GRAY_ACCEL_FRAME_COST_H
#define GRAY_ACCEL_FRAME_COST_H

#include "math/box.h"

#include <stdbool.h>
#include <stdint.h>

enum { MESSAGE_LEVELS = 7 };

/* Level l has cubical voxels, 2^l along the longest axis. */
struct frame_level {
    uint32_t cells[3];
    double filled;   /* voxels that are not empty, by the sample */
    double visited;  /* voxels that a random line through the frame visits */
    double occupied; /* those of them that hold something */
    double listed;   /* entries of their lists that it passes */
    double around;   /* things in the voxel of a random thing */
};

struct frame_census {
    struct frame_level levels[MESSAGE_LEVELS];
    uint32_t level_count; /* 1: nothing to choose from, or no memory */
    double items;
};

typedef struct box frame_box(const void *context, uint32_t item);

/* Looks at `samples` of the `count` items at most; empty and infinite boxes are left out. Levels 0 .. levels - 1, fewer
 * where voxels would be many times as many as items. Deterministic. */
void frame_census_take(struct frame_census *census, const struct box *bounds, frame_box *box_of, const void *context,
                       uint32_t count, uint32_t samples, uint32_t levels);

/* A frame of about three voxels to an item with lists in them, against one voxel with a hierarchy of four children to a
 * node; in visits of its nodes. */
struct frame_choice {
    double lists, hierarchy;
};
struct frame_choice frame_lists_or_hierarchy(const struct frame_census *census);

/* A frame over a mesh: for every level of the census what a ray costs through voxels with hierarchies of eight children
 * to a node in them, in visits of a node and beyond what all levels have in common; and the level that costs least. */
struct frame_of_mesh {
    double costs[MESSAGE_LEVELS];
    uint32_t level;
};
struct frame_of_mesh frame_over_mesh(const struct frame_census *census);

#endif
