/* The curve. Projected along the ray it is a plane curve p(x) with a width w(x); the ray meets the ribbon where the
 * curve is nearest and not farther than half the width: at local minima of p^2, roots of the polynomial p . p' of
 * degree 5 where its sign goes from - to +, with 2 |p| <= w. This is what the recursive bisection of Nakamaru and Ohno
 * ("Ray tracing for curves primitive", 2002; pbrt's Curve) converges to. At a corner between two pieces the corner
 * itself may be nearest. The ends are cut straight across.
 *
 * The point that is reported is where reflected rays start. A ray that leads away from the tangent plane of the round
 * hair, half a width from the middle, does not hit the ribbon again. Neither does one that starts half a width w above
 * a flat ribbon at x <= w/2 off the middle: at an angle a to the ribbon, towards the middle, the nearest approach is x
 * sin a + w/2 cos a away while it is ahead (tan a < 2 x / w), which is at least w/2. All this holds under affine maps,
 * because the point is mapped; an offset along the normal of the world would be too long or too short. */
#include "shape/curve.h"

#include "geometry/bernstein.h"
#include "shape/part_tree_internal.h"

#include <string.h>

#define FLAT 0.2
enum { DEEPEST = 6 };
/* The normal at the rim of a round hair is still on the side from which the ray comes. */
static const double rim = 0.5 - 0x1p-22;

struct curve_piece {
    double c[4][4]; /* Bezier points of x, y, z and the width */
    struct vec3 centre;
    double from, to;
    uint32_t before; /* the piece whose end is this one's beginning; its own number for the first */
};

struct curve {
    struct curve_piece *pieces;
    uint32_t count;
    bool flat;
    struct part_tree tree;
    struct box bounds;
};

static struct vec3 control(const struct curve_piece *piece, int k) {
    return vec3_make(piece->c[0][k], piece->c[1][k], piece->c[2][k]);
}

static struct vec3 curve_point(const struct curve_piece *piece, double x) {
    return vec3_make(cubic_value(piece->c[0], x), cubic_value(piece->c[1], x), cubic_value(piece->c[2], x));
}

/* Along the curve; where its derivative is zero, along the chord. */
static struct vec3 tangent(const struct curve_piece *piece, double x) {
    struct vec3 t = {cubic_slope(piece->c[0], x), cubic_slope(piece->c[1], x), cubic_slope(piece->c[2], x)};
    struct vec3 chord = vec3_sub(control(piece, 3), control(piece, 0));
    return vec3_max_abs(t) > 0x1p-30 * vec3_max_abs(chord) ? t : chord;
}

static bool is_flat(const struct curve_piece *piece) {
    struct vec3 chord = vec3_sub(control(piece, 3), control(piece, 0));
    double length = vec3_length(chord);
    for (int k = 1; k <= 2; k++)
        if (!(vec3_length(vec3_cross(vec3_sub(control(piece, k), control(piece, 0)), chord)) <= FLAT * length * length))
            return false;
    return true;
}

static void cut(struct curve *curve, bool write, const struct curve_piece *piece, int depth) {
    if (depth == DEEPEST || is_flat(piece)) {
        if (write) {
            curve->pieces[curve->count] = *piece;
            curve->pieces[curve->count].before = curve->count > 0 ? curve->count - 1 : 0;
        }
        curve->count++;
        return;
    }
    struct curve_piece left = *piece, right = *piece;
    for (int d = 0; d < 4; d++)
        bernstein_split(piece->c[d], 3, 0.5, left.c[d], right.c[d]);
    left.to = right.from = piece->from / 2 + piece->to / 2;
    cut(curve, write, &left, depth + 1);
    cut(curve, write, &right, depth + 1);
}

