/* The beam around rays of one origin, in double precision: four planes through the origin, from the smallest and the
 * largest slope of the rays over the axis that is the longest for the first of them. Always conservative. */
#ifndef GRAY_ACCEL_BEAM_H
#define GRAY_ACCEL_BEAM_H

#include "accel/box_tree.h"
#include "accel/ray_packet.h"

struct beam {
    double origin[3], slack; /* slack: world units, for the rounding of differences from the origin */
    int forward, side[2];
    bool backwards;
    double slope_min[2], slope_max[2]; /* of coordinate / |forward| */
    double soonest; /* 1 / the largest |direction| ahead: t is at least the distance ahead times this */
};

/* False: the rays do not point in the same direction along that axis. */
bool beam_make(struct beam *out, const struct ray_packet *rays);

/* Items whose box the beam meets, nearest boxes first:
 *   beam_traversal_begin(&traversal, tree, &beam); while (beam_traversal_next(&traversal, t_max, &item)) ...
 * t_max: the largest t of interest to any ray; it may shrink between calls. */
struct beam_traversal {
    const struct box_tree *tree;
    const struct beam *beam;
    uint32_t steps;
    int top;
    uint32_t child[BOX_TREE_STACK];
    double enter[BOX_TREE_STACK];
};
void beam_traversal_begin(struct beam_traversal *traversal, const struct box_tree *tree, const struct beam *beam);
bool beam_traversal_next(struct beam_traversal *traversal, double t_max, uint32_t *item);

/* The shaft from one point to a parallelogram (Haines and Wallace, "Shaft Culling for Efficient Ray-Traced Radiosity",
 * 1991): every segment from the point to the parallelogram lies inside. */
struct shaft {
    struct box bounds;
    struct vec3 normal[5]; /* outward; a box that is on the outer side of one of them is outside */
    double offset[5];
    int planes;
};
struct shaft shaft_make(struct vec3 from, struct vec3 corner, struct vec3 edge1, struct vec3 edge2);
/* Items whose box meets the shaft, at most `limit`; returns the count, or limit + 1 when there are more. */
uint32_t box_tree_in_shaft(const struct box_tree *tree, const struct shaft *shaft, uint32_t *items, uint32_t limit);

#endif
