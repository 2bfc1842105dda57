/* Passes: while somebody walks, one sample for every divide x divide pixels, with divide so that a pass takes about a
 * thirtieth of a second; then finer ones, and at last the picture as the script wants it. The cost of a pass goes with
 * the square of 1 / divide, which is how divide is found. */
#include "base/mem.h"
#include "viewer/viewer_internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { FIRST_DIVIDE = 16, MIDDLE_DIVIDE = 4, DIVIDE_LIMIT = 32 };
static const double pass_goal = 0.033;

static bool is_different(double a, double b) {
    return a < b || a > b;
}

static struct pass_view current_view(const struct viewer *viewer, uint32_t divide, bool plain) {
    return (struct pass_view){.camera = viewer->camera_moved ? fly_camera_camera(&viewer->fly_camera)
                                                             : viewer->request.camera,
                              .exposure = viewer->request.exposure,
                              .divide = divide,
                              .plain = plain,
                              .own = !viewer->camera_moved};
}

/* The scripts ran again: where somebody has flown to and what was changed stays. */
static void keep_work(struct viewer *viewer, const struct viewer *before) {
    struct pose home = viewer->fly_camera.home;
    if (before->camera_moved) {
        viewer->fly_camera = before->fly_camera;
        viewer->fly_camera.home = home;
        viewer->camera_moved = true;
    }
    if (is_different(before->request.exposure, before->script_exposure))
        viewer->request.exposure = before->request.exposure;
    viewer->edits = before->edits;
    viewer->pending = before->pending;
    viewer->tool = before->tool;
    viewer_resend_edits(viewer);
}

static void forget_work(struct viewer *viewer) {
    edits_destroy(&viewer->edits);
    change_list_destroy(&viewer->pending);
}

static void close_window(struct viewer *viewer) {
    if (viewer->open)
        viewer->driver->close(viewer->driver->context);
    mem_free(viewer->image);
    mem_free(viewer->light);
    mem_free(viewer->drawn);
    viewer_destroy_overlay(viewer);
    mem_free(viewer->panel.canvas.rgba);
    viewer->image = viewer->drawn = viewer->panel.canvas.rgba = NULL;
    viewer->light = NULL;
    viewer->layout = (struct window_layout){0};
    viewer->open = false;
}

/* The window with all that belongs to it. */
static void keep_window(struct viewer *viewer, const struct viewer *before) {
    viewer->control = before->control;
    viewer->number = before->number;
    viewer->logs_notes = before->logs_notes;
    viewer->image = before->image;
    viewer->light = before->light;
    viewer->drawn = before->drawn;
    viewer->layout = before->layout;
    viewer->panel = before->panel;
    viewer->hides_overlay = before->hides_overlay;
    viewer->overlay = before->open ? before->overlay : viewer->overlay;
    viewer->open = before->open;
}

static bool open_window(struct viewer *viewer, struct error *error) {
    const struct picture_request *request = &viewer->request;
    size_t pixels = (size_t)request->width * request->height;
    viewer->image = mem_alloc_zero(pixels, 3);
    viewer->light = mem_alloc_zero(pixels, 3 * sizeof(float));
    viewer->drawn = mem_alloc_zero(viewer->tiles, 1);
    if (!viewer->image || !viewer->light || !viewer->drawn)
        return error_no_memory(error, "the window");
    viewer->open = viewer->driver->open(viewer->driver->context, request->width, request->height, viewer->name, error);
    return viewer->open;
}

