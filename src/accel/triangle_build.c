/* Wide hierarchies by the surface area heuristic in bins: Ingo Wald, "On fast Construction of SAH-based Bounding Volume
 * Hierarchies", RT 2007; a node's largest child is split until there are eight (Wald, Benthin, Boulos, "Getting Rid of
 * Packets", RT 2008). The cost of a leaf counts blocks of eight triangles, not triangles.
 *
 * Parallel and deterministic: ranges above a size that only the data decides are split one after the other into top
 * nodes, until what is left can be shared out; each job then builds its own nodes and list of leaves, and since the
 * jobs' numbers are known only then, references are moved to their final place while the parts are put together. Blocks
 * are made at the end, when their number is known: no memory beyond the result and the references. */
#include "accel/triangle_build.h"

#include "accel/simd.h"
#include "base/mem.h"

#include <string.h>

enum {
    BINS = 16,
    LEAF_TRIANGLES = WIDTH,
    JOB_REFERENCES = 4096, /* small hierarchies are gathered into jobs of about so many */
    MEDIAN_DEPTH = 20,     /* below this many wide levels ranges are halved: bounds the stack of a search */
};

/* References first .. first + count - 1, their box and the box of their centres (times two). */
struct range {
    simd4 min, max, centre_min, centre_max;
    uint32_t first, count;
};

struct leaf {
    uint32_t first, count;
};

/* A stretch of roots that one worker builds. References inside are relative: to nodes[0], to leaves[0]. */
struct job {
    uint32_t first_root, root_count;
    struct wide_node *nodes;
    struct leaf *leaves;
    uint32_t node_count, node_capacity, leaf_count, leaf_capacity;
    uint32_t node_base, leaf_base;
    bool failed;
};

struct root {
    uint32_t first, count, result, job;
    uint32_t depth;
};

/* What a child of a top node is until everything has its place. */
enum { TOP_NODE = 1 << 30 };

struct builder {
    struct triangle_index *index;
    const struct triangle_set *set;
    struct reference *references;
    struct pool *pool;
    uint32_t job_limit;
    struct wide_node *top;
    struct root *roots;
    struct job *jobs;
    uint32_t top_count, top_capacity, root_count, root_capacity, job_count;
};

static bool reserve(void **array, uint32_t *capacity, uint32_t used, size_t size) {
    if (used < *capacity)
        return true;
    uint32_t larger = *capacity + *capacity / 2 + 32;
    void *grown = mem_resize_array(*array, larger, size);
    if (!grown)
        return false;
    *array = grown;
    *capacity = larger;
    return true;
}

static simd4 reference_min(const struct reference *r) {
    return simd4_three(simd4_load(r->min));
}

static simd4 reference_max(const struct reference *r) {
    return simd4_three(simd4_load(r->max));
}

static void range_clear(struct range *range) {
    range->min = range->centre_min = simd4_all(INFINITY);
    range->max = range->centre_max = simd4_all(-INFINITY);
}

static inline void range_add(struct range *range, simd4 lo, simd4 hi, simd4 centre) {
    range->min = simd4_min(range->min, lo);
    range->max = simd4_max(range->max, hi);
    range->centre_min = simd4_min(range->centre_min, centre);
    range->centre_max = simd4_max(range->centre_max, centre);
}

static void range_measure(const struct reference *references, struct range *range) {
    range_clear(range);
    for (uint32_t i = range->first; i < range->first + range->count; i++) {
        simd4 lo = reference_min(&references[i]), hi = reference_max(&references[i]);
        range_add(range, lo, hi, simd4_add(lo, hi));
    }
}

static float half_area(simd4 lo, simd4 hi) {
    float e[4];
    simd4_store(e, simd4_sub(hi, lo));
    return e[0] * e[1] + e[1] * e[2] + e[2] * e[0];
}

