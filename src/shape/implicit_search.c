/* Crossings of a line and an implicit solid. The line passes the regions (implicit_regions.c) in order. In a region
 * where the sign may change, the values of the function at both ends of the stretch and bounds of its slope along the
 * line decide:
 * - A stretch whose ends have one sign has no crossing if the slope is too small for one.
 * - A stretch whose ends have different signs has one crossing if the slope has one sign. It is found by the method of
 *   Chandrupatla.
 * - Every other stretch is divided into eight parts, whose bounds are computed at once.
 * Thin walls are found down to the resolution. With a Lipschitz bound, the line is marched in steps without a crossing.
 *
 * The search keeps track of the side of the surface, so entries and exits alternate. It searches every region from end
 * to end, also for rays that begin or end in it. So the nearest hit has the bits of the first crossing of the list.
 *
 * R. E. Moore, "Interval Analysis", 1966; J. Snyder, "Interval Analysis for Computer Graphics", SIGGRAPH 1992;
 * T. R. Chandrupatla, "A new hybrid quadratic/bisection algorithm", Advances in Engineering Software 28, 1997;
 * J. Hart, "Sphere Tracing", The Visual Computer 12, 1996; B. Keinert et al., "Enhanced Sphere Tracing", STAG 2014. */
#include "shape/implicit_search_internal.h"

#include <math.h>

/* Fractions of the size. Two crossings that are closer than the resolution may be missed together. A crossing is
 * located to the accuracy. */
static const double resolution = 0x1p-25;
/* The smallest step of a march; twice as long after as many steps of that length in a region. */
static const double march_resolution = 0x1p-20;
enum { MARCH_SMALLEST = 64 };
/* WORK: the limit of operations of the function for one line; an interval operation counts as ten. Beyond the limit,
 * segments are not divided further. */
enum { WORK = 4000000 };

struct search {
    const struct implicit *solid;
    struct line line;
    double origin[3], inverse[3];  /* of the line; 1 / direction, 0 along an axis plane */
    double begin, end;             /* within the bounds, in units of length along the line */
    uint32_t begin_part, end_part; /* where it meets them */
    bool inside;                   /* before the current place */
    double at, value;              /* of the function, where it was evaluated last */
    uint64_t work, limit;
    struct crossing waiting; /* not returned yet; the next one may cancel it */
    bool has_waiting, has_found, is_done, is_full;
    bool is_any;           /* any crossing does */
    bool is_unknown;       /* `inside` is not valid, because the segments before were skipped */
    const struct ray *ray; /* of a nearest hit: its interval; then `found` */
    struct crossing *found;
    struct geom_scratch *scratch;
    bool is_list;
    double tolerance; /* at t = 1, in units of length along the line */
};

/* The larger one of a share of the size, and of the tolerance at s. */
static double room_at(const struct search *search, double share, double s) {
    const double room = search->solid->size * share;
    return search->tolerance > 0 ? math_max(room, search->tolerance * line_t(&search->line, s)) : room;
}

/* Slopes along the line. */
struct slope {
    double low, high;
};

/* --- the ends --- */

static bool clip_box(struct search *search, const struct box *box) {
    search->begin = -INFINITY;
    search->end = INFINITY;
    for (int axis = 0; axis < 3; axis++) {
        double o = vec3_get(search->line.origin, axis), d = vec3_get(search->line.direction, axis);
        double lo = vec3_get(box->min, axis) - o, hi = vec3_get(box->max, axis) - o;
        if (d == 0) {
            if (!(lo < 0 && hi > 0))
                return false;
            continue;
        }
        double near = (d > 0 ? lo : hi) / d, far = (d > 0 ? hi : lo) / d;
        if (near > search->begin) {
            search->begin = near;
            search->begin_part = IMPLICIT_PART_BOX + (uint32_t)axis;
        }
        if (far < search->end) {
            search->end = far;
            search->end_part = IMPLICIT_PART_BOX + (uint32_t)axis;
        }
    }
    return search->begin < search->end;
}

static bool clip_ball(struct search *search, struct vec3 centre, double radius) {
    struct vec3 o = vec3_sub(search->line.origin, centre);
    double foot = -vec3_dot(o, search->line.direction);
    struct vec3 nearest = vec3_add_scaled(o, search->line.direction, foot);
    double room = radius * radius - vec3_dot(nearest, nearest);
    if (!(room > 0))
        return false;
    search->begin = foot - sqrt(room);
    search->end = foot + sqrt(room);
    search->begin_part = search->end_part = IMPLICIT_PART_BALL;
    return search->begin < search->end;
}

/* --- crossings, in order --- */

