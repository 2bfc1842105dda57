/* The packet search, compiled once per instruction set: a file defines PACKET(name) and includes this one.
 *
 * Up to 64 rays of one origin traverse one hierarchy together. A node is first tested against the beam that contains
 * all of them, eight children at once: the slopes of the rays over their longest axis bound it by four planes through
 * the origin (as in Reshetov, Soupikov, Hurley, "Multi-Level Ray Tracing Algorithm", SIGGRAPH 2005). A child that the
 * beam hits goes on the stack with its box and the set of rays that hit its parent; when it is popped, its box is
 * tested against these rays, a vector of them at a time, with their current limits.
 *
 * With one origin o the Moeller-Trumbore test falls into a part of the triangle and a part of the ray: with the edges
 * e1, e2 from the corner c and s = o - c, all of
 *   det = d . (e2 x e1),  u = d . (e2 x s),  v = d . (s x e1),  T = e2 . (s x e1),  t = T / det
 * are scalar products of the ray's direction d with vectors that are computed once for the eight triangles of a block.
 * Then either one ray is tested against eight triangles or one triangle against many rays, whichever is less work.
 *
 * Single precision proposes, doubles decide, as in triangle_kernel_internal.h, with the same meaning of e, S, L and D.
 * The rays are tested from their origin, which is not moved and is up to FARTHEST from the middle; with R = |o| a
 * corner is at most R + S:
 *
 * - s is off by (2 R + S) e + D (R for the origin, R + S for the corner), and by S e from the subtraction;
 * - e2 x e1 by 8 e L^2 a component, det by 46 e L^2;
 * - e2 x s and s x e1 by (4 R + 10 S) e L + 2 D L a component; u and v by (12 R + 52 S) e L + 6 D L;
 * - T by (12 R + 58 S) e L^2 + 6 D L^2, and 46 e L^2 t from comparing it with t det; a direction's largest component is
 *   1/4 to 1, so t <= 4 (S + 2 L).
 *
 * With E = ((13 R + 64 S + 64 L) e + 8 D) L a true hit has u, v >= -E, u + v <= |det| + 3 E, and T within 6 E L. A
 * triangle that passes with these reversed is certainly a hit.
 *
 * A certain hit of a "nearest" search becomes the ray's candidate, with bounds of its t. A nearer one replaces it; if
 * bounds overlap, and for all uncertain hits, doubles decide at once. The remaining candidates are decided at the end,
 * eight rays at a time. */

#include "accel/triangle_layout_internal.h"
#include "accel/triangle_packet.h"
#include "math/lanes.h"

#include <string.h>

enum { GROUPS = PACKET_RAYS / FLOAT_LANES };
/* All lanes of a group of rays. */
#define ALL_LANES ((UINT64_C(1) << FLOAT_LANES) - 1)

/* Local units. */
#define FARTHEST 64.0

struct packet {
    _Alignas(64) float dx[PACKET_RAYS], dy[PACKET_RAYS], dz[PACKET_RAYS];
    float rx[PACKET_RAYS], ry[PACKET_RAYS], rz[PACKET_RAYS]; /* 1 / direction */
    float limit[PACKET_RAYS];                                /* local t beyond which hits do not matter */
    float certain[PACKET_RAYS]; /* local t below which the ray's own interval surely has not ended */
    float nearer[PACKET_RAYS];  /* the candidate's t is surely not below this; infinite: no candidate */
    uint32_t candidate[PACKET_RAYS];
    double best[PACKET_RAYS]; /* as decided */
    float shifted[6];         /* origin moved out by the slack of boxes, in the order of a node's rows */
    float origin[3];
    float error; /* 13 R e + 8 D */
    float begun; /* local t from which the rays' interval surely has begun */
    /* The beam: over the axis `forward`, along which all rays have the same sign. */
    int forward, side[2];
    bool backwards, mixed;                     /* mixed: the signs of the rays differ along other axes */
    float slope_min[2], slope_max[2], soonest; /* of coordinate / |forward|; 1 / the largest |d| ahead */
    bool negative[3];
    double t_to_local;
    const struct triangle_index *index;
    const struct triangle_set *set;
    const struct ray_packet *rays;
    struct packet_hits *hits;
    unsigned groups; /* vectors of rays in use */
    int axes;        /* x, y, z of triangle_ray_set as base-4 digits where all rays have the same, else -1 */
    uint64_t alive, found, pending; /* rays that search; that have a hit; that have a candidate */
    uint64_t tests, nodes;
};

struct pending_box {
    float bounds[6]; /* about the origin, grown */
    uint32_t reference;
    uint64_t rays;
};

/* ---- deciding ---- */

