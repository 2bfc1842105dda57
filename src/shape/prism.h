/* The prism: an outline in the xz plane, of one or more closed curves, extruded along y. Inside is by even-odd, so a
 * curve within another is a hole. Owner: the arena it was built in. */
#ifndef GRAY_SHAPE_PRISM_H
#define GRAY_SHAPE_PRISM_H

#include "base/arena.h"
#include "base/bundle.h"
#include "base/error.h"
#include "geometry/crossing.h"
#include "geometry/hit.h"
#include "geometry/spline.h"
#include "math/box.h"
#include "math/ray.h"

struct prism;

struct prism_input {
    enum spline_kind kind;
    const double (*points)[2];    /* x and z of all curves, one after the other */
    const uint32_t *curve_starts; /* curve_count + 1 entries; a last point equal to the first one is not needed */
    uint32_t curve_count;
    double from, to; /* heights, from < to */
};

const struct prism *prism_build(struct arena *arena, const struct prism_input *input, struct error *error);
struct box prism_bounds(const struct prism *prism);
/* The least and the greatest dot(g, p) over the shape. */
void prism_extent(const struct prism *prism, struct vec3 g, double *lo, double *hi);
/* Parts: PRISM_SIDES and more are pieces of the outline with u the place on them; of straight lines one for each. */
enum prism_part { PRISM_BOTTOM, PRISM_TOP, PRISM_SIDES };
bool prism_crossings(const struct prism *prism, const struct ray *ray, struct geom_scratch *scratch,
                     struct crossing_list *out);
bool prism_contains(const struct prism *prism, struct vec3 point);
/* Sides: u along the curve by its length, to the right seen from outside, v upwards. Bottom and top: u along x, v along
 * z over the bounds, at the top in the opposite direction: nothing is mirrored. */
void prism_describe(const struct prism *prism, const struct ray *ray, const struct crossing *crossing,
                    struct surface *out);
uint32_t prism_scratch_need(const struct prism *prism);
/* Copies what *prism points to (base/bundle.h). */
void prism_bundle(struct bundle *bundle, const struct prism **prism);

#endif