/* Half blocks, so that filling a block is worth something and a few more triangles are not free. */
static float leaf_cost(uint32_t triangles) {
    return (float)((triangles + 3) / 4);
}

struct split {
    int axis; /* -1: nothing separates the centres */
    int32_t last_left;
    float low[4], scale[4];
};

static void bins_of(const struct split *split, simd4 centre, int32_t bin[4]) {
    simd4_store_int(bin, simd4_mul(simd4_sub(centre, simd4_load(split->low)), simd4_load(split->scale)));
}

static void find_split(const struct reference *references, const struct range *range, struct split *split) {
    float extent[4];
    simd4_store(extent, simd4_sub(range->centre_max, range->centre_min));
    simd4_store(split->low, range->centre_min);
    split->axis = -1;
    bool any = false;
    int bins = range->count < 64 ? BINS / 2 : BINS;
    for (int k = 0; k < 3; k++) {
        split->scale[k] = extent[k] > 0 ? (float)bins * 0.999f / extent[k] : 0;
        if (!(split->scale[k] < 0x1p100f))
            split->scale[k] = 0;
        any |= split->scale[k] > 0;
    }
    split->low[3] = split->scale[3] = 0;
    if (!any)
        return;
    simd4 lo[3][BINS], hi[3][BINS];
    uint32_t count[3][BINS] = {{0}};
    for (int k = 0; k < 3; k++)
        for (int b = 0; b < bins; b++) {
            lo[k][b] = simd4_all(INFINITY);
            hi[k][b] = simd4_all(-INFINITY);
        }
    for (uint32_t i = range->first; i < range->first + range->count; i++) {
        simd4 a = reference_min(&references[i]), b = reference_max(&references[i]);
        int32_t bin[4];
        bins_of(split, simd4_add(a, b), bin);
        for (int k = 0; k < 3; k++) {
            lo[k][bin[k]] = simd4_min(lo[k][bin[k]], a);
            hi[k][bin[k]] = simd4_max(hi[k][bin[k]], b);
            count[k][bin[k]]++;
        }
    }
    float best = INFINITY;
    for (int k = 0; k < 3; k++) {
        if (!(split->scale[k] > 0))
            continue;
        float right_cost[BINS];
        simd4 a = simd4_all(INFINITY), b = simd4_all(-INFINITY);
        uint32_t n = 0;
        for (int j = bins - 1; j > 0; j--) {
            a = simd4_min(a, lo[k][j]);
            b = simd4_max(b, hi[k][j]);
            n += count[k][j];
            right_cost[j] = n ? half_area(a, b) * leaf_cost(n) : -1;
        }
        a = simd4_all(INFINITY);
        b = simd4_all(-INFINITY);
        n = 0;
        for (int j = 0; j + 1 < bins; j++) {
            a = simd4_min(a, lo[k][j]);
            b = simd4_max(b, hi[k][j]);
            n += count[k][j];
            if (n == 0 || right_cost[j + 1] < 0)
                continue;
            float cost = half_area(a, b) * leaf_cost(n) + right_cost[j + 1];
            if (cost < best) {
                best = cost;
                split->axis = k;
                split->last_left = j;
            }
        }
    }
}

/* Splits a range in two that are not empty. */
static void split_range(struct reference *references, const struct range *range, bool halve, struct range *left,
                        struct range *right) {
    struct split split = {.axis = -1};
    if (!halve)
        find_split(references, range, &split);
    if (split.axis < 0) {
        left->first = range->first;
        left->count = range->count / 2;
        right->first = range->first + left->count;
        right->count = range->count - left->count;
        range_measure(references, left);
        range_measure(references, right);
        return;
    }
    range_clear(left);
    range_clear(right);
    uint32_t i = range->first, end = range->first + range->count;
    while (i < end) {
        simd4 lo = reference_min(&references[i]), hi = reference_max(&references[i]), centre = simd4_add(lo, hi);
        int32_t bin[4];
        bins_of(&split, centre, bin);
        if (bin[split.axis] <= split.last_left) {
            range_add(left, lo, hi, centre);
            i++;
            continue;
        }
        range_add(right, lo, hi, centre);
        end--;
        struct reference swap = references[i];
        references[i] = references[end];
        references[end] = swap;
    }
    left->first = range->first;
    left->count = i - range->first;
    right->first = i;
    right->count = range->count - left->count;
}

