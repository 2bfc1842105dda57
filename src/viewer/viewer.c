/* Passes: while the camera moves, one sample for every divide x divide pixels, with divide chosen so that a pass takes
 * about a thirtieth of a second; then finer ones, and finally the picture with the settings of the script. The cost of
 * a pass is proportional to the square of 1 / divide, which gives divide. */
#include "base/mem.h"
#include "film/path_film.h"
#include "viewer/viewer_internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { FIRST_DIVIDE = 16, MIDDLE_DIVIDE = 4, DIVIDE_LIMIT = 32 };
/* In seconds, and where that would leave less than a quarter of the pixels in each direction. */
static const double pass_goal = 1 / 30.0, pass_limit = 1 / 22.0, margin = 1.02;

static bool is_different(double a, double b) {
    return a < b || a > b;
}

static struct pass_view current_view(const struct viewer *viewer, uint32_t divide, bool plain) {
    return (struct pass_view){
        .camera = viewer->camera_moved ? fly_camera_current(&viewer->fly_camera) : viewer->request.camera,
        .exposure = viewer->request.settings.tone.exposure,
        .divide = divide,
        .plain = plain,
        .headlight = plain && (!viewer_plays(viewer) || viewer->window.mode.previews || viewer_shows_denoised(viewer)),
        .shows = viewer->window.mode.shows,
        .patch = viewer->window.mode.patch,
        .own = !viewer->camera_moved};
}

/* The scripts ran again: a moved camera and the edits are kept. */
static void keep_work(struct viewer *viewer, const struct viewer *before) {
    struct pose home = viewer->fly_camera.home;
    if (before->camera_moved) {
        viewer->fly_camera = before->fly_camera;
        viewer->fly_camera.home = home;
        viewer->camera_moved = true;
    }
    if (is_different(before->request.settings.tone.exposure, before->script_exposure))
        viewer->request.settings.tone.exposure = before->request.settings.tone.exposure;
    viewer->edit.steps = before->edit.steps;
    viewer->edit.saved_at = before->edit.saved_at;
    viewer->edit.pending = before->edit.pending;
    viewer->edit.tool = before->edit.tool;
    viewer_resend_edits(viewer);
}

static void forget_work(struct viewer *viewer) {
    edits_destroy(&viewer->edit.steps);
    change_list_destroy(&viewer->edit.pending);
}

static void close_window(struct viewer *viewer) {
    if (viewer->window.open)
        viewer->window.driver->close(viewer->window.driver->context);
    mem_free(viewer->window.image);
    mem_free(viewer->window.light);
    mem_free(viewer->window.drawn);
    mem_free(viewer->window.tones);
    viewer_destroy_overlay(viewer);
    viewer_destroy_large(viewer);
    viewer->window.tones = NULL;
    viewer->window.image = viewer->window.drawn = NULL;
    viewer->window.light = NULL;
    viewer->window.layout = (struct window_layout){0};
    viewer->window.open = false;
}

/* Images for the size of the request. */
static bool make_images(struct viewer *viewer, struct error *error) {
    const struct picture_request *request = &viewer->request;
    size_t pixels = (size_t)request->width * request->height;
    mem_free(viewer->window.image);
    mem_free(viewer->window.light);
    mem_free(viewer->window.drawn);
    viewer->window.image = mem_alloc_zero(pixels, 3);
    viewer->window.light = mem_alloc_zero(pixels, 3 * sizeof(float));
    viewer->window.drawn = mem_alloc_zero(viewer->display.tiles, 1);
    viewer->window.tones = viewer->window.tones ? viewer->window.tones : mem_alloc_zero(1, sizeof(struct tone_lookup));
    bool ok = viewer->window.tones && viewer->window.image && viewer->window.light && viewer->window.drawn;
    return ok || error_no_memory(error, "the window");
}

