/* Scripts run one after the other in this process, so that meshes and images (assets) outlive the script that read
 * them. Each gr.render is a job: prepare, begin (names and film), build the world, render, hand over. The world lives
 * in the arena of the job, which is emptied for the next one. */
#include "host/render_process.h"

#include "base/arena.h"
#include "base/file.h"
#include "base/hash.h"
#include "base/mem.h"
#include "base/pool.h"
#include "base/size.h"
#include "base/terminal_text.h"
#include "image/image.h"
#include "inspect/inspect.h"
#include "output/progress.h"
#include "render/aov.h"
#include "render/overlay.h"
#include "render/render.h"
#include "script/script.h"
#include "session/text.h"
#include "viewer/preview_session.h"
#include "world/world.h"

#include <stdio.h>
#include <string.h>
#include <sys/resource.h>

enum { TOLD_LIMIT = 256, LARGE_JOB = 64 << 20 /* bytes */ };

struct child {
    const struct options *options;
    const struct child_services *services;
    const char *script; /* the one that runs */
    struct pool *pool;  /* made for the first picture */
    struct arena job;   /* memory of the picture being made */
    struct assets assets;
    struct scene_writer *errors; /* what scripts write to standard error */
    uint64_t pictures;           /* of this run of the scripts, those that cannot be made too */
    struct mem_account memory;   /* of the pictures of this script: worlds, indexes of meshes, photons, films */
    struct mem_account *account; /* the same while there is a limit, or NULL */
    uint64_t reserved;           /* in it, for the picture that is made */
    struct file_witness witness; /* what the scripts read, when tiles are kept for later */
    struct file_set reported;    /* files that the supervisor knows of; empty under --watch */
    int status;                  /* --check: worst of the problems reported so far in this script */
    bool building;               /* the world */
    uint64_t runs_before;        /* of the pool, before that */
    uint64_t told[TOLD_LIMIT];   /* hashes of the warnings about scenes that this script was given */
    int told_count;
};

static bool is_cancelled(void *context) {
    const struct child *child = context;
    return atomic_load(&child->services->control->cancel) == CANCEL_ALL;
}

/* What the script printed and said is written; the supervisor reports what could not be, once for all scripts. */
static void finish_output(const struct child *child) {
    scene_writer_flush(child->errors);
    if (fflush(stdout) != 0 || ferror(stdout))
        atomic_store(&child->services->control->lost, 1);
}

static void tell(const struct child *child, enum line_kind kind, const char *text) {
    finish_output(child); /* what the script printed before stands before */
    child->services->line(child->services->context, kind, text);
}

/* A line whose beginning the scene may have chosen: by a chunk's name, or that of its file. */
static void tell_of_scene(const struct child *child, enum line_kind kind, const char *text) {
    const char *mark = scene_mark(text);
    char line[FRAME_TEXT_LIMIT];
    if (mark[0] != '\0')
        (void)snprintf(line, sizeof line, "%s%s", mark, text);
    tell(child, kind, mark[0] != '\0' ? line : text);
}

/* How many steps building takes depends on the scene; how far each one is can be told. */
static void tell_building(const struct child *child) {
    struct pool_progress progress = pool_progress(child->pool);
    struct control *control = child->services->control;
    if (!child->building)
        return;
    atomic_store_explicit(&control->build_step, (uint32_t)(progress.runs - child->runs_before) + 1,
                          memory_order_relaxed);
    atomic_store_explicit(&control->build_done,
                          progress.count ? (uint32_t)(1000ull * progress.begun / progress.count) : 0,
                          memory_order_relaxed);
}

static void poll_pool(void *context) {
    const struct child *child = context;
    tell_building(child);
    if (child->services->poll)
        child->services->poll(child->services->context);
}

static bool need_pool(struct child *child, struct error *error) {
    char warning[256], line[512];
    if (child->pool)
        return true;
    child->pool = pool_create(child->options->threads, warning);
    if (!child->pool)
        return error_no_memory(error, "the threads");
    if (warning[0] != '\0') {
        (void)snprintf(line, sizeof line, "gray: warning: %s", warning);
        tell(child, LINE_WARNING, line);
    }
    pool_set_poll(child->pool, poll_pool, child);
    pool_watch(child->pool, &child->services->control->cancel);
    return true;
}

