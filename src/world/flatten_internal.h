/* From the authoring tree to a list of primitives, in flattening order: a node's own surface first, then its
 * children as they were added. */
#ifndef GRAY_WORLD_FLATTEN_INTERNAL_H
#define GRAY_WORLD_FLATTEN_INTERNAL_H

#include "world/world.h"

struct material_table; /* distinct (material, texture) pairs */
struct linear_table;

/* The pose of a node: relative to the world, or to its nearest moving ancestor. */
struct pose {
    uint32_t above;             /* number of its link, or LINK_NONE: nothing above moves */
    struct transform from_node; /* to the space of `above`, or to the world */
};

/* A clipping solid; the pose of the node that it is an operand of. */
struct clip {
    const struct node *solid;
    struct pose pose;
    const struct clip *next;
};

/* The inherited graphics state for everything below a node. */
struct graphics_state {
    const struct clip *clips;
    const struct material *inherited; /* for shapes without a material */
    struct box limit;                 /* in the world: contains everything below */
};

/* How the primitives of a scene were made: the nodes that were visited, in order, so that the primitives of nodes with
 * other transforms can be updated. Zero value: nothing is recorded. */
struct flatten_record {
    const struct node *node;
    uint32_t index;     /* of the node */
    uint32_t above;     /* number of the record of the node above it, or RECORD_NONE */
    uint32_t placement; /* of the node above it, as in struct scene_step */
    uint32_t first;     /* its own primitives begin here; those of the next record follow */
};
#define RECORD_NONE UINT32_MAX
struct flatten_log {
    bool on; /* false, also after a part of the scene whose primitives cannot be updated */
    struct flatten_record *records;
    uint32_t count, capacity;
    uint8_t *inside; /* by node->index below node_total: the node is an operand, or below one; NULL: none is */
    uint32_t node_total;
    struct primitive *primitives;           /* those of the world */
    struct linear_table *linear_table;      /* of the world's maps, which have room for linear_capacity */
    uint32_t linear_capacity, linear_count; /* linear_count: when it was flattened */
};
void flatten_log_clear(struct flatten_log *log);

struct flattening {
    struct arena *arena; /* of the job: owns all results */
    struct scene *scene; /* its nodes are only read */
    struct world *world;
    struct pool *pool;
    bool linear_colours, encodes; /* as in struct world_input */
    world_warning *warn;          /* or NULL */
    void *warn_context;
    struct error *error;
    bool unqueried; /* no ray will query this world: its meshes get no index */
    struct primitive *primitives;
    struct box *limits; /* of each primitive, when there are any; else NULL */
    uint32_t primitive_capacity, prototype_capacity, linear_capacity, moving_capacity, link_capacity;
    uint32_t *prototype_of;            /* by node->index: index of its first prototype */
    struct linear_table *linear_table; /* the maps by their bits */
    struct material_table *materials;
    struct flatten_log *log; /* or NULL */
};

/* Fills world->primitives, prototypes, linear_maps, moving, links, and authored. Errors: cycles, too many primitives,
 * open operands of CSG, no memory. */
bool flatten_scene(struct flattening *f, const struct node *root);

/* False: the map of a node into the world, or into its solid, exceeds the range of doubles. */
bool flatten_check_transform(struct flattening *f, const struct node *node, const struct transform *t);
bool flatten_mesh_accel(struct flattening *f, const struct shape *shape);
/* Sets shifts and linear map of a placement. Maps that are equal to the bit are stored once. */
bool flatten_map(struct flattening *f, const struct transform *world_from_object, struct primitive *out);
void flatten_map_end(struct flattening *f); /* frees memory that only flattening needs, or gives it to the log */
void linear_table_destroy(struct linear_table *table);

/* Updates the primitives and boxes of a world, which a log belongs to, after the transforms of nodes have changed.
 * *done: false if the world must be built anew; then it may have been changed. Errors: a transform that is not finite,
 * no memory. */
bool flatten_update(struct flattening *f, const struct scene_changes *changes, bool *done);

#endif
