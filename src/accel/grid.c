/* The grid. Three numbers per voxel boundary are not the same in exact arithmetic: the boundary as computed by the
 * builder, the point where the traversal computes that the ray crosses it, and the point where the ray hits an item.
 * The invariant that makes the traversal safe:
 *
 *   Every item is listed in every voxel that its box, grown by `slack` on each axis, touches; and whenever the ray is
 * at q inside an item's box, the traversal is, at that t, in a voxel whose distance from q is below the slack on each
 * axis.
 *
 * Per axis the traversal's index at t is the start index plus the number of boundaries whose t_next is <= t. It is
 * wrong only while q is within d of a boundary, d being the error of t_next times the speed: at most (steps + 8) 2^-53
 * (|origin| + |q|) on that axis, the steps because t_next is a running sum. With at most 2^12 steps and a slack of
 * 2^-12 of a voxel, d < slack as long as |origin| < 2^26 voxels. Rays from farther away do not traverse the grid: they
 * get all items at once. Worlds far from the origin get voxels so large that the same is true for their coordinates.
 *
 * Everything is relative to the boxes, so scaling by a power of two changes no index and no step. */
#include "accel/grid.h"

#include "base/mem.h"
#include "math/elementary.h"

enum { TRAVERSAL_UNBOUNDED, TRAVERSAL_VOXELS, TRAVERSAL_EVERYTHING, TRAVERSAL_DONE };
enum { POLL_ITEMS = 4096 }; /* how often building checks for cancellation */

#define SLACK 0x1p-12   /* of a voxel */
#define FAR_AWAY 0x1p26 /* voxels between the origin of a traversing ray and the origin of the space */
#define CELLS_PER_AXIS 4096.0
#define CELLS_PER_ITEM 3.0
#define CELLS_IN_ALL 0x1p24
#define ENTRIES_PER_ITEM 24 /* more list entries than that (and a few) make the voxels larger */
#define LARGEST 0x1p1000    /* boxes beyond are treated as infinite: differences must not overflow */
#define SMALLEST 0x1p-900   /* worlds below are one voxel: reciprocals must not overflow */

/* ---- building ---- */

static bool is_bounded(const struct box *b) {
    return vec3_max_abs(b->min) <= LARGEST && vec3_max_abs(b->max) <= LARGEST;
}

static void set3(struct vec3 *v, int axis, double value) {
    double *component = axis == 0 ? &v->x : axis == 1 ? &v->y : &v->z;
    *component = value;
}

/* About `wanted` cubic voxels; axes too thin for a second voxel give theirs to the others. extent[] is relative to the
 * longest one. */
static void choose_cells(const double extent[3], double wanted, uint32_t cells[3]) {
    bool thin[3] = {false, false, false};
    double edge = 1;
    for (int round = 0; round < 3; round++) {
        double volume = 1;
        int axes = 0;
        for (int i = 0; i < 3; i++) {
            if (thin[i])
                continue;
            volume *= extent[i];
            axes++;
        }
        /* The edge that gives the wanted number over the axes that are left. */
        edge = axes == 3 ? el_cbrt(volume / wanted) : axes == 2 ? sqrt(volume / wanted) : volume / wanted;
        bool again = false;
        for (int i = 0; i < 3; i++)
            if (!thin[i] && !(extent[i] >= edge)) {
                thin[i] = true;
                again = true;
            }
        if (!again)
            break;
    }
    for (int i = 0; i < 3; i++) {
        double n = thin[i] ? 1 : floor(extent[i] / edge + 0.5);
        cells[i] = n >= CELLS_PER_AXIS ? (uint32_t)CELLS_PER_AXIS : n >= 1 ? (uint32_t)n : 1;
    }
}

/* The voxel of a coordinate, clamped; NaN gives 0. */
static uint32_t voxel_index(const struct grid *grid, int axis, double x) {
    double position = (x - vec3_get(grid->bounds.min, axis)) * vec3_get(grid->inverse_cell_size, axis);
    if (!(position >= 1))
        return 0;
    uint32_t last = grid->cells[axis] - 1;
    return position >= (double)last ? last : (uint32_t)position;
}

