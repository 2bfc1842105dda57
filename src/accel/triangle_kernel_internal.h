/* The search, compiled once per instruction set: a file defines KERNEL(name) and includes this one.
 *
 * Single precision proposes, doubles decide. A ray is taken into local space in double precision and rounded. A ray
 * that starts farther than NEAR_BY from the middle is first moved to where it enters the frame (so its origin is at
 * most 1 + VOXEL_MARGIN in size), and its direction is scaled to about length one. Every comparison has a tolerance
 * larger than all rounding errors, and candidates are tested again with the test of triangle.h on the original ray and
 * vertices. So the result has the same bits as a test of every triangle, on any instruction set.
 *
 * A triangle is tested from t0 on the ray, where it enters the box of the triangle's block (0 in searches without this
 * value): rounding errors then depend on the distances near the triangle and not on the length of the ray, which for a
 * dense mesh in a wide scene is thousands of times more.
 *
 * How far rounding reaches, in units of e = 2^-24 (unit roundoff), with s = o + t0 d - corner, S = |s|, L the largest
 * component of the two edges, M the largest of the direction's, R = |o| + t0 M, which bounds the point of the ray at
 * t0, so that |corner| is at most R + S; D bounds what the double arithmetic of either side may move the line, about
 * 2^-46 times the distance of the origin:
 *
 * - s is off by (3 R + S) e + D (one R each for the origin and the direction, for their sum, and for the corner; one t0
 *   M more without fused operations), and by S e from the subtraction;
 * - p = d x e2 by 7 e L M, where |p| <= 2 L M;
 * - u = s p by ((18 R + 51 S) e + 6 D) L M, and v = d q, with q = s x e1, by the same;
 * - det = e1 p by 45 e L^2 M, so where its sign is wrong |det| is no more than that.
 *
 * So with W = (20 R + 146 S + 180 L) e + 8 D and E = W L M a true hit always has u, v >= -E and u + v <= |det| + 3 E. S
 * itself is used, not a bound: otherwise a ray that starts on a surface would too often find its own triangle
 * uncertain.
 *
 * For T = e2 q that is not enough: for large triangles, such as floors, S is large, too. But floors are mostly parallel
 * to the axes. With s_k, l_k and d_k for the components and p_k the product of the other two l, every product in T, and
 * so its error, is bounded by one of |s_k| p_k:
 *
 * - q by ((3 R + 5 |s_k|) e + D) l_j from each of its two products;
 * - T by the sum over k of ((6 R + 18 |s_k|) e + 2 D) p_k;
 * - (t - t0) det by the sum of 16 e |d_k| p_k (t - t0), where |d_k| (t - t0) <= |s_k| + l_k.
 *
 * So T is within F = sum of ((10 R + 36 |s_k| + 18 l_k) e + 4 D) p_k of (t - t0) det. A triangle that passes these
 * comparisons with E and F reversed is certainly a hit.
 *
 * A certain hit ends an "any" search at once. In a "nearest" search the nearest certain hit is kept, with bounds of its
 * t, until the search is over; hits that are not certain, or whose order is not, are decided at once. */

#include "accel/triangle_kernels_internal.h"
#include "accel/triangle_nodes_internal.h"
#include "accel/triangle_vectors_internal.h"

#include <stddef.h>
#include <string.h>

/* The distance from the middle of the mesh, in local units, up to which BOX_GROWTH covers the additional rounding. */
#define FAR_AWAY 0x1p20

/* W for each unit of |o| and of t0 M. */
#define POSITION_ERROR (20 * 0x1p-24f)
#if defined(LANES_FUSED)
#define MOVING_ERROR POSITION_ERROR
#else
#define MOVING_ERROR (26 * 0x1p-24f)
#endif

/* The minimum of L in the slack, local units, so that a degenerate triangle is never a certain hit. Edge functions of a
 * certain hit are so large that their products do not cancel: the products are below 4 (S + L)^2 and cancellation
 * begins at 2^-49 of them, but their difference is at least 95 (S + L) L e. (The error of the double arithmetic, 2^-48
 * (S + L) times the distance of the origin, is small: with 2 L^2 M >= |det| >= 5 E that distance is less than 2^19
 * L.) */
#define MIN_EXTENT 0x1p-24f

/* The vertices of this few triangles stay in the caches, and the index of this many does not. */
enum { FEW_TRIANGLES = 50000, MANY_TRIANGLES = 400000 };

/* Prefetches the parts of a block that only a hit needs, while its triangles are tested. (gcc removes calls of a
 * function that only prefetches, unless it is inlined.) */
static inline __attribute__((always_inline)) void fetch_vertex_numbers(const struct triangle_block *block) {
    __builtin_prefetch(block->vertices[0]);
    __builtin_prefetch(&block->vertices[2][WIDTH - 1]);
}

/* Prefetches the next entry of the stack. */
static inline __attribute__((always_inline)) void prefetch_block(const struct triangle_index *index,
                                                                 uint32_t reference) {
    const char *position = reference & REF_LEAF ? (const char *)(index->blocks + (reference & ~REF_LEAF))
                                                : (const char *)(index->nodes + reference);
    for (int i = 0; i < 5; i++)
        __builtin_prefetch(position + 64 * i);
}

