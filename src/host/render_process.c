/* Scripts run one after the other in this process, so that meshes and images (assets) outlive the script that read
 * them. Each gr.render is a job: prepare, begin (names and film), build the world, render, deliver. The world lives
 * in the arena of the job, which is emptied for the next one. */
#include "host/light_meter_internal.h"
#include "host/render_process_internal.h"

#include "base/clock.h"
#include "base/error.h"
#include "call/context.h"
#include "denoise/denoise.h"
#include "film/path_film.h"
#include "formats/model.h"
#include "host/model_export.h"
#include "host/picture_device.h"
#include "host/picture_in_window_internal.h"
#include "host/render_reports.h"
#include "host/scene_text.h"
#include "inspect/inspect.h"
#include "output/progress.h"
#include "preview/preview_session.h"
#include "render/integrator.h"
#include "render/overlay.h"
#include "render/scene_check.h"
#include "session/text.h"
#include "world/world_cache.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LARGE_JOB = 64 << 20 /* bytes */ };

static bool is_cancelled(void *context) {
    const struct render_process *process = context;
    return atomic_load(&process->services->control->cancel) == CANCEL_ALL;
}

/* The supervisor writes the files of a frame while the script of the next one runs. Whatever could show the difference
 * waits: reading files, printing, the next picture, the end of the script. */
static void wait_for_files(void *context) {
    const struct render_process *process = context;
    if (process->services->wait)
        process->services->wait(process->services->context);
}

/* False: the last frame could not be written. The error has the name of its file, and no line of the script, which has
 * gone on. */
static bool settle(const struct render_process *process, struct error *error) {
    if (!process->services->settle || process->services->settle(process->services->context, error))
        return true;
    error->elsewhere = true;
    return false;
}

/* The number of building steps depends on the scene; only the progress of each one is known. */
static void report_building(const struct render_process *process) {
    struct pool_progress progress = pool_progress(process->pool);
    struct control *control = process->services->control;
    if (!process->building)
        return;
    atomic_store_explicit(&control->build_step, (uint32_t)(progress.runs - process->runs_before) + 1,
                          memory_order_relaxed);
    atomic_store_explicit(&control->build_done,
                          progress.count ? (uint32_t)(1000ull * progress.begun / progress.count) : 0,
                          memory_order_relaxed);
}

static void poll_pool(void *context) {
    const struct render_process *process = context;
    report_building(process);
    if (process->services->poll)
        process->services->poll(process->services->context);
}

bool render_process_need_pool(struct render_process *process, struct error *error) {
    char warning[256], line[512];
    if (process->pool)
        return true;
    process->pool = pool_create(process->options->threads, warning);
    if (!process->pool)
        return error_no_memory(error, "the threads");
    if (warning[0] != '\0') {
        (void)snprintf(line, sizeof line, "gray: warning: %s", warning);
        render_process_report(process, LINE_WARNING, line);
    }
    pool_set_poll(process->pool, poll_pool, process);
    pool_watch(process->pool, &process->services->control->cancel);
    return true;
}

static void tile_done(void *context, uint32_t tile, uint32_t done, uint32_t count) {
    struct control *control = context;
    (void)tile;
    atomic_store_explicit(&control->tiles, count, memory_order_relaxed);
    /* Those of an earlier run are included; of two workers the later one may report first. */
    uint32_t warned = atomic_load_explicit(&control->tiles_done, memory_order_relaxed);
    while (warned < done && !atomic_compare_exchange_weak_explicit(&control->tiles_done, &warned, done,
                                                                   memory_order_relaxed, memory_order_relaxed))
        ;
}

/* --pixel, --dump-scene and --dump-expr: the scene is built, no picture is made. */
static bool is_asked(const struct options *options) {
    return options->pixel_count > 0 || options->dump_scene || options->dump_expr;
}

/* Not through the supervisor, so that later output of the script follows it. */
void render_process_print(void *context, const char *text) {
    (void)context;
    text_print(stdout, text);
}

static bool answer_questions(const struct picture_work *work, struct error *error) {
    const struct options *options = work->process->options;
    struct inspected picture = {.file = work->name,
                                .job = &work->job,
                                .root = work->request->root,
                                .pool = work->process->pool,
                                .json = options->json};
    struct text_writer writer = {.put = render_process_print};
    if (options->dump_expr)
        inspect_functions(&picture, &writer);
    return (!options->dump_scene || inspect_world(&picture, &writer, error)) &&
           (options->pixel_count == 0 ||
            inspect_pixels(&picture, options->pixels, options->pixel_count, &writer, error));
}

