#include "host/model_export.h"

#include "export/gltf_write.h"
#include "export/model_build.h"
#include "export/print_check.h"
#include "formats/model_format.h"
#include "host/render_reports.h"
#include "image/png_write.h"
#include "render/headlight.h"
#include "scene/traversal.h"
#include "session/text.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* What a model is made of. */
struct model_work {
    struct render_process *process;
    struct scene *scene;
    const struct node *node;
    const char *file, *where;
    double tolerance, time; /* seconds since the first frame */
    struct model_write_options write;
    struct kept_model made;
    struct vec3 view, up; /* of the thumbnail */
    bool by_user, linear;
};

enum { THUMBNAIL = 256 }; /* pixels wide and high */

static void notice(void *context, const char *text) {
    const struct model_work *work = context;
    render_process_say(work->process, LINE_NOTICE, "%.400s: %s", work->where, text);
}

static void detail(const struct model_work *work, const struct export_model *model) {
    size_t triangles = 0;
    for (size_t i = 0; i < model->parts.count; i++)
        triangles += export_parts(model)[i].triangles.count;
    render_process_say(work->process, LINE_DETAIL, "%.400s: %zu parts, %zu triangles", work->file, model->parts.count,
                       triangles);
}

static void print_report(const struct print_report *report) {
    struct text_writer writer = {.put = render_process_print};
    struct vec3 size = vec3_sub(report->box.max, report->box.min);
    text_writer_print(&writer, "closed: %s\n", report->closed ? "yes" : "no");
    text_writer_print(&writer, "volume: %.6g, surface: %.6g\n", report->volume, report->area);
    text_writer_print(&writer, "size: %.6g x %.6g x %.6g\n", size.x, size.y, size.z);
    if (isfinite(report->thinnest))
        text_writer_put(&writer, "thinnest wall: %g at %v\n", report->thinnest, report->thinnest_at);
    else
        text_writer_print(&writer, "thinnest wall: none is as thick as the tolerance\n");
    if (report->overhang > 0)
        text_writer_put(&writer, "steepest overhang: %g degrees from the vertical at %v; ", report->overhang,
                        report->overhang_at);
    else
        text_writer_print(&writer, "steepest overhang: none; ");
    text_writer_put(&writer, "area above 45 degrees: %g\n", report->overhang_area);
    text_writer_put(&writer,
                    report->is_standing ? "stands on the plate: yes, contact area %g\n"
                                        : "stands on the plate: no, it falls over; contact area %g\n",
                    report->contact_area);
    text_writer_flush(&writer);
}

/* All vertices are in a circle in the middle. */
static struct camera thumbnail_camera(const struct model_work *work, const struct world *world,
                                      const struct export_model *model) {
    const double fov = 30, slope = 0.255; /* tan(fov / 2), and a rim of 5 % */
    struct box box = world_finite_bounds(world);
    struct vec3 middle = vec3_scale(vec3_add(box.min, box.max), 0.5), view = vec3_normalize(work->view);
    double distance = 0;
    for (size_t i = 0; i < model->parts.count; i++) {
        const struct export_part *part = &export_parts(model)[i];
        for (size_t v = 0; v < part->points.count; v++) {
            struct vec3 to = vec3_sub(export_points(part)[v], middle);
            double along = vec3_dot(to, view), across = vec3_length(vec3_add_scaled(to, view, -along));
            distance = math_max(distance, across / slope - along);
        }
    }
    return (struct camera){vec3_add_scaled(middle, view, -distance), view, work->up, fov};
}

struct thumbnail {
    uint32_t width;
    uint8_t *rgb;
};

static void thumbnail_row(void *context, uint32_t y, uint8_t *line) {
    const struct thumbnail *thumbnail = context;
    memcpy(line, thumbnail->rgb + (size_t)3 * thumbnail->width * y, (size_t)3 * thumbnail->width);
}

static bool put_into_list(void *list, const void *bytes, size_t size, struct error *error) {
    return list_add_bytes(list, bytes, size) || error_no_memory(error, "a thumbnail");
}

