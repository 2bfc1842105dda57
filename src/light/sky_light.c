/* Importance sampling of skies: a table of cells, all of the same height in y and width in longitude and so of the same
 * solid angle (Archimedes), each drawn in proportion to the sky's mean luminance in it; a row first, then a cell of the
 * row (Pharr, Jakob, Humphreys, "Physically Based Rendering", the chapter on infinite area lights). Inside of a cell
 * directions are uniform. Equal cells make the poles no special case: rows are thin in angle near the horizon and wide
 * at the poles, where skies change little. A part of all samples is uniform, so that features that the table misses are
 * found and no sample has a very large weight. */
#include "light/sky_light_internal.h"

#include "light/light_shapes_internal.h"
#include "math/elementary.h"

enum { MIN_COLUMNS = 128, MAX_COLUMNS = 512, PROBES = 2 };
static const double everywhere = 1.0 / 16; /* the uniform part */

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

static double cell_luminance(const struct sky *sky, uint32_t column, uint32_t row, uint32_t columns, uint32_t rows) {
    double sum = 0;
    for (int j = 0; j < PROBES; j++) {
        for (int i = 0; i < PROBES; i++) {
            double x = (column + (i + 0.5) / PROBES) / columns, y = (row + (j + 0.5) / PROBES) / rows;
            double value = light_luminance(sky_colour(sky, direction_at(x, y), 0));
            sum += isfinite(value) ? value : 0;
        }
    }
    return sum / (PROBES * PROBES);
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

struct sky_rows {
    const struct sky *sky;
    double *cells;
    uint32_t rows, columns;
};

static void fill_row(void *context, uint32_t row, int worker) {
    const struct sky_rows *f = context;
    (void)worker;
    for (uint32_t column = 0; column < f->columns; column++)
        f->cells[(size_t)row * f->columns + column] = cell_luminance(f->sky, column, row, f->columns, f->rows);
}

const struct sky_table *sky_table_build(const struct sky *sky, struct arena *arena, struct pool *pool) {
    uint32_t columns = columns_for(sky), rows = columns / 2;
    struct sky_table *table = arena_alloc(arena, sizeof *table);
    double *row_until = arena_alloc_array(arena, rows, sizeof *row_until);
    double *until = arena_alloc_array(arena, (size_t)rows * columns, sizeof *until);
    if (!table || !row_until || !until)
        return NULL;
    struct sky_rows filling = {sky, until, rows, columns};
    (void)pool_run(pool, rows, fill_row, &filling); /* cancelled: the next stage of the render checks it */
    double total = 0;
    for (size_t i = 0; i < (size_t)rows * columns; i++)
        total += until[i];
    double min = total / ((double)rows * columns) * everywhere;
    for (uint32_t row = 0; row < rows; row++) {
        double *cells = &until[(size_t)row * columns];
        for (uint32_t column = 0; column < columns; column++)
            cells[column] = (1 - everywhere) * cells[column] + min;
        row_until[row] = running_shares(cells, columns);
    }
    (void)running_shares(row_until, rows);
    *table = (struct sky_table){rows, columns, row_until, until};
    return table;
}

/* The entry selected by a number; *within: its position inside the entry. */
static uint32_t find_share(const double *until, uint32_t count, double share, double *within, double *width) {
    uint32_t low = 0, high = count - 1;
    while (low < high) {
        uint32_t middle = low + (high - low) / 2;
        if (until[middle] > share)
            high = middle;
        else
            low = middle + 1;
    }
    double begin = low > 0 ? until[low - 1] : 0;
    *width = until[low] - begin;
    *within = *width > 0 ? (share - begin) / *width : 0.5;
    *within = *within < 1 ? *within : 1;
    return low;
}

/* Of directions by solid angle, from the shares of a row and of a cell in it. */
static double density_of(const struct sky_table *table, double row_share, double cell_share) {
    return row_share * cell_share * ((double)table->rows * table->columns / (4 * PI));
}

struct sky_sample sky_table_sample(const struct sky *sky, const struct sky_table *table, struct sample2 xi) {
    double x, y, row_share, cell_share;
    uint32_t row = find_share(table->row_until, table->rows, xi.y, &y, &row_share);
    const double *cells = &table->until[(size_t)row * table->columns];
    uint32_t column = find_share(cells, table->columns, xi.x, &x, &cell_share);
    struct sky_sample sample = {.direction = direction_at((column + x) / table->columns, (row + y) / table->rows)};
    sample.pdf = density_of(table, row_share, cell_share);
    if (!(sample.pdf > 0))
        return sample;
    sample.radiance = sky_colour(sky, sample.direction, 0);
    sample.intensity = vec3_scale(sample.radiance, 1 / radiance_of(sample.pdf));
    return sample;
}

static uint32_t cell_index(double x, uint32_t count) {
    double cell = floor(x * count);
    return cell > 0 ? (cell < count ? (uint32_t)cell : count - 1) : 0;
}

double sky_table_pdf(const struct sky_table *table, struct vec3 direction) {
    double turn = el_atan2(direction.z, direction.x) / (2 * PI);
    uint32_t row = cell_index((1 - direction.y) / 2, table->rows);
    uint32_t column = cell_index(turn < 0 ? turn + 1 : turn, table->columns);
    const double *cells = &table->until[(size_t)row * table->columns];
    double row_share = table->row_until[row] - (row > 0 ? table->row_until[row - 1] : 0);
    return density_of(table, row_share, cells[column] - (column > 0 ? cells[column - 1] : 0));
}
