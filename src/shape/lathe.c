/* The lathe. In the half-plane of radius r and height y a line is one branch of a hyperbola, r^2 = h^2 + c^2 s^2 with
 * y = y0 + d s: h is its distance from the axis, s counts from the foot there, c and d are its speeds across and along
 * the axis (c^2 + d^2 = 1). A crossing is a place x on the profile (r(x), y(x)) with G(x) = c (y(x) - y0) - sign * d
 * w(x) = 0,   w = sqrt(r^2 - h^2), one function for each half of the hyperbola (s = sign * w / c). Squared it is the
 * polynomial of degree 6 of van Wijk, "Ray tracing objects defined by sweeping planar cubic splines" (ACM TOG 1984),
 * whose roots come in almost equal pairs for a ray that is almost level; unsquared it stays well behaved for every ray,
 * so that is what is solved:
 *   - the profile is cut into pieces monotone in r and y, so that a piece lies where r > h from one place on;
 *   - there w G'(x) = c w y' - sign d r r' is bounded by intervals; where it does not change sign G has one root or
 * none, by the signs at the ends; where it may, the piece is halved (a straight piece is cut where w G' is zero).
 * Parity: a point of the profile with r > h lies between the halves of the hyperbola if its two G differ in sign. The
 * number of crossings on a piece is odd just if one of its ends does, decided from the end's coordinates alone, which
 * neighbours share; so on a loop, or from axis to axis, it is even in spite of rounding. A tree over the pieces' boxes
 * in (r, y) excludes those that the hyperbola does not meet. */
#include "shape/lathe.h"

#include "geometry/bernstein.h"
#include "math/bracket.h"
#include "math/elementary.h"
#include "shape/part_tree_internal.h"

#include <string.h>

enum { DEEPEST = 26 };

/* Radius and height at a place of a piece. */
static inline double radius_at(const struct outline_piece *c, double x) {
    return c->straight ? c->p[0] + x * (c->p[3] - c->p[0]) : cubic_value(c->p, x);
}
static inline double height_at(const struct outline_piece *c, double x) {
    return c->straight ? c->q[0] + x * (c->q[3] - c->q[0]) : cubic_value(c->q, x);
}

struct lathe {
    struct outline outline;
    struct part_tree tree; /* x is the radius, y the height */
    struct box bounds;
    bool closed;
};

/* ---- building ---- */

static bool check_points(const struct lathe_input *in, struct error *error) {
    double top = 0;
    for (uint32_t i = 0; i < in->count; i++) {
        if (!isfinite(in->points[i][0]) || !isfinite(in->points[i][1]))
            return error_set(error, ERROR_SCENE, "point %u of the profile is not finite", i + 1);
        if (in->points[i][0] < 0 && in->kind != SPLINE_BEZIER)
            return error_set(error, ERROR_SCENE, "point %u of the profile has the negative radius %g", i + 1,
                             in->points[i][0]);
        top = math_max(top, math_max(fabs(in->points[i][0]), fabs(in->points[i][1])));
    }
    if (!(top > 0x1p-300 && top < 0x1p300))
        return error_set(error, ERROR_SCENE, "the profile has no extent, or is too large");
    return true;
}

/* The straight piece from an end of the profile to the axis. */
static struct spline_segment disc(double r0, double r1, double y) {
    return (struct spline_segment){{{r0, (2 * r0 + r1) / 3, (r0 + 2 * r1) / 3, r1}, {y, y, y, y}}};
}

/* Radii left of the axis by rounding are put on it, others are an error. */
static bool settle_radii(struct outline *outline, double size, struct error *error) {
    for (uint32_t i = 0; i < outline->count; i++) {
        struct outline_piece *c = &outline->pieces[i];
        for (int k = 0; k < 4; k += 3) {
            if (c->p[k] >= 0)
                continue;
            if (c->p[k] < -1e-9 * size)
                return error_set(error, ERROR_SCENE, "the profile crosses the axis (radius %g) in segment %u", c->p[k],
                                 c->segment + 1);
            c->p[k] = 0;
        }
    }
    return true;
}

