/* Building: from the root down, each set of lights is split where the cost of the two halves is smallest, by the
 * surface area orientation heuristic of Conty Estevez and Kulla (section 4.4) over bins along each axis: power times
 * the area of the box times the solid angle of the cone of directions, larger for boxes that are thin along the split
 * axis. Sets whose centres agree, and those deeper than DEPTH_LIMIT, are halved in the order of the lights.
 *
 * Sampling: one random number serves the whole descent; after each choice it is rescaled to be uniform. The probability
 * of a light is the product from its leaf up. */
#include "light/light_sampler.h"

#include "base/error.h"
#include "base/mem.h"
#include "math/elementary.h"
#include "math/sampling.h"

static const double below_one = 1 - 0x1p-53;

enum { BINS = 12, DEPTH_LIMIT = 64 };

/* --- building --- */

struct building {
    struct light_tree_node *nodes;
    uint32_t node_count;
    /* By part: */
    struct light_bounds *bounds;
    struct light_part *parts;
    const uint32_t *first_part;
    uint32_t *leaf_of;
    uint32_t *items, *spare; /* numbers of the parts with a place; room to sort them */
    uint32_t bounded;
    const struct pool *pool;
    bool cancelled;
};

/* The solid angle of the directions in which a cone of normals shines, those near its rim by their cosine. */
static double cone_measure(const struct light_bounds *b) {
    double theta_o = el_acos(b->cos_theta_o), theta_e = el_acos(b->cos_theta_e), all = math_min(theta_o + theta_e, PI);
    double sin_o, cos_o;
    el_sincos(theta_o, &sin_o, &cos_o);
    double inside = 2 * PI * (1 - cos_o);
    double rim = PI / 2 * (2 * all * sin_o - el_cos(theta_o - 2 * all) - 2 * theta_o * sin_o + cos_o);
    return (inside + rim) * (b->two_sided ? 2 : 1);
}

/* A row of lamps has a box without surface: the square of its length keeps the measure above 0. */
static double box_measure(const struct box *box) {
    struct vec3 d = vec3_sub(box->max, box->min);
    return 2 * (d.x * d.y + d.y * d.z + d.z * d.x) + vec3_length_squared(d);
}

static double cost_of(const struct light_bounds *b) {
    return (b->steady + b->attenuation) * cone_measure(b) * box_measure(&b->box);
}

struct bin {
    struct light_bounds bounds;
    uint32_t count;
};

static void add_to_bin(struct bin *bin, const struct light_bounds *bounds) {
    bin->bounds = bin->count > 0 ? light_bounds_join(&bin->bounds, bounds) : *bounds;
    bin->count++;
}

static uint32_t bin_of(double x, double low, double high) {
    double bin = (x - low) / (high - low) * BINS;
    return bin > 0 ? (bin < BINS ? (uint32_t)bin : BINS - 1) : 0;
}

/* The costs of a split before bin k, k = 1 to BINS - 1, of what lies on one side. */
static void sweep_costs(const struct bin bins[BINS], bool from_below, double costs[BINS], uint32_t counts[BINS]) {
    struct bin all = {.count = 0};
    for (int i = 0; i + 1 < BINS; i++) {
        const struct bin *bin = &bins[from_below ? i : BINS - 1 - i];
        if (bin->count > 0) {
            all.bounds = all.count > 0 ? light_bounds_join(&all.bounds, &bin->bounds) : bin->bounds;
            all.count += bin->count;
        }
        int k = from_below ? i + 1 : BINS - 1 - i;
        costs[k] += all.count > 0 ? cost_of(&all.bounds) : 0;
        counts[k] = counts[k] < all.count ? counts[k] : all.count;
    }
}

struct split {
    int axis; /* -1: none */
    uint32_t bin;
    double low, high, cost;
};

static void try_axis(const struct building *b, uint32_t first, uint32_t count, int axis, const struct box *centres,
                     struct split *best) {
    double low = vec3_get(centres->min, axis), high = vec3_get(centres->max, axis);
    struct vec3 size = vec3_sub(centres->max, centres->min);
    if (!(high > low))
        return;
    struct bin bins[BINS] = {{.count = 0}};
    for (uint32_t i = first; i < first + count; i++) {
        const struct light_bounds *bounds = &b->bounds[b->items[i]];
        add_to_bin(&bins[bin_of(vec3_get(bounds->centre, axis), low, high)], bounds);
    }
    double costs[BINS] = {0}, thin = vec3_max_abs(size) / (high - low);
    uint32_t counts[BINS];
    for (int k = 0; k < BINS; k++)
        counts[k] = count;
    sweep_costs(bins, true, costs, counts);
    sweep_costs(bins, false, costs, counts);
    for (uint32_t k = 1; k < BINS; k++)
        if (counts[k] > 0 && costs[k] * thin < best->cost)
            *best = (struct split){axis, k, low, high, costs[k] * thin};
}

