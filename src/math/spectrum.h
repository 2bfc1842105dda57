/* Wavelengths as colours. The observer is the CIE's of 1931 (2 degrees), as fitted by C. Wyman, P.-P. Sloan and P.
 * Shirley, "Simple Analytic Approximations to the CIE XYZ Color Matching Functions", JCGT 2013, in linear sRGB without
 * limits: single wavelengths have negative components. White light has the same power at all wavelengths, and each
 * component is scaled so that white is {1, 1, 1}. Wavelengths are in vacuum, in micrometres, from 0.38 to 0.76. */
#ifndef GRAY_MATH_SPECTRUM_H
#define GRAY_MATH_SPECTRUM_H

#include "math/colour.h"

#define SPECTRUM_MIN 0.38
#define SPECTRUM_MAX 0.76

/* Of white light, per micrometre: the integral over all wavelengths is {1, 1, 1}. */
struct colour spectrum_colour(double wavelength);

/* A wavelength for u in [0, 1), more often where the eye sees more; *weight: its colour over its density, whose mean
 * over u is {1, 1, 1}. */
double spectrum_sample(double u, struct colour *weight);
/* The same weight, by the wavelength. */
struct colour spectrum_weight(double wavelength);

/* Nodes at the middles of equal steps of 1 / wavelength, and the weights of a mean over white light. */
enum { SPECTRUM_NODES = 40 };
static inline double spectrum_node(int i) {
    return 1 / SPECTRUM_MAX + (i + 0.5) * ((1 / SPECTRUM_MIN - 1 / SPECTRUM_MAX) / SPECTRUM_NODES);
}
struct colour spectrum_node_weight(int i);

/* A black body of this temperature in kelvin, over the mean of the components at 2,000 K; components are at least 0. */
struct colour spectrum_black_body(double kelvin);

#endif