const struct lathe *lathe_build(struct arena *arena, const struct lathe_input *in, struct error *error) {
    if (!check_points(in, error))
        return NULL;
    uint32_t count = in->count;
    bool loop = in->loop;
    const double *first = in->points[0], *last = in->points[count - 1];
    if (count > 2 && first[0] == last[0] && first[1] == last[1] && first[0] > 0) {
        loop = true;
        count -= in->kind == SPLINE_BEZIER && count % 3 == 0 ? 0 : 1;
        last = in->points[count - 1];
    }
    /* A smooth profile that ends on the axis continues mirrored there, so that the pole is smooth. */
    double before[2], after[2];
    bool first_on_axis = first[0] == 0, last_on_axis = last[0] == 0;
    if (first_on_axis && count > 1)
        before[0] = -in->points[1][0], before[1] = in->points[1][1];
    if (last_on_axis && count > 1)
        after[0] = -in->points[count - 2][0], after[1] = in->points[count - 2][1];
    struct spline_input spline = {.kind = in->kind,
                                  .dimensions = 2,
                                  .points = &in->points[0][0],
                                  .count = count,
                                  .closed = loop,
                                  .before = first_on_axis && count > 1 ? before : NULL,
                                  .after = last_on_axis && count > 1 ? after : NULL};
    struct spline_segment *segments;
    uint32_t segment_count;
    if (!spline_build(arena, &spline, &segments, &segment_count, error))
        return NULL;

    /* Profile, and discs at its ends, as one outline in order. */
    struct lathe *lathe = arena_alloc(arena, sizeof *lathe);
    struct outline parts[3] = {{0}};
    struct spline_segment bottom = disc(0, first[0], first[1]), top = disc(last[0], 0, last[1]);
    bool discs = !loop && !in->open;
    if (!lathe) {
        error_no_memory(error, "a lathe");
        return NULL;
    }
    if ((discs && !first_on_axis && !outline_build(arena, &bottom, 1, true, &parts[0], error)) ||
        !outline_build(arena, segments, segment_count, in->kind == SPLINE_LINEAR, &parts[1], error) ||
        (discs && !last_on_axis && !outline_build(arena, &top, 1, true, &parts[2], error)))
        return NULL;
    struct outline *all = &lathe->outline;
    all->pieces = arena_alloc_array(arena, parts[0].count + parts[1].count + parts[2].count, sizeof *all->pieces);
    struct box *boxes = arena_alloc_array(arena, parts[0].count + parts[1].count + parts[2].count, sizeof *boxes);
    if (!all->pieces || !boxes) {
        error_no_memory(error, "a lathe");
        return NULL;
    }
    double total = parts[0].length + parts[1].length + parts[2].length, done = 0;
    for (int k = 0; k < 3; k++) {
        for (uint32_t i = 0; i < parts[k].count; i++) {
            struct outline_piece *piece = &all->pieces[all->count++];
            *piece = parts[k].pieces[i];
            piece->from = (done + piece->from * parts[k].length) / total;
            piece->to = (done + piece->to * parts[k].length) / total;
        }
        done += parts[k].length;
    }
    if (all->count == 0) {
        error_set(error, ERROR_SCENE, "all points of the profile are the same");
        return NULL;
    }
    struct box profile = box_empty();
    for (uint32_t i = 0; i < all->count; i++) {
        const struct outline_piece *c = &all->pieces[i];
        boxes[i] = box_empty();
        for (int k = 0; k < 4; k += 3)
            boxes[i] = box_add_point(boxes[i], vec3_make(c->p[k], c->q[k], 0));
        profile = box_join(profile, boxes[i]);
    }
    double size = math_max(vec3_max_abs(profile.min), vec3_max_abs(profile.max));
    if (!settle_radii(all, size, error))
        return NULL;
    if (!part_tree_build(arena, boxes, all->count, 2, &lathe->tree)) {
        error_no_memory(error, "a lathe");
        return NULL;
    }
    double r = profile.max.x;
    if (!(r > 0)) {
        error_set(error, ERROR_SCENE, "the profile lies on the axis");
        return NULL;
    }
    lathe->bounds = box_pad((struct box){{-r, profile.min.y, -r}, {r, profile.max.y, r}});
    lathe->closed = loop || discs || (first_on_axis && last_on_axis);
    return lathe;
}

