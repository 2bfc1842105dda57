/* Messages between the two processes: their bodies, the check of a received one, and the layout of the film's memory,
 * which both processes map. Both are the same program, so bodies are plain structs; the supervisor checks every size
 * and every text, since the render process runs untrusted scenes. */
#ifndef GRAY_SESSION_MESSAGES_H
#define GRAY_SESSION_MESSAGES_H

#include "base/error.h"
#include "base/file.h"
#include "base/hash.h"
#include "math/affine.h"
#include "render/overlay.h"
#include "render/render.h"
#include "scene/change.h"
#include "scene/change_material.h"
#include "settings/frame.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* From the render process to the supervisor, then from the supervisor to the render process. */
enum message_kind {
    MESSAGE_LINE = 1,      /* struct message_line: a line for the user */
    MESSAGE_BEGIN,         /* struct picture_request; answered by MESSAGE_FILM */
    MESSAGE_DONE,          /* struct picture_report; answered by MESSAGE_ANSWER when the files are written */
    MESSAGE_PREVIEW_REPLY, /* struct preview_reply: a command of the window is done; answered by MESSAGE_PREVIEW_COMMAND
                            */
    MESSAGE_ABANDON,       /* no body: the picture in progress will not be finished; no answer */
    MESSAGE_SCRIPT,        /* struct message_script: a script has ended; no answer */
    MESSAGE_READ,          /* struct message_read: a file was read; no answer */
    MESSAGE_FRAME,         /* no body: the script begins another frame, its time counts from here; no answer */
    MESSAGE_AGAIN,  /* no body: all scripts have ended; answered, possibly much later, by MESSAGE_ANSWER: ok: run them
                     * again
                     */
    MESSAGE_FILM,   /* struct message_answer, and on success the descriptor of the film's memory */
    MESSAGE_ANSWER, /* struct message_answer */
    MESSAGE_PREVIEW_COMMAND, /* struct preview_command, with the descriptor of a film's memory for a larger pass */
};

/* The kind of a line: decides whether -q or --verbose print it, and on which stream. */
enum line_kind {
    LINE_ERROR,
    LINE_WARNING,
    LINE_NOTICE,
    LINE_DETAIL,
    LINE_OUTPUT /* a piece of the requested output: printed on standard output unchanged, no newline added */
};

enum { MESSAGE_TEXT_LIMIT = 16384, MESSAGE_SIZE_LIMIT = MESSAGE_TEXT_LIMIT + 64 };

struct message_line {
    enum line_kind kind;
    char text[MESSAGE_TEXT_LIMIT]; /* only the used bytes are sent, with the final NUL */
};

/* The result of a click (inspect/pick.h). */
enum { PICK_PATH = 512, PICK_NAME = 64 };

