/* Marks: what lies over the picture in a window and is found by rays, so that only the child can make it: the lines of
 * --overlay, and which pixels show the node that is selected. The child leaves them in the memory of the film, behind
 * its layers, and says so with its news; the supervisor takes a copy before it sends another order. */
#ifndef GRAY_VIEWER_VIEW_OVERLAY_H
#define GRAY_VIEWER_VIEW_OVERLAY_H

#include "session/messages.h"
#include "world/path.h"

struct view_overlay_scene {
    const struct render_job *job; /* with its world; its camera is the one that looks */
    const struct node *root;      /* of which the world was built */
    struct pool *pool;
};

/* Makes what is wished for, as the camera of the job sees it. False: no memory, or no such camera, or cancelled. */
bool view_overlay_make(const struct view_overlay_scene *scene, const struct view_overlay_request *request,
                       const struct view_overlay_buffers *buffers, struct view_overlay *overlay, struct error *error);

#endif
