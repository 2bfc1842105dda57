/* Splines as cubic Bezier segments, in up to four dimensions. */
#ifndef GRAY_GEOM_SPLINE_H
#define GRAY_GEOM_SPLINE_H

#include "base/arena.h"
#include "base/error.h"
#include "base/list.h"

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

/* Error ends with what is wrong with the points. Neighbouring segments share their common point bit by bit. */
bool spline_build(struct arena *arena, const struct spline_input *input, struct spline_segment **segments,
                  uint32_t *count, struct error *error);

#endif
