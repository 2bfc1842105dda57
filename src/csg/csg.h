/* CSG as one primitive: a postfix program over leaves. The crossings of the whole line with every leaf are merged in
 * one pass by ascending t while the truth value of the program is tracked; where it changes, the surface is there.
 * Difference and inverse flip the normal. A cut face keeps the leaf that made it, hence its material.
 *
 * A clipped surface is two programs: what is shown is the surface of the first where the second is true; it has no caps
 * and no inside. Its first program may be one leaf that is no solid. Owner: the arena it was built in. */
#ifndef GRAY_CSG_CSG_H
#define GRAY_CSG_CSG_H

#include "base/arena.h"
#include "base/bundle.h"
#include "base/error.h"
#include "shape/shape.h"

/* Binary ones take the two above them, the inverse takes one. */
enum csg_operation { CSG_LEAF, CSG_UNION, CSG_INTERSECTION, CSG_DIFFERENCE, CSG_INVERSE };

/* The invisible side of a clipped surface: the back, or the front. */
enum csg_cull { CSG_CULL_NONE, CSG_CULL_BACK, CSG_CULL_FRONT };

struct csg_leaf {
    struct shape shape; /* closed; nested programs are flattened into one */
    struct transform csg_from_leaf;
    const struct box *limit; /* in CSG space: nothing of the leaf that matters is outside of it; NULL: not known */
    uint32_t material;
    uint32_t slot_count; /* of a mesh: face slot k has material + k; below 2 all have `material` */
    enum csg_cull cull;  /* of a surface that is clipped; CSG_CULL_NONE in solids */
    uint32_t origin;     /* a number that the creator of the leaf chose, to identify it */
};

struct csg_token {
    enum csg_operation operation;
    uint16_t leaf; /* of CSG_LEAF */
};

struct csg {
    const struct csg_leaf *leaves;
    uint32_t leaf_count; /* 1 .. 65535 */
    const struct csg_token *program;
    uint32_t program_length;
    uint32_t solid_length; /* the program's first tokens make the solid, those behind them the clip */
    bool clipped;          /* there is a clip */
    bool open;             /* the solid is one leaf that is a mere surface */
    bool inside_out;       /* what is far away is inside */
    struct box bounds;     /* of the surface; of the solid too unless it is inside out */
    uint32_t stack_depth;
    uint32_t max_crossings; /* scratch items one ray needs, a guess when meshes are leaves */
    const bool *convexity;  /* of each leaf: it is convex, and the solid lies in it */
    const void *plan;       /* data that csg_build prepares for the search (private to csg.c) */
};

bool csg_nearest(const struct csg *csg, const struct ray *ray, struct geom_scratch *scratch, struct crossing *out);
bool csg_any(const struct csg *csg, const struct ray *ray, struct geom_scratch *scratch);
/* All crossings of the whole line, by ascending t, pushed on the scratch: the caller pops them by setting scratch->used
 * to what it was. The solid is closed and finite. False: the scratch overflowed. */
bool csg_list_crossings(const struct csg *csg, const struct ray *ray, struct geom_scratch *scratch,
                        struct crossing_list *out);
/* A clipped surface contains no point. */
bool csg_contains(const struct csg *csg, struct vec3 point, struct geom_scratch *scratch);
void csg_describe(const struct csg *csg, const struct ray *ray, const struct crossing *crossing, struct surface *out);
/* Copies what *csg points to (base/bundle.h). */
void csg_bundle(struct bundle *bundle, const struct csg **csg);

#endif
