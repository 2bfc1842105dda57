/* Answers to the render process. Invariant: files are written by this process alone, and only from a film that the
 * render process has declared complete. */
#include "host/supervisor_messages.h"

#include "host/supervisor_child.h"
#include "host/supervisor_device.h"
#include "host/supervisor_export.h"

#include "base/clock.h"
#include "base/mem.h"
#include "settings/setting.h"
#include "viewer/viewer_save.h"

#include <poll.h>
#include <string.h>

/* Seconds that a child has to end when the window is closed; closing must take less than 50 milliseconds. */
static const double patience_quit = 0.01;
/* Seconds for the scripts to end before they run again; afterwards the process is started again. */
static const double patience_again = 0.3;

/* Without its answer the child would wait for ever. If the child has ended, the end of the channel reports it. */
static void note_unsent(struct supervisor *supervisor) {
    struct pollfd peer = {.fd = supervisor->channel.descriptor};
    bool gone = poll(&peer, 1, 0) == 1 && (peer.revents & POLLHUP) != 0;
    supervisor->broken = supervisor->broken || !gone;
}

void supervisor_send_answer(struct supervisor *supervisor, enum message_kind kind, bool ok, bool already,
                            const struct error *error, int descriptor) {
    struct message_answer answer = {.ok = ok, .already = already};
    if (!ok)
        answer.error = *error;
    if (!channel_send(&supervisor->channel, kind, &answer, sizeof answer, descriptor))
        note_unsent(supervisor);
}

/* A request to stop a pass ends here; one to stop everything stays. To be called while the child waits for an answer: a
 * later request stops what the child does then. */
static void forget_stop(const struct supervisor *supervisor) {
    int stop = CANCEL_PASS;
    (void)atomic_compare_exchange_strong(&supervisor->control->cancel, &stop, CANCEL_NOTHING);
}

/* For a script that starts again: this picture is finished. If there is no memory for this note, the picture is
 * rendered again. */
static void settle(struct supervisor *supervisor, uint32_t number) {
    uint32_t room = supervisor->retry.settled_count;
    if (!supervisor->output.farm)
        return;
    if (number >= room) {
        uint32_t larger = 2 * number + 64;
        uint8_t *settled = mem_resize(supervisor->retry.settled, larger);
        if (!settled)
            return;
        memset(settled + room, 0, larger - room);
        supervisor->retry.settled = settled;
        supervisor->retry.settled_count = larger;
    }
    supervisor->retry.settled[number] = 1;
}

static bool is_settled(const struct supervisor *supervisor, uint32_t number) {
    return number < supervisor->retry.settled_count && supervisor->retry.settled[number];
}

static bool same_picture(const struct picture_request *a, const struct picture_request *b) {
    return a->full_width == b->full_width && a->full_height == b->full_height && a->x0 == b->x0 && a->y0 == b->y0 &&
           memcmp(&a->shown, &b->shown, sizeof a->shown) == 0 && a->width == b->width && a->height == b->height &&
           a->layers == b->layers && a->check == b->check && digest_equal(a->files, b->files) &&
           strcmp(a->file, b->file) == 0;
}

/* A script that starts again reaches its pictures again; the picture that was kept continues with its tiles. False: the
 * picture is rendered like any other. */
static bool answer_retry(struct supervisor *supervisor, const struct picture_request *request) {
    struct output_session *output = &supervisor->output;
    struct error error = {0};
    uint32_t number = output->pictures + 1;
    bool settled = is_settled(supervisor, number);
    if (!supervisor->retry.kept)
        return false;
    output->pictures = number;
    /* Pictures before the kept one are finished, or failed. */
    if (number < supervisor->retry.kept) {
        error_set(&error, ERROR_SCENE, "this picture failed before, too");
        supervisor_send_answer(supervisor, MESSAGE_FILM, settled, settled, &error, -1);
        return true;
    }
    /* A script may do something else the second time. */
    bool same = same_picture(request, &output->current.request);
    supervisor->retry.kept = 0;
    if (!same) {
        output_abandon(output);
        error_set(&error, ERROR_SCENE,
                  "started again after its render process was killed, the script renders a different picture");
    } else {
        progress_estimate_reset(&supervisor->control->progress_estimate,
                                output->progress.mode != PROGRESS_NONE && !output->farm);
    }
    supervisor_send_answer(supervisor, MESSAGE_FILM, same, false, &error,
                           same ? output->current.memory.descriptor : -1);
    return true;
}

