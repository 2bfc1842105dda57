#include "render/path_view.h"

#include "base/hash.h"
#include "film/path_film.h"
#include "render/path_view_internal.h"
#include "render/path_wave_internal.h"

#include <math.h>
#include <string.h>

enum { SIDE_LIMIT = 1 << 30 }; /* pixels */

/* Paths on a device do not read the settings that are cleared here, or the camera has them. */
static uint64_t hash_of_rest(const struct settings *settings) {
    struct settings rest;
    memcpy(&rest, settings, sizeof rest);
    memset(&rest.tone, 0, sizeof rest.tone);
    memset(&rest.lens, 0, sizeof rest.lens);
    memset(&rest.motion, 0, sizeof rest.motion);
    rest.denoise = DENOISER_NONE;
    rest.path_samples = 0;
    rest.noise = rest.time_limit = 0;
    rest.passes = rest.cropped = rest.keep_first = rest.view_is_target = false;
    return hash_bytes(&rest, sizeof rest, 0);
}

bool path_view_make(const struct renderer *renderer, struct path_view *view) {
    const struct render_job *job = renderer->job;
    const struct medium_stack *eye = &renderer->eye_medium_stack;
    const uint32_t closed = renderer->medium_stack_by_ray ? renderer->closed_count : 0;
    memset(view, 0, sizeof *view);
    if (closed > PATH_VIEW_CLOSED || (renderer->timed && job->settings.motion.moves))
        return false;
    view->camera = renderer->camera;
    view->rest = hash_of_rest(&job->settings);
    view->width = job->width;
    view->height = job->height;
    view->solid_count = eye->count;
    memcpy(view->solids, eye->solids, eye->count * sizeof *eye->solids);
    view->closed_count = closed;
    if (closed > 0)
        memcpy(view->closed, renderer->closed, closed * sizeof *renderer->closed);
    view->timed = renderer->timed;
    view->medium_stack_by_ray = renderer->medium_stack_by_ray;
    view->has_parts = path_has_parts(&job->settings);
    view->has_room = path_scene_has_room(renderer);
    return true;
}

bool path_view_follows(const struct path_view *first, const struct path_view *view) {
    return first->rest == view->rest && view->has_parts <= first->has_room;
}

/* --- in the device process, from one that may be hostile --- */

/* The values of a type with few of them, as they are in memory: any others must not be read as that type. */
static bool is_below(const void *value, size_t size, uint32_t limit) {
    uint32_t number = 0;
    memcpy(&number, value, size);
    return number < limit;
}

static bool is_finite(const double *numbers, size_t count) {
    bool is = true;
    for (size_t i = 0; i < count; i++)
        is = is && isfinite(numbers[i]);
    return is;
}

static bool are_below(const uint32_t *numbers, uint32_t count, uint32_t room, uint32_t limit) {
    bool are = count <= room;
    for (uint32_t i = 0; are && i < count; i++)
        are = numbers[i] < limit;
    return are;
}

static bool camera_fits(const struct camera_frame *camera) {
    static const char *const projections[] = {PROJECTIONS(LIST_WORD)}, *const stereos[] = {STEREOS(LIST_WORD)};
    const struct lens *lens = &camera->lens;
    const double numbers[] = {camera->width,     camera->height,     camera->spread, camera->focus,
                              camera->radian,    lens->view_height,  lens->angle,    lens->shift_x,
                              lens->shift_y,     lens->aperture,     lens->focus,    lens->fov,
                              lens->blade_angle, lens->eye_distance, lens->screen,   lens->spacing};
    const struct vec3 vectors[] = {camera->eye,        camera->forward,   camera->right,    camera->down,
                                   camera->unit_right, camera->unit_down, lens->focus_point};
    bool fits = is_finite(numbers, sizeof numbers / sizeof *numbers) && camera->width >= 1 && camera->height >= 1;
    for (size_t i = 0; i < sizeof vectors / sizeof *vectors; i++)
        fits = fits && is_finite((const double[]){vectors[i].x, vectors[i].y, vectors[i].z}, 3);
    return fits &&
           is_below(&lens->projection, sizeof lens->projection, (uint32_t)(sizeof projections / sizeof *projections)) &&
           is_below(&lens->stereo, sizeof lens->stereo, (uint32_t)(sizeof stereos / sizeof *stereos)) &&
           is_below(&lens->depth, sizeof lens->depth, 2) && lens->blades >= 0 && lens->rows >= 0 &&
           lens->rows <= LIGHT_FIELD_SIDE && lens->columns >= 0 && lens->columns <= LIGHT_FIELD_SIDE &&
           (lens->rows > 0) == (lens->columns > 0);
}

bool path_view_fits(const struct path_scene *scene, const struct path_view *view) {
    const struct world *world = scene->job.world;
    const uint32_t solids = world->first_solid ? world->first_solid[world->primitive_count] : 0;
    return view->width >= 1 && view->width <= SIDE_LIMIT && view->height >= 1 && view->height <= SIDE_LIMIT &&
           are_below(view->solids, view->solid_count, MEDIUM_STACK_LIMIT, solids) &&
           are_below(view->closed, view->closed_count, PATH_VIEW_CLOSED, world->primitive_count) && view->timed < 2 &&
           view->medium_stack_by_ray < 2 && view->has_parts < 2 && view->has_parts <= scene->has_room &&
           camera_fits(&view->camera);
}

void path_view_set(struct path_scene *scene, const struct path_view *view, uint64_t address) {
    struct renderer *renderer = &scene->renderer;
    scene->job.width = view->width;
    scene->job.height = view->height;
    scene->has_parts = view->has_parts;
    renderer->camera = view->camera;
    renderer->timed = view->timed;
    renderer->medium_stack_by_ray = view->medium_stack_by_ray;
    renderer->eye_medium_stack.count = view->solid_count;
    memcpy(renderer->eye_medium_stack.solids, view->solids, sizeof view->solids);
    memcpy(scene->closed, view->closed, sizeof view->closed);
    renderer->closed = (uint32_t *)(uintptr_t)(address + offsetof(struct path_scene, closed));
    renderer->closed_count = view->closed_count;
}