/* A film as the bytes of a PNG file, reduced to at most THUMBNAIL pixels. */
static bool encode_thumbnail(const struct film *film, const struct tone *tone, struct list *out, struct error *error) {
    uint32_t longer = film->width > film->height ? film->width : film->height;
    double scale = longer > THUMBNAIL ? (double)THUMBNAIL / longer : 1;
    uint32_t width = (uint32_t)math_max(1, scale * film->width), height = (uint32_t)math_max(1, scale * film->height);
    struct thumbnail thumbnail = {width, mem_alloc((size_t)3 * width * height)};
    const struct png_source source = {
        .width = width, .height = height, .bytes = thumbnail_row, .context = &thumbnail, .srgb = tone->srgb};
    if (!thumbnail.rgb)
        return error_no_memory(error, "a thumbnail");
    film_shrink(film, tone, width, height, thumbnail.rgb);
    out->count = 0;
    bool ok = png_encode(&source, NULL, put_into_list, out, error);
    mem_free(thumbnail.rgb);
    return ok;
}

/* A picture of the model, without that of the script. */
static bool make_thumbnail(struct model_work *work, const struct world *world, const struct export_model *model,
                           struct error *error) {
    const struct film_record record = {0};
    const struct tone tone = {.srgb = work->linear};
    struct render_statistics statistics = {0};
    struct film film = {0};
    size_t size = 0;
    if (!film_size(2 * THUMBNAIL, 2 * THUMBNAIL, record, &size, error))
        return false;
    void *block = mem_alloc_zero(size, 1);
    if (!block)
        return error_no_memory(error, "a thumbnail");
    film_layout(&film, block, 2 * THUMBNAIL, 2 * THUMBNAIL, record);
    film.full_width = film.full_height = 2 * THUMBNAIL;
    const struct render_job job = {.world = world,
                                   .camera = thumbnail_camera(work, world, model),
                                   .settings = settings_default(),
                                   .width = 2 * THUMBNAIL,
                                   .height = 2 * THUMBNAIL,
                                   .film = &film};
    bool ok = render_headlight(&job, &(struct headlight_request){.state = FILM_TILE_DONE}, work->process->pool,
                               &statistics, error) &&
              encode_thumbnail(&film, &tone, &work->made.thumbnail, error);
    mem_free(block);
    return ok;
}

/* The world of the node alone, without lights; then the model of it. */
static bool build_model(struct model_work *work, struct export_model *model, struct error *error) {
    struct render_process *process = work->process;
    const struct sky sky = {.kind = SKY_CONSTANT, .colour = colour_all(0.9)}; /* behind the thumbnail */
    const struct world_input world_input = {.scene = work->scene,
                                            .root = work->node,
                                            .sky = &sky,
                                            .accel = process->options->settings.accel,
                                            .linear_colours = work->linear};
    bool is_3mf = work->write.format == FORMAT_3MF;
    struct world world;
    scene_set_time(work->scene, work->time);
    if (!world_build(&world, &world_input, &process->job, process->pool, error))
        return false;
    const struct model_build_input input = {.world = &world,
                                            .name = work->node->name,
                                            .tolerance = work->tolerance,
                                            .linear = work->linear,
                                            .corners = is_3mf || work->write.format == FORMAT_PLY,
                                            .arena = &process->job,
                                            .pool = process->pool,
                                            .notice = notice,
                                            .context = work};
    bool ok = model_build(&input, model, error);
    if (ok && process->options->check_print)
        ok = print_check(model, process->pool, &work->made.report, error);
    if (ok && is_3mf && !process->options->check_print)
        ok = make_thumbnail(work, &world, model, error);
    world_destroy(&world);
    return ok;
}

/* --- glTF --- */

static void warn(void *context, const char *text) {
    const struct model_work *work = context;
    render_process_say(work->process, LINE_WARNING, "%.400s: warning: %s", work->where, text);
}

/* A moment of the scene; request: of the picture, or NULL: the node alone. */
static bool add_moment(struct model_work *work, struct gltf_scene *scene, const struct render_request *request,
                       struct error *error) {
    struct render_process *process = work->process;
    struct world_input input = {.scene = work->scene,
                                .root = work->node,
                                .sky = &(struct sky){.kind = SKY_CONSTANT},
                                .accel = process->options->settings.accel,
                                .linear_colours = work->linear};
    struct gltf_moment moment = {.root = work->node, .scene = work->scene};
    struct camera camera;
    struct world world;
    if (request) {
        camera = request->camera;
        if (request->settings.view_is_target)
            camera.view = vec3_sub(camera.view, camera.eye);
        moment.camera = &camera;
        moment.lens = &request->settings.lens;
        moment.aspect = request->width / request->height;
        moment.is_frame = request->frame.number > 0;
        moment.time = moment.is_frame ? work->time : 0;
        input.lights = request->lights;
        input.light_count = request->light_count;
    }
    scene_set_time(work->scene, work->time);
    if (!world_build(&world, &input, &process->job, process->pool, error))
        return false;
    moment.world = &world;
    bool ok = gltf_scene_add(scene, &moment, error);
    world_destroy(&world);
    arena_reset(&process->job);
    return ok;
}

