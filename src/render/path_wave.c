/* The pieces of paths in waves. */
#include "render/path_wave.h"

#define PATH(name) path_wave_##name
#define LAYERS 1
#define OBSERVED 0
#define MATTER 1
#define PIECES_ONLY 1
#include "render/path_pieces_internal.h"

#include "material/density.h"
#include "render/media_light_internal.h"
#include "render/path_wave_internal.h"
#include "render/sample_internal.h"

struct path_wave_state {
    struct path path;
    double seen_through;
    uint32_t number;
    bool below; /* the next piece is come_out, not extend and shade */
    bool ended; /* but for the light that is on its way */
    bool failed;
};
struct path_wave_light {
    struct path_shadow shadow;
};
struct path_wave_answer {
    struct packet_answer met;
    bool failed;
};
struct path_wave_result {
    struct colour light;
    double seen_through, weight; /* weight: of the filter */
    bool failed;
    struct path_parts parts; /* with scene->has_room */
};
_Static_assert(sizeof(struct path_wave_answer) <= PATH_ANSWER_ROOM, "an answer has room");
_Static_assert(sizeof(struct path_wave_light) <= sizeof(struct path_wave_state), "they share memory");
_Static_assert(2 * sizeof(struct path_wave_state) + offsetof(struct path_wave_result, parts) <= 1160,
               "millions of paths fit into memory");

struct path_lane {
    struct world_scratch scratch;
    struct integrator_state state;
    struct medium_stack media; /* around the eye */
    uint64_t camera_rays;
};

size_t path_wave_state_size(void) {
    return sizeof(struct path_wave_state);
}

size_t path_wave_result_size(const struct path_scene *scene) {
    return scene->has_room ? sizeof(struct path_wave_result) : offsetof(struct path_wave_result, parts);
}

uint32_t path_scene_crossings(const struct path_scene *scene) {
    enum { USUAL = 64 };
    return scene->job.world->scratch_need > USUAL ? scene->job.world->scratch_need : USUAL;
}

static size_t lane_head(void) {
    return (sizeof(struct path_lane) + 15) / 16 * 16;
}

size_t path_lane_size(uint32_t crossings) {
    return lane_head() + ((size_t)crossings * sizeof(struct crossing) + 15) / 16 * 16;
}

struct path_lane *path_lane_init(void *memory, const struct path_scene *scene, uint32_t crossings) {
    struct path_lane *lane = memory;
    *lane = (struct path_lane){.state = {.job = &scene->job, .media_dim = scene->media_dim}};
    lane->state.scratch = &lane->scratch;
    lane->scratch.geom = (struct geom_scratch){
        .items = (struct crossing *)(void *)((char *)memory + lane_head()), .capacity = crossings, .fixed = true};
    for (int i = 0; i < WORLD_SHADOW_CACHE; i++)
        lane->scratch.shadow_cache[i] = WORLD_NOTHING;
    return lane;
}

uint64_t path_orders_pixels(const struct path_orders *orders) {
    uint64_t count = 0;
    for (uint32_t i = 0; i < orders->count; i++)
        count += path_order_pixels(&orders->all[i]);
    return count;
}

uint64_t path_orders_paths(const struct path_orders *orders) {
    uint64_t count = 0;
    for (uint32_t i = 0; i < orders->count; i++)
        count += path_order_paths(&orders->all[i]);
    return count;
}

void path_counts_add(struct path_counts *to, const struct path_counts *counts) {
    to->camera_rays += counts->camera_rays;
    to->reflected_rays += counts->reflected_rays;
    to->refracted_rays += counts->refracted_rays;
    to->shadow_rays += counts->shadow_rays;
    to->hits += counts->hits;
    to->medium_events += counts->medium_events;
    to->clamped = to->clamped != 0 || counts->clamped != 0;
}

struct path_counts path_lane_counts(const struct path_lane *lane) {
    const struct integrator_state *state = &lane->state;
    return (struct path_counts){lane->camera_rays, state->reflected_rays, state->refracted_rays, state->shadow_rays,
                                state->hits,       state->medium_events,  state->clamped};
}

/* --- the pieces --- */

/* result: or NULL, where a piece has no parts. */
static void enter(struct path_lane *lane, const struct path_scene *scene, const struct path_wave_state *wave,
                  struct path_wave_result *result) {
    lane->state.parts = scene->has_parts && result ? &result->parts : NULL;
    lane->state.seen_through = wave->seen_through;
    lane->scratch.failed = lane->scratch.geom.overflow = false;
    lane->scratch.geom.used = 0;
}

static void leave(const struct path_lane *lane, struct path_wave_state *wave) {
    wave->seen_through = lane->state.seen_through;
    wave->failed = wave->failed || lane->scratch.failed;
}