static inline void answer(struct packet *p, unsigned i, const struct triangle_hit *h, const bool any) {
    if (!(h->t > p->rays->t_min) || !(h->t <= p->best[i]))
        return;
    uint64_t bit = UINT64_C(1) << i;
    if (h->t == p->best[i] && !((p->found & bit) && !any && h->triangle < p->hits->triangle[i]))
        return;
    p->found |= bit;
    if (any) {
        p->alive &= ~bit;
        return;
    }
    p->best[i] = h->t;
    packet_hits_set(p->hits, i, h);
    float local = (float)(h->t * p->t_to_local) * (1 + 0x1p-20f);
    if (local < p->limit[i])
        p->limit[i] = local;
}

static __attribute__((noinline)) void decide(struct packet *p, unsigned i, uint32_t triangle, const bool any) {
    struct triangle_ray sheared;
    struct ray ray = ray_packet_get(p->rays, i);
    triangle_ray_set(&sheared, &ray); /* the rays have been checked */
    const uint32_t *c = p->set->corners[triangle];
    struct triangle_hit h = {.triangle = triangle};
    if (triangle_cross(&sheared, p->set->vertices[c[0]], p->set->vertices[c[1]], p->set->vertices[c[2]], &h))
        answer(p, i, &h, any);
}

/* A hit that is certain, at a local t between `from` and `to`. */
static inline void keep(struct packet *p, unsigned i, uint32_t triangle, float from, float to) {
    uint64_t bit = UINT64_C(1) << i;
    if ((p->pending & bit) && !(to < p->nearer[i]))
        decide(p, i, p->candidate[i], false);
    p->pending |= bit;
    p->candidate[i] = triangle;
    p->nearer[i] = from;
    if (to < p->limit[i])
        p->limit[i] = to;
}

enum { BATCH = 8 };

/* triangle_cross for the candidates of eight rays at once: the same operations in the same order, so the same bits.
 * If an edge function cancels, triangle_cross itself is called. */
static inline __attribute__((always_inline)) void decide_batch(struct packet *p, unsigned first, unsigned pending,
                                                               const int x, const int y, const int z) {
    _Alignas(64) double a[3][BATCH], b[3][BATCH], c[3][BATCH], t[BATCH], hit_u[BATCH], hit_v[BATCH], sums[BATCH];
    int64_t clear[BATCH];
    const double *dx = p->rays->direction[x] + first, *dy = p->rays->direction[y] + first,
                 *dz = p->rays->direction[z] + first;
    const double origin[3] = {p->rays->origin.x, p->rays->origin.y, p->rays->origin.z};
    const double ox = origin[x], oy = origin[y], oz = origin[z];
    for (unsigned k = 0; k < BATCH; k++) {
        const uint32_t *corner = p->set->corners[pending >> k & 1 ? p->candidate[first + k] : 0];
        const double *va = p->set->vertices[corner[0]], *vb = p->set->vertices[corner[1]],
                     *vc = p->set->vertices[corner[2]];
        a[0][k] = va[x];
        a[1][k] = va[y];
        a[2][k] = va[z];
        b[0][k] = vb[x];
        b[1][k] = vb[y];
        b[2][k] = vb[z];
        c[0][k] = vc[x];
        c[1][k] = vc[y];
        c[2][k] = vc[z];
    }
    for (int k = 0; k < BATCH; k++) {
        double scale_z = 1 / dz[k], shear_x = dx[k] / dz[k], shear_y = dy[k] / dz[k];
        double az = a[2][k] - oz, bz = b[2][k] - oz, cz = c[2][k] - oz;
        double ax = (a[0][k] - ox) - shear_x * az, ay = (a[1][k] - oy) - shear_y * az;
        double bx = (b[0][k] - ox) - shear_x * bz, by = (b[1][k] - oy) - shear_y * bz;
        double cx = (c[0][k] - ox) - shear_x * cz, cy = (c[1][k] - oy) - shear_y * cz;
        double up = cx * by, uq = cy * bx, u = up - uq;
        double vp = ax * cy, vq = ay * cx, v = vp - vq;
        double wp = bx * ay, wq = by * ax, w = wp - wq;
        double u_left = fabs(u) - 0x1p-49 * (fabs(up) + fabs(uq)), v_left = fabs(v) - 0x1p-49 * (fabs(vp) + fabs(vq)),
               w_left = fabs(w) - 0x1p-49 * (fabs(wp) + fabs(wq));
        double sum = u + v + w;
        /* Equal signs: none of the three products with the sum is negative. */
        clear[k] = (u_left > 0) & (v_left > 0) & (w_left > 0) & ((u > 0) == (v > 0)) & ((v > 0) == (w > 0));
        sums[k] = sum;
        t[k] = (u * az + v * bz + w * cz) / sum * scale_z;
        hit_u[k] = v / sum;
        hit_v[k] = w / sum;
    }
    for (; pending; pending &= pending - 1) {
        unsigned k = (unsigned)__builtin_ctz(pending), i = first + k;
        if (!clear[k]) {
            decide(p, i, p->candidate[i], false);
            continue;
        }
        struct triangle_hit h = {t[k], hit_u[k], hit_v[k], p->candidate[i], sums[k] > 0};
        answer(p, i, &h, false);
    }
}