static void give_out(struct search *search) {
    if (!search->has_waiting)
        return;
    search->has_waiting = false;
    const struct crossing *crossing = &search->waiting;
    if (search->solid->in.open && crossing->part >= IMPLICIT_PART_BOX)
        return;
    if (search->is_list) {
        search->is_full = !geom_scratch_push(search->scratch, *crossing);
        search->is_done = search->is_full;
        return;
    }
    if (crossing->t > search->ray->t_min && crossing->t < search->ray->t_max) {
        *search->found = *crossing;
        search->has_found = search->is_done = true;
    }
}

/* The line changes sides at s. Two changes at one t cancel each other. */
static void cross(struct search *search, double s, uint32_t part) {
    double t = line_t(&search->line, s);
    search->inside = !search->inside;
    if (search->has_waiting && !(search->waiting.t < t)) {
        search->has_waiting = false;
        return;
    }
    give_out(search);
    search->waiting = (struct crossing){.t = t, .u = room_at(search, 0, s), .part = part, .enter = search->inside};
    search->has_waiting = true;
}

/* --- the function --- */

static double evaluate(struct search *search, const struct expr_program *program, double s) {
    double inputs[EXPR_INPUT_COUNT], outputs[EXPR_OUTPUTS];
    struct vec3 p = line_at(&search->line, s);
    inputs[EXPR_POINT_X] = p.x;
    inputs[EXPR_POINT_Y] = p.y;
    inputs[EXPR_POINT_Z] = p.z;
    expr_evaluate(program, inputs, outputs);
    search->work += expr_work(program);
    return outputs[0];
}

/* Memory on top of the scratch, which the next crossing overwrites. NULL: it is too small. */
static void *borrow_memory(struct search *search, size_t size) {
    struct geom_scratch *scratch = search->scratch;
    if ((size_t)(scratch->capacity - scratch->used) * sizeof *scratch->items >= size + IMPLICIT_ALIGNMENT)
        return implicit_aligned(scratch->items + scratch->used);
    scratch->overflow = search->is_full = search->is_done = true;
    return NULL;
}

/* Bounds of the function and of its slope over each of the eight parts, or over all of them in each case of its
 * discontinuities. False: the scratch is too small. Its frame is large: no function that calls itself may contain it.
 */
static __attribute__((noinline)) bool bound_eighths(struct search *search, const struct expr_program *program,
                                                    const double ends[EXPR_LANES + 1], bool are_cases,
                                                    struct expr_lane_range *out) {
    const size_t size = expr_lanes_size(program);
    _Alignas(IMPLICIT_ALIGNMENT) unsigned char memory[IMPLICIT_STACK];
    void *rows = size <= IMPLICIT_STACK ? memory : borrow_memory(search, size);
    struct expr_lane_inputs inputs;
    struct expr_lane_range outputs[EXPR_OUTPUTS];
    struct expr_directions directions;
    if (!rows)
        return false;
    /* Points of the line are off by rounding: the boxes are a little larger. */
    double margin = search->solid->size * 0x1p-50;
    directions.count = 1;
    inputs.are_cases = are_cases;
    for (int k = 0; k < 3; k++) {
        double d = vec3_get(search->line.direction, k);
        double *low = inputs.low[EXPR_POINT_X + k], *high = inputs.high[EXPR_POINT_X + k];
        for (int i = 0; i < EXPR_LANES; i++) {
            double p = search->origin[k] + d * ends[are_cases ? 0 : i];
            double q = search->origin[k] + d * ends[are_cases ? EXPR_LANES : i + 1];
            low[i] = (p < q ? p : q) - margin;
            high[i] = (p < q ? q : p) + margin;
        }
        directions.seeds[EXPR_POINT_X + k][0] = d;
    }
    search->work += 10 * expr_work(program);
    expr_evaluate_slopes_lanes(program, &inputs, &directions, outputs, NULL, rows);
    *out = outputs[0];
    return true;
}

static struct slope slope_in(const struct search *search, const struct implicit_region *region) {
    struct slope out = {0, 0};
    for (int k = 0; k < 3; k++) {
        double d = vec3_get(search->line.direction, k);
        if (d == 0)
            continue;
        out.low += d * (double)(d > 0 ? region->low[k] : region->high[k]);
        out.high += d * (double)(d > 0 ? region->high[k] : region->low[k]);
    }
    double rounding = (fabs(out.low) + fabs(out.high)) * 0x1p-50;
    return (struct slope){out.low - rounding, out.high + rounding};
}

/* --- one crossing --- */

