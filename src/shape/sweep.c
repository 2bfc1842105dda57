/* The sphere sweep. Seen from the line, ball x of the path covers the stretch b(x) -+ sqrt(D(x)), where b is its
 * centre's place along the line, D = R^2 - p^2, p its distance from the line. D is a polynomial of degree 6 (2 for
 * straight pieces); between two of its roots the balls that the line meets follow each other without a gap, so what
 * they cover is one stretch, from the least b - sqrt(D) to the greatest b + sqrt(D) there. These lie at the ends or
 * where 4 b'^2 D = D'^2, the polynomial of degree 10 that is known from van Wijk, "Ray tracing objects defined by
 * sweeping a sphere" (Eurographics 1984). A place that is a little wrong costs s only the square of the error, and one
 * root too many costs nothing, since the least of all candidates is taken: so the envelope needs no care for double
 * roots, and it has no inner walls, which the equation of the envelope would add. The stretches of all pieces are
 * united. Each piece is solved from the point of the line next to it; D is evaluated as (R - p)(R + p) at the end. */
#include "shape/sweep.h"

#include "geometry/bernstein.h"
#include "math/elementary.h"
#include "shape/part_tree_internal.h"

#include <string.h>

#define FLAT 0.25
enum { DEEPEST = 6 };

struct sweep_piece {
    double c[4][4];           /* Bezier points of x, y, z and the radius */
    struct vec3 centre;       /* of its box */
    struct vec3 side0, side1; /* where u = 0 points, at both ends */
    double from, to;          /* part of the path */
    bool straight;
};

struct sweep_path {
    struct sweep_piece *pieces;
    uint32_t count;
    struct part_tree tree;
    struct box bounds;
};

/* ---- building ---- */

static struct vec3 centre_at(const struct sweep_piece *piece, double x) {
    return vec3_make(cubic_value(piece->c[0], x), cubic_value(piece->c[1], x), cubic_value(piece->c[2], x));
}

static struct vec3 tangent_at(const struct sweep_piece *piece, double x) {
    struct vec3 t = {cubic_slope(piece->c[0], x), cubic_slope(piece->c[1], x), cubic_slope(piece->c[2], x)};
    struct vec3 chord = vec3_sub(centre_at(piece, 1), centre_at(piece, 0));
    return vec3_max_abs(t) > 0x1p-30 * vec3_max_abs(chord) ? t : chord;
}

static bool is_flat(const struct sweep_piece *piece) {
    struct vec3 a = centre_at(piece, 0), chord = vec3_sub(centre_at(piece, 1), a);
    double length = vec3_length(chord);
    for (int k = 1; k <= 2; k++) {
        struct vec3 inner = vec3_sub(vec3_make(piece->c[0][k], piece->c[1][k], piece->c[2][k]), a);
        if (!(vec3_length(vec3_cross(inner, chord)) <= FLAT * length * length))
            return false;
    }
    return true;
}

static void cut(struct sweep_path *sweep, bool write, const struct sweep_piece *piece, int depth) {
    if (piece->straight || depth == DEEPEST || is_flat(piece)) {
        if (write)
            sweep->pieces[sweep->count] = *piece;
        sweep->count++;
        return;
    }
    struct sweep_piece left = *piece, right = *piece;
    for (int d = 0; d < 4; d++)
        bernstein_split(piece->c[d], 3, 0.5, left.c[d], right.c[d]);
    left.to = right.from = piece->from / 2 + piece->to / 2;
    cut(sweep, write, &left, depth + 1);
    cut(sweep, write, &right, depth + 1);
}

/* Least and greatest of centre -+ radius along one axis. */
static void extent(const double c[4], const double r[4], double *lo, double *hi) {
    *lo = INFINITY, *hi = -INFINITY;
    for (int sign = -1; sign <= 1; sign += 2) {
        double sum[4];
        for (int k = 0; k < 4; k++)
            sum[k] = c[k] + sign * r[k];
        outline_range(sum, lo, hi);
    }
}

