/* The lathe: a profile in the half-plane of radius and height, rotated about the y axis. Owner: the arena it was built
 * in. */
#ifndef GRAY_SHAPE_LATHE_H
#define GRAY_SHAPE_LATHE_H

#include "base/arena.h"
#include "base/bundle.h"
#include "base/error.h"
#include "geometry/crossing.h"
#include "geometry/hit.h"
#include "geometry/spline.h"
#include "math/box.h"
#include "math/ray.h"

struct lathe;

struct lathe_input {
    enum spline_kind kind;
    const double (*points)[2]; /* radius >= 0 and height */
    uint32_t count;
    bool loop; /* back to the first point: a ring */
    bool open; /* no discs from the ends to the axis: a sheet, unless both ends are on it */
};

/* A profile that is a loop (also when its last point is its first) or whose ends are on the axis, or joined to it by
 * discs, bounds a solid; inside is by even-odd. Errors give the reason. */
const struct lathe *lathe_build(struct arena *arena, const struct lathe_input *input, struct error *error);
struct box lathe_bounds(const struct lathe *lathe);
/* The least and the greatest dot(g, p) over the shape. */
void lathe_extent(const struct lathe *lathe, struct vec3 g, double *lo, double *hi);
bool lathe_is_closed(const struct lathe *lathe);
/* The part is a piece of the profile, u the place on it. */
bool lathe_crossings(const struct lathe *lathe, const struct ray *ray, struct geom_scratch *scratch,
                     struct crossing_list *out);
bool lathe_contains(const struct lathe *lathe, struct vec3 point);
/* v runs along the profile by its length, u around the axis from -x, to the right as seen from outside with the profile
 * pointing upwards: images follow the profile and are never mirrored. */
void lathe_describe(const struct lathe *lathe, const struct ray *ray, const struct crossing *crossing,
                    struct surface *out);
uint32_t lathe_scratch_need(const struct lathe *lathe);
/* Copies what *lathe points to (base/bundle.h). */
void lathe_bundle(struct bundle *bundle, const struct lathe **lathe);

#endif