struct box lathe_bounds(const struct lathe *lathe) {
    return lathe->bounds;
}

bool lathe_is_closed(const struct lathe *lathe) {
    return lathe->closed;
}

/* A circle of radius r at height y reaches g.y y -+ |g across| r: a cubic on each piece. */
void lathe_extent(const struct lathe *lathe, struct vec3 g, double *lo, double *hi) {
    double across = sqrt(g.x * g.x + g.z * g.z);
    *lo = INFINITY, *hi = -INFINITY;
    for (uint32_t i = 0; i < lathe->outline.count; i++) {
        const struct outline_piece *c = &lathe->outline.pieces[i];
        for (int sign = -1; sign <= 1; sign += 2) {
            double sum[4];
            for (int k = 0; k < 4; k++)
                sum[k] = g.y * c->q[k] + sign * across * c->p[k];
            outline_range(sum, lo, hi);
        }
    }
}

uint32_t lathe_scratch_need(const struct lathe *lathe) {
    return lathe->outline.count < 64 ? 4 * lathe->outline.count : 256;
}

/* ---- the line in the half-plane ---- */

struct hyperbola {
    double h;       /* distance from the axis */
    double c, d;    /* speeds across and along the axis */
    double y, foot; /* height at s = 0; s where the axis is nearest */
    double y_foot;
    struct line line;
};

static bool hyperbola_init(struct hyperbola *hy, const struct ray *ray, const struct box *bounds) {
    struct vec3 centre = {0, bounds->min.y / 2 + bounds->max.y / 2, 0};
    if (!line_init(&hy->line, ray, centre))
        return false;
    struct vec3 o = hy->line.origin, u = hy->line.direction;
    hy->c = sqrt(u.x * u.x + u.z * u.z);
    if (hy->c < 0x1p-300) /* the square of what is left would vanish */
        hy->c = 0;
    hy->d = u.y;
    hy->y = o.y;
    if (hy->c == 0) {
        hy->h = sqrt(o.x * o.x + o.z * o.z);
        hy->foot = 0;
    } else {
        double ux = u.x / hy->c, uz = u.z / hy->c;
        hy->h = fabs(o.x * uz - o.z * ux);
        hy->foot = -(o.x * ux + o.z * uz) / hy->c;
    }
    hy->y_foot = o.y + hy->foot * hy->d;
    return true;
}

/* Whether the curve may meet a box of the half-plane. */
static bool hyperbola_meets(const struct hyperbola *hy, const struct box *box) {
    if (box->max.x < hy->h)
        return false;
    double lo = box->min.y - hy->y, hi = box->max.y - hy->y;
    if (hy->d == 0) {
        if (lo > 0 || hi < 0)
            return false;
        lo = -INFINITY, hi = INFINITY;
    } else {
        double a = lo / hy->d, b = hi / hy->d;
        lo = math_min(a, b), hi = math_max(a, b);
    }
    if (hy->c == 0)
        return box->min.x <= hy->h;
    /* Distances from the axis over that range of s. */
    lo = (lo - hy->foot) * hy->c, hi = (hi - hy->foot) * hy->c;
    double far = math_max(-lo, hi), near = lo > 0 ? lo : hi < 0 ? -hi : 0;
    double outer = (box->max.x - hy->h) * (box->max.x + hy->h);
    double inner = box->min.x > hy->h ? (box->min.x - hy->h) * (box->min.x + hy->h) : 0;
    /* The foot may be far away: rounding in the distances is relative to that. */
    double slack = 0x1p-45 * fabs(hy->foot * hy->c);
    near -= slack;
    far += slack;
    return (near <= 0 || near * near <= outer) && far * far >= inner;
}