/* Carries the direction of u = 0 along the path with least turning (Wang, Juettler, Zheng, Liu, "Computation of
 * rotation minimizing frames", ACM TOG 2008: two reflections per step). */
static void carry_sides(struct sweep_path *sweep) {
    struct vec3 t = vec3_normalize(tangent_at(&sweep->pieces[0], 0));
    struct vec3 axis = fabs(t.y) < 0.9 ? vec3_make(0, 1, 0) : vec3_make(1, 0, 0);
    struct vec3 side = vec3_normalize(vec3_sub(axis, vec3_scale(t, vec3_dot(axis, t))));
    for (uint32_t i = 0; i < sweep->count; i++) {
        struct sweep_piece *piece = &sweep->pieces[i];
        struct vec3 a = tangent_at(piece, 0), b = vec3_normalize(tangent_at(piece, 1));
        struct vec3 chord = vec3_sub(centre_at(piece, 1), centre_at(piece, 0));
        a = vec3_normalize(a);
        side = vec3_sub(side, vec3_scale(a, vec3_dot(a, side)));
        if (!(vec3_max_abs(side) > 0x1p-20)) { /* a corner that turned it into the path */
            struct vec3 other = fabs(a.y) < 0.9 ? vec3_make(0, 1, 0) : vec3_make(1, 0, 0);
            side = vec3_sub(other, vec3_scale(a, vec3_dot(other, a)));
        }
        side = piece->side0 = vec3_normalize(side);
        double cc = vec3_dot(chord, chord);
        if (cc > 0) {
            struct vec3 s1 = vec3_add_scaled(side, chord, -2 * vec3_dot(chord, side) / cc);
            struct vec3 t1 = vec3_add_scaled(a, chord, -2 * vec3_dot(chord, a) / cc);
            struct vec3 w = vec3_sub(b, t1);
            double ww = vec3_dot(w, w);
            side = ww > 0 ? vec3_add_scaled(s1, w, -2 * vec3_dot(w, s1) / ww) : s1;
        }
        side = piece->side1 = vec3_normalize(side);
    }
}

const struct sweep_path *sweep_build(struct arena *arena, const struct sweep_input *in, struct error *error) {
    struct sweep_path *sweep = arena_alloc(arena, sizeof *sweep);
    double(*points)[4] = arena_alloc_array(arena, (size_t)in->count + 1, sizeof *points);
    if (!sweep || !points) {
        error_no_memory(error, "a sweep");
        return NULL;
    }
    /* Centres and radii are one curve in four dimensions. */
    double widest = 0;
    for (uint32_t i = 0; i < in->count; i++) {
        for (int d = 0; d < 3; d++)
            points[i][d] = in->points[i][d];
        points[i][3] = in->radii[i];
        widest = math_max(widest, in->radii[i]);
        if (!(in->radii[i] >= 0)) {
            error_set(error, ERROR_SCENE, "radius %u of the sweep is %g, not at least 0", i + 1, in->radii[i]);
            return NULL;
        }
        for (int d = 0; d < 4; d++)
            if (!isfinite(points[i][d]) || fabs(points[i][d]) > 0x1p300) {
                error_set(error, ERROR_SCENE, "point %u of the sweep is not a usable number", i + 1);
                return NULL;
            }
    }
    if (!(widest > 0)) {
        error_set(error, ERROR_SCENE, "all radii of the sweep are 0");
        return NULL;
    }
    struct spline_input spline = {
        .kind = in->kind, .dimensions = 4, .points = &points[0][0], .count = in->count, .closed = in->loop};
    struct spline_segment *segments;
    uint32_t segment_count;
    if (!spline_build(arena, &spline, &segments, &segment_count, error))
        return NULL;
    /* Segments are cut into pieces that are nearly straight: counted first, then stored. */
    for (int write = 0; write < 2; write++) {
        sweep->count = 0;
        for (uint32_t i = 0; i < segment_count; i++) {
            struct sweep_piece piece = {.from = (double)i / segment_count, .to = (double)(i + 1) / segment_count};
            memcpy(piece.c, segments[i].b, sizeof piece.c);
            piece.straight = in->kind == SPLINE_LINEAR;
            cut(sweep, write, &piece, 0);
        }
        if (!write)
            sweep->pieces = arena_alloc_array(arena, sweep->count, sizeof *sweep->pieces);
        if (!sweep->pieces)
            break;
    }
    struct box *boxes = arena_alloc_array(arena, sweep->count, sizeof *boxes);
    if (!sweep->pieces || !boxes) {
        error_no_memory(error, "a sweep");
        return NULL;
    }
    /* A piece lies in the box around its spheres. */
    sweep->bounds = box_empty();
    for (uint32_t i = 0; i < sweep->count; i++) {
        struct sweep_piece *piece = &sweep->pieces[i];
        extent(piece->c[0], piece->c[3], &boxes[i].min.x, &boxes[i].max.x);
        extent(piece->c[1], piece->c[3], &boxes[i].min.y, &boxes[i].max.y);
        extent(piece->c[2], piece->c[3], &boxes[i].min.z, &boxes[i].max.z);
        piece->centre = vec3_add(vec3_scale(boxes[i].min, 0.5), vec3_scale(boxes[i].max, 0.5));
        sweep->bounds = box_join(sweep->bounds, boxes[i]);
    }
    carry_sides(sweep);
    if (!part_tree_build(arena, boxes, sweep->count, 1, &sweep->tree)) {
        error_no_memory(error, "a sweep");
        return NULL;
    }
    sweep->bounds = box_pad(sweep->bounds);
    return sweep;
}

