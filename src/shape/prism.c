/* The prism. Seen along y the line is a line in the plane of the outline, (o + u d) with a unit direction d; a piece of
 * the outline is crossed where n . (P(x) - o) = 0, n across d: a cubic in Bernstein form whose end values depend only
 * on the end points, so on closed curves the number of crossings is even in spite of rounding. Sorted, they give the
 * parts of the line inside the infinite prism; each is clipped to the slab between the two heights. For a line along y,
 * its one point in the outline decides. (Kajiya, "New techniques for ray tracing procedurally defined objects",
 * SIGGRAPH 1983, has the prism as a problem of the plane.) */
#include "shape/prism.h"

#include "geometry/bernstein.h"
#include "shape/part_tree_internal.h"

struct prism {
    struct outline outline; /* all curves */
    struct part_tree tree;  /* x and z; y is 0 */
    struct box bounds;
};

const struct prism *prism_build(struct arena *arena, const struct prism_input *in, struct error *error) {
    struct prism *prism = arena_alloc(arena, sizeof *prism);
    struct outline *curves = arena_alloc_array(arena, in->curve_count, sizeof *curves);
    if (!prism || !curves) {
        error_no_memory(error, "a prism");
        return NULL;
    }
    if (!(in->from < in->to) || !isfinite(in->from) || !isfinite(in->to)) {
        error_set(error, ERROR_SCENE, "the height 'from' (%g) must be below 'to' (%g)", in->from, in->to);
        return NULL;
    }
    /* Each curve becomes pieces without a turn. */
    uint32_t total = 0;
    for (uint32_t k = 0; k < in->curve_count; k++) {
        const double(*points)[2] = in->points + in->curve_starts[k];
        uint32_t count = in->curve_starts[k + 1] - in->curve_starts[k];
        for (uint32_t i = 0; i < count; i++)
            if (!isfinite(points[i][0]) || !isfinite(points[i][1]) ||
                math_max(fabs(points[i][0]), fabs(points[i][1])) > 0x1p300) {
                error_set(error, ERROR_SCENE, "point %u of curve %u of the outline is not a usable number", i + 1,
                          k + 1);
                return NULL;
            }
        /* A first point that is repeated at the end closes the curve, which is closed anyway. */
        if (count > 1 && points[0][0] == points[count - 1][0] && points[0][1] == points[count - 1][1] &&
            (in->kind != SPLINE_BEZIER || count % 3 == 1))
            count--;
        struct spline_input spline = {
            .kind = in->kind, .dimensions = 2, .points = &points[0][0], .count = count, .closed = true};
        struct spline_segment *segments;
        uint32_t segment_count;
        if (!spline_build(arena, &spline, &segments, &segment_count, error) ||
            !outline_build(arena, segments, segment_count, in->kind == SPLINE_LINEAR, &curves[k], error)) {
            error_prefix(error, "curve %u of the outline", k + 1);
            return NULL;
        }
        total += curves[k].count;
    }
    prism->outline.pieces = arena_alloc_array(arena, total, sizeof *prism->outline.pieces);
    struct box *boxes = arena_alloc_array(arena, total, sizeof *boxes), bounds = box_empty();
    if (!prism->outline.pieces || !boxes) {
        error_no_memory(error, "a prism");
        return NULL;
    }
    /* All pieces in one list, over which the tree is built. */
    uint32_t at = 0;
    for (uint32_t k = 0; k < in->curve_count; k++)
        for (uint32_t i = 0; i < curves[k].count; i++, at++) {
            const struct outline_piece *c = &curves[k].pieces[i];
            prism->outline.pieces[at] = *c;
            boxes[at] = box_add_point(box_add_point(box_empty(), vec3_make(c->p[0], 0, c->q[0])),
                                      vec3_make(c->p[3], 0, c->q[3]));
            bounds = box_join(bounds, boxes[at]);
        }
    prism->outline.count = total;
    if (!(bounds.min.x < bounds.max.x && bounds.min.z < bounds.max.z)) {
        error_set(error, ERROR_SCENE, "the outline has no area");
        return NULL;
    }
    if (!part_tree_build(arena, boxes, total, 2, &prism->tree)) {
        error_no_memory(error, "a prism");
        return NULL;
    }
    bounds.min.y = in->from;
    bounds.max.y = in->to;
    prism->bounds = bounds;
    return prism;
}

