/* The regions of an implicit solid: the leaves of an octree, which is built level by level. Bounds of the function over
 * a node (interval arithmetic) may prove it outside or inside. Other nodes are divided until bounds of the slopes show
 * that the surface is nearly flat in them. Then the values at both ends of a line's stretch decide it. The program of a
 * node leaves out the operands that min, max and selections never take there. Programs of divided nodes are freed at
 * the end.
 *
 * T. Duff, "Interval arithmetic and recursive subdivision for implicit functions and constructive solid geometry",
 * SIGGRAPH 1992; M. Keeter, "Massively parallel rendering of complex closed-form implicit surfaces", SIGGRAPH 2020. */

#include "base/mem.h"
#include "expr/expr_shorten.h"
#include "math/portable.h"
#include "shape/implicit_regions_internal.h"

#include <math.h>
#include <string.h>

/* Limits of the work and of the memory: nodes, instructions that are evaluated over regions, and instructions of
 * shortened programs. Beyond KEPT, regions use the program of a larger region, up to twice KEPT in all. */
enum { NODES = 1 << 18, EVALUATED = 24000000, KEPT = 1000000, FIRST_LEVELS = 2 };
/* With a Lipschitz bound, regions are bounded by values at their centres. Bounds over boxes only shorten programs; they
 * are computed until a program has not become shorter for as many levels. A point costs less than a box. */
enum { MARCH_LEVELS = 7, SHORTENING_LEVELS = 2, POINTS_OF_A_BOX = 8 };
/* The largest deviation of the slopes from their middle, of its length, in a region that is flat. */
static const double slope_spread = 0.4;

/* A node that is not decided yet. */
struct pending {
    struct box box;
    uint32_t candidate; /* the program of the node that was divided */
    int level;
};

/* The program of a node that was divided. Candidates exist only while the octree is built; regions keep those that they
 * need. */
struct candidate {
    struct expr_program program;
    uint32_t parent; /* the candidate that it is a part of */
    uint32_t kept;   /* its number among the programs, or NOT_KEPT */
    int level;       /* of the node */
};
#define NOT_KEPT UINT32_MAX

struct building {
    struct implicit *solid;
    struct arena *arena;
    uint32_t *nodes;
    struct pending *pending; /* of each node */
    struct implicit_region *regions;
    struct expr_program *programs;
    struct candidate *candidates;
    struct arena candidate_arena;
    uint32_t node_count, node_capacity, region_count, region_capacity, program_count, program_capacity;
    uint32_t candidate_count, candidate_capacity;
    uint64_t evaluated, kept;
    struct expr_directions directions; /* the axes */
    struct expr_choice *choices;
    struct expr_instruction *code; /* for one shortened program, before and after folding */
    void *rows, *scratch;
};

/* Room for `more` entries of an array. */
static bool reserve(void **array, uint32_t *capacity, uint32_t count, uint32_t more, size_t size) {
    if (count + more <= *capacity)
        return true;
    uint32_t larger = (count + more) * 2;
    void *moved = mem_resize_array(*array, larger, size);
    if (!moved)
        return false;
    *array = moved;
    *capacity = larger;
    return true;
}

/* The bounds of a region with room for rounding. */
static struct box wider(const struct implicit *solid, const struct box *box) {
    struct vec3 margin = vec3_all(solid->size * IMPLICIT_MARGIN);
    return (struct box){vec3_sub(box->min, margin), vec3_add(box->max, margin)};
}

static bool is_finite(const struct expr_interval *x) {
    return x->low > -INFINITY && x->high < INFINITY;
}

static bool is_flat(const struct expr_interval slopes[EXPR_DIRECTIONS]) {
    double length = 0, deviation = 0;
    for (int k = 0; k < 3; k++) {
        if (!is_finite(&slopes[k]))
            return false;
        double middle = slopes[k].low / 2 + slopes[k].high / 2, radius = slopes[k].high / 2 - slopes[k].low / 2;
        length += middle * middle;
        deviation += radius * radius;
    }
    return deviation < slope_spread * slope_spread * length;
}

/* The program for a region whose choices are known. False if it is not much shorter. The next one overwrites it. */
static bool shorten(struct building *b, const struct expr_program *whole, int lane, struct expr_program *out) {
    struct expr_stack stack = {.code = b->code, .free = 2 * (size_t)whole->count};
    void *scratch = implicit_aligned(b->scratch);
    return expr_shorten(whole, b->choices, (uint32_t)lane, &stack, scratch, out) &&
           expr_fold(out, &stack, scratch, out) && out->count + out->count / 16 < whole->count;
}

