/* What stands at a place of the picture: the first thing on the way through it, and which node that belongs to. */
#ifndef GRAY_APP_PICK_H
#define GRAY_APP_PICK_H

#include "base/error.h"
#include "math/affine.h"
#include "render/render.h"
#include "scene/change_look.h"

enum { PICK_PATH = 512, PICK_WORDS = 64 };

struct picked {
    bool hit;
    char path[PICK_PATH]; /* names with their order of creation, from the root to the node */
    char name[PICK_WORDS], shape[PICK_WORDS], material[PICK_WORDS];
    uint32_t serial, parent_serial; /* of the node, and of the one above it */
    char parent_name[PICK_WORDS];
    uint64_t way;               /* to it (app/marks.h); 0: not known */
    uint64_t solid;             /* of an operand: the way to the solid that was placed; else 0 */
    uint32_t levels;            /* nodes above it */
    int32_t up;                 /* as it was asked for, but no farther than there are nodes */
    uint32_t below;             /* operands below it on the way to the surface that was hit */
    uint32_t material_serial;   /* of the base, which can be changed; 0: it is plain gray */
    double look[LOOK_PARTS][3]; /* of that base */
    bool can_own;               /* a shape was hit and is told: it can be given a material of its own */
    double distance;            /* from the eye */
    struct vec3 position, normal;
    bool has_box;
    struct vec3 corners[8];          /* of a box round the node: bit 0 of the number is its first axis, and so on */
    struct affine world_from_parent; /* the space that the node stands in */
};

/* A name cut to this size; control characters become '?'. */
void pick_words(char out[PICK_WORDS], const char *text);

/* The ray through (x, y) of the whole picture, in pixels, with the camera of the job as it is at time 0. up: so many
 * nodes above the one that was hit; below 0: so many operands below it, if it is a combined solid. False: no memory, or
 * no such camera. */
bool pick_at(const struct render_job *job, const struct node *root, double x, double y, int32_t up, struct picked *out,
             struct error *error);

#endif
