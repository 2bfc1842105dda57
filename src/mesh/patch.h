/* Bicubic Bezier patches as a mesh: triangles fine enough for a tolerance, one net for all patches of a list, so that
 * neighbours with a common border meet without cracks; vertices that are the same are one, so patches that enclose a
 * volume give a closed mesh. */
#ifndef GRAY_MESH_PATCH_H
#define GRAY_MESH_PATCH_H

#include "base/arena.h"
#include "base/error.h"
#include "mesh/mesh.h"

struct patch_input {
    const char *name;          /* for messages */
    const double (*points)[3]; /* 16 per patch, row by row; u runs within a row, v from row to row */
    uint32_t count;            /* of patches */
    double tolerance;          /* largest distance from the true surface; 0: a thousandth of the size */
    bool flip;                 /* normals to the other side; else along dp/du x dp/dv */
};

/* The mesh's input, in the arena: vertices, normals, uv (0..1 over each patch). Errors: points that are no numbers, a
 * tolerance that would take more than some ten million triangles. */
bool patch_tessellate(struct arena *arena, const struct patch_input *input, struct mesh_input *out,
                      struct error *error);

#endif
