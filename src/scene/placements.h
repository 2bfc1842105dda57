/* The many placements of the children of one node: what a node for each would say in ten times the memory. */
#ifndef GRAY_SCENE_PLACEMENTS_H
#define GRAY_SCENE_PLACEMENTS_H

#include "math/affine.h"

#include <stdint.h>

/* Placement i scales by size, turns about the axis, then moves to its place; or it is matrix i. Everything lives in the
 * arena of the scene. */
struct placements {
    uint32_t count;
    const double (*at)[3];         /* count places; NULL with matrices */
    const double *turn, *size;     /* degrees; factors, not 0; NULL: none */
    bool one_turn, one_size;       /* the first is everybody's */
    int axis;                      /* of turn */
    const struct affine *matrices; /* count maps that have an inverse, or NULL */
};

struct transform placement_transform(const struct placements *placements, uint32_t i);

#endif
