/* Removes triangles from a fine mesh of a solid. */
#ifndef GRAY_EXPORT_SIMPLIFY_INTERNAL_H
#define GRAY_EXPORT_SIMPLIFY_INTERNAL_H

#include "export/solid_mesh_internal.h"

/* How near a vertex is kept: within the tolerance, much nearer, in its place. */
enum { KEEP_NEAR, KEEP_CLOSE, KEEP_VERTEX };

struct simplify_input {
    double tolerance;
    double size;         /* of the solid */
    double resolution;   /* the coordinates are multiples of about this number: triangles are at least so high */
    const uint8_t *keep; /* by vertex */
};

/* The vertices that stay are those of the fine mesh; edges and corners of the solid keep their places, and no removed
 * vertex is farther than the tolerance from the mesh. Triangles may intersect afterwards, and may be far from the
 * surface where the fine mesh had no vertices. False: no memory. */
bool simplify_mesh(struct solid_mesh *mesh, const struct simplify_input *input);

#endif
