/* Bounds of lights, by which one of many is chosen. */
#ifndef GRAY_LIGHT_LIGHT_BOUNDS_H
#define GRAY_LIGHT_LIGHT_BOUNDS_H

#include "light/light.h"

/* Bounds of a light, or of several together. */
struct light_bounds {
    struct box box; /* of the emitting points */
    /* The light leaves from normals within theta_o of the axis (unit), in directions within theta_e of these. */
    struct vec3 axis;
    double cos_theta_o, cos_theta_e;
    bool two_sided; /* ... and likewise about the opposite of the axis */
    /* The radiance of a white surface that faces it at distance d, averaged over colours and visible sides:
     * steady + fading / (falloff[0] + falloff[1] d + falloff[2] d^2), nothing beyond `range`. */
    double steady, attenuation, falloff[3], range;
    struct vec3 centre; /* the rest is computed from the fields above: a ball around the box */
    double radius, sin_theta_o;
};
/* The bounds of both. */
struct light_bounds light_bounds_join(const struct light_bounds *a, const struct light_bounds *b);
/* An estimate of its contribution at a surface with that normal (both sides; {0,0,0}: at a point without a surface). 0:
 * none. */
double light_bounds_importance(const struct light_bounds *bounds, struct vec3 point, struct vec3 normal);

/* The attenuation of a delta light at a distance. */
double light_attenuation(const struct light *light, double distance);
/* Share of a spot's light in the unit direction from the light: 1 inside the inner cone, 0 outside the outer, between
 * them the cubic 3 s^2 - 2 s^3 of the cosine. */
double light_cone(const struct light *light, struct vec3 from_light);
/* Cuts the part of a line (unit direction) to where the light may shine: a narrow spot only in its cone. False: nowhere.
 */
bool light_cut(const struct light *light, struct vec3 origin, struct vec3 direction, double *from, double *to);

/* A delta light: from its attenuation. */
void light_bounds_fade(const struct light *light, struct light_bounds *out);
/* Computes the other fields of the bounds; false: no emission. */
bool light_bounds_finish(struct light_bounds *bounds);

#endif
