/* The index of a mesh: frame, voxels, searches.
 *
 * How many voxels? The caller decides, or the cost model of accel_cost.c, which uses a sample of the triangles. Voxels
 * save a ray the upper levels of the hierarchy. They cost a step per voxel (about a third of a node visit), the start
 * of a hierarchy per occupied voxel on its path (about one), and memory for triangles in several voxels. With eight
 * children per node the saved levels are at most log8 of the number of occupied voxels, if all are equally full: 1.3
 * for 16 of them, 2 for 64; but a ray through a body of that many visits 2 to 4 occupied ones. For compact bodies this
 * is about even. But with one voxel a ray need not be moved to the frame, and rays of one origin traverse the hierarchy
 * together, which saves four visits of a node per ray; so the model chooses one voxel for every measured mesh, and each
 * was fastest with it (docs/lab/notebook.md has the estimates and the times of 8 to 4,096 voxels). The frame is
 * then only the box to which every ray is clipped. */
#include "accel/triangle_index.h"

#include "accel/accel_cost.h"
#include "accel/triangle_build_internal.h"
#include "accel/triangle_kernels_internal.h"
#include "accel/triangle_layout_internal.h"
#include "base/isa.h"
#include "base/mem.h"
#include "math/elementary.h"
#include "math/portable.h"

#include <string.h>

enum {
    MAX_CELLS = 128 /* along one axis */,
    BIG_VOXELS = 8 /* a triangle in more of them goes to a separate hierarchy */
};

static void set_space(struct triangle_index *index, const struct triangle_set *set) {
    struct vec3 extent = vec3_sub(set->bounds.max, set->bounds.min);
    struct vec3 centre = vec3_scale(vec3_add(set->bounds.min, set->bounds.max), 0.5);
    double half = vec3_max_abs(extent) / 2;
    int exponent;
    (void)math_frexp(half, &exponent);
    index->scale = math_ldexp(1, exponent < -1000 ? 1000 : -exponent); /* finite for denormal extents as well */
    for (int k = 0; k < 3; k++) {
        index->centre[k] = vec3_get(centre, k);
        index->half[k] = vec3_get(extent, k) / 2 * index->scale + (double)VOXEL_MARGIN;
    }
}

/* About `wanted` cubical voxels in the local box; axes along which it is thinner than a voxel get one. */
static void set_cells(struct triangle_index *index, double wanted) {
    bool active[3] = {true, true, true};
    double side = 0;
    /* Each round leaves out the axes that are too thin for the side. */
    for (int round = 0; round < 3; round++) {
        double volume = 1;
        int axes = 0;
        for (int k = 0; k < 3; k++)
            if (active[k]) {
                volume *= 2 * index->half[k];
                axes++;
            }
        double each = volume / wanted;
        side = axes == 3 ? el_cbrt(each) : axes == 2 ? sqrt(each) : each;
        for (int k = 0; k < 3; k++)
            active[k] = active[k] && 2 * index->half[k] >= side;
    }
    for (int k = 0; k < 3; k++) {
        double cells = floor(2 * index->half[k] / side + 0.5);
        index->cells[k] = cells < 1 ? 1 : cells > MAX_CELLS ? MAX_CELLS : (uint32_t)cells;
        index->cell[k] = (float)(2 * index->half[k] / index->cells[k]);
        index->inverse_cell[k] = 1 / index->cell[k];
        index->half_single[k] = (float)index->half[k];
        index->last_cell[k] = (float)(index->cells[k] - 1);
    }
    /* Around the voxels is a border, so that a step outside needs no test. */
    index->stride[0] = index->cells[0] + 2;
    index->stride[1] = index->stride[0] * (index->cells[1] + 2);
    const int32_t stride[3] = {1, (int32_t)index->stride[0], (int32_t)index->stride[1]};
    /* The step in memory for each set of axes crossed at once, by the signs of the direction. */
    for (int negative = 0; negative < 8; negative++)
        for (int axes = 0; axes < 8; axes++) {
            index->offset[negative][axes] = 0;
            for (int k = 0; k < 3; k++)
                if (axes >> k & 1)
                    index->offset[negative][axes] += negative >> k & 1 ? -stride[k] : stride[k];
        }
    index->voxel_count = (size_t)index->stride[1] * (index->cells[2] + 2);
}

