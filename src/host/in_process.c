/* The services of the render process, called directly in the output session: no channel, no second process. */
#include "host/in_process.h"

#include "base/mem.h"
#include "formats/list.h"
#include "host/render_process.h"
#include "output/output_session.h"

#include <signal.h>
#include <stdio.h>
#include <string.h>

struct in_process {
    struct output_session output;
    int status;
};

static bool in_process_begin(void *context, const struct picture_request *request, struct film *film, bool *already,
                             struct error *error) {
    struct in_process *in_process = context;
    if (!output_begin(&in_process->output, request, already, error))
        return false;
    *film = in_process->output.current.film;
    return true;
}

static void in_process_abandon(void *context) {
    struct in_process *in_process = context;
    output_abandon(&in_process->output);
}

static bool in_process_done(void *context, const struct picture_report *report, bool early, struct error *error) {
    struct in_process *in_process = context;
    (void)early;
    return output_done(&in_process->output, report, error);
}

static bool in_process_model(void *context, const struct model_request *request, const void *bytes,
                             struct error *error) {
    struct in_process *in_process = context;
    struct output_session *output = &in_process->output;
    if (!output_begin_model(output, request, error))
        return false;
    if (!bytes)
        return true;
    memcpy(output->model.memory.block, bytes, request->size);
    return model_output_write(&output->model, &output->files, error);
}

static bool in_process_solution(void *context, const struct model_request *request, struct list *bytes,
                                struct error *error) {
    struct in_process *in_process = context;
    struct model_output *model = &in_process->output.model;
    return in_process_model(context, request, NULL, error) &&
           (!model->memory.block || list_add_bytes(bytes, model->memory.block, model->memory.size) ||
            error_no_memory(error, "radiosity"));
}

static void in_process_model_end(void *context) {
    struct in_process *in_process = context;
    model_output_forget(&in_process->output.model);
}

static void in_process_line(void *context, enum line_kind kind, const char *text) {
    struct in_process *in_process = context;
    output_report(&in_process->output, kind, text);
}

static void in_process_script_ended(void *context, int index, int status) {
    struct in_process *in_process = context;
    (void)index;
    if (status > in_process->status)
        in_process->status = status;
}

static void in_process_read(void *context, const char *path, const struct file_version *version, bool written) {
    struct in_process *in_process = context;
    (void)path;
    picture_files_keep(&in_process->output.files, version->identity, written);
}

static void in_process_poll(void *context) {
    struct in_process *in_process = context;
    output_show_progress(&in_process->output);
}

struct scripts {
    const struct options *options;
    const struct host_services *services;
};

static void run_scripts(void *context) {
    const struct scripts *scripts = context;
    render_process_run(scripts->options, scripts->services, 0);
}

static void note_failure(struct in_process *in_process, const struct error *error) {
    output_report(&in_process->output, LINE_ERROR, error->text);
    in_process_script_ended(in_process, 0, (int)error->kind);
}

static int run(struct in_process *in_process, const struct options *options) {
    struct control control = {0};
    struct error error;
    struct host_services services = {.context = in_process,
                                     .control = &control,
                                     .begin = in_process_begin,
                                     .abandon = in_process_abandon,
                                     .done = in_process_done,
                                     .model = in_process_model,
                                     .model_end = in_process_model_end,
                                     .solution = in_process_solution,
                                     .line = in_process_line,
                                     .script_ended = in_process_script_ended,
                                     .read = in_process_read,
                                     .poll = in_process_poll};
    struct scripts scripts = {options, &services};
    /* A closed pipe and a limit of files are errors of a write, with a message. */
    (void)signal(SIGPIPE, SIG_IGN);
    (void)signal(SIGXFSZ, SIG_IGN);
    output_init(&in_process->output, options, &control);
    output_warn_no_sandbox(&in_process->output);
    if (!options->script.no_sandbox)
        output_report(&in_process->output, LINE_WARNING,
                      "gray: warning: --no-fork: no Landlock, no seccomp filter: confined by checks of file names");
    if (!pool_call_with_stack(run_scripts, &scripts, &error))
        note_failure(in_process, &error);
    if (!output_finish(&in_process->output, in_process->status == 0, &error))
        note_failure(in_process, &error);
    if (!output_flush_streams(&in_process->output, &error))
        note_failure(in_process, &error);
    return in_process->status;
}

/* Not on the stack, which may be small. */
int in_process_run(const struct options *options) {
    struct in_process *in_process = mem_alloc_zero(1, sizeof *in_process);
    if (!in_process) {
        (void)fputs("gray: out of memory\n", stderr);
        return ERROR_MACHINE;
    }
    int status = run(in_process, options);
    mem_free(in_process);
    return status;
}
