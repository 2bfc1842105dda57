/* An implicit solid: its making, the points in it, its surface at a crossing (implicit_search.c finds the crossings),
 * and what is reported of it. */
#include "base/random.h"
#include "math/frame.h"
#include "shape/implicit_internal.h"
#include "shape/implicit_regions_internal.h"
#include "shape/implicit_search_internal.h"

#include <math.h>

/* Room for crossings in the scratch memory. */
enum { GUESS = 64 };

struct vec3 implicit_middle(const struct implicit *solid) {
    const struct box *box = &solid->in.bounds;
    return solid->in.is_ball ? solid->in.centre : vec3_add(vec3_scale(box->min, 0.5), vec3_scale(box->max, 0.5));
}

/* --- points --- */

static bool is_below_zero(const struct expr_program *program, struct vec3 point) {
    double inputs[EXPR_INPUT_COUNT], outputs[EXPR_OUTPUTS];
    inputs[EXPR_POINT_X] = point.x;
    inputs[EXPR_POINT_Y] = point.y;
    inputs[EXPR_POINT_Z] = point.z;
    expr_evaluate(program, inputs, outputs);
    return outputs[0] < 0;
}

bool implicit_contains(const struct implicit *solid, struct vec3 point) {
    const struct box *box = &solid->in.bounds;
    for (int k = 0; k < 3; k++) {
        double x = vec3_get(point, k);
        if (!(x > vec3_get(box->min, k) && x < vec3_get(box->max, k)))
            return false;
    }
    struct vec3 from_centre = vec3_sub(point, solid->in.centre);
    if (solid->in.is_ball && !(vec3_dot(from_centre, from_centre) < solid->in.radius * solid->in.radius))
        return false;
    return is_below_zero(solid->in.program, point);
}

/* The function at a point, and its gradient. program: one of the solid's. */
static double implicit_gradient(const struct expr_program *program, struct vec3 point, struct vec3 *gradient) {
    _Alignas(IMPLICIT_ALIGNMENT) unsigned char memory[EXPR_GRADIENT_LIMIT];
    double inputs[EXPR_INPUT_COUNT], outputs[EXPR_OUTPUTS], gradients[EXPR_OUTPUTS][EXPR_DIRECTIONS];
    inputs[EXPR_POINT_X] = point.x;
    inputs[EXPR_POINT_Y] = point.y;
    inputs[EXPR_POINT_Z] = point.z;
    expr_evaluate_gradient(program, inputs, expr_gradient_seeds, outputs, gradients, memory);
    *gradient = vec3_make(gradients[0][0], gradients[0][1], gradients[0][2]);
    return outputs[0];
}

/* The same from the values at the corners of a small tetrahedron. The program takes at most IMPLICIT_STACK. */
static double implicit_difference(const struct implicit *solid, const struct expr_program *program, struct vec3 point,
                                  struct vec3 *gradient) {
    enum { CORNERS = 4 };
    static const double signs[3][CORNERS] = {{1, 1, -1, -1}, {1, -1, 1, -1}, {1, -1, -1, 1}};
    _Alignas(IMPLICIT_ALIGNMENT) unsigned char memory[IMPLICIT_STACK];
    double points[3][CORNERS], values[CORNERS], *const outputs[EXPR_OUTPUTS] = {values};
    const double *const inputs[EXPR_INPUT_COUNT] = {
        [EXPR_POINT_X] = points[0], [EXPR_POINT_Y] = points[1], [EXPR_POINT_Z] = points[2]};
    const double step = solid->size * 0x1p-18 + vec3_max_abs(point) * 0x1p-24;
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < CORNERS; i++)
            points[k][i] = vec3_get(point, k) + signs[k][i] * step;
    expr_evaluate_batch(program, CORNERS, inputs, outputs, memory);
    double sums[3] = {0, 0, 0};
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < CORNERS; i++)
            sums[k] += signs[k][i] * values[i];
    *gradient = vec3_scale(vec3_make(sums[0], sums[1], sums[2]), 1 / (CORNERS * step));
    return (values[0] + values[1] + values[2] + values[3]) / CORNERS;
}

