/* Hierarchies of eight children per node (Wald, Benthin, Boulos, "Getting Rid of Packets", RT 2008), cut from binary
 * ones (triangle_tree_internal.h).
 *
 * Parallel and deterministic: ranges above a size that depends only on the data are partitioned by all threads
 * together, round by round, until the rest can be distributed; the parts are built by jobs, joined, improved by
 * reinsertion on one thread, weighed bottom-up by jobs and then at the top, and written by jobs to offsets from a
 * prefix sum. The binary hierarchy is a third as large as the result, and is freed together with the references. */
#include "accel/triangle_build_internal.h"

#include "accel/triangle_tree_internal.h"
#include "base/mem.h"

#include <string.h>

enum { JOB_REFERENCES = 4096 /* small pieces are collected into jobs of about this many */ };

/* A unit of work for one worker: first a range without a branch, later a branch. */
struct piece {
    struct range range;
    uint32_t depth;
    uint32_t branch; /* while it is built, in its job's own tree */
    uint32_t count;  /* its references */
    uint32_t node_count, block_count, node_base, block_base;
};

struct pieces {
    struct piece *items;
    uint32_t count, capacity;
};

/* Consecutive pieces. */
struct job {
    uint32_t first, count;
    struct tree tree;
    bool failed;
};

struct builder {
    struct triangle_index *index;
    const struct triangle_set *set;
    struct reference *references;
    struct pool *pool;
    uint32_t job_limit;
    struct tree tree;
    struct pieces pieces; /* of the stage under way */
    struct open_branch *open;
    struct job *jobs;
    uint32_t job_count;
    struct lane_costs *costs; /* of each piece */
    struct top_node *top;     /* nodes above the pieces */
    uint32_t top_count, top_capacity;
};

/* A node whose children may be pieces. */
struct top_node {
    uint32_t branch;
    uint32_t child[WIDTH]; /* a piece, or the number of a top node */
};

/* Whether a number is a piece and not a node above them. */
#define PIECE (UINT32_C(1) << 31)

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

static bool is_cancelled(const struct builder *builder) {
    return builder->pool && pool_cancelled(builder->pool);
}

/* --- pieces and jobs --- */

static struct piece *add_piece(struct builder *builder, uint32_t references) {
    struct pieces *pieces = &builder->pieces;
    if (!reserve((void **)&pieces->items, &pieces->capacity, pieces->count, sizeof *pieces->items))
        return NULL;
    struct piece *piece = &pieces->items[pieces->count++];
    *piece = (struct piece){.count = references};
    return piece;
}

/* Collects the pieces into jobs. */
static bool make_jobs(struct builder *builder) {
    const struct pieces *pieces = &builder->pieces;
    uint64_t gathered = UINT64_MAX / 2;
    builder->job_count = 0;
    builder->jobs = mem_alloc_zero((size_t)pieces->count + 1, sizeof *builder->jobs);
    for (uint32_t i = 0; builder->jobs && i < pieces->count; i++) {
        if (gathered + pieces->items[i].count > JOB_REFERENCES) {
            builder->jobs[builder->job_count++].first = i;
            gathered = 0;
        }
        builder->jobs[builder->job_count - 1].count++;
        gathered += pieces->items[i].count;
    }
    return builder->jobs != NULL;
}

static void drop_jobs(struct builder *builder) {
    for (uint32_t i = 0; builder->jobs && i < builder->job_count; i++)
        mem_free(builder->jobs[i].tree.branches);
    mem_free(builder->jobs);
    builder->jobs = NULL;
    builder->job_count = 0;
}

/* False when it was cancelled or a job has failed. */
static bool run_jobs(struct builder *builder, pool_function *function) {
    bool complete = true;
    if (builder->pool)
        complete = pool_run(builder->pool, builder->job_count, function, builder);
    else
        for (uint32_t i = 0; i < builder->job_count; i++)
            function(builder, i, 0);
    for (uint32_t i = 0; i < builder->job_count; i++)
        complete = complete && !builder->jobs[i].failed;
    return complete;
}

/* --- the binary hierarchies --- */

/* A branch above the pieces that is not partitioned yet. */
struct open_branch {
    struct range range, part[2];
    uint32_t branch, depth;
};

struct front {
    struct open_branch *items;
    uint32_t count, capacity;
};

