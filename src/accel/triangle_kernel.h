/* The search, compiled once per instruction set: a file defines KERNEL(name) and includes this one.
 *
 * Single precision proposes, doubles decide. A ray is taken into local space in double precision, moved to where it
 * enters the frame (so its origin is at most 1 + VOXEL_MARGIN in size) and rounded; its direction's largest component
 * is 1/2 to 1. Hits are then looked for with every comparison slack by more than all rounding can do, and what is found
 * is tried again with the test of triangle.h on the original ray and vertices. So the answer is the same bits as trying
 * every triangle, whatever the instruction set.
 *
 * How far rounding reaches, in units of e = 2^-24 (unit roundoff), with |o| <= 1, |d| <= 1, s = o - corner, S = |s| and
 * L the largest component of the two edges; D bounds what the double arithmetic of either side may move the line, about
 * 2^-46 times the distance of the origin:
 *   s           2.5 e + D, and S e from the subtraction
 *   p = d x e2  7 e L                          (|p| <= 2 L)
 *   u = s p     (15 + 45 S) e L + 6 L D; v = d q the same
 *   det = e1 p  45 e L^2
 *   T = e2 q    (15 + 48 S) e L^2 + 6 L^2 D, and 45 e L^2 t from comparing it with t det, where t <= 2 (S + 2 L)
 * A sign of det that is wrong means |det| <= 45 e L^2. So with W = (15 + 140 S + 180 L) e + 8 D and E = W L a true hit
 * always has u, v >= -E, u + v <= |det| + 3 E and T within E L, and what passes with these turned round is certainly a
 * hit. S counts, not its bound: a ray that starts on a surface would else find its own triangle doubtful too often.
 *
 * A certain hit ends an "any" search at once. A "nearest" search decides what is proposed at once, too: since near
 * boxes come first, there is hardly more than one proposal for every ray that hits. */

#include "accel/simd.h"
#include "accel/triangle_kernels.h"
#include "accel/triangle_layout.h"

#include <string.h>

enum { STACK_ENTRIES = 256 };

/* In local units. Up to here BOX_GROWTH covers what the distance adds to the rounding. */
#define FAR_AWAY 0x1p20

struct search {
    const struct triangle_index *index;
    const struct triangle_set *set;
    const struct ray *ray;
    enum triangle_search kind;
    simd8 ox, oy, oz, dx, dy, dz;
    simd8 rx, ry, rz;             /* 1 / direction */
    simd8 mx, my, mz;             /* origin / direction: a plane is met at plane * r - m */
    simd8 wx, wy, wz;             /* for rays from far away: how much the boxes' growth falls short, in local t */
    uint32_t row_x, row_y, row_z; /* where the near row of a node starts, in floats; the far one is at row ^ WIDTH */
    float error;                  /* 15 e + 8 D */
    float limit;                  /* local t beyond which nothing matters */
    float certain;                /* local t below which the ray's own interval surely has not ended */
    bool found, sheared_ready, far_away;
    double t_to_local, t_offset; /* local t = t * t_to_local - t_offset */
    double best;                 /* as decided */
    struct triangle_hit *hit;
    triangle_visit *visit;
    void *context;
    uint32_t blocks, nodes, voxels;
    struct triangle_ray sheared;
};

/* triangle_ray_set with one division for all three. */
static inline void sheared_set(struct triangle_ray *out, const struct ray *ray) {
    const double d[3] = {ray->direction.x, ray->direction.y, ray->direction.z};
    int z = fabs(d[1]) > fabs(d[0]);
    z = fabs(d[2]) > fabs(d[z]) ? 2 : z;
    triangle_ray_axes(out, d, z);
    wide4_store(&out->shear_x, wide4_div(wide4_make(d[out->x], d[out->y], 1, 0), wide4_all(d[z])));
    out->origin[0] = ray->origin.x;
    out->origin[1] = ray->origin.y;
    out->origin[2] = ray->origin.z;
}