static struct gltf_scene *begin_scene(struct model_work *work, struct error *error) {
    const struct gltf_options options = {
        .tolerance = work->tolerance, .linear = work->linear, .pool = work->process->pool};
    struct gltf_scene *scene = gltf_scene_create(&options);
    if (!scene)
        error_no_memory(error, "a model");
    return scene;
}

static bool write_scene(struct model_work *work, struct gltf_scene *scene, struct error *error) {
    return gltf_scene_write(scene, work->write.format == FORMAT_GLB, warn, work, &work->made.files.model, error);
}

static bool make_scene(struct model_work *work, struct error *error) {
    struct gltf_scene *scene = begin_scene(work, error);
    bool ok = scene && add_moment(work, scene, NULL, error) &&
              (work->process->options->check || write_scene(work, scene, error));
    gltf_scene_destroy(scene);
    return ok;
}

/* What else a file lacks of a picture. */
static void warn_of_picture(struct model_work *work, const struct render_request *request) {
    if (request->sky_chosen)
        warn(work, "the sky is left out");
    if (colour_max_abs(request->ambient) > 0)
        warn(work, "the ambient light is left out");
    if (request->outside.affects)
        warn(work, "the medium around the scene is left out");
}

/* --- files --- */

static bool make_files(struct model_work *work, struct error *error) {
    struct render_process *process = work->process;
    struct export_model model = {0};
    if (model_format_is_scene(work->write.format))
        return make_scene(work, error);
    bool ok = build_model(work, &model, error);
    if (ok && !process->options->check) {
        detail(work, &model);
        ok = process->options->check_print || model_write(&model, &work->write, &work->made.files, error);
    }
    export_model_destroy(&model);
    arena_reset(&process->job);
    return ok;
}

static struct model_request request_of(const struct model_work *work) {
    struct model_request request = {.role = work->by_user ? MODEL_OF_USER : MODEL_OF_SCRIPT};
    (void)snprintf(request.file, sizeof request.file, "%s", work->file);
    return request;
}

/* The materials of an OBJ file first: a reader of the new model finds them. */
static bool send(struct model_work *work, struct error *error) {
    const struct host_services *services = work->process->services;
    struct model_request request = request_of(work);
    struct model_files *files = &work->made.files;
    if (files->directory.count > 0 && !model_add_thumbnail(files, &work->made.thumbnail, error))
        return false;
    if (files->mtl.count > 0) {
        request.beside = 1;
        request.size = files->mtl.count;
        if (!services->model(services->context, &request, files->mtl.items, error))
            return false;
    }
    request.beside = 0;
    request.size = files->model.count;
    return services->model(services->context, &request, files->model.items, error);
}

/* Writes the model, or prints its report. */
static bool finish(struct model_work *work, struct error *error) {
    const struct options *options = work->process->options;
    if (!options->check_print)
        return options->check || send(work, error);
    print_report(&work->made.report);
    return true;
}

static void forget(struct kept_model *kept) {
    model_files_destroy(&kept->files);
    list_destroy(&kept->thumbnail);
    *kept = (struct kept_model){0};
}

/* The account of memory is that of pictures. keep: where the model stays, or NULL: it is written. */
static bool run(struct model_work *work, struct kept_model *keep, struct error *error) {
    struct render_process *process = work->process;
    const struct host_services *services = process->services;
    struct model_request request = request_of(work);
    char mtl_name[256];
    const char *last = strrchr(work->file, '/');
    last = last ? last + 1 : work->file;
    if (strlen(work->file) >= sizeof request.file || strlen(last) >= sizeof mtl_name)
        return error_set(error, ERROR_SCENE, "the name of the model is longer than %zu bytes", sizeof mtl_name - 1);
    (void)snprintf(mtl_name, sizeof mtl_name, "%.*s.mtl", (int)strlen(last) - 4, last);
    work->write.format = model_format_written(work->file);
    work->write.mtl_name = mtl_name;
    if (!render_process_need_pool(process, error))
        return false;
    bool asks = !process->options->check_print;
    bool ok = !asks || services->model(services->context, &request, NULL, error);
    struct mem_account *script = render_process_charge_picture(process);
    ok = ok && make_files(work, error);
    (void)mem_charge(script);
    work->made.ready = work->made.shows_next = ok;
    if (ok && keep)
        *keep = work->made;
    else if (ok)
        ok = finish(work, error);
    if (!ok || !keep)
        forget(&work->made);
    if (asks)
        services->model_end(services->context);
    return ok;
}

