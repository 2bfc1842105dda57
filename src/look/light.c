/* Attenuation of point-like lights. */
#include "look/light.h"

double light_attenuation(const struct light *light, double distance) {
    const double *c = light->falloff;
    if (c[0] == 0 && c[1] == 0 && c[2] == 0)
        return 1;
    return 1 / (c[0] + c[1] * distance + c[2] * distance * distance);
}
