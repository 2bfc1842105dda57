/* See phase.h. Henyey and Greenstein, "Diffuse radiation in the Galaxy", Astrophysical Journal 93, 1941. Rayleigh's
 * function is sampled after Frisvad, "Importance sampling the Rayleigh phase function", JOSA A 28, 2011. */
#include "material/phase.h"

#include "math/elementary.h"
#include "math/frame.h"

#include <math.h>

/* The cosine of the deflection for u in [0, 1]. Inverting the cumulative function gives (1 + g^2 - q^2) / (2 g) with
 * q = (1 - g^2) / (1 + g s) and s = 2 u - 1; multiplied out, g = 0 is no special case. */
static double henyey_greenstein_cosine(double g, double u) {
    double s = 2 * u - 1, r = 1 + g * s;
    return (s + g * (0.5 * (3 + s * s) + g * (s - 0.5 * g * (1 - s * s)))) / (r * r);
}

/* The root of c^3 + 3 c = 8 u - 4. */
static double rayleigh_cosine(double u) {
    double q = fabs(4 * u - 2), t = el_cbrt(q + sqrt(q * q + 1)), c = t - 1 / t;
    return u < 0.5 ? -c : c;
}

double phase_eval(const struct phase *phase, struct vec3 wo, struct vec3 wi) {
    double c = -vec3_dot(wo, wi), g = phase->g;
    switch (phase->kind) {
    case PHASE_HENYEY_GREENSTEIN: {
        double square = (1 - g) * (1 - g) + 2 * g * (1 - c);
        return (1 - g * g) / (2 * TURN * square * sqrt(square));
    }
    case PHASE_RAYLEIGH:
        return 3 / (8 * TURN) * (1 + c * c);
    }
    return 0;
}

struct vec3 phase_sample(const struct phase *phase, struct vec3 wo, struct sample2 u) {
    double c = 0, sine, cosine;
    switch (phase->kind) {
    case PHASE_HENYEY_GREENSTEIN:
        c = henyey_greenstein_cosine(phase->g, u.x);
        break;
    case PHASE_RAYLEIGH:
        c = rayleigh_cosine(u.x);
        break;
    }
    c = math_min(math_max(c, -1), 1);
    struct vec3 forward = vec3_negate(wo), side, up;
    frame_tangents(forward, &side, &up);
    el_sincos(TURN * u.y, &sine, &cosine);
    double r = sqrt(1 - c * c);
    return vec3_normalize(vec3_add_scaled(vec3_add_scaled(vec3_scale(forward, c), side, r * cosine), up, r * sine));
}
