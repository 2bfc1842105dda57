#include "output/model_output.h"

#include "formats/model_format.h"
#include "output/solution_file_internal.h"

#include <string.h>

static bool choose_name(struct model_output *model, const struct picture_files *files,
                        const struct model_request *request, struct error *error) {
    const struct options *options = files->options;
    if (request->role == MODEL_SCENE) {
        model->by_user = true;
        model->is_beside = false;
        return (options->output && output_name(options->output, request->number, model->name, sizeof model->name)) ||
               error_set(error, ERROR_SCENE, "the name of the scene is longer than %d bytes", NAME_LIMIT - 1);
    }
    const char *own = request->role == MODEL_BAKED ? options->bake : request->role ? options->model : NULL;
    const char *file = own ? own : request->file;
    size_t length = strlen(file);
    model->by_user = file != request->file;
    if (request->role != MODEL_BAKED && model_format_written(file) == FORMAT_OTHER)
        return error_set(error, ERROR_SCENE, "%.600s: the name of a model ends in" MODEL_FORMATS_HELP, file);
    if (length >= sizeof model->name)
        return error_set(error, ERROR_SCENE, "the name of the model is longer than %d bytes", NAME_LIMIT - 1);
    if (!model->by_user && !options->script.no_sandbox && !path_policy_may_create(&files->folders, file))
        return error_set(
            error, ERROR_SCENE,
            "%.600s: models of scripts must be below the working directory, without a hidden name (-o FILE "
            "or --allow-write DIR allow other places)",
            file);
    memcpy(model->name, file, length + 1);
    model->is_beside = request->beside;
    if (request->beside)
        memcpy(model->name + length - 4, ".mtl", 4);
    return true;
}

static const struct file_rules *rules_of(const struct model_output *model, const struct picture_files *files) {
    return model->by_user ? &files->user_model : &files->model;
}

/* Finds what an earlier picture or run has kept. */
static bool find_solution(struct model_output *model, const struct picture_files *files, struct error *error) {
    const struct options *options = files->options;
    const struct file_target target = {.path = model->solution, .rules = &files->solution};
    model->stays = false;
    if (model->solution[0] == '\0')
        return error_set(error, ERROR_SCENE, "no file is named for the solution of radiosity");
    if (!file_output_check(&target, error))
        return error_elsewhere(error);
    if (!file_is_regular(model->solution))
        return true;
    if (!solution_file_read(model->solution, model->depends, script_picture_memory(&options->script), &model->memory,
                            error))
        return error_elsewhere(error);
    model->stays = model->memory.block || model->is_later;
    return model->stays || !options->resume ||
           error_set(error, ERROR_SCENE,
                     "%.400s: cannot be resumed: the scene, an option of radiosity or gray has changed",
                     model->solution) ||
           error_elsewhere(error);
}

bool model_output_begin(struct model_output *model, struct picture_files *files, const struct model_request *request,
                        struct error *error) {
    if (files->folders_error.kind != ERROR_NONE) {
        *error = files->folders_error;
        return false;
    }
    model->is_solution = request->role == MODEL_SOLUTION;
    model->depends = request->depends;
    if (model->is_solution && request->size == 0)
        return find_solution(model, files, error);
    if (!model->is_solution && !choose_name(model, files, request, error))
        return false;
    const struct file_target target = {.path = model->name, .rules = rules_of(model, files)};
    if (!model->is_solution && !file_output_check(&target, error))
        return model->by_user ? error_elsewhere(error) : false;
    model->size = request->size;
    if (request->size > files->quota.limit - files->quota.written)
        return error_set_limit(error, "%s", files->quota.words);
    if (request->size > script_picture_memory(&files->options->script))
        return error_set_limit(error, "%.600s: the model takes more than --script-memory allows", model->name);
    return request->size == 0 || share_create(&model->memory, request->size, error);
}

bool model_output_write(struct model_output *model, struct picture_files *files, struct error *error) {
    struct file_output own = {0}, *output = model->is_beside ? &model->beside : &own;
    const struct file_target target = {.path = model->name, .rules = rules_of(model, files)};
    if (model->is_solution) {
        const struct file_target kept = {.path = model->solution, .rules = &files->solution};
        bool written = model->stays || solution_file_write(&kept, model->depends, &model->memory, error);
        model_output_forget(model);
        return written;
    }
    bool ok =
        file_output_open(output, &target, error) && file_output_write(output, model->memory.block, model->size, error);
    if (ok && model->is_beside) {
        share_destroy(&model->memory);
        return true;
    }
    ok = ok && (!model->beside.open || file_output_commit(&model->beside, error)) && file_output_commit(output, error);
    file_output_abandon(&own);
    model_output_forget(model);
    return ok || (model->by_user ? error_elsewhere(error) : false);
}

void model_output_forget(struct model_output *model) {
    file_output_abandon(&model->beside);
    share_destroy(&model->memory);
}
