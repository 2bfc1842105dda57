/* What csg_build prepares for the sweep in csg.c; private to the two. */
#ifndef GRAY_CSG_CSG_BUILD_INTERNAL_H
#define GRAY_CSG_CSG_BUILD_INTERNAL_H

#include "csg/csg.h"

#define CSG_NONE UINT32_MAX

/* An AND or an OR over any number of nodes and literals. */
struct csg_node {
    uint32_t parent;    /* CSG_NONE for the root */
    uint32_t threshold; /* true when so many children are: 1 for OR, all of them for AND */
};

/* A leaf in the tree. */
struct csg_literal {
    uint32_t parent; /* CSG_NONE for a mere surface, which is true nowhere */
    bool negated;
};

/* A binary tree over the leaves' boxes in depth-first order: a first child follows its parent, `skip` is where to go on
 * when the box is missed. */
struct csg_bound {
    struct box box;
    uint32_t skip;
    uint32_t first, count; /* into `order`; count 0: has children instead */
    bool unprobed;         /* nearly as large as its parent, one leaf, or the root: it is not tried */
};

struct csg_plan {
    struct csg_node *nodes;       /* the root of the solid is 0; a parent comes before its children */
    uint32_t clip_root;           /* CSG_NONE without a clip */
    bool starts_in, starts_shown; /* the truth of solid and clip while the line is outside every leaf */
    uint32_t *start_counts;       /* true children of each node while the line is outside every leaf */
    struct csg_literal *literals;
    struct box *own_boxes; /* of the leaves, in CSG space, padded */
    struct box *boxes;     /* what of them the nodes above leave: where a leaf matters */
    bool *as_it_is;        /* csg_from_leaf of a leaf changes nothing */
    struct csg_bound *bounds;
    uint32_t *order;
    uint32_t *needed; /* leaves that contain the whole solid; tested first, the ones that rays miss most often before
                         the others */
    bool *is_needed, *is_convex;
    uint32_t leaf_count, node_count, bound_count, needed_count;
    uint32_t state_items; /* scratch items that hold the truth of all nodes and leaves */
    double size;          /* largest coordinate of any leaf's box */
};

#endif