/* Puts the items of the lower half first, both halves in the order they had; returns how many they are. */
static uint32_t split_items(struct building *b, uint32_t first, uint32_t count, const struct split *split) {
    uint32_t lower = 0, upper = 0;
    for (uint32_t i = first; i < first + count; i++) {
        uint32_t item = b->items[i];
        if (bin_of(vec3_get(b->bounds[item].centre, split->axis), split->low, split->high) < split->bin)
            b->items[first + lower++] = item;
        else
            b->spare[upper++] = item;
    }
    for (uint32_t i = 0; i < upper; i++)
        b->items[first + lower + i] = b->spare[i];
    return lower;
}

/* Of more than one item. -1 as its axis: none. */
static struct split best_split(const struct building *b, uint32_t first, uint32_t count, int depth) {
    struct split best = {.axis = -1, .cost = INFINITY};
    struct box centres = box_empty();
    for (uint32_t i = first; i < first + count; i++)
        centres = box_add_point(centres, b->bounds[b->items[i]].centre);
    for (int axis = 0; axis < 3 && depth < DEPTH_LIMIT; axis++)
        try_axis(b, first, count, axis, &centres, &best);
    return best;
}

static uint32_t build_node(struct building *b, uint32_t first, uint32_t count, uint32_t parent, int depth) {
    uint32_t index = b->node_count++;
    struct light_tree_node *node = &b->nodes[index];
    node->parent = parent;
    if (count == 1) {
        uint32_t item = b->items[first];
        node->bounds = b->bounds[item];
        node->part = b->parts[item];
        b->leaf_of[item] = index;
        return index;
    }
    b->cancelled = b->cancelled || (b->pool && pool_cancelled(b->pool));
    struct split split = {.axis = -1};
    if (!b->cancelled)
        split = best_split(b, first, count, depth);
    uint32_t lower = split.axis < 0 ? count / 2 : split_items(b, first, count, &split);
    uint32_t one = build_node(b, first, lower, index, depth + 1);
    node->second = build_node(b, first + lower, count - lower, index, depth + 1);
    node->bounds = light_bounds_join(&b->nodes[one].bounds, &b->nodes[node->second].bounds);
    return index;
}

/* The items of the parts with a place; other lights that emit are listed. */
static void collect(struct building *b, const struct light *lights, uint32_t count, uint32_t *infinite,
                    uint32_t *infinite_count) {
    for (uint32_t i = 0; i < count; i++) {
        for (uint32_t k = b->first_part[i]; k < b->first_part[i + 1]; k++) {
            b->parts[k] = (struct light_part){i, k - b->first_part[i]};
            b->leaf_of[k] = LIGHT_NONE;
            switch (light_bounds_of(&lights[i], b->parts[k].triangle, &b->bounds[k])) {
            case LIGHT_EXTENT_NONE:
                break;
            case LIGHT_EXTENT_BOUNDED:
                b->items[b->bounded++] = k;
                break;
            case LIGHT_EXTENT_INFINITE:
                infinite[(*infinite_count)++] = i;
                b->leaf_of[k] = LIGHT_LEAF_INFINITE;
                break;
            }
        }
    }
}

/* Shares that do not depend on the point. An infinite light counts as the mean of the others. */
static bool build_shares(struct light_sampler *out, const struct building *b, uint32_t part_count,
                         struct arena *arena) {
    struct light_part *candidates = arena_alloc_array(arena, out->count, sizeof *candidates);
    double *until = arena_alloc_array(arena, out->count, sizeof *until), sum = 0, so_far = 0;
    double *share = arena_alloc_array(arena, part_count, sizeof *share);
    if (!candidates || !until || !share)
        return false;
    /* Lights with a place by their power. */
    bool by_power = out->choice == LIGHT_CHOICE_POWER;
    for (uint32_t i = 0; i < b->bounded; i++) {
        const struct light_bounds *bounds = &b->bounds[b->items[i]];
        candidates[i] = b->parts[b->items[i]];
        until[i] = by_power ? bounds->steady + bounds->attenuation : 1;
        sum += until[i];
    }
    /* Those without one count as the mean of the others. */
    double mean = b->bounded > 0 ? sum / b->bounded : 1;
    for (uint32_t i = b->bounded; i < out->count; i++) {
        candidates[i] = (struct light_part){out->infinite[i - b->bounded], 0};
        until[i] = mean;
        sum += mean;
    }
    /* Sums that end at exactly 1, whatever was rounded. */
    for (uint32_t i = 0; i < out->count; i++) {
        double begin = so_far;
        so_far = i + 1 < out->count ? math_min(so_far + until[i] / sum, 1) : 1;
        until[i] = so_far;
        share[out->first_part[candidates[i].light] + candidates[i].triangle] = so_far - begin;
    }
    out->candidates = candidates;
    out->until = until;
    out->share = share;
    return true;
}