/* ---- crossings on one piece ---- */

static double width(const struct hyperbola *hy, double r) {
    return r > hy->h ? sqrt((r - hy->h) * (r + hy->h)) : 0;
}

static double value(const struct hyperbola *hy, double sign, double r, double y) {
    return (hy->c * y - hy->c * hy->y_foot) - sign * hy->d * width(hy, r);
}

struct search {
    const struct hyperbola *hy;
    const struct outline_piece *piece;
    uint32_t part;
    struct geom_scratch *scratch;
};

static bool push(const struct search *f, double x, double sign) {
    const struct hyperbola *hy = f->hy;
    double r = radius_at(f->piece, x), y = height_at(f->piece, x), w = width(hy, r);
    /* By height or by radius, whichever determines s better. */
    double s = fabs(hy->d) * r >= w * hy->c ? (y - hy->y) / hy->d : hy->foot + sign * w / hy->c;
    if (!isfinite(s))
        s = 0;
    return geom_scratch_push(f->scratch, (struct crossing){.t = s, .u = x, .v = sign, .part = f->part});
}

/* The root between lo and hi, where G has different signs: steps of Newton's inside the bracket while they shrink, else
 * halves. G' is infinite where w is zero, at the ends of the halves of the hyperbola; there halving starts it off. */
static double bracketed_root(const struct search *f, double sign, double lo, double hi, double g_lo, double g_hi) {
    const struct hyperbola *hy = f->hy;
    const double *p = f->piece->p, *q = f->piece->q;
    struct bracket b = {.lo = lo, .hi = hi, .last_step = hi - lo, .rising = g_lo < 0};
    b.x = lo + (hi - lo) * math_min(math_max(g_lo / (g_lo - g_hi), 0.0625), 0.9375);
    for (int i = 0; i < 120; i++) {
        double x = b.x;
        double r = radius_at(f->piece, x), w = width(hy, r);
        double g = (hy->c * height_at(f->piece, x) - hy->c * hy->y_foot) - sign * hy->d * w;
        if (g == 0)
            return x;
        double dr = f->piece->straight ? p[3] - p[0] : cubic_slope(p, x);
        double dy = f->piece->straight ? q[3] - q[0] : cubic_slope(q, x);
        double slope = hy->c * dy - sign * hy->d * r * dr / w;
        bool good = bracket_newton(&b, g, slope);
        if (fabs(b.step) < 0x1p-54 || (!good && (!bracket_halve(&b, 0.5 * (b.lo + b.hi)) || b.hi - b.lo < 0x1p-54)))
            return x;
        bracket_move(&b);
    }
    return b.x;
}

/* Bounds of a product of two ranges. */
static void product_range(double a0, double a1, double b0, double b1, double *lo, double *hi) {
    double p = a0 * b0, q = a0 * b1, r = a1 * b0, s = a1 * b1;
    *lo = math_min(math_min(p, q), math_min(r, s));
    *hi = math_max(math_max(p, q), math_max(r, s));
}

static void slope_range(const double b[4], double *lo, double *hi) {
    double p = b[1] - b[0], q = b[2] - b[1], r = b[3] - b[2];
    *lo = 3 * math_min(p, math_min(q, r));
    *hi = 3 * math_max(p, math_max(q, r));
}

struct span {
    double p[4], q[4];
    double lo, hi, g_lo, g_hi;
    int depth;
};

