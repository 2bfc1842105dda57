/* What can be changed of a light and of the base of a material, and how. */
#ifndef GRAY_SCENE_CHANGE_LOOK_H
#define GRAY_SCENE_CHANGE_LOOK_H

#include "light/light.h"
#include "material/material.h"

/* A turn and a size that a light can be given: 3 rows of 3, the linear part of a map about its place. */
enum { TURN_NUMBERS = 9 };

/* Whether a change of its place, its turn, its size is to be seen. A lamp that is a mesh goes with its node; the size
 * of a spot is the width of its cone, that of a light without an extent is its range. */
bool light_can_move(const struct light *light);
bool light_can_turn(const struct light *light);
bool light_can_size(const struct light *light);
void light_move(struct light *light, struct vec3 way);
/* The turn has an inverse. Lengths without a direction grow by the cube root of its determinant. The half angle h of a
 * spot's cone becomes h' with tan(h'/2) = size tan(h/2), which keeps every cone between nothing and everything. */
void light_turn(struct light *light, const double turn[TURN_NUMBERS]);
/* The determinant of a turn. */
/* The turn about the y axis that is nearest to a map; false: there is none (what it takes the x and z axes to says
 * nothing). */
bool turn_about_y(const double turn[TURN_NUMBERS], double *sine, double *cosine);
double light_turn_volume(const double turn[TURN_NUMBERS]);

/* Parts of a base (MATERIAL_PHONG), by the names that scripts use. */
enum look_part {
    LOOK_KD,
    LOOK_KS,
    LOOK_SHININESS,
    LOOK_REFLECT,
    LOOK_ROUGHNESS,
    LOOK_REFRACT,
    LOOK_IOR,
    LOOK_EMISSION,
    LOOK_ABSORPTION,
    LOOK_PARTS
};
const char *look_part_name(enum look_part part);
/* 3 for a colour, else 1. */
int look_part_count(enum look_part part);
/* The numbers a part may have: from *low to *high, both included; they may be infinite. */
void look_part_range(enum look_part part, double *low, double *high);
void look_part_get(const struct material *base, enum look_part part, double numbers[3]);
void look_part_set(struct material *base, enum look_part part, const double numbers[3]);
/* The world that was built does not depend on it. */
bool look_part_keeps_world(enum look_part part);

#endif
