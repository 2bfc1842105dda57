/* CSG by one sweep along the line. Every leaf is closed, so its crossings cut the line into inside and outside; the
 * lists of all leaves are merged by t, and the truth of the whole expression is tracked (csg_build.c has the tree that
 * makes one change cheap). The surface is where it changes. A mesh counts by parity, for any orientation of its
 * triangles.
 *
 * Coincident faces. Operands have their own transforms, so faces that should coincide differ by rounding. A
 * crossing has a bound of the error of its t: the rounding errors of the ray in the leaf's space at that place,
 * relative to the numbers they came from, divided by the cosine at the surface. Crossings with overlapping error
 * intervals cannot be distinguished; they form a group and take effect together:
 *   - a leaf that crosses an even number of times within a group does not cross;
 *   - while the line is outside the solid, first all that subtract take effect, then those that add; while it is
 * inside, first those that add, then those that subtract; each in the order of the operands. More true leaves (counted
 * with their sign) can only make the expression true, so it changes at most once in a group, and the crossing that
 * changes it is the surface. Hence the union of touching solids has no inner wall, a difference with a common face
 * leaves no skin, the intersection of touching solids is empty, and of two coincident faces the same operand is always
 * visible. A solid thinner than the rounding error is invisible. The truth of a clip is tracked by the same rule; a
 * surface that coincides with the clip's is visible.
 *
 * Leaves that contain the solid are tested first: a ray that misses one misses the solid, and after it leaves one there
 * are no more crossings. Every other leaf is tested when the sweep reaches the box in which it matters: the argument of
 * csg_build.c that a leaf may be taken as false outside its box is true at every single point.
 *
 * The truth of nodes and leaves lives on the scratch, above what was there; nothing is allocated inside a ray. */
#include "csg/csg.h"

#include "csg/csg_build_internal.h"

/* The error of a crossing is bounded by so many times the magnitudes that went into it: each of the few operations and
 * each transform in a chain of some dozens costs 2^-53. */
#define ROUNDING 0x1p-47
/* Errors are looked at only where two t are closer than this, relative to the numbers involved. */
#define COARSE 0x1p-20

/* ---- order ---- */

static bool comes_before(const void *one, const void *other) {
    const struct crossing *a = one, *b = other;
    if (a->t != b->t)
        return a->t < b->t;
    if (a->leaf != b->leaf)
        return a->leaf < b->leaf;
    if (a->part != b->part)
        return a->part < b->part;
    return a->enter && !b->enter;
}

static bool comes_before_by_leaf(const void *one, const void *other) {
    const struct crossing *a = one, *b = other;
    return a->leaf != b->leaf ? a->leaf < b->leaf : comes_before(a, b);
}

/* The first `sorted` are in order already. The order is total, so it does not matter that neither way of sorting is
 * stable. */
static void sort_crossings(struct crossing *items, uint32_t sorted, uint32_t count, bool by_leaf) {
    if (count <= 48) { /* insertion: a few lists, each in order already */
        for (uint32_t i = sorted > 1 ? sorted : 1; i < count; i++) {
            if (!by_leaf && items[i - 1].t < items[i].t) /* t decides nearly always */
                continue;
            struct crossing moved = items[i];
            uint32_t j = i;
            if (by_leaf)
                for (; j > 0 && comes_before_by_leaf(&moved, &items[j - 1]); j--)
                    items[j] = items[j - 1];
            else
                for (; j > 0 &&
                       (moved.t < items[j - 1].t || (moved.t == items[j - 1].t && comes_before(&moved, &items[j - 1])));
                     j--)
                    items[j] = items[j - 1];
            items[j] = moved;
        }
        return;
    }
    if (by_leaf)
        sort_items(items, count, sizeof *items, comes_before_by_leaf);
    else
        sort_items(items, count, sizeof *items, comes_before);
}

/* ---- the sweep ---- */

/* Leaves whose boxes the line meets, and where it enters them. Before that a leaf has no effect, so it is tested only
 * when the sweep arrives there; the nearest surface is usually found before all are tested. If there are more leaves
 * than this, all are tested at once. */
