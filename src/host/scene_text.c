#include "host/scene_text.h"

#include "host/render_process_internal.h"
#include "host/render_reports.h"
#include "session/options.h"
#include "session/text.h"

#include <stdio.h>
#include <string.h>

static bool is_numbered(const struct options *options) {
    return options->output && output_name_numbered(options->output);
}

static bool send(const struct render_process *process, uint32_t number, const void *text, size_t size,
                 struct error *error) {
    const struct host_services *services = process->services;
    const struct model_request request = {.role = MODEL_SCENE, .number = number, .size = size};
    bool ok = services->model(services->context, &request, text, error);
    services->model_end(services->context);
    return ok;
}

bool scene_text_write(void *render_process, const struct render_request *request, const char *text, size_t size,
                      struct error *error) {
    struct render_process *process = render_process;
    if (process->skips)
        return true;
    uint32_t number = ++process->scenes;
    process->model_pictures++;
    if (is_numbered(process->options))
        return send(process, request->frame.number > 0 ? request->frame.number : number, text, size, error);
    if (number > 1) {
        list_destroy(&process->scene);
        return error_set(error, ERROR_USAGE,
                         "%s: more than one picture is rendered; -o scene%%d.%s writes a file for each, and --frames "
                         "N-N chooses a frame",
                         process->options->to_json ? "--to-json" : "--to-lua",
                         process->options->to_json ? "json" : "lua");
    }
    return (list_add_bytes(&process->scene, text, size) && list_add_bytes(&process->scene, "", 1)) ||
           error_no_memory(error, "the text of the scene");
}

bool scene_text_finish(struct render_process *process, struct error *error) {
    const char *output = process->options->output;
    bool ok = true;
    if (process->scene.count == 0)
        return true;
    if (output && strcmp(output, "-") != 0)
        ok = send(process, 1, process->scene.items, process->scene.count - 1, error);
    else
        text_print(stdout, process->scene.items);
    list_destroy(&process->scene);
    return ok;
}
