/* A second supervisor, in a process of its own, runs the script with the edits of the window before it. The window is
 * free meanwhile, and whatever ends that process leaves the old file or the new one. */
#define _GNU_SOURCE
#include "host/supervisor_export.h"

#include "base/clock.h"
#include "base/fault.h"
#include "host/supervisor_child.h"

#include <stdio.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

enum { EXPORT_TEXT = 1 << 16 }; /* bytes of its messages that are kept */

static void show(struct supervisor *supervisor, bool ok, const char *text) {
    output_say(&supervisor->output, ok ? LINE_NOTICE : LINE_ERROR, ok ? "gray: notice: %s" : "%s", text);
    viewer_show_notice(&supervisor->viewer, text, !ok);
}

static bool put_line(void *list, const char *line) {
    return list_add_bytes(list, line, strlen(line));
}

static bool note_edits(const struct viewer *viewer, struct list *out) {
    const struct camera camera = fly_camera_current(&viewer->fly_camera);
    return edits_write_lua(&viewer->edit.steps.now, viewer->request.file, viewer->camera_moved ? &camera : NULL, NULL,
                           put_line, out) &&
           list_add_bytes(out, "", 1);
}

/* The options of the other process: one script, and the picture or frame in the window. */
static struct options options_of(const struct supervisor *supervisor) {
    const struct viewer *viewer = &supervisor->viewer;
    struct options options = *supervisor->options;
    int last = options.script_count - 1;
    options.scripts += supervisor->next_script < last ? supervisor->next_script : last;
    options.picture = options.script_count == 1 ? (int)viewer->window.number : 0;
    options.script_count = 1;
    options.script.edits_text = supervisor->model.edits.items;
    options.model = supervisor->model.name;
    options.output = options.display = options.checkpoint = options.targets_prefix = options.first_pass_prefix = NULL;
    options.animation = ANIMATION_NONE;
    options.window = options.watch = options.resume = false;
    options.progress = PROGRESS_NONE;
    options.statistics = STATISTICS_NONE;
    uint32_t frame = viewer->request.frame.number;
    if (frame > 0) {
        options.script.frames.selection = (struct frame_selection){frame, frame, 1};
        options.picture = 0;
    }
    return options;
}

static _Noreturn void write_model(struct supervisor *supervisor, pid_t parent) {
    struct options options = options_of(supervisor);
    supervisor_leave(supervisor);
    (void)dup2(supervisor->model.text.descriptor, STDERR_FILENO);
    (void)syscall(SYS_close_range, STDERR_FILENO + 1, ~0U, 0);
    if (prctl(PR_SET_PDEATHSIG, SIGTERM) != 0 || getppid() != parent)
        _exit(ERROR_MACHINE);
    int status = supervisor_run(&options, &(struct program_parts){0});
    (void)fflush(NULL);
    _exit(status);
}

void supervisor_begin_export(struct supervisor *supervisor) {
    struct window_export *model = &supervisor->model;
    struct error error;
    if (model->process > 0 || supervisor->viewer.save_as[0] == '\0')
        return;
    if (!share_create(&model->text, EXPORT_TEXT, &error)) {
        show(supervisor, false, error.text);
        return;
    }
    bool noted = note_edits(&supervisor->viewer, &model->edits);
    (void)snprintf(model->name, sizeof model->name, "%s", supervisor->viewer.save_as);
    model->began = clock_now();
    model->shown = -1;
    (void)fflush(NULL);
    pid_t parent = getpid();
    model->process = noted ? MAY_FAIL(fork()) : -1;
    if (model->process == 0)
        write_model(supervisor, parent);
    list_destroy(&model->edits);
    if (model->process > 0)
        return;
    share_destroy(&model->text);
    show(supervisor, false, "the process that writes the model cannot be started");
}

/* The last line that is not part of a traceback. */
static const char *last_line(char *text) {
    const char *last = text;
    for (char *line = strtok(text, "\n"); line; line = strtok(NULL, "\n"))
        last = line[0] == ' ' ? last : line;
    return last;
}

void supervisor_show_export(struct supervisor *supervisor) {
    struct window_export *model = &supervisor->model;
    char line[NAME_LIMIT + 64], *text = model->text.block;
    int how = 0, seconds = (int)(clock_now() - model->began);
    if (model->process <= 0)
        return;
    if (waitpid(model->process, &how, WNOHANG) != model->process) {
        (void)snprintf(line, sizeof line, "%.400s is being made, %d s", model->name, seconds);
        if (seconds != model->shown)
            viewer_show_notice(&supervisor->viewer, line, false);
        model->shown = seconds;
        return;
    }
    bool ok = WIFEXITED(how) && WEXITSTATUS(how) == 0;
    text[EXPORT_TEXT - 1] = '\0';
    if (ok)
        (void)snprintf(line, sizeof line, "%s is written", model->name);
    else if (WIFEXITED(how) && text[0] != '\0')
        (void)snprintf(line, sizeof line, "%s", last_line(text));
    else
        (void)snprintf(line, sizeof line, "%s is not written: its process was ended", model->name);
    if (ok && text[0] != '\0')
        output_say(&supervisor->output, LINE_NOTICE, "%.*s", (int)strlen(text) - 1, text);
    show(supervisor, ok, line);
    share_destroy(&model->text);
    model->process = 0;
}

void supervisor_stop_export(struct supervisor *supervisor) {
    if (supervisor->model.process <= 0)
        return;
    (void)kill(supervisor->model.process, SIGTERM);
    (void)waitpid(supervisor->model.process, NULL, 0);
    share_destroy(&supervisor->model.text);
    supervisor->model.process = 0;
}