/* Whether the next picture may be like this one. */
static bool is_frame(const struct picture_work *work) {
    return work->request->frame.number > 0 || work->process->options->animation != ANIMATION_NONE;
}

/* The scene notes what the script changes from frame to frame; changes of the window and of gr.change_... are
 * others. */
static bool notes_changes(const struct picture_work *work) {
    const struct render_process *process = work->process;
    return process->animates && work->request->frame.number > 0 && !work->picture_request.in_window &&
           !work->request->changed && !process->options->script.lenient;
}

struct world_input render_process_world_input(const struct picture_work *work) {
    return (struct world_input){.scene = work->request->scene,
                                .root = work->request->root,
                                .lights = work->request->lights,
                                .light_count = work->request->light_count,
                                .sky = &work->request->sky,
                                .outside = &work->request->outside,
                                .shutter = work->job.settings.shutter,
                                .accel = work->job.settings.accel,
                                .linear_colours = settings_linear(&work->job.settings),
                                .encodes = work->job.settings.tone.srgb,
                                .classic = integrator_traits(work->job.settings.integrator).is_classic,
                                .warn = render_process_warn,
                                .warn_context = work->process};
}

bool render_process_build_world(struct picture_work *work, const struct changed_scene *changed, struct error *error) {
    struct render_process *process = work->process;
    struct control *control = process->services->control;
    if (!notes_changes(work))
        world_cache_drop_tables(&process->world_cache);
    process->building = true;
    process->runs_before = pool_progress(process->pool).runs;
    atomic_store(&control->build_done, 0);
    atomic_store(&control->build_step, 1);
    struct world_input input = render_process_world_input(work);
    if (changed) {
        input.lights = changed->lights;
        input.light_count = changed->light_count;
        input.sky = changed->sky ? changed->sky : input.sky;
    }
    input.cache = is_frame(work) ? &process->world_cache : NULL;
    input.keeps_tables = notes_changes(work);
    bool ok = work->built = world_build(&work->world, &input, &process->job, process->pool, error);
    process->building = false;
    atomic_store(&control->build_step, 0);
    return ok;
}

static bool too_much_memory(const struct render_process *process, struct error *error) {
    const struct script_options *options = &process->options->script;
    char size[SIZE_WORDS];
    return error_set_limit(error, "the picture needs too much memory: --script-memory allows %s for picture and script",
                           size_words(script_picture_memory(options), size));
}

/* Of something that scene_check has seen. */
static void notice_of_picture(void *context, const char *text) {
    const struct picture_work *work = context;
    render_process_say(work->process, LINE_NOTICE, "%.1400s: %s", work->request->where, text);
}

static bool render_picture(struct picture_work *work, struct error *error) {
    struct render_process *process = work->process;
    struct picture_device device = {
        .services = process->services, .pool = process->pool, .kind = (enum device)process->options->device};
    struct path_device maker;
    bool ok = true;
    if (process->options->device != DEVICE_CPU && !process->lacks_device) {
        ok = picture_device_init(&device, &work->job, &maker, error);
        work->job.device = &maker;
    }
    ok = ok && render_run(&work->job, process->pool, &work->report.rays, error);
    work->job.device = NULL;
    process->lacks_device = process->lacks_device || device.is_absent;
    picture_device_end(&device);
    return ok && overlay_draw(&work->job, process->pool, error);
}

