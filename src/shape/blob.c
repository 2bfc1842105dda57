/* The blob (Blinn, "A generalization of algebraic surface drawing", ACM TOG 1982; the polynomial field is that of
 * Wyvill, McPheeters, Wyvill, "Data structure for soft objects", 1986, in the form that POV-Ray uses). Along a line the
 * squared distance from a ball's centre or a cylinder's axis is a quadratic, so its field is a polynomial of degree 4
 * between two places and zero elsewhere; a cylinder has up to three such stretches. The ends of all stretches cut the
 * line into intervals; in each the active polynomials are added in Bernstein form on that interval, which is accurate
 * for lines of any length, and the roots of the sum are the crossings. The state inside or outside is carried from
 * interval to interval, so rounding at their borders cannot change the parity. The extent in a direction is found by
 * branch and bound over an octree: cells in which the sum cannot attain the threshold are left out. */
#include "shape/blob.h"

#include "geometry/bernstein.h"
#include "shape/part_tree_internal.h"

enum { CELL_DEPTH = 9, REGIONS = 4, BODY = 0, BALL_A = 1, BALL_B = 2 };
#define CELL_WORK (UINT32_C(1) << 16) /* fields looked at in one direction; beyond it cells count as full */

struct blob {
    struct blob_element *elements;
    uint32_t count;
    double threshold, size;
    struct vec3 middle; /* of the elements that add, for pictures */
    struct part_tree tree;
    struct box bounds;
};

/* The nearest point of the element's axis. */
static struct vec3 axis_point(const struct blob_element *e, struct vec3 p) {
    struct vec3 axis = vec3_sub(e->b, e->a), from_a = vec3_sub(p, e->a);
    double squared = vec3_dot(axis, axis), h = squared > 0 ? vec3_dot(from_a, axis) / squared : 0;
    return h <= 0 ? e->a : h >= 1 ? e->b : vec3_add_scaled(e->a, axis, h);
}

static double field(const struct blob_element *e, double distance) {
    double x = distance / e->radius, q = 1 - x * x;
    return x < 1 ? e->strength * q * q : 0;
}

/* ---- building ---- */

/* The search for the point that is furthest along a direction. */
struct extent {
    const struct blob *blob;
    struct vec3 g;
    double furthest; /* dot(g, p) of the cells found so far */
    uint32_t work;
};

static bool may_be_inside(struct extent *search, const struct box *cell) {
    struct vec3 middle = vec3_add(vec3_scale(cell->min, 0.5), vec3_scale(cell->max, 0.5));
    double extent = vec3_length(vec3_sub(cell->max, middle)), sum = 0;
    const struct part_tree *tree = &search->blob->tree;
    for (uint32_t n = 0; n < tree->node_count;) {
        const struct part_node *node = &tree->nodes[n];
        struct box common = box_meet(node->box, *cell);
        if (box_is_empty(&common)) {
            n = node->skip;
            continue;
        }
        for (uint32_t i = 0; i < node->count; i++) {
            const struct blob_element *e = &search->blob->elements[tree->order[node->first + i]];
            double distance = vec3_length(vec3_sub(middle, axis_point(e, middle)));
            sum += field(e, e->strength > 0 ? math_max(0, distance - extent) : distance + extent);
            search->work++;
        }
        n++;
    }
    return sum >= search->blob->threshold * (1 - 0x1p-30);
}

/* The corner furthest along g: bits of box_corner(). */
static unsigned front(struct vec3 g) {
    return (g.x > 0 ? 1u : 0) | (g.y > 0 ? 2u : 0) | (g.z > 0 ? 4u : 0);
}

/* Cells behind the current maximum are left out, and so are those in which the sum cannot attain the threshold; the
 * cells in front come first. A cell of the last level, or any when the search has taken too long, counts as full. */