static void decide_candidates(struct packet *p) {
    for (unsigned first = 0; first < PACKET_RAYS; first += BATCH) {
        unsigned pending = (unsigned)(p->pending >> first & 255);
        if (!pending)
            continue;
        /* One permutation of the axes for all rays has code of its own; otherwise each ray has its own. */
        switch (p->axes) {
        case 0:
            decide_batch(p, first, pending, 1, 2, 0);
            break;
        case 1:
            decide_batch(p, first, pending, 2, 0, 1);
            break;
        case 2:
            decide_batch(p, first, pending, 0, 1, 2);
            break;
        case 3:
            decide_batch(p, first, pending, 2, 1, 0);
            break;
        case 4:
            decide_batch(p, first, pending, 0, 2, 1);
            break;
        case 5:
            decide_batch(p, first, pending, 1, 0, 2);
            break;
        default:
            for (; pending; pending &= pending - 1) {
                unsigned i = first + (unsigned)__builtin_ctz(pending);
                decide(p, i, p->candidate[i], false);
            }
        }
    }
}

/* ---- blocks ---- */

/* The part of the test of eight triangles that depends only on the origin. */
struct parts {
    _Alignas(32) float n[3][WIDTH], a[3][WIDTH], q[3][WIDTH], t[WIDTH], e[WIDTH], slack[WIDTH];
    const uint32_t *ids;
    unsigned used; /* one bit a triangle */
};

static inline unsigned float8_not_negative(float8 a) {
    return float8_negative(a) ^ 255u;
}

static inline unsigned float_lanes_not_negative(float_lanes a) {
    return float_lanes_negative(a) ^ (unsigned)ALL_LANES;
}

static inline float8 cross_part(float8 ay, float8 az, float8 by, float8 bz) {
    return float8_multiply_sub(ay, bz, float8_mul(az, by));
}

static inline __attribute__((always_inline)) void split_block(const struct packet *p, uint32_t number,
                                                              struct parts *out) {
    const struct triangle_block *b = p->index->blocks + number;
    float8 e1x = float8_load(b->edge1[0]), e1y = float8_load(b->edge1[1]), e1z = float8_load(b->edge1[2]);
    float8 e2x = float8_load(b->edge2[0]), e2y = float8_load(b->edge2[1]), e2z = float8_load(b->edge2[2]);
    float8 sx = float8_sub(float8_all(p->origin[0]), float8_load(b->corner[0]));
    float8 sy = float8_sub(float8_all(p->origin[1]), float8_load(b->corner[1]));
    float8 sz = float8_sub(float8_all(p->origin[2]), float8_load(b->corner[2]));
    float8_store(out->n[0], cross_part(e2y, e2z, e1y, e1z));
    float8_store(out->n[1], cross_part(e2z, e2x, e1z, e1x));
    float8_store(out->n[2], cross_part(e2x, e2y, e1x, e1y));
    float8_store(out->a[0], cross_part(e2y, e2z, sy, sz));
    float8_store(out->a[1], cross_part(e2z, e2x, sz, sx));
    float8_store(out->a[2], cross_part(e2x, e2y, sx, sy));
    float8 qx = cross_part(sy, sz, e1y, e1z), qy = cross_part(sz, sx, e1z, e1x), qz = cross_part(sx, sy, e1x, e1y);
    float8_store(out->q[0], qx);
    float8_store(out->q[1], qy);
    float8_store(out->q[2], qz);
    float8_store(out->t, float8_multiply_add(e2x, qx, float8_multiply_add(e2y, qy, float8_mul(e2z, qz))));
    float8 extent =
        float8_max(float8_max(float8_size(e1x), float8_size(e1y)), float8_max(float8_size(e1z), float8_size(e2x)));
    extent = float8_max(extent, float8_max(float8_size(e2y), float8_size(e2z)));
    extent = float8_max(extent, float8_all(0x1p-40f)); /* zero slack would make degenerate triangles certain hits */
    float8 distance = float8_max(float8_size(sx), float8_max(float8_size(sy), float8_size(sz)));
    float8 e = float8_multiply_add(float8_add(extent, distance), float8_all(64 * 0x1p-24f), float8_all(p->error));
    e = float8_mul(e, extent);
    float8_store(out->e, e);
    float8_store(out->slack, float8_mul(float8_mul(e, extent), float8_all(6)));
    out->ids = b->ids;
    out->used = float8_bits(
        float8_less_equal(float8_load(b->corner[0]), float8_all(4))); /* an unused lane is outside of the frame */
}

