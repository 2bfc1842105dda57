/* The defaults of SPEC part 3. */
#include "render/settings.h"

struct settings settings_default(void) {
    return (struct settings){.samples = 3,
                             .reflect_limit = 2,
                             .refract_limit = 4,
                             .side_tolerance = 0.005,
                             .corner_tolerance = 0.01,
                             .area_samples = 4,
                             .specular = SPECULAR_PHONG,
                             .accel = ACCEL_AUTO,
                             .shutter = {0, 1},
                             .cutoff = 0.0001,
                             .lens = {.view_height = 2, .angle = 180, .screen = 1}};
}
