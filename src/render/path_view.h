/* What changes in a scene for waves (path_wave.h) when only the camera or the size of the picture does: numbers without
 * pointers, which a device takes in place of a new bundle. Who takes one has checked it. */
#ifndef GRAY_RENDER_PATH_VIEW_H
#define GRAY_RENDER_PATH_VIEW_H

#include "material/medium.h"
#include "render/camera.h"
#include "render/path_wave.h"

enum { PATH_VIEW_CLOSED = 256 };
struct path_view {
    struct camera_frame camera;
    uint64_t rest; /* a hash of the settings that a view does not change; devices do not read it */
    uint32_t width, height;
    uint32_t solid_count, solids[MEDIUM_STACK_LIMIT]; /* that contain the eye */
    uint32_t closed_count, closed[PATH_VIEW_CLOSED];  /* of the renderer */
    uint8_t timed, medium_stack_by_ray;               /* the same; 0 or 1, as the next two */
    uint8_t has_parts, has_room;                      /* room: a bundle of this view has memory for parts */
};

/* Whether a device with the bundle of `first` can make it, if the world is the same. */
bool path_view_follows(const struct path_view *first, const struct path_view *view);
/* Whether all its numbers are possible ones for the scene. */
bool path_view_fits(const struct path_scene *scene, const struct path_view *view);
/* It does. address: where the scene lies for those who follow its pointers. */
void path_view_set(struct path_scene *scene, const struct path_view *view, uint64_t address);

#endif
