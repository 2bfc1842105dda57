/* See spectrum.h. */
#include "math/spectrum.h"

#include "math/elementary.h"

#include "math/spectrum_tables_internal.h"

enum { QUANTILES = sizeof quantiles / sizeof *quantiles - 1 };

/* Two halves of bells with the inverse widths `below` and `above` the middle, in nanometres. */
static double lobe(double nanometres, double middle, double below, double above) {
    double t = (nanometres - middle) * (nanometres < middle ? below : above);
    return el_exp(-0.5 * t * t);
}

struct colour spectrum_colour(double wavelength) {
    double w = 1000 * wavelength;
    double x = 0.362 * lobe(w, 442.0, 0.0624, 0.0374) + 1.056 * lobe(w, 599.8, 0.0264, 0.0323) -
               0.065 * lobe(w, 501.1, 0.0490, 0.0382);
    double y = 0.821 * lobe(w, 568.8, 0.0213, 0.0247) + 0.286 * lobe(w, 530.9, 0.0613, 0.0322);
    double z = 1.217 * lobe(w, 437.0, 0.0845, 0.0278) + 0.681 * lobe(w, 459.0, 0.0385, 0.0725);
    return colour_make((3.2404542 * x - 1.5371385 * y - 0.4985314 * z) / white[0],
                       (-0.9692660 * x + 1.8760108 * y + 0.0415560 * z) / white[1],
                       (0.0556434 * x - 0.2040259 * y + 1.0572252 * z) / white[2]);
}

/* Each interval between quantiles has the same share of the wavelengths, evenly. */
static struct colour weight_in(int interval, double wavelength) {
    return colour_scale(spectrum_colour(wavelength), QUANTILES * (quantiles[interval + 1] - quantiles[interval]));
}

double spectrum_sample(double u, struct colour *weight) {
    double at = u * QUANTILES;
    int interval = (int)at < QUANTILES ? (int)at : QUANTILES - 1;
    double wavelength = quantiles[interval] + (at - interval) * (quantiles[interval + 1] - quantiles[interval]);
    *weight = weight_in(interval, wavelength);
    return wavelength;
}

struct colour spectrum_weight(double wavelength) {
    int interval = 0;
    while (interval + 1 < QUANTILES && wavelength >= quantiles[interval + 1])
        interval++;
    return weight_in(interval, wavelength);
}

struct colour spectrum_node_weight(int i) {
    return node_weights[i];
}

/* Planck's law, by wavelength. */
static struct colour planck(double kelvin) {
    const double c2 = 14387.768775; /* second radiation constant, in micrometres times kelvin */
    struct colour sum = {0, 0, 0};
    for (int i = 0; i < SPECTRUM_NODES; i++) {
        double wave = 1 / spectrum_node(i),
               power = 1 / (wave * wave * wave * wave * wave * el_expm1(c2 / (wave * kelvin)));
        sum = colour_add_scaled(sum, spectrum_node_weight(i), power);
    }
    return sum;
}

struct colour spectrum_black_body(double kelvin) {
    struct colour one = planck(2000), own = colour_max(planck(kelvin), colour_all(0));
    return colour_scale(own, 3 / (one.r + one.g + one.b));
}