/* Where the sign changes between a and b, which have different signs. */
static double find_change(struct search *search, const struct expr_program *program, double a, double fa, double b,
                          double fb) {
    double tolerance = room_at(search, implicit_accuracy(search->solid), a), c = a, fc = fa, t = fa / (fa - fb);
    for (int step = 0; step < 200; step++) {
        double limit = tolerance / fabs(b - a);
        if (!(limit < 0.5))
            break;
        t = t > limit ? (t < 1 - limit ? t : 1 - limit) : t <= limit ? limit : 0.5;
        double x = a + t * (b - a), fx = evaluate(search, program, x);
        /* The sign changes between a and b; c is the place before. */
        if ((fx < 0) == (fa < 0)) {
            c = a;
            fc = fa;
        } else {
            c = b;
            fc = fb;
            b = a;
            fb = fa;
        }
        a = x;
        fa = fx;
        if (fa == 0)
            break;
        /* Where three places lie on a smooth curve, its inverse is interpolated; else the part is halved. */
        double xi = (a - b) / (c - b), phi = (fa - fb) / (fc - fb);
        bool is_smooth = phi * phi < xi && (1 - phi) * (1 - phi) < 1 - xi;
        t = is_smooth ? fa / (fb - fa) * (fc / (fb - fc)) + (c - a) / (b - a) * (fa / (fc - fa)) * (fb / (fc - fb))
                      : 0.5;
    }
    /* Where only the tolerance ended the search, the outer end: the inside of an estimate of distances may be flat. */
    if (search->tolerance > 0)
        return fb < 0 ? a : b;
    return fabs(fb) < fabs(fa) ? b : a;
}

/* --- stretches --- */

/* A part of a region: where it ends, and the function there. */
struct part {
    double a, fa, b, fb;
};

/* Whether the slope excludes that the function has reached 0 between two values of one sign. */
static bool stays(const struct search *search, const struct part *part, struct slope slope) {
    double w = part->b - part->a, fa = part->fa, fb = part->fb;
    if (!(slope.low > -INFINITY && slope.high < INFINITY) || fa != fa || fb != fb)
        return false;
    if (slope.low >= 0 || slope.high <= 0)
        return true;
    bool below = fa < 0;
    /* Lines of the largest slopes from both ends meet in the farthest value. */
    double from_a = below ? slope.high : slope.low, from_b = below ? slope.low : slope.high;
    double x = (fb - fa - from_b * w) / (from_a - from_b), farthest = fa + from_a * x;
    double rounding = search->solid->size * 0x1p-50 * (slope.high - slope.low);
    return below ? farthest < rounding : farthest > -rounding;
}

/* The side of the surface at a point, if bounds decide it. */
enum side { SIDE_OUTSIDE, SIDE_INSIDE, SIDE_UNKNOWN };

static enum side side_of_lane(const struct expr_lane_range *range, int lane) {
    if (range->low[lane] >= 0 || range->is_nan >> lane & 1) /* NaN is outside */
        return SIDE_OUTSIDE;
    return range->high[lane] < 0 && !(range->may_be_nan >> lane & 1) ? SIDE_INSIDE : SIDE_UNKNOWN;
}

/* On both sides of a discontinuity the sign may be the same. */
static enum side side_of_cases(struct search *search, const struct expr_program *program, double a, double b) {
    const double ends[EXPR_LANES + 1] = {[0] = a, [EXPR_LANES] = b};
    struct expr_lane_range range;
    if (!bound_eighths(search, program, ends, true, &range))
        return SIDE_UNKNOWN;
    enum side side = side_of_lane(&range, 0);
    for (int i = 1; i < EXPR_LANES; i++)
        side = side_of_lane(&range, i) == side ? side : SIDE_UNKNOWN;
    return side;
}

/* From s on, the line is on a known side. */
static void settle(struct search *search, bool inside, double s, uint32_t number, uint32_t first_number) {
    if (search->is_unknown)
        search->inside = inside;
    search->is_unknown = false;
    if (search->inside != inside)
        cross(search, s, s > search->begin ? number : first_number);
}

/* Whether no later change of sides can have the t of the one in the part, and cancel it: the sign has changed at a
 * place with a smaller t than that of the end. Few places are tried. */
static bool cancels_nothing(struct search *search, const struct expr_program *program, const struct part *part) {
    enum { TRIES = 3 };
    double s = part->a;
    for (int i = 0; i < TRIES; i++) {
        s += (part->b - s) / 2;
        if ((evaluate(search, program, s) < 0) != (part->fa < 0))
            return line_t(&search->line, s) < line_t(&search->line, part->b);
    }
    return false;
}

/* A part with one crossing, or with an odd number of crossings close to each other. */
static void pass_change(struct search *search, uint32_t number, const struct part *part) {
    const struct expr_program *program = &search->solid->programs[search->solid->regions[number].program];
    double t = line_t(&search->line, part->a);
    if (search->is_any && t > search->ray->t_min && line_t(&search->line, part->b) < search->ray->t_max &&
        !(search->has_waiting && search->waiting.t >= t) && cancels_nothing(search, program, part)) {
        search->has_found = search->is_done = true; /* wherever it is */
        return;
    }
    cross(search, find_change(search, program, part->a, part->fa, part->b, part->fb), number);
}

static void search_eighths(struct search *search, uint32_t number, const struct part *part, struct slope slope);