enum { WAITING_MAX = 16 };
struct pending_leaves {
    double enter[WAITING_MAX];
    uint32_t leaf[WAITING_MAX];
    uint32_t count;
};

struct sweep {
    const struct csg *csg;
    const struct csg_plan *plan;
    const struct ray *ray;
    struct crossing *items; /* the crossings of the leaves tested so far, by t; on top of the scratch */
    uint32_t count, next;
    struct geom_scratch *scratch;
    struct pending_leaves *pending; /* NULL: all leaves have been tested */
    struct ray *leaf_ray;           /* a copy of the ray, for the leaves' spaces */
    uint32_t first_clip_leaf;       /* leaves of the clip come after those of the solid */
    uint32_t *counts;               /* true children of each node */
    uint32_t *inside;               /* one bit per leaf */
    bool in, shown;                 /* the line is inside the solid, inside the clip */
    double from, to;                /* surfaces are looked for between; what is before from has happened */
    double coarse;                  /* the part of the coarse distance that does not grow with t */
};

static bool leaf_is_inside(const struct sweep *s, uint32_t leaf) {
    return s->inside[leaf / 32] >> leaf % 32 & 1;
}

/* Whether crossing this leaf's surface now makes its literal true. */
static bool adds(const struct sweep *s, uint32_t leaf) {
    return leaf_is_inside(s, leaf) == s->plan->literals[leaf].negated;
}

static bool is_of_clip(const struct sweep *s, uint32_t leaf) {
    return leaf >= s->first_clip_leaf;
}

/* The line crosses the surface of a leaf; true when the solid, or the clip if it is a leaf of that, changes with it. */
static bool toggle(struct sweep *s, uint32_t leaf) {
    bool add = adds(s, leaf);
    s->inside[leaf / 32] ^= UINT32_C(1) << leaf % 32;
    for (uint32_t node = s->plan->literals[leaf].parent; node != CSG_NONE; node = s->plan->nodes[node].parent) {
        uint32_t threshold = s->plan->nodes[node].threshold;
        bool changed = add ? ++s->counts[node] == threshold : s->counts[node]-- == threshold;
        if (!changed)
            return false;
    }
    *(is_of_clip(s, leaf) ? &s->shown : &s->in) = add;
    return true;
}

/* The crossing as the operand itself has it. */
static struct crossing own_crossing(const struct crossing *crossing) {
    struct crossing own = *crossing;
    own.enter = crossing->enter != crossing->flip;
    own.flip = false;
    own.leaf = 0;
    return own;
}

/* One coordinate's rounding error in the leaf's space at t: of the transformed origin, of the way, of the surface. */
static double row_error(const double row[4], const struct ray *ray, double t, double surface) {
    double origin = fabs(row[0] * ray->origin.x) + fabs(row[1] * ray->origin.y) + fabs(row[2] * ray->origin.z);
    double speed = fabs(row[0] * ray->direction.x) + fabs(row[1] * ray->direction.y) + fabs(row[2] * ray->direction.z);
    return ROUNDING * (origin + fabs(row[3]) + fabs(t) * speed + surface);
}

/* How far the t of a crossing may be from where it should be; at most `limit`. */
static double crossing_error(const struct sweep *s, const struct crossing *crossing, double limit) {
    const struct csg_leaf *leaf = &s->csg->leaves[crossing->leaf];
    const struct affine *to_leaf = &leaf->csg_from_leaf.inverse;
    struct ray ray = ray_transform(to_leaf, s->ray);
    struct crossing own = own_crossing(crossing);
    struct surface surface;
    shape_describe(&leaf->shape, &ray, &own, &surface);
    struct box bounds = shape_bounds(&leaf->shape);
    struct vec3 n = vec3_normalize(surface.normal), size = vec3_max(vec3_negate(bounds.min), bounds.max);
    if (!vec3_finite(size)) /* without end: the place itself, which the way has, is all that counts */
        size = vec3_all(0);
    double error = fabs(n.x) * row_error(to_leaf->m[0], s->ray, crossing->t, fabs(size.x)) +
                   fabs(n.y) * row_error(to_leaf->m[1], s->ray, crossing->t, fabs(size.y)) +
                   fabs(n.z) * row_error(to_leaf->m[2], s->ray, crossing->t, fabs(size.z));
    double cosine = fabs(vec3_dot(n, ray.direction));
    return error < limit * cosine ? error / cosine : limit;
}