/* One ray, eight triangles. */
static inline __attribute__((always_inline)) void try_ray(struct packet *p, const struct parts *b, unsigned i,
                                                          const bool any) {
    /* The determinant and the scaled barycentric coordinates. */
    float8 dx = float8_all(p->dx[i]), dy = float8_all(p->dy[i]), dz = float8_all(p->dz[i]);
    float8 det = float8_multiply_add(
        dx, float8_load(b->n[0]), float8_multiply_add(dy, float8_load(b->n[1]), float8_mul(dz, float8_load(b->n[2]))));
    float8 u = float8_multiply_add(dx, float8_load(b->a[0]),
                                   float8_multiply_add(dy, float8_load(b->a[1]), float8_mul(dz, float8_load(b->a[2]))));
    float8 v = float8_multiply_add(dx, float8_load(b->q[0]),
                                   float8_multiply_add(dy, float8_load(b->q[1]), float8_mul(dz, float8_load(b->q[2]))));
    /* All of them with a positive determinant. */
    float8 sign = float8_sign(det), t = float8_flip(float8_load(b->t), sign);
    det = float8_flip(det, sign);
    u = float8_flip(u, sign);
    v = float8_flip(v, sign);
    /* Triangles that the ray may meet, in bounds widened by the errors of rounding. */
    float8 e = float8_load(b->e), e3 = float8_mul(e, float8_all(3)), slack = float8_load(b->slack);
    float8 min = float8_min(u, v), rest = float8_sub(det, float8_add(u, v));
    float8 before = float8_sub(float8_multiply_add(det, float8_all(p->limit[i]), slack), t);
    float8 inside = float8_min(float8_add(min, e), float8_add(rest, e3));
    unsigned met = b->used & float8_not_negative(float8_min(inside, float8_min(float8_add(t, slack), before)));
    if (!met)
        return;
    /* Those that it meets for certain, in bounds narrowed by them. */
    inside = float8_min(float8_sub(min, e), float8_sub(rest, e3));
    float8 ends = float8_sub(float8_multiply_sub(det, float8_all(p->certain[i]), slack), t);
    float8 begins = float8_sub(float8_sub(t, slack), float8_mul(det, float8_all(p->begun)));
    unsigned certain = met & float8_not_negative(float8_min(inside, float8_min(begins, ends)));
    /* A shadow ray ends at one for certain; others are decided in double precision. */
    if (any) {
        if (certain) {
            p->found |= UINT64_C(1) << i;
            p->alive &= ~(UINT64_C(1) << i);
            return;
        }
        for (; met && (p->alive >> i & 1); met &= met - 1)
            decide(p, i, b->ids[__builtin_ctz(met)], true);
        return;
    }
    /* The nearest: a certain one keeps bounds of its t, others are decided. */
    _Alignas(32) float from[WIDTH], to[WIDTH];
    if (certain) {
        float8_store(from, float8_div(float8_sub(t, slack), det));
        float8_store(to, float8_div(float8_add(t, slack), det));
    }
    for (; met; met &= met - 1) {
        unsigned k = (unsigned)__builtin_ctz(met);
        if (certain >> k & 1)
            keep(p, i, b->ids[k], from[k] * (1 - 0x1p-20f), to[k] * (1 + 0x1p-20f));
        else
            decide(p, i, b->ids[k], false);
    }
}