static void extent_along(struct extent *search, const struct box *cell, int depth) {
    double max = vec3_dot(search->g, box_corner(cell, front(search->g)));
    if (max <= search->furthest)
        return;
    if (search->work < CELL_WORK) {
        if (!may_be_inside(search, cell))
            return;
        if (depth < CELL_DEPTH) {
            struct vec3 middle = vec3_add(vec3_scale(cell->min, 0.5), vec3_scale(cell->max, 0.5));
            for (unsigned i = 0; i < 8; i++) {
                struct vec3 end = box_corner(cell, i ^ front(search->g));
                struct box child = {vec3_min(middle, end), vec3_max(middle, end)};
                extent_along(search, &child, depth + 1);
            }
            return;
        }
    }
    search->furthest = max;
}

/* k (1 - x^2)^2 = threshold. */
static double extent_of_one(const struct blob *blob) {
    const struct blob_element *e = &blob->elements[0];
    return e->radius * sqrt(math_max(1 - sqrt(blob->threshold / e->strength), 0)) * (1 + 0x1p-40);
}

static double furthest(const struct blob *blob, struct vec3 g) {
    const struct blob_element *e = &blob->elements[0];
    if (blob->count == 1)
        return e->strength >= blob->threshold
                   ? math_max(vec3_dot(g, e->a), vec3_dot(g, e->b)) + extent_of_one(blob) * vec3_length(g)
                   : vec3_dot(g, e->a);
    struct extent search = {.blob = blob, .g = g, .furthest = -INFINITY};
    extent_along(&search, &blob->bounds, 0);
    return search.furthest > -INFINITY ? search.furthest : vec3_dot(g, e->a); /* the threshold is attained nowhere */
}

void blob_extent(const struct blob *blob, struct vec3 g, double *lo, double *hi) {
    *lo = -furthest(blob, vec3_negate(g));
    *hi = furthest(blob, g);
}

/* Twice, so that the cells of the second search divide the box itself and not the extent of the fields. */
static void find_bounds(struct blob *blob) {
    for (int turn = 0; turn < 2; turn++) {
        double lo[3], hi[3];
        for (int axis = 0; axis < 3; axis++)
            blob_extent(blob, vec3_make(axis == 0, axis == 1, axis == 2), &lo[axis], &hi[axis]);
        blob->bounds = (struct box){vec3_make(lo[0], lo[1], lo[2]), vec3_make(hi[0], hi[1], hi[2])};
    }
    blob->bounds = box_pad(blob->bounds);
}

static bool check(const struct blob_input *in, struct error *error) {
    if (in->count == 0)
        return error_set(error, ERROR_SCENE, "the blob has no balls and no cylinders");
    if (!(in->threshold > 0) || !isfinite(in->threshold))
        return error_set(error, ERROR_SCENE, "the threshold of the blob is %g, not above 0", in->threshold);
    for (uint32_t i = 0; i < in->count; i++) {
        const struct blob_element *e = &in->elements[i];
        if (!vec3_finite(e->a) || !vec3_finite(e->b) || !(e->radius > 0x1p-300) ||
            !(math_max(math_max(vec3_max_abs(e->a), vec3_max_abs(e->b)), e->radius) < 0x1p300))
            return error_set(error, ERROR_SCENE, "element %u of the blob has no usable size", i + 1);
        if (!isfinite(e->strength) || e->strength == 0)
            return error_set(error, ERROR_SCENE, "element %u of the blob has the strength %g", i + 1, e->strength);
    }
    return true;
}

const struct blob *blob_build(struct arena *arena, const struct blob_input *in, struct error *error) {
    if (!check(in, error))
        return NULL;
    struct blob *blob = arena_alloc(arena, sizeof *blob);
    struct box *boxes = arena_alloc_array(arena, in->count, sizeof *boxes), all = box_empty(), adding = box_empty();
    struct blob_element *elements = arena_alloc_array(arena, in->count, sizeof *elements);
    if (!blob || !boxes || !elements) {
        error_no_memory(error, "a blob");
        return NULL;
    }
    /* An element has no influence outside of its box. */
    for (uint32_t i = 0; i < in->count; i++) {
        const struct blob_element *e = &in->elements[i];
        elements[i] = *e;
        boxes[i].min = vec3_sub(vec3_min(e->a, e->b), vec3_all(e->radius));
        boxes[i].max = vec3_add(vec3_max(e->a, e->b), vec3_all(e->radius));
        all = box_join(all, boxes[i]);
        if (e->strength > 0)
            adding = box_join(adding, boxes[i]);
    }
    *blob = (struct blob){.elements = elements, .count = in->count, .threshold = in->threshold, .bounds = all};
    if (!part_tree_build(arena, boxes, in->count, 2, &blob->tree)) {
        error_no_memory(error, "a blob");
        return NULL;
    }
    find_bounds(blob);
    blob->middle =
        box_is_empty(&adding) ? elements[0].a : vec3_add(vec3_scale(adding.min, 0.5), vec3_scale(adding.max, 0.5));
    blob->size = math_max(vec3_max_abs(all.min), vec3_max_abs(all.max));
    return blob;
}

