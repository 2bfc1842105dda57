/* The authoring tree: nodes with transforms, shapes, materials; a DAG, since a node may have several parents (an
 * instance, not a copy). Everything is in the arena of the scene; nothing is freed individually. Adding 100,000
 * children is linear. Cycles can be built here and are found by world_build, which names the nodes. */
#ifndef GRAY_SCENE_NODE_H
#define GRAY_SCENE_NODE_H

#include "base/arena.h"
#include "base/hash.h"
#include "base/list.h"
#include "light/light_edit.h"
#include "light/sky.h"
#include "material/material.h"
#include "math/affine.h"
#include "mesh/mesh.h"
#include "scene/assets.h"
#include "shape/shape.h"

#include <stdint.h>

/* Many placements of the children of one node, in a tenth of the memory of separate nodes. */

/* Placement i scales by size, rotates about the axis, then translates to its position; or it is matrix i. Everything
 * lives in the arena of the scene. */
struct placements {
    uint32_t count;
    const double (*at)[3];         /* count places; NULL with matrices */
    const double *turn, *size;     /* degrees; factors, not 0; NULL: none */
    bool one_turn, one_size;       /* only the first is used */
    int axis;                      /* of turn */
    const struct affine *matrices; /* count maps that have an inverse, or NULL */
};

struct transform placement_transform(const struct placements *placements, uint32_t i);

enum node_kind { NODE_GROUP, NODE_JOINT, NODE_GEOMETRY, NODE_CSG };
/* The faces of a mesh that rays ignore, by the order of their corners. Operands of CSG always have all faces. */
#define NODE_CULLS(X)                                                                                                  \
    X(CULL_NONE, "none")                                                                                               \
    X(CULL_BACK, "back")                                                                                               \
    X(CULL_FRONT, "front")
enum node_cull { NODE_CULLS(LIST_MEMBER) };
/* Whether a transparent surface is a wall without thickness, whose two sides have the same medium. WALLS_BY_SHAPE: if
 * it is open (flatten.c). */
enum node_walls { WALLS_BY_SHAPE, WALLS_THIN, WALLS_OF_SOLID };
/* A difference is the first operand minus the others, an inverse has one; of NODE_CLIPPED and NODE_BOUNDED the first
 * operand is the visible object, of any kind, and the second the solid that clips it, or that contains it. */
enum node_csg { NODE_UNION, NODE_INTERSECTION, NODE_DIFFERENCE, NODE_INVERSE, NODE_CLIPPED, NODE_BOUNDED };

/* docs/language.md 12.4: the composition of later calls. NEW: M = T * M; OLD: M = M * T; SEPARATE: T * R * S kept
 * apart. */
#define TRANSFORM_ORDERS(X)                                                                                            \
    X(TRANSFORM_ORDER_NEW, "new")                                                                                      \
    X(TRANSFORM_ORDER_OLD, "old")                                                                                      \
    X(TRANSFORM_ORDER_SEPARATE, "separate")
enum transform_order { TRANSFORM_ORDERS(LIST_MEMBER) };

struct node;
struct node_child {
    struct node *node;
    struct node_child *next;
};

/* A rotation at a constant rate, in the node's own space. */
struct node_spin {
    struct vec3 axis; /* not 0 */
    double degrees;   /* per second */
};