const struct curve *curve_build(struct arena *arena, const struct curve_input *in, struct error *error) {
    struct curve *curve = arena_alloc(arena, sizeof *curve);
    double(*points)[4] = arena_alloc_array(arena, (size_t)in->count + 1, sizeof *points);
    if (!curve || !points) {
        error_no_memory(error, "a curve");
        return NULL;
    }
    /* Places and widths are one curve in four dimensions. */
    for (uint32_t i = 0; i < in->count; i++) {
        for (int d = 0; d < 3; d++)
            points[i][d] = in->points[i][d];
        points[i][3] = in->widths[i];
        if (!(in->widths[i] >= 0)) {
            error_set(error, ERROR_SCENE, "width %u of the curve is %g, not at least 0", i + 1, in->widths[i]);
            return NULL;
        }
        for (int d = 0; d < 4; d++)
            if (!(fabs(points[i][d]) < 0x1p300)) {
                error_set(error, ERROR_SCENE, "point %u of the curve is not a usable number", i + 1);
                return NULL;
            }
    }
    struct spline_input spline = {.kind = in->kind, .dimensions = 4, .points = &points[0][0], .count = in->count};
    struct spline_segment *segments;
    uint32_t segment_count;
    if (!spline_build(arena, &spline, &segments, &segment_count, error))
        return NULL;
    curve->flat = in->flat;
    /* Segments are cut into pieces that are nearly straight: counted first, then stored. */
    for (int write = 0; write < 2; write++) {
        curve->count = 0;
        for (uint32_t i = 0; i < segment_count; i++) {
            struct curve_piece piece = {.from = (double)i / segment_count, .to = (double)(i + 1) / segment_count};
            memcpy(piece.c, segments[i].b, sizeof piece.c);
            cut(curve, write, &piece, 0);
        }
        if (!write)
            curve->pieces = arena_alloc_array(arena, curve->count, sizeof *curve->pieces);
        if (!curve->pieces)
            break;
    }
    struct box *boxes = arena_alloc_array(arena, curve->count, sizeof *boxes);
    if (!curve->pieces || !boxes) {
        error_no_memory(error, "a curve");
        return NULL;
    }
    /* Control points contain the curve, and half of the width is around it. */
    curve->bounds = box_empty();
    for (uint32_t i = 0; i < curve->count; i++) {
        struct curve_piece *piece = &curve->pieces[i];
        double widest = 0;
        boxes[i] = box_empty();
        for (int k = 0; k < 4; k++) {
            boxes[i] = box_add_point(boxes[i], control(piece, k));
            widest = math_max(widest, fabs(piece->c[3][k]));
        }
        boxes[i].min = vec3_sub(boxes[i].min, vec3_all(widest / 2));
        boxes[i].max = vec3_add(boxes[i].max, vec3_all(widest / 2));
        piece->centre = vec3_add(vec3_scale(boxes[i].min, 0.5), vec3_scale(boxes[i].max, 0.5));
        curve->bounds = box_join(curve->bounds, boxes[i]);
    }
    if (!part_tree_build(arena, boxes, curve->count, 1, &curve->tree)) {
        error_no_memory(error, "a curve");
        return NULL;
    }
    curve->bounds = box_pad(curve->bounds);
    return curve;
}

struct box curve_bounds(const struct curve *curve) {
    return curve->bounds;
}

bool curve_piece_tube(const struct curve *curve, uint32_t number, double tube[4][4]) {
    if (number >= curve->count)
        return false;
    memcpy(tube, curve->pieces[number].c, sizeof curve->pieces[number].c);
    for (int k = 0; k < 4; k++)
        tube[3][k] = fabs(tube[3][k]) / 2;
    return true;
}

void curve_extent(const struct curve *curve, struct vec3 g, double *lo, double *hi) {
    double half = vec3_length(g) / 2;
    *lo = INFINITY, *hi = -INFINITY;
    for (uint32_t i = 0; i < curve->count; i++) {
        const struct curve_piece *piece = &curve->pieces[i];
        for (int sign = -1; sign <= 1; sign += 2) {
            double sum[4];
            for (int k = 0; k < 4; k++)
                sum[k] = vec3_dot(g, control(piece, k)) + sign * half * piece->c[3][k];
            outline_range(sum, lo, hi);
        }
    }
}

uint32_t curve_scratch_need(const struct curve *curve) {
    return curve->count < 64 ? 3 * curve->count : 192;
}

static struct vec3 across(struct vec3 a, struct vec3 direction) {
    return vec3_add_scaled(a, direction, -vec3_dot(a, direction));
}

static bool offer(const struct curve_piece *piece, uint32_t part, double x, const struct line *line,
                  struct geom_scratch *scratch) {
    struct vec3 q = vec3_sub(curve_point(piece, x), line->origin);
    double s = vec3_dot(q, line->direction), width = fabs(cubic_value(piece->c[3], x));
    if (!(2 * vec3_length(vec3_add_scaled(q, line->direction, -s)) <= width))
        return true;
    return geom_scratch_push(scratch, (struct crossing){.t = s, .u = x, .part = part, .enter = true});
}

