/* The height field. Above the line or below it: phi(s) = y(s) - h(x(s), z(s)) is continuous and, between the places
 * where the line passes an edge of a cell or its diagonal, linear; the surface is where its sign changes. Only the sign
 * at the end of each stretch is evaluated, and carried on, so the crossings alternate in spite of rounding; the solid's
 * walls and floor are the ends of the part of the line over the square and above the floor. A pyramid of least and
 * greatest heights over blocks of 2^k x 2^k cells (Musgrave, "Grid tracing", Yale 1988; the pyramid as in Tevs, Ihrke,
 * Seidel, "Maximum mipmaps", I3D 2008) lets the line pass over or under whole blocks. Other blocks are divided into
 * four; the line meets at most three of them, one after the other. */
#include "shape/height_field.h"

#include "math/portable.h"
#include "shape/span_internal.h"

enum { FLOOR, WALL_X0, WALL_X1, WALL_Z0, WALL_Z1, GROUND, MAX_LEVELS = 18, MAX_SIDE = 32768 };

struct range {
    double lo, hi;
};

struct level {
    uint32_t columns, rows;
    struct range *ranges;
};

struct height_field {
    const double *heights;
    uint32_t columns, rows; /* of cells */
    bool open, smooth;
    double floor, lo, hi, size;
    struct level levels[MAX_LEVELS];
    int level_count;
};

static double height(const struct height_field *f, uint32_t column, uint32_t row) {
    return f->heights[(size_t)row * (f->columns + 1) + column];
}

/* ---- building ---- */

static struct range range_join(struct range a, struct range b) {
    return (struct range){math_min(a.lo, b.lo), math_max(a.hi, b.hi)};
}

/* Of the four corners of a cell. */
static struct range range_of_corners(const struct height_field *f, uint32_t column, uint32_t row) {
    struct range r = {INFINITY, -INFINITY};
    for (uint32_t k = 0; k < 4; k++) {
        double h = height(f, column + (k & 1), row + (k >> 1));
        r = range_join(r, (struct range){h, h});
    }
    return r;
}

/* Of the four cells of the level below, of which some may lie outside. */
static struct range range_of_parts(const struct level *below, uint32_t column, uint32_t row) {
    struct range r = {INFINITY, -INFINITY};
    for (uint32_t j = 2 * row; j < 2 * row + 2 && j < below->rows; j++)
        for (uint32_t i = 2 * column; i < 2 * column + 2 && i < below->columns; i++)
            r = range_join(r, below->ranges[(size_t)j * below->columns + i]);
    return r;
}

static bool build_levels(struct height_field *f, struct arena *arena) {
    uint32_t columns = f->columns, rows = f->rows;
    for (f->level_count = 0;; f->level_count++) {
        struct level *level = &f->levels[f->level_count];
        *level = (struct level){columns, rows, arena_alloc_array(arena, (size_t)columns * rows, sizeof *level->ranges)};
        if (!level->ranges)
            return false;
        for (uint32_t j = 0; j < rows; j++)
            for (uint32_t i = 0; i < columns; i++)
                level->ranges[(size_t)j * columns + i] =
                    f->level_count == 0 ? range_of_corners(f, i, j) : range_of_parts(level - 1, i, j);
        if (columns == 1 && rows == 1)
            break;
        columns = (columns + 1) / 2;
        rows = (rows + 1) / 2;
    }
    f->level_count++;
    return true;
}

