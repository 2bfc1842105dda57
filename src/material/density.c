/* See density.h. */
#include "material/density_internal.h"

#include <float.h>
#include <stdatomic.h>

enum density_kind { DENSITY_BOX, DENSITY_FUNCTION, DENSITY_GRID };

/* CELLS: of a grid, along an axis. STEPS: of the quadrature, in a cell. */
enum { CELLS = 48, STEPS = 4 };

#define CELL_NONE UINT64_MAX

struct density {
    enum density_kind kind;
    bool fits;
    struct box box;
    /* Of a function and a grid. */
    struct fog_cells cells;
    float (*bounds)[2];
    const struct fog_field *field;
    uint32_t count[3];
    const float *values;
    _Atomic uint64_t *excess; /* the first cell with a density above its bound; CELL_NONE: there is none */
};

static struct density *density_make(struct arena *arena, enum density_kind kind, const struct box *box,
                                    struct error *error) {
    struct density *density = arena_alloc(arena, sizeof *density);
    _Atomic uint64_t *excess = density ? arena_alloc(arena, sizeof *excess) : NULL;
    if (!excess) {
        (void)error_no_memory(error, "a medium");
        return NULL;
    }
    *density = (struct density){.kind = kind, .box = *box, .excess = excess};
    atomic_init(excess, CELL_NONE);
    return density;
}

const struct density *density_of_box(struct arena *arena, const struct box *box, struct error *error) {
    return density_make(arena, DENSITY_BOX, box, error);
}

const struct density *density_of_function(struct arena *arena, const struct density_function *in, struct error *error) {
    const struct box box = {in->field->corner, vec3_add(in->field->corner, in->field->size)};
    struct density *density = density_make(arena, DENSITY_FUNCTION, &box, error);
    if (!density)
        return NULL;
    density->field = fog_field_build(arena, in->field, error);
    if (!density->field)
        return NULL;
    const float(*bounds)[2] = fog_field_cells(density->field, &density->cells);
    uint64_t count = fog_cell_count(&density->cells);
    density->bounds = arena_alloc_array(arena, count, sizeof *density->bounds);
    if (!density->bounds) {
        (void)error_no_memory(error, "a medium");
        return NULL;
    }
    for (uint64_t i = 0; i < count; i++) {
        double high = math_min((double)bounds[i][1] * in->looseness, in->bound);
        if (!(high <= (double)FLT_MAX)) {
            (void)error_set(error, ERROR_SCENE,
                            "gray finds no bound of the density of %s; give one with bound = NUMBER",
                            in->field->source);
            return NULL;
        }
        /* Where the density may be above its bound it is looked at everywhere. */
        density->bounds[i][0] = bounds[i][0] < (float)high ? bounds[i][0] : 0;
        density->bounds[i][1] = (float)high;
    }
    return density;
}

/* The voxels whose values count in cell i of `count` along an axis with n of them. */
static void voxels_of_cell(uint32_t i, uint32_t count, uint32_t n, uint32_t *first, uint32_t *last) {
    double begin = floor((double)i * n / count - 0.5 - 0x1p-20),
           end = floor((double)(i + 1) * n / count + 0.5 + 0x1p-20);
    *first = begin > 0 ? (uint32_t)begin : 0;
    *last = end < n - 1 ? (uint32_t)end : n - 1;
}

static void bound_cell(struct density *density, uint64_t cell, double looseness) {
    const uint32_t *n = density->count, *cells = density->cells.count;
    const uint64_t at[3] = {cell % cells[0], cell / cells[0] % cells[1], cell / cells[0] / cells[1]};
    uint32_t first[3], last[3];
    float low = INFINITY, high = 0;
    for (int k = 0; k < 3; k++)
        voxels_of_cell((uint32_t)at[k], cells[k], n[k], &first[k], &last[k]);
    for (uint64_t z = first[2]; z <= last[2]; z++)
        for (uint64_t y = first[1]; y <= last[1]; y++)
            for (uint64_t x = first[0]; x <= last[0]; x++) {
                float value = density->values[x + n[0] * (y + n[1] * z)];
                low = (float)math_min(low, value);
                high = (float)math_max(high, value);
            }
    /* Interpolation rounds. */
    density->bounds[cell][0] = low * (1 - 0x1p-20F);
    density->bounds[cell][1] = high * (1 + 0x1p-20F) * (float)looseness;
}

