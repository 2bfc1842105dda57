/* How lights without a body fade: by distance, and a spot by its cone (docs/light.md). */
#include "light/light_internal.h"
#include "math/range.h"

/* Where a falloff passes through zero, or a light is touched. A colour times it is finite. */
static const double strongest = 1e200;

double light_attenuation(const struct light *light, double distance) {
    const double *c = light->falloff;
    switch (light->attenuation) {
    case ATTENUATION_RANGE:
        return distance < light->range ? 1 - distance / light->range : 0;
    case ATTENUATION_INVERSE_SQUARE:
        return number_clamped(light->intensity / (distance * distance), strongest);
    case ATTENUATION_COEFFICIENTS:
        break;
    }
    if (c[0] == 0 && c[1] == 0 && c[2] == 0)
        return 1;
    return number_clamped(1 / (c[0] + c[1] * distance + c[2] * distance * distance), strongest);
}

/* Share of a spot's light in the unit direction from the light: 1 inside the inner cone, 0 outside the outer, between
 * them the cubic 3 s^2 - 2 s^3 of the cosine. */
double light_cone(const struct light *light, struct vec3 from_light) {
    double cosine = vec3_dot(light->direction, from_light);
    if (cosine >= light->cos_inner)
        return 1;
    if (cosine <= light->cos_outer)
        return 0;
    double s = (cosine - light->cos_outer) / (light->cos_inner - light->cos_outer);
    return s * s * (3 - 2 * s);
}

void light_bounds_fade(const struct light *light, struct light_bounds *out) {
    double strength = light_magnitude(light->colour);
    const double *c = light->falloff;
    switch (light->attenuation) {
    case ATTENUATION_RANGE:
        out->steady = strength;
        out->range = light->range;
        return;
    case ATTENUATION_INVERSE_SQUARE:
        out->attenuation = strength * fabs(light->intensity);
        out->falloff[2] = 1;
        return;
    case ATTENUATION_COEFFICIENTS:
        break;
    }
    bool constant = c[1] == 0 && c[2] == 0;
    if (constant)
        out->steady = c[0] != 0 ? strength / fabs(c[0]) : strength;
    else
        out->attenuation = strength;
    for (int i = 0; i < 3 && !constant; i++)
        out->falloff[i] = fabs(c[i]);
}
