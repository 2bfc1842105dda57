/* The step of a search at a node, after the tests of the children's boxes: the nearest child is visited next, the
 * others go on the stack. The nearest child is not found by sorting: the node has a list of its lanes for the octant
 * of the direction (triangle_layout_internal.h). So there are no comparisons, and the only branch is whether any child
 * was hit; the list is correct nearly as often as sorting (T. Fuetterling et al., "Accelerated Single Ray Tracing for
 * Wide Vector Units", HPG 2017, order lanes in a similar way). The next child does not come from the stack just
 * written, since its load would wait for that store. */
#ifndef GRAY_ACCEL_TRIANGLE_NODES_INTERNAL_H
#define GRAY_ACCEL_TRIANGLE_NODES_INTERNAL_H

#include "accel/simd_internal.h"
#include "accel/triangle_layout_internal.h"

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
    simd8 enter, leave;
};

#if defined(__AVX2__) && !defined(GRAY_NO_SIMD)

static inline __m256i node_children(const struct wide_node *node) {
    return _mm256_load_si256((const __m256i *)(const void *)node->child);
}

#if defined(__AVX512VL__)
static inline void node_push_lanes(struct node_stack *stack, size_t top, __m256i children, unsigned lanes) {
    _mm256_storeu_si256((__m256i *)(void *)(stack->reference + top),
                        _mm256_maskz_compress_epi32((__mmask8)lanes, children));
}
static inline void node_push_enter(struct node_stack *stack, size_t top, simd8 enter, unsigned lanes) {
    _mm256_storeu_ps(stack->enter + top, _mm256_maskz_compress_ps((__mmask8)lanes, enter));
}
#else
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

static inline __m256i node_compressing(unsigned lanes) {
    return _mm256_cvtepu8_epi32(_mm_loadl_epi64((const __m128i *)(const void *)(node_lanes + lanes)));
}
static inline void node_push_lanes(struct node_stack *stack, size_t top, __m256i children, unsigned lanes) {
    _mm256_storeu_si256((__m256i *)(void *)(stack->reference + top),
                        _mm256_permutevar8x32_epi32(children, node_compressing(lanes)));
}
static inline void node_push_enter(struct node_stack *stack, size_t top, simd8 enter, unsigned lanes) {
    _mm256_storeu_ps(stack->enter + top, _mm256_permutevar8x32_ps(enter, node_compressing(lanes)));
}
#endif

/* False: no child is hit. Else *reference is the first child along the ray and the others are on the stack, the next
 * one on top. */
static inline bool node_take_nearest(const struct wide_node *node, uint32_t octant, struct node_span span,
                                     struct node_stack *stack, size_t *top, uint32_t *reference) {
    simd8 enter = span.enter, leave = span.leave;
    __m256i order =
        _mm256_srlv_epi32(_mm256_set1_epi32((int)node->order[octant]), _mm256_setr_epi32(0, 3, 6, 9, 12, 15, 18, 21));
    __m256i children = _mm256_permutevar8x32_epi32(node_children(node), order);
    _Alignas(32) uint32_t child[WIDTH];
    _mm256_store_si256((__m256i *)(void *)child, children);
    enter = _mm256_permutevar8x32_ps(enter, order);
    leave = _mm256_permutevar8x32_ps(leave, order);
    unsigned lanes = simd8_at_max_bits(enter, leave);
    if (!lanes)
        return false;
    /* Including the first one, which is stored above the top. */
    node_push_enter(stack, *top, enter, lanes);
    node_push_lanes(stack, *top, children, lanes);
    *top += (unsigned)__builtin_popcount(lanes) - 1;
    *reference = child[31 - __builtin_clz(lanes)];
    return true;
}

/* The same in any order and without where the ray enters. Boxes are larger than their contents by more than all
 * rounding errors, so a box that the ray leaves where it enters has no hit. */
static inline bool node_take_any(const struct wide_node *node, simd8 enter, simd8 leave, struct node_stack *stack,
                                 size_t *top, uint32_t *reference) {
    unsigned lanes = simd8_below_bits(enter, leave);
    if (!lanes)
        return false;
    *reference = node->child[__builtin_ctz(lanes)];
    lanes &= lanes - 1;
    node_push_lanes(stack, *top, node_children(node), lanes);
    *top += (unsigned)__builtin_popcount(lanes);
    return true;
}

#else

static inline bool node_take_nearest(const struct wide_node *node, uint32_t octant, struct node_span span,
                                     struct node_stack *stack, size_t *top, uint32_t *reference) {
    simd8 enter = span.enter, leave = span.leave;
    unsigned lanes = simd8_at_max_bits(enter, leave);
    if (!lanes)
        return false;
    _Alignas(32) float t[WIDTH];
    simd8_store(t, enter);
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

static inline bool node_take_any(const struct wide_node *node, simd8 enter, simd8 leave, struct node_stack *stack,
                                 size_t *top, uint32_t *reference) {
    unsigned lanes = simd8_at_max_bits(enter, leave);
    if (!lanes)
        return false;
    *reference = node->child[__builtin_ctz(lanes)];
    while (lanes &= lanes - 1)
        stack->reference[(*top)++] = node->child[__builtin_ctz(lanes)];
    return true;
}

#endif

#endif