/* Parts a floor, whose triangles have half the surface of the range each, from all that stands on it, if it is much
 * thinner; false: there is none. The surface says that this brings nothing, but rays start on floors, and those that
 * leave them miss a box that is flat. */
static bool split_floor(struct reference *references, const struct range *range, struct range *floor,
                        struct range *rest) {
    float least = half_area(range->min, range->max) / 2;
    uint32_t end = range->first;
    for (uint32_t i = range->first; i < range->first + range->count; i++) {
        if (half_area(reference_min(&references[i]), reference_max(&references[i])) < least)
            continue;
        struct reference swap = references[i];
        references[i] = references[end];
        references[end++] = swap;
    }
    *floor = (struct range){.first = range->first, .count = end - range->first};
    *rest = (struct range){.first = end, .count = range->count - floor->count};
    if (floor->count == 0 || rest->count == 0)
        return false;
    range_measure(references, floor);
    float extent[4], thin[4];
    simd4_store(extent, simd4_sub(range->max, range->min));
    simd4_store(thin, simd4_sub(floor->max, floor->min));
    if (!(thin[0] < extent[0] / 16 || thin[1] < extent[1] / 16 || thin[2] < extent[2] / 16))
        return false;
    range_measure(references, rest);
    return true;
}

/* Splits into at most eight, the one with the largest surface first; none below `limit` references is split. */
static uint32_t split_wide(struct reference *references, const struct range *whole, uint32_t limit, bool halve,
                           struct range part[WIDTH]) {
    float area[WIDTH];
    uint32_t parts = 1;
    part[0] = *whole;
    if (!halve && split_floor(references, whole, &part[0], &part[1]))
        parts = 2;
    else
        part[0] = *whole;
    for (uint32_t j = 0; j < parts; j++)
        area[j] = half_area(part[j].min, part[j].max);
    while (parts < WIDTH) {
        uint32_t largest = WIDTH;
        for (uint32_t j = 0; j < parts; j++)
            if (part[j].count > limit && (largest == WIDTH || area[j] > area[largest]))
                largest = j;
        if (largest == WIDTH)
            break;
        struct range range = part[largest];
        split_range(references, &range, halve, &part[largest], &part[parts]);
        area[largest] = half_area(part[largest].min, part[largest].max);
        area[parts] = half_area(part[parts].min, part[parts].max);
        parts++;
    }
    return parts;
}

/* By the middles of the boxes along the diagonal of each octant, those that hold nothing first. */
static void node_set_order(struct wide_node *node, uint32_t parts) {
    for (uint32_t octant = 0; octant < 8; octant++) {
        float along[WIDTH];
        uint32_t lanes[WIDTH];
        node->order[octant] = 0;
        for (uint32_t j = 0; j < WIDTH; j++) {
            along[j] = j < parts ? 0 : INFINITY;
            for (int k = 0; k < 3; k++) {
                float middle = node->bounds[2 * k][j] + node->bounds[2 * k + 1][j];
                along[j] += octant >> k & 1 ? -middle : middle;
            }
            uint32_t place = j;
            for (; place > 0 && along[lanes[place - 1]] < along[j]; place--)
                lanes[place] = lanes[place - 1];
            lanes[place] = j;
        }
        for (uint32_t j = 0; j < WIDTH; j++)
            node->order[octant] |= lanes[j] << 3 * j;
    }
}

