/* The index of refraction as a function of the wavelength: Sellmeier's formula of a glass (glasses.h), or Cauchy's law
 * n = a + b / wavelength^2 by Abbe's number (OpenPBR Surface 1.1). Materials state their index at the line d of helium,
 * which white light has. */
#ifndef GRAY_MATERIAL_DISPERSION_H
#define GRAY_MATERIAL_DISPERSION_H

#include <stdbool.h>
#include <stdint.h>

struct dispersion {
    double amount;  /* 0: none. By Cauchy's law a factor over Abbe's number, of a glass the factor alone */
    uint32_t glass; /* its number in glasses.h, from 1; 0: Cauchy's law */
};

/* The index for a wavelength in micrometres (0: white light) of a medium with `ior` at the line d. n - 1 is that of
 * the glass or of the law, times a number. */
double dispersion_ior(struct dispersion dispersion, double ior, double wavelength);
/* The index at the line d of a glass by its number from 1. */
double glass_ior(uint32_t glass);

static inline bool dispersion_equal(struct dispersion a, struct dispersion b) {
    return a.amount == b.amount && a.glass == b.glass;
}

#endif