/* The axes of triangle_ray_axes by a table, as halves of lanes x, y, z, z: the index is which of the direction's
 * components are larger than those before (double4_larger), and above that their signs. */
#define LANE(i) 2 * (i), 2 * (i) + 1
#define AXES(z, negative)                                                                                              \
    { LANE(((z) + 1 + (negative)) % 3), LANE(((z) + 2 - (negative)) % 3), LANE(z), LANE(z) }
#define AXES_4(s) AXES(0, (s)&1), AXES(1, (s) >> 1 & 1), AXES(2, (s) >> 2 & 1), AXES(2, (s) >> 2 & 1)
static const _Alignas(32) uint32_t axes_of[32][8] = {AXES_4(0), AXES_4(1), AXES_4(2), AXES_4(3),
                                                     AXES_4(4), AXES_4(5), AXES_4(6), AXES_4(7)};
#undef AXES_4
#undef AXES
#undef LANE

/* triangle_ray in vectors. */
struct sheared_ray {
    const uint32_t *axes;
    double4 origin; /* x, y, z, z */
    double4 shear;  /* of x, of y, and twice the factor that makes t of z */
};

/* triangle_ray_set with one division for all three. Reads the values after the vectors of the ray with them. */
static inline void sheared_set(struct sheared_ray *out, const struct ray *ray) {
    const double *numbers = (const double *)(const void *)ray;
    _Static_assert(offsetof(struct ray, direction) == 3 * sizeof(double) && sizeof(struct ray) > 7 * sizeof(double),
                   "vectors of a ray are read four numbers at a time");
    double4 direction = double4_load_any(numbers + 3);
    const uint32_t *axes = axes_of[double4_larger(double4_size(direction)) | (double4_negative(direction) & 7) << 2];
    out->axes = axes;
    out->origin = double4_permuted(double4_load_any(numbers), axes);
    direction = double4_permuted(direction, axes);
    out->shear = double4_div(double4_shuffle(direction, double4_all(1), 0, 1, 6, 7), double4_third(direction));
}

struct search {
    const struct triangle_index *index;
    const struct triangle_set *set;
    const struct ray *ray;
    enum triangle_search kind;
    /* In local space, single numbers: spreading one over a vector costs no more than loading the vector. */
    _Alignas(16) float origin[4], direction[4];
    float4 reciprocal; /* 1 / direction */
    float4 middle;     /* origin / direction: the ray crosses a plane at plane * reciprocal - middle */
    float widen[4];    /* for rays from far away: the additional growth of boxes, in local t */
    float longest;     /* the largest size of the direction's components, M */
    uint32_t octant;   /* bit k: the direction is negative along axis k */
    float error;       /* 15 e + 8 D */
    float limit;       /* local t beyond which hits do not matter */
    float certain;     /* local t below which the ray's own interval surely has not ended */
    float blur;        /* absolute error of a hit's local t, beyond its last places */
    bool found, sheared_ready;
    bool moved, far_away;        /* if moved: the ray was moved to the frame, maybe from FAR_AWAY */
    double t_to_local, t_offset; /* if moved: local t = t * t_to_local - t_offset; else they are the same */
    double best;                 /* as decided */
    struct triangle_hit *hit;
    triangle_visit *visit;
    void *context;
    struct triangle_cost *cost;
    struct triangle_run run;    /* skipped, by the searches without a run of triangles */
    uint32_t occluder;          /* skipped triangles that ended an "any" search */
    struct sheared_ray sheared; /* if it is ready */
    /* The nearest certain hit so far, with bounds of its local t; NULL: none. */
    const struct triangle_block *pending;
    unsigned pending_lane;
    float pending_from;
};

/* Byte offsets of the rows of a node with the near and the far sides of boxes for rays of an octant. */
struct sides {
    size_t near_x, near_y, near_z, far_x, far_y, far_z;
};
#define ROW(i) (i) * WIDTH * sizeof(float)
#define SIDES(x, y, z)                                                                                                 \
    { ROW(0 + (x)), ROW(2 + (y)), ROW(4 + (z)), ROW(1 - (x)), ROW(3 - (y)), ROW(5 - (z)) }
static const struct sides sides_of[8] = {SIDES(0, 0, 0), SIDES(1, 0, 0), SIDES(0, 1, 0), SIDES(1, 1, 0),
                                         SIDES(0, 0, 1), SIDES(1, 0, 1), SIDES(0, 1, 1), SIDES(1, 1, 1)};
#undef SIDES
#undef ROW

static inline float8 sides_load(const struct wide_node *node, size_t row) {
    return float8_load((const float *)(const void *)((const char *)node + row));
}

/* The edge functions of triangle_cross, rounded, and the distance to the corners along the ray's axis; lane 3 is not
 * used. */
struct edges {
    double4 e, p, q, along;
};

static inline __attribute__((always_inline)) double4 seen_from(const struct sheared_ray *ray, const double corner[3]) {
    return double4_sub(double4_permuted(double4_load_three(corner), ray->axes), ray->origin);
}

static inline __attribute__((always_inline)) double4 sheared(const struct sheared_ray *ray, double4 corner) {
    return double4_sub(corner, double4_mul(ray->shear, double4_third(corner)));
}