static void cut_span(const double b[4], double lo, double hi, double out[4]) {
    double unused[4], rest[4];
    if (lo == 0 && hi == 1) {
        memcpy(out, b, 4 * sizeof *b);
        return;
    }
    bernstein_split(b, 3, hi, rest, unused);
    bernstein_split(rest, 3, lo / hi, unused, out);
}

/* Whether G may have an extremum in the span; `none`: it may, but cannot reach zero. */
static bool may_turn(const struct hyperbola *hy, double sign, const struct span *span, bool *none) {
    double dy0, dy1, dr0, dr1, a0, a1, b0, b1;
    slope_range(span->q, &dy0, &dy1);
    slope_range(span->p, &dr0, &dr1);
    double r0 = math_min(span->p[0], span->p[3]), r1 = math_max(span->p[0], span->p[3]);
    double w0 = width(hy, r0), w1 = width(hy, r1);
    product_range(hy->c * w0, hy->c * w1, dy0, dy1, &a0, &a1);
    double k0 = sign * hy->d * r0, k1 = sign * hy->d * r1;
    product_range(math_min(k0, k1), math_max(k0, k1), dr0, dr1, &b0, &b1);
    *none = false;
    if (a0 - b1 >= 0 || a1 - b0 <= 0)
        return false;
    double y0 = hy->c * math_min(span->q[0], span->q[3]) - hy->c * hy->y_foot;
    double y1 = hy->c * math_max(span->q[0], span->q[3]) - hy->c * hy->y_foot;
    double m0 = sign * hy->d * w0, m1 = sign * hy->d * w1;
    *none = y0 - math_max(m0, m1) > 0 || y1 - math_min(m0, m1) < 0;
    return true;
}

/* All roots of one half on the piece from lo to hi, r > h inside. False: the scratch is full. */
static bool roots_of_half(const struct search *f, double sign, double lo, double hi, double g_lo, double g_hi) {
    const struct hyperbola *hy = f->hy;
    if (f->piece->straight) {
        /* w G' = 0 where (r^2 - h^2) (c y')^2 = (d r r')^2. */
        double dr = f->piece->p[3] - f->piece->p[0], dy = f->piece->q[3] - f->piece->q[0];
        double cy = hy->c * dy, dd = hy->d * dr, turns = (cy - dd) * (cy + dd);
        double middle = lo, g = g_lo;
        if (turns > 0 && sign * hy->d * dr * dy > 0) {
            double r = hy->h * fabs(cy) / sqrt(turns), x = (r - f->piece->p[0]) / dr;
            if (x > lo && x < hi) {
                middle = x;
                g = value(hy, sign, radius_at(f->piece, x), height_at(f->piece, x));
            }
        }
        if (middle > lo && (g_lo < 0) != (g < 0) && !push(f, bracketed_root(f, sign, lo, middle, g_lo, g), sign))
            return false;
        return (g < 0) == (g_hi < 0) || push(f, bracketed_root(f, sign, middle, hi, g, g_hi), sign);
    }
    struct span stack[DEEPEST + 2];
    stack[0] = (struct span){.lo = lo, .hi = hi, .g_lo = g_lo, .g_hi = g_hi};
    cut_span(f->piece->p, lo, hi, stack[0].p);
    cut_span(f->piece->q, lo, hi, stack[0].q);
    int depth = 1;
    while (depth > 0) {
        struct span span = stack[--depth];
        bool none, odd = (span.g_lo < 0) != (span.g_hi < 0), turn = may_turn(hy, sign, &span, &none);
        if (!odd && (!turn || none || span.depth == DEEPEST))
            continue;
        if (!turn || span.depth == DEEPEST) {
            if (!push(f, bracketed_root(f, sign, span.lo, span.hi, span.g_lo, span.g_hi), sign))
                return false;
            continue;
        }
        struct span *left = &stack[depth++], *right = &stack[depth++];
        *left = *right = span;
        left->depth = right->depth = span.depth + 1;
        double middle = span.lo / 2 + span.hi / 2;
        double g = value(hy, sign, radius_at(f->piece, middle), height_at(f->piece, middle));
        bernstein_split(span.p, 3, 0.5, left->p, right->p);
        bernstein_split(span.q, 3, 0.5, left->q, right->q);
        left->hi = right->lo = middle;
        left->g_hi = right->g_lo = g;
    }
    return true;
}

