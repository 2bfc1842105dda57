/* A union of disjoint solids is equivalent to several primitives, and a hierarchy over primitives finds the right one
 * faster than a solid finds its operand. */
#ifndef GRAY_CSG_CSG_SPLIT_H
#define GRAY_CSG_CSG_SPLIT_H

#include "csg/csg_build.h"

/* As csg_build, in as many parts as have disjoint boxes; together they have the same crossings as the whole.
 * In the order of their first operands. */
bool csg_build_parts(struct arena *arena, const struct csg_program *program, const struct csg ***parts, uint32_t *count,
                     struct error *error);

#endif
