/* What the path tracer gives to waves. */
#ifndef GRAY_RENDER_PATH_WAVE_INTERNAL_H
#define GRAY_RENDER_PATH_WAVE_INTERNAL_H

#include "render/path_internal.h"
#include "render/path_view.h"

struct path_scene {
    struct render_job job; /* the first, to which `renderer` points */
    struct renderer renderer;
    struct path_tracer tracer;
    bool has_parts, media_dim;
    bool has_room;                     /* states of paths have memory for parts */
    uint32_t closed[PATH_VIEW_CLOSED]; /* of a view (path_view_set), to which `renderer` points */
};

/* What waves do not have, as the end of a sentence; NULL: nothing that the scene needs. */
const char *path_scene_lacks(const struct path_tracer *tracer, const struct renderer *renderer);
/* Parts are stored, or will be by another pass over the same film. */
bool path_scene_has_room(const struct renderer *renderer);
/* The scene with all that its paths read, and their search, which is borrowed until bundle_write. NULL: no memory. */
struct bundle *path_scene_bundle(const struct path_tracer *tracer, const struct renderer *renderer,
                                 const struct device_search *search);

#endif