/* The window stays open for a picture of another size. */
static bool fit_images(struct viewer *viewer, struct error *error) {
    const struct window_layout layout = viewer->window.layout;
    if (!make_images(viewer, error)) {
        close_window(viewer);
        return false;
    }
    viewer->window.dirty = true;
    viewer_resize(viewer, layout.width, layout.height, layout.density);
    return true;
}

static bool open_window(struct viewer *viewer, struct error *error) {
    if (!make_images(viewer, error))
        return false;
    viewer->window.driver->state->has_scene = true;
    viewer->window.open = viewer->window.driver->open(viewer->window.driver->context, error);
    return viewer->window.open;
}

bool viewer_open(struct viewer *viewer, const struct window_driver *driver, const char *title, uint32_t width,
                 uint32_t height, struct error *error) {
    const struct box unknown = box_empty();
    const struct camera camera = {.view = {0, 0, -1}, .up = {0, 1, 0}, .fov = 50};
    viewer->window.driver = driver;
    viewer->request = (struct picture_request){
        .full_width = width, .full_height = height, .width = width, .height = height, .camera = camera};
    (void)snprintf(viewer->request.file, sizeof viewer->request.file, "%s", title);
    viewer->display.tiles = 1;
    fly_camera_begin(&viewer->fly_camera, &camera, &unknown);
    return open_window(viewer, error);
}

bool viewer_begin(struct viewer *viewer, const struct window_driver *driver, const struct viewer_picture *picture,
                  double now, struct error *error) {
    const struct picture_request *request = picture->request;
    struct film whole = pass_film(request, picture->block, 1);
    const struct box unknown = box_empty();
    bool kept = (viewer->keep && viewer->window.open) || viewer_player_continues(viewer, request);
    bool resized = viewer->request.width != request->width || viewer->request.height != request->height;
    viewer_destroy_overlay(viewer);
    struct viewer before = *viewer;
    bool was_picture = before.window.open && before.name[0] != '\0';
    *viewer = (struct viewer){.window = before.window,
                              .request = *request,
                              .block = picture->block,
                              .script_exposure = request->settings.tone.exposure,
                              .pass = {.outdated = true, .from_coarse = true, .divide = FIRST_DIVIDE, .began = now},
                              .overlay.kind = was_picture ? before.overlay.kind : request->settings.overlay,
                              .display = {.tiles = film_tile_count(&whole), .shown_at = now},
                              .stepped = now,
                              .begun = now};
    viewer->window.driver = driver;
    viewer->window.large.shown = false;
    viewer->window.large.refused_width = 0;
    mem_free(before.lights.items);
    (void)snprintf(viewer->name, sizeof viewer->name, "%s", picture->name);
    fly_camera_begin(&viewer->fly_camera, &request->camera, &unknown);
    viewer->pass.view = current_view(viewer, FIRST_DIVIDE, true);
    if (kept)
        keep_work(viewer, &before);
    else
        forget_work(&before);
    viewer_player_begin(viewer, &before);
    resized = resized || viewer->display.tiles != before.display.tiles; /* before: maybe a window without picture */
    if (viewer->window.open ? resized && !fit_images(viewer, error) : !open_window(viewer, error))
        return false;
    memset(viewer->window.drawn, 0, viewer->display.tiles);
    return true;
}

void viewer_end(struct viewer *viewer) {
    close_window(viewer);
    forget_work(viewer);
    mem_free(viewer->lights.items);
    *viewer = (struct viewer){.window = {.control = viewer->window.control, .logs_notes = viewer->window.logs_notes}};
}

void viewer_detach(struct viewer *viewer) {
    viewer->block = NULL;
    viewer->pass.film = (struct film){0};
    viewer->pass.state = PASS_BUSY;
    if (viewer->pass.result == RESULT_STOPPED)
        viewer->pass.result = RESULT_NONE;
    viewer->edit.click_waits = viewer->trace.requested = false;
    viewer->pass.halted = viewer->pass.unbuilt = false;
    viewer->edit.selection.kind = SELECTED_NOTHING;
    viewer->display.figures_at = 0;
}

