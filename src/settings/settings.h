/* The settings of a picture from the command line and the script. The zero value is NOT the default here, because many
 * defaults are not zero: settings_default() is. */
#ifndef GRAY_SETTINGS_SETTINGS_H
#define GRAY_SETTINGS_SETTINGS_H

#include "base/list.h"
#include "image/finish.h"
#include "image/tone.h"
#include "math/motion.h"
#include "math/vec3.h"

#include <stdbool.h>
#include <stdint.h>

enum { COARSE_SIDE = 2 };

#define PROJECTIONS(X)                                                                                                 \
    X(PROJECTION_PERSPECTIVE, "perspective")                                                                           \
    X(PROJECTION_ORTHOGRAPHIC, "orthographic")                                                                         \
    X(PROJECTION_FISHEYE, "fisheye")                                                                                   \
    X(PROJECTION_PANORAMA, "panorama")
enum projection { PROJECTIONS(LIST_MEMBER) };
#define STEREOS(X)                                                                                                     \
    X(STEREO_NONE, "none")                                                                                             \
    X(STEREO_SIDE, "side")                                                                                             \
    X(STEREO_ANAGLYPH, "anaglyph")
enum stereo { STEREOS(LIST_MEMBER) };

/* The camera in front of the film. The zero value is a pinhole in the middle of the window. */
struct lens {
    enum projection projection;
    double view_height;      /* orthographic: height of the window, world units */
    double angle;            /* fisheye: full angle across the picture's height, degrees, in (0, 360] */
    double shift_x, shift_y; /* how far the window is off the axis, in widths to the right and heights upwards */
    double aperture;         /* radius of the lens, world units; 0: a pinhole */
    double focus;            /* distance of the plane in focus along the view; 0: the one through focus_point */
    struct vec3 focus_point;
    int blades;         /* of the diaphragm, its corners at the radius; 0: round */
    double blade_angle; /* degrees */
    enum stereo stereo;
    double eye_distance; /* between the two eyes */
    double screen;       /* distance along the view where both eyes see the same place of the picture */
};

/* The camera at time 1 if it moves; it has its given values at time 0, and all three change linearly.
 */
struct camera_motion {
    bool moves;
    struct vec3 eye, view, up;
};

/* A photon map for caustics (docs/light.md). */
struct caustics {
    int photons;   /* sent; 0: no caustics; at most PHOTONS_MAX */
    double radius; /* of what one photon lights, world units; 0: by their density */
};
enum { PHOTONS_MAX = 100000000, PHOTONS_USUAL = 200000 };

/* What colours mean (docs/colour.md). AUTO: linear with integrators of light (integrator_traits), else classic. */
#define COLOUR_PIPELINES(X)                                                                                            \
    X(COLOUR_AUTO, "auto")                                                                                             \
    X(COLOUR_CLASSIC, "classic") /* numbers unchanged */                                                               \
    X(COLOUR_LINEAR, "linear")   /* light: pictures are decoded, PNG files encoded */
enum colour_pipeline { COLOUR_PIPELINES(LIST_MEMBER) };

/* How light becomes a picture; render/integrator.c switches over them. */
#define INTEGRATORS(X)                                                                                                 \
    X(INTEGRATOR_WHITTED, "whitted")                                                                                   \
    X(INTEGRATOR_PATH, "path")
enum integrator_kind { INTEGRATORS(LIST_MEMBER) };
/* What the pictures of an integrator are to the rest of the program. */
struct integrator_traits {
    bool progressive;     /* a pixel is the mean of a sequence of samples: --spp, --noise and --time-limit hold */
    bool has_light_parts; /* its light is known by kind of scattering: the layers AOV_PATH */
    bool is_linear;       /* COLOUR_AUTO is linear */
};
struct integrator_traits integrator_traits(enum integrator_kind integrator);
/* NOISE: the limit with --noise and without --spp. */
enum {
    PATH_SAMPLES_DEFAULT = 64,
    PATH_SAMPLES_NOISE = 1 << 16,
    PATH_SAMPLES_MAX = 1 << 24,
    DEPTH_DEFAULT = 16,
    ROULETTE_DEPTH_DEFAULT = 2,
    DEPTH_MAX = 1000000
};
/* What makes noise of few samples invisible, where the picture is written. GRAY: denoise/denoise.h; OIDN: the program
 * oidnDenoise of Intel's Open Image Denoise. */
