/* The traversal of box_tree.h, compiled once per instruction set: a file defines TRAVERSAL(name) and includes this one.
 * The same operations in each, nothing fused, so the same items in the same order. */
#include "accel/box_tree.h"

#if defined(__SSE2__)
#include <immintrin.h>
#endif

/* Where the ray enters each child, and which children it meets before t_max (bit i for child i). */
#if defined(__AVX__)
static inline unsigned meet_children(const struct box_tree_traversal *traversal, const struct box_tree_node *node,
                                     double t_max, double enter_out[BOX_TREE_WIDTH], double leave_out[BOX_TREE_WIDTH]) {
    __m256d enter = _mm256_set1_pd(traversal->t_min), leave = _mm256_set1_pd(t_max);
    for (int axis = 0; axis < 3; axis++) {
        __m256d origin = _mm256_set1_pd(traversal->origin[axis]), inverse = _mm256_set1_pd(traversal->inverse[axis]);
        __m256d near = _mm256_load_pd(node->planes[axis][traversal->near_side[axis]]);
        __m256d far = _mm256_load_pd(node->planes[axis][!traversal->near_side[axis]]);
        /* max and min give their second operand when the first is NaN. */
        enter = _mm256_max_pd(_mm256_mul_pd(_mm256_sub_pd(near, origin), inverse), enter);
        leave = _mm256_min_pd(_mm256_mul_pd(_mm256_sub_pd(far, origin), inverse), leave);
    }
    _mm256_storeu_pd(enter_out, enter);
    _mm256_storeu_pd(leave_out, leave);
    /* The factor that moves the bound outwards. */
    __m256d less = _mm256_set1_pd(1 - 0x1p-50), more = _mm256_set1_pd(1 + 0x1p-50);
    __m256d early = _mm256_min_pd(_mm256_mul_pd(enter, less), _mm256_mul_pd(enter, more));
    __m256d late = _mm256_max_pd(_mm256_mul_pd(leave, less), _mm256_mul_pd(leave, more));
    return (unsigned)_mm256_movemask_pd(_mm256_cmp_pd(early, late, _CMP_LE_OQ));
}
#elif defined(__SSE2__)
static unsigned meet_children(const struct box_tree_traversal *traversal, const struct box_tree_node *node,
                              double t_max, double enter_out[BOX_TREE_WIDTH], double leave_out[BOX_TREE_WIDTH]) {
    unsigned met = 0;
    for (int half = 0; half < BOX_TREE_WIDTH; half += 2) {
        __m128d enter = _mm_set1_pd(traversal->t_min), leave = _mm_set1_pd(t_max);
        for (int axis = 0; axis < 3; axis++) {
            const double *near_planes = node->planes[axis][traversal->near_side[axis]] + half;
            const double *far_planes = node->planes[axis][!traversal->near_side[axis]] + half;
            __m128d origin = _mm_set1_pd(traversal->origin[axis]), inverse = _mm_set1_pd(traversal->inverse[axis]);
            /* max and min give their second operand when the first is NaN. */
            enter = _mm_max_pd(_mm_mul_pd(_mm_sub_pd(_mm_loadu_pd(near_planes), origin), inverse), enter);
            leave = _mm_min_pd(_mm_mul_pd(_mm_sub_pd(_mm_loadu_pd(far_planes), origin), inverse), leave);
        }
        _mm_storeu_pd(enter_out + half, enter);
        _mm_storeu_pd(leave_out + half, leave);
        /* The factor that moves the bound outwards. */
        __m128d less = _mm_set1_pd(1 - 0x1p-50), more = _mm_set1_pd(1 + 0x1p-50);
        __m128d early = _mm_min_pd(_mm_mul_pd(enter, less), _mm_mul_pd(enter, more));
        __m128d late = _mm_max_pd(_mm_mul_pd(leave, less), _mm_mul_pd(leave, more));
        met |= (unsigned)_mm_movemask_pd(_mm_cmple_pd(early, late)) << half;
    }
    return met;
}
#else
static unsigned meet_children(const struct box_tree_traversal *traversal, const struct box_tree_node *node,
                              double t_max, double enter_out[BOX_TREE_WIDTH], double leave_out[BOX_TREE_WIDTH]) {
    unsigned met = 0;
    for (int i = 0; i < BOX_TREE_WIDTH; i++) {
        double enter = traversal->t_min, leave = t_max;
        for (int axis = 0; axis < 3; axis++) {
            double near = (node->planes[axis][traversal->near_side[axis]][i] - traversal->origin[axis]) *
                          traversal->inverse[axis];
            double far = (node->planes[axis][!traversal->near_side[axis]][i] - traversal->origin[axis]) *
                         traversal->inverse[axis];
            enter = near > enter ? near : enter;
            leave = far < leave ? far : leave;
        }
        enter_out[i] = enter;
        leave_out[i] = leave;
        double early = enter * (enter > 0 ? 1 - 0x1p-50 : 1 + 0x1p-50);
        double late = leave * (leave > 0 ? 1 + 0x1p-50 : 1 - 0x1p-50);
        met |= (unsigned)(early <= late) << i;
    }
    return met;
}
#endif

bool TRAVERSAL(down)(struct box_tree_traversal *traversal, double t_max, uint32_t *item) {
    while (traversal->top > 0) {
        uint32_t child;
        if (!box_tree_take(traversal, t_max, &child))
            continue;
        if (child & BOX_TREE_ITEM) {
            *item = child & ~BOX_TREE_ITEM;
            return true;
        }
        const struct box_tree_node *node = &traversal->tree->nodes[child];
        double enter[BOX_TREE_WIDTH], leave[BOX_TREE_WIDTH], order[BOX_TREE_WIDTH];
        unsigned met = meet_children(traversal, node, t_max, enter, leave);
        traversal->steps++;
        /* The child that the ray leaves first must be on top: insertion sort of the few that were met. For disjoint
         * boxes this is also the order of entry; of two nested boxes the inner one comes first, and its hit shortens
         * the ray through the outer one (a teapot in a stadium). */
        int base = traversal->top;
        for (; met; met &= met - 1) {
            int i = __builtin_ctz(met), at = traversal->top++;
            for (; at > base && order[at - 1 - base] < leave[i]; at--) {
                order[at - base] = order[at - 1 - base];
                traversal->enter[at] = traversal->enter[at - 1];
                traversal->child[at] = traversal->child[at - 1];
            }
            order[at - base] = leave[i];
            traversal->enter[at] = enter[i];
            traversal->child[at] = node->child[i];
        }
    }
    return false;
}

bool TRAVERSAL(any)(struct box_tree_traversal *traversal, double t_max, uint32_t *item) {
    while (traversal->top > 0) {
        uint32_t child = traversal->child[--traversal->top];
        if (child & BOX_TREE_ITEM) {
            if (child == BOX_TREE_NONE) /* met only by rays that are not finite, through comparisons with NaN */
                continue;
            *item = child & ~BOX_TREE_ITEM;
            return true;
        }
        const struct box_tree_node *node = &traversal->tree->nodes[child];
        double enter[BOX_TREE_WIDTH], leave[BOX_TREE_WIDTH];
        unsigned met = meet_children(traversal, node, t_max, enter, leave);
        traversal->steps++;
        for (; met; met &= met - 1)
            traversal->child[traversal->top++] = node->child[__builtin_ctz(met)];
    }
    return false;
}
