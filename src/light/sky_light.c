/* Importance sampling of skies: a table of cells, all of the same height in y and width in longitude and so of the same
 * solid angle (Archimedes), each drawn in proportion to the sky's mean luminance in it; a row first, then a cell of the
 * row (Pharr, Jakob, Humphreys, "Physically Based Rendering", the chapter on infinite area lights). Inside of a cell
 * directions are uniform. Equal cells make the poles no special case: rows are thin in angle near the horizon and wide
 * at the poles, where skies change little. A part of all samples is uniform, so that features that the table misses are
 * found and no sample has a very large weight.
 *
 * A cell that has much more light than others, or may have it, is divided into halves until no part has much of what is
 * not known: of a picture all light of a part, down to its texels, because its mip levels hide nothing; of a function
 * what bounds over the part allow beyond its darkest value. So a small sun is found, and the parts end at its edge. */
#include "light/sky_light_internal.h"

#include "base/mem.h"
#include "expr/expr_affine.h"
#include "light/light_shapes_internal.h"
#include "math/elementary.h"
#include "math/sampling.h"

enum { MIN_COLUMNS = 128, MAX_COLUMNS = 512, PROBES = 2 };
enum { BREADTH = 4096, MAX_PARTS = 1 << 17 }; /* parts divided in a round; all parts */
static const double everywhere = 1.0 / 16;    /* the uniform part */
static const double unknown_share = 0x1p-14;  /* of all light: what may be unknown of a part */
static const double hidden_share = 0.125;     /* of what is unknown of a part in the end: how much it counts */

/* The width in texels of the whole sky. */
static uint32_t texels_across(const struct sky *sky) {
    switch (sky->kind) {
    case SKY_MAP:
    case SKY_CROSS:
        return image_width(sky->image);
    case SKY_FACES:
        return 4 * image_width(sky->faces[0]);
    case SKY_FUNCTION: /* of any detail */
        return MAX_COLUMNS;
    case SKY_GRADIENT:
    case SKY_CONSTANT:
    case SKY_STOPS:
    case SKY_CLEAR:
        break;
    }
    return MIN_COLUMNS;
}

static uint32_t columns_for(const struct sky *sky) {
    uint32_t columns = texels_across(sky);
    return columns < MIN_COLUMNS ? MIN_COLUMNS : columns > MAX_COLUMNS ? MAX_COLUMNS : columns;
}

/* Row 0 is at the top; y and x of a point run from 0 to 1 downwards and around. */
static struct vec3 direction_at(double x, double y) {
    double height = 1 - 2 * y, sine, cosine, level = sqrt(4 * y * (1 - y));
    el_sincos(2 * PI * x, &sine, &cosine);
    return vec3_make(level * cosine, height, level * sine);
}

/* A rectangle of the table, in the units of direction_at. */
struct patch {
    double x, y, width, height;
};

/* Its extents as angles about its middle; across a map by its texels, which are narrow at the poles. */
static double angle_across(const struct sky *sky, const struct patch *p) {
    double y = p->y + p->height / 2;
    return 2 * PI * p->width * (sky->kind == SKY_MAP ? 1 : sqrt(4 * y * (1 - y)));
}

static double angle_down(const struct patch *p) {
    double y = p->y + p->height / 2;
    return 2 * p->height / sqrt(4 * y * (1 - y));
}

static double angle_of(const struct sky *sky, const struct patch *p) {
    return math_max(angle_across(sky, p), angle_down(p));
}

static double luminance_at(const struct sky *sky, double x, double y, double spread) {
    double value = light_luminance(sky_colour(sky, direction_at(x, y), spread));
    return isfinite(value) ? value : 0;
}

static double texel_angle(const struct sky *sky) {
    return 2 * PI / texels_across(sky);
}

static bool is_picture(const struct sky *sky) {
    return sky->kind == SKY_MAP || sky->kind == SKY_CROSS || sky->kind == SKY_FACES;
}

