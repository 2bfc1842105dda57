/* What the command line and the script decide about a picture. The zero value is NOT the default here, because many
 * defaults are not zero: settings_default() is. */
#ifndef GRAY_RENDER_SETTINGS_H
#define GRAY_RENDER_SETTINGS_H

#include "geom/mesh.h"
#include "look/shading.h"
#include "math/vec3.h"

#include <stdbool.h>
#include <stdint.h>

struct settings {
    int samples;                             /* -ss: N x N for a marked pixel; 1..64 */
    bool full;                               /* -full: every pixel */
    int reflect_limit, refract_limit;        /* 0..1000 */
    double side_tolerance, corner_tolerance; /* squared RGB distance, >= 0 */
    bool use_tir;
    int area_samples;                        /* -al-samples: N x N shadow rays; 1..64 */
    uint64_t seed;
    bool view_is_target;                     /* --view target */
    bool pixel_corner;                       /* --pixel-sample corner */
    enum specular_kind specular;             /* --specular */
    bool ambient_plain;                      /* --ambient plain: ambient is added itself, not times kd */
    enum accel_kind accel;
    bool keep_first;                         /* the first pass is wanted even where -full makes it needless */
    bool cropped;
    int64_t crop_x, crop_y, crop_width, crop_height;
};

struct settings settings_default(void);

struct camera {
    struct vec3 eye, view, up; /* view: direction, or point with view_is_target; nothing needs to be unit or at right angles */
    double fov;                /* full vertical angle, degrees, in (0, 180) */
};

#endif