struct box sweep_bounds(const struct sweep_path *sweep) {
    return sweep->bounds;
}

bool sweep_piece_tube(const struct sweep_path *sweep, uint32_t number, double tube[4][4]) {
    if (number >= sweep->count)
        return false;
    memcpy(tube, sweep->pieces[number].c, sizeof sweep->pieces[number].c);
    for (int k = 0; k < 4; k++)
        tube[3][k] = fabs(tube[3][k]);
    return true;
}

/* A ball reaches g . centre -+ |g| radius. */
void sweep_extent(const struct sweep_path *sweep, struct vec3 g, double *lo, double *hi) {
    double length = vec3_length(g);
    *lo = INFINITY, *hi = -INFINITY;
    for (uint32_t i = 0; i < sweep->count; i++) {
        const struct sweep_piece *piece = &sweep->pieces[i];
        for (int sign = -1; sign <= 1; sign += 2) {
            double sum[4];
            for (int k = 0; k < 4; k++)
                sum[k] =
                    g.x * piece->c[0][k] + g.y * piece->c[1][k] + g.z * piece->c[2][k] + sign * length * piece->c[3][k];
            outline_range(sum, lo, hi);
        }
    }
}

uint32_t sweep_scratch_need(const struct sweep_path *sweep) {
    return sweep->count < 64 ? 8 * sweep->count : 512;
}

/* ---- one piece against the line ---- */

struct view {
    const struct sweep_piece *piece;
    struct vec3 origin, direction;
};

/* Place along the line, and half the stretch squared, of ball x. */
static double ball(const struct view *view, double x, double *b) {
    struct vec3 q = vec3_sub(centre_at(view->piece, x), view->origin);
    *b = vec3_dot(q, view->direction);
    double p = vec3_length(vec3_add_scaled(q, view->direction, -*b)), r = fabs(cubic_value(view->piece->c[3], x));
    return (r - p) * (r + p);
}

struct stretch {
    double enter, leave, x_enter, x_leave;
};

static void consider(const struct view *view, double x, struct stretch *out) {
    double b, d = ball(view, x, &b), half = d > 0 ? sqrt(d) : 0;
    if (b - half < out->enter)
        out->enter = b - half, out->x_enter = x;
    if (b + half > out->leave)
        out->leave = b + half, out->x_leave = x;
}

