/* The accelerator over the primitives of a world: one value of one kind. It only contains boxes and numbers of
 * primitives; the traversals that test primitives are in world.c and packet.c. */
#ifndef GRAY_WORLD_SCENE_ACCEL_H
#define GRAY_WORLD_SCENE_ACCEL_H

#include "accel/box_tree.h"
#include "accel/grid.h"
#include "accel/kd_tree.h"
#include "mesh/mesh.h"

/* Zero-initialised: nothing to destroy. Owns what it holds; the structures of other kinds stay zero.
 * What differs between the kinds is a switch of each operation: build, cells, and the search (world.c). */
struct scene_accel {
    enum accel_kind kind; /* once built never ACCEL_AUTO */
    struct grid grid;
    struct box_tree tree; /* ACCEL_BVH */
    struct kd_tree kd_tree;
};

/* For ACCEL_AUTO the cost model chooses ACCEL_GRID or ACCEL_BVH. `boxes` in world space, by primitive; they are not
 * kept. Errors: no memory, cancelled; the caller then destroys partial results. */
bool scene_accel_build(struct scene_accel *accel, enum accel_kind requested, const struct box *boxes, uint32_t count,
                       struct pool *pool, struct error *error);
void scene_accel_destroy(struct scene_accel *accel);
size_t scene_accel_memory(const struct scene_accel *accel); /* bytes */

/* The accelerator of the previous frame, kept for the next one. Zero-initialised: there is none. Owns its contents. */
struct accel_cache {
    bool full; /* it has an accelerator */
    struct scene_accel accel;
    struct box *boxes; /* that it was made of, or last refitted to */
    uint32_t count, capacity;
    enum accel_kind requested;
    double cost; /* of the hierarchy when it was built; 0: it was not kept yet */
};

/* Returns the stored accelerator if it fits these boxes. It is unchanged if the boxes are the same. It is refitted if
 * there are as many boxes and the cost model still chooses a hierarchy, unless its cost has grown by a quarter since it
 * was built. Searches find the same as in a new accelerator. False: it must be built. */
bool accel_cache_reuse(struct accel_cache *cache, enum accel_kind requested, const struct box *boxes, uint32_t count,
                       struct scene_accel *accel);
/* Takes over an accelerator over these boxes, which are copied; without memory for them nothing is kept. */
void accel_cache_keep(struct accel_cache *cache, enum accel_kind requested, const struct box *boxes, uint32_t count,
                      struct scene_accel *accel);
void accel_cache_destroy(struct accel_cache *cache);

/* Called with a cell and its load, or its closeness to the root: 1 and more is high. `whole`: the box of everything,
 * which comes first. Returns whether to continue. */
typedef bool scene_accel_visit(void *context, const struct box *cell, bool whole, double share);
/* Cells for pictures of the accelerator, about `limit` of them, spread evenly: the occupied voxels and leaves, or the
 * inner nodes of the hierarchy; none for ACCEL_NONE. */
void scene_accel_cells(const struct scene_accel *accel, uint32_t limit, scene_accel_visit *visit, void *context);

/* The hierarchy for beams and shafts; NULL: there is none. */
static inline const struct box_tree *scene_accel_hierarchy(const struct scene_accel *accel) {
    return accel->tree.nodes ? &accel->tree : NULL;
}

#endif