/* triangle_cross, its three edge functions at a time and with the same bits; what is near zero is left to it. */
static inline bool cross(const struct triangle_ray *ray, const double a[3], const double b[3], const double c[3],
                         struct triangle_hit *hit) {
    int x = ray->x, y = ray->y, z = ray->z;
    wide4 pz = wide4_sub(wide4_make(a[z], b[z], c[z], c[z]), wide4_all(ray->origin[z]));
    wide4 px = wide4_sub(wide4_make(a[x], b[x], c[x], c[x]), wide4_all(ray->origin[x]));
    wide4 py = wide4_sub(wide4_make(a[y], b[y], c[y], c[y]), wide4_all(ray->origin[y]));
    px = wide4_sub(px, wide4_mul(wide4_all(ray->shear_x), pz));
    py = wide4_sub(py, wide4_mul(wide4_all(ray->shear_y), pz));
    wide4 p = wide4_mul(wide4_cab(px), wide4_bca(py)), q = wide4_mul(wide4_cab(py), wide4_bca(px));
    wide4 e = wide4_sub(p, q);
    wide4 doubt = wide4_mul(wide4_all(0x1p-49), wide4_add(wide4_size(p), wide4_size(q)));
    if (__builtin_expect((wide4_below(doubt, wide4_size(e)) & 7) != 7, 0))
        return triangle_cross(ray, a, b, c, hit);
    unsigned negative = wide4_negative(e) & 7;
    if (negative != 0 && negative != 7)
        return false;
    double sum = wide4_sum_of_three(e);
    wide4 found = wide4_div(wide4_with_first(e, wide4_sum_of_three(wide4_mul(e, pz))), wide4_all(sum));
    hit->t = wide4_lane(found, 0) * ray->scale_z;
    hit->u = wide4_lane(found, 1);
    hit->v = wide4_lane(found, 2);
    hit->enter = negative == 0;
    return true;
}

/* The answer for one proposed triangle. True when an "any" search is over. */
static inline bool decide(struct search *s, const struct triangle_block *block, unsigned lane) {
    const double(*vertices)[3] = s->set->vertices;
    struct triangle_hit h;
    if (!cross(&s->sheared, vertices[block->vertices[0][lane]], vertices[block->vertices[1][lane]],
               vertices[block->vertices[2][lane]], &h))
        return false;
    h.triangle = block->ids[lane];
    if (s->kind == TRIANGLE_ALL) {
        s->visit(s->context, &h);
        return false;
    }
    if (!(h.t > s->ray->t_min) || !(h.t <= s->best))
        return false;
    if (h.t == s->best && !(s->found && h.triangle < s->hit->triangle))
        return false;
    s->found = true;
    if (s->kind == TRIANGLE_ANY)
        return true;
    s->best = h.t;
    *s->hit = h;
    float local = (float)(h.t * s->t_to_local - s->t_offset) * (1 + 0x1p-20f) + 0x1p-20f;
    if (local < s->limit)
        s->limit = local;
    return false;
}

/* Decides a block's proposals. True when an "any" search is over. */
static __attribute__((noinline)) bool decide_lanes(struct search *s, const struct triangle_block *block,
                                                   unsigned lanes) {
    if (!s->sheared_ready) {
        sheared_set(&s->sheared, s->ray); /* search_begin has seen that the ray is good */
        s->sheared_ready = true;
    }
    do {
        if (decide(s, block, (unsigned)__builtin_ctz(lanes)))
            return true;
        lanes &= lanes - 1;
    } while (lanes);
    return false;
}

