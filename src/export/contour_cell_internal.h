/* The cells. */
#ifndef GRAY_EXPORT_CONTOUR_CELL_INTERNAL_H
#define GRAY_EXPORT_CONTOUR_CELL_INTERNAL_H

#include "export/contour_internal.h"

/* Adds the triangles of a cell. False: it is to be divided, and nothing was added; not for the smallest. */
bool cell_mesh(struct contour *contour, const struct cell *cell);

#endif