static bool add_candidate(struct building *b, const struct expr_program *program, uint32_t parent, int level,
                          uint32_t *out) {
    struct candidate candidate = {.parent = parent, .kept = NOT_KEPT, .level = level};
    if (!expr_keep(program, &b->candidate_arena, &candidate.program) ||
        !reserve((void **)&b->candidates, &b->candidate_capacity, b->candidate_count, 1, sizeof *b->candidates))
        return false;
    b->candidates[b->candidate_count] = candidate;
    *out = b->candidate_count++;
    return true;
}

static bool keep_program(struct building *b, const struct expr_program *program, uint32_t *out) {
    struct expr_program stored;
    if (!expr_keep(program, b->arena, &stored) ||
        !reserve((void **)&b->programs, &b->program_capacity, b->program_count, 1, sizeof *b->programs))
        return false;
    b->kept += program->count;
    b->programs[b->program_count] = stored;
    *out = b->program_count++;
    return true;
}

/* The program of a region: the shortened one; or that of the divided node, if there is no shortened one (NULL) or no
 * room for it. */
static bool choose_program(struct building *b, const struct expr_program *shorter, uint32_t candidate, uint32_t *out) {
    if (shorter && b->kept < KEPT)
        return keep_program(b, shorter, out);
    while (b->candidates[candidate].kept == NOT_KEPT && b->kept >= 2 * (uint64_t)KEPT)
        candidate = b->candidates[candidate].parent;
    struct candidate *chosen = &b->candidates[candidate];
    if (chosen->kept == NOT_KEPT && !keep_program(b, &chosen->program, &chosen->kept))
        return false;
    *out = chosen->kept;
    return true;
}

static float below(double x) {
    float f = (float)x;
    return f <= x ? f : math_nextafterf(f, -INFINITY);
}

static bool add_region(struct building *b, uint32_t node, const struct expr_program *shorter,
                       const struct expr_interval slopes[EXPR_DIRECTIONS]) {
    const struct pending *here = &b->pending[node];
    struct implicit_region region;
    double inputs[EXPR_INPUT_COUNT], outputs[EXPR_OUTPUTS];
    for (int k = 0; k < 3; k++)
        inputs[EXPR_POINT_X + k] = region_middle(vec3_get(here->box.min, k), vec3_get(here->box.max, k));
    if (!choose_program(b, shorter, here->candidate, &region.program))
        return false;
    expr_evaluate(&b->programs[region.program], inputs, outputs);
    region.middle_low = outputs[0] == outputs[0] ? below(outputs[0]) : -INFINITY;
    region.middle_high = outputs[0] == outputs[0] ? -below(-outputs[0]) : INFINITY;
    for (int k = 0; k < 3; k++) {
        region.low[k] = below(slopes[k].low);
        region.high[k] = -below(-slopes[k].high);
    }
    if (!reserve((void **)&b->regions, &b->region_capacity, b->region_count, 1, sizeof *b->regions))
        return false;
    b->nodes[node] = b->region_count << 2 | REGION_SURFACE;
    b->regions[b->region_count++] = region;
    return true;
}

static bool add_nodes(struct building *b, uint32_t count) {
    uint32_t capacity = b->node_capacity;
    return reserve((void **)&b->nodes, &capacity, b->node_count, count, sizeof *b->nodes) &&
           reserve((void **)&b->pending, &b->node_capacity, b->node_count, count, sizeof *b->pending);
}

/* Divides a node. */
static bool add_parts(struct building *b, uint32_t node) {
    uint32_t first = b->node_count;
    if (!add_nodes(b, 8))
        return false;
    struct pending whole = b->pending[node];
    struct vec3 lo = whole.box.min, hi = whole.box.max;
    struct vec3 middle = {region_middle(lo.x, hi.x), region_middle(lo.y, hi.y), region_middle(lo.z, hi.z)};
    for (uint32_t k = 0; k < 8; k++) {
        struct pending part = {.candidate = whole.candidate, .level = whole.level + 1};
        part.box.min = vec3_make(k & 1 ? middle.x : lo.x, k & 2 ? middle.y : lo.y, k & 4 ? middle.z : lo.z);
        part.box.max = vec3_make(k & 1 ? hi.x : middle.x, k & 2 ? hi.y : middle.y, k & 4 ? hi.z : middle.z);
        b->pending[first + k] = part;
    }
    b->node_count += 8;
    b->nodes[node] = first << 2 | REGION_SPLIT;
    return true;
}