/* A step of Newton's towards f' = 0, f = b - sign sqrt(D), if it makes |f'| smaller. D and b are Bernstein on [lo,
 * hi]. */
static double polish(const double *d, int degree, const double *b, int b_degree, double sign, double x) {
    double d1[6], d2[5], b1[3], b2[2] = {0};
    bernstein_derivative(d, degree, d1);
    bernstein_derivative(d1, degree - 1, d2);
    bernstein_derivative(b, b_degree, b1);
    if (b_degree > 1)
        bernstein_derivative(b1, b_degree - 1, b2);
    double best = INFINITY, next = x;
    for (int i = 0; i < 4 && next >= 0 && next <= 1; i++) {
        double value = bernstein_value(d, degree, next);
        if (!(value > 0))
            break;
        double root = sqrt(value), slope = bernstein_value(d1, degree - 1, next);
        double f1 = bernstein_value(b1, b_degree - 1, next) - sign * slope / (2 * root);
        if (!(fabs(f1) < best))
            break;
        best = fabs(f1);
        x = next;
        double f2 = (b_degree > 1 ? bernstein_value(b2, b_degree - 2, x) : 0) -
                    sign * (bernstein_value(d2, degree - 2, x) / (2 * root) - slope * slope / (4 * value * root));
        next = x - f1 / f2;
    }
    return x;
}

/* D and b of the balls from lo to hi. */
struct part_of_piece {
    const struct view *view;
    const double *d, *b;
    int d_degree, b_degree;
    double lo, hi;
};

static void consider_near(const struct part_of_piece *part, double x, double sign, struct stretch *out) {
    x = polish(part->d, part->d_degree, part->b, part->b_degree, sign, x);
    consider(part->view, part->lo + (part->hi - part->lo) * x, out);
}

/* In Bernstein form. */
struct polynomial {
    const double *c;
    int degree;
};

/* The stretch covered by the balls from x = lo to hi, all of which the line meets. */
static struct stretch cover(const struct view *view, struct polynomial d, struct polynomial b, double lo, double hi) {
    struct stretch out = {INFINITY, -INFINITY, lo, hi};
    consider(view, lo, &out);
    consider(view, hi, &out);

    /* D and b on [lo, hi] alone. */
    double dd[7], bb[4], rest[7], unused[7];
    if (lo > 0 || hi < 1) {
        bernstein_split(d.c, d.degree, hi, rest, unused);
        bernstein_split(rest, d.degree, lo / hi, unused, dd);
        bernstein_split(b.c, b.degree, hi, rest, unused);
        bernstein_split(rest, b.degree, lo / hi, unused, bb);
    } else {
        memcpy(dd, d.c, sizeof dd);
        memcpy(bb, b.c, sizeof bb);
    }
    double b1[3], d1[6], bb1[5], left[11], right[11], roots[10];
    bernstein_derivative(bb, b.degree, b1);
    bernstein_derivative(dd, d.degree, d1);
    bernstein_multiply(b1, b.degree - 1, b1, b.degree - 1, bb1);
    bernstein_multiply(bb1, 2 * b.degree - 2, dd, d.degree, left);
    bernstein_multiply(d1, d.degree - 1, d1, d.degree - 1, right);
    int total = 2 * d.degree - 2; /* = 2 (b.degree - 1) + d.degree */
    double largest = 0, slope = 0;
    for (int k = 0; k <= total; k++) {
        slope = math_max(slope, 4 * fabs(left[k]));
        largest = math_max(largest, math_max(4 * fabs(left[k]), right[k]));
    }
    for (int k = 0; k <= total; k++) {
        left[k] = 4 * left[k] - right[k];
        if (fabs(left[k]) < 0x1p-48 * largest) /* rounding: where the derivative of the path is zero, everything is zero
                                                  to the fourth order */
            left[k] = 0;
    }
    const struct part_of_piece part = {view, dd, bb, d.degree, b.degree, lo, hi};
    int count = bernstein_roots(left, total, roots);
    for (int k = 0; k < count; k++) {
        /* f' = b' - sign D' / (2 sqrt(D)) is zero where the signs of b' and D' say so. */
        double same = bernstein_value(b1, b.degree - 1, roots[k]) * bernstein_value(d1, d.degree - 1, roots[k]);
        consider_near(&part, roots[k], same > 0 ? 1 : -1, &out);
    }
    /* Where b' and D' are zero together, the sign does not change: everywhere on a line at right angles to the plane of
     * a path, and in the middle of a path with two equal halves. */
    count = slope < 0x1p-30 * largest ? bernstein_roots(d1, d.degree - 1, roots) : 0;
    if (count == 0 && b.degree > 1) {
        double steepest = 0;
        for (int k = 0; k < d.degree; k++)
            steepest = math_max(steepest, fabs(d1[k]));
        int all = bernstein_roots(b1, b.degree - 1, roots);
        for (int k = 0; k < all; k++)
            if (fabs(bernstein_value(d1, d.degree - 1, roots[k])) < 0x1p-8 * steepest)
                roots[count++] = roots[k];
    }
    for (int k = 0; k < count; k++) {
        consider_near(&part, roots[k], 1, &out);
        consider_near(&part, roots[k], -1, &out);
    }
    return out;
}

