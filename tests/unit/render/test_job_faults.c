/* Failures while a picture is made: with scenes of every kind of object and every accelerator, whichever allocation
 * fails while the world is built and the picture is rendered, the job ends with one machine error or with the picture,
 * and the next job succeeds. */
#include "base/fault.h"
#include "film/aov.h"
#include "inspect/inspect.h"
#include "inspect/pick.h"
#include "render/overlay.h"
#include "render/render.h"
#include "tests/unit/script_host.h"
#include "world/world.h"

#include "image/png_write.h"
#include "tests/stage.h"

enum { SIDE = 6 };

static const char objects[] =
    "local red = gr.material({0.8, 0.3, 0.2}, {0.5, 0.5, 0.5}, 20)\n"
    "local glass = gr.difresnel_material(gr.rr_material({0, 0, 0}, {1, 1, 1}, 100, 0.1, 0.9, 1.5))\n"
    "local image = gr.image_material{material = red, image = 'pic.png', channel = 'opacity'}\n"
    "local marble = gr.marble_pnd_material(red, 1, 2, 3, 1, {1, 1, 1})\n"
    "local root, ball = gr.node('root'), gr.sphere(glass)\n"
    "root:add_child(ball)\n"
    "root:add_child(gr.instances{of = gr.sphere(red), at = {{1, 2, 3}, {3, 2, 1}, {0, 3, 0}}, turn = {10, 20, 5}})\n"
    "local verts = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}\n"
    "local faces = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}\n"
    "local mesh = gr.mesh{material = marble, verts = verts, faces = faces}\n"
    "local parts = gr.mesh{materials = {red, glass}, face_materials = {1, 2, 1, 2}, verts = verts, faces = faces}\n"
    "parts:translate(-2, 0, 0) mesh:translate(2, 0, 0) root:add_child(mesh) root:add_child(parts)\n"
    "local cut = gr.difference('cut', gr.union('two', gr.sphere(red), gr.cube(red)), gr.cylinder{material = glass, "
    "radius = 0.4},\n"
    "  gr.mesh{material = red, verts = verts, faces = faces}, gr.torus{material = marble})\n"
    "cut:translate(0, -2, 0) root:add_child(cut)\n"
    "local moving = gr.cube(image) moving:velocity{1, 0, 0} root:add_child(moving)\n"
    "local turning = gr.node('turning') turning:add_child(gr.sphere(red)) turning:rotate('y', 20)\n"
    "root:add_child(turning)\n"
    "root:add_child(gr.height_field(red, {{0, 1, 0}, {1, 0, 1}}))\n"
    "root:add_child(gr.blob(red, {{0, 0, 0, 1}}, {{0, 0, 0, 1, 0, 0, 0.5, 2}}, 0.4))\n"
    "root:add_child(gr.curve(red, {{0, 0, 0}, {1, 1, 0}, {2, 0, 1}}, 0.1, 'b-spline'))\n"
    "root:add_child(gr.sweep(red, {{0, 0, 0}, {1, 1, 0}, {2, 0, 1}}, {0.1, 0.2, 0.1}))\n"
    "root:add_child(gr.lathe(red, {{0, 0}, {1, 0}, {1, 1}, {0, 2}}, 'catmull-rom'))\n"
    "root:add_child(gr.prism{material = red, outline = {{0, 0}, {3, 0}, {0, 3}}, to = 2})\n"
    "root:add_child(gr.superellipsoid{material = red, e = 0.5, n = 0.5})\n"
    "root:add_child(gr.plane{material = image, normal = {0, 1, 0}, distance = -4})\n"
    "local bounded = gr.bounded_by{object = gr.sphere(red), by = gr.cube(red)} root:add_child(bounded)\n"
    "root:add_child(gr.clipped_by{object = gr.mesh{material = red, verts = verts, faces = faces}, by = "
    "gr.sphere(red)})\n"
    /* solids of disjoint parts, one with holes, one with a bound; an empty node */
    "root:add_child(gr.union{name = 'apart', gr.sphere{material = image, centre = {-9, 0, 0}}, gr.sphere{material = "
    "red, centre = {9, 0, 0}},\n"
    "  gr.bounded_by{object = gr.sphere{material = red, centre = {0, 9, 0}}, by = gr.cube{corner = {-2, 7, -2}, size = "
    "4}}})\n"
    "root:add_child(gr.mesh{verts = verts, faces = {}})\n";
