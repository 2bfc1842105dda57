/* Fog: attenuates light along lines of sight and adds its colour. It is outside of transparent solids only, and does
 * not attenuate the light of lamps. */
#ifndef GRAY_MATERIAL_FOG_H
#define GRAY_MATERIAL_FOG_H

#include "base/bundle.h"
#include "math/colour.h"
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
    FOG_FIELD,       /* a density and perhaps a colour as functions of the point, in a box (fog_field.h) */
};

struct fog_field;

/* Arrays belong to the script's arena. */
struct fog {
    enum fog_kind kind;
    struct colour colour; /* a bound, where the field has colours */
    bool display;         /* `colour` is a display colour */
    double density;
    double near, far;
    double base, scale;
    uint32_t count; /* of the profile: heights never decrease */
    const double *heights, *densities;
    const double *sums; /* of the profile: integral of the density from heights[0] to heights[i] */
    struct vec3 corner, size;
    uint32_t cells[3]; /* densities[x + cells[0] (y + cells[1] z)] */
    const struct fog_field *field;
    bool clear_sky; /* fog does not affect the sky */
};

/* The transmittance over `distance` (may be INFINITY) along the unit direction; 0..1. Of FOG_FIELD at time 0. */
double fog_transmittance(const struct fog *fog, struct vec3 origin, struct vec3 direction, double distance);
/* What it points to (base/bundle.h). */
bundle_fields fog_bundle;

#endif