struct node {
    const char *name; /* never NULL */
    enum node_kind kind;
    uint32_t serial; /* order of creation, unique in a scene; as users see it */
    uint32_t index;  /* below the scene's node_total: for tables beside the nodes */
    bool has_parent; /* it was added to a node */
    bool singular;   /* some scale factor was 0: nothing under it is drawn */
    bool posed;      /* it is in scene_changes.posed */
    uint32_t child_count;
    struct node_child *first_child, *last_child;
    const struct placements *placements; /* or NULL: the children are instantiated once for each of them */
    struct transform *separate;          /* TRANSFORM_ORDER_SEPARATE only: translation, rotation, scaling; else NULL */
    struct transform parent_from_node;
    struct vec3 velocity;         /* in the parent's space, of every second */
    const struct node_spin *spin; /* or NULL */
    /* Or NULL: at time 1 this node has the pose of that node's own transforms. */
    const struct node *moves_to;
    /* A NODE_GROUP ends here: there may be millions, and scene_node takes no memory for the rest. */
    struct {
        double min, init, max;
    } joint_x, joint_y; /* NODE_JOINT, degrees */
    /* A NODE_JOINT ends here. */
    struct shape shape;              /* NODE_GEOMETRY */
    const struct material *material; /* may be NULL: plain gray and one warning */
    /* A mesh whose faces have slots: their materials, NULL for plain gray. `material`, where it is set, covers them
     * all. */
    const struct material *const *slots;
    const char *const *slot_names; /* as many, or NULL */
    uint32_t slot_count;
    enum node_cull cull;
    enum node_walls walls;               /* not of operands of solids */
    const struct texture_image *texture; /* set_texture: over kd of the material; the mapping is that of the shape */
    const struct bump *bump;             /* set_bump, likewise */
    enum node_csg operation;             /* NODE_CSG */
    uint32_t operand_count;
    struct node *const *operands;
    const char *file; /* the scene's file and line when the node was made; line 0: unknown */
    uint32_t line;
};

/* A node, a light or a texture that a change adds (scene/change.h), kept for the next time. */
struct added_node {
    uint32_t number;
    int kind; /* of the change */
    const char *call;
    const struct node *source; /* of a copy */
    void *object;              /* a node, a scene_light or a texture */
    struct material *material; /* that a shape has got, or NULL */
    struct added_node *next;
};

/* The same of a material that a change gives to one shape: a copy of another, link by link. */
struct own_material {
    uint32_t number;
    const struct material *like;
    struct material **links; /* from the first to the base */
    uint32_t count;
    struct own_material *next;
};

/* What has changed since a world of an animation was built from the scene (struct world_cache). */
enum { SCENE_POSED_MAX = 1024 };
struct posed_node {
    struct node *node;
    struct digest before; /* of its transform in that world */
};
struct scene_changes {
    bool other; /* something else than transforms of nodes, or transforms of more nodes */
    uint32_t posed_count;
    struct posed_node posed[SCENE_POSED_MAX]; /* nodes whose transforms were set, each once */
};

/* The diffuse colour of shapes without a material in the light of a studio, and of models. */
#define STUDIO_GRAY 0.85

enum { SCENE_NAMES = 64 };
struct scene {
    struct arena arena;
    const char *names[SCENE_NAMES]; /* names of nodes made lately, by hash: most are used again */
    struct assets *assets;          /* not owned */
    uint64_t epoch; /* while it does not change, an address in the arena or the store always means the same object */
    uint32_t node_count, material_count;
    uint32_t node_total; /* nodes made so far, those of changes too */
    uint8_t *warned;     /* by index: the warning about the node is out; has room for warned_room */
    uint32_t warned_room;
    struct added_node *added;
    struct own_material *own;
    struct material *last_material; /* they are linked from the newest to the oldest */
    uint32_t kept_nodes;            /* of a snapshot: nodes with a smaller index are older */
    bool escaped;                   /* an older object refers to a newer one */
    struct scene_changes changes;
    enum transform_order order;
    bool studio;      /* the studio light acts: shapes without a material are light gray, without a warning */
    bool is_model;    /* of a model of the command line: the same, and model_scene.lua is the script */
    bool spins;       /* some node does */
    double time;      /* seconds since the first frame, for spins; scene_set_time */
    const char *file; /* of the script: nodes that are made get them; line 0: unknown */
    uint32_t line;
};
void scene_init(struct scene *scene, struct assets *assets);
void scene_destroy(struct scene *scene);

/* A copy of the text in the scene's arena; equal texts in succession share one copy. NULL: no memory. */
const char *scene_keep_text(struct scene *scene, const char *text);

