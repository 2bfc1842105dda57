/* Crossings of rays and surfaces, with only the data to compare them and to describe the hit later. Searches use only
 * crossings; normals, uv and materials are computed once, for the nearest one (shape_describe). */
#ifndef GRAY_GEOMETRY_CROSSING_H
#define GRAY_GEOMETRY_CROSSING_H

#include "accel/triangle_index.h"
#include "base/sort.h"
#include "geometry/hit.h"
#include "math/box.h"
#include "math/ray.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct crossing {
    union {
        struct {
            double t;
            double u, v;   /* barycentric weights of vertices 1 and 2 on a mesh; free for other shapes. Of an implicit
                            * solid u is the tolerance. */
            uint32_t part; /* which face, triangle or nappe */
            bool enter;    /* the line goes from outside to inside here (geometric, after a CSG flip) */
            bool flip;     /* CSG difference or inverse turned the surface inside out */
            uint16_t leaf; /* which CSG operand made the surface; 0 outside CSG */
        };
        struct triangle_hit on_mesh; /* t to enter, so that a search of triangles writes them directly */
    };
};
_Static_assert(offsetof(struct crossing, part) == offsetof(struct triangle_hit, triangle) &&
                   offsetof(struct crossing, enter) == offsetof(struct triangle_hit, enter),
               "a hit on a mesh is a crossing but for what follows enter");

/* One worker's memory for lists of crossings, used as a stack. It grows between rays, never during one: if it is too
 * small a push fails, `overflow` is set, and the caller of the whole query calls geom_scratch_grow and repeats it. */
struct geom_scratch {
    struct crossing *items;
    uint32_t capacity, used;
    bool overflow;
    bool fixed;      /* it never grows */
    float tolerance; /* 0; of previews a share of t: crossings may be off by twice as much */
    /* the cost of searches; sums, which searches never read */
    uint64_t shape_tests;
    uint64_t box_tests; /* of single boxes; a node of a hierarchy is one of cost.hierarchy_steps */
    struct triangle_cost cost;
};

/* A list on top of the scratch: items[first .. first + count - 1]. */
struct crossing_list {
    uint32_t first, count;
};

bool geom_scratch_init(struct geom_scratch *scratch, uint32_t capacity);
void geom_scratch_destroy(struct geom_scratch *scratch);
bool geom_scratch_grow(struct geom_scratch *scratch); /* doubles, clears overflow and used; false: no memory */

/* All steps and tests. */
static inline uint64_t geom_work(const struct geom_scratch *scratch) {
    return scratch->cost.hierarchy_steps + scratch->cost.voxels + scratch->cost.triangle_tests + scratch->box_tests +
           scratch->shape_tests;
}

static inline bool geom_scratch_push(struct geom_scratch *scratch, struct crossing crossing) {
    if (scratch->used == scratch->capacity) {
        scratch->overflow = true;
        return false;
    }
    scratch->items[scratch->used++] = crossing;
    return true;
}

/* --- The line of a ray, normalised for a shape: the origin is moved along it to near the shape, the direction is a
 * unit vector, and s counts object units from there. So the numbers in a root finder do not depend on the distance of
 * the ray's origin, nor on the length of its direction. Scaling by powers of two scales s and changes nothing else
 * --- */

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

/* Most lists are short and nearly sorted: insertion sort; heap sort for long ones. `before` compares two crossings and
 * is a total order: then it does not matter that sorting is not stable. */
static inline void crossings_sort_by(struct crossing *items, uint32_t count, sort_before *before) {
    enum { FEW = 40 };
    if (count > FEW) {
        sort_items(items, count, sizeof *items, before);
        return;
    }
    for (uint32_t i = 1; i < count; i++) {
        struct crossing moved = items[i];
        uint32_t j = i;
        for (; j > 0 && before(&moved, &items[j - 1]); j--)
            items[j] = items[j - 1];
        items[j] = moved;
    }
}

/* Sorts crossings by t (then part, then u). */
void crossings_sort(struct crossing *items, uint32_t count);
/* Converts all crossings above `first` on the scratch, whose t has s in any order, into the list of an open or closed
 * shape: sorted by t; for a closed one also without pairs at one t and with alternating entries and exits. */
void line_finish_open(const struct line *line, struct geom_scratch *scratch, uint32_t first, struct crossing_list *out);
void line_finish_closed(const struct line *line, struct geom_scratch *scratch, uint32_t first,
                        struct crossing_list *out);

/* Cylindrical and spherical image coordinates, also for surfaces without coordinates of their own. */

/* Unit vectors at right angles to the unit vector `axis` from which angles are counted; x and z for the axis y. */
void surface_mapping_axes(struct vec3 axis, struct vec3 *x, struct vec3 *z);

/* Both fill u, v, dpdu and dpdv of a surface whose point and normal are known; normals may have any length > 0. u is
 * the angle about the axis, from 0 to 1 to the right as seen from outside, starting at the back (at -x for the axis y).
 * Where the surface faces the axis, u runs in the other direction, so that images are not mirrored. */

/* Spherical, from `centre`: v is the angle above the lower pole, 0 to 1. The axis is y. */
void surface_mapping_sphere(struct vec3 centre, struct surface *out);
/* Cylindrical, about the axis through `base`: v is the height above the base in units of `length`. The axis has unit
 * length. */
void surface_mapping_label(struct vec3 base, struct vec3 axis, double length, struct surface *out);

#endif