static const char view[] = "file = 'a.png', width = 6, height = 6, eye = {0, 1, 9}, view = {0, 0, -1}, fov = 60, ";

/* Keeps the result of the run without failures, to compare the runs after a failure with it. */
static int failed_runs, pictures;

static void no_warning(void *context, const char *text) {
    (void)context, (void)text;
}

static struct render_job job_of(const struct render_request *request, const struct world *world, struct film *film) {
    return (struct render_job){.world = world,
                               .camera = request->camera,
                               .settings = request->settings,
                               .width = SIDE,
                               .height = SIDE,
                               .ambient = request->ambient,
                               .film = film};
}

static bool make(const struct render_request *request, enum accel_kind accel, struct pool *pool,
                 struct film_pixel *pixels, struct error *error) {
    struct world world = {0};
    struct arena arena = {0};
    struct film film = {0};
    struct render_statistics statistics = {0};
    struct render_job job = job_of(request, &world, &film);
    char warning[256];
    struct render_area area;
    *error = (struct error){0};
    job.settings.accel = accel;
    size_t bytes;
    bool ok = render_prepare(&job, &area, warning, error) &&
              film_size(SIDE, SIDE, stage_record(INTEGRATOR_WHITTED), &bytes, error);
    if (ok) {
        void *block = calloc(1, bytes);
        film_layout(&film, block, SIDE, SIDE, stage_record(INTEGRATOR_WHITTED));
        film.full_width = film.full_height = SIDE;
        const struct world_input input = {.scene = request->scene,
                                          .root = request->root,
                                          .lights = request->lights,
                                          .light_count = request->light_count,
                                          .sky = &request->sky,
                                          .outside = &request->outside,
                                          .shutter = request->settings.shutter,
                                          .accel = accel,
                                          .warn = no_warning};
        ok = world_build(&world, &input, &arena, pool, error) && render_run(&job, pool, &statistics, error);
        if (ok && pixels)
            memcpy(pixels, film.pixels, 2 * sizeof *pixels * SIDE * SIDE);
        free(block);
    }
    world_destroy(&world);
    arena_destroy(&arena);
    return ok;
}

static void fail_each(struct listener *listener, const struct render_request *request) {
    static const enum accel_kind kinds[] = {ACCEL_AUTO, ACCEL_GRID, ACCEL_KDTREE, ACCEL_NONE};
    char warning[256];
    struct error error;
    struct pool *pool = pool_create(2, warning);
    (void)listener;
    pictures++;
    for (size_t a = 0; a < sizeof kinds / sizeof kinds[0]; a++) {
        /* The colours, followed by the first pass. */
        static struct film_pixel wanted[2 * SIDE * SIDE], after[2 * SIDE * SIDE];
        if (!make(request, kinds[a], pool, wanted, &error)) {
            test_fail(__FILE__, __LINE__, "picture %d: %s", pictures, error.text);
            break;
        }
        for (uint64_t k = 1;; k++) {
            uint64_t before = fault_count(FAULT_OF_ALLOCATION);
            fault_at(FAULT_OF_ALLOCATION, k);
            bool ok = make(request, kinds[a], pool, NULL, &error);
            fault_at(FAULT_OF_ALLOCATION, 0);
            failed_runs += !ok;
            if (!ok && error.kind != ERROR_MACHINE)
                test_fail(__FILE__, __LINE__, "picture %d, allocation %llu: kind %d: %s", pictures,
                          (unsigned long long)k, (int)error.kind, error.text);
            if (fault_count(FAULT_OF_ALLOCATION) - before < k)
                break;
            pool_reset_cancel(pool);
        }
        CHECK(make(request, kinds[a], pool, after, &error));
        CHECK(memcmp(wanted, after, sizeof wanted) == 0);
    }
    pool_destroy(pool);
}

/* Queries about a picture. */
enum question {
    ASK_PIXELS,
    ASK_PIXELS_JSON,
    ASK_DUMP,
    ASK_DUMP_JSON,
    ASK_BOXES,
    ASK_CELLS,
    ASK_LAYERS,
    ASK_PICK,
    ASK_SHARD,
    QUESTIONS
};

/* The result as one hash: of all characters of a text or all bytes of a picture. */
static void add_bytes(uint64_t *sum, const void *bytes, size_t size) {
    for (size_t i = 0; i < size; i++)
        *sum = (*sum ^ ((const uint8_t *)bytes)[i]) * UINT64_C(0x100000001b3);
}