bool viewer_has_tiles(const struct viewer *viewer) {
    const struct viewer_pass *pass = &viewer->pass;
    return viewer->block && pass->view.own && !pass->view.plain && pass->view.divide == 1 && pass->view.samples == 0 &&
           pass->view.width == 0 && !pass->edited;
}

bool viewer_delays_change(struct viewer *viewer, double now) {
    static const double long_time = 30; /* seconds */
    double end = viewer->finished > 0 ? viewer->finished : now;
    viewer->window.changed = viewer->window.open && viewer->begun > 0 && end - viewer->begun > long_time;
    return viewer->window.changed;
}

void viewer_keep(struct viewer *viewer) {
    viewer->keep = viewer->window.open;
}

bool viewer_skips(const struct viewer *viewer, unsigned number) {
    return viewer->keep && number < viewer->window.number;
}

void viewer_add_pixel_trace(struct viewer *viewer, const char *text) {
    size_t used = strlen(viewer->trace.text);
    (void)snprintf(viewer->trace.text + used, sizeof viewer->trace.text - used, "%s", text);
    viewer->display.hud_dirty = true;
}

void viewer_show_message(struct viewer *viewer, const char *text) {
    size_t length = strcspn(text, "\n");
    (void)snprintf(viewer->message, sizeof viewer->message, "%.*s", (int)(length < 500 ? length : 500), text);
    viewer->display.figures_at = 0;
}

void viewer_show_notice(struct viewer *viewer, const char *text, bool warns) {
    viewer->window.notice = (struct viewer_notice){.warns = warns};
    (void)snprintf(viewer->window.notice.text, sizeof viewer->window.notice.text, "%.500s", text);
    viewer->display.figures_at = 0;
}

/* Commands. */

void viewer_note_stop(struct viewer *viewer, double seconds) {
    (void)snprintf(viewer->note, sizeof viewer->note, "%.100s: stopped in %.1f ms", viewer->request.file,
                   1000 * seconds);
}

/* There is no unfinished request of the user. */
static bool is_served(const struct viewer *viewer) {
    return !viewer->pass.outdated && !viewer->edit.click_waits && !viewer->trace.requested &&
           viewer->edit.pending.count == 0 && !viewer_needs_overlay(viewer);
}

bool viewer_is_idle(const struct viewer *viewer) {
    return viewer->pass.state == PASS_WAITING && viewer->pass.result == RESULT_COMPLETE && is_served(viewer) &&
           !viewer_wants_large(viewer) && !viewer_large_is_outdated(viewer);
}

bool viewer_rests(const struct viewer *viewer) {
    bool flies = false;
    for (int key = 0; key < FLY_KEYS; key++)
        flies = flies || viewer->fly_camera.down[key];
    bool done = viewer->window.waits || (viewer->block && (viewer_is_idle(viewer) || viewer->pass.halted));
    return viewer->window.open && done && !flies && !viewer->window.dirty && !viewer_plays(viewer);
}

bool viewer_is_enlarging(const struct viewer *viewer) {
    return is_served(viewer) && !viewer_is_idle(viewer) && (viewer->pass.view.width > 0 || viewer_wants_large(viewer));
}

void viewer_choose_mode(struct viewer *viewer, struct view_mode mode) {
    viewer->window.mode = mode;
    viewer_outdate(viewer);
    viewer_halt(viewer, false);
}

void viewer_outdate(struct viewer *viewer) {
    const double pause = 0.3; /* seconds; between two movements */
    struct viewer_motion *motion = &viewer->motion;
    if (motion->began <= 0 || viewer->stepped - motion->last > pause)
        *motion = (struct viewer_motion){.began = viewer->stepped};
    motion->last = viewer->stepped;
    viewer->pass.outdated = true;
}