/* The objects that a frame of an animation creates are freed after it if nothing refers to them: scene_snapshot before
 * the frame, then scene_rewind. The caller knows the references that scripts hold; scene->escaped states whether older
 * parts of the scene refer to newer ones. Serial numbers are never used again, indices are. */
struct scene_snapshot {
    struct arena_mark arena;
    uint32_t node_total, warned_room;
    uint8_t *warned;
    struct material *last_material;
    struct asset_mesh *meshes;
};
struct scene_snapshot scene_snapshot(struct scene *scene);
/* Newer meshes of tables leave the store, too; meshes of files stay. */
void scene_rewind(struct scene *scene, const struct scene_snapshot *snapshot);
/* Must be called when a node that may be part of a world changes, except for its transforms. (Changes of
 * scene/change.h are never part of a world that is kept.) */
static inline void scene_note_change(struct scene *scene) {
    scene->changes.other = true;
}
/* Before a frame. Its spins differ from those of the frame before. */
static inline void scene_set_time(struct scene *scene, double time) {
    if (scene->spins && scene->time != time)
        scene_note_change(scene);
    scene->time = time;
}
/* Whether something has changed since scene_forget_changes; not if transforms were set and are as before. */
bool scene_has_changes(const struct scene *scene);
void scene_forget_changes(struct scene *scene);
/* Must be called when a node gets a reference, or memory of its own. */
static inline void scene_note_reference(struct scene *scene, uint32_t node_index) {
    scene_note_change(scene);
    scene->escaped = scene->escaped || node_index < scene->kept_nodes;
}

struct node *scene_node(struct scene *scene, enum node_kind kind, const char *name, struct error *error);
bool node_add_child(struct scene *scene, struct node *parent, struct node *child, struct error *error);
/* Whether `part` is the node or below it. It stops after `budget` steps (at most a thousand, since it recurses), with
 * false if it has not found it. */
bool node_holds(const struct node *node, const struct node *part, int *budget);
enum node_step { NODE_TRANSLATE, NODE_ROTATE, NODE_SCALE, NODE_STEPS };
/* A NODE_CSG over these, which are copied. */
struct node *scene_combine(struct scene *scene, const char *name, enum node_csg operation, struct node *const *operands,
                           uint32_t count, struct error *error);
/* Applies one transform in the scene's order. False: no memory (only TRANSFORM_ORDER_SEPARATE needs any). */
bool node_transform(struct scene *scene, struct node *node, enum node_step step, const struct transform *by);
/* Forgets all transforms. */
void node_reset_transform(struct scene *scene, struct node *node);
/* Everything from the node to its parent, joint angles included (y after x). */
struct transform node_parent_from_node(const struct node *node);
/* Of geometry: a mesh without triangles has none. */
static inline bool node_has_surface(const struct node *node) {
    return node->kind == NODE_GEOMETRY && (node->shape.kind != SHAPE_MESH || mesh_triangle_count(node->shape.mesh) > 0);
}
/* Shows what is under its first operand, cut open or bounded by the second. */
static inline bool node_is_placing(const struct node *node) {
    return node->kind == NODE_CSG && (node->operation == NODE_CLIPPED || node->operation == NODE_BOUNDED);
}
/* True once for each node: a warning about it is due. */
bool scene_warns(struct scene *scene, const struct node *node);
static inline bool node_moves(const struct node *node) {
    return (node->moves_to && node->moves_to != node) || vec3_max_abs(node->velocity) > 0 || node->spin;
}
struct material *scene_material(struct scene *scene, enum material_kind kind, const struct material *base,
                                struct error *error);

/* A light as scripts and changes say it; a world has the light alone, with the lists, the mesh and the sky resolved. */
struct scene_light {
    struct light light;
    const struct node *node; /* of a mesh light: all meshes there and below; its colour multiplies their emission */
    /* The nodes (with everything under them) that it lights, or does not; NULL: no such list. Arrays of the script. */
    const struct node *const *include, *const *exclude;
    uint32_t include_count, exclude_count;
    struct sky_turn sky_turn; /* the sky of an environment is to be turned further */
};

#endif
