/* Planar shapes, anywhere in space: planes, parallelograms, discs, triangles and polygons. A point is origin + a u + b
 * v; a and b decide whether it belongs to the shape and are its image coordinates, so u points along the rows of an
 * image and v up its columns. The normal's side is the front. */
#ifndef GRAY_SHAPE_PLANAR_H
#define GRAY_SHAPE_PLANAR_H

#include "base/arena.h"
#include "base/bundle.h"
#include "geometry/crossing.h"
#include "geometry/hit.h"
#include "math/ray.h"

enum planar_kind { PLANAR_PLANE, PLANAR_PARALLELOGRAM, PLANAR_DISC, PLANAR_TRIANGLE, PLANAR_POLYGON };

struct polygon; /* the outlines in (a, b); lives in an arena */

struct planar {
    enum planar_kind kind;
    struct vec3 origin, u, v;
    struct vec3 normal; /* at right angles to u and v, not 0 */
    double inner;       /* disc: radius of the hole as a share of the disc's */
    const struct polygon *polygon;
};

/* Two unit vectors perpendicular to the unit vector n, so that an image on the front is upright: the first is
 * horizontal, the second points up. x and -z for n = y. */
void planar_across(struct vec3 n, struct vec3 *level, struct vec3 *up);

/* 0 or 1 crossings; of the plane as a half-space, one more at t = -INFINITY or INFINITY where the line is inside. A
 * line in the plane does not cross. */
int planar_crossings(const struct planar *planar, const struct ray *ray, struct crossing out[2]);
bool planar_contains(const struct planar *planar, struct vec3 point); /* of the half-space; else false */
void planar_describe(const struct planar *planar, const struct ray *ray, const struct crossing *crossing,
                     struct surface *out);
void planar_extent(const struct planar *planar, struct vec3 g, double *lo, double *hi);

/* --- The infinite plane, and the half-space behind it --- */

/* { p : normal . p = distance }, normal of any length > 0, distance in units of length. As a solid the plane is the
 * half-space behind it. */
struct planar planar_plane(struct vec3 normal, double distance);

/* --- The square, the rectangle and the parallelogram --- */

/* From a corner along two edges that are not parallel; the front is where `along` turns to `up` counter-clockwise, and
 * an image on it is upright. */
struct planar planar_parallelogram(struct vec3 corner, struct vec3 along, struct vec3 up);
/* The square of docs/language.md 3.3: -0.5 .. 0.5 in x and z at y = 0, normal +y. */
struct planar planar_square(void);

/* --- The disc and the annulus --- */

/* 0 <= inner < radius, normal of any length > 0. */
struct planar planar_disc(struct vec3 centre, struct vec3 normal, double radius, double inner);

/* --- The single triangle; many of them are a mesh --- */

/* The front sees the corners counter-clockwise. */
struct planar planar_triangle(struct vec3 a, struct vec3 b, struct vec3 c);

/* --- The polygon: convex, concave, with holes --- */

/* Outlines of points that lie in one plane, one after the other; ends[i] is one past the last point of outline i. A
 * point is inside when it is so by the even-odd rule over all outlines; the front sees the first outline
 * counter-clockwise. False, with what is wrong in `why`: fewer than three points, no area, not flat, or (why = NULL) no
 * memory. */
bool planar_polygon(struct arena *arena, const struct vec3 *points, const uint32_t *ends, uint32_t outlines,
                    struct planar *out, const char **why);
/* An outline of a polygon, in (a, b); NULL: it has fewer. */
const double (*planar_outline(const struct planar *polygon, uint32_t outline, uint32_t *count))[2];
/* What it points to (base/bundle.h). */
bundle_fields planar_bundle;

#endif
