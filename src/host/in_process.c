/* The services of the child, answered on the spot by the desk: no channel, no second process. */
#include "host/in_process.h"

#include "base/mem.h"
#include "host/render_process.h"
#include "output/output_session.h"

#include <signal.h>
#include <stdio.h>

struct alone {
    struct desk desk;
    int status;
};

static bool alone_begin(void *context, const struct picture_request *request, struct film *film, bool *already,
                        struct error *error) {
    struct alone *alone = context;
    if (!desk_begin(&alone->desk, request, already, error))
        return false;
    *film = alone->desk.current.film;
    return true;
}

static void alone_abandon(void *context) {
    struct alone *alone = context;
    desk_abandon(&alone->desk);
}

static bool alone_done(void *context, const struct picture_report *report, struct error *error) {
    struct alone *alone = context;
    return desk_done(&alone->desk, report, error);
}

static void alone_line(void *context, enum line_kind kind, const char *text) {
    struct alone *alone = context;
    desk_line(&alone->desk, kind, text);
}

static void alone_script_ended(void *context, int index, int status) {
    struct alone *alone = context;
    (void)index;
    if (status > alone->status)
        alone->status = status;
}

static void alone_read(void *context, const char *path, const struct file_version *version, bool written) {
    struct alone *alone = context;
    (void)path;
    picture_files_keep(&alone->desk.files, version->identity, written);
}

static void alone_poll(void *context) {
    struct alone *alone = context;
    desk_show_progress(&alone->desk);
}

struct scripts {
    const struct options *options;
    const struct child_services *services;
};

static void run_scripts(void *context) {
    const struct scripts *scripts = context;
    child_run(scripts->options, scripts->services, 0);
}

static void note_failure(struct alone *alone, const struct error *error) {
    desk_line(&alone->desk, LINE_ERROR, error->text);
    alone_script_ended(alone, 0, (int)error->kind);
}

static int run(struct alone *alone, const struct options *options) {
    struct control control = {0};
    struct error error;
    struct child_services services = {.context = alone,
                                      .control = &control,
                                      .begin = alone_begin,
                                      .abandon = alone_abandon,
                                      .done = alone_done,
                                      .line = alone_line,
                                      .script_ended = alone_script_ended,
                                      .read = alone_read,
                                      .poll = alone_poll};
    struct scripts scripts = {options, &services};
    (void)signal(SIGPIPE, SIG_IGN);
    (void)signal(SIGXFSZ, SIG_IGN);
    desk_init(&alone->desk, options, &control);
    desk_tell_trust(&alone->desk);
    if (!options->script.no_sandbox)
        desk_line(&alone->desk, LINE_WARNING,
                  "gray: warning: --no-fork: no Landlock, no seccomp filter: confined by checks of file names");
    if (!pool_call_with_stack(run_scripts, &scripts, &error))
        note_failure(alone, &error);
    if (!desk_finish(&alone->desk, alone->status == 0, &error))
        note_failure(alone, &error);
    if (!desk_finish_output(&alone->desk, &error))
        note_failure(alone, &error);
    return alone->status;
}

/* Not on the stack: that may be a small one. */
int alone_run(const struct options *options) {
    struct alone *alone = mem_alloc_zero(1, sizeof *alone);
    if (!alone) {
        (void)fputs("gray: out of memory\n", stderr);
        return ERROR_MACHINE;
    }
    int status = run(alone, options);
    mem_free(alone);
    return status;
}