struct voxel_range {
    uint32_t lo[3], hi[3];
};

static struct voxel_range item_range(const struct grid *grid, const struct box *b) {
    struct voxel_range range;
    for (int i = 0; i < 3; i++) {
        double slack = SLACK * vec3_get(grid->cell_size, i);
        range.lo[i] = voxel_index(grid, i, vec3_get(b->min, i) - slack);
        range.hi[i] = voxel_index(grid, i, vec3_get(b->max, i) + slack);
    }
    return range;
}

/* Sets cells and sizes so that there are about `wanted` voxels. */
static void set_resolution(struct grid *grid, double wanted, double largest_coordinate) {
    struct vec3 size = vec3_sub(grid->bounds.max, grid->bounds.min);
    double longest = vec3_max_abs(size);
    grid->cells[0] = grid->cells[1] = grid->cells[2] = 1;
    if (longest > SMALLEST && wanted > 1) {
        const double extent[3] = {size.x / longest, size.y / longest, size.z / longest};
        choose_cells(extent, wanted, grid->cells);
    }
    for (int i = 0; i < 3; i++) {
        /* The world's own coordinates must be small beside FAR_AWAY voxels. */
        double extent = vec3_get(size, i);
        while (grid->cells[i] > 1 && !(extent / grid->cells[i] * (FAR_AWAY / 16) > largest_coordinate))
            grid->cells[i] /= 2;
        double cell = extent / grid->cells[i];
        set3(&grid->cell_size, i, cell);
        set3(&grid->inverse_cell_size, i, grid->cells[i] > 1 ? 1 / cell : 0);
    }
}

static uint64_t count_entries(const struct grid *grid, const struct box *boxes, uint32_t count, uint64_t max_entries) {
    uint64_t entries = 0;
    for (uint32_t i = 0; i < count && entries <= max_entries; i++) {
        if (box_is_empty(&boxes[i]) || !is_bounded(&boxes[i]))
            continue;
        struct voxel_range r = item_range(grid, &boxes[i]);
        entries += (uint64_t)(r.hi[0] - r.lo[0] + 1) * (r.hi[1] - r.lo[1] + 1) * (r.hi[2] - r.lo[2] + 1);
    }
    return entries;
}

/* Count, prefix sum, fill: afterwards cell_start[v] .. cell_start[v + 1] - 1 are the entries of voxel v, ascending. */
static bool fill_lists(struct grid *grid, const struct box *boxes, uint32_t count, const struct pool *pool,
                       struct error *error) {
    uint64_t cells = (uint64_t)grid->cells[0] * grid->cells[1] * grid->cells[2];
    uint64_t row = grid->cells[0], slab = row * grid->cells[1];
    grid->cell_start = mem_alloc_zero(cells + 2, sizeof *grid->cell_start);
    if (!grid->cell_start)
        return error_no_memory(error, "the voxel grid");
    /* Two places up: counts become starts by the sums, and starts become the next voxel's starts by filling. */
    for (int pass = 0; pass < 2; pass++) {
        for (uint32_t item = 0; item < count; item++) {
            if (pool && item % POLL_ITEMS == 0 && pool_cancelled(pool))
                return error_set(error, ERROR_CANCELLED, "cancelled");
            if (box_is_empty(&boxes[item]) || !is_bounded(&boxes[item]))
                continue;
            struct voxel_range r = item_range(grid, &boxes[item]);
            for (uint64_t z = r.lo[2]; z <= r.hi[2]; z++)
                for (uint64_t y = r.lo[1]; y <= r.hi[1]; y++) {
                    uint64_t first = z * slab + y * row;
                    for (uint64_t x = r.lo[0]; x <= r.hi[0]; x++) {
                        if (pass == 0)
                            grid->cell_start[first + x + 2]++;
                        else
                            grid->cell_items[grid->cell_start[first + x + 1]++] = item;
                    }
                }
        }
        if (pass == 0)
            for (uint64_t v = 2; v < cells + 2; v++)
                grid->cell_start[v] += grid->cell_start[v - 1];
    }
    return true;
}