const struct height_field *height_field_build(struct arena *arena, const struct height_field_input *in,
                                              struct error *error) {
    if (in->columns < 2 || in->rows < 2 || in->columns > MAX_SIDE || in->rows > MAX_SIDE) {
        error_set(error, ERROR_SCENE, "a height field has 2 to %d columns and rows, not %u by %u", MAX_SIDE,
                  in->columns, in->rows);
        return NULL;
    }
    size_t count = (size_t)in->columns * in->rows;
    struct height_field *f = arena_alloc(arena, sizeof *f);
    double *heights = arena_alloc_array(arena, count, sizeof *heights);
    if (!f || !heights) {
        error_no_memory(error, "a height field");
        return NULL;
    }
    *f = (struct height_field){.heights = heights,
                               .columns = in->columns - 1,
                               .rows = in->rows - 1,
                               .open = in->open,
                               .smooth = in->smooth,
                               .floor = in->floor};
    for (size_t i = 0; i < count; i++) {
        heights[i] = in->heights[i];
        if (!(fabs(heights[i]) < 0x1p300)) {
            error_set(error, ERROR_SCENE, "the height in row %zu, column %zu is not a usable number",
                      i / in->columns + 1, i % in->columns + 1);
            return NULL;
        }
    }
    if (!build_levels(f, arena)) {
        error_no_memory(error, "a height field");
        return NULL;
    }
    /* The top level has one cell: the range of all heights. */
    struct range all = f->levels[f->level_count - 1].ranges[0];
    f->lo = all.lo;
    f->hi = all.hi;
    if (!in->open && !(f->floor < f->lo && isfinite(f->floor))) {
        error_set(error, ERROR_SCENE, "the floor of the height field (%g) must be below its lowest place (%g)",
                  f->floor, f->lo);
        return NULL;
    }
    if (in->open)
        f->floor = f->lo;
    f->size = math_max(1, math_max(fabs(f->floor), math_max(fabs(f->lo), fabs(f->hi))));
    return f;
}

/* At a point of the finer grid. The last column and row belong to the cells before them. */
static double refined_height(const struct height_field *f, uint32_t n, uint32_t i, uint32_t j) {
    uint32_t column = i / n < f->columns ? i / n : f->columns - 1, row = j / n < f->rows ? j / n : f->rows - 1;
    double x = (double)(i - column * n) / n, z = (double)(j - row * n) / n;
    double h00 = height(f, column, row), h11 = height(f, column + 1, row + 1);
    double h = z > x ? height(f, column, row + 1) : height(f, column + 1, row);
    double along = z > x ? x : z, to_corner = z > x ? z : x;
    return h00 * (1 - to_corner) + h * (to_corner - along) + h11 * along;
}

bool height_field_refine(const struct height_field *f, uint32_t n, struct arena *arena, struct height_field_input *out,
                         struct error *error) {
    uint64_t columns = (uint64_t)f->columns * n + 1, rows = (uint64_t)f->rows * n + 1;
    if (columns > MAX_SIDE || rows > MAX_SIDE)
        return error_set(error, ERROR_SCENE, "a height field has at most %d columns and rows, not %llu by %llu",
                         MAX_SIDE, (unsigned long long)columns, (unsigned long long)rows);
    double *heights = arena_alloc_array(arena, (size_t)(columns * rows), sizeof *heights);
    if (!heights)
        return error_no_memory(error, "a height field");
    *out = (struct height_field_input){heights, (uint32_t)columns, (uint32_t)rows, f->open, f->floor, f->smooth};
    for (uint32_t j = 0; j < rows; j++)
        for (uint32_t i = 0; i < columns; i++)
            heights[(size_t)j * columns + i] = refined_height(f, n, i, j);
    return true;
}

double height_field_step(const struct height_field *f) {
    return vec3_length(vec3_make(1.0 / f->columns, 0, 1.0 / f->rows));
}

struct box height_field_bounds(const struct height_field *f) {
    struct box bounds = {{0, f->floor, 0}, {1, f->hi, 1}};
    return f->open ? box_pad(bounds) : (struct box){bounds.min, box_pad(bounds).max};
}

bool height_field_is_closed(const struct height_field *f) {
    return !f->open;
}

static struct vec3 point_at(const struct height_field *f, uint32_t column, uint32_t row) {
    return vec3_make((double)column / f->columns, height(f, column, row), (double)row / f->rows);
}

/* The greatest dot(g, p) over the points of a block of 2^k cells a side, if it is above what was found: blocks whose
 * corners do not reach so far are left out, the one in front comes first. */
static void extent_along(const struct height_field *f, struct vec3 g, int k, uint32_t i, uint32_t j, double *found) {
    const struct level *level = &f->levels[k];
    if (i >= level->columns || j >= level->rows)
        return;
    uint32_t right = g.x > 0, behind = g.z > 0;
    if (k == 0) {
        for (uint32_t n = 0; n < 4; n++)
            *found = math_max(*found, vec3_dot(g, point_at(f, i + (n & 1), j + (n >> 1))));
        return;
    }
    struct range r = level->ranges[(size_t)j * level->columns + i];
    double x = math_min(1, math_ldexp(i + right, k) / f->columns), z = math_min(1, math_ldexp(j + behind, k) / f->rows);
    if (vec3_dot(g, vec3_make(x, g.y > 0 ? r.hi : r.lo, z)) <= *found)
        return;
    for (uint32_t n = 0; n < 4; n++)
        extent_along(f, g, k - 1, 2 * i + ((n & 1) ^ right), 2 * j + ((n >> 1) ^ behind), found);
}

