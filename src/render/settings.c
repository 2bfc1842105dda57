/* The defaults of docs/language.md 13. */
#include "render/settings.h"

#include <math.h>

struct settings settings_default(void) {
    return (struct settings){.samples = 3,
                             .reflect_limit = 2,
                             .refract_limit = 4,
                             .side_tolerance = 0.005,
                             .corner_tolerance = 0.01,
                             .area_samples = 4,
                             .max_depth = DEPTH_DEFAULT,
                             .specular = SPECULAR_PHONG,
                             .accel = ACCEL_AUTO,
                             .shutter = {0, 1},
                             .cutoff = 0.0001,
                             .lens = {.view_height = 2, .angle = 180, .screen = 1}};
}

void settings_set_draft(struct settings *settings, enum draft_level draft_level) {
    if (draft_level == DRAFT_NONE)
        return;
    settings->full = false;
    settings->samples = 1;
    settings->path_samples = draft_level == DRAFT_PREVIEW ? 1 : 4;
    settings->side_tolerance = settings->corner_tolerance = HUGE_VAL; /* nothing is sampled again */
    settings->coarse = true;
    settings->area_samples = settings->area_samples < COARSE_SIDE ? settings->area_samples : COARSE_SIDE;
    settings->caustics.photons = 0;
    settings->lens.aperture = 0;
    settings->shutter.close = settings->shutter.open;
    if (draft_level == DRAFT_PREVIEW) {
        settings->reflect_limit = settings->refract_limit = 0;
        settings->area_samples = 1;
    }
}
