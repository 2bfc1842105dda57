#include "shape/bevelled.h"

#include "base/sort.h"
#include "geometry/inset.h"
#include "math/frame.h"
#include "math/portable.h"
#include "shape/revolved_quadric.h"
#include "shape/sweep.h"
#include "shape/torus.h"

#include <string.h>

enum { CHORDS = 32, POINTS_LIMIT = 20000 };

/* A torus about axes[1]. */
struct ring {
    struct torus torus;
    struct vec3 centre, axes[3];
};
struct piece {
    enum { PIECE_PRISM, PIECE_SWEEP, PIECE_ROUND, PIECE_RING } kind;
    union {
        struct ring ring;
        const struct prism *prism;
        const struct sweep_path *sweep;
        struct revolved_quadric round;
    };
};
struct bevelled {
    struct piece *pieces;
    uint32_t count;
    uint32_t needed; /* a point is inside where so many pieces are: 1 or all */
    bool convex;     /* the first two pieces are the inset and the lower one of a convex solid */
    struct box bounds;
};

/* --- the solid --- */

/* Into the space of the torus and back. */
static struct vec3 into(const struct ring *ring, struct vec3 v) {
    return vec3_make(vec3_dot(v, ring->axes[0]), vec3_dot(v, ring->axes[1]), vec3_dot(v, ring->axes[2]));
}

static struct vec3 back(const struct ring *ring, struct vec3 v) {
    return vec3_add_scaled(vec3_add_scaled(vec3_scale(ring->axes[0], v.x), ring->axes[1], v.y), ring->axes[2], v.z);
}

static struct ray ray_into(const struct ring *ring, const struct ray *ray) {
    struct ray own = *ray;
    own.origin = into(ring, vec3_sub(ray->origin, ring->centre));
    own.direction = into(ring, ray->direction);
    return own;
}

static void ring_describe(const struct ring *ring, const struct ray *ray, const struct crossing *crossing,
                          struct surface *out) {
    const struct ray own = ray_into(ring, ray);
    torus_describe(&ring->torus, &own, crossing, out);
    out->point = out->pattern_point = vec3_add(ring->centre, back(ring, out->point));
    out->normal = out->shading_normal = out->pattern_normal = back(ring, out->normal);
    out->dpdu = back(ring, out->dpdu);
    out->dpdv = back(ring, out->dpdv);
    out->error += 0x1p-50 * vec3_max_abs(ring->centre);
}

static void piece_extent(const struct piece *piece, struct vec3 g, double *lo, double *hi) {
    switch (piece->kind) {
    case PIECE_PRISM:
        prism_extent(piece->prism, g, lo, hi);
        return;
    case PIECE_SWEEP:
        sweep_extent(piece->sweep, g, lo, hi);
        return;
    case PIECE_ROUND:
        revolved_quadric_extent(&piece->round, g, lo, hi);
        return;
    case PIECE_RING:
        torus_extent(&piece->ring.torus, into(&piece->ring, g), lo, hi);
        *lo += vec3_dot(g, piece->ring.centre);
        *hi += vec3_dot(g, piece->ring.centre);
        return;
    }
}

void bevelled_extent(const struct bevelled *bevelled, struct vec3 g, double *lo, double *hi) {
    const bool all = bevelled->needed > 1;
    *lo = all ? -INFINITY : INFINITY, *hi = -*lo;
    for (uint32_t i = 0; i < bevelled->count; i++) {
        double low = INFINITY, high = -INFINITY;
        piece_extent(&bevelled->pieces[i], g, &low, &high);
        *lo = all ? math_max(*lo, low) : math_min(*lo, low);
        *hi = all ? math_min(*hi, high) : math_max(*hi, high);
    }
}

struct box bevelled_bounds(const struct bevelled *bevelled) {
    return bevelled->bounds;
}

static bool piece_contains(const struct piece *piece, struct vec3 point) {
    switch (piece->kind) {
    case PIECE_PRISM:
        return prism_contains(piece->prism, point);
    case PIECE_SWEEP:
        return sweep_contains(piece->sweep, point);
    case PIECE_ROUND:
        return revolved_quadric_contains(&piece->round, point);
    case PIECE_RING:
        break;
    }
    return torus_contains(&piece->ring.torus, into(&piece->ring, vec3_sub(point, piece->ring.centre)));
}

bool bevelled_contains(const struct bevelled *bevelled, struct vec3 point) {
    uint32_t inside = 0;
    for (uint32_t i = 0; i < bevelled->count && inside < bevelled->needed; i++)
        inside += piece_contains(&bevelled->pieces[i], point);
    return inside == bevelled->needed;
}

uint32_t bevelled_scratch_need(const struct bevelled *bevelled) {
    uint32_t need = 0;
    for (uint32_t i = 0; i < bevelled->count; i++) {
        const struct piece *piece = &bevelled->pieces[i];
        need += piece->kind == PIECE_PRISM   ? prism_scratch_need(piece->prism)
                : piece->kind == PIECE_SWEEP ? sweep_scratch_need(piece->sweep)
                                             : 4;
    }
    return need;
}

