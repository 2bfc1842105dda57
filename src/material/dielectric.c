/* See dielectric_internal.h. */
#include "material/dielectric_internal.h"

struct vec3 dielectric_mirror(struct vec3 normal, struct vec3 view) {
    return vec3_sub(vec3_scale(normal, 2 * vec3_dot(normal, view)), view);
}

bool dielectric_refract(struct vec3 normal, struct vec3 view, double eta, struct vec3 *out) {
    double cos_view = vec3_dot(normal, view);
    double sin2 = eta * eta * (1 - cos_view * cos_view);
    if (sin2 >= 1)
        return false;
    double cos_other = sqrt(1 - sin2);
    *out = vec3_add(vec3_scale(view, -eta), vec3_scale(normal, eta * cos_view - cos_other));
    return true;
}

double dielectric_fresnel(double cos_view, double eta) {
    double sin2 = eta * eta * (1 - cos_view * cos_view);
    if (sin2 >= 1)
        return 1;
    /* In units of the far side's index: n_view = eta, n_other = 1. */
    double cos_other = sqrt(1 - sin2);
    double s = (eta * cos_view - cos_other) / (eta * cos_view + cos_other);
    double p = (cos_view - eta * cos_other) / (cos_view + eta * cos_other);
    return 0.5 * (s * s + p * p);
}