/* Memory for the parts. first_part: by light, and one more. */
static bool building_begin(struct building *b, uint32_t part_count, struct arena *arena) {
    b->bounds = mem_alloc_zero((size_t)part_count + 1, sizeof *b->bounds);
    b->parts = mem_alloc_zero((size_t)part_count + 1, sizeof *b->parts);
    b->items = mem_alloc_zero((size_t)part_count + 1, sizeof *b->items);
    b->spare = mem_alloc_zero((size_t)part_count + 1, sizeof *b->spare);
    b->leaf_of = arena_alloc_array(arena, part_count, sizeof *b->leaf_of);
    return b->bounds && b->parts && b->items && b->spare && b->leaf_of;
}

static void building_end(struct building *b) {
    mem_free(b->bounds);
    mem_free(b->parts);
    mem_free(b->items);
    mem_free(b->spare);
}

static bool build_tree(struct light_sampler *out, struct building *b, struct arena *arena) {
    b->nodes = arena_alloc_array(arena, (size_t)b->bounded * 2, sizeof *b->nodes);
    if (!b->nodes)
        return false;
    if (b->bounded > 0)
        (void)build_node(b, 0, b->bounded, LIGHT_NONE, 0);
    out->nodes = b->nodes;
    out->node_count = b->node_count;
    return true;
}

static bool build(struct light_sampler *out, struct building *b, const struct light *lights, uint32_t light_count,
                  struct arena *arena) {
    uint32_t *infinite = arena_alloc_array(arena, light_count, sizeof *infinite);
    if (!infinite || !building_begin(b, b->first_part[light_count], arena))
        return false;
    collect(b, lights, light_count, infinite, &out->infinite_count);
    out->infinite = infinite;
    out->leaf_of = b->leaf_of;
    out->count = b->bounded + out->infinite_count;
    switch (out->choice) {
    case LIGHT_CHOICE_TREE:
        return build_tree(out, b, arena);
    case LIGHT_CHOICE_POWER:
    case LIGHT_CHOICE_UNIFORM:
        break;
    }
    return build_shares(out, b, b->first_part[light_count], arena);
}

bool light_sampler_build(struct light_sampler *out, struct light_sampler_options options, const struct light *lights,
                         uint32_t light_count, struct arena *arena, struct error *error) {
    *out = (struct light_sampler){.choice = options.choice};
    uint32_t *first_part = arena_alloc_array(arena, (size_t)light_count + 1, sizeof *first_part);
    uint64_t parts = 0;
    for (uint32_t i = 0; first_part && i < light_count && parts <= UINT32_MAX / 2; i++) {
        parts += light_part_count(&lights[i]);
        first_part[i + 1] = (uint32_t)parts;
    }
    if (parts > UINT32_MAX / 2)
        return error_set(error, ERROR_SCENE, "the scene has too many emitting triangles");
    out->first_part = first_part;
    struct building b = {.first_part = first_part, .pool = options.pool};
    bool ok = first_part && build(out, &b, lights, light_count, arena);
    building_end(&b);
    if (ok && b.cancelled)
        return error_set(error, ERROR_CANCELLED, "stopped while the lights of the scene were gathered");
    return ok || error_no_memory(error, "the lights of the scene");
}

/* --- sampling --- */

static double importance_at(const struct light_sampler *s, uint32_t node, struct vec3 point, struct vec3 normal) {
    return light_bounds_importance(&s->nodes[node].bounds, point, normal);
}

