/* Phase functions: how the particles of a medium scatter light, as a density of directions by solid angle. wo points to
 * where a path comes from, wi to where it goes on, both of unit length: light that is not deflected has wi = -wo. */
#ifndef GRAY_MATERIAL_PHASE_H
#define GRAY_MATERIAL_PHASE_H

#include "math/sampling.h"
#include "math/vec3.h"

enum phase_kind {
    PHASE_HENYEY_GREENSTEIN, /* g: the mean cosine of the angle of deflection; 0: isotropic */
    PHASE_RAYLEIGH,          /* particles much smaller than the wavelength */
};

struct phase {
    enum phase_kind kind;
    double g; /* in (-1, 1) */
};

/* Per steradian; it is also the density of phase_sample. */
double phase_eval(const struct phase *phase, struct vec3 wo, struct vec3 wi);
/* wi for a point of the unit square. */
struct vec3 phase_sample(const struct phase *phase, struct vec3 wo, struct sample2 u);

#endif
