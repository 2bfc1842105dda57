/* node:export. */
#include "formats/model_format.h"
#include "record/record_bounds.h"
#include "script/rows_internal.h"
#include "script/script_internal.h"

enum { EXPORT_FILE = 1, EXPORT_TOLERANCE, EXPORT_UNIT, EXPORT_TEXT };
static const struct script_parameter export_parameters[] = {
    SELF_PARAMETER,
    [EXPORT_FILE] = {"file", KIND_OUTPUT, 0, ANY, NULL, NULL, "Model file:" MODEL_FORMATS_HELP "."},
    [EXPORT_TOLERANCE] = {"tolerance", KIND_NUMBER, OPTIONAL | LOW_OPEN, ABOVE(0), NULL, "1/1000 of the size",
                          "Largest distance of the model from the exact surface."},
    [EXPORT_UNIT] = {"unit", KIND_CHOICE, OPTIONAL, 0, 0, LIST_BLANKS(MODEL_UNITS), NULL, "'mm'",
                     "Unit of the numbers, for files that name it (3MF)."},
    [EXPORT_TEXT] = {"text", KIND_BOOLEAN, OPTIONAL, ANY, NULL, "false", "Whether an STL file is text, not binary."},
};

static bool gr_export(struct script_context *context, const struct script_value *args, struct script_result *result,
                      struct error *error) {
    (void)result;
    char where[PATH_SIZE + 32], title[96];
    sandbox_where(&context->sandbox, where, sizeof where);
    const char *call = arena_format(&context->sandbox.call, "%s%s", where, function_title(context->function, title));
    if (!call)
        return error_no_memory(error, "a model");
    const struct script_host *host = script_of(context)->host;
    const struct export_request request = {.scene = &context->scene,
                                           .node = args[SELF].node,
                                           .file = args[EXPORT_FILE].text,
                                           .tolerance = args[EXPORT_TOLERANCE].number,
                                           .unit = args[EXPORT_UNIT].choice,
                                           .text = args[EXPORT_TEXT].boolean,
                                           .linear = settings_linear(&host->settings),
                                           .where = call};
    if (!record_check(&context->sandbox, &context->scene, request.node, error))
        return false;
    limits_pause(&context->sandbox.limits);
    bool done = !host->export_model || host->export_model(host->context, &request, error);
    limits_resume(&context->sandbox.limits);
    return done;
}

static const struct script_function export_rows[] = {
    NODE("export", export_parameters, RESULT_NOTHING, gr_export,
         "Writes the solids of the node as a closed mesh, or as glTF the whole node, for printers and other programs.", "file"),
};
const struct function_rows export_functions = {export_rows, COUNT(export_rows)};