static struct reference whole_reference(const struct triangle_index *index, const struct triangle_set *set,
                                        uint32_t i) {
    struct reference r = {.triangle = i};
    const double *centre = index->centre;
    const double *a = set->vertices[set->corners[i][0]], *b = set->vertices[set->corners[i][1]],
                 *c = set->vertices[set->corners[i][2]];
    for (int k = 0; k < 3; k++) {
        double lo = a[k] < b[k] ? a[k] : b[k], hi = a[k] < b[k] ? b[k] : a[k];
        lo = c[k] < lo ? c[k] : lo;
        hi = c[k] > hi ? c[k] : hi;
        r.min[k] = (float)((lo - centre[k]) * index->scale);
        r.max[k] = (float)((hi - centre[k]) * index->scale);
    }
    return r;
}

/* Voxels low .. high (inclusive) that the grown box touches; their number. */
static uint32_t touched(const struct triangle_index *index, const struct reference *r, uint32_t low[3],
                        uint32_t high[3]) {
    uint32_t number = 1;
    for (int k = 0; k < 3; k++) {
        float a = (r->min[k] - VOXEL_MARGIN + (float)index->half[k]) * index->inverse_cell[k];
        float b = (r->max[k] + VOXEL_MARGIN + (float)index->half[k]) * index->inverse_cell[k];
        uint32_t last = index->cells[k] - 1;
        low[k] = a > 0 ? (uint32_t)a : 0;
        high[k] = b > 0 ? (uint32_t)b : 0;
        low[k] = low[k] > last ? last : low[k];
        high[k] = high[k] > last ? last : high[k];
        number *= high[k] - low[k] + 1;
    }
    return number;
}

static struct reference cut(const struct triangle_index *index, const struct reference *whole, const uint32_t at[3]) {
    struct reference r = *whole;
    for (int k = 0; k < 3; k++) {
        float lo = (float)at[k] * index->cell[k] - (float)index->half[k] - VOXEL_MARGIN;
        float hi = (float)(at[k] + 1) * index->cell[k] - (float)index->half[k] + VOXEL_MARGIN;
        r.min[k] = r.min[k] > lo ? r.min[k] : lo;
        r.max[k] = r.max[k] < hi ? r.max[k] : hi;
        if (r.min[k] > r.max[k]) /* touches only by the margin */
            r.min[k] = r.max[k] = whole->min[k] > hi ? hi : lo;
    }
    return r;
}

static size_t voxel_at(const struct triangle_index *index, uint32_t x, uint32_t y, uint32_t z) {
    return (size_t)(z + 1) * index->stride[1] + (size_t)(y + 1) * index->stride[0] + x + 1;
}

/* Called for every triangle, polls every few thousand. */
static bool is_time_to_stop(const struct pool *pool, uint32_t i) {
    return i % 4096 == 0 && pool && pool_cancelled(pool);
}

enum { CHUNK = 8192 }; /* triangles that one item of the pool takes */

struct referring {
    const struct triangle_index *index;
    const struct triangle_set *set;
    struct reference *references;
};

static void refer_to_chunk(void *context, uint32_t item, int worker) {
    const struct referring *r = context;
    uint32_t first = item * CHUNK, left = r->set->count - first;
    (void)worker;
    for (uint32_t i = first; i < first + (left < CHUNK ? left : CHUNK); i++)
        r->references[i] = whole_reference(r->index, r->set, i);
}

