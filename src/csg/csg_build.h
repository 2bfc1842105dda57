/* Builds constructive solids from leaves and a postfix program. */
#ifndef GRAY_CSG_CSG_BUILD_H
#define GRAY_CSG_CSG_BUILD_H

#include "csg/csg.h"

/* Leaves, and the operations on them in postfix order. */
struct csg_program {
    const struct csg_leaf *leaves;
    uint32_t leaf_count;
    const struct csg_token *tokens;
    uint32_t length;
};

/* Copies leaves and program into the arena, works out bounds and a plan. Fails on no memory, on an empty or malformed
 * program (assertion of the caller), on more than 65535 leaves. */
const struct csg *csg_build(struct arena *arena, const struct csg_leaf *leaves, uint32_t leaf_count,
                            const struct csg_token *program, uint32_t program_length, struct error *error);
/* The same; the tokens behind the first solid_length make the solid that clips, if there are any. Its leaves come after
 * those of the solid. */
const struct csg *csg_build_clipped(struct arena *arena, const struct csg_program *program, uint32_t solid_length,
                                    struct error *error);

#endif
