/* See dispersion.h. */
#include "material/dispersion.h"

#include "material/glasses.h"

#include <math.h>

/* Too strong a dispersion has no index for long waves. */
static const double smallest = 0.01;

/* The lines d (helium), F and C (hydrogen) of Abbe's number (n_d - 1) / (n_F - n_C). */
static const double line_d = 0.5875618, line_f = 0.4861327, line_c = 0.6562725;

enum { TERMS = 4 };
struct glass {
    double b[TERMS], c[TERMS];
};
#define GLASS(name, b1, b2, b3, b4, c1, c2, c3, c4) {{b1, b2, b3, b4}, {c1, c2, c3, c4}},
static const struct glass glasses[] = {GLASSES(GLASS)};

static double sellmeier(const struct glass *glass, double wavelength) {
    double square = wavelength * wavelength, sum = 1;
    for (int i = 0; i < TERMS; i++)
        sum += glass->b[i] * square / (square - glass->c[i]);
    return sqrt(sum);
}

double glass_ior(uint32_t glass) {
    return sellmeier(&glasses[glass - 1], line_d);
}

static double inverse_square(double wavelength) {
    return 1 / (wavelength * wavelength);
}

/* The relative change of n - 1. */
static double change(uint32_t glass, double wavelength) {
    if (glass > 0) {
        double d = glass_ior(glass);
        return (sellmeier(&glasses[glass - 1], wavelength) - d) / (d - 1);
    }
    return (inverse_square(wavelength) - inverse_square(line_d)) / (inverse_square(line_f) - inverse_square(line_c));
}

double dispersion_ior(struct dispersion dispersion, double ior, double wavelength) {
    if (!(dispersion.amount > 0 && wavelength > 0))
        return ior;
    double at = 1 + (ior - 1) * (1 + dispersion.amount * change(dispersion.glass, wavelength));
    return at > smallest ? at : smallest;
}