/* A script may render hundreds of frames of one scene; each warning about it comes once. */
static void warn_of_scene(void *context, const char *text) {
    struct child *child = context;
    static const char word[] = "warning: ";
    uint64_t hash = hash_bytes(text, strlen(text), 0);
    for (int i = 0; i < child->told_count; i++) {
        if (child->told[i] == hash)
            return;
    }
    if (child->told_count < TOLD_LIMIT)
        child->told[child->told_count++] = hash;
    bool has_word = strncmp(text, word, strlen(word)) == 0;
    char line[2048];
    (void)snprintf(line, sizeof line, "%s: %s%s", child->script, has_word ? "" : word, text);
    tell_of_scene(child, LINE_WARNING, line);
}

static void tile_done(void *context, uint32_t tile, uint32_t done, uint32_t count) {
    struct control *control = context;
    (void)tile;
    atomic_store_explicit(&control->tiles, count, memory_order_relaxed);
    /* Those of an earlier run count too; of two workers the later one may come first. */
    uint32_t told = atomic_load_explicit(&control->tiles_done, memory_order_relaxed);
    while (told < done && !atomic_compare_exchange_weak_explicit(&control->tiles_done, &told, done,
                                                                 memory_order_relaxed, memory_order_relaxed))
        ;
}

static void fill_report(const struct child *child, const struct world *world, const struct scene *scene,
                        const struct film *film, struct picture_report *report) {
    struct rusage usage;
    struct error ignored;
    size_t film_bytes = 0;
    report->primitives = world->placed_count;
    report->triangles = world->triangles;
    report->mesh_bytes = world->mesh_memory;
    report->placed_bytes = world_placed_memory(world);
    report->search_bytes = scene_accel_memory(&world->accel);
    report->image_bytes = 0;
    for (const struct asset_image *entry = child->assets.images; entry; entry = entry->next)
        report->image_bytes += image_memory(entry->image);
    memcpy(report->grid_cells, world->accel.grid.cells, sizeof report->grid_cells);
    report->node_bytes = scene->arena.total;
    (void)film_size_layered(film->width, film->height, film->record, aov_layers(film->layer_mask), &film_bytes,
                            &ignored);
    report->film_bytes = film_bytes;
    report->threads = pool_workers(child->pool);
    if (getrusage(RUSAGE_SELF, &usage) == 0)
        report->peak_bytes = (uint64_t)usage.ru_maxrss * 1024;
}

static void tell_world(const struct child *child, const char *file, const struct picture_report *report) {
    char line[4096 + 512];
    (void)snprintf(line, sizeof line,
                   "%s: %s: %llu primitives, %llu triangles, grid of %u x %u x %u, built in %.3f s, %d threads",
                   child->script, file, (unsigned long long)report->primitives, (unsigned long long)report->triangles,
                   report->grid_cells[0], report->grid_cells[1], report->grid_cells[2], report->rays.build_seconds,
                   report->threads);
    tell_of_scene(child, LINE_DETAIL, line);
}

/* --pixel and --dump-scene: the scene is built, no picture is made. */
static bool is_asked(const struct options *options) {
    return options->pixel_count > 0 || options->dump_scene;
}

/* Not by way of the supervisor: what the script prints next stands behind it. */
static void print_piece(void *context, const char *text) {
    (void)context;
    text_print(stdout, text);
}

static bool answer_questions(struct child *child, const struct render_request *request, const struct render_job *job,
                             struct error *error) {
    const struct options *options = child->options;
    struct inspected picture = {request->file, job, request->root};
    struct sheet sheet = {.put = print_piece};
    return (!options->dump_scene || inspect_world(&picture, options->json, &sheet, error)) &&
           (options->pixel_count == 0 ||
            inspect_pixels(&picture, options->pixels, options->pixel_count, options->json, child->pool, &sheet, error));
}

