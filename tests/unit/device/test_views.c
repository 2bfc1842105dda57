/* Views of a scene that a device has: they give the bytes of threads, and no other numbers are taken. */
#include "device/emulation.h"
#include "film/film.h"
#include "render/path_view.h"
#include "tests/harness.h"
#include "tests/stage.h"

#include "base/mem.h"
#include "base/random.h"

#include <math.h>
#include <string.h>

/* An emulation as the device of a window; the last view that it took. */
struct viewed {
    struct emulation *emulation;
    uint32_t begins, orders;
    bool has_begun;
    struct path_view first, view;
};
static enum path_device_answer take_view(void *context, const struct path_view *view) {
    struct viewed *viewed = context;
    viewed->view = *view;
    if (!viewed->has_begun || !path_view_follows(&viewed->first, view)) {
        viewed->first = *view;
        return PATH_DEVICE_BEGINS;
    }
    CHECK(emulation_set_view(viewed->emulation, view));
    return PATH_DEVICE_TAKES;
}
static bool begin(void *context, struct bundle *scene, bool *is_used, struct error *error) {
    struct viewed *viewed = context;
    const struct path_device inner = emulation_device(viewed->emulation);
    viewed->begins++;
    viewed->has_begun = true;
    return inner.begin(inner.context, scene, is_used, error);
}
static bool make(void *context, const struct path_orders *orders, struct path_counts *counts) {
    struct viewed *viewed = context;
    const struct path_device inner = emulation_device(viewed->emulation);
    __atomic_fetch_add(&viewed->orders, 1, __ATOMIC_RELAXED);
    uint64_t number = 0;
    bool goes_on = inner.make(inner.context, orders, counts);
    for (uint32_t k = 0; k < orders->count; k++)
        for (uint64_t i = 0; i < path_order_pixels(&orders->all[k]); i++, number++)
            CHECK(path_orders_pixel(orders, number)->samples == orders->all[k].end);
    return goes_on;
}

/* The picture of the stage by threads and by the device. */
static void compare(struct stage *s, struct viewed *viewed, uint32_t width, uint32_t height) {
    const struct path_device device = {.take_view = take_view, .begin = begin, .make = make, .context = viewed};
    CHECK(stage_render(s, width, height));
    struct render_job job = stage_job(s, width, height);
    const size_t size = (size_t)width * height * job.film->record.floats * sizeof(float);
    float *floats = mem_alloc(size);
    memcpy(floats, job.film->floats, size);
    memset(job.film->floats, 0, size);
    job.device = &device;
    viewed->orders = 0;
    for (uint32_t i = 0; i < film_tile_count(job.film); i++)
        atomic_store(&job.film->tiles[i], FILM_TILE_WANTED);
    CHECK(render_run(&job, s->pool, &s->statistics, &s->error));
    CHECK(viewed->orders > 0 && memcmp(floats, job.film->floats, size) == 0);
    mem_free(floats);
}

/* A ball of glass around the origin in fog of its own colour, before a floor. */
static void begin_scene(struct stage *s, struct viewed *viewed) {
    stage_begin(s, 2);
    s->settings.integrator = INTEGRATOR_PATH;
    s->settings.path_samples = 2;
    s->settings.denoise = DENOISER_NONE;
    s->camera = (struct camera){{0, 1, 6}, {0, -0.1, -1}, {0, 1, 0}, 50};
    s->sky.colour = colour_make(0.2, 0.3, 0.4);
    stage_point_light(s, vec3_make(3, 5, 4), colour_make(0.9, 0.8, 0.7));
    struct node *floor = stage_cube(s, s->root, stage_phong(s, colour_make(0.7, 0.5, 0.3), colour_all(0.2), 30));
    stage_scale(s, floor, 20, 1, 20);
    stage_move(s, floor, -10, -2, -10);
    (void)stage_sphere(s, s->root, stage_glass(s, 1, 1, 1.5));
    *viewed = (struct viewed){.emulation = emulation_create(s->pool, 0, 0)};
}

static void end_scene(struct stage *s, struct viewed *viewed) {
    emulation_destroy(viewed->emulation);
    stage_end(s);
}