/* The items that no voxel can hold. */
static bool list_unbounded(struct grid *grid, const struct box *boxes, uint32_t count, uint32_t unbounded) {
    grid->unbounded = mem_resize_array(NULL, unbounded, sizeof *grid->unbounded);
    if (!grid->unbounded)
        return false;
    for (uint32_t i = 0; i < count; i++)
        if (!box_is_empty(&boxes[i]) && !is_bounded(&boxes[i]))
            grid->unbounded[grid->unbounded_count++] = i;
    return true;
}

/* Bounds, resolution and lists of the bounded items. */
static bool build_voxels(struct grid *grid, const struct box *boxes, uint32_t count, uint32_t bounded,
                         const struct pool *pool, struct error *error) {
    /* A margin on every axis, also on axes without extent, larger than a ray's rounding error at the border. */
    double largest = math_max(vec3_max_abs(grid->bounds.min), vec3_max_abs(grid->bounds.max));
    double longest = vec3_max_abs(vec3_sub(grid->bounds.max, grid->bounds.min));
    struct vec3 margin = vec3_all(math_max(longest * 0x1p-20 + largest * 0x1p-40, 0x1p-1000));
    grid->bounds = (struct box){vec3_sub(grid->bounds.min, margin), vec3_add(grid->bounds.max, margin)};

    /* Few items: a list is faster. Items that cover many voxels each: larger voxels, so that memory stays bounded. */
    double wanted = bounded <= 3 ? 1 : math_min(CELLS_PER_ITEM * (double)bounded, CELLS_IN_ALL);
    uint64_t limit = (uint64_t)bounded * ENTRIES_PER_ITEM + 4096, entries = 0;
    if (limit > UINT32_MAX)
        limit = UINT32_MAX;
    for (;; wanted /= 4) {
        set_resolution(grid, wanted, largest);
        entries = count_entries(grid, boxes, count, limit);
        if (entries <= limit || wanted <= 1)
            break;
    }
    grid->cell_items = mem_resize_array(NULL, entries, sizeof *grid->cell_items);
    if (!grid->cell_items)
        return error_no_memory(error, "the voxel grid");
    return fill_lists(grid, boxes, count, pool, error);
}

bool grid_build(struct grid *grid, const struct box *boxes, uint32_t count, struct pool *pool, struct error *error) {
    *grid = (struct grid){.bounds = box_empty(), .item_count = count};
    uint32_t bounded = 0, unbounded = 0;
    for (uint32_t i = 0; i < count; i++) {
        if (box_is_empty(&boxes[i]))
            continue;
        if (!is_bounded(&boxes[i])) {
            unbounded++;
            continue;
        }
        bounded++;
        grid->bounds = box_join(grid->bounds, boxes[i]);
    }
    bool ok = unbounded == 0 || list_unbounded(grid, boxes, count, unbounded);
    if (!ok)
        error_no_memory(error, "the voxel grid");
    ok = ok && (bounded == 0 || build_voxels(grid, boxes, count, bounded, pool, error));
    if (!ok)
        grid_destroy(grid);
    return ok;
}

void grid_destroy(struct grid *grid) {
    mem_free(grid->cell_start);
    mem_free(grid->cell_items);
    mem_free(grid->unbounded);
    *grid = (struct grid){.bounds = box_empty()};
}

size_t grid_memory(const struct grid *grid) {
    size_t cells = (size_t)grid->cells[0] * grid->cells[1] * grid->cells[2];
    size_t bytes = grid->unbounded_count * sizeof *grid->unbounded;
    if (grid->cell_start)
        bytes += (cells + 2 + grid->cell_start[cells]) * sizeof(uint32_t);
    return bytes;
}

/* ---- traversal ---- */

