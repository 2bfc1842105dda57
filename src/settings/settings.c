/* The settings of a picture: defaults, drafts, and what they mean together. */
#include "settings/setting.h"

#include "base/unreachable.h"

#include <math.h>

struct integrator_traits integrator_traits(enum integrator_kind integrator) {
    switch (integrator) {
    case INTEGRATOR_WHITTED:
        return (struct integrator_traits){.is_classic = true, .has_styles = true};
    case INTEGRATOR_PATH:
        return (struct integrator_traits){
            .progressive = true, .has_light_parts = true, .is_linear = true, .sky_lights = true, .follows_paths = true};
    case INTEGRATOR_RADIOSITY:
        return (struct integrator_traits){.is_linear = true, .sky_lights = true};
    }
    UNREACHABLE("an integrator of no kind");
}

struct settings settings_default(void) {
    struct settings settings = {.shutter = {0, 1}, .lens = {.view_height = 2, .angle = 180}};
    for (int i = 0; i < setting_count; i++)
        setting_store(&setting_table[i], &settings, setting_table[i].initial);
    return settings;
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

void settings_move_camera(struct settings *settings, const struct camera *to) {
    const struct vec3 towards = vec3_sub(settings->lens.focus_point, to->eye);
    const double distance = vec3_length(towards);
    /* The plane of a point beside the camera would be at the lens. */
    const bool in_front = vec3_dot(towards, to->view) > 0.001 * distance * vec3_length(to->view);
    settings->view_is_target = false;
    settings->motion = (struct camera_motion){0};
    if (settings->lens.focus == 0 && !in_front)
        settings->lens.focus = distance > 0 ? distance : 1;
}
