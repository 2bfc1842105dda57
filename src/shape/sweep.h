/* The sphere sweep: everything that a ball of changing radius covers while its centre runs along a spline. Closed.
 * Owner: the arena it was built in. */
#ifndef GRAY_SHAPE_SWEEP_H
#define GRAY_SHAPE_SWEEP_H

#include "base/arena.h"
#include "base/bundle.h"
#include "base/error.h"
#include "geometry/crossing.h"
#include "geometry/hit.h"
#include "geometry/spline.h"
#include "math/box.h"
#include "math/ray.h"

struct sweep_path;

struct sweep_input {
    enum spline_kind kind;
    const double (*points)[3]; /* centres */
    const double *radii;       /* >= 0; interpolated by the same spline */
    uint32_t count;
    bool loop;
};

const struct sweep_path *sweep_build(struct arena *arena, const struct sweep_input *input, struct error *error);
struct box sweep_bounds(const struct sweep_path *sweep);
/* The least and the greatest dot(g, p) over the shape. */
void sweep_extent(const struct sweep_path *sweep, struct vec3 g, double *lo, double *hi);
/* Piece `number` as Bezier points of x, y, z and of the radius; the direction changes little within a piece. False:
 * there are fewer pieces. */
bool sweep_piece_tube(const struct sweep_path *sweep, uint32_t number, double tube[4][4]);
/* The part is a piece of the path, u the place of the ball that touches there. */
bool sweep_crossings(const struct sweep_path *sweep, const struct ray *ray, struct geom_scratch *scratch,
                     struct crossing_list *out);
bool sweep_contains(const struct sweep_path *sweep, struct vec3 point);
/* v runs along the path, one unit over all of it; u runs around it, from the direction of a fixed axis. */
void sweep_describe(const struct sweep_path *sweep, const struct ray *ray, const struct crossing *crossing,
                    struct surface *out);
uint32_t sweep_scratch_need(const struct sweep_path *sweep);
/* Copies what *sweep points to (base/bundle.h). */
void sweep_bundle(struct bundle *bundle, const struct sweep_path **sweep);

#endif
