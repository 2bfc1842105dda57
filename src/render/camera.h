/* A pinhole camera: an eye and a window one unit along the view (SPEC 1.5). */
#ifndef GRAY_RENDER_CAMERA_H
#define GRAY_RENDER_CAMERA_H

#include "base/error.h"
#include "math/ray.h"
#include "render/settings.h"

#include <stdbool.h>

struct camera_frame {
    struct vec3 eye;
    struct vec3 forward, right, down; /* forward unit; right and down span one pixel */
    double width, height;             /* pixels */
    double spread;                    /* angle of a pixel, radians: the ray's footprint */
};

/* Errors: view zero or not finite. Sets *warning to a sentence when up had to be replaced. */
bool camera_prepare(const struct camera *camera, const struct settings *settings, double width, double height,
                    struct camera_frame *out, char warning[256], struct error *error);
/* The ray through (x, y), pixels from the upper left corner of the picture. */
struct ray camera_ray(const struct camera_frame *frame, double x, double y);

#endif
