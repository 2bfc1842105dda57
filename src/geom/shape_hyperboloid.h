/* The hyperboloids of one and of two sheets about the y axis. */
#ifndef GRAY_GEOM_SHAPE_HYPERBOLOID_H
#define GRAY_GEOM_SHAPE_HYPERBOLOID_H

#include "geom/conic.h"

/* One sheet: radius `waist` at y = 0 and `rim` > waist at y = lo or hi, whichever is farther. lo < hi. */
struct conic conic_one_sheet(double waist, double rim, double lo, double hi, bool open);
/* Two sheets with their tips at y = -gap and y = gap, radius `rim` at y = -reach and y = reach > gap > 0. */
struct conic conic_two_sheets(double gap, double reach, double rim, bool open);

#endif
