/* See expr_field.h. Directions are bounded in cells of the six faces of a cube: the ends of u / |(1, u, v)| over a cell
 * are at its corners and where it is nearest to the middle of the face. */
#include "expr/expr_field.h"

#include "base/mem.h"
#include "expr/expr_interval.h"

#include <math.h>
#include <string.h>

bool expr_field_reads_only(const struct expr_program *program, unsigned inputs, const char *words,
                           struct error *error) {
    for (int k = 0; k < program->input_count; k++) {
        unsigned input = program->inputs[k].input;
        if (!(inputs >> input & 1))
            return error_set(error, ERROR_SCENE, "the function reads %s, but %s",
                             expr_input_name((enum expr_input)input), words);
    }
    return true;
}

bool expr_field_reads(const struct expr_program *program, enum expr_input input) {
    for (int k = 0; k < program->input_count; k++)
        if (program->inputs[k].input == (unsigned)input)
            return true;
    return false;
}

static bool is_finite_at(const double p[EXPR_INPUT_COUNT], double value, struct error *error) {
    if (isfinite(value))
        return true;
    return error_set(error, ERROR_SCENE, "at p = {%.6g, %.6g, %.6g} the function is %s", p[EXPR_POINT_X],
                     p[EXPR_POINT_Y], p[EXPR_POINT_Z], isnan(value) ? "not a number (NaN)" : "infinite");
}

bool expr_field_evaluate(const struct expr_program *program, const struct expr_points *points, double *values,
                         struct error *error) {
    double inputs[EXPR_INPUT_COUNT][EXPR_BATCH], outputs[EXPR_OUTPUTS][EXPR_BATCH], point[EXPR_BATCH][EXPR_INPUT_COUNT];
    const double *from[EXPR_INPUT_COUNT];
    double *to[EXPR_OUTPUTS];
    void *rows = mem_alloc_aligned(64, expr_batch_size(program));
    bool ok = rows || error_no_memory(error, "a function");
    for (int k = 0; k < EXPR_INPUT_COUNT; k++)
        from[k] = inputs[k];
    for (int k = 0; k < EXPR_OUTPUTS; k++)
        to[k] = outputs[k];
    for (size_t first = 0; ok && first < points->count; first += EXPR_BATCH) {
        size_t left = points->count - first;
        uint32_t count = left < EXPR_BATCH ? (uint32_t)left : EXPR_BATCH;
        /* The inputs of a batch of points. */
        for (uint32_t i = 0; i < count; i++) {
            memset(point[i], 0, sizeof point[i]);
            points->inputs(points->context, first + i, point[i]);
            for (int k = 0; k < EXPR_INPUT_COUNT; k++)
                inputs[k][i] = point[i][k];
        }
        /* Their values, in order, which must be finite. */
        expr_evaluate_batch(program, count, from, to, rows);
        for (uint32_t i = 0; ok && i < count; i++)
            for (int k = 0; ok && k < program->output_count; k++) {
                *values++ = outputs[k][i];
                ok = is_finite_at(point[i], outputs[k][i], error);
            }
    }
    mem_free(rows);
    return ok;
}

static double amount(double x) {
    return x > 0 && isfinite(x) ? x : 0;
}

struct colour expr_field_at(const struct expr_program *program, struct vec3 p) {
    double inputs[EXPR_INPUT_COUNT] = {p.x, p.y, p.z}, out[EXPR_OUTPUTS];
    expr_evaluate(program, inputs, out);
    if (program->output_count == 1)
        return colour_all(amount(out[0]));
    return colour_make(amount(out[0]), amount(out[1]), amount(out[2]));
}

/* Along each edge of a face. */
enum { FACE_CELLS = 16 };