static void search_part(struct search *search, uint32_t number, const struct part *part, struct slope slope) {
    bool changes = (part->fa < 0) != (part->fb < 0);
    bool is_known = changes ? slope.low >= 0 || slope.high <= 0 : stays(search, part, slope);
    if (!is_known && part->b - part->a > room_at(search, resolution, part->a) && search->work < search->limit)
        search_eighths(search, number, part, slope);
    else if (changes)
        pass_change(search, number, part);
}

/* The value at s, which is stored for the next part. */
static double value_at(struct search *search, const struct expr_program *program, double s) {
    if (search->at != s)
        search->value = evaluate(search, program, s);
    search->at = s;
    return search->value;
}

static void search_eighths(struct search *search, uint32_t number, const struct part *part, struct slope slope) {
    const struct expr_program *program = &search->solid->programs[search->solid->regions[number].program];
    struct expr_lane_range range;
    double ends[EXPR_LANES + 1];
    for (int i = 0; i < EXPR_LANES; i++)
        ends[i] = part->a + (part->b - part->a) * ((double)i / EXPR_LANES);
    ends[EXPR_LANES] = part->b;
    if (!bound_eighths(search, program, ends, false, &range))
        return;
    for (int i = 0; i < EXPR_LANES && !search->is_done; i++) {
        enum side side = side_of_lane(&range, i);
        struct slope here = {range.slopes[0].low[i], range.slopes[0].high[i]};
        /* A jump without a change of sign is no surface. */
        if (side == SIDE_UNKNOWN && !(here.low > -INFINITY && here.high < INFINITY))
            side = side_of_cases(search, program, ends[i], ends[i + 1]);
        if (search->is_full)
            return;
        if (side != SIDE_UNKNOWN) {
            settle(search, side == SIDE_INSIDE, ends[i], number, number);
            continue;
        }
        /* The bounds of the whole part hold, too. */
        here.low = here.low > slope.low ? here.low : slope.low;
        here.high = here.high < slope.high ? here.high : slope.high;
        struct part eighth = {.a = ends[i], .b = ends[i + 1]};
        eighth.fa = i == 0 ? part->fa : value_at(search, program, ends[i]);
        eighth.fb = i == EXPR_LANES - 1 ? part->fb : value_at(search, program, ends[i + 1]);
        settle(search, eighth.fa < 0, ends[i], number, number);
        if (!search->is_done)
            search_part(search, number, &eighth, here);
    }
}

/* The part from s0 to s1 with a Lipschitz bound. Around a point there is no crossing within |f| / lipschitz. If the
 * function grows along the line, the spheres of the next point reach back, so the step may be longer: it is tried,
 * and repeated if both spheres do not meet. A march begins at the region, so that it does not depend on the ray. */
static void march(struct search *search, uint32_t number, double s0, double s1) {
    const struct expr_program *program = &search->solid->programs[search->solid->regions[number].program];
    const double lipschitz = search->solid->in.lipschitz;
    double smallest = room_at(search, march_resolution, s0), trend = -1; /* of |f| / lipschitz along the line */
    int smallest_steps = 0;
    const double first = search->is_any ? (search->ray->t_min - search->line.t0) * search->line.speed : s0;
    if (first > s0 && first < s1) { /* where the crossing is does not matter */
        s0 = first;
        search->is_unknown = true;
        search->has_waiting = false;
    }
    struct part part = {.a = s0, .fa = value_at(search, program, s0)};
    settle(search, part.fa < 0, s0, number, search->begin_part);
    while (part.a < s1 && !search->is_done) {
        double clear = fabs(part.fa) / lipschitz;
        clear = clear < INFINITY ? clear : 0; /* or NaN */
        double step = clear > smallest ? clear : smallest, longer = 1.9 * clear / (1 - trend);
        bool is_longer = longer > step;
        part.b = math_min(part.a + (is_longer ? longer : step), s1);
        part.fb = value_at(search, program, part.b);
        bool changes = (part.fa < 0) != (part.fb < 0);
        if (is_longer && (changes || !(fabs(part.fa) + fabs(part.fb) >= lipschitz * (part.b - part.a)))) {
            part.b = math_min(part.a + step, s1);
            part.fb = value_at(search, program, part.b);
            changes = (part.fa < 0) != (part.fb < 0);
        }
        smallest_steps += step <= smallest;
        if (smallest_steps == MARCH_SMALLEST) {
            smallest *= 2;
            smallest_steps = 0;
        }
        trend = (fabs(part.fb) - fabs(part.fa)) / (lipschitz * (part.b - part.a));
        trend = trend > -1 && !changes ? math_min(trend, 0.8) : -1; /* or NaN */
        if (changes)
            pass_change(search, number, &part);
        if (search->has_waiting && search->waiting.t < line_t(&search->line, part.b) && !search->is_done)
            give_out(search); /* at once: the steps inside are short */
        part.a = part.b;
        part.fa = part.fb;
    }
}

/* The box of a node. */
struct node_box {
    double lo[3], hi[3];
};