#define DENOISERS(X)                                                                                                   \
    X(DENOISER_NONE, "none")                                                                                           \
    X(DENOISER_GRAY, "gray")                                                                                           \
    X(DENOISER_OIDN, "oidn")
enum denoiser { DENOISERS(LIST_MEMBER) };
#define OVERLAYS(X)                                                                                                    \
    X(OVERLAY_NONE, "none")                                                                                            \
    X(OVERLAY_OF_BOXES, "boxes")                                                                                       \
    X(OVERLAY_OF_GRID, "grid")
enum overlay { OVERLAYS(LIST_MEMBER) };
/* Reconstruction filters (render/filter_internal.h). */
#define FILTERS(X)                                                                                                     \
    X(FILTER_BOX, "box")                                                                                               \
    X(FILTER_TENT, "tent")                                                                                             \
    X(FILTER_GAUSSIAN, "gaussian")                                                                                     \
    X(FILTER_MITCHELL, "mitchell")
enum filter_kind { FILTERS(LIST_MEMBER) };
/* Adaptive anti-aliasing of Whitted's integrator: which pixels get N x N samples, and where these samples are
 * (whitted_pixels.c). GRID: marks by colours only, samples at the centres of N x N cells. ROTATED: also marks by
 * surfaces and thin primitives; samples on a rotated grid, jittered near thin primitives. */
#define AA_PATTERNS(X)                                                                                                 \
    X(AA_GRID, "grid")                                                                                                 \
    X(AA_ROTATED, "rotated")
enum aa_pattern { AA_PATTERNS(LIST_MEMBER) };
/* How surfaces reflect light (render/style_internal.h); only for Whitted's integrator. */
#define STYLES(X)                                                                                                      \
    X(STYLE_NONE, "none")                                                                                              \
    X(STYLE_INK, "ink")                                                                                                \
    X(STYLE_TOON, "toon")                                                                                              \
    X(STYLE_GOOCH, "gooch")
enum style { STYLES(LIST_MEMBER) };
#define LINE_WIDTH_DEFAULT 2.0 /* with a style */
enum { LINE_WIDTH_MAX = 32, TOON_STEPS_MAX = 64 };
#define TILE_ORDERS(X)                                                                                                 \
    X(ORDER_SPREAD, "spread")                                                                                          \
    X(ORDER_CENTRE, "centre")                                                                                          \
    X(ORDER_ROWS, "rows")
enum order { TILE_ORDERS(LIST_MEMBER) };

/* The search structure over primitives and inside meshes; the results are the same. AUTO: the fastest; GRID: the
 * uniform grid of Amanatides and Woo; BVH: a hierarchy; KDTREE: a kd-tree; NONE: everything is tested. */
#define ACCEL_KINDS(X)                                                                                                 \
    X(ACCEL_AUTO, "auto")                                                                                              \
    X(ACCEL_GRID, "grid")                                                                                              \
    X(ACCEL_BVH, "bvh")                                                                                                \
    X(ACCEL_KDTREE, "kdtree")                                                                                          \
    X(ACCEL_NONE, "none")
enum accel_kind { ACCEL_KINDS(LIST_MEMBER) };

/* The highlight of the picture. */
#define SPECULAR_KINDS(X)                                                                                              \
    X(SPECULAR_PHONG, "phong")                                                                                         \
    X(SPECULAR_BLINN, "blinn")
enum specular_kind { SPECULAR_KINDS(LIST_MEMBER) };

/* How a light is chosen. UNIFORM and POWER are there to be compared with. */
#define LIGHT_CHOICES(X)                                                                                               \
    X(LIGHT_CHOICE_TREE, "tree")                                                                                       \
    X(LIGHT_CHOICE_POWER, "power")                                                                                     \
    X(LIGHT_CHOICE_UNIFORM, "uniform")
enum light_choice { LIGHT_CHOICES(LIST_MEMBER) };

/* How paths find light that rays can hit: by sampling lights and BSDFs with multiple importance sampling, or, for
 * comparison, by one of them only. */
enum path_strategy { PATH_STRATEGY_MIS, PATH_STRATEGY_LIGHTS, PATH_STRATEGY_BSDF };

