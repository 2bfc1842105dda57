#include "geometry/inset.h"

#include "math/portable.h"

#include <math.h>

static const double straight_turn = 1e-9; /* sine of an angle that is none */

static bool too_large(double distance, const double at[2], struct error *error) {
    return error_set(error, ERROR_SCENE, "edge (%g) is too large for the outline near {%g, %g}", distance, at[0],
                     at[1]);
}

static double length_of(double x, double y) {
    return sqrt(x * x + y * y);
}

/* The unit vector from one point to the other; the distance of the points. */
static double direction_of(const double from[2], const double to[2], double out[2]) {
    double x = to[0] - from[0], y = to[1] - from[1], length = length_of(x, y);
    out[0] = x / length;
    out[1] = y / length;
    return length;
}

bool inset_corners(const double (*points)[2], uint32_t count, bool left, double distance, struct inset_corner *corners,
                   struct error *error) {
    const double side = left ? 1 : -1;
    for (uint32_t i = 0; i < count; i++) {
        const double *at = points[i], *previous = points[(i + count - 1) % count], *next = points[(i + 1) % count];
        double in[2], out[2];
        struct inset_corner *corner = &corners[i];
        double shorter = math_min(direction_of(previous, at, in), direction_of(at, next, out));
        /* The tangent of half the turn: so far, in distances, the line moves along itself to the new corner. */
        double sine = side * (in[0] * out[1] - in[1] * out[0]), cosine = in[0] * out[0] + in[1] * out[1];
        double half = sine / (1 + cosine);
        if (!(fabs(half) * distance <= shorter) && (half > 0 || !isfinite(half)))
            return too_large(distance, at, error);
        const double along[2] = {half * distance * in[0], half * distance * in[1]};
        corner->convex = half > straight_turn && (at[0] - along[0] != at[0] || at[1] - along[1] != at[1]);
        for (int k = 0; k < 2; k++) {
            double normal = side * (k == 0 ? -in[1] : in[0]);
            corner->inner[k] = at[k] - along[k] + distance * normal;
            corner->before[k] = corner->convex ? at[k] - along[k] : at[k];
            corner->after[k] = corner->convex ? at[k] + half * distance * out[k] : at[k];
        }
    }
    /* Lines that became shorter keep their direction. */
    for (uint32_t i = 0; i < count; i++) {
        const struct inset_corner *a = &corners[i], *b = &corners[(i + 1) % count];
        double along[2];
        (void)direction_of(points[i], points[(i + 1) % count], along);
        if (!((b->inner[0] - a->inner[0]) * along[0] + (b->inner[1] - a->inner[1]) * along[1] > 0))
            return too_large(distance, points[i], error);
    }
    return true;
}

bool inset_is_clear(const double (*points)[2], uint32_t count, const double point[2], double distance) {
    for (uint32_t i = 0; i < count; i++) {
        const double *a = points[i], *b = points[(i + 1) % count];
        double along[2], length = direction_of(a, b, along);
        double x = point[0] - a[0], y = point[1] - a[1];
        double s = math_min(math_max(x * along[0] + y * along[1], 0), length);
        if (length_of(x - s * along[0], y - s * along[1]) < distance * (1 - 0x1p-20))
            return false;
    }
    return true;
}

/* --- smooth curves --- */

/* A part of a segment, from t0 to t1. */
struct curve_part {
    const struct spline_segment *segment;
    double t0, t1;
};

static double second(const double b[4], double t) {
    return 6 * ((1 - t) * (b[2] - 2 * b[1] + b[0]) + t * (b[3] - 2 * b[2] + b[1]));
}

/* A point of the moved curve and its derivative. False: the curve stands still or turns too sharply there. */
static bool moved(const struct spline_segment *segment, double t, double distance, double point[2], double slope[2]) {
    const double *x = segment->b[0], *y = segment->b[1];
    double dx = cubic_slope(x, t), dy = cubic_slope(y, t), speed = length_of(dx, dy);
    double bend = (dx * second(y, t) - dy * second(x, t)) / (speed * speed * speed);
    point[0] = cubic_value(x, t) - distance * dy / speed;
    point[1] = cubic_value(y, t) + distance * dx / speed;
    slope[0] = dx * (1 - bend * distance);
    slope[1] = dy * (1 - bend * distance);
    return speed > 0 && bend * distance < 0.95;
}

