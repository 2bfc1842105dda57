/* The footprint of a ray is a parallelogram in the tangent plane of the hit: as wide as the ray's cone across the view,
 * and stretched along the view by the inclination of the surface. The inputs of a function are linear on it. Bounds of
 * the function over the footprint (expr/expr_interval.h) determine the number of points: one where the function hardly
 * changes, up to 16 where it may have a detail smaller than the footprint. (Bounds that limit the samples of a
 * procedural texture: W. Heidrich, P. Slusallek and H.-P. Seidel, "Sampling procedural shaders using affine
 * arithmetic", TOG 1998.) The points are those of Hammersley, centred: each has its own row and column. */
#include "material/texture_function_internal.h"

#include "expr/expr_derivative.h"
#include "material/texture_mapping_internal.h"
#include "math/frame.h"

#include <string.h>

/* MAX_STRETCH: of a footprint at a grazing angle. BATCH_POINTS: from so many points on a batch is faster. Programs that
 * need more memory on the stack have no batches, and no bounds of slopes. */
enum { MAX_STRETCH = 64, BATCH_POINTS = 4, BATCH_REGISTERS = 253, SLOPE_MEMORY = 1 << 16 };

/* The change of the inputs along axes, as seeds of derivatives. */
typedef double input_slopes[EXPR_INPUT_COUNT][EXPR_DIRECTIONS];

/* The inputs on the footprint: at its middle, and from side to side. */
struct region {
    double inputs[EXPR_INPUT_COUNT];
    input_slopes slopes;
    enum texture_mapping mapping; /* of u and v */
};

/* The plane of the hit that the tangents of the pattern span: their lengths and their angle in world space. */
struct tangents {
    struct vec3 a, b; /* pattern space, unit vectors */
    double aa, ab, bb, determinant;
};

static bool tangents_at(const struct hit *hit, struct tangents *out) {
    out->aa = vec3_length_squared(hit->along_a);
    out->bb = vec3_length_squared(hit->along_b);
    out->ab = vec3_dot(hit->along_a, hit->along_b);
    out->determinant = out->aa * out->bb - out->ab * out->ab;
    frame_tangents(vec3_normalize(hit->pattern_normal), &out->a, &out->b);
    return out->determinant > 0 && isfinite(out->determinant);
}

/* A world vector of the tangent plane in pattern space. */
static struct vec3 to_pattern(const struct tangents *tangents, const struct hit *hit, struct vec3 step) {
    double wa = vec3_dot(step, hit->along_a), wb = vec3_dot(step, hit->along_b);
    double a = (tangents->bb * wa - tangents->ab * wb) / tangents->determinant;
    double b = (tangents->aa * wb - tangents->ab * wa) / tangents->determinant;
    return vec3_add(vec3_scale(tangents->a, a), vec3_scale(tangents->b, b));
}

/* The parallelogram that the cone of the ray covers: world vectors from side to side. */
static void footprint_axes(const struct hit *hit, struct vec3 axes[2]) {
    struct vec3 n = hit->normal_geometric;
    double cosine = vec3_dot(n, hit->view);
    struct vec3 along = vec3_add_scaled(hit->view, n, -cosine);
    if (vec3_length_squared(along) > 1e-12)
        along = vec3_normalize(along);
    else
        frame_tangents(n, &along, &axes[1]);
    axes[0] = vec3_scale(along, hit->footprint * math_min(1 / fabs(cosine), MAX_STRETCH));
    axes[1] = vec3_scale(vec3_cross(n, along), hit->footprint);
}

/* The values at the hit. u and v are those of images, v from below. at: the coordinates, or NULL for none. */
static void inputs_at(const struct hit *hit, const struct texcoord *at, double out[EXPR_INPUT_COUNT]) {
    const struct vec3 *p = &hit->pattern_point, *n = &hit->normal, *v = &hit->view, *w = &hit->point;
    const double inputs[EXPR_INPUT_COUNT] = {p->x, p->y, p->z, at ? at->u : 0, at ? 1 - at->v : 0,
                                             n->x, n->y, n->z, v->x,           v->y,
                                             v->z, w->x, w->y, w->z,           hit->time};
    for (int k = 0; k < EXPR_INPUT_COUNT; k++)
        out[k] = inputs[k];
}