static bool piece_crossings(const struct piece *piece, const struct ray *ray, struct geom_scratch *scratch,
                            struct crossing_list *out) {
    struct crossing few[4];
    switch (piece->kind) {
    case PIECE_PRISM:
        return prism_crossings(piece->prism, ray, scratch, out);
    case PIECE_SWEEP:
        return sweep_crossings(piece->sweep, ray, scratch, out);
    case PIECE_ROUND:
    case PIECE_RING:
        break;
    }
    const struct ray own = piece->kind == PIECE_RING ? ray_into(&piece->ring, ray) : *ray;
    const int count = piece->kind == PIECE_RING ? torus_crossings(&piece->ring.torus, &own, few)
                                                : revolved_quadric_crossings(&piece->round, ray, few);
    *out = (struct crossing_list){scratch->used, (uint32_t)count};
    for (uint32_t i = 0; i < out->count; i++)
        if (!geom_scratch_push(scratch, few[i]))
            return false;
    return true;
}

/* Of crossings at one place, the line enters first: pieces that touch there have no gap. */
static bool comes_before(const void *one, const void *other) {
    const struct crossing *a = one, *b = other;
    if (a->t != b->t)
        return a->t < b->t;
    return a->enter != b->enter ? a->enter : a->part < b->part;
}

/* Whether it is on a face of a convex solid, before and after which there is nothing else: an end of the inset piece,
 * or a side of the lower one that does not cut a corner (every second one of a prism). */
static bool is_final(const struct bevelled *bevelled, const struct crossing *crossing) {
    const uint32_t part = crossing->part / bevelled->count;
    const bool inset = crossing->part % bevelled->count == 0;
    if (bevelled->pieces[0].kind == PIECE_ROUND)
        return inset == (part != REVOLVED_QUADRIC_SIDE);
    return inset ? part < PRISM_SIDES : part >= PRISM_SIDES && (part - PRISM_SIDES) % 2 == 1;
}

/* The crossings of the first two pieces, if the others add nothing: the first and the last one in place of all. */
static bool is_settled(const struct bevelled *bevelled, struct geom_scratch *scratch, struct crossing_list *out) {
    struct crossing *items = &scratch->items[out->first];
    const uint32_t count = scratch->used - out->first;
    if (count != 2 && count != 4)
        return false;
    const struct crossing first = count == 4 && items[2].t < items[0].t ? items[2] : items[0];
    const struct crossing last = count == 4 && items[3].t > items[1].t ? items[3] : items[1];
    if (!is_final(bevelled, &first) || !is_final(bevelled, &last))
        return false;
    items[0] = first;
    items[1] = last;
    out->count = 2;
    scratch->used = out->first + 2;
    return true;
}

bool bevelled_crossings(const struct bevelled *bevelled, const struct ray *ray, struct geom_scratch *scratch,
                        struct crossing_list *out) {
    *out = (struct crossing_list){scratch->used, 0};
    struct line line;
    struct vec3 centre = vec3_add(vec3_scale(bevelled->bounds.min, 0.5), vec3_scale(bevelled->bounds.max, 0.5));
    if (!line_init(&line, ray, centre) || !line_meets_box(&line, &bevelled->bounds))
        return true;
    /* Those of all pieces; a part says which piece. */
    for (uint32_t i = 0; i < bevelled->count; i++) {
        struct crossing_list list;
        if (!piece_crossings(&bevelled->pieces[i], ray, scratch, &list)) {
            scratch->used = out->first;
            return false;
        }
        for (uint32_t k = list.first; k < list.first + list.count; k++)
            scratch->items[k].part = scratch->items[k].part * bevelled->count + i;
        if (i == 1 && bevelled->convex && is_settled(bevelled, scratch, out))
            return true;
    }
    struct crossing *items = &scratch->items[out->first];
    uint32_t count = scratch->used - out->first, depth = 0;
    crossings_sort_by(items, count, comes_before);
    /* Where the first of those needed begins and ends. */
    for (uint32_t i = 0; i < count; i++) {
        const bool changes = items[i].enter ? ++depth == bevelled->needed : depth-- == bevelled->needed;
        if (changes && !items[i].enter && items[i].t == items[out->count - 1].t)
            out->count--;
        else if (changes)
            items[out->count++] = items[i];
    }
    scratch->used = out->first + out->count;
    return true;
}

