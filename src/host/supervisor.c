/* One render process runs all scripts, so that files read by one script can be used by the next. When it dies, a new
 * one continues with the next script. */
#include "host/supervisor_internal.h"

#include "base/clock.h"
#include "base/mem.h"
#include "host/supervisor_child.h"
#include "host/supervisor_device.h"
#include "host/supervisor_export.h"
#include "host/supervisor_messages.h"
#include "host/supervisor_signals.h"
#include "session/text.h"
#include "settings/setting.h"

#include <errno.h>
#include <poll.h>
#include <string.h>
#include <unistd.h>

void supervisor_note_status(struct supervisor *supervisor, int status) {
    if (status > supervisor->status)
        supervisor->status = status;
}

/* In the terminal; errors also in the window. */
void supervisor_report(struct supervisor *supervisor, enum line_kind kind, const char *text) {
    output_report(&supervisor->output, kind, text);
    if (kind == LINE_ERROR)
        viewer_show_message(&supervisor->viewer, text);
    if (kind == LINE_OUTPUT)
        viewer_add_pixel_trace(&supervisor->viewer, text);
}

void supervisor_note_error(struct supervisor *supervisor, const struct error *error) {
    supervisor_report(supervisor, LINE_ERROR, error->text);
    supervisor_note_status(supervisor, (int)error->kind);
}

/* What happened to ranks. */
static void show_notes(struct supervisor *supervisor) {
    char line[2048];
    while (supervisor->output.farm && farm_next_note(supervisor->output.farm, line, sizeof line))
        output_report(&supervisor->output, LINE_WARNING, line);
}

/* Another rank ends with the first one. */
static void leave_abandoned(struct supervisor *supervisor) {
    if (!supervisor->output.farm || supervisor->ended || !farm_is_abandoned(supervisor->output.farm))
        return;
    text_print_line(standard_error(), "gray: the first rank of the farm has been silent for too long, this one ends");
    supervisor_interrupt(supervisor);
    supervisor_note_status(supervisor, ERROR_CANCELLED);
}

/* That becomes readable with an event of the window, or -1. */
static int window_descriptor(const struct supervisor *supervisor) {
    const struct window_driver *window = supervisor->window;
    return window ? window->descriptor(window->context) : -1;
}

/* Milliseconds between two looks at the window. */
static int window_patience(const struct supervisor *supervisor) {
    return window_descriptor(supervisor) >= 0 && viewer_rests(&supervisor->viewer) ? 250 : 4;
}

/* Milliseconds to wait for the next message at most; -1: until it comes. */
static int poll_time(const struct supervisor *supervisor) {
    if (supervisor->output.farm)
        return 2;
    if (supervisor->window)
        return window_patience(supervisor);
    if (supervisor->deadline > 0)
        return 5;
    if (supervisor->output.current.open || supervisor->watch.open)
        return 50;
    int patience = supervisor_script_patience(supervisor);
    bool reports = supervisor->script.runs && supervisor->output.progress.mode == PROGRESS_BAR;
    return reports && (patience < 0 || patience > 500) ? 500 : patience;
}

/* Reports that a script is still running. */
static void report_script(struct supervisor *supervisor) {
    const struct options *options = supervisor->options;
    char line[4096 + 128];
    bool runs = supervisor->script.runs && supervisor->next_script < options->script_count && !supervisor->window &&
                !supervisor->output.current.open;
    const char *script = runs ? options->scripts[supervisor->next_script] : "";
    if (progress_script_line(&supervisor->output.progress, script, runs, line, sizeof line))
        output_report(&supervisor->output, LINE_NOTICE, line);
}

static bool files_changed(struct supervisor *supervisor) {
    if (!supervisor->watch.open)
        return false;
    watch_read(&supervisor->watch, clock_now());
    return watch_changed(&supervisor->watch, clock_now());
}

