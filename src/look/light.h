/* Lights. Positions are world coordinates; falloff {0,0,0} counts as {1,0,0}. */
#ifndef GRAY_LOOK_LIGHT_H
#define GRAY_LOOK_LIGHT_H

#include "math/vec3.h"

enum light_kind { LIGHT_POINT, LIGHT_PARALLELOGRAM };

struct light {
    enum light_kind kind;
    struct vec3 position; /* of a parallelogram: its centre */
    struct vec3 corner, edge1, edge2;
    struct vec3 colour;
    double falloff[3];
};

/* 1 / (c0 + c1 d + c2 d^2). */
double light_attenuation(const struct light *light, double distance);

#endif