static bool build_world(struct child *child, const struct render_request *request, const struct render_job *job,
                        const struct light *lights, uint32_t light_count, struct world *world, struct error *error) {
    struct control *control = child->services->control;
    child->building = true;
    child->runs_before = pool_progress(child->pool).runs;
    atomic_store(&control->build_done, 0);
    atomic_store(&control->build_step, 1);
    const struct world_input input = {.scene = request->scene,
                                      .root = request->root,
                                      .lights = lights,
                                      .light_count = light_count,
                                      .sky = &request->sky,
                                      .shutter = job->settings.shutter,
                                      .accel = job->settings.accel,
                                      .warn = warn_of_scene,
                                      .warn_context = child};
    bool ok = world_build(world, &input, &child->job, child->pool, error);
    child->building = false;
    atomic_store(&control->build_step, 0);
    return ok;
}

/* A picture in a window. */
struct sitting {
    struct child *child;
    const struct render_request *request;
    struct render_job *job;
    struct world *world;
};

static bool sitting_build(void *context, const struct light *lights, uint32_t light_count, struct error *error) {
    struct sitting *sitting = context;
    world_destroy(sitting->world);
    arena_reset(&sitting->child->job);
    return build_world(sitting->child, sitting->request, sitting->job, lights, light_count, sitting->world, error);
}

static void sitting_fill(void *context, const struct film *film, struct picture_report *report) {
    const struct sitting *sitting = context;
    fill_report(sitting->child, sitting->world, sitting->request->scene, film, report);
}

static void sitting_warn(void *context, const char *text) {
    const struct sitting *sitting = context;
    warn_of_scene(sitting->child, text);
}

static bool make_in_window(struct child *child, const struct render_request *request, struct render_job *job,
                           struct world *world, const struct picture_request *asked, struct picture_report *report,
                           double build_seconds, struct error *error) {
    struct sitting sitting = {child, request, job, world};
    bool built = job->world != NULL;
    job->world = world;
    struct studio studio = {.services = child->services,
                            .pool = child->pool,
                            .request = request,
                            .asked = asked,
                            .job = job,
                            .world = world,
                            .context = &sitting,
                            .build = sitting_build,
                            .fill = sitting_fill,
                            .warn = sitting_warn};
    return studio_run(&studio, built, report, build_seconds, error);
}

static bool too_much_memory(const struct child *child, struct error *error) {
    const struct script_options *options = &child->options->script;
    char size[SIZE_WORDS];
    return error_set_limit(error, "the picture needs too much memory: --script-memory allows %s for it and the script",
                           size_words(script_picture_memory(options), size));
}

/* From the flattened scene to the finished film. */
static bool make_picture_unlimited(struct child *child, const struct render_request *request, struct render_job *job,
                                   const struct picture_request *asked, struct picture_report *report,
                                   struct error *error) {
    struct world world = {0};
    double begun = progress_clock(), worked = progress_processor_clock();
    if (build_world(child, request, job, request->lights, request->light_count, &world, error))
        job->world = &world;
    else if (!asked->in_window || !studio_was_stopped(child->services->control, error))
        return false;
    bool ok = true;
    double built = progress_clock(), built_worked = progress_processor_clock();
    if (is_asked(child->options)) {
        ok = answer_questions(child, request, job, error);
    } else if (!child->options->check) {
        if (!asked->in_window)
            atomic_store(&child->services->control->tiles, film_tile_count(job->film));
        ok = asked->in_window
                 ? make_in_window(child, request, job, &world, asked, report, built - begun, error)
                 : render_run(job, child->pool, &report->rays, error) && overlay_draw(job, child->pool, error);
    }
    report->rays.build_seconds = built - begun;
    report->rays.build_processor_seconds = built_worked - worked;
    report->rays.render_seconds = progress_clock() - built;
    report->rays.render_processor_seconds = progress_processor_clock() - built_worked;
    fill_report(child, &world, request->scene, job->film, report);
    world_destroy(&world);
    if (ok)
        tell_world(child, request->file, report);
    return ok;
}