static void answer_begin(struct supervisor *supervisor, const struct message *message) {
    struct output_session *output = &supervisor->output;
    if (answer_retry(supervisor, &message->body.request))
        return;
    struct error error = {0};
    unsigned number = output_number_of(output, &message->body.request);
    bool already = viewer_skips(&supervisor->viewer, number) || is_settled(supervisor, number);
    supervisor->script.frames = message->body.request.in_window ? 0 : supervisor->script.frames;
    bool ok = output_begin(output, &message->body.request, &already, &error);
    bool film = ok && !already && !message->body.request.check;
    if (ok && already)
        settle(supervisor, output->pictures);
    const struct viewer_picture picture = {&output->current.request, output->current.memory.block,
                                           output->current.name};
    supervisor->viewer.window.number = film ? output->pictures : supervisor->viewer.window.number;
    if (film && supervisor->window &&
        !viewer_begin(&supervisor->viewer, supervisor->window, &picture, clock_now(), &error)) {
        output_abandon(output);
        film = ok = false;
    }
    forget_stop(supervisor);
    supervisor_send_answer(supervisor, MESSAGE_FILM, ok, already, &error,
                           film ? output->current.memory.descriptor : -1);
}

static void send_command(struct supervisor *supervisor, const struct preview_command *command) {
    if (supervisor->viewer.pass.state == PASS_WAITING) /* END: it was not the viewer that decided */
        supervisor->viewer.pass.state = PASS_BUSY;
    forget_stop(supervisor);
    bool large = command->kind == COMMAND_PASS && command->view.width > 0;
    if (!channel_send(&supervisor->channel, MESSAGE_PREVIEW_COMMAND, command, sizeof *command,
                      large ? supervisor->viewer.window.large.memory.descriptor : -1))
        note_unsent(supervisor);
}

static void end_picture(struct supervisor *supervisor, bool quit) {
    const struct preview_command command = {.kind = COMMAND_END, .quit = quit};
    send_command(supervisor, &command);
}

/* A picture that is not written yet is interrupted as by Ctrl-C. */
static void quit_window(struct supervisor *supervisor) {
    supervisor->ended = true;
    supervisor->quit_at = clock_now();
    if (supervisor->deadline > 0 || supervisor->waits)
        return;
    supervisor->stop = true;
    supervisor->deadline = clock_now() + patience_quit;
    atomic_store(&supervisor->control->cancel, CANCEL_ALL);
    if (!supervisor->viewer.written)
        supervisor_note_status(supervisor, ERROR_CANCELLED);
    if (supervisor->viewer.pass.state == PASS_WAITING)
        end_picture(supervisor, true);
}

/* The scripts are ended, to run again: what they read has changed. */
void supervisor_restart(struct supervisor *supervisor) {
    if (supervisor->deadline > 0)
        return;
    supervisor->stop = supervisor->restarts = true;
    supervisor->deadline = clock_now() + patience_again;
    atomic_store(&supervisor->control->cancel, CANCEL_ALL);
    viewer_keep(&supervisor->viewer);
    atomic_store(&supervisor->control->next_frame, viewer_next_frame(&supervisor->viewer));
    if (supervisor->viewer.pass.state == PASS_WAITING)
        end_picture(supervisor, true);
}

/* The scripts end, and the window stays. */
static void end_scripts(struct supervisor *supervisor) {
    if (supervisor->deadline > 0)
        return;
    supervisor->stop = true;
    supervisor->deadline = clock_now() + patience_again;
    atomic_store(&supervisor->control->cancel, CANCEL_ALL);
}