/* The normal, on the side from which the line crosses. Near silhouettes, rounding may put it on the other side.
 * Without a normal, it is the direction of the ray. */
static struct vec3 usable_normal(struct vec3 normal, const struct ray *ray, bool enter) {
    struct vec3 out = vec3_scale(vec3_normalize(ray->direction), enter ? -1 : 1);
    double length = vec3_length(normal);
    if (!(length > 0) || !isfinite(length))
        return out;
    struct vec3 unit = vec3_scale(normal, 1 / length);
    double cosine = vec3_dot(unit, out);
    if (cosine >= 0)
        return unit;
    return cosine > -0.1 ? vec3_normalize(vec3_add_scaled(unit, out, -cosine)) : out;
}

/* --- jumps --- */

/* Near a crossing of a line, where the sign jumps: two directions across the line, and the room for steps along it. */
struct jump {
    const struct expr_program *program;
    struct vec3 point, along, across[2];
    double room;
    bool enter;
};

/* How far along the line the sign changes, `off` beside the line. False: not within the room. */
static bool find_beside(const struct jump *jump, int axis, double off, double *out) {
    const struct vec3 start = vec3_add_scaled(jump->point, jump->across[axis], off);
    double low = -jump->room, high = jump->room;
    if (is_below_zero(jump->program, vec3_add_scaled(start, jump->along, low)) == jump->enter ||
        is_below_zero(jump->program, vec3_add_scaled(start, jump->along, high)) != jump->enter)
        return false;
    for (int step = 0; step < 24; step++) {
        const double middle = 0.5 * (low + high);
        if (is_below_zero(jump->program, vec3_add_scaled(start, jump->along, middle)) == jump->enter)
            high = middle;
        else
            low = middle;
    }
    *out = 0.5 * (low + high);
    return true;
}

/* The slope of the surface along one of the directions across the line, which meets it at `from`. The second side is
 * for edges of the surface, the smaller step for grazing lines. */
static bool slope_beside(const struct jump *jump, int axis, double from, double *out) {
    static const double shares[] = {0x1p-4, -0x1p-4, 0x1p-10, -0x1p-10};
    for (int k = 0; k < 4; k++)
        if (find_beside(jump, axis, jump->room * shares[k], out)) {
            *out = (*out - from) / (jump->room * shares[k]);
            return true;
        }
    return false;
}

/* The normal of the plane through three points where the sign changes. */
static bool normal_of_jump(const struct jump *jump, struct vec3 *out) {
    double from, slopes[2];
    if (!find_beside(jump, 0, 0, &from) || !slope_beside(jump, 0, from, &slopes[0]) ||
        !slope_beside(jump, 1, from, &slopes[1]))
        return false;
    struct vec3 normal = vec3_add_scaled(jump->along, jump->across[0], -slopes[0]);
    *out = vec3_scale(vec3_add_scaled(normal, jump->across[1], -slopes[1]), jump->enter ? -1 : 1);
    return true;
}

/* Where the function jumps over 0, the gradient does not show the normal. If the surface is too rough or too thin, the
 * normal is not changed. */
static void describe_jump(const struct implicit *solid, const struct ray *ray, struct vec3 point, bool enter,
                          struct vec3 *normal) {
    struct jump jump = {.program = solid->in.program, .point = point, .enter = enter};
    const double rounding = vec3_max_abs(point) * 0x1p-36;
    jump.along = vec3_normalize(ray->direction);
    frame_tangents(jump.along, &jump.across[0], &jump.across[1]);
    for (double share = 0x1p-20; share >= 0x1p-26; share /= 64) {
        jump.room = solid->size * share + rounding;
        if (normal_of_jump(&jump, normal))
            return;
    }
}