/* Writes axis `k` of the slopes: a step in world space, and in pattern space. Normal, view and time do not change. */
static void slopes_along(const struct texcoord *at, int k, struct vec3 world, struct vec3 pattern, input_slopes out) {
    out[EXPR_POINT_X][k] = pattern.x;
    out[EXPR_POINT_Y][k] = pattern.y;
    out[EXPR_POINT_Z][k] = pattern.z;
    out[EXPR_WORLD_X][k] = world.x;
    out[EXPR_WORLD_Y][k] = world.y;
    out[EXPR_WORLD_Z][k] = world.z;
    if (!at)
        return;
    double uu = vec3_length_squared(at->dpdu), vv = vec3_length_squared(at->dpdv), uv = vec3_dot(at->dpdu, at->dpdv);
    double determinant = uu * vv - uv * uv, wu = vec3_dot(world, at->dpdu), wv = vec3_dot(world, at->dpdv);
    if (!(determinant > 0) || !isfinite(determinant))
        return;
    out[EXPR_U][k] = (vv * wu - uv * wv) / determinant;
    out[EXPR_V][k] = -(uu * wv - uv * wu) / determinant;
}

static const struct texcoord *coordinates_at(const struct texture_operation *texture, const struct hit *hit,
                                             struct texcoord *at) {
    const struct texture_image image = {.mapping = texture->recorded.mapping, .wrap = IMAGE_REPEAT};
    return texture->recorded.has_coordinates && texture_coordinates(&image, hit, at) ? at : NULL;
}

/* The inputs at the hit, with a region of size 0. */
static void region_at(const struct texture_operation *texture, const struct hit *hit, const struct texcoord *at,
                      const struct tangents *tangents, struct region *out) {
    inputs_at(hit, at, out->inputs);
    memset(out->slopes, 0, sizeof out->slopes);
    out->mapping = texture->recorded.mapping;
    if (!(hit->footprint > 0))
        return;
    struct vec3 axes[2];
    footprint_axes(hit, axes);
    for (int k = 0; k < 2; k++)
        slopes_along(at, k, axes[k], to_pattern(tangents, hit, axes[k]), out->slopes);
}

/* --- the number of points --- */

static void box_of(const struct expr_program *program, const struct region *region,
                   struct expr_interval out[EXPR_INPUT_COUNT]) {
    for (int k = 0; k < program->input_count; k++) {
        int input = program->inputs[k].input;
        double middle = region->inputs[input];
        double radius = 0.5 * (fabs(region->slopes[input][0]) + fabs(region->slopes[input][1]));
        out[input] = (struct expr_interval){middle - radius, middle + radius, false};
    }
}

/* The number of points for which the standard error of the mean is below 1/27 if the values are uniform between the
 * bounds. The bounds are usually two or three times too wide. Values above 1 count relative to their magnitude. */
static int points_for(struct expr_interval bounds, int max) {
    double size = math_max(math_max(fabs(bounds.low), fabs(bounds.high)), 1),
           width = 8 * (bounds.high - bounds.low) / size;
    int count = 1;
    while (count < max && !(width * width <= count))
        count *= 2;
    return count;
}

static int count_points(const struct texture_operation *texture, const struct region *region) {
    const struct expr_program *program = texture->recorded.program;
    struct expr_interval box[EXPR_INPUT_COUNT], bounds[EXPR_OUTPUTS];
    _Alignas(64) struct expr_interval rows[EXPR_VALUES];
    int count = 1;
    box_of(program, region, box);
    expr_evaluate_interval(program, box, bounds, NULL, rows);
    for (int k = 0; k < program->output_count; k++) {
        int wanted = points_for(bounds[k], texture->recorded.points);
        count = wanted > count ? wanted : count;
    }
    return count;
}

/* --- points --- */

/* The positions of the points along each axis, between -1/2 and 1/2. */
struct points {
    double along[FUNCTION_POINTS], across[FUNCTION_POINTS];
    int count;
};

/* count: a power of two. */
static void points_make(int count, struct points *out) {
    out->count = count;
    for (int i = 0; i < count; i++) {
        int reversed = 0;
        for (int bit = 1, low = count / 2; bit < count; bit *= 2, low /= 2)
            reversed += i & bit ? low : 0;
        out->along[i] = (i + 0.5) / count - 0.5;
        out->across[i] = (reversed + 0.5) / count - 0.5;
    }
}