/* Runs until the child closes the channel, or waits for changes. */
static void talk_to_child(struct supervisor *supervisor) {
    struct message message;
    while (!supervisor->broken) {
        struct pollfd watched[3] = {{.fd = supervisor->channel.descriptor, .events = POLLIN},
                                    {.fd = supervisor->signals, .events = POLLIN},
                                    {.fd = window_descriptor(supervisor), .events = POLLIN}};
        if (poll(watched, 3, poll_time(supervisor)) < 0 && errno != EINTR)
            break;
        /* A child that is beyond its limits is killed, unless it is ending anyway. */
        if (supervisor_script_patience(supervisor) == 0) {
            supervisor->script.out_of_time = supervisor->deadline == 0;
            break;
        }
        if (supervisor_child_is_stalled(supervisor)) {
            supervisor->stall.found = supervisor->deadline == 0;
            break;
        }
        if (watched[1].revents)
            supervisor_read_signals(supervisor);
        leave_abandoned(supervisor);
        if (supervisor->output.current.open)
            supervisor_watch_device(supervisor);
        else
            supervisor_end_device(supervisor);
        if (supervisor->deadline > 0 && clock_now() > supervisor->deadline)
            break;
        /* What the user sees goes on whether or not the child reports something. */
        output_show_progress(&supervisor->output);
        report_script(supervisor);
        show_notes(supervisor);
        supervisor_step_window(supervisor);
        if (files_changed(supervisor) && !viewer_delays_change(&supervisor->viewer, clock_now()))
            supervisor_restart(supervisor);
        if (!watched[0].revents)
            continue;
        /* One message at a time, so that signals and the window wait for no more than that. */
        enum channel_result result = channel_receive(&supervisor->channel, &message);
        if (result == CHANNEL_END)
            return;
        if (result == CHANNEL_MESSAGE)
            supervisor_handle_message(supervisor, &message);
        else
            supervisor->broken = true;
        if (supervisor->waits)
            return;
        if (result == CHANNEL_MESSAGE && message.kind == MESSAGE_PREVIEW_REPLY) /* the child waits for a command */
            supervisor_step_window(supervisor);
    }
    (void)kill(supervisor->child, SIGKILL);
}

/* An existing child continues; without one, a new one is started. */
static void run_children(struct supervisor *supervisor) {
    struct error error;
    supervisor->viewer.window.script_began = clock_now();
    bool there = supervisor->child > 0;
    while (supervisor->next_script < supervisor->options->script_count && !supervisor->stop) {
        supervisor->broken = false;
        if (!there && !supervisor_start_child(supervisor, &error)) {
            supervisor_note_error(supervisor, &error);
            output_abandon(&supervisor->output);
            supervisor->retry.kept = 0;
            return;
        }
        talk_to_child(supervisor);
        if (supervisor->waits)
            return;
        supervisor_end_device(supervisor);
        channel_close(&supervisor->channel); /* a child that waits for an answer ends */
        int how = supervisor_reap_child(supervisor);
        there = false;
        supervisor->child = 0;
        supervisor_judge_end(supervisor, how);
    }
}

/* Between two runs: nothing is rendered, the window shows the last good picture. True when something has changed. */
static bool wait_for_change(struct supervisor *supervisor) {
    supervisor->waits = true;
    watch_settle(&supervisor->watch, supervisor->status != 0, clock_now());
    if (!supervisor->window && !supervisor->restarts)
        output_report(&supervisor->output, LINE_NOTICE, "gray: notice: waiting for changes (Ctrl-C ends)");
    supervisor->stop = false;
    supervisor->deadline = 0;
    if (supervisor->status != 0)
        supervisor_open_window(supervisor); /* for the error */
    while (!supervisor->ended && !supervisor->restarts) {
        struct pollfd watched[3] = {{.fd = supervisor->watch.descriptor, .events = POLLIN},
                                    {.fd = supervisor->signals, .events = POLLIN},
                                    {.fd = window_descriptor(supervisor), .events = POLLIN}};
        /* Not at once: a file that was read while it was being written is checked again. */
        int patience = supervisor->window ? window_patience(supervisor) : 500;
        (void)poll(watched, 3, patience > 20 && supervisor->watch.last > 0 ? 20 : patience);
        if (watched[1].revents)
            supervisor_read_signals(supervisor);
        supervisor_step_window(supervisor);
        if (files_changed(supervisor) && !viewer_delays_change(&supervisor->viewer, clock_now()))
            break;
    }
    return !supervisor->ended;
}