/* Whether a box and the ball of the bounds have a point in common. */
static bool meets_ball(const struct implicit_input *in, const struct box *box) {
    double square = 0;
    for (int k = 0; k < 3; k++) {
        double c = vec3_get(in->centre, k), lo = vec3_get(box->min, k), hi = vec3_get(box->max, k);
        double gap = c < lo ? lo - c : c > hi ? c - hi : 0;
        square += gap * gap;
    }
    return square <= in->radius * in->radius * (1 + 0x1p-40);
}

/* Of one lane of the slopes. */
static enum region_kind kind_of_lane(const struct expr_lane_range *range, int lane) {
    if (range->low[lane] >= 0 || range->is_nan >> lane & 1)
        return REGION_OUTSIDE;
    return range->high[lane] < 0 && !(range->may_be_nan >> lane & 1) ? REGION_INSIDE : REGION_SURFACE;
}

static void evaluate_boxes(struct building *b, const struct expr_program *program, const struct box boxes[EXPR_LANES],
                           bool are_cases, struct expr_lane_range *out) {
    struct expr_lane_inputs inputs;
    struct expr_lane_range outputs[EXPR_OUTPUTS];
    inputs.are_cases = are_cases;
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < EXPR_LANES; i++) {
            inputs.low[EXPR_POINT_X + k][i] = vec3_get(boxes[are_cases ? 0 : i].min, k);
            inputs.high[EXPR_POINT_X + k][i] = vec3_get(boxes[are_cases ? 0 : i].max, k);
        }
    expr_evaluate_slopes_lanes(program, &inputs, &b->directions, outputs, are_cases ? NULL : b->choices,
                               implicit_aligned(b->rows));
    *out = outputs[0];
}

/* The function may be discontinuous within a region and have one sign on both sides. */
static enum region_kind kind_of_cases(struct building *b, const struct expr_program *program, const struct box *box) {
    struct expr_lane_range range;
    evaluate_boxes(b, program, box, true, &range);
    enum region_kind kind = kind_of_lane(&range, 0);
    for (int i = 1; i < EXPR_LANES; i++)
        kind = kind_of_lane(&range, i) == kind ? kind : REGION_SURFACE;
    return kind;
}

/* Decides the kind of a node by the bounds over its box in one lane. */
static bool decide(struct building *b, uint32_t node, const struct box *box, const struct expr_lane_range *range,
                   int lane) {
    struct implicit *solid = b->solid;
    struct pending *here = &b->pending[node];
    const struct expr_program *program = &b->candidates[here->candidate].program;
    struct expr_program shorter;
    struct expr_interval slopes[EXPR_DIRECTIONS];
    enum region_kind kind = kind_of_lane(range, lane);
    bool is_bounded = true;
    for (int k = 0; k < 3; k++) {
        slopes[k] = (struct expr_interval){range->slopes[k].low[lane], range->slopes[k].high[lane], false};
        is_bounded = is_bounded && is_finite(&slopes[k]);
    }
    if (solid->in.is_ball && !meets_ball(&solid->in, box))
        kind = REGION_OUTSIDE;
    else if (kind == REGION_SURFACE && !is_bounded)
        kind = kind_of_cases(b, program, box);
    b->nodes[node] = kind;
    if (kind == REGION_OUTSIDE)
        return true;
    solid->tight = box_join(solid->tight, *box);
    if (kind == REGION_INSIDE)
        return true;
    /* In its part the function may be shorter; as long as that helps, the part is divided. */
    bool is_shorter = shorten(b, program, lane, &shorter);
    uint32_t before = program->count, after = is_shorter ? shorter.count : before;
    bool is_simple = is_flat(slopes) && (after < 32 || after > before - before / 8);
    bool has_room = here->level < IMPLICIT_LEVELS && b->node_count + 8 <= NODES && b->evaluated < EVALUATED;
    if (has_room && (here->level < FIRST_LEVELS || !is_simple)) {
        b->evaluated += 8 * (uint64_t)after;
        return (!is_shorter || add_candidate(b, &shorter, here->candidate, here->level, &here->candidate)) &&
               add_parts(b, node);
    }
    return add_region(b, node, is_shorter ? &shorter : NULL, slopes);
}