/* As if its option were given from now on: another child runs the scripts. */
static void change_setting(struct supervisor *supervisor, const struct viewer_setting *change) {
    setting_store(&setting_table[change->index], &supervisor->own_options->settings, change->number);
    supervisor->given[change->index] = "";
    supervisor->options_differ = true;
    supervisor_restart(supervisor);
}

/* ok: a file with that name was written. */
static void show_written(struct supervisor *supervisor, bool ok, const char *name, const struct error *error) {
    char line[NAME_LIMIT + 64];
    (void)snprintf(line, sizeof line, ok ? "%s is written" : "%s", ok ? name : error->text);
    viewer_show_notice(&supervisor->viewer, line, !ok);
}

static bool save_from_window(struct supervisor *supervisor,
                             bool (*take)(const struct viewer *viewer, const struct file_target *picture, char *name,
                                          struct error *error)) {
    struct error error;
    char name[NAME_LIMIT];
    const struct file_target picture = {.path = supervisor->viewer.name, .rules = &supervisor->output.files.saved};
    bool ok = take(&supervisor->viewer, &picture, name, &error);
    output_say(&supervisor->output, ok ? LINE_NOTICE : LINE_ERROR, ok ? "gray: notice: %s is written" : "%s",
               ok ? name : error.text);
    show_written(supervisor, ok, name, &error);
    return ok;
}

/* The script's picture, under its name. */
static void write_from_window(struct supervisor *supervisor) {
    struct error error;
    bool ok = output_write(&supervisor->output, &error);
    if (!ok && error.kind != ERROR_CANCELLED)
        supervisor_note_error(supervisor, &error);
    show_written(supervisor, ok, supervisor->viewer.name, &error);
}

void supervisor_open_window(struct supervisor *supervisor) {
    const struct options *options = supervisor->options;
    const char *script =
        options->scripts[supervisor->next_script < options->script_count ? supervisor->next_script : 0];
    struct error ignored; /* the first picture tries again, and reports the error */
    if (!supervisor->window || supervisor->viewer.window.open || supervisor->deadline > 0 || supervisor->early_refused)
        return;
    supervisor->early_refused =
        !viewer_open(&supervisor->viewer, supervisor->window, script, options->width ? (uint32_t)options->width : 640,
                     options->height ? (uint32_t)options->height : 480, &ignored);
}

void supervisor_step_window(struct supervisor *supervisor) {
    if (!supervisor->waits)
        supervisor_open_window(supervisor);
    supervisor->viewer.window.waits = supervisor->waits;
    supervisor_show_export(supervisor);
    struct viewer *viewer = &supervisor->viewer;
    int nothing = CANCEL_NOTHING;
    if (viewer->player.seeking) /* it may have changed */
        atomic_store(&supervisor->control->next_frame, viewer_next_frame(viewer));
    while (viewer->window.open && supervisor->deadline <= 0) {
        switch (viewer_step(viewer, clock_now())) {
        case VIEWER_NOTHING:
            return;
        case VIEWER_STOP_PASS:
            (void)atomic_compare_exchange_strong(&supervisor->control->cancel, &nothing, CANCEL_PASS);
            return;
        case VIEWER_SEND_COMMAND:
            send_command(supervisor, &viewer->command);
            break;
        case VIEWER_WRITE_PICTURE:
            write_from_window(supervisor);
            break;
        case VIEWER_SAVE_IMAGE:
            (void)save_from_window(supervisor, viewer_save_image);
            break;
        case VIEWER_SAVE_CAMERA:
            (void)save_from_window(supervisor, viewer_save_camera);
            break;
        case VIEWER_SAVE_EDITS:
            if (save_from_window(supervisor, viewer_save_edits))
                viewer->edit.saved_at = viewer->edit.steps.at;
            break;
        case VIEWER_EXPORT_MODEL:
            supervisor_begin_export(supervisor);
            break;
        case VIEWER_CHANGE_SETTING:
            change_setting(supervisor, &viewer->setting);
            return;
        case VIEWER_RUN_AGAIN:
            supervisor_restart(supervisor);
            return;
        case VIEWER_END_SCRIPTS:
            end_scripts(supervisor);
            return;
        case VIEWER_LOG_NOTE:
            output_report(&supervisor->output, LINE_DETAIL, viewer->note);
            viewer->note[0] = '\0';
            break;
        case VIEWER_NEXT_FRAME:
        case VIEWER_NEXT_PICTURE:
            atomic_store(&supervisor->control->next_frame, viewer_next_frame(viewer));
            end_picture(supervisor, false);
            return;
        case VIEWER_QUIT:
            quit_window(supervisor);
            return;
        }
    }
}

