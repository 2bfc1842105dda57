/* The cells of a density along a line, and the density in them. */
#ifndef GRAY_MATERIAL_DENSITY_INTERNAL_H
#define GRAY_MATERIAL_DENSITY_INTERNAL_H

#include "material/density.h"
#include "material/fog_cells_internal.h"

/* Its cells, and for each the minimum and the maximum; NULL: it has none. */
const float (*density_cells(const struct density *density, struct fog_cells *cells))[2];
/* The cell of a point of the box. */
uint64_t density_cell(const struct density *density, struct vec3 p);
/* At any point. */
double density_value(const struct density *density, struct vec3 p, double time);
/* At a point of a cell whose bound is `high`. */
double density_at(const struct density *density, struct vec3 p, double time, double high);

/* The cells along a line:
 *     density_begin(density, &line, &traversal);
 *     while (density_next(&traversal)) ... in [from, to) the density is between low and high. */
struct density_traversal {
    const struct density *density;
    struct fog_traversal cells;
    double from, to, low, high;
    bool more;
};
void density_begin(const struct density *density, const struct medium_line *line, struct density_traversal *traversal);
bool density_next(struct density_traversal *traversal);

#endif
