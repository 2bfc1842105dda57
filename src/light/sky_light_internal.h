/* A sky as a light: directions in proportion to their radiance. */
#ifndef GRAY_LIGHT_SKY_LIGHT_INTERNAL_H
#define GRAY_LIGHT_SKY_LIGHT_INTERNAL_H

#include "base/arena.h"
#include "base/bundle.h"
#include "base/pool.h"
#include "light/sky.h"
#include "math/sampling.h"

/* A part of a cell: half of it, half of that, and so on. */
struct sky_part {
    double share;    /* of the first of its two halves */
    uint32_t halves; /* the first one; the second one follows. 0: it is not divided */
    bool by_height;  /* else by longitude */
};

/* Cells of height y and longitude; in the arena it was built in. */
struct sky_table {
    uint32_t rows, columns;
    const double *row_until; /* share of the unit interval up to and with a row, from y = 1 down */
    const double *until;     /* rows x columns: the same inside of a row */
    const struct sky_part *parts;
    const uint32_t *divided; /* rows x columns: the part that is the whole cell, 0: none. NULL: no cell is divided */
    uint32_t part_count;
};

/* NULL: no memory. A sky that is black everywhere gives a table of equal cells. */
const struct sky_table *sky_table_build(const struct sky *sky, struct arena *arena, struct pool *pool);
struct sky_sample {
    struct vec3 direction; /* unit */
    struct colour radiance;
    double pdf; /* of the direction, by solid angle */
    struct colour
        intensity; /* radiance / pdf as classic light: the colour of a white surface is its mean times (n.l) */
};
/* The sample for a place of the unit square. */
struct sky_sample sky_table_sample(const struct sky *sky, const struct sky_table *table, struct sample2 xi);
/* Its density for a unit direction. */
double sky_table_pdf(const struct sky_table *table, struct vec3 direction);
/* Copies what *table points to (base/bundle.h). */
void sky_table_bundle(struct bundle *bundle, const struct sky_table **table);

#endif