static inline __attribute__((always_inline)) struct edges edges_of(const struct sheared_ray *ray, const double a[3],
                                                                   const double b[3], const double c[3]) {
    double4 from_a = seen_from(ray, a), from_b = seen_from(ray, b), from_c = seen_from(ray, c);
    double4 plane_a = sheared(ray, from_a), plane_b = sheared(ray, from_b), plane_c = sheared(ray, from_c);
    double4 px = double4_firsts(plane_a, plane_b, plane_c), py = double4_seconds(plane_a, plane_b, plane_c);
    struct edges edges = {.p = double4_mul(double4_cab(px), double4_bca(py)),
                          .q = double4_mul(double4_cab(py), double4_bca(px)),
                          .along = double4_thirds(from_a, from_b, from_c)};
    edges.e = double4_sub(edges.p, edges.q);
    return edges;
}

static inline __attribute__((always_inline)) void hit_set(struct triangle_hit *hit, const struct sheared_ray *ray,
                                                          const struct edges *edges) {
    _Static_assert(offsetof(struct triangle_hit, u) == sizeof(double) &&
                       offsetof(struct triangle_hit, v) == 2 * sizeof(double) &&
                       sizeof(struct triangle_hit) >= 4 * sizeof(double),
                   "t, u and v are written with what is behind them");
    double4 found = double4_weighted(edges->e, double4_mul(edges->e, edges->along));
    double4_store_any(&hit->t, double4_mul(found, double4_shuffle(double4_all(1), ray->shear, 6, 1, 2, 3)));
    unsigned enter = ~double4_negative(edges->e) & 1;
    hit->enter = enter;
}

/* triangle_cross with its three edge functions at once and the same bits; cases near zero call triangle_cross. */
static inline __attribute__((always_inline)) bool cross(const struct search *s, const double a[3], const double b[3],
                                                        const double c[3], struct triangle_hit *hit) {
    struct edges edges = edges_of(&s->sheared, a, b, c);
    double4 doubt = double4_mul(double4_all(0x1p-49), double4_add(double4_size(edges.p), double4_size(edges.q)));
    if (__builtin_expect((double4_bits(double4_less(doubt, double4_size(edges.e))) & 7) != 7, 0)) {
        struct triangle_ray exactly;
        triangle_ray_set(&exactly, s->ray); /* search_begin has checked the ray */
        return triangle_cross(&exactly, a, b, c, hit);
    }
    unsigned negative = double4_negative(edges.e) & 7;
    if (negative != 0 && negative != 7)
        return false;
    hit_set(hit, &s->sheared, &edges);
    return true;
}

static inline bool is_crossed(const struct search *s, const struct triangle_block *block, unsigned lane,
                              struct triangle_hit *hit) {
    const double(*vertices)[3] = s->set->vertices;
    bool crossed = cross(s, vertices[block->vertices[0][lane]], vertices[block->vertices[1][lane]],
                         vertices[block->vertices[2][lane]], hit);
    hit->triangle = block->ids[lane];
    return crossed;
}

static inline bool is_nearer(const struct search *s, const struct triangle_hit *h) {
    if (!(h->t > s->ray->t_min) || !(h->t <= s->best))
        return false;
    return h->t != s->best || (s->found && h->triangle < s->hit->triangle);
}

/* Field by field: loading a whole struct that was stored in pieces is slow. */
static inline void hit_copy(struct triangle_hit *to, const struct triangle_hit *from) {
    to->t = from->t;
    to->u = from->u;
    to->v = from->v;
    to->triangle = from->triangle;
    to->enter = from->enter;
}

/* Decides one proposed triangle. True when an "any" search is over. */
static inline bool decide(struct search *s, const struct triangle_block *block, unsigned lane) {
    struct triangle_hit h;
    if (!is_crossed(s, block, lane, &h))
        return false;
    if (s->kind == TRIANGLE_ALL) {
        struct triangle_hit visited = h;
        s->visit(s->context, &visited);
        return false;
    }
    if (!is_nearer(s, &h))
        return false;
    s->found = true;
    s->occluder = h.triangle;
    if (s->kind == TRIANGLE_ANY)
        return true;
    s->best = h.t;
    hit_copy(s->hit, &h);
    double t = s->moved ? h.t * s->t_to_local - s->t_offset : h.t;
    float local = (float)t * (1 + 0x1p-20f) + s->blur;
    if (local < s->limit)
        s->limit = local;
    return false;
}

static inline void make_ready(struct search *s) {
    if (s->sheared_ready)
        return;
    sheared_set(&s->sheared, s->ray);
    s->sheared_ready = true;
}

/* The end of a "nearest" search. If only one certain hit was found, it is final: only its numbers remain to be
 * computed, and none of its edge functions is near zero (MIN_EXTENT). */
static inline bool decide_last(struct search *s) {
    const struct triangle_block *block = s->pending;
    if (!block)
        return s->found;
    unsigned lane = s->pending_lane;
    const double(*vertices)[3] = s->set->vertices;
    if (__builtin_expect(s->found, 0)) {
        struct triangle_hit h;
        make_ready(s);
        if (is_crossed(s, block, lane, &h) && is_nearer(s, &h))
            hit_copy(s->hit, &h);
        return true;
    }
    struct sheared_ray ray;
    sheared_set(&ray, s->ray);
    struct edges edges = edges_of(&ray, vertices[block->vertices[0][lane]], vertices[block->vertices[1][lane]],
                                  vertices[block->vertices[2][lane]]);
    hit_set(s->hit, &ray, &edges);
    s->hit->triangle = block->ids[lane];
    return true;
}