static inline __attribute__((always_inline)) bool try_block(struct search *s, uint32_t number, const bool any) {
    const struct triangle_block *b = s->index->blocks + number;
    simd8 e1x = simd8_load(b->edge1[0]), e1y = simd8_load(b->edge1[1]), e1z = simd8_load(b->edge1[2]);
    simd8 e2x = simd8_load(b->edge2[0]), e2y = simd8_load(b->edge2[1]), e2z = simd8_load(b->edge2[2]);
    simd8 px = simd8_multiply_sub(s->dy, e2z, simd8_mul(s->dz, e2y));
    simd8 py = simd8_multiply_sub(s->dz, e2x, simd8_mul(s->dx, e2z));
    simd8 pz = simd8_multiply_sub(s->dx, e2y, simd8_mul(s->dy, e2x));
    simd8 det = simd8_multiply_add(e1x, px, simd8_multiply_add(e1y, py, simd8_mul(e1z, pz)));
    simd8 sx = simd8_sub(s->ox, simd8_load(b->corner[0]));
    simd8 sy = simd8_sub(s->oy, simd8_load(b->corner[1]));
    simd8 sz = simd8_sub(s->oz, simd8_load(b->corner[2]));
    simd8 qx = simd8_multiply_sub(sy, e1z, simd8_mul(sz, e1y));
    simd8 qy = simd8_multiply_sub(sz, e1x, simd8_mul(sx, e1z));
    simd8 qz = simd8_multiply_sub(sx, e1y, simd8_mul(sy, e1x));
    simd8 u = simd8_multiply_add(sx, px, simd8_multiply_add(sy, py, simd8_mul(sz, pz)));
    simd8 v = simd8_multiply_add(s->dx, qx, simd8_multiply_add(s->dy, qy, simd8_mul(s->dz, qz)));
    simd8 t = simd8_multiply_add(e2x, qx, simd8_multiply_add(e2y, qy, simd8_mul(e2z, qz)));
    simd8 sign = simd8_sign(det);
    det = simd8_flip(det, sign);
    u = simd8_flip(u, sign);
    v = simd8_flip(v, sign);
    t = simd8_flip(t, sign);
    simd8 reach = simd8_max(simd8_max(simd8_size(e1x), simd8_size(e1y)), simd8_max(simd8_size(e1z), simd8_size(e2x)));
    reach = simd8_max(reach, simd8_max(simd8_size(e2y), simd8_size(e2z)));
    reach = simd8_max(reach, simd8_all(0x1p-40f)); /* no slack at all would make points certain hits */
    simd8 distance = simd8_max(simd8_size(sx), simd8_max(simd8_size(sy), simd8_size(sz)));
    simd8 w = simd8_multiply_add(reach, simd8_all(180 * 0x1p-24f), simd8_all(s->error));
    simd8 e = simd8_mul(simd8_multiply_add(distance, simd8_all(140 * 0x1p-24f), w), reach);
    simd8 e3 = simd8_mul(e, simd8_all(3)), slack = simd8_mul(e, reach);
    simd8 a = simd8_add(simd8_min(u, v), e);
    simd8 c = simd8_sub(simd8_add(det, e3), simd8_add(u, v));
    simd8 f = simd8_add(t, slack);
    simd8 g = simd8_sub(simd8_multiply_add(det, simd8_all(s->limit), slack), t);
    unsigned lanes = simd8_not_negative(simd8_min(simd8_min(a, c), simd8_min(f, g)));
    if (__builtin_expect(!lanes, 1))
        return false;
    if (any) {
        a = simd8_sub(simd8_min(u, v), e);
        c = simd8_sub(simd8_sub(det, e3), simd8_add(u, v));
        f = simd8_sub(t, slack);
        g = simd8_sub(simd8_multiply_sub(det, simd8_all(s->certain), slack), t);
        if (lanes & simd8_not_negative(simd8_min(simd8_min(a, c), simd8_min(f, g))))
            return true;
    }
    return decide_lanes(s, b, lanes);
}

static inline uint64_t stack_entry(float t, uint32_t reference) {
    uint32_t bits;
    memcpy(&bits, &t, sizeof bits);
    return (uint64_t)bits << 32 | reference;
}

static inline float stack_t(uint64_t entry) {
    uint32_t bits = (uint32_t)(entry >> 32);
    float t;
    memcpy(&t, &bits, sizeof t);
    return t;
}

