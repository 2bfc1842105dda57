/* Render layers (AOVs): the hit of the first sample of every pixel, and the cost of the pixel. Each layer has three
 * numbers per pixel; aov_colour converts them to colours, files of linear light (.pfm, .hdr, .exr) have them unchanged.
 */
#ifndef GRAY_FILM_AOV_H
#define GRAY_FILM_AOV_H

#include "base/list.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

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
    X(AOV_TRANSMISSION_INDIRECT, "transmission_indirect", "RGB")
enum aov { AOVS(LIST_MEMBER) };
enum { AOV_COUNT = LIST_COUNT(AOVS) };
#define AOV_ALL ((UINT32_C(1) << AOV_COUNT) - 1)
/* Those of path-traced pictures only, and among them the groups of light. */
#define AOV_PATH (AOV_ALL & ~((UINT32_C(1) << AOV_RAW) - 1))
#define AOV_LIGHT (AOV_ALL & ~((UINT32_C(1) << AOV_EMISSION) - 1))

const char *aov_name(enum aov aov);
const char *aov_channels(enum aov aov); /* one to three letters, one for each number that means something */
/* Names separated by commas, or "all", as a mask. */
bool aov_parse(const char *text, uint32_t *mask);
/* The number of layers of a mask, and the index of a layer. */
uint32_t aov_layers(uint32_t mask);
uint32_t aov_layer(uint32_t mask, enum aov aov);

/* The colour of a value. nearest: the smallest depth of the picture; most: its largest number of samples. */
struct aov_scale {
    double nearest, max;
};
struct aov_scale aov_scale(enum aov aov, const float (*values)[3], size_t count);
void aov_colour(enum aov aov, const struct aov_scale *scale, const float value[3], double rgb[3]);

#endif