static void describe_cap(const struct implicit *solid, const struct ray *ray, const struct crossing *crossing,
                         struct surface *out) {
    struct vec3 point = ray_at(ray, crossing->t), middle = implicit_middle(solid), normal = {0, 0, 0};
    if (crossing->part == IMPLICIT_PART_BALL) {
        normal = vec3_normalize(vec3_sub(point, middle));
        point = vec3_add_scaled(middle, normal, solid->in.radius);
    } else {
        const struct box *box = &solid->in.bounds;
        double *const points[3] = {&point.x, &point.y, &point.z}, *const normals[3] = {&normal.x, &normal.y, &normal.z};
        int axis = (int)(crossing->part - IMPLICIT_PART_BOX);
        bool is_upper = (vec3_get(ray->direction, axis) > 0) != crossing->enter;
        *normals[axis] = is_upper ? 1 : -1;
        *points[axis] = vec3_get(is_upper ? box->max : box->min, axis);
    }
    surface_make(out, point, normal, 0x1p-48 * (solid->size + vec3_max_abs(middle)));
}

void implicit_describe(const struct implicit *solid, const struct ray *ray, const struct crossing *crossing,
                       struct surface *out) {
    if (crossing->part >= IMPLICIT_PART_BOX) {
        describe_cap(solid, ray, crossing, out);
    } else {
        const bool is_preview = crossing->u > 0;
        const struct expr_program *program =
            &solid->programs[crossing->part < solid->region_count ? solid->regions[crossing->part].program : 0];
        struct vec3 point = ray_at(ray, crossing->t), gradient;
        double off = is_preview && expr_batch_size(program) <= IMPLICIT_STACK
                         ? implicit_difference(solid, program, point, &gradient)
                         : implicit_gradient(program, point, &gradient);
        double square = vec3_dot(gradient, gradient), room = solid->size * 0x1p-36;
        double error = solid->size * 2 * implicit_accuracy(solid);
        if (square > 0 && (fabs(off) < room * sqrt(square) || is_preview)) {
            /* One step along the gradient removes the rounding error of the ray, or what the tolerance allows. */
            point = vec3_add_scaled(point, gradient, -off / square);
        } else {
            error = room;
            describe_jump(solid, ray, point, crossing->enter, &gradient);
        }
        surface_make(out, point, usable_normal(gradient, ray, crossing->enter), error);
    }
    surface_mapping_sphere(implicit_middle(solid), out);
}

/* --- the solid --- */

const struct implicit *implicit_build(struct arena *arena, const struct implicit_input *in, struct error *error) {
    struct implicit *solid = arena_alloc(arena, sizeof *solid);
    if (!solid) {
        (void)error_no_memory(error, "an implicit solid");
        return NULL;
    }
    solid->in = *in;
    if (in->is_ball) {
        struct vec3 radius = vec3_all(in->radius);
        solid->in.bounds = (struct box){vec3_sub(in->centre, radius), vec3_add(in->centre, radius)};
    }
    /* Everything is measured in the size of the bounds. */
    for (int k = 0; k < 3; k++) {
        double lo = vec3_get(solid->in.bounds.min, k), hi = vec3_get(solid->in.bounds.max, k);
        if (!(lo < hi && hi - lo < HUGE_VAL)) {
            (void)error_set(error, ERROR_SCENE, "the bounds must have a length, a width and a height, and end");
            return NULL;
        }
        solid->size = hi - lo > solid->size ? hi - lo : solid->size;
    }
    /* At a point nothing else than the point is known. */
    for (int k = 0; k < in->program->input_count; k++)
        if (in->program->inputs[k].input > EXPR_POINT_Z) {
            (void)error_set(error, ERROR_SCENE, "the function reads %s, but a solid may depend only on p",
                            expr_input_name((enum expr_input)in->program->inputs[k].input));
            return NULL;
        }
    if (in->program->output_count != 1) {
        (void)error_set(error, ERROR_SCENE, "the function returns a colour; a solid needs one number, negative inside");
        return NULL;
    }
    return implicit_regions_build(arena, solid, error) ? solid : NULL;
}