/* u and v stay within the ball or the face. */
static double fold(const struct region *region, int input, double x) {
    if (x >= 0 && x <= 1)
        return x;
    bool wraps = input == EXPR_U && region->mapping != MAPPING_FACES;
    return wraps ? x - floor(x) : x > 1 ? 1 : 0;
}

/* The values of an input at the points. */
static void spread(const struct region *region, int input, const struct points *points, double *out) {
    double middle = region->inputs[input], along = region->slopes[input][0], across = region->slopes[input][1];
    bool folds = (input == EXPR_U || input == EXPR_V) && region->mapping != MAPPING_UV;
    for (int i = 0; i < points->count; i++)
        out[i] = middle + (points->along[i] * along + points->across[i] * across);
    for (int i = 0; i < points->count && folds; i++)
        out[i] = fold(region, input, out[i]);
}

static bool is_before(const double a[3], const double b[3]) {
    for (int k = 0; k < 3; k++)
        if (a[k] != b[k])
            return a[k] < b[k];
    return false;
}

/* NaN counts as 0 and is reported with the pattern point of the hit. */
static double not_nan(const struct texture_operation *texture, const struct region *region, double x) {
    struct texture_nan *nan = texture->recorded.nan;
    const double *point = &region->inputs[EXPR_POINT_X];
    if (x == x)
        return x;
    if (!nan)
        return 0;
#ifdef GRAY_DEVICE
    nan->found = true; /* a processor finds out where */
#else
    while (atomic_flag_test_and_set_explicit(&nan->lock, memory_order_acquire))
        continue;
    if (!nan->found || is_before(point, nan->point))
        memcpy(nan->point, point, sizeof nan->point);
    nan->found = true;
    atomic_flag_clear_explicit(&nan->lock, memory_order_release);
#endif
    return 0;
}

static void evaluate_each(const struct expr_program *program, const double *const from[EXPR_INPUT_COUNT], int count,
                          double *const to[EXPR_OUTPUTS]) {
    for (int i = 0; i < count; i++) {
        double inputs[EXPR_INPUT_COUNT], outputs[EXPR_OUTPUTS];
        for (int k = 0; k < program->input_count; k++)
            inputs[program->inputs[k].input] = from[program->inputs[k].input][i];
        expr_evaluate(program, inputs, outputs);
        for (int k = 0; k < program->output_count; k++)
            to[k][i] = outputs[k];
    }
}

/* The sums of the outputs at the points; NaN counts as 0. */
static void sum_points(const struct texture_operation *texture, const struct region *region, int count,
                       double sums[3]) {
    const struct expr_program *program = texture->recorded.program;
    double inputs[EXPR_INPUT_COUNT][FUNCTION_POINTS], values[EXPR_OUTPUTS][FUNCTION_POINTS];
    const double *from[EXPR_INPUT_COUNT];
    double *to[EXPR_OUTPUTS];
    struct points points;
    points_make(count, &points);
    for (int k = 0; k < program->input_count; k++) {
        int input = program->inputs[k].input;
        spread(region, input, &points, inputs[input]);
        from[input] = inputs[input];
    }
    for (int k = 0; k < EXPR_OUTPUTS; k++)
        to[k] = values[k];
    if (count >= BATCH_POINTS && program->row_count <= BATCH_REGISTERS) {
        _Alignas(64) double rows[(BATCH_REGISTERS + 3) * EXPR_BATCH];
        expr_evaluate_batch(program, (uint32_t)count, from, to, rows);
    } else {
        evaluate_each(program, from, count, to);
    }
    for (int k = 0; k < program->output_count; k++)
        for (int i = 0; i < count; i++)
            sums[k] += not_nan(texture, region, values[k][i]);
}

