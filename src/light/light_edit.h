/* Changes of lights. */
#ifndef GRAY_LIGHT_LIGHT_EDIT_H
#define GRAY_LIGHT_LIGHT_EDIT_H

#include "light/light.h"

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