/* A face of a clipped surface that is not shown; a crossing enters where it meets the face from the front. */
static bool is_culled(const struct sweep *s, const struct crossing *crossing) {
    enum csg_cull cull = s->csg->leaves[crossing->leaf].cull;
    return cull != CSG_CULL_NONE && crossing->enter == (cull == CSG_CULL_FRONT);
}

/* Crossing an open surface changes no truth value: the crossing itself is the surface. */
static bool is_open_surface(const struct sweep *s, uint32_t leaf) {
    return s->plan->literals[leaf].parent == CSG_NONE;
}

/* Several crossings at once, see the rule at the top. `surface` is the one that changed the truth. */
static bool cross_group(struct sweep *s, struct crossing *group, uint32_t count, struct crossing *surface) {
    sort_crossings(group, 0, count, true);
    bool was_in = s->in, was_shown = s->shown, changed = false;
    uint32_t kept = 0;
    for (uint32_t i = 0; i < count;) {
        uint32_t end = i + 1;
        while (end < count && group[end].leaf == group[i].leaf)
            end++;
        if (is_open_surface(s, group[i].leaf)) {
            uint32_t shown = i;
            while (shown + 1 < end && is_culled(s, &group[shown]))
                shown++;
            *surface = group[shown];
            changed = true;
        } else if ((end - i) % 2) {
            group[kept++] = group[end - 1];
        }
        i = end;
    }
    /* First those that cannot change the truth, in case the others do. */
    for (uint32_t i = 0; i < kept; i++) {
        bool last = adds(s, group[i].leaf) != (is_of_clip(s, group[i].leaf) ? was_shown : was_in);
        if (!last)
            (void)toggle(s, group[i].leaf);
        group[i].flip = last; /* marks what is left to do */
    }
    for (uint32_t i = 0; i < kept; i++) {
        if (!group[i].flip || !toggle(s, group[i].leaf) || is_of_clip(s, group[i].leaf))
            continue;
        *surface = group[i];
        changed = true;
    }
    return changed && (was_shown || s->shown);
}

/* A single crossing; true if it is a visible surface. */
static bool cross_one(struct sweep *s, uint32_t leaf) {
    if (is_open_surface(s, leaf))
        return s->shown;
    return toggle(s, leaf) && !is_of_clip(s, leaf) && s->shown;
}

/* Keeps those crossings of a leaf, on top of the scratch, that are in the interval of the search. Later ones do not
 * matter; earlier ones only change the initial state, in any order. */
static void keep_crossings(struct sweep *s, uint32_t leaf, uint32_t first) {
    struct geom_scratch *scratch = s->scratch;
    uint32_t kept = first;
    for (uint32_t k = first; k < scratch->used; k++) {
        struct crossing *c = &scratch->items[k];
        if (c->t > s->to || c->t == INFINITY)
            break;
        if (c->t < s->from || c->t == -INFINITY) {
            if (!is_open_surface(s, leaf))
                (void)toggle(s, leaf);
            continue;
        }
        c->leaf = (uint16_t)leaf;
        if (kept != k)
            scratch->items[kept] = *c;
        kept++;
    }
    scratch->used = kept;
}

/* Outside a leaf that contains the solid there is no search, except for crossings that may be in one group with its
 * ends. items: all its crossings on the line. */
static void narrow(struct sweep *s, const struct crossing *items, uint32_t count) {
    if (count == 0) {
        s->from = INFINITY;
        s->to = -INFINITY;
        return;
    }
    double enter = items[0].t, leave = items[count - 1].t;
    double from = enter - (s->coarse + COARSE * fabs(enter)), to = leave + (s->coarse + COARSE * fabs(leave));
    if (from > s->from)
        s->from = from;
    if (to < s->to && count % 2 == 0)
        s->to = to;
}