void bevelled_describe(const struct bevelled *bevelled, const struct ray *ray, const struct crossing *crossing,
                       struct surface *out) {
    const struct piece *piece = &bevelled->pieces[crossing->part % bevelled->count];
    struct crossing own = *crossing;
    own.part = crossing->part / bevelled->count;
    switch (piece->kind) {
    case PIECE_PRISM:
        prism_describe(piece->prism, ray, &own, out);
        return;
    case PIECE_SWEEP:
        sweep_describe(piece->sweep, ray, &own, out);
        return;
    case PIECE_ROUND:
        revolved_quadric_describe(&piece->round, ray, &own, out);
        return;
    case PIECE_RING:
        ring_describe(&piece->ring, ray, &own, out);
        return;
    }
}

/* --- building --- */

static struct bevelled *bevelled_make(struct arena *arena, uint32_t pieces, struct error *error) {
    struct bevelled *out = arena_alloc(arena, sizeof *out);
    if (out)
        *out = (struct bevelled){.needed = 1, .pieces = arena_alloc_array(arena, pieces, sizeof *out->pieces)};
    if (out && out->pieces)
        return out;
    (void)error_no_memory(error, "a solid with bevelled edges");
    return NULL;
}

static bool add_sweep(struct bevelled *out, struct arena *arena, const struct sweep_input *input, struct error *error) {
    const struct sweep_path *sweep = sweep_build(arena, input, error);
    if (sweep)
        out->pieces[out->count++] = (struct piece){.kind = PIECE_SWEEP, .sweep = sweep};
    return sweep != NULL;
}

static bool add_prism(struct bevelled *out, struct arena *arena, const struct prism_input *input, struct error *error) {
    const struct prism *prism = prism_build(arena, input, error);
    if (prism)
        out->pieces[out->count++] = (struct piece){.kind = PIECE_PRISM, .prism = prism};
    return prism != NULL;
}

static struct bevelled *bevelled_end(struct bevelled *out) {
    double lo[3], hi[3];
    for (int i = 0; i < 3; i++)
        bevelled_extent(out, vec3_make(i == 0, i == 1, i == 2), &lo[i], &hi[i]);
    out->bounds = box_pad((struct box){{lo[0], lo[1], lo[2]}, {hi[0], hi[1], hi[2]}});
    return out;
}

/* --- cylinders --- */

static struct piece ring_of(const struct bevelled_cylinder *in, struct vec3 centre) {
    struct piece out = {.kind = PIECE_RING, .ring = {.torus = {in->radius - in->edge, in->edge}, .centre = centre}};
    out.ring.axes[1] = vec3_normalize(vec3_sub(in->to, in->from));
    frame_tangents(out.ring.axes[1], &out.ring.axes[2], &out.ring.axes[0]);
    return out;
}

const struct bevelled *bevelled_cylinder(struct arena *arena, const struct bevelled_cylinder *in, struct error *error) {
    const struct vec3 axis = vec3_normalize(vec3_sub(in->to, in->from));
    const double length = vec3_length(vec3_sub(in->to, in->from)), inner = in->radius - in->edge;
    const struct vec3 low = vec3_add_scaled(in->from, axis, in->edge), high = vec3_add_scaled(in->to, axis, -in->edge);
    struct bevelled *out = bevelled_make(arena, 4, error);
    if (!out)
        return NULL;
    if (in->chamfer) {
        /* From each end a frustum that gets wider by as much as it is long, and the cylinder. */
        const struct vec3 above = vec3_add_scaled(in->to, axis, length),
                          below = vec3_add_scaled(in->from, axis, -length);
        const struct revolved_quadric rounds[] = {
            revolved_quadric_frustum(in->from, inner, above, inner + 2 * length, false),
            revolved_quadric_frustum(in->to, inner, below, inner + 2 * length, false),
            revolved_quadric_cylinder(below, above, in->radius, false)};
        for (; out->count < 3; out->count++)
            out->pieces[out->count] = (struct piece){.kind = PIECE_ROUND, .round = rounds[out->count]};
        out->needed = out->count;
        return bevelled_end(out);
    }
    out->pieces[0] =
        (struct piece){.kind = PIECE_ROUND, .round = revolved_quadric_cylinder(in->from, in->to, inner, false)};
    out->pieces[1] =
        (struct piece){.kind = PIECE_ROUND, .round = revolved_quadric_cylinder(low, high, in->radius, false)};
    out->pieces[2] = ring_of(in, low);
    out->pieces[3] = ring_of(in, high);
    out->count = 4;
    out->convex = true;
    return bevelled_end(out);
}

/* --- outlines --- */

/* One curve of an outline. */
struct curve {
    const double (*input)[2]; /* its points, without one that closes it */
    uint32_t input_count;
    struct spline_segment *segments; /* unless its lines are straight */
    uint32_t segment_count;
    double (*points)[2];     /* a polygon: its points without repeated ones, or points near the curve */
    uint32_t count, nesting; /* how many curves enclose it */
    bool left;               /* the solid is left of it */
    struct inset_corner *corners;
    double (*inner)[2], (*wide)[2]; /* of the inset outline, and of the one whose corners are cut */
    uint32_t inner_count, wide_count;
};
struct curves {
    struct curve *all;
    uint32_t count, points;
};