/* Counts the pictures of a movement; at the end reports how soon they came, and the first denoised one. */
static void note_motion(struct viewer *viewer, double now) {
    struct viewer_motion *motion = &viewer->motion;
    const struct pass_view *view = &viewer->pass.view;
    if (motion->began <= 0 || viewer->pass.began < motion->began)
        return;
    motion->first_shown = motion->first_shown > 0 ? motion->first_shown : now;
    if (viewer->pass.began < motion->last + pass_goal) {
        motion->pictures++;
        motion->divide = view->divide;
    }
    if (view->headlight && view->divide == 1)
        (void)snprintf(
            viewer->note, sizeof viewer->note,
            "%.40s: %u pictures in %.2f s, at 1/%u, the first after %.0f ms, all pixels %.0f ms after the last",
            viewer->request.file, motion->pictures, motion->last - motion->began, motion->divide,
            1000 * (motion->first_shown - motion->began), 1000 * (now - motion->last));
    if (view->walks && viewer->pass.began >= motion->last)
        (void)snprintf(viewer->note, sizeof viewer->note,
                       "%.40s: %u pictures of the integrator in %.2f s, the first after %.0f ms", viewer->request.file,
                       motion->pictures, motion->last - motion->began, 1000 * (motion->first_shown - motion->began));
    if (view->headlight || view->walks)
        return;
    (void)snprintf(viewer->note, sizeof viewer->note, "%.40s: the integrator after %.0f ms, at 1/%u",
                   viewer->request.file, 1000 * (now - motion->last), view->divide);
    motion->began = 0;
}

void viewer_fit_resolution(struct viewer *viewer, double now, double seconds, double limit) {
    uint32_t divide = viewer->pass.divide;
    if (!viewer->pass.view.plain || viewer->pass.view.walks || viewer->pass.view.divide != divide)
        return;
    double side = divide * sqrt(now - viewer->pass.began);
    double needed = math_min(math_max(math_min(side / sqrt(seconds), MIDDLE_DIVIDE), side / sqrt(limit)), 1.5 * divide);
    if (needed > divide)
        divide = needed < DIVIDE_LIMIT ? (uint32_t)ceil(needed) : DIVIDE_LIMIT;
    else if (ceil(margin * needed) < divide)
        divide = (uint32_t)math_max(1, ceil(margin * needed));
    viewer->pass.divide = divide;
}

static void end_pass(struct viewer *viewer, const struct picture_report *report, double now) {
    bool known = viewer->pass.report.threads > 0;
    bool last = viewer->window.mode.previews && viewer->pass.view.headlight && viewer->pass.view.divide == 1;
    bool few = (viewer->pass.view.plain && !last) || viewer->pass.view.samples > 0;
    viewer->pass.result = report->stopped ? RESULT_STOPPED : few ? RESULT_COARSE : RESULT_COMPLETE;
    if (report->stopped)
        return;
    /* Tiles that were finished before a pass was stopped may be denoised now. */
    if (path_film_parts(viewer->pass.film.record) != 0) {
        memset(viewer->window.drawn, 0, viewer->display.tiles);
        viewer->window.large.stale = viewer->window.large.shown;
    }
    viewer->pass.report = *report;
    if (viewer->overlay.kind == OVERLAY_OF_PATCHES && !viewer->pass.view.plain) /* they are those of the picture */
        viewer->overlay.lines_fresh = false;
    if (viewer_plays(viewer)) {
        viewer_player_end_pass(viewer, now);
        return;
    }
    viewer_draw_tiles(viewer);
    note_motion(viewer, now);
    if (known)
        viewer_fit_resolution(viewer, now, pass_goal, pass_limit);
}

