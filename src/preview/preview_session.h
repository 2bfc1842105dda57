/* Executes commands of the viewer in the render process: renders passes, picks and changes nodes, traces pixels. The
 * world is kept as long as only the camera or a colour changes. */
#ifndef GRAY_PREVIEW_PREVIEW_SESSION_H
#define GRAY_PREVIEW_PREVIEW_SESSION_H

#include "base/pool.h"
#include "render/render.h"
#include "scene/change.h"
#include "script/script.h"
#include "session/services.h"

struct preview_session {
    const struct host_services *services;
    struct pool *pool;
    const struct render_request *request;
    const struct picture_request *picture_request;
    struct render_job *job; /* as the script requests it; with the world to use */
    struct world *world;
    /* The device of the job, if it has one. */
    struct {
        bool (*walks)(void *context, uint64_t pixels); /* it makes raw pictures while the camera moves */
        void (*forget)(void *context);                 /* the world has changed */
        void *context;
    } device;
    void *context; /* of the functions below */
    /* Builds job->world again with the lights, and the sky, of the changes; NULL: of the script. False: there is no
     * world; building can be stopped like a pass. */
    bool (*build)(void *context, const struct changed_scene *changed, struct error *error);
    void (*fill)(void *context, const struct film *film, struct picture_report *report);
    void (*warn)(void *context, const char *text);
};

/* Runs until the picture is finished. built: the world exists; else the user stopped its building and may request it
 * later. False: the window was closed, or an error. */
bool preview_run(struct preview_session *preview, bool built, struct picture_report *report, double build_seconds,
                 struct error *error);
/* Whether this is the error of a pass that the user has stopped. */
bool preview_was_stopped(const struct control *control, const struct error *error);

#endif
