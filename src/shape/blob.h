/* The blob: where the fields of some balls and cylinders add up to a threshold. A ball of radius R and strength k has
 * the field k (1 - (d/R)^2)^2 within R, nothing outside; a cylinder the same with the distance from its axis, rounded
 * by half balls at its ends (POV-Ray's blob). Closed. Owner: the arena it was built in. */
#ifndef GRAY_SHAPE_BLOB_H
#define GRAY_SHAPE_BLOB_H

#include "base/arena.h"
#include "base/bundle.h"
#include "base/error.h"
#include "geometry/crossing.h"
#include "geometry/hit.h"
#include "math/box.h"
#include "math/ray.h"

struct blob;

struct blob_element {
    struct vec3 a, b; /* the ends of the axis; the same for a ball */
    double radius;    /* > 0 */
    double strength;  /* not 0; negative ones take away */
};

struct blob_input {
    const struct blob_element *elements;
    uint32_t count;
    double threshold; /* > 0 */
};

const struct blob *blob_build(struct arena *arena, const struct blob_input *input, struct error *error);
struct box blob_bounds(const struct blob *blob);
/* The least and the greatest dot(g, p) over the blob, at most a five-hundredth of its size too far out. */
void blob_extent(const struct blob *blob, struct vec3 g, double *lo, double *hi);
/* The part is the element that is strongest where the line crosses. */
bool blob_crossings(const struct blob *blob, const struct ray *ray, struct geom_scratch *scratch,
                    struct crossing_list *out);
bool blob_contains(const struct blob *blob, struct vec3 point);
/* Image coordinates are spherical, about the centre of the box around the positive elements; y is up. */
void blob_describe(const struct blob *blob, const struct ray *ray, const struct crossing *crossing,
                   struct surface *out);
uint32_t blob_scratch_need(const struct blob *blob);
/* Copies what *blob points to (base/bundle.h). */
void blob_bundle(struct bundle *bundle, const struct blob **blob);

#endif
