/* The number of voxels of the outer grid. Voxels save a ray the upper levels of the hierarchy and cost a step each. In
 * a cloud of similar primitives without other objects, with three voxels to each of them, steps win by a tenth (10,000
 * spheres) to a fifth (200,000) of the whole picture. But one floor around the cloud makes voxels of the floor's size,
 * which contain everything at once: 25 times slower at 10,000, 190 times at 200,000. No uniform resolution suits both.
 * ACCEL_AUTO asks the cost model of accel/accel_cost.c, which estimates from a sample of the boxes how many voxels a
 * line visits, the length of their lists, and the length for rays to the crowd: voxels with lists where they cost
 * clearly less, else one voxel with the hierarchy of box_tree.c in it, which also lets packets and shafts through.
 * ACCEL_GRID and ACCEL_BVH pin it. docs/lab/performance.md has the measurements. */
#include "world/scene_accel.h"

#include "accel/accel_cost.h"
#include "base/mem.h"
#include "math/elementary.h"

#include <string.h>

static struct box box_of(const void *context, uint32_t i) {
    return ((const struct box *)context)[i];
}

/* Voxels only if clearly cheaper: packets and shafts, which need the hierarchy, save about a third of its cost, and few
 * primitives cost little in both cases. */
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
    cost_sample_take(&cost_sample, &(struct cost_items){&bounds, box_of, boxes, count}, SAMPLES, MESSAGE_LEVELS);
    struct accel_scene_cost cost = accel_lists_or_hierarchy(&cost_sample);
    return cost.lists < clear * cost.hierarchy ? ACCEL_GRID : ACCEL_BVH;
}