const struct density *density_of_grid(struct arena *arena, const struct density_grid *in, struct error *error) {
    struct density *density = density_make(arena, DENSITY_GRID, &in->box, error);
    if (!density)
        return NULL;
    density->values = in->values;
    density->fits = in->fits;
    density->cells = (struct fog_cells){.corner = in->box.min, .size = vec3_sub(in->box.max, in->box.min)};
    for (int k = 0; k < 3; k++) {
        density->count[k] = in->count[k];
        density->cells.count[k] = in->count[k] < CELLS ? in->count[k] : CELLS;
    }
    uint64_t count = fog_cell_count(&density->cells);
    density->bounds = arena_alloc_array(arena, count, sizeof *density->bounds);
    if (!density->bounds) {
        (void)error_no_memory(error, "a medium");
        return NULL;
    }
    for (uint64_t i = 0; i < count; i++)
        bound_cell(density, i, in->looseness);
    return density;
}

struct box density_box(const struct density *density) {
    return density->box;
}

const float (*density_cells(const struct density *density, struct fog_cells *cells))[2] {
    if (density->kind == DENSITY_BOX)
        return NULL;
    *cells = density->cells;
    return (const float(*)[2])density->bounds;
}

bool density_fits(const struct density *density) {
    return density->fits;
}

/* --- at a point --- */

static double grid_at(const struct density *density, struct vec3 p) {
    uint64_t offsets[3][2];
    double shares[3];
    uint64_t stride = 1;
    for (int k = 0; k < 3; k++) {
        double n = density->count[k];
        double at = (vec3_get(p, k) - vec3_get(density->cells.corner, k)) / vec3_get(density->cells.size, k) * n - 0.5;
        double low = math_min(math_max(floor(at), 0), n - 1);
        shares[k] = math_min(math_max(at - low, 0), 1);
        offsets[k][0] = stride * (uint64_t)low;
        offsets[k][1] = stride * (uint64_t)math_min(low + 1, n - 1);
        stride *= density->count[k];
    }
    double planes[2];
    for (int z = 0; z < 2; z++) {
        double rows[2];
        for (int y = 0; y < 2; y++) {
            const float *row = density->values + offsets[1][y] + offsets[2][z];
            double a = (double)row[offsets[0][0]], b = (double)row[offsets[0][1]];
            rows[y] = a + shares[0] * (b - a);
        }
        planes[z] = rows[0] + shares[1] * (rows[1] - rows[0]);
    }
    return planes[0] + shares[2] * (planes[1] - planes[0]);
}

uint64_t density_cell(const struct density *density, struct vec3 p) {
    uint64_t cell = 0, stride = 1;
    for (int k = 0; k < 3; k++) {
        double n = density->cells.count[k];
        double at = floor((vec3_get(p, k) - vec3_get(density->cells.corner, k)) / vec3_get(density->cells.size, k) * n);
        cell += stride * (uint64_t)math_min(math_max(at, 0), n - 1);
        stride *= density->cells.count[k];
    }
    return cell;
}

/* Of all cells the first one, whatever the order. */
static void note_excess(const struct density *density, struct vec3 p) {
    uint64_t cell = density_cell(density, p), first = atomic_load_explicit(density->excess, memory_order_relaxed);
    while (cell < first && !atomic_compare_exchange_weak(density->excess, &first, cell))
        continue;
}

double density_at(const struct density *density, struct vec3 p, double time, double high) {
    double value = 1;
    switch (density->kind) {
    case DENSITY_BOX:
        return 1;
    case DENSITY_FUNCTION:
        value = fog_field_at(density->field, p, time);
        break;
    case DENSITY_GRID:
        value = grid_at(density, p);
        break;
    }
    if (value <= high)
        return value > 0 ? value : 0;
    /* Bounds are singles: a function may exceed them by its own rounding. */
    if (value > high * (1 + 0x1p-20))
        note_excess(density, p);
    return value > high ? high : 0;
}

