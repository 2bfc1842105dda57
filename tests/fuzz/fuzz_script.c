/* Any bytes as a scene: through the grammar of gr calls (script_grammar.h) they become a script, which runs in this
 * process with small limits; its pictures are flattened and rendered with 8 x 8 pixels. The result is a film, or one
 * line. GRAY_FUZZ_PRINT in the environment shows the text. Bytes that begin with "--" are a script as they are, and with
 * "{" a scene in JSON. */
#define _GNU_SOURCE
#include "base/mem.h"
#include "film/aov.h"
#include "image/png_write.h"
#include "render/integrator.h"
#include "render/render.h"
#include "script/script.h"
#include "tests/fuzz/folder.h"
#include "tests/fuzz/script_grammar.h"
#include "world/world.h"

#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/time.h>
#include <unistd.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { SIDE = 8, PICTURES = 3 };

/* Set by the clock: nothing that a scene starts may continue for long after it. */
static _Atomic int wish_to_stop;

static void pattern_row(void *context, uint32_t y, uint8_t *line) {
    (void)context;
    for (uint32_t i = 0; i < 3 * SIDE; i++)
        line[i] = (uint8_t)(i * 37 + y * 91);
}

/* Of the working copy, if the program was started there. */
static void copy_font(int start) {
    static uint8_t bytes[1 << 18];
    int file = openat(start, "data/fonts/gray-round.ttf", O_RDONLY | O_CLOEXEC);
    ssize_t size = file < 0 ? -1 : read(file, bytes, sizeof bytes);
    if (file >= 0)
        (void)close(file);
    if (size > 0)
        fuzz_write("letters.ttf", bytes, (size_t)size);
}

static void fill_folder(void) {
    static const char flag_obj[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nusemtl red\nf 1 2 3\nf 2 4 3\n";
    static const char flag_ply[] = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                                   "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
                                   "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    static const char flag_stl[] = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 "
                                   "0\nendloop\nendfacet\nendsolid a\n";
    static const char flag_gltf[] =
        "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":36,\"uri\":\"data:application/octet-stream;"
        "base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA\"}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":36}]"
        ","
        "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"}],\"meshes\":[{"
        "\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],\"nodes\":[{\"mesh\":0}],\"scenes\":[{\"nodes\":[0]}]}";
    static const char head[] = "PF\n2 2\n-1\n";
    float light[12] = {1, 2, 3, 0, 0, 0, 1e30f, 1, 1, 0.5f, 0.25f, 0.125f};
    uint8_t pfm[sizeof head - 1 + sizeof light];
    struct error error;
    int start = open(".", O_PATH | O_CLOEXEC);
    memcpy(pfm, head, sizeof head - 1);
    memcpy(pfm + sizeof head - 1, light, sizeof light);
    fuzz_write("light.pfm", pfm, sizeof pfm);
    fuzz_write("flag.obj", flag_obj, sizeof flag_obj - 1);
    fuzz_write("flag.ply", flag_ply, sizeof flag_ply - 1);
    fuzz_write("flag.stl", flag_stl, sizeof flag_stl - 1);
    fuzz_write("flag.gltf", flag_gltf, sizeof flag_gltf - 1);
    copy_font(start);
    (void)close(start);
    if (!png_write_from(FILE_AT("cross.png"),
                        &(struct png_source){.width = SIDE, .height = SIDE * 3 / 4, .bytes = pattern_row}, NULL,
                        &error) ||
        !png_write_from(FILE_AT("square.png"),
                        &(struct png_source){.width = SIDE, .height = SIDE, .bytes = pattern_row}, NULL, &error))
        abort();
}

static void ring(int number) {
    (void)number;
    wish_to_stop = 1;
}

static void set_clock(int milliseconds) {
    struct itimerval timer = {.it_value = {milliseconds / 1000, milliseconds % 1000 * 1000}};
    (void)setitimer(ITIMER_VIRTUAL, &timer, NULL);
}

struct stage {
    struct assets assets;
    struct pool *pool;
    int pictures;
};

static void hear(void *context, enum script_message kind, const char *text) {
    (void)context;
    (void)kind;
    if (text[0] == '\0')
        abort();
}

static void hear_of_scene(void *context, const char *text) {
    hear(context, SCRIPT_WARNING, text);
}

static bool is_stopped(void *context) {
    (void)context;
    return wish_to_stop != 0;
}

static int smaller(int a, int b) {
    return a < b ? a : b;
}