/* A straight piece of equal balls. With y counted from the ball next to the line, b = B y + ... and D = h^2 - P^2 y^2:
 * b -+ sqrt(D) is convex or concave, and its derivative is zero at y = -+ B h / (P length). p: the centres at the ends,
 * without their way along the line. */
static bool capsule_crossings(const struct view *view, const struct vec3 p[2], double along, double shift,
                              uint32_t part, struct geom_scratch *scratch) {
    const struct vec3 across = vec3_sub(p[1], p[0]);
    const double speed = vec3_length(across), length = sqrt(speed * speed + along * along),
                 r = fabs(view->piece->c[3][0]);
    double lo = 0, hi = 1, next = 0, offset = 0;
    if (speed > 0x1p-40 * length) {
        next = -vec3_dot(p[0], across) / (speed * speed);
        double distance = vec3_length(vec3_add_scaled(p[0], across, next));
        double half = distance < r ? sqrt((r - distance) * (r + distance)) / speed : -1;
        lo = math_max(0, next - half);
        hi = math_min(1, next + half);
        offset = half * along / length;
    } else if (vec3_length(p[0]) > r) {
        hi = -1;
    }
    if (lo > hi)
        return true;
    struct stretch s = {INFINITY, -INFINITY, lo, hi};
    consider(view, lo, &s);
    consider(view, hi, &s);
    if (next - offset > lo && next - offset < hi)
        consider(view, next - offset, &s);
    if (next + offset > lo && next + offset < hi)
        consider(view, next + offset, &s);
    return geom_scratch_push(scratch,
                             (struct crossing){.t = s.enter + shift, .u = s.x_enter, .part = part, .enter = true}) &&
           geom_scratch_push(scratch, (struct crossing){.t = s.leave + shift, .u = s.x_leave, .part = part});
}

/* The square of a linear or cubic polynomial. */
static void square_of(const double *a, int degree, double *out) {
    if (degree == 1) {
        out[0] = a[0] * a[0], out[1] = a[0] * a[1], out[2] = a[1] * a[1];
        return;
    }
    out[0] = a[0] * a[0];
    out[1] = a[0] * a[1];
    out[2] = (2 * a[0] * a[2] + 3 * a[1] * a[1]) / 5;
    out[3] = (a[0] * a[3] + 9 * a[1] * a[2]) / 10;
    out[4] = (2 * a[1] * a[3] + 3 * a[2] * a[2]) / 5;
    out[5] = a[2] * a[3];
    out[6] = a[3] * a[3];
}