static void node_set_bounds(struct wide_node *node, const struct range *part, uint32_t parts) {
    for (uint32_t j = 0; j < WIDTH; j++) {
        float lo[4] = {1e30f, 1e30f, 1e30f}, hi[4] = {-1e30f, -1e30f, -1e30f};
        if (j < parts) {
            simd4_store(lo, simd4_sub(part[j].min, simd4_all(BOX_GROWTH)));
            simd4_store(hi, simd4_add(part[j].max, simd4_all(BOX_GROWTH)));
        }
        for (int k = 0; k < 3; k++) {
            node->bounds[2 * k][j] = lo[k];
            node->bounds[2 * k + 1][j] = hi[k];
        }
        node->child[j] = REF_EMPTY;
    }
    node_set_order(node, parts);
}

enum { POLL_COUNT = 2000 }; /* references that are split without asking whether to stop */

static bool is_cancelled(const struct builder *builder) {
    return builder->pool && pool_cancelled(builder->pool);
}

/* Relative reference to the hierarchy of a range; marks the job when memory is out. */
static uint32_t build_range(struct builder *builder, struct job *job, const struct range *range, uint32_t depth) {
    if (range->count <= LEAF_TRIANGLES) {
        if (!reserve((void **)&job->leaves, &job->leaf_capacity, job->leaf_count, sizeof *job->leaves)) {
            job->failed = true;
            return REF_EMPTY;
        }
        job->leaves[job->leaf_count] = (struct leaf){range->first, range->count};
        return REF_LEAF | job->leaf_count++;
    }
    if (range->count > POLL_COUNT && is_cancelled(builder))
        job->failed = true; /* told apart from a lack of memory at the end */
    struct range part[WIDTH];
    uint32_t parts = split_wide(builder->references, range, LEAF_TRIANGLES, depth > MEDIAN_DEPTH, part);
    if (!reserve((void **)&job->nodes, &job->node_capacity, job->node_count, sizeof *job->nodes)) {
        job->failed = true;
        return REF_EMPTY;
    }
    uint32_t number = job->node_count++;
    node_set_bounds(&job->nodes[number], part, parts);
    for (uint32_t j = 0; j < parts && !job->failed; j++) {
        uint32_t child = build_range(builder, job, &part[j], depth + 1);
        job->nodes[number].child[j] = child;
    }
    return number;
}

static void run_job(void *context, uint32_t item, int worker) {
    struct builder *builder = context;
    struct job *job = &builder->jobs[item];
    (void)worker;
    for (uint32_t i = job->first_root; i < job->first_root + job->root_count && !job->failed; i++) {
        struct root *root = &builder->roots[i];
        struct range range = {.first = root->first, .count = root->count};
        range_measure(builder->references, &range);
        root->result = build_range(builder, job, &range, root->depth);
    }
}

static bool add_root(struct builder *builder, uint32_t first, uint32_t count, uint32_t depth, uint32_t *result) {
    if (!reserve((void **)&builder->roots, &builder->root_capacity, builder->root_count, sizeof *builder->roots))
        return false;
    builder->roots[builder->root_count] = (struct root){.first = first, .count = count, .depth = depth};
    *result = builder->root_count++;
    return true;
}

/* Top nodes over a range until its parts are small enough for one job each. */
static bool plan_range(struct builder *builder, const struct range *range, uint32_t depth, uint32_t *result) {
    if (range->count <= builder->job_limit)
        return add_root(builder, range->first, range->count, depth, result);
    if (is_cancelled(builder))
        return false;
    struct range part[WIDTH];
    uint32_t parts = split_wide(builder->references, range, LEAF_TRIANGLES, depth > MEDIAN_DEPTH, part);
    if (!reserve((void **)&builder->top, &builder->top_capacity, builder->top_count, sizeof *builder->top))
        return false;
    uint32_t number = builder->top_count++;
    node_set_bounds(&builder->top[number], part, parts);
    for (uint32_t j = 0; j < parts; j++) {
        uint32_t child;
        if (!plan_range(builder, &part[j], depth + 1, &child))
            return false;
        builder->top[number].child[j] = child;
    }
    *result = TOP_NODE | number;
    return true;
}