/* One hierarchy. True when an "any" search is over. */
static inline __attribute__((always_inline)) bool descend(struct search *s, uint32_t reference,
                                                          const enum triangle_search kind, const bool far_away) {
    uint64_t stack[STACK_ENTRIES]; /* t, whose bits order as it does (it is not negative), then the reference */
    uint32_t top = 0;
    bool found = false;
    const struct wide_node *nodes = s->index->nodes;
    const simd8 rx = s->rx, ry = s->ry, rz = s->rz, mx = s->mx, my = s->my, mz = s->mz;
    uint32_t visited = 0, tried = 0;
    const size_t near_x = s->row_x, near_y = s->row_y, near_z = s->row_z;
    const size_t far_x = near_x ^ WIDTH, far_y = near_y ^ WIDTH, far_z = near_z ^ WIDTH;
    for (;;) {
        while (!(reference & REF_LEAF)) {
            const struct wide_node *n = nodes + reference;
            const float *bounds = n->bounds[0];
            visited++;
            simd8 ax = simd8_multiply_sub(simd8_load(bounds + near_x), rx, mx);
            simd8 ay = simd8_multiply_sub(simd8_load(bounds + near_y), ry, my);
            simd8 az = simd8_multiply_sub(simd8_load(bounds + near_z), rz, mz);
            simd8 bx = simd8_multiply_sub(simd8_load(bounds + far_x), rx, mx);
            simd8 by = simd8_multiply_sub(simd8_load(bounds + far_y), ry, my);
            simd8 bz = simd8_multiply_sub(simd8_load(bounds + far_z), rz, mz);
            if (far_away) {
                ax = simd8_sub(ax, s->wx);
                ay = simd8_sub(ay, s->wy);
                az = simd8_sub(az, s->wz);
                bx = simd8_add(bx, s->wx);
                by = simd8_add(by, s->wy);
                bz = simd8_add(bz, s->wz);
            }
            simd8 enter = simd8_max(simd8_max(ax, ay), simd8_max(az, simd8_all(0)));
            simd8 leave = simd8_min(simd8_min(bx, by), simd8_min(bz, simd8_all(s->limit)));
            unsigned lanes = simd8_at_most(enter, leave);
            if (!lanes)
                goto pop;
            unsigned i = (unsigned)__builtin_ctz(lanes);
            lanes &= lanes - 1;
            if (!lanes) {
                reference = n->child[i];
                continue;
            }
            if (kind != TRIANGLE_NEAREST) { /* which child comes first matters less than sorting costs */
                reference = n->child[i];
                do {
                    stack[top++] = n->child[__builtin_ctz(lanes)];
                    lanes &= lanes - 1;
                } while (lanes);
                continue;
            }
            _Alignas(32) float t[WIDTH];
            simd8_store(t, enter);
            unsigned j = (unsigned)__builtin_ctz(lanes);
            lanes &= lanes - 1;
            uint64_t first = stack_entry(t[i], n->child[i]), second = stack_entry(t[j], n->child[j]);
            if (!lanes) {
                reference = (uint32_t)(first < second ? first : second);
                stack[top++] = first < second ? second : first;
                continue;
            }
            uint32_t base = top; /* three or more: by insertion, the farthest at the bottom */
            stack[top++] = first < second ? second : first;
            stack[top++] = first < second ? first : second;
            do {
                unsigned k = (unsigned)__builtin_ctz(lanes);
                lanes &= lanes - 1;
                uint64_t entry = stack_entry(t[k], n->child[k]);
                uint32_t place = top++;
                for (; place > base && stack[place - 1] < entry; place--)
                    stack[place] = stack[place - 1];
                stack[place] = entry;
            } while (lanes);
            reference = (uint32_t)stack[--top];
        }
        tried++;
        if (try_block(s, reference & ~REF_LEAF, kind == TRIANGLE_ANY)) {
            found = true;
            break;
        }
    pop:
        do {
            if (!top)
                goto done;
            top--;
        } while (kind == TRIANGLE_NEAREST && stack_t(stack[top]) > s->limit);
        reference = (uint32_t)stack[top];
    }
done:
    s->nodes += visited;
    s->blocks += tried;
    return found;
}

