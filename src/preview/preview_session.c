/* Executes a command, replies, and waits for the next one; the viewer makes all decisions. All changes are undone and
 * applied again together, so that their order is that of the list, as in a script. */
#include "preview/preview_session.h"

#include "base/clock.h"
#include "film/path_film.h"
#include "inspect/inspect.h"
#include "inspect/pick.h"
#include "light/light_edit.h"
#include "preview/view_overlay_internal.h"
#include "radiosity/radiosity.h"
#include "render/camera.h"

#include <stdio.h>
#include <string.h>

struct preview_state {
    struct preview_session *preview;
    struct change_list changes;
    struct changed_scene changed;
    bool stale;    /* the world does not include the changes, or there is none */
    bool reported; /* the first reply about the world was sent */
    struct pass_view view;
    double build_seconds;
};

/* Settings of a pass: a coarse pass is a draft with one sample per pixel. */
static void set_pass(struct render_job *job, const struct render_job *own, const struct pass_view *view,
                     struct film *film) {
    *job = *own;
    job->film = film;
    job->width = film->full_width;
    job->height = film->full_height;
    job->settings.show_refined = true;
    job->settings.tile_order = TILE_ORDER_CENTRE;
    job->settings.tone.exposure = view->exposure;
    job->settings.passes = (view->divide <= 1 && !view->plain) || view->samples > 0;
    settings_set_draft(&job->settings, view->plain && !view->walks ? DRAFT_QUICK : DRAFT_NONE);
    if (view->walks)
        job->settings.passes = false;
    if (view->plain && !view->walks)
        job->device = NULL;
    if (!job->settings.passes || view->samples > 0) {
        job->settings.path_samples = view->samples > 0 ? (int)view->samples : 1;
        job->settings.noise = job->settings.time_limit = 0;
    }
    if (view->samples > 0 && path_film_parts(film->record) & PATH_PART_FEATURES) /* for passes that follow */
        job->settings.denoise = DENOISER_GRAY;
    job->kept_samples = view->kept;
    if (view->divide > 1 || view->width > 0) { /* the film determines the part */
        job->settings.cropped = false;
        job->settings.keep_first = false;
    }
    if (!view->own) {
        job->camera = view->camera;
        settings_move_camera(&job->settings, &view->camera);
    }
}

/* The supervisor requests a stop, and clears the request before it sends the next command. */
bool preview_was_stopped(const struct control *control, const struct error *error) {
    return error->kind == ERROR_CANCELLED && atomic_load(&control->cancel) != CANCEL_ALL;
}

/* The film of the pass: in the memory of the picture, or a larger one. */
static bool lay_film(const struct preview_state *work, void *large, struct film *film, struct error *error) {
    const struct preview_session *preview = work->preview;
    struct picture_request request;
    if (work->view.width == 0) {
        *film = pass_film(preview->picture_request, preview->job->film->pixels, work->view.divide);
        return true;
    }
    if (!large || !picture_request_enlarge(preview->picture_request, work->view.width, work->view.height, &request))
        return error_set(error, ERROR_MACHINE, "the memory of the picture cannot be reached");
    *film = pass_film(&request, large, 1);
    return true;
}

/* The job with the camera of the window. */
static struct render_job view_job(const struct preview_state *work, const struct pass_view *view) {
    struct render_job job = *work->preview->job;
    if (!view->own) {
        job.camera = view->camera;
        settings_move_camera(&job.settings, &view->camera);
    }
    return job;
}

/* The patch of radiosity at a point, or PATCH_NONE. */
static uint32_t find_patch(const struct preview_state *work, const struct view_point *at) {
    const struct render_job job = view_job(work, &(struct pass_view){.camera = at->camera, .own = at->own});
    const struct radiosity *radiosity = job.radiosity;
    struct world_scratch scratch;
    struct camera_frame frame;
    struct error ignored;
    struct ray ray;
    struct hit hit;
    char warning[256];
    uint32_t patch = PATCH_NONE;
    double shares[3];
    if (!radiosity || radiosity->patches.world != job.world || !world_scratch_init(&scratch, job.world))
        return PATCH_NONE;
    bool found = camera_prepare(&job.camera, &job.settings, (struct picture_size){job.width, job.height}, &frame,
                                warning, &ignored) &&
                 camera_ray_through(&frame, at->x, at->y, (struct sample2){0.5, 0.5}, NULL, &ray) &&
                 world_nearest(job.world, &ray, &scratch, &hit) &&
                 patches_find(&radiosity->patches, &hit, &patch, shares);
    world_scratch_destroy(&scratch);
    return found ? patch : PATCH_NONE;
}