/* One triangle, a vector of rays. */
static inline __attribute__((always_inline)) void try_group(struct packet *p, const struct parts *b, unsigned k,
                                                            unsigned first, unsigned active, const bool any) {
    /* The steps are those of try_ray. */
    float_lanes dx = float_lanes_load(p->dx + first), dy = float_lanes_load(p->dy + first),
                dz = float_lanes_load(p->dz + first);
    float_lanes det = float_lanes_multiply_add(
        dx, float_lanes_all(b->n[0][k]),
        float_lanes_multiply_add(dy, float_lanes_all(b->n[1][k]), float_lanes_mul(dz, float_lanes_all(b->n[2][k]))));
    float_lanes u = float_lanes_multiply_add(
        dx, float_lanes_all(b->a[0][k]),
        float_lanes_multiply_add(dy, float_lanes_all(b->a[1][k]), float_lanes_mul(dz, float_lanes_all(b->a[2][k]))));
    float_lanes v = float_lanes_multiply_add(
        dx, float_lanes_all(b->q[0][k]),
        float_lanes_multiply_add(dy, float_lanes_all(b->q[1][k]), float_lanes_mul(dz, float_lanes_all(b->q[2][k]))));
    float_lanes sign = float_lanes_sign(det), t = float_lanes_flip(float_lanes_all(b->t[k]), sign);
    det = float_lanes_flip(det, sign);
    u = float_lanes_flip(u, sign);
    v = float_lanes_flip(v, sign);
    float_lanes e = float_lanes_all(b->e[k]), e3 = float_lanes_mul(e, float_lanes_all(3)),
                slack = float_lanes_all(b->slack[k]);
    float_lanes min = float_lanes_min(u, v), rest = float_lanes_sub(det, float_lanes_add(u, v));
    float_lanes before = float_lanes_sub(float_lanes_multiply_add(det, float_lanes_load(p->limit + first), slack), t);
    float_lanes inside = float_lanes_min(float_lanes_add(min, e), float_lanes_add(rest, e3));
    unsigned met =
        active & float_lanes_not_negative(float_lanes_min(inside, float_lanes_min(float_lanes_add(t, slack), before)));
    if (!met)
        return;
    inside = float_lanes_min(float_lanes_sub(min, e), float_lanes_sub(rest, e3));
    float_lanes ends = float_lanes_sub(float_lanes_multiply_sub(det, float_lanes_load(p->certain + first), slack), t);
    float_lanes begins = float_lanes_sub(float_lanes_sub(t, slack), float_lanes_mul(det, float_lanes_all(p->begun)));
    unsigned certain = met & float_lanes_not_negative(float_lanes_min(inside, float_lanes_min(begins, ends)));
    if (any) {
        p->found |= (uint64_t)certain << first;
        p->alive &= ~((uint64_t)certain << first);
        for (met &= ~certain; met; met &= met - 1)
            decide(p, first + (unsigned)__builtin_ctz(met), b->ids[k], true);
        return;
    }
    _Alignas(64) float from[FLOAT_LANES], to[FLOAT_LANES];
    float_lanes_store(from, float_lanes_div(float_lanes_sub(t, slack), det));
    float_lanes_store(to, float_lanes_div(float_lanes_add(t, slack), det));
    for (; met; met &= met - 1) {
        unsigned lane = (unsigned)__builtin_ctz(met);
        if (certain >> lane & 1)
            keep(p, first + lane, b->ids[k], from[lane] * (1 - 0x1p-20f), to[lane] * (1 + 0x1p-20f));
        else
            decide(p, first + lane, b->ids[k], false);
    }
}

static __attribute__((noinline)) void try_block(struct packet *p, uint32_t number, uint64_t rays, const bool any) {
    struct parts parts;
    split_block(p, number, &parts);
    unsigned used = (unsigned)__builtin_popcount(parts.used), groups = 0; /* the unused ones come last */
    for (unsigned g = 0; g < p->groups; g++)
        groups += (rays >> g * FLOAT_LANES & ALL_LANES) != 0;
    unsigned count = (unsigned)__builtin_popcountll(rays);
    p->tests += (uint64_t)count * WIDTH;
    if (count <= used * groups) {
        for (; rays; rays &= rays - 1)
            try_ray(p, &parts, (unsigned)__builtin_ctzll(rays), any);
        return;
    }
    for (unsigned g = 0; g < p->groups; g++) {
        unsigned active = (unsigned)(rays >> g * FLOAT_LANES & ALL_LANES);
        for (unsigned k = 0; k < used && active; k++)
            try_group(p, &parts, k, g * FLOAT_LANES, active, any);
    }
}

/* ---- the hierarchy ---- */