struct picked {
    bool hit;
    char path[PICK_PATH]; /* the names and creation numbers from the root to the node */
    char name[PICK_NAME], shape[PICK_NAME], material[PICK_NAME];
    uint32_t serial, parent_serial; /* of the node, and of the one above it */
    char parent_name[PICK_NAME];
    uint64_t route;                        /* to it (viewer/view_overlay_internal.h); 0: not known */
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

/* Zero value: none. */
struct view_overlay_request {
    struct overlay_request lines; /* none: OVERLAY_NONE */
    bool outline;                 /* of the node with this serial ... */
    uint32_t serial;
    uint64_t route; /* ... on this route (route_hash); 0: on all routes */
    uint64_t solid; /* of an operand: the route to the combined solid that it is in; else 0 */
};

struct view_overlay {
    bool stopped; /* before they were complete */
    bool has_lines, has_outline;
    struct film_rectangle outline; /* of the film, from 0; outside it the node is not visible */
};

/* Their offsets, for a picture in a window. */
struct view_overlay_buffers {
    float (*lines)[4]; /* as overlay_lines makes them */
    uint8_t *shows;    /* by pixel: not 0 where the node is visible */
};

/* A picture to be rendered. */
struct picture_request {
    uint32_t full_width, full_height; /* of the whole picture */
    uint32_t x0, y0, width, height;   /* the part that is rendered */
    struct film_rectangle shown;      /* the part of that which is written: less where it is denoised with a rim */
    struct settings settings;         /* the table of its tone curve is the next one */
    struct tone_table tone_table;     /* of TONE_FUNCTION */
    struct film_record record;        /* of its film */
    uint32_t layers;                  /* mask of the layers beside the picture */
    uint32_t in_window;               /* not 0: in a window */
    struct camera camera;             /* its view a direction */
    uint32_t keep;                    /* not 0: a picture that exists under this name is not replaced */
    uint32_t check;                   /* not 0 for --check: only the names are checked, no film is needed */
    struct digest files;              /* of all files read so far; zero if not needed */
    uint32_t repeats;                 /* not 0: equal to the last picture that this process rendered */
    struct frame frame;               /* of an animation, or number 0 */
    char file[4096];                  /* as the script wrote it */
};

/* The statistics of a finished picture. */
struct picture_report {
    struct render_statistics rays;
    double write_seconds, write_processor_seconds; /* of the files; filled by the process that writes them */
    uint64_t primitives, triangles;
    uint64_t node_bytes, mesh_bytes, image_bytes, primitive_bytes, search_bytes, film_bytes; /* memory by part */
    uint64_t peak_bytes;
    uint32_t grid_cells[3];
    int threads;
    struct box bounds; /* of the scene */
    uint32_t stopped;  /* not 0: a pass that was stopped */
};

/* A pass of a picture in a window. */
struct pass_view {
    struct camera camera;   /* its view a direction */
    double exposure;        /* stops: it decides which pixels are sampled again */
    uint32_t divide;        /* one pixel represents a square with this side; from 1 */
    bool plain;             /* one sample a pixel, coarse soft light */
    bool own;               /* the camera, lens and motion of the script */
    uint32_t width, height; /* not 0: so many pixels in place of those of the picture, in the memory of the command */
};

/* Lights of a scene are reported in groups of this size. */
enum { LIGHTS_PER_MESSAGE = 32 };
struct light_info {
    uint32_t kind;       /* an enum light_kind, for its name */
    uint32_t properties; /* of enum light_property */
    bool has_position;   /* its position is known */
    struct vec3 position, colour;
    struct vec3 direction, edge1, edge2; /* as in struct light, zero if it has none */
    double radius, cos_outer;
    bool moves, turns, sizes; /* the possible edits */
};

enum preview_reply_kind {
    REPLY_BUILT /* the world, for the first time */,
    REPLY_PASS,
    REPLY_PICKED,
    REPLY_CHANGED,
    REPLY_PIXEL_TRACE,
    REPLY_LIGHTS,
    REPLY_OVERLAY
};
/* The result of a command of the window; the render process waits for the next one. */
struct preview_reply {
    enum preview_reply_kind kind;
    struct picture_report report; /* of BUILT (its bounds) and PASS */
    struct picked picked;
    struct view_overlay overlay; /* of PASS, PICKED and OVERLAY: the parts that were requested and made */
    double built;                /* of BUILT: when, on progress_clock */
    uint32_t added;              /* of BUILT: nodes that the script has added by gr.change_add */
    uint32_t owned;              /* of BUILT: materials of gr.change_own */
    uint32_t root;               /* of BUILT: the serial of the root, and the space of its children */
    char root_name[PICK_NAME];
    struct affine world_from_root;
    uint32_t light_count; /* of BUILT, CHANGED and LIGHTS: all of them; those reported begin with first_light, from 0 */
    uint32_t first_light;
    struct light_info lights[LIGHTS_PER_MESSAGE];
    char text[512]; /* of CHANGED: why an edit failed, or empty */
    bool unbuilt;   /* of CHANGED: the building of the world was stopped; the next pass starts it again */
};

enum preview_command_kind {
    COMMAND_END,
    COMMAND_PASS,
    COMMAND_PICK,
    COMMAND_CHANGE,
    COMMAND_PIXEL_TRACE,
    COMMAND_LIGHTS,
    COMMAND_OVERLAY
};
struct preview_command {
    enum preview_command_kind kind;
    bool quit;             /* of END: the window was closed */
    struct pass_view view; /* of PASS, PICK, PIXEL_TRACE and OVERLAY */
    struct view_overlay_request
        overlay;          /* of PASS: made after it; of OVERLAY. After PICK the outline is that of the picked node */
    double x, y;          /* of PICK and PIXEL_TRACE: pixels of the whole picture */
    int32_t up;           /* of PICK: nodes above the one that is hit, or operands below it */
    uint32_t first_light; /* of CHANGE and LIGHTS: report lights from this one on, counted from 0 */
    struct change change;
    bool present; /* of CHANGE: it is applied; else it is undone */
    bool more;    /* of CHANGE: another change follows at once */
    void *block;  /* the memory that came along, or NULL; set by the receiver */
};

struct message_answer {
    bool ok;
    bool already; /* to MESSAGE_BEGIN: there is nothing to do, and no film is sent */
    struct error error;
};

struct message_script {
    int index;  /* into options.scripts */
    int status; /* the exit status for this script alone */
};

struct message_read {
    struct file_version version;
    bool written;    /* a script opened it for writing */
    char path[4096]; /* as it was requested: relative to the working directory, which both processes share */
};

/* A message as it was received: `size` bytes of body. */
struct message {
    enum message_kind kind;
    size_t size;
    int descriptor; /* that came along, or -1, that of a film also where it was lost; owned by the receiver */
    union {
        struct message_line line;
        struct picture_request request;
        struct picture_report report;
        struct preview_reply reply;
        struct preview_command command;
        struct message_answer answer;
        struct message_script script;
        struct message_read read;
        char bytes[MESSAGE_SIZE_LIMIT];
    } body;
};

/* Whether sizes, texts and numbers are such that later code can rely on them: texts end in NUL, enums are known. */
bool message_is_valid(const struct message *message);

/* The tone of the files of a picture. Its table is that of the request. */
struct tone picture_tone(const struct picture_request *request);

/* The same picture in another size, at least its own: only its film. False: it is too large. */
bool picture_request_enlarge(const struct picture_request *request, uint32_t width, uint32_t height,
                             struct picture_request *out);
/* Bytes of the memory of the film, layers and overlay included. False: too large. */
bool picture_film_size(const struct picture_request *request, size_t *bytes, struct error *error);
/* The film in that memory, with its layers and the part of the picture that it is. */
void picture_film_layout(const struct picture_request *request, void *block, struct film *film);
/* Where the overlay of a picture in a window is in that memory: behind the layers. */
void view_overlay_buffers(const struct picture_request *request, void *block, struct view_overlay_buffers *buffers);
/* The film of a pass in the same memory: the rectangle of the picture, divided. */
struct film pass_film(const struct picture_request *request, void *block, uint32_t divide);

/* The channel between supervisor and render process: a pair of sockets that keep the boundaries of messages. A message
 * is a kind and a body, whose size is fixed by the kind, or a text (messages.h). */

struct channel {
    int descriptor;
};

/* Two ends of a new channel; both are closed on exec. */
bool channel_pair(struct channel ends[2], struct error *error);
void channel_close(struct channel *channel);

/* Blocks until the message is handed over; false when the other side is gone. descriptor: one to pass along, or -1. */
bool channel_send(struct channel *channel, enum message_kind kind, const void *body, size_t size, int descriptor);
bool channel_send_line(struct channel *channel, enum line_kind kind, const char *text);

enum channel_result { CHANNEL_MESSAGE, CHANNEL_END, CHANNEL_BROKEN };
/* Blocks for one message. END: the other side is gone. BROKEN: the message is not valid. */
enum channel_result channel_receive(struct channel *channel, struct message *message);

#endif