static double furthest(const struct height_field *f, struct vec3 g) {
    double found = f->open ? -INFINITY : math_max(g.x, 0) + g.y * f->floor + math_max(g.z, 0);
    extent_along(f, g, f->level_count - 1, 0, 0, &found);
    return found;
}

void height_field_extent(const struct height_field *f, struct vec3 g, double *lo, double *hi) {
    *lo = -furthest(f, vec3_negate(g));
    *hi = furthest(f, g);
}

uint32_t height_field_scratch_need(const struct height_field *f) {
    uint32_t cells = f->columns + f->rows;
    return cells < 64 ? 2 * cells + 4 : 128;
}

/* ---- the line ---- */

struct cell_traversal {
    const struct height_field *field;
    struct line line;
    double x, z, dx, dz; /* in cells */
    double y, dy;
    struct geom_scratch *scratch;
    uint32_t first;
    bool known, below; /* the side of the ground on which the line is, once known */
};

static bool cross(struct cell_traversal *w, double s, uint32_t part) {
    w->below = !w->below;
    return geom_scratch_push(w->scratch, (struct crossing){.t = s, .part = part, .enter = w->below});
}

/* The ground of one triangle of a cell: h = h0 + a (x - column) + b (z - row). */
struct triangle_plane {
    double h0, a, b;
};
static struct triangle_plane triangle_plane(const struct height_field *f, uint32_t column, uint32_t row, bool upper) {
    double h00 = height(f, column, row), h11 = height(f, column + 1, row + 1);
    double h = upper ? height(f, column, row + 1) : height(f, column + 1, row);
    return (struct triangle_plane){h00, upper ? h11 - h : h - h00, upper ? h - h00 : h11 - h};
}

static double phi(const struct cell_traversal *w, double s, uint32_t column, uint32_t row, bool upper) {
    struct triangle_plane plane = triangle_plane(w->field, column, row, upper);
    return (w->y + s * w->dy) - (plane.h0 + plane.a * (w->x + s * w->dx - column) + plane.b * (w->z + s * w->dz - row));
}

/* For numbers: math_min and math_max also look for NaN. */
static inline double lesser(double a, double b) {
    return a < b ? a : b;
}

static inline double greater(double a, double b) {
    return a > b ? a : b;
}

/* The line over one triangle, from s = from to s = to. */
static bool meet_triangle(struct cell_traversal *w, uint32_t column, uint32_t row, bool upper, double from, double to) {
    double start = phi(w, from, column, row, upper), end = phi(w, to, column, row, upper);
    if (!w->known) {
        w->known = true;
        w->below = start < 0;
        if (w->below && !w->field->open)
            w->scratch->items[w->first].enter = true; /* the way in counts */
    }
    if ((end < 0) == w->below)
        return true;
    double s = (start < 0) != (end < 0) ? from + (to - from) * (start / (start - end)) : from;
    uint32_t part = GROUND + 2 * (row * w->field->columns + column) + upper;
    return cross(w, lesser(greater(s, from), to), part);
}

static bool meet_cell(struct cell_traversal *w, uint32_t column, uint32_t row, double from, double to) {
    double before = (w->z + from * w->dz - row) - (w->x + from * w->dx - column);
    double after = (w->z + to * w->dz - row) - (w->x + to * w->dx - column);
    if ((before > 0) == (after > 0))
        return meet_triangle(w, column, row, before > 0, from, to);
    double middle = from + (to - from) * (before / (before - after));
    return meet_triangle(w, column, row, before > 0, from, middle) &&
           meet_triangle(w, column, row, after > 0, middle, to);
}

/* The line over or under a whole block. */
static bool pass(struct cell_traversal *w, bool below, double from, uint32_t column, uint32_t row) {
    if (!w->known) {
        w->known = true;
        w->below = below;
        if (below && !w->field->open)
            w->scratch->items[w->first].enter = true;
        return true;
    }
    return w->below == below || cross(w, from, GROUND + 2 * (row * w->field->columns + column));
}