bool viewer_begin(struct viewer *viewer, const struct window_driver *driver, const struct picture_request *request,
                  void *block, const char *name, double now, struct error *error) {
    struct film whole = pass_film(request, block, 1);
    const struct box unknown = box_empty();
    bool kept = viewer->keep && viewer->open;
    if (viewer->open && (viewer->request.width != request->width || viewer->request.height != request->height))
        close_window(viewer);
    viewer_destroy_overlay(viewer);
    struct viewer before = *viewer;
    *viewer =
        (struct viewer){.driver = driver,
                        .request = *request,
                        .block = block,
                        .script_exposure = request->exposure,
                        .overlay = request->overlay <= OVERLAY_OF_GRID ? (enum overlay)request->overlay : OVERLAY_NONE,
                        .tiles = film_tile_count(&whole),
                        .moved = true,
                        .again = true,
                        .divide = FIRST_DIVIDE / 2,
                        .pass_began = now,
                        .stepped = now,
                        .shown = now};
    mem_free(before.lights);
    keep_window(viewer, &before);
    (void)snprintf(viewer->name, sizeof viewer->name, "%s", name);
    fly_camera_begin(&viewer->fly_camera, &request->camera, &unknown);
    viewer->view = current_view(viewer, FIRST_DIVIDE, true);
    if (kept)
        keep_work(viewer, &before);
    else
        forget_work(&before);
    if (!viewer->open && !open_window(viewer, error))
        return false;
    memset(viewer->drawn, 0, viewer->tiles);
    return true;
}

void viewer_end(struct viewer *viewer) {
    close_window(viewer);
    forget_work(viewer);
    mem_free(viewer->lights);
    *viewer = (struct viewer){.control = viewer->control, .logs_notes = viewer->logs_notes};
}

void viewer_detach(struct viewer *viewer) {
    viewer->block = NULL;
    viewer->film = (struct film){0};
    viewer->running = viewer->waiting = viewer->stopping = viewer->partial = viewer->asks = viewer->wants_trace = false;
    viewer->halted = viewer->unbuilt = false;
    viewer->selection.kind = SELECTED_NOTHING;
    viewer->figures_at = 0;
}

void viewer_keep(struct viewer *viewer) {
    viewer->keep = viewer->open;
}

bool viewer_skips(const struct viewer *viewer, unsigned number) {
    return viewer->keep && number < viewer->number;
}

void viewer_add_pixel_trace(struct viewer *viewer, const char *text) {
    size_t used = strlen(viewer->trace_text);
    (void)snprintf(viewer->trace_text + used, sizeof viewer->trace_text - used, "%s", text);
    viewer->over_dirty = true;
}

void viewer_show_message(struct viewer *viewer, const char *text) {
    size_t length = strcspn(text, "\n");
    (void)snprintf(viewer->message, sizeof viewer->message, "%.*s", (int)(length < 500 ? length : 500), text);
    viewer->figures_at = 0;
}

/* Orders. */

void viewer_note_stop(struct viewer *viewer, double seconds) {
    (void)snprintf(viewer->note, sizeof viewer->note, "%.100s: stopped in %.1f ms", viewer->request.file,
                   1000 * seconds);
}

bool viewer_is_idle(const struct viewer *viewer) {
    return viewer->waiting && viewer->complete && !viewer->moved && !viewer->asks && !viewer->wants_trace &&
           viewer->pending.count == 0;
}

static void end_pass(struct viewer *viewer, const struct picture_report *report, double now) {
    bool known = viewer->report.threads > 0;
    viewer->partial = report->stopped != 0;
    if (report->stopped)
        return;
    viewer_draw_tiles(viewer);
    /* Passes that take no time say nothing about how coarse they must be. */
    double took = now - viewer->pass_began, divide = viewer->view.divide * sqrt(took / pass_goal);
    if (viewer->view.plain && viewer->view.divide == viewer->divide && known)
        viewer->divide = divide < 1 ? 1 : divide > DIVIDE_LIMIT ? DIVIDE_LIMIT : (uint32_t)ceil(divide);
    viewer->complete = !viewer->view.plain;
    viewer->report = *report;
}

