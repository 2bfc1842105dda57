/* A planar curve cut into pieces that a root-finder likes: each piece is monotone in both coordinates (so its end
 * points are its box) and turns little. Neighbouring pieces share their common point bit by bit, on which the parity of
 * crossings rests. Used by the lathe (p is the radius, q the height) and the prism (p is x, q is z). */
#ifndef GRAY_GEOM_OUTLINE_H
#define GRAY_GEOM_OUTLINE_H

#include "geom/spline.h"

#include <stdbool.h>

struct outline_piece {
    double p[4], q[4]; /* Bezier points */
    double from, to;   /* fractions of the whole length at its ends */
    uint32_t segment;  /* of the spline it is cut from */
    bool straight;
};

struct outline {
    struct outline_piece *pieces;
    uint32_t count;
    double length; /* of all chords */
};

/* The first two dimensions of the segments; pieces of no extent are left out. */
bool outline_build(struct arena *arena, const struct spline_segment *segments, uint32_t count, bool straight,
                   struct outline *out, struct error *error);

/* Value of a cubic in Bezier form and its derivative; exact at 0 and 1. */
static inline double cubic_value(const double b[4], double x) {
    double y = 1 - x;
    return y * y * (y * b[0] + 3 * x * b[1]) + x * x * (3 * y * b[2] + x * b[3]);
}
static inline double cubic_slope(const double b[4], double x) {
    double y = 1 - x;
    return 3 * (y * y * (b[1] - b[0]) + 2 * x * y * (b[2] - b[1]) + x * x * (b[3] - b[2]));
}
/* Widens lo..hi by the values of a cubic on [0, 1]. */
void outline_range(const double b[4], double *lo, double *hi);
/* The direction of the curve at x, the chord where it stands still. */
void outline_tangent(const struct outline_piece *piece, double x, double *dp, double *dq);

#endif