/* Decides the side by the value at the centre of the region and by the slopes. They bound the function by linear
 * functions, whose extremes are at the ends of the segment. */
static enum side side_by_slopes(const struct search *search, const struct implicit_region *region,
                                const struct node_box *box, double s0, double s1) {
    double lows[2], highs[2];
    for (int end = 0; end < 2; end++) {
        double s = end == 0 ? s0 : s1, low = (double)region->middle_low, high = (double)region->middle_high, size = 0;
        for (int k = 0; k < 3; k++) {
            double off =
                search->origin[k] + vec3_get(search->line.direction, k) * s - region_middle(box->lo[k], box->hi[k]);
            double a = off * (double)region->low[k], b = off * (double)region->high[k];
            low += a < b ? a : b;
            high += a < b ? b : a;
            size += fabs(a) + fabs(b);
        }
        lows[end] = low - size * 0x1p-44;
        highs[end] = high + size * 0x1p-44;
    }
    if (lows[0] > 0 && lows[1] > 0)
        return SIDE_OUTSIDE;
    return highs[0] < 0 && highs[1] < 0 ? SIDE_INSIDE : SIDE_UNKNOWN;
}

/* Whether the sphere around the centre of the region, in which the function has the sign of the centre, contains
 * both ends and so the segment. */
static enum side side_by_sphere(const struct search *search, const struct implicit_region *region,
                                const struct node_box *box, double s0, double s1) {
    double squares[2] = {0, 0};
    for (int end = 0; end < 2; end++)
        for (int k = 0; k < 3; k++) {
            double off = search->origin[k] + vec3_get(search->line.direction, k) * (end == 0 ? s0 : s1) -
                         region_middle(box->lo[k], box->hi[k]);
            squares[end] += off * off;
        }
    double change = search->solid->in.lipschitz * sqrt(squares[0] > squares[1] ? squares[0] : squares[1]) * (1 + 1e-9);
    if ((double)region->middle_low > change)
        return SIDE_OUTSIDE;
    return (double)region->middle_high < -change ? SIDE_INSIDE : SIDE_UNKNOWN;
}

static void pass_surface(struct search *search, uint32_t number, double s0, double s1) {
    const struct implicit_region *region = &search->solid->regions[number];
    const struct expr_program *program = &search->solid->programs[region->program];
    struct part part = {.a = s0, .b = s1};
    part.fa = value_at(search, program, s0);
    part.fb = value_at(search, program, s1);
    double value = part.fb;
    settle(search, part.fa < 0, s0, number, search->begin_part);
    if (!search->is_done)
        search_part(search, number, &part, slope_in(search, region));
    search->at = s1;
    search->value = value;
}

/* Whether the ray begins after s. For such a segment only the side at its end is needed. */
static bool is_before(const struct search *search, double s) {
    return search->ray && line_t(&search->line, s) <= search->ray->t_min;
}

static void pass_region(struct search *search, uint32_t node, const struct node_box *box, double s0, double s1) {
    const uint32_t value = search->solid->nodes[node], number = value >> 2;
    if (is_before(search, s1)) {
        search->is_unknown = true;
    } else {
        /* Bounds decide most regions without an evaluation. */
        enum region_kind kind = (enum region_kind)(value & 3);
        enum side side = kind == REGION_INSIDE ? SIDE_INSIDE : SIDE_OUTSIDE;
        const bool is_marched = search->solid->in.lipschitz > 0;
        if (kind == REGION_SURFACE)
            side = (is_marched ? side_by_sphere : side_by_slopes)(search, &search->solid->regions[number], box, s0, s1);
        if (side == SIDE_UNKNOWN && is_marched)
            march(search, number, s0, s1);
        else if (side == SIDE_UNKNOWN)
            pass_surface(search, number, s0, s1);
        else
            settle(search, side == SIDE_INSIDE, s0, kind == REGION_SURFACE ? number : IMPLICIT_PART_WHOLE,
                   search->begin_part);
    }
    if (!search->ray || search->is_done)
        return;
    /* Nothing behind this place can cancel the crossing that waits. */
    double t = line_t(&search->line, s1);
    if (search->has_waiting && search->waiting.t < t)
        give_out(search);
    search->is_done = search->is_done || t >= search->ray->t_max;
}