/* At the middle of a patch, of a picture the mean of texels around. */
static double middle_luminance(const struct sky *sky, const struct patch *p, double spread) {
    return luminance_at(sky, p->x + p->width / 2, p->y + p->height / 2, spread);
}

/* The mean of some directions. Where texels of a picture would lie between them, that of all texels. */
static double mean_luminance(const struct sky *sky, const struct patch *p) {
    double sum = 0, angle = angle_of(sky, p);
    if (is_picture(sky) && angle > PROBES * texel_angle(sky))
        return middle_luminance(sky, p, angle);
    for (int j = 0; j < PROBES; j++) {
        for (int i = 0; i < PROBES; i++)
            sum += luminance_at(sky, p->x + (i + 0.5) / PROBES * p->width, p->y + (j + 0.5) / PROBES * p->height, 0);
    }
    return sum / (PROBES * PROBES);
}

/* Of a picture: above 0 if any texel shines into the patch. */
static double wide_luminance(const struct sky *sky, const struct patch *p) {
    return middle_luminance(sky, p, math_max(4 * angle_of(sky, p), 2 * texel_angle(sky)));
}

/* --- bounds of a function --- */

/* The directions of a patch of a few rows: affine forms of longitude and height. Arcs deviate from their chords by less
 * than the third power of their half width over 15, or by their sagitta. */
static void patch_directions(const struct sky *sky, const struct patch *p, struct expr_affine d[3]) {
    double half = PI * p->width, s, c, sine, cosine;
    el_sincos(2 * PI * (p->x + p->width / 2), &s, &c);
    el_sincos(half, &sine, &cosine);
    if (sky->adjusted) { /* the direction that sky_colour looks up */
        double turned = sky->turn_cosine * c - sky->turn_sine * s;
        s = sky->turn_sine * c + sky->turn_cosine * s;
        c = turned;
    }
    struct expr_affine along = {(1 + cosine) / 2, {0, 0}, (1 - cosine) / 2};
    struct expr_affine aside = {0, {sine, 0}, half * half * half / 15};
    /* The distance from the axis grows or falls with height along an arc of a circle. */
    double top = sqrt(4 * p->y * (1 - p->y)), end = p->y + p->height, bottom = sqrt(math_max(0, 4 * end * (1 - end)));
    double chord = (4 * p->height * p->height + (top - bottom) * (top - bottom)) / 4,
           slack = sqrt(math_max(0, 1 - chord));
    double sagitta = 2 * slack * chord / ((1 + slack) * (top + bottom));
    struct expr_affine level = {(top + bottom + sagitta) / 2, {0, (top - bottom) / 2}, sagitta / 2};
    d[0] = expr_affine_multiply(level, expr_affine_add(expr_affine_scale(along, c), expr_affine_scale(aside, -s)));
    d[1] = (struct expr_affine){1 - 2 * p->y - p->height, {0, p->height}, 0x1p-50};
    d[2] = expr_affine_multiply(level, expr_affine_add(expr_affine_scale(along, s), expr_affine_scale(aside, c)));
}

static double luminance_of(const struct sky *sky, double r, double g, double b) {
    struct colour colour = sky->program->output_count == 1 ? colour_all(r) : colour_make(r, g, b);
    return light_luminance(colour_max(colour, colour_all(0))) * (sky->adjusted ? fabs(sky->intensity) : 1);
}

/* Bounds of the luminance of a function over a patch: all numbers where nothing is known. */
static struct expr_interval luminance_bounds(const struct sky *sky, const struct patch *p, void *rows) {
    struct expr_affine inputs[EXPR_INPUT_COUNT] = {{0}};
    struct expr_interval out[EXPR_OUTPUTS] = {{0}};
    patch_directions(sky, p, &inputs[EXPR_POINT_X]);
    expr_evaluate_affine(sky->program, inputs, out, rows);
    return (struct expr_interval){luminance_of(sky, out[0].low, out[1].low, out[2].low),
                                  luminance_of(sky, out[0].high, out[1].high, out[2].high), false};
}

