/* The options of the command line for scripts. */
#ifndef GRAY_SETTINGS_SCRIPT_OPTIONS_H
#define GRAY_SETTINGS_SCRIPT_OPTIONS_H

#include "base/list.h"
#include "settings/frame.h"

#include <stdbool.h>
#include <stdint.h>

#define SCRIPT_ORDERS(X)                                                                                               \
    X(SCRIPT_ORDER_AUTO, "auto")                                                                                       \
    X(SCRIPT_ORDER_NEW, "new")                                                                                         \
    X(SCRIPT_ORDER_OLD, "old")                                                                                         \
    X(SCRIPT_ORDER_SEPARATE, "separate")
enum script_order { SCRIPT_ORDERS(LIST_MEMBER) };

/* The axis of a model that points up. */
#define MODEL_UPS(X)                                                                                                   \
    X(MODEL_UP_AUTO, "auto")                                                                                           \
    X(MODEL_UP_Y, "y")                                                                                                 \
    X(MODEL_UP_Z, "z")
enum model_up { MODEL_UPS(LIST_MEMBER) };

struct script_define {
    const char *name, *value; /* -D name=value */
};

struct script_options {
    enum script_order transform_order;
    bool lenient;
    const char *dialect;    /* --dialect: a name or a file, or NULL */
    const char *sky;        /* --sky: a picture file, or NULL */
    const char *edits;      /* --edits: a Lua file, or NULL */
    const char *edits_text; /* Lua to run after it, before the script: the edits of a window, or NULL */
    const char *camera;     /* --camera: its name or number in the model, or NULL */
    enum model_up up;       /* --up, of models */
    uint64_t seed;          /* math.random starts from it */
    const struct script_define *defines;
    int define_count;
    /* By setting (settings/setting.h): the text of its option, "" of an option without a value, or NULL: not given. */
    const char *const *given;
    uint64_t defaults; /* by setting, as bits: --default */
    /* The sandbox: what a script may read, write and use beyond the defaults (docs/security.md). */
    bool no_sandbox;
    const char *const *allow_read, *const *allow_write; /* folders */
    int allow_read_count, allow_write_count;
    uint64_t memory_limit; /* bytes; 0: 4 GiB, without the sandbox none */
    double time_limit;     /* seconds of processor time, rendering not counted; 0: 60, without the sandbox none */
    uint64_t output_limit; /* bytes printed and written; 0: 64 MiB, without the sandbox none */
    struct frame_options frames;
    const char *library_folder; /* absolute path of lua/ (data folder of the installation), on package.path last */
};

/* Whether the option of the setting was given, so that it has priority over the field, and whether it was or has a
 * value of --default. */
bool script_option_given(const struct script_options *options, int setting);
bool script_option_chosen(const struct script_options *options, int setting);

/* The limits under these options, those that were given or the usual ones; 0: none. Seconds, bytes, bytes. */
double script_time_limit(const struct script_options *options);
uint64_t script_memory_limit(const struct script_options *options);
uint64_t script_output_limit(const struct script_options *options);
/* Bytes that a script, its scene and a picture of it may use together; UINT64_MAX: no limit. */
uint64_t script_picture_memory(const struct script_options *options);

#endif
