/* The parts that paths record besides radiance: features of the visible surface, which guide the denoiser, and
 * groups of light, whose sum is the radiance. */
#ifndef GRAY_FILM_PATH_PARTS_H
#define GRAY_FILM_PATH_PARTS_H

#include "math/colour.h"

#include <stdbool.h>

/* The parts that films may record for a path-traced pixel besides its colour. */
enum path_part {
    PATH_PART_FEATURES = 1,
    PATH_PART_LIGHT = 2,
    PATH_PART_LINE = 4,
    PATH_PART_ALPHA = 8,
    PATH_PART_BRIGHT = 16, /* the sums of weights of RESOLVE_BRIGHT */
    PATH_PARTS = 31
};

/* Features of the first surface on a line of sight that scatters or emits light; mirrors and smooth glass in front
 * of it are skipped. But the light that the first smooth glass reflects counts as white albedo: chance chooses
 * between reflection and refraction, and this share shows the outline of the glass without noise. */
enum path_feature {
    PATH_ALBEDO,     /* 3 channels, 0 to 1: weights of the lobes, or L / (1 + L) of emission and skies */
    PATH_NORMAL = 3, /* 3 channels: the shading normal on the side of the viewer; 0 for skies */
    PATH_DEPTH = 6,  /* length of the line of sight in world units; 0 for skies */
    PATH_GLOW = 7,   /* 3 channels: the light of PATH_LIGHT_EMISSION, which has almost no noise */
    PATH_FEATURES = 10
};

/* Groups by the first scattering event of a path. Direct: light that was scattered once. */
enum path_light_group {
    PATH_LIGHT_EMISSION, /* not scattered: emission, skies, fog */
    PATH_LIGHT_DIFFUSE_DIRECT,
    PATH_LIGHT_DIFFUSE_INDIRECT,
    PATH_LIGHT_SPECULAR_DIRECT, /* mirrors, glossy surfaces, highlights */
    PATH_LIGHT_SPECULAR_INDIRECT,
    PATH_LIGHT_TRANSMISSION_DIRECT,
    PATH_LIGHT_TRANSMISSION_INDIRECT,
    PATH_LIGHT_VOLUME_DIRECT, /* media */
    PATH_LIGHT_VOLUME_INDIRECT,
    PATH_LIGHT_GROUPS
};
enum { PATH_SCATTERINGS = (PATH_LIGHT_GROUPS - 1) / 2 };

/* Of one camera ray. */
struct path_parts {
    bool surface_known; /* the features are there */
    double travelled;   /* along the line of sight, to its last surface */
    double reflected;   /* the share of light that the first smooth glass reflects; 0 without glass */
    struct colour seen; /* this share of the path's weight at the glass, which may be seen in a mirror */
    float features[PATH_FEATURES];
    struct colour light[PATH_LIGHT_GROUPS];
    /* For each kind of scattering (diffuse, specular, transmission, volume) and each channel: its fraction of the light
     * after the first scattering event. The fractions add up to 1. */
    struct colour shares[PATH_SCATTERINGS];
};

#endif
