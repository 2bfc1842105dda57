/* Parts of a mesh that touch. */
#ifndef GRAY_EXPORT_SEPARATE_INTERNAL_H
#define GRAY_EXPORT_SEPARATE_INTERNAL_H

#include "export/solid_mesh_internal.h"

/* Moves vertices, by fractions of the tolerance, until no triangles intersect, as far as this helps. Coordinates stay
 * numbers of single precision. False: no memory, cancelled. */
bool separate_parts(struct solid_mesh *mesh, const struct solid_input *input, struct solid_findings *findings,
                    struct error *error);

#endif