const struct expr_program *implicit_program(const struct implicit *solid) {
    return solid->in.program;
}

struct box implicit_bounds(const struct implicit *solid) {
    return box_pad(solid->tight);
}

bool implicit_is_closed(const struct implicit *solid) {
    return !solid->in.open;
}

uint32_t implicit_scratch_need(const struct implicit *solid) {
    const size_t size = expr_lanes_size(solid->in.program);
    return GUESS + (size <= IMPLICIT_STACK ? 0 : (uint32_t)((size + IMPLICIT_ALIGNMENT) / sizeof(struct crossing)) + 1);
}

/* --- whether a Lipschitz bound holds, and whether bounds are too wide ---
 *
 * Points and lines are the same for all solids with the same bounds. */

enum { POINTS = 1000, LINES = 64 };
/* Operations for one line, and for all of them. */
static const uint64_t line_limit = 1000000, all_limit = 4000000;

/* Of slopes, relative. */
static const double rounding = 1e-6;

static struct vec3 random_point(const struct box *box, uint64_t index) {
    double u[3];
    for (uint64_t k = 0; k < 3; k++)
        u[k] = random_unit(random_combine(random_combine(18, index), k));
    return vec3_make(box->min.x + (box->max.x - box->min.x) * u[0], box->min.y + (box->max.y - box->min.y) * u[1],
                     box->min.z + (box->max.z - box->min.z) * u[2]);
}

/* |f| by the distance of a point where the sign is another one, if there is one among 16 points that |f| promises to
 * be of one sign, the first of them along the gradient; else 0. */
static double ratio_to_distance(const struct implicit *solid, struct vec3 point, double value, struct vec3 gradient,
                                uint64_t index) {
    const double radius = fabs(value) / solid->in.lipschitz;
    const struct box ball = {vec3_all(-1), vec3_all(1)};
    double ratio = 0;
    for (uint64_t k = 0; k < 16 && radius < solid->size; k++) {
        double share = k == 0 ? 1 : sqrt(random_unit(random_combine(random_combine(20, index), k)));
        struct vec3 direction = k == 0 ? vec3_scale(gradient, value < 0 ? 1 : -1) : random_point(&ball, 16 * index + k);
        struct vec3 other = vec3_add_scaled(point, vec3_normalize(direction), 0.999 * share * radius);
        double inputs[EXPR_INPUT_COUNT], outputs[EXPR_OUTPUTS];
        if (!box_contains(&solid->in.bounds, other))
            continue;
        for (int axis = 0; axis < 3; axis++)
            inputs[EXPR_POINT_X + axis] = vec3_get(other, axis);
        expr_evaluate(solid->in.program, inputs, outputs);
        if ((outputs[0] < 0) != (value < 0) && 1 / (0.999 * share) > ratio)
            ratio = 1 / (0.999 * share);
    }
    return ratio;
}

static void examine_point(const struct implicit *solid, struct vec3 point, struct implicit_findings *out) {
    struct vec3 gradient;
    double value = implicit_gradient(solid->in.program, point, &gradient), slope = vec3_length(gradient);
    out->is_empty = out->is_empty && !(value < 0);
    if (solid->in.is_distance)
        slope = ratio_to_distance(solid, point, value, gradient, out->points);
    out->points++;
    out->steep_points += slope > solid->in.lipschitz * (1 + rounding) && slope < INFINITY;
    if (slope > out->steepest && slope < INFINITY) {
        out->steepest = slope;
        out->steepest_at = point;
    }
}