static bool make_jobs(struct builder *builder) {
    builder->jobs = mem_alloc_zero((size_t)builder->root_count + 1, sizeof *builder->jobs);
    if (!builder->jobs)
        return false;
    uint64_t gathered = UINT64_MAX / 2;
    for (uint32_t i = 0; i < builder->root_count; i++) {
        if (gathered + builder->roots[i].count > JOB_REFERENCES) {
            builder->jobs[builder->job_count++].first_root = i;
            gathered = 0;
        }
        builder->roots[i].job = builder->job_count - 1;
        builder->jobs[builder->job_count - 1].root_count++;
        gathered += builder->roots[i].count;
    }
    return true;
}

static bool run(struct builder *builder, uint32_t count, pool_function *function) {
    if (builder->pool)
        return pool_run(builder->pool, count, function, builder);
    for (uint32_t i = 0; i < count; i++)
        function(builder, i, 0);
    return true;
}

static bool is_used(const struct wide_node *node, uint32_t lane) {
    return node->bounds[0][lane] <= node->bounds[1][lane];
}

static uint32_t moved(const struct job *job, uint32_t reference) {
    return reference & REF_LEAF ? reference + job->leaf_base : reference + job->node_base;
}

static uint32_t resolve(const struct builder *builder, uint32_t tag) {
    if (tag & TOP_NODE)
        return (tag & ~(uint32_t)TOP_NODE) + 1;
    const struct root *root = &builder->roots[tag];
    return moved(&builder->jobs[root->job], root->result);
}

static void set_lane(const struct triangle_index *index, const struct triangle_set *set, uint32_t triangle,
                     struct triangle_block *block, uint32_t lane) {
    const uint32_t *corner = set->corners[triangle];
    double p[3][3];
    const double *centre = index->centre;
    for (int j = 0; j < 3; j++)
        for (int k = 0; k < 3; k++)
            p[j][k] = (set->vertices[corner[j]][k] - centre[k]) * index->scale;
    for (int k = 0; k < 3; k++) {
        block->corner[k][lane] = (float)p[0][k];
        block->edge1[k][lane] = (float)(p[1][k] - p[0][k]);
        block->edge2[k][lane] = (float)(p[2][k] - p[0][k]);
    }
    block->ids[lane] = triangle;
    for (int j = 0; j < 3; j++)
        block->vertices[j][lane] = corner[j];
}

static void set_unused_lane(struct triangle_block *block, uint32_t lane) {
    for (int k = 0; k < 3; k++) {
        block->corner[k][lane] = UNUSED_AT;
        block->edge1[k][lane] = k == 0 ? 0x1p-4f : 0;
        block->edge2[k][lane] = k == 1 ? 0x1p-4f : 0;
    }
    block->ids[lane] = 0;
    for (int j = 0; j < 3; j++)
        block->vertices[j][lane] = 0;
}

/* Moves a job's nodes into the index and fills its blocks. */
static void finish_job(void *context, uint32_t item, int worker) {
    struct builder *builder = context;
    struct triangle_index *index = builder->index;
    struct job *job = &builder->jobs[item];
    (void)worker;
    for (uint32_t i = 0; i < job->node_count; i++) {
        struct wide_node *node = &index->nodes[job->node_base + i];
        *node = job->nodes[i];
        for (uint32_t j = 0; j < WIDTH; j++)
            if (is_used(node, j))
                node->child[j] = moved(job, node->child[j]);
    }
    for (uint32_t i = 0; i < job->leaf_count; i++) {
        struct leaf leaf = job->leaves[i];
        struct triangle_block *block = &index->blocks[job->leaf_base + i];
        for (uint32_t lane = 0; lane < WIDTH; lane++)
            if (lane < leaf.count)
                set_lane(index, builder->set, builder->references[leaf.first + lane].triangle, block, lane);
            else
                set_unused_lane(block, lane);
    }
}

