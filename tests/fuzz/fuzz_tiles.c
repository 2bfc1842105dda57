/* Any bytes as a file of tiles: a description and tiles that fit its film, or one line that names the file. If the last
 * byte is odd, the checksums of all records are corrected first; otherwise hardly any input would pass them. */
#define _GNU_SOURCE
#include "base/mem.h"
#include "film/tile_file.h"
#include "tests/fuzz/tile_bytes.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void restore(const struct tile_file *file) {
    const struct tile_picture *picture = &file->picture;
    struct error error;
    size_t bytes;
    if ((uint64_t)picture->width * picture->height > 1 << 16 ||
        !film_size(picture->width, picture->height, picture->record, &bytes, &error))
        return;
    void *block = mem_alloc_zero(1, bytes);
    if (!block)
        return;
    struct film film = {.x0 = picture->x0, .y0 = picture->y0};
    uint32_t restored, twice;
    film_layout(&film, block, picture->width, picture->height, picture->record);
    tile_file_restore(file, &film, &restored, &twice);
    if (twice != 0 || restored != file->tiles)
        abort();
    mem_free(block);
}

/* A file in memory has a path as long as it is open. */
static int open_bytes(const uint8_t *bytes, size_t size, char path[64]) {
    int descriptor = memfd_create("fuzz.part", MFD_CLOEXEC);
    if (descriptor < 0 || write(descriptor, bytes, size) != (ssize_t)size)
        abort();
    (void)snprintf(path, 64, "/proc/self/fd/%d", descriptor);
    return descriptor;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    uint8_t *bytes = mem_alloc(size + 1);
    if (!bytes)
        return 0;
    if (size)
        memcpy(bytes, data, size);
    if (size > 16 && data[size - 1] % 2)
        tile_bytes_repair(bytes, size);
    struct tile_file file;
    struct error error = {0};
    char path[64];
    int descriptor = open_bytes(bytes, size, path);
    bool taken = tile_file_read(path, &file, &error);
    if (taken && file.has_picture)
        restore(&file);
    if (taken)
        tile_file_close(&file);
    else if (error.kind == ERROR_NONE || !strstr(error.text, path) || strchr(error.text, '\n'))
        abort();
    (void)close(descriptor);
    mem_free(bytes);
    return 0;
}