void viewer_receive_reply(struct viewer *viewer, const struct preview_reply *reply, double now) {
    if (viewer->pass.halted && viewer->pass.halted_at > 0)
        viewer_note_stop(viewer, now - viewer->pass.halted_at);
    viewer->pass.halted_at = 0;
    viewer->pass.state = PASS_WAITING;
    viewer->display.hud_dirty = true;
    viewer->pass.unbuilt = reply->unbuilt;
    viewer->pass.walks = reply->walks;
    /* The reply is to the last command; what it shows is drawn at the next step. */
    switch (reply->kind) {
    case REPLY_BUILT:
        fly_camera_measure(&viewer->fly_camera, &reply->report.bounds);
        viewer->pass.outdated = true;
        viewer->built = reply->built;
        viewer->scene = *reply;
        viewer->nodes.count = 0;
        viewer->window.driver->nodes(viewer->window.driver->context, NULL, NULL);
        viewer_receive_lights(viewer, reply);
        return;
    case REPLY_PASS:
        end_pass(viewer, &reply->report, now);
        if (!reply->report.stopped && viewer->command.overlay.lines.limit > 0)
            viewer_receive_overlay(viewer, &viewer->command.overlay, &reply->overlay);
        return;
    case REPLY_OVERLAY:
        viewer_receive_overlay(viewer, &viewer->command.overlay, &reply->overlay);
        return;
    case REPLY_PICKED:
        viewer_receive_picked(viewer, &reply->picked);
        if (viewer->command.probes)
            return;
        viewer->command.overlay = viewer_overlay_request(viewer, false);
        viewer->command.overlay.lines.kind = OVERLAY_NONE;
        viewer_receive_overlay(viewer, &viewer->command.overlay, &reply->overlay);
        return;
    case REPLY_CHANGED:
        if (reply->added != viewer->nodes.added || reply->light_count != viewer->lights.count)
            viewer->window.driver->nodes(viewer->window.driver->context, NULL, NULL);
        viewer->nodes.added = reply->added;
        if (!reply->unbuilt || reply->light_count > 0)
            viewer_receive_lights(viewer, reply);
        if (reply->text[0] != '\0')
            viewer_take_back(viewer, reply->text);
        viewer->pass.outdated = true;
        viewer_invalidate_overlay(viewer);
        return;
    case REPLY_LIGHTS:
        viewer_receive_lights(viewer, reply);
        return;
    case REPLY_NODES:
        viewer->rows = reply->nodes;
        viewer_receive_nodes(viewer, &viewer->command.node, &viewer->rows);
        return;
    case REPLY_PIXEL_TRACE:
        return;
    }
}

static void command_pass(struct viewer *viewer, double now) {
    viewer->command = (struct preview_command){.kind = COMMAND_PASS, .view = viewer->pass.view};
    viewer->pass.result = RESULT_NONE;
    viewer->pass.state = PASS_RUNNING;
    viewer->pass.began = now;
}

/* resume: finished tiles are kept. */
static void begin_pass(struct viewer *viewer, uint32_t divide, bool plain, bool resume, double now) {
    if (!resume) {
        viewer_drop_large(viewer);
        viewer->pass.view = current_view(viewer, divide, plain);
        viewer->pass.film = pass_film(&viewer->request, viewer->block, divide);
        viewer->pass.edited = viewer->edit.steps.now.count > 0 ||
                              is_different(viewer->request.settings.tone.exposure, viewer->script_exposure);
        memset(viewer->window.drawn, 0, viewer->display.tiles);
        if (viewer->pass.film.marked)
            memset(viewer->pass.film.marked, 0, (size_t)viewer->pass.film.width * viewer->pass.film.height);
    }
    viewer->pass.view.kept = 0;
    for (uint32_t tile = 0; tile < film_tile_count(&viewer->pass.film); tile++) {
        if (!resume || atomic_load(&viewer->pass.film.tiles[tile]) != FILM_TILE_DONE)
            atomic_store(&viewer->pass.film.tiles[tile], FILM_TILE_WANTED);
    }
    command_pass(viewer, now);
    if (viewer->pass.outdated)
        viewer_invalidate_overlay(viewer);
    if (plain && !resume && viewer_needs_overlay(viewer))
        viewer->command.overlay = viewer_overlay_request(viewer, viewer->pass.outdated);
    viewer->pass.outdated = false;
}