static bool make_pass(struct preview_state *work, void *large, struct picture_report *report, struct error *error) {
    struct preview_session *preview = work->preview;
    struct render_job job;
    struct film film;
    double begun = clock_now();
    if (!lay_film(work, large, &film, error))
        return false;
    set_pass(&job, preview->job, &work->view, &film);
    /* A coarse pass needs no time estimate. */
    struct progress_estimate *progress_estimate = &preview->services->control->progress_estimate;
    bool fine = work->view.divide <= 1 && !work->view.plain;
    progress_estimate_reset(progress_estimate, fine);
    job.progress_estimate = fine ? progress_estimate : NULL;
    report->rays = (struct render_statistics){.build_seconds = work->build_seconds};
    const struct headlight_request headlight = {
        .shows = work->view.shows,
        .coarse = work->view.divide > 1,
        .state = FILM_TILE_DONE,
        .patch = work->view.shows == HEADLIGHT_FACTORS ? find_patch(work, &work->view.patch) : PATCH_NONE};
    bool ok = work->view.headlight ? render_headlight(&job, &headlight, preview->pool, &report->rays, error)
                                   : render_run(&job, preview->pool, &report->rays, error);
    report->stopped = !ok && preview_was_stopped(preview->services->control, error);
    if (!ok && !report->stopped)
        return false;
    pool_reset_cancel(preview->pool);
    report->rays.render_seconds = clock_now() - begun;
    preview->fill(preview->context, &film, report);
    return true;
}

/* The changed light, which may not be in the world yet; the position of a mesh light comes from the world, if there is
 * one. */
static void describe_light(const struct world *world, const struct light *light, uint32_t number,
                           struct light_info *out) {
    const struct light *built = world && number < world->light_count ? &world->lights[number] : light;
    unsigned properties = light_properties(light);
    struct vec3 position = light->position;
    bool has_position = light_can_move(light) || light_centre(built, &position);
    *out = (struct light_info){.kind = (uint32_t)light->kind,
                               .properties = properties,
                               .has_position = has_position,
                               .position = position,
                               .colour = light->colour,
                               .direction = properties & LIGHT_HAS_DIRECTION ? light->direction : vec3_all(0),
                               .edge1 = light->edge1,
                               .edge2 = light->edge2,
                               .radius = light->radius,
                               .cos_outer = light->cos_outer,
                               .moves = light_can_move(light),
                               .turns = light_can_turn(light),
                               .sizes = light_can_size(light)};
}

static void describe_lights(const struct preview_state *work, uint32_t first, struct preview_reply *reply) {
    bool over = work->changes.count > 0;
    const struct scene_light *lights = over ? work->changed.lights : work->preview->request->lights;
    reply->light_count = over ? work->changed.light_count : work->preview->request->light_count;
    reply->first_light = first;
    for (uint32_t i = 0; i < LIGHTS_PER_MESSAGE && first < reply->light_count && i < reply->light_count - first; i++)
        describe_light(work->stale ? NULL : work->preview->world, &lights[first + i].light, first + i,
                       &reply->lights[i]);
}

static bool build_again(struct preview_state *work, struct error *error) {
    struct preview_session *preview = work->preview;
    double begun = clock_now();
    bool ok = preview->build(preview->context, work->changes.count > 0 ? &work->changed : NULL, error);
    work->build_seconds = clock_now() - begun;
    work->stale = !ok;
    pool_reset_cancel(preview->pool);
    return ok;
}

/* The world of the changes; if the user stops its building it remains stale, and `reply` reports this. False: an
 * error. */
static bool need_world(struct preview_state *work, struct preview_reply *reply, struct error *error) {
    if (!work->stale || build_again(work, error))
        return true;
    reply->unbuilt = preview_was_stopped(work->preview->services->control, error);
    if (reply->unbuilt)
        reply->kind = REPLY_CHANGED;
    return reply->unbuilt;
}

/* What the first edit that was skipped has to say; others may follow from it. */
struct lost_edit {
    const struct preview_session *preview;
    char text[1024];
};

static void note_lost_edit(void *context, const char *text) {
    struct lost_edit *lost = context;
    if (lost->text[0] == '\0')
        (void)snprintf(lost->text, sizeof lost->text, "%s", text);
    lost->preview->warn(lost->preview->context, text);
}