static double area_of(const struct curve *curve) {
    double area = 0;
    for (uint32_t i = 0; i < curve->count; i++) {
        const double *a = curve->points[i], *b = curve->points[(i + 1) % curve->count];
        area += (a[0] - curve->points[0][0]) * (b[1] - curve->points[0][1]) -
                (b[0] - curve->points[0][0]) * (a[1] - curve->points[0][1]);
    }
    return area;
}

static bool encloses(const struct curve *curve, const double point[2]) {
    bool inside = false;
    for (uint32_t i = 0; i < curve->count; i++) {
        const double *a = curve->points[i], *b = curve->points[(i + 1) % curve->count];
        if ((a[1] > point[1]) != (b[1] > point[1]))
            inside ^= a[0] + (point[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0]) > point[0];
    }
    return inside;
}

/* The polygon of a curve. */
static bool find_points(struct curve *curve, struct arena *arena, const struct prism_input *in, struct error *error) {
    if (in->kind == SPLINE_LINEAR) {
        curve->points = arena_alloc_array(arena, curve->input_count, sizeof *curve->points);
        for (uint32_t i = 0; curve->points && i < curve->input_count; i++) {
            const double *at = curve->input[i], *next = curve->input[(i + 1) % curve->input_count];
            if (at[0] != next[0] || at[1] != next[1])
                memcpy(curve->points[curve->count++], at, sizeof *curve->points);
        }
        return curve->points || error_no_memory(error, "a prism");
    }
    const struct spline_input spline = {
        .kind = in->kind, .dimensions = 2, .points = &curve->input[0][0], .count = curve->input_count, .closed = true};
    if (!spline_build(arena, &spline, &curve->segments, &curve->segment_count, error))
        return false;
    curve->count = CHORDS * curve->segment_count;
    curve->points = arena_alloc_array(arena, curve->count, sizeof *curve->points);
    for (uint32_t i = 0; curve->points && i < curve->count; i++)
        for (int k = 0; k < 2; k++)
            curve->points[i][k] = cubic_value(curve->segments[i / CHORDS].b[k], (double)(i % CHORDS) / CHORDS);
    return curve->points || error_no_memory(error, "a prism");
}

/* Of an outline that a prism has accepted. */
static bool find_curves(struct curves *curves, struct arena *arena, const struct prism_input *in, struct error *error) {
    curves->count = in->curve_count;
    curves->all = arena_alloc_array(arena, curves->count, sizeof *curves->all);
    if (!curves->all)
        return error_no_memory(error, "a prism");
    memset(curves->all, 0, curves->count * sizeof *curves->all);
    for (uint32_t k = 0; k < curves->count; k++) {
        struct curve *curve = &curves->all[k];
        curve->input = in->points + in->curve_starts[k];
        curve->input_count = in->curve_starts[k + 1] - in->curve_starts[k];
        const double *first = curve->input[0], *last = curve->input[curve->input_count - 1];
        if (first[0] == last[0] && first[1] == last[1] && (in->kind != SPLINE_BEZIER || curve->input_count % 3 == 1))
            curve->input_count--;
        if (!find_points(curve, arena, in, error))
            return false;
        curves->points += curve->count;
    }
    if (curves->points > POINTS_LIMIT)
        return error_set(error, ERROR_SCENE, "edge is for outlines of at most %d points", POINTS_LIMIT);
    for (uint32_t k = 0; k < curves->count; k++) {
        struct curve *curve = &curves->all[k];
        for (uint32_t i = 0; i < curves->count; i++)
            curve->nesting += i != k && encloses(&curves->all[i], curve->points[0]);
        curve->left = (area_of(curve) > 0) == (curve->nesting % 2 == 0);
    }
    return true;
}

/* Of straight lines: the corners of the inset outline, and points where convex corners are cut. */
static bool find_corners(struct curve *curve, struct arena *arena, double edge, struct error *error) {
    curve->corners = arena_alloc_array(arena, curve->count, sizeof *curve->corners);
    curve->inner = arena_alloc_array(arena, curve->count, sizeof *curve->inner);
    curve->wide = arena_alloc_array(arena, 2 * (size_t)curve->count, sizeof *curve->wide);
    if (!curve->corners || !curve->inner || !curve->wide)
        return error_no_memory(error, "a prism");
    if (!inset_corners((const double(*)[2])curve->points, curve->count, curve->left, edge, curve->corners, error))
        return false;
    for (uint32_t i = 0; i < curve->count; i++) {
        const struct inset_corner *corner = &curve->corners[i];
        memcpy(curve->inner[curve->inner_count++], corner->inner, sizeof *curve->inner);
        memcpy(curve->wide[curve->wide_count++], corner->before, sizeof *curve->wide);
        if (corner->convex)
            memcpy(curve->wide[curve->wide_count++], corner->after, sizeof *curve->wide);
    }
    return true;
}