/* The complete view again, at the resolution of the window. */
static void begin_large_pass(struct viewer *viewer, double now) {
    viewer->pass.view.kept = 0; /* its film is another one */
    for (uint32_t tile = 0; tile < film_tile_count(&viewer->pass.film); tile++)
        atomic_store(&viewer->pass.film.tiles[tile], FILM_TILE_WANTED);
    command_pass(viewer, now);
}

/* The first change that was not sent yet. */
static void command_change(struct viewer *viewer) {
    struct change target = viewer->edit.pending.items[0];
    const struct change *now = change_list_find(&viewer->edit.steps.now, &target);
    (void)change_list_set(&viewer->edit.pending, &target, false);
    bool light = target.kind == CHANGE_LIGHT || target.kind == CHANGE_DARK;
    viewer->command = (struct preview_command){.kind = COMMAND_CHANGE,
                                               .change = now ? *now : target,
                                               .present = now != NULL,
                                               .more = viewer->edit.pending.count > 0,
                                               .first_light = light ? target.serial - 1 : 0};
}

static void command_pick(struct viewer *viewer) {
    viewer->edit.click_waits = false;
    viewer->command = (struct preview_command){.kind = COMMAND_PICK,
                                               .view = current_view(viewer, 1, true),
                                               .x = viewer->edit.click.x,
                                               .y = viewer->edit.click.y,
                                               .up = viewer->edit.click.up,
                                               .probes = viewer->edit.probes,
                                               .by_node = viewer->edit.by_node,
                                               .node = viewer->edit.node};
    viewer->edit.by_node = false;
}

/* Rows that were wanted first. */
static void command_nodes(struct viewer *viewer) {
    struct viewer_nodes *nodes = &viewer->nodes;
    viewer->command = (struct preview_command){.kind = COMMAND_NODES, .node = nodes->wanted[0]};
    memmove(nodes->wanted, nodes->wanted + 1, --nodes->count * sizeof *nodes->wanted);
}

static void command_pixel_trace(struct viewer *viewer) {
    viewer->trace.requested = false;
    viewer->trace.text[0] = '\0';
    viewer->command = (struct preview_command){.kind = COMMAND_PIXEL_TRACE,
                                               .view = current_view(viewer, 1, false),
                                               .x = viewer->trace.x,
                                               .y = viewer->trace.y};
}

static void command_overlay(struct viewer *viewer) {
    viewer->command = (struct preview_command){.kind = COMMAND_OVERLAY,
                                               .view = current_view(viewer, 1, true),
                                               .overlay = viewer_overlay_request(viewer, false)};
}

/* While the camera moves, a device makes one sample for each pixel. */
static void begin_walking_pass(struct viewer *viewer, double now) {
    begin_pass(viewer, 1, true, false, now);
    viewer->pass.view.headlight = false;
    viewer->pass.view.walks = true;
    viewer->pass.view.samples = 1;
    viewer->command.view = viewer->pass.view;
}

/* Between the preview and the picture of a progressive integrator: denoised pictures, of 2 and 4 samples at a third of
 * the pixels in each direction, of 8 at a half, then of twice as many samples each time, which those before are a part
 * of. After a pass that walks, which has one sample of all pixels, the next one has 8. Where the noise or the time
 * decides, there are at most 16. */
