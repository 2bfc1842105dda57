/* The lines of the grid. A line is cast as a whole when it is first needed, and all cells share its crossings. */
#include "base/mem.h"
#include "export/contour_grid_internal.h"

/* Where a crossing is closer than this to a node, in finest cells, the node itself is tested, so that the three lines
 * through it agree. */
static const double node_margin = 1e-6;
/* Where the grid begins before the solid, in base cells: odd numbers, so that faces of models meet no nodes. */
static const double grid_offset[3] = {0.5137, 0.4719, 0.5391};

static uint64_t line_key(int axis, int u, int v) {
    return ((uint64_t)axis << 40 | (uint64_t)u << 20 | (uint64_t)v) + 1;
}

static struct vec3 point_on(const struct line_grid *grid, int axis, int u, int v, double along) {
    struct vec3 point = vec3_with(grid->origin, axis, along);
    point = vec3_with(point, (axis + 1) % 3, grid_node(grid, (axis + 1) % 3, u));
    return vec3_with(point, (axis + 2) % 3, grid_node(grid, (axis + 2) % 3, v));
}

static void cast_line(const struct line_grid *grid, struct solid_probe *probe, int axis, int u, int v) {
    solid_cast(probe, point_on(grid, axis, u, v, vec3_get(grid->origin, axis)), vec3_with(vec3_all(0), axis, 1));
}

static int unit_of(struct contour *contour, int axis, int u, int v, const struct solid_crossing *crossing) {
    const struct line_grid *grid = &contour->grid;
    double units = crossing->t / grid->step, nearest = floor(units + 0.5);
    if (fabs(units - nearest) > node_margin)
        return (int)floor(units);
    struct vec3 node = point_on(grid, axis, u, v, grid_node(grid, axis, (int)nearest));
    return solid_contains(&contour->probe, node) == crossing->enter ? (int)nearest - 1 : (int)nearest;
}

/* Wakes the base cells at the crossing, and notes that they must come near to it. */
static void note_crossing(struct contour *contour, int axis, int u, int v, struct vec3 point) {
    struct line_grid *grid = &contour->grid;
    int base[3];
    base[axis] = (int)floor((vec3_get(point, axis) - vec3_get(grid->origin, axis)) / grid->step / grid->base);
    bool known = u % grid->base != 0 || v % grid->base != 0;
    for (int i = 0; i < 4; i++) {
        base[(axis + 1) % 3] = u / grid->base - (i & 1);
        base[(axis + 2) % 3] = v / grid->base - (i >> 1);
        /* Only a line between base cells belongs to those before it too. */
        bool meets = (!(i & 1) || u % grid->base == 0) && (!(i >> 1) || v % grid->base == 0);
        for (int a = 0; a < 3; a++)
            meets = meets && base[a] >= 0 && base[a] < grid->base_count[a];
        if (!meets)
            continue;
        size_t index = grid_base_index(grid, base);
        grid->wanted[index] = 1;
        grid->has_wanted = true;
        const struct known_point here = {point, grid->first_known[index]};
        if (known && list_add(&grid->known, &here, 1, sizeof here))
            grid->first_known[index] = (uint32_t)grid->known.count - 1;
        else
            contour->failed = contour->failed || known;
    }
}

/* Adds a line whose crossings are found. */
static struct grid_line add_line(struct contour *contour, int axis, int u, int v, const struct solid_crossing *found,
                                 uint32_t count) {
    struct line_grid *grid = &contour->grid;
    struct grid_crossing *crossings = list_room(&grid->crossings, count, sizeof *crossings);
    const struct grid_line line = {(uint32_t)grid->crossings.count, count};
    if (!crossings || !list_add(&grid->lines, &line, 1, sizeof line) ||
        !key_map_add(&grid->line_numbers, line_key(axis, u, v), (uint32_t)grid->lines.count - 1)) {
        contour->failed = true;
        return (struct grid_line){0, 0};
    }
    grid->crossings.count += count;
    for (uint32_t i = 0; i < count; i++) {
        double along = vec3_get(grid->origin, axis) + found[i].t;
        const struct solid_vertex vertex = {
            .point = point_on(grid, axis, u, v, along), .normal = {found[i].normal}, .surface = {found[i].surface}};
        crossings[i] = (struct grid_crossing){contour_add_vertex(contour, &vertex),
                                              unit_of(contour, axis, u, v, &found[i]), found[i].enter};
        note_crossing(contour, axis, u, v, vertex.point);
    }
    return line;
}