static bool piece_crossings(const void *shape, uint32_t part, const struct line *line, struct geom_scratch *scratch) {
    const struct sweep_path *sweep = shape;
    const struct sweep_piece *piece = &sweep->pieces[part];
    double shift = vec3_dot(vec3_sub(piece->centre, line->origin), line->direction);
    struct view view = {piece, line_at(line, shift), line->direction};

    /* D and b in Bernstein form. */
    int b_degree = piece->straight ? 1 : 3, degree = 2 * b_degree, step = piece->straight ? 3 : 1;
    double b[4], r[4], p[3][4], d[7], square[7], roots[8], widest = 0;
    struct vec3 sum = {0, 0, 0};
    for (int k = 0; k <= b_degree; k++) {
        struct vec3 q =
            vec3_sub(vec3_make(piece->c[0][k * step], piece->c[1][k * step], piece->c[2][k * step]), view.origin);
        b[k] = vec3_dot(q, view.direction);
        q = vec3_add_scaled(q, view.direction, -b[k]);
        p[0][k] = q.x, p[1][k] = q.y, p[2][k] = q.z;
        r[k] = piece->c[3][k * step];
        widest = math_max(widest, fabs(r[k]));
        sum = vec3_add(sum, q);
    }
    /* All of it beyond a straight edge that is farther than the balls reach. */
    struct vec3 outer = vec3_normalize(sum);
    double nearest = INFINITY;
    for (int k = 0; k <= b_degree; k++)
        nearest = math_min(nearest, p[0][k] * outer.x + p[1][k] * outer.y + p[2][k] * outer.z);
    if (nearest > (1 + 0x1p-30) * widest)
        return true;
    if (piece->straight && r[0] == r[1]) {
        const struct vec3 ends[2] = {{p[0][0], p[1][0], p[2][0]}, {p[0][1], p[1][1], p[2][1]}};
        return capsule_crossings(&view, ends, b[1] - b[0], shift, part, scratch);
    }
    square_of(r, b_degree, d);
    for (int axis = 0; axis < 3; axis++) {
        square_of(p[axis], b_degree, square);
        for (int k = 0; k <= degree; k++)
            d[k] -= square[k];
    }
    int count = bernstein_roots(d, degree, roots);
    bool meets = !(d[0] < 0);
    double from = 0;
    for (int k = 0; k <= count; k++) {
        double to = k < count ? roots[k] : 1;
        if (meets && from <= to && to > 0) {
            struct stretch s = cover(&view, (struct polynomial){d, degree}, (struct polynomial){b, b_degree}, from, to);
            if (!geom_scratch_push(
                    scratch, (struct crossing){.t = s.enter + shift, .u = s.x_enter, .part = part, .enter = true}) ||
                !geom_scratch_push(scratch, (struct crossing){.t = s.leave + shift, .u = s.x_leave, .part = part}))
                return false;
        }
        meets = !meets;
        from = to;
    }
    return true;
}

/* ---- the questions ---- */

bool sweep_crossings(const struct sweep_path *sweep, const struct ray *ray, struct geom_scratch *scratch,
                     struct crossing_list *out) {
    *out = (struct crossing_list){scratch->used, 0};
    struct line line;
    struct vec3 centre = vec3_add(vec3_scale(sweep->bounds.min, 0.5), vec3_scale(sweep->bounds.max, 0.5));
    if (!line_init(&line, ray, centre))
        return true;
    if (!part_tree_crossings(&sweep->tree, &line, sweep, piece_crossings, scratch))
        return false;
    /* The union of the stretches. */
    uint32_t count = scratch->used - out->first, kept = 0, depth = 0;
    struct crossing *items = &scratch->items[out->first];
    crossings_sort(items, count);
    for (uint32_t i = 0; i < count; i++) {
        bool outer = items[i].enter ? depth == 0 : depth == 1;
        if (items[i].enter)
            depth++;
        else if (depth > 0)
            depth--;
        else
            continue; /* the end of a stretch of no length came before its beginning */
        if (outer)
            items[kept++] = items[i];
    }
    scratch->used = out->first + kept;
    line_finish_closed(&line, scratch, out->first, out);
    return true;
}