/* The rays that hit the box before their limits. */
static inline __attribute__((always_inline)) uint64_t meet_box(const struct packet *p, const float box[6],
                                                               uint64_t rays, const bool mixed) {
    uint64_t met = 0;
    /* If all rays have the same signs, the sides that they meet first are known. */
    float_lanes low_x = float_lanes_all(box[p->negative[0]]), high_x = float_lanes_all(box[!p->negative[0]]);
    float_lanes low_y = float_lanes_all(box[2 + p->negative[1]]), high_y = float_lanes_all(box[2 + !p->negative[1]]);
    float_lanes low_z = float_lanes_all(box[4 + p->negative[2]]), high_z = float_lanes_all(box[4 + !p->negative[2]]);
    for (unsigned g = 0; g < p->groups; g++) {
        unsigned first = g * FLOAT_LANES;
        uint64_t active = rays & ALL_LANES << first;
        if (!active)
            continue;
        /* The parameters of the six planes for a vector of rays. */
        float_lanes rx = float_lanes_load(p->rx + first), ry = float_lanes_load(p->ry + first),
                    rz = float_lanes_load(p->rz + first);
        float_lanes ax = float_lanes_mul(low_x, rx), ay = float_lanes_mul(low_y, ry), az = float_lanes_mul(low_z, rz);
        float_lanes bx = float_lanes_mul(high_x, rx), by = float_lanes_mul(high_y, ry),
                    bz = float_lanes_mul(high_z, rz);
        float_lanes enter, leave;
        if (mixed) {
            enter = float_lanes_max(float_lanes_max(float_lanes_min(ax, bx), float_lanes_min(ay, by)),
                                    float_lanes_max(float_lanes_min(az, bz), float_lanes_all(0)));
            leave = float_lanes_min(float_lanes_min(float_lanes_max(ax, bx), float_lanes_max(ay, by)),
                                    float_lanes_min(float_lanes_max(az, bz), float_lanes_load(p->limit + first)));
        } else {
            enter = float_lanes_max(float_lanes_max(ax, ay), float_lanes_max(az, float_lanes_all(0)));
            leave = float_lanes_min(float_lanes_min(bx, by), float_lanes_min(bz, float_lanes_load(p->limit + first)));
        }
        met |= active & (uint64_t)float_lanes_bits(float_lanes_less_equal(enter, leave)) << first;
    }
    return met;
}

/* Pushes the children of a node that the beam hits, the farthest first. */
static inline __attribute__((always_inline)) uint32_t push_children(struct packet *p, uint32_t number, uint64_t rays,
                                                                    struct pending_box *stack, uint32_t top) {
    /* The eight boxes, relative to the origin of the beam. */
    const struct wide_node *n = p->index->nodes + number;
    _Alignas(32) float box[6][WIDTH], t[WIDTH];
    float8 rows[6];
    for (int i = 0; i < 6; i++) {
        rows[i] = float8_sub(float8_load(n->bounds[i]), float8_all(p->shifted[i]));
        float8_store(box[i], rows[i]);
    }
    /* Along the axis of the beam, near comes before far. */
    float8 zero = float8_all(0), near = rows[2 * p->forward], far = rows[2 * p->forward + 1];
    if (p->backwards) {
        float8 swap = float8_sub(zero, near);
        near = float8_sub(zero, far);
        far = swap;
    }
    /* A box is outside if it lies behind, or beyond a side of the beam. */
    float8 outside = float8_sub(zero, far);
    for (int i = 0; i < 2; i++) {
        float8 low = rows[2 * p->side[i]], high = rows[2 * p->side[i] + 1];
        float8 max = float8_mul(p->slope_max[i] > 0 ? far : near, float8_all(p->slope_max[i]));
        float8 min = float8_mul(p->slope_min[i] > 0 ? near : far, float8_all(p->slope_min[i]));
        outside = float8_max(outside, float8_max(float8_sub(low, max), float8_sub(min, high)));
    }
    unsigned met = float8_bits(float8_less_equal(outside, zero));
    p->nodes++;
    if (!met)
        return top;
    /* The boxes that are met, sorted by insertion; t > 0 has the order of its bits. */
    float8_store(t, float8_max(near, zero));
    uint64_t order[WIDTH];
    unsigned count = 0;
    for (; met; met &= met - 1) {
        unsigned i = (unsigned)__builtin_ctz(met), slot = count++;
        uint32_t bits;
        memcpy(&bits, &t[i], sizeof bits);
        uint64_t entry = (uint64_t)bits << 32 | i;
        for (; slot > 0 && order[slot - 1] < entry; slot--)
            order[slot] = order[slot - 1];
        order[slot] = entry;
    }
    /* The farthest one is pushed first. */
    for (unsigned k = 0; k < count; k++) {
        unsigned i = (unsigned)order[k] & (WIDTH - 1);
        struct pending_box *w = &stack[top++];
        for (int j = 0; j < 6; j++)
            w->bounds[j] = box[j][i];
        w->reference = n->child[i];
        w->rays = rays;
    }
    return top;
}

static inline __attribute__((always_inline)) void traverse_all(struct packet *p, uint32_t root, const bool any,
                                                               const bool mixed) {
    struct pending_box stack[STACK_ENTRIES];
    uint32_t top = 0;
    if (root & REF_LEAF) {
        try_block(p, root & ~REF_LEAF, p->alive, any);
        return;
    }
    top = push_children(p, root, p->alive, stack, top);
    while (top > 0 && p->alive) {
        const struct pending_box *w = &stack[--top];
        uint64_t rays = meet_box(p, w->bounds, w->rays & p->alive, mixed);
        uint32_t reference = w->reference;
        if (!rays)
            continue;
        if (reference & REF_LEAF)
            try_block(p, reference & ~REF_LEAF, rays, any);
        else
            top = push_children(p, reference, rays, stack, top);
    }
}

