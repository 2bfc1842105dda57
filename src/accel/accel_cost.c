/* The cost model of the grid of voxels ("frame"). Two kinds of rays represent all: random lines through the frame, of
 * which the share S(voxel) / S(frame) visits a voxel (S: surface; Cauchy and Crofton, as in the surface area heuristic
 * of MacDonald and Booth, "Heuristics for Ray Tracing Using Space Subdivision", 1990), and lines to a random item,
 * since cameras look at objects and light comes from them: for those a voxel counts in proportion to its number of
 * items. The end of a ray does not affect the choice: steps and nodes end with it.
 *
 * A hierarchy is modelled as the occupied voxels of all levels, 2, 4, 8 ... along the longest axis; from one level to
 * the next it needs log(growth of their number) / log(children) levels of nodes. Lists in voxels have no start cost,
 * and in clouds of similar items a step, about 0.35 visits of a node, saves more than it costs; but one crowded voxel
 * (a cluster on a wide floor) costs every ray that visits it a test of all its items. */
#include "accel/accel_cost.h"

#include "base/mem.h"
#include "math/elementary.h"

/* In visits of a node; measured (docs/lab/performance.md). */
#define STEP_COST 0.35 /* one voxel on */
#define LIST_COST 0.3  /* an entry of a list: its box */
#define OVERLAP 1.5    /* factor for nodes that overlap or are not full */
#define START_COST 1.2 /* of a hierarchy in a voxel */
/* Once per ray that traverses voxels over a mesh: it is moved to the frame and its error bounds are larger (2.5), and
 * it cannot be part of a packet (a third of the rays, at half the cost: 1.5). */
#define TRAVERSAL_COST 4.0

enum { BIG_ITEM = 64 /* voxels */, SAMPLE_LIMIT = 4 /* samples to an occupied voxel */ };

static double half_surface(struct vec3 size) {
    return size.x * size.y + size.y * size.z + size.z * size.x;
}

static void level_shape(struct cost_level *level, struct vec3 size, uint32_t along) {
    double longest = vec3_max_abs(size);
    for (int k = 0; k < 3; k++) {
        double cells = floor(vec3_get(size, k) / longest * along + 0.5);
        level->cells[k] = cells >= 1 ? (uint32_t)cells : 1;
    }
}

/* The voxels that a box touches along one axis. */
static uint32_t cells_along(const struct cost_level *level, const struct box *bounds, const struct box *box, int axis,
                            uint32_t *first) {
    double scale = level->cells[axis] / (vec3_get(bounds->max, axis) - vec3_get(bounds->min, axis));
    double low = (vec3_get(box->min, axis) - vec3_get(bounds->min, axis)) * scale;
    double high = (vec3_get(box->max, axis) - vec3_get(bounds->min, axis)) * scale;
    uint32_t last = level->cells[axis] - 1;
    *first = low >= last ? last : low > 0 ? (uint32_t)low : 0;
    uint32_t end = high >= last ? last : high > 0 ? (uint32_t)high : 0;
    return end >= *first ? end - *first + 1 : 1;
}

struct sample {
    const struct box *boxes;
    uint32_t count;
    double each; /* items that one sample represents */
};

/* False: the sample is too small for the level. */
static bool count_level(struct cost_level *level, const struct box *bounds, const struct sample *sample,
                        uint32_t *counts) {
    const uint32_t *cells = level->cells;
    size_t all = (size_t)cells[0] * cells[1] * cells[2];
    double entries = 0, squares = 0, occupied = 0, listed = 0;
    for (uint32_t i = 0; i < sample->count; i++) {
        uint32_t first[3], number[3];
        for (int k = 0; k < 3; k++)
            number[k] = cells_along(level, bounds, &sample->boxes[i], k, &first[k]);
        double touched = (double)number[0] * number[1] * number[2];
        listed += touched;
        if (touched > BIG_ITEM)
            continue;
        for (uint32_t z = first[2]; z < first[2] + number[2]; z++)
            for (uint32_t y = first[1]; y < first[1] + number[1]; y++)
                for (uint32_t x = first[0]; x < first[0] + number[0]; x++)
                    counts[((size_t)z * cells[1] + y) * cells[0] + x]++;
    }
    for (size_t v = 0; v < all; v++) {
        occupied += counts[v] > 0;
        entries += counts[v];
        squares += (double)counts[v] * counts[v];
    }
    struct vec3 size = vec3_sub(bounds->max, bounds->min);
    struct vec3 voxel = {size.x / cells[0], size.y / cells[1], size.z / cells[2]};
    double share = half_surface(voxel) / half_surface(size);
    level->filled = occupied;
    level->visited = (double)all * share;
    level->occupied = occupied * share;
    level->listed = listed * sample->each * share;
    /* One of them is the item itself; the others represent the rest. */
    level->neighbours = entries > 0 ? 1 + (squares / entries - 1) * sample->each : 0;
    return sample->each == 1 || entries >= SAMPLE_LIMIT * occupied;
}