struct settings {
    enum integrator_kind integrator;
    enum colour_pipeline colour;
    enum path_strategy path_strategy;
    enum light_choice light_choice; /* of paths; not of a script: to compare with */
    struct caustics caustics;
    struct lens lens;
    struct shutter shutter;
    struct camera_motion motion;
    struct tone tone;                        /* of the picture file; the film stays linear */
    bool keeps_tone;                         /* --tone: functions of scenes have no effect */
    bool deep;                               /* 16 bits a channel in PNG files */
    struct finish finish;                    /* of the picture file too */
    int samples;                             /* -ss: N x N for a marked pixel; 1..64 */
    bool full;                               /* -full: every pixel */
    enum aa_pattern aa_pattern;              /* --aa-pattern */
    int reflect_limit, refract_limit;        /* 0..1000 */
    double side_tolerance, corner_tolerance; /* squared RGB distance, >= 0 */
    bool use_tir;
    enum style style;
    double line_width;  /* of lines at edges, pixels, 0..LINE_WIDTH_MAX; negative: that of the style */
    int toon_steps;     /* 1..TOON_STEPS_MAX */
    int area_samples;   /* -al-samples: N x N shadow rays; 1..64 */
    int path_samples;   /* --spp: samples of a pixel; 0: not set, PATH_SAMPLES_DEFAULT */
    int max_depth;      /* scattering events of a path, 0..DEPTH_MAX: 0 emission, 1 direct light */
    int roulette_depth; /* scattering events after which Russian roulette may end a path, 0..DEPTH_MAX */
    enum filter_kind filter;
    double noise;          /* --noise: a tile whose relative standard error is not larger is done; 0: all samples */
    double time_limit;     /* --time-limit: seconds, for whole passes of paths over the picture; 0: none */
    double clamp;          /* --clamp: the largest component that a sample of a path may have; 0: any */
    bool passes;           /* paths: the picture is looked at while it is made, so its samples come in passes */
    enum denoiser denoise; /* of path-traced pictures */
    bool keeps_noise;      /* --denoise=none: scenes cannot request a denoiser */
    uint64_t seed;
    bool view_is_target;         /* --view target */
    bool pixel_corner;           /* --pixel-sample corner */
    enum specular_kind specular; /* --specular */
    bool ambient_plain;          /* --ambient plain: ambient is added itself, not times kd */
    enum accel_kind accel;
    double cutoff;        /* rays that can change a pixel by less (of 1) are not followed; 0: all are */
    enum overlay overlay; /* lines over the picture */
    enum order order;     /* of the tiles; the picture does not depend on it */
    uint32_t aov;         /* layers beside the picture: a mask of film/aov.h */
    bool keep_first;      /* the first pass is wanted even where -full makes it needless */
    bool coarse;       /* rough surfaces send one ray, and lights area_samples of them, instead of their own numbers */
    bool show_refined; /* pixels that are to be resampled are marked in the film before (FILM_MARK_WAITS) */
    bool cropped;
    int64_t crop_x, crop_y, crop_width, crop_height;
};

struct settings settings_default(void);
/* Drafts: what to leave out for a fast picture. QUICK: one sample a pixel, coarse, no caustics, no blur by lens
 * or motion; PREVIEW: neither mirrored nor refracted rays either, one shadow ray for a light. */
enum draft_level { DRAFT_NONE, DRAFT_QUICK, DRAFT_PREVIEW };
void settings_set_draft(struct settings *settings, enum draft_level draft_level);

struct camera {
    struct vec3 eye, view,
        up;     /* view: direction, or point with view_is_target; nothing needs to be unit or at right angles */
    double fov; /* full vertical angle, degrees, in (0, 180) */
};

static inline double settings_line_width(const struct settings *settings) {
    double of_style = settings->style == STYLE_NONE ? 0 : LINE_WIDTH_DEFAULT;
    return settings->line_width < 0 ? of_style : settings->line_width;
}
/* With the integrator path: samples of a pixel, at most. */
static inline uint32_t settings_path_samples(const struct settings *settings) {
    if (settings->path_samples > 0)
        return (uint32_t)settings->path_samples;
    return settings->noise > 0        ? PATH_SAMPLES_NOISE
           : settings->time_limit > 0 ? PATH_SAMPLES_MAX
                                      : PATH_SAMPLES_DEFAULT;
}

static inline bool settings_linear(const struct settings *settings) {
    return settings->colour == COLOUR_LINEAR ||
           (settings->colour == COLOUR_AUTO && integrator_traits(settings->integrator).is_linear);
}

#endif
