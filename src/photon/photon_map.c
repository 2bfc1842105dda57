/* Every photon lights a disc of its own radius, with Epanechnikov's filter: 2 / (pi r^2) (1 - d^2 / r^2), whose
 * integral over the surface is 1, so light is conserved for any radii. By default the radius follows the density (a
 * sample-point estimator: Breiman, Meisel, Purcell, "Variable Kernel Estimates of Multivariate Densities",
 * Technometrics 1977): the distance of the PILOT-th neighbour times STRETCH, so about 50 photons light any point, fine
 * lines stay fine, and sparse light is smooth. It is at most the 95th percentile: a stray photon does not light half
 * the scene.
 *
 * The tree halves the photons by the median along the longest side of their box; ranges follow from the number of a
 * node alone. Invariant: the photons under node k of level l are those from n k / 2^l to n (k + 1) / 2^l. Every
 * comparison falls back on the photon's number, so the tree is a function of the photons. */
#include "photon/photon_map.h"
#include "material/bsdf_select.h"
#include "math/elementary.h"

#include "base/mem.h"
#include "base/random.h"
#include "base/sort.h"
#include "math/portable.h"

#include <string.h>

enum { LEAF = 8, PILOT = 32, SUBTREE_LEVEL = 8, CHUNK = 1 << 14, LEVEL_LIMIT = 30 };

static const float stretch = 1.75F;

/* --- directions --- */

/* The octahedron unfolded to a square (Meyer, Suessmuth, Sussner, Stamminger, Greiner, "On Floating-Point Normal
 * Vectors", EGSR 2010). */
uint32_t photon_pack(struct vec3 d) {
    double sum = fabs(d.x) + fabs(d.y) + fabs(d.z), u = d.x / sum, v = d.y / sum;
    if (d.z < 0) {
        double turned = (1 - fabs(v)) * (u < 0 ? -1 : 1);
        v = (1 - fabs(u)) * (v < 0 ? -1 : 1);
        u = turned;
    }
    uint32_t i = (uint32_t)((u + 1) * 32767.5 + 0.5), j = (uint32_t)((v + 1) * 32767.5 + 0.5);
    return (i > 65535 ? 65535 : i) << 16 | (j > 65535 ? 65535 : j);
}

/* Not unit: of the octahedron. */
static struct vec3 unfold(uint32_t packed) {
    double u = (packed >> 16) / 32767.5 - 1, v = (packed & 65535) / 32767.5 - 1, z = 1 - fabs(u) - fabs(v);
    if (z < 0) {
        double turned = (1 - fabs(v)) * (u < 0 ? -1 : 1);
        v = (1 - fabs(u)) * (v < 0 ? -1 : 1);
        u = turned;
    }
    return vec3_make(u, v, z);
}

/* --- the order of the photons --- */

/* A photon while the tree is made: its number is stored in the field of the radius. */
struct entry {
    float at[3];
    uint32_t number;
};
_Static_assert(sizeof(struct entry) == sizeof(struct photon_spot), "entries become spots in place");

struct builder {
    struct photon_map *map;
    const struct photon *photons;
    uint32_t count;    /* of the photons, including those that did not land */
    uint32_t *firsts;  /* of each chunk: where its photons begin among those that landed */
    struct box *boxes; /* of each chunk */
    double *powers;    /* the largest of each chunk */
    struct entry *entries;
    struct pool *pool;
    uint32_t level;    /* that is made */
    float radius, max; /* of all photons, 0: by density; largest radius */
};

static uint32_t node_first(const struct photon_map *map, uint32_t level, uint32_t k) {
    return (uint32_t)((uint64_t)map->count * k >> level);
}

static uint32_t chunk_end(const struct builder *b, uint32_t chunk) {
    uint64_t end = ((uint64_t)chunk + 1) * CHUNK;
    return end < b->count ? (uint32_t)end : b->count;
}

static void measure_chunk(void *context, uint32_t chunk, int worker) {
    (void)worker;
    struct builder *b = context;
    uint32_t landed = 0;
    double max = 0;
    struct box box = box_empty();
    for (uint32_t i = chunk * CHUNK; i < chunk_end(b, chunk); i++) {
        const struct photon *photon = &b->photons[i];
        if (photon->light == PHOTON_NOWHERE)
            continue;
        double power = colour_max_abs(photon->power);
        max = power > max ? power : max;
        box = box_add_point(box, photon->position);
        landed++;
    }
    b->firsts[chunk] = landed;
    b->boxes[chunk] = box;
    b->powers[chunk] = max;
}