/* Converts weights to cumulative shares; all equal if all are 0. Returns the sum. */
static double running_shares(double *weights, uint32_t count) {
    double sum = 0, so_far = 0;
    for (uint32_t i = 0; i < count; i++)
        sum += weights[i];
    for (uint32_t i = 0; i < count; i++) {
        so_far += sum > 0 ? weights[i] / sum : 1.0 / count;
        weights[i] = i + 1 < count && so_far < 1 ? so_far : 1;
    }
    return sum;
}

/* --- cells --- */

struct sky_rows {
    const struct sky *sky;
    double *cells;   /* their mean luminance */
    double *unknown; /* of pictures and functions: by how much more a part of a cell may have */
    double minimum;  /* what of this matters */
    char *scratch;   /* scratch_size bytes for each worker */
    size_t scratch_size;
    uint32_t rows, columns;
};

static struct patch patch_of(const struct sky_rows *f, uint32_t row, uint32_t begin, uint32_t end) {
    return (struct patch){(double)begin / f->columns, (double)row / f->rows, (double)(end - begin) / f->columns,
                          1.0 / f->rows};
}

static void fill_row(void *context, uint32_t row, int worker) {
    const struct sky_rows *f = context;
    (void)worker;
    for (uint32_t column = 0; column < f->columns; column++) {
        struct patch p = patch_of(f, row, column, column + 1);
        f->cells[(size_t)row * f->columns + column] = mean_luminance(f->sky, &p);
        if (is_picture(f->sky))
            f->unknown[(size_t)row * f->columns + column] = wide_luminance(f->sky, &p);
    }
}

/* The cells of a row from `begin` to `end`. Where bounds over all of them show nothing, each needs none. */
static void bound_cells(const struct sky_rows *f, uint32_t row, uint32_t begin, uint32_t end, void *scratch) {
    struct patch p = patch_of(f, row, begin, end);
    struct expr_interval bounds = luminance_bounds(f->sky, &p, scratch);
    if (bounds.high <= f->minimum)
        return;
    if (end - begin == 1) {
        f->unknown[(size_t)row * f->columns + begin] = isfinite(bounds.high) ? bounds.high - bounds.low : 0;
        return;
    }
    uint32_t middle = begin + (end - begin) / 2;
    bound_cells(f, row, begin, middle, scratch);
    bound_cells(f, row, middle, end, scratch);
}

static void bound_row(void *context, uint32_t row, int worker) {
    const struct sky_rows *f = context;
    bound_cells(f, row, 0, f->columns, f->scratch + (size_t)worker * f->scratch_size);
}

/* --- parts of cells --- */

/* A part while cells are divided. Light is luminance times area; a cell has area 1. */
struct part {
    struct patch patch;
    double area, light, unknown; /* unknown: by how much more light there may be */
    uint32_t halves;
    bool by_height;
};

struct division {
    const struct sky *sky;
    struct part *parts; /* the first one is not used */
    uint32_t count, capacity;
    double light; /* of all cells */
    void *scratch;
};

/* Half a texel, and those at the corners of a cube are narrower; of functions what directions have digits for. */
static double smallest_angle(const struct sky *sky) {
    return sky->kind == SKY_FUNCTION ? 0x1p-24 : texel_angle(sky) / (sky->kind == SKY_MAP ? 2 : 4);
}

static struct part make_part(const struct division *d, struct patch patch, double area) {
    struct part part = {patch, area, mean_luminance(d->sky, &patch) * area,
                        0,     0,    angle_down(&patch) > angle_across(d->sky, &patch)};
    if (d->sky->kind == SKY_FUNCTION) {
        struct expr_interval bounds = luminance_bounds(d->sky, &patch, d->scratch);
        part.unknown = isfinite(bounds.high) ? (bounds.high - bounds.low) * area : 0;
    } else {
        part.unknown = wide_luminance(d->sky, &patch) * area;
    }
    part.light += hidden_share * part.unknown;
    if (angle_of(d->sky, &patch) < smallest_angle(d->sky))
        part.unknown = 0;
    return part;
}

