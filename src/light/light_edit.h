/* What can be changed of a light, and how. */
#ifndef GRAY_LIGHT_LIGHT_EDIT_H
#define GRAY_LIGHT_LIGHT_EDIT_H

#include "light/light.h"

/* A turn and a size that a light can be given: 3 rows of 3, the linear part of a map about its place. */
enum { TURN_NUMBERS = 9 };

/* Whether a change of its place, its turn, its size is to be seen. A lamp that is a mesh goes with its node; the size
 * of a spot is the width of its cone, that of a light without an extent is its range. */
bool light_can_move(const struct light *light);
bool light_can_turn(const struct light *light);
bool light_can_size(const struct light *light);
void light_move(struct light *light, struct vec3 offset);
/* The turn has an inverse. Lengths without a direction grow by the cube root of its determinant. The half angle h of a
 * spot's cone becomes h' with tan(h'/2) = size tan(h/2), which keeps every cone between nothing and everything. */
void light_turn(struct light *light, const double turn[TURN_NUMBERS]);
/* How far the sky of a light was turned about the y axis: by the angle of this sine and cosine. Zero: not at all. */
struct sky_turn {
    bool turned;
    double sine, cosine;
};
/* What light_turn leaves of a light that is an environment: its sky is turned further. Nothing of other lights. */
void light_turn_sky(const struct light *light, const double turn[TURN_NUMBERS], struct sky_turn *sky);
/* The turn about the y axis that is nearest to a map; false: there is none (what it takes the x and z axes to says
 * nothing). */
bool turn_about_y(const double turn[TURN_NUMBERS], double *sine, double *cosine);
/* The determinant of a turn. */
double light_turn_volume(const double turn[TURN_NUMBERS]);

#endif
