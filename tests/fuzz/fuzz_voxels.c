/* Any bytes as an NRRD file: a grid whose values are finite and not negative, or one line that names the file. */
#include "formats/voxels.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    struct arena arena = {0};
    struct error error = {0};
    struct voxels voxels;
    if (voxels_parse_nrrd("fuzz.nrrd", data, size, &arena, &voxels, &error)) {
        uint64_t count = (uint64_t)voxels.count[0] * voxels.count[1] * voxels.count[2];
        for (uint64_t i = 0; i < count; i++)
            if (!(voxels.values[i] >= 0) || !isfinite(voxels.values[i]))
                abort();
    } else if (error.kind == ERROR_NONE || !strstr(error.text, "fuzz.nrrd") || strchr(error.text, '\n')) {
        abort();
    }
    arena_destroy(&arena);
    return 0;
}