/* From the flattened scene to the finished film. */
static bool make_picture_unlimited(struct picture_work *work, struct error *error) {
    struct render_process *process = work->process;
    struct render_job *job = &work->job;
    struct picture_report *report = &work->report;
    bool in_window = work->picture_request.in_window;
    double begun = clock_now(), worked = clock_seconds(CLOCK_PROCESS_CPUTIME_ID);
    if (render_process_build_world(work, NULL, error))
        job->world = &work->world;
    else if (!in_window || !preview_was_stopped(process->services->control, error))
        return false;
    bool ok = true;
    double built = clock_now(), built_worked = clock_seconds(CLOCK_PROCESS_CPUTIME_ID);
    if (job->world) {
        integrator_warn(job, render_process_warn, process);
        if (work->request->frame.number <= 1) /* things come into view and light comes on in later ones */
            scene_check(job, &process->faults, notice_of_picture, work);
    }
    if (is_asked(process->options)) {
        ok = answer_questions(work, error);
    } else if (!process->options->check) {
        process->building = true;
        process->runs_before = pool_progress(process->pool).runs;
        ok = !job->world || in_window || integrator_prepare(job, process->pool, error);
        process->building = false;
        atomic_store(&process->services->control->build_step, 0);
    }
    if (ok && !is_asked(process->options) && !process->options->check) {
        if (!in_window)
            atomic_store(&process->services->control->tiles, film_tile_count(job->film));
        ok = in_window ? picture_in_window(work, built - begun, error) : render_picture(work, error);
    }
    report->rays.build_seconds = built - begun;
    report->rays.build_processor_seconds = built_worked - worked;
    report->rays.render_seconds = clock_now() - built;
    report->rays.render_processor_seconds = clock_seconds(CLOCK_PROCESS_CPUTIME_ID) - built_worked;
    render_process_fill_report(work, job->film, report);
    if (ok && job->world) {
        render_process_warn_of_nan(process, job->world);
        render_process_warn_of_density(process, job->world);
    }
    work->ok = ok;
    if (ok && !is_asked(process->options) && !process->options->check)
        render_process_report_samples(work);
    if (ok)
        render_process_report_world(process, work->name, report);
    return ok;
}

/* After a large scene the memory is released: the next picture may need blocks of other sizes. */
static void clear_picture(struct picture_work *work) {
    struct render_process *process = work->process;
    (void)mem_charge(process->account);
    if (work->ok && work->built && is_frame(work))
        world_keep(&work->world, &process->world_cache);
    else
        world_destroy(&work->world);
    process->radiosity.patches.world = NULL; /* of the solution until it is that of the next world */
    if (process->job.total > LARGE_JOB)
        arena_destroy(&process->job);
    else
        arena_reset(&process->job);
    (void)mem_charge(NULL);
}

/* The same within the remaining memory. */
static bool make_picture(struct picture_work *work, struct error *error) {
    struct render_process *process = work->process;
    (void)mem_charge(process->account);
    uint64_t refusals = mem_refusals();
    bool ok = make_picture_unlimited(work, error);
    if (!ok && mem_refusals() != refusals)
        (void)too_much_memory(process, error);
    (void)mem_charge(NULL);
    return ok;
}

/* The memory outside the arenas: the film plus half of its size for writing it, unless the command line chooses its
 * size, and the stacks of the workers. */
static bool reserve_memory(struct render_process *process, const struct picture_request *picture,
                           const struct settings *settings, struct error *error) {
    enum { STACK_OF_A_LEVEL = 8 << 10 };
    size_t film = 0;
    if (picture->check)
        return true;
    if (!picture_film_size(picture, &film, error))
        return false;
    uint64_t levels = (uint64_t)settings->reflect_limit + (uint64_t)settings->refract_limit;
    uint64_t bytes = (uint64_t)pool_workers(process->pool) * levels * STACK_OF_A_LEVEL;
    bytes += process->options->width ? 0 : film + film / 2;
    (void)mem_charge(process->account);
    bool ok = mem_reserve(bytes);
    (void)mem_charge(NULL);
    process->reserved = ok ? bytes : 0;
    return ok || too_much_memory(process, error);
}

static struct picture_request picture_request_of(const struct options *options, const struct render_job *job,
                                                 struct frame frame) {
    static const struct tone_table no_table = {{0}};
    const struct tone_table *table = job->settings.tone.table;
    struct settings recorded = job->settings;
    if (options->window) /* it shows no noise while it renders */
        recorded.denoise = DENOISER_GRAY;
    return (struct picture_request){.full_width = job->width,
                                    .full_height = job->height,
                                    .settings = job->settings,
                                    .tone_table = table ? *table : no_table,
                                    .record = render_record(&recorded),
                                    .layers = job->settings.aov,
                                    .in_window = options->window,
                                    .camera = job->camera,
                                    .frame = frame,
                                    .check = options->check || is_asked(options)};
}

/* Of a frame that a later one may be equal to; else zero. With --lenient, scripts change their scene for a picture. */
static struct digest digest_of_frame(const struct picture_work *work) {
    bool never = !is_frame(work) || work->picture_request.check || work->picture_request.in_window ||
                 work->request->changed || work->process->options->script.lenient;
    return never ? (struct digest){0} : render_request_digest(work->request);
}

/* The last rendered picture was such a frame, with an equal request, and no node has changed since. */
static bool repeats_frame(const struct picture_work *work) {
    return !digest_is_zero(work->shows) && digest_equal(work->shows, work->process->rendered) &&
           !scene_has_changes(work->request->scene);
}