/* The ends of u / sqrt(1 + u^2 + v^2). */
static void coordinate_ends(const double u[2], const double v[2], double *low, double *high) {
    double v_near = v[0] <= 0 && v[1] >= 0 ? 0 : math_min(fabs(v[0]), fabs(v[1])),
           v_far = math_max(fabs(v[0]), fabs(v[1]));
    double first = u[0] / sqrt(1 + u[0] * u[0] + (u[0] < 0 ? v_near * v_near : v_far * v_far));
    double second = u[1] / sqrt(1 + u[1] * u[1] + (u[1] > 0 ? v_near * v_near : v_far * v_far));
    *low = first - 0x1p-40;
    *high = second + 0x1p-40;
}

struct direction_cells {
    double low[3][EXPR_BOXES], high[3][EXPR_BOXES];
    struct vec3 probes[EXPR_BOXES];
};

static struct vec3 on_face(int face, double u, double v) {
    double x[3];
    x[face / 2] = face % 2 ? 1 : -1;
    x[(face / 2 + 1) % 3] = u;
    x[(face / 2 + 2) % 3] = v;
    return vec3_normalize(vec3_make(x[0], x[1], x[2]));
}

static void put_cell(struct direction_cells *cells, int at, int face, int i, int j) {
    const double u[2] = {2.0 * i / FACE_CELLS - 1, 2.0 * (i + 1) / FACE_CELLS - 1};
    const double v[2] = {2.0 * j / FACE_CELLS - 1, 2.0 * (j + 1) / FACE_CELLS - 1};
    int axis = face / 2, across = (axis + 1) % 3, up = (axis + 2) % 3;
    double u_near = math_min(fabs(u[0]), fabs(u[1])),
           v_near = math_min(fabs(v[0]), fabs(v[1])); /* no cell contains 0 inside */
    double u_far = math_max(fabs(u[0]), fabs(u[1])), v_far = math_max(fabs(v[0]), fabs(v[1]));
    double near = 1 / sqrt(1 + u_near * u_near + v_near * v_near) + 0x1p-40;
    double far = 1 / sqrt(1 + u_far * u_far + v_far * v_far) - 0x1p-40;
    cells->low[axis][at] = face % 2 ? far : -near;
    cells->high[axis][at] = face % 2 ? near : -far;
    coordinate_ends(u, v, &cells->low[across][at], &cells->high[across][at]);
    coordinate_ends(v, u, &cells->low[up][at], &cells->high[up][at]);
    cells->probes[at] = on_face(face, (u[0] + u[1]) / 2, (v[0] + v[1]) / 2);
}

/* The largest of a cell: its bound, or where that is infinite the value at its middle. */
static double cell_largest(const struct expr_program *program, const struct expr_bounds *bounds, int outputs, int at,
                           struct vec3 probe) {
    double largest = 0;
    for (int k = 0; k < outputs; k++)
        largest = math_max(largest, bounds[k].high[at]);
    if (isfinite(largest))
        return largest;
    struct colour value = expr_field_at(program, probe);
    return math_max(value.r, math_max(value.g, value.b));
}

bool expr_field_largest(const struct expr_program *program, double *largest) {
    struct direction_cells cells;
    struct expr_boxes boxes = {.count = EXPR_BOXES};
    struct expr_bounds bounds[EXPR_OUTPUTS];
    void *rows = mem_alloc_aligned(64, expr_intervals_size(program));
    *largest = 0;
    if (!rows)
        return false;
    for (int k = 0; k < 3; k++) {
        boxes.low[EXPR_POINT_X + k] = cells.low[k];
        boxes.high[EXPR_POINT_X + k] = cells.high[k];
    }
    for (int cell = 0; cell < 6 * FACE_CELLS * FACE_CELLS; cell += EXPR_BOXES) {
        for (int i = 0; i < EXPR_BOXES; i++)
            put_cell(&cells, i, (cell + i) / (FACE_CELLS * FACE_CELLS), (cell + i) % FACE_CELLS,
                     (cell + i) / FACE_CELLS % FACE_CELLS);
        expr_evaluate_intervals(program, &boxes, bounds, NULL, rows);
        for (int i = 0; i < EXPR_BOXES; i++)
            *largest = math_max(*largest, cell_largest(program, bounds, program->output_count, i, cells.probes[i]));
    }
    mem_free(rows);
    return true;
}