struct block {
    int level;
    uint32_t column, row;
    double from, to;
};

/* Divides a block: pushes the parts of the line over its children, the last one first. */
static int divide(const struct cell_traversal *w, const struct block *block, struct block *stack, int depth) {
    double edge = (double)((uint32_t)1 << (block->level - 1));
    double x_middle = (2.0 * block->column + 1) * edge, z_middle = (2.0 * block->row + 1) * edge;
    double sx = w->dx != 0 ? (x_middle - w->x) / w->dx : INFINITY,
           sz = w->dz != 0 ? (z_middle - w->z) / w->dz : INFINITY;
    /* Which half comes first. */
    uint32_t x_side = w->dx != 0 ? w->dx < 0 : w->x >= x_middle, z_side = w->dz != 0 ? w->dz < 0 : w->z >= z_middle;
    double cuts[4] = {block->from, lesser(greater(lesser(sx, sz), block->from), block->to),
                      lesser(greater(greater(sx, sz), block->from), block->to), block->to};
    const struct level *level = &w->field->levels[block->level - 1];
    for (int k = 2; k >= 0; k--) {
        double from = cuts[k], to = cuts[k + 1];
        if (!(from < to))
            continue;
        uint32_t column = 2 * block->column + (sx <= from ? 1 - x_side : x_side);
        uint32_t row = 2 * block->row + (sz <= from ? 1 - z_side : z_side);
        if (column < level->columns && row < level->rows)
            stack[depth++] = (struct block){block->level - 1, column, row, from, to};
    }
    return depth;
}

/* The walls and the floor at an end of the line's part. */
struct end {
    double s;
    uint32_t part;
};

static bool clip(double o, double d, struct slab slab, struct end *enter, struct end *leave) {
    if (d == 0)
        return o > slab.lo && o < slab.hi;
    struct end near = {((d > 0 ? slab.lo : slab.hi) - o) / d, d > 0 ? slab.lo_part : slab.hi_part};
    struct end far = {((d > 0 ? slab.hi : slab.lo) - o) / d, d > 0 ? slab.hi_part : slab.lo_part};
    if (near.s > enter->s)
        *enter = near;
    if (far.s < leave->s)
        *leave = far;
    return true;
}

/* All crossings, or, given an interval, at least those up to the first inside it (then *stopped may be set). */
static bool collect(const struct height_field *f, const struct ray *ray, bool nearest, struct geom_scratch *scratch,
                    struct line *line, bool *stopped) {
    struct cell_traversal w = {.field = f, .scratch = scratch, .first = scratch->used};
    *stopped = false;
    if (!line_init(&w.line, ray, vec3_make(0.5, f->floor / 2 + f->hi / 2, 0.5))) {
        *line = w.line;
        return true;
    }
    *line = w.line;
    struct vec3 o = w.line.origin, d = w.line.direction;
    struct end enter = {-INFINITY, 0}, leave = {INFINITY, 0};
    double above = (f->hi - f->floor) * 0x1p-10 + f->size * 0x1p-30;
    if (!clip(o.x, d.x, (struct slab){0, 1, WALL_X0, WALL_X1}, &enter, &leave) ||
        !clip(o.z, d.z, (struct slab){0, 1, WALL_Z0, WALL_Z1}, &enter, &leave) ||
        !clip(o.y, d.y, (struct slab){f->open ? f->lo - above : f->floor, f->hi + above, FLOOR, FLOOR}, &enter,
              &leave) ||
        !(enter.s < leave.s) || !isfinite(enter.s) || !isfinite(leave.s))
        return true;
    w.x = o.x * f->columns, w.dx = d.x * f->columns;
    w.z = o.z * f->rows, w.dz = d.z * f->rows;
    w.y = o.y, w.dy = d.y;

    /* The entry is written first and removed unless the line is below the ground there. */
    if (!f->open && !geom_scratch_push(scratch, (struct crossing){.t = enter.s, .part = enter.part}))
        return false;
    struct block stack[3 * MAX_LEVELS + 1];
    stack[0] = (struct block){f->level_count - 1, 0, 0, enter.s, leave.s};
    int depth = 1;
    bool room = true;
    while (room && depth > 0) {
        struct block block = stack[--depth];
        if (nearest && scratch->used > w.first + (f->open ? 0 : 1)) {
            double t = line_t(&w.line, scratch->items[scratch->used - 1].t);
            if (t > ray->t_min && line_t(&w.line, block.from) > t) {
                *stopped = true;
                break;
            }
        }
        const struct level *level = &f->levels[block.level];
        struct range heights = level->ranges[(size_t)block.row * level->columns + block.column];
        double y0 = w.y + block.from * w.dy, y1 = w.y + block.to * w.dy;
        uint32_t column = block.column << block.level, row = block.row << block.level;
        if (lesser(y0, y1) > heights.hi)
            room = pass(&w, false, block.from, column, row);
        else if (greater(y0, y1) < heights.lo)
            room = pass(&w, true, block.from, column, row);
        else if (block.level == 0)
            room = meet_cell(&w, column, row, block.from, block.to);
        else
            depth = divide(&w, &block, stack, depth);
    }
    if (room && !*stopped && w.below && !f->open)
        room = geom_scratch_push(scratch, (struct crossing){.t = leave.s, .part = leave.part});
    if (!room)
        return false;
    if (!f->open && !scratch->items[w.first].enter) {
        for (uint32_t i = w.first + 1; i < scratch->used; i++)
            scratch->items[i - 1] = scratch->items[i];
        scratch->used--;
    }
    return true;
}