/* Turns a range into a piece, or into a branch of the front. */
static bool store_range(struct builder *builder, struct front *front, const struct range *range, uint32_t depth,
                        uint32_t parent, uint32_t *result) {
    if (range->count <= builder->job_limit) {
        struct piece *piece = add_piece(builder, range->count);
        if (!piece)
            return false;
        piece->range = *range;
        piece->depth = depth;
        *result = PIECE | (builder->pieces.count - 1);
        return true;
    }
    if (!reserve((void **)&front->items, &front->capacity, front->count, sizeof *front->items) ||
        !tree_add(&builder->tree, range, parent, result))
        return false;
    front->items[front->count++] = (struct open_branch){.range = *range, .branch = *result, .depth = depth};
    return true;
}

static void part_open(void *context, uint32_t item, int worker) {
    const struct builder *builder = context;
    struct open_branch *open = &builder->open[item];
    (void)worker;
    tree_part(builder->references, &open->range, open->depth, open->part);
}

/* Splits all branches of a front together; parts that are still too large form the next front. */
static bool part_front(struct builder *builder, const struct front *front, struct front *next) {
    bool go_on = true;
    builder->open = front->items;
    if (builder->pool)
        go_on = pool_run(builder->pool, front->count, part_open, builder);
    for (uint32_t i = 0; !builder->pool && i < front->count; i++)
        part_open(builder, i, 0);
    next->count = 0;
    for (uint32_t i = 0; go_on && i < front->count; i++) {
        const struct open_branch *open = &front->items[i];
        uint32_t child[2];
        for (int k = 0; k < 2; k++)
            go_on = go_on && store_range(builder, next, &open->part[k], open->depth + 1, open->branch, &child[k]);
        if (go_on)
            memcpy(builder->tree.branches[open->branch].child, child, sizeof child);
    }
    return go_on;
}

/* Branches until all their parts are small enough for one job each. */
static bool plan(struct builder *builder, struct hierarchy *hierarchies, uint32_t count) {
    struct front fronts[2] = {{0}};
    uint64_t total = 0;
    for (uint32_t i = 0; i < count; i++)
        total += hierarchies[i].count;
    uint64_t share = total / 64;
    builder->job_limit = share < JOB_REFERENCES ? JOB_REFERENCES : (uint32_t)share;
    bool go_on = true;
    for (uint32_t i = 0; go_on && i < count; i++) {
        struct hierarchy *h = &hierarchies[i];
        struct range range = {.first = h->first, .count = h->count};
        if (h->count == 0)
            continue;
        if (h->count > builder->job_limit) /* else its job does */
            range_measure(builder->references, &range);
        go_on = store_range(builder, &fronts[0], &range, 0, NO_BRANCH, &h->result);
    }
    for (int turn = 0; go_on && fronts[turn].count > 0; turn = !turn)
        go_on = !is_cancelled(builder) && part_front(builder, &fronts[turn], &fronts[!turn]);
    mem_free(fronts[0].items);
    mem_free(fronts[1].items);
    return go_on;
}

static void build_job(void *context, uint32_t item, int worker) {
    struct builder *builder = context;
    struct job *job = &builder->jobs[item];
    (void)worker;
    for (uint32_t i = job->first; i < job->first + job->count && !job->failed; i++) {
        struct piece *piece = &builder->pieces.items[i];
        if (piece->depth == 0) /* a whole hierarchy; the others were measured when they were partitioned */
            range_measure(builder->references, &piece->range);
        job->failed =
            !tree_build(&job->tree, builder->references, &piece->range, piece->depth, builder->pool, &piece->branch);
    }
}

/* Appends the trees of all jobs after the top. */
static bool join_trees(struct builder *builder, struct hierarchy *hierarchies, uint32_t count) {
    struct tree *tree = &builder->tree;
    uint32_t top = tree->count;
    uint64_t all = top;
    for (uint32_t i = 0; i < builder->job_count; i++)
        all += builder->jobs[i].tree.count;
    struct branch *grown = mem_resize_array(tree->branches, all + 1, sizeof *grown);
    if (!grown)
        return false;
    tree->branches = grown;
    tree->capacity = (uint32_t)all;
    for (uint32_t i = 0; i < builder->job_count; i++) {
        struct job *job = &builder->jobs[i];
        uint32_t base = tree->count;
        /* Numbers inside of the tree of a job are shifted behind what is there. */
        for (uint32_t j = 0; j < job->tree.count; j++) {
            struct branch *branch = &tree->branches[base + j];
            *branch = job->tree.branches[j];
            branch->parent += branch->parent == NO_BRANCH ? 0 : base;
            for (int k = 0; k < 2; k++)
                branch->child[k] += base;
        }
        tree->count += job->tree.count;
        for (uint32_t j = job->first; j < job->first + job->count; j++)
            builder->pieces.items[j].branch += base;
    }
    /* Children come after their parents, so the heights are known from the end. */
    for (uint32_t i = top; i-- > 0;) {
        struct branch *branch = &tree->branches[i];
        for (int k = 0; k < 2; k++) {
            if (branch->child[k] & PIECE)
                branch->child[k] = builder->pieces.items[branch->child[k] & ~PIECE].branch;
            tree->branches[branch->child[k]].parent = i;
        }
        branch->height = branch_height(&tree->branches[branch->child[0]], &tree->branches[branch->child[1]]);
    }
    for (uint32_t i = 0; i < count; i++)
        if (hierarchies[i].count > 0 && hierarchies[i].result & PIECE)
            hierarchies[i].result = builder->pieces.items[hierarchies[i].result & ~PIECE].branch;
    return true;
}

