/* The step of a search at a node, after the tests of the children's boxes: the nearest child is visited next, the
 * others go on the stack. The nearest child is not found by sorting: the node has a list of its lanes for the octant
 * of the direction (triangle_layout_internal.h). So there are no comparisons, and the only branch is whether any child
 * was hit; the list is correct nearly as often as sorting (T. Fuetterling et al., "Accelerated Single Ray Tracing for
 * Wide Vector Units", HPG 2017, order lanes in a similar way). The next child does not come from the stack just
 * written, since its load would wait for that store. */
#ifndef GRAY_ACCEL_TRIANGLE_NODES_INTERNAL_H
#define GRAY_ACCEL_TRIANGLE_NODES_INTERNAL_H

#include "accel/triangle_layout_internal.h"
#include "accel/triangle_vectors_internal.h"

enum { STACK_ROOM = STACK_ENTRIES + WIDTH }; /* pushing writes whole vectors */

/* References still to be visited, and where the ray enters them (only kept for a nearest search). Their number is a
 * separate variable, so that it stays in a register. enter[top], above them, is where the ray enters the visited
 * node. */
struct node_stack {
    float enter[STACK_ROOM];
    uint32_t reference[STACK_ROOM];
};

/* Where a ray enters and leaves the boxes of the children. */
struct node_span {
    float8 enter, leave;
};

#if defined(LANES_AVX2)

#if !defined(LANES_AVX512)
/* For every set of lanes, a list of their numbers, one byte each. */
#define LANE(set, i) ((set) >> (i)&1 ? UINT64_C(i) << 8 * __builtin_popcount((set) & ((1 << (i)) - 1)) : 0)
#define LANES(set)                                                                                                     \
    (LANE(set, 0) | LANE(set, 1) | LANE(set, 2) | LANE(set, 3) | LANE(set, 4) | LANE(set, 5) | LANE(set, 6) |          \
     LANE(set, 7))
#define LANES_4(set) LANES(set), LANES(set + 1), LANES(set + 2), LANES(set + 3)
#define LANES_16(set) LANES_4(set), LANES_4(set + 4), LANES_4(set + 8), LANES_4(set + 12)
#define LANES_64(set) LANES_16(set), LANES_16(set + 16), LANES_16(set + 32), LANES_16(set + 48)
static const uint64_t node_lanes[256] = {LANES_64(0), LANES_64(64), LANES_64(128), LANES_64(192)};
#undef LANE
#undef LANES
#undef LANES_4
#undef LANES_16
#undef LANES_64
#endif

/* Lanes in another order; clang has no expression for an order that is known only at run time. */
static inline float8 float8_permuted(float8 a, float8_integers order) {
    return _mm256_permutevar8x32_ps(a, (__m256i)order);
}
/* Some lanes, moved to the first ones: vectors of C can only be permuted by a constant order. */
static inline float8 float8_compressed(float8 a, unsigned lanes) {
#if defined(LANES_AVX512)
    return _mm256_maskz_compress_ps((__mmask8)lanes, a);
#else
    return float8_permuted(
        a, (float8_integers)_mm256_cvtepu8_epi32(_mm_loadl_epi64((const __m128i *)(const void *)(node_lanes + lanes))));
#endif
}
/* References are moved as floats: only their bits count. */
static inline float8 node_children(const struct wide_node *node) {
    return float8_load((const float *)(const void *)node->child);
}
static inline void node_push(struct node_stack *stack, size_t top, float8 children, unsigned lanes) {
    float8_store_any((float *)(void *)(stack->reference + top), float8_compressed(children, lanes));
}

/* False: no child is hit. Else *reference is the first child along the ray and the others are on the stack, the next
 * one on top. */
static inline bool node_take_nearest(const struct wide_node *node, uint32_t octant, struct node_span span,
                                     struct node_stack *stack, size_t *top, uint32_t *reference) {
    float8 enter = span.enter, leave = span.leave;
    const float8_integers shift = {0, 3, 6, 9, 12, 15, 18, 21},
                          all = (int32_t)node->order[octant] - (float8_integers){0};
    float8_integers order = all >> shift;
    float8 children = float8_permuted(node_children(node), order);
    _Alignas(32) uint32_t child[WIDTH];
    float8_store((float *)(void *)child, children);
    enter = float8_permuted(enter, order);
    leave = float8_permuted(leave, order);
    unsigned lanes = float8_less_equal_bits(enter, leave);
    if (!lanes)
        return false;
    /* Including the first one, which is stored above the top. */
    float8_store_any(stack->enter + *top, float8_compressed(enter, lanes));
    node_push(stack, *top, children, lanes);
    *top += (unsigned)__builtin_popcount(lanes) - 1;
    *reference = child[31 - __builtin_clz(lanes)];
    return true;
}

/* The same in any order and without where the ray enters. Boxes are larger than their contents by more than all
 * rounding errors, so a box that the ray leaves where it enters has no hit. */
static inline bool node_take_any(const struct wide_node *node, float8 enter, float8 leave, struct node_stack *stack,
                                 size_t *top, uint32_t *reference) {
    unsigned lanes = float8_less_bits(enter, leave);
    if (!lanes)
        return false;
    *reference = node->child[__builtin_ctz(lanes)];
    lanes &= lanes - 1;
    node_push(stack, *top, node_children(node), lanes);
    *top += (unsigned)__builtin_popcount(lanes);
    return true;
}

#else

static inline bool node_take_nearest(const struct wide_node *node, uint32_t octant, struct node_span span,
                                     struct node_stack *stack, size_t *top, uint32_t *reference) {
    float8 enter = span.enter, leave = span.leave;
    unsigned lanes = float8_less_equal_bits(enter, leave);
    if (!lanes)
        return false;
    _Alignas(32) float t[WIDTH];
    float8_store(t, enter);
    if (!(lanes & (lanes - 1))) {
        stack->enter[*top] = t[__builtin_ctz(lanes)];
        *reference = node->child[__builtin_ctz(lanes)];
        return true;
    }
    size_t end = *top;
    for (uint32_t order = node->order[octant], i = 0; i < WIDTH; i++, order >>= 3) {
        stack->enter[end] = t[order & 7];
        stack->reference[end] = node->child[order & 7];
        end += lanes >> (order & 7) & 1;
    }
    *reference = stack->reference[--end];
    *top = end;
    return true;
}

static inline bool node_take_any(const struct wide_node *node, float8 enter, float8 leave, struct node_stack *stack,
                                 size_t *top, uint32_t *reference) {
    unsigned lanes = float8_less_equal_bits(enter, leave);
    if (!lanes)
        return false;
    *reference = node->child[__builtin_ctz(lanes)];
    while (lanes &= lanes - 1)
        stack->reference[(*top)++] = node->child[__builtin_ctz(lanes)];
    return true;
}

#endif

#endif