/* Decides a block's proposals. True when an "any" search is over. */
static __attribute__((noinline)) bool decide_lanes(struct search *s, const struct triangle_block *block,
                                                   unsigned lanes) {
    make_ready(s);
    do {
        if (decide(s, block, (unsigned)__builtin_ctz(lanes)))
            return true;
        lanes &= lanes - 1;
    } while (lanes);
    return false;
}

static inline void decide_pending(struct search *s) {
    if (!s->pending)
        return;
    make_ready(s);
    (void)decide(s, s->pending, s->pending_lane);
    s->pending = NULL;
}

/* Keeps the nearest certain hit so far, with bounds of its t: they limit the search well enough to continue, and its
 * vertices are prefetched meanwhile. */
static inline __attribute__((always_inline)) void keep(struct search *s, const struct triangle_block *block,
                                                       unsigned lane, float from, float to) {
    s->pending = block;
    s->pending_lane = lane;
    s->pending_from = from;
    if (s->set->count > FEW_TRIANGLES)
        for (int j = 0; j < 3; j++)
            __builtin_prefetch(s->set->vertices[block->vertices[j][lane]]);
    float limit = to * (1 + 0x1p-20f) + s->blur;
    if (limit < s->limit)
        s->limit = limit;
}

/* Several of them, or one more. */
static __attribute__((noinline)) void keep_lanes(struct search *s, const struct triangle_block *block, unsigned lanes,
                                                 float8 from, float8 to) {
    _Alignas(32) float froms[WIDTH], tos[WIDTH];
    float8_store(froms, from);
    float8_store(tos, to);
    do {
        unsigned lane = (unsigned)__builtin_ctz(lanes);
        lanes &= lanes - 1;
        if (froms[lane] > s->limit)
            continue;
        if (s->pending && !(tos[lane] < s->pending_from)) { /* too close to say which is nearer */
            decide_pending(s);
            (void)decide_lanes(s, block, 1u << lane);
            continue;
        }
        keep(s, block, lane, froms[lane], tos[lane]);
    } while (lanes);
}

/* The lanes of a block with triangles that the search skips. */
static inline unsigned left_out(const struct search *s, const struct triangle_block *b) {
    unsigned lanes = 0;
    typedef uint32_t __attribute__((vector_size(16), may_alias)) numbers;
    for (unsigned i = 0; i < WIDTH; i += 4) {
        numbers after = *(const numbers *)(const void *)(b->ids + i) - s->run.first;
        lanes |= float4_bits((float4_mask)(after < s->run.count)) << i;
    }
    return lanes;
}

