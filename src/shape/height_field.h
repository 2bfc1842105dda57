/* The height field: a table of heights over the unit square 0 <= x, z <= 1, two triangles to a cell (cut from the
 * corner at least x and z to the opposite one), closed downwards by walls and a floor, or a sheet. Owner: the arena it
 * was built in. */
#ifndef GRAY_SHAPE_HEIGHT_FIELD_H
#define GRAY_SHAPE_HEIGHT_FIELD_H

#include "base/arena.h"
#include "base/bundle.h"
#include "base/error.h"
#include "geometry/crossing.h"
#include "geometry/hit.h"
#include "math/box.h"
#include "math/ray.h"

struct height_field;

struct height_field_input {
    const double *heights;  /* columns * rows; row by row, x runs within a row, z from row to row */
    uint32_t columns, rows; /* at least 2 each */
    bool open;              /* a sheet without walls and floor */
    double floor;           /* height of the floor, below all heights */
    bool smooth;            /* shading normals are interpolated */
};

const struct height_field *height_field_build(struct arena *arena, const struct height_field_input *input,
                                              struct error *error);
/* The input of the same surface on a grid that is `n` times as fine, with heights in the arena: heights are linear
 * along the edges and the diagonals of the cells. False: more than 32768 columns or rows, or no memory. */
bool height_field_refine(const struct height_field *field, uint32_t n, struct arena *arena,
                         struct height_field_input *out, struct error *error);
double height_field_step(const struct height_field *field); /* the diagonal of a cell on the ground */
struct box height_field_bounds(const struct height_field *field);
/* The least and the greatest dot(g, p) over the shape. */
void height_field_extent(const struct height_field *field, struct vec3 g, double *lo, double *hi);
bool height_field_is_closed(const struct height_field *field);
/* Parts 0-4: floor, walls at x = 0, x = 1, z = 0, z = 1; then two per cell, row by row. */
bool height_field_crossings(const struct height_field *field, const struct ray *ray, struct geom_scratch *scratch,
                            struct crossing_list *out);
/* The first crossing inside the ray's interval, without those behind it. */
bool height_field_nearest(const struct height_field *field, const struct ray *ray, struct geom_scratch *scratch,
                          struct crossing *out);
bool height_field_contains(const struct height_field *field, struct vec3 point);
/* u = x and v = 1 - z on the ground, so that an image fits the heights that were made from it; on walls u runs to the
 * right seen from outside and v upwards. */
void height_field_describe(const struct height_field *field, const struct ray *ray, const struct crossing *crossing,
                           struct surface *out);
uint32_t height_field_scratch_need(const struct height_field *field);
/* Copies what *field points to (base/bundle.h). */
void height_field_bundle(struct bundle *bundle, const struct height_field **field);

#endif
