/* The camera: an eye and a window one unit along the view (docs/language.md 10.2), with lens, other projections and
 * stereo. */
#ifndef GRAY_RENDER_CAMERA_H
#define GRAY_RENDER_CAMERA_H

#include "base/error.h"
#include "math/box.h"
#include "math/ray.h"
#include "math/sampling.h"
#include "settings/settings.h"

#include <stdbool.h>

struct camera_frame {
    struct vec3 eye;
    struct vec3 forward, right, down; /* forward unit; right and down span one pixel */
    double width, height;             /* pixels; of one view: an eye's half side by side, a view of a light field */
    double spread;                    /* angle of a pixel, radians: the ray's footprint */
    struct vec3 unit_right, unit_down;
    struct lens lens;
    double focus;  /* distance of the plane in focus */
    double radian; /* fisheye: angle of half the height */
};

struct picture_size {
    double width, height; /* pixels */
};
/* The same without words, for a camera of which an earlier moment was prepared. False: there is no such view. */
bool camera_prepare_quietly(const struct camera *camera, const struct settings *settings, struct picture_size size,
                            struct camera_frame *out);
/* Errors: view zero or not finite, an impossible lens. Sets *warning to a sentence if up was replaced. */
bool camera_prepare(const struct camera *camera, const struct settings *settings, struct picture_size size,
                    struct camera_frame *out, char warning[256], struct error *error);
/* The camera at a moment. */
struct camera camera_at(const struct camera *camera, const struct camera_motion *motion, double time);
/* A box around all origins of rays. */
struct box camera_origins(const struct camera_frame *frame);
/* The ray of a pinhole through (x, y), pixels from the upper left corner of the picture. */
struct ray camera_ray(const struct camera_frame *frame, double x, double y);

/* Rays start from several eyes. */
static inline bool camera_has_views(const struct camera_frame *frame) {
    return frame->lens.stereo != STEREO_NONE || frame->lens.columns > 0;
}
/* A view of the picture: its upper left corner, pixels, its eye from that of the frame, world units, and its number. */
struct camera_view {
    double x, y, right, down;
    uint32_t number;
    bool depth; /* its colours are depths */
};
/* The view with the pixel whose centre is (x, y). */
struct camera_view camera_view_at(const struct camera_frame *frame, double x, double y);
/* An eye of a stereo pair in one picture: -1 left, 1 right. */
struct camera_view camera_view_of_eye(const struct camera_frame *frame, int eye);
/* A pinhole in the middle: camera_ray is sufficient. */
static inline bool camera_is_plain(const struct camera_frame *frame) {
    const struct lens *lens = &frame->lens;
    return lens->projection == PROJECTION_PERSPECTIVE && lens->aperture == 0 && !camera_has_views(frame) &&
           lens->shift_x == 0 && lens->shift_y == 0;
}
/* Origins of rays may be in different media. */
static inline bool camera_spreads(const struct camera_frame *frame) {
    const struct lens *lens = &frame->lens;
    return lens->projection == PROJECTION_ORTHOGRAPHIC || camera_has_views(frame) || lens->aperture > 0;
}
/* The ray through (x, y) from a place on the lens (of the unit square). view: or NULL, the one at (x, y). False:
 * nothing is visible there. */
bool camera_ray_through(const struct camera_frame *frame, double x, double y, struct sample2 position,
                        const struct camera_view *view, struct ray *out);
/* The position of a world point in the picture of a pinhole camera: the inverse of camera_ray_through. With several
 * views, the result is that of the middle between their eyes. False: it is not in the picture. */
bool camera_project(const struct camera_frame *frame, struct vec3 point, double *x, double *y);

#endif