static inline __attribute__((always_inline)) bool try_block(struct search *s, uint32_t number, const float from_t,
                                                            const enum triangle_search kind, const bool leaves_out) {
    const struct triangle_block *b = s->index->blocks + number;
    float8 ox = float8_all(s->origin[0]), oy = float8_all(s->origin[1]), oz = float8_all(s->origin[2]);
    if (kind == TRIANGLE_NEAREST)
        fetch_vertex_numbers(b);
    float8 dx = float8_all(s->direction[0]), dy = float8_all(s->direction[1]), dz = float8_all(s->direction[2]);
    const float8 moved = float8_all(from_t);
    float error = s->error;
    if (kind == TRIANGLE_NEAREST) {
        error += MOVING_ERROR * from_t * s->longest;
        ox = float8_multiply_add(moved, dx, ox);
        oy = float8_multiply_add(moved, dy, oy);
        oz = float8_multiply_add(moved, dz, oz);
    }
    float8 e1x = float8_load(b->edge1[0]), e1y = float8_load(b->edge1[1]), e1z = float8_load(b->edge1[2]);
    float8 e2x = float8_load(b->edge2[0]), e2y = float8_load(b->edge2[1]), e2z = float8_load(b->edge2[2]);
    float8 px = float8_multiply_sub(dy, e2z, float8_mul(dz, e2y));
    float8 py = float8_multiply_sub(dz, e2x, float8_mul(dx, e2z));
    float8 pz = float8_multiply_sub(dx, e2y, float8_mul(dy, e2x));
    float8 det = float8_multiply_add(e1x, px, float8_multiply_add(e1y, py, float8_mul(e1z, pz)));
    float8 sx = float8_sub(ox, float8_load(b->corner[0]));
    float8 sy = float8_sub(oy, float8_load(b->corner[1]));
    float8 sz = float8_sub(oz, float8_load(b->corner[2]));
    float8 qx = float8_multiply_sub(sy, e1z, float8_mul(sz, e1y));
    float8 qy = float8_multiply_sub(sz, e1x, float8_mul(sx, e1z));
    float8 qz = float8_multiply_sub(sx, e1y, float8_mul(sy, e1x));
    float8 u = float8_multiply_add(sx, px, float8_multiply_add(sy, py, float8_mul(sz, pz)));
    float8 v = float8_multiply_add(dx, qx, float8_multiply_add(dy, qy, float8_mul(dz, qz)));
    float8 t = float8_multiply_add(e2x, qx, float8_multiply_add(e2y, qy, float8_mul(e2z, qz)));
    float8 sign = float8_sign(det);
    det = float8_flip(det, sign);
    u = float8_flip(u, sign);
    v = float8_flip(v, sign);
    t = float8_flip(t, sign);
    float8 lx = float8_max_size(e1x, e2x), ly = float8_max_size(e1y, e2y), lz = float8_max_size(e1z, e2z);
    float8 extent = float8_max(float8_max(lx, ly), lz);
    extent = float8_max(extent, float8_all(MIN_EXTENT)); /* no slack at all would make points certain hits */
    float8 ax = float8_size(sx), ay = float8_size(sy), az = float8_size(sz);
    float8 w = float8_multiply_add(extent, float8_all(180 * 0x1p-24f), float8_all(error));
    float8 e = float8_multiply_add(float8_max(float8_max(ax, ay), az), float8_all(146 * 0x1p-24f), w);
    e = float8_mul(float8_mul(e, extent), float8_all(s->longest));
    float8 yz = float8_mul(ly, lz), zx = float8_mul(lz, lx), xy = float8_mul(lx, ly);
    float8 min = float8_all(error / 2), each = float8_all(36 * 0x1p-24f);
    float8 slack =
        float8_mul(float8_multiply_add(lx, float8_all(54 * 0x1p-24f), float8_multiply_add(ax, each, min)), yz);
    slack = float8_multiply_add(float8_multiply_add(ay, each, min), zx, slack);
    slack = float8_multiply_add(float8_multiply_add(az, each, min), xy, slack);
    float8 smaller = float8_min(u, v), rest = float8_sub(det, float8_add(u, v));
    float8 a = float8_add(smaller, e), c = float8_multiply_add(e, float8_all(3), rest);
    float8 f = float8_add(t, slack);
    float8 g = float8_sub(float8_multiply_add(det, float8_all(s->limit - from_t), slack), t);
    const unsigned all = (1 << WIDTH) - 1;
    unsigned missed = float8_negative(float8_min(float8_min(a, c), float8_min(f, g))), doubtful = all;
    if (leaves_out)
        missed |= left_out(s, b);
    if (__builtin_expect(missed == all, 1))
        return false;
    if (kind != TRIANGLE_ALL) {
        a = float8_sub(smaller, e);
        c = float8_sub(rest, float8_mul(e, float8_all(3)));
        f = float8_sub(t, slack);
        g = float8_sub(float8_multiply_sub(det, float8_all(s->certain - from_t), slack), t);
        doubtful = missed | float8_negative(float8_min(float8_min(a, c), float8_min(f, g)));
        if (doubtful != all && kind == TRIANGLE_ANY) {
            if (leaves_out)
                s->occluder = b->ids[__builtin_ctz(doubtful ^ all)];
            return true;
        }
        if (doubtful != all) { /* |T - t det| <= slack */
            unsigned certain = doubtful ^ all;
            float8 r = float8_div(float8_all(1), det);
            float8 from = float8_mul(float8_multiply_add(f, r, moved), float8_all(1 - 0x1p-20f));
            float8 to = float8_mul(float8_multiply_add(float8_add(t, slack), r, moved), float8_all(1 + 0x1p-20f));
            if (__builtin_expect(!(certain & (certain - 1)) && !s->pending, 1)) {
                unsigned lane = (unsigned)__builtin_ctz(certain);
                keep(s, b, lane, float8_pick(from, lane), float8_pick(to, lane));
            } else {
                keep_lanes(s, b, certain, from, to);
            }
            if (doubtful == missed)
                return false;
        }
    }
    return decide_lanes(s, b, doubtful ^ missed);
}