/* Starts the traversal at the voxel where the ray enters; false if it misses the grid. */
static bool enter_grid(struct grid_traversal *traversal, const struct grid *grid, const struct ray *ray) {
    double t_enter, t_exit;
    if (!grid->cell_start || !box_clip(&grid->bounds, ray, &t_enter, &t_exit))
        return false;
    traversal->state = TRAVERSAL_VOXELS;
    traversal->t_end = t_exit;
    traversal->cell = 0;
    int64_t stride = 1;
    for (int i = 0; i < 3; i++) {
        double o = vec3_get(ray->origin, i), d = vec3_get(ray->direction, i);
        double cell = vec3_get(grid->cell_size, i);
        uint32_t cells = grid->cells[i];
        traversal->t_next[i] = INFINITY;
        traversal->t_step[i] = 0;
        traversal->cell_step[i] = 0;
        traversal->left[i] = 0;
        if (cells > 1) {
            /* From too far away the position is too coarse for voxels. */
            if (!(fabs(o) < cell * FAR_AWAY))
                traversal->state = TRAVERSAL_EVERYTHING;
            uint32_t index = voxel_index(grid, i, d != 0 ? o + t_enter * d : o);
            traversal->cell += stride * (int64_t)index;
            if (d != 0) {
                /* The next boundary along the axis, and how many voxels are left to the end. */
                double boundary = vec3_get(grid->bounds.min, i) + cell * (double)(d > 0 ? index + 1 : index);
                traversal->t_next[i] = (boundary - o) / d;
                traversal->t_step[i] = cell / fabs(d);
                traversal->cell_step[i] = d > 0 ? stride : -stride;
                traversal->left[i] = d > 0 ? cells - 1 - index : index;
            }
        }
        stride *= cells;
    }
    return true;
}

/* At a voxel: offers its list. */
static bool offer(struct grid_traversal *traversal) {
    const uint32_t *start = traversal->grid->cell_start + traversal->cell;
    traversal->items = traversal->grid->cell_items + start[0];
    traversal->count = start[1] - start[0];
    return traversal->count > 0;
}

/* The axis whose boundary comes next. */
static int next_axis(const struct grid_traversal *traversal) {
    double x = traversal->t_next[0], y = traversal->t_next[1], z = traversal->t_next[2];
    return x <= y ? (x <= z ? 0 : 2) : (y <= z ? 1 : 2);
}

/* Steps until a voxel has items. */
static bool advance(struct grid_traversal *traversal, bool step_first) {
    for (;;) {
        int axis = next_axis(traversal);
        if (step_first) {
            if (!(traversal->t_next[axis] <= traversal->t_end) || traversal->left[axis] == 0)
                break;
            traversal->left[axis]--;
            traversal->cell += traversal->cell_step[axis];
            traversal->t_next[axis] += traversal->t_step[axis];
            axis = next_axis(traversal);
        }
        step_first = true;
        traversal->voxels++;
        if (offer(traversal)) {
            traversal->t_exit = traversal->t_next[axis];
            return true;
        }
    }
    traversal->state = TRAVERSAL_DONE;
    return false;
}

static bool offer_everything(struct grid_traversal *traversal) {
    const struct grid *grid = traversal->grid;
    traversal->state = TRAVERSAL_DONE;
    traversal->items = grid->cell_items;
    traversal->count = grid->cell_start[(size_t)grid->cells[0] * grid->cells[1] * grid->cells[2]];
    traversal->t_exit = -INFINITY;
    traversal->voxels++;
    return traversal->count > 0;
}

bool grid_traversal_begin(struct grid_traversal *traversal, const struct grid *grid, const struct ray *ray) {
    traversal->grid = grid;
    traversal->voxels = 0;
    traversal->state = TRAVERSAL_DONE;
    bool inside = enter_grid(traversal, grid, ray);
    if (grid->unbounded_count > 0) {
        traversal->items = grid->unbounded;
        traversal->count = grid->unbounded_count;
        traversal->t_exit = -INFINITY;
        return true; /* voxels == 0: grid_traversal_next has not returned the first voxel yet */
    }
    if (!inside)
        return false;
    return traversal->state == TRAVERSAL_EVERYTHING ? offer_everything(traversal) : advance(traversal, false);
}

bool grid_traversal_next(struct grid_traversal *traversal) {
    if (traversal->state == TRAVERSAL_DONE)
        return false;
    if (traversal->state == TRAVERSAL_EVERYTHING)
        return offer_everything(traversal);
    return advance(traversal, traversal->voxels > 0);
}