static bool piece_crossings(const void *shape, uint32_t part, const struct line *line, struct geom_scratch *scratch) {
    const struct curve *curve = shape;
    const struct curve_piece *piece = &curve->pieces[part];
    double shift = vec3_dot(vec3_sub(piece->centre, line->origin), line->direction);
    struct vec3 origin = line_at(line, shift), p[4], sum_p = {0, 0, 0};
    double widest = 0;
    for (int k = 0; k < 4; k++) {
        p[k] = across(vec3_sub(control(piece, k), origin), line->direction);
        widest = math_max(widest, fabs(piece->c[3][k]));
        sum_p = vec3_add(sum_p, p[k]);
    }
    /* All of it beyond a straight edge that is farther than the ribbon reaches. */
    struct vec3 outer = vec3_normalize(sum_p);
    double nearest = INFINITY;
    for (int k = 0; k < 4; k++)
        nearest = math_min(nearest, vec3_dot(p[k], outer));
    if (nearest > 0.5 * (1 + 0x1p-30) * widest)
        return true;
    /* A corner at the beginning: towards it on the piece before, away from it on this one. */
    if (piece->before != part) {
        struct vec3 t0 = tangent(&curve->pieces[piece->before], 1), t1 = tangent(piece, 0);
        bool towards = vec3_dot(p[0], across(t0, line->direction)) < 0,
             away = !(vec3_dot(p[0], across(t1, line->direction)) < 0);
        if (towards && away && !offer(piece, part, 0, line, scratch))
            return false;
    }
    double axis[4], slope[3], product[6], sum[6] = {0}, roots[5];
    for (int d = 0; d < 3; d++) {
        for (int k = 0; k < 4; k++)
            axis[k] = vec3_get(p[k], d);
        bernstein_derivative(axis, 3, slope);
        bernstein_multiply(axis, 3, slope, 2, product);
        for (int k = 0; k < 6; k++)
            sum[k] += product[k];
    }
    int count = bernstein_roots(sum, 5, roots);
    bool falling = sum[0] < 0;
    for (int k = 0; k < count; k++, falling = !falling)
        if (falling && !offer(piece, part, roots[k], line, scratch))
            return false;
    return true;
}

bool curve_crossings(const struct curve *curve, const struct ray *ray, struct geom_scratch *scratch,
                     struct crossing_list *out) {
    *out = (struct crossing_list){scratch->used, 0};
    struct line line;
    struct vec3 centre = vec3_add(vec3_scale(curve->bounds.min, 0.5), vec3_scale(curve->bounds.max, 0.5));
    if (!line_init(&line, ray, centre))
        return true;
    if (!part_tree_crossings(&curve->tree, &line, curve, piece_crossings, scratch))
        return false;
    line_finish_open(&line, scratch, out->first, out);
    return true;
}

void curve_describe(const struct curve *curve, const struct ray *ray, const struct crossing *crossing,
                    struct surface *out) {
    const struct curve_piece *piece = &curve->pieces[crossing->part];
    double x = crossing->u, width = fabs(cubic_value(piece->c[3], x));
    struct vec3 point = ray_at(ray, crossing->t), middle = curve_point(piece, x),
                direction = vec3_normalize(ray->direction);
    struct vec3 along = vec3_normalize(tangent(piece, x));
    struct vec3 facing = vec3_negate(across(direction, along));
    if (!(vec3_length(facing) > 0x1p-26)) /* the ray runs along the hair */
        facing = fabs(along.x) < 0.9 ? across(vec3_make(1, 0, 0), along) : across(vec3_make(0, 1, 0), along);
    facing = vec3_normalize(facing);
    struct vec3 side = vec3_cross(along, facing);
    double off = width > 0 ? vec3_dot(vec3_sub(point, middle), side) / width : 0;
    off = math_min(math_max(off, -rim), rim);
    struct vec3 round = vec3_add(vec3_scale(side, 2 * off), vec3_scale(facing, sqrt(1 - 4 * off * off)));
    struct vec3 normal = curve->flat ? facing : round;
    double size = math_max(vec3_max_abs(curve->bounds.min), vec3_max_abs(curve->bounds.max));
    *out = (struct surface){.point = vec3_add_scaled(curve->flat ? point : middle, normal, width / 2),
                            .normal = normal,
                            .shading_normal = normal,
                            .pattern_point = point,
                            .pattern_normal = normal,
                            .has_uv = true,
                            .error = 0x1p-46 * size + 0x1p-30 * width,
                            .behind = width / 2};
    out->u = piece->from + (piece->to - piece->from) * x;
    out->v = 0.5 - off;
    out->dpdu = vec3_scale(tangent(piece, x), 1 / (piece->to - piece->from));
    out->dpdv = vec3_scale(side, -width);
}

static void bundle_tables(struct bundle *bundle, void *tables) {
    struct curve *curve = tables;
    BUNDLE(bundle, curve->pieces, curve->count, NULL);
    part_tree_bundle(bundle, &curve->tree);
}

void curve_bundle(struct bundle *bundle, const struct curve **curve) {
    BUNDLE(bundle, *curve, 1, bundle_tables);
}