struct box blob_bounds(const struct blob *blob) {
    return blob->bounds;
}

uint32_t blob_scratch_need(const struct blob *blob) {
    return blob->count < 64 ? 16 * blob->count : 1024;
}

/* ---- the line ---- */

/* The perpendicular from the axis or centre to a point of the line. */
static struct vec3 arm(const struct blob_element *e, int region, struct vec3 p) {
    if (region == BALL_A)
        return vec3_sub(p, e->a);
    if (region == BALL_B)
        return vec3_sub(p, e->b);
    struct vec3 axis = vec3_normalize(vec3_sub(e->b, e->a)), from_a = vec3_sub(p, e->a);
    return vec3_add_scaled(from_a, axis, -vec3_dot(from_a, axis));
}

/* A piece of a line. */
struct stretch {
    double lo, hi;
};

/* The stretch in which a region of an element acts, cut to where its field is not zero. */
static bool add_stretch(const struct line *line, const struct blob *blob, uint32_t index, int region,
                        struct stretch stretch, struct geom_scratch *scratch) {
    const struct blob_element *e = &blob->elements[index];
    double lo = stretch.lo, hi = stretch.hi;
    struct vec3 p = arm(e, region, line->origin), d = line->direction;
    /* In the body only the distance from the axis counts. */
    if (region == BODY) {
        struct vec3 axis = vec3_normalize(vec3_sub(e->b, e->a));
        d = vec3_add_scaled(d, axis, -vec3_dot(d, axis));
    }
    /* Where the line is nearer than the radius; a line along the axis is so everywhere or nowhere. */
    double dd = vec3_dot(d, d);
    if (dd > 0x1p-100) {
        double foot = -vec3_dot(p, d) / dd, distance = vec3_length(vec3_add_scaled(p, d, foot));
        if (!(distance < e->radius))
            return true;
        double half = sqrt((e->radius - distance) * (e->radius + distance) / dd);
        lo = math_max(lo, foot - half);
        hi = math_min(hi, foot + half);
    } else if (!(vec3_length(p) < e->radius)) {
        return true;
    }
    if (!(lo < hi) || !isfinite(lo) || !isfinite(hi))
        return true;
    uint32_t part = index * REGIONS + (uint32_t)region;
    return geom_scratch_push(scratch, (struct crossing){.t = lo, .part = part, .enter = true}) &&
           geom_scratch_push(scratch, (struct crossing){.t = hi, .part = part});
}

static bool add_element(const void *shape, uint32_t index, const struct line *line, struct geom_scratch *scratch) {
    const struct blob *blob = shape;
    const struct blob_element *e = &blob->elements[index];
    struct vec3 axis = vec3_sub(e->b, e->a);
    double squared = vec3_dot(axis, axis);
    if (!(squared > 0))
        return add_stretch(line, blob, index, BALL_A, (struct stretch){-INFINITY, INFINITY}, scratch);
    /* Where the line passes the two planes in which the body ends. */
    double speed = vec3_dot(axis, line->direction), at = vec3_dot(axis, vec3_sub(line->origin, e->a));
    if (speed == 0) {
        int region = at < 0 ? BALL_A : at > squared ? BALL_B : BODY;
        return add_stretch(line, blob, index, region, (struct stretch){-INFINITY, INFINITY}, scratch);
    }
    double s_a = -at / speed, s_b = vec3_dot(axis, vec3_sub(e->b, line->origin)) / speed;
    double first = speed > 0 ? s_a : s_b, last = speed > 0 ? s_b : s_a;
    return add_stretch(line, blob, index, speed > 0 ? BALL_A : BALL_B, (struct stretch){-INFINITY, first}, scratch) &&
           add_stretch(line, blob, index, BODY, (struct stretch){first, last}, scratch) &&
           add_stretch(line, blob, index, speed > 0 ? BALL_B : BALL_A, (struct stretch){last, INFINITY}, scratch);
}