/* The crossings of a leaf in the interval of the search, on top of the scratch. False: scratch overflow. */
static bool ask_leaf(struct sweep *s, uint32_t leaf) {
    struct geom_scratch *scratch = s->scratch;
    const struct csg_leaf *operand = &s->csg->leaves[leaf];
    struct crossing_list list = {scratch->used, 0};
    if (s->plan->as_it_is[leaf]) {
        (void)shape_crossings(&operand->shape, s->ray, scratch, &list);
    } else {
        s->leaf_ray->origin = affine_point(&operand->csg_from_leaf.inverse, s->ray->origin);
        s->leaf_ray->direction = affine_vector(&operand->csg_from_leaf.inverse, s->ray->direction);
        (void)shape_crossings(&operand->shape, s->leaf_ray, scratch, &list);
    }
    if (s->plan->is_needed[leaf])
        narrow(s, &scratch->items[list.first], scratch->used - list.first);
    if (scratch->used > list.first)
        keep_crossings(s, leaf, list.first);
    return !scratch->overflow;
}

/* Merges the crossings added since there were `count`. */
static void take_in(struct sweep *s) {
    uint32_t count = (uint32_t)(&s->scratch->items[s->scratch->used] - s->items);
    if (count > s->count) {
        sort_crossings(&s->items[s->next], s->count - s->next, count - s->next, false);
        s->count = count;
    }
}

/* Tests the leaves that are entered before `until`; false: scratch overflow. */
static bool ask_waiting(struct sweep *s, double until) {
    struct pending_leaves *w = s->pending;
    for (uint32_t i = 0; i < w->count;) {
        if (!(w->enter[i] <= until)) {
            i++;
            continue;
        }
        if (!ask_leaf(s, w->leaf[i]))
            return false;
        w->count--;
        w->enter[i] = w->enter[w->count];
        w->leaf[i] = w->leaf[w->count];
    }
    take_in(s);
    return true;
}

/* Makes sure that the next crossing is the next one of all leaves; false: scratch overflow. */
static bool test_next_leaves(struct sweep *s) {
    while (s->pending && s->pending->count > 0) {
        double first = INFINITY;
        for (uint32_t i = 0; i < s->pending->count; i++)
            first = s->pending->enter[i] < first ? s->pending->enter[i] : first;
        if (s->next < s->count) { /* twice as far as crossings are compared with it */
            double t = s->items[s->next].t, until = t + 2 * (s->coarse + COARSE * fabs(t));
            if (first > until)
                return true;
            first = until;
        }
        if (!ask_waiting(s, first))
            return false;
    }
    return true;
}

/* The end of the group that begins at `first`: error intervals are joined as long as they overlap. 0: scratch
 * overflow. */
static uint32_t group_end(struct sweep *s, uint32_t first) {
    uint32_t end = first + 1;
    double extent = 0;
    for (; end < s->count; end++) {
        double before = s->items[end - 1].t, t = s->items[end].t, limit = s->coarse + COARSE * fabs(t);
        if (!(t - before <= limit))
            break;
        if (s->pending && s->pending->count > 0) { /* rare: a group may extend beyond the tested range */
            if (!ask_waiting(s, INFINITY))
                return 0;
            end = first;
            continue;
        }
        if (end == first + 1)
            extent = before + crossing_error(s, &s->items[first], limit);
        double error = crossing_error(s, &s->items[end], limit);
        if (!(t - error <= extent))
            break;
        extent = math_max(extent, t + error);
    }
    return end;
}

