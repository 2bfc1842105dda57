/* The part of the overlay of a picture in a window that needs rays, so that only the render process can make it: the
 * lines of --overlay, and the pixels that show the selected node. The render process stores it in the memory of the
 * film, after the layers, and replies; the supervisor copies it before it sends another command. */
#ifndef GRAY_PREVIEW_VIEW_OVERLAY_INTERNAL_H
#define GRAY_PREVIEW_VIEW_OVERLAY_INTERNAL_H

#include "preview/preview_messages.h"
#include "world/node_path.h"

struct view_overlay_scene {
    const struct render_job *job; /* with its world and the camera of the view */
    const struct node *root;      /* from which the world was built */
    struct pool *pool;
};

/* Makes the requested parts for the camera of the job. False: no memory, or no such camera, or cancelled. */
bool view_overlay_make(const struct view_overlay_scene *scene, const struct view_overlay_request *request,
                       const struct view_overlay_buffers *buffers, struct view_overlay *overlay, struct error *error);

#endif