/* Whether the run writes files of tiles by request, which name all files that were read by their contents. A checkpoint
 * that is only kept in case of an interruption is given up if they have more than logged_bytes. */
static const uint64_t logged_bytes = 256 * MEBIBYTE;
static bool needs_files(const struct options *options) {
    return options->checkpoint || options->shards || options->mpi;
}

/* Names the picture and creates its film. *already: there is nothing to do. */
static bool begin_picture(struct picture_work *work, bool *already, struct error *error) {
    struct render_process *process = work->process;
    struct render_job *job = &work->job;
    struct picture_request *picture = &work->picture_request;
    struct film *film = &work->film;
    const char *file = work->request->file;
    if (!light_meter_measure(work, error))
        return false;
    *picture = picture_request_of(process->options, job, work->request->frame);
    struct render_area area;
    char warning[256] = "";
    size_t length = strlen(file);
    if (length >= sizeof picture->file)
        return error_set(error, ERROR_SCENE, "the name of the picture is longer than %zu bytes",
                         sizeof picture->file - 1);
    memcpy(picture->file, file, length);
    memcpy(work->name, file, length + 1);
    if (work->request->frame.number > 0 && length + 128 < NAME_LIMIT) /* longer names have no number here */
        (void)picture_files_number_frame(work->request->frame.number, work->name, error);
    picture->keep = work->request->keep;
    if (!render_prepare(job, &area, warning, error))
        return false;
    if (warning[0] != '\0')
        render_process_warn_at(process, work->request->where, warning);
    picture->shown = (struct film_rectangle){area.x0, area.y0, area.x0 + area.width, area.y0 + area.height};
    uint32_t rim =
        settings_denoise(&job->settings) && path_film_parts(picture->record) & PATH_PART_FEATURES ? DENOISE_RIM : 0;
    rim += finish_rim(&job->settings.finish, picture->full_height);
    struct film_rectangle all = film_rectangle_grown(&picture->shown, rim, picture->full_width, picture->full_height);
    picture->x0 = all.x0, picture->y0 = all.y0, picture->width = all.x1 - all.x0, picture->height = all.y1 - all.y0;
    if (job->settings.view_is_target)
        picture->camera.view = vec3_sub(job->camera.view, job->camera.eye);
    picture->files = file_read_log_sum(&process->read_log);
    if (process->read_log.incomplete && needs_files(process->options))
        return error_no_memory(error, "the list of files that were read");
    if (process->read_log.incomplete)
        picture->files = (struct digest){0};
    if (!reserve_memory(process, picture, &job->settings, error))
        return false;
    bool turns = process->options->script.frames.turntable > 0;
    scene_set_time(work->request->scene, turns ? 0 : work->request->time);
    work->shows = digest_of_frame(work);
    picture->repeats = repeats_frame(work);
    if (!settle(process, error))
        return false;
    if (!process->services->begin(process->services->context, picture, film, already, error)) {
        error->refused = error->kind == ERROR_SCENE;
        return false;
    }
    /* Also for queries without a film. */
    film->x0 = picture->x0;
    film->y0 = picture->y0;
    film->full_width = picture->full_width;
    film->full_height = picture->full_height;
    return true;
}

/* The script's width or height; a preview has a quarter of it. */
static uint32_t in_preview(const struct options *options, double side) {
    uint32_t whole = (uint32_t)side;
    return options->preview ? (whole + 3) / 4 : whole;
}

static void init_work(struct picture_work *work, struct render_process *process, const struct render_request *request) {
    const struct options *options = process->options;
    struct control *control = process->services->control;
    process->picture_file = request->file;
    *work = (struct picture_work){.process = process, .request = request};
    work->job = (struct render_job){
        .camera = request->camera,
        .settings = request->settings,
        .width = options->width ? (uint32_t)options->width : in_preview(options, request->width),
        .height = options->height ? (uint32_t)options->height : in_preview(options, request->height),
        .ambient = request->ambient,
        .background_lights = request->sky_chosen,
        .radiosity = &process->radiosity,
        .film = &work->film,
        .shard = options->shard,
        .shards = options->shards,
        .tile_done = tile_done,
        .context = control,
        .drain = &control->drain,
    };
    /* The size is that of a view. */
    const struct lens *lens = &request->settings.lens;
    if (lens->columns > 0) {
        work->job.width *= (uint32_t)lens->columns;
        work->job.height *= (uint32_t)lens->rows * lens_grids(lens);
    }
    settings_set_draft(&work->job.settings, options->preview ? DRAFT_PREVIEW
                                            : options->quick ? DRAFT_QUICK
                                                             : DRAFT_NONE);
    struct settings *settings = &work->job.settings;
    if (!integrator_traits(settings->integrator).has_light_parts && settings->aov == AOV_ALL)
        settings->aov &= ~AOV_PATH; /* all that there are */
}

