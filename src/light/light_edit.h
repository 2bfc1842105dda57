/* Changes of lights, and what listings and editors show of them. */
#ifndef GRAY_LIGHT_LIGHT_EDIT_H
#define GRAY_LIGHT_LIGHT_EDIT_H

#include "light/light.h"

const char *light_kind_name(enum light_kind kind);
enum light_property {
    LIGHT_HAS_POSITION = 1,  /* that of its own */
    LIGHT_HAS_DIRECTION = 2, /* the direction of emission, or the normal of a disc */
    LIGHT_HAS_EDGES = 4,
    LIGHT_HAS_RADIUS = 8,     /* about its direction, where it has one */
    LIGHT_HAS_CONE = 16,      /* about its direction */
    LIGHT_HAS_RANGE = 32,     /* its range grows with it */
    LIGHT_IS_ENVIRONMENT = 64 /* it comes from all sides, mirrors show it, and it rotates only about the y axis */
};
unsigned light_properties(const struct light *light);
/* The centre of a light with a position, and of a mesh once the world is built. False: there is none. */
bool light_centre(const struct light *light, struct vec3 *out);
/* Whether a ray towards it finds its light, from the light or from its mesh or sky, so that a mirror shows it. */
bool light_is_seen(const struct light *light);

/* A rotation and a scale for a light: 3 rows of 3, the linear part of a map about its position. */
enum { TURN_NUMBERS = 9 };

/* Whether a change of its position, rotation or scale has an effect. A mesh light moves with its node; the scale of a
 * spot changes the width of its cone, that of another delta light its range. */
bool light_can_move(const struct light *light);
bool light_can_turn(const struct light *light);
bool light_can_size(const struct light *light);
void light_move(struct light *light, struct vec3 offset);
/* The map has an inverse. Lengths without a direction are scaled by the cube root of its determinant. The half angle h
 * of a spot's cone becomes h' with tan(h'/2) = size tan(h/2), which stays between 0 and 180 degrees. */
void light_turn(struct light *light, const double turn[TURN_NUMBERS]);
/* How far the sky of a light was turned about the y axis: by the angle of this sine and cosine. Zero: not at all. */
struct sky_turn {
    bool turned;
    double sine, cosine;
};
/* What light_turn leaves of a light that is an environment: its sky is turned further. Nothing of other lights. */
void light_turn_sky(const struct light *light, const double turn[TURN_NUMBERS], struct sky_turn *sky);
/* The rotation about the y axis that is nearest to a map; false: there is none (the images of the x and z axes do not
 * determine it). */
bool turn_about_y(const double turn[TURN_NUMBERS], double *sine, double *cosine);
/* The determinant of such a map. */
double light_turn_volume(const double turn[TURN_NUMBERS]);

#endif
