/* The script layer: runs one Lua scene. It reads arguments, raises script errors, and passes plain C values on. It does
 * not handle pixels and opens no file by itself (base/file.h does). The host is a set of functions of the
 * application. */
#ifndef GRAY_SCRIPT_SCRIPT_H
#define GRAY_SCRIPT_SCRIPT_H

#include "base/error.h"
#include "base/hash.h"
#include "material/medium.h"
#include "sandbox/message.h"
#include "scene/change.h"
#include "settings/script_options.h"
#include "settings/settings.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* One gr.render call, complete and checked, with all defaults. Pointers live until the call returns. */
struct render_request {
    struct scene *scene;
    struct node *root;
    struct node *subject; /* what a model of the scene is: without the ground of a picture of a model */
    const char *file; /* as the script wrote it, with compatible number formats; relative to the working directory */
    double width, height; /* checked to be whole numbers in 1..2^20 */
    struct camera camera;
    struct colour ambient;
    struct medium outside; /* of all solids */
    const struct scene_light *lights;
    uint32_t light_count;
    struct sky sky;
    bool sky_chosen;           /* not the default */
    struct settings settings;  /* the host's settings, changed by the call's named fields */
    uint64_t replaced;         /* by setting, as bits: fields that have no effect because of an option */
    uint64_t fields;           /* the settings that the call's fields set: a bit by the index of each */
    uint32_t added;            /* nodes that gr.change_add has added: those of others are numbered from here on */
    uint32_t owned;            /* the same of materials and gr.change_own */
    struct change_maker maker; /* of what a window adds */
    bool keep;                 /* a picture that exists under this name is not replaced */
    bool changed;              /* gr.change_... has changed the scene for this picture */
    struct frame frame;        /* of an animation; else its number is 0 */
    double time;               /* seconds since the first frame */
    const char *where;         /* "scene.lua:12: gr.render", for messages that do not stop the script */
};

/* Of all that the picture shows except the nodes of the scene, which note their changes (scene/node.h). It is a digest
 * of the request's bytes, so it includes every field. Different padding only means that an equal frame is rendered. */
struct digest render_request_digest(const struct render_request *request);

/* One call of node:export, or the scene of a picture as the model of -o. */
struct export_request {
    struct scene *scene;
    struct node *node;
    const char *file;  /* as the script wrote it; NULL: that of -o */
    double tolerance;  /* 0: a thousandth of the size */
    int unit;          /* an enum model_unit */
    bool text;         /* an STL file that is not binary */
    bool linear;       /* colours are linear light */
    const char *where; /* as in struct render_request */
};

struct script_host {
    void *context;
    struct assets *assets;    /* meshes and images that outlive the script */
    struct settings settings; /* from the command line */
    double width, height;     /* of --size; 0: those of the script */
    /* Renders at once; false = stop the script with this error (an ERROR_SCENE is raised as a script error at the line
     * of the call, other kinds end the script without being catchable by pcall). */
    bool (*render)(void *context, const struct render_request *request, struct error *error);
    /* The same for models; may be NULL. */
    bool (*export_model)(void *context, const struct export_request *request, struct error *error);
    /* Takes the scene of a picture as text, in the place of `render`. NULL: it is rendered. */
    bool (*write_scene)(void *context, const struct render_request *request, const char *text, size_t size,
                        struct error *error);
    const char *text_file; /* where that is written; NULL: to no file */
    /* One complete line without newline, e.g. "scene.lua:3: warning: gr.sphere: ..." */
    void (*message)(void *context, enum script_message kind, const char *text);
    bool (*cancelled)(void *context); /* polled by a count hook; may be NULL */
    /* What the script writes to standard error (with the sandbox), and where `output_is_error` to standard output; the
     * text holds any bytes. NULL: the streams are those of the process. */
    void (*error_text)(void *context, const char *text, size_t size);
    bool output_is_error;
    void (*prints)(void *context); /* the script is about to print, or to write to a file; may be NULL */
    /* Animations; the functions may be NULL. A script without gr.frames runs once for each frame of --frames: `frame`
     * is the frame of this run, else its number is 0. The first run may still call gr.frames; `repeats` is set in the
     * later ones. */
    struct frame frame;
    bool repeats;
    uint32_t frame_limit;                /* of gr.frames; 0: FRAMES_MAX */
    bool checks;                         /* --check: a model lists its contents */
    uint32_t namesakes;                  /* models before this one whose picture has the same name */
    void (*animates)(void *context);     /* the script has called gr.frames */
    void (*frame_begins)(void *context); /* another frame of it: the script's time counts from here */
    /* For a window, or NULL: the number of the frame to render after `frame` (number 0: none yet); 0: no more. */
    uint32_t (*next_frame)(void *context, const struct frame *frame);
    void (*rewinds)(void *context); /* that frame is before the last drawn one: the script ends, and runs again */
};

struct path_policy;
/* Adds the folders that the script at `path` may read and write. */
bool script_path_policy(const char *path, const struct script_options *options, struct path_policy *path_policy,
                        struct error *error);

/* Runs the script at `path`. false: error.text is the complete first line, and *traceback (allocated in `arena`, lines
 * indented by two spaces, may be NULL) follows for script errors. */
bool script_run(const char *path, const struct script_options *options, const struct script_host *host,
                struct arena *arena, const char **traceback, struct error *error);

#endif
