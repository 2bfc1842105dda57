/* Implicit solids: the points within a box or a ball where a function is negative. A point with the value NaN is
 * outside. A discontinuity with a change of sign is a surface. The function is a recorded expression. Bounds of its
 * values and slopes prove that a segment of a line has no crossing, or one. The caller need not give a gradient. */
#ifndef GRAY_SHAPE_IMPLICIT_H
#define GRAY_SHAPE_IMPLICIT_H

#include "base/arena.h"
#include "base/bundle.h"
#include "base/error.h"
#include "expr/expr_program.h"
#include "geometry/crossing.h"

struct implicit_input {
    const struct expr_program *program; /* of p alone, with one output; it must outlive the shape */
    struct box bounds;                  /* finite, min < max on every axis; not read of a ball */
    bool is_ball;
    struct vec3 centre;
    double radius; /* > 0 */
    bool open;     /* without caps on the bounds */
    /* 0, or a promise: |f(a) - f(b)| <= lipschitz |a - b| for all points of the bounds, but for jumps without a change
     * of sign. It replaces the bounds of values and slopes: for functions whose bounds are too wide, as of fractals.
     * The search only needs that |f| / lipschitz is at most the distance from the surface; is_distance promises no
     * more. */
    double lipschitz;
    bool is_distance;
};

enum { IMPLICIT_SLOW = 3000 };
struct implicit;

/* NULL and error: no memory, or the program is not of p alone. The work is bounded. */
const struct implicit *implicit_build(struct arena *arena, const struct implicit_input *in, struct error *error);
/* What some points and lines show of a solid. */
struct implicit_findings {
    /* With a Lipschitz bound: how many points, at how many of them the slope of the function is above the bound, and
     * the largest slope. Of distances: at how many of them the surface is closer, and the largest ratio. */
    uint32_t points, steep_points;
    double steepest;
    struct vec3 steepest_at;
    bool is_empty;    /* it is below 0 at none of them, nor at the centre of a region */
    double line_work; /* without a Lipschitz bound: the mean number of operations for a line, if it is below 10^6 */
    /* Where that is above IMPLICIT_SLOW: a bound that the slopes at all points support, and the mean number with it. */
    double lipschitz, marched_work;
};
/* The same findings for the same solid. False and an error: no memory. */
bool implicit_examine(const struct implicit *solid, struct implicit_findings *out, struct error *error);
const struct expr_program *implicit_program(const struct implicit *solid);
struct box implicit_bounds(const struct implicit *solid);
bool implicit_is_closed(const struct implicit *solid);
bool implicit_contains(const struct implicit *solid, struct vec3 point);
void implicit_describe(const struct implicit *solid, const struct ray *ray, const struct crossing *crossing,
                       struct surface *out);
uint32_t implicit_scratch_need(const struct implicit *solid);
/* Copies what *implicit points to (base/bundle.h). */
void implicit_bundle(struct bundle *bundle, const struct implicit **implicit);

#endif