/* The same within what memory is left. */
static bool make_picture(struct child *child, const struct render_request *request, struct render_job *job,
                         const struct picture_request *asked, struct picture_report *report, struct error *error) {
    (void)mem_charge(child->account);
    uint64_t refusals = mem_refusals();
    bool ok = make_picture_unlimited(child, request, job, asked, report, error);
    if (!ok && mem_refusals() != refusals)
        (void)too_much_memory(child, error);
    /* Of a large scene nothing is kept: the next picture may need its memory in other pieces. */
    if (child->job.total > LARGE_JOB)
        arena_destroy(&child->job);
    else
        arena_reset(&child->job);
    (void)mem_charge(NULL);
    return ok;
}

/* What is not allocated block by block: the film with half as much again for its way into a file, unless the command
 * line chooses its size, and the stacks of the workers, which rays of rays may use level by level. */
static bool reserve_memory(struct child *child, const struct picture_request *asked, const struct settings *settings,
                           struct error *error) {
    enum { STACK_OF_A_LEVEL = 8 << 10 };
    size_t film = 0;
    if (asked->check)
        return true;
    if (!film_size_layered(asked->width, asked->height, asked->record, marks_layers(asked), &film, error))
        return false;
    uint64_t levels = (uint64_t)settings->reflect_limit + (uint64_t)settings->refract_limit;
    uint64_t bytes = (uint64_t)pool_workers(child->pool) * levels * STACK_OF_A_LEVEL;
    bytes += child->options->width ? 0 : film + film / 2;
    (void)mem_charge(child->account);
    bool ok = mem_reserve(bytes);
    (void)mem_charge(NULL);
    child->reserved = ok ? bytes : 0;
    return ok || too_much_memory(child, error);
}

static bool begin_picture(struct child *child, const struct render_request *request, struct render_job *job,
                          struct film *film, struct picture_request *out, bool *already, struct error *error) {
    struct picture_request asked = {.full_width = job->width,
                                    .full_height = job->height,
                                    .exposure = job->settings.tone.exposure,
                                    .curve = (uint32_t)job->settings.tone.curve,
                                    .srgb = job->settings.tone.srgb,
                                    .deep = job->settings.deep,
                                    .record = integrator_record(job->settings.integrator),
                                    .layers = job->settings.aov,
                                    .in_window = child->options->window,
                                    .overlay = (uint32_t)job->settings.overlay,
                                    .camera = job->camera,
                                    .lens = job->settings.lens,
                                    .check = child->options->check || is_asked(child->options)};
    char warning[256] = "";
    size_t length = strlen(request->file);
    if (length >= sizeof asked.file)
        return error_set(error, ERROR_SCENE, "the name of the picture is longer than %zu bytes", sizeof asked.file - 1);
    memcpy(asked.file, request->file, length);
    if (!render_prepare(job, &asked.x0, &asked.y0, &asked.width, &asked.height, warning, error))
        return false;
    if (warning[0] != '\0')
        warn_of_scene(child, warning);
    if (job->settings.view_is_target)
        asked.camera.view = vec3_sub(job->camera.view, job->camera.eye);
    asked.files = file_witness_sum(&child->witness);
    if (child->witness.incomplete)
        return error_no_memory(error, "the list of files that were read");
    if (!reserve_memory(child, &asked, &job->settings, error))
        return false;
    if (!child->services->begin(child->services->context, &asked, film, already, error))
        return false;
    film->x0 = asked.x0;
    film->y0 = asked.y0;
    film->full_width = asked.full_width;
    film->full_height = asked.full_height;
    *out = asked;
    return true;
}

/* The script's width or height; a preview has a quarter of it. */
static uint32_t in_preview(const struct options *options, double side) {
    uint32_t whole = (uint32_t)side;
    return options->preview ? (whole + 3) / 4 : whole;
}

