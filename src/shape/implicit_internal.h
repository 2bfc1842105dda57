/* The regions of an implicit solid: made by implicit_regions.c, read by implicit_search.c. */
#ifndef GRAY_SHAPE_IMPLICIT_INTERNAL_H
#define GRAY_SHAPE_IMPLICIT_INTERNAL_H

#include "expr/expr_derivative.h"
#include "shape/implicit.h"

/* A node of the octree over the bounds is a number. Its lowest two bits are the kind. The other bits are, for
 * REGION_SPLIT, the index of the first of its eight parts, and for REGION_SURFACE the index of the region. Bit k of the
 * number of a part is set in the upper half of axis k; the halves meet at region_middle. */
enum { IMPLICIT_LEVELS = 8 }; /* at most, below the root */
enum region_kind { REGION_OUTSIDE, REGION_INSIDE, REGION_SURFACE, REGION_SPLIT };

/* A region in which the sign may change. Slopes bound the derivatives along the axes, rounded outwards. */
struct implicit_region {
    float low[3], high[3];
    float middle_low, middle_high; /* bounds of the function at the centre of the region; not finite if it is NaN */
    uint32_t program;              /* the function, shortened for the region */
};

struct implicit {
    struct implicit_input in; /* bounds: of a ball those around it */
    struct box tight;         /* around all that may be inside */
    double size;              /* the largest edge of the bounds */
    const uint32_t *nodes;
    const struct implicit_region *regions;
    const struct expr_program *programs; /* the whole one first */
    uint32_t node_count, region_count, program_count;
};

static inline double region_middle(double low, double high) {
    return low + (high - low) * 0.5;
}

/* Points of a line leave their region by rounding; by less than this share of the size. */
#define IMPLICIT_MARGIN 0x1p-42

/* Memory for the evaluators of expressions begins at a multiple of 64. */
enum { IMPLICIT_ALIGNMENT = 64 };
static inline void *implicit_aligned(void *memory) {
    return (void *)(((uintptr_t)memory + IMPLICIT_ALIGNMENT - 1) / IMPLICIT_ALIGNMENT * IMPLICIT_ALIGNMENT);
}

/* Parts of crossings: on a side of the bounds its axis, on a ball, between regions. All others are numbers of
 * regions. */
enum { IMPLICIT_PART_WHOLE = 0x7fffffe0, IMPLICIT_PART_BOX = 0x7ffffff0, IMPLICIT_PART_BALL = IMPLICIT_PART_BOX + 3 };

/* Larger memory for bounds is taken from the scratch, not from the stack. */
enum { IMPLICIT_STACK = 1 << 18 };

/* The share of the size to which a crossing is located. */
static inline double implicit_accuracy(const struct implicit *solid) {
    return solid->in.lipschitz > 0 ? 0x1p-38 : 0x1p-46;
}

struct vec3 implicit_middle(const struct implicit *solid);

#endif