double density_value(const struct density *density, struct vec3 p, double time) {
    if (!box_contains(&density->box, p))
        return 0;
    bool is_box = density->kind == DENSITY_BOX;
    return density_at(density, p, time, is_box ? 1 : (double)density->bounds[density_cell(density, p)][1]);
}

bool density_excess(const struct density *density, struct box *cell, double *bound) {
    uint64_t first = atomic_load(density->excess), rest = first;
    double low[3], high[3];
    if (first == CELL_NONE)
        return false;
    for (int k = 0; k < 3; k++) {
        double n = density->cells.count[k], i = (double)(rest % density->cells.count[k]);
        rest /= density->cells.count[k];
        low[k] = vec3_get(density->cells.corner, k) + vec3_get(density->cells.size, k) * (i / n);
        high[k] = vec3_get(density->cells.corner, k) + vec3_get(density->cells.size, k) * ((i + 1) / n);
    }
    *cell = (struct box){vec3_make(low[0], low[1], low[2]), vec3_make(high[0], high[1], high[2])};
    *bound = (double)density->bounds[first][1];
    return true;
}

/* --- along a line --- */

void density_begin(const struct density *density, const struct medium_line *line, struct density_traversal *traversal) {
    traversal->density = density;
    if (density->kind != DENSITY_BOX) {
        traversal->more =
            fog_traversal_begin(&traversal->cells, &density->cells, line->origin, line->direction, line->distance);
        return;
    }
    const struct ray ray = {.origin = line->origin, .direction = line->direction, .t_max = line->distance};
    traversal->low = traversal->high = 1;
    traversal->more =
        box_clip(&density->box, &ray, &traversal->from, &traversal->to) && traversal->from < traversal->to;
}

bool density_next(struct density_traversal *traversal) {
    uint64_t cell;
    if (!traversal->more)
        return false;
    if (traversal->density->kind == DENSITY_BOX) {
        traversal->more = false;
        return true;
    }
    do {
        if (!fog_traversal_next(&traversal->cells, &cell, &traversal->from, &traversal->to)) {
            traversal->more = false;
            return false;
        }
    } while (!(traversal->density->bounds[cell][1] > 0) || !(traversal->from < traversal->to));
    traversal->low = (double)traversal->density->bounds[cell][0];
    traversal->high = (double)traversal->density->bounds[cell][1];
    return true;
}

/* Two points for each step (Gauss-Legendre). */
static double depth_in_cell(const struct density_traversal *traversal, const struct medium_line *line) {
    double step = (traversal->to - traversal->from) / STEPS, sum = 0;
    for (int i = 0; i < 2 * STEPS; i++) {
        double t = traversal->from + step * (i / 2 + 0.5 + (i % 2 ? 0.28867513459481287 : -0.28867513459481287));
        sum += density_at(traversal->density, vec3_add_scaled(line->origin, line->direction, t), line->time,
                          traversal->high);
    }
    return sum * (step / 2);
}

double density_depth(const struct density *density, const struct medium_line *line) {
    struct density_traversal traversal;
    double depth = 0;
    density_begin(density, line, &traversal);
    while (density_next(&traversal))
        depth += traversal.low == traversal.high ? traversal.low * (traversal.to - traversal.from)
                                                 : depth_in_cell(&traversal, line);
    return depth;
}

static void bundle_values(struct bundle *bundle, void *values) {
    struct density *density = values;
    const size_t voxels = (size_t)density->count[0] * density->count[1] * density->count[2];
    BUNDLE(bundle, density->bounds, (size_t)fog_cell_count(&density->cells), NULL);
    fog_field_bundle(bundle, &density->field);
    BUNDLE(bundle, density->values, voxels, NULL);
    BUNDLE(bundle, density->excess, 1, NULL);
}

void density_bundle(struct bundle *bundle, const struct density **density) {
    BUNDLE(bundle, *density, 1, bundle_values);
}
