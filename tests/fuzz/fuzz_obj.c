/* Any bytes as an OBJ file: a mesh or one line that names the file, nothing else. */
#include "formats/obj_internal.h"

#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    struct error error = {0};
    struct mesh *mesh = obj_parse("fuzz.obj", (const char *)data, size, &error);
    if (!mesh && (error.kind == ERROR_NONE || (!strstr(error.text, "fuzz.obj") || strchr(error.text, '\n'))))
        abort();
    mesh_release(mesh);
    return 0;
}
