/* Classic intensity and radiance. A diffuse surface of the scene language reflects kd I (n.l) of light with intensity I
 * from the direction l (docs/language.md 5.2); a Lambertian surface of albedo kd reflects kd / pi L w (n.l) of radiance
 * L from the solid angle w. So radiance L from the solid angle w is intensity L w / pi, a formula of
 * docs/language.md 5.2 is pi f |cos| of a BSDF f, and a white surface whose whole hemisphere has radiance L reflects
 * radiance L. This is the only place with that pi (docs/design/light.md). */
#ifndef GRAY_MATERIAL_CLASSIC_H
#define GRAY_MATERIAL_CLASSIC_H

#include "math/elementary.h"

/* Of radiance times solid angle; of a classic formula f |cos|. Where a solid angle or an area is pi x by its formula,
 * its intensity x is written down at once. */
static inline double intensity_of(double radiance) {
    return radiance / PI;
}
/* The radiance with that intensity from the unit solid angle. */
static inline double radiance_of(double intensity) {
    return intensity * PI;
}

#endif
