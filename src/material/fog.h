/* Fog: what a ray sees is attenuated along the ray, and the colour of the fog is added. It fills the open air, not the
 * inside of transparent solids, and dims sight only, not the light of lamps. */
#ifndef GRAY_MATERIAL_FOG_H
#define GRAY_MATERIAL_FOG_H

#include "math/vec3.h"

#include <stdbool.h>
#include <stdint.h>

enum fog_kind {
    FOG_EXPONENTIAL, /* exp(-density d) */
    FOG_SQUARED,     /* exp(-(density d)^2) */
    FOG_LINEAR,      /* 1 before near, 0 beyond far, linear between */
    FOG_HEIGHT,      /* density exp(-(y - base) / scale), integrated along the ray */
    FOG_PROFILE,     /* a density for every height, linear between, constant beyond; integrated */
    FOG_GRID,        /* a density for every cell of a box, none outside; integrated */
};

/* Arrays belong to the script's arena. */
struct fog {
    enum fog_kind kind;
    struct vec3 colour;
    double density;
    double near, far;
    double base, scale;
    uint32_t count; /* of the profile: heights never fall */
    const double *heights, *densities;
    const double *sums; /* of the profile: integral of the density from heights[0] to heights[i] */
    struct vec3 corner, size;
    uint32_t cells[3]; /* densities[x + cells[0] (y + cells[1] z)] */
    bool clear_sky;    /* the sky is seen without fog */
};

/* The share of what is `distance` away (INFINITY too) along the unit direction that is still seen; 0..1. */
double fog_transmittance(const struct fog *fog, struct vec3 origin, struct vec3 direction, double distance);

#endif
