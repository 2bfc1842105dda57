/* See fog_field.h. The number of steps of a ray in a cell is the uncertainty of its optical depth by the bounds of the
 * cell, divided by `step`; beyond STEPS it is multiplied by what is left of the light before the cell. A step is
 * divided again if its points differ by more than `part`. Steps have two points each (Gauss-Legendre quadrature: exact
 * for cubic densities). The emission of a step is that of a constant density and colour in each of its halves. */
#include "material/fog_field.h"

#include "base/mem.h"
#include "base/random.h"
#include "expr/expr_field.h"
#include "expr/expr_interval.h"
#include "material/fog_cells_internal.h"
#include "math/elementary.h"
#include "math/portable.h"

#include <float.h>

/* CELLS: along the longest edge of the box. WORK: instructions times cells for the bounds. VALUES: registers of a
 * program, whose batches are on the stack (inputs keep theirs). STEPS: of a ray in a cell, VISIBLE_STEPS if light is
 * left; PARTS: of a step. */
enum {
    CELLS = 32,
    WORK = 1 << 25,
    VALUES = 512 + EXPR_INPUT_COUNT,
    STEPS = 4,
    VISIBLE_STEPS = 256,
    STEPS_AT_ONCE = EXPR_BATCH / 2,
    PARTS = 8,
    CHECKED_POINTS = 1000
};
static const double step = 0.2, part = 0.03, opaque = 40;

struct fog_field {
    struct fog_cells cells;
    const struct expr_program *density, *colour;
    float (*bounds)[2]; /* of each cell: the minimum and the maximum of the density; at least 0 */
    double brightest;
};

/* --- bounds --- */

enum {
    WORLD_INPUTS = 1U << EXPR_WORLD_X | 1U << EXPR_WORLD_Y | 1U << EXPR_WORLD_Z,
    VIEW_INPUTS = 1U << EXPR_VIEW_X | 1U << EXPR_VIEW_Y | 1U << EXPR_VIEW_Z,
    DENSITY_INPUTS = EXPR_POINT_INPUTS | WORLD_INPUTS | 1U << EXPR_TIME,
};

static bool reads_only(const struct expr_program *program, unsigned inputs, const char *words, struct error *error) {
    if (program->row_count > VALUES)
        return error_set(error, ERROR_SCENE, "the function needs %u values at once; that of a fog may need %d",
                         program->row_count, VALUES);
    return expr_field_reads_only(program, inputs, words, error);
}

struct cell_boxes {
    double low[3][EXPR_BOXES], high[3][EXPR_BOXES], minus[EXPR_BOXES], zero[EXPR_BOXES], one[EXPR_BOXES];
};

static void put_box(const struct fog_cells *cells, uint64_t cell, uint32_t at, struct cell_boxes *boxes) {
    uint64_t rest = cell;
    for (int axis = 0; axis < 3; axis++) {
        double low = vec3_get(cells->corner, axis), size = vec3_get(cells->size, axis), n = cells->count[axis];
        double i = (double)(rest % cells->count[axis]), slack = 0x1p-40 * (fabs(low) + size);
        rest /= cells->count[axis];
        boxes->low[axis][at] = low + size * (i / n) - slack;
        boxes->high[axis][at] = low + size * ((i + 1) / n) + slack;
    }
    boxes->minus[at] = -1;
    boxes->zero[at] = 0;
    boxes->one[at] = 1;
}

static float round_up(double x) {
    float f = (float)x;
    return (double)f < x ? math_nextafterf(f, INFINITY) : f;
}

/* Computes bounds of a program over all cells: of its first output in `bounds` (or NULL), and the maximum of all
 * outputs. */