static bool change_scene(struct preview_state *work, const struct preview_command *command, struct preview_reply *reply,
                         struct error *error) {
    struct preview_session *preview = work->preview;
    const struct render_request *request = preview->request;
    reply->kind = REPLY_CHANGED;
    if ((unsigned)command->change.kind >= CHANGE_KINDS ||
        !memchr(command->change.call, '\0', sizeof command->change.call) ||
        (unsigned)command->change.part >= MATERIAL_PART_PARTS ||
        !change_list_set(&work->changes, &command->change, command->present)) {
        (void)snprintf(reply->text, sizeof reply->text, "there are too many changes");
        return true;
    }
    preview->device.forget(preview->device.context);
    /* Changes are laid over the script's scene anew, so their order does not matter. */
    changes_remove(&work->changed);
    struct lost_edit lost = {.preview = preview};
    if (!changes_lay_over((struct change_range){work->changes.items, work->changes.count},
                          &(struct change_target){&request->maker, request->scene, request->root, request->lights,
                                                  request->light_count},
                          note_lost_edit, &lost, &work->changed, error))
        return false;
    (void)snprintf(reply->text, sizeof reply->text, "%.500s", lost.text);
    reply->added = work->changed.added_count;
    /* Colours only change numbers; everything else needs a new world, after the last change of a row. */
    work->stale = work->stale || !change_keeps_world(&command->change);
    if (!command->more && !need_world(work, reply, error))
        return false;
    if (!work->stale)
        world_update_materials(preview->world);
    reply->unbuilt = work->stale;
    describe_lights(work, command->first_light, reply);
    return true;
}

/* The material is reported without the changes of the window, which the viewer has itself. */
static bool answer_click(const struct preview_state *work, const struct preview_command *command, struct picked *picked,
                         struct error *error) {
    struct render_job job = view_job(work, &command->view);
    const struct node *root = work->preview->request->root;
    const struct pick_query query = {command->x, command->y, command->up};
    bool material = command->by_node && command->node.depth > 0 && command->node.path[0] == SECTION_MATERIALS;
    if (material)
        pick_material(job.world, &command->node, picked);
    else if (!(command->by_node ? pick_node(&job, root, &command->node, picked, error)
                                : pick_at(&job, root, query, picked, error)))
        return false;
    const struct material *before = changes_before(&work->changed, picked->material_serial);
    for (int part = 0; before && part < MATERIAL_PART_PARTS; part++)
        material_part_get(before, (enum material_part)part, picked->inputs[part]);
    return true;
}

static void print_piece(void *context, const char *text) {
    const struct preview_session *preview = context;
    preview->services->line(preview->services->context, LINE_OUTPUT, text);
}

static bool send_pixel_trace(struct preview_state *work, const struct preview_command *command, struct error *error) {
    struct preview_session *preview = work->preview;
    struct render_job job = view_job(work, &command->view);
    struct inspected picture = {
        .file = preview->request->file, .job = &job, .root = preview->request->root, .pool = preview->pool};
    struct text_writer writer = {.put = print_piece, .context = preview};
    const uint32_t pixel[1][2] = {{(uint32_t)command->x, (uint32_t)command->y}};
    /* The supervisor requests pixels of the picture only; others have no trace. */
    if (!(command->x >= 0 && command->y >= 0 && command->x < job.width && command->y < job.height))
        return true;
    return inspect_pixels(&picture, pixel, 1, &writer, error);
}

static void describe_world(struct preview_state *work, struct preview_reply *reply) {
    const struct node *root = work->preview->request->root;
    reply->kind = REPLY_BUILT;
    reply->built = clock_now();
    reply->added = work->preview->request->added;
    reply->owned = work->preview->request->owned;
    reply->report.bounds = world_finite_bounds(work->preview->world);
    reply->root = root->serial;
    reply->world_from_root = node_parent_from_node(root).forward;
    pick_copy_name(reply->root_name, root->name);
    describe_lights(work, 0, reply);
    work->reported = true;
}