void viewer_take_reply(struct viewer *viewer, const struct preview_reply *reply, double now) {
    if (viewer->halted && viewer->halted_at > 0)
        viewer_note_stop(viewer, now - viewer->halted_at);
    viewer->halted_at = 0;
    viewer->running = viewer->stopping = false;
    viewer->waiting = viewer->over_dirty = true;
    viewer->unbuilt = reply->unbuilt;
    switch (reply->kind) {
    case REPLY_BUILT:
        fly_camera_measure(&viewer->fly_camera, &reply->report.bounds);
        viewer->moved = true;
        viewer->built = reply->built;
        viewer->scene = *reply;
        viewer_take_lights(viewer, reply);
        return;
    case REPLY_PASS:
        end_pass(viewer, &reply->report, now);
        if (!reply->report.stopped && viewer->command.overlay.lines.limit > 0)
            viewer_take_overlay(viewer, &viewer->command.overlay, &reply->overlay);
        return;
    case REPLY_OVERLAY:
        viewer_take_overlay(viewer, &viewer->command.overlay, &reply->overlay);
        return;
    case REPLY_PICKED:
        viewer_take_picked(viewer, &reply->picked);
        viewer->command.overlay = viewer_overlay_request(viewer, false);
        viewer->command.overlay.lines.kind = OVERLAY_NONE;
        viewer_take_overlay(viewer, &viewer->command.overlay, &reply->overlay);
        return;
    case REPLY_CHANGED:
        if (!reply->unbuilt || reply->light_count > 0)
            viewer_take_lights(viewer, reply);
        if (reply->text[0] != '\0')
            viewer_show_message(viewer, reply->text);
        viewer->moved = true;
        viewer_invalidate_overlay(viewer);
        return;
    case REPLY_LIGHTS:
        viewer_take_lights(viewer, reply);
        return;
    case REPLY_PIXEL_TRACE:
        return;
    }
}

/* resume: the tiles that are done stay. */
static void begin_pass(struct viewer *viewer, uint32_t divide, bool plain, bool resume, double now) {
    if (!resume) {
        viewer->view = current_view(viewer, divide, plain);
        viewer->film = pass_film(&viewer->request, viewer->block, divide);
        viewer->edited = viewer->edits.now.count > 0 || is_different(viewer->request.exposure, viewer->script_exposure);
        memset(viewer->drawn, 0, viewer->tiles);
        if (viewer->film.marked)
            memset(viewer->film.marked, 0, (size_t)viewer->film.width * viewer->film.height);
    }
    for (uint32_t tile = 0; tile < film_tile_count(&viewer->film); tile++) {
        if (!resume || atomic_load(&viewer->film.tiles[tile]) != FILM_TILE_DONE)
            atomic_store(&viewer->film.tiles[tile], FILM_TILE_WANTED);
    }
    viewer->command = (struct preview_command){.kind = COMMAND_PASS, .view = viewer->view};
    if (viewer->moved)
        viewer_invalidate_overlay(viewer);
    if (plain && !resume && viewer_needs_overlay(viewer))
        viewer->command.overlay = viewer_overlay_request(viewer, viewer->moved);
    viewer->moved = viewer->complete = viewer->partial = false;
    viewer->running = true;
    viewer->pass_began = now;
}

/* The first of what the child has not been told yet. */
static void command_change(struct viewer *viewer) {
    struct change target = viewer->pending.items[0];
    const struct change *now = change_list_find(&viewer->edits.now, &target);
    (void)change_list_set(&viewer->pending, &target, false);
    bool light = target.kind == CHANGE_LIGHT || target.kind == CHANGE_DARK;
    viewer->command = (struct preview_command){.kind = COMMAND_CHANGE,
                                               .change = now ? *now : target,
                                               .present = now != NULL,
                                               .more = viewer->pending.count > 0,
                                               .first_light = light ? target.serial - 1 : 0};
}

static void command_pick(struct viewer *viewer) {
    viewer->asks = false;
    viewer->command = (struct preview_command){.kind = COMMAND_PICK,
                                               .view = current_view(viewer, 1, true),
                                               .x = viewer->asked.x,
                                               .y = viewer->asked.y,
                                               .up = viewer->asked.up};
}

static void command_pixel_trace(struct viewer *viewer) {
    viewer->wants_trace = false;
    viewer->trace_text[0] = '\0';
    viewer->trace_line = 0;
    viewer->command = (struct preview_command){.kind = COMMAND_PIXEL_TRACE,
                                               .view = current_view(viewer, 1, false),
                                               .x = viewer->trace_x,
                                               .y = viewer->trace_y};
}

static void command_overlay(struct viewer *viewer) {
    viewer->command = (struct preview_command){.kind = COMMAND_OVERLAY,
                                               .view = current_view(viewer, 1, true),
                                               .overlay = viewer_overlay_request(viewer, false)};
}