static bool render_job_run(struct child *child, const struct render_request *request, struct error *error) {
    const struct options *options = child->options;
    const struct child_services *services = child->services;
    struct film film = {0};
    struct picture_report report = {0};
    struct render_job job = {
        .camera = request->camera,
        .settings = request->settings,
        .width = options->width ? (uint32_t)options->width : in_preview(options, request->width),
        .height = options->height ? (uint32_t)options->height : in_preview(options, request->height),
        .ambient = request->ambient,
        .fog = request->fog,
        .film = &film,
        .shard = options->shard,
        .shards = options->shards,
        .tile_done = tile_done,
        .context = services->control,
        .enough = &services->control->enough,
    };
    settings_hasten(&job.settings, options->preview ? HASTE_PREVIEW : options->quick ? HASTE_QUICK : HASTE_NONE);
    finish_output(child);
    if (is_cancelled(child))
        return error_set(error, ERROR_CANCELLED, "interrupted");
    struct picture_request asked;
    bool already = false;
    if (!need_pool(child, error) || !begin_picture(child, request, &job, &film, &asked, &already, error))
        return false;
    if (already)
        return true;
    if (atomic_load(&services->control->outlook.begun) == OUTLOOK_WANTED)
        job.outlook = &services->control->outlook;
    job.gate = atomic_load(&services->control->gate) != GATE_NONE ? &services->control->gate : NULL;
    bool ok = make_picture(child, request, &job, &asked, &report, error);
    if (ok && !asked.check)
        return services->done(services->context, &report, error);
    services->abandon(services->context);
    return ok;
}

/* Pictures may use what the script leaves. They have an account of their own: what is kept from one to the next, as the
 * index of a mesh, does not count as the script's. `script` is its account, or NULL. */
static void grant_memory(struct child *child, const struct mem_account *script) {
    uint64_t all = script_picture_memory(&child->options->script);
    uint64_t held = script && script->held > 0 ? (uint64_t)script->held : 0;
    child->account = script ? &child->memory : NULL;
    child->memory.limit = all - (held < all ? held : all - 1);
}

static bool render_one(struct child *child, const struct render_request *request, struct error *error) {
    struct mem_account *script = mem_charge(NULL);
    grant_memory(child, script);
    bool ok = options_allow_picture(child->options, ++child->pictures, error) && render_job_run(child, request, error);
    (void)mem_charge(child->account);
    mem_unreserve(child->reserved);
    child->reserved = 0;
    (void)mem_charge(script);
    return ok;
}

/* With --check a scene that cannot be built is reported at once and the script goes on, to find what else is wrong. */
static bool render(void *context, const struct render_request *request, struct error *error) {
    struct child *child = context;
    if (render_one(child, request, error))
        return true;
    if (!child->options->check || error->kind != ERROR_SCENE || error->limit)
        return false;
    char line[2048];
    (void)snprintf(line, sizeof line, "%s%s%s", error->elsewhere ? "" : request->where, error->elsewhere ? "" : ": ",
                   error->text);
    tell_of_scene(child, LINE_ERROR, line);
    child->status = ERROR_SCENE;
    return true;
}

static void scene_text(void *context, const char *text, size_t size) {
    const struct child *child = context;
    scene_writer_take(child->errors, text, size);
}

static void message(void *context, enum script_message kind, const char *text) {
    switch (kind) {
    case SCRIPT_NOTICE:
        tell_of_scene(context, LINE_NOTICE, text);
        return;
    case SCRIPT_WARNING:
        tell_of_scene(context, LINE_WARNING, text);
        return;
    }
}

/* The first line, and below it the traceback. Wrong usage is no fault of the scene: the program speaks. What the
 * machine or a limit refused comes with the name of the script. */
static void tell_error(const struct child *child, struct arena *arena, const struct error *error,
                       const char *traceback) {
    const char *below = traceback ? traceback : "", *who = "";
    bool named = strncmp(error->text, child->script, strlen(child->script)) == 0;
    if (error->kind == ERROR_USAGE)
        who = "gray";
    else if ((error->kind == ERROR_MACHINE || error->limit) && !named)
        who = child->script;
    size_t length = strlen(below);
    while (length > 0 && below[length - 1] == '\n')
        length--;
    const char *text = arena_format(arena, "%s%s%s%s%.*s", who, who[0] ? ": " : "", error->text, length > 0 ? "\n" : "",
                                    (int)length, below);
    if (error->kind == ERROR_USAGE)
        tell(child, LINE_ERROR, text ? text : error->text);
    else
        tell_of_scene(child, LINE_ERROR, text ? text : error->text);
}