/* --- which branches become nodes --- */

/* Branches of at most job_limit references become pieces. */
static bool cut_pieces(struct builder *builder, uint32_t number) {
    struct branch *branch = &builder->tree.branches[number];
    if (branch->height == 0)
        return true;
    if (branch->count > builder->job_limit)
        return cut_pieces(builder, branch->child[0]) && cut_pieces(builder, branch->child[1]);
    struct piece *piece = add_piece(builder, branch->count);
    if (!piece)
        return false;
    piece->branch = number;
    return true;
}

static void weigh_job(void *context, uint32_t item, int worker) {
    struct builder *builder = context;
    const struct job *job = &builder->jobs[item];
    (void)worker;
    for (uint32_t i = job->first; i < job->first + job->count; i++) {
        uint32_t number = builder->pieces.items[i].branch;
        builder->costs[i] = tree_weigh(&builder->tree, number, 0, NULL);
        builder->tree.branches[number].first = i;
    }
}

static bool weigh(struct builder *builder, const struct hierarchy *hierarchies, uint32_t count) {
    builder->pieces.count = 0;
    for (uint32_t i = 0; i < count; i++)
        if (hierarchies[i].count > 0 && !cut_pieces(builder, hierarchies[i].result))
            return false;
    builder->costs = mem_alloc(((size_t)builder->pieces.count + 1) * sizeof *builder->costs);
    if (!builder->costs || !make_jobs(builder) || !run_jobs(builder, weigh_job))
        return false;
    drop_jobs(builder);
    for (uint32_t i = 0; i < count; i++)
        if (hierarchies[i].count > 0)
            (void)tree_weigh(&builder->tree, hierarchies[i].result, builder->job_limit, builder->costs);
    return true;
}

/* --- what is made --- */

static bool is_node(const struct branch *branch) {
    return branch->height > 0 && !branch->is_block;
}

/* Creates the nodes above the pieces: *result is the reference for branch `number`, a piece or the number of a top
 * node. */
static bool store_top(struct builder *builder, uint32_t number, uint32_t *result) {
    const struct branch *branch = &builder->tree.branches[number];
    if (branch->count <= builder->job_limit || !is_node(branch)) {
        struct piece *piece = add_piece(builder, branch->count);
        if (!piece)
            return false;
        piece->branch = number;
        *result = PIECE | (builder->pieces.count - 1);
        return true;
    }
    if (!reserve((void **)&builder->top, &builder->top_capacity, builder->top_count, sizeof *builder->top))
        return false;
    uint32_t slot = builder->top_count++, children[WIDTH], count = tree_children(&builder->tree, number, children);
    builder->top[slot] = (struct top_node){.branch = number};
    for (uint32_t i = 0; i < count; i++) {
        uint32_t child;
        if (!store_top(builder, children[i], &child))
            return false;
        builder->top[slot].child[i] = child;
    }
    *result = slot;
    return true;
}

/* Small leaves of one node share blocks: block_of[i], of the node's own, for each child that is a leaf. A ray that
 * meets one of them tests triangles of the others too, which changes no result. Returns the number of blocks. */
static uint32_t share_blocks(const struct tree *tree, const uint32_t *children, uint32_t count,
                             uint32_t block_of[WIDTH]) {
    uint32_t used[WIDTH] = {0}, blocks = 0;
    for (uint32_t i = 0; i < count; i++) {
        const struct branch *branch = &tree->branches[children[i]];
        if (is_node(branch))
            continue;
        uint32_t j = 0;
        while (used[j] + branch->count > WIDTH)
            j++;
        used[j] += branch->count;
        block_of[i] = j;
        blocks = j < blocks ? blocks : j + 1;
    }
    return blocks;
}

