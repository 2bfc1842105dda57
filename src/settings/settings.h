/* The settings of a picture from the command line and the script: their words, the list of all, and what they mean
 * together. The zero value is NOT the default, because many defaults are not zero: settings_default() is. */
#ifndef GRAY_SETTINGS_SETTINGS_H
#define GRAY_SETTINGS_SETTINGS_H

#include "base/list.h"
#include "image/finish.h"
#include "image/tone.h"
#include "math/motion.h"
#include "math/vec3.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { COARSE_SIDE = 2, CROP_MAX = 1 << 20 };

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
    double screen;       /* distance along the view where both eyes, or all views, see the same place of the picture */
    /* A light field: the film is a grid of views, from cameras on a plane across the view. 0: one camera. */
    int rows, columns;
    double spacing; /* between neighbouring cameras */
    bool depth; /* below the grid there is another one, whose colours are depths along the view; 0: nothing is hit */
    double fov; /* of the camera, for the file of a light field */
};
enum { LIGHT_FIELD_SIDE = 1024 }; /* of the grid */
/* The grids of views of the film, one below the other; 0: no light field. */
static inline uint32_t lens_grids(const struct lens *lens) {
    return lens->columns > 0 ? 1 + (uint32_t)lens->depth : 0;
}
/* Whether a film of that size is such grids of equal views. */
static inline bool lens_fits(const struct lens *lens, uint32_t width, uint32_t height) {
    return lens->columns > 0 && lens->rows > 0 && width % (uint32_t)lens->columns == 0 &&
           height % ((uint32_t)lens->rows * lens_grids(lens)) == 0;
}

/* The camera at time 1 if it moves; it has its given values at time 0, and all three change linearly. */
struct camera_motion {
    bool moves;
    struct vec3 eye, view, up;
};

/* A photon map for caustics (docs/design/light.md). */
struct caustics {
    int photons;   /* sent; 0: no caustics; at most PHOTONS_MAX */
    double radius; /* of what one photon lights, world units; 0: by their density */
};
enum { PHOTONS_MAX = 100000000, PHOTONS_USUAL = 200000 };
enum { PATCHES_MAX = 10000000 };

/* What colours mean (docs/colour.md). AUTO: linear with integrators of light (integrator_traits), else classic. */
#define COLOUR_PIPELINES(X)                                                                                            \
    X(COLOUR_AUTO, "auto")                                                                                             \
    X(COLOUR_CLASSIC, "classic") /* numbers unchanged */                                                               \
    X(COLOUR_LINEAR, "linear")   /* light: pictures are decoded, PNG files encoded */
enum colour_pipeline { COLOUR_PIPELINES(LIST_MEMBER) };

/* How light becomes a picture; render/integrator.c switches over them. */
#define INTEGRATORS(X)                                                                                                 \
    X(INTEGRATOR_WHITTED, "whitted")                                                                                   \
    X(INTEGRATOR_PATH, "path")                                                                                         \
    X(INTEGRATOR_RADIOSITY, "radiosity")