/* Values at the centres of all regions, and slopes at every `stride`-th of them. */
static void examine_node(const struct implicit *solid, uint32_t node, const struct box *box, uint32_t stride,
                         struct implicit_findings *out) {
    const uint32_t value = solid->nodes[node], number = value >> 2;
    const struct vec3 middle = {region_middle(box->min.x, box->max.x), region_middle(box->min.y, box->max.y),
                                region_middle(box->min.z, box->max.z)};
    switch ((enum region_kind)(value & 3)) {
    case REGION_OUTSIDE:
        return;
    case REGION_INSIDE:
        out->is_empty = false;
        return;
    case REGION_SURFACE:
        out->is_empty = out->is_empty && !(solid->regions[number].middle_low < 0);
        if (number % stride == 0)
            examine_point(solid, middle, out);
        return;
    case REGION_SPLIT:
        /* Bit k of a number is the half along axis k. */
        for (uint32_t k = 0; k < 8; k++) {
            struct box part = *box;
            *(k & 1 ? &part.min.x : &part.max.x) = middle.x;
            *(k & 2 ? &part.min.y : &part.max.y) = middle.y;
            *(k & 4 ? &part.min.z : &part.max.z) = middle.z;
            examine_node(solid, number + k, &part, stride, out);
        }
        return;
    }
}

static bool examine_lines(const struct implicit *solid, double *work) {
    struct geom_scratch scratch;
    uint64_t sum = 0, lines = 0;
    if (!geom_scratch_init(&scratch, implicit_scratch_need(solid)))
        return false;
    while (lines < LINES && sum < all_limit) {
        const struct vec3 a = random_point(&solid->tight, 2 * lines), b = random_point(&solid->tight, 2 * lines + 1);
        const struct ray line = {.origin = a, .direction = vec3_sub(b, a), .t_min = -INFINITY, .t_max = INFINITY};
        sum += implicit_line_work(solid, &line, line_limit, &scratch);
        lines++;
        if (scratch.overflow && !geom_scratch_grow(&scratch)) {
            geom_scratch_destroy(&scratch);
            return false;
        }
    }
    *work = (double)sum / (double)lines;
    geom_scratch_destroy(&scratch);
    return true;
}

static void examine_points(const struct implicit *solid, struct implicit_findings *out) {
    for (uint64_t k = 0; k < POINTS; k++)
        examine_point(solid, random_point(&solid->in.bounds, k), out);
    examine_node(solid, 0, &solid->in.bounds, solid->region_count / POINTS + 1, out);
}

/* The same solid with the largest slope as its bound, rounded up to two digits. */
static bool try_marching(const struct implicit *solid, struct implicit_findings *out, struct error *error) {
    struct arena arena = {0};
    struct implicit_input in = solid->in;
    examine_points(solid, out);
    out->steep_points = 0;
    out->is_empty = false;
    if (!(out->steepest > 0))
        return true;
    double digit = 1;
    while (digit * 100 <= out->steepest)
        digit *= 10;
    while (digit * 10 > out->steepest)
        digit /= 10;
    in.lipschitz = out->lipschitz = ceil(out->steepest / digit) * digit;
    const struct implicit *marched = implicit_build(&arena, &in, error);
    bool ok = marched && (examine_lines(marched, &out->marched_work) || error_no_memory(error, "an implicit solid"));
    arena_destroy(&arena);
    return ok;
}

bool implicit_examine(const struct implicit *solid, struct implicit_findings *out, struct error *error) {
    *out = (struct implicit_findings){.is_empty = solid->in.lipschitz > 0};
    if (solid->in.lipschitz > 0) {
        examine_points(solid, out);
        return true;
    }
    if (!examine_lines(solid, &out->line_work))
        return error_no_memory(error, "an implicit solid");
    return out->line_work <= IMPLICIT_SLOW || try_marching(solid, out, error);
}

static void bundle_tables(struct bundle *bundle, void *tables) {
    struct implicit *implicit = tables;
    BUNDLE(bundle, implicit->in.program, 1, expr_program_bundle);
    BUNDLE(bundle, implicit->nodes, implicit->node_count, NULL);
    BUNDLE(bundle, implicit->regions, implicit->region_count, NULL);
    BUNDLE(bundle, implicit->programs, implicit->program_count, expr_program_bundle);
}

void implicit_bundle(struct bundle *bundle, const struct implicit **implicit) {
    BUNDLE(bundle, *implicit, 1, bundle_tables);
}