/* A frame of gr.frames that another one follows: the script goes on while its files are written. Outside the sandbox,
 * a script can read them in ways that wait_for_files does not see. */
static bool is_written_early(const struct picture_work *work) {
    const struct script_options *options = &work->process->options->script;
    const struct frame *frame = &work->request->frame;
    return work->process->animates && frame->number > 0 && !work->picture_request.check &&
           !work->picture_request.in_window && !options->no_sandbox &&
           frame_after(&options->frames.selection, frame) > 0;
}

static bool render_job_run(struct render_process *process, const struct render_request *request, struct error *error) {
    const struct host_services *services = process->services;
    struct control *control = services->control;
    struct picture_work work;
    bool already = false;
    init_work(&work, process, request);
    render_process_finish_output(process);
    if (is_cancelled(process))
        return error_set(error, ERROR_CANCELLED, "interrupted");
    if (!render_process_need_pool(process, error) || !begin_picture(&work, &already, error))
        return false;
    process->passed_over = already;
    process->frames_shown += already && work.picture_request.repeats; /* equal to the one before */
    if (already)
        return true;
    if (atomic_load(&control->progress_estimate.wanted))
        work.job.progress_estimate = &control->progress_estimate;
    work.job.handout = atomic_load(&control->handout) != HANDOUT_NONE ? &control->handout : NULL;
    work.job.handed = &control->handed;
    const struct options *options = process->options;
    effects_note(&work);
    work.job.settings.passes = options->display && !options->checkpoint && !work.job.handout; /* of paths */
    process->rendered = (struct digest){0};
    bool ok = make_picture(&work, error);
    ok = ok && (work.picture_request.check || model_export_show(process, &work.film, &work.job.settings.tone, error));
    bool bakes = options->bake && !process->baked && !work.picture_request.check;
    bool early = ok && !bakes && is_written_early(&work);
    if (ok && is_frame(&work))
        effects_count_frame(&work);
    if (!early)
        clear_picture(&work);
    if (ok && !work.picture_request.check)
        ok = services->done(services->context, &work.report, early, error);
    else
        services->abandon(services->context);
    if (ok && bakes)
        ok = model_export_bake(process, &work.job.settings.tone, error);
    if (early)
        clear_picture(&work);
    if (ok)
        process->rendered = work.shows;
    return ok;
}

/* Pictures may use the memory that the script does not use. They have their own account: memory kept between pictures,
 * such as the index of a mesh, is not counted for the script. `script` is its account, or NULL. */
static void grant_memory(struct render_process *process, const struct mem_account *script) {
    uint64_t all = script_picture_memory(&process->options->script);
    uint64_t held = script && script->held > 0 ? (uint64_t)script->held : 0;
    process->account = script ? &process->memory : NULL;
    process->memory.limit = all - (held < all ? held : all - 1);
}

struct mem_account *render_process_charge_picture(struct render_process *process) {
    struct mem_account *script = mem_charge(NULL);
    grant_memory(process, script);
    (void)mem_charge(process->account);
    return script;
}

static bool render_one(struct render_process *process, const struct render_request *request, struct error *error) {
    struct mem_account *script = mem_charge(NULL);
    grant_memory(process, script);
    process->pictures++;
    process->played += process->options->window && request->frame.number > 0;
    bool ok = options_allow_picture(process->options, process->pictures - process->played, error) &&
              render_job_run(process, request, error);
    (void)mem_charge(process->account);
    mem_unreserve(process->reserved);
    process->reserved = 0;
    (void)mem_charge(script);
    return ok;
}