/* --- with a Lipschitz bound --- */

/* Values at the centres of eight nodes. */
static void evaluate_centres(struct building *b, const struct expr_program *program, uint32_t first,
                             double out[EXPR_LANES]) {
    double points[3][EXPR_LANES];
    const double *inputs[EXPR_INPUT_COUNT] = {NULL};
    double *outputs[EXPR_OUTPUTS] = {out};
    for (int k = 0; k < 3; k++) {
        for (uint32_t i = 0; i < EXPR_LANES; i++) {
            const struct box *box = &b->pending[first + i].box;
            points[k][i] = region_middle(vec3_get(box->min, k), vec3_get(box->max, k));
        }
        inputs[EXPR_POINT_X + k] = points[k];
    }
    b->evaluated += EXPR_LANES * expr_work(program) / POINTS_OF_A_BOX;
    expr_evaluate_batch(program, EXPR_LANES, inputs, outputs, implicit_aligned(b->rows));
}

/* Bounds of the values over eight boxes, and the choices. */
static void bound_boxes(struct building *b, const struct expr_program *program, const struct box boxes[EXPR_LANES],
                        struct expr_bounds *out) {
    double low[3][EXPR_LANES], high[3][EXPR_LANES];
    struct expr_boxes inputs = {.count = EXPR_LANES};
    struct expr_bounds outputs[EXPR_OUTPUTS];
    for (int k = 0; k < 3; k++) {
        for (int i = 0; i < EXPR_LANES; i++) {
            low[k][i] = vec3_get(boxes[i].min, k);
            high[k][i] = vec3_get(boxes[i].max, k);
        }
        inputs.low[EXPR_POINT_X + k] = low[k];
        inputs.high[EXPR_POINT_X + k] = high[k];
    }
    b->evaluated += EXPR_LANES * expr_work(program);
    expr_evaluate_intervals(program, &inputs, outputs, b->choices, implicit_aligned(b->rows));
    *out = outputs[0];
}

static enum region_kind kind_of_bounds(const struct expr_bounds *bounds, int lane) {
    if (bounds->low[lane] >= 0)
        return REGION_OUTSIDE;
    return bounds->high[lane] < 0 && !(bounds->may_be_nan >> lane & 1) ? REGION_INSIDE : REGION_SURFACE;
}

/* Decides the kind of a node by the value at its centre, or by its bounds in one lane; bounds is NULL if they are not
 * known. */
static bool decide_by_sphere(struct building *b, uint32_t node, double value, const struct expr_bounds *bounds,
                             int lane) {
    struct implicit *solid = b->solid;
    struct pending *here = &b->pending[node];
    const struct box box = wider(solid, &here->box);
    const double lipschitz = solid->in.lipschitz;
    const double change = lipschitz * vec3_length(vec3_sub(box.max, box.min)) * 0.5 * (1 + 1e-9);
    enum region_kind kind = bounds ? kind_of_bounds(bounds, lane) : REGION_SURFACE;
    /* The promise: within the box the function changes no more than this. */
    if (kind == REGION_SURFACE && fabs(value) > change && fabs(value) < INFINITY)
        kind = value < 0 ? REGION_INSIDE : REGION_OUTSIDE;
    if (solid->in.is_ball && !meets_ball(&solid->in, &box))
        kind = REGION_OUTSIDE;
    b->nodes[node] = kind;
    if (kind != REGION_OUTSIDE)
        solid->tight = box_join(solid->tight, box);
    if (kind != REGION_SURFACE)
        return true;
    const struct expr_program *program = &b->candidates[here->candidate].program;
    struct expr_program shorter;
    bool is_shorter = bounds && shorten(b, program, lane, &shorter);
    if (here->level < MARCH_LEVELS && b->node_count + 8 <= NODES && b->evaluated < EVALUATED)
        return (!is_shorter || add_candidate(b, &shorter, here->candidate, here->level, &here->candidate)) &&
               add_parts(b, node);
    const struct expr_interval slope = {-lipschitz, lipschitz, false};
    return add_region(b, node, is_shorter ? &shorter : NULL,
                      (struct expr_interval[EXPR_DIRECTIONS]){slope, slope, slope});
}

/* --- all nodes --- */

