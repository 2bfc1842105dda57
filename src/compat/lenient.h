/* --lenient: errors in calls of gr become warnings, one for each kind and line (docs/language.md 12.5). */
#ifndef GRAY_COMPAT_LENIENT_H
#define GRAY_COMPAT_LENIENT_H

#include "call/context.h"

enum { LENIENT_WARNINGS = 1024, LENIENT_LIGHTS = 64 };

/* Lives in sandbox.keep; only with --lenient. */
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
};

/* Creates it: the calls of the context are lenient. False without memory. */
bool lenient_begin(struct script_context *context);
/* Changes the metatables of handles, and the functions of gr on numbers and vectors, after all have been made. */
void lenient_open(lua_State *L);
/* Pushes the field at index 2 of the handle at index 1 if the script has set it. */
bool lenient_own_field(lua_State *L);
/* The call of a function of gr: never an error of the scene. -1: *result is its result; else a substitute has been
 * pushed, of that many values. */
int lenient_call(struct script_context *context, const struct script_function *function, struct script_result *result);
void lenient_warn(struct script_context *context, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* A node that the script has created. */
void lenient_note_node(struct script_context *context, struct node *node);

#endif
