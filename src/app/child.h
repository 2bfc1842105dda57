/* The child: runs the scripts and makes their pictures. It opens no file for writing and owns no terminal; what it
 * needs of those it asks for through child_services, which is the channel to the supervisor or, with --no-fork, the
 * desk itself. */
#ifndef GRAY_APP_CHILD_H
#define GRAY_APP_CHILD_H

#include "app/channel.h"
#include "app/control.h"
#include "app/options.h"
#include "render/film.h"

#include <stdbool.h>

struct child_services {
    void *context;
    struct control *control;
    /* A film for the picture; under request->check only the answer whether it could be written. *already: the picture
     * is there or somebody else's; neither done nor abandon follows. */
    bool (*begin)(void *context, const struct picture_request *request, struct film *film, bool *already,
                  struct error *error);
    /* Something for a window is done: waits for what comes next. False: there is nobody. */
    bool (*news)(void *context, const struct studio_news *news, struct studio_order *order, struct error *error);
    void (*abandon)(void *context);
    /* The film is complete. True when the files are written. */
    bool (*done)(void *context, const struct picture_report *report, struct error *error);
    void (*line)(void *context, enum line_kind kind, const char *text);
    void (*script_ended)(void *context, int index, int status);
    /* A script read a file, or opened it for writing. */
    void (*read)(void *context, const char *path, const struct file_version *version, bool written);
    /* --watch: all scripts have ended; waits, and returns whether they run again in this process. NULL: no watch. */
    bool (*again)(void *context);
    void (*poll)(void *context); /* called every few milliseconds while a picture is made; may be NULL */
};

/* Runs the scripts from number `first` on, one after the other; stops early after wrong usage or when cancelled. */
void child_run(const struct options *options, const struct child_services *services, int first);

#endif
