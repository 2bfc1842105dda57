/* The state of one run of a script: the Lua state, the scene it builds, the host it calls. Private to src/script.
 *
 * How errors are raised. An ordinary error is a Lua error with the complete first line as its string. What a script
 * must not catch (out of memory, cancelled, os.exit) is kept in `fatal` and `ended` while nil is raised; every function
 * that could catch it (pcall, xpcall, coroutine.resume, load ...) is replaced by a version that raises it again
 * (protect.c). */
#ifndef GRAY_SCRIPT_CONTEXT_INTERNAL_H
#define GRAY_SCRIPT_CONTEXT_INTERNAL_H

#include "base/list.h"
#include "base/mem.h"
#include "base/path_policy.h"
#include "scene/change.h"
#include "script/script.h"
#include "script/search_internal.h"
#include "script/table_internal.h"

#include <lua.h>
#include <stdio.h>

enum { PATH_SIZE = 4096, FILE_LIMIT = 1 << 28 };

/* Types, with their names in Lua and in messages. */
#define HANDLE_LIST(X)                                                                                                 \
    X(HANDLE_NODE, "node", "a node")                                                                                   \
    X(HANDLE_MATERIAL, "material", "a material")                                                                       \
    X(HANDLE_LIGHT, "light", "a light")                                                                                \
    X(HANDLE_TEXTURE, "texture", "a texture")                                                                          \
    X(HANDLE_FOG, "fog", "a fog")                                                                                      \
    X(HANDLE_SKY, "sky", "a sky")                                                                                      \
    X(HANDLE_GHOST, "ghost", "something this version does not have")
enum handle_type { HANDLE_LIST(LIST_MEMBER) };
enum { HANDLE_TYPES = LIST_COUNT(HANDLE_LIST) };

/* The contents of our userdata; no finalizer. The serial gives tables with handles as keys a fixed order. */
struct handle {
    enum handle_type type;
    uint32_t serial;
    void *pointer;
};

/* Every file that Lua has loaded, newest first: Lua shortens long names in messages, these are the full ones.
 */
struct source_name {
    const char *path;
    struct source_name *next;
};

/* How much of its limits the script has used (limits.c). */
struct limits {
    struct mem_account account; /* of everything allocated for the script; a limit of 0 means no limit */
    struct mem_account *charged_before;
    char memory_words[128];
    const void *refused_block; /* the last request that was refused: Lua repeats it after a garbage collection */
    size_t refused_size;
    bool memory_out;               /* a request was refused: the script ends, unless its repetition succeeds at once */
    bool refused_for_good;         /* the repetition, or another request, failed too */
    double time_begun, time_limit; /* seconds of this thread's processor time; a limit of 0 means no limit */
    uint64_t output, output_limit; /* bytes printed and written */
};

/* gr.change_view and gr.change_exposure: of the picture of that file name. */
struct changed_view {
    const char *picture;
    bool has_camera, has_exposure;
    struct camera camera;
    double exposure;
    struct changed_view *next;
};

struct recorder;
struct lenient;

/* A line of a script; the source by its address in the Lua state. */
struct script_line {
    const char *source;
    int number;
};
enum { CHECKED_LINES = 1024 };

struct script_context {
    lua_State *lua; /* the thread that called last */
    struct limits limits;
    const struct path_policy *path_policy; /* what may be read and written; NULL: everything */
    const struct script_options *options;
    const struct script_host *host;
    FILE *output, *errors; /* standard output and error of the script, if they differ from those of the process */
    struct scene scene;
    struct arena keep;      /* lives as long as the context */
    struct arena call;      /* arguments of one call */
    struct arena *out;      /* the caller's arena, for the traceback */
    const char *path;       /* the scene as the user named it */
    char folder[PATH_SIZE]; /* its folder with a final slash, or "" */
    const char *dialect;    /* the file of --dialect, or NULL */
    struct source_name *sources;
    struct file_search search;       /* for files that are not at the path in the script */
    struct source_name *found_names; /* the names of those that were found, with a notice for each */
    const void *metatables[HANDLE_TYPES];
    uint32_t handle_count;
    const struct script_function *function; /* the one that runs */
    const char *subject;                    /* the node it is about, or NULL */
    struct script_line *checked_lines;      /* context_is_new_line: CHECKED_LINES of them, in `keep` */
    const char *line_source;                /* context_note_line: the source that scene.file is of */
    uint8_t *warned;                        /* WARNED_ bits by row of the table */
    struct change *changes;                 /* gr.change_node and its like, in order; in `keep` */
    uint32_t change_count, change_room, added, owned;
    struct changed_view *views;   /* the newest first */
    bool changes_reported;        /* warnings that were omitted */
    bool number_repaired;         /* the notice about ".0" was printed */
    struct lenient *lenient;      /* NULL without --lenient */
    bool only_named_pictures;     /* struct order_finding */
    uint64_t overridden;          /* by options->given: the notice was printed */
    uint32_t pictures;            /* that gr.render has made */
    struct frame frame;           /* the one that is drawn; number 0: none */
    struct shutter frame_shutter; /* in frames: of gr.frames */
    bool animates;                /* in gr.frames */
    bool lists_handles;           /* new handles are listed for gr_frames.c */
    char raised[1536];            /* the last error of a function of gr, without its position */
    bool unforgivable;            /* --lenient would not continue after it */
    struct error fatal;
    struct recorder *recorder; /* record_internal.h */
    bool ended;                /* os.exit was called with success */
    const char *traceback;
    struct error failure; /* the message of a script error, made by the message handler */
};