struct grid_line grid_line(struct contour *contour, int axis, int u, int v) {
    struct line_grid *grid = &contour->grid;
    uint32_t *number = key_map_find(&grid->line_numbers, line_key(axis, u, v));
    if (number)
        return ((struct grid_line *)grid->lines.items)[*number];
    struct solid_probe *probe = &contour->probe;
    cast_line(grid, probe, axis, u, v);
    return add_line(contour, axis, u, v, probe->found, probe->count);
}

/* The lines of one axis, every `step` units, cast by the pool: one item is a row of lines. */
struct line_rows {
    struct contour *contour;
    int axis, step, columns;
    struct solid_probe *probes; /* of the workers */
    struct list *rows;          /* of each item: the crossings of all its lines */
    uint32_t *counts;           /* of each line */
};

static void cast_row(void *context, uint32_t item, int worker) {
    struct line_rows *work = context;
    struct solid_probe *probe = &work->probes[worker];
    for (int v = 0; v < work->columns; v++) {
        cast_line(&work->contour->grid, probe, work->axis, (int)item * work->step, v * work->step);
        probe->failed = !list_add(&work->rows[item], probe->found, probe->count, sizeof *probe->found) || probe->failed;
        work->counts[item * (uint32_t)work->columns + (uint32_t)v] = probe->count;
    }
}

static void add_row(struct line_rows *work, int row) {
    const struct solid_crossing *found = work->rows[row].items;
    for (int v = 0; v < work->columns && !work->contour->failed; v++) {
        uint32_t count = work->counts[row * work->columns + v];
        (void)add_line(work->contour, work->axis, row * work->step, v * work->step, found, count);
        found += count;
    }
}

static bool cast_axis(struct line_rows *work, struct pool *pool, struct error *error) {
    struct contour *contour = work->contour;
    int rows = contour->grid.count[(work->axis + 1) % 3] / work->step + 1;
    work->columns = contour->grid.count[(work->axis + 2) % 3] / work->step + 1;
    work->rows = mem_alloc_zero((size_t)rows, sizeof *work->rows);
    work->counts = mem_alloc_zero((size_t)rows * (size_t)work->columns, sizeof *work->counts);
    bool ok = work->rows && work->counts;
    if (!ok)
        error_no_memory(error, "the lines through a solid");
    else if (!(ok = pool_run(pool, (uint32_t)rows, cast_row, work)))
        error_set(error, ERROR_CANCELLED, "stopped while a solid was measured");
    for (int i = 0; i < pool_workers(pool); i++)
        contour->failed = contour->failed || work->probes[i].failed;
    for (int row = 0; work->rows && row < rows; row++) {
        if (ok && !contour->failed)
            add_row(work, row);
        list_destroy(&work->rows[row]);
    }
    mem_free(work->rows);
    mem_free(work->counts);
    return ok;
}

/* So many lines of each axis along an edge of a base cell: what is between them may be missed, such as the tip of one
 * leaf that another one hides but for that. Lines through implicit solids take long. */
static int lines_per_base(const struct csg *csg) {
    bool fast = csg->leaf_count > 1;
    for (uint32_t i = 0; i < csg->leaf_count; i++)
        fast = fast && csg->leaves[i].shape.kind != SHAPE_IMPLICIT;
    return fast ? 8 : 4;
}