/* With --check a scene that cannot be built is reported at once and the script continues, to find further errors. */
static bool render(void *context, const struct render_request *request, struct error *error) {
    struct render_process *process = context;
    bool model = process->options->model || process->options->check_print;
    if (process->skips)
        return true;
    if (model && !model_export_picture(process, request, error))
        return false;
    if (model && !process->options->output)
        return true;
    if (render_one(process, request, error)) {
        render_process_count_replaced(process, request->replaced);
        return true;
    }
    if (!process->options->check || error->kind != ERROR_SCENE || error->limit)
        return false;
    render_process_say(process, LINE_ERROR, "%s%s%s", error->elsewhere ? "" : request->where,
                       error->elsewhere ? "" : ": ", error->text);
    process->status = ERROR_SCENE;
    return true;
}

static void scene_text(void *context, const char *text, size_t size) {
    const struct render_process *process = context;
    scene_writer_take(process->errors, text, size);
}

static void message(void *context, enum script_message kind, const char *text) {
    switch (kind) {
    case SCRIPT_NOTICE:
        render_process_report_scene(context, LINE_NOTICE, text);
        return;
    case SCRIPT_WARNING:
        render_process_report_scene(context, LINE_WARNING, text);
        return;
    }
}

/* Prints the first line, and below it the traceback. Wrong usage is no error of the scene: the line begins with the
 * program's name. Errors of the machine or a limit begin with the name of the script. */
static void report_error(const struct render_process *process, struct arena *arena, const struct error *error,
                         const char *traceback) {
    const char *below = traceback ? traceback : "", *who = "";
    bool named = strncmp(error->text, process->script, strlen(process->script)) == 0;
    if (error->kind == ERROR_USAGE)
        who = "gray";
    else if ((error->kind == ERROR_MACHINE || error->limit) && !named)
        who = process->script;
    size_t length = strlen(below);
    while (length > 0 && below[length - 1] == '\n')
        length--;
    const char *text = arena_format(arena, "%s%s%s%s%.*s", who, who[0] ? ": " : "", error->text, length > 0 ? "\n" : "",
                                    (int)length, below);
    if (error->kind == ERROR_USAGE)
        render_process_report(process, LINE_ERROR, text ? text : error->text);
    else
        render_process_report_scene(process, LINE_ERROR, text ? text : error->text);
}

/* Meshes and images of earlier scripts, with the indexes that pictures have added, are kept for the next one until they
 * exceed the memory limit of a script and its picture. */
static void begin_memory(struct render_process *process) {
    (void)mem_charge(process->account);
    arena_destroy(&process->job);
    (void)mem_charge(NULL);
    process->assets.memory += process->memory.held > 0 ? (uint64_t)process->memory.held : 0;
    if (process->assets.memory > script_picture_memory(&process->options->script)) {
        assets_destroy(&process->assets);
        world_cache_destroy(&process->world_cache);
        radiosity_destroy(&process->radiosity);
    }
    process->account = NULL;
    process->memory = (struct mem_account){.option = "--script-memory", .words = "--script-memory is the limit"};
}

static void note_animation(void *context) {
    struct render_process *process = context;
    process->animates = true;
    process->skips = false;
}

static void begin_frame(void *context) {
    const struct render_process *process = context;
    if (process->services->frame)
        process->services->frame(process->services->context);
}

/* The frame that the window requests, among those that can be rendered. */
static uint32_t next_frame(void *context, const struct frame *frame) {
    const struct render_process *process = context;
    const struct frame_selection *selection = &process->options->script.frames.selection;
    uint32_t wanted = atomic_load(&process->services->control->next_frame);
    if (process->passed_over || (wanted == FRAMES_OVER && frame->number > 0))
        return 0;
    if (wanted == 0 || wanted == FRAMES_OVER)
        return selection->step > 0 ? selection->first : 1;
    return wanted < frame->count ? wanted : frame->count;
}

static void note_rewind(void *context) {
    struct render_process *process = context;
    process->rewinds = true;
    begin_frame(process);
}

static bool writes_scenes(const struct options *options) {
    return options->to_json || options->to_lua;
}

/* Runs a script once; returns the exit status. frame: the frame that it renders outside of gr.frames, or number 0;
 * repeats: an earlier run did not call gr.frames. */