static void answer_done(struct supervisor *supervisor, const struct message *message) {
    struct error error = {0};
    struct picture_report report = message->body.report;
    viewer_detach(&supervisor->viewer);
    report.rays.device = supervisor_device_statistics(supervisor);
    bool ok = output_done(&supervisor->output, &report, &error);
    if (ok)
        settle(supervisor, supervisor->output.pictures);
    if (supervisor->finishing) { /* the tiles in progress were the last ones: the picture is complete */
        supervisor->deadline = clock_now() + supervisor_patience;
        atomic_store(&supervisor->control->cancel, CANCEL_ALL);
    }
    supervisor_send_answer(supervisor, MESSAGE_ANSWER, ok, false, &error, -1);
}

/* The time of the script stands still from the first request until the end. */
static void answer_model(struct supervisor *supervisor, const struct model_request *request) {
    struct output_session *output = &supervisor->output;
    struct error error = {0};
    supervisor_stop_script_clock(supervisor);
    bool ok = output_begin_model(output, request, &error);
    supervisor_send_answer(supervisor, MESSAGE_FILM, ok, false, &error,
                           output->model.memory.block ? output->model.memory.descriptor : -1);
}

static void write_model(struct supervisor *supervisor) {
    struct output_session *output = &supervisor->output;
    struct error error = {0};
    bool ok = output->interrupted ? error_set(&error, ERROR_CANCELLED, "%.600s: interrupted", output->model.name)
                                  : model_output_write(&output->model, &output->files, &error);
    supervisor_send_answer(supervisor, MESSAGE_ANSWER, ok, false, &error, -1);
}

/* A script that was started again has ended before it reached its picture again. */
static void drop_kept(struct supervisor *supervisor, const struct message_script *script) {
    struct error error;
    error_set(&error, ERROR_SCENE,
              "%.400s: started again after its render process was killed, the script did not render %.400s, which is "
              "not written",
              supervisor->options->scripts[script->index], supervisor->output.current.name);
    output_abandon(&supervisor->output);
    supervisor->retry.kept = 0;
    supervisor_note_error(supervisor, &error);
}

static void note_script(struct supervisor *supervisor, const struct message_script *script) {
    static const int known[] = {0, ERROR_SCENE, ERROR_USAGE, ERROR_MACHINE, ERROR_CANCELLED};
    bool sound = script->index == supervisor->next_script && script->index < supervisor->options->script_count;
    bool is_known = false;
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        is_known = is_known || script->status == known[i];
    if (!sound || !is_known) {
        supervisor->broken = true;
        return;
    }
    supervisor->next_script++;
    supervisor->script.used = 0;
    supervisor->script.frames = 0;
    supervisor->retry.count = 0;
    supervisor->retry.pictures_before = supervisor->output.pictures;
    if (supervisor->retry.kept)
        drop_kept(supervisor, script);
    supervisor_start_script_clock(supervisor);
    supervisor->stop = supervisor->stop || script->status == ERROR_USAGE || script->status == ERROR_CANCELLED;
    /* What a request to stop means was noted when it came. */
    if (supervisor->deadline <= 0)
        supervisor_note_status(supervisor, script->status);
}