bool height_field_crossings(const struct height_field *f, const struct ray *ray, struct geom_scratch *scratch,
                            struct crossing_list *out) {
    *out = (struct crossing_list){scratch->used, 0};
    struct line line;
    bool stopped;
    if (!collect(f, ray, false, scratch, &line, &stopped)) {
        scratch->used = out->first;
        return false;
    }
    if (f->open)
        line_finish_open(&line, scratch, out->first, out);
    else
        line_finish_closed(&line, scratch, out->first, out);
    return true;
}

bool height_field_nearest(const struct height_field *f, const struct ray *ray, struct geom_scratch *scratch,
                          struct crossing *out) {
    struct crossing_list list = {scratch->used, 0};
    struct line line;
    bool stopped, found = false;
    if (!collect(f, ray, true, scratch, &line, &stopped)) {
        scratch->used = list.first;
        return false;
    }
    if (f->open) {
        line_finish_open(&line, scratch, list.first, &list);
    } else {
        /* The exit that belongs to the last entry is further away; its position does not matter. */
        if (stopped && (scratch->used - list.first) % 2 &&
            !geom_scratch_push(scratch, (struct crossing){.t = INFINITY})) {
            scratch->used = list.first;
            return false;
        }
        line_finish_closed(&line, scratch, list.first, &list);
    }
    for (uint32_t i = 0; i < list.count && !found; i++) {
        const struct crossing *c = &scratch->items[list.first + i];
        if (c->t > ray->t_min && c->t < ray->t_max) {
            *out = *c;
            found = true;
        }
    }
    scratch->used = list.first;
    return found;
}

/* The cell at a place of the unit square, and where in it. */
static uint32_t cell_at(double position, uint32_t cells, double *inside) {
    double scaled = math_min(math_max(position, 0), 1) * cells;
    uint32_t cell = (uint32_t)scaled;
    if (cell >= cells)
        cell = cells - 1;
    *inside = scaled - cell;
    return cell;
}

bool height_field_contains(const struct height_field *f, struct vec3 point) {
    if (!(point.x > 0 && point.x < 1 && point.z > 0 && point.z < 1 && point.y > f->floor))
        return false;
    double x, z;
    uint32_t column = cell_at(point.x, f->columns, &x), row = cell_at(point.z, f->rows, &z);
    struct triangle_plane plane = triangle_plane(f, column, row, z > x);
    return point.y < plane.h0 + plane.a * x + plane.b * z;
}

/* Slopes at a corner by the difference of its neighbours. */
static void corner_slopes(const struct height_field *f, uint32_t column, uint32_t row, double *x_slope,
                          double *z_slope) {
    uint32_t c0 = column > 0 ? column - 1 : 0, c1 = column < f->columns ? column + 1 : column;
    uint32_t r0 = row > 0 ? row - 1 : 0, r1 = row < f->rows ? row + 1 : row;
    *x_slope = (height(f, c1, row) - height(f, c0, row)) * f->columns / (c1 - c0);
    *z_slope = (height(f, column, r1) - height(f, column, r0)) * f->rows / (r1 - r0);
}