/* Bezier points of a part by its ends and the derivatives there. */
static bool fit(const struct curve_part *part, double distance, double out[4][2]) {
    double step = (part->t1 - part->t0) / 3, slope0[2], slope1[2];
    if (!moved(part->segment, part->t0, distance, out[0], slope0) ||
        !moved(part->segment, part->t1, distance, out[3], slope1))
        return false;
    for (int k = 0; k < 2; k++) {
        out[1][k] = out[0][k] + step * slope0[k];
        out[2][k] = out[3][k] - step * slope1[k];
    }
    return true;
}

/* How far the fit is from the moved curve. */
static double error_of_fit(const struct curve_part *part, double distance, const double fitted[4][2]) {
    double worst = 0;
    for (int i = 1; i < 4; i++) {
        double t = i / 4.0, point[2], slope[2], at[2];
        (void)moved(part->segment, part->t0 + t * (part->t1 - part->t0), distance, point, slope);
        for (int k = 0; k < 2; k++) {
            const double b[4] = {fitted[0][k], fitted[1][k], fitted[2][k], fitted[3][k]};
            at[k] = cubic_value(b, t) - point[k];
        }
        /* Across the curve: along it the fit may be ahead. */
        worst = math_max(worst, fabs(at[0] * slope[1] - at[1] * slope[0]) / length_of(slope[0], slope[1]));
    }
    return worst;
}

static bool is_smooth(const struct spline_segment *a, const struct spline_segment *b) {
    double in[2] = {cubic_slope(a->b[0], 1), cubic_slope(a->b[1], 1)};
    double out[2] = {cubic_slope(b->b[0], 0), cubic_slope(b->b[1], 0)};
    double sine = in[0] * out[1] - in[1] * out[0], cosine = in[0] * out[0] + in[1] * out[1];
    return cosine > 0 && fabs(sine) <= 1e-6 * cosine;
}

bool inset_curve(struct arena *arena, const struct spline_segment *segments, uint32_t count, double to_left,
                 struct inset_points *points, struct error *error) {
    enum { PARTS_LIMIT = 64 };
    const double distance = fabs(to_left);
    double(*out)[2] = arena_alloc_array(arena, (size_t)count * PARTS_LIMIT * 3, sizeof *out);
    uint32_t made = 0;
    if (!out)
        return error_no_memory(error, "a prism");
    for (uint32_t i = 0; i < count; i++) {
        const struct spline_segment *segment = &segments[i];
        const double at[2] = {segment->b[0][3], segment->b[1][3]};
        if (!is_smooth(segment, &segments[(i + 1) % count]))
            return error_set(error, ERROR_SCENE,
                             "edge needs a smooth curve or straight lines, and the outline has a "
                             "corner at {%g, %g}",
                             at[0], at[1]);
        for (uint32_t parts = 1;; parts *= 2) {
            double worst = 0, fitted[4][2];
            double near[2];
            bool ok = true;
            for (uint32_t k = 0; k < parts && ok; k++) {
                for (int j = 0; j < 2; j++)
                    near[j] = cubic_value(segment->b[j], (double)k / parts);
                const struct curve_part part = {segment, (double)k / parts, (double)(k + 1) / parts};
                ok = fit(&part, to_left, fitted);
                if (ok)
                    worst = math_max(worst, error_of_fit(&part, to_left, (const double(*)[2])fitted));
                for (int j = 0; ok && j < 3; j++) {
                    out[made + 3 * k + (uint32_t)j][0] = fitted[j][0];
                    out[made + 3 * k + (uint32_t)j][1] = fitted[j][1];
                }
            }
            if (!ok || (worst > 1e-6 * distance && 2 * parts > PARTS_LIMIT))
                return too_large(distance, near, error);
            if (worst <= 1e-6 * distance) {
                made += 3 * parts;
                break;
            }
        }
    }
    *points = (struct inset_points){out, made};
    return true;
}