/* The next surface on the line. False: there is none, or scratch overflow. */
static bool sweep_next(struct sweep *s, struct crossing *out) {
    while (test_next_leaves(s) && s->next < s->count) {
        uint32_t first = s->next, end = group_end(s, first);
        if (end == 0)
            return false;
        struct crossing surface = s->items[first];
        s->next = end;
        s->from = s->items[end - 1].t;
        bool changed =
            end == first + 1 ? cross_one(s, surface.leaf) : cross_group(s, &s->items[first], end - first, &surface);
        if (!changed || is_culled(s, &surface))
            continue;
        *out = surface;
        if (!s->csg->open) {
            out->flip = surface.enter != s->in;
            out->enter = s->in;
        }
        return true;
    }
    return false;
}

/* The part of the ray inside the box, as box_probe_meets sees it; false when there is none. */
static bool clip(const struct box_probe *probe, const struct box *b, double *from, double *to) {
    struct box_span span = box_probe_span(probe, b);
    *from = span.enter > *from ? span.enter : *from;
    *to = span.leave < *to ? span.leave : *to;
    return *from <= *to;
}

/* A leaf whose box the line meets. False: scratch overflow. */
static bool add_leaf(struct sweep *s, uint32_t leaf, double enter) {
    struct pending_leaves *w = s->pending;
    if (!w)
        return ask_leaf(s, leaf);
    if (w->count < WAITING_MAX) {
        w->enter[w->count] = enter;
        w->leaf[w->count++] = leaf;
        return true;
    }
    for (uint32_t i = 0; i < w->count; i++)
        if (!ask_leaf(s, w->leaf[i]))
            return false;
    s->pending = NULL;
    return ask_leaf(s, leaf);
}

/* Finds the leaves that matter where the ray is inside of the bounds; everything on the scratch above `used` is the
 * sweep's until the caller pops it. The caller lends leaf_ray, a copy of the ray, and `pending`. False: nothing can be
 * there, or scratch overflow. */
static bool sweep_begin(struct sweep *s, const struct csg *csg, const struct ray *ray, struct ray *leaf_ray,
                        struct pending_leaves *pending, struct geom_scratch *scratch) {
    const struct csg_plan *plan = csg->plan;
    double speed = vec3_max_abs(ray->direction), t_from = ray->t_min, t_to = ray->t_max;
    struct box_probe probe = box_probe_make(ray);
    if (!(speed > 0) || !clip(&probe, &csg->bounds, &t_from, &t_to))
        return false;
    if (scratch->capacity - scratch->used < plan->state_items) {
        scratch->overflow = true;
        return false;
    }
    /* The truth of nodes and leaves as plain words. */
    uint32_t *words = (uint32_t *)(void *)&scratch->items[scratch->used];
    scratch->used += plan->state_items;
    uint32_t first = scratch->used;
    double coarse = COARSE * ((vec3_max_abs(ray->origin) + plan->size) / speed);

    t_from = t_from - coarse - COARSE * fabs(t_from);
    t_to = t_to + coarse + COARSE * fabs(t_to);
    const struct csg_token *first_of_clip = csg->clipped ? &csg->program[csg->solid_length] : NULL;
    s->csg = csg;
    s->plan = plan;
    s->ray = ray;
    s->items = &scratch->items[first];
    s->count = s->next = 0;
    s->scratch = scratch;
    s->pending = pending;
    s->leaf_ray = leaf_ray;
    s->first_clip_leaf = first_of_clip ? first_of_clip->leaf : UINT32_MAX;
    s->counts = words;
    s->inside = words + plan->node_count;
    s->in = plan->starts_in;
    s->shown = plan->starts_shown;
    s->from = t_from;
    s->to = t_to;
    s->coarse = coarse;
    for (uint32_t i = 0; i < plan->node_count; i++)
        s->counts[i] = plan->start_counts[i];
    for (uint32_t i = 0; i < (csg->leaf_count + 31) / 32; i++)
        s->inside[i] = 0;
    pending->count = 0;
    for (uint32_t i = 0; i < plan->needed_count; i++) {
        if (!ask_leaf(s, plan->needed[i]) || !(s->from <= s->to))
            return false;
    }
    for (uint32_t b = 0; b < plan->bound_count;) {
        const struct csg_bound *bound = &plan->bounds[b];
        if (!bound->unprobed && !box_probe_meets(&probe, &bound->box, s->from, s->to)) {
            b = bound->skip;
            continue;
        }
        for (uint32_t i = 0; i < bound->count; i++) {
            uint32_t leaf = plan->order[bound->first + i];
            if (plan->is_needed[leaf])
                continue;
            struct box_span span = box_probe_span(&probe, &plan->boxes[leaf]);
            if (box_span_meets(span, s->from, s->to) && !add_leaf(s, leaf, span.enter))
                return false;
        }
        b++;
    }
    take_in(s);
    return true;
}