static enum viewer_action next_command(struct viewer *viewer, double now) {
    uint32_t divide = viewer->again ? FIRST_DIVIDE : viewer->divide;
    bool coarse = viewer->view.plain && viewer->view.divide > MIDDLE_DIVIDE && !viewer->halted;
    if (viewer->halted && viewer->unbuilt) /* what is asked now has no answer */
        viewer->asks = viewer->wants_trace = false;
    if (viewer->pending.count > 0 && !viewer->halted) {
        command_change(viewer);
    } else if (viewer->asks) {
        command_pick(viewer);
    } else if (viewer->wants_trace) {
        command_pixel_trace(viewer);
    } else if (!viewer->moved && !coarse && viewer_needs_overlay(viewer)) {
        command_overlay(viewer);
    } else if (viewer->halted) {
        return VIEWER_NOTHING;
    } else if (viewer->moved) {
        viewer->again = false;
        begin_pass(viewer, divide, true, false, now);
    } else if (viewer->lights_known < viewer->light_count) {
        viewer->command = (struct preview_command){.kind = COMMAND_LIGHTS, .first_light = viewer->lights_known};
    } else if (!viewer->view.plain && is_different(viewer->view.exposure, viewer->request.exposure)) {
        begin_pass(viewer, 1, false, false, now);
    } else if (viewer->partial) {
        begin_pass(viewer, 0, false, true, now);
    } else if (viewer->complete) {
        return VIEWER_NOTHING;
    } else if (viewer->view.divide > MIDDLE_DIVIDE) {
        begin_pass(viewer, MIDDLE_DIVIDE, true, false, now);
    } else {
        begin_pass(viewer, 1, false, false, now);
    }
    viewer->waiting = false;
    return VIEWER_SEND_COMMAND;
}

/* What can be done while the child works. */
static enum viewer_action step_running(struct viewer *viewer) {
    /* A coarse pass is over soon and is worth showing; a fine one is not. */
    bool coarse = viewer->view.plain && viewer->view.divide >= viewer->divide;
    if (viewer->halted && viewer->block && !viewer->stopping) {
        viewer->stopping = true;
        return VIEWER_STOP_PASS;
    }
    bool wanted = viewer->moved || (!coarse && viewer_needs_overlay(viewer)) || viewer->asks || viewer->wants_trace ||
                  viewer->pending.count > 0 || is_different(viewer->view.exposure, viewer->request.exposure);
    if (!viewer->running || !wanted || viewer->stopping || coarse)
        return VIEWER_NOTHING;
    viewer->stopping = true;
    return VIEWER_STOP_PASS;
}

/* The picture is written with the lines of the command line, which are there where people look at them. */
static bool lines_of_script(const struct viewer *viewer) {
    return viewer->request.overlay == OVERLAY_NONE || (viewer->overlay == (enum overlay)viewer->request.overlay &&
                                                       viewer->lines_fresh && viewer->has_lines && !viewer->moved);
}

enum viewer_action viewer_step(struct viewer *viewer, double now) {
    struct window_event event;
    double seconds = now - viewer->stepped;
    viewer->stepped = now;
    if (viewer->block && fly_camera_step(&viewer->fly_camera, seconds < 0.1 ? seconds : 0.1))
        viewer_change_view(viewer);
    while (viewer->action == VIEWER_NOTHING && !viewer->quit && viewer->driver->poll(viewer->driver->context, &event))
        viewer_take_event(viewer, &event);
    if (viewer->running)
        viewer_draw_tiles(viewer);
    viewer_show(viewer, now);
    enum viewer_action action = viewer->action;
    viewer->action = VIEWER_NOTHING;
    if (action != VIEWER_NOTHING)
        return action;
    if (viewer->logs_notes && viewer->note[0] != '\0')
        return VIEWER_LOG_NOTE;
    if (viewer->quit)
        return VIEWER_QUIT;
    if (viewer->complete && viewer->view.own && !viewer->edited && !viewer->written && lines_of_script(viewer)) {
        viewer->written = true;
        if (viewer->request.overlay != OVERLAY_NONE)
            overlay_lay(&viewer->film, viewer->lines);
        return VIEWER_WRITE_PICTURE;
    }
    if (viewer->waiting && viewer->next && viewer->written)
        return VIEWER_NEXT_PICTURE;
    return viewer->waiting ? next_command(viewer, now) : step_running(viewer);
}