static int run_once(struct render_process *process, const char *path, const struct frame *frame, bool repeats) {
    /* Without the sandbox, in a separate process, standard output is a copy of standard error here. */
    bool sandboxed = !process->options->script.no_sandbox, in_process = process->options->no_fork;
    struct script_host host = {.context = process,
                               .assets = &process->assets,
                               .settings = process->options->settings,
                               .width = process->options->width,
                               .height = process->options->height,
                               .render = render,
                               .export_model = model_export_node,
                               .write_scene = writes_scenes(process->options) ? scene_text_write : NULL,
                               .text_file = process->options->output,
                               .text_is_lua = process->options->to_lua,
                               .message = message,
                               .cancelled = is_cancelled,
                               .error_text = scene_text,
                               .frame = *frame,
                               .repeats = repeats,
                               .checks = process->options->check,
                               .namesakes = process->namesakes,
                               .frame_limit = options_picture_limit(process->options),
                               .animates = note_animation,
                               .frame_begins = begin_frame,
                               .prints = wait_for_files,
                               .next_frame = process->options->window ? next_frame : NULL,
                               .rewinds = note_rewind,
                               .output_is_error = (options_output_is_stream(process->options) ||
                                                   (writes_scenes(process->options) && !process->options->output)) &&
                                                  (sandboxed || in_process)};
    struct arena arena = {0};
    struct error error = {0};
    const char *traceback = NULL;
    begin_memory(process);
    process->rewinds = process->passed_over = false;
    bool ok = script_run(path, &process->options->script, &host, &arena, &traceback, &error);
    int status = ok ? process->status : (int)error.kind;
    if (!ok && error.kind != ERROR_CANCELLED)
        report_error(process, &arena, &error, traceback);
    if (!settle(process, &error)) {
        if (error.kind != ERROR_CANCELLED)
            report_error(process, &arena, &error, NULL);
        status = (int)error.kind > status ? (int)error.kind : status;
    }
    arena_destroy(&arena);
    render_process_finish_output(process);
    return status;
}

static void report_no_picture(struct render_process *process, const char *path) {
    char line[2 * NAME_LIMIT];
    (void)snprintf(line, sizeof line, "%.4095s: no picture was rendered, because the script did not call gr.render",
                   path);
    message(process, SCRIPT_NOTICE, line);
}

/* The model or the scene of the command line, after the script. Returns the exit status. */
static int finish_model(struct render_process *process, int status) {
    struct error error = {0};
    struct arena arena = {0};
    if (status != 0) {
        model_export_forget(process);
        list_destroy(&process->scene);
        return status;
    }
    bool is_model = process->options->model || process->options->check_print;
    if (scene_text_finish(process, &error) && (!is_model || model_export_finish(process, &error)))
        return 0;
    report_error(process, &arena, &error, NULL);
    arena_destroy(&arena);
    return (int)error.kind;
}

/* Runs a script; returns the exit status. With --frames, a script that does not call gr.frames runs again for each
 * frame; the first run shows whether it calls gr.frames. */
static int run_script(struct render_process *process, const char *path) {
    const struct frame_options *options = &process->options->script.frames;
    const struct frame_selection *selection = &options->selection;
    bool repeats = selection->step > 0 && options->turntable == 0;
    struct frame frame = {.number = repeats,
                          .count = repeats ? selection->last : 0,
                          .rate = options->rate > 0 ? options->rate : FRAME_RATE_DEFAULT,
                          .loops = options->loops};
    process->script = path;
    process->status = 0;
    process->warned_count = 0;
    memset(process->replaced, 0, sizeof process->replaced);
    process->faults = 0;
    process->animates = false;
    process->models = process->model_pictures = 0;
    process->picture_names[0] = '\0';
    /* In the window the first frame is the one that it asks for. */
    if (repeats && process->options->window) {
        frame.number = 0;
        frame.number = next_frame(process, &frame);
    }
    /* Whether it calls gr.frames is not known yet: a frame that is not selected is run, too, but not rendered. */
    process->skips = repeats && !frame_is_selected(selection, frame.number);
    (void)mem_charge(process->account);
    world_cache_destroy(&process->world_cache);
    radiosity_destroy(&process->radiosity);
    process->baked = false;
    (void)mem_charge(NULL);
    uint64_t first = process->pictures, before = first;
    int status = run_once(process, path, &frame, false);
    while (status == 0 && process->rewinds)
        status = run_once(process, path, &frame, false);
    process->skips = false;
    /* A script that renders nothing more ends the frames, except in a window. */
    while (repeats && status == 0 && !process->animates && (process->pictures > before || !process->options->window) &&
           (frame.number = process->options->window ? next_frame(process, &frame) : frame_after(selection, &frame)) >
               0) {
        begin_frame(process);
        before = process->pictures;
        status = run_once(process, path, &frame, true);
    }
    status = finish_model(process, status);
    if (status == 0 && process->pictures == first && process->models == 0 && process->model_pictures == 0)
        report_no_picture(process, path);
    render_process_report_replaced(process);
    return status;
}