/* Meshes and images of earlier scripts, with the indexes that pictures have added, stay for the next one until they
 * exceed what a script and its picture may hold. */
static void begin_memory(struct child *child) {
    (void)mem_charge(child->account);
    arena_destroy(&child->job);
    (void)mem_charge(NULL);
    child->assets.memory += child->memory.held > 0 ? (uint64_t)child->memory.held : 0;
    if (child->assets.memory > script_picture_memory(&child->options->script))
        assets_destroy(&child->assets);
    child->account = NULL;
    child->memory = (struct mem_account){.option = "--script-memory", .words = "--script-memory allows no more"};
}

/* Exit status of one script. */
static int run_script(struct child *child, const char *path) {
    /* Without the sandbox and in a process of its own standard output is a copy of standard error by now. */
    bool sandboxed = !child->options->script.no_sandbox, alone = child->options->no_fork;
    struct script_host host = {.context = child,
                               .settings = child->options->settings,
                               .render = render,
                               .message = message,
                               .cancelled = is_cancelled,
                               .error_text = scene_text,
                               .output_is_error = options_output_is_stream(child->options) && (sandboxed || alone)};
    struct arena arena = {0};
    struct error error = {0};
    const char *traceback = NULL;
    child->script = path;
    child->status = 0;
    child->told_count = 0;
    begin_memory(child);
    bool ok = script_run(path, &child->options->script, &host, &child->assets, &arena, &traceback, &error);
    int status = ok ? child->status : (int)error.kind;
    if (!ok && error.kind != ERROR_CANCELLED)
        tell_error(child, &arena, &error, traceback);
    arena_destroy(&arena);
    finish_output(child);
    return status;
}

static void run_scripts(struct child *child, int first) {
    child->pictures = 0;
    for (int i = first; i < child->options->script_count; i++) {
        int status = run_script(child, child->options->scripts[i]);
        child->services->script_ended(child->services->context, i, status);
        if (status == ERROR_USAGE || status == ERROR_CANCELLED)
            break;
    }
}

/* Reads are reported so that no picture replaces what was read. Under --watch every one is, since a file may change. */
static void report_file(struct child *child, const char *path, const struct file_version *version, bool written) {
    bool watched = child->options->watch;
    if (!watched && file_set_has(&child->reported, version->identity))
        return;
    if (!watched)
        (void)file_set_add(&child->reported, version->identity); /* without memory for it: reported again */
    child->services->read(child->services->context, path, version, written);
}

static void report_read(void *context, const char *path, const struct file_version *version) {
    report_file(context, path, version, false);
}

static void report_write(void *context, const char *path, const struct file_version *version) {
    report_file(context, path, version, true);
}

void child_run(const struct options *options, const struct child_services *services, int first) {
    struct scene_writer errors;
    struct child child = {.options = options, .services = services, .errors = &errors};
    scene_writer_init(&errors, &services->control->error_stream);
    const struct file_listener listener = {
        .heard = report_read, .wrote = report_write, .contents = options->watch, .context = &child};
    bool watched = options->watch && services->again;
    mem_return_large();
    if (options->checkpoint || options->shards || options->mpi)
        file_set_witness(&child.witness);
    if (services->read)
        file_set_listener(&listener);
    run_scripts(&child, first);
    while (watched && services->again(services->context)) {
        if (child.pool)
            pool_reset_cancel(child.pool);
        run_scripts(&child, 0);
    }
    file_set_listener(NULL);
    pool_destroy(child.pool);
    arena_destroy(&child.job);
    assets_destroy(&child.assets);
    file_witness_destroy(&child.witness);
    file_set_destroy(&child.reported);
}