/* The same kinds of work as for a large picture, but little of each. */
static struct settings small_settings(const struct settings *asked) {
    struct settings settings = *asked;
    settings.samples = smaller(settings.samples, 2);
    settings.area_samples = smaller(settings.area_samples, 2);
    settings.reflect_limit = smaller(settings.reflect_limit, 3);
    settings.refract_limit = smaller(settings.refract_limit, 3);
    settings.caustics.photons = smaller(settings.caustics.photons, 100);
    return settings;
}

static bool make_film(struct film *film, const struct settings *settings, uint32_t width, uint32_t height,
                      struct error *error) {
    size_t bytes;
    if (!film_size_layered(width, height, render_record(settings), aov_layers(settings->aov), &bytes, error))
        return false;
    void *block = mem_alloc_zero(1, bytes);
    if (!block)
        return error_no_memory(error, "the film");
    film_layout(film, block, width, height, render_record(settings));
    film_layout_layers(film, block, settings->aov);
    return true;
}

static bool render_small(void *context, const struct render_request *request, struct error *error) {
    struct stage *stage = context;
    struct world world = {0};
    struct arena arena = {0};
    struct film film = {0};
    struct render_statistics statistics = {0};
    struct render_job job = {.world = &world,
                             .camera = request->camera,
                             .settings = small_settings(&request->settings),
                             .width = request->width < SIDE ? (uint32_t)request->width : SIDE,
                             .height = request->height < SIDE ? (uint32_t)request->height : SIDE,
                             .ambient = request->ambient,
                             .film = &film};
    char warning[256] = "";
    struct render_area area;
    if (stage->pictures++ >= PICTURES || !render_prepare(&job, &area, warning, error))
        return stage->pictures > PICTURES;
    bool ok = make_film(&film, &job.settings, area.width, area.height, error);
    if (ok) {
        film.x0 = area.x0;
        film.y0 = area.y0;
        film.full_width = job.width;
        film.full_height = job.height;
        const struct world_input input = {.scene = request->scene,
                                          .root = request->root,
                                          .lights = request->lights,
                                          .light_count = request->light_count,
                                          .sky = &request->sky,
                                          .outside = &request->outside,
                                          .shutter = job.settings.shutter,
                                          .accel = job.settings.accel,
                                          .warn = hear_of_scene};
        ok = world_build(&world, &input, &arena, stage->pool, error) &&
             render_run(&job, stage->pool, &statistics, error);
        if (!ok && error->kind == ERROR_NONE)
            abort();
    }
    mem_free(film.pixels);
    world_destroy(&world);
    arena_destroy(&arena);
    pool_reset_cancel(stage->pool);
    return ok;
}

static void run(struct stage *stage, const char *name) {
    char path[128];
    const struct script_options options = {
        .transform_order = SCRIPT_ORDER_NEW, .memory_limit = 64 << 20, .time_limit = 1, .output_limit = 1 << 20};
    const struct script_host host = {.context = stage,
                                     .assets = &stage->assets,
                                     .settings = settings_default(),
                                     .render = render_small,
                                     .message = hear,
                                     .cancelled = is_stopped};
    struct arena arena = {0};
    const char *traceback = NULL;
    struct error error = {0};
    (void)snprintf(path, sizeof path, "%s/%s", fuzz_folder(), name);
    wish_to_stop = 0;
    set_clock(150);
    bool ok = script_run(path, &options, &host, &arena, &traceback, &error);
    set_clock(0);
    if (!ok && (error.kind == ERROR_NONE || error.text[0] == '\0' || strchr(error.text, '\n')))
        abort();
    arena_destroy(&arena);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static char text[SCRIPT_GRAMMAR_SIZE];
    static bool has_files;
    struct stage stage = {0};
    char warning[256];
    if (!has_files) {
        has_files = true;
        fill_folder();
        (void)signal(SIGVTALRM, ring);
    }
    script_grammar(data, size, text);
    const char *script = text;
    size_t length = strlen(text);
    bool is_json = size > 2 && data[0] == '{';
    if (is_json || (size > 2 && data[0] == '-' && data[1] == '-')) {
        script = (const char *)data;
        length = size;
    }
    if (getenv("GRAY_FUZZ_PRINT"))
        (void)fprintf(stderr, "%.*s\n", (int)length, script);
    const char *name = is_json ? "scene.json" : "scene.lua";
    fuzz_write(name, script, length);
    stage.pool = pool_create(1, warning);
    if (!stage.pool)
        return 0;
    pool_watch(stage.pool, &wish_to_stop);
    run(&stage, name);
    pool_destroy(stage.pool);
    assets_destroy(&stage.assets);
    return 0;
}
