/* The division of the bounds of an implicit solid into regions. */
#ifndef GRAY_SHAPE_IMPLICIT_REGIONS_INTERNAL_H
#define GRAY_SHAPE_IMPLICIT_REGIONS_INTERNAL_H

#include "shape/implicit_internal.h"

/* Fills nodes, regions, programs and tight from the rest. */
bool implicit_regions_build(struct arena *arena, struct implicit *solid, struct error *error);

#endif
