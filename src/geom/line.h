/* The line of a ray in a shape's own measure: the origin is moved along it to where it passes the shape, the direction
 * is a unit vector, s counts object units from there. So the numbers that a root-finder sees do not depend on how far
 * away the ray began, nor on the length of its direction. Scaling by powers of two scales s and changes nothing else.
 */
#ifndef GRAY_GEOM_LINE_H
#define GRAY_GEOM_LINE_H

#include "geom/crossing.h"
#include "math/box.h"
#include "math/ray.h"

struct line {
    struct vec3 origin, direction;
    double t0, speed; /* t = t0 + s / speed */
};

/* False: the ray has no direction, or its numbers overflow. */
bool line_init(struct line *line, const struct ray *ray, struct vec3 centre);

static inline double line_t(const struct line *line, double s) {
    return line->t0 + s / line->speed;
}
static inline struct vec3 line_at(const struct line *line, double s) {
    return vec3_add_scaled(line->origin, line->direction, s);
}
/* Whether the whole line meets the box, which has been padded for rounding. */
static inline bool line_meets_box(const struct line *line, const struct box *box) {
    double enter = -INFINITY, leave = INFINITY;
    for (int axis = 0; axis < 3; axis++) {
        double o = vec3_get(line->origin, axis), d = vec3_get(line->direction, axis);
        double lo = vec3_get(box->min, axis) - o, hi = vec3_get(box->max, axis) - o;
        if (d == 0) {
            if (lo > 0 || hi < 0)
                return false;
            continue;
        }
        double near = (d > 0 ? lo : hi) / d, far = (d > 0 ? hi : lo) / d;
        enter = near > enter ? near : enter;
        leave = far < leave ? far : leave;
    }
    return enter <= leave;
}

/* Sorts crossings by t (then part, then u). */
void crossings_sort(struct crossing *items, uint32_t count);
/* Turns everything above `first` on the scratch, whose t holds s in any order, into the list of an open or closed
 * shape: by ascending t, and for a closed one without pairs at one t and with enter and leave alternating. */
void line_finish_open(const struct line *line, struct geom_scratch *scratch, uint32_t first, struct crossing_list *out);
void line_finish_closed(const struct line *line, struct geom_scratch *scratch, uint32_t first,
                        struct crossing_list *out);

#endif