struct box prism_bounds(const struct prism *prism) {
    struct box padded = box_pad(prism->bounds);
    padded.min.y = prism->bounds.min.y; /* the caps are exactly there */
    padded.max.y = prism->bounds.max.y;
    return padded;
}

void prism_extent(const struct prism *prism, struct vec3 g, double *lo, double *hi) {
    *lo = INFINITY, *hi = -INFINITY;
    for (uint32_t i = 0; i < prism->outline.count; i++) {
        const struct outline_piece *c = &prism->outline.pieces[i];
        double sum[4];
        for (int k = 0; k < 4; k++)
            sum[k] = g.x * c->p[k] + g.z * c->q[k];
        outline_range(sum, lo, hi);
    }
    double bottom = g.y * prism->bounds.min.y, top = g.y * prism->bounds.max.y;
    *lo += math_min(bottom, top);
    *hi += math_max(bottom, top);
}

uint32_t prism_scratch_need(const struct prism *prism) {
    return prism->outline.count < 64 ? 2 * prism->outline.count + 2 : 256;
}

/* Whether the line in the plane meets a box. */
static bool meets(double ox, double oz, double dx, double dz, const struct box *box) {
    /* The corners' distances from the line are centre +- extent. */
    double cx = box->min.x / 2 + box->max.x / 2 - ox, cz = box->min.z / 2 + box->max.z / 2 - oz;
    double ex = box->max.x / 2 - box->min.x / 2, ez = box->max.z / 2 - box->min.z / 2;
    return fabs(dx * cz - dz * cx) <= fabs(dx) * ez + fabs(dz) * ex;
}

/* Crossings of the outline with the line in the plane, t being the way along it. */
static bool outline_crossings(const struct prism *prism, double ox, double oz, double dx, double dz,
                              struct geom_scratch *scratch) {
    for (uint32_t n = 0; n < prism->tree.node_count;) {
        const struct part_node *node = &prism->tree.nodes[n];
        if (!meets(ox, oz, dx, dz, &node->box)) {
            n = node->skip;
            continue;
        }
        for (uint32_t i = 0; i < node->count; i++) {
            uint32_t part = prism->tree.order[node->first + i];
            const struct outline_piece *c = &prism->outline.pieces[part];
            double b[4], roots[3];
            for (int k = 0; k < 4; k++)
                b[k] = dx * (c->q[k] - oz) - dz * (c->p[k] - ox);
            /* Where the piece crosses the line in the plane. */
            int count = 0;
            if (!c->straight) {
                count = bernstein_roots(b, 3, roots);
            } else if ((b[0] < 0) != (b[3] < 0)) {
                roots[0] = b[0] / (b[0] - b[3]);
                count = 1;
            }
            for (int k = 0; k < count; k++) {
                double x = roots[k], along = dx * (cubic_value(c->p, x) - ox) + dz * (cubic_value(c->q, x) - oz);
                if (!geom_scratch_push(scratch, (struct crossing){.t = along, .u = x, .part = PRISM_SIDES + part}))
                    return false;
            }
        }
        n++;
    }
    return true;
}

bool prism_crossings(const struct prism *prism, const struct ray *ray, struct geom_scratch *scratch,
                     struct crossing_list *out) {
    *out = (struct crossing_list){scratch->used, 0};
    struct line line;
    struct vec3 centre = vec3_add(vec3_scale(prism->bounds.min, 0.5), vec3_scale(prism->bounds.max, 0.5));
    if (!line_init(&line, ray, centre))
        return true;
    struct vec3 o = line.origin, d = line.direction;

    /* The part of the line between the two heights, in s. */
    double enter = -INFINITY, leave = INFINITY;
    uint32_t enter_part = d.y > 0 ? PRISM_BOTTOM : PRISM_TOP, leave_part = d.y > 0 ? PRISM_TOP : PRISM_BOTTOM;
    if (d.y != 0) {
        enter = ((d.y > 0 ? prism->bounds.min.y : prism->bounds.max.y) - o.y) / d.y;
        leave = ((d.y > 0 ? prism->bounds.max.y : prism->bounds.min.y) - o.y) / d.y;
    } else if (!(o.y > prism->bounds.min.y && o.y < prism->bounds.max.y)) {
        return true;
    }
    double across = sqrt(d.x * d.x + d.z * d.z);
    bool upright = across < 0x1p-300;
    double dx = upright ? 1 : d.x / across, dz = upright ? 0 : d.z / across;
    if (!outline_crossings(prism, o.x, o.z, dx, dz, scratch)) {
        scratch->used = out->first;
        return false;
    }
    uint32_t count = scratch->used - out->first;
    struct crossing *items = &scratch->items[out->first];
    crossings_sort(items, count);

    /* Two results for two inputs, so the result can overwrite the input. */
    uint32_t kept = 0;
    for (uint32_t i = 0; i + 1 < count; i += 2) {
        struct crossing a = items[i], b = items[i + 1];
        if (upright) {
            if (!(a.t <= 0 && b.t > 0))
                continue;
            a.t = -INFINITY;
            b.t = INFINITY;
        } else {
            a.t /= across;
            b.t /= across;
        }
        if (a.t <= enter)
            a = (struct crossing){.t = enter, .part = enter_part};
        if (b.t >= leave)
            b = (struct crossing){.t = leave, .part = leave_part};
        if (!(a.t < b.t))
            continue;
        items[kept++] = a;
        items[kept++] = b;
    }
    scratch->used = out->first + kept;
    line_finish_closed(&line, scratch, out->first, out);
    return true;
}