static void describe_ground(const struct height_field *f, uint32_t triangle, struct vec3 p, struct surface *out) {
    uint32_t cell = triangle / 2, column = cell % f->columns, row = cell / f->columns;
    bool upper = triangle % 2;
    double x = math_min(math_max(p.x * f->columns - column, 0), 1), z = math_min(math_max(p.z * f->rows - row, 0), 1);
    struct triangle_plane plane = triangle_plane(f, column, row, upper);
    p.y = plane.h0 + plane.a * x + plane.b * z;
    double x_slope = plane.a * f->columns, z_slope = plane.b * f->rows;
    out->point = p;
    out->normal = out->shading_normal = vec3_make(-x_slope, 1, -z_slope);
    out->u = p.x;
    out->v = 1 - p.z;
    out->dpdu = vec3_make(1, x_slope, 0);
    out->dpdv = vec3_make(0, -z_slope, -1);
    if (!f->smooth)
        return;
    /* Weights of the triangle's corners: (0, 0), (1, 1) and the one off the diagonal. */
    double w11 = upper ? x : z, w = upper ? z - x : x - z, w00 = 1 - w11 - w, gx[3], gz[3];
    corner_slopes(f, column, row, &gx[0], &gz[0]);
    corner_slopes(f, column + 1, row + 1, &gx[1], &gz[1]);
    corner_slopes(f, upper ? column : column + 1, upper ? row + 1 : row, &gx[2], &gz[2]);
    out->shading_normal =
        vec3_make(-(w00 * gx[0] + w11 * gx[1] + w * gx[2]), 1, -(w00 * gz[0] + w11 * gz[1] + w * gz[2]));
}

void height_field_describe(const struct height_field *f, const struct ray *ray, const struct crossing *crossing,
                           struct surface *out) {
    struct vec3 p = ray_at(ray, crossing->t), n = {0, 0, 0};
    p.x = math_min(math_max(p.x, 0), 1);
    p.z = math_min(math_max(p.z, 0), 1);
    *out = (struct surface){.has_uv = true, .error = 0x1p-46 * f->size};
    if (crossing->part >= GROUND) {
        describe_ground(f, crossing->part - GROUND, p, out);
    } else {
        double tall = f->hi - f->floor;
        out->v = (p.y - f->floor) / tall;
        out->dpdv = vec3_make(0, tall, 0);
        /* On the walls u runs along the border, against the clock, and v from the floor to the top. */
        switch (crossing->part) {
        case WALL_X0:
            p.x = 0, n.x = -1;
            out->u = p.z, out->dpdu = vec3_make(0, 0, 1);
            break;
        case WALL_X1:
            p.x = 1, n.x = 1;
            out->u = 1 - p.z, out->dpdu = vec3_make(0, 0, -1);
            break;
        case WALL_Z0:
            p.z = 0, n.z = -1;
            out->u = 1 - p.x, out->dpdu = vec3_make(-1, 0, 0);
            break;
        case WALL_Z1:
            p.z = 1, n.z = 1;
            out->u = p.x, out->dpdu = vec3_make(1, 0, 0);
            break;
        case FLOOR:
            p.y = f->floor, n.y = -1;
            out->u = p.x, out->v = p.z;
            out->dpdu = vec3_make(1, 0, 0), out->dpdv = vec3_make(0, 0, 1);
            break;
        }
        out->point = p;
        out->normal = out->shading_normal = n;
    }
    out->pattern_point = out->point;
    out->pattern_normal = out->normal;
}

static void bundle_tables(struct bundle *bundle, void *tables) {
    struct height_field *field = tables;
    BUNDLE(bundle, field->heights, ((size_t)field->columns + 1) * (field->rows + 1), NULL);
    for (int i = 0; i < field->level_count; i++) {
        struct level *level = &field->levels[i];
        BUNDLE(bundle, level->ranges, (size_t)level->columns * level->rows, NULL);
    }
}

void height_field_bundle(struct bundle *bundle, const struct height_field **field) {
    BUNDLE(bundle, *field, 1, bundle_tables);
}
