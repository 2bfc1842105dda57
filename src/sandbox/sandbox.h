/* A Lua state for an untrusted scene: what it may read, write and use, how it ends, and how errors are raised. Nothing
 * here knows what a scene is.
 *
 * An ordinary error is a Lua error with the complete first line as its string. What a script must not catch (out of
 * memory, cancelled, os.exit) is kept in `fatal` and `ended` while nil is raised; every function that could catch it
 * (pcall, xpcall, coroutine.resume, load ...) is replaced by a version that raises it again (protect.c). */
#ifndef GRAY_SANDBOX_SANDBOX_H
#define GRAY_SANDBOX_SANDBOX_H

#include "base/path_policy.h"
#include "sandbox/files.h"
#include "sandbox/limits.h"
#include "sandbox/message.h"

#include <stdarg.h>
#include <stdio.h>

/* Functions of the program; each gets `context`. */
struct sandbox_host {
    void *context;
    /* One complete line without newline. */
    void (*message)(void *context, enum script_message kind, const char *text);
    bool (*cancelled)(void *context); /* polled by a count hook; may be NULL */
    /* What the script writes to standard error (with the sandbox), and where `output_is_error` to standard output; the
     * text holds any bytes. NULL: the streams are those of the process. */
    void (*error_text)(void *context, const char *text, size_t size);
    bool output_is_error;
    void (*prints)(void *context); /* the script is about to print, or to write to a file; may be NULL */
};

/* The C function that the script has called, for messages: "gr.sphere: TEXT (node 'eye')". */
struct running_function {
    const char *owner, *name; /* "gr.", "sphere"; NULL: none */
    const char *subject;      /* the node it is about, or NULL */
};

/* A line of a script; the source by its address in the Lua state. */
struct script_line {
    const char *source;
    const void *key;
    int number;
};

enum { SUFFIX_SIZE = 32 };

struct recorder;

/* Lua's extra space points to it. The owner sets options, host, path_policy and files.path. */
struct sandbox {
    lua_State *lua; /* the thread that called last */
    const struct script_options *options;
    struct sandbox_host host;
    const struct path_policy *path_policy; /* what may be read and written; NULL: everything */
    struct arena keep;                     /* lives as long as the sandbox */
    struct arena call;                     /* arguments of one call */
    struct limits limits;
    struct files files;
    FILE *output, *errors; /* standard output and error of the script, if they differ from those of the process */
    struct running_function running;
    char error_suffix[SUFFIX_SIZE];    /* at the end of errors: " (frame 7)", or "" */
    struct script_line *checked_lines; /* sandbox_is_new_line: CHECKED_LINES of them, in `keep` */
    lua_State *hints;                  /* the state of hints.c; NULL until the first hint */
    size_t hint_bytes;                 /* of scripts read again for hints */
    char raised[1536];                 /* the last error of a C function, without its position */
    char refused[512];                 /* why io.open returned nil the last time, or "" */
    bool unforgivable;                 /* --lenient would not continue after it */
    bool is_positional;                /* the scene renders by positions, as scenes of other programs do */
    struct error fatal;
    bool ended; /* os.exit was called with success */
    /* Pushes a loader for a module that does not exist. NULL: that is an error. */
    void (*replace_module)(lua_State *L, const char *name);
    struct recorder
        *recorder; /* of functions; the module `record` sets it, and while it is silent nothing is printed */
    bool (*is_silent)(const struct recorder *recorder);
    /* Of a scene that is no script: writes the place of what is read, "nodes[3]: ", and takes it out of `raised` if it
     * is there. NULL: there is none. */
    void (*locate)(const struct sandbox *sandbox, char *out, size_t size);
};

struct sandbox *sandbox_of(lua_State *L);

/* Begins the account of memory, and sets `folder`. False: an error; sandbox_end is called in any case. */
bool sandbox_begin(struct sandbox *sandbox, struct error *error);
/* Adds the libraries, without the functions that an untrusted script must not have. Runs protected and may raise. */
void sandbox_open(lua_State *L);
/* After the state was closed. Returns the bytes that are still allocated. */
uint64_t sandbox_end(struct sandbox *sandbox);

/* Whether the script must end: code that catches errors raises them again. */
bool sandbox_is_over(const struct sandbox *sandbox);
/* A C function that is not one of the table begins. */
struct sandbox *sandbox_enter(lua_State *L);

/* The nearest Lua function on the stack with a known line; one of the scene before those of our library. */
bool sandbox_is_library(const struct sandbox *sandbox, const char *source);
bool sandbox_find_frame(lua_State *L, lua_Debug *frame);
const char *sandbox_frame_file(const lua_Debug *frame);
/* "scene.lua:12: " of that function, with "module.function: " if it has called a function of our library, or
 * "scene.lua: ". */
void sandbox_where(const struct sandbox *sandbox, char *out, size_t size);
/* The message of an error in our library with the position of the scene in front, and its own behind; others are the
 * same. May push values. */
const char *sandbox_relocate(lua_State *L, const char *message);
/* False if the current line was checked before. It may also be true then, because only some lines are stored. */
bool sandbox_is_new_line(struct sandbox *sandbox, const void *key);

/* "gr.sphere: TEXT (node 'eye')", always one line. */
void sandbox_compose(const struct sandbox *sandbox, const char *text, char *out, size_t size);
void sandbox_message(const struct sandbox *sandbox, enum script_message kind, const char *text);
/* "scene.lua:12: warning: LINE" */
void sandbox_warn_line(struct sandbox *sandbox, const char *line);
/* "scene.lua:12: warning: gr.sphere: TEXT (node 'x')" */
void sandbox_warn(struct sandbox *sandbox, const char *format, ...) __attribute__((format(printf, 2, 3)));
void sandbox_warn_list(struct sandbox *sandbox, const char *format, va_list arguments);

/* Raise "scene.lua:12: gr.sphere: TEXT (node 'x')". */
_Noreturn void sandbox_raise(struct sandbox *sandbox, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* Raises an error of a C function: script errors as above, others so that no script can catch them. */
_Noreturn void sandbox_raise_error(struct sandbox *sandbox, const struct error *error);
_Noreturn void sandbox_raise_fatal(lua_State *L);
_Noreturn void sandbox_raise_no_memory(struct sandbox *sandbox);

/* The type of the value at an index, in words: "a number", "a material", "nothing". Userdata have theirs in the field
 * WORDS_FIELD of their metatables. */
#define WORDS_FIELD "__words"
const char *value_words(lua_State *L, int index);

#endif
