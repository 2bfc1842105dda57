/* What paths find beside radiance: features of the surface that a pixel shows, which guide the denoiser, and groups of
 * light whose sum is the radiance. */
#ifndef GRAY_RENDER_PATH_PARTS_H
#define GRAY_RENDER_PATH_PARTS_H

#include "math/vec3.h"

#include <stdbool.h>

/* What films may record of a path-traced pixel beside its colour. */
enum path_part { PATH_PART_FEATURES = 1, PATH_PART_LIGHT = 2 };

/* Of the first surface that a line of sight meets which scatters light or emits it: behind mirrors and smooth glass. */
enum path_feature {
    PATH_ALBEDO,     /* 3 channels: weights of the lobes, and L / (1 + L) of emission and skies; 0 to 1 */
    PATH_NORMAL = 3, /* 3: the shading normal on the side of the viewer; 0 of skies */
    PATH_DEPTH = 6,  /* length of the line of sight in world units; 0 of skies */
    PATH_GLOW = 7,   /* 3: the light of PATH_LIGHT_EMISSION, which is all but free of noise */
    PATH_FEATURES = 10
};

/* By the first scattering event of a path. Direct: light that was scattered once. */
enum path_light_group {
    PATH_LIGHT_EMISSION, /* not scattered: emission, skies, fog */
    PATH_LIGHT_DIFFUSE_DIRECT,
    PATH_LIGHT_DIFFUSE_INDIRECT,
    PATH_LIGHT_SPECULAR_DIRECT, /* mirrors, glossy surfaces, highlights */
    PATH_LIGHT_SPECULAR_INDIRECT,
    PATH_LIGHT_TRANSMISSION_DIRECT,
    PATH_LIGHT_TRANSMISSION_INDIRECT,
    PATH_LIGHT_GROUPS
};
enum { PATH_SCATTERINGS = (PATH_LIGHT_GROUPS - 1) / 2 };

/* Of one camera ray. */
struct path_parts {
    bool surface_known; /* the features are there */
    float features[PATH_FEATURES];
    struct vec3 light[PATH_LIGHT_GROUPS];
    /* How much of what comes after the first scattering event belongs to each kind of scattering: diffuse, specular,
     * transmission, by channel; the sum is 1. */
    struct vec3 shares[PATH_SCATTERINGS];
};

#endif
