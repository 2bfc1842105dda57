/* The kinds of sky that fill a file of their own, for sky.c. */
#ifndef GRAY_LIGHT_SKY_PARTS_H
#define GRAY_LIGHT_SKY_PARTS_H

#include "light/sky.h"

/* sky_map.c: an image of longitude by latitude. */
struct vec3 sky_map_colour(const struct image *image, struct vec3 direction, double spread);
/* sky_clear.c: never negative. */
struct vec3 sky_clear_colour(const struct clear_sky *clear, struct vec3 direction);

#endif
