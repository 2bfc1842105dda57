/* The pieces of paths, called for many paths at a time, as a card does. */
#define PATH(name) wave_##name
#define LAYERS 1
#define OBSERVED 0
#define MATTER 1
#include "render/path_pieces_internal.h"

#include "material/openpbr.h"
#include "render/filter_internal.h"
#include "tests/harness.h"
#include "tests/stage.h"

#include <stdlib.h>

enum { WIDTH = 24, HEIGHT = 18, SAMPLES = 4, PATHS = WIDTH * HEIGHT * SAMPLES };

/* What a card keeps of each path. */
struct wave {
    struct path path;
    struct path_shadow shadow;
    struct path_parts parts;
    double seen_through;
    bool below; /* the next piece is come_out, not extend and shade */
    bool ended; /* but for the shadow ray */
};

struct waves {
    struct path_tracer paths;
    struct renderer renderer;
    struct render_job job;
    struct world_scratch scratch;
    struct integrator_state state;
    struct wave *all;
    uint32_t below; /* pieces below surfaces */
};

static void begin_waves(struct waves *w, struct stage *s) {
    char warning[256];
    *w = (struct waves){.job = stage_job(s, WIDTH, HEIGHT)};
    w->renderer = (struct renderer){.job = &w->job, .pool = s->pool};
    CHECK(camera_prepare(&w->job.camera, &w->job.settings, (struct picture_size){WIDTH, HEIGHT}, &w->renderer.camera,
                         warning, &s->error));
    CHECK(world_scratch_init(&w->scratch, &s->world));
    const struct inside_query eye = {w->renderer.camera.eye, 0, NULL, 0};
    world_medium_stack(&s->world, &eye, &w->scratch, &w->renderer.eye_medium_stack);
    CHECK(path_tracer_create(&w->paths, &w->renderer, &s->statistics, &s->error));
    w->state = (struct integrator_state){
        .job = &w->job, .scratch = &w->scratch, .eye_medium_stack = &w->renderer.eye_medium_stack, .media_dim = true};
    w->all = calloc(PATHS, sizeof *w->all);
}

static void end_waves(struct waves *w) {
    path_tracer_destroy(&w->paths);
    world_scratch_destroy(&w->scratch);
    free(w->all);
}

/* The sampler and the camera ray of path i. */
static struct ray begin_path(struct waves *w, uint32_t i) {
    const uint32_t pixel = i / SAMPLES;
    w->state.sampler = sampler_make_sobol(w->job.settings.seed, pixel, i % SAMPLES);
    struct filter_sample at = filter_sample(&w->paths.filter, sampler_point(&w->state.sampler, SAMPLER_PIXEL));
    return camera_ray(&w->renderer.camera, pixel % WIDTH + at.x, (double)(pixel / WIDTH) + at.y);
}

/* One piece for each living path of the list, in an order that changes; keeps those that go on. */
typedef bool piece(struct waves *w, struct wave *wave);
static uint32_t each(struct waves *w, uint32_t *living, uint32_t count, uint32_t turn, piece *call) {
    uint32_t kept = 0, *next = calloc(count + 1, sizeof *next);
    for (uint32_t k = 0; k < count; k++) {
        const uint32_t i = living[turn % 2 ? count - 1 - k : (k * 7919 + turn) % count];
        w->state.parts = &w->all[i].parts;
        w->state.seen_through = w->all[i].seen_through;
        if (call(w, &w->all[i]))
            next[kept++] = i;
        w->all[i].seen_through = w->state.seen_through;
    }
    memcpy(living, next, kept * sizeof *next);
    free(next);
    return kept;
}

static bool call_extend(struct waves *w, struct wave *wave) {
    if (!wave->below)
        extend(&w->state, &wave->path);
    return true;
}
static bool call_shade(struct waves *w, struct wave *wave) {
    w->below += wave->below;
    bool goes_on = (wave->below ? come_out : shade)(&w->paths, &w->state, &wave->path, &wave->shadow, NULL);
    wave->below = !goes_on && wave->path.kind == RAY_BELOW;
    wave->ended = !goes_on && !wave->below;
    return true;
}
static bool call_shadow(struct waves *w, struct wave *wave) {
    shadow(&w->paths, &w->state, &wave->path, &wave->shadow);
    return !wave->ended;
}