static inline __attribute__((always_inline)) bool walk(struct search *s, simd4 origin, simd4 reciprocal,
                                                       const enum triangle_search kind, const bool far_away) {
    const struct triangle_index *index = s->index;
    if (index->big && descend(s, index->big, kind, far_away))
        return true;
    if (index->voxel_count == 27) { /* one voxel: nothing to walk */
        uint32_t only = index->voxels[13];
        return only != REF_EMPTY && descend(s, only, kind, far_away);
    }
    simd4 cell = simd4_load(index->cell),
          place = simd4_mul(simd4_add(origin, simd4_load(index->half_single)), simd4_load(index->inverse_cell));
    int32_t at[4];
    simd4 start = simd4_max(simd4_all(0), simd4_min(place, simd4_load(index->last_cell)));
    simd4_store_int(at, start);
    start = simd4_whole(start);
    simd4 across = simd4_mul(cell, reciprocal);
    simd4 next_t = simd4_mul(simd4_sub(simd4_add(start, simd4_one_unless_negative(reciprocal)), place), across);
    simd4 step_t = simd4_size(across);
    next_t = simd4_add(next_t, simd4_make(0, 0, 0, INFINITY));
    const int32_t *offset = index->offset[simd4_negative(reciprocal) & 7];
    const uint32_t *voxel = index->voxels + 1 + index->stride[0] + index->stride[1] + (uint32_t)at[0] +
                            (uint32_t)at[1] * index->stride[0] + (uint32_t)at[2] * index->stride[1];
    for (;;) {
        uint32_t reference = *voxel;
        simd4 leave = simd4_min_of_three(next_t);
        if (reference != REF_EMPTY) {
            if (reference == REF_OUTSIDE)
                return false;
            s->voxels++;
            if (descend(s, reference, kind, far_away))
                return true;
        }
        if (s->limit <= simd4_first(leave))
            return false;
        unsigned lanes;
        next_t = simd4_add_where_reached(next_t, leave, step_t, &lanes);
        voxel += offset[lanes & 7];
    }
}

static inline double power_of_two(uint64_t exponent_bits) {
    double x;
    exponent_bits <<= 52;
    memcpy(&x, &exponent_bits, sizeof x);
    return x;
}

/* False: the ray misses the frame. *usable is false for rays that are left to brute force: not finite, or so far away
 * that the slack would swallow the mesh. */
static inline bool search_begin(struct search *s, simd4 *origin, simd4 *reciprocal, bool *usable) {
    const struct triangle_index *index = s->index;
    const struct ray *ray = s->ray;
    wide4 scale = wide4_all(index->scale);
    /* Number by number: the caller has just stored them, and a wider load would have to wait for the stores. */
    wide4 o = wide4_make(ray->origin.x, ray->origin.y, ray->origin.z, 0);
    wide4 d = wide4_mul(wide4_make(ray->direction.x, ray->direction.y, ray->direction.z, 0), scale);
    o = wide4_mul(wide4_sub(o, wide4_load(index->centre)), scale);
    /* A zero becomes so small that no way along it counts. */
    wide4 d_size = wide4_size(d), r = wide4_div(wide4_all(1), wide4_signed(wide4_max(d_size, wide4_all(0x1p-980)), d));
    wide4 half = wide4_load(index->half), o_size = wide4_with_last(wide4_size(o), 1);
    wide4 a = wide4_mul(wide4_sub(wide4_sub(wide4_all(0), half), o), r), b = wide4_mul(wide4_sub(half, o), r);
    double enter = wide4_largest(wide4_with_last(wide4_min(a, b), ray->t_min));
    double leave = wide4_smallest(wide4_with_last(wide4_max(a, b), ray->t_max));
    double largest = wide4_largest(d_size), far = wide4_largest(o_size);
    *usable =
        wide4_all_below(o_size, wide4_all(0x1p30)) && wide4_all_below(d_size, wide4_all(0x1p900)) && largest > 0x1p-900;
    if (!*usable || !(enter <= leave))
        return false;
    /* The local direction's largest component becomes at least 1/2 and less than 1, by a power of two. */
    uint64_t exponent;
    memcpy(&exponent, &largest, sizeof exponent);
    exponent >>= 52;
    double to_local = power_of_two(exponent + 1), shrink = power_of_two(2045 - exponent);
    simd4 o4 = wide4_to_single(wide4_add(o, wide4_mul(d, wide4_all(enter))));
    simd4 d4 = wide4_to_single(wide4_mul(d, wide4_all(shrink)));
    r = wide4_mul(r, wide4_all(to_local));
    r = wide4_signed(wide4_min(wide4_size(r), wide4_all(0x1p60)), r);
    simd4 r4 = wide4_to_single(r);
    simd4 m4 = simd4_mul(o4, r4);
    s->ox = simd8_lane(o4, 0);
    s->oy = simd8_lane(o4, 1);
    s->oz = simd8_lane(o4, 2);
    s->dx = simd8_lane(d4, 0);
    s->dy = simd8_lane(d4, 1);
    s->dz = simd8_lane(d4, 2);
    s->rx = simd8_lane(r4, 0);
    s->ry = simd8_lane(r4, 1);
    s->rz = simd8_lane(r4, 2);
    s->mx = simd8_lane(m4, 0);
    s->my = simd8_lane(m4, 1);
    s->mz = simd8_lane(m4, 2);
    unsigned negative = simd4_negative(r4);
    s->row_x = (negative & 1) * WIDTH;
    s->row_y = (2 + (negative >> 1 & 1)) * WIDTH;
    s->row_z = (4 + (negative >> 2 & 1)) * WIDTH;
    s->t_to_local = to_local;
    s->t_offset = enter * to_local;
    s->limit = (float)((leave - enter) * to_local) * (1 + 0x1p-20f) + 0x1p-20f;
    double certain = (ray->t_max - enter) * to_local * (1 - 0x1p-20) - 0x1p-20;
    s->certain = certain < 16 ? (float)certain : 16;
    s->error = 16 * 0x1p-24f + (float)(far * 8 * 0x1p-46);
    s->far_away = far > FAR_AWAY;
    if (s->far_away || s->kind == TRIANGLE_ALL) { /* which is compiled for far rays only */
        simd4 w4 = simd4_mul(simd4_size(r4), simd4_all((float)(far * 0x1p-45)));
        s->wx = simd8_lane(w4, 0);
        s->wy = simd8_lane(w4, 1);
        s->wz = simd8_lane(w4, 2);
    }
    s->found = s->sheared_ready = false;
    s->best = ray->t_max;
    s->blocks = s->nodes = s->voxels = 0;
    *origin = o4;
    *reciprocal = r4;
    return true;
}