static void count_parts(const struct tree *tree, uint32_t number, struct piece *piece) {
    if (!is_node(&tree->branches[number])) {
        piece->block_count++;
        return;
    }
    uint32_t children[WIDTH], block_of[WIDTH], count = tree_children(tree, number, children);
    piece->node_count++;
    piece->block_count += share_blocks(tree, children, count, block_of);
    for (uint32_t i = 0; i < count; i++)
        if (is_node(&tree->branches[children[i]]))
            count_parts(tree, children[i], piece);
}

static void count_job(void *context, uint32_t item, int worker) {
    struct builder *builder = context;
    const struct job *job = &builder->jobs[item];
    (void)worker;
    for (uint32_t i = job->first; i < job->first + job->count; i++)
        count_parts(&builder->tree, builder->pieces.items[i].branch, &builder->pieces.items[i]);
}

/* Half the surface of a child's box. */
static float child_area(const struct wide_node *node, uint32_t j) {
    float e[3];
    for (int k = 0; k < 3; k++)
        e[k] = node->bounds[2 * k + 1][j] - node->bounds[2 * k][j];
    return e[0] * e[1] + e[1] * e[2] + e[2] * e[0];
}

/* By the centres of the boxes along the diagonal of each octant; empty lanes come first, then a box with more than half
 * of the surface of all (a floor): objects in front of it or in it are hit first and mostly end the ray. */
static void node_set_order(struct wide_node *node, uint32_t parts, float area) {
    for (uint32_t octant = 0; octant < 8; octant++) {
        float along[WIDTH];
        uint32_t lanes[WIDTH];
        node->order[octant] = 0;
        for (uint32_t j = 0; j < WIDTH; j++) {
            along[j] = j >= parts ? INFINITY : child_area(node, j) > area / 2 ? 1e30f : 0;
            for (int k = 0; k < 3; k++) {
                float middle = node->bounds[2 * k][j] + node->bounds[2 * k + 1][j];
                along[j] += octant >> k & 1 ? -middle : middle;
            }
            uint32_t slot = j;
            for (; slot > 0 && along[lanes[slot - 1]] < along[j]; slot--)
                lanes[slot] = lanes[slot - 1];
            lanes[slot] = j;
        }
        for (uint32_t j = 0; j < WIDTH; j++)
            node->order[octant] |= lanes[j] << 3 * j;
    }
}