/* ---- the questions ---- */

bool csg_nearest(const struct csg *csg, const struct ray *ray, struct geom_scratch *scratch, struct crossing *out) {
    uint32_t used = scratch->used;
    struct sweep s;
    struct pending_leaves pending;
    struct ray leaf_ray = *ray;
    bool found = false;
    if (sweep_begin(&s, csg, ray, &leaf_ray, &pending, scratch)) {
        struct crossing surface;
        while (!found && sweep_next(&s, &surface) && surface.t < ray->t_max)
            if (surface.t > ray->t_min) {
                *out = surface;
                found = true;
            }
    }
    scratch->used = used;
    return found;
}

bool csg_any(const struct csg *csg, const struct ray *ray, struct geom_scratch *scratch) {
    struct crossing ignored;
    return csg_nearest(csg, ray, scratch, &ignored);
}

/* A surface takes the place of a crossing that the sweep has passed. */
bool csg_list_crossings(const struct csg *csg, const struct ray *ray, struct geom_scratch *scratch,
                        struct crossing_list *out) {
    uint32_t used = scratch->used;
    struct sweep s;
    struct pending_leaves pending;
    struct ray leaf_ray = *ray;
    struct crossing surface;
    *out = (struct crossing_list){used, 0};
    if (sweep_begin(&s, csg, ray, &leaf_ray, &pending, scratch)) {
        out->first = (uint32_t)(s.items - scratch->items);
        while (sweep_next(&s, &surface))
            s.items[out->count++] = surface;
    }
    scratch->used = scratch->overflow ? used : out->first + out->count;
    return !scratch->overflow;
}

/* The postfix program itself, on a stack of bits: independent of the plan but for the leaves' own boxes. */
bool csg_contains(const struct csg *csg, struct vec3 point, struct geom_scratch *scratch) {
    const struct csg_plan *plan = csg->plan;
    uint32_t used = scratch->used;
    if (csg->clipped)
        return false;
    if (scratch->capacity - used < plan->state_items) {
        scratch->overflow = true;
        return false;
    }
    /* The stack of the program as bits; leaves may use the scratch above it. */
    uint32_t *stack = (uint32_t *)(void *)&scratch->items[used], depth = 0;
    scratch->used += plan->state_items;
    for (uint32_t i = 0; i < csg->program_length; i++) {
        bool value = false;
        enum csg_operation operation = csg->program[i].operation;
        if (operation == CSG_LEAF) {
            uint32_t index = csg->program[i].leaf;
            const struct csg_leaf *leaf = &csg->leaves[index];
            if (box_contains(&plan->own_boxes[index], point))
                value = shape_contains(&leaf->shape, affine_point(&leaf->csg_from_leaf.inverse, point), scratch);
        } else if (operation == CSG_INVERSE) {
            depth--;
            value = !(stack[depth / 32] >> depth % 32 & 1);
        } else {
            depth -= 2;
            bool left = stack[depth / 32] >> depth % 32 & 1, right = stack[(depth + 1) / 32] >> (depth + 1) % 32 & 1;
            value = operation == CSG_UNION          ? left || right
                    : operation == CSG_INTERSECTION ? left && right
                                                    : left && !right;
        }
        /* The bits above are of values that were taken: they are cleared. */
        uint32_t bit = UINT32_C(1) << depth % 32, below = bit - 1;
        stack[depth / 32] = (depth % 32 ? stack[depth / 32] & below : 0) | (value ? bit : 0);
        depth++;
    }
    bool inside = stack[0] & 1;
    scratch->used = used;
    return inside && !scratch->overflow;
}