bool model_export_node(void *context, const struct export_request *request, struct error *error) {
    struct render_process *process = context;
    struct model_work work = {.process = process,
                              .scene = request->scene,
                              .node = request->node,
                              .file = request->file,
                              .where = request->where,
                              .tolerance = request->tolerance,
                              .write = {.unit = (enum model_unit)request->unit, .text = request->text},
                              .view = {-0.4, 1, -0.35}, /* from the front, right and above */
                              .up = {0, 0, 1},
                              .linear = request->linear};
    process->models++;
    /* With -o MODEL the command line has chosen the model. */
    return process->skips || process->options->model || process->options->check_print || run(&work, NULL, error);
}

bool model_export_bake(struct render_process *process, const struct tone *tone, struct error *error) {
    const struct host_services *services = process->services;
    struct model_request request = {.role = MODEL_BAKED};
    struct list bytes = {0};
    if (process->radiosity.patches.all.count == 0)
        return true;
    (void)snprintf(request.file, sizeof request.file, "%.4000s", process->options->bake);
    bool ok = radiosity_bake(&process->radiosity, tone, model_format_baked(request.file), &bytes) ||
              error_no_memory(error, "the light of patches");
    request.size = bytes.count;
    ok = ok && services->model(services->context, &request, bytes.items, error);
    services->model_end(services->context);
    list_destroy(&bytes);
    process->baked = ok;
    return ok;
}

static struct model_request solution_request(const struct render_process *process, struct digest depends) {
    struct model_request request = {.role = MODEL_SOLUTION, .depends = depends};
    (void)snprintf(request.file, sizeof request.file, "%.4000s", process->picture_file);
    return request;
}

bool model_export_load_solution(void *context, struct digest depends, struct list *bytes, struct error *error) {
    const struct render_process *process = context;
    const struct host_services *services = process->services;
    const struct model_request request = solution_request(process, depends);
    bool ok = services->solution(services->context, &request, bytes, error);
    services->model_end(services->context);
    return ok;
}

void model_export_save_solution(void *context, struct digest depends, const struct list *bytes) {
    struct render_process *process = context;
    const struct host_services *services = process->services;
    struct model_request request = solution_request(process, depends);
    struct error error;
    request.size = bytes->count;
    if (!services->model(services->context, &request, bytes->items, &error))
        render_process_say(process, LINE_WARNING, "gray: warning: the solution of radiosity: %s", error.text);
    services->model_end(services->context);
}

/* The first node of that name. */
static const struct node *find_node(const struct node *root, const char *name, struct error *error) {
    struct scene_traversal t = {.operands = OPERANDS_ALL, .distinct = true};
    const struct node *found = NULL;
    enum scene_event event;
    scene_traversal_begin(&t, root);
    while (!found && (event = scene_traversal_next(&t)) < SCENE_END) {
        const struct node *node = scene_traversal_node(&t);
        if (event == SCENE_ENTER && node->name && strcmp(node->name, name) == 0)
            found = node;
    }
    scene_traversal_end(&t);
    if (!found) {
        (void)error_set(error, ERROR_SCENE, "--node %.200s: the scene has no node of this name", name);
        (void)error_elsewhere(error);
    }
    return found;
}

/* Adds the scene of a picture to the file, which is written when no other frame comes. */
static bool keep_moment(struct model_work *work, const struct render_request *request, struct error *error) {
    struct render_process *process = work->process;
    const struct host_services *services = process->services;
    const struct model_request file = request_of(work);
    const bool is_first = !process->gltf_scene;
    if (!render_process_need_pool(process, error) || !services->model(services->context, &file, NULL, error))
        return false;
    struct mem_account *script = render_process_charge_picture(process);
    if (is_first)
        process->gltf_scene = begin_scene(work, error);
    process->gltf_frame = request->frame.number;
    bool ok = process->gltf_scene && add_moment(work, process->gltf_scene, request, error);
    (void)mem_charge(script);
    services->model_end(services->context);
    if (ok && is_first)
        warn_of_picture(work, request);
    process->kept_model.ready = ok;
    return ok;
}

