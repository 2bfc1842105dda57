/* Picking: the first hit of the ray through a point of the picture, and its node. */
#ifndef GRAY_INSPECT_PICK_H
#define GRAY_INSPECT_PICK_H

#include "inspect/node_list.h"
#include "math/affine.h"
#include "render/render.h"
#include "scene/change_material.h"
#include "world/node_path.h"

/* The result of a click. */
enum { PICK_PATH = 512, PICK_NAME = 64 };

struct picked {
    bool hit;
    struct node_query path;    /* to the node; depth 0: it is too deep */
    char node_path[PICK_PATH]; /* the names and creation numbers from the root to the node */
    char name[PICK_NAME], shape[PICK_NAME], material[PICK_NAME];
    uint32_t serial, parent_serial; /* of the node, and of the one above it */
    char parent_name[PICK_NAME];
    uint64_t route;                        /* to it (preview/view_overlay_internal.h); 0: not known */
    uint64_t solid;                        /* of an operand: the route to the solid; else 0 */
    uint32_t levels;                       /* nodes above it */
    int32_t up;                            /* as requested, limited by the number of nodes */
    uint32_t below;                        /* operands below it on the path to the surface that was hit */
    uint32_t material_serial;              /* of the base material, which can be changed; 0: the default gray */
    double inputs[MATERIAL_PART_PARTS][3]; /* of that base */
    uint32_t idle_parts; /* bit k: part k changes nothing at the point, as glTF's metalness replaces ks */
    bool can_own;        /* a shape was hit and selected: it can be given a material of its own */
    double distance;     /* from the eye */
    struct vec3 position, normal;
    bool has_box;
    struct vec3 corners[8];          /* of a box around the node: bit 0 of the number is its first axis, and so on */
    struct affine world_from_parent; /* the space of the node */
};

/* A name cut to this size; control characters become '?'. */
void pick_copy_name(char out[PICK_NAME], const char *text);

/* A number for a route to a node: it distinguishes the routes to a node with several parents. */
uint64_t route_hash(const struct scene_step *steps, uint32_t depth);

struct pick_query {
    double x, y; /* pixels of the whole picture */
    int32_t up;  /* levels above the node that is hit; if negative, levels of operands below it, in a combined solid */
};
/* What the ray through a pixel hits, with the camera of the job as it is at time 0. False: no memory, or no such
 * camera. */
bool pick_at(const struct render_job *job, const struct node *root, struct pick_query query, struct picked *out,
             struct error *error);

/* The materials of a world in a tree of nodes: the number of them at its top, or rows of the list; and one of them, as
 * if a node with it were hit. */
void material_rows(const struct world *world, const struct node_query *query, struct node_rows *out);
void pick_material(const struct world *world, const struct node_query *query, struct picked *out);

/* The same for a node of the tree, at the middle of its box; a node of which nothing is drawn is not hit. */
bool pick_node(const struct render_job *job, const struct node *root, const struct node_query *query,
               struct picked *out, struct error *error);

#endif
