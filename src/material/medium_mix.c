/* See medium_mix.h. */
#include "material/medium_mix.h"

#include "base/random.h"
#include "material/density_internal.h"
#include "math/elementary.h"

/* --- which media --- */

static void add(struct medium_mix *mix, const struct medium *medium) {
    for (; medium && mix->count < MEDIUM_MIX_LIMIT; medium = medium->inner)
        if (medium->fog || !colour_is_black(medium->extinction) || !colour_is_black(medium->emission))
            mix->media[mix->count++] = medium;
}

void medium_stack_mix(const struct medium_stack *stack, struct medium_mix *out) {
    const struct medium *outside = &stack->media->all[stack->media->outside];
    uint32_t below = medium_stack_below(stack, stack->count);
    out->count = 0;
    for (uint32_t i = stack->count; i > below; i--)
        add(out, medium_stack_at(stack, i - 1));
    if (below > 0)
        add(out, medium_stack_at(stack, below - 1));
    else if (!outside->fog || stack->count == 0)
        add(out, outside);
}

bool medium_mix_scatters(const struct medium_mix *mix) {
    bool any = false;
    for (uint32_t i = 0; i < mix->count; i++)
        any = any || mix->media[i]->scatters;
    return any;
}

/* --- where --- */

struct vec3 medium_placement_point(const struct medium_placement *placement, struct vec3 p, double time) {
    if (!placement)
        return p;
    struct vec3 open = affine_point(&placement->open, p), close = affine_point(&placement->close, p);
    return vec3_add_scaled(open, vec3_sub(close, open), time);
}

struct medium_line medium_placement_line(const struct medium_placement *placement, const struct medium_line *line) {
    struct medium_line local = *line;
    if (!placement)
        return local;
    struct vec3 open = affine_vector(&placement->open, line->direction),
                close = affine_vector(&placement->close, line->direction);
    local.origin = medium_placement_point(placement, line->origin, line->time);
    local.direction = vec3_add_scaled(open, vec3_sub(close, open), line->time);
    return local;
}

bool medium_needs_solid(const struct medium *medium) {
    return medium->density && (density_fits(medium->density) || (medium->heat && heat_fits(medium->heat)));
}

double medium_density(const struct medium *medium, struct vec3 p, double time) {
    return medium->density ? density_value(medium->density, medium_placement_point(medium->placement, p, time), time)
                           : 1;
}

struct colour medium_emission_at(const struct medium *medium, double density, struct vec3 p, double time) {
    struct colour emission = colour_scale(medium->emission, density);
    return medium->heat
               ? colour_mul(emission, heat_at(medium->heat, medium_placement_point(medium->placement, p, time), time))
               : emission;
}

/* --- along a line --- */

/* Pieces of the line in which all bounds are constant. */
struct pieces {
    const struct medium_mix *mix;
    const struct medium_line *line;
    double from, to;
    double low[MEDIUM_MIX_LIMIT], high[MEDIUM_MIX_LIMIT]; /* of each density */
    struct medium_line lines[MEDIUM_MIX_LIMIT];           /* where each density is */
    struct density_traversal traversals[MEDIUM_MIX_LIMIT];
    bool inside[MEDIUM_MIX_LIMIT]; /* the traversal has a cell that is not passed */
};

static void begin_pieces(struct pieces *pieces, const struct medium_mix *mix, const struct medium_line *line) {
    pieces->mix = mix;
    pieces->line = line;
    pieces->to = 0;
    for (uint32_t i = 0; i < mix->count; i++) {
        pieces->low[i] = pieces->high[i] = 1;
        pieces->inside[i] = false;
        if (!mix->media[i]->density)
            continue;
        pieces->lines[i] = medium_placement_line(mix->media[i]->placement, line);
        density_begin(mix->media[i]->density, &pieces->lines[i], &pieces->traversals[i]);
        pieces->inside[i] = density_next(&pieces->traversals[i]);
    }
}

