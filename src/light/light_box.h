/* Rectangles and boxes sampled by the solid angle that they fill. */
#ifndef GRAY_LIGHT_LIGHT_BOX_H
#define GRAY_LIGHT_LIGHT_BOX_H

#include "math/sampling.h"
#include "math/vec3.h"

#include <stdbool.h>

/* A rectangle as a point sees it. */
struct spherical_rectangle {
    struct vec3 from, x, y, z;
    double x0, x1, y0, y1, z0, b0, b1, k, angle; /* angle: the solid angle */
};
/* False: its edges are not at right angles, or it is seen too small for it to matter. */
bool spherical_rectangle_make(struct vec3 corner, struct vec3 edge1, struct vec3 edge2, struct vec3 from,
                              struct spherical_rectangle *out);
struct vec3 spherical_rectangle_point(const struct spherical_rectangle *seen, struct sample2 place);

/* A box with right angles: at most three of its faces are seen from outside, each a rectangle. Directions are uniform
 * in the solid angle of all of them. */
struct light_box {
    struct vec3 corner, edges[3]; /* edges: at right angles */
};

/* A box as a point sees it. */
struct spherical_box {
    uint32_t count; /* of faces; those seen too small are left out, and directions through them have density 0 */
    struct spherical_rectangle faces[3];
    int axes[3];  /* the edge across each face */
    double angle; /* the solid angle of all faces */
};

/* False: the point is inside, or every face is seen too small. */
bool spherical_box_make(const struct light_box *box, struct vec3 from, struct spherical_box *out);
/* A point on a face; equal areas of the unit square are equal solid angles. */
struct vec3 spherical_box_point(const struct spherical_box *seen, struct sample2 place);
/* The density of the directions to such points, by solid angle, of a direction (of any length) that meets the box. */
double spherical_box_pdf(const struct light_box *box, const struct spherical_box *seen, struct vec3 from,
                         struct vec3 direction);

#endif