static bool is_inside(const struct curves *curves, const double point[2]) {
    uint32_t count = 0;
    for (uint32_t i = 0; i < curves->count; i++)
        count += encloses(&curves->all[i], point);
    return count % 2 == 1;
}

/* Whether the inset outline is inside, far enough from all of the outline; `slack` is for curves. */
static bool check_clear(const struct curves *curves, double edge, double slack, struct error *error) {
    for (uint32_t k = 0; k < curves->count; k++)
        for (uint32_t p = 0; p<curves->all[k].inner_count; p += slack> 0 ? 3 : 1) {
            const double *point = curves->all[k].inner[p];
            bool clear = is_inside(curves, point);
            for (uint32_t i = 0; clear && i < curves->count; i++)
                clear = inset_is_clear((const double(*)[2])curves->all[i].points, curves->all[i].count, point,
                                       edge * (1 - slack));
            if (!clear)
                return error_set(error, ERROR_SCENE, "edge (%g) is too large for the outline near {%g, %g}", edge,
                                 point[0], point[1]);
        }
    return true;
}

/* The inset outline or the one with cut corners as a prism. */
static bool prism_of(const struct curves *curves, bool inner, struct arena *arena, struct prism_input *out,
                     struct error *error) {
    size_t all = 0;
    for (uint32_t k = 0; k < curves->count; k++)
        all += inner ? curves->all[k].inner_count : curves->all[k].wide_count;
    double(*points)[2] = arena_alloc_array(arena, all, sizeof *points);
    uint32_t *starts = arena_alloc_array(arena, (size_t)curves->count + 1, sizeof *starts);
    if (!points || !starts)
        return error_no_memory(error, "a prism");
    starts[0] = 0;
    for (uint32_t k = 0; k < curves->count; k++) {
        const struct curve *curve = &curves->all[k];
        uint32_t count = inner ? curve->inner_count : curve->wide_count;
        memcpy(points + starts[k], inner ? curve->inner : curve->wide, count * sizeof *points);
        starts[k + 1] = starts[k] + count;
    }
    out->points = (const double(*)[2])points;
    out->curve_starts = starts;
    return true;
}

/* --- rounded prisms --- */

struct rounding {
    struct arena *arena, *work;
    struct bevelled *out;
    const struct prism_input *in;
    double radius;
};

/* A path of balls. */
static bool add_balls(struct rounding *r, enum spline_kind kind, double (*path)[3], uint32_t count,
                      struct error *error) {
    double *radii = arena_alloc_array(r->work, count, sizeof *radii);
    if (!radii)
        return error_no_memory(error, "a prism");
    for (uint32_t i = 0; i < count; i++)
        radii[i] = r->radius;
    const struct sweep_input sweep = {.kind = kind,
                                      .points = (const double(*)[3])path,
                                      .radii = radii,
                                      .count = count,
                                      .loop = kind == SPLINE_BEZIER};
    return add_sweep(r->out, r->arena, &sweep, error);
}

static void put(double (*path)[3], uint32_t *count, const double point[2], double y) {
    double *at = path[(*count)++];
    at[0] = point[0], at[1] = y, at[2] = point[1];
}

/* Straight lines: balls run around the bottom, then around the top, from there down and up again at convex corners. */
static bool round_corners(struct rounding *r, const struct curve *curve, struct error *error) {
    const double low = r->in->from + r->radius, high = r->in->to - r->radius;
    double(*path)[3] = arena_alloc_array(r->work, (size_t)4 * curve->count + 4, sizeof *path);
    uint32_t count = 0;
    if (!path)
        return error_no_memory(error, "a prism");
    for (uint32_t i = 0; i <= curve->count; i++)
        put(path, &count, curve->inner[i % curve->count], low);
    for (uint32_t i = 0; i <= curve->count; i++) {
        put(path, &count, curve->inner[i % curve->count], high);
        if (i > 0 && i < curve->count && curve->corners[i].convex) {
            put(path, &count, curve->inner[i], low);
            put(path, &count, curve->inner[i], high);
        }
    }
    return add_balls(r, SPLINE_LINEAR, path, count, error);
}

/* Smooth curves: balls run around the bottom and the top. */
static bool round_curve(struct rounding *r, const struct curve *curve, struct error *error) {
    for (int k = 0; k < 2; k++) {
        const double y = k == 0 ? r->in->from + r->radius : r->in->to - r->radius;
        double(*path)[3] = arena_alloc_array(r->work, curve->inner_count, sizeof *path);
        uint32_t count = 0;
        if (!path)
            return error_no_memory(error, "a prism");
        for (uint32_t i = 0; i < curve->inner_count; i++)
            put(path, &count, curve->inner[i], y);
        if (!add_balls(r, SPLINE_BEZIER, path, count, error))
            return false;
    }
    return true;
}