TEST(views_of_a_scene_that_a_device_has_give_the_bytes_of_threads) {
    struct stage s;
    struct viewed viewed;
    begin_scene(&s, &viewed);
    compare(&s, &viewed, 40, 30);
    s.camera.eye = vec3_make(0.2, 0.1, 0.3); /* inside the glass */
    compare(&s, &viewed, 40, 30);
    CHECK_EQ_INT(viewed.view.solid_count, 1);
    compare(&s, &viewed, 71, 67);
    s.settings.lens.aperture = 1; /* some rays start inside */
    s.settings.lens.focus = 4;
    compare(&s, &viewed, 20, 30);
    CHECK(viewed.view.medium_stack_by_ray && viewed.view.closed_count > 0);
    s.settings.lens = (struct lens){.projection = PROJECTION_ORTHOGRAPHIC, .view_height = 4};
    compare(&s, &viewed, 20, 30);
    s.settings.lens = (struct lens){.stereo = STEREO_SIDE, .eye_distance = 0.2, .screen = 4};
    s.settings.tone.exposure = 2;
    s.settings.path_samples = 5;
    s.camera.eye = vec3_make(0, 1, 6);
    compare(&s, &viewed, 40, 30);
    CHECK_EQ_INT(viewed.begins, 1);
    /* There is no room for the parts of paths, then there is, whether they are wanted or not. */
    s.settings.lens = (struct lens){.projection = PROJECTION_PERSPECTIVE};
    s.settings.denoise = DENOISER_GRAY;
    compare(&s, &viewed, 40, 30);
    CHECK_EQ_INT(viewed.begins, 2);
    s.settings.denoise = DENOISER_NONE;
    compare(&s, &viewed, 40, 30);
    CHECK_EQ_INT(viewed.begins, 2);
    /* Another setting of paths is not a matter of the view. */
    s.settings.max_depth = 3;
    compare(&s, &viewed, 40, 30);
    CHECK_EQ_INT(viewed.begins, 3);
    end_scene(&s, &viewed);
}

TEST(views_with_numbers_that_are_not_possible_are_refused) {
    struct stage s;
    struct viewed viewed;
    begin_scene(&s, &viewed);
    s.settings.lens.aperture = 0.5;
    compare(&s, &viewed, 40, 30);
    const struct path_scene *scene = emulation_scene(viewed.emulation);
    const struct path_view good = viewed.view;
    const uint8_t two = 2;
    CHECK(path_view_fits(scene, &good));
#define REFUSES(assignment)                                                                                            \
    do {                                                                                                               \
        struct path_view view = good;                                                                                  \
        assignment;                                                                                                    \
        CHECK(!path_view_fits(scene, &view));                                                                          \
        CHECK(!emulation_set_view(viewed.emulation, &view));                                                           \
    } while (0)
    REFUSES(view.width = 0);
    REFUSES(view.height = 0);
    REFUSES(view.width = UINT32_MAX);
    REFUSES(view.solid_count = MEDIUM_STACK_LIMIT + 1);
    REFUSES((view.solid_count = 1, view.solids[0] = 2));
    REFUSES(view.closed_count = PATH_VIEW_CLOSED + 1);
    REFUSES((view.closed_count = 1, view.closed[0] = 2));
    REFUSES(view.timed = 2);
    REFUSES(view.medium_stack_by_ray = 0xff);
    REFUSES(view.has_parts = 2);
    REFUSES(view.has_parts = 1); /* without room */
    REFUSES(view.camera.eye.y = NAN);
    REFUSES(view.camera.down.z = HUGE_VAL);
    REFUSES(view.camera.spread = NAN);
    REFUSES(view.camera.width = 0);
    REFUSES(view.camera.lens.aperture = -HUGE_VAL);
    REFUSES(view.camera.lens.rows = -1);
    REFUSES(view.camera.lens.columns = 3); /* of no rows */
    REFUSES(view.camera.lens.columns = LIGHT_FIELD_SIDE + 1);
    REFUSES(view.camera.lens.blades = -3);
    REFUSES(memset(&view.camera.lens.projection, 0x7f, sizeof view.camera.lens.projection));
    REFUSES(memset(&view.camera.lens.stereo, 0xff, sizeof view.camera.lens.stereo));
    REFUSES(memcpy(&view.camera.lens.depth, &two, 1));
    end_scene(&s, &viewed);
}

/* Of a render process that an attacker controls: what fits is made. */
TEST(a_device_survives_every_view_that_it_takes) {
    enum { TRIES = 3000 };
    struct stage s;
    struct viewed viewed;
    struct path_pixel pixels[64];
    begin_scene(&s, &viewed);
    s.settings.lens.aperture = 0.5;
    compare(&s, &viewed, 40, 30);
    const struct path_view good = viewed.view;
    const struct path_device inner = emulation_device(viewed.emulation);
    uint64_t random = 5, taken = 0;
    for (int i = 0; i < TRIES; i++) {
        unsigned char bytes[sizeof good];
        struct path_view view;
        memcpy(bytes, &good, sizeof bytes);
        for (int k = 0; k < 1 + i % 3; k++) {
            random = random_combine(random, 1);
            /* Half of them before the list of solids, which is long. */
            const size_t room = random & 1 ? sizeof bytes : offsetof(struct path_view, closed);
            bytes[(size_t)(random >> 40) % room] = (unsigned char)(random >> 8);
        }
        memcpy(&view, bytes, sizeof view);
        if (!emulation_set_view(viewed.emulation, &view))
            continue;
        struct path_counts counts = {0};
        taken++;
        memset(pixels, 0, sizeof pixels);
        const struct path_order order = {3, 5, 11, 13, 0, 1};
        CHECK(inner.make(inner.context, &(struct path_orders){&order, 1, pixels, sizeof *pixels}, &counts));
    }
    CHECK(taken > TRIES / 10 && taken < TRIES);
    end_scene(&s, &viewed);
}