/* Nodes and blocks in one table: a search jumps about in both, and a table on large pages, where the system has them,
 * has the nodes on them however few they are. */
static bool alloc_tables(struct triangle_index *index, uint32_t nodes, uint32_t blocks) {
    size_t node_bytes = nodes * sizeof *index->nodes, size = node_bytes + blocks * sizeof *index->blocks;
    char *table = mem_alloc_aligned(size < MEM_LARGE_PAGE ? 64 : MEM_LARGE_PAGE, size);
    if (!table)
        return false;
    index->nodes = (struct wide_node *)(void *)table;
    index->blocks = (struct triangle_block *)(void *)(table + node_bytes);
    index->node_count = nodes;
    index->block_count = blocks;
    return true;
}

static bool assemble(struct builder *builder) {
    struct triangle_index *index = builder->index;
    uint32_t nodes = 1 + builder->top_count, blocks = 0;
    for (uint32_t i = 0; i < builder->job_count; i++) {
        struct job *job = &builder->jobs[i];
        if (job->failed)
            return false;
        job->node_base = nodes;
        job->leaf_base = blocks;
        nodes += job->node_count;
        blocks += job->leaf_count;
    }
    if (!alloc_tables(index, nodes, blocks))
        return false;
    memset(&index->nodes[0], 0, sizeof *index->nodes);
    for (uint32_t i = 0; i < builder->top_count; i++) {
        struct wide_node *node = &builder->top[i];
        for (uint32_t j = 0; j < WIDTH && is_used(node, j); j++)
            node->child[j] = resolve(builder, node->child[j]);
        index->nodes[1 + i] = *node;
    }
    return true;
}

static bool plan(struct builder *builder, struct hierarchy *hierarchies, uint32_t count) {
    uint64_t total = 0;
    for (uint32_t i = 0; i < count; i++)
        total += hierarchies[i].count;
    uint64_t share = total / 64;
    builder->job_limit = share < JOB_REFERENCES ? JOB_REFERENCES : (uint32_t)share;
    for (uint32_t i = 0; i < count; i++) {
        struct hierarchy *h = &hierarchies[i];
        if (h->count == 0)
            continue;
        if (h->count <= builder->job_limit) {
            if (!add_root(builder, h->first, h->count, 0, &h->result))
                return false;
            continue;
        }
        struct range range = {.first = h->first, .count = h->count};
        range_measure(builder->references, &range);
        if (!plan_range(builder, &range, 0, &h->result))
            return false;
    }
    return make_jobs(builder);
}

bool hierarchies_build(struct triangle_index *index, const struct triangle_set *set, struct reference *references,
                       struct hierarchy *hierarchies, uint32_t count, struct pool *pool, struct error *error) {
    struct builder builder = {.index = index, .set = set, .references = references, .pool = pool};
    bool enough = plan(&builder, hierarchies, count), complete = true;
    if (enough)
        complete = run(&builder, builder.job_count, run_job);
    if (enough && complete)
        enough = assemble(&builder);
    if (enough && complete)
        complete = run(&builder, builder.job_count, finish_job);
    for (uint32_t i = 0; i < count && enough && complete; i++)
        hierarchies[i].result = hierarchies[i].count ? resolve(&builder, hierarchies[i].result) : REF_EMPTY;
    for (uint32_t i = 0; i < builder.job_count; i++) {
        mem_free(builder.jobs[i].nodes);
        mem_free(builder.jobs[i].leaves);
    }
    mem_free(builder.top);
    mem_free(builder.roots);
    mem_free(builder.jobs);
    if (!enough && !is_cancelled(&builder))
        return error_no_memory(error, "the index of a mesh");
    return (enough && complete) || error_set(error, ERROR_CANCELLED, "cancelled while indexing a mesh");
}