enum integrator_kind { INTEGRATORS(LIST_MEMBER) };
/* What the pictures of an integrator are to the rest of the program. */
struct integrator_traits {
    bool progressive;     /* a pixel is the mean of a sequence of samples: --spp, --noise and --time-limit hold */
    bool has_light_parts; /* its light is known by kind of scattering: the layers AOV_PATH */
    bool is_linear;       /* COLOUR_AUTO is linear */
    bool is_classic;      /* materials with layers may be shaded by numbers of gr.material */
    bool sky_lights;      /* the background lights surfaces, and ambient light does not */
    bool has_styles;      /* pictures may look like drawings */
    bool follows_paths;   /* through thin walls, under surfaces, and by wavelength */
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
/* What makes noise of few samples invisible, where the picture is written. AUTO: GRAY if the scene requests it, else
 * NONE; GRAY: denoise/denoise.h; OIDN: the program oidnDenoise of Intel's Open Image Denoise. */
#define DENOISERS(X)                                                                                                   \
    X(DENOISER_AUTO, "auto")                                                                                           \
    X(DENOISER_NONE, "none")                                                                                           \
    X(DENOISER_GRAY, "gray")                                                                                           \
    X(DENOISER_OIDN, "oidn")
enum denoiser { DENOISERS(LIST_MEMBER) };
#define OVERLAYS(X)                                                                                                    \
    X(OVERLAY_NONE, "none")                                                                                            \
    X(OVERLAY_OF_BOXES, "boxes")                                                                                       \
    X(OVERLAY_OF_GRID, "grid")                                                                                         \
    X(OVERLAY_OF_PATCHES, "patches")
enum overlay { OVERLAYS(LIST_MEMBER) };
/* Reconstruction filters (render/filter_internal.h). */
#define FILTERS(X)                                                                                                     \
    X(FILTER_BOX, "box")                                                                                               \
    X(FILTER_TENT, "tent")                                                                                             \
    X(FILTER_GAUSSIAN, "gaussian")                                                                                     \
    X(FILTER_MITCHELL, "mitchell")
enum filter_kind { FILTERS(LIST_MEMBER) };
/* How samples become a pixel. BRIGHT: a mean with the weights 1 / (1 + luminance), after exposure, which is the mean of
 * tone-mapped samples, mapped back. */
#define RESOLVES(X)                                                                                                    \
    X(RESOLVE_MEAN, "mean")                                                                                            \
    X(RESOLVE_BRIGHT, "bright")
enum resolve { RESOLVES(LIST_MEMBER) };
/* Adaptive anti-aliasing of Whitted's integrator: which pixels get N x N samples, and where these samples are
 * (whitted.c). GRID: marks by colours only, samples at the centres of N x N cells. ROTATED: also marks by
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
    X(TILE_ORDER_SPREAD, "spread")                                                                                     \
    X(TILE_ORDER_CENTRE, "centre")                                                                                     \
    X(TILE_ORDER_ROWS, "rows")
enum tile_order { TILE_ORDERS(LIST_MEMBER) };

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
#define PATH_STRATEGIES(X)                                                                                             \
    X(PATH_STRATEGY_MIS, "mis")                                                                                        \
    X(PATH_STRATEGY_LIGHTS, "lights")                                                                                  \
    X(PATH_STRATEGY_BSDF, "bsdf")
enum path_strategy { PATH_STRATEGIES(LIST_MEMBER) };

/* Settings with two values are bools: false is the first word. */
#define VIEW_MEANINGS(X) X(false, "direction") X(true, "target")
#define PIXEL_POSITIONS(X) X(false, "centre") X(true, "corner")
#define AMBIENT_MEANINGS(X) X(false, "kd") X(true, "plain")
/* A number may have words, which are the numbers above its range. */
#define EXPOSURES(X) X(EXPOSURE_AUTO, "auto")
enum { EXPOSURE_MAX = 100, EXPOSURES(LIST_MEMBER) }; /* of 101: until the light is measured (host/light_meter.h) */
#define NO_WORDS(X) X(NONE, "")

/* Each layer, with its name for --aov and in names of files, and the letters of its channels in an EXR file. */
#define AOVS(X)                                                                                                        \
    X(AOV_DEPTH, "depth", "Z")       /* distance from the eye along the ray, world units; 0: no hit */                 \
    X(AOV_NORMAL, "normal", "XYZ")   /* unit vector in world space, the outward shading normal; {0, 0, 0}: no hit */   \
    X(AOV_ALBEDO, "albedo", "RGB")   /* kd of the surface */                                                           \
    X(AOV_UV, "uv", "UV")            /* u, v, 1; {0, 0, 0}: no hit or no image coordinates */                          \
    X(AOV_NODE, "node", "N")         /* the number of the node by order of creation, from 1; 0: no hit */              \
    X(AOV_MATERIAL, "material", "N") /* the material's number in the scene, from 1 */                                  \
    X(AOV_COST, "cost", "N") /* nodes, voxels, boxes, shapes and triangles that all samples of the pixel looked at */  \
    X(AOV_SAMPLES, "samples", "N") /* camera rays of the pixel */                                                      \
    X(AOV_LIGHTS, "lights",                                                                                            \
      "N") /* fraction of the lights with a position or a direction whose centre the point sees */                     \
    /* Of path-traced pictures only. */                                                                                \
    X(AOV_RAW, "raw", "RGB")           /* the picture before it is denoised */                                         \
    X(AOV_VARIANCE, "variance", "RGB") /* of the raw picture: the squared standard error */                            \
    /* Groups of light in the order of enum path_light_group; their sum is the raw picture. */                         \
    X(AOV_EMISSION, "emission", "RGB")                                                                                 \
    X(AOV_DIFFUSE_DIRECT, "diffuse_direct", "RGB")                                                                     \
    X(AOV_DIFFUSE_INDIRECT, "diffuse_indirect", "RGB")                                                                 \
    X(AOV_SPECULAR_DIRECT, "specular_direct", "RGB")                                                                   \
    X(AOV_SPECULAR_INDIRECT, "specular_indirect", "RGB")                                                               \
    X(AOV_TRANSMISSION_DIRECT, "transmission_direct", "RGB")                                                           \
    X(AOV_TRANSMISSION_INDIRECT, "transmission_indirect", "RGB")                                                       \
    X(AOV_VOLUME_DIRECT, "volume_direct", "RGB")                                                                       \
    X(AOV_VOLUME_INDIRECT, "volume_indirect", "RGB")
enum aov { AOVS(LIST_MEMBER) };
enum { AOV_COUNT = LIST_COUNT(AOVS) };
#define AOV_ALL ((UINT32_C(1) << AOV_COUNT) - 1)
/* Those of path-traced pictures only, and among them the groups of light. */
#define AOV_PATH (AOV_ALL & ~((UINT32_C(1) << AOV_RAW) - 1))
#define AOV_LIGHT (AOV_ALL & ~((UINT32_C(1) << AOV_EMISSION) - 1))
#define AOV_NAME_IN_LIST(aov, name, channels) " " name ","
#define AOV_NAMES AOVS(AOV_NAME_IN_LIST)

/* Part of the keys of tile files: grows when a row is added, removed or moved, or its values change their meaning. */
enum { SETTINGS_VERSION = 6 };

/* What a setting changes: the samples of a picture; the finished picture, which is made of the samples; or only how it
 * is made. */
enum setting_change { CHANGES_SAMPLES, CHANGES_FINISH, CHANGES_RUN };

/* Groups of options in --help. */
enum option_group {
    OPTION_GROUP_RAYS,
    OPTION_GROUP_SIZE_AND_COLOUR,
    OPTION_GROUP_FINISH,
    OPTION_GROUP_FILES,
    OPTION_GROUP_ANIMATION,
    OPTION_GROUP_MODELS,
    OPTION_GROUP_VIEWS,
    OPTION_GROUP_OTHER_PROGRAMS,
    OPTION_GROUP_SANDBOX,
    OPTION_GROUP_EXECUTION,
    OPTION_GROUP_MACHINES,
    OPTION_GROUP_REPORTS,
    OPTION_GROUP_COUNT,
    OPTION_GROUP_NONE = OPTION_GROUP_COUNT
};

/* What a setting has effect with; one that the run or a call of gr.render gives in vain gets a notice
 * (host/effects.c). In words, after "it is for". */
#define SETTING_EFFECTS(X)                                                                                             \
    X(EFFECT_ALWAYS, "")                                                                                               \
    X(EFFECT_WHITTED, "integrator whitted")                                                                            \
    X(EFFECT_TREES, "integrators whitted and radiosity")                                                               \
    X(EFFECT_RADIOSITY, "integrator radiosity")                                                                        \
    X(EFFECT_PATH, "integrator path")                                                                                  \
    X(EFFECT_TOON, "style toon")                                                                                       \
    X(EFFECT_DISPLAY, "PNG files and animations; .pfm, .hdr and .exr have linear light")                               \
    X(EFFECT_BYTES, "PNG files of 8 bits")                                                                             \
    X(EFFECT_FRAMES, "animations, which --frames, --turntable or gr.frames make")                                      \
    X(EFFECT_GIF, "GIF files")
enum setting_effect { SETTING_EFFECTS(LIST_MEMBER) };

/* The list of settings: a setting is written here, where it is used, in the documentation and in a test. From its row
 * come the member of struct settings, the option with its check and its help, the field of gr.render, the check of the
 * messages between the processes, and the keys of tile files. The columns:
 *
 *     kind (setting.h), type, member, what it changes, default, lowest and highest value, words of a choice,
 *     option with its other spellings (NULL: none), its value in the help, unit, field of gr.render (NULL: none),
 *     default in words (NULL: from the default), group of options, help: a sentence for the option and for the field,
 *     what it has effect with (left out: everything)
 *
 * A default outside of the range means "not set". Members of struct tone and struct finish have lists of their own, and
 * so have settings with no field, and those with neither option nor field. */
#define SETTINGS_OF_SCENES(X)                                                                                          \
    X(CHOICE, enum integrator_kind, integrator, SAMPLES, INTEGRATOR_WHITTED, 0, 0, INTEGRATORS, "--integrator", NULL,  \
      NULL, "integrator", NULL, RAYS,                                                                                  \
      "The method: whitted has direct light, mirrors and glass; path also has indirect light from all surfaces; "      \
      "radiosity has whitted's mirrors and glass, and stored light that diffuse surfaces exchange.")                   \
    X(WHOLE, int, samples, SAMPLES, 3, 1, 64, NO_WORDS, "-ss", "N", NULL, "samples", NULL, RAYS,                       \
      "N x N samples for a marked pixel.", EFFECT_TREES)                                                               \
    X(FLAG, bool, full, SAMPLES, false, 0, 1, NO_WORDS, "-full", NULL, NULL, "full", NULL, RAYS,                       \
      "N x N samples for every pixel, not only for marked ones.", EFFECT_TREES)                                        \
    X(NUMBER, double, side_tolerance, SAMPLES, 0.005, 0, HUGE_VAL, NO_WORDS, "-side-tolerance", "X", NULL,             \
      "side_tolerance", NULL, RAYS, "A pixel is marked when the squared RGB distance to a side neighbour exceeds X.",  \
      EFFECT_TREES)                                                                                                    \
    X(NUMBER, double, corner_tolerance, SAMPLES, 0.01, 0, HUGE_VAL, NO_WORDS, "-corner-tolerance", "X", NULL,          \
      "corner_tolerance", NULL, RAYS, "The same for the corner neighbours.", EFFECT_TREES)                             \
    X(WHOLE, int, reflect_limit, SAMPLES, 2, 0, 1000, NO_WORDS, "-reflect-limit", "N", NULL, "reflect_limit", NULL,    \
      RAYS, "How often a path may reflect.", EFFECT_TREES)                                                             \
    X(WHOLE, int, refract_limit, SAMPLES, 4, 0, 1000, NO_WORDS, "-refract-limit", "N", NULL, "refract_limit", NULL,    \
      RAYS, "How often a path may refract.", EFFECT_TREES)                                                             \
    X(FLAG, bool, use_tir, SAMPLES, false, 0, 1, NO_WORDS, "-use-tir", NULL, NULL, "use_tir", NULL, RAYS,              \
      "At total internal reflection, add the refracted amount to the reflected one; without it, that light is lost.",  \
      EFFECT_TREES)                                                                                                    \
    X(WHOLE, int, area_samples, SAMPLES, 4, 1, 64, NO_WORDS, "-al-samples|alsamples", "N", NULL, "area_samples", NULL, \
      RAYS, "N x N shadow rays for each area light.", EFFECT_TREES)                                                    \
    X(WHOLE, int, medium_samples, SAMPLES, 16, 1, 4096, NO_WORDS, "--medium-samples", "N", NULL, "medium_samples",     \
      NULL, RAYS, "N points on a ray in a medium that scatters or has a density, with shadow rays to all lights.",     \
      EFFECT_TREES)                                                                                                    \
    X(NUMBER, double, cutoff, SAMPLES, 0.0001, 0, 1, NO_WORDS, "--cutoff", "X", NULL, "cutoff", NULL, RAYS,            \
      "Do not trace rays that can change a pixel by less than X, where white is 1; 0: trace all rays.", EFFECT_TREES)  \
    X(WHOLE, int, path_samples, SAMPLES, 0, 1, PATH_SAMPLES_MAX, NO_WORDS, "--spp", "N", NULL, "spp", "64", RAYS,      \
      "N samples for a pixel, with integrator path.", EFFECT_PATH)                                                     \
    X(WHOLE, int, max_depth, SAMPLES, 16, 0, DEPTH_MAX, NO_WORDS, "--max-depth", "N", NULL, "max_depth", NULL, RAYS,   \
      "A path is scattered at most N times: 0 shows emission only, 1 direct light, 2 one indirect bounce.",            \
      EFFECT_PATH)                                                                                                     \
    X(NUMBER, double, noise, SAMPLES, 0, 1e-6, 10, NO_WORDS, "--noise", "X", NULL, "noise", "all samples", RAYS,       \
      "With integrator path, a tile of 32 x 32 pixels gets samples (at least 16, at most --spp) until its relative "   \
      "standard error is X.",                                                                                          \
      EFFECT_PATH)                                                                                                     \
    X(NUMBER, double, clamp, SAMPLES, 0, 0, HUGE_VAL, NO_WORDS, "--clamp", "X", NULL, "clamp", NULL, RAYS,             \
      "With integrator path, no component of a sample is larger than X, 0: no limit; less noise, but the picture "     \
      "becomes darker than it should be (bias).",                                                                      \
      EFFECT_PATH)                                                                                                     \
    X(NUMBER, double, radiosity_error, SAMPLES, 0.001, 1e-9, 1, NO_WORDS, "--radiosity-error", "X", NULL,              \
      "radiosity_error", NULL, RAYS, "Stop when the share X of light is not yet shot, with integrator radiosity.",     \
      EFFECT_RADIOSITY)                                                                                                \
    X(WHOLE, int, radiosity_patches, SAMPLES, 20000, 1, PATCHES_MAX, NO_WORDS, "--radiosity-patches", "N", NULL,       \
      "radiosity_patches", NULL, RAYS, "At most N patches, with integrator radiosity.", EFFECT_RADIOSITY)              \
    X(CHOICE, enum filter_kind, filter, SAMPLES, FILTER_BOX, 0, 0, FILTERS, "--filter", NULL, NULL, "filter", NULL,    \
      RAYS, "Reconstruction filter of a pixel.")                                                                       \
    X(CHOICE, enum resolve, resolve, SAMPLES, RESOLVE_MEAN, 0, 0, RESOLVES, "--resolve", NULL, NULL, "resolve", NULL,  \
      RAYS,                                                                                                            \
      "How samples become a pixel, with integrator path; bright: by a mean with the weights 1 / (1 + luminance), "     \
      "after exposure: edges of lamps are smooth, but pixels whose samples differ are darker than their mean (bias).", \
      EFFECT_PATH)                                                                                                     \
    X(DENOISE, enum denoiser, denoise, FINISH, DENOISER_AUTO, 0, 0, DENOISERS, "--denoise", "gray", NULL, "denoise",   \
      NULL, RAYS,                                                                                                      \
      "Remove noise, with integrator path. Without a word gray does; oidn: by the program oidnDenoise of Open Image "  \
      "Denoise, which must be on PATH; none: do not, even if a scene requests it; auto: if a scene requests it.",      \
      EFFECT_PATH)                                                                                                     \
    X(SEED, uint64_t, seed, SAMPLES, 0, 0, 0x1p53 - 1, NO_WORDS, "--seed", "N", NULL, "seed", NULL, RAYS,              \
      "Seed of all random numbers; the option also seeds math.random in scripts.")                                     \
    X(CHOICE, enum accel_kind, accel, RUN, ACCEL_AUTO, 0, 0, ACCEL_KINDS, "--accel", NULL, NULL, "accel", NULL,        \
      SIZE_AND_COLOUR, "Acceleration structure; the picture is the same.")                                             \
    X(CHOICE, enum colour_pipeline, colour, SAMPLES, COLOUR_AUTO, 0, 0, COLOUR_PIPELINES, "--colour", NULL, NULL,      \
      "colour", NULL, SIZE_AND_COLOUR,                                                                                 \
      "linear: decode colour pictures from sRGB and encode PNG files as sRGB; classic: use all numbers unchanged; "    \
      "auto: linear with integrators path and radiosity.")                                                             \
    X(FLAG, bool, deep, FINISH, false, 0, 1, NO_WORDS, "--deep", NULL, NULL, "deep", NULL, SIZE_AND_COLOUR,            \
      "16 bits per channel in PNG files.", EFFECT_DISPLAY)                                                             \
    X(CHOICE, enum style, style, SAMPLES, STYLE_NONE, 0, 0, STYLES, "--style", NULL, NULL, "style", NULL, FINISH,      \
      "Pictures that look like drawings, with integrator whitted; ink: lines on white paper; toon: a few levels of "   \
      "light; gooch: cool to warm colours.",                                                                           \
      EFFECT_WHITTED)                                                                                                  \
    X(NUMBER, double, line_width, SAMPLES, -1, 0, LINE_WIDTH_MAX, NO_WORDS, "--line-width", "PIXELS", "pixels",        \
      "line_width", "2 with a style, else 0", FINISH, "Width of the lines where objects, normals and depths change.")  \
    X(WHOLE, int, toon_steps, SAMPLES, 3, 1, TOON_STEPS_MAX, NO_WORDS, "--toon-steps", "N", NULL, "toon_steps", NULL,  \
      FINISH, "Number of levels of light of style toon, not counting shadow.", EFFECT_TOON)                            \
    X(CHOICE, enum specular_kind, specular, SAMPLES, SPECULAR_PHONG, 0, 0, SPECULAR_KINDS, "--specular", NULL, NULL,   \
      "specular", NULL, OTHER_PROGRAMS, "Formula of the highlight.")
#define SETTINGS_OF_TONE(X)                                                                                            \
    X(NUMBER, double, tone.exposure, FINISH, 0, -100, EXPOSURE_MAX, EXPOSURES, "--exposure", "STOPS", "stops",         \
      "exposure", NULL, SIZE_AND_COLOUR,                                                                               \
      "Multiply light by 2^STOPS when a PNG file is written; auto: as a light meter measures.", EFFECT_DISPLAY)        \
    X(TONE, enum tone_curve, tone.curve, FINISH, TONE_NONE, 0, 0, TONE_CURVES, "--tone", NULL, NULL, "tone", NULL,     \
      SIZE_AND_COLOUR,                                                                                                 \
      "Tone curve that maps bright light into the range of a PNG file; a field may also be a function f(x) of the "    \
      "light x from 0 on, the same for red, green and blue.",                                                          \
      EFFECT_DISPLAY)                                                                                                  \
    X(FLAG, bool, tone.srgb, FINISH, false, 0, 1, NO_WORDS, "--srgb", NULL, NULL, "srgb", NULL, SIZE_AND_COLOUR,       \
      "Encode PNG files with the sRGB transfer function; without it, values are linear.", EFFECT_DISPLAY)
#define SETTINGS_OF_FINISH(X)                                                                                          \
    X(NUMBER, double, finish.bloom, FINISH, 0, 0, 1, NO_WORDS, "--bloom", "X", NULL, "bloom", NULL, FINISH,            \
      "Spread light above white to the pixels around it, with the weight X.")                                          \
    X(NUMBER, double, finish.vignette, FINISH, 0, 0, 1, NO_WORDS, "--vignette", "X", NULL, "vignette", NULL, FINISH,   \
      "Darken the corners; with X = 1 they have a quarter of their light.")                                            \
    X(FLAG, bool, finish.gray, FINISH, false, 0, 1, NO_WORDS, "--gray", NULL, NULL, "gray", NULL, FINISH,              \
      "A gray picture: the luminance.")                                                                                \
    X(FLAG, bool, finish.edges, FINISH, false, 0, 1, NO_WORDS, "--edges", NULL, NULL, "edges", NULL, FINISH,           \
      "A picture of the edges of the picture, white on black (Sobel); PNG files only.", EFFECT_DISPLAY)                \
    X(FLAG, bool, finish.fxaa, FINISH, false, 0, 1, NO_WORDS, "--fxaa", NULL, NULL, "fxaa", NULL, FINISH,              \
      "Smooth the edges of the finished picture (FXAA); PNG files only.", EFFECT_DISPLAY)                              \
    X(CHOICE, enum dither, finish.dither, FINISH, DITHER_NONE, 0, 0, DITHERS, "--dither", NULL, NULL, "dither", NULL,  \
      FINISH, "Round to 8 bits by a pattern, which removes bands: ordered, or blue noise; PNG files of 8 bits only.",  \
      EFFECT_BYTES)
#define SETTINGS_OF_CAUSTICS(X)                                                                                        \
    X(CAUSTICS, int, caustics.photons, SAMPLES, 0, 0, PHOTONS_MAX, NO_WORDS, "--caustics", "N", NULL, "caustics",      \
      NULL, RAYS,                                                                                                      \
      "Trace N photons for caustics, the light that glass and mirrors focus; 0: none. A field may also have the "      \
      "radius of the disc that each photon lights (default: from their density).")
/* Without a field. */
#define SETTINGS_OF_RUNS(X)                                                                                            \
    X(WHOLE, int, roulette_depth, SAMPLES, 2, 0, DEPTH_MAX, NO_WORDS, "--roulette-depth", "N", NULL, NULL, NULL, RAYS, \
      "Russian roulette may end a path after N scattering events.", EFFECT_PATH)                                       \
    X(NUMBER, double, time_limit, SAMPLES, 0, 0.001, 1e9, NO_WORDS, "--time-limit", "SECONDS", NULL, NULL, "none",     \
      RAYS,                                                                                                            \
      "End a picture after SECONDS. Integrator path adds samples to all pixels until then and prints their number; "   \
      "--spp with this number makes the same picture. With whitted the rest has fewer samples, and a notice.")         \
    X(CHOICE, enum aa_pattern, aa_pattern, SAMPLES, AA_ROTATED, 0, 0, AA_PATTERNS, "--aa-pattern", NULL, NULL, NULL,   \
      NULL, RAYS,                                                                                                      \
      "Which pixels are marked, and where their samples are; rotated: marked by colours, surfaces and thin "           \
      "primitives, samples on a rotated grid; grid: marked by colours only, samples at the centres of N x N cells.",   \
      EFFECT_TREES)                                                                                                    \
    X(CHOICE, bool, view_is_target, SAMPLES, false, 0, 0, VIEW_MEANINGS, "--view", NULL, NULL, NULL, NULL,             \
      OTHER_PROGRAMS, "Meaning of the view argument: a direction, or a point to look at.")                             \
    X(CHOICE, bool, pixel_corner, SAMPLES, false, 0, 0, PIXEL_POSITIONS, "--pixel-sample", NULL, NULL, NULL, NULL,     \
      OTHER_PROGRAMS, "Position of the first sample of a pixel.")                                                      \
    X(CHOICE, bool, ambient_plain, SAMPLES, false, 0, 0, AMBIENT_MEANINGS, "--ambient", NULL, NULL, NULL, NULL,        \
      OTHER_PROGRAMS, "Multiply ambient light by kd, or add it unchanged.", EFFECT_WHITTED)                            \
    X(CHOICE, enum tile_order, tile_order, RUN, TILE_ORDER_SPREAD, 0, 0, TILE_ORDERS, "--tile-order", NULL, NULL,      \
      NULL, NULL, EXECUTION,                                                                                           \
      "Order in which tiles are rendered (in a window always from the centre); the picture is the same.")              \
    X(LAYERS, uint32_t, aov, RUN, 0, 0, AOV_ALL, NO_WORDS, "--aov", "LIST", NULL, NULL, NULL, FILES,                   \
      "For dir/foo.png also write dir/foo.NAME.png for each NAME of LIST, separated by commas:" AOV_NAMES " or all.")  \
    X(CHOICE, enum overlay, overlay, RUN, OVERLAY_NONE, 0, 0, OVERLAYS, "--overlay", NULL, NULL, NULL, NULL, FILES,    \
      "Draw lines over the picture: bounding boxes of all primitives, the cells of the acceleration structure "        \
      "(see --accel), or the patches of integrator radiosity.")                                                        \
    X(CROP, bool, cropped, SAMPLES, false, 0, 1, NO_WORDS, "--crop", "X,Y,W,H", NULL, NULL, "all", SIZE_AND_COLOUR,    \
      "Write a W x H picture, exactly that part of the whole; X,Y is its upper left pixel.")
/* Without an option and without a field. The crop is set by --crop. coarse: rough surfaces send one ray, and lights
 * area_samples of them, instead of their own numbers. passes: the picture is looked at while it is made, so its samples
 * come in passes. keep_first: the first pass is wanted even where -full makes it needless. show_refined: pixels that
 * are to be resampled are marked in the film before (FILM_MARK_WAITS). transparent: lines of sight see no background.
 */
#define SETTINGS_WITHIN(X)                                                                                             \
    X(WHOLE, int, crop_x, SAMPLES, 0, 0, CROP_MAX, NO_WORDS, NULL, NULL, NULL, NULL, NULL, NONE, NULL)                 \
    X(WHOLE, int, crop_y, SAMPLES, 0, 0, CROP_MAX, NO_WORDS, NULL, NULL, NULL, NULL, NULL, NONE, NULL)                 \
    X(WHOLE, int, crop_width, SAMPLES, 0, 0, CROP_MAX, NO_WORDS, NULL, NULL, NULL, NULL, NULL, NONE, NULL)             \
    X(WHOLE, int, crop_height, SAMPLES, 0, 0, CROP_MAX, NO_WORDS, NULL, NULL, NULL, NULL, NULL, NONE, NULL)            \
    X(CHOICE, enum path_strategy, path_strategy, SAMPLES, PATH_STRATEGY_MIS, 0, 0, PATH_STRATEGIES, NULL, NULL, NULL,  \
      NULL, NULL, NONE, NULL)                                                                                          \
    X(CHOICE, enum light_choice, light_choice, SAMPLES, LIGHT_CHOICE_TREE, 0, 0, LIGHT_CHOICES, NULL, NULL, NULL,      \
      NULL, NULL, NONE, NULL)                                                                                          \
    X(FLAG, bool, coarse, SAMPLES, false, 0, 1, NO_WORDS, NULL, NULL, NULL, NULL, NULL, NONE, NULL)                    \
    X(FLAG, bool, transparent, SAMPLES, false, 0, 1, NO_WORDS, NULL, NULL, NULL, NULL, NULL, NONE, NULL)               \
    X(FLAG, bool, passes, RUN, false, 0, 1, NO_WORDS, NULL, NULL, NULL, NULL, NULL, NONE, NULL)                        \
    X(FLAG, bool, keep_first, RUN, false, 0, 1, NO_WORDS, NULL, NULL, NULL, NULL, NULL, NONE, NULL)                    \
    X(FLAG, bool, show_refined, RUN, false, 0, 1, NO_WORDS, NULL, NULL, NULL, NULL, NULL, NONE, NULL)
/* What the file of a light field states. */
#define SETTINGS_OF_GRID(X)                                                                                            \
    X(WHOLE, int, lens.rows, FINISH, 0, 1, LIGHT_FIELD_SIDE, NO_WORDS, NULL, NULL, NULL, NULL, NULL, NONE, NULL)       \
    X(WHOLE, int, lens.columns, FINISH, 0, 1, LIGHT_FIELD_SIDE, NO_WORDS, NULL, NULL, NULL, NULL, NULL, NONE, NULL)    \
    X(NUMBER, double, lens.spacing, FINISH, 0, 0, HUGE_VAL, NO_WORDS, NULL, NULL, NULL, NULL, NULL, NONE, NULL)        \
    X(FLAG, bool, lens.depth, FINISH, false, 0, 1, NO_WORDS, NULL, NULL, NULL, NULL, NULL, NONE, NULL)                 \
    X(NUMBER, double, lens.screen, FINISH, 1, 0, HUGE_VAL, NO_WORDS, NULL, NULL, NULL, NULL, NULL, NONE, NULL)         \
    X(NUMBER, double, lens.fov, FINISH, 0, 0, 180, NO_WORDS, NULL, NULL, NULL, NULL, NULL, NONE, NULL)
#define SETTINGS_OF_RADIUS(X)                                                                                          \
    X(NUMBER, double, caustics.radius, SAMPLES, 0, 0, HUGE_VAL, NO_WORDS, NULL, NULL, NULL, NULL, NULL, NONE, NULL)

/* All lists; those with a field of gr.render come first. */
#define SETTINGS_WITH_FIELD(X) SETTINGS_OF_SCENES(X) SETTINGS_OF_TONE(X) SETTINGS_OF_FINISH(X) SETTINGS_OF_CAUSTICS(X)
#define SETTINGS(X)                                                                                                    \
    SETTINGS_WITH_FIELD(X) SETTINGS_OF_RUNS(X) SETTINGS_WITHIN(X) SETTINGS_OF_RADIUS(X) SETTINGS_OF_GRID(X)

#define SETTING_MEMBER(kind, type, member, ...) type member;
struct settings {
    struct tone tone;     /* of the picture file; the film stays linear */
    struct finish finish; /* of the picture file, too */
    struct caustics caustics;
    struct lens lens; /* this and the next two are arguments of gr.render */
    struct shutter shutter;
    struct camera_motion motion;
    SETTINGS_OF_SCENES(SETTING_MEMBER)
    SETTINGS_OF_RUNS(SETTING_MEMBER)
    SETTINGS_WITHIN(SETTING_MEMBER)
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
/* Of a camera that was moved after the script placed it: it does not move while the shutter is open, and a point in
 * focus that is no longer in front of it leaves the plane at the distance of the point. */
void settings_move_camera(struct settings *settings, const struct camera *to);

static inline double settings_line_width(const struct settings *settings) {
    double of_style = settings->style == STYLE_NONE ? 0 : LINE_WIDTH_DEFAULT;
    return settings->line_width < 0 ? of_style : settings->line_width;
}
/* Whether two settings exclude each other: styles are for the integrator whitted. */
static inline bool settings_exclude(const struct settings *settings) {
    return !integrator_traits(settings->integrator).has_styles && settings->style != STYLE_NONE;
}
/* Whether the picture is denoised. */
static inline bool settings_denoise(const struct settings *settings) {
    return settings->denoise == DENOISER_GRAY || settings->denoise == DENOISER_OIDN;
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