bool path_wave_begin(const struct path_scene *scene, struct path_lane *lane, const struct path_wave_start *start,
                     struct path_wave_state *wave, struct path_wave_result *result) {
    const struct renderer *renderer = &scene->renderer;
    const struct path_order *order = start->order;
    const uint32_t each = order->end - order->begin;
    const uint64_t pixel = start->path / each, width = order->x1 - order->x0;
    const struct pixel_sample at =
        path_sample_position(&scene->tracer, &scene->job, order->x0 + (int64_t)(pixel % width),
                             order->y0 + (int64_t)(pixel / width), order->begin + (uint32_t)(start->path % each));
    struct integrator_state *state = &lane->state;
    struct ray ray;
    if (scene->has_parts)
        result->parts = (struct path_parts){0};
    result->light = colour_all(0);
    result->seen_through = 0;
    result->weight = at.weight;
    result->failed = false;
    wave->number = start->number;
    wave->seen_through = 0;
    wave->failed = wave->below = wave->ended = false;
    enter(lane, scene, wave, result);
    state->sampler =
        sampler_make_sobol(scene->job.settings.seed, (uint64_t)at.y * scene->job.width + (uint64_t)at.x, at.number);
    struct camera_frame own;
    const struct camera_frame *camera = renderer_camera_of(renderer, &state->sampler, &own);
    if (!camera || !renderer_camera_ray(renderer, camera, &at, &state->sampler, &ray))
        return false;
    lane->camera_rays++;
    state->eye_medium_stack = renderer_eye_media(renderer, &ray, &lane->scratch, &lane->media);
    begin(&wave->path, state, &ray, state->sampler.key);
    leave(lane, wave);
    return true;
}

uint32_t path_wave_number(const struct path_wave_state *wave) {
    return wave->number;
}

void path_wave_move(struct path_wave_state *to, const struct path_wave_state *from) {
    *to = *from;
    to->path.ray.media = &to->path.media;
}

void path_wave_extend(const struct path_scene *scene, struct path_lane *lane, struct path_wave_state *wave,
                      struct device_questions *questions) {
    const struct device_query query = {scene->job.world, &wave->path.ray, &lane->scratch};
    questions->count = 0;
    enter(lane, scene, wave, NULL);
    if (!wave->below) {
        lane->scratch.rays++;
        device_search_nearest(&query, &wave->path.met, questions);
    }
    leave(lane, wave);
}

bool path_scene_leaves_solids(const struct path_scene *scene) {
    return scene->job.world->device->has_slow;
}

uint32_t path_wave_question_class(const struct path_scene *scene, uint32_t primitive) {
    return scene->job.world->primitives[primitive].prototype % PATH_CLASSES;
}

void path_wave_ask(const struct path_scene *scene, struct path_lane *lane, const struct path_wave_state *wave,
                   uint32_t primitive, struct path_wave_answer *answer) {
    const struct device_query query = {scene->job.world, &wave->path.ray, &lane->scratch};
    enter(lane, scene, wave, NULL);
    device_search_ask(&query, primitive, &wave->path.met, &answer->met);
    answer->failed = lane->scratch.failed;
}

void path_wave_keep(struct path_wave_state *wave, const struct path_wave_answer *answer) {
    device_search_keep(&wave->path.met, &answer->met);
    wave->failed = wave->failed || answer->failed;
}

uint32_t path_wave_class(const struct path_scene *scene, const struct path_wave_state *wave) {
    enum { MATERIALS = PATH_CLASSES - 2 };
    const uint32_t primitive = wave->path.met.primitive;
    if (wave->below)
        return MATERIALS;
    return primitive == WORLD_NOTHING ? MATERIALS + 1
                                      : primitive_prototype(scene->job.world, primitive)->material % MATERIALS;
}

void path_wave_shade(const struct path_scene *scene, struct path_lane *lane, struct path_wave_state *wave,
                     struct path_wave_light *light, struct path_wave_result *result) {
    enter(lane, scene, wave, result);
    bool goes_on = (wave->below ? come_out : shade)(&scene->tracer, &lane->state, &wave->path, &light->shadow, NULL);
    wave->below = !goes_on && wave->path.kind == RAY_BELOW;
    wave->ended = !goes_on && !wave->below;
    leave(lane, wave);
}

bool path_wave_shadow(const struct path_scene *scene, struct path_lane *lane, struct path_wave_state *wave,
                      struct path_wave_light *light, struct path_wave_result *result) {
    enter(lane, scene, wave, result);
    shadow(&scene->tracer, &lane->state, &wave->path, &light->shadow);
    leave(lane, wave);
    if (!wave->ended && !wave->failed)
        return true;
    result->failed = wave->failed;
    if (!wave->failed)
        result->light = finish(&scene->tracer, &lane->state, &wave->path);
    result->seen_through = lane->state.seen_through;
    return false;
}