static void traverse(struct packet *p, uint32_t root, const bool any) {
    if (any && p->mixed)
        traverse_all(p, root, true, true);
    else if (any)
        traverse_all(p, root, true, false);
    else if (p->mixed)
        traverse_all(p, root, false, true);
    else
        traverse_all(p, root, false, false);
}

/* ---- beginning ---- */

static float float_lanes_smallest(float_lanes a) {
    _Alignas(64) float x[FLOAT_LANES];
    float_lanes_store(x, a);
    float m = x[0];
    for (int i = 1; i < FLOAT_LANES; i++)
        m = x[i] < m ? x[i] : m;
    return m;
}

/* The planes around the rays, over the axis that is the longest for all of them. False: there is none. */
static bool set_beam(struct packet *p) {
    const float *d[3] = {p->dx, p->dy, p->dz};
    int z = fabsf(d[1][0]) > fabsf(d[0][0]);
    z = fabsf(d[2][0]) > fabsf(d[z][0]) ? 2 : z;
    p->forward = z;
    p->side[0] = (z + 1) % 3;
    p->side[1] = (z + 2) % 3;
    p->backwards = d[z][0] < 0;
    float_lanes min = float_lanes_all(INFINITY), slope_min[2], slope_max[2];
    for (int k = 0; k < 2; k++) {
        slope_min[k] = float_lanes_all(INFINITY);
        slope_max[k] = float_lanes_all(-INFINITY);
    }
    float_lanes turn = float_lanes_all(p->backwards ? -0.0f : 0.0f);
    const float *inverse[3] = {p->rx, p->ry, p->rz};
    for (unsigned g = 0; g < p->groups; g++) {
        min = float_lanes_min(min, float_lanes_flip(float_lanes_load(d[z] + g * FLOAT_LANES), turn));
        float_lanes over = float_lanes_flip(float_lanes_load(inverse[z] + g * FLOAT_LANES), turn);
        for (int k = 0; k < 2; k++) {
            float_lanes slope = float_lanes_mul(float_lanes_load(d[p->side[k]] + g * FLOAT_LANES), over);
            slope_min[k] = float_lanes_min(slope_min[k], slope);
            slope_max[k] = float_lanes_max(slope_max[k], slope);
        }
    }
    if (!(float_lanes_smallest(min) >= 0x1p-5f))
        return false;
    for (int k = 0; k < 2; k++) {
        p->slope_min[k] = float_lanes_smallest(slope_min[k]) - 0x1p-20f;
        p->slope_max[k] = -float_lanes_smallest(float_lanes_sub(float_lanes_all(0), slope_max[k])) + 0x1p-20f;
        p->slope_min[k] -= fabsf(p->slope_min[k]) * 0x1p-20f;
        p->slope_max[k] += fabsf(p->slope_max[k]) * 0x1p-20f;
    }
    /* The axes of the double-precision test: all rays have their longest component ahead, or they differ. */
    static const signed char kind[3][2] = {{0, 3}, {1, 4}, {2, 5}};
    p->axes = kind[z][p->backwards];
    const double *exact[3] = {p->rays->direction[0], p->rays->direction[1], p->rays->direction[2]};
    int differ = 0;
    for (unsigned i = 0; i < p->groups * FLOAT_LANES; i++)
        differ |= (fabs(exact[p->side[0]][i]) >= fabs(exact[z][i])) | (fabs(exact[p->side[1]][i]) >= fabs(exact[z][i]));
    if (differ)
        p->axes = -1;
    return true;
}

static double power_of_two(uint64_t exponent_bits) {
    double x;
    exponent_bits <<= 52;
    memcpy(&x, &exponent_bits, sizeof x);
    return x;
}

/* The largest component of the longest and of the shortest direction. False: one is not finite. */
static bool measure_rays(const struct ray_packet *rays, unsigned count, double *longest, double *shortest) {
    double max = 0, min = INFINITY;
    int bad = 0;
    for (unsigned i = 0; i < count; i++) {
        double x = fabs(rays->direction[0][i]), y = fabs(rays->direction[1][i]), z = fabs(rays->direction[2][i]);
        double size = x > y ? x : y;
        size = z > size ? z : size;
        max = size > max ? size : max;
        min = size < min ? size : min;
        bad |= !(x + y + z < INFINITY);
    }
    *longest = max;
    *shortest = min;
    return !bad;
}