/* False: no memory. */
static bool add_part(struct division *d, struct patch patch, double area) {
    if (d->count >= d->capacity) {
        uint32_t capacity = d->capacity ? 2 * d->capacity : 4096;
        struct part *parts = mem_resize_array(d->parts, capacity, sizeof *parts);
        if (!parts)
            return false;
        d->parts = parts;
        d->capacity = capacity;
    }
    d->parts[d->count] = make_part(d, patch, area);
    d->light += d->parts[d->count++].light;
    return true;
}

static bool divide(struct division *d, uint32_t at) {
    struct part *whole = &d->parts[at];
    struct patch first = whole->patch, second;
    double half = whole->area / 2;
    whole->halves = d->count;
    d->light -= whole->light;
    *(whole->by_height ? &first.height : &first.width) /= 2;
    second = first;
    second.x += whole->by_height ? 0 : second.width;
    second.y += whole->by_height ? second.height : 0;
    return add_part(d, first, half) && add_part(d, second, half);
}

/* Divides cells, then their halves, until nothing that matters is unknown. */
static bool divide_parts(struct division *d) {
    for (uint32_t begin = 1, end = d->count; begin < end && d->count < MAX_PARTS; begin = end, end = d->count) {
        /* At most BREADTH of them. */
        double limit = unknown_share * math_max(0, d->light);
        for (uint32_t chosen = BREADTH + 1; chosen > BREADTH;
             limit = chosen > BREADTH ? math_max(2 * limit, 0x1p-1000) : limit) {
            chosen = 0;
            for (uint32_t i = begin; i < end; i++)
                chosen += d->parts[i].unknown > limit;
        }
        for (uint32_t i = begin; i < end; i++)
            if (d->parts[i].unknown > limit && !divide(d, i))
                return false;
    }
    return true;
}

/* The cells that may have to be divided become parts, are divided, and have the light of their parts.
 * divided: zeros, then as in struct sky_table. False: no memory. */
static bool divide_cells(struct division *d, const struct sky_rows *f, uint32_t *divided) {
    const uint32_t count = f->rows * f->columns;
    d->count = 1;
    for (uint32_t i = 0; i < count; i++)
        d->light += f->cells[i];
    for (uint32_t i = 0; i < count; i++) {
        if (!(f->unknown[i] > f->minimum))
            continue;
        divided[i] = d->count;
        d->light -= f->cells[i];
        if (!add_part(d, patch_of(f, i / f->columns, i % f->columns, i % f->columns + 1), 1))
            return false;
    }
    if (!divide_parts(d))
        return false;
    for (uint32_t i = d->count; i-- > 1;) { /* halves follow their wholes */
        const struct part *halves = &d->parts[d->parts[i].halves];
        if (d->parts[i].halves)
            d->parts[i].light = halves[0].light + halves[1].light;
    }
    for (uint32_t i = 0; i < count; i++)
        if (divided[i])
            f->cells[i] = d->parts[divided[i]].light;
    return true;
}

/* Divides cells of pictures and functions. False: no memory. */
static bool refine(struct division *d, struct sky_rows *f, struct pool *pool, uint32_t *divided) {
    if (!is_picture(f->sky)) {
        f->scratch_size = (expr_affine_size(f->sky->program) + 63) / 64 * 64;
        d->scratch = f->scratch = mem_alloc_zero((size_t)pool_workers(pool), f->scratch_size);
        if (!f->scratch)
            return false;
        (void)pool_run(pool, f->rows, bound_row, f);
    }
    bool ok = divide_cells(d, f, divided);
    mem_free(f->scratch);
    return ok;
}

