/* The overlay of a picture in a window as far as rays find it, so that only the render process can make it: the lines
 * of
 * --overlay, and which pixels show the selected node. The render process leaves it in the memory of the film, behind
 * the layers, and replies; the supervisor copies it before it sends another command. */
#ifndef GRAY_VIEWER_VIEW_OVERLAY_INTERNAL_H
#define GRAY_VIEWER_VIEW_OVERLAY_INTERNAL_H

#include "session/messages.h"
#include "world/path.h"

struct view_overlay_scene {
    const struct render_job *job; /* with its world; its camera is the one that looks */
    const struct node *root;      /* of which the world was built */
    struct pool *pool;
};

/* Makes what is requested, as the camera of the job sees it. False: no memory, or no such camera, or cancelled. */
bool view_overlay_make(const struct view_overlay_scene *scene, const struct view_overlay_request *request,
                       const struct view_overlay_buffers *buffers, struct view_overlay *overlay, struct error *error);

#endif