bool model_export_picture(struct render_process *process, const struct render_request *request, struct error *error) {
    const struct options *options = process->options;
    const struct camera *camera = &request->camera;
    struct model_work work = {.process = process,
                              .scene = request->scene,
                              .node = request->subject,
                              .file = options->model ? options->model : "check.stl",
                              .where = request->where,
                              .tolerance = options->tolerance,
                              .time = options->script.frames.turntable > 0 ? 0 : request->time,
                              .write = {.unit = (enum model_unit)options->unit},
                              .view =
                                  request->settings.view_is_target ? vec3_sub(camera->view, camera->eye) : camera->view,
                              .up = camera->up,
                              .by_user = true,
                              .linear = settings_linear(&request->settings)};
    const bool is_scene = model_format_is_scene(model_format_written(work.file));
    /* The frames of an animation are one file. */
    const bool goes_on = is_scene && process->gltf_scene && request->frame.number > process->gltf_frame;
    uint32_t number = goes_on ? process->model_pictures : ++process->model_pictures;
    process->kept_model.shows_next = false;
    if (goes_on) {
        return keep_moment(&work, request, error);
    }
    size_t length = strlen(process->picture_names);
    (void)snprintf(process->picture_names + length, sizeof process->picture_names - length, "%s%u %.80s",
                   number > 1 ? ", " : "", number, request->file);
    if (options->picture > 0 ? number != (uint32_t)options->picture : number > 1)
        return true;
    if (request->frame.number > 0 && options->script.frames.selection.step == 0 && !is_scene)
        return error_set(error, ERROR_SCENE, "a model shows one frame: --frames N-N chooses it");
    if (options->node && !(work.node = find_node(request->root, options->node, error)))
        return false;
    return is_scene ? keep_moment(&work, request, error)
                    : run(&work, options->picture > 0 && !options->output ? NULL : &process->kept_model, error);
}

bool model_export_show(struct render_process *process, const struct film *film, const struct tone *tone,
                       struct error *error) {
    struct kept_model *kept = &process->kept_model;
    bool shows = kept->shows_next && kept->thumbnail.count > 0;
    kept->shows_next = false;
    return !shows || film_tiles_in(film, FILM_TILE_DONE) < film_tile_count(film) ||
           encode_thumbnail(film, tone, &kept->thumbnail, error);
}

bool model_export_finish(struct render_process *process, struct error *error) {
    const struct options *options = process->options;
    const struct host_services *services = process->services;
    struct model_work work = {.process = process,
                              .file = options->model,
                              .where = options->model,
                              .by_user = true,
                              .made = process->kept_model};
    struct gltf_scene *scene = process->gltf_scene;
    const char *option = options->model ? options->model : "--check-print";
    bool ok = true;
    process->kept_model = (struct kept_model){0};
    process->gltf_scene = NULL;
    if (options->picture == 0 && process->model_pictures > 1)
        ok = error_set(error, ERROR_USAGE,
                       "%.200s: the script renders several pictures, %.600s; --picture N chooses one", option,
                       process->picture_names);
    else if (options->picture > 0 && process->model_pictures < (uint32_t)options->picture)
        ok = error_set(error, ERROR_USAGE, "--picture %d: the script renders %u pictures", options->picture,
                       process->model_pictures);
    else if (process->model_pictures == 0)
        ok = error_set(error, ERROR_USAGE, "%.200s: the script renders no picture whose scene could be the model",
                       option);
    else if (work.made.ready) {
        work.write.format = options->model ? model_format_written(options->model) : FORMAT_OTHER;
        ok = (!scene || options->check || write_scene(&work, scene, error)) && finish(&work, error);
        if (options->model)
            services->model_end(services->context);
    }
    gltf_scene_destroy(scene);
    forget(&work.made);
    return ok;
}

void model_export_forget(struct render_process *process) {
    gltf_scene_destroy(process->gltf_scene);
    process->gltf_scene = NULL;
    forget(&process->kept_model);
}