enum { WARNED_EXTRA = 1, WARNED_OTHER = 2, WARNED_FRACTION = 4, WARNED_BYTES = 8 };

struct script_context *context_of(lua_State *L);

/* "scene.lua:12: " of the nearest Lua function on the stack, or "scene.lua: ". */
void context_where(const struct script_context *context, char *out, size_t size);
/* "scene.lua:12: warning: gr.sphere: TEXT (node 'x')" to the host. */
void context_warn(struct script_context *context, const char *format, ...) __attribute__((format(printf, 2, 3)));
void context_warn_once(struct script_context *context, unsigned bit, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
/* Warns once for a function if the colour has numbers from 0 to 255. */
void context_warn_of_bytes(struct script_context *context, const char *name, struct vec3 colour);
/* Nodes that are created from now on have the current line. */
void context_note_line(struct script_context *context);
/* False if the current line was checked before. It may also be true then, because only some lines are stored. */
bool context_is_new_line(struct script_context *context);
/* "gr.sphere: TEXT (node 'eye')", always one line. */
void context_compose(const struct script_context *context, const char *text, char *out, size_t size);
/* "gr.sphere" or "node:scale". */
const char *function_title(const struct script_function *function, char out[96]);
/* The parameter that takes any number of nodes, or NULL; and its index. */
const struct script_parameter *function_rest(const struct script_function *function, int *index);
/* An unknown field is an error: the first one in byte order, so that the message is always the same. */
void context_check_fields(struct script_context *context, const struct script_function *function, int table);

/* Raise "scene.lua:12: gr.sphere: TEXT (node 'x')". */
_Noreturn void context_raise(struct script_context *context, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
/* Raises an error of a C function behind a gr function: script errors as above, others so that no script can catch
 * them. */
_Noreturn void context_raise_error(struct script_context *context, const struct error *error);
_Noreturn void context_raise_fatal(lua_State *L);
_Noreturn void context_raise_no_memory(struct script_context *context); /* in the call of a gr function */

/* gr_changes.c: the changes by gr.change_... are applied to the scene before a picture is rendered, and undone after
 * it. */
bool changes_begin(struct script_context *context, struct render_request *request, struct changed_scene *changed,
                   struct error *error);

/* limits.c */
void limits_begin(struct script_context *context);
void limits_end(struct script_context *context);
void *limits_allocate(void *context, void *block, size_t old_size, size_t size); /* a lua_Alloc */
void limits_open(lua_State *L);                                                  /* sets the hook */
void limits_check(lua_State *L); /* raises when time or memory is used up or a stop is requested */
_Noreturn void limits_end_for_memory(lua_State *L);
void limits_output(lua_State *L, size_t size); /* to be called before this many bytes are written; may raise */
void limits_count_output(struct script_context *context,
                         size_t size); /* the same without raising; the next check raises */
/* Pause and resume the limits during work that is not the script's. */
void limits_pause(struct script_context *context);
void limits_resume(struct script_context *context);
/* The time limit starts here. */
void limits_restart_time(struct script_context *context);

/* context.c */
void handles_open(lua_State *L);
void handle_push(lua_State *L, enum handle_type type, void *pointer);
/* The handle at a stack index, or NULL for any other value. */
const struct handle *handle_at(lua_State *L, int index);
const char *handle_words(enum handle_type type);
const void *handle_key(enum handle_type type); /* the metatable is in the registry under this pointer */
/* The type of the value at an index, in words: "a number", "a material", "nothing". */
const char *value_words(lua_State *L, int index);

/* dispatch.c */
void dispatch_open(lua_State *L); /* the global gr */
void dispatch_push(lua_State *L, const struct script_function *function);
void dispatch_push_methods(lua_State *L); /* the table of the methods of nodes, by name */
int dispatch_answer(lua_State *L, const struct script_function *function, const struct script_result *result);

/* gr_frames.c: a handle on top of the stack that was made in a frame. */
void frames_list_handle(lua_State *L, uint32_t serial);
/* Calls `draw` of gr.frames for its frames and renders them; may raise. */
int frames_run(lua_State *L, const struct script_result *result);
void frames_open(lua_State *L); /* gr.time, gr.clock and gr.frame */
/* " (frame 7)" for errors, or "": an error before or after the frames of gr.frames belongs to no frame. */
enum { FRAME_WORDS = 32 };
void frames_name_frame(const struct script_context *context, char out[FRAME_WORDS]);

/* arguments.c: reads the arguments; may raise. Reads into args[0 .. parameter_count-1]. False: an argument is a ghost,
 * so the call has no effect. `first` is the stack index of the first argument. */
bool arguments_read(struct script_context *context, const struct script_function *function, int first,
                    struct script_value *args);
/* The same for one value, unless it is nil. */
bool arguments_read_one(struct script_context *context, int index, const struct script_parameter *parameter,
                        struct script_value *value);
/* Whether the arguments first to last are one table of named fields. */
bool arguments_have_names(lua_State *L, const struct script_function *function, int first, int last);
/* context.c: whether a value of this Lua type can be an argument of the kind. */
bool argument_resembles(lua_State *L, int index, enum kind kind, unsigned flags);

/* context.c: the nearest of the words by Damerau-Levenshtein distance if the distance is small enough, else NULL. */
struct suggestion {
    const char *word, *best;
    size_t distance;
};
void suggest_begin(struct suggestion *suggestion, const char *word);
void suggest_offer(struct suggestion *suggestion, const char *candidate);

/* files.c */
void files_open(lua_State *L);
/* Finds a file that the scene names; docs/language.md 12.3. */
bool files_find(struct script_context *context, const char *name, char out[PATH_SIZE]);
/* The same with the number in its name repaired, and with an error that names the folders that were searched. */
bool files_require(struct script_context *context, const char *name, char out[PATH_SIZE], struct error *error);
/* Searches for a file that does not exist under the name in a file of the scene in `folder`; prints a notice if it is
 * found. A model_search. */
bool files_search(void *context, const char *folder, const char *name, const char **path, bool *refused,
                  struct error *error);
/* The templates of package.path with `file` instead of the question marks: the first file that can be read. */
bool files_on_path(const struct script_context *context, const char *templates, const char *file, char path[PATH_SIZE]);
/* Drops the ".0" of whole numbers. The same pointer when there was none; NULL without memory. */
const char *files_repair_number(struct script_context *context, const char *name);
/* The policy for a Lua file; NULL for the scene and its dialect: the user named them, so they may be links to any file.
 * */
const struct path_policy *files_policy(const struct script_context *context, const char *path);
/* Loads a Lua file as text: pushes the chunk or a message and answers with the status. Raises what cannot be caught. */
int files_load(lua_State *L, const char *path);
/* File names that Lua has shortened are written in full again at the start of a message. */
const char *files_unshorten(struct script_context *context, const char *message); /* NULL without memory */

/* dialect.c */
bool dialect_add_folder(const struct script_options *options, struct path_policy *path_policy, struct error *error);
bool dialect_find(struct script_context *context, struct error *error); /* sets context->dialect */
void dialect_run(lua_State *L);                                         /* before the scene; may raise */
void dialect_finish(lua_State *L);                                      /* after it */

/* These add functions to a new state. All run protected and may raise. */
void sandbox_open(
    lua_State *L); /* sandbox.c: the libraries, without the functions that an untrusted script must not have */
/* Whether Lua's library has this function but the sandbox does not. */
bool sandbox_removes(const char *library, const char *name);
void streams_open(lua_State *L);                    /* streams.c: files and printing within what the scene was given */
void streams_close(struct script_context *context); /* after the state */
void protect_open(lua_State *L);                    /* protect.c */
/* Replaces library.name by `function`; the old function becomes its upvalue. */
void wrap_function(lua_State *L, const char *library, const char *name, lua_CFunction function);
void compat_open(lua_State *L);   /* compat.c: old Lua */
void traverse_open(lua_State *L); /* traverse.c: pairs in a fixed order */
void library_open(lua_State *L);  /* files.c: saves the globals for our own modules; called after all of these */
void define_open(lua_State *L);   /* script.c: -D */

/* files.c: the chunk on top of the stack, from the file `path`, sees the saved globals if it is one of ours. */
void library_adopt(lua_State *L, const char *path);

#endif