/* One hierarchy. True when an "any" search is over. */
static inline __attribute__((always_inline)) bool descend(struct search *s, uint32_t reference,
                                                          const enum triangle_search kind, const bool far_away,
                                                          const bool many, const bool leaves_out) {
    struct node_stack stack;
    size_t top = 0;
    bool found = false;
    if (kind == TRIANGLE_NEAREST)
        stack.enter[0] = 0;
    const struct wide_node *nodes = s->index->nodes;
    const float8 rx = float8_all(s->reciprocal[0]), ry = float8_all(s->reciprocal[1]),
                 rz = float8_all(s->reciprocal[2]);
    const float8 mx = float8_all(s->middle[0]), my = float8_all(s->middle[1]), mz = float8_all(s->middle[2]);
    uint64_t visited = 0, tried = 0;
    float8 limit = float8_all(s->limit);
    const uint32_t octant = s->octant;
    const struct sides sides = sides_of[octant];
    for (;;) {
        if (!(reference & REF_LEAF)) {
            const struct wide_node *n = nodes + reference;
            visited++;
            float8 ax = float8_multiply_sub(sides_load(n, sides.near_x), rx, mx);
            float8 ay = float8_multiply_sub(sides_load(n, sides.near_y), ry, my);
            float8 az = float8_multiply_sub(sides_load(n, sides.near_z), rz, mz);
            float8 bx = float8_multiply_sub(sides_load(n, sides.far_x), rx, mx);
            float8 by = float8_multiply_sub(sides_load(n, sides.far_y), ry, my);
            float8 bz = float8_multiply_sub(sides_load(n, sides.far_z), rz, mz);
            if (far_away) {
                float8 wx = float8_all(s->widen[0]), wy = float8_all(s->widen[1]), wz = float8_all(s->widen[2]);
                ax = float8_sub(ax, wx);
                ay = float8_sub(ay, wy);
                az = float8_sub(az, wz);
                bx = float8_add(bx, wx);
                by = float8_add(by, wy);
                bz = float8_add(bz, wz);
            }
            /* Comparing bits is enough although it reverses the order of negative numbers, because the limit is not
             * negative. For a box that begins behind the ray's start `enter` is negative. If the box also ends there,
             * `leave` is negative, too, and `enter` is not nearer to 0, so as bits it is not less. */
            float8 enter = float8_latest_bits(ax, ay, az);
            float8 leave = float8_min_bits(float8_min_bits(bx, by), float8_min_bits(bz, limit));
            if (kind == TRIANGLE_NEAREST
                    ? node_take_nearest(n, octant, (struct node_span){enter, leave}, &stack, &top, &reference)
                    : node_take_any(n, enter, leave, &stack, &top, &reference)) {
                if (many && top)
                    prefetch_block(s->index, stack.reference[top - 1]);
                continue;
            }
        } else {
            tried++;
            float enter = kind == TRIANGLE_NEAREST && stack.enter[top] > 0 ? stack.enter[top] : 0;
            if (try_block(s, reference & ~REF_LEAF, enter, kind, leaves_out)) {
                found = true;
                break;
            }
            if (kind == TRIANGLE_NEAREST)
                limit = float8_all(s->limit);
        }
        do {
            if (!top)
                goto done;
            top--;
        } while (kind == TRIANGLE_NEAREST && stack.enter[top] > float8_low(limit)[0]);
        reference = stack.reference[top];
    }
done:
    s->cost->hierarchy_steps += visited;
    s->cost->triangle_tests += tried * WIDTH;
    return found;
}

static inline __attribute__((always_inline)) bool traverse_voxels(struct search *s, const enum triangle_search kind,
                                                                  const bool many, const bool leaves_out) {
    const struct triangle_index *index = s->index;
    if (!index->voxels)
        return false;
    /* Big triangles belong to no voxel. */
    if (index->big && descend(s, index->big, kind, true, many, leaves_out))
        return true;
    /* The first voxel. */
    float4 origin = float4_load_any(s->origin), reciprocal = s->reciprocal, cell = float4_load_any(index->cell),
           position = float4_mul(float4_add(origin, float4_load_any(index->half_single)),
                                 float4_load_any(index->inverse_cell));
    int32_t at[4];
    float4 start = float4_max(float4_all(0), float4_min(position, float4_load_any(index->last_cell)));
    float4_store_int(at, start);
    start = float4_whole(start);
    /* The parameter of the next voxel along each axis, and between two of them. */
    float4 across = float4_mul(cell, reciprocal);
    float4 next_t = float4_mul(float4_sub(float4_add(start, float4_one_unless_negative(reciprocal)), position), across);
    float4 step_t = float4_size(across);
    next_t = float4_add(next_t, (float4){0, 0, 0, INFINITY});
    /* Voxel after voxel, until something is met or the ray leaves. */
    const int32_t *offset = index->offset[float4_negative(reciprocal) & 7];
    const uint32_t *voxel = index->voxels + 1 + index->stride[0] + index->stride[1] + (uint32_t)at[0] +
                            (uint32_t)at[1] * index->stride[0] + (uint32_t)at[2] * index->stride[1];
    for (;;) {
        uint32_t reference = *voxel;
        float4 leave = float4_min_of_three(next_t);
        if (reference != REF_EMPTY) {
            if (reference == REF_OUTSIDE)
                return false;
            s->cost->voxels++;
            if (descend(s, reference, kind, true, many, leaves_out))
                return true;
        }
        if (s->limit <= leave[0])
            return false;
        unsigned lanes;
        next_t = float4_add_where_reached(next_t, leave, step_t, &lanes);
        voxel += offset[lanes & 7];
    }
}

/* Rays that have been moved to the frame. */
static inline __attribute__((always_inline)) bool traverse(struct search *s, const enum triangle_search kind,
                                                           const bool leaves_out) {
    const bool many = kind == TRIANGLE_NEAREST && s->set->count > MANY_TRIANGLES;
    if (s->index->only == REF_EMPTY)
        return traverse_voxels(s, kind, many, leaves_out);
    return s->far_away ? descend(s, s->index->only, kind, true, many, leaves_out)
                       : descend(s, s->index->only, kind, false, many, leaves_out);
}

/* Separate from the kernel of the others, which needs its registers. */
static __attribute__((noinline)) bool traverse_nearest_apart(struct search *s) {
    return traverse(s, TRIANGLE_NEAREST, false);
}

static __attribute__((noinline)) bool traverse_any_apart(struct search *s) {
    return traverse(s, TRIANGLE_ANY, false);
}

