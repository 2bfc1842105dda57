/* Splines as cubic Bezier segments, in up to four dimensions. */
#ifndef GRAY_GEOMETRY_SPLINE_H
#define GRAY_GEOMETRY_SPLINE_H

#include "base/arena.h"
#include "base/bundle.h"
#include "base/error.h"
#include "base/list.h"
#include <stdbool.h>

#include <stdint.h>

#define SPLINE_KINDS(X)                                                                                                \
    X(SPLINE_LINEAR, "linear")           /* straight from point to point */                                            \
    X(SPLINE_CATMULL_ROM, "catmull-rom") /* through all points; the ends' neighbours are mirrored unless given */      \
    X(SPLINE_B_SPLINE, "b-spline") /* uniform cubic, near the points; begins and ends at the first and the last one */ \
    X(SPLINE_BEZIER, "bezier")     /* 3 n + 1 points (closed: 3 n), every third is passed */
enum spline_kind { SPLINE_KINDS(LIST_MEMBER) };

/* Straight segments have their inner points at the thirds. */
struct spline_segment {
    double b[4][4]; /* [dimension][control point] */
};

struct spline_input {
    enum spline_kind kind;
    int dimensions;
    const double *points; /* count * dimensions numbers */
    uint32_t count;
    bool closed; /* from the last point back to the first, which is not repeated */
    /* SPLINE_CATMULL_ROM, open: the points before the first and after the last one, or NULL: mirrored at the ends */
    const double *before, *after;
};

/* The error ends with the reason. Neighbouring segments share their common point bit by bit. */
bool spline_build(struct arena *arena, const struct spline_input *input, struct spline_segment **segments,
                  uint32_t *count, struct error *error);

/* --- A planar curve cut into pieces for root finding: each piece is monotone in both coordinates (so its end points
 * are its box) and turns little. Neighbouring pieces share their common point bit by bit, which the parity of crossings
 * requires. Used by the lathe (p is the radius, q the height) and the prism (p is x, q is z) --- */

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
/* The direction of the curve at x; the direction of the chord where the derivative is zero. */
void outline_tangent(const struct outline_piece *piece, double x, double *dp, double *dq);
/* What it points to (base/bundle.h). */
bundle_fields outline_bundle;

#endif
