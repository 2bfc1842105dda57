/* Boxes with edges in any directions that cover a shape. They are tighter than its bounds for long and thin shapes: a
 * cylinder, a rectangle, a curve. Anti-aliasing uses them to find shapes that the first samples of a picture miss
 * (render/thin_map_internal.h). */
#ifndef GRAY_SHAPE_SHAPE_PART_H
#define GRAY_SHAPE_SHAPE_PART_H

#include "shape/shape.h"

/* The points corner + a edges[0] + b edges[1] + c edges[2] for a, b and c from 0 to 1; edges are at right angles, or
 * those of a parallelogram, and may be zero. */
struct oriented_box {
    struct vec3 corner, edges[3];
};

struct oriented_box oriented_box_of(const struct box *box);
struct oriented_box oriented_box_of_quadric(const struct revolved_quadric *quadric);
struct oriented_box oriented_box_of_planar(const struct planar *planar); /* infinite: it has no end */
bool oriented_box_is_finite(const struct oriented_box *box);

/* BOX: covered by a box. TUBE: by balls whose centres and radii are a cubic curve. */
enum shape_part_kind { SHAPE_PART_BOX, SHAPE_PART_TUBE };
struct shape_part {
    enum shape_part_kind kind;
    union {
        struct oriented_box box;
        double tube[4][4]; /* Bezier points of x, y, z and of the radius, which is >= 0 */
    };
};

/* The part as a box. */
struct oriented_box shape_part_box(const struct shape_part *part);
/* The two halves of a part: divided across the longest edge of a box in the target space of `map`, or at the middle of
 * a curve. */
void shape_part_split(const struct shape_part *part, const struct affine *map, struct shape_part halves[2]);

#endif