static void begin_finer_pass(struct viewer *viewer, double now) {
    enum { FIRST = 2, HALF = 8, ADAPTIVE_LIMIT = 16 };
    const struct settings *settings = &viewer->request.settings;
    bool adapts = settings->noise > 0 || settings->time_limit > 0;
    const struct pass_view *before = &viewer->pass.view;
    uint32_t done = before->samples, all = settings_path_samples(settings);
    uint32_t samples = before->walks ? HALF : done > 0 ? 2 * done : FIRST;
    uint32_t divide = before->walks || samples > HALF ? 1 : samples < HALF ? 3 : 2;
    bool last = !viewer_shows_denoised(viewer) || samples > all / 2 || (adapts && samples > ADAPTIVE_LIMIT);
    bool keeps = done > 0 && done < all && before->divide == 1 && !adapts && viewer->pass.result == RESULT_COARSE;
    begin_pass(viewer, last ? 1 : divide, false, false, now);
    viewer->pass.view.samples = last ? 0 : samples;
    viewer->pass.view.kept = keeps ? done : 0;
    viewer->command.view = viewer->pass.view;
}

bool viewer_shows_denoised(const struct viewer *viewer) {
    return (path_film_parts(viewer->request.record) & PATH_PART_FEATURES) != 0;
}

static enum viewer_action next_command(struct viewer *viewer, double now) {
    if (viewer_large_is_outdated(viewer) && !viewer->pass.outdated)
        viewer_drop_large(viewer);
    bool coarse = viewer->pass.view.plain && viewer->pass.view.divide > MIDDLE_DIVIDE && !viewer->pass.halted;
    if (viewer->pass.halted && viewer->pass.unbuilt) /* the pending request has no answer */
        viewer->edit.click_waits = viewer->trace.requested = false;
    if (viewer->edit.pending.count > 0 && !viewer->pass.halted) {
        command_change(viewer);
    } else if (viewer->edit.click_waits) {
        command_pick(viewer);
    } else if (viewer->trace.requested) {
        command_pixel_trace(viewer);
    } else if (viewer->nodes.count > 0) {
        command_nodes(viewer);
    } else if (!viewer->pass.outdated && !coarse && viewer_needs_overlay(viewer)) {
        command_overlay(viewer);
    } else if (viewer->pass.halted) {
        return VIEWER_NOTHING;
    } else if (viewer->pass.outdated) {
        viewer->pass.from_coarse = false;
        if (viewer->pass.walks && !viewer->window.mode.previews && !viewer_plays(viewer))
            begin_walking_pass(viewer, now);
        else
            begin_pass(viewer, viewer->pass.divide, true, false, now);
    } else if (viewer->lights.known < viewer->lights.count) {
        viewer->command = (struct preview_command){.kind = COMMAND_LIGHTS, .first_light = viewer->lights.known};
    } else if (!viewer->pass.view.plain &&
               is_different(viewer->pass.view.exposure, viewer->request.settings.tone.exposure)) {
        begin_pass(viewer, 1, false, false, now);
    } else if (viewer->pass.result == RESULT_STOPPED) {
        begin_pass(viewer, 0, false, true, now);
    } else if (viewer->pass.result == RESULT_COMPLETE) {
        if (!viewer_wants_large(viewer) || !viewer_begin_large(viewer))
            return VIEWER_NOTHING;
        begin_large_pass(viewer, now);
    } else if (viewer->pass.view.headlight && viewer->pass.view.divide > 1) {
        begin_pass(viewer, viewer->pass.view.divide / 2, true, false, now);
    } else if (viewer->pass.view.divide > MIDDLE_DIVIDE) {
        begin_pass(viewer, MIDDLE_DIVIDE, true, false, now);
    } else {
        begin_finer_pass(viewer, now);
    }
    if (viewer->command.kind != COMMAND_PASS)
        viewer->pass.state = PASS_BUSY;
    return VIEWER_SEND_COMMAND;
}

