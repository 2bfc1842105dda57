/* The lines of the grid. */
#ifndef GRAY_EXPORT_CONTOUR_GRID_INTERNAL_H
#define GRAY_EXPORT_CONTOUR_GRID_INTERNAL_H

#include "export/contour_internal.h"

/* Casts the lines of the base cells' edges and those between them, and lines through the box of each leaf. */
bool line_grid_build(struct contour *contour, uint32_t cells, struct pool *pool, struct error *error);
void line_grid_destroy(struct line_grid *grid);
/* The line of an axis through the node with these two other indices, in the order of the axes after it; cast when it is
 * first asked for. */
struct grid_line grid_line(struct contour *contour, int axis, int u, int v);

#endif