/* A stopped overlay is made later. False: an error. */
static bool make_overlay(struct preview_state *work, const struct pass_view *view,
                         const struct view_overlay_request *request, struct preview_reply *reply, struct error *error) {
    struct preview_session *preview = work->preview;
    struct render_job job = view_job(work, view);
    struct view_overlay_buffers buffers;
    view_overlay_buffers(preview->picture_request, job.film->pixels, &buffers);
    if (request->lines.limit == 0 || request->lines.cell == 0) /* no lines are requested */
        return true;
    double begun = clock_now();
    const struct view_overlay_scene scene = {&job, preview->request->root, preview->pool};
    bool ok = view_overlay_make(&scene, request, &buffers, &reply->overlay, error);
    reply->report.rays.render_seconds += clock_now() - begun; /* a frame exists only with its lines */
    reply->overlay.stopped = !ok && preview_was_stopped(preview->services->control, error);
    pool_reset_cancel(preview->pool);
    return ok || reply->overlay.stopped;
}

/* The object there, and where it is visible. */
static bool pick(struct preview_state *work, const struct preview_command *command, struct preview_reply *reply,
                 struct error *error) {
    struct view_overlay_request request = {.lines = {OVERLAY_NONE, 1, 1}, .outline = true};
    if (!answer_click(work, command, &reply->picked, error))
        return false;
    request.serial = reply->picked.serial;
    request.route = reply->picked.route;
    request.solid = reply->picked.solid;
    return !reply->picked.hit || command->probes || make_overlay(work, &command->view, &request, reply, error);
}

static bool execute_command(struct preview_state *work, const struct preview_command *command,
                            struct preview_reply *reply, struct error *error) {
    if (command->kind != COMMAND_CHANGE && (!need_world(work, reply, error) || reply->unbuilt))
        return reply->unbuilt;
    /* The window learns of a new world before anything else. */
    if (command->kind != COMMAND_CHANGE && !work->reported) {
        describe_world(work, reply);
        return true;
    }
    switch (command->kind) {
    case COMMAND_PASS:
        reply->kind = REPLY_PASS;
        work->view = command->view;
        return make_pass(work, command->block, &reply->report, error) &&
               (reply->report.stopped || make_overlay(work, &command->view, &command->overlay, reply, error));
    case COMMAND_PICK:
        reply->kind = REPLY_PICKED;
        return pick(work, command, reply, error);
    case COMMAND_OVERLAY:
        reply->kind = REPLY_OVERLAY;
        return make_overlay(work, &command->view, &command->overlay, reply, error);
    case COMMAND_CHANGE:
        return change_scene(work, command, reply, error);
    case COMMAND_PIXEL_TRACE:
        reply->kind = REPLY_PIXEL_TRACE;
        return send_pixel_trace(work, command, error);
    case COMMAND_LIGHTS:
        reply->kind = REPLY_LIGHTS;
        describe_lights(work, command->first_light, reply);
        return true;
    case COMMAND_NODES:
        reply->kind = REPLY_NODES;
        node_list_rows(work->preview->request->root, &command->node, &reply->nodes);
        material_rows(work->preview->job->world, &command->node, &reply->nodes);
        return true;
    case COMMAND_END:
        break;
    }
    return true;
}

static bool walks(const struct preview_state *work) {
    const struct preview_session *preview = work->preview;
    const struct film *film = preview->job->film;
    return preview->job->device && !work->stale &&
           preview->device.walks(preview->device.context, (uint64_t)film->width * film->height);
}

static bool serve(struct preview_state *work, struct picture_report *report, struct error *error) {
    struct preview_session *preview = work->preview;
    struct preview_reply reply = {.kind = REPLY_CHANGED, .report = *report, .unbuilt = work->stale};
    struct preview_command command;
    if (!work->stale)
        describe_world(work, &reply);
    for (;;) {
        if (reply.kind == REPLY_BUILT)
            report->bounds = reply.report.bounds;
        reply.walks = walks(work);
        if (!preview->services->reply(preview->services->context, &reply, &command, error))
            return false;
        if (command.kind == COMMAND_END)
            return !command.quit || error_set(error, ERROR_CANCELLED, "the window was closed");
        reply = (struct preview_reply){.report = *report};
        if (!execute_command(work, &command, &reply, error))
            return false;
        if (reply.kind == REPLY_PASS)
            *report = reply.report;
    }
}

bool preview_run(struct preview_session *preview, bool built, struct picture_report *report, double build_seconds,
                 struct error *error) {
    struct preview_state work = {.preview = preview, .stale = !built, .build_seconds = build_seconds};
    bool ok = serve(&work, report, error);
    changes_remove(&work.changed);
    change_list_destroy(&work.changes);
    return ok;
}