bool sweep_contains(const struct sweep_path *sweep, struct vec3 point) {
    if (!box_contains(&sweep->bounds, point))
        return false;
    for (uint32_t n = 0; n < sweep->tree.node_count;) {
        const struct part_node *node = &sweep->tree.nodes[n];
        if (!box_contains(&node->box, point)) {
            n = node->skip;
            continue;
        }
        for (uint32_t i = 0; i < node->count; i++) {
            const struct sweep_piece *piece = &sweep->pieces[sweep->tree.order[node->first + i]];
            const double at[3] = {point.x, point.y, point.z};
            double d[7], square[7], q[4], roots[6];
            /* Squared radius minus squared distance, as a polynomial of degree 6: positive inside of a sphere. */
            bernstein_multiply(piece->c[3], 3, piece->c[3], 3, d);
            for (int axis = 0; axis < 3; axis++) {
                for (int k = 0; k < 4; k++)
                    q[k] = piece->c[axis][k] - at[axis];
                bernstein_multiply(q, 3, q, 3, square);
                for (int k = 0; k < 7; k++)
                    d[k] -= square[k];
            }
            if (d[0] > 0 || d[6] > 0 || bernstein_roots(d, 6, roots) > 0)
                return true;
        }
        n++;
    }
    return false;
}

void sweep_describe(const struct sweep_path *sweep, const struct ray *ray, const struct crossing *crossing,
                    struct surface *out) {
    const struct sweep_piece *piece = &sweep->pieces[crossing->part];
    double x = crossing->u, radius = fabs(cubic_value(piece->c[3], x));
    struct vec3 centre = centre_at(piece, x), n = vec3_normalize(vec3_sub(ray_at(ray, crossing->t), centre));
    if (!(vec3_max_abs(n) > 0)) /* a ball that is a point */
        n = vec3_normalize(vec3_scale(ray->direction, crossing->enter ? -1 : 1));
    struct vec3 point = vec3_add_scaled(centre, n, radius);
    double size = math_max(vec3_max_abs(sweep->bounds.min), vec3_max_abs(sweep->bounds.max));
    *out = (struct surface){.point = point,
                            .normal = n,
                            .shading_normal = n,
                            .pattern_point = point,
                            .pattern_normal = n,
                            .has_uv = true,
                            .error = 0x1p-46 * size};
    struct vec3 tangent = vec3_normalize(tangent_at(piece, x));
    struct vec3 side = vec3_add(vec3_scale(piece->side0, 1 - x), vec3_scale(piece->side1, x));
    side = vec3_normalize(vec3_add_scaled(side, tangent, -vec3_dot(side, tangent)));
    struct vec3 other = vec3_cross(tangent, side);
    out->u = 0.5 + el_atan2(vec3_dot(n, other), vec3_dot(n, side)) / TURN;
    out->v = piece->from + (piece->to - piece->from) * x;
    out->dpdu = vec3_scale(vec3_cross(tangent, n), TURN * radius);
    struct vec3 along = vec3_scale(tangent_at(piece, x), 1 / (piece->to - piece->from));
    out->dpdv = vec3_add_scaled(along, n, -vec3_dot(along, n));
}

static void bundle_tables(struct bundle *bundle, void *tables) {
    struct sweep_path *sweep = tables;
    BUNDLE(bundle, sweep->pieces, sweep->count, NULL);
    part_tree_bundle(bundle, &sweep->tree);
}

void sweep_bundle(struct bundle *bundle, const struct sweep_path **sweep) {
    BUNDLE(bundle, *sweep, 1, bundle_tables);
}