static void note_read(struct supervisor *supervisor, const struct message_read *read) {
    struct error error;
    picture_files_keep(&supervisor->output.files, read->version.identity, read->written);
    if (read->written)
        return;
    if (supervisor->watch.open && !watch_add(&supervisor->watch, read->path, &read->version, clock_now())) {
        (void)error_no_memory(&error, "the list of files that are watched");
        supervisor_note_error(supervisor, &error);
    }
}

/* A message out of turn (a second picture before the first is finished ...) is not answered: it breaks the protocol. */
void supervisor_handle_message(struct supervisor *supervisor, const struct message *message) {
    struct output_session *output = &supervisor->output;
    const struct picture *current = &output->current;
    struct preview_reply reply;
    struct error ignored;
    switch (message->kind) {
    case MESSAGE_LINE:
        supervisor_report(supervisor, message->body.line.kind, message->body.line.text);
        error_stream_note_handled(&supervisor->control->error_stream);
        return;
    case MESSAGE_BEGIN:
        if (current->open && !supervisor->retry.kept)
            break;
        supervisor_stop_script_clock(supervisor);
        answer_begin(supervisor, message);
        if (!current->open || supervisor->retry.kept)
            supervisor_start_script_clock(supervisor);
        return;
    case MESSAGE_DONE:
        if (!current->open || supervisor->retry.kept || current->request.check || supervisor->deadline > 0)
            break;
        supervisor_start_script_clock(supervisor);
        answer_done(supervisor, message);
        return;
    case MESSAGE_PREVIEW_REPLY:
        if (!current->open || !supervisor->window || supervisor->viewer.pass.state == PASS_WAITING ||
            !preview_reply_read(message, &reply))
            break;
        viewer_receive_reply(&supervisor->viewer, &reply, clock_now());
        if (supervisor->deadline > 0)
            end_picture(supervisor, true);
        return;
    case MESSAGE_ABANDON:
        if (!current->open || supervisor->retry.kept)
            break;
        supervisor_abandon_picture(supervisor);
        supervisor_start_script_clock(supervisor);
        return;
    case MESSAGE_MODEL:
        if ((current->open && message->body.model.role != MODEL_SOLUTION) || output->model.memory.block)
            break;
        answer_model(supervisor, &message->body.model);
        return;
    case MESSAGE_MODEL_WRITE:
        if (!output->model.memory.block || supervisor->deadline > 0)
            break;
        write_model(supervisor);
        return;
    case MESSAGE_MODEL_END:
        model_output_forget(&output->model);
        if (!current->open)
            supervisor_start_script_clock(supervisor);
        return;
    case MESSAGE_DEVICE: /* first for the scene, then for its orders */
        if (!current->open || supervisor->options->device == DEVICE_CPU ||
            (message->body.device.size == 0 && !supervisor->device.asked))
            break;
        supervisor_answer_device(supervisor, &message->body.device);
        return;
    case MESSAGE_SCRIPT:
        note_script(supervisor, &message->body.script);
        return;
    case MESSAGE_READ:
        note_read(supervisor, &message->body.read);
        return;
    case MESSAGE_FRAME: /* a script that announces more frames than allowed could avoid the time limit */
        if (current->open || !options_allow_picture(supervisor->options, ++supervisor->script.frames, &ignored))
            break;
        supervisor_stop_script_clock(supervisor);
        supervisor->script.used = 0;
        supervisor_start_script_clock(supervisor);
        return;
    case MESSAGE_AGAIN:
        if (!supervisor->watch.open || current->open)
            break;
        supervisor_stop_script_clock(supervisor);
        supervisor->waits = true;
        return;
    case MESSAGE_FILM:
    case MESSAGE_ANSWER:
    case MESSAGE_PREVIEW_COMMAND:
    case MESSAGE_WINDOW:
        break;
    }
    supervisor->broken = true;
}
