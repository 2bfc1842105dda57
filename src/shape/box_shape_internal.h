/* The box's mathematics, in its own space. Parts are the faces in the order of enum box_face. */
#ifndef GRAY_SHAPE_BOX_SHAPE_INTERNAL_H
#define GRAY_SHAPE_BOX_SHAPE_INTERNAL_H

#include "geometry/crossing.h"
#include "geometry/hit.h"
#include "math/box.h"
#include "math/ray.h"

enum box_face { BOX_POSITIVE_X, BOX_NEGATIVE_X, BOX_POSITIVE_Y, BOX_NEGATIVE_Y, BOX_POSITIVE_Z, BOX_NEGATIVE_Z };

/* Both crossings of the whole line in order, the entering one first; false when there are none. A line that lies in the
 * plane of a face or touches only an edge or a corner does not cross. */
bool box_shape_crossings(const struct box *box, const struct ray *ray, struct crossing out[2]);
bool box_shape_contains(const struct box *box, struct vec3 point);
/* Moves a point onto the plane of a face; normal: the outward unit normal. */
void box_face_point(const struct box *box, enum box_face face, struct vec3 *point, struct vec3 *normal);
void box_shape_describe(const struct box *box, const struct ray *ray, const struct crossing *crossing,
                        struct surface *out);

#endif