static void enter_chunk(void *context, uint32_t chunk, int worker) {
    (void)worker;
    struct builder *b = context;
    uint32_t next = b->firsts[chunk];
    for (uint32_t i = chunk * CHUNK; i < chunk_end(b, chunk); i++) {
        const struct photon *photon = &b->photons[i];
        if (photon->light == PHOTON_NOWHERE)
            continue;
        struct vec3 p = vec3_scale(vec3_sub(photon->position, b->map->origin), 1 / b->map->unit);
        b->entries[next++] = (struct entry){{(float)p.x, (float)p.y, (float)p.z}, i};
    }
}

static bool comes_before(const struct entry *a, const struct entry *b, int axis) {
    return a->at[axis] < b->at[axis] || (a->at[axis] == b->at[axis] && a->number < b->number);
}

static void swap_entries(struct entry *a, struct entry *b) {
    struct entry kept = *a;
    *a = *b;
    *b = kept;
}

/* Hoare's selection: the entries before `middle` come before the others along the axis. The pivot is drawn, so no order
 * of photons is a bad one. */
static void part_entries(struct entry *entries, uint32_t count, uint32_t middle, int axis, const struct pool *pool) {
    uint32_t low = 0, high = count, swaps = 0;
    while (high - low > 1 && !pool_cancelled(pool)) {
        struct entry pivot = entries[low + random_mix((uint64_t)high << 32 | low) % (high - low)];
        uint32_t i = low, j = high - 1;
        for (;;) {
            while (comes_before(&entries[i], &pivot, axis))
                i++;
            while (comes_before(&pivot, &entries[j], axis))
                j--;
            if (i >= j)
                break;
            swap_entries(&entries[i], &entries[j]);
            /* The pivot itself stays a sentinel on the side that it was moved to. */
            if (entries[i].number != pivot.number)
                i++;
            if (entries[j].number != pivot.number)
                j--;
            if ((++swaps & 0x7fff) == 0 && pool_cancelled(pool))
                return;
        }
        /* Here i = j is the place of the pivot. */
        if (i == middle)
            return;
        if (i < middle)
            low = i + 1;
        else
            high = i;
    }
}