static void node_set(struct wide_node *node, const struct tree *tree, uint32_t number, const uint32_t *children,
                     uint32_t count) {
    for (uint32_t j = 0; j < WIDTH; j++) {
        const struct branch *branch = j < count ? &tree->branches[children[j]] : NULL;
        for (int k = 0; k < 3; k++) {
            node->bounds[2 * k][j] = branch ? branch->min[k] - BOX_GROWTH : 1e30f;
            node->bounds[2 * k + 1][j] = branch ? branch->max[k] + BOX_GROWTH : -1e30f;
        }
        node->child[j] = REF_EMPTY;
    }
    node_set_order(node, count, tree->branches[number].area);
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

static void set_unused_lanes(struct triangle_block *block, uint32_t first) {
    for (uint32_t lane = first; lane < WIDTH; lane++) {
        for (int k = 0; k < 3; k++) {
            block->corner[k][lane] = UNUSED_AT;
            block->edge1[k][lane] = k == 0 ? 0x1p-4f : 0;
            block->edge2[k][lane] = k == 1 ? 0x1p-4f : 0;
        }
        block->ids[lane] = 0;
        for (int j = 0; j < 3; j++)
            block->vertices[j][lane] = 0;
    }
}

/* Nodes and blocks are in one table: a search accesses both at random, and with large pages, if the system has them,
 * even a few nodes are on large pages. */
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

/* The triangles below a branch into the lanes of a block from `lane` on; the next lane. */
static uint32_t fill_lanes(const struct builder *builder, uint32_t number, struct triangle_block *block,
                           uint32_t lane) {
    const struct branch *branch = &builder->tree.branches[number];
    if (branch->height > 0) {
        lane = fill_lanes(builder, branch->child[0], block, lane);
        return fill_lanes(builder, branch->child[1], block, lane);
    }
    for (uint32_t i = 0; i < branch->count; i++)
        set_lane(builder->index, builder->set, builder->references[branch->first + i].triangle, block, lane++);
    return lane;
}

/* Writes the nodes and blocks below a branch after those that its piece has written so far; returns the reference. */
static uint32_t write_branch(const struct builder *builder, struct piece *piece, uint32_t number) {
    struct triangle_index *index = builder->index;
    const struct tree *tree = &builder->tree;
    uint32_t base = piece->block_base + piece->block_count, used[WIDTH] = {0};
    if (!is_node(&tree->branches[number])) {
        piece->block_count++;
        used[0] = fill_lanes(builder, number, &index->blocks[base], 0);
        set_unused_lanes(&index->blocks[base], used[0]);
        return REF_LEAF | base;
    }
    uint32_t children[WIDTH], block_of[WIDTH], count = tree_children(tree, number, children);
    uint32_t slot = piece->node_base + piece->node_count++, blocks = share_blocks(tree, children, count, block_of);
    struct wide_node *node = &index->nodes[slot];
    piece->block_count += blocks;
    node_set(node, tree, number, children, count);
    for (uint32_t i = 0; i < count; i++) {
        if (is_node(&tree->branches[children[i]])) {
            node->child[i] = write_branch(builder, piece, children[i]);
            continue;
        }
        uint32_t j = block_of[i];
        used[j] = fill_lanes(builder, children[i], &index->blocks[base + j], used[j]);
        node->child[i] = REF_LEAF | (base + j);
    }
    for (uint32_t j = 0; j < blocks; j++)
        set_unused_lanes(&index->blocks[base + j], used[j]);
    return slot;
}

static void write_job(void *context, uint32_t item, int worker) {
    struct builder *builder = context;
    const struct job *job = &builder->jobs[item];
    (void)worker;
    for (uint32_t i = job->first; i < job->first + job->count; i++) {
        struct piece *piece = &builder->pieces.items[i];
        piece->node_count = piece->block_count = 0; /* counted once more */
        (void)write_branch(builder, piece, piece->branch);
    }
}

/* The final reference to a piece or a top node. */
static uint32_t reference_to(const struct builder *builder, uint32_t result) {
    if (!(result & PIECE))
        return result + 1;
    const struct piece *piece = &builder->pieces.items[result & ~PIECE];
    return is_node(&builder->tree.branches[piece->branch]) ? piece->node_base : REF_LEAF | piece->block_base;
}

static bool write_all(struct builder *builder, struct hierarchy *hierarchies, uint32_t count) {
    builder->pieces.count = 0;
    for (uint32_t i = 0; i < count; i++)
        if (hierarchies[i].count > 0 && !store_top(builder, hierarchies[i].result, &hierarchies[i].result))
            return false;
    if (!make_jobs(builder) || !run_jobs(builder, count_job))
        return false;
    /* With the counts every piece knows its place, and threads write without waiting. */
    uint32_t nodes = 1 + builder->top_count, blocks = 0;
    for (uint32_t i = 0; i < builder->pieces.count; i++) {
        struct piece *piece = &builder->pieces.items[i];
        piece->node_base = nodes;
        piece->block_base = blocks;
        nodes += piece->node_count;
        blocks += piece->block_count;
    }
    if (!alloc_tables(builder->index, nodes, blocks))
        return false;
    /* Node 0 is empty; after it comes the top. */
    memset(&builder->index->nodes[0], 0, sizeof *builder->index->nodes);
    for (uint32_t i = 0; i < builder->top_count; i++) {
        const struct top_node *top = &builder->top[i];
        struct wide_node *node = &builder->index->nodes[1 + i];
        uint32_t children[WIDTH], parts = tree_children(&builder->tree, top->branch, children);
        node_set(node, &builder->tree, top->branch, children, parts);
        for (uint32_t j = 0; j < parts; j++)
            node->child[j] = reference_to(builder, top->child[j]);
    }
    for (uint32_t i = 0; i < count; i++)
        hierarchies[i].result = hierarchies[i].count ? reference_to(builder, hierarchies[i].result) : REF_EMPTY;
    return run_jobs(builder, write_job);
}

bool hierarchies_build(struct triangle_index *index, const struct triangle_set *set, struct reference *references,
                       struct hierarchy_list hierarchies, struct pool *pool, struct error *error) {
    struct builder builder = {.index = index, .set = set, .references = references, .pool = pool};
    bool complete = plan(&builder, hierarchies.items, hierarchies.count) && make_jobs(&builder) &&
                    run_jobs(&builder, build_job) && join_trees(&builder, hierarchies.items, hierarchies.count);
    drop_jobs(&builder);
    complete = complete && tree_improve(&builder.tree, pool) && weigh(&builder, hierarchies.items, hierarchies.count) &&
               write_all(&builder, hierarchies.items, hierarchies.count);
    drop_jobs(&builder);
    mem_free(builder.tree.branches);
    mem_free(builder.pieces.items);
    mem_free(builder.costs);
    mem_free(builder.top);
    if (!complete && is_cancelled(&builder))
        return error_set(error, ERROR_CANCELLED, "cancelled while indexing a mesh");
    return complete || error_no_memory(error, "the index of a mesh");
}