/* The probability of the tree relative to the infinite lights; 0 if all of it is dark. */
static double tree_share(const struct light_sampler *s, struct vec3 point, struct vec3 normal) {
    if (s->infinite_count == 0)
        return s->node_count > 0;
    bool lit = s->node_count > 0 && importance_at(s, 0, point, normal) > 0;
    return lit ? 1.0 / (1 + s->infinite_count) : 0;
}

static const struct light_part no_part = {LIGHT_NONE, 0};

static struct light_part sample_tree(const struct light_sampler *s, struct vec3 point, struct vec3 normal, double u,
                                     double *pmf) {
    uint32_t node = 0;
    while (s->nodes[node].second != 0) {
        uint32_t one = node + 1, other = s->nodes[node].second;
        double a = importance_at(s, one, point, normal), b = importance_at(s, other, point, normal);
        if (!(a + b > 0)) {
            *pmf = 0;
            return no_part;
        }
        double share = a / (a + b);
        bool first = u < share;
        node = first ? one : other;
        *pmf *= first ? share : b / (a + b);
        u = math_min(first ? u / share : (u - share) / (1 - share), below_one);
    }
    return s->nodes[node].part;
}

static double tree_pmf(const struct light_sampler *s, struct vec3 point, struct vec3 normal, uint32_t node) {
    double pmf = 1;
    for (uint32_t parent; (parent = s->nodes[node].parent) != LIGHT_NONE; node = parent) {
        uint32_t one = parent + 1, other = s->nodes[parent].second;
        double a = importance_at(s, one, point, normal), b = importance_at(s, other, point, normal);
        if (!(a + b > 0))
            return 0;
        pmf *= (node == one ? a : b) / (a + b);
    }
    return pmf;
}

static struct light_part sample_shares(const struct light_sampler *s, double u, double *pmf) {
    struct light_part part = s->candidates[sample_entry(s->until, s->count, u)];
    *pmf = s->share[s->first_part[part.light] + part.triangle];
    return part;
}

struct light_part light_sampler_sample(const struct light_sampler *s, struct vec3 point, struct vec3 normal, double u,
                                       double *pmf) {
    *pmf = 0;
    if (s->count == 0)
        return no_part;
    switch (s->choice) {
    case LIGHT_CHOICE_TREE:
        break;
    case LIGHT_CHOICE_POWER:
    case LIGHT_CHOICE_UNIFORM:
        return sample_shares(s, u, pmf);
    }
    if (s->infinite_count == 0 && s->node_count == 1) { /* as often the only light */
        *pmf = 1;
        return s->nodes[0].part;
    }
    double tree = tree_share(s, point, normal);
    if (tree == 0 && s->infinite_count == 0) /* no light can be chosen */
        return no_part;
    if (u < tree) {
        *pmf = tree;
        return sample_tree(s, point, normal, math_min(u / tree, below_one), pmf);
    }
    double position = (u - tree) / (1 - tree) * s->infinite_count;
    uint32_t number = position < s->infinite_count ? (uint32_t)position : s->infinite_count - 1;
    *pmf = (1 - tree) / s->infinite_count;
    return (struct light_part){s->infinite[number], 0};
}

double light_sampler_pmf(const struct light_sampler *s, struct vec3 point, struct vec3 normal, struct light_part part) {
    uint32_t number = s->first_part[part.light] + part.triangle, leaf = s->leaf_of[number];
    switch (s->choice) {
    case LIGHT_CHOICE_TREE:
        break;
    case LIGHT_CHOICE_POWER:
    case LIGHT_CHOICE_UNIFORM:
        return s->count > 0 ? s->share[number] : 0;
    }
    if (leaf == LIGHT_NONE)
        return 0;
    double tree = tree_share(s, point, normal);
    if (leaf == LIGHT_LEAF_INFINITE)
        return (1 - tree) / s->infinite_count;
    return tree * tree_pmf(s, point, normal, leaf);
}

void light_sampler_bundle(struct bundle *bundle, struct light_sampler *sampler, uint32_t light_count) {
    const uint32_t parts = sampler->first_part ? sampler->first_part[light_count] : 0;
    BUNDLE(bundle, sampler->infinite, sampler->infinite_count, NULL);
    BUNDLE(bundle, sampler->nodes, sampler->node_count, NULL);
    BUNDLE(bundle, sampler->leaf_of, parts, NULL);
    BUNDLE(bundle, sampler->candidates, sampler->count, NULL);
    BUNDLE(bundle, sampler->until, sampler->count, NULL);
    BUNDLE(bundle, sampler->share, parts, NULL);
    BUNDLE(bundle, sampler->first_part, light_count + 1, NULL);
}
