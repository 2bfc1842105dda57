/* Any bytes as a library of materials. */
#include "fuzz_model.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    struct error error = {0};
    struct model model = {.path = "fuzz.obj", .options.single_file = true};
    if (!mtl_load(&model, "fuzz.mtl", (const char *)data, size, &error) &&
        (error.kind == ERROR_NONE || !strstr(error.text, "fuzz.mtl") || strchr(error.text, '\n')))
        abort();
    model_destroy(&model);
    return 0;
}