bool scene_accel_build(struct scene_accel *accel, enum accel_kind requested, const struct box *boxes, uint32_t count,
                       struct pool *pool, struct error *error) {
    accel->kind = requested == ACCEL_AUTO ? choose(boxes, count) : requested;
    switch (accel->kind) {
    case ACCEL_GRID:
        return grid_build(&accel->grid, boxes, count, pool, error);
    case ACCEL_AUTO:
    case ACCEL_BVH:
        return box_tree_build(&accel->tree, boxes, count, pool, error);
    case ACCEL_KDTREE:
        return kd_tree_build(&accel->kd_tree, &(struct kd_items){boxes, count, NULL, NULL}, pool, error);
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
    return grid_memory(&accel->grid) + box_tree_memory(&accel->tree) + kd_tree_memory(&accel->kd_tree);
}

/* --- from frame to frame --- */

static const double cost_growth =
    1.25; /* relative growth of the number of visited nodes; a new hierarchy costs some tenths of a picture */

/* A fraction of changed boxes that does not influence the choice of the cost model. */
static const double few_changes = 1 / 32.0;

/* The number of boxes that differ; more than there are: a box is empty in one array only. */
static uint32_t changes(const struct box *a, const struct box *b, uint32_t count) {
    enum { BLOCK = 64 };
    uint32_t changed = 0;
    for (uint32_t i = 0; i < count; i++) {
        bool whole = i % BLOCK == 0 && count - i >= BLOCK;
        if (whole && memcmp(&a[i], &b[i], BLOCK * sizeof a[i]) == 0) {
            i += BLOCK - 1;
            continue;
        }
        if (memcmp(&a[i], &b[i], sizeof a[i]) == 0)
            continue;
        if (box_is_empty(&a[i]) != box_is_empty(&b[i]))
            return UINT32_MAX;
        changed++;
    }
    return changed;
}

/* A hierarchy has no leaf for items that were empty. */
static bool refit(struct accel_cache *cache, enum accel_kind requested, const struct box *boxes, uint32_t count) {
    uint32_t changed = cache->accel.kind == ACCEL_BVH ? changes(cache->boxes, boxes, count) : UINT32_MAX;
    if (changed > count ||
        (requested == ACCEL_AUTO && changed > few_changes * count && choose(boxes, count) != ACCEL_BVH))
        return false;
    box_tree_refit(&cache->accel.tree, boxes);
    return box_tree_cost(&cache->accel.tree) <= cost_growth * cache->cost;
}

bool accel_cache_reuse(struct accel_cache *cache, enum accel_kind requested, const struct box *boxes, uint32_t count,
                       struct scene_accel *accel) {
    bool fits = cache->full && cache->requested == requested && cache->count == count &&
                (memcmp(cache->boxes, boxes, count * sizeof *boxes) == 0 || refit(cache, requested, boxes, count));
    if (fits)
        *accel = cache->accel;
    else
        scene_accel_destroy(&cache->accel);
    cache->full = false;
    cache->cost = fits ? cache->cost : 0;
    cache->accel = (struct scene_accel){0};
    return fits;
}

void accel_cache_keep(struct accel_cache *cache, enum accel_kind requested, const struct box *boxes, uint32_t count,
                      struct scene_accel *accel) {
    if (count > cache->capacity || !cache->boxes) {
        mem_free(cache->boxes);
        cache->boxes = mem_alloc((count > 0 ? count : 1) * sizeof *cache->boxes);
        cache->capacity = cache->boxes ? count : 0;
    }
    cache->full = cache->boxes != NULL;
    if (cache->full) {
        memcpy(cache->boxes, boxes, count * sizeof *boxes);
        cache->accel = *accel;
        *accel = (struct scene_accel){0};
    }
    cache->count = count;
    cache->requested = requested;
    if (cache->cost == 0)
        cache->cost = box_tree_cost(&cache->accel.tree);
}

void accel_cache_destroy(struct accel_cache *cache) {
    scene_accel_destroy(&cache->accel);
    mem_free(cache->boxes);
    *cache = (struct accel_cache){0};
}

/* --- cells --- */

static uint32_t step_for(uint64_t count, uint32_t limit) {
    return (uint32_t)((count + limit - 1) / limit);
}

/* Occupied voxels. */
static void visit_voxels(const struct grid *grid, uint32_t limit, scene_accel_visit *visit, void *context) {
    uint64_t count = (uint64_t)grid->cells[0] * grid->cells[1] * grid->cells[2];
    uint32_t step = step_for(count, limit);
    bool go_on = visit(context, &grid->bounds, true, 0);
    for (uint64_t i = 0; i < count && go_on; i += step) {
        uint32_t items = grid->cell_start[i + 1] - grid->cell_start[i];
        struct vec3 at = {(double)(i % grid->cells[0]), (double)(i / grid->cells[0] % grid->cells[1]),
                          (double)(i / grid->cells[0] / grid->cells[1])};
        struct box cell = {vec3_add(grid->bounds.min, vec3_mul(at, grid->cell_size)), {0, 0, 0}};
        cell.max = vec3_add(cell.min, grid->cell_size);
        if (items > 0)
            go_on = visit(context, &cell, false, items / 8.0);
    }
}

/* Inner nodes of the hierarchy, from the root on. */
static void visit_tree(const struct box_tree *tree, uint32_t limit, scene_accel_visit *visit, void *context) {
    uint32_t step = step_for((uint64_t)tree->node_count * BOX_TREE_WIDTH, limit);
    bool go_on = visit(context, &tree->bounds, true, 0);
    for (uint32_t i = 0; i < tree->node_count && go_on; i += step) {
        const struct box_tree_node *node = &tree->nodes[i];
        for (int k = 0; k < BOX_TREE_WIDTH && go_on; k++) {
            if (node->child[k] == BOX_TREE_NONE || (node->child[k] & BOX_TREE_ITEM))
                continue;
            struct box box = {{node->planes[0][0][k], node->planes[1][0][k], node->planes[2][0][k]},
                              {node->planes[0][1][k], node->planes[1][1][k], node->planes[2][1][k]}};
            go_on = visit(context, &box, false, 1 - el_log2(1 + (double)node->child[k]) / 16);
        }
    }
}

/* Occupied leaves; the cell of a node is that of its parent, cut. */
static void visit_halves(const struct kd_tree *tree, uint32_t limit, scene_accel_visit *visit, void *context) {
    struct {
        struct box cell;
        uint32_t node;
    } stack[KD_DEPTH + 2];
    int depth = 0;
    uint32_t visited = 0;
    if (tree->node_count == 0)
        return;
    stack[depth].cell = tree->bounds;
    stack[depth++].node = 0;
    while (depth > 0 && visited < limit) {
        struct box cell = stack[--depth].cell, lower = cell, upper = cell;
        uint32_t number = stack[depth].node;
        const struct kd_node *node = &tree->nodes[number];
        if (node->axis == KD_LEAF) {
            visited += node->count > 0;
            if (node->count > 0 && !visit(context, &cell, false, (double)node->count / 8))
                return;
            continue;
        }
        /* The lower half comes next, since it was pushed last. */
        double *high = node->axis == 0 ? &lower.max.x : node->axis == 1 ? &lower.max.y : &lower.max.z;
        double *low = node->axis == 0 ? &upper.min.x : node->axis == 1 ? &upper.min.y : &upper.min.z;
        *high = *low = node->split;
        stack[depth].cell = upper;
        stack[depth++].node = node->offset;
        stack[depth].cell = lower;
        stack[depth++].node = number + 1;
    }
}

void scene_accel_cells(const struct scene_accel *accel, uint32_t limit, scene_accel_visit *visit, void *context) {
    switch (accel->kind) {
    case ACCEL_GRID:
        visit_voxels(&accel->grid, limit, visit, context);
        return;
    case ACCEL_AUTO:
    case ACCEL_BVH:
        visit_tree(&accel->tree, limit, visit, context);
        return;
    case ACCEL_KDTREE:
        visit_halves(&accel->kd_tree, limit, visit, context);
        return;
    case ACCEL_NONE:
        return;
    }
}
