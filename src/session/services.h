/* The services of the supervisor for the render process, which opens no file for writing and owns no terminal. The
 * calls go over the channel or, with --no-fork, to the output session of the same process. */
#ifndef GRAY_SESSION_SERVICES_H
#define GRAY_SESSION_SERVICES_H

#include "film/film.h"
#include "session/control.h"
#include "session/messages.h"

#include <stdbool.h>

struct bundle;
struct list;
struct share;
struct preview_reply;
struct preview_command;

struct host_services {
    void *context;
    struct control *control;
    /* A film for the picture; under request->check only whether it could be written. *already: the picture is written,
     * or another process renders it; neither done nor abandon follows. */
    bool (*begin)(void *context, const struct picture_request *request, struct film *film, bool *already,
                  struct error *error);
    /* A command of the window is done: waits for the next one. False: the window is gone. */
    bool (*reply)(void *context, const struct preview_reply *reply, struct preview_command *command,
                  struct error *error);
    void (*abandon)(void *context);
    /* The film is complete. True if the files are written; with `early`, where there is a `settle`, it may return true
     * before. */
    bool (*done)(void *context, const struct picture_report *report, bool early, struct error *error);
    /* Waits until the files of the last picture are written. NULL: they are. */
    void (*wait)(void *context);
    /* The same. False: they cannot be written, reported once. NULL with `wait`. */
    bool (*settle)(void *context, struct error *error);
    /* Writes a file of a model: the bytes, or NULL to ask only whether it could be written, before the work begins;
     * then model_end follows in any case. */
    bool (*model)(void *context, const struct model_request *request, const void *bytes, struct error *error);
    void (*model_end)(void *context);
    /* The same question for MODEL_SOLUTION; adds the bytes that were kept if they are of the same scene. */
    bool (*solution)(void *context, const struct model_request *request, struct list *bytes, struct error *error);
    /* A device process for the scene, which makes so many groups of orders at a time, each with so many bytes for
     * pixels; *link: the memory that it shares (device/device_link.h). NULL: there are no such processes. False: there
     * is none, reported. */
    bool (*device)(void *context, const struct bundle *scene, uint32_t slots, uint32_t room, struct share *link,
                   struct error *error);
    void (*line)(void *context, enum line_kind kind, const char *text);
    void (*script_ended)(void *context, int index, int status);
    /* A script read a file, or opened it for writing. */
    void (*read)(void *context, const char *path, const struct file_version *version, bool written);
    /* A script begins another frame of gr.frames: its time counts from here. NULL: nobody measures it. */
    void (*frame)(void *context);
    /* --watch: all scripts have ended; waits, and returns whether they run again in this process. NULL: no watch. */
    bool (*again)(void *context);
    void (*poll)(void *context); /* called every few milliseconds while a picture is made; may be NULL */
};

#endif
