/* --lenient: errors in calls of gr become warnings, one for each kind and line (docs/language.md 12.5). */
#ifndef GRAY_SCRIPT_LENIENT_INTERNAL_H
#define GRAY_SCRIPT_LENIENT_INTERNAL_H

#include "script/context_internal.h"

/* The result of a call of an unknown function. It accepts every call and index, contains the nodes of the call, and is
 * ignored if no value can replace it. */
struct ghost {
    const char *name;
    struct node *node; /* NULL until it has a child or a parent */
    const struct material *material;
    bool is_method; /* a call returns the node before the colon */
};

enum { LENIENT_WARNINGS = 1024, LENIENT_LIGHTS = 64 };

/* Lives in context->keep; only with --lenient. */
struct lenient {
    uint64_t warned[LENIENT_WARNINGS]; /* hashes */
    uint32_t warned_count;
    struct node **nodes; /* all that the script made, in order */
    uint32_t node_count, node_room;
    struct scene_light lights[LENIENT_LIGHTS]; /* the first lights that it made */
    uint32_t light_count;
    struct node *last; /* made or returned last */
    struct node *root; /* of the last gr.render that failed, or NULL */
    bool refused;      /* the name of a picture was refused: no other picture takes its place */
    bool nothing;      /* the arguments of the call describe a shape without extent */
};

/* lenient.c */
bool lenient_begin(struct script_context *context); /* false without memory */
/* The call of a function of gr: never an error of the scene. */
int lenient_call(lua_State *L, struct script_context *context, const struct script_function *function);
void lenient_warn(struct script_context *context, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* Pushes the original function of gr, even if the script has replaced it. */
void lenient_push_function(lua_State *L, const char *name);

/* A node that the script has created. */
void lenient_note_node(struct script_context *context, struct node *node);

/* lenient_handles.c */
void lenient_open(lua_State *L); /* after dispatch_open */
void lenient_push_ghost(lua_State *L, const char *name, bool is_method);
/* The node of the ghost, or NULL; if `make` is set, a missing node is created. */
void *lenient_ghost_as(struct script_context *context, const struct handle *ghost, enum handle_type type, bool make);
/* Pushes the field at index 2 of the value at index 1 if the script has set it. */
bool lenient_own_field(lua_State *L);
/* __index of handles without methods: ignores fields that do not exist, with a warning. */
int lenient_handle_index(lua_State *L);
/* Adds the arguments `first` to `last`, and the entries of tables among them, to the ghost at stack index `at`. */
void lenient_ghost_take(struct script_context *context, int at, int first, int last);

/* lenient_values.c: pushes the value at `index` in the form of the parameter, or nil. */
void lenient_convert(struct script_context *context, int index, const struct script_function *function,
                     const struct script_parameter *parameter, const struct script_value *args);
/* Pushes a value for an argument that is missing, or nil. */
void lenient_default(struct script_context *context, const struct script_function *function,
                     const struct script_parameter *parameter);
/* How well the value fits, from 0 (not at all) to 3. */
int lenient_fit(lua_State *L, int index, const struct script_parameter *parameter);

/* lenient_picture.c */
/* A unit cube in place of a missing mesh. */
struct node *lenient_placeholder(struct script_context *context, const char *name, const struct material *material,
                                 struct error *error);
/* A checker pattern in place of a missing picture: 4 x 3 squares, so that it can also be a sky. */
struct image *lenient_checks(struct script_context *context, struct error *error);
/* Makes scenes out of which no world can be built into ones that can be shown: combined solids of open or moving
 * operands become groups, the first operand alone for a difference. */
void lenient_simplify(struct script_context *context);
/* A camera that shows everything below the node. */
void lenient_camera(const struct node *root, struct camera *camera);
/* The root of a picture if the script names none, or NULL. */
struct node *lenient_root(struct script_context *context);
/* After the script: a picture of its scene if gr.render made none. `failed`: the script ended with an error. */
void lenient_last_picture(struct script_context *context, bool failed);
/* SCENE-lenient.png */
void lenient_picture_name(const struct script_context *context, char *out, size_t size);

#endif