/* Decides the eight parts of a node. */
static bool decide_parts(struct building *b, uint32_t first) {
    struct box boxes[EXPR_LANES];
    const struct expr_program *program = &b->candidates[b->pending[first].candidate].program;
    for (uint32_t k = 0; k < EXPR_LANES; k++)
        boxes[k] = wider(b->solid, &b->pending[first + k].box);
    /* Bounds beside the promise are computed while they still shorten the function. */
    if (b->solid->in.lipschitz > 0) {
        double values[EXPR_LANES];
        struct expr_bounds bounds;
        const int shortened = b->candidates[b->pending[first].candidate].level;
        const bool is_bounded = b->pending[first].level <= shortened + SHORTENING_LEVELS;
        evaluate_centres(b, program, first, values);
        if (is_bounded)
            bound_boxes(b, program, boxes, &bounds);
        for (uint32_t k = 0; k < EXPR_LANES; k++)
            if (!decide_by_sphere(b, first + k, values[k], is_bounded ? &bounds : NULL, (int)k))
                return false;
        return true;
    }
    struct expr_lane_range range;
    evaluate_boxes(b, program, boxes, false, &range);
    for (uint32_t k = 0; k < EXPR_LANES; k++)
        if (!decide(b, first + k, &boxes[k], &range, (int)k))
            return false;
    return true;
}

/* Copies an array into the arena. */
static const void *in_arena(struct arena *arena, const void *array, uint32_t count, size_t size) {
    void *out = arena_alloc_array(arena, (size_t)count + 1, size);
    if (out && count > 0)
        memcpy(out, array, count * size);
    return out;
}

static bool build(struct building *b) {
    struct implicit *solid = b->solid;
    const struct expr_program *program = solid->in.program;
    size_t room = (size_t)program->count + 1;
    b->choices = mem_alloc_zero(room, sizeof *b->choices);
    b->code = mem_alloc_zero(2 * room, sizeof *b->code);
    /* One piece of memory for all evaluations. */
    size_t rows = expr_lanes_size(program);
    if (solid->in.lipschitz > 0) {
        const size_t points = expr_batch_size(program), boxes = expr_intervals_size(program);
        rows = points > boxes ? points : boxes;
    }
    b->rows = mem_alloc_zero(rows + 64, 1);
    b->scratch = mem_alloc_zero(expr_shorten_size(program) + 64, 1);
    if (!b->choices || !b->code || !b->rows || !b->scratch || !add_nodes(b, 1) ||
        !reserve((void **)&b->programs, &b->program_capacity, 0, 1, sizeof *b->programs) ||
        !reserve((void **)&b->candidates, &b->candidate_capacity, 0, 1, sizeof *b->candidates))
        return false;
    b->programs[b->program_count++] = *program;
    b->candidates[b->candidate_count++] = (struct candidate){.program = *program, .kept = 0};
    b->pending[0] = (struct pending){.box = solid->in.bounds};
    b->node_count = 1;
    solid->tight = box_empty();
    if (!add_parts(b, 0))
        return false;
    /* Eight parts at once; parts of parts are added at the end. */
    for (uint32_t first = 1; first < b->node_count; first += EXPR_LANES)
        if (!decide_parts(b, first))
            return false;
    solid->tight = box_is_empty(&solid->tight) ? solid->in.bounds : box_meet(solid->tight, solid->in.bounds);
    solid->nodes = in_arena(b->arena, b->nodes, b->node_count, sizeof *b->nodes);
    solid->regions = in_arena(b->arena, b->regions, b->region_count, sizeof *b->regions);
    solid->programs = in_arena(b->arena, b->programs, b->program_count, sizeof *b->programs);
    solid->node_count = b->node_count;
    solid->region_count = b->region_count;
    solid->program_count = b->program_count;
    return solid->nodes && solid->regions && solid->programs;
}

bool implicit_regions_build(struct arena *arena, struct implicit *solid, struct error *error) {
    struct building b = {.solid = solid, .arena = arena, .directions = {.count = 3}};
    memcpy(b.directions.seeds, expr_gradient_seeds, sizeof b.directions.seeds);
    bool ok = build(&b);
    if (!ok)
        (void)error_no_memory(error, "an implicit solid");
    mem_free(b.nodes);
    mem_free(b.pending);
    mem_free(b.regions);
    mem_free(b.programs);
    mem_free(b.candidates);
    arena_destroy(&b.candidate_arena);
    mem_free(b.choices);
    mem_free(b.code);
    mem_free(b.rows);
    mem_free(b.scratch);
    return ok;
}
