/* Messages between the two processes: their bodies, the check of a received one, and the layout of the film's memory,
 * which both processes map. Both are the same program, so bodies are plain structs; the supervisor checks every size
 * and every text, since the render process runs untrusted scenes. */
#ifndef GRAY_SESSION_MESSAGES_H
#define GRAY_SESSION_MESSAGES_H

#include "base/error.h"
#include "base/file.h"
#include "base/hash.h"
#include "film/film.h"
#include "film/render_statistics.h"
#include "math/box.h"
#include "settings/frame.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* From the render process to the supervisor, then from the supervisor to the render process. */
enum message_kind {
    MESSAGE_LINE = 1,      /* struct message_line: a line for the user */
    MESSAGE_BEGIN,         /* struct picture_request; answered by MESSAGE_FILM */
    MESSAGE_DONE,          /* struct picture_report; answered by MESSAGE_ANSWER when the files are written */
    MESSAGE_PREVIEW_REPLY, /* a command of the window is done (viewer/preview_messages.h); answered by
                            * MESSAGE_PREVIEW_COMMAND */
    MESSAGE_ABANDON,       /* no body: the picture in progress will not be finished; no answer */
    MESSAGE_SCRIPT,        /* struct message_script: a script has ended; no answer */
    MESSAGE_READ,          /* struct message_read: a file was read; no answer */
    MESSAGE_FRAME,         /* no body: the script begins another frame, its time counts from here; no answer */
    MESSAGE_MODEL, /* struct model_request: a model is to be written; answered by MESSAGE_FILM, with memory for its
                    * bytes if their number is known */
    MESSAGE_MODEL_WRITE, /* no body: the bytes are there; answered by MESSAGE_ANSWER when the file is written */
    MESSAGE_MODEL_END,   /* no body: the script goes on; no answer */
    MESSAGE_DEVICE, /* struct device_request: memory for a scene is wanted, or for orders; answered by MESSAGE_FILM */
    MESSAGE_AGAIN,  /* no body: all scripts have ended; answered, possibly much later, by MESSAGE_ANSWER: ok: run them
                     * again */
    MESSAGE_FILM,   /* struct message_answer, and on success the descriptor of the film's memory */
    MESSAGE_ANSWER, /* struct message_answer */
    MESSAGE_PREVIEW_COMMAND, /* with the descriptor of a film's memory for a larger pass */
    MESSAGE_WINDOW, /* between the viewer and the process of its window (viewer/window_channel.h), with the descriptor
                     * of a picture's memory */
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

/* Who names the file of a model: a script; -o; --bake. A solution of radiosity, and a scene as text, whose name is that
 * of -o, are written in the same way. */
enum model_role { MODEL_OF_SCRIPT, MODEL_OF_USER, MODEL_BAKED, MODEL_SOLUTION, MODEL_SCENE };
/* A file of a model. */
struct model_request {
    uint64_t size;         /* bytes; 0: a question before the work begins: can this file be written? */
    uint32_t role;         /* an enum model_role */
    uint32_t beside;       /* not 0: the file of its materials, .mtl in place of .obj */
    uint32_t number;       /* of a scene: of its picture or frame, from 1 */
    struct digest depends; /* of a solution: all that it depends on */
    char file[4096];       /* as the script wrote it */
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

/* size: bytes of the bundle of a scene, which come first; 0: they are there, a device process is to begin, and so many
 * groups of orders are to be made at a time, each with so many bytes for pixels. */
enum { DEVICE_SLOTS = 1024, DEVICE_ROOM = 1 << 26 };
struct device_request {
    uint64_t size;
    uint32_t slots, room; /* 1 to DEVICE_SLOTS, and at most DEVICE_ROOM */
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
        struct model_request model;
        struct device_request device;
        struct message_answer answer;
        struct message_script script;
        struct message_read read;
        char bytes[MESSAGE_SIZE_LIMIT];
    } body;
};

/* Whether sizes, texts and numbers are such that later code can rely on them: texts end in NUL, enums are known. The
 * bodies of the messages of a window are checked where they are read (viewer/preview_messages.h). */
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