static void split_node(struct builder *b, uint32_t level, uint32_t k) {
    uint32_t first = node_first(b->map, level, k), end = node_first(b->map, level, k + 1);
    uint32_t middle = node_first(b->map, level + 1, 2 * k + 1);
    float min[3] = {INFINITY, INFINITY, INFINITY}, max[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (uint32_t i = first; i < end; i++) {
        if (((i - first) & 0xffff) == 0xffff && pool_cancelled(b->pool))
            return;
        for (int axis = 0; axis < 3; axis++) {
            float x = b->entries[i].at[axis];
            min[axis] = x < min[axis] ? x : min[axis];
            max[axis] = x > max[axis] ? x : max[axis];
        }
    }
    int axis = 0;
    for (int i = 1; i < 3; i++)
        axis = max[i] - min[i] > max[axis] - min[axis] ? i : axis;
    part_entries(b->entries + first, end - first, middle - first, axis, b->pool);
}

static void split_level(void *context, uint32_t k, int worker) {
    (void)worker;
    struct builder *b = context;
    split_node(b, b->level, k);
}

/* All levels below node k of SUBTREE_LEVEL. */
static void split_subtree(void *context, uint32_t k, int worker) {
    (void)worker;
    struct builder *b = context;
    for (uint32_t level = SUBTREE_LEVEL; level < b->map->levels; level++) {
        uint32_t shift = level - SUBTREE_LEVEL;
        for (uint32_t i = k << shift; i < (k + 1) << shift && !pool_cancelled(b->pool); i++)
            split_node(b, level, i);
    }
}

static bool order_photons(struct builder *b) {
    for (b->level = 0; b->level < b->map->levels && b->level < SUBTREE_LEVEL; b->level++) {
        if (!pool_run(b->pool, (uint32_t)1 << b->level, split_level, b))
            return false;
    }
    return b->map->levels <= SUBTREE_LEVEL || pool_run(b->pool, (uint32_t)1 << SUBTREE_LEVEL, split_subtree, b);
}

static void fill_chunk(void *context, uint32_t chunk, int worker) {
    (void)worker;
    struct builder *b = context;
    uint64_t end = ((uint64_t)chunk + 1) * CHUNK;
    for (uint32_t i = chunk * CHUNK; i < end && i < b->map->count; i++) {
        const struct photon *photon = &b->photons[b->entries[i].number];
        struct colour power = colour_scale(photon->power, 1 / b->map->power_unit);
        b->map->lights[i] =
            (struct photon_light){{(float)power.r, (float)power.g, (float)power.b}, photon->from, photon->light};
        b->map->spots[i].radius = b->radius;
    }
}

/* --- boxes --- */

static void leaf_box(const struct photon_map *map, uint32_t k, struct photon_node *node) {
    *node = (struct photon_node){{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
    for (uint32_t i = node_first(map, map->levels, k); i < node_first(map, map->levels, k + 1); i++) {
        const struct photon_spot *spot = &map->spots[i];
        for (int axis = 0; axis < 3; axis++) {
            float low = spot->at[axis] - spot->radius, high = spot->at[axis] + spot->radius;
            node->min[axis] = low < node->min[axis] ? low : node->min[axis];
            node->max[axis] = high > node->max[axis] ? high : node->max[axis];
        }
    }
}

static void join_boxes(struct photon_node *out, const struct photon_node *a, const struct photon_node *b) {
    for (int axis = 0; axis < 3; axis++) {
        out->min[axis] = a->min[axis] < b->min[axis] ? a->min[axis] : b->min[axis];
        out->max[axis] = a->max[axis] > b->max[axis] ? a->max[axis] : b->max[axis];
    }
}

/* The subtree of node k of level min(levels, SUBTREE_LEVEL), from the leaves up. */
static void box_subtree(void *context, uint32_t k, int worker) {
    (void)worker;
    struct photon_map *map = ((struct builder *)context)->map;
    uint32_t top = map->levels < SUBTREE_LEVEL ? map->levels : SUBTREE_LEVEL, shift = map->levels - top;
    for (uint32_t i = k << shift; i < (k + 1) << shift; i++)
        leaf_box(map, i, &map->nodes[((uint32_t)1 << map->levels) + i]);
    for (uint32_t level = map->levels; level-- > top;) {
        shift = level - top;
        for (uint32_t i = k << shift; i < (k + 1) << shift; i++) {
            uint32_t node = ((uint32_t)1 << level) + i;
            join_boxes(&map->nodes[node], &map->nodes[2 * node], &map->nodes[2 * node + 1]);
        }
    }
}

/* With radii 0 the boxes hold the photons alone. */
static bool make_boxes(struct builder *b) {
    uint32_t top = b->map->levels < SUBTREE_LEVEL ? b->map->levels : SUBTREE_LEVEL;
    if (!pool_run(b->pool, (uint32_t)1 << top, box_subtree, b))
        return false;
    for (uint32_t node = (uint32_t)1 << top; node-- > 1;)
        join_boxes(&b->map->nodes[node], &b->map->nodes[2 * node], &b->map->nodes[2 * node + 1]);
    return true;
}

/* --- radii by density --- */

static float squared_to_box(const struct photon_node *node, const float at[3]) {
    float sum = 0;
    for (int axis = 0; axis < 3; axis++) {
        float low = node->min[axis] - at[axis], high = at[axis] - node->max[axis];
        float off = low > high ? low : high;
        sum += off > 0 ? off * off : 0;
    }
    return sum;
}

/* The smallest PILOT squared distances so far, the largest first (a heap). */
struct nearest {
    float squared[PILOT];
    uint32_t count;
    float bound; /* nothing farther counts */
};

static void nearest_add(struct nearest *n, float squared) {
    uint32_t at;
    if (n->count < PILOT) {
        for (at = n->count++; at > 0 && n->squared[(at - 1) / 2] < squared; at = (at - 1) / 2)
            n->squared[at] = n->squared[(at - 1) / 2];
    } else {
        for (at = 0; 2 * at + 1 < PILOT;) {
            uint32_t child = 2 * at + 1;
            child += child + 1 < PILOT && n->squared[child + 1] > n->squared[child];
            if (n->squared[child] <= squared)
                break;
            n->squared[at] = n->squared[child];
            at = child;
        }
    }
    n->squared[at] = squared;
    if (n->count == PILOT)
        n->bound = n->squared[0];
}

/* The squared distance of the PILOT-th photon, which is known to be at most `bound`. */
static float pilot_squared(const struct photon_map *map, const float at[3], float bound) {
    struct nearest n = {.bound = bound};
    struct {
        uint32_t node, level;
        float squared;
    } stack[LEVEL_LIMIT + 2];
    int pending = 0;
    stack[pending].node = 1;
    stack[pending].level = 0;
    stack[pending++].squared = 0;
    while (pending > 0) {
        uint32_t node = stack[--pending].node, level = stack[pending].level;
        if (stack[pending].squared > n.bound)
            continue;
        if (level == map->levels) {
            uint32_t k = node - ((uint32_t)1 << level), end = node_first(map, level, k + 1);
            for (uint32_t i = node_first(map, level, k); i < end; i++) {
                const float *other = map->spots[i].at;
                float dx = other[0] - at[0], dy = other[1] - at[1], dz = other[2] - at[2];
                float squared = dx * dx + dy * dy + dz * dz;
                if (n.count < PILOT ? squared <= n.bound : squared < n.bound)
                    nearest_add(&n, squared);
            }
            continue;
        }
        float left = squared_to_box(&map->nodes[2 * node], at), right = squared_to_box(&map->nodes[2 * node + 1], at);
        uint32_t near_one = left <= right ? 2 * node : 2 * node + 1;
        /* The nearer child is on top. */
        stack[pending].node = near_one ^ 1;
        stack[pending].level = level + 1;
        stack[pending++].squared = left <= right ? right : left;
        stack[pending].node = near_one;
        stack[pending].level = level + 1;
        stack[pending++].squared = left <= right ? left : right;
    }
    return n.bound;
}

/* Neighbours in the tree are neighbours in space: the last result, plus the distance, bounds the next one. A photon
 * that is much closer to the last searched one than that one's radius gets the same radius: its own is between half of
 * it and one and a half times it. */
static void find_radii(void *context, uint32_t chunk, int worker) {
    (void)worker;
    struct builder *b = context;
    struct photon_map *map = b->map;
    uint64_t end = ((uint64_t)chunk + 1) * (CHUNK / 16);
    const float *last_at = NULL;
    float last = 0;
    for (uint32_t i = chunk * (CHUNK / 16); i < end && i < map->count && !pool_cancelled(b->pool); i++) {
        const float *at = map->spots[i].at;
        float bound = INFINITY;
        /* Neighbours in the order of the map are near each other: the radius of the last one bounds that of this one.
         */
        if (last_at) {
            float dx = at[0] - last_at[0], dy = at[1] - last_at[1], dz = at[2] - last_at[2];
            float distance = sqrtf(dx * dx + dy * dy + dz * dz);
            if (distance <= last / 2) {
                map->spots[i].radius = stretch * last;
                continue;
            }
            bound = (last + distance) * 1.00001F;
            bound *= bound;
        }
        last = sqrtf(pilot_squared(map, at, bound));
        last_at = at;
        map->spots[i].radius = stretch * last;
    }
}

/* No radius is larger than `max`, none smaller than the grain of the coordinates. */
static const float grain = 0x1p-18F;

static void limit_chunk(void *context, uint32_t chunk, int worker) {
    (void)worker;
    struct builder *b = context;
    uint64_t end = ((uint64_t)chunk + 1) * CHUNK;
    for (uint32_t i = chunk * CHUNK; i < end && i < b->map->count; i++) {
        float *radius = &b->map->spots[i].radius;
        *radius = *radius > b->max ? b->max : *radius < grain ? grain : *radius;
    }
}

/* The largest radius that counts, from a few thousand of them. */
static void choose_max_radius(struct builder *b) {
    enum { SAMPLES = 4096 };
    uint64_t words[SAMPLES];
    struct photon_map *map = b->map;
    uint32_t samples = map->count < SAMPLES ? map->count : SAMPLES;
    for (uint32_t i = 0; i < samples; i++) {
        uint32_t bits; /* positive floats are in the order of their bits */
        memcpy(&bits, &map->spots[(uint64_t)map->count * i / samples].radius, sizeof bits);
        words[i] = bits;
    }
    sort_words(words, samples);
    uint32_t bits = (uint32_t)words[(uint64_t)samples * 95 / 100];
    memcpy(&b->max, &bits, sizeof bits);
    b->max = b->max > grain ? b->max : grain;
}

/* --- building --- */

/* The power of two that is next above; its reciprocal is finite, too. */
static double unit_of(double size) {
    int exponent;
    (void)math_frexp(size, &exponent);
    exponent = exponent < -1000 ? -1000 : exponent > 1000 ? 1000 : exponent;
    return size > 0 && isfinite(size) ? math_ldexp(1, exponent) : 1;
}

static bool measure(struct builder *b, uint32_t chunks) {
    struct photon_map *map = b->map;
    if (!pool_run(b->pool, chunks, measure_chunk, b))
        return false;
    struct box box = box_empty();
    double max = 0;
    for (uint32_t i = 0; i < chunks; i++) {
        uint32_t landed = b->firsts[i];
        b->firsts[i] = map->count;
        map->count += landed;
        box = box_join(box, b->boxes[i]);
        max = b->powers[i] > max ? b->powers[i] : max;
    }
    if (map->count == 0)
        return true;
    struct vec3 half = vec3_scale(vec3_sub(box.max, box.min), 0.5);
    map->origin = vec3_add(box.min, half);
    map->unit = unit_of(vec3_max_abs(half));
    map->power_unit = unit_of(max);
    while (map->count >> map->levels > LEAF)
        map->levels++;
    return true;
}

static bool make_tree(struct builder *b, uint32_t chunks, double radius, struct error *error) {
    struct photon_map *map = b->map;
    uint32_t landed_chunks = (map->count + CHUNK - 1) / CHUNK;
    map->spots = mem_alloc_aligned(64, (size_t)map->count * sizeof *map->spots);
    map->lights = mem_alloc_zero(map->count, sizeof *map->lights);
    map->nodes = mem_alloc_aligned(64, ((size_t)2 << map->levels) * sizeof *map->nodes);
    if (!map->spots || !map->lights || !map->nodes)
        return error_no_memory(error, "the photons of the caustics");
    b->entries = (struct entry *)(void *)map->spots;
    bool ok = pool_run(b->pool, chunks, enter_chunk, b) && order_photons(b);
    /* A radius that is given holds from here on; else 0 makes boxes of the photons alone. */
    b->radius = (float)(radius / map->unit);
    ok = ok && pool_run(b->pool, landed_chunks, fill_chunk, b) && make_boxes(b);
    if (ok && radius == 0) {
        ok = pool_run(b->pool, (map->count + CHUNK / 16 - 1) / (CHUNK / 16), find_radii, b);
        if (ok)
            choose_max_radius(b);
        ok = ok && pool_run(b->pool, landed_chunks, limit_chunk, b) && make_boxes(b);
    }
    return ok || error_set(error, ERROR_CANCELLED, "stopped while making the photon map");
}

bool photon_map_build(struct photon_map *map, const struct world *world, const struct photon_list *photons,
                      double radius, struct pool *pool, struct error *error) {
    uint32_t chunks = (uint32_t)(((uint64_t)photons->count + CHUNK - 1) / CHUNK);
    *map = (struct photon_map){.unit = 1, .power_unit = 1};
    for (uint32_t i = 0; i < world->light_count; i++)
        map->listed = map->listed || world->lights[i].lit;
    struct builder b = {.map = map, .photons = photons->items, .count = photons->count, .pool = pool};
    b.firsts = mem_alloc_zero(chunks, sizeof *b.firsts);
    b.boxes = mem_alloc_zero(chunks, sizeof *b.boxes);
    b.powers = mem_alloc_zero(chunks, sizeof *b.powers);
    bool ok = b.firsts && b.boxes && b.powers;
    if (!ok)
        ok = error_no_memory(error, "the photons of the caustics");
    else if (!measure(&b, chunks))
        ok = error_set(error, ERROR_CANCELLED, "stopped while making the photon map");
    else if (map->count > 0)
        ok = make_tree(&b, chunks, radius, error);
    mem_free(b.firsts);
    mem_free(b.boxes);
    mem_free(b.powers);
    return ok;
}

void photon_map_destroy(struct photon_map *map) {
    mem_free(map->spots);
    mem_free(map->lights);
    mem_free(map->nodes);
    *map = (struct photon_map){0};
}

/* --- gathering --- */

/* The query at one point. */
struct density_query {
    const struct photon_map *map;
    const struct world *world;
    const struct hit *hit;
    const struct bsdf *bsdf;
    uint32_t lobes; /* the classic ones that are not black */
    struct vec3 side;
    bool plain; /* Lambertian lobes alone, and the geometric normal is the normal */
    float at[3], up[3];
    struct colour sum;
};

/* Photons fall on the geometric surface, so each photon counts with its power divided by n.l of that surface; the lobes
 * contain their own cosine. At grazing light the quotient is bounded. */
static void add_photon(struct density_query *g, uint32_t i, double weight) {
    const struct photon_light *light = &g->map->lights[i];
    if (g->map->listed) {
        const uint8_t *lit = g->world->lights[light->light].lit;
        if (lit && !lit[g->hit->primitive])
            return;
    }
    struct vec3 from = unfold(light->from);
    double cosine = vec3_dot(from, g->side);
    if (!(cosine > 0))
        return;
    struct colour power = {(double)light->power[0] * weight, (double)light->power[1] * weight,
                           (double)light->power[2] * weight};
    if (!g->plain) {
        double scale = 1 / sqrt(vec3_dot(from, from));
        cosine *= scale;
        struct colour reflected = bsdf_classic(g->bsdf, g->lobes, g->hit->view, vec3_scale(from, scale));
        power = colour_scale(colour_mul(power, reflected), 1 / (cosine > 0.0625 ? cosine : 0.0625));
    }
    g->sum = colour_add(g->sum, power);
}

/* Distances off the tangent plane count four times: surfaces around a corner get less light. */
static void gather_leaf(struct density_query *g, uint32_t k) {
    const struct photon_map *map = g->map;
    uint32_t end = node_first(map, map->levels, k + 1);
    for (uint32_t i = node_first(map, map->levels, k); i < end; i++) {
        const struct photon_spot *spot = &map->spots[i];
        float dx = spot->at[0] - g->at[0], dy = spot->at[1] - g->at[1], dz = spot->at[2] - g->at[2];
        float height = dx * g->up[0] + dy * g->up[1] + dz * g->up[2];
        float squared = dx * dx + dy * dy + dz * dz + 15 * height * height,
              radius_squared = spot->radius * spot->radius;
        if (squared < radius_squared)
            add_photon(g, i, (double)((1 - squared / radius_squared) / radius_squared));
    }
}

static bool holds(const struct photon_node *node, const float at[3]) {
    return at[0] >= node->min[0] && at[0] <= node->max[0] && at[1] >= node->min[1] && at[1] <= node->max[1] &&
           at[2] >= node->min[2] && at[2] <= node->max[2];
}

static void gather(struct density_query *g) {
    const struct photon_map *map = g->map;
    uint32_t stack[LEVEL_LIMIT + 2], first_leaf = (uint32_t)1 << map->levels;
    int pending = 0;
    if (holds(&map->nodes[1], g->at))
        stack[pending++] = 1;
    while (pending > 0) {
        uint32_t node = stack[--pending];
        if (node >= first_leaf) {
            gather_leaf(g, node - first_leaf);
            continue;
        }
        for (uint32_t child = 2 * node + 2; child-- > 2 * node;) {
            if (holds(&map->nodes[child], g->at))
                stack[pending++] = child;
        }
    }
}

struct colour photon_map_light(const struct photon_map *map, const struct world *world, const struct hit *hit,
                               const struct bsdf *bsdf, uint32_t lobes) {
    struct density_query g = {.map = map, .world = world, .hit = hit, .bsdf = bsdf};
    struct vec3 normal = bsdf->lit;
    if (map->count == 0)
        return colour_all(0);
    bool turned = vec3_dot(normal, hit->normal) < 0;
    g.side = turned ? vec3_negate(hit->normal_geometric) : hit->normal_geometric;
    g.plain = normal.x == g.side.x && normal.y == g.side.y && normal.z == g.side.z;
    /* Only classic lobes; if all of them are Lambert's, one sum of power is enough. */
    bool lambert;
    g.lobes = lobes & bsdf_lobes_with(bsdf, BSDF_CLASSIC);
    struct colour albedo = bsdf_weight_of(bsdf, &g.lobes, &lambert);
    g.plain = g.plain && lambert;
    if (g.lobes == 0)
        return colour_all(0);
    /* In the units of the map, so that single precision suffices. */
    struct vec3 at = vec3_scale(vec3_sub(hit->point, map->origin), 1 / map->unit);
    g.at[0] = (float)at.x, g.at[1] = (float)at.y, g.at[2] = (float)at.z;
    g.up[0] = (float)g.side.x, g.up[1] = (float)g.side.y, g.up[2] = (float)g.side.z;
    gather(&g);
    if (g.plain)
        g.sum = colour_mul(g.sum, albedo);
    return colour_scale(g.sum, 2 * map->power_unit / (PI * map->unit * map->unit));
}
