/* Which primitives may share a part of their surfaces: flush boxes, cemented lenses, a cup and what fills it. A search
 * finds one of several surfaces at one place, and rounding decides which; a hit on a primitive with partners looks for
 * the others (joint.h). Surfaces that only cross, or touch in a point, do not count. Partners are found by their
 * shapes: equal planes, round surfaces about one centre, other surfaces of one kind whose boxes meet. So partners may
 * have nothing in common, but what coincides has partners, except for what touching.c names. */
#ifndef GRAY_WORLD_TOUCHING_H
#define GRAY_WORLD_TOUCHING_H

#include "accel/box_tree.h"
#include "base/arena.h"
#include "base/bundle.h"

struct world;
struct flattening;

struct touching {
    const uint32_t *first;    /* by primitive, one more at the end: where its partners begin; NULL: there are none */
    const uint32_t *partners; /* in ascending order for each primitive */
    struct box_tree tree;     /* over all primitives, if the accelerator has none; owned */
};

/* Fills world->touching. The world has its primitives, solids and accelerator. Warns of flat primitives that others
 * hide. Errors: no memory, cancelled. */
bool touching_find(struct world *world, struct flattening *flattening);
void touching_destroy(struct touching *touching);

static inline bool touching_has(const struct touching *touching, uint32_t primitive) {
    return touching->first && touching->first[primitive] < touching->first[primitive + 1];
}

/* The partners of a primitive whose box meets a small box: begin, then next until it returns false. */
struct touching_query {
    const struct world *world;
    struct box region;
    uint32_t primitive;
    const uint32_t *list, *end; /* list NULL: the tree is searched, since there are many */
    struct box_tree_meeting meeting;
};
void touching_begin(struct touching_query *query, const struct world *world, uint32_t primitive,
                    const struct box *region);
bool touching_next(struct touching_query *query, uint32_t *partner);
/* False: no box of a partner meets it. */
bool touching_any(const struct world *world, uint32_t primitive, const struct box *region);
/* What it points to (base/bundle.h), in a world with so many primitives. */
void touching_bundle(struct bundle *bundle, struct touching *touching, uint32_t primitive_count);

#endif
