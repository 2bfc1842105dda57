/* Points in squares and discs, and random orders. */
#ifndef GRAY_MATH_SAMPLING_H
#define GRAY_MATH_SAMPLING_H

#include "base/random.h"
#include "math/vec3.h"

#include <stdbool.h>
#include <stdint.h>

struct sample2 {
    double x, y;
};

/* A point of cell (i, j) of the n x n cells of the unit square, jittered inside the cell; a function of its
 * arguments. */
static inline struct sample2 sample_cell(uint64_t key, uint32_t i, uint32_t j, uint32_t n) {
    uint64_t bits = random_combine(key, (uint64_t)j * n + i);
    double x = random_unit(bits), y = random_unit(random_mix(bits + UINT64_C(0x9e3779b97f4a7c15)));
    return (struct sample2){((double)i + x) / (double)n, ((double)j + y) / (double)n};
}

/* The same inside part (part % side, part / side) of side x side parts of the cell. */
static inline struct sample2 sample_cell_part(uint64_t key, uint32_t i, uint32_t j, uint32_t n, uint32_t part,
                                              uint32_t side) {
    struct sample2 inner = sample_cell(random_combine(key, (uint64_t)j * n + i), part % side, part / side, side);
    return (struct sample2){((double)i + inner.x) / (double)n, ((double)j + inner.y) / (double)n};
}

/* Part (part % side, part / side) of side x side of cell (i, j) of n x n cells. */
struct sample_part {
    uint32_t i, j, n, part, side;
};
/* A point of a part, so that all parts of all cells together are one multi-jittered set: with m = n * side, each of the
 * m x m parts has one point, and so has each of the m^2 columns and each of the m^2 rows. `set` is the key of the set,
 * `key` that of the jitter. */
struct sample2 sample_multi(uint64_t set, uint64_t key, struct sample_part part);
/* Element `index` of a random order of 0 .. count-1 (a bijection for every key). */
uint32_t sample_permute(uint32_t index, uint32_t count, uint64_t key);
/* Maps the unit square onto the unit disc; keeps the ratio of areas, and is continuous. */
struct sample2 sample_disc(struct sample2 square);
/* A direction on the side of a unit normal, with the density of its cosine over pi. */
struct vec3 sample_cosine(struct vec3 normal, struct sample2 square);

/* The entry of a table that a number of [0, 1) selects; until: rising shares up to and with each of the entries. */
static inline uint64_t sample_entry(const double *until, uint64_t count, double x) {
    uint64_t low = 0, high = count - 1;
    while (low < high) {
        uint64_t middle = low + (high - low) / 2;
        if (until[middle] > x)
            high = middle;
        else
            low = middle + 1;
    }
    return low;
}

/* Rectangles and boxes sampled by their solid angle. */

/* The directions and lengths of the edges of a rectangle. */
struct rectangle_frame {
    bool right; /* its edges have lengths, and are at right angles */
    struct vec3 x, y, z;
    double width, height;
};
struct rectangle_frame rectangle_frame_make(struct vec3 edge1, struct vec3 edge2);

/* A rectangle as a point sees it. */
struct spherical_rectangle {
    struct vec3 from, x, y, z;
    double x0, x1, y0, y1, z0, b0, b1, k, angle; /* angle: the solid angle */
};
/* False: its edges are not at right angles, or its solid angle is too small. */
bool spherical_rectangle_make(const struct rectangle_frame *frame, struct vec3 corner, struct vec3 from,
                              struct spherical_rectangle *out);
struct vec3 spherical_rectangle_point(const struct spherical_rectangle *seen, struct sample2 xi);

/* A box with right angles: at most three of its faces are seen from outside, each a rectangle. Directions are uniform
 * in the solid angle of all of them. */
struct light_box {
    struct vec3 corner, edges[3]; /* edges: at right angles */
};

/* A box as a point sees it. */
struct spherical_box {
    uint32_t count; /* of faces; those with a very small solid angle are left out, and directions through them have
                       density 0 */
    struct spherical_rectangle faces[3];
    int axes[3];  /* the edge across each face */
    double angle; /* the solid angle of all faces */
};

/* False: the point is inside, or all solid angles are too small. */
bool spherical_box_make(const struct light_box *box, struct vec3 from, struct spherical_box *out);
/* A point on a face; equal areas of the unit square are equal solid angles. */
struct vec3 spherical_box_point(const struct spherical_box *seen, struct sample2 xi);
/* The density by solid angle of a direction (of any length) that meets the box. */
double spherical_box_pdf(const struct light_box *box, const struct spherical_box *seen, struct vec3 from,
                         struct vec3 direction);

/* Sampling of a triangle by its solid angle at a point. */
struct spherical_triangle {
    struct vec3 from, corner, edge1, edge2;
    struct vec3 a, b, across; /* unit directions of two corners; `across`: from a towards the third one, tangent at a */
    double cos_ab, cos_ac, cos_alpha, sin_alpha; /* cosines of two arcs; the angle at a */
    double angle;                                /* the solid angle */
};

/* False: its solid angle is too small, or almost a half-space. */
bool spherical_triangle_make(struct vec3 corner, struct vec3 edge1, struct vec3 edge2, struct vec3 from,
                             struct spherical_triangle *out);
/* A point of the triangle; equal areas of the unit square are equal solid angles. */
struct vec3 spherical_triangle_point(const struct spherical_triangle *seen, struct sample2 xi);

#endif
