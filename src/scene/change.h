/* Edits of a scene in addition to its script: in the window, and again by a file that the window wrote.
 * They are applied to the scene when a picture is made, and removed afterwards; the same changes in the same order give
 * the same bits. Nodes and materials are identified by their order of creation, nodes also by name, lights by their
 * index in the list of the picture. */
#ifndef GRAY_SCENE_CHANGE_H
#define GRAY_SCENE_CHANGE_H

#include "base/list.h"
#include "light/light_edit.h"
#include "scene/change_material.h"
#include "scene/node.h"

/* In the order of application: an added object exists before it is changed. */
enum change_kind {
    CHANGE_ADD,       /* a new node under another */
    CHANGE_TRANSFORM, /* of a node: a map after its own, in its parent's space */
    CHANGE_GONE,      /* a node is not drawn */
    CHANGE_OWN,       /* a shape gets its own material */
    CHANGE_MATERIAL,  /* a part of a material's base */
    CHANGE_TEXTURE,   /* a texture is the kd of a material's base */
    CHANGE_ADD_LIGHT, /* a light, or a copy of one, at the end of the list */
    CHANGE_LIGHT,     /* a light is moved, rotated, scaled, its colour multiplied or replaced */
    CHANGE_DARK,      /* a light is removed */
    CHANGE_HIDDEN,    /* a node is not drawn in the window; not written as Lua */
    CHANGE_SOLO,      /* only a node, and what is below it, is drawn; not written as Lua */
    CHANGE_KINDS
};
enum { TURN_AT = 6, COLOUR_AT = 15 };
#define OWN_SERIAL (UINT32_MAX / 2)
/* Nodes and materials inside of an added object count from its part of these numbers, ADDED_PARTS for each. */
#define ADDED_PART_SERIAL (UINT32_MAX / 4 * 3)
#define ADDED_MATERIAL_SERIAL (UINT32_MAX / 4)
enum { ADDED_PARTS = 1 << 16 };

/* An added node or material, by its serial: its number from 1; 0: the script made it. */
uint32_t added_number(uint32_t serial);

enum { CHANGE_NAME = 64, CHANGE_LIMIT = 4096, CHANGE_NUMBERS = 18, CHANGE_CALL = 512 };

struct change {
    enum change_kind kind;
    /* Of the node, or of the one that the new node hangs under; of the material; the light's number, from 1. */
    uint32_t serial;
    char name[CHANGE_NAME]; /* of that node, cut; "" fits all */
    /* Of ADD, ADD_LIGHT and TEXTURE: the Lua call that makes the object, as "gr.torus{minor = 0.1}"; empty: it is a
     * copy. */
    char call[CHANGE_CALL];
    /* Of added objects, from 0; a node's serial is UINT32_MAX - number. Of OWN, counted separately: the material's
     * serial is OWN_SERIAL - number. */
    uint32_t number;
    /* A copy: the serial of the node to copy. OWN: that of the base to copy if the shape has no material; 0: plain
     * gray. ADD_LIGHT: the number of the light to copy. */
    uint32_t source;
    enum material_part part; /* of MATERIAL */
    bool turns, colours;     /* of LIGHT: it has a turn; a colour */
    /* PLACE: 3 rows of 4. ADD: a colour, for a shape whose call gives it no material. MATERIAL: as many as the part
     * has. LIGHT: a translation, three factors, and from TURN_AT on 3 rows of 3, from COLOUR_AT on a colour that
     * replaces its own. ADD_LIGHT: a translation, three factors. */
    double numbers[CHANGE_NUMBERS];
};

/* Zero value: none. Owner: the caller; change_list_destroy frees it. */
struct change_list {
    struct change *items;
    uint32_t count, room;
};
/* Two changes of the same object: the later one replaces the earlier one. */
bool change_same_target(const struct change *a, const struct change *b);
/* Puts the change into the list (replacing one of the same target, else in order of kind and number: the list does not
 * depend on the order of changes), or, with `present` false, removes it. False: no memory, or too many. */
bool change_list_set(struct change_list *list, const struct change *change, bool present);
const struct change *change_list_find(const struct change_list *list, const struct change *like);
void change_list_destroy(struct change_list *list);
/* Whether a change takes effect without building the world again. */
bool change_keeps_world(const struct change *change);

/* The report of a skipped change: the name of a node or a material that the script no longer makes. */
typedef void change_warning(void *context, const char *text);

struct changed_node {
    struct node *node;
    struct node before;              /* its first part, which all kinds have */
    struct node_child *end;          /* its last child before */
    const struct material *material; /* of a shape */
    struct node moved_end;           /* of a node that moves to another's place: that place, changed alike */
    struct node_child only;          /* its one child, of a node above a solo one */
};
struct changed_material {
    struct material *material;
    struct material before;
};
/* The changes applied to a scene. Owner: the caller; changes_remove removes and frees all of them. */
struct changed_scene {
    struct scene_light *lights; /* the list of the picture */
    uint32_t light_count;
    const struct sky *sky;      /* of an added light: it is the background; NULL: that of the picture */
    struct changed_node *nodes; /* in order */
    struct changed_material *materials;
    struct node **added;
    uint32_t node_count, material_count, added_count;
};
struct change_range {
    const struct change *items;
    uint32_t count;
};
/* Makes the object of the call of a change, in the arena of the scene: a node, a scene_light or a texture. Its parts
 * have the serials of the number of the change. An ERROR_SCENE: the call is wrong. */
struct change_maker {
    bool (*make)(void *context, const struct change *change, void **object, struct error *error);
    void *context;
};
/* What a picture shows, and changes are laid over. */
struct change_target {
    const struct change_maker *maker;
    struct scene *scene;
    struct node *root;
    const struct scene_light *lights;
    uint32_t light_count;
};
/* In order, one after the other; new nodes live in the arena of the scene. Errors: no memory. */
bool changes_lay_over(struct change_range changes, const struct change_target *target, change_warning *warn,
                      void *context, struct changed_scene *out, struct error *error);
void changes_remove(struct changed_scene *changed);
/* A base before all changes; NULL: it was not changed. */
const struct material *changes_before(const struct changed_scene *changed, uint32_t serial);

#endif