/* False: the line ends. */
static bool next_piece(struct pieces *pieces) {
    double from = pieces->from = pieces->to, to = pieces->line->distance;
    if (!(from < to))
        return false;
    for (uint32_t i = 0; i < pieces->mix->count; i++) {
        struct density_traversal *traversal = &pieces->traversals[i];
        if (!pieces->mix->media[i]->density)
            continue;
        while (pieces->inside[i] && !(traversal->to > from))
            pieces->inside[i] = density_next(traversal);
        bool here = pieces->inside[i] && traversal->from <= from;
        pieces->low[i] = here ? traversal->low : 0;
        pieces->high[i] = here ? traversal->high : 0;
        if (pieces->inside[i])
            to = math_min(to, here ? traversal->to : traversal->from);
    }
    pieces->to = to;
    return true;
}

static double density_of(const struct pieces *pieces, uint32_t i, double t) {
    if (!(pieces->high[i] > pieces->low[i]))
        return pieces->high[i];
    struct vec3 p = vec3_add_scaled(pieces->lines[i].origin, pieces->lines[i].direction, t);
    return density_at(pieces->mix->media[i]->density, p, pieces->line->time, pieces->high[i]);
}

/* The sum over the media of their extinction by these densities. */
static struct colour extinction_by(const struct medium_mix *mix, const double density[MEDIUM_MIX_LIMIT]) {
    struct colour sum = {0, 0, 0};
    for (uint32_t i = 0; i < mix->count; i++)
        sum = colour_add_scaled(sum, mix->media[i]->extinction, density[i]);
    return sum;
}

/* Infinite lengths of nothing have no depth. */
static struct colour depth_of(struct colour extinction, double length) {
    return colour_make(extinction.r > 0 ? extinction.r * length : 0, extinction.g > 0 ? extinction.g * length : 0,
                       extinction.b > 0 ? extinction.b * length : 0);
}

static struct colour exponential(struct colour depth) {
    return colour_make(el_exp(-depth.r), el_exp(-depth.g), el_exp(-depth.b));
}

/* --- tracking --- */

/* Tracking as far as it has come. One channel, the hero, decides; `odds` is the probability by which each channel would
 * have come here with the same events, over that of the hero. */
struct tracking {
    struct pieces pieces;
    struct colour share; /* the probability of each channel to be the hero */
    int hero;
    struct colour odds;
    uint64_t key, drawn;
    double u; /* the next number of the distance */
    const struct glow_met *met;
};

static double draw(struct tracking *tracking) {
    return random_unit(random_combine(tracking->key, tracking->drawn++));
}

/* A weight of the channels over the mean probability of all heroes. */
static struct colour over_mean(const struct tracking *tracking, struct colour weight, struct colour probability) {
    double mean = colour_dot(tracking->share, colour_mul(tracking->odds, probability));
    return mean > 0 ? colour_scale(colour_mul(tracking->odds, weight), 1 / mean) : colour_all(0);
}

/* The odds after a stretch without an event, of these depths by channel. */
static void pass(struct tracking *tracking, struct colour depth) {
    double own = colour_get(depth, tracking->hero);
    tracking->odds = colour_mul(tracking->odds, exponential(colour_sub(depth, colour_all(own))));
}

/* An event at t, where the sum of the bounds is `bound`. True: the path ends there, in *out. */
static bool meet(struct tracking *tracking, double t, struct colour bound, struct medium_track *out) {
    const struct medium_mix *mix = tracking->pieces.mix;
    double density[MEDIUM_MIX_LIMIT];
    for (uint32_t i = 0; i < mix->count; i++)
        density[i] = density_of(&tracking->pieces, i, t);
    struct colour real = extinction_by(mix, density);
    double own = colour_get(real, tracking->hero), until = draw(tracking) * colour_get(bound, tracking->hero);
    if (!(until < own)) {
        /* Nothing is there: the bound is the extinction and what fills up to it. */
        struct colour nothing = colour_sub(bound, real);
        tracking->odds = colour_scale(colour_mul(tracking->odds, nothing), 1 / colour_get(nothing, tracking->hero));
        return false;
    }
    uint32_t chosen = 0;
    while (chosen + 1 < mix->count) {
        double part = density[chosen] * colour_get(mix->media[chosen]->extinction, tracking->hero);
        if (until < part)
            break;
        until -= part;
        chosen++;
    }
    const struct medium *medium = mix->media[chosen];
    out->scatterer = medium;
    out->distance = t;
    out->weight = over_mean(tracking, colour_scale(medium->scattering, density[chosen]),
                            colour_scale(medium->extinction, density[chosen]));
    return true;
}