static void add_text(void *context, const char *text) {
    add_bytes(context, text, strlen(text));
}

static bool answer(enum question question, const struct render_request *request, struct render_job *job,
                   struct pool *pool, uint64_t *sum, struct error *error) {
    static struct text_writer writer;
    struct inspected picture = {.file = "a.png", .job = job, .root = request->root, .pool = pool};
    const uint32_t pixels[][2] = {{3, 3}, {1, 4}, {5, 0}};
    struct render_statistics statistics = {0};
    struct picked picked;
    bool ok = false;
    writer = (struct text_writer){.put = add_text, .context = sum};
    switch (question) {
    case ASK_PIXELS:
    case ASK_PIXELS_JSON:
        picture.json = question == ASK_PIXELS_JSON;
        return inspect_pixels(&picture, pixels, 3, &writer, error);
    case ASK_DUMP:
    case ASK_DUMP_JSON:
        picture.json = question == ASK_DUMP_JSON;
        return inspect_world(&picture, &writer, error);
    case ASK_BOXES:
    case ASK_CELLS:
        job->settings.overlay = question == ASK_BOXES ? OVERLAY_OF_BOXES : OVERLAY_OF_GRID;
        ok = overlay_draw(job, pool, error);
        add_bytes(sum, job->film->pixels, film_record_size(job->film->record) * SIDE * SIDE);
        return ok;
    case ASK_LAYERS:
        ok = render_run(job, pool, &statistics, error);
        add_bytes(sum, job->film->layers, sizeof(float[3]) * SIDE * SIDE);
        return ok;
    case ASK_PICK:
        for (int pixel = 0; pixel < SIDE * SIDE; pixel++) {
            if (!pick_at(job, request->root, (struct pick_query){pixel % SIDE + 0.5, pixel / SIDE + 0.5, pixel % 3 - 1},
                         &picked, error))
                return false;
            add_text(sum, picked.node_path);
        }
        return true;
    case ASK_SHARD:
        job->shard = 1;
        job->shards = 2;
        ok = render_run(job, pool, &statistics, error);
        add_bytes(sum, job->film->pixels, film_record_size(job->film->record) * SIDE * SIDE);
        return ok;
    case QUESTIONS:
        break;
    }
    return ok;
}

/* One query of a built world with allocation k failing (0: none); *over: there were fewer than k allocations. */
static bool ask(enum question question, const struct render_request *request, const struct world *world,
                struct pool *pool, uint64_t k, bool *over, uint64_t *sum, struct error *error) {
    struct film film = {.full_width = SIDE, .full_height = SIDE};
    struct render_job job = job_of(request, world, &film);
    size_t bytes;
    *error = (struct error){0};
    *sum = 0;
    job.settings.aov = question == ASK_LAYERS ? AOV_ALL : 0;
    CHECK(film_size_layered(SIDE, SIDE, stage_record(INTEGRATOR_WHITTED), aov_layers(job.settings.aov), &bytes, error));
    void *block = calloc(1, bytes);
    film_layout(&film, block, SIDE, SIDE, stage_record(INTEGRATOR_WHITTED));
    film_layout_layers(&film, block, job.settings.aov);
    film.full_width = film.full_height = SIDE;
    uint64_t before = fault_count(FAULT_OF_ALLOCATION);
    fault_at(FAULT_OF_ALLOCATION, k);
    bool ok = answer(question, request, &job, pool, sum, error);
    fault_at(FAULT_OF_ALLOCATION, 0);
    *over = fault_count(FAULT_OF_ALLOCATION) - before < k;
    free(block);
    return ok;
}

static void ask_all(enum question question, const struct render_request *request, const struct world *world,
                    struct pool *pool) {
    uint64_t wanted, sum;
    struct error error;
    bool over = false;
    if (!ask(question, request, world, pool, 0, &over, &wanted, &error))
        test_fail(__FILE__, __LINE__, "question %d: %s", (int)question, error.text);
    over = false;
    for (uint64_t k = 1; !over; k++) {
        bool ok = ask(question, request, world, pool, k, &over, &sum, &error);
        failed_runs += !ok;
        if (ok ? sum != wanted : error.kind != ERROR_MACHINE)
            test_fail(__FILE__, __LINE__, "question %d, allocation %llu: kind %d: %s", (int)question,
                      (unsigned long long)k, (int)error.kind, ok ? "another answer" : error.text);
        pool_reset_cancel(pool);
    }
}