static inline void add_cost(const struct search *s, struct triangle_cost *cost) {
    cost->triangle_tests += (uint64_t)s->blocks * WIDTH;
    cost->hierarchy_steps += s->nodes;
    cost->voxels += s->voxels;
}

bool KERNEL(nearest)(const struct triangle_index *index, const struct triangle_set *set, const struct ray *ray,
                     struct triangle_hit *hit, struct triangle_cost *cost) {
    struct search s;
    simd4 origin, reciprocal;
    bool usable;
    s.index = index;
    s.set = set;
    s.ray = ray;
    s.kind = TRIANGLE_NEAREST;
    s.hit = hit;
    if (!search_begin(&s, &origin, &reciprocal, &usable))
        return usable ? false : triangle_brute_nearest(set, ray, hit, cost);
    if (s.far_away)
        walk(&s, origin, reciprocal, TRIANGLE_NEAREST, true);
    else
        walk(&s, origin, reciprocal, TRIANGLE_NEAREST, false);
    add_cost(&s, cost);
    return s.found;
}

bool KERNEL(any)(const struct triangle_index *index, const struct triangle_set *set, const struct ray *ray,
                 struct triangle_cost *cost) {
    struct search s;
    simd4 origin, reciprocal;
    bool usable;
    s.index = index;
    s.set = set;
    s.ray = ray;
    s.kind = TRIANGLE_ANY;
    if (!search_begin(&s, &origin, &reciprocal, &usable))
        return usable ? false : triangle_brute_any(set, ray, cost);
    bool found = s.far_away ? walk(&s, origin, reciprocal, TRIANGLE_ANY, true)
                            : walk(&s, origin, reciprocal, TRIANGLE_ANY, false);
    add_cost(&s, cost);
    return found;
}

void KERNEL(all)(const struct triangle_index *index, const struct triangle_set *set, const struct ray *ray,
                 triangle_visit *visit, void *context, struct triangle_cost *cost) {
    struct search s;
    simd4 origin, reciprocal;
    bool usable;
    struct ray line = *ray;
    line.t_min = -INFINITY;
    line.t_max = INFINITY;
    s.index = index;
    s.set = set;
    s.ray = &line;
    s.kind = TRIANGLE_ALL;
    s.visit = visit;
    s.context = context;
    if (search_begin(&s, &origin, &reciprocal, &usable)) {
        walk(&s, origin, reciprocal, TRIANGLE_ALL, true);
        add_cost(&s, cost);
    } else if (!usable)
        triangle_brute_all(set, &line, visit, context, cost);
}