/* Walks to t. True: it ends before. */
static bool track_to(struct tracking *tracking, double t, struct medium_track *out) {
    double at = tracking->pieces.from;
    struct colour bound = extinction_by(tracking->pieces.mix, tracking->pieces.high);
    double own = colour_get(bound, tracking->hero);
    for (;;) {
        double depth = own * (t - at), step = -el_log(1 - tracking->u);
        if (!(own > 0) || !(step < depth)) {
            /* What is left of the step is for the next piece. */
            tracking->u = own > 0 ? -el_expm1(depth - step) : tracking->u;
            pass(tracking, depth_of(bound, t - at));
            tracking->pieces.from = t;
            return false;
        }
        at += step / own;
        pass(tracking, colour_scale(bound, step / own));
        if (meet(tracking, at, bound, out))
            return true;
        tracking->u = draw(tracking);
    }
}

/* A point on a stretch of this length, more often near its begin if the medium there is dense: 1 - exp(-rate length);
 * below `thin` uniform. */
static const double thin = 0x1p-20;

static double sample_depth(double rate, double length, double u) {
    double whole = rate > 0 ? -el_expm1(-rate * length) : 0;
    return whole > thin ? math_min(-el_log(1 - u * whole) / rate, length) : u * length;
}

static double depth_pdf(double rate, double length, double depth) {
    double whole = rate > 0 ? -el_expm1(-rate * length) : 0;
    return whole > thin ? rate * el_exp(-rate * depth) / whole : 1 / length;
}

/* Emission is taken at one point of each piece. */
static bool track_with_emission(struct tracking *tracking, struct medium_track *out) {
    const struct medium_mix *mix = tracking->pieces.mix;
    double from = tracking->pieces.from, length = tracking->pieces.to - from;
    struct colour bound = extinction_by(mix, tracking->pieces.high), emission = {0, 0, 0};
    double depth = sample_depth(colour_get(bound, tracking->hero), length, draw(tracking));
    if (!(depth < INFINITY))
        return track_to(tracking, tracking->pieces.to, out);
    if (track_to(tracking, from + depth, out))
        return true;
    const struct medium_line *line = tracking->pieces.line;
    const struct vec3 p = vec3_add_scaled(line->origin, line->direction, from + depth);
    for (uint32_t i = 0; i < mix->count; i++) {
        const struct medium *medium = mix->media[i];
        if (colour_is_black(medium->emission))
            continue;
        struct colour own = medium_emission_at(medium, density_of(&tracking->pieces, i, from + depth), p, line->time);
        double weight = tracking->met ? glow_met_weight(tracking->met, medium, p, line->time) : 1;
        emission = colour_add_scaled(emission, own, weight);
    }
    struct colour pdf = colour_make(depth_pdf(bound.r, length, depth), depth_pdf(bound.g, length, depth),
                                    depth_pdf(bound.b, length, depth));
    out->emitted = colour_add(out->emitted, over_mean(tracking, emission, pdf));
    return track_to(tracking, tracking->pieces.to, out);
}

static bool has_emission(const struct pieces *pieces) {
    for (uint32_t i = 0; i < pieces->mix->count; i++)
        if (pieces->high[i] > 0 && !colour_is_black(pieces->mix->media[i]->emission))
            return true;
    return false;
}

void medium_mix_track(const struct medium_mix *mix, const struct medium_line *line, struct colour throughput,
                      struct medium_draw numbers, struct medium_track *out) {
    throughput = colour_abs(throughput); /* single wavelengths have negative components */
    double sum = throughput.r + throughput.g + throughput.b;
    struct tracking tracking;
    tracking.share = sum > 0 ? colour_scale(throughput, 1 / sum) : colour_all(1.0 / 3);
    tracking.odds = colour_all(1);
    tracking.key = numbers.key;
    tracking.drawn = 0;
    tracking.u = numbers.u.y;
    tracking.met = numbers.met;
    tracking.hero = numbers.u.x < tracking.share.r ? 0 : numbers.u.x < tracking.share.r + tracking.share.g ? 1 : 2;
    *out = (struct medium_track){.distance = line->distance};
    begin_pieces(&tracking.pieces, mix, line);
    while (next_piece(&tracking.pieces))
        if (has_emission(&tracking.pieces) ? track_with_emission(&tracking, out)
                                           : track_to(&tracking, tracking.pieces.to, out))
            return;
    out->weight = over_mean(&tracking, colour_all(1), colour_all(1));
}