static void ask_each(struct listener *listener, const struct render_request *request) {
    static const enum accel_kind kinds[] = {ACCEL_AUTO, ACCEL_GRID, ACCEL_KDTREE, ACCEL_BVH, ACCEL_NONE};
    char warning[256];
    struct error error = {0};
    struct pool *pool = pool_create(1, warning);
    (void)listener;
    pictures++;
    for (size_t a = 0; a < sizeof kinds / sizeof kinds[0]; a++) {
        struct world world = {0};
        struct arena arena = {0};
        const struct world_input input = {.scene = request->scene,
                                          .root = request->root,
                                          .lights = request->lights,
                                          .light_count = request->light_count,
                                          .sky = &request->sky,
                                          .outside = &request->outside,
                                          .shutter = request->settings.shutter,
                                          .accel = kinds[a],
                                          .warn = no_warning};
        CHECK(world_build(&world, &input, &arena, pool, &error));
        for (int question = 0; question < QUESTIONS; question++)
            if (kinds[a] == ACCEL_AUTO || question == ASK_CELLS)
                ask_all((enum question)question, request, &world, pool);
        world_destroy(&world);
        arena_destroy(&arena);
    }
    pool_destroy(pool);
}

static void white_row(void *context, uint32_t y, uint8_t *line) {
    (void)context;
    memset(line, 100 + 20 * (int)y, 3 * 8);
}

static void run_seen(const char *renders,
                     void (*seen)(struct listener *listener, const struct render_request *request)) {
    struct listener listener = {.seen = seen};
    struct error error = {0};
    char path[512], text[8192];
#ifndef GRAY_FAULTS
    test_skip("failures on demand are only in builds with GRAY_FAULTS");
#endif
    (void)snprintf(path, sizeof path, "%s/pic.png", test_folder());
    CHECK(
        png_write_from(FILE_AT(path), &(struct png_source){.width = 8, .height = 6, .bytes = white_row}, NULL, &error));
    (void)snprintf(text, sizeof text, "%s%s", objects, renders);
    failed_runs = pictures = 0;
    if (!listen_to_text(&listener, text, NULL, &error))
        test_fail(__FILE__, __LINE__, "%s", error.text);
    CHECK(pictures > 0);
    CHECK(failed_runs > 50);
}

static void run(const char *renders) {
    run_seen(renders, fail_each);
}

TEST(any_allocation_of_an_answer_about_a_picture_may_fail) {
    char text[4096];
    (void)snprintf(text, sizeof text,
                   "local sky = gr.sky_map('pic.png')\n"
                   "local lamp = gr.mesh_light{mesh = gr.mesh{verts = verts, faces = faces}, emission = {1, 1, 1}}\n"
                   "gr.render{node = root, %s lights = {gr.light({4, 5, 6}, {0.9, 0.9, 0.9}, {1, 0, 0}), lamp, "
                   "gr.sky_light{sky = sky}}, caustics = {photons = 60, radius = 0.5}, background = sky}\n",
                   view);
    run_seen(text, ask_each);
}

TEST(any_allocation_of_a_job_may_fail_and_the_next_job_is_whole) {
    char text[4096];
    (void)snprintf(text, sizeof text,
                   "gr.render{node = root, %s lights = {gr.light({4, 5, 6}, {0.9, 0.9, 0.9}, {1, 0, 0}),\n"
                   "gr.area_light({4, 5, 6}, {1, 0, 0}, {0, 1, 0}, {0.3, 0.3, 0.3}, {1, 0, 0})},\n"
                   "background = gr.sky_map{image = 'pic.png'}, shutter = {0, 1}, samples = 2}\n",
                   view);
    run(text);
}

TEST(any_allocation_of_caustics_fog_and_lights_may_fail) {
    char text[4096];
    (void)snprintf(text, sizeof text,
                   "local sky = gr.sky_map('pic.png')\n"
                   "local lamp = gr.mesh_light{mesh = gr.mesh{verts = verts, faces = faces}, emission = {1, 1, 1}}\n"
                   "gr.render{node = root, %s lights = {gr.light({4, 5, 6}, {0.9, 0.9, 0.9}, {1, 0, 0}), lamp},\n"
                   "caustics = {photons = 200, radius = 0.5}, fog = gr.uniform_fog{density = 0.1}}\n"
                   "gr.render{node = root, %s lights = {gr.sky_light{sky = sky}}, background = sky}\n",
                   view, view);
    run(text);
}