/* One voxel: all triangles lie in it. */
static bool fill_one_voxel(struct triangle_index *index, const struct triangle_set *set, struct pool *pool,
                           struct error *error) {
    struct referring referring = {index, set, mem_alloc_aligned(64, set->count * sizeof(struct reference))};
    struct hierarchy whole = {.count = set->count};
    uint32_t chunks = (set->count - 1) / CHUNK + 1;
    bool complete = true;
    if (!referring.references)
        return error_no_memory(error, "the index of a mesh");
    if (pool)
        complete = pool_run(pool, chunks, refer_to_chunk, &referring) ||
                   error_set(error, ERROR_CANCELLED, "cancelled while indexing a mesh");
    for (uint32_t i = 0; !pool && i < chunks; i++)
        refer_to_chunk(&referring, i, 0);
    complete = complete &&
               hierarchies_build(index, set, referring.references, (struct hierarchy_list){&whole, 1}, pool, error);
    index->only = whole.result;
    for (int k = 0; k < 4; k++) {
        index->usual_from[k] = -1;
        index->usual_to[k] = NEAR_BY;
        index->usual_from[4 + k] = k < 3 ? 0x1p-80f : -1;
        index->usual_to[4 + k] = 0x1p30f;
    }
    mem_free(referring.references);
    return complete;
}

/* Count, prefix sum, fill: references of every voxel in ascending order of triangles, those of the big ones at the
 * end. */
static bool fill_voxels(struct triangle_index *index, const struct triangle_set *set, struct pool *pool,
                        struct error *error) {
    struct hierarchy *lists = mem_alloc_zero(index->voxel_count + 1, sizeof *lists);
    struct reference *references = NULL;
    index->voxels = mem_alloc(index->voxel_count * sizeof *index->voxels);
    bool is_complete = lists && index->voxels;
    uint32_t low[3], high[3];
    uint64_t total = 0;
    struct hierarchy *big = lists + (lists ? index->voxel_count : 0);
    bool go_on = true;
    /* Count. A big triangle stands in a list of its own, which every ray visits. */
    for (uint32_t i = 0; is_complete && go_on && i < set->count; i++) {
        go_on = !is_time_to_stop(pool, i);
        struct reference r = whole_reference(index, set, i);
        if (touched(index, &r, low, high) > BIG_VOXELS) {
            big->count++;
            continue;
        }
        for (uint32_t z = low[2]; z <= high[2]; z++)
            for (uint32_t y = low[1]; y <= high[1]; y++)
                for (uint32_t x = low[0]; x <= high[0]; x++)
                    lists[voxel_at(index, x, y, z)].count++;
    }
    /* Where each list begins; the counts begin anew. */
    for (size_t v = 0; is_complete && v <= index->voxel_count; v++) {
        lists[v].first = (uint32_t)total;
        total += lists[v].count;
        lists[v].count = 0;
    }
    is_complete = is_complete && total < UINT32_MAX;
    if (is_complete)
        references = mem_alloc_aligned(64, total * sizeof *references);
    is_complete = is_complete && references;
    /* Fill, each reference cut to its voxel. */
    for (uint32_t i = 0; is_complete && go_on && i < set->count; i++) {
        go_on = !is_time_to_stop(pool, i);
        struct reference r = whole_reference(index, set, i);
        if (touched(index, &r, low, high) > BIG_VOXELS) {
            references[big->first + big->count++] = r;
            continue;
        }
        uint32_t at[3];
        for (at[2] = low[2]; at[2] <= high[2]; at[2]++)
            for (at[1] = low[1]; at[1] <= high[1]; at[1]++)
                for (at[0] = low[0]; at[0] <= high[0]; at[0]++) {
                    struct hierarchy *list = &lists[voxel_at(index, at[0], at[1], at[2])];
                    references[list->first + list->count++] = cut(index, &r, at);
                }
    }
    if (is_complete && !go_on) {
        mem_free(lists);
        mem_free(references);
        return error_set(error, ERROR_CANCELLED, "cancelled while indexing a mesh");
    }
    bool complete =
        is_complete ? hierarchies_build(index, set, references,
                                        (struct hierarchy_list){lists, (uint32_t)index->voxel_count + 1}, pool, error)
                    : error_no_memory(error, "the index of a mesh");
    if (complete) {
        /* Voxels at the border mean: outside. */
        for (size_t v = 0; v < index->voxel_count; v++)
            index->voxels[v] = REF_OUTSIDE;
        for (uint32_t z = 0; z < index->cells[2]; z++)
            for (uint32_t y = 0; y < index->cells[1]; y++)
                for (uint32_t x = 0; x < index->cells[0]; x++) {
                    size_t v = voxel_at(index, x, y, z);
                    index->voxels[v] = lists[v].result;
                }
        index->big = big->result;
    }
    mem_free(lists);
    mem_free(references);
    return complete;
}