/* What can be done while the render process works. */
static enum viewer_action step_running(struct viewer *viewer) {
    /* A coarse pass ends soon and is useful to show; a fine one is stopped. */
    const struct pass_view *view = &viewer->pass.view;
    bool coarse = view->plain && (view->walks || view->divide >= viewer->pass.divide);
    if (viewer->pass.halted && viewer->block && viewer->pass.state != PASS_STOPPING) {
        viewer->pass.state = PASS_STOPPING;
        return VIEWER_STOP_PASS;
    }
    bool wanted = viewer->pass.outdated || viewer_large_is_outdated(viewer) || viewer->player.target > 0 ||
                  (!coarse && viewer_needs_overlay(viewer)) || viewer->edit.click_waits || viewer->trace.requested ||
                  viewer->nodes.count > 0 || viewer->edit.pending.count > 0 ||
                  is_different(viewer->pass.view.exposure, viewer->request.settings.tone.exposure);
    if (viewer->pass.state != PASS_RUNNING || !wanted || coarse)
        return VIEWER_NOTHING;
    viewer->pass.state = PASS_STOPPING;
    return VIEWER_STOP_PASS;
}

/* The picture is written with the overlay lines of the command line, which exist if they are visible. */
static bool lines_of_script(const struct viewer *viewer) {
    return viewer->request.settings.overlay == OVERLAY_NONE ||
           (viewer->overlay.kind == viewer->request.settings.overlay && viewer->overlay.lines_fresh &&
            viewer->overlay.has_lines && !viewer->pass.outdated);
}

enum viewer_action viewer_step(struct viewer *viewer, double now) {
    struct window_event event;
    double seconds = now - viewer->stepped;
    viewer->stepped = now;
    if (viewer->block && fly_camera_step(&viewer->fly_camera, seconds < 0.1 ? seconds : 0.1))
        viewer_change_view(viewer);
    while (viewer->action == VIEWER_NOTHING && !viewer->quit &&
           (!viewer->window.logs_notes || viewer->note[0] == '\0') &&
           viewer->window.driver->poll(viewer->window.driver->context, &event))
        viewer_handle_event(viewer, &event);
    /* A fine pass of an outdated view is being stopped: it would show the previous view. */
    bool stale = viewer->pass.outdated && !viewer->pass.view.plain;
    if ((viewer->pass.state == PASS_RUNNING || viewer->pass.state == PASS_STOPPING) && !viewer_plays(viewer) && !stale)
        viewer_draw_tiles(viewer);
    viewer_show(viewer, now);
    enum viewer_action action = viewer->action;
    viewer->action = VIEWER_NOTHING;
    if (action != VIEWER_NOTHING)
        return action;
    if (viewer->window.logs_notes && viewer->note[0] != '\0')
        return VIEWER_LOG_NOTE;
    if (viewer->quit)
        return VIEWER_QUIT;
    if (viewer->pass.result == RESULT_COMPLETE && !viewer->pass.view.plain && viewer->pass.view.width == 0 &&
        viewer->pass.view.own && !viewer->pass.edited && !viewer->written && lines_of_script(viewer)) {
        viewer->written = true;
        if (viewer->request.settings.overlay != OVERLAY_NONE)
            overlay_lay(&viewer->pass.film, viewer->overlay.lines);
        return VIEWER_WRITE_PICTURE;
    }
    if (viewer->pass.state == PASS_WAITING && viewer->next && viewer->written)
        return VIEWER_NEXT_PICTURE;
    if (viewer->pass.state == PASS_WAITING && viewer_plays(viewer) && viewer->nodes.count > 0) {
        command_nodes(viewer); /* the tree is filled between two frames */
        viewer->pass.state = PASS_BUSY;
        return VIEWER_SEND_COMMAND;
    }
    switch (viewer_player_decide(viewer, now)) {
    case PLAYER_GOES:
        return VIEWER_NEXT_FRAME;
    case PLAYER_WAITS:
        return VIEWER_NOTHING;
    case PLAYER_REFINES:
        break;
    }
    return viewer->pass.state == PASS_WAITING ? next_command(viewer, now) : step_running(viewer);
}

uint32_t viewer_next_frame(const struct viewer *viewer) {
    if (viewer->player.target > 0)
        return viewer->player.target;
    return viewer->next ? FRAMES_OVER : viewer->request.frame.number;
}