/* Sum of the acting fields less the threshold, in Bernstein form on the stretch. */
static void sum_fields(const struct blob *blob, const struct line *line, const struct crossing *acting, uint32_t count,
                       struct stretch stretch, double sum[5]) {
    for (int k = 0; k < 5; k++)
        sum[k] = -blob->threshold;
    struct vec3 from = line_at(line, stretch.lo), to = line_at(line, stretch.hi);
    for (uint32_t i = 0; i < count; i++) {
        const struct blob_element *e = &blob->elements[acting[i].part / REGIONS];
        int region = (int)(acting[i].part % REGIONS);
        struct vec3 p = vec3_scale(arm(e, region, from), 1 / e->radius),
                    r = vec3_scale(arm(e, region, to), 1 / e->radius);
        /* 1 - d^2 in Bernstein form (its polar form is p . r), and its square. */
        double a = 1 - vec3_dot(p, p), b = 1 - vec3_dot(p, r), c = 1 - vec3_dot(r, r), k = e->strength;
        sum[0] += k * a * a;
        sum[1] += k * a * b;
        sum[2] += k * ((2 * b * b + a * c) / 3);
        sum[3] += k * b * c;
        sum[4] += k * c * c;
    }
}

/* The element with the strongest field at a point; the first of equals. */
static uint32_t strongest(const struct blob *blob, const struct line *line, const struct crossing *acting,
                          uint32_t count, double s) {
    struct vec3 p = line_at(line, s);
    uint32_t best = UINT32_MAX;
    double max = -INFINITY;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t index = acting[i].part / REGIONS;
        const struct blob_element *e = &blob->elements[index];
        double f = field(e, vec3_length(vec3_sub(p, axis_point(e, p))));
        if (f > max || (f == max && index < best)) {
            max = f;
            best = index;
        }
    }
    return best == UINT32_MAX ? 0 : best;
}

bool blob_crossings(const struct blob *blob, const struct ray *ray, struct geom_scratch *scratch,
                    struct crossing_list *out) {
    *out = (struct crossing_list){scratch->used, 0};
    struct line line;
    struct vec3 centre = vec3_add(vec3_scale(blob->bounds.min, 0.5), vec3_scale(blob->bounds.max, 0.5));
    if (!line_init(&line, ray, centre) || !line_meets_box(&line, &blob->bounds))
        return true;
    if (!part_tree_crossings(&blob->tree, &line, blob, add_element, scratch))
        return false;
    /* On the scratch: the ends of the stretches, the stretches that act, the crossings found. */
    uint32_t end_count = scratch->used - out->first;
    uint32_t acting_at = scratch->used, acting = 0;
    if (scratch->capacity - scratch->used < end_count / 2) {
        scratch->overflow = true;
        scratch->used = out->first;
        return false;
    }
    scratch->used += end_count / 2;
    struct crossing *ends = &scratch->items[out->first], *active = &scratch->items[acting_at];
    uint32_t found = scratch->used;
    crossings_sort(ends, end_count);
    bool inside = false, room = true;
    for (uint32_t i = 0; room && i < end_count; i++) {
        bool later = i > 0 && ends[i].t > ends[i - 1].t;
        if (inside && later && acting == 0) { /* by rounding: where nothing acts is outside */
            room =
                geom_scratch_push(scratch, (struct crossing){.t = ends[i - 1].t, .part = ends[i - 1].part / REGIONS});
            inside = false;
        }
        if (room && later && acting > 0) {
            double lo = ends[i - 1].t, hi = ends[i].t, sum[5], roots[4];
            sum_fields(blob, &line, active, acting, (struct stretch){lo, hi}, sum);
            if ((sum[0] < 0) == inside)
                sum[0] = inside ? 0 : -0x1p-1000;
            int count = bernstein_roots(sum, 4, roots);
            for (int k = 0; room && k < count; k++) {
                double s = lo + (hi - lo) * roots[k];
                room = geom_scratch_push(scratch,
                                         (struct crossing){.t = s, .part = strongest(blob, &line, active, acting, s)});
            }
            inside = !(sum[4] < 0);
        }
        if (ends[i].enter) {
            active[acting++] = ends[i];
            continue;
        }
        for (uint32_t k = 0; k < acting; k++)
            if (active[k].part == ends[i].part) {
                active[k] = active[--acting];
                break;
            }
    }
    if (room && inside)
        room = geom_scratch_push(
            scratch, (struct crossing){.t = ends[end_count - 1].t, .part = ends[end_count - 1].part / REGIONS});
    if (!room) {
        scratch->used = out->first;
        return false;
    }
    uint32_t count = scratch->used - found;
    for (uint32_t i = 0; i < count; i++)
        scratch->items[out->first + i] = scratch->items[found + i];
    scratch->used = out->first + count;
    line_finish_closed(&line, scratch, out->first, out);
    return true;
}

