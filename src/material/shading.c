/* The lobes of SPEC 1.2 and the two laws of specular directions. */
#include "material/shading.h"

#include "math/elementary.h"

/* Power with the usual small whole exponents done by multiplication would be faster but rounds differently for
 * neighbouring exponents; el_pow is the same function for all. 0^0 = 1, as old scenes with shininess 0 expect. */
static double lobe_power(double cosine, double exponent) {
    return el_pow(cosine, exponent);
}

struct vec3 shading_evaluate(const struct shading *shading, struct vec3 normal, struct vec3 view,
                             struct vec3 to_light) {
    double n_l = vec3_dot(normal, to_light);
    struct vec3 sum = {0, 0, 0};
    if (!(n_l > 0))
        return sum;
    for (int i = 0; i < shading->count; i++) {
        const struct lobe *lobe = &shading->lobes[i];
        double factor = 0;
        switch (lobe->kind) {
        case LOBE_DIFFUSE:
            factor = n_l;
            break;
        case LOBE_PHONG: {
            double r_v = vec3_dot(vec3_sub(vec3_scale(normal, 2 * n_l), to_light), view);
            factor = r_v > 0 ? lobe_power(r_v, lobe->exponent) : 0;
            break;
        }
        case LOBE_BLINN: {
            double n_h = vec3_dot(normal, vec3_normalize(vec3_add(to_light, view)));
            factor = n_h > 0 ? lobe_power(n_h, lobe->exponent) : 0;
            break;
        }
        case LOBE_MIRROR:
        case LOBE_REFRACT:
            continue;
        }
        sum = vec3_add_scaled(sum, lobe->weight, factor);
    }
    return sum;
}

struct vec3 shading_reflect(struct vec3 normal, struct vec3 view) {
    return vec3_sub(vec3_scale(normal, 2 * vec3_dot(normal, view)), view);
}

bool shading_refract(struct vec3 normal, struct vec3 view, double eta, struct vec3 *out) {
    double cos_view = vec3_dot(normal, view);
    double sin2 = eta * eta * (1 - cos_view * cos_view);
    if (sin2 >= 1)
        return false;
    double cos_other = sqrt(1 - sin2);
    *out = vec3_add(vec3_scale(view, -eta), vec3_scale(normal, eta * cos_view - cos_other));
    return true;
}

double shading_fresnel(double cos_view, double eta) {
    double sin2 = eta * eta * (1 - cos_view * cos_view);
    if (sin2 >= 1)
        return 1;
    /* In units of the far side's index: n_view = eta, n_other = 1. */
    double cos_other = sqrt(1 - sin2);
    double s = (eta * cos_view - cos_other) / (eta * cos_view + cos_other);
    double p = (cos_view - eta * cos_other) / (cos_view + eta * cos_other);
    return 0.5 * (s * s + p * p);
}