/* Where the piece passes the radius h; one of its ends is beyond, the other is not. */
static double parameter_of_radius(const struct outline_piece *piece, double h) {
    if (piece->straight)
        return (h - piece->p[0]) / (piece->p[3] - piece->p[0]);
    double b[4], roots[3];
    for (int i = 0; i < 4; i++)
        b[i] = piece->p[i] - h;
    /* Zero counts as not beyond, as it does for the caller. */
    for (int i = 0; i < 4; i++)
        b[i] = -b[i];
    return bernstein_roots(b, 3, roots) > 0 ? roots[0] : piece->p[0] > piece->p[3] ? 1 : 0;
}

static bool piece_crossings(const struct search *f) {
    const struct hyperbola *hy = f->hy;
    const struct outline_piece *c = f->piece;
    bool in0 = c->p[0] > hy->h, in1 = c->p[3] > hy->h;
    if (hy->c == 0)
        return in0 == in1 || push(f, parameter_of_radius(c, hy->h), 1);
    if (!in0 && !in1)
        return true;
    double lo = 0, hi = 1, g_lo[2], g_hi[2];
    for (int k = 0; k < 2; k++) {
        double sign = k ? 1 : -1;
        g_lo[k] = value(hy, sign, c->p[0], c->q[0]);
        g_hi[k] = value(hy, sign, c->p[3], c->q[3]);
    }
    if (in0 != in1) {
        double x = parameter_of_radius(c, hy->h), g = hy->c * height_at(c, x) - hy->c * hy->y_foot;
        if (in0)
            hi = x, g_hi[0] = g_hi[1] = g;
        else
            lo = x, g_lo[0] = g_lo[1] = g;
        if (!(lo < hi)) { /* nothing but the end itself is beyond h */
            bool differs = in0 ? (g_lo[0] < 0) != (g_lo[1] < 0) : (g_hi[0] < 0) != (g_hi[1] < 0);
            return !differs || push(f, lo < 1 ? lo : 1, 1);
        }
    }
    return roots_of_half(f, -1, lo, hi, g_lo[0], g_hi[0]) && roots_of_half(f, 1, lo, hi, g_lo[1], g_hi[1]);
}

/* ---- queries ---- */

static struct vec3 outward(const struct outline_piece *piece, double x, struct vec3 radial) {
    double dr, dy;
    outline_tangent(piece, x, &dr, &dy);
    return vec3_normalize(vec3_make(dy * radial.x, -dr, dy * radial.z));
}

static struct vec3 radial_at(const struct line *line, double s) {
    struct vec3 p = line_at(line, s), radial = vec3_normalize(vec3_make(p.x, 0, p.z));
    return vec3_max_abs(radial) > 0 ? radial : vec3_make(1, 0, 0);
}

bool lathe_crossings(const struct lathe *lathe, const struct ray *ray, struct geom_scratch *scratch,
                     struct crossing_list *out) {
    *out = (struct crossing_list){scratch->used, 0};
    struct hyperbola hy;
    if (!hyperbola_init(&hy, ray, &lathe->bounds) || !line_meets_box(&hy.line, &lathe->bounds))
        return true;
    for (uint32_t n = 0; n < lathe->tree.node_count;) {
        const struct part_node *node = &lathe->tree.nodes[n];
        if (!hyperbola_meets(&hy, &node->box)) {
            n = node->skip;
            continue;
        }
        for (uint32_t i = 0; i < node->count; i++) {
            uint32_t part = lathe->tree.order[node->first + i];
            struct search f = {&hy, &lathe->outline.pieces[part], part, scratch};
            if (!piece_crossings(&f)) {
                scratch->used = out->first;
                return false;
            }
        }
        n++;
    }
    if (lathe->closed) {
        line_finish_closed(&hy.line, scratch, out->first, out);
        return true;
    }
    /* A sheet: entering is to meet the side that lies right of the profile's direction. */
    for (uint32_t i = out->first; i < scratch->used; i++) {
        struct crossing *c = &scratch->items[i];
        struct vec3 n = outward(&lathe->outline.pieces[c->part], c->u, radial_at(&hy.line, c->t));
        c->enter = vec3_dot(n, hy.line.direction) < 0;
    }
    line_finish_open(&hy.line, scratch, out->first, out);
    return true;
}