/* The parts of the table, with the uniform part of the samples, which has luminance `min`. */
static struct sky_part *kept_parts(const struct division *d, double min, struct arena *arena) {
    struct sky_part *parts = arena_alloc_array(arena, d->count, sizeof *parts);
    for (uint32_t i = 1; parts && i < d->count; i++) {
        const struct part *part = &d->parts[i];
        double all = (1 - everywhere) * part->light + min * part->area;
        double first = part->halves ? (1 - everywhere) * d->parts[part->halves].light + min * part->area / 2 : all;
        parts[i] = (struct sky_part){first / all, part->halves, part->by_height};
    }
    return parts;
}

static double sum_of(const double *numbers, size_t count) {
    double sum = 0;
    for (size_t i = 0; i < count; i++)
        sum += numbers[i];
    return sum;
}

/* Fills the cells, parts and divided of the table; the cells are not shares yet. False: no memory. */
static bool fill_cells(struct sky_table *table, struct sky_rows *f, struct arena *arena, struct pool *pool) {
    const size_t count = (size_t)f->rows * f->columns;
    bool is_divided = f->sky->kind == SKY_FUNCTION || is_picture(f->sky), ok = true;
    struct division division = {.sky = f->sky};
    uint32_t *divided = is_divided ? arena_alloc_array(arena, count, sizeof *divided) : NULL;
    f->unknown = is_divided ? mem_alloc_zero(count, sizeof *f->unknown) : NULL;
    if (is_divided && (!divided || !f->unknown)) {
        mem_free(f->unknown);
        return false;
    }
    (void)pool_run(pool, f->rows, fill_row, f); /* cancelled: the next stage of the render checks it */
    f->minimum = unknown_share * sum_of(f->cells, count);
    if (is_divided)
        ok = refine(&division, f, pool, divided);
    /* The uniform part. */
    double min = sum_of(f->cells, count) / (double)count * everywhere;
    for (size_t i = 0; i < count; i++)
        f->cells[i] = (1 - everywhere) * f->cells[i] + min;
    table->divided = divided;
    table->parts = ok && is_divided ? kept_parts(&division, min, arena) : NULL;
    table->part_count = table->parts ? division.count : 0;
    mem_free(division.parts);
    mem_free(f->unknown);
    return !is_divided || table->parts;
}

const struct sky_table *sky_table_build(const struct sky *sky, struct arena *arena, struct pool *pool) {
    uint32_t columns = columns_for(sky), rows = columns / 2;
    struct sky_table *table = arena_alloc(arena, sizeof *table);
    double *row_until = arena_alloc_array(arena, rows, sizeof *row_until);
    double *until = arena_alloc_array(arena, (size_t)rows * columns, sizeof *until);
    if (!table || !row_until || !until)
        return NULL;
    *table = (struct sky_table){.rows = rows, .columns = columns, .row_until = row_until, .until = until};
    struct sky_rows filling = {.sky = sky, .cells = until, .rows = rows, .columns = columns};
    if (!fill_cells(table, &filling, arena, pool))
        return NULL;
    for (uint32_t row = 0; row < rows; row++)
        row_until[row] = running_shares(&until[(size_t)row * columns], columns);
    (void)running_shares(row_until, rows);
    return table;
}

/* The entry selected by a number; *within: its position inside the entry. */
static uint32_t find_share(const double *until, uint32_t count, double share, double *within, double *width) {
    uint32_t found = (uint32_t)sample_entry(until, count, share);
    double begin = found > 0 ? until[found - 1] : 0;
    *width = until[found] - begin;
    *within = *width > 0 ? (share - begin) / *width : 0.5;
    *within = *within < 1 ? *within : 1;
    return found;
}

/* Of directions by solid angle, from the shares of a row and of a cell in it. */
static double density_of(const struct sky_table *table, double row_share, double cell_share) {
    return row_share * cell_share * ((double)table->rows * table->columns / (4 * PI));
}

