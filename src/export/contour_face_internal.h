/* The faces of cells. */
#ifndef GRAY_EXPORT_CONTOUR_FACE_INTERNAL_H
#define GRAY_EXPORT_CONTOUR_FACE_INTERNAL_H

#include "export/contour_internal.h"

/* The arcs of a face at right angles to an axis. */
struct face face_arcs(struct contour *contour, int axis, const int at[3], int size);

#endif