/* The stretch from s0 to s1, on which the line is in a node of the octree. */
static void pass_node(struct search *search, uint32_t node, const struct node_box *box, double s0, double s1) {
    uint32_t value = search->solid->nodes[node], number = value >> 2, part = 0;
    enum region_kind kind = (enum region_kind)(value & 3);
    if (kind != REGION_SPLIT || is_before(search, s1)) {
        pass_region(search, node, box, s0, s1);
        return;
    }
    /* Visits the parts in order. The line changes to the other half of an axis where it crosses the middle. */
    double middles[3], meets[3];
    for (int k = 0; k < 3; k++) {
        middles[k] = region_middle(box->lo[k], box->hi[k]);
        bool is_upper = search->origin[k] >= middles[k];
        meets[k] = INFINITY;
        if (search->inverse[k] != 0) {
            meets[k] = (middles[k] - search->origin[k]) * search->inverse[k];
            is_upper = (meets[k] <= s0) == (search->inverse[k] > 0);
            if (meets[k] <= s0)
                meets[k] = INFINITY;
        }
        part |= is_upper ? 1U << k : 0;
    }
    while (s0 < s1 && !search->is_done) {
        int axis = meets[0] <= meets[1] ? 0 : 1;
        axis = meets[axis] <= meets[2] ? axis : 2;
        double next = meets[axis] < s1 ? meets[axis] : s1;
        if (next > s0) {
            struct node_box half;
            for (int k = 0; k < 3; k++) {
                half.lo[k] = part >> k & 1 ? middles[k] : box->lo[k];
                half.hi[k] = part >> k & 1 ? box->hi[k] : middles[k];
            }
            pass_node(search, number + part, &half, s0, next);
        }
        part ^= 1U << axis;
        meets[axis] = INFINITY;
        s0 = next;
    }
}

/* --- lines --- */

/* False: the line is off the bounds. */
static bool search_begin(struct search *search, const struct implicit *solid, const struct ray *ray,
                         struct geom_scratch *scratch) {
    search->solid = solid;
    search->scratch = scratch;
    if (!line_init(&search->line, ray, implicit_middle(solid)) || !line_meets_box(&search->line, &solid->tight))
        return false;
    for (int k = 0; k < 3; k++) {
        double d = vec3_get(search->line.direction, k);
        search->origin[k] = vec3_get(search->line.origin, k);
        search->inverse[k] = fabs(d) > 0x1p-1000 ? 1 / d : 0;
    }
    search->inside = search->is_unknown = search->has_waiting = search->has_found = search->is_done = search->is_full =
        search->is_any = search->is_list = false;
    search->work = 0;
    search->limit = WORK;
    search->tolerance = (double)scratch->tolerance * search->line.speed;
    search->at = (double)NAN;
    search->ray = NULL;
    search->found = NULL;
    return solid->in.is_ball ? clip_ball(search, solid->in.centre, solid->in.radius)
                             : clip_box(search, &solid->in.bounds);
}

static void search_run(struct search *search) {
    const struct box *b = &search->solid->in.bounds;
    struct node_box box = {{b->min.x, b->min.y, b->min.z}, {b->max.x, b->max.y, b->max.z}};
    pass_node(search, 0, &box, search->begin, search->end);
    if (search->inside && !search->is_done)
        cross(search, search->end, search->end_part);
    if (!search->is_done)
        give_out(search);
}

bool implicit_crossings(const struct implicit *solid, const struct ray *ray, struct geom_scratch *scratch,
                        struct crossing_list *out) {
    struct search search;
    *out = (struct crossing_list){scratch->used, 0};
    if (!search_begin(&search, solid, ray, scratch))
        return true;
    search.is_list = true;
    search_run(&search);
    if (search.is_full) {
        scratch->used = out->first;
        return false;
    }
    out->count = scratch->used - out->first;
    return true;
}

uint64_t implicit_line_work(const struct implicit *solid, const struct ray *ray, uint64_t limit,
                            struct geom_scratch *scratch) {
    struct search search;
    const uint32_t used = scratch->used;
    if (!search_begin(&search, solid, ray, scratch))
        return 0;
    search.is_list = true;
    search.limit = limit;
    search_run(&search);
    scratch->used = used;
    return search.work;
}

static bool find_first(const struct implicit *solid, const struct ray *ray, struct geom_scratch *scratch, bool is_any,
                       struct crossing *out) {
    struct search search;
    if (!search_begin(&search, solid, ray, scratch) || line_t(&search.line, search.begin) >= ray->t_max ||
        line_t(&search.line, search.end) <= ray->t_min)
        return false;
    search.ray = ray;
    search.found = out;
    search.is_any = is_any;
    search_run(&search);
    return search.has_found;
}

bool implicit_nearest(const struct implicit *solid, const struct ray *ray, struct geom_scratch *scratch,
                      struct crossing *out) {
    return find_first(solid, ray, scratch, false, out);
}

bool implicit_any(const struct implicit *solid, const struct ray *ray, struct geom_scratch *scratch) {
    struct crossing ignored;
    return find_first(solid, ray, scratch, true, &ignored);
}

/* --- rays of a preview together ---
 *
 * Each ray marches on its own, from leaf to leaf of the octree; the function is evaluated at the places of all rays at
 * once. A step may leave the region. Hits may differ from those of rays alone by the tolerance. */