static bool is_usable(const struct box *box) {
    return !box_is_empty(box) && vec3_finite(box->min) && vec3_finite(box->max);
}

void cost_sample_take(struct cost_sample *cost_sample, const struct cost_items *items, uint32_t samples,
                      uint32_t levels) {
    const struct box *bounds = items->bounds;
    uint32_t count = items->count;
    struct vec3 size = vec3_sub(bounds->max, bounds->min);
    *cost_sample = (struct cost_sample){.level_count = 1, .items = count};
    cost_sample->levels[0] = (struct cost_level){
        .cells = {1, 1, 1}, .filled = 1, .visited = 1, .occupied = 1, .listed = count, .neighbours = count};
    double surface = half_surface(size), longest = vec3_max_abs(size);
    if (count == 0 || !(surface > 0x1p-900) || !(surface < 0x1p900) || !(longest > 0))
        return;
    uint32_t stride = count > samples ? count / samples : 1, max = 2, kept = 0;
    while (max < levels && (double)(UINT64_C(1) << 3 * (max - 1)) < count)
        max++;
    max = max < MESSAGE_LEVELS ? max : MESSAGE_LEVELS;
    size_t largest = (size_t)1 << 3 * (max - 1);
    struct box *boxes = mem_alloc(((size_t)count / stride + 1) * sizeof *boxes);
    uint32_t *counts = mem_alloc(largest * sizeof *counts);
    for (uint32_t i = 0; boxes && i < count; i += stride) {
        boxes[kept] = items->box_of(items->context, i);
        kept += is_usable(&boxes[kept]);
    }
    struct sample sample = {boxes, kept, stride};
    for (uint32_t l = 1; boxes && counts && l < max; l++) {
        struct cost_level *level = &cost_sample->levels[l];
        level_shape(level, size, UINT32_C(1) << l);
        for (size_t v = 0; v < largest; v++)
            counts[v] = 0;
        /* At finer levels a sample would find too few occupied voxels. */
        if (!count_level(level, bounds, &sample, counts))
            break;
        cost_sample->level_count = l + 1;
    }
    mem_free(boxes);
    mem_free(counts);
}

/* Levels of a hierarchy with this many children per node that divide the voxels of level - 1 into those of level. */
static double growth(const struct cost_sample *cost_sample, uint32_t level, uint32_t children) {
    double before = cost_sample->levels[level - 1].filled, after = cost_sample->levels[level].filled;
    return after > before ? el_log(after / before) / el_log(children) : 0;
}

struct accel_scene_cost accel_lists_or_hierarchy(const struct cost_sample *cost_sample) {
    /* The level with three voxels per item, which may be finer than the levels of the cost sample. */
    double wanted = el_log(3 * cost_sample->items) / el_log(8);
    uint32_t last = cost_sample->level_count - 1, level = wanted < last ? (uint32_t)(wanted + 0.5) : last;
    double beyond = wanted > level ? wanted - level : 0, finer = el_exp2(beyond);
    const struct cost_level *at = &cost_sample->levels[level];
    double steps = STEP_COST * at->visited * finer, nodes = at->occupied;
    for (uint32_t l = 1; l <= level; l++)
        nodes += OVERLAP * growth(cost_sample, l, 4) * cost_sample->levels[l - 1].occupied;
    double crowd = at->neighbours / (finer * finer * finer), depth = el_log(cost_sample->items) / el_log(4);
    double lists = 2 * steps + LIST_COST * (at->listed / (finer * finer) + (crowd > 1 ? crowd : 1));
    return (struct accel_scene_cost){.lists = lists / 2, .hierarchy = (nodes + depth) / 2};
}

/* Both kinds of rays; a ray to an item passes all levels above it. */
struct accel_mesh_cost accel_over_mesh(const struct cost_sample *cost_sample) {
    struct accel_mesh_cost frame = {.level = 0};
    uint32_t last = cost_sample->level_count - 1;
    for (uint32_t l = 0; l <= last; l++) {
        const struct cost_level *at = &cost_sample->levels[l];
        double traversal = l > 0 ? TRAVERSAL_COST + STEP_COST * at->visited : 0, starts = START_COST * at->occupied;
        double across = 0, depth = 0;
        for (uint32_t below = l + 1; below <= last; below++) {
            double nodes = growth(cost_sample, below, 8);
            across += OVERLAP * nodes * cost_sample->levels[below - 1].occupied;
            depth += nodes;
        }
        frame.costs[l] = traversal + starts + (across + depth) / 2;
        if (frame.costs[l] < frame.costs[frame.level])
            frame.level = l;
    }
    return frame;
}