static inline double power_of_two(uint64_t exponent_bits) {
    double x;
    exponent_bits <<= 52;
    memcpy(&x, &exponent_bits, sizeof x);
    return x;
}

/* The ray is at `origin`; its local t ends at about `last`. */
static inline void search_start(struct search *s, float4 origin, float4 direction, float4 reciprocal, float last) {
    float4_store_any(s->origin, origin);
    float4_store_any(s->direction, direction);
    s->reciprocal = reciprocal;
    s->middle = float4_mul(origin, reciprocal);
    s->octant = float4_negative(direction) & 7;
    s->limit = last * (1 + 0x1p-20f) + s->blur;
    s->certain = last * (1 - 0x1p-20f) - s->blur;
    s->found = s->sheared_ready = false;
    s->pending = NULL;
    s->best = s->ray->t_max;
}

enum ray_start { RAY_INSIDE, RAY_MISSES, RAY_UNUSABLE };

/* In double precision, for rays that start far away or have odd directions. Rays that are not finite, or so far away
 * that the tolerance would exceed the mesh, use brute force. */
static __attribute__((noinline)) enum ray_start search_begin_far(struct search *s, double4 o, double4 d) {
    const struct triangle_index *index = s->index;
    /* A zero becomes so small that any distance along it is negligible. */
    double4 d_size = double4_size(d),
            r = double4_div(double4_all(1), double4_flip(double4_max(d_size, double4_all(0x1p-980)), double4_sign(d)));
    double4 half = double4_load_any(index->half), o_size = double4_shuffle(double4_size(o), double4_all(1), 0, 1, 2, 7);
    double4 a = double4_mul(double4_sub(double4_sub(double4_all(0), half), o), r),
            b = double4_mul(double4_sub(half, o), r);
    double enter = double4_largest(double4_shuffle(double4_min(a, b), double4_all(s->ray->t_min), 0, 1, 2, 7));
    double leave = double4_smallest(double4_shuffle(double4_max(a, b), double4_all(s->ray->t_max), 0, 1, 2, 7));
    double largest = double4_largest(d_size), far = double4_largest(o_size);
    if (!double4_all_less(o_size, double4_all(0x1p30)) || !double4_all_less(d_size, double4_all(0x1p900)) ||
        !(largest > 0x1p-900))
        return RAY_UNUSABLE;
    if (!(enter <= leave))
        return RAY_MISSES;
    /* The local direction's largest component becomes at least 1/2 and less than 1, by a power of two. */
    uint64_t exponent;
    memcpy(&exponent, &largest, sizeof exponent);
    exponent >>= 52;
    double to_local = power_of_two(exponent + 1), shrink = power_of_two(2045 - exponent);
    r = double4_mul(r, double4_all(to_local));
    r = double4_flip(double4_min(double4_size(r), double4_all(0x1p60)), double4_sign(r));
    float4 r4 = double4_to_single(r);
    s->moved = true;
    s->t_to_local = to_local;
    s->t_offset = enter * to_local;
    s->blur = 0x1p-20f;
    search_start(s, double4_to_single(double4_add(o, double4_mul(d, double4_all(enter)))),
                 double4_to_single(double4_mul(d, double4_all(shrink))), r4, (float)((leave - enter) * to_local));
    double certain = (s->ray->t_max - enter) * to_local * (1 - 0x1p-20) - 0x1p-20;
    s->certain = certain < 16 ? (float)certain : 16;
    s->longest = 1;
    s->error = POSITION_ERROR + (float)(far * 8 * 0x1p-46);
    s->far_away = far > FAR_AWAY;
    float4_store_any(s->widen, float4_mul(float4_size(r4), float4_all((float)(far * 0x1p-45))));
    return RAY_INSIDE;
}

/* Most rays start near the mesh and at t = 0. They are not moved, and are in single precision from here on: the first
 * node does not wait for the entry into the frame, and their t is the local one. */
static inline __attribute__((always_inline)) enum ray_start search_begin(struct search *s) {
    const struct triangle_index *index = s->index;
    const struct ray *ray = s->ray;
    double4 scale = double4_all(index->scale);
    double4 o = double4_mul(double4_sub(double4_load_singly(&ray->origin.x), double4_load_any(index->centre)), scale);
    double4 d = double4_mul(double4_load_singly(&ray->direction.x), scale);
    float4 o4 = double4_to_single(o), d4 = double4_to_single(d);
    float8 sizes = float8_size(float8_of(o4, d4));
    s->longest = float4_largest_of_three(float8_high(sizes));
    uint64_t from_bits;
    memcpy(&from_bits, &ray->t_min, sizeof from_bits);
    bool usual = float8_all_within(sizes, index->usual_from, index->usual_to) && s->longest > 0x1p-30f &&
                 from_bits == 0 && ray->t_max > 0;
    if (__builtin_expect(!usual, 0))
        return search_begin_far(s, o, d);
    float4 r4 = float4_div(float4_all(1), d4), half = float4_load_any(index->half_single);
    float last = (float)(ray->t_max < 0x1p60 ? ray->t_max : 0x1p60);
    if (float4_bits(float4_less(half, float8_low(sizes))) & 7) { /* from outside many rays miss the frame */
        float4 middle = float4_mul(o4, r4), extent = float4_mul(half, float4_size(r4));
        float enter = float4_largest_of_three(float4_sub(float4_sub(float4_all(0), middle), extent));
        float leave = float4_smallest_of_three(float4_sub(extent, middle));
        if (!(enter <= leave && leave >= 0 && enter <= last))
            return RAY_MISSES;
    }
    s->blur = 0;
    s->error = POSITION_ERROR * float4_largest_of_three(float8_low(sizes)) + 0x1p-40f;
    s->moved = false;
    search_start(s, o4, d4, r4, last);
    return RAY_INSIDE;
}