static void check_waves(struct stage *s, bool has_skin) {
    struct waves w;
    uint32_t living[PATHS], count = PATHS, different = 0;
    double sum = 0;
    CHECK(stage_build(s, s->root, s->settings.accel));
    begin_waves(&w, s);
    for (uint32_t i = 0; i < PATHS; i++) {
        struct ray ray = begin_path(&w, i);
        begin(&w.all[i].path, &w.state, &ray, w.state.sampler.key);
        living[i] = i;
    }
    for (uint32_t turn = 0; count > 0; turn += 3) {
        count = each(&w, living, count, turn, call_extend);
        count = each(&w, living, count, turn + 1, call_shade);
        count = each(&w, living, count, turn + 2, call_shadow);
    }
    for (uint32_t i = 0; i < PATHS; i++) {
        struct path_parts parts = {0};
        struct ray ray = begin_path(&w, i);
        w.state.parts = &w.all[i].parts;
        struct colour apart = finish(&w.paths, &w.state, &w.all[i].path);
        w.state.parts = &parts;
        w.state.seen_through = 0;
        struct colour whole = path_trace_layers(&w.paths, &w.state, &ray, NULL, true, w.state.sampler.key);
        different += memcmp(&apart, &whole, sizeof apart) != 0 || memcmp(&parts, &w.all[i].parts, sizeof parts) != 0 ||
                     w.state.seen_through != w.all[i].seen_through;
        sum += whole.r + whole.g + whole.b;
    }
    CHECK_EQ_INT(different, 0);
    CHECK(sum > 0 && (w.below > 0) == has_skin);
    end_waves(&w);
}

/* Mirrors, glass, two kinds of lamps and a sky. */
static void begin_scene(struct stage *s) {
    stage_begin(s, 2);
    s->settings.integrator = INTEGRATOR_PATH;
    s->settings.path_samples = SAMPLES;
    s->settings.max_depth = 8;
    s->camera = (struct camera){{0, 1, 6}, {0, -0.1, -1}, {0, 1, 0}, 50};
    s->sky.colour = colour_make(0.2, 0.3, 0.4);
    stage_point_light(s, vec3_make(3, 5, 4), colour_make(0.9, 0.8, 0.7));
    struct material *glowing = stage_phong(s, colour_all(0), colour_all(0), 1);
    glowing->phong.emission = colour_all(6);
    struct node *lamp = stage_sphere(s, s->root, glowing);
    stage_scale(s, lamp, 0.3, 0.3, 0.3);
    stage_move(s, lamp, -2, 3, 1);
    struct node *floor = stage_cube(s, s->root, stage_phong(s, colour_make(0.7, 0.5, 0.3), colour_all(0.2), 30));
    stage_scale(s, floor, 20, 1, 20);
    stage_move(s, floor, -10, -2, -10);
    stage_move(s, stage_sphere(s, s->root, stage_glass(s, 1, 1, 1.5)), 1.2, 0, 0);
    stage_move(s, stage_sphere(s, s->root, stage_glass(s, 1, 0, 1)), -1.2, 0, 0);
}

TEST(pieces_of_many_paths_in_any_order_give_the_light_of_one_path_after_the_other) {
    struct stage s;
    begin_scene(&s);
    check_waves(&s, false);
    stage_end(&s);
}

TEST(pieces_of_paths_in_media_in_any_order_give_the_light_of_one_path_after_the_other) {
    struct stage s;
    begin_scene(&s);
    const struct medium milk = medium_filling(&(struct medium_input){.absorption = colour_make(0.1, 0.1, 0.2),
                                                                     .scattering = colour_make(0.5, 0.4, 0.3),
                                                                     .phase = {PHASE_HENYEY_GREENSTEIN, 0.4}});
    struct node *ball = stage_sphere(&s, s.root, stage_filling(&s, &milk));
    stage_move(&s, ball, 0, 1, 1.5);
    check_waves(&s, false);
    stage_end(&s);
}

TEST(pieces_of_paths_below_surfaces_in_any_order_give_the_light_of_one_path_after_the_other) {
    struct stage s;
    begin_scene(&s);
    struct openpbr *layers = arena_alloc(&s.scene.arena, sizeof *layers);
    struct material *skin = stage_phong(&s, colour_all(0), colour_all(0), 1);
    *layers = openpbr_defaults();
    layers->subsurface_weight = 0.8;
    layers->subsurface_radius = 0.2;
    skin->kind = MATERIAL_OPENPBR;
    skin->openpbr = layers;
    stage_move(&s, stage_sphere(&s, s.root, skin), 0, 1, 1.5);
    check_waves(&s, true);
    stage_end(&s);
}
