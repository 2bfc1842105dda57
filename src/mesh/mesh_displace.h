/* Displacement: a mesh divided into small triangles whose vertices are moved by a recorded function. */
#ifndef GRAY_MESH_MESH_DISPLACE_H
#define GRAY_MESH_MESH_DISPLACE_H

#include "expr/expr_program.h"
#include "mesh/mesh_smooth.h"

#define DISPLACED_TRIANGLES 10000000

struct mesh_displacement {
    /* A program of p, s.normal, s.u and s.v, at a vertex before it moves. One output: a distance along the normal, in
     * object units; three: an offset. */
    const struct expr_program *program;
    double edge; /* the maximum length of an edge before the vertices move; 0: `level` applies */
    int level;   /* how often every edge is halved */
};

/* The tables of the displaced mesh, without normals. The division of an edge depends only on its ends, so faces that
 * share an edge divide it at the same points. Vertices at equal positions move together: along the mean normal of all
 * their faces, weighted with angles, and by the mean of the values where texture coordinates differ. So a closed mesh
 * stays closed. Errors: more than DISPLACED_TRIANGLES, a result that is not finite, an input that does not exist, no
 * memory. `own` is zero before. */
bool mesh_input_displace(const struct mesh *mesh, const struct mesh_displacement *by, struct mesh_input *input,
                         struct mesh_tables *own, struct error *error);

#endif