static struct box box_of_triangle(const void *context, uint32_t i) {
    const struct triangle_set *set = context;
    struct box box = box_empty();
    for (int j = 0; j < 3; j++) {
        const double *v = set->vertices[set->corners[i][j]];
        box = box_add_point(box, vec3_make(v[0], v[1], v[2]));
    }
    return box;
}

static uint32_t voxels_by_cost(const struct triangle_set *set) {
    enum { SAMPLES = 512, LEVELS = 5 };
    struct cost_sample cost_sample;
    cost_sample_take(&cost_sample, &(struct cost_items){&set->bounds, box_of_triangle, set, set->count}, SAMPLES,
                     LEVELS);
    const uint32_t *cells = cost_sample.levels[accel_over_mesh(&cost_sample).level].cells;
    return cells[0] * cells[1] * cells[2];
}

bool triangle_index_build(struct triangle_index **out, const struct triangle_set *set, uint32_t voxels,
                          struct pool *pool, struct error *error) {
    struct triangle_index *index = mem_alloc_zero(1, sizeof *index);
    if (!index)
        return error_no_memory(error, "the index of a mesh");
    if (set->count > 0) {
        set_space(index, set);
        set_cells(index, voxels > 0 ? voxels : voxels_by_cost(set));
        if (!(index->voxel_count == ONE_VOXEL ? fill_one_voxel : fill_voxels)(index, set, pool, error)) {
            triangle_index_destroy(index);
            return false;
        }
    }
    *out = index;
    return true;
}

void triangle_index_destroy(struct triangle_index *index) {
    if (!index)
        return;
    mem_free(index->voxels);
    mem_free(index->nodes); /* and the blocks, in the same table */
    mem_free(index);
}

size_t triangle_index_memory(const struct triangle_index *index) {
    size_t voxels = index->voxels ? index->voxel_count * sizeof *index->voxels : 0;
    return sizeof *index + voxels + index->node_count * sizeof *index->nodes +
           index->block_count * sizeof *index->blocks;
}