/* False: these rays do not suit a packet. */
static bool begin(struct packet *p, uint64_t active) {
    const struct triangle_index *index = p->index;
    const struct ray_packet *rays = p->rays;
    double longest, shortest;
    p->groups = (rays->count + FLOAT_LANES - 1) / FLOAT_LANES;
    unsigned slots = p->groups * FLOAT_LANES;
    if (index->voxel_count != 27 || !(rays->t_min >= 0) || !measure_rays(rays, slots, &longest, &shortest))
        return false;
    double scaled = longest * index->scale;
    if (!(longest > 0x1p-900 && longest < 0x1p900) || !(shortest >= 0.5 * longest) ||
        !(scaled > 0x1p-900 && scaled < 0x1p900))
        return false;
    double o[3] = {(rays->origin.x - index->centre[0]) * index->scale,
                   (rays->origin.y - index->centre[1]) * index->scale,
                   (rays->origin.z - index->centre[2]) * index->scale};
    double away = 0;
    for (int k = 0; k < 3; k++) {
        if (!(fabs(o[k]) <= FARTHEST))
            return false;
        away = fabs(o[k]) > away ? fabs(o[k]) : away;
    }
    double far = away > 1 ? away : 1;
    uint64_t exponent;
    memcpy(&exponent, &scaled, sizeof exponent);
    exponent >>= 52;
    double shrink = index->scale * power_of_two(2045 - exponent), to_local = power_of_two(exponent + 1);
    p->t_to_local = to_local;
    float *const d[3] = {p->dx, p->dy, p->dz}, *const inverse[3] = {p->rx, p->ry, p->rz};
    p->mixed = false;
    for (int k = 0; k < 3; k++) {
        for (unsigned i = 0; i < slots; i++)
            d[k][i] = (float)(rays->direction[k][i] * shrink);
        unsigned any = 0, all = 1;
        for (unsigned g = 0; g < p->groups; g++) {
            float_lanes x = float_lanes_load(d[k] + g * FLOAT_LANES), sign = float_lanes_sign(x);
            /* A zero becomes so small that no way along it counts. */
            float_lanes size =
                float_lanes_min(float_lanes_size(float_lanes_div(float_lanes_all(1), x)), float_lanes_all(0x1p60f));
            float_lanes_store(inverse[k] + g * FLOAT_LANES, float_lanes_flip(size, sign));
            unsigned positive = float_lanes_not_negative(x);
            any |= positive != ALL_LANES;
            all &= positive == 0;
        }
        p->negative[k] = any && all;
        p->mixed |= any && !all;
    }
    if (!set_beam(p))
        return false;
    for (unsigned i = 0; i < slots; i++) {
        double end = rays->t_max[i] * to_local;
        end = end < 0x1p60 ? end : 0x1p60;
        p->limit[i] = (float)end * (1 + 0x1p-20f);
        p->certain[i] = (float)end * (1 - 0x1p-20f);
        p->best[i] = rays->t_max[i];
    }
    double start = rays->t_min * to_local;
    p->begun = start < 0x1p60 ? (float)start * (1 + 0x1p-20f) : 0x1p60f;
    float slack = (float)(1 + far) * 0x1p-21f;
    for (int k = 0; k < 3; k++) {
        p->origin[k] = (float)o[k];
        p->shifted[2 * k] = p->origin[k] + slack;
        p->shifted[2 * k + 1] = p->origin[k] - slack;
    }
    p->error = (float)(away * 13 * 0x1p-24 + far * 8 * 0x1p-46);
    p->alive = active;
    p->found = p->pending = p->tests = p->nodes = 0;
    return true;
}

static void search(struct packet *p, struct triangle_cost *cost, const bool any) {
    const struct triangle_index *index = p->index;
    if (index->big)
        traverse(p, index->big, any);
    if (index->only != REF_EMPTY)
        traverse(p, index->only, any);
    cost->triangle_tests += p->tests;
    cost->hierarchy_steps += p->nodes;
}

bool PACKET(nearest)(const struct triangle_index *index, const struct triangle_set *set, const struct ray_packet *rays,
                     uint64_t active, struct packet_hits *hits, uint64_t *answer_bits, struct triangle_cost *cost) {
    struct packet p;
    p.index = index;
    p.set = set;
    p.rays = rays;
    p.hits = hits;
    if (!begin(&p, active))
        return false;
    for (unsigned g = 0; g < p.groups; g++)
        float_lanes_store(p.nearer + g * FLOAT_LANES, float_lanes_all(INFINITY));
    search(&p, cost, false);
    decide_candidates(&p);
    *answer_bits = p.found;
    return true;
}

bool PACKET(any)(const struct triangle_index *index, const struct triangle_set *set, const struct ray_packet *rays,
                 uint64_t active, uint64_t *answer_bits, struct triangle_cost *cost) {
    struct packet p;
    p.index = index;
    p.set = set;
    p.rays = rays;
    p.hits = NULL;
    if (!begin(&p, active))
        return false;
    search(&p, cost, true);
    *answer_bits = p.found;
    return true;
}