static bool check_height(const struct prism_input *in, double edge, struct error *error) {
    return 2 * edge < in->to - in->from ||
           error_set(error, ERROR_SCENE, "edge (%g) must be less than half of the height (%g)", edge,
                     in->to - in->from);
}

const struct bevelled *bevelled_prism(struct arena *arena, struct arena *work, const struct prism_input *in,
                                      double radius, struct error *error) {
    const bool straight = in->kind == SPLINE_LINEAR;
    struct rounding r = {.arena = arena, .work = work, .in = in, .radius = radius};
    struct curves curves = {0};
    struct prism_input inner = *in, wide = *in;
    /* The curves, each inset by itself. */
    if (!prism_build(work, in, error) || !check_height(in, radius, error) || !find_curves(&curves, work, in, error))
        return NULL;
    for (uint32_t k = 0; k < curves.count; k++) {
        struct curve *curve = &curves.all[k];
        struct inset_points inner_points = {0};
        if (straight ? !find_corners(curve, work, radius, error)
                     : !inset_curve(work, curve->segments, curve->segment_count, curve->left ? radius : -radius,
                                    &inner_points, error))
            return NULL;
        if (!straight) {
            curve->inner = inner_points.items;
            curve->inner_count = inner_points.count;
        }
    }
    if (!check_clear(&curves, radius, straight ? 0 : 0.02, error))
        return NULL;
    /* Two prisms, and the balls around them. */
    if (!prism_of(&curves, true, work, &inner, error) || (straight && !prism_of(&curves, false, work, &wide, error)))
        return NULL;
    inner.kind = straight ? SPLINE_LINEAR : SPLINE_BEZIER;
    wide.from += radius;
    wide.to -= radius;
    r.out = bevelled_make(arena, 2 + 2 * curves.count, error);
    if (!r.out || !add_prism(r.out, arena, &inner, error) || !add_prism(r.out, arena, &wide, error))
        return NULL;
    r.out->convex = straight && curves.count == 1 && curves.all[0].wide_count == 2 * curves.all[0].count;
    for (uint32_t k = 0; k < curves.count; k++)
        if (straight ? !round_corners(&r, &curves.all[k], error) : !round_curve(&r, &curves.all[k], error))
            return NULL;
    return bevelled_end(r.out);
}

/* --- chamfered prisms --- */

/* Faces that a mesh is made of. Heights 0 and 3: the inset outline at the bottom and at the top; 1 and 2: the outline
 * with cut corners. */
struct faces {
    struct chamfered_prism *out;
    uint32_t corners;                 /* of all faces so far */
    uint32_t inner_count, wide_count; /* of all curves */
};

static uint32_t vertex_of(const struct faces *faces, int height, uint32_t number) {
    switch (height) {
    case 0:
        return number;
    case 1:
        return faces->inner_count + number;
    case 2:
        return faces->inner_count + faces->wide_count + number;
    default:
        return faces->inner_count + 2 * faces->wide_count + number;
    }
}

/* Four corners, or three if the last one is UINT32_MAX; from outside, unless the solid is right of the outline. */
static void add_face(struct faces *faces, bool left, const uint32_t corners[4]) {
    struct chamfered_prism *out = faces->out;
    uint32_t count = corners[3] == UINT32_MAX ? 3 : 4;
    for (uint32_t i = 0; i < count; i++)
        out->vertex_index[faces->corners++] = corners[left ? i : count - 1 - i];
    out->face_start[++out->face_count] = faces->corners;
}

/* All faces along a curve. */
static void add_sides(struct faces *faces, const struct curve *curve, uint32_t inner, uint32_t wide) {
    uint32_t at = 0;
    for (uint32_t i = 0; i < curve->count; i++) {
        const uint32_t before = wide + at, after = before + curve->corners[i].convex;
        const uint32_t next = wide + (at += 1 + curve->corners[i].convex) % curve->wide_count;
        const uint32_t own = inner + i, other = inner + (i + 1) % curve->count;
        const bool left = curve->left;
        /* From this corner to the next one: bottom chamfer, wall, top chamfer. */
        add_face(faces, left,
                 (uint32_t[4]){vertex_of(faces, 0, own), vertex_of(faces, 1, after), vertex_of(faces, 1, next),
                               vertex_of(faces, 0, other)});
        add_face(faces, left,
                 (uint32_t[4]){vertex_of(faces, 1, after), vertex_of(faces, 2, after), vertex_of(faces, 2, next),
                               vertex_of(faces, 1, next)});
        add_face(faces, left,
                 (uint32_t[4]){vertex_of(faces, 2, after), vertex_of(faces, 3, own), vertex_of(faces, 3, other),
                               vertex_of(faces, 2, next)});
        if (before == after)
            continue;
        /* The corner that is cut. */
        add_face(faces, left,
                 (uint32_t[4]){vertex_of(faces, 0, own), vertex_of(faces, 1, before), vertex_of(faces, 1, after),
                               UINT32_MAX});
        add_face(faces, left,
                 (uint32_t[4]){vertex_of(faces, 1, before), vertex_of(faces, 2, before), vertex_of(faces, 2, after),
                               vertex_of(faces, 1, after)});
        add_face(faces, left,
                 (uint32_t[4]){vertex_of(faces, 2, before), vertex_of(faces, 3, own), vertex_of(faces, 2, after),
                               UINT32_MAX});
    }
}