/* By the middle of the bounds. */
double medium_mix_density(const struct medium_mix *mix, const struct medium_line *line, struct colour throughput) {
    struct pieces pieces;
    double sum = throughput.r + throughput.g + throughput.b, middle[MEDIUM_MIX_LIMIT];
    struct colour depth = {0, 0, 0}, here = {0, 0, 0};
    begin_pieces(&pieces, mix, line);
    while (next_piece(&pieces)) {
        for (uint32_t i = 0; i < mix->count; i++)
            middle[i] = (pieces.low[i] + pieces.high[i]) / 2;
        here = extinction_by(mix, middle);
        depth = colour_add(depth, depth_of(here, pieces.to - pieces.from));
    }
    return sum > 0 ? colour_dot(throughput, colour_mul(here, exponential(depth))) / sum : 0;
}

double medium_mix_haze(const struct medium_mix *mix) {
    struct fog_cells cells;
    double sum = 0;
    for (uint32_t i = 0; i < mix->count; i++) {
        const struct medium *medium = mix->media[i];
        const struct colour e = medium->extinction;
        if (!medium->density || !density_cells(medium->density, &cells))
            sum += (e.r + e.g + e.b) / 3;
    }
    return sum;
}

/* The lower bounds dim light exactly; what may be above them is tracked by the largest channel. */
struct colour medium_mix_left(const struct medium_mix *mix, const struct medium_line *line, uint64_t key) {
    struct pieces pieces;
    struct colour depth = {0, 0, 0}, left = {1, 1, 1};
    uint64_t drawn = 0;
    begin_pieces(&pieces, mix, line);
    while (next_piece(&pieces)) {
        double length = pieces.to - pieces.from, above[MEDIUM_MIX_LIMIT], at = pieces.from;
        struct colour low = extinction_by(mix, pieces.low);
        depth = colour_add(depth, depth_of(low, length));
        for (uint32_t i = 0; i < mix->count; i++)
            above[i] = pieces.high[i] - pieces.low[i];
        double rate = colour_max_abs(extinction_by(mix, above));
        while (rate > 0) {
            at -= el_log(1 - random_unit(random_combine(key, drawn++))) / rate;
            if (!(at < pieces.to))
                break;
            for (uint32_t i = 0; i < mix->count; i++)
                above[i] = density_of(&pieces, i, at) - pieces.low[i];
            left = colour_mul(left, colour_sub(colour_all(1), colour_scale(extinction_by(mix, above), 1 / rate)));
        }
        /* Little light: one in four stands for four. */
        if (colour_max_abs(colour_mul(left, exponential(depth))) < 1e-3) {
            if (random_unit(random_combine(key, drawn++)) >= 0.25)
                return colour_all(0);
            left = colour_scale(left, 4);
        }
    }
    return colour_mul(left, exponential(depth));
}

struct colour medium_mix_dimmed(const struct medium_mix *mix, const struct medium_line *line) {
    struct colour depth = {0, 0, 0};
    for (uint32_t i = 0; i < mix->count; i++) {
        const struct density *density = mix->media[i]->density;
        const struct medium_line local = medium_placement_line(mix->media[i]->placement, line);
        depth = colour_add(
            depth, depth_of(mix->media[i]->extinction, density ? density_depth(density, &local) : line->distance));
    }
    return exponential(depth);
}

struct colour medium_ray_left(enum medium_ray kind, const struct ray *ray, double distance, uint64_t key) {
    struct medium_mix mix;
    struct medium_effect effect;
    if (medium_affects(kind, ray) && medium_stack_current(ray->media)->mixed) {
        medium_stack_mix(ray->media, &mix);
        if (!(mix.count == 1 && mix.media[0]->fog)) {
            const struct medium_line line = {ray->origin, vec3_normalize(ray->direction), distance, ray->time};
            return medium_mix_left(&mix, &line, key);
        }
    }
    (void)medium_transmittance(kind, ray, distance, &effect);
    return effect.transmittance;
}
