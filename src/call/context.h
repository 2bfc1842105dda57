/* The state of a call of gr: the sandbox, the scene it builds, the function that runs. */
#ifndef GRAY_CALL_CONTEXT_H
#define GRAY_CALL_CONTEXT_H

#include "call/function.h"
#include "call/handle.h"
#include "sandbox/sandbox.h"

struct lenient;
struct function_warnings;

struct script_context {
    struct sandbox sandbox; /* the first member: Lua's extra space points to both */
    struct scene scene;
    struct handles handles;
    const struct script_function *function; /* the one that runs */
    bool draws;                             /* the function `draw` of gr.frames runs */
    struct function_warnings *warned;
    const char *line_source; /* context_note_line: the source that scene.file is of */
    struct lenient *lenient; /* NULL without --lenient */
    /* While the scene is written: an argument at a stack index was read; it may raise. Else NULL. */
    void (*noted)(struct script_context *context, int index, const struct script_parameter *parameter,
                  const struct script_value *value);
    /* With it: the node or material that stands for a ghost, or NULL; if `make` is set, a missing node is created. */
    void *(*ghost_as)(struct script_context *context, const struct handle *ghost, enum handle_type type, bool make);
};

struct script_context *context_of(lua_State *L);
/* A function of the table begins. */
void context_begin_call(struct script_context *context, const struct script_function *function);

/* The functions of gr, even if the script has replaced them, with --lenient: keeps the table on top, which is popped;
 * pushes it. */
void context_keep_functions(lua_State *L);
void context_push_functions(lua_State *L);

/* Whether a value is the table gr, as the first argument of gr:sphere(...) is. */
bool context_is_gr(lua_State *L, int index);

enum {
    WARNED_EXTRA = 1,
    WARNED_OTHER = 2,
    WARNED_FRACTION = 4,
    WARNED_BYTES = 8,
    WARNED_RADIANS = 16,
    WARNED_SLOW = 32
};
/* Warns once for each function and bit. */
void context_warn_once(struct script_context *context, unsigned bit, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
/* Warns once for a function if the colour has numbers from 0 to 255. */
void context_warn_of_bytes(struct script_context *context, const char *name, struct colour colour);
/* Warns once for a function if a number of degrees is a multiple or a simple fraction of pi. */
void context_warn_of_radians(struct script_context *context, const char *name, double degrees);
/* Nodes that are created from now on have the current line. */
void context_note_line(struct script_context *context);
/* Of a picture that is named after the script: SCENE and this end. */
void context_picture_name(const struct script_context *context, const char *end, char *out, size_t size);
/* The same for any script or model. */
void context_name_of_picture(const char *path, const char *end, char *out, size_t size);
/* An array that lives as long as the call. Raises an error without memory. */
void *context_array(struct script_context *context, size_t count, size_t size);
/* The contents of the handle of a texture; NULL with an error. */
struct script_texture *context_keep_texture(struct script_context *context, const struct script_texture *value,
                                            struct error *error);

#endif