static bool cast_base_lines(struct contour *contour, struct pool *pool, struct error *error) {
    const struct csg *csg = contour->probe.csg;
    int workers = pool_workers(pool), step = contour->grid.base / lines_per_base(csg);
    struct line_rows work = {.contour = contour, .step = step > 0 ? step : 1, .probes = solid_probes(csg, workers)};
    bool ok = work.probes || error_no_memory(error, "the lines through a solid");
    for (work.axis = 0; ok && work.axis < 3; work.axis++)
        ok = cast_axis(&work, pool, error);
    solid_probes_destroy(work.probes, workers);
    return ok;
}

/* Nine lines of each axis through the box of a leaf, so that leaves of any size are seen. */
static void cast_through(struct contour *contour, const struct box *box) {
    struct line_grid *grid = &contour->grid;
    for (int i = 0; i < 27; i++) {
        int axis = i / 9, index[2];
        bool within = true;
        for (int side = 0; side < 2; side++) {
            int other = (axis + 1 + side) % 3, step = side ? i % 3 - 1 : i / 3 % 3 - 1;
            double low = vec3_get(box->min, other), high = vec3_get(box->max, other);
            double at = 0.5 * (low + high) + 0.3 * step * (high - low);
            index[side] = (int)floor((at - vec3_get(grid->origin, other)) / grid->step + 0.5);
            within = within && index[side] >= 0 && index[side] <= grid->count[other];
        }
        if (within)
            (void)grid_line(contour, axis, index[0], index[1]);
    }
}

static void cast_leaf_lines(struct contour *contour) {
    const struct csg *csg = contour->probe.csg;
    for (uint32_t i = 0; i < csg->leaf_count && !contour->failed; i++) {
        const struct csg_leaf *leaf = &csg->leaves[i];
        struct box box = box_meet(shape_bounds_under(&leaf->shape, &leaf->csg_from_leaf.forward), csg->bounds);
        if (!box_is_empty(&box))
            cast_through(contour, &box);
    }
}

/* Finest cells along a side: keys of cells have 16 bits for each axis. */
enum { FINEST = 32000, DEEPEST = 32, SMALL_DIVISIONS = 4000 };

bool line_grid_build(struct contour *contour, uint32_t cells, struct pool *pool, struct error *error) {
    struct line_grid *grid = &contour->grid;
    const struct box *bounds = &contour->probe.csg->bounds;
    struct vec3 extent = vec3_sub(bounds->max, bounds->min);
    double side = contour->size / cells;
    int size = 1;
    /* Small cells are about half the tolerance, the finest ones a 64th of it. */
    for (grid->small = 1; size * 2 * (int)cells <= FINEST && side / size > 0.5 * contour->tolerance;)
        size *= 2;
    for (grid->base = size; grid->small < DEEPEST && grid->base * 2 * (int)cells <= FINEST; grid->small *= 2)
        grid->base *= 2;
    grid->step = side / grid->base;
    for (int axis = 0; axis < 3; axis++) {
        double low = vec3_get(bounds->min, axis) - grid_offset[axis] * side;
        grid->origin = vec3_with(grid->origin, axis, low);
        grid->base_count[axis] = (int)ceil(vec3_get(extent, axis) / side) + 2;
        grid->count[axis] = grid->base_count[axis] * grid->base;
    }
    size_t total = (size_t)grid->base_count[0] * (size_t)grid->base_count[1] * (size_t)grid->base_count[2];
    grid->wanted = mem_alloc_zero(total, 1);
    grid->first_known = mem_alloc(total * sizeof *grid->first_known);
    if (!grid->wanted || !grid->first_known)
        return error_no_memory(error, "the cells of a solid");
    memset(grid->first_known, 0xff, total * sizeof *grid->first_known);
    if (!cast_base_lines(contour, pool, error))
        return false;
    cast_leaf_lines(contour);
    contour->divisions = SMALL_DIVISIONS;
    return !contour->failed || error_no_memory(error, "the lines through a solid");
}

void line_grid_destroy(struct line_grid *grid) {
    list_destroy(&grid->lines);
    list_destroy(&grid->crossings);
    list_destroy(&grid->known);
    key_map_destroy(&grid->line_numbers);
    mem_free(grid->first_known);
    mem_free(grid->wanted);
}