/* The child runs the scripts again, or ends if a mesh or image that it may have kept has changed. */
static void answer_again(struct supervisor *supervisor, bool again) {
    const struct error none = {0};
    if (supervisor->child <= 0)
        return;
    supervisor_send_answer(supervisor, MESSAGE_ANSWER, again, false, &none, -1);
    if (again) {
        supervisor_start_script_clock(supervisor);
        return;
    }
    (void)supervisor_reap_child(supervisor);
    supervisor->child = 0;
    channel_close(&supervisor->channel);
}

static bool watch_scripts(struct supervisor *supervisor, struct error *error) {
    if (!watch_open(&supervisor->watch, error))
        return false;
    for (int i = 0; i < supervisor->options->script_count; i++) {
        if (!watch_add(&supervisor->watch, supervisor->options->scripts[i], NULL, clock_now()))
            return error_no_memory(error, "the list of files that are watched");
    }
    return true;
}

/* Every run has its own status; the last one is the status of the program. */
static void run_and_watch(struct supervisor *supervisor) {
    struct error error;
    run_children(supervisor);
    while (supervisor->watch.open && !supervisor->ended) {
        if (!supervisor->restarts &&
            (!output_write_held(&supervisor->output, &error) ||
             (supervisor->status == 0 && !output_assemble(&supervisor->output, &error))) &&
            error.kind != ERROR_CANCELLED)
            supervisor_note_error(supervisor, &error);
        if (!wait_for_change(supervisor))
            break;
        /* Everything that counts for one run begins again. */
        supervisor->watch.any = false;
        viewer_keep(&supervisor->viewer);
        atomic_store(&supervisor->control->next_frame, viewer_next_frame(&supervisor->viewer));
        output_restart(&supervisor->output);
        supervisor->restarts = supervisor->waits = supervisor->stop = false;
        supervisor->deadline = 0;
        supervisor->status = supervisor->next_script = 0;
        supervisor->script.used = 0;
        supervisor->script.frames = 0;
        atomic_store(&supervisor->control->cancel, CANCEL_NOTHING);
        answer_again(supervisor, !supervisor->watch.assets_differ && !supervisor->options_differ);
        supervisor->options_differ = false;
        run_children(supervisor);
    }
    supervisor->waits = false;
    answer_again(supervisor, false);
}

/* Called while the farm waits for other ranks. */
static void poll_in_farm(void *context) {
    struct supervisor *supervisor = context;
    supervisor_read_signals(supervisor);
    show_notes(supervisor);
}

static void report_foreign_line(void *context, const char *line) {
    struct supervisor *supervisor = context;
    output_report(&supervisor->output, LINE_WARNING, line);
}

static bool start_farm(struct supervisor *supervisor, const struct farm_transport *transport, struct error *error) {
    long processors = sysconf(_SC_NPROCESSORS_ONLN);
    uint32_t threads = (uint32_t)(supervisor->options->threads ? supervisor->options->threads : processors);
    if (!transport)
        return true;
    supervisor->output.farm =
        farm_create(transport, 2 * threads, supervisor->options->farm_silence, supervisor->control);
    if (!supervisor->output.farm)
        return error_no_memory(error, "the farm");
    atomic_store(&supervisor->control->error_stream.mute, transport->rank > 0);
    farm_set_poll(supervisor->output.farm, poll_in_farm, supervisor);
    return true;
}

