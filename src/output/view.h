/* gray view: pictures of a light field or a panorama that is rendered, without its scene. */
#ifndef GRAY_OUTPUT_VIEW_H
#define GRAY_OUTPUT_VIEW_H

#include "image/light_field_view.h"
#include "light/sky.h"
#include "output/picture_files.h"
#include "session/options.h"

enum { VIEW_POINTS = 64 };
/* What is shown: a light field, or a sky around the eye. */
struct view {
    const struct options *options;
    struct picture_files files;
    struct pool *pool;
    bool is_field;
    struct light_field field;
    struct image *image;
    struct sky sky;
    struct tone tone;
    struct vec3 points[VIEW_POINTS]; /* of the path */
    uint32_t point_count, frames, width, height;
    float (*light)[3]; /* of the picture */
};
/* How it is seen: by a camera in the field; or x and y are the direction (degrees to the right and up), and fov is the
 * angle of view (degrees). */
struct view_state {
    struct light_field_camera camera;
    double fov;
};

/* Whether a file holds a picture or a light field. */
bool view_is(const char *name);
/* Opens the file that options->scripts names, with all that the options want of it. NULL: an error. */
struct view *view_open(const struct options *options, struct error *error);
/* Closes it (or NULL), and prints the error unless it is NULL. Returns the exit status. */
int view_close(struct view *view, const struct error *error);
struct view_state view_state_of(const struct view *view, uint32_t frame);
/* Draws view->light, view->width x view->height: the size of state->camera. */
bool view_draw(struct view *view, const struct view_state *state, struct error *error);
/* Writes view->light into a picture of this name. */
bool view_write(struct view *view, const char *name, struct error *error);

/* options->scripts is the file. Returns the exit status. */
int view_run(const struct options *options);

#endif