/* A polygon of inner points; holes become a part of it by bridges (two corners visited twice). */
struct cap {
    const struct curves *curves;
    uint32_t *curve, *point; /* of each corner */
    uint32_t count;
};

static const double *at_cap(const struct cap *cap, uint32_t i) {
    return cap->curves->all[cap->curve[i % cap->count]].inner[cap->point[i % cap->count]];
}

/* Point number i of a curve with the solid left of it. */
static uint32_t forward(const struct curve *curve, uint32_t i) {
    i %= curve->inner_count;
    return curve->left ? i : curve->inner_count - 1 - i;
}

static double turn(const double a[2], const double b[2], const double c[2]) {
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/* Whether the point is between the lines of a corner, on the side of the solid. */
static bool in_corner(const double before[2], const double at[2], const double after[2], const double point[2]) {
    bool one = turn(before, at, point) > 0, other = turn(at, after, point) > 0;
    return turn(before, at, after) > 0 ? one && other : one || other;
}

static bool crosses(const double a[2], const double b[2], const double c[2], const double d[2]) {
    return (turn(a, b, c) > 0) != (turn(a, b, d) > 0) && (turn(c, d, a) > 0) != (turn(c, d, b) > 0);
}

static bool same(const double a[2], const double b[2]) {
    return a[0] == b[0] && a[1] == b[1];
}

/* Whether no line of the curves is between two points of them. */
static bool sees(const struct curves *curves, const double a[2], const double b[2]) {
    for (uint32_t k = 0; k < curves->count; k++)
        for (uint32_t i = 0; i < curves->all[k].inner_count; i++) {
            const double *c = curves->all[k].inner[i], *d = curves->all[k].inner[(i + 1) % curves->all[k].inner_count];
            if (!same(a, c) && !same(a, d) && !same(b, c) && !same(b, d) && crosses(a, b, c, d))
                return false;
        }
    return true;
}

static uint32_t rightmost(const struct curve *curve) {
    uint32_t best = 0;
    for (uint32_t i = 1; i < curve->inner_count; i++)
        best = curve->inner[forward(curve, i)][0] > curve->inner[forward(curve, best)][0] ? i : best;
    return best;
}

/* Joins a hole at its rightmost point to the nearest corner that is seen from there. */
static void join_hole(struct cap *cap, uint32_t hole) {
    const struct curve *curve = &cap->curves->all[hole];
    const uint32_t start = rightmost(curve);
    const double *from = curve->inner[forward(curve, start)],
                 *before = curve->inner[forward(curve, start + curve->inner_count - 1)],
                 *after = curve->inner[forward(curve, start + 1)];
    double nearest = INFINITY;
    uint32_t to = 0, made = 0;
    for (uint32_t i = 0; i < cap->count; i++) {
        const double *at = at_cap(cap, i), x = at[0] - from[0], y = at[1] - from[1];
        if (x * x + y * y < nearest && in_corner(before, from, after, at) &&
            in_corner(at_cap(cap, i + cap->count - 1), at, at_cap(cap, i + 1), from) && sees(cap->curves, from, at)) {
            nearest = x * x + y * y;
            to = i;
        }
    }
    /* The rest of the polygon moves behind the hole and the two ends of the bridge. */
    const uint32_t rest = cap->count - to, added = curve->inner_count + 2;
    for (uint32_t i = 0; i < rest; i++) {
        cap->curve[cap->count + added - 1 - i] = cap->curve[cap->count - 1 - i];
        cap->point[cap->count + added - 1 - i] = cap->point[cap->count - 1 - i];
    }
    for (uint32_t i = 0; i <= curve->inner_count; i++, made++) {
        cap->curve[to + 1 + made] = hole;
        cap->point[to + 1 + made] = forward(curve, start + i);
    }
    cap->count += added;
}

/* A curve with the holes that are directly in it. */
static void fill_cap(struct cap *cap, uint32_t outer, bool *joined) {
    const struct curve *outline = &cap->curves->all[outer];
    cap->count = outline->inner_count;
    for (uint32_t i = 0; i < cap->count; i++) {
        cap->curve[i] = outer;
        cap->point[i] = forward(outline, i);
    }
    /* Those that reach farthest to the right first: they see a corner that is already joined. */
    for (;;) {
        uint32_t next = UINT32_MAX;
        double right = -INFINITY;
        for (uint32_t k = 0; k < cap->curves->count; k++) {
            const struct curve *hole = &cap->curves->all[k];
            double x = hole->inner[forward(hole, rightmost(hole))][0];
            if (!joined[k] && hole->nesting == outline->nesting + 1 && encloses(outline, hole->points[0]) &&
                x > right) {
                right = x;
                next = k;
            }
        }
        if (next == UINT32_MAX)
            return;
        joined[next] = true;
        join_hole(cap, next);
    }
}

static bool add_caps(struct faces *faces, const struct curves *curves, struct arena *arena, struct error *error) {
    const size_t room = (size_t)faces->inner_count + 2 * (size_t)curves->count;
    struct cap cap = {.curves = curves,
                      .curve = arena_alloc_array(arena, room, sizeof *cap.curve),
                      .point = arena_alloc_array(arena, room, sizeof *cap.point)};
    bool *joined = arena_alloc_array(arena, curves->count, sizeof *joined);
    uint32_t *first = arena_alloc_array(arena, curves->count, sizeof *first), all = 0;
    struct chamfered_prism *out = faces->out;
    if (!cap.curve || !cap.point || !joined || !first)
        return error_no_memory(error, "a prism");
    for (uint32_t k = 0; k < curves->count; all += curves->all[k++].inner_count) {
        joined[k] = false;
        first[k] = all;
    }
    for (uint32_t k = 0; k < curves->count; k++) {
        if (curves->all[k].nesting % 2 != 0)
            continue;
        fill_cap(&cap, k, joined);
        for (int height = 0; height <= 3; height += 3) {
            for (uint32_t i = 0; i < cap.count; i++) {
                uint32_t at = height == 0 ? i : cap.count - 1 - i;
                out->vertex_index[faces->corners++] = vertex_of(faces, height, first[cap.curve[at]] + cap.point[at]);
            }
            out->face_start[++out->face_count] = faces->corners;
        }
    }
    return true;
}

bool chamfered_prism(struct arena *arena, const struct prism_input *in, double edge, struct chamfered_prism *out,
                     struct error *error) {
    struct curves curves = {0};
    struct faces faces = {.out = out};
    if (in->kind != SPLINE_LINEAR)
        return error_set(error, ERROR_SCENE, "chamfer = true needs an outline of straight lines");
    if (!prism_build(arena, in, error) || !check_height(in, edge, error) || !find_curves(&curves, arena, in, error))
        return false;
    for (uint32_t k = 0; k < curves.count; k++) {
        if (!find_corners(&curves.all[k], arena, edge, error))
            return false;
        faces.inner_count += curves.all[k].inner_count;
        faces.wide_count += curves.all[k].wide_count;
    }
    if (!check_clear(&curves, edge, 0, error))
        return false;
    /* Vertices, height by height. */
    const size_t corners = faces.inner_count;
    *out = (struct chamfered_prism){
        .vertex_count = 2 * (faces.inner_count + faces.wide_count),
        .vertices = arena_alloc_array(arena, 2 * (corners + faces.wide_count), sizeof *out->vertices),
        .face_start = arena_alloc_array(arena, 6 * corners + 2 * (size_t)curves.count + 1, sizeof *out->face_start),
        .vertex_index = arena_alloc_array(arena, 24 * corners + 4 * (size_t)curves.count, sizeof *out->vertex_index)};
    if (!out->vertices || !out->face_start || !out->vertex_index)
        return error_no_memory(error, "a prism");
    const double heights[4] = {in->from, in->from + edge, in->to - edge, in->to};
    uint32_t made = 0;
    for (int height = 0; height < 4; height++)
        for (uint32_t k = 0; k < curves.count; k++) {
            const struct curve *curve = &curves.all[k];
            const bool inner = height % 3 == 0;
            for (uint32_t i = 0; i < (inner ? curve->inner_count : curve->wide_count); i++)
                put(out->vertices, &made, inner ? curve->inner[i] : curve->wide[i], heights[height]);
        }
    /* Faces: sides, then caps. */
    out->face_start[0] = 0;
    uint32_t inner = 0, wide = 0;
    for (uint32_t k = 0; k < curves.count; k++) {
        add_sides(&faces, &curves.all[k], inner, wide);
        inner += curves.all[k].inner_count;
        wide += curves.all[k].wide_count;
    }
    return add_caps(&faces, &curves, arena, error);
}

static void bundle_piece(struct bundle *bundle, void *of_solid) {
    struct piece *piece = of_solid;
    if (piece->kind == PIECE_PRISM)
        prism_bundle(bundle, &piece->prism);
    else if (piece->kind == PIECE_SWEEP)
        sweep_bundle(bundle, &piece->sweep);
}

static void bundle_tables(struct bundle *bundle, void *tables) {
    struct bevelled *bevelled = tables;
    BUNDLE(bundle, bevelled->pieces, bevelled->count, bundle_piece);
}

void bevelled_bundle(struct bundle *bundle, const struct bevelled **bevelled) {
    BUNDLE(bundle, *bevelled, 1, bundle_tables);
}