/* Even-odd in the half-plane, along the ray from the point outwards at its height. */
bool lathe_contains(const struct lathe *lathe, struct vec3 point) {
    if (!box_contains(&lathe->bounds, point))
        return false;
    double r = sqrt(point.x * point.x + point.z * point.z);
    bool inside = false;
    for (uint32_t i = 0; i < lathe->outline.count; i++) {
        const struct outline_piece *c = &lathe->outline.pieces[i];
        if ((c->q[0] > point.y) == (c->q[3] > point.y) || math_max(c->p[0], c->p[3]) <= r)
            continue;
        double b[4], roots[3], x = (point.y - c->q[0]) / (c->q[3] - c->q[0]);
        for (int k = 0; k < 4; k++)
            b[k] = point.y - c->q[k];
        if (!c->straight)
            x = bernstein_roots(b, 3, roots) > 0 ? roots[0] : 0.5;
        inside ^= radius_at(c, x) > r;
    }
    return inside;
}

void lathe_describe(const struct lathe *lathe, const struct ray *ray, const struct crossing *crossing,
                    struct surface *out) {
    const struct outline_piece *c = &lathe->outline.pieces[crossing->part];
    double x = crossing->u, r = radius_at(c, x), y = height_at(c, x), dr, dy;
    struct vec3 p = ray_at(ray, crossing->t), radial = vec3_normalize(vec3_make(p.x, 0, p.z));
    if (!(vec3_max_abs(radial) > 0))
        radial = vec3_make(1, 0, 0);
    struct vec3 point = {r * radial.x, y, r * radial.z}, n = outward(c, x, radial);
    if (lathe->closed && (vec3_dot(n, ray->direction) < 0) != crossing->enter)
        n = vec3_negate(n);
    double size = math_max(vec3_max_abs(lathe->bounds.min), vec3_max_abs(lathe->bounds.max));
    *out = (struct surface){.point = point,
                            .normal = n,
                            .shading_normal = n,
                            .pattern_point = point,
                            .pattern_normal = n,
                            .has_uv = true,
                            .error = 0x1p-47 * size};
    out->u = 0.5 + el_atan2(radial.z, radial.x) / TURN;
    out->v = c->from + (c->to - c->from) * x;
    outline_tangent(c, x, &dr, &dy);
    double by_length = c->to > c->from ? 1 / (c->to - c->from) : 0;
    out->dpdu = vec3_make(-TURN * r * radial.z, 0, TURN * r * radial.x);
    out->dpdv = vec3_make(by_length * dr * radial.x, by_length * dy, by_length * dr * radial.z);
    /* du x dv is -dy radial + dr up; where that is inwards u runs the other way. */
    if (dr * n.y - dy * vec3_dot(radial, n) < 0) {
        out->u = 1 - out->u;
        out->dpdu = vec3_negate(out->dpdu);
    }
}

static void bundle_tables(struct bundle *bundle, void *tables) {
    struct lathe *lathe = tables;
    outline_bundle(bundle, &lathe->outline);
    part_tree_bundle(bundle, &lathe->tree);
}

void lathe_bundle(struct bundle *bundle, const struct lathe **lathe) {
    BUNDLE(bundle, *lathe, 1, bundle_tables);
}