/* Even-odd along x. */
bool prism_contains(const struct prism *prism, struct vec3 point) {
    if (!box_contains(&prism->bounds, point))
        return false;
    bool inside = false;
    for (uint32_t i = 0; i < prism->outline.count; i++) {
        const struct outline_piece *c = &prism->outline.pieces[i];
        if ((c->q[0] > point.z) == (c->q[3] > point.z))
            continue;
        double b[4], roots[3], x = (point.z - c->q[0]) / (c->q[3] - c->q[0]);
        for (int k = 0; k < 4; k++)
            b[k] = point.z - c->q[k];
        if (!c->straight)
            x = bernstein_roots(b, 3, roots) > 0 ? roots[0] : 0.5;
        inside ^= cubic_value(c->p, x) > point.x;
    }
    return inside;
}

void prism_describe(const struct prism *prism, const struct ray *ray, const struct crossing *crossing,
                    struct surface *out) {
    struct vec3 p = ray_at(ray, crossing->t), n = {0, 0, 0}, min = prism->bounds.min, max = prism->bounds.max;
    struct vec3 size = vec3_sub(max, min);
    double extent = math_max(vec3_max_abs(min), vec3_max_abs(max));
    *out = (struct surface){.has_uv = true, .error = 0x1p-48 * extent};
    if (crossing->part < PRISM_SIDES) {
        bool top = crossing->part == PRISM_TOP;
        n.y = top ? 1 : -1;
        p.y = top ? max.y : min.y;
        out->u = (p.x - min.x) / size.x;
        out->v = top ? (max.z - p.z) / size.z : (p.z - min.z) / size.z;
        out->dpdu = vec3_make(size.x, 0, 0);
        out->dpdv = vec3_make(0, 0, top ? -size.z : size.z);
    } else {
        const struct outline_piece *c = &prism->outline.pieces[crossing->part - PRISM_SIDES];
        double dp, dq, by_length = c->to > c->from ? 1 / (c->to - c->from) : 0;
        outline_tangent(c, crossing->u, &dp, &dq);
        p = vec3_make(cubic_value(c->p, crossing->u), math_min(math_max(p.y, min.y), max.y),
                      cubic_value(c->q, crossing->u));
        n = vec3_normalize(vec3_make(dq, 0, -dp));
        if ((vec3_dot(n, ray->direction) < 0) != crossing->enter)
            n = vec3_negate(n);
        out->u = c->from + (c->to - c->from) * crossing->u;
        out->v = (p.y - min.y) / size.y;
        out->dpdu = vec3_make(by_length * dp, 0, by_length * dq);
        out->dpdv = vec3_make(0, size.y, 0);
        if (dp * n.z - dq * n.x < 0) { /* the outline runs in the other direction */
            out->u = 1 - out->u;
            out->dpdu = vec3_negate(out->dpdu);
        }
    }
    out->point = out->pattern_point = p;
    out->normal = out->shading_normal = out->pattern_normal = n;
}

static void bundle_tables(struct bundle *bundle, void *tables) {
    struct prism *prism = tables;
    outline_bundle(bundle, &prism->outline);
    part_tree_bundle(bundle, &prism->tree);
}

void prism_bundle(struct bundle *bundle, const struct prism **prism) {
    BUNDLE(bundle, *prism, 1, bundle_tables);
}