static bool find_bounds(const struct fog_cells *cells, const struct expr_program *program, float (*bounds)[2],
                        double *largest) {
    uint64_t count = (uint64_t)cells->count[0] * cells->count[1] * cells->count[2];
    void *rows = mem_alloc_aligned(64, expr_intervals_size(program));
    struct cell_boxes *boxes = mem_alloc_aligned(64, sizeof *boxes);
    struct expr_bounds out[EXPR_OUTPUTS];
    *largest = 0;
    for (uint64_t first = 0; rows && boxes && first < count; first += EXPR_BOXES) {
        /* Many cells at once. */
        struct expr_boxes in = {.count = (uint32_t)(count - first < EXPR_BOXES ? count - first : EXPR_BOXES)};
        for (uint32_t i = 0; i < in.count; i++)
            put_box(cells, first + i, i, boxes);
        for (int k = 0; k < 3; k++) {
            in.low[EXPR_POINT_X + k] = in.low[EXPR_WORLD_X + k] = boxes->low[k];
            in.high[EXPR_POINT_X + k] = in.high[EXPR_WORLD_X + k] = boxes->high[k];
            in.low[EXPR_VIEW_X + k] = boxes->minus;
            in.high[EXPR_VIEW_X + k] = boxes->one;
        }
        /* Bounds hold for all directions of view, and for the whole shutter. */
        in.low[EXPR_TIME] = boxes->zero;
        in.high[EXPR_TIME] = boxes->one;
        expr_evaluate_intervals(program, &in, out, NULL, rows);
        for (uint32_t i = 0; i < in.count; i++) {
            for (int k = 0; k < program->output_count; k++)
                *largest = math_max(*largest, out[k].high[i]);
            /* Rounded outwards: singles must contain the doubles. */
            if (bounds) {
                bounds[first + i][0] = (float)math_min(math_max(0, out[0].low[i]), FLT_MAX);
                bounds[first + i][1] = round_up(math_max(0, out[0].high[i]));
            }
        }
    }
    bool done = rows && boxes;
    mem_free(rows);
    mem_free(boxes);
    return done;
}

static struct vec3 checked_point(const struct fog_cells *cells, uint64_t i) {
    double x[3];
    for (int axis = 0; axis < 3; axis++)
        x[axis] = vec3_get(cells->corner, axis) +
                  vec3_get(cells->size, axis) * random_unit(random_combine(i, (uint64_t)axis));
    return vec3_make(x[0], x[1], x[2]);
}

static void evaluate(const struct expr_program *program, struct vec3 p, double time, double out[EXPR_OUTPUTS]) {
    double inputs[EXPR_INPUT_COUNT] = {p.x, p.y, p.z};
    inputs[EXPR_WORLD_X] = p.x;
    inputs[EXPR_WORLD_Y] = p.y;
    inputs[EXPR_WORLD_Z] = p.z;
    inputs[EXPR_VIEW_Z] = 1;
    inputs[EXPR_TIME] = time;
    expr_evaluate(program, inputs, out);
}

static bool check_points(const struct fog_field *field, const struct fog_field_input *in, struct error *error) {
    const char *name = in->name ? in->name : "density";
    for (uint64_t i = 0; i < CHECKED_POINTS; i++) {
        struct vec3 p = checked_point(&field->cells, i);
        double out[EXPR_OUTPUTS];
        evaluate(field->density, p, 0, out);
        if (isnan(out[0]))
            return error_set(error, ERROR_SCENE,
                             "the %s of %s must be at least 0; at p = {%.6g, %.6g, %.6g} it is not a number (NaN)",
                             name, in->source, p.x, p.y, p.z);
        if (out[0] < 0)
            return error_set(error, ERROR_SCENE,
                             "the %s of %s must be at least 0; at p = {%.6g, %.6g, %.6g} it is %.6g "
                             "(gr.max(0.0, x) is never negative)",
                             name, in->source, p.x, p.y, p.z, out[0]);
    }
    return true;
}

static double largest_at_points(const struct fog_field *field) {
    double largest = 0, out[EXPR_OUTPUTS];
    for (uint64_t i = 0; i < CHECKED_POINTS; i++) {
        evaluate(field->colour, checked_point(&field->cells, i), 0, out);
        for (int k = 0; k < field->colour->output_count; k++)
            largest = isfinite(out[k]) ? math_max(largest, out[k]) : largest;
    }
    return largest;
}

/* The cells are cubes; there are fewer if the program is long. */
static void choose_cells(struct fog_cells *cells, const struct expr_program *program) {
    double longest = vec3_max_abs(cells->size);
    for (uint32_t n = CELLS;; n /= 2) {
        uint64_t count = 1;
        for (int axis = 0; axis < 3; axis++) {
            double wanted = ceil(n * (vec3_get(cells->size, axis) / longest));
            cells->count[axis] = wanted < 1 ? 1 : (uint32_t)wanted;
            count *= cells->count[axis];
        }
        if (n <= 4 || count * expr_work(program) <= WORK)
            return;
    }
}