/* From a place in the unit square to one in a cell, both as x and y. Returns by how much the density there differs from
 * that of the cell. */
static double sample_parts(const struct sky_table *table, size_t cell, double at[2]) {
    double low[2] = {0, 0}, size[2] = {1, 1}, density = 1;
    if (!table->divided)
        return 1;
    for (const struct sky_part *part = &table->parts[table->divided[cell]]; part->halves;) {
        int axis = part->by_height;
        bool second = at[axis] >= part->share && part->share < 1;
        double begin = second ? part->share : 0, share = second ? 1 - part->share : part->share;
        at[axis] = (at[axis] - begin) / share;
        size[axis] /= 2;
        low[axis] += second ? size[axis] : 0;
        density *= 2 * share;
        part = &table->parts[part->halves + second];
    }
    for (int axis = 0; axis < 2; axis++)
        at[axis] = low[axis] + size[axis] * math_min(at[axis], 1);
    return density;
}

/* That density for a place in the cell. */
static double density_of_parts(const struct sky_table *table, size_t cell, double at[2]) {
    double density = 1;
    if (!table->divided)
        return 1;
    for (const struct sky_part *part = &table->parts[table->divided[cell]]; part->halves;) {
        int axis = part->by_height;
        bool second = at[axis] >= 0.5;
        at[axis] = 2 * at[axis] - second;
        density *= 2 * (second ? 1 - part->share : part->share);
        part = &table->parts[part->halves + second];
    }
    return density;
}

struct sky_sample sky_table_sample(const struct sky *sky, const struct sky_table *table, struct sample2 xi) {
    double at[2], row_share, cell_share;
    uint32_t row = find_share(table->row_until, table->rows, xi.y, &at[1], &row_share);
    size_t first = (size_t)row * table->columns;
    uint32_t column = find_share(&table->until[first], table->columns, xi.x, &at[0], &cell_share);
    double within = sample_parts(table, first + column, at);
    struct sky_sample sample = {.direction =
                                    direction_at((column + at[0]) / table->columns, (row + at[1]) / table->rows)};
    sample.pdf = density_of(table, row_share, cell_share) * within;
    if (!(sample.pdf > 0))
        return sample;
    sample.radiance = sky_colour(sky, sample.direction, 0);
    sample.intensity = colour_scale(sample.radiance, 1 / radiance_of(sample.pdf));
    return sample;
}

/* *within: the position inside of the cell. */
static uint32_t cell_index(double x, uint32_t count, double *within) {
    double cell = math_min(math_max(floor(x * count), 0), count - 1.0);
    *within = x * count - cell;
    return (uint32_t)cell;
}

double sky_table_pdf(const struct sky_table *table, struct vec3 direction) {
    double turn = el_atan2(direction.z, direction.x) / (2 * PI), at[2];
    uint32_t row = cell_index((1 - direction.y) / 2, table->rows, &at[1]);
    uint32_t column = cell_index(turn < 0 ? turn + 1 : turn, table->columns, &at[0]);
    size_t first = (size_t)row * table->columns;
    const double *cells = &table->until[first];
    double row_share = table->row_until[row] - (row > 0 ? table->row_until[row - 1] : 0);
    double density = density_of(table, row_share, cells[column] - (column > 0 ? cells[column - 1] : 0));
    return density * density_of_parts(table, first + column, at);
}

static void bundle_cells(struct bundle *bundle, void *sky_table) {
    struct sky_table *table = sky_table;
    const size_t cells = (size_t)table->rows * table->columns;
    BUNDLE(bundle, table->row_until, table->rows, NULL);
    BUNDLE(bundle, table->until, cells, NULL);
    BUNDLE(bundle, table->parts, table->part_count, NULL);
    BUNDLE(bundle, table->divided, cells, NULL);
}

void sky_table_bundle(struct bundle *bundle, const struct sky_table **table) {
    BUNDLE(bundle, *table, 1, bundle_cells);
}
