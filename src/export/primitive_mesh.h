/* One primitive of a world as a solid, and its mesh. */
#ifndef GRAY_EXPORT_PRIMITIVE_MESH_H
#define GRAY_EXPORT_PRIMITIVE_MESH_H

#include "base/error.h"
#include "base/pool.h"
#include "csg/csg.h"
#include "formats/list.h"
#include "world/world.h"

enum { SOLID_LEAVES = 65535 };

/* A solid in the making, in the space of the world; the arrays have room for all. */
struct solid_program {
    struct csg_leaf *leaves;
    struct csg_token *tokens;
    uint32_t leaf_count, length;
};
/* Unites it with a closed primitive at time 0. False: more than SOLID_LEAVES. */
bool solid_program_add(struct solid_program *program, const struct world *world, uint32_t primitive);

/* The corners of the triangles of a closed, finite primitive that is no mesh, counterclockwise as seen from outside: so
 * many struct vec3 are added to the list. Errors: those of solid_mesh_build. */
bool primitive_mesh_build(const struct world *world, uint32_t primitive, double tolerance, struct pool *pool,
                          struct list *corners, struct error *error);

#endif
