/* Classic light and radiance. A diffuse surface of the scene language answers light of intensity I from the direction l
 * with kd I (n.l) (docs/language.md 5.2); a Lambertian surface of albedo kd answers radiance L from the solid angle w
 * with kd / pi L w (n.l). So radiance L from the solid angle w is intensity L w / pi, a formula of docs/language.md 5.2
 * is pi f |cos| of a BSDF f, and a white surface that sees nothing but a light of radiance L has the radiance L. This
 * is the only place with that pi (docs/light.md). */
#ifndef GRAY_MATERIAL_CLASSIC_H
#define GRAY_MATERIAL_CLASSIC_H

#include "math/elementary.h"

/* Of radiance times solid angle; of a classic formula f |cos|. Where a solid angle or an area is pi x by its formula,
 * its intensity x is written down at once. */
static inline double intensity_of(double radiance) {
    return radiance / PI;
}
/* The radiance that has that intensity from the unit solid angle. */
static inline double radiance_of(double intensity) {
    return intensity * PI;
}

#endif
