/* A union of solids that keep apart is as good as several primitives, and a hierarchy over primitives finds the right
 * one faster than a solid finds its operand. */
#ifndef GRAY_CSG_CSG_SPLIT_H
#define GRAY_CSG_CSG_SPLIT_H

#include "csg/csg.h"

/* As csg_build, in as many parts as have disjoint boxes; together they answer every ray as the whole does.
 * In the order of their first operands. */
bool csg_build_parts(struct arena *arena, const struct csg_program *program, const struct csg ***parts, uint32_t *count,
                     struct error *error);

#endif