/* The first rank waits until the others have ended, after everything is written. It also determines the status: an
 * error only on another rank is a line, not a status. */
static void end_farm(struct supervisor *supervisor) {
    struct farm *farm = supervisor->output.farm;
    if (!farm)
        return;
    bool interrupted = supervisor->ended && supervisor->status == ERROR_CANCELLED;
    supervisor->all_written = true;
    if (!farm_is_first(farm) && !interrupted)
        supervisor->status = 0;
    farm_finish(farm, supervisor->status == 0, report_foreign_line, supervisor);
    leave_abandoned(supervisor);
    show_notes(supervisor);
    farm_destroy(farm);
    supervisor->output.farm = NULL;
    mem_free(supervisor->retry.settled);
    supervisor->retry.settled = NULL;
}

static int run(struct supervisor *supervisor, const struct farm_transport *transport) {
    const struct options *options = supervisor->options;
    struct error error;
    supervisor->control = mem_share(sizeof *supervisor->control);
    supervisor->viewer.window.control = supervisor->control;
    supervisor->viewer.window.logs_notes = options->verbose;
    supervisor->viewer.window.sends_memory = true;
    supervisor->viewer.window.frames = options->script.frames.selection;
    output_init(&supervisor->output, options, supervisor->control);
    supervisor->output.wait_for_text = supervisor_wait_for_reader;
    supervisor->output.wait_context = supervisor;
    /* Errors before the first child are reported like those of a script. */
    bool ready = supervisor->control
                     ? supervisor_listen(supervisor, &error) && start_farm(supervisor, transport, &error) &&
                           (!options->watch || watch_scripts(supervisor, &error))
                     : error_no_memory(&error, "the render process");
    if (ready)
        standard_streams_begin(&supervisor->streams);
    output_set_interrupt(&supervisor->output,
                         &(struct file_interrupt){supervisor->signals, supervisor_is_stopped, supervisor});
    output_warn_no_sandbox(&supervisor->output);
    if (ready)
        run_and_watch(supervisor);
    else
        supervisor_note_error(supervisor, &error);
    /* The window closes first: writing files may take long. */
    viewer_end(&supervisor->viewer);
    supervisor_stop_export(supervisor);
    if (supervisor->quit_at > 0)
        output_say(&supervisor->output, LINE_DETAIL, "gray: the window closed in %.1f ms",
                   1000 * (clock_now() - supervisor->quit_at));
    watch_close(&supervisor->watch);
    if (!output_finish(&supervisor->output, supervisor->status == 0, &error) && error.kind != ERROR_CANCELLED)
        supervisor_note_error(supervisor, &error);
    if (!output_flush_streams(&supervisor->output, &error))
        supervisor_note_error(supervisor, &error);
    end_farm(supervisor);
    standard_streams_end();
    if (supervisor->signals >= 0)
        (void)close(supervisor->signals);
    mem_unshare(supervisor->control, sizeof *supervisor->control);
    return supervisor->status;
}

/* Not on the stack, which may be small. */
int supervisor_run(const struct options *options, const struct program_parts *parts) {
    struct supervisor *supervisor = mem_alloc_zero(1, sizeof *supervisor);
    struct options own = *options;
    const char **given = mem_alloc_zero((size_t)setting_count, sizeof *given);
    if (!supervisor || !given) {
        (void)fputs("gray: out of memory\n", stderr);
        mem_free(supervisor);
        mem_free(given);
        return ERROR_MACHINE;
    }
    for (int i = 0; options->script.given && i < setting_count; i++)
        given[i] = options->script.given[i];
    own.script.given = supervisor->given = given;
    supervisor->options = supervisor->own_options = &own;
    supervisor->window = parts->window;
    supervisor->signals = supervisor->channel.descriptor = -1;
    int status = run(supervisor, parts->transport);
    mem_free(supervisor);
    mem_free(given);
    return status;
}
