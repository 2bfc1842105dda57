/* Closed outlines moved inwards by a distance: what a bevelled prism is made of. */
#ifndef GRAY_GEOMETRY_INSET_H
#define GRAY_GEOMETRY_INSET_H

#include "base/arena.h"
#include "base/error.h"
#include "geometry/spline.h"

#include <stdbool.h>
#include <stdint.h>

/* A corner of an outline of straight lines. */
struct inset_corner {
    double inner[2]; /* where the lines beside it meet after they are moved */
    double before[2],
        after[2]; /* the points of these lines nearest to `inner`; the corner itself unless it is convex */
    bool convex;  /* the solid turns around it by less than half a turn */
};

/* corners[i] belongs to the point i; equal neighbours are not allowed. `left`: the solid is left of the outline.
 * Errors: a line is too short for the distance. */
bool inset_corners(const double (*points)[2], uint32_t count, bool left, double distance, struct inset_corner *corners,
                   struct error *error);
/* Whether the point is at least so far from all lines of the outline. */
bool inset_is_clear(const double (*points)[2], uint32_t count, const double point[2], double distance);

/* The Bezier points (3 for each piece, the last one joins the first) of a smooth closed curve that is moved to its
 * left, or with a negative distance to its right, within a millionth of the distance. Errors: the curve has a corner or
 * turns too sharply, no memory. */
struct inset_points {
    double (*items)[2];
    uint32_t count;
};
bool inset_curve(struct arena *arena, const struct spline_segment *segments, uint32_t count, double to_left,
                 struct inset_points *out, struct error *error);

#endif