struct lane {
    struct search search;
    struct part part; /* a: the last place, if has_value; b: the next one */
    double step, smallest;
    double last;     /* where the search ends */
    uint32_t number; /* of the region */
    uint32_t ray;
    int smallest_steps;
    /* The finest cells: how many in a unit of length, their size, and that of the place; the nodes that contain it. */
    double cells[3], widths[3];
    uint32_t cell[3], level, path[IMPLICIT_LEVELS + 1];
    bool has_value, is_longer;
};

/* The leaf just behind s, its box, and where the line leaves it. Nodes that contain the place before, too, are known.
 */
static uint32_t find_leaf(struct lane *lane, double s, struct node_box *box, double *leaves) {
    const struct search *search = &lane->search;
    const struct box *bounds = &search->solid->in.bounds;
    uint32_t cell[3], changed = 0;
    for (int k = 0; k < 3; k++) {
        const double above_min = search->origin[k] + vec3_get(search->line.direction, k) * s - vec3_get(bounds->min, k);
        cell[k] = (uint32_t)math_min(math_max(above_min * lane->cells[k], 0), (1 << IMPLICIT_LEVELS) - 1);
        changed |= cell[k] ^ lane->cell[k];
        lane->cell[k] = cell[k];
    }
    while (changed >> (IMPLICIT_LEVELS - lane->level))
        lane->level--;
    while ((lane->path[lane->level] & 3) == REGION_SPLIT) {
        const uint32_t first = lane->path[lane->level] >> 2, shift = IMPLICIT_LEVELS - ++lane->level;
        const uint32_t part = (cell[0] >> shift & 1) | (cell[1] >> shift & 1) << 1 | (cell[2] >> shift & 1) << 2;
        lane->path[lane->level] = search->solid->nodes[first + part];
    }
    const uint32_t above = IMPLICIT_LEVELS - lane->level;
    *leaves = INFINITY;
    for (int k = 0; k < 3; k++) {
        const double inverse = search->inverse[k], size = (double)(1U << above) * lane->widths[k];
        box->lo[k] = vec3_get(bounds->min, k) + (double)(cell[k] >> above) * size;
        box->hi[k] = box->lo[k] + size;
        if (inverse != 0)
            *leaves = math_min(*leaves, ((inverse > 0 ? box->hi[k] : box->lo[k]) - search->origin[k]) * inverse);
    }
    return lane->path[lane->level];
}

static uint32_t number_of_leaf(uint32_t value) {
    return (value & 3) == REGION_SURFACE ? value >> 2 : IMPLICIT_PART_WHOLE;
}

/* Goes on from part.b to a place where the value is needed. False: the search has ended. */
static bool lane_advance(struct lane *lane) {
    struct search *search = &lane->search;
    const struct implicit *solid = search->solid;
    const double margin = solid->size * IMPLICIT_MARGIN / 2;
    for (;;) {
        const double s = lane->part.b, t = line_t(&search->line, s);
        if (search->has_waiting && search->waiting.t < t)
            give_out(search);
        if (search->is_done)
            return false;
        if (s >= search->end || t >= search->ray->t_max) {
            if (s >= search->end && search->inside)
                cross(search, search->end, search->end_part);
            give_out(search);
            return false;
        }
        struct node_box box;
        double leaves;
        const uint32_t value = find_leaf(lane, s + margin, &box, &leaves), before = lane->number;
        enum side side = (value & 3) == REGION_INSIDE ? SIDE_INSIDE : SIDE_OUTSIDE;
        lane->number = number_of_leaf(value);
        if ((value & 3) == REGION_SURFACE)
            side = side_by_sphere(search, &solid->regions[value >> 2], &box, s, math_max(s, leaves));
        if (side == SIDE_UNKNOWN && lane->number != before) {
            lane->smallest = room_at(search, march_resolution, s);
            lane->smallest_steps = 0;
        }
        if (side == SIDE_UNKNOWN || (lane->has_value && lane->is_longer))
            return true;
        settle(search, side == SIDE_INSIDE, s, lane->number, search->begin_part);
        lane->has_value = false;
        lane->part.b = math_max(s, leaves) + margin;
    }
}

/* See march. */
static void lane_take(struct lane *lane, double value) {
    struct search *search = &lane->search;
    struct part *part = &lane->part;
    const double lipschitz = search->solid->in.lipschitz;
    const bool changes = lane->has_value && (part->fa < 0) != (value < 0);
    double trend = -1;
    part->fb = value;
    if (lane->has_value) {
        if (lane->is_longer && (changes || !(fabs(part->fa) + fabs(value) >= lipschitz * (part->b - part->a)))) {
            part->b = part->a + lane->step;
            lane->is_longer = false;
            return;
        }
        trend = (fabs(value) - fabs(part->fa)) / (lipschitz * (part->b - part->a));
        trend = trend > -1 && !changes ? math_min(trend, 0.8) : -1; /* or NaN */
        if (changes) {
            double s = find_change(search, search->solid->programs, part->a, part->fa, part->b, value), leaves;
            struct node_box box;
            cross(search, s, number_of_leaf(find_leaf(lane, s, &box, &leaves)));
        }
    } else {
        settle(search, value < 0, part->b, lane->number, search->begin_part);
    }
    double clear = fabs(value) / lipschitz;
    clear = clear < INFINITY ? clear : 0; /* or NaN */
    lane->step = math_max(clear, lane->smallest);
    const double longer = 1.9 * clear / (1 - trend);
    *part = (struct part){.a = part->b, .fa = value};
    lane->is_longer = longer > lane->step && part->a + longer < lane->last;
    part->b = part->a + (lane->is_longer ? longer : lane->step);
    lane->has_value = true;
    lane->smallest_steps += lane->step <= lane->smallest;
    if (lane->smallest_steps == MARCH_SMALLEST) {
        lane->smallest *= 2;
        lane->smallest_steps = 0;
    }
}