bool KERNEL(nearest)(const struct triangle_index *index, const struct triangle_set *set, const struct ray *ray,
                     struct triangle_hit *hit, struct triangle_cost *cost) {
    struct search s;
    s.cost = cost;
    s.index = index;
    s.set = set;
    s.ray = ray;
    s.kind = TRIANGLE_NEAREST;
    s.hit = hit;
    enum ray_start start_case = search_begin(&s);
    if (start_case != RAY_INSIDE)
        return start_case == RAY_UNUSABLE && triangle_brute_nearest(set, ray, hit, cost);
    if (s.moved)
        traverse_nearest_apart(&s);
    else if (set->count > MANY_TRIANGLES)
        descend(&s, index->only, TRIANGLE_NEAREST, false, true, false);
    else
        descend(&s, index->only, TRIANGLE_NEAREST, false, false, false);
    return decide_last(&s);
}

bool KERNEL(any)(const struct triangle_index *index, const struct triangle_set *set, const struct ray *ray,
                 struct triangle_cost *cost) {
    struct search s;
    s.cost = cost;
    s.index = index;
    s.set = set;
    s.ray = ray;
    s.kind = TRIANGLE_ANY;
    enum ray_start start_case = search_begin(&s);
    if (start_case != RAY_INSIDE)
        return start_case == RAY_UNUSABLE && triangle_brute_any(set, ray, cost);
    return s.moved ? traverse_any_apart(&s) : descend(&s, index->only, TRIANGLE_ANY, false, false, false);
}

/* The same without a run of triangles. */
static __attribute__((noinline)) bool traverse_nearest_but_apart(struct search *s) {
    return traverse(s, TRIANGLE_NEAREST, true);
}

static __attribute__((noinline)) bool traverse_any_but_apart(struct search *s) {
    return traverse(s, TRIANGLE_ANY, true);
}

/* An empty run begins after the last triangle. */
static inline struct triangle_run run_to_leave_out(struct triangle_run run) {
    return run.count > 0 ? run : (struct triangle_run){UINT32_MAX, 1};
}

bool KERNEL(nearest_but)(const struct triangle_index *index, const struct triangle_set *set, const struct ray *ray,
                         struct triangle_run run, struct triangle_hit *hit, struct triangle_cost *cost) {
    struct search s;
    s.cost = cost;
    s.index = index;
    s.set = set;
    s.ray = ray;
    s.kind = TRIANGLE_NEAREST;
    s.hit = hit;
    s.run = run_to_leave_out(run);
    enum ray_start start_case = search_begin(&s);
    if (start_case != RAY_INSIDE)
        return start_case == RAY_UNUSABLE && triangle_brute_nearest(set, ray, hit, cost);
    if (s.moved)
        traverse_nearest_but_apart(&s);
    else if (set->count > MANY_TRIANGLES)
        descend(&s, index->only, TRIANGLE_NEAREST, false, true, true);
    else
        descend(&s, index->only, TRIANGLE_NEAREST, false, false, true);
    return decide_last(&s);
}

bool KERNEL(any_but)(const struct triangle_index *index, const struct triangle_set *set, const struct ray *ray,
                     struct triangle_run run, uint32_t *triangle, struct triangle_cost *cost) {
    struct search s;
    s.cost = cost;
    s.index = index;
    s.set = set;
    s.ray = ray;
    s.kind = TRIANGLE_ANY;
    s.run = run_to_leave_out(run);
    enum ray_start start_case = search_begin(&s);
    if (start_case == RAY_UNUSABLE) {
        struct triangle_hit hit;
        bool found = triangle_brute_nearest(set, ray, &hit, cost);
        *triangle = hit.triangle;
        return found;
    }
    if (start_case == RAY_MISSES)
        return false;
    if (!(s.moved ? traverse_any_but_apart(&s) : descend(&s, index->only, TRIANGLE_ANY, false, false, true)))
        return false;
    *triangle = s.occluder;
    return true;
}

void KERNEL(all)(const struct triangle_index *index, const struct triangle_set *set, const struct ray *ray,
                 triangle_visit *visit, void *context, struct triangle_cost *cost) {
    struct search s;
    struct ray line = *ray;
    s.cost = cost;
    line.t_min = -INFINITY;
    line.t_max = INFINITY;
    s.index = index;
    s.set = set;
    s.ray = &line;
    s.kind = TRIANGLE_ALL;
    s.visit = visit;
    s.context = context;
    enum ray_start start_case = search_begin(&s);
    if (start_case == RAY_UNUSABLE)
        triangle_brute_all(set, &line, visit, context, cost);
    if (start_case != RAY_INSIDE)
        return;
    traverse(&s, TRIANGLE_ALL, false);
}