struct model_picture {
    uint64_t name; /* its hash */
    int script;
};

static int by_name_and_script(const void *left, const void *right) {
    const struct model_picture *a = left, *b = right;
    return a->name != b->name ? (a->name < b->name ? -1 : 1) : (a->script > b->script) - (a->script < b->script);
}

/* Of each script, the models before it whose pictures have the same name: sorted, since a command line may have a
 * hundred thousand. NULL without memory: then a second picture of one name is refused. */
static uint32_t *count_namesakes(const struct options *options) {
    size_t room = (size_t)options->script_count + 1, count = 0;
    uint32_t *namesakes = mem_alloc_zero(room, sizeof *namesakes);
    struct model_picture *pictures = namesakes ? mem_alloc_zero(room, sizeof *pictures) : NULL;
    for (int i = 0; pictures && i < options->script_count; i++) {
        char name[PATH_SIZE];
        context_name_of_picture(options->scripts[i], ".png", name, sizeof name);
        if (model_is_named(options->scripts[i]))
            pictures[count++] = (struct model_picture){hash_bytes(name, strlen(name), 0), i};
    }
    if (count > 1)
        qsort(pictures, count, sizeof *pictures, by_name_and_script);
    for (size_t i = 1; i < count; i++)
        if (pictures[i].name == pictures[i - 1].name)
            namesakes[pictures[i].script] = namesakes[pictures[i - 1].script] + 1;
    mem_free(pictures);
    return namesakes;
}

static void run_scripts(struct render_process *process, int first) {
    uint32_t *namesakes = count_namesakes(process->options);
    process->pictures = process->played = process->frames_shown = 0;
    process->frames_differ = false;
    for (int i = first; i < process->options->script_count; i++) {
        process->namesakes = namesakes ? namesakes[i] : 0;
        int status = run_script(process, process->options->scripts[i]);
        process->services->script_ended(process->services->context, i, status);
        if (status == ERROR_USAGE || status == ERROR_CANCELLED)
            break;
    }
    mem_free(namesakes);
    effects_note_frames(process);
}

/* Reads are reported so that no picture replaces what was read. Under --watch every one is, since a file may change. */
static void report_file(struct render_process *process, const char *path, const struct file_version *version,
                        bool written) {
    bool watched = process->options->watch;
    if (!watched && file_set_has(&process->reported, version->identity))
        return;
    if (!watched)
        (void)file_set_add(&process->reported,
                           version->identity); /* without memory for the entry it is reported again */
    process->services->read(process->services->context, path, version, written);
}

static void report_read(void *context, const char *path, const struct file_version *version) {
    report_file(context, path, version, false);
}

static void report_write(void *context, const char *path, const struct file_version *version) {
    report_file(context, path, version, true);
}

void render_process_run(const struct options *options, const struct host_services *services, int first) {
    struct scene_writer errors;
    struct render_process process = {.options = options, .services = services, .errors = &errors};
    scene_writer_init(&errors, &services->control->error_stream);
    process.read_log.limit = needs_files(options) ? 0 : logged_bytes;
    process.store = (struct radiosity_store){&process, NULL, NULL, &services->control->unshot};
    if (options_keep_solution(options)) {
        process.store.load = model_export_load_solution;
        process.store.save = model_export_save_solution;
    }
    process.radiosity.store = &process.store;
    const struct file_listener listener = {.searches = services->wait ? wait_for_files : NULL,
                                           .log =
                                               needs_files(options) || options->keeps_tiles ? &process.read_log : NULL,
                                           .heard = services->read ? report_read : NULL,
                                           .wrote = services->read ? report_write : NULL,
                                           .contents = services->read && options->watch,
                                           .context = &process};
    bool watched = options->watch && services->again;
    mem_return_large();
    if (listener.log || listener.heard || listener.searches)
        file_set_listener(&listener);
    run_scripts(&process, first);
    /* With --watch until the window closes or the run is interrupted. */
    while (watched && services->again(services->context)) {
        if (process.pool)
            pool_reset_cancel(process.pool);
        run_scripts(&process, 0);
    }
    file_set_listener(NULL);
    pool_destroy(process.pool);
    arena_destroy(&process.job);
    assets_destroy(&process.assets);
    world_cache_destroy(&process.world_cache);
    radiosity_destroy(&process.radiosity);
    file_read_log_destroy(&process.read_log);
    file_set_destroy(&process.reported);
}