struct colour texture_function_colour(const struct texture_operation *texture, const struct hit *hit) {
    const struct expr_program *program = texture->recorded.program;
    struct texcoord coordinates;
    const struct texcoord *at = coordinates_at(texture, hit, &coordinates);
    struct tangents tangents;
    struct region region;
    double sums[3] = {0, 0, 0};
    int count = 1;
    if (hit->footprint > 0 && texture->recorded.points > 1 && tangents_at(hit, &tangents)) {
        region_at(texture, hit, at, &tangents, &region);
        count = count_points(texture, &region);
    } else {
        inputs_at(hit, at, region.inputs);
    }
    if (count > 1) {
        sum_points(texture, &region, count, sums);
    } else {
        double outputs[EXPR_OUTPUTS];
        expr_evaluate(program, region.inputs, outputs);
        for (int k = 0; k < program->output_count; k++)
            sums[k] = not_nan(texture, &region, outputs[k]);
    }
    if (program->output_count == 1)
        return colour_all(sums[0] / count);
    return colour_make(sums[0] / count, sums[1] / count, sums[2] / count);
}

/* --- slopes --- */

/* The number of points for the mean slope; 0: the function may be discontinuous. */
static int count_slope_points(const struct texture_operation *texture, const struct region *region,
                              const struct expr_directions *directions, double height) {
    const struct expr_program *program = texture->recorded.program;
    struct expr_interval box[EXPR_INPUT_COUNT];
    struct expr_range ranges[EXPR_OUTPUTS];
    _Alignas(64) unsigned char rows[SLOPE_MEMORY];
    int count = 1;
    box_of(program, region, box);
    expr_evaluate_slopes(program, box, directions, ranges, NULL, rows);
    for (int k = 0; k < program->output_count; k++) {
        for (int d = 0; d < directions->count; d++) {
            struct expr_interval slope = ranges[k].slopes[d];
            if (ranges[k].is_nan || slope.may_be_nan || !isfinite(slope.low) || !isfinite(slope.high))
                return 0;
            double p = height * slope.low, q = height * slope.high;
            int wanted =
                points_for((struct expr_interval){math_min(p, q), math_max(p, q), false}, texture->recorded.points);
            count = wanted > count ? wanted : count;
        }
    }
    return count;
}

static struct expr_directions tangent_seeds(const struct texcoord *at, const struct hit *hit,
                                            const struct tangents *tangents) {
    struct expr_directions out = {.count = 2};
    slopes_along(at, 0, hit->along_a, tangents->a, out.seeds);
    slopes_along(at, 1, hit->along_b, tangents->b, out.seeds);
    return out;
}

static void sum_gradients(const struct expr_program *program, const struct region *region,
                          const struct expr_directions *directions, int count, double sums[2]) {
    double inputs[EXPR_INPUT_COUNT][FUNCTION_POINTS];
    struct points points;
    points_make(count, &points);
    for (int k = 0; k < program->input_count; k++)
        spread(region, program->inputs[k].input, &points, inputs[program->inputs[k].input]);
    for (int i = 0; i < count; i++) {
        double moved[EXPR_INPUT_COUNT], outputs[EXPR_OUTPUTS], gradients[EXPR_OUTPUTS][EXPR_DIRECTIONS];
        _Alignas(64) unsigned char rows[SLOPE_MEMORY];
        for (int k = 0; k < program->input_count; k++)
            moved[program->inputs[k].input] = inputs[program->inputs[k].input][i];
        expr_evaluate_gradient(program, moved, directions->seeds, outputs, gradients, rows);
        for (int k = 0; k < program->output_count; k++)
            for (int d = 0; d < 2; d++)
                sums[d] += gradients[k][d] / program->output_count;
    }
}

bool texture_function_slopes(const struct texture_operation *texture, const struct hit *hit, double height,
                             double slopes[2]) {
    const struct expr_program *program = texture->recorded.program;
    struct texcoord coordinates;
    const struct texcoord *at = coordinates_at(texture, hit, &coordinates);
    struct tangents tangents;
    struct region region;
    double sums[2] = {0, 0};
    if (expr_slopes_size(program) > SLOPE_MEMORY || expr_gradient_size(program) > SLOPE_MEMORY ||
        !tangents_at(hit, &tangents))
        return false;
    const struct expr_directions directions = tangent_seeds(at, hit, &tangents);
    region_at(texture, hit, at, &tangents, &region);
    int count = count_slope_points(texture, &region, &directions, height);
    if (count == 0)
        return false;
    sum_gradients(program, &region, &directions, count, sums);
    if (!isfinite(sums[0]) || !isfinite(sums[1]))
        return false;
    slopes[0] = height * sums[0] / count;
    slopes[1] = height * sums[1] / count;
    return true;
}