const struct fog_field *fog_field_build(struct arena *arena, const struct fog_field_input *in, struct error *error) {
    if (in->density->output_count != 1) {
        (void)error_set(error, ERROR_SCENE, "the %s of %s is a colour; it must be a number",
                        in->name ? in->name : "density", in->source);
        return NULL;
    }
    if (!reads_only(in->density, DENSITY_INPUTS, "a density may depend only on the point and the time", error) ||
        (in->colour && !reads_only(in->colour, (unsigned)DENSITY_INPUTS | VIEW_INPUTS,
                                   "the colour of a fog may depend only on the point, s.view and the time", error)))
        return NULL;
    struct fog_field *field = arena_alloc(arena, sizeof *field);
    if (!field) {
        (void)error_no_memory(error, "a fog");
        return NULL;
    }
    *field = (struct fog_field){
        .cells = {.corner = in->corner, .size = in->size}, .density = in->density, .colour = in->colour};
    /* Errors at points come before the bounds, because their message names the point. */
    if (!check_points(field, in, error))
        return NULL;
    choose_cells(&field->cells, in->density);
    uint64_t count = (uint64_t)field->cells.count[0] * field->cells.count[1] * field->cells.count[2];
    double unused;
    field->bounds = arena_alloc_array(arena, count, sizeof *field->bounds);
    if (!field->bounds || !find_bounds(&field->cells, field->density, field->bounds, &unused) ||
        (field->colour && !find_bounds(&field->cells, field->colour, NULL, &field->brightest))) {
        (void)error_no_memory(error, "a fog");
        return NULL;
    }
    /* Bounds without end do not say how bright it is. */
    if (field->colour && !isfinite(field->brightest))
        field->brightest = largest_at_points(field);
    return field;
}

double fog_field_brightest(const struct fog_field *field) {
    return field->brightest;
}

const struct expr_program *fog_field_density(const struct fog_field *field) {
    return field->density;
}

const struct expr_program *fog_field_colour(const struct fog_field *field) {
    return field->colour;
}

const float (*fog_field_cells(const struct fog_field *field, struct fog_cells *cells))[2] {
    *cells = field->cells;
    return (const float(*)[2])field->bounds;
}

double fog_field_at(const struct fog_field *field, struct vec3 p, double time) {
    double out[EXPR_OUTPUTS];
    evaluate(field->density, p, time, out);
    return out[0];
}

/* --- along a line --- */

/* Steps of the line that are not evaluated yet, and the result of the line before them. */
struct fog_march {
    const struct fog_field *field;
    const struct medium_line *line;
    uint32_t count;
    double from[STEPS_AT_ONCE], length[STEPS_AT_ONCE];
    double depth;
    struct colour light;
};

/* Density and colour at the two points of each step. */
struct fog_values {
    double density[EXPR_BATCH], colour[3][EXPR_BATCH];
};

static void evaluate_steps(const struct fog_march *march, uint32_t count, const double *from, const double *length,
                           struct fog_values *out) {
    _Alignas(64) unsigned char rows[(VALUES + 3) * EXPR_BATCH * sizeof(union expr_value)];
    double p[3][EXPR_BATCH], view[3][EXPR_BATCH], time[EXPR_BATCH];
    const double *inputs[EXPR_INPUT_COUNT] = {0};
    const struct medium_line *line = march->line;
    for (uint32_t i = 0; i < 2 * count; i++) {
        double apart = length[i / 2] * 0.28867513459481287; /* 1 / (2 sqrt 3) */
        double t = from[i / 2] + length[i / 2] / 2 + (i % 2 ? apart : -apart);
        struct vec3 at = vec3_add_scaled(line->origin, line->direction, t);
        for (int k = 0; k < 3; k++) {
            p[k][i] = vec3_get(at, k);
            view[k][i] = -vec3_get(line->direction, k);
        }
        time[i] = line->time;
    }
    for (int k = 0; k < 3; k++) {
        inputs[EXPR_POINT_X + k] = inputs[EXPR_WORLD_X + k] = p[k];
        inputs[EXPR_VIEW_X + k] = view[k];
    }
    inputs[EXPR_TIME] = time;
    double *const densities[EXPR_OUTPUTS] = {out->density};
    double *const colours[EXPR_OUTPUTS] = {out->colour[0], out->colour[1], out->colour[2]};
    expr_evaluate_batch(march->field->density, 2 * count, inputs, densities, rows);
    if (march->field->colour)
        expr_evaluate_batch(march->field->colour, 2 * count, inputs, colours, rows);
}

/* NaN and negative numbers count as 0. */
static double amount(double x) {
    return x > 0 ? x : 0;
}

/* exp(-depth) */
static double left_of(double depth) {
    return depth < opaque ? el_exp(-depth) : 0;
}