/* The function at the places of lanes: as it is shortened for the region of all of them; else the whole one, or each
 * its own, whichever is less work. */
static void evaluate_lanes(struct lane *const *lanes, uint32_t count, double points[3][EXPR_BATCH], double *values,
                           void *rows) {
    const struct implicit *solid = lanes[0]->search.solid;
    const double *const inputs[EXPR_INPUT_COUNT] = {
        [EXPR_POINT_X] = points[0], [EXPR_POINT_Y] = points[1], [EXPR_POINT_Z] = points[2]};
    double *const outputs[EXPR_OUTPUTS] = {values};
    const struct expr_program *programs[EXPR_BATCH], *whole = solid->programs;
    uint64_t work = 0;
    bool is_same = true;
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t number = lanes[i]->number;
        programs[i] = &whole[number < solid->region_count ? solid->regions[number].program : 0];
        work += expr_work(programs[i]);
        is_same = is_same && programs[i] == programs[0];
    }
    if (is_same) {
        expr_evaluate_batch(programs[0], count, inputs, outputs, rows);
    } else if (work > expr_work(whole) * (count + 3) / 4) {
        expr_evaluate_batch(whole, count, inputs, outputs, rows);
    } else {
        for (uint32_t i = 0; i < count; i++)
            values[i] = evaluate(&lanes[i]->search, programs[i], lanes[i]->part.b);
    }
}

bool implicit_takes_packets(const struct implicit *solid, const struct geom_scratch *scratch) {
    return solid->in.lipschitz > 0 && scratch->tolerance > 0 && expr_batch_size(solid->programs) <= IMPLICIT_STACK;
}

uint64_t implicit_nearest_packet(const struct implicit *solid, const struct ray *rays, uint64_t active,
                                 struct geom_scratch *scratch, struct crossing *out) {
    _Alignas(IMPLICIT_ALIGNMENT) unsigned char memory[IMPLICIT_STACK];
    struct lane lanes[EXPR_BATCH], *alive[EXPR_BATCH];
    double points[3][EXPR_BATCH], values[EXPR_BATCH];
    const struct vec3 edges = vec3_sub(solid->in.bounds.max, solid->in.bounds.min);
    uint32_t count = 0;
    uint64_t found = 0;
    for (; active; active &= active - 1) {
        struct lane *lane = &lanes[count];
        const uint32_t i = (uint32_t)__builtin_ctzll(active);
        if (!search_begin(&lane->search, solid, &rays[i], scratch))
            continue;
        const double first = (rays[i].t_min - lane->search.line.t0) * lane->search.line.speed;
        lane->search.ray = &rays[i];
        lane->search.found = &out[i];
        lane->search.is_unknown = first > lane->search.begin;
        lane->part.b = math_max(first, lane->search.begin);
        lane->last = math_min((rays[i].t_max - lane->search.line.t0) * lane->search.line.speed, lane->search.end);
        lane->ray = i;
        lane->number = IMPLICIT_PART_WHOLE;
        lane->level = 0;
        lane->path[0] = solid->nodes[0];
        for (int k = 0; k < 3; k++) {
            lane->widths[k] = vec3_get(edges, k) / (1 << IMPLICIT_LEVELS);
            lane->cells[k] = 1 / lane->widths[k];
            lane->cell[k] = 0;
        }
        lane->has_value = false;
        alive[count++] = lane;
    }
    while (count > 0) {
        uint32_t kept = 0;
        for (uint32_t i = 0; i < count; i++) {
            struct lane *lane = alive[i];
            if (!lane_advance(lane)) {
                found |= (uint64_t)lane->search.has_found << lane->ray;
                continue;
            }
            const struct vec3 p = line_at(&lane->search.line, lane->part.b);
            points[0][kept] = p.x;
            points[1][kept] = p.y;
            points[2][kept] = p.z;
            alive[kept++] = lane;
        }
        count = kept;
        if (count > 0)
            evaluate_lanes(alive, count, points, values, memory);
        for (uint32_t i = 0; i < count; i++)
            lane_take(alive[i], values[i]);
    }
    return found;
}