/* A bound of how much a map stretches: the Frobenius norm of its linear part. */
static double stretch(const struct affine *a) {
    double rows[3];
    for (int i = 0; i < 3; i++)
        rows[i] = vec3_length(vec3_make(a->m[i][0], a->m[i][1], a->m[i][2]));
    return vec3_length(vec3_make(rows[0], rows[1], rows[2]));
}

void csg_describe(const struct csg *csg, const struct ray *ray, const struct crossing *crossing, struct surface *out) {
    const struct csg_leaf *leaf = &csg->leaves[crossing->leaf];
    const struct transform *map = &leaf->csg_from_leaf;
    struct ray leaf_ray = ray_transform(&map->inverse, ray);
    struct crossing own = own_crossing(crossing);
    shape_describe(&leaf->shape, &leaf_ray, &own, out);

    /* Fields in the operand's space stay unchanged; the others are transformed to CSG space. */
    struct vec3 p = out->point;
    out->point = affine_point(&map->forward, p);
    out->normal = transform_normal(map, out->normal);
    out->shading_normal = transform_normal(map, out->shading_normal);
    if (crossing->flip) {
        out->normal = vec3_negate(out->normal);
        out->shading_normal = vec3_negate(out->shading_normal);
    }
    if (out->has_second) {
        out->second.dpdu = affine_vector(&map->forward, out->second.dpdu);
        out->second.dpdv = affine_vector(&map->forward, out->second.dpdv);
    }
    out->dpdu = affine_vector(&map->forward, out->dpdu);
    out->dpdv = affine_vector(&map->forward, out->dpdv);
    double rounding = 0;
    for (int i = 0; i < 3; i++) {
        const double *row = map->forward.m[i];
        rounding = math_max(rounding, fabs(row[0] * p.x) + fabs(row[1] * p.y) + fabs(row[2] * p.z) + fabs(row[3]));
    }
    out->error = stretch(&map->forward) * out->error + 0x1p-49 * rounding;
    out->leaf = crossing->leaf;
}

static void bundle_leaf(struct bundle *bundle, void *csg_leaf) {
    struct csg_leaf *leaf = csg_leaf;
    shape_bundle(bundle, &leaf->shape);
    BUNDLE(bundle, leaf->limit, 1, NULL);
}

static void bundle_plan(struct bundle *bundle, void *csg_plan) {
    struct csg_plan *plan = csg_plan;
    BUNDLE(bundle, plan->nodes, plan->node_count, NULL);
    BUNDLE(bundle, plan->start_counts, plan->node_count, NULL);
    BUNDLE(bundle, plan->literals, plan->leaf_count, NULL);
    BUNDLE(bundle, plan->own_boxes, plan->leaf_count, NULL);
    BUNDLE(bundle, plan->boxes, plan->leaf_count, NULL);
    BUNDLE(bundle, plan->as_it_is, plan->leaf_count, NULL);
    BUNDLE(bundle, plan->bounds, plan->bound_count, NULL);
    BUNDLE(bundle, plan->order, plan->leaf_count, NULL);
    BUNDLE(bundle, plan->needed, plan->needed_count, NULL);
    BUNDLE(bundle, plan->is_needed, plan->leaf_count, NULL);
    BUNDLE(bundle, plan->is_convex, plan->leaf_count, NULL);
}

static void bundle_solid(struct bundle *bundle, void *solid) {
    struct csg *csg = solid;
    BUNDLE(bundle, csg->leaves, csg->leaf_count, bundle_leaf);
    BUNDLE(bundle, csg->program, csg->program_length, NULL);
    BUNDLE(bundle, csg->convexity, csg->leaf_count, NULL);
    bundle_point(bundle, &csg->plan, 1, sizeof(struct csg_plan), bundle_plan);
}

void csg_bundle(struct bundle *bundle, const struct csg **csg) {
    BUNDLE(bundle, *csg, 1, bundle_solid);
}
