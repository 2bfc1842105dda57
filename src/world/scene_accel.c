/* How many voxels has the frame? A voxel spares a ray that passes it the upper levels of the hierarchy and costs it a
 * step. In a cloud of alike primitives without surroundings, with three voxels to each of them, steps win by a
 * tenth (10,000 spheres) to a fifth (200,000) of the whole picture. But one floor around the cloud makes voxels of the
 * floor's size, which contain everything at once: 25 times slower at 10,000, 190 times at 200,000. No resolution that
 * is the same everywhere suits both. ACCEL_AUTO asks the cost model of accel/accel_cost.c, which knows from a sample of
 * the boxes how many voxels a line visits, how long their lists are, and how long for somebody who looks at the
 * crowd: voxels with lists where they cost clearly less, else one voxel with the hierarchy of box_tree.c in it, which
 * also lets packets and shafts through. ACCEL_GRID and ACCEL_BVH pin it. docs/performance.md has the measurements. */
#include "world/scene_accel.h"

#include "accel/accel_cost.h"

static struct box box_of(const void *context, uint32_t i) {
    return ((const struct box *)context)[i];
}

/* Voxels only where the account is clear: packets and shafts, which the hierarchy alone can answer, are worth about a
 * third of it, and few primitives cost little either way. */
static enum accel_kind choose(const struct box *boxes, uint32_t count) {
    enum { FEW = 1000, SAMPLES = 4096 };
    const double clear = 0.6;
    if (count < FEW)
        return ACCEL_BVH;
    struct box bounds = box_empty();
    for (uint32_t i = 0; i < count; i++) {
        if (!box_is_empty(&boxes[i]) && vec3_finite(boxes[i].min) && vec3_finite(boxes[i].max))
            bounds = box_join(bounds, boxes[i]);
    }
    if (box_is_empty(&bounds))
        return ACCEL_BVH;
    struct cost_sample cost_sample;
    cost_sample_take(&cost_sample, &bounds, box_of, boxes, count, SAMPLES, MESSAGE_LEVELS);
    struct accel_scene_cost cost = accel_lists_or_hierarchy(&cost_sample);
    return cost.lists < clear * cost.hierarchy ? ACCEL_GRID : ACCEL_BVH;
}

bool scene_accel_build(struct scene_accel *accel, enum accel_kind wanted, const struct box *boxes, uint32_t count,
                       struct pool *pool, struct error *error) {
    accel->kind = wanted == ACCEL_AUTO ? choose(boxes, count) : wanted;
    switch (accel->kind) {
    case ACCEL_GRID:
        return grid_build(&accel->grid, boxes, count, pool, error);
    case ACCEL_AUTO:
    case ACCEL_BVH:
        return box_tree_build(&accel->tree, boxes, count, pool, error);
    case ACCEL_KDTREE:
        return kd_tree_build(&accel->kd_tree, boxes, count, NULL, NULL, pool, error);
    case ACCEL_NONE:
        return true;
    }
    return true;
}

void scene_accel_destroy(struct scene_accel *accel) {
    grid_destroy(&accel->grid);
    box_tree_destroy(&accel->tree);
    kd_tree_destroy(&accel->kd_tree);
}

size_t scene_accel_memory(const struct scene_accel *accel) {
    switch (accel->kind) {
    case ACCEL_GRID:
        return grid_memory(&accel->grid);
    case ACCEL_AUTO:
    case ACCEL_BVH:
        return box_tree_memory(&accel->tree);
    case ACCEL_KDTREE:
        return kd_tree_memory(&accel->kd_tree);
    case ACCEL_NONE:
        return 0;
    }
    return 0;
}