bool path_wave_add(const struct path_scene *scene, const struct path_wave_result *result, struct path_pixel *pixel) {
    if (!result->failed)
        path_add(pixel, scene->has_parts ? &result->parts : NULL, result->light, result->seen_through, result->weight);
    return !result->failed;
}

/* --- the scene --- */

bool path_scene_met_fault(const struct path_scene *scene) {
    const struct world *world = scene->job.world;
    const uint32_t count = world->media.outside + 1 + world->local_media_count;
    struct box cell;
    double bound;
    bool met = texture_tables_met_nan(&world->surfaces.textures);
    for (uint32_t i = 0; i < count && !met; i++)
        for (const struct medium *medium = &world->media.all[i]; medium && !met; medium = medium->inner)
            met = medium->density && density_excess(medium->density, &cell, &bound);
    return met;
}

size_t path_scene_size(void) {
    return sizeof(struct path_scene);
}

size_t path_scene_pixel_size(const struct path_scene *scene) {
    return path_pixel_size(scene->has_parts);
}

const char *path_scene_lacks(const struct path_tracer *tracer, const struct renderer *renderer) {
    const struct lens *lens = &renderer->camera.lens;
    if (renderer->job->world->primitive_count > DEVICE_SEARCH_PRIMITIVES)
        return "more than 268,435,456 primitives";
    if (tracer->photon_lights)
        return "photons (--caustics)";
    if (lens->stereo == STEREO_ANAGLYPH || lens->depth)
        return "colours of both eyes, and depths of a light field";
    return NULL;
}

/* The tables of a world that is there. */
static void bundle_media(struct bundle *bundle, void *tables) {
    struct media *media = tables;
    BUNDLE(bundle, media->solids, 1, NULL);
    BUNDLE(bundle, media->all, 1, medium_bundle);
}

static void bundle_scene(struct bundle *bundle, void *path_scene) {
    struct path_scene *scene = path_scene;
    struct path_tracer *tracer = &scene->tracer;
    const struct world *world = scene->job.world;
    BUNDLE(bundle, scene->renderer.closed, scene->renderer.closed_count, NULL);
    BUNDLE(bundle, tracer->aimed_lights, tracer->aimed_light_count, NULL);
    BUNDLE(bundle, tracer->sealed, world->first_solid ? world->first_solid[world->primitive_count] : 0, NULL);
    BUNDLE(bundle, scene->job.world, 1, world_bundle);
    world_lights_bundle(bundle, &tracer->lights);
    glow_bundle(bundle, &tracer->glow);
    BUNDLE(bundle, scene->renderer.eye_medium_stack.media, 1, bundle_media);
    BUNDLE(bundle, scene->renderer.job, 1, NULL); /* the root */
}

struct path_order path_scene_trial(const struct path_scene *scene, uint32_t side, uint32_t samples) {
    const uint32_t width = scene->job.width, height = scene->job.height;
    const uint32_t x = width > side ? (width - side) / 2 : 0, y = height > side ? (height - side) / 2 : 0;
    return (struct path_order){x, y,      x + (width < side ? width : side), y + (height < side ? height : side),
                               0, samples};
}

bool path_scene_has_room(const struct renderer *renderer) {
    return path_has_parts(&renderer->job->settings) ||
           (path_film_parts(renderer->job->film->record) & PATH_PART_FEATURES) != 0;
}

struct bundle *path_scene_bundle(const struct path_tracer *tracer, const struct renderer *renderer,
                                 const struct device_search *search) {
    const struct world world = device_search_world(search, renderer->job->world);
    struct path_scene scene = {.tracer = *tracer, .has_parts = path_has_parts(&renderer->job->settings)};
    scene.has_room = path_scene_has_room(renderer);
    scene.tracer.lights.world = &world;
    scene.job = (struct render_job){.world = &world,
                                    .camera = renderer->job->camera,
                                    .settings = renderer->job->settings,
                                    .width = renderer->job->width,
                                    .height = renderer->job->height};
    scene.job.settings.tone.table = NULL;
    scene.renderer = (struct renderer){.job = &scene.job,
                                       .camera = renderer->camera,
                                       .eye_medium_stack = renderer->eye_medium_stack,
                                       .timed = renderer->timed,
                                       .medium_stack_by_ray = renderer->medium_stack_by_ray,
                                       .sampler = renderer->sampler,
                                       .sample_share = renderer->sample_share,
                                       .closed = renderer->closed,
                                       .closed_count = renderer->closed_count};
    scene.media_dim = media_dim_lights(renderer->job->world);
    scene.tracer.tiles = NULL;
    scene.tracer.contours = NULL;
    scene.tracer.arena = (struct arena){0};
    return bundle_create(&scene, sizeof scene, bundle_scene);
}