/* The field less the threshold, and its gradient. */
static double field_at(const struct blob *blob, struct vec3 point, struct vec3 *gradient) {
    double sum = -blob->threshold;
    *gradient = vec3_all(0);
    for (uint32_t n = 0; n < blob->tree.node_count;) {
        const struct part_node *node = &blob->tree.nodes[n];
        if (!box_contains(&node->box, point)) {
            n = node->skip;
            continue;
        }
        for (uint32_t i = 0; i < node->count; i++) {
            const struct blob_element *e = &blob->elements[blob->tree.order[node->first + i]];
            struct vec3 from_axis = vec3_sub(point, axis_point(e, point));
            struct vec3 x = vec3_scale(from_axis, 1 / e->radius);
            double q = 1 - vec3_dot(x, x);
            if (!(q > 0))
                continue;
            sum += e->strength * q * q;
            *gradient = vec3_add_scaled(*gradient, x, -4 * e->strength * q / e->radius);
        }
        n++;
    }
    return sum;
}

bool blob_contains(const struct blob *blob, struct vec3 point) {
    struct vec3 gradient;
    return box_contains(&blob->bounds, point) && field_at(blob, point, &gradient) >= 0;
}

void blob_describe(const struct blob *blob, const struct ray *ray, const struct crossing *crossing,
                   struct surface *out) {
    struct vec3 point = ray_at(ray, crossing->t), gradient;
    double off = field_at(blob, point, &gradient), steep = vec3_length(gradient);
    double min = 0x1p-20 * blob->threshold / blob->elements[crossing->part].radius;
    /* One step along the gradient takes off what the ray's rounding left, unless the field is flat here. */
    double error = 0x1p-46 * blob->size;
    if (steep > min && fabs(off) < 0x1p-20 * blob->threshold)
        point = vec3_add_scaled(point, gradient, -off / (steep * steep));
    else
        error = 0x1p-22 * blob->size;
    struct vec3 n = vec3_normalize(vec3_negate(gradient));
    if (!(vec3_max_abs(n) > 0))
        n = vec3_normalize(vec3_scale(ray->direction, crossing->enter ? -1 : 1));
    *out = (struct surface){
        .point = point, .normal = n, .shading_normal = n, .pattern_point = point, .pattern_normal = n, .error = error};
    surface_mapping_sphere(blob->middle, out);
}

static void bundle_tables(struct bundle *bundle, void *tables) {
    struct blob *blob = tables;
    BUNDLE(bundle, blob->elements, blob->count, NULL);
    part_tree_bundle(bundle, &blob->tree);
}

void blob_bundle(struct bundle *bundle, const struct blob **blob) {
    BUNDLE(bundle, *blob, 1, bundle_tables);
}