#if CPU_ISA_CHOICE
#define OF_EVERY_ISA(name)                                                                                             \
    { name##_base, name##_avx2, name##_avx512 }
#else
#define OF_EVERY_ISA(name)                                                                                             \
    { name##_base, name##_base, name##_base }
#endif

bool triangle_index_nearest(const struct triangle_index *index, const struct triangle_set *set, const struct ray *ray,
                            struct triangle_hit *hit, struct triangle_cost *cost) {
    static bool (*const search[])(const struct triangle_index *, const struct triangle_set *, const struct ray *,
                                  struct triangle_hit *, struct triangle_cost *) = OF_EVERY_ISA(triangle_nearest);
    return search[cpu_isa()](index, set, ray, hit, cost);
}

bool triangle_index_any(const struct triangle_index *index, const struct triangle_set *set, const struct ray *ray,
                        struct triangle_cost *cost) {
    static bool (*const search[])(const struct triangle_index *, const struct triangle_set *, const struct ray *,
                                  struct triangle_cost *) = OF_EVERY_ISA(triangle_any);
    return search[cpu_isa()](index, set, ray, cost);
}

bool triangle_index_nearest_but(const struct triangle_index *index, const struct triangle_set *set,
                                const struct ray *ray, struct triangle_run run, struct triangle_hit *hit,
                                struct triangle_cost *cost) {
    static bool (*const search[])(const struct triangle_index *, const struct triangle_set *, const struct ray *,
                                  struct triangle_run, struct triangle_hit *, struct triangle_cost *) =
        OF_EVERY_ISA(triangle_nearest_but);
    return search[cpu_isa()](index, set, ray, run, hit, cost);
}

bool triangle_index_any_but(const struct triangle_index *index, const struct triangle_set *set, const struct ray *ray,
                            struct triangle_run run, uint32_t *triangle, struct triangle_cost *cost) {
    static bool (*const search[])(const struct triangle_index *, const struct triangle_set *, const struct ray *,
                                  struct triangle_run, uint32_t *, struct triangle_cost *) =
        OF_EVERY_ISA(triangle_any_but);
    return search[cpu_isa()](index, set, ray, run, triangle, cost);
}

void triangle_index_all(const struct triangle_index *index, const struct triangle_set *set, const struct ray *ray,
                        triangle_visit *visit, void *context, struct triangle_cost *cost) {
    static void (*const search[])(const struct triangle_index *, const struct triangle_set *, const struct ray *,
                                  triangle_visit *, void *, struct triangle_cost *) = OF_EVERY_ISA(triangle_all);
    search[cpu_isa()](index, set, ray, visit, context, cost);
}

/* --- searches without an index, the reference for all others --- */

static bool cross(const struct triangle_set *set, uint32_t triangle, const struct triangle_ray *ray,
                  struct triangle_hit *hit) {
    const uint32_t *corner = set->corners[triangle];
    hit->triangle = triangle;
    return triangle_cross(ray, set->vertices[corner[0]], set->vertices[corner[1]], set->vertices[corner[2]], hit);
}

bool triangle_brute_nearest(const struct triangle_set *set, const struct ray *ray, struct triangle_hit *hit,
                            struct triangle_cost *cost) {
    struct triangle_ray sheared;
    if (!triangle_ray_init(&sheared, ray))
        return false;
    double best = ray->t_max;
    bool found = false;
    struct triangle_hit candidate;
    for (uint32_t i = 0; i < set->count; i++)
        if (cross(set, i, &sheared, &candidate) && candidate.t > ray->t_min && candidate.t < best) {
            best = candidate.t;
            *hit = candidate;
            found = true;
        }
    cost->triangle_tests += set->count;
    return found;
}

bool triangle_brute_any(const struct triangle_set *set, const struct ray *ray, struct triangle_cost *cost) {
    struct triangle_ray sheared;
    if (!triangle_ray_init(&sheared, ray))
        return false;
    struct triangle_hit candidate;
    for (uint32_t i = 0; i < set->count; i++)
        if (cross(set, i, &sheared, &candidate) && candidate.t > ray->t_min && candidate.t < ray->t_max) {
            cost->triangle_tests += i + 1;
            return true;
        }
    cost->triangle_tests += set->count;
    return false;
}

void triangle_brute_all(const struct triangle_set *set, const struct ray *ray, triangle_visit *visit, void *context,
                        struct triangle_cost *cost) {
    struct triangle_ray sheared;
    if (!triangle_ray_init(&sheared, ray))
        return;
    struct triangle_hit hit;
    for (uint32_t i = 0; i < set->count; i++)
        if (cross(set, i, &sheared, &hit))
            visit(context, &hit);
    cost->triangle_tests += set->count;
}

static void bundle_tables(struct bundle *bundle, void *triangle_index) {
    struct triangle_index *index = triangle_index;
    BUNDLE(bundle, index->nodes, index->node_count, NULL);
    BUNDLE(bundle, index->blocks, index->block_count, NULL);
    BUNDLE(bundle, index->voxels, index->voxel_count, NULL);
}

void triangle_index_bundle(struct bundle *bundle, struct triangle_index **index) {
    BUNDLE(bundle, *index, 1, bundle_tables);
}

void triangle_set_bundle(struct bundle *bundle, void *triangles) {
    struct triangle_set *set = triangles;
    uint32_t corners = 0;
    for (uint32_t i = 0; i < set->count; i++)
        for (int k = 0; k < 3; k++)
            corners = set->corners[i][k] < corners ? corners : set->corners[i][k] + 1;
    BUNDLE(bundle, set->vertices, corners, NULL);
    BUNDLE(bundle, set->corners, set->count, NULL);
}