/* The two points of a step. */
static void add_step(struct fog_march *march, const struct fog_values *values, uint32_t number, double length) {
    int last = march->field->colour ? march->field->colour->output_count - 1 : 0;
    for (uint32_t i = 2 * number; i < 2 * number + 2; i++) {
        double depth = amount(values->density[i]) * (length / 2);
        if (!(depth > 0))
            continue;
        if (march->field->colour) {
            double share = left_of(march->depth) * (depth < opaque ? -el_expm1(-depth) : 1);
            struct colour c = {amount(values->colour[0][i]), amount(values->colour[last / 2][i]),
                               amount(values->colour[last][i])};
            march->light = colour_finite(c) ? colour_add_scaled(march->light, c, share) : march->light;
        }
        march->depth += depth;
    }
}

/* A step in which the density changes much is divided into `parts`. */
static void add_divided(struct fog_march *march, uint32_t number, uint32_t parts) {
    double from[PARTS], length[PARTS];
    struct fog_values values;
    for (uint32_t i = 0; i < parts; i++) {
        length[i] = march->length[number] / parts;
        from[i] = march->from[number] + length[i] * i;
    }
    evaluate_steps(march, parts, from, length, &values);
    for (uint32_t i = 0; i < parts; i++)
        add_step(march, &values, i, length[i]);
}

static void add_steps(struct fog_march *march) {
    struct fog_values values;
    if (march->count == 0)
        return;
    evaluate_steps(march, march->count, march->from, march->length, &values);
    for (uint32_t i = 0; i < march->count && march->depth < opaque; i++) {
        double change = fabs(amount(values.density[2 * i]) - amount(values.density[2 * i + 1])) * march->length[i];
        double parts = change / part + 1;
        if (parts >= 2)
            add_divided(march, i, parts < PARTS ? (uint32_t)parts : PARTS);
        else
            add_step(march, &values, i, march->length[i]);
    }
    march->count = 0;
}

/* The number of steps for a cell; an infinite bound needs the maximum. Thin dense layers are in cells that need many
 * steps, if they are visible: then all steps before are evaluated, for the light that is left. */
static uint32_t steps_of(struct fog_march *march, const float bounds[2], double length) {
    double uncertain = ((double)bounds[1] - (double)bounds[0]) * length / step;
    if (uncertain < STEPS)
        return (uint32_t)uncertain + 1;
    if (!(uncertain * left_of(march->depth) > STEPS))
        return STEPS;
    add_steps(march);
    double visible =
        uncertain < VISIBLE_STEPS ? uncertain * left_of(march->depth) : VISIBLE_STEPS * left_of(march->depth);
    return visible > STEPS ? (uint32_t)visible : STEPS;
}

double fog_field_transmittance(const struct fog_field *field, const struct medium_line *line, struct colour *source) {
    struct fog_march march;
    struct fog_traversal traversal;
    uint64_t cell;
    double from, to;
    march.field = field;
    march.line = line;
    march.count = 0;
    march.depth = 0;
    march.light = colour_all(0);
    if (!fog_traversal_begin(&traversal, &field->cells, line->origin, line->direction, line->distance))
        return 1;
    while (march.depth < opaque && fog_traversal_next(&traversal, &cell, &from, &to)) {
        const float *bounds = field->bounds[cell];
        /* Cells that are empty cost nothing. */
        if (!(bounds[1] > 0) || !(to > from))
            continue;
        uint32_t steps = steps_of(&march, bounds, to - from);
        for (uint32_t i = 0; i < steps; i++) {
            march.length[march.count] = (to - from) / steps;
            march.from[march.count] = from + (to - from) / steps * i;
            /* The functions are evaluated for many steps at once. */
            if (++march.count == STEPS_AT_ONCE)
                add_steps(&march);
        }
    }
    add_steps(&march);
    double left = left_of(march.depth);
    /* The light is relative to what the fog hides. */
    if (field->colour)
        *source = left < 1 ? colour_scale(march.light, 1 / (1 - left)) : colour_all(0);
    return left;
}

static void bundle_functions(struct bundle *bundle, void *fog_field) {
    struct fog_field *field = fog_field;
    BUNDLE(bundle, field->density, 1, expr_program_bundle);
    BUNDLE(bundle, field->colour, 1, expr_program_bundle);
    BUNDLE(bundle, field->bounds, (size_t)fog_cell_count(&field->cells), NULL);
}

void fog_field_bundle(struct bundle *bundle, const struct fog_field **field) {
    BUNDLE(bundle, *field, 1, bundle_functions);
}
