/* The cells of a box along a line, in order (Amanatides and Woo, "A Fast Voxel Traversal Algorithm", Eurographics
 * 1987). */
#ifndef GRAY_MATERIAL_FOG_CELLS_INTERNAL_H
#define GRAY_MATERIAL_FOG_CELLS_INTERNAL_H

#include "math/vec3.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

struct fog_cells {
    struct vec3 corner, size;
    uint32_t count[3];
};

static inline uint64_t fog_cell_count(const struct fog_cells *cells) {
    return (uint64_t)cells->count[0] * cells->count[1] * cells->count[2];
}

struct fog_traversal {
    const struct fog_cells *cells;
    double t, to, next[3], delta[3];
    int64_t cell[3], step[3];
};

/* The part of the line inside the box; false: none. */
static inline bool fog_cells_clip(const struct fog_cells *cells, struct vec3 o, struct vec3 d, double *from,
                                  double *to) {
    for (int axis = 0; axis < 3; axis++) {
        double start = vec3_get(o, axis), step = vec3_get(d, axis), low = vec3_get(cells->corner, axis);
        double high = low + vec3_get(cells->size, axis);
        if (step == 0) {
            if (start < low || start >= high)
                return false;
            continue;
        }
        double a = (low - start) / step, b = (high - start) / step;
        *from = math_max(*from, a < b ? a : b);
        *to = math_min(*to, a < b ? b : a);
    }
    return *from < *to;
}

/* Starts at o along d, up to t = distance. False: the line misses the box. */
static inline bool fog_traversal_begin(struct fog_traversal *traversal, const struct fog_cells *cells, struct vec3 o,
                                       struct vec3 d, double distance) {
    traversal->cells = cells;
    traversal->t = 0;
    traversal->to = distance;
    if (!fog_cells_clip(cells, o, d, &traversal->t, &traversal->to))
        return false;
    for (int axis = 0; axis < 3; axis++) {
        double start = vec3_get(o, axis), speed = vec3_get(d, axis), low = vec3_get(cells->corner, axis);
        double width = vec3_get(cells->size, axis) / cells->count[axis];
        double at = floor((start + speed * traversal->t - low) / width);
        traversal->cell[axis] = at < 0 ? 0 : at >= cells->count[axis] ? (int64_t)cells->count[axis] - 1 : (int64_t)at;
        traversal->step[axis] = speed > 0 ? 1 : -1;
        double border = low + width * (double)(traversal->cell[axis] + (speed > 0 ? 1 : 0));
        traversal->next[axis] = speed == 0 ? INFINITY : (border - start) / speed;
        traversal->delta[axis] = speed == 0 ? INFINITY : width / fabs(speed);
    }
    return true;
}

/* The next cell, and the part of the line in it; x varies fastest in the index of the cell. False: the line has left
 * the box. */
static inline bool fog_traversal_next(struct fog_traversal *traversal, uint64_t *cell, double *from, double *to) {
    const uint32_t *count = traversal->cells->count;
    for (int axis = 0; axis < 3; axis++)
        if (traversal->cell[axis] < 0 || traversal->cell[axis] >= count[axis])
            return false;
    if (!(traversal->t < traversal->to))
        return false;
    const double *next = traversal->next;
    int axis = next[0] <= next[1] && next[0] <= next[2] ? 0 : next[1] <= next[2] ? 1 : 2;
    *cell = (uint64_t)traversal->cell[0] +
            count[0] * ((uint64_t)traversal->cell[1] + count[1] * (uint64_t)traversal->cell[2]);
    *from = traversal->t;
    *to = traversal->t = math_min(next[axis], traversal->to);
    traversal->next[axis] += traversal->delta[axis];
    traversal->cell[axis] += traversal->step[axis];
    return true;
}

#endif
